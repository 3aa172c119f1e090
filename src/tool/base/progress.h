// SPDX-License-Identifier: MIT
/* progress.h - how far the command is, on standard error, once it has lasted two seconds. */
#ifndef TOOL_PROGRESS_H
#define TOOL_PROGRESS_H
#include <stdbool.h>
#include <stddef.h>

/* Begins to count rays; 0: it is not known how many there are.  Nothing is shown unless standard error is a
 * terminal, and the data do not go to one.  With `forced` it is always shown; in
 * lines, if standard error is no terminal. */
void progress_begin(size_t rays, bool data_on_standard_output, bool forced);

/* They are no rays but these: "boxes". */
void progress_of(const char *things);

/* So many are done.  Not in two threads at once. */
void progress_add(size_t rays);

/* For ranks: share k of `of` is begun, of a pass (from 0) that has so many rays (0: it is not known); k > of:
 * the pass is done.  Those of progress_add, which are only some, are then not counted. */
void progress_share(size_t pass, size_t k, size_t of, size_t rays);
void progress_rays(size_t rays); /* so many it were */

/* All are done: clears the line, or with `forced` says how long it took. */
void progress_end(void);

#endif
