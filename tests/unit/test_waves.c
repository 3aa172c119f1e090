// SPDX-License-Identifier: MIT
/* Phases in waves: gratings, perfect foci on planes and curved surfaces, holograms, Zernike's, which orders
 * there are, proofs, and phases that are not sound.  The closed forms are those of geometry; where a program
 * has published a number it is named. */
#include "unit.h"

#include <sagitta/aim.h>
#include <sagitta/formula.h>
#include <sagitta/interval.h>
#include <sagitta/surfaces.h>
#include <sagitta/system.h>

static const sgt_conic flat = {0};

static sgt_vec3 unit_of(double x, double y, double z)
{
    wide d = wide_unit((wide){x, y, z});
    return (sgt_vec3){(double)d.x, (double)d.y, (double)d.z};
}

/* T y waves, turned from y toward -x. */
typedef struct grating { double a[4]; sgt_polynomial_xy w; sgt_phase phase; } grating;

static void set_grating(grating *g, double lines, double turn, double per_wave)
{
    *g = (grating){.a = {0, lines * cos(turn), -lines * sin(turn), 0}};
    g->w.a = (sgt_numbers){g->a, 2, 2};
    g->phase = (sgt_phase){
        .kind = SGT_PHASE_SAG, .waves = {&sgt_polynomial_xy_ops, &g->w}, .per_wave = per_wave};
}

static sgt_element plane_with(const sgt_phase *phase, double index)
{
    return (sgt_element){.surface = {&sgt_conic_ops, &flat}, .index = index, .phase = phase};
}

/* ---------------------------------------------------------------------- gratings */

static void test_grating(void **state)
{
    (void)state;
    grating g;
    sgt_passage is;
    sgt_fate fate;
    /* 250 lines per mm at 0.9 um: sine 0.225, 4.618422 over 20 */
    set_grating(&g, 250, 0, 0.9e-3);
    sgt_element e = plane_with(&g.phase, 0);
    sgt_ray ray = {.o = {0, 0, -3}, .d = {0, 0, 1}};
    assert_int_equal(sgt_trace(1, &e, 1, &ray, &is, NULL, NULL), 1);
    assert_true(fabs(ray.d.y - 0.225) < 1e-16 && ray.d.x == 0);
    assert_true(fabs(20 * ray.d.y / ray.d.z - 4.618422) < 5e-7);
    /* its fifth order does not exist; sgt_phase_at says which ones do */
    set_grating(&g, 250, 0, 5 * 0.9e-3);
    ray = (sgt_ray){.o = {0, 0, -3}, .d = {0, 0, 1}};
    assert_int_equal(sgt_trace(1, &e, 1, &ray, &is, &fate, NULL), 0);
    assert_true(fate == SGT_EVANESCENT && is.hit.status == SGT_HIT && is.opl == 3 && is.direction.z == 0);
    assert_string_equal(sgt_fate_text(fate), "evanescent");
    sgt_phased at = sgt_phase_at(&e, 1, (sgt_vec3){0, 0, 1}, &is.hit);
    assert_true(at.waves == 0 && at.gradient.y == 250 && at.gradient.x == 0 && at.limit == 1);
    assert_true(fabs(at.along - 1.125) < 1e-15);
    assert_true(fabs(at.per_wave.lo + 4e-3) < 1e-17 && fabs(at.per_wave.hi - 4e-3) < 1e-17);
    /* a mirror: 1740 lines per mm at 1.03 um, 59.1 degrees to 69.09 on the other side */
    set_grating(&g, 1740, 0, 1.03e-3);
    e = plane_with(&g.phase, SGT_MIRROR);
    const double sine = sin(59.1 * acos(-1.0) / 180);
    ray = (sgt_ray){.o = {0, 0, 0}, .d = {0, -sine, sqrt(1 - sine * sine)}};
    assert_int_equal(sgt_trace(1, &e, 1, &ray, &is, NULL, NULL), 1);
    assert_true(fabs(ray.d.y - (1740 * 1.03e-3 - sine)) < 1e-15 && ray.d.z < 0);
    assert_true(fabs(asin(ray.d.y) * 180 / acos(-1.0) - 69.09) < 0.005);
    /* no phase at all */
    g.phase.per_wave = 0;
    at = sgt_phase_at(&e, 1, ray.d, &is.hit);
    assert_true(at.along == fabs(ray.d.y));
}

/* From a plane wavefront in front to one behind, all rays have the same path, whatever the incidence. */
static void test_path_of_a_grating(void **state)
{
    (void)state;
    generator g = seeded("paths");
    const long n = scaled(4000);
    long passed = 0;
    for (long i = 0; i < n; i++) {
        const double n1 = chance(&g, 0.5) ? 1 : uniform(&g, 1, 2);
        const double n2 = chance(&g, 0.5) ? n1 : uniform(&g, 1, 2);
        const bool mirror = chance(&g, 0.3);
        const double to = either_sign(&g), wavelength = uniform(&g, 0.4e-3, 1e-3);
        const sgt_vec3 d = unit_of(uniform(&g, -1, 1), uniform(&g, -1, 1), to);
        grating line;
        set_grating(&line, uniform(&g, 1, 1000), uniform(&g, -4, 4), (below(&g, 7) - 3) * wavelength);
        sgt_element e = plane_with(&line.phase, mirror ? SGT_MIRROR : n2);
        double path[4], size = 0;
        for (int k = 0; k < 4; k++) {
            const sgt_vec3 q = {uniform(&g, -20, 20) * (k > 0), uniform(&g, -20, 20) * (k > 0), 0};
            sgt_ray ray = {.o = q, .d = d};
            sgt_passage is;
            if (sgt_trace(1, &e, n1, &ray, &is, NULL, NULL) != 1) goto next;
            const long double in = n1 * wide_dot(widen(d), widen(q));
            const long double out = (mirror ? n1 : n2) * wide_dot(widen(is.direction), widen(q));
            path[k] = (double)(in + is.opl - out);
            size = fmax(size, fabs(is.opl) + 40 * n1 + 40 * n2);
            REQUIRE((is.direction.z > 0) == ((to > 0) != mirror), "grating %ld: the way", i);
        }
        passed++;
        for (int k = 1; k < 4; k++)
            REQUIRE(fabs(path[k] - path[0]) < 0x1p-49 * size, "grating %ld: %g", i, path[k] - path[0]);
    next:;
    }
    REQUIRE(passed > n / 3, "%ld passed", passed);
}

/* ------------------------------------------------------------------------- foci */

/* All rays of a bundle go through `focus`, with the same path to there, within the told error. */
static double require_focus(const sgt_element *e, double n1, sgt_vec3 o, bool afar, sgt_vec3 focus,
                            double reach, double behind)
{
    sgt_element row[2] = {*e, {.surface = {&sgt_conic_ops, &flat}, .pose = {.origin = focus}}};
    double opl[24], most = 0;
    int count = 0;
    for (int k = 0; k < 24; k++) {
        const double r = reach * k / 24, x = r * cos(2.4 * k), y = r * sin(2.4 * k);
        const sgt_vec3 at = afar ? (sgt_vec3){x, y, o.z} : o;
        sgt_ray ray = {.o = at, .d = afar ? (sgt_vec3){0, 0, 1} : unit_of(x - o.x, y - o.y, -o.z)};
        const sgt_ray launch = ray;
        sgt_passage is[2];
        sgt_end_error told;
        REQUIRE(sgt_trace(2, row, n1, &ray, is, NULL, NULL) == 2, "ray %d is stopped", k);
        assert_true(sgt_trace_error(2, row, n1, &launch, is, &told));
        const double off = hypot(is[1].hit.p.x, is[1].hit.p.y);
        REQUIRE(off <= told.point && told.point < 1e-10, "ray %d misses by %g, told %g", k, off, told.point);
        opl[count++] = is[1].opl;
        const double by = fabs(is[1].opl - opl[0]), most_by = told.path + behind * told.point;
        REQUIRE(by <= 2 * most_by && most_by < 1e-10, "ray %d: path off by %g, told %g", k, by, most_by);
        most = fmax(most, by);
    }
    return most;
}

static void test_perfect_focus(void **state)
{
    (void)state;
    /* S = f - sqrt(f^2 + r^2) is the sag of a hyperboloid: c = -1 / f, k = -2 */
    const double f = 50;
    const sgt_conic sag = {.c = -1 / f, .k = -2};
    sgt_phase phase = {.kind = SGT_PHASE_SAG, .waves = {&sgt_conic_ops, &sag}, .per_wave = 1};
    sgt_element e = plane_with(&phase, 0);
    printf("%g off\n", require_focus(&e, 1, (sgt_vec3){0, 0, -10}, true, (sgt_vec3){0, 0, f}, 30, 1));
    /* the same as a series in r^2, at another wavelength: binomial coefficients, in waves */
    sgt_even_asphere series = {.c = 0};
    double b = 1;
    const double wavelength = 0.55e-3;
    for (int i = 1; i <= 8; i++) {
        b *= (1.5 - i) / i;
        series.a[i - 1] = -b * pow(f, 1 - 2 * i) / wavelength;
    }
    phase.waves = (sgt_surface){&sgt_even_asphere_ops, &series}, phase.per_wave = wavelength;
    require_focus(&e, 1, (sgt_vec3){0, 0, -10}, true, (sgt_vec3){0, 0, f}, 6, 1);
    /* at twice the wavelength its paraxial focus is at f / 2 */
    phase.per_wave = 2 * wavelength;
    sgt_ray ray = {.o = {1e-4, 0, 0}, .d = {0, 0, 1}};
    assert_int_equal(sgt_trace(1, &e, 1, &ray, NULL, NULL, NULL), 1);
    assert_true(fabs(-1e-4 * ray.d.z / ray.d.x - f / 2) < 1e-9);
}

static double room[5][512];

static sgt_formula formula_of(int k, const char *text, size_t n, const sgt_named named[])
{
    sgt_error error;
    const sgt_tape *tape = sgt_formula_read(text, SGT_FORMULA_XYZ, n, named, room[k], sizeof room[k], &error);
    REQUIRE(tape, "%s: %s", text, error.words);
    return (sgt_formula){.tape = tape};
}

/* On any surface, between any media: S = -n' |Q - P2| - n d . Q, and for a point in front -n |Q - P1|. */
static void test_foci_on_curved_surfaces(void **state)
{
    (void)state;
    static const double c[] = {0, 1 / 40.0, -1 / 35.0, 1 / 12.0};
    static const double k[] = {0, 0, -3, -1};
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < 2; j++) {
            const double n1 = j ? 1.3 : 1, n2 = j ? 1 : 1.7, P2 = 90, P1 = -70;
            const sgt_named named[] = {{"n1", n1}, {"n2", n2}, {"P", P2}, {"p", P1}};
            const sgt_formula afar = formula_of(0, "-n2*sqrt(x^2 + y^2 + (z - P)^2) - n1*z", 4, named);
            const sgt_formula near = formula_of(
                1, "-n2*sqrt(x^2 + y^2 + (z - P)^2) - n1*sqrt(x^2 + y^2 + (z - p)^2)", 4, named);
            sgt_phase phase = {
                .kind = SGT_PHASE_FUNCTION, .waves = {&sgt_formula_ops, &afar}, .per_wave = 1};
            const sgt_conic bowl = {.c = c[i], .k = k[i]};
            sgt_element e = {.surface = {&sgt_conic_ops, &bowl}, .index = n2, .phase = &phase};
            require_focus(&e, n1, (sgt_vec3){0, 0, -20}, true, (sgt_vec3){0, 0, P2}, 9, n2);
            phase.waves.self = &near;
            require_focus(&e, n1, (sgt_vec3){0, 0, P1}, false, (sgt_vec3){0, 0, P2}, 9, n2);
        }
}

/* A hologram of two points used as it was made images the one into the other; off the axis it gives the
 * number that OpticStudio gives. */
static void test_hologram(void **state)
{
    (void)state;
    const double wavelength = 0.6328e-3;
    const sgt_named named[] = {{"L", wavelength}};
    const sgt_formula in = formula_of(
        2, "-(sqrt(x^2 + y^2 + (z + 200)^2) + sqrt(x^2 + y^2 + (z - 100)^2))/L", 1, named);
    sgt_phase phase = {
        .kind = SGT_PHASE_FUNCTION, .waves = {&sgt_formula_ops, &in}, .per_wave = wavelength};
    sgt_element e = plane_with(&phase, 0);
    require_focus(&e, 1, (sgt_vec3){0, 0, -200}, false, (sgt_vec3){0, 0, 100}, 20, 1);
    sgt_ray ray = {.o = {0, 10, -200}, .d = unit_of(0, 15, 200)};
    assert_int_equal(sgt_trace(1, &e, 1, &ray, NULL, NULL, NULL), 1);
    double y = 25 + 100 * ray.d.y / ray.d.z;
    REQUIRE(fabs(y + 5.505476815018) < 1e-11, "%.15g", y);
    /* reflected: from P1 (0, 0, -200) to P2 (0, 0, -100) */
    const sgt_formula back = formula_of(
        3, "-(sqrt(x^2 + y^2 + (z + 200)^2) + sqrt(x^2 + y^2 + (z + 100)^2))/L", 1, named);
    phase.waves.self = &back, e.index = SGT_MIRROR;
    ray = (sgt_ray){.o = {0, 10, -200}, .d = unit_of(0, 15, 200)};
    assert_int_equal(sgt_trace(1, &e, 1, &ray, NULL, NULL, NULL), 1);
    y = 25 - 100 * ray.d.y / ray.d.z;
    REQUIRE(fabs(y + 5.505476815018) < 1e-11, "%.15g", y);
}

/* Fringe terms 1, 4, 9 of -2, -3, -1 waves are -6 rho^4: behind an ideal lens, 0.0412500035. */
static void test_zernike(void **state)
{
    (void)state;
    const double a[9] = {-2, 0, 0, -3, 0, 0, 0, 0, -1};
    const sgt_zernike z = {.norm = 4, .order = SGT_FRINGE, .a = {a, 1, 9}};
    const sgt_phase phase = {.kind = SGT_PHASE_SAG, .waves = {&sgt_zernike_ops, &z}, .per_wave = 0.55e-3},
                    lens = {.kind = SGT_IDEAL_LENS, .focal_length = 100};
    const sgt_element e[] = {plane_with(&phase, 0), plane_with(&lens, 0),
                             {.surface = {&sgt_conic_ops, &flat}, .pose = {.origin = {0, 0, 100}}}};
    sgt_ray ray = {.o = {0, 2, 0}, .d = {0, 0, 1}};
    sgt_passage is[3];
    assert_int_equal(sgt_trace(3, e, 1, &ray, is, NULL, NULL), 3);
    REQUIRE(fabs(fabs(is[2].hit.p.y) - 0.0412500035) < 6e-11, "%.12g", is[2].hit.p.y);
    assert_true(fabs(is[0].opl + 6 * 0.0625 * 0.55e-3) < 1e-18);
}

/* W = (y - 5)^8, multiplied out: near y = 5 its terms cancel to a part in 10^8 and less.  The told errors
 * know of that. */
static void test_cancelling(void **state)
{
    (void)state;
    generator g = seeded("cancelling");
    double a[9], binomial = 1, worst = 0;
    for (int j = 8; j >= 0; j--) {
        a[j] = binomial * pow(-5, 8 - j);
        binomial *= j / (9.0 - j);
    }
    const sgt_polynomial_xy w = {.a = {a, 1, 9}};
    const sgt_phase phase = {
        .kind = SGT_PHASE_SAG, .waves = {&sgt_polynomial_xy_ops, &w}, .per_wave = 0x1p-10};
    const sgt_element e[] = {plane_with(&phase, 0),
                             {.surface = {&sgt_conic_ops, &flat}, .pose = {.origin = {0, 0, 100}}}};
    for (int i = 0; i < 1000; i++) {
        const double y = uniform(&g, 4.5, 5.5);
        const sgt_ray launch = {.o = {0, y, 0}, .d = {0, 0, 1}};
        sgt_ray ray = launch;
        sgt_passage is[2];
        sgt_end_error told;
        assert_int_equal(sgt_trace(2, e, 1, &ray, is, NULL, NULL), 2);
        assert_true(sgt_trace_error(2, e, 1, &launch, is, &told));
        const long double by = y - 5.0L, G = 0x1p-10L * 8 * powl(by, 7), W = powl(by, 8);
        const long double right = y + 100 * G / sqrtl(1 - G * G);
        const double off = (double)fabsl(is[1].hit.p.y - right);
        REQUIRE(off <= told.point, "y %.17g: off by %g, told %g", y, off, told.point);
        REQUIRE(fabsl(is[0].opl - 0x1p-10L * W) <= told.path, "y %.17g: the path", y);
        worst = fmax(worst, off / told.point);
    }
    REQUIRE(worst > 1e-3, "at most %g of what is told", worst);
}

/* ------------------------------------------------------------------------ the rest */

/* Just inside of what sgt_phase_at tells a ray passes, and just outside it does not. */
static void test_orders(void **state)
{
    (void)state;
    generator g = seeded("orders");
    const long n = scaled(20000);
    long none = 0, ends = 0;
    for (long i = 0; i < n; i++) {
        const double n1 = uniform(&g, 1, 2), n2 = uniform(&g, 1, 2);
        const sgt_conic bowl = {.c = chance(&g, 0.5) ? 0 : uniform(&g, -0.2, 0.2)};
        grating line;
        set_grating(&line, uniform(&g, 10, 1000), uniform(&g, -4, 4), 0);
        sgt_element e = plane_with(&line.phase, chance(&g, 0.3) ? SGT_MIRROR : n2);
        e.surface.self = &bowl;
        const sgt_vec3 d = unit_of(uniform(&g, -2, 2), uniform(&g, -2, 2), either_sign(&g)),
                       o = {uniform(&g, -2, 2), uniform(&g, -2, 2), 0};
        sgt_ray ray = {.o = o, .d = d};
        sgt_passage is;
        sgt_fate fate;
        sgt_trace(1, &e, n1, &ray, &is, &fate, NULL);
        if (!(is.hit.status > 0)) continue;
        const sgt_phased at = sgt_phase_at(&e, n1, d, &is.hit);
        const double ask[] = {at.per_wave.lo * (1 - 1e-9), at.per_wave.lo * (1 + 1e-9),
                              at.per_wave.hi * (1 - 1e-9), at.per_wave.hi * (1 + 1e-9)};
        none += at.per_wave.lo > at.per_wave.hi;
        for (int k = 0; k < 4; k++) {
            line.phase.per_wave = at.per_wave.lo > at.per_wave.hi ? uniform(&g, -1e-2, 1e-2) : ask[k];
            ray = (sgt_ray){.o = o, .d = d};
            sgt_trace(1, &e, n1, &ray, &is, &fate, NULL);
            const double p = line.phase.per_wave;
            const bool passes = p > at.per_wave.lo && p < at.per_wave.hi;
            REQUIRE(fate == (passes ? SGT_PASSED : SGT_EVANESCENT), "case %ld, %d: %s", i, k,
                    sgt_fate_text(fate));
            ends++;
        }
    }
    REQUIRE(none > n / 100 && ends > n, "%ld without an order", none);
}

/* W of a user, who offers no more than a value. */
static double wavy(const void *self, sgt_vec3 p, sgt_vec3 *grad)
{
    (void)self;
    if (grad) *grad = (sgt_vec3){40, 30 * cos(p.y), 7};
    return p.x > 3 ? (double)NAN : 40 * p.x + 30 * sin(p.y) + 7 * p.z;
}

static void test_user(void **state)
{
    (void)state;
    const sgt_surface_ops ops = {.name = "wavy", .value = wavy};
    sgt_phase phase = {.kind = SGT_PHASE_FUNCTION, .waves = {&ops, NULL}, .per_wave = 1e-3};
    const sgt_element e = plane_with(&phase, 0);
    sgt_ray ray = {.o = {1, 2, -5}, .d = {0, 0, 1}}, launch = ray;
    sgt_passage is;
    sgt_fate fate;
    assert_int_equal(sgt_trace(1, &e, 1, &ray, &is, NULL, NULL), 1);
    assert_true(fabs(ray.d.x - 0.04) < 1e-16 && fabs(ray.d.y - 0.03 * cos(2.0)) < 1e-16);
    assert_true(fabs(is.opl - (5 + 1e-3 * (40 + 30 * sin(2.0)))) < 1e-15);
    sgt_ray_change change = {.p = {1, 0, 0}}, out;
    assert_int_equal(sgt_trace_sensitivity(1, &e, 1, &launch, &is, 1, &change, &out), SGT_LACKS_SECOND);
    assert_true(isnan(out.d.x) && fabs(out.opl - 0.04) < 1e-16);
    ray.o.x = 4, ray.o.z = -5, ray.d = launch.d;
    sgt_trace(1, &e, 1, &ray, &is, &fate, NULL);
    assert_true(fate == SGT_LOST && is.hit.status == SGT_UNDEFINED);
}

static void wavy_second(const void *self, size_t n, sgt_points p, double *const out[6])
{
    (void)self;
    for (int k = 0; k < 6; k++)
        for (size_t i = 0; i < n; i++) out[k][i] = k == 3 ? -30 * sin(p.p[1][i]) : 0;
}

static bool wavy_bounds(const void *self, const sgt_interval box[3], sgt_interval gradient[3],
                        sgt_interval second[6])
{
    (void)self;
    if (!(box[0].hi < 3)) return false;
    gradient[0] = sgt_interval_of(40), gradient[2] = sgt_interval_of(7);
    gradient[1] = sgt_interval_scaled(sgt_interval_cosine(box[1]), 30);
    for (int k = 0; k < 6; k++) second[k] = sgt_interval_of(0);
    second[3] = sgt_interval_scaled(sgt_interval_sine(box[1]), -30);
    return true;
}

/* The proof alone, with boxes of all sizes, never says of a point that is met that it is not. */
static void require_no_denial(const sgt_element e[2], const sgt_beam *beam, size_t which)
{
    generator g = {7 + which};
    const sgt_vec2 nowhere = {1e9, 1e9};
    const sgt_aim_options alone = {.max_traces = 1, .start = &nowhere, .starts = 1, .max_boxes = 200};
    for (int k = 0; k < 100; k++) {
        const double u = uniform(&g, -2, 2), v = uniform(&g, -2, 2), span = log_uniform(&g, 1e-4, 1);
        sgt_beam part = *beam;
        part.u = (sgt_interval){u - span * uniform(&g, 0, 1), u + span * uniform(&g, 0, 1)};
        part.v = (sgt_interval){v - span * uniform(&g, 0, 1), v + span * uniform(&g, 0, 1)};
        sgt_ray ray = sgt_beam_ray(beam, u, v);
        sgt_passage is[2];
        sgt_aiming found;
        if (sgt_trace(2, e, 1, &ray, is, NULL, NULL) != 2) continue;
        const sgt_vec2 there = {is[1].hit.p.x, is[1].hit.p.y};
        REQUIRE(sgt_aim(1, e, 1, &part, there, is, &alone, &found) != SGT_NO_SUCH_RAY,
                "phase %zu: the ray of %g, %g is denied", which, u, v);
    }
}

/* What is said of a whole beam: that it meets a point, that none of it does, that all of it is evanescent. */
static void test_proofs(void **state)
{
    (void)state;
    const sgt_surface_ops ops = {.name = "wavy", .value = wavy, .second = wavy_second};
    const sgt_named named[] = {{"L", 0.6328e-3}};
    const sgt_formula hologram = formula_of(
        4, "-(sqrt(x^2 + y^2 + (z + 200)^2) + sqrt(x^2 + y^2 + (z - 100)^2))/L", 1, named);
    const double a[9] = {0, 0, 0.01, 0.02, -1};
    const sgt_zernike zernike = {.norm = 4, .order = SGT_NOLL, .a = {a, 1, 5}};
    const sgt_conic focus = {.c = -1 / 50.0, .k = -2}, bowl = {.c = 1 / 60.0};
    grating g;
    set_grating(&g, 300, 1, 0.5e-3);
    sgt_phase steep = g.phase;
    steep.per_wave = 4.8e-3; /* nearly evanescent */
    const sgt_phase phase[] = {
        g.phase,
        steep,
        {.kind = SGT_PHASE_FUNCTION, .waves = {&sgt_formula_ops, &hologram}, .per_wave = 0.6328e-3},
        {.kind = SGT_PHASE_SAG, .waves = {&sgt_zernike_ops, &zernike}, .per_wave = 0.1},
        {.kind = SGT_PHASE_SAG, .waves = {&sgt_conic_ops, &focus}, .per_wave = 1},
        {.kind = SGT_PHASE_FUNCTION, .waves = {&ops, NULL}, .per_wave = 1e-3, .bounds = wavy_bounds},
        {.kind = SGT_PHASE_FUNCTION, .waves = {&ops, NULL}, .per_wave = 1e-3},
    };
    const sgt_beam beam = {
        .o = {0, 0, -9}, .ou = {1, 0, 0}, .ov = {0, 1, 0}, .d = {0, 0, 1}, .u = {-2, 2}, .v = {-2, 2}};
    for (size_t i = 0; i < COUNT_OF(phase); i++)
        for (int curved = 0; curved < 2; curved++) {
            const sgt_element e[] = {
                {.surface = {&sgt_conic_ops, curved ? &bowl : &flat}, .index = 1.5, .phase = &phase[i]},
                {.surface = {&sgt_conic_ops, &flat}, .pose = {.origin = {0, 0, 30}}}};
            sgt_passage is[2];
            sgt_aiming found;
            sgt_ray ray = sgt_beam_ray(&beam, 0.7, -1.1);
            assert_int_equal(sgt_trace(2, e, 1, &ray, is, NULL, NULL), 2);
            const sgt_vec2 there = {is[1].hit.p.x, is[1].hit.p.y}, beside = {there.x + 9, there.y};
            REQUIRE(sgt_aim(1, e, 1, &beam, there, is, NULL, &found) == SGT_MET, "phase %zu", i);
            const sgt_aimed far = sgt_aim(1, e, 1, &beam, beside, is, NULL, &found);
            require_no_denial(e, &beam, i);
            const bool known = i + 1 < COUNT_OF(phase);
            REQUIRE(far == (known ? SGT_NO_SUCH_RAY : SGT_AIMED_UNDECIDED), "phase %zu: %s", i,
                    sgt_aimed_text(far));
        }
    /* an order that does not exist, for any ray of the beam */
    set_grating(&g, 300, 1, 8e-3);
    const sgt_element e[] = {plane_with(&g.phase, 1.5),
                             {.surface = {&sgt_conic_ops, &flat}, .pose = {.origin = {0, 0, 30}}}};
    sgt_passage is[2];
    sgt_aiming found;
    assert_int_equal(sgt_aim(1, e, 1, &beam, (sgt_vec2){0, 0}, is, NULL, &found), SGT_NO_SUCH_RAY);
    /* of the stop itself the phase has no say */
    assert_int_equal(sgt_aim(0, e, 1, &beam, (sgt_vec2){0.5, 0.5}, is, NULL, &found), SGT_MET);
}

static void require_unsound(sgt_phase phase, const char *key)
{
    const sgt_element e = plane_with(&phase, 0);
    sgt_ray ray = {.o = {0, 0, -1}, .d = {0, 0, 1}};
    sgt_passage is;
    sgt_fate fate;
    sgt_error error;
    REQUIRE(sgt_trace(1, &e, 1, &ray, &is, &fate, NULL) == 0 && fate == SGT_LOST &&
                is.hit.status == SGT_INVALID,
            "%s is taken", key);
    assert_false(sgt_explain_trace(1, &e, 1, &ray, NULL, NULL, NULL, &error));
    REQUIRE(strcmp(error.key, key) == 0, "%s, should be %s", error.key, key);
    assert_true(isnan(sgt_phase_at(&e, 1, ray.d, &is.hit).along));
}

static void test_unsound(void **state)
{
    (void)state;
    static const double bad[] = {NAN, HUGE_VAL, -HUGE_VAL};
    const sgt_quadric ball = {.squares = {1, 1, 1}, .constant = -1};
    const sgt_surface_ops none = {.name = "none"};
    grating g;
    set_grating(&g, 100, 0, 1e-3);
    sgt_phase p = g.phase;
    for (size_t i = 0; i < COUNT_OF(bad); i++) p.per_wave = bad[i], require_unsound(p, "e[0].phase.per_wave");
    for (size_t i = 0; i < COUNT_OF(p.reserved_); i++) {
        p = g.phase, p.reserved_[i] = 1;
        char key[] = "e[0].phase.reserved_[0]";
        key[sizeof key - 3] = (char)('0' + i);
        require_unsound(p, key);
    }
    p = g.phase, p.waves.ops = NULL, require_unsound(p, "e[0].phase.waves.ops");
    p = g.phase, p.waves.ops = &none, require_unsound(p, "e[0].phase.waves.ops->value");
    p = g.phase, p.waves = (sgt_surface){&sgt_quadric_ops, &ball}, require_unsound(p, "e[0].phase.waves");
    p.kind = SGT_FACETS, require_unsound(p, "e[0].phase.waves");
    p.kind = (sgt_phase_kind)5, require_unsound(p, "e[0].phase.kind");
    g.a[1] = (double)NAN, p = g.phase, require_unsound(p, "e[0].phase.waves.self.coefficients");
    for (size_t i = 0; i < COUNT_OF(bad); i++) {
        const sgt_conic c = {.c = bad[i]};
        p.waves = (sgt_surface){&sgt_conic_ops, &c}, require_unsound(p, "e[0].phase.waves.self.curvature");
        const sgt_even_asphere a = {.a = {0, bad[i]}};
        p.waves = (sgt_surface){&sgt_even_asphere_ops, &a};
        require_unsound(p, "e[0].phase.waves.self.coefficients");
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_grating),       cmocka_unit_test(test_path_of_a_grating),
        cmocka_unit_test(test_perfect_focus), cmocka_unit_test(test_foci_on_curved_surfaces),
        cmocka_unit_test(test_hologram),      cmocka_unit_test(test_zernike),
        cmocka_unit_test(test_cancelling),
        cmocka_unit_test(test_orders),        cmocka_unit_test(test_user),
        cmocka_unit_test(test_proofs),        cmocka_unit_test(test_unsound),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
