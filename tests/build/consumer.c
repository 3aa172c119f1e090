// SPDX-License-Identifier: MIT
/* An optical tool in small: a scan lens, its numbers in the program, traced with
 * nothing but the installed library.  Prints where the chief and the marginal
 * rays land; exits with the number of rays that are not where they should be.
 *
 * The lens: Laikin, Lens Design, 4th edition, page 251, in inches, at 0.633 um. */
#include <math.h>
#include <stdio.h>
#include <sagitta/surfaces.h>
#include <sagitta/system.h>

#define GLASS 1.8395380486608464
#define SURFACES 8

int main(void)
{
    static const struct { double radius, z, index; } lens[SURFACES] = {
        { INFINITY, 0, 1 },       /* the stop */
        { -2.2136, 5.0, GLASS }, { -2.6575, 5.3, 1 },
        { -5.5022, 5.319999999999999, GLASS }, { -3.8129, 5.8492, 1 },
        { 7.9951, 10.1419, GLASS }, { 8.3651, 10.7319, 1 },
        { INFINITY, 28.7333, 1 }  /* the image */
    };
    /* Launched at z = -1; where each lands, from a trace at 50 digits. */
    static const struct { const char *name; sgt_vec3 o, d, point, direction; } rays[] = {
        { "axis, chief", { 0, 0, -1 }, { 0, 0, 1 }, { 0, 0, 0 }, { 0, 0, 1 } },
        { "axis, lower", { 0, -0.5, -1 }, { 0, 0, 1 },
          { 0, -0.002307925412564594611055892, 0 },
          { 0, 0.02491867118776522717160838, 0.9996894817023114198544036 } },
        { "axis, side", { 0.5, 0, -1 }, { 0, 0, 1 },
          { 0.002307925412564594611055892, 0, 0 },
          { -0.02491867118776522717160838, 0, 0.9996894817023114198544036 } },
        { "15 deg, chief", { 0, -0.2679491924311227, -1 }, { 0, 0.2588190451025208, 0.9659258262890684 },
          { 0, 5.234820045459811411434062, 0 },
          { 0, 0.1578309120642157208620088, 0.9874661529373945100755167 } },
        { "15 deg, lower", { 0, -0.7679491924311227, -1 }, { 0, 0.2588190451025208, 0.9659258262890684 },
          { 0, 5.247190278715706976243825, 0 },
          { 0, 0.1824385401091658610767561, 0.9832172593495479722048526 } },
        { "15 deg, side", { -0.5, -0.2679491924311227, -1 }, { 0, 0.2588190451025208, 0.9659258262890684 },
          { -0.003961638278527241172906504, 5.241225288451206150516882, 0 },
          { 0.02457126125861839793272237, 0.1580171205537071537121113, 0.9871306107765455668564052 } },
    };

    sgt_conic shapes[SURFACES];
    sgt_element elements[SURFACES];
    for (int i = 0; i < SURFACES; i++) {
        shapes[i] = (sgt_conic){ .c = 1 / lens[i].radius };
        elements[i] = (sgt_element){ .surface = { &sgt_conic_ops, &shapes[i] },
                                     .pose.origin = { 0, 0, lens[i].z },
                                     .index = lens[i].index };
    }
    elements[0].semi_diameter = 0.5;

    int wrong = 0;
    printf("%-14s %20s %20s %9s\n", "ray", "x", "y", "off by");
    for (size_t i = 0; i < sizeof rays / sizeof rays[0]; i++) {
        sgt_ray ray = { rays[i].o, rays[i].d, 0, 0 };
        sgt_passage at[SURFACES];
        sgt_fate fate;
        size_t passed = sgt_trace(SURFACES, elements, 1, &ray, at, &fate, NULL);
        if (passed != SURFACES) {
            printf("%-14s %s at surface %zu\n", rays[i].name, sgt_fate_text(fate), passed + 1);
            wrong++;
            continue;
        }
        sgt_vec3 p = at[SURFACES - 1].hit.p, d = at[SURFACES - 1].direction;
        double off = hypot(p.x - rays[i].point.x, p.y - rays[i].point.y);
        double turned = fabs(d.x - rays[i].direction.x) + fabs(d.y - rays[i].direction.y)
                      + fabs(d.z - rays[i].direction.z);
        printf("%-14s %20.16f %20.16f %9.1e\n", rays[i].name, p.x, p.y, off);
        wrong += !(off < 1e-12 * 28.7333 && turned < 1e-12);
    }
    return wrong;
}
