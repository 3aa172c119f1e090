// SPDX-License-Identifier: MIT
/* ranks.h - the programs that work on one run together: those of mpirun, counted from 0 (ranks_mpi.c); or
 * this one alone (ranks_alone.c).
 *
 * All of them run the same command with the same arguments.  Each reads the input; shares of the work are
 * handed out one by one (shard.h).  Rank 0 writes what the command writes. */
#ifndef TOOL_RANKS_H
#define TOOL_RANKS_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Begins, before anything is read or said. */
void ranks_begin(int *argc, char **argv[]);

bool ranks_are(void);  /* is this the command for ranks, even if there is one alone? */
int  ranks_here(void); /* which one this is */
int  ranks_all(void);

/* What is asked for cannot be divided: the other ranks end here, and rank 0 goes on alone. */
void ranks_alone(void);

/* All are here, and have read the same bytes, whose digest this is.  If one has failed before, all end; if
 * one has read other bytes, the run is ended with its name. */
void ranks_meet(uint64_t digest);

/* Bytes of rank 0, for all. */
void ranks_tell(void *bytes, size_t size);

/* Text of standard input, which rank 0 alone has, for all. */
void ranks_tell_text(char **text, size_t *length);

/* A file that all open together, write to at places of their own, and close together.  path: that of
 * --output, for messages; name: where it is.  A fault ends the command. */
typedef struct ranks_file ranks_file;
ranks_file *ranks_open(const char *path, const char *name);
void ranks_write(ranks_file *f, size_t at, const void *bytes, size_t size); /* one thread at a time */
void ranks_close(ranks_file *f);

/* A number that no other rank has got since ranks_wait: 0, 1, 2, ... */
size_t ranks_next(void);

/* To be called now and then by rank 0, so that nobody waits for a number; one thread at a time. */
void ranks_serve(void);

/* Waits for all.  ranks_next then begins anew. */
void ranks_wait(void);

#endif
