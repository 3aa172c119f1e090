// SPDX-License-Identifier: MIT
/* part.h - the file of one shard of a run: what it is of, and records, one after another (docs/scale.md). */
#ifndef TOOL_PART_H
#define TOOL_PART_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* What a part is of: this is number 1 ... of; the arguments that all parts share, each with a zero byte
 * behind it, the command first; and a digest of what was read. */
typedef struct part_of_run {
    uint64_t number, of, digest;
    const char *arguments;
    size_t length;              /* bytes of the arguments */
} part_of_run;

/* Writes to a temporary file beside the path, which part_end renames; brief: it need not outlast a failure of
 * power.  A fault ends the command, with the name, and leaves neither. */
void part_begin(const char *path, const part_of_run *of, bool brief);
void part_put(const void *bytes, size_t size);
void part_end(void);

/* A part that is read. */
typedef struct run_part {
    const char *path;
    part_of_run of;
    const char *file, *bytes, *end; /* all of it; its records */
    size_t records;
    const char **record;        /* [records]: where each begins */
    size_t next;                /* for those that read one after another */
} run_part;

/* NULL, or why it is no whole part of this version. */
const char *part_read(const char *path, run_part *out);

/* Its i-th record; NULL: there is none. */
const void *part_record(const run_part *p, size_t i, size_t *size);

/* Nothing of it is read any more. */
void part_leave(run_part *p);

#endif
