/* watch.h - --watch FILE: every evaluation of those rays of a batch that were lost, as csv.
 *
 * The columns are those of sagitta diagnose.  Those of a trace have the wavelength in micrometres before the
 * bounds f_lo ... slope_hi; it is empty if the lens gives none.  Rows are in the order of the rays, whatever
 * the number of threads.  Each function may be called for no watch, NULL, and then does nothing. */
#ifndef TOOL_WATCH_H
#define TOOL_WATCH_H
#include "../base/tiles.h"
#include "../job/job.h"

typedef struct watch watch;

/* Makes tiles small enough that the evaluations of all their rays can be kept.  path: NULL if nothing is
 * watched. */
void watch_tiling(tiling *in, const char *path, const sgt_options *opt);

/* Opens the file of --watch, for tiles at so many places; elements: of the lens, 0 for a single surface.
 * path NULL: there is no watch. */
watch *watch_begin(const char *path, bool hexadecimal, size_t places, size_t elements);

/* Repeats a lost ray and keeps its evaluations at the place of its tile.  all: as for --all. */
void watch_trace(watch *w, size_t place, const job_lens *at, const launch *l, const sgt_options *opt);
void watch_intersect(watch *w, size_t place, sgt_surface s, const launch *l, const sgt_options *opt,
                     bool all);

/* Writes what is kept at a place: for each tile in turn, after its rays. */
void watch_take(watch *w, size_t place);

void watch_end(watch *w);

#endif
