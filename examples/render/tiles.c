// SPDX-License-Identifier: MIT
/* tiles.c - tiles in threads, by OpenMP.
 *
 * A pixel depends on the scene, its own place and the frame, and on no other pixel: which thread draws
 * it, and when, changes nothing, to the last bit.  Counts are whole numbers and add up in any order.
 * Without OpenMP the same loop runs in one thread. */
#include "tiles.h"

#include "fail.h"
#include "progress.h"
#include "shade.h"

#include <stdlib.h>

#ifdef _OPENMP
#include <omp.h>
#define PRAGMA(words) _Pragma(#words)
#else
#define PRAGMA(words)
#endif

enum { WAVE = 1024 }; /* looks at a time; their rays, as they come and go, stay in the processor's cache */

int tiles_threads(void)
{
#ifdef _OPENMP
    return omp_get_max_threads();
#else
    return 1;
#endif
}

/* The pixels of a tile: from x0, y0 to before x1, y1. */
typedef struct tile { int x0, y0, x1, y1; } tile;

static size_t pixels_of(const tile *t) { return (size_t)(t->x1 - t->x0) * (size_t)(t->y1 - t->y0); }

static pixel pixel_at(const tile *t, const order *o, size_t i)
{
    size_t width = (size_t)(t->x1 - t->x0);
    return (pixel){(uint32_t)(t->x0 + (int)(i % width)), (uint32_t)(t->y0 + (int)(i / width)),
                   (uint32_t)o->frame};
}

static vec3 *place_of(const picture *p, pixel at)
{
    return &p->pixel[(size_t)at.y * (size_t)p->width + at.x];
}

/* All pixels at once, some samples of each at a time: that many looks are one wave. */
static void shine(const scene *s, const view *v, const order *o, const tile *t, picture *p, desk *d,
                  tally *sum)
{
    size_t n = pixels_of(t), samples = (size_t)o->samples, most = n < WAVE ? WAVE / n : 1;
    look *looks = room(NULL, n * most, sizeof *looks);
    for (size_t i = 0; i < n; i++) *place_of(p, pixel_at(t, o, i)) = (vec3){0, 0, 0};
    for (size_t done = 0; done < samples; done += most) {
        size_t count = samples - done < most ? samples - done : most;
        for (size_t i = 0; i < n * count; i++)
            looks[i] = (look){.pixel = pixel_at(t, o, i / count), .index = (uint32_t)(done + i % count)};
        shade(s, v, n * count, looks, d, sum);
        for (size_t i = 0; i < n * count; i++) {
            vec3 *to = place_of(p, looks[i].pixel);
            *to = add(*to, looks[i].light);
        }
    }
    for (size_t i = 0; i < n; i++) {
        vec3 *to = place_of(p, pixel_at(t, o, i));
        *to = scaled(*to, 1.0 / o->samples);
    }
    free(looks);
}

static void keep(const arrays *a, size_t i, const meeting *m)
{
    const double no = (double)NAN;
    const bool hit = m->status > 0;
    const vec3 n = hit ? m->n : (vec3){no, no, no};
    a->depth[i] = hit ? m->t : m->status == 0 ? HUGE_VAL : no;
    a->t_err[i] = hit ? m->t_err : no;
    a->normal[3 * i] = n.x, a->normal[3 * i + 1] = n.y, a->normal[3 * i + 2] = n.z;
    a->status[i] = (signed char)m->status;
}

/* One ray for each pixel, through its middle: painted, or kept. */
static void paint(const scene *s, const view *v, const order *o, const tile *t, picture *p, tally *sum)
{
    size_t n = pixels_of(t);
    beam *b = room(NULL, n, sizeof *b);
    meeting *m = room(NULL, n, sizeof *m);
    for (size_t i = 0; i < n; i++) {
        pixel at = pixel_at(t, o, i);
        b[i] = (beam){.o = v->eye, .d = camera_direction(v, at.x + 0.5, at.y + 0.5), .far = HUGE_VAL};
    }
    meet(s, n, b, m, sum);
    for (size_t i = 0; i < n; i++) {
        vec3 *to = place_of(p, pixel_at(t, o, i));
        if (o->paint != PAINT_LIGHT) *to = (vec3){m[i].evals, m[i].status, 0};
        if (o->arrays) keep(o->arrays, (size_t)(to - p->pixel), &m[i]);
    }
    free(b), free(m);
}

void tiles_render(const scene *s, double along_path, const order *o, picture *p, tally *total)
{
    view v = camera_at(s, along_path);
    int across = (p->width + o->tile - 1) / o->tile, all = across * ((p->height + o->tile - 1) / o->tile);
    progress bar = progress_begin(o->name, all, o->pace);
    PRAGMA(omp parallel num_threads(o->threads))
    {
        desk *d = desk_new();
        PRAGMA(omp for schedule(dynamic))
        for (int i = 0; i < all; i++) {
            int x = i % across * o->tile, y = i / across * o->tile;
            tile t = {x, y, x + o->tile < p->width ? x + o->tile : p->width,
                      y + o->tile < p->height ? y + o->tile : p->height};
            tally sum = {0};
            if (o->paint == PAINT_LIGHT) shine(s, &v, o, &t, p, d, &sum);
            if (o->paint != PAINT_LIGHT || o->arrays) paint(s, &v, o, &t, p, &sum);
            PRAGMA(omp critical)
            {
                tally_add(total, &sum);
                progress_step(&bar);
            }
        }
        desk_free(d);
    }
    progress_end(&bar);
}
