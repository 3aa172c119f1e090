// SPDX-License-Identifier: MIT
/* A program with one surface; one_surface.py looks at what it carries. */
#include <stdio.h>
#include <sagitta/surfaces.h>

int main(void)
{
    const sgt_conic sphere = { .c = -0.1 };
    sgt_hit hit = sgt_intersect((sgt_surface){ &sgt_conic_ops, &sphere },
                                (sgt_ray){ .o = { 0, 0.5, -5 }, .d = { 0, 0, 1 } }, NULL);
    printf("%s at t = %.17g\n", sgt_status_text(hit.status), hit.t);
    return hit.status != SGT_HIT;
}
