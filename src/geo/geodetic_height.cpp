// SPDX-License-Identifier: MIT
// geodetic_height.cpp - the points at one height over an ellipsoid.  The height is a convex distance
// (earth.hpp).  So
//   - |F| minus its rounding is a clearance everywhere;
//   - a ray enters once and leaves once, and `first` tells which comes first;
//   - readings at the two ends of a stretch enclose g and its slope.
#include "earth.hpp"

namespace geo {
namespace {

// If -h is below this part of the least radius of curvature, the surface is smooth and its body convex.  Its
// radii of curvature are then those of the ellipsoid plus h.
constexpr double DEEPEST = 0.99;

sgt_objection object(const sgt_geodetic_height &s)
{
    double a = s.a, f = s.f;
    if (!(a >= 0 && a <= 1e100)) return {"a", "must be above 0 and at most 1e100"};
    if (a == 0 && f != 0) return {"f", "given without a; give both or neither"};
    if (!(f < 1 && f >= -1e6)) return {"f", "must be below 1 and at least -1e6"};
    if (a == 0) a = wgs84().a, f = wgs84().f;
    double b = a * (1 - f), least = a < b ? a * (a / b) : b * (b / a);
    if (!(b > 0 && least > 1e-100))
        return {"a", "too small, or f too near 1: the ellipsoid shrinks to nothing"};
    if (!(s.h <= 1e100)) return {"h", "must be at most 1e100"};
    if (!(s.h > -DEEPEST * least))
        return {"h", "must be above -0.99 of the least radius of curvature: below it the surface folds"};
    return {nullptr, nullptr};
}

struct height {
    bool valid;
    double h;
    ellipsoid e;
    shell body; // set by prepare()
    explicit height(const void *self) : height(*static_cast<const sgt_geodetic_height *>(self)) {}
    explicit height(const sgt_geodetic_height &s)
        : valid(!object(s).param), h(s.h), e(valid && s.a != 0 ? ellipsoid(s.a, s.f) : wgs84()), body() {}

    void prepare() { body = shell_of(e, h); }

    double value(const sgt_vec3 &p, sgt_vec3 *grad) const
    {
        foot q = e.below(p);
        if (grad) *grad = q.up;
        return q.h - h;
    }
    double rounding(double size, double over) const
    {
        return e.rounding(size, over) + 0x1p-53 * (std::fabs(over) + std::fabs(h));
    }
    double rounding(const sgt_vec3 &p) const { return rounding(length(p), e.farthest(length(p))); }

    reading read(const sgt_ray &ray, double t) const
    {
        sgt_vec3 p = at(ray, t);
        foot q = e.below(p);
        double size = length(p);
        return {q.h - h, rounding(size, q.h) + 0x1p-53 * size, dot(q.up, ray.d),
                length(ray.d) * (e.direction(size, q.h) + 0x1p-50)};
    }
    chord across(const sgt_ray &ray) const { return chord_of(body, ray); }
    sgt_span span(const sgt_ray &ray) const { return span_of(across(ray)); }
    sgt_span first(const sgt_ray &ray) const
    {
        return first_of(across(ray), ray, 0, [&](double t) { return read(ray, t); });
    }
    sgt_interval enclose(const sgt_ray &ray, sgt_interval t, sgt_interval *slope) const
    {
        return convex(t, read(ray, t.lo), read(ray, t.hi), slope);
    }
    double by_parameter() const { return -1; }
};

double clearance(const void *self, sgt_vec3 p)
{
    height s(self);
    if (!s.valid) return nothing;
    foot q = s.e.below(p);
    return std::fabs(q.h - s.h) - s.rounding(length(p), q.h);
}

// The second derivatives of a parallel surface: curvature 1 / (M + h) northward and 1 / (N + h) eastward.
void second(const void *self, size_t n, sgt_points p, double *const out[6])
{
    height s(self);
    for (size_t i = 0; i < n; i++) {
        foot q = s.e.below({p.p[0][i], p.p[1][i], p.p[2][i]});
        double along = s.valid ? 1 / (s.e.meridian(q.sin_latitude) + q.h) : nothing,
               across = 1 / (s.e.vertical(q.sin_latitude) + q.h);
        double north[3] = {-q.sin_latitude * q.cos_longitude, -q.sin_latitude * q.sin_longitude,
                           q.cos_latitude},
               east[3] = {-q.sin_longitude, q.cos_longitude, 0};
        for (int j = 0, m = 0; j < 3; j++)
            for (int k = j; k < 3; k++, m++)
                out[m][i] = along * north[j] * north[k] + across * east[j] * east[k];
    }
}

constexpr sgt_surface_ops with_all()
{
    sgt_surface_ops ops = operations<height>::named("geodetic_height");
    ops.clearance = clearance, ops.second = second;
    return ops;
}

} // namespace

sgt_objection object_to_geodetic_height(const void *self)
{
    return object(*static_cast<const sgt_geodetic_height *>(self));
}

} // namespace geo

const sgt_surface_ops sgt_geodetic_height_ops = geo::with_all();
