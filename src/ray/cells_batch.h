// SPDX-License-Identifier: MIT
/* cells_batch.h - the first root on rays, by the cells of a surface that offers `encloses`. */
#ifndef SGT_RAY_CELLS_BATCH_H
#define SGT_RAY_CELLS_BATCH_H

#include "general.h"

/* Are first roots on this surface searched for here?  Then single rays and batches both have to. */
bool sgt_cells_offered(sgt_surface s, const sgt_options *opt);

/* Answers a tile of rays as sgt_builtin_ops.lanes of builtin.h does, or a part of them: the others are
 * SGT_HARD, or SGT_SINGLE if the span is single and no proof is asked for.  Returns how many are neither
 * met nor missed. */
#define SGT_SINGLE ((sgt_status)(SGT_HARD - 1))
size_t sgt_cells_tile(sgt_surface s, const sgt_tile *tile, const sgt_options *opt);

/* The same for one ray.  true: *hit is the answer, or STOPPED.  false: the ray is left to others, and
 * hit->evals evaluations have been spent. */
bool sgt_cells_first(sgt_surface s, const sgt_ray *ray, const sgt_options *opt, sgt_hit *hit);

#endif
