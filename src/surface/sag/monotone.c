// SPDX-License-Identifier: MIT
/* monotone.c - along which rays is a sag monotone, all over the chord of its domain?
 *
 * With a = l^2 + m^2 and L a bound on the slope of the sag, that is so where n^2 > L^2 a. */
#include "lanes.h"
#include "poly.h"

/* Tests n^2 > limit (l^2 + m^2).  Where a square underflows, it is small beside n^2 times 2^-500. */
SGT_KERNEL
static mask lane_monotone(double limit, const sgt_tile *tile, mask unique[])
{
    const double *l = tile->rays.d[0], *m = tile->rays.d[1], *n = tile->rays.d[2];
    size_t count = tile->n;
    mask all = MASK(true);
    _Pragma("omp simd reduction(& : all)") for (size_t i = 0; i < count; i++) {
        double a = l[i] * l[i] + m[i] * m[i], n2 = n[i] * n[i];
        unique[i] = MASK(n2 > limit * a) & MASK(a + n2 > 0x1p-200);
        all &= unique[i];
    }
    return all;
}

bool sgt_lanes_steeper(double limit, const sgt_tile *tile, mask unique[])
{
    return lane_monotone(limit < 0x1p500 ? limit : HUGE_VAL, tile, unique) != 0;
}

bool sgt_lanes_monotone(const shape *s, const sgt_tile *tile, mask unique[])
{
    return sgt_lanes_steeper(single_limit(s), tile, unique);
}
