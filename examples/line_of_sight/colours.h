// SPDX-License-Identifier: MIT
/* colours.h - numbers as colours, and what cairo wants said often. */
#ifndef LINE_OF_SIGHT_COLOURS_H
#define LINE_OF_SIGHT_COLOURS_H
#include <cairo.h>

enum {
    INK = 0x202020,
    FAINT = 0xb4b4b4,
    PAPER = 0xffffff,
    MISSED = 0xe8e8e8,
    UNDECIDED = 0xd55e00,
    TRACK = 0xd6336c
};

unsigned colours_viridis(double x); /* 0 ... 1; other numbers: the nearer end */
void colours_set(cairo_t *cr, unsigned code);
void colours_box(cairo_t *cr, double x, double y, double width, double height, unsigned code);

/* align: 0 begins at x, 0.5 in the middle, 1 ends there.  The width is returned. */
double colours_text(cairo_t *cr, double x, double y, double align, const char *words);

#endif
