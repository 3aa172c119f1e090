// SPDX-License-Identifier: MIT
/* exact.h - sums of doubles, and of products of two or three, without any rounding.
 *
 * THE ACCUMULATOR is Kulisch's long one (Kulisch & Miranker 1986, SIAM Review 28, 1): a number of fixed point
 * that has a place for each bit of each summand.  The lowest bit of a product of three doubles is worth
 * 2^-3222, as that of one is worth 2^-1074, and every such product is below 2^3072.  So a sum has no error
 * and no order: whatever comes first, and however it is divided, the bits are the same.
 *
 * ITS FORM is that of Neal's small superaccumulator (Neal 2015, arXiv:1505.05571): words that are worth
 * 2^32 times the one before, in integers of 64 bits.  A summand adds less than 2^32 to each word that it
 * meets, with its sign.  So 2^30 of them have room before carries have to be taken.
 *
 * A PRODUCT is worked out in integers: mantissas of 53 bits make 106 bits, or 159 of three.  Nothing is split
 * into a rounded product and its error, so there is no underflow to look at, and no fma.
 *
 * INFINITIES AND NaN are noted apart.  A NaN among the summands, or infinities of both signs, make the sum a
 * NaN; infinities of one sign make it this infinity: as the set of the summands says, in any order.
 *
 * COST, in instructions: some 30 for a number, 60 for w x, 100 for w x x; by run.h, where weights repeat, 25.
 * 1.6 KB. */
#ifndef SGT_STUDY_EXACT_H
#define SGT_STUDY_EXACT_H
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

enum { EXACT_WORDS = 200, EXACT_LOWEST = -3222, EXACT_ADDS = 1 << 30 };
enum { EXACT_ABOVE = 1, EXACT_BELOW = 2, EXACT_NONE = 4 }; /* +infinity, -infinity, NaN */

/* Zero bytes are the empty sum. */
typedef struct exact {
    int64_t word[EXACT_WORDS];
    uint32_t adds;              /* since carries were taken */
    uint32_t odd;               /* which numbers that are not finite there were */
} exact;

/* Takes carries: words from 0 to 2^32 - 1, but the last, which has the sign. */
void sgt_exact_carry(exact *s);

/* s += more */
void sgt_exact_merge(exact *s, const exact *more);

/* The sum rounded to nearest, ties to even; what that leaves, rounded, in *rest (may be NULL). */
double sgt_exact_value(const exact *s, double *rest);

/* Notes a summand that is not finite. */
static inline void exact_note(exact *s, double x)
{
    s->odd |= isnan(x) ? EXACT_NONE : x > 0 ? EXACT_ABOVE : EXACT_BELOW;
}

/* A double as (-1)^negative mantissa 2^(at - 1075), at from 1 on; at 2047: not finite. */
typedef struct exact_parts { uint64_t mantissa, negative; unsigned at; } exact_parts;

static inline exact_parts exact_parts_of(double x)
{
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    const unsigned at = (unsigned)(bits >> 52) & 2047;
    const uint64_t fraction = bits & ((UINT64_C(1) << 52) - 1);
    return (exact_parts){fraction | (uint64_t)(at > 0) << 52, bits >> 63, at + (at == 0)};
}

/* The low 64 bits of a b, and *high the others. */
static inline uint64_t exact_times(uint64_t a, uint64_t b, uint64_t *high)
{
#ifdef __SIZEOF_INT128__
    __extension__ typedef unsigned __int128 wide;
    const wide all = (wide)a * b;
    return *high = (uint64_t)(all >> 64), (uint64_t)all;
#else
    const uint64_t half = 0xffffffffu, low = (a & half) * (b & half);
    const uint64_t middle = (a >> 32) * (b & half) + (low >> 32);
    const uint64_t other = (a & half) * (b >> 32) + (middle & half);
    *high = (a >> 32) * (b >> 32) + (middle >> 32) + (other >> 32);
    return other << 32 | (low & half);
#endif
}

/* Adds one word of 32 bits; sign: 0, or -1. */
static inline void exact_word(int64_t *to, uint64_t bits, int64_t sign)
{
    *to += ((int64_t)(bits & 0xffffffffu) ^ sign) - sign;
}

/* Adds (-1)^negative (q[0] + q[1] 2^64 + ...) 2^(at + EXACT_LOWEST), of so many words; at + 64 words is below
 * 6400. */
static inline void exact_put(exact *s, uint64_t negative, const uint64_t q[], size_t words, unsigned at)
{
    const unsigned shift = at % 32;
    const int64_t sign = -(int64_t)negative;
    int64_t *to = s->word + at / 32;
    uint64_t carry = 0;
    for (size_t i = 0; i < words; i++) {
        const uint64_t low = q[i] << shift | carry;
        carry = (q[i] >> 1) >> (63 - shift);
        exact_word(to + 2 * i, low, sign), exact_word(to + 2 * i + 1, low >> 32, sign);
    }
    exact_word(to + 2 * words, carry, sign);
    if (++s->adds >= EXACT_ADDS) sgt_exact_carry(s);
}

/* s += x */
static inline void exact_add(exact *s, double x)
{
    const exact_parts p = exact_parts_of(x);
    const uint64_t q[3] = {p.mantissa};
    if (p.at == 2047) exact_note(s, x);
    else exact_put(s, p.negative, q, 1, p.at + 2147);
}

/* s += w x */
static inline void exact_add_product(exact *s, double w, double x)
{
    const exact_parts a = exact_parts_of(w), b = exact_parts_of(x);
    uint64_t q[3] = {0};
    if (a.at == 2047 || b.at == 2047) {
        exact_note(s, w * x);
        return;
    }
    q[0] = exact_times(a.mantissa, b.mantissa, &q[1]);
    exact_put(s, a.negative ^ b.negative, q, 2, a.at + b.at + 1072);
}

/* s += w x x */
static inline void exact_add_square(exact *s, double w, double x)
{
    const exact_parts a = exact_parts_of(w), b = exact_parts_of(x);
    uint64_t q[3] = {0}, high;
    if (a.at == 2047 || b.at == 2047) {
        exact_note(s, w * fabs(x));
        return;
    }
    const uint64_t low = exact_times(b.mantissa, b.mantissa, &high);
    q[0] = exact_times(low, a.mantissa, &q[1]);
    uint64_t more, top = exact_times(high, a.mantissa, &more);
    q[1] += top, q[2] = more + (q[1] < top);
    exact_put(s, a.negative, q, 3, a.at + 2 * b.at - 3);
}

/* A mean square that rounding may have made negative.  A NaN stays: such sums have no answer. */
static inline double sgt_not_below_0(double x) { return x < 0 ? 0 : x; }

#endif
