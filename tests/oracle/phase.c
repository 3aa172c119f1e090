// SPDX-License-Identifier: MIT
/* phase.c - random ideal lenses met at a point, as text for test_phase.py.
 *
 *     phase COUNT SEED
 *
 * A line has, in hexadecimal: n1 n2 mirror fx fy object  x y  l m n in front  l m n behind  opl.  fy is 0 for
 * a lens of one power.  The ray starts at the point, so opl is what the lens adds. */
#include <sagitta/surfaces.h>
#include <sagitta/system.h>

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

static uint64_t state;

static double uniform(double lo, double hi)
{
    uint64_t z = state += 0x9e3779b97f4a7c15u; /* splitmix64 */
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return lo + (hi - lo) * ldexp((double)((z ^ (z >> 31)) >> 11), -53);
}
static bool chance(double p) { return uniform(0, 1) < p; }
static double any_scale(double lo, double hi) { return exp(uniform(log(lo), log(hi))); }
static double any_sign(void) { return chance(0.5) ? 1 : -1; }

static double any_index(void) { return chance(0.4) ? 1 : chance(0.9) ? uniform(1, 4) : any_scale(1e-6, 1e6); }

int main(int argc, char **argv)
{
    static const sgt_conic flat = {0};
    long count = argc > 1 ? atol(argv[1]) : 10;
    state = argc > 2 ? strtoull(argv[2], NULL, 0) : 1;
    for (long i = 0; i < count; i++) {
        double n1 = any_index(), n2 = chance(0.5)   ? n1
                                      : chance(0.2) ? n1 * (1 + any_scale(1e-15, 1))
                                                    : any_index();
        bool mirror = chance(0.2);
        if (mirror) n2 = n1;
        double f = any_sign() * any_scale(1e-3, 1e3),
               reach = fabs(f) * any_scale(1e-8, chance(0.1) ? 1e3 : 2);
        sgt_phase phase = {.kind = SGT_IDEAL_LENS, .focal_length = f};
        if (chance(0.4))
            phase.focal_length_y = chance(0.3)
                                       ? any_sign() * (double)INFINITY
                                       : any_sign() * fabs(f) * any_scale(1, chance(0.1) ? 1e200 : 30);
        if (phase.focal_length_y != 0 && chance(0.5))
            phase.focal_length = phase.focal_length_y, phase.focal_length_y = f;
        if (chance(0.7))
            phase.object_distance = chance(0.2)   ? n1 * f * any_sign()
                                    : chance(0.2) ? 2 * n1 * f
                                                  : any_sign() * fabs(f) * any_scale(1e-4, 1e4);
        sgt_vec3 p = {any_sign() * reach * uniform(0, 1),
                      chance(0.2) ? 0 : any_sign() * reach * uniform(0, 1), 0};
        /* slopes: small, any, from near the object's axis, nearly along the plane */
        double steep = chance(0.1) ? any_scale(1, 1e7) : any_scale(1e-8, 3), u = steep * uniform(-1, 1),
               v = steep * uniform(-1, 1), to = any_sign();
        if (phase.object_distance != 0 && chance(0.3))
            u = p.x / phase.object_distance * (1 + any_sign() * any_scale(1e-16, 1)),
            v = p.y / phase.object_distance;
        if (chance(0.1)) u = p.x / (n1 * f), v = p.y / (n1 * f);
        if (phase.focal_length_y != 0 && chance(0.2)) { /* in a section, or from afar along the axis */
            const bool axial = chance(0.3), in_y = chance(0.5);
            if (axial || in_y) u = 0;
            if (axial || !in_y) v = 0;
            if (!axial && in_y) p.x = 0;
            if (!axial && !in_y) p.y = 0;
        }
        long double length = sqrtl(1 + (long double)u * u + (long double)v * v);
        sgt_ray ray = {.o = p, .d = {(double)(u / length), (double)(v / length), (double)(to / length)}};
        sgt_vec3 d = ray.d;
        sgt_element e = {
            .surface = {&sgt_conic_ops, &flat}, .index = mirror ? SGT_MIRROR : n2, .phase = &phase};
        sgt_passage is;
        if (sgt_trace(1, &e, n1, &ray, &is, NULL, NULL) != 1) continue;
        printf("%a %a %d %a %a %a  %a %a  %a %a %a  %a %a %a  %a\n", n1, n2, mirror, phase.focal_length,
               phase.focal_length_y, phase.object_distance, is.hit.p.x, is.hit.p.y, d.x, d.y, d.z,
               is.direction.x, is.direction.y, is.direction.z, is.opl);
    }
    return 0;
}
