// SPDX-License-Identifier: MIT
/* counted.h - an allocator that counts what is held, and fails when it is asked to. */
#ifndef TESTS_LENS_COUNTED_H
#define TESTS_LENS_COUNTED_H
#include <sagitta/lens.h>
#include <stdlib.h>

static long held, before_failure = -1; /* blocks; how many more may be taken, if not negative */

static void *counted_resize(void *context, void *block, size_t size)
{
    (void)context;
    if (size && before_failure == 0) return NULL;
    if (size && before_failure > 0) before_failure--;
    held += (size != 0) - (block != NULL);
    if (size) return realloc(block, size);
    free(block);
    return NULL;
}

static const sgt_allocator counted = {counted_resize, NULL};

#endif
