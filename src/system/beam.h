// SPDX-License-Identifier: MIT
/* beam.h - boxes of rays through a lens (<sagitta/beam.h>): what beam.c and beam_walk.h share. */
#ifndef SGT_SYSTEM_BEAM_H
#define SGT_SYSTEM_BEAM_H
#include "aperture.h"
#include "bundle.h"

#include <sagitta/beam.h>

/* A box on its way: the call, and what is told of it. */
typedef struct beam_task {
    const sgt_box_lens *lens;
    const sgt_box_launch *launch;
    sgt_box_room *room;
    sgt_box_at *at;
    /* in place of `launch`, of two parameters: */
    const sgt_series_ray *from;
    sgt_series_ray *arriving, *ends;
} beam_task;

/* The walk through all elements, for up to 2, 4 and 8 parameters.  The task is sound.  (beam_2.c, ...) */
sgt_box_verdict sgt_box_walk_2(const beam_task *task, sgt_box_end *out);
sgt_box_verdict sgt_box_walk_4(const beam_task *task, sgt_box_end *out);
sgt_box_verdict sgt_box_walk_8(const beam_task *task, sgt_box_end *out);
sgt_box_verdict sgt_box_walk_series(const beam_task *task, sgt_box_end *out);

#endif
