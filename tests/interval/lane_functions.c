// SPDX-License-Identifier: MIT
/* lane_functions.c - see lane_functions.h.  SGT_SET is base, v3 or v4. */
#include "lane_functions.h"
#include "../../src/num/functions.h"

#define JOINED(a, b) a##b
#define NAMED(a, b) JOINED(a, b)

#define ONE(name)                                                                                           \
    SGT_KERNEL static void loop_##name(size_t n, const double *restrict a, const double *restrict b,       \
                                       double *restrict y)                                                  \
    {                                                                                                       \
        (void)b;                                                                                            \
        LANES for (size_t i = 0; i < n; i++) y[i] = lane_##name(a[i]);                                      \
    }
#define TWO(name)                                                                                           \
    SGT_KERNEL static void loop_##name(size_t n, const double *restrict a, const double *restrict b,       \
                                       double *restrict y)                                                  \
    {                                                                                                       \
        LANES for (size_t i = 0; i < n; i++) y[i] = lane_##name(a[i], b[i]);                                \
    }
OF_ONE(ONE)
OF_TWO(TWO)

#define LOOP(name) loop_##name,
lane_loop *const NAMED(lane_loops_, SGT_SET)[] = {OF_ONE(LOOP) OF_TWO(LOOP)};

#ifdef WITH_SINGLES
#define SINGLE_ONE(name) static double single_##name(double a, double b) { return (void)b, lane_##name(a); }
#define SINGLE_TWO(name) static double single_##name(double a, double b) { return lane_##name(a, b); }
OF_ONE(SINGLE_ONE)
OF_TWO(SINGLE_TWO)
#define SINGLE(name) single_##name,
lane_single *const lane_singles[] = {OF_ONE(SINGLE) OF_TWO(SINGLE)};
#endif
