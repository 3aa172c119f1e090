// SPDX-License-Identifier: MIT
/* waves.c - random gratings and polynomial phases met at a point, as text for test_waves.py.
 *
 *     waves COUNT SEED
 *
 * A line has, in hexadecimal: n1 n2 mirror  c k of the surface  per_wave  nine coefficients of x^i y^j in
 * waves  x y z  l m n in front  fate  l m n behind  opl.  The ray starts at the point, so opl is S.  Orders
 * are -3 to 3; two of three are linear gratings, in conical incidence. */
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

int main(int argc, char **argv)
{
    const long count = argc > 1 ? atol(argv[1]) : 10;
    state = argc > 2 ? strtoull(argv[2], NULL, 0) : 1;
    for (long i = 0; i < count; i++) {
        const double n1 = chance(0.5) ? 1 : uniform(1, 2), n2 = chance(0.3) ? n1 : uniform(1, 2);
        const bool mirror = chance(0.3), flat = chance(0.5);
        const sgt_conic s = {.c = flat ? 0 : uniform(-0.1, 0.1), .k = chance(0.5) ? 0 : uniform(-2, 1)};
        const double order = floor(uniform(-3, 4)), wavelength = uniform(0.4e-3, 1e-3);
        const double lines = uniform(1, 1500);
        double a[9] = {0}, turn = chance(0.3) ? 0 : uniform(-4, 4);
        a[3] = -lines * sin(turn), a[1] = lines * cos(turn);
        if (chance(0.33))
            for (int k = 0; k < 9; k++) a[k] = uniform(-200, 200) * pow(3, -(k / 3 + k % 3));
        const sgt_polynomial_xy w = {.a = {a, 3, 3}};
        const sgt_phase phase = {
            .kind = SGT_PHASE_SAG, .waves = {&sgt_polynomial_xy_ops, &w}, .per_wave = order * wavelength};
        const sgt_element e = {
            .surface = {&sgt_conic_ops, &s}, .index = mirror ? SGT_MIRROR : n2, .phase = &phase};
        const double u = uniform(-1, 1), v = uniform(-1, 1), to = chance(0.5) ? 1 : -1;
        const double length = sqrt(1 + u * u + v * v);
        const sgt_vec3 d = {u / length, v / length, to / length};
        sgt_ray ray = {.o = {uniform(-3, 3), uniform(-3, 3), 0}, .d = d};
        sgt_passage is;
        sgt_trace(1, &e, n1, &ray, &is, NULL, NULL);
        ray = (sgt_ray){.o = is.hit.p, .d = d}; /* again from there */
        sgt_fate fate;
        sgt_trace(1, &e, n1, &ray, &is, &fate, NULL);
        if (!(is.hit.status > 0)) continue;
        printf("%a %a %d  %a %a  %a ", n1, mirror ? n1 : n2, mirror, s.c, s.k, phase.per_wave);
        for (int k = 0; k < 9; k++) printf(" %a", a[k]);
        printf("  %a %a %a  %a %a %a  %d  %a %a %a  %a\n", is.hit.p.x, is.hit.p.y, is.hit.p.z, d.x, d.y, d.z,
               (int)fate, is.direction.x, is.direction.y, is.direction.z, is.opl - n1 * is.hit.t);
    }
    return 0;
}
