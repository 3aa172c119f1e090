// SPDX-License-Identifier: MIT
/* The solver alone: sgt_root_begin, sgt_root_next, fed equations whose roots are known in
 * closed form, with true slopes and with lies.  What must hold, whatever the slope says:
 *   - no t outside the span, never NaN; never more evaluations than the budget;
 *   - HIT: a root within t_err, and g changes sign within t_err or |g| <= g_err;
 *   - MISS only where `single` was promised and there is no root. */
#include "unit.h"

typedef double equation_g(double t, double *slope);

/* The statuses that are right: a set. */
enum { HIT = 1, GRAZE = 2, MISS = 4, UNPROVEN = 8, UNDEFINED = 16, EXHAUSTED = 32 };

static int set_of(sgt_status s)
{
    switch (s) {
    case SGT_HIT: return HIT;
    case SGT_GRAZE: return GRAZE;
    case SGT_MISS: return MISS;
    case SGT_UNPROVEN: return UNPROVEN;
    case SGT_UNDEFINED: return UNDEFINED;
    case SGT_EXHAUSTED: return EXHAUSTED;
    default: return 0;
    }
}

typedef struct equation {
    const char *name;
    equation_g *g;
    double lo, hi, seed;
    double root;     /* the nearest of them counts, where there is a second */
    double second;
    double off;      /* how far a root of g as computed may be from that of g */
    double g_err;
    int right;       /* with a true slope; with a lie UNPROVEN is right too, unless `ends` */
    bool ends;       /* g has certain, opposite signs at the ends: nothing but HIT will do */
    bool single;
    bool nice;       /* at most 10 evaluations with a true slope */
} equation;

#define PI_2 1.5707963267948966
enum { BUDGET = 2000 }; /* the default of max_evals */

static double g_cos(double t, double *s) { return *s = -sin(t), cos(t); }
static double g_square(double t, double *s) { return *s = 2 * t, t * t - 2; }
static double g_wallis(double t, double *s) { return *s = 3 * t * t - 2, t * t * t - 2 * t - 5; }
static double g_exp(double t, double *s) { return *s = exp(t), exp(t) - 2; }
static double g_ninth(double t, double *s) { return *s = 9 * pow(t, 8), pow(t, 9); }
static double g_cube_root(double t, double *s) { return *s = 1 / (3 * cbrt(t) * cbrt(t)), cbrt(t); }
static double g_exp_50(double t, double *s) { return *s = 50 * exp(50 * t), expm1(50 * t); }
static double g_atan(double t, double *s) { return *s = 1 / (1 + t * t), atan(t); }
static double g_erf(double t, double *s) { return *s = 1.1283791670955126 * exp(-t * t), erf(t) - 0.5; }
static double g_huge(double t, double *s) { return *s = 1e-300, t / 1e300 - 1; }
static double g_tiny(double t, double *s) { return *s = 1e300, t * 1e300 - 1; }
static double g_square_tiny(double t, double *s) { return *s = 2 * t, t * t - 1e-300; }
static double g_line(double t, double *s) { return *s = 1, t; }
static double g_line_1(double t, double *s) { return *s = 1, t - 1; }
static double g_kepler(double t, double *s)
{
    return *s = 1 - 0.99 * cos(t), (t - 0.1) - 0.99 * (sin(t) - sin(0.1));
}
static double g_log(double t, double *s) { return *s = 1 / t, log(t); } /* NaN for t < 0 */
static double g_root(double t, double *s) { return *s = 0.5 / sqrt(t), sqrt(t) - 2; }
static double g_tan(double t, double *s) { return *s = 1 + tan(t) * tan(t), tan(t); }
static double g_pole(double t, double *s) { return *s = -1 / (t * t), 1 / t; }
static double g_jump(double t, double *s) { return *s = 0, t < 0.3 ? -1 : 1; }
static double g_island(double t, double *s) { return *s = 1, t > 0.3 && t < 0.5 ? NOT : t - 0.7; }
static double g_island_beside(double t, double *s)
{
    return *s = 1, t > 0.6 && t < 0.6999999 ? NOT : t - 0.7;
}
static double g_island_on(double t, double *s) { return *s = 1, t > 0.69 && t < 0.71 ? NOT : t - 0.7; }
static double g_islands(double t, double *s) /* two thirds of the line are NaN, the root is not */
{
    *s = 3 * t * t;
    return fabs(t - 0.5) > 0.01 && fabs(remainder(t, 0.03)) < 0.01 ? NOT : t * t * t - 0.125;
}
static double g_nowhere(double t, double *s) { return (void)t, *s = 1, NOT; }
static double g_noise(double t, double *s) { return *s = 1, t - 0.5 + 0.99e-8 * sin(1e12 * t); }
static double g_double(double t, double *s) { return *s = 2 * (t - 0.3), (t - 0.3) * (t - 0.3); }
static double g_bowl(double t, double *s) { return *s = 2 * t, t * t + 1; }
static double g_exp_0(double t, double *s) { return *s = exp(t), exp(t); }
static double g_cube_8(double t, double *s) { return *s = 3 * t * t, t * t * t - 8; }
static double g_atan_far(double t, double *s) { return *s = 1 / (1 + (t - 1e5) * (t - 1e5)), atan(t - 1e5); }
static double g_log_100(double t, double *s) { return *s = 1 / t, log(t) - 100; }
static double g_close(double t, double *s) { return *s = 2 * (t - 2), (t - 2) * (t - 2) - 0x1p-46; }
static double g_cycle(double t, double *s) { return *s = 3 * t * t - 2, t * t * t - 2 * t + 2; }
static double g_bell(double t, double *s) { return *s = (1 - 2 * t * t) * exp(-t * t), t * exp(-t * t); }
static double g_fifth(double t, double *s) { return *s = 5 * pow(t - 1, 4), pow(t - 1, 5); }
static double g_hyperbola(double t, double *s) { return *s = 20 + 1 / (19 * t * t), 20 * t - 1 / (19 * t); }
static double g_twentieth(double t, double *s) { return *s = 20 * pow(t, 19), pow(t, 20) - 1; }
static double g_weak(double t, double *s) { return *s = 1e-200, 1e-200 * (t - 3); }
static double g_strong(double t, double *s) { return *s = 1e200, 1e200 * (t - 3); }
static double g_square_root(double t, double *s)
{
    return *s = 0.5 / sqrt(fabs(t)), copysign(sqrt(fabs(t)), t);
}
static double g_flat(double t, double *s)
{
    return *s = 2 / fabs(t * t * t) * exp(-1 / (t * t)), copysign(exp(-1 / (t * t)), t);
}
static double g_subnormal(double t, double *s) { return *s = 1e-310, 1e-310 * (t - 1); }
static double g_infinite(double t, double *s) { return *s = 0, t < 1 ? -FAR : FAR; }
static double g_overflow(double t, double *s) { return *s = 1e200 * 3 * t * t, 1e300 * (t - 2) * 1e300; }
static double g_sphere(double t, double *s) /* the scan lens's first surface, in t; NaN beyond the radius */
{
    double R = -2.2136, y = 0.5 + 0.3420201433256687 * t, z = -5 + 0.9396926207859084 * t,
           phi = sqrt(1 - y * y / (R * R));
    *s = 0.9396926207859084 - y / (R * phi) * 0.3420201433256687;
    return z - y * y / R / (1 + phi);
}

static const equation equations[] = {
    {.name = "cos", .g = g_cos, .lo = 0, .hi = 2, .seed = 1, .root = PI_2, .right = HIT, .ends = true,
     .nice = true},
    {.name = "x^2 - 2", .g = g_square, .lo = 0, .hi = 2, .seed = 1, .root = 1.4142135623730951, .right = HIT,
     .ends = true, .nice = true},
    {.name = "x^3 - 2x - 5 (Wallis)", .g = g_wallis, .lo = 2, .hi = 3, .seed = 2, .root = 2.0945514815423265,
     .right = HIT, .ends = true, .nice = true},
    {.name = "exp x - 2", .g = g_exp, .lo = -10, .hi = 10, .seed = 1, .root = 0.6931471805599453,
     .right = HIT, .ends = true, .nice = true},
    {.name = "exp x - 2, single", .g = g_exp, .lo = -10, .hi = 10, .seed = -3, .root = 0.6931471805599453,
     .right = HIT, .ends = true, .single = true},
    {.name = "x^9", .g = g_ninth, .lo = -1, .hi = 1.5, .seed = 1, .root = 0, .off = 1e-35, .right = HIT,
     .ends = true},
    {.name = "cube root, Newton doubles x", .g = g_cube_root, .lo = -1, .hi = 2, .seed = 1.5, .root = 0,
     .right = HIT, .ends = true},
    {.name = "exp 50x - 1, from the flat side", .g = g_exp_50, .lo = -1, .hi = 1, .seed = -0.5, .root = 0,
     .right = HIT, .ends = true},
    {.name = "exp 50x - 1, from the steep side", .g = g_exp_50, .lo = -1, .hi = 1, .seed = 1, .root = 0,
     .right = HIT, .ends = true},
    {.name = "atan, from far away", .g = g_atan, .lo = -1e6, .hi = 2e6, .seed = 1e5, .root = 0, .right = HIT,
     .ends = true},
    {.name = "erf x - 1/2", .g = g_erf, .lo = -5, .hi = 5, .seed = 4.5, .root = 0.4769362762044699,
     .right = HIT, .ends = true},
    {.name = "a root at 1e300", .g = g_huge, .lo = 0, .hi = DBL_MAX, .seed = 1, .root = 1e300, .right = HIT,
     .ends = true},
    {.name = "a root at 1e-300", .g = g_tiny, .lo = 0, .hi = 1, .seed = 1, .root = 1e-300, .right = HIT,
     .ends = true},
    {.name = "x^2 - 1e-300", .g = g_square_tiny, .lo = 0, .hi = 1, .seed = 1, .root = 1e-150, .right = HIT,
     .ends = true},
    {.name = "a root at the lower end", .g = g_line, .lo = 0, .hi = 1, .seed = 0.5, .root = 0,
     .right = HIT | GRAZE},
    {.name = "a root at the upper end", .g = g_line_1, .lo = 0, .hi = 1, .seed = 0.5, .root = 1,
     .right = HIT | GRAZE},
    {.name = "a root at the seed", .g = g_line_1, .lo = 0, .hi = 3, .seed = 1, .root = 1, .right = HIT,
     .ends = true, .nice = true},
    {.name = "a root at zero", .g = g_line, .lo = -1, .hi = 2, .seed = 1, .root = 0, .right = HIT,
     .ends = true, .nice = true},
    {.name = "Kepler's, e = 0.99", .g = g_kepler, .lo = -3, .hi = 3, .seed = 0, .root = 0.1, .off = 1e-14,
     .right = HIT, .ends = true},
    {.name = "log, undefined at the seed", .g = g_log, .lo = -1, .hi = 10, .seed = -0.5, .root = 1,
     .right = HIT},
    {.name = "sqrt, undefined at the seed", .g = g_root, .lo = -10, .hi = 100, .seed = -5, .root = 4,
     .off = 1e-14, .right = HIT},
    {.name = "tan, a pole", .g = g_tan, .lo = 0.1, .hi = 3, .seed = 1, .root = PI_2, .right = HIT,
     .ends = true},
    {.name = "1/x, a pole", .g = g_pole, .lo = -1, .hi = 2, .seed = 1, .root = 0, .off = 1e-300, .right = HIT,
     .ends = true},
    {.name = "a jump", .g = g_jump, .lo = -1, .hi = 1, .seed = 0, .root = 0.3, .right = HIT, .ends = true},
    {.name = "an island of NaN on the way", .g = g_island, .lo = 0, .hi = 1, .seed = 0.1, .root = 0.7,
     .right = HIT | UNDEFINED},
    {.name = "an island of NaN beside the root", .g = g_island_beside, .lo = 0, .hi = 1, .seed = 0.1,
     .root = 0.7, .right = HIT | UNDEFINED},
    {.name = "an island of NaN on the root", .g = g_island_on, .lo = 0, .hi = 1, .seed = 0.1, .root = NOT,
     .right = UNDEFINED},
    {.name = "islands of NaN everywhere", .g = g_islands, .lo = 0, .hi = 1, .seed = 0.9, .root = 0.5,
     .right = HIT | UNDEFINED},
    {.name = "NaN everywhere", .g = g_nowhere, .lo = 0, .hi = 1, .seed = 0.9, .root = NOT,
     .right = UNDEFINED},
    {.name = "NaN everywhere, single", .g = g_nowhere, .lo = 0, .hi = 1, .seed = 0.9, .root = NOT,
     .single = true, .right = UNDEFINED},
    {.name = "noise", .g = g_noise, .lo = 0, .hi = 1, .seed = 0.9, .root = 0.5, .off = 1e-8, .g_err = 1e-8,
     .right = HIT | GRAZE},
    {.name = "a double root", .g = g_double, .lo = 0, .hi = 1, .seed = 0.9, .root = 0.3, .off = 1e-160,
     .right = GRAZE | UNPROVEN},
    {.name = "a double root with rounding", .g = g_double, .lo = 0, .hi = 1, .seed = 0.9, .root = 0.3,
     .off = 1.1e-8, .g_err = 1e-16, .right = GRAZE | UNPROVEN},
    {.name = "no root", .g = g_bowl, .lo = -2, .hi = 3, .seed = 1, .root = NOT, .right = UNPROVEN},
    {.name = "no root, single", .g = g_exp_0, .lo = -2, .hi = 3, .seed = 1, .root = NOT, .right = MISS,
     .single = true},
    {.name = "no root on the half-line", .g = g_exp_0, .lo = 0, .hi = FAR, .seed = 1, .root = NOT,
     .right = UNPROVEN},
    {.name = "no root, no end", .g = g_bowl, .lo = -FAR, .hi = FAR, .seed = NOT, .root = NOT,
     .right = UNPROVEN | EXHAUSTED},
    {.name = "x^3 - 8, no end", .g = g_cube_8, .lo = -FAR, .hi = FAR, .seed = NOT, .root = 2, .right = HIT},
    {.name = "atan far away, no end", .g = g_atan_far, .lo = -FAR, .hi = FAR, .seed = 0, .root = 1e5,
     .right = HIT | UNPROVEN},
    {.name = "log x - 100, no end", .g = g_log_100, .lo = 0, .hi = FAR, .seed = 1,
     .root = 2.6881171418161356e43, .off = 1e30, .right = HIT | UNPROVEN},
    {.name = "two roots close together", .g = g_close, .lo = 0, .hi = 3, .seed = 3, .root = 2 + 0x1p-23,
     .second = 2 - 0x1p-23, .right = HIT},
    {.name = "x^3 - 2x + 2, Newton's cycle", .g = g_cycle, .lo = -3, .hi = 3, .seed = 0,
     .root = -1.7692923542386314, .right = HIT, .ends = true},
    {.name = "x exp -x^2, Newton leaves", .g = g_bell, .lo = -0.5, .hi = 3, .seed = 2, .root = 0,
     .right = HIT, .ends = true},
    {.name = "(x - 1)^5", .g = g_fifth, .lo = -1, .hi = 4, .seed = 3, .root = 1, .off = 1e-60, .right = HIT,
     .ends = true},
    {.name = "20x - 1/19x", .g = g_hyperbola, .lo = 0.01, .hi = 1, .seed = 1, .root = 0.05129891760425771,
     .right = HIT, .ends = true},
    {.name = "x^20 - 1, from the flat side", .g = g_twentieth, .lo = 0, .hi = 2, .seed = 0.5, .root = 1,
     .off = 1e-15, .right = HIT, .ends = true},
    {.name = "a weak slope", .g = g_weak, .lo = 0, .hi = 10, .seed = 7, .root = 3, .right = HIT, .ends = true,
     .nice = true},
    {.name = "a strong slope", .g = g_strong, .lo = 0, .hi = 10, .seed = 7, .root = 3, .right = HIT,
     .ends = true, .nice = true},
    {.name = "square root, Newton's mirror", .g = g_square_root, .lo = -1, .hi = 2, .seed = 1, .root = 0,
     .right = HIT, .ends = true},
    {.name = "flat as exp -1/x^2", .g = g_flat, .lo = -1, .hi = 2, .seed = 1, .root = 0, .off = 0.04,
     .right = HIT | GRAZE},
    {.name = "subnormal g", .g = g_subnormal, .lo = 0, .hi = 4, .seed = 3, .root = 1, .off = 1e-13,
     .right = HIT, .ends = true},
    {.name = "infinite g", .g = g_infinite, .lo = 0, .hi = 4, .seed = 3, .root = 1, .right = HIT,
     .ends = true},
    {.name = "overflowing g", .g = g_overflow, .lo = 0, .hi = 4, .seed = 3, .root = 2, .right = HIT,
     .ends = true},
    {.name = "a span of one point, a root", .g = g_line_1, .lo = 1, .hi = 1, .seed = NOT, .root = 1,
     .right = HIT | GRAZE},
    {.name = "a span of one point, none", .g = g_line, .lo = 1, .hi = 1, .seed = 1, .root = NOT,
     .single = true, .right = MISS},
    {.name = "the scan lens, undefined at the seed", .g = g_sphere, .lo = -12, .hi = 12,
     .seed = 5.3208888623795616, .root = 4.143085073464612, .off = 2e-15, .right = HIT},
};

/* What the slope says. */
typedef enum lie {
    TRUTH,
    NEGATIVE,
    STEEP,
    FLAT,
    NONE,
    INFINITE,
    MINUS_INFINITE,
    UNKNOWN,
    UNIT,
    RANDOM,
    LIES
} lie;
static const char *const lie_name[LIES] = {"truth",    "negative",  "times 1e6", "times 1e-6", "zero",
                                           "infinite", "-infinite", "NaN",       "unit",       "random"};

static double told(lie what, double slope, generator *g)
{
    switch (what) {
    case NEGATIVE: return -slope;
    case STEEP: return 1e6 * slope;
    case FLAT: return 1e-6 * slope;
    case NONE: return 0;
    case INFINITE: return FAR;
    case MINUS_INFINITE: return -FAR;
    case UNKNOWN: return NOT;
    case UNIT: return copysign(1, slope);
    case RANDOM: return either_sign(g) * log_uniform(g, 1e-9, 1e9);
    default: return slope;
    }
}

static double ulps(double x, int n)
{
    double a = fabs(x) * DBL_EPSILON;
    return n * (a > DBL_TRUE_MIN ? a : DBL_TRUE_MIN);
}

/* Is there a change of sign, or a zero, of g within t_err of t?  At the ends, at t, and at a
 * few points between: g is what was computed. */
static bool changes_sign(const equation *e, double t, double t_err)
{
    double at, s, previous = 0;
    int before = 0;
    for (int i = -8; i <= 8; i++) {
        double x = t + t_err * (i / 8.0);
        x = fmin(fmax(x, e->lo), e->hi);
        at = e->g(x, &s);
        if (fabs(at) <= e->g_err) return true;
        int now = at > 0 ? 1 : at < 0 ? -1 : 0;
        if (now * before < 0 && !isnan(previous)) return true;
        if (now) before = now;
        previous = at;
    }
    return false;
}

static sgt_root solve(const equation *e, lie what, const sgt_options *opt, generator *g)
{
    int budget = opt && opt->max_evals ? opt->max_evals : 2000, evals = 0;
    sgt_root r = sgt_root_begin((sgt_span){.lo = e->lo, .hi = e->hi, .seed = e->seed, .single = e->single},
                                opt);
    bool more;
    r.g_err = e->g_err;
    do {
        double slope, value;
        REQUIRE(r.t >= e->lo && r.t <= e->hi, "%s, slope %s: asks at %.17g", e->name, lie_name[what], r.t);
        value = e->g(r.t, &slope);
        evals++;
        more = sgt_root_next(&r, value, told(what, slope, g));
        REQUIRE(evals <= budget, "%s, slope %s: over the budget", e->name, lie_name[what]);
    } while (more);
    REQUIRE(r.evals == evals, "%s, slope %s: %d evaluations, says %d", e->name, lie_name[what], evals,
            r.evals);
    REQUIRE(!sgt_root_next(&r, 1, 1), "%s: goes on after its end", e->name);
    if (r.status > 0) {
        double off = fmin(fabs(r.t - e->root), e->second != 0 ? fabs(r.t - e->second) : FAR);
        if (opt && opt->f_tol > 0) off *= 0.5; /* t_err is then |g| / |slope|, right to first order */
        REQUIRE(r.t >= e->lo && r.t <= e->hi && r.t_err >= 0, "%s: ends at %.17g +- %g", e->name, r.t,
                r.t_err);
        REQUIRE(off <= r.t_err + e->off + ulps(e->root, 2), "%s, slope %s: t %.17g is %g off, t_err %g",
                e->name, lie_name[what], r.t, off, r.t_err);
    } else {
        REQUIRE(isnan(r.t) || r.status == SGT_EXHAUSTED, "%s, slope %s: %s at %g", e->name, lie_name[what],
                sgt_status_text(r.status), r.t);
    }
    if (r.status == SGT_HIT)
        REQUIRE(changes_sign(e, r.t, r.t_err + ulps(r.t, 1)) || (opt && opt->f_tol > 0),
                "%s, slope %s: no change of sign at %.17g +- %g", e->name, lie_name[what], r.t, r.t_err);
    return r;
}

static void test_true_slopes(void **state)
{
    (void)state;
    generator g = {1};
    for (size_t i = 0; i < COUNT_OF(equations); i++) {
        const equation *e = &equations[i];
        sgt_root r = solve(e, TRUTH, NULL, &g);
        REQUIRE(set_of(r.status) & e->right, "%s: %s after %d", e->name, sgt_status_text(r.status), r.evals);
        REQUIRE(!e->nice || r.evals <= 10, "%s: %d evaluations", e->name, r.evals);
        /* to rounding, unless an end of the answer is not defined or the root is a multiple one */
        if (r.status == SGT_HIT && e->ends && e->off == 0)
            REQUIRE(r.t_err <= ulps(e->root, 8), "%s: t_err %g at %.17g", e->name, r.t_err, r.t);
    }
    print_message("%zu equations\n", COUNT_OF(equations));
}

static void test_lying_slopes(void **state)
{
    (void)state;
    generator g = seeded("lying slopes");
    int worst = 0;
    const char *worst_name = "";
    for (size_t i = 0; i < COUNT_OF(equations); i++)
        for (int what = NEGATIVE; what < LIES; what++)
            for (int again = 0; again < (what == RANDOM ? 20 : 1); again++) {
                const equation *e = &equations[i];
                sgt_root r = solve(e, (lie)what, NULL, &g);
                int right = e->right | (e->ends ? 0 : UNPROVEN) | (e->right & HIT ? GRAZE : 0);
                if (e->ends) right &= ~UNPROVEN;
                REQUIRE(set_of(r.status) & right, "%s, slope %s: %s after %d", e->name, lie_name[what],
                        sgt_status_text(r.status), r.evals);
                if (r.evals > worst) worst = r.evals, worst_name = e->name;
            }
    print_message("at most %d evaluations (%s)\n", worst, worst_name);
}

static void test_budget(void **state)
{
    (void)state;
    generator g = {1};
    for (size_t i = 0; i < COUNT_OF(equations); i++) {
        int needed = solve(&equations[i], TRUTH, NULL, &g).evals;
        for (int budget = 1; budget <= 20; budget++) {
            sgt_root r = solve(&equations[i], TRUTH, &(sgt_options){.max_evals = budget}, &g);
            if (budget < needed)
                REQUIRE(r.status == SGT_EXHAUSTED && r.evals == budget,
                        "%s, %d of %d evaluations: %s after %d", equations[i].name, budget, needed,
                        sgt_status_text(r.status), r.evals);
            else
                REQUIRE(r.status != SGT_EXHAUSTED, "%s: exhausted by %d, needs %d", equations[i].name, budget,
                        needed);
        }
    }
}

static void test_tolerances(void **state)
{
    (void)state;
    generator g = {1};
    for (size_t i = 0; i < COUNT_OF(equations); i++) {
        const equation *e = &equations[i];
        int needed = solve(e, TRUTH, NULL, &g).evals;
        for (double tol = 1e-3; tol > 1e-16; tol *= 0.1) {
            /* t_err is a bound all the same */
            sgt_root r = solve(e, TRUTH, &(sgt_options){.t_tol = tol}, &g);
            if (e->nice)
                REQUIRE(r.evals <= needed + 2 && r.status == SGT_HIT && r.t_err <= 4 * tol + ulps(r.t, 8),
                        "%s, t_tol %g: t_err %g", e->name, tol, r.t_err);
            if (!e->nice) continue;
            r = solve(e, TRUTH, &(sgt_options){.f_tol = tol}, &g);
            double slope;
            REQUIRE(r.status == SGT_HIT && fabs(e->g(r.t, &slope)) <= fmax(tol, ulps(r.t, 4) * fabs(slope)),
                    "%s, f_tol %g", e->name, tol);
            REQUIRE(r.evals <= needed, "%s, f_tol %g: %d evaluations, %d without", e->name, tol, r.evals,
                    needed);
        }
    }
}

static void require_invalid(sgt_span span, const sgt_options *opt, const char *why)
{
    sgt_root r = sgt_root_begin(span, opt);
    REQUIRE(r.status == SGT_INVALID, "%s: %s", why, sgt_status_text(r.status));
    REQUIRE(!sgt_root_next(&r, 1, 1), "%s: asks for more", why);
    REQUIRE(r.status == SGT_INVALID, "%s: %s after a step", why, sgt_status_text(r.status));
}

static void test_invalid(void **state)
{
    (void)state;
    sgt_span good = {.lo = 0, .hi = 1, .seed = 0.5};
    require_invalid((sgt_span){.lo = 1, .hi = 0, .seed = 0.5}, NULL, "lo > hi");
    require_invalid((sgt_span){.lo = NOT, .hi = 1, .seed = 0.5}, NULL, "lo is NaN");
    require_invalid((sgt_span){.lo = 0, .hi = NOT, .seed = 0.5}, NULL, "hi is NaN");
    require_invalid(good, &(sgt_options){.t_tol = -1}, "t_tol < 0");
    require_invalid(good, &(sgt_options){.t_tol = NOT}, "t_tol is NaN");
    require_invalid(good, &(sgt_options){.f_tol = -1}, "f_tol < 0");
    require_invalid(good, &(sgt_options){.f_tol = NOT}, "f_tol is NaN");
    require_invalid(good, &(sgt_options){.max_evals = -1}, "max_evals < 0");
    sgt_root r = sgt_root_begin(good, NULL);
    REQUIRE(r.status != SGT_INVALID && r.t == 0.5, "a good span: %s at %g", sgt_status_text(r.status), r.t);
}

/* ------------------------------------------- random equations, random lies */

/* sign(t - root) |t - root|^power * (a positive, wavy factor): one change of sign, whose place
 * is exact in doubles, however it is scaled.  NaN in the holes. */
typedef struct curve {
    double root, power, scale, wave, phase;
    struct { double lo, hi; } hole[3];
    int holes;
} curve;

static double curve_g(const curve *c, double t, double *slope)
{
    for (int i = 0; i < c->holes; i++)
        if (t > c->hole[i].lo && t < c->hole[i].hi) return *slope = NOT;
    double x = t - c->root, a = pow(fabs(x), c->power), w = 1 + 0.5 * sin(c->wave * x + c->phase);
    *slope = c->scale *
             (c->power * pow(fabs(x), c->power - 1) * w + a * 0.5 * c->wave * cos(c->wave * x + c->phase));
    return c->scale * copysign(a * w, x);
}

static void test_random(void **state)
{
    (void)state;
    generator g = seeded("random equations");
    static const double powers[] = {1.0 / 3, 0.5, 1, 1, 1, 2, 3, 5};
    long n = scaled(100000), found = 0, evals = 0;
    int most = 0;
    for (long i = 0; i < n; i++) {
        double size = log_uniform(&g, 1e-12, 1e12),
               at = chance(&g, 0.2) ? 0 : either_sign(&g) * log_uniform(&g, 1e-12, 1e12);
        curve c = {.root = at,
                   .power = powers[below(&g, (int)COUNT_OF(powers))],
                   .wave = chance(&g, 0.5) ? 0 : uniform(&g, 0, 3) / size,
                   .phase = uniform(&g, 0, 6),
                   .scale = either_sign(&g) * log_uniform(&g, 1e-9, 1e9)};
        sgt_span span = {.lo = at - size * uniform(&g, 0.01, 1),
                         .hi = at + size * uniform(&g, 0.01, 1),
                         .single = chance(&g, 0.5)};
        if (!(span.lo < at && span.hi > at)) continue; /* size below an ulp of the root */
        span.seed = chance(&g, 0.2) ? NOT : uniform(&g, span.lo, span.hi);
        if (chance(&g, 0.1)) span.hi = FAR;
        if (chance(&g, 0.1)) span.lo = -FAR;
        c.holes = chance(&g, 0.7) ? 0 : 1 + below(&g, 3);
        for (int h = 0; h < c.holes; h++) {
            double side = either_sign(&g), near = log_uniform(&g, 1e-9, 1) * size,
                   across = uniform(&g, 0, 1) * size;
            c.hole[h].lo = side > 0 ? at + near : at - near - across;
            c.hole[h].hi = side > 0 ? at + near + across : at - near;
        }
        lie what = chance(&g, 0.3) ? TRUTH : (lie)below(&g, LIES);
        bool fickle = chance(&g, 0.3); /* another lie at each step */

        sgt_root r = sgt_root_begin(span, NULL);
        bool more;
        int spent = 0;
        do {
            double slope;
            REQUIRE(r.t >= span.lo && r.t <= span.hi, "case %ld: asks at %.17g of [%g, %g]", i, r.t, span.lo,
                    span.hi);
            double value = curve_g(&c, r.t, &slope);
            if (fickle) what = (lie)below(&g, LIES);
            more = sgt_root_next(&r, value, told(what, slope, &g));
            REQUIRE(++spent <= 2000, "case %ld: over the budget", i);
        } while (more);

        double s, left = curve_g(&c, fmax(span.lo, -DBL_MAX), &s),
                  right = curve_g(&c, fmin(span.hi, DBL_MAX), &s);
        bool sure = c.holes == 0 && left * right < 0 && isfinite(span.lo) && isfinite(span.hi);
        REQUIRE(r.status != SGT_MISS, "case %ld: a miss, the root is %.17g in [%.17g, %.17g]", i, at, span.lo,
                span.hi);
        REQUIRE(r.status != SGT_INVALID, "case %ld: invalid", i);
        REQUIRE(r.status > 0 || !sure,
                "case %ld: %s after %d; root %.17g in [%.17g, %.17g], power %g, slope %s", i,
                sgt_status_text(r.status), r.evals, at, span.lo, span.hi, c.power,
                fickle ? "fickle" : lie_name[what]);
        REQUIRE(r.status != SGT_UNDEFINED || c.holes, "case %ld: undefined without a hole", i);
        if (r.status > 0) {
            long double off = fabsl((long double)r.t - at);
            /* where g underflows to zero, that is a root as computed */
            long double zero = powl(1e-322L / fminl(1, fabsl((long double)c.scale)),
                                    1 / (long double)c.power);
            REQUIRE(off <= (long double)r.t_err * (1 + 1e-15L) + zero,
                    "case %ld: %s t %.17g is %Lg off, t_err %g; power %g", i, sgt_status_text(r.status), r.t,
                    off, r.t_err, c.power);
            if (sure && r.status == SGT_HIT && c.power <= 1)
                REQUIRE(r.t_err <= ulps(at, 16) + 1e-300, "case %ld: t_err %g at %.17g, power %g", i, r.t_err,
                        r.t, c.power);
            found++, evals += r.evals;
            if (r.evals > most) most = r.evals;
        }
    }
    print_message("%ld of %ld found, %.1f evaluations on average, at most %d\n", found, n,
                  (double)evals / (double)found, most);
}

/* A hole narrower than the tolerance, with the change of sign in it: a root is nowhere defined.  What was
 * seen is NaN inside of the bracket; a search that has not seen it cannot know. */
static void test_narrow_holes(void **state)
{
    (void)state;
    generator g = seeded("narrow holes");
    long n = scaled(20000), undefined = 0, unseen = 0;
    for (long i = 0; i < n; i++) {
        double at = uniform(&g, -1, 1), half = log_uniform(&g, 1e-12, 1e-2),
               tol = log_uniform(&g, 1e-3, 1e3) * half,
               steep = chance(&g, 0.3) ? 0 : log_uniform(&g, 1e-3, 1e3), nan = NOT;
        sgt_span span = {
            .lo = -2, .hi = 2, .seed = chance(&g, 0.3) ? NOT : uniform(&g, -2, 2), .single = chance(&g, 0.5)};
        sgt_root r = sgt_root_begin(span, &(sgt_options){.t_tol = tol});
        double value, slope;
        bool more;
        do {
            double w = r.t - at;
            value = fabs(w) < half ? nan : copysign(chance(&g, 0.5) ? 1 : 0.5, w) + steep * w, slope = steep;
            if (isnan(value)) span.seed = r.t; /* the last hole */
            else if (fabs(span.seed - at) >= half) span.seed = NOT;
            more = sgt_root_next(&r, value, slope);
        } while (more);
        bool seen = !isnan(span.seed) && span.seed > r.lo && span.seed < r.hi;
        REQUIRE(!seen || r.status < 0,
                "case %ld: %s at %.17g +- %g, where g is undefined within %g of %.17g; t_tol %g", i,
                sgt_status_text(r.status), r.t, r.t_err, half, at, tol);
        REQUIRE(r.status <= 0 || r.t_err >= half || fabs(r.t - at) <= r.t_err,
                "case %ld: %s at %.17g +- %g, none is there", i, sgt_status_text(r.status), r.t, r.t_err);
        undefined += r.status == SGT_UNDEFINED, unseen += r.status > 0;
    }
    REQUIRE(undefined > n / 4, "only %ld of %ld are undefined", undefined, n);
    print_message("%ld of %ld undefined, in %ld the hole was not seen\n", undefined, n, unseen);
}

static void test_texts(void **state)
{
    (void)state;
    static const char *const status[] = {"invalid",  "stopped", "exhausted", "undefined",
                                         "unproven", "miss",    "hit",       "graze"};
    static const char *const move[] = {"seed", "march", "newton", "bisect", "retreat", "probe"};
    for (int i = SGT_INVALID; i <= SGT_GRAZE; i++)
        assert_string_equal(sgt_status_text((sgt_status)i), status[i - SGT_INVALID]);
    for (int i = SGT_SEED; i <= SGT_PROBE; i++) assert_string_equal(sgt_move_text((sgt_move)i), move[i]);
    assert_string_equal(sgt_status_text((sgt_status)99), "?");
    assert_string_equal(sgt_move_text((sgt_move)99), "?");
}

/* g as computed is off by all that g_err allows: with f_tol too t_err holds for the exact g. */
static void test_uncertain(void **state)
{
    (void)state;
    generator g = seeded("uncertain");
    for (long i = 0; i < scaled(2000); i++) {
        double root = uniform(&g, -2, 2), e = log_uniform(&g, 1e-12, 1e-3), off = e * uniform(&g, -1, 1),
               slope = log_uniform(&g, 1e-3, 1e3);
        sgt_options opt = {.f_tol = e * log_uniform(&g, 1e-3, 1e3)};
        sgt_root r = sgt_root_begin(
            (sgt_span){
                .lo = -3, .hi = 3, .seed = uniform(&g, 0, 1) < 0.3 ? root - off / slope : uniform(&g, -3, 3)},
            &opt);
        r.g_err = e * (1 + 1e-9) + 1e-14 * slope;
        while (sgt_root_next(&r, slope * (r.t - root) + off, slope))
            ;
        REQUIRE(r.status != SGT_HIT || fabs(r.t - root) <= r.t_err,
                "slope %g, g_err %g, f_tol %g: the root is %g away, t_err is %g", slope, r.g_err, opt.f_tol,
                fabs(r.t - root), r.t_err);
    }
}

/* A straight line in noise, its root now and then at an end of the span, with slopes that are told up to
 * 1.9 times too steep, or too flat: whatever is told of a root, it is within t_err, which has twice what
 * |g| and its rounding can move it. */
static void test_in_noise(void **state)
{
    (void)state;
    generator g = seeded("in noise");
    long n = scaled(50000), hits = 0, grazes = 0;
    for (long i = 0; i < n; i++) {
        double lo = uniform(&g, -1, 1), hi = lo + log_uniform(&g, 1e-3, 1),
               root = chance(&g, 0.3)   ? lo
                      : chance(&g, 0.4) ? hi
                                        : uniform(&g, lo, hi);
        double steep = either_sign(&g) * log_uniform(&g, 1e-3, 1e3),
               noise = fabs(steep) * log_uniform(&g, 1e-12, 1e-2), told = log_uniform(&g, 0.02, 1.9);
        sgt_root r = sgt_root_begin((sgt_span){.lo = lo, .hi = hi, .seed = uniform(&g, lo, hi)}, NULL);
        do r.g_err = noise;
        while (sgt_root_next(&r,
                             steep * (r.t - root) + noise * (chance(&g, 0.5) ? 0.99 * either_sign(&g)
                                                                             : uniform(&g, -0.99, 0.99)),
                             told * steep));
        hits += r.status == SGT_HIT, grazes += r.status == SGT_GRAZE;
        if (r.status > 0)
            REQUIRE(fabs(r.t - root) <= r.t_err * (1 + 1e-12) + 1e-15,
                    "case %ld: %s at %.17g +- %g, the root is at %.17g of [%g, %g]; noise / slope %g, slopes "
                    "told are %g of the true",
                    i, sgt_status_text(r.status), r.t, r.t_err, root, lo, hi, noise / fabs(steep), told);
    }
    print_message("%ld hits, %ld grazes\n", hits, grazes);
    REQUIRE(hits > n / 10 && grazes > n / 100, "these are no test");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_true_slopes),  cmocka_unit_test(test_lying_slopes),
        cmocka_unit_test(test_budget),       cmocka_unit_test(test_tolerances),
        cmocka_unit_test(test_invalid),      cmocka_unit_test(test_random),
        cmocka_unit_test(test_narrow_holes), cmocka_unit_test(test_texts),
        cmocka_unit_test(test_uncertain),    cmocka_unit_test(test_in_noise),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
