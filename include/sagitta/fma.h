// SPDX-License-Identifier: MIT
/* fma.h - a * b + c, rounded once, on every system.
 *
 * Error terms and outward rounding rest on it, and the fma of some C libraries is not
 * rounded once (mingw-w64's is not).  If the compiler's target has the instruction,
 * sgt_fma is that instruction.  So it is in a program for any x86-64 that runs on a
 * processor with it.  Elsewhere it is sgt_fma_exactly, which gives the same bits and
 * calls no library.
 * (The library itself is compiled once with the instruction and once without.)
 *
 * METHOD.  Where no step can overflow and no product loses bits by underflow (the ranges
 * below), the sum is worked out from error-free pieces (Boldo and Melquiond 2008,
 * "Emulation of FMA and correctly rounded sums: proved algorithms using rounding to odd",
 * IEEE Trans. Computers 57(4), 462-471, section 4):
 *
 *     u + u' = a b,   t + t' = c + u',   v + v' = u + t,   z = t' + v' rounded to odd,
 *     result = v + z,
 *
 * where u, t, v are the rounded values and u', t', v' their errors.  Rounding to odd
 * takes of the two neighbours of a sum that is not a double the one whose last bit is 1.
 * So z is never a tie of v + z, unless t' + v' is one, and the last rounding is the only
 * one.
 *     u': Dekker's product (Dekker 1971, Numer. Math. 18, 224).  Each factor is split
 *     into two halves of 26 bits, by its bits: the upper half is the factor rounded to a
 *     multiple of 2^27 units of its last place, and the lower half, which is exact, is at
 *     most 2^26 units.  So all four products of halves are doubles.
 *     t', v': Knuth's sum (TAOCP vol. 2, 4.2.2, theorem B), exact where nothing
 *     overflows.
 *
 * RANGES.  1e-289 <= |u| <= 1e307, |a|, |b| <= 4e307 and |c| <= 1e307; 1e-289 > 2^-961,
 * 1e307 < 2^1020, 4e307 < 2^1022.
 *     Above: the upper half of a factor is at most 2^1022, a product of halves at most
 *     2^1021, a sum at most 2^1022.
 *     Below: |a b| > 2^-962, so its last bit is worth at least 2^-962 2^-106 > 2^-1074:
 *     every product and sum here, and c, is a multiple of 2^-1074.  A sum of such numbers
 *     that is subnormal is exact.  So the proof, which takes exponents as unbounded, also
 *     holds for a result that cancels down to 2^-1074.
 * Most calls ask what a rounded product has left out, c = -u: that is u'.
 *
 * Outside those ranges (sgt_fma_by_integers): zero, infinity and NaN are seen to one by
 * one.  Other numbers are added as integers of 128 bits, in two words, with the highest
 * bit of each term at place 126, or 125 of a product.  The term with the lower exponent
 * is shifted down, and its lowest bit made 1 if any 1 is shifted out.  That happens only
 * if it is shifted by more than 20 places.  Then the difference has its highest bit at
 * place 123 at least, and the bit made 1 is far below the last place of the result: it
 * says on which side of a tie the sum is, and that is all that rounding asks.
 *
 * CONTRACTION.  A compiler may fuse products and sums by itself only where the target has
 * the instruction.  Then gcc, which does so by default, defines __FP_FAST_FMA (__FMA__ on
 * x86), and sgt_fma is the instruction; for clang a pragma forbids it.  sgt_fma_exactly
 * is never inlined, so that a caller compiled for another processor by an attribute does
 * not change it.
 *
 * SPEED.  3 to 7 ns a call in the ranges above, 12 to 40 ns outside (x86-64, one core of
 * an EPYC; glibc's own, without the instruction: 97 to 130 ns).
 *
 * It needs rounding to nearest, registers no wider than a double (interval.h asks for the
 * same), and no -ffast-math.  Safe in any number of threads.
 *
 * Test: tests/interval/test_fma.c. */
#ifndef SAGITTA_FMA_H
#define SAGITTA_FMA_H

#include <float.h>
#include <math.h>
#include <string.h>

#ifdef __cplusplus
extern "C" {
#endif

#if defined(__GNUC__)
#define SGT_FMA_APART static __attribute__((noinline, unused))
#else
#define SGT_FMA_APART static inline
#endif

static inline unsigned long long sgt_fma_bits(double x)
{
    unsigned long long bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}

static inline double sgt_fma_double(unsigned long long bits)
{
    double x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

/* |x| = m 2^e, 2^52 <= m < 2^53; x is finite and not 0.  Returns m. */
static inline unsigned long long sgt_fma_mantissa(double x, int *e)
{
    unsigned long long bits = sgt_fma_bits(fabs(x)), m = bits & ((1ULL << 52) - 1);
    int field = (int)(bits >> 52);
    if (field > 0) {
        *e = field - 1075;
        return m | 1ULL << 52;
    }
    for (*e = -1074; m < 1ULL << 52; m <<= 1) --*e;
    return m;
}

/* high, low shifted down by n > 0 places; the lowest bit is made 1 if any 1 is shifted
 * out. */
static inline void sgt_fma_shift_down(unsigned long long *high, unsigned long long *low,
                                      int n)
{
    unsigned long long lost;
    if (n >= 128) {
        lost = *high | *low, *high = *low = 0;
    } else if (n >= 64) {
        lost = n > 64 ? *low | *high << (128 - n) : *low;
        *low = *high >> (n - 64), *high = 0;
    } else {
        lost = *low << (64 - n);
        *low = *low >> n | *high << (64 - n), *high >>= n;
    }
    *low |= lost != 0;
}

/* Any doubles, by integers. */
SGT_FMA_APART double sgt_fma_by_integers(double a, double b, double c)
{
    const unsigned long long half = 0xffffffffULL, top = 1ULL << 63;
    unsigned long long sign = (sgt_fma_bits(a) ^ sgt_fma_bits(b)) & top;
    unsigned long long sign_c = sgt_fma_bits(c) & top, x, y, lower, middle, high, low;
    unsigned long long high_c, low_c, bits, lost;
    int ea, eb, e, ec, by, field;
    if (!(fabs(a) <= DBL_MAX && fabs(b) <= DBL_MAX)) return a * b + c;
    if (!(fabs(c) <= DBL_MAX)) return c + c; /* and not a * b + c: a * b may overflow */
    if (a == 0 || b == 0) return a * b + c;
    if (c == 0) return a * b; /* if it rounds to 0, that has the sign of the product */

    /* the product, 2^104 <= ... < 2^106, then 21 places up */
    x = sgt_fma_mantissa(a, &ea), y = sgt_fma_mantissa(b, &eb);
    lower = (x & half) * (y & half);
    middle = (x >> 32) * (y & half) + (lower >> 32);           /* < 2^53 + 2^32 */
    high = (x >> 32) * (y >> 32) + (middle >> 32);
    middle = (x & half) * (y >> 32) + (middle & half);         /* < 2^54 */
    high += middle >> 32, low = (middle & half) << 32 | (lower & half);
    high = high << 21 | low >> 43, low <<= 21, e = ea + eb - 21;
    high_c = sgt_fma_mantissa(c, &ec) << 10, low_c = 0, ec -= 74;

    if (e > ec) sgt_fma_shift_down(&high_c, &low_c, e - ec);
    else if (e < ec) sgt_fma_shift_down(&high, &low, ec - e), e = ec;
    if (sign == sign_c) {
        low += low_c, high += high_c + (low < low_c);
    } else if (high > high_c || (high == high_c && low >= low_c)) {
        high -= high_c + (low < low_c), low -= low_c;
    } else {
        high = high_c - high - (low_c < low), low = low_c - low, sign = sign_c;
    }
    if ((high | low) == 0) return 0;

    /* the highest bit to place 63 of high; what low has left, to its lowest bit */
    if (high == 0) high = low, low = 0, e -= 64;
    for (by = 32; by > 0; by >>= 1)
        if (high >> (64 - by) == 0)
            high = high << by | low >> (64 - by), low <<= by, e -= by;
    high |= low != 0;
    e += 64; /* the sum is high 2^e, and the double high 2^-11 2^(e + 11) */

    field = e + 11 + 1075; /* of the exponent, if the number is normal */
    if (field >= 2047) return sgt_fma_double(sign | 0x7ffULL << 52);
    by = field > 0 ? 11 : 12 - field; /* places below the last one that the double has */
    if (by > 63) return sgt_fma_double(sign | (by == 64 && high > top ? 1 : 0));
    lost = high & ((1ULL << by) - 1), bits = high >> by;
    if (field > 1) /* the bit of 2^52 adds 1 */
        bits += (unsigned long long)(field - 1) << 52;
    if (lost > 1ULL << (by - 1) || (lost == 1ULL << (by - 1) && (bits & 1)))
        bits++; /* carries to the next binade, or to infinity */
    return sgt_fma_double(sign | bits);
}

/* The same without the instruction: any doubles, infinities, NaN and subnormal numbers
 * included, rounded to nearest, ties to even; signs of zero as C's fma has them; the
 * exception flags are not kept. */
SGT_FMA_APART double sgt_fma_exactly(double a, double b, double c)
{
#if defined(__clang__)
#pragma STDC FP_CONTRACT OFF
#endif
    const unsigned long long half_unit = 1ULL << 26, upper = ~((1ULL << 27) - 1);
    double u = a * b, size = fabs(u), a_high, a_low, b_high, b_low, u_low;
    double t, t_low, v, v_low, z, z_low, by;
    if (!(size >= 1e-289 && size <= 1e307 && fabs(a) <= 4e307 && fabs(b) <= 4e307
          && fabs(c) <= 1e307))
        return sgt_fma_by_integers(a, b, c);
    a_high = sgt_fma_double((sgt_fma_bits(a) + half_unit) & upper), a_low = a - a_high;
    b_high = sgt_fma_double((sgt_fma_bits(b) + half_unit) & upper), b_low = b - b_high;
    u_low = a_low * b_low - (((u - a_high * b_high) - a_low * b_high) - a_high * b_low);
    if (c == -u) return u_low + 0.0; /* 0 is +0 */
    t = c + u_low, by = t - c, t_low = (c - (t - by)) + (u_low - by);
    v = u + t, by = v - u, v_low = (u - (v - by)) + (t - by);
    z = t_low + v_low, by = z - t_low, z_low = (t_low - (z - by)) + (v_low - by);
    if (z_low != 0 && (sgt_fma_bits(z) & 1) == 0) /* to odd: the neighbour toward z_low */
        z = sgt_fma_double(sgt_fma_bits(z) + ((z_low > 0) == (z > 0) ? 1 : ~0ULL));
    return v + z;
}

static inline double sgt_fma(double a, double b, double c)
{
#if defined(__FMA__) || defined(__aarch64__) || defined(__s390x__) || \
    defined(__FP_FAST_FMA)
    return __builtin_fma(a, b, c);
#elif defined(__x86_64__) && defined(__GNUC__) && !defined(SGT_SET)
    if (!__builtin_cpu_supports("fma")) return sgt_fma_exactly(a, b, c);
    __asm__("vfmadd231sd %2, %1, %0" : "+x"(c) : "x"(a), "x"(b));
    return c;
#else
    return sgt_fma_exactly(a, b, c);
#endif
}

#ifdef __cplusplus
}
#endif

#endif
