// SPDX-License-Identifier: MIT
/* Refraction and reflection, seen through sgt_trace at one element: the law in long double,
 * its limits, and normals of every size.  A plane of the user's own gives the normal. */
#include "unit.h"

#include <sagitta/surfaces.h>
#include <sagitta/system.h>

/* F = a . p, the gradient given apart, so that it may be anything. */
typedef struct slant { sgt_vec3 a, told; } slant;

static double slant_value(const void *self, sgt_vec3 p, sgt_vec3 *grad)
{
    const slant *s = self;
    if (grad) *grad = s->told;
    return s->a.x * p.x + s->a.y * p.y + s->a.z * p.z;
}
static sgt_span slant_span(const void *self, const sgt_ray *ray)
{
    const slant *s = self;
    double t = -slant_value(s, ray->o, NULL) / slant_value(s, ray->d, NULL);
    return (sgt_span){.lo = t - 1, .hi = t + 1, .seed = t, .single = true};
}
static const sgt_surface_ops slant_ops = {.name = "slant", .value = slant_value, .span = slant_span};

/* One ray at one slanted plane through the origin. */
static sgt_fate bend(slant s, sgt_vec3 d, double before, double behind, sgt_vec3 *out, sgt_passage *passage)
{
    sgt_ray ray = {.o = {-2 * d.x, -2 * d.y, -2 * d.z}, .d = d};
    sgt_element e = {.surface = {&slant_ops, &s}, .index = behind};
    sgt_fate fate;
    size_t passed = sgt_trace(1, &e, before, &ray, passage, &fate, NULL);
    REQUIRE(passed == (fate == SGT_PASSED), "passed %zu, %s", passed, sgt_fate_text(fate));
    *out = ray.d;
    REQUIRE(fate != SGT_PASSED || same_vector(ray.d, passage->direction), "two directions");
    REQUIRE(fate == SGT_PASSED ||
                (passage->direction.x == 0 && passage->direction.y == 0 && passage->direction.z == 0),
            "a direction, though not passed");
    return fate;
}

/* A unit vector at the angle with the sine s from n, as near as doubles can. */
static sgt_vec3 at_sine(generator *g, sgt_vec3 n, double s)
{
    wide u = wide_unit(widen(n)), side = wide_unit(wide_cross(u, widen(random_direction(g))));
    wide d = wide_sum(wide_times(sqrtl(1 - (long double)s * s), u), wide_times(s, side));
    d = wide_unit(d);
    return (sgt_vec3){(double)d.x, (double)d.y, (double)d.z};
}

static void test_snell(void **state)
{
    (void)state;
    generator g = seeded("Snell's law");
    long n = scaled(200000), tir = 0;
    long double worst = 0, worst_length = 0, worst_exact = 0;
    for (long i = 0; i < n; i++) {
        sgt_vec3 normal = random_direction(&g);
        double size = chance(&g, 0.3) ? either_sign(&g) * log_uniform(&g, 1e-100, 1e100) : either_sign(&g);
        normal = (sgt_vec3){size * normal.x, size * normal.y, size * normal.z};
        double n1 = uniform(&g, 1, 2),
               n2 = chance(&g, 0.1) ? n1 * (1 + 1e-9 * uniform(&g, -1, 1)) : uniform(&g, 1, 2);
        if (chance(&g, 0.1)) n1 = log_uniform(&g, 1e-3, 1e3);
        double s = chance(&g, 0.2)   ? log_uniform(&g, 1e-12, 1)
                   : chance(&g, 0.2) ? sqrt(1 - pow(log_uniform(&g, 1e-6, 1), 2))
                                     : uniform(&g, 0, 1);
        /* about the limit */
        if (chance(&g, 0.2) && n1 > n2)
            s = fmin(1, n2 / n1 * (1 + either_sign(&g) * log_uniform(&g, 1e-15, 1e-3)));
        sgt_vec3 d = at_sine(&g, normal, s), out;
        sgt_passage passage;
        slant plane = {normal, normal};
        /* along the plane, as far as F tells: no root is the one */
        if (slant_value(&plane, d, NULL) == 0) continue;
        sgt_fate fate = bend(plane, d, n1, n2, &out, &passage);
        REQUIRE(fate == SGT_PASSED || fate == SGT_TIR, "case %ld: %s, %s", i, sgt_fate_text(fate),
                sgt_status_text(passage.hit.status));

        wide N = wide_unit(widen(normal)), d1 = wide_unit(widen(d));
        long double c = wide_dot(d1, N), r = (long double)n1 / n2, sine = wide_length(wide_cross(d1, N));
        long double Q = (1 - r * sine) * (1 + r * sine);
        /* what the rounding of d and of the normal does to Q near the limit */
        if (fabsl(Q) > 4e-15L)
            REQUIRE((Q < 0) == (fate == SGT_TIR), "case %ld: Q %Lg, %s", i, Q, sgt_fate_text(fate));
        if (fate == SGT_TIR) {
            tir++;
            continue;
        }
        wide d2 = widen(out),
             law = wide_difference(wide_times(n1, wide_cross(d1, N)), wide_times(n2, wide_cross(d2, N)));
        long double off = wide_length(law) / fmaxl(n1, n2);
        REQUIRE(wide_dot(d2, N) * c >= 0 || fabsl(Q) < 1e-15L, "case %ld: it goes back", i);
        worst = fmaxl(worst, off);
        worst_length = fmaxl(worst_length, fabsl(wide_length(d2) - 1));
        /* and the direction itself, wherever it is not near the limit */
        wide want = wide_sum(wide_times(r, d1), wide_times(copysignl(sqrtl(fmaxl(Q, 0)), c) - r * c, N));
        if (Q > 0.01L) worst_exact = fmaxl(worst_exact, wide_length(wide_difference(want, d2)) / fmaxl(1, r));
    }
    print_message(
        "law within %.2Lf, length within %.2Lf, direction within %.2Lf of 2^-53; %ld of %ld reflected\n",
        worst * 0x1p53L, worst_length * 0x1p53L, worst_exact * 0x1p53L, tir, n);
    REQUIRE(worst <= 6 * 0x1p-53L, "n1 d1 x N differs from n2 d2 x N by %Lg", worst);
    REQUIRE(worst_length <= 0x1p-52L, "the length is off by %Lg", worst_length);
    /* at Q = 0.01 an error of Q is five times that in the direction, and Q itself has four roundings */
    REQUIRE(worst_exact <= 32 * 0x1p-53L, "the direction is off by %Lg", worst_exact);
}

/* A ray along the axis at a paraboloid of curvature c: small angles keep their relative precision. */
static void test_paraxial(void **state)
{
    (void)state;
    for (double y = 1; y > 1e-14; y *= 0.01) {
        sgt_conic shape = {.c = 1e-3, .k = -1};
        sgt_element e = {.surface = {&sgt_conic_ops, &shape}, .index = 1.5};
        sgt_ray ray = {.o = {0, y, -10}, .d = {0, 0, 1}};
        sgt_fate fate;
        sgt_trace(1, &e, 1, &ray, NULL, &fate, NULL);
        assert_int_equal(fate, SGT_PASSED);
        /* Snell, at the angle of the normal */
        long double a = atanl(1e-3L * y), slope = sinl(a), b = asinl(slope / 1.5L), want = sinl(b - a);
        REQUIRE(fabsl(ray.d.y - want) <= 1e-12L * fabsl(want), "height %g: %.17g, %.17Lg wanted", y, ray.d.y,
                want);
    }
}

static void test_mirror(void **state)
{
    (void)state;
    generator g = seeded("mirror");
    long n = scaled(100000);
    long double worst = 0;
    for (long i = 0; i < n; i++) {
        sgt_vec3 normal = random_direction(&g), out;
        double size = either_sign(&g) * log_uniform(&g, 1e-100, 1e100), index = uniform(&g, 1, 2);
        normal = (sgt_vec3){size * normal.x, size * normal.y, size * normal.z};
        sgt_vec3 d = at_sine(&g, normal, chance(&g, 0.2) ? 1 - log_uniform(&g, 1e-12, 1) : uniform(&g, 0, 1));
        sgt_passage passage;
        sgt_fate fate = bend((slant){normal, normal}, d, index, SGT_MIRROR, &out, &passage);
        REQUIRE(fate == SGT_PASSED, "case %ld: %s", i, sgt_fate_text(fate));
        wide N = wide_unit(widen(normal)), d1 = widen(d),
             want = wide_difference(d1, wide_times(2 * wide_dot(d1, N), N));
        worst = fmaxl(worst, wide_length(wide_difference(wide_unit(want), widen(out))));
    }
    print_message("within %.2Lf of 2^-53\n", worst * 0x1p53L);
    REQUIRE(worst <= 6 * 0x1p-53L, "the direction is off by %Lg", worst);
}

/* Behind a mirror the index is that in front of it, and positive. */
static void test_index_behind_mirror(void **state)
{
    (void)state;
    sgt_conic flat = {0};
    sgt_element e[] = {
        {.surface = {&sgt_conic_ops, &flat}, .pose = {.origin = {0, 0, 1}}, .index = 1.5},
        {.surface = {&sgt_conic_ops, &flat}, .pose = {.origin = {0, 0, 3}}, .index = SGT_MIRROR},
        {.surface = {&sgt_conic_ops, &flat}, .pose = {.origin = {0, 0, 1}}, .index = 1},
    };
    sgt_ray ray = {.o = {0, 0, 0}, .d = {0, 0.6, 0.8}}, start = ray;
    sgt_passage p[3];
    sgt_fate fate;
    assert_int_equal(sgt_trace(3, e, 1, &ray, p, &fate, NULL), 3);
    REQUIRE(fabs(ray.d.y - start.d.y) < 1e-15 && fabs(ray.d.z + start.d.z) < 1e-15, "out at %g %g", ray.d.y,
            ray.d.z);
    double inside = sqrt(1 - 0.16);
    REQUIRE(fabs(p[2].opl - (1 / 0.8 + 2 * 1.5 * 2 / inside)) < 1e-14, "opl %.17g", p[2].opl);
}

static void test_equal_indices(void **state)
{
    (void)state;
    generator g = seeded("equal indices");
    for (long i = 0, n = scaled(5000); i < n; i++) {
        sgt_vec3 normal = random_direction(&g), d = random_direction(&g), out;
        double index = uniform(&g, 1, 2);
        sgt_passage passage;
        if (fabs(normal.x * d.x + normal.y * d.y + normal.z * d.z) < 1e-6) continue;
        sgt_ray ray = {.d = d};
        sgt_trace(0, NULL, 1, &ray, NULL, NULL, NULL); /* of unit length */
        for (int same = 0; same < 2; same++) {
            sgt_fate fate = bend((slant){normal, normal}, ray.d, index, same ? index : 0, &out, &passage);
            REQUIRE(fate == SGT_PASSED && same_vector(out, ray.d), "case %ld: a bend between equal indices",
                    i);
        }
        /* nor does a turned frame disturb it */
        sgt_conic flat = {0};
        sgt_element e = {.surface = {&sgt_conic_ops, &flat},
                         .pose = sgt_pose_tilted((sgt_vec3){0.1, 0.2, 0.3}, random_point(&g, 40))};
        sgt_ray turned = {.o = {1, 2, 3}, .d = ray.d};
        if (sgt_trace(1, &e, index, &turned, NULL, NULL, NULL) == 1)
            REQUIRE(same_vector(turned.d, ray.d), "case %ld: a bend in a turned frame", i);
    }
}

/* Normals beyond the ordinary: one infinite component is a direction, two are none. */
static void test_strange_normals(void **state)
{
    (void)state;
    const sgt_vec3 a = {0, 0, 1}, d = {0.6, 0, 0.8};
    sgt_vec3 out, plain;
    sgt_passage passage;
    assert_int_equal(bend((slant){a, a}, d, 1, 1.5, &plain, &passage), SGT_PASSED);
    const struct { sgt_vec3 told; sgt_fate fate;
    } normals[] = {
        {{0, 0, FAR}, SGT_PASSED},     {{0, 0, -FAR}, SGT_PASSED},    {{1e10, 3, FAR}, SGT_PASSED},
        {{0, 0, DBL_MAX}, SGT_PASSED}, {{0, 0, -1e-320}, SGT_PASSED}, {{FAR, 0, FAR}, SGT_LOST},
        {{0, -FAR, FAR}, SGT_LOST},    {{NOT, 0, 1}, SGT_LOST},       {{0, NOT, FAR}, SGT_LOST},
        {{0, 0, 0}, SGT_LOST},         {{NOT, NOT, NOT}, SGT_LOST},
    };
    for (size_t i = 0; i < COUNT_OF(normals); i++) {
        sgt_fate fate = bend((slant){a, normals[i].told}, d, 1, 1.5, &out, &passage);
        REQUIRE(fate == normals[i].fate, "normal %zu: %s", i, sgt_fate_text(fate));
        if (fate == SGT_PASSED)
            REQUIRE(fabs(out.x - plain.x) < 1e-15 && fabs(out.z - plain.z) < 1e-15,
                    "normal %zu: another direction", i);
        else
            REQUIRE(passage.hit.status == SGT_UNDEFINED && isnan(passage.hit.t) && isnan(passage.opl),
                    "normal %zu: %s", i, sgt_status_text(passage.hit.status));
        fate = bend((slant){a, normals[i].told}, d, 1, SGT_MIRROR, &out, &passage);
        REQUIRE(fate == normals[i].fate, "normal %zu, mirror: %s", i, sgt_fate_text(fate));
        if (fate == SGT_PASSED)
            REQUIRE(fabs(out.x - d.x) < 1e-15 && fabs(out.z + d.z) < 1e-15,
                    "normal %zu, mirror: another direction", i);
        /* between equal indices no normal is needed */
        assert_int_equal(bend((slant){a, normals[i].told}, d, 1.5, 1.5, &out, &passage), SGT_PASSED);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_snell),         cmocka_unit_test(test_paraxial),
        cmocka_unit_test(test_mirror),        cmocka_unit_test(test_index_behind_mirror),
        cmocka_unit_test(test_equal_indices), cmocka_unit_test(test_strange_normals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
