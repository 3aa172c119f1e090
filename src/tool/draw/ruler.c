// SPDX-License-Identifier: MIT
/* ruler.c - the axes of a picture.
 *
 * A section has rulers below and at its left, in the lens's unit of length, with ticks at round numbers; one
 * scale holds for both.  The view in space has none, as lengths are foreshortened there: it has three arrows,
 * each as long as a unit of its direction is seen. */
#include "ruler.h"

#include "chart_draw.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const double TICK = 4, MINOR = 2, APART = 4, TICKS_APART = 32, ARROW = 34, HEAD = 5, LETTER = 9;
enum { RULER_LABEL = 80 };

static chart_axis axis_across(const page *p, const frame_box *plot)
{
    chart_axis a = {.low = (plot->left - p->left) / p->scale, .high = (plot->right - p->left) / p->scale};
    chart_axis_ticks_beside(p->cr, &a, plot->right - plot->left);
    return a;
}

static chart_axis axis_upward(const page *p, const frame_box *plot)
{
    chart_axis a = {.low = (p->base - plot->bottom) / p->scale, .high = (p->base - plot->top) / p->scale};
    chart_axis_ticks(&a, plot->bottom - plot->top, TICKS_APART);
    return a;
}

double ruler_width(const page *p, const frame_box *plot)
{
    chart_axis a = axis_upward(p, plot);
    return TICK + APART + chart_axis_width(p->cr, &a);
}

/* "z (mm)" */
static void print_label(char text[CHART_TEXT], const page *p, const chart_axis *a, const char *letter)
{
    const char *units = p->scene->job->lens.units;
    char label[RULER_LABEL];
    snprintf(label, sizeof label, *units ? "%s (%.40s)" : "%s", letter, units);
    chart_axis_label(a, label, true, text);
}

/* Draws the ticks at each step, and those of `minor` parts of it, from (x, y) on by (dx, dy) for the whole
 * axis. side: the direction of a tick. */
static void draw_ruler(const page *p, const chart_axis *a, page_dot from, page_dot way, page_dot side)
{
    cairo_t *cr = p->cr;
    cairo_move_to(cr, from.x, from.y);
    cairo_line_to(cr, from.x + way.x, from.y + way.y);
    for (long i = (chart_axis_first(a) - 1) * a->minor; i <= (chart_axis_last(a) + 1) * a->minor; i++) {
        double u = chart_axis_part(a, a->origin + (double)i * a->step / a->minor);
        double length = i % a->minor == 0 ? TICK : MINOR;
        if (u < -1e-6 || u > 1 + 1e-6) continue;
        cairo_move_to(cr, from.x + u * way.x, from.y + u * way.y);
        cairo_line_to(cr, from.x + u * way.x + length * side.x, from.y + u * way.y + length * side.y);
    }
    page_stroke(p, PAGE_THIN, 0.45);
    chart_font(cr, CHART_SMALL, false);
    chart_grey(cr, 0.3);
    for (long i = chart_axis_first(a); i <= chart_axis_last(a); i++) {
        char text[CHART_TEXT];
        double u = chart_axis_part(a, a->origin + (double)i * a->step);
        double x = from.x + u * way.x + (TICK + APART) * side.x, y = from.y + u * way.y;
        chart_axis_number(a, i, text);
        if (side.x == 0)
            chart_text(cr, x, y + TICK + CHART_SMALL + 1, 0.5, HUGE_VAL, text);
        else
            chart_text(cr, x, y + 0.35 * CHART_SMALL, 1, HUGE_VAL, text);
    }
}

void ruler_draw(const page *p, const frame_box *plot)
{
    const double wide = plot->right - plot->left, high = plot->bottom - plot->top;
    const char *upward = p->scene->view.plane == VIEW_XZ ? "x" : "y";
    char text[CHART_TEXT];
    chart_axis across = axis_across(p, plot), up = axis_upward(p, plot);
    draw_ruler(p, &across, (page_dot){plot->left, plot->bottom}, (page_dot){wide, 0}, (page_dot){0, 1});
    draw_ruler(p, &up, (page_dot){plot->left, plot->bottom}, (page_dot){0, -high}, (page_dot){-1, 0});
    print_label(text, p, &across, "z");
    chart_text(p->cr, plot->right, plot->bottom + RULER_HEIGHT - 4, 1, wide, text);
    print_label(text, p, &up, upward);
    chart_text(p->cr, plot->left + APART, plot->top + CHART_SMALL, 0, wide, text);
}

void ruler_directions(const page *p, page_dot from)
{
    static const char *const letter[] = {"x", "y", "z"};
    const sgt_vec3 axis[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    for (int k = 0; k < 3; k++) {
        page_dot d = page_along(p, axis[k]);
        page_dot tip = {from.x + ARROW * d.x, from.y + ARROW * d.y};
        double length = hypot(d.x, d.y), x = HEAD * d.x / length, y = HEAD * d.y / length;
        cairo_move_to(p->cr, from.x, from.y), cairo_line_to(p->cr, tip.x, tip.y);
        cairo_move_to(p->cr, tip.x - x - y / 2, tip.y - y + x / 2), cairo_line_to(p->cr, tip.x, tip.y);
        cairo_line_to(p->cr, tip.x - x + y / 2, tip.y - y - x / 2);
        page_stroke(p, PAGE_SURFACE, 0.3);
        chart_font(p->cr, CHART_SMALL, false);
        chart_grey(p->cr, 0.2);
        double beyond = LETTER / length;
        chart_text(p->cr, tip.x + beyond * d.x, tip.y + beyond * d.y + 0.3 * CHART_SMALL, 0.5, HUGE_VAL,
                   letter[k]);
    }
}
