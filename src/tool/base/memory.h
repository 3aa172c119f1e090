// SPDX-License-Identifier: MIT
/* memory.h - memory that lasts until the command ends, and is freed then. */
#ifndef TOOL_MEMORY_H
#define TOOL_MEMORY_H
#include "fail.h"

#include <stddef.h>

/* Room for `count` things of `size` bytes, zeroed.  Never NULL: without memory the command ends. */
void *memory_take(size_t count, size_t size);

/* Resizes a block to `count` things; new bytes are not zeroed.  For NULL it makes a new block. */
void *memory_grow(void *block, size_t count, size_t size);

/* Frees a block before the end: a large one, of which nothing is needed any more.  NULL: nothing. */
void memory_drop(void *block);

/* A copy of `length` bytes, with a zero byte behind them. */
char *memory_text(const char *text, size_t length);

/* A text as printf makes it, of any length. */
char *memory_print(const char *format, ...) LIKE_PRINTF(1, 2);

/* Makes room for one more: if `count` has reached *capacity, doubles it. */
void *memory_room(void *data, size_t count, size_t *capacity, size_t size);

#endif
