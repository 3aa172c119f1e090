// SPDX-License-Identifier: MIT
/* src/num/functions.h against MPFR: each function is within the bound that its head argues, and NaN where it
 * says so.  A loop over lanes has the bits of the single calls, in each set of instructions, whatever stands
 * in the lanes beside.
 *
 *     test_lane_functions      SAGITTA_TEST_SCALE multiplies the random cases, SAGITTA_TEST_SEED
 *
 * The error is in u = 2^-53 of the right result, and the worst is printed with its arguments.  2^-1074 is
 * taken off before. */
#include "lane_functions.h"
#include "random_bits.h"
#include "../../src/num/functions.h"

#include <inttypes.h>
#include <mpfr.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>

static const double inf = HUGE_VAL, none = NAN;
static int faults;

static double uniform(double lo, double hi)
{
    return lo + (hi - lo) * ldexp((double)(random_bits() >> 11), -53);
}

/* --------------------------------------------------------------------- the oracle */

typedef int of_one(mpfr_t, const mpfr_t, mpfr_rnd_t);
typedef int of_two(mpfr_t, const mpfr_t, const mpfr_t, mpfr_rnd_t);

typedef struct function {
    const char *name;
    double bound;
    of_one *one;
    of_two *two;
    double from, to; /* the domain of the first argument; it is open at `from` if `open` */
    bool open;
    double lo, hi;   /* where a third of the arguments are drawn */
} function;

#define R -HUGE_VAL, HUGE_VAL, false
#define TURNS -LANE_TURN_LIMIT, LANE_TURN_LIMIT, false
static const function functions[] = {
    [LANE_exp] = {"exp", LANE_EXP_BOUND, mpfr_exp, 0, R, -746, 711},
    [LANE_log] = {"log", LANE_LOG_BOUND, mpfr_log, 0, 0, HUGE_VAL, true, 0.3, 3},
    [LANE_sin] = {"sin", LANE_SIN_BOUND, mpfr_sin, 0, TURNS, -9, 9},
    [LANE_cos] = {"cos", LANE_SIN_BOUND, mpfr_cos, 0, TURNS, -9, 9},
    [LANE_tan] = {"tan", LANE_TAN_BOUND, mpfr_tan, 0, TURNS, -9, 9},
    [LANE_asin] = {"asin", LANE_ASIN_BOUND, mpfr_asin, 0, -1, 1, false, -1, 1},
    [LANE_acos] = {"acos", LANE_ASIN_BOUND, mpfr_acos, 0, -1, 1, false, -1, 1},
    [LANE_atan] = {"atan", LANE_ATAN_BOUND, mpfr_atan, 0, R, -8, 8},
    [LANE_sinh] = {"sinh", LANE_SINH_BOUND, mpfr_sinh, 0, R, -3, 3},
    [LANE_cosh] = {"cosh", LANE_SINH_BOUND, mpfr_cosh, 0, R, -712, 712},
    [LANE_tanh] = {"tanh", LANE_TANH_BOUND, mpfr_tanh, 0, R, -3, 3},
    [LANE_cbrt] = {"cbrt", LANE_CBRT_BOUND, mpfr_cbrt, 0, R, -9, 9},
    [LANE_atan2] = {"atan2", LANE_ATAN_BOUND, 0, mpfr_atan2, R, -3, 3},
    [LANE_hypot] = {"hypot", LANE_HYPOT_BOUND, 0, mpfr_hypot, R, -3, 3},
    [LANE_power] = {"power", LANE_POWER_BOUND, 0, mpfr_pow, 0, HUGE_VAL, false, 0, 9},
};

static mpfr_t first, second, right, off, size;

typedef struct worst { double off, a, b; } worst;

static void look(int k, double a, double b, worst *w)
{
    const function *f = &functions[k];
    double got = lane_singles[k](a, b);
    bool inside = f->open ? a > f->from && a <= f->to : a >= f->from && a <= f->to;
    mpfr_set_d(first, a, MPFR_RNDN);
    mpfr_set_d(second, b, MPFR_RNDN);
    if (f->one) f->one(right, first, MPFR_RNDN);
    else f->two(right, first, second, MPFR_RNDN);
    if (k == LANE_atan2) inside = a != 0 || b != 0;
    if (k == LANE_power) inside = a > 0 || (a == 0 && b > 0);
    if (!inside) {
        if (!isnan(got)) faults++, printf("%s(%a, %a) is %a, and not NaN\n", f->name, a, b, got);
        return;
    }
    double u = 0, bound = f->bound;
    if (fabs(got) <= DBL_MAX) {
        mpfr_set_d(off, got, MPFR_RNDN);
        mpfr_sub(off, off, right, MPFR_RNDN);
        mpfr_abs(off, off, MPFR_RNDN);
        mpfr_set_d(size, 0x1p-1074, MPFR_RNDN);
        mpfr_sub(off, off, size, MPFR_RNDN);
        if (mpfr_sgn(off) > 0) {
            mpfr_abs(size, right, MPFR_RNDN);
            mpfr_div(off, off, size, MPFR_RNDN);
            u = mpfr_get_d(off, MPFR_RNDN) * 0x1p53;
        }
    } else { /* an overflow: the right one with the bound added is beyond, too */
        mpfr_mul_d(size, right, 1 + (bound + 3000) * 0x1p-53, MPFR_RNDN);
        u = isnan(got) || fabs(mpfr_get_d(size, MPFR_RNDN)) <= DBL_MAX
            || signbit(got) != (mpfr_sgn(right) < 0) ? inf : 0;
    }
    if (!(u <= w->off)) w->off = u, w->a = a, w->b = b;
    if (!(u <= bound)) {
        if (faults++ < 30) printf("%s(%a, %a) is %a, off by %g u\n", f->name, a, b, got, u);
    }
}

/* ------------------------------------------------------------------ the arguments */

static double any_bits(void)
{
    uint64_t bits = random_bits();
    double x;
    memcpy(&x, &bits, sizeof x);
    return isfinite(x) ? x : 1;
}

/* What is hard for one of the functions. */
static double hard(void)
{
    static const double ends[] = {
        0, 0x1p-1074, 0x1p-1073, DBL_MIN, 0x1.fffffffffffffp-1023, DBL_MAX, 0x1p-500, 0x1p500, 1, 2, 0.5, 8,
        1 + DBL_EPSILON, 1 - DBL_EPSILON / 2, 0x1p26, 0x1.6a09e667f3bcdp-1, 0x1.6a09e667f3bccp-1, 0.125,
        0.375, 0.625, 0.875, 709.782712893384, 709.782712893385, -708.4, -745.13, -745.2, 710.4758600739439,
        720, -760, 27, 0x1.62e42fefa39efp-2, 0x1.921fb54442d18p0, 0x1p-26, 0x1p-27};
    double x = ends[random_bits() % (sizeof ends / sizeof *ends)];
    int64_t bits;
    switch (random_bits() % 5) {
    case 0: break;
    case 1: /* beside a multiple of pi/2 */
        x = (double)(random_bits() >> (38 + random_bits() % 26)) * 0x1.921fb54442d18p0;
        break;
    case 2: x = 1 + uniform(-1, 1) * ldexp(1, -(int)(random_bits() % 52)); break;
    case 3: x = uniform(-1, 1) * ldexp(1, (int)(random_bits() % 60) - 30); break;
    default: x = ldexp(1 + (double)(random_bits() % 5) * DBL_EPSILON, (int)(random_bits() % 2098) - 1074);
    }
    memcpy(&bits, &x, sizeof bits);
    bits += (int64_t)(random_bits() % 5) - 2;
    memcpy(&x, &bits, sizeof x);
    if (!isfinite(x)) x = 0;
    return random_bits() & 1 ? -x : x;
}

static double argument(const function *f, int which)
{
    switch (which % 3) {
    case 0: return any_bits();
    case 1: return hard();
    default: return uniform(f->lo, f->hi);
    }
}

/* Powers that do not overflow, of any base. */
static void look_at_powers(long n, worst *w)
{
    for (long i = 0; i < n; i++) {
        double b = fabs(i & 1 ? any_bits() : uniform(0.5, 2)), e = uniform(-744, 709) / log(b);
        if (b > 0 && isfinite(e)) look(LANE_power, b, e, w);
    }
}

/* The doubles up to 2^26 that are nearest to a multiple of pi/2, for their size: from the continued fraction
 * of 2^k 2 / pi. */
static void nearest_turns(worst w[])
{
    mpfr_t x, whole, half_pi;
    mpfr_inits2(400, x, whole, half_pi, (mpfr_ptr)0);
    mpfr_const_pi(half_pi, MPFR_RNDN);
    mpfr_div_2ui(half_pi, half_pi, 1, MPFR_RNDN);
    double least = 1;
    for (int k = -52; k <= -27; k++) { /* m 2^k near n pi/2: n / m near 2^k 2 / pi */
        mpfr_ui_div(x, 1, half_pi, MPFR_RNDN);
        mpfr_mul_2si(x, x, k, MPFR_RNDN);
        double m0 = 0, m1 = 1; /* denominators, below 2^53 exact */
        for (;;) {
            mpfr_frac(x, x, MPFR_RNDN);
            mpfr_ui_div(x, 1, x, MPFR_RNDN);
            mpfr_trunc(whole, x);
            double m2 = m0 + mpfr_get_d(whole, MPFR_RNDN) * m1;
            if (!(m2 < 0x1p53)) break;
            m0 = m1, m1 = m2;
            for (int times = 1; times <= 3; times++) {
                double a = ldexp(m1 * times, k);
                if (!(a > 0.7 && a <= LANE_TURN_LIMIT)) continue;
                for (int j = LANE_sin; j <= LANE_tan; j++) look(j, a, 0, &w[j]), look(j, -a, 0, &w[j]);
                least = fmin(least, fabs(lane_sin(a))), least = fmin(least, fabs(lane_cos(a)));
            }
        }
    }
    printf("the least sine or cosine that was met: %g\n", least);
    if (!(least < 0x1p-57)) faults++, printf("no hard turns were met\n");
    mpfr_clears(x, whole, half_pi, (mpfr_ptr)0);
}

/* -------------------------------------------------------------------------- lanes */

static bool same(double a, double b) { return memcmp(&a, &b, sizeof a) == 0 || (isnan(a) && isnan(b)); }

static void lanes_as_single(lane_loop *const loops[], const char *set, int k)
{
    enum { MOST = 37 };
    double a[MOST] = {0}, b[MOST] = {0}, y[MOST];
    static const double odd[] = {HUGE_VAL, -HUGE_VAL, NAN, 0.0, -0.0, 1e308, -1e308, 0x1p-1074};
    size_t n = random_bits() % (MOST + 1);
    for (size_t i = 0; i < n; i++) {
        bool strange = random_bits() % 4 == 0;
        a[i] = strange ? odd[random_bits() % 8] : argument(&functions[k], (int)(random_bits() % 3));
        b[i] = strange ? odd[random_bits() % 8] : argument(&functions[k], (int)(random_bits() % 3));
    }
    loops[k](n, a, b, y);
    for (size_t i = 0; i < n; i++) {
        double single = lane_singles[k](a[i], b[i]);
        if (same(y[i], single)) continue;
        if (faults++ < 30)
            printf("%s(%a, %a), %s: %a in lane %zu, and %a by itself\n", functions[k].name, a[i], b[i], set,
                   y[i], i, single);
    }
}

static void require(bool is, const char *what)
{
    if (!is) faults++, printf("%s: wrong\n", what);
}

int main(void)
{
    const char *seed = getenv("SAGITTA_TEST_SEED"), *scale = getenv("SAGITTA_TEST_SCALE");
    state = seed ? strtoull(seed, NULL, 0) : 1;
    printf("SAGITTA_TEST_SEED=%" PRIu64 "\n", state);
    long n = (long)(60000 * (scale ? atof(scale) : 0.5));
    mpfr_inits2(180, first, second, right, off, size, (mpfr_ptr)0);

    worst w[LANE_FUNCTIONS] = {0};
    for (int k = 0; k < LANE_FUNCTIONS; k++)
        for (long i = 0; i < n; i++)
            look(k, argument(&functions[k], (int)(i % 3)), argument(&functions[k], (int)(i / 3 % 3)), &w[k]);
    nearest_turns(w), look_at_powers(n, &w[LANE_power]);
    for (int k = 0; k < LANE_FUNCTIONS; k++)
        printf("%-6s worst %7.4f u at %a, %a, bound %g\n", functions[k].name, w[k].off, w[k].a, w[k].b,
               functions[k].bound);

    require(lane_exp(inf) == inf && lane_exp(-inf) == 0 && lane_exp(0) == 1 && isnan(lane_exp(none)), "exp");
    require(lane_log(inf) == inf && lane_log(1) == 0 && isnan(lane_log(-0.0)) && isnan(lane_log(none))
            && isnan(lane_log(-inf)), "log");
    require(isnan(lane_sin(inf)) && isnan(lane_cos(-inf)) && isnan(lane_tan(none)) && lane_sin(0) == 0
            && lane_cos(0) == 1 && lane_tan(0) == 0, "sin, cos, tan");
    require(isnan(lane_asin(none)) && isnan(lane_acos(none)) && isnan(lane_asin(inf))
            && isnan(lane_acos(-inf)) && lane_acos(1) == 0 && lane_asin(0) == 0, "asin, acos");
    require(lane_atan(inf) == lane_asin(1) && lane_atan(-inf) == -lane_asin(1) && isnan(lane_atan(none))
            && isnan(lane_atan2(1, none)) && isnan(lane_atan2(none, 1)) && isnan(lane_atan2(0, 0))
            && isnan(lane_atan2(0.0, -0.0)) && lane_atan2(0, -1) == lane_acos(-1), "atan, atan2");
    require(lane_sinh(inf) == inf && lane_sinh(-inf) == -inf && lane_cosh(-inf) == inf
            && isnan(lane_sinh(none)) && isnan(lane_cosh(none)) && lane_tanh(inf) == 1
            && lane_tanh(-inf) == -1 && isnan(lane_tanh(none)) && lane_sinh(0) == 0 && lane_cosh(0) == 1
            && lane_tanh(0) == 0, "sinh, cosh, tanh");
    require(lane_cbrt(inf) == inf && lane_cbrt(-inf) == -inf && isnan(lane_cbrt(none)) && lane_cbrt(0) == 0,
            "cbrt");
    require(lane_hypot(inf, 1) == inf && lane_hypot(1, -inf) == inf && isnan(lane_hypot(none, 1))
            && isnan(lane_hypot(1, none)) && lane_hypot(0, 0) == 0 && lane_hypot(-3, 4) == 5, "hypot");
    require(lane_power(0, 1) == 0 && isnan(lane_power(0, 0)) && isnan(lane_power(0, -1))
            && isnan(lane_power(-8, 3)) && lane_power(5, 0) == 1 && isnan(lane_power(none, 1))
            && isnan(lane_power(2, none)) && lane_power(inf, 2) == inf && lane_power(inf, -2) == 0
            && isnan(lane_power(-inf, 2)) && isnan(lane_power(inf, 0)), "power");

    for (int k = 0; k < LANE_FUNCTIONS; k++)
        for (long i = 0; i < 1 + n / 30; i++) {
            lanes_as_single(lane_loops_base, "base", k);
#if LANE_SETS > 1
            if (__builtin_cpu_supports("avx2")) lanes_as_single(lane_loops_v3, "v3", k);
            if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq")
                && __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512bw")
                && __builtin_cpu_supports("avx512cd"))
                lanes_as_single(lane_loops_v4, "v4", k);
#endif
        }
    printf("%d faults\n", faults);
    return faults != 0;
}
