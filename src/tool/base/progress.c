// SPDX-License-Identifier: MIT
/* progress.c - one line that is written over, with no colour and no sign but a return. */
#include "progress.h"

#include "ranks.h"

#include <stdio.h>
#include <time.h>
#include <unistd.h>

static const double SILENT = 2, EVERY = 0.5, EVERY_LINE = 5; /* s */

static struct {
    size_t all, done;
    size_t before, pass, share, shares; /* of ranks; before: the rays of passes that are done */
    bool shown, forced, terminal;
    double start, last;
    int length;      /* of the line that is on the terminal */
    const char *things; /* that are counted; NULL: rays */
} progress;

static double progress_now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

void progress_of(const char *things) { progress.things = things; }

void progress_begin(size_t rays, bool data_on_standard_output, bool forced)
{
    const bool terminal = isatty(STDERR_FILENO) == 1;
    progress.all = rays, progress.done = 0, progress.length = 0;
    progress.terminal = terminal, progress.forced = forced, progress.things = NULL;
    progress.shown = forced || (terminal && !(data_on_standard_output && isatty(STDOUT_FILENO) == 1));
    if (ranks_here()) progress.shown = progress.forced = false;
    progress.start = progress_now(), progress.last = progress.start + SILENT;
}

static void show_line(double seconds)
{
    const double part = (double)progress.done / (double)progress.all;
    fprintf(stderr, progress.terminal ? "\r" : "sagitta: ");
    const int length =
        progress.things ? fprintf(stderr, "%zu %s, %.0f s", progress.done, progress.things, seconds)
        : progress.all ? fprintf(stderr, "%zu of %zu rays, %.0f %%, %.0f s, %.0f s left", progress.done,
                               progress.all, 100 * part, seconds, seconds / part - seconds)
                     : fprintf(stderr, "pass %zu, block %zu of %zu, %.0f s", progress.pass + 1,
                               progress.share, progress.shares, seconds);
    const int shorter = progress.length > length ? progress.length - length : 0;
    if (progress.terminal) fprintf(stderr, "%*s", shorter, "");
    else fputc('\n', stderr);
    progress.length = length;
    fflush(stderr);
}

static void show_at_times(void)
{
    if (!progress.shown) return;
    const double now = progress_now();
    if (now < progress.last) return;
    progress.last = now + (progress.terminal ? EVERY : EVERY_LINE);
    if (progress.done < progress.all || !progress.all) show_line(now - progress.start);
}

void progress_add(size_t rays)
{
    if (progress.shares) return;
    progress.done += rays;
    show_at_times();
}

void progress_share(size_t pass, size_t k, size_t of, size_t rays)
{
    progress.pass = pass, progress.share = k, progress.shares = of;
    progress.done = progress.before + (k > of ? rays : (size_t)((double)rays * (double)(k - 1) / (double)of));
    if (k > of) progress.before += rays;
    else show_at_times();
}

void progress_rays(size_t rays) { progress.done = rays; }

void progress_end(void)
{
    const double seconds = progress_now() - progress.start;
    if (progress.terminal && progress.length) fprintf(stderr, "\r%*s\r", progress.length, "");
    if (progress.forced && progress.things)
        fprintf(stderr, "sagitta: %zu %s, %.1f s\n", progress.done, progress.things, seconds);
    else if (progress.forced)
        fprintf(stderr, "sagitta: %zu rays, %.1f s, %.4g rays a second\n", progress.done, seconds,
                seconds > 0 ? (double)progress.done / seconds : 0);
}
