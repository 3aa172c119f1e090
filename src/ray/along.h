// SPDX-License-Identifier: MIT
/* along.h - a departure along a ray is a polynomial: what that says of the whole way at once (along.c). */
#ifndef SGT_RAY_ALONG_H
#define SGT_RAY_ALONG_H

#include "vicinity.h"

/* What is known of a ray from some t on. */
typedef enum along_says { ALONG_SILENT, ALONG_CLEAR, ALONG_MISS, ALONG_ROOT } along_says;

enum { ALONG_ROWS = 8 };

/* Looks along these rows of v, at most ALONG_ROWS, each from its t on.
 *
 *     ALONG_SILENT   nothing is said
 *     ALONG_CLEAR    no root is from there on up to t, which is later than it was
 *     ALONG_MISS     no root is from there on
 *     ALONG_ROOT     none is before lo of v; lo, hi, least and seed of v are set, and asked is 0
 *
 * Evaluations are counted in v, and told.  What a row is answered does not depend on the others. */
void sgt_look_along(sgt_surface s, const sgt_rays *r, size_t count, const size_t row[], double t[],
                    along_says said[], vicinities *kept, const vicinity *v);

/* The same for a sag of revolution that has a profile (profile.c); false: it has none. */
bool sgt_look_by_profile(sgt_surface s, const sgt_rays *r, size_t count, const size_t row[], double t[],
                         along_says said[], vicinities *kept, const vicinity *v);

#endif
