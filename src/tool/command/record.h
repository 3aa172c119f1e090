// SPDX-License-Identifier: MIT
/* record.h - what a shard keeps of a tile, array after array, and who joins takes back (base/shard.h). */
#ifndef TOOL_RECORD_H
#define TOOL_RECORD_H
#include "../base/bytes.h"
#include "../base/fail.h"
#include "../show/table.h"

#include <stdbool.h>

/* Both ways: arrays are put into `put`, or (NULL) taken from `at`. */
typedef struct keeping { bytes *put; const char *at, *end; } keeping;

static inline void record_bytes(keeping *r, void *array, size_t size)
{
    if (r->put) {
        bytes_put(r->put, array, size);
        return;
    }
    if ((size_t)(r->end - r->at) < size) fail_input("a part of this run has a tile that is too short");
    if (size) memcpy(array, r->at, size);
    r->at += size;
}

/* count things of an array. */
#define RECORD(r, array, count) record_bytes(r, array, (count) * sizeof *(array))

/* The rows of a part of a table, as they are printed; those that are put are not in the part any more. */
static inline void record_rows(keeping *r, table *part)
{
    RECORD(r, table_rows(part), 1);
    for (size_t i = 0; i < table_arrays(part); i++) {
        bytes *b = table_printed(part, i);
        RECORD(r, &b->length, 1);
        const size_t length = b->length;
        if (!r->put) b->length = 0, bytes_room(b, length), b->length = length;
        record_bytes(r, b->at, length);
    }
    if (r->put) table_drop(part);
}

#endif
