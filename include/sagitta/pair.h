// SPDX-License-Identifier: MIT
/* pair.h - elementary functions of doubles, as sums of two doubles, with proven bounds.
 *
 * interval.h rounds them outward.  The functions of a C library differ in their last bits
 * from one system to the next, and few of them come with a bound.  These are made of
 * sums, quotients, square roots and sgt_fma in one order, so their bits are the same on
 * every processor.  No product stands beside a sum, unless it is exact: a product to be
 * added is made by sgt_pair_times, which a compiler cannot fuse with the sum.  (The rest
 * of what interval.h asks of the compiler also holds here.)
 *
 * A PAIR is hi + lo, with hi the double nearest to the sum.  The operations on pairs are
 * those of Joldes, Muller and Popescu 2017 (ACM TOMS 44, 15res): algorithms 6 (sum) and
 * 12 (product), proven within 3 u^2 and 5 u^2, u = 2^-53.  The quotient and the root are
 * the double, and one Newton step from it, whose own error is a few u of a few u:
 *     quotient  the product by q is off by 5 u^2 of x, the difference by 3 u^2 of it, and
 *               the step, at most 2 u of q, by 4 u of that: the dropped parts and its
 *               rounding.
 *     root      what is left is at most 2 u of x, and off by u of that; the step, u of
 *               the root, by 3 u of that, and by its square, left out.
 * So each operation is within 2^-101, relative to its result, cancellation or not.  That
 * holds for operands and results from 2^-400 to 2^400, or 0.  Less adds at most 2^-900.
 *
 * BOUND.  Each function below, called in its range, is within 2^-71 of its result, and
 * interval.h takes 2^-62 (SGT_PAIR_ERROR).  The argument is the same for all:
 *   - The series.  Its first terms are added as pairs, the others as doubles.  Horner's
 *     rule in doubles, with each term at most an eighth of the one before, is within 4 u
 *     of its sum; with the product by the variable, within 7 u < 2^-50.  The part in
 *     doubles is at most 2^-21.7 of the result.  What the series leaves out is below
 *     2^-79.  So a series is within 2^-71.6.
 *   - Fewer than 50 operations on pairs follow or precede, 2^-95.  No sum has operands
 *     that cancel by more than a factor of 4, except where the text says why it is exact.
 *
 *     series                       |y| at most   first term in doubles, of the sum
 *     exp r = sum r^n / n!         0.347         r^7 / 7!       2^-22.4
 *     S(y) = sum y^n / (2n + 1)!   1             y^5 / 11!      2^-25
 *     C(y) = sum y^n / (2n)!       1             y^5 / 10!      2^-21.8 (cosh 1 is 1.54:
 *                                                               2^-22.4)
 *     A(y) = sum y^n / (2n + 1)    0.04          y^4 / 9        2^-21.7
 *
 * sin x = x S(-x^2), sinh x = x S(x^2), cos x = C(-x^2), cosh x = C(x^2),
 * atan x = x A(-x^2), and half of log((1 + x) / (1 - x)) = x A(x^2).
 *
 * Test: tests/interval/test_pair.c (MPFR). */
#ifndef SAGITTA_PAIR_H
#define SAGITTA_PAIR_H
#include <sagitta/fma.h>

#include <float.h>
#include <math.h>
#include <stdbool.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct sgt_pair {
    double hi, lo;
} sgt_pair;

/* ------------------------------------------------------------ operations on pairs */

/* a * b rounded, which no compiler fuses with a sum.  (Only where the processor has the
 * instruction could it.  The sign of a product that is 0 may differ.) */
static inline double sgt_pair_times(double a, double b)
{
#if defined(__FMA__) || defined(__aarch64__) || defined(__s390x__) || \
    defined(__FP_FAST_FMA)
    return sgt_fma(a, b, 0.0);
#else
    return a * b;
#endif
}

static inline sgt_pair sgt_pair_of(double a)
{
    sgt_pair x = {a, 0};
    return x;
}

/* a + b, exactly; |a| >= |b|. */
static inline sgt_pair sgt_pair_joined(double a, double b)
{
    sgt_pair x = {a + b, 0};
    x.lo = b - (x.hi - a);
    return x;
}

/* a + b, exactly. */
static inline sgt_pair sgt_pair_exact_sum(double a, double b)
{
    sgt_pair x = {a + b, 0};
    double by = x.hi - a;
    x.lo = (a - (x.hi - by)) + (b - by);
    return x;
}

/* a * b, exactly. */
static inline sgt_pair sgt_pair_exact_product(double a, double b)
{
    sgt_pair x = {sgt_pair_times(a, b), 0};
    x.lo = sgt_fma(a, b, -x.hi);
    return x;
}

static inline sgt_pair sgt_pair_sum(sgt_pair x, sgt_pair y)
{
    sgt_pair s = sgt_pair_exact_sum(x.hi, y.hi), t = sgt_pair_exact_sum(x.lo, y.lo);
    s = sgt_pair_joined(s.hi, s.lo + t.hi);
    return sgt_pair_joined(s.hi, t.lo + s.lo);
}

static inline sgt_pair sgt_pair_negative(sgt_pair x)
{
    x.hi = -x.hi, x.lo = -x.lo;
    return x;
}

static inline sgt_pair sgt_pair_difference(sgt_pair x, sgt_pair y)
{
    return sgt_pair_sum(x, sgt_pair_negative(y));
}

static inline sgt_pair sgt_pair_product(sgt_pair x, sgt_pair y)
{
    sgt_pair p = sgt_pair_exact_product(x.hi, y.hi);
    double t = sgt_fma(x.lo, y.hi, sgt_fma(x.hi, y.lo, sgt_pair_times(x.lo, y.lo)));
    return sgt_pair_joined(p.hi, p.lo + t);
}

/* y is not 0. */
static inline sgt_pair sgt_pair_quotient(sgt_pair x, sgt_pair y)
{
    double q = x.hi / y.hi;
    sgt_pair left = sgt_pair_difference(x, sgt_pair_product(sgt_pair_of(q), y));
    return sgt_pair_joined(q, left.hi / y.hi);
}

/* x > 0. */
static inline sgt_pair sgt_pair_root(sgt_pair x)
{
    double s = sqrt(x.hi), left = sgt_fma(-s, s, x.hi) + x.lo;
    return sgt_pair_joined(s, left / (s + s));
}

/* x times a power of two: exact. */
static inline sgt_pair sgt_pair_scaled(sgt_pair x, double by)
{
    x.hi *= by, x.lo *= by;
    return x;
}

/* 2^k, -1074 <= k <= 1023. */
static inline double sgt_pair_two_to(int k)
{
    return sgt_fma_double(k >= -1022 ? (unsigned long long)(k + 1023) << 52
                                     : 1ULL << (k + 1074));
}

/* x = f 2^*k, 1 <= f < 2; x is finite and above 0.  Returns f. */
static inline double sgt_pair_fraction(double x, int *k)
{
    double f = (double)sgt_fma_mantissa(x, k);
    *k += 52;
    return f * sgt_pair_two_to(-52);
}

/* The integer nearest to x * by, |x * by| < 2^30; or the one beside it, if x * by is
 * within 2^-20 of a half. */
static inline double sgt_pair_nearest(double x, double by)
{
    const double shift = 6755399441055744.0; /* 1.5 2^52: the sum's last bit is worth 1 */
    return sgt_fma(x, by, shift) - shift;
}

/* ------------------------------------------------------------------------ series */

/* first[0] + y first[1] + ... + y^firsts (rest[0] + y rest[1] + ...). */
static inline sgt_pair sgt_pair_series(sgt_pair y, const sgt_pair *first, int firsts,
                                       const double *rest, int rests)
{
    double tail = rest[rests - 1];
    sgt_pair sum;
    int i;
    for (i = rests - 2; i >= 0; i--) tail = sgt_fma(y.hi, tail, rest[i]);
    sum = sgt_pair_of(sgt_pair_times(y.hi, tail));
    for (i = firsts - 1; i > 0; i--)
        sum = sgt_pair_product(y, sgt_pair_sum(first[i], sum));
    return sgt_pair_sum(first[0], sum);
}

/* The exponential of r, |r| <= 0.347; it leaves out r^18 / 18!. */
static inline sgt_pair sgt_pair_series_e(sgt_pair r)
{
    static const sgt_pair first[] = {
        {1, 0}, {1, 0}, {0.5, 0}, {0.16666666666666666, 9.25185853854297e-18},
        {0.041666666666666664, 2.3129646346357427e-18},
        {0.008333333333333333, 1.1564823173178714e-19},
        {0.001388888888888889, -5.300543954373577e-20}};
    static const double rest[] = {
        1 / 5040.0, 1 / 40320.0, 1 / 362880.0, 1 / 3628800.0, 1 / 39916800.0,
        1 / 479001600.0, 1 / 6227020800.0, 1 / 87178291200.0, 1 / 1307674368000.0,
        1 / 20922789888000.0, 1 / 355687428096000.0};
    return sgt_pair_series(r, first, 7, rest, 11);
}

/* S: it leaves out y^12 / 25!. */
static inline sgt_pair sgt_pair_series_s(sgt_pair y)
{
    static const sgt_pair first[] = {{1, 0},
                                     {0.16666666666666666, 9.25185853854297e-18},
                                     {0.008333333333333333, 1.1564823173178714e-19},
                                     {0.0001984126984126984, 1.7209558293420705e-22},
                                     {2.7557319223985893e-06, -1.858393274046472e-22}};
    static const double rest[] = {
        1 / 39916800.0, 1 / 6227020800.0, 1 / 1307674368000.0, 1 / 355687428096000.0,
        1 / 121645100408832000.0, 1 / 51090942171709440000.0,
        1 / 25852016738884976640000.0};
    return sgt_pair_series(y, first, 5, rest, 7);
}

/* C: it leaves out y^12 / 24!. */
static inline sgt_pair sgt_pair_series_c(sgt_pair y)
{
    static const sgt_pair first[] = {{1, 0},
                                     {0.5, 0},
                                     {0.041666666666666664, 2.3129646346357427e-18},
                                     {0.001388888888888889, -5.300543954373577e-20},
                                     {2.48015873015873e-05, 2.1511947866775882e-23}};
    static const double rest[] = {
        1 / 3628800.0, 1 / 479001600.0, 1 / 87178291200.0, 1 / 20922789888000.0,
        1 / 6402373705728000.0, 1 / 2432902008176640000.0, 1 / 1124000727777607680000.0};
    return sgt_pair_series(y, first, 5, rest, 7);
}

/* A: it leaves out y^16 / 33, and no more than 1.05 times that. */
static inline sgt_pair sgt_pair_series_a(sgt_pair y)
{
    static const sgt_pair first[] = {{1, 0},
                                     {0.3333333333333333, 1.850371707708594e-17},
                                     {0.2, -1.1102230246251566e-17},
                                     {0.14285714285714285, 7.93016446160826e-18}};
    static const double rest[] = {1 / 9.0,  1 / 11.0, 1 / 13.0, 1 / 15.0,
                                  1 / 17.0, 1 / 19.0, 1 / 21.0, 1 / 23.0,
                                  1 / 25.0, 1 / 27.0, 1 / 29.0, 1 / 31.0};
    return sgt_pair_series(y, first, 4, rest, 12);
}

/* ------------------------------------------------------------------ the functions */

/* log 2 = upper + lower within 2^-98.  The upper part has 42 bits, so a product by an
 * integer below 2^11 is exact. */
#define SGT_PAIR_LOG_2_UPPER 0.6931471805598903
#define SGT_PAIR_LOG_2_LOWER 5.497923018708371e-14

static inline sgt_pair sgt_pair_half_pi(void)
{
    sgt_pair x = {1.5707963267948966, 6.123233995736766e-17};
    return x;
}

/* e^x = f 2^*k, 0.7 < f < 1.42; |x| <= 1100.
 * x = k log 2 + r.  x.hi less k times the upper part of log 2 is exact: if k is not 0,
 * both are multiples of 2^-54, and the difference is below 1/2.  r is off by k 2^-98. */
static inline sgt_pair sgt_pair_exponential(sgt_pair x, int *k)
{
    double n = sgt_pair_nearest(x.hi, 1.4426950408889634);
    sgt_pair r = sgt_pair_exact_sum(sgt_fma(-n, SGT_PAIR_LOG_2_UPPER, x.hi), x.lo);
    *k = (int)n;
    return sgt_pair_series_e(
        sgt_pair_sum(r, sgt_pair_exact_product(-n, SGT_PAIR_LOG_2_LOWER)));
}

/* The logarithm of x, finite and above 0.  It is within 2^-73: y is below 0.0295.
 * x = 2^k f with sqrt(1/2) < f < sqrt(2), s = (f - 1) / (f + 1), |s| <= 0.1716;
 * log x = k log 2 + 2 s A(s^2).  f - 1 is exact.  The sum does not cancel by more than 2:
 * |log f| <= 0.347, and |k| log 2 >= 0.693. */
static inline sgt_pair sgt_pair_logarithm(double x)
{
    int k;
    double f = sgt_pair_fraction(x, &k);
    sgt_pair s, log_f, n;
    if (f > 1.4142135623730951) f *= 0.5, k++;
    s = sgt_pair_quotient(sgt_pair_of(f - 1), sgt_pair_exact_sum(f, 1));
    log_f = sgt_pair_product(sgt_pair_scaled(s, 2),
                             sgt_pair_series_a(sgt_pair_product(s, s)));
    n = sgt_pair_sum(sgt_pair_of(k * SGT_PAIR_LOG_2_UPPER),
                     sgt_pair_exact_product(k, SGT_PAIR_LOG_2_LOWER));
    return sgt_pair_sum(n, log_f);
}

/* x = n pi/2 + rest, |rest| <= 0.7854. */
typedef struct sgt_turn {
    sgt_pair rest;
    int n;
} sgt_turn;

#define SGT_TURN_LIMIT 67108864.0 /* 2^26 */

/* |x| <= SGT_TURN_LIMIT, so |n| < 2^26.  pi/2 = p + q + s within 2^-163.
 * x - n p is exact: if n is not 0, it is a multiple of 2^-53, and below 1.  Each sum
 * after it is within 2^-102 of what it gives.  No double but 0 is nearer to a multiple of
 * pi/2 than 2^-61.1 (6381956970095103 2^797 is the nearest: Muller, Elementary Functions,
 * on worst cases of range reduction).  n s is below 2^-82, so the last sum does not
 * cancel.  What is left out, n 2^-163, is below 2^-137: 2^-75 of the rest. */
static inline sgt_turn sgt_turn_of(double x)
{
    sgt_turn turn;
    double n = sgt_pair_nearest(x, 0.6366197723675814);
    sgt_pair r = sgt_pair_of(sgt_fma(-n, 1.5707963267948966, x));
    r = sgt_pair_sum(r, sgt_pair_exact_product(-n, 6.123233995736766e-17));
    r = sgt_pair_sum(r, sgt_pair_exact_product(-n, -1.4973849048591698e-33));
    turn.rest = r, turn.n = (int)n;
    return turn;
}

/* The sine of x, of |x| <= 1; with sign 1 in place of -1 the hyperbolic one. */
static inline sgt_pair sgt_pair_sine(sgt_pair x, double sign)
{
    sgt_pair y = sgt_pair_scaled(sgt_pair_product(x, x), sign);
    return sgt_pair_product(x, sgt_pair_series_s(y));
}

static inline sgt_pair sgt_pair_cosine(sgt_pair x, double sign)
{
    return sgt_pair_series_c(sgt_pair_scaled(sgt_pair_product(x, x), sign));
}

/* The arc tangent of t, 2^-64 <= t <= 2^64.
 * Above 1: pi/2 - atan(1 / t), where the second is at most half the first.  Then
 * atan t = 2 atan(t / (1 + sqrt(1 + t^2))) until t <= 0.2: twice at most, as
 * tan(pi / 16) = 0.1989. */
static inline sgt_pair sgt_pair_arc_tangent(sgt_pair t)
{
    bool over = t.hi > 1;
    double times = 1;
    if (over) t = sgt_pair_quotient(sgt_pair_of(1), t);
    for (; t.hi > 0.2 && times < 4; times *= 2) {
        sgt_pair root = sgt_pair_sum(sgt_pair_of(1), sgt_pair_product(t, t));
        root = sgt_pair_root(root);
        t = sgt_pair_quotient(t, sgt_pair_sum(sgt_pair_of(1), root));
    }
    t = sgt_pair_product(
        t, sgt_pair_series_a(sgt_pair_negative(sgt_pair_product(t, t))));
    t = sgt_pair_scaled(t, times);
    return over ? sgt_pair_difference(sgt_pair_half_pi(), t) : t;
}

/* The cube root of 1 <= x < 8.  The first guess is within 11 %, and Newton's step squares
 * that (times at most 1.13): four of them leave 2.4e-15, and the roundings of the last,
 * together below 2^-47.  A fifth, with the cube as a pair, leaves less than 2^-93. */
static inline sgt_pair sgt_pair_cube_root(double x)
{
    double y = 1 + (x - 1) / 7;
    sgt_pair cube;
    int i;
    for (i = 0; i < 4; i++) y = (y + y + x / sgt_pair_times(y, y)) / 3;
    cube = sgt_pair_product(sgt_pair_exact_product(y, y), sgt_pair_of(y));
    cube = sgt_pair_difference(sgt_pair_of(x), cube);
    return sgt_pair_joined(y, cube.hi / (3 * sgt_pair_times(y, y)));
}

#ifdef __cplusplus
}
#endif
#endif
