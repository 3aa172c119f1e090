// SPDX-License-Identifier: MIT
/* src/num/elementary.h against MPFR: each function is within the bound that its head proves.
 *
 *     test_elementary      SAGITTA_TEST_SCALE multiplies the random cases, SAGITTA_TEST_SEED
 *
 * The error is in ulps of the right result, and the worst is printed with its input. */
#include "random_bits.h"
#include "../../src/num/elementary.h"

#include <inttypes.h>
#include <mpfr.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

static double uniform(double lo, double hi)
{
    return lo + (hi - lo) * ldexp((double)(random_bits() >> 11), -53);
}

/* A positive number, any bits. */
static double any_positive(void)
{
    for (;;) {
        uint64_t bits = random_bits() >> 1;
        double x;
        memcpy(&x, &bits, sizeof x);
        if (x > 0 && x <= DBL_MAX) return x;
    }
}

static mpfr_t argument, right, off;

/* How far x is from `right`, in ulps of it. */
static double ulps_off(double x)
{
    mpfr_set_d(off, x, MPFR_RNDN);
    mpfr_sub(off, off, right, MPFR_RNDN);
    if (mpfr_zero_p(right)) return mpfr_zero_p(off) ? 0 : HUGE_VAL;
    long place = mpfr_get_exp(right) - 53;
    mpfr_mul_2si(off, off, place < -1074 ? 1074 : -place, MPFR_RNDN);
    return fabs(mpfr_get_d(off, MPFR_RNDN));
}

static int faults;

typedef struct worst { const char *name; double bound, off, at; } worst;

static void note(worst *w, double x, double got)
{
    double off_by = ulps_off(got);
    if (!(off_by <= w->off)) w->off = off_by, w->at = x;
}

static void judge(const worst *w)
{
    printf("%-22s worst %.4f ulp at %a, bound %g\n", w->name, w->off, w->at, w->bound);
    if (!(w->off <= w->bound)) faults++;
}

static void require(bool right_, const char *what)
{
    if (!right_) faults++, printf("%s: wrong\n", what);
}

static bool is_zero(double x) { return !(x < 0) && !(x > 0) && x == x; }

int main(void)
{
    const char *seed = getenv("SAGITTA_TEST_SEED"), *scale = getenv("SAGITTA_TEST_SCALE");
    state = seed ? strtoull(seed, NULL, 0) : 1;
    printf("SAGITTA_TEST_SEED=%" PRIu64 "\n", state);
    long n = (long)(100000 * (scale ? atof(scale) : 0.5));
    mpfr_inits2(160, argument, right, off, (mpfr_ptr)0);

    worst log_any = {"logarithm", 0.65, 0, 0}, log_near = {"logarithm near 1", 0.65, 0, 0};
    worst log_two = {"logarithm within 2", 0.65, 0, 0};
    worst *logs[] = {&log_any, &log_near, &log_two};
    for (long i = 0; i < 3 * n; i++) {
        double near = 1 + uniform(-1, 1) * ldexp(1, -(int)(random_bits() % 52));
        double x = i % 3 == 0 ? any_positive() : i % 3 == 1 ? near : uniform(0.5, 2);
        if (!(x > 0)) continue;
        mpfr_set_d(argument, x, MPFR_RNDN);
        mpfr_log(right, argument, MPFR_RNDN);
        note(logs[i % 3], x, logarithm(x));
    }
    for (int k = -1074; k <= 1023; k++) { /* and the ends of each binade, and of the reduction */
        const double ends[] = {1, 1 + DBL_EPSILON, 2 - DBL_EPSILON, 0x1.6a09e667f3bccp0, 0x1.6a09e667f3bcdp0};
        for (int j = 0; j < 5; j++) {
            double x = times_power_of_two(ends[j], k);
            mpfr_set_d(argument, x, MPFR_RNDN);
            mpfr_log(right, argument, MPFR_RNDN);
            note(&log_any, x, logarithm(x));
        }
    }
    for (int j = 0; j < 3; j++) judge(logs[j]);
    require(logarithm(0) == -HUGE_VAL && logarithm(-0.0) == -HUGE_VAL && logarithm(HUGE_VAL) == HUGE_VAL
            && is_zero(logarithm(1)) && isnan(logarithm(-1)) && isnan(logarithm(-HUGE_VAL))
            && isnan(logarithm((double)NAN)), "special logarithms");

    worst exp_any = {"exponential", 2.5, 0, 0};
    for (long i = 0; i < 2 * n; i++) {
        double x = i & 1 ? uniform(-708, 709.7) : uniform(-2, 2);
        mpfr_set_d(argument, x, MPFR_RNDN);
        mpfr_exp(right, argument, MPFR_RNDN);
        note(&exp_any, x, exponential(x));
    }
    judge(&exp_any);
    worst exp_small = {"subnormal exponential", 1.6, 0, 0};
    for (long i = 0; i < n; i++) {
        double x = uniform(-745, -708.4);
        mpfr_set_d(argument, x, MPFR_RNDN);
        mpfr_exp(right, argument, MPFR_RNDN);
        note(&exp_small, x, exponential(x));
    }
    judge(&exp_small);
    require(exponential(0) == 1 && exponential(-0.0) == 1 && exponential(HUGE_VAL) == HUGE_VAL
            && is_zero(exponential(-HUGE_VAL)) && is_zero(exponential(-1e300))
            && exponential(1e300) == HUGE_VAL && exponential(709.9) == HUGE_VAL
            && is_zero(exponential(-745.2)) && isnan(exponential((double)NAN)), "special exponentials");

    worst sine = {"sine", 0.65, 0, 0}, cosine = {"cosine", 0.65, 0, 0};
    for (long i = 0; i < 2 * n; i++) {
        double quarter = 0x1.921fb54442d18p-1, hi = uniform(-quarter, quarter);
        if (i & 1) hi *= ldexp(1, -(int)(random_bits() % 900));
        double lo = hi * uniform(-0x1p-54, 0x1p-54);
        sine_cosine r = sine_cosine_of((twofold){hi, lo});
        mpfr_set_d(argument, hi, MPFR_RNDN);
        mpfr_add_d(argument, argument, lo, MPFR_RNDN);
        mpfr_sin(right, argument, MPFR_RNDN);
        note(&sine, hi, r.sine);
        mpfr_cos(right, argument, MPFR_RNDN);
        note(&cosine, hi, r.cosine);
    }
    judge(&sine), judge(&cosine);

    for (unsigned k = 0; k <= 256; k++) {
        worst power = {"power", 0, 0, 0}, fine = {"twofold power", 0.501, 0, 0};
        for (long i = 0; i < 1 + n / 1000; i++) {
            double x = i < 8 ? (double)(i + 1) : uniform(0.07, 14);
            mpfr_set_d(argument, x, MPFR_RNDN);
            mpfr_pow_ui(right, argument, k, MPFR_RNDN);
            note(&power, x, integer_power(x, k));
            note(&fine, x, twofold_power(x, k).hi);
        }
        power.bound = k > 1 ? (k - 1) * 1.001 : 0;
        if (power.off <= power.bound && fine.off <= fine.bound && k < 256) continue;
        printf("power %u\n", k);
        judge(&power), judge(&fine);
    }
    printf("%d faults\n", faults);
    return faults != 0;
}
