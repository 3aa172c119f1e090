// SPDX-License-Identifier: MIT
/* explain.c - one line of verdict, and the numbers that support it. */
#include "explain.h"

#include "../base/memory.h"
#include "../show/frame.h"
#include "../../text/number.h"

#include <math.h>

static sgt_diagnosis diagnosis_of(const record *r)
{
    return sgt_diagnose(&(sgt_log){.step = r->step, .cap = (int)r->count, .n = (int)r->count});
}

/* A verdict in words for the user of the command; sgt_verdict_text is for programmers. */
static const char *advice(const sgt_diagnosis *d, method m, const record *r)
{
    if (m == METHOD_MARCH)
        return "marching: each step the greatest of an estimate, Newton's step and dt; once F has changed "
               "sign, halving";
    bool own = m == METHOD_SAFEGUARDED, normalised = m == METHOD_NORMALISED;
    if (own && d->march == (int)r->count)
        return "marching: steps along the ray that never came near enough to a root to solve for it";
    switch (own ? UNGUARDED_NO_FAULT : unguarded_fault_of(r->count, r->step)) {
    case UNGUARDED_NO_FAULT:
        break;
    case UNGUARDED_BACKS_OFF:
        return "backing off: halving t leads from one point where F is NaN to the next";
    case UNGUARDED_GOES_ROUND:
        return "going round: Newton's step leads to where F is NaN, and halving t leads back";
    case UNGUARDED_WALKS:
        return "walking away: steps the same way that do not get shorter; the tangents point to no root that "
               "is near";
    case UNGUARDED_FLICKERS:
        return "at the limit of rounding: to and fro between neighbouring numbers, and no step is short "
               "enough to end on; give --t-tol";
    }
    switch (d->verdict) {
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
    return sgt_verdict_text(d->verdict);
}

const char *explain_advice(method m, const record *r)
{
    const sgt_diagnosis d = diagnosis_of(r);
    return advice(&d, m, r);
}

/* "7 evaluations: 5 Newton, 1 backing off; order 2, rate 0.139." */
static void verdict(table *t, method m, const record *r)
{
    sgt_diagnosis d = diagnosis_of(r);
    const struct { int n; const char *what; } kinds[] = {
        {d.newton, "Newton"}, {d.bisect, "bisecting"}, {d.march, "marching"}, {d.retreat, "backing off"},
    };
    const char *text = memory_print("%zu evaluation%s", r->count, r->count == 1 ? "" : "s"), *between = ": ";
    for (int i = 0; i < 4; i++)
        if (kinds[i].n)
            text = memory_print("%s%s%d %s", text, between, kinds[i].n, kinds[i].what), between = ", ";
    const size_t from = r->count / 2;
    const double factor =
        d.verdict == SGT_LINEAR ? unguarded_factor(r->count - from, r->step + from) : (double)NAN;
    if (isfinite(factor))
        text = memory_print("%s; order %.3g, a factor of %.3g a step", text, d.order, factor);
    else if (isfinite(d.order))
        text = memory_print("%s; order %.3g, rate %.3g", text, d.order, d.rate);
    table_line(t, "%s", advice(&d, m, r));
    table_line(t, "%s.", text);
    if (d.before > 2 && d.verdict == SGT_LATE)
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

static bool of_function;

void explain_a_function(void) { of_function = true; }

static const char *miss_words(void)
{
    return of_function ? "miss: the function certainly has no root there."
                       : "miss: the ray certainly does not meet the surface.";
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

static void answer(table *t, const sgt_search *s, double condition, bool told)
{
    const sgt_hit *hit = s->hit;
    if (hit->status == SGT_MISS) table_line(t, "%s", miss_words());
    if (hit->status < 0 && !told) options_say_undecided(t, "", s);
    if (hit->status <= 0) return;
    const char *root = root_text(hit);
    bool proven = s->options->proof && hit->status == SGT_HIT;
    table_line(t, "%s%s%s.", root, proven ? ", " : "",
               proven ? explain_proof(s->options, s->near_seed, false) : "");
    if (isfinite(condition))
        table_line(t, "Condition: an error in F moves t by %.3g times as much%s.", condition,
                   condition <= 100 ? ""
                   : of_function    ? "; the root is nearly a double one"
                                    : "; the ray grazes");
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

void explain_safeguarded(table *t, const record *r, const sgt_search *s, bool told)
{
    if (r->count > 0) verdict(t, METHOD_SAFEGUARDED, r);
    else table_line(t, "Answered without an evaluation.");
    answer(t, s, r->count > 0 ? diagnosis_of(r).condition : (double)NAN, told);
    if (s->fast && s->hit->status != SGT_MISS) table_line(t, "%s", explain_fast);
    explain_rows(t, r);
}

/* Near a root the normalised step multiplies the error by 1 - |grad F|. */
static void explain_normalised(table *t, const unguarded *end, const sgt_search *s)
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
    else if (end->settled)
        table_line(t, "it settled, a constant factor a step.  With the gradient as it is, each step doubles "
                      "the digits.");
    else
        table_line(
            t, "close to the root it would settle, but it does not get close.  Use the gradient as it is.");
}

void explain_miss(table *t, size_t number, sgt_surface surface, const sgt_ray *ray)
{
    char why[WHY_SIZE];
    if (sgt_why_missed(surface, ray, sizeof why, why)) table_line(t, "Ray %zu: %s.", number, why);
}

/* Says why a root on which a bare method settled is not accepted, if that is known. */
static void explain_not_accepted(table *t, double at, const sgt_search *s)
{
    char why[WHY_SIZE], place[NUMBER_SIZE];
    number_print_short(place, at, 6);
    if (sgt_why_refused(s, at, sizeof why, why))
        table_line(t, "The t = %s on which it settled %s.", place, why);
}

/* A bare method rounds o + t d, so a few ulps outside the library's bound still agree. */
bool explain_agrees(double t, const sgt_search *s)
{
    return fabs(t - s->hit->t) <= s->hit->t_err + 0x1p-40 * fabs(s->hit->t) + s->options->t_tol;
}

void explain_bare(table *t, method m, const record *r, const unguarded *end, const sgt_search *s)
{
    const sgt_hit *hit = s->hit;
    if (r->count > 0) verdict(t, m, r);
    char place[NUMBER_SIZE];
    number_print(place, end->t, false);
    if (!end->settled) table_line(t, "Not settled after %zu evaluation%s: %s.", r->count,
                               r->count == 1 ? "" : "s", end->stopped);
    else table_line(t, "Settled at t = %s.", place);
    if (hit->status == SGT_MISS) {
        table_line(t, "The library's answer: %s", miss_words());
    } else if (hit->status < 0) {
        options_say_undecided(t, "The library's answer: ", s);
    } else {
        const bool agrees = explain_agrees(end->t, s);
        const char *how = !end->settled ? "" : agrees ? ": the same" : ": another root, or none";
        table_line(t, "The library's answer: %s%s.", root_text(hit), how);
        if (!agrees && end->settled) explain_not_accepted(t, end->t, s);
    }
    if (hit->status <= 0 && end->settled) explain_not_accepted(t, end->t, s);
    if (m == METHOD_NORMALISED) explain_normalised(t, end, s);
    if (m == METHOD_BISECTION && end->settled)
        table_line(t, "Each evaluation halves the bracket: one bit of t for each.");
}
