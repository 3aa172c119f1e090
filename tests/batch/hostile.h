// SPDX-License-Identifier: MIT
/* hostile.h - surfaces, rays and options made to break a batch; answers compared by their bits.
 *
 * A batch must give each ray the answer that sgt_intersect gives it alone, so what is wanted here is not
 * rays that are likely but rays that are unlike each other: every way a quick form can be left for the
 * careful one, every way a ray is no ray at all, and these side by side in one register.
 *
 *   surfaces   each type of sgt_builtins by sets chosen by hand, by random sets of its kind or by its row
 *              alone (lists, tables
 *              and terms too), and by any legal (and now and then illegal) number in each parameter of its
 *                  row;
 *   rays       by kind, see ray_kinds; points to aim at are taken from the surface itself;
 *   ends       none, all, at a root to the ulp, reversed, NaN.
 *
 * The generator is its own (splitmix64).  A seed means the same case on every system, as long as the
 * library aims alike: numbers are made by whole numbers, sums, products, quotients and square roots alone,
 * nothing of the C library's mathematics, and no two draws stand in one expression whose order C leaves
 * open (arguments, operands, initialisers). */
#ifndef TESTS_BATCH_HOSTILE_H
#define TESTS_BATCH_HOSTILE_H

#include <float.h>
#include <math.h>
#include <sagitta/surfaces.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#if defined(__GNUC__)
#define UNUSED __attribute__((unused))
#else
#define UNUSED
#endif

#define COUNT_OF(array) (sizeof(array) / sizeof *(array))

static const double NOT = (double)NAN, FAR = HUGE_VAL;

/* ------------------------------------------------------------ random numbers */

typedef struct generator { uint64_t state; } generator;

static UNUSED uint64_t random_bits(generator *g)
{
    uint64_t z = (g->state += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

static UNUSED double uniform(generator *g, double lo, double hi)
{
    return lo + (hi - lo) * ((double)(random_bits(g) >> 11) * 0x1p-53);
}
static UNUSED int below(generator *g, int n) { return (int)(random_bits(g) % (uint64_t)n); }
static UNUSED bool chance(generator *g, double p) { return uniform(g, 0, 1) < p; }
static UNUSED double either_sign(generator *g) { return chance(g, 0.5) ? 1 : -1; }

/* 10^x to some ulps, |x| < 400.  exp(u) by its series: u <= log(10) / 16 = 0.144, and u^10 / 10! < 2^-49. */
static UNUSED double power_of_ten(double x)
{
    int whole = (int)x - (x < 0);
    double u = (x - whole) * (2.302585092994046 / 16), y = 1;
    for (int i = 9; i > 0; i--) y = 1 + u / i * y;
    for (int i = 0; i < 4; i++) y *= y;
    for (; whole > 0; whole--) y *= 10;
    for (; whole < 0; whole++) y /= 10;
    return y;
}

/* x^n. */
static UNUSED double whole_power(double x, int n)
{
    double y = 1;
    for (int i = n < 0 ? -n : n; i > 0; i--) y *= x;
    return n < 0 ? 1 / y : y;
}

/* A power of ten from 10^lo to 10^hi, not a round one; the same of either sign. */
static UNUSED double any_scale(generator *g, double lo, double hi)
{
    return power_of_ten(uniform(g, lo, hi));
}

static UNUSED double signed_scale(generator *g, double lo, double hi)
{
    double sign = either_sign(g);
    return sign * any_scale(g, lo, hi);
}

static UNUSED double from_bits(uint64_t bits)
{
    double x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

static UNUSED uint64_t bits_of(double x)
{
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}

/* x moved by n ulps, to an infinity and no farther: doubles of one sign are in the order of their bits. */
static UNUSED double ulps(double x, int n)
{
    const int64_t infinity = 0x7ff0000000000000;
    if (x != x) return x;
    int64_t place = (int64_t)(bits_of(x) & 0x7fffffffffffffff);
    if (bits_of(x) >> 63) place = -place;
    place += n;
    if (place > infinity) place = infinity;
    if (place < -infinity) place = -infinity;
    return place < 0 ? -from_bits((uint64_t)-place) : from_bits((uint64_t)place);
}

/* A number that no formula likes. */
static UNUSED double hostile_number(generator *g)
{
    static const double bad[] = {
        0,       -0.0,     0x1p-1074,   -0x1p-1074,  0x1p-1060, 0x1p-1022, -0x1p-1023, 0x1p-1000, 1e-300,
        -1e-200, 1e-160,   1e-154,      1e-16,       -1e-8,     1,         -1,         1e8,       1e15,
        -1e16,   1e75,     1e100,       -1e150,      1e154,     1e155,     -1e200,     1e300,     -1e300,
        DBL_MAX, -DBL_MAX, (double)NAN, (double)NAN, HUGE_VAL,  -HUGE_VAL,
    };
    if (chance(g, 0.2)) return from_bits(random_bits(g));
    return bad[below(g, COUNT_OF(bad))];
}

static UNUSED uint64_t test_seed(uint64_t standard)
{
    const char *text = getenv("SAGITTA_TEST_SEED");
    return text ? strtoull(text, NULL, 0) : standard;
}

static UNUSED double test_scale(void)
{
    const char *text = getenv("SAGITTA_TEST_SCALE");
    return text ? atof(text) : 0.5;
}

/* ------------------------------------------------------------------ vectors */

static UNUSED sgt_vec3 sum(sgt_vec3 a, sgt_vec3 b) { return (sgt_vec3){a.x + b.x, a.y + b.y, a.z + b.z}; }
static UNUSED sgt_vec3 difference(sgt_vec3 a, sgt_vec3 b)
{
    return (sgt_vec3){a.x - b.x, a.y - b.y, a.z - b.z};
}
static UNUSED sgt_vec3 times(double k, sgt_vec3 a) { return (sgt_vec3){k * a.x, k * a.y, k * a.z}; }
static UNUSED double dot(sgt_vec3 a, sgt_vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

/* A point of the cube about the origin whose edge is 2. */
static UNUSED sgt_vec3 random_vector(generator *g)
{
    double x = uniform(g, -1, 1), y = uniform(g, -1, 1), z = uniform(g, -1, 1);
    return (sgt_vec3){x, y, z};
}

static UNUSED sgt_vec3 random_direction(generator *g)
{
    for (;;) {
        sgt_vec3 v = random_vector(g);
        double n2 = dot(v, v);
        if (n2 > 1e-2 && n2 < 1) return times(1 / sqrt(n2), v);
    }
}

/* A direction across the axis. */
static UNUSED sgt_vec3 random_radius(generator *g)
{
    for (;;) {
        sgt_vec3 v = random_vector(g);
        v.z = 0;
        double n2 = dot(v, v);
        if (n2 > 1e-2 && n2 < 1) return times(1 / sqrt(n2), v);
    }
}

static UNUSED sgt_vec3 random_vector_of(generator *g, double lo, double hi)
{
    double length = uniform(g, lo, hi);
    return times(length, random_direction(g));
}

/* ----------------------------------------------------------------- surfaces */

typedef union parameters {
    sgt_conic conic;
    sgt_even_asphere asphere;
    sgt_julia julia;
    sgt_mandelbrot mandelbrot;
    unsigned char byte[512];
} parameters;

/* A surface, how large it is, and points on it to aim at with the gradient there. */
enum { ANCHORS = 8 };
/* A row that answers by itself, and has sets chosen by hand below; the others are met by their operations,
 * `values` among them. */
static UNUSED bool answers_itself(const sgt_builtin *row) { return !row->ops->values; }

typedef struct specimen {
    const sgt_builtin *type;
    parameters with;
    double size;
    bool sag;                            /* F = z - s(x, y): points are cheap */
    sgt_vec3 anchor[ANCHORS], normal[ANCHORS];
} specimen;

static UNUSED sgt_surface surface_of(const specimen *s) { return (sgt_surface){s->type->ops, &s->with}; }

#define PLANE(...) {"plane", {.conic = {__VA_ARGS__}}}
#define SPHERE(...) {"sphere", {.conic = {__VA_ARGS__}}}
#define CONIC(...) {"conic", {.conic = {__VA_ARGS__}}}
#define ASPHERE(...) {"even_asphere", {.asphere = {__VA_ARGS__}}}
#define JULIA(...) {"julia", {.julia = {__VA_ARGS__}}}
#define MANDELBROT(...) {"mandelbrot", {.mandelbrot = {__VA_ARGS__}}}
#define TURNED .ex = {0.8, 0, 0.6, 0}, .ey = {0, 1, 0, 0}, .ez = {-0.6, 0, 0.8, 0}
#define OBLIQUE .ex = {1, 0.2, 0, 0.1}, .ey = {0.1, 0.9, 0.1, 0}, .ez = {0, 0.2, 0.8, 0.3}
#define GROWN(k) .ex = {k, 0, 0, 0}, .ey = {0, k, 0, 0}, .ez = {0, 0, k, 0}

static const struct chosen { const char *type; parameters with;
} chosen[] = {
    PLANE(0),
    PLANE(.semi_diameter = 5),
    PLANE(.semi_diameter = 1e-3),
    PLANE(.c = -0.0, .semi_diameter = 12.5),
    PLANE(.semi_diameter = 1e150),
    PLANE(.semi_diameter = 1e151),
    PLANE(.semi_diameter = 1e-150),
    PLANE(.semi_diameter = 0x1p-1074),
    PLANE(.semi_diameter = NAN),
    PLANE(.semi_diameter = HUGE_VAL),
    PLANE(.semi_diameter = -1),

    SPHERE(.c = 0.1),
    SPHERE(.c = -0.1),
    SPHERE(.c = 0.1, .semi_diameter = 4),
    SPHERE(.c = -1, .semi_diameter = 0.5),
    SPHERE(.c = 0.1, .semi_diameter = 10),
    SPHERE(.c = 0.1, .semi_diameter = 9.999999999),
    SPHERE(.c = 0.1, .semi_diameter = 11),
    SPHERE(.c = 1),
    SPHERE(.c = 1e-12),
    SPHERE(.c = -1e12),
    SPHERE(.c = 1e-150),
    SPHERE(.c = 1e-300),
    SPHERE(.c = 1e150),
    SPHERE(.c = -1e300),
    SPHERE(.c = 0x1p-1074),
    SPHERE(.c = DBL_MAX),
    SPHERE(.c = 0x1p-1022),
    SPHERE(.c = NAN),
    SPHERE(.c = HUGE_VAL),
    SPHERE(.c = -HUGE_VAL, .semi_diameter = 1),
    SPHERE(.c = 0.1, .semi_diameter = NAN),
    SPHERE(.c = 1e-9, .semi_diameter = 1e150),

    CONIC(.c = 0.1, .k = -1),
    CONIC(.c = 0.1, .k = -0.6),
    CONIC(.c = 0.1, .k = -0.6, .semi_diameter = 4),
    CONIC(.c = -0.05, .k = -1, .semi_diameter = 30),
    CONIC(.c = 0.1, .k = -4),
    CONIC(.c = -0.1, .k = -2.25, .semi_diameter = 8),
    CONIC(.c = 0.1, .k = 1),
    CONIC(.c = 0.1, .k = 3, .semi_diameter = 5),
    CONIC(.c = 0.1, .k = 3, .semi_diameter = 4.9),
    CONIC(.c = 1, .k = 1e3),
    CONIC(.c = 0.2, .k = -1e3),
    CONIC(.c = 0.1, .k = -1 + 1e-12),
    CONIC(.c = 0.1, .k = -1 - 1e-12),
    CONIC(.c = 0.1, .k = -1.0000000000000002),
    CONIC(.c = 0.1, .k = 1e-300),
    CONIC(.c = 1e-5, .k = 1e12),
    CONIC(.c = 1, .k = -1e20),
    CONIC(.c = 1e-3, .k = 1e300),
    CONIC(.c = 1e-3, .k = -1e300),
    CONIC(.c = 1e-200, .k = 1e200),
    CONIC(.c = 1e100, .k = -1e100),
    CONIC(.c = 0.1, .k = DBL_MAX),
    CONIC(.c = 0, .k = NAN),
    CONIC(.c = 0.1, .k = NAN),
    CONIC(.c = 0.1, .k = HUGE_VAL),
    CONIC(.c = 0, .k = 1e300, .semi_diameter = 3),
    CONIC(.c = 0.1, .k = -0.5, .semi_diameter = 1e-145),

    ASPHERE(.c = 0.1, .k = -0.6, .semi_diameter = 4, .a = {0, 1e-4, -2e-6, 1e-8}),
    ASPHERE(.c = 0.1, .k = -0.6, .a = {0, 1e-4, -2e-6, 1e-8}),
    ASPHERE(.c = 0.1, .k = -0.6, .semi_diameter = 4, .a = {1e-4, -2e-6, 1e-8}),
    ASPHERE(.c = -0.02, .semi_diameter = 12, .a = {0, -3e-6}),
    ASPHERE(.c = 0.1, .k = -0.6, .semi_diameter = 4),
    ASPHERE(.c = 0.1, .k = 1),
    ASPHERE(.semi_diameter = 5),
    ASPHERE(.a = {0.1}),
    ASPHERE(.a = {0.1}, .semi_diameter = 3),
    ASPHERE(.a = {0, 0.2}),
    ASPHERE(.a = {-1, 0.5}, .semi_diameter = 2),
    ASPHERE(.a = {0, 1, -0.6, 0.1}, .semi_diameter = 2),
    ASPHERE(.c = 0.5, .k = 2, .a = {0.3, -0.4, 0.2}),
    ASPHERE(.c = 0.02, .k = -3, .semi_diameter = 10,
            .a = {1e-3, -2e-5, 3e-7, -4e-9, 2e-11, -1e-13, 3e-16, -1e-18}),
    ASPHERE(.c = 0.02, .k = -3, .a = {1e-3, -2e-5, 3e-7, -4e-9, 2e-11, -1e-13, 3e-16, -1e-18}),
    ASPHERE(.c = 1, .semi_diameter = 0.99, .a = {1, -3, 5, -7, 9, -11, 13, -15}),
    ASPHERE(.c = 0.1, .semi_diameter = 10, .a = {0, 1e-5}),
    ASPHERE(.c = 0.1, .semi_diameter = 4, .a = {0, 0, 0, 0, 0, 0, 0, 1e-12}),
    ASPHERE(.semi_diameter = 1, .a = {0, 0, 0, 0, 0, 0, 0, 1}),
    ASPHERE(.c = 0.1, .k = -1, .a = {0, -1e-3}),
    ASPHERE(.c = 1e-3, .semi_diameter = 100, .a = {0, 1e-8, 0, 1e-16}),
    ASPHERE(.c = 0.1, .semi_diameter = 4, .a = {-0.05}),
    ASPHERE(.c = 0.1, .k = -1, .semi_diameter = 4, .a = {-0.05}),
    ASPHERE(.c = 0.1, .a = {1e300}),
    ASPHERE(.c = 0.1, .a = {1e-300, 1e-310}),
    ASPHERE(.c = 1e300, .a = {0, 1e-4}),
    ASPHERE(.c = 1e-300, .semi_diameter = 2, .a = {1e-2, 1e-3, 1e-4}),
    ASPHERE(.c = 0.1, .a = {0, 0, 0, 0, 0, 0, 0, NAN}),
    ASPHERE(.c = 0.1, .a = {HUGE_VAL}),
    ASPHERE(.c = NAN, .a = {0, 1e-4}),
    ASPHERE(.c = 0.1, .k = -HUGE_VAL, .a = {0, 1e-4}),
    ASPHERE(.c = 0.1, .semi_diameter = -4, .a = {0, 1e-4}),
    ASPHERE(.c = 0.1, .semi_diameter = 1e151, .a = {0, 1e-4}),
    ASPHERE(.c = 0.1, .k = -0.6, .semi_diameter = 1e-3, .a = {0, 1e-4, -2e-6, 1e-8}),

    JULIA(.c = {-0.083, 0, -0.83, -0.025}, .iterations = 7),
    JULIA(.iterations = 0),
    JULIA(.c = {-0.2, 0.8, 0, 0}, .iterations = 1),
    JULIA(.c = {-0.2, 0.8, 0, 0}, .iterations = 2),
    JULIA(.c = {-0.2, 0.8, 0, 0}, .iterations = 3),
    JULIA(.c = {-0.2, 0.8, 0, 0}, .iterations = 12),
    JULIA(.c = {-1, 0.2, 0, 0}, .iterations = 9, .at = {0, 0, 0, 0.2}),
    JULIA(.c = {-0.291, -0.399, 0.339, 0.437}, .iterations = 8),
    JULIA(.c = {0.1, 0.3, 0.2, 0}, .iterations = 5, .power = 3),
    JULIA(.c = {0.5, 0.4, 0, 0.1}, .iterations = 4, .power = 8),
    JULIA(.c = {-0.2, 0.4, -0.4, -0.4}, .iterations = 6, TURNED),
    JULIA(.c = {-0.2, 0.4, -0.4, -0.4}, .iterations = 5, OBLIQUE, .at = {0.1, 0, 0, 0.1}),
    JULIA(.c = {-1, 0, 0, 0}, .iterations = 6, GROWN(1e-3)),
    JULIA(.c = {-1, 0, 0, 0}, .iterations = 6, GROWN(1e60)),
    JULIA(.c = {-0.7, 0.3, 0, 0}, .iterations = 5, .escape = 1e6),
    JULIA(.c = {-0.7, 0.3, 0, 0}, .iterations = 8, .escape = 4),
    JULIA(.c = {1e6, 0, 0, 0}, .iterations = 2),
    JULIA(.c = {0.3, 0, 0, 0}, .iterations = 40),
    JULIA(.iterations = 10001),
    JULIA(.c = {0.26, 0, 0, 0}, .iterations = 101),
    JULIA(.c = {0.2501, 0, 0, 0}, .iterations = 300, .at = {0, 0, 0, 0.01}),
    JULIA(.power = 9),
    JULIA(.iterations = -1),
    JULIA(.c = {NAN}),
    JULIA(.escape = 0.5),
    JULIA(.ex = {1}, .ey = {2}, .ez = {0, 0, 1}),
    JULIA(.c = {0, HUGE_VAL}),
    JULIA(.at = {NAN}),

    MANDELBROT(.iterations = 6),
    MANDELBROT(.iterations = 0),
    MANDELBROT(.iterations = 1),
    MANDELBROT(.iterations = 2),
    MANDELBROT(.iterations = 12),
    MANDELBROT(.iterations = 9, .at = {0, 0, 0, 0.1}),
    MANDELBROT(.iterations = 5, .power = 3),
    MANDELBROT(.iterations = 4, .power = 8),
    MANDELBROT(.iterations = 7, TURNED),
    MANDELBROT(.iterations = 5, OBLIQUE),
    MANDELBROT(.iterations = 6, GROWN(1e3)),
    MANDELBROT(.iterations = 6, .escape = 10),
    MANDELBROT(.escape = 1),
    MANDELBROT(.iterations = 40),
    MANDELBROT(.power = 1),
    MANDELBROT(.at = {0, NAN}),
};

static UNUSED double random_conic_constant(generator *g)
{
    switch (below(g, 8)) {
    case 0: return 0;
    case 1: return -1;
    case 2: return -1 + either_sign(g) * 1e-12;
    case 3: return signed_scale(g, 3, 30);
    case 4: case 5: return signed_scale(g, -3, 3);
    default: return uniform(g, -3, 3);
    }
}

/* A set of its kind, as likely as not a sensible one; false: nothing is known of such a type. */
static UNUSED bool random_parameters(generator *g, const sgt_builtin *type, parameters *with)
{
    memset(with, 0, sizeof *with);
    if (type->ops == &sgt_conic_ops || type->ops == &sgt_even_asphere_ops) {
        bool plane = !strcmp(type->type, "plane"), sphere = !strcmp(type->type, "sphere");
        sgt_conic s = {.c = plane ? 0 : signed_scale(g, -4, 2)};
        if (!plane && !sphere) s.k = random_conic_constant(g);
        double e = (1 + s.k) * s.c * s.c, edge = e > 0 ? 1 / sqrt(e) : s.c != 0 ? 2 / fabs(s.c) : 10;
        double rim = edge * uniform(g, 0.05, 1.1);
        if (chance(g, 0.6)) s.semi_diameter = chance(g, 0.1) ? edge : rim;
        if (type->ops == &sgt_conic_ops) with->conic = s;
        else {
            with->asphere = (sgt_even_asphere){
                .c = chance(g, 0.1) ? 0 : s.c, .k = s.k, .semi_diameter = s.semi_diameter};
            int terms = below(g, 9);
            double strong = any_scale(g, -6, chance(g, 0.2) ? 1.5 : 0);
            for (int i = 0; i < terms; i++)
                with->asphere.a[i] =
                    chance(g, 0.2) ? 0 : uniform(g, -strong, strong) * whole_power(rim, -(2 * i + 1));
        }
        return true;
    }
    sgt_julia j = {.iterations = below(g, 13)};
    j.power = chance(g, 0.6) ? 2 : below(g, 9);
    if (j.power == 1) j.power = 3;
    if (j.power > 3 && j.iterations > 5) j.iterations = 5;
    for (int i = 0; i < 4; i++) {
        j.c[i] = chance(g, 0.3) ? 0 : uniform(g, -0.8, 0.6);
        j.at[i] = chance(g, 0.8) ? 0 : uniform(g, -0.3, 0.3);
    }
    if (chance(g, 0.3)) {
        double k = chance(g, 0.7) ? 1 : any_scale(g, -4, 4);
        for (int i = 0; i < 4; i++)
            j.ex[i] = k * uniform(g, -1, 1), j.ey[i] = k * uniform(g, -1, 1), j.ez[i] = k * uniform(g, -1, 1);
    }
    if (chance(g, 0.2)) j.escape = uniform(g, 1.5, 6);
    if (type->ops == &sgt_julia_ops) with->julia = j;
    else if (type->ops == &sgt_mandelbrot_ops) {
        sgt_mandelbrot *m = &with->mandelbrot;
        memcpy(m->at, j.at, sizeof m->at), memcpy(m->ex, j.ex, sizeof m->ex);
        memcpy(m->ey, j.ey, sizeof m->ey), memcpy(m->ez, j.ez, sizeof m->ez);
        m->escape = j.escape, m->iterations = j.iterations, m->power = j.power;
    } else return false;
    return true;
}

/* ------------------------------------------------------- a type known by its row alone */

/* What lists and terms point to: each is overwritten after some twenty more specimens. */
enum { NUMBERS = 1 << 16, TERMS = 256, LONGEST_LIST = 30, LARGEST_TABLE = 9 };

static UNUSED double *kept_numbers(size_t n)
{
    static double all[NUMBERS];
    static size_t used;
    if (used + n > NUMBERS) used = 0;
    used += n;
    return all + used - n;
}

static UNUSED const sgt_param *param_of(const sgt_builtin *type, const char *name)
{
    for (const sgt_param *p = type->params; p->name; p++)
        if (!strcmp(p->name, name)) return p;
    return NULL;
}

/* The power of a length that number i, j of a parameter has. */
static UNUSED int power_of_length(sgt_param_unit u, int i, int j)
{
    return u.length + i * u.by_i + j * u.by_j;
}

/* A surface of the size h, its departure `strong` h. */
static UNUSED void random_by_row(generator *g, const sgt_builtin *type, parameters *with, double h,
                                 double strong)
{
    static parameters terms_with[TERMS];
    static sgt_surface terms[TERMS];
    static size_t used;
    memset(with, 0, sizeof *with);
    for (const sgt_param *p = type->params; p->name; p++) {
        unsigned char *at = with->byte + p->offset;
        if (p->kind == SGT_PARAM_WHOLE || p->kind == SGT_PARAM_WORD || p->kind == SGT_PARAM_TRUTH) {
            int whole = (int)p->lo + below(g, (int)(p->hi < 20 ? p->hi - p->lo : 20 - p->lo) + 1);
            memcpy(at, &whole, sizeof whole);
        } else if (p->kind == SGT_PARAM_LIST || p->kind == SGT_PARAM_TABLE) {
            bool heights = !strcmp(p->name, "sag"); /* at least four by four, of any size in a row */
            int most = p->kind == SGT_PARAM_LIST ? LONGEST_LIST : LARGEST_TABLE, least = heights ? 4 : 1;
            if (chance(g, 0.9)) most /= 3; /* long ones seldom: they are dear */
            size_t rows = p->kind == SGT_PARAM_LIST ? 1 : (size_t)(least + below(g, most)),
                   columns = (size_t)(least + below(g, most));
            if (!heights && chance(g, 0.05)) rows = columns = 0;
            sgt_numbers all = {kept_numbers(rows * columns), rows, columns};
            double *x = (double *)(uintptr_t)all.x;
            for (size_t i = 0; i < rows; i++)
                for (size_t j = 0; j < columns; j++) {
                    int m = p->kind == SGT_PARAM_LIST ? (int)j : (int)i,
                        n = p->kind == SGT_PARAM_LIST ? 0 : (int)j;
                    double falling = heights ? 1 : 1 / (1 + (double)(m + n) * (m + n));
                    falling *= strong * whole_power(h, power_of_length(p->unit, m, n));
                    x[i * columns + j] = chance(g, 0.15) ? 0 : falling * uniform(g, -1, 1);
                }
            memcpy(at, &all, sizeof all);
        } else if (p->kind == SGT_PARAM_TERMS) {
            static const char *const kinds[] = {"even_asphere", "odd_asphere", "polynomial_xy", "chebyshev",
                                                "zernike",      "q_con",       "q_bfs",         "grid",
                                                "toroidal",     "biconic"};
            size_t n = (size_t)below(g, 4);
            if (used + n > TERMS) used = 0;
            const sgt_surface *first = terms + used;
            for (size_t i = 0; i < n; i++, used++) {
                const sgt_builtin *kind = sgt_builtins();
                for (int chosen_kind = below(g, COUNT_OF(kinds));
                     kind->type && strcmp(kind->type, kinds[chosen_kind]);)
                    kind++;
                random_by_row(g, kind, &terms_with[used], h, strong / (double)n);
                terms[used] = (sgt_surface){kind->ops, &terms_with[used]};
            }
            memcpy(at, &first, sizeof first), memcpy(at + sizeof first, &n, sizeof n);
        } else {
            bool list = p->count > 1 && p->kind == SGT_PARAM_REAL;
            for (int i = 0; i < p->count; i++) {
                int power = power_of_length(p->unit, i, 0);
                double x = uniform(g, -1, 1);
                if (list) x = chance(g, 0.2) ? 0 : x * strong / (1 + (double)i * i);
                else if (power == 1 && p->kind == SGT_PARAM_REAL) x = uniform(g, 0.3, 1.5);
                else if (power == -1) x = chance(g, 0.2) ? 0 : signed_scale(g, -3, 0);
                else if (power == 0) x *= chance(g, 0.3) ? 0 : 2;
                if (!strcmp(p->name, "semi_diameter")) x = chance(g, 0.6);
                if (!strncmp(p->name, "step", 4)) x /= LARGEST_TABLE;
                x *= whole_power(h, power);
                memcpy(at + sizeof x * (size_t)i, &x, sizeof x);
            }
        }
    }
    if (type->prepare && chance(g, 0.5)) type->prepare(with);
}

/* Any number in any parameter of the type's row; of a sum its terms are left as they are. */
static UNUSED void spoil(generator *g, const sgt_builtin *type, parameters *with)
{
    int rows = 0;
    while (type->params[rows].name) rows++;
    const sgt_param *p = &type->params[below(g, rows)];
    unsigned char *at = with->byte + p->offset;
    double x = chance(g, 0.5) ? hostile_number(g) : uniform(g, -2, 2);
    if (p->kind == SGT_PARAM_WHOLE || p->kind == SGT_PARAM_WORD || p->kind == SGT_PARAM_TRUTH) {
        int whole = chance(g, 0.7) ? (int)uniform(g, p->lo, p->hi + 1) : below(g, 400) - 200;
        memcpy(at, &whole, sizeof whole);
    } else if (p->kind == SGT_PARAM_LIST || p->kind == SGT_PARAM_TABLE) {
        sgt_numbers all;
        memcpy(&all, at, sizeof all);
        if (all.rows > 0 && all.columns > 0)
            ((double *)(uintptr_t)all.x)[below(g, (int)(all.rows * all.columns))] = x;
    } else if (p->kind != SGT_PARAM_TERMS) memcpy(at + sizeof x * (size_t)below(g, p->count), &x, sizeof x);
}

static UNUSED sgt_hit alone(const specimen *s, sgt_ray ray, sgt_pick pick)
{
    return sgt_intersect(surface_of(s), ray, &(sgt_options){.pick = pick});
}

/* A size, where it is not known, and points to aim at. */
static UNUSED void survey(generator *g, specimen *s)
{
    s->sag = param_of(s->type, "semi_diameter") != NULL;
    if (!(s->size > 0)) s->size = 2;
    if (s->type->ops == &sgt_conic_ops || s->type->ops == &sgt_even_asphere_ops) {
        double v[3]; /* an asphere begins as a conic does */
        memcpy(v, &s->with, sizeof v);
        double e = (1 + v[1]) * v[0] * v[0], edge = e > 0 ? 1 / sqrt(e) : v[0] != 0 ? 2 / fabs(v[0]) : 10;
        s->size = v[2] > 0 && v[2] < edge ? v[2] : edge;
    } else if (s->type->ops == &sgt_julia_ops || s->type->ops == &sgt_mandelbrot_ops) {
        const double *ex = s->type->ops == &sgt_julia_ops ? s->with.julia.ex : s->with.mandelbrot.ex;
        double length = sqrt(ex[0] * ex[0] + ex[1] * ex[1] + ex[2] * ex[2] + ex[3] * ex[3]);
        s->size = length > 0 ? 1.5 / length : 1.5;
    }
    if (!(s->size > 1e-280 && s->size < 1e280)) s->size = 1;
    for (int i = 0; i < ANCHORS; i++) {
        sgt_vec3 from = times(2 * s->size, random_direction(g)), to = random_vector_of(g, 0, 0.5 * s->size);
        sgt_hit hit = s->sag ? (sgt_hit){0}
                             : alone(s, (sgt_ray){from, times(1 / s->size, difference(to, from)), 0, 0},
                                     SGT_FIRST);
        s->anchor[i] = hit.status > 0 ? hit.p : to;
        s->normal[i] = hit.status > 0 ? hit.n : random_direction(g);
    }
}

/* A ray as a lens or a picture has them. */
static UNUSED sgt_ray ordinary_ray(generator *g, const specimen *s)
{
    sgt_ray ray = {.tmin = 0, .tmax = FAR};
    double h = s->size;
    if (s->sag) {
        double r = 0.6 * h * sqrt(uniform(g, 0, 1)), l = uniform(g, -0.15, 0.15), m = uniform(g, -0.15, 0.15);
        ray.o = times(r, random_radius(g));
        ray.o.z = -2 * h;
        ray.d = (sgt_vec3){l, m, sqrt(1 - l * l - m * m)};
    } else {
        ray.o = times(2 * h, random_direction(g));
        ray.d = difference(random_vector_of(g, 0, 0.9 * h), ray.o);
        ray.d = times(1 / sqrt(dot(ray.d, ray.d)), ray.d);
    }
    return ray;
}

/* Sets that answer every ray alike (invalid, out of range) are drawn seldom. */
static UNUSED specimen random_specimen(generator *g, const sgt_builtin *type)
{
    specimen s = {.type = type};
    int first = -1, sets = 0;
    for (int i = 0; i < (int)COUNT_OF(chosen); i++)
        if (!strcmp(chosen[i].type, type->type)) first = first < 0 ? i : first, sets++;
    sgt_status said;
    do {
        double which = uniform(g, 0, 1);
        s.size = 0;
        if (!answers_itself(type)) {
            s.size = chance(g, 0.7) ? uniform(g, 0.5, 20) : any_scale(g, -3, 3);
            random_by_row(g, type, &s.with, s.size, any_scale(g, -6, -1));
        } else if (sets && (which < 0.6 || !random_parameters(g, type, &s.with)))
            s.with = chosen[first + below(g, sets)].with;
        for (bool more = (!sets && answers_itself(type)) || which > 0.9; more; more = chance(g, 0.5))
            spoil(g, type, &s.with);
        survey(g, &s);
        said = alone(&s, ordinary_ray(g, &s), SGT_FIRST).status;
    } while ((said == SGT_INVALID || said == SGT_UNPROVEN) && chance(g, 0.8));
    return s;
}

/* ---------------------------------------------------------------------- rays */

/* A point of the surface and the gradient there. */
static UNUSED sgt_vec3 point_on(generator *g, const specimen *s, sgt_vec3 *normal)
{
    if (!s->sag) {
        int i = below(g, ANCHORS);
        *normal = s->normal[i];
        return s->anchor[i];
    }
    double r = s->size;
    switch (below(g, 8)) {
    case 0: r *= any_scale(g, -9, 0); break;
    case 1: r = ulps(r, below(g, 9) - 4); break;         /* the rim, or the equator */
    case 2: r *= 1 + 0x1p-45 * uniform(g, -4, 4); break; /* where it is soft */
    case 3: r *= uniform(g, 0.99, 1.3); break;
    default: r *= sqrt(uniform(g, 0, 1)); break;
    }
    sgt_vec3 p = times(r, random_radius(g));
    if (chance(g, 0.1)) p.x = r, p.y = 0;
    double F = s->type->ops->value(&s->with, p, normal);
    p.z = F == F ? -F : uniform(g, -1, 1) * s->size; /* F = z - s(x, y) */
    if (!(F == F)) *normal = random_direction(g);
    return p;
}

/* Through p, from `away` before it. */
static UNUSED sgt_ray ray_through(sgt_vec3 p, sgt_vec3 d, double away)
{
    return (sgt_ray){.o = difference(p, times(away, d)), .d = d, .tmin = 0, .tmax = FAR};
}

typedef enum ray_kind {
    ORDINARY,
    AIMED,
    LONG_OR_SHORT,
    MISSING,
    GRAZING,
    STARTING,
    AXIAL,
    LEVEL,
    FARAWAY,
    SPOILT,
    TINY_RAY,
    HUGE_RAY,
    EQUATOR,
    NOISE,
    RAY_KINDS
} ray_kind;

static const char *const ray_kinds[RAY_KINDS] = {
    "ordinary",
    "aimed at a point of the surface or its rim",
    "of a direction not of unit length",
    "missing",
    "grazing",
    "starting on the surface",
    "along the axis",
    "parallel to the vertex plane",
    "from far away",
    "with a hostile number",
    "with tiny numbers",
    "with huge numbers",
    "across the equator",
    "of random bits",
};

static UNUSED double *component(sgt_ray *ray, int i)
{
    double *all[] = {&ray->o.x, &ray->o.y, &ray->o.z,  &ray->d.x,
                     &ray->d.y, &ray->d.z, &ray->tmin, &ray->tmax};
    return all[i];
}

/* A hostile number in any place. */
static UNUSED void spoil_ray(generator *g, sgt_ray *ray)
{
    double *place = component(ray, below(g, 8));
    *place = hostile_number(g);
}

static UNUSED sgt_ray ray_of_kind(generator *g, const specimen *s, ray_kind kind)
{
    sgt_vec3 n, p, d;
    sgt_ray ray = ordinary_ray(g, s);
    double h = s->size, away;
    int which;
    switch (kind) {
    case ORDINARY: break;
    case AIMED:
        p = point_on(g, s, &n);
        d = random_direction(g);
        ray = ray_through(p, d, h * any_scale(g, -3, 2));
        break;
    case LONG_OR_SHORT: {
        double k = chance(g, 0.5) ? any_scale(g, -3, 3) : any_scale(g, -200, 200);
        ray.d = times(k, ray.d);
        if (chance(g, 0.3)) ray.tmin = uniform(g, -1, 2.5) * h / k, ray.tmax = uniform(g, 1.5, 4) * h / k;
        break;
    }
    case MISSING:
        ray.o = sum(ray.o, random_vector_of(g, 2 * h, 50 * h));
        if (chance(g, 0.3)) ray.d = times(-1, ray.d);
        break;
    case GRAZING: {
        p = point_on(g, s, &n);
        double nn = dot(n, n);
        sgt_vec3 u = random_direction(g);
        if (nn > 0 && nn < 1e300) {
            n = times(1 / sqrt(nn), n);
            u = difference(u, times(dot(u, n), n));
            u = times(1 / sqrt(dot(u, u)), u);
            double off = chance(g, 0.3) ? 0 : signed_scale(g, -17, -1);
            if (chance(g, 0.5)) p = sum(p, times(off * h, n));
            else u = sum(u, times(off, n));
        }
        ray = ray_through(p, u, h * (chance(g, 0.2) ? 0 : any_scale(g, -6, 3)));
        if (chance(g, 0.3)) ray.tmin = -FAR;
        break;
    }
    case STARTING:
        p = point_on(g, s, &n);
        if (chance(g, 0.5)) {
            sgt_hit hit = alone(s, ray, SGT_FIRST);
            if (hit.status > 0) p = hit.p;
        }
        ray.o = p;
        if (chance(g, 0.5)) ray.d = random_direction(g);
        if (chance(g, 0.3)) ray.tmin = -any_scale(g, -20, 0) * h;
        which = below(g, 3);
        if (chance(g, 0.3)) *component(&ray, which) *= 1 + signed_scale(g, -16, -8);
        break;
    case AXIAL:
        ray.o = (sgt_vec3){0, 0, chance(g, 0.2) ? 0 : either_sign(g) * h * any_scale(g, -3, 3)};
        ray.d = (sgt_vec3){0, 0, either_sign(g)};
        if (chance(g, 0.3)) ray.o.x = h * uniform(g, -1, 1);
        if (chance(g, 0.2)) ray.o.y = either_sign(g) * h * any_scale(g, -300, 0);
        if (chance(g, 0.2)) ray.d.x = signed_scale(g, -320, -5);
        if (chance(g, 0.2)) ray.o.x = -0.0, ray.d.y = -0.0;
        break;
    case LEVEL:
        p = point_on(g, s, &n);
        d = random_vector(g);
        d.z = 0;
        if (chance(g, 0.3)) d.y = 0;
        if (chance(g, 0.4)) d.z = signed_scale(g, -320, -6);
        ray = ray_through(p, d, h * uniform(g, 0, 4));
        if (chance(g, 0.3)) ray.o.z = chance(g, 0.7) ? 0 : hostile_number(g);
        if (chance(g, 0.2)) { /* touching at the vertex, exactly or nearly */
            which = below(g, 2);
            away = h * whole_power(2, below(g, 9) - 4);
            ray = ray_through((sgt_vec3){0, 0, 0}, (sgt_vec3){1, which, 0}, away);
            if (chance(g, 0.3)) ray.o.z = either_sign(g) * h * any_scale(g, -300, -3);
        }
        if (chance(g, 0.5)) ray.tmin = -FAR;
        break;
    case FARAWAY:
        p = point_on(g, s, &n);
        d = chance(g, 0.5) ? ray.d : random_direction(g);
        ray = ray_through(p, d, h * signed_scale(g, 2, 15));
        if (chance(g, 0.5)) ray.tmin = -FAR;
        break;
    case SPOILT:
        do spoil_ray(g, &ray);
        while (chance(g, 0.3));
        break;
    case TINY_RAY: {
        double k = any_scale(g, -320, -10), j = chance(g, 0.5) ? 1 : any_scale(g, -320, -10);
        for (int i = 0; i < 3; i++)
            if (chance(g, 0.7)) *component(&ray, i) *= k;
        for (int i = 3; i < 6; i++)
            if (chance(g, 0.7)) *component(&ray, i) *= j;
        break;
    }
    case HUGE_RAY: {
        double k = any_scale(g, 10, 308), j = chance(g, 0.5) ? 1 : any_scale(g, 10, 308);
        for (int i = 0; i < 3; i++)
            if (chance(g, 0.7)) *component(&ray, i) *= k;
        for (int i = 3; i < 6; i++)
            if (chance(g, 0.7)) *component(&ray, i) *= j;
        break;
    }
    case EQUATOR: { /* v = 1 - (1 + k) c z near 0, or a root near the other sheet */
        double v[2];
        memcpy(v, &s->with, sizeof v);
        double z = s->sag && (1 + v[1]) * v[0] != 0 ? 1 / ((1 + v[1]) * v[0]) : h;
        if (chance(g, 0.8)) z *= 1 + signed_scale(g, -17, -1);
        p = times(h, random_radius(g));
        p.z = z;
        if (chance(g, 0.3)) p.x *= uniform(g, 0, 2), p.y *= uniform(g, 0, 2);
        away = h * uniform(g, 0, 4);
        ray = ray_through(p, random_direction(g), away);
        if (chance(g, 0.2)) ray = ray_through((sgt_vec3){h, 0, z}, (sgt_vec3){0, below(g, 2), 1}, h);
        /* touching there */
        if (chance(g, 0.1)) ray = ray_through((sgt_vec3){h, 0, z}, (sgt_vec3){0, 1, 0}, h);
        break;
    }
    case NOISE: default:
        for (int i = 0; i < 8; i++)
            if (chance(g, i < 6 ? 0.8 : 0.3)) *component(&ray, i) = from_bits(random_bits(g));
        break;
    }
    return ray;
}

/* Ends of every kind; a root at an end, to the ulp. */
static UNUSED void hostile_ends(generator *g, const specimen *s, sgt_ray *ray)
{
    static const double ends[][2] = {
        {0, 0},
        {-0.0, 0},
        {0, -0.0},
        {-HUGE_VAL, HUGE_VAL},
        {-HUGE_VAL, 0},
        {0, HUGE_VAL},
        {1, 1},
        {2, 1},
        {HUGE_VAL, HUGE_VAL},
        {-HUGE_VAL, -HUGE_VAL},
        {NAN, 1},
        {0, NAN},
        {NAN, NAN},
        {-1, 0},
        {1, 0},
        {-1e300, 1e300},
        {0, 1e-300},
        {0x1p-1074, 0x1p-1060},
        {DBL_MAX, HUGE_VAL},
        {-HUGE_VAL, -DBL_MAX},
        {5, HUGE_VAL},
        {0, 2},
    };
    if (chance(g, 0.5)) {
        int i = below(g, COUNT_OF(ends));
        ray->tmin = ends[i][0], ray->tmax = ends[i][1];
        return;
    }
    sgt_ray line = *ray;
    line.tmin = -FAR, line.tmax = FAR;
    sgt_hit hit = alone(s, line, chance(g, 0.5) ? SGT_FIRST : SGT_NEAR_SEED);
    if (!(hit.status > 0)) return;
    double at = ulps(hit.t, below(g, 7) - 3);
    if (chance(g, 0.3)) at = hit.t + uniform(g, -3, 3) * hit.t_err;
    if (chance(g, 0.3)) at = hit.t + signed_scale(g, -18, -10) * (fabs(hit.t) + s->size);
    if (chance(g, 0.5)) ray->tmin = at;
    else ray->tmax = at;
    if (chance(g, 0.1)) ray->tmin = ray->tmax = at;
}

static UNUSED sgt_ray hostile_ray(generator *g, const specimen *s)
{
    sgt_ray ray = ray_of_kind(g, s, (ray_kind)below(g, RAY_KINDS));
    if (chance(g, 0.15)) hostile_ends(g, s, &ray);
    if (chance(g, 0.02)) spoil_ray(g, &ray);
    return ray;
}

static UNUSED sgt_options hostile_options(generator *g)
{
    static const double tolerances[] = {0, 1e-15, 1e-9, 1e-6, 1e-3, 1, 1e300, 0x1p-1074};
    static const int budgets[] = {1, 2, 3, 5, 10, 30, 100, 3000};
    sgt_options opt = {.pick = (sgt_pick)below(g, 3)};
    if (chance(g, 0.4)) opt.t_tol = tolerances[below(g, COUNT_OF(tolerances))];
    if (chance(g, 0.1)) opt.f_tol = tolerances[below(g, COUNT_OF(tolerances))];
    if (chance(g, 0.15)) opt.dt_min = any_scale(g, -3, 0);
    if (chance(g, 0.3)) opt.max_evals = budgets[below(g, COUNT_OF(budgets))];
    if (chance(g, 0.02)) opt.t_tol = chance(g, 0.5) ? NOT : -1;
    if (chance(g, 0.01)) opt.dt_min = NOT;
    if (chance(g, 0.4)) opt.proof = (sgt_proof)(1 + below(g, chance(g, 0.99) ? 2 : 3));
    if (chance(g, 0.01)) opt.max_evals = -1;
    return opt;
}

/* ------------------------------------------------------------------ answers */

/* Equal to the last bit, the sign of a zero too; a NaN is a NaN. */
static UNUSED bool same(double a, double b) { return bits_of(a) == bits_of(b) || (a != a && b != b); }

static UNUSED void print_number(double x) { printf(" %a", x); }

/* All that a batch says of a ray is the same. */
static UNUSED bool same_answer(const sgt_hit *a, const sgt_hit *b)
{
    return a->status == b->status && a->evals == b->evals && same(a->t, b->t) && same(a->t_err, b->t_err) &&
           same(a->t_lo, b->t_lo) && same(a->p_err, b->p_err) && same(a->p.x, b->p.x) &&
           same(a->p.y, b->p.y) && same(a->p.z, b->p.z) && same(a->n.x, b->n.x) && same(a->n.y, b->n.y) &&
           same(a->n.z, b->n.z);
}

static UNUSED void print_answer(const char *name, const sgt_hit *h)
{
    printf("    %-7s %s, evals %d, t %a t_err %a t_lo %a\n            p %a %a %a +- %a  n %a %a %a\n", name,
           sgt_status_text(h->status), h->evals, h->t, h->t_err, h->t_lo, h->p.x, h->p.y, h->p.z, h->p_err,
           h->n.x, h->n.y, h->n.z);
}

static UNUSED void print_ray(const sgt_ray *r)
{
    printf("    ray     {{%a, %a, %a}, {%a, %a, %a}, %a, %a}\n", r->o.x, r->o.y, r->o.z, r->d.x, r->d.y,
           r->d.z, r->tmin, r->tmax);
}

static UNUSED void print_options(const sgt_options *o)
{
    printf("    options {.t_tol = %a, .f_tol = %a, .dt_min = %a, .max_evals = %d, .pick = %d, .proof = %d}\n",
        o->t_tol, o->f_tol, o->dt_min, o->max_evals, (int)o->pick, (int)o->proof);
}

/* By its row, so that any type can be printed. */
static UNUSED void print_parameters(const sgt_builtin *type, const parameters *with)
{
    printf("    %s", type->type);
    for (const sgt_param *p = type->params; p->name; p++) {
        const unsigned char *at = with->byte + p->offset;
        printf("  %s", p->name);
        if (p->kind == SGT_PARAM_WHOLE || p->kind == SGT_PARAM_WORD || p->kind == SGT_PARAM_TRUTH) {
            int whole;
            memcpy(&whole, at, sizeof whole);
            printf(" %d", whole);
        } else if (p->kind == SGT_PARAM_LIST || p->kind == SGT_PARAM_TABLE) {
            sgt_numbers all;
            memcpy(&all, at, sizeof all);
            printf(" %zu x %zu", all.rows, all.columns);
            for (size_t i = 0; i < all.rows * all.columns; i++) print_number(all.x[i]);
        } else if (p->kind == SGT_PARAM_TERMS) {
            const sgt_surface *terms;
            size_t n;
            memcpy(&terms, at, sizeof terms), memcpy(&n, at + sizeof terms, sizeof n);
            for (size_t i = 0; i < n; i++)
                for (const sgt_builtin *kind = sgt_builtins(); kind->type; kind++)
                    if (!strcmp(kind->type, terms[i].ops->name))
                        printf("\n    "), print_parameters(kind, terms[i].self);
        } else for (int i = 0; i < p->count; i++) {
            double x;
            memcpy(&x, at + sizeof x * (size_t)i, sizeof x);
            print_number(x);
        }
    }
    printf("\n");
}

static UNUSED void print_specimen(const specimen *s) { print_parameters(s->type, &s->with); }

/* ------------------------------------------------------------------- arrays */

/* An array with room on both sides that nobody may write to, beginning at any place. */
enum { MOST = 1100, GUARD = 24 };
typedef struct guarded { double room[MOST + 2 * GUARD]; size_t from; bool wanted; } guarded;

static const uint64_t CANARY = 0x7ff4c0ffee5a5a5au;

static UNUSED double *guarded_array(guarded *a, generator *g, bool wanted)
{
    for (size_t i = 0; i < COUNT_OF(a->room); i++) memcpy(&a->room[i], &CANARY, sizeof CANARY);
    a->from = GUARD / 2 + (size_t)below(g, 9);
    a->wanted = wanted;
    return wanted ? a->room + a->from : NULL;
}

/* Nothing written outside the first `bytes` of it. */
static UNUSED bool untouched(const guarded *a, size_t bytes)
{
    const unsigned char *byte = (const unsigned char *)a->room, *expected = (const unsigned char *)&CANARY;
    size_t begin = a->from * sizeof(double), end = a->wanted ? begin + bytes : begin;
    for (size_t i = 0; i < begin; i++)
        if (byte[i] != expected[i % sizeof CANARY]) return false;
    for (size_t i = end; i < sizeof a->room; i++)
        if (byte[i] != expected[i % sizeof CANARY]) return false;
    return true;
}

#endif
