/* patterns.c - points in a pupil.
 *
 * Philox against the published vectors (Salmon et al. 2011; Random123's known answers).  Each pattern: how
 * many points there are, all in the circle, weights that add up to 1, and the moments of a uniform circle,
 * 1/4 of x^2 and of y^2, 1/8 of x^4, 0 of x, y and x y, within what the number of points allows.  A random
 * point depends on the seed and its number alone; the first points of a longer Sobol pattern are the
 * shorter one. */
#include "require.h"

#include <sagitta/lens.h>

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
    test_exact();
    printf("seed 1\n%d faults\n", faults);
    return faults > 0;
}
