/* tiles.c - rays in tiles, tiles in threads, results in order.
 *
 * A ray's answer depends on no other ray, and results are taken in the order of the tiles.  So it
 * changes no byte of the output which thread computes a tile, and when.  Tiles go in rounds of
 * several for each thread.  In each round one thread first takes the results of the round before,
 * while the others compute.  A thread that has finished a tile computes the next one, so a hard
 * tile makes others wait at the end of a round only. */
#include "tiles.h"

#include "threads.h"

#ifdef _OPENMP
#include <omp.h>
#endif

int tiles_threads(void)
{
#ifdef _OPENMP
    return omp_get_max_threads();
#else
    return 1;
#endif
}

static size_t least(size_t a, size_t b) { return a < b ? a : b; }

static size_t tile_rays(const tiling *of) { return of->most ? of->most : TILE_RAYS; }

static size_t tiles_of(const tiling *of)
{
    return of->rays / tile_rays(of) + (of->rays % tile_rays(of) != 0);
}

static size_t round_of(const tiling *of) { return of->threads > 1 ? (size_t)of->threads * of->share : 1; }

size_t tiles_places(const tiling *of) { return least(tiles_of(of), of->threads > 1 ? 2 * round_of(of) : 1); }

/* The i-th of the tiles that begin at ray `first` and at place `place`. */
static tile tile_at(const tiling *of, size_t first, size_t place, size_t i)
{
    size_t begin = first + i * tile_rays(of);
    return (tile){place + i, begin, least(of->rays - begin, tile_rays(of))};
}

void tiles_run(const tiling *of, void *data, void (*work)(void *data, const tile *),
               void (*take)(void *data, const tile *))
{
    const size_t size = tile_rays(of), all = tiles_of(of), most = round_of(of), places = tiles_places(of);
    for (size_t begin = 0, before = 0; begin < all || before > 0;) {
        size_t tiles = least(all - begin, most), place = begin % places,
               place_before = (begin - before) % places;
        int several = (int)least((size_t)of->threads, tiles);
        (void)several; /* unused without OpenMP */
        THREADS(omp parallel for schedule(dynamic) num_threads(several > 0 ? several : 1))
        for (size_t i = 0; i <= tiles; i++) {
            for (size_t k = 0; i == 0 && k < before; k++) {
                tile t = tile_at(of, (begin - before) * size, place_before, k);
                take(data, &t);
            }
            if (i == 0) continue;
            tile t = tile_at(of, begin * size, place, i - 1);
            work(data, &t);
        }
        begin += tiles, before = tiles;
    }
}
