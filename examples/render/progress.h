// SPDX-License-Identifier: MIT
/* progress.h - a bar on standard error, where that is a terminal. */
#ifndef RENDER_PROGRESS_H
#define RENDER_PROGRESS_H

/* Of several pictures: how many are done, of how many, and when the first began (progress_now). */
typedef struct pace { int done, all; double began; } pace;
double progress_now(void); /* seconds */

typedef struct progress { const char *name; int done, all, shown; double began; pace pace; } progress;

/* With a pace the time left is that of all pictures. */
progress progress_begin(const char *name, int all, pace of);
void progress_step(progress *p); /* by one thread at a time */
void progress_end(progress *p);  /* takes the bar away */

#endif
