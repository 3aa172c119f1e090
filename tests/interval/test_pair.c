// SPDX-License-Identifier: MIT
/* pair.h against MPFR: each operation and function is within the bound that its head proves.
 *
 *     test_pair      SAGITTA_TEST_SCALE multiplies the random cases, SAGITTA_TEST_SEED
 *
 * Errors are relative, and printed as powers of two, with the worst argument.  An error below 2^-30 of its
 * bound is a fault, too: then nothing was measured. */
#include "random_bits.h"
#include <sagitta/pair.h>

#include <inttypes.h>
#include <mpfr.h>
#include <stdio.h>
#include <stdlib.h>

static double uniform(double lo, double hi)
{
    return lo + (hi - lo) * ldexp((double)(random_bits() >> 11), -53);
}

/* From 2^lo to 2^hi, either sign. */
static double any_size(int lo, int hi)
{
    double x = ldexp(uniform(1, 2), lo + (int)(random_bits() % (unsigned)(hi - lo)));
    return random_bits() & 1 ? x : -x;
}

static sgt_pair any_pair(double hi) { return sgt_pair_joined(hi, hi * uniform(-0x1p-54, 0x1p-54)); }

static mpfr_t x, y, right, off;

static void set(mpfr_t to, sgt_pair from)
{
    mpfr_set_d(to, from.hi, MPFR_RNDN);
    mpfr_add_d(to, to, from.lo, MPFR_RNDN);
}

typedef struct bound { const char *name; int proven; double worst, at; } bound;

/* got against `right`, times 2^k. */
static void note(bound *b, sgt_pair got, int k, double at)
{
    set(off, got);
    mpfr_mul_2si(off, off, k, MPFR_RNDN);
    mpfr_sub(off, off, right, MPFR_RNDN);
    if (!mpfr_zero_p(right)) mpfr_div(off, off, right, MPFR_RNDN);
    double error = fabs(mpfr_get_d(off, MPFR_RNDA));
    if (got.hi + got.lo != got.hi) error = HUGE_VAL; /* hi is to be the nearest */
    if (!(error <= b->worst)) b->worst = error, b->at = at;
}

enum { SUM, PRODUCT, QUOTIENT, ROOT, EXP, LOG, LOG_NEAR, TURN, SIN, COS, SINH, COSH, ATAN, CBRT, BOUNDS };

static void try_operations(bound *b)
{
    double a = any_size(-300, 300);
    sgt_pair p = any_pair(a);
    sgt_pair q = any_pair(random_bits() & 1 ? -a * uniform(0.99, 1.01) : a * any_size(-100, 90));
    set(x, p), set(y, q);
    mpfr_add(right, x, y, MPFR_RNDN), note(&b[SUM], sgt_pair_sum(p, q), 0, a);
    if (fabs(a) < 1e40 && fabs(a) > 1e-40) {
        mpfr_mul(right, x, y, MPFR_RNDN), note(&b[PRODUCT], sgt_pair_product(p, q), 0, a);
        mpfr_div(right, x, y, MPFR_RNDN), note(&b[QUOTIENT], sgt_pair_quotient(p, q), 0, a);
    }
    if (a < 0) return;
    mpfr_sqrt(right, x, MPFR_RNDN), note(&b[ROOT], sgt_pair_root(p), 0, a);
}

static void try_exponential_and_logarithm(bound *b)
{
    int k;
    sgt_pair p = any_pair(random_bits() & 1 ? uniform(-1100, 1100) : any_size(-60, 3)), got;
    got = sgt_pair_exponential(p, &k);
    set(x, p), mpfr_exp(right, x, MPFR_RNDN), note(&b[EXP], got, k, p.hi);
    double a = fabs(any_size(-1074, 1023)), near = 1 + any_size(-52, -2);
    mpfr_set_d(x, a, MPFR_RNDN), mpfr_log(right, x, MPFR_RNDN), note(&b[LOG], sgt_pair_logarithm(a), 0, a);
    mpfr_set_d(x, near, MPFR_RNDN), mpfr_log(right, x, MPFR_RNDN);
    note(&b[LOG_NEAR], sgt_pair_logarithm(near), 0, near);
}

static void try_turns(bound *b)
{
    static const double hard[] = {0x1.6c6cbc45dc8dep5,  0x1.b951f1572eba5p23, 0x1.b951f1572eba5p24,
                                  0x1.b951f1572eba5p25, 0x1.39c6fd67805a7p18, 0x1.9eb7148f354d6p20};
    double a = random_bits() & 1 ? uniform(-0x1p26, 0x1p26) : any_size(-27, 26);
    if (random_bits() % 16 == 0) a = hard[random_bits() % 6];
    if (random_bits() % 4 == 0) a = 1.5707963267948966 * (double)(random_bits() % 40000000 + 1);
    sgt_turn turn = sgt_turn_of(a);
    mpfr_const_pi(right, MPFR_RNDN);
    mpfr_div_2si(right, right, 1, MPFR_RNDN);
    mpfr_mul_si(right, right, turn.n, MPFR_RNDN);
    mpfr_d_sub(right, a, right, MPFR_RNDN);
    note(&b[TURN], turn.rest, 0, a);
    if (!(fabs(turn.rest.hi) <= 0.7854)) b[TURN].worst = HUGE_VAL, b[TURN].at = a;
    set(x, turn.rest);
    mpfr_sin(right, x, MPFR_RNDN), note(&b[SIN], sgt_pair_sine(turn.rest, -1), 0, a);
    mpfr_cos(right, x, MPFR_RNDN), note(&b[COS], sgt_pair_cosine(turn.rest, -1), 0, a);
}

static void try_others(bound *b)
{
    sgt_pair p = any_pair(random_bits() & 1 ? uniform(-1, 1) : any_size(-60, 0));
    set(x, p);
    mpfr_sinh(right, x, MPFR_RNDN), note(&b[SINH], sgt_pair_sine(p, 1), 0, p.hi);
    mpfr_cosh(right, x, MPFR_RNDN), note(&b[COSH], sgt_pair_cosine(p, 1), 0, p.hi);
    p = any_pair(random_bits() & 1 ? uniform(0.05, 8) : fabs(any_size(-64, 64)));
    set(x, p), mpfr_atan(right, x, MPFR_RNDN), note(&b[ATAN], sgt_pair_arc_tangent(p), 0, p.hi);
    double a = uniform(1, 8);
    mpfr_set_d(x, a, MPFR_RNDN), mpfr_cbrt(right, x, MPFR_RNDN), note(&b[CBRT], sgt_pair_cube_root(a), 0, a);
}

int main(void)
{
    const char *seed = getenv("SAGITTA_TEST_SEED"), *scale = getenv("SAGITTA_TEST_SCALE");
    bound bounds[BOUNDS] = {
        [SUM] = {"sum", -101, 0, 0}, [PRODUCT] = {"product", -101, 0, 0},
        [QUOTIENT] = {"quotient", -101, 0, 0},
        [ROOT] = {"root", -101, 0, 0}, [EXP] = {"exponential", -71, 0, 0}, [LOG] = {"logarithm", -73, 0, 0},
        [LOG_NEAR] = {"logarithm near 1", -73, 0, 0}, [TURN] = {"rest of a turn", -75, 0, 0},
        [SIN] = {"sine", -71, 0, 0}, [COS] = {"cosine", -71, 0, 0}, [SINH] = {"hyperbolic sine", -71, 0, 0},
        [COSH] = {"hyperbolic cosine", -71, 0, 0}, [ATAN] = {"arc tangent", -71, 0, 0},
        [CBRT] = {"cube root", -93, 0, 0}};
    int faults = 0;
    state = seed ? strtoull(seed, NULL, 0) : 1;
    printf("SAGITTA_TEST_SEED=%" PRIu64 "\n", state);
    long n = (long)(100000 * (scale ? atof(scale) : 0.5));
    mpfr_inits2(300, x, y, right, off, (mpfr_ptr)0);
    for (long i = 0; i < n; i++) {
        try_operations(bounds), try_exponential_and_logarithm(bounds);
        try_turns(bounds), try_others(bounds);
    }
    for (int i = 0; i < BOUNDS; i++) {
        const bound *b = &bounds[i];
        bool kept = b->worst <= ldexp(1, b->proven), measured = b->worst > ldexp(1, b->proven - 30);
        printf("%-18s worst 2^%.2f at %a, bound 2^%d%s\n", b->name, log2(b->worst), b->at, b->proven,
               !kept ? " FAIL" : !measured ? " FAIL: nothing was measured" : "");
        faults += !kept || !measured;
    }
    printf("%d faults\n", faults);
    return faults != 0;
}
