// SPDX-License-Identifier: MIT
/* functions.h - elementary functions of doubles, for loops over lanes.
 *
 * There is no branch, no call but sqrt, no table and no fma.  So a loop over lanes (lanes.h) becomes vector
 * code in each set of instructions, and a lane has the bits of the single call.  They are quicker and less
 * exact than pair.h, which knows its results to 2^-71.
 *
 * BOUNDS.  u = 2^-53.  A result that is not NaN is off by at most `bound` u of the right one, and by 2^-1074
 * besides.
 *
 *     exp  2      log  2.5    sin, cos  2     tan  5     cbrt  2      hypot  2.5
 *     atan, atan2  6          asin, acos  11             sinh, cosh  5      tanh  6
 *     power b^e  4.5
 *
 * NaN is where a function is not defined: log of 0 or less; asin and acos beyond 1; atan2(0, 0); a power of a
 * number below 0, and 0^e for e <= 0.  sin, cos and tan are NaN beyond 2^26, too.  Infinite arguments give
 * the limit, or NaN where there is none, and for atan2 and power NaN in some cases that have one.
 *
 * Each bound below is counted as: an error in u of the result, for each rounding that is not negligible.
 * Terms of the second order and what the series leave out (each named, at most 0.05) are in the rounding up.
 *
 * EXP.  x = k log 2 + r, |r| <= 0.347, as in elementary.h: e^x = 2^k (1 + (r + r^2 q)), q to r^13 / 13!,
 * which leaves out 2^-57.7.  Absolute errors for e^r: that of r, u/4 times e^r; r^2 q <= 0.068, with six
 * roundings, 0.41 u at most and 0.25 u where e^r < 1; the sum in parentheses u/4; the last sum u/2, or u
 * above 1.  Below 1, e^r >= 0.707: 0.25 + (0.25 + 0.25 + 0.5) / 0.707 = 1.7.  Above 1 it is at most 0.25 +
 * 0.41 + 0.25 + 1 = 1.95. 2^k is multiplied in two parts, so that only the last product is rounded, and only
 * if it is subnormal.
 *
 * LOG.  x = 2^k (1 + f), sqrt(1/2) <= 1 + f < sqrt(2).  With s = f / (2 + f), h = f^2 / 2,
 *
 *     log(1 + f) = 2 s + s R = f - (h - s (h + R)),  R = 2/3 s^2 + 2/5 s^4 + ... + 2/21 s^20
 *
 * (fdlibm, e_log.c).  It leaves out 2^-58 of 2 s.  k = 0: h is at most 1/4 of the result, s (h + R) 1/20.
 * Three roundings of h and the difference, 0.5; five of s (h + R), 0.25; the last, 1.  Else the result is at
 * least 0.3466: h, u/16 at most; s (h + R), 0.02 u; the sums in parentheses and the last below 1/2, u/4 each,
 * which is 0.72 of the result; together 0.24 + 0.06 + 0.72 + 0.72.  Larger results have smaller shares.
 *
 * SIN and COS.  x = n pi/2 + a.  n is below 2^25.5, and pi/2 is five parts, of which the first four have 27
 * bits and less: their products by n are exact.
 *     x - n P1      exact: if n is not 0, both are multiples of 2^-53, and the difference is below 1 (of
 *                   |n| >= 2, multiples of 2^-51 and below 2)
 *     less n P2     exact: multiples of 2^-53 below 0.8
 *     less n P3, n P4    as error-free sums.  P4 goes down to 2^-107
 *     less n P5     rounded: 2^-134, where a is 2^-61.1 at least (pair.h)
 * So a = hi + lo within 2^-72 of it.  |lo| is u |hi| at most, or 2^-82 where |hi| is below 2^-27.
 *     sin a = hi + (lo - b lo / 2 + hi b S), b = hi^2, S to b^7 / 17!, which leaves out 2^-63.  |hi b S| is
 *     at most 0.114 of the result, with five roundings 0.57; with that of the inner sum 0.12, and the last 1.
 *     cos a = w + ((1 - w - b/2) + (b^2 C - hi lo)), w = 1 - b/2, C to b^6 / 16!, which leaves out 2^-58.3.
 *     b is off by u/2 at most, b/2 by u/4; b^2 C <= 0.0159, with six roundings 0.1 u; the last, of a sum of
 *     at least 0.7, u/2; all together 0.85 u / 0.7 = 1.2.  Near 1 it is smaller.
 * TAN is their quotient: 1.7 + 1.2 + 1.
 *
 * ATAN2.  q = the smaller of |x|, |y| over the larger.  k is the integer nearest to 4 q, c = k/4, and atan q
 * = atan c + atan t, t = (q - c) / (1 + c q).  q - c is exact (Sterbenz).  |t| <= 1/8, and the series to t^17
 * / 17 leaves out 2^-58.  q is off by u q, which is 1 of the result at most; t by 2.2 of itself, which is at
 * most 0.98 of the result for k = 1 and less beyond; atan c by 0.5; the series by 0.1, the last sum by 1:
 * 3.6. The complement to pi/2, and to pi, has the error of at most the angle itself, one of the constant (its
 * lower part is used), and one rounding each.
 * ASIN x = atan2(x, r), ACOS x = atan2(r, x), r = sqrt((1 - x) (1 + x)), with (1 + 1 + 1) / 2 + 1 = 2.5
 * roundings; an angle changes by no more of itself than the quotient does.
 *
 * SINH, COSH.  Above 1, E/2 -+ 1 / (4 E/2), E = e^|x|: (2 + 1) 1.32 + 1 for sinh, less for cosh.  sinh to 1:
 * x + x b T, b = x^2, T to b^7 / 17!, which leaves out 2^-56 of it; x b T is at most 0.15 of the result,
 * with five roundings 0.75, and the last 1.
 * TANH.  To 1: s / sqrt(1 + s^2), s = sinh x.  s is off by 1.8, s^2 by 4.6; the root by half of the share of
 * s^2 of that, at most 1.35, and 1.5: 1.8 + 2.85 + 1.  (Both have the error of s, with the same sign.)  Above
 * 1: 1 - 2 / (e^2|x| + 1); the second is at most 0.313 of the result and off by 5: 2.6.
 *
 * CBRT.  x = 2^3k f, 1/2 <= f < 4.  A cubic is within 0.53 % of the root (found by Remez' exchange).
 * Halley's step takes an error e to 2/3 e^3 and so to 10^-7, a second to 10^-21.  The residue y^3 - f in that
 * is off by 2 u f, which is 2/3 of the root; the last rounding 1.
 *
 * HYPOT.  Both are scaled by a power of two, so that no square overflows, or is lost beside the other.  The
 * sum of squares is off by 2, its root by 1 and 1 more.
 *
 * POWER is exp(e log b), with log b and the product in two parts.  s = S + S', where S has 26 bits, and 2 + f
 * is split in the same way.  So the residue f - S (2 + f) is exact but for 2^-79 of f, and s is known to
 * 2^-77. With z = S^2 (exact), q = z/3 rounded, r = z - 3 q (exact, both steps by Sterbenz), P = 1/5 + s^2 /
 * 7 ... + s^20 / 25,
 *
 *     log(1 + f) / 2 = S + S q + (S' + S' q + s ((r + 2 S S' + S'^2) / 3 + s^4 P)).
 *
 * S times the upper half of q is exact.  The parentheses are below 2^-12 of s, and off by less than eight
 * roundings of that: 2^-62 of s, and so are the sums of the whole.  k log 2 is off by 2^-86 k.  The product
 * by e is off by 2^-61.5 of itself, which is below 746, so by 2.1 u at most; the exponential, which takes the
 * lower part of its argument to r, by 2.
 *
 * Test: tests/interval/test_lane_functions.c (MPFR). */
#ifndef SGT_NUM_FUNCTIONS_H
#define SGT_NUM_FUNCTIONS_H

#include "lanes.h"

#include <float.h>
#include <string.h>

/* In u of the result. */
#define LANE_EXP_BOUND 2.0
#define LANE_LOG_BOUND 2.5
#define LANE_SIN_BOUND 2.0
#define LANE_TAN_BOUND 5.0
#define LANE_CBRT_BOUND 2.0
#define LANE_HYPOT_BOUND 2.5
#define LANE_ATAN_BOUND 6.0
#define LANE_ASIN_BOUND 11.0
#define LANE_SINH_BOUND 5.0
#define LANE_TANH_BOUND 6.0
#define LANE_POWER_BOUND 4.5

#define LANE_TURN_LIMIT 0x1p26   /* beyond it sin, cos and tan are NaN */

/* x + LANE_SHIFT, |x| < 2^51, is rounded to an integer, which stands in the lowest bits of the sum. */
#define LANE_SHIFT 0x1.8p52

SGT_INLINE mask lane_bits(double x)
{
    mask bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}

SGT_INLINE double lane_double(mask bits)
{
    double x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

/* All bits set if a < b, else none, by the sign of a - b; a is not -0.  If a or b is NaN, or both are
 * infinite, it is either.  (With SSE2 alone gcc 12 makes no vector code of MASK.  In no set does it like a
 * condition that chooses twice.) */
SGT_INLINE mask lane_below(double a, double b) { return 0 - (lane_bits(a - b) >> 63); }

/* The same as chosen(), by bits. */
SGT_INLINE double lane_chosen(mask m, double yes, double no)
{
    return lane_double((lane_bits(yes) & m) | (lane_bits(no) & ~m));
}

/* x with the sign of `sign` multiplied in. */
SGT_INLINE double lane_signed(double x, double sign)
{
    return lane_double(lane_bits(x) ^ (lane_bits(sign) & 1ULL << 63));
}

/* ------------------------------------------------------------------ exp and log */

/* log 2; the upper part has 32 bits. */
#define LANE_LOG_2 0x1.62e42fee00000p-1
#define LANE_LOG_2_LOW 0x1.a39ef35793c76p-33

/* e^(x + low) times 2^-half; low is below u |x|, half is 0 or 1. */
SGT_INLINE double lane_exp_halved(double x, double low, double half)
{
    double b = x > 720 ? 720 : x, c = b < -760 ? -760 : b;
    double k = (c * 0x1.71547652b82fep+0 + LANE_SHIFT) - LANE_SHIFT;
    double r = (c - k * LANE_LOG_2) + (low - k * LANE_LOG_2_LOW), s = r * r;
    double even = 1.0 / 3628800 + s * (1.0 / 479001600);
    double odd = 1.0 / 39916800 + s * (1.0 / 6227020800);
    even = 1.0 / 40320 + s * even, odd = 1.0 / 362880 + s * odd;
    even = 1.0 / 720 + s * even, odd = 1.0 / 5040 + s * odd;
    even = 1.0 / 24 + s * even, odd = 1.0 / 120 + s * odd;
    even = 0.5 + s * even, odd = 1.0 / 6 + s * odd;
    double e = 1 + (r + s * (even + r * odd));
    /* two powers of two, each with a normal exponent */
    double n = k - half, some = n * 0.5 + LANE_SHIFT, rest = (n - (some - LANE_SHIFT)) + LANE_SHIFT;
    double first = lane_double((lane_bits(some) << 52) + (1023ULL << 52));
    double second = lane_double((lane_bits(rest) << 52) + (1023ULL << 52));
    return e * first * second;
}

SGT_INLINE double lane_exp(double x) { return lane_exp_halved(x, 0, 0); }

/* x = 2^k (1 + f) with sqrt(1/2) <= 1 + f < sqrt(2); x is finite and above 0. */
typedef struct lane_parts { double k, f; } lane_parts;

SGT_INLINE lane_parts lane_parts_of(double x)
{
    mask tiny = lane_below(x, DBL_MIN);
    mask bits = lane_bits(x * lane_chosen(tiny, 0x1p54, 1));
    /* 1023 and the digits of sqrt(1/2) are moved to the border of two exponents, and back */
    const mask root = 0x3fe6a09e667f3bcdULL;
    bits += 0x3ff0000000000000ULL - root;
    double k = lane_double(bits >> 52 | 0x4330000000000000ULL) - (0x1p52 + 1023);
    k -= lane_double(tiny & lane_bits(54));
    return (lane_parts){k, lane_double((bits & 0x000fffffffffffffULL) + root) - 1};
}

SGT_INLINE double lane_log(double x)
{
    lane_parts p = lane_parts_of(x);
    double k = p.k, f = p.f, h = 0.5 * f * f, s = f / (2 + f), z = s * s, w = z * z;
    double even = 2.0 / 15 + w * (2.0 / 19), odd = 2.0 / 17 + w * (2.0 / 21);
    even = 2.0 / 11 + w * even, odd = 2.0 / 13 + w * odd;
    even = 2.0 / 7 + w * even, odd = 2.0 / 9 + w * odd;
    even = 2.0 / 3 + w * even, odd = 2.0 / 5 + w * odd;
    double r = z * (even + z * odd);
    double y = k * LANE_LOG_2 - ((h - (s * (h + r) + k * LANE_LOG_2_LOW)) - f);
    y = x > 0 ? y : (double)NAN;
    return x > DBL_MAX ? x : y;
}

/* ----------------------------------------------------------------------- angles */

typedef struct lane_wave { double sine, cosine; } lane_wave;

/* Of one number: what comes of it does not cost twice. */
SGT_INLINE lane_wave lane_sin_cos(double any)
{
    double x = fabs(any) <= LANE_TURN_LIMIT ? any : (double)NAN;
    double turns = x * 0x1.45f306dc9c883p-1 + LANE_SHIFT, n = turns - LANE_SHIFT; /* 2 / pi */
    mask quarter = lane_bits(turns);
    double a1 = (x - n * 0x1.921fb54p+0) - n * 0x1.10b46p-30;
    twofold a2 = two_sum(a1, n * -0x1.1a62630p-54), a3 = two_sum(a2.hi, n * -0x1.8a2e034p-81);
    double hi = a3.hi, lo = (a2.lo + a3.lo) - n * 0x1.839a252049c11p-108;
    double b = hi * hi, d = b * b, half = 0.5 * b;
    double s = 1.0 / 6227020800 + d * (1.0 / 355687428096000), t = 1.0 / 39916800 + d * (1.0 / 1307674368000);
    s = 1.0 / 362880 + d * s, t = 1.0 / 5040 + d * t;
    s = 1.0 / 120 + d * s, t = 1.0 / 6 + d * t;
    double sine = hi + ((lo - half * lo) + hi * b * (b * s - t));
    double c = 1.0 / 479001600 + d * (1.0 / 20922789888000), e = 1.0 / 3628800 + d * (1.0 / 87178291200);
    c = 1.0 / 40320 + d * c, e = 1.0 / 720 + d * e;
    c = 1.0 / 24 + d * c;
    double w = 1 - half, cosine = w + (((1 - w) - half) + (d * (c - b * e) - hi * lo));
    mask odd = 0 - (quarter & 1);
    double p = lane_chosen(odd, cosine, sine), q = lane_chosen(odd, sine, cosine);
    return (lane_wave){lane_double(lane_bits(p) ^ (quarter & 2) << 62),
                       lane_double(lane_bits(q) ^ ((quarter + 1) & 2) << 62)};
}

SGT_INLINE double lane_sin(double x) { return lane_sin_cos(x).sine; }
SGT_INLINE double lane_cos(double x) { return lane_sin_cos(x).cosine; }

SGT_INLINE double lane_tan(double x)
{
    lane_wave w = lane_sin_cos(x);
    return w.sine / w.cosine;
}

/* atan(1/4), atan(1/2), atan(3/4), atan(1) */
#define ATAN_1 0x1.f5b75f92c80ddp-3
#define ATAN_2 0x1.dac670561bb4fp-2
#define ATAN_3 0x1.4978fa3269ee1p-1
#define ATAN_4 0x1.921fb54442d18p-1

SGT_INLINE double lane_atan2(double y, double x)
{
    double size_y = fabs(y), size_x = fabs(x);
    mask steep = lane_below(size_x, size_y);
    double q = lane_chosen(steep, size_x, size_y) / lane_chosen(steep, size_y, size_x);
    double k = (4 * q + LANE_SHIFT) - LANE_SHIFT, c = 0.25 * k;
    /* the bits of atan(1/4), and what the next ones differ in */
    mask of_c = lane_below(0.5, k) & lane_bits(ATAN_1);
    of_c ^= lane_below(1.5, k) & (lane_bits(ATAN_1) ^ lane_bits(ATAN_2));
    of_c ^= lane_below(2.5, k) & (lane_bits(ATAN_2) ^ lane_bits(ATAN_3));
    of_c ^= lane_below(3.5, k) & (lane_bits(ATAN_3) ^ lane_bits(ATAN_4));
    double t = (q - c) / (1 + c * q), z = t * t, w = z * z;
    double even = 1.0 / 13 + w * (1.0 / 17), odd = 1.0 / 15;
    even = 1.0 / 9 + w * even, odd = 1.0 / 11 + w * odd;
    even = 1.0 / 5 + w * even, odd = 1.0 / 7 + w * odd;
    odd = 1.0 / 3 + w * odd;
    double angle = lane_double(of_c) + (t + t * z * (z * even - odd));
    angle = lane_chosen(steep, 0x1.921fb54442d18p+0 - (angle - 0x1.1a62633145c07p-54), angle);
    /* -0 is as 0: on the cut the angle is pi, or -pi for y = -0 */
    angle = x < 0 ? 0x1.921fb54442d18p+1 - (angle - 0x1.1a62633145c07p-53) : angle;
    return lane_signed(angle, y);
}

SGT_INLINE double lane_atan(double x) { return lane_atan2(x, 1); }
SGT_INLINE double lane_asin(double x) { return lane_atan2(x, sqrt((1 - x) * (1 + x))); }
SGT_INLINE double lane_acos(double x) { return lane_atan2(sqrt((1 - x) * (1 + x)), x); }

/* ------------------------------------------------------------- hyperbolic functions */

/* sinh x, |x| <= 1. */
SGT_INLINE double lane_sinh_near(double x)
{
    double b = x * x, d = b * b;
    double s = 1.0 / 6227020800 + d * (1.0 / 355687428096000), t = 1.0 / 39916800 + d * (1.0 / 1307674368000);
    s = 1.0 / 362880 + d * s, t = 1.0 / 5040 + d * t;
    s = 1.0 / 120 + d * s, t = 1.0 / 6 + d * t;
    return x + x * b * (t + b * s);
}

SGT_INLINE double lane_sinh(double x)
{
    double size = fabs(x), half = lane_exp_halved(size, 0, 1);
    double far = half - 0.25 / half;
    return lane_signed(size <= 1 ? lane_sinh_near(size) : far, x);
}

SGT_INLINE double lane_cosh(double x)
{
    double half = lane_exp_halved(fabs(x), 0, 1);
    return half + 0.25 / half;
}

SGT_INLINE double lane_tanh(double x)
{
    double size = fabs(x), s = lane_sinh_near(size), near = s / sqrt(1 + s * s);
    double far = 1 - 2 / (lane_exp(2 * size) + 1);
    return lane_signed(size <= 1 ? near : far, x);
}

/* ---------------------------------------------------------------- roots and powers */

SGT_INLINE double lane_cbrt(double x)
{
    double size = fabs(x);
    mask tiny = lane_below(size, DBL_MIN);
    mask bits = lane_bits(size * lane_chosen(tiny, 0x1p54, 1));
    double e = lane_double(bits >> 52 | 0x4330000000000000ULL) - (0x1p52 + 1023);
    double third = e * 0x1.5555555555555p-2 + LANE_SHIFT, k = third - LANE_SHIFT;
    double f = lane_double(bits - (lane_bits(3 * k + LANE_SHIFT) << 52));
    double y = f * (f * 0.014688057909422726 - 0.13750120867341548);
    y = 0.5410527782829908 + f * (0.5786526069984106 + y);
    double c = y * y * y;
    y -= y * ((c - f) / (2 * c + f)), c = y * y * y;
    y -= y * ((c - f) / (2 * c + f));
    y *= lane_double((lane_bits(third) << 52) + (1023ULL << 52)) * lane_chosen(tiny, 0x1p-18, 1);
    /* 0, infinity and NaN are their own roots */
    y = size > 0 ? y : size;
    return lane_signed(size <= DBL_MAX ? y : size, x);
}

SGT_INLINE double lane_hypot(double a, double b)
{
    double size_a = fabs(a), size_b = fabs(b), most = larger(size_a, size_b);
    mask huge = lane_below(0x1p500, most), tiny = lane_below(most, 0x1p-400);
    double down = lane_chosen(huge, 0x1p-600, lane_chosen(tiny, 0x1p600, 1));
    double up = lane_chosen(huge, 0x1p600, lane_chosen(tiny, 0x1p-600, 1));
    double p = size_a * down, q = size_b * down;
    return sqrt(p * p + q * q) * up;
}

/* The upper 26 bits. */
SGT_INLINE double lane_upper(double x) { return lane_double(lane_bits(x) & ~0x7ffffffULL); }

/* b^e. */
SGT_INLINE double lane_power(double b, double e)
{
    lane_parts p = lane_parts_of(b);
    double d = 2 + p.f, d1 = lane_upper(d), d2 = p.f - (d1 - 2);
    double s = p.f / d, s1 = lane_upper(s), s2 = ((p.f - s1 * d1) - s1 * d2) / d;
    double z = s1 * s1, q = z / 3, left = ((z - 2 * q) - q) + (2 * s1 + s2) * s2, q1 = lane_upper(q);
    double v = s * s, w = v * v, even = 1.0 / 21 + w * (1.0 / 25), odd = 1.0 / 19 + w * (1.0 / 23);
    even = 1.0 / 17 + w * even, odd = 1.0 / 15 + w * odd;
    even = 1.0 / 13 + w * even, odd = 1.0 / 11 + w * odd;
    even = 1.0 / 9 + w * even, odd = 1.0 / 7 + w * odd;
    even = 1.0 / 5 + w * even;
    twofold sum = quick_two_sum(s1, s1 * q1);
    double rest = (s2 + s2 * q) + (s1 * (q - q1) + s * (left * (1.0 / 3) + w * (even + v * odd)));
    twofold log_b = two_sum(p.k * LANE_LOG_2, 2 * sum.hi);
    double low = log_b.lo + (2 * (sum.lo + rest) + p.k * LANE_LOG_2_LOW);
    /* times e */
    double e1 = lane_upper(e), e2 = e - e1, h1 = lane_upper(log_b.hi), h2 = log_b.hi - h1;
    double x = e * log_b.hi, x2 = (((e1 * h1 - x) + e1 * h2) + e2 * h1) + (e2 * h2 + e * low);
    twofold power = quick_two_sum(x, fabs(x) < 800 ? x2 : 0);
    power.lo = fabs(x) < 800 ? power.lo : 0; /* where x is infinite */
    double y = lane_exp_halved(power.hi, power.lo, 0), at_0 = e > 0 ? 0 : (double)NAN;
    y = b > 0 ? y : (double)NAN;
    /* of an infinite b as of a limit, which is e times infinity */
    y = b > DBL_MAX ? lane_exp_halved(e * b, 0, 0) : y;
    return b == 0 ? at_0 : y;
}

#endif
