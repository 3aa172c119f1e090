/* unguarded.h - Newton's method and bisection without safeguards, to compare with what the library does. */
#ifndef TRUTH_UNGUARDED_H
#define TRUTH_UNGUARDED_H
#include <sagitta/sagitta.h>

typedef enum unguarded_method {
    UNGUARDED_NEWTON,       /* Newton's steps only; where F is NaN, t is halved */
    UNGUARDED_NORMALISED,   /* the same with the gradient scaled to unit length */
    UNGUARDED_BISECTION
} unguarded_method;

/* How a method ended. */
typedef struct unguarded {
    bool settled;           /* the next step would not change t */
    double t;               /* where it ended */
    const char *stopped;    /* why, if it did not settle */
} unguarded;

/* Runs a method; opt->watch is told each evaluation, and opt->max_evals are the most.  t is in lengths of the
 * ray's direction.  If the span is infinite, bisection uses the part inside the clear aperture
 * (semi_diameter, a length; 0: none). */
unguarded unguarded_run(unguarded_method m, sgt_surface s, double semi_diameter, const sgt_ray *ray,
                        const sgt_options *opt);

#endif
