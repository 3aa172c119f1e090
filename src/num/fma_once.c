// SPDX-License-Identifier: MIT
/* fma_once.c - the fused multiply-add of fma_once.h. */
#include "fma_once.h"

double sgt_fma_once(double a, double b, double c) { return sgt_fma_of_file(a, b, c); }
