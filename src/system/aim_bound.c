/* aim_bound.c - a ray that is traced whatever clips it, and a bound on the error of its end.
 *
 * THE ERROR OF THE END.  p_err of a hit is about the ray from the hit before as it stands in doubles
 * (system.h).  So there is one error at each element, and each goes through the rest of the lens.  With A the
 * derivatives of the end by the point p and the direction d' at an element (chain.h), to first order x at the
 * end is off by the sum of
 *
 *     |A_p| p_err                          the point
 *     |A_d'| u (16 + 16 / cos)             the bending: Q is off by at most 12 u (trace.h), cos^2 = Q is that
 *                                          behind the surface; and the frames and unit lengths after it
 *     |A_n| |n| (1 + slope^2) 64 u         the gradient, whose base has the condition of the conic's root
 *     |A_d| 8 u                            the direction in front as it is bent: its frames
 *
 * The first and the last were taken from analysis, the second from what has been observed; the third is a
 * guess that tests/sensitivity/test_aim.cpp holds against 113 bits.  A half is added for the second order.
 *
 * THE ERROR OF THE PATH.  Let the path be that of the polygon through the points as computed, and move these
 * to those of the exact ray.  By Fermat's principle the change is, to first order, the sum of
 * (n d - n' d') . dp: that vector is along the normal (with a phase: along it but for the gradient of the
 * phase, which cancels), so only the part of dp across the surface counts, and that is p_err at most.  The
 * sum itself is a product and an addition at each element, and the directions are of unit length to 4 u. */
#include "aim.h"

#include "phase.h"

#include <stdint.h>

/* --------------------------------------------------------------------- the trace */

bool sgt_aim_trace(const aim_task *task, const sgt_ray *launch, sgt_fate *fate, size_t *element,
                   size_t *clipped)
{
    const sgt_options options = {.pick = SGT_NEAR_SEED};
    const size_t stop = task->stop;
    state at;
    *fate = SGT_LOST, *element = 0, *clipped = stop + 1;
    if (!sgt_launch(launch, task->e, task->index_before, &at)) {
        task->passages[0] = sgt_not_met(SGT_INVALID);
        return false;
    }
    for (size_t i = 0; i <= stop; i++) {
        const sgt_element *e = &task->e[i];
        sgt_passage *passage = &task->passages[i];
        bool sound = is_plain(e) && is_aperture_sound(e) && is_phase_sound(e);
        *fate = sgt_pass(e, sound, &at, &options, NULL, passage), *element = i;
        if (*fate == SGT_CLIPPED) {
            if (i < *clipped) *clipped = i;
            if (i == stop)
                *fate = SGT_PASSED;
            else { /* on from the very hit, without the aperture */
                sgt_element open = *e;
                sgt_hit hit = passage->hit;
                open.semi_diameter = 0, open.aperture = NULL;
                *fate = sgt_pass(&open, sound, &at, &options, &hit, passage);
            }
        }
        if (i == stop && *fate == SGT_TIR) *fate = SGT_PASSED;
        if (*fate != SGT_PASSED) return false;
    }
    return true;
}

/* --------------------------------------------------------------------- the error */

static double size_of(sgt_vec3 a) { return sqrt(dot(a, a)); }

/* What the rounding at one element adds.  x: the adjoints behind it; in, front: those inside and in front. */
static double at_element(const chain_link *c, const sgt_hit *hit, bool turns, sgt_vec3 point,
                         sgt_vec3 direction, const chain_inside *in, sgt_vec3 front)
{
    double by = size_of(point) * hit->p_err;
    if (!turns) return by;
    double n2 = dot(c->n, c->n), n = sqrt(n2), behind = fabs(c->by_S) * n;
    double steep = c->n.z == 1 ? n2 : 1;
    by += size_of(direction) * SGT_U * (c->bends ? 16 + 16 * behind : 8);
    by += size_of(in->n) * n * steep * 64 * SGT_U;
    return by + size_of(front) * 8 * SGT_U;
}

double sgt_aim_error(const aim_task *task, const sgt_ray *launch, double *grain)
{
    enum { AXES = 2 };
    double error[AXES] = {0, 0}, ulp[AXES];
    chain_back back[AXES] = {{{1, 0, 0}, {0, 0, 0}, 0, 0}, {{0, 1, 0}, {0, 0, 0}, 0, 0}};
    for (size_t i = task->stop + 1; i-- > 0;) {
        const sgt_element *e = &task->e[i];
        const sgt_hit *hit = &task->passages[i].hit;
        bool turns = i < task->stop;
        chain_link c;
        chain_at(e, chain_direction(task->e, i, launch, task->passages),
                 chain_index(task->e, i, task->index_before), &task->passages[i], &c);
        if (c.bends && turns) chain_second(chain_surface(e->surface), &c);
        for (int k = 0; k < AXES; k++) {
            sgt_vec3 point = into(&e->pose, back[k].p), direction = into(&e->pose, back[k].d), front;
            if (i == task->stop) point = back[k].p, direction = back[k].d; /* in its frame */
            back[k].p = point, back[k].d = direction;
            chain_inside in = chain_backward(&c, turns, &back[k], &front);
            error[k] += at_element(&c, hit, turns, point, direction, &in, front);
            back[k].p = out_of(&e->pose, back[k].p), back[k].d = out_of(&e->pose, back[k].d);
        }
    }
    double length = unit_of(launch->d).length;
    for (int k = 0; k < AXES; k++)
        ulp[k] =
            2 * SGT_U *
            (size_of(back[k].p) * absolute(launch->o) + size_of(back[k].d) * absolute(launch->d) / length);
    *grain = ulp[0] + ulp[1];
    return 1.5 * sqrt(error[0] * error[0] + error[1] * error[1]);
}

/* n d - n' d' at an element, and what its hit adds to the error of the path. */
static double of_path(const sgt_element *e, const chain_link *c, const sgt_passage *passage, double before)
{
    const double behind = e->index == SGT_MIRROR || e->index == 0 ? c->n1 : e->index;
    const bool on = !is_zero(passage->direction);
    sgt_vec3 kick = on ? plus_times(times(c->n1, c->d), -behind, passage->direction) : (sgt_vec3){0, 0, 0};
    const double way = c->n1 * fabs(c->t), phase = fabs(passage->opl - before) - way;
    return size_of(kick) * passage->hit.p_err + c->n1 * passage->hit.t_err + 5 * SGT_U * way +
           SGT_U * fabs(passage->opl) + (e->phase ? 8 * SGT_U * fabs(phase) : 0);
}

bool sgt_trace_error(size_t n, const sgt_element e[], double index_before, const sgt_ray *launch,
                     const sgt_passage passages[], sgt_end_error *out)
{
    const double none = (double)NAN;
    *out = (sgt_end_error){none, none, none};
    for (size_t i = 0; i < n; i++)
        if (!(passages[i].hit.status > 0)) return false;
    *out = (sgt_end_error){0, 0, 0};
    if (n == 0) return true;
    for (size_t i = 0; i < n; i++) {
        chain_link c;
        chain_at(&e[i], chain_direction(e, i, launch, passages), chain_index(e, i, index_before),
                 &passages[i], &c);
        out->path += of_path(&e[i], &c, &passages[i], i > 0 ? passages[i - 1].opl : 0);
    }
    const aim_task task = {.stop = n - 1, .e = e, .index_before = index_before,
                           .passages = (sgt_passage *)(uintptr_t)passages};
    out->point = sgt_aim_error(&task, launch, &out->grain);
    return true;
}
