// SPDX-License-Identifier: MIT
/* conic.c - where does a ray meet a sphere, and how sure is the answer? */
#include <sagitta/surfaces.h>

#include <math.h>
#include <stdio.h>

int main(void)
{
    /* The first surface of a scan lens: radius -2.2136, so the centre of curvature is at -z.
     * A surface is a table of operations and the parameters they work on. */
    sgt_conic lens = {.c = 1 / -2.2136, .k = 0, .semi_diameter = 2};
    sgt_surface surface = {&sgt_conic_ops, &lens};

    /* A ray is o + t d.  Its ends are left at zero: all of it from o on. */
    sgt_ray ray = {.o = {0, 0.5, -5}, .d = {0, 0.3420201433256687, 0.9396926207859084}};

    sgt_hit hit = sgt_intersect(surface, ray, NULL);
    printf("%s at t = %.17g, right within %.2g\n", sgt_status_text(hit.status), hit.t, hit.t_err);
    printf("point (%.15g, %.15g, %.15g), normal (%.6f, %.6f, %.6f)\n",
           hit.p.x, hit.p.y, hit.p.z, hit.n.x, hit.n.y, hit.n.z);

    /* A ray that passes the lens by: that is certain too. */
    ray.o.y = 3;
    sgt_hit miss = sgt_intersect(surface, ray, NULL);
    printf("%s\n", sgt_status_text(miss.status));

    /* The root to 22 digits is 4.143085073464611925784. */
    return hit.status == SGT_HIT && fabs(hit.t - 4.143085073464612) <= hit.t_err && hit.t_err < 1e-14
            && miss.status == SGT_MISS ? 0 : 1;
}
