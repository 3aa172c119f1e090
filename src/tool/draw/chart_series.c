/* chart_series.c - lines, marks, circles and rules of a panel, and their samples in the legend.
 *
 * Cairo counts points in 24 bits before the binary point, and a path may go to 1e300.  So lines are cut at
 * the frame here (Liang & Barsky 1984, ACM Trans. Graph. 3, 1), not by cairo.  A circle is a line of many
 * sides, each at most 1/16 point beside it. */
#include "chart_draw.h"

#include "palette.h"

#include <math.h>

static const double LINE_WIDTH = 1.2, THIN_LINE = 0.8, RADIUS = 2.7, TURN = 6.283185307179586;
enum { BATCH = 500, MOST_SIDES = 20000 };

typedef struct chart_point {
    double x, y;
} chart_point;

static chart_point point_of(const chart_place *p, double x, double y)
{
    return (chart_point){p->plot.left + chart_axis_part(&p->x, x) * (p->plot.right - p->plot.left),
                         p->plot.bottom - chart_axis_part(&p->y, y) * (p->plot.bottom - p->plot.top)};
}

/* ------------------------------------------------------------------ lines */

/* Narrows [u[0], u[1]] to where from + u * (to - from) lies in [low, high]. */
static void narrow(double from, double to, double low, double high, double u[2])
{
    double step = to - from;
    if (step == 0) {
        if (from < low || from > high) u[1] = -1;
        return;
    }
    double a = (low - from) / step, b = (high - from) / step;
    u[0] = fmax(u[0], fmin(a, b)), u[1] = fmin(u[1], fmax(a, b));
}

/* Adds the part of a segment inside the frame to the path; goes on from its last point if `joined`.  Returns
 * whether the end of the segment was reached. */
static bool add_segment(cairo_t *cr, const chart_box *frame, chart_point a, chart_point b, bool joined)
{
    double u[2] = {0, 1};
    narrow(a.x, b.x, frame->left, frame->right, u);
    narrow(a.y, b.y, frame->top, frame->bottom, u);
    if (!(u[0] <= u[1])) return false;
    if (!joined || u[0] > 0) cairo_move_to(cr, a.x + u[0] * (b.x - a.x), a.y + u[0] * (b.y - a.y));
    cairo_line_to(cr, a.x + u[1] * (b.x - a.x), a.y + u[1] * (b.y - a.y));
    return u[1] == 1;
}

static void draw_line(cairo_t *cr, const chart_place *p, const chart_series *s)
{
    bool joined = false, before = false;
    chart_point last = {0, 0};
    cairo_new_path(cr);
    for (size_t i = 0; i < s->count; i++) {
        bool there = chart_finite(s->x[i]) && chart_finite(s->y[i]);
        chart_point next = there ? point_of(p, s->x[i], s->y[i]) : last;
        joined = there && before && add_segment(cr, &p->plot, last, next, joined);
        before = there, last = next;
    }
    cairo_set_line_width(cr, LINE_WIDTH);
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

/* Single points are smaller than those on a line. */
static double radius_of(const chart_series *s) { return s->line ? RADIUS : 0.6 * RADIUS; }

/* If colours repeat, marks and dashes go on. */
static chart_mark mark_of(const chart_series *s)
{
    size_t round = s->colour / PALETTE_COLOURS;
    return s->mark == CHART_NO_MARK ? CHART_NO_MARK : (chart_mark)(1 + (s->mark - 1 + round) % CHART_DIAMOND);
}

static void draw_points(cairo_t *cr, const chart_place *p, const chart_series *s)
{
    chart_mark mark = mark_of(s);
    size_t waiting = 0;
    cairo_new_path(cr);
    for (size_t i = 0; i < s->count; i++) {
        if (!chart_finite(s->x[i]) || !chart_finite(s->y[i])) continue;
        chart_point at = point_of(p, s->x[i], s->y[i]);
        if (at.x < p->plot.left - 0.01 || at.x > p->plot.right + 0.01) continue;
        if (at.y < p->plot.top - 0.01 || at.y > p->plot.bottom + 0.01) continue;
        add_mark(cr, mark, radius_of(s), at.x, at.y);
        if (++waiting == BATCH) finish_marks(cr, mark, radius_of(s)), waiting = 0;
    }
    finish_marks(cr, mark, radius_of(s));
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
    chart_point centre = point_of(p, c->x, c->y), last = point_of(p, c->x + c->radius, c->y);
    double across = fabs(last.x - centre.x), up = fabs(point_of(p, c->x, c->y + c->radius).y - centre.y);
    if (!chart_finite(centre.x) || !chart_finite(centre.y) || !chart_finite(across) || !chart_finite(up))
        return;
    /* A side of angle w lies r w^2 / 8 within the circle. */
    double sides = ceil(TURN * sqrt(2 * fmax(across, up))), count = fmin(fmax(sides, 24), MOST_SIDES);
    bool joined = false;
    thin_look(cr, c->dash);
    cairo_new_path(cr);
    for (int i = 1; i <= (int)count; i++) {
        double angle = TURN * i / count;
        chart_point next = {centre.x + across * cos(angle), centre.y - up * sin(angle)};
        joined = add_segment(cr, &p->plot, last, next, joined);
        last = next;
    }
    cairo_stroke(cr);
    palette_dash(cr, 0);
}

void chart_rule_draw(cairo_t *cr, const chart_place *p, const chart_rule *r)
{
    if (!chart_finite(r->at)) return;
    chart_point at = r->upright ? point_of(p, r->at, p->y.low) : point_of(p, p->x.low, r->at);
    chart_point to = r->upright ? (chart_point){at.x, p->plot.top} : (chart_point){p->plot.right, at.y};
    thin_look(cr, r->dash);
    cairo_new_path(cr);
    add_segment(cr, &p->plot, at, to, false);
    cairo_stroke(cr);
    palette_dash(cr, 0);
}

/* ---------------------------------------------------------------- samples */

void chart_series_sample(cairo_t *cr, const chart_series *s, double x, double y, double width)
{
    series_look(cr, s);
    cairo_move_to(cr, x, y), cairo_line_to(cr, x + width, y);
    cairo_set_line_width(cr, LINE_WIDTH);
    if (s->line) cairo_stroke(cr);
    palette_dash(cr, 0);
    cairo_new_path(cr);
    add_mark(cr, mark_of(s), 1.3 * radius_of(s), x + width / 2, y);
    if (s->mark != CHART_NO_MARK) finish_marks(cr, mark_of(s), 1.3 * radius_of(s));
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
