// SPDX-License-Identifier: MIT
/* tree.c - branches put one behind the other, and merged where two are neighbours (tree.h). */
#include "tree.h"

#include <string.h>

/* Merges the last branch into the one before. */
static void merge_last(sum_tree *t)
{
    t->branches--;
    t->merge(t->data, sgt_tree_sum(t, t->branches - 1), sgt_tree_sum(t, t->branches));
}

void sgt_tree_put(sum_tree *t, sum_branch at, const void *sum)
{
    if (t->exact && t->branches) {
        t->merge(t->data, sgt_tree_sum(t, 0), sum);
        return;
    }
    memcpy(sgt_tree_sum(t, t->branches), sum, t->size);
    t->branch[t->branches++] = at;
    while (t->branches > 1) {
        sum_branch *left = &t->branch[t->branches - 2], right = t->branch[t->branches - 1];
        if (left->level != right.level || left->number % 2 || left->number + 1 != right.number) return;
        *left = (sum_branch){left->level + 1, left->number / 2};
        merge_last(t);
    }
}

void *sgt_tree_end(sum_tree *t)
{
    const bool any = t->branches > 0;
    while (t->branches > 1) merge_last(t);
    t->branches = 0;
    return any ? sgt_tree_sum(t, 0) : NULL;
}
