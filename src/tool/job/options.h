// SPDX-License-Identifier: MIT
/* options.h - the options that several commands share. */
#ifndef TOOL_OPTIONS_H
#define TOOL_OPTIONS_H
#include "../read/surface.h"
#include "../base/shard.h"
#include "../show/table.h"
#include "parse.h"

#include <sagitta/why.h>

typedef struct shared_options {
    table_target target;
    sgt_options solver;
    int threads;          /* 0: not given */
    bool progress;
    const char *picture;  /* NULL: none */
    int weights;          /* 1: each ray counts alike */
    shard_options shard;
} shared_options;

/* --format, --output, --hex; the same with --columns, --progress and npy for a row for each ray. */
extern const option_group options_output, options_rows;
extern const option_group options_solver;  /* --t-tol, --dt-min, --max-evals */
extern const option_group options_in_threads;
extern const option_group options_shards;  /* --shard, --resume */

/* With --shard this run becomes that shard, and prints nothing; with several ranks it becomes one of them,
 * and only rank 0 prints.  alone: what was asked for cannot be divided among ranks. */
void options_shard(shared_options *o, bool alone);

/* With several ranks: does each print its own rows?  It can, but for text, if all have the `same` columns.
 * If it is `known` how many rows there will be, each writes those of npy where they belong: the target then
 * has `placed`.  Rank 0 decides. */
bool options_print(shared_options *o, bool same, bool known, size_t rows);

/* Rows of OPTIONS_SHARED, with what they mean to a command. */
#define PICK_OPTION(help)                                                                              \
    {"pick", "P", help, OPTION_WORD, .to = offsetof(shared_options, solver.pick), .least = SGT_FIRST, \
     .words = "first near-seed"}
#define PROOF_OPTION(help)                                                                               \
    {"proof", "P", help, OPTION_WORD, .to = offsetof(shared_options, solver.proof), .least = SGT_ESTIMATE, \
     .words = "estimate root first"}

/* Is this surface searched in the fast way of --dt-min?  Its answers then claim less. */
static inline bool options_fast(const shared_options *o, sgt_surface s)
{
    return o->solver.dt_min > 0 && surface_is_level_set(s);
}

/* Is the root near the seed asked for?  by_default: the pick without --pick.  Never on a level set, which has
 * no seed. */
bool options_near_seed(const shared_options *o, sgt_surface s, sgt_pick by_default);

/* A search by the library as the options ask for it, for why.h. */
sgt_search options_search(const shared_options *o, const sgt_element *e, sgt_pick by_default, sgt_ray own,
                          const sgt_hit *hit);

enum { UNDECIDED_SHOWN = 4,   /* how many undecided rays are explained */
       WHY_SIZE = 600 };      /* room for a text of why.h */

/* Prints a line that begins with `who`: the stretch of the ray still in doubt, and why. */
void options_say_undecided(table *t, const char *who, const sgt_search *s);

/* How many threads to work in.  Notes on standard error if --threads cannot be used. */
int options_threads(const shared_options *o);

/* Notes on standard error if --dt-min or --pick was given and no element uses it.  Ends with a usage error if
 * --dt-min and --proof are given for the same element. */
void options_note_unread(const shared_options *o, size_t count, const sgt_element element[]);

#endif
