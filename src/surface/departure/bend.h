/* bend.h - the length of a gradient, and the norm of a second derivative, from bounds on their entries. */
#ifndef SGT_SURFACE_DEPARTURE_BEND_H
#define SGT_SURFACE_DEPARTURE_BEND_H

#include "../../num/elementary.h"

#include <stdbool.h>
#include <stddef.h>

/* sqrt(a^2 + b^2) of a, b >= 0, but for rounding; more, a + b, where the squares leave the range. */
SGT_INLINE double length_of(double a, double b)
{
    double r2 = a * a + b * b;
    return r2 > 0x1p-960 && r2 < HUGE_VAL ? sqrt(r2) : a + b;
}

/* The norm of any symmetric matrix whose entries are at most these in magnitude: at most that of these
 * themselves, its greater eigenvalue. */
SGT_INLINE double norm_of(double xx, double xy, double yy)
{
    double half = 0.5 * (xx - yy), norm = (0.5 * (xx + yy) + length_of(fabs(half), xy)) * (1 + 0x1p-40);
    return norm < HUGE_VAL ? norm : HUGE_VAL; /* nor NaN */
}

/* A disc about the origin, and not what is left of it by a rectangle. */
SGT_INLINE bool is_disc(double x_most, double y_most, double r) { return x_most >= r && y_most >= r; }

/* k^(k/2), of the degrees of a table: within 64 roundings, 2^-46 relative. */
enum { MOST_HALF_POWERS = 128 };
SGT_INLINE void half_powers(size_t n, double *h)
{
    h[0] = 1;
    for (size_t k = 1; k < n; k++)
        h[k] = integer_power((double)k, (unsigned)k / 2) * (k & 1 ? sqrt((double)k) : 1);
}

/* The most of x^p y^q where x^2 + y^2 <= 1. */
SGT_INLINE double corner_of(const double *h, size_t p, size_t q) { return h[p] * h[q] / h[p + q]; }

#endif
