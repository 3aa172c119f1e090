// SPDX-License-Identifier: MIT
/* sgt_diagnose on sequences whose law is known, and on what the library does itself. */
#include "unit.h"

#include <sagitta/diagnose.h>
#include <sagitta/surfaces.h>

enum { CAP = 2000 };
static sgt_step kept[CAP];

static void add(sgt_log *log, sgt_move move, double t, double f, double slope)
{
    sgt_step step = {.eval = log->n + 1, .move = move, .t = t, .f = f, .slope = slope, .lo = -FAR, .hi = FAR};
    assert_int_equal(sgt_log_step(log, &step), 0);
}

typedef double equation_g(double t, double *slope);

/* Bare Newton, the slope as told by `by` times the true one. */
static sgt_log newton(equation_g *g, double t, int n, double by)
{
    sgt_log log = {kept, CAP, 0};
    for (int i = 0; i < n; i++) {
        double s, f = g(t, &s);
        add(&log, i ? SGT_NEWTON : SGT_SEED, t, f, by * s);
        if (f == 0) break;
        t -= f / (by * s);
    }
    return log;
}

static double g_square(double t, double *s) { return *s = 2 * t, t * t - 2; }
static double g_double(double t, double *s) { return *s = 2 * (t - 1) * exp(t), (t - 1) * (t - 1) * exp(t); }
static double g_triple(double t, double *s)
{
    return *s = 3 * (t - 1) * (t - 1), (t - 1) * (t - 1) * (t - 1);
}
static double g_cos(double t, double *s) { return *s = -sin(t), cos(t); }
static double g_line(double t, double *s) { return *s = 3, 3 * t - 1; }
/* 0, 1, 0, 1 ... */
static double g_cycle(double t, double *s) { return *s = 3 * t * t - 2, t * t * t - 2 * t + 2; }
static double g_cube_root(double t, double *s) { return *s = 1 / (3 * cbrt(t) * cbrt(t)), cbrt(t); }

static void require_verdict(const sgt_log *log, sgt_verdict want, const char *what)
{
    sgt_diagnosis d = sgt_diagnose(log);
    REQUIRE(d.verdict == want, "%s: verdict %d (%s), %d wanted; order %g rate %g", what, (int)d.verdict,
            sgt_verdict_text(d.verdict), (int)want, d.order, d.rate);
}

static void test_quadratic(void **state)
{
    (void)state;
    static const struct {
        equation_g *g;
        double seed, rate;
    } cases[] = {{g_square, 1, 0.35355}, {g_square, 1.9, 0.35355}, {g_square, 100, 0.35355}};
    for (size_t i = 0; i < COUNT_OF(cases); i++)
        for (int n = 5; n < 14; n++) {
            sgt_log log = newton(cases[i].g, cases[i].seed, n + (cases[i].seed > 50 ? 6 : 0), 1);
            sgt_diagnosis d = sgt_diagnose(&log);
            REQUIRE(d.verdict == SGT_QUADRATIC, "case %zu, %d steps: %s", i, n, sgt_verdict_text(d.verdict));
            REQUIRE(fabs(d.order - 2) < 0.2, "case %zu, %d steps: order %g", i, n, d.order);
            REQUIRE(fabs(d.condition - 1 / (2 * sqrt(2))) < 0.01, "case %zu: condition %g", i, d.condition);
            REQUIRE(d.newton == log.n - 1 && d.bisect == 0 && d.march == 0 && d.retreat == 0,
                    "case %zu: %d Newton steps of %d", i, d.newton, log.n);
        }
    /* few steps of it: a step that gains two digits or more is as good as any */
    for (int n = 2; n < 5; n++) {
        sgt_log log = newton(g_square, 1.42, n, 1);
        require_verdict(&log, SGT_QUADRATIC, "x^2 - 2 from 1.42");
    }
    sgt_log log = newton(g_cos, 1.5, 4, 1); /* g'' = 0 at the root: cubic, and no worse for it */
    require_verdict(&log, SGT_QUADRATIC, "cos");
    log = newton(g_line, 7, 2, 1);
    require_verdict(&log, SGT_QUADRATIC, "a straight line");
}

static double g_cubic(double t, double *s) { return *s = 3 * t * t - 1, t * t * t - t - 1; }

/* From beside its turning point: to 17.9, and back by a third of what is left each time. */
static void test_late(void **state)
{
    (void)state;
    sgt_log log = newton(g_cubic, 0.6, 13, 1);
    require_verdict(&log, SGT_LATE, "a cubic from its turning point");
    REQUIRE(sgt_diagnose(&log).before >= 3 && sgt_diagnose(&log).before < log.n - 3, "%d of %d before",
            sgt_diagnose(&log).before, log.n);
    log = newton(g_cubic, 1.5, 7, 1);
    require_verdict(&log, SGT_QUADRATIC, "a cubic from near its root");
    /* NaN where a search began is of its history */
    for (int nan = 0; nan < 6; nan++) {
        sgt_log in = {kept, CAP, 0};
        for (int i = 0; i < nan; i++) add(&in, i ? SGT_RETREAT : SGT_SEED, 48 >> i, NOT, NOT);
        for (double t = 1.5, f = 1, slope; f != 0 && in.n < nan + 7; t -= f / slope)
            f = g_cubic(t, &slope), add(&in, in.n == nan ? SGT_RETREAT : SGT_NEWTON, t, f, slope);
        require_verdict(&in, nan >= 3 ? SGT_LATE : SGT_QUADRATIC, "NaN at first");
    }
}

static void test_linear(void **state)
{
    (void)state;
    static const struct { equation_g *g; const char *what; double seed, by, rate;
    } cases[] = {
        {g_double, "a double root", 1.5, 1, 0.5},
        {g_double, "a double root from the left", 0.3, 1, 0.5},
        {g_triple, "a triple root", 2, 1, 2.0 / 3},
        {g_square, "a slope twice too steep", 1, 2, 0.5},
        {g_square, "a slope five times too steep", 1, 5, 0.8},
        {g_square, "a slope a hundred times too steep", 1, 100, 0.99},
        {g_square, "a slope 3/4 of the true", 1, 0.75, 1.0 / 3},
    };
    for (size_t i = 0; i < COUNT_OF(cases); i++)
        for (int n = 10; n <= 24; n++) {
            sgt_log log = newton(cases[i].g, cases[i].seed, n, cases[i].by);
            sgt_diagnosis d = sgt_diagnose(&log);
            REQUIRE(d.verdict == SGT_LINEAR, "%s, %d steps: %s", cases[i].what, n,
                    sgt_verdict_text(d.verdict));
            REQUIRE(fabs(d.order - 1) < 0.1, "%s, %d steps: order %g", cases[i].what, n, d.order);
            /* C is per e^p: at p not quite 1 it is what carries one error to the next */
            if (fabs(d.order - 1) < 1e-3)
                REQUIRE(fabs(d.rate - cases[i].rate) < 0.03, "%s, %d steps: rate %g", cases[i].what, n,
                        d.rate);
        }
}

/* The scan lens's first surface, in t; the classic mistake scales its gradient to one. */
static double sphere(double t, double *slope, double *length)
{
    double R = -2.2136, m = 0.3420201433256687, n = 0.9396926207859084, y = 0.5 + m * t, z = -5 + n * t,
           phi = sqrt(1 - y * y / (R * R)), Fy = -y / (R * phi);
    *slope = n + Fy * m;
    *length = sqrt(1 + Fy * Fy);
    return z - y * y / R / (1 + phi);
}

static void test_oscillating(void **state)
{
    (void)state;
    static const double published[] = {4.775443550511577, 2.8626356840250526, 4.7418998688939,
                                       2.997895475725084, 4.714415826981489};
    sgt_log log = {kept, CAP, 0};
    double t = 5 / 0.9396926207859084;
    bool before = false;
    int n = 0;
    for (int i = 0; i < 1000; i++) {
        double slope, length, f = sphere(t, &slope, &length);
        add(&log, i == 0 ? SGT_SEED : before ? SGT_NEWTON : SGT_RETREAT, t, f, slope / length);
        before = !isnan(f);
        if (before) t -= f / (slope / length);
        else t *= 0.5;
        if (before && n < 5) {
            REQUIRE(fabs(t - published[n]) < 1e-12, "step %d: %.17g, published %.17g", n, t, published[n]);
            n++;
        }
        if (i >= 5) {
            REQUIRE(sgt_diagnose(&log).verdict == SGT_OSCILLATING, "after %d: %s", log.n,
                    sgt_verdict_text(sgt_diagnose(&log).verdict));
            REQUIRE(sgt_diagnose(&log).retreat == 1, "after %d: %d retreats", log.n,
                    sgt_diagnose(&log).retreat);
        }
    }
    /* the same without the moves, as a caller's own iteration may be logged */
    sgt_log bare = {kept, 5, 0};
    for (int i = 0; i < 5; i++) {
        double slope, length, f = sphere(published[i], &slope, &length);
        add(&bare, i ? SGT_NEWTON : SGT_SEED, published[i], f, slope);
    }
    require_verdict(&bare, SGT_OSCILLATING, "the published steps, the true slope beside them");
    for (int i = 4; i <= 100; i += 7) {
        log = newton(g_cycle, 0, i, 1);
        require_verdict(&log, SGT_OSCILLATING, "a cycle of two");
        log = newton(g_cube_root, 1, i, 1);
        require_verdict(&log, SGT_OSCILLATING, "a cube root: to and fro, farther each time");
    }
    log = newton(g_square, 1, 40, 0.51); /* to and fro, by 0.96 each time */
    require_verdict(&log, SGT_OSCILLATING, "a slope half the true one");
}

/* What the solver makes of an equation, step by step. */
static sgt_log solver(equation_g *g, sgt_span span, double by)
{
    sgt_log log = {kept, CAP, 0};
    sgt_root r = sgt_root_begin(span, NULL);
    double slope, f;
    do {
        f = g(r.t, &slope);
        sgt_log_step(&log, &(sgt_step){.eval = r.evals + 1,
                                       .move = r.move,
                                       .t = r.t,
                                       .f = f,
                                       .slope = by * slope,
                                       .lo = r.lo,
                                       .hi = r.hi});
    } while (sgt_root_next(&r, f, by * slope));
    return log;
}

static void test_solver(void **state)
{
    (void)state;
    sgt_log log = solver(g_square, (sgt_span){.lo = 0, .hi = 2, .seed = 1}, 1);
    require_verdict(&log, SGT_QUADRATIC, "the solver, x^2 - 2");
    log = solver(g_square, (sgt_span){.lo = 0, .hi = 2, .seed = 1}, NOT);
    require_verdict(&log, SGT_BISECTING, "the solver without a slope");
    REQUIRE(sgt_diagnose(&log).bisect > 20 && isnan(sgt_diagnose(&log).condition), "%d bisections",
            sgt_diagnose(&log).bisect);
    log = solver(g_square, (sgt_span){.lo = 0, .hi = 2, .seed = 1}, -1);
    require_verdict(&log, SGT_BISECTING, "the solver, the slope negated");
    log = solver(g_square, (sgt_span){.lo = 0, .hi = 2, .seed = sqrt(2)}, 1);
    require_verdict(&log, SGT_ROUNDING, "the solver from the root");
    log = solver(g_square, (sgt_span){.lo = 0, .hi = 2, .seed = 1.4142135623730954}, 1);
    require_verdict(&log, SGT_ROUNDING, "the solver from two ulps beside the root");
    log = solver(g_triple, (sgt_span){.lo = 0, .hi = 3, .seed = 2.5}, 1);
    sgt_verdict v = sgt_diagnose(&log).verdict;
    REQUIRE(v == SGT_LINEAR || v == SGT_BISECTING, "the solver at a triple root: %s", sgt_verdict_text(v));
}

static void test_few_and_strange(void **state)
{
    (void)state;
    sgt_log empty = {kept, CAP, 0};
    const sgt_log *nothing[] = {&empty, &(sgt_log){NULL, 0, 0}, &(sgt_log){NULL, 0, 7}, NULL};
    for (size_t i = 0; i < COUNT_OF(nothing); i++) {
        sgt_diagnosis d = sgt_diagnose(nothing[i]);
        REQUIRE(d.verdict == SGT_WANDERING && isnan(d.order) && isnan(d.rate) && isnan(d.condition) &&
                    d.newton + d.bisect + d.march + d.retreat == 0,
                "an empty log (%zu)", i);
    }
    sgt_log log = {kept, CAP, 0};
    add(&log, SGT_SEED, 1, 0.5, 0.25);
    sgt_diagnosis d = sgt_diagnose(&log);
    REQUIRE(d.verdict == SGT_WANDERING && isnan(d.order) && d.condition == 4, "one step: %s, condition %g",
            sgt_verdict_text(d.verdict), d.condition);
    log.n = 0;
    add(&log, SGT_SEED, 1, 0, 0.25);
    require_verdict(&log, SGT_ROUNDING, "one step, on the root");
    log.n = 0;
    add(&log, SGT_SEED, 1, 1e-16, 0.25);
    require_verdict(&log, SGT_ROUNDING, "one step, the next would be less than an ulp or two");
    log.n = 0;
    add(&log, SGT_SEED, 1, NOT, NOT);
    add(&log, SGT_RETREAT, 0.5, NOT, NOT);
    d = sgt_diagnose(&log);
    REQUIRE(d.verdict == SGT_WANDERING && d.retreat == 1 && isnan(d.condition), "nothing but NaN: %s",
            sgt_verdict_text(d.verdict));
    log.n = 0;
    add(&log, SGT_SEED, 1, 1, 0);
    d = sgt_diagnose(&log);
    REQUIRE(d.verdict == SGT_WANDERING && d.condition == FAR, "no slope: condition %g", d.condition);

    generator g = seeded("wandering");
    log.n = 0;
    add(&log, SGT_SEED, 0, 1, 1e-3);
    for (double t = 0, i = 0; i < 30; i++) add(&log, SGT_NEWTON, t += uniform(&g, 1, 3) * (1 + i), 1, 1e-3);
    require_verdict(&log, SGT_WANDERING, "farther and farther");

    /* any numbers at all: an answer, never a trap */
    for (long i = 0, n = scaled(20000); i < n; i++) {
        static const double odd[] = {0, -0.0, 1, -1, 1e-310, 1e300, -1e300};
        log.n = 0;
        for (int j = below(&g, 12); j > 0; j--) {
            double v[3];
            for (int k = 0; k < 3; k++)
                v[k] = chance(&g, 0.1)   ? NOT
                       : chance(&g, 0.1) ? either_sign(&g) * FAR
                       : chance(&g, 0.3) ? odd[below(&g, (int)COUNT_OF(odd))]
                                         : uniform(&g, -1, 1);
            add(&log, (sgt_move)below(&g, 6), v[0], v[1], v[2]);
        }
        d = sgt_diagnose(&log);
        REQUIRE(d.verdict >= SGT_QUADRATIC && d.verdict <= SGT_LATE, "case %ld: verdict %d", i,
                (int)d.verdict);
        REQUIRE(d.newton + d.bisect + d.march + d.retreat <= log.n, "case %ld: counts", i);
        REQUIRE(!(d.condition < 0), "case %ld: condition %g", i, d.condition);
    }
}

static void test_log(void **state)
{
    (void)state;
    sgt_step two[3] = {{0}};
    two[2].eval = 77;
    sgt_log log = {two, 2, 0};
    for (int i = 1; i <= 5; i++) assert_int_equal(sgt_log_step(&log, &(sgt_step){.eval = i, .t = i}), 0);
    assert_true(log.n == 5 && two[0].t == 1 && two[1].t == 2 && two[2].eval == 77);
    sgt_diagnose(&log); /* reads what was kept, no more */
    sgt_log counting = {NULL, 0, 0};
    assert_int_equal(sgt_log_step(&counting, &(sgt_step){.eval = 1}), 0);
    assert_int_equal(counting.n, 1);

    /* two solves in one log: the last is judged */
    log = newton(g_square, 1, 8, 1);
    int n = log.n;
    for (int i = 0; i < 40; i++) {
        double slope, t = i & 1 ? 1 : 0, f = g_cycle(t, &slope);
        sgt_log_step(
            &log,
            &(sgt_step){.eval = i + 1, .move = i ? SGT_NEWTON : SGT_SEED, .t = t, .f = f, .slope = slope});
    }
    require_verdict(&log, SGT_OSCILLATING, "two solves, the last a cycle");
    assert_int_equal(sgt_diagnose(&log).newton, 39);
    log.n = n;
    require_verdict(&log, SGT_QUADRATIC, "the first of them");
}

/* As the header shows it. */
static void test_watching(void **state)
{
    (void)state;
    sgt_conic shape = {.c = 1 / -2.2136};
    sgt_ray ray = {.o = {0, 0.5, -5}, .d = {0, 0.3420201433256687, 0.9396926207859084}};
    sgt_log log = {kept, CAP, 0};
    sgt_hit hit = sgt_intersect((sgt_surface){&sgt_conic_ops, &shape}, ray,
                                &(sgt_options){.watch = sgt_log_step, .watch_data = &log});
    assert_int_equal(hit.status, SGT_HIT);
    REQUIRE(log.n == hit.evals && log.n <= 4, "%d steps, %d evaluations", log.n, hit.evals);
    REQUIRE(kept[log.n - 1].t == hit.t, "the last step is at %.17g, the hit at %.17g", kept[log.n - 1].t,
            hit.t);
    sgt_diagnosis d = sgt_diagnose(&log);
    REQUIRE(d.verdict == SGT_ROUNDING || d.verdict == SGT_QUADRATIC, "%s", sgt_verdict_text(d.verdict));
    REQUIRE(d.condition > 0.5 && d.condition < 2, "condition %g", d.condition);
}

static void test_texts(void **state)
{
    (void)state;
    for (int i = SGT_QUADRATIC; i <= SGT_LATE; i++) {
        const char *text = sgt_verdict_text((sgt_verdict)i);
        assert_true(text && strlen(text) > 10 && strlen(text) < 160 && !strchr(text, '\n'));
        for (int j = SGT_QUADRATIC; j < i; j++)
            assert_string_not_equal(text, sgt_verdict_text((sgt_verdict)j));
    }
    assert_string_equal(sgt_verdict_text((sgt_verdict)99), "?");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_quadratic),       cmocka_unit_test(test_linear),
        cmocka_unit_test(test_late),
        cmocka_unit_test(test_oscillating),     cmocka_unit_test(test_solver),
        cmocka_unit_test(test_few_and_strange), cmocka_unit_test(test_log),
        cmocka_unit_test(test_watching),        cmocka_unit_test(test_texts),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
