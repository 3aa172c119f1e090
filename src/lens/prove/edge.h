// SPDX-License-Identifier: MIT
/* edge.h - how much of a box of the pupil is inside the edges that go through it.
 *
 * Of a box that is cut at a clear aperture the rays with g(s, t) < 0 are inside, g = x^2 + y^2 - a^2 a series
 * of its radius s and angle t.  So what is not decided is not the whole box but a strip along g = 0, as thin
 * as g is known. */
#ifndef SGT_PROVE_EDGE_H
#define SGT_PROVE_EDGE_H
#include "disc.h"

enum { EDGES = 4 }; /* at most, that go through a box */

/* In parts of the disc's area: all g < -slack in `in` of it at least, some g > slack in `out`.  0 and 0 where
 * one of them may run along either way. */
void sgt_edge_parts(const sector *of, size_t edges, const sgt_series g[], const double slack[], double *in,
                    double *out);

#endif
