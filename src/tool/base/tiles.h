/* tiles.h - many rays, some hundred at a time, in threads. */
#ifndef TOOL_TILES_H
#define TOOL_TILES_H
#include <stddef.h>

enum { TILE_RAYS = 256 };

/* How many threads are meant where none are asked for: the processors, or what
 * OMP_NUM_THREADS says; 1 where the command is built without OpenMP. */
int tiles_threads(void);

/* A piece of the work: rays first ... first + count - 1, and the place it has for itself. */
typedef struct tile { size_t place, first, count; } tile;

/* So many rays in so many threads, in rounds of `share` tiles for each: more of them wait for
 * each other less often, and need more room. */
/* most: rays in a tile, TILE_RAYS at most; 0: that */
typedef struct tiling { size_t rays; int threads; size_t share, most; } tiling;
enum { SHARE_MOST = 32 };

/* How many places are needed. */
size_t tiles_places(const tiling *of);

/* Calls work(data, tile) for tiles that cover all rays, several at a time and in any order,
 * and take(data, tile) for each that is worked out, one at a time and in the order of the
 * rays; both from any thread.  From work to take a place belongs to its tile.  There are at
 * most tiles_places() of them, so that the room they need does not grow with the rays. */
void tiles_run(const tiling *of, void *data, void (*work)(void *data, const tile *),
               void (*take)(void *data, const tile *));

#endif
