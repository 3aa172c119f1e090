// SPDX-License-Identifier: MIT
/* trace.c - one ray through a system: system.h. */
#include "dispatch.h"

#include <sagitta/system.h>

SGT_DISPATCH(size_t, sgt_trace,
             (size_t elements, const sgt_element e[], double index_before, sgt_ray *ray,
              sgt_passage passages[], sgt_fate *fate, const sgt_options *opt),
             (elements, e, index_before, ray, passages, fate, opt))
SGT_DISPATCH(sgt_pose, sgt_pose_tilted, (sgt_vec3 origin, sgt_vec3 degrees), (origin, degrees))
SGT_DISPATCH_VOID(sgt_turns, (size_t n, const double degrees[], double cosine[], double sine[]),
                  (n, degrees, cosine, sine))
SGT_DISPATCH(sgt_phased, sgt_phase_at,
             (const sgt_element *e, double index_before, sgt_vec3 d, const sgt_hit *hit),
             (e, index_before, d, hit))
SGT_EXPORT(sgt_clipping, sgt_clipped_by, (const sgt_element *e, sgt_vec3 p), (e, p))
SGT_EXPORT(const char *, sgt_fate_text, (sgt_fate fate), (fate))
