/* prove.h - proofs for one ray and a surface that is met by its operations.  Implemented in proven.c, by
 * the search of prove.c (proof.h). */
#ifndef SGT_RAY_PROVE_H
#define SGT_RAY_PROVE_H

#include "general.h"

/* As sgt_intersect_general where options.proof is not SGT_ESTIMATE.  A root is accepted only within r^2 <=
 * rim2; HUGE_VAL: within the surface's own rim. */
sgt_hit sgt_prove_within(sgt_surface s, const sgt_ray *ray, double rim2, const sgt_options *opt);

#endif
