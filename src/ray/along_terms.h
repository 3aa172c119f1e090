// SPDX-License-Identifier: MIT
/* along_terms.h - a departure along some rays at once, as a polynomial of each (along_terms.c). */
#ifndef SGT_RAY_ALONG_TERMS_H
#define SGT_RAY_ALONG_TERMS_H

#include "../surface/departure/departure.h"

#include "along.h"

/* At least half of the greatest number of nodes; that number; rays at a time. */
enum { ALONG_HALF = 20, ALONG_MOST = 2 * ALONG_HALF, WIDE = ALONG_ROWS };

/* (Loops of eight and four lanes are no kernels of exact.h: four do not fill the widest registers.) */
typedef double lane_row[WIDE];
#define EACH LANES for (size_t u = 0; u < WIDE; u++)

/* The lines of some rays, each about its point nearest the axis, counted in v, and P along it. */
typedef struct lines {
    size_t half, n;                        /* nodes on either side; the degree, 2 half - 1 */
    double c, k1;                          /* the base */
    lane_row x, y, l, m;                   /* dx/dv = l, dy/dv = m */
    lane_row z, g;                         /* z = z0 + g v */
    lane_row W, t0, by, scale;             /* t = (t0 + by v) scale */
    lane_row E, B;                         /* the size of p - P; the greatest |b_k| */
    lane_row p[ALONG_MOST], b[ALONG_MOST]; /* c_k and b_k */
} lines;

SGT_INLINE double along_power(double x, size_t n)
{
    double power = 1;
    for (; n; n >>= 1, x *= x)
        if (n & 1) power *= x;
    return power;
}

/* At most how far P may be off at the nodes of a line of this W, by its own rounding and by that of the
 * points, times their weights; HUGE_VAL: not known.  It is kept. */
double sgt_rounding_along(sgt_surface s, size_t half, double W, vicinities *kept);

/* Sets p, b, E and B of the lines, of which `count` differ.  both: P is not the same on either side of the
 * nearest point.  rounding: as above, of each. */
void sgt_ask_along(sgt_surface s, bool both, size_t count, const lane_row rounding, lines *e);

#endif
