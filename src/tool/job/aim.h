/* aim.h - rays aimed at the stop, and fields aimed at the image. */
#ifndef TOOL_AIM_H
#define TOOL_AIM_H
#include "launch.h"

/* Where the search for a ray begins: at the ray before it. */
typedef struct aim_start { bool known; sgt_vec2 pupil, at; } aim_start;

/* The height of the marginal ray at the stop. */
double aim_stop_radius(const launch_how *how);

/* Sets l->ray to the ray of the beam through q times the radius of the stop.  false: there is none, or none
 * was found; counted, and noted for the first few. */
bool aim_ray(launch_how *how, const lens *traced, const beam *b, sgt_vec2 q, launch *l, aim_start *start);

/* Sets the point or direction of the beam so that its chief ray meets the image at the height `at`.  If
 * none is found the command ends. */
void aim_field(const launch_how *how, beam *b, sgt_lens_field at);

#endif
