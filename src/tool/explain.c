/* explain.c - one line of verdict, and the numbers it rests on. */
#include "explain.h"

#include "frame.h"
#include "number.h"

#include <math.h>
#include <stdio.h>

enum { ROOT_SIZE = 4 * NUMBER_SIZE };

/* "7 evaluations: 5 Newton, 1 backing off; order 2, rate 0.139." */
static void verdict(table *t, const record *r)
{
    sgt_diagnosis d = method_diagnose(r);
    const struct { int n; const char *what; } kinds[] = {
        {d.newton, "Newton"}, {d.bisect, "bisecting"}, {d.march, "marching"}, {d.retreat, "backing off"},
    };
    char text[200];
    int length = snprintf(text, sizeof text, "%zu evaluation%s", r->count, r->count == 1 ? "" : "s");
    const char *between = ": ";
    for (int i = 0; i < 4; i++) {
        if (kinds[i].n == 0) continue;
        length += snprintf(text + length, sizeof text - (size_t)length, "%s%d %s", between, kinds[i].n, kinds[i].what);
        between = ", ";
    }
    if (isfinite(d.order))
        snprintf(text + length, sizeof text - (size_t)length, "; order %.3g, rate %.3g", d.order, d.rate);
    table_line(t, "%s", sgt_verdict_text(d.verdict));
    table_line(t, "%s.", text);
}

/* "hit at t = 4.1, at most 3.6e-15 off" */
static void print_root(char text[ROOT_SIZE], const sgt_hit *hit)
{
    char t[NUMBER_SIZE], off[NUMBER_SIZE] = "exactly";
    number_print(t, hit->t, false);
    if (hit->t_err > 0) snprintf(off, sizeof off, "at most %.2g off", hit->t_err);
    snprintf(text, ROOT_SIZE, "%s at t = %s, %s", sgt_status_text(hit->status), t, off);
}

static const char *undecided_text(sgt_status status)
{
    switch (status) {
    case SGT_MISS: return "the ray certainly does not meet the surface.";
    case SGT_UNPROVEN: return "there may be a root or none; rounding does not let it be told.";
    case SGT_UNDEFINED: return "F is NaN where the root would have to be.";
    case SGT_EXHAUSTED: return "--max-evals was spent first.";
    case SGT_INVALID: return "this is no ray, or no surface.";
    default: return "no answer.";
    }
}

static void answer(table *t, const sgt_hit *hit, double condition)
{
    if (hit->status <= 0) {
        table_line(t, "%s: %s", sgt_status_text(hit->status), undecided_text(hit->status));
        return;
    }
    char root[ROOT_SIZE];
    print_root(root, hit);
    table_line(t, "%s.", root);
    if (isfinite(condition))
        table_line(t, "Condition %.3g: an error of 1 in F would move t by as much%s.", condition,
                   condition > 100 ? "; the ray grazes" : "");
}

void explain_safeguarded(table *t, const record *r, const sgt_hit *hit)
{
    if (r->count > 0) verdict(t, r);
    else table_line(t, "Answered without an evaluation.");
    answer(t, hit, r->count > 0 ? method_diagnose(r).condition : (double)NAN);
}

/* Near a root the normalised step multiplies the error by 1 - |grad F|. */
static void explain_normalised(table *t, const record *r, sgt_surface surface, const sgt_ray *ray, const sgt_hit *hit)
{
    if (hit->status <= 0) return;
    sgt_vec3 grad;
    surface.ops->value(surface.self, vector_along(ray->o, ray->d, hit->t), &grad);
    double length = vector_length(grad), factor = 1 - length;
    table_line(t, "The gradient was scaled to unit length and F was not: each step is too long by |grad F|,");
    table_line(t, "which is %.6g at the root.  Near it the error is multiplied by 1 - %.6g = %.6g a step:", length, length, factor);
    if (fabs(factor) >= 1) table_line(t, "it goes to and fro and can never settle.  Use the gradient as it is.");
    else if (fabs(factor) > 0.9) table_line(t, "it goes to and fro and hardly closes in.  Use the gradient as it is.");
    else if (r->settled) table_line(t, "it settled, one constant factor at a time.  With the gradient as it is, digits double.");
    else table_line(t, "close to the root it would settle, but it does not come close.  Use the gradient as it is.");
}

void explain_bare(table *t, method m, const record *r, sgt_surface surface, const sgt_ray *ray, const sgt_hit *hit)
{
    if (r->count > 0) verdict(t, r);
    char end[NUMBER_SIZE], root[ROOT_SIZE];
    number_print(end, r->t, false);
    print_root(root, hit);
    if (!r->settled) table_line(t, "Not settled after %zu evaluation%s: %s.", r->count,
                               r->count == 1 ? "" : "s", r->stopped);
    else table_line(t, "Settled at t = %s.", end);
    if (hit->status <= 0) {
        table_line(t, "The library's answer: %s: %s", sgt_status_text(hit->status), undecided_text(hit->status));
    } else {
        /* a bare method rounds o + t d: some ulps beside the library's bound are no disagreement */
        double apart = fabs(r->t - hit->t), close = hit->t_err + 0x1p-40 * fabs(hit->t);
        const char *how = !r->settled ? "" : apart <= close ? ": the same" : ": another root, or none";
        table_line(t, "The library's answer: %s%s.", root, how);
    }
    if (m == METHOD_NORMALISED) explain_normalised(t, r, surface, ray, hit);
    if (m == METHOD_BISECTION && r->settled) table_line(t, "Each evaluation halves the bracket: one bit of t for each.");
}
