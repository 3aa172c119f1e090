// SPDX-License-Identifier: MIT
/* src/num/interval_lanes.h against MPFR, and beside interval.h.
 *
 *     test_interval_lanes      SAGITTA_TEST_SCALE multiplies the random cases, SAGITTA_TEST_SEED
 *
 * Operands are random intervals, of which one in ten has an end that is infinite or NaN.  At random members
 * of the operands each operation is worked out in MPFR, rounded either way; the value has to be in the
 * result, unless it is not defined.  An end that is not a number says nothing.  Where ends_no_root or its
 * kin say that there is no value, there must be none.
 *
 * How much farther out than with interval.h the ends are is printed, in steps of 2^-52 of the end, and has a
 * limit.  So an end that says nothing is a fault, too, where interval.h knows one. */
#include "../../src/num/interval_lanes.h"
#include "random_bits.h"

#include <sagitta/interval.h>

#include <inttypes.h>
#include <mpfr.h>
#include <stdio.h>
#include <stdlib.h>

static int faults;
static const double inf = HUGE_VAL;

static double uniform(double lo, double hi)
{
    return lo + (hi - lo) * ldexp((double)(random_bits() >> 11), -53);
}

static int below(int n) { return (int)(random_bits() % (uint64_t)n); }

/* ---------------------------------------------------------------------- operations */

enum { MOST_OPERANDS = 4 };

/* limit: how far an end may be out, in 2^-52 of it; of two products, of the greatest product.  right NULL:
 * the product. */
typedef struct operation {
    const char *name;
    int operands;
    double limit;
    two_ends (*lanes)(const two_ends *x);
    int (*right)(mpfr_t y, mpfr_t *x, mpfr_rnd_t way);
    sgt_interval (*tight)(const sgt_interval *x);
    bool (*no_value)(two_ends x);
} operation;

#define LANES_OF_1(NAME) static two_ends lanes_##NAME(const two_ends *x) { return ends_##NAME(x[0]); }
#define LANES_OF_2(NAME) \
    static two_ends lanes_##NAME(const two_ends *x) { return ends_##NAME(x[0], x[1]); }
#define RIGHT_1(NAME, MPFR) \
    static int right_##NAME(mpfr_t y, mpfr_t *x, mpfr_rnd_t way) { return mpfr_##MPFR(y, x[0], way); }
#define RIGHT_2(NAME, MPFR) \
    static int right_##NAME(mpfr_t y, mpfr_t *x, mpfr_rnd_t way) { return mpfr_##MPFR(y, x[0], x[1], way); }
#define TIGHT_1(NAME, OURS) \
    static sgt_interval tight_##NAME(const sgt_interval *x) { return sgt_interval_##OURS(x[0]); }
#define TIGHT_2(NAME, OURS) \
    static sgt_interval tight_##NAME(const sgt_interval *x) { return sgt_interval_##OURS(x[0], x[1]); }

LANES_OF_2(sum) RIGHT_2(sum, add) TIGHT_2(sum, sum)
LANES_OF_2(difference) RIGHT_2(difference, sub) TIGHT_2(difference, difference)
LANES_OF_2(product) RIGHT_2(product, mul) TIGHT_2(product, product)
LANES_OF_2(quotient) RIGHT_2(quotient, div) TIGHT_2(quotient, quotient)
LANES_OF_2(minimum) RIGHT_2(minimum, min) TIGHT_2(minimum, minimum)
LANES_OF_2(maximum) RIGHT_2(maximum, max) TIGHT_2(maximum, maximum)
LANES_OF_2(hypotenuse) RIGHT_2(hypotenuse, hypot) TIGHT_2(hypotenuse, hypotenuse)
LANES_OF_2(angle) RIGHT_2(angle, atan2) TIGHT_2(angle, angle)
LANES_OF_1(negative) RIGHT_1(negative, neg) TIGHT_1(negative, negative)
LANES_OF_1(absolute) RIGHT_1(absolute, abs) TIGHT_1(absolute, absolute)
LANES_OF_1(square) RIGHT_1(square, sqr) TIGHT_1(square, square)
LANES_OF_1(root) RIGHT_1(root, sqrt) TIGHT_1(root, square_root)
LANES_OF_1(cbrt) RIGHT_1(cbrt, cbrt) TIGHT_1(cbrt, cube_root)
LANES_OF_1(exp) RIGHT_1(exp, exp) TIGHT_1(exp, exponential)
LANES_OF_1(log) RIGHT_1(log, log) TIGHT_1(log, logarithm)
LANES_OF_1(tan) RIGHT_1(tan, tan) TIGHT_1(tan, tangent)
LANES_OF_1(asin) RIGHT_1(asin, asin) TIGHT_1(asin, arc_sine)
LANES_OF_1(acos) RIGHT_1(acos, acos) TIGHT_1(acos, arc_cosine)
LANES_OF_1(atan) RIGHT_1(atan, atan) TIGHT_1(atan, arc_tangent)
LANES_OF_1(sinh) RIGHT_1(sinh, sinh) TIGHT_1(sinh, hyperbolic_sine)
LANES_OF_1(cosh) RIGHT_1(cosh, cosh) TIGHT_1(cosh, hyperbolic_cosine)
LANES_OF_1(tanh) RIGHT_1(tanh, tanh) TIGHT_1(tanh, hyperbolic_tangent)
LANES_OF_1(cube) LANES_OF_1(reciprocal)
RIGHT_1(sin, sin) TIGHT_1(sin, sine) RIGHT_1(cos, cos) TIGHT_1(cos, cosine)

static two_ends lanes_sin(const two_ends *x) { return ends_sin_cos(x[0]).sine; }
static two_ends lanes_cos(const two_ends *x) { return ends_sin_cos(x[0]).cosine; }
static int right_cube(mpfr_t y, mpfr_t *x, mpfr_rnd_t way) { return mpfr_pow_ui(y, x[0], 3, way); }
static sgt_interval tight_cube(const sgt_interval *x) { return sgt_interval_power(x[0], 3); }
static int right_reciprocal(mpfr_t y, mpfr_t *x, mpfr_rnd_t way) { return mpfr_ui_div(y, 1, x[0], way); }
static sgt_interval tight_reciprocal(const sgt_interval *x)
{
    return sgt_interval_quotient(sgt_interval_of(1), x[0]);
}

static two_ends lanes_two(const two_ends *x) { return ends_two_products(x[0], x[1], x[2], x[3]); }
static int right_two(mpfr_t y, mpfr_t *x, mpfr_rnd_t way)
{
    return mpfr_fmma(y, x[0], x[1], x[2], x[3], way); /* rounded once */
}
static sgt_interval tight_two(const sgt_interval *x)
{
    return sgt_interval_sum(sgt_interval_product(x[0], x[1]), sgt_interval_product(x[2], x[3]));
}
static double greatest_product(const sgt_interval *x)
{
    return sgt_interval_greatest(sgt_interval_product(x[0], x[1])) +
           sgt_interval_greatest(sgt_interval_product(x[2], x[3]));
}

/* By a number, the lower end of the second operand. */
static double number_of(double k) { return fabs(k) <= DBL_MAX ? k : 1.5; }
static two_ends lanes_scaled(const two_ends *x) { return ends_scaled(x[0], number_of(x[1].lo)); }
static sgt_interval tight_scaled(const sgt_interval *x)
{
    return sgt_interval_scaled(x[0], number_of(x[1].lo));
}

/* The second operand is made finite and above 0. */
static two_ends positive(two_ends x)
{
    double a = fabs(number_of(x.lo)), b = fabs(number_of(x.hi));
    a = a > 0 ? a : 0x1p-1074, b = b > 0 ? b : 0x1p-1074;
    return a < b ? ends_of(a, b) : ends_of(b, a);
}
static two_ends lanes_positive(const two_ends *x) { return ends_product_positive(x[0], x[1]); }

#define ROW_1(NAME, LIMIT) {#NAME, 1, LIMIT, lanes_##NAME, right_##NAME, tight_##NAME, NULL}
#define ROW_2(NAME, LIMIT) {#NAME, 2, LIMIT, lanes_##NAME, right_##NAME, tight_##NAME, NULL}
#define OFF(BOUND) ((BOUND) + 2.1) /* bound u that the function may be off by, bound + 2 outward, roundings */
static const operation operations[] = {
    ROW_2(sum, 2.1), ROW_2(difference, 2.1), ROW_2(product, 1.6),
    {"two products", 4, 4, lanes_two, right_two, tight_two, NULL},
    {"scaled", 2, 1.6, lanes_scaled, NULL, tight_scaled, NULL},
    {"positive", 2, 1.6, lanes_positive, right_product, tight_product, NULL},
    ROW_1(negative, 0.1), ROW_1(absolute, 0.1), ROW_1(square, 1.6), ROW_1(cube, OFF(2)),
    ROW_1(reciprocal, 1.6), ROW_2(quotient, 3.1),
    {"root", 1, 1.6, lanes_root, right_root, tight_root, ends_no_root},
    ROW_2(minimum, 0.1), ROW_2(maximum, 0.1), ROW_2(hypotenuse, OFF(LANE_HYPOT_BOUND)),
    ROW_2(angle, OFF(LANE_ATAN_BOUND)), ROW_1(exp, OFF(LANE_EXP_BOUND)),
    {"log", 1, OFF(LANE_LOG_BOUND), lanes_log, right_log, tight_log, ends_no_log},
    ROW_1(sin, OFF(LANE_SIN_BOUND)), ROW_1(cos, OFF(LANE_SIN_BOUND)), ROW_1(tan, OFF(LANE_TAN_BOUND)),
    {"asin", 1, OFF(LANE_ASIN_BOUND), lanes_asin, right_asin, tight_asin, ends_no_arc},
    {"acos", 1, OFF(LANE_ASIN_BOUND), lanes_acos, right_acos, tight_acos, ends_no_arc},
    ROW_1(atan, OFF(LANE_ATAN_BOUND)), ROW_1(sinh, OFF(LANE_SINH_BOUND)), ROW_1(cosh, OFF(LANE_SINH_BOUND)),
    ROW_1(tanh, OFF(LANE_TANH_BOUND)), ROW_1(cbrt, OFF(LANE_CBRT_BOUND)),
};
enum { OPERATIONS = sizeof operations / sizeof *operations };

/* ------------------------------------------------------------------------ operands */

static double end(bool moderate)
{
    static const double ends[] = {0,        0x1p-1074, 0x1p-1073, DBL_MIN, DBL_MAX,  0x1p-500, 0x1p500,
                                  1,        2,         0.5,       0x1p26,  0x1p-969, 0x1p-970, 0x1p-1021,
                                  0x1p1023, 709.79,    -745.2,    710.5,   0x1p-537, 0x1.921fb54442d18p0};
    double x = uniform(-3, 3);
    int64_t bits;
    switch (moderate ? below(3) : 3 + below(4)) {
    case 0: return x;
    case 1: return (double)(below(41) - 20) / 4;
    case 2: x = ldexp(x, below(40) - 20); break;
    case 3: return x;
    case 4: x = ends[below(20)]; break;
    case 5: x = ldexp(x, below(2097) - 1074); break;
    default: x = (double)below(200) * 0x1.921fb54442d18p0;
    }
    memcpy(&bits, &x, sizeof bits);
    bits += below(5) - 2;
    memcpy(&x, &bits, sizeof x);
    if (!isfinite(x)) x = 1;
    return below(2) ? -x : x;
}

static two_ends any_interval(bool moderate)
{
    double a = end(moderate), b = end(moderate);
    if (below(3) == 0) b = a; /* one point */
    else if (below(2)) b = a + ldexp(fabs(a), -below(54));
    two_ends x = a < b ? ends_of(a, b) : ends_of(b, a);
    if (fabs(x.hi) > DBL_MAX) x.hi = x.lo;
    if (!moderate && below(10) == 0) x.lo = below(2) ? -inf : (double)NAN;
    if (!moderate && below(10) == 0) x.hi = below(2) ? inf : (double)NAN;
    return x;
}

/* One of its numbers, which is finite. */
static double member(two_ends x)
{
    bool no_lo = !(x.lo > -inf), no_hi = !(x.hi < inf);
    double y;
    switch (below(4)) {
    case 0: y = no_lo ? -DBL_MAX : x.lo; break;
    case 1: y = no_hi ? DBL_MAX : x.hi; break;
    case 2: y = end(false); break;
    default: y = no_lo || no_hi ? end(true) : x.lo + uniform(0, 1) * (x.hi - x.lo);
    }
    if (!no_lo && !(y >= x.lo)) y = x.lo;
    if (!no_hi && !(y <= x.hi)) y = x.hi;
    return y;
}

/* ---------------------------------------------------------------------- the oracle */

static mpfr_t low, high, given[MOST_OPERANDS];

static void fault(const operation *f, const char *what, const two_ends *x, two_ends y, const double *at)
{
    if (faults++ >= 30) return;
    printf("%s: %s:", f->name, what);
    for (int k = 0; k < f->operands; k++) printf(" [%a, %a]", x[k].lo, x[k].hi);
    printf(" gave [%a, %a]", y.lo, y.hi);
    for (int k = 0; k < f->operands && at; k++) printf(" %a", at[k]);
    printf("\n");
}

static void look(const operation *f, const two_ends *x, long *decided)
{
    two_ends y = f->lanes(x);
    bool none = f->no_value && f->no_value(x[0]);
    for (int times = 0; times < 4; times++) {
        double at[MOST_OPERANDS];
        for (int k = 0; k < f->operands; k++) at[k] = member(x[k]);
        if (f->lanes == lanes_scaled) at[1] = number_of(x[1].lo);
        for (int k = 0; k < f->operands; k++) mpfr_set_d(given[k], at[k] == 0 ? 0 : at[k], MPFR_RNDN);
        int (*right)(mpfr_t, mpfr_t *, mpfr_rnd_t) = f->right ? f->right : right_product;
        right(low, given, MPFR_RNDD), right(high, given, MPFR_RNDU);
        bool angle_of_0 = f->lanes == lanes_angle && at[0] == 0 && at[1] == 0;
        if (!mpfr_number_p(low) || !mpfr_number_p(high) || angle_of_0) continue;
        *decided += 1;
        if (none) fault(f, "there is a value", x, y, at);
        /* below the value rounded down, and a NaN compares as neither */
        else if (mpfr_cmp_d(low, isnan(y.lo) ? -inf : y.lo) < 0) fault(f, "lower end", x, y, at);
        else if (mpfr_cmp_d(high, isnan(y.hi) ? inf : y.hi) > 0) fault(f, "upper end", x, y, at);
    }
}

/* How far out, in 2^-52 of `size`. */
static double steps(double out, double size)
{
    return out <= 0 ? 0 : (out - 0x1p-1070) / (size * 0x1p-52 + 0x1p-1074);
}

static void measure(const operation *f, const two_ends *x, double *most)
{
    sgt_interval of[MOST_OPERANDS];
    for (int k = 0; k < f->operands; k++) of[k] = sgt_interval_between(x[k].lo, x[k].hi);
    sgt_interval t = f->tight(of);
    two_ends y = f->lanes(x);
    if (sgt_interval_is_empty(t) || !(t.lo > -inf && t.hi < inf)) return;
    /* what lanes do not look into: divisors with 0 in them, angles at the cut */
    if (f->lanes == lanes_quotient && x[1].lo <= 0 && x[1].hi >= 0) return;
    if (f->lanes == lanes_angle && x[0].lo <= 0 && x[0].hi >= 0 && x[1].lo <= 0) return;
    double least = f->lanes == lanes_two ? greatest_product(of) : 0;
    double lo = steps(t.lo - y.lo, fmax(fabs(t.lo), least)), hi = steps(y.hi - t.hi, fmax(fabs(t.hi), least));
    if (!(y.lo > -inf && y.hi < inf)) fault(f, "nothing is known", x, y, NULL);
    else if (!(lo <= f->limit && hi <= f->limit)) fault(f, "too wide", x, y, (double[]){lo, hi});
    *most = fmax(*most, fmax(lo, hi));
}

int main(void)
{
    const char *seed = getenv("SAGITTA_TEST_SEED"), *scale = getenv("SAGITTA_TEST_SCALE");
    state = seed ? strtoull(seed, NULL, 0) : 1;
    printf("SAGITTA_TEST_SEED=%" PRIu64 "\n", state);
    long n = (long)(20000 * (scale ? atof(scale) : 0.5));
    mpfr_inits2(160, low, high, (mpfr_ptr)0);
    for (int k = 0; k < MOST_OPERANDS; k++) mpfr_init2(given[k], 53);
    for (const operation *f = operations; f < operations + OPERATIONS; f++) {
        double most = 0;
        long decided = 0;
        for (long i = 0; i < n; i++) {
            two_ends x[MOST_OPERANDS];
            bool moderate = i % 2 == 0;
            for (int k = 0; k < f->operands; k++) x[k] = any_interval(moderate);
            if (f->lanes == lanes_positive) x[1] = positive(x[1]);
            look(f, x, &decided);
            if (moderate) measure(f, x, &most);
        }
        printf("%-12s %ld members, ends at most %.2f steps farther out than in interval.h\n", f->name,
               decided, most);
        if (decided < n / 3) faults++, printf("%s: too few members\n", f->name);
    }
    mpfr_clears(low, high, (mpfr_ptr)0);
    for (int k = 0; k < MOST_OPERANDS; k++) mpfr_clear(given[k]);
    printf("%d faults\n", faults);
    return faults != 0;
}
