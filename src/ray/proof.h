// SPDX-License-Identifier: MIT
/* proof.h - the search of proof.c: one ray and a surface that is met by its operations, proven by its
 * enclosure.
 *
 * Unless a comment says "the ray's own t", every t below counts from t0. */
#ifndef SGT_RAY_PROOF_H
#define SGT_RAY_PROOF_H

#include "../solve/cells.h"
#include "general.h"
#include "tail.h"

typedef struct proof {
    sgt_surface s;
    const sgt_ray *ray;
    tally told;
    sgt_list *list;
    bool all, found;
    bool anew;             /* max_evals is for each root anew */
    /* The t where the ray is nearest the origin of the surface's frame, and the distance of that origin
     * from the ray's start, as a length of t. */
    double centre, reach, size;
    double t0;             /* what t counts from: 0 or `far` */
    double far;            /* the t of the centre, or near it; 0 if the centre is not far off */
    sgt_ray at_far;        /* a user's surface: the ray that begins there */
    double foot;           /* the distance of the centre from the frame's origin, as a length of t */
    sgt_interval all_t;    /* what is searched, in the ray's own t */
    sgt_interval tmin;     /* the ray's tmin; an interval, as counting from t0 may round */
    double seed, near;     /* the seed; how far the nearest entry so far is from it */
    sgt_hit nearest;       /* that entry */
    double rim2;           /* a root is accepted within r^2 <= rim2 */
    double least;          /* shorter pieces are not divided */
    double lo, hi;         /* what is searched */
    cells march;           /* its cells are pieces */
    sgt_interval last;     /* the interval of the last root */
    double told_dark;      /* the end of the last undecided stretch that was reported */
} proof;

/* Sets *span to the part of the ray in which a root can be, in the ray's own t.  false: the ray misses the
 * span. */
bool sgt_proof_bounds(sgt_surface s, const sgt_ray *ray, sgt_span *span);
bool sgt_proof_bounds_by(sgt_surface s, const sgt_ray *ray, sgt_tails *kept, sgt_span *span);

/* Prepares a search for the first root or, if `all` is set, for every root.  The surface needs no
 * `enclose` for this. */
proof sgt_proof_of(sgt_surface s, const sgt_ray *ray, const sgt_options *opt, const sgt_span *span,
                   sgt_list *list, bool all);

/* Adds the entries in w->all_t, in order. */
void sgt_proof_search(proof *w);

/* A root has been found at t + t_lo, within t_err, in the ray's own t.  It is added if it can be proven
 * and is accepted.  false: it cannot be proven to be a root. */
bool sgt_proof_take(proof *w, double t, double t_lo, double t_err);

/* Adds [lo, hi], which is not decided or was not searched. */
void sgt_proof_stretch(proof *w, sgt_status status, double lo, double hi);

/* Without a proof: finishes a search that has been begun, within its budget.  Adds every root if `all` is
 * set, the root nearest to the seed if `near` is set, else the first.  Up to `clear`, in the ray's own t, no
 * root is accepted: the search begins there.  (The rule of the start is that of the ray's own tmin.) */
void sgt_prove_rest(sgt_surface s, const sgt_ray *ray, tally *told, bool all, bool near, double clear,
                    sgt_list *list);

/* A root has been found at t + t_lo, within t_err, on a ray that meets no other, but rounding hides
 * whether it is accepted.  true: it is decided now.  It is added if it is accepted, or as UNPROVEN if that
 * cannot be told. */
bool sgt_prove_found(sgt_surface s, const sgt_ray *ray, tally *told, double t, double t_lo, double t_err,
                     sgt_list *list);

#endif
