// SPDX-License-Identifier: MIT
/* fma_once.c - the fused multiply-add of fma_once.h; in a set that is not small nobody asks for it. */
#include <sagitta/fma.h>

#ifndef SGT_NUM_FMA_ONCE_H
#define sgt_fma_of_file sgt_fma
double sgt_fma_once(double a, double b, double c);
#endif

double sgt_fma_once(double a, double b, double c) { return sgt_fma_of_file(a, b, c); }
