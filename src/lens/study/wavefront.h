// SPDX-License-Identifier: MIT
/* wavefront.h - sums over path differences. */
#ifndef SGT_STUDY_WAVEFRONT_H
#define SGT_STUDY_WAVEFRONT_H
#include "exact.h"

#include <sagitta/analysis.h>

/* Weighted sums of differences and of their squares; of rays that have one (`passed`). */
typedef struct sgt_wavefront_sum { size_t rays, passed; double least, most, off; exact w, first, square;
} sgt_wavefront_sum;

void sgt_wavefront_add(sgt_wavefront_sum *s, size_t count, const sgt_ray_end end[], const double opd[],
                       const double error[]);
void sgt_wavefront_merge(sgt_wavefront_sum *s, const sgt_wavefront_sum *more);
/* The index in front of the last element. */
double sgt_index_of_image(size_t count, const sgt_element e[], double index_before);

double sgt_wavefront_rms_error(const sgt_wavefront_sum *s);
sgt_wavefront sgt_wavefront_sum_of(const sgt_wavefront_sum *s);

#endif
