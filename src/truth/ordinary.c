// SPDX-License-Identifier: MIT
/* ordinary.c - ordinary rays for a surface of any type, always the same.
 *
 * On a sag: origins uniform in a disk of radius r at z = -2 r, and l and m uniform in +-0.15.
 * r is the smallest of 5/8 of semi_diameter, 5/8 of the norm of its polynomials, 5/8 of half a grid, and 1/4
 * of a radius; 1 if it has none of these.  On a body or a level set: from a sphere about the origin of its
 * frame, of radius 1.5 times its reach, toward any point within 3/4 of the reach.  The reach is the farthest
 * root on the axes, or of a level set half the chord of its ball.  A formula f has the reach of its ball; of
 * a box, about whose middle the sphere then is, half its diagonal.  Random numbers are splitmix64 (Steele,
 * Lea, Flood 2014, OOPSLA) from 0x1234567, so the rays are always the same. */
#include "ordinary.h"

#include <sagitta/formula.h>
#include <sagitta/surfaces.h>

#include <math.h>
#include <stdint.h>

static double unit_random(uint64_t *state)
{
    uint64_t z = *state += 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return (double)((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

static const double TURN = 6.283185307179586;

static sgt_ray sag_ray(uint64_t *state, double reach)
{
    double r = reach * sqrt(unit_random(state)), angle = TURN * unit_random(state);
    double l = 0.15 * (2 * unit_random(state) - 1), m = 0.15 * (2 * unit_random(state) - 1);
    return (sgt_ray){.o = {r * cos(angle), r * sin(angle), -2 * reach}, .d = {l, m, sqrt(1 - l * l - m * m)}};
}

static sgt_vec3 on_sphere(uint64_t *state, double radius)
{
    double z = 2 * unit_random(state) - 1, r = sqrt(1 - z * z), angle = TURN * unit_random(state);
    return (sgt_vec3){radius * r * cos(angle), radius * r * sin(angle), radius * z};
}

static sgt_ray set_ray(uint64_t *state, sgt_vec3 middle, double escape)
{
    sgt_vec3 o = on_sphere(state, 1.5 * escape),
             to = on_sphere(state, 0.75 * escape * cbrt(unit_random(state)));
    sgt_vec3 d = {to.x - o.x, to.y - o.y, to.z - o.z};
    double length = sqrt(d.x * d.x + d.y * d.y + d.z * d.z);
    return (sgt_ray){.o = {middle.x + o.x, middle.y + o.y, middle.z + o.z},
                     .d = {d.x / length, d.y / length, d.z / length}};
}

/* Half the chord of the ball on the line through the origin: about how far the set reaches. */
static double half_chord(sgt_surface s)
{
    sgt_span span = s.ops->span(s.self, &(sgt_ray){.o = {0, 0, 0}, .d = {0, 0, 1}});
    double half = 0.5 * (span.hi - span.lo);
    return half > 0 && half < HUGE_VAL ? half : 1;
}

static double body_reach(sgt_surface s)
{
    enum { ROOTS = 8 };
    double reach = 0;
    for (int axis = 0; axis < 3; axis++) {
        sgt_hit hit[ROOTS];
        sgt_ray line = {.d = {axis == 0, axis == 1, axis == 2}, .tmin = -HUGE_VAL, .tmax = HUGE_VAL};
        int count = sgt_intersect_all(s, line, ROOTS, hit, NULL);
        for (int i = 0; i < count && i < ROOTS; i++)
            if (hit[i].status > 0) reach = fmax(reach, fabs(hit[i].t));
    }
    return reach > 0 && reach < HUGE_VAL ? reach : 1;
}

static double sag_reach(sgt_surface s)
{
    static const struct { const char *key; bool curvature; } limit[] = {
        {"semi_diameter", false}, {"norm", false}, {"norm_x", false}, {"norm_y", false},
        {"curvature", true}, {"curvature_x", true}, {"curvature_y", true},
    };
    double reach = HUGE_VAL;
    if (s.ops == &sgt_formula_sag_ops) {
        double rim = ((const sgt_formula_sag *)s.self)->semi_diameter;
        return rim > 0 ? 0.625 * rim : 1;
    }
    for (size_t i = 0; i < sizeof limit / sizeof limit[0]; i++) {
        const double *x = sgt_number_of(s, limit[i].key);
        if (x && *x != 0) reach = fmin(reach, limit[i].curvature ? 0.25 / fabs(*x) : 0.625 * *x);
    }
    const double *step_x = sgt_number_of(s, "step_x"), *step_y = sgt_number_of(s, "step_y");
    for (const sgt_param *p = sgt_builtin_of(s)->params; step_x && step_y && p->name; p++) {
        const sgt_numbers *z = (const void *)((const char *)s.self + p->offset);
        if (p->kind == SGT_PARAM_TABLE && z->rows)
            reach = fmin(reach, 0.3125 * fmin(*step_x * (double)(z->columns - 1),
                                              *step_y * (double)(z->rows - 1)));
    }
    return reach < HUGE_VAL ? reach : 1;
}

/* Of a formula f, by its ball or box; *middle: of the box. */
static double clip_reach(sgt_surface s, sgt_vec3 *middle)
{
    const sgt_formula *f = s.self;
    sgt_vec3 half = {0.5 * (f->hi.x - f->lo.x), 0.5 * (f->hi.y - f->lo.y), 0.5 * (f->hi.z - f->lo.z)};
    double diagonal = sqrt(half.x * half.x + half.y * half.y + half.z * half.z);
    if (f->ball > 0 && !(diagonal > 0 && diagonal < f->ball)) return f->ball;
    if (!(diagonal > 0)) return body_reach(s);
    *middle = (sgt_vec3){f->lo.x + half.x, f->lo.y + half.y, f->lo.z + half.z};
    return diagonal;
}

void ordinary_rays(sgt_surface s, size_t count, sgt_ray ray[])
{
    uint64_t state = 0x1234567;
    bool clipped = s.ops == &sgt_formula_ops;
    bool sag = s.ops == &sgt_formula_sag_ops || (!clipped && sgt_is_sag(s));
    bool set = sgt_builtin_of(s)->family == SGT_FAMILY_LEVEL_SET;
    sgt_vec3 middle = {0, 0, 0};
    double reach = sag       ? sag_reach(s)
                   : clipped ? clip_reach(s, &middle)
                   : set     ? half_chord(s)
                             : body_reach(s);
    for (size_t i = 0; i < count; i++)
        ray[i] = sag ? sag_ray(&state, reach) : set_ray(&state, middle, reach);
}
