// SPDX-License-Identifier: MIT
/* shape.c - sags, sections and parts in use.
 *
 * Sags are compared with closed forms in long double, and of every type with F = 0.  Sections of spheres,
 * tori and ellipsoids must lie on the surface, close, and be as long as the curve is; so they cover it.  The
 * edge of an item is where sgt_clipped_by begins to clip. */
#include "require.h"

#include <sagitta/shape.h>
#include <sagitta/surfaces.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double CIRCLE = 6.283185307179586;

static double uniform(double low, double high)
{
    static unsigned long long state = 20261127;
    state = state * 6364136223846793005ULL + 1442695040888963407ULL;
    return low + (high - low) * ((double)(state >> 11) * 0x1p-53);
}

/* -------------------------------------------------------------------- sags */

static long double closed_conic(double c, double k, long double square)
{
    return c * square / (1 + sqrtl(1 - (1 + (long double)k) * c * c * square));
}

static void test_closed_forms(void)
{
    for (int i = 0; i < 2000; i++) {
        const double x = uniform(-4, 4), y = uniform(-4, 4);
        const sgt_conic conic = {.c = uniform(-0.15, 0.15), .k = uniform(-3, 0.2)};
        const sgt_even_asphere asphere = {.c = conic.c, .k = conic.k, .semi_diameter = 6,
                                          .a = {0, uniform(-1e-4, 1e-4), uniform(-1e-6, 1e-6)}};
        const sgt_biconic biconic = {.c_x = conic.c, .k_x = conic.k, .c_y = uniform(-0.1, 0.1), .k_y = -0.5,
                                     .semi_diameter = 6};
        const long double xx = (long double)x * x, yy = (long double)y * y, r2 = xx + yy;
        const long double cx = biconic.c_x, cy = biconic.c_y, z = closed_conic(conic.c, conic.k, r2);
        const struct { sgt_surface s; long double z; const char *type; } row[] = {
            {{&sgt_conic_ops, &conic}, z, "conic"},
            {{&sgt_even_asphere_ops, &asphere}, z + asphere.a[1] * r2 * r2 + asphere.a[2] * r2 * r2 * r2,
             "even asphere"},
            {{&sgt_biconic_ops, &biconic},
             (cx * xx + cy * yy) / (1 + sqrtl(1 - (1 + (long double)biconic.k_x) * cx * cx * xx -
                                              (1 + (long double)biconic.k_y) * cy * cy * yy)), "biconic"},
        };
        for (size_t k = 0; k < sizeof row / sizeof *row; k++) {
            const double sag = sgt_sag_at(row[k].s, x, y);
            REQUIRE(fabsl(sag - row[k].z) <= 0x1p-50 * (fabsl(row[k].z) + 0.1L),
                    "%s at %g, %g: %.17g, not %.17Lg", row[k].type, x, y, sag, row[k].z);
        }
    }
}

static void test_every_type(void)
{
    for (const sgt_builtin *b = sgt_builtins(); b->type; b++) {
        if (!b->specimen) continue;
        const sgt_surface s = {b->ops, b->specimen};
        int met = 0;
        for (int i = 0; i < 100; i++) {
            const double x = uniform(-3, 3), y = uniform(-3, 3), z = sgt_sag_at(s, x, y);
            met += !isnan(z);
            if (isnan(z)) continue;
            sgt_vec3 grad;
            const double f = b->ops->value(b->specimen, (sgt_vec3){x, y, z}, &grad);
            REQUIRE(fabs(f) <= 1e-13 * (fabs(grad.z) + 1), "%s: F = %g at the sag", b->type, f);
        }
        REQUIRE(sgt_is_sag(s) ? met > 50 : met == 0, "%s: %d of 100 sags", b->type, met);
    }
}

static void test_ends(void)
{
    static const sgt_conic ball = {.c = 0.1}, bowl = {.c = 0.1, .semi_diameter = 5},
                           dish = {.c = 0.1, .k = -1}, oblate = {.c = 0.1, .k = 3};
    const struct { const sgt_conic *of; double radius; } row[] = {
        {&ball, 10}, {&bowl, 5}, {&dish, 20}, {&oblate, 5}};
    for (size_t k = 0; k < sizeof row / sizeof *row; k++) {
        const sgt_surface s = {&sgt_conic_ops, row[k].of};
        const double radius = sgt_whole_radius(s, 20);
        REQUIRE(fabs(radius - row[k].radius) <= 20 * 0x1p-38, "%zu: %.17g", k, radius);
        REQUIRE(row[k].radius == 20 || isnan(sgt_sag_at(s, 1.001 * radius, 0)), "%zu", k);
        REQUIRE(!isnan(sgt_sag_at(s, 0, 0.999 * radius)), "%zu", k);
        REQUIRE(isnan(sgt_sag_at(s, (double)NAN, 0)) && isnan(sgt_sag_at(s, 0, HUGE_VAL)), "%zu", k);
    }
}

/* ---------------------------------------------------------------- sections */

static double apart(sgt_vec3 a, sgt_vec3 b) { return hypot(hypot(a.x - b.x, a.y - b.y), a.z - b.z); }

/* How many ends of strokes are closer to p than rounding. */
static int ends_at(size_t count, sgt_vec3 stroke[][2], sgt_vec3 p)
{
    int n = 0;
    for (size_t i = 0; i < count; i++)
        for (int k = 0; k < 2; k++) n += apart(stroke[i][k], p) < 1e-9;
    return n;
}

typedef double distance_of(sgt_vec3 p); /* from the surface */
static double from_ball(sgt_vec3 p) { return hypot(hypot(p.x, p.y), p.z) - 3; }
static double from_ring(sgt_vec3 p) { return hypot(hypot(p.x, p.y) - 5, p.z) - 2; }
static double from_egg(sgt_vec3 p) /* to first order, divided by no more than the least axis */
{
    return (hypot(hypot(p.x, p.y) / 5, p.z / 4) - 1) * 4;
}

/* The length of an ellipse, by the trapezoidal rule: for periodic functions it converges exponentially. */
static double ellipse_length(double a, double b)
{
    double sum = 0;
    for (int k = 0; k < 400; k++) sum += hypot(a * sin(CIRCLE * k / 400), b * cos(CIRCLE * k / 400));
    return sum * CIRCLE / 400;
}

static void test_sections(void)
{
    static const sgt_quadric ball = {.squares = {1, 1, 1}, .constant = -9}, away = {
        .squares = {1, 1, 1}, .linear = {-100, 0, 0}, .constant = 2500 - 9};
    static const sgt_torus ring = {.major = 5, .minor = 2};
    static const sgt_ellipsoid egg = {.a = 5, .f = 0.2};
    static sgt_vec3 stroke[SGT_SECTION_MOST][2], few[10][2];
    const double a = 0.7, b = 0.4;
    const sgt_vec3 x = {1, 0, 0}, y = {0, 1, 0}, z = {0, 0, 1}, turned = {cos(a), sin(a), 0},
                   up = {-sin(a) * cos(b), cos(a) * cos(b), sin(b)};
    const struct { sgt_surface s; distance_of *off; sgt_vec3 across, along; double length; } row[] = {
        {{&sgt_quadric_ops, &ball}, from_ball, x, z, CIRCLE * 3},
        {{&sgt_quadric_ops, &ball}, from_ball, turned, up, CIRCLE * 3},
        {{&sgt_torus_ops, &ring}, from_ring, x, z, 2 * CIRCLE * 2},
        {{&sgt_torus_ops, &ring}, from_ring, turned, z, 2 * CIRCLE * 2},
        {{&sgt_torus_ops, &ring}, from_ring, x, y, CIRCLE * (3 + 7)},
        {{&sgt_ellipsoid_ops, &egg}, from_egg, turned, z, ellipse_length(5, 4)},
        {{&sgt_ellipsoid_ops, &egg}, from_egg, x, y, CIRCLE * 5},
    };
    for (size_t k = 0; k < sizeof row / sizeof *row; k++) {
        sgt_element e = {.surface = row[k].s};
        const size_t count = sgt_section(&e, 2, row[k].across, row[k].along, SGT_SECTION_MOST, stroke);
        double length = 0, off = 0;
        int open = 0;
        for (size_t i = 0; i < count; i++) {
            length += apart(stroke[i][0], stroke[i][1]);
            for (int end = 0; end < 2; end++) {
                off = fmax(off, fabs(row[k].off(stroke[i][end])));
                open += ends_at(count, stroke, stroke[i][end]) < 2;
            }
        }
        REQUIRE(off < 0.004, "section %zu: %g off the surface", k, off);
        REQUIRE(open == 0, "section %zu: %d open ends", k, open);
        REQUIRE(fabs(length / row[k].length - 1) < 2e-3, "section %zu: length %g, not %g", k, length,
                row[k].length);
        REQUIRE(sgt_section(&e, 2, row[k].across, row[k].along, 0, NULL) == count, "section %zu", k);
        memset(few, 0, sizeof few);
        REQUIRE(sgt_section(&e, 2, row[k].across, row[k].along, 9, few) == count, "section %zu", k);
        REQUIRE(memcmp(few, stroke, 9 * sizeof *few) == 0 && few[9][0].x == 0 && few[9][1].z == 0, "%zu", k);
        e.semi_diameter = 1; /* no farther than asked */
        const size_t part = sgt_section(&e, 2.5, row[k].across, row[k].along, SGT_SECTION_MOST, stroke);
        double far = 0;
        for (size_t i = 0; i < part; i++) {
            const sgt_vec3 p = stroke[i][0], u = row[k].across;
            far = fmax(far, fabs(p.x * u.x + p.y * u.y + p.z * u.z));
        }
        REQUIRE(far <= 2.5 * (1 + 1e-12) && (part > 0) == (row[k].s.self != &ring || row[k].along.y == 1),
                "section %zu: %zu strokes, out to %g", k, part, far);
        REQUIRE(sgt_section(&e, 0, x, z, 0, NULL) == 0 && sgt_section(&e, (double)NAN, x, z, 0, NULL) == 0,
                "section %zu: no reach", k);
    }
    const sgt_element far_off = {.surface = {&sgt_quadric_ops, &away}};
    REQUIRE(sgt_section(&far_off, 2, x, z, 0, NULL) == 0, "a ball far beside the axis");
}

/* -------------------------------------------------------------------- parts */

static bool clipped(const sgt_aperture_item *item, double x, double y)
{
    const sgt_aperture aperture = {.count = 1, .items = item};
    const sgt_element e = {.aperture = &aperture};
    return sgt_clipped_by(&e, (sgt_vec3){x, y, 0}).by != SGT_BY_NONE;
}

static const sgt_vec2 corners[] = {{3, -2}, {3, 2}, {-2, 3}, {-3, -1}};
static const sgt_aperture_item items[] = {
    {.shape = SGT_CIRCLE, .radius = 2, .centre = {5, 1}},
    {.shape = SGT_ANNULUS, .radius = 3, .inner = 1},
    {.shape = SGT_RECTANGLE, .half = {3, 1}, .degrees = 30, .centre = {-1, 2}},
    {.shape = SGT_ELLIPSE, .half = {3, 1}, .degrees = -50, .centre = {0, 4}},
    {.shape = SGT_POLYGON, .vertices = corners, .count = 4, .degrees = 15, .centre = {1, 1}},
};
enum { ITEMS = sizeof items / sizeof *items };

static void test_edges(void)
{
    for (size_t i = 0; i < ITEMS; i++)
        for (int inner = 0; inner < (items[i].shape == SGT_ANNULUS ? 2 : 1); inner++) {
            const sgt_part p = sgt_part_of_item(&items[i], 100, inner);
            const sgt_vec2 m = p.middle;
            double area = 0;
            for (int k = 0; k < SGT_RIM_POINTS; k++) {
                const sgt_vec2 at = p.rim[k], next = p.rim[(k + 1) % SGT_RIM_POINTS];
                const double u = at.x - m.x, v = at.y - m.y, in = 1 - 1e-9, out = 1 + 1e-9;
                REQUIRE(clipped(&items[i], m.x + in * u, m.y + in * v) == inner, "item %zu, point %d", i, k);
                REQUIRE(clipped(&items[i], m.x + out * u, m.y + out * v) == !inner, "item %zu, point %d", i,
                        k);
                area += u * (next.y - m.y) - v * (next.x - m.x);
            }
            REQUIRE(p.item == &items[i] && area > 0, "item %zu", i);
            for (int k = 0; k < 50 && !inner; k++) {
                const double angle = CIRCLE * k / 50, c = cos(angle), s = sin(angle), less = 1 - 2e-3;
                double low, high;
                REQUIRE(sgt_part_along(&p, (sgt_vec2){c, s}, &low, &high) && low < 0 && high > 0, "%zu", i);
                const double t[] = {less * low, less * high}, beyond[] = {low / less, high / less};
                for (int end = 0; end < 2 && items[i].shape != SGT_ANNULUS; end++)
                    REQUIRE(!clipped(&items[i], m.x + t[end] * c, m.y + t[end] * s) &&
                                clipped(&items[i], m.x + beyond[end] * c, m.y + beyond[end] * s),
                            "item %zu along %g", i, angle);
            }
        }
    const sgt_aperture_item strip = {.shape = SGT_RECTANGLE, .half = {1, HUGE_VAL}};
    const sgt_part p = sgt_part_of_item(&strip, 7, false);
    double most = 0;
    for (int k = 0; k < SGT_RIM_POINTS; k++) most = fmax(most, fabs(p.rim[k].y));
    REQUIRE(most == 7, "a side without end: %g", most);
}

static void test_in_use(void)
{
    static const sgt_conic flat = {0}, ball = {.c = 0.1};
    static const sgt_aperture round = {.count = 1, .items = &items[1]},
                              beside = {.count = 1, .items = &items[0]};
    const sgt_footprint about = {.radius = 2, .low = {-2, -1}, .high = {1, 2}},
                        off = {.radius = 12, .low = {-1, 10}, .high = {1, 12}};
    const sgt_lens_surface mirror = {.mirror = true}, sized = {.size = 4};
    sgt_element e = {.surface = {&sgt_conic_ops, &flat}};
    REQUIRE(sgt_half_height(&e, NULL, NULL, 9) == 9, "without rays");
    REQUIRE(sgt_half_height(&e, NULL, &about, 9) == 1.1 * 2, "by rays");
    REQUIRE(sgt_half_height(&e, &sized, &about, 9) == 4, "a size for drawings");
    for (size_t i = 0; i < ITEMS; i++) { /* an aperture: as far out as its sides, seen from the axis */
        const double farthest[] = {hypot(5, 1) + 2, 3, hypot(1, 2) + 3, 4 + 3, hypot(1, 1) + hypot(3, 2)};
        const sgt_aperture one = {.count = 1, .items = &items[i]};
        const sgt_element with = {.surface = e.surface, .aperture = &one};
        const double height = sgt_half_height(&with, &sized, &about, 9);
        REQUIRE(fabs(height - farthest[i]) < 1e-14, "item %zu: %.17g", i, height);
    }
    const struct {
        double semi_diameter;
        const sgt_aperture *aperture;
        const sgt_lens_surface *given;
        const sgt_footprint *met;
        double height, x, y;  /* of the part, and its middle */
        bool of_item;
    } row[] = {
        {0, NULL, NULL, NULL, 9, 0, 0, false},       {0, NULL, NULL, &about, 2.2, 0, 0, false},
        {0, NULL, NULL, &off, 13.2, 0, 0, false},    {0, NULL, &mirror, &off, 1.1, 0, 11, false},
        {0, NULL, &mirror, NULL, 9, 0, 0, false},    {0, NULL, &sized, &off, 4, 0, 0, false},
        {6, NULL, &mirror, &off, 6, 0, 0, false},    {6, &round, NULL, &about, 6, 0, 0, false},
        {6, &round, &mirror, &about, 3, 0, 0, true}, {0, &round, NULL, NULL, 3, 0, 0, true},
        {6, &beside, NULL, NULL, 2, 5, 1, true},     {1, &beside, NULL, NULL, 1, 5, 1, true},
    };
    for (size_t k = 0; k < sizeof row / sizeof *row; k++) {
        e.semi_diameter = row[k].semi_diameter, e.aperture = row[k].aperture;
        const sgt_part p = sgt_part_in_use(&e, row[k].given, row[k].met, 9);
        double low, high;
        REQUIRE(sgt_part_along(&p, (sgt_vec2){0, 1}, &low, &high), "part %zu", k);
        REQUIRE(fabs((high - low) / 2 - row[k].height) < 1e-12, "part %zu: %.17g", k, (high - low) / 2);
        REQUIRE(p.middle.x == row[k].x && p.middle.y == row[k].y, "part %zu: %g, %g", k, p.middle.x,
                p.middle.y);
        REQUIRE((p.item != NULL) == row[k].of_item, "part %zu", k);
    }
    const sgt_element globe = {.surface = {&sgt_conic_ops, &ball}};
    const sgt_part p = sgt_part_in_use(&globe, NULL, NULL, 15);
    REQUIRE(fabs(p.rim[0].x - 10) < 1e-9, "a part ends where the surface does: %g", p.rim[0].x);
}

int main(void)
{
    test_closed_forms();
    test_every_type();
    test_ends();
    test_sections();
    test_edges();
    test_in_use();
    if (faults) printf("%d faults\n", faults);
    return faults > 0;
}
