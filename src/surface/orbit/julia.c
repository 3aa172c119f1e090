// SPDX-License-Identifier: MIT
/* julia.c - level sets of Q^p + c as surfaces: the quaternion Julia and Mandelbrot sets.
 *
 * value.c has F at a point.  level.c and level_batch.c have the roots along a ray.
 *
 * Tests: tests/oracle/test_levels.cpp, test_brute.cpp, test_ceres.cpp, tests/unit/test_levels.c. */
#include "level.h"

#include "course.h"

/* Encloses about the middle of t, along the scaled direction: if d is very short, squares would be lost.
 * If the ray is so far away that squares overflow, nothing is known. */
static sgt_interval enclose_by(const orbit *o, const sgt_ray *ray, sgt_interval t, sgt_interval *slope)
{
    path w;
    double scale = scale_of(ray->d), lo = t.lo / scale, hi = t.hi / scale, m = 0.5 * lo + 0.5 * hi;
    double h = larger(hi - m, m - lo) * (1 + 4 * SGT_U) + 0x1p-1070; /* for underflow */
    *slope = (sgt_interval){-HUGE_VAL, HUGE_VAL};
    if (t.lo > t.hi) return *slope = (sgt_interval){HUGE_VAL, -HUGE_VAL};
    local q = local_at(ray, m, 0);
    double far = (fabs(q.x) + fabs(q.y) + fabs(q.z)) + 2 * h;
    if (!(far < 0x1p480)) return (sgt_interval){-1, 1};
    set_of(o, &w);
    path_of(o, (sgt_vec3){q.x, q.y, q.z}, q.l, q.m, q.n, &w);
    sgt_interval g = sgt_orbit_enclose(&w, 0, h, slope);
    slope->lo = slope->lo / scale - 0x1p-1074, slope->hi = slope->hi / scale + 0x1p-1074;
    return g;
}

/* ------------------------------------------------------- the two surfaces */

static double value_nowhere(sgt_vec3 *grad)
{
    if (grad) *grad = (sgt_vec3){NAN, NAN, NAN};
    return NAN;
}

static sgt_hit meet_orbit(const orbit *o, const sgt_ray *ray, const sgt_options *opt)
{
    sgt_list list = {.cap = 0, .count = 0};
    if (!ray_valid(ray)) return hit_without(SGT_INVALID, ray, 0);
    int evals = sgt_level_march(o, ray, opt, false, &list);
    return first_entry(&list, ray, evals);
}

static sgt_status all_of_orbit(const orbit *o, const sgt_ray *ray, const sgt_options *opt, sgt_list *list)
{
    sgt_level_march(o, ray, opt, true, list);
    return 0;
}

static size_t all_hard(const sgt_tile *tile)
{
    memset(tile->hits.status, SGT_HARD, tile->n);
    return tile->n;
}

/* A function of an orbit o as one of a surface.  HEAD: its name and parameters, the first of which is
 * `self`.  IF_NOT: its value where a parameter is invalid. */
#define OF_ORBIT(NAME, HEAD, IF_NOT, THEN)                                                                  \
    static HEAD                                                                                             \
    {                                                                                                       \
        orbit o;                                                                                            \
        return sgt_orbit_of_##NAME(self, &o).param ? (IF_NOT) : (THEN);                                     \
    }

/* sgt_NAME_ops and sgt_NAME_potential, from sgt_orbit_of_NAME, which reads the parameters. */
#define LEVEL_SET(NAME)                                                                                     \
    OF_ORBIT(NAME, double NAME##_value(const void *self, sgt_vec3 p, sgt_vec3 *grad), value_nowhere(grad),  \
             sgt_level_value(&o, p, grad))                                                                  \
    OF_ORBIT(NAME, sgt_span NAME##_span(const void *self, const sgt_ray *ray),                              \
             ((sgt_span){.lo = -HUGE_VAL, .hi = HUGE_VAL, .seed = NAN}), sgt_level_span(&o, ray))           \
    OF_ORBIT(NAME, double NAME##_rounding(const void *self, sgt_vec3 p), (double)NAN,                       \
             sgt_level_rounding(&o, p))                                                                     \
    OF_ORBIT(NAME, double NAME##_estimate(const void *self, sgt_vec3 p), (double)NAN,                       \
             sgt_level_estimate(&o, p, &(double){0}))                                                       \
    OF_ORBIT(NAME,                                                                                          \
             sgt_interval NAME##_enclose(const void *self, const sgt_ray *ray, sgt_interval t,              \
                                         sgt_interval *slope),                                              \
             (*slope = (sgt_interval){NAN, NAN}), enclose_by(&o, ray, t, slope))                            \
    OF_ORBIT(NAME, sgt_hit NAME##_meet(const void *self, const sgt_ray *ray, const sgt_options *opt),       \
             hit_without(SGT_INVALID, ray, 0), meet_orbit(&o, ray, opt))                                    \
    OF_ORBIT(NAME,                                                                                          \
             sgt_status NAME##_all(const void *self, const sgt_ray *ray, const sgt_options *opt,            \
                                   sgt_list *list),                                                         \
             SGT_INVALID, all_of_orbit(&o, ray, opt, list))                                                 \
    OF_ORBIT(NAME, size_t NAME##_lanes(const void *self, const sgt_tile *tile, const sgt_options *opt),     \
             all_hard(tile), sgt_level_lanes(&o, tile, opt))                                                \
    OF_ORBIT(NAME, double NAME##_logarithm(const void *self, sgt_vec3 p, sgt_vec3 *grad),                   \
             value_nowhere(grad), sgt_level_potential(&o, p, grad))                                         \
    static sgt_objection NAME##_object(const void *self) { return sgt_orbit_of_##NAME(self, &(orbit){0}); } \
    static const struct sgt_builtin_ops NAME##_builtin = {                                                  \
        .object = NAME##_object, .meet = NAME##_meet, .all = NAME##_all, .lanes = NAME##_lanes,             \
        .tile = SGT_MOST_TILE};                                                                             \
    const sgt_surface_ops sgt_##NAME##_ops = {                                                              \
        .name = #NAME, .own_ = &NAME##_builtin, .value = NAME##_value, .span = NAME##_span,                 \
        .rounding = NAME##_rounding, .estimate = NAME##_estimate, .enclose = NAME##_enclose};               \
    double sgt_##NAME##_potential(const sgt_##NAME *s, sgt_vec3 p, sgt_vec3 *grad)                          \
    {                                                                                                       \
        return NAME##_logarithm(s, p, grad);                                                                \
    }

LEVEL_SET(julia)
LEVEL_SET(mandelbrot)
