// SPDX-License-Identifier: MIT
/* bench_rows.c - what `sagitta trace LENS --random N --field 0` does without its output: launches N rays
 * through the lens and traces them in batches, in threads.
 *
 *     build/tests/bench/bench_rows LENS N THREADS
 *
 * Prints seconds of the trace alone, and of launching, and how many rays passed.  docs/rows_table.py
 * compares. */
#include <sagitta/analysis.h>

#include <stdio.h>
#include <stdlib.h>
#include <time.h>

enum { RAYS = 256, NUMBERS = 9 };

static double seconds(void)
{
    struct timespec t;
    timespec_get(&t, TIME_UTC);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static double *column(size_t n) { return malloc((n ? n : 1) * sizeof(double)); }

/* The answers at each element, as the command asks for them. */
static sgt_passages *answers(size_t elements)
{
    sgt_passages *p = malloc(elements * sizeof *p);
    for (size_t i = 0; i < elements; i++) {
        double *n = column(NUMBERS * RAYS);
        p[i] = (sgt_passages){.hits = {.status = malloc(RAYS), .evals = malloc(RAYS * sizeof(int)),
                                       .p = {n, n + RAYS, n + 2 * RAYS}, .t = n + 6 * RAYS,
                                       .t_err = n + 7 * RAYS},
                              .direction = {n + 3 * RAYS, n + 4 * RAYS, n + 5 * RAYS},
                              .opl = n + 8 * RAYS};
    }
    return p;
}

/* Traces rays[first ...]; returns how many passed. */
static size_t trace(const sgt_lens *lens, double *const ray[6], size_t first, size_t count, sgt_passages *out)
{
    double end[6][RAYS];
    sgt_fate fate[RAYS];
    int passed[RAYS];
    size_t through = 0;
    const sgt_rays in = {.o = {ray[0] + first, ray[1] + first, ray[2] + first},
                         .d = {ray[3] + first, ray[4] + first, ray[5] + first}};
    const sgt_traced to = {.fate = fate, .passed = passed, .o = {end[0], end[1], end[2]},
                           .d = {end[3], end[4], end[5]}};
    sgt_trace_batch(lens->count, lens->element, lens->index_before, count, in, to, out, NULL);
    for (size_t i = 0; i < count; i++) through += fate[i] == SGT_PASSED;
    return through;
}

static void launch(const sgt_lens *lens, size_t n, double *const ray[6])
{
    const sgt_lens_field axis = {.weight = 1};
    sgt_field_beam beam;
    sgt_launcher *from = sgt_launcher_new(lens, NULL, NULL);
    sgt_pupil_point *at = malloc(n * sizeof *at);
    sgt_launched *out = malloc(n * sizeof *out);
    if (!from || !at || !out || !sgt_launch_field(from, SGT_FIELD_ANGLE, &axis, &beam, NULL)) exit(1);
    sgt_pupil_points(SGT_PATTERN_RANDOM, n, 1, n, at);
    sgt_launch_rays(from, &beam, lens->element, lens->index_before, n, at, out, NULL);
    for (size_t i = 0; i < n; i++) {
        const sgt_ray *r = &out[i].ray;
        const double number[] = {r->o.x, r->o.y, r->o.z, r->d.x, r->d.y, r->d.z};
        for (int k = 0; k < 6; k++) ray[k][i] = number[k];
    }
    free(at), free(out);
    sgt_launcher_free(from);
}

int main(int argc, char *argv[])
{
    sgt_error error;
    sgt_lens *lens = argc == 4 ? sgt_lens_read(argv[1], NULL, &error) : NULL;
    if (!lens) return fprintf(stderr, "bench_rows LENS N THREADS\n"), 2;
    const size_t n = strtoul(argv[2], NULL, 10);
    const int threads = atoi(argv[3]);
    double *ray[6], begin = seconds();
    for (int k = 0; k < 6; k++) ray[k] = column(n);
    launch(lens, n, ray);
    const double launched = seconds();
    size_t through = 0;
    (void)threads; /* unused without OpenMP */
#ifdef _OPENMP
#pragma omp parallel num_threads(threads) reduction(+ : through)
#endif
    {
        sgt_passages *out = answers(lens->count);
#ifdef _OPENMP
#pragma omp for schedule(dynamic)
#endif
        for (size_t tile = 0; tile < n / RAYS + (n % RAYS > 0); tile++)
            through += trace(lens, ray, tile * RAYS, n - tile * RAYS < RAYS ? n - tile * RAYS : RAYS, out);
    }
    printf("%.6f %.6f %zu\n", seconds() - launched, launched - begin, through);
    sgt_lens_free(lens);
    return 0;
}
