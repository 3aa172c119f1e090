// SPDX-License-Identifier: MIT
/* progress.c - how far it has come, and how long it will take at this pace. */
#include "progress.h"

#include <stdio.h>
#include <time.h>
#include <unistd.h>

enum { BAR = 40, PARTS = 200 };

double progress_now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

progress progress_begin(const char *name, int all, pace of)
{
    return (progress){.name = name, .all = isatty(STDERR_FILENO) ? all : 0, .shown = -1,
                      .began = of.all ? of.began : progress_now(), .pace = of.all ? of : (pace){.all = 1}};
}

void progress_step(progress *p)
{
    p->done++;
    if (!p->all || p->done * PARTS / p->all == p->shown) return;
    p->shown = p->done * PARTS / p->all;
    double spent = progress_now() - p->began, done = p->pace.done + (double)p->done / p->all,
           left = spent / done * (p->pace.all - done);
    char bar[BAR + 1];
    for (int i = 0; i < BAR; i++) bar[i] = i < p->done * BAR / p->all ? '#' : '.';
    bar[BAR] = 0;
    fprintf(stderr, "\r%s [%s] %3d %%  %.0f s left \033[K", p->name, bar, 100 * p->done / p->all, left);
}

void progress_end(progress *p)
{
    if (p->all) fputs("\r\033[K", stderr);
}
