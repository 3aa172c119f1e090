// SPDX-License-Identifier: MIT
/* elementary.h - logarithm, exponential, sine and cosine, and integer powers, without the C library.
 *
 * The functions of a C library differ in their last bits from one system to the next.  These use sums,
 * products, quotients, square roots and the fma of exact.h only, in one order.  So their bits are the same
 * everywhere.  They are not made to be fast: none is called where rays are traced.  The bounds are proven
 * below, with u = 2^-53; an ulp is one of the result.
 *
 * LOGARITHM, within 0.65 ulp.  Let x = 2^k m with sqrt(1/2) <= m < sqrt(2), and s = (m - 1) / (m + 1), so
 * |s| <= 0.1716.  Then
 *
 *     log x = k log 2 + 2 s + 2 s^3 (1/3 + s^2/5 + ... + s^18/21),
 *
 * the series of the area tangent.  What it leaves out is below 2^-60 of 2 s.  m - 1 is exact, and s is a
 * twofold.  The upper part of log 2 has 32 bits, so k times it is exact, and its sum with 2 s is known to
 * 2^-100.  Only the rest is rounded.
 *
 * The rest is at most 0.0102 of 2 |s|, with a relative error below 12 u: six for s^3 times the series,
 * which has only the upper part of s, the others for the sums.  That is 0.13 u of 2 |s|.  And 2 |s| <=
 * |log x|: if k is not 0, |log x| >= log 2 - 0.347, and 2 |s| < 0.3466.  With the last rounding the error
 * is 1/2 + 0.13 ulp, and 0.01 for the series.
 *
 * EXPONENTIAL, within 2.5 ulps if the result is normal.  Let x = k log 2 + r with |r| <= 0.347.  Then
 *
 *     e^x = 2^k (1 + r + ... + r^14/14!),
 *
 * which leaves out 2^-63.  r is off by u |r| + 2^-75.  The sum is 1 + r S.  S is off by 1.5 u of itself,
 * and r S has two more roundings: with that of r, 4.6 u |r S|.  Now |r S| = |e^r - 1|:
 *
 *     the sum is above 1    |r S| is at most 0.415, the sum's ulp is 2 u: 0.96 ulps
 *     the sum is below 1    |r S| is at most 0.293, the sum's ulp is u: 1.35 ulps
 *
 * The last addition adds a half.  A sum just below 1 may be rounded to 1, where an ulp is 2 u.  Then the
 * error is half as many ulps.
 *
 * SINE and COSINE of a twofold a, |a| <= pi/4, within 0.65 ulp.  With b = a^2 as a twofold,
 *
 *     cos a = 1 - b/2 + b^2 (1/24 - b/720 + ... - b^7/18!),
 *     sin a = a - a b/6 + a b^2 (1/120 - b/5040 + ... + b^6/17!).
 *
 * The series leave out less than 2^-68 and 2^-62 of the result.  1 - b/2 and a - a b/6 are computed as
 * twofolds. The rest is at most 0.016, and 0.0032 |a|, with a relative error below 8 u.  That is 0.13 u of
 * a cosine whose ulp is at least u, and 0.03 u |a| of a sine of at least 0.9 |a|.
 *
 * POWER x^n by repeated squares.  It is a product of n factors in some order.  So it has n - 1 roundings,
 * and an error of (n - 1) u (1 + 2^-40) relative, if nothing overflows or underflows.
 *
 * Test: tests/interval/test_elementary.c (MPFR). */
#ifndef SGT_NUM_ELEMENTARY_H
#define SGT_NUM_ELEMENTARY_H

#include "bits.h"

/* log 2 in two parts, the upper one of 32 bits (split as by Tang 1990, ACM TOMS 16, 378). */
static const double LOG_2_HIGH = 0x1.62e42fee00000p-1, LOG_2_LOW = 0x1.a39ef35793c76p-33;

/* The natural logarithm; -INFINITY for 0, NaN for negative numbers. */
static inline double logarithm(double x)
{
    if (!(x > 0 && x <= DBL_MAX)) return x == 0 ? -(double)INFINITY : x > 0 ? x : (double)NAN;
    int k;
    double m = binary_mantissa(x, &k);
    if (m < 0x1.6a09e667f3bcdp-1) m *= 2, k--; /* sqrt(1/2) */
    twofold s = twofold_quotient(twofold_of(m - 1), two_sum(m, 1));
    double s2 = s.hi * s.hi, series = 0;
    for (int n = 21; n >= 3; n -= 2) series = 1.0 / n + s2 * series;
    twofold sum = two_sum(k * LOG_2_HIGH, 2 * s.hi);
    return sum.hi + (sum.lo + (k * LOG_2_LOW + 2 * (s.lo + s.hi * s2 * series)));
}

/* e^x; 0 below -746, INFINITY above 710. */
static inline double exponential(double x)
{
    if (!(fabs(x) <= DBL_MAX)) return x < 0 ? 0 : x;
    if (x > 710 || x < -746) return x > 0 ? (double)INFINITY : 0;
    double k = nearest_integer(x * 0x1.71547652b82fep+0), sum = 1; /* 1 / log 2 */
    double r = (x - k * LOG_2_HIGH) - k * LOG_2_LOW;
    for (int n = 14; n >= 1; n--) sum = 1 + r / n * sum;
    return times_power_of_two(sum, (int)k);
}

typedef struct sine_cosine { double sine, cosine; } sine_cosine;

/* Sine and cosine of a in radians, |a| <= pi/4. */
SGT_INLINE sine_cosine sine_cosine_of(twofold a)
{
    static const twofold sixth = {0x1.5555555555555p-3, 0x1.5555555555555p-57};
    twofold b = twofold_product(a, a), cube = twofold_product(twofold_product(a, b), sixth);
    twofold d = twofold_difference(a, cube), e = two_sum(1, -0.5 * b.hi);
    double x = b.hi, x2 = x * x;
    double s = 1.0 / 1307674368000 - x / 355687428096000, c = 1.0 / 20922789888000 - x / 6402373705728000;
    s = 1.0 / 362880 - x * (1.0 / 39916800 - x * (1.0 / 6227020800 - x * s));
    s = 1.0 / 120 - x * (1.0 / 5040 - x * s);
    c = 1.0 / 3628800 - x * (1.0 / 479001600 - x * (1.0 / 87178291200 - x * c));
    c = 1.0 / 24 - x * (1.0 / 720 - x * (1.0 / 40320 - x * c));
    return (sine_cosine){d.hi + (d.lo + a.hi * x2 * s), e.hi + (e.lo + (x2 * c - 0.5 * b.lo))};
}

/* x^n. */
static inline double integer_power(double x, unsigned n)
{
    double power = n & 1 ? x : 1;
    while (n >>= 1) {
        x *= x;
        if (n & 1) power *= x;
    }
    return power;
}

/* The same as a twofold, within 6 n u^2 relative (exact.h: 5 u^2 for each product). */
static inline twofold twofold_power(double x, unsigned n)
{
    twofold power = twofold_of(n & 1 ? x : 1), square = twofold_of(x);
    while (n >>= 1) {
        square = twofold_product(square, square);
        if (n & 1) power = twofold_product(power, square);
    }
    return power;
}

#endif
