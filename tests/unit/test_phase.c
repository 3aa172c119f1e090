// SPDX-License-Identifier: MIT
/* Ideal lenses: slopes, mirrors, light both ways, paths from a point to its image, and phases that are not
 * sound. */
#include "unit.h"

#include <sagitta/aim.h>
#include <sagitta/surfaces.h>
#include <sagitta/system.h>

static const sgt_conic flat = {0};

static sgt_phase lens_of(double f, double object)
{
    return (sgt_phase){.kind = SGT_IDEAL_LENS, .focal_length = f, .object_distance = object};
}

static sgt_element element_of(const sgt_phase *phase, double index, double z)
{
    return (sgt_element){
        .surface = {&sgt_conic_ops, &flat}, .pose = {.origin = {0, 0, z}}, .index = index, .phase = phase};
}

static sgt_vec3 unit_of(long double x, long double y, long double z)
{
    wide d = wide_unit((wide){x, y, z});
    return (sgt_vec3){(double)d.x, (double)d.y, (double)d.z};
}

/* Two equal focal lengths are one, to the bit; an infinite one is the section of a lens. */
static void test_two_powers(void **state)
{
    (void)state;
    generator g = seeded("two powers");
    for (int i = 0; i < 2000; i++) {
        const double f = (chance(&g, 0.5) ? 1 : -1) * uniform(&g, 1, 100), n1 = uniform(&g, 1, 2);
        sgt_phase one = lens_of(f, chance(&g, 0.5) ? 0 : uniform(&g, -50, 50)), two = one, flat_in_x = one;
        two.focal_length_y = f, flat_in_x.focal_length_y = f, flat_in_x.focal_length = HUGE_VAL;
        const sgt_phase *const kinds[] = {&one, &two, &flat_in_x};
        const double x = uniform(&g, -3, 3), u = uniform(&g, -1, 1);
        sgt_passage is[3], in_section[3];
        for (int k = 0; k < 3; k++) {
            const sgt_element e = element_of(kinds[k], 1.5, 0);
            sgt_ray ray = {.o = {x, 2, -1}, .d = {u, 0.2, 1}}, across = {.o = {0, 2, -1}, .d = {0, u, 1}};
            sgt_trace(1, &e, n1, &ray, &is[k], NULL, NULL);
            sgt_trace(1, &e, n1, &across, &in_section[k], NULL, NULL);
        }
        REQUIRE(memcmp(&is[0], &is[1], sizeof is[0]) == 0, "two powers of one size, f = %a", f);
        const sgt_passage *a = &in_section[0], *b = &in_section[2];
        REQUIRE(fabs(a->direction.y - b->direction.y) <= 0x1p-50 && fabs(a->opl - b->opl) <= 0x1p-45,
                "a cylinder in its section, f = %a", f);
        /* n2 u' = n1 u without power */
        const sgt_passage *c = &is[2];
        REQUIRE(fabs(1.5 * c->direction.x / c->direction.z - n1 * u) <= 0x1p-46, "along a cylinder, f = %a",
                f);
    }
}

/* 0, or a conjugate of any kind. */
static double random_object(generator *g, double f, double n1)
{
    switch (below(g, 5)) {
    case 0:
        return chance(g, 0.5) ? 0 : either_sign(g) * FAR;
    case 1:
        return n1 * f; /* the image at infinity */
    case 2:
        return 2 * n1 * f;
    default:
        return either_sign(g) * log_uniform(g, 0.1, 100) * fabs(f);
    }
}

/* ------------------------------------------------------------------ slopes */

static void test_slopes(void **state)
{
    (void)state;
    generator g = seeded("slopes");
    long n = scaled(20000);
    double worst = 0;
    for (long i = 0; i < n; i++) {
        double n1 = chance(&g, 0.5) ? 1 : uniform(&g, 1, 2), n2 = chance(&g, 0.5) ? n1 : uniform(&g, 1, 2);
        bool mirror = chance(&g, 0.3);
        if (mirror) n2 = n1;
        double f = either_sign(&g) * log_uniform(&g, 1e-3, 1e3), to = either_sign(&g);
        sgt_vec3 p = {uniform(&g, -2, 2) * f, uniform(&g, -2, 2) * f, 0};
        sgt_vec3 d = unit_of(uniform(&g, -2, 2), uniform(&g, -2, 2), to);
        sgt_phase phase = lens_of(f, random_object(&g, f, n1));
        sgt_element e = element_of(&phase, mirror ? SGT_MIRROR : n1 == n2 && chance(&g, 0.5) ? 0 : n2, 0);
        sgt_ray ray = {.o = p, .d = d};
        sgt_passage is;
        assert_int_equal(sgt_trace(1, &e, n1, &ray, &is, NULL, NULL), 1);
        long double size = fabsl((long double)d.z), u = d.x / size, v = d.y / size;
        wide right = wide_unit((wide){(n1 * u - p.x / (long double)f) / n2,
                                      (n1 * v - p.y / (long double)f) / n2, mirror ? -to : to});
        wide off = wide_difference(widen(is.direction), right);
        double most = (double)fmaxl(fabsl(off.x), fmaxl(fabsl(off.y), fabsl(off.z)));
        worst = fmax(worst, most);
        REQUIRE(most <= 0x1p-50, "lens %ld: off by %g", i, most);
        REQUIRE((is.direction.z > 0) == (mirror ? to < 0 : to > 0), "lens %ld: the way", i);
        REQUIRE(same_vector(ray.d, is.direction) && is.hit.t == 0, "lens %ld: at return", i);
    }
    printf("%g of 2^-53\n", worst * 0x1p53);
}

/* What the signs mean: f > 0 focuses, both ways and reflected. */
static void test_signs(void **state)
{
    (void)state;
    for (int back = 0; back < 2; back++)
        for (int mirror = 0; mirror < 2; mirror++) {
            double to = back ? -1 : 1;
            sgt_phase phase = lens_of(50, 0);
            sgt_element e = element_of(&phase, mirror ? SGT_MIRROR : 0, 0);
            sgt_ray ray = {.o = {3, -4, -7 * to}, .d = {0, 0, to}};
            sgt_passage is;
            assert_int_equal(sgt_trace(1, &e, 1, &ray, &is, NULL, NULL), 1);
            double on = mirror ? -to : to, t = 50 * on / ray.d.z;
            assert_true(ray.d.z * on > 0);
            assert_true(fabs(3 + t * ray.d.x) < 1e-14 && fabs(-4 + t * ray.d.y) < 1e-14);
            /* along the axis and at the vertex: 7, and 50 behind; at the rim as much */
            assert_true(fabs(is.opl + sqrt(50 * 50 + 25) - 57) < 1e-14);
        }
    /* between unlike media the foci are n1 f in front and n2 f behind */
    sgt_phase phase = lens_of(20, 0);
    sgt_element e = element_of(&phase, 1.5, 0);
    sgt_ray ray = {.o = {0, 2, -1}, .d = {0, 0, 1}};
    assert_int_equal(sgt_trace(1, &e, 1.25, &ray, NULL, NULL, NULL), 1);
    assert_true(fabs(2 + 30 * ray.d.y / ray.d.z) < 1e-14);
    ray = (sgt_ray){.o = {0, 0, -25}, .d = unit_of(0, 2, 25)};
    assert_int_equal(sgt_trace(1, &e, 1.25, &ray, NULL, NULL, NULL), 1);
    assert_true(fabs(ray.d.y) < 1e-16);
    /* from the focal point in air: parallel, as well as the doubles say */
    ray = (sgt_ray){.o = {3, 4, 0}, .d = {0.6, 0, 0.8}};
    phase = lens_of(4, 0), e = element_of(&phase, 0, 0);
    assert_int_equal(sgt_trace(1, &e, 1, &ray, NULL, NULL, NULL), 1);
    assert_true(fabs(ray.d.x) < 0x1p-54);
}

/* ------------------------------------------------------------------- paths */

/* Tilted, somewhere, and turned about: a pose that changes nothing of what is asked. */
static sgt_pose random_pose(generator *g)
{
    return sgt_pose_tilted(random_point(g, 5),
                           (sgt_vec3){uniform(g, -180, 180), uniform(g, -180, 180), uniform(g, -180, 180)});
}

static sgt_vec3 onto(const sgt_pose *pose, wide a, bool place)
{
    wide b = wide_sum(wide_sum(wide_times(a.x, widen(pose->ex)), wide_times(a.y, widen(pose->ey))),
                      wide_times(a.z, widen(pose->ez)));
    if (place) b = wide_sum(b, widen(pose->origin));
    return (sgt_vec3){(double)b.x, (double)b.y, (double)b.z};
}

/* Rays of one object point go through its image, and have the path of the ray through the vertex. */
static void test_paths(void **state)
{
    (void)state;
    generator g = seeded("paths");
    long n = scaled(10000);
    long double worst = 0;
    for (long i = 0; i < n; i++) {
        double n1 = chance(&g, 0.5) ? 1 : uniform(&g, 1, 2), n2 = chance(&g, 0.5) ? n1 : uniform(&g, 1, 2);
        bool mirror = chance(&g, 0.3), posed = chance(&g, 0.3);
        if (mirror) n2 = n1;
        double f = either_sign(&g) * log_uniform(&g, 1, 100), to = either_sign(&g);
        double object = random_object(&g, f, n1), reach = log_uniform(&g, 1e-3, 1) * fabs(f);
        bool afar = object == 0 || isinf(object);
        sgt_phase phase = lens_of(f, object);
        sgt_element e = element_of(&phase, mirror ? SGT_MIRROR : n2, 0);
        sgt_pose none = {.ex = {1, 0, 0}, .ey = {0, 1, 0}, .ez = {0, 0, 1}},
                 pose = posed ? random_pose(&g) : none;
        if (posed) e.pose = pose;
        /* slopes of the ray through the vertex; vergence behind */
        long double u0 = uniform(&g, -0.5, 0.5), v0 = uniform(&g, -0.5, 0.5);
        long double behind = 1 / (long double)f - (afar ? 0 : n1 / (long double)object);
        bool to_infinity = fabsl(behind) < 1e-9L / fabsl(f);
        long double b = to_infinity ? 0 : n2 / behind, a = afar ? 0 : object;
        long double u2 = n1 * u0 / n2, v2 = n1 * v0 / n2, on = mirror ? -to : to;
        long double s0 = sqrtl(1 + u0 * u0 + v0 * v0), s2 = sqrtl(1 + u2 * u2 + v2 * v2);
        wide Q = {-a * u0, -a * v0, -a * to}, I = {b * u2, b * v2, b * on};
        long double right = n1 * a * s0 + n2 * b * s2;
        for (int k = 0; k < 4; k++) {
            wide p = {uniform(&g, -1, 1) * reach, uniform(&g, -1, 1) * reach, 0}, o, d;
            if (k == 0) p.x = p.y = 0;
            if (afar) {
                d = wide_unit((wide){u0, v0, to});
                o = wide_sum(p, wide_times(-wide_dot(p, d), d));
            } else {
                wide along = wide_times(a < 0 ? -1 : 1, wide_difference(p, Q));
                d = wide_unit(along), o = Q;
            }
            sgt_ray ray = {.o = onto(&pose, o, true), .d = onto(&pose, d, false)};
            sgt_passage is;
            sgt_fate fate;
            REQUIRE(sgt_trace(1, &e, n1, &ray, &is, &fate, NULL) == 1, "lens %ld: %s", i,
                    sgt_fate_text(fate));
            wide met = widen(is.hit.p), way = widen(is.direction);
            long double path = is.opl, size = fabsl(right) + n1 * reach * s0 + n2 * reach;
            if (to_infinity)
                path -= n2 * wide_dot(met, wide_unit((wide){u2, v2, on}));
            else {
                /* how near it passes the image, and the path to there */
                wide left = wide_difference(I, met);
                long double t = wide_dot(left, way);
                wide miss = wide_difference(left, wide_times(t, way));
                long double far = wide_length(left) + wide_length(I) + reach;
                REQUIRE(wide_length(miss) <= 0x1p-47L * far * (1 + fabsl(a / b)),
                        "lens %ld: misses by %Lg of %Lg", i, wide_length(miss), far);
                path += n2 * t, size += n2 * far;
            }
            if (!afar) size += n1 * wide_length(wide_difference(p, Q));
            if (posed) size += n1 * 10;
            long double off = fabsl(path - right) / size;
            worst = fmaxl(worst, off);
            REQUIRE(off <= 0x1p-50L, "lens %ld, ray %d, f %g, object %g, %g to %g: path off by %Lg of %Lg", i,
                    k, f, object, n1, n2, path - right, size);
        }
    }
    printf("%Lg of 2^-53\n", worst * 0x1p53L);
}

/* Two lenses one after the other: the image of the first is the object of the second. */
static void test_two_lenses(void **state)
{
    (void)state;
    generator g = seeded("two lenses");
    long n = scaled(5000);
    double worst = 0;
    for (long i = 0; i < n; i++) {
        double f1 = either_sign(&g) * log_uniform(&g, 1, 100), f2 = either_sign(&g) * log_uniform(&g, 1, 100);
        double apart = uniform(&g, 1, 200);
        sgt_phase first = lens_of(f1, 0), second = lens_of(f2, apart - f1);
        bool telescope = chance(&g, 0.3); /* afocal */
        if (telescope) apart = f1 + f2, second.object_distance = f2;
        if (fabs(second.object_distance) < 1e-3) continue;
        double a = second.object_distance, b = telescope ? 0 : 1 / (1 / f2 - 1 / a);
        if (fabs(b) > 1e4) continue;
        sgt_element e[3] = {element_of(&first, 0, 0), element_of(&second, 0, apart),
                            element_of(NULL, 0, apart + b)};
        double slope = uniform(&g, -0.2, 0.2), opl[3], size = 0;
        wide out = {0};
        for (int k = 0; k < 3; k++) {
            wide p = {k == 1 ? 0.05 * f1 : 0, k * 0.04 * f1, 0}, d = wide_unit((wide){slope, 0, 1});
            wide o = wide_sum(p, wide_times(-wide_dot(p, d), d));
            sgt_ray ray = {.o = {(double)o.x, (double)o.y, (double)o.z},
                           .d = {(double)d.x, (double)d.y, (double)d.z}};
            sgt_passage is[3];
            assert_int_equal(sgt_trace(3, e, 1, &ray, is, NULL, NULL), 3);
            opl[k] = is[2].opl;
            for (int j = 0; j < 3; j++) size = fmax(size, fabs(is[j].hit.t) + fabs(is[j].opl));
            wide end = widen(is[2].hit.p), way = widen(is[2].direction);
            if (!telescope) continue;
            if (k == 0) out = way; /* parallel behind it, and on one wavefront */
            long double off = wide_length(wide_difference(way, out));
            REQUIRE(off <= 0x1p-48L, "telescope %ld: not parallel by %Lg", i, off);
            opl[k] -= (double)wide_dot(end, out);
        }
        for (int k = 1; k < 3; k++) {
            double off = fabs(opl[k] - opl[0]) /
                         (size + fabs(apart) + fabs(a) + fabs(b) + fabs(f1) * (1 + fabs(b / a)));
            worst = fmax(worst, off);
            REQUIRE(off <= 0x1p-49, "lenses %ld, ray %d: f %g, %g, %g apart: %g of 2^-53", i, k, f1, f2,
                    apart, off * 0x1p53);
        }
    }
    printf("%g of 2^-53\n", worst * 0x1p53);
}

/* ---------------------------------------------------------------- the rest */

/* What clips, misses or goes along the plane; opl of a clipped ray has no W. */
static void test_fates(void **state)
{
    (void)state;
    sgt_aperture_item hole = {.shape = SGT_CIRCLE, .radius = 2};
    sgt_aperture round = {.count = 1, .items = &hole};
    sgt_phase phase = lens_of(10, 0);
    for (int i = 0; i < 2; i++) {
        sgt_element e = element_of(&phase, 0, 0);
        if (i)
            e.aperture = &round;
        else
            e.semi_diameter = 2;
        double ox[3] = {0, 3, 1}, oy[3] = {0}, oz[3] = {-5, -5, -5}, dx[3] = {0}, dz[3] = {1, 1, 1}, opl[3];
        sgt_fate fate[3];
        sgt_passages told = {.opl = opl};
        assert_int_equal(sgt_trace_batch(1, &e, 1, 3, (sgt_rays){{ox, oy, oz}, {dx, dx, dz}, NULL, NULL},
                                         (sgt_traced){.fate = fate}, &told, NULL),
                         2);
        assert_true(fate[0] == SGT_PASSED && fate[1] == SGT_CLIPPED && fate[2] == SGT_PASSED);
        for (int k = 0; k < 3; k++) {
            sgt_ray ray = {.o = {ox[k], 0, -5}, .d = {0, 0, 1}};
            sgt_passage is;
            sgt_trace(1, &e, 1, &ray, &is, NULL, NULL);
            assert_true(same_bits(is.opl, opl[k]));
        }
        assert_true(opl[0] == 5 && opl[1] == 5 && opl[2] < 5 - 0.049 && opl[2] > 5 - 0.051);
    }
    /* along the plane: of a sphere, where such a ray can meet it; in air, and with the same surface bare */
    const sgt_conic ball = {.c = 0.1};
    for (int bare = 0; bare < 2; bare++) {
        sgt_element e = {.surface = {&sgt_conic_ops, &ball}, .phase = bare ? NULL : &phase};
        sgt_ray ray = {.o = {-20, 0, 5}, .d = {1, 0, 0}};
        sgt_fate fate;
        sgt_passage is;
        size_t passed = sgt_trace(1, &e, 1, &ray, &is, &fate, NULL);
        double x = -20, y = 0, z = 5, one = 1;
        sgt_fate batch = SGT_TIR;
        sgt_status status = SGT_EXHAUSTED;
        sgt_passages told = {.hits = {.status = &status}};
        sgt_trace_batch(1, &e, 1, 1, (sgt_rays){{&x, &y, &z}, {&one, &y, &y}, NULL, NULL},
                        (sgt_traced){.fate = &batch}, &told, NULL);
        assert_true(batch == fate && status == is.hit.status);
        if (bare)
            assert_true(passed == 1 && fate == SGT_PASSED);
        else
            assert_true(passed == 0 && fate == SGT_LOST && status == SGT_UNDEFINED && isnan(is.opl));
    }
}

/* They are there at an ideal lens, and behind it; tests/sensitivity/test_ideal.cpp says what they are. */
static void test_derivatives(void **state)
{
    (void)state;
    sgt_phase phase = lens_of(10, 0);
    const sgt_element e[] = {element_of(NULL, 1.5, 0), element_of(&phase, 0, 1), element_of(NULL, 1, 2),
                             element_of(NULL, 0, 5)};
    for (size_t n = 1; n <= 4; n++) {
        sgt_ray launch = {.o = {0.1, 0.2, -1}, .d = {0, 0.1, 1}}, ray = launch;
        sgt_passage is[4];
        assert_int_equal(sgt_trace(n, e, 1, &ray, is, NULL, NULL), n);
        sgt_ray_change change = {.p = {1, 0, 0}}, out;
        int lacks = sgt_trace_sensitivity(n, e, 1, &launch, is, 1, &change, &out);
        assert_int_equal(lacks, 0);
        assert_true(!isnan(out.p.x) && !isnan(out.d.x) && !isnan(out.opl));
        double gradient[80];
        size_t all = sgt_trace_parameters(n, e);
        assert_true(all <= COUNT_OF(gradient));
        sgt_ray_change weight = {.p = {1, 0, 0}, .opl = 1};
        lacks = sgt_trace_gradient(n, e, 1, &launch, is, 1, &weight, gradient);
        assert_int_equal(lacks & SGT_LACKS_SECOND, 0);
        for (size_t i = 0; i < all; i++)
            REQUIRE(!isnan(gradient[i]), "%zu elements, number %zu", n, i);
    }
    sgt_passage is[4];
    sgt_aiming found;
    sgt_beam beam = {
        .o = {0, 0, -1}, .ou = {1, 0, 0}, .ov = {0, 1, 0}, .d = {0, 0, 1}, .u = {-1, 1}, .v = {-1, 1}};
    sgt_aimed aimed = sgt_aim(3, e, 1, &beam, (sgt_vec2){0.11, 0.07}, is, NULL, &found);
    assert_true(aimed == SGT_MET && found.miss < 1e-12);
    assert_true(fabs(found.point.x - 0.11) < 1e-12 && fabs(found.point.y - 0.07) < 1e-12);
}

static void require_unsound(sgt_phase phase, const char *what)
{
    sgt_element e = element_of(&phase, 0, 0);
    sgt_ray ray = {.o = {0, 0, -1}, .d = {0, 0, 1}};
    sgt_passage is;
    sgt_fate fate;
    REQUIRE(sgt_trace(1, &e, 1, &ray, &is, &fate, NULL) == 0 && fate == SGT_LOST &&
                is.hit.status == SGT_INVALID,
            "%s", what);
    double x = 0, z = -1, one = 1;
    sgt_fate lost = SGT_PASSED;
    sgt_status status = SGT_HIT;
    sgt_passages told = {.hits = {.status = &status}};
    sgt_trace_batch(1, &e, 1, 1, (sgt_rays){{&x, &x, &z}, {&x, &x, &one}, NULL, NULL},
                    (sgt_traced){.fate = &lost}, &told, NULL);
    REQUIRE(lost == SGT_LOST && status == SGT_INVALID, "%s, in a batch", what);
}

static void test_unsound(void **state)
{
    (void)state;
    static const double bad[] = {NAN, HUGE_VAL, -HUGE_VAL, 0x1p-501, 0x1p501, 5e-324, DBL_MAX};
    sgt_phase good = lens_of(10, 30), bad_phase;
    require_unsound((sgt_phase){.focal_length = 10}, "kind 0");
    require_unsound((sgt_phase){.kind = (sgt_phase_kind)2, .focal_length = 10}, "kind 2");
    require_unsound(lens_of(0, 0), "f = 0");
    for (size_t i = 0; i < COUNT_OF(bad); i++) { /* of two powers one may be infinite, not both */
        bad_phase = good, bad_phase.focal_length_y = bad[i];
        if (!isinf(bad[i])) require_unsound(bad_phase, "a bad focal length along y");
        bad_phase = lens_of(bad[i], 0), bad_phase.focal_length_y = isinf(bad[i]) ? -HUGE_VAL : 10;
        require_unsound(bad_phase, "bad focal lengths");
    }
    bad_phase = lens_of(0, 0), bad_phase.focal_length_y = 10;
    require_unsound(bad_phase, "f = 0 along x");
    for (size_t i = 0; i < COUNT_OF(bad); i++) {
        require_unsound(lens_of(bad[i], 0), "a bad focal length");
        if (!isinf(bad[i])) require_unsound(lens_of(10, bad[i]), "a bad object distance");
    }
    for (size_t i = 0; i < COUNT_OF(good.reserved_); i++) {
        bad_phase = good, bad_phase.reserved_[i] = 1;
        require_unsound(bad_phase, "reserved");
    }
    /* the ends of the range are sound */
    static const double ends[] = {0x1p-500, 0x1p500, -0x1p-500, -0x1p500};
    for (size_t i = 0; i < COUNT_OF(ends); i++) {
        sgt_phase phase = lens_of(ends[i], ends[COUNT_OF(ends) - 1 - i]);
        sgt_element e = element_of(&phase, 0, 0);
        sgt_ray ray = {.o = {0, 0, -1}, .d = {0, 0, 1}};
        sgt_passage is;
        assert_int_equal(sgt_trace(1, &e, 1, &ray, &is, NULL, NULL), 1);
        assert_true(is.opl == 1 && ray.d.z == 1);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_slopes),     cmocka_unit_test(test_signs),       cmocka_unit_test(test_paths),
        cmocka_unit_test(test_two_lenses), cmocka_unit_test(test_fates),       cmocka_unit_test(test_unsound),
        cmocka_unit_test(test_two_powers), cmocka_unit_test(test_derivatives),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
