// SPDX-License-Identifier: MIT
/* trace_batch.c - many rays through a system: system.h. */
#include "dispatch.h"

#include <sagitta/system.h>

SGT_DISPATCH_RAYS(size_t, sgt_trace_batch,
             (size_t elements, const sgt_element e[], double index_before, size_t n, sgt_rays rays,
              sgt_traced out, const sgt_passages passages[], const sgt_options *opt),
             (elements, e, index_before, n, rays, out, passages, opt))
