// SPDX-License-Identifier: MIT
/* check.c - what a user's surface promises: diagnose.h. */
#include "dispatch.h"

#include <sagitta/diagnose.h>

SGT_DISPATCH(sgt_fault, sgt_check, (sgt_surface s, size_t n, const sgt_ray rays[], sgt_vec3 *where),
             (s, n, rays, where))
SGT_EXPORT(const char *, sgt_fault_text, (sgt_fault fault), (fault))
