// SPDX-License-Identifier: MIT
/* shard.h - is this run whole, one shard of several, or the join of their parts?
 *
 * A shard works on a run of the tiles or blocks of a command, and writes what was computed of them to its
 * part.  Who joins runs the same command, and has all that from the parts in place of computing it: so what
 * is written then is what one run writes, to the byte. */
#ifndef TOOL_SHARD_H
#define TOOL_SHARD_H
#include "part.h"
#include "tiles.h"

/* What --shard K/N and --resume say. */
typedef struct shard_options { int number, of; bool resume; } shard_options;

/* This run is a shard; its part goes to `path`.  arguments: those that all shards share. */
void shard_be(const shard_options *o, const char *path, const char *arguments, size_t length);

/* This run is one of several ranks (ranks.h), who take small shares as they become free, and leave their
 * parts in a folder beside `path` (NULL: one that is gone in the end).  Rank 0 joins those of each pass when
 * all are there; the others are shards all the time.  shard_clear removes the folder, when what was asked for
 * is written. */
void shard_be_rank(const char *path, bool resume, const char *arguments, size_t length);
void shard_clear(void);

/* This run joins these parts, which are all of a run.  A fault ends the command, with the name of a part. */
void shard_join(int count, char *const path[]);

bool shard_is(void);    /* one of several */
bool shard_joins(void);

/* Of ranks: is a part that is there kept?  shard_forget: none is, as what belongs to them is gone. */
bool shard_keeps(void);
void shard_forget(void);

/* The arguments of the parts that are joined. */
const part_of_run *shard_joined(void);

/* Everything is read, and all ranks are here.  A shard begins to write; with --resume, if its part is whole,
 * the command ends here.  Who joins compares the digest of what was read (input.h) with that of the parts. */
void shard_begin(void);

/* Ends a shard: its part is whole. */
void shard_end(void);

/* The most that shard_run works on at once: the same tiles, whatever the threads; of a shard only some. */
tiling shard_tiling(tiling whole);

/* tiles_run of what this run has of the whole: all of it, a share, share after share; or all that the shares
 * have left. */
void shard_run(const tiling *whole, void *data, void (*work)(void *data, const tile *),
               void (*take)(void *data, const tile *));

/* Of who joins: what was put for a tile in the pass-th run of tiles, each of which has `rays` rays. */
const void *shard_tile(const tiling *of, size_t pass, const tile *t, size_t *size);

/* Of a study: as sgt_shard (study.h) asks for it.  shard_write is for tiles, too. */
bool shard_write(void *context, size_t size, const void *bytes);
bool shard_read(void *context, size_t number, size_t size, void *bytes);
size_t shard_next(void *context, size_t of);
bool shard_ranks(void);    /* are there several, each of which asks shard_next? */
size_t shard_number(void); /* 0: who joins */
size_t shard_count(void);  /* 0: a whole run */

#endif
