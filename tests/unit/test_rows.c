// SPDX-License-Identifier: MIT
/* test_rows.c - one row for each fault that was mended, that random tests did not find or would seldom
 * find: what was wrong, and the input as it was. */
#include "unit.h"

#include <sagitta/surfaces.h>
#include <sagitta/system.h>

static sgt_hit conic(sgt_conic s, sgt_ray ray, sgt_options opt)
{
    return sgt_intersect((sgt_surface){&sgt_conic_ops, &s}, ray, &opt);
}
static sgt_hit asphere(sgt_even_asphere s, sgt_ray ray, sgt_options opt)
{
    return sgt_intersect((sgt_surface){&sgt_even_asphere_ops, &s}, ray, &opt);
}

/* Where F is 0 at the first look beside a grazed root, the next look went to the side of a signed zero: the
 * image in the vertex plane had other bits. */
static void test_grazing_mirrored(void **state)
{
    (void)state;
    generator g = seeded("grazing, mirrored in z");
    const double none[1] = {0};
    for (long i = 0; i < scaled(20000); i++) {
        sgt_polynomial_xy s = {.c = uniform(&g, 0.01, 0.4), .a = {none, 1, 1}}, m = s;
        const double R = 1 / s.c, r = uniform(&g, 0, 0.02) * R, from = uniform(&g, -3.15, 3.15),
                     to = uniform(&g, -3.15, 3.15), low = log_uniform(&g, 1e-4, 1e-2);
        s.semi_diameter = m.semi_diameter = 0.05 * R;
        const double x = r * cos(from), y = r * sin(from);
        m.c = -s.c;
        sgt_ray ray = {{x, y, s.c * (x * x + y * y) / (1 + sqrt(1 - s.c * s.c * (x * x + y * y)))},
                       {cos(to), sin(to), chance(&g, 0.5) ? low : -low},
                       0,
                       0};
        if (i == 0) { /* as it was found */
            s = (sgt_polynomial_xy){0.32348796348066844, 0, 0.014797214127851134, {none, 1, 1}};
            m = s, m.c = -s.c;
            ray = (sgt_ray){{0.00022261624099069181, -0.0040887969194358647, 2.7002529303041301e-06},
                            {-0.99669230900345585, -0.081266697645965336, 0.00040623525105072065},
                            0,
                            0};
        }
        sgt_ray image = ray;
        image.o.z = -ray.o.z, image.d.z = -ray.d.z;
        sgt_hit h = sgt_intersect((sgt_surface){&sgt_polynomial_xy_ops, &s}, ray, NULL),
                k = sgt_intersect((sgt_surface){&sgt_polynomial_xy_ops, &m}, image, NULL);
        REQUIRE(h.status == k.status && !memcmp(&h.t, &k.t, sizeof h.t) &&
                    !memcmp(&h.t_err, &k.t_err, sizeof h.t),
                "ray %ld: %s, t = %a +- %a; its image %s, t = %a +- %a", i, sgt_status_text(h.status), h.t,
                h.t_err, sgt_status_text(k.status), k.t, k.t_err);
    }
}

/* Coefficients that are almost 0, a hyperboloid without a rim: what grazes it was left to the form from the
 * side alone, which could not tell. */
static void test_grazing_small_terms(void **state)
{
    (void)state;
    sgt_even_asphere s = {
        .c = -6.4277521977852707, .k = -3.8296772926414939, .a = {-1.48e-323, 0, 0, -9.88e-324}};
    sgt_ray ray = {{0.0016092384850759482, -0.00076126373738267866, 1.8824665596555731e-06},
                   {-0.90395608422666063, 0.42762399326767392, -0.0010574362443696932},
                   0,
                   0};
    sgt_hit h = asphere(s, ray, (sgt_options){.max_evals = 0});
    REQUIRE(h.status == SGT_HIT && fabs(h.t - 0.0017802175494539213) < 1e-17, "%s, t = %.17g",
            sgt_status_text(h.status), h.t);
}

/* Slope and terms are both 0 there: the rule of the start divided 0 by 0, and the vertex was missed. */
static void test_vertex_in_its_plane(void **state)
{
    (void)state;
    sgt_hit h = conic((sgt_conic){.c = 0.5}, (sgt_ray){{0, -3, 0}, {0, 1, 0}, 0, 0},
                      (sgt_options){.proof = SGT_PROVE_FIRST});
    REQUIRE(h.status == SGT_GRAZE && h.t == 3, "%s, t = %g", sgt_status_text(h.status), h.t);
}

/* From before a start on the surface, and before where G was known to be monotone: the root behind it was
 * lost. */
static void test_two_about_the_start(void **state)
{
    (void)state;
    sgt_even_asphere s = {.c = 0x1.397f20e515dd7p-9,
                     .k = -1,
                     .a = {-0x1.397f20e515dd7p-9},
                     .semi_diameter = 0x1.331f9d6e3f332p-4};
    sgt_ray ray = {{0, -0x1.331f9d6e3f3d2p-4, -0x1.c335d4c831659p-18},
                   {-0x1.a4b601e00ae5cp-1, 0x1.9b1479c210008p-2, 0x1.2df80f3217ae6p-14},
                   -INFINITY,
                   INFINITY};
    sgt_hit h = asphere(s, ray, (sgt_options){.proof = SGT_PROVE_FIRST});
    REQUIRE(h.status == SGT_HIT && fabs(h.t - 2.9607102465031e-12) < 1e-24, "%s, t = %.17g",
            sgt_status_text(h.status), h.t);
}

/* A coarse t_tol let a root be settled into another's place. */
static void test_coarse_tolerance(void **state)
{
    (void)state;
    sgt_even_asphere s = {.a = {0x1.257079de8042ep-3}};
    sgt_ray ray = {{-0x1.c6e67c4e9ed4ep+21, -0x1.622cb0e653952p+21, 0x1.62ee5bdf09597p+21},
                   {-0x1.5805f0bf80123p+57, -0x1.0bd919c49a89p+57, 0x1.0c6b98b96741p+57},
                   -0x1.5281f8d7943ecp-36,
                   INFINITY};
    for (int near = 0; near < 2; near++) {
        sgt_hit h = asphere(
            s, ray, (sgt_options){.t_tol = 0x1.3c7ff785fa8b4p-12, .pick = near ? SGT_NEAR_SEED : SGT_FIRST});
        REQUIRE(h.status == SGT_HIT && fabs(h.t + 1.924192376555709e-11) < 1e-25, "%s, t = %.17g",
                sgt_status_text(h.status), h.t);
    }
}

/* The start itself, farther from tmin than rounding but not than t_err. */
static void test_start_within_the_tolerance(void **state)
{
    (void)state;
    sgt_even_asphere s = {.a = {0x1.94140d6471016p-6}, .semi_diameter = 0x1.58c3ba7d55e34p+1};
    sgt_ray ray = {{-0x1.836d917f47d5ep-7, 0x1.b0c3f0aaa9adep-3, 0x1.2197d48c861dap-10},
                   {0x1.687ecfd1e44d8p-1, -0x1.4914deabb3444p-1, -0x1.3524c5bb4655fp-2},
                   0,
                   0};
    sgt_hit h = asphere(s, ray, (sgt_options){.t_tol = 0x1.69782f0dc527ep-37});
    REQUIRE(h.status <= 0 || h.t > h.t_err, "%s, t = %.17g", sgt_status_text(h.status), h.t);
}

/* Without a rim no root is hidden by it, however far. */
static void test_far_without_a_rim(void **state)
{
    (void)state;
    sgt_hit h = conic((sgt_conic){0}, (sgt_ray){{1e160, 0, -1}, {0, 0, 1}, 0, 0},
                      (sgt_options){.proof = SGT_PROVE_ROOT});
    REQUIRE(h.status == SGT_HIT, "%s", sgt_status_text(h.status));
}

/* So far off that the rounding of t0 hid on which side of the rim it meets the plane. */
static void test_rim_from_afar(void **state)
{
    (void)state;
    sgt_ray ray = {{-0x1.2641bd7f3d81dp+48, 0, -0x1.d444df855fb0bp+49},
                   {0x1.92ec1c209efp-3, 0, 0x1.4098fb7bd322p-1},
                   0,
                   0};
    sgt_hit h = conic((sgt_conic){.semi_diameter = 0x1.438ef8e633bbep-14}, ray,
                      (sgt_options){.proof = SGT_PROVE_ROOT});
    REQUIRE(h.status != SGT_HIT, "%s at r = %.17g", sgt_status_text(h.status), fabs(h.p.x));
}

/* An undecided stretch from the start on was dropped. */
static void test_dark_from_the_start(void **state)
{
    (void)state;
    sgt_hit h = asphere((sgt_even_asphere){.c = 1e-31, .k = 1, .a = {1, -1}},
                        (sgt_ray){{.1, .07, 0}, {0, 1, 0}, 0, 0}, (sgt_options){0});
    REQUIRE(h.status != SGT_MISS && (h.status < 0 || fabs(h.t - 0.924987) < 1e-5), "%s, t = %.17g",
            sgt_status_text(h.status), h.t);
}

static sgt_fate traced(sgt_conic s, double aperture, sgt_ray ray, sgt_options opt, sgt_passage *passage)
{
    sgt_element e = {.surface = {&sgt_conic_ops, &s}, .semi_diameter = aperture, .index = 1.5};
    sgt_fate fate;
    sgt_trace(1, &e, 1, &ray, passage, &fate, &opt);
    return fate;
}

/* The other root, as near to the chord's end as to be taken for its start. */
static void test_other_at_the_end_of_the_chord(void **state)
{
    (void)state;
    sgt_conic s = {
        .c = 0x1.385c77ba3310bp-12, .k = -0x1.fff2e48e8a71ep-1, .semi_diameter = 0x1.c4d4f9ad18d51p-3};
    sgt_ray ray = {{0x1.bc9144b93038ap-4, -0x1.8a8556cdffca9p-3, 0x1.e8ad202eaaf8dp-18},
                   {-0x1.ace5d763dd25p-1, 0x1.17a03cf9a2724p-1, -0x1.ea07605e136a9p-15},
                   0,
                   0};
    sgt_passage p;
    sgt_fate fate = traced(s, 0x1.c4d4f9ad18d52p-3, ray, (sgt_options){.proof = SGT_PROVE_FIRST}, &p);
    REQUIRE(fate == SGT_LOST && p.hit.status == SGT_UNPROVEN, "%s, %s, t = %.17g", sgt_fate_text(fate),
            sgt_status_text(p.hit.status), p.hit.t);
}

/* A root a little outside the aperture hid the one inside. */
static void test_root_beside_the_aperture(void **state)
{
    (void)state;
    sgt_conic s = {.c = -0x1.9a12ebb57cc63p-7, .k = -0x1p-1};
    sgt_ray ray = {{0x1.3124c67db0bd7p+6, 0x1.25ff1fa5775eap+7, 0x1.343a640e5414cp+6},
                   {0x1.144d2e4383c63p-2, 0x1.aa00f69090f8ap-1, 0x1.f04d914e999fap-2},
                   0,
                   0};
    sgt_passage p;
    sgt_fate fate = traced(s, 0x1.60f3d8643aecfp+6, ray, (sgt_options){.pick = SGT_FIRST}, &p);
    REQUIRE(fate == SGT_PASSED && fabs(hypot(p.hit.p.x, p.hit.p.y) - 30.44) < 0.01, "%s, r = %.17g",
            sgt_fate_text(fate), hypot(p.hit.p.x, p.hit.p.y));
}

/* Through the vertex from so far beside the axis that nothing is left of where the ray meets the vertex
 * plane: it was told to pass by.  The ray's numbers have few bits, so that it meets the vertex exactly. */
static void test_vertex_from_far_aside(void **state)
{
    (void)state;
    static const double conics[] = {-2, -1, 0, 3, 42624},
                        slopes[] = {0x1.2c2cp-247, 0x1.2c2cp-60, 0x1.2c2cp-20, 0x1.2c2cp-3};
    for (size_t k = 0; k < COUNT_OF(conics); k++)
        for (size_t l = 0; l < COUNT_OF(slopes); l++)
            for (int e = 20; e < 490; e += 5) {
                double t = ldexp(0x1.8b5fp-1, e);
                sgt_conic s = {.c = 21.75, .k = conics[k]};
                sgt_even_asphere a = {.c = 21.75, .k = conics[k], .a = {0x1p-30}};
                sgt_ray ray = {.o = {-slopes[l] * t, 0, -0x1.8b65p0 * t}, .d = {slopes[l], 0, 0x1.8b65p0}};
                for (int pick = SGT_FIRST; pick <= SGT_NEAR_SEED; pick++) {
                    sgt_hit h[2] = {conic(s, ray, (sgt_options){.pick = (sgt_pick)pick}),
                                    asphere(a, ray, (sgt_options){.pick = (sgt_pick)pick})};
                    for (int i = 0; i < 2; i++)
                        REQUIRE(h[i].status != SGT_MISS, "%s, k %g, slope %g, from 2^%d: a miss",
                                i ? "asphere" : "conic", s.k, slopes[l], e);
                }
            }
}

/* The start is on the surface as it goes on beyond the rim: that root says nothing of the one within. */
static void test_start_beyond_the_rim(void **state)
{
    (void)state;
    sgt_even_asphere s = {0x1.738506c3aa031p-2,
                     0x1.f535500360efp-1,
                     1,
                     {-0x1.abd3b97750abfp-3, 0, -0x1.9ad2b6671712ep-2, -0x1.29c29357b8009p-4}};
    sgt_ray ray = {{0x1.78a4cd2f1cc16p+0, 0x1.412531a2303afp-1, -0x1.38c7598ce6bc1p+3},
                   {-0x1.ffe42651d2255p-1, 0x1.51bb570f32b0fp-6, 0x1.132edbff8bbffp+2},
                   0,
                   0};
    for (int proof = SGT_ESTIMATE; proof <= SGT_PROVE_FIRST; proof++) {
        sgt_hit h = asphere(s, ray, (sgt_options){.proof = (sgt_proof)proof});
        REQUIRE(h.status == SGT_HIT && fabs(h.t - 2.176658344377588) < 1e-14, "%s, t = %.17g",
                sgt_status_text(h.status), h.t);
    }
}

/* Bounds of the slope and of the height that overflow or underflow are no bounds: the root told as the
 * first was not. */
static void test_bounds_out_of_range(void **state)
{
    (void)state;
    static const sgt_even_asphere even[] = {{1e4, -2, 3e150, {1e-300}}, {0x1p50, -0x1p30, 0, {1e-300}},
                                       {0, 0, 0, {1e16}},          {0, 0, 1e145, {1e6}},
                                       {0, 0, 0, {0x1p-541}},      {0, 0, 0x1p446, {0x1p-541}}};
    static const sgt_ray rays[] = {{{-10, 0, 5.0000001}, {1, 0, -0.5}, 0, 0},
                                   {{0, 0, 0x1p-90}, {1, 0, -0x1p-16}, -0x1p449, INFINITY},
                                   {{0, 0, 1e-9}, {1.4e-162, 0, -1e-11}, -1e297, INFINITY},
                                   {{0, 0, 1e-9}, {1.4e-162, 0, -1e-11}, -1e308, INFINITY},
                                   {{0, 0, 0x1p-110}, {1, 0, -0x1p-97}, -0x1p446, INFINITY},
                                   {{0, 0, 0x1p-110}, {1, 0, -0x1p-97}, -0x1p446, INFINITY}};
    static const double before[] = {10, 5e-23, 100, 100, 1e-4, 1e-4}; /* there is a root well before it */
    for (size_t i = 0; i < COUNT_OF(even); i++)
        for (int proof = SGT_ESTIMATE; proof <= SGT_PROVE_FIRST; proof++) {
            sgt_hit h = asphere(even[i], rays[i], (sgt_options){.proof = (sgt_proof)proof});
            REQUIRE(h.status < 0 || (h.status == SGT_HIT && h.t < before[i]), "row %zu: %s, t = %.17g", i,
                    sgt_status_text(h.status), h.t);
        }
    sgt_odd_asphere odd = {.c = 1, .k = -0x1p230};
    sgt_ray ray = {{0, 0, 0x1p-280}, {1, 0, -0x1p-116}, -0x1p398, INFINITY};
    sgt_hit h = sgt_intersect((sgt_surface){&sgt_odd_asphere_ops, &odd}, ray, NULL);
    REQUIRE(h.status < 0 || (h.status == SGT_HIT && h.t < 0), "%s, t = %.17g", sgt_status_text(h.status),
            h.t);
}

/* The ray lies in the plane but for 1e-17 of slope: its root is known to 0.06 alone, was told from outside
 * the aperture, and that the chord of the aperture was undecided was dropped: clipped, though the root
 * (here in rational numbers) is inside. */
static void test_undecided_inside_the_aperture(void **state)
{
    (void)state;
    static const double terms[] = {0x1.5ac5ceb637f6dp-12, 0x1.7edec989461e4p-16};
    sgt_polynomial_xy s = {.a = {terms, 1, 2}};
    sgt_ray ray = {{0x1.4259198b33942p-9, 0x1.117e7d4c9426fp-2, 0x1.6129f1be178ccp-12},
                   {-0x1.7b30901a943e4p-2, 0x1.db9a4139cbb5bp-1, 0x1.63a709c1f8efep-16},
                   0,
                   0};
    const double t = 0.009911956420991056, r = hypot(ray.o.x + t * ray.d.x, ray.o.y + t * ray.d.y);
    for (int i = 1; i < 1000; i++) {
        const double aperture = r + 2e-5 * i * r;
        sgt_element e = {.surface = {&sgt_polynomial_xy_ops, &s}, .semi_diameter = aperture, .index = 1.5};
        sgt_ray one = ray;
        sgt_fate fate, of_batch;
        sgt_options opt = {.t_tol = 0x1p-1000};
        sgt_rays rays = {{&ray.o.x, &ray.o.y, &ray.o.z}, {&ray.d.x, &ray.d.y, &ray.d.z}, NULL, NULL};
        sgt_trace(1, &e, 1, &one, NULL, &fate, &opt);
        sgt_trace_batch(1, &e, 1, 1, rays, (sgt_traced){.fate = &of_batch}, NULL, &opt);
        REQUIRE(fate != SGT_CLIPPED && fate != SGT_MISSED && of_batch == fate, "aperture %.17g: %s, %s",
                aperture, sgt_fate_text(fate), sgt_fate_text(of_batch));
    }
}

/* So far off that the enclosure of g at a point is wide, and holds 0 where F is certainly below it: that
 * was told as a graze. */
static void test_graze_far_from_the_surface(void **state)
{
    (void)state;
    static const double terms[] = {0x1.a46p+35, 0, 0, 0x1.a46p+35};
    sgt_zernike s = {
        .c = -0x1.5e2p-41, .k = -0x1.742p+1, .norm = 0x1p39, .order = SGT_NOLL, .a = {terms, 1, 4}};
    sgt_ray ray = {{-0x1.f691e88863c04p+89, -0x1.1c3fdd3d5f2b5p+80, 0x1.252046f37943p+90},
                   {0x1.47e15260c36cp-7, 0x1.6a332c7f41d45p-7, -0x1.7e799b3353e96p-7},
                   0x1.9b743764fc912p+76,
                   0x1.9b743767fc825p+76};
    for (int pick = SGT_FIRST; pick <= SGT_NEAR_SEED; pick++)
        for (int proof = SGT_ESTIMATE; proof <= SGT_PROVE_FIRST; proof++) {
            sgt_hit h = sgt_intersect((sgt_surface){&sgt_zernike_ops, &s}, ray,
                                      &(sgt_options){.pick = (sgt_pick)pick, .proof = (sgt_proof)proof});
            REQUIRE(h.status <= 0, "%s where F is %g", sgt_status_text(h.status), h.f);
        }
}

/* At the equator both sheets of G have a root, and F one: with an undecided stretch between the two it was
 * told twice. */
static void test_one_root_of_two_sheets(void **state)
{
    (void)state;
    sgt_even_asphere s = {0x1.96f5b8f1e0531p-1,
                     -0x1.08e941da180d3p-2,
                     0,
                     {0, 0x1.4841d1350f54p+9, 0, -0x1.8289c2505dc99p+28, -0x1.7102828cbf981p+36,
                      -0x1.2fa37a5dcd9fp+45, 0x1.a00155c5b359dp+56, 0}};
    sgt_ray ray = {{0x1.83170f8b990d3p-1, -0x1.419c0e74d29abp+0, 0x1.48c5b3f4979fcp+64},
                   {-0x1.57faef4cef1dbp-2, 0x1.705c072584e61p-1, -0x1.373f3b3ed69bfp-1},
                   -INFINITY,
                   INFINITY};
    sgt_hit h[4];
    int n = sgt_intersect_all((sgt_surface){&sgt_even_asphere_ops, &s}, ray, 4, h, NULL);
    REQUIRE(n == 2 && h[0].status == SGT_HIT && h[1].status == SGT_HIT, "%d entries", n);
    REQUIRE(fabs(h[0].t - 0.0063246599381126048) <= h[0].t_err &&
                fabs(h[1].t - 3.6666084510183721) <= h[1].t_err,
            "t = %.17g and %.17g", h[0].t, h[1].t);
}

/* What is told first is the first of all: near an end one way to a root told it to count, another not. */
static void test_first_of_all_at_an_end(void **state)
{
    (void)state;
    /* by t_err from where the start ends; a hair before tmax; undecided, but certainly behind tmax */
    sgt_conic ball = {.c = -0x1.013e4c9d49c0ep-5};
    sgt_even_asphere vertex = {
        -0x1.b9b320ec2f4fep+0, -0x1.dbc997f8b1f1bp-4, 0x1.cc6c9dec1de0ap-8, {0x1.fa183ce98af62p+0}};
    sgt_even_asphere far = {-0x1.938ee88563354p-18,
                       0x1.dc93cb8589b6cp+0,
                       0,
                       {-0x1.98c88b234c3f6p-22, -0x1.a547062a9246fp-43, 0x1.3b210411a9d7cp-69, 0,
                        -0x1.3c7a7cbbbe9c8p-120, 0x1.f809ceafafbdfp-147, 0x1.19cde09b461cap-169, 0}};
    const struct { sgt_surface s; sgt_ray ray; sgt_proof proof;
    } rows[] = {
        {{&sgt_conic_ops, &ball},
         {{-0x1.9f6985da5a516p+6, -0x1.5f5e799b56bfdp+7, 0x1.ae1164efddb76p+5},
          {-0x1.036045737337ap-1, -0x1.a64b4dac47b25p-1, 0x1.012eb71908166p-2},
          -0x1.b979f31375eb5p+7,
          INFINITY},
         SGT_ESTIMATE},
        {{&sgt_even_asphere_ops, &vertex},
         {{0, 0, 0},
          {0x1.0bc855dfc29fep-9, -0x1.61f77b172708fp-9, -0x1.78b606b2556e5p-10},
          -0x1.1926388f8cc2ap-6,
          DBL_TRUE_MIN},
         SGT_PROVE_FIRST},
        {{&sgt_even_asphere_ops, &far},
         {{0x1.ddd04f035ec62p+16, 0x1.846e205acfabbp+15, 0x1.418edeee487b3p+63},
          {-0x1.30a26b50cf454p-5, -0x1.8a579ba54b6aap-6, 0x1.bee7e27fba531p-4},
          -INFINITY,
          0x1.35cfda829cebdp+22},
         SGT_ESTIMATE},
    };
    for (size_t i = 0; i < COUNT_OF(rows); i++) {
        sgt_options opt = {.proof = rows[i].proof};
        sgt_hit all[4], first = sgt_intersect(rows[i].s, rows[i].ray, &opt);
        int n = sgt_intersect_all(rows[i].s, rows[i].ray, 4, all, &opt);
        sgt_status status = n ? all[0].status : SGT_MISS;
        REQUIRE(first.status == status, "row %zu: %s, of all %s", i, sgt_status_text(first.status),
                sgt_status_text(status));
        REQUIRE(status <= 0 || fabs(first.t - all[0].t) <= first.t_err + all[0].t_err,
                "row %zu: %.17g, of all %.17g", i, first.t, all[0].t);
    }
}

/* t_err was so wide that the first root was taken for the start: of a conic so flat that the vertex plane
 * is far outside it from the point nearest the vertex, in the list; of an asphere so near the vertex that
 * its terms underflow.  The rays start in the vertex plane, where the root is known without a difference of
 * like numbers (the asphere's power adds less than rounding). */
static void test_start_within_a_wide_t_err(void **state)
{
    (void)state;
    for (int e = 0; e < 520; e += 8)
        for (int place = 20; place < 300; place += 17)
            for (int which = 0; which < 4; which++) {
                sgt_conic s = {.c = 3.6, .k = ldexp(which & 1 ? 1 : -1, e), .semi_diameter = 1};
                sgt_even_asphere a = {.c = 3.6, .k = s.k, .semi_diameter = 1, .a = {0, 0x1p-200}};
                sgt_surface surface = which & 2 ? (sgt_surface){&sgt_even_asphere_ops, &a}
                                                : (sgt_surface){&sgt_conic_ops, &s};
                sgt_ray ray = {{ldexp(1.6, -place), 0, 0}, {1, 0, 0.25}, 0, 0};
                long double A = s.c * (1 + (1 + (long double)s.k) * 0.0625L),
                            B = 0.25L - (long double)s.c * ray.o.x, C = s.c * (long double)ray.o.x * ray.o.x;
                long double D = B * B - A * C, t = C / (B + sqrtl(D)),
                            v = 1 - (1 + (long double)s.k) * s.c * t * 0.25L;
                if (!(D > 0.1L * B * B && v > 0.1L)) continue; /* touched, nearly, or on another sheet */
                for (int proof = SGT_ESTIMATE; proof <= SGT_PROVE_FIRST; proof++) {
                    sgt_options opt = {.proof = (sgt_proof)proof};
                    sgt_hit first = sgt_intersect(surface, ray, &opt), all[2];
                    int count = sgt_intersect_all(surface, ray, 2, all, &opt);
                    REQUIRE(first.status != SGT_MISS && count > 0, "k %g, 2^-%d: %s, and %d in the list", s.k,
                            place, sgt_status_text(first.status), count);
                    REQUIRE((long double)all[0].lo <= t && (long double)all[0].hi >= t * (1 - 0x1p-60L),
                            "k %g, 2^-%d: %Lg is not in [%g, %g]", s.k, place, t, all[0].lo, all[0].hi);
                    REQUIRE(first.status < 0 || fabsl(first.t - t) <= first.t_err + 0x1p-60L * t,
                            "k %g, 2^-%d: t = %.17g, and it is %.20Lg", s.k, place, first.t, t);
                }
            }
}

/* Of a ray nearly in the vertex plane and close to it, what was to mend the quotient of t0 underflowed:
 * t_err was less than it was off. */
static void test_vertex_plane_whose_remainder_underflows(void **state)
{
    (void)state;
    sgt_even_asphere s = {.c = 0x1p-1023, .k = -1, .a = {0, 0x1p-1023}};
    for (int e = 600; e < 1020; e += 9)
        for (int i = 1; i < 60; i++) {
            sgt_ray ray = {{0, 0, -i * 0x1p-1074}, {0, 1, ldexp(1 + i * 0.016180339887498949, -e)}, 0, 0};
            long double t = -(long double)ray.o.z / ray.d.z; /* the sag there is below 2^-1400 */
            for (int pick = SGT_FIRST; pick <= SGT_NEAR_SEED; pick++) {
                sgt_hit h = asphere(s, ray, (sgt_options){.pick = (sgt_pick)pick});
                REQUIRE(h.status < 0 || (h.status == SGT_HIT && fabsl(h.t - t) <= h.t_err + 0x1p-62L * t),
                        "%d, slope 2^-%d: %s, t = %a +- %a, and it is %La", i, e, sgt_status_text(h.status),
                        h.t, h.t_err, t);
            }
        }
}

/* A span whose ends underflow in lengths of a long d had no room for the root: with one sign at both ends
 * it was a miss. */
static void test_span_that_underflows_in_t(void **state)
{
    (void)state;
    for (int length = 500; length < 1020; length += 60)
        for (int height = 0; height < 540; height += 20) {
            sgt_quadric q = {.constant = ldexp(-1, -2 * height), .linear = {0, 0, ldexp(1, -height)}};
            sgt_quadric ball = {.constant = ldexp(-1, -2 * height), .squares = {1, 1, 1}};
            sgt_torus torus = {.major = ldexp(1, -height), .minor = ldexp(0.25, -height)};
            sgt_surface s[3] = {{&sgt_quadric_ops, &q}, {&sgt_quadric_ops, &ball}, {&sgt_torus_ops, &torus}};
            /* they meet it */
            sgt_ray ray = {{ldexp(0.125, -height), 0, 0},
                           {ldexp(1, length), 0, ldexp(1, length - 4)},
                           -INFINITY,
                           INFINITY};
            for (int i = 0; i < 3; i++)
                for (int proof = SGT_ESTIMATE; proof <= SGT_PROVE_FIRST; proof++)
                    for (int pick = SGT_FIRST; pick <= SGT_NEAR_SEED; pick++) {
                        sgt_hit h = sgt_intersect(
                            s[i], ray, &(sgt_options){.proof = (sgt_proof)proof, .pick = (sgt_pick)pick});
                        REQUIRE(h.status != SGT_MISS,
                                "surface %d of size 2^-%d, a direction of 2^%d, proof %d, pick %d: a miss", i,
                                height, length, proof, pick);
                    }
        }
}

/* The bound on a term underflowed where the term did not, as its coefficient is large: the enclosure was
 * empty. */
static void test_term_whose_bound_underflows(void **state)
{
    (void)state;
    for (int norm = 0; norm < 500; norm += 4)
        for (int size = 0; size < 1020; size += 20)
            for (int which = 0; which < 2; which++) {
                double a[8];
                for (int i = 0; i < 8; i++) a[i] = ldexp(1.17, size);
                sgt_q_con con = {.norm = ldexp(1.17, norm), .a = {a, 1, 8}};
                sgt_q_bfs bfs = {.norm = con.norm, .a = con.a};
                sgt_surface s = which ? (sgt_surface){&sgt_q_bfs_ops, &bfs}
                                      : (sgt_surface){&sgt_q_con_ops, &con};
                for (int r = -10; r < 50; r += 10) {
                    sgt_ray ray = {{ldexp(1.3, r), 0, 0}, {0, 0.5, 1}, 0, 0};
                    sgt_interval slope, f = s.ops->enclose(s.self, &ray, (sgt_interval){-1, 0x1p-20}, &slope);
                    double v = s.ops->value(s.self, ray.o, NULL), off = s.ops->rounding(s.self, ray.o);
                    if (!(fabs(v) < INFINITY && off < INFINITY)) continue;
                    REQUIRE(f.lo <= v + off && f.hi >= v - off && slope.lo <= slope.hi,
                            "%s, norm 2^%d, coefficients 2^%d, r 2^%d: [%g, %g], and F is %g", s.ops->name,
                            norm, size, r, f.lo, f.hi, v);
                }
            }
}

/* An end that underflows in the t of the scaled direction was taken for 0: a root at t = 0 behind the start
 * was the start, one behind tmax was met; between two such ends there was none. */
static void test_ends_that_underflow(void **state)
{
    (void)state;
    for (int e = 45; e < 1000; e += 5)
        for (int which = 0; which < 3; which++) {
            sgt_conic s = {.c = which ? 0.1 : 0};
            sgt_even_asphere a = {.c = 0.1, .a = {0, 0x1p-10}};
            sgt_ray early = {{which ? 0 : 0.6, 0, 0},
                             {ldexp(1, -e), 0, ldexp(1, -e)},
                             ldexp(-1.9, -e),
                             INFINITY},
                    late = early;
            late.tmin = -INFINITY, late.tmax = early.tmin;
            for (int pick = SGT_FIRST; pick <= SGT_NEAR_SEED; pick++) {
                sgt_options opt = {.pick = (sgt_pick)pick};
                sgt_hit h = which == 2 ? asphere(a, early, opt) : conic(s, early, opt),
                        l = which == 2 ? asphere(a, late, opt) : conic(s, late, opt);
                REQUIRE(h.status != SGT_MISS, "surface %d, 2^-%d: %s", which, e, sgt_status_text(h.status));
                sgt_ray both = early; /* every root, where both ends underflow */
                both.tmax = -both.tmin;
                sgt_surface of = which == 2 ? (sgt_surface){&sgt_even_asphere_ops, &a}
                                            : (sgt_surface){&sgt_conic_ops, &s};
                REQUIRE(sgt_intersect_all(of, both, 0, NULL, &opt) != 0, "surface %d, 2^-%d: none of all",
                        which, e);
                REQUIRE(l.status <= 0 || l.t <= late.tmax, "surface %d, 2^-%d: %s at %g, tmax %g", which, e,
                        sgt_status_text(l.status), l.t, late.tmax);
            }
        }
}

/* The terms of the gradient at the middle of what holds the root are 200 times those at the root itself,
 * which is 20 widths of the start behind it: it was told to be the start, a miss under each proof.  The
 * roots are those of the parabola in 113 bits. */
static void test_start_between_two_planes(void **state)
{
    (void)state;
    sgt_quadric s = {{6, 30, 0}, {-41, -36, 6}, {-1, 37, 6}, -7};
    sgt_ray ray = {{-0x1.4920b47eccf5bp+5, -0x1.158adc72f3e92p+1, 0x1.43ee3b3e04218p+5},
                   {-0x1.45bf848f39251p-2, -0x1.b8af1bdba53bap-1, -0x1.9701be93b9028p-2},
                   0x1.664dc4b2bb969p+2,
                   0x1.f2e14bde2533p+3};
    for (int proof = SGT_ESTIMATE; proof <= SGT_PROVE_FIRST; proof++) {
        sgt_hit h = sgt_intersect((sgt_surface){&sgt_quadric_ops, &s}, ray,
                                  &(sgt_options){.proof = (sgt_proof)proof});
        REQUIRE(h.status < 0 || (h.status > 0 && fabs(h.t - 5.5984966035318342) <= h.t_err), "%s",
                sgt_status_text(h.status));
    }
}

/* Next to the line in which two planes meet a root is known to 1e-8, and the terms of the start's rule are
 * 1e9 times as much at the middle of that as at the root, which is 2e-12 behind tmin: it was dropped as the
 * start, and a miss proven.  The root at 113 bits, with the rule's width there, is that of
 * tests/oracle/test_degenerate.cpp. */
static void test_start_beside_a_double_line(void **state)
{
    (void)state;
    sgt_quadric planes = {{35, -12, -8}, {-32, 28, -6}, {25, -30, 10}, 0};
    sgt_ray ray = {{-0x1.063b2688e066p+4, -0x1.5728871dd76f9p+5, -0x1.87080546ae5efp+5},
                   {0x1.9d59b8a93dc2ep-2, -0x1.bfb2036f259bap-1, 0x1.13aaffb91c482p-2},
                   -0x1.3e7dcb8de2cafp+3,
                   0x1.4c8497dc566b6p+2};
    for (int proof = SGT_ESTIMATE; proof <= SGT_PROVE_FIRST; proof++) {
        sgt_hit h = sgt_intersect((sgt_surface){&sgt_quadric_ops, &planes}, ray,
                                  &(sgt_options){.proof = (sgt_proof)proof});
        REQUIRE(h.status != SGT_MISS, "proof %d: %s, the root is 2e-12 behind tmin", proof,
                sgt_status_text(h.status));
    }
}

/* A flat grid with steps below 2^-1024: its slope was bounded by 0 times infinity, and what
 * sgt_grid_measure wrote was refused as not measured.  A grid is as valid with the bounds as without them,
 * whatever its heights and steps. */
static void test_grid_measured_at_the_limits(void **state)
{
    (void)state;
    static const double steps[] = {0x1p-1074, 0x1p-1030, 0x1p-700, 1, 0x1p700, 0x1.fp1023};
    static const double heights[] = {0, 0x1p-1074, 1, 0x1p1000};
    for (size_t h = 0; h < sizeof heights / sizeof *heights; h++)
        for (size_t i = 0; i < sizeof steps / sizeof *steps; i++)
            for (size_t j = 0; j < sizeof steps / sizeof *steps; j++)
                for (int rough = 0; rough < 2; rough++) {
                    double z[16];
                    for (int k = 0; k < 16; k++) z[k] = rough && k % 3 == 0 ? -heights[h] : heights[h];
                    sgt_grid grid = {0, 0, 0, steps[i], steps[j], {z, 4, 4}, 0, 0, 0};
                    sgt_ray ray = {{0, 0, -1}, {0, 0, 1}, 0, HUGE_VAL};
                    for (int measured = 0; measured < 2; measured++) {
                        if (measured) sgt_grid_measure(&grid);
                        sgt_hit hit = sgt_intersect((sgt_surface){&sgt_grid_ops, &grid}, ray, NULL);
                        REQUIRE(hit.status != SGT_INVALID, "steps %a, %a, height %a, rough %d, measured %d",
                                steps[i], steps[j], heights[h], rough, measured);
                    }
                }
}

/* A root's cell became shorter than what rounding leaves of the root, and its bracket as wide as it had
 * been stayed, after sixty looks: from 1e-12 before the root that much t_err made it the start, and the
 * miss was proven. */
static void test_level_set_from_close_before_a_root(void **state)
{
    (void)state;
    sgt_julia julia = {.c = {0x1.6889f4bc166bcp-2, 0, -0x1.64af14a4fedf9p-2, 0x1.55f8f8cd3afccp-3},
                       .iterations = 6,
                       .power = 2};
    sgt_surface s = {&sgt_julia_ops, &julia};
    sgt_ray ray = {{0x1.c63683bb19418p-4, -0x1.59c4e192ded97p-5, 0x1.7c44a0ca0f60bp-3},
                   {-0x1.50aa295ef79e1p-3, -0x1.28b0bd82bd029p-5, -0x1.643511c671812p-4}, 0, HUGE_VAL};
    sgt_hit whole = sgt_intersect(s, ray, NULL);
    REQUIRE(whole.status == SGT_HIT, "%s", sgt_status_text(whole.status));
    for (double gap = 1; gap > 1e-12; gap *= 0.5)
        for (int proof = SGT_ESTIMATE; proof <= SGT_PROVE_FIRST; proof++) {
            ray.tmin = whole.t - gap;
            sgt_hit h = sgt_intersect(s, ray, &(sgt_options){.proof = (sgt_proof)proof});
            REQUIRE(h.status == SGT_HIT && fabs(h.t - whole.t) <= h.t_err + whole.t_err,
                    "%g before: %s, %a, not %a", gap, sgt_status_text(h.status), h.t, whole.t);
            REQUIRE(h.t_err <= 4 * whole.t_err && h.evals <= 24,
                    "%g before: t_err %g, not %g, %d evaluations", gap, h.t_err, whole.t_err, h.evals);
        }
}

/* From the vertex, at a start behind it: that there is one root at most told a miss, and the one was
 * behind. */
static void test_one_root_behind_a_later_start(void **state)
{
    (void)state;
    for (int e = -60; e <= 12; e++)
        for (int pick = SGT_FIRST; pick <= SGT_NEAR_SEED; pick++)
            for (int proof = SGT_ESTIMATE; proof <= SGT_PROVE_FIRST; proof++) {
                sgt_even_asphere a = {.c = 0.1, .k = -0.6, .a = {0, 1e-4}};
                sgt_ray ray = {{0, 0, 0}, {0.9, 0, 0.2}, e < 12 ? ldexp(1.1, e) : 0, HUGE_VAL};
                if (ray.tmin > 4.6) ray.tmin = 4.6;
                sgt_hit h = asphere(a, ray, (sgt_options){.pick = (sgt_pick)pick, .proof = (sgt_proof)proof});
                REQUIRE(h.status != SGT_MISS, "tmin %g, pick %d, proof %d: the root at 4.685 is missed",
                        ray.tmin, pick, proof);
            }
}

/* 1.5e-15 of r^2 beyond the soft rim, t known to an ulp: without a proof the rule of the rim decides, and
 * it was UNPROVEN. */
static void test_root_beyond_the_rim_by_rounding(void **state)
{
    (void)state;
    sgt_odd_asphere a = {.k = -1, .semi_diameter = 0x1.0395b494c893p+0, .a = {-0x1.8c9b19cbc4d6dp-13}};
    sgt_surface s = {&sgt_odd_asphere_ops, &a};
    sgt_ray ray = {{0x1.8743f94f969fep+0, 0x1.9192929903p-2, 0x1.7aa820b377e7cp+1},
                   {-0x1.5bdd11fe5cc18p-3, -0x1.0935e33fc1ceap-3, -0x1.f42f531cbe87cp-1},
                   -INFINITY,
                   INFINITY};
    for (int pick = SGT_FIRST; pick <= SGT_NEAR_SEED; pick++) {
        sgt_hit h = sgt_intersect(s, ray, &(sgt_options){.pick = (sgt_pick)pick});
        REQUIRE(h.status == SGT_MISS, "pick %d: %s", pick, sgt_status_text(h.status));
        h = sgt_intersect(s, ray, &(sgt_options){.pick = (sgt_pick)pick, .proof = SGT_PROVE_ROOT});
        REQUIRE(h.status == SGT_UNPROVEN, "pick %d, with a proof: %s", pick, sgt_status_text(h.status));
    }
}

/* Between two planes, two roots 1e-11 apart: the terms at the second were uncertain by a part in twenty,
 * and it was told though the rule of the start reaches beyond it, by a part in two hundred. */
static void test_start_reaches_a_little_beyond(void **state)
{
    (void)state;
    sgt_quadric q = {{48, 8, -20}, {-56, 36, -16}, {42, -47, 29}, -6};
    sgt_surface s = {&sgt_quadric_ops, &q};
    sgt_ray ray = {{0x1.e253061e9d7f3p+2, 0x1.3771c41bb3d7p+3, 0x1.28e523043f515p+2},
                   {-0x1.013622a205c17p-1, -0x1.280ae7a2e21ecp-4, 0x1.b9276dbbc6c5p-1},
                   0x1.42ea8afb0b107p+1,
                   INFINITY};
    double counts = 0x1.42ea8afb388acp+1, start = 0x1.42ea8afb3eda9p+1;
    for (int proof = SGT_ESTIMATE; proof <= SGT_PROVE_FIRST; proof++) {
        sgt_hit h[4];
        bool in = false;
        int n = sgt_intersect_all(s, ray, 4, h, &(sgt_options){.proof = (sgt_proof)proof});
        for (int i = 0; i < n && i < 4; i++) {
            REQUIRE(h[i].status != SGT_HIT || fabs(h[i].t - start) > h[i].t_err,
                    "proof %d: the start is told", proof);
            in = in || (h[i].lo <= counts && counts <= h[i].hi);
        }
        REQUIRE(in, "proof %d: the first root is lost", proof);
    }
}

/* The first radius of a march through the wings was chosen by a number in 1/length: in another unit of
 * length the last bits of the errors were others. */
static void test_march_in_another_unit(void **state)
{
    (void)state;
    sgt_hit h[2];
    for (int k = 0; k < 2; k++) {
        double unit = k ? 0x1p20 : 1;
        sgt_biconic cylinder = {.c_y = -0x1.8cada47495899p+1 / unit};
        sgt_ray ray = {
            {0x1.de9510d71ab36p+23 * unit, 0x1.a4a5b82a4a195p+22 * unit, -0x1.f8078e2b75b8cp+25 * unit},
            {-0x1.d696aa89db8f2p-3, -0x1.9d9f0c1ef4aa6p-4, 0x1.ef9c583367c9ep-1},
            0,
            INFINITY};
        h[k] = sgt_intersect((sgt_surface){&sgt_biconic_ops, &cylinder}, ray, NULL);
        REQUIRE(h[k].status == SGT_HIT, "%s", sgt_status_text(h[k].status));
        h[k].p_err /= unit, h[k].t /= unit, h[k].t_err /= unit;
    }
    REQUIRE(h[0].t == h[1].t && h[0].t_err == h[1].t_err && h[0].p_err == h[1].p_err, "p_err %a, not %a",
            h[1].p_err, h[0].p_err);
}

/* A torus so small that F underflows is grazed along all of a chord: told at its begin, outside the aperture,
 * the ray was clipped, and in another unit it has a root inside. */
static void test_graze_that_reaches_inside_the_aperture(void **state)
{
    (void)state;
    const double q = 0x1p-294;
    sgt_torus torus = {0x1.cdefb5bf55564p+3 * q, 0x1.159b91ba51106p+4 * q};
    double unit = 0x1.cdefb5bf55564p+3 * q;
    sgt_element e = {.surface = {&sgt_torus_ops, &torus},
                     .pose = {.origin = {0.125 * unit, 0, unit}},
                     .index = 1.5,
                     .semi_diameter = 0.75 * unit};
    sgt_ray ray = {{0x1.8a9dd4b6e8738p+4 * q, -0x1.4816fa38627dfp+6 * q, -0x1.b753bc838208p+6 * q},
                   {0x1.0086998d46e9bp-9, -0x1.f01237670aa67p-8, -0x1.52e44f3b08bcbp-7}, 0, 0};
    sgt_fate fate;
    sgt_trace(1, &e, 1, &ray, NULL, &fate, &(sgt_options){.pick = SGT_FIRST});
    REQUIRE(fate != SGT_CLIPPED && fate != SGT_MISSED, "%s", sgt_fate_text(fate));
}

/* A user's surface with `enclose`, the ray begins right before a root and ends far away, no seed: rounding
 * of the way from the middle took the root for the start, or hid that it counts. */
static void test_root_right_behind_a_start_far_from_the_middle(void **state)
{
    (void)state;
    const sgt_surface_ops *from = &sgt_odd_asphere_ops;
    sgt_surface_ops ops = {.name = "user's",
                           .value = from->value,
                           .rounding = from->rounding,
                           .span = from->span,
                           .enclose = from->enclose};
    sgt_odd_asphere s = {
        .c = -0x1.dacfa21f04c9dp-14, .k = 0x1.4d4f33b24033p-3, .a = {0, 0x1.7336dc561f657p-9}};
    for (int i = 2; i < 80; i++) {
        double root = 0x1.6d5daf7017384p+6, before = 16 * i * 0x1p-46;
        sgt_ray ray = {{0x1.8798d9bb08bc8p+4, -0x1.12bc9456a3a8fp+2, 0x1.075b8be0a560cp-3},
                       {-0x1.4d9209daff25cp-2, -0x1.11f8f073a4904p-15, 0x0p+0},
                       root - before,
                       0x1.e0d52c6e2b2a7p+14};
        sgt_hit h = sgt_intersect((sgt_surface){&ops, &s}, ray, NULL);
        REQUIRE(h.status == SGT_HIT && fabs(h.t - root) <= h.t_err, "%g before: %s, t = %.17g", before,
                sgt_status_text(h.status), h.t);
    }
}

/* The estimate, begun at the root itself, knew t better than the search: the first root was one that counts,
 * and of all of them there was none. */
static void test_first_of_all_at_the_start(void **state)
{
    (void)state;
    sgt_biconic s = {.c_y = -0x1.afe2a3094efa6p-11, .semi_diameter = 0x1.773796731d3c9p+0};
    sgt_surface surface = {&sgt_biconic_ops, &s};
    sgt_ray ray = {{-0x1.3b4f5af7cb08ep+0, -0x1.82ff31cbf2ecbp-7, -0x1.ed7bfce0d72bfp-25},
                   {-0x1.4d4d80805afe9p-3, 0x1.1a4c6f2587a49p-4, -0x1.166d632ee254fp-2},
                   -0x1.934079498d5e9p-68,
                   INFINITY};
    sgt_options opt = {.proof = SGT_PROVE_ROOT};
    sgt_hit first = sgt_intersect(surface, ray, &opt), all = {.status = SGT_MISS};
    sgt_intersect_all(surface, ray, 1, &all, &opt);
    REQUIRE(first.status == all.status, "first %s, of all %s", sgt_status_text(first.status),
            sgt_status_text(all.status));
}

/* A root that waited for its neighbours' steps was asked for its terms once more, so its bound under a proof
 * had other last bits in a batch than alone. */
static void test_proven_among_others(void **state)
{
    (void)state;
    enum { N = 40 };
    sgt_torus shape = {.major = 0x1.cbbca52214eccp+3, .minor = 0x1.7d784p+26};
    sgt_surface s = {&sgt_torus_ops, &shape};
    sgt_options opt = {.proof = SGT_PROVE_FIRST};
    double o[3][N], d[3][N], t[N], t_err[N], t_lo[N];
    sgt_status status[N];
    generator g = seeded("proven among others");
    int hits = 0;
    for (int again = 0; again < 20; again++) {
        for (int i = 0; i < N; i++) {
            double f = uniform(&g, 0.85, 1.15);
            o[0][i] = -0x1.a6a77ab180432p+21 * f, o[1][i] = -0x1.8721d95106e34p+24 * f;
            o[2][i] = -0x1.707cd20840c79p+26;
            d[0][i] = 0x1.db220439b3142p+8 * f, d[1][i] = -0x1.542c07b0359bbp+2;
            d[2][i] = -0x1.12ca6624f5111p+8 * f;
        }
        sgt_intersect_batch(s, N, (sgt_rays){{o[0], o[1], o[2]}, {d[0], d[1], d[2]}, NULL, NULL},
                            (sgt_hits){.status = status, .t = t, .t_err = t_err, .t_lo = t_lo}, &opt);
        for (int i = 0; i < N; i++) {
            sgt_ray r = {{o[0][i], o[1][i], o[2][i]}, {d[0][i], d[1][i], d[2][i]}, 0, FAR};
            sgt_hit h = sgt_intersect(s, r, &opt);
            bool same = h.t == t[i] && h.t_lo == t_lo[i] && h.t_err == t_err[i];
            REQUIRE(h.status == status[i] && (same || h.status != SGT_HIT),
                    "ray %d: t_err %a alone, %a in a batch", i, h.t_err, t_err[i]);
            hits += h.status == SGT_HIT;
        }
    }
    REQUIRE(hits > 100, "%d hits", hits);
}

/* A root near the origin of a ray that begins before it, without a rim, beside rays that march: which bound
 * of rounding was asked for there was decided by the tile, and not by the ray. */
static void test_roots_at_the_origin(void **state)
{
    (void)state;
    enum { N = 8 };
    generator g = seeded("roots at the origin");
    const long rounds = scaled(600);
    long hits = 0;
    for (long again = 0; again < rounds; again++) {
        sgt_biconic shape = {.c_x = again % 2 ? 0 : uniform(&g, -2, 2), .c_y = uniform(&g, -2, 2)};
        shape.k_x = uniform(&g, -2, 0), shape.k_y = uniform(&g, -2, 0);
        sgt_surface s = {&sgt_biconic_ops, &shape};
        sgt_options opt = {.proof = again % 3 == 0   ? SGT_ESTIMATE
                                    : again % 3 == 1 ? SGT_PROVE_ROOT
                                                     : SGT_PROVE_FIRST};
        double o[3][N], d[3][N], tmin[N], tmax[N], t[N], t_err[N], t_lo[N];
        sgt_status status[N];
        for (int i = 0; i < N; i++) {
            double x = uniform(&g, -1, 1), y = uniform(&g, -1, 1), back = uniform(&g, 0, 1);
            o[0][i] = 5 * x, o[1][i] = 5 * y, o[2][i] = uniform(&g, -1, 1);
            for (int k = 0; k < 3; k++) d[k][i] = uniform(&g, -1, 1);
            tmin[i] = 0, tmax[i] = FAR;
            if (i % 2) continue;
            o[0][i] = x, o[1][i] = 0.1 * y, tmin[i] = -0.1 * back; /* onto the surface, to 1e-4 */
            sgt_hit h = sgt_intersect(s, (sgt_ray){{x, 0.1 * y, -9}, {0, 0, 1}, 0, 99}, NULL);
            o[2][i] = h.p.z + 1e-4 * uniform(&g, -1, 1), d[2][i] -= 2;
        }
        sgt_intersect_batch(s, N, (sgt_rays){{o[0], o[1], o[2]}, {d[0], d[1], d[2]}, tmin, tmax},
                            (sgt_hits){.status = status, .t = t, .t_err = t_err, .t_lo = t_lo}, &opt);
        for (int i = 0; i < N; i++) {
            sgt_ray r = {{o[0][i], o[1][i], o[2][i]}, {d[0][i], d[1][i], d[2][i]}, tmin[i], tmax[i]};
            sgt_hit h = sgt_intersect(s, r, &opt);
            bool same = h.t == t[i] && h.t_lo == t_lo[i] && h.t_err == t_err[i];
            REQUIRE(h.status == status[i] && (same || h.status != SGT_HIT),
                    "biconic %a %a, ray %a %a %a along %a %a %a from %a: t_err %a alone, %a in a batch",
                    shape.c_x, shape.c_y, r.o.x, r.o.y, r.o.z, r.d.x, r.d.y, r.d.z, r.tmin,
                    h.t_err, t_err[i]);
            hits += h.status == SGT_HIT;
        }
    }
    REQUIRE(hits > rounds, "%ld hits in %ld rounds", hits, rounds);
}

/* A quick proof that had spent max_evals left 0 evaluations to the search, which is the default of 2000. */
static void test_budget_of_a_proof(void **state)
{
    (void)state;
    generator g = seeded("budget of a proof");
    for (const sgt_builtin *row = sgt_builtins(); row->type; row++) {
        static double with[4096];
        if (strcmp(row->type, "even_asphere") == 0) continue; /* its search for other roots has its own */
        memcpy(with, row->specimen, row->size);
        if (row->prepare) row->prepare(with);
        for (int i = 0; i < 40; i++) {
            sgt_ray r = {{uniform(&g, -1.5, 1.5), uniform(&g, -1.5, 1.5), -5},
                         {uniform(&g, -0.1, 0.1), uniform(&g, -0.1, 0.1), 1}, 0, FAR};
            for (int proof = SGT_ESTIMATE; proof <= SGT_PROVE_FIRST; proof++)
                for (int pick = SGT_FIRST; pick <= SGT_NEAR_SEED; pick++)
                    for (int most = 1; most < 8; most++) {
                        sgt_options opt = {
                            .proof = (sgt_proof)proof, .pick = (sgt_pick)pick, .max_evals = most};
                        sgt_hit h = sgt_intersect((sgt_surface){row->ops, with}, r, &opt);
                        REQUIRE(h.evals <= most + 2, "%s, proof %d, pick %d: %d evaluations, max_evals %d",
                                row->type, proof, pick, h.evals, most);
                    }
        }
    }
}

/* What bounds the part far out was taken with the wrong sign where its product with the curvature, or with
 * another term's, was too small for a double: roots were lost.  A term too small to matter changes no first
 * root. */
static void require_alike(sgt_surface with, sgt_surface without, sgt_ray ray, const char *what)
{
    for (int proof = SGT_ESTIMATE; proof <= SGT_PROVE_FIRST; proof++) {
        sgt_options opt = {.proof = (sgt_proof)proof, .pick = SGT_FIRST};
        sgt_hit a = sgt_intersect(with, ray, &opt), b = sgt_intersect(without, ray, &opt);
        const bool differ = a.status >= 0 && b.status >= 0 && (a.status > 0) != (b.status > 0);
        const bool apart = a.status > 0 && b.status > 0 && !(fabs(a.t - b.t) <= a.t_err + b.t_err);
        REQUIRE(!differ && !apart, "%s, proof %d: %s, t = %g; without the term %s, t = %g", what, proof,
                sgt_status_text(a.status), a.t, sgt_status_text(b.status), b.t);
    }
}

static void test_terms_too_small_to_matter(void **state)
{
    (void)state;
    generator g = seeded("terms too small to matter");
    static const double sizes[] = {5e-324, 1e-320, 1e-310, 1e-300, 1e-250, 1e-200, 1e-170, 1e-100};
    const long rounds = scaled(1200);
    for (long i = 0; i < rounds; i++) {
        const double c = i % 4 ? uniform(&g, -0.05, 0.05) : 0, k = uniform(&g, -2, 0.5);
        const double tiny = sizes[i % 8] * (i & 8 ? 1 : -1), other = i & 16 ? -0.5 * tiny : 0;
        const double own[2] = {tiny, other}, none[2] = {0, 0};
        const double far = uniform(&g, 2, 20), down = i % 3 ? uniform(&g, -0.02, 0.02) : 0;
        const double height = i % 5 && c != 0 ? c * far * far * uniform(&g, 0, 1) : 0.01;
        const sgt_ray ray = {{-far, i % 7 ? uniform(&g, -1, 1) : 0, height}, {1, 0, down}, 0, 1e9};
        sgt_q_con q = {.c = c, .k = k, .norm = 7, .a = {own, 1, 2}}, q0 = q;
        sgt_q_bfs b = {.c = c, .norm = 7, .a = {own, 1, 2}}, b0 = b;
        sgt_odd_asphere o = {.c = c, .k = k, .a = {0, 0, 0, tiny, other}}, o0 = o;
        q0.a.x = b0.a.x = none, o0.a[3] = o0.a[4] = 0;
        require_alike((sgt_surface){&sgt_q_con_ops, &q}, (sgt_surface){&sgt_q_con_ops, &q0}, ray, "q_con");
        require_alike((sgt_surface){&sgt_q_bfs_ops, &b}, (sgt_surface){&sgt_q_bfs_ops, &b0}, ray, "q_bfs");
        require_alike((sgt_surface){&sgt_odd_asphere_ops, &o}, (sgt_surface){&sgt_odd_asphere_ops, &o0}, ray,
                      "odd_asphere");
        sgt_q_con flat = {.norm = 7, .a = {own, 1, 1}};
        sgt_odd_asphere against = {.a = {0, 0, 0, 0, 0, -tiny}};
        sgt_surface term[2] = {{&sgt_q_con_ops, &flat}, {&sgt_odd_asphere_ops, &against}};
        sgt_sum sum = {.c = c, .k = k, .terms = term, .count = 2};
        sgt_conic bare = {.c = c, .k = k};
        require_alike((sgt_surface){&sgt_sum_ops, &sum}, (sgt_surface){&sgt_conic_ops, &bare}, ray, "sum");
    }
}

/* A flat sum of two terms of opposite sign, whose product is too small for a double: a root at 7.3 was a
 * miss. */
static void test_small_terms_against_each_other(void **state)
{
    (void)state;
    const double size[1] = {5e-170};
    sgt_q_con up = {.norm = 1, .a = {size, 1, 1}};
    sgt_odd_asphere down = {.a = {0, 0, 0, 0, 0, -1e-170}};
    sgt_surface term[2] = {{&sgt_q_con_ops, &up}, {&sgt_odd_asphere_ops, &down}};
    sgt_sum sum = {.terms = term, .count = 2};
    for (int proof = SGT_ESTIMATE; proof <= SGT_PROVE_FIRST; proof++) {
        sgt_hit h = sgt_intersect((sgt_surface){&sgt_sum_ops, &sum},
                                  (sgt_ray){{-10, 0, -1e-168}, {1, 0, 0}, 0, INFINITY},
                                  &(sgt_options){.proof = (sgt_proof)proof});
        REQUIRE(h.status < 0 || (h.status == SGT_HIT && fabs(h.t - 7.3491) < 1e-3), "%s, t = %g",
                sgt_status_text(h.status), h.t);
    }
}

/* The root is just before tmax, on a rim that is small beside how far off it is: a tile told of a miss. */
static void test_leaving_up_to_a_small_rim(void **state)
{
    (void)state;
    sgt_conic s = {.c = 0.55448471816054934, .k = -0.74244639851490679, .semi_diameter = 5.91983e-15};
    enum { RAYS = 64 };
    double o[3][RAYS], d[3][RAYS], tmin[RAYS], tmax[RAYS], t[RAYS];
    sgt_status status[RAYS];
    for (int i = 0; i < RAYS; i++) {
        o[0][i] = -1.3916748573584625, o[1][i] = 0, o[2][i] = 0.559287173198319;
        d[0][i] = 0.75404452864683069, d[1][i] = 0, d[2][i] = -0.3030358928040302;
        tmin[i] = 0, tmax[i] = 1.8456136268979979;
    }
    sgt_intersect_batch((sgt_surface){&sgt_conic_ops, &s}, RAYS,
                        (sgt_rays){{o[0], o[1], o[2]}, {d[0], d[1], d[2]}, tmin, tmax},
                        (sgt_hits){.status = status, .t = t}, NULL);
    sgt_hit alone = conic(s, (sgt_ray){{o[0][0], 0, o[2][0]}, {d[0][0], 0, d[2][0]}, 0, tmax[0]},
                          (sgt_options){.max_evals = 0});
    for (int i = 0; i < RAYS; i++)
        REQUIRE(status[i] == alone.status && status[i] != SGT_MISS && (alone.status < 0 || t[i] == alone.t),
                "%s alone, %s in a batch", sgt_status_text(alone.status), sgt_status_text(status[i]));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_terms_too_small_to_matter),
        cmocka_unit_test(test_small_terms_against_each_other),
        cmocka_unit_test(test_leaving_up_to_a_small_rim),
        cmocka_unit_test(test_first_of_all_at_the_start),
        cmocka_unit_test(test_root_right_behind_a_start_far_from_the_middle),
        cmocka_unit_test(test_graze_that_reaches_inside_the_aperture),
        cmocka_unit_test(test_march_in_another_unit),
        cmocka_unit_test(test_start_reaches_a_little_beyond),
        cmocka_unit_test(test_root_beyond_the_rim_by_rounding),
        cmocka_unit_test(test_one_root_behind_a_later_start),
        cmocka_unit_test(test_level_set_from_close_before_a_root),
        cmocka_unit_test(test_grid_measured_at_the_limits),
        cmocka_unit_test(test_start_beside_a_double_line),
        cmocka_unit_test(test_start_between_two_planes),
        cmocka_unit_test(test_undecided_inside_the_aperture),
        cmocka_unit_test(test_graze_far_from_the_surface),
        cmocka_unit_test(test_one_root_of_two_sheets),
        cmocka_unit_test(test_first_of_all_at_an_end),
        cmocka_unit_test(test_start_beyond_the_rim),
        cmocka_unit_test(test_bounds_out_of_range),
        cmocka_unit_test(test_start_within_a_wide_t_err),
        cmocka_unit_test(test_vertex_plane_whose_remainder_underflows),
        cmocka_unit_test(test_ends_that_underflow),
        cmocka_unit_test(test_span_that_underflows_in_t),
        cmocka_unit_test(test_term_whose_bound_underflows),
        cmocka_unit_test(test_vertex_from_far_aside),
        cmocka_unit_test(test_grazing_mirrored),
        cmocka_unit_test(test_grazing_small_terms),
        cmocka_unit_test(test_vertex_in_its_plane),
        cmocka_unit_test(test_two_about_the_start),
        cmocka_unit_test(test_coarse_tolerance),
        cmocka_unit_test(test_start_within_the_tolerance),
        cmocka_unit_test(test_far_without_a_rim),
        cmocka_unit_test(test_rim_from_afar),
        cmocka_unit_test(test_dark_from_the_start),
        cmocka_unit_test(test_other_at_the_end_of_the_chord),
        cmocka_unit_test(test_root_beside_the_aperture),
        cmocka_unit_test(test_proven_among_others),
        cmocka_unit_test(test_roots_at_the_origin),
        cmocka_unit_test(test_budget_of_a_proof),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
