// SPDX-License-Identifier: MIT
/* intersect.c - one ray: sagitta.h. */
#include "dispatch.h"

#include <sagitta/sagitta.h>

/* A ray is eight numbers on the stack.  Its address is passed on, so that it is not copied once more. */
SGT_IN_SETS(sgt_hit, sgt_intersect_copy, (sgt_surface s, sgt_ray *ray, const sgt_options *opt))
sgt_hit sgt_intersect(sgt_surface s, sgt_ray ray, const sgt_options *opt)
{
    return sgt_intersect_copy_in_set[sgt_set()](s, &ray, opt);
}
sgt_ray sgt_ray_between(sgt_vec3 o, sgt_vec3 d, double tmin, double tmax)
{
    return (sgt_ray){o, d, tmin, tmax == 0 ? -0.0 : tmax}; /* builtin.h, DEFAULT ENDS */
}

SGT_DISPATCH(int, sgt_intersect_all,
             (sgt_surface s, sgt_ray ray, int cap, sgt_hit hits[], const sgt_options *opt),
             (s, ray, cap, hits, opt))
