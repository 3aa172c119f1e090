// SPDX-License-Identifier: MIT
/* wavefront.h - sums over path differences. */
#ifndef SGT_STUDY_WAVEFRONT_H
#define SGT_STUDY_WAVEFRONT_H
#include <sagitta/analysis.h>

/* Of weight w about the mean; rays that have a difference. */
typedef struct sgt_wavefront_sum { size_t rays, passed; double w, mean, square, least, most, off;
} sgt_wavefront_sum;

void sgt_wavefront_add(sgt_wavefront_sum *s, size_t count, const sgt_ray_end end[], const double opd[],
                       const double error[]); /* s is zero */
void sgt_wavefront_join(sgt_wavefront_sum *s, const sgt_wavefront_sum *more);
double sgt_wavefront_rms_error(const sgt_wavefront_sum *s);
sgt_wavefront sgt_wavefront_sum_of(const sgt_wavefront_sum *s);

#endif
