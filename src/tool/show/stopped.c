/* stopped.c - why a ray ended at an element, in words of optics. */
#include "stopped.h"

#include "clipped.h"
#include "frame.h"
#include "profile.h"

#include <math.h>
#include <stdio.h>

static const double DEGREES = 57.295779513082321; /* in a radian */

/* By the tangent, since the cosine of a small angle is 1 to within rounding. */
double stopped_incidence(const sgt_element *e, const arrival *a)
{
    sgt_vec3 n, d = a->direction;
    e->surface.ops->value(e->surface.self, a->p, &n);
    const sgt_vec3 across = {n.y * d.z - n.z * d.y, n.z * d.x - n.x * d.z, n.x * d.y - n.y * d.x};
    return atan2(vector_length(across), fabs(vector_dot(n, d))) * DEGREES;
}

double stopped_critical_angle(const arrival *a) { return asin(fmin(1, a->behind / a->index)) * DEGREES; }

static void print_missed(char text[STOPPED_SIZE], const sgt_element *e, const arrival *a)
{
    const sgt_vec3 at_vertex = vector_along(a->from, a->direction, -a->from.z / a->direction.z);
    if (!profile_is_sag(e->surface))
        snprintf(text, STOPPED_SIZE, "missed it");
    else if (a->direction.z == 0)
        snprintf(text, STOPPED_SIZE, "missed it: it runs parallel to the vertex plane");
    else
        snprintf(text, STOPPED_SIZE, "missed it: its line crosses the vertex plane %.4g from the axis",
                 hypot(at_vertex.x, at_vertex.y));
}

void stopped_print(char text[STOPPED_SIZE], const sgt_element *e, sgt_fate fate, const arrival *a)
{
    char by[CLIPPED_SIZE];
    *text = 0;
    switch (fate) {
    case SGT_CLIPPED:
        clipped_print(by, e, a->p);
        snprintf(text, STOPPED_SIZE, "clipped %s", by);
        break;
    case SGT_TIR:
        snprintf(text, STOPPED_SIZE, "totally reflected: incidence %.4g degrees, critical angle %.4g",
                 stopped_incidence(e, a), stopped_critical_angle(a));
        break;
    case SGT_MISSED:
        print_missed(text, e, a);
        break;
    case SGT_PASSED:
    case SGT_LOST: break;
    }
}
