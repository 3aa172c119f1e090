// SPDX-License-Identifier: MIT
/* bend.h - the length of a gradient and the norm of a second derivative, from bounds on their entries. */
#ifndef SGT_SURFACE_DEPARTURE_BEND_H
#define SGT_SURFACE_DEPARTURE_BEND_H

#include "../../num/elementary.h"

#include <stdbool.h>
#include <stddef.h>

/* sqrt(a^2 + b^2) for a, b >= 0, to rounding.  If the squares leave the range, the larger a + b. */
SGT_INLINE double length_of(double a, double b)
{
    double r2 = a * a + b * b;
    return r2 > 0x1p-960 && r2 < HUGE_VAL ? sqrt(r2) : a + b;
}

/* The norm of any symmetric matrix with entries of at most these magnitudes.  It is at most the norm of
 * the matrix of the magnitudes, which is its greater eigenvalue. */
SGT_INLINE double norm_of(double xx, double xy, double yy)
{
    double half = 0.5 * (xx - yy), norm = (0.5 * (xx + yy) + length_of(fabs(half), xy)) * (1 + 0x1p-40);
    return norm < HUGE_VAL ? norm : HUGE_VAL; /* NaN too */
}

/* Is the region a disc about the origin, not cut by its rectangle? */
SGT_INLINE bool is_disc(double x_most, double y_most, double r) { return x_most >= r && y_most >= r; }

/* h[k] = k^(k/2) for the degrees of a table, within 64 roundings, 2^-46 relative. */
enum { MOST_HALF_POWERS = 128 };
SGT_INLINE void half_powers(size_t n, double *h)
{
    h[0] = 1;
    for (size_t k = 1; k < n; k++)
        h[k] = integer_power((double)k, (unsigned)k / 2) * (k & 1 ? sqrt((double)k) : 1);
}

/* The maximum of x^p y^q over x^2 + y^2 <= 1. */
SGT_INLINE double corner_of(const double *h, size_t p, size_t q) { return h[p] * h[q] / h[p + q]; }

#endif
