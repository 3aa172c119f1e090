// SPDX-License-Identifier: MIT
/* tiles.h - a picture of a scene, tile by tile. */
#ifndef RENDER_TILES_H
#define RENDER_TILES_H
#include "meet.h"
#include "paint.h"
#include "progress.h"

enum { TILE = 16 }; /* pixels across */
/* What the rays through the middles of pixels meet, row by row from the top: the distance, which is infinite
 * where nothing is met and NaN where it is undecided; its error; the normal, of unit length, toward the eye;
 * the status. */
typedef struct arrays { double *depth, *t_err, *normal; signed char *status; } arrays;

typedef struct order {
    int samples, threads, tile, frame;
    paint_kind paint;
    const char *name;
    const arrays *arrays;  /* NULL: not wanted */
    pace pace;             /* zero: there is one picture */
} order;

/* Fills the picture, which is as large as the scene says; adds to *total.  Threads and tiles do not change
 * a bit of either. */
void tiles_render(const scene *s, double along_path, const order *o, picture *p, tally *total);

int tiles_threads(void); /* how many threads there can be */

#endif
