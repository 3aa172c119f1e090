// SPDX-License-Identifier: MIT
/* move.h - the origin of a ray moved along it. */
#ifndef SGT_RAY_MOVE_H
#define SGT_RAY_MOVE_H

#include <sagitta/sagitta.h>

/* Moves the origin of the ray along it, exactly: *moved has the same line and direction, and its origin is
 * o + t0 d, three doubles without rounding.  Returns t0, which is near `about`.  Returns 0 if no such t0
 * is found; *moved is then the ray itself. */
double sgt_move_exactly(const sgt_ray *ray, double about, sgt_ray *moved);

#endif
