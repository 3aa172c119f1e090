// SPDX-License-Identifier: MIT
/* diagnose.c - how did the solver converge, and why did it not?
 *
 * THE IDEA.  Let e, e' be two successive errors.
 *
 *     a simple root, Newton's step         e' ~ |g''/2g'| e^2
 *     a root of multiplicity m             e' = (1 - 1/m) e
 *     a slope off by a constant factor q   e' = |1 - 1/q| e
 *     a gradient scaled to unit length     the step is wrong by |grad F|, and may go to and fro for ever
 *
 * So the order p and the rate C in e' ~ C e^p tell what is wrong.  Three errors in a row give both:
 *
 *     p = log(e3 / e2) / log(e2 / e1),   C = e3 / e2^p.
 *
 * STEPS INSTEAD OF ERRORS.  The errors are not known; the steps are.  For any p > 1 the step is the error
 * but for what is left after it, s = e - e' ~ e.  For p = 1 it is e (1 - C), the same factor each time.
 * So s may replace e in p (Ortega & Rheinboldt 1970, chapter 9).  s1, s2, s3 are the last three steps that
 * rounding has not touched.  The step that the last slope would take next is one more; without it three
 * evaluations would say nothing.  (Errors against the last t are no better: at a double root the last t is
 * as far from the root as the last step is long.)
 *
 * WHICH STEPS.  Only a run of Newton steps has an order.  A bisection, a back-off or a march begins a new
 * run; the last run is judged.  Probes, which look beside a root already found, are skipped.  So are
 * evaluations that gave NaN, and bounds over cells.  If a log has several solves (eval begins at 1 again),
 * the last is judged.
 *
 * WHEN IT FAILS.  Two steps have no order: it is NaN, and the verdict goes by how much one gained on the
 * other.  A log that was cut short (n > cap) is judged by what it kept.
 *
 * THE NUMBERS are no tolerances of an answer.  They separate verdicts:
 *
 *     FLOOR_ULPS 16       a step below it is taken for none.  The solver ends with steps of a few ulps on
 *                         purpose (root.c, overshooting), and t itself is rounded
 *     CLOSED 2^-20        a bracket narrower than that part of t has the width of an answer, not of a search.
 *                         It is the size of what is not known, and a step below it is none either
 *     NEWTON_GAIN 2^-7    the most that a step which gains two digits or more leaves of the one before.
 *                         Linear convergence as fast as that needs no mending
 *     order 1.5           is between 1 (linear) and 1.618 (the secant method), 2 (Newton)
 *     SETTLING 0.9        to and fro by nine tenths each time would take 350 steps to 16 digits.  The
 *                         normalised gradient of the scan lens (tests/unit/test_diagnose.c) shows 0.93 to
 *                         0.99
 *     LATE 3              evaluations before the steps close in.  They are all that a better start can save.
 *                         It has to be evaluated itself, and the step from any start may be too long: so one
 *                         or two are no fault, three are one or more saved */
#include <sagitta/diagnose.h>

#include "../num/elementary.h"

#include <float.h>
#include <limits.h>
#include <math.h>

enum { LATE = 3 };
static const double FLOOR_ULPS = 16, CLOSED = 0x1p-20, NEWTON_GAIN = 0x1p-7, SETTLING = 0.9;

int sgt_log_step(void *log, const sgt_step *step)
{
    sgt_log *l = log;
    if (l->n >= 0 && l->n < l->cap && l->step) l->step[l->n] = *step;
    if (l->n < INT_MAX) l->n++;
    return 0;
}

static bool is_iterate(const sgt_step *s)
{
    return s->kind == SGT_AT_POINT && s->move != SGT_PROBE && isfinite(s->f) && isfinite(s->t);
}

/* The last steps that are longer than `least`, newest first.
 *
 *     lost    the step after them, if that is not longer; NaN: none
 *     next    the step that the last slope would take; NaN: none */
enum { STEPS = 8 };
typedef struct diagnose_run { double next, lost, size[STEPS]; int n; bool to_and_fro; } diagnose_run;

/* The last run of Newton steps in step[0 ... n-1]; any_move: of steps of any kind. */
static diagnose_run last_run(const sgt_step *step, int n, bool any_move, double least)
{
    diagnose_run r = {.next = (double)NAN, .lost = (double)NAN, .to_and_fro = true};
    const sgt_step *later = NULL;
    double before = 0;
    for (int i = n - 1; i >= 0 && r.n < STEPS; i--) {
        if (!is_iterate(&step[i])) continue;
        if (later) {
            if (!any_move && later->move != SGT_NEWTON) break;
            double s = later->t - step[i].t;
            if (r.n == 0 && fabs(s) <= least) {
                r.lost = fabs(s);
            } else {
                if (s * before > 0) r.to_and_fro = false;
                r.size[r.n++] = fabs(s);
                before = s;
            }
        } else {
            r.next = fabs(step[i].f / step[i].slope);
        }
        later = &step[i];
    }
    return r;
}

/* To and fro: three steps or more, each against the one before, and not closing in. */
static bool oscillates(const diagnose_run *r)
{
    if (!r->to_and_fro || r->n < 3 || !isnan(r->lost)) return false;
    return r->size[0] / r->size[r->n - 1] > integer_power(SETTLING, (unsigned)r->n - 1);
}

/* Sets order and rate from s1, s2, s3, and returns their verdict; WANDERING: none. */
static sgt_verdict diagnose_judge(double s1, double s2, double s3, sgt_diagnosis *d)
{
    if (!(s3 < s2 && s2 < s1)) return SGT_WANDERING;
    double order = logarithm(s3 / s2) / logarithm(s2 / s1);
    sgt_verdict v = order >= 1.5 ? (s3 <= 0.25 * s2 ? SGT_QUADRATIC : SGT_WANDERING)
                  : order > 0.6 ? SGT_LINEAR : SGT_WANDERING;
    if (v != SGT_WANDERING) d->order = order, d->rate = exponential(logarithm(s3) - order * logarithm(s2));
    return v;
}

static int before_closing(const sgt_step *step, int n, double least);

static sgt_diagnosis diagnose_log(const sgt_log *log)
{
    sgt_diagnosis d = {
        .verdict = SGT_WANDERING, .order = (double)NAN, .rate = (double)NAN, .condition = (double)NAN};
    const sgt_step *step = log ? log->step : NULL, *first = NULL, *last = NULL;
    int n = !step ? 0 : log->n < log->cap ? log->n : log->cap, defined = 0;
    for (int i = n - 1; i > 0; i--)
        if (step[i].eval == 1) { /* the last solve */
            step += i, n -= i;
            break;
        }
    double big = 0, spread = 0;
    for (int i = 0; i < n; i++) {
        d.newton += step[i].move == SGT_NEWTON;
        d.bisect += step[i].move == SGT_BISECT;
        d.march += step[i].move == SGT_MARCH;
        d.retreat += step[i].move == SGT_RETREAT;
        if (step[i].kind == SGT_AT_POINT && !isnan(step[i].slope)) d.condition = 1 / fabs(step[i].slope);
        if (!is_iterate(&step[i])) continue;
        if (!first) first = &step[i];
        last = &step[i];
        big = maximum_number(big, fabs(last->t));
        spread = maximum_number(spread, fabs(last->t - first->t));
        defined++;
    }
    if (!defined) return d;

    double least = FLOOR_ULPS * DBL_EPSILON * big, bracket = last->hi - last->lo;
    if (bracket <= CLOSED * big) least = maximum_number(least, bracket);
    d.before = before_closing(step, n, least);
    diagnose_run all = last_run(step, n, true, least), newton = last_run(step, n, false, least);
    if (first->f == 0 || (spread <= least && (defined > 1 || all.next <= least))) d.verdict = SGT_ROUNDING;
    else if (d.bisect > d.newton) d.verdict = SGT_BISECTING;
    else if (oscillates(&newton) || oscillates(&all)) d.verdict = SGT_OSCILLATING;
    if (d.verdict != SGT_WANDERING) return d;

    double s[STEPS + 1], lost = newton.lost; /* with the next step, if there is one */
    int left = 0;
    if (newton.next > least && isfinite(newton.next) && isnan(lost)) s[left++] = newton.next;
    else if (newton.next <= least && isnan(lost)) lost = newton.next;
    for (int i = 0; i < newton.n; i++) s[left++] = newton.size[i];
    /* The newest may be noise all the same (the slope of a double root): two may be dropped. */
    for (int i = 0; i < 3 && i + 2 < left && d.verdict == SGT_WANDERING; i++)
        d.verdict = diagnose_judge(s[i + 2], s[i + 1], s[i], &d);
    if (d.verdict == SGT_WANDERING && left >= 1) {
        double later = isnan(lost) ? s[0] : minimum_number(lost, least);
        double before = isnan(lost) ? (left >= 2 ? s[1] : 0) : s[0];
        if (later <= NEWTON_GAIN * before) d.verdict = SGT_QUADRATIC;
    }
    return d;
}

sgt_diagnosis sgt_diagnose(const sgt_log *log)
{
    sgt_diagnosis d = diagnose_log(log);
    if (d.verdict == SGT_QUADRATIC && d.before >= LATE) d.verdict = SGT_LATE;
    return d;
}

/* How many iterates come before those whose steps shrink to the end, each to half or less.  A step that
 * rounding has touched, below `least`, says nothing.  The step that leads to the first of those belongs to
 * what came before. */
static int before_closing(const sgt_step *step, int n, double least)
{
    const sgt_step *later = NULL;
    int all = 0, closing = 0;
    double size = 0;
    bool shrinks = true;
    for (int i = n - 1; i >= 0; i--) {
        if (step[i].kind != SGT_AT_POINT || step[i].move == SGT_PROBE || step[i].move == SGT_MARCH) continue;
        all++;
        if (!is_iterate(&step[i])) { /* NaN: what led there was no step toward the root */
            if (later) shrinks = false;
            else all--;
            continue;
        }
        if (later && shrinks) {
            double s = fabs(later->t - step[i].t);
            shrinks = s <= least || size == 0 || size <= 0.5 * s;
            if (shrinks && s > least) size = s;
        }
        closing += shrinks;
        later = &step[i];
    }
    return all - closing;
}

const char *sgt_verdict_text(sgt_verdict v)
{
    switch (v) {
    case SGT_QUADRATIC: return "quadratic: Newton's method at its best, nothing to mend";
    case SGT_LINEAR:
        return "linear: a constant factor a step; "
               "the ray grazes (a double root), or the slope is off: run sgt_check on the gradient";
    case SGT_BISECTING:
        return "bisecting: the bracket did the work; "
               "give a better seed, or run sgt_check on the gradient: its steps were refused";
    case SGT_OSCILLATING:
        return "oscillating: to and fro without closing in; "
               "is the gradient normalised? It must keep its length: run sgt_check";
    case SGT_WANDERING:
        return "wandering: no pattern, or too few steps to tell; look at the rows: give a span and a seed "
               "near the root";
    case SGT_ROUNDING:
        return "rounding: the seed is the root already, to within rounding; no step can come closer";
    case SGT_LATE:
        return "wandering at first, quadratic in the end: a start nearer to the root saves the first steps";
    }
    return "?";
}
