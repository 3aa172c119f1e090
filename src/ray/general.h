/* general.h - a ray and any surface, by nothing but what its operations answer. */
#ifndef SGT_RAY_GENERAL_H
#define SGT_RAY_GENERAL_H
#include "../surface/own.h"

/* ray and opt have been checked, tmax made explicit. */
sgt_hit sgt_intersect_general(sgt_surface s, const sgt_ray *ray, const sgt_options *opt);

/* Every entry; a list's first is what the other returns. */
void sgt_intersect_all_general(sgt_surface s, const sgt_ray *ray, const sgt_options *opt, sgt_list *list);

#endif
