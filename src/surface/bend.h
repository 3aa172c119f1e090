/* bend.h - the norm of a second derivative from bounds on its entries. */
#ifndef SGT_SURFACE_BEND_H
#define SGT_SURFACE_BEND_H

#include "../num/exact.h"

/* The norm of any symmetric matrix whose entries are at most these in magnitude: at most that of these themselves, its
 * greater eigenvalue. */
SGT_INLINE double norm_of(double xx, double xy, double yy)
{
    double half = 0.5 * (xx - yy), norm = (0.5 * (xx + yy) + sqrt(half * half + xy * xy)) * (1 + 0x1p-40);
    return norm < HUGE_VAL ? norm : HUGE_VAL; /* nor NaN */
}

#endif
