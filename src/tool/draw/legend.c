// SPDX-License-Identifier: MIT
/* legend.c - entries from left to right, in as many rows as they need, and the scale bar at
 * the right end of the first row. */
#include "legend.h"

#include "../base/memory.h"

#include "chart_draw.h"
#include "palette.h"

#include <math.h>

static const double LEGEND_ROW = 18, SAMPLE = 20, GAP = 6, BETWEEN = 22, BAR_ROOM = 210, BAR_LONGEST = 150,
                    TICK = 3;

/* The colour of a field or wavelength; beyond the number of colours, other dashes. */
static void legend_set(cairo_t *cr, size_t i)
{
    palette_set(cr, i);
    palette_dash(cr, i / PALETTE_COLOURS);
}

void legend_ray(cairo_t *cr, const scene *s, const ray_path *ray, double opaque)
{
    size_t i = s->by_wavelength ? ray->wavelength : ray->field;
    const double *c = palette_colour(i);
    legend_set(cr, i);
    cairo_set_source_rgba(cr, c[0], c[1], c[2], opaque);
}

void legend_mark(cairo_t *cr, sgt_fate fate, double x, double y)
{
    const double r = 3;
    cairo_new_path(cr);
    if (fate == SGT_CLIPPED) {
        cairo_move_to(cr, x - r, y - r), cairo_line_to(cr, x + r, y + r);
        cairo_move_to(cr, x - r, y + r), cairo_line_to(cr, x + r, y - r);
    } else if (fate == SGT_TIR || fate == SGT_EVANESCENT) {
        cairo_arc(cr, x, y, r, 0, 8 * atan(1.0));
    } else if (fate == SGT_LOST) {
        cairo_rectangle(cr, x - 0.75 * r, y - 0.75 * r, 1.5 * r, 1.5 * r);
        cairo_fill_preserve(cr);
    } else {
        cairo_move_to(cr, x, y - r), cairo_line_to(cr, x + r, y + r), cairo_line_to(cr, x - r, y + r);
        cairo_close_path(cr);
    }
    cairo_set_line_width(cr, 1.1);
    cairo_stroke(cr);
}

/* ---------------------------------------------------------------- entries */

typedef struct flow { cairo_t *cr; double left, right, x, y; } flow;

/* Makes room for a sample and a text, and draws the text; returns x of the sample. */
static double entry(flow *f, double sample, const char *text)
{
    double room = f->right - f->left, wide = fmin(sample + GAP + chart_width(f->cr, text), room);
    if (f->x > f->left && f->x + wide > f->right) f->x = f->left, f->y += LEGEND_ROW;
    double x = f->x;
    chart_grey(f->cr, 0.2);
    chart_text(f->cr, x + sample + GAP, f->y, 0, room, text);
    f->x += wide + BETWEEN;
    return x;
}

/* "field 5°" or, of lengths, "field 3, 4 mm"; the word only before the first. */
static const char *field_name(const job *j, size_t i)
{
    bool angle = j->field_kind == SGT_FIELD_ANGLE;
    const char *unit = angle ? "\302\260" : j->lens.units, *blank = angle ? "" : " ";
    const char *word = i == 0 ? "field " : "";
    sgt_lens_field at = j->field[i];
    return at.x == 0 ? memory_print("%s%g%s%.20s", word, at.y, blank, unit)
                     : memory_print("%s(%g, %g)%s%.20s", word, at.x, at.y, blank, unit);
}

/* What the colours of the rays mean. */
static void ray_entries(flow *f, const scene *s)
{
    const job *j = s->job;
    for (size_t i = 0; i < (s->by_wavelength ? j->wavelengths : j->fields); i++) {
        const char *text = s->by_wavelength ? memory_print("%g \302\265m", j->at[i].lens.wavelength)
                                            : field_name(j, i);
        double x = entry(f, SAMPLE, text), y = f->y - CHART_NORMAL / 3;
        legend_set(f->cr, i);
        cairo_move_to(f->cr, x, y), cairo_line_to(f->cr, x + SAMPLE, y);
        cairo_set_line_width(f->cr, 1.6);
        cairo_stroke(f->cr);
        cairo_set_dash(f->cr, NULL, 0, 0);
    }
}

static void stop_entry(flow *f, const scene *s)
{
    double x = entry(f, LEGEND_STOP_WIDTH, memory_print("stop: element %zu", s->job->lens.of->stop + 1));
    cairo_set_source_rgb(f->cr, 0, 0, 0);
    cairo_move_to(f->cr, x + 1, f->y + 1), cairo_line_to(f->cr, x + 1, f->y - CHART_NORMAL + 2);
    cairo_set_line_width(f->cr, LEGEND_STOP_WIDTH);
    cairo_stroke(f->cr);
}

static void fate_entries(flow *f, const scene *s)
{
    static const struct {
        sgt_fate fate;
        const char *name;
    } fates[] = {
        {SGT_CLIPPED, "clipped"},
        {SGT_TIR, "totally reflected"},
        {SGT_EVANESCENT, "evanescent"},
        {SGT_MISSED, "missed"},
        {SGT_LOST, "lost"},
    };
    for (int k = 0; k < 5; k++) {
        size_t n = 0;
        for (size_t i = 0; i < s->paths; i++) n += s->path[i].fate == fates[k].fate;
        if (n == 0) continue;
        double x = entry(f, 6, memory_print("%zu %s", n, fates[k].name));
        legend_mark(f->cr, fates[k].fate, x + 3, f->y - CHART_NORMAL / 3);
    }
}

/* A bar of the longest length that fits: 1, 2 or 5 times a power of ten. */
static void scale_bar(cairo_t *cr, const scene *s, double right, double y, double scale)
{
    static const double steps[] = {1, 2, 5, 10};
    double longest = BAR_LONGEST / scale, ten = pow(10, floor(log10(longest))), length = ten;
    char text[CHART_TEXT];
    for (int i = 0; i < 4; i++)
        if (steps[i] * ten <= longest) length = steps[i] * ten;
    chart_number(length, s->job->lens.units, text);
    double wide = fmin(chart_width(cr, text), BAR_ROOM - BAR_LONGEST);
    double end = right - wide - GAP, start = end - scale * length;
    chart_grey(cr, 0.2);
    chart_text(cr, right, y, 1, wide, text);
    y -= CHART_NORMAL / 3;
    cairo_move_to(cr, start, y - TICK), cairo_line_to(cr, start, y + TICK);
    cairo_move_to(cr, start, y), cairo_line_to(cr, end, y);
    cairo_move_to(cr, end, y - TICK), cairo_line_to(cr, end, y + TICK);
    cairo_set_line_width(cr, 0.9);
    cairo_stroke(cr);
}

double legend_draw(cairo_t *cr, const scene *s, const char *words, double left, double right, double top,
                   double scale)
{
    chart_font(cr, CHART_NORMAL, false);
    flow f = {.cr = cr, .left = left, .right = right - (scale > 0 ? BAR_ROOM : 0), .x = left,
              .y = top + CHART_NORMAL};
    ray_entries(&f, s);
    if (s->job->lens.of->stop_marked) stop_entry(&f, s);
    fate_entries(&f, s);
    if (*words) entry(&f, 0, words);
    if (scale > 0) scale_bar(cr, s, right, top + CHART_NORMAL, scale);
    return f.y - top + LEGEND_ROW / 2;
}
