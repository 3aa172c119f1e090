/* walk.h - one ray on its way along any surface: evaluations, brackets, and the roots they hold. */
#ifndef SGT_RAY_WALK_H
#define SGT_RAY_WALK_H

#include "../solve/root.h"
#include "../surface/sag.h"

/* F at one local point of the ray, and how far it can be off there. */
typedef struct point { double tau, g, slope, g_err, terms; sgt_vec3 p, n; double p_err; } point;

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
    double first;   /* |g| where the solver began */
    bool off;       /* the root that does not count can be told not to */
} walk;

/* No more is to be asked: stopped, spent, or found what was wanted. */
SGT_INLINE bool over(const walk *w) { return w->found || w->told.stopped || spent(&w->told); }

SGT_INLINE int sign_at(const point *e) { return e->g > e->g_err ? 1 : e->g < -e->g_err ? -1 : 0; }

/* F at tau; NaN without an evaluation where the search is over. */
point sgt_walk_look(walk *w, double tau, sgt_move move, double lo, double hi);

/* Runs the solver, with the options of the ray; *at is the point it ended on. */
sgt_root sgt_walk_solve(walk *w, sgt_root r, point *at);
sgt_root sgt_walk_begin(const walk *w, sgt_span span);

/* Adds what the solver found; false where it is no root that counts. */
bool sgt_walk_take(walk *w, const sgt_root *r, point at);

/* A root between a and b, whose signs differ; false: none that counts.  *past is behind it. */
bool sgt_walk_between(walk *w, const point *a, const point *b, double *past);

/* [lo, hi] is not decided, or was not searched. */
void sgt_walk_stretch(walk *w, sgt_status status, double lo, double hi);

/* Every root in [lo, hi], both finite, by the surface's enclosure. */
void sgt_walk_cells(walk *w, double lo, double hi);

#endif
