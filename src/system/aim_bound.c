/* aim_bound.c - a ray that is traced whatever clips it, and a bound on the error of its end.
 *
 * THE ERROR OF THE END.  p_err of a hit is about the ray from the hit before as it stands in doubles
 * (system.h).  So there is one error at each element, and each goes through the rest of the lens.  With A the
 * derivatives of the end by the point p and the direction d' at an element (chain.h), to first order x at the
 * end is off by the sum of
 *
 *     |A_p| p_err      the point
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
 * tests/sensitivity/test_aim.cpp and tests/lens/test_analysis.py hold the sum against 113 bits and 50
 * digits.  A half is added for the second order.
 *
 * THE ERROR OF THE PATH.  Let the path be that of the polygon through the points as computed, and move these
 * to those of the exact ray.  By Fermat's principle the change is, to first order, the sum of
 * (n d - n' d') . dp: that vector is along the normal (with a phase: along it but for the gradient of the
 * phase, which cancels), so only the part of dp across the surface counts, and that is p_err at most.  How
 * far opl is from the path of that polygon is computed, in twice the precision.  Where frames are turned,
 * their axes are orthogonal to some u only, and lengths are off by as much of a point's distance from the
 * origin. */
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

/* How far the gradient is off across itself. */
static double of_gradient(sgt_surface s, const chain_link *c)
{
    const double n2 = dot(c->n, c->n), n = sqrt(n2), across = sqrt(c->n.x * c->n.x + c->n.y * c->n.y);
    if (s.ops == &sgt_conic_ops) return SGT_U * across * (2 + 4 * (1 + fabs(1 - c->n.z)) / n);
    if (s.ops != &sgt_asphere_ops) return 64 * SGT_U * n * (c->n.z == 1 ? n2 : 1);
    const sgt_asphere *a = s.self;
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

/* What the rounding at one element adds.  point, direction: the adjoints behind it; in, front: those inside
 * and in front. */
static double at_element(const sgt_element *e, const chain_link *c, const sgt_hit *hit, bool turns,
                         sgt_vec3 point, sgt_vec3 direction, const chain_inside *in, sgt_vec3 front)
{
    const double frame = is_turned(&e->pose) ? 8 * SGT_U : 0;
    double by = size_of(point) * hit->p_err;
    if (!turns) return by;
    by += size_of(direction) * frame + size_of(front) * frame;
    if (!c->bends) return by;
    return by + size_of(direction) * of_bending(c) + size_of(in->n) * of_gradient(in_set(e->surface), c);
}

double sgt_aim_error(const aim_task *task, const sgt_ray *launch, double *grain)
{
    enum { AXES = 2 };
    double error[AXES] = {0, 0}, ulp[AXES];
    chain_back back[AXES] = {{{1, 0, 0}, {0, 0, 0}, 0, 0}, {{0, 1, 0}, {0, 0, 0}, 0, 0}};
    for (size_t i = task->stop + 1; i-- > 0;) {
        sgt_element bare = task->e[i];
        const sgt_element *e = &bare;
        const sgt_hit *hit = &task->passages[i].hit;
        bool turns = i < task->stop;
        if (!turns) bare.phase = NULL; /* what the last element does to light moves no point of it */
        chain_link c;
        chain_at(e, chain_direction(task->e, i, launch, task->passages),
                 chain_index(task->e, i, task->index_before), &task->passages[i], &c);
        if (c.bends && turns) chain_second(chain_surface(e->surface), &c);
        for (int k = 0; k < AXES; k++) {
            sgt_vec3 point = into(&e->pose, back[k].p), direction = into(&e->pose, back[k].d), front;
            if (i == task->stop) point = back[k].p, direction = back[k].d; /* in its frame */
            back[k].p = point, back[k].d = direction;
            chain_inside in = chain_backward(&c, turns, &back[k], &front);
            error[k] += at_element(e, &c, hit, turns, point, direction, &in, front);
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

/* What opl has gained at an element with a phase is taken as it is: its stretch, the phase, and the sum. */
static double of_phase(const chain_link *c, const sgt_passage *passage, double before)
{
    const double way = c->n1 * fabs(c->t), phase = passage->opl - before - c->n1 * c->t;
    return c->n1 * passage->hit.t_err + SGT_U * (5 * way + fabs(passage->opl) + 8 * fabs(phase));
}

bool sgt_trace_error(size_t n, const sgt_element e[], double index_before, const sgt_ray *launch,
                     const sgt_passage passages[], sgt_end_error *out)
{
    static const sgt_pose global = {0};
    const double none = (double)NAN;
    *out = (sgt_end_error){none, none, none};
    for (size_t i = 0; i < n; i++)
        if (!(passages[i].hit.status > 0)) return false;
    *out = (sgt_end_error){0, 0, 0};
    if (n == 0) return true;
    far_point from = at_point(&global, launch->o);
    twofold path = {0, 0};
    for (size_t i = 0; i < n; i++) {
        chain_link c;
        chain_at(&e[i], chain_direction(e, i, launch, passages), chain_index(e, i, index_before),
                 &passages[i], &c);
        const far_point to = at_point(&e[i].pose, passages[i].hit.p);
        const double before = i > 0 ? passages[i - 1].opl : 0;
        const twofold piece = twofold_scaled(length_between(&from, &to), c.t < 0 ? -c.n1 : c.n1);
        if (e[i].phase) {
            path = twofold_sum(path, two_sum(passages[i].opl, -before));
            out->path += of_phase(&c, &passages[i], before);
        } else {
            path = twofold_sum(path, piece);
            out->path += of_kick(&c, &passages[i]);
            if (is_turned(&e[i].pose)) out->path += 8 * SGT_U * size_of(passages[i].hit.p) * (c.n1 + c.n2);
        }
        from = to;
    }
    out->path += fabs(twofold_difference(twofold_of(passages[n - 1].opl), path).hi);
    const aim_task task = {.stop = n - 1, .e = e, .index_before = index_before,
                           .passages = (sgt_passage *)(uintptr_t)passages};
    out->point = sgt_aim_error(&task, launch, &out->grain);
    return true;
}
