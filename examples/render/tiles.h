// SPDX-License-Identifier: MIT
/* tiles.h - a picture of a scene, tile by tile. */
#ifndef RENDER_TILES_H
#define RENDER_TILES_H
#include "meet.h"
#include "paint.h"

enum { TILE = 16 }; /* pixels across */
typedef struct order { int samples, threads, tile, frame; paint_kind paint; const char *name; } order;

/* Fills the picture, which is as large as the scene says; adds to *total.  Threads and tiles do not change
 * a bit of either. */
void tiles_render(const scene *s, double along_path, const order *o, picture *p, tally *total);

int tiles_threads(void); /* how many threads there can be */

#endif
