/* batch.h - many rays and one surface, a tile at a time. */
#ifndef SGT_RAY_BATCH_H
#define SGT_RAY_BATCH_H
#include "../surface/own.h"

/* Answers every ray of a tile; opt has been checked and asks for no watcher, its t_tol is not read.  The number of
 * positive statuses. */
size_t sgt_intersect_tile(sgt_surface s, const sgt_tile *tile, const sgt_options *opt);

#endif
