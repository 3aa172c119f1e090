/* stopped.c - why a ray ended at an element, in words of optics. */
#include "stopped.h"

#include "clipped.h"
#include "frame.h"

#include <math.h>
#include <stdio.h>

static const double DEGREES = 57.295779513082321; /* in a radian */

/* The angle between the direction and the normal at p, in degrees. */
static double incidence(const sgt_element *e, const arrival *a)
{
    sgt_vec3 n;
    e->surface.ops->value(e->surface.self, a->p, &n);
    return acos(fmin(1, fabs(vector_dot(n, a->direction)) / vector_length(n))) * DEGREES;
}

void stopped_print(char text[STOPPED_SIZE], const sgt_element *e, sgt_fate fate, const arrival *a)
{
    char by[CLIPPED_SIZE];
    sgt_vec3 at_vertex;
    *text = 0;
    switch (fate) {
    case SGT_CLIPPED:
        clipped_print(by, e, a->p);
        snprintf(text, STOPPED_SIZE, "clipped %s", by);
        break;
    case SGT_TIR:
        snprintf(text, STOPPED_SIZE, "totally reflected: incidence %.4g degrees, critical angle %.4g",
                 incidence(e, a), asin(fmin(1, a->behind / a->index)) * DEGREES);
        break;
    case SGT_MISSED:
        at_vertex = vector_along(a->from, a->direction, -a->from.z / a->direction.z);
        snprintf(text, STOPPED_SIZE, "missed it: its line crosses the vertex plane %.4g from the axis",
                 hypot(at_vertex.x, at_vertex.y));
        break;
    case SGT_PASSED:
    case SGT_LOST: break;
    }
}
