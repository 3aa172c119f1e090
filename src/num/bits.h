// SPDX-License-Identifier: MIT
/* bits.h - powers of two, nearest integers and the larger of two numbers, without the C library.
 *
 * They do what C's frexp, ldexp, ilogb, rint, fmax and fmin do, exactly, on every system.  A finite double
 * that is not 0 is m 2^e with 1/2 <= |m| < 1.  Its bits are the sign, e + 1022 and the digits of m.  A
 * subnormal number is first multiplied by 2^64, which is exact.
 *
 * nextafter toward infinity is sgt_next_above of interval.h.
 *
 * Test: tests/unit/test_bits.c. */
#ifndef SGT_NUM_BITS_H
#define SGT_NUM_BITS_H

#include "exact.h"

#include <float.h>
#include <string.h>

/* The smaller, by one instruction; b if a is NaN.  (`larger` is in exact.h.) */
SGT_INLINE double smaller(double a, double b) { return a < b ? a : b; }

/* The larger, or the smaller, of a and b.  If one of them is NaN, the other is returned.  That is what
 * maximumNumber and minimumNumber of IEEE 754-2019 (section 9.6) do, but for zeros: there -0 is below +0,
 * and here b is returned if a and b are both zero. */
SGT_INLINE double maximum_number(double a, double b) { return a > b || b != b ? a : b; }
SGT_INLINE double minimum_number(double a, double b) { return a < b || b != b ? a : b; }

/* x to an integer, ties to even, with the sign of x.  Infinities and NaN stay.  Between 2^52 and 2^53 the
 * doubles are the integers.  So |x| + 2^52 is rounded to an integer, and the difference is exact. */
SGT_INLINE double nearest_integer(double x)
{
    double size = fabs(x);
    return size < 0x1p52 ? copysign((size + 0x1p52) - 0x1p52, x) : x;
}

/* 2^n for any n: infinity above the largest double, 0 below 2^-1074. */
SGT_INLINE double power_of_two(int n)
{
    unsigned long long bits = n > 1023 ? 2047ULL << 52 : n >= -1022 ? (unsigned long long)(n + 1023) << 52
                            : n >= -1074 ? 1ULL << (n + 1074) : 0;
    double x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

/* Returns m and sets *e, with x = m 2^e and 1/2 <= |m| < 1.  0, infinities and NaN are returned as they
 * are, with *e = 0. */
SGT_INLINE double binary_mantissa(double x, int *e)
{
    unsigned long long bits;
    *e = 0;
    if (!(x != 0 && fabs(x) <= DBL_MAX)) return x;
    if (fabs(x) < DBL_MIN) x *= 0x1p64, *e = -64;
    memcpy(&bits, &x, sizeof bits);
    *e += (int)(bits >> 52 & 2047) - 1022;
    bits = (bits & ~(2047ULL << 52)) | 1022ULL << 52;
    memcpy(&x, &bits, sizeof x);
    return x;
}

/* The e with 2^e <= |x| < 2^(e + 1); x is finite and not 0. */
SGT_INLINE int binary_exponent(double x)
{
    int e;
    (void)binary_mantissa(x, &e);
    return e - 1;
}

/* x 2^n, rounded once.  If 2^n is not a normal number, x is taken apart: m 2^k has one rounding, in the
 * product with a subnormal 2^k.  Below 2^-1074 half of it may still round up, and a quarter never does. */
SGT_INLINE double times_power_of_two(double x, int n)
{
    int k;
    if (n >= -1022 && n <= 1023) return x * power_of_two(n);
    if (!(x != 0 && fabs(x) <= DBL_MAX)) return x;
    double m = 2 * binary_mantissa(x, &k);
    n = n > 4000 ? 4000 : n < -4000 ? -4000 : n, k += n - 1;
    if (k < -1074) m *= k == -1075 ? 0.5 : 0.25, k = -1074;
    return m * power_of_two(k);
}

#endif
