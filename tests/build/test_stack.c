// SPDX-License-Identifier: MIT
/* A call of the library needs less than 80 KiB of stack, but for the two that headers name.  Each kind of
 * call runs on a stack of its own that has been painted before; what has lost its paint was used.  A call
 * runs twice, since the first may bind names. */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <ucontext.h>
#include <sagitta/aim.h>
#include <sagitta/diagnose.h>
#include <sagitta/formula.h>
#include <sagitta/sensitivity.h>
#include <sagitta/surfaces.h>
#include <sagitta/system.h>

enum { MOST = 80 * 1024, MORE = 16 * 1024, MORE_LEAVING = 70 * 1024, ROOM = 512 * 1024, RAYS = 60 };
static const unsigned char PAINT = 0xa5;

/* -------------------------------------------------------------- the painted stack */

static _Alignas(4096) unsigned char stack[ROOM];
static ucontext_t here, there;
static void (*call)(void);

static void run(void) { call(); }

static size_t stack_of(void (*what)(void))
{
    call = what;
    for (int i = 0; i < 2; i++) {
        memset(stack, PAINT, sizeof stack);
        if (getcontext(&there) != 0) return 0;
        there.uc_stack.ss_sp = stack, there.uc_stack.ss_size = sizeof stack, there.uc_link = &here;
        makecontext(&there, run, 0);
        if (swapcontext(&here, &there) != 0) return 0;
    }
    size_t clean = 0;
    while (clean < sizeof stack && stack[clean] == PAINT) clean++;
    return sizeof stack - clean;
}

/* A call that needs 96 KiB is seen to. */
static void greedy(void)
{
    volatile unsigned char array[96 * 1024];
    for (size_t i = 0; i < sizeof array; i++) array[i] = 0;
}

/* ------------------------------------------------------------------ surfaces, rays */

/* A user's own: a wavy sheet, that needs a march; alone, with many points at a time, with spans as well. */
static double waves(const void *self, sgt_vec3 p, sgt_vec3 *grad)
{
    (void)self;
    if (grad) *grad = (sgt_vec3){-0.3 * cos(p.x), 0.3 * sin(p.y), 1};
    return p.z - 0.3 * sin(p.x) - 0.3 * cos(p.y);
}

static void many_waves(const void *self, size_t n, sgt_points p, sgt_values out)
{
    for (size_t i = 0; i < n; i++) {
        sgt_vec3 grad;
        out.f[i] = waves(self, (sgt_vec3){p.p[0][i], p.p[1][i], p.p[2][i]}, &grad);
        if (out.grad[0]) out.grad[0][i] = grad.x, out.grad[1][i] = grad.y, out.grad[2][i] = grad.z;
    }
}

static sgt_span wave_span(const void *self, const sgt_ray *ray)
{
    (void)self;
    double a = (-1 - ray->o.z) / ray->d.z, b = (1 - ray->o.z) / ray->d.z;
    return (sgt_span){.lo = fmin(a, b), .hi = fmax(a, b), .seed = (double)NAN};
}

static void wave_spans(const void *self, size_t n, sgt_rays rays, sgt_spans out)
{
    for (size_t i = 0; i < n; i++) {
        sgt_ray ray = {
            {rays.o[0][i], rays.o[1][i], rays.o[2][i]}, {rays.d[0][i], rays.d[1][i], rays.d[2][i]}, 0, 0};
        sgt_span span = wave_span(self, &ray);
        out.lo[i] = span.lo, out.hi[i] = span.hi, out.seed[i] = span.seed, out.single[i] = span.single;
    }
}

static const sgt_surface_ops sheet = {.name = "waves", .value = waves, .span = wave_span};
static const sgt_surface_ops sheets = {
    .name = "waves", .value = waves, .span = wave_span, .values = many_waves};
static sgt_interval wave_enclose(const void *self, const sgt_ray *ray, sgt_interval t, sgt_interval *slope)
{
    (void)self;
    double a = ray->o.z + t.lo * ray->d.z, b = ray->o.z + t.hi * ray->d.z,
           steep = fabs(ray->d.z) + 3 * (fabs(ray->d.x) + fabs(ray->d.y));
    *slope = (sgt_interval){-steep, steep};
    return (sgt_interval){fmin(a, b) - 1, fmax(a, b) + 1};
}

static const sgt_surface_ops sure_sheet = {
    .name = "waves", .value = waves, .span = wave_span, .enclose = wave_enclose};
static const sgt_surface_ops all_sheets = {
    .name = "waves", .value = waves, .span = wave_span, .values = many_waves, .spans = wave_spans};
static const sgt_conic mirror = {.c = -0.1, .k = -1}, rimmed = {.c = 0.2, .k = -0.6, .semi_diameter = 4};
static const sgt_even_asphere asphere = {
    .c = 0.2, .k = -0.6, .semi_diameter = 4, .a = {0, 1e-4, -2e-6, 1e-8}};
static const sgt_julia julia = {.c = {-0.2, 0.8, 0, 0}, .iterations = 8},
                       cubic = {.c = {0.1, 0.3, 0.2, 0}, .iterations = 5, .power = 3};
static const sgt_mandelbrot mandelbrot = {.iterations = 6};

/* Small departures with long lists: the order counts, and not the numbers. */
static double list[231], table[64 * 64];
static const sgt_odd_asphere odd = {.c = 0.2, .semi_diameter = 4, .a = {1e-3, 1e-4, -2e-6, [15] = 1e-14}};
static const sgt_polynomial_xy polynomial = {.c = 0.2, .semi_diameter = 4, .a = {table, 12, 12}};
static const sgt_chebyshev chebyshev = {
    .c = 0.2, .semi_diameter = 4, .norm_x = 5, .norm_y = 5, .a = {table, 24, 24}};
static const sgt_zernike zernike = {
    .c = 0.2, .semi_diameter = 4, .norm = 5, .order = SGT_NOLL, .a = {list, 1, 231}};
static const sgt_q_con q_con = {.c = 0.2, .semi_diameter = 4, .norm = 4, .a = {list, 1, 64}};
static const sgt_q_bfs q_bfs = {.c = 0.2, .semi_diameter = 4, .norm = 4, .a = {list, 1, 64}};
static const sgt_grid grid = {
    .c = 0.2, .semi_diameter = 4, .step_x = 0.2, .step_y = 0.2, .z = {table, 64, 64}};
static const sgt_surface terms[] = {{&sgt_chebyshev_ops, &chebyshev},
                                    {&sgt_zernike_ops, &zernike},
                                    {&sgt_grid_ops, &grid},
                                    {&sgt_q_bfs_ops, &q_bfs}};
static const sgt_sum sum = {.c = 0.2, .semi_diameter = 4, .terms = terms, .count = 4};
static const sgt_toroidal toroid = {.c = 0.2, .c_x = 0.1, .semi_diameter = 4, .a = {0, 1e-5}};
static const sgt_biconic biconic = {.c_x = 0.1, .c_y = 0.2, .semi_diameter = 4},
                         wide = {.c_x = 0.1, .c_y = 0.2};
static const sgt_quadric quadric = {.squares = {1, 2, 3}, .products = {0.1, 0.2, 0.3}, .constant = -4};
static const sgt_torus ring = {.major = 2, .minor = 0.5}, spindle = {.major = 1, .minor = 2};
static const sgt_ellipsoid ellipsoid = {.a = 2, .f = 0.3};

/* Formulas, read by make_formulas: with parts that are not polynomials, of r^2 alone, and of x, y and z. */
static sgt_formula_sag trefoil = {.semi_diameter = 4}, round_sag = {.semi_diameter = 4};
static sgt_formula clebsch = {.ball = 4}, sheets_of_waves = {.ball = 4};

static const struct { const char *name; sgt_surface surface;
} surfaces[] = {
    {"formula, sag", {&sgt_formula_sag_ops, &trefoil}},
    {"formula, r^2", {&sgt_formula_sag_ops, &round_sag}},
    {"formula, cubic", {&sgt_formula_ops, &clebsch}},
    {"formula, waves", {&sgt_formula_ops, &sheets_of_waves}},
    {"odd asphere", {&sgt_odd_asphere_ops, &odd}},
    {"polynomial_xy", {&sgt_polynomial_xy_ops, &polynomial}},
    {"chebyshev", {&sgt_chebyshev_ops, &chebyshev}},
    {"zernike", {&sgt_zernike_ops, &zernike}},
    {"q_con", {&sgt_q_con_ops, &q_con}},
    {"q_bfs", {&sgt_q_bfs_ops, &q_bfs}},
    {"grid", {&sgt_grid_ops, &grid}},
    {"sum", {&sgt_sum_ops, &sum}},
    {"toroid", {&sgt_toroidal_ops, &toroid}},
    {"biconic", {&sgt_biconic_ops, &biconic}},
    {"biconic, no rim", {&sgt_biconic_ops, &wide}},
    {"quadric", {&sgt_quadric_ops, &quadric}},
    {"torus", {&sgt_torus_ops, &ring}},
    {"spindle", {&sgt_torus_ops, &spindle}},
    {"ellipsoid", {&sgt_ellipsoid_ops, &ellipsoid}},
    {"paraboloid", {&sgt_conic_ops, &mirror}},
    {"conic", {&sgt_conic_ops, &rimmed}},
    {"asphere", {&sgt_even_asphere_ops, &asphere}},
    {"own, value", {&sheet, NULL}},
    {"own, values", {&sheets, NULL}},
    {"own, enclose", {&sure_sheet, NULL}},
    {"own, spans", {&all_sheets, NULL}},
    {"julia", {&sgt_julia_ops, &julia}},
    {"julia, power 3", {&sgt_julia_ops, &cubic}},
    {"mandelbrot", {&sgt_mandelbrot_ops, &mandelbrot}},
};

static double numbers[8][RAYS], out[2][14][RAYS];
static sgt_status status[2][RAYS];
static sgt_fate fates[RAYS];
static int evals[2][RAYS];
static const sgt_rays rays = {
    {numbers[0], numbers[1], numbers[2]}, {numbers[3], numbers[4], numbers[5]}, numbers[6], numbers[7]};

/* splitmix64, as a number in [-1, 1). */
static uint64_t state = 20240229;
static double random_number(void)
{
    uint64_t z = state += 0x9e3779b97f4a7c15u;
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
    z = (z ^ z >> 27) * 0x94d049bb133111ebu;
    return (double)((z ^ z >> 31) >> 11) * 0x1p-52 - 1;
}

/* Near and far, steep and grazing, misses, and some that are no rays at all. */
static void make_rays(void)
{
    for (size_t i = 0; i < RAYS; i++) {
        double far = i % 7 == 0 ? 1e9 : 1, steep = i % 3 == 0 ? 1e-3 : 1;
        for (int k = 0; k < 6; k++) numbers[k][i] = random_number();
        numbers[0][i] *= far, numbers[1][i] *= 3, numbers[2][i] = -5 * far;
        numbers[3][i] *= 0.2 * far, numbers[4][i] *= 0.2, numbers[5][i] = steep * (5 * far + numbers[5][i]);
        numbers[6][i] = i % 11 ? -HUGE_VAL : 0, numbers[7][i] = i % 13 ? HUGE_VAL : 4;
        if (i % 101 == 0) numbers[i % 8][i] = (double)NAN;
    }
}

static sgt_hits hits_of(int j)
{
    double(*o)[RAYS] = out[j];
    return (sgt_hits){status[j],          evals[j],           o[0], o[1], o[2],
                      {o[3], o[4], o[5]}, {o[6], o[7], o[8]}, o[9], {0}};
}

static sgt_ray ray_of(size_t i)
{
    return (sgt_ray){{numbers[0][i], numbers[1][i], numbers[2][i]},
                     {numbers[3][i], numbers[4][i], numbers[5][i]},
                     numbers[6][i],
                     numbers[7][i]};
}

/* ----------------------------------------------------------------------- the calls */

static sgt_surface surface;
static size_t met, count;

/* Every option that leads another way, all outputs and t alone. */
static const sgt_options ways[] = {{0},
                                   {.pick = SGT_NEAR_SEED},
                                   {.t_tol = 1e-6, .f_tol = 1e-9},
                                   {.dt_min = 0.05},
                                   {.max_evals = 20},
                                   {.proof = SGT_PROVE_ROOT},
                                   {.proof = SGT_PROVE_FIRST},
                                   {.pick = SGT_NEAR_SEED, .proof = SGT_PROVE_FIRST}};

static void intersect_batch(void)
{
    for (size_t w = 0; w < sizeof ways / sizeof ways[0]; w++)
        met += sgt_intersect_batch(surface, count, rays, hits_of(0), &ways[w]);
    met += sgt_intersect_batch(surface, count, rays, (sgt_hits){.t = out[0][0]}, NULL);
}

/* Rays that leave the surface where others met it, and some that begin anywhere.  sagitta.h allows
 * sgt_leave_batch MORE_LEAVING. */
static void leave_batch(void)
{
    static signed char side[RAYS];
    sgt_intersect_batch(surface, count, rays, hits_of(0), &(sgt_options){0});
    double(*o)[RAYS] = out[0];
    for (size_t i = 0; i < count; i++)
        for (int k = 0; k < 3 && status[0][i] <= 0; k++) o[3 + k][i] = numbers[k][i], o[6 + k][i] = 0;
    const sgt_starts from = {.p = {o[3], o[4], o[5]}, .n = {o[6], o[7], o[8]},
                             .d = {numbers[3], numbers[4], numbers[5]}};
    for (size_t w = 0; w < sizeof ways / sizeof ways[0]; w++)
        met += 1 + sgt_leave_batch(surface, count, from, hits_of(1), side, &ways[w]);
}

static void intersect(void)
{
    for (size_t w = 0; w < sizeof ways / sizeof ways[0]; w++)
        for (size_t i = 0; i < count; i++) {
            sgt_hit all[4];
            met += sgt_intersect(surface, ray_of(i), &ways[w]).status > 0;
            met += sgt_intersect_all(surface, ray_of(i), 4, all, &ways[w]) > 0;
        }
}

/* Derivatives of the hits there are, by o and by parameters, of t and n; those along a change, which needs
 * the most. */
static void differentiate(void)
{
    static double by_o[12][RAYS], by_a[4][RAYS], change[7][RAYS], da[64];
    double *t[64], *n[3][64];
    for (int j = 0; j < 64; j++)
        t[j] = by_a[0], n[0][j] = by_a[1], n[1][j] = by_a[2], n[2][j] = by_a[3], da[j] = 1;
    sgt_jacobian all = {
        .t_by_o = {by_o[0], by_o[1], by_o[2]},
        .n_by_o = {{by_o[3], by_o[4], by_o[5]}, {by_o[6], by_o[7], by_o[8]}, {by_o[9], by_o[10], by_o[11]}},
        .t_by_a = t,
        .n_by_a = {n[0], n[1], n[2]}};
    met++; /* whether or not a hit is among them */
    if (sgt_parameters(surface) > 64) return;
    sgt_intersect_batch(surface, count, rays, hits_of(0), NULL);
    sgt_differentiate_batch(surface, count, rays, hits_of(0), all);
    sgt_differentiate_forward(
        surface, count, rays, hits_of(0), rays, da,
        (sgt_changes){change[0], {change[1], change[2], change[3]}, {change[4], change[5], change[6]}});
    for (size_t i = 0; i < count; i++) {
        sgt_ray ray = ray_of(i);
        sgt_hit hit = sgt_intersect(surface, ray, NULL);
        sgt_change o[3], a[64];
        sgt_differentiate(surface, &ray, &hit, o, a);
    }
}

static sgt_element elements[3];

static void trace_batch(void)
{
    sgt_traced traced = {.fate = fates, .passed = evals[1], .o = {out[1][0], out[1][1], out[1][2]},
                         .d = {out[1][3], out[1][4], out[1][5]}, .opl = out[1][6]};
    sgt_passages passage = {.hits = hits_of(0), .direction = {out[0][10], out[0][11], out[0][12]},
                            .opl = out[0][13]};
    sgt_passages passages[3] = {passage, passage, passage};
    for (size_t w = 0; w < sizeof ways / sizeof ways[0]; w++) {
        met += sgt_trace_batch(3, elements, 1, count, rays, traced, passages, &ways[w]);
        met += sgt_trace_batch(3, elements, 1, count, rays, (sgt_traced){.fate = fates}, NULL, &ways[w]);
    }
}

static void trace(void)
{
    for (size_t i = 0; i < count; i++) {
        sgt_passage passages[3];
        sgt_fate fate;
        sgt_ray ray = ray_of(i);
        met += sgt_trace(3, elements, 1, &ray, passages, &fate, NULL);
    }
}

/* The derivatives of traces, and aiming where it is not met, so that a proof is tried. */
static void aim(void)
{
    static double gradient[2 * 4096];
    const sgt_beam beam = {.o = {0, 0, -9}, .ou = {1, 0, 0}, .ov = {0, 1, 0}, .d = {0, 0, 1}, .u = {-2, 2},
                           .v = {-2, 2}};
    sgt_passage passages[3];
    sgt_ray_change weight[2] = {{{1, 0, 0}, {0, 0, 0}, 0}, {{0, 0, 0}, {0, 1, 0}, 0}}, change[2];
    for (size_t i = 0; i < 20; i += 9) {
        sgt_ray launch = sgt_beam_ray(&beam, 0.1 * (double)i - 1, 0.5), ray = launch;
        size_t n = sgt_trace(3, elements, 1, &ray, passages, NULL, NULL);
        if (sgt_trace_parameters(n, elements) <= 4096)
            sgt_trace_gradient(n, elements, 1, &launch, passages, 2, weight, gradient);
        sgt_trace_sensitivity(n, elements, 1, &launch, passages, 2, weight, change);
        sgt_vec2 wanted = {0.3 * (double)i, 0.1};
        met += 1 + (size_t)(sgt_aim(2, elements, 1, &beam, wanted, passages, NULL, NULL) == SGT_MET);
    }
}

/* The same of many rays, and aiming at points that are met or not.  aim.h allows sgt_aim_batch MORE. */
static void aim_many(void)
{
    enum { MANY = 70, ELEMENTS = 3, LIST = 4096 };
    static double array[16 * ELEMENTS][MANY], to[6][MANY], *gradient[2 * LIST];
    static sgt_status statuses[ELEMENTS][MANY];
    static sgt_vec2 wanted[MANY];
    const sgt_beam beam = {.o = {0, 0, -9}, .ou = {1, 0, 0}, .ov = {0, 1, 0}, .d = {0, 0, 1}, .u = {-2, 2},
                           .v = {-2, 2}};
    sgt_passage room[ELEMENTS];
    sgt_passages some[ELEMENTS];
    for (int e = 0, k = 0; e < ELEMENTS; e++) {
        some[e] = (sgt_passages){.hits = {.status = statuses[e], .t = array[k], .p_err = array[k + 1]}};
        some[e].opl = array[k + 2], k += 3;
        for (int x = 0; x < 3; x++, k += 3)
            some[e].hits.p[x] = array[k], some[e].hits.n[x] = array[k + 1],
            some[e].direction[x] = array[k + 2];
    }
    for (int i = 0; i < MANY; i++) wanted[i] = (sgt_vec2){0.05 * (i - 20), 0.1};
    const sgt_aims aims = {MANY, wanted, NULL, some};
    const sgt_aim_options quick = {.max_boxes = 20, .max_traces = 40};
    met += 1 + sgt_aim_batch(2, elements, 1, &beam, &aims, room, &quick);
    const sgt_traces traces = {
        MANY, {.o = {array[45], array[46], array[47]}, .d = {to[3], to[4], to[5]}}, some};
    for (int i = 0; i < MANY; i++) {
        const sgt_ray ray = sgt_beam_ray(&beam, 0.02 * i - 1, 0.5);
        array[45][i] = ray.o.x, array[46][i] = ray.o.y, array[47][i] = ray.o.z;
        to[3][i] = ray.d.x, to[4][i] = ray.d.y, to[5][i] = ray.d.z;
    }
    sgt_trace_batch(ELEMENTS, elements, 1, MANY, traces.rays, (sgt_traced){.fate = NULL}, some, NULL);
    const sgt_ray_changes change[2] = {{.p = {to[3], to[4], to[5]}}, {.d = {to[3], to[4], to[5]}}},
                          end[2] = {{.p = {to[0], to[1], to[2]}}, {.opl = to[0]}};
    sgt_trace_sensitivity_batch(ELEMENTS, elements, 1, &traces, 2, change, end);
    for (int i = 0; i < 2 * LIST; i++) gradient[i] = i % 40 ? NULL : to[0];
    if (sgt_trace_parameters(ELEMENTS, elements) <= LIST)
        sgt_trace_gradient_batch(ELEMENTS, elements, 1, &traces, 2, change, gradient);
    const sgt_end_errors errors = {.point = to[0], .path = to[1]};
    met += sgt_trace_error_batch(ELEMENTS, elements, 1, &traces, errors);
}

static void check(void)
{
    sgt_ray walk = {{0.3, 0.2, -5}, {0, 0.1, 1}, 0, 10};
    met += sgt_check(surface, 1, &walk, NULL) == SGT_SOUND;
}

/* The deepest formulas. */
static char formula[9 * SGT_DEEPEST_FORMULA + 8];

static void read_formula(void)
{
    static double room[60000];
    sgt_tape *tape = NULL;
    if (sgt_formula_room(formula, 0) <= sizeof room)
        tape = sgt_formula_read(formula, SGT_FORMULA_XYZ, 0, NULL, room, sizeof room, NULL);
    met += tape != NULL;
}

/* SGT_DEEPEST_FORMULA parentheses or powers, a part of the text having `many`. */
static void make_formula(const char *part, int many, bool parentheses)
{
    int count_of_parts = SGT_DEEPEST_FORMULA / many;
    formula[0] = 0;
    for (int i = 0; i < count_of_parts; i++) strcat(formula, part);
    strcat(formula, "z");
    for (int i = 0; parentheses && i < count_of_parts; i++) strcat(formula, ")");
}

static sgt_tape *tape_of(const char *text, sgt_formula_kind kind)
{
    size_t size = sgt_formula_room(text, 0);
    void *place = malloc(size);
    sgt_tape *tape = place ? sgt_formula_read(text, kind, 0, NULL, place, size, NULL) : NULL;
    if (!tape) puts("a formula was not read"), exit(1);
    return tape;
}

static void make_formulas(void)
{
    trefoil.tape = tape_of("0.1*r^2/(1 + sqrt(1 - 0.02*r^2)) + 1e-4*r^4*cos(3*atan2(y, x))"
                           " + 1e-3*sin(x)*exp(y/9) + 1e-6*(9 + x)^(2.5 + y/99) + 1e-5*cosh(y)",
                           SGT_FORMULA_XY);
    round_sag.tape = tape_of("0.1*r^2/(1 + sqrt(1 - 0.02*r^2)) + 1e-4*r^4 + 1e-6*cosh(r^2/9)",
                             SGT_FORMULA_XY);
    clebsch.tape = tape_of("81*(x^3 + y^3 + z^3) - 189*(x^2*(y + z) + y^2*(x + z) + z^2*(x + y)) + 54*x*y*z"
                           " + 126*(x*y + x*z + y*z) - 9*(x^2 + y^2 + z^2) - 9*(x + y + z) + 1",
                           SGT_FORMULA_XYZ);
    sheets_of_waves.tape = tape_of("min(sin(6*x)*cos(6*y) + z, hypot(x, y) - atan2(1 + x^2, z))"
                                   " + abs(x)^2.5 - cbrt(z)",
                                   SGT_FORMULA_XYZ);
}

int main(void)
{
    if (stack_of(greedy) < 80 * 1024) return puts("paint does not tell what was used"), 1;
    for (size_t i = 0; i < sizeof list / sizeof *list; i++) list[i] = 1e-4 / (double)(1 + i);
    for (size_t i = 0; i < sizeof table / sizeof *table; i++) table[i] = 1e-9 / (double)(1 + i);
    make_rays();
    make_formulas();

    size_t worst = 0, before = 0, idle = 0;
    for (size_t s = 0; s < sizeof surfaces / sizeof surfaces[0]; s++) {
        surface = surfaces[s].surface;
        /* those of the catalogue take their time */
        count = surface.ops->values && surface.ops->own_ ? RAYS / 5 : RAYS;
        for (int i = 0; i < 3; i++)
            elements[i] = (sgt_element){.surface = surface,
                                        .pose = {.origin = {0, 0, 2 * i}},
                                        .index = 1.1 + 0.1 * i,
                                        .semi_diameter = i ? 3 : 0};
        elements[1].pose = sgt_pose_tilted((sgt_vec3){0.1, 0, 2}, (sgt_vec3){2, 0, 0});
        elements[2].index = SGT_MIRROR;
        const sgt_phase phase = {.kind = SGT_PHASE_FUNCTION, .waves = surface, .per_wave = 1e-3};
        elements[1].phase = &phase;
        static void (*const calls[])(void) = {intersect_batch, intersect,     trace_batch, trace,
                                              check,           differentiate, aim,         aim_many,
                                              leave_batch};
        static const char *const names[] = {"intersect_batch", "intersect",     "trace_batch", "trace",
                                            "check",           "differentiate", "aim",         "aim_many",
                                            "leave_batch"};
        printf("%-16s", surfaces[s].name);
        for (size_t c = 0; c < sizeof calls / sizeof calls[0]; c++) {
            size_t used = stack_of(calls[c]);
            printf("  %s %zu", names[c], used);
            if (calls[c] == aim_many) used = used > MORE ? used - MORE : 0;
            if (calls[c] == leave_batch) used = used > MORE_LEAVING ? used - MORE_LEAVING : 0;
            if (used > worst) worst = used;
            idle += met == before;
            before = met;
        }
        printf("\n");
    }
    static const struct { const char *part; int many; } deep[] = {
        {"x+y*(", 1}, {"x-sin(", 1}, {"hypot(x,", 1}, {"x^", 1}, {"x+y*z^-(", 2}};
    for (size_t i = 0; i < sizeof deep / sizeof deep[0]; i++) {
        make_formula(deep[i].part, deep[i].many, strchr(deep[i].part, '(') != NULL);
        size_t used = stack_of(read_formula);
        printf("%-16s  read %zu\n", deep[i].part, used);
        if (used > worst) worst = used;
        idle += met == before;
        before = met;
    }
    printf("at most %zu bytes of stack; %d are allowed\n", worst, MOST);
    if (idle) printf("%zu calls met nothing\n", idle);
    return worst >= MOST || idle != 0;
}
