// SPDX-License-Identifier: MIT
/* interval_lanes.h - intervals for loops over lanes.
 *
 * interval.h finds the nearest double outward; here an end is worked out to nearest and moved outward by a
 * bound, without a branch.  So a loop over lanes (lanes.h) becomes vector code.  Each function below takes
 * one lane; `lane_interval` holds the ends of INTERVAL_LANES of them.
 *
 * WHAT AN INTERVAL SAYS.  lo: no value is below.  hi: none is above.  An end that is infinite or NaN says
 * nothing.  An end once NaN stays so until an intersection, unless the operation has a bound by itself (a
 * sine, a square that is not negative), or the end has no part in the result (the larger argument of a
 * minimum).  Intervals are of the values where the operation has one: of sqrt, the part that is not negative.
 * If there is no such part at all, that is asked for beside the interval (ends_no_root ...), which means
 * nothing then.
 *
 * WIDENING.  u = 2^-53, e = 2^-1074.  Let r be the double nearest to v.
 *   - v is a sum of two doubles.  Then |v - r| <= u |r|, and if |r| < 2^-1021, v = r.  w = 2^-52 |r| is at
 *     least the distance to the next double on either side; if that product is rounded down, it is
 *     subnormal, r is below 2^-969, and w is a multiple of e that is still not below that distance (itself a
 *     multiple of e).  So r - w, rounded, is at most the next double below r, and v is above it.  If v = r =
 *     0, then w = 0.
 *   - v is a product, a quotient or a root.  Then |v - r| <= u |r| or, if r is subnormal, e/2.
 *     w = (u + 2^-105) |r| + e.  The first part is above half the distance to the next double; rounded it is
 *     at least that, and where the sum with e is rounded, it is above it (half a distance has one bit, so u +
 *     2^-105 of |r| is at least its next double).  So r - w is beyond the middle of r and its neighbour, and
 *     rounds to the neighbour at least.  Where |r| is below 2^-969, e is not lost, and w is at least the
 *     distance e, or half a greater one and e.
 *   - a function of functions.h is within `bound` u of v and e.  w = (bound + 2) u |r| + 2 e: 1 for the
 *     rounding of r - w, and 1 for all of the second order.
 *
 * INFINITY AND NaN.  min and max by a comparison drop a NaN if it comes first.  So where ends are compared, a
 * number `unknown` is added to the result: 0 times the sum of all ends, which is 0 if these are finite, and
 * else NaN.  (It is NaN for sums beyond the largest double, too.)  An end that overflows is infinite in its
 * own direction, which says nothing; toward the other side it becomes NaN in the widening, as w is infinite.
 * A sum needs no care: an end NaN or infinite stays so. */
#ifndef SGT_NUM_INTERVAL_LANES_H
#define SGT_NUM_INTERVAL_LANES_H

#include "functions.h"

#include <stdbool.h>

enum { INTERVAL_LANES = 16 };

typedef struct lane_interval {
    _Alignas(64) double lo[INTERVAL_LANES];
    double hi[INTERVAL_LANES];
} lane_interval;

/* Of one lane. */
typedef struct two_ends { double lo, hi; } two_ends;

#define LANE_LEAST 0x1p-1074
#define LANE_HALF_GAP 0x1.0000000000001p-53
#define LANE_OFF(bound) (((bound) + 2) * SGT_U)

/* Upper bounds of pi/2 and pi. */
#define LANE_HALF_PI 0x1.921fb54442d19p+0
#define LANE_PI 0x1.921fb54442d19p+1

SGT_INLINE two_ends ends_of(double lo, double hi) { return (two_ends){lo, hi}; }
SGT_INLINE two_ends ends_negative(two_ends a) { return ends_of(-a.hi, -a.lo); }

/* 0, or NaN if one of the numbers added up is not finite. */
SGT_INLINE double ends_unknown(double sum) { return sum * 0; }

/* The nearest to products, quotients or roots made ends.  NaN, if unknown is. */
SGT_INLINE two_ends ends_outward(double lo, double hi, double unknown)
{
    double least = LANE_LEAST + unknown;
    return ends_of(lo - (fabs(lo) * LANE_HALF_GAP + least), hi + (fabs(hi) * LANE_HALF_GAP + least));
}

/* The same of sums. */
SGT_INLINE two_ends ends_outward_sum(double lo, double hi)
{
    return ends_of(lo - fabs(lo) * 0x1p-52, hi + fabs(hi) * 0x1p-52);
}

/* The same of a function that is off by `off` of itself and by LANE_LEAST. */
SGT_INLINE two_ends ends_outward_by(double lo, double hi, double off)
{
    return ends_of(lo - (fabs(lo) * off + 2 * LANE_LEAST), hi + (fabs(hi) * off + 2 * LANE_LEAST));
}

/* The smaller and the larger of two numbers, of which neither is NaN or else the result is not used. */
SGT_INLINE double lesser_of(double a, double b) { return a < b ? a : b; }
SGT_INLINE double greater_of(double a, double b) { return a > b ? a : b; }

SGT_INLINE two_ends ends_of_four(double p, double q, double r, double s)
{
    return ends_of(lesser_of(lesser_of(p, q), lesser_of(r, s)),
                   greater_of(greater_of(p, q), greater_of(r, s)));
}

/* The numbers of the product, to nearest. */
SGT_INLINE two_ends ends_corners(two_ends a, two_ends b)
{
    return ends_of_four(a.lo * b.lo, a.lo * b.hi, a.hi * b.lo, a.hi * b.hi);
}

/* In [least, most], where all values are known to be; a NaN, too. */
SGT_INLINE two_ends ends_within(two_ends a, double least, double most)
{
    return ends_of(a.lo > least ? a.lo : least, a.hi < most ? a.hi : most);
}

/* ----------------------------------------------------------- sums and products */

SGT_INLINE two_ends ends_sum(two_ends a, two_ends b) { return ends_outward_sum(a.lo + b.lo, a.hi + b.hi); }

SGT_INLINE two_ends ends_difference(two_ends a, two_ends b)
{
    return ends_outward_sum(a.lo - b.hi, a.hi - b.lo);
}

SGT_INLINE two_ends ends_product(two_ends a, two_ends b)
{
    two_ends p = ends_corners(a, b);
    return ends_outward(p.lo, p.hi, ends_unknown((a.lo + a.hi) + (b.lo + b.hi)));
}

/* a b + c d, for the slope of a product.  The products are off by u of themselves and e/2, their sum and the
 * last difference by u of theirs: w is greater. */
SGT_INLINE two_ends ends_two_products(two_ends a, two_ends b, two_ends c, two_ends d)
{
    two_ends p = ends_corners(a, b), q = ends_corners(c, d);
    double sum = ((a.lo + a.hi) + (b.lo + b.hi)) + ((c.lo + c.hi) + (d.lo + d.hi));
    double least = 2 * LANE_LEAST + ends_unknown(sum);
    return ends_of((p.lo + q.lo) - ((fabs(p.lo) + fabs(q.lo)) * 0x1p-51 + least),
                   (p.hi + q.hi) + ((fabs(p.hi) + fabs(q.hi)) * 0x1p-51 + least));
}

/* a k, for a number k that is finite. */
SGT_INLINE two_ends ends_scaled(two_ends a, double k)
{
    double p = a.lo * k, q = a.hi * k;
    return ends_outward(k < 0 ? q : p, k < 0 ? p : q, 0);
}

/* The number of least magnitude, and that of the greatest. */
SGT_INLINE two_ends ends_absolute(two_ends a)
{
    double near = a.hi < 0 ? -a.hi : 0;
    near = a.lo > 0 ? a.lo : near;
    return ends_of(near, greater_of(-a.lo, a.hi) + ends_unknown(a.lo + a.hi));
}

SGT_INLINE two_ends ends_square(two_ends a)
{
    two_ends m = ends_absolute(a), s = ends_outward(m.lo * m.lo, m.hi * m.hi, 0);
    return ends_of(s.lo > 0 ? s.lo : 0, s.hi);
}

/* Two roundings. */
SGT_INLINE two_ends ends_cube(two_ends a)
{
    return ends_outward_by(a.lo * a.lo * a.lo, a.hi * a.hi * a.hi, LANE_OFF(2));
}

/* a k, where all of k is finite and above 0: an end of a that is not known leaves the other as it is. */
SGT_INLINE two_ends ends_product_positive(two_ends a, two_ends k)
{
    return ends_outward(lesser_of(a.lo * k.lo, a.lo * k.hi), greater_of(a.hi * k.lo, a.hi * k.hi), 0);
}

/* NaN, if 0 may be in a, or an end is NaN. */
SGT_INLINE two_ends ends_reciprocal(two_ends a)
{
    return ends_outward(1 / a.hi, 1 / a.lo, a.lo * a.hi > 0 ? 0 : (double)NAN);
}

SGT_INLINE two_ends ends_quotient(two_ends a, two_ends b) { return ends_product(a, ends_reciprocal(b)); }

/* The root of the part that is not negative; ends_no_root: there is none. */
SGT_INLINE two_ends ends_root(two_ends a)
{
    double low = a.lo > 0 ? a.lo : 0;
    two_ends r = ends_outward(sqrt(low), sqrt(a.hi), 0);
    return ends_of(r.lo > 0 ? r.lo : 0, r.hi);
}

SGT_INLINE bool ends_no_root(two_ends a) { return a.hi < 0; }

/* --------------------------------------------------------------- two of a kind */

SGT_INLINE two_ends ends_minimum(two_ends a, two_ends b)
{
    double hi = a.hi < b.hi ? a.hi : b.hi;
    return ends_of(lesser_of(a.lo, b.lo) + ends_unknown(a.lo + b.lo), b.hi == b.hi ? hi : a.hi);
}

SGT_INLINE two_ends ends_maximum(two_ends a, two_ends b)
{
    return ends_negative(ends_minimum(ends_negative(a), ends_negative(b)));
}

SGT_INLINE two_ends ends_hypotenuse(two_ends a, two_ends b)
{
    two_ends p = ends_absolute(a), q = ends_absolute(b);
    two_ends h = ends_outward_by(lane_hypot(p.lo, q.lo), lane_hypot(p.hi, q.hi), LANE_OFF(LANE_HYPOT_BOUND));
    return ends_of(h.lo > 0 ? h.lo : 0, h.hi);
}

/* 0 if the points (x, y) are all on one side of the cut y = 0, x <= 0, and away from it; else NaN. */
SGT_INLINE double ends_beside_cut(two_ends y, two_ends x)
{
    double beside = x.lo > 0 ? 0 : (double)NAN;
    beside = y.lo > 0 ? 0 : beside;
    return y.hi < 0 ? 0 : beside;
}

/* atan2(y, x).  The angle is greater than a given one on one side of a line through the origin.  So on a box
 * beside the cut, which lies in half of the plane, it has its extremes at corners. */
SGT_INLINE two_ends ends_angle(two_ends y, two_ends x)
{
    double p = lane_atan2(y.lo, x.lo), q = lane_atan2(y.lo, x.hi);
    double r = lane_atan2(y.hi, x.lo), s = lane_atan2(y.hi, x.hi);
    double unknown = ends_unknown((p + q) + (r + s)) + ends_beside_cut(y, x);
    two_ends a = ends_of_four(p, q, r, s);
    a = ends_outward_by(a.lo + unknown, a.hi + unknown, LANE_OFF(LANE_ATAN_BOUND));
    return ends_within(a, -LANE_PI, LANE_PI);
}

/* ------------------------------------------------------------------- functions */

SGT_INLINE two_ends ends_exp(two_ends a)
{
    two_ends e = ends_outward_by(lane_exp(a.lo), lane_exp(a.hi), LANE_OFF(LANE_EXP_BOUND));
    return ends_of(e.lo > 0 ? e.lo : 0, e.hi);
}

/* Of the part above 0; ends_no_log: there is none. */
SGT_INLINE two_ends ends_log(two_ends a)
{
    return ends_outward_by(lane_log(a.lo), lane_log(a.hi), LANE_OFF(LANE_LOG_BOUND));
}

SGT_INLINE bool ends_no_log(two_ends a) { return a.hi <= 0; }

/* May there be an integer k with from <= first + period k <= to?  `from` and `to` count quarter turns. */
SGT_INLINE bool ends_has_turn(double from, double to, double first, double per)
{
    double a = (from - first) * per, b = (to - first) * per, k = (a + LANE_SHIFT) - LANE_SHIFT;
    k = k < a ? k + 1 : k;
    return k <= b;
}

/* a in quarter turns, with a margin: 2 / pi and the product are off by 2 u, the differences in ends_has_turn
 * by another u and 3 u more.  (a is below 2^26, else it is not used.) */
SGT_INLINE two_ends ends_turns(two_ends a)
{
    double p = a.lo * 0x1.45f306dc9c883p-1, q = a.hi * 0x1.45f306dc9c883p-1;
    double margin = (fabs(p) + fabs(q)) * 0x1p-50 + 0x1p-50;
    return ends_of(p - margin, q + margin);
}

typedef struct ends_wave { two_ends sine, cosine; } ends_wave;

SGT_INLINE two_ends ends_of_wave(double a, double b, double unknown, bool top, bool bottom)
{
    double lo = lesser_of(a, b) + unknown, hi = greater_of(a, b) + unknown;
    two_ends w = ends_within(ends_outward_by(lo, hi, LANE_OFF(LANE_SIN_BOUND)), -1, 1);
    return ends_of(bottom ? -1 : w.lo, top ? 1 : w.hi);
}

SGT_INLINE ends_wave ends_sin_cos(two_ends a)
{
    lane_wave p = lane_sin_cos(a.lo), q = lane_sin_cos(a.hi);
    double unknown = ends_unknown(p.sine + q.sine);
    two_ends t = ends_turns(a);
    return (ends_wave){ends_of_wave(p.sine, q.sine, unknown, ends_has_turn(t.lo, t.hi, 1, 0.25),
                                    ends_has_turn(t.lo, t.hi, 3, 0.25)),
                       ends_of_wave(p.cosine, q.cosine, unknown, ends_has_turn(t.lo, t.hi, 0, 0.25),
                                    ends_has_turn(t.lo, t.hi, 2, 0.25))};
}

SGT_INLINE two_ends ends_tan(two_ends a)
{
    two_ends t = ends_turns(a);
    double p = lane_tan(a.lo), q = lane_tan(a.hi), unknown = ends_unknown(p + q);
    unknown = ends_has_turn(t.lo, t.hi, 1, 0.5) ? (double)NAN : unknown;
    return ends_outward_by(p + unknown, q + unknown, LANE_OFF(LANE_TAN_BOUND));
}

/* Of the part in [-1, 1]; ends_no_arc: there is none. */
SGT_INLINE two_ends ends_asin(two_ends a)
{
    two_ends x = ends_within(a, -1, 1);
    x = ends_outward_by(lane_asin(x.lo), lane_asin(x.hi), LANE_OFF(LANE_ASIN_BOUND));
    return ends_within(x, -LANE_HALF_PI, LANE_HALF_PI);
}

SGT_INLINE two_ends ends_acos(two_ends a)
{
    two_ends x = ends_within(a, -1, 1);
    x = ends_outward_by(lane_acos(x.hi), lane_acos(x.lo), LANE_OFF(LANE_ASIN_BOUND));
    return ends_within(x, 0, LANE_PI);
}

SGT_INLINE bool ends_no_arc(two_ends a) { return a.lo > 1 || a.hi < -1; }

SGT_INLINE two_ends ends_atan(two_ends a)
{
    two_ends x = ends_outward_by(lane_atan(a.lo), lane_atan(a.hi), LANE_OFF(LANE_ATAN_BOUND));
    return ends_within(x, -LANE_HALF_PI, LANE_HALF_PI);
}

SGT_INLINE two_ends ends_sinh(two_ends a)
{
    return ends_outward_by(lane_sinh(a.lo), lane_sinh(a.hi), LANE_OFF(LANE_SINH_BOUND));
}

SGT_INLINE two_ends ends_cosh(two_ends a)
{
    two_ends m = ends_absolute(a);
    two_ends c = ends_outward_by(lane_cosh(m.lo), lane_cosh(m.hi), LANE_OFF(LANE_SINH_BOUND));
    return ends_of(c.lo > 1 ? c.lo : 1, c.hi);
}

SGT_INLINE two_ends ends_tanh(two_ends a)
{
    return ends_within(ends_outward_by(lane_tanh(a.lo), lane_tanh(a.hi), LANE_OFF(LANE_TANH_BOUND)), -1, 1);
}

SGT_INLINE two_ends ends_cbrt(two_ends a)
{
    return ends_outward_by(lane_cbrt(a.lo), lane_cbrt(a.hi), LANE_OFF(LANE_CBRT_BOUND));
}

#endif
