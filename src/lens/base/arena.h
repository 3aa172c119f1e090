// SPDX-License-Identifier: MIT
/* arena.h - memory that is freed all at once: blocks that stay where they are. */
#ifndef SGT_LENS_ARENA_H
#define SGT_LENS_ARENA_H
#include <sagitta/lens.h>

typedef struct block block;

typedef struct arena {
    sgt_allocator allocator;
    block *blocks;
    size_t left; /* bytes at the end of the first block */
} arena;

/* The allocator of the caller, or (NULL) that of the C library. */
sgt_allocator sgt_allocator_or(const sgt_allocator *allocator);

/* Memory aligned for any type, not zeroed; NULL: there is none. */
void *sgt_arena_take(arena *a, size_t size);

/* The same, aligned for what is no larger than a pointer. */
void *sgt_arena_pack(arena *a, size_t size);

/* A copy of `length` bytes with a zero byte behind them; NULL: no memory. */
char *sgt_arena_text(arena *a, const char *text, size_t length);

void sgt_arena_free(arena *a);

#endif
