/* aim.h - what the search for a ray and the proof that there is none share.
 *
 * Functions in aim_bound.c, but for those whose comment names another file. */
#ifndef SGT_SYSTEM_AIM_H
#define SGT_SYSTEM_AIM_H
#include "chain.h"

/* A question: which ray of the beam meets e[stop] at `wanted`? */
typedef struct aim_task {
    size_t stop;
    const sgt_element *e;
    double index_before;
    const sgt_beam *beam;
    sgt_vec2 wanted;
    sgt_passage *passages;
} aim_task;

/* Traces a launch ray up to the stop, whatever clips it.  true: it meets the stop.  *clipped: the first
 * element that clips it, or stop + 1.  false: *fate and *element say what stopped it. */
bool sgt_aim_trace(const aim_task *task, const sgt_ray *launch, sgt_fate *fate, size_t *element,
                   size_t *clipped);

/* How far x and y of the last hit may be off, for a ray that sgt_aim_trace has taken to the stop.
 * *grain: how far an ulp of each number of the launch ray puts them. */
double sgt_aim_error(const aim_task *task, const sgt_ray *launch, double *grain);

#endif
