// SPDX-License-Identifier: MIT
/* camera.h - from a point of the picture to a direction in the world. */
#ifndef RENDER_CAMERA_H
#define RENDER_CAMERA_H
#include "scene.h"

/* direction = corner + x right + y down, in pixels */
typedef struct view { vec3 eye, right, down, corner; } view;

/* Is there a direction ahead, and one to the right, at u of its paths? */
bool camera_is_good(const scene *s, double u);

/* At u of its paths, from 0 to 1. */
view camera_at(const scene *s, double u);
vec3 camera_direction(const view *v, double x, double y); /* of unit length */

#endif
