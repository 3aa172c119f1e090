/* cells.c - every root of a user's surface that has `enclose`, in order, none missed.
 *
 * The stretch is covered by cells, nearest first.  `enclose` gives intervals that contain g and g' over
 * the whole of a cell:
 *
 *     0 is not in g          no root in the cell, or F is undefined all over it
 *     0 is not in g'         g is monotone: one root if the signs at the two ends differ, none if they agree;
 *                            the signs must be certain, else the end is moved
 *     neither                the cell is halved
 *
 * A cell joins an undecided stretch if it cannot be halved, or if g has come within its own rounding.  The
 * next decided cell ends that stretch.  If the signs at its ends are unlike, it is a crossing, and the
 * hit's [lo, hi] is the whole stretch.  If |g| is within its rounding all over, it is a graze.  Else it is
 * UNPROVEN.
 *
 * If the ray's origin is far, g is enclosed on a ray that begins nearby, where there is one
 * (sgt_move_exactly of move.h).
 *
 * Source: Moore 1966; Hansen and Walster 2004, chapter 9. */
#include "move.h"
#include "walk.h"

#include <sagitta/interval.h>

static bool excludes_zero(sgt_interval x) { return x.lo > 0 || x.hi < 0; }

/* Does the ray touch between `dark` and `to`?  g is in `seen` all over that undecided stretch.  It
 * touches, as far as can be told, if g is within 8 times its rounding there.  If so, a graze is added if
 * it is accepted. */
static bool cells_touches(walk *w, const point *dark, double to, sgt_interval seen)
{
    sgt_root r = {.t = 0.5 * dark->tau + 0.5 * to,
                  .t_err = 0.5 * (to - dark->tau) * (1 + 0x1p-40),
                  .status = SGT_GRAZE};
    point middle = sgt_walk_look(w, r.t, SGT_PROBE, dark->tau, to);
    if (over(w) || !(larger(-seen.lo, seen.hi) <= 8 * middle.g_err)) return false;
    w->lowest = w->highest = HUGE_VAL; /* g is bounded all over the stretch: no pole */
    return sgt_walk_take(w, &r, middle);
}

/* The monotone cell [tau, end] has a root very near tmin, an end of the search.  Rounding of the way from t0
 * hides whether that root is accepted: t0 may be a thousand times as far off as the surface is large.  So the
 * root is looked for once more from an origin at tmin, where t is as sharp as the rule of the start asks.  A
 * root that cannot be told from the start there is within t_err of it, and is not accepted (sgt_ray). */
static void cells_from_start(walk *w, double tau, double end, int side)
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

void sgt_walk_cells(walk *w, double lo, double hi)
{
    const local *q = &w->q;
    double tau = lo, h = 0.125 * (hi - lo), past;
    sgt_ray near;
    /* the difference is exact, as the two are near each other */
    double away = fabs(q->t0) > 8 * larger(-lo, hi) ? sgt_move_exactly(w->ray, q->t0 * q->scale, &near) : 0,
           base = q->t0 - away / q->scale;
    /* If `pending` is set, [dark, tau] is undecided.  edge: a point of certain sign, without a root
     * between it and dark. */
    point dark = {.tau = lo}, edge = dark;
    double back = lo;                      /* no root in [back, tau] */
    sgt_interval seen = {0, 0}; /* bounds on g over the undecided stretch */
    bool pending = false;
    int moved = 0;
    while (tau < hi && !over(w)) {
        if (2 * h > hi - tau) h = 0.5 * (hi - tau);
        double m = tau + h, end = tau + 2 * h;
        if (!(m > tau && end > m)) m = sgt_next_above(tau), end = sgt_next_above(m);
        /* Outward, by what t0 + tau and the scale can round. */
        double from = (base + tau) * q->scale, to = (base + end) * q->scale;
        sgt_interval t = {larger(from - 0x1p-52 * fabs(from), -DBL_MAX), to + 0x1p-52 * fabs(to)},
                     slope = {(double)NAN, (double)NAN};
        if (!(t.hi <= DBL_MAX)) t.hi = DBL_MAX;
        sgt_interval g = w->s.ops->enclose(w->s.self, away != 0 ? &near : w->ray, t, &slope);
        tell(&w->told, SGT_MARCH, (q->t0 + m) * q->scale, 0.5 * g.lo + 0.5 * g.hi,
             0.5 * slope.lo + 0.5 * slope.hi, (q->t0 + tau) * q->scale, (q->t0 + hi) * q->scale);
        bool empty = excludes_zero(g) || g.lo > g.hi,
             monotone = !empty && g.lo <= g.hi && excludes_zero(slope) && slope.lo <= slope.hi;
        point left = {.g = (double)NAN}, right = left;
        int signs = 0, side = 0;
        bool start = false; /* a root may be the start, or one right behind it */
        if (monotone) {
            left = sgt_walk_look(w, tau, SGT_MARCH, tau, hi),
            right = sgt_walk_look(w, end, SGT_MARCH, tau, hi);
            if (over(w)) break;
            if (!sign_at(&right) && sign_at(&left) && !pending && moved++ < 16) {
                h *= 0.75;
                continue;
            }
            moved = 0;
            signs = sign_at(&left) * sign_at(&right);
            side = slope.lo > 0 ? 1 : -1;
            /* The start is on the surface, and that root is not accepted.  A second root behind it is one
             * root. */
            if (signs == 0 && tau == lo && w->from_tmin && sign_at(&right) == side) {
                double least = (slope.lo > 0 ? slope.lo : -slope.hi) * q->scale;
                signs = 1;
                start = !acceptance_of(q, tau, (fabs(left.g) + left.g_err) / least, left.p, left.n, left.at,
                                       w->ray->tmin, w->ray->tmax, w->rim2, 0).off;
            }
            double most = larger(fabs(left.g) + left.g_err, fabs(right.g) + right.g_err);
            /* Undecided, with g between its values at the ends.  Not if the slope of `value` is so large
             * that its rounding is beyond the enclosure of g. */
            if (signs == 0 && most <= 4 * larger(-g.lo, g.hi)) {
                monotone = false;
                g = (sgt_interval){-most, most};
            }
        }
        if ((empty || monotone) && pending) { /* the undecided stretch ends here */
            left = sgt_walk_look(w, tau, SGT_PROBE, dark.tau, tau);
            point beyond = left;
            for (double part = 0x1p-10; empty && part < 1 && !sign_at(&beyond) && !over(w); part *= 8)
                beyond = sgt_walk_look(w, tau + part * (end - tau), SGT_PROBE, dark.tau, end);
            bool crossed = !over(w) && sign_at(&edge) * sign_at(&beyond) < 0 &&
                           sgt_walk_between(w, &edge, &beyond, &past);
            if (over(w) && !crossed) break;
            if (crossed)
                sgt_list_cover(w->list, (q->t0 + edge.tau) * q->scale, (q->t0 + beyond.tau) * q->scale);
            else if (sign_at(&edge) * sign_at(&beyond) < 0 || !cells_touches(w, &dark, tau, seen))
                sgt_walk_stretch(w, SGT_UNPROVEN, dark.tau, tau);
            pending = false, back = tau;
        } else if (empty) {
            back = tau, tau = end, h *= 1.5;
        } else if (monotone) {
            double t_tol = w->t_tol;
            /* at the far end a tolerance would hide whether the root is accepted */
            if (!(end < hi)) w->t_tol = 0;
            if (signs < 0) {
                w->hidden.t = (double)NAN;
                start = !sgt_walk_between(w, &left, &right, &past) && !w->off && w->from_tmin &&
                        w->hidden.t - w->ray->tmin <= 2 * w->hidden.t_err;
            }
            if (start && !over(w)) cells_from_start(w, tau, end, side);
            w->t_tol = t_tol;
            if (signs == 0) sgt_walk_stretch(w, SGT_UNPROVEN, tau, end);
            back = signs > 0 ? tau : end;
            if (w->told.stopped || spent(&w->told)) break;
            tau = end, h *= 1.5;
        } else {
            point middle = {.g = (double)NAN};
            if (h <= 0x1p-20 * (hi - lo)) middle = sgt_walk_look(w, m, SGT_MARCH, tau, hi);
            /* 3, as halves would not be narrower */
            bool noise = !isnan(middle.g) && g.hi - g.lo <= (sign_at(&middle) ? 3 : 8) * middle.g_err;
            double least = 0x1p-52 * fabs(m) + 0x1p-53 * fabs(base) + 0x1p-90 * (hi - lo);
            if (h > least && !noise && isnan(left.g)) {
                h *= 0.5;
            } else {
                if (!pending) {
                    dark = edge = sgt_walk_look(w, tau, SGT_PROBE, tau, end), seen = g;
                    for (double part = 0x1p-10; back < tau && part < 1 && !sign_at(&edge) && !over(w);
                         part *= 8)
                        edge = sgt_walk_look(w, tau - part * (tau - back), SGT_PROBE, back, end);
                }
                if (!(g.lo >= seen.lo)) seen.lo = g.lo;
                if (!(g.hi <= seen.hi)) seen.hi = g.hi;
                pending = true;
                tau = end, h *= 1.5;
            }
        }
    }
    if (w->found) return;
    if (over(w))
        sgt_walk_stretch(w, w->told.stopped ? SGT_STOPPED : SGT_EXHAUSTED, pending ? dark.tau : tau, hi);
    else if (pending && !cells_touches(w, &dark, hi, seen)) sgt_walk_stretch(w, SGT_UNPROVEN, dark.tau, hi);
}
