// SPDX-License-Identifier: MIT
/* fma_once.h - the fused multiply-add without the instruction, once for a whole set that is to be small
 * (src/meson.build includes this before all else).
 *
 * Each file that includes <sagitta/fma.h> has a copy of sgt_fma_exactly, of 1.4 KB, and there are sixty
 * files. */
#ifndef SGT_NUM_FMA_ONCE_H
#define SGT_NUM_FMA_ONCE_H

#define sgt_fma sgt_fma_of_file
#include <sagitta/fma.h>
#undef sgt_fma

double sgt_fma_once(double a, double b, double c);

static inline double sgt_fma(double a, double b, double c) { return sgt_fma_once(a, b, c); }

#endif
