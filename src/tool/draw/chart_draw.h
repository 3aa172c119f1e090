// SPDX-License-Identifier: MIT
/* chart_draw.h - what the files of a chart share.  Lengths are points; y grows downward on the sheet. */
#ifndef TOOL_CHART_DRAW_H
#define TOOL_CHART_DRAW_H
#include "chart.h"

#include <cairo.h>

typedef struct chart_box { double left, top, right, bottom; } chart_box;

static inline bool chart_boxes_meet(const chart_box *a, const chart_box *b)
{
    return a->left < b->right && b->left < a->right && a->top < b->bottom && b->top < a->bottom;
}

/* (chart_series.c) Does the line from x0, y0 to x1, y1 enter the box? */
bool chart_line_enters(double x0, double y0, double x1, double y1, const chart_box *b);

/* ------------------------------------------------------------------ chart_text.c */

#define CHART_SMALL 9.0
#define CHART_NORMAL 10.0
#define CHART_LINE 1.32 /* from one line of text to the next, in sizes of the font */

void chart_font(cairo_t *cr, double size, bool bold);

/* The font with which the text is no wider than `room`, but at least three quarters of `size`. */
void chart_font_within(cairo_t *cr, double size, double room, const char *text);

void chart_grey(cairo_t *cr, double grey);

/* Width of a text as it is drawn; 0 for NULL.  Bytes that are not UTF-8 stand as a question mark, and control
 * characters as a space. */
double chart_width(cairo_t *cr, const char *text);

/* Draws a text on the line y.  It begins at x (part 0), ends there (1), or is centred there (0.5).  If it is
 * wider than `room` it is shortened with an ellipsis; a unit in brackets at its end is kept. */
void chart_text(cairo_t *cr, double x, double y, double part, double room, const char *text);

/* The same turned upward: it is centred on y, and x is its line. */
void chart_text_up(cairo_t *cr, double x, double y, double room, const char *text);

/* Breaks a text between words into lines no wider than `room`, and draws them if `draw`, the first on the
 * line y and each `step` below the last.  Returns how many lines it makes. */
size_t chart_wrap(cairo_t *cr, double x, double y, double room, double step, const char *text, bool draw);

/* ------------------------------------------------------------------ chart_axis.c */

/* What a panel shows along one direction.  Ends of `fixed` are ends of the axis; about `free` there is a
 * margin. Of an empty pair the first is larger. */
typedef struct chart_range { double fixed[2], free[2]; } chart_range;

/* An axis and its ticks: at origin + i * step for whole numbers i.  Their numbers say i * step / 10^exponent.
 */
typedef struct chart_axis {
    double low, high, step, origin;
    int exponent, decimals, minor; /* minor: intervals between two ticks */
} chart_axis;

enum { CHART_TEXT = 200 };

chart_range chart_range_none(void);

/* Takes in a value; NaN, infinities and what is beyond 1e300 are left out. */
void chart_range_add(double pair[2], double value);

/* Whether the value can be drawn. */
bool chart_finite(double value);

/* The ends of the axis that shows a range; 0 and 1 if it is empty. */
chart_axis chart_axis_of(const chart_range *r);

/* Sets ticks at least `spacing` points apart on an axis that is `length` points long. */
void chart_axis_ticks(chart_axis *a, double length, double spacing);

/* The same, so far apart that their numbers do not touch if they stand side by side. */
void chart_axis_ticks_beside(cairo_t *cr, chart_axis *a, double length);

long chart_axis_first(const chart_axis *a); /* the numbers i of the first and the last tick */
long chart_axis_last(const chart_axis *a);

/* Where a value lies along the axis: 0 at its low end, 1 at the high one. */
double chart_axis_part(const chart_axis *a, double value);

void chart_axis_number(const chart_axis *a, long i, char text[CHART_TEXT]);
double chart_axis_width(cairo_t *cr, const chart_axis *a); /* of its widest number */

/* The label with the axis's power of ten and origin: "z (mm)" becomes "z (10^-6 mm from 97.4 mm)".  Without
 * `numbers` it loses its unit.  Returns whether there is any. */
bool chart_axis_label(const chart_axis *a, const char *label, bool numbers, char text[CHART_TEXT]);

/* A number by itself: 0.02, or 2 x 10^-6.  `unit` (may be NULL) stands behind it. */
void chart_number(double value, const char *unit, char text[CHART_TEXT]);

/* The unit in brackets at the end of a label; empty if there is none. */
void chart_unit(const char *label, char text[CHART_TEXT]);

/* ------------------------------------------------------------------ chart_map.c */

/* What the colours of a map mean.  They run over the axis, of logarithms if the map is so. */
typedef struct chart_scale {
    bool shown; /* there is a bar */
    chart_axis axis;
} chart_scale;

chart_scale chart_scale_of(const chart_map *m, double length);
double chart_scale_width(cairo_t *cr, const chart_map *m, const chart_scale *s);
void chart_scale_draw(cairo_t *cr, const chart_map *m, const chart_scale *s, const chart_box *plot);

/* Fills the squares of the map, which reaches over the box `at`. */
void chart_map_draw(cairo_t *cr, const chart_map *m, const chart_scale *s, const chart_box *at);

/* The colour of kind i, as parts of red, green and blue. */
void chart_kind_colour(size_t i, double rgb[3]);

/* ---------------------------------------------------------------- chart_panel.c */

typedef struct chart_place {
    const chart_panel *of;
    bool bar; /* a scale bar in place of numbers */
    chart_range x_range, y_range;
    chart_axis x, y;
    chart_scale scale;    /* of the map */
    chart_box plot;       /* inside the frame */
    double before, after; /* room to its left and right that texts may use */
} chart_place;

/* What the panel has to show; the axes and the plot are still to be found. */
chart_place chart_place_of(const chart_panel *p);

/* Room that the panel needs on the left and the right of a plot that is `wide`, and below it without notes.
 */
double chart_place_left(cairo_t *cr, const chart_place *p);
double chart_place_right(cairo_t *cr, const chart_place *p, double wide);
double chart_place_foot(const chart_place *p);
void chart_place_draw(cairo_t *cr, const chart_place *p);

/* --------------------------------------------------------------- chart_series.c */

void chart_series_draw(cairo_t *cr, const chart_place *p, const chart_series *s);
void chart_circle_draw(cairo_t *cr, const chart_place *p, const chart_circle *c);
void chart_rule_draw(cairo_t *cr, const chart_place *p, const chart_rule *r);

/* Whether a circle can be drawn, with all of it among the numbers of an axis. */
bool chart_circle_there(const chart_circle *c);

/* Samples for the legend, between x and x + width. */
void chart_series_sample(cairo_t *cr, const chart_series *s, double x, double y, double width);
void chart_circle_sample(cairo_t *cr, const chart_circle *c, double x, double y, double width);
void chart_rule_sample(cairo_t *cr, const chart_rule *r, double x, double y, double width);

/* --------------------------------------------------------------- chart_legend.c */

/* Draws the legend between left and right, from top down, if `draw`; returns its height. */
double chart_legend(cairo_t *cr, const chart *c, double left, double right, double top, bool draw);

#endif
