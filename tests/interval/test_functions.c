// SPDX-License-Identifier: MIT
/* The elementary functions of interval.h against MPFR.
 *
 *     test_functions      SAGITTA_TEST_SCALE multiplies the random cases, SAGITTA_TEST_SEED
 *
 * The oracle is the least interval of doubles that contains what the function has on its argument.  MPFR
 * rounds the values at the ends once, down and up.  Where the function turns, or has a pole, is worked out
 * in 300 bits.  Of each result is demanded: it contains the oracle's; no end is farther out than the header
 * allows; it contains the values at random members, which tries the oracle too.  Last, false functions are
 * given to the same checks, which have to see them. */
#include "random_bits.h"
#include <sagitta/interval.h>

#include <inttypes.h>
#include <mpfr.h>
#include <stdio.h>
#include <stdlib.h>

static const double inf = HUGE_VAL, least = 1 / 0x1p1000 / 0x1p74;

static double uniform(double lo, double hi)
{
    return lo + (hi - lo) * ldexp((double)(random_bits() >> 11), -53);
}

/* Neighbours are 1 apart, -0 and 0 the same. */
static int64_t place(double x)
{
    int64_t b;
    memcpy(&b, &x, sizeof b);
    return b < 0 ? INT64_MIN - b : b;
}

static double at_place(int64_t p)
{
    int64_t b = p < 0 ? INT64_MIN - p : p;
    double x;
    memcpy(&x, &b, sizeof x);
    return x;
}

static double moved(double x, int64_t by)
{
    int64_t p = place(x) + by, end = place(inf);
    return at_place(p > end ? end : p < -end ? -end : p);
}

/* a <= b */
static double doubles_between(double a, double b)
{
    return (double)((uint64_t)place(b) - (uint64_t)place(a));
}

/* ------------------------------------------------------------------ functions */

typedef int rounded_one(mpfr_t, const mpfr_t, mpfr_rnd_t);
typedef int rounded_two(mpfr_t, const mpfr_t, const mpfr_t, mpfr_rnd_t);
typedef sgt_interval of_one(sgt_interval);
typedef sgt_interval of_two(sgt_interval, sgt_interval);

typedef enum shape { RISES, FALLS, EVEN, SINE, COSINE, TANGENT, ANGLE, LENGTH, POWER, LESSER, GREATER } shape;

typedef struct function {
    const char *name;
    shape shape;
    of_one *one;
    rounded_one *rounded;
    double from, to; /* the domain */
    double lo, hi;   /* where half of the arguments are drawn */
    of_two *two;
    rounded_two *rounded_of_two;
} function;

#define ALL -HUGE_VAL, HUGE_VAL
static const function functions[] = {
    {"cube_root", RISES, sgt_interval_cube_root, mpfr_cbrt, ALL, -30, 30, 0, 0},
    {"exponential", RISES, sgt_interval_exponential, mpfr_exp, ALL, -746, 711, 0, 0},
    {"logarithm", RISES, sgt_interval_logarithm, mpfr_log, 0, HUGE_VAL, -0.1, 2, 0, 0},
    {"sine", SINE, sgt_interval_sine, mpfr_sin, ALL, -20, 20, 0, 0},
    {"cosine", COSINE, sgt_interval_cosine, mpfr_cos, ALL, -20, 20, 0, 0},
    {"tangent", TANGENT, sgt_interval_tangent, mpfr_tan, ALL, -4, 4, 0, 0},
    {"arc_sine", RISES, sgt_interval_arc_sine, mpfr_asin, -1, 1, -1.1, 1.1, 0, 0},
    {"arc_cosine", FALLS, sgt_interval_arc_cosine, mpfr_acos, -1, 1, -1.1, 1.1, 0, 0},
    {"arc_tangent", RISES, sgt_interval_arc_tangent, mpfr_atan, ALL, -8, 8, 0, 0},
    {"hyperbolic_sine", RISES, sgt_interval_hyperbolic_sine, mpfr_sinh, ALL, -712, 712, 0, 0},
    {"hyperbolic_cosine", EVEN, sgt_interval_hyperbolic_cosine, mpfr_cosh, ALL, -712, 712, 0, 0},
    {"hyperbolic_tangent", RISES, sgt_interval_hyperbolic_tangent, mpfr_tanh, ALL, -21, 21, 0, 0},
    {"angle", ANGLE, 0, 0, ALL, -3, 3, sgt_interval_angle, mpfr_atan2},
    {"hypotenuse", LENGTH, 0, 0, ALL, -3, 3, sgt_interval_hypotenuse, mpfr_hypot},
    {"real_power", POWER, 0, 0, ALL, -1, 9, sgt_interval_real_power, mpfr_pow},
    {"minimum", LESSER, 0, 0, ALL, -3, 3, sgt_interval_minimum, mpfr_min},
    {"maximum", GREATER, 0, 0, ALL, -3, 3, sgt_interval_maximum, mpfr_max},
};
enum { FUNCTIONS = sizeof functions / sizeof *functions };

/* ------------------------------------------------------------------ the oracle */

static mpfr_t first, second, result, wide, pi;

static double value(const function *f, double x, double y, mpfr_rnd_t way)
{
    mpfr_set_d(first, x, MPFR_RNDN);
    mpfr_set_d(second, y, MPFR_RNDN);
    int inexact = f->one ? f->rounded(result, first, way) : f->rounded_of_two(result, first, second, way);
    mpfr_subnormalize(result, inexact, way);
    return mpfr_get_d(result, way);
}

static void add(sgt_interval *hull, const function *f, double x, double y)
{
    double below = value(f, x, y, MPFR_RNDD), above = value(f, x, y, MPFR_RNDU);
    if (below < hull->lo) hull->lo = below;
    if (above > hull->hi) hull->hi = above;
}

/* Is there a k with (k + part) pi in x, or (k + part) 2 pi? */
static bool has_turn(sgt_interval x, double part, int period)
{
    long at[2];
    for (int i = 0; i < 2; i++) {
        mpfr_set_d(wide, i ? x.hi : x.lo, MPFR_RNDN);
        mpfr_div(wide, wide, pi, MPFR_RNDN);
        mpfr_div_si(wide, wide, period, MPFR_RNDN);
        mpfr_sub_d(wide, wide, part, MPFR_RNDN);
        at[i] = mpfr_get_si(wide, i ? MPFR_RNDD : MPFR_RNDU);
    }
    return at[0] <= at[1];
}

/* x without zero inside: its part below 0, with its end at -0, and the rest. */
static int parts(sgt_interval x, sgt_interval part[2])
{
    int n = 0;
    if (x.lo < 0) part[n++] = sgt_interval_between(x.lo, x.hi < 0 ? x.hi : -0.0);
    if (x.hi >= 0) part[n++] = sgt_interval_between(x.lo > 0 ? x.lo : 0, x.hi > 0 ? x.hi : 0);
    return n;
}

/* In each quadrant the angle is monotone in x and in y. */
static sgt_interval angle_truth(const function *f, sgt_interval y, sgt_interval x)
{
    sgt_interval hull = {inf, -inf}, xs[2], ys[2];
    int many_x = parts(x, xs), many_y = parts(y, ys);
    for (int i = 0; i < 4 * many_x * many_y; i++) {
        sgt_interval b = xs[i / 4 / many_y], a = ys[i / 4 % many_y];
        double p = i & 1 ? a.lo : a.hi, q = i & 2 ? b.lo : b.hi;
        if (p == 0 && q == 0 && b.lo == 0 && b.hi == 0) continue; /* the origin, and not a limit */
        add(&hull, f, p, q);
    }
    return hull;
}

static sgt_interval truth_of_two(const function *f, sgt_interval x, sgt_interval y)
{
    sgt_interval hull = {inf, -inf};
    if (f->shape == ANGLE) return angle_truth(f, x, y);
    if (f->shape == POWER) {
        if (x.hi < 0 || (x.hi == 0 && y.hi <= 0)) return hull;
        if (x.hi == 0) return sgt_interval_of(0);
        if (x.lo <= 0) x.lo = 0; /* and not -0 */
    }
    for (int i = 0; i < 4; i++) add(&hull, f, i & 1 ? x.lo : x.hi, i & 2 ? y.lo : y.hi);
    if (f->shape == LENGTH) {
        bool zero_x = x.lo <= 0 && x.hi >= 0, zero_y = y.lo <= 0 && y.hi >= 0;
        if (zero_x) add(&hull, f, 0, y.lo), add(&hull, f, 0, y.hi);
        if (zero_y) add(&hull, f, x.lo, 0), add(&hull, f, x.hi, 0);
        if (zero_x && zero_y) add(&hull, f, 0, 0);
    }
    return hull;
}

static sgt_interval truth(const function *f, sgt_interval x, sgt_interval y)
{
    sgt_interval hull = {inf, -inf};
    if (x.lo == inf) x.lo = DBL_MAX;
    if (x.hi == -inf) x.hi = -DBL_MAX;
    if (y.lo == inf) y.lo = DBL_MAX;
    if (y.hi == -inf) y.hi = -DBL_MAX;
    if (!f->one) return truth_of_two(f, x, y);
    if (x.hi < f->from || x.lo > f->to || (f->from == 0 && x.hi == 0)) return hull;
    if (x.lo <= f->from) x.lo = f->from;
    if (x.hi > f->to) x.hi = f->to;
    bool far = x.lo < -0x1p26 || x.hi > 0x1p26; /* the header's limit */
    if (f->shape == TANGENT && (far || has_turn(x, 0.5, 1))) return sgt_interval_all();
    if (far && (f->shape == SINE || f->shape == COSINE)) return sgt_interval_between(-1, 1);
    add(&hull, f, x.lo, 0), add(&hull, f, x.hi, 0);
    if (f->shape == EVEN && x.lo < 0 && x.hi > 0) add(&hull, f, 0, 0);
    if (f->shape == SINE && has_turn(x, 0.25, 2)) hull.hi = 1;
    if (f->shape == SINE && has_turn(x, 0.75, 2)) hull.lo = -1;
    if (f->shape == COSINE && has_turn(x, 0, 2)) hull.hi = 1;
    if (f->shape == COSINE && has_turn(x, 0.5, 2)) hull.lo = -1;
    return hull;
}

/* ------------------------------------------------------------------ verdicts */

typedef struct tally { long tried, ends, tight, failed; double farthest; } tally;

static void fail(const function *f, tally *t, const char *what, sgt_interval x, sgt_interval y,
                 sgt_interval got, sgt_interval want, bool quiet)
{
    if (t->failed++ >= 5 || quiet) return;
    printf("FAIL %s: %s; x [%a, %a] y [%a, %a] got [%a, %a] oracle [%a, %a]\n", f->name, what, x.lo, x.hi,
           y.lo, y.hi, got.lo, got.hi, want.lo, want.hi);
}

/* How many doubles too far an end may be. */
static int allowed(const function *f, double end)
{
    if (f->shape == LESSER || f->shape == GREATER || end == 0 || fabs(end) > DBL_MAX) return 0;
    if ((f->shape == SINE || f->shape == COSINE) && fabs(end) >= 1) return 0;
    return fabs(end) <= 1e-289 || fabs(end) >= 1e307 ? 2 : 1;
}

static bool unknown(sgt_interval x) { return isnan(x.lo) || isnan(x.hi); }

static const char *fault_of(const function *f, sgt_interval got, sgt_interval want)
{
    if (unknown(got)) return "a NaN";
    if (want.lo > want.hi) return got.lo > got.hi ? NULL : "not empty";
    if (got.lo > got.hi) return "empty";
    if (!(got.lo <= want.lo && got.hi >= want.hi)) return "does not contain";
    if (got.lo < moved(want.lo, -allowed(f, want.lo)) || got.hi > moved(want.hi, allowed(f, want.hi)))
        return "wider than it may be";
    return NULL;
}

/* The value at a member, with any double beside it, is in what was got. */
static void try_member(const function *f, tally *t, sgt_interval x, sgt_interval y, sgt_interval got,
                       bool quiet)
{
    double a = uniform(0, 1), b = uniform(0, 1);
    a = x.lo + a * (x.hi - x.lo), b = y.lo + b * (y.hi - y.lo);
    if (!(a >= x.lo && a <= x.hi && b >= y.lo && b <= y.hi && fabs(a) < inf && fabs(b) < inf)) return;
    if (f->shape >= SINE && f->shape <= TANGENT && fabs(a) > 0x1p30) return; /* slow */
    if (f->shape == POWER && (a < 0 || (a == 0 && b <= 0))) return;
    if (f->shape == ANGLE && a == 0 && (b == 0 || signbit(a))) return;
    sgt_interval want = {value(f, a, b, MPFR_RNDD), value(f, a, b, MPFR_RNDU)};
    if (unknown(want) || (f->from == 0 && a == 0)) return; /* outside of the domain */
    if (!(got.lo <= want.lo && got.hi >= want.hi)) fail(f, t, "a member", x, y, got, want, quiet);
}

static void try(const function *f, tally *t, sgt_interval x, sgt_interval y, bool quiet)
{
    if (f->one) y = sgt_interval_of(0);
    sgt_interval got = f->one ? f->one(x) : f->two(x, y), want = {inf, -inf};
    if (got.lo == inf && got.hi == inf) got.lo = DBL_MAX; /* numbers beyond it */
    if (got.lo == -inf && got.hi == -inf) got.hi = -DBL_MAX;
    bool empty = x.lo > x.hi || y.lo > y.hi, odd = unknown(x) || unknown(y);
    if (odd) want = sgt_interval_all();
    else if (!empty) want = truth(f, x, y);
    const char *what = fault_of(f, got, want);
    t->tried++;
    if (what) fail(f, t, what, x, y, got, want, quiet);
    if (what || odd || empty || want.lo > want.hi) return;
    t->ends += 2, t->tight += (got.lo == want.lo) + (got.hi == want.hi);
    double low = doubles_between(got.lo, want.lo), high = doubles_between(want.hi, got.hi);
    if (low > t->farthest) t->farthest = low;
    if (high > t->farthest) t->farthest = high;
    try_member(f, t, x, y, got, quiet);
}

/* ------------------------------------------------------------------ arguments */

static double any_bits(void)
{
    uint64_t b = random_bits();
    double x;
    memcpy(&x, &b, sizeof x);
    return isnan(x) ? 1 : x;
}

/* Half of them where the function is not simple, others huge, tiny, or next to where it is special. */
static double drawn(const function *f)
{
    const double half_pi = 1.5707963267948966;
    switch (random_bits() % 8) {
    case 0: return any_bits();
    case 1: return uniform(-1, 1) * ldexp(1, (int)(random_bits() % 60) - 30);
    case 2: return moved((double)((int)(random_bits() % 9) - 4), (int64_t)(random_bits() % 9) - 4);
    case 3:
        return moved((double)((int)(random_bits() % 2001) - 1000) * half_pi,
                     (int64_t)(random_bits() % 5) - 2);
    default: return uniform(f->lo, f->hi);
    }
}

/* A point, a few doubles, something narrow, or anything. */
static sgt_interval drawn_interval(const function *f)
{
    double a = drawn(f), b = a, swap;
    switch (random_bits() % 5) {
    case 0: break;
    case 1: b = moved(a, (int64_t)(random_bits() % 20)); break;
    case 2: b = a + uniform(0, 1) * ldexp(1, -(int)(random_bits() % 40)); break;
    case 3: b = a + uniform(0, 7); break;
    default: b = drawn(f);
    }
    if (b < a) swap = a, a = b, b = swap;
    return sgt_interval_between(a, b);
}

static void try_special(const function *f, tally *t, bool quiet)
{
    const double special[] = {
        0, -0.0, least, -least, DBL_MIN, -DBL_MIN, 1, -1, moved(1, 1), moved(1, -1), moved(-1, 1),
        moved(-1, -1), 0x1p-27, 0x1.0000000000001p-27, 0x1p26, 0x1.0000000000001p26, -0x1p26, 0x1p64,
        0x1.8p-540, 40, -40, 709.782712893384, 709.7827128933841, -708.3964185322641, -745.1332191019411,
        -745.1332191019412, 710.4758600739439, 710.475860073944, 712, 8, 27, 0.5, -2, 3, 4,
        1.5707963267948966, 3.141592653589793, DBL_MAX, -DBL_MAX, inf, -inf, NAN};
    enum { SPECIALS = sizeof special / sizeof *special };
    for (int i = 0; i < SPECIALS; i++)
        for (int j = 0; j < SPECIALS; j++) {
            sgt_interval x = sgt_interval_between(special[i], special[j]);
            for (int k = 0; k < (f->one ? 1 : 8); k++) {
                uint64_t from = random_bits() % SPECIALS, to = k & 1 ? from : random_bits() % SPECIALS;
                try(f, t, x, sgt_interval_between(special[from], special[to]), quiet);
            }
        }
}

static tally tallied(const function *f, long n, bool quiet)
{
    tally t = {0, 0, 0, 0, 0};
    try_special(f, &t, quiet);
    for (long i = 0; i < n; i++) try(f, &t, drawn_interval(f), drawn_interval(f), quiet);
    return t;
}

/* The doubles below 2^26 that are nearest to multiples of pi/2, among the convergents of pi/2 times powers of
 * two; the first is 2^-60.5 from 29 pi/2. */
static void try_near_multiples(tally *t)
{
    static const double near_half_pi[] = {0x1.6c6cbc45dc8dep5,  0x1.b951f1572eba5p23, 0x1.b951f1572eba5p24,
                                          0x1.b951f1572eba5p25, 0x1.39c6fd67805a7p18, 0x1.9eb7148f354d6p20};
    for (unsigned i = 0; i < sizeof near_half_pi / sizeof *near_half_pi; i++)
        for (int j = 3; j <= 5; j++) {
            sgt_interval x = sgt_interval_of(near_half_pi[i]), next = {x.lo, moved(x.lo, 1)};
            try(&functions[j], t, x, x, false), try(&functions[j], t, next, x, false);
        }
}

/* ------------------------------------------------------------------ faults */

static sgt_interval low_exponential(sgt_interval x)
{
    sgt_interval y = sgt_interval_exponential(x);
    if (y.hi < inf && y.hi > 1) y.hi = sgt_next_below(y.hi);
    return y;
}

static sgt_interval sine_of_ends(sgt_interval x)
{
    sgt_interval low = sgt_interval_sine(sgt_interval_of(x.lo));
    sgt_interval high = sgt_interval_sine(sgt_interval_of(x.hi));
    return x.lo <= x.hi ? sgt_interval_hull(low, high) : sgt_interval_sine(x);
}

static sgt_interval wide_arc_tangent(sgt_interval x)
{
    sgt_interval y = sgt_interval_arc_tangent(x);
    if (y.lo > 0 && y.lo <= y.hi) y.lo = moved(y.lo, -2);
    return y;
}

static sgt_interval angle_over_cut(sgt_interval y, sgt_interval x)
{
    if (y.lo < 0 && y.hi == 0) y.hi = -least;
    return sgt_interval_angle(y, x);
}

static int planted(void)
{
    const function false_ones[] = {
        {"low_exponential", RISES, low_exponential, mpfr_exp, ALL, -746, 711, 0, 0},
        {"sine_of_ends", SINE, sine_of_ends, mpfr_sin, ALL, -20, 20, 0, 0},
        {"wide_arc_tangent", RISES, wide_arc_tangent, mpfr_atan, ALL, -8, 8, 0, 0},
        {"angle_over_cut", ANGLE, 0, 0, ALL, -3, 3, angle_over_cut, mpfr_atan2},
    };
    int missed = 0;
    for (unsigned i = 0; i < sizeof false_ones / sizeof *false_ones; i++) {
        tally t = tallied(&false_ones[i], 1000, true);
        if (t.failed == 0) missed++, printf("FAIL: the fault %s was not seen\n", false_ones[i].name);
    }
    return missed;
}

int main(void)
{
    const char *seed = getenv("SAGITTA_TEST_SEED"), *scale = getenv("SAGITTA_TEST_SCALE");
    long failures = 0;
    state = seed ? strtoull(seed, NULL, 0) : 1;
    printf("SAGITTA_TEST_SEED=%" PRIu64 "\n", state);
    long n = (long)(30000 * (scale ? atof(scale) : 0.5));
    mpfr_inits2(300, wide, pi, (mpfr_ptr)0);
    mpfr_const_pi(pi, MPFR_RNDN);
    mpfr_inits2(53, first, second, result, (mpfr_ptr)0);
    mpfr_set_emin(-1073), mpfr_set_emax(1024); /* those of doubles; `wide` has them, too, and needs no more */
    printf("%-20s %8s %8s %7s %s\n", "", "tried", "tight", "failed", "doubles too far, at most");
    for (int i = 0; i < FUNCTIONS; i++) {
        tally t = tallied(&functions[i], n, false);
        if (functions[i].shape == SINE) try_near_multiples(&t);
        if (functions[i].shape == ANGLE) /* a slope below the least double, found by fuzzing */
            try(&functions[i], &t, sgt_interval_of(-0x1.ffffp-211), sgt_interval_of(0x1.4444p+976), false);
        printf("%-20s %8ld %7.2f%% %7ld %g\n", functions[i].name, t.tried,
               100.0 * (double)t.tight / (double)t.ends, t.failed, t.farthest);
        failures += t.failed;
    }
    failures += planted();
    printf("%ld failures\n", failures);
    return failures != 0;
}
