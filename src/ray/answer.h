// SPDX-License-Identifier: MIT
/* answer.h - the answers for one ray and a surface that is met by its operations, with a proof or without. */
#ifndef SGT_RAY_ANSWER_H
#define SGT_RAY_ANSWER_H

#include "general.h"

/* The hit that options.pick asks for, under options.proof.  ray and opt have been checked, and tmax is
 * explicit. */
sgt_hit sgt_intersect_general(sgt_surface s, const sgt_ray *ray, const sgt_options *opt);

/* The same with what a batch keeps of parts of the surface (vicinity.h), at less cost and with less stack.
 * sgt_quick_proof_offered is true, no cells are offered, and options.f_tol is 0. */
struct memo;
sgt_hit sgt_prove_kept(sgt_surface s, const sgt_ray *ray, const sgt_options *opt, struct memo *known);

/* Adds every entry to the list, under options.proof.  The first entry is the hit that
 * sgt_intersect_general returns for SGT_FIRST. */
void sgt_intersect_all_general(sgt_surface s, const sgt_ray *ray, const sgt_options *opt, sgt_list *list);

/* As sgt_intersect_general where options.proof is not SGT_ESTIMATE.  A root is accepted only within r^2 <=
 * rim2; HUGE_VAL: within the surface's own rim. */
sgt_hit sgt_prove_within(sgt_surface s, const sgt_ray *ray, double rim2, const sgt_options *opt);

#endif
