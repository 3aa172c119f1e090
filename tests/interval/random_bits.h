// SPDX-License-Identifier: MIT
/* random_bits.h - the random numbers of test_fma.c, test_elementary.c, test_pair.c and test_functions.c. */
#ifndef RANDOM_BITS_H
#define RANDOM_BITS_H

#include <stdint.h>

static uint64_t state;

static inline uint64_t random_bits(void) /* splitmix64 (Steele, Lea & Flood 2014) */
{
    uint64_t z = (state += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

#endif
