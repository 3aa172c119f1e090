/* undecided.h - explains an undecided ray: the part still in doubt, and why. */
#ifndef TOOL_UNDECIDED_H
#define TOOL_UNDECIDED_H
#include "table.h"

#include <sagitta/surfaces.h>

/* A search by the library: where, what was asked, and the answer. */
typedef struct search {
    sgt_surface surface;
    double semi_diameter;         /* of a lens element's clear aperture; 0: only the surface's own rim */
    sgt_ray ray;                  /* in the surface's frame */
    const sgt_options *asked;
    bool near_seed, fast;         /* the pick is near-seed; the search is that of --dt-min */
    const sgt_hit *hit;
} search;

enum { UNDECIDED_SHOWN = 4 };     /* how many undecided rays are explained */

/* Prints a line that begins with `who`: the stretch of the ray still in doubt, and why. */
void undecided_explain(table *t, const char *who, const search *s);

/* A surface without its rim, if its type has one.  rim: the rim it had; 0: none.  c, k: of the conic that it
 * is or is built on; 0 if there is none.  terms: it is more than a conic. */
typedef struct bare_surface { sgt_surface surface; double c, k, rim; bool terms; } bare_surface;
bool undecided_has_rim(sgt_surface s);
bare_surface undecided_without_rim(sgt_surface s);

#endif
