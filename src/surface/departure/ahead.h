// SPDX-License-Identifier: MIT
/* ahead.h - a function G of t along a ray, whose roots hold all roots of F: looked along from a point on, for
 * some rays at once (ahead.c). */
#ifndef SGT_SURFACE_DEPARTURE_AHEAD_H
#define SGT_SURFACE_DEPARTURE_AHEAD_H

#include "../../num/bits.h"
#include "../../num/lanes.h"
#include "departure.h"

/* What rounding can do: of a sum of at most 2^9 terms, and of as many factors, it is less than this part of
 * the sum of their magnitudes.  AHEAD_LEAST: underflow. */
#define AHEAD_LOST 0x1p-43
#define AHEAD_LEAST 0x1p-900

/* G and G' at t, to within err and slope_err; infinite or NaN: not known. */
typedef struct ahead_looks {
    ahead_row g, slope, err, slope_err;
} ahead_looks;

/* Over a stretch: G lies in [g_lo, g_hi], and G'' in [bend_lo, bend_hi].  none: 1 if F has no root in it,
 * whatever G has; else 0. */
typedef struct ahead_overs {
    ahead_row g_lo, g_hi, bend_lo, bend_hi, none;
} ahead_overs;

/* Of a root of F behind a point at which |F| is at most f: it is at most `width` behind; the terms of the
 * rule of the start are at least `terms` at it; and |K| at the point is at most `ratio` times that at the
 * root, where G = K F.  width NaN: not known. */
typedef struct ahead_starts {
    ahead_row width, terms, ratio;
} ahead_starts;

/* Each answers the rows from i up to n. */
typedef struct ahead_ops {
    void (*at)(const void *w, size_t i, size_t n, const double t[], ahead_looks *out);
    void (*over)(const void *w, size_t i, size_t n, const double from[], const double to[], ahead_overs *out);
    /* Has F certainly no root at t or beyond it?  1 or 0.  G has the sign `sign` at t; 0: not known. */
    void (*tail)(const void *w, size_t i, size_t n, const double t[], const double sign[], double none[]);
    /* |G'| is at least `least` from t on, as far as matters. */
    void (*start)(const void *w, size_t i, size_t n, const double t[], const double f[], const double least[],
                  ahead_starts *out);
} ahead_ops;

/* part: of a way with an end, the first step. */
void sgt_look_ahead(const ahead_ops *ops, const void *w, size_t n, double part, sgt_ahead *ahead);

/* How many rows are worked on, for n rays. */
SGT_INLINE size_t ahead_rows(size_t n) { return n > 1 ? AHEAD_ROWS : n; }

/* Is each number 0, or far from where a product of four of them underflows or overflows? */
SGT_INLINE mask ahead_usual(double x)
{
    return MASK(x == 0) | (MASK(fabs(x) > 0x1p-100) & MASK(fabs(x) < 0x1p100));
}

/* Takes away the rays that are not usual; all of them, if c or c_2 is not.  Such a ray ends nowhere. */
SGT_INLINE void ahead_drop_unusual(double c, double c_2, size_t n, sgt_ahead *e)
{
    for (size_t i = 0; i < n; i++) {
        mask all = ahead_usual(c) & ahead_usual(c_2);
        for (int j = 0; j < 3; j++) all &= ahead_usual(e->o[j][i]) & ahead_usual(e->d[j][i]);
        if (all == 0) e->to[i] = (double)NAN;
    }
}

/* The least and the greatest of |x|, `off` about it. */
SGT_INLINE sgt_interval ahead_about(double x, double off)
{
    double far = fabs(x);
    off += 0x1p-40 * far;
    return (sgt_interval){larger(far - off, 0), far + off};
}

/* ----------------------------------------------------- a polynomial in t, up to t^2 */

/* Its coefficients, and the sums of the magnitudes of what they are made of. */
typedef struct ahead_quadratic {
    double c0, c1, c2, m0, m1, m2;
} ahead_quadratic;

typedef struct ahead_quadratics {
    ahead_row c0, c1, c2, m0, m1, m2;
} ahead_quadratics;

SGT_INLINE ahead_quadratic ahead_quadratic_of(const ahead_quadratics *p, size_t i)
{
    return (ahead_quadratic){p->c0[i], p->c1[i], p->c2[i], p->m0[i], p->m1[i], p->m2[i]};
}

SGT_INLINE void ahead_quadratic_put(ahead_quadratics *to, size_t i, ahead_quadratic p)
{
    to->c0[i] = p.c0, to->c1[i] = p.c1, to->c2[i] = p.c2;
    to->m0[i] = p.m0, to->m1[i] = p.m1, to->m2[i] = p.m2;
}

/* o + t d. */
SGT_INLINE ahead_quadratic ahead_linear(double o, double d)
{
    return (ahead_quadratic){o, d, 0, fabs(o), fabs(d), 0};
}

/* (o + t d)^2. */
SGT_INLINE ahead_quadratic ahead_square(double o, double d)
{
    double twice = 2 * (o * d);
    return (ahead_quadratic){o * o, twice, d * d, o * o, fabs(twice), d * d};
}

/* k p. */
SGT_INLINE ahead_quadratic ahead_scaled(ahead_quadratic p, double k)
{
    double m = fabs(k);
    return (ahead_quadratic){k * p.c0, k * p.c1, k * p.c2, m * p.m0, m * p.m1, m * p.m2};
}

SGT_INLINE ahead_quadratic ahead_sum(ahead_quadratic p, ahead_quadratic q)
{
    return (ahead_quadratic){p.c0 + q.c0, p.c1 + q.c1, p.c2 + q.c2, p.m0 + q.m0, p.m1 + q.m1, p.m2 + q.m2};
}

SGT_INLINE double ahead_value(ahead_quadratic p, double t) { return (p.c2 * t + p.c1) * t + p.c0; }

/* At most what rounding does to its value at |t| = far, and nearer. */
SGT_INLINE double ahead_off(ahead_quadratic p, double far)
{
    return AHEAD_LOST * ((p.m2 * far + p.m1) * far + p.m0) + AHEAD_LEAST;
}

/* Its range.  `to` is finite. */
SGT_INLINE sgt_interval ahead_range(ahead_quadratic p, double from, double to)
{
    double a = ahead_value(p, from), b = ahead_value(p, to), turn = -0.5 * p.c1 / p.c2,
           at = ahead_value(p, turn);
    at = chosen(MASK(turn > from) & MASK(turn < to), at, a);
    double off = ahead_off(p, larger(fabs(from), fabs(to)));
    return (sgt_interval){smaller(smaller(a, b), at) - off, larger(larger(a, b), at) + off};
}

/* Has a sum the sign `sign`, or is nothing in it? */
SGT_INLINE mask ahead_signed(double c, double most, double sign)
{
    return MASK(most == 0) | MASK(sign * c > AHEAD_LOST * most + AHEAD_LEAST);
}

/* Has p the sign `sign`, or is it 0, at t and beyond it?  All its coefficients about t have. */
SGT_INLINE mask ahead_keeps(ahead_quadratic p, double t, double sign)
{
    double far = fabs(t), c1 = p.c1 + t * p.c2, m1 = p.m1 + far * p.m2;
    return ahead_signed(p.c0 + t * c1, p.m0 + far * m1, sign) &
           ahead_signed(c1 + t * p.c2, m1 + far * p.m2, sign) & ahead_signed(p.c2, p.m2, sign);
}

#endif
