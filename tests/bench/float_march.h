// SPDX-License-Identifier: MIT
/* float_march.h - the rival in speed on a Julia set: a distance march in single precision. */
#ifndef BENCH_FLOAT_MARCH_H
#define BENCH_FLOAT_MARCH_H

#include <sagitta/surfaces.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Into t[i] where the ray i, of unit length, is first within eps of the set by Hart's estimate; NaN: nowhere.
 * The plain slice (x, y, z, 0) alone, and p = 2. */
void float_march(const sgt_julia *s, size_t n, const float *const o[3], const float *const d[3], float eps,
                 float t[]);

#ifdef __cplusplus
}
#endif
#endif
