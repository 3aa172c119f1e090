// SPDX-License-Identifier: MIT
/* levels.h - `iterations: auto`: as many levels of an orbit as a pixel resolves. */
#ifndef RENDER_LEVELS_H
#define RENDER_LEVELS_H
#include "camera.h"

/* Sets the iterations of each object that has them so, for this view.  *least and *most: over those objects,
 * where they are less or more than they were. */
void levels_choose(scene *s, const view *v, int *least, int *most);

/* The least distance of Q_1 ... Q_N, the orbit of a point in the object's frame, from a quaternion. */
double levels_trap(const object *o, vec3 p, const double trap[4]);

#endif
