// SPDX-License-Identifier: MIT
/* tree.h - sums of blocks, merged in a tree that hangs on the blocks' numbers alone.
 *
 * Block i is a leaf.  Two neighbours 2 k, 2 k + 1 of a level make number k of the level above, wherever both
 * are.  So whoever has the blocks from first to last has some whole branches of the tree, log2 of the blocks
 * at most up and as many down; branches that are put together make the same tree, and sums that round come
 * out with the same bits.  What is left when all blocks are there (their number need not be a power of two)
 * is merged from the last branch to the first.
 *
 * Sums that do not round (`exact`) need no tree: all that is there is one branch. */
#ifndef SGT_STUDY_TREE_H
#define SGT_STUDY_TREE_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* A branch: level 0 is a block.  Its sum stands beside it, in `sums`. */
typedef struct sum_branch { uint64_t level, number; } sum_branch;

typedef struct sum_tree {
    size_t size, apart;         /* bytes of a sum, and from one to the next */
    bool exact;                 /* the order of merges has no part in a bit */
    void (*merge)(const void *data, void *into, const void *more);
    const void *data;
    size_t branches, most;
    sum_branch *branch;         /* [most] */
    char *sums;                 /* of as many */
} sum_tree;

/* How many branches there may be of so many blocks, while they are put one behind the other. */
static inline size_t sgt_tree_most(size_t blocks)
{
    size_t most = 4;
    for (; blocks > 1; blocks /= 2) most += 2;
    return most;
}

/* Bytes that the sums of a tree take. */
static inline size_t sgt_tree_apart(size_t size) { return (size + 63) / 64 * 64; }

static inline void *sgt_tree_sum(const sum_tree *t, size_t i) { return t->sums + i * t->apart; }

/* Puts a branch behind those that are there. */
void sgt_tree_put(sum_tree *t, sum_branch at, const void *sum);

/* Merges what is left, and empties the tree; its sum, NULL of no blocks.  It lasts until the next put. */
void *sgt_tree_end(sum_tree *t);

#endif
