// SPDX-License-Identifier: MIT
/* chart_panel.c - one panel: what it shows, its axes and their texts, and its contents from back to front.
 *
 * Around the plot, from inside out: ticks, their numbers, the label.  The numbers of the y axis are as wide
 * as they are, so a panel tells how much room it needs (chart_place_left), and the sheet gives all panels the
 * same.  With a scale bar the grid is as wide as the bar is long. */
#include "chart_draw.h"

#include <math.h>

static const double TICK_LENGTH = 4, MINOR_LENGTH = 2, NUMBER_GAP = 6, LABEL_GAP = 5, EDGE = 0.7, GRID = 0.5,
                    FOOT_NUMBERS = 15, FOOT_LABEL = 13, FOOT_BAR = 18,
                    LABEL_BEYOND = 6, /* a label may be longer than the axis */
    SMALLEST_MAP = 0.01;

/* Whether there is a map that can be drawn. */
static bool map_there(const chart_map *m)
{
    return m && m->columns > 0 && m->rows > 0 && chart_finite(m->x_low) && chart_finite(m->x_high) &&
           chart_finite(m->y_low) && chart_finite(m->y_high) && m->x_low < m->x_high && m->y_low < m->y_high;
}

static void map_range(chart_place *p, const chart_map *m)
{
    if (!map_there(m)) return;
    chart_range_add(p->x_range.fixed, m->x_low), chart_range_add(p->x_range.fixed, m->x_high);
    chart_range_add(p->y_range.fixed, m->y_low), chart_range_add(p->y_range.fixed, m->y_high);
}

bool chart_circle_there(const chart_circle *c)
{
    return c->radius >= 0 && chart_finite(fabs(c->x) + c->radius) && chart_finite(fabs(c->y) + c->radius);
}

chart_place chart_place_of(const chart_panel *p)
{
    chart_place place = {
        .of = p, .bar = p->bar && p->square, .x_range = chart_range_none(), .y_range = chart_range_none()};
    double *x = place.x_range.free, *y = place.y_range.free;
    if (p->x_low != 0 || p->x_high != 0)
        chart_range_add(place.x_range.fixed, p->x_low), chart_range_add(place.x_range.fixed, p->x_high);
    if (p->y_low != 0 || p->y_high != 0)
        chart_range_add(place.y_range.fixed, p->y_low), chart_range_add(place.y_range.fixed, p->y_high);
    map_range(&place, p->map);
    for (size_t i = 0; i < p->series_count; i++) {
        const chart_series *s = &p->series[i];
        for (size_t k = 0; k < s->count; k++)
            if (chart_finite(s->x[k]) && chart_finite(s->y[k]))
                chart_range_add(x, s->x[k]), chart_range_add(y, s->y[k]);
    }
    for (size_t i = 0; i < p->circles; i++) {
        const chart_circle *c = &p->circle[i];
        if (!chart_circle_there(c)) continue;
        chart_range_add(x, c->x - c->radius), chart_range_add(x, c->x + c->radius);
        chart_range_add(y, c->y - c->radius), chart_range_add(y, c->y + c->radius);
    }
    for (size_t i = 0; i < p->rules; i++) chart_range_add(p->rule[i].upright ? x : y, p->rule[i].at);
    return place;
}

/* ------------------------------------------------------------------- room */

double chart_place_left(cairo_t *cr, const chart_place *p)
{
    char text[CHART_TEXT];
    double label = chart_axis_label(&p->y, p->of->y_label, !p->bar, text) ? LABEL_GAP + CHART_NORMAL : 0;
    return label + (p->bar ? 0 : NUMBER_GAP + chart_axis_width(cr, &p->y));
}

static double bar_length(const chart_place *p, double wide)
{
    return p->x.step / (p->x.high - p->x.low) * wide;
}

double chart_place_right(cairo_t *cr, const chart_place *p, double wide)
{
    char text[CHART_TEXT];
    if (p->bar)
        chart_number(p->x.step, NULL, text);
    else
        chart_axis_number(&p->x, chart_axis_last(&p->x), text);
    chart_font(cr, CHART_SMALL, false);
    double number = chart_width(cr, text),
           beyond = p->bar ? bar_length(p, wide) + 5 + number - wide : number / 2;
    return fmax(beyond, p->of->map ? chart_scale_width(cr, p->of->map, &p->scale) : 0);
}

double chart_place_foot(const chart_place *p)
{
    char text[CHART_TEXT];
    if (p->bar) return FOOT_BAR;
    return FOOT_NUMBERS + (chart_axis_label(&p->x, p->of->x_label, true, text) ? FOOT_LABEL : 0);
}

/* ------------------------------------------------------------------- axes */

static double x_at(const chart_place *p, double i, double step)
{
    return p->plot.left + chart_axis_part(&p->x, p->x.origin + i * step) * (p->plot.right - p->plot.left);
}

static double y_at(const chart_place *p, double i, double step)
{
    return p->plot.bottom - chart_axis_part(&p->y, p->y.origin + i * step) * (p->plot.bottom - p->plot.top);
}

/* The lines through zero are darker. */
static void draw_grid(cairo_t *cr, const chart_place *p)
{
    const chart_box *b = &p->plot;
    cairo_set_line_width(cr, GRID);
    for (int zero = 0; zero < 2; zero++) {
        for (long i = chart_axis_first(&p->x); i <= chart_axis_last(&p->x); i++) {
            if ((i == 0 && p->x.origin == 0) != zero) continue;
            cairo_move_to(cr, x_at(p, (double)i, p->x.step), b->top),
                cairo_rel_line_to(cr, 0, b->bottom - b->top);
        }
        for (long i = chart_axis_first(&p->y); i <= chart_axis_last(&p->y); i++) {
            if ((i == 0 && p->y.origin == 0) != zero) continue;
            cairo_move_to(cr, b->left, y_at(p, (double)i, p->y.step)),
                cairo_rel_line_to(cr, b->right - b->left, 0);
        }
        chart_grey(cr, zero ? 0.65 : 0.88);
        cairo_stroke(cr);
    }
}

static void draw_ticks(cairo_t *cr, const chart_place *p)
{
    const chart_box *b = &p->plot;
    long first = (chart_axis_first(&p->x) - 1) * p->x.minor, last = (chart_axis_last(&p->x) + 1) * p->x.minor;
    for (long i = first; i <= last; i++) {
        double x = x_at(p, (double)i, p->x.step / p->x.minor);
        if (x < b->left - 0.01 || x > b->right + 0.01) continue;
        cairo_move_to(cr, x, b->bottom);
        cairo_line_to(cr, x, b->bottom + (i % p->x.minor ? MINOR_LENGTH : TICK_LENGTH));
    }
    first = (chart_axis_first(&p->y) - 1) * p->y.minor, last = (chart_axis_last(&p->y) + 1) * p->y.minor;
    for (long i = first; i <= last; i++) {
        double y = y_at(p, (double)i, p->y.step / p->y.minor);
        if (y < b->top - 0.01 || y > b->bottom + 0.01) continue;
        cairo_move_to(cr, b->left, y);
        cairo_line_to(cr, b->left - (i % p->y.minor ? MINOR_LENGTH : TICK_LENGTH), y);
    }
    cairo_set_line_width(cr, EDGE);
    cairo_stroke(cr);
}

static void draw_numbers(cairo_t *cr, const chart_place *p)
{
    char text[CHART_TEXT];
    chart_font(cr, CHART_SMALL, false);
    for (long i = chart_axis_first(&p->x); i <= chart_axis_last(&p->x); i++) {
        chart_axis_number(&p->x, i, text);
        chart_text(cr, x_at(p, (double)i, p->x.step), p->plot.bottom + FOOT_NUMBERS - 2, 0.5, HUGE_VAL, text);
    }
    for (long i = chart_axis_first(&p->y); i <= chart_axis_last(&p->y); i++) {
        chart_axis_number(&p->y, i, text);
        chart_text(cr, p->plot.left - NUMBER_GAP, y_at(p, (double)i, p->y.step) + 0.35 * CHART_SMALL, 1,
                   HUGE_VAL, text);
    }
}

static void draw_labels(cairo_t *cr, const chart_place *p)
{
    char text[CHART_TEXT];
    const chart_box *b = &p->plot;
    double left = b->left - NUMBER_GAP - chart_axis_width(cr, &p->y) - LABEL_GAP,
           wide = b->right - b->left + 2 * fmin(p->before, p->after),
           high = b->bottom - b->top + 2 * LABEL_BEYOND;
    chart_axis_label(&p->x, p->of->x_label, true, text);
    chart_font_within(cr, CHART_NORMAL, wide, text);
    chart_text(cr, (b->left + b->right) / 2, b->bottom + FOOT_NUMBERS + FOOT_LABEL - 3, 0.5, wide, text);
    chart_axis_label(&p->y, p->of->y_label, true, text);
    chart_font_within(cr, CHART_NORMAL, high, text);
    chart_text_up(cr, left, (b->top + b->bottom) / 2, high, text);
}

/* The bar and its length on the left below the plot, the name of x on the right. */
static void draw_scale_bar(cairo_t *cr, const chart_place *p)
{
    char text[CHART_TEXT], unit[CHART_TEXT];
    const chart_box *b = &p->plot;
    double y = b->bottom + FOOT_BAR - 6, end = b->left + bar_length(p, b->right - b->left),
           right = b->right + p->after;
    for (int i = 0; i < 2; i++)
        cairo_move_to(cr, i ? end : b->left, y - 6), cairo_line_to(cr, i ? end : b->left, y);
    cairo_move_to(cr, b->left, y - 3), cairo_line_to(cr, end, y - 3);
    cairo_set_line_width(cr, 1);
    cairo_stroke(cr);
    chart_number(p->x.step, NULL, text);
    chart_font(cr, CHART_SMALL, false);
    chart_text(cr, end += 5, y, 0, HUGE_VAL, text);
    chart_unit(p->of->x_label, unit);
    end += chart_width(cr, text) + 3;
    chart_text(cr, end, y, 0, right - end, unit);
    end += chart_width(cr, unit) + 10;
    chart_font(cr, CHART_NORMAL, false);
    chart_axis_label(&p->x, p->of->x_label, false, text);
    chart_text(cr, b->right, y, 1, b->right - end, text);
    chart_axis_label(&p->y, p->of->y_label, false, text);
    chart_text_up(cr, b->left - LABEL_GAP, (b->top + b->bottom) / 2, b->bottom - b->top, text);
}

/* --------------------------------------------------------------- contents */

static void draw_map(cairo_t *cr, const chart_place *p)
{
    const chart_map *m = p->of->map;
    if (!map_there(m)) return;
    double x = p->plot.right - p->plot.left, y = p->plot.bottom - p->plot.top;
    chart_box at = {.left = p->plot.left + chart_axis_part(&p->x, m->x_low) * x,
                    .right = p->plot.left + chart_axis_part(&p->x, m->x_high) * x,
                    .top = p->plot.bottom - chart_axis_part(&p->y, m->y_high) * y,
                    .bottom = p->plot.bottom - chart_axis_part(&p->y, m->y_low) * y};
    /* Cairo refuses a scale of 0: of a map beside values that are 1e9 times as large. */
    if (!(at.right - at.left > SMALLEST_MAP && at.bottom - at.top > SMALLEST_MAP)) return;
    chart_map_draw(cr, m, &p->scale, &at);
    chart_scale_draw(cr, m, &p->scale, &p->plot);
}

void chart_place_draw(cairo_t *cr, const chart_place *p)
{
    const chart_panel *of = p->of;
    draw_grid(cr, p);
    draw_map(cr, p);
    chart_grey(cr, 0.25);
    cairo_rectangle(cr, p->plot.left, p->plot.top, p->plot.right - p->plot.left,
                    p->plot.bottom - p->plot.top);
    cairo_set_line_width(cr, EDGE);
    cairo_stroke(cr);
    for (size_t i = 0; i < of->rules; i++) chart_rule_draw(cr, p, &of->rule[i]);
    for (size_t i = 0; i < of->series_count; i++) chart_series_draw(cr, p, &of->series[i]);
    for (size_t i = 0; i < of->circles; i++) chart_circle_draw(cr, p, &of->circle[i]);
    chart_grey(cr, 0.25);
    if (p->bar) {
        draw_scale_bar(cr, p);
        return;
    }
    draw_ticks(cr, p);
    draw_numbers(cr, p);
    draw_labels(cr, p);
}
