// SPDX-License-Identifier: MIT
/* profile_table.h - a sag that depends on r alone: what a table of its profile says of whole rays. */
#ifndef SGT_RAY_PROFILE_TABLE_H
#define SGT_RAY_PROFILE_TABLE_H

#include "../surface/departure/profile.h"

#include <sagitta/interval.h>

#include <stdbool.h>

/* The rings between q = r^2 of one node and of the next.  What is said of a ring holds as far as 2^-10 of its
 * width beyond it.
 *
 *     sag, off               at the node, and how far F may be off there by all that is rounded, but for z
 *     slope, bend            of the ring: what the first and the second derivative by q lie in
 *     has_core               the first ring has no range of derivatives by q.  Known of it instead: `steep`,
 *                            a bound on |ds/dr|, and `bent`, what the second derivative in any direction
 *                            lies in
 *     edge, low, high        where the base ends (r^2; infinite: nowhere), and what the sag lies in from the
 *                            last node to there
 *
 * Nodes behind the last repeat it, up to the end of its block and one more. */
enum { PROFILE_NODES = 64 };
typedef double profile_row[PROFILE_NODES + 1];
typedef struct sgt_profile_table {
    sgt_profile of;
    double c, k1, steep, edge, low, high;
    sgt_interval bent;
    bool has_core;
    size_t nodes;
    profile_row q, sag, off, slope_lo, slope_hi, bend_lo, bend_hi;
} sgt_profile_table;

#endif
