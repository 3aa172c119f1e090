/* general.h - a ray and any surface, by nothing but what its operations answer. */
#ifndef SGT_RAY_GENERAL_H
#define SGT_RAY_GENERAL_H
#include <sagitta/sagitta.h>

/* ray and opt have been checked, tmax made explicit. */
sgt_hit sgt_intersect_general(sgt_surface s, const sgt_ray *ray, const sgt_options *opt);

#endif
