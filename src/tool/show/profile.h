/* profile.h - the shape of an element, asked of the library as rays are. */
#ifndef TOOL_PROFILE_H
#define TOOL_PROFILE_H
#include <sagitta/system.h>
#include <stdbool.h>

/* Is it one, F = z - s(x, y)?  What is not, a body or a level set, has no vertex and no profile. */
bool profile_is_sag(sgt_surface s);

/* z of the surface at x, y of its own frame, the sheet at the vertex; NaN: none there. */
double profile_sag(const sgt_element *e, double x, double y);

/* The curvature of the section x = 0 at the vertex, from the gradient at y = step;
 * step is to be small beside the radius.  NaN where there is none. */
double profile_curvature(const sgt_element *e, double step);

/* The section x = 0 of any other surface, in short strokes: two points (0, y, z) of its own frame for each,
 * |y| <= reach, or all of it where it has no clear aperture and is not much wider.  Parts smaller than
 * reach / 64 may be left out.  *stroke is memory of the command's; returns how many. */
size_t profile_section(const sgt_element *e, double reach, sgt_vec3 (**stroke)[2]);

#endif
