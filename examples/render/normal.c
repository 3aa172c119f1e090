// SPDX-License-Identifier: MIT
/* normal.c - three normals of a level set, to be compared.
 *
 * The gradient of F is exact, and on the level set of a long orbit it is as rough as the set.
 * Central differences cost six more values and are smooth over a step; the step, 2^-17 of the
 * distance from the frame's origin, is near where rounding and curvature do equal harm.  The
 * potential log|Q_n| / p^n does not depend on where the orbit is cut off: its level sets close in on the set
 * as smooth surfaces, and its gradient is the smooth normal. */
#include "normal.h"

#include <sagitta/surfaces.h>

static vec3 difference(const object *o, vec3 p)
{
    double h = 0x1p-17 * fmax(length(p), 0x1p-10);
    double (*value)(const void *, vec3, vec3 *) = o->surface.ops->value;
    const void *self = o->surface.self;
    return (vec3){value(self, (vec3){p.x + h, p.y, p.z}, NULL) - value(self, (vec3){p.x - h, p.y, p.z}, NULL),
                  value(self, (vec3){p.x, p.y + h, p.z}, NULL) - value(self, (vec3){p.x, p.y - h, p.z}, NULL),
                  value(self, (vec3){p.x, p.y, p.z + h}, NULL) -
                      value(self, (vec3){p.x, p.y, p.z - h}, NULL)};
}

vec3 normal_at(const object *o, vec3 p, vec3 gradient)
{
    vec3 n = {0};
    if (o->normal == NORMAL_DIFFERENCE) n = difference(o, p);
    if (o->normal == NORMAL_POTENTIAL && o->surface.ops == &sgt_julia_ops)
        sgt_julia_potential(o->surface.self, p, &n);
    if (o->normal == NORMAL_POTENTIAL && o->surface.ops == &sgt_mandelbrot_ops)
        sgt_mandelbrot_potential(o->surface.self, p, &n);
    double size = length(n);
    /* the gradient, or where the other says nothing */
    if (!(size > 0 && size < HUGE_VAL)) n = gradient, size = length(n);
    return size > 0 && size < HUGE_VAL ? scaled(n, 1 / size) : (vec3){0};
}
