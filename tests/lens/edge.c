// SPDX-License-Identifier: MIT
/* edge.c - the areas of a box on either side of random curves (src/lens/prove/edge.h), against integrals over
 * many lines of it.  On each line of `y` the other side is found by bisection, so these are right to 1e-7 of
 * the box.  No area may be larger than it is; and what is left open is small. */
#include "../../src/lens/prove/edge.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

static uint64_t state = 1;

static double uniform(double a, double b)
{
    state = state * 6364136223846793005u + 1442695040888963407u;
    return a + (b - a) * (double)(state >> 11) * 0x1p-53;
}

static double value(const sgt_series *g, double s, double t)
{
    double sum = 0;
    for (int i = SGT_SERIES_ORDER; i >= 0; i--) {
        double row = 0;
        for (int j = SGT_SERIES_ORDER - i; j >= 0; j--) row = row * t + g->k[SGT_SERIES_PLACE(i, j)];
        sum = sum * s + row;
    }
    return sum;
}

/* A curve through or beside the box, steeper in s or in t. */
static sgt_series random_curve(int main_of, double sign)
{
    sgt_series g = {.rest = 0};
    const double bent = uniform(0, 1) < 0.3 ? 0 : uniform(0, 0.4), steep = sign * uniform(0.8, 1.3);
    for (int i = 0; i <= 3; i++)
        for (int j = 0; i + j <= 3; j++)
            g.k[SGT_SERIES_PLACE(i, j)] = uniform(-1, 1) * bent / (1 + i + j) / 4;
    g.k[0] = uniform(-1, 1) * (uniform(0, 1) < 0.5 ? 0.3 : 1.2);
    g.k[main_of ? SGT_SERIES_PLACE(0, 1) : SGT_SERIES_PLACE(1, 0)] = steep;
    g.k[main_of ? SGT_SERIES_PLACE(1, 0) : SGT_SERIES_PLACE(0, 1)] = uniform(-0.5, 0.5);
    return g;
}

static double part_below(double x, double w) { return 0.5 * (x + 1) + 0.25 * w * (x * x - 1); }

/* Up to where g has the sign that it has at x = -1, along x. */
static double crossing(const sgt_series *g, int main_of, double y)
{
    double low = -1, high = 1;
    const double first = main_of ? value(g, y, -1) : value(g, -1, y),
                 last = main_of ? value(g, y, 1) : value(g, 1, y);
    if ((first < 0) == (last < 0))
        return (first < 0) == (main_of ? g->k[SGT_SERIES_PLACE(0, 1)] > 0 : g->k[SGT_SERIES_PLACE(1, 0)] > 0)
                   ? 1
                   : -1;
    for (int k = 0; k < 48; k++) {
        const double x = (low + high) / 2, v = main_of ? value(g, y, x) : value(g, x, y);
        *((v < 0) == (first < 0) ? &low : &high) = x;
    }
    return (low + high) / 2;
}

int main(void)
{
    enum { CASES = 300, LINES = 600 };
    const char *seed = getenv("SAGITTA_TEST_SEED");
    int faults = 0;
    double open = 0, widest = 0;
    state = seed ? strtoull(seed, NULL, 0) : 1;
    printf("SAGITTA_TEST_SEED=%llu\n", (unsigned long long)state);
    for (int k = 0; k < 10; k++) uniform(0, 1);
    for (int n = 0; n < CASES; n++) {
        const double r0 = uniform(0, 1) < 0.3 ? 0 : uniform(0, 0.9);
        const sector of = {r0, r0 + uniform(0.01, 0.1), 0.25, 0.25 + uniform(0.01, 0.2)};
        const double w = (of.r1 - of.r0) / (of.r1 + of.r0), area = sgt_sector_area(&of);
        const int main_of = uniform(0, 1) < 0.5, count = uniform(0, 1) < 0.5 ? 1 : 2;
        const sgt_series g[2] = {random_curve(main_of, uniform(0, 1) < 0.5 ? -1 : 1),
                                 random_curve(main_of, uniform(0, 1) < 0.5 ? -1 : 1)};
        const double slack[2] = {0, 0};
        double in, out, inside = 0;
        sgt_edge_parts(&of, (size_t)count, g, slack, &in, &out);
        for (int i = 0; i < LINES; i++) {
            const double y = -1 + 2 * (i + 0.5) / LINES;
            double from = -1, to = 1;
            for (int k = 0; k < count; k++) {
                const double x = crossing(&g[k], main_of, y);
                const bool up = g[k].k[main_of ? SGT_SERIES_PLACE(0, 1) : SGT_SERIES_PLACE(1, 0)] > 0;
                if (up)
                    to = fmin(to, x);
                else
                    from = fmax(from, x);
            }
            if (!(to > from)) continue;
            inside += main_of ? (to - from) / 2 * (1 + w * y) / LINES
                              : (part_below(to, w) - part_below(from, w)) / LINES;
        }
        in /= area, out /= area;
        if (in > inside + 2e-6 || out > 1 - inside + 2e-6 || !(in >= 0 && out >= 0)) {
            if (faults++ < 10)
                printf("case %d, %d curves, %d: in %.9f, out %.9f, of %.9f\n", n, count, main_of, in, out,
                       inside);
        }
        open += 1 - in - out;
        if (count == 1) widest = fmax(widest, in + out > 0 ? 1 - in - out : 0);
    }
    printf("open: %.4f of the boxes, %.4f at most with one curve; %d faults\n", open / CASES, widest, faults);
    if (open / CASES > 0.1) faults++, printf("that is too much\n");
    return faults > 0;
}
