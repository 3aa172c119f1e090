// SPDX-License-Identifier: MIT
/* sgt_fma_exactly of fma.h against MPFR (mpfr_fma and mpfr_subnormalize) and against the processor's
 * instruction, whichever there are.
 *
 *     test_fma      SAGITTA_TEST_SCALE=10: 2 10^7 random cases; SAGITTA_TEST_SEED
 *
 * All bits have to be the same, the sign of a zero too; of two NaN the bits are not compared.
 *
 * Random doubles with random exponents reach neither ties nor cancellation.  So each kind of case below is
 * drawn on purpose, and the ways through the code that the cases take are counted.  Each way has to be
 * taken. */
#include <sagitta/fma.h>

#include "random_bits.h"
#include "fma_instruction.h"

#include <float.h>
#include <inttypes.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#if defined(WITH_MPFR)
#include <mpfr.h>
#endif

/* ------------------------------------------------------------------ random doubles */

static int between(int lo, int hi) { return lo + (int)(random_bits() % (uint64_t)(hi - lo + 1)); }

/* A double of `bits` significant bits at most, all of them 0 or 1 at random or nearly all alike, about
 * 2^exponent. */
static double drawn(int bits, int exponent)
{
    uint64_t m = random_bits() >> (64 - bits);
    int kind = between(0, 3);
    if (kind == 0) m = 1u + (m & 1u);
    if (kind == 1) m = (UINT64_C(1) << bits) - 1 - (m & 3);
    m |= UINT64_C(1) << (bits - 1);
    double x = ldexp((double)m, exponent - bits + 1);
    return random_bits() & 1 ? x : -x;
}

/* x moved by so many doubles; x and the result are finite and not 0. */
static double moved(double x, int by) { return sgt_fma_double(sgt_fma_bits(x) + (unsigned long long)by); }

static double of_bits(uint64_t bits) { return sgt_fma_double(bits); }

enum { KINDS = 10 };
typedef struct operands { double a, b, c; } operands;

static operands draw(int kind)
{
    operands x = {drawn(53, between(-40, 40)), drawn(53, between(-40, 40)), 0};
    int place, bits;
    switch (kind) {
    case 0: /* anything */
        return (operands){of_bits(random_bits()), of_bits(random_bits()), of_bits(random_bits())};
    case 1: /* terms whose bits may overlap */
        x.c = drawn(53, between(-200, 200));
        return x;
    case 2: /* what a product leaves out */
        x.c = -(x.a * x.b);
        return x;
    case 3: /* the same nearly: cancellation */
        x.c = moved(-(x.a * x.b), between(-3, 3));
        return x;
    case 4: /* a product that is a tie, and a c of any size, that decides */
        x.a = drawn(27, between(-400, 400)), x.b = drawn(27, between(-400, 400));
        x.a = moved(x.a, (sgt_fma_bits(x.a) & 1u << 26) != 0 ? 0 : 1 << 26);
        x.b = moved(x.b, (sgt_fma_bits(x.b) & 1u << 26) != 0 ? 0 : 1 << 26);
        x.c = drawn(between(1, 53), between(-1074, ilogb(x.a) + ilogb(x.b) - 53));
        return x;
    case 5: /* half a unit of c */
        x.c = drawn(53, between(-900, 900)), x.a = drawn(1, between(-60, 60));
        x.b = ldexp(1, ilogb(x.c) - 53 - ilogb(x.a));
        if (between(0, 1)) x.b = moved(x.b, between(-1, 1));
        return x;
    case 6: /* a result near the smallest doubles */
        place = between(-1130, -1015), bits = between(1, 53);
        x.a = drawn(bits, between(-1000, 0)), x.b = drawn(between(1, 53), place - ilogb(x.a));
        x.c = drawn(53, between(-1074, -1015));
        if (between(0, 3) == 0) x.c = moved(random_bits() & 1 ? DBL_MIN : -DBL_MIN, between(-2, 2));
        return x;
    case 7: /* a result near the largest */
        x.a = drawn(53, between(1, 1023)), x.b = drawn(53, between(1019, 1026) - ilogb(x.a));
        x.c = drawn(53, between(900, 1023));
        if (between(0, 3) == 0) x.c = moved(random_bits() & 1 ? DBL_MAX : -DBL_MAX, between(-2, 0));
        return x;
    case 8: /* out of the ranges of twofold arithmetic, in all differences of exponents */
        place = between(-1160, -930);
        x.a = drawn(between(1, 53), between(-900, 0)), x.b = drawn(between(1, 53), place - ilogb(x.a));
        x.c = drawn(between(1, 53), between(-1074, place + 200 < -1070 ? -1060 : place + 200));
        return x;
    default: /* cancellation out of those ranges */
        place = between(-1074, -962);
        x.a = drawn(53, between(-900, -100)), x.b = drawn(53, place - ilogb(x.a));
        x.c = -(x.a * x.b);
        if (x.c != 0 && random_bits() & 1) x.c = moved(x.c, between(0, 2));
        return x;
    }
}

/* ------------------------------------------------------------- the ways through fma.h */

enum {
    ERROR_OF_PRODUCT, TWOFOLD_SMALL_C, TWOFOLD_NEAR, TWOFOLD_LARGE_C, TWOFOLD_SUBNORMAL,
    NOT_FINITE, C_NOT_FINITE, PRODUCT_ZERO, C_ZERO,
    C_DOWN, C_DOWN_64, C_DOWN_128, NONE_DOWN, PRODUCT_DOWN, PRODUCT_DOWN_64, PRODUCT_DOWN_128,
    CANCELS, OVERFLOWS, NORMAL, LEAST_NORMAL, SUBNORMAL, LEAST_SUBNORMAL, TO_ZERO, WAYS
};
static const char *const way_names[] = {
    "error of a product", "twofold, c small", "twofold", "twofold, c large", "twofold, subnormal",
    "infinity or NaN", "c infinite or NaN", "0 times b", "c = 0",
    "c down", "c down 64", "c down 128", "none down", "product down", "product down 64", "product down 128",
    "cancels", "overflows", "normal", "2^-1022", "subnormal", "2^-1074", "to 0"};
static long taken[WAYS];

/* Counts the ways that the operands take, whose right result is r. */
static void count(operands x, double r)
{
    double u = x.a * x.b, size = fabs(r);
    if (fabs(u) >= 1e-289 && fabs(u) <= 1e307 && fabs(x.a) <= 4e307 && fabs(x.b) <= 4e307
        && fabs(x.c) <= 1e307) {
        int d = x.c == 0 ? INT32_MIN : ilogb(x.c) - ilogb(u);
        taken[x.c == -u ? ERROR_OF_PRODUCT : d < -60 ? TWOFOLD_SMALL_C : d > 60 ? TWOFOLD_LARGE_C
              : TWOFOLD_NEAR]++;
        taken[TWOFOLD_SUBNORMAL] += size < DBL_MIN;
        return;
    }
    if (!isfinite(x.a) || !isfinite(x.b)) {
        taken[NOT_FINITE]++;
    } else if (!isfinite(x.c)) {
        taken[C_NOT_FINITE]++;
    } else if (x.a == 0 || x.b == 0) {
        taken[PRODUCT_ZERO]++;
    } else if (x.c == 0) {
        taken[C_ZERO]++;
    } else {
        int down = (ilogb(x.a) + ilogb(x.b) - 104 - 21) - (ilogb(x.c) - 52 - 74);
        taken[down >= 128 ? C_DOWN_128 : down >= 64 ? C_DOWN_64 : down > 0 ? C_DOWN : down == 0 ? NONE_DOWN
              : down > -64 ? PRODUCT_DOWN : down > -128 ? PRODUCT_DOWN_64 : PRODUCT_DOWN_128]++;
        taken[r == 0 ? (u == -x.c ? CANCELS : TO_ZERO) : size == HUGE_VAL ? OVERFLOWS
              : size == 0x1p-1074 ? LEAST_SUBNORMAL : size < DBL_MIN ? SUBNORMAL
              : size == DBL_MIN ? LEAST_NORMAL : NORMAL]++;
    }
}

/* -------------------------------------------------------------------------- oracles */

static long faults;

static void complain(const char *oracle, operands x, double got, double want)
{
    if (++faults <= 20) printf("%a * %a + %a: %a, by %s %a\n", x.a, x.b, x.c, got, oracle, want);
}

static bool alike(double a, double b) { return (isnan(a) && isnan(b)) || sgt_fma_bits(a) == sgt_fma_bits(b); }

#if defined(WITH_MPFR)
static mpfr_t first, second, third, sum;

static double by_mpfr(operands x)
{
    mpfr_set_d(first, x.a, MPFR_RNDN), mpfr_set_d(second, x.b, MPFR_RNDN), mpfr_set_d(third, x.c, MPFR_RNDN);
    int inexact = mpfr_fma(sum, first, second, third, MPFR_RNDN);
    mpfr_subnormalize(sum, inexact, MPFR_RNDN);
    return mpfr_get_d(sum, MPFR_RNDN);
}
#endif

static void check(operands x)
{
    double got = sgt_fma_exactly(x.a, x.b, x.c), other = sgt_fma_by_integers(x.a, x.b, x.c), right = got;
    if (!alike(got, other)) complain("integers", x, got, other);
    other = sgt_fma_exactly(x.b, x.a, x.c);
    if (!alike(got, other)) complain("b * a", x, got, other);
    if (fma_instruction_is_there()) {
        right = fma_instruction(x.a, x.b, x.c);
        if (!alike(got, right)) complain("the instruction", x, got, right);
    }
#if defined(WITH_MPFR)
    right = by_mpfr(x);
    if (!alike(got, right)) complain("MPFR", x, got, right);
#endif
    count(x, right);
}

static double either(const double list[], int i) { return i & 1 ? -list[i / 2] : list[i / 2]; }

int main(void)
{
    /* DBL_MAX + 2^970 is the tie between DBL_MAX and infinity, 2^-1022 the boundary of subnormal numbers */
    static const double special[] = {
        0, 0x1p-1074, 0x1p-1073, 0x1.8p-1073, 0x0.fffffffffffffp-1022, 0x1p-1022, 0x1.0000000000001p-1022,
        0x1p-969, 0x1p-537, 0x1.fffffffffffffp-538, 0x1p-512, 0x1p-53, 0x1p-54, 0x1.0000000000001p-54,
        0.5, 0x1.fffffffffffffp-1, 1, 0x1.0000000000001p0, 1.5, 3, 0x1p52, 0x1p53,
        0x1p511, 0x1.fffffffffffffp511, 0x1p512, 0x1p970, 0x1.fffffffffffffp969, 0x1.0000000000001p970,
        0x1p1022, 0x1p1023, DBL_MAX, HUGE_VAL, (double)NAN};
    enum { SPECIAL = sizeof special / sizeof special[0] };
    const char *seed = getenv("SAGITTA_TEST_SEED"), *scale = getenv("SAGITTA_TEST_SCALE");
    state = seed ? strtoull(seed, NULL, 0) : 1;
    long n = (long)(2e6 * (scale ? atof(scale) : 0.5)), all = 0;
    printf("SAGITTA_TEST_SEED=%" PRIu64 "\n", state);
#if defined(WITH_MPFR)
    mpfr_inits2(53, first, second, third, sum, (mpfr_ptr)0);
    mpfr_set_emin(-1073), mpfr_set_emax(1024);
    printf("against MPFR\n");
#endif
    if (fma_instruction_is_there()) printf("against the processor's instruction\n");

    for (int i = 0; i < 2 * SPECIAL; i++)
        for (int j = 0; j < 2 * SPECIAL; j++)
            for (int k = 0; k < 2 * SPECIAL; k++, all++)
                check((operands){either(special, i), either(special, j), either(special, k)});
    for (long i = 0; i < n; i++, all++) check(draw((int)(i % KINDS)));

    for (int i = 0; i < WAYS; i++) {
        printf("%10ld %s\n", taken[i], way_names[i]);
        if (!taken[i]) faults++, printf("           never taken\n");
    }
    printf("%ld cases, %ld faults\n", all, faults);
    return faults != 0;
}
