/* methods.h - records the library's evaluations, and runs the bare methods to compare them with. */
#ifndef TOOL_METHODS_H
#define TOOL_METHODS_H
#include <sagitta/diagnose.h>

typedef enum method {
    METHOD_SAFEGUARDED,   /* what the library does */
    METHOD_NEWTON,        /* Newton's steps only; where F is NaN, t is halved */
    METHOD_NORMALISED,    /* the same with the gradient scaled to unit length */
    METHOD_BISECTION
} method;

/* The evaluations a method made, and how it ended. */
typedef struct record {
    sgt_step *step;
    size_t count, capacity;
    bool settled;         /* of a bare method: the next step would not change t */
    double t;             /* where it ended */
    const char *stopped;  /* why, if it did not settle */
} record;

/* An sgt_options.watch that appends to a record; data: the record. */
int method_watch(void *data, const sgt_step *step);

/* Runs a bare method; t is in lengths of the ray's direction.  If the span is infinite, bisection
 * uses the part inside the clear aperture (semi_diameter, a length; 0: none). */
record method_run(method m, sgt_surface s, double semi_diameter, const sgt_ray *ray, int max_evals);

/* Was F NaN at every evaluation, so that all it did was to halve t? */
bool method_only_retreated(const record *r);

/* How many of the evaluations are steps of a march? */
size_t method_march_steps(const record *r);

sgt_diagnosis method_diagnose(const record *r);

#endif
