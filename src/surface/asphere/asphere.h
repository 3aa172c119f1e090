/* asphere.h - what the files of the asphere share. */
#ifndef SGT_SURFACE_ASPHERE_ASPHERE_H
#define SGT_SURFACE_ASPHERE_ASPHERE_H

#include "../sag/poly.h"

/* The certified march of classify.c; seed is a t of the scaled direction.  With a list every entry is
 * added to it, and the answer is of no meaning. */
sgt_hit sgt_asphere_march(const shape *s, const sgt_ray *ray, double seed, tally *told, sgt_list *list);

/* Of those rays of a tile that sgt_lanes_monotone has left (alone[i] is 0), the same: all at once, or else
 * each by itself. */
bool sgt_asphere_unique(const shape *s, const sgt_tile *tile, unsigned long long unique[]);

/* Of the rays that begin behind the vertex plane, or in the vertex, and whose passes[i] is not 0: it is left
 * so where the ray certainly meets nothing, else made 0, as it is of all others.  hits and t_tol are not
 * read. */
void sgt_asphere_pass(const shape *s, const sgt_tile *tile, unsigned long long passes[]);

/* Its terms, for a sum. */
extern const struct departure sgt_asphere_departure;

#endif
