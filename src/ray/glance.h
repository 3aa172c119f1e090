// SPDX-License-Identifier: MIT
/* glance.h - the first root along a chord within the rim, by two looks beside it (glance.c). */
#ifndef SGT_RAY_GLANCE_H
#define SGT_RAY_GLANCE_H

#include "vicinity.h"

/* Looks beside the root near the seed of each row that is asked, within [v->lo, v->hi], and answers in v as
 * sgt_march_chord does (wings.h), which is to be asked for the rows that are left.  marches_chord(whole) is
 * true. */
void sgt_glance_chord(sgt_surface s, size_t n, sgt_rays rays, const sgt_shared *whole, const vicinity *v);

#endif
