// SPDX-License-Identifier: MIT
/* ahead.c - the way of a ray from some point on: nothing is met, or one root is parted from all others.
 *
 * WHAT IS LOOKED AT is not F = z - s(x, y) but a function G of t without the root of the sag: a polynomial,
 * or one with a profile in it.  Each root of F is one of G.  G has others, on sheets that are no part of the
 * surface.  So that G has no root in a stretch says that F has none; that it has one says no more than that
 * F has one at most.  Whether it has, and where, is told by F itself (ray/lanes.c, ray/walk.c).
 *
 * THE MARCH goes from t to e = t + h, where G is at least a and b away from zero:
 *
 *     G is not 0 all over [t, e], or F has        nothing is met before e
 *     no root there for another reason
 *     like signs, s G'' <= B all over, and        the same: s G is above the parabola through both
 *     h sqrt(B / 2) < sqrt a + sqrt b             (ray/wings.c, THE MARCH)
 *     unlike signs, |G''| <= B, and               G' is (a + b) / h at least in the mean, and differs from
 *     a + b > B h^2 / 2                           that by B h / 2 at most: one root
 *     else                                        h is made shorter
 *
 * THE START.  Let |F| be at most f where the march begins, on the surface or next to it, and G = K F.  As
 * far as |G'| is between l > 0 and u, G has one root at most.  If F has it, at t* behind the start, then t*
 * <= f |K_0| / l, and |F'| = |G'| / |K| there.  So t* |F'| <= f (u / l) |K_0 / K|.  If that is less than
 * 2^-48 of the terms of the rule of the start, at t*, the root is not accepted (accept.h), and nothing else
 * is met so far.
 *
 * A step is guessed from the slope, which is not relied on.  What is known of G'' over a stretch holds in
 * each part of it.  A root of G at which F certainly has none is stepped over: all along some stretch that
 * holds it.
 *
 * ROUNDING.  Each number is off by less than 2^-43 of the sum of the magnitudes of all that it is made of,
 * as there are at most 2^9 roundings of 2^-53, and 2^-900 for underflow.  Bounds are made wider by that, and
 * the comparisons by 2^-20.  With a NaN none of them holds. */
#include "ahead.h"

#include "../../num/bits.h"

enum { AHEAD_STEPS = 48 };

/* ------------------------------------------------------------------------ polynomials */

static double size_at(const ahead_poly *p, double t)
{
    double most = 0;
    for (int i = p->degree; i >= 0; i--) most = most * fabs(t) + p->most[i];
    return most;
}

ahead_look sgt_ahead_poly_at(const ahead_poly *p, double t)
{
    double g = 0, slope = 0, most = 0, steep = 0, far = fabs(t);
    for (int i = p->degree; i >= 0; i--) {
        slope = slope * t + g, g = g * t + p->c[i];
        steep = steep * far + most, most = most * far + p->most[i];
    }
    return (ahead_look){g, slope, AHEAD_LOST * most + AHEAD_LEAST, AHEAD_LOST * steep + AHEAD_LEAST};
}

sgt_interval sgt_ahead_poly_over(const ahead_poly *p, double from, double to)
{
    double a = (p->c[2] * from + p->c[1]) * from + p->c[0], b = (p->c[2] * to + p->c[1]) * to + p->c[0],
           lo = smaller(a, b), hi = larger(a, b), turn = -0.5 * p->c[1] / p->c[2];
    if (turn > from && turn < to) {
        double at = (p->c[2] * turn + p->c[1]) * turn + p->c[0];
        lo = smaller(lo, at), hi = larger(hi, at);
    }
    double off = AHEAD_LOST * size_at(p, larger(fabs(from), fabs(to))) + AHEAD_LEAST;
    return (sgt_interval){lo - off, hi + off};
}

ahead_poly sgt_ahead_poly_bend(const ahead_poly *p)
{
    ahead_poly b = {.degree = p->degree > 2 ? p->degree - 2 : 0};
    for (int i = 2; i <= p->degree; i++)
        b.c[i - 2] = i * (i - 1) * p->c[i], b.most[i - 2] = i * (i - 1) * p->most[i];
    return b;
}

bool sgt_ahead_poly_keeps(const ahead_poly *p, double t, double sign)
{
    double c[5], most[5];
    for (int i = 0; i <= p->degree; i++) c[i] = p->c[i], most[i] = p->most[i];
    for (int i = 0; i < p->degree; i++)
        for (int j = p->degree - 1; j >= i; j--) c[j] += t * c[j + 1], most[j] += fabs(t) * most[j + 1];
    for (int i = 0; i <= p->degree; i++)
        if (!(most[i] == 0 || sign * c[i] > AHEAD_LOST * most[i] + AHEAD_LEAST)) return false;
    return true;
}

/* -------------------------------------------------------------------------- the march */

/* G at the two ends, certainly at least this far from zero; the length; s G'' and |G''| at most.  A NaN tells
 * nothing. */
static bool stays_clear(double a, double b, double h, double most)
{
    return most <= 0 || h * sqrt(0.5 * most) * (1 + 0x1p-20) < sqrt(a) + sqrt(b);
}

static bool parted(double a, double b, double h, double most)
{
    return a + b > (0.5 + 0x1p-20) * most * h * h;
}

/* The next step, if G falls to zero at this rate, or rises (fall < 0). */
static double step_guessed(double a, double fall, double most, double bend, double room)
{
    double to_root = a / fall;
    if (fall > 0 && 3 * bend * to_root < fall && 1.25 * to_root < room) return 1.25 * to_root;
    if (!(most > 0)) return room;
    double safe = fall > 0 ? 1.8 * a / (fall + sqrt(fall * fall + 2 * most * a)) : 0.98 * sqrt(2 * a / most);
    return safe < room ? safe : room;
}

/* How far behind the first of two points of unlike signs the root is, as the parabola has it that has G at
 * both and G' at the first. */
static double root_of_ends(const ahead_look *a, const ahead_look *b, double h)
{
    double secant = h * (a->g / (a->g - b->g)), bend = (b->g - a->g - a->slope * h) / (h * h),
           root = sqrt(a->slope * a->slope - 4 * bend * a->g), up = copysign(root, b->g - a->g),
           by = -2 * a->g / (a->slope + up);
    return by > 0 && by < h ? by : secant;
}

/* G has one root between t and t + h, near t + root, where F has none.  How far behind t a stretch ends
 * that holds that root and none of F; 0: not known. */
static double past_root(const ahead_ops *ops, const void *w, double t, double root, double h, double sign)
{
    if (ops->off(w, t, t + h)) return h;
    for (double off = 0x1p-6 * h; off > 0x1p-24 * h; off *= 0x1p-6) {
        double from = t + larger(root - off, 0), to = t + smaller(root + off, h);
        if (!ops->off(w, from, to)) continue;
        ahead_look a = ops->at(w, from), b = ops->at(w, to);
        return sign * a.g > a.err && -sign * b.g > b.err ? to - t : 0;
    }
    return 0;
}

/* THE START: the step behind it.  0: not known. */
static double step_behind(const ahead_ops *ops, const void *w, const ahead_look *at, double length,
                          const sgt_ahead *ahead)
{
    double t = ahead->from, h = length;
    const double slope = fabs(at->slope);
    for (int i = 0; i < 6; i++, h *= 0.25) {
        if (!(t + h > t && t + h < HUGE_VAL)) return 0;
        ahead_over over = ops->over(w, t, t + h);
        double bend = larger(-over.bend.lo, over.bend.hi), most = 0x1p-6 * slope / bend,
               step = most < h ? most : h;
        if (over.none || !(bend < HUGE_VAL) || (step < 0x1p-4 * h && i < 5)) continue;
        double off = at->slope_err + bend * step, least = (slope - off) * (1 - 0x1p-20);
        ahead_start start;
        if (!(least > 0 && ops->start(w, t, ahead->f, least, &start) && start.width < step)) return 0;
        double terms = ahead->f * start.ratio * ((slope + off) / least);
        return terms < START_ULPS * start.terms * (1 - 0x1p-20) ? step : 0;
    }
    return 0;
}

sgt_ahead_kind sgt_look_ahead(const ahead_ops *ops, const void *w, sgt_ahead *ahead)
{
    const double end = ahead->to;
    double t = ahead->from, known_to = t, known = 0, h = end - t;
    ahead_look at = ops->at(w, t);
    ahead_over over = {{0, 0}, {0, 0}, false};
    ahead->clear = t;
    if (!(end > t && fabs(t) < HUGE_VAL)) return end == t ? AHEAD_NONE : AHEAD_OPEN;
    if (ahead->f < HUGE_VAL) {
        double step = step_behind(ops, w, &at, smaller(ahead->length, end - t), ahead);
        if (!(step > 0)) return AHEAD_OPEN;
        ahead->clear = t = known_to = t + step, h = end - t, at = ops->at(w, t);
        if (!(fabs(at.g) > at.err)) return AHEAD_OPEN;
    }
    h *= ahead->part;
    if (!(h < HUGE_VAL)) h = larger(4 * fabs(t - ahead->start), ahead->length);
    for (int i = 0; i < AHEAD_STEPS; i++) {
        const double a = fabs(at.g) - at.err, sign = at.g > 0 ? 1 : -1;
        const bool certain = a > 0;
        if (!(end < HUGE_VAL) && ops->tail(w, t, certain ? sign : 0)) return AHEAD_NONE;
        double to = t + h;
        if (!(to < end)) to = end, h = end - t;
        if (!(to > t && h > 0x1p-36 * fabs(t) && to < 0x1p200)) return AHEAD_OPEN;
        if (to > known_to || 4 * h <= known) over = ops->over(w, t, to), known_to = to, known = h;
        bool moves = over.none || over.g.lo > 0 || over.g.hi < 0;
        ahead_look next = {0, 0, HUGE_VAL, HUGE_VAL};
        if (!(moves && to == end)) next = ops->at(w, to);
        const double b = fabs(next.g) - next.err, greatest = larger(-over.bend.lo, over.bend.hi),
                     most = sign > 0 ? over.bend.hi : -over.bend.lo, fall = -sign * at.slope;
        const bool like = b > 0 && sign * next.g > 0, unlike = certain && b > 0 && sign * next.g < 0;
        double root = unlike ? root_of_ends(&at, &next, h) : h;
        moves = moves || (certain && like && stays_clear(a, b, h, most));
        if (unlike && !moves && parted(a, b, h, greatest)) {
            double past = ops->off(w, t + root, t + root) ? past_root(ops, w, t, root, h, sign) : 0;
            if (!(past > 0)) {
                ahead->lo = t, ahead->hi = to, ahead->seed = t + root;
                return AHEAD_ONE;
            }
            moves = true;
            if (past < h) to = t + past, h = past, next = ops->at(w, to);
        }
        if (moves) {
            const double rest = fabs(next.g) - next.err, falls = next.g > 0 ? -next.slope : next.slope,
                         up = next.g > 0 ? over.bend.hi : -over.bend.lo;
            ahead->clear = t = to, at = next;
            if (!(t < end)) return AHEAD_NONE;
            h = t < known_to ? known_to - t : 2 * h;
            if (rest > 0 && !over.none && greatest < HUGE_VAL) h = step_guessed(rest, falls, up, greatest, h);
        } else if (!certain || !(greatest < HUGE_VAL)) {
            h *= 0.25;
        } else if (unlike) {
            h = root > 0.3 * h ? 0.8 * root : 1.3 * root;
        } else {
            double shorter = step_guessed(a, fall, most, greatest, h);
            h = shorter < 0.125 * h ? 0.25 * h : shorter < 0.75 * h ? shorter : 0.5 * h;
        }
    }
    return AHEAD_OPEN;
}
