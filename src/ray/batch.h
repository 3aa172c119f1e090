// SPDX-License-Identifier: MIT
/* batch.h - many rays and one surface, a tile at a time. */
#ifndef SGT_RAY_BATCH_H
#define SGT_RAY_BATCH_H
#include "../surface/builtin.h"

/* Answers every ray of a tile.  opt has been checked and asks for no watcher; its t_tol is not read.
 * Returns the number of positive statuses. */
size_t sgt_intersect_tile(sgt_surface s, const sgt_tile *tile, const sgt_options *opt);

/* A watcher that is also told the index of the ray.  `data` of sgt_watch_numbered is a `numbered`. */
typedef struct numbered { sgt_watch *watch; void *data; size_t ray; } numbered;
int sgt_watch_numbered(void *data, const sgt_step *step);

#endif
