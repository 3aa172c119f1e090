/* profile.c - sag and vertex curvature of any surface that has them.
 *
 * A surface that has a sag is told by its gradient: of z - s(x, y) dF/dz is 1, exactly, at
 * any z; of a level set it is not, at the two points of the axis that are looked at.
 *
 * The sag is where a line parallel to z meets the surface.  The curvature: on the surface
 * the slope of the section is s'(y) = -F_y / F_z, and s'(y) = C y + O(y^3), so the gradient
 * at y = h gives C = -F_y / (F_z h) to a relative (C h)^2, and to rounding: the gradient is
 * worked out, not differenced.  On an even asphere that is c + 2 a_1, as it should be. */
#include "profile.h"

#include <math.h>

bool profile_is_sag(sgt_surface s)
{
    sgt_vec3 low, high;
    s.ops->value(s.self, (sgt_vec3){0, 0, 0}, &low);
    s.ops->value(s.self, (sgt_vec3){0, 0, 1}, &high);
    return low.z == 1 && high.z == 1;
}

double profile_sag(const sgt_element *e, double x, double y)
{
    if (!profile_is_sag(e->surface)) return (double)NAN;
    sgt_ray line = {.o = {x, y, 0}, .d = {0, 0, 1}, .tmin = -HUGE_VAL, .tmax = HUGE_VAL};
    sgt_hit hit = sgt_intersect(e->surface, line, &(sgt_options){.pick = SGT_NEAR_SEED});
    return hit.status > 0 ? hit.p.z : (double)NAN;
}

double profile_curvature(const sgt_element *e, double step)
{
    if (!profile_is_sag(e->surface)) return (double)NAN;
    sgt_vec3 slope;
    double f = e->surface.ops->value(e->surface.self, (sgt_vec3){0, step, 0}, &slope);
    double c = -slope.y / (slope.z * step);
    return isfinite(f) && isfinite(c) ? c : (double)NAN;
}
