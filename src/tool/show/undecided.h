/* undecided.h - what is left of a ray that has no answer, and what a person can do about it. */
#ifndef TOOL_UNDECIDED_H
#define TOOL_UNDECIDED_H
#include "table.h"

#include <sagitta/surfaces.h>

/* A search of the library's own: where, what was asked, and the answer. */
typedef struct search {
    sgt_surface surface;
    /* of the clear aperture of a lens's element; 0: none but the surface's own */
    double semi_diameter;
    sgt_ray ray;                  /* in the surface's frame */
    const sgt_options *asked;
    bool near_seed, fast;         /* whose pick that is; as --dt-min asks for it */
    const sgt_hit *hit;
} search;

enum { UNDECIDED_SHOWN = 4 };     /* of many rays so many are explained */

/* A line that begins with `who`: the stretch of the ray that is left, and why. */
void undecided_explain(table *t, const char *who, const search *s);

/* The same surface without its rim, if it can have one.  rim: what it had, 0: none; c and k of the conic
 * that it is, or is built on (terms: with more than that), 0 where there is no such conic. */
typedef struct bare_surface { sgt_surface surface; double c, k, rim; bool terms; } bare_surface;
bool undecided_has_rim(sgt_surface s);
bare_surface undecided_without_rim(sgt_surface s);

#endif
