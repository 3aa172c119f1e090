// SPDX-License-Identifier: MIT
/* enclosed.c - every root of a user's surface that has `enclose`, in order, none missed: the march of
 * solve/cells.h.
 *
 * `enclose` gives intervals that contain g and g' over the whole of a cell:
 *
 *     0 is not in g          no root in the cell, or F is undefined all over it
 *     0 is not in g'         g is monotone: one root if the signs at the two ends differ, none if they agree;
 *                            the signs must be certain, else the end is moved.  g' has two finite ends: with
 *                            one at infinity g may jump back, over a root
 *     neither                the cell is halved.  It is noise if it cannot be, or if g has come within its
 *                            own rounding
 *
 * The signs are those of `value`.  So an enclosure that is wide for reasons of its own costs cells, and
 * mostly no answer.  An undecided stretch across which g changes its sign is a hit, whose [lo, hi] is the
 * whole stretch.
 *
 * WHY APART.  The other searches by enclosures do not look at signs of `value`.  That of proof.c for what is
 * searched here takes twice the instructions for a first root, 1.6 times for every root, and leaves jumps
 * and poles in loose enclosures undecided.  The slots of cells_batch.c, with `enclose` asked for each of them
 * in turn, take 1.9 times for one ray and 1.3 times for many: vectors of one.
 *
 * If the ray's origin is far, g is enclosed on a ray that begins nearby, where there is one
 * (sgt_move_exactly of move.h). */
#include "../solve/cells.h"
#include "move.h"
#include "walk.h"

#include <sagitta/interval.h>

static bool excludes_zero(sgt_interval x) { return x.lo > 0 || x.hi < 0; }

/* Of a slope: F is continuous then. */
static bool is_continuous(sgt_interval x) { return x.lo > -HUGE_VAL && x.hi < HUGE_VAL && x.lo <= x.hi; }

/* Does the ray touch between `from` and `to`?  g is in `seen` all over that undecided stretch.  It
 * touches, as far as can be told, if g is within 8 times its rounding there.  If so, a graze is added if
 * it is accepted. */
static bool enclosed_touches(walk *w, double from, double to, sgt_interval seen)
{
    sgt_root r = {.t = 0.5 * from + 0.5 * to,
                  .t_err = 0.5 * (to - from) * (1 + 0x1p-40),
                  .status = SGT_GRAZE};
    point middle = sgt_walk_look(w, r.t, SGT_PROBE, from, to);
    if (over(w) || !(larger(-seen.lo, seen.hi) <= 8 * middle.g_err)) return false;
    w->lowest = w->highest = HUGE_VAL; /* g is bounded all over the stretch: no pole */
    return sgt_walk_take(w, &r, middle);
}

/* The monotone cell [tau, end] has a root very near tmin, an end of the search.  Rounding of the way from t0
 * hides whether that root is accepted: t0 may be a thousand times as far off as the surface is large.  So the
 * root is looked for once more from an origin at tmin, where t is as sharp as the rule of the start asks.  A
 * root that cannot be told from the start there is within t_err of it, and is not accepted (sgt_ray). */
static void enclosed_from_start(walk *w, double tau, double end, int side)
{
    local far = w->q;
    double lo = w->lo, hi = w->hi, t_tol = w->t_tol;
    double t0 = w->ray->tmin * inverse_of_scale(w->ray->d), by = far.t0 - t0, past;
    double inward = 0x1p-50 * (fabs(far.t0) + fabs(t0) + fabs(end)); /* of `by`, and of end itself */
    bool first = tau == lo, told = false; /* first: the cell begins at tmin */
    w->q = local_at(w->ray, t0, 0);
    w->t_tol = 0; /* it would hide the same */
    w->lo = first ? 0 : tau + by + inward, w->hi = end + by - inward;
    if (w->lo < w->hi) {
        point a = sgt_walk_look(w, w->lo, SGT_PROBE, w->lo, w->hi),
              b = sgt_walk_look(w, w->hi, SGT_PROBE, w->lo, w->hi);
        told = sign_at(&b) == side && (first || sign_at(&a) == -side);
        if (told && sign_at(&a) == -side) sgt_walk_between(w, &a, &b, &past);
    }
    w->q = far, w->lo = lo, w->hi = hi, w->t_tol = t_tol;
    if (!told && !over(w)) sgt_walk_stretch(w, SGT_UNPROVEN, tau, end);
}

/* A march.  from: the ray on which g is enclosed, whose t is that of the ray less `away`.  g, slope: the
 * cell's; side: the sign of slope.  left, right: g at the ends of a monotone cell, whose signs multiply to
 * `signs`.  start: a root may be the start, or one right behind it.  edge, beyond: where the sign was last
 * looked for before an undecided stretch, and behind it.  seen: bounds on g all over it. */
typedef struct enclosed {
    walk *w;
    const sgt_ray *from;
    double base, lo, hi;
    sgt_interval g, slope, seen;
    point left, right, edge, beyond;
    int signs, side, moved;
    bool start;
} enclosed;

static bool enclosed_over(void *self) { return over(((enclosed *)self)->w); }

/* The enclosures over the cell.  Outward, by what t0 + tau and the scale can round. */
static void enclosed_ask(enclosed *s, const cells *c)
{
    walk *w = s->w;
    const local *q = &w->q;
    double from = (s->base + c->k.tau) * q->scale, to = (s->base + c->at.end) * q->scale;
    sgt_interval t = {larger(from - 0x1p-52 * fabs(from), -DBL_MAX), to + 0x1p-52 * fabs(to)};
    if (!(t.hi <= DBL_MAX)) t.hi = DBL_MAX;
    s->slope = (sgt_interval){(double)NAN, (double)NAN};
    s->g = w->s.ops->enclose(w->s.self, s->from, t, &s->slope);
    tell_cell(&w->told, SGT_MARCH, (q->t0 + c->k.tau) * q->scale, (q->t0 + c->at.end) * q->scale, s->g,
              s->slope);
}

/* The signs at the ends of a monotone cell.  AGAIN: the cell is to be another, or the search is over. */
static cells_kind enclosed_ends(enclosed *s, cells *c)
{
    walk *w = s->w;
    double tau = c->k.tau, end = c->at.end;
    s->left = sgt_walk_look(w, tau, SGT_MARCH, tau, s->hi);
    s->right = sgt_walk_look(w, end, SGT_MARCH, tau, s->hi);
    if (over(w)) return CELLS_AGAIN;
    const point *l = &s->left, *r = &s->right;
    if (!sign_at(r) && sign_at(l) && !c->dark.any && s->moved++ < 16) {
        c->k.h = 0.75 * c->at.h;
        return CELLS_AGAIN;
    }
    s->moved = 0, s->start = false;
    s->signs = sign_at(l) * sign_at(r), s->side = s->slope.lo > 0 ? 1 : -1;
    /* The start is on the surface, and that root is not accepted.  A second root behind it is one root. */
    if (s->signs == 0 && tau == s->lo && w->from_tmin && sign_at(r) == s->side) {
        double least = (s->slope.lo > 0 ? s->slope.lo : -s->slope.hi) * w->q.scale;
        s->signs = 1;
        s->start = !acceptance_of(&w->q, tau, (fabs(l->g) + l->g_err) / least, l->at, walk_limits(w)).off;
    }
    /* Undecided, with g between its values at the ends.  Not if the slope of `value` is so large that its
     * rounding is beyond the enclosure of g. */
    double most = larger(fabs(l->g) + l->g_err, fabs(r->g) + r->g_err);
    if (s->signs != 0 || !(most <= 4 * larger(-s->g.lo, s->g.hi))) return CELLS_MONOTONE;
    s->g = (sgt_interval){-most, most};
    return isnan(l->g) ? CELLS_OPEN : CELLS_NOISE; /* F may not be defined in a part of the cell */
}

static cells_kind enclosed_classify(void *self, cells *c)
{
    enclosed *s = self;
    walk *w = s->w;
    enclosed_ask(s, c);
    sgt_interval g = s->g;
    if (excludes_zero(g) || g.lo > g.hi) return CELLS_EMPTY;
    cells_kind kind = CELLS_OPEN;
    if (g.lo <= g.hi && excludes_zero(s->slope) && is_continuous(s->slope)) kind = enclosed_ends(s, c);
    if (kind == CELLS_OPEN) {
        double h = c->at.h, m = c->at.m, all = s->hi - s->lo;
        point middle = {.g = (double)NAN};
        if (h <= 0x1p-20 * all) middle = sgt_walk_look(w, m, SGT_MARCH, c->k.tau, s->hi);
        /* 3, as halves would not be narrower */
        bool noise = !isnan(middle.g) && g.hi - g.lo <= (sign_at(&middle) ? 3 : 8) * middle.g_err;
        if (!noise && h > 0x1p-52 * fabs(m) + 0x1p-53 * fabs(s->base) + 0x1p-90 * all) return CELLS_OPEN;
        kind = CELLS_NOISE;
    }
    if (kind != CELLS_NOISE) return kind;
    if (!c->dark.any) s->seen = s->g;
    if (!(s->g.lo >= s->seen.lo)) s->seen.lo = s->g.lo;
    if (!(s->g.hi <= s->seen.hi)) s->seen.hi = s->g.hi;
    c->touches = true; /* enclosed_dark has the last word */
    return CELLS_NOISE;
}

static int enclosed_sign(void *self, cells *c, double tau)
{
    enclosed *s = self;
    point at = sgt_walk_look(s->w, tau, SGT_PROBE, c->dark.any ? c->dark.lo : c->back, c->at.end);
    *(c->dark.any ? &s->beyond : &s->edge) = at;
    return sign_at(&at);
}

static bool enclosed_dark(void *self, cells *c, sgt_status status)
{
    enclosed *s = self;
    walk *w = s->w;
    const local *q = &w->q;
    const point *edge = &s->edge, *beyond = &s->beyond;
    double lo = c->dark.lo, hi = c->dark.hi, past;
    bool crossed = status == SGT_HIT && !over(w) && sgt_walk_between(w, edge, beyond, &past);
    if (over(w) && !crossed) return false;
    if (crossed) sgt_list_cover(w->list, (q->t0 + edge->tau) * q->scale, (q->t0 + beyond->tau) * q->scale);
    else if (status == SGT_HIT || !enclosed_touches(w, lo, hi, s->seen))
        sgt_walk_stretch(w, SGT_UNPROVEN, lo, hi);
    return true;
}

static cells_kind enclosed_settle(void *self, cells *c)
{
    enclosed *s = self;
    walk *w = s->w;
    double tau = c->k.tau, end = c->at.end, t_tol = w->t_tol, past;
    if (!(end < s->hi)) w->t_tol = 0; /* it would hide whether a root at the far end is accepted */
    if (s->signs < 0) {
        w->hidden.t = (double)NAN;
        s->start = !sgt_walk_between(w, &s->left, &s->right, &past) && !w->off && w->from_tmin &&
                   w->hidden.t - w->ray->tmin <= 2 * w->hidden.t_err;
    }
    if (s->start && !over(w)) enclosed_from_start(w, tau, end, s->side);
    w->t_tol = t_tol;
    if (s->signs == 0) sgt_walk_stretch(w, SGT_UNPROVEN, tau, end);
    if (w->told.stopped || spent(&w->told)) return CELLS_AGAIN;
    return s->signs > 0 ? CELLS_EMPTY : CELLS_MONOTONE;
}

void sgt_walk_enclosed(walk *w, double lo, double hi)
{
    const local *q = &w->q;
    sgt_ray near;
    /* the difference is exact, as the two are near each other */
    double away = fabs(q->t0) > 8 * larger(-lo, hi) ? sgt_move_exactly(w->ray, q->t0 * q->scale, &near) : 0;
    enclosed s = {
        .w = w, .from = away != 0 ? &near : w->ray, .base = q->t0 - away / q->scale, .lo = lo, .hi = hi};
    cells c = {.k = {.tau = lo, .hi = hi, .h = 0.125 * (hi - lo), .growth = 2}, .back = lo, .leap = 1.5};
    cells_ops ops = {enclosed_over, enclosed_classify, enclosed_settle, enclosed_sign, enclosed_dark};
    cells_march(&c, &s, ops);
    if (over(w) && !w->found)
        sgt_walk_stretch(w, w->told.stopped ? SGT_STOPPED : SGT_EXHAUSTED, cells_reached(&c), hi);
}
