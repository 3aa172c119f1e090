/* proof.h - a ray and a surface that is met by its operations, proven by its enclosure: the search of
 * prove.c. */
#ifndef SGT_RAY_PROOF_H
#define SGT_RAY_PROOF_H

#include "general.h"

typedef struct proof {
    sgt_surface s;
    const sgt_ray *ray;
    tally told;
    sgt_list *list;
    bool all, found;
    bool anew;             /* max_evals is each root's */
    /* where the ray is nearest to the origin of the surface's frame, and how far that is from its own */
    double centre, reach;
    double t0;             /* what t counts from: 0 or */
    double far;            /* the t of the centre, or near it; 0 where that is not far off */
    sgt_ray at_far;        /* of a surface of a user the ray that begins there */
    double foot;           /* the distance of the centre from the origin of the surface's frame */
    sgt_interval all_t;    /* what is searched, in the ray's own t */
    sgt_interval tmin;     /* the ray's */
    double seed, near;     /* the seed, and how far from it is: */
    sgt_hit nearest;       /* the entry nearest to it */
    double rim2;           /* r^2 within which a root counts */
    double least;          /* pieces below it are not divided */
    double lo, hi, done;   /* what is searched; decided up to here */
    bool pending;          /* there is an undecided stretch: */
    sgt_interval dark, last; /* it, and where the last root was */
    double told_dark;      /* where the last such stretch that was told of ended */
} proof;

/* Where on the ray a root can be, from the span; false: nowhere. */
bool sgt_proof_bounds(sgt_surface s, const sgt_ray *ray, sgt_span *span);

/* A search for the first root, or with `all` for every root, that is to begin. */
proof sgt_proof_of(sgt_surface s, const sgt_ray *ray, const sgt_options *opt, const sgt_span *span,
                   sgt_list *list, bool all);

/* Adds what there is in w->all_t, in order. */
void sgt_proof_search(proof *w);

/* A root has been found at t + t_lo, right to t_err.  It is added if it can be proven; false: it cannot. */
bool sgt_proof_take(proof *w, double t, double t_lo, double t_err);

/* [lo, hi] is not decided, or was not searched. */
void sgt_proof_stretch(proof *w, sgt_status status, double lo, double hi);

/* Where no proof is asked for, the rest of a search that has been begun, within its budget: every root of
 * `all`, else the first, or the one nearest to the seed, is added. */
void sgt_prove_rest(sgt_surface s, const sgt_ray *ray, tally *told, bool all, bool near, sgt_list *list);

/* A root that has been found at t + t_lo, right to t_err, on a ray that meets no other, where rounding hides
 * whether it is accepted.  true: it is decided, and added if it is accepted, or cannot be told. */
bool sgt_prove_found(sgt_surface s, const sgt_ray *ray, tally *told, double t, double t_lo, double t_err,
                     sgt_list *list);

#endif
