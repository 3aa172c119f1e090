// SPDX-License-Identifier: MIT
/* ends.h - the tmax that a ray means, for arrays of a batch, whose ends are taken as they stand: infinity
 * where both ends are +0, the default of sgt_ray. */
#ifndef TESTS_ENDS_H
#define TESTS_ENDS_H
#include <math.h>
#include <sagitta/sagitta.h>

static inline double end_of(const sgt_ray *r)
{
    return r->tmin == 0 && r->tmax == 0 && !signbit(r->tmin) && !signbit(r->tmax) ? HUGE_VAL : r->tmax;
}

#endif
