// SPDX-License-Identifier: MIT
/* legend.h - the line under a picture: the meaning of colours and marks, and a scale bar. */
#ifndef TOOL_LEGEND_H
#define TOOL_LEGEND_H
#include "scene.h"

#include <cairo.h>

#define LEGEND_STOP_WIDTH 2.6

/* Sets colour and dash of a ray: those of its field, or of its wavelength (scene.by_wavelength).
 * opaque: 1; less lets shine through what is behind. */
void legend_ray(cairo_t *cr, const scene *s, const ray_path *ray, double opaque);

/* Draws the mark of a ray's end: a cross (clipped), a ring (tir), a triangle (missed), a full square (lost).
 */
void legend_mark(cairo_t *cr, sgt_fate fate, double x, double y);

/* Draws the legend between left and right, from top down; returns its height.  All are points.
 * words: stand behind the marks; may be empty.  scale: points per unit of length of the lens, for a bar that
 * shows it; 0: no bar. */
double legend_draw(cairo_t *cr, const scene *s, const char *words, double left, double right, double top,
                   double scale);

#endif
