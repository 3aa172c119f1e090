/* methods.c - Newton's method and bisection without any safeguard.
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
 * Bisection halves the span of the surface on the ray, if F has different signs at its ends. */
#include "methods.h"

#include "../show/frame.h"
#include "../base/memory.h"
#include "../show/profile.h"

#include <math.h>

int method_watch(void *data, const sgt_step *step)
{
    record *r = data;
    r->step = memory_room(r->step, r->count, &r->capacity, sizeof *r->step);
    r->step[r->count++] = *step;
    return 0;
}

typedef struct methods_search {
    sgt_surface surface;
    const sgt_ray *ray;
    record *record;
    double semi_diameter; /* of the clear aperture; 0: none */
    int left;             /* evaluations that may still be made */
    bool normalised;
} methods_search;

static const char SPENT[] = "--max-evals is used up";

/* F and its slope at t, as a row of the record. */
static double evaluate(methods_search *s, sgt_move move, double t, double lo, double hi, double *slope)
{
    sgt_vec3 p = vector_along(s->ray->o, s->ray->d, t), grad;
    double f = s->surface.ops->value(s->surface.self, p, &grad);
    *slope = vector_dot(grad, s->ray->d) / (s->normalised ? vector_length(grad) : 1);
    sgt_step step = {
        .eval = (int)s->record->count + 1, .move = move, .t = t, .f = f, .slope = *slope, .lo = lo, .hi = hi,
        .f_lo = f, .f_hi = f, .slope_lo = *slope, .slope_hi = *slope};
    method_watch(s->record, &step);
    s->left--;
    return f;
}

static sgt_span span_of(const methods_search *s)
{
    sgt_span all = {.lo = -HUGE_VAL, .hi = HUGE_VAL, .seed = (double)NAN};
    if (s->surface.ops->span) all = s->surface.ops->span(s->surface.self, s->ray);
    all.lo = fmax(all.lo, s->ray->tmin);
    all.hi = fmin(all.hi, s->ray->tmax);
    return all;
}

/* On a sag, where the ray crosses the vertex plane; else the middle of the span; NaN if there is none. */
static double start_of(const methods_search *s)
{
    double plane = -s->ray->o.z / s->ray->d.z;
    if (isfinite(plane) && profile_is_sag(s->surface)) return plane;
    sgt_span span = span_of(s);
    if (span.lo > span.hi) return (double)NAN;
    double middle = span.lo + (span.hi - span.lo) / 2;
    return isfinite(middle) ? middle : isfinite(span.seed) ? span.seed : 0;
}

static void newton(methods_search *s)
{
    const double none = (double)NAN;
    double t = start_of(s);
    sgt_move move = SGT_SEED;
    record *r = s->record;
    if (isnan(t)) {
        r->stopped = "the ray passes beside the surface: there is nowhere to start";
        return;
    }
    for (r->stopped = SPENT; s->left > 0;) {
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
        if (fabs(next - t) <= nextafter(fabs(t), HUGE_VAL) - fabs(t)) {
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
static double end_value(methods_search *s, double *end, double other, double *slope)
{
    double at = *end, f = evaluate(s, SGT_SEED, at, fmin(at, other), fmax(at, other), slope);
    for (int k = -40; isnan(f) && k < 0 && s->left > 0; k += 2) {
        *end = at + ldexp(other - at, k - 1);
        f = evaluate(s, SGT_RETREAT, *end, fmin(*end, other), fmax(*end, other), slope);
    }
    return f;
}

/* Cuts an infinite end to the chord of the aperture, x^2 + y^2 <= a^2.  Along the axis that chord is
 * infinite too; there the span is AXIAL times a on both sides of the vertex plane. */
static void cut_to_aperture(const methods_search *s, sgt_span *span)
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

static void bisect(methods_search *s)
{
    record *r = s->record;
    sgt_span span = span_of(s);
    cut_to_aperture(s, &span);
    double lo = span.lo, hi = span.hi, slope;
    if (lo > hi)
        r->stopped = "the ray passes beside the surface: there is no span to halve";
    else if (!isfinite(lo) || !isfinite(hi))
        r->stopped = "the span is infinite and cannot be halved; give the ray a tmin and a tmax";
    if (r->stopped) return;
    double f_lo = end_value(s, &lo, hi, &slope), f_hi = end_value(s, &hi, lo, &slope);
    if (isnan(f_lo) || isnan(f_hi)) r->stopped = "F is NaN near an end of the span";
    else if ((f_lo > 0 && f_hi > 0) || (f_lo < 0 && f_hi < 0))
        r->stopped = "F has the same sign at both ends: there is no bracket to halve";
    if (r->stopped) return;
    for (r->stopped = SPENT; s->left > 0;) {
        double middle = lo + (hi - lo) / 2;
        r->t = fabs(f_lo) <= fabs(f_hi) ? lo : hi;
        if (!(middle > lo && middle < hi) || f_lo == 0 || f_hi == 0) {
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

bool method_only_retreated(const record *r)
{
    for (size_t i = 0; i < r->count; i++)
        if (!isnan(r->step[i].f) || r->step[i].move != (i ? SGT_RETREAT : SGT_SEED)) return false;
    return r->count > 1;
}

size_t method_march_steps(const record *r)
{
    size_t n = 0;
    for (size_t i = 0; i < r->count; i++) n += r->step[i].move == SGT_MARCH;
    return n;
}

record method_run(method m, sgt_surface s, double semi_diameter, const sgt_ray *ray, int max_evals)
{
    record r = {.t = (double)NAN};
    methods_search q = {.surface = s, .ray = ray, .record = &r, .semi_diameter = semi_diameter,
                        .left = max_evals, .normalised = m == METHOD_NORMALISED};
    if (m == METHOD_BISECTION) bisect(&q);
    else newton(&q);
    return r;
}

sgt_diagnosis method_diagnose(const record *r)
{
    int count = (int)r->count;
    return sgt_diagnose(&(sgt_log){.step = r->step, .cap = count, .n = count});
}
