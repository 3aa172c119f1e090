// SPDX-License-Identifier: MIT
/* only.h - the only root of a ray, by its first root and its last one (by_slope.c, THE ONLY ROOT). */
#ifndef SGT_RAY_ONLY_H
#define SGT_RAY_ONLY_H
#include "../solve/root.h"
#include "unique.h"

/* Is the last root, as the way back met it, the first one? */
typedef enum other_end { THE_SAME, ANOTHER, NOT_KNOWN } other_end;

SGT_INLINE other_end other_end_of(sgt_interval part, sgt_interval last, double tmax)
{
    const double lo = -last.hi, hi = -last.lo;
    return lo >= part.lo && hi <= part.hi ? THE_SAME : lo > part.hi && hi < tmax ? ANOTHER : NOT_KNOWN;
}

/* The way back from beyond all roots that may follow on the one at t: so far that none is taken for the
 * start.  tmin is NaN if that is not known. */
SGT_INLINE sgt_ray way_back(const sgt_ray *ray, double beyond, double t, sgt_interval part)
{
    const double from = beyond + larger(beyond - t, part.hi - part.lo);
    const bool known = from > part.lo && from > t && from < HUGE_VAL;
    return (sgt_ray){ray->o, {-ray->d.x, -ray->d.y, -ray->d.z}, known ? -from : (double)NAN, HUGE_VAL};
}

/* The evaluations that the way there has to leave for the way back, 64 of its estimate and some of the proof:
 * whatever the way there has spent, the way back is the same. */
enum { FOR_BACK = 72 };
SGT_INLINE bool leaves_enough(const sgt_options *opt, int spent)
{
    return spent <= (opt->max_evals ? opt->max_evals : SGT_DEFAULT_EVALS) - FOR_BACK;
}

#endif
