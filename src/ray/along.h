// SPDX-License-Identifier: MIT
/* along.h - a departure along a ray is a polynomial: what that says of the whole way at once (along.c). */
#ifndef SGT_RAY_ALONG_H
#define SGT_RAY_ALONG_H

#include "vicinity.h"

/* What is known of a ray from some t on. */
typedef enum along_says { ALONG_SILENT, ALONG_CLEAR, ALONG_MISS, ALONG_ROOT } along_says;

/* Looks along row i of v, from t on, which is not behind `from` on the ray.
 *
 *     ALONG_SILENT   nothing is said
 *     ALONG_CLEAR    no root is in [from, *clear], and *clear > from
 *     ALONG_MISS     no root is on the ray from `from` on
 *     ALONG_ROOT     no root is before v->lo[i]; v->lo, hi, least and seed are set (vicinity.h)
 *
 * Evaluations are counted in v, and told.  ray: that of row i. */
along_says sgt_look_along(sgt_surface s, const sgt_ray *ray, double from, vicinities *kept, const vicinity *v,
                          size_t i, double *clear);

#endif
