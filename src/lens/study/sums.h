// SPDX-License-Identifier: MIT
/* sums.h - the sums of analysis.h from inside. */
#ifndef SGT_STUDY_SUMS_H
#define SGT_STUDY_SUMS_H
#include "spot.h"
#include "wavefront.h"

struct sgt_sums {
    sgt_allocator allocator;
    sgt_sums_kind kind;
    sgt_vec2 about;
    middle_sum middle;          /* of a spot: from `about` */
    spread_sum spread;
    sgt_wavefront_sum front;
};

enum { SUMS_MOST_EXACT = 8 };

/* The exact sums of a kind, one after another; returns how many. */
size_t sgt_sums_exact(sgt_sums *s, exact *out[SUMS_MOST_EXACT]);

#endif
