// SPDX-License-Identifier: MIT
/* level_counts.h - what a batch on a level set does, counted. */
#ifndef BENCH_LEVEL_COUNTS_H
#define BENCH_LEVEL_COUNTS_H

#include <sagitta/surfaces.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Levels of the orbit; the places for them that lanes had; rays left to the single ray. */
typedef struct level_counts { long long levels, lanes, hard; } level_counts;

level_counts level_counts_of(const sgt_julia *s, size_t n, const double *const o[3], const double *const d[3],
                             size_t tile_size, double t_tol);

#ifdef __cplusplus
}
#endif
#endif
