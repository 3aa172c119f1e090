// SPDX-License-Identifier: MIT
/* sensitivity.c - derivatives of a hit: sensitivity.h. */
#include "dispatch.h"

#include <sagitta/sensitivity.h>

SGT_DISPATCH(size_t, sgt_parameters, (sgt_surface s), (s))
SGT_DISPATCH(int, sgt_differentiate,
             (sgt_surface s, const sgt_ray *ray, const sgt_hit *hit, sgt_change by_o[3], sgt_change by_a[]),
             (s, ray, hit, by_o, by_a))
SGT_DISPATCH(int, sgt_differentiate_batch,
             (sgt_surface s, size_t n, sgt_rays rays, sgt_hits hits, sgt_jacobian out),
             (s, n, rays, hits, out))
SGT_DISPATCH(int, sgt_differentiate_forward,
             (sgt_surface s, size_t n, sgt_rays rays, sgt_hits hits, sgt_rays change, const double da[],
              sgt_changes out),
             (s, n, rays, hits, change, da, out))
