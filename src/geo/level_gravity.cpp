// SPDX-License-Identifier: MIT
// level_gravity.cpp - a level surface of normal gravity about the Earth.
//
// F = G(p) - G of the level, with G = GM / U.  For a point mass at rest, G is the distance from it.  So G is
// nearly a distance: its gradient is nearly a unit vector, Newton's method needs two steps from anywhere, and
// it is nearly convex.  U is from GeographicLib's NormalGravity (Heiskanen and Moritz 1967, section 2-7, in
// Karney's form).
//
// THE FAR SHEET.  U = GM / r + omega^2 rho^2 / 2 and small terms.  Along a radius U falls up to
// r^3 sin^2(colatitude) = GM / omega^2 (42164 km on the equator) and rises from there on.  So far out U has
// the value of the level again.  F is defined only inside a sphere that excludes that sheet; the span is
// closer still.
//
// THE BODY inside is convex.  Across the vertical the second derivative of U is -GM / r^3 (1 - q) with
// q = omega^2 r^3 / GM, to some percent, and q is below 0.06 for r <= a + MOST.  Its surface is nearly the
// ellipsoid of its own two radii: exactly that at h = 0, outside of it for h < 0, inside for h > 0.  It is
// farthest from it at latitude 45 (to 1e-3 of the maximum; observed for -100 km ... 10000 km, every tenth of
// a degree), by 0.4 m at h = 100 km.
//
// THE BOUNDS of the derivatives of F, times r.  Observed at 200,000 points and directions, on spheres of 6280
// km and more: gradient 0.97 ... 0.999; second derivative at most 1.0006, and at least -0.0206 (at 6280 km),
// -0.028 (7000 km), -0.078 (10000 km), -0.53 (20000 km).  Used are 1.01 for the gradient, and 1.05 and
// -0.04 (r / 7000 km)^3 for the second derivative.
#include "earth.hpp"

#include <GeographicLib/NormalGravity.hpp>

namespace geo {
namespace {

using GeographicLib::NormalGravity;

constexpr double LEAST = -1e5, MOST = 1e7, EDGE = 42e6, DEEP = 6e6;
constexpr double BENDS = 1.05, STEEP = 1.01;

double bends_down(double r) { return 0.04 * (r / 7e6) * (r / 7e6) * (r / 7e6); }

double potential_at(double x, double z)
{
    double gx, gy, gz;
    return NormalGravity::WGS84().U(x, 0, z, gx, gy, gz);
}

sgt_objection object(const sgt_level_gravity &s)
{
    const double a = wgs84().a;
    if (!(s.h >= LEAST && s.h <= MOST)) return {"h", "must be from -100e3 to 10e6 m"};
    if (s.potential != 0 && s.h != 0) return {"potential", "given beside h; give one of the two"};
    if (s.potential != 0 &&
        !(s.potential >= potential_at(a + MOST, 0) && s.potential <= potential_at(a + LEAST, 0)))
        return {"potential", "must be that of a level from -100e3 to 10e6 m high on the equator"};
    return {nullptr, nullptr};
}

// The radius of the level U on the equator or the axis, to rounding.  GM / U is nearly r, and Newton's step
// from where it is right to 1e-8 leaves 1e-16.
double radius_of(double U, bool axis)
{
    const NormalGravity &field = NormalGravity::WGS84();
    double G = field.MassConstant() / U, gx, gy, gz, here, slope;
    sgt_options near = {};
    near.f_tol = 1e-8 * G;
    sgt_root r = sgt_root_begin({0.5 * G, 2 * G, G, true}, &near);
    do {
        double own = axis ? field.U(0, 0, r.t, gx, gy, gz) : field.U(r.t, 0, 0, gx, gy, gz);
        here = field.MassConstant() / own, slope = -here / own * (axis ? gz : gx);
    } while (sgt_root_next(&r, here - G, slope));
    return r.t - (here - G) / slope;
}

struct level {
    bool valid, by_height;
    double a, U, G; // of the level: its radius on the equator, U, and GM / U
    shell body;     // set by prepare()
    explicit level(const void *self) : level(*static_cast<const sgt_level_gravity *>(self)) {}
    explicit level(const sgt_level_gravity &s)
        : valid(!object(s).param), by_height(s.potential == 0), a(wgs84().a + s.h),
          U(by_height ? potential_at(a, 0) : s.potential), G(NormalGravity::WGS84().MassConstant() / U),
          body()
    {
    }

    void prepare()
    {
        if (!by_height) a = radius_of(U, false);
        double b = radius_of(U, true), half = std::sqrt(0.5),
               off = 1.25 * std::fabs(value({a * half, 0, b * half}, nullptr)) / b + 1e-9;
        body = {a, b, 1 - off, 1 + off};
    }

    double value(const sgt_vec3 &p, sgt_vec3 *grad) const
    {
        const NormalGravity &field = NormalGravity::WGS84();
        sgt_vec3 g;
        if (!(length(p) <= EDGE)) return no_gradient(grad);
        double own = field.U(p.x, p.y, p.z, g.x, g.y, g.z), here = field.MassConstant() / own,
               scale = -here / own;
        if (grad) *grad = {g.x * scale, g.y * scale, g.z * scale};
        return here - G;
    }
    // Observed, against quadruple precision, at 6300 ... 42000 km: at most 4.2 units of 2^-53 of |p| + G.
    double rounding(const sgt_vec3 &p) const { return 0x1p-53 * 8 * (length(p) + G); }

    reading read(const sgt_ray &ray, double t) const
    {
        sgt_vec3 p = at(ray, t), grad;
        double g = value(p, &grad), along = length(ray.d), size = length(p);
        return {g, rounding(p) + 0x1.04p-53 * size, dot(grad, ray.d), 0x1p-46 * along};
    }
    chord across(const sgt_ray &ray) const { return chord_of(body, ray); }
    sgt_span span(const sgt_ray &ray) const { return span_of(across(ray)); }
    sgt_span first(const sgt_ray &ray) const
    {
        return first_of(across(ray), ray, bends_down(a) / DEEP * dot(ray.d, ray.d),
                        [&](double t) { return read(ray, t); });
    }
    // By Taylor about the middle.  Deep down, where the field has its sources, all that is used is that F is
    // negative there: U is above GM / r of the farther end, to 1.2e-3, because a potential has its minimum on
    // the boundary.
    sgt_interval enclose(const sgt_ray &ray, sgt_interval t, sgt_interval *slope) const
    {
        double middle = 0.5 * t.lo + 0.5 * t.hi,
               half = std::fmax(t.hi - middle, middle - t.lo) * (1 + 0x1p-50), along = length(ray.d);
        double far = std::fmax(length(at(ray, t.lo)), length(at(ray, t.hi))) * (1 + 0x1p-50);
        if (!(far <= EDGE)) return sgt_interval_all();
        sgt_vec3 p = at(ray, middle);
        double near = length(p) - half * along * (1 + 0x1p-50);
        if (!(near >= DEEP)) return {-2 * G, std::fmax(far, DEEP) * 1.0015 - G};
        reading r = read(ray, middle);
        double bend = along * along / near * (1 + 0x1p-40), up = 0.5 * BENDS * bend * half * half,
               down = 0.5 * bends_down(far) * bend * half * half;
        double steep = std::fabs(r.slope) + r.slope_err,
               turn = std::fmax(BENDS, bends_down(far)) * bend * half + r.slope_err, most = STEEP * along;
        *slope = {std::fmax(r.slope - turn, -most), std::fmin(r.slope + turn, most)};
        return {r.g - r.g_err - steep * half * (1 + 0x1p-50) - down,
                r.g + r.g_err + steep * half * (1 + 0x1p-50) + up};
    }
    // By h, through the change of the level's own G; or by U: dG / dU = -G / U.
    double by_parameter() const
    {
        double gx, gy, gz;
        if (!by_height) return G / U;
        NormalGravity::WGS84().U(a, 0, 0, gx, gy, gz);
        return gx / U * G;
    }
};

} // namespace

sgt_objection object_to_level_gravity(const void *self)
{
    return object(*static_cast<const sgt_level_gravity *>(self));
}

} // namespace geo

const sgt_surface_ops sgt_level_gravity_ops = geo::operations<geo::level>::named("level_gravity");
