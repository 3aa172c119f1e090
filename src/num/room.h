// SPDX-License-Identifier: MIT
/* room.h - what a public struct reserves for later versions (`reserved_`): is it zero?
 *
 * A program compiled for a later version may have set a member there that this library does not know.
 * The length is that of the struct's own reserved_, so a struct that grows needs no change here. */
#ifndef SGT_NUM_ROOM_H
#define SGT_NUM_ROOM_H

#include <stdbool.h>
#include <stddef.h>

static inline bool words_are_zero(const unsigned long long *word, size_t count)
{
    unsigned long long any = 0;
    for (size_t i = 0; i < count; i++) any |= word[i];
    return any == 0;
}

#define ROOM_IS_ZERO(of) words_are_zero((of)->reserved_, sizeof(of)->reserved_ / sizeof *(of)->reserved_)

#endif
