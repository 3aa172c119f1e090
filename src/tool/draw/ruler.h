// SPDX-License-Identifier: MIT
/* ruler.h - the axes of a picture: rulers with the unit of length, or the directions of x, y and z. */
#ifndef TOOL_RULER_H
#define TOOL_RULER_H
#include "page.h"

/* The box of the plot on the page. */
typedef struct frame_box { double left, top, right, bottom; } frame_box;

#define RULER_HEIGHT 34.0 /* of what is drawn below the plot */

/* How wide the ruler at the left of a plot is. */
double ruler_width(const page *p, const frame_box *plot);

/* Draws both rulers. */
void ruler_draw(const page *p, const frame_box *plot);

/* Draws arrows that show the directions of x, y and z, from a point on. */
void ruler_directions(const page *p, page_dot from);

#endif
