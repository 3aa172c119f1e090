// SPDX-License-Identifier: MIT
/* chart_series.c - lines, marks, circles and rules of a panel, and their samples in the legend.
 *
 * The axes take in every number that can be drawn (chart_place_of), so nothing has to be cut at the frame. */
#include "chart_draw.h"

#include "palette.h"

#include <math.h>

/* The line is cut at each edge in turn (Liang and Barsky 1984, ACM TOG 3, 1). */
bool chart_line_enters(double x0, double y0, double x1, double y1, const chart_box *b)
{
    double from = 0, to = 1, dx = x1 - x0, dy = y1 - y0;
    const double way[4] = {-dx, dx, -dy, dy},
                 room[4] = {x0 - b->left, b->right - x0, y0 - b->top, b->bottom - y0};
    for (int i = 0; i < 4; i++) {
        if (way[i] == 0 && room[i] <= 0) return false;
        if (way[i] < 0) from = fmax(from, room[i] / way[i]);
        if (way[i] > 0) to = fmin(to, room[i] / way[i]);
    }
    return from < to;
}

static const double LINE_WIDTH = 1.2, THIN_LINE = 0.8, RADIUS = 2.7, SMALL = 1.6, SMALLER = 1,
                    FULL_SIZE = 240, TURN = 6.283185307179586,
                    SMALLEST_CIRCLE = 0.01; /* cairo refuses a scale of 0 */
enum { BATCH = 500, MANY = 1000 };

typedef struct chart_point { double x, y; } chart_point;

static chart_point point_of(const chart_place *p, double x, double y)
{
    return (chart_point){p->plot.left + chart_axis_part(&p->x, x) * (p->plot.right - p->plot.left),
                         p->plot.bottom - chart_axis_part(&p->y, y) * (p->plot.bottom - p->plot.top)};
}

/* ------------------------------------------------------------------ lines */

static bool point_there(const chart_series *s, size_t i)
{
    return i < s->count && chart_finite(s->x[i]) && chart_finite(s->y[i]);
}

/* A point without a mark between two gaps is drawn as a dot as wide as the line. */
static void draw_line(cairo_t *cr, const chart_place *p, const chart_series *s)
{
    bool before = false;
    cairo_new_path(cr);
    cairo_set_line_width(cr, LINE_WIDTH);
    for (size_t i = 0; i < s->count; i++) {
        bool there = point_there(s, i);
        chart_point at = there ? point_of(p, s->x[i], s->y[i]) : (chart_point){0, 0};
        if (there && before)
            cairo_line_to(cr, at.x, at.y);
        else if (there && point_there(s, i + 1))
            cairo_move_to(cr, at.x, at.y);
        else if (there && s->mark == CHART_NO_MARK)
            cairo_stroke(cr), cairo_arc(cr, at.x, at.y, LINE_WIDTH / 2, 0, TURN), cairo_fill(cr);
        before = there;
    }
    cairo_stroke(cr);
}

/* ------------------------------------------------------------------ marks */

static void polygon(cairo_t *cr, double x, double y, double radius, int corners, double turned)
{
    for (int i = 0; i < corners; i++) {
        double angle = TURN * (i + turned) / corners;
        cairo_line_to(cr, x + radius * sin(angle), y - radius * cos(angle));
    }
    cairo_close_path(cr);
}

static void add_mark(cairo_t *cr, chart_mark mark, double r, double x, double y)
{
    cairo_new_sub_path(cr);
    switch (mark) {
    case CHART_NO_MARK:
        break;
    case CHART_DOT:
        cairo_move_to(cr, x, y), cairo_line_to(cr, x, y);
        break; /* by the round caps of the line */
    case CHART_PLUS:
        cairo_move_to(cr, x - r, y), cairo_line_to(cr, x + r, y);
        cairo_move_to(cr, x, y - r), cairo_line_to(cr, x, y + r);
        break;
    case CHART_CROSS:
        r *= 0.8;
        cairo_move_to(cr, x - r, y - r), cairo_line_to(cr, x + r, y + r);
        cairo_move_to(cr, x - r, y + r), cairo_line_to(cr, x + r, y - r);
        break;
    case CHART_TRIANGLE:
        polygon(cr, x, y, 1.2 * r, 3, 0);
        break;
    case CHART_SQUARE:
        polygon(cr, x, y, 1.2 * r, 4, 0.5);
        break;
    case CHART_RING:
        cairo_arc(cr, x, y, r, 0, TURN);
        break;
    case CHART_DIAMOND:
        polygon(cr, x, y, 1.2 * r, 4, 0);
        break;
    }
}

/* Draws the marks that were added. */
static void finish_marks(cairo_t *cr, chart_mark mark, double r)
{
    bool filled = mark == CHART_TRIANGLE || mark == CHART_SQUARE || mark == CHART_DIAMOND;
    cairo_set_line_cap(cr, CAIRO_LINE_CAP_ROUND);
    cairo_set_line_width(cr, mark == CHART_DOT ? 1.2 * r : 0.3 * r + 0.2);
    if (filled)
        cairo_fill(cr);
    else
        cairo_stroke(cr);
    cairo_set_line_cap(cr, CAIRO_LINE_CAP_BUTT);
}

/* Single points are smaller than those on a line, still smaller if there are many, and on small plots. */
static double radius_on(const chart_place *p, const chart_series *s)
{
    double part = fmin(fmax((p->plot.right - p->plot.left) / FULL_SIZE, 0.6), 1);
    return s->line ? RADIUS : part * (s->count > MANY ? SMALLER : SMALL);
}

/* If colours repeat, marks and dashes go on. */
static chart_mark mark_of(const chart_series *s)
{
    size_t round = s->colour / PALETTE_COLOURS;
    return s->mark == CHART_NO_MARK ? CHART_NO_MARK : (chart_mark)(1 + (s->mark - 1 + round) % CHART_DIAMOND);
}

static void draw_points(cairo_t *cr, const chart_place *p, const chart_series *s)
{
    chart_mark mark = mark_of(s);
    double radius = radius_on(p, s);
    size_t waiting = 0;
    cairo_new_path(cr);
    for (size_t i = 0; i < s->count; i++) {
        if (!point_there(s, i)) continue;
        chart_point at = point_of(p, s->x[i], s->y[i]);
        add_mark(cr, mark, radius, at.x, at.y);
        if (++waiting == BATCH) finish_marks(cr, mark, radius), waiting = 0;
    }
    finish_marks(cr, mark, radius);
}

static void series_look(cairo_t *cr, const chart_series *s)
{
    palette_set(cr, s->colour);
    palette_dash(cr, s->line ? s->dash + s->colour / PALETTE_COLOURS : 0);
}

void chart_series_draw(cairo_t *cr, const chart_place *p, const chart_series *s)
{
    series_look(cr, s);
    if (s->line) draw_line(cr, p, s);
    palette_dash(cr, 0);
    if (s->mark != CHART_NO_MARK) draw_points(cr, p, s);
}

/* -------------------------------------------------------- circles and rules */

static void thin_look(cairo_t *cr, chart_dash dash)
{
    chart_grey(cr, 0.2);
    palette_dash(cr, dash);
    cairo_set_line_width(cr, THIN_LINE);
}

void chart_circle_draw(cairo_t *cr, const chart_place *p, const chart_circle *c)
{
    if (!chart_circle_there(c)) return;
    chart_point centre = point_of(p, c->x, c->y), corner = point_of(p, c->x + c->radius, c->y + c->radius);
    thin_look(cr, c->dash);
    cairo_save(cr);
    cairo_translate(cr, centre.x, centre.y);
    cairo_scale(cr, fmax(corner.x - centre.x, SMALLEST_CIRCLE), fmax(centre.y - corner.y, SMALLEST_CIRCLE));
    cairo_new_path(cr);
    cairo_arc(cr, 0, 0, 1, 0, TURN);
    cairo_restore(cr);
    cairo_stroke(cr);
    palette_dash(cr, 0);
}

void chart_rule_draw(cairo_t *cr, const chart_place *p, const chart_rule *r)
{
    if (!chart_finite(r->at)) return;
    chart_point at = r->upright ? point_of(p, r->at, p->y.low) : point_of(p, p->x.low, r->at);
    thin_look(cr, r->dash);
    cairo_move_to(cr, at.x, at.y);
    cairo_line_to(cr, r->upright ? at.x : p->plot.right, r->upright ? p->plot.top : at.y);
    cairo_stroke(cr);
    palette_dash(cr, 0);
}

/* ---------------------------------------------------------------- samples */

void chart_series_sample(cairo_t *cr, const chart_series *s, double x, double y, double width)
{
    double radius = s->line ? 1.3 * RADIUS : 1.3 * SMALL;
    series_look(cr, s);
    cairo_move_to(cr, x, y), cairo_line_to(cr, x + width, y);
    cairo_set_line_width(cr, LINE_WIDTH);
    if (s->line) cairo_stroke(cr);
    palette_dash(cr, 0);
    cairo_new_path(cr);
    add_mark(cr, mark_of(s), radius, x + width / 2, y);
    if (s->mark != CHART_NO_MARK) finish_marks(cr, mark_of(s), radius);
    cairo_new_path(cr);
}

void chart_circle_sample(cairo_t *cr, const chart_circle *c, double x, double y, double width)
{
    thin_look(cr, c->dash);
    cairo_new_path(cr);
    cairo_arc(cr, x + width / 2, y, 5, 0, TURN);
    cairo_stroke(cr);
    palette_dash(cr, 0);
}

void chart_rule_sample(cairo_t *cr, const chart_rule *r, double x, double y, double width)
{
    double half = r->upright ? 0 : width / 2, high = r->upright ? 6 : 0;
    thin_look(cr, r->dash);
    cairo_move_to(cr, x + width / 2 - half, y + high), cairo_line_to(cr, x + width / 2 + half, y - high);
    cairo_stroke(cr);
    palette_dash(cr, 0);
}
