// SPDX-License-Identifier: MIT
/* plot.c - draws error against time, with cairo: a panel for each case.
 *
 * Both axes are logarithmic.  A dot stands at the error that 99 % of the rays stay below; its stem ends at
 * the largest error; an error of 0 stands on the floor.  A filled dot is a best setting.  The stairs show the
 * smallest error that can be had in a given time: by best settings with the default's outputs, no proof, and
 * no more undecided or wrong rays than the default.  They lead from the top edge down, from one dot to the
 * next, and on to the right edge.
 *
 * A setting that is the same as the default, or as another value of its knob, has no dot of its own; its name
 * is added to that of the other.  Dots that would still cover each other are drawn as rings about each other.
 *
 * Each dot has a name.  The places around the dot are tried, nearest first.  The name takes the first place
 * where it covers no other name, dot, stem or edge.  If it stands apart from its dot, a leader in the colour
 * of the dot joins them, and that must cross nothing either. */
#include "trade.h"

#include "../base/memory.h"
#include "../draw/chart_draw.h"
#include "../draw/palette.h"
#include "../draw/sheet.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double PLOT_WIDTH = 1040, MARGIN = 16, PANEL_HIGH = 312, HEAD_HIGH = 44, FOOT_HIGH = 46,
                    LEFT = 70, GAP = 26;
static const double FONT = 10.5, DOT = 4, RING = 3.4, FLOOR = 26, STEM = 3, LINE = 12.5, KEY_HIGH = 132;
static const char *const knob_name[KNOBS] = {"default", "single ray", "outputs", "t_tol",     "max_evals",
                                             "pick",    "proof",      "dt_min",  "iterations", "floats"};
static const size_t knob_colour[KNOBS] = {4, 5, 3, 0, 1, 4, 6, 2, 6, 2};

typedef struct plot_stroke { double x0, y0, x1, y1; } plot_stroke;

/* A dot; of: its setting, the first of those that are the same. */
typedef struct plot_dot { double x, y, radius; const setting *of; bool best; } plot_dot;

typedef struct panel {
    cairo_t *cr;
    const trade_case *c;
    chart_box plot;
    double x_low, x_high, y_low, y_high;  /* ends of the axes, as log10 */
    bool floor;                           /* is there an error of 0? */
    const setting **stands_for;           /* [settings]: whose dot it has; NULL: it has no error */
    plot_dot *dot;
    size_t dots;
    chart_box *taken;                           /* where names, dots, stems and stairs are */
    size_t taken_count, taken_capacity;
    chart_box *name;                            /* where names are */
    size_t names, name_capacity;
    plot_stroke *leader;
    size_t leaders, leader_capacity;
} panel;

static bool plot_shown(const setting *s) { return s->error_99 >= 0; }

static double x_of(const panel *p, double ns)
{
    return p->plot.left + (log10(ns) - p->x_low) / (p->x_high - p->x_low) * (p->plot.right - p->plot.left);
}

static double y_of(const panel *p, double error)
{
    double bottom = p->plot.bottom - (p->floor ? FLOOR : 0);
    if (error == 0) return p->plot.bottom - FLOOR / 2;
    return bottom - (log10(error) - p->y_low) / (p->y_high - p->y_low) * (bottom - p->plot.top);
}

static panel panel_of(cairo_t *cr, const trade_case *c, double left, double top, double width)
{
    panel p = {
        .cr = cr, .c = c, .plot = {left + LEFT, top + HEAD_HIGH, left + width, top + PANEL_HIGH - FOOT_HIGH}};
    double x[2] = {HUGE_VAL, -HUGE_VAL}, y[2] = {HUGE_VAL, -HUGE_VAL};
    for (size_t i = 0; i < c->settings; i++) {
        const setting *s = &c->setting[i];
        if (!plot_shown(s)) continue;
        x[0] = fmin(x[0], log10(s->ns)), x[1] = fmax(x[1], log10(s->ns));
        if (s->error_99 > 0) y[0] = fmin(y[0], log10(s->error_99));
        if (s->error_worst > 0) y[1] = fmax(y[1], log10(s->error_worst));
        p.floor = p.floor || s->error_99 == 0;
    }
    if (!(x[0] <= x[1])) x[0] = 0, x[1] = 1;
    if (!(y[0] <= y[1])) y[0] = -16, y[1] = -15;
    double middle = (x[0] + x[1]) / 2, half = fmax(x[1] - x[0], 0.6) / 2 + 0.12;
    p.x_low = middle - 1.2 * half, p.x_high = middle + 1.3 * half; /* with room for names on all sides */
    p.y_low = floor(y[0] - 0.15 - 0.22 * (y[1] - y[0])), p.y_high = ceil(y[1] + 0.3);
    return p;
}

static void line(cairo_t *cr, double x0, double y0, double x1, double y1, double width)
{
    cairo_move_to(cr, x0, y0);
    cairo_line_to(cr, x1, y1);
    cairo_set_line_width(cr, width);
    cairo_stroke(cr);
}

/* ------------------------------------------------------------------- axes */

static void time_axis(const panel *p)
{
    static const double step[] = {1, 2, 5, 1.5, 3, 7}; /* the second half only for a short axis */
    int steps = p->x_high - p->x_low < 1.1 ? 6 : 3;
    cairo_t *cr = p->cr;
    for (int decade = (int)floor(p->x_low); decade <= (int)p->x_high + 1; decade++)
        for (int i = 0; i < steps; i++) {
            double ns = step[i] * pow(10, decade), x = x_of(p, ns);
            if (x < p->plot.left || x > p->plot.right) continue;
            char text[40];
            snprintf(text, sizeof text, "%g", ns);
            chart_grey(cr, 0.9);
            line(cr, x, p->plot.top, x, p->plot.bottom, 0.6);
            chart_grey(cr, 0.25);
            chart_text(cr, x, p->plot.bottom + 14, 0.5, HUGE_VAL, text);
        }
    chart_text(cr, (p->plot.left + p->plot.right) / 2, p->plot.bottom + 31, 0.5, HUGE_VAL,
               "time per ray (ns)");
}

/* Written upward, beside the numbers. */
static void error_label(const panel *p)
{
    cairo_t *cr = p->cr;
    char text[80];
    if (p->c->lens)
        snprintf(text, sizeof text, "error of the last point (%.20s)",
                 *p->c->lens->units ? p->c->lens->units : "lengths of the lens");
    else
        snprintf(text, sizeof text, "error of t (lengths of the direction)");
    chart_text_up(cr, p->plot.left - LEFT + 16, (p->plot.top + p->plot.bottom) / 2,
                  p->plot.bottom - p->plot.top,
                  text);
}

static void error_axis(const panel *p)
{
    cairo_t *cr = p->cr;
    int every = p->y_high - p->y_low > 8 ? 2 : 1;
    for (int decade = (int)p->y_low; decade <= (int)p->y_high; decade++) {
        double y = y_of(p, pow(10, decade));
        chart_grey(cr, 0.9);
        line(cr, p->plot.left, y, p->plot.right, y, 0.6);
        if ((decade - (int)p->y_high) % every) continue;
        char text[40];
        snprintf(text, sizeof text, "1e%d", decade);
        chart_grey(cr, 0.25);
        chart_text(cr, p->plot.left - 6, y + 4, 1, HUGE_VAL, text);
    }
    chart_grey(cr, 0.25);
    if (p->floor) chart_text(cr, p->plot.left - 6, p->plot.bottom - FLOOR / 2 + 4, 1, HUGE_VAL, "0");
    error_label(p);
    cairo_rectangle(cr, p->plot.left, p->plot.top, p->plot.right - p->plot.left,
                    p->plot.bottom - p->plot.top);
    cairo_set_line_width(cr, 0.8);
    cairo_stroke(cr);
}

/* ------------------------------------------------------------------- dots */

static void plot_take(panel *p, chart_box b)
{
    p->taken = memory_room(p->taken, p->taken_count, &p->taken_capacity, sizeof *p->taken);
    p->taken[p->taken_count++] = b;
}

static bool changes_nothing(const setting *s) { return strstr(s->effect, "nothing") != NULL; }

static const setting *shared_dot(const panel *p, size_t i)
{
    const setting *s = &p->c->setting[i], *base = measure_base(p->c);
    if (!plot_shown(s)) return NULL;
    if (base && plot_shown(base) && changes_nothing(s)) return base;
    for (size_t k = 0; k < i; k++) {
        const setting *other = p->stands_for[k];
        if (other == &p->c->setting[k] && other != base && other->turned == s->turned &&
            other->outputs == s->outputs && measure_same(other, s))
            return other;
    }
    return s;
}

/* Of dots that would cover each other, later ones become rings about the earlier. */
static void find_dots(panel *p)
{
    const trade_case *c = p->c;
    p->stands_for = memory_take(c->settings, sizeof *p->stands_for);
    p->dot = memory_take(c->settings, sizeof *p->dot);
    for (size_t i = 0; i < c->settings; i++) {
        const setting *s = &c->setting[i];
        p->stands_for[i] = shared_dot(p, i);
        if (p->stands_for[i] != s) continue;
        plot_dot d = {.x = x_of(p, s->ns), .y = y_of(p, s->error_99), .radius = DOT, .of = s};
        for (size_t k = 0; k < p->dots; k++) {
            const plot_dot *o = &p->dot[k];
            if (hypot(o->x - d.x, o->y - d.y) < o->radius + DOT) d.radius = fmax(d.radius, o->radius + RING);
        }
        p->dot[p->dots++] = d;
    }
    for (size_t i = 0; i < c->settings; i++)
        for (size_t k = 0; k < p->dots; k++)
            if (p->stands_for[i] == p->dot[k].of && c->setting[i].best) p->dot[k].best = true;
}

static void colour_of(cairo_t *cr, knob turned)
{
    palette_set(cr, knob_colour[turned]);
    if (turned == KNOB_NONE) chart_grey(cr, 0);
    /* there is no eighth colour in the palette */
    if (turned == KNOB_ITERATIONS) cairo_set_source_rgb(cr, 0.45, 0.3, 0.15);
}

/* On a white disk, so that lines under the dot end there. */
static void draw_dot(cairo_t *cr, double x, double y, double radius, knob turned, bool best)
{
    cairo_new_path(cr);
    cairo_arc(cr, x, y, radius + 1, 0, 8 * atan(1));
    chart_grey(cr, 1);
    cairo_fill(cr);
    cairo_arc(cr, x, y, radius, 0, 8 * atan(1));
    colour_of(cr, turned);
    cairo_set_line_width(cr, 1.3);
    if (best) cairo_fill_preserve(cr);
    cairo_stroke(cr);
}

static void draw_stem(panel *p, const plot_dot *d)
{
    double top = d->of->error_worst > 0 ? y_of(p, d->of->error_worst) : d->y;
    if (d->y - top < DOT) return;
    chart_grey(p->cr, 0.55);
    line(p->cr, d->x, d->y, d->x, top, 0.7);
    line(p->cr, d->x - 2.5, top, d->x + 2.5, top, 0.7);
    plot_take(p, (chart_box){d->x - 1, top, d->x + 1, d->y});
}

static int by_time(const void *a, const void *b)
{
    const plot_dot *const *x = a, *const *y = b;
    return ((*x)->x > (*y)->x) - ((*x)->x < (*y)->x);
}

static int by_size(const void *a, const void *b)
{
    const plot_dot *const *x = a, *const *y = b;
    return ((*x)->radius < (*y)->radius) - ((*x)->radius > (*y)->radius);
}

static const plot_dot **dots_sorted(const panel *p, int (*order)(const void *, const void *))
{
    const plot_dot **list = memory_take(p->dots, sizeof *list);
    for (size_t i = 0; i < p->dots; i++) list[i] = &p->dot[i];
    qsort(list, p->dots, sizeof *list, order);
    return list;
}

static void stair(panel *p, double x0, double y0, double x1, double y1)
{
    line(p->cr, x0, y0, x1, y1, 1.8);
    plot_take(p, (chart_box){fmin(x0, x1) - 1, fmin(y0, y1) - 1, fmax(x0, x1) + 1, fmax(y0, y1) + 1});
}

static void draw_stairs(panel *p)
{
    const plot_dot **step = dots_sorted(p, by_time);
    const setting *base = measure_base(p->c);
    double x = 0, y = p->plot.top;
    bool begun = false;
    chart_grey(p->cr, 0.62);
    cairo_set_line_cap(p->cr, CAIRO_LINE_CAP_SQUARE);
    for (size_t i = 0; i < p->dots; i++) {
        const setting *s = step[i]->of;
        bool own_model = s->turned == KNOB_ITERATIONS; /* all of these are less certain than the largest N */
        if (!step[i]->best || !base || s->outputs != base->outputs || s->options.proof != base->options.proof)
            continue;
        if (!own_model && (s->undecided > base->undecided || s->wrong > base->wrong)) continue;
        if (begun && step[i]->y <= y) continue;
        if (begun) stair(p, x, y, step[i]->x, y);
        stair(p, step[i]->x, y, step[i]->x, step[i]->y);
        x = step[i]->x, y = step[i]->y, begun = true;
    }
    if (begun) stair(p, x, y, p->plot.right, y);
    cairo_set_line_cap(p->cr, CAIRO_LINE_CAP_BUTT);
}

/* ------------------------------------------------------------------ names */

enum { TEXT_SIZE = 160, LINES = 8, LONG_LINE = 30 };

static void plot_append(char text[TEXT_SIZE], const char *more)
{
    size_t length = strlen(text);
    snprintf(text + length, TEXT_SIZE - length, "%s", more);
}

typedef struct name { const plot_dot *of; int lines; char line[LINES][TEXT_SIZE]; } name;

/* Adds the lines "20 % undecided" and "0.1 % wrong". */
static void add_shares(name *n, const setting *s, size_t rays)
{
    const struct {
        size_t n;
        const char *what;
    } share[2] = {{s->undecided, "undecided"}, {s->wrong, "wrong"}};
    for (int i = 0; i < 2; i++) {
        if (!share[i].n || n->lines == LINES) continue;
        double percent = 100.0 * (double)share[i].n / (double)rays;
        snprintf(n->line[n->lines++], TEXT_SIZE, "%.*g %% %s", percent < 99 ? 2 : 3, percent, share[i].what);
    }
}

/* Appends a word, in the same line or a new one. */
static void add_word(name *n, const char *before, const char *word)
{
    char *last = n->line[n->lines - 1];
    if (strlen(last) + strlen(word) > LONG_LINE && n->lines < LINES) {
        plot_append(last, *before == ',' ? "," : "");
        last = n->line[n->lines++];
        before = "";
    }
    plot_append(last, before);
    plot_append(last, word);
}

/* Adds what is the same as this setting, in lines of their own: "= t_tol, pick, out=t".  If all values of a
 * knob are, only the knob is named. */
static void name_same(name *n, const panel *p)
{
    const char *before = "= ";
    for (int k = KNOB_NONE + 1; k < KNOBS; k++) {
        size_t all = 0, same = 0;
        for (size_t i = 0; i < p->c->settings; i++) {
            const setting *s = &p->c->setting[i];
            if (s->turned != (knob)k || s == n->of->of) continue;
            all++;
            same += p->stands_for[i] == n->of->of;
        }
        for (size_t i = 0; i < p->c->settings && same; i++) {
            const setting *s = &p->c->setting[i];
            if (s->turned != (knob)k || s == n->of->of || p->stands_for[i] != n->of->of) continue;
            if (*before == '=' && n->lines < LINES) n->lines++;
            bool whole = same == all;
            add_word(n, before, whole ? trade_knob_name[k] : s->name);
            before = ", ";
            if (whole) break;
        }
    }
}

static name name_of(const panel *p, const plot_dot *d)
{
    name n = {.of = d, .lines = 1};
    plot_append(n.line[0], d->of->name);
    if (d->of == measure_base(p->c)) {
        add_shares(&n, d->of, p->c->rays);
        name_same(&n, p);
        return n;
    }
    for (size_t i = 0; i < p->c->settings; i++) {
        const char *value = strchr(p->c->setting[i].name, '=');
        if (p->stands_for[i] == d->of && &p->c->setting[i] != d->of)
            add_word(&n, ", ", value ? value + 1 : p->c->setting[i].name);
    }
    add_shares(&n, d->of, p->c->rays);
    return n;
}

static bool plot_enters(const plot_stroke *s, const chart_box *b)
{
    return chart_line_enters(s->x0, s->y0, s->x1, s->y1, b);
}

static double side(const plot_stroke *s, double x, double y)
{
    return (s->x1 - s->x0) * (y - s->y0) - (s->y1 - s->y0) * (x - s->x0);
}

static bool cross(const plot_stroke *a, const plot_stroke *b)
{
    return side(a, b->x0, b->y0) * side(a, b->x1, b->y1) <= 0 &&
           side(b, a->x0, a->y0) * side(b, a->x1, a->y1) <= 0;
}

/* What a name must not cover.  Each is tried if there is no place by the one before:
 * ALL: anything.  LEADERS: stems and stairs may be covered.  DOTS: leaders too, and its own leader need only
 * avoid dots.  NAMES: the same, and its own leader need avoid nothing. */
typedef enum respect { RESPECT_ALL, RESPECT_LEADERS, RESPECT_DOTS, RESPECT_NAMES, RESPECTS } respect;

static bool thin(const chart_box *b) { return fmin(b->right - b->left, b->bottom - b->top) < STEM; }

static bool free_place(const panel *p, chart_box b, respect of)
{
    if (b.left < p->plot.left + 2 || b.right > p->plot.right - 2 || b.top < p->plot.top + 1 ||
        b.bottom > p->plot.bottom - 1)
        return false;
    for (size_t i = 0; i < p->taken_count; i++)
        if (!(of != RESPECT_ALL && thin(&p->taken[i])) && chart_boxes_meet(&b, &p->taken[i])) return false;
    for (size_t i = 0; i < p->leaders && of < RESPECT_DOTS; i++)
        if (plot_enters(&p->leader[i], &b)) return false;
    return true;
}

/* The leader: from the edge of the dot to the nearest place of the name. */
static plot_stroke leader_to(const plot_dot *d, const chart_box *b)
{
    double x = fmin(fmax(d->x, b->left), b->right), y = fmin(fmax(d->y, b->top), b->bottom),
           length = fmax(hypot(x - d->x, y - d->y), 1);
    return (plot_stroke){d->x + d->radius * (x - d->x) / length, d->y + d->radius * (y - d->y) / length, x,
                         y};
}

static bool hits(const plot_stroke *s, const plot_dot *d)
{
    return plot_enters(s, &(chart_box){d->x - d->radius, d->y - d->radius, d->x + d->radius,
                       d->y + d->radius});
}

/* May a leader be there?  It may cross stems and stairs and the rings about its own dot, but no other dot, no
 * name and no other leader. */
static bool free_leader(const panel *p, const plot_stroke *s, const plot_dot *of, respect respected)
{
    for (size_t i = 0; i < p->dots && respected <= RESPECT_DOTS; i++)
        if (hypot(p->dot[i].x - of->x, p->dot[i].y - of->y) > p->dot[i].radius + of->radius &&
            hits(s, &p->dot[i]))
            return false;
    if (respected >= RESPECT_DOTS) return true;
    for (size_t i = 0; i < p->leaders; i++)
        if (cross(s, &p->leader[i])) return false;
    for (size_t i = 0; i < p->names; i++)
        if (plot_enters(s, &p->name[i])) return false;
    return true;
}

static double off(const plot_dot *d, const chart_box *b)
{
    double x = fmin(fmax(d->x, b->left), b->right), y = fmin(fmax(d->y, b->top), b->bottom);
    return hypot(x - d->x, y - d->y) - d->radius;
}

/* Is it clear whose name it is?  No other dot may be nearer to the place than its own. */
static bool clear_whose(const panel *p, const chart_box *b, const plot_dot *of)
{
    const double NEXT = 10;
    double own = fmin(off(of, b), NEXT);
    for (size_t i = 0; i < p->dots; i++)
        if (&p->dot[i] != of && off(&p->dot[i], b) < own) return false;
    return true;
}

/* Tries places on circles about the dot; the name touches the circle from outside. */
static bool find_place(const panel *p, const name *n, double wide, double high, respect of, bool *led,
                       chart_box *b)
{
    enum { WAYS = 32 };
    const double near = n->of->radius + 4;
    for (double d = near; d < 300; d += 5)
        for (int k = 0; k < WAYS; k++) {
            int turn = k % 2 ? (k + 1) / 2 : -k / 2; /* right first, left last */
            double x = cos(turn * 8 * atan(1) / WAYS), y = sin(turn * 8 * atan(1) / WAYS);
            double left = n->of->x + d * x - wide * (1 - x) / 2, top = n->of->y + d * y - high * (1 - y) / 2;
            *led = d > near;
            *b = (chart_box){left - 2, top - 1, left + wide + 2, top + high + 1};
            plot_stroke leader = leader_to(n->of, b);
            if (of < RESPECT_DOTS && !clear_whose(p, b, n->of)) continue;
            if (free_place(p, *b, of) && (!*led || free_leader(p, &leader, n->of, of))) return true;
        }
    return false;
}

static void place_name(panel *p, const name *n)
{
    cairo_t *cr = p->cr;
    double wide = 0, high = n->lines * LINE;
    bool found = false, led = false;
    chart_box b;
    for (int i = 0; i < n->lines; i++) wide = fmax(wide, chart_width(cr, n->line[i]));
    for (int of = RESPECT_ALL; of < RESPECTS && !found; of++)
        found = find_place(p, n, wide, high, (respect)of, &led, &b);
    if (!found) return; /* every place covers something, or the name is wider than the panel: leave it out */
    if (led) {
        plot_stroke s = leader_to(n->of, &b);
        colour_of(cr, n->of->of->turned);
        line(cr, s.x0, s.y0, s.x1, s.y1, 0.8);
        p->leader = memory_room(p->leader, p->leaders, &p->leader_capacity, sizeof *p->leader);
        p->leader[p->leaders++] = s;
    }
    plot_take(p, b);
    p->name = memory_room(p->name, p->names, &p->name_capacity, sizeof *p->name);
    p->name[p->names++] = b;
    cairo_set_source_rgba(cr, 1, 1, 1, 0.8);
    cairo_rectangle(cr, b.left, b.top, b.right - b.left, b.bottom - b.top);
    cairo_fill(cr);
    for (int i = 0; i < n->lines; i++) {
        bool same = strncmp(n->line[i], "= ", 2) == 0 || (i > 1 && n->of->of == measure_base(p->c));
        chart_grey(cr, n->of->best && !same ? 0 : 0.4);
        chart_text(cr, b.left + 2, b.top + 1 + (i + 0.8) * LINE, 0, HUGE_VAL, n->line[i]);
    }
}

static void draw_panel(panel *p)
{
    cairo_t *cr = p->cr;
    chart_font(cr, 13, true);
    chart_grey(cr, 0);
    chart_text(cr, p->plot.left, p->plot.top - 24, 0, p->plot.right - p->plot.left, p->c->name);
    chart_font(cr, FONT, false);
    chart_grey(cr, 0.35);
    chart_text(cr, p->plot.left, p->plot.top - 8, 0, p->plot.right - p->plot.left, p->c->about);
    time_axis(p);
    error_axis(p);
    find_dots(p);
    if (p->dots == 0)
        chart_text(cr, (p->plot.left + p->plot.right) / 2, (p->plot.top + p->plot.bottom) / 2, 0.5, HUGE_VAL,
                   "no ray is met");
    draw_stairs(p);
    for (size_t i = 0; i < p->dots; i++) draw_stem(p, &p->dot[i]);
    const plot_dot **order = dots_sorted(p, by_size);
    for (size_t i = 0; i < p->dots; i++) {
        const plot_dot *d = order[i];
        draw_dot(cr, d->x, d->y, d->radius, d->of->turned, d->best);
        plot_take(p, (chart_box){d->x - d->radius, d->y - d->radius, d->x + d->radius, d->y + d->radius});
    }
    for (size_t i = 0; i < p->dots; i++) {
        name n = name_of(p, &p->dot[i]);
        place_name(p, &n);
    }
}

/* ------------------------------------------------------------------- page */

static void draw_key(cairo_t *cr, const trade *t, double left, double right, double y)
{
    static const char *const words[] = {
        "A dot: 99 % of the rays have a smaller error.  Its stem ends at the largest error.",
        "A filled dot is a best setting: none with as many outputs and as much proven beats it.",
        "A ring around a dot is another setting at nearly the same place.",
        "= SETTING: the same in time and error, as far as repeated runs can tell.",
        ("The grey stairs: the smallest error to be had in a given time, by filled dots with the default's "
         "outputs, no proof, and no more undecided or wrong rays."),
    };
    double x = left;
    bool used[KNOBS] = {false};
    for (size_t i = 0; i < t->count; i++)
        for (size_t k = 0; k < t->list[i].settings; k++)
            if (plot_shown(&t->list[i].setting[k])) used[t->list[i].setting[k].turned] = true;
    chart_font(cr, FONT, false);
    for (int k = 0; k < KNOBS; k++) {
        if (!used[k]) continue;
        double wide = 9 + chart_width(cr, knob_name[k]) + 16;
        if (x + wide > right) x = left, y += LINE + 4;
        draw_dot(cr, x + DOT, y - 3.5, DOT, (knob)k, true);
        chart_grey(cr, 0.2);
        chart_text(cr, x + 12, y, 0, HUGE_VAL, knob_name[k]);
        x += wide;
    }
    chart_grey(cr, 0.35);
    y += 20;
    for (size_t i = 0; i < sizeof words / sizeof words[0]; i++)
        y += (double)chart_wrap(cr, left, y, right - left, LINE + 2, words[i], true) * (LINE + 2);
}

/* Two panels stand side by side; the key is in the free place, or below. */
typedef struct plot_sheet { const trade *trade; int columns, rows; bool gap; double width, page; } plot_sheet;

static void draw_plot(cairo_t *cr, const void *what)
{
    const plot_sheet *s = what;
    for (size_t i = 0; i < s->trade->count; i++) {
        const size_t beside = i % (size_t)s->columns, below = i / (size_t)s->columns;
        panel p = panel_of(cr, &s->trade->list[i], MARGIN + (double)beside * (s->width + GAP),
                           (double)below * PANEL_HIGH, s->width);
        draw_panel(&p);
    }
    draw_key(cr, s->trade, MARGIN + LEFT + (s->gap ? s->width + GAP : 0), s->page - MARGIN,
             s->gap ? (s->rows - 1) * PANEL_HIGH + HEAD_HIGH + 12 : s->rows * PANEL_HIGH + 18);
}

void trade_picture(const char *file, const trade *t)
{
    plot_sheet s = {.trade = t, .columns = t->count > 1 ? 2 : 1};
    s.rows = ((int)t->count + s.columns - 1) / s.columns, s.gap = s.columns == 2 && t->count % 2;
    s.width = (s.columns == 2 ? 1 : 1.4) * (PLOT_WIDTH - 2 * MARGIN - GAP) / 2;
    s.page = s.columns * s.width + (s.columns - 1) * GAP + 2 * MARGIN;
    sheet_write(file, picture_kind_of("picture", file), s.page,
                s.rows * PANEL_HIGH + (s.gap ? 0 : KEY_HIGH) + MARGIN, draw_plot, &s);
}
