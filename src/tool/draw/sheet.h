// SPDX-License-Identifier: MIT
/* sheet.h - the file of a picture: svg, png or pdf. */
#ifndef TOOL_SHEET_H
#define TOOL_SHEET_H
#include "kind.h"

#include <cairo.h>

/* A sheet to measure texts on; what is drawn there goes nowhere.  To be ended by sheet_forget. */
cairo_t *sheet_nowhere(void);
void sheet_forget(cairo_t *cr);

/* Writes a file of a white sheet on which `draw` draws.  Sizes are points; a png has two pixels a point,
 * unless it is so high that no png can hold them.  The same drawing gives the same bytes.  If the file cannot
 * be written the command ends. */
void sheet_write(const char *path, picture_kind kind, double width, double height,
                 void (*draw)(cairo_t *cr, const void *what), const void *what);

#endif
