/* stopped.h - why a ray ended at an element, in words of optics. */
#ifndef TOOL_STOPPED_H
#define TOOL_STOPPED_H
#include <sagitta/system.h>

/* A ray as it came to an element, in the element's frame: from the point before, or the launch. */
typedef struct arrival {
    sgt_vec3 from, direction;   /* of unit length */
    sgt_vec3 p;                 /* where it was met; unless it was missed */
    double index, behind;       /* of the media in front and behind */
} arrival;

/* In degrees: the angle between the ray and the normal where it is met, and the least one of total
 * reflection (90: there is none). */
double stopped_incidence(const sgt_element *e, const arrival *a);
double stopped_critical_angle(const arrival *a);

/* "clipped by its semi_diameter ...", "totally reflected: incidence 53.1 degrees, critical angle 41.2",
 * "clipped by aperture 2 (rectangle): 0.3 beyond its edge", "missed it: its line crosses the vertex plane 20
 * from the axis"; empty for a ray that passed or was lost. */
const char *stopped_why(const sgt_element *e, sgt_fate fate, const arrival *a);

#endif
