// SPDX-License-Identifier: MIT
/* cases.c - surfaces, rays, and the settings to try on them.
 *
 * One knob is turned at a time.  All others keep their defaults: a batch; the outputs status, t, t_err, p, n
 * (of a lens: fate, last point and direction, path); t_tol 0; the default budget and pick.  The budgets tried
 * are 1/2, 1/4 and 1/8 of what the worst ray takes by default. */
#include "trade.h"

#include "../job/launch.h"
#include "../base/memory.h"
#include "../read/surface.h"
#include "../../truth/ordinary.h"

#include <math.h>
#include <sagitta/study.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { RAYS_DEFAULT = 1000, GRID_DEFAULT = 21 };

static ray_list default_rays(sgt_surface s)
{
    ray_list list = {.count = 0};
    sgt_ray *ray = memory_take(RAYS_DEFAULT, sizeof *ray);
    ordinary_rays(s, RAYS_DEFAULT, ray);
    for (int i = 0; i < RAYS_DEFAULT; i++) rays_add(&list, (launch){.ray = ray[i]});
    return list;
}

/* ------------------------------------------------------------------ cases */

static trade_case *add_case(trade *t, const char *name, const ray_list *rays)
{
    t->list = memory_room(t->list, t->count, &t->capacity, sizeof *t->list);
    trade_case *c = &t->list[t->count++];
    *c = (trade_case){.take = memory_take, .name = name, .rays = rays->count,
                      .ray = memory_take(rays->count, sizeof *c->ray)};
    double *array[8];
    for (int k = 0; k < 8; k++) array[k] = memory_take(rays->count, sizeof **array);
    bool ended = false;
    for (size_t i = 0; i < c->rays; i++) {
        const sgt_ray *r = &rays->ray[i].ray;
        const double number[8] = {r->o.x, r->o.y, r->o.z,  r->d.x,
                                  r->d.y, r->d.z, r->tmin, ray_end(r)};
        for (int k = 0; k < 8; k++) array[k][i] = number[k];
        ended = ended || number[6] != 0 || number[7] < HUGE_VAL;
        c->ray[i] = *r;
    }
    c->columns = (sgt_rays){.o = {array[0], array[1], array[2]}, .d = {array[3], array[4], array[5]}};
    if (ended) c->columns.tmin = array[6], c->columns.tmax = array[7];
    return c;
}

const char *const trade_knob_name[KNOBS] = {"default", "single", "out",    "t_tol",     "max_evals",
                                            "pick",    "proof",  "dt_min", "iterations", "floats"};

/* The rays rounded to floats, for the setting `floats`. */
static void round_rays(trade_case *c)
{
    float *own[8];
    for (int k = 0; k < 8; k++) own[k] = memory_take(c->rays, sizeof *own[k]);
    for (size_t i = 0; i < c->rays; i++) {
        const sgt_ray *r = &c->ray[i];
        const double number[8] = {r->o.x, r->o.y, r->o.z, r->d.x, r->d.y, r->d.z, r->tmin, ray_end(r)};
        for (int k = 0; k < 8; k++) own[k][i] = (float)number[k];
    }
    c->columns_f =
        (sgt_rays_f){.o = {own[0], own[1], own[2]}, .d = {own[3], own[4], own[5]}};
    if (c->columns.tmin) c->columns_f.tmin = own[6], c->columns_f.tmax = own[7];
}

static void add(trade_case *c, setting s, knob turned, const char *format, ...) LIKE_PRINTF(4, 5);

static void add(trade_case *c, setting s, knob turned, const char *format, ...)
{
    va_list values;
    va_start(values, format);
    vsnprintf(s.name, sizeof s.name, format, values);
    va_end(values);
    s.turned = turned;
    c->setting = memory_room(c->setting, c->settings, &c->capacity, sizeof *c->setting);
    c->setting[c->settings++] = s;
}

/* A number as a short text: 1e-9 and not 1e-09, 1e-1 like 1e-2. */
static const char *brief(double x)
{
    char text[40];
    int digits = 0;
    do snprintf(text, sizeof text, "%.*e", digits, x);
    while (strtod(text, NULL) != x && digits++ < 16);
    if (x >= 1) snprintf(text, sizeof text, "%.17g", x);
    char *e = strstr(text, "e-0");
    if (e) memmove(e + 2, e + 3, strlen(e + 3) + 1);
    return memory_text(text, strlen(text));
}

static const knob_list *given_or(const knob_list *given, const knob_list *otherwise)
{
    return given->count ? given : otherwise;
}

static const char *const proof_name[] = {"estimate", "root", "first"};

/* Adds the settings of one knob after another.  seed: --pick is of use (some surface is no level set); set:
 * --dt-min is (some surface is one). */
static void add_settings(trade_case *c, const trade_options *o, setting base, bool seed, bool set)
{
    static const knob_list t_tol = {4, {1e-12, 1e-9, 1e-6, 1e-3}}, dt_min = {4, {1e-1, 1e-2, 1e-3, 1e-4}};
    setting s = base;
    add(c, base, KNOB_NONE, "default");
    s.single = true, add(c, s, KNOB_CALL, "single"), s = base;
    s.outputs = OUTPUTS_LEAST, add(c, s, KNOB_OUTPUTS, c->lens ? "out=point" : "out=t");
    s.outputs = OUTPUTS_ALL, add(c, s, KNOB_OUTPUTS, "out=all"), s = base;
    if (c->columns_f.o[0]) {
        s.floats = true, s.truth = measure_truth(c, &s);
        add(c, s, KNOB_FLOATS, "floats"), s = base;
    }
    const knob_list *list = given_or(&o->t_tol, &t_tol);
    for (size_t i = 0; i < list->count; i++) {
        s.options.t_tol = list->value[i];
        add(c, s, KNOB_T_TOL, "t_tol=%s", brief(list->value[i]));
    }
    s = base;
    knob_list budgets = {0};
    for (int most = measure_most_evals(c, &base) / 2; most > 0 && budgets.count < 3; most /= 2)
        budgets.value[budgets.count++] = most;
    list = given_or(&o->max_evals, &budgets);
    for (size_t i = 0; i < list->count; i++) {
        s.options.max_evals = (int)list->value[i];
        add(c, s, KNOB_MAX_EVALS, "max_evals=%d", s.options.max_evals);
    }
    s = base;
    if (seed && o->pick == SGT_PICK_DEFAULT) {
        s.options.pick = c->lens ? SGT_FIRST : SGT_NEAR_SEED;
        s.truth = measure_truth(c, &s);
        add(c, s, KNOB_PICK, "pick=%s", c->lens ? "first" : "near-seed"), s = base;
    }
    static const sgt_proof proofs[] = {SGT_PROVE_ROOT, SGT_PROVE_FIRST};
    size_t count = o->proofs ? o->proofs : sizeof proofs / sizeof proofs[0];
    for (size_t i = 0; i < count; i++) {
        s.options.proof = o->proofs ? o->proof[i] : proofs[i];
        add(c, s, KNOB_PROOF, "proof=%s", proof_name[s.options.proof]);
    }
    s = base;
    list = given_or(&o->dt_min, &dt_min);
    for (size_t i = 0; set && i < list->count; i++) {
        s.options.dt_min = list->value[i];
        add(c, s, KNOB_DT_MIN, "dt_min=%s", brief(list->value[i]));
    }
}

/* ------------------------------------------------- the number of iterations */

/* The parameter N of a type; NULL: it has none. */
static const sgt_param *iterations_of(const sgt_builtin *b)
{
    for (const sgt_param *p = b->params; b->type && p->name; p++)
        if (strcmp(p->name, "iterations") == 0) return p;
    return NULL;
}

/* The same surface with another N; self NULL: that N is not valid. */
static sgt_surface with_iterations(sgt_surface s, int n)
{
    const sgt_builtin *b = sgt_builtin_of(s);
    char *self = memory_take(1, b->size);
    memcpy(self, s.self, b->size);
    memcpy(self + iterations_of(b)->offset, &n, sizeof n);
    if (b->object && b->object(self).reason) return (sgt_surface){.ops = s.ops, .self = NULL};
    return (sgt_surface){.ops = s.ops, .self = self};
}

static void iterations_case(trade *t, const trade_options *o, const char *name, const char *about,
                            sgt_surface s, const ray_list *rays)
{
    const sgt_param *p = iterations_of(sgt_builtin_of(s));
    int own, deepest = 0;
    if (!p) return;
    memcpy(&own, (const char *)s.self + p->offset, sizeof own);
    if (own == 0) own = 10;
    knob_list around = {0};
    for (int n = own - 4; n <= own + 4; n += 2)
        if (n >= 1 && n <= p->hi && with_iterations(s, n).self) around.value[around.count++] = n;
    const knob_list *list = given_or(&o->iterations, &around);
    for (size_t i = 0; i < list->count; i++) {
        int n = (int)list->value[i];
        if (!with_iterations(s, n).self) fail_usage("--iterations %d: more than this surface can have", n);
        if (n > deepest) deepest = n;
    }
    if (list->count < 2) return;
    trade_case *c = add_case(t, memory_text(name, strlen(name)), rays);
    snprintf(c->about, sizeof c->about, "%.300s; errors against N = %d", about, deepest);
    setting s_of_n = {
        .surface = with_iterations(s, deepest), .outputs = OUTPUTS_USUAL, .options = {.pick = o->pick}};
    s_of_n.truth = measure_truth(c, &s_of_n);
    for (size_t i = 0; i < list->count; i++) {
        int n = (int)list->value[i];
        s_of_n.surface = with_iterations(s, n);
        s_of_n.other_model = n != deepest;
        add(c, s_of_n, KNOB_ITERATIONS, "iterations=%d", n);
    }
}

/* ------------------------------------------------------ surfaces and lenses */

/* Gives a surface that is a text its definition in 113 bits. */
static void read_formula(const char *which, sgt_surface s)
{
    const char *text;
    const sgt_named *parameter;
    size_t count;
    if (quad_formula_of(s) || !lens_formula_of(s, &text, &parameter, &count)) return;
    size_t at = quad_formula_read(s, text, count, parameter);
    if (at) fail_usage("%s: column %zu of the formula cannot be worked out in 113 bits", which, at);
}

/* Ends with an error if there is no formula in 113 bits for a surface; which: "--surface" or "element 2". */
static void check_known(const char *which, const char *type, sgt_surface s)
{
    read_formula(which, s);
    if (quad_formula_of(s)) return;
    fail_usage(
        "%s: trade cannot measure the type %s: errors are told against 113 bits, and it has no F in them",
        which, type);
}

static void surface_case(trade *t, const trade_options *o, const char *name, const char *about, sgt_surface s)
{
    check_known("--surface", name, s);
    ray_list given = o->rays, rays = given.count ? given : default_rays(s);
    trade_case *c = add_case(t, name, &rays);
    snprintf(c->about, sizeof c->about, "%.300s", about);
    if (s.ops == &sgt_conic_ops || s.ops == &sgt_even_asphere_ops) round_rays(c);
    setting base = {.surface = s, .outputs = OUTPUTS_USUAL, .options = {.pick = o->pick}};
    base.truth = measure_truth(c, &base);
    add_settings(c, o, base, !surface_is_level_set(s), surface_is_level_set(s));
    char deeper[100];
    snprintf(deeper, sizeof deeper, "%.60s-iterations", name);
    iterations_case(t, o, deeper, about, s, &rays);
}

static void lens_case(trade *t, const trade_options *o, const char *name, const job *j)
{
    bool seed = false, set = false;
    for (size_t i = 0; i < j->lens.count; i++) {
        char which[40];
        snprintf(which, sizeof which, "element %zu", i + 1);
        check_known(which, j->lens.surface[i].type, j->element[i].surface);
        bool is_set = surface_is_level_set(j->element[i].surface);
        seed = seed || !is_set, set = set || is_set;
    }
    trade_case *c = add_case(t, name, &j->rays);
    measured_lens *l = memory_take(1, sizeof *l);
    *l = (measured_lens){.count = j->lens.count, .element = j->element, .index_before = j->lens.index_before,
                         .length = sgt_lens_unit(j->lens.of), .wavelength = j->lens.wavelength,
                         .units = j->lens.units};
    c->lens = l;
    snprintf(c->about, sizeof c->about, "%zu elements%s%.20s", j->lens.count,
             *j->lens.units ? ", unit of length: " : "", j->lens.units);
    setting base = {.outputs = OUTPUTS_USUAL, .options = {.pick = o->pick}};
    base.truth = measure_truth(c, &base);
    add_settings(c, o, base, seed, set);
}

/* The scan lens of examples/lenses/ftheta.yaml, at its first wavelength. */
static const char SCAN_LENS[] =
    "{name: f-theta scan lens, units: in, wavelengths: [0.5876], pupil: {semi_diameter: 0.5, distance: 0},"
    " fields: [0, 10, 20], surfaces: ["
    "{type: plane, thickness: 5, semi_diameter: 0.5},"
    "{type: sphere, radius: -2.2136, thickness: 0.3, index: 1.84666, semi_diameter: 2},"
    "{type: sphere, radius: -2.6575, thickness: 0.02, index: 1, semi_diameter: 2.25},"
    "{type: sphere, radius: -5.5022, thickness: 0.5292, index: 1.84666, semi_diameter: 2.5},"
    "{type: sphere, radius: -3.8129, thickness: 4.2927, index: 1, semi_diameter: 2.6},"
    "{type: sphere, radius: 7.9951, thickness: 0.59, index: 1.84666, semi_diameter: 4.05},"
    "{type: sphere, radius: 8.3651, thickness: 18.0014, index: 1, semi_diameter: 4},"
    "{type: plane, semi_diameter: 7.2}]}";

static const job *scan_lens(void)
{
    job *j = memory_take(1, sizeof *j);
    j->lens = lens_of_text("scan-lens", SCAN_LENS);
    j->element = j->lens.element;
    j->fields = j->lens.of->fields, j->field = j->lens.of->field;
    launch_how how = launch_by(&j->lens, &(sgt_lens_aim){SGT_LENS_AIM_PUPIL});
    const launch_pattern grid = launch_points(SGT_PATTERN_GRID, GRID_DEFAULT, 0);
    for (size_t f = 0; f < j->fields; f++)
        launch_field(&j->rays, &how, &j->lens, j->lens.element, f, SGT_FIELD_ANGLE, j->field[f], &grid);
    return j;
}

static void default_set(trade *t, const trade_options *o)
{
    static const sgt_conic conic = {.c = 0.1, .k = -0.6};
    static const sgt_even_asphere asphere = {
        .c = 0.1, .k = -0.6, .semi_diameter = 4, .a = {0, 1e-4, -2e-6, 1e-8}};
    static const sgt_julia julia = {.c = {-0.083, 0, -0.83, -0.025}, .iterations = 7};
    surface_case(t, o, "conic", "R = 10, k = -0.6", (sgt_surface){&sgt_conic_ops, &conic});
    surface_case(t, o, "asphere", "that conic with 1e-4 r^4 - 2e-6 r^6 + 1e-8 r^8, semi-diameter 4",
                 (sgt_surface){&sgt_even_asphere_ops, &asphere});
    lens_case(t, o, "scan-lens", scan_lens());
    surface_case(t, o, "julia", "c = (-0.083, 0, -0.83, -0.025), N = 7",
                 (sgt_surface){&sgt_julia_ops, &julia});
}

trade trade_cases(const trade_options *o)
{
    trade t = {.count = 0};
    if (o->surface) {
        const char *type;
        sgt_surface s = surface_parse_typed("--surface", o->surface, &type);
        trade_options with_rays = *o;
        if (o->job.rays) rays_read(&with_rays.rays, o->job.rays, o->job.skip_bad);
        surface_case(&t, &with_rays, type, o->surface, s);
    } else if (o->job.lens) {
        job *j = memory_take(1, sizeof *j);
        job_options asked = o->job;
        if (!asked.rays && !asked.points && !asked.pupils)
            asked.pattern = SGT_PATTERN_GRID, asked.points = GRID_DEFAULT;
        *j = job_read(&asked);
        lens_case(&t, o, *j->lens.name ? j->lens.name : o->job.lens, j);
    } else {
        default_set(&t, o);
    }
    return t;
}
