// SPDX-License-Identifier: MIT
/* exact.c - carries, sums of sums, and the rounding of the long accumulator (exact.h). */
#include "run.h"

static const int64_t BASE = INT64_C(1) << 32;

void sgt_exact_carry(exact *s)
{
    int64_t carry = 0;
    for (size_t i = 0; i + 1 < EXACT_WORDS; i++) {
        const int64_t all = s->word[i] + carry;
        s->word[i] = all & (BASE - 1);
        carry = (all - s->word[i]) / BASE;
    }
    s->word[EXACT_WORDS - 1] += carry;
    s->adds = 1; /* what is left in a word is that of one summand */
}

void sgt_exact_merge(exact *s, const exact *more)
{
    exact own;
    if (more->adds >= EXACT_ADDS / 2) own = *more, sgt_exact_carry(&own), more = &own;
    if (s->adds >= EXACT_ADDS / 2) sgt_exact_carry(s);
    for (size_t i = 0; i < EXACT_WORDS; i++) s->word[i] += more->word[i];
    s->adds += more->adds, s->odd |= more->odd;
}

/* The bits from place `at` on, at most 64 of them, of words without carries. */
static uint64_t bits_from(const exact *s, size_t at)
{
    const size_t k = at / 32, shift = at % 32;
    uint64_t word[3] = {0};
    for (size_t i = 0; i < 3 && k + i < EXACT_WORDS; i++) word[i] = (uint64_t)s->word[k + i];
    const uint64_t low = word[0] | word[1] << 32;
    return shift ? low >> shift | word[2] << (64 - shift) : low;
}

static bool any_below(const exact *s, size_t at)
{
    for (size_t i = 0; i < at / 32; i++)
        if (s->word[i]) return true;
    return at % 32 && (s->word[at / 32] & ((INT64_C(1) << at % 32) - 1));
}

double sgt_exact_value(const exact *s, double *rest)
{
    enum { DIGITS = 53, SUBNORMAL = -1074 - EXACT_LOWEST };
    exact all = *s;
    if (rest) *rest = 0;
    if (s->odd & EXACT_NONE || (s->odd & EXACT_ABOVE && s->odd & EXACT_BELOW)) return (double)NAN;
    if (s->odd) return s->odd & EXACT_ABOVE ? HUGE_VAL : -HUGE_VAL;
    sgt_exact_carry(&all);
    const bool negative = all.word[EXACT_WORDS - 1] < 0;
    if (negative) {
        for (size_t i = 0; i < EXACT_WORDS; i++) all.word[i] = -all.word[i];
        sgt_exact_carry(&all);
    }
    size_t top = EXACT_WORDS;
    while (top > 0 && !all.word[top - 1]) top--;
    if (top == 0) return 0;
    size_t above = 32 * (top - 1); /* the place above the highest bit */
    for (int64_t word = all.word[top - 1]; word; word >>= 1) above++;
    const size_t least = above > SUBNORMAL + DIGITS ? above - DIGITS : SUBNORMAL; /* that of the last digit */
    const uint64_t mask = (UINT64_C(1) << DIGITS) - 1, half = bits_from(&all, least - 1) & 1;
    uint64_t digits = bits_from(&all, least) & mask;
    digits += half && (any_below(&all, least - 1) || digits & 1);
    const double size = ldexp((double)digits, (int)least + EXACT_LOWEST), value = negative ? -size : size;
    if (rest && isfinite(value)) {
        exact left = *s;
        exact_add(&left, -value);
        *rest = sgt_exact_value(&left, NULL);
    }
    return value;
}

void sgt_exact_run_end(exact_run *r, exact *s, double w)
{
    const exact_parts p = exact_parts_of(w);
    const uint64_t below = r->q[2] >> 63, sign = -below;
    uint64_t q[4] = {0}, carry = below;
    for (size_t i = 0; i < 3; i++) { /* times the weight, without the sign */
        const uint64_t size = (r->q[i] ^ sign) + carry;
        uint64_t high, low = exact_times(size, p.mantissa, &high);
        carry = carry && !size;
        q[i] += low, q[i + 1] = high + (q[i] < low);
    }
    if (r->q[0] | r->q[1] | r->q[2])
        exact_put(s, p.negative ^ below, q, 4, p.at + (r->square ? 2 * r->low - 3 : r->low + 1072));
    *r = (exact_run){.low = 1, .square = r->square};
}
