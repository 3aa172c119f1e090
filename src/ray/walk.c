/* walk.c - evaluations along a ray of any surface, brackets, and the roots they hold.
 *
 * F is evaluated at the local point x + tau d; what rounding of that point does to F, e_i |F_i| per
 * coordinate, is added to the surface's own `rounding`.
 *
 * A change of sign through a pole is no root: |F| at the end of the search is greater than where it
 * began, and at the ends of the bracket, and it is passed by. */
#include "walk.h"

point sgt_walk_look(walk *w, double tau, sgt_move move, double lo, double hi)
{
    const local *q = &w->q;
    double tl = tau * q->l, tm = tau * q->m, tn = tau * q->n;
    point e = {.tau = tau, .p = {q->x + tl, q->y + tm, q->z + tn}};
    if (over(w)) {
        e.g = e.slope = NAN;
        return e;
    }
    e.g = w->s.ops->value(w->s.self, e.p, &e.n);
    e.slope = e.n.x * q->l + e.n.y * q->m + e.n.z * q->n;
    double ex = q->xa + fabs(tl) + fabs(e.p.x), ey = q->ya + fabs(tm) + fabs(e.p.y), ez = q->za + fabs(tn) + fabs(e.p.z);
    double place = SGT_U * (ex * fabs(e.n.x) + ey * fabs(e.n.y) + ez * fabs(e.n.z));
    e.p_err = SGT_U * (ex + ey + ez);
    e.terms = fabs(e.p.x * e.n.x) + fabs(e.p.y * e.n.y) + fabs(e.p.z * e.n.z);
    e.g_err = place >= 0 ? place : 0; /* NaN: a gradient that says nothing */
    if (w->s.ops->rounding) {
        double own = w->s.ops->rounding(w->s.self, e.p);
        e.g_err += own >= 0 ? own : 0; /* a bound that is none is none */
    }
    w->defined = w->defined || !isnan(e.g);
    tell(&w->told, move, (q->t0 + tau) * q->scale, e.g, e.slope / q->scale, (q->t0 + lo) * q->scale, (q->t0 + hi) * q->scale);
    return e;
}

sgt_root sgt_walk_begin(const walk *w, sgt_span span)
{
    return sgt_root_begin(span, &(sgt_options){.t_tol = w->t_tol, .f_tol = w->told.opt->f_tol, .max_evals = w->told.budget});
}

sgt_root sgt_walk_solve(walk *w, sgt_root r, point *at)
{
    w->first = HUGE_VAL;
    while (!over(w)) {
        *at = sgt_walk_look(w, r.t, r.move, r.lo, r.hi);
        if (w->told.stopped) break;
        if (w->first == HUGE_VAL && fabs(at->g) < HUGE_VAL) w->first = fabs(at->g);
        r.g_err = at->g_err;
        if (!sgt_root_next(&r, at->g, at->slope)) break;
    }
    return r;
}

bool sgt_walk_take(walk *w, const sgt_root *r, point at)
{
    const local *q = &w->q;
    w->off = false;
    if (r->status <= 0 || w->told.stopped) return false;
    if (at.tau != r->t) {
        at = sgt_walk_look(w, r->t, SGT_NEWTON, r->lo, r->hi);
        if (isnan(at.g) || w->told.stopped) return false;
    }
    if (!(fabs(at.g) <= w->first + 16 * at.g_err)) return false; /* a pole: it grew */
    twofold t = two_sum(q->t0, r->t);
    double width = START_ULPS * at.terms / fabs(at.slope), length = fabs(q->l) + fabs(q->m) + fabs(q->n);
    sgt_hit hit = {.status = r->status, .t = t.hi * q->scale, .t_lo = t.lo * q->scale,
                   .t_err = (fabs(t.lo) + r->t_err) * (1 + 4 * SGT_U) * q->scale, .f = at.g, .p = at.p, .n = at.n,
                   .p_err = length * r->t_err + 1.01 * at.p_err};
    hit.lo = hit.t - hit.t_err, hit.hi = hit.t + hit.t_err;
    width = (width < HUGE_VAL ? width * q->scale : 0) + 8 * SGT_U * fabs(hit.t);
    double tmin = w->ray->tmin;
    w->off = hit.t - hit.t_err > w->ray->tmax || hit.t + hit.t_err <= tmin || hit.t_err <= width + 64 * SGT_U * fabs(tmin);
    bool started = tmin == -HUGE_VAL || hit.t > tmin + (hit.t_err + width);
    if (!started || hit.t > w->ray->tmax) return false;
    hit.evals = w->told.evals - w->told.before;
    w->told.before = w->told.root = w->told.evals;
    sgt_list_add(w->list, &hit);
    w->found = !w->all;
    return true;
}

bool sgt_walk_between(walk *w, const point *a, const point *b, double *past)
{
    sgt_root r = sgt_walk_begin(w, (sgt_span){.lo = a->tau, .hi = b->tau, .seed = a->tau - a->g * (b->tau - a->tau) / (b->g - a->g)});
    point at = *a;
    sgt_root_tell(&r, a->tau, a->g);
    sgt_root_tell(&r, b->tau, b->g);
    r = sgt_walk_solve(w, r, &at);
    *past = r.hi;
    if (r.status <= 0 || w->told.stopped) return false;
    double ga = fabs(a->g) < HUGE_VAL ? fabs(a->g) : 0, gb = fabs(b->g) < HUGE_VAL ? fabs(b->g) : 0;
    bool pole = fabs(at.g) > larger(ga, gb);
    w->first = larger(w->first, larger(ga, gb)); /* the solver may have begun on the root itself */
    return !pole && sgt_walk_take(w, &r, at);
}

void sgt_walk_stretch(walk *w, sgt_status status, double lo, double hi)
{
    int count = w->list->count;
    add_stretch(w->list, &w->told, status, w->ray, (w->q.t0 + lo) * w->q.scale, (w->q.t0 + hi) * w->q.scale);
    w->found = w->found || (w->list->count > count && !w->all);
}
