// SPDX-License-Identifier: MIT
/* palette.h - the colours and dashes of all pictures. */
#ifndef TOOL_PALETTE_H
#define TOOL_PALETTE_H
#include <cairo.h>
#include <stddef.h>

enum { PALETTE_COLOURS = 7, PALETTE_DASHES = 5 };

/* Colour number i (0, 1, ...), as parts of red, green and blue from 0 to 1.  After PALETTE_COLOURS they
 * repeat: then tell things apart by the dash or the mark i / PALETTE_COLOURS. */
const double *palette_colour(size_t i);

/* What is drawn next has colour i. */
void palette_set(cairo_t *cr, size_t i);

/* What is drawn next has dash number i: 0 solid, 1 dashed, 2 dotted, 3 dash and dot, 4 long dashes; then they
 * repeat.  It suits lines of 0.5 to 2 points with any caps. */
void palette_dash(cairo_t *cr, size_t i);

#endif
