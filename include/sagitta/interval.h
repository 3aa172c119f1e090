/* interval.h - intervals of doubles, rounded outward: what is needed to write `enclose`.
 *
 * An interval is the set of the real numbers x with lo <= x <= hi.  An end at infinity
 * says that there is no end.  Each operation returns an interval that contains every
 * value its operation has on members of its arguments, where it has one: the set-based
 * flavour of IEEE 1788-2015, without its decorations.
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
 * 0 * INFINITY is 0: an end at infinity is no number, and 0 times each number is 0.
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

static inline sgt_interval sgt_interval_negative(sgt_interval x)
{
    if (!(x.lo <= x.hi)) return sgt_interval_odd(x, x);
    return sgt_interval_between(-x.hi, -x.lo);
}

static inline sgt_interval sgt_interval_sum(sgt_interval x, sgt_interval y)
{
    if (!(x.lo <= x.hi && y.lo <= y.hi)) return sgt_interval_odd(x, y);
    return sgt_interval_between(-sgt_sum_above(-x.lo, -y.lo), sgt_sum_above(x.hi, y.hi));
}

static inline sgt_interval sgt_interval_difference(sgt_interval x, sgt_interval y)
{
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

#ifdef __cplusplus
}
#endif
#endif
