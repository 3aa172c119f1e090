// SPDX-License-Identifier: MIT
/* progress.h - a bar on standard error, where that is a terminal. */
#ifndef RENDER_PROGRESS_H
#define RENDER_PROGRESS_H

typedef struct progress { const char *name; int done, all, shown; double began; } progress;

progress progress_begin(const char *name, int all);
void progress_step(progress *p); /* by one thread at a time */
void progress_end(progress *p);  /* takes the bar away */

#endif
