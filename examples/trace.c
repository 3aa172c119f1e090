// SPDX-License-Identifier: MIT
/* trace.c - a lens of two surfaces: each ray of a fan through it, and where it crosses the axis.
 *
 * An element is a surface, a pose, the index behind it and a clear aperture; elements are met in
 * the order given.  The singlet here is plano-convex, flat side last, and the fan shows its
 * spherical aberration: marginal rays cross the axis before the paraxial focus. */
#include <math.h>
#include <sagitta/surfaces.h>
#include <sagitta/system.h>
#include <stdio.h>

int main(void)
{
    sgt_conic front = {.c = 1 / 51.68}, back = {0};
    sgt_element lens[] = {
        {.surface = {&sgt_conic_ops, &front}, .index = 1.5168, .semi_diameter = 12.7},
        {.surface = {&sgt_conic_ops, &back},
         .pose = {.origin = {0, 0, 5}},
         .index = 1,
         .semi_diameter = 12.7},
    };
    double paraxial = 51.68 / 0.5168 - 5 / 1.5168, last = paraxial; /* behind the flat face */

    for (int i = 1; i <= 6; i++) {
        sgt_ray ray = {.o = {0, 2.0 * i, -10}, .d = {0, 0, 1}};
        sgt_passage passages[2];
        sgt_fate fate;
        size_t passed = sgt_trace(2, lens, 1, &ray, passages, &fate, NULL);
        if (passed != 2) {
            printf("height %4.1f: %s at element %zu\n", 2.0 * i, sgt_fate_text(fate), passed + 1);
            return 1;
        }
        /* ray starts at the last point passed, in the global frame */
        double focus = ray.o.z - ray.o.y * ray.d.z / ray.d.y - 5;
        printf("height %4.1f: crosses the axis %.6f behind the lens, path %.9f\n", 2.0 * i, focus,
               passages[1].opl);
        if (!(focus < last)) return 1; /* each nearer than the one before */
        last = focus;
    }
    return !(fabs(paraxial - last) < 10);
}
