// SPDX-License-Identifier: MIT
/* map.h - a part of the Earth on paper, north up in its middle. */
#ifndef LINE_OF_SIGHT_MAP_H
#define LINE_OF_SIGHT_MAP_H
#include <cairo.h>
#include <stdbool.h>
#include <stddef.h>

typedef struct spot { double x, y; } spot;

typedef struct map {
    double left, top, width, height;  /* on the page */
    double latitude, longitude;       /* of the middle, degrees */
    double scale;                     /* of the page for a km, in the middle */
} map;

/* on the page; false: too far round the Earth */
bool map_spot(const map *m, double latitude, double longitude, spot *at);
/* middle and scale, so that all of these are on it; NaN are passed by */
void map_fit(map *m, size_t n, const double latitude[], const double longitude[]);
void map_graticule(const map *m, cairo_t *cr);      /* with its labels, to the left, below and above */
void map_scale_bar(const map *m, cairo_t *cr);

#endif
