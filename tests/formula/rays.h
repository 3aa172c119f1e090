// SPDX-License-Identifier: MIT
// rays.h - rays of every kind toward a written formula.  Nothing of the library is asked.
#ifndef FORMULA_RAYS_H
#define FORMULA_RAYS_H

#include "oracle.h"
#include "../oracle/cases.h"

namespace formula
{

using oracle::generator;

static const char *const ray_kinds[] = {"through", "inside", "far",  "parallel", "special",
                                        "grazing", "start",  "ends", "scaled"};
enum { kinds_of_rays = 9 };

inline sgt_vec3 plus(const sgt_vec3 &p, double by, const sgt_vec3 &d)
{
    return {p.x + by * d.x, p.y + by * d.y, p.z + by * d.z};
}
inline double inner(const sgt_vec3 &a, const sgt_vec3 &b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline sgt_vec3 scaled_to(const sgt_vec3 &a, double length)
{
    const double by = length / std::sqrt(inner(a, a));
    return {a.x * by, a.y * by, a.z * by};
}
inline sgt_vec3 random_way(generator &g)
{
    for (;;) {
        const sgt_vec3 v = {g.uniform(-1, 1), g.uniform(-1, 1), g.uniform(-1, 1)};
        const double l = inner(v, v);
        if (l < 1 && l > 1e-3) return scaled_to(v, 1);
    }
}
inline sgt_vec3 random_point(generator &g, const place &w)
{
    if (w.rim > 0) {
        const double r = w.rim * std::sqrt(g.uniform(0, 1)), at = g.uniform(0, 6.283185307179586);
        return {r * std::cos(at), r * std::sin(at), w.reach * g.uniform(-1, 1)};
    }
    if (w.ball > 0) return plus({0, 0, 0}, w.ball * std::cbrt(g.uniform(0, 1)), random_way(g));
    return {w.box[0] * g.uniform(-1, 1), w.box[1] * g.uniform(-1, 1), w.box[2] * g.uniform(-1, 1)};
}

// A point of the surface, as near as doubles are; false: none was met on some random lines.
inline bool point_of(generator &g, const written &f, sgt_vec3 *p, sgt_vec3 *n)
{
    for (int attempt = 0; attempt < 20; attempt++) {
        const sgt_vec3 o = random_point(g, f.where), d = random_way(g);
        const sgt_span all = chord_of(f.where, {o, d, 0, 0});
        if (!(all.lo < all.hi)) continue;
        double last = NAN, before = all.lo;
        const double from = g.uniform(0, 1);
        for (int i = 0; i <= 100; i++) {
            const double t = all.lo + (all.hi - all.lo) * (i + from) / 101;
            const double v = value_at(f, plus(o, t, d), nullptr, true);
            if (last * v < 0) {
                double lo = before, hi = t;
                for (int k = 0; k < 60; k++) {
                    const double m = 0.5 * (lo + hi);
                    (value_at(f, plus(o, m, d), nullptr, true) * last > 0 ? lo : hi) = m;
                }
                *p = plus(o, lo, d);
                const double off = value_at(f, *p, n, true), steep = std::sqrt(inner(*n, *n));
                if (std::fabs(off) < 1e-9 * steep * f.where.size() && steep < HUGE_VAL) return true;
            }
            last = v, before = t;
        }
    }
    return false;
}

inline sgt_ray random_ray(generator &g, const written &f, int kind)
{
    const double size = f.where.size(), infinity = HUGE_VAL;
    const sgt_vec3 at = random_point(g, f.where);
    sgt_vec3 d = random_way(g), p, n;
    sgt_ray ray = {plus(at, -size * g.uniform(2, 5), d), d, 0, infinity};
    switch (kind) {
    case 1:
        ray.o = at;
        break;
    case 2:
        ray.o = plus(at, -size * g.log_uniform(1e2, 1e9), d);
        break;
    case 3: {
        double *const v[3] = {&ray.d.x, &ray.d.y, &ray.d.z};
        ray.d = {0, 0, 0};
        const int axis = g.below(3);
        *v[axis] = g.sign();
        ray.o = at;
        if (g.chance(0.2)) (axis == 0 ? ray.o.y : ray.o.x) = 0;
        if (g.chance(0.2)) *v[(axis + 1) % 3] = g.sign() * (g.chance(0.5) ? 1 : g.log_uniform(1e-18, 1e-3));
        if (g.chance(0.8)) ray.o = plus(ray.o, -4 * size, ray.d);
        break;
    }
    case 4: {
        if (f.special.empty()) break;
        sgt_vec3 q = f.special[static_cast<std::size_t>(g.below(static_cast<int>(f.special.size())))];
        if (g.chance(0.4)) q = plus(q, size * g.log_uniform(1e-16, 1e-3), random_way(g));
        ray.o = plus(q, -size * g.uniform(1, 4), d);
        break;
    }
    case 5:
        if (!point_of(g, f, &p, &n)) break;
        d = random_way(g);
        d = plus(d, -inner(d, n) / inner(n, n), n);
        if (!(inner(d, d) > 1e-6)) break;
        d = scaled_to(d, 1);
        p = plus(p, g.chance(0.1) ? 0 : g.sign() * size * g.log_uniform(1e-15, 1e-2), scaled_to(n, 1));
        ray = {plus(p, -size * g.uniform(0, 4), d), d, 0, infinity};
        break;
    case 6:
        if (!point_of(g, f, &p, &n)) break;
        ray.o = p;
        break;
    case 7:
        ray.o = plus(at, -size * g.uniform(0, 3), d);
        if (g.chance(0.3))
            ray.tmin = -infinity;
        else
            ray.tmin = size * g.uniform(-3, 3);
        if (!g.chance(0.3)) ray.tmax = std::max(ray.tmin, 0.0) + size * g.uniform(0.01, 3);
        if (g.chance(0.3) && point_of(g, f, &p, &n)) { // an end on the surface, or beside it
            ray = {plus(p, -2 * size, d), d, 0, infinity};
            const double end = 2 * size + (g.chance(0.3) ? 0 : g.sign() * size * g.log_uniform(1e-16, 1e-3));
            (g.chance(0.5) ? ray.tmin : ray.tmax) = end;
        }
        break;
    case 8: {
        const double by = g.log_uniform(1e-4, 1e4);
        ray.d = scaled_to(d, by);
        if (g.chance(0.3)) ray.tmax = size * g.uniform(1, 6) / by;
        break;
    }
    default:
        break;
    }
    return ray;
}

} // namespace formula
#endif
