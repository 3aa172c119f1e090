/* explain.c - one line of verdict, and the numbers that support it. */
#include "explain.h"

#include "../base/memory.h"
#include "../show/frame.h"
#include "../../text/number.h"
#include "../read/rays.h"
#include "../read/surface.h"

#include <math.h>

/* x with six digits. */
static const char *short_number(double x)
{
    char text[NUMBER_SIZE];
    number_print_short(text, x, 6);
    return memory_print("%s", text);
}

/* A verdict in words for the user of the command; sgt_verdict_text is for programmers. */
static const char *advice(sgt_verdict v, method m, const record *r)
{
    bool own = m == METHOD_SAFEGUARDED, normalised = m == METHOD_NORMALISED;
    if (own && r->count == method_march_steps(r))
        return "marching: steps along the ray that never came near enough to a root to solve for it";
    if (!own && method_only_retreated(r))
        return "backing off: halving t leads from one point where F is NaN to the next";
    switch (v) {
    case SGT_LINEAR:
        return normalised ? "linear: the error shrinks by a constant factor a step, since the gradient was "
                            "scaled to unit length"
               : own ? "linear: the error shrinks by a constant factor a step; the ray grazes: two roots are "
                       "close together"
                     : "linear: the error shrinks by a constant factor a step, as where two roots are close "
                       "together, or are seen from far away";
    case SGT_BISECTING:
        return own ? "bisecting: Newton's steps would have left the bracket, so it was halved; the answer "
                     "is as certain as any"
                   : "bisecting: each step halves the bracket, as this method does";
    case SGT_OSCILLATING:
        return normalised
                   ? "oscillating: to and fro without coming closer, as with a gradient scaled to unit length"
               : own ? "oscillating: to and fro without coming closer; the rows show where"
                     : "oscillating: to and fro without coming closer; --method safeguarded keeps a bracket "
                       "that ends it";
    case SGT_WANDERING:
        return own ? "wandering: no pattern, or too few steps to tell; the rows show its way"
                   : "wandering: no pattern, or too few steps to tell; compare the rows with --method "
                     "safeguarded";
    case SGT_QUADRATIC: case SGT_ROUNDING: case SGT_LATE: break;
    }
    return sgt_verdict_text(v);
}

/* "7 evaluations: 5 Newton, 1 backing off; order 2, rate 0.139." */
static void verdict(table *t, method m, const record *r)
{
    sgt_diagnosis d = method_diagnose(r);
    const struct { int n; const char *what; } kinds[] = {
        {d.newton, "Newton"}, {d.bisect, "bisecting"}, {d.march, "marching"}, {d.retreat, "backing off"},
    };
    const char *text = memory_print("%zu evaluation%s", r->count, r->count == 1 ? "" : "s"), *between = ": ";
    for (int i = 0; i < 4; i++)
        if (kinds[i].n)
            text = memory_print("%s%s%d %s", text, between, kinds[i].n, kinds[i].what), between = ", ";
    if (isfinite(d.order)) text = memory_print("%s; order %.3g, rate %.3g", text, d.order, d.rate);
    table_line(t, "%s", advice(d.verdict, m, r));
    table_line(t, "%s.", text);
    if (d.before > 2 && (d.verdict == SGT_LATE || d.verdict == SGT_LINEAR))
        table_line(t, "%d of these came before the steps began to close in on the end.", d.before);
}

/* "hit at t = 4.1, at most 3.6e-15 off" */
static const char *root_text(const sgt_hit *hit)
{
    char t[NUMBER_SIZE];
    number_print(t, hit->t, false);
    return memory_print("%s at t = %s, %s", sgt_status_text(hit->status), t,
                        hit->t_err > 0 ? memory_print("at most %.2g off", hit->t_err) : "exactly");
}

const char explain_fast[] =
    "Searched in steps of --dt-min or more: thin parts may have been skipped.  Without --dt-min, no part is.";

const char *explain_proof(const sgt_options *asked, bool near_seed, bool several)
{
    if (asked->proof == SGT_PROVE_ROOT)
        return several ? "proven to be single roots" : "proven to be a single root";
    return !near_seed ? "proven to be the first"
           : several  ? "proven to be the only roots"
                      : "proven to be the only root";
}

static void answer(table *t, const search *s, double condition, bool told)
{
    const sgt_hit *hit = s->hit;
    if (hit->status == SGT_MISS) table_line(t, "miss: the ray certainly does not meet the surface.");
    if (hit->status < 0 && !told) undecided_explain(t, "", s);
    if (hit->status <= 0) return;
    const char *root = root_text(hit);
    bool proven = s->asked->proof && hit->status == SGT_HIT;
    table_line(t, "%s%s%s.", root, proven ? ", " : "",
               proven ? explain_proof(s->asked, s->near_seed, false) : "");
    if (isfinite(condition))
        table_line(t, "Condition: an error in F moves t by %.3g times as much%s.", condition,
                   condition > 100 ? "; the ray grazes" : "");
}

/* Explains rows that do not show F at a t. */
static void explain_rows(table *t, const record *r)
{
    size_t cells = 0;
    for (size_t i = 0; i < r->count; i++) cells += r->step[i].kind == SGT_OVER_CELL;
    if (cells)
        table_line(t, "A row without f is about the whole cell lo ... hi; csv and json have the bounds on F "
                      "there.");
}

void explain_safeguarded(table *t, const record *r, const search *s, bool told)
{
    if (r->count > 0) verdict(t, METHOD_SAFEGUARDED, r);
    else table_line(t, "Answered without an evaluation.");
    answer(t, s, r->count > 0 ? method_diagnose(r).condition : (double)NAN, told);
    if (s->fast && s->hit->status != SGT_MISS) table_line(t, "%s", explain_fast);
    explain_rows(t, r);
}

/* Near a root the normalised step multiplies the error by 1 - |grad F|. */
static void explain_normalised(table *t, const record *r, const search *s)
{
    if (s->hit->status <= 0) return;
    sgt_vec3 grad;
    s->surface.ops->value(s->surface.self, vector_along(s->ray.o, s->ray.d, s->hit->t), &grad);
    double length = vector_length(grad), factor = 1 - length;
    if (fabs(factor) < 1e-12) { /* F is a distance */
        table_line(t, "The gradient was scaled to unit length.  At the root it has unit length anyway: near "
                      "it nothing changes.");
        return;
    }
    table_line(t, "The gradient was scaled to unit length and F was not: each step is too long by |grad F|,");
    table_line(t, "which is %.6g at the root.  Near it the error is multiplied by 1 - %.6g = %.6g a step:",
               length, length, factor);
    if (fabs(factor) >= 1)
        table_line(t, "it goes to and fro and can never settle.  Use the gradient as it is.");
    else if (fabs(factor) > 0.9)
        table_line(t, "it goes to and fro and hardly comes closer.  Use the gradient as it is.");
    else if (r->settled)
        table_line(t, "it settled, a constant factor a step.  With the gradient as it is, each step doubles "
                      "the digits.");
    else
        table_line(
            t, "close to the root it would settle, but it does not get close.  Use the gradient as it is.");
}

/* A level set lies inside a ball, and its span is the ray's chord of that ball.  A torus or an ellipsoid has
 * a span of the same kind. */
static void explain_miss_of_set(table *t, size_t number, sgt_surface surface, const sgt_ray *ray)
{
    if (!surface.ops->span) return;
    const char *what = surface_is_level_set(surface) ? "the ball that holds the set" : "the surface";
    sgt_span span = surface.ops->span(surface.self, ray);
    if (span.lo > span.hi)
        table_line(t, "Ray %zu: it passes beside %s.", number, what);
    else if (span.hi < ray->tmin || span.lo > ray->tmax)
        table_line(t, "Ray %zu: it reaches %s only outside tmin ... tmax.", number, what);
}

/* On the whole quadric A t^2 - 2 B t + C = 0.  Its sheet is where (1 + k) c z < 1. */
static void explain_miss_of_quadric(table *t, size_t number, const bare_surface *b, sgt_vec3 o, sgt_vec3 d)
{
    const char other[] = "the other sheet of the quadric (of a sphere, the far half)";
    double k1 = 1 + b->k, A = b->c * (d.x * d.x + d.y * d.y + k1 * d.z * d.z);
    double B = d.z - b->c * (o.x * d.x + o.y * d.y + k1 * o.z * d.z);
    double C = b->c * (o.x * o.x + o.y * o.y + k1 * o.z * o.z) - 2 * o.z;
    double slack = (B * B + fabs(A * C)) * 0x1p-20;
    if (B * B > A * C + slack)
        table_line(t, "Ray %zu: it meets only %s.", number, other);
    else if (B * B < A * C - slack)
        table_line(t, "Ray %zu: it passes beside the whole quadric.", number);
    else if (k1 * b->c * vector_along(o, d, B / A).z > 1)
        table_line(t, "Ray %zu: it comes near, but only to %s.", number, other);
    else
        table_line(t,
                   "Ray %zu: it only just misses: it nearly touches the surface.  A small shift of the ray "
                   "can make it a hit.",
                   number);
}

void explain_miss(table *t, size_t number, sgt_surface surface, const sgt_ray *ray)
{
    if (!undecided_has_rim(surface)) {
        explain_miss_of_set(t, number, surface, ray);
        return;
    }
    const double margin = 1 + 0x1p-30; /* far more than rounding: say it only if it is clear */
    const bare_surface b = undecided_without_rim(surface);
    sgt_ray line = {.o = ray->o, .d = ray->d, .tmin = -HUGE_VAL, .tmax = HUGE_VAL};
    sgt_hit whole = sgt_intersect(surface, line, NULL);
    const char *at;
    if (whole.status > 0) {
        at = short_number(whole.t);
        table_line(
            t, "Ray %zu: there is a root at t = %s, but it is outside tmin ... tmax, or the ray's own start.",
            number, at);
        return;
    }
    if (whole.status < 0) {
        table_line(t, "Ray %zu: there is no root between tmin and tmax.  Outside of them one is in doubt.",
                   number);
        return;
    }
    sgt_hit beyond = sgt_intersect(b.surface, line, NULL);
    if (beyond.status > 0) {
        at = short_number(hypot(beyond.p.x, beyond.p.y));
        table_line(t, "Ray %zu: it meets the surface only outside semi_diameter, first at r = %s.", number,
                   at);
        return;
    }
    if (beyond.status < 0) {
        table_line(t, "Ray %zu: there is no root within semi_diameter.  Outside of it one is in doubt.",
                   number);
        return;
    }
    double domain = b.k > -1 && b.c != 0 ? 1 / (fabs(b.c) * sqrt(1 + b.k)) : HUGE_VAL;
    double nearest = vector_axis_distance(ray->o, ray->d);
    at = short_number(domain);
    if (nearest > domain * margin) {
        table_line(t, "Ray %zu: it never comes within r = %s of the axis, and the surface ends there.",
                   number, at);
    } else if (nearest * margin > domain && b.rim > 0 && nearest > b.rim * margin) {
        table_line(t, "Ray %zu: it comes no nearer to the axis than r = %s, outside semi_diameter.", number,
                   at);
    } else if (nearest * margin > domain) {
        table_line(t,
                   "Ray %zu: it passes the very edge of the surface.  It comes no nearer to the axis than "
                   "r = %s,",
                   number, at);
        table_line(t, "and there the surface ends, to within rounding.  A nearer ray can meet it.");
    } else if (b.c == 0 && !b.terms && ray->d.z == 0) {
        table_line(t, "Ray %zu: it is parallel to the surface.", number);
    } else if (b.c != 0 && !b.terms) {
        explain_miss_of_quadric(t, number, &b, ray->o, ray->d);
    } else if (b.terms && ray->d.z != 0) {
        sgt_vec3 plane = vector_along(ray->o, ray->d, -ray->o.z / ray->d.z);
        plane.z = 0;
        if (isnan(surface.ops->value(surface.self, plane, NULL)))
            table_line(t, "Ray %zu: there is no surface where it crosses the vertex plane.", number);
    }
}

/* Says why a root on which a bare method settled is not accepted, if that is known. */
static void explain_not_accepted(table *t, const record *r, const search *s)
{
    const sgt_ray *ray = &s->ray;
    const double tmin = ray->tmin, tmax = ray_end(ray),
                 close = 0x1p-40 * (fabs(r->t) + fabs(tmin));
    const sgt_surface surface = s->surface;
    sgt_vec3 p = vector_along(ray->o, ray->d, r->t);
    const double radius = hypot(p.x, p.y),
                 rim = undecided_has_rim(surface) ? undecided_without_rim(surface).rim : 0;
    const char *at = short_number(r->t), *end;
    sgt_span span = {.lo = -HUGE_VAL, .hi = HUGE_VAL};
    if (surface.ops->span) span = surface.ops->span(surface.self, ray);
    if (r->t > tmax) {
        end = short_number(tmax);
        table_line(t, "The t = %s on which it settled lies beyond the ray's end, tmax = %s.", at, end);
    } else if (r->t < tmin && tmin - r->t > close) {
        end = short_number(tmin);
        table_line(t, "The t = %s on which it settled lies before the ray's start, tmin = %s.", at, end);
    } else if (fabs(r->t - tmin) <= close) {
        table_line(t, "The t = %s on which it settled is the ray's own start, which is not accepted.", at);
    } else if (rim > 0 && radius > rim) {
        end = short_number(radius);
        table_line(t, "The t = %s on which it settled lies outside semi_diameter, at r = %s.", at, end);
    } else if (r->t < span.lo || r->t > span.hi) {
        table_line(t, "The t = %s on which it settled lies outside the part of space that holds the surface.",
                   at);
    } else if (s->hit->status == SGT_MISS) {
        table_line(t, "The t = %s on which it settled is no root: F only comes near 0 there, or jumps.",
                   at);
    } else if (r->t > s->hit->t) {
        table_line(t, "The library's answer comes before it on the ray.");
    }
}

void explain_bare(table *t, method m, const record *r, const search *s)
{
    const sgt_hit *hit = s->hit;
    if (r->count > 0) verdict(t, m, r);
    char end[NUMBER_SIZE];
    number_print(end, r->t, false);
    if (!r->settled) table_line(t, "Not settled after %zu evaluation%s: %s.", r->count,
                               r->count == 1 ? "" : "s", r->stopped);
    else table_line(t, "Settled at t = %s.", end);
    if (hit->status == SGT_MISS) {
        table_line(t, "The library's answer: miss: the ray certainly does not meet the surface.");
    } else if (hit->status < 0) {
        undecided_explain(t, "The library's answer: ", s);
    } else {
        /* a bare method rounds o + t d, so a few ulps outside the library's bound still agree */
        double apart = fabs(r->t - hit->t), close = hit->t_err + 0x1p-40 * fabs(hit->t);
        const char *how = !r->settled ? "" : apart <= close ? ": the same" : ": another root, or none";
        table_line(t, "The library's answer: %s%s.", root_text(hit), how);
        if (!(apart <= close) && r->settled) explain_not_accepted(t, r, s);
    }
    if (hit->status <= 0 && r->settled) explain_not_accepted(t, r, s);
    if (m == METHOD_NORMALISED) explain_normalised(t, r, s);
    if (m == METHOD_BISECTION && r->settled)
        table_line(t, "Each evaluation halves the bracket: one bit of t for each.");
}
