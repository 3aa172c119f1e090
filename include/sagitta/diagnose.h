/* diagnose.h - how did the solver converge, and why did it not? */
#ifndef SAGITTA_DIAGNOSE_H
#define SAGITTA_DIAGNOSE_H
#include <sagitta/sagitta.h>
#ifdef __cplusplus
extern "C" {
#endif

/* A watcher that keeps steps in the caller's array:
 *     sgt_step step[100];
 *     sgt_log log = { step, 100, 0 };
 *     sgt_intersect(s, ray, &(sgt_options){ .watch = sgt_log_step, .watch_data = &log });
 *     sgt_diagnosis d = sgt_diagnose(&log);
 * n counts every step, those beyond cap too (they are not kept). */
typedef struct sgt_log { sgt_step *step; int cap, n; } sgt_log;
SGT_API int sgt_log_step(void *log, const sgt_step *step);  /* returns 0: never stops */

typedef enum sgt_verdict {
    SGT_QUADRATIC,    /* as Newton should */
    SGT_LINEAR,       /* a constant factor a step: a double root, or a slope that is off */
    SGT_BISECTING,    /* the bracket did the work */
    SGT_OSCILLATING,  /* to and fro without closing in */
    SGT_WANDERING,    /* no pattern, or not enough of one */
    SGT_ROUNDING      /* at the limit of rounding from the first evaluation on */
} sgt_verdict;

typedef struct sgt_diagnosis {
    sgt_verdict verdict;
    double order, rate;     /* |e_{k+1}| ~ rate |e_k|^order over the last steps; NaN: too few */
    double condition;       /* |dt| / |dF| at the root, 1/|slope|: how grazing, how flat */
    int newton, bisect, march, retreat;  /* how many evaluations were chosen so */
} sgt_diagnosis;

/* From the steps kept in the log; an empty log is WANDERING with NaN numbers. */
SGT_API sgt_diagnosis sgt_diagnose(const sgt_log *log);
SGT_API const char   *sgt_verdict_text(sgt_verdict v);  /* one line a person can act on */

/* Does a surface keep its word?  Walks the given rays (finite ends; an infinite
 * one is cut at the span's, or at 1000 lengths) and compares the gradient with
 * differences, and the span with the changes of sign that samples show: none may
 * lie outside it, nor two inside one that is `single`.  `rounding` must be finite
 * and not negative where F is defined.  Over stretches of many widths `enclose` must
 * hold what samples show of F and its slope, and be empty only where F is nowhere defined; a
 * slope with two finite ends promises that F is defined and differentiable there, or at
 * least does not jump.  Within its `clearance` of points of the rays F may not change its
 * sign, in some directions.  `values` and `spans` must give what `value`
 * and `span` give, to the last bit (a NaN for a NaN), with or without gradients, and
 * write no more than they are asked for.  Where `first` is single no root that counts may lie before its stretch, nor two
 * in it, nor one behind it and none in it; `firsts` is to it what `spans` is to span.  Returns the first fault found; *where (may
 * be NULL) is then a point that shows it; of WRONG_SPANS it is the ray's origin. */
typedef enum sgt_fault {
    SGT_SOUND, SGT_WRONG_GRADIENT, SGT_WRONG_SPAN, SGT_WRONG_ROUNDING, SGT_NO_VALUE, SGT_WRONG_VALUES, SGT_WRONG_SPANS,
    SGT_WRONG_CLEARANCE, SGT_WRONG_ENCLOSURE, SGT_WRONG_FIRST, SGT_WRONG_FIRSTS
} sgt_fault;
SGT_API sgt_fault sgt_check(sgt_surface s, size_t n, const sgt_ray rays[], sgt_vec3 *where);
SGT_API const char *sgt_fault_text(sgt_fault fault);

#ifdef __cplusplus
}
#endif
#endif
