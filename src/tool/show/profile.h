/* profile.h - the shape of an element, found by asking the library. */
#ifndef TOOL_PROFILE_H
#define TOOL_PROFILE_H
#include <sagitta/system.h>
#include <stdbool.h>

/* The z of the surface at x, y of its own frame, on the sheet of the vertex; NaN if there is none. */
double profile_sag(const sgt_element *e, double x, double y);

/* The section of any other surface by a plane through its origin as short strokes, in its own frame.  The
 * plane has the axes `across` and `along`, of length 1 and at right angles.  It is looked for within `reach`
 * of the axis `along`; or all of it if it has no clear aperture and is not much wider.  Parts smaller than
 * reach / 64 may be missing.  Returns how many strokes; *stroke lasts until the command ends. */
size_t profile_section(const sgt_element *e, double reach, sgt_vec3 across, sgt_vec3 along,
                       sgt_vec3 (**stroke)[2]);

#endif
