// SPDX-License-Identifier: MIT
/* page.h - a page on which a scene is drawn: points of the lens as points of the page (1/72 inch, y down). */
#ifndef TOOL_PAGE_H
#define TOOL_PAGE_H
#include "scene.h"

#include <cairo.h>

typedef struct page {
    cairo_t *cr;
    const scene *scene;
    double scale;      /* points per unit of length */
    double left, base; /* x = left + scale right, y = base - scale up */
    bool pale;         /* what is drawn stands behind another lens: all lines in one light grey */
} page;

typedef struct page_dot { double x, y; } page_dot;

/* Widths of lines. */
#define PAGE_THIN 0.5
#define PAGE_SURFACE 0.9
#define PAGE_MIRROR 1.6
#define PAGE_BLOCKED 2.6

/* Where a point of the lens is on the page.  Not finite where p is not. */
page_dot page_at(const page *p, sgt_vec3 point);

/* The same of a direction, not scaled: its x and y on the page are at most 1. */
page_dot page_along(const page *p, sgt_vec3 direction);

/* Adds lines through `count` points to the path; after a point that is not
 * finite a new line begins. */
void page_line(const page *p, const sgt_vec3 at[], size_t count);

/* Strokes the path in grey (0: black), on a pale page in PAGE_PALE. */
#define PAGE_PALE 0.7
void page_stroke(const page *p, double width, double grey);

#endif
