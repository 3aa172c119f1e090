// SPDX-License-Identifier: MIT
/* batch.c - many rays: sagitta.h. */
#include "dispatch.h"

#include <sagitta/sagitta.h>

SGT_DISPATCH_RAYS(size_t, sgt_intersect_batch,
             (sgt_surface s, size_t n, sgt_rays rays, sgt_hits hits, const sgt_options *opt),
             (s, n, rays, hits, opt))

SGT_DISPATCH_RAYS(size_t, sgt_intersect_batch_f,
             (sgt_surface s, size_t n, sgt_rays_f rays, sgt_hits_f hits, const sgt_options *opt),
             (s, n, rays, hits, opt))
