// SPDX-License-Identifier: MIT
/* sample.h - points of the unit square that depend on the pixel and on nothing else. */
#ifndef RENDER_SAMPLE_H
#define RENDER_SAMPLE_H
#include <stdint.h>

enum { SAMPLE_MOST = 1 << 14 };

typedef struct pixel { uint32_t x, y, frame; } pixel;

/* The index-th point of the pixel's own sequence number `which`: the first 2^k are
 * spread as evenly over the square as 2^k points can be, and sequences of unlike pixels or
 * numbers have nothing to do with each other.  Each coordinate is in [0, 1). */
void sample_square(pixel p, uint32_t which, uint32_t index, double *u, double *v);

#endif
