/* walk.h - one ray on its way along any surface: evaluations, brackets, and the roots they hold. */
#ifndef SGT_RAY_WALK_H
#define SGT_RAY_WALK_H

#include "../solve/root.h"
#include "../solve/step.h"
#include "../surface/builtin.h"

/* F at one local point of the ray, and how far it can be off there. */
typedef struct point {
    double tau, g, g_err;
    sgt_vec3 p, n;
    around at;
    bool glanced; /* the surface's own rounding is left out of g_err */
} point;

typedef struct walk {
    sgt_surface s;
    const sgt_ray *ray;
    local q;
    tally told;
    sgt_list *list;
    bool all;       /* every root is wanted, not the first alone */
    bool found;     /* and that one is found */
    bool from_tmin; /* the search begins at tmin: a root there does not count */
    bool defined;   /* F was, somewhere */
    bool uncertain; /* a step was taken that a root can hide in */
    double t_tol;   /* of tau */
    double lo, hi;  /* the stretch that is searched: F is not asked for outside of it */
    double lowest, highest; /* the least and the greatest |g| that the search for the root has seen */
    bool off;       /* the root that does not count can be told not to */
    /* of the quick form: the root that may count or not; its t is NaN where there is none */
    acceptance hidden;
    /* a bound from below on |g'| all along the stretch, which has one root at most; 0: not known */
    double least;
    double rim2;    /* of the surface's rim; infinite where there is none */
    double margin;  /* of acceptance_of: END_ERRORS where not all roots are found this way */
    sgt_shared shared; /* of the surface, where it shares */
    bool nearby;       /* and what its departure adds to the rounding is known near this ray alone: */
    double noise[3];   /* vicinity.h */
} walk;

/* No more is to be asked: stopped, spent, or found what was wanted. */
SGT_INLINE bool over(const walk *w) { return w->found || w->told.stopped || spent(&w->told); }

SGT_INLINE int sign_at(const point *e) { return (int)sign_of(e->g, e->g_err); }

SGT_INLINE mark mark_of(const point *e) { return (mark){e->tau, e->g, e->at.slope, sign_of(e->g, e->g_err)}; }

/* F at tau; NaN without an evaluation where the search is over. */
point sgt_walk_look(walk *w, double tau, sgt_move move, double lo, double hi);

/* The same, the surface's own rounding left out where it can be: close_of in step.h. */
point sgt_walk_glance(walk *w, double tau, sgt_move move, double lo, double hi, double last);

/* Its sign with the surface's own rounding. */
int sgt_walk_sign(const walk *w, const point *at);

/* Runs the solver, with the options of the ray; *at is the point it ended on. */
sgt_root sgt_walk_solve(walk *w, sgt_root r, point *at);
sgt_root sgt_walk_begin(walk *w, sgt_span span);

/* Adds what the solver found; false where it is no root that counts. */
bool sgt_walk_take(walk *w, const sgt_root *r, point at);

/* The quick form (step.h) from tau, `last` the step before, |g| at first (< 0: at tau): *at is the root,
 * right to *tau_err; *past is behind it. */
bool sgt_walk_quick(walk *w, double lo, double hi, double tau, double last, double first, point *at,
                    double *tau_err, double *past);
bool sgt_walk_take_quick(walk *w, point at, double tau_err);

/* The same of one that may count or not, where `least` is known, with the rounding of F at the very point;
 * true: it counts, or certainly does not. */
bool sgt_walk_sharpen(walk *w, point at, double lo, double hi);

/* One certain sign at both ends. */
bool sgt_walk_quick_miss(walk *w, double lo, double hi);

/* A root between a and b, whose signs differ; false: none that counts.  *past is behind it. */
bool sgt_walk_between(walk *w, const point *a, const point *b, double *past);

/* [lo, hi] is not decided, or was not searched. */
void sgt_walk_stretch(walk *w, sgt_status status, double lo, double hi);

/* Every root in [lo, hi], both finite, by the surface's enclosure. */
void sgt_walk_cells(walk *w, double lo, double hi);

#endif
