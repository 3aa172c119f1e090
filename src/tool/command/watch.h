// SPDX-License-Identifier: MIT
/* watch.h - --watch FILE: every evaluation of those rays of a batch that were lost, or of one ray, as csv.
 *
 * The columns are those of sagitta diagnose.  Those of a trace have the wavelength in micrometres before the
 * bounds f_lo ... slope_hi; it is empty if the lens gives none.  Rows are in the order of the rays, whatever
 * the number of threads.  Each function may be called for no watch, NULL, and then does nothing. */
#ifndef TOOL_WATCH_H
#define TOOL_WATCH_H
#include "../base/tiles.h"
#include "../job/job.h"

typedef struct watch watch;

/* What is watched.  Rows of OPTIONS_OWN whose struct has one as `watched`. */
typedef struct watch_options {
    const char *path; /* NULL: nothing */
    const char *ray;  /* only this one, lost or not; NULL: those that are lost */
    int element;      /* only there, from 1; 0: at all */
} watch_options;
#define WATCH_RAY_OPTION(arguments)                                                                 \
    {                                                                                               \
        "watch-ray", "I", "with --watch: of ray I alone, lost or not, counted from 0", OPTION_TEXT, \
            .to = offsetof(arguments, watched.ray)                                                  \
    }

/* Makes tiles small enough that the evaluations of all their rays can be kept.  path: NULL if nothing is
 * watched. */
void watch_tiling(tiling *in, const char *path, const sgt_options *opt);

/* Opens the file of --watch, for tiles at so many places; elements: of the lens, 0 for a single surface.
 * o->path NULL: there is no watch. */
watch *watch_begin(const watch_options *o, bool hexadecimal, size_t places, size_t elements);

/* Repeats a ray, if it is one to watch, and keeps its evaluations at the place of its tile.  all: as for
 * --all. */
void watch_trace(watch *w, size_t place, const job_lens *at, const launch *l, const sgt_options *opt,
                 bool lost);
void watch_intersect(watch *w, size_t place, sgt_surface s, const launch *l, const sgt_options *opt, bool all,
                     bool lost);

/* Writes what is kept at a place: for each tile in turn, after its rays. */
void watch_take(watch *w, size_t place);

void watch_end(watch *w);

#endif
