// SPDX-License-Identifier: MIT
/* aim_proof.c - that no launch ray of a beam meets the point: branch and bound over the box of (u, v).
 *
 * A part of the box is traced as a whole (bundle.c).  That gives x and y at the stop as forms
 * c + a U + b V +- e over the part, |U|, |V| <= 1.  The part is done
 *
 *     if no ray of it gets to the stop,
 *     or if X is not in the range of x, or Y not in that of y,
 *     or if U or V would be outside of [-1, 1]: with M about the inverse of the linear part J,
 *     M (x - X, y - Y) = 0 is
 *
 *         U + M c = rest,   |rest| <= |M| e + |M J - 1| (1, 1),
 *
 *     an interval for U and one for V.  (The interval Newton method: Neumaier 1990, Interval Methods for
 *     Systems of Equations, chapter 5.)
 *
 * Else it is cut down to these intervals.  If that has made it much smaller, it is traced again; if not, or
 * if nothing is known of so large a part, it is divided in two: across the parameter by which x and y change
 * more, if that is known.
 *
 * NO ROOM is needed but a stack: parts are taken depth first, and each division puts one part on it.  A part
 * that is no longer than NARROW of the box in both parameters is not divided.  The point is nearly met there,
 * or rays graze; then there is no proof.
 *
 * A RAY AFTER ALL.  If a part has been cut down to LOOK of the box, a ray of it may well meet the point, and
 * the starts have not found it.  The search is asked to begin there, up to LOOKS times. */
#include "bundle.h"

enum { LOOKS = 6 };
static const double NARROW = 0x1p-24, LOOK = 0x1p-6, SMALLER = 0.7;

aim_proof sgt_aim_proof_of(const aim_task *task, int most)
{
    aim_proof w = {.task = task, .most = most, .height = 1};
    w.stack[0] = (aim_part){task->beam->u, task->beam->v};
    if (!sgt_bundle_offered(task)) w.most = 0;
    return w;
}

/* The part of a box in which U is in x, rounded outward; the rest of it if that is not known. */
static sgt_interval part_of(sgt_interval box, sgt_interval x)
{
    double middle = sgt_interval_middle(box), half = larger(box.hi - middle, middle - box.lo);
    double size = FORM_ROUND * (fabs(box.lo) + fabs(box.hi));
    sgt_interval part = {middle + half * x.lo - size, middle + half * x.hi + size};
    if (!(part.lo >= box.lo)) part.lo = box.lo;
    if (!(part.hi <= box.hi)) part.hi = box.hi;
    return part;
}

/* U + (p x + q y) = 0 is an interval for U; i: 0 for U, 1 for V. */
static sgt_interval solved_for(linear x, linear y, double p, double q, int i)
{
    linear sum = form_sum(form_scaled(x, p), form_scaled(y, q));
    double left = i == 0 ? fabs(sum.a - 1) + fabs(sum.b) : fabs(sum.a) + fabs(sum.b - 1);
    double by = (sum.e + left + FORM_ROUND * (1 + fabs(sum.c))) * (1 + FORM_ROUND);
    return (sgt_interval){-sum.c - by, -sum.c + by};
}

/* Cuts the part down.  false: no ray of it meets the point. */
static bool aim_cut_down(const aim_task *task, linear x, linear y, aim_part *part)
{
    x = form_plus(x, -task->wanted.x), y = form_plus(y, -task->wanted.y);
    sgt_interval rx = form_range(x), ry = form_range(y);
    if (rx.lo > 0 || rx.hi < 0 || ry.lo > 0 || ry.hi < 0) return false;
    double det = x.a * y.b - x.b * y.a;
    if (!(fabs(det) > 0x1p-30 * (form_linear(x) * form_linear(y)))) return true;
    sgt_interval u = solved_for(x, y, y.b / det, -x.b / det, 0),
                 v = solved_for(x, y, -y.a / det, x.a / det, 1);
    if (u.lo > 1 || u.hi < -1 || v.lo > 1 || v.hi < -1) return false;
    part->u = part_of(part->u, u), part->v = part_of(part->v, v);
    return true;
}

static double share(sgt_interval part, sgt_interval box)
{
    return box.hi > box.lo ? (part.hi - part.lo) / (box.hi - box.lo) : 0;
}

/* Divides the part and puts both on the stack.  false: it is too narrow, or there is no room. */
static bool aim_divide(aim_proof *w, aim_part part, bool known, linear x, linear y)
{
    const sgt_beam *b = w->task->beam;
    double su = share(part.u, b->u), sv = share(part.v, b->v);
    double u = known ? fabs(x.a) + fabs(y.a) : su, v = known ? fabs(x.b) + fabs(y.b) : sv;
    bool across_u = su > NARROW && (u >= v || !(sv > NARROW));
    if (!(su > NARROW || sv > NARROW) || w->height + 2 > AIM_DEEP) return false;
    aim_part first = part, second = part;
    if (across_u)
        first.u.hi = second.u.lo = sgt_interval_middle(part.u);
    else
        first.v.hi = second.v.lo = sgt_interval_middle(part.v);
    w->stack[w->height++] = second, w->stack[w->height++] = first;
    return true;
}

aim_verdict sgt_aim_proof_next(aim_proof *w)
{
    const sgt_beam *b = w->task->beam;
    while (w->height > 0 && !w->given_up) {
        if (w->boxes >= w->most) return PROOF_OPEN;
        w->boxes++;
        aim_part part = w->stack[--w->height], before = part;
        linear x = {0, 0, 0, 0}, y = x;
        bundle_fate fate = sgt_bundle_trace(w->task, part.u, part.v, w->kept, &x, &y);
        if (fate == BUNDLE_GONE) continue;
        bool known = fate == BUNDLE_THERE && form_linear(x) + form_linear(y) < HUGE_VAL;
        if (known && !aim_cut_down(w->task, x, y, &part)) continue;
        double su = share(part.u, b->u), sv = share(part.v, b->v);
        bool smaller = share(part.u, before.u) < SMALLER || share(part.v, before.v) < SMALLER;
        bool narrow = !(su > NARROW || sv > NARROW);
        if (known && smaller && !narrow)
            w->stack[w->height++] = part; /* where it was */
        else if (!aim_divide(w, part, known, x, y))
            w->given_up = true;
        if (known && su < LOOK && sv < LOOK && (smaller || narrow) && w->looks < LOOKS) {
            w->looks++;
            w->u = sgt_interval_middle(part.u), w->v = sgt_interval_middle(part.v);
            return PROOF_LOOK;
        }
    }
    return w->given_up ? PROOF_OPEN : PROOF_DONE;
}
