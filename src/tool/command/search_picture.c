// SPDX-License-Identifier: MIT
/* search_picture.c - the picture of one search, in four panels.
 *
 *     F along the ray  its curve, and each evaluation on it, with a mark for how its t was chosen.  Newton's
 *                      steps go along the tangent to its zero, and from there to the curve
 *     where it looked  the same evaluations, one above the other, with the bracket or cell of each
 *     the slope        grad F . d, what Newton's step divides by; |grad F|; their quotient if that is used
 *     the errors       of each method, against evaluations: a curve that falls ever faster is quadratic, a
 *                      straight line is linear.  Left out if no root is known
 *
 * The first three show the same stretch of the ray: the bracket, if the ray has two ends; else what holds all
 * evaluations.  What lies outside is counted in a note.  Of a function, t is x. */
#include "contest.h"

#include "../base/memory.h"
#include "../draw/chart.h"
#include "../show/frame.h"

#include <float.h>
#include <math.h>

enum { SAMPLES = 401, MARKS = SGT_PROBE + 1, STEEPEST = 4, FARTHEST = 100 };

typedef struct search_picture {
    const contest *of;
    const record *seen;
    method shown;
    double low, high; /* the stretch that is shown */
    size_t outside;
    bool function;        /* of x; else of a ray */
} search_picture;

/* Points to draw, one after another; NaN is a gap. */
typedef struct points {
    size_t count, x_room, y_room;
    double *x, *y;
} points;

static void point_add(points *p, double x, double y)
{
    p->x = memory_room(p->x, p->count, &p->x_room, sizeof *p->x);
    p->y = memory_room(p->y, p->count, &p->y_room, sizeof *p->y);
    p->x[p->count] = x, p->y[p->count++] = y;
}
static void gap_add(points *p) { point_add(p, (double)NAN, (double)NAN); }

/* (an end is rounded) */
static bool inside(const search_picture *c, double t)
{
    const double room = 1e-9 * (c->high - c->low);
    return t >= c->low - room && t <= c->high + room;
}

static chart_series series_of(const points *p, const char *name, size_t colour, chart_mark mark,
                              chart_dash dash)
{
    return (chart_series){.name = name,
                          .colour = colour,
                          .mark = mark,
                          .dash = dash,
                          .line = true,
                          .count = p->count,
                          .x = p->x,
                          .y = p->y};
}

/* ----------------------------------------------------------- what is shown */

static void take_in(search_picture *c, double t)
{
    if (isfinite(t)) c->low = fmin(c->low, t), c->high = fmax(c->high, t);
}

static search_picture search_picture_of(const contest *of, method shown)
{
    search_picture c = {
        .of = of, .seen = &of->seen[shown], .shown = shown, .low = HUGE_VAL, .high = -HUGE_VAL};
    const sgt_ray *ray = &of->s.ray;
    const double root = of->s.hit->status > 0 ? of->s.hit->t : (double)NAN;
    if (isfinite(ray->tmin) && isfinite(ray->tmax) && ray->tmin < ray->tmax) {
        c.low = ray->tmin, c.high = ray->tmax;
    } else {
        for (size_t i = 0; i < c.seen->count; i++)
            take_in(&c, c.seen->step[i].t), take_in(&c, c.seen->step[i].lo), take_in(&c, c.seen->step[i].hi);
        take_in(&c, root);
        if (!(c.low <= c.high)) c.low = c.high = 0;
        const sgt_surface_ops *ops = of->s.surface.ops;
        const double width = c.high - c.low;
        if (width <= 1e-6 * fabs(c.high) && ops->span) { /* answered at once */
            const sgt_span span = ops->span(of->s.surface.self, ray);
            if (span.lo <= span.hi)
                take_in(&c, fmax(span.lo, ray->tmin)), take_in(&c, fmin(span.hi, ray->tmax));
        }
        double margin = (c.high - c.low) / 20;
        if (!(c.high - c.low > 1e-6 * fabs(c.high))) margin = 1 + fabs(c.high) / 4;
        c.low -= margin, c.high += margin;
    }
    for (size_t i = 0; i < c.seen->count; i++) c.outside += !inside(&c, c.seen->step[i].t);
    return c;
}

/* F at t, and the gradient. */
static double value_at(const search_picture *c, double t, sgt_vec3 *grad)
{
    const sgt_search *s = &c->of->s;
    return s->surface.ops->value(s->surface.self, vector_along(s->ray.o, s->ray.d, t), grad);
}

/* ---------------------------------------------------------------- the marks */

static const struct {
    const char *name;
    chart_mark mark;
    size_t colour;
} look[MARKS] = {
    [SGT_SEED] = {"seed: the start", CHART_RING, 2},
    [SGT_NEWTON] = {"newton: a Newton step", CHART_TRIANGLE, 0},
    [SGT_BISECT] = {"bisect: the middle of a bracket", CHART_CROSS, 4},
    [SGT_MARCH] = {"march: a step along the ray", CHART_PLUS, 5},
    [SGT_RETREAT] = {"retreat: back from a NaN", CHART_DIAMOND, 6},
    [SGT_PROBE] = {"probe: beside the root", CHART_SQUARE, 1},
};

/* Appends a series for each kind of move; y: F, or the number of the evaluation. */
static size_t add_marks(const search_picture *c, bool numbers, chart_series *to)
{
    size_t n = 0;
    for (int move = 0; move < MARKS; move++) {
        points p = {0};
        for (size_t i = 0; i < c->seen->count; i++) {
            const sgt_step *s = &c->seen->step[i];
            if ((int)s->move != move || !inside(c, s->t) || (!numbers && s->kind == SGT_OVER_CELL)) continue;
            point_add(&p, s->t, numbers ? (double)(i + 1) : isnan(s->f) ? 0 : s->f), gap_add(&p);
        }
        if (p.count)
            to[n++] = series_of(&p, look[move].name, look[move].colour, look[move].mark, CHART_SOLID);
    }
    return n;
}

/* --------------------------------------------------------------- the panels */

/* From an evaluation along its tangent to the zero of that, as far as is shown. */
static void add_tangents(const search_picture *c, points *p)
{
    for (size_t i = 0; i + 1 < c->seen->count; i++) {
        const sgt_step *s = &c->seen->step[i], *next = s + 1;
        if (next->move != SGT_NEWTON || !isfinite(s->f) || !inside(c, s->t)) continue;
        const double to = fmin(fmax(next->t, c->low), c->high), part = (to - s->t) / (next->t - s->t);
        if (!isfinite(part)) continue;
        point_add(p, s->t, s->f), point_add(p, to, s->f * (1 - part));
        if (part == 1 && isfinite(next->f)) point_add(p, to, next->f);
        gap_add(p);
    }
}

static chart_panel panel_of_values(const search_picture *c, const char *const *note)
{
    points curve = {0}, tangents = {0};
    chart_series *s = memory_take(MARKS + 2, sizeof *s);
    for (int i = 0; i < SAMPLES; i++) {
        const double t = c->low + (c->high - c->low) * i / (SAMPLES - 1);
        point_add(&curve, t, value_at(c, t, NULL));
    }
    add_tangents(c, &tangents);
    size_t n = 0;
    s[n++] = series_of(&curve, c->function ? "f" : "F along the ray", 4, CHART_NO_MARK, CHART_SOLID);
    if (tangents.count)
        s[n++] =
            series_of(&tangents, "Newton's step, along the slope to zero", 3, CHART_NO_MARK, CHART_DASHED);
    n += add_marks(c, false, s + n);
    return (chart_panel){.title = c->function ? "f (NaN: on the line f = 0)"
                                              : "F along the ray (NaN: on the line F = 0)",
                         .x_label = c->function ? "x" : "t",
                         .y_label = c->function ? "f" : "F",
                         .x_low = c->low,
                         .x_high = c->high,
                         .note = note,
                         .notes = c->outside > 0,
                         .series_count = n,
                         .series = s};
}

static chart_panel panel_of_brackets(const search_picture *c)
{
    points bars = {0};
    chart_series *s = memory_take(MARKS + 1, sizeof *s);
    for (size_t i = 0; i < c->seen->count; i++) {
        const sgt_step *step = &c->seen->step[i];
        const double lo = fmax(step->lo, c->low), hi = fmin(step->hi, c->high);
        if (isnan(step->lo) || isnan(step->hi) || !(lo < hi)) continue;
        point_add(&bars, lo, (double)(i + 1)), point_add(&bars, hi, (double)(i + 1)), gap_add(&bars);
    }
    size_t n = 0;
    if (bars.count)
        s[n++] = series_of(&bars, "bracket, cell, or what is left", 3, CHART_NO_MARK, CHART_SOLID);
    n += add_marks(c, true, s + n);
    return (chart_panel){.title = "Where it looked",
                         .x_label = c->function ? "x" : "t",
                         .y_label = "evaluation",
                         .y_high = (double)c->seen->count + 1,
                         .x_low = c->low,
                         .x_high = c->high,
                         .series_count = n,
                         .series = s};
}

static chart_panel panel_of_slope(const search_picture *c)
{
    points slope = {0}, length = {0}, used = {0};
    double most = 0; /* the edge of a sag is steep without end: what is far beyond the slopes that were used
                        is not drawn */
    for (size_t i = 0; i < c->seen->count; i++) most = fmax(most, STEEPEST * fabs(c->seen->step[i].slope));
    if (!(most > 0)) most = HUGE_VAL;
    for (int i = 0; i < SAMPLES; i++) {
        const double t = c->low + (c->high - c->low) * i / (SAMPLES - 1), none = (double)NAN;
        sgt_vec3 grad = {none, none, none};
        const bool there = !isnan(value_at(c, t, &grad));
        const double g = vector_dot(grad, c->of->s.ray.d), all = vector_length(grad);
        point_add(&slope, t, there && fabs(g) <= most ? g : none);
        point_add(&length, t, there && all <= most ? all : none);
        point_add(&used, t, there ? g / all : none);
    }
    chart_series *s = memory_take(3, sizeof *s);
    const char *const slope_name = c->function ? "f', the slope" : "grad F . d, the slope",
                      *const used_name = c->function ? "f' / |f'|, used in its place"
                                                     : "grad F . d / |grad F|, used in its place";
    s[0] = series_of(&slope, slope_name, 0, CHART_NO_MARK, CHART_SOLID);
    s[1] = series_of(&length, c->function ? "|f'|" : "|grad F|", 4, CHART_NO_MARK, CHART_DASHED);
    s[2] = series_of(&used, used_name, 2, CHART_NO_MARK, CHART_DOTTED);
    return (chart_panel){.title = c->function ? "The slope" : "The slope along the ray",
                         .x_label = c->function ? "x" : "t",
                         .y_label = "slope",
                         .x_low = c->low,
                         .x_high = c->high,
                         .series_count = c->shown == METHOD_NORMALISED ? 3 : 2,
                         .series = s};
}

/* An error of 0 is shown as half an ulp of the root; one of FARTHEST times the stretch that is shown is not,
 * since a method that flies off would leave the others no room. */
static chart_panel panel_of_errors(const search_picture *c)
{
    const contest *of = c->of;
    const double root = of->s.hit->t, least = fmax(DBL_EPSILON / 4 * fabs(root), DBL_MIN);
    chart_series *s = memory_take(METHODS, sizeof *s);
    size_t n = 0;
    for (size_t m = 0; m < METHODS; m++) {
        points p = {0};
        for (size_t i = 0; i < of->seen[m].count; i++) {
            const sgt_step *step = &of->seen[m].step[i];
            const bool iterate = step->kind == SGT_AT_POINT && step->move != SGT_PROBE;
            const double error = fmax(fabs(step->t - root), least);
            if (iterate && error < FARTHEST * (c->high - c->low))
                point_add(&p, (double)(i + 1), log10(error));
        }
        if (p.count)
            s[n++] = series_of(&p, memory_print("method %s", method_name[m]), m, (chart_mark)(CHART_PLUS + m),
                               (chart_dash)(m % 3));
    }
    return (chart_panel){.title = "The error of each method",
                         .x_label = "evaluation",
                         .y_label = c->function ? "log10 |x - root|" : "log10 |t - root|",
                         .series_count = n,
                         .series = s};
}

void contest_draw(const char *path, const char *title, const contest *of, method shown, bool function)
{
    search_picture c = search_picture_of(of, shown);
    c.function = function;
    const char *note = memory_print("%zu of %zu evaluations lie outside", c.outside, c.seen->count);
    const char *line =
        memory_print("--method %s, %zu evaluation%s: %s", method_name[shown], c.seen->count,
                     c.seen->count == 1 ? "" : "s", c.seen->count ? explain_advice(shown, c.seen) : "");
    chart_panel panel[4] = {panel_of_values(&c, &note), panel_of_brackets(&c), panel_of_slope(&c)};
    const bool known = of->s.hit->status > 0;
    if (known) panel[3] = panel_of_errors(&c);
    chart_write(
        path,
        &(chart){
            .title = title, .line = &line, .lines = 1, .columns = 2, .panels = 3 + known, .panel = panel});
}
