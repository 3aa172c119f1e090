/* methods.h - the solver watched, and the bare methods it is compared with. */
#ifndef TOOL_METHODS_H
#define TOOL_METHODS_H
#include <sagitta/diagnose.h>

typedef enum method {
    METHOD_SAFEGUARDED,   /* what the library does */
    METHOD_NEWTON,        /* bare, with the NaN back-off alone */
    METHOD_NORMALISED,    /* the same, with the gradient scaled to unit length */
    METHOD_BISECTION
} method;

/* The evaluations a method made, and how it ended. */
typedef struct record {
    sgt_step *step;
    size_t count, capacity;
    bool settled;         /* a bare method: the next step would change nothing */
    double t;             /* where it ended */
    const char *stopped;  /* why, if it did not settle */
} record;

/* A watcher for sgt_options; data is a record. */
int method_watch(void *data, const sgt_step *step);

/* Runs one of the bare methods; t is the ray's own.  Where the span is infinite, bisection
 * takes the stretch within the clear aperture (semi_diameter; 0: there is none). */
record method_run(method m, sgt_surface s, double semi_diameter, const sgt_ray *ray, int max_evals);

/* Did it only back off from one undefined point to the next? */
bool method_only_retreated(const record *r);

/* How many of the evaluations were steps of a march? */
size_t method_march_steps(const record *r);

sgt_diagnosis method_diagnose(const record *r);

#endif
