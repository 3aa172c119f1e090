// SPDX-License-Identifier: MIT
// earth.cpp - the height over an ellipsoid, and the two ellipsoids between which a ray's roots lie.
#include "earth.hpp"

#include <GeographicLib/Math.hpp>

namespace geo {

using GeographicLib::Math;

ellipsoid::ellipsoid(double a_, double f_)
    : a(a_), f(f_), b(a_ * (1 - f_)), most(std::fmax(a, b)), least(a < b ? a * (a / b) : b * (b / a)),
      geocentric(a_, f_)
{
}

const ellipsoid &wgs84()
{
    static const ellipsoid earth(6378137, 1 / 298.257223563);
    return earth;
}

double ellipsoid::vertical(double sine) const { return a / std::sqrt(1 - f * (2 - f) * sine * sine); }

double ellipsoid::meridian(double sine) const
{
    double w2 = 1 - f * (2 - f) * sine * sine;
    return a * (1 - f) * (1 - f) / (w2 * std::sqrt(w2));
}

foot ellipsoid::below(const sgt_vec3 &p) const
{
    foot q;
    double height, c, s;
    geocentric.Reverse(p.x, p.y, p.z, q.latitude, q.longitude, height);
    Math::sincosd(q.latitude, s, c);
    double r = std::hypot(p.x, p.y), z = (1 - f) * s, sigma = a * std::sqrt(c * c + z * z);
    q.sin_latitude = s, q.cos_latitude = c;
    q.cos_longitude = r > 0 ? p.x / r : 1, q.sin_longitude = r > 0 ? p.y / r : 0;
    q.h = sgt_fma(c, r, sgt_fma(s, p.z, -sigma));
    q.up = {c * q.cos_longitude, c * q.sin_longitude, s};
    return q;
}

shell shell_of(const ellipsoid &e, double h)
{
    shell s = {e.a + h, e.b + h, 1, 1};
    double thin = std::fmin(s.a, s.b),
           k = std::fabs(h) * (e.a - e.b) * (e.a - e.b) / (2 * std::fmin(e.a, e.b) * thin * thin);
    if (h >= 0) s.outer = std::sqrt(1 + k);
    else s.inner = k < 1 ? std::sqrt(1 - k) : 0;
    return s;
}

// Works in the frame where the ellipsoid is the unit sphere and the ray is q + t e, from the ray's point
// nearest the centre.  The error of its distance is at most 32 units of 2^-53 |q|, that of its t 16 units of
// 2^-53 |q| / |e|.  The slack is 2^11 times as large.
chord chord_of(const shell &s, const sgt_ray &ray)
{
    chord c = {};
    int power;
    std::frexp(std::fmax(std::fabs(ray.d.x), std::fmax(std::fabs(ray.d.y), std::fabs(ray.d.z))), &power);
    double scale = std::ldexp(1.0, -power); // the ray's own t = (t of the scaled direction) scale
    if (!(scale > 0 && scale < infinity)) return c;
    sgt_vec3 q = {ray.o.x / s.a, ray.o.y / s.a, ray.o.z / s.b};
    sgt_vec3 e = {ray.d.x * scale / s.a, ray.d.y * scale / s.a, ray.d.z * scale / s.b};
    double far = length(q), fast = length(e), slack = 0x1p-37 * (far / fast + 1 / fast);
    double middle = -(dot(q, e) / dot(e, e));
    sgt_vec3 n = {sgt_fma(middle, e.x, q.x), sgt_fma(middle, e.y, q.y), sgt_fma(middle, e.z, q.z)};
    double off = length(n), doubt = 0x1p-47 * (far + 1), near = (off - doubt) / s.outer,
           deep = s.inner > 0 ? (off + doubt) / s.inner : 2;
    if (!(far < 1e150 && fast > 1e-150 && slack < infinity)) return c;
    c.known = true;
    c.by = near > 1;
    if (c.by) return c;
    double half = std::sqrt(1 - (near > 0 ? near * near : 0)) * s.outer / fast + slack;
    c.lo = (middle - half) * scale, c.hi = (middle + half) * scale, c.middle = middle * scale;
    c.in = infinity, c.out = -infinity;
    if (deep < 1) {
        double inside = std::sqrt(1 - deep * deep) * s.inner / fast - slack;
        if (inside > 0) {
            c.in = (middle - inside) * scale, c.out = (middle + inside) * scale;
            c.depth = (1 - deep) * s.inner * std::fmin(s.a, s.b);
        }
    }
    double own = off < 1 ? std::sqrt(1 - off * off) / fast : 0;
    c.entry = (middle - own) * scale, c.exit = (middle + own) * scale;
    return c;
}

sgt_interval convex(sgt_interval t, const reading &from, const reading &to, sgt_interval *slope)
{
    double w = (t.hi - t.lo) * (1 - 0x1p-50), fall = from.slope - from.slope_err,
           rise = to.slope + to.slope_err; // the rounding of w, either way, is inside the margin
    double p = from.g - from.g_err, q = to.g - to.g_err,
           high = std::fmax(from.g + from.g_err, to.g + to.g_err), low;
    *slope = {fall, rise};
    if (!(p > -infinity && q > -infinity && high < infinity)) return sgt_interval_all();
    if (fall >= 0) low = p;
    else if (rise <= 0) low = q;
    else if (fall > -infinity && rise < infinity)
        low = (p * rise - q * fall + fall * rise * w) / (rise - fall) +
              0x1p-47 * (fall * w - std::fabs(p) - std::fabs(q));
    else low = -infinity;
    low = std::fmin(low, std::fmin(p, q)); // rounding of the tangents must not put the bound above the ends
    return {std::isnan(low) ? -infinity : low, high};
}

} // namespace geo
