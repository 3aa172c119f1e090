// SPDX-License-Identifier: MIT
/* unguarded.h - methods by themselves, to compare with what the library does: Newton's and bisection without
 * safeguards, the march of old ray tracers, and the library's Newton in a bracket from a given start. */
#ifndef TRUTH_UNGUARDED_H
#define TRUTH_UNGUARDED_H
#include <sagitta/sagitta.h>

typedef enum unguarded_method {
    UNGUARDED_NEWTON,     /* Newton's steps only; where F is NaN, t is halved */
    UNGUARDED_NORMALISED, /* the same with the gradient scaled to unit length */
    UNGUARDED_BISECTION,
    UNGUARDED_MARCH /* steps, each the greatest of an estimate, Newton's step and dt; then halving */
} unguarded_method;

/* How a method ended. */
typedef struct unguarded {
    bool settled;           /* the next step would not change t */
    double t;               /* where it ended */
    const char *stopped;    /* why, if it did not settle */
} unguarded;

/* Runs a method; opt->watch is told each evaluation, and opt->max_evals are the most.  t is in lengths of the
 * ray's direction.  Newton's method begins at `start`; NaN: where the surface suggests.  A step of opt->t_tol
 * or less, or half a bracket, is an end, too.  opt->dt_min is the dt of the march; 0: 1/64 of the span.  If
 * the span is infinite, bisection and march use the part inside the clear aperture (semi_diameter, a length;
 * 0: none). */
unguarded unguarded_run(unguarded_method m, sgt_surface s, double semi_diameter, const sgt_ray *ray,
                        double start, const sgt_options *opt);

/* The library's Newton in a bracket (sgt_root) on F along the ray: from `start` (NaN: the middle), between
 * tmin and tmax.  A change of sign at which |F| is larger than elsewhere, a pole, is no root: unproven.  Of
 * the hit only status, t, t_err, lo, hi, f and evals are set. */
sgt_hit in_bracket(sgt_surface s, const sgt_ray *ray, double start, const sgt_options *opt);

/* What keeps a method from ending, as its n evaluations show. */
typedef enum unguarded_fault {
    UNGUARDED_NO_FAULT,
    UNGUARDED_BACKS_OFF,  /* halving t leads from NaN to NaN: the last three evaluations, or all */
    UNGUARDED_GOES_ROUND, /* Newton's steps lead to a NaN, and halving back: the last six or more */
    UNGUARDED_WALKS, /* the last eight steps, Newton's, go the same way, each 0.98 of the one before or longer
                      */
    UNGUARDED_FLICKERS /* the last eight steps, Newton's, are of a few ulps, and none is short enough to end
                          on */
} unguarded_fault;
unguarded_fault unguarded_fault_of(size_t n, const sgt_step step[]);

/* What a Newton step leaves of the one before: the geometric mean; NaN: too few. */
double unguarded_factor(size_t n, const sgt_step step[]);

#endif
