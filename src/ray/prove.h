/* prove.h - a ray and a surface that is met by its operations, proven. */
#ifndef SGT_RAY_PROVE_H
#define SGT_RAY_PROVE_H

#include "general.h"

/* As sgt_intersect_general where options.proof is not SGT_ESTIMATE; only roots within r^2 <= rim2 are
 * accepted. */
sgt_hit sgt_prove_within(sgt_surface s, const sgt_ray *ray, double rim2, const sgt_options *opt);

#endif
