// SPDX-License-Identifier: MIT
/* watch.c - --watch FILE: every evaluation of those rays of a batch that were lost, or of one.
 *
 * A batch under a watcher would run ray by ray.  So the batch runs without one.  A ray that is to be watched
 * is answered once more by itself, under a watcher.  A batch gives the same bits as single rays, so these are
 * the evaluations that it took in the batch.  This is done in the thread of the ray's tile, and the rows wait
 * at the place of the tile until it is its turn. */
#include "watch.h"

#include "watched.h"
#include "../base/input.h"
#include "../base/memory.h"
#include "../../text/number.h"

#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

static const char watch_head[] = "ray,element,eval,move,t,f,slope,lo,hi";

enum {
    EVALS_MOST = 1 << 18,   /* of the rays of a tile, if each spends all it may: some 32 MB as text */
    SHARE_WATCHED = 2,
    ROW_SIZE = 12 * NUMBER_SIZE + 80
};

/* The lost rays of a tile. */
typedef struct watch_part {
    watched ray;             /* the one that is repeated; its record serves single surfaces, too */
    char *text;
    size_t length, capacity;
} watch_part;

struct watch {
    const char *path;
    FILE *file;
    bool hexadecimal;
    long ray;                /* -1: those that are lost */
    size_t element;          /* from 1; 0: all */
    watch_part *part;        /* [places] */
};

void watch_tiling(tiling *in, const char *path, const sgt_options *opt)
{
    const size_t evals = opt->max_evals ? (size_t)opt->max_evals : 2000 /* sagitta.h */;
    const size_t most = evals < EVALS_MOST ? EVALS_MOST / evals : 1;
    if (!path) return;
    if (in->most == 0 || in->most > most) in->most = most < TILE_RAYS ? most : TILE_RAYS;
    if (in->share > SHARE_WATCHED) in->share = SHARE_WATCHED;
}

watch *watch_begin(const watch_options *o, bool hexadecimal, size_t places, size_t elements)
{
    const char *path = o->path;
    if (!path && (o->ray || o->element)) fail_usage("--watch-ray and --watch-element go with --watch FILE");
    if (!path) return NULL;
    if ((size_t)o->element > elements) fail_usage("--watch-element %d: there are %zu", o->element, elements);
    const long ray = o->ray ? options_integer("watch-ray", o->ray, 0, LONG_MAX) : -1;
    output_reserve("watch", path);
    watch *w = memory_take(1, sizeof *w);
    *w = (watch){.path = path,
                 .file = fopen(path, "wb"),
                 .hexadecimal = hexadecimal,
                 .ray = ray,
                 .element = (size_t)o->element,
                 .part = memory_take(places, sizeof *w->part)};
    if (!w->file) fail_input("--watch %s: %s", path, strerror(errno));
    fprintf(w->file, "%s%s,f_lo,f_hi,slope_lo,slope_hi\n", watch_head, elements ? ",wavelength" : "");
    for (size_t i = 0; i < places; i++) w->part[i].ray = watched_room(elements);
    return w;
}

/* The i-th evaluation of a ray at an element.  behind: what stands before the bounds. */
static void watch_write(const watch *w, watch_part *p, size_t ray, size_t element, const record *r, size_t i,
                        const char *behind)
{
    const sgt_step *s = &r->step[i];
    const double numbers[] = {s->t, s->f, s->slope, s->lo, s->hi, s->f_lo, s->f_hi, s->slope_lo, s->slope_hi};
    if (p->capacity - p->length < ROW_SIZE) {
        p->capacity = 2 * p->capacity + ROW_SIZE;
        p->text = memory_grow(p->text, p->capacity, 1);
    }
    char *to = p->text + p->length;
    to += snprintf(to, ROW_SIZE, "%zu,%zu,%zu,%s", ray, element + 1, i + 1, sgt_move_text(s->move));
    for (int k = 0; k < 9; k++) {
        if (k == 5) to += snprintf(to, NUMBER_SIZE + 2, "%s", behind);
        *to++ = ',';
        to += number_print(to, numbers[k], w->hexadecimal);
    }
    *to++ = '\n';
    p->length = (size_t)(to - p->text);
}

static bool to_watch(const watch *w, const launch *l, bool lost)
{
    return w && (w->ray < 0 ? lost : l->number == (size_t)w->ray);
}

void watch_trace(watch *w, size_t place, const job_lens *at, const launch *l, const sgt_options *opt,
                 bool lost)
{
    char behind[NUMBER_SIZE + 2] = ",", um[NUMBER_SIZE] = "";
    if (!to_watch(w, l, lost)) return;
    watch_part *p = &w->part[place];
    if (!isnan(at->lens.wavelength)) number_print(um, at->lens.wavelength, w->hexadecimal);
    snprintf(behind, sizeof behind, ",%s", um);
    watched_trace(&p->ray, at->element, at->lens.index_before, &l->ray, opt);
    for (size_t i = 0; i < p->ray.count; i++) {
        const record r = watched_at(&p->ray, i);
        for (size_t k = 0; k < r.count && (!w->element || w->element == i + 1); k++)
            watch_write(w, p, l->number, i, &r, k, behind);
    }
}

void watch_intersect(watch *w, size_t place, sgt_surface s, const launch *l, const sgt_options *opt, bool all,
                     bool lost)
{
    if (!to_watch(w, l, lost)) return;
    watch_part *p = &w->part[place];
    record *r = &p->ray.all;
    sgt_options own = *opt;
    own.watch = record_watch, own.watch_data = r;
    r->count = 0;
    if (all) sgt_intersect_all(s, l->ray, 0, NULL, &own);
    else sgt_intersect(s, l->ray, &own);
    for (size_t k = 0; k < r->count; k++) watch_write(w, p, l->number, 0, r, k, "");
}

void watch_take(watch *w, size_t place)
{
    if (!w) return;
    watch_part *p = &w->part[place];
    if (p->length) fwrite(p->text, 1, p->length, w->file);
    p->length = 0;
}

void watch_end(watch *w)
{
    if (!w) return;
    bool bad = fflush(w->file) != 0 || ferror(w->file);
    if (fclose(w->file) != 0 || bad) fail_input("--watch %s: could not be written", w->path);
}
