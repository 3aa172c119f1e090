/* batch.c - many rays: sagitta.h. */
#include "dispatch.h"

#include <sagitta/sagitta.h>

SGT_DISPATCH(size_t, sgt_intersect_batch,
             (sgt_surface s, size_t n, sgt_rays rays, sgt_hits hits, const sgt_options *opt),
             (s, n, rays, hits, opt))

SGT_DISPATCH(size_t, sgt_leave_batch,
             (sgt_surface s, size_t n, sgt_starts from, sgt_hits hits, signed char *side,
              const sgt_options *opt),
             (s, n, from, hits, side, opt))
