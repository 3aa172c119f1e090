// SPDX-License-Identifier: MIT
/* patterns.c - points in a pupil.
 *
 * Philox against the published vectors (Salmon et al. 2011; Random123's known answers).  Each pattern: how
 * many points there are, all in the circle, weights that add up to 1, and the moments of a uniform circle,
 * 1/4 of x^2 and of y^2, 1/8 of x^4, 0 of x, y and x y, within what the number of points allows.  A random
 * point depends on the seed and its number alone, and is that of Philox's words; the first points of a longer
 * Sobol pattern are the shorter one, and its points those of its definition.  The rays through points by
 * column. */
#include "require.h"

#include <sagitta/analysis.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void test_philox(void)
{
    static const struct { uint32_t counter[4], key[2], out[4]; } known[] = {
        {{0, 0, 0, 0}, {0, 0}, {0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}},
        {{0xffffffff, 0xffffffff, 0xffffffff, 0xffffffff}, {0xffffffff, 0xffffffff},
         {0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}},
        {{0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}, {0xa4093822, 0x299f31d0},
         {0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}},
    };
    for (size_t i = 0; i < sizeof known / sizeof known[0]; i++) {
        uint32_t out[4];
        sgt_philox(known[i].counter, known[i].key, out);
        REQUIRE(memcmp(out, known[i].out, sizeof out) == 0, "vector %zu", i);
    }
}

typedef struct moments { double w, x, y, xx, yy, xy, xxxx; } moments;

static moments moments_of(const sgt_pupil_point *p, size_t n)
{
    moments m = {0, 0, 0, 0, 0, 0, 0};
    for (size_t i = 0; i < n; i++) {
        double x = p[i].x, y = p[i].y, w = p[i].weight;
        m.w += w, m.x += w * x, m.y += w * y, m.xx += w * x * x, m.yy += w * y * y, m.xy += w * x * y;
        m.xxxx += w * x * x * x * x;
    }
    return m;
}

static void test_pattern(sgt_pattern pattern, size_t n, size_t count, double within)
{
    size_t got = sgt_pupil_points(pattern, n, 1, 0, NULL);
    REQUIRE(got == count, "pattern %d of %zu: %zu points, not %zu", pattern, n, got, count);
    sgt_pupil_point *p = malloc(got * sizeof *p), *again = malloc(got * sizeof *p);
    if (!p || !again) abort();
    sgt_pupil_points(pattern, n, 1, got, p);
    sgt_pupil_points(pattern, n, 1, got, again);
    REQUIRE(memcmp(p, again, got * sizeof *p) == 0, "pattern %d", pattern);
    for (size_t i = 0; i < got; i++)
        REQUIRE(p[i].x * p[i].x + p[i].y * p[i].y <= 1 + 0x1p-44 && p[i].weight > 0, "pattern %d: %zu",
                pattern, i);
    moments m = moments_of(p, got);
    REQUIRE(fabs(m.w - 1) < 1e-9, "pattern %d: %g", pattern, m.w);
    REQUIRE(fabs(m.x) < within && fabs(m.y) < within && fabs(m.xy) < within, "pattern %d: %g %g %g", pattern,
            m.x, m.y, m.xy);
    REQUIRE(fabs(m.xx - 0.25) < within && fabs(m.yy - 0.25) < within && fabs(m.xxxx - 0.125) < within,
            "pattern %d: %g %g %g", pattern, m.xx, m.yy, m.xxxx);
    free(p);
    free(again);
}

static void test_alone(void)
{
    enum { MANY = 1000 };
    sgt_pupil_point few[10], many[MANY], other[10];
    sgt_pupil_points(SGT_PATTERN_RANDOM, 10, 42, 10, few);
    sgt_pupil_points(SGT_PATTERN_RANDOM, MANY, 42, MANY, many);
    sgt_pupil_points(SGT_PATTERN_RANDOM, 10, 43, 10, other);
    for (int i = 0; i < 10; i++) {
        REQUIRE(few[i].x == many[i].x && few[i].y == many[i].y, "%d", i);
        REQUIRE(few[i].x != other[i].x, "%d", i);
    }
    sgt_pupil_points(SGT_PATTERN_SOBOL, 10, 0, 10, few);
    sgt_pupil_points(SGT_PATTERN_SOBOL, MANY, 0, MANY, many);
    for (int i = 0; i < 10; i++) REQUIRE(few[i].x == many[i].x && few[i].y == many[i].y, "%d", i);
}

/* A random point is that of the first words of Philox that lie in the circle. */
static void test_random(void)
{
    enum { COUNT = 1000 };
    const uint64_t seed = 0x9876543210abcdefu;
    const uint32_t key[2] = {(uint32_t)seed, (uint32_t)(seed >> 32)};
    sgt_pupil_point at[COUNT];
    sgt_pupil_points(SGT_PATTERN_RANDOM, COUNT, seed, COUNT, at);
    for (uint32_t i = 0; i < COUNT; i++) {
        double c[2] = {2, 2};
        for (uint32_t attempt = 0; c[0] * c[0] + c[1] * c[1] > 1; attempt++) {
            uint32_t w[4];
            sgt_philox((const uint32_t[4]){i, 0, attempt, 0}, key, w);
            for (int k = 0; k < 2; k++)
                c[k] = ((double)(((uint64_t)w[2 * k] << 32 | w[2 * k + 1]) >> 11) + 0.5) * 0x1p-52 - 1;
        }
        REQUIRE(at[i].x == c[0] && at[i].y == c[1], "random point %u", (unsigned)i);
    }
    sgt_pupil_point some[COUNT], one;
    const size_t far = (size_t)0xffffff9cu; /* some of their numbers have more than 32 bits */
    sgt_pupil_random(COUNT, seed, 37, 300, some);
    REQUIRE(memcmp(some, at + 37, 300 * sizeof *some) == 0, "a part");
    sgt_pupil_random(COUNT, seed, far, COUNT, some);
    for (size_t i = 0; i < COUNT; i++) {
        sgt_pupil_random(COUNT, seed, far + i, 1, &one);
        REQUIRE(memcmp(&one, &some[i], sizeof one) == 0, "random point %zu from afar", i);
    }
    REQUIRE(sizeof far < 8 || some[150].x != at[50].x, "numbers of 32 bits");
}

/* Any part of a pattern is that of the whole, to the bit. */
static void test_parts(void)
{
    enum { MOST = 2000 };
    static const struct { sgt_pattern pattern; size_t n; } each[] = {
        {SGT_PATTERN_FAN, 301}, {SGT_PATTERN_GRID, 41}, {SGT_PATTERN_GRID, 2}, {SGT_PATTERN_HEXAPOLAR, 21},
        {SGT_PATTERN_RANDOM, 1000}, {SGT_PATTERN_SOBOL, 1300}, {SGT_PATTERN_CELLS, 40},
        {SGT_PATTERN_CROSS, 99}, {SGT_PATTERN_FAN, 1},
    };
    static sgt_pupil_point all[MOST], some[MOST];
    for (size_t k = 0; k < sizeof each / sizeof *each; k++) {
        sgt_pupil *p = sgt_pupil_new(each[k].pattern, each[k].n, 5, NULL);
        const size_t count = sgt_pupil_points(each[k].pattern, each[k].n, 5, MOST, all);
        REQUIRE(p && sgt_pupil_count(p) == count && count < MOST, "pattern %zu: %zu points", k, count);
        for (size_t first = 0; first < count; first += 1 + first / 5)
            for (size_t part = 1; first + part <= count; part += 1 + part / 2) {
                sgt_pupil_part(p, first, part, some);
                REQUIRE(memcmp(some, all + first, part * sizeof *some) == 0, "pattern %zu: %zu from %zu", k,
                        part, first);
            }
        sgt_pupil_free(p);
    }
    sgt_pupil_free(NULL);
}

/* Sobol's points by their definition, one after another: x is the number k with its bits reversed; bit r of
 * y, from the top, is the parity of binomial(j, r) over the bits j >= r of k, and that binomial is odd where
 * r has no bit that j lacks.  Parts anywhere, of patterns of any length, have to be these. */
static void test_sobol(void)
{
    enum { COUNT = 400000, PART = 300 };
    static sgt_pupil_point some[PART], ring[COUNT];
    size_t count = 0;
    for (uint32_t k = 0; count < COUNT; k++) {
        uint32_t x = 0, y = 0;
        for (unsigned j = 0; j < 32; j++)
            for (unsigned r = 0; r <= j && k >> j & 1; r++) {
                x |= (uint32_t)(r == j) << (31 - r);
                y ^= (uint32_t)((r & ~j) == 0) << (31 - r);
            }
        const double px = x * 0x1p-31 - 1, py = y * 0x1p-31 - 1;
        if (px * px + py * py <= 1) ring[count++] = (sgt_pupil_point){px, py, 0};
    }
    for (size_t n = 1; n <= COUNT; n = n < COUNT ? (n * 9 < COUNT ? n * 9 : COUNT) : n + 1) {
        sgt_pupil *p = sgt_pupil_new(SGT_PATTERN_SOBOL, n, 0, NULL);
        for (size_t first = 0; p && first < n; first += 1 + first / 7) {
            const size_t part = n - first < PART ? n - first : PART;
            sgt_pupil_part(p, first, part, some);
            for (size_t i = 0; i < part; i++)
                REQUIRE(some[i].x == ring[first + i].x && some[i].y == ring[first + i].y &&
                            some[i].weight == 1 / (double)n,
                        "Sobol point %zu of %zu", first + i, n);
        }
        sgt_pupil_free(p);
    }
}

/* Rays by column are those one by one, to the bit. */
static void test_columns(void)
{
    static const char *const object[] = {"", "object: {distance: 30}\n"};
    enum { COUNT = 300, BEAMS = 2 };
    static sgt_pupil_point at[COUNT];
    static sgt_launched one[COUNT];
    static double n[6][COUNT];
    double *column[6];
    for (int k = 0; k < 6; k++) column[k] = n[k];
    sgt_pupil_points(SGT_PATTERN_RANDOM, COUNT, 3, COUNT, at);
    for (int i = 0; i < 4 * BEAMS; i++) {
        char text[400];
        sgt_error e;
        sgt_field_beam b;
        static const sgt_lens_aim stop = SGT_LENS_AIM_REAL_STOP;
        snprintf(text, sizeof text, "pupil: {semi_diameter: 2}\n%ssurfaces:\n"
                                    "  - {type: sphere, radius: 20, thickness: 3, index: 1.5, stop: true}\n"
                                    "  - {type: plane}\n", object[i % BEAMS]);
        sgt_lens *lens = sgt_lens_read_text("lens", text, strlen(text), NULL, &e);
        sgt_launcher *from = lens ? sgt_launcher_new(lens, NULL, &e) : NULL;
        const sgt_field_kind kind = i % BEAMS ? SGT_FIELD_OBJECT_HEIGHT : SGT_FIELD_ANGLE;
        const bool fine = from && sgt_launch_field(from, kind, &(sgt_lens_field){.x = 1, .y = -2}, &b, &e);
        REQUIRE(fine, "%s: %s", text, e.words);
        if (!fine) return;
        if (i / BEAMS > 0) b.shift = (sgt_vec2){0.1, -0.2}, b.scale = (sgt_vec2){0.7, 0.6};
        if (i / BEAMS > 1) b.turn = (sgt_vec2){0.6, 0.8};
        if (i / BEAMS > 2) b.cone = 0.3;
        const bool rays = sgt_launch_rays(from, &b, lens->element, 1, COUNT, at, one, &e);
        REQUIRE(rays && sgt_launch_columns(from, &b, COUNT, at, column, column + 3), "columns %d", i);
        for (int k = 0; k < COUNT; k++) {
            const sgt_ray *r = &one[k].ray;
            const double want[6] = {r->o.x, r->o.y, r->o.z, r->d.x, r->d.y, r->d.z};
            for (int c = 0; c < 6; c++) REQUIRE(memcmp(&want[c], &n[c][k], 8) == 0, "beam %d, ray %d", i, k);
        }
        sgt_launcher *aimed = sgt_launcher_new(lens, &(sgt_launcher_options){.aim = &stop}, &e);
        REQUIRE(aimed && !sgt_launch_columns(aimed, &b, COUNT, at, column, column + 3), "aimed: %s", e.words);
        sgt_launcher_free(aimed), sgt_launcher_free(from), sgt_lens_free(lens);
    }
}

/* The edges of fans and rings are exactly on the circle's axes. */
static void test_exact(void)
{
    sgt_pupil_point p[40];
    sgt_pupil_points(SGT_PATTERN_FAN, 3, 0, 40, p);
    REQUIRE(p[0].y == -1 && p[1].y == 0 && p[2].y == 1 && p[0].x == 0, "%g", p[0].y);
    REQUIRE(sgt_pupil_points(SGT_PATTERN_FAN, 1, 0, 40, p) == 1 && p[0].x == 0 && p[0].y == 0, "%g", p[0].y);
    sgt_pupil_points(SGT_PATTERN_HEXAPOLAR, 3, 0, 40, p);
    REQUIRE(p[0].x == 0 && p[19].x == 1 && p[19].y == 0 && p[28].x == -1 && p[28].y == 0, "%g %g", p[19].x,
            p[28].x);
}

/* The order of points is that of the rows of every table: of a net x by x, from below. */
static void test_order(void)
{
    static const sgt_pupil_point grid[] = {{-1, 0, 0.2}, {0, -1, 0.2}, {0, 0, 0.2}, {0, 1, 0.2}, {1, 0, 0.2}};
    static const double cells[][2] = {{-0.5, -0.5}, {-0.5, 0.5}, {0.5, -0.5}, {0.5, 0.5}};
    sgt_pupil_point at[8];
    REQUIRE(sgt_pupil_points(SGT_PATTERN_GRID, 3, 0, 8, at) == 5, "grid of 3");
    for (int i = 0; i < 5; i++)
        REQUIRE(at[i].x == grid[i].x && at[i].y == grid[i].y && at[i].weight == grid[i].weight, "point %d",
                i);
    REQUIRE(sgt_pupil_points(SGT_PATTERN_CELLS, 2, 0, 8, at) == 4, "cells of 2");
    for (int i = 0; i < 4; i++) REQUIRE(at[i].x == cells[i][0] && at[i].y == cells[i][1], "cell %d", i);
    REQUIRE(sgt_pupil_points(SGT_PATTERN_GRID, 2, 0, 0, NULL) == 0, "grid of 2");
    REQUIRE(sgt_pupil_points(SGT_PATTERN_CROSS, 4, 0, 0, NULL) == 8, "cross of 4");
}

int main(void)
{
    test_order();
    test_philox();
    test_pattern(SGT_PATTERN_GRID, 201, sgt_pupil_points(SGT_PATTERN_GRID, 201, 0, 0, NULL), 2e-3);
    test_pattern(SGT_PATTERN_HEXAPOLAR, 30, 1 + 3 * 30 * 31, 1e-3);
    test_pattern(SGT_PATTERN_SOBOL, 2000, 2000, 2e-3);
    test_pattern(SGT_PATTERN_RANDOM, 40000, 40000, 1e-2);
    test_alone();
    test_random();
    test_sobol();
    test_parts();
    test_columns();
    test_exact();
    printf("seed 1\n%d faults\n", faults);
    return faults > 0;
}
