// SPDX-License-Identifier: MIT
/* pattern.h - a pattern of the pupil in parts. */
#ifndef SGT_OPTICS_PATTERN_H
#define SGT_OPTICS_PATTERN_H
#include <sagitta/lens.h>
#include <stdint.h>

enum { PUPIL_PART = 128 };

struct sgt_pupil {
    sgt_pattern pattern;
    size_t n, count;
    uint64_t seed;
    double sum;                   /* of the weights */
    const size_t *row;
    const sgt_pupil_point *given; /* single points; NULL: the pattern */
    bool equal;                   /* each weighs 1 / count */
    sgt_allocator allocator;      /* of one that was made by sgt_pupil_new */
};

/* How many numbers `row` of sgt_pupil_of needs. */
size_t sgt_pupil_rows(sgt_pattern pattern, size_t n);

/* The pattern.  row lasts as long as it is used. */
sgt_pupil sgt_pupil_of(sgt_pattern pattern, size_t n, uint64_t seed, size_t row[]);

#endif
