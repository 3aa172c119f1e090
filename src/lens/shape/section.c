// SPDX-License-Identifier: MIT
/* section.c - the sag of a surface, and its section by a plane, found by asking the library.
 *
 * The sag is where a line parallel to z meets the surface.
 *
 * THE SECTION of a surface that is not a sag: its extent is found by lines parallel to `along`.  F is
 * computed on a square net over this extent.  In each cell where F has both signs at the corners, a stroke
 * goes from side to side, between the points where F is 0 if it is linear between corners.  Each side is cut
 * once at most, so a cell has at most two strokes. */
#include <sagitta/shape.h>
#include <sagitta/surfaces.h>

#include "../base/vec3.h"

#include <math.h>

double sgt_sag_at(sgt_surface s, double x, double y)
{
    if (!sgt_is_sag(s)) return (double)NAN;
    sgt_ray line = {.o = {x, y, 0}, .d = {0, 0, 1}, .tmin = -HUGE_VAL, .tmax = HUGE_VAL};
    sgt_hit hit = sgt_intersect(s, line, &(sgt_options){.pick = SGT_NEAR_SEED});
    return hit.status > 0 ? hit.p.z : (double)NAN;
}

/* By bisection. */
double sgt_whole_radius(sgt_surface s, double wanted)
{
    double low = 0, high = wanted;
    for (int i = 0; i < 40; i++) {
        double r = i ? (low + high) / 2 : high;
        bool fine = !isnan(sgt_sag_at(s, 0, r) + sgt_sag_at(s, 0, -r) + sgt_sag_at(s, r, 0) +
                           sgt_sag_at(s, -r, 0));
        if (fine && i == 0) return high;
        if (fine)
            low = r;
        else
            high = r;
    }
    return low;
}

enum { NET = 128, ROOTS = 16, STROKES = 2 * NET * NET };
_Static_assert((int)STROKES == (int)SGT_SECTION_MOST, "two strokes a cell");

/* The plane of a section: the point (u, w) is u across + w along. */
typedef struct section { sgt_vec3 across, along; } section;

static sgt_vec3 section_point(const section *in, double u, double w)
{
    const sgt_vec3 *a = &in->across, *b = &in->along;
    return (sgt_vec3){u * a->x + w * b->x, u * a->y + w * b->y, u * a->z + w * b->z};
}

/* All roots on a line.  Returns how many of hit[] are set. */
static int meetings(sgt_surface s, sgt_vec3 o, sgt_vec3 d, sgt_hit hit[ROOTS])
{
    int count = sgt_intersect_all(s, (sgt_ray){.o = o, .d = d, .tmin = -HUGE_VAL, .tmax = HUGE_VAL}, ROOTS,
                                  hit, NULL);
    return count < ROOTS ? count : ROOTS;
}

/* The largest |u| where the axis `across` meets the surface, if that is not much more than reach; else
 * reach. */
static double whole(sgt_surface s, const section *in, double reach)
{
    const double MUCH = 4, MARGIN = 1.02;
    double far = 0;
    sgt_hit hit[ROOTS];
    int count = meetings(s, (sgt_vec3){0, 0, 0}, in->across, hit);
    for (int i = 0; i < count; i++)
        if (hit[i].status > 0) far = fmax(far, MARGIN * fabs(hit[i].t));
    return far <= MUCH * reach ? fmax(far, reach) : reach;
}

/* The least and the greatest w at which lines parallel to `along`, at the heights of the net, meet the
 * surface. */
static bool section_ends(sgt_surface s, const section *in, double reach, double *low, double *high)
{
    *low = HUGE_VAL, *high = -HUGE_VAL;
    for (int k = 0; k <= NET; k++) {
        sgt_hit hit[ROOTS];
        int count = meetings(s, section_point(in, reach * (2.0 * k / NET - 1), 0), in->along, hit);
        for (int i = 0; i < count; i++)
            if (hit[i].status > 0) *low = fmin(*low, hit[i].t), *high = fmax(*high, hit[i].t);
    }
    return *low <= *high;
}

/* Where F = 0 on the side from a to b of a cell, by linear interpolation; false: F has one sign there. */
static bool crosses(sgt_vec3 a, double f, sgt_vec3 b, double g, sgt_vec3 *at)
{
    if ((f > 0) == (g > 0) || isnan(f + g)) return false;
    *at = along3(a, f / (f - g), minus3(b, a));
    return true;
}

size_t sgt_section(const sgt_element *e, double reach, sgt_vec3 across, sgt_vec3 along, size_t room,
                   sgt_vec3 stroke[][2])
{
    const sgt_surface s = e->surface;
    const section in = {across, along};
    double low, high;
    size_t count = 0;
    if (!(e->semi_diameter > 0)) reach = whole(s, &in, reach);
    if (!(reach > 0) || !section_ends(s, &in, reach, &low, &high)) return 0;
    double beyond = 2 * ((high - low) / NET + reach * 0x1p-20);
    low -= beyond, high += beyond;
    for (int i = 0; i < NET; i++)
        for (int j = 0; j < NET; j++) {
            sgt_vec3 p[5], end[4];
            double f[5];
            int ends = 0;
            for (int k = 0; k < 5; k++) { /* round the cell, and back to the first corner */
                double u = (double)(i + (k == 1 || k == 2)) / NET, w = (double)(j + (k == 2 || k == 3)) / NET;
                p[k] = section_point(&in, reach * (2 * u - 1), low + (high - low) * w);
                f[k] = s.ops->value(s.self, p[k], NULL);
                if (k > 0 && crosses(p[k - 1], f[k - 1], p[k], f[k], &end[ends])) ends++;
            }
            for (int k = 0; k + 1 < ends; k += 2, count++)
                if (count < room) stroke[count][0] = end[k], stroke[count][1] = end[k + 1];
        }
    return count;
}
