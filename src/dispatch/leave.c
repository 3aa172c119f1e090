// SPDX-License-Identifier: MIT
/* leave.c - rays that start on a surface: sagitta.h. */
#include "dispatch.h"

#include <sagitta/sagitta.h>

SGT_DISPATCH(sgt_crossing, sgt_leave, (sgt_surface s, const sgt_start *from, const sgt_options *opt),
             (s, from, opt))

SGT_DISPATCH(size_t, sgt_leave_batch,
             (sgt_surface s, size_t n, sgt_starts from, sgt_hits hits, signed char *side,
              const sgt_options *opt),
             (s, n, from, hits, side, opt))
