/* trade_plot.c - error against time, a panel a case, with cairo.
 *
 * Both axes are logarithmic.  A dot is at the error that 99 % of the rays keep below, its stem ends at the
 * worst; an error of 0 stands on the floor.  Full dots are those that nothing beats, and a line of
 * stairs joins the ones of them with the default's outputs that leave no more undecided or wrong.  Each dot
 * is named, dots that cover each other together: of the places around it, nearest first, the first takes the
 * name where it covers no other name, dot, stem or edge; a name that has to stand off is tied to its dot. */
#include "trade.h"

#include "legend.h"
#include "memory.h"

#include <cairo-svg.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double WIDTH = 1040, MARGIN = 16, PANEL_HIGH = 300, HEAD_HIGH = 44, FOOT_HIGH = 40, LEFT = 62, GAP = 26;
static const double FONT = 10.5, DOT = 4, FLOOR = 26, STEM = 3, LINE = 12.5, KEY_HIGH = 76;
static const char *const knob_name[KNOBS] = {"default", "single ray", "outputs", "t_tol", "max_evals", "pick", "proof", "dt_min", "iterations"};
static const size_t knob_colour[KNOBS] = {4, 2, 6, 0, 5, 4, 3, 1, 3};

void trade_picture_check(void) {}

typedef struct box { double left, top, right, bottom; } box;

typedef struct panel {
    cairo_t *cr;
    const trade_case *c;
    box plot;
    double x_low, x_high, y_low, y_high;  /* decades */
    bool floor;                           /* is there an error of 0? */
    box *taken;                           /* names and dots so far */
    size_t taken_count, taken_capacity;
} panel;

static bool shown(const setting *s) { return s->error_99 >= 0; }

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
    panel p = {.cr = cr, .c = c, .plot = {left + LEFT, top + HEAD_HIGH, left + width, top + PANEL_HIGH - FOOT_HIGH}};
    double x[2] = {HUGE_VAL, -HUGE_VAL}, y[2] = {HUGE_VAL, -HUGE_VAL};
    for (size_t i = 0; i < c->settings; i++) {
        const setting *s = &c->setting[i];
        if (!shown(s)) continue;
        x[0] = fmin(x[0], log10(s->ns)), x[1] = fmax(x[1], log10(s->ns));
        if (s->error_99 > 0) y[0] = fmin(y[0], log10(s->error_99));
        if (s->error_worst > 0) y[1] = fmax(y[1], log10(s->error_worst));
        p.floor = p.floor || s->error_99 == 0;
    }
    if (!(x[0] <= x[1])) x[0] = 0, x[1] = 1;
    if (!(y[0] <= y[1])) y[0] = -16, y[1] = -15;
    double middle = (x[0] + x[1]) / 2, half = fmax(x[1] - x[0], 0.6) / 2 + 0.12;
    p.x_low = middle - half, p.x_high = middle + 1.3 * half; /* names stand at the right, most of them */
    p.y_low = floor(y[0] - 0.15 - 0.1 * (y[1] - y[0])), p.y_high = ceil(y[1] + 0.3); /* room for names below */
    return p;
}

/* ------------------------------------------------------------------- text */

static void grey(cairo_t *cr, double g) { cairo_set_source_rgb(cr, g, g, g); }

static void font(cairo_t *cr, double size, bool bold)
{
    cairo_select_font_face(cr, "sans-serif", CAIRO_FONT_SLANT_NORMAL, bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
    cairo_set_font_size(cr, size);
}

static double width_of(cairo_t *cr, const char *text)
{
    cairo_text_extents_t size;
    cairo_text_extents(cr, text, &size);
    return size.x_advance;
}

/* At x, or ending there, or about it: part 0, 1, 0.5. */
static void write_text(cairo_t *cr, double x, double y, double part, const char *text)
{
    cairo_move_to(cr, x - part * width_of(cr, text), y);
    cairo_show_text(cr, text);
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
    static const double step[] = {1, 2, 5, 1.5, 3, 7}; /* the second half for a short axis */
    int steps = p->x_high - p->x_low < 1.1 ? 6 : 3;
    cairo_t *cr = p->cr;
    for (int decade = (int)floor(p->x_low); decade <= (int)p->x_high + 1; decade++)
        for (int i = 0; i < steps; i++) {
            double ns = step[i] * pow(10, decade), x = x_of(p, ns);
            if (x < p->plot.left || x > p->plot.right) continue;
            char text[40];
            snprintf(text, sizeof text, "%g", ns);
            grey(cr, 0.9);
            line(cr, x, p->plot.top, x, p->plot.bottom, 0.6);
            grey(cr, 0.25);
            write_text(cr, x, p->plot.bottom + 14, 0.5, text);
        }
    write_text(cr, p->plot.right, p->plot.bottom + 28, 1, "ns a ray");
    write_text(cr, p->plot.left, p->plot.bottom + 28, 0, p->c->lens ? "error of the last point" : "error of t");
}

static void error_axis(const panel *p)
{
    cairo_t *cr = p->cr;
    int every = p->y_high - p->y_low > 8 ? 2 : 1;
    for (int decade = (int)p->y_low; decade <= (int)p->y_high; decade++) {
        double y = y_of(p, pow(10, decade));
        grey(cr, 0.9);
        line(cr, p->plot.left, y, p->plot.right, y, 0.6);
        if ((decade - (int)p->y_high) % every) continue;
        char text[40];
        snprintf(text, sizeof text, "1e%d", decade);
        grey(cr, 0.25);
        write_text(cr, p->plot.left - 6, y + 4, 1, text);
    }
    grey(cr, 0.25);
    if (p->floor) write_text(cr, p->plot.left - 6, p->plot.bottom - FLOOR / 2 + 4, 1, "0");
    cairo_rectangle(cr, p->plot.left, p->plot.top, p->plot.right - p->plot.left, p->plot.bottom - p->plot.top);
    cairo_set_line_width(cr, 0.8);
    cairo_stroke(cr);
}

/* ------------------------------------------------------------------- dots */

static void take(panel *p, box b)
{
    p->taken = memory_room(p->taken, p->taken_count, &p->taken_capacity, sizeof *p->taken);
    p->taken[p->taken_count++] = b;
}

static void draw_dot(cairo_t *cr, double x, double y, knob turned, bool best)
{
    cairo_new_path(cr);
    cairo_arc(cr, x, y, DOT, 0, 8 * atan(1));
    legend_colour(cr, knob_colour[turned]);
    if (turned == KNOB_NONE) grey(cr, 0);
    cairo_set_line_width(cr, 1.3);
    if (best) cairo_fill_preserve(cr);
    cairo_stroke(cr);
}

static void draw_stem(panel *p, const setting *s)
{
    double x = x_of(p, s->ns), y = y_of(p, s->error_99), top = s->error_worst > 0 ? y_of(p, s->error_worst) : y;
    if (y - top < DOT) return;
    grey(p->cr, 0.55);
    line(p->cr, x, y - DOT, x, top, 0.7);
    line(p->cr, x - 2.5, top, x + 2.5, top, 0.7);
    take(p, (box){x - 1, top, x + 1, y});
}

static int by_time(const void *a, const void *b)
{
    const setting *const *x = a, *const *y = b;
    return ((*x)->ns > (*y)->ns) - ((*x)->ns < (*y)->ns);
}

static void draw_stairs(const panel *p)
{
    const trade_case *c = p->c;
    const setting **step = memory_take(c->settings, sizeof *step);
    size_t n = 0;
    for (size_t i = 0; i < c->settings; i++) {
        const setting *s = &c->setting[i];
        if (s->best && s->outputs == OUTPUTS_USUAL && shown(s) && s->undecided <= c->setting[0].undecided && s->wrong <= c->setting[0].wrong) step[n++] = s;
    }
    qsort(step, n, sizeof *step, by_time);
    double y = 0;
    for (size_t i = 0; i < n; i++) {
        double to = y_of(p, step[i]->error_99), x = x_of(p, step[i]->ns);
        if (i == 0) cairo_move_to(p->cr, x, to);
        else cairo_line_to(p->cr, x, y), cairo_line_to(p->cr, x, to);
        y = to;
    }
    grey(p->cr, 0.6);
    cairo_set_line_width(p->cr, 1);
    cairo_stroke(p->cr);
}

/* ------------------------------------------------------------------ names */

enum { TEXT_SIZE = 160 };

static void append(char text[TEXT_SIZE], const char *more)
{
    size_t length = strlen(text);
    snprintf(text + length, TEXT_SIZE - length, "%s", more);
}

/* " (20 % undecided, 0.1 % wrong)" */
static void append_shares(char text[TEXT_SIZE], const setting *s, size_t rays)
{
    const struct { size_t n; const char *what; } share[2] = {{s->undecided, "undecided"}, {s->wrong, "wrong"}};
    const char *before = " (";
    for (int i = 0; i < 2; i++) {
        char part[60];
        if (!share[i].n) continue;
        double percent = 100.0 * (double)share[i].n / (double)rays;
        snprintf(part, sizeof part, "%s%.*g %% %s", before, percent < 99 ? 2 : 3, percent, share[i].what);
        append(text, part);
        before = ", ";
    }
    if (*before == ',') append(text, ")");
}

/* Dots that cover each other have one name, a line a knob, "t_tol=1e-9, 1e-6", or two if it gets long. */
enum { LINES = 2 * KNOBS, LONG_LINE = 26 };
typedef struct name {
    double x, y;
    bool best;
    int lines;
    knob turned[LINES];
    char line[LINES][TEXT_SIZE];
} name;

static void add_to_name(name *to, const setting *s, size_t rays)
{
    const char *value = strchr(s->name, '=');
    int i = 0;
    while (i < to->lines && (to->turned[i] != s->turned || (strlen(to->line[i]) > LONG_LINE && to->lines < LINES))) i++;
    to->best = to->best || s->best;
    if (i == LINES) return; /* more than a name can hold */
    if (i == to->lines) {
        to->turned[to->lines++] = s->turned;
        snprintf(to->line[i], TEXT_SIZE, "%s", s->name);
    } else {
        append(to->line[i], ", ");
        append(to->line[i], value ? value + 1 : s->name);
    }
    append_shares(to->line[i], s, rays);
}

static size_t gather_names(const panel *p, name *list)
{
    size_t count = 0;
    for (size_t i = 0; i < p->c->settings; i++) {
        const setting *s = &p->c->setting[i];
        if (!shown(s)) continue;
        double x = x_of(p, s->ns), y = y_of(p, s->error_99);
        size_t k = 0;
        while (k < count && !(fabs(list[k].x - x) < 2 * DOT && fabs(list[k].y - y) < 2 * DOT)) k++;
        if (k == count) list[count++] = (name){.x = x, .y = y};
        add_to_name(&list[k], s, p->c->rays);
    }
    return count;
}

/* What may be in the way of a name: all there is; dots and other names; nothing but the frame. */
typedef enum respect { RESPECT_ALL, RESPECT_DOTS, RESPECT_FRAME } respect;

static bool free_place(const panel *p, box b, respect of)
{
    if (b.left < p->plot.left + 2 || b.right > p->plot.right - 2 || b.top < p->plot.top + 1 || b.bottom > p->plot.bottom - 1) return false;
    for (size_t i = 0; i < p->taken_count && of != RESPECT_FRAME; i++) {
        const box *o = &p->taken[i];
        if (of == RESPECT_DOTS && o->right - o->left < STEM) continue;
        if (b.left < o->right && o->left < b.right && b.top < o->bottom && o->top < b.bottom) return false;
    }
    return true;
}

static void tie(cairo_t *cr, const name *n, box b)
{
    double x = fmin(fmax(n->x, b.left), b.right), y = fmin(fmax(n->y, b.top), b.bottom), length = hypot(x - n->x, y - n->y);
    grey(cr, 0.7);
    line(cr, n->x + (DOT + 1) * (x - n->x) / length, n->y + (DOT + 1) * (y - n->y) / length, x, y, 0.5);
}

/* Along the circle of radius d about the dot; the name touches it from outside. */
static bool find_place(const panel *p, const name *n, double wide, double high, respect of, double *distance, box *b)
{
    enum { WAYS = 16 };
    for (double d = DOT + 4; d < 260; d += 6)
        for (int k = 0; k < WAYS; k++) {
            int turn = k % 2 ? (k + 1) / 2 : -k / 2; /* to the right first, the left last */
            double x = cos(turn * 8 * atan(1) / WAYS), y = sin(turn * 8 * atan(1) / WAYS);
            double left = n->x + d * x - wide * (1 - x) / 2, top = n->y + d * y - high * (1 - y) / 2;
            *distance = d;
            *b = (box){left - 2, top - 1, left + wide + 2, top + high + 1};
            if (free_place(p, *b, of)) return true;
        }
    return false;
}

static void place_name(panel *p, const name *n)
{
    cairo_t *cr = p->cr;
    double wide = 0, high = n->lines * LINE, distance;
    bool found = false;
    box b;
    for (int i = 0; i < n->lines; i++) wide = fmax(wide, width_of(cr, n->line[i]));
    for (int of = RESPECT_ALL; of <= (n->best ? RESPECT_FRAME : RESPECT_DOTS) && !found; of++) found = find_place(p, n, wide, high, (respect)of, &distance, &b);
    if (!found) return; /* it would cover others, or is wider than the panel */
    if (distance > DOT + 11) tie(cr, n, b);
    take(p, b);
    cairo_set_source_rgba(cr, 1, 1, 1, 0.8);
    cairo_rectangle(cr, b.left, b.top, b.right - b.left, b.bottom - b.top);
    cairo_fill(cr);
    grey(cr, n->best ? 0 : 0.4);
    for (int i = 0; i < n->lines; i++) write_text(cr, b.left + 2, b.top + 1 + (i + 0.8) * LINE, 0, n->line[i]);
}

static void draw_panel(panel *p)
{
    cairo_t *cr = p->cr;
    font(cr, 13, true);
    grey(cr, 0);
    write_text(cr, p->plot.left, p->plot.top - 24, 0, p->c->name);
    font(cr, FONT, false);
    grey(cr, 0.35);
    write_text(cr, p->plot.left, p->plot.top - 8, 0, p->c->about);
    time_axis(p);
    error_axis(p);
    draw_stairs(p);
    for (size_t i = p->c->settings; i-- > 0;) { /* the default on top */
        const setting *s = &p->c->setting[i];
        if (!shown(s)) continue;
        double x = x_of(p, s->ns), y = y_of(p, s->error_99);
        draw_stem(p, s);
        draw_dot(cr, x, y, s->turned, s->best);
        take(p, (box){x - DOT, y - DOT, x + DOT, y + DOT});
    }
    name *list = memory_take(p->c->settings, sizeof *list);
    size_t count = gather_names(p, list);
    for (size_t i = 0; i < count; i++) place_name(p, &list[i]);
}

/* ------------------------------------------------------------------- page */

static void draw_key(cairo_t *cr, const trade *t, double left, double right, double y)
{
    static const char *const words[] = {
        "A dot: the error that 99 % of the rays keep below; its stem: the worst.", "A full dot: none with as many outputs beats it in time, error, undecided, wrong.",
        "The line joins those of the default's outputs that are as sure as it is.",
    };
    double x = left;
    bool used[KNOBS] = {false};
    for (size_t i = 0; i < t->count; i++)
        for (size_t k = 0; k < t->list[i].settings; k++) used[t->list[i].setting[k].turned] = true;
    font(cr, FONT, false);
    for (int k = 0; k < KNOBS; k++) {
        if (!used[k]) continue;
        double wide = 9 + width_of(cr, knob_name[k]) + 16;
        if (x + wide > right) x = left, y += LINE + 4;
        draw_dot(cr, x + DOT, y - 3.5, (knob)k, true);
        grey(cr, 0.2);
        write_text(cr, x + 12, y, 0, knob_name[k]);
        x += wide;
    }
    grey(cr, 0.35);
    for (int i = 0; i < 3; i++) write_text(cr, left, y + 20 + i * (LINE + 2), 0, words[i]);
}

void trade_picture(const char *file, const trade *t)
{
    int columns = t->count > 1 ? 2 : 1, rows = ((int)t->count + columns - 1) / columns;
    bool gap = columns == 2 && t->count % 2; /* a panel's place for the key */
    double width = (columns == 2 ? 1 : 1.4) * (WIDTH - 2 * MARGIN - GAP) / 2;
    double page = columns * width + (columns - 1) * GAP + 2 * MARGIN, height = rows * PANEL_HIGH + (gap ? 0 : KEY_HIGH) + MARGIN;
    cairo_surface_t *surface = cairo_svg_surface_create(file, page, height);
    cairo_t *cr = cairo_create(surface);
    grey(cr, 1);
    cairo_paint(cr);
    for (size_t i = 0; i < t->count; i++) {
        double left = MARGIN + (double)(i % (size_t)columns) * (width + GAP), top = (double)(i / (size_t)columns) * PANEL_HIGH;
        panel p = panel_of(cr, &t->list[i], left, top, width);
        draw_panel(&p);
    }
    double key = MARGIN + LEFT + (gap ? width + GAP : 0);
    draw_key(cr, t, key, page - MARGIN, gap ? (rows - 1) * PANEL_HIGH + HEAD_HIGH + 12 : rows * PANEL_HIGH + 18);
    cairo_destroy(cr);
    cairo_surface_finish(surface);
    cairo_status_t status = cairo_surface_status(surface);
    cairo_surface_destroy(surface);
    if (status != CAIRO_STATUS_SUCCESS) fail_input("%s: %s", file, cairo_status_to_string(status));
}
