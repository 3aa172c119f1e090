// SPDX-License-Identifier: MIT
// draw.h - random surfaces and rays, a tenth of them hard, each with the name of its kind.
#ifndef PROOF_DRAW_H
#define PROOF_DRAW_H

#include "../oracle/cases.h"
#include "../oracle/levels.h"

#include <string>

namespace proof {

using oracle::generator;
using oracle::rough_sag;

struct subject {
    bool is_level = false, asphere = false;
    sgt_even_asphere s = {}; // a conic is one without terms
    oracle::level f = {};
    double h = 1;       // the aperture; of a level set a length
    std::string kind;
    sgt_conic conic = {};
    sgt_mandelbrot m = {};

    sgt_surface surface()
    {
        if (is_level) return as_surface(f, &m);
        conic = {s.c, s.k, s.semi_diameter};
        return asphere ? sgt_surface{&sgt_even_asphere_ops, &s} : sgt_surface{&sgt_conic_ops, &conic};
    }
};

inline double domain_of(const sgt_even_asphere &s)
{
    const double e = (1 + s.k) * s.c * s.c;
    return e > 0 ? 1 / std::sqrt(e) : HUGE_VAL;
}

// Of any size; or of about the size of `like`.
inline subject random_optical(generator &g, double like = 0)
{
    subject t;
    sgt_even_asphere &s = t.s;
    const double R = g.sign() * (like > 0 ? like * g.log_uniform(0.5, 50) : g.log_uniform(1e-3, 1e6));
    s.c = 1 / R;
    switch (g.below(6)) {
    case 0: s.c = 0, t.kind = "plane"; break;
    case 1: t.kind = "sphere"; break;
    case 2: s.k = g.uniform(-0.999, 1), t.kind = "ellipsoid"; break;
    case 3: s.k = g.chance(0.7) ? -1 : -1 + g.sign() * 1e-12, t.kind = "paraboloid"; break;
    case 4: s.k = -1 - g.log_uniform(1e-3, 1e3), t.kind = "hyperboloid"; break;
    default: s.k = g.log_uniform(1e-3, 1e3), t.kind = "oblate"; break;
    }
    const double domain = domain_of(s);
    t.h = s.c == 0 ? std::fabs(R)
                   : std::fmin(std::fabs(R) * g.log_uniform(0.01, 3), domain * g.uniform(0.05, 0.98));
    if (g.chance(0.5)) s.semi_diameter = t.h;
    t.asphere = g.chance(0.45);
    if (t.asphere) {
        const int terms = 1 + g.below(8);
        const double most = g.chance(0.5) ? 0.02 : 0.1;
        for (int i = 0; i < terms; i++)
            if (i == terms - 1 || g.chance(0.8))
                s.a[i] = g.uniform(-most, most) * t.h / std::pow(t.h, 2 * i + 2);
        t.kind = "asphere";
    }
    return t;
}

inline double slope_at(const sgt_even_asphere &s, double r) // ds/dr
{
    const double r2 = r * r, u = 1 - (1 + s.k) * s.c * s.c * r2;
    double slope = u > 0 ? s.c / std::sqrt(u) : HUGE_VAL, power = 1;
    for (int i = 0; i < 8; i++, power *= r2) slope += (2 * i + 2) * s.a[i] * power;
    return slope * r;
}

inline void set_ends(generator &g, sgt_ray *ray, double away, double unit)
{
    const int kind = g.below(5);
    if (kind < 2) return; // the half-line
    if (kind == 2) {
        ray->tmin = -HUGE_VAL, ray->tmax = HUGE_VAL;
        return;
    }
    ray->tmin = away + g.sign() * unit * g.log_uniform(1e-4, 10);
    ray->tmax = ray->tmin + unit * g.log_uniform(1e-2, 100);
    if (ray->tmin == 0 && ray->tmax == 0) ray->tmax = 1;
    if (g.chance(0.2)) ray->tmin = -HUGE_VAL;
    else if (g.chance(0.2)) ray->tmax = HUGE_VAL;
}

inline sgt_vec3 less_by(const sgt_vec3 &p, double t, const sgt_vec3 &d)
{
    return {p.x - t * d.x, p.y - t * d.y, p.z - t * d.z};
}

inline sgt_ray ordinary_ray(generator &g, const subject &t)
{
    const double pi = 3.141592653589793,
                 r = t.h * (g.chance(0.8) ? 0.99 * std::sqrt(g.uniform(0, 1)) : 1 + g.log_uniform(1e-3, 2)),
                 at = g.uniform(0, 2 * pi);
    const sgt_vec3 target = {r * std::cos(at), r * std::sin(at),
                             rough_sag(t.s, std::fmin(r, t.h) * std::fmin(r, t.h))};
    const double tilt = g.chance(0.05) ? 0 : g.uniform(0, g.chance(0.8) ? 40 : 85) * pi / 180,
                 about = g.uniform(0, 2 * pi), length = g.chance(0.5) ? 1 : g.log_uniform(1e-3, 1e3);
    sgt_ray ray = {};
    ray.d = {length * std::sin(tilt) * std::cos(about), length * std::sin(tilt) * std::sin(about),
             g.sign() * length * std::cos(tilt)};
    const double away = g.sign() * t.h * g.log_uniform(1e-2, 1e3) / length;
    ray.o = less_by(target, away, ray.d);
    if (away > 0 || g.chance(0.7)) set_ends(g, &ray, away, t.h / length);
    return ray;
}

// A hard one; may change the rim of the surface.
inline sgt_ray hard_ray(generator &g, subject *t, std::string *kind)
{
    const double pi = 3.141592653589793;
    sgt_even_asphere &s = t->s;
    sgt_ray ray = ordinary_ray(g, *t);
    const double length = std::sqrt(ray.d.x * ray.d.x + ray.d.y * ray.d.y + ray.d.z * ray.d.z),
                 at = g.uniform(0, 2 * pi);
    switch (g.below(8)) {
    case 0: { // in the tangent plane, and lifted off it, or turned out of it
        *kind = "tangent";
        const double r = t->h * (g.chance(0.1) ? 0 : std::sqrt(g.uniform(0, 1))), slope = slope_at(s, r),
                     m = std::sqrt(1 + slope * slope), about = g.uniform(0, 2 * pi);
        const double lift = g.chance(0.2) ? 0 : g.sign() * g.log_uniform(1e-17, 1e-12),
                     turn = g.chance(0.5) ? 0 : g.sign() * g.log_uniform(1e-17, 1e-12);
        const double out = std::cos(about) / m - turn * slope / m, across = std::sin(about),
                     axial = std::cos(about) * slope / m + turn / m;
        const double size = s.c != 0 ? std::fmin(t->h, 1 / std::fabs(s.c)) : t->h,
                     along = -lift * size * slope / m;
        const sgt_vec3 target = {(r + along) * std::cos(at), (r + along) * std::sin(at),
                                 rough_sag(s, r * r) + lift * size / m};
        ray.d = {length * (out * std::cos(at) - across * std::sin(at)),
                 length * (out * std::sin(at) + across * std::cos(at)), length * axial};
        ray.o = less_by(target, (g.chance(0.1) ? 0 : g.sign() * t->h * g.log_uniform(1e-3, 10)) / length,
                        ray.d);
        ray.tmin = -HUGE_VAL, ray.tmax = HUGE_VAL;
        if (g.chance(0.4)) ray.tmin = ray.tmax = 0;
        break;
    }
    case 1: { // two roots close to one another, across the vertex: the chord at height z, exactly
        *kind = "pair";
        static const double ways[][2] = {{1, 0}, {0, 1}, {-1, 0}, {0.75, 1}, {0.5, -1}, {1, 1}};
        const double *way = ways[g.below(6)], curvature = s.c + 2 * s.a[0],
                     apart = t->h * g.log_uniform(1e-18, 1e-9);
        if (curvature == 0) break;
        const double z = curvature * apart * apart * 0.125,
                     shift = g.chance(0.5) ? 0 : apart * g.log_uniform(1e-3, 0.7);
        const double back = g.chance(0.2) ? 0 : std::ldexp(g.sign(), g.below(12) - 6 + std::ilogb(t->h));
        ray.d = {way[0], way[1], g.chance(0.7) ? 0 : z / t->h * g.uniform(-1, 1)};
        ray.o = {-back * way[0], -back * way[1], z * (g.chance(0.3) ? 1 + g.uniform(-1, 1) : 1)};
        if (back == 0) ray.o.x += shift * way[1], ray.o.y -= shift * way[0];
        ray.tmin = -HUGE_VAL, ray.tmax = HUGE_VAL;
        if (g.chance(0.4)) ray.tmin = ray.tmax = 0;
        break;
    }
    case 2: { // from a point just computed, on
        *kind = "start";
        ray.tmin = -HUGE_VAL, ray.tmax = HUGE_VAL;
        const sgt_hit h = sgt_intersect(t->surface(), ray, nullptr);
        if (h.status <= 0) break;
        if (g.chance(0.4)) { // or where an end is the root itself, or an ulp from it
            const double end = h.t + (g.chance(0.5) ? g.below(9) - 4 : 0) * 0x1p-53 * std::fabs(h.t);
            if (g.chance(0.5) || end == 0) ray.tmin = end, ray.tmax = HUGE_VAL;
            else ray.tmax = end;
            break;
        }
        const sgt_ray next = ordinary_ray(g, *t);
        if (g.chance(0.5)) ray.d = next.d; // else toward another point of the surface
        else {
            const double r = t->h * std::sqrt(g.uniform(0, 1));
            ray.d = {r * std::cos(at) - h.p.x, r * std::sin(at) - h.p.y, rough_sag(s, r * r) - h.p.z};
        }
        ray.o = h.p;
        ray.tmin = 0, ray.tmax = g.chance(0.5) ? 0 : t->h * 3;
        break;
    }
    case 3: { // the root next to the rim
        *kind = "rim";
        ray.tmin = -HUGE_VAL, ray.tmax = HUGE_VAL;
        const double before = s.semi_diameter;
        s.semi_diameter = 0;
        const sgt_hit h = sgt_intersect(t->surface(), ray, nullptr);
        s.semi_diameter = before;
        if (h.status <= 0) break;
        const double r = std::hypot(h.p.x, h.p.y) / std::sqrt(1 + 0x1p-44);
        s.semi_diameter = r * (1 + (g.chance(0.5) ? g.below(9) - 4 : 0) * 0x1p-52);
        if (g.chance(0.5)) s.semi_diameter *= 1 + g.sign() * g.log_uniform(1e-16, 1e-12);
        break;
    }
    case 4: { // near the edge of the domain
        *kind = "equator";
        const double domain = domain_of(s);
        if (!(domain < HUGE_VAL)) break;
        for (int i = 0; i < 8; i++) s.a[i] *= std::pow(t->h / domain, 2 * i + 1); // as tame there as at h
        const double r = domain * (1 - (g.chance(0.1) ? 0 : g.log_uniform(1e-17, 1e-4)));
        s.semi_diameter = g.chance(0.5) ? 0 : r * 1.1;
        const sgt_vec3 target = {r * std::cos(at), r * std::sin(at), rough_sag(s, r * r)};
        if (g.chance(0.3)) ray.d = {0, 0, length};
        ray.o = less_by(target, g.sign() * t->h * g.log_uniform(1e-3, 1e2) / length, ray.d);
        ray.tmin = -HUGE_VAL, ray.tmax = HUGE_VAL;
        break;
    }
    case 5:
    case 6: { // from far away
        *kind = "far";
        const sgt_vec3 target = {ray.o.x, ray.o.y, ray.o.z};
        const double away = g.log_uniform(1e3, 1e12) * t->h / length;
        sgt_hit h = sgt_intersect(t->surface(), {target, ray.d, -HUGE_VAL, HUGE_VAL}, nullptr);
        ray.o = less_by(h.status > 0 ? h.p : target, away, ray.d);
        ray.tmin = ray.tmax = 0;
        break;
    }
    default: { // (nearly) along the axes
        *kind = "parallel";
        double *const v[3] = {&ray.d.x, &ray.d.y, &ray.d.z};
        *v[g.below(3)] = g.chance(0.4) ? 0 : g.sign() * length * g.log_uniform(1e-20, 1e-8);
        if (g.chance(0.3)) *v[g.below(2)] = 0;
        if (ray.d.x == 0 && ray.d.y == 0 && ray.d.z == 0) ray.d.z = 1;
        const double r = t->h * std::sqrt(g.uniform(0, 1));
        const sgt_vec3 target = {r * std::cos(at), r * std::sin(at), rough_sag(s, r * r)};
        ray.o = less_by(target, g.sign() * t->h * g.log_uniform(1e-2, 1e2) / length, ray.d);
        ray.tmin = -HUGE_VAL, ray.tmax = HUGE_VAL;
        break;
    }
    }
    return ray;
}

inline subject random_level_set(generator &g)
{
    subject t;
    t.is_level = true;
    t.f = oracle::random_level(g);
    t.h = 1 / oracle::axis_length(t.f);
    t.kind = t.f.mandelbrot ? "mandelbrot" : "julia";
    return t;
}

inline sgt_ray hard_level_ray(generator &g, subject *t, std::string *kind)
{
    sgt_ray ray = oracle::random_ray(g, t->f);
    const sgt_surface s = t->surface();
    const double length = std::sqrt(ray.d.x * ray.d.x + ray.d.y * ray.d.y + ray.d.z * ray.d.z);
    if (g.chance(0.3)) {
        *kind = "start";
        const sgt_hit h = sgt_intersect(s, ray, nullptr);
        if (h.status <= 0) return ray;
        ray = oracle::random_ray(g, t->f);
        ray.o = h.p;
        ray.tmin = ray.tmax = 0;
        return ray;
    }
    if (g.chance(0.3)) {
        *kind = "far";
        const double away = g.log_uniform(10, 1e9) * t->h / length;
        ray.o = less_by(ray.o, away, ray.d);
        return ray;
    }
    // Shifted until it nearly touches: one that meets it and one that does not, halved.
    *kind = "tangent";
    const sgt_vec3 aside = oracle::random_way(g);
    double met = NAN, missed = NAN;
    for (int i = 0; i < 20 && !(met == met && missed == missed); i++) {
        const double by = g.uniform(-2, 2) * t->h;
        const sgt_hit h = sgt_intersect(s, {less_by(ray.o, by, aside), ray.d, 0, 0}, nullptr);
        (h.status > 0 ? met : missed) = by;
    }
    if (!(met == met && missed == missed)) return ray;
    for (int i = 0, n = 20 + g.below(36); i < n; i++) {
        const double by = 0.5 * (met + missed);
        const sgt_hit h = sgt_intersect(s, {less_by(ray.o, by, aside), ray.d, 0, 0}, nullptr);
        (h.status > 0 ? met : missed) = by;
    }
    ray.o = less_by(ray.o, g.chance(0.5) ? met : missed, aside);
    return ray;
}

} // namespace proof
#endif
