// SPDX-License-Identifier: MIT
/* lane_functions.h - the functions of src/num/functions.h as loops over lanes, compiled for each set of
 * instructions (lane_functions.c), and called one by one. */
#ifndef LANE_FUNCTIONS_H
#define LANE_FUNCTIONS_H

#include <stddef.h>

/* The functions of one argument, and those of two. */
#define OF_ONE(F)                                                                                           \
    F(exp) F(log) F(sin) F(cos) F(tan) F(asin) F(acos) F(atan) F(sinh) F(cosh) F(tanh) F(cbrt)
#define OF_TWO(F) F(atan2) F(hypot) F(power)

#define ONE_OF_THEM(name) LANE_##name,
enum { OF_ONE(ONE_OF_THEM) OF_TWO(ONE_OF_THEM) LANE_FUNCTIONS };

/* y[i] = f(a[i], b[i]); b is not read by a function of one argument. */
typedef void lane_loop(size_t n, const double *a, const double *b, double *y);
typedef double lane_single(double a, double b);

extern lane_loop *const lane_loops_base[], *const lane_loops_v3[], *const lane_loops_v4[];
extern lane_single *const lane_singles[];

#endif
