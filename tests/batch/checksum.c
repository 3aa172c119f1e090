// SPDX-License-Identifier: MIT
/* One number for all that the library answers: builds of it that are meant to agree to the last bit, for
 * other kinds of processors and by other compilers, are compared by it (clones.py).  A NaN counts as a NaN,
 * whichever.
 *
 *     checksum                 a line for each part: its name, how many rays, the sum
 *     checksum PART            a line for each ray of that part, to find the first that differs
 *
 * The parts are all types of sgt_builtins with hostile rays (hostile.h), a lens with a mirror, a tilt, an
 * asphere and apertures, a user's surface in each way the solver treats one, and tilted poses; the Earth's
 * surfaces are in checksum_earth.c.  Of each ray there are the first root (or the one near the seed, proven
 * or not, as the options are drawn), all roots, the batch, with and without what need not be wanted, and
 * the derivatives.  The rays are fixed, on every system: they change with the library where they are aimed
 * by its own answers, and so does the sum.
 *
 * checksum.txt has the sums that are expected (sums.py); platforms/run.py asks other systems for them. */
#include "checksum.h"

#include <sagitta/diagnose.h>
#include <sagitta/system.h>

/* ------------------------------------------------------------ built-in types */

static void add_type(const sgt_builtin *type, generator *g, int rounds, int most)
{
    while (rounds-- > 0) {
        specimen s = random_specimen(g, type);
        sgt_options opt = chance(g, 0.6) ? (sgt_options){0} : hostile_options(g);
        size_t n = (size_t)below(g, most + 1);
        for (size_t i = 0; i < n; i++) {
            rays[i] = i % 2 ? hostile_ray(g, &s) : ordinary_ray(g, &s);
            sgt_vec3 p = rays[i].o, gradient;
            add_number(type->ops->value(&s.with, p, &gradient)), add_vector(gradient);
            if (type->ops->rounding) add_number(type->ops->rounding(&s.with, p));
            if (i % 8) continue;
            if (type->ops == &sgt_julia_ops)
                add_number(sgt_julia_potential(&s.with.julia, p, &gradient)), add_vector(gradient);
            if (type->ops == &sgt_mandelbrot_ops)
                add_number(sgt_mandelbrot_potential(&s.with.mandelbrot, p, &gradient)), add_vector(gradient);
        }
        if (listed) print_specimen(&s), print_options(&opt);
        add_surface(surface_of(&s), n, &opt);
    }
}

/* --------------------------------------------------- a surface of a user's own */

/* A saddle with a dent, z = a x^2 - b y^2 + e / (1 + x^2 + y^2). */
typedef struct saddle { double a, b, e; } saddle;

static double saddle_value(const void *self, sgt_vec3 p, sgt_vec3 *grad)
{
    const saddle *s = self;
    double q = 1 / (1 + p.x * p.x + p.y * p.y), dent = 2 * s->e * q * q;
    if (grad) *grad = (sgt_vec3){p.x * (dent - 2 * s->a), p.y * (dent + 2 * s->b), 1};
    return p.z - (s->a * p.x * p.x - s->b * p.y * p.y + s->e * q);
}

static void saddle_values(const void *self, size_t n, sgt_points at, sgt_values out)
{
    for (size_t i = 0; i < n; i++) {
        sgt_vec3 grad;
        out.f[i] = saddle_value(self, (sgt_vec3){at.p[0][i], at.p[1][i], at.p[2][i]}, &grad);
        if (out.grad[0]) out.grad[0][i] = grad.x, out.grad[1][i] = grad.y, out.grad[2][i] = grad.z;
    }
}

static double saddle_rounding(const void *self, sgt_vec3 p)
{
    const saddle *s = self;
    return 16 * 0x1p-53 * (fabs(p.z) + fabs(s->a) * p.x * p.x + fabs(s->b) * p.y * p.y + fabs(s->e));
}

/* The slab |z| <= 3: what lies outside it is not of interest. */
static sgt_span saddle_span(const void *self, const sgt_ray *ray)
{
    (void)self;
    double a = (-3 - ray->o.z) / ray->d.z, b = (3 - ray->o.z) / ray->d.z;
    return (sgt_span){.lo = a < b ? a : b, .hi = a < b ? b : a, .seed = 0.5 * (a + b)};
}

static void saddle_spans(const void *self, size_t n, sgt_rays r, sgt_spans out)
{
    for (size_t i = 0; i < n; i++) {
        sgt_ray ray = {{r.o[0][i], r.o[1][i], r.o[2][i]}, {r.d[0][i], r.d[1][i], r.d[2][i]}, 0, 0};
        sgt_span span = saddle_span(self, &ray);
        out.lo[i] = span.lo, out.hi[i] = span.hi, out.seed[i] = span.seed, out.single[i] = span.single;
    }
}

static sgt_span saddle_span_single(const void *self, const sgt_ray *ray)
{
    sgt_span span = saddle_span(self, ray);
    span.single = fabs(ray->d.x) + fabs(ray->d.y) < 0.2 * fabs(ray->d.z);
    return span;
}

static void saddle_spans_single(const void *self, size_t n, sgt_rays r, sgt_spans out)
{
    for (size_t i = 0; i < n; i++) {
        sgt_ray ray = {{r.o[0][i], r.o[1][i], r.o[2][i]}, {r.d[0][i], r.d[1][i], r.d[2][i]}, 0, 0};
        sgt_span span = saddle_span_single(self, &ray);
        out.lo[i] = span.lo, out.hi[i] = span.hi, out.seed[i] = span.seed, out.single[i] = span.single;
    }
}

/* |grad F| <= sqrt(1 + (slope of the sheet)^2) within the slab's neighbourhood. */
static double saddle_clearance(const void *self, sgt_vec3 p) { return fabs(saddle_value(self, p, NULL)) / 4; }

static const saddle dented = {0.2, 0.1, 0.7};
static const sgt_surface_ops saddles[] = {
    {.name = "value", .value = saddle_value},
    {.name = "span", .value = saddle_value, .span = saddle_span, .rounding = saddle_rounding},
    {.name = "values", .value = saddle_value, .values = saddle_values, .rounding = saddle_rounding},
    {.name = "spans",
     .value = saddle_value,
     .span = saddle_span,
     .values = saddle_values,
     .spans = saddle_spans},
    {.name = "single",
     .value = saddle_value,
     .span = saddle_span_single,
     .rounding = saddle_rounding,
     .values = saddle_values,
     .spans = saddle_spans_single},
    {.name = "clearance",
     .value = saddle_value,
     .span = saddle_span,
     .clearance = saddle_clearance,
     .values = saddle_values,
     .spans = saddle_spans},
};

static void add_own_surface(generator *g, int rounds)
{
    const specimen like = {.type = sgt_builtins(), .size = 2, .sag = true};
    while (rounds-- > 0) {
        sgt_surface s = {&saddles[below(g, COUNT_OF(saddles))], &dented};
        sgt_options opt = chance(g, 0.6) ? (sgt_options){0} : hostile_options(g);
        size_t n = (size_t)below(g, BATCH + 1);
        for (size_t i = 0; i < n; i++) rays[i] = i % 4 == 3 ? hostile_ray(g, &like) : ordinary_ray(g, &like);
        if (listed) printf("    %s\n", s.ops->name), print_options(&opt);
        add_surface(s, n, &opt);
        sgt_vec3 where = {0, 0, 0};
        add_bits((uint64_t)sgt_check(s, n < 8 ? n : 8, rays, &where)), add_vector(where);
    }
}

/* -------------------------------------------------------------------- a lens */

/* A constant of the program with the address of a table that may lie in a DLL (sagitta.h). */
static const sgt_conic front = {.c = 0.05};
static const sgt_surface front_surface = {&sgt_conic_ops, &front};

static void add_lens(generator *g, int rounds)
{
    const sgt_conic back = {.c = -0.03, .k = -0.6}, flat = {0}, mirror = {.c = -0.02, .k = -1};
    const sgt_even_asphere corrector = {.c = 0.01, .k = -1, .semi_diameter = 9, .a = {0, 1e-5, -2e-8, 1e-11}};
    const sgt_element e[] = {
        {.surface = front_surface, .pose = {.origin = {0, 0, 5}}, .index = 1.62, .semi_diameter = 8},
        {.surface = {&sgt_conic_ops, &back}, .pose = {.origin = {0, 0, 9}}, .index = 1, .semi_diameter = 8},
        {.surface = {&sgt_conic_ops, &flat},
         .pose = sgt_pose_tilted((sgt_vec3){0, 0.1, 12}, (sgt_vec3){2, -3, 10}),
         .semi_diameter = 5},
        {.surface = {&sgt_even_asphere_ops, &corrector}, .pose = {.origin = {0, 0, 15}}, .index = 1.5},
        {.surface = {&saddles[3], &dented},
         .pose = sgt_pose_tilted((sgt_vec3){0, 0, 20}, (sgt_vec3){0, 5, 0}),
         .index = 1},
        {.surface = {&sgt_conic_ops, &mirror},
         .pose = {.origin = {0, 0, 40}},
         .index = SGT_MIRROR,
         .semi_diameter = 30},
        {.surface = {&sgt_even_asphere_ops, &corrector},
         .pose = sgt_pose_tilted((sgt_vec3){0, 0, 30}, (sgt_vec3){0, 90, 0}),
         .index = 1.8},
        {.surface = {&sgt_conic_ops, &flat}, .pose = {.origin = {0, 0, 2}}, .index = 1},
    };
    enum { ELEMENTS = COUNT_OF(e) };
    static hit_arrays met[ELEMENTS];
    static double direction[ELEMENTS][3][BATCH], opl[ELEMENTS][BATCH], end[7][BATCH];
    static sgt_fate fates[BATCH];
    static int passed[BATCH];
    const specimen like = {.type = sgt_builtins(), .size = 8, .sag = true};
    sgt_passages recorded[ELEMENTS];
    for (int j = 0; j < ELEMENTS; j++)
        recorded[j] = (sgt_passages){
            pointers(&met[j]), {direction[j][0], direction[j][1], direction[j][2]}, opl[j], {0}};
    const sgt_traced out = {.fate = fates,
                            .passed = passed,
                            .o = {end[0], end[1], end[2]},
                            .d = {end[3], end[4], end[5]},
                            .opl = end[6]};

    while (rounds-- > 0) {
        size_t n = (size_t)below(g, BATCH + 1),
               elements = chance(g, 0.7) ? ELEMENTS : (size_t)below(g, ELEMENTS + 1);
        sgt_options opt = chance(g, 0.7) ? (sgt_options){0} : hostile_options(g);
        double index = chance(g, 0.8) ? 1 : chance(g, 0.8) ? 1.9 : hostile_number(g);
        for (size_t i = 0; i < n; i++) rays[i] = i % 4 == 3 ? hostile_ray(g, &like) : ordinary_ray(g, &like);
        if (listed) printf("    %zu elements, index %a\n", elements, index), print_options(&opt);
        for (size_t i = 0; i < n; i++) {
            sgt_passage p[ELEMENTS];
            sgt_fate fate;
            sgt_ray ray = rays[i];
            size_t through = sgt_trace(elements, e, index, &ray, p, &fate, &opt);
            add_bits((uint64_t)through << 32 | (uint64_t)(fate - SGT_LOST)), add_vector(ray.o),
                add_vector(ray.d);
            for (size_t j = 0; j < through; j++)
                add_hit(&p[j].hit), add_vector(p[j].direction), add_number(p[j].opl);
            list_ray(&rays[i], "traced alone");
        }
        bool told = chance(g, 0.5);
        add_bits(sgt_trace_batch(elements, e, index, n, as_arrays(n), out, told ? recorded : NULL, &opt));
        for (size_t i = 0; i < n; i++) {
            add_bits((uint64_t)passed[i] << 32 | (uint64_t)(fates[i] - SGT_LOST));
            for (int j = 0; j < 7; j++) add_number(end[j][i]);
            for (size_t j = 0; told && j < elements; j++) {
                add_arrays(&met[j], i), add_number(opl[j][i]);
                for (int k = 0; k < 3; k++) add_number(direction[j][k][i]);
            }
            list_ray(&rays[i], told ? "traced in a batch, each element told" : "traced in a batch");
        }
    }
}

/* -------------------------------------------------------------------- floats */

/* Conics and aspheres of any kind, asked in single precision. */
static void add_floats(generator *g, int rounds)
{
    static float columns[8][BATCH], of[9][BATCH];
    static sgt_status status[BATCH];
    const sgt_rays_f from = {{columns[0], columns[1], columns[2]}, {columns[3], columns[4], columns[5]},
                             columns[6], columns[7]};
    const sgt_hits_f to = {.status = status, .t = of[0], .t_err = of[1], .p = {of[2], of[3], of[4]},
                           .n = {of[5], of[6], of[7]}, .p_err = of[8]};
    while (rounds-- > 0) {
        specimen s = random_specimen(g, &sgt_builtins()[below(g, 4)]);
        const sgt_options opt = {.pick = chance(g, 0.5) ? SGT_FIRST : SGT_NEAR_SEED};
        size_t n = (size_t)below(g, BATCH + 1);
        for (size_t i = 0; i < n; i++) rays[i] = i % 8 ? ordinary_ray(g, &s) : hostile_ray(g, &s);
        const sgt_rays in_double = as_arrays(n);
        for (size_t i = 0; i < n; i++)
            for (int j = 0; j < 3; j++)
                columns[j][i] = (float)in_double.o[j][i], columns[3 + j][i] = (float)in_double.d[j][i];
        for (size_t i = 0; i < n; i++)
            columns[6][i] = (float)in_double.tmin[i], columns[7][i] = (float)in_double.tmax[i];
        add_bits(sgt_intersect_batch_f(surface_of(&s), n, from, to, &opt));
        for (size_t i = 0; i < n; i++) {
            add_bits((uint64_t)(status[i] - SGT_INVALID));
            for (int j = 0; j < 9; j++) add_number((double)of[j][i]);
            list_ray(&rays[i], "in floats");
        }
    }
}

/* ------------------------------------------------------------------- poses */

static void add_poses(generator *g, int rounds)
{
    while (rounds-- > 0) {
        double *place, whole = 15.0 * (below(g, 49) - 24);
        sgt_vec3 origin = random_vector(g), degrees = random_direction(g);
        degrees = times(any_scale(g, -10, 5), degrees);
        if (chance(g, 0.3)) degrees.x = whole;
        if (chance(g, 0.3)) degrees.y = whole, degrees.z = -whole;
        place = chance(g, 0.5) ? &degrees.x : &degrees.z;
        if (chance(g, 0.02)) *place = hostile_number(g);
        sgt_pose pose = sgt_pose_tilted(origin, degrees);
        add_vector(pose.origin), add_vector(pose.ex), add_vector(pose.ey), add_vector(pose.ez);
        list_ray(&(sgt_ray){.o = origin, .d = degrees}, "turned by so many degrees");
    }
}

/* ---------------------------------------------------------------------------- */

static void part_of_type(const sgt_builtin *b, generator *g, double scale, int argc, char **argv)
{
    generator own = {random_bits(g)};
    bool sag = param_of(b, "semi_diameter") != NULL, dear = !answers_itself(b); /* these march by intervals */
    if (begin(b->type, argc, argv))
        add_type(b, &own, (int)((sag && !dear ? 150 : 40) * scale) + 1, dear ? 100 : BATCH), end(b->type);
}

int main(int argc, char **argv)
{
    /* Types that came later are behind all else: a new one, at the end of the list, changes no other sum. */
    enum { FIRST_TYPES = 20 };
    generator g = {test_seed(2)};
    double scale = test_scale();
    for (int i = 0; i < FIRST_TYPES; i++) part_of_type(&sgt_builtins()[i], &g, scale, argc, argv);
    generator own = {random_bits(&g)}, lens = {random_bits(&g)}, poses = {random_bits(&g)};
    if (begin("own surface", argc, argv)) add_own_surface(&own, (int)(60 * scale) + 1), end("own surface");
    if (begin("lens", argc, argv)) add_lens(&lens, (int)(60 * scale) + 1), end("lens");
    if (begin("poses", argc, argv)) add_poses(&poses, (int)(1000 * scale) + 1), end("poses");
    for (const sgt_builtin *b = &sgt_builtins()[FIRST_TYPES]; b->type; b++)
        part_of_type(b, &g, scale, argc, argv);
    generator floats = {random_bits(&g)};
    if (begin("floats", argc, argv)) add_floats(&floats, (int)(200 * scale) + 1), end("floats");
    return 0;
}
