// SPDX-License-Identifier: MIT
/* chart.c - the sheet: a title block, a grid of panels, the legend; written as svg, png or pdf.
 *
 * The sheet has a fixed width and the height that its rows need.  All panels have plots of one size, aligned
 * in rows and columns, so that they can be compared.  Their size follows from the room that numbers need, and
 * the numbers from the size; so both are found in turns, and the room only grows (place_all).  Everything is
 * measured before the surface is made, by fonts without hinting.  So all kinds of files have the same layout.
 *
 * With square panels the plot's shape follows the content, from 1 : 2.5 to 1 : 1, and x and y get one scale:
 * the larger one that the two need.  If the panels share a range, they share that scale.
 *
 * The same chart gives the same bytes: the pdf has no date. */
#include "../base/memory.h"
#include "chart_draw.h"
#include "sheet.h"

#include <math.h>

static const double SHEET_WIDTH = 900, SHEET_MARGIN = 24, PANELS_APART = 20, ROWS_APART = 14, TITLE_FONT = 15,
                    LINE_FONT = 10.5, TALLEST = 470, FLATTEST = 0.4, NARROWEST_PLOT = 72;

void chart_check(const char *option, const char *path) { picture_kind_of(option, path); }

/* ----------------------------------------------------------------- layout */

enum { MOST_COLUMNS = 8 };

typedef struct chart_sheet {
    cairo_t *cr;
    const chart *c;
    chart_place *place; /* [panels] */
    size_t columns, rows;
    double cell, left, right; /* width of a cell; room beside the plots in it */
    double wide, high;        /* of a plot */
    double height;            /* of the sheet */
} chart_sheet;

static size_t columns_of(const chart *c)
{
    size_t chosen = c->panels <= 3 ? c->panels : c->panels == 4 ? 2 : c->panels <= 9 ? 3 : 4;
    if (c->columns) chosen = c->columns < c->panels ? c->columns : c->panels;
    return chosen < MOST_COLUMNS ? chosen : MOST_COLUMNS;
}

static void join_ranges(chart_range *all, const chart_range *r)
{
    for (int i = 0; i < 2; i++)
        chart_range_add(all->fixed, r->fixed[i]), chart_range_add(all->free, r->free[i]);
}

static void find_ranges(chart_sheet *s)
{
    chart_range x = chart_range_none(), y = chart_range_none();
    for (size_t i = 0; i < s->c->panels; i++) {
        s->place[i] = chart_place_of(&s->c->panel[i]);
        join_ranges(&x, &s->place[i].x_range), join_ranges(&y, &s->place[i].y_range);
    }
    for (size_t i = 0; i < s->c->panels; i++) {
        chart_place *p = &s->place[i];
        p->x = chart_axis_of(s->c->same_x ? &x : &p->x_range);
        p->y = chart_axis_of(s->c->same_y ? &y : &p->y_range);
    }
}

static double span(const chart_axis *a) { return a->high - a->low; }

/* Height by width of the plots: as the content of the square panels has it, else by the number of columns. */
static double shape_of(const chart_sheet *s)
{
    double tallest = 0;
    for (size_t i = 0; i < s->c->panels; i++)
        if (s->place[i].of->square) tallest = fmax(tallest, span(&s->place[i].y) / span(&s->place[i].x));
    if (tallest > 0) return fmin(fmax(tallest, FLATTEST), 1);
    return s->columns == 1 ? 0.5 : s->columns == 2 ? 0.58 : 0.8;
}

static void set_scale(chart_axis *a, double new_span)
{
    double middle = a->low / 2 + a->high / 2;
    a->low = middle - new_span / 2, a->high = middle + new_span / 2;
}

/* Gives x and y of square panels one scale. */
static void square_up(chart_sheet *s, double shape)
{
    double shared = 0; /* the span of x */
    for (size_t i = 0; i < s->c->panels; i++) {
        const chart_place *p = &s->place[i];
        if (p->of->square) shared = fmax(shared, fmax(span(&p->x), span(&p->y) / shape));
    }
    for (size_t i = 0; i < s->c->panels; i++) {
        chart_place *p = &s->place[i];
        if (!p->of->square) continue;
        double own = s->c->same_x || s->c->same_y ? shared : fmax(span(&p->x), span(&p->y) / shape);
        set_scale(&p->x, own), set_scale(&p->y, own * shape);
    }
}

static void set_ticks(const chart_sheet *s, chart_place *p)
{
    if (p->bar) { /* the step of the grid is the length of the bar */
        chart_axis_ticks(&p->x, s->wide, s->wide / 5);
        chart_axis_ticks(&p->y, s->high, s->wide / 5);
    } else {
        chart_axis_ticks_beside(s->cr, &p->x, s->wide);
        chart_axis_ticks(&p->y, s->high, fmax(17, s->high / 9));
    }
    if (p->of->map) p->scale = chart_scale_of(p->of->map, s->high);
}

/* Finds the size of the plots, and the ticks. */
static void place_all(chart_sheet *s)
{
    double shape = shape_of(s), room = 0;
    bool square = false;
    for (size_t i = 0; i < s->c->panels; i++) square = square || s->place[i].of->square;
    square_up(s, shape);
    s->left = s->right = 0;
    do {
        room = s->left + s->right;
        s->wide = fmax(s->cell - room, NARROWEST_PLOT / 2);
        s->high = fmin(s->wide * shape, TALLEST);
        if (square) s->wide = s->high / shape;
        for (size_t i = 0; i < s->c->panels; i++) {
            chart_place *p = &s->place[i];
            set_ticks(s, p);
            s->left = fmax(s->left, chart_place_left(s->cr, p));
            s->right = fmax(s->right, chart_place_right(s->cr, p, s->wide));
        }
    } while (s->left + s->right > room && s->wide >= NARROWEST_PLOT);
}

/* ---------------------------------------------------------------- drawing */

/* The title block; returns where it ends. */
static double title_block(const chart_sheet *s, bool draw)
{
    double y = SHEET_MARGIN, room = SHEET_WIDTH - 2 * SHEET_MARGIN, step = CHART_LINE * TITLE_FONT;
    chart_font(s->cr, TITLE_FONT, true);
    chart_grey(s->cr, 0);
    y += step * (double)chart_wrap(s->cr, SHEET_MARGIN, y + TITLE_FONT - 3, room, step, s->c->title, draw);
    chart_font(s->cr, LINE_FONT, false);
    chart_grey(s->cr, 0.35);
    step = CHART_LINE * LINE_FONT;
    for (size_t i = 0; i < s->c->lines; i++)
        y += step *
             (double)chart_wrap(s->cr, SHEET_MARGIN, y + LINE_FONT - 1, room, step, s->c->line[i], draw);
    return y + 14;
}

/* The title above a plot, whose last line is just above it; returns its height. */
static double title_of(const chart_sheet *s, const chart_place *p, bool draw)
{
    double step = CHART_LINE * CHART_NORMAL, room = s->wide + p->after;
    chart_font(s->cr, CHART_NORMAL, true);
    chart_grey(s->cr, 0.1);
    double lines = (double)chart_wrap(s->cr, 0, 0, room, step, p->of->title, false);
    double y = p->plot.top - 6 - (lines - 1) * step;
    if (draw) chart_wrap(s->cr, p->plot.left, y, room, step, p->of->title, true);
    return lines == 0 ? 0 : 5 + lines * step;
}

static double notes_of(const chart_sheet *s, const chart_place *p, bool draw)
{
    double step = CHART_LINE * CHART_SMALL, room = s->wide + p->after, lines = 0,
           y = p->plot.bottom + chart_place_foot(p) + 2 + CHART_SMALL;
    chart_font(s->cr, CHART_SMALL, false);
    chart_grey(s->cr, 0.35);
    for (size_t i = 0; i < p->of->notes; i++)
        lines += (double)chart_wrap(s->cr, p->plot.left, y + lines * step, room, step, p->of->note[i], draw);
    return lines == 0 ? 0 : 4 + lines * step;
}

/* Places a row of panels from y down, and draws it if `draw`; returns where it ends. */
static double row_of_panels(const chart_sheet *s, size_t row, double y, bool draw)
{
    double title = 0, foot = 0, notes = 0;
    double spare = fmax(s->cell - s->left - s->right - s->wide, 0) / 2; /* of a cell wider than its panel */
    size_t first = row * s->columns, end = first + s->columns;
    if (end > s->c->panels) end = s->c->panels;
    for (size_t i = first; i < end; i++) {
        chart_place *p = &s->place[i];
        p->before = s->left + spare, p->after = s->right + spare;
        title = fmax(title, title_of(s, p, false));
    }
    for (size_t i = first; i < end; i++) {
        chart_place *p = &s->place[i];
        double x = SHEET_MARGIN + (double)(i - first) * (s->cell + PANELS_APART) + p->before;
        p->plot = (chart_box){x, y + title, x + s->wide, y + title + s->high};
        notes = fmax(notes, notes_of(s, p, draw));
        foot = fmax(foot, chart_place_foot(p));
        if (!draw) continue;
        title_of(s, p, true);
        chart_place_draw(s->cr, p);
    }
    return y + title + s->high + foot + notes;
}

static double draw_sheet(const chart_sheet *s, bool draw)
{
    double y = title_block(s, draw);
    for (size_t row = 0; row < s->rows; row++) y = row_of_panels(s, row, y, draw) + ROWS_APART;
    y += chart_legend(s->cr, s->c, SHEET_MARGIN, SHEET_WIDTH - SHEET_MARGIN, y, draw);
    return y + SHEET_MARGIN / 2;
}

/* If the plots would be too narrow there are fewer columns. */
static chart_sheet measured(const chart *c)
{
    chart_sheet s = {.c = c, .columns = columns_of(c), .place = memory_take(c->panels, sizeof *s.place)};
    s.cr = sheet_nowhere();
    for (; s.columns > 0; s.columns--) {
        s.rows = (c->panels + s.columns - 1) / s.columns;
        s.cell = (SHEET_WIDTH - 2 * SHEET_MARGIN + PANELS_APART) / (double)s.columns - PANELS_APART;
        find_ranges(&s);
        place_all(&s);
        if (s.wide >= NARROWEST_PLOT || s.columns == 1) break;
    }
    s.height = draw_sheet(&s, false);
    sheet_forget(s.cr);
    return s;
}

static void draw_chart(cairo_t *cr, const void *what)
{
    chart_sheet s = *(const chart_sheet *)what;
    s.cr = cr;
    cairo_set_line_join(cr, CAIRO_LINE_JOIN_ROUND);
    draw_sheet(&s, true);
}

void chart_write(const char *path, const chart *c)
{
    chart_sheet s = measured(c);
    sheet_write(path, picture_kind_of("picture", path), SHEET_WIDTH, s.height, draw_chart, &s);
}
