// SPDX-License-Identifier: MIT
/* disc.c - sectors of the unit disc. */
#include "disc.h"

#include <math.h>

static const sgt_interval PI = {0x1.921fb54442d18p+1, 0x1.921fb54442d19p+1};

static bool is_whole(const sector *of) { return of->turn1 - of->turn0 == 1; }

double sgt_sector_area(const sector *of)
{
    return (of->r1 - of->r0) * (of->r1 + of->r0) * (of->turn1 - of->turn0);
}

bool sgt_sector_is_fit(const sector *of) { return of->turn1 - of->turn0 <= 0.25; }

/* The ends of the angle round: twice what that is at most is its rest. */
void sgt_sector_series(const sector *of, sgt_series *x, sgt_series *y)
{
    const sgt_interval lo = sgt_interval_product(PI, sgt_interval_of(2 * of->turn0)),
                       hi = sgt_interval_product(PI, sgt_interval_of(2 * of->turn1));
    sgt_series_polar((sgt_interval){of->r0, of->r1}, (sgt_interval){lo.lo, hi.hi}, x, y);
    const double rounds = 2 * of->r1 * (lo.hi - lo.lo + hi.hi - hi.lo);
    x->rest = sgt_sum_above(x->rest, rounds), y->rest = sgt_sum_above(y->rest, rounds);
}

sgt_interval sgt_sector_integral(const sector *of, const sgt_series *f)
{
    return sgt_interval_product(sgt_series_mean(f, (of->r1 - of->r0) / (of->r1 + of->r0)),
                                sgt_interval_of(sgt_sector_area(of)));
}

void sgt_sector_halve(const sector *of, bool in_angle, sector half[2])
{
    half[0] = half[1] = *of;
    if (in_angle) half[0].turn1 = half[1].turn0 = (of->turn0 + of->turn1) / 2;
    else half[0].r1 = half[1].r0 = (of->r0 + of->r1) / 2;
}

bool sgt_sector_can_halve(const sector *of, bool in_angle)
{
    const double least = 1.0 / (1 << DISC_DEEPEST);
    if (in_angle) return of->turn1 - of->turn0 > least;
    return of->r1 - of->r0 > least;
}

void sgt_sector_point(const sector *of, double p, double q, double *x, double *y)
{
    const double degrees = 360 * (of->turn0 + q * (of->turn1 - of->turn0));
    const double r = is_whole(of) && p == 0.5 ? 0 : of->r0 + p * (of->r1 - of->r0);
    double c, s;
    sgt_turns(1, &degrees, &c, &s);
    *x = r * c, *y = r * s;
}
