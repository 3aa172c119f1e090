/* monotone.c - along which rays is a sag monotone, all over the chord of its domain? */
#include "lanes.h"
#include "poly.h"

/* n^2 > limit (l^2 + m^2); where a square has underflown it is small beside n^2 times 2^-500. */
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
