/* profile.h - the shape of an element, asked of the library as rays are. */
#ifndef TOOL_PROFILE_H
#define TOOL_PROFILE_H
#include <sagitta/system.h>
#include <stdbool.h>

/* Is it one, F = z - s(x, y)?  What is not, a level set, has no vertex and no profile. */
bool profile_is_sag(sgt_surface s);

/* z of the surface at x, y of its own frame, the sheet at the vertex; NaN: none there. */
double profile_sag(const sgt_element *e, double x, double y);

/* The curvature of the section x = 0 at the vertex, from the gradient at y = step;
 * step is to be small beside the radius.  NaN where there is none. */
double profile_curvature(const sgt_element *e, double step);

#endif
