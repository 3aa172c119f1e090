/* nearest.h - how near a line that misses a surface comes to it. */
#ifndef TOOL_NEAREST_H
#define TOOL_NEAREST_H
#include <sagitta/sagitta.h>
#include <stdbool.h>

typedef struct nearest {
    bool known;        /* else nothing was found near */
    double distance;   /* length */
    double t;          /* the place on the line, in lengths of its direction */
    sgt_vec3 p;        /* the point of the surface that is nearest to it */
} nearest;

/* An estimate, of the whole line of a ray that misses.  A part of the surface that is small beside the
 * distance may be overlooked; then the distance is too large. */
nearest nearest_approach(sgt_surface s, const sgt_ray *ray);

#endif
