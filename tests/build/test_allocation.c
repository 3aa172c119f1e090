// SPDX-License-Identifier: MIT
/* No allocation in the library: malloc and its kin are replaced by ones that
 * count (glibc's own are behind them), and the count must not move while rays of
 * every kind run. */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <sagitta/aim.h>
#include <sagitta/diagnose.h>
#include <sagitta/surfaces.h>
#include <sagitta/system.h>

void *__libc_malloc(size_t size);
void *__libc_calloc(size_t count, size_t size);
void *__libc_realloc(void *block, size_t size);
void *__libc_memalign(size_t alignment, size_t size);

static volatile size_t allocations;

void *malloc(size_t size) { allocations++; return __libc_malloc(size); }
void *calloc(size_t count, size_t size) { allocations++; return __libc_calloc(count, size); }
void *realloc(void *block, size_t size) { allocations++; return __libc_realloc(block, size); }
void *aligned_alloc(size_t alignment, size_t size) { allocations++; return __libc_memalign(alignment, size); }

/* splitmix64, as a number in [-1, 1). */
static uint64_t state = 20240229;
static double random_number(void)
{
    uint64_t z = state += 0x9e3779b97f4a7c15u;
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
    z = (z ^ z >> 27) * 0x94d049bb133111ebu;
    return (double)((z ^ z >> 31) >> 11) * 0x1p-52 - 1;
}

/* A user's own: a wavy sheet, that needs a march. */
static double waves(const void *self, sgt_vec3 p, sgt_vec3 *grad)
{
    (void)self;
    if (grad)
        *grad = (sgt_vec3){ -0.3 * cos(p.x), 0.3 * sin(p.y), 1 };
    return p.z - 0.3 * sin(p.x) - 0.3 * cos(p.y);
}
static sgt_span wave_span(const void *self, const sgt_ray *ray)
{
    (void)self;
    double a = (-1 - ray->o.z) / ray->d.z, b = (1 - ray->o.z) / ray->d.z;
    return (sgt_span){ .lo = fmin(a, b), .hi = fmax(a, b), .seed = NAN };
}

static void many_waves(const void *self, size_t n, sgt_points p, sgt_values out)
{
    for (size_t i = 0; i < n; i++) {
        sgt_vec3 grad;
        out.f[i] = waves(self, (sgt_vec3){ p.p[0][i], p.p[1][i], p.p[2][i] }, &grad);
        if (out.grad[0])
            out.grad[0][i] = grad.x, out.grad[1][i] = grad.y, out.grad[2][i] = grad.z;
    }
}
static void many_wave_spans(const void *self, size_t n, sgt_rays rays, sgt_spans out)
{
    for (size_t i = 0; i < n; i++) {
        sgt_ray ray = {
            {rays.o[0][i], rays.o[1][i], rays.o[2][i]}, {rays.d[0][i], rays.d[1][i], rays.d[2][i]}, 0, 0};
        sgt_span span = wave_span(self, &ray);
        out.lo[i] = span.lo, out.hi[i] = span.hi, out.seed[i] = span.seed, out.single[i] = span.single;
    }
}

/* The rays again, many at a time. */
enum { MANY = 300 };
static double in[6][MANY], out[14][MANY];
static sgt_status status[MANY];
static int evals[MANY];

int main(void)
{
    void *volatile counted = malloc(1);
    free(counted);
    if (allocations == 0)
        return puts("the counter does not count"), 1;

    static const sgt_surface_ops wave_ops = { .name = "waves", .value = waves, .span = wave_span };
    static const sgt_surface_ops many_ops = {
        .name = "waves", .value = waves, .span = wave_span, .values = many_waves, .spans = many_wave_spans};
    const sgt_conic mirror = { .c = -0.1, .k = -1 }, lens = { .c = 0.2, .k = -0.6, .semi_diameter = 4 };
    const sgt_even_asphere asphere = {.c = 0.2, .k = -0.6, .semi_diameter = 4, .a = {0, 1e-4, -2e-6, 1e-8}};
    const sgt_julia julia = {.c = {-0.2, 0.8, 0, 0}, .iterations = 8},
                    cubic = {.c = {0.1, 0.3, 0.2, 0}, .iterations = 5, .power = 3};
    const sgt_mandelbrot mandelbrot = { .iterations = 6 };
    const sgt_surface surfaces[] = {
        {&sgt_conic_ops, &mirror},
        {&sgt_conic_ops, &lens},
        {&sgt_even_asphere_ops, &asphere},
        {&wave_ops, NULL},
        {&many_ops, NULL},
        {&sgt_julia_ops, &julia},
        {&sgt_julia_ops, &cubic},
        {&sgt_mandelbrot_ops, &mandelbrot},
    };
    const sgt_element elements[] = {
        {.surface = surfaces[1], .pose = {.origin = {0, 0, 5}}, .index = 1.5, .semi_diameter = 4},
        {.surface = surfaces[2],
         .pose = sgt_pose_tilted((sgt_vec3){0.1, 0, 6}, (sgt_vec3){2, 0, 0}),
         .index = 1},
        {.surface = surfaces[0], .pose = {.origin = {0, 0, 20}}, .index = SGT_MIRROR},
    };
    const char *scale = getenv("SAGITTA_TEST_SCALE");
    const int rays = (int)(20000 * (scale ? atof(scale) : 0.5)) + MANY;
    const size_t before = allocations;
    size_t hits = 0, passed = 0, entries = 0, batches = 0;
    const sgt_rays many = { { in[0], in[1], in[2] }, { in[3], in[4], in[5] }, NULL, NULL };
    const sgt_hits all_hits = {
        status, evals, out[0], out[1], out[2], {out[3], out[4], out[5]}, {out[6], out[7], out[8]},
        out[9], {0}};
    const sgt_passages passage = {all_hits, {out[10], out[11], out[12]}, out[13], {0}},
                       every[3] = {passage, passage, passage};
    const sgt_traced last = { .o = { in[0], in[1], in[2] }, .d = { in[3], in[4], in[5] } };

    for (int i = 0; i < rays; i++) {
        /* Origins from near to far, directions steep and grazing. */
        double far = i % 7 == 0 ? 1e9 : 1;
        sgt_ray ray = { { far * random_number(), 3 * random_number(), -5 * far },
                        { far * random_number(), random_number(), 5 * far + random_number() }, 0, 0 };
        for (size_t s = 0; s < sizeof surfaces / sizeof surfaces[0]; s++) {
            sgt_step steps[20];
            sgt_log log = { steps, 20, 0 };
            sgt_options options = {.pick = i % 2 ? SGT_FIRST : SGT_NEAR_SEED,
                                   .proof = (sgt_proof)(i / 2 % 3),
                                   .watch = i % 3 ? NULL : sgt_log_step,
                                   .watch_data = &log};
            hits += sgt_intersect(surfaces[s], ray, i % 5 ? &options : NULL).status > 0;
            (void)sgt_diagnose(&log);
            sgt_hit all[4];
            if (i % 4 == 0)
                entries += sgt_intersect_all(surfaces[s], ray, i % 8 ? 4 : 0, i % 8 ? all : NULL,
                                             i % 5 ? &options : NULL) > 0;
        }
        sgt_vec3 grad, at = { random_number(), random_number(), random_number() };
        (void)(sgt_julia_potential(&julia, at, &grad) + sgt_mandelbrot_potential(&mandelbrot, at, NULL));
        sgt_passage passages[3];
        sgt_fate fate;
        sgt_ray traced = { { random_number(), random_number(), 0 }, { 0.1 * random_number(), 0, 1 }, 0, 0 };
        passed += sgt_trace(3, elements, 1, &traced, i % 2 ? passages : NULL, &fate, NULL);

        if (i % 50 == 0) {
            const sgt_beam beam = { traced.o, { 1, 0, 0 }, { 0, 1, 0 }, traced.d, { 0, 0, 0 }, { 0, 0, 0 },
                                    { -1, 1 }, { -1, 1 }, { 0 } };
            const sgt_vec2 wanted = { 3 * random_number(), random_number() };
            static double gradient[1000];
            sgt_ray_change weight = { { 1, 0, 0 }, { 0, 1, 0 }, 1 }, change;
            sgt_ray launch = sgt_beam_ray(&beam, 0, 0), end = launch;
            const size_t n = sgt_trace(3, elements, 1, &end, passages, &fate, NULL);
            if (sgt_trace_parameters(n, elements) <= 1000)
                sgt_trace_gradient(n, elements, 1, &launch, passages, 1, &weight, gradient);
            sgt_trace_sensitivity(n, elements, 1, &launch, passages, 1, &weight, &change);
            passed += sgt_aim(2, elements, 1, &beam, wanted, passages, NULL, NULL) == SGT_MET;
        }

        const double number[6] = { ray.o.x, ray.o.y, ray.o.z, ray.d.x, ray.d.y, ray.d.z };
        for (int k = 0; k < 6; k++)
            in[k][i % MANY] = number[k];
        if (i % MANY == MANY - 1) {
            sgt_options options = {.pick = i % 2 ? SGT_FIRST : SGT_NEAR_SEED,
                                   .proof = (sgt_proof)(i / MANY % 3)};
            for (size_t s = 0; s < sizeof surfaces / sizeof surfaces[0]; s++)
                batches += sgt_intersect_batch(surfaces[s], MANY, many, all_hits, &options);
            batches += sgt_trace_batch(3, elements, 1, MANY, many, last, every, &options);
        }
    }
    sgt_ray walk = { { 0.3, 0.2, -5 }, { 0, 0.1, 1 }, 0, 10 };
    for (size_t s = 0; s < sizeof surfaces / sizeof surfaces[0]; s++)
        (void)sgt_check(surfaces[s], 1, &walk, NULL);

    const size_t made = allocations - before;
    printf("%d rays on %zu surfaces, %zu hits, %zu lists, %zu elements passed, %zu hits in batches, %zu "
           "allocations\n",
           rays, sizeof surfaces / sizeof surfaces[0], hits, entries, passed, batches, made);
    return made != 0 || hits == 0 || entries == 0 || passed == 0 || batches == 0;
}
