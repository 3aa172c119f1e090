// SPDX-License-Identifier: MIT
/* arena.c - memory that is freed all at once.
 *
 * Small things are cut from blocks of 16 KiB, so that a lens of 10^5 surfaces is not millions of
 * calls of the allocator; a large one has a block of its own, behind the one that is being cut. */
#include "arena.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

struct block {
    block *next;
    size_t size;
    max_align_t data[];
};

enum { BLOCK = 16 << 10, ALIGNED = sizeof(max_align_t) };

static void *plain_resize(void *context, void *memory, size_t size)
{
    (void)context;
    if (size) return realloc(memory, size);
    free(memory);
    return NULL;
}

sgt_allocator sgt_allocator_or(const sgt_allocator *allocator)
{
    return allocator ? *allocator : (sgt_allocator){.resize = plain_resize};
}

/* All sizes are multiples of a pointer's. */
static void *take(arena *a, size_t size, size_t aligned)
{
    if (size > SIZE_MAX / 2) return NULL;
    size = (size + aligned - 1) / aligned * aligned;
    const size_t apart = a->left % aligned;
    if (size + apart <= a->left) {
        a->left -= apart;
        char *data = (char *)a->blocks->data + a->blocks->size - a->left;
        a->left -= size;
        return data;
    }
    bool own = size > BLOCK / 4;
    size_t whole = own ? size : BLOCK;
    block *b = a->allocator.resize(a->allocator.context, NULL, sizeof *b + whole);
    if (!b) return NULL;
    b->size = whole;
    if (own && a->blocks) {
        b->next = a->blocks->next, a->blocks->next = b;
    } else {
        b->next = a->blocks, a->blocks = b, a->left = whole - size;
    }
    return b->data;
}

void *sgt_arena_take(arena *a, size_t size) { return take(a, size, ALIGNED); }

void *sgt_arena_pack(arena *a, size_t size) { return take(a, size, sizeof(void *)); }

char *sgt_arena_text(arena *a, const char *text, size_t length)
{
    char *copy = sgt_arena_take(a, length + 1);
    if (copy && length) memcpy(copy, text, length);
    if (copy) copy[length] = 0;
    return copy;
}

void sgt_arena_free(arena *a)
{
    for (block *b = a->blocks, *next; b; b = next) {
        next = b->next;
        a->allocator.resize(a->allocator.context, b, 0);
    }
    a->blocks = NULL, a->left = 0;
}
