// SPDX-License-Identifier: MIT
/* aperture.h - the items of an element's aperture: sound or not, and what they clip. */
#ifndef SGT_SYSTEM_APERTURE_H
#define SGT_SYSTEM_APERTURE_H

#include "../num/exact.h"
#include "../num/room.h"
#include <sagitta/system.h>

/* Is every item as its shape needs it?  A polygon is looked at vertex by vertex.  The others below are
 * given sound lists only. */
bool sgt_aperture_sound(const sgt_aperture *a);

/* The index of the first item that clips the point; SGT_BY_NONE if none does. */
int sgt_aperture_clips(const sgt_aperture *a, double x, double y);

/* Sets good[i] to verdict, which is below 0, if it is above 0 and some item clips the point.  Returns how
 * many are above 0 then. */
size_t sgt_aperture_clips_tile(const sgt_aperture *a, size_t n, const double x[], const double y[],
                               double verdict, double good[]);

/* What an aperture does to all points of a box: 1 none is clipped, -1 all are, 0 it is not certain.  *away: a
 * distance in x and y that all points are from where one is clipped, at least; of 1 only. */
int sgt_aperture_over(const sgt_aperture *a, sgt_interval x, sgt_interval y, double *away);

#endif
