/* stopped.c - why a ray ended at an element, in words of optics. */
#include "stopped.h"

#include "../base/memory.h"
#include "frame.h"
#include "profile.h"

#include <math.h>

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

static const char *clipped_how(const sgt_element *e, sgt_vec3 p)
{
    static const char *const shapes[] = {"",        "circle",  "annulus", "rectangle",
                                         "ellipse", "polygon", "spider"};
    const sgt_clipping by = sgt_clipped_by(e, p);
    const char *side = by.size > by.limit ? "beyond" : "within";
    if (by.by == SGT_BY_SEMI_DIAMETER)
        return memory_print("clipped by its semi_diameter: r = %.9g is beyond %.9g", by.size, by.limit);
    if (by.by < 0) return "clipped at its edge";
    const sgt_aperture_item *item = &e->aperture->items[by.by];
    const char *where = item->shape == SGT_CIRCLE || item->shape == SGT_ANNULUS
                            ? memory_print("r = %.9g is %s %.9g", by.size, side, by.limit)
                            : memory_print("%.3g %s its edge", by.size,
                                           item->obscuring ? "within" : "beyond");
    return memory_print("clipped by aperture %d (%s%s): %s", by.by + 1, shapes[item->shape],
                        item->obscuring ? ", obscuring" : "", where);
}

static const char *missed_how(const sgt_element *e, const arrival *a)
{
    const sgt_vec3 at_vertex = vector_along(a->from, a->direction, -a->from.z / a->direction.z);
    if (!profile_is_sag(e->surface)) return "missed it";
    if (a->direction.z == 0) return "missed it: it runs parallel to the vertex plane";
    return memory_print("missed it: its line crosses the vertex plane %.4g from the axis",
                        hypot(at_vertex.x, at_vertex.y));
}

const char *stopped_why(const sgt_element *e, sgt_fate fate, const arrival *a)
{
    switch (fate) {
    case SGT_CLIPPED: return clipped_how(e, a->p);
    case SGT_TIR:
        return memory_print("totally reflected: incidence %.4g degrees, critical angle %.4g",
                            stopped_incidence(e, a), stopped_critical_angle(a));
    case SGT_MISSED: return missed_how(e, a);
    case SGT_PASSED:
    case SGT_LOST: break;
    }
    return "";
}
