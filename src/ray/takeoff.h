// SPDX-License-Identifier: MIT
/* takeoff.h - rays that start on a sag within its rim, and what is ahead of them (takeoff.c). */
#ifndef SGT_RAY_TAKEOFF_H
#define SGT_RAY_TAKEOFF_H

#include "vicinity.h"

/* Looks at the start of each row that is asked and may start on the surface, and beside it.  Rows that meet
 * nothing within [v->tmin, v->hi] are answered in v, as misses.  Of others that start on it, lo is set to a t
 * up to which no root is accepted, and seed to where the next one is thought to be: they are still asked, and
 * sgt_glance_chord and sgt_march_chord are to follow.  Returns which these are, a bit each.
 * marches_chord(whole) is true. */
unsigned long long sgt_take_off(sgt_surface s, size_t n, sgt_rays rays, const sgt_shared *whole,
                                const vicinity *v);

#endif
