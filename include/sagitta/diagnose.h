// SPDX-License-Identifier: MIT
/* diagnose.h - how did the solver converge, and why did it not?  Does a surface keep its
 * promises?
 *
 * Every function may run in any number of threads, each with a log of its own. */
#ifndef SAGITTA_DIAGNOSE_H
#define SAGITTA_DIAGNOSE_H
#include <sagitta/sagitta.h>
#ifdef __cplusplus
extern "C" {
#endif

/* ------------------------------------------------------------- how a ray was solved */

/* An array of the caller in which a watcher keeps steps. */
typedef struct sgt_log {
    sgt_step *step;
    int       cap;  /* how many steps there is room for */
    int       n;    /* how many steps there were, those beyond cap too (not kept) */
} sgt_log;

/* A watcher that keeps each step in the sgt_log that `log` points to.  Returns 0: it
 * never stops the search.  Example:
 *
 *     sgt_surface any = {NULL, NULL};
 *     sgt_ray ray = {.o = {0, 0, -5}, .d = {0, 0, 1}};
 *     sgt_step step[100];
 *     sgt_log log = {step, 100, 0};
 *     sgt_intersect(any, ray, &(sgt_options){.watch = sgt_log_step, .watch_data = &log});
 *     sgt_diagnosis d = sgt_diagnose(&log);
 */
SGT_API int sgt_log_step(void *log, const sgt_step *step);

typedef enum sgt_verdict {
    SGT_QUADRATIC,    /* as Newton should */
    SGT_LINEAR,       /* a constant factor a step: a double root, or a wrong slope */
    SGT_BISECTING,    /* the bracket did the work */
    SGT_OSCILLATING,  /* to and fro without closing in */
    SGT_WANDERING,    /* no pattern, or not enough of one */
    SGT_ROUNDING,     /* at the limit of rounding from the first evaluation on */
    SGT_LATE          /* as Newton should in the end, but three evaluations or more came
                         before that (sgt_diagnosis.before) */
} sgt_verdict;

typedef struct sgt_diagnosis {
    sgt_verdict verdict;
    double order, rate;  /* |e_{k+1}| ~ rate |e_k|^order over the last steps;
                            NaN: too few */
    double condition;    /* |dt| / |dF| at the root, 1/|slope|: how grazing, how flat */
    int newton, bisect, march, retreat;  /* how many evaluations were chosen so */
    int before;  /* At its end a search closes in: each step is at most half of the one
                    before.  `order` is that of these steps.  `before` counts the
                    evaluations of F, NaN or not, in front of them, without marches and
                    probes */
    unsigned long long reserved_[4];
} sgt_diagnosis;

/* Made from the steps kept in the log.  An empty log: SGT_WANDERING, NaN numbers. */
SGT_API sgt_diagnosis sgt_diagnose(const sgt_log *log);

/* One line that a person can act on. */
SGT_API const char *sgt_verdict_text(sgt_verdict v);

/* ------------------------------------------------- does a surface keep its promises? */

/* The first fault that sgt_check found.  SGT_SOUND: these rays showed none. */
typedef enum sgt_fault {
    SGT_SOUND,
    SGT_WRONG_GRADIENT,
    SGT_WRONG_SPAN,
    SGT_WRONG_ROUNDING,
    SGT_NO_VALUE,  /* no `value`, a table of operations that is too short, or a built-in
                      surface with an invalid parameter */
    SGT_WRONG_VALUES,
    SGT_WRONG_SPANS,
    SGT_WRONG_CLEARANCE,
    SGT_WRONG_ENCLOSURE,
    SGT_WRONG_FIRST,
    SGT_WRONG_FIRSTS,
    SGT_WRONG_ENCLOSURES, /* of `encloses`; from version 0.3 on */
    SGT_WRONG_ARITHMETIC  /* not the surface's: see sgt_arithmetic.  Nothing was tried. */
} sgt_fault;

/* Walks n rays and tries to catch the surface breaking a promise of sgt_surface_ops.  The
 * ends of a ray should be finite: an infinite one is cut at the span's, or at 1000
 * lengths.
 *
 *     operation   what is checked
 *     value       the gradient agrees with differences of F
 *     span        samples show no change of sign outside it, and never two inside a
 *                 span that is `single`
 *     rounding    it is finite and not negative where F is defined
 *     enclose     over stretches of many widths it contains what samples show of F and
 *                 its slope; it is empty only where F is nowhere defined; where the slope
 *                 has two finite ends, F does not jump between its samples
 *     encloses    the same, and it says the same of a cell, to the last bit, among others
 *                 and alone, with slopes and without, and writes no more than asked for
 *     clearance   within it F does not change sign, about points of the rays, in some
 *                 directions
 *     values,     they give what `value` and `span` give, to the last bit (a NaN for a
 *     spans       NaN), with and without gradients, and write no more than asked for
 *     first       if it is single, no accepted root lies before its stretch, nor two in
 *                 it; and if it holds none, none lies behind it
 *     firsts      they give what `first` gives, as `spans` does of `span`
 *
 * Not checked: estimate, second, parameters, by_parameter, and whether `rounding` is as
 * large as it has to be.
 *
 * Returns the first fault found.  If `where` is not NULL, *where is set to a point that
 * shows the fault; for SGT_WRONG_SPANS to the origin of the ray; to NaN if none is
 * found. */
SGT_API sgt_fault sgt_check(sgt_surface s, size_t n, const sgt_ray rays[],
                            sgt_vec3 *where);

/* One line that names the fault. */
SGT_API const char *sgt_fault_text(sgt_fault fault);

#ifdef __cplusplus
}
#endif
#endif
