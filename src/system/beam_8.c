// SPDX-License-Identifier: MIT
/* beam_8.c - the walk of beam_walk.h for boxes of up to 8 parameters. */
#include "beam_walk.h"

sgt_box_verdict sgt_box_walk_8(const beam_task *task, sgt_box_end *out) { return box_walk(task, out); }
