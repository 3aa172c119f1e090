// SPDX-License-Identifier: MIT
/* proof.c - the search through a ray by a surface's enclosure: what is proven of a surface that is met by
 * its operations.
 *
 * Without an enclosure nothing can be proven but that the ray misses the span.  The answer is then the
 * estimate, made UNPROVEN (answer.c).  With an enclosure, every claim rests on the span and on the
 * intervals that it gives of g and g', in the ray's own t, for the ray as given.  `value` only guesses
 * where to look, and gives f and n of the hit.
 *
 * The stretch is a row of pieces, searched from the near end.  Let g and S be the intervals of g and g'
 * over a piece X, and G the interval of g at one point m of it:
 *
 *     0 is not in g     no root in X, or F is undefined all over it
 *     0 is not in S     g is monotone, and a root of X lies in m - G / S (Moore 1966).  If that is outside
 *                       of X, there is none.  Else X is cut to that, and m moves into it by Newton's steps
 *                       on `value`.  Where 0 is in G, the root is proven; else what is left of X is a piece
 *     else, 0 not in G  the mean value theorem keeps roots away from m: where G > 0, no root is in
 *                       (m - min G / max S, m + min G / -min S); for G < 0 the same with signs changed.
 *                       What is left on either side is a piece (Hansen and Walster 2004, chapter 9)
 *     else              X is divided, if more pieces can tell more.  They cannot, and X is undecided, if
 *                       m is at the limit of doubles, or 0 is in G and g over X is no wider than four
 *                       times G, or S times the length of X is no more than the width of G
 *
 * A slope without bound says nothing of a root: g may jump there, or not be defined.  A bounded slope
 * promises that F is defined and continuous (sgt_surface_ops.enclose in sagitta.h says so).
 *
 * A ROOT IS PROVEN if m - G / S' lies inside X', with S' the slope over X'.  By the mean value theorem g
 * then has unlike signs at the ends of X', or is zero there, and S' allows no second zero in X'.  X' is
 * small, and about the root.  It may reach beyond the piece, so that it makes no difference where pieces
 * end.
 *
 * UNDECIDED pieces with little between them are one stretch.  It is a graze if g over all of it is within
 * eight times G, its ends do not have certain unlike signs, and F in the middle is 0 to rounding.  At tmin
 * a stretch is dropped if no root in it can be accepted: the slope at any root is at most max |S|, which
 * bounds from below how far from tmin an accepted root has to be (start_width).
 *
 * THE START.  The rule is in accept.h.  Here it is evaluated with the certain bounds of the slope about
 * the root, and with the gradient of `value`.  Rounding moves the terms of that gradient.  So the reach of
 * the rule has a least and a most:
 *
 *     case                                          UNPROVEN is
 *     most <= 4 least, and the reach is small       a root between the least and the most reach
 *     most > 4 least: rounding makes the terms      a root that may be the start, unless it is certainly
 *     uncertain by more than half, or so            within the least reach
 *     most > 2^-36 of the point's distance from     the same, with the least reach in all of the root's
 *     the origin                                    interval
 *
 * Near the line in which two planes meet, both the slope and the terms of `value` are nothing but
 * rounding; taken as they are, they would drop a root far from tmin.  A reach of 2^-36 is 2^12 times that
 * of a surface met at a right angle.  The slope is then so small that the terms may change by orders of
 * magnitude within the root's interval.
 *
 * FROM AFAR.  If the ray's origin is far, one ulp of t is a long way, and an enclosure over it cannot tell
 * a root from a near miss.  The centre is the point of the ray nearest the origin of the surface's frame.
 * Near the centre such a ray is searched in a t that counts from t0, the t of the centre: every t, lo or
 * hi in this file counts from t0, exactly.  Nearer to the ray's own origin than to the centre t0 is 0, so
 * that no root loses the digits of its own t.
 *
 *     a built-in surface    encloses g(t0 + t) for any t0 (sgt_builtin_ops, enclose)
 *     a user's surface      is given a ray, whose origin has to be doubles.  Through the nearest doubles goes
 *                           another ray, and only the gradient would tell how far its g is from the true one.
 *                           So t0 is the one of sgt_move_exactly (move.c), nearest the centre, at which all
 *                           three coordinates o + t0 d are doubles
 *
 * If the components of d are alike in size, that t0 is some lengths from the centre.  If coordinates begin
 * much smaller than they end, there may be none; then the ray's own t is used.
 *
 * WITHOUT AN END.  The far stretch from T to DBL_MAX is asked as a whole.  If that does not decide it, it
 * is divided at distances that are fixed multiples of the ray's own (RUNGS), and between these at the
 * geometric mean, as often as it takes.  So a ray is as long as its t can be told.
 *
 * ONE ROOT that need not be the first (SGT_PROVE_ROOT, near the seed or with span.single) is first looked
 * for by the estimate, with a few evaluations, and proven where that finds it.  If that fails, it is the
 * root nearest to the seed among all of them.
 *
 * WITHOUT A PROOF the same search is the careful path of built-in surfaces without `meet` (general.c).
 * Their rim, r^2 <= rim2, is a rule in computed numbers, as in accept.h.  A root whose side of the rim is
 * hidden by its error is UNPROVEN under a proof.  Without one it is UNPROVEN only if its error is greater
 * than what the rim is soft by. */
#include "proof.h"

#include "../num/bits.h"
#include "../solve/root.h"
#include "../solve/step.h"
#include "move.h"

#include <sagitta/interval.h>

enum { PIECES = 96, GUESSES = 10, NEARBY = 4 };

static bool proof_over(const proof *w) { return w->found || w->told.stopped || spent(&w->told); }

static bool has_zero(sgt_interval x) { return x.lo <= 0 && x.hi >= 0; }
static bool is_bounded(sgt_interval x) { return x.lo > -HUGE_VAL && x.hi < HUGE_VAL; } /* nor NaN */
static sgt_interval number(double x) { return sgt_interval_of(x); }

static double finite(double t) { return t < -DBL_MAX ? -DBL_MAX : t > DBL_MAX ? DBL_MAX : t; }

/* g and g' over t.  All numbers if nothing is known, or if the search is over and nothing is asked. */
static sgt_interval proof_ask(proof *w, sgt_interval t, sgt_move move, sgt_interval *slope)
{
    *slope = sgt_interval_all();
    if (proof_over(w)) return *slope;
    t.lo = finite(t.lo), t.hi = finite(t.hi);
    const sgt_surface_ops *ops = w->s.ops;
    bool own = ops->own_ && ops->own_->enclose;
    sgt_interval g = own ? ops->own_->enclose(w->s.self, w->ray, w->t0, t, slope)
                         : ops->enclose(w->s.self, w->t0 != 0 ? &w->at_far : w->ray, t, slope);
    tell_cell(&w->told, move, w->t0 + t.lo, w->t0 + t.hi, g, *slope);
    if (!(slope->lo <= slope->hi)) *slope = sgt_interval_all();
    return isnan(g.lo) || isnan(g.hi) ? sgt_interval_all() : g;
}

static sgt_interval ask_at(proof *w, double t, sgt_move move)
{
    sgt_interval slope;
    return proof_ask(w, number(t), move, &slope);
}

/* m - G / S */
static sgt_interval newton_set(double m, sgt_interval g, sgt_interval slope)
{
    return sgt_interval_difference(number(m), sgt_interval_quotient(g, slope));
}

/* ------------------------------------------------------------------ where t counts from */

/* t + by, rounded up. */
static double up_by(double t, twofold by)
{
    return t == -HUGE_VAL ? t : sgt_sum_above(t, sgt_sum_above(by.hi, by.lo));
}
static double down_by(double t, twofold by) { return -up_by(-t, twofold_negative(by)); }
static sgt_interval out_by(sgt_interval t, twofold by)
{
    return sgt_interval_between(down_by(t.lo, by), up_by(t.hi, by));
}

/* Makes everything that the search knows count from another t0, rounding outward. */
static void count_from(proof *w, double t0)
{
    twofold by = two_sum(w->t0, -t0);
    if (t0 == w->t0) return;
    sgt_interval all = w->all_t, tmin = sgt_interval_of(w->ray->tmin);
    if (t0 != 0) { /* a root at tmax is accepted where t0 + t is rounded to it */
        all.hi = sgt_next_above(all.hi);
        all = out_by(all, twofold_of(-t0)), tmin = out_by(tmin, twofold_of(-t0));
    }
    w->lo = all.lo, w->hi = all.hi, w->tmin = tmin;
    cells *c = &w->march;
    c->done = down_by(c->done, by), c->dark.lo = down_by(c->dark.lo, by), c->dark.hi = up_by(c->dark.hi, by);
    w->told_dark = up_by(w->told_dark, by), w->last = out_by(w->last, by);
    w->seed += by.hi, w->centre += by.hi;
    w->t0 = t0;
}

/* On one side of this t the ray is searched with t0 = far, on the other with t0 = 0. */
static double border_of(const proof *w) { return w->far != 0 ? 0.5 * w->far : HUGE_VAL; }

/* One coordinate of the point of the ray at t0 + t, all in the unit of d times `scale`. */
static double coordinate_at(double o, double d, double t0, double t)
{
    return t0 == 0 ? moved_along(o, t, d) : coordinate(o, d, t0, t).hi;
}

static sgt_vec3 point_at(const sgt_ray *ray, double scale, double t0, double t)
{
    sgt_vec3 o = ray->o, d = ray->d;
    return (sgt_vec3){coordinate_at(o.x, d.x * scale, t0, t), coordinate_at(o.y, d.y * scale, t0, t),
                      coordinate_at(o.z, d.z * scale, t0, t)};
}

/* --------------------------------------------------------------- what is reported */

/* The point of the ray at t, F there, and whether a root there, within t_err, is accepted. */
typedef struct proof_place {
    acceptance h;
    sgt_vec3 p, n;
    double f, width;       /* width: the reach of the rule of the start, as a t */
    double least, most;    /* its lower and upper bound */
    double r2, off;        /* r^2, and a bound on its error */
    bool exact;            /* scaling t has lost nothing */
} proof_place;

/* The least |x| in the interval. */
static double least_of(sgt_interval x) { return x.lo > 0 ? x.lo : x.hi < 0 ? -x.hi : 0; }

/* A bound on how far rounding of the gradient moves |x Fx| + |y Fy| + |z Fz|.  F is a sum of such terms;
 * so it is a part of what rounding does to F, times the degree: 32 of it.  A rounding below 2^-1000 stands
 * for underflow in any unit of length, and says nothing of terms. */
static double terms_err(const proof *w, sgt_vec3 p)
{
    double own = w->s.ops->rounding ? w->s.ops->rounding(w->s.self, p) : 0;
    return own >= 0x1p-1000 ? 0x1p5 * own : own >= 0 ? 0 : HUGE_VAL;
}

/* slope: certain bounds of g' at the root, in the ray's own t.  The gradient of `value` is rounded.  Where
 * it nearly vanishes (where two planes meet, at the apex of a cone) its slope is nothing but rounding, so
 * it is clipped to these bounds. */
static proof_place proof_place_of(proof *w, double t, double t_err, sgt_interval slope)
{
    const sgt_ray *ray = w->ray;
    double scale = scale_of(ray->d), inverse = inverse_of_scale(ray->d);
    double from = w->t0 != 0 ? w->t0 : t, rest = w->t0 != 0 ? t : 0, tau = rest * inverse;
    local q = {.l = ray->d.x * scale, .m = ray->d.y * scale, .n = ray->d.z * scale,
               .t0 = from * inverse, .scale = scale};
    proof_place at = {.p = point_at(ray, scale, q.t0, tau),
                      .exact = q.t0 * scale == from && tau * scale == rest};
    at.f = w->s.ops->value(w->s.self, at.p, &at.n);
    q.x = at.p.x, q.y = at.p.y, q.z = at.p.z;
    around a = around_of(&q, 0, at.p, at.n, 0);
    double least = least_of(slope) * scale, most = sgt_interval_greatest(slope) * scale,
           steep = fabs(a.slope);
    double terms = fabs(at.p.x * at.n.x) + fabs(at.p.y * at.n.y) + fabs(at.p.z * at.n.z),
           err = terms_err(w, at.p), by = START_ULPS * scale;
    a.slope = steep < least ? least : steep > most ? most : steep;
    at.least = by * larger(terms - err, 0) / most, at.most = by * (terms + err) / least;
    at.h = acceptance_of(&q, tau, t_err * inverse, a, (limits){ray->tmin, ray->tmax, w->rim2, 0});
    at.r2 = at.p.x * at.p.x + at.p.y * at.p.y;
    at.off = 1.01 * ((2 * (fabs(at.p.x) + fabs(at.p.y)) + at.h.p_err) * at.h.p_err + 4 * SGT_U * at.r2);
    at.h.t_err = larger(at.h.t_err, t_err);
    at.width = by * terms / a.slope + 8 * SGT_U * fabs(w->t0 + t);
    double along = at.n.x * ray->d.x + at.n.y * ray->d.y + at.n.z * ray->d.z; /* a.slope has no sign */
    tell(&w->told, SGT_PROBE, w->t0 + t, at.f, along, w->t0 + (t - t_err), w->t0 + (t + t_err));
    return at;
}

/* Notes that an entry of [lo, hi] has been added. */
static void added(proof *w, double lo, double hi)
{
    double off = larger(larger(lo - w->seed, w->seed - hi), 0);
    if (off <= w->near) w->near = off, w->nearest = w->list->last;
    w->found = !w->all;
}

void sgt_proof_stretch(proof *w, sgt_status status, double lo, double hi)
{
    add_stretch(w->list, &w->told, status, w->ray, w->t0 + lo, w->t0 + hi);
    if (w->list->count) added(w, lo, hi);
}

/* about: [lo, hi] of the hit, in the ray's own t; x: the root's interval, counted from t0. */
static void proof_add(proof *w, sgt_status status, const proof_place *at, sgt_interval x, sgt_interval about)
{
    meeting h = {.t = at->h.t, .t_lo = at->h.t_lo, .t_err = at->h.t_err, .p_err = at->h.p_err, .p = at->p,
                 .n = at->n};
    sgt_hit hit = hit_found(status, w->told.evals - w->told.before, at->f, &h);
    hit.lo = about.lo, hit.hi = about.hi;
    w->told.before = w->told.evals;
    if (w->anew) next_root(&w->told);
    sgt_list_add(w->list, &hit);
    added(w, x.lo, x.hi);
}

/* A lower bound on how far from tmin a root in `at` has to be in order to be accepted; 0: none.  The
 * products x Fx are looked at in both ends and the middle.  If none of the three changes sign, the product
 * is not below the least of them.  That is exact for a quadric, whose gradient is linear.  For others it
 * holds while the stretch is short for its distance from the origin (2^-10 of it). */
static double start_width(proof *w, sgt_interval at, sgt_interval slope)
{
    double t[3] = {at.lo, sgt_interval_middle(at), at.hi}, x[3][3], terms = 0, err = 0, far = 0;
    sgt_vec3 d = w->ray->d;
    for (int i = 0; i < 3; i++) {
        proof_place here = proof_place_of(w, t[i], 0, sgt_interval_all());
        if (w->told.stopped) return 0;
        const double p[3] = {here.p.x, here.p.y, here.p.z}, n[3] = {here.n.x, here.n.y, here.n.z};
        for (int k = 0; k < 3; k++) x[k][i] = p[k] * n[k];
        err = larger(err, terms_err(w, here.p)),
        far = larger(far, larger(fabs(p[0]), larger(fabs(p[1]), fabs(p[2]))));
    }
    if (!((at.hi - at.lo) * larger(fabs(d.x), larger(fabs(d.y), fabs(d.z))) <= 0x1p-10 * far)) return 0;
    for (int k = 0; k < 3; k++) {
        bool one = (x[k][0] > 0 && x[k][1] > 0 && x[k][2] > 0) || (x[k][0] < 0 && x[k][1] < 0 && x[k][2] < 0);
        double a = fabs(x[k][0]), b = fabs(x[k][1]), c = fabs(x[k][2]), least = a < b ? a : b;
        if (one) terms += c < least ? c : least;
    }
    return START_ULPS * larger(terms - err, 0) / sgt_interval_greatest(slope);
}

/* Is all of it within 2^-1000 of the start (accept.h)? */
static bool at_very_start(const proof *w, sgt_interval at)
{
    sgt_vec3 d = w->ray->d;
    double most = larger(fabs(d.x), larger(fabs(d.y), fabs(d.z)));
    return sgt_sum_above(at.hi, -w->tmin.lo) <= START_LEAST / most;
}

/* Does all of the stretch lie beyond the rim? */
static bool proof_outside(const proof *w, sgt_interval t)
{
    sgt_vec3 o = w->ray->o, d = w->ray->d;
    t = w->t0 != 0 ? out_by(t, twofold_of(w->t0)) : t;
    sgt_interval x = sgt_interval_sum(number(o.x), sgt_interval_scaled(t, d.x));
    sgt_interval y = sgt_interval_sum(number(o.y), sgt_interval_scaled(t, d.y));
    return sgt_interval_sum(sgt_interval_square(x), sgt_interval_square(y)).lo > w->rim2;
}

static double proof_absolute(sgt_vec3 a) { return fabs(a.x) + fabs(a.y) + fabs(a.z); }

/* Is F as computed there 0, as far as rounding tells?  The enclosure cannot answer this: it may be wide
 * for reasons of its own.  The enclosure of a sum of large terms, far off, holds 0 at points where `value`
 * is certainly not 0.  And if rounding is a part in 2^20 of all that F is made of (a power has left the
 * range of doubles), nothing is known. */
static bool proof_touches(const proof *w, const proof_place *at)
{
    const sgt_surface_ops *ops = w->s.ops;
    double own = ops->rounding ? ops->rounding(w->s.self, at->p) : HUGE_VAL,
           size = proof_absolute(at->p) * proof_absolute(at->n);
    if (!(own >= 0 && own < HUGE_VAL)) return !is_catalogue(ops); /* not known */
    bool lost =
        at->n.z == 1 && own > 0x1p-20 * size + 0x1p-900; /* a sag; another's gradient may vanish */
    return !lost && !(fabs(at->f) > 8 * (own + 2 * SGT_U * size));
}

/* Neither the point nor the gradient has overflown. */
static bool proof_in_range(const proof_place *at)
{
    return larger(fabs(at->n.x), larger(fabs(at->n.y), fabs(at->n.z))) < HUGE_VAL && at->h.p_err < HUGE_VAL;
}

/* Ends the undecided stretch, if there is one: it is dropped, a graze, or UNPROVEN. */
static void flush(proof *w)
{
    undecided *dark = &w->march.dark;
    if (!dark->any) return;
    dark->any = false, w->told_dark = dark->hi;
    sgt_interval at = {dark->lo, dark->hi}, slope, steep;
    bool whole = at.lo <= finite(w->lo) && at.hi >= finite(w->hi) && at.hi > at.lo,
         start = at.lo <= w->tmin.hi;
    double t = whole ? start_within(w->ray, w->t0, at.lo, at.hi, w->centre, w->rim2)
                     : sgt_interval_middle(at);
    if (proof_outside(w, at) || (!whole && at_very_start(w, at))) return;
    if (whole) at = sgt_interval_between(w->lo, w->hi);
    if (isnan(t)) {
        sgt_proof_stretch(w, SGT_UNPROVEN, at.lo, at.hi);
        return;
    }
    sgt_interval g = proof_ask(w, at, SGT_PROBE, &slope), middle = proof_ask(w, number(t), SGT_PROBE, &steep);
    if (is_bounded(slope))
        g = sgt_interval_intersection(
            g, sgt_interval_sum(middle, sgt_interval_product(slope, sgt_interval_difference(at, number(t)))));
    if (start && !whole && is_bounded(slope) && !proof_over(w) &&
        sgt_sum_above(at.hi, -w->tmin.lo) < (1 - 0x1p-20) * start_width(w, at, slope)) return;
    if (is_bounded(g) && is_bounded(middle) && is_bounded(steep) &&
        sgt_interval_greatest(g) <= 8 * sgt_interval_width(middle) && (whole || !start)) {
        sgt_interval left = ask_at(w, at.lo, SGT_PROBE), right = ask_at(w, at.hi, SGT_PROBE);
        bool crosses = (left.lo > 0 && right.hi < 0) || (left.hi < 0 && right.lo > 0);
        if (!crosses && !proof_over(w)) {
            proof_place here = proof_place_of(w, t, whole ? 0 : sgt_interval_width(at) * (0.5 + 0x1p-40),
                                              sgt_interval_all());
            sgt_interval about = w->t0 != 0 ? out_by(at, twofold_of(w->t0)) : at;
            if (here.r2 - w->rim2 > here.off && !whole) return;
            about = sgt_interval_between(larger(about.lo, w->ray->tmin),
                                         about.hi < w->ray->tmax ? about.hi : w->ray->tmax);
            if (whole && w->t0 == 0) here.h.t = t, here.h.t_lo = 0; /* d short: it may underflow */
            if (whole && here.h.t < w->ray->tmin) here.h.t = w->ray->tmin, here.h.t_lo = 0;
            double at_t = here.h.t;
            bool inside = here.r2 <= w->rim2 && at_t >= about.lo && at_t <= about.hi;
            if (!w->told.stopped && inside && proof_touches(w, &here) && fabs(at_t) < HUGE_VAL
                && here.h.t_err < HUGE_VAL && proof_in_range(&here)) {
                proof_add(w, SGT_GRAZE, &here, at, about);
                return;
            }
        }
    }
    sgt_proof_stretch(w, SGT_UNPROVEN, at.lo, at.hi);
}

/* --------------------------------------------------------------------------- a root */

typedef enum proof_verdict { NONE, ROOT, UNSURE, CUT } proof_verdict;

/* The root's interval; the interval in which it is the only root; the slope over that. */
typedef struct certain { sgt_interval root, only, slope; } certain;

/* Is there a root in n, and only one?  G is g at m. */
static proof_verdict proof_certify(proof *w, sgt_interval n, double m, sgt_interval G, certain *c)
{
    n = sgt_interval_hull(n, number(m)); /* the mean value theorem is used between m and the root */
    double pad = sgt_interval_width(n) + 0x1p-51 * fabs(m) + DBL_TRUE_MIN;
    for (int i = 0; i < 3; i++, pad *= 8) {
        sgt_interval slope, x = {-sgt_sum_above(-n.lo, pad), sgt_sum_above(n.hi, pad)};
        if (!has_zero(proof_ask(w, x, SGT_PROBE, &slope))) return NONE;
        if (has_zero(slope) || !is_bounded(slope)) return UNSURE;
        sgt_interval root = newton_set(m, G, slope);
        double t = sgt_interval_middle(root),
               far = larger(sgt_sum_above(root.hi, -t), sgt_sum_above(t, -root.lo)) * (1 + 0x1p-48);
        if (root.lo <= root.hi && sgt_interval_is_in(sgt_interval_about(t, far), x)) {
            *c = (certain){root, x, slope};
            return ROOT;
        }
    }
    return UNSURE;
}

/* Is there no other root within t_err of t?  A hit under a proof claims that.  From afar t_err is half an
 * ulp of t or more, which is wider than `only`, and there may be another root in it.  So the rest of that
 * interval is asked about. */
static bool unique_as_told(proof *w, const proof_place *at, sgt_interval only)
{
    sgt_interval slope, told = out_by(sgt_interval_about(at->h.t, at->h.t_err), twofold_of(-w->t0));
    if (w->t0 == 0 || !w->told.opt->proof || sgt_interval_is_in(told, only)) return true;
    proof_ask(w, sgt_interval_hull(told, only), SGT_PROBE, &slope);
    if (!has_zero(slope) && is_bounded(slope)) return true;
    sgt_interval before = {told.lo, only.lo}, behind = {only.hi, told.hi};
    return (before.lo > before.hi || !has_zero(proof_ask(w, before, SGT_PROBE, &slope))) &&
           (behind.lo > behind.hi || !has_zero(proof_ask(w, behind, SGT_PROBE, &slope)));
}

/* A user's surface without a proof: has F, by `value`, certainly one sign on both sides of the root?  Then
 * the enclosure does not belong to this F, and its root is not told. */
static bool refuted(proof *w, sgt_interval only)
{
    if (is_catalogue(w->s.ops) || w->told.opt->proof) return false;
    int signs[2];
    for (int i = 0; i < 2; i++) {
        proof_place at = proof_place_of(w, i ? only.hi : only.lo, 0, sgt_interval_all());
        if (w->told.stopped) return true;
        double own = w->s.ops->rounding ? w->s.ops->rounding(w->s.self, at.p) : 0,
               off = 8 * (own + 2 * SGT_U * proof_absolute(at.p) * proof_absolute(at.n));
        signs[i] = (int)sign_of(at.f, off);
    }
    return signs[0] * signs[1] > 0;
}

/* May the root be the start or not?  Decided in computed numbers while these tell how far the start reaches
 * (steady).  Else by what is certain wherever the root is in its interval (THE START). */
static bool start_hides(proof *w, const certain *c, const proof_place *at)
{
    sgt_interval root = c->root;
    double t_err = at->h.t_err, t = w->t0 + sgt_interval_middle(root), steps = 8 * SGT_U * fabs(t),
           most_p = larger(fabs(at->p.x), larger(fabs(at->p.y), fabs(at->p.z))),
           gap = at->h.t - (w->ray->tmin + t_err + steps);
    bool steady = at->most <= 4 * at->least && at->most <= 0x1p-36 * most_p * scale_of(w->ray->d);
    if (w->ray->tmin == -HUGE_VAL || steady
        || root.lo - w->tmin.hi > 2 * t_err + at->most + 2 * steps)
        return steady && gap > at->least && gap <= at->most;
    double reach = start_width(w, root, c->slope), sure = reach < at->least ? reach : at->least;
    return !(root.hi - (w->tmin.lo + steps) <= sure + (t_err <= 16 * sure ? t_err : 0));
}

/* Adds the root if it is accepted, or an UNPROVEN stretch if that cannot be told.  false: the root cannot
 * be told from an earlier entry. */
static bool proof_take(proof *w, const certain *c)
{
    sgt_interval root = c->root, only = c->only;
    if (root.lo <= w->last.hi) { /* the last root once more? */
        if (!sgt_interval_is_in(w->last, only)) return false;
        return true;
    }
    if (root.lo <= w->told_dark) return false; /* it cannot be told from a stretch already reported */
    undecided *dark = &w->march.dark;
    if (dark->any && root.lo <= dark->hi) { /* that stretch is part of where this root is the only one */
        if (!sgt_interval_is_in((sgt_interval){dark->lo, dark->hi}, only)) return false;
        dark->any = false;
    }
    flush(w);
    if (proof_over(w)) return true;
    if (at_very_start(w, root)) {
        w->last = root;
        return true;
    }
    double t = sgt_interval_middle(root),
           t_err = larger(sgt_sum_above(root.hi, -t), sgt_sum_above(t, -root.lo));
    proof_place at = proof_place_of(w, t, t_err, c->slope);
    if (w->told.stopped) return true;
    w->last = root;
    sgt_interval about = sgt_about(at.h.t, at.h.t_err);
    bool hidden = start_hides(w, c, &at);
    if (w->told.stopped) return true;
    bool on_rim = w->rim2 < HUGE_VAL && !(fabs(at.r2 - w->rim2) > at.off);
    /* Without a proof the rule of the rim decides.  It drops no root within the semi_diameter itself:
     * rounding moves r^2 by less than the rim is soft by. */
    if (on_rim && !w->told.opt->proof && at.r2 > w->rim2 && at.off <= 0x1p-45 * w->rim2) return true;
    if (on_rim && w->told.opt->proof) sgt_proof_stretch(w, SGT_UNPROVEN, root.lo, root.hi);
    else if (hidden && !(w->t0 + root.lo > w->ray->tmax))
        sgt_proof_stretch(w, SGT_UNPROVEN, root.lo, root.hi); /* the start or not */
    else if (at.h.accepted && at.exact && proof_in_range(&at) && unique_as_told(w, &at, only) &&
             !refuted(w, only))
        proof_add(w, SGT_HIT, &at, root, about);
    else if (!at.h.off && !(at.h.t - at.h.t_err <= w->ray->tmin + at.width && at.h.t_err <= 16 * at.width))
        sgt_proof_stretch(w, SGT_UNPROVEN, root.lo, root.hi);
    return true;
}

/* How sharp a root in n has to be.  At an end of the search a tolerance would hide whether it is accepted. */
static double sharp_enough(const proof *w, sgt_interval n)
{
    return n.lo > w->lo && n.hi < w->hi ? w->told.opt->t_tol : 0;
}

/* The t to which Newton's steps on `value` lead from the middle of n. */
static double guess(proof *w, sgt_interval n)
{
    const sgt_ray *ray = w->ray;
    double t = sgt_interval_middle(n), last = n.hi - n.lo, t_tol = sharp_enough(w, n);
    for (int i = 0; i < GUESSES && !proof_over(w); i++) {
        sgt_vec3 grad = {0, 0, 0}, p = point_at(ray, 1, w->t0, t);
        double f = w->s.ops->value(w->s.self, p, &grad),
               slope = grad.x * ray->d.x + grad.y * ray->d.y + grad.z * ray->d.z;
        newton s = newton_of(f, slope, 0, t, last, (searched){n.lo, n.hi, 0}, 0, 0);
        tell(&w->told, SGT_NEWTON, w->t0 + t, f, slope, w->t0 + n.lo, w->t0 + n.hi);
        if (!(s.go >= 0)) break;
        /* an estimate of the next step's length */
        double shrinks = s.size / last, left = s.size * (shrinks * shrinks);
        last = s.size, t -= s.step;
        if (left <= 0x1p-53 * larger(fabs(t), w->t0 != 0 ? w->foot : 0) || last < 0.25 * t_tol) break;
    }
    return t;
}

/* m is the root as far as G, which has 0, can tell.  If g is nearly flat in a part of n, and steep at m, then
 * m - G / S is as long as that part: a ray that leaves a face of an octahedron close to its next one.  So
 * the signs beside m are asked for.  If they are unlike, the root is between, be it beyond an end of n. */
static sgt_interval between_signs(proof *w, sgt_interval n, double m, sgt_interval G, sgt_interval slope)
{
    double most = sgt_interval_greatest(slope),
           by = 8 * sgt_interval_width(G) / most + 0x1p-50 * fabs(m) + DBL_TRUE_MIN;
    if (!has_zero(G) || !(least_of(slope) < 0x1p-10 * most) || !(2 * by < n.hi - n.lo)) return n;
    sgt_interval left = ask_at(w, m - by, SGT_PROBE), right = ask_at(w, m + by, SGT_PROBE);
    bool unlike = (left.lo > 0 && right.hi < 0) || (left.hi < 0 && right.lo > 0);
    return unlike ? sgt_interval_between(m - by, m + by) : n;
}

/* Looks for the root of *x, where g is monotone with a bounded slope, by STEPS at most: from m, where g is G;
 * from where `value` takes the root to be; then from the middle of what is left.  CUT: *x is what is left
 * then.  What is shorter than 4 ulps of t is as short as it need be: the next step, that of the proof, is far
 * sharper (G of a body excludes 0 at any double).  If the last step does not shorten *x, nothing will. */
static proof_verdict contract(proof *w, sgt_interval *x, sgt_interval slope, double m, sgt_interval G,
                              certain *c)
{
    enum { STEPS = 4 };
    for (int i = 1; !(G.lo > G.hi); i++) {
        double before = sgt_interval_width(*x);
        *x = sgt_interval_intersection(*x, newton_set(m, G, slope));
        if (sgt_interval_is_empty(*x)) return NONE;
        double left = sgt_interval_width(*x),
               enough = larger(0x1p-51 * sgt_interval_greatest(*x), sharp_enough(w, *x));
        if (has_zero(G) || left <= enough || (i == STEPS && !(left <= 0.75 * before)))
            return proof_certify(w, between_signs(w, *x, m, G, slope), m, G, c);
        if (i == STEPS) return CUT;
        m = i == 1 ? guess(w, *x) : sgt_interval_middle(*x);
        G = ask_at(w, m, i == 1 ? SGT_NEWTON : SGT_BISECT);
        if (proof_over(w)) break;
    }
    return UNSURE;
}

/* ---------------------------------------------------------------------- the search */

/* The far rungs, in lengths of w->size.  Beyond FAR a piece is no longer divided once F leaves the range of
 * doubles in its middle.  The border of that range is one number, whatever the unit of length, and costs a
 * thousand evaluations to find.  The undecided stretch then begins at a rung or between two.  The rungs lie
 * where polynomials of degree 2, 3, 4, 5 and 6 do not leave the range within 2^40 of an ordinary unit.
 * Behind the last the next is 2^32 times as far: d may have components that differ by such a factor. */
#define FAR 0x1p60
static const double RUNGS[] = {0x1p34, 0x1p67, 0x1p115, 0x1p225, 0x1p420};

/* The first rung that is far beyond a, a distance from the centre. */
static double rung_beyond(const proof *w, double a)
{
    for (size_t i = 0; i < sizeof RUNGS / sizeof *RUNGS; i++)
        if (RUNGS[i] * w->size > 0x1p8 * a) return RUNGS[i] * w->size;
    return 0x1p32 * a;
}

/* Where a piece is divided: its middle, or the geometric middle if it is long for its distance from the
 * centre.  DBL_MAX stands for an end at infinity, and is no length.  Such a piece is divided at a rung,
 * whatever the unit of length.  sqrt(b / a) has no unit, and sqrt(a) has one: it rounds otherwise in a unit
 * of length that is an odd power of two of this one.  If b / a overflows, the plain middle is taken. */
static double middle_of(const proof *w, sgt_interval x)
{
    double a = x.lo - w->centre, b = x.hi - w->centre, m = (double)NAN;
    if (x.hi == DBL_MAX && a > 0) m = w->centre + rung_beyond(w, a);
    else if (x.lo == -DBL_MAX && b < 0) m = w->centre - rung_beyond(w, -b);
    if (!(m > x.lo && m < x.hi) && a > 0 && b > 4 * a) m = w->centre + a * sqrt(b / a);
    if (!(m > x.lo && m < x.hi) && b < 0 && a < 4 * b) m = w->centre + b * sqrt(a / b);
    return m > x.lo && m < x.hi ? m : sgt_interval_middle(x);
}

/* The end of x that is nearer to the centre, of a piece on one side of it. */
static double near_end(const proof *w, sgt_interval x) { return x.hi <= w->centre ? x.hi : x.lo; }

static bool proof_ended(void *self) { return proof_over(self); }

/* Decides the piece, or divides it. */
static cells_kind proof_classify(void *self, cells *c)
{
    proof *w = self;
    sgt_interval x = {c->k.tau, c->k.hi}, slope, G = sgt_interval_all(),
                 g = proof_ask(w, x, SGT_MARCH, &slope);
    certain root;
    c->at.end = x.hi;
    if (!has_zero(g)) return CELLS_EMPTY;
    if (proof_over(w)) return CELLS_AGAIN;
    double m = middle_of(w, x), past = m, end = near_end(w, x), away = fabs(end - w->centre);
    bool smooth = is_bounded(slope),
         room = m > x.lo && m < x.hi && x.hi - x.lo > w->least && c->count + 2 <= PIECES;
    bool asked = smooth || !is_bounded(g) || !room;
    if (asked) G = ask_at(w, m, SGT_MARCH);
    if (proof_over(w)) return CELLS_AGAIN;
    if (smooth && !has_zero(slope)) {
        sgt_interval rest = x;
        proof_verdict verdict = contract(w, &rest, slope, m, G, &root);
        if (verdict == NONE) return CELLS_EMPTY;
        if (verdict == ROOT && proof_take(w, &root)) {
            c->done = larger(x.hi, root.only.hi);
            return w->found || !proof_over(w) ? CELLS_EMPTY : CELLS_AGAIN;
        }
        if (proof_over(w)) return CELLS_AGAIN;
        if (verdict == CUT) {
            c->k.tau = rest.lo, cells_divide(c, rest.hi, HUGE_VAL);
            return CELLS_OPEN;
        }
    }
    bool noise = asked && has_zero(G) && (sgt_interval_width(g) <= 4 * sgt_interval_width(G)
                           || sgt_interval_greatest(slope) * (x.hi - x.lo) <= sgt_interval_width(G));
    /* out of range at m: at the near end of X, too? */
    if (noise && room && !is_bounded(G) && !(away > FAR * w->size))
        noise = !is_bounded(ask_at(w, end, SGT_MARCH));
    if (!room || noise) return CELLS_NOISE;
    if (smooth && G.lo <= G.hi && !has_zero(G)) {
        double size = G.lo > 0 ? G.lo : -G.hi, down = G.lo > 0 ? slope.hi : -slope.lo,
               up = G.lo > 0 ? -slope.lo : slope.hi;
        m = down > 0 ? sgt_sum_above(m, sgt_quotient_above(-size, down)) : -HUGE_VAL;
        past = up > 0 ? -sgt_sum_above(-past, sgt_quotient_above(-size, up)) : HUGE_VAL;
    } else if (smooth) { /* m may be a root: divide elsewhere */
        m = past = x.lo + 0.375 * (x.hi - x.lo);
    }
    cells_divide(c, m, past);
    return CELLS_OPEN;
}

/* flush asks the enclosure about the stretch, and needs no signs at its ends. */
static bool proof_dark(void *self, cells *c, sgt_status status)
{
    (void)c, (void)status;
    flush(self);
    return true;
}

/* Searches `part`.  false: the search is over, and only what lies before cells_reached is decided. */
static bool search_part(proof *w, sgt_interval part)
{
    sgt_interval pieces[PIECES];
    cells *c = &w->march;
    double from = finite(part.lo), to = finite(part.hi);
    double left = w->centre - 2.125 * w->reach, right = w->centre + 2.125 * w->reach;
    bool far_left = from < w->centre - 8 * w->reach && left<to, far_right = to> w->centre + 8 * w->reach &&
                    right > from;
    c->rest = pieces, c->count = 0, c->gap = 4;
    c->k = (course){.tau = from, .hi = -HUGE_VAL, .h = HUGE_VAL, .growth = 1};
    if (far_right) cells_push(c, right, to), to = right;
    cells_push(c, far_left ? left : from, to);
    if (far_left) cells_push(c, from, left);
    /* an end at infinity is no length */
    double begin = far_left || from == -DBL_MAX ? left : from, stop = to == DBL_MAX ? right : to;
    double away = larger(fabs(begin - w->centre), fabs(stop - w->centre));
    w->least = 0x1p-80 * (stop > begin ? stop - begin : away);
    cells_ops ops = {.over = proof_ended, .classify = proof_classify, .tell = proof_dark};
    bool whole = cells_march(c, w, ops);
    c->rest = NULL;
    return whole || w->found;
}

void sgt_proof_search(proof *w)
{
    sgt_interval all = w->all_t;
    double border = border_of(w);
    bool decided = true;
    count_from(w, 0);
    w->march = (cells){.k.tau = all.lo, .done = -HUGE_VAL};
    w->told_dark = -HUGE_VAL, w->last = sgt_interval_between(-HUGE_VAL, -HUGE_VAL);
    for (int i = 0; i < 2 && decided && !w->found; i++) {
        sgt_interval part = {i ? larger(border, all.lo) : all.lo, i || !(border < all.hi) ? all.hi : border};
        if (i ? !(border < all.hi) : !(all.lo <= border)) continue;
        count_from(w, (i == 0) == (w->far < 0) ? w->far : 0);
        if (w->t0 != 0)
            part = sgt_interval_between(part.lo == all.lo ? w->lo : down_by(part.lo, twofold_of(-w->t0)),
                                        part.hi == all.hi ? w->hi : up_by(part.hi, twofold_of(-w->t0)));
        decided = search_part(w, part);
    }
    if (w->found) return;
    double next = decided ? w->hi : w->march.k.tau;
    if (decided) flush(w);
    sgt_status spent = w->told.opt->proof ? SGT_UNPROVEN : SGT_EXHAUSTED;
    if (w->told.stopped || !decided)
        sgt_proof_stretch(w, w->told.stopped ? SGT_STOPPED : spent,
                          w->march.dark.any ? w->march.dark.lo : next, w->hi);
}

/* ----------------------------------------------------------- public in the library */

bool sgt_proof_bounds_by(sgt_surface s, const sgt_ray *ray, sgt_tails *kept, sgt_span *span)
{
    *span = (sgt_span){.lo = -HUGE_VAL, .hi = HUGE_VAL};
    if (s.ops->span) *span = s.ops->span(s.self, ray);
    sgt_cut_tails(s, ray, span, kept);
    bool by = span->lo > span->hi;
    /* a root at an end of the span is to be inside */
    double room = 0x1p-50 * ((fabs(span->lo) < HUGE_VAL ? fabs(span->lo) : 0) +
                             (fabs(span->hi) < HUGE_VAL ? fabs(span->hi) : 0));
    span->lo -= room, span->hi += room;
    if (!(span->lo >= ray->tmin)) span->lo = ray->tmin;
    if (!(span->hi <= ray->tmax)) span->hi = ray->tmax;
    return !by && span->lo <= span->hi;
}

bool sgt_proof_bounds(sgt_surface s, const sgt_ray *ray, sgt_span *span)
{
    sgt_tails none;
    none.any = false;
    return sgt_proof_bounds_by(s, ray, &none, span);
}

/* |v| within 3 ulps, also where its square would leave the range of a double. */
static double proof_length_of(sgt_vec3 v)
{
    double scale = scale_of(v), x = v.x * scale, y = v.y * scale, z = v.z * scale;
    return sqrt(x * x + y * y + z * z) / scale;
}

proof sgt_proof_of(sgt_surface s, const sgt_ray *ray, const sgt_options *opt, const sgt_span *span,
                   sgt_list *list, bool all)
{
    sgt_interval all_t = {span->lo, span->hi};
    proof w = {.s = s, .ray = ray, .list = list, .all = all, .anew = all, .lo = span->lo, .hi = span->hi,
               .all_t = all_t, .tmin = {ray->tmin, ray->tmin}, .seed = span->seed, .near = HUGE_VAL,
               .rim2 = rim2_of_surface(s),
               .told = {.opt = opt, .budget = opt->max_evals ? opt->max_evals : SGT_DEFAULT_EVALS}};
    const sgt_vec3 o = ray->o, d = ray->d;
    double scale = scale_of(d), l = d.x * scale, m = d.y * scale, n = d.z * scale,
           length2 = l * l + m * m + n * n;
    w.centre = -(o.x * l + o.y * m + o.z * n) / length2 * scale;
    w.reach = proof_length_of(o) / sqrt(length2) * scale;
    if (!(fabs(w.centre) < HUGE_VAL)) w.centre = 0;
    if (!(w.reach > 0 && w.reach < HUGE_VAL)) w.reach = scale;
    w.size = larger(w.reach, 0x1p-64 * scale); /* an origin beside the frame's says nothing of the surface */
    if (!(fabs(w.seed) < HUGE_VAL)) w.seed = w.centre;
    double off = fabs(w.centre) / scale;
    double c = w.centre;
    sgt_vec3 foot = {moved_along(o.x, c, d.x), moved_along(o.y, c, d.y), moved_along(o.z, c, d.z)};
    w.foot = proof_length_of(foot) / sqrt(length2) * scale;
    if (off > 0x1p-400 && off < 0x1p400 && fabs(w.centre) > NEARBY * w.foot && s.ops->enclose)
        w.far = s.ops->own_ && s.ops->own_->enclose ? w.centre : sgt_move_exactly(ray, w.centre, &w.at_far);
    return w;
}

bool sgt_proof_take(proof *w, double t, double t_lo, double t_err)
{
    certain c;
    w->march.done = w->last.hi = w->told_dark = -HUGE_VAL;
    count_from(w, (w->far > 0 && t > border_of(w)) || (w->far < 0 && t < border_of(w)) ? w->far : 0);
    twofold from = two_sum(t, -w->t0);
    double m = w->t0 != 0 ? from.hi + (from.lo + t_lo) : t;
    sgt_interval about = sgt_interval_about(m, t_err), G = ask_at(w, m, SGT_PROBE);
    return proof_certify(w, about, m, G, &c) == ROOT && proof_take(w, &c);
}

/* What sgt_prove_rest says; the search begins at `clear`. */
static void prove_from(sgt_surface s, const sgt_ray *ray, tally *told, bool all, bool near, double clear,
                       sgt_list *list)
{
    sgt_span span;
    if (!sgt_proof_bounds(s, ray, &span)) return;
    if (clear > span.lo) span.lo = clear;
    if (!(span.lo <= span.hi)) return;
    int before = list->count, told_before = told->before;
    proof w = sgt_proof_of(s, ray, told->opt, &span, list, all);
    w.all = all || near;
    w.told = *told;
    sgt_proof_search(&w);
    *told = w.told;
    if (all || (list->count == before && !w.told.stopped)) return;
    int evals = w.told.evals - told_before;
    if (w.told.stopped && (list->count == before || list->last.status != SGT_STOPPED))
        list->last = hit_without(SGT_STOPPED, ray, evals);
    else if (near && !w.told.stopped) list->last = w.nearest;
    list->last.evals = evals, list->count = before + 1;
}

void sgt_prove_rest(sgt_surface s, const sgt_ray *ray, tally *told, bool all, bool near, double clear,
                    sgt_list *list)
{
    const sgt_list before = *list;
    const int told_before = told->before;
    const bool rest = clear > ray->tmin && !all && !near;
    prove_from(s, ray, told, all, near, rest ? clear : -HUGE_VAL, list);
    /* Its cells are others, and may leave open what those of the whole ray do not.  And a stretch that holds
     * `clear`, on which rounding hides F, is cut there: what is left of it is no root of its own. */
    const sgt_hit *hit = &list->last;
    const bool sure = hit->status == SGT_HIT && hit->t - clear > 0x1p10 * hit->t_err,
               open = rest && list->count > before.count && !sure;
    if (!open || told->stopped || spent(told)) return;
    *list = before, told->before = told_before;
    prove_from(s, ray, told, all, near, -HUGE_VAL, list);
}

bool sgt_prove_found(sgt_surface s, const sgt_ray *ray, tally *told, double t, double t_lo, double t_err,
                     sgt_list *list)
{
    sgt_span span;
    if (!sgt_proof_bounds(s, ray, &span)) return false;
    proof w = sgt_proof_of(s, ray, told->opt, &span, list, false);
    w.told = *told;
    bool decided = sgt_proof_take(&w, t, t_lo, t_err) && (w.found || !proof_over(&w));
    *told = w.told;
    return decided;
}
