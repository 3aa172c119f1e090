// SPDX-License-Identifier: MIT
/* wide.c - numbers of many parameters (src/lens/prove/wide.h): what they stand for is inside, at random
 * parameters and their ends, in 64 bits of precision or more; and rays that sgt_trace takes through an
 * element are inside what sgt_wide_through says of all of them. */
#include "../../src/lens/prove/wide.h"

#include <sagitta/surfaces.h>

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static uint64_t state = 1;
static int faults;

static double uniform(void)
{
    state = state * 6364136223846793005u + 1442695040888963407u;
    return (double)(state >> 11) * 0x1p-52 - 1;
}

static double at_ends(void)
{
    const double x = uniform();
    return x < -0.4 ? -1 : x > 0.4 ? 1 : uniform();
}

static wide random_wide(double c, double spread, int n)
{
    wide x = {.c = c};
    for (int i = 0; i < n; i++) x.by[i] = spread * uniform() / n;
    x.rest = uniform() < 0 ? 0 : spread / 10;
    return x;
}

static long double value_of(const wide *x, const double s[], double of_rest)
{
    long double sum = x->c + (long double)of_rest * x->rest;
    for (int i = 0; i < WIDE; i++) sum += (long double)x->by[i] * s[i];
    return sum;
}

static void inside(const wide *x, const double s[], long double value, double slack, const char *what)
{
    const long double off = fabsl(value - value_of(x, s, 0));
    if (off <= x->rest + (long double)slack) return;
    if (faults++ < 10) printf("%s: off by %Lg, rest %g\n", what, off, x->rest);
}

static void try_operations(void)
{
    const int n = uniform() < 0 ? 1 : 4;
    const wide x = random_wide(uniform() * 3, fabs(uniform()), n), y = random_wide(2 + uniform(), 0.9, n);
    double s[WIDE] = {0};
    for (int i = 0; i < n; i++) s[i] = at_ends();
    const double rx = at_ends(), ry = at_ends();
    const long double a = value_of(&x, s, rx), b = value_of(&y, s, ry);
    wide out, other;
    sgt_wide_product(&x, &y, &out), inside(&out, s, a * b, 0, "product");
    sgt_wide_product(&y, &y, &out), inside(&out, s, b * b, 0, "square");
    sgt_wide_inverse(&y, &out), inside(&out, s, 1 / b, 0, "inverse");
    sgt_wide_added(&x, 0.3, &y, &out), inside(&out, s, a + 0.3 * b, 1e-18, "sum");
    sgt_wide_scaled(&x, -1.7, &out), inside(&out, s, -1.7 * a, 1e-18, "scaled");
    sgt_wide_turn(&x, &out, &other), inside(&out, s, cosl(a), 0, "cosine"),
        inside(&other, s, sinl(a), 0, "sine");
}

/* A conic or a mirror, by one parameter alone: there the second order is exactly known, and the third shows.
 */
static void try_element(void)
{
    const sgt_conic sphere = {.c = uniform() / 30, .k = uniform(), .semi_diameter = 0};
    const bool mirror = uniform() > 0.5;
    const sgt_element e = {
        .surface = {&sgt_conic_ops, &sphere}, .semi_diameter = 12, .index = mirror ? SGT_MIRROR : 1.6};
    const wide before = {.c = 1}, behind = {.c = mirror ? 1 : 1.6, .by = {0, 0.05}};
    const double size[] = {1.5, 1.5, 0.1, 0.1};
    double s[WIDE] = {0};
    wide_line line = {.ahead = 1};
    wide *const part[] = {&line.x, &line.y, &line.u, &line.v};
    const int n = uniform() < 0 ? 1 : 2;
    for (int k = 0; k < 4; k++)
        *part[k] = random_wide(uniform() * (k < 2 ? 6 : 0.2), size[k], 1), part[k]->rest = 0;
    const wide_element of = {.e = &e, .before = &before, .behind = n == 1 || mirror ? &before : &behind};
    s[0] = at_ends(), s[1] = n == 1 ? 0 : at_ends();
    sgt_ray ray = {.o = {(double)value_of(&line.x, s, 0), (double)value_of(&line.y, s, 0), 0},
                         .d = {(double)value_of(&line.u, s, 0), (double)value_of(&line.v, s, 0), 1},
                         .tmin = -HUGE_VAL,
                         .tmax = HUGE_VAL};
    sgt_element own = e;
    own.index = mirror ? SGT_MIRROR : (double)value_of(of.behind, s, 0);
    wide point[2];
    sgt_box_why why;
    sgt_passage p;
    sgt_fate fate;
    const wide_fate found = sgt_wide_through(&of, &line, point, &why);
    sgt_trace(1, &own, 1, &ray, &p, &fate, NULL);
    if (found == WIDE_UNKNOWN || found == WIDE_MAYBE) return;
    if ((found == WIDE_PASSED) != (fate == SGT_PASSED)) {
        if (faults++ < 10) printf("a ray has another fate\n");
        return;
    }
    if (found != WIDE_PASSED) return;
    const long double u = (long double)p.direction.x / p.direction.z,
                      v = (long double)p.direction.y / p.direction.z;
    inside(&point[0], s, p.hit.p.x, 1e-13, "x"), inside(&point[1], s, p.hit.p.y, 1e-13, "y");
    inside(&line.u, s, u, 1e-13, "u"), inside(&line.v, s, v, 1e-13, "v");
    inside(&line.x, s, p.hit.p.x - p.hit.p.z * u, 1e-13, "x at the vertex");
    inside(&line.y, s, p.hit.p.y - p.hit.p.z * v, 1e-13, "y at the vertex");
}

int main(void)
{
    const char *seed = getenv("SAGITTA_TEST_SEED"), *scale = getenv("SAGITTA_TEST_SCALE");
    const double count = 40000 * (scale ? strtod(scale, NULL) : 0.5);
    state = seed ? strtoull(seed, NULL, 10) : 1;
    printf("seed %llu\n", (unsigned long long)state);
    for (int i = 0; i < count; i++) try_operations(), try_element();
    printf("%d faults\n", faults);
    return faults > 0;
}
