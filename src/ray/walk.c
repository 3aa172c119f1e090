// SPDX-License-Identifier: MIT
/* walk.c - evaluations along a ray of any surface, brackets, and the roots they hold.
 *
 * F is evaluated at the local point x + tau d.  Rounding of that point changes F by up to e_i |F_i| per
 * coordinate.  That is added to the surface's own `rounding`.
 *
 * A root is first looked for by the quick form (step.h says what it claims), then by solve/root.c.
 *
 * A POLE IS NO ROOT.  F changes sign at a pole of odd order, too.  As the bracket shrinks, |F| behaves
 * differently:
 *
 *     at a root    |F| falls
 *     at a jump    |F| stays
 *     at a pole    |F| grows
 *
 * Bounds on rounding do not help: at a pole they grow as fast as |F|.  The quick form tells a root by two
 * signs: |F| is greater beside it, and to its right F has the sign of the slope.  To the right of a pole F
 * has the other sign.
 *
 * The careful path does not trust slopes.  A root is suspicious if its |F| is not the least of its search,
 * or not far below the greatest (the seed itself may be next to a pole).  Such a root is looked at from
 * 64, 256, 1024 ... times its error.  If |F| falls outward on a side, it is a pole, and is skipped.
 *
 * F MAY BE NOISIER than it says, if it offers no `rounding`.  Then what is left of a pole is 1 / noise, which
 * rises, falls and changes sign by chance.  One look that rises says nothing.  So four looks in a row have to
 * agree on each side, which noise does in less than one of 500 times.  Where they nowhere agree, the root is
 * skipped.  The price: a suspicious root is skipped, too, if |F| rises over less than 4096 errors beside it.
 *
 * What is left: 1 / F of two values only, over 16384 errors, is a jump to all that can be seen.  And the
 * quick form, from a seed inside the noise of a pole, may by chance see the signs of a root.
 *
 * A jump is a change of sign, and a hit. */
#include "walk.h"

#include "../solve/ways.h"
#include "vicinity.h"

static double own_rounding(const walk *w, sgt_vec3 p, double f)
{
    const sgt_surface_ops *ops = w->s.ops;
    double own = 0;
    bool known = is_catalogue(ops) && ops->own_->roundings &&
                 ops->own_->roundings(w->s.self, &w->shared, 1, (sgt_points){{&p.x, &p.y, &p.z}}, &f, &own);
    if (w->nearby) own += sgt_noise_at(w->noise[0], w->noise[1], w->noise[2], p.x * p.x + p.y * p.y);
    if (!(known && own >= 0) && ops->rounding) own = ops->rounding(w->s.self, p);
    return own >= 0 ? own : is_catalogue(ops) ? HUGE_VAL : 0; /* a NaN or negative bound: none is known */
}

int sgt_walk_sign(const walk *w, const point *at)
{
    return (int)sign_of(at->g, at->g_err + (at->glanced ? own_rounding(w, at->at.p, at->g) : 0));
}

/* sgt_walk_glance, into *e. */
SGT_INLINE void glance(walk *w, point *e, double tau, sgt_move move, double lo, double hi, double last)
{
    const local *q = &w->q;
    sgt_vec3 p = {q->x + tau * q->l, q->y + tau * q->m, q->z + tau * q->n}, grad = {0, 0, 0};
    *e = (point){.tau = tau, .at.p = p};
    if (over(w)) {
        e->g = e->at.slope = (double)NAN;
        return;
    }
    e->g = w->s.ops->value(w->s.self, p, &grad);
    e->at = around_of(q, tau, p, grad, 0);
    e->g_err = e->at.place;
    e->glanced = w->s.ops->rounding && !close_of(e->g, e->at.slope, e->at.place, last, w->told.opt->f_tol);
    if (!e->glanced) e->g_err += own_rounding(w, p, e->g);
    w->defined = w->defined || !isnan(e->g);
    tell(&w->told, move, (q->t0 + tau) * q->scale, e->g, e->at.slope / q->scale, (q->t0 + lo) * q->scale,
         (q->t0 + hi) * q->scale);
}

point sgt_walk_glance(walk *w, double tau, sgt_move move, double lo, double hi, double last)
{
    point e;
    glance(w, &e, tau, move, lo, hi, last);
    return e;
}

point sgt_walk_look(walk *w, double tau, sgt_move move, double lo, double hi)
{
    return sgt_walk_glance(w, tau, move, lo, hi, (double)NAN);
}

bool sgt_walk_quick(walk *w, sgt_interval in, double tau, double last, double first, walked *found)
{
    WENT(WAY_QUICK);
    point *at = &found->at;
    const searched stretch = {in.lo, in.hi, larger(w->least, w->steep)};
    sgt_root r = root_quickly(stretch, tau, last, first, w->t_tol, w->told.opt->f_tol);
    do {
        glance(w, at, r.t, r.move, in.lo, in.hi, r.private_.step);
        if (w->told.stopped) return false;
        r.g_err = at->g_err;
        newton s = root_newton(&r, at->g, at->at.slope);
        if (s.ready >= 0 && at->glanced) r.private_.own = own_rounding(w, at->at.p, at->g);
        if (!root_quick_next(&r, s, at->g, at->at.slope)) break;
    } while (r.private_.quick == QUICK_NEWTON);
    while (!r.private_.done) {
        point beside = sgt_walk_look(w, r.t, SGT_PROBE, in.lo, in.hi);
        if (w->told.stopped) return false;
        r.g_err = beside.g_err;
        root_beside(&r, beside.g);
    }
    found->tau_err = r.t_err, found->past = r.hi;
    return r.status == SGT_HIT;
}

bool sgt_walk_quick_miss(walk *w, double lo, double hi)
{
    if (!(lo > -HUGE_VAL && hi < HUGE_VAL) || over(w)) return false;
    point a = sgt_walk_look(w, lo, SGT_SEED, lo, hi), b = sgt_walk_look(w, hi, SGT_SEED, lo, hi);
    int first = sign_at(&a), last = sign_at(&b);
    return !w->told.stopped && (first * last > 0 || gone_by(first, last, w->q.n, w->least));
}

sgt_root sgt_walk_begin(walk *w, sgt_span span)
{
    w->lowest = HUGE_VAL, w->highest = 0;
    return sgt_root_begin(
        span, &(sgt_options){.t_tol = w->t_tol, .f_tol = w->told.opt->f_tol, .max_evals = w->told.budget});
}

void sgt_walk_solve(walk *w, sgt_root *r, point *at)
{
    while (!over(w)) {
        *at = sgt_walk_look(w, r->t, r->move, r->lo, r->hi);
        if (w->told.stopped) break;
        if (fabs(at->g) < w->lowest) w->lowest = fabs(at->g);
        if (fabs(at->g) > w->highest) w->highest = fabs(at->g);
        r->g_err = at->g_err;
        if (!sgt_root_next(r, at->g, at->at.slope)) break;
    }
}

/* What the looks from `at` outward on one side say: 1, it may be a root or a jump; -1, it may not; 0, F
 * cannot be asked there.  The first look is 64 errors away.  RUN looks of one sign that each rise, or each
 * fall, decide, wherever they begin.  So do RUN + 1 looks of one sign that rise or stay, if none before fell.
 * If the stretch ends first, none may fall.  Where F's rounding is bounded, one look that certainly rises
 * decides. */
static int side_of(walk *w, const point *at, double e, int side)
{
    enum { LOOKS = 20, RUN = 4 };
    bool bounded = w->s.ops->rounding, none_fell = true;
    int run = 0, held = 0, kind_before = 0, sign_before = 0, says = 0;
    double before = fabs(at->g), far = 64 * e;
    for (int i = 0; i < LOOKS; i++, far *= 4) {
        double tau = at->tau + side * far;
        if (!(tau >= w->lo && tau <= w->hi)) break;
        point p = sgt_walk_look(w, tau, SGT_PROBE, at->tau, tau);
        if (over(w)) return -1;
        if (isnan(p.g)) break;
        double size = fabs(p.g);
        int sign = sign_at(&p), kind = size > 1.25 * before ? 1 : 1.25 * size < before ? -1 : 0;
        bool finite = size < HUGE_VAL, certain = sign != 0 && finite, same = sign == sign_before;
        if (bounded && finite && size - p.g_err > fabs(at->g) + at->g_err) return 1;
        none_fell = none_fell && certain && kind >= 0;
        run = !certain ? 0 : run > 0 && kind == kind_before && same ? run + 1 : 1;
        held = same ? held + 1 : 1;
        says = none_fell && held == i + 1 ? 1 : -1;
        if (run >= RUN && kind != 0) return kind;
        if (held > RUN && none_fell) return 1;
        kind_before = kind, sign_before = sign, before = size;
    }
    return says;
}

/* Is `at`, the end of a search within tau_err, a pole, as far as its sides can be asked?  Also true if the
 * search is over before. */
static bool is_pole(walk *w, const point *at, double tau_err)
{
    double place = larger(larger(at->at.ex, at->at.ey), at->at.ez);
    double e = larger(tau_err, place * DBL_EPSILON); /* rounding of the point hides what is nearer */
    return side_of(w, at, e, -1) < 0 || side_of(w, at, e, 1) < 0;
}

/* Adds the root at `at`, if it is accepted. */
static bool walk_take(walk *w, sgt_status status, point at, double tau_err)
{
    if (!(at.g_err < HUGE_VAL && fabs(at.g) < HUGE_VAL)) return false; /* nothing is known there */
    acceptance h = acceptance_of(&w->q, at.tau, tau_err, at.at, walk_limits(w));
    w->off = h.off, w->hidden = h;
    if (!h.accepted) return false;
    meeting m = {.t = h.t, .t_lo = h.t_lo, .t_err = h.t_err, .p_err = h.p_err, .p = at.at.p, .n = at.at.n};
    sgt_hit hit = hit_found(status, w->told.evals - w->told.before, at.g, &m);
    w->told.before = w->told.evals;
    next_root(&w->told);
    sgt_list_add(w->list, &hit);
    w->found = !w->all;
    return true;
}

bool sgt_walk_take_quick(walk *w, point at, double tau_err)
{
    w->off = false;
    return walk_take(w, SGT_HIT, at, tau_err);
}

bool sgt_walk_sharpen(walk *w, point at, double lo, double hi)
{
    local before = w->q;
    bool decided = false;
    for (int i = 0; i < SHARPER && !decided && !w->told.stopped; i++) {
        if (i) {
            w->q = moved_onto(&w->q, w->ray->o, at.tau - at.g / at.at.slope, &lo, &hi);
            at = sgt_walk_look(w, 0, SGT_PROBE, lo, hi);
        }
        sharpened s = sharpened_of(w->s, &w->q, at.tau, at.g, at.at, (searched){lo, hi, w->least},
                                   walk_limits(w));
        decided = s.known && (s.h.accepted ? walk_take(w, SGT_HIT, at, s.tau_err) : s.h.off);
    }
    w->q = before;
    return decided;
}

/* Is |F| at the end of a search suspicious: above the least seen, or not below 2^-10 of the greatest (2^-4
 * with a t_tol)? */
static bool may_be_pole(const walk *w, double g)
{
    return fabs(g) > w->lowest || fabs(g) > (w->t_tol > 0 ? 0x1p-4 : 0x1p-10) * w->highest;
}

bool sgt_walk_take(walk *w, const sgt_root *r, point at)
{
    w->off = false;
    if (r->status <= 0 || w->told.stopped) return false;
    if (at.tau != r->t) {
        at = sgt_walk_look(w, r->t, SGT_NEWTON, r->lo, r->hi);
        if (isnan(at.g) || w->told.stopped) return false;
    }
    if (is_catalogue(w->s.ops) || !may_be_pole(w, at.g)) return walk_take(w, r->status, at, r->t_err);
    if (w->t_tol > 0) { /* a root narrower than the tolerance would look like a pole */
        double t_tol = w->t_tol, lowest = w->lowest, highest = w->highest;
        w->t_tol = 0;
        sgt_root sharp = sgt_walk_begin(w, (sgt_span){.lo = r->lo, .hi = r->hi, .seed = r->t});
        w->lowest = lowest, w->highest = highest;
        sgt_walk_solve(w, &sharp, &at);
        bool taken = sgt_walk_take(w, &sharp, at);
        w->t_tol = t_tol;
        return taken;
    }
    return !is_pole(w, &at, r->t_err) && walk_take(w, r->status, at, r->t_err);
}

bool sgt_walk_between(walk *w, const point *a, const point *b, double *past)
{
    double seed = secant_of(mark_of(a), mark_of(b)), ga = fabs(a->g) < HUGE_VAL ? fabs(a->g) : 0,
           gb = fabs(b->g) < HUGE_VAL ? fabs(b->g) : 0;
    sgt_interval in = {a->tau, b->tau};
    walked found;
    if (seed > in.lo && seed < in.hi && sgt_walk_quick(w, in, seed, in.hi - in.lo, larger(ga, gb), &found)) {
        *past = found.past;
        return sgt_walk_take_quick(w, found.at, found.tau_err);
    }
    point at = *a;
    *past = b->tau;
    if (over(w) || sgt_walk_sign(w, a) * sgt_walk_sign(w, b) >= 0) return false;
    sgt_root r = sgt_walk_begin(w, (sgt_span){.lo = a->tau, .hi = b->tau, .seed = seed});
    sgt_root_tell(&r, a->tau, a->g);
    sgt_root_tell(&r, b->tau, b->g);
    w->lowest = (ga < gb ? ga : gb) * (1 - 0x1p-52); /* a root has to be below both ends */
    w->highest = larger(ga, gb);
    sgt_walk_solve(w, &r, &at);
    *past = r.hi;
    return sgt_walk_take(w, &r, at);
}

void sgt_walk_stretch(walk *w, sgt_status status, double lo, double hi)
{
    int count = w->list->count;
    if (w->told.stopped) status = SGT_STOPPED;
    add_stretch(w->list, &w->told, status, w->ray, (w->q.t0 + lo) * w->q.scale, (w->q.t0 + hi) * w->q.scale);
    w->found = w->found || (w->list->count > count && !w->all);
}
