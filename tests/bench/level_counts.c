// SPDX-License-Identifier: MIT
/* level_counts.c - src/surface/orbit/level_batch.c once more, counting: how many levels of the orbit its
 * lanes take, and in how many of them they are busy with a cell that is not decided yet.  The way back to
 * the gradient is not counted. */
#include "level_counts.h"

static volatile long long levels_of_lanes, levels_busy;

#if defined(__clang__)
#pragma clang diagnostic ignored "-Wpass-failed" /* what counts is no vector code */
#endif

#define SGT_COUNT_LEVEL(busy) \
    (levels_of_lanes = levels_of_lanes + 1, levels_busy = levels_busy + ((busy) ? 1 : 0))
#undef sgt_level_lanes
#define sgt_level_lanes counted_lanes
#include "../../src/surface/orbit/level_batch.c"

/* A whole batch in tiles of the size given; the rays are halves of lines. */
level_counts level_counts_of(const sgt_julia *s, size_t n, const double *const o[3], const double *const d[3],
                             size_t tile_size, double t_tol)
{
    enum { MOST = 4096 };
    static sgt_status status[MOST];
    static double tmin[MOST], tmax[MOST], tolerances[MOST];
    const sgt_options options = {.t_tol = t_tol};
    orbit checked;
    level_counts r = {0, 0, 0};
    if (sgt_orbit_of_julia(s, &checked).param || tile_size > MOST) return r;
    for (size_t i = 0; i < MOST; i++) tmax[i] = HUGE_VAL, tolerances[i] = t_tol;
    levels_of_lanes = levels_busy = 0;
    for (size_t i = 0; i < n; i += tile_size) {
        const sgt_tile tile = {
            .n = n - i < tile_size ? n - i : tile_size,
            .t_tol = tolerances,
            .hits = {.status = status},
            .rays = {{o[0] + i, o[1] + i, o[2] + i}, {d[0] + i, d[1] + i, d[2] + i}, tmin, tmax}};
        r.hard += (long long)counted_lanes(&checked, &tile, &options);
    }
    r.levels = levels_busy, r.lanes = levels_of_lanes;
    return r;
}
