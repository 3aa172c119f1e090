// SPDX-License-Identifier: MIT
/* pupil.c - a pattern of the pupil in parts, for those outside the library (pattern.c makes its points). */
#include "../base/arena.h"
#include "launch.h"
#include "pattern.h"

sgt_pupil *sgt_pupil_new(sgt_pattern pattern, size_t n, uint64_t seed, const sgt_allocator *allocator)
{
    const sgt_launcher none = {.allocator = sgt_allocator_or(allocator)};
    const size_t rows = sgt_pupil_rows(pattern, n);
    if (rows > SIZE_MAX / sizeof(size_t) - sizeof(sgt_pupil)) return NULL;
    sgt_pupil *p = sgt_launch_take(&none, 1, sizeof *p + rows * sizeof(size_t));
    if (!p) return NULL;
    *p = sgt_pupil_of(pattern, n, seed, (size_t *)(p + 1));
    p->allocator = none.allocator;
    return p;
}

void sgt_pupil_free(sgt_pupil *p)
{
    if (!p) return;
    const sgt_launcher was = {.allocator = p->allocator};
    sgt_launch_forget(&was, p);
}

size_t sgt_pupil_count(const sgt_pupil *p) { return p->count; }
