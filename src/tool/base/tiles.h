// SPDX-License-Identifier: MIT
/* tiles.h - works through many rays in threads, some hundred rays at a time. */
#ifndef TOOL_TILES_H
#define TOOL_TILES_H
#include <stdbool.h>
#include <stddef.h>

enum { TILE_RAYS = 1024 };

/* The default number of threads: OMP_NUM_THREADS, else the number of processors; 1 without
 * OpenMP. */
int tiles_threads(void);

/* Rays first ... first + count - 1, and the index of the room that this tile may use. */
typedef struct tile { size_t place, first, count; } tile;

/* The work: `rays` rays in `threads` threads, each of which may be `share` tiles ahead of the one whose turn
 * it is (a larger share means less waiting and more room), with at most `most` rays in a tile (at most
 * TILE_RAYS; 0: TILE_RAYS). */
typedef struct tiling {
    size_t rays;
    int threads;
    size_t share, most;
    size_t skip;  /* the number of the first ray: a multiple of a tile */
    bool fixed;   /* tiles have `most` rays, however few there are for each thread */
} tiling;
enum { SHARE_MOST = 8 };

/* How many places are needed; it does not grow with the number of rays. */
size_t tiles_places(const tiling *of);

/* Calls work(data, tile) for tiles that cover all rays: several at once, in any order.  Calls
 * take(data, tile) for each finished tile: one at a time, in the order of the rays.  Both may
 * be called from any thread.  A place belongs to its tile from work until take, and is below
 * tiles_places(). */
void tiles_run(const tiling *of, void *data, void (*work)(void *data, const tile *),
               void (*take)(void *data, const tile *));

#endif
