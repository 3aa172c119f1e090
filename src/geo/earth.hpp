// SPDX-License-Identifier: MIT
// earth.hpp - shared by the surfaces about the Earth: the height over an ellipsoid and its error, the two
// ellipsoids between which a ray's roots lie, and which root is the first.
#ifndef SGT_GEO_EARTH_HPP
#define SGT_GEO_EARTH_HPP

#include <sagitta/geo.h>
#include <sagitta/interval.h>

#include <GeographicLib/Geocentric.hpp>

#include <cmath>

namespace geo {

constexpr double infinity = HUGE_VAL, nothing = static_cast<double>(NAN);

// ------------------------------------------------------------------ vectors

inline double dot(const sgt_vec3 &a, const sgt_vec3 &b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline double length(const sgt_vec3 &a) { return std::sqrt(dot(a, a)); }

// Each coordinate is rounded once, however far o is: its relative error is at most 2^-53.
inline sgt_vec3 at(const sgt_ray &ray, double t)
{
    return {std::fma(t, ray.d.x, ray.o.x), std::fma(t, ray.d.y, ray.o.y), std::fma(t, ray.d.z, ray.o.z)};
}

// ---------------------------------------------------------------- the height

// The height h over an ellipsoid is the signed distance to a convex body.  Let sigma(n) be the distance from
// the origin to its tangent plane of normal n.  Then
//     h(p) = max over unit n of n . p - sigma(n),   sigma = sqrt(a^2 (nx^2 + ny^2) + b^2 nz^2),
// and the maximum is at the up vector n (Rockafellar 1970, section 16, for points outside; for points inside,
// the nearest tangent plane is that of the nearest point).  Three things follow.
//   - h is convex along every ray, and changes by no more than the distance travelled.
//   - An error e of n changes the right side only by (M + h) e^2 / 2, where M is a radius of curvature.  So n
//     is from GeographicLib's Reverse (Vermeille 2002; Karney 2011), which need be right only to 1e-10 and is
//     to 1e-15.  h is computed as the right side, and has its rounding.  No other error of Reverse enters.
//   - The Hessian of h is that of a parallel surface: 1 / (M + h) northward, 1 / (N + h) eastward.
struct foot { // the point of the ellipsoid below p
    double h, latitude, longitude;
    double sin_latitude, cos_latitude, cos_longitude, sin_longitude;
    sgt_vec3 up;
};

struct ellipsoid {
    double a, f, b, most;   // radii: equatorial, polar, the greater
    double least;           // radius of curvature
    GeographicLib::Geocentric geocentric;

    ellipsoid(double a, double f); // 0 < a <= 1e100 and f < 1

    foot below(const sgt_vec3 &p) const;

    // A bound on |computed h - exact h| at p; size: |p|.  Relative errors to first order, in units of 2^-53:
    // r 2; c r 1; s z 1; sigma 5; s z - sigma (fused) and h 1 each; the length of (c, s) 2.  With
    // c r + |s z| <= |p|, sigma <= most and |h| <= |p| + most the sum is 3 |p| + 6 most + 3 |h|.
    double rounding(double size, double h) const
    {
        return 0x1p-53 * (1 + 0x1p-40) * (3 * size + 6 * most + 3 * std::fabs(h));
    }

    // An upper bound of |h|: the ellipsoid holds a ball of its least radius and lies in one of its greatest.
    double farthest(double size) const
    {
        return std::fmax(std::fabs(size - most), std::fabs(size - std::fmin(a, b)));
    }

    // A bound on the error of n, if h is not near the evolute.  Observed against quadruple precision (f =
    // -5 ... 0.9, from half way to the evolute to 1000 a): at most 1.3 units of 2^-53 (|p| + most) / (least +
    // h).  The bound is 64 units.
    double direction(double size, double h) const
    {
        return h + least > 0x1p-6 * least ? 0x1p-47 * (size + most) / (least + h) + 0x1p-50 : infinity;
    }

    double meridian(double sine) const; // radii of curvature
    double vertical(double sine) const;
};

const ellipsoid &wgs84();

// --------------------------------- the two ellipsoids between which a ray's roots lie

// Two ellipsoids of radii (a, a, b) times `inner` and `outer`: the surface of the body lies between them.
struct shell { double a, b, inner, outer; };

// The shell of the points of height h.  The body's tangent planes are at distance sigma + h.  Those of the
// ellipsoid of radii a + h, b + h are at |u + h n| with u = (a c, b s), |u| = sigma.  Now
// (|u| + h)^2 = |u + h n|^2 + 2 h (|u| - u.n), and 0 <= |u| - u.n <= (a - b)^2 / (4 |u|), because the sine of
// the angle between u and n is (a - b) c s / |u|.
shell shell_of(const ellipsoid &e, double h);

// A ray through a shell.  lo, hi are moved outward, and in, out inward, by more than rounding can do.
struct chord {
    bool by;               // it misses the outer ellipsoid
    bool known;            // false: out of the range of double; nothing is claimed
    double lo, hi, middle; // t of the chord of the outer ellipsoid, and of its middle
    double in, out;        // t of the chord of the inner ellipsoid, if in <= out
    double depth;          // at least how deep the middle is below the surface
    double entry, exit;    // t where it meets the ellipsoid (a, a, b); if it misses that, t of the middle
};
chord chord_of(const shell &s, const sgt_ray &ray);

inline sgt_span span_of(const chord &c)
{
    if (!c.known) return {-infinity, infinity, nothing, false};
    if (c.by) return {infinity, -infinity, nothing, false};
    return {c.lo, c.hi, c.entry, false};
}

// F on the ray and its slope, and bounds on their errors.
struct reading { double g, g_err, slope, slope_err; };

// The first accepted root on a convex body: `entry` if the ray starts in front of the body, `exit` if inside,
// none if behind.  A point of the ray that is certainly inside separates the two roots.  F on the ray, g,
// falls before the first and rises behind the second.  By convexity the slope at a root is at least depth /
// (distance to that point).  bend: g'' >= -bend on the whole chord.  If rounding hides on which side of the
// surface tmin is, or whether the ray touches, nothing is claimed: it is the span, and not `single`.
//
// Why apart: convexity tells here what the general path has to search for.  Without `first` a height
// over the ellipsoid costs 1.8 times the instructions one by one and 2.3 times in a batch, a level of
// gravity 1.7 and 3.3 times (300 rays from 400 km above the Earth, by callgrind).
template <typename Read> sgt_span first_of(const chord &c, const sgt_ray &ray, double bend, Read &&read)
{
    const sgt_span none = {infinity, -infinity, nothing, false};
    if (!c.known || c.by) return span_of(c);
    double tmax = ray.tmax == 0 && ray.tmin >= 0 ? infinity : ray.tmax;
    if (ray.tmin > c.hi || tmax < c.lo) return none;

    double in = c.in, out = c.out, depth = c.depth, middle = c.middle;
    if (!(in <= out && depth > 0)) { // look for the lowest point, the root of the slope
        double by = 0x1p-11 * (c.hi - c.lo);
        sgt_options few = {};
        few.max_evals = 12;
        sgt_root low = sgt_root_begin({c.lo, c.hi, middle, true}, &few);
        for (;;) {
            reading r = read(low.t);
            if (!(r.g_err < infinity)) return span_of(c);
            depth = 0.5 * (-r.g - 4 * r.g_err);
            if (depth > 0) break;
            double rest = std::fmax(low.t - c.lo, c.hi - low.t),
                   fall = std::fabs(r.slope) + r.slope_err; // g is above its tangent, less the bend
            if (r.g - r.g_err - fall * rest - 0.5 * bend * rest * rest > 0) return none;
            low.g_err = r.slope_err;
            if (!sgt_root_next(&low, r.slope, (read(low.t + by).slope - r.slope) / by)) return span_of(c);
        }
        in = out = middle = low.t;
    }

    double far = std::fabs(ray.o.x) + std::fabs(ray.o.y) + std::fabs(ray.o.z), along = length(ray.d);
    double unsure = 0x1p-40 * (far + (std::fabs(c.lo) + std::fabs(c.hi)) *
                                         along); // of F: 256 times the tolerance of a start on the surface
    double steep = 0.5 * depth / (c.hi - c.lo);  // the least |slope| of g at a root
    if (ray.tmin <= c.lo && (ray.tmin == -infinity || (c.lo - ray.tmin) * steep > unsure))
        return {c.lo, middle, c.entry, true};
    if (ray.tmin >= in && ray.tmin <= out) return {ray.tmin, c.hi, c.exit, true};
    if (!(ray.tmin > c.lo)) return span_of(c);
    reading r = read(ray.tmin);
    if (r.g < -4 * r.g_err) return {ray.tmin, c.hi, c.exit, true};
    if (ray.tmin > middle) return r.g > unsure ? none : span_of(c);
    if (0.5 * r.g / along * steep > 2 * unsure) return {ray.tmin, middle, c.entry, true};
    return span_of(c);
}

// An enclosure of a convex g on t, from readings at its two ends.  g lies below the chord and above both
// tangents, and its slope between those of the ends.
sgt_interval convex(sgt_interval t, const reading &from, const reading &to, sgt_interval *slope);

inline double no_gradient(sgt_vec3 *grad)
{
    if (grad) *grad = {nothing, nothing, nothing};
    return nothing;
}

// --------------------------------------------------------- a surface as its operations

// S is made of a struct of parameters once per call.  It has: valid, value(p, grad), rounding(p), prepare(),
// then span(ray) and first(ray), enclose(ray, t, slope), and by_parameter(), which is the same at every
// point.  None of them throws.
template <typename S> struct operations {
    static double value(const void *self, sgt_vec3 p, sgt_vec3 *grad)
    {
        S s(self);
        return s.valid ? s.value(p, grad) : no_gradient(grad);
    }
    static void values(const void *self, size_t n, sgt_points p, sgt_values out)
    {
        S s(self);
        for (size_t i = 0; i < n; i++) {
            sgt_vec3 at = {p.p[0][i], p.p[1][i], p.p[2][i]}, grad, *wanted = out.grad[0] ? &grad : nullptr;
            out.f[i] = s.valid ? s.value(at, wanted) : no_gradient(wanted);
            if (wanted) out.grad[0][i] = grad.x, out.grad[1][i] = grad.y, out.grad[2][i] = grad.z;
        }
    }
    static S prepared(const void *self)
    {
        S s(self);
        if (s.valid) s.prepare();
        return s;
    }
    static sgt_span anywhere() { return {-infinity, infinity, nothing, false}; }
    static sgt_span span(const void *self, const sgt_ray *ray)
    {
        S s = prepared(self);
        return s.valid ? s.span(*ray) : anywhere();
    }
    static sgt_span first(const void *self, const sgt_ray *ray)
    {
        S s = prepared(self);
        return s.valid ? s.first(*ray) : anywhere();
    }
    template <typename One> static void each(size_t n, sgt_rays rays, sgt_spans out, One &&one)
    {
        for (size_t i = 0; i < n; i++) {
            sgt_span s = one(sgt_ray{{rays.o[0][i], rays.o[1][i], rays.o[2][i]},
                                     {rays.d[0][i], rays.d[1][i], rays.d[2][i]},
                                     rays.tmin ? rays.tmin[i] : 0,
                                     rays.tmax ? rays.tmax[i] : infinity});
            out.lo[i] = s.lo, out.hi[i] = s.hi, out.seed[i] = s.seed, out.single[i] = s.single;
        }
    }
    static void spans(const void *self, size_t n, sgt_rays rays, sgt_spans out)
    {
        S s = prepared(self);
        each(n, rays, out, [&](const sgt_ray &ray) { return s.valid ? s.span(ray) : anywhere(); });
    }
    static void firsts(const void *self, size_t n, sgt_rays rays, sgt_spans out)
    {
        S s = prepared(self);
        each(n, rays, out, [&](const sgt_ray &ray) { return s.valid ? s.first(ray) : anywhere(); });
    }
    static double rounding(const void *self, sgt_vec3 p)
    {
        S s(self);
        return s.valid ? s.rounding(p) : nothing;
    }
    static sgt_interval enclose(const void *self, const sgt_ray *ray, sgt_interval t, sgt_interval *slope)
    {
        S s(self);
        *slope = sgt_interval_all();
        return s.valid ? s.enclose(*ray, t, slope) : sgt_interval_all();
    }
    static size_t parameters(const void *) { return 1; }
    static void by_parameter(const void *self, size_t, size_t n, sgt_points, sgt_values out)
    {
        S s(self);
        for (size_t i = 0; i < n; i++) {
            out.f[i] = s.valid ? s.by_parameter() : nothing;
            if (out.grad[0]) out.grad[0][i] = out.grad[1][i] = out.grad[2][i] = 0;
        }
    }
    static constexpr sgt_surface_ops named(const char *name)
    {
        sgt_surface_ops ops = {};
        ops.name = name, ops.value = value, ops.values = values, ops.rounding = rounding,
        ops.enclose = enclose;
        ops.span = span, ops.spans = spans, ops.first = first, ops.firsts = firsts;
        ops.parameters = parameters, ops.by_parameter = by_parameter;
        return ops;
    }
};

// The checks of parameters for the rows of the table (sgt_builtin.object).
sgt_objection object_to_geodetic_height(const void *self), object_to_level_gravity(const void *self),
    object_to_geoid_height(const void *self);

} // namespace geo

#endif
