// SPDX-License-Identifier: MIT
/* aim_bound.c - a ray that is traced whatever clips it, and a bound on the error of its end.  The formulas
 * are in end_error.h; error_batch.c has them in loops over rays.
 *
 * THE ERROR OF THE END.  p_err of a hit is about the ray from the hit before as it stands in doubles
 * (system.h).  So there is one error at each element, and each goes through the rest of the lens.  With A the
 * derivatives of the end by the point p and the direction d' at an element (chain.h), to first order x at the
 * end is off by the sum of
 *
 *     |A_p'| p_err     the point, and by it the gradient or the phase there (chain.h)
 *     |A_d'| b         the bending, below; and 8 u for the frame behind, if it is turned
 *     |A_n| g          the gradient, below
 *     |A_d| 8 u        the frame in front, if it is turned
 *
 * Of the point, x and y are off together: A has two rows then, and |A| is how long A v is at most for a v of
 * unit length (longest_of).
 *
 * THE BENDING is d' = r d + f n (trace.h).  Its roundings and those of the unit length are at most
 * u (r + |f n| + 3).  f itself is off by a part e_f; that moves d' along n, and across d' by |f n| e_f
 * times the sine behind the surface.  With the cosines c1 and c2 in front and behind and q = r c1 + c2, f
 * is k / q but for |n|.  Three roundings are in r and three in g (absolute: of d and n), and c2 = sqrt(Q)
 * is off by 6 u / c2, as Q is by at most 12 u (observed: trace.h), so
 *
 *     e_f <= u (6 + (6 r + 2 + 6 / c2) / q).
 *
 * The rounding of r turns d' by u tan.
 *
 * THE GRADIENT.  Its length has no say.  Of a conic it is (-c x, -c y, 1 - (1 + k) c z): off by 2 u n_xy,
 * and by 4 u (1 + |(1 + k) c z|) along z, of which n_xy / |n| is across n; of a plane by nothing.  Of an
 * even asphere it is (-x s, -y s, 1): each term of the slope is off by 22 u of it (a product, and Horner's
 * rule over eight), the conic's by 8 u (1 + w / (1 - w)) with w = (1 + k) c^2 r^2.  Of others
 * 64 u |n| (1 + slope^2) is a guess.
 *
 * AN IDEAL LENS puts the direction off by 8 u in each component, and W by 64 u of its size (phase.h).  If
 * |n| in front is below 2^-50 n1 / n2, nothing is known of the direction.  A PHASE IN WAVES: waves.h.
 *
 * tests/sensitivity/test_aim.cpp, test_ideal.cpp and tests/lens/test_analysis.py hold the sum against 113
 * bits and 50 digits.  A half is added for the second order.
 *
 * THE ERROR OF THE PATH.  Let the path be that of the polygon through the points as computed, and move these
 * to those of the exact ray.  By Fermat's principle the change is, to first order, the sum of
 * (n d - n' d') . dp: that vector is along the normal, so only the part of dp across the surface counts, and
 * that is p_err at most.  How far opl is from the path of that polygon is computed, in twice the precision.
 * Where frames are turned, their axes are orthogonal to some u only, and lengths are off by as much of a
 * point's distance from the origin.
 *
 * THE SAME WITH A PHASE.  Fermat's principle does not hold at an ideal lens: W has no eikonal (phase.h).
 * So the errors of all elements go through the derivatives, as those of the point do.  The number at the end
 * is L - n d . p: the path to the foot of the perpendicular from a fixed point near the end.  It has the
 * adjoints A_L = 1, A_p = -n d.  A point that is off by dp makes the last side of the polygon longer by
 * d . dp, so its error counts by A_p' + n d.  Without a phase that is n d - n' d' again.  What is added at a
 * phase is W for p and d as they stand.  The numbers of the launch ray have a say in it, too: by A_o + n d,
 * as a launch point that is moved along the ray makes the path longer by as much, and is no error of a
 * direction; and by A_d. */
#include "aim.h"
#include "end_error.h"

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
        if (i == stop && (*fate == SGT_TIR || *fate == SGT_EVANESCENT)) *fate = SGT_PASSED;
        if (*fate != SGT_PASSED) return false;
    }
    return true;
}

/* --------------------------------------------------------------------- the error */

enum { ERROR_ROWS = 3, OF_PATH = 2 }; /* x, y, and the path */
enum { ERROR_OF_POINT, ERROR_OF_PATH, ERRORS };

/* Of an element i of the trace. */
static void link_at(const aim_task *task, const sgt_ray *launch, size_t i, chain_link *c)
{
    chain_at(&task->e[i], chain_direction(task->e, i, launch, task->passages),
             chain_index(task->e, i, task->index_before), &task->passages[i], c);
}

/* Rows k and, if `two`, k + 1 through an element; returns what that adds to the error. */
static double error_through(const sgt_element *e, const chain_link *c, bool turns, double p_err, bend_off off,
                            bool two, chain_back back[])
{
    const bool turned = is_turned(&e->pose);
    error_steps s = {.two = two};
    for (int k = 0; k <= two; k++) {
        chain_back *x = &back[k];
        if (turns) x->p = into(&e->pose, x->p), x->d = into(&e->pose, x->d); /* else in its frame */
        s.direction[k] = x->d, s.by[k] = chain_backward(c, turns, *x);
        *x = s.by[k].x;
        x->p = out_of(&e->pose, x->p), x->d = out_of(&e->pose, x->d);
    }
    const double more = c->phased ? of_phase(e, c, turns, p_err, s) : 0;
    return of_element(c->bends && !c->phased, c->phased, *c, turns, turned, p_err, off, s) + more;
}

/* The errors of the point and, if `path`, of the path; what an ulp of each number of the launch ray does. */
static void through_derivatives(const aim_task *task, const sgt_ray *launch, bool path, double error[],
                                double ulp[])
{
    const int rows = path ? ERROR_ROWS : OF_PATH;
    chain_back back[ERROR_ROWS] = {{{1, 0, 0}, {0, 0, 0}, 0, 0}, {{0, 1, 0}, {0, 0, 0}, 0, 0}};
    error[ERROR_OF_POINT] = error[ERROR_OF_PATH] = 0;
    for (size_t i = task->stop + 1; i-- > 0;) {
        const sgt_element *e = &task->e[i];
        const sgt_surface s = chain_surface(e->surface);
        const bool turns = i < task->stop;
        const double p_err = task->passages[i].hit.p_err;
        bend_off off = {0, 0};
        chain_link c;
        link_at(task, launch, i, &c);
        if (c.bends && turns) {
            chain_second(s, &c);
            if (!c.phased) off = bend_off_of(gradient_kind_of(s), s.self, c);
            if (!c.phased && sgt_has_kinks(s))
                off.gradient = larger(off.gradient, sgt_kink_off(s, c.p, p_err, c.n));
        }
        if (i == task->stop) back[OF_PATH] = (chain_back){times(-c.n1, c.d), {0, 0, 0}, 1, 0};
        error[ERROR_OF_POINT] += error_through(e, &c, turns, p_err, off, true, back);
        if (path) error[ERROR_OF_PATH] += error_through(e, &c, turns, p_err, off, false, &back[OF_PATH]);
    }
    const unit_launch from = unit_of(launch->d);
    const double index = task->index_before == 0 ? 1 : task->index_before;
    for (int k = 0; k < rows; k++) ulp[k] = of_launch(back[k], index, launch->o, launch->d, from);
}

double sgt_aim_error(const aim_task *task, const sgt_ray *launch, double *grain)
{
    double error[ERRORS], ulp[ERROR_ROWS];
    through_derivatives(task, launch, false, error, ulp);
    *grain = ulp[0] + ulp[1];
    return of_point(error[ERROR_OF_POINT]);
}

bool sgt_any_phase(size_t elements, const sgt_element e[])
{
    for (size_t i = 0; i < elements; i++)
        if (e[i].phase) return true;
    return false;
}

bool sgt_trace_error(size_t elements, const sgt_element e[], double index_before, const sgt_ray *launch,
                     const sgt_passage passages[], sgt_end_error *out)
{
    static const sgt_pose global = {0};
    const double none = (double)NAN;
    *out = (sgt_end_error){none, none, none, none, {0}};
    for (size_t i = 0; i < elements; i++)
        if (!(passages[i].hit.status > 0)) return false;
    *out = (sgt_end_error){.point = 0};
    if (elements == 0) return true;
    const bool phases = sgt_any_phase(elements, e);
    const aim_task task = {.stop = elements - 1, .e = e, .index_before = index_before,
                           .passages = (sgt_passage *)(uintptr_t)passages};
    double error[ERRORS], ulp[ERROR_ROWS];
    far_point from = far_point_of(&global, false, launch->o);
    twofold path = {0, 0};
    for (size_t i = 0; i < elements; i++) {
        const bool turned = is_turned(&e[i].pose);
        const double p_err = passages[i].hit.p_err;
        chain_link c;
        link_at(&task, launch, i, &c);
        const far_point to = far_point_of(&e[i].pose, turned, c.p);
        const twofold by = length_between(from, to);
        out->path += of_sum(path, by, c.n1, to);
        path = path_with(path, by, c.n1, c.t);
        if (c.waves && c.passed == 1) {
            path = kick_path(path_per_wave(c.waves), c.by_waves.at.w, path);
        } else if (c.phased && c.passed == 1) {
            const thin_lens lens = thin_lens_of(e[i].phase, c.n1, c.n2, e[i].index == SGT_MIRROR);
            path = twofold_sum(path, twofold_of(phase_path(lens, c.p, c.d)));
        }
        if (!phases) out->path += of_kick(c.n1, c.n2, c.d, c.after, p_err);
        if (turned) out->path += of_axes(c.p, c.n1, c.n2);
        from = to;
    }
    out->path += fabs(twofold_difference(twofold_of(passages[elements - 1].opl), path).hi);
    through_derivatives(&task, launch, phases, error, ulp);
    out->point = of_point(error[ERROR_OF_POINT]), out->grain = ulp[0] + ulp[1];
    if (phases) out->path += 1.5 * error[ERROR_OF_PATH], out->path_grain = ulp[OF_PATH];
    out->path = told_path(out->path);
    return true;
}
