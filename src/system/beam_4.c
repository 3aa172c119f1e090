// SPDX-License-Identifier: MIT
/* beam_4.c - the walk of beam_walk.h for boxes of up to 4 parameters. */
#define MODEL_4
#include "beam_walk.h"

sgt_box_verdict sgt_box_walk_4(const beam_task *task, sgt_box_end *out) { return box_walk(task, out); }
