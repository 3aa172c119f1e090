// SPDX-License-Identifier: MIT
/* tiles.c - rays in tiles, tiles in threads, results in order.
 *
 * A ray's answer depends on no other ray, and results are taken in the order of the tiles.  So it
 * changes no byte of the output which thread computes a tile, and when.
 *
 * A thread works on the next tile that no thread has.  When it has done the tile whose turn it is, it takes
 * that and all behind it that are done, while the other threads work on: so reading and tracing go on while
 * results are written.  A hard tile holds up the others only when they are ahead of it by all places. */
#include "tiles.h"

#include "fail.h"
#include "memory.h"
#include "threads.h"

#include <pthread.h>
#include <stdbool.h>
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

enum { TILES_A_THREAD = 8, TILE_LEAST = 64 }; /* of few rays tiles are small, so that each thread has some */

static size_t least(size_t a, size_t b) { return a < b ? a : b; }

static size_t tile_rays(const tiling *of)
{
    const size_t most = of->most ? of->most : TILE_RAYS;
    const bool divided = of->threads > 1 && !of->fixed;
    const size_t few = divided ? of->rays / ((size_t)of->threads * TILES_A_THREAD) : most;
    return least(most, few > TILE_LEAST ? few : TILE_LEAST);
}

static size_t tiles_of(const tiling *of)
{
    return of->rays / tile_rays(of) + (of->rays % tile_rays(of) != 0);
}

size_t tiles_places(const tiling *of)
{
    return least(tiles_of(of), of->threads > 1 ? (size_t)of->threads * of->share : 1);
}

/* What all threads share; they change it one at a time. */
typedef struct run {
    const tiling *of;
    void *data;
    void (*work)(void *data, const tile *), (*take)(void *data, const tile *);
    size_t tiles, places, next, turn; /* next: to be worked on; turn: to be taken */
    bool taking, *done;               /* [places] */
    pthread_mutex_t lock;
    pthread_cond_t freed;             /* a place was */
} run;

static tile tile_at(const run *r, size_t i)
{
    const size_t first = i * tile_rays(r->of);
    return (tile){i % r->places, r->of->skip + first, least(r->of->rays - first, tile_rays(r->of))};
}

/* Takes all that are done and whose turn it is. */
static void take_done(run *r)
{
    r->taking = true;
    while (r->done[r->turn % r->places]) {
        const tile t = tile_at(r, r->turn);
        pthread_mutex_unlock(&r->lock);
        r->take(r->data, &t);
        pthread_mutex_lock(&r->lock);
        r->done[t.place] = false;
        r->turn++;
        pthread_cond_broadcast(&r->freed);
    }
    r->taking = false;
}

static void run_thread(run *r)
{
    pthread_mutex_lock(&r->lock);
    while (r->next < r->tiles) {
        if (r->next - r->turn == r->places) {
            pthread_cond_wait(&r->freed, &r->lock);
            continue;
        }
        const tile t = tile_at(r, r->next++);
        pthread_mutex_unlock(&r->lock);
        r->work(r->data, &t);
        pthread_mutex_lock(&r->lock);
        r->done[t.place] = true;
        if (!r->taking) take_done(r);
    }
    pthread_mutex_unlock(&r->lock);
}

void tiles_run(const tiling *of, void *data, void (*work)(void *data, const tile *),
               void (*take)(void *data, const tile *))
{
    run r = {.of = of, .data = data, .work = work, .take = take, .tiles = tiles_of(of),
             .places = tiles_places(of), .lock = PTHREAD_MUTEX_INITIALIZER,
             .freed = PTHREAD_COND_INITIALIZER};
    const int threads = (int)least((size_t)(of->threads > 1 ? of->threads : 1), r.tiles);
    if (!r.tiles) return;
    r.done = memory_take(r.places, sizeof *r.done);
    (void)threads; /* unused without OpenMP */
    fail_in_threads(threads > 1);
    THREADS(omp parallel num_threads(threads))
    run_thread(&r);
    fail_in_threads(false);
}
