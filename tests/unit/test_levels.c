// SPDX-License-Identifier: MIT
/* Level sets of quaternion orbits: which parameters are none, what zeros stand for, and closed
 * forms.  With c = 0 the level set is the sphere |Q| = E^(1/p^N); a Mandelbrot's N = 1 is the ball
 * of radius E, its N = 2 cuts the real axis where x^2 + x = 2; and for c = -2 the real axis maps
 * by 2 cos a to 2 cos 2a, which touches E = 2 again and again. */
#include "../ends.h"
#include "unit.h"

#include <sagitta/diagnose.h>
#include <sagitta/surfaces.h>

enum { MOST = 300 };

static sgt_surface julia_surface(const sgt_julia *s) { return (sgt_surface){&sgt_julia_ops, s}; }
static sgt_surface mandelbrot_surface(const sgt_mandelbrot *s)
{
    return (sgt_surface){&sgt_mandelbrot_ops, s};
}

/* The Mandelbrot set of the same slice. */
static sgt_mandelbrot sliced_alike(const sgt_julia *s)
{
    sgt_mandelbrot m = {.escape = s->escape, .iterations = s->iterations, .power = s->power};
    memcpy(m.at, s->at, sizeof m.at), memcpy(m.ex, s->ex, sizeof m.ex);
    memcpy(m.ey, s->ey, sizeof m.ey), memcpy(m.ez, s->ez, sizeof m.ez);
    return m;
}

static const sgt_builtin *row_of(const char *type)
{
    for (const sgt_builtin *row = sgt_builtins(); row->type; row++)
        if (!strcmp(row->type, type)) return row;
    fail_msg("no row for %s", type);
    return NULL;
}
static const sgt_param *param_of(const sgt_builtin *row, const char *name)
{
    for (const sgt_param *p = row->params; p->name; p++)
        if (!strcmp(p->name, name)) return p;
    return NULL;
}

/* ------------------------------------------------------------------ the rows */

static void test_rows(void **state)
{
    (void)state;
    typedef struct key { const char *name; size_t offset; int count; sgt_param_kind kind; } key;
    static const key of_julia[] = {
        {"c", offsetof(sgt_julia, c), 4, SGT_PARAM_VECTOR},
        {"at", offsetof(sgt_julia, at), 4, SGT_PARAM_VECTOR},
        {"slice", offsetof(sgt_julia, at) + 3 * sizeof(double), 1, SGT_PARAM_REAL},
        {"ex", offsetof(sgt_julia, ex), 4, SGT_PARAM_VECTOR},
        {"ey", offsetof(sgt_julia, ey), 4, SGT_PARAM_VECTOR},
        {"ez", offsetof(sgt_julia, ez), 4, SGT_PARAM_VECTOR},
        {"escape", offsetof(sgt_julia, escape), 1, SGT_PARAM_REAL},
        {"iterations", offsetof(sgt_julia, iterations), 1, SGT_PARAM_WHOLE},
        {"power", offsetof(sgt_julia, power), 1, SGT_PARAM_WHOLE},
    };
    static const key of_mandelbrot[] = {
        {"at", offsetof(sgt_mandelbrot, at), 4, SGT_PARAM_VECTOR},
        {"ex", offsetof(sgt_mandelbrot, ex), 4, SGT_PARAM_VECTOR},
        {"ey", offsetof(sgt_mandelbrot, ey), 4, SGT_PARAM_VECTOR},
        {"ez", offsetof(sgt_mandelbrot, ez), 4, SGT_PARAM_VECTOR},
        {"escape", offsetof(sgt_mandelbrot, escape), 1, SGT_PARAM_REAL},
        {"iterations", offsetof(sgt_mandelbrot, iterations), 1, SGT_PARAM_WHOLE},
        {"power", offsetof(sgt_mandelbrot, power), 1, SGT_PARAM_WHOLE},
    };
    for (int m = 0; m < 2; m++) {
        const sgt_builtin *row = row_of(m ? "mandelbrot" : "julia");
        const key *keys = m ? of_mandelbrot : of_julia;
        assert_ptr_equal(row->ops, m ? &sgt_mandelbrot_ops : &sgt_julia_ops);
        assert_int_equal(row->size, m ? sizeof(sgt_mandelbrot) : sizeof(sgt_julia));
        assert_non_null(row->object);
        for (size_t i = 0; i < (m ? COUNT_OF(of_mandelbrot) : COUNT_OF(of_julia)); i++) {
            const sgt_param *p = param_of(row, keys[i].name);
            REQUIRE(p, "%s has no key %s", row->type, keys[i].name);
            REQUIRE(p->offset == keys[i].offset && p->count == keys[i].count && p->kind == keys[i].kind,
                    "%s.%s: offset %zu, count %d, kind %d", row->type, p->name, p->offset, p->count,
                    (int)p->kind);
            REQUIRE(p->lo < p->hi && isfinite(p->lo) && isfinite(p->hi), "%s.%s: from %g to %g", row->type,
                    p->name, p->lo, p->hi);
            /* a zero stands for a default in the struct; as a number that is given it is none of these */
            if (!strcmp(p->name, "iterations")) assert_true(p->lo == 1 && p->hi == 10000);
            if (!strcmp(p->name, "power")) assert_true(p->lo == 2 && p->hi == 8);
            if (!strcmp(p->name, "escape")) assert_true(p->lo > 0 && p->hi == 1e6);
        }
        assert_null(m ? param_of(row, "c") : param_of(row, "semi_diameter"));
        assert_string_equal(row->ops->name, row->type);
        assert_non_null(row->ops->span);
        assert_non_null(row->ops->rounding);
        assert_non_null(row->ops->estimate);
    }
}

/* -------------------------------------------------- what is no level set */

/* Does the row say so: a range, or its objection?  *key is the parameter named. */
static bool row_objects(const sgt_builtin *row, const void *self, const char **key)
{
    for (const sgt_param *p = row->params; p->name; p++)
        for (int i = 0; i < p->count; i++) {
            const char *at = (const char *)self + p->offset;
            double x = p->kind == SGT_PARAM_WHOLE ? (double)((const int *)(const void *)at)[i]
                                            : ((const double *)(const void *)at)[i];
            *key = p->name;
            if (x != 0 && !(x >= p->lo && x <= p->hi)) return true; /* zero: not given */
        }
    sgt_objection o = row->object(self);
    *key = o.param;
    REQUIRE(!o.param == !o.reason, "%s: an objection of half", row->type);
    REQUIRE(!o.param || (param_of(row, o.param) && *o.reason), "%s objects to %s, which is no key", row->type,
            o.param);
    return o.param;
}

/* Invalid everywhere, or nowhere. */
static bool is_invalid(sgt_surface s, const sgt_builtin *row)
{
    const sgt_ray ray = {.o = {0.1, 0.2, -5}, .d = {0, 0.01, 1}};
    const sgt_options few = {.max_evals = 50};
    sgt_hit hit[2];
    bool invalid = sgt_intersect(s, ray, &few).status == SGT_INVALID;
    REQUIRE((sgt_intersect_all(s, ray, 2, hit, &few) == SGT_INVALID) == invalid, "%s: of all %s", row->type,
            invalid ? "valid" : "invalid");
    REQUIRE((sgt_intersect(s, ray, &(sgt_options){.dt_min = 0.01, .max_evals = 50}).status == SGT_INVALID) ==
                invalid,
            "%s: the fast way is %s", row->type, invalid ? "valid" : "invalid");
    sgt_vec3 grad = {0};
    double potential = s.ops == &sgt_julia_ops ? sgt_julia_potential(s.self, (sgt_vec3){2, 0, 0}, &grad)
                                               : sgt_mandelbrot_potential(s.self, (sgt_vec3){2, 0, 0}, &grad);
    REQUIRE(isnan(potential) == invalid, "%s: the potential is %g", row->type, potential);
    return invalid;
}

static void test_one_by_one(void **state)
{
    (void)state;
    const sgt_builtin *julia = row_of("julia"), *mandelbrot = row_of("mandelbrot");
    const double golden = 1.6180339887498949; /* x^2 = x + 1 */
    const sgt_julia sound = {.c = {0, 0.6, 0.8, 0},
                             .ex = {1},
                             .ey = {0, 1},
                             .ez = {0, 0, 1},
                             .escape = 2,
                             .iterations = 5,
                             .power = 2};
    typedef struct what { sgt_julia s; const char *key; } what; /* key NULL: valid */
    what cases[100];
    int n = 0;
#define CASE(text, assignment)          \
    do {                                \
        cases[n] = (what){sound, text}; \
        sgt_julia *s = &cases[n++].s;   \
        assignment;                     \
    } while (0)
    CASE(NULL, (void)s);
    CASE(NULL, s->iterations = 1);
    CASE(NULL, s->iterations = 100);
    CASE(NULL, s->iterations = 101);
    CASE(NULL, s->iterations = 10000);
    CASE(NULL, s->iterations = 0);
    CASE("iterations", s->iterations = -1);
    CASE("iterations", s->iterations = 10001);
    CASE(NULL, s->power = 8);
    CASE(NULL, s->power = 0);
    CASE("power", s->power = 1);
    CASE("power", s->power = -2);
    CASE("power", s->power = 9);
    CASE(NULL, s->escape = 0);
    CASE(NULL, s->escape = golden);
    CASE(NULL, s->escape = golden * (1 - 0x1p-42));
    CASE("escape", s->escape = golden * (1 - 0x1p-38));
    CASE("escape", s->escape = 1);
    CASE("escape", s->escape = -2);
    CASE(NULL, s->escape = 1e6);
    CASE("escape", s->escape = 1.001e6);
    CASE("escape", s->escape = NOT);
    CASE("escape", s->escape = FAR);
    CASE(NULL, (s->c[0] = 1e6, s->escape = 2000));
    CASE("c", (s->c[0] = -1.001e6, s->escape = 2000));
    CASE("escape", (s->c[0] = 1e6)); /* c is right, and the escape then too small */
    CASE(NULL, s->at[2] = -1e6);
    CASE("at", s->at[2] = 1.001e6);
    CASE(NULL, (s->ex[0] = 0, s->ey[1] = 0, s->ez[2] = 0)); /* all zero: the first three components */
    CASE("ex", s->ex[0] = 0);
    CASE("ey", s->ey[1] = 0);
    CASE("ez", s->ez[2] = 0);
    CASE(NULL, s->ey[0] = 3); /* askew */
    CASE(NULL, (s->ex[0] = 1e100, s->ey[1] = 1e100, s->ez[2] = 1e100));
    CASE(NULL, (s->ex[0] = 1.0001e-100, s->ey[1] = 1.0001e-100, s->ez[2] = 1.0001e-100));
    CASE("ex", s->ex[0] = 1.001e100);
    CASE("ey", s->ey[1] = 0.999e-100);
    CASE("e?", (s->ex[0] = 0, s->ey[1] = 1e-200, s->ez[2] = 0)); /* not zero, though its square is */
    CASE("e?", (s->ey[1] = 0, s->ey[0] = 2));                         /* along ex */
    CASE("e?", (s->ez[2] = 0, s->ez[0] = 0.5, s->ez[1] = 0.25));      /* in the plane of both */
    CASE("e?", (s->ey[1] = 0, s->ey[0] = 1, s->ey[3] = 0x1p-60));     /* next to along ex */
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 2; k++) {
            double bad = k ? NOT : -FAR;
            CASE("c", s->c[i] = bad);
            CASE("at", s->at[i] = bad);
            CASE("ex", s->ex[i] = bad);
            CASE("ey", s->ey[i] = bad);
            CASE("ez", s->ez[i] = bad);
        }
    for (int i = 0; i < n; i++) {
        const char *key, *want = cases[i].key;
        bool invalid = is_invalid(julia_surface(&cases[i].s), julia),
             told = row_objects(julia, &cases[i].s, &key);
        REQUIRE(invalid == (want != NULL), "case %d, %s: %s", i, want ? want : "sound",
                invalid ? "invalid" : "valid");
        REQUIRE(told == invalid, "case %d, %s: the row does not say so", i, want ? want : "sound");
        if (want) REQUIRE(!strcmp(key, want) || (want[1] == '?' && key[0] == 'e' && strlen(key) == 2),
            "case %d: %s is named, it is %s", i, key, want);
        /* the same of a Mandelbrot set, whose safe escape is 2 */
        const sgt_julia *from = &cases[i].s;
        sgt_mandelbrot m = sliced_alike(from);
        if (from->escape > 1 && from->escape < 1e6) m.escape += 1;
        bool by_c = want && !strcmp(want, "c"),
             by_escape = want && !strcmp(want, "escape") && from->escape > 1 && from->escape <= 1e6;
        invalid = is_invalid(mandelbrot_surface(&m), mandelbrot), told = row_objects(mandelbrot, &m, &key);
        REQUIRE(invalid == (want && !by_c && !by_escape),
            "case %d, %s, of a mandelbrot: %s", i, want ? want : "sound", invalid ? "invalid" : "valid");
        REQUIRE(told == invalid, "case %d, %s, of a mandelbrot: the row does not say so", i,
                want ? want : "sound");
    }
    const sgt_mandelbrot least = {.escape = 2 * (1 - 0x1p-42)}, less = {.escape = 2 * (1 - 0x1p-38)};
    const sgt_mandelbrot cubic = {.escape = 1.4142135623730952, .power = 3},
                         low = {.escape = 1.41421, .power = 3};
    assert_false(is_invalid(mandelbrot_surface(&least), mandelbrot));
    assert_true(is_invalid(mandelbrot_surface(&less), mandelbrot));
    assert_false(is_invalid(mandelbrot_surface(&cubic), mandelbrot));
    assert_true(is_invalid(mandelbrot_surface(&low), mandelbrot));
}

/* Anything in any field: the library and the row are of one mind. */
static void test_of_one_mind(void **state)
{
    (void)state;
    generator g = seeded("of one mind");
    const double numbers[] = {0,      0,     0,   1,   -1,    0.5,    2,   1e-90, 1e90,
                              1e-110, 1e110, 5e5, 2e6, 1e300, 5e-324, NOT, FAR};
    long n = scaled(20000), invalid = 0;
    for (long i = 0; i < n; i++) {
        bool wild = chance(&g, 0.5);
        sgt_julia s = {.iterations = chance(&g, 0.9) ? below(&g, 101) : below(&g, 30000) - 10000,
                       .power = chance(&g, 0.9) ? 2 + below(&g, 7) : below(&g, 20) - 5,
                       .escape = chance(&g, 0.5) ? 0 : log_uniform(&g, 0.5, 5)};
        double *const list[] = {s.c, s.at, s.ex, s.ey, s.ez};
        for (int k = 0; k < 5; k++)
            for (int j = 0; j < 4; j++)
                list[k][j] = wild && chance(&g, 0.1) ? numbers[below(&g, COUNT_OF(numbers))]
                             : k < 2                 ? uniform(&g, -1, 1)
                             : chance(&g, 0.5)       ? j == k - 2
                                                     : uniform(&g, -1, 1);
        sgt_mandelbrot m = sliced_alike(&s);
        const char *key;
        const sgt_builtin *row = row_of(i & 1 ? "mandelbrot" : "julia");
        sgt_surface surface = i & 1 ? mandelbrot_surface(&m) : julia_surface(&s);
        bool told = row_objects(row, surface.self, &key), is = is_invalid(surface, row);
        REQUIRE(told == is, "case %ld: %s is %s, the row names %s", i, row->type, is ? "invalid" : "valid",
                told ? key : "nothing");
        invalid += is;
    }
    REQUIRE(invalid > n / 10 && invalid < n - n / 10, "%ld of %ld invalid", invalid, n);
}

/* ----------------------------------------------------------------- defaults */

static bool same_hit(const sgt_hit *a, const sgt_hit *b)
{
    return a->status == b->status &&
           (a->status <= 0 || (same_bits(a->t, b->t) && same_bits(a->t_err, b->t_err) &&
                               same_vector(a->p, b->p) && same_vector(a->n, b->n)));
}

static void test_defaults(void **state)
{
    (void)state;
    generator g = seeded("defaults");
    const sgt_julia none = {.c = {-0.6, 0.2, 0.1, 0}}, all = {.c = {-0.6, 0.2, 0.1, 0},
                                                              .ex = {1},
                                                              .ey = {0, 1},
                                                              .ez = {0, 0, 1},
                                                              .iterations = 10,
                                                              .power = 2};
    const sgt_mandelbrot bare = {.at = {0.1}}, given = {.at = {0.1},
                                                        .ex = {1},
                                                        .ey = {0, 1},
                                                        .ez = {0, 0, 1},
                                                        .iterations = 10,
                                                        .power = 2};
    const sgt_surface left[] = {julia_surface(&none), mandelbrot_surface(&bare)},
                      right[] = {julia_surface(&all), mandelbrot_surface(&given)};
    for (int i = 0; i < 2000; i++)
        for (int k = 0; k < 2; k++) {
            sgt_vec3 p = random_point(&g, 1.2), d = random_direction(&g), n, m;
            double f = left[k].ops->value(left[k].self, p, &n), h = right[k].ops->value(right[k].self, p, &m);
            REQUIRE(same_bits(f, h) && same_vector(n, m), "set %d: F by default %g, with numbers %g", k, f,
                    h);
            sgt_ray ray = {.o = {p.x - 4 * d.x, p.y - 4 * d.y, p.z - 4 * d.z}, .d = d};
            sgt_hit a = sgt_intersect(left[k], ray, NULL), b = sgt_intersect(right[k], ray, NULL);
            REQUIRE(same_hit(&a, &b), "set %d: by default %s at %.17g, with numbers %s at %.17g", k,
                    sgt_status_text(a.status), a.t, sgt_status_text(b.status), b.t);
        }
    const sgt_mandelbrot two = {.at = {0.1}, .escape = 2};
    for (int i = 0; i < 200; i++) {
        sgt_vec3 p = random_point(&g, 1.5);
        double f = sgt_mandelbrot_ops.value(&bare, p, NULL), h = sgt_mandelbrot_ops.value(&two, p, NULL);
        REQUIRE(fabs(f - h) <= 1e-14, "mandelbrot: F by default of escape %.17g, with 2 %.17g", f, h);
    }
    /* the safe escape: |c| = 2 has x^2 = x + 2 at 2; c = 0 has x^p = x at 1; the golden ratio for 1 */
    const struct { sgt_julia s; double escape;
    } safe[] = {
        {{.c = {0, -2}, .iterations = 1}, 2},
        {{.iterations = 1}, 1},
        {{.iterations = 1, .power = 7}, 1},
        {{.c = {0, 0, 1}, .iterations = 1}, 1.6180339887498949},
        {{.c = {-6}, .iterations = 1, .power = 3}, 2},
        {{.c = {0, 0, 0, 1}, .iterations = 1, .power = 5}, 1.1673039782614187},
    };
    for (size_t k = 0; k < COUNT_OF(safe); k++) {
        sgt_julia with = safe[k].s;
        with.escape = safe[k].escape;
        for (int i = 0; i < 200; i++) {
            sgt_vec3 p = random_point(&g, 1.5);
            double f = sgt_julia_ops.value(&safe[k].s, p, NULL), h = sgt_julia_ops.value(&with, p, NULL);
            REQUIRE(fabs(f - h) <= 1e-14, "|c| %g, power %d: F by default %.17g, with %.17g as escape %.17g",
                    fabs(with.c[0]), with.power, f, with.escape, h);
        }
    }
}

/* -------------------------------------------------------------- closed forms */

static void test_spheres(void **state)
{
    (void)state;
    generator g = seeded("spheres");
    long n = scaled(3000), two = 0;
    for (long i = 0; i < n; i++) {
        bool of_point = chance(&g, 0.3);
        int power = 2 + below(&g, 7);
        sgt_julia s = {.iterations = of_point ? 1 : 1 + below(&g, 6),
                       .power = power,
                       .escape = chance(&g, 0.3) && !of_point ? 0 : uniform(&g, 2, 10)};
        sgt_mandelbrot m = {.iterations = 1, .power = power, .escape = s.escape};
        sgt_surface surface = of_point ? mandelbrot_surface(&m) : julia_surface(&s);
        long double R = of_point ? (long double)m.escape
                                 : powl(s.escape > 0 ? s.escape : 1, powl(power, -s.iterations));
        sgt_ray ray = {.o = random_point(&g, 6), .d = random_direction(&g), .tmin = -FAR, .tmax = FAR};
        wide o = widen(ray.o), d = widen(ray.d);
        long double a = wide_dot(d, d), b = wide_dot(o, d) / a, c = (wide_dot(o, o) - R * R) / a,
                    D = b * b - c;
        if (fabsl(D) < 1e-6L) continue;
        sgt_hit hit[4];
        int got = sgt_intersect_all(surface, ray, 4, hit, NULL);
        REQUIRE(got == (D > 0 ? 2 : 0),
            "ray %ld: %d roots of a sphere of radius %Lg at a distance of %Lg, power %d, %d iterations",
            i, got, R, sqrtl(c + R * R - b * b), power, s.iterations);
        two += got == 2;
        for (int j = 0; j < got; j++) {
            /* an escape by default is good to a few ulps, R to long doubles */
            long double t = j ? -b + sqrtl(D) : -b - sqrtl(D), off = 4e-15L * R / sqrtl(D);
            REQUIRE(hit[j].status == SGT_HIT && fabsl(hit[j].t - t) <= hit[j].t_err + off,
                    "ray %ld: root %d: %s at %.17g +- %g, of the sphere %.17Lg", i, j,
                    sgt_status_text(hit[j].status), hit[j].t, hit[j].t_err, t);
            REQUIRE(hit[j].t_err <= 1e-11 * (1 + fabs(hit[j].t)) / (double)sqrtl(D), "ray %ld: t_err %g", i,
                    hit[j].t_err);
            /* F = (u - 1) / (u + 1), u = (r / R)^(2 p^N): at the surface its slope is p^N / R outward */
            wide p = widen(hit[j].p), normal = widen(hit[j].n);
            long double size = powl(power, of_point ? 0 : s.iterations) / R;
            REQUIRE(wide_length(wide_difference(normal, wide_times(size / R, p))) <= 1e-10L * size,
                "ray %ld: the gradient is %Lg long, %Lg wanted", i, wide_length(normal), size);
            REQUIRE((hit[j].n.x * ray.d.x + hit[j].n.y * ray.d.y + hit[j].n.z * ray.d.z < 0) == (j == 0),
                    "ray %ld: enters and leaves", i);
        }
        /* the potential of c = 0 is log r */
        sgt_vec3 p = random_point(&g, 3), grad;
        long double r = wide_length(widen(p));
        if (of_point || fabsl(r - 1) < 1e-6L) continue;
        double potential = sgt_julia_potential(&s, p, &grad);
        REQUIRE(fabsl(potential - (r > 1 ? logl(r) : 0)) <= 1e-13L * r,
                "point %ld: the potential is %.17g, log r %.17Lg", i, potential, logl(r));
        REQUIRE(wide_length(wide_difference(widen(grad), wide_times(r > 1 ? 1 / (r * r) : 0, widen(p)))) <=
                    1e-12L / r,
                "point %ld: the gradient of the potential", i);
        REQUIRE(same_bits(potential, sgt_julia_potential(&s, p, NULL)),
                "point %ld: another potential without the gradient", i);
    }
    REQUIRE(two > n / 10, "%ld of %ld rays with two roots", two, n);
    /* far out the potential of a Mandelbrot set is that of Q_1 = c */
    const sgt_mandelbrot m = {.power = 3};
    REQUIRE(fabs(sgt_mandelbrot_potential(&m, (sgt_vec3){1e100, 0, 0}, NULL) - log(1e100) / 3) < 1e-12,
        "%.17g", sgt_mandelbrot_potential(&m, (sgt_vec3){1e100, 0, 0}, NULL));
}

static void test_on_the_axis(void **state)
{
    (void)state;
    const sgt_ray axis = {.o = {-5, 0, 0}, .d = {1, 0, 0}};
    const sgt_mandelbrot second = {.iterations = 2};
    const sgt_julia basilica = {.c = {-1}, .iterations = 2, .escape = 2}; /* ((x^2 - 1)^2 - 1)^2 = 4 */
    const struct { sgt_surface s; double root[2];
    } cases[] = {
        {mandelbrot_surface(&second), {-2, 1}},
        {julia_surface(&basilica), {-1.6528916502810695, 1.6528916502810695}},
    };
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        sgt_hit hit[4];
        int n = sgt_intersect_all(cases[i].s, axis, 4, hit, NULL);
        REQUIRE(n == 2, "case %zu: %d roots", i, n);
        for (int j = 0; j < 2; j++)
            REQUIRE(hit[j].status == SGT_HIT &&
                        fabs(hit[j].t - (5 + cases[i].root[j])) <= hit[j].t_err + 2e-15 &&
                        hit[j].t_err < 1e-13,
                    "case %zu: root %d: %s at %.17g +- %g", i, j, sgt_status_text(hit[j].status), hit[j].t,
                    hit[j].t_err);
    }
}

/* c = -2, E = 2: on the real axis |Q_N| = |2 cos(2^N a)| is 2 at x = 2 cos(k pi / 2^N), and less
 * between.  At k = 0 and 2^N the ray enters and leaves; the others only touch, from inside. */
static void test_touching(void **state)
{
    (void)state;
    for (int N = 1; N <= 6; N++) {
        const sgt_julia s = {.c = {-2}, .iterations = N, .escape = 2};
        const sgt_ray axis = {.o = {-5, 0, 0}, .d = {1, 0, 0}};
        sgt_hit hit[MOST];
        int n = sgt_intersect_all(julia_surface(&s), axis, MOST, hit, NULL), whole = 1 << N;
        REQUIRE(n >= 3 && n <= MOST, "N = %d: %d entries", N, n);
        REQUIRE(hit[0].status == SGT_HIT && fabs(hit[0].t - 3) <= hit[0].t_err,
            "N = %d: enters at %.17g: %s", N, hit[0].t, sgt_status_text(hit[0].status));
        REQUIRE(hit[n - 1].status == SGT_HIT && fabs(hit[n - 1].t - 7) <= hit[n - 1].t_err,
            "N = %d: leaves at %.17g: %s", N, hit[n - 1].t, sgt_status_text(hit[n - 1].status));
        for (int k = 0; k <= whole; k++) {
            double root = 5 + 2 * cos(3.141592653589793 * k / whole);
            bool reported = false;
            for (int j = 0; j < n; j++)
                reported = reported ||
                           (hit[j].status > 0 ? fabs(hit[j].t - root) <= hit[j].t_err + 1e-15
                                              : hit[j].lo - 1e-15 <= root && hit[j].hi + 1e-15 >= root);
            REQUIRE(reported, "N = %d: the touch at %.17g is in none of %d entries", N, root, n);
        }
        for (int j = 0; j < n; j++) {
            double off = FAR;
            for (int k = 0; k <= whole; k++)
                off = fmin(off, fabs(hit[j].t - 5 - 2 * cos(3.141592653589793 * k / whole)));
            REQUIRE(off <= hit[j].t_err + 1e-15 && hit[j].t_err < 1e-5,
                    "N = %d: entry %d, %s at %.17g +- %g, is %g from every touch", N, j,
                    sgt_status_text(hit[j].status), hit[j].t, hit[j].t_err, off);
            REQUIRE(j == 0 || hit[j].t >= hit[j - 1].t, "N = %d: out of order", N);
        }
        sgt_hit first = sgt_intersect(julia_surface(&s), axis, NULL);
        REQUIRE(first.status == SGT_HIT && fabs(first.t - 3) <= first.t_err,
            "N = %d: the first: %s at %.17g", N, sgt_status_text(first.status), first.t);
    }
}

/* The sphere |Q| = 1 (c = 0, E = 1, any N), touched from inside by less than rounding can tell: two roots,
 * told as such, as a graze or as an undecided stretch, and no miss. */
static void test_nearly_tangent(void **state)
{
    (void)state;
    generator g = seeded("nearly tangent");
    static const char *const told[] = {"undecided", "missed", "hits", "grazes"};
    long n = scaled(20000), of[4] = {0};
    for (long i = 0; i < n; i++) {
        sgt_julia s = {.iterations = 1 + below(&g, 12), .power = 2 + below(&g, 3), .escape = 1};
        sgt_vec3 d = random_direction(&g), u = random_direction(&g);
        double along = u.x * d.x + u.y * d.y + u.z * d.z,
               away = chance(&g, 0.5) ? uniform(&g, 1, 5) : log_uniform(&g, 1, 1e8);
        u = (sgt_vec3){u.x - along * d.x, u.y - along * d.y, u.z - along * d.z};
        double by = (1 - log_uniform(&g, 1e-17, 1e-11)) / sqrt(u.x * u.x + u.y * u.y + u.z * u.z);
        sgt_ray ray = {.o = {by * u.x - away * d.x, by * u.y - away * d.y, by * u.z - away * d.z},
                       .d = d,
                       .tmin = -FAR,
                       .tmax = FAR};
        wide o = widen(ray.o), w = widen(ray.d),
             p = wide_sum(o, wide_times(-wide_dot(o, w) / wide_dot(w, w), w));
        if (!(1 - wide_dot(p, p) > 1e-18L * (1 + away))) continue; /* for certain inside */
        sgt_hit all[4], first = sgt_intersect(julia_surface(&s), ray, NULL);
        int count = sgt_intersect_all(julia_surface(&s), ray, 4, all, NULL);
        REQUIRE(count > 0 && first.status != SGT_MISS,
                "case %ld: N = %d, power %d, from %g away: a miss, the ray is %Lg inside", i, s.iterations,
                s.power, away, 0.5L * (1 - wide_dot(p, p)));
        of[first.status < 0 ? 0 : first.status == SGT_HIT ? 2 : 3]++;
        for (int proof = SGT_PROVE_ROOT; proof <= SGT_PROVE_FIRST; proof++) {
            first = sgt_intersect(julia_surface(&s), ray, &(sgt_options){.proof = (sgt_proof)proof});
            REQUIRE(first.status != SGT_MISS, "case %ld: a proven miss, the ray is %Lg inside", i,
                    0.5L * (1 - wide_dot(p, p)));
        }
    }
    for (int k = 0; k < 4; k++) print_message("%s %ld  ", told[k], of[k]);
    print_message("\n");
    REQUIRE(of[0] > n / 100 && of[2] > n / 100 && of[3] > n / 100, "these rays are no test");
}

/* -------------------------------------------------------------- from afar */

/* From afar an ulp of t is long beside the folds of the set.  A root is proven nevertheless where the next
 * one is more than that away. */
static void test_from_afar(void **state)
{
    (void)state;
    generator g = seeded("from afar");
    static const sgt_proof proofs[] = {SGT_PROVE_ROOT, SGT_PROVE_FIRST};
    long n = scaled(1000), met = 0;
    for (long i = 0; i < n; i++) {
        sgt_julia s = {.iterations = 6 + below(&g, 15), .escape = chance(&g, 0.5) ? 0 : 3};
        for (int k = 0; k < 4; k++) s.c[k] = uniform(&g, -0.8, 0.8);
        sgt_vec3 at = random_point(&g, 0.8), d = random_direction(&g);
        double away = log_uniform(&g, 1e8, 1e12);
        sgt_ray ray = {.o = {at.x - away * d.x, at.y - away * d.y, at.z - away * d.z}, .d = d};
        sgt_hit all[2];
        int count = sgt_intersect_all(julia_surface(&s), ray, 2, all, NULL);
        if (count < 1 || all[0].status != SGT_HIT) continue;
        if (count > 1 && (all[1].status != SGT_HIT || all[1].t - all[1].t_err <= all[0].t + 2 * all[0].t_err))
            continue;
        met++;
        for (size_t k = 0; k < COUNT_OF(proofs); k++) {
            sgt_hit hit = sgt_intersect(julia_surface(&s), ray, &(sgt_options){.proof = proofs[k]});
            REQUIRE(hit.status == SGT_HIT && hit.t == all[0].t,
                    "case %ld, from %g away: the first root, %.17g +- %g, is %s under proof %d", i, away,
                    all[0].t, all[0].t_err, sgt_status_text(hit.status), proofs[k]);
        }
    }
    REQUIRE(10 * met > n, "only %ld of %ld rays are of use", met, n);
}

/* The list goes on behind what is not proven: from afar some roots are too near to the next for a proof,
 * and others are not. */
static void test_all_proven_or_not(void **state)
{
    (void)state;
    generator g = seeded("proven or not, all are told");
    long n = scaled(400), behind = 0;
    for (long i = 0; i < n; i++) {
        sgt_julia s = {.iterations = 8 + below(&g, 12), .escape = chance(&g, 0.5) ? 0 : 3};
        for (int k = 0; k < 4; k++) s.c[k] = uniform(&g, -0.8, 0.8);
        sgt_vec3 at = random_point(&g, 0.8), d = random_direction(&g);
        double away = log_uniform(&g, 1e8, 1e13);
        sgt_ray ray = {.o = {at.x - away * d.x, at.y - away * d.y, at.z - away * d.z}, .d = d};
        sgt_hit plain[MOST], proven[MOST];
        const sgt_options opt = {.proof = SGT_PROVE_ROOT, .max_evals = 100000};
        int count = sgt_intersect_all(julia_surface(&s), ray, MOST, plain,
                                      &(sgt_options){.max_evals = 100000}),
            told = sgt_intersect_all(julia_surface(&s), ray, MOST, proven, &opt);
        if (count > MOST || told > MOST) continue;
        bool undecided = false;
        for (int j = 0; j < told; j++)
            behind += undecided && proven[j].status > 0, undecided = undecided || proven[j].status < 0;
        for (int j = 0; j < count; j++) {
            bool in = plain[j].status < 0;
            for (int k = 0; k < told; k++)
                in = in || (plain[j].t >= proven[k].lo && plain[j].t <= proven[k].hi);
            REQUIRE(in,
                    "case %ld, from %g away: the root %.17g, %d of %d, is in none of %d entries under proof",
                    i, away, plain[j].t, j, count, told);
        }
    }
    print_message("%ld proven roots behind what is not\n", behind);
    REQUIRE(n < 400 || behind > n / 20, "%ld of %ld: these rays are no test", behind, n);
}

/* A start on the set, at the origin of its frame: there the rule of the start is t_err and little else,
 * which is wide for t.  What is told is behind it, alone and in a batch. */
static void test_start_at_origin(void **state)
{
    (void)state;
    generator g = seeded("a start on the set");
    long n = scaled(20000), met = 0, at_start = 0;
    for (long i = 0; i < n; i++) {
        sgt_julia s = {.ex = {1},
                       .ey = {0, 1},
                       .ez = {0, 0, 1},
                       .iterations = 2 + below(&g, 8),
                       .escape = chance(&g, 0.5) ? 0 : 3};
        for (int k = 0; k < 4; k++) s.c[k] = uniform(&g, -0.7, 0.7);
        sgt_mandelbrot m = sliced_alike(&s);
        sgt_surface surface = chance(&g, 0.5) ? julia_surface(&s) : mandelbrot_surface(&m);
        sgt_vec3 d = random_direction(&g), at = random_point(&g, 0.5);
        sgt_hit on = sgt_intersect(
            surface, (sgt_ray){.o = {at.x - 3 * d.x, at.y - 3 * d.y, at.z - 3 * d.z}, .d = d}, NULL);
        if (on.status != SGT_HIT) continue;
        s.at[0] += on.p.x, s.at[1] += on.p.y, s.at[2] += on.p.z; /* the origin is there now, to rounding */
        m = sliced_alike(&s);
        double off = chance(&g, 0.3) ? 0 : log_uniform(&g, 1e-18, 1e-14);
        sgt_ray ray = {.o = {off * d.x, off * d.y, off * d.z},
                       .d = chance(&g, 0.5) ? d : random_direction(&g)};
        sgt_hit hit = sgt_intersect(surface, ray, NULL);
        double t, t_err, tmax = FAR;
        sgt_status status;
        sgt_rays one = {.o = {&ray.o.x, &ray.o.y, &ray.o.z},
                        .d = {&ray.d.x, &ray.d.y, &ray.d.z},
                        .tmin = &ray.tmin,
                        .tmax = &tmax};
        sgt_intersect_batch(surface, 1, one, (sgt_hits){.status = &status, .t = &t, .t_err = &t_err}, NULL);
        if (hit.status == SGT_HIT)
            REQUIRE(hit.t > hit.t_err, "case %ld: t %.17g, t_err %g: the start itself", i, hit.t, hit.t_err);
        if (status == SGT_HIT)
            REQUIRE(t > t_err, "case %ld, in a batch: t %.17g, t_err %g: the start itself", i, t, t_err);
        sgt_hit line[MOST];
        ray.tmin = -FAR, ray.tmax = 1e-12;
        int roots = sgt_intersect_all(surface, ray, MOST, line, NULL);
        for (int j = 0; j < roots && j < MOST; j++)
            at_start += line[j].status == SGT_HIT && line[j].t > 0 && line[j].t <= line[j].t_err;
        met += hit.status == SGT_HIT;
    }
    print_message("%ld rays meet the set, of %ld the start is a root a little ahead\n", met, at_start);
    REQUIRE(met > n / 10 && at_start > n / 100, "these rays are no test");
}

/* -------------------------------------------------------------- t_tol */

enum { RAYS = 48, NUMBERS = 10 };

static void numbers_of(const sgt_hit *h, double to[NUMBERS])
{
    const double all[NUMBERS] = {h->t,   h->t_err, h->t_lo, h->p_err, h->p.x,
                                 h->p.y, h->p.z,   h->n.x,  h->n.y,   h->n.z};
    memcpy(to, all, sizeof all);
}

/* A batch of rays, as hits. */
static void meet_all(sgt_surface s, const sgt_ray ray[RAYS], const sgt_options *opt, sgt_hit hit[RAYS])
{
    static double in[8][RAYS], out[NUMBERS][RAYS];
    static sgt_status status[RAYS];
    static int evals[RAYS];
    for (int i = 0; i < RAYS; i++) {
        sgt_vec3 o = ray[i].o, d = ray[i].d;
        const double numbers[8] = {o.x, o.y, o.z, d.x, d.y, d.z, ray[i].tmin, end_of(&ray[i])};
        for (int k = 0; k < 8; k++) in[k][i] = numbers[k];
    }
    const sgt_rays rays = {{in[0], in[1], in[2]}, {in[3], in[4], in[5]}, in[6], in[7]};
    const sgt_hits hits = {.status = status, .evals = evals, .t = out[0], .t_err = out[1], .t_lo = out[2],
                           .p_err = out[3], .p = {out[4], out[5], out[6]}, .n = {out[7], out[8], out[9]}};
    sgt_intersect_batch(s, RAYS, rays, hits, opt);
    for (int i = 0; i < RAYS; i++)
        hit[i] = (sgt_hit){.status = (sgt_status)status[i],
                           .evals = evals[i],
                           .t = out[0][i],
                           .t_err = out[1][i],
                           .t_lo = out[2][i],
                           .p_err = out[3][i],
                           .p = {out[4][i], out[5][i], out[6][i]},
                           .n = {out[7][i], out[8][i], out[9][i]}};
}

/* A looser t_tol: the batch is the single ray to the bit; the same rays are met, where the root is within
 * t_err, and t_err as wanted; and a first root takes no more evaluations than to rounding, but one where
 * rounding hides a sign.  Of rays that start on the surface, which go on behind a root that is refused, all
 * together take no more. */
static void test_tolerances(void **state)
{
    (void)state;
    generator g = seeded("tolerances");
    long n = scaled(400), fewer = 0, met = 0, missed = 0, hidden = 0, refused = 0, start_exact = 0,
         start_loose = 0;
    for (long i = 0; i < n; i++) {
        sgt_julia s = {.iterations = 1 + below(&g, chance(&g, 0.1) ? 20 : 16), .power = 2};
        if (chance(&g, 0.4)) s.power = 2 + below(&g, 7);
        if (chance(&g, 0.3)) s.escape = uniform(&g, 3, 10);
        for (int k = 0; k < 4; k++)
            s.c[k] = uniform(&g, -0.7, 0.7), s.at[k] = chance(&g, 0.5) ? 0 : uniform(&g, -0.3, 0.3);
        if (chance(&g, 0.2)) memcpy(s.c, (double[4]){-0.083, 0, -0.83, -0.025}, sizeof s.c);
        if (chance(&g, 0.2)) memcpy(s.c, (double[4]){0, 1, 0, 0}, sizeof s.c);
        sgt_mandelbrot m = sliced_alike(&s);
        sgt_surface surface = i % 4 == 3 ? mandelbrot_surface(&m) : julia_surface(&s);
        double unit = chance(&g, 0.5) ? 1 : log_uniform(&g, 1e-3, 1e3),
               t_tol = unit * log_uniform(&g, 1e-8, 0.3);
        sgt_ray ray[RAYS];
        bool on_surface[RAYS] = {false};
        for (int k = 0; k < RAYS; k++) {
            sgt_vec3 at = random_point(&g, 0.9), d = random_direction(&g);
            double away = chance(&g, 0.2) ? 0 : uniform(&g, 1, 5);
            ray[k] = (sgt_ray){.o = {at.x - away * d.x, at.y - away * d.y, at.z - away * d.z},
                               .d = {d.x / unit, d.y / unit, d.z / unit}};
            if (chance(&g, 0.2))
                ray[k].tmin = unit * uniform(&g, -3, 3), ray[k].tmax = ray[k].tmin + unit * uniform(&g, 0, 5);
            if (k > 0 && chance(&g, 0.2)) { /* from the surface */
                sgt_hit before = sgt_intersect(surface, ray[k - 1], NULL);
                if (before.status == SGT_HIT) ray[k].o = before.p, on_surface[k] = true;
            }
        }
        sgt_options exactly = {.max_evals = chance(&g, 0.1) ? 1 + below(&g, 60) : 0}, loosely = exactly;
        loosely.t_tol = t_tol;
        sgt_hit exact[RAYS], loose[RAYS];
        meet_all(surface, ray, &exactly, exact), meet_all(surface, ray, &loosely, loose);
        for (int k = 0; k < RAYS; k++) {
            sgt_hit alone = sgt_intersect(surface, ray[k], &loosely);
            double a[NUMBERS], b[NUMBERS];
            numbers_of(&alone, a), numbers_of(&loose[k], b);
            bool same = alone.status == loose[k].status && alone.evals == loose[k].evals;
            for (int j = 0; j < NUMBERS; j++)
                same = same && (same_bits(a[j], b[j]) || (isnan(a[j]) && isnan(b[j])));
            char which[96];
            snprintf(which, sizeof which, "case %ld, %s, N = %d, power %d, t_tol %g, ray %d", i,
                     surface.ops->name, s.iterations, s.power, t_tol, k);
            REQUIRE(same, "%s: %s at %.17g, %d evaluations, alone %s at %.17g, %d", which,
                    sgt_status_text(loose[k].status), loose[k].t, loose[k].evals,
                    sgt_status_text(alone.status), alone.t, alone.evals);
            const sgt_hit *e = &exact[k], *l = &loose[k];
            if (e->status < 0 || e->status == SGT_GRAZE) continue;
            /* a root that is not farther than t_tol from an end of the ray may be refused */
            double tmin = ray[k].tmin, tmax = ray[k].tmax, near = 2 * t_tol;
            bool cut = tmin != 0 || tmax != 0, at_end = e->t < tmin + near || (cut && e->t > tmax - near);
            if (e->status == SGT_MISS ? cut && l->status != SGT_MISS : at_end) {
                refused++;
                continue;
            }
            REQUIRE(l->status == e->status, "%s: %s, to rounding %s", which, sgt_status_text(l->status),
                sgt_status_text(e->status));
            if (on_surface[k]) start_exact += e->evals, start_loose += l->evals;
            REQUIRE(on_surface[k] || l->evals <= e->evals + 1, "%s: %d evaluations, to rounding %d", which,
                    l->evals, e->evals);
            fewer += l->evals < e->evals, hidden += l->evals > e->evals && !on_surface[k];
            if (e->status == SGT_MISS) {
                missed++;
                continue;
            }
            met++;
            REQUIRE(fabs(l->t - e->t) <= l->t_err + e->t_err, "%s: t %.17g +- %g, to rounding %.17g +- %g",
                    which, l->t, l->t_err, e->t, e->t_err);
            REQUIRE(l->t_err <= t_tol + 4 * e->t_err, "%s: t_err %g, to rounding %g", which, l->t_err,
                    e->t_err);
        }
    }
    print_message("%ld met, %ld missed, %ld with fewer evaluations, %ld with one more; %ld met elsewhere\n",
                  met, missed, fewer, hidden, refused);
    print_message("from the surface %.3f of the evaluations\n", (double)start_loose / (double)start_exact);
    REQUIRE(met > 10 * n && missed > 10 * n && fewer > 10 * n, "these rays are no test");
    REQUIRE(start_loose <= start_exact, "from the surface %ld evaluations, to rounding %ld", start_loose,
            start_exact);
    REQUIRE(1000 * hidden < met + missed, "rounding hides a sign on %ld of %ld rays", hidden, met + missed);
}

/* -------------------------------------------------------------- sgt_check */

static void test_sound(void **state)
{
    (void)state;
    generator g = seeded("sound");
    long n = scaled(200);
    for (long i = 0; i < n; i++) {
        sgt_julia s = {.iterations = 1 + below(&g, 12),
                       .power = chance(&g, 0.5) ? 2 : 2 + below(&g, 7),
                       .escape = chance(&g, 0.7) ? 0 : uniform(&g, 3, 10)};
        double unit = chance(&g, 0.5) ? 1 : log_uniform(&g, 1e-3, 1e3);
        for (int k = 0; k < 4; k++)
            s.c[k] = uniform(&g, -1, 1), s.at[k] = chance(&g, 0.5) ? 0 : uniform(&g, -0.3, 0.3);
        if (chance(&g, 0.5))
            for (int k = 0; k < 4; k++) {
                s.ex[k] = unit * (uniform(&g, -0.2, 0.2) + (k == 0));
                s.ey[k] = unit * (uniform(&g, -0.2, 0.2) + (k == 1));
                s.ez[k] = unit * (uniform(&g, -0.2, 0.2) + (k == 3));
            }
        else unit = 1;
        sgt_mandelbrot m = sliced_alike(&s);
        sgt_surface surface = i & 1 ? mandelbrot_surface(&m) : julia_surface(&s);
        sgt_ray rays[4];
        for (size_t k = 0; k < COUNT_OF(rays); k++) {
            sgt_vec3 at = random_point(&g, 0.8 / unit), d = random_direction(&g);
            double away = uniform(&g, 0, 4) / unit, length = log_uniform(&g, 0.1, 10);
            rays[k] = (sgt_ray){.o = {at.x - away * d.x, at.y - away * d.y, at.z - away * d.z},
                                .d = {length * d.x, length * d.y, length * d.z}};
            if (k & 1) rays[k].tmin = -FAR, rays[k].tmax = FAR;
        }
        sgt_vec3 where;
        sgt_fault fault = sgt_check(surface, COUNT_OF(rays), rays, &where);
        REQUIRE(fault == SGT_SOUND,
                "case %ld, %s, power %d, %d iterations, escape %g: %s at %.17g %.17g %.17g", i,
                surface.ops->name, s.power, s.iterations, s.escape, sgt_fault_text(fault), where.x, where.y,
                where.z);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_rows),
        cmocka_unit_test(test_one_by_one),
        cmocka_unit_test(test_of_one_mind),
        cmocka_unit_test(test_defaults),
        cmocka_unit_test(test_spheres),
        cmocka_unit_test(test_on_the_axis),
        cmocka_unit_test(test_touching),
        cmocka_unit_test(test_nearly_tangent),
        cmocka_unit_test(test_from_afar),
        cmocka_unit_test(test_all_proven_or_not),
        cmocka_unit_test(test_start_at_origin),
        cmocka_unit_test(test_tolerances),
        cmocka_unit_test(test_sound),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
