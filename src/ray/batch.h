// SPDX-License-Identifier: MIT
/* batch.h - many rays and one surface, a tile at a time. */
#ifndef SGT_RAY_BATCH_H
#define SGT_RAY_BATCH_H
#include "../surface/builtin.h"

/* Answers every ray of a tile.  opt has been checked and asks for no watcher; its t_tol is not read.
 * Returns the number of positive statuses. */
size_t sgt_intersect_tile(sgt_surface s, const sgt_tile *tile, const sgt_options *opt);

/* The arrays from their i-th entry on. */
SGT_INLINE double *row_from(double *a, size_t i) { return a ? a + i : NULL; }

SGT_INLINE sgt_hits hits_from(const sgt_hits *h, size_t i)
{
    return (sgt_hits){.status = h->status ? h->status + i : NULL,
                      .evals = h->evals ? h->evals + i : NULL,
                      .t = row_from(h->t, i),
                      .t_err = row_from(h->t_err, i),
                      .t_lo = row_from(h->t_lo, i),
                      .p_err = row_from(h->p_err, i),
                      .p = {row_from(h->p[0], i), row_from(h->p[1], i), row_from(h->p[2], i)},
                      .n = {row_from(h->n[0], i), row_from(h->n[1], i), row_from(h->n[2], i)}};
}

/* n rays of the tile, from the i-th on. */
SGT_INLINE sgt_tile tile_part(const sgt_tile *tile, size_t i, size_t n)
{
    sgt_tile part = *tile;
    part.n = n, part.t_tol += i, part.hits = hits_from(&tile->hits, i), part.rays = rays_from(&tile->rays, i);
    part.rays.tmin = tile->rays.tmin + i, part.rays.tmax = tile->rays.tmax + i;
    return part;
}

/* A watcher that is also told the index of the ray.  `data` of sgt_watch_numbered is a `numbered`. */
typedef struct numbered { sgt_watch *watch; void *data; size_t ray; } numbered;
int sgt_watch_numbered(void *data, const sgt_step *step);

#endif
