// SPDX-License-Identifier: MIT
/* sample.c - Sobol' points, scrambled by a counter-based generator.
 *
 * A generator without a state, Philox 4x32-10 (Salmon, Moraes, Dror, Shaw: Parallel random numbers, SC 2011),
 * makes four random words of (sequence, x, y, frame).  They are seeds: one shuffles the index, two
 * scramble the coordinates of a two-dimensional Sobol' point in the manner of Owen, by which every
 * binary cell keeps its one point; the hash that does so is Laine and Karras's with N. Vegdahl's
 * constants (B. Burley, Practical hash-based Owen scrambling, JCGT 9 (2020) 4).  No order of
 * pixels, and so no number of threads, changes a point. */
#include "sample.h"

static void philox(uint32_t c[4])
{
    uint32_t k0 = 0x5a617469, k1 = 0x73616769; /* any key does */
    for (int round = 0; round < 10; round++, k0 += 0x9e3779b9, k1 += 0xbb67ae85) {
        uint64_t a = (uint64_t)0xd2511f53 * c[0], b = (uint64_t)0xcd9e8d57 * c[2];
        uint32_t n0 = (uint32_t)(b >> 32) ^ c[1] ^ k0, n2 = (uint32_t)(a >> 32) ^ c[3] ^ k1;
        c[0] = n0, c[1] = (uint32_t)b, c[2] = n2, c[3] = (uint32_t)a;
    }
}

static uint32_t reversed(uint32_t x)
{
    x = (x & 0x55555555) << 1 | (x >> 1 & 0x55555555);
    x = (x & 0x33333333) << 2 | (x >> 2 & 0x33333333);
    x = (x & 0x0f0f0f0f) << 4 | (x >> 4 & 0x0f0f0f0f);
    x = (x & 0x00ff00ff) << 8 | (x >> 8 & 0x00ff00ff);
    return x << 16 | x >> 16;
}

/* Each bit is changed by those above it alone. */
static uint32_t scrambled(uint32_t x, uint32_t seed)
{
    x = reversed(x);
    x ^= x * 0x3d20adea;
    x += seed;
    x *= seed >> 16 | 1;
    x ^= x * 0x05526c56;
    x ^= x * 0x53a22864;
    return reversed(x);
}

/* Two dimensions of Sobol': van der Corput's sequence, and the one of Pascal's triangle modulo 2. */
static uint32_t second(uint32_t index)
{
    uint32_t x = 0;
    for (uint32_t v = 1u << 31; index; index >>= 1, v ^= v >> 1)
        if (index & 1) x ^= v;
    return x;
}

void sample_square(pixel p, uint32_t which, uint32_t index, double *u, double *v)
{
    uint32_t seed[4] = {which, p.x, p.y, p.frame};
    philox(seed);
    uint32_t i = scrambled(index, seed[0]);
    *u = 0x1p-32 * scrambled(reversed(i), seed[1]);
    *v = 0x1p-32 * scrambled(second(i), seed[2]);
}
