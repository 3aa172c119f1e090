// SPDX-License-Identifier: MIT
/* walk.h - one ray on its way along any surface: evaluations, brackets, and the roots they hold.
 *
 * All stretches and points (lo, hi, tau) are in the local measure: tau counts from the local origin, in
 * lengths of the scaled direction (step.h, approach_of).  The functions are in walk.c; sgt_walk_enclosed is
 * in enclosed.c. */
#ifndef SGT_RAY_WALK_H
#define SGT_RAY_WALK_H

#include "../solve/root.h"
#include "../solve/step.h"
#include "../surface/builtin.h"

/* F at one point of the ray: g = F, off by at most g_err. */
typedef struct point {
    double tau, g, g_err;
    around at;
    bool glanced; /* g_err leaves out the surface's own rounding */
} point;

typedef struct walk {
    sgt_surface s;
    const sgt_ray *ray;
    local q;
    tally told;
    sgt_list *list;
    bool all;       /* every root is wanted, not only the first */
    bool found;     /* the one root that is wanted is found */
    bool from_tmin; /* the search begins at tmin, where a root is not accepted */
    bool defined;   /* F was defined at some point */
    bool uncertain; /* a step was taken in which a root can hide */
    double t_tol;   /* options.t_tol in units of tau */
    double lo, hi;  /* the stretch that is searched; F is not asked for outside */
    double lowest, highest; /* the least and the greatest |g| seen in the search for this root */
    bool off;       /* the root is certainly not accepted */
    /* From the quick form: the last root whose acceptance was asked for.  general.c sets t to NaN before;
     * it stays NaN if there was none. */
    acceptance hidden;
    /* A lower bound on |g'| all along the stretch, which has at most one root; 0: not known. */
    double least;
    double steep;   /* of a body: the same where `first` has told it, of no other use; else 0 */
    double rim2;    /* r^2 at the surface's rim; infinite without one */
    double margin;  /* margin of acceptance_of: END_ERRORS if this way finds one root only */
    sgt_shared shared; /* what the surface shares, if it has `share`; bare_of that, if nearby is set */
    bool nearby;       /* what its departure adds to the rounding is known near this ray only: */
    double noise[3];   /* noise of vicinity.h */
} walk;

/* At the beginning, without a rim; q, shared, noise and hidden are set by who knows them.  (Member by member:
 * to clear the whole struct costs as much as a look.) */
SGT_INLINE void walk_begin(walk *w, sgt_surface s, const sgt_ray *ray, const sgt_options *opt, sgt_list *list)
{
    w->s = s, w->ray = ray, w->list = list;
    w->told = (tally){.opt = opt, .evals = 0, .before = 0, .root = 0,
                      .budget = opt->max_evals ? opt->max_evals : SGT_DEFAULT_EVALS, .stopped = false};
    w->all = w->found = w->from_tmin = w->defined = w->uncertain = w->off = w->nearby = false;
    w->shared.ahead = false; /* asked of a surface that shares nothing, too */
    w->t_tol = w->lo = w->hi = w->lowest = w->highest = w->least = w->steep = w->margin = 0;
    w->rim2 = HUGE_VAL;
}

/* Ask no more: stopped, the budget spent, or the wanted root found. */
SGT_INLINE bool over(const walk *w) { return w->found || w->told.stopped || spent(&w->told); }

SGT_INLINE int sign_at(const point *e) { return (int)sign_of(e->g, e->g_err); }

SGT_INLINE limits walk_limits(const walk *w)
{
    return (limits){w->ray->tmin, w->ray->tmax, w->rim2, w->margin};
}

SGT_INLINE mark mark_of(const point *e) { return (mark){e->tau, e->g, e->at.slope, sign_of(e->g, e->g_err)}; }

/* F at tau.  If the search is over, g is NaN and no evaluation is spent.  lo, hi: for the watcher. */
point sgt_walk_look(walk *w, double tau, sgt_move move, double lo, double hi);

/* The same, but the surface's own rounding is left out if close_of (step.h) allows it.  last: the step
 * before. */
point sgt_walk_glance(walk *w, double tau, sgt_move move, double lo, double hi, double last);

/* The sign of g, with the surface's own rounding: 1, -1, or 0 if it is not certain. */
int sgt_walk_sign(const walk *w, const point *at);

/* sgt_walk_begin starts the careful search with the ray's options.  sgt_walk_solve runs it to its end; *at is
 * set to the last point. */
sgt_root sgt_walk_begin(walk *w, sgt_span span);
void sgt_walk_solve(walk *w, sgt_root *r, point *at);

/* Adds what the solver found.  false: it is not an accepted root. */
bool sgt_walk_take(walk *w, const sgt_root *r, point at);

/* A root of the quick form, within tau_err.  past: behind it. */
typedef struct walked { point at; double tau_err, past; } walked;

/* The quick form (solve/root.h), from tau, with `last` the size of the step before.  first: |g| where the
 * search began; if it is negative, |g| at tau.  true: *found is a root. */
bool sgt_walk_quick(walk *w, sgt_interval in, double tau, double last, double first, walked *found);
bool sgt_walk_take_quick(walk *w, point at, double tau_err);

/* Decides a root of which sgt_walk_take_quick could not tell whether it is accepted.  Uses the rounding of
 * F at the very point; `least` has to be known.  true: decided.  It is then added, or certainly not
 * accepted. */
bool sgt_walk_sharpen(walk *w, point at, double lo, double hi);

/* A miss: F has one certain sign at both ends, or is gone_by (step.h).  The stretch has one root at most. */
bool sgt_walk_quick_miss(walk *w, double lo, double hi);

/* Adds a root between a and b, whose signs differ.  *past lies behind it.  false: no root there is
 * accepted. */
bool sgt_walk_between(walk *w, const point *a, const point *b, double *past);

/* Adds [lo, hi], which is not decided or was not searched. */
void sgt_walk_stretch(walk *w, sgt_status status, double lo, double hi);

/* Adds every root in [lo, hi], both ends finite, by the surface's enclosure. */
void sgt_walk_enclosed(walk *w, double lo, double hi);

#endif
