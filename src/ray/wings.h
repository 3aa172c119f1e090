/* wings.h - a march through the wings of a sag: wings.c. */
#ifndef SGT_RAY_WINGS_H
#define SGT_RAY_WINGS_H

#include "../num/lanes.h"

#include "vicinity.h"

#include <string.h>

enum { FINER = 47, FINE = 49, COARSE = 52 };

/* A power of two above r, or an eighth of one, or a thirty-second; infinite beyond 2^400, and never below
 * 2^-400. */
SGT_INLINE double rung_above(double r, int digits)
{
    unsigned long long bits, unit = 1ULL << digits;
    double above = larger(r, 0x1p-401);
    memcpy(&bits, &above, sizeof bits);
    bits = (bits & ~(unit - 1)) + unit;
    memcpy(&above, &bits, sizeof above);
    return chosen(MASK(r < 0x1p400), above, HUGE_VAL);
}

/* Not below it: of a ray from afar x and y are known to an ulp of what they are made of. */
SGT_INLINE double radius_at(double ox, double oy, double dx, double dy, double t)
{
    double tl = t * dx, tm = t * dy, x = ox + tl, y = oy + tm;
    return sqrt(x * x + y * y) + 0x1p-51 * ((fabs(ox) + fabs(tl)) + (fabs(oy) + fabs(tm)));
}

/* Where it is kept. */
SGT_INLINE int place_of(double rung, int digits, int places)
{
    unsigned long long bits;
    memcpy(&bits, &rung, sizeof bits);
    return (int)(bits >> digits) & (places - 1);
}

/* Of each lane that is asked, from `from` on; work may be the rows of `from`.  Where the surface has an edge,
 * of those alone that begin behind the seed, or of the others.  Spends evaluations; those of a row by
 * itself are told. */
void sgt_march_wings(sgt_surface s, size_t n, sgt_rays rays, const double *from, bool behind,
                     const sgt_shared *bare, rings *kept, const vicinity *v, double *const work[WINGS_ROWS]);

#endif
