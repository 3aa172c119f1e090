// SPDX-License-Identifier: MIT
/* batch.c - a thousand rays in one call: on a paraboloid, and from it to its focus.
 *
 * Rays come in as arrays, one for each number, and so do the answers; an array left NULL is not
 * wanted.  Each answer is the one that its ray gets alone, to the last bit. */
#include <math.h>
#include <sagitta/surfaces.h>
#include <sagitta/system.h>
#include <stdio.h>

enum { RAYS = 1000 };

static double x[RAYS], y[RAYS], z[RAYS], l[RAYS], m[RAYS], n[RAYS];
static double t[RAYS], t_err[RAYS], end_x[RAYS], end_y[RAYS], end_z[RAYS], end_l[RAYS], end_m[RAYS],
    end_n[RAYS];

int main(void)
{
    /* Parallel to the axis, spread over a disk, from z = 20 down to the hollow side of z = r^2 / 20. */
    for (int i = 0; i < RAYS; i++) {
        double r = 4 * sqrt((i + 0.5) / RAYS), a = 2.399963229728653 * i;
        x[i] = r * cos(a), y[i] = r * sin(a), z[i] = 20, n[i] = -1;
    }
    sgt_conic bowl = {.c = 0.1, .k = -1};
    sgt_surface surface = {&sgt_conic_ops, &bowl};
    sgt_rays rays = {.o = {x, y, z}, .d = {l, m, n}}; /* tmin and tmax left NULL: from o on */

    size_t met = sgt_intersect_batch(surface, RAYS, rays, (sgt_hits){.t = t, .t_err = t_err}, NULL);
    int equal = 0;
    double worst = 0, bound = 0;
    for (int i = 0; i < RAYS; i++) {
        sgt_hit alone = sgt_intersect(surface, (sgt_ray){.o = {x[i], y[i], z[i]}, .d = {l[i], m[i], n[i]}},
                                      NULL);
        equal += alone.t == t[i] && alone.t_err == t_err[i];
        worst = fmax(worst, fabs(t[i] - (20 - (x[i] * x[i] + y[i] * y[i]) / 20)));
        bound = fmax(bound, t_err[i]);
    }
    printf("%zu of %d rays meet it, t right within %.1e; %d are what the ray gets alone\n", met, RAYS, bound,
           equal);

    /* As a mirror it sends them all through its focus, 5 from the vertex. */
    sgt_conic plane = {0};
    sgt_element mirror[] = {
        {.surface = surface, .index = SGT_MIRROR},
        {.surface = {&sgt_conic_ops, &plane}, .pose = {.origin = {0, 0, 5}}},
    };
    sgt_traced ends = {.o = {end_x, end_y, end_z}, .d = {end_l, end_m, end_n}};
    size_t passed = sgt_trace_batch(2, mirror, 1, RAYS, rays, ends, NULL, NULL);
    double off = 0;
    for (int i = 0; i < RAYS; i++) off = fmax(off, hypot(end_x[i], end_y[i]));
    printf("%zu of %d are reflected through the focus, none farther from it than %.1e\n", passed, RAYS, off);

    return !(met == RAYS && equal == RAYS && worst < 1e-14 && passed == RAYS && off < 1e-14);
}
