/* legend.h - the line under a picture: what the colours and marks mean, and how long. */
#ifndef TOOL_LEGEND_H
#define TOOL_LEGEND_H
#include "scene.h"

#include <cairo.h>

#define LEGEND_FONT 11.0
#define LEGEND_STOP_WIDTH 2.6

/* The colour of a field's rays, as the source of what is drawn next. */
void legend_colour(cairo_t *cr, size_t field);

/* Where a ray was lost: a cross, a ring or a triangle, as its fate asks. */
void legend_mark(cairo_t *cr, sgt_fate fate, double x, double y);

/* Draws the legend between left and right, from top down; returns its height.  scale:
 * points per length of the lens. */
double legend_draw(cairo_t *cr, const scene *s, double left, double right, double top, double scale);

#endif
