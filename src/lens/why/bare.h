// SPDX-License-Identifier: MIT
/* bare.h - a surface without its rim, if its type has one. */
#ifndef SGT_LENS_BARE_H
#define SGT_LENS_BARE_H
#include <sagitta/surfaces.h>

/* rim: the rim it had; 0: none.  c, k: of the conic that it is or is built on; 0 if there is none.  terms: it
 * is more than a conic. */
typedef struct rimless { sgt_surface surface; double c, k, rim; bool has_rim, terms; void *room; } rimless;

/* Without memory the surface keeps its rim. */
rimless sgt_bare_of(sgt_surface s);
void sgt_bare_end(rimless *b);

/* The tmax that is meant: infinity where both ends are left at their default. */
double sgt_end_of(const sgt_ray *ray);

#endif
