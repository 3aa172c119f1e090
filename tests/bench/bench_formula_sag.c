// SPDX-License-Identifier: MIT
/* A sag as a formula beside the built-in type, in batches from the cache.
 *
 *     build/tests/bench/bench_formula_sag
 *
 * A thousand rays, up to 10 degrees off the axis, meet a sag within a rim of 4.  Told are ns a ray, the
 * medians of 41 turns, in the time of the processor that this thread has had: of the root near the seed, as a
 * lens asks for it, and of the first root.  unlike: rays whose roots differ by more than both errors.
 * "as odd" is the asphere beside the same one as the built-in odd_asphere: the even asphere has a solver of
 * its own, and the odd one, as a formula, has none. */
#include <sagitta/formula.h>
#include <sagitta/surfaces.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

enum { RAYS = 1000, TURNS = 41, CALLS = 20, ROOM = 1 << 16 };
static double o[3][RAYS], d[3][RAYS], number[2][8][RAYS];
static sgt_status status[2][RAYS];

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec * 1e9 + (double)t.tv_nsec;
}

static void launch(void)
{
    for (int i = 0; i < RAYS; i++) { /* a spiral of equal areas; the tilt turns on its own */
        const double r = 3.6 * sqrt((i + 0.5) / RAYS), turn = 2.399963229728653 * i;
        const double tilt = 0.17 * sin(0.7 * i);
        o[0][i] = r * cos(turn), o[1][i] = r * sin(turn), o[2][i] = 0;
        d[0][i] = sin(tilt) * cos(3.1 * i), d[1][i] = sin(tilt) * sin(3.1 * i), d[2][i] = cos(tilt);
        for (int k = 0; k < 3; k++) o[k][i] -= 5 * d[k][i];
    }
}

static double meet(sgt_surface s, sgt_pick pick, int to)
{
    const sgt_rays rays = {.o = {o[0], o[1], o[2]}, .d = {d[0], d[1], d[2]}};
    double(*n)[RAYS] = number[to];
    const sgt_hits hits = {.status = status[to], .t = n[0], .t_err = n[1], .p = {n[2], n[3], n[4]},
                           .n = {n[5], n[6], n[7]}};
    const sgt_options options = {.pick = pick};
    const double start = now();
    for (int i = 0; i < CALLS; i++) sgt_intersect_batch(s, RAYS, rays, hits, &options);
    return (now() - start) / CALLS / RAYS;
}

static int by_size(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static int unlike(void)
{
    int count = 0;
    for (int i = 0; i < RAYS; i++)
        count += !(status[0][i] == SGT_HIT && status[1][i] == SGT_HIT &&
                   fabs(number[0][0][i] - number[1][0][i]) <= number[0][1][i] + number[1][1][i]);
    return count;
}

/* builtin.ops NULL: there is none. */
static bool compare(const char *name, sgt_surface builtin, const char *text, size_t n, const sgt_named *named)
{
    static double room[ROOM / sizeof(double)];
    sgt_error error;
    const sgt_tape *tape = sgt_formula_read(text, SGT_FORMULA_XY, n, named, room, sizeof room, &error);
    if (!tape) return printf("%s: column %zu: %s\n", text, error.column, error.words), false;
    const sgt_formula_sag sag = {.tape = tape, .semi_diameter = 4};
    const sgt_surface formula = {&sgt_formula_sag_ops, &sag};
    double ns[4][TURNS];
    int wrong = 0;
    for (int i = 0; i < TURNS; i++)
        for (int k = 0; k < 2; k++) {
            const sgt_pick pick = k ? SGT_FIRST : SGT_NEAR_SEED;
            ns[k][i] = meet(formula, pick, 0);
            if (builtin.ops) ns[2 + k][i] = meet(builtin, pick, 1), wrong += unlike();
        }
    double median[4];
    for (int k = 0; k < (builtin.ops ? 4 : 2); k++) {
        qsort(ns[k], TURNS, sizeof(double), by_size);
        median[k] = ns[k][TURNS / 2];
    }
    if (builtin.ops)
        printf("%-8s %14.1f %14.1f %8.1f %14.1f %14.1f %8.1f %8d\n", name, median[0], median[2],
               median[0] / median[2], median[1], median[3], median[1] / median[3], wrong);
    else
        printf("%-8s %14.1f %14s %8s %14.1f\n", name, median[0], "-", "-", median[1]);
    return wrong == 0;
}

int main(void)
{
    launch();
    const sgt_conic conic = {.c = 0.1, .k = -0.6, .semi_diameter = 4};
    const sgt_even_asphere asphere = {.c = 0.1, .k = -0.6, .semi_diameter = 4, .a = {0, 1e-4, -2e-6, 1e-8}};
    const sgt_named named[] = {{"c", 0.1}, {"k", -0.6}, {"a", 1e-4}, {"b", -2e-6}, {"g", 1e-8}};
    const sgt_named twist[] = {{"c", 0.1}, {"k", -0.6}, {"a", 1e-4}};
    printf("%-8s %14s %14s %8s %14s %14s %8s %8s\n", "ns a ray", "near, formula", "built-in", "times",
           "first, formula", "built-in", "times", "unlike");
    bool good = compare("conic", (sgt_surface){&sgt_conic_ops, &conic},
                        "c*r^2/(1 + sqrt(1 - (1 + k)*c^2*r^2))", 2, named);
    good &= compare("asphere", (sgt_surface){&sgt_even_asphere_ops, &asphere},
                    "c*r^2/(1 + sqrt(1 - (1 + k)*c^2*r^2)) + a*r^4 + b*r^6 + g*r^8", 5, named);
    const sgt_odd_asphere odd = {.c = 0.1, .k = -0.6, .semi_diameter = 4,
                                 .a = {0, 0, 0, 1e-4, 0, -2e-6, 0, 1e-8}};
    good &= compare("as odd", (sgt_surface){&sgt_odd_asphere_ops, &odd},
                    "c*r^2/(1 + sqrt(1 - (1 + k)*c^2*r^2)) + a*r^4 + b*r^6 + g*r^8", 5, named);
    good &= compare("trefoil", (sgt_surface){NULL, NULL},
                    "c*r^2/(1 + sqrt(1 - (1 + k)*c^2*r^2)) + a*r^3*cos(3*atan2(y, x))", 3, twist);
    return good ? 0 : 1;
}
