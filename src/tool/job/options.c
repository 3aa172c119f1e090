// SPDX-License-Identifier: MIT
/* options.c - the options that several commands share. */
#include "options.h"

#include "../base/memory.h"
#include "../base/ranks.h"
#include "../base/tiles.h"

#include <limits.h>
#include <string.h>

enum { THREADS_MOST = 1024 };

static const option_row solver_rows[] = {
    {"t-tol", "X",
     "stop when the error of t is below X (lengths of the direction)\n"
     "0 (the default): go on to the limit of rounding",
     OPTION_LENGTH, .to = offsetof(shared_options, solver.t_tol)},
    {"dt-min", "X",
     "only for level sets (julia, mandelbrot): go along the ray in steps of X or more\n"
     "(lengths of the direction).  Faster, but it proves nothing, and thin parts may be\n"
     "skipped",
     OPTION_LENGTH, .to = offsetof(shared_options, solver.dt_min)},
    {"max-evals", "N", "give up on a root after N evaluations of F (default 2000)", OPTION_WHOLE,
     .to = offsetof(shared_options, solver.max_evals), 1, INT_MAX},
    {0},
};
const option_group options_solver = {OPTIONS_SHARED, NULL, .row = solver_rows};

#define OUTPUT_ROWS                                                                    \
    {"output", "FILE", "write to FILE instead of standard output; or -o", OPTION_TEXT, \
     .to = offsetof(shared_options, target.path)},                                     \
    {"hex", NULL, "numbers in hexadecimal", OPTION_FLAG, .to = offsetof(shared_options, target.hexadecimal)}
static const option_row output_rows[] = {
    {"format", "F", "text (for people, the default), csv or json", OPTION_WORD,
     .to = offsetof(shared_options, target.format), .words = "text csv json"},
    OUTPUT_ROWS, {0},
};
static const option_row rows_rows[] = {
    {"format", "F",
     "text (for people, the default), csv, json or npy\n"
     "npy: with --output NAME.npy one array of rows for NumPy; with --output FOLDER an\n"
     "array for each column.  docs/rays.md has types and codes",
     OPTION_WORD, .to = offsetof(shared_options, target.format), .words = "text csv json npy"},
    OUTPUT_ROWS,
    {"columns", "A,B,...", "only these columns, in this order", OPTION_TEXT,
     .to = offsetof(shared_options, target.columns)},
    {"progress", NULL, "say on standard error how far it is; without this only on a terminal", OPTION_FLAG,
     .to = offsetof(shared_options, progress)},
    {0},
};
const option_group options_output = {OPTIONS_SHARED, "Output", .row = output_rows},
                   options_rows = {OPTIONS_SHARED, "Output", .row = rows_rows};

static const option_row threads_rows[] = {
    {"threads", "N",
     "work in N threads; the output does not depend on N\n"
     "Default: what OMP_NUM_THREADS says, else one for each processor",
     OPTION_WHOLE, .to = offsetof(shared_options, threads), 1, THREADS_MOST},
    {0},
};
const option_group options_in_threads = {OPTIONS_SHARED, NULL, .row = threads_rows};

static void take_shard(void *into, const option_row *row, const char *value)
{
    enum { MOST = 1000000 };
    shard_options *o = &((shared_options *)into)->shard;
    char *text = memory_text(value, strlen(value)), *slash = strchr(text, '/');
    if (!slash) fail_usage("--%s must be K/N: 3/7 is the third of seven, not \"%s\"", row->name, value);
    *slash = 0;
    o->of = (int)options_integer(row->name, slash + 1, 1, MOST);
    o->number = (int)options_integer(row->name, text, 1, o->of);
}

static const option_row shard_rows[] = {
    {"shard", "K/N",
     "compute only the K-th of N shares of the rays, and write it to the file of --output\n"
     "sagitta join makes of all N parts what one run writes.  docs/scale.md",
     OPTION_TAKE, .take = take_shard},
    {"resume", NULL, "with --shard: nothing is done if the part is there and whole", OPTION_FLAG,
     .to = offsetof(shared_options, shard.resume)},
    {0},
};
const option_group options_shards = {OPTIONS_SHARED, "For many machines", .row = shard_rows};

void options_shard(shared_options *o, bool alone)
{
    size_t length;
    const char *arguments = command_arguments(&length);
    arguments = memory_text(arguments, length);
    if (o->shard.of && ranks_are()) fail_usage("--shard: not here; the ranks of sagitta-mpi share the work");
    if (o->shard.resume && !o->shard.of && !ranks_are()) fail_usage("--resume goes with --shard K/N");
    if (alone) ranks_alone();
    else if (ranks_all() > 1 || (ranks_are() && o->shard.resume))
        shard_be_rank(o->target.path, o->shard.resume, arguments, length);
    if (o->shard.of) shard_be(&o->shard, o->target.path, arguments, length);
    o->target.nowhere = shard_is();
}

bool options_print(shared_options *o, bool same, bool known, size_t rows)
{
    struct { size_t placed; bool prints; } say = {.prints = same && o->target.format != TABLE_TEXT};
    if (!shard_ranks()) return false;
    if (say.prints && known && o->target.format == TABLE_NPY) say.placed = rows;
    ranks_tell(&say, sizeof say);
    o->target.placed = say.placed;
    return say.prints;
}

void options_note_unread(const shared_options *o, size_t count, const sgt_element element[])
{
    bool set = false, other = false;
    for (size_t i = 0; i < count; i++) {
        set = set || surface_is_level_set(element[i].surface);
        other = other || !surface_is_level_set(element[i].surface);
    }
    if (o->solver.dt_min > 0 && set && o->solver.proof)
        fail_usage("give --proof or --dt-min, not both: the steps of --dt-min prove nothing");
    if (o->solver.dt_min > 0 && !set) note("--dt-min: not used; it is for level sets (julia, mandelbrot)");
    if (o->solver.pick == SGT_NEAR_SEED && !other)
        note("--pick near-seed: not used; on a level set the first root is taken");
}

bool options_near_seed(const shared_options *o, sgt_surface s, sgt_pick by_default)
{
    return (o->solver.pick ? o->solver.pick : by_default) == SGT_NEAR_SEED && !surface_is_level_set(s);
}

sgt_search options_search(const shared_options *o, const sgt_element *e, sgt_pick by_default, sgt_ray own,
                          const sgt_hit *hit)
{
    return (sgt_search){.surface = e->surface, .semi_diameter = e->semi_diameter, .ray = own,
                        .options = &o->solver, .near_seed = options_near_seed(o, e->surface, by_default),
                        .fast = options_fast(o, e->surface), .hit = hit};
}

void options_say_undecided(table *t, const char *who, const sgt_search *s)
{
    char why[WHY_SIZE];
    sgt_why_undecided(s, sizeof why, why);
    table_line(t, "%s%s.", who, why);
}

int options_threads(const shared_options *o)
{
    int most = tiles_threads();
    if (o->threads == 0) return most;
#ifndef _OPENMP
    if (o->threads > 1)
        note("--threads %d: not used; this command is built without OpenMP and works in one thread",
             o->threads);
    return 1;
#else
    return o->threads;
#endif
}
