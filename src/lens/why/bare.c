// SPDX-License-Identifier: MIT
/* bare.c - a surface without its rim: a copy of its parameters with a semi_diameter of 0. */
#include "bare.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

rimless sgt_bare_of(sgt_surface s)
{
    const sgt_builtin *row = sgt_builtin_of(s);
    rimless b = {.surface = s, .terms = row->family != SGT_FAMILY_CONIC};
    const double *rim = sgt_number_of(s, "semi_diameter"), *c = sgt_number_of(s, "curvature"),
                 *k = sgt_number_of(s, "conic");
    if (!rim) return b;
    b.has_rim = true, b.rim = *rim;
    /* with a curvature_x, c and k belong to one section only */
    if (!sgt_number_of(s, "curvature_x")) b.c = c ? *c : 0, b.k = k ? *k : 0;
    if (row->family == SGT_FAMILY_ASPHERE) { /* of no terms it is a conic */
        const double *a = sgt_number_of(s, "coefficients");
        b.terms = false;
        for (int i = 0; i < 8; i++) b.terms = b.terms || a[i] != 0;
    }
    b.room = malloc(row->size);
    if (!b.room) return b;
    memcpy(b.room, s.self, row->size);
    memset((char *)b.room + ((const char *)rim - (const char *)s.self), 0, sizeof *rim);
    b.surface.self = b.room;
    return b;
}

void sgt_bare_end(rimless *b) { free(b->room); }

double sgt_end_of(const sgt_ray *ray)
{
    const bool none = ray->tmin == 0 && ray->tmax == 0 && !signbit(ray->tmax);
    return none ? HUGE_VAL : ray->tmax + 0.0; /* a -0, of sgt_ray_between, is 0 */
}
