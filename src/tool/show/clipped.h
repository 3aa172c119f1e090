/* clipped.h - by what a ray was clipped, in words. */
#ifndef TOOL_CLIPPED_H
#define TOOL_CLIPPED_H
#include <sagitta/system.h>

/* "by its semi_diameter: r = 5.2 is beyond 5", "by aperture 2 (rectangle): 0.3 beyond its edge".  p: the
 * point of the hit, in the element's frame. */
enum { CLIPPED_SIZE = 120 };
void clipped_print(char text[CLIPPED_SIZE], const sgt_element *e, sgt_vec3 p);

#endif
