// SPDX-License-Identifier: MIT
/* src/surface/formula/enclose_lanes.c against interval.h, on random formulas, rays and cells.
 *
 *     test_enclose_lanes       SAGITTA_TEST_SCALE multiplies the random cases, SAGITTA_TEST_SEED
 *
 * The value of F at a point of the cell is worked out by interval.h (sgt_formula_jet of a point, whose
 * intervals test_interval.cpp and test_functions.c hold to MPFR).  It shares no arithmetic with lanes.
 *   - It meets the value over the cell.  If that is empty, F is undefined at the point.
 *   - A slope with two finite ends says that F is defined at each point, and by the mean value theorem
 *     F(t) - F(s) meets the slope times t - s: a jump, a pole or a slope too small breaks that.
 *   - The derivative at a point meets the slope, wherever F is smooth.
 *   - The bits are those of one cell by itself, in each set of instructions, with or without slopes.
 * How often a slope has ends where that of interval.h over the cell has, and how much wider it is, is printed
 * and has a limit: all numbers would pass the rest. */
#include "random_bits.h"

#include <sagitta/formula.h>
#include <sagitta/interval.h>

#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

/* The functions of the room, of each set.  (v4 has those of v3: narrow_files in src/meson.build.) */
typedef void encloses(const sgt_tape *tape, size_t n, sgt_rays rays, const double *t_lo, const double *t_hi,
                      sgt_enclosures out);
extern encloses sgt_formula_encloses_base, sgt_formula_encloses_v3;
typedef struct formula_jet { sgt_interval f, u, v, uv; bool whole; } formula_jet;
formula_jet sgt_formula_jet_base(const sgt_tape *tape, const sgt_interval at[3], sgt_interval r,
                                 const sgt_interval du[3], const sgt_interval dv[3], bool second);

static int faults;
static const double inf = HUGE_VAL;

static double uniform(double lo, double hi)
{
    return lo + (hi - lo) * ldexp((double)(random_bits() >> 11), -53);
}

static int below(int n) { return (int)(random_bits() % (uint64_t)n); }

/* ------------------------------------------------------------------------ formulas */

enum { LONGEST = 4000 };
static char text[LONGEST];
static size_t length;

#ifdef __GNUC__
__attribute__((format(printf, 1, 2)))
#endif
static void put(const char *words, ...)
{
    va_list list;
    va_start(list, words);
    if (length < LONGEST) length += (size_t)vsnprintf(text + length, LONGEST - length, words, list);
    va_end(list);
}

static void leaf(void)
{
    switch (below(9)) {
    case 0: put("%d", 1 + below(5)); return;
    case 1: put("%.17g", uniform(-2, 2)); return; /* also after a minus */
    case 2: put(below(3) == 0 ? "pi" : "p"); return;
    case 3: put("r"); return;
    default: put("%c", "xyz"[below(3)]);
    }
}

static void grow(int depth)
{
    static const char *const functions[] = {"sqrt", "cbrt", "exp",  "log",  "sin",  "cos",
                                            "tan",  "asin", "acos", "atan", "sinh", "cosh",
                                            "tanh", "abs",  "sqrt", "sin",  "cos",  "abs"};
    static const char *const pairs[] = {"min", "max", "hypot", "atan2"};
    static const char *const exponents[] = {"2",    "2",   "3",   "4",      "5", "8",    "(-1)", "(-2)",
                                            "(-3)", "0.5", "1.5", "(-0.5)", "p", "(-p)", "1"};
    if (depth == 0) {
        leaf();
        return;
    }
    int what = below(20), less = depth > 2 ? depth - 2 : 0;
    put("(");
    if (what < 10) {
        grow(depth - 1), put("%c", "+-*+-*/"[below(7)]), put("("), grow(depth - 1), put(")");
    } else if (what < 13) {
        grow(depth - 1), put("^%s", exponents[below(15)]);
    } else if (what < 17) {
        put("%s(", functions[below(18)]), grow(depth - 1), put(")");
    } else if (what < 19) {
        put("%s(", pairs[below(4)]), grow(depth - 1), put(","), grow(depth - 1), put(")");
    } else {
        put("("), grow(less), put(")^("), grow(less), put(")");
    }
    put(")");
}

static sgt_tape *tape_of(const char *words, double p)
{
    static void *room;
    sgt_named parameter = {"p", p};
    size_t size = sgt_formula_room(words, 1);
    free(room);
    room = malloc(size);
    return room ? sgt_formula_read(words, SGT_FORMULA_XYZ, 1, &parameter, room, size, NULL) : NULL;
}

/* --------------------------------------------------------------------------- cells */

enum { MOST = 40 };
typedef struct batch {
    double o[3][MOST], d[3][MOST], lo[MOST], hi[MOST];
} batch;
typedef struct answers { double g_lo[MOST], g_hi[MOST], slope_lo[MOST], slope_hi[MOST]; } answers;

static sgt_rays rays_of(const batch *b, size_t from)
{
    return (sgt_rays){.o = {b->o[0] + from, b->o[1] + from, b->o[2] + from},
                      .d = {b->d[0] + from, b->d[1] + from, b->d[2] + from}};
}

static double number(void)
{
    static const double odd[] = {0, -0.0, 1, -1, 0.5, 1e300, 1e-300, 0x1p-1074, -1e308, 1e160};
    int what = below(40);
    return what == 0 ? odd[below(10)] : what < 5 ? (double)(below(9) - 4) / 2 : uniform(-2, 2);
}

static void any_cell(batch *b, int i)
{
    for (int k = 0; k < 3; k++) b->o[k][i] = number(), b->d[k][i] = number();
    b->lo[i] = number();
    b->hi[i] = b->lo[i] + (below(8) == 0 ? 0 : ldexp(uniform(0, 1), -below(below(2) ? 4 : 50)));
}

/* What no search asks; nothing is promised of it but that its neighbours do not see it. */
static void poisoned_cell(batch *b, int i)
{
    any_cell(b, i);
    double bad = below(2) ? (double)NAN : inf;
    *(below(2) ? &b->lo[i] : below(2) ? &b->o[below(3)][i] : &b->d[below(3)][i]) = bad;
}

static bool same(double a, double b) { return memcmp(&a, &b, sizeof a) == 0; }

static void compare(const char *what, const answers *a, size_t i, const answers *b, size_t j, bool slopes)
{
    bool equal = same(a->g_lo[i], b->g_lo[j]) && same(a->g_hi[i], b->g_hi[j]);
    if (slopes) equal = equal && same(a->slope_lo[i], b->slope_lo[j]) && same(a->slope_hi[i], b->slope_hi[j]);
    if (equal) return;
    if (faults++ < 30)
        printf("%s: %s, lane %zu: [%a, %a] and [%a, %a]; [%a, %a] and [%a, %a]\n", text, what, i, a->g_lo[i],
               a->g_hi[i], b->g_lo[j], b->g_hi[j], a->slope_lo[i], a->slope_hi[i], b->slope_lo[j],
               b->slope_hi[j]);
}

static void ask(encloses *f, const sgt_tape *tape, const batch *b, size_t from, size_t n, bool slopes,
                answers *y)
{
    f(tape, n, rays_of(b, from), b->lo + from, b->hi + from,
      (sgt_enclosures){y->g_lo, y->g_hi, slopes ? y->slope_lo : NULL, slopes ? y->slope_hi : NULL});
}

/* ----------------------------------------------------------------------- interval.h */

static formula_jet jet_at(const sgt_tape *tape, const batch *b, int i, sgt_interval t)
{
    sgt_interval at[3], d[3];
    for (int k = 0; k < 3; k++) {
        d[k] = sgt_interval_of(b->d[k][i]);
        at[k] = sgt_interval_sum(sgt_interval_of(b->o[k][i]), sgt_interval_product(d[k], t));
    }
    return sgt_formula_jet_base(tape, at, sgt_interval_hypotenuse(at[0], at[1]), d, d, false);
}

static bool is_finite(sgt_interval x) { return fabs(x.lo) <= DBL_MAX && fabs(x.hi) <= DBL_MAX; }
static bool meets(sgt_interval x, sgt_interval y) { return !(x.lo > y.hi) && !(y.lo > x.hi); }

static struct tally {
    long cells, empty, undefined, bounded, not_bounded, points, pairs, both, values, slopes;
} sum;

static void fault(const batch *b, int i, double t, const char *what, sgt_interval cell, sgt_interval point)
{
    if (faults++ >= 30) return;
    printf("%s, o %a %a %a, d %a %a %a, t [%a, %a]: %s at %a: [%a, %a] and [%a, %a]\n", text, b->o[0][i],
           b->o[1][i], b->o[2][i], b->d[0][i], b->d[1][i], b->d[2][i], b->lo[i], b->hi[i], what, t, cell.lo,
           cell.hi, point.lo, point.hi);
}

/* Cell i holds what is promised. */
static void judge(const sgt_tape *tape, const batch *b, int i, const answers *y)
{
    enum { POINTS = 5 };
    sgt_interval g = {y->g_lo[i], y->g_hi[i]}, s = {y->slope_lo[i], y->slope_hi[i]}, f[POINTS];
    bool empty = g.lo > g.hi, bounded = is_finite(s);
    double t[POINTS];
    sum.cells++, sum.empty += empty, sum.bounded += bounded;
    if (isnan(g.lo) || isnan(g.hi) || isnan(s.lo) || isnan(s.hi)) fault(b, i, 0, "a NaN", g, s);
    if (empty && bounded) fault(b, i, 0, "empty, with a slope", g, s);
    for (int k = 0; k < POINTS; k++) {
        t[k] = k == 0 ? b->lo[i] : k == 1 ? b->hi[i] : uniform(b->lo[i], b->hi[i]);
        t[k] = fmin(fmax(t[k], b->lo[i]), b->hi[i]);
        formula_jet at = jet_at(tape, b, i, sgt_interval_of(t[k]));
        f[k] = at.f;
        bool undefined = at.f.lo > at.f.hi;
        sum.points++, sum.undefined += undefined;
        if (bounded && undefined) fault(b, i, t[k], "a slope, and undefined", s, at.f);
        if (undefined) continue;
        if (empty && at.whole) fault(b, i, t[k], "empty, and defined", g, at.f);
        if (!empty && !meets(g, at.f)) fault(b, i, t[k], "the value", g, at.f);
        bool steep = bounded && at.whole && is_finite(at.u);
        if (steep && !meets(s, at.u)) fault(b, i, t[k], "the slope", s, at.u);
    }
    for (int k = 1; bounded && k < POINTS; k++) {
        if (!is_finite(f[k]) || !is_finite(f[k - 1])) continue;
        sgt_interval by = sgt_interval_difference(sgt_interval_of(t[k]), sgt_interval_of(t[k - 1]));
        sgt_interval rise = sgt_interval_difference(f[k], f[k - 1]);
        sum.pairs++;
        if (!meets(sgt_interval_product(s, by), rise))
            fault(b, i, t[k], "the mean value theorem", sgt_interval_product(s, by), rise);
    }
    /* how wide they are */
    formula_jet over = jet_at(tape, b, i, sgt_interval_between(b->lo[i], b->hi[i]));
    bool tight = is_finite(over.u) && is_finite(over.f) && sgt_interval_greatest(over.u) < 1e100;
    if (tight && !bounded) sum.not_bounded++;
    double size = sgt_interval_greatest(over.f) + 1, steep = sgt_interval_greatest(over.u) + size;
    if (tight && bounded && !empty) {
        sum.both++;
        sum.values += g.hi - g.lo > 1.01 * (over.f.hi - over.f.lo) + 1e-12 * size;
        sum.slopes += s.hi - s.lo > 1.01 * (over.u.hi - over.u.lo) + 1e-11 * steep;
    }
}

static void look(const sgt_tape *tape, bool special)
{
    batch b;
    answers y, one, values;
    bool poisoned[MOST];
    size_t n = (size_t)(1 + below(MOST)), first = (size_t)below((int)n);
    for (int i = 0; i < MOST; i++) {
        poisoned[i] = !special && below(6) == 0;
        if (poisoned[i]) poisoned_cell(&b, i);
        else any_cell(&b, i);
    }
    ask(sgt_formula_encloses_base, tape, &b, 0, n, true, &y);
    for (size_t i = 0; i < n; i++)
        if (!poisoned[i]) judge(tape, &b, (int)i, &y);
    ask(sgt_formula_encloses_base, tape, &b, 0, n, false, &values);
    for (size_t i = 0; i < n; i++) compare("without slopes", &y, i, &values, i, false);
    ask(sgt_formula_encloses_base, tape, &b, first, 1, true, &one);
    compare("by itself", &y, first, &one, 0, true);
#if LANE_SETS > 1
    if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) {
        ask(sgt_formula_encloses_v3, tape, &b, 0, n, true, &one);
        for (size_t i = 0; i < n; i++) compare("v3", &y, i, &one, i, true);
    }
#endif
}

/* One cell on the line (t, 0.5, 0.25), or (t, 0, 0). */
static void require(const char *words, double y, double lo, double hi, bool empty, bool bounded)
{
    batch b = {.o = {{0}, {y}, {y / 2}}, .d = {{1}, {0}, {0}}, .lo = {lo}, .hi = {hi}};
    answers a;
    sgt_tape *tape = tape_of(words, 1.5);
    snprintf(text, sizeof text, "%s", words);
    if (!tape) {
        faults++, printf("%s is not read\n", words);
        return;
    }
    ask(sgt_formula_encloses_base, tape, &b, 0, 1, true, &a);
    bool is_empty = a.g_lo[0] > a.g_hi[0];
    bool is_bounded = is_finite(sgt_interval_between(a.slope_lo[0], a.slope_hi[0]));
    if (is_empty == empty && is_bounded == bounded) {
        judge(tape, &b, 0, &a);
        return;
    }
    faults++;
    printf("%s over [%g, %g]: value [%g, %g], slope [%g, %g]\n", words, lo, hi, a.g_lo[0], a.g_hi[0],
           a.slope_lo[0], a.slope_hi[0]);
}

static void require_known_cases(void)
{
    require("sqrt(x)", 0.5, 1, 2, false, true);
    require("sqrt(x)", 0.5, -1, 2, false, false);
    require("sqrt(x)", 0.5, 0, 2, false, false);
    require("sqrt(x)", 0.5, -2, -1, true, false);
    require("1 + 2*sqrt(x)*y", 0.5, -2, -1, true, false);
    require("log(x)", 0.5, -2, -0.1, true, false);
    require("log(x)", 0.5, -2, 1, false, false);
    require("log(x)", 0.5, 0.1, 1, false, true);
    require("asin(x)", 0.5, 1.5, 2, true, false);
    require("acos(x)", 0.5, -3, -1.5, true, false);
    require("asin(x)", 0.5, 0.5, 2, false, false);
    require("acos(x)", 0.5, -0.5, 0.5, false, true);
    require("tan(x)", 0.5, -1.5, 1.5, false, true);
    require("tan(x)", 0.5, 1.5, 1.6, false, false);
    require("tan(x)", 0.5, 1.5, 4, false, false);
    require("1/x", 0.5, -1, 1, false, false);
    require("1/x", 0.5, 1, 2, false, true);
    require("x^(-2)", 0.5, -1, 1, false, false);
    require("x^0.5", 0.5, -2, -1, true, false);
    require("x^1.5", 0.5, 0.1, 1, false, true);
    require("abs(x)^p", 0.5, -1, 1, false, true);
    require("abs(x)^0.5", 0.5, -1, 1, false, false);
    require("x^1.5", 0.5, -1, 1, false, false);
    require("x^p", 0.5, 0.1, 1, false, true);
    require("x^p", 0.5, -2, -1, true, false);
    require("x^(-p)", 0.5, -2, -0.1, true, false);
    require("x^(-p)", 0.5, -2, 2, false, false);
    require("x^y", 0.5, 1, 2, false, true);
    require("x^y", 0.5, -2, -1, true, false);
    require("atan2(y,x)", 0.5, -1, 1, false, true);
    require("atan2(y,x)", 0, -1, -0.5, false, false);
    require("atan2(y,x)", 0, 0.5, 1, false, true);
    require("atan2(y,x)", 0, -1, 1, false, false);
    require("atan2(x,y)", 0, -1, 1, false, false);
    require("abs(x)", 0.5, -1, 1, false, true);
    require("min(x,y)", 0.5, -1, 1, false, true);
    require("max(x,-x)", 0.5, -1, 1, false, true);
    require("hypot(x,y)", 0, -1, 1, false, true);
    require("r", 0, -1, 1, false, true);
    require("cbrt(x)", 0.5, -1, 1, false, false);
    require("sin(1000000000000*x)", 0.5, 1, 2, false, true);
    require("min(x, sqrt(x - 5))", 0.5, 1, 2, true, false);
    require("exp(1000*x)", 0.5, 1, 2, false, false);
    require("tanh(exp(1000*x))", 0.5, 1, 2, false, false);
    require("x", 0.5, 1, 2, false, true);
    require("exp(1000*p)*x", 0.5, 1, 2, false, false);
}

int main(void)
{
    static const char *const known[] = {
        "4*((2.618033988749895*x^2-y^2)*(2.618033988749895*y^2-z^2)*(2.618033988749895*z^2-x^2))"
        "-4.23606797749979*(x^2+y^2+z^2-1)^2",
        "81*(x^3+y^3+z^3)-189*(x^2*(y+z)+y^2*(x+z)+z^2*(x+y))+54*(x*y*z)+126*(x*y+x*z+y*z)-9*(x^2+y^2+z^2)"
        "-9*(x+y+z)+1",
        "2*(2*(2*x^2-1)^2-1)^2+2*(2*(2*y^2-1)^2-1)^2+2*(2*(2*z^2-1)^2-1)^2-2",
        "sin(6*x)*cos(6*y)+sin(6*y)*cos(6*z)+sin(6*z)*cos(6*x)",
        "abs(x)^2.5 + abs(y)^2.5 + abs(z)^2.5 - 1", "(x^2+9/4*y^2+z^2-1)^3-x^2*z^3-9/80*y^2*z^3"};
    const char *seed = getenv("SAGITTA_TEST_SEED"), *scale = getenv("SAGITTA_TEST_SCALE");
    state = seed ? strtoull(seed, NULL, 0) : 1;
    printf("SAGITTA_TEST_SEED=%" PRIu64 "\n", state);
    long n = (long)(10000 * (scale ? atof(scale) : 0.5)), read = 0;
    require_known_cases();
    for (long i = 0; i < n; i++) {
        length = 0;
        if (i % 10 == 0) put("%s", known[below(6)]);
        else grow(1 + below(5));
        if (length >= LONGEST) continue;
        double parameter = below(2) ? (double)(below(9) - 4) : uniform(-3, 3);
        sgt_tape *tape = tape_of(text, parameter);
        if (!tape) continue; /* a number that is not defined, or no variable */
        read++;
        look(tape, i % 10 == 0);
    }
    printf("%ld formulas, %ld cells: %ld empty, %ld with a slope; %ld more have one by interval.h\n", read,
           sum.cells, sum.empty, sum.bounded, sum.not_bounded);
    printf("%ld points, %ld undefined; %ld pairs of points\n", sum.points, sum.undefined, sum.pairs);
    printf("wider by 1 %% than interval.h: %ld values, %ld slopes, of %ld\n", sum.values, sum.slopes,
           sum.both);
    if (!(read > n / 2 && sum.empty > sum.cells / 50 && sum.bounded > sum.cells / 4
          && sum.undefined > sum.points / 50))
        faults++, printf("too few of a kind\n");
    if (!(sum.not_bounded < sum.bounded / 50 && sum.values < sum.both / 100 && sum.slopes < sum.both / 10))
        faults++, printf("too wide\n");
    printf("%d faults\n", faults);
    return faults != 0;
}
