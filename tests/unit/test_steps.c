// SPDX-License-Identifier: MIT
/* What a watcher is told is so: at a point F and its slope, as `value` gives them there; over a cell bounds
 * that contain what samples of `value` show.  Every type of surface, formulas with what they offer taken away
 * one by one, each pick and proof, one ray and batches, the first root and all roots, and a trace. */
#include "unit.h"

#include <sagitta/formula.h>
#include <sagitta/surfaces.h>
#include <sagitta/system.h>

enum { LARGEST = 4096, SAMPLES = 9 };

/* A ray under a watcher. */
typedef struct watching {
    sgt_surface s;
    sgt_ray ray;
    const char *what;
    long points, cells, calls;
} watching;

static sgt_vec3 along(const sgt_ray *ray, double t)
{
    sgt_vec3 o = ray->o, d = ray->d;
    return (sgt_vec3){(double)(o.x + (long double)t * d.x), (double)(o.y + (long double)t * d.y),
                      (double)(o.z + (long double)t * d.z)};
}

static double absolute(sgt_vec3 v) { return sqrt(v.x * v.x + v.y * v.y + v.z * v.z); }

/* What rounding of the point may hide of F and of its slope there. */
typedef struct seen { double f, slope, f_err, slope_err; } seen;

static seen seen_at(const watching *w, double t)
{
    sgt_vec3 p = along(&w->ray, t), n = {0, 0, 0}, d = w->ray.d, o = w->ray.o;
    seen e = {.f = w->s.ops->value(w->s.self, p, &n)};
    e.slope = n.x * d.x + n.y * d.y + n.z * d.z;
    double own = w->s.ops->rounding ? w->s.ops->rounding(w->s.self, p) : 0;
    double place = fabs(n.x) * (fabs(o.x) + fabs(t * d.x)) + fabs(n.y) * (fabs(o.y) + fabs(t * d.y)) +
                   fabs(n.z) * (fabs(o.z) + fabs(t * d.z));
    e.f_err = 4 * own + 0x1p-48 * (place + fabs(e.f)) + 1e-300;
    e.slope_err = 1e-9 * (fabs(n.x * d.x) + fabs(n.y * d.y) + fabs(n.z * d.z)) + 1e-300;
    return e;
}

#define ABOUT "%s, ray %.17g %.17g %.17g %.17g %.17g %.17g, %s %d at t = %.17g [%.17g, %.17g]: "
#define ABOUT_OF w->what, w->ray.o.x, w->ray.o.y, w->ray.o.z, w->ray.d.x, w->ray.d.y, w->ray.d.z, \
                 sgt_move_text(s->move), s->eval, s->t, s->lo, s->hi

/* Between the t that is told and that where F was evaluated (sgt_step), and the rounding of points here. */
static double rounding_of_t(const watching *w, const sgt_step *s)
{
    const sgt_surface_ops *ops = w->s.ops;
    const sgt_ray *r = &w->ray;
    double nearest = absolute(r->o) / absolute(r->d);
    double seed = ops->span ? ops->span(w->s.self, r).seed : 0, most = fmax(fabs(s->t), nearest);
    /* the last: in a trace, on a sag */
    const double places[] = {s->lo, s->hi, r->tmin, r->tmax, seed, r->o.z / r->d.z};
    for (size_t i = 0; i < COUNT_OF(places); i++)
        if (fabs(places[i]) < FAR) most = fmax(most, fabs(places[i]));
    return 0x1p-50 * most;
}

static void require_point(const watching *w, const sgt_step *s)
{
    double least = FAR, most = -FAR, least_slope = FAR, most_slope = -FAR, err = 0, slope_err = 0, step;
    bool undefined = false;
    step = rounding_of_t(w, s);
    /* the last point of a hit is told as the answer has it, and F takes f within lo ... hi */
    if (s->hi - s->lo <= 1e-6) step += s->hi - s->lo;
    /* near the point, too: far from it a function may not be defined */
    const double near = 0x1p-50 * (fabs(s->t) + absolute(w->ray.o));
    for (int i = -8; i <= 8; i++) {
        seen e = seen_at(w, s->t + (i % 2 ? 0.125 * i * near : 0.125 * i * step));
        if (!(fabs(e.f) < FAR)) undefined = true;
        if (!(fabs(e.f) < FAR)) continue;
        least = fmin(least, e.f), most = fmax(most, e.f), err = fmax(err, e.f_err);
        least_slope = fmin(least_slope, e.slope), most_slope = fmax(most_slope, e.slope);
        slope_err = fmax(slope_err, e.slope_err);
    }
    if (!(fabs(s->f) < FAR)) {
        REQUIRE(undefined || fabs(least) > 1e6, ABOUT "f is %g, F is %.17g", ABOUT_OF, s->f, least);
        return;
    }
    if (fabs(s->f) > 1e6 || fabs(s->slope) > 1e9) return; /* beside a pole, where rounding of t is all */
    REQUIRE(least <= most, ABOUT "f is %.17g, and F is not defined", ABOUT_OF, s->f);
    REQUIRE(s->f >= least - err && s->f <= most + err, ABOUT "f is %.17g, and F %.17g ... %.17g +- %.3g",
            ABOUT_OF, s->f, least, most, err);
    double room = slope_err + 4 * (most_slope - least_slope);
    REQUIRE(s->slope >= least_slope - room && s->slope <= most_slope + room,
            ABOUT "slope is %.17g, and that of F %.17g ... %.17g", ABOUT_OF, s->slope, least_slope,
            most_slope);
    REQUIRE(s->f == s->f_lo && s->f == s->f_hi && s->slope == s->slope_lo && s->slope == s->slope_hi,
            ABOUT "bounds %.17g ... %.17g of a point", ABOUT_OF, s->f_lo, s->f_hi);
}

/* Does F or its slope take a value of lo ... hi within blur of t?  Beside a pole samples do not show it. */
static bool takes(const watching *w, double t, double blur, bool slope, double lo, double hi)
{
    double least = FAR, most = -FAR;
    for (int i = -8; i <= 8; i++) {
        seen e = seen_at(w, t + i * blur / 8);
        double x = slope ? e.slope : e.f;
        if (!(fabs(x) < 1e6)) return true;
        least = fmin(least, x), most = fmax(most, x);
    }
    return least <= hi && most >= lo;
}

static void require_cell(const watching *w, const sgt_step *s)
{
    REQUIRE(s->lo <= s->hi && s->lo <= s->t && s->t <= s->hi, ABOUT "the ends of the cell", ABOUT_OF);
    REQUIRE(isnan(s->f) && isnan(s->slope), ABOUT "f is %.17g over a cell", ABOUT_OF, s->f);
    REQUIRE(isnan(s->f_lo) == isnan(s->f_hi) && !(s->f_lo > s->f_hi) && !(s->slope_lo > s->slope_hi),
            ABOUT "bounds of F %.17g ... %.17g", ABOUT_OF, s->f_lo, s->f_hi);
    const double blur = rounding_of_t(w, s);
    for (int i = 0; i < SAMPLES; i++) {
        double from = i / (double)(SAMPLES - 1), t = (1 - from) * s->lo + from * s->hi;
        if (!(fabs(t) < 1e100)) continue;
        seen e = seen_at(w, t);
        if (!(fabs(e.f) < FAR)) continue;
        const bool at_end = t - s->lo < blur || s->hi - t < blur;
        const bool inside = e.f >= s->f_lo - e.f_err && e.f <= s->f_hi + e.f_err;
        REQUIRE(inside || (at_end && takes(w, t, blur, false, s->f_lo - e.f_err, s->f_hi + e.f_err)),
                ABOUT "F is %.17g at %.17g, and its bounds %.17g ... %.17g", ABOUT_OF, e.f, t, s->f_lo,
                s->f_hi);
        if (isnan(s->slope_lo) || !(fabs(e.slope) < FAR)) continue;
        double out = fmax(s->slope_lo - e.slope, e.slope - s->slope_hi) - e.slope_err;
        if (!(out > 0)) continue;
        REQUIRE(at_end && takes(w, t, blur, true, s->slope_lo, s->slope_hi),
                ABOUT "the slope is %.17g at %.17g, and its bounds %.17g ... %.17g", ABOUT_OF, e.slope, t,
                s->slope_lo, s->slope_hi);
    }
}

static int look(void *data, const sgt_step *s)
{
    watching *w = data;
    REQUIRE(s->kind == SGT_AT_POINT || s->kind == SGT_OVER_CELL, "%s: kind %d", w->what, (int)s->kind);
    for (int i = 0; i < 4; i++) REQUIRE(s->reserved_[i] == 0, "%s: reserved", w->what);
    if (s->kind == SGT_AT_POINT) require_point(w, s), w->points++;
    else require_cell(w, s), w->cells++;
    return ++w->calls >= 1000; /* all roots of a formula without a span may take 2^18 */
}

typedef struct stopping { int calls, at; } stopping;

static int stop_at(void *data, const sgt_step *s)
{
    stopping *w = data;
    (void)s;
    return ++w->calls >= w->at;
}

/* A search that its watcher stops, at one of `evals` evaluations, asks for none more and says so. */
static void stop_ray(const watching *w, sgt_options o, int evals)
{
    sgt_hit hits[8];
    for (int at = 1; at <= evals; at += at < 3 || at + 4 > evals ? 1 : evals / 7 + 1) {
        stopping s = {0, at};
        o.watch = stop_at, o.watch_data = &s;
        sgt_hit hit = sgt_intersect(w->s, w->ray, &o);
        const sgt_ray *r = &w->ray;
        REQUIRE(s.calls == at && hit.evals == at && hit.status == SGT_STOPPED,
                "%s, ray (%a, %a, %a) + t (%a, %a, %a), %a ... %a, pick %d, proof %d: stopped at %d of %d, "
                "and asked %d times: %s", w->what, r->o.x, r->o.y, r->o.z, r->d.x, r->d.y, r->d.z, r->tmin,
                r->tmax, (int)o.pick, (int)o.proof, at, evals, s.calls, sgt_status_text(hit.status));
        s.calls = 0;
        int n = sgt_intersect_all(w->s, w->ray, 8, hits, &o);
        REQUIRE(s.calls <= at, "%s: stopped at %d, and asked %d times for all roots", w->what, at, s.calls);
        if (s.calls == at && n > 0 && n <= 8)
            REQUIRE(hits[n - 1].status == SGT_STOPPED, "%s: all roots stopped, and the last is %s", w->what,
                    sgt_status_text(hits[n - 1].status));
    }
}

/* One ray in every way. */
static void watch_ray(watching *w)
{
    sgt_hit hits[8];
    for (int i = 0; i < 24; i++) {
        sgt_options o = {.pick = (sgt_pick)(i % 3), .proof = (sgt_proof)(i / 3 % 3),
                         .t_tol = i < 9 ? 0 : 1e-6,
                         .dt_min = i >= 18 ? 0.01 : 0, .max_evals = 200,
                         .watch = look, .watch_data = w};
        w->calls = 0;
        sgt_hit hit = sgt_intersect(w->s, w->ray, &o);
        REQUIRE(hit.evals == w->calls, "%s: %d evaluations, and %ld were told", w->what, hit.evals, w->calls);
        stop_ray(w, o, hit.evals);
        if (i % 3 == 0) sgt_intersect_all(w->s, w->ray, 8, hits, &o);
    }
    sgt_options o = {.watch = look, .watch_data = w};
    sgt_element e = {.surface = w->s, .index = 1, .semi_diameter = 3};
    sgt_passage passage;
    sgt_fate fate;
    if (fabs(absolute(w->ray.d) - 1) < 0x1p-40) sgt_trace(1, &e, 1, &w->ray, &passage, &fate, &o);
    sgt_status status;
    sgt_ray *r = &w->ray;
    sgt_rays one = {{&r->o.x, &r->o.y, &r->o.z}, {&r->d.x, &r->d.y, &r->d.z}, &r->tmin, &r->tmax};
    sgt_intersect_batch(w->s, 1, one, (sgt_hits){.status = &status}, &o);
}

static sgt_ray random_ray(generator *g)
{
    sgt_ray ray = {.tmax = chance(g, 0.5) ? FAR : uniform(g, 0, 20), .d = random_direction(g)};
    sgt_vec3 at = random_point(g, chance(g, 0.8) ? 2 : 6);
    double back = chance(g, 0.1) ? log_uniform(g, 10, 1e7) : uniform(g, 0, 10);
    if (chance(g, 0.5)) ray.d = (sgt_vec3){0.1 * ray.d.x, 0.1 * ray.d.y, ray.d.z};
    ray.o = (sgt_vec3){at.x - back * ray.d.x, at.y - back * ray.d.y, at.z - back * ray.d.z};
    if (ray.tmax < FAR) ray.tmax += back;
    if (chance(g, 0.2)) ray.tmin = chance(g, 0.5) ? -FAR : uniform(g, -5, ray.tmax < FAR ? ray.tmax : 5);
    return ray;
}

static void watch_rays(generator *g, sgt_surface s, const char *what, long n)
{
    watching w = {.s = s, .what = what};
    for (long i = 0; i < n; i++) {
        w.ray = random_ray(g);
        watch_ray(&w);
    }
    printf("%-40s %7ld points, %7ld cells\n", what, w.points, w.cells);
}

static void test_builtins(void **state)
{
    (void)state;
    generator g = seeded("built-in surfaces");
    for (const sgt_builtin *row = sgt_builtins(); row->type; row++) {
        static double with[LARGEST / sizeof(double)];
        memcpy(with, row->specimen, row->size);
        if (row->prepare) row->prepare(with);
        watch_rays(&g, (sgt_surface){row->ops, with}, row->type,
                   scaled(row->family == SGT_FAMILY_LEVEL_SET ? 5 : 12));
        sgt_surface_ops users = *row->ops;
        users.own_ = NULL;
        watch_rays(&g, (sgt_surface){&users, with}, "  as a user's", scaled(5));
    }
    /* without a rim, and steep */
    sgt_even_asphere steep = {.c = -0.4, .k = 0.7, .a = {0.01, -2e-3, 1e-4, -3e-5}};
    watch_rays(&g, (sgt_surface){&sgt_even_asphere_ops, &steep}, "a steep asphere without a rim",
               scaled(100));
}

static void test_formulas(void **state)
{
    static const struct { const char *text; bool sag; } formulas[] = {
        {"z^2 - 2", 0}, {"z^3 - z - 1", 0}, {"x^4 + y^4 + z^4 = 4", 0},
        {"sin(x)*cos(y) + sin(y)*cos(z) + sin(z)*cos(x)", 0}, {"max(abs(x), max(abs(y), abs(z))) - 1", 0},
        {"x*y*z - 0.2/(x^2 + y^2 + 0.1)", 0}, {"sqrt(x^2 + y^2) - 1 + z", 0},
        {"1/z - x", 0}, {"log(z) - y", 0}, {"0.1*(x^2 + y^2)", 1}, {"0.2*sin(3*x) + 0.05*y^2", 1},
        {"0.1*x^2/(1 + sqrt(1 - 0.05*(x^2 + y^2)))", 1},
    };
    (void)state;
    generator g = seeded("formulas");
    for (size_t i = 0; i < COUNT_OF(formulas); i++) {
        static double room[4096];
        sgt_error error;
        const char *text = formulas[i].text;
        sgt_formula_kind kind = formulas[i].sag ? SGT_FORMULA_XY : SGT_FORMULA_XYZ;
        sgt_tape *tape = sgt_formula_read(text, kind, 0, NULL, room, sizeof room, &error);
        REQUIRE(tape, "%s cannot be read", text);
        sgt_formula f = {.tape = tape};
        sgt_formula_sag sag = {.tape = tape, .semi_diameter = 3};
        sgt_formula_sag open = {.tape = tape};
        if (formulas[i].sag) {
            watch_rays(&g, (sgt_surface){&sgt_formula_sag_ops, &sag}, text, scaled(8));
            watch_rays(&g, (sgt_surface){&sgt_formula_sag_ops, &open}, text, scaled(8));
            continue;
        }
        watch_rays(&g, (sgt_surface){&sgt_formula_ops, &f}, text, scaled(8));
        /* as a user's surface: with all but `encloses`, without a clearance, with `value` alone */
        sgt_surface_ops ops = sgt_formula_ops;
        ops.own_ = NULL, ops.encloses = NULL;
        watch_rays(&g, (sgt_surface){&ops, &f}, "  without encloses", scaled(8));
        ops.rounding = NULL;
        watch_rays(&g, (sgt_surface){&ops, &f}, "  without rounding", scaled(8));
        ops = (sgt_surface_ops){.value = sgt_formula_ops.value, .name = "by value"};
        watch_rays(&g, (sgt_surface){&ops, &f}, "  value alone", scaled(3));
        ops.rounding = sgt_formula_ops.rounding, ops.span = sgt_formula_ops.span;
        watch_rays(&g, (sgt_surface){&ops, &f}, "  value, rounding and span", scaled(3));
    }
}

/* A ball, whose distance is known. */
static double ball(const void *self, sgt_vec3 p, sgt_vec3 *grad)
{
    (void)self;
    double r = sqrt(p.x * p.x + p.y * p.y + p.z * p.z);
    if (grad) *grad = (sgt_vec3){p.x / r, p.y / r, p.z / r};
    return r - 1.5;
}
static double ball_clearance(const void *self, sgt_vec3 p) { return fabs(ball(self, p, NULL)) * (1 - 1e-9); }
static sgt_span ball_span(const void *self, const sgt_ray *ray)
{
    (void)self;
    double d2 = ray->d.x * ray->d.x + ray->d.y * ray->d.y + ray->d.z * ray->d.z,
           t = -(ray->o.x * ray->d.x + ray->o.y * ray->d.y + ray->o.z * ray->d.z) / d2;
    return (sgt_span){.lo = t - 2 / sqrt(d2), .hi = t + 2 / sqrt(d2), .seed = t - 1.5 / sqrt(d2)};
}

static void test_clearance(void **state)
{
    (void)state;
    generator g = seeded("surfaces with a clearance");
    sgt_surface_ops ops = {.value = ball, .clearance = ball_clearance, .name = "ball"};
    watch_rays(&g, (sgt_surface){&ops, NULL}, "clearance", scaled(12));
    ops.span = ball_span, ops.estimate = ball_clearance;
    watch_rays(&g, (sgt_surface){&ops, NULL}, "clearance, span and estimate", scaled(12));
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_builtins), cmocka_unit_test(test_formulas),
                                       cmocka_unit_test(test_clearance)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
