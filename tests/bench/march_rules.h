// SPDX-License-Identifier: MIT
// march_rules.h - how to find the first root along a ray: the ways a person would write by hand, orbit and
// all.
//
// The surface is |Q_N| = E, Q_{j+1} = Q_j^2 + c from Q_0 = (x, y, z, 0).  It lies in the ball of radius E;
// the ray starts outside, its direction of unit length.  All the rules begin where it enters the ball and
// give up where it leaves.  They differ in the step:
//
//     constant     dt                          blind to parts thinner than dt
//     estimate     max(e, dt_min)              e estimates the distance to the surface; it is no bound
//     newton       max(e, Newton, dt_min)      the classic recipe: near a graze the slope is small and
//                  Newton's step
//                                              leaps over what lies behind, however small dt_min is
//     stop         e, until e < eps            distance-estimator rendering: no sign is looked at, so a ray
//                                              that passes near the surface has hit it, and t is early
//
// The first three look for a change of sign, and solve for the root between the two points (sgt_root, to
// rounding).  The estimate is Hart's, |Q| log(|Q|/E) / (2 |Q'|), |Q'| = 2^n |Q_0| ... |Q_{n-1}|.  Newton's
// step is that of g = |Q_N|^2 - E^2: -g/g', g' = 2 <Q, v>, v = dQ/dt.  An orbit is left as soon as |Q_n| >
// 1000 E; each further level would halve Newton's step (to first order in c/|Q|^2) and hardly change the
// estimate.
//
// Every rule ends with the gradient at the hit.  An evaluation is one orbit.
#ifndef BENCH_MARCH_RULES_H
#define BENCH_MARCH_RULES_H

#include <algorithm>
#include <cmath>
#include <limits>
#include <sagitta/sagitta.h>
#include <sagitta/surfaces.h>

namespace march {

const double NONE = std::numeric_limits<double>::quiet_NaN();

struct Answer { bool hit; double t; sgt_vec3 n; long evals; };

inline sgt_vec3 along(const sgt_ray &ray, double t)
{
    return { ray.o.x + t * ray.d.x, ray.o.y + t * ray.d.y, ray.o.z + t * ray.d.z };
}

inline double dot(sgt_vec3 a, sgt_vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

// Where the ray is in the ball; lo > hi: nowhere.
inline sgt_span ball(const sgt_ray &ray, double radius)
{
    double middle = -dot(ray.o, ray.d);
    sgt_vec3 nearest = along(ray, middle);
    double half2 = radius * radius - dot(nearest, nearest);
    if (!(half2 >= 0))
        return { 1, -1, NONE, false };
    return { std::max(middle - std::sqrt(half2), 0.0), middle + std::sqrt(half2), NONE, false };
}

struct Orbit {
    double norm2, slope;  // |Q_n|^2; <Q_n, v>, if it was wanted
    double growth2;       // |Q'|^2, if it was wanted
    int left;             // N - n
};

// What is not wanted is not worked out: the flags are known when this is compiled.
template <bool with_slope, bool with_growth>
Orbit orbit(const sgt_julia &s, const sgt_ray &ray, double t, double most)
{
    sgt_vec3 p = along(ray, t);
    double x = p.x, y = p.y, z = p.z, w = 0, vx = ray.d.x, vy = ray.d.y, vz = ray.d.z, vw = 0;
    Orbit r = { x * x + y * y + z * z, 0, 1, s.iterations };
    for (; r.left > 0 && r.norm2 < most; r.left--) {
        if (with_growth)
            r.growth2 *= 4 * r.norm2;
        if (with_slope) {
            double v = 2 * (x * vx - y * vy - z * vz - w * vw);
            vy = 2 * (x * vy + y * vx);
            vz = 2 * (x * vz + z * vx);
            vw = 2 * (x * vw + w * vx);
            vx = v;
        }
        double a = x * x - (y * y + z * z + w * w) + s.c[0];
        y = 2 * x * y + s.c[1];
        z = 2 * x * z + s.c[2];
        w = 2 * x * w + s.c[3];
        x = a;
        r.norm2 = x * x + y * y + z * z + w * w;
    }
    if (with_slope)
        r.slope = x * vx + y * vy + z * vz + w * vw;
    return r;
}

inline double far_out(const sgt_julia &s) { return 1e6 * s.escape * s.escape; }

inline double estimate(const sgt_julia &s, const Orbit &r)
{
    double u = r.norm2 / (s.escape * s.escape);
    return u > 1 ? 0.25 * std::log(u) * std::sqrt(r.norm2 / r.growth2) : 0;
}

inline Answer nothing(long evals) { return { false, NONE, { NONE, NONE, NONE }, evals }; }

// With the gradient, as the library gives it.
inline Answer met(const sgt_julia &s, const sgt_ray &ray, double t, long evals)
{
    Answer answer = { true, t, { 0, 0, 0 }, evals + 1 };
    sgt_julia_ops.value(&s, along(ray, t), &answer.n);
    return answer;
}

// The sign changes between lo and hi.  What is solved is (u - 1)/(u + 1), u = |Q_N|^2/E^2, which does not
// overflow.
inline Answer polish(const sgt_julia &s, const sgt_ray &ray, double lo, double hi, long evals)
{
    sgt_root r = sgt_root_begin({ lo, hi, NONE, false }, nullptr);
    double f, slope, E2 = s.escape * s.escape;
    do {
        Orbit at = orbit<true, false>(s, ray, r.t, 1e100);
        double below = at.norm2 + E2;
        f = (at.norm2 - E2) / below;
        slope = 4 * at.slope / below * (E2 / below);
        evals++;
    } while (sgt_root_next(&r, f, slope));
    return r.status > 0 ? met(s, ray, r.t, evals) : nothing(evals);
}

// The rules that look for a change of sign; step(r) says how far to go from where the orbit is r.
template <bool with_slope, bool with_growth, class Step>
Answer by_sign(const sgt_julia &s, const sgt_ray &ray, Step step)
{
    sgt_span inside = ball(ray, s.escape);
    if (!(inside.lo <= inside.hi))
        return nothing(0);
    double most = far_out(s), E2 = s.escape * s.escape, t = inside.lo;
    Orbit r = orbit<with_slope, with_growth>(s, ray, t, most);
    long evals = 1;
    while (t < inside.hi) {
        double next = std::min(t + step(r), inside.hi);
        Orbit r_next = orbit<with_slope, with_growth>(s, ray, next, most);
        evals++;
        if ((r.norm2 < E2) != (r_next.norm2 < E2))
            return polish(s, ray, t, next, evals);
        t = next;
        r = r_next;
    }
    return nothing(evals);
}

inline Answer constant(const sgt_julia &s, const sgt_ray &ray, double dt)
{
    return by_sign<false, false>(s, ray, [&](const Orbit &) { return dt; });
}

inline Answer estimate_or_least(const sgt_julia &s, const sgt_ray &ray, double dt_min)
{
    return by_sign<false, true>(s, ray, [&](const Orbit &r) { return std::fmax(estimate(s, r), dt_min); });
}

inline Answer estimate_newton_or_least(const sgt_julia &s, const sgt_ray &ray, double dt_min)
{
    return by_sign<true, true>(s, ray, [&](const Orbit &r) {
        double newton = -std::ldexp((r.norm2 - s.escape * s.escape) / (2 * r.slope), -r.left);
        return std::fmax(std::fmax(estimate(s, r), newton), dt_min);
    });
}

inline Answer stop_when_near(const sgt_julia &s, const sgt_ray &ray, double eps)
{
    sgt_span inside = ball(ray, s.escape);
    double most = far_out(s);
    long evals = 0;
    for (double t = inside.lo; t <= inside.hi && evals < 100000;) {
        double e = estimate(s, orbit<false, true>(s, ray, t, most));
        evals++;
        if (!(e >= eps))
            return met(s, ray, t, evals);
        t += e;
    }
    return nothing(evals);
}

} // namespace march
#endif
