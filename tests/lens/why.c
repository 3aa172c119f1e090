// SPDX-License-Identifier: MIT
/* why.c - what became of a ray: each reason by a ray for which it is known by hand.
 *
 * Texts are cut as snprintf cuts them, whatever the room.  The nearest approach is compared with spheres,
 * planes and tori, the incidence with the sine y/R of a ray parallel to the axis of a sphere. */
#include "require.h"

#include <sagitta/surfaces.h>
#include <sagitta/why.h>

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { SIZE = 400 };
static const sgt_conic ball = {.c = 0.1}, bowl = {.c = 0.1, .semi_diameter = 5}, flat = {.semi_diameter = 2};
static const sgt_torus ring = {.major = 5, .minor = 1};
static const sgt_even_asphere asphere = {.c = 0.1, .a = {0, 1e-4}};

static sgt_surface conic(const sgt_conic *c) { return (sgt_surface){&sgt_conic_ops, c}; }

static sgt_ray line_of(double ox, double oy, double oz, double dx, double dy, double dz)
{
    return (sgt_ray){.o = {ox, oy, oz}, .d = {dx, dy, dz}, .tmin = -HUGE_VAL, .tmax = HUGE_VAL};
}

/* Tables: the rows that have a surface, and no others. */
static void test_of_types(void)
{
    const sgt_surface_ops own = sgt_conic_ops;
    const sgt_surface user = {&own, &ball};
    for (const sgt_builtin *b = sgt_builtins(); b->type; b++) {
        const sgt_surface s = {b->ops, b->specimen};
        const sgt_builtin *row = sgt_builtin_of(s);
        REQUIRE(row->ops == b->ops && row <= b, "%s: row %s", b->type, row->type);
        const bool sag = b->family <= SGT_FAMILY_DEPARTURE;
        REQUIRE(!b->specimen || sgt_is_sag(s) == sag, "%s", b->type);
        REQUIRE((sgt_number_of(s, "semi_diameter") != NULL) == sag, "%s", b->type);
        REQUIRE(!sgt_number_of(s, "semi-diameter"), "%s", b->type);
    }
    REQUIRE(sgt_builtin_of(user)->type == NULL && !sgt_number_of(user, "curvature"), "a user's surface");
    REQUIRE(sgt_is_sag(user), "a user's sag");
    REQUIRE(*sgt_number_of(conic(&bowl), "semi_diameter") == 5, "a bowl");
}

static void test_missed(void)
{
    const sgt_surface sphere = conic(&ball), cup = conic(&bowl), plane = conic(&flat),
                      torus = {&sgt_torus_ops, &ring};
    const struct { sgt_surface s; sgt_ray ray; const char *why; } row[] = {
        {sphere, line_of(12, 0, 0, 0, 0, 1), "it never comes within r = 10 of the axis"},
        {sphere, {.o = {0, 0, 1}, .d = {0, 0, 1}, .tmax = 5}, "there is a root at t = -1, but it is outside"},
        {sphere, line_of(-20, 0, 15, 1, 0, 0), "it meets only the other sheet of the quadric"},
        {sphere, line_of(-20, 0, -1, 1, 0, 0), "it passes beside the whole quadric"},
        {cup, line_of(6, 0, 0, 0, 0, 1), "it meets the surface only outside semi_diameter, first at r = 6"},
        {plane, line_of(0, 0, 1, 0, 1, 0), "it is parallel to the surface"},
        {torus, line_of(0, 0, 0, 0, 0, 1), "it passes beside the surface"},
        {torus, line_of(9, 0, 0, 0, 0, 1), "it passes beside the surface"},
        {torus, {.o = {-9, 0, 0}, .d = {1, 0, 0}, .tmax = 1}, "it reaches the surface only outside tmin ..."},
    };
    for (size_t i = 0; i < sizeof row / sizeof *row; i++) {
        char text[SIZE];
        REQUIRE(sgt_intersect(row[i].s, row[i].ray, NULL).status == SGT_MISS, "row %zu", i);
        const size_t length = sgt_why_missed(row[i].s, &row[i].ray, SIZE, text);
        REQUIRE(length == strlen(text), "row %zu", i);
        REQUIRE(strncmp(text, row[i].why, strlen(row[i].why)) == 0, "row %zu: %s", i, text);
    }
}

static void test_cut(void)
{
    const sgt_ray line = line_of(6, 0, 0, 0, 0, 1);
    char whole[SIZE], text[SIZE];
    const size_t length = sgt_why_missed(conic(&bowl), &line, SIZE, whole);
    REQUIRE(sgt_why_missed(conic(&bowl), &line, 0, NULL) == length, "no room");
    for (size_t size = 1; size < SIZE; size++) {
        memset(text, '#', SIZE);
        REQUIRE(sgt_why_missed(conic(&bowl), &line, size, text) == length, "%zu", size);
        const size_t there = size <= length ? size - 1 : length;
        REQUIRE(memcmp(text, whole, there) == 0 && text[there] == 0, "%zu: %s", size, text);
        REQUIRE(size == SIZE || text[size] == '#', "%zu", size);
    }
}

static void test_undecided(void)
{
    const sgt_surface cup = conic(&bowl), bent = {&sgt_even_asphere_ops, &asphere};
    const struct {
        sgt_surface s; double semi_diameter; sgt_ray ray; sgt_options opt; bool near; const char *why;
    } row[] = {
        {bent, 5, line_of(-20, 0, 0.5, 1, 0, 0), {.proof = SGT_PROVE_FIRST, .pick = SGT_NEAR_SEED}, true,
         "the root near the vertex is not the only one: the ray meets the surface at t = 1"},
        {bent, 5, line_of(-20, 0, 0, 1, 0, 0), {.proof = SGT_PROVE_FIRST}, true,
         "the ray grazes; there may be a root or none: rounding hides which"},
        {bent, 0, line_of(0.1, 0.2, -9, 0.3, 0.1, 1), {.max_evals = 1}, false, "max_evals was used up first"},
        {bent, 0, line_of(0, 0, -9, 0, 0, 0), {.max_evals = 1}, false, "the ray or the surface is invalid"},
    };
    for (size_t i = 0; i < sizeof row / sizeof *row; i++) {
        char text[SIZE] = "", head[40];
        const sgt_hit hit = sgt_intersect(row[i].s, row[i].ray, &row[i].opt);
        const sgt_search s = {.surface = row[i].s, .semi_diameter = row[i].semi_diameter, .ray = row[i].ray,
                              .options = &row[i].opt, .near_seed = row[i].near, .hit = &hit};
        REQUIRE(hit.status < 0, "row %zu: %s", i, sgt_status_text(hit.status));
        REQUIRE(sgt_why_undecided(&s, SIZE, text) == strlen(text), "row %zu", i);
        snprintf(head, sizeof head, "%s", sgt_status_text(hit.status));
        REQUIRE(strncmp(text, head, strlen(head)) == 0 && strstr(text, row[i].why), "row %zu: %s", i, text);
    }
    const sgt_ray line = line_of(0, 0, -9, 0, 0, 1);
    const sgt_hit hit = sgt_intersect(cup, line, NULL);
    const sgt_search s = {.surface = cup, .ray = line, .hit = &hit};
    char text[SIZE] = "#";
    REQUIRE(sgt_why_undecided(&s, SIZE, text) == 0 && !*text, "a hit: %s", text);
}

static void test_refused(void)
{
    const sgt_ray ray = {.o = {0, 0, -9}, .d = {0, 0, 1}, .tmin = 0, .tmax = 12};
    const sgt_ray wide = line_of(6, 0, 0, 0, 0, 1);
    const struct { const sgt_ray *ray; double t; const char *why; } row[] = {
        {&ray, 13, "lies beyond the ray's end, tmax = 12"},
        {&ray, -1, "lies before the ray's start, tmin = 0"},
        {&ray, 0, "is the ray's own start"}, {&ray, 10, "lies behind the library's answer"},
        {&wide, 2, "lies outside semi_diameter, at r = 6"},
    };
    for (size_t i = 0; i < sizeof row / sizeof *row; i++) {
        char text[SIZE];
        const sgt_hit hit = sgt_intersect(conic(&bowl), *row[i].ray, NULL);
        const sgt_search s = {.surface = conic(&bowl), .ray = *row[i].ray, .hit = &hit};
        REQUIRE(sgt_why_refused(&s, row[i].t, SIZE, text) == strlen(text), "row %zu", i);
        REQUIRE(strncmp(text, row[i].why, strlen(row[i].why)) == 0, "row %zu: %s", i, text);
    }
}

/* A rim counts; the half sphere ends at its equator; the hole of a torus is passed inside. */
static void test_nearest(void)
{
    const struct { sgt_surface s; sgt_ray ray; double distance; } row[] = {
        {conic(&ball), line_of(12, 0, 0, 0, 0, 1), 2}, {conic(&bowl), line_of(0, 13, 0, 0, 0, 1), 8},
        {conic(&ball), line_of(-20, 0, -1, 1, 0, 0), 1}, {conic(&flat), line_of(1, 9, -4, 0, 1, 0), 4},
        {conic(&flat), line_of(0, 6, -3, 2, 0, 0), 5},
        {{&sgt_torus_ops, &ring}, line_of(0, 0, 0, 0, 0, 1), 4},
        {{&sgt_torus_ops, &ring}, line_of(9, 0, 0, 0, 0, 1), 3},
    };
    for (size_t i = 0; i < sizeof row / sizeof *row; i++) {
        const sgt_nearest n = sgt_nearest_of(row[i].s, &row[i].ray);
        REQUIRE(n.known && fabs(n.distance - row[i].distance) < 1e-9, "row %zu: %.17g", i, n.distance);
    }
}

static void test_ended(void)
{
    const double R = 10, DEGREES = 57.295779513082321;
    const sgt_element e = {.surface = conic(&ball), .semi_diameter = 5};
    char text[SIZE];
    for (double y = 0; y < 9; y += 0.7) {
        const sgt_arrival a = {.from = {0, y, -3}, .direction = {0, 0, 1},
                               .p = {0, y, R - sqrt(R * R - y * y)}, .index = 1.5, .behind = 1};
        REQUIRE(fabs(sgt_incidence(&e, &a) - DEGREES * asin(y / R)) < 1e-13 * 90, "y %g", y);
        REQUIRE(fabs(sgt_critical_angle(&a) - DEGREES * asin(1 / 1.5)) < 1e-13 * 90, "y %g", y);
        const size_t length = sgt_why_ended(&e, SGT_CLIPPED, &a, SIZE, text);
        char wanted[SIZE];
        snprintf(wanted, SIZE, "clipped by its semi_diameter: r = %.9g is beyond 5", y);
        REQUIRE(y < 5 || strcmp(text, wanted) == 0, "%s", text);
        REQUIRE(length == strlen(text), "%s", text);
        REQUIRE(sgt_why_ended(&e, SGT_PASSED, &a, SIZE, text) == 0 && !*text, "%s", text);
    }
    const sgt_arrival out = {.direction = {0, 0, 1}, .index = 1, .behind = 1.5};
    REQUIRE(sgt_critical_angle(&out) == 90, "into glass");
    const sgt_arrival beside = {.from = {0, 12, 7}, .direction = {0, 0, 1}, .index = 1, .behind = 1};
    sgt_why_ended(&e, SGT_MISSED, &beside, SIZE, text);
    REQUIRE(strcmp(text, "missed it: its line crosses the vertex plane 12 from the axis") == 0, "%s", text);
}

/* A program of a later version that sets a member. */
static void test_later(void)
{
    const sgt_element e = {.surface = conic(&ball)};
    const sgt_hit hit = {.status = SGT_UNPROVEN};
    const sgt_search s = {.surface = e.surface, .hit = &hit, .reserved_ = {0, 0, 0, 1}};
    const sgt_arrival a = {.reserved_ = {1}};
    char text[3][SIZE] = {""};
    sgt_why_undecided(&s, SIZE, text[0]);
    sgt_why_refused(&s, 1, SIZE, text[1]);
    sgt_why_ended(&e, SGT_CLIPPED, &a, SIZE, text[2]);
    for (int i = 0; i < 3; i++)
        REQUIRE(strstr(text[i], i < 2 ? "member that sgt_search" : "member that sgt_arrival"), "%s", text[i]);
}

int main(void)
{
    test_of_types();
    test_missed();
    test_cut();
    test_undecided();
    test_refused();
    test_nearest();
    test_ended();
    test_later();
    printf("%d faults\n", faults);
    return faults != 0;
}
