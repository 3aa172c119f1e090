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

/* The search for a proof that no ray of the beam meets the point (aim_proof.c).  It is a walk over parts of
 * the box, and stops where a ray may be near.  PROOF_LOOK: at (u, v); ask again to go on.  PROOF_DONE: there
 * is no such ray.  PROOF_OPEN: it cannot be told, or the budget is spent. */
typedef enum aim_verdict { PROOF_DONE, PROOF_OPEN, PROOF_LOOK } aim_verdict;
typedef struct aim_part { sgt_interval u, v; } aim_part;
enum { AIM_DEEP = 100 };
typedef struct aim_proof {
    const aim_task *task;
    aim_part stack[AIM_DEEP];
    int height, boxes, most, looks;
    bool given_up; /* on a part */
    double u, v;
} aim_proof;
aim_proof sgt_aim_proof_of(const aim_task *task, int most);
aim_verdict sgt_aim_proof_next(aim_proof *w);

#endif
