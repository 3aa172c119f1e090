// SPDX-License-Identifier: MIT
/* step.h - the quick form of a search along a ray, for any surface: its single steps.
 *
 * QUICK, THEN CAREFUL.  From a good guess Newton's method needs three or four steps, and none of the
 * safeguards of solve/root.c.  So it is first tried without them:
 *
 *     1. Each step has to be at most 0.6 of the last, and to stay inside the stretch.  It ends when |g| is
 *        within its rounding, or the tolerance is met.
 *     2. F is looked at on both sides of the root, at the distance root.c would use: twice what |g|, its
 *        rounding and the slope can move it.  If a sign is not certain: at four and sixteen times that.
 *     3. Certain, opposite signs are a hit, the same claim as that of root.c.
 *
 * If a lower bound on |g'| is known for the whole stretch (the built-in sags within a rim), |g| at the
 * root says as much as step 2, which is left out.  If a step breaks the rule, and the span has at most one
 * root, certain and like signs at both of its ends are a miss.  In any other case the quick form has no
 * answer, and the careful path begins anew.  The evaluations of the quick form are counted.
 *
 * BIT FOR BIT.  The single ray (solve/root.h, ray/walk.c) and the lanes of a batch (ray/lanes.c) call the
 * functions below: the same operations in the same order, and so the same bits.  They have no branches; a
 * loop around them becomes vector code. */
#ifndef SGT_SOLVE_STEP_H
#define SGT_SOLVE_STEP_H

#include "accept.h"

enum { QUICK_STEPS = 12, PROBES = 3, MARCH_STEPS = 64, SHARPER = 3 };

/* ------------------------------------------------------------ the ray made local */

typedef struct approach {
    local q;
    double inverse;     /* 1 / q.scale, exactly */
    double lo, hi;      /* what is searched, counted from t0 */
    double nearest;     /* the t0 nearest the origin of the surface's frame; NaN: not asked for */
    bool passes;        /* no part of the ray is in the span */
    bool seeded;        /* t0 is the surface's own guess, or the end nearest to it */
    bool middle;        /* t0 is the middle of a stretch with two ends */
    bool from_tmin;     /* the search begins at tmin */
    bool known;         /* the local origin is finite, and the direction was scaled exactly */
} approach;

/* Makes the ray local, and cuts the span to its ends (cut: tmin and tmax).
 *
 *     back              a root at the near end of the span is to be inside: the end is moved back by so much
 *                       of where it is
 *     everywhere        a ray without a seed and without two ends is searched, too: `nearest` is set
 *     early             all that the span promises holds before tmin, too.  The stretch then begins earlier,
 *                       so that a root that is the start itself lies inside, and can be told to be the start
 *
 * With `early` the stretch begins earlier by a part (2^-4) of how far the ray is from the origin.  So
 * Newton's steps, which may pass the root, do not leave it. */
SGT_INLINE approach approach_of(sgt_vec3 o, sgt_vec3 d, sgt_interval cut, sgt_interval span, double seed,
                                double back, bool everywhere, bool early)
{
    approach a;
    double tmin = cut.lo, tmax = cut.hi, from = span.lo, to = span.hi;
    double scale = scale_of(d), inverse = inverse_of_scale(d);
    bool passes = from > to;
    double to_end = to, span_from = from;
    from = from >= tmin ? from : tmin, to = to <= tmax ? to : tmax; /* a NaN end is no end */
    double lo = from * inverse, hi = to * inverse;
    a.q.scale = scale, a.q.l = d.x * scale, a.q.m = d.y * scale, a.q.n = d.z * scale;
    a.inverse = inverse, a.nearest = (double)NAN;
    if (everywhere)
        a.nearest = -(o.x * a.q.l + o.y * a.q.m + o.z * a.q.n) /
                    (a.q.l * a.q.l + a.q.m * a.q.m + a.q.n * a.q.n);
    bool ends = (lo > -HUGE_VAL) & (hi < HUGE_VAL);
    seed *= inverse;
    a.passes = passes | (lo > hi);
    a.seeded = fabs(seed) < HUGE_VAL;
    a.middle = ends & !a.seeded;
    /* The middle of two numbers, or of one and itself: gcc would move code that only one branch reads into
     * that branch. */
    double left = ends ? lo : a.nearest, right = ends ? hi : a.nearest, reach = lo > -HUGE_VAL ? lo : 0;
    left = a.seeded ? seed : left, right = a.seeded ? seed : right;
    double t0 = 0.5 * left + 0.5 * right;
    t0 = t0 < lo ? lo : t0;
    t0 = t0 > hi ? hi : t0;
    a.q.t0 = t0, a.q.t0_lo = 0, a.q.t0_err = 0;
    a.q.x = moved_along(o.x, t0, a.q.l), a.q.y = moved_along(o.y, t0, a.q.m),
    a.q.z = moved_along(o.z, t0, a.q.n);
    a.q.xa = fabs(a.q.x), a.q.ya = fabs(a.q.y), a.q.za = fabs(a.q.z);
    /* no component has underflown */
    bool whole = (a.q.l * inverse == d.x) & (a.q.m * inverse == d.y) & (a.q.n * inverse == d.z);
    a.known = whole & ((a.q.x - a.q.x) + (a.q.y - a.q.y) + (a.q.z - a.q.z) == 0);
    a.from_tmin = !(from > tmin);
    back = a.from_tmin ? 0 : back;
    double end = to_end * inverse, most = end + 0x1p-50 * fabs(end);
    hi += (tmax <= to ? 0x1p-44 : 0x1p-50) * fabs(hi); /* a root at tmax is to be inside, */
    hi = hi > most ? most : hi;                        /* and what is behind the span is not */
    lo -= back * (fabs(reach) + fabs(t0));
    double begin = lo - 0x1p-4 * (fabs(reach) + fabs(t0) + (a.q.xa + a.q.ya + a.q.za));
    begin = larger(span_from * inverse, begin);
    lo = (early & (begin < lo)) ? begin : lo;
    a.lo = lo - t0, a.hi = hi - t0;
    return a;
}

/* ---------------------------------------------------------------- one evaluation */

/* What is known at p = x + tau l, with the gradient n there: the slope; place, a bound on what rounding of
 * the point does to F; ex, ey, ez, the sums of terms of the point's coordinates, each off by u of them. */
typedef struct around { double slope, place, ex, ey, ez; sgt_vec3 p, n; } around;

/* none: 0, which replaces a bound that is NaN.  (If gcc could see that it is 0, it would make two ways of
 * it, with a division on each.) */
SGT_INLINE around around_of(const local *q, double tau, sgt_vec3 p, sgt_vec3 grad, double none)
{
    around a = {.slope = grad.x * q->l + grad.y * q->m + grad.z * q->n, .p = p, .n = grad};
    a.ex = fabs(q->x) + fabs(tau * q->l) + fabs(p.x), a.ey = fabs(q->y) + fabs(tau * q->m) + fabs(p.y),
    a.ez = fabs(q->z) + fabs(tau * q->n) + fabs(p.z);
    double place = SGT_U * (a.ex * fabs(grad.x) + a.ey * fabs(grad.y) + a.ez * fabs(grad.z));
    a.place = place >= 0 ? place : none; /* NaN: the gradient says nothing */
    return a;
}

/* Does the surface's own rounding have to be asked for, too?  Far from the root it would change nothing:
 * where |g| is above 1024 times what rounding of the point does to it, and Newton's steps shrink.  What
 * decides in the end is asked beside the root.  last: the step before; NaN: always ask. */
SGT_INLINE bool close_of(double g, double slope, double place, double last, double f_tol)
{
    return (fabs(g) <= 0x1p10 * place) | (fabs(g) <= f_tol) | !(fabs(g) <= 0.6 * last * fabs(slope));
}

/* 1, -1, or 0 where it is not certain. */
SGT_INLINE double sign_of(double g, double g_err)
{
    return (g > g_err ? 1.0 : 0.0) - (g < -g_err ? 1.0 : 0.0);
}

/* If `least` is known, F rises all along the stretch where n > 0, and falls where n < 0
 * (departure/departure.c, THE SPAN).  So there is no root if the sign at the first end is that behind the
 * root, or at the last end that before it.  This holds even if F is not defined at the other end: the
 * corners of a rectangle are farther from the axis than its sides. */
SGT_INLINE bool gone_by(double sign_first, double sign_last, double n, double least)
{
    return (least > 0) & ((sign_first * n > 0) | (sign_last * n < 0));
}

/* -------------------------------------------------------------------- Newton's step */

/* The step, to be taken from t: the root of g's tangent. */
SGT_INLINE double step_of(double g, double slope) { return g / slope; }

/* What is searched: [lo, hi], and a lower bound on |g'| all over it; 0: not known. */
typedef struct searched { double lo, hi, least; } searched;

/* ready, go: true if not negative.  They are the lesser or greater margin of two conditions, as gcc works
 * with masks one by one, which is as slow as whole rows. */
typedef struct newton { double step, size, ready, go; } newton;

/* Newton's step from tau.
 * - ready: the root is as near as it needs to be.  If steps have ceased to shrink at 64 times the known
 *   rounding, F is noisier than it says; then the signs beside the root decide.
 * - go: the next point is inside, and the step has shrunk.
 *
 * last is finite, so that an infinite step does not shrink. */
SGT_INLINE newton newton_of(double g, double slope, double g_err, double tau, double last, searched in,
                            double t_tol, double f_tol)
{
    newton s = {.step = step_of(g, slope)};
    s.size = fabs(s.step);
    double near = larger(f_tol, g_err), noisy = larger(near, 64 * g_err), most = 0.6 * last,
           next = tau - s.step;
    near = s.size <= most ? near : noisy;
    double by_size = near - fabs(g), by_width = t_tol * fabs(slope) - 2 * (fabs(g) + g_err),
           behind = next - in.lo, before = in.hi - next;
    s.ready = larger(by_width, by_size); /* by_width may be NaN */
    double inside = behind < before ? behind : before, shrinks = most - s.size;
    s.go = inside < shrinks ? inside : shrinks; /* if one is NaN, so is shrinks */
    return s;
}

/* The distance from the root at which F is looked at.  Infinite or NaN if the slope says nothing.  A t_tol
 * widens it as far as the stretch `in` has room: what is outside is not the same root's to tell. */
SGT_INLINE double width_of(double g, double slope, double g_err, double tau, double t_tol, searched in)
{
    double w = 2 * (fabs(g) + g_err) / fabs(slope), ulp = fabs(tau) * DBL_EPSILON;
    double before = tau - in.lo, behind = in.hi - tau, room = 0.75 * (before < behind ? before : behind),
           most = t_tol < room ? t_tol : room;
    w = most > w ? most : w;
    ulp = ulp > DBL_TRUE_MIN ? ulp : DBL_TRUE_MIN;
    return ulp > w ? ulp : w;
}

/* If |g'| is at least `least` all over the stretch, g has a root within (|g| + g_err) / least of tau, and
 * no other, provided that this interval is inside the stretch. */
typedef struct certified { double tau_err; bool inside; } certified;

SGT_INLINE certified certified_of(double tau, double g, double g_err, searched in)
{
    double e = (fabs(g) + g_err) / in.least * (1 + 8 * SGT_U), left = tau - e, right = tau + e;
    return (certified){larger(e, larger(tau - left, right - tau)),
                       (left > in.lo) & (right < in.hi) & (in.least > 0)};
}

/* -------------------------------------------------------------------- a root found */

typedef struct acceptance {
    double t, t_lo, t_err, p_err;
    bool accepted;
    bool off;     /* the root is certainly not accepted */
} acceptance;

/* Within what a root is accepted.  rim2 is infinite without a rim.  Of a root that is nearer to tmax, or to
 * the end of the start's reach, than `margin` times its t_err, neither `accepted` nor `off` is set. */
typedef struct limits { double tmin, tmax, rim2, margin; } limits;

/* Is the root at tau, known within tau_err, accepted?  (accept.h has the rules.) */
SGT_INLINE acceptance acceptance_of(const local *q, double tau, double tau_err, around at, limits in)
{
    acceptance h;
    sgt_vec3 p = at.p, grad = at.n;
    double tmin = in.tmin, tmax = in.tmax, rim2 = in.rim2, margin = in.margin;
    twofold t = two_sum(q->t0, tau);
    double terms = fabs(p.x * grad.x) + fabs(p.y * grad.y) + fabs(p.z * grad.z),
           width = START_ULPS * terms / fabs(at.slope);
    h.t = t.hi * q->scale, h.t_lo = t.lo * q->scale;
    h.t_err = (fabs(t.lo) + tau_err) * (1 + 4 * SGT_U) * q->scale;
    h.p_err = (fabs(q->l) + fabs(q->m) + fabs(q->n)) * tau_err + 1.01 * (SGT_U * (at.ex + at.ey + at.ez));
    width = width < HUGE_VAL ? width : 0;
    width = width * q->scale + 8 * SGT_U * fabs(h.t);
    double r2 = p.x * p.x + p.y * p.y,
           hidden = (2 * (fabs(p.x) + fabs(p.y)) + h.p_err) * h.p_err + 4 * SGT_U * r2;
    bool outside = r2 > rim2;
    double room = margin * (h.t_err + SGT_U * fabs(h.t)); /* t itself is rounded */
    double start = tmin + (h.t_err + width);
    bool far = h.t - room > tmax, sharp = h.t_err <= 64 * SGT_U * fabs(tmax);
    h.off = (r2 - rim2 > hidden) | (h.t - (h.t_err + room) > tmax) | (far & sharp) |
            (h.t + h.t_err <= tmin + width);
    /* t may be out of range in lengths of d */
    h.accepted = (h.t - room > start) & !(h.t + room > tmax) & !outside & (fabs(h.t) < HUGE_VAL) &
                 (h.t_err < HUGE_VAL);
    return h;
}

/* Is a root near the start accepted?  The reach of the rule of the start is made of the terms of F, which
 * vanish toward the axis.  A bound on rounding for all points within the rim does not vanish.  Then, for
 * most rays that begin near the axis, it hides where the root is.  For these only, `rounding` is asked at
 * the very point; the rest is as in acceptance_of.  `least` is above 0, so the root is the only one
 * (certified_of).
 *
 * The rounding of F alone may still be more than the reach, with all else far less.  Then the rule of
 * sagitta.h decides as in a search (proof.c, proof_take): a root that may be nearer to tmin than the reach
 * is not accepted.  Two conditions hold:
 * - its error is not above 16 times the reach;
 * - the terms themselves are known: rounding of the gradient moves them by no more than 32 times what it
 *   does to F (proof.c, terms_err), which here is at most half of them. */
typedef struct sharpened { acceptance h; double tau_err; bool known; } sharpened;

SGT_INLINE sharpened sharpened_of(sgt_surface s, const local *q, double tau, double g, around at,
                                  searched in, limits ends)
{
    sgt_vec3 p = at.p, grad = at.n;
    double own = s.ops->rounding ? s.ops->rounding(s.self, p) : HUGE_VAL;
    certified c = certified_of(tau, g, at.place + (own >= 0 ? own : HUGE_VAL), in);
    acceptance h = acceptance_of(q, tau, c.tau_err, at, ends);
    double terms = fabs(p.x * grad.x) + fabs(p.y * grad.y) + fabs(p.z * grad.z),
           far = larger(fabs(p.x), larger(fabs(p.y), fabs(p.z))), slope = larger(fabs(at.slope), in.least),
           width = START_ULPS * terms / slope * q->scale;
    double hides = own / slope * q->scale;
    bool steady = (own >= 0x1p-1000) & (64 * own <= terms) & (width <= 0x1p-38 * far * q->scale)
                  & (4 * (fabs(g) + at.place) <= own);
    h.off |= steady & (h.t - hides <= ends.tmin + width) & (hides <= 16 * width);
    return (sharpened){h, c.tau_err, c.inside};
}

/* The local origin moved onto the root; done SHARPER - 1 times at most.  A bad guess has left it far off,
 * and then rounding of the way from there is large beside terms that vanish.  F has to be asked for anew,
 * at 0.  *lo and *hi, which may be infinite, are moved inward by more than their rounding. */
SGT_INLINE local moved_onto(const local *q, sgt_vec3 o, double tau, double *lo, double *hi)
{
    local r = *q;
    double off = 0x1p-48 * (fabs(q->t0) + fabs(tau));
    r.t0 = q->t0 + tau;
    r.x = moved_along(o.x, r.t0, q->l), r.y = moved_along(o.y, r.t0, q->m);
    r.z = moved_along(o.z, r.t0, q->n);
    r.xa = fabs(r.x), r.ya = fabs(r.y), r.za = fabs(r.z);
    *lo = *lo * (1 - copysign(0x1p-48, *lo)) - tau + off; /* perhaps infinite */
    *hi = *hi * (1 - copysign(0x1p-48, *hi)) - tau - off;
    return r;
}

/* ------------------------------------------------------------------------- a march */

/* Where steps of one length end on a ray without an end.  It is past the point nearest the origin of the
 * surface's frame by 1.25 times the start's distance from that origin.  It is no round number of radii, as
 * a root may be there. */
SGT_INLINE double far_end(sgt_vec3 o, double l, double m, double n, double t0, double nearest, double lo)
{
    double away = sqrt(o.x * o.x + o.y * o.y + o.z * o.z) / sqrt(l * l + m * m + n * n);
    return larger(nearest + 1.25 * away - t0, lo);
}

typedef struct mark { double tau, g, slope, sign; } mark;

/* |F| falls from a and rises to b. */
SGT_INLINE bool valley_of(mark a, mark b)
{
    return (a.sign != 0) & (a.sign == b.sign) & (a.sign * a.slope < 0) & (a.sign * b.slope > 0);
}

SGT_INLINE double tangents_meet(mark a, mark b)
{
    return (b.g - a.g + a.slope * a.tau - b.slope * b.tau) / (a.slope - b.slope);
}

/* A valley whose tangents at a and b meet beyond zero: |F| may reach zero between.  If they do not, the
 * minimum of a convex |F| is above zero. */
SGT_INLINE bool dip_of(mark a, mark b)
{
    double t = tangents_meet(a, b), low = a.g + a.slope * (t - a.tau);
    return valley_of(a, b) & !(a.sign * low > 0) & (t > a.tau) & (t < b.tau);
}

SGT_INLINE double secant_of(mark a, mark b) { return a.tau - a.g * (b.tau - a.tau) / (b.g - a.g); }

#endif
