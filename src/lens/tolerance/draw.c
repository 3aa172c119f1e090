// SPDX-License-Identifier: MIT
/* draw.c - the values of a trial.
 *
 * A generator by counter (Philox4x32-10) turns (seed; trial, entry, block) into 128 random bits: two numbers
 * of 53 bits.  So a trial hangs on nothing that was drawn before.
 *
 * NORMAL, cut at 2 sigma, without a function whose last bit differs between systems: x, uniform in [-2, 2],
 * is accepted with probability exp(-x^2 / 2).  An event of probability exp(-q), q in [0, 1], is von Neumann's
 * (1951): draw u1, u2, ... for as long as q > u1 > u2 > ...; the number of those is even with probability
 * 1 - q + q^2/2! - ... = exp(-q).  x^2 / 2 is at most 2, so two events of q = x^2 / 4 make one.  Some 1.7
 * candidates are needed on average; after BUDGET of them (never seen: 0.6^256) the middle is taken. */
#include "tolerance.h"

typedef struct stream {
    uint32_t counter[4], key[2];
    uint32_t bits[4];
    int used;
} stream;

/* Uniform in [0, 1), a multiple of 2^-53. */
static double next_of(stream *s)
{
    if (s->used == 4) sgt_philox(s->counter, s->key, s->bits), s->counter[3]++, s->used = 0;
    const uint64_t x = (uint64_t)s->bits[s->used] << 32 | s->bits[s->used + 1];
    s->used += 2;
    return (double)(x >> 11) * 0x1p-53;
}

static bool falls_even(stream *s, double q)
{
    bool even = true;
    for (double u = next_of(s); u < q; u = next_of(s)) q = u, even = !even;
    return even;
}

static double cut_normal(stream *s)
{
    enum { BUDGET = 256 };
    for (int i = 0; i < BUDGET; i++) {
        const double x = 4 * next_of(s) - 2, q = x * x / 4;
        if (falls_even(s, q) && falls_even(s, q)) return x;
    }
    return 0;
}

void sgt_tolerancing_draw(const sgt_tolerancing *t, uint64_t seed, uint64_t trial, double value[])
{
    for (size_t i = 0; i < t->count; i++) {
        const sgt_tolerance *e = &t->entry[i];
        stream s = {.counter = {(uint32_t)trial, (uint32_t)(trial >> 32), (uint32_t)i, 0},
                    .key = {(uint32_t)seed, (uint32_t)(seed >> 32)},
                    .used = 4};
        const double half = (e->upper - e->lower) / 2, middle = e->lower + half;
        value[i] = 0;
        if (e->compensator) continue;
        switch (e->distribution) {
        case SGT_UNIFORM:
            value[i] = e->lower + 2 * half * next_of(&s);
            break;
        case SGT_NORMAL:
            value[i] = middle + half / 2 * cut_normal(&s);
            break;
        case SGT_ENDS:
            value[i] = next_of(&s) < 0.5 ? e->lower : e->upper;
            break;
        }
    }
}
