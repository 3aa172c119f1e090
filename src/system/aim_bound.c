/* aim_bound.c - a ray that is traced whatever clips it, and a bound on the error of its end.
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
 * A PHASE puts the direction off by 8 u in each component, and W by 64 u of its size (phase.h).  If |n| in
 * front is below 2^-50 n1 / n2, nothing is known of the direction.
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
 * THE SAME WITH A PHASE.  Fermat's principle does not hold: W has no eikonal (phase.h).  So the errors of all
 * elements go through the derivatives, as those of the point do.  The number at the end is L - n d . p: the
 * path to the foot of the perpendicular from a fixed point near the end.  It has the adjoints A_L = 1,
 * A_p = -n d.  A point that is off by dp makes the last side of the polygon longer by d . dp, so its error
 * counts by A_p' + n d.  Without a phase that is n d - n' d' again.  What is added at a phase is W for p and
 * d as they stand.  The numbers of the launch ray have a say in it, too: by A_o + n d, as a launch point that
 * is moved along the ray makes the path longer by as much, and is no error of a direction; and by A_d. */
#include "aim.h"

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

/* How far the gradient is off across itself. */
static double of_gradient(sgt_surface s, const chain_link *c)
{
    const double n2 = dot(c->n, c->n), n = sqrt(n2), across = sqrt(c->n.x * c->n.x + c->n.y * c->n.y);
    if (s.ops == &sgt_conic_ops) return SGT_U * across * (2 + 4 * (1 + fabs(1 - c->n.z)) / n);
    if (s.ops != &sgt_even_asphere_ops) return 64 * SGT_U * n * (c->n.z == 1 ? n2 : 1);
    const sgt_even_asphere *a = s.self;
    const double r2 = c->p.x * c->p.x + c->p.y * c->p.y, r = sqrt(r2), w = (1 + a->k) * a->c * a->c * r2;
    double terms = 0;
    for (int i = 8; i-- > 0;) terms = terms * r2 + (2 * i + 2) * fabs(a->a[i]);
    return SGT_U * (8 * (1 + fabs(w) / (1 - w)) * fabs(a->c) * r / sqrt(1 - w) + 22 * terms * r);
}

/* How far the direction behind is off, for the gradient and the direction in front as they are. */
static double of_bending(const chain_link *c)
{
    const double n = sqrt(dot(c->n, c->n)), fn = fabs(c->f) * n, behind = 1 / (fabs(c->by_S) * n);
    const double q = c->r * fabs(dot(c->d, c->n)) / n + behind;
    const sgt_vec3 cross = cross_product(c->after, c->n);
    const double sine = sqrt(dot(cross, cross)) / n, part = 6 + (6 * c->r + 2 + 6 / behind) / q;
    return SGT_U * (c->r + fn + 3 + sine * (fn * part + 1 / behind));
}

/* What the rounding at one element adds.  direction: the adjoint behind it; opl: that of the path; in, front:
 * those inside and in front. */
static double at_element(const sgt_element *e, const chain_link *c, const sgt_hit *hit, bool turns,
                         sgt_vec3 direction, double opl, const chain_inside *in, sgt_vec3 front)
{
    const double frame = is_turned(&e->pose) ? 8 * SGT_U : 0;
    double by = size_of(plus_times(in->p, opl * c->n1, c->d)) * hit->p_err;
    if (c->phased) {
        const phase_off off = phase_off_of(e->phase, c->n1, c->n2, c->p, c->d);
        by += size_of(front) * frame + (turns ? absolute(direction) * off.direction : 0);
        by += c->passed == 1 ? fabs(opl) * off.path : 0;
    }
    if (!turns) return by;
    by += size_of(direction) * frame + (c->phased ? 0 : size_of(front) * frame);
    if (!c->bends) return by;
    return by + size_of(direction) * of_bending(c) + size_of(in->n) * of_gradient(in_set(e->surface), c);
}

enum { ERROR_ROWS = 3, OF_PATH = 2 }; /* x, y, and the path */

/* Of an element i of the trace. */
static void link_at(const aim_task *task, const sgt_ray *launch, size_t i, chain_link *c)
{
    chain_at(&task->e[i], chain_direction(task->e, i, launch, task->passages),
             chain_index(task->e, i, task->index_before), &task->passages[i], c);
}

/* Of the first `rows`: the errors, and what an ulp of each number of the launch ray does. */
static void through_derivatives(const aim_task *task, const sgt_ray *launch, int rows, double error[],
                                double ulp[])
{
    chain_back back[ERROR_ROWS] = {{{1, 0, 0}, {0, 0, 0}, 0, 0}, {{0, 1, 0}, {0, 0, 0}, 0, 0}};
    for (int k = 0; k < rows; k++) error[k] = 0;
    for (size_t i = task->stop + 1; i-- > 0;) {
        const sgt_element *e = &task->e[i];
        bool turns = i < task->stop;
        chain_link c;
        link_at(task, launch, i, &c);
        if (c.bends && turns) chain_second(chain_surface(e->surface), &c);
        if (i == task->stop) back[OF_PATH] = (chain_back){times(-c.n1, c.d), {0, 0, 0}, 1, 0};
        for (int k = 0; k < rows; k++) {
            chain_back *x = &back[k];
            if (turns) x->p = into(&e->pose, x->p), x->d = into(&e->pose, x->d); /* else in its frame */
            sgt_vec3 direction = x->d, front;
            chain_inside in = chain_backward(&c, turns, x, &front);
            error[k] += at_element(e, &c, &task->passages[i].hit, turns, direction, x->opl, &in, front);
            x->p = out_of(&e->pose, x->p), x->d = out_of(&e->pose, x->d);
        }
    }
    const unit_launch from = unit_of(launch->d);
    const double index = task->index_before == 0 ? 1 : task->index_before;
    for (int k = 0; k < rows; k++) {
        const sgt_vec3 by = plus_times(back[k].p, back[k].opl * index, from.d);
        ulp[k] = 2 * SGT_U *
                 (size_of(by) * absolute(launch->o) + size_of(back[k].d) * absolute(launch->d) / from.length);
    }
}

/* Of both coordinates together. */
static double of_point(const double error[], const double ulp[], double *grain)
{
    *grain = ulp[0] + ulp[1];
    return 1.5 * sqrt(error[0] * error[0] + error[1] * error[1]);
}

double sgt_aim_error(const aim_task *task, const sgt_ray *launch, double *grain)
{
    double error[ERROR_ROWS], ulp[ERROR_ROWS];
    through_derivatives(task, launch, OF_PATH, error, ulp);
    return of_point(error, ulp, grain);
}

/* A point in global axes. */
typedef struct far_point { twofold x[3]; } far_point;

static far_point at_point(const sgt_pose *pose, sgt_vec3 p)
{
    const double by[3] = {p.x, p.y, p.z}, origin[3] = {pose->origin.x, pose->origin.y, pose->origin.z},
                 ex[3] = {pose->ex.x, pose->ex.y, pose->ex.z}, ey[3] = {pose->ey.x, pose->ey.y, pose->ey.z},
                 ez[3] = {pose->ez.x, pose->ez.y, pose->ez.z};
    far_point out;
    for (int k = 0; k < 3; k++) {
        out.x[k] = two_sum(origin[k], is_turned(pose) ? 0 : by[k]);
        if (!is_turned(pose)) continue;
        out.x[k] = twofold_sum(out.x[k], two_product(p.x, ex[k]));
        out.x[k] = twofold_sum(out.x[k], two_product(p.y, ey[k]));
        out.x[k] = twofold_sum(out.x[k], two_product(p.z, ez[k]));
    }
    return out;
}

static twofold length_between(const far_point *a, const far_point *b)
{
    twofold sum = {0, 0};
    for (int k = 0; k < 3; k++) {
        const twofold by = twofold_difference(a->x[k], b->x[k]);
        sum = twofold_sum(sum, twofold_product(by, by));
    }
    return sum.hi > 0 ? twofold_root(sum) : (twofold){0, 0};
}

/* |n d - n' d'| p_err */
static double of_kick(const chain_link *c, const sgt_passage *passage)
{
    if (is_zero(passage->direction)) return 0;
    sgt_vec3 kick = plus_times(times(c->n1, c->d), -c->n2, passage->direction);
    return size_of(kick) * passage->hit.p_err;
}

static bool any_phase(size_t n, const sgt_element e[])
{
    for (size_t i = 0; i < n; i++)
        if (e[i].phase) return true;
    return false;
}

bool sgt_trace_error(size_t n, const sgt_element e[], double index_before, const sgt_ray *launch,
                     const sgt_passage passages[], sgt_end_error *out)
{
    static const sgt_pose global = {0};
    const double none = (double)NAN;
    *out = (sgt_end_error){none, none, none, none, {0}};
    for (size_t i = 0; i < n; i++)
        if (!(passages[i].hit.status > 0)) return false;
    *out = (sgt_end_error){.point = 0};
    if (n == 0) return true;
    const bool phases = any_phase(n, e);
    const aim_task task = {.stop = n - 1, .e = e, .index_before = index_before,
                           .passages = (sgt_passage *)(uintptr_t)passages};
    double error[ERROR_ROWS], ulp[ERROR_ROWS];
    far_point from = at_point(&global, launch->o);
    twofold path = {0, 0};
    for (size_t i = 0; i < n; i++) {
        chain_link c;
        link_at(&task, launch, i, &c);
        const far_point to = at_point(&e[i].pose, passages[i].hit.p);
        path = twofold_sum(path, twofold_scaled(length_between(&from, &to), c.t < 0 ? -c.n1 : c.n1));
        if (c.phased && c.passed == 1) {
            const thin_lens by = thin_lens_of(e[i].phase, c.n1, c.n2, e[i].index == SGT_MIRROR);
            path = twofold_sum(path, twofold_of(phase_path(by, c.p, c.d)));
        }
        if (!phases) out->path += of_kick(&c, &passages[i]);
        if (is_turned(&e[i].pose)) out->path += 8 * SGT_U * size_of(passages[i].hit.p) * (c.n1 + c.n2);
        from = to;
    }
    out->path += fabs(twofold_difference(twofold_of(passages[n - 1].opl), path).hi);
    through_derivatives(&task, launch, phases ? ERROR_ROWS : OF_PATH, error, ulp);
    out->point = of_point(error, ulp, &out->grain);
    if (phases) out->path += 1.5 * error[OF_PATH], out->path_grain = ulp[OF_PATH];
    return true;
}
