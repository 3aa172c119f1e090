// SPDX-License-Identifier: MIT
/* The cases whose instructions cost.py counts: ordinary questions, in the ways a user asks them.
 *
 *     cases            asks every case: once not counted (the dynamic linker, the first touch), once in
 *                      `measured`
 *     cases --build    what this program and the library were built by, and the kernels that run here
 *
 * It prints one line for each case, its name and how many rays it has, in the order in which `measured` is
 * called.  Surfaces are those of tests/bench/bench_catalogue.cpp: c = 0.1, k = -0.6, rim 4, departures of
 * 0.01.  Rays come from z = -5, uniform in the disk of radius 2.5, with slopes up to 0.15.  Nothing here
 * calls the C library's mathematics: the rays are the same bits everywhere. */
#include <math.h>
#include <sagitta/aim.h>
#include <sagitta/interval.h>
#include <sagitta/sensitivity.h>
#include <sagitta/surfaces.h>
#include <sagitta/system.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#ifdef __GLIBC__
#include <gnu/libc-version.h>
#endif

#define COUNT_OF(array) (sizeof(array) / sizeof *(array))
#define RIM 4
#define BASE .c = 0.1, .k = -0.6

/* rays: one by one, a small batch, a batch of three tiles and a rest */
enum { ALONE = 40, FEW = 5, MANY = 200 };

/* -------------------------------------------------------------------- the rays */

static uint64_t state = 0x1234567;

static double uniform(double lo, double hi)  /* splitmix64 */
{
    uint64_t z = state += 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return lo + (hi - lo) * ((double)((z ^ (z >> 31)) >> 11) * 0x1p-53);
}

static void in_disk(double radius, double *x, double *y)
{
    do *x = uniform(-radius, radius), *y = uniform(-radius, radius);
    while (*x * *x + *y * *y > radius * radius);
}

static sgt_ray toward_lens(void)
{
    sgt_ray ray = {.o.z = -5};
    in_disk(2.5, &ray.o.x, &ray.o.y);
    double l = uniform(-0.15, 0.15), m = uniform(-0.15, 0.15);
    ray.d = (sgt_vec3){l, m, sqrt(1 - l * l - m * m)};
    return ray;
}

static sgt_ray along_axis(void)
{
    sgt_ray ray = {.o.z = -1, .d.z = 1};
    in_disk(0.5, &ray.o.x, &ray.o.y);
    return ray;
}

static sgt_ray from_vertex(void)
{
    sgt_ray ray = toward_lens();
    ray.o = (sgt_vec3){0, 0, 0};
    return ray;
}

/* Near a surface and not on it: between the heights of what is about. */
static sgt_ray from_nearby(void)
{
    sgt_ray ray = toward_lens();
    ray.o.z = -0.02;
    return ray;
}

static sgt_ray of_picture(void)  /* of the ball of radius 1.2 about the origin, from one eye */
{
    sgt_ray ray = {.o = {1.2, 0.9, -3.2}};
    ray.d = (sgt_vec3){uniform(-1.2, 1.2) - 1.2, uniform(-1.2, 1.2) - 0.9, uniform(-1.2, 1.2) + 3.2};
    return ray;
}

/* ---------------------------------------------------------------- the surfaces */

/* Of both signs, falling. */
static double coefficient(size_t i, double first)
{
    return (i % 3 == 1 ? -first : first) / (1 + 0.5 * (double)i * (double)i);
}

static double list_a[16], wave_a[25], power_a[9], height_a[64 * 64];
/* Initialisers, as a const variable is none to every compiler. */
#define LIST_16 {list_a, 1, 16}
#define LIST_8 {list_a, 1, 8}
#define WAVE_5 {wave_a, 5, 5}
#define POWER_3 {power_a, 3, 3}

static void fill(void)
{
    for (size_t i = 0; i < 16; i++) list_a[i] = coefficient(i, 0.01);
    for (size_t i = 0; i < 25; i++) wave_a[i] = coefficient(i / 5 + i % 5, 0.005);
    double scale[5] = {1, 1.0 / RIM, 1.0 / (RIM * RIM), 1.0 / (RIM * RIM * RIM),
                       1.0 / (RIM * RIM * RIM * RIM)};
    for (size_t i = 0; i < 9; i++) {
        size_t degree = i / 3 + i % 3;
        power_a[i] = degree < 2 ? 0 : coefficient(degree, 0.01) * scale[degree];
    }
    for (int i = 0; i < 64; i++)
        for (int j = 0; j < 64; j++) {
            double x = (j - 31.5) / 30, y = (i - 31.5) / 30;
            height_a[i * 64 + j] = 0.01 * (1 - 2 * x * x - x * y - 0.5 * y * y) + 0.003 * (y - x * x * y);
        }
}

static const sgt_conic conic = {BASE}, conic_rim = {BASE, .semi_diameter = RIM};
static const sgt_even_asphere even = {BASE, .a = {0, 1e-4, -2e-6, 1e-8}},
                         even_rim = {BASE, .semi_diameter = RIM, .a = {0, 1e-4, -2e-6, 1e-8}};
static const sgt_even_asphere plate = {.a = {-3.2e-3, 2e-4}},
                         plate_rim = {.a = {-3.2e-3, 2e-4}, .semi_diameter = RIM};
#define ODD .a = {0, 0, 5e-4, 1e-4, -2e-5, -2e-6, 1e-7, 1e-8}
static const sgt_odd_asphere odd = {BASE, ODD}, odd_rim = {BASE, .semi_diameter = RIM, ODD};
static const sgt_polynomial_xy xy = {BASE, .a = POWER_3}, xy_rim = {BASE, .semi_diameter = RIM, .a = POWER_3};
static const sgt_zernike zernike_rim = {BASE, .semi_diameter = RIM, .norm = RIM, .order = SGT_FRINGE,
                                        .a = LIST_16};
static const sgt_chebyshev chebyshev_rim = {BASE, .semi_diameter = RIM, .norm_x = RIM, .norm_y = RIM,
                                            .a = WAVE_5};
static const sgt_q_con q_con_rim = {BASE, .semi_diameter = RIM, .norm = RIM, .a = LIST_8};
static const sgt_q_bfs q_bfs = {.c = 0.1, .norm = RIM, .a = LIST_8},
                       q_bfs_rim = {.c = 0.1, .semi_diameter = RIM, .norm = RIM, .a = LIST_8};
static sgt_grid grid_rim = {BASE, .semi_diameter = RIM, .step_x = 2.1 * RIM / 63, .step_y = 2.1 * RIM / 63,
                            .z = {height_a, 64, 64}};
static const sgt_surface terms[] = {{&sgt_zernike_ops, &zernike_rim}, {&sgt_even_asphere_ops, &even}};
static const sgt_sum sum_rim = {BASE, .semi_diameter = RIM, .terms = terms, .count = COUNT_OF(terms)};
#define TOROID .c_x = 0.07, .a = {0, 1e-4, -2e-6, 1e-8}
static const sgt_toroidal toroid = {BASE, TOROID}, toroid_rim = {BASE, .semi_diameter = RIM, TOROID};
#define BICONIC .c_x = 0.1, .k_x = -0.6, .c_y = 0.07, .k_y = 0.3
static const sgt_biconic biconic = {BICONIC}, biconic_rim = {BICONIC, .semi_diameter = RIM};
static const sgt_quadric quadric = {{0.05, 0.04, 0.01}, {0.01, 0.005, -0.005}, {0.02, 0.01, -1}, -0.2};
static const sgt_torus torus = {2, 1.5};
static const sgt_ellipsoid ellipsoid = {5, 0.2};
static const sgt_julia julia = {.c = {-0.083, 0, -0.83, -0.025}, .iterations = 7};
static const sgt_julia julia_11 = {.c = {-0.083, 0, -0.83, -0.025}, .iterations = 11};
static const sgt_julia julia_16 = {.c = {0, 1, 0, 0}, .iterations = 16};
static const sgt_mandelbrot mandelbrot = {.iterations = 6};

/* A user's own: the saddle z = a x^2 - b y^2, with less and with more told of it. */
static const struct saddle { double a, b; } saddle = {0.05, 0.03};

static double saddle_value(const void *self, sgt_vec3 p, sgt_vec3 *grad)
{
    const struct saddle *s = self;
    if (grad) *grad = (sgt_vec3){-2 * s->a * p.x, 2 * s->b * p.y, 1};
    return p.z - (s->a * p.x * p.x - s->b * p.y * p.y);
}

static double saddle_rounding(const void *self, sgt_vec3 p)
{
    const struct saddle *s = self;
    return 8 * 0x1p-53 * (fabs(p.z) + s->a * p.x * p.x + s->b * p.y * p.y);
}

static sgt_span saddle_span(const void *self, const sgt_ray *ray)  /* the slab |z| <= 1 */
{
    (void)self;
    double a = (-1 - ray->o.z) / ray->d.z, b = (1 - ray->o.z) / ray->d.z;
    return (sgt_span){.lo = a < b ? a : b, .hi = a < b ? b : a, .seed = 0.5 * (a + b)};
}

static sgt_interval along(double o, double d, sgt_interval t)
{
    return sgt_interval_sum(sgt_interval_of(o), sgt_interval_scaled(t, d));
}

static sgt_interval saddle_enclose(const void *self, const sgt_ray *ray, sgt_interval t, sgt_interval *slope)
{
    const struct saddle *s = self;
    sgt_vec3 o = ray->o, d = ray->d;
    sgt_interval x = along(o.x, d.x, t), y = along(o.y, d.y, t), z = along(o.z, d.z, t);
    sgt_interval ax = sgt_interval_scaled(x, 2 * s->a), by = sgt_interval_scaled(y, 2 * s->b);
    *slope = sgt_interval_sum(sgt_interval_of(d.z), sgt_interval_difference(sgt_interval_scaled(by, d.y),
                                                                            sgt_interval_scaled(ax, d.x)));
    sgt_interval up = sgt_interval_scaled(sgt_interval_square(x), s->a),
                 down = sgt_interval_scaled(sgt_interval_square(y), s->b);
    return sgt_interval_sum(z, sgt_interval_difference(down, up));
}

static void saddle_values(const void *self, size_t n, sgt_points at, sgt_values out)
{
    const struct saddle *s = self;
    const double *restrict x = at.p[0], *restrict y = at.p[1], *restrict z = at.p[2];
    for (size_t i = 0; i < n; i++) out.f[i] = z[i] - (s->a * x[i] * x[i] - s->b * y[i] * y[i]);
    if (out.grad[0])
        for (size_t i = 0; i < n; i++)
            out.grad[0][i] = -2 * s->a * x[i], out.grad[1][i] = 2 * s->b * y[i], out.grad[2][i] = 1;
}

static const sgt_surface_ops saddle_value_ops = {.name = "value", .value = saddle_value};
static const sgt_surface_ops saddle_values_ops = {.name = "span",
                                                  .value = saddle_value,
                                                  .span = saddle_span,
                                                  .rounding = saddle_rounding,
                                                  .values = saddle_values};
static const sgt_surface_ops saddle_enclose_ops = {.name = "enclose",
                                                   .value = saddle_value,
                                                   .span = saddle_span,
                                                   .rounding = saddle_rounding,
                                                   .values = saddle_values,
                                                   .enclose = saddle_enclose};

/* ---------------------------------------------------------------------- a lens */

/* M. Laikin, Lens Design, 4th edition (CRC Press 2007), page 251: examples/lenses/ftheta.yaml.  Of spheres;
 * then each with terms of r^4, r^6, r^8, as even aspheres (without a rim of their own: the clear aperture
 * cuts them) and as odd ones. */
static const struct optic { double radius, thickness, index, semi_diameter; } scan_lens[] = {
    {0, 5, 1, 0.5}, {-2.2136, 0.3, 1.84666, 2.0}, {-2.6575, 0.02, 1, 2.25}, {-5.5022, 0.5292, 1.84666, 2.5},
    {-3.8129, 4.2927, 1, 2.6}, {7.9951, 0.59, 1.84666, 4.05}, {8.3651, 18.0014, 1, 4.0}, {0, 0, 1, 7.2},
};
enum { ELEMENTS = COUNT_OF(scan_lens) };
static sgt_conic lens_conic[ELEMENTS];
static sgt_even_asphere lens_even[ELEMENTS];
static sgt_odd_asphere lens_odd[ELEMENTS];
static sgt_element lens_of_spheres[ELEMENTS], lens_of_aspheres[ELEMENTS], lens_of_odd_aspheres[ELEMENTS];
static sgt_element open_lens[ELEMENTS], clipping_lens[ELEMENTS], ringed_lens[ELEMENTS],
    figured_lens[ELEMENTS];

/* Lists that clip none of the rays, and one that clips half of them. */
static const sgt_vec2 corners[] = {{9, -9}, {9, 9}, {0, 10}, {-9, 9}, {-9, -9}};
static const sgt_aperture_item rings[] = {{.shape = SGT_CIRCLE, .radius = 9, .centre = {0.1, 0}},
                                          {.shape = SGT_ANNULUS, .radius = 9, .inner = 8, .obscuring = true}};
static const sgt_aperture_item figures[] = {{.shape = SGT_RECTANGLE, .half = {9, 9}, .degrees = 30},
                                            {.shape = SGT_POLYGON, .count = 5, .vertices = corners},
                                            {.shape = SGT_SPIDER, .arms = 4, .obscuring = true}};
static const sgt_aperture_item disc = {.shape = SGT_CIRCLE, .radius = 0.35, .obscuring = true};
static const sgt_aperture ring_list = {.count = 2, .items = rings}, disc_list = {.count = 1, .items = &disc},
                          figure_list = {.count = 3, .items = figures};

static void make_lenses(void)
{
    double z = 0;
    for (int i = 0; i < ELEMENTS; i++) {
        const struct optic *o = &scan_lens[i];
        double r = o->semi_diameter, c = o->radius != 0 ? 1 / o->radius : 0, a4 = 0.004 / (r * r * r),
               a6 = -0.002 / (r * r * r * r * r);
        sgt_element e = {.pose.origin.z = z, .index = o->index, .semi_diameter = r};
        lens_conic[i].c = lens_even[i].c = lens_odd[i].c = c;
        lens_of_spheres[i] = lens_of_aspheres[i] = lens_of_odd_aspheres[i] = e;
        lens_of_spheres[i].surface = lens_of_aspheres[i].surface = lens_of_odd_aspheres[i].surface =
            (sgt_surface){&sgt_conic_ops, &lens_conic[i]};
        if (c != 0) {
            lens_even[i].k = lens_odd[i].k = -0.2;
            lens_even[i].a[1] = lens_odd[i].a[3] = a4, lens_even[i].a[2] = lens_odd[i].a[5] = a6;
            lens_of_aspheres[i].surface = (sgt_surface){&sgt_even_asphere_ops, &lens_even[i]};
            lens_of_odd_aspheres[i].surface = (sgt_surface){&sgt_odd_asphere_ops, &lens_odd[i]};
        }
        z += o->thickness;
    }
}

/* The same lens without clear apertures; with one in its middle that stops half of the rays; with lists of
 * apertures at each element. */
static void make_others(const sgt_element *lens)
{
    for (int i = 0; i < ELEMENTS; i++) {
        open_lens[i] = clipping_lens[i] = ringed_lens[i] = figured_lens[i] = lens[i];
        open_lens[i].semi_diameter = 0;
        ringed_lens[i].aperture = &ring_list, figured_lens[i].aperture = &figure_list;
    }
    clipping_lens[ELEMENTS / 2].semi_diameter = 0.42;
}

/* ------------------------------------------------------------------- the asking */

static sgt_ray rays[MANY];
static double in[6][MANY], out[10][MANY], derivatives[12][MANY];
static sgt_status status[MANY];
static sgt_fate fates[MANY];

static void draw(sgt_ray (*ray)(void))
{
    state = 0x1234567;
    for (size_t i = 0; i < MANY; i++) {
        rays[i] = ray();
        const double numbers[6] = {rays[i].o.x, rays[i].o.y, rays[i].o.z,
                                   rays[i].d.x, rays[i].d.y, rays[i].d.z};
        for (int k = 0; k < 6; k++) in[k][i] = numbers[k];
    }
}

static sgt_rays arrays(void) { return (sgt_rays){{in[0], in[1], in[2]}, {in[3], in[4], in[5]}, NULL, NULL}; }
static sgt_hits hits(void)
{
    return (sgt_hits){.status = status,
                      .t = out[0],
                      .t_err = out[1],
                      .p = {out[2], out[3], out[4]},
                      .n = {out[5], out[6], out[7]}};
}

/* What `measured` is given, and how it asks. */
typedef struct subject { sgt_surface surface; const sgt_element *lens; } subject;
typedef void question(const subject *of, size_t n, const sgt_options *opt);

static volatile double seen;

static void alone(const subject *of, size_t n, const sgt_options *opt)
{
    for (size_t i = 0; i < n; i++) seen = sgt_intersect(of->surface, rays[i], opt).t;
}

static void every_root(const subject *of, size_t n, const sgt_options *opt)
{
    sgt_hit met[8];
    for (size_t i = 0; i < n; i++) seen = sgt_intersect_all(of->surface, rays[i], 8, met, opt);
}

static void batch(const subject *of, size_t n, const sgt_options *opt)
{
    sgt_intersect_batch(of->surface, n, arrays(), hits(), opt);
}

/* Straight on from where `batch` has met the surface. */
static void leave_batch(const subject *of, size_t n, const sgt_options *opt)
{
    static double next[4][MANY];
    static sgt_status met[MANY];
    static signed char side[MANY];
    const sgt_starts from = {.p = {out[2], out[3], out[4]}, .n = {out[5], out[6], out[7]},
                             .d = {in[3], in[4], in[5]}};
    const sgt_hits to = {.status = met, .t = next[0], .n = {next[1], next[2], next[3]}};
    sgt_leave_batch(of->surface, n, from, to, side, opt);
}

/* The rays rounded to floats. */
static void batch_of_floats(const subject *of, size_t n, const sgt_options *opt)
{
    static float from[6][MANY], to[8][MANY];
    for (size_t i = 0; i < n; i++)
        for (int k = 0; k < 6; k++) from[k][i] = (float)in[k][i];
    const sgt_rays_f asked = {.o = {from[0], from[1], from[2]}, .d = {from[3], from[4], from[5]}};
    const sgt_hits_f told = {.status = status, .t = to[0], .t_err = to[1],
                             .p = {to[2], to[3], to[4]}, .n = {to[5], to[6], to[7]}};
    sgt_intersect_batch_f(of->surface, n, asked, told, opt);
}

static void batches_of_one(const subject *of, size_t n, const sgt_options *opt)
{
    for (size_t i = 0; i < n; i++) {
        sgt_rays one = arrays();
        for (int j = 0; j < 3; j++) one.o[j] += i, one.d[j] += i;
        sgt_intersect_batch(of->surface, 1, one, hits(), opt);
    }
}

static void differentiate(const subject *of, size_t n, const sgt_options *opt)
{
    (void)opt;
    sgt_jacobian by_o = {0};
    for (int k = 0; k < 3; k++) {
        by_o.t_by_o[k] = derivatives[k];
        for (int j = 0; j < 3; j++) by_o.n_by_o[k][j] = derivatives[3 + 3 * k + j];
    }
    sgt_differentiate_batch(of->surface, n, arrays(), hits(), by_o);
}

static void trace(const subject *of, size_t n, const sgt_options *opt)
{
    for (size_t i = 0; i < n; i++) {
        sgt_passage p[ELEMENTS];
        sgt_ray ray = rays[i];
        sgt_fate fate;
        seen = (double)sgt_trace(ELEMENTS, of->lens, 1, &ray, p, &fate, opt);
    }
}

static void trace_batch(const subject *of, size_t n, const sgt_options *opt)
{
    const sgt_traced end = {.fate = fates, .o = {out[0], out[1], out[2]}, .d = {out[3], out[4], out[5]}};
    sgt_trace_batch(ELEMENTS, of->lens, 1, n, arrays(), end, NULL, opt);
}

static void trace_batch_with_paths(const subject *of, size_t n, const sgt_options *opt)
{
    const sgt_traced end = {.fate = fates, .o = {out[0], out[1], out[2]}, .d = {out[3], out[4], out[5]},
                            .opl = out[6]};
    sgt_trace_batch(ELEMENTS, of->lens, 1, n, arrays(), end, NULL, opt);
}

/* What the functions of aim.h read of many rays. */
static sgt_passages passages[ELEMENTS];

static void trace_batch_with_passages(const subject *of, size_t n, const sgt_options *opt)
{
    static double room[ELEMENTS][12][MANY];
    static sgt_status statuses[ELEMENTS][MANY];
    for (int e = 0; e < ELEMENTS; e++) {
        double(*x)[MANY] = room[e];
        passages[e] = (sgt_passages){.hits = {.status = statuses[e], .t = x[0], .p_err = x[1],
                                              .p = {x[2], x[3], x[4]}, .n = {x[5], x[6], x[7]}},
                                     .direction = {x[8], x[9], x[10]}, .opl = x[11]};
    }
    sgt_trace_batch(ELEMENTS, of->lens, 1, n, arrays(), (sgt_traced){.fate = fates}, passages, opt);
}

/* The passages are those of the case before. */
static void errors(const subject *of, size_t n, const sgt_options *opt)
{
    (void)opt;
    const sgt_end_errors told = {.point = out[0], .path = out[1], .grain = out[2]};
    const sgt_traces traces = {n, arrays(), passages};
    seen = (double)sgt_trace_error_batch(ELEMENTS, of->lens, 1, &traces, told);
}

static void gradient(const subject *of, size_t n, const sgt_options *opt)
{
    (void)opt;
    static double ones[MANY], numbers[MANY], *list[ELEMENTS * 100];
    size_t count = sgt_trace_parameters(ELEMENTS, of->lens);
    for (size_t i = 0; i < COUNT_OF(list); i++) list[i] = numbers;
    for (size_t i = 0; i < n; i++) ones[i] = 1;
    const sgt_ray_changes weight = {.p = {ones, ones, ones}};
    const sgt_traces traces = {n, arrays(), passages};
    if (count <= COUNT_OF(list))
        sgt_trace_gradient_batch(ELEMENTS, of->lens, 1, &traces, 1, &weight, list);
}

/* cost.py counts from the call of this function to its return, and by its name: not inlined, not copied,
 * seen from outside. */
void measured(question *ask, const subject *of, size_t n, const sgt_options *opt);
#if defined(__clang__)
#define AS_IT_IS __attribute__((noinline))
#else
#define AS_IT_IS __attribute__((noinline, noclone))
#endif
AS_IT_IS void measured(question *ask, const subject *of, size_t n, const sgt_options *opt)
{
    ask(of, n, opt);
}

static void ask_case(const char *name, const char *how, question *ask, const subject *of, size_t n,
                     sgt_options opt)
{
    ask(of, n, &opt);
    measured(ask, of, n, &opt);
    printf("%s: %s,%zu\n", name, how, n);
}

static const char *kernels(void)
{
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && __GNUC__ >= 12
    __builtin_cpu_init();
    return __builtin_cpu_supports("x86-64-v4")   ? "x86-64-v4"
           : __builtin_cpu_supports("x86-64-v3") ? "x86-64-v3"
                                                 : "any x86-64";
#else
    return "unknown";
#endif
}

int main(int argc, char **argv)
{
    if (argc > 1 && !strcmp(argv[1], "--build")) {
#ifdef __GLIBC__
        const char *libc = gnu_get_libc_version();
#else
        const char *libc = "none";
#endif
        printf("%s, glibc %s, kernels for %s\n", BUILD, libc, kernels());
        return 0;
    }
    fill(), make_lenses(), sgt_grid_measure(&grid_rim);

    const struct {
        const char *name;
        subject of;
        bool whole;  /* each way of asking; else one ray and a batch */
        sgt_ray (*ray)(void);
    } surfaces[] = {
        {"conic", {{&sgt_conic_ops, &conic}, NULL}, true, toward_lens},
        {"conic with a rim", {{&sgt_conic_ops, &conic_rim}, NULL}, true, toward_lens},
        {"even asphere", {{&sgt_even_asphere_ops, &even}, NULL}, true, toward_lens},
        {"even asphere with a rim", {{&sgt_even_asphere_ops, &even_rim}, NULL}, true, toward_lens},
        {"corrector plate", {{&sgt_even_asphere_ops, &plate}, NULL}, false, toward_lens},
        {"corrector plate with a rim", {{&sgt_even_asphere_ops, &plate_rim}, NULL}, false, toward_lens},
        {"odd asphere", {{&sgt_odd_asphere_ops, &odd}, NULL}, true, toward_lens},
        {"odd asphere with a rim", {{&sgt_odd_asphere_ops, &odd_rim}, NULL}, true, toward_lens},
        {"polynomial xy", {{&sgt_polynomial_xy_ops, &xy}, NULL}, false, toward_lens},
        {"polynomial xy with a rim", {{&sgt_polynomial_xy_ops, &xy_rim}, NULL}, false, toward_lens},
        {"zernike with a rim", {{&sgt_zernike_ops, &zernike_rim}, NULL}, false, toward_lens},
        {"chebyshev with a rim", {{&sgt_chebyshev_ops, &chebyshev_rim}, NULL}, false, toward_lens},
        {"q_con with a rim", {{&sgt_q_con_ops, &q_con_rim}, NULL}, false, toward_lens},
        {"q_bfs", {{&sgt_q_bfs_ops, &q_bfs}, NULL}, false, toward_lens},
        {"q_bfs with a rim", {{&sgt_q_bfs_ops, &q_bfs_rim}, NULL}, false, toward_lens},
        {"grid with a rim", {{&sgt_grid_ops, &grid_rim}, NULL}, false, toward_lens},
        {"sum with a rim", {{&sgt_sum_ops, &sum_rim}, NULL}, false, toward_lens},
        {"toroid", {{&sgt_toroidal_ops, &toroid}, NULL}, false, toward_lens},
        {"toroid with a rim", {{&sgt_toroidal_ops, &toroid_rim}, NULL}, true, toward_lens},
        {"biconic", {{&sgt_biconic_ops, &biconic}, NULL}, false, toward_lens},
        {"biconic with a rim", {{&sgt_biconic_ops, &biconic_rim}, NULL}, true, toward_lens},
        {"quadric", {{&sgt_quadric_ops, &quadric}, NULL}, true, toward_lens},
        {"ellipsoid", {{&sgt_ellipsoid_ops, &ellipsoid}, NULL}, true, toward_lens},
        {"torus", {{&sgt_torus_ops, &torus}, NULL}, true, toward_lens},
        {"julia", {{&sgt_julia_ops, &julia}, NULL}, false, of_picture},
        {"mandelbrot", {{&sgt_mandelbrot_ops, &mandelbrot}, NULL}, false, of_picture},
        {"a user's value", {{&saddle_value_ops, &saddle}, NULL}, false, toward_lens},
        {"a user's span and values", {{&saddle_values_ops, &saddle}, NULL}, true, toward_lens},
        {"a user's enclose", {{&saddle_enclose_ops, &saddle}, NULL}, true, toward_lens},
    };
    const sgt_options first = {0}, near = {.pick = SGT_NEAR_SEED}, proven = {.proof = SGT_PROVE_FIRST};
    for (size_t i = 0; i < COUNT_OF(surfaces); i++) {
        const subject *of = &surfaces[i].of;
        const char *name = surfaces[i].name;
        draw(surfaces[i].ray);
        ask_case(name, "one ray", alone, of, ALONE, first);
        ask_case(name, "a batch", batch, of, MANY, first);
        if (!surfaces[i].whole) continue;
        ask_case(name, "one ray near the seed", alone, of, ALONE, near);
        ask_case(name, "a batch near the seed", batch, of, MANY, near);
        ask_case(name, "a batch of 5", batch, of, FEW, first);
        ask_case(name, "a batch of 1", batches_of_one, of, ALONE, first);
        ask_case(name, "one ray proven", alone, of, ALONE, proven);
        ask_case(name, "a batch proven", batch, of, MANY, proven);
        ask_case(name, "every root", every_root, of, ALONE, first);
        if (!of->surface.ops->second) continue;
        batch(of, MANY, &first);
        ask_case(name, "derivatives by the ray", differentiate, of, MANY, first);
    }
    for (size_t i = 0; i < COUNT_OF(surfaces); i++) { /* from on the surface */
        const subject *of = &surfaces[i].of;
        if (of->surface.ops != &sgt_conic_ops && of->surface.ops != &sgt_even_asphere_ops) continue;
        draw(from_vertex);
        ask_case(surfaces[i].name, "a batch from the vertex", batch, of, MANY, first);
        draw(toward_lens);
        batch(of, MANY, &first);
        ask_case(surfaces[i].name, "a batch that leaves", leave_batch, of, MANY, first);
        ask_case(surfaces[i].name, "a batch of floats", batch_of_floats, of, MANY, first);
    }
    for (size_t i = 0; i < COUNT_OF(surfaces); i++) {
        const subject *of = &surfaces[i].of;
        if (of->surface.ops != &sgt_odd_asphere_ops && of->surface.ops != &sgt_q_bfs_ops) continue;
        draw(from_nearby);
        ask_case(surfaces[i].name, "a batch from nearby", batch, of, MANY, first);
    }
    for (size_t i = 0; i < COUNT_OF(surfaces); i++) { /* what a tolerance ends has to end in the lanes */
        static const double t_tol[] = {1e-3, 1e-6, 1e-12};
        if (!surfaces[i].whole || !sgt_builtin_of(surfaces[i].of.surface)) continue;
        draw(surfaces[i].ray);
        for (size_t k = 0; k < COUNT_OF(t_tol); k++) {
            const sgt_options loose = {.t_tol = t_tol[k]};
            char how[64];
            snprintf(how, sizeof how, "a batch with t_tol %g", t_tol[k]);
            ask_case(surfaces[i].name, how, batch, &surfaces[i].of, MANY, loose);
            snprintf(how, sizeof how, "one ray with t_tol %g", t_tol[k]);
            if (k != 1) ask_case(surfaces[i].name, how, alone, &surfaces[i].of, ALONE, loose);
        }
    }
    for (const sgt_builtin *b = sgt_builtins(); b->type; b++) { /* any other, by its specimen */
        bool named = false;
        for (size_t i = 0; i < COUNT_OF(surfaces); i++) named = named || surfaces[i].of.surface.ops == b->ops;
        const subject of = {{b->ops, b->specimen}, NULL};
        if (named) continue;
        draw(toward_lens);
        ask_case(b->type, "one ray", alone, &of, ALONE, first);
        ask_case(b->type, "a batch", batch, &of, MANY, first);
        ask_case(b->type, "one ray proven", alone, &of, ALONE, proven);
        ask_case(b->type, "a batch proven", batch, &of, MANY, proven);
    }
    const struct { const char *name; subject of; double t_tol[3]; } loose[] = {
        {"julia of 11 levels", {{&sgt_julia_ops, &julia_11}, NULL}, {1e-1, 1e-2, 1e-6}},
        {"julia of 16 levels", {{&sgt_julia_ops, &julia_16}, NULL}, {1e-1, 1e-3, 1e-6}},
    };
    draw(of_picture);
    for (size_t i = 0; i < COUNT_OF(loose); i++) {
        const subject *of = &loose[i].of;
        ask_case(loose[i].name, "a batch", batch, of, MANY, first);
        for (size_t k = 0; k < COUNT_OF(loose[i].t_tol); k++) {
            char how[64];
            snprintf(how, sizeof how, "a batch with t_tol %g", loose[i].t_tol[k]);
            ask_case(loose[i].name, how, batch, of, MANY, (sgt_options){.t_tol = loose[i].t_tol[k]});
        }
    }
    const struct { const char *name; subject of; } lenses[] = {
        {"lens of spheres", {{NULL, NULL}, lens_of_spheres}},
        {"lens of even aspheres", {{NULL, NULL}, lens_of_aspheres}},
        {"lens of odd aspheres", {{NULL, NULL}, lens_of_odd_aspheres}},
    };
    draw(along_axis);
    for (size_t i = 0; i < COUNT_OF(lenses); i++) {
        const subject *of = &lenses[i].of;
        const char *name = lenses[i].name;
        ask_case(name, "a trace", trace, of, ALONE, near);
        ask_case(name, "a trace batch", trace_batch, of, MANY, near);
        ask_case(name, "a trace batch with paths", trace_batch_with_paths, of, MANY, near);
        ask_case(name, "a trace batch with passages", trace_batch_with_passages, of, MANY, near);
        ask_case(name, "a batch of errors", errors, of, MANY, near);
        ask_case(name, "a batch of gradients", gradient, of, MANY, near);
        const subject open = {{NULL, NULL}, open_lens}, clipping = {{NULL, NULL}, clipping_lens};
        make_others(of->lens);
        ask_case(name, "a trace batch without apertures", trace_batch, &open, MANY, near);
        ask_case(name, "a trace batch that loses half", trace_batch, &clipping, MANY, near);
        ask_case(name, "a trace of first roots", trace, of, ALONE, first);
        ask_case(name, "a trace proven", trace, of, ALONE, proven);
        ask_case(name, "a trace batch proven", trace_batch, of, MANY, proven);
        if (i) continue;
        const subject ringed = {{NULL, NULL}, ringed_lens}, figured = {{NULL, NULL}, figured_lens};
        ask_case(name, "a trace with circle and annulus", trace, &ringed, ALONE, near);
        ask_case(name, "a trace batch with circle and annulus", trace_batch, &ringed, MANY, near);
        ask_case(name, "a trace with rectangle and polygon and spider", trace, &figured, ALONE, near);
        ask_case(name, "a trace batch with rectangle and polygon and spider", trace_batch, &figured, MANY,
                 near);
        clipping_lens[ELEMENTS / 2] = lens_of_spheres[ELEMENTS / 2];
        clipping_lens[ELEMENTS / 2].aperture = &disc_list;
        ask_case(name, "a trace batch that loses half to a disc", trace_batch, &clipping, MANY, near);
    }
    return 0;
}
