// SPDX-License-Identifier: MIT
/* asphere.h - what the files of the asphere share. */
#ifndef SGT_SURFACE_ASPHERE_ASPHERE_H
#define SGT_SURFACE_ASPHERE_ASPHERE_H

#include "../sag/poly.h"

/* The certified march of classify.c.  seed is a t along the scaled direction.  If `list` is given, every
 * entry is added to it, and the answer means nothing. */
sgt_hit sgt_asphere_march(const shape *s, const sgt_ray *ray, double seed, tally *told, sgt_list *list);

/* Decides for the rays that sgt_lanes_monotone has left (unique[i] is 0).  Sets unique[i] and returns true
 * as it does.  All rays are tried at once, then each by itself. */
bool sgt_asphere_unique(const shape *s, const sgt_tile *tile, unsigned long long unique[]);

/* Which rays certainly meet nothing?  By the cone, all at once; then ring by ring, each by itself.  Asked
 * for rays that begin behind the vertex plane or in the vertex, and whose passes[i] is not 0.  passes[i]
 * stays as it is if the ray certainly meets nothing.  Otherwise, and for all other rays, it is set to 0.
 * hits and t_tol are not read. */
void sgt_asphere_pass(const shape *s, const sgt_tile *tile, unsigned long long passes[]);

/* The terms by themselves, for a sum. */
extern const struct departure sgt_asphere_departure;

#endif
