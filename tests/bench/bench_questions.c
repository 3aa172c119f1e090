// SPDX-License-Identifier: MIT
/* bench_questions.c - what is asked of many rays of a lens, beside their trace: one thread, in the cache.
 *
 *     build/tests/bench/bench_questions LENS [RUNS]
 *
 * Prints a line for each: a name, nanoseconds a ray (of the processor, the median of RUNS alternated runs),
 * and how many elements the lens has.
 * tests/bench/rays_and_questions.py makes a table of them. */
#include <sagitta/aim.h>
#include <sagitta/analysis.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { RAYS = 1024, TIMES = 40, RUNS = 15, RUNS_MOST = 1000, QUESTIONS = 6 };

typedef struct asked {
    const sgt_lens *lens;
    sgt_rays rays;
    sgt_passages *all, *last;           /* with everything; the last point alone */
    sgt_passages *path;                 /* the last point, and the path there */
    sgt_end_errors errors;
    sgt_ray_changes change[2], end[2], weight;
    double **gradient;
} asked;

static double *numbers(size_t n)
{
    double *x = calloc(n, sizeof *x);
    if (!x) exit(2);
    return x;
}

static sgt_passages *passages(size_t elements)
{
    sgt_passages *p = calloc(elements, sizeof *p);
    if (!p) exit(2);
    return p;
}

static void point(sgt_passages *p)
{
    for (int k = 0; k < 3; k++) p->hits.p[k] = numbers(RAYS);
}

static void trace(const asked *a, const sgt_passages *p)
{
    sgt_fate fate[RAYS];
    sgt_trace_batch(a->lens->count, a->lens->element, a->lens->index_before, RAYS, a->rays,
                    (sgt_traced){.fate = fate}, p, NULL);
}

static void ask(const asked *a, int question)
{
    const sgt_lens *l = a->lens;
    const sgt_traces traces = {RAYS, a->rays, a->all};
    switch (question) {
    case 0: trace(a, a->last); return;
    case 1: trace(a, a->path); return;
    case 2: trace(a, a->all); return;
    case 3: sgt_trace_error_batch(l->count, l->element, l->index_before, &traces, a->errors); return;
    case 4:
        sgt_trace_sensitivity_batch(l->count, l->element, l->index_before, &traces, 2, a->change, a->end);
        return;
    default:
        sgt_trace_gradient_batch(l->count, l->element, l->index_before, &traces, 1, &a->weight, a->gradient);
    }
}

static void launch(const sgt_lens *lens, double *const o[3], double *const d[3])
{
    static sgt_pupil_point at[RAYS];
    static sgt_launched out[RAYS];
    const sgt_lens_field axis = {.weight = 1};
    sgt_field_beam beam;
    sgt_launcher *from = sgt_launcher_new(lens, NULL, NULL);
    if (!from || !sgt_launch_field(from, SGT_FIELD_ANGLE, &axis, &beam, NULL)) exit(1);
    sgt_pupil_points(SGT_PATTERN_SOBOL, RAYS, 1, RAYS, at);
    sgt_launch_rays(from, &beam, lens->element, lens->index_before, RAYS, at, out, NULL);
    for (size_t i = 0; i < RAYS; i++) {
        o[0][i] = out[i].ray.o.x, o[1][i] = out[i].ray.o.y, o[2][i] = out[i].ray.o.z;
        d[0][i] = out[i].ray.d.x, d[1][i] = out[i].ray.d.y, d[2][i] = out[i].ray.d.z;
    }
    sgt_launcher_free(from);
}

static asked question_of(const sgt_lens *l)
{
    asked a = {.lens = l, .all = passages(l->count), .last = passages(l->count), .path = passages(l->count)};
    double *o[3], *d[3];
    for (int k = 0; k < 3; k++) a.rays.o[k] = o[k] = numbers(RAYS), a.rays.d[k] = d[k] = numbers(RAYS);
    launch(l, o, d);
    for (size_t i = 0; i < l->count; i++) {
        sgt_passages *p = &a.all[i];
        point(p);
        for (int k = 0; k < 3; k++) p->hits.n[k] = numbers(RAYS), p->direction[k] = numbers(RAYS);
        p->hits.status = calloc(RAYS, 1), p->hits.t = numbers(RAYS), p->hits.p_err = numbers(RAYS);
        p->opl = numbers(RAYS);
    }
    point(&a.last[l->count - 1]), point(&a.path[l->count - 1]);
    a.path[l->count - 1].opl = numbers(RAYS);
    a.errors = (sgt_end_errors){.point = numbers(RAYS), .path = numbers(RAYS), .grain = numbers(RAYS)};
    for (int c = 0; c < 2; c++)
        for (int k = 0; k < 3; k++) {
            a.change[c].p[k] = numbers(RAYS), a.change[c].d[k] = numbers(RAYS), a.end[c].p[k] = numbers(RAYS);
            for (size_t i = 0; i < RAYS; i++) a.change[c].p[k][i] = k == c;
        }
    for (int k = 0; k < 3; k++) {
        a.weight.p[k] = numbers(RAYS), a.weight.d[k] = numbers(RAYS);
        for (size_t i = 0; i < RAYS; i++) a.weight.p[k][i] = k == 0;
    }
    const size_t parameters = sgt_trace_parameters(l->count, l->element);
    a.gradient = calloc(parameters, sizeof *a.gradient);
    for (size_t i = 0; i < parameters; i++) a.gradient[i] = numbers(RAYS);
    trace(&a, a.all);
    return a;
}

static double now(void) { return 1e9 * (double)clock() / CLOCKS_PER_SEC; }

static int compare(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

int main(int argc, char *argv[])
{
    static const char *const name[QUESTIONS] = {"trace", "trace and path", "all told", "errors",
                                                "derivatives", "gradient"};
    static double ns[QUESTIONS][RUNS_MOST];
    sgt_error error;
    sgt_lens *lens = argc > 1 ? sgt_lens_read(argv[1], NULL, &error) : NULL;
    const int runs = argc > 2 ? atoi(argv[2]) : RUNS;
    if (!lens || runs < 1 || runs > RUNS_MOST) return fprintf(stderr, "bench_questions LENS [RUNS]\n"), 2;
    const asked a = question_of(lens);
    for (int run = 0; run < runs; run++)
        for (int q = 0; q < QUESTIONS; q++) {
            const double begin = now();
            for (int i = 0; i < TIMES; i++) ask(&a, q);
            ns[q][run] = (now() - begin) / ((double)TIMES * RAYS);
        }
    for (int q = 0; q < QUESTIONS; q++) {
        qsort(ns[q], (size_t)runs, sizeof(double), compare);
        printf("%s,%.2f,%zu\n", name[q], ns[q][runs / 2], lens->count);
    }
    sgt_lens_free(lens);
}
