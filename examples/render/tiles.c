/* tiles.c - tiles in threads, by OpenMP.
 *
 * A pixel depends on the scene, its own place and the frame, and on no other pixel: which thread draws
 * it, and when, changes nothing, to the last bit.  Counts are whole numbers and add up in any order.
 * Without OpenMP the same loop runs in one thread. */
#include "tiles.h"

#include "progress.h"
#include "shade.h"

#ifdef _OPENMP
#include <omp.h>
#define PRAGMA(words) _Pragma(#words)
#else
#define PRAGMA(words)
#endif

enum { TILE = 16 };

int tiles_threads(void)
{
#ifdef _OPENMP
    return omp_get_max_threads();
#else
    return 1;
#endif
}

static vec3 pixel_of(const scene *s, const view *v, const order *o, int x, int y, tally *t)
{
    pixel p = {(uint32_t)x, (uint32_t)y, (uint32_t)o->frame};
    if (o->paint == PAINT_LIGHT) {
        vec3 sum = {0};
        for (int i = 0; i < o->samples; i++) sum = add(sum, shade(s, v, p, (uint32_t)i, t));
        return scaled(sum, 1.0 / o->samples);
    }
    beam b = {.o = v->eye, .d = camera_direction(v, x + 0.5, y + 0.5)};
    meeting m;
    sgt_status status;
    int evals;
    meet(s, &b, HUGE_VAL, &m, t, &status, &evals);
    return (vec3){evals, status, 0};
}

static tally tile(const scene *s, const view *v, const order *o, picture *p, int left, int top)
{
    tally t = {0};
    for (int y = top; y < top + TILE && y < p->height; y++)
        for (int x = left; x < left + TILE && x < p->width; x++)
            p->pixel[(size_t)y * (size_t)p->width + (size_t)x] = pixel_of(s, v, o, x, y, &t);
    return t;
}

void tiles_render(const scene *s, double along_path, const order *o, picture *p, tally *total)
{
    view v = camera_at(s, along_path);
    int across = (p->width + TILE - 1) / TILE, all = across * ((p->height + TILE - 1) / TILE);
    progress bar = progress_begin(o->name, all);
    PRAGMA(omp parallel for schedule(dynamic) num_threads(o->threads))
    for (int i = 0; i < all; i++) {
        tally t = tile(s, &v, o, p, i % across * TILE, i / across * TILE);
        PRAGMA(omp critical)
        {
            tally_add(total, &t);
            progress_step(&bar);
        }
    }
    progress_end(&bar);
}
