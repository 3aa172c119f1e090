// SPDX-License-Identifier: MIT
/* bytes.h - bytes that grow at their end. */
#ifndef TOOL_BYTES_H
#define TOOL_BYTES_H
#include "memory.h"

#include <string.h>

typedef struct bytes { char *at; size_t length, capacity; } bytes;

/* Makes room for `more` bytes; returns where they go. */
static inline char *bytes_room(bytes *b, size_t more)
{
    if (b->capacity - b->length < more) {
        b->capacity = 2 * b->capacity + more;
        b->at = memory_grow(b->at, b->capacity, 1);
    }
    return b->at + b->length;
}

static inline void bytes_put(bytes *b, const void *from, size_t length)
{
    if (length == 0) return; /* of nothing, `from` may be null, and memcpy takes no null */
    memcpy(bytes_room(b, length), from, length);
    b->length += length;
}

static inline void bytes_text(bytes *b, const char *text) { bytes_put(b, text, strlen(text)); }
static inline void bytes_one(bytes *b, char c) { *bytes_room(b, 1) = c, b->length++; }

#endif
