// SPDX-License-Identifier: MIT
/* What an enclosure of a formula costs over one cell, value and slope along a ray, for four surfaces.
 *
 *     build/tests/bench/bench_formula_cells
 *
 * ns a cell, in the time of the processor that this thread has had, the best of nine runs: with 16 cells a
 * call in each set of instructions, with one cell a call in the last of them, and through interval.h. */
#include <sagitta/formula.h>

#include <stdio.h>
#include <stdlib.h>
#include <time.h>

typedef void encloses(const sgt_tape *tape, size_t n, sgt_rays rays, const double *t_lo, const double *t_hi,
                      double *g_lo, double *g_hi, double *slope_lo, double *slope_hi);
/* v4 has those of v3: narrow_files in src/meson.build. */
extern encloses sgt_formula_encloses_base, sgt_formula_encloses_v3;

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec * 1e9 + (double)t.tv_nsec;
}

enum { CELLS = 16, ROUNDS = 2000, RUNS = 9 };
static double o[3][CELLS], d[3][CELLS], lo[CELLS], hi[CELLS], answers[4][CELLS], sum;

static void place(int round)
{
    static const double from[] = {1.2, 0.9, -3.2}, along[] = {-0.3, -0.25, 0.9};
    for (int i = 0; i < CELLS; i++) {
        for (int k = 0; k < 3; k++) o[k][i] = from[k], d[k][i] = along[k];
        lo[i] = round * 1e-3 + i * 0.01, hi[i] = lo[i] + 0.01;
    }
}

/* f NULL: the surface's own `enclose`. */
static double cost(encloses *f, const sgt_tape *tape, size_t n, bool slopes)
{
    sgt_rays rays = {.o = {o[0], o[1], o[2]}, .d = {d[0], d[1], d[2]}};
    sgt_formula surface = {.tape = tape};
    double best = 1e18;
    for (int run = 0; run < RUNS; run++) {
        double begin = now();
        for (int i = 0; i < ROUNDS; i++) {
            place(i);
            if (f) {
                f(tape, n, rays, lo, hi, answers[0], answers[1], slopes ? answers[2] : NULL,
                  slopes ? answers[3] : NULL);
            } else {
                sgt_interval slope;
                sgt_ray ray = {{o[0][0], o[1][0], o[2][0]}, {d[0][0], d[1][0], d[2][0]}, 0, 1};
                sgt_interval t = {lo[0], hi[0]};
                answers[0][0] = sgt_formula_ops.enclose(&surface, &ray, t, &slope).lo;
            }
            sum += answers[0][0];
        }
        double ns = (now() - begin) / ROUNDS / (double)n;
        best = ns < best ? ns : best;
    }
    return best;
}

int main(void)
{
    static const char *const surfaces[][2] = {
        {"Barth", "4*((2.618033988749895*x^2-y^2)*(2.618033988749895*y^2-z^2)*(2.618033988749895*z^2-x^2))"
                  "-4.23606797749979*(x^2+y^2+z^2-1)^2"},
        {"Clebsch", "81*(x^3+y^3+z^3)-189*(x^2*(y+z)+y^2*(x+z)+z^2*(x+y))+54*(x*y*z)+126*(x*y+x*z+y*z)"
                    "-9*(x^2+y^2+z^2)-9*(x+y+z)+1"},
        {"Chmutov 8", "2*(2*(2*x^2-1)^2-1)^2+2*(2*(2*y^2-1)^2-1)^2+2*(2*(2*z^2-1)^2-1)^2-2"},
        {"gyroid", "sin(6*x)*cos(6*y)+sin(6*y)*cos(6*z)+sin(6*z)*cos(6*x)"},
    };
    static encloses *const sets[] = {sgt_formula_encloses_base,
#if SETS > 1
                                     sgt_formula_encloses_v3
#endif
    };
    printf("ns a cell   value: base, v3         with the slope: base, v3        one by one   interval.h\n");
    for (size_t k = 0; k < sizeof surfaces / sizeof *surfaces; k++) {
        size_t size = sgt_formula_room(surfaces[k][1], 0);
        void *room = malloc(size);
        if (!room) return 1;
        sgt_tape *tape = sgt_formula_read(surfaces[k][1], SGT_FORMULA_XYZ, 0, NULL, room, size, NULL);
        if (!tape) return 1;
        int most = 1; /* sets that this processor has */
#if SETS > 1
        if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) most = 2;
#endif
        printf("%-9s", surfaces[k][0]);
        for (int slopes = 0; slopes < 2; slopes++) {
            printf("   ");
            for (int set = 0; set < most; set++) printf(" %6.1f", cost(sets[set], tape, CELLS, slopes));
        }
        printf("   %8.0f   %8.0f\n", cost(sets[most - 1], tape, 1, true), cost(NULL, tape, 1, true));
        free(room);
    }
    return sum == 1; /* so that nothing is left out */
}
