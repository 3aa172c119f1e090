// SPDX-License-Identifier: MIT
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

/* Has any element a phase? */
bool sgt_any_phase(size_t elements, const sgt_element e[]);

/* Start i: the user's, the middle, then all over the box.  (aim.c, as the next) */
sgt_vec2 sgt_aim_start(const aim_task *task, const sgt_aim_options *opt, size_t i);

/* Are all numbers of the question as they have to be? */
bool sgt_aim_sound(const aim_task *task, const sgt_aim_options *opt);

/* ---------------------------------------------- a step, of one ray (aim.c) and of many (aim_batch.c) */

enum { AIM_TRACES = 400, AIM_STEPS = 60 };
#define AIM_NOISE 8.0

SGT_INLINE double aim_within(double x, sgt_interval box)
{
    return x < box.lo ? box.lo : x > box.hi ? box.hi : x;
}

/* [i][j]: of x or y by u or v, in units of the box. */
typedef struct aim_slopes {
    double x[2], y[2];
} aim_slopes;

SGT_INLINE double aim_size(const aim_slopes *j)
{
    return fabs(j->x[0]) + fabs(j->x[1]) + fabs(j->y[0]) + fabs(j->y[1]);
}

/* By how much a launch ray changes over the whole box. */
SGT_INLINE sgt_ray_change aim_change(double wide, sgt_vec3 by_o, sgt_vec3 by_d)
{
    return (sgt_ray_change){times(wide, by_o), times(wide, by_d), 0};
}

/* How far an ulp of the launch ray moves its end; size: of the slopes. */
SGT_INLINE double aim_steep(const sgt_beam *b, double wide, const sgt_ray *ray, double size)
{
    const double o = wide * (absolute(b->ou) + absolute(b->ov)),
                 d = wide * (absolute(b->du) + absolute(b->dv));
    const double by_o = o > 0 ? absolute(ray->o) / o : 0, by_d = d > 0 ? absolute(ray->d) / d : 0;
    return 2 * SGT_U * size * (by_o + by_d);
}

/* (J^T J + m I) s = -J^T f, m in units of the mean square of J.  Without m it is Newton's, by J itself, or
 * that of one parameter if the other is held. */
SGT_INLINE sgt_vec2 aim_step(const aim_slopes *j, sgt_vec2 f, double m, bool hold_u, bool hold_v)
{
    double a = hold_u ? 0 : j->x[0], b = hold_v ? 0 : j->x[1], c = hold_u ? 0 : j->y[0],
           d = hold_v ? 0 : j->y[1];
    double size = a * a + b * b + c * c + d * d, det = difference_of_products(a, d, b, c);
    if (m == 0 && fabs(det) > 0x1p-40 * size)
        return (sgt_vec2){-difference_of_products(d, f.x, b, f.y) / det,
                          -difference_of_products(a, f.y, c, f.x) / det};
    double more = (m > 0 ? m : 0x1p-40) * size, uu = a * a + c * c + more, vv = b * b + d * d + more,
           uv = a * b + c * d, gu = a * f.x + c * f.y, gv = b * f.x + d * f.y, all = uu * vv - uv * uv;
    return (sgt_vec2){-(vv * gu - uv * gv) / all, -(uu * gv - uv * gu) / all};
}

/* Does the step go out of the box where r is on its edge? */
SGT_INLINE bool goes_out(double at, sgt_interval box, double step)
{
    return (at <= box.lo && step < 0) || (at >= box.hi && step > 0);
}

/* A step, in units of the box, that Newton's method cannot make better. */
SGT_INLINE bool aim_is_small(sgt_vec2 step) { return fabs(step.x) + fabs(step.y) < 0x1p-36; }

/* Has that part of a step made the miss less? */
SGT_INLINE bool aim_is_less(double miss, double before, double part)
{
    return miss < before * (1 - 1e-3 * part);
}

/* Is a miss as little as is wanted, or as half an ulp of the launch ray makes it?  steep: aim_steep of the
 * ray before; 0, if there is none. */
SGT_INLINE bool aim_is_enough(double miss, double tol, double steep)
{
    return miss <= tol || miss <= 0.5 * steep;
}

SGT_INLINE double aim_told_miss(double miss, double error) { return (miss + error) * (1 + 8 * SGT_U); }

/* ------------------------------------------------------------------------ the proof */

/* The search for a proof that no ray of the beam meets the point (aim_proof.c).  It is a walk over parts of
 * the box, and stops where a ray may be near.  PROOF_LOOK: at (u, v); ask again to go on.  PROOF_DONE: there
 * is no such ray.  PROOF_OPEN: it cannot be told, or the budget is spent. */
typedef enum aim_verdict { PROOF_DONE, PROOF_OPEN, PROOF_LOOK } aim_verdict;
typedef struct aim_part { sgt_interval u, v; } aim_part;
enum { AIM_DEEP = 100, AIM_KEPT = 16 };

/* The z of a surface within a radius, if it is known. */
typedef struct sag_kept { bool known; sgt_interval z; } sag_kept;
typedef struct aim_proof {
    const aim_task *task;
    sag_kept kept[AIM_KEPT][2]; /* of the first elements (bundle.h) */
    aim_part stack[AIM_DEEP];
    int height, boxes, most, looks;
    bool given_up; /* on a part */
    double u, v;
} aim_proof;
aim_proof sgt_aim_proof_of(const aim_task *task, int most);
aim_verdict sgt_aim_proof_next(aim_proof *w);

#endif
