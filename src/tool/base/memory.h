/* memory.h - memory that lasts until the command ends, and is freed then. */
#ifndef TOOL_MEMORY_H
#define TOOL_MEMORY_H
#include <stddef.h>

/* Room for `count` things of `size` bytes, zeroed; never NULL (the command ends). */
void *memory_take(size_t count, size_t size);

/* The same block with room for `count` things; what is new is not zeroed.  NULL: a new one. */
void *memory_grow(void *block, size_t count, size_t size);

/* A copy that ends in a zero byte. */
char *memory_text(const char *text, size_t length);

/* Room for one more: doubles *capacity when `count` has reached it. */
void *memory_room(void *data, size_t count, size_t *capacity, size_t size);

#endif
