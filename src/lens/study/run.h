// SPDX-License-Identifier: MIT
/* run.h - exact sums of w x and w x x over a run of rays that all have the same weight w.
 *
 * Most rays have the weight of the one before.  So x, or x x, is summed without it, in 192 bits with a sign,
 * and the sum is multiplied by w once, when the weight changes or the rays end (exact_run_end).  It is the
 * same exact sum as by exact_add_square and its kin, at half the cost or less.
 *
 * THE WINDOW.  The lowest bit of the 192 is that of an x of the exponent `low`.  Exponents up to 31 above it
 * have room: a square has 106 bits, and is shifted by 62 at most, which leaves 23 for carries.  A larger x
 * ends the run and begins another with a window about itself.  A smaller one (also 0, and what is not finite)
 * goes to the accumulator by itself. */
#ifndef SGT_STUDY_RUN_H
#define SGT_STUDY_RUN_H
#include "exact.h"

enum { RUN_ABOVE = 31, RUN_BELOW = 15, RUN_MOST = 1 << 20 };

/* square: of x x; else of x. */
typedef struct exact_run { uint64_t q[3]; unsigned low; bool square; } exact_run;

/* An empty run: those of x, and of x x. */
#define RUN_OF_FIRST {.low = 1}
#define RUN_OF_SQUARE {.low = 1, .square = true}

/* Adds w times the run to s, and empties it.  w is finite. */
void sgt_exact_run_end(exact_run *r, exact *s, double w);

/* q += (-1)^negative (low + high 2^64) 2^shift, shift < 64 */
static inline void exact_run_put(uint64_t q[3], uint64_t low, uint64_t high, unsigned shift,
                                 uint64_t negative)
{
    const uint64_t sign = -negative, a = (low << shift) ^ sign;
    const uint64_t b = (high << shift | (low >> 1) >> (63 - shift)) ^ sign;
    const uint64_t c = ((high >> 1) >> (63 - shift)) ^ sign;
    const uint64_t q0 = q[0] + a, carry0 = q0 < a, q0n = q0 + negative, one0 = q0n < q0;
    const uint64_t q1 = q[1] + b, carry1 = q1 < b, up = carry0 + one0, q1n = q1 + up, one1 = q1n < q1;
    q[0] = q0n, q[1] = q1n, q[2] += c + carry1 + one1;
}

/* Can an x of this exponent be added?  It may end the run. */
static inline bool exact_run_has(exact_run *r, exact *s, double w, unsigned at, uint64_t mantissa)
{
    enum { LARGEST = 2046 }; /* of a finite number */
    if (at - r->low <= RUN_ABOVE) return true;
    if (at < r->low || at == 2047 || !mantissa) return false;
    sgt_exact_run_end(r, s, w);
    r->low = at > RUN_BELOW ? at - RUN_BELOW : 1;
    if (r->low > LARGEST - RUN_ABOVE) r->low = LARGEST - RUN_ABOVE; /* infinities and NaN are above a run */
    return true;
}

/* s += w x x, of which some may still be in the run. */
static inline void exact_run_square(exact_run *r, exact *s, double w, double x)
{
    const exact_parts p = exact_parts_of(x);
    uint64_t high;
    if (!exact_run_has(r, s, w, p.at, p.mantissa)) {
        exact_add_square(s, w, x);
        return;
    }
    const uint64_t low = exact_times(p.mantissa, p.mantissa, &high);
    exact_run_put(r->q, low, high, 2 * (p.at - r->low), 0);
}

/* s += w x */
static inline void exact_run_add(exact_run *r, exact *s, double w, double x)
{
    const exact_parts p = exact_parts_of(x);
    if (exact_run_has(r, s, w, p.at, p.mantissa))
        exact_run_put(r->q, p.mantissa, 0, p.at - r->low, p.negative);
    else exact_add_product(s, w, x);
}

#endif
