// SPDX-License-Identifier: MIT
/* unguarded.c - Newton's method and bisection without any safeguard.
 *
 * Newton's step along a ray is t - F / (grad F . d).  Here there is no bracket, and where F
 * is NaN, t is halved, toward the ray's origin.  The iteration stops when a step moves t by
 * at most an ulp, which says nothing about F.
 *
 * `newton-normalised` scales the gradient to unit length first, as for a normal vector.  F is
 * not scaled, so the step is too long by the factor |grad F|, and near the root each step
 * multiplies the error by 1 - |grad F|.  On a sag |grad F| is 1 / cos of the surface's slope:
 * beyond 60 degrees it is more than 2, and the iteration cannot settle.
 *
 * Bisection halves the span of the surface on the ray, if F has different signs at its ends.
 *
 * The march is that of ray tracers for fractals: each step is the greatest of an estimate of the distance
 * (the surface's own, or its clearance), Newton's step if it leads forward, and dt.  So it neither stalls
 * before a root nor creeps along a surface that it passes by.  But a step of dt, or Newton's, may leap over
 * two roots. If a step leads to where F is NaN, half of it is tried.  Once F has changed sign the bracket is
 * halved, down to t_tol, and its middle is the answer.  On a surface that is rough at all scales a coarse
 * t_tol averages over what is finer. */
#include "unguarded.h"

#include <sagitta/surfaces.h>

#include <float.h>
#include <math.h>

typedef struct unguarded_search {
    sgt_surface surface;
    const sgt_ray *ray;
    const sgt_options *opt;
    double semi_diameter; /* of the clear aperture; 0: none */
    double start;         /* NaN: none is given */
    int evals;
    bool normalised;
} unguarded_search;

static const char SPENT[] = "max_evals is used up";

static bool may_go_on(const unguarded_search *s) { return s->evals < s->opt->max_evals; }

static sgt_vec3 point_at(const sgt_ray *ray, double t)
{
    return (sgt_vec3){ray->o.x + t * ray->d.x, ray->o.y + t * ray->d.y, ray->o.z + t * ray->d.z};
}

static double product(sgt_vec3 a, sgt_vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

static double evaluate_quietly(const unguarded_search *s, double t)
{
    return s->surface.ops->value(s->surface.self, point_at(s->ray, t), NULL);
}

/* F and its slope at t, and tells them. */
static double evaluate(unguarded_search *s, sgt_move move, double t, double lo, double hi, double *slope)
{
    sgt_vec3 grad;
    double f = s->surface.ops->value(s->surface.self, point_at(s->ray, t), &grad);
    *slope = product(grad, s->ray->d) / (s->normalised ? sqrt(product(grad, grad)) : 1);
    const sgt_step step = {
        .eval = ++s->evals, .move = move, .t = t, .f = f, .slope = *slope, .lo = lo, .hi = hi,
        .f_lo = f, .f_hi = f, .slope_lo = *slope, .slope_hi = *slope};
    s->opt->watch(s->opt->watch_data, &step);
    return f;
}

static sgt_span span_of(const unguarded_search *s)
{
    sgt_span all = {.lo = -HUGE_VAL, .hi = HUGE_VAL, .seed = (double)NAN};
    if (s->surface.ops->span) all = s->surface.ops->span(s->surface.self, s->ray);
    all.lo = fmax(all.lo, s->ray->tmin);
    all.hi = fmin(all.hi, s->ray->tmax);
    return all;
}

/* On a sag, where the ray crosses the vertex plane; else the middle of the span; NaN if there is none. */
static double start_of(const unguarded_search *s)
{
    double plane = -s->ray->o.z / s->ray->d.z;
    if (isfinite(plane) && sgt_is_sag(s->surface)) return plane;
    sgt_span span = span_of(s);
    if (span.lo > span.hi) return (double)NAN;
    double middle = span.lo + (span.hi - span.lo) / 2;
    return isfinite(middle) ? middle : isfinite(span.seed) ? span.seed : 0;
}

static void newton(unguarded_search *s, unguarded *r)
{
    const double none = (double)NAN;
    double t = isnan(s->start) ? start_of(s) : s->start;
    sgt_move move = SGT_SEED;
    if (isnan(t)) {
        r->stopped = "the ray passes beside the surface: there is nowhere to start";
        return;
    }
    for (r->stopped = SPENT; may_go_on(s);) {
        double slope, f = evaluate(s, move, t, none, none, &slope);
        r->t = t;
        if (isnan(f) || isnan(slope)) {
            if (t == 0) {
                r->stopped = "F is NaN at the ray's origin, so t cannot be halved any more";
                return;
            }
            t /= 2;
            move = SGT_RETREAT;
            continue;
        }
        double next = t - f / slope;
        if (!isfinite(next)) {
            r->stopped = "the slope is 0 there, so the next step would be infinite";
            return;
        }
        if (fabs(next - t) <= fmax(nextafter(fabs(t), HUGE_VAL) - fabs(t), s->opt->t_tol)) {
            r->settled = true;
            r->t = next;
            return;
        }
        t = next;
        move = SGT_NEWTON;
    }
}

/* F at an end of the span.  If F is NaN there (the span may reach an ulp beyond the domain), the end moves
 * toward the middle by 2^-40 of the way, then 2^-38, 2^-36 ... */
static double end_value(unguarded_search *s, double *end, double other, double *slope)
{
    double at = *end, f = evaluate(s, SGT_SEED, at, fmin(at, other), fmax(at, other), slope);
    for (int k = -40; isnan(f) && k < 0 && may_go_on(s); k += 2) {
        *end = at + ldexp(other - at, k - 1);
        f = evaluate(s, SGT_RETREAT, *end, fmin(*end, other), fmax(*end, other), slope);
    }
    return f;
}

/* Cuts an infinite end to the chord of the aperture, x^2 + y^2 <= a^2.  Along the axis that chord is
 * infinite too; there the span is AXIAL times a on both sides of the vertex plane. */
static void cut_to_aperture(const unguarded_search *s, sgt_span *span)
{
    const double AXIAL = 4;
    sgt_vec3 o = s->ray->o, d = s->ray->d;
    double a = s->semi_diameter, across = d.x * d.x + d.y * d.y, nearest = -(o.x * d.x + o.y * d.y) / across;
    double x = o.x + nearest * d.x, y = o.y + nearest * d.y, half = sqrt((a * a - x * x - y * y) / across);
    if (!(a > 0) || (isfinite(span->lo) && isfinite(span->hi))) return;
    double plane = -o.z / d.z, axial = fabs(AXIAL * a / d.z);
    if (d.z != 0 && !(half <= 1e3 * axial)) nearest = plane, half = axial;
    if (!isfinite(nearest) || !isfinite(half)) return;
    span->lo = fmax(span->lo, nearest - half);
    span->hi = fmin(span->hi, nearest + half);
}

/* Halves a bracket to t_tol, or to the last bit. */
static void halve(unguarded_search *s, unguarded *r, double lo, double f_lo, double hi, double f_hi)
{
    for (r->stopped = SPENT; may_go_on(s);) {
        double middle = lo + (hi - lo) / 2, slope;
        const bool narrow = hi - lo <= 2 * s->opt->t_tol;
        r->t = narrow ? middle : fabs(f_lo) <= fabs(f_hi) ? lo : hi;
        if (narrow || !(middle > lo && middle < hi) || f_lo == 0 || f_hi == 0) {
            r->settled = true;
            return;
        }
        double f = evaluate(s, SGT_BISECT, middle, lo, hi, &slope);
        if (isnan(f)) {
            r->stopped = "F is NaN inside the bracket";
            return;
        }
        if ((f < 0) == (f_lo < 0) && f != 0) lo = middle, f_lo = f;
        else hi = middle, f_hi = f;
    }
}

/* The stretch to search; false: r->stopped says why there is none. */
static bool stretch_of(unguarded_search *s, sgt_span *span, unguarded *r)
{
    *span = span_of(s);
    cut_to_aperture(s, span);
    if (span->lo > span->hi)
        r->stopped = "the ray passes beside the surface: there is no span to search";
    else if (!isfinite(span->lo) || !isfinite(span->hi))
        r->stopped = "the span is infinite and cannot be searched; give the ray a tmin and a tmax";
    return !r->stopped;
}

static void bisect(unguarded_search *s, unguarded *r)
{
    sgt_span span;
    if (!stretch_of(s, &span, r)) return;
    double slope, f_lo = end_value(s, &span.lo, span.hi, &slope),
                  f_hi = end_value(s, &span.hi, span.lo, &slope);
    if (isnan(f_lo) || isnan(f_hi))
        r->stopped = "F is NaN near an end of the span";
    else if ((f_lo > 0 && f_hi > 0) || (f_lo < 0 && f_hi < 0))
        r->stopped = "F has the same sign at both ends: there is no bracket to halve";
    if (!r->stopped) halve(s, r, span.lo, f_lo, span.hi, f_hi);
}

/* The surface's guess at its distance from the ray at t, in lengths of the direction. */
static double estimate_at(const unguarded_search *s, double t)
{
    const sgt_surface_ops *ops = s->surface.ops;
    double (*guess)(const void *, sgt_vec3) = ops->estimate ? ops->estimate : ops->clearance;
    return guess ? guess(s->surface.self, point_at(s->ray, t)) / sqrt(product(s->ray->d, s->ray->d)) : 0;
}

static void march(unguarded_search *s, unguarded *r)
{
    const double none = (double)NAN;
    sgt_span span;
    if (!stretch_of(s, &span, r)) return;
    const double dt = s->opt->dt_min > 0 ? s->opt->dt_min : (span.hi - span.lo) / 64;
    double t = span.lo, before = none, f_before = none;
    sgt_move move = SGT_SEED;
    for (r->stopped = SPENT; may_go_on(s);) {
        double slope, f = evaluate(s, move, t, none, none, &slope);
        r->t = t;
        if ((r->settled = f == 0)) return;
        if ((f < 0 && f_before > 0) || (f > 0 && f_before < 0)) {
            halve(s, r, before, f_before, t, f);
            return;
        }
        if (isnan(f) && !isnan(f_before) && t - before > 0x1p-40 * (span.hi - span.lo)) { /* too far */
            t = before + (t - before) / 2, move = SGT_RETREAT;
            continue;
        }
        if (!(t < span.hi)) {
            r->stopped = "F has not changed sign up to the end of the span";
            return;
        }
        const double newton_step = -f / slope, other = fmax(dt, estimate_at(s, t));
        move = newton_step > other ? SGT_NEWTON : SGT_MARCH;
        before = t, f_before = f;
        t = fmin(t + fmax(other, newton_step), span.hi); /* fmax passes over a NaN */
    }
}

sgt_hit in_bracket(sgt_surface surface, const sgt_ray *ray, double start, const sgt_options *opt)
{
    unguarded_search s = {.surface = surface, .ray = ray, .opt = opt};
    double f, slope, least = HUGE_VAL;
    sgt_root r = sgt_root_begin((sgt_span){.lo = ray->tmin, .hi = ray->tmax, .seed = start}, opt);
    do {
        f = evaluate(&s, r.move, r.t, r.lo, r.hi, &slope);
        const sgt_vec3 p = point_at(ray, r.t);
        least = fmin(least, fabs(f));
        r.g_err = surface.ops->rounding ? surface.ops->rounding(surface.self, p) : 0;
    } while (sgt_root_next(&r, f, slope));
    f = evaluate_quietly(&s, r.t);
    const double rounding = isfinite(r.g_err) ? r.g_err : 0;
    if (r.status == SGT_HIT && !(fabs(f) <= fmax(2 * least, rounding))) r.status = SGT_UNPROVEN; /* a pole */
    if (r.status == SGT_GRAZE && !isfinite(r.t_err)) r.status = SGT_UNPROVEN; /* F and t overflow */
    return (sgt_hit){
        .status = r.status, .t = r.t, .t_err = r.t_err, .lo = r.lo, .hi = r.hi, .f = f, .evals = r.evals};
}

unguarded unguarded_run(unguarded_method m, sgt_surface s, double semi_diameter, const sgt_ray *ray,
                        double start, const sgt_options *opt)
{
    unguarded r = {.t = (double)NAN};
    unguarded_search q = {.surface = s,
                          .ray = ray,
                          .opt = opt,
                          .semi_diameter = semi_diameter,
                          .start = start,
                          .normalised = m == UNGUARDED_NORMALISED};
    if (m == UNGUARDED_BISECTION) bisect(&q, &r);
    else if (m == UNGUARDED_MARCH)
        march(&q, &r);
    else newton(&q, &r);
    return r;
}

unguarded_fault unguarded_fault_of(size_t n, const sgt_step step[])
{
    enum { BACKED = 3, ROUND = 6, RETURNS = 2, WALK = 8, FLICKER = 8 };
    const double ulps = 16 * DBL_EPSILON, as_long = 0.98;
    size_t backed = 0, round = 0, returns = 0, walked = 0, short_steps = 0, i;
    while (backed < n && isnan(step[n - 1 - backed].f) && step[n - 1 - backed].kind == SGT_AT_POINT) backed++;
    if (backed >= BACKED || (backed == n && n > 1)) return UNGUARDED_BACKS_OFF;
    for (i = n; i-- > 1 && step[i].move == (isnan(step[i].f) ? SGT_NEWTON : SGT_RETREAT); round++)
        returns += step[i].move == SGT_NEWTON;
    if (round >= ROUND && returns >= RETURNS) return UNGUARDED_GOES_ROUND;
    for (i = n; i-- > 2 && step[i].move == SGT_NEWTON && step[i - 1].move == SGT_NEWTON; walked++)
        if (!((step[i].t - step[i - 1].t) / (step[i - 1].t - step[i - 2].t) > as_long)) break;
    if (walked >= WALK) return UNGUARDED_WALKS;
    for (i = n; i-- > 1 && step[i].move == SGT_NEWTON; short_steps++)
        if (!(fabs(step[i].t - step[i - 1].t) <= ulps * fabs(step[i].t))) break;
    return short_steps >= FLICKER ? UNGUARDED_FLICKERS : UNGUARDED_NO_FAULT;
}

double unguarded_factor(size_t n, const sgt_step step[])
{
    double first = 0, last = 0;
    int steps = 0;
    for (size_t i = 1; i < n; i++) {
        const double s = fabs(step[i].t - step[i - 1].t);
        if (step[i].move != SGT_NEWTON || !(s > 0)) continue;
        if (steps++ == 0) first = s;
        last = s;
    }
    return steps > 1 ? pow(last / first, 1.0 / (steps - 1)) : (double)NAN;
}
