// SPDX-License-Identifier: MIT
/* memory.c - a ring of blocks, each freed when the command ends.
 *
 * The command reads a file, answers and ends, so hardly anything is worth freeing before.  An error
 * may end it anywhere (fail.c).  A ring of all blocks makes both simple.  Threads change it
 * one at a time. */
#include "memory.h"

#include "fail.h"
#include "threads.h"

#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct block { struct block *before, *after; max_align_t data[]; } block;

static block ring = {&ring, &ring};

static void free_all(void)
{
    while (ring.after != &ring) {
        block *b = ring.after;
        ring.after = b->after;
        free(b);
    }
    ring.before = &ring;
}

/* Ends without freeing: other threads may be using the blocks. */
_Noreturn static void end(const char *why)
{
    note("%s", why);
    _Exit(EXIT_BAD_INPUT);
}

/* A new block is zeroed, and by calloc: pages that are never touched are then none of the process. */
static block *sized(block *old, size_t count, size_t size)
{
    if (size > 0 && count > (SIZE_MAX - sizeof(block)) / size) end("more memory asked for than there can be");
    const size_t all = sizeof(block) + count * size;
    block *b = old ? realloc(old, all) : calloc(1, all);
    if (!b) end("out of memory");
    return b;
}

static block *grown(block *old, size_t count, size_t size)
{
    static int registered;
    if (!registered) registered = atexit(free_all) == 0;
    block *before = old ? old->before : &ring, *after = old ? old->after : ring.after;
    block *b = sized(old, count, size);
    b->before = before, b->after = after;
    before->after = b, after->before = b;
    return b;
}

void *memory_grow(void *data, size_t count, size_t size)
{
    block *b = data ? (block *)(void *)((char *)data - offsetof(block, data)) : NULL;
    THREADS(omp critical (memory))
    b = grown(b, count, size);
    return b->data;
}

void memory_drop(void *data)
{
    if (!data) return;
    block *b = (block *)(void *)((char *)data - offsetof(block, data));
    THREADS(omp critical (memory))
    {
        b->before->after = b->after;
        b->after->before = b->before;
    }
    free(b);
}

void *memory_take(size_t count, size_t size) { return memory_grow(NULL, count, size); }

char *memory_text(const char *text, size_t length)
{
    char *copy = memory_grow(NULL, length + 1, 1);
    memcpy(copy, text, length);
    copy[length] = 0;
    return copy;
}

char *memory_print(const char *format, ...)
{
    va_list values, again;
    va_start(values, format);
    va_copy(again, values);
    const int length = vsnprintf(NULL, 0, format, values);
    char *text = memory_take((size_t)length + 1, 1);
    vsnprintf(text, (size_t)length + 1, format, again);
    va_end(again);
    va_end(values);
    return text;
}

void *memory_room(void *data, size_t count, size_t *capacity, size_t size)
{
    if (count < *capacity) return data;
    *capacity = *capacity ? 2 * *capacity : 16;
    return memory_grow(data, *capacity, size);
}
