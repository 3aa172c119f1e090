// SPDX-License-Identifier: MIT
/* view.h - from where a picture shows a lens: the plane it is drawn on. */
#ifndef TOOL_VIEW_H
#define TOOL_VIEW_H
#include <sagitta/system.h>
#include <stdbool.h>

/* VIEW_YZ, VIEW_XZ: z to the right, and y or x up.  VIEW_3D: from beside, in front and above, without
 * perspective, so that circles are ellipses and parallel rays stay parallel. */
typedef enum view_plane { VIEW_YZ, VIEW_XZ, VIEW_3D } view_plane;

/* Axes of the picture, of length 1, in the global frame.  toward: from the lens to who looks. */
typedef struct view_axes { view_plane plane; sgt_vec3 right, up, toward; } view_axes;

/* A point of the picture, in lengths of the lens. */
typedef struct spot { double right, up; } spot;

view_axes view_of(view_plane plane);

/* "y-z section", for a title. */
const char *view_title(view_plane plane);

spot view_spot(const view_axes *v, sgt_vec3 p);

#endif
