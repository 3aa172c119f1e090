// SPDX-License-Identifier: MIT
/* level_sets.c - the potential about a level set: surfaces.h. */
#include "dispatch.h"

#include <sagitta/surfaces.h>

SGT_DISPATCH(double, sgt_julia_potential, (const sgt_julia *s, sgt_vec3 p, sgt_vec3 *grad), (s, p, grad))
SGT_DISPATCH(double, sgt_mandelbrot_potential, (const sgt_mandelbrot *s, sgt_vec3 p, sgt_vec3 *grad),
             (s, p, grad))
