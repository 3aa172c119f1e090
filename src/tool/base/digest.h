// SPDX-License-Identifier: MIT
/* digest.h - a number that tells bytes from others: words by FNV-1a, turned so that high bits come down.
 * Each step is one to one, so a word that differs makes another digest.  No guard against intent. */
#ifndef TOOL_DIGEST_H
#define TOOL_DIGEST_H
#include <stddef.h>
#include <stdint.h>
#include <string.h>

static inline uint64_t digest_word(uint64_t h, uint64_t word)
{
    h = (h ^ word) * UINT64_C(0x100000001b3);
    return h << 29 | h >> 35;
}

/* Of bytes, behind those of h. */
static inline uint64_t digest_bytes(uint64_t h, const void *bytes, size_t size)
{
    const char *at = bytes;
    uint64_t word;
    for (h = digest_word(h, size); size >= sizeof word; size -= sizeof word, at += sizeof word)
        memcpy(&word, at, sizeof word), h = digest_word(h, word);
    word = 0;
    if (size) memcpy(&word, at, size);
    return digest_word(h, word);
}

#endif
