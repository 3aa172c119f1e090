// SPDX-License-Identifier: MIT
/* interval.h - intervals of doubles, rounded outward: what is needed to write `enclose`.
 *
 * An interval is the set of the real numbers x with lo <= x <= hi.  If an end is
 * infinite, the set is unbounded on that side.  Each operation returns an interval that
 * contains all values that it has for members of its arguments (the set-based flavour of
 * IEEE 1788-2015, without its decorations).
 *   - Empty is lo > hi; operations return it as {INFINITY, -INFINITY}.  An operation on
 *     an empty interval is empty.  So is the square root of negative numbers, and a
 *     quotient by zero alone.
 *   - A NaN at either end says that nothing is known.  The result is then all numbers; an
 *     intersection takes all numbers in its place.  Empty is a proof, so it is never made
 *     of a NaN.
 *   - INFINITY at both ends stands for numbers above the largest double, -INFINITY at
 *     both ends for numbers below the least.
 *
 * ROUNDING.  Ends are worked out to nearest.  What that leaves out is a double, and its
 * sign says whether to go one double outward.  So a result is the least interval of
 * doubles that contains its set, with two exceptions, in which each operation may go one
 * double farther out than it has to:
 *   - operands and results, other than 0, of 1e-289 and less or 1e307 and more, where
 *     what is left out is not always a double;
 *   - sgt_interval_power, which is made of products.
 * No end crosses zero by that, except that of a sum whose operands are of 1e307 and more.
 *
 * ELEMENTARY FUNCTIONS.  Between its ends a function is monotone, or its extremes are
 * known.  pair.h works out the value at an end as a sum hi + lo of two doubles, within
 * 2^-62 of it.  |lo| is at most half the gap between hi and the next double on its side,
 * and the bound is less than a 256th of a gap.  So an upper end is hi if lo and the bound
 * add up to 0 or less, and else the next double above hi: the value is not above either.
 *   - An end is the best possible double, or the next one outward.  It is the next one if
 *     the value itself is a double, and in less than one of a hundred other cases.  Ends
 *     of 1e-289 and less or 1e307 and more may be one double farther out.
 *   - Arguments beyond 2^26: a sine and a cosine are [-1, 1], a tangent is all numbers.
 *     A tangent with a pole in x is also all numbers.
 *   - If a function is defined on a part of x only, the result is that of this part; it
 *     is empty if there is no such part.  An `enclose` has to return an infinite slope
 *     there.
 *   - A sine, a cosine and a hyperbolic tangent stay in [-1, 1].
 *
 * THE SAME BITS ON EVERY PROCESSOR.  The processor's rounding mode is left alone and has
 * to be to nearest, with subnormal numbers kept.  sgt_fma rounds once on every system
 * (fma.h).  No product stands beside a sum that a compiler could fuse it with.  The
 * user's compiler has to keep to IEEE 754: no -ffast-math, no registers wider than a
 * double.
 *
 * Sources: Moller 1965 (BIT 5, 37) and Knuth (TAOCP vol. 2, 4.2.2, theorem B) for what a
 * sum leaves out; Boldo and Daumas 2003 (16th IEEE Symposium on Computer Arithmetic, 79)
 * for products, quotients and roots, and when it is a double; Hickey, Ju and van Emden
 * 2001 (J. ACM 48, 1038) for the cases of product and quotient.
 *
 * All functions are pure, and safe in any number of threads.  Example, x^2 - 2:
 *
 *     sgt_interval x = sgt_interval_between(1, 1.1), two = sgt_interval_of(2);
 *     sgt_interval f = sgt_interval_difference(sgt_interval_square(x), two);
 *     bool no_root = !sgt_interval_has(f, 0);
 */
#ifndef SAGITTA_INTERVAL_H
#define SAGITTA_INTERVAL_H
#include <sagitta/fma.h>
#include <sagitta/pair.h>
#include <sagitta/sagitta.h>

#include <float.h>
#include <math.h>
#include <string.h>

/* 16 and 32 are of types narrower than a double (ISO/IEC TS 18661-3).  With 1, on s390x,
 * floats are worked out as doubles, and there are none here. */
#if defined(__FAST_MATH__) || defined(__ASSOCIATIVE_MATH__) || \
    (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__ > 0) || \
    (defined(FLT_EVAL_METHOD) && FLT_EVAL_METHOD != 0 && FLT_EVAL_METHOD != 1 && \
     FLT_EVAL_METHOD != 16 && FLT_EVAL_METHOD != 32)
#error "sagitta/interval.h: no -ffast-math, and on 32-bit x86 -msse2 -mfpmath=sse"
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* ------------------------------------------------- numbers, one way or the other */

/* The next double above x: of -0 and 0 the smallest, of -INFINITY -DBL_MAX.  INFINITY and
 * NaN stay. */
static inline double sgt_next_above(double x)
{
    long long bits;
    if (!(x < (double)INFINITY)) return x;
    memcpy(&bits, &x, sizeof bits);
    /* the bits of doubles of one sign are in the order of the doubles */
    bits = x == 0 ? 1 : x > 0 ? bits + 1 : bits - 1;
    memcpy(&x, &bits, sizeof bits);
    return x;
}

static inline double sgt_next_below(double x) { return -sgt_next_above(-x); }

/* The next double above x if asked (x is then neither 0 nor infinite), else x.  Without a
 * branch, as no processor could predict it. */
static inline double sgt_raised(double x, bool asked)
{
    long long bits;
    memcpy(&bits, &x, sizeof bits);
    bits += (long long)asked * (1 - 2 * (long long)((unsigned long long)bits >> 63));
    memcpy(&x, &bits, sizeof bits);
    return x;
}

/* The next functions are bounds from above on a + b, a * b, a / b and the root of a.
 * Those from below are made of them: a sum's is -above(-a, -b).
 * 0 * INFINITY is 0: an end at infinity is not a number, and 0 times each number is 0.
 * An upper end that is -INFINITY is of numbers below -DBL_MAX, as near to it as you like.
 * So -DBL_MAX is added, multiplied or divided in its place: */
static inline double sgt_within(double a)
{
    return a > DBL_MAX ? DBL_MAX : a < -DBL_MAX ? -DBL_MAX : a;
}

/* Two moderate numbers: what their sum leaves out is exact, subnormal or not. */
static inline double sgt_sum_above(double a, double b)
{
    double s = a + b, v = s - a, left = (a - (s - v)) + (b - v);
    if (fabs(a) < 1e307 && fabs(b) < 1e307) return sgt_raised(s, left > 0);
    s = (a < 0 ? sgt_within(a) : a) + (b < 0 ? sgt_within(b) : b);
    return s <= DBL_MAX ? sgt_next_above(s)
                        : (double)INFINITY; /* and of NaN: opposite infinities */
}

static inline double sgt_product_above(double a, double b)
{
    double p = a * b, size = fabs(p);
    if (size > 1e-289 && size < 1e307) return sgt_raised(p, sgt_fma(a, b, -p) > 0);
    if (a == 0 || b == 0) return 0;
    if (p == 0 && (a > 0) != (b > 0)) return 0;
    return sgt_next_above(p < -DBL_MAX ? sgt_within(a) * sgt_within(b) : p);
}

/* b is above 0, or finite and below. */
static inline double sgt_quotient_above(double a, double b)
{
    double q = a / b, size = fabs(q);
    if (fabs(a) > 1e-289 && fabs(a) <= DBL_MAX && fabs(b) <= DBL_MAX && size > 1e-289 &&
        size < 1e307) {
        double left = sgt_fma(-q, b, a); /* a - q b: exact */
        return sgt_raised(q, b > 0 ? left > 0 : left < 0);
    }
    if (a == 0) return 0;
    q = (a < 0 ? sgt_within(a) : a) / sgt_within(b);
    if (q == 0 && (a > 0) != (b > 0)) return 0;
    return q <= DBL_MAX ? sgt_next_above(q) : (double)INFINITY;
}

/* a >= 0. */
static inline double sgt_square_root_above(double a)
{
    double s = sqrt(a);
    if (a > 1e-289 && a <= DBL_MAX) return sgt_raised(s, sgt_fma(-s, s, a) > 0);
    return a == 0 ? 0 : sgt_next_above(s);
}

static inline double sgt_square_root_below(double a)
{
    double s = sqrt(a);
    if (a > 1e-289 && a <= DBL_MAX) return -sgt_raised(-s, sgt_fma(-s, s, a) < 0);
    return a == 0 ? 0 : sgt_next_below(sqrt(sgt_within(a)));
}

/* ------------------------------------------------------------- making and asking */

/* All numbers, and none. */
static inline sgt_interval sgt_interval_all(void)
{
    sgt_interval x = {-(double)INFINITY, (double)INFINITY};
    return x;
}

static inline sgt_interval sgt_interval_empty(void)
{
    sgt_interval x = {(double)INFINITY, -(double)INFINITY};
    return x;
}

/* From a to b; empty if a > b. */
static inline sgt_interval sgt_interval_between(double a, double b)
{
    sgt_interval x = {a, b};
    return x;
}

/* a alone. */
static inline sgt_interval sgt_interval_of(double a)
{
    return sgt_interval_between(a, a);
}

/* middle +- by, rounded outward; by is at least 0. */
static inline sgt_interval sgt_interval_about(double middle, double by)
{
    return sgt_interval_between(-sgt_sum_above(-middle, by), sgt_sum_above(middle, by));
}

static inline bool sgt_interval_is_empty(sgt_interval x)
{
    return x.lo > x.hi;
}

/* May a be in x?  true for a NaN too: nothing is known. */
static inline bool sgt_interval_has(sgt_interval x, double a)
{
    return !(a < x.lo || a > x.hi) || isnan(x.lo) || isnan(x.hi);
}

/* Are all of x above 0, or below 0?  false if x is empty or has a NaN. */
static inline bool sgt_interval_is_positive(sgt_interval x)
{
    return x.lo > 0 && x.lo <= x.hi;
}

static inline bool sgt_interval_is_negative(sgt_interval x)
{
    return x.hi < 0 && x.lo <= x.hi;
}

/* All of x is in y, for certain; false for a NaN. */
static inline bool sgt_interval_is_in(sgt_interval x, sgt_interval y)
{
    return x.lo > x.hi || (x.lo >= y.lo && x.hi <= y.hi);
}

/* A finite double in x, near its middle.  NaN if x is empty or has a NaN.  (If x lies
 * beyond the largest double, the middle is not in it.) */
static inline double sgt_interval_middle(sgt_interval x)
{
    double lo = x.lo < -DBL_MAX ? -DBL_MAX : x.lo;
    double hi = x.hi > DBL_MAX ? DBL_MAX : x.hi, m = lo + hi;
    if (!(x.lo <= x.hi)) return (double)NAN;
    /* the halves of the second form are exact: fused or not, it is the same */
    m = fabs(m) <= DBL_MAX ? 0.5 * m : 0.5 * lo + 0.5 * hi;
    return m < lo ? lo : m > hi ? hi : m;
}

/* The greatest magnitude in x, at least; 0 if x is empty, INFINITY for a NaN. */
static inline double sgt_interval_greatest(sgt_interval x)
{
    double a = fabs(x.lo), b = fabs(x.hi);
    if (x.lo > x.hi) return 0;
    return a >= b ? a : b >= a ? b : (double)INFINITY;
}

/* hi - lo, rounded up; 0 if x is empty. */
static inline double sgt_interval_width(sgt_interval x)
{
    return x.lo > x.hi ? 0 : sgt_sum_above(x.hi, -x.lo);
}

/* What an operation returns if one of its arguments is empty or has a NaN. */
static inline sgt_interval sgt_interval_odd(sgt_interval x, sgt_interval y)
{
    bool unknown = isnan(x.lo) || isnan(x.hi) || isnan(y.lo) || isnan(y.hi);
    return (x.lo > x.hi || y.lo > y.hi) && !unknown ? sgt_interval_empty()
                                                    : sgt_interval_all();
}

/* What is in both. */
static inline sgt_interval sgt_interval_intersection(sgt_interval x, sgt_interval y)
{
    if (isnan(x.lo) || isnan(x.hi)) x = sgt_interval_all();
    if (isnan(y.lo) || isnan(y.hi)) y = sgt_interval_all();
    double lo = x.lo > y.lo ? x.lo : y.lo, hi = x.hi < y.hi ? x.hi : y.hi;
    return lo <= hi ? sgt_interval_between(lo, hi) : sgt_interval_empty();
}

/* The least interval that contains both. */
static inline sgt_interval sgt_interval_hull(sgt_interval x, sgt_interval y)
{
    if (isnan(x.lo) || isnan(x.hi)) return sgt_interval_all();
    if (isnan(y.lo) || isnan(y.hi)) return sgt_interval_all();
    if (x.lo > x.hi) return y.lo > y.hi ? sgt_interval_empty() : y;
    if (y.lo > y.hi) return x;
    return sgt_interval_between(x.lo < y.lo ? x.lo : y.lo, x.hi > y.hi ? x.hi : y.hi);
}

/* ------------------------------------------------------------------ operations */

static inline sgt_interval sgt_interval_negative(sgt_interval x) /* -x */
{
    if (!(x.lo <= x.hi)) return sgt_interval_odd(x, x);
    return sgt_interval_between(-x.hi, -x.lo);
}

static inline sgt_interval sgt_interval_sum(sgt_interval x, sgt_interval y) /* x + y */
{
    if (!(x.lo <= x.hi && y.lo <= y.hi)) return sgt_interval_odd(x, y);
    return sgt_interval_between(-sgt_sum_above(-x.lo, -y.lo), sgt_sum_above(x.hi, y.hi));
}

static inline sgt_interval sgt_interval_difference(sgt_interval x, sgt_interval y)
{ /* x - y */
    if (!(x.lo <= x.hi && y.lo <= y.hi)) return sgt_interval_odd(x, y);
    return sgt_interval_between(-sgt_sum_above(-x.lo, y.hi), sgt_sum_above(x.hi, -y.lo));
}

/* Of x and y that are both at least 0. */
static inline sgt_interval sgt_interval_product_up(double x_lo, double x_hi, double y_lo,
                                                   double y_hi)
{
    double below = -sgt_product_above(-x_lo, y_lo), above = sgt_product_above(x_hi, y_hi);
    return sgt_interval_between(below, above);
}

static inline sgt_interval sgt_interval_product(sgt_interval x, sgt_interval y)
{
    double low, high, other;
    if (!(x.lo <= x.hi && y.lo <= y.hi)) return sgt_interval_odd(x, y);
    if (x.lo >= 0 && y.lo >= 0)
        return sgt_interval_product_up(x.lo, x.hi, y.lo, y.hi);
    if (x.hi <= 0 && y.hi <= 0)
        return sgt_interval_product_up(-x.hi, -x.lo, -y.hi, -y.lo);
    if (x.lo >= 0 && y.hi <= 0)
        return sgt_interval_negative(sgt_interval_product_up(x.lo, x.hi, -y.hi, -y.lo));
    if (x.hi <= 0 && y.lo >= 0)
        return sgt_interval_negative(sgt_interval_product_up(-x.hi, -x.lo, y.lo, y.hi));
    if (y.lo < 0 && y.hi > 0 && !(x.lo < 0 && x.hi > 0)) {
        sgt_interval swap = x; /* the one that has both signs first */
        x = y, y = swap;
    }
    if (y.lo >= 0) {
        low = -sgt_product_above(-x.lo, y.hi), high = sgt_product_above(x.hi, y.hi);
        return sgt_interval_between(low, high);
    }
    if (y.hi <= 0) {
        low = -sgt_product_above(x.hi, -y.lo), high = sgt_product_above(x.lo, y.lo);
        return sgt_interval_between(low, high);
    }
    low = -sgt_product_above(-x.lo, y.hi), other = -sgt_product_above(x.hi, -y.lo);
    if (other < low) low = other;
    high = sgt_product_above(x.lo, y.lo), other = sgt_product_above(x.hi, y.hi);
    return sgt_interval_between(low, high > other ? high : other);
}

/* If y has 0 inside and x is not 0 alone, it is all numbers: the two parts are not told
 * apart. */
static inline sgt_interval sgt_interval_quotient(sgt_interval x, sgt_interval y)
{
    if (!(x.lo <= x.hi && y.lo <= y.hi)) return sgt_interval_odd(x, y);
    if (y.lo == 0 && y.hi == 0) return sgt_interval_empty();
    if (x.lo == 0 && x.hi == 0) return sgt_interval_of(0);
    if (y.lo < 0 && y.hi > 0) return sgt_interval_all();
    if (y.hi <= 0) x = sgt_interval_negative(x), y = sgt_interval_negative(y);
    /* Now y.lo >= 0.  A quotient by an end that is 0 is one by numbers as small as you
     * like, by an end at infinity as large as you like. */
    bool ends = y.hi < (double)INFINITY, apart = y.lo > 0;
    double lo, hi;
    if (x.lo >= 0) lo = ends ? -sgt_quotient_above(-x.lo, y.hi) : 0;
    else lo = apart ? -sgt_quotient_above(-x.lo, y.lo) : -(double)INFINITY;
    if (x.hi <= 0) hi = ends ? sgt_quotient_above(x.hi, y.hi) : 0;
    else hi = apart ? sgt_quotient_above(x.hi, y.lo) : (double)INFINITY;
    return sgt_interval_between(lo, hi);
}

static inline sgt_interval sgt_interval_absolute(sgt_interval x)
{
    if (!(x.lo <= x.hi)) return sgt_interval_odd(x, x);
    if (x.lo >= 0) return x;
    if (x.hi <= 0) return sgt_interval_negative(x);
    return sgt_interval_between(0, -x.lo > x.hi ? -x.lo : x.hi);
}

static inline sgt_interval sgt_interval_square(sgt_interval x)
{
    if (!(x.lo <= x.hi)) return sgt_interval_odd(x, x);
    x = sgt_interval_absolute(x);
    return sgt_interval_product_up(x.lo, x.hi, x.lo, x.hi);
}

/* Of the part of x that has a root. */
static inline sgt_interval sgt_interval_square_root(sgt_interval x)
{
    if (!(x.lo <= x.hi)) return sgt_interval_odd(x, x);
    if (x.hi < 0) return sgt_interval_empty();
    double below = x.lo > 0 ? sgt_square_root_below(x.lo) : 0;
    return sgt_interval_between(below, sgt_square_root_above(x.hi));
}

/* x^n.  For a negative n it is 1 / x^-n, which is as wide as [0, 1 / DBL_MAX] where x^-n
 * is beyond the largest double. */
static inline sgt_interval sgt_interval_power(sgt_interval x, int n)
{
    sgt_interval power = {1, 1}, square;
    unsigned left = n < 0 ? 0u - (unsigned)n : (unsigned)n;
    if (!(x.lo <= x.hi)) return sgt_interval_odd(x, x);
    if ((left & 1) && x.lo < 0 && x.hi > 0) {
        /* odd powers keep the order: each end by itself */
        sgt_interval low = sgt_interval_power(sgt_interval_of(x.lo), (int)left);
        sgt_interval high = sgt_interval_power(sgt_interval_of(x.hi), (int)left);
        power = sgt_interval_between(low.lo, high.hi);
    } else {
        for (square = x; left; left >>= 1, square = sgt_interval_square(square))
            if (left & 1) power = sgt_interval_product(power, square);
    }
    return n < 0 ? sgt_interval_quotient(sgt_interval_of(1), power) : power;
}

/* x times 2^k, or any number known exactly. */
static inline sgt_interval sgt_interval_scaled(sgt_interval x, double by)
{
    return sgt_interval_product(x, sgt_interval_of(by));
}

/* The lesser and the greater of each two members. */
static inline sgt_interval sgt_interval_minimum(sgt_interval x, sgt_interval y)
{
    if (!(x.lo <= x.hi && y.lo <= y.hi)) return sgt_interval_odd(x, y);
    return sgt_interval_between(x.lo < y.lo ? x.lo : y.lo, x.hi < y.hi ? x.hi : y.hi);
}

static inline sgt_interval sgt_interval_maximum(sgt_interval x, sgt_interval y)
{
    if (!(x.lo <= x.hi && y.lo <= y.hi)) return sgt_interval_odd(x, y);
    return sgt_interval_between(x.lo > y.lo ? x.lo : y.lo, x.hi > y.hi ? x.hi : y.hi);
}

/* --------------------------------------------- functions of one number, enclosed
 *
 * sgt_NAME_at(x) is an interval about the value at x.  At an x that is infinite its outer
 * end is the limit, and its inner end that of the largest double: x.lo = INFINITY stands
 * for numbers above DBL_MAX.  So also where the value is beyond the largest double. */

/* pair.h proves 2^-71, and 2^-63.8 of sgt_real_power_at. */
#define SGT_PAIR_ERROR (1 / 4611686018427387904.0) /* 2^-62 */

static inline double sgt_pair_above(sgt_pair x)
{
    double off = x.lo + fabs(x.hi) * SGT_PAIR_ERROR; /* an exact product */
    return off > 0 ? sgt_next_above(x.hi) : x.hi;
}

/* About x, from 2^-400 to 2^400 in magnitude. */
static inline sgt_interval sgt_interval_of_pair(sgt_pair x)
{
    return sgt_interval_between(-sgt_pair_above(sgt_pair_negative(x)), sgt_pair_above(x));
}

/* x times 2^k; 1/2 <= x < 4. */
static inline sgt_interval sgt_interval_of_pair_times(sgt_pair x, int k)
{
    sgt_interval y = sgt_interval_of_pair(x);
    int over = k > 1023 ? k - 1023 : k < -1074 ? k + 1074 : 0;
    double by = sgt_pair_two_to(k - over);
    if (over > 1) return sgt_interval_between(DBL_MAX, (double)INFINITY);
    if (over < -2) return sgt_interval_between(0, sgt_next_above(0));
    y.lo *= sgt_pair_two_to(over), y.hi *= sgt_pair_two_to(over); /* exact */
    return sgt_interval_between(-sgt_product_above(-y.lo, by),
                                sgt_product_above(y.hi, by));
}

/* From x to the next double toward 0, or away from it; x is not 0.  For |x| <= 2^-27 it
 * holds each of sin, atan, tanh (toward) and tan, asin, sinh (away): they begin as
 * x - a x^3 with |a| <= 1/2, and x^3 / 2 is below 2^-55 of x, a quarter of a gap. */
static inline sgt_interval sgt_interval_beside(double x, bool away)
{
    double y = (x > 0) == away ? sgt_next_above(x) : sgt_next_below(x);
    return x < y ? sgt_interval_between(x, y) : sgt_interval_between(y, x);
}

static inline bool sgt_is_tiny(double x)
{
    return fabs(x) <= 1 / 134217728.0; /* 2^-27 */
}

static inline sgt_interval sgt_cube_root_at(double x)
{
    int k, rest;
    double f;
    sgt_interval y;
    if (x == 0) return sgt_interval_of(0);
    if (x < 0) return sgt_interval_negative(sgt_cube_root_at(-x));
    f = sgt_pair_fraction(sgt_within(x), &k);
    rest = (k + 1200) % 3, k = (k - rest) / 3;
    y = sgt_interval_of_pair_times(sgt_pair_cube_root(f * (1 << rest)), k);
    return x > DBL_MAX ? sgt_interval_between(y.lo, x) : y;
}

/* e^x is below 2^-1075 under -746, and above DBL_MAX over 710. */
static inline sgt_interval sgt_exponential_at(double x)
{
    int k;
    sgt_pair f;
    if (x == 0) return sgt_interval_of(1);
    if (x > 710) return sgt_interval_between(DBL_MAX, (double)INFINITY);
    if (x < -746) return sgt_interval_between(0, sgt_next_above(0));
    f = sgt_pair_exponential(sgt_pair_of(x), &k);
    return sgt_interval_of_pair_times(f, k);
}

/* x >= 0. */
static inline sgt_interval sgt_logarithm_at(double x)
{
    sgt_interval y;
    if (x == 0) return sgt_interval_of(-(double)INFINITY);
    if (x == 1) return sgt_interval_of(0);
    y = sgt_interval_of_pair(sgt_pair_logarithm(sgt_within(x)));
    return x > DBL_MAX ? sgt_interval_between(y.lo, x) : y;
}

/* With E = e^x and x >= 0: (E + 1 / E) / 2 if sign is 1; (E - 1 / E) / 2 if it is -1,
 * above 1, where it cancels by 1.4 at most.  1 / E is below 2^-119 of E if k is above
 * 60. */
static inline sgt_interval sgt_exponentials_at(double x, double sign)
{
    int k;
    sgt_pair f;
    if (x > 712) return sgt_interval_between(DBL_MAX, (double)INFINITY);
    f = sgt_pair_exponential(sgt_pair_of(x), &k);
    if (k <= 60)
        f = sgt_pair_sum(
            f, sgt_pair_quotient(sgt_pair_of(sign * sgt_pair_two_to(-2 * k)), f));
    return sgt_interval_of_pair_times(f, k - 1);
}

static inline sgt_interval sgt_hyperbolic_sine_at(double x)
{
    if (x == 0) return sgt_interval_of(0);
    if (x < 0) return sgt_interval_negative(sgt_hyperbolic_sine_at(-x));
    if (sgt_is_tiny(x)) return sgt_interval_beside(x, true);
    if (x <= 1) return sgt_interval_of_pair(sgt_pair_sine(sgt_pair_of(x), 1));
    return sgt_exponentials_at(x, -1);
}

/* x >= 0. */
static inline sgt_interval sgt_hyperbolic_cosine_at(double x)
{
    return x == 0 ? sgt_interval_of(1) : sgt_exponentials_at(x, 1);
}

/* Above 1: 1 - 2 / (E^2 + 1); above 40 it is within 2^-114 of 1. */
static inline sgt_interval sgt_hyperbolic_tangent_at(double x)
{
    sgt_pair f;
    sgt_interval y;
    int k;
    if (x == 0) return sgt_interval_of(0);
    if (x < 0) return sgt_interval_negative(sgt_hyperbolic_tangent_at(-x));
    if (sgt_is_tiny(x)) return sgt_interval_beside(x, false);
    if (x > 40) return sgt_interval_between(sgt_next_below(1), 1);
    if (x <= 1) {
        f = sgt_pair_quotient(sgt_pair_sine(sgt_pair_of(x), 1),
                              sgt_pair_cosine(sgt_pair_of(x), 1));
    } else {
        f = sgt_pair_exponential(sgt_pair_of(2 * x), &k);
        f = sgt_pair_sum(sgt_pair_scaled(f, sgt_pair_two_to(k)), sgt_pair_of(1));
        f = sgt_pair_quotient(sgt_pair_of(2), f);
        f = sgt_pair_difference(sgt_pair_of(1), f);
    }
    y = sgt_interval_of_pair(f);
    return y.hi > 1 ? sgt_interval_between(y.lo, 1) : y;
}

/* Above 2^64 it is within 2^-64 of pi/2. */
static inline sgt_interval sgt_arc_tangent_at(double x)
{
    if (x == 0) return sgt_interval_of(0);
    if (x < 0) return sgt_interval_negative(sgt_arc_tangent_at(-x));
    if (sgt_is_tiny(x)) return sgt_interval_beside(x, false);
    if (x > 18446744073709551616.0) return sgt_interval_of_pair(sgt_pair_half_pi());
    return sgt_interval_of_pair(sgt_pair_arc_tangent(sgt_pair_of(x)));
}

/* |x| <= 1: the arc tangent of x / sqrt((1 - x) (1 + x)). */
static inline sgt_interval sgt_arc_sine_at(double x)
{
    sgt_pair root;
    if (x == 0) return sgt_interval_of(0);
    if (x < 0) return sgt_interval_negative(sgt_arc_sine_at(-x));
    if (sgt_is_tiny(x)) return sgt_interval_beside(x, true);
    if (x >= 1) return sgt_interval_of_pair(sgt_pair_half_pi());
    root = sgt_pair_product(sgt_pair_exact_sum(1, -x), sgt_pair_exact_sum(1, x));
    root = sgt_pair_quotient(sgt_pair_of(x), sgt_pair_root(root));
    return sgt_interval_of_pair(sgt_pair_arc_tangent(root));
}

/* |x| <= 1: twice the arc tangent of sqrt((1 - x) / (1 + x)). */
static inline sgt_interval sgt_arc_cosine_at(double x)
{
    sgt_pair t;
    if (x >= 1) return sgt_interval_of(0);
    if (x <= -1) return sgt_interval_of_pair(sgt_pair_scaled(sgt_pair_half_pi(), 2));
    t = sgt_pair_quotient(sgt_pair_exact_sum(1, -x), sgt_pair_exact_sum(1, x));
    t = sgt_pair_arc_tangent(sgt_pair_root(t));
    return sgt_interval_of_pair(sgt_pair_scaled(t, 2));
}

/* x^y for x > 0 and y, as limits if they are 0 or infinite.  log x is within 2^-73.5,
 * and |y log x| below 2^9.6: so the power is within 2^-63.9 + 2^-71 of itself. */
static inline sgt_interval sgt_real_power_at(double x, double y)
{
    sgt_pair log_x = {x == 0 ? -(double)INFINITY : x, 0};
    double size;
    int k;
    if (y == 0 || x == 1) return sgt_interval_of(1);
    if (x > 0 && x <= DBL_MAX) log_x = sgt_pair_logarithm(x);
    size = sgt_pair_times(log_x.hi, y);
    if (size > 711) return sgt_interval_between(DBL_MAX, (double)INFINITY);
    if (size < -747) return sgt_interval_between(0, sgt_next_above(0));
    log_x = sgt_pair_exponential(sgt_pair_product(log_x, sgt_pair_of(y)), &k);
    return sgt_interval_of_pair_times(log_x, k);
}

/* sqrt(x^2 + y^2), 0 <= y <= x.  If y is below 2^-40 of x, that is above x by less than
 * 2^-81 of it. */
static inline sgt_interval sgt_hypotenuse_at(double x, double y)
{
    int k, k_y;
    double f, g;
    sgt_pair s;
    sgt_interval length;
    if (y == 0) return sgt_interval_of(x);
    f = sgt_pair_fraction(sgt_within(x), &k), g = sgt_pair_fraction(sgt_within(y), &k_y);
    if (k - k_y > 41) return sgt_interval_between(sgt_within(x), sgt_next_above(x));
    g *= sgt_pair_two_to(k_y - k);
    s = sgt_pair_sum(sgt_pair_exact_product(f, f), sgt_pair_exact_product(g, g));
    s = sgt_pair_scaled(sgt_pair_root(s), 0.5);
    length = sgt_interval_of_pair_times(s, k + 1);
    return x > DBL_MAX ? sgt_interval_between(length.lo, x) : length;
}

/* The angle of the point x, y; y >= 0, and not both are 0; a limit, if one is infinite.
 * With q = y / |x|: if q > 2^64, it is within 2^-64 of pi/2.  If q < 2^-64 and x < 0, it
 * is within 2^-64 of pi.  If q < 2^-64 and x > 0, it is q, less at most q^3 / 3. */
static inline sgt_interval sgt_angle_at(double y, double x)
{
    const sgt_pair half = sgt_pair_half_pi(), pi = sgt_pair_scaled(half, 2);
    double f, g;
    sgt_pair t;
    int k, k_y;
    if ((y == 0 && x > 0) || x > DBL_MAX) return sgt_interval_of(0);
    if (y == 0 || x < -DBL_MAX) return sgt_interval_of_pair(pi);
    if (x == 0 || y > DBL_MAX) return sgt_interval_of_pair(half);
    f = sgt_pair_fraction(fabs(x), &k), g = sgt_pair_fraction(y, &k_y);
    if (k_y - k > 64) return sgt_interval_of_pair(half);
    if (x < 0 && k_y - k < -64) return sgt_interval_of_pair(pi);
    t = sgt_pair_quotient(sgt_pair_of(g), sgt_pair_of(f));
    if (k_y - k < -64) return sgt_interval_of_pair_times(t, k_y - k);
    t = sgt_pair_arc_tangent(sgt_pair_scaled(t, sgt_pair_two_to(k_y - k)));
    if (x < 0) t = sgt_pair_difference(pi, t);
    return sgt_interval_of_pair(t);
}

/* The sine of turn.n + quarters quarter turns and the rest; x is what the turn is of. */
static inline sgt_interval sgt_sine_at(double x, sgt_turn turn, int quarters)
{
    int n = (turn.n + quarters) & 3;
    sgt_pair s;
    sgt_interval y;
    if (x == 0) return sgt_interval_of(quarters);
    if (sgt_is_tiny(x) && !quarters) return sgt_interval_beside(x, false);
    s = n & 1 ? sgt_pair_cosine(turn.rest, -1) : sgt_pair_sine(turn.rest, -1);
    y = sgt_interval_of_pair(n & 2 ? sgt_pair_negative(s) : s);
    return sgt_interval_between(y.lo < -1 ? -1 : y.lo, y.hi > 1 ? 1 : y.hi);
}

static inline sgt_interval sgt_tangent_at(double x, sgt_turn turn)
{
    sgt_pair sine, cosine;
    if (x == 0) return sgt_interval_of(0);
    if (sgt_is_tiny(x)) return sgt_interval_beside(x, true);
    sine = sgt_pair_sine(turn.rest, -1), cosine = sgt_pair_cosine(turn.rest, -1);
    return sgt_interval_of_pair(turn.n & 1
                                    ? sgt_pair_quotient(cosine, sgt_pair_negative(sine))
                                    : sgt_pair_quotient(sine, cosine));
}

/* floor(x / (pi/2)), to which 2^27 is added: never negative. */
static inline int sgt_turn_quadrant(sgt_turn turn)
{
    return 134217728 + turn.n - (turn.rest.hi < 0);
}

/* ----------------------------------------------------------- elementary functions */

typedef sgt_interval sgt_function_at(double x /* f(x) lies in what it returns */);

/* Of a function that rises all over x, or falls. */
static inline sgt_interval sgt_interval_rising(sgt_interval x, sgt_function_at *at)
{
    sgt_interval low;
    if (!(x.lo <= x.hi)) return sgt_interval_odd(x, x);
    low = at(x.lo);
    return sgt_interval_between(low.lo, x.lo < x.hi ? at(x.hi).hi : low.hi);
}

static inline sgt_interval sgt_interval_falling(sgt_interval x, sgt_function_at *at)
{
    sgt_interval low;
    if (!(x.lo <= x.hi)) return sgt_interval_odd(x, x);
    low = at(x.lo);
    return sgt_interval_between(x.lo < x.hi ? at(x.hi).lo : low.lo, low.hi);
}

static inline sgt_interval sgt_interval_cube_root(sgt_interval x)
{
    return sgt_interval_rising(x, sgt_cube_root_at);
}

static inline sgt_interval sgt_interval_exponential(sgt_interval x)
{
    return sgt_interval_rising(x, sgt_exponential_at);
}

/* The natural one, of the part of x that is above 0. */
static inline sgt_interval sgt_interval_logarithm(sgt_interval x)
{
    if (x.lo <= x.hi && x.hi <= 0) return sgt_interval_empty();
    if (x.lo < 0 && x.hi > 0) x.lo = 0;
    return sgt_interval_rising(x, sgt_logarithm_at);
}

static inline sgt_interval sgt_interval_hyperbolic_sine(sgt_interval x)
{
    return sgt_interval_rising(x, sgt_hyperbolic_sine_at);
}

static inline sgt_interval sgt_interval_hyperbolic_cosine(sgt_interval x)
{
    if (x.lo <= x.hi) x = sgt_interval_absolute(x);
    return sgt_interval_rising(x, sgt_hyperbolic_cosine_at);
}

static inline sgt_interval sgt_interval_hyperbolic_tangent(sgt_interval x)
{
    return sgt_interval_rising(x, sgt_hyperbolic_tangent_at);
}

/* The sine of x + quarters pi/2.  It is 1 where the quadrants 1, 5, 9 ... begin, and -1
 * where 3, 7, 11 ... do. */
static inline sgt_interval sgt_interval_wave(sgt_interval x, int quarters)
{
    sgt_interval y = {-1, 1}, low, high;
    sgt_turn from, to;
    int p, q;
    if (!(x.lo <= x.hi)) return sgt_interval_odd(x, x);
    if (!(x.lo >= -SGT_TURN_LIMIT && x.hi <= SGT_TURN_LIMIT)) return y;
    from = sgt_turn_of(x.lo), low = sgt_sine_at(x.lo, from, quarters);
    if (x.lo == x.hi) return low;
    to = sgt_turn_of(x.hi), high = sgt_sine_at(x.hi, to, quarters);
    p = sgt_turn_quadrant(from) + quarters, q = sgt_turn_quadrant(to) + quarters;
    if ((p + 3) / 4 == (q + 3) / 4) y.hi = low.hi > high.hi ? low.hi : high.hi;
    if ((p + 1) / 4 == (q + 1) / 4) y.lo = low.lo < high.lo ? low.lo : high.lo;
    return y;
}

static inline sgt_interval sgt_interval_sine(sgt_interval x)
{
    return sgt_interval_wave(x, 0);
}

static inline sgt_interval sgt_interval_cosine(sgt_interval x)
{
    return sgt_interval_wave(x, 1);
}

/* The poles are where the odd quadrants begin. */
static inline sgt_interval sgt_interval_tangent(sgt_interval x)
{
    sgt_interval low;
    sgt_turn from, to;
    if (!(x.lo <= x.hi)) return sgt_interval_odd(x, x);
    if (!(x.lo >= -SGT_TURN_LIMIT && x.hi <= SGT_TURN_LIMIT)) return sgt_interval_all();
    from = sgt_turn_of(x.lo), low = sgt_tangent_at(x.lo, from);
    if (x.lo == x.hi) return low;
    to = sgt_turn_of(x.hi);
    if ((sgt_turn_quadrant(from) + 1) / 2 != (sgt_turn_quadrant(to) + 1) / 2)
        return sgt_interval_all();
    return sgt_interval_between(low.lo, sgt_tangent_at(x.hi, to).hi);
}

/* In [-pi/2, pi/2], of the part of x in [-1, 1]. */
static inline sgt_interval sgt_interval_arc_sine(sgt_interval x)
{
    if (x.lo <= x.hi) x = sgt_interval_intersection(x, sgt_interval_between(-1, 1));
    return sgt_interval_rising(x, sgt_arc_sine_at);
}

/* In [0, pi], of the part of x in [-1, 1]. */
static inline sgt_interval sgt_interval_arc_cosine(sgt_interval x)
{
    if (x.lo <= x.hi) x = sgt_interval_intersection(x, sgt_interval_between(-1, 1));
    return sgt_interval_falling(x, sgt_arc_cosine_at);
}

static inline sgt_interval sgt_interval_arc_tangent(sgt_interval x)
{
    return sgt_interval_rising(x, sgt_arc_tangent_at);
}

/* An end at infinity that stands for numbers beyond the largest double: the largest. */
static inline sgt_interval sgt_interval_reached(sgt_interval x)
{
    return sgt_interval_between(x.lo > 0 ? sgt_within(x.lo) : x.lo,
                                x.hi < 0 ? sgt_within(x.hi) : x.hi);
}

/* Of y >= 0.  The angle falls with x.  It rises with y where x > 0, and falls where
 * x < 0. */
static inline sgt_interval sgt_interval_angle_above(sgt_interval y, sgt_interval x)
{
    double first, last;
    if (y.hi == 0) { /* on the axis */
        if (x.lo == 0 && x.hi == 0) return sgt_interval_empty();
        return sgt_interval_between(x.hi > 0 ? 0 : sgt_angle_at(0, -1).lo,
                                    x.lo < 0 ? sgt_angle_at(0, -1).hi : 0);
    }
    first = x.hi > 0 ? y.lo : y.hi, last = x.lo < 0 ? y.lo : y.hi;
    first = sgt_angle_at(first, x.hi).lo, last = sgt_angle_at(last, x.lo).hi;
    return sgt_interval_between(first, last);
}

/* atan2(y, x): the angle of the points (x, y) from the axis of x, in [-pi, pi]; pi where
 * x < 0 and y = 0.  Of x = y = 0 there is none.  If x < 0 and both y = 0 and y < 0 are
 * among them, it is [-pi, pi]: the cut is crossed. */
static inline sgt_interval sgt_interval_angle(sgt_interval y, sgt_interval x)
{
    double below, above;
    if (!(x.lo <= x.hi && y.lo <= y.hi)) return sgt_interval_odd(x, y);
    x = sgt_interval_reached(x), y = sgt_interval_reached(y);
    if (y.lo >= 0) return sgt_interval_angle_above(y, x);
    if (y.hi < 0 || (y.hi == 0 && x.lo >= 0))
        return sgt_interval_negative(
            sgt_interval_angle_above(sgt_interval_negative(y), x));
    if (x.lo < 0) y.lo = 0, y.hi = 0, x.lo = -1; /* pi either way */
    below = -sgt_angle_at(-y.lo, x.lo).hi, above = sgt_angle_at(y.hi, x.lo).hi;
    return sgt_interval_between(below, above);
}

/* sqrt(x^2 + y^2). */
static inline sgt_interval sgt_interval_hypotenuse(sgt_interval x, sgt_interval y)
{
    sgt_interval low, high;
    if (!(x.lo <= x.hi && y.lo <= y.hi)) return sgt_interval_odd(x, y);
    x = sgt_interval_absolute(x), y = sgt_interval_absolute(y);
    low = x.lo > y.lo ? sgt_hypotenuse_at(x.lo, y.lo) : sgt_hypotenuse_at(y.lo, x.lo);
    high = x.hi > y.hi ? sgt_hypotenuse_at(x.hi, y.hi) : sgt_hypotenuse_at(y.hi, x.hi);
    return sgt_interval_between(low.lo, high.hi);
}

/* x^y = e^(y log x), of the part of x above 0, and 0^y = 0 for y > 0.  sgt_interval_power
 * is for integer exponents, and also for numbers below 0.  y log x has its extremes at
 * two of the corners. */
static inline sgt_interval sgt_interval_real_power(sgt_interval x, sgt_interval y)
{
    sgt_interval power, other;
    if (!(x.lo <= x.hi && y.lo <= y.hi)) return sgt_interval_odd(x, y);
    if (x.hi < 0 || (x.hi == 0 && y.hi <= 0)) return sgt_interval_empty();
    if (x.hi == 0) return sgt_interval_of(0);
    if (x.lo < 0) x.lo = 0;
    x = sgt_interval_reached(x), y = sgt_interval_reached(y);
    power = sgt_real_power_at(x.lo, y.lo), other = sgt_real_power_at(x.hi, y.lo);
    power = sgt_interval_hull(power, other);
    if (y.lo == y.hi) return power;
    other = sgt_real_power_at(x.lo, y.hi), power = sgt_interval_hull(power, other);
    other = sgt_real_power_at(x.hi, y.hi);
    return sgt_interval_hull(power, other);
}

#ifdef __cplusplus
}
#endif
#endif
