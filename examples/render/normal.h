// SPDX-License-Identifier: MIT
/* normal.h - which way a surface faces. */
#ifndef RENDER_NORMAL_H
#define RENDER_NORMAL_H
#include "scene.h"

/* At a point, where F's gradient is this: toward growing F, of unit length, in the object's own frame; zero
 * where there is none. */
vec3 normal_at(const object *o, vec3 p, vec3 gradient);

#endif
