/* cells.c - every root of a surface that can enclose itself, in order, none missed.
 *
 * The stretch is covered by cells, nearest first.  With intervals that contain g and g' over the cell:
 *     0 is not in g         there is no root in it (nor where F is undefined all over);
 *     0 is not in g'        g is monotone: one root if the signs at the ends differ, none if they agree; the
 *                           signs must be certain, else the end is moved.
 * A cell that is neither is halved; where it cannot be, or where g has come within its own rounding,
 * it joins an undecided stretch, that ends with the next cell that is decided: unlike signs at its ends are
 * a crossing, and the hit speaks of the whole stretch.  (Moore 1966; Hansen and Walster 2004, chapter 9.) */
#include "walk.h"

static bool excludes_zero(sgt_interval x) { return x.lo > 0 || x.hi < 0; }

void sgt_walk_cells(walk *w, double lo, double hi)
{
    const local *q = &w->q;
    double tau = lo, h = 0.125 * (hi - lo), past;
    point dark = {.tau = lo}; /* [dark, tau] is undecided */
    bool pending = false;
    int moved = 0;
    while (tau < hi && !over(w)) {
        if (2 * h > hi - tau) h = 0.5 * (hi - tau);
        double m = tau + h, end = tau + 2 * h;
        if (!(m > tau && end > m)) m = nextafter(tau, HUGE_VAL), end = nextafter(m, HUGE_VAL);
        /* outward by what t0 + tau and the scale can round */
        double from = (q->t0 + tau) * q->scale, to = (q->t0 + end) * q->scale;
        sgt_interval t = {larger(from - 0x1p-52 * fabs(from), -DBL_MAX), to + 0x1p-52 * fabs(to)}, slope = {(double)NAN, (double)NAN};
        if (!(t.hi <= DBL_MAX)) t.hi = DBL_MAX;
        sgt_interval g = w->s.ops->enclose(w->s.self, w->ray, t, &slope);
        tell(&w->told, SGT_MARCH, (q->t0 + m) * q->scale, 0.5 * g.lo + 0.5 * g.hi, 0.5 * slope.lo + 0.5 * slope.hi, from, (q->t0 + hi) * q->scale);
        bool empty = excludes_zero(g) || g.lo > g.hi, monotone = !empty && g.lo <= g.hi && excludes_zero(slope) && slope.lo <= slope.hi;
        if ((empty || monotone) && pending) { /* the undecided stretch ends here */
            point left = sgt_walk_look(w, tau, SGT_PROBE, dark.tau, tau);
            bool crossed = !over(w) && sign_at(&dark) * sign_at(&left) < 0 && sgt_walk_between(w, &dark, &left, &past);
            if (over(w) && !crossed) break;
            if (crossed) sgt_list_cover(w->list, (q->t0 + dark.tau) * q->scale, (q->t0 + tau) * q->scale);
            else sgt_walk_stretch(w, SGT_UNPROVEN, dark.tau, tau);
            pending = false;
        } else if (empty) {
            tau = end, h *= 1.5;
        } else if (monotone) {
            point left = sgt_walk_look(w, tau, SGT_MARCH, tau, hi), right = sgt_walk_look(w, end, SGT_MARCH, tau, hi);
            if (over(w)) break;
            if (!sign_at(&right) && moved++ < 16) {
                h *= 0.75;
                continue;
            }
            moved = 0;
            int signs = sign_at(&left) * sign_at(&right);
            if (signs == 0 && tau == lo && w->from_tmin) { /* the start is on the surface, and does not count; a root behind it is one */
                signs = sign_at(&right) * (slope.lo > 0 ? 1 : -1) > 0 ? 1 : 0;
            }
            if (signs < 0) sgt_walk_between(w, &left, &right, &past);
            else if (signs == 0) sgt_walk_stretch(w, SGT_UNPROVEN, tau, end);
            if (w->told.stopped || spent(&w->told)) break;
            tau = end, h *= 1.5;
        } else {
            point middle = {.g = (double)NAN};
            if (h <= 0x1p-20 * (hi - lo)) middle = sgt_walk_look(w, m, SGT_MARCH, tau, hi);
            bool noise = !isnan(middle.g) && !sign_at(&middle) && g.hi - g.lo <= 8 * middle.g_err;
            double least = 0x1p-52 * fabs(m) + 0x1p-53 * fabs(q->t0) + 0x1p-90 * (hi - lo);
            if (h > least && !noise) {
                h *= 0.5;
            } else {
                if (!pending) dark = sgt_walk_look(w, tau, SGT_PROBE, tau, end);
                pending = true;
                tau = end;
            }
        }
    }
    if (w->found) return;
    if (over(w)) sgt_walk_stretch(w, w->told.stopped ? SGT_STOPPED : SGT_EXHAUSTED, pending ? dark.tau : tau, hi);
    else if (pending) sgt_walk_stretch(w, SGT_UNPROVEN, dark.tau, hi);
}
