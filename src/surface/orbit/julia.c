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

static sgt_hit first_of(const orbit *o, const sgt_ray *ray, const sgt_options *opt)
{
    sgt_list list = {.cap = 0, .count = 0};
    int evals = sgt_level_march(o, ray, opt, false, &list);
    return first_entry(&list, ray, evals);
}

#define LEVEL_SET(kind)                                                                           \
    static double kind##_value(const void *self, sgt_vec3 p, sgt_vec3 *grad)                      \
    {                                                                                             \
        orbit o;                                                                                  \
        if (!sgt_orbit_of_##kind(self, &o).param) return sgt_level_value(&o, p, grad);            \
        if (grad) *grad = (sgt_vec3){NAN, NAN, NAN};                                              \
        return NAN;                                                                               \
    }                                                                                             \
    static sgt_span kind##_span(const void *self, const sgt_ray *ray)                             \
    {                                                                                             \
        orbit o;                                                                                  \
        if (sgt_orbit_of_##kind(self, &o).param)                                                  \
            return (sgt_span){.lo = -HUGE_VAL, .hi = HUGE_VAL, .seed = NAN};                      \
        return sgt_level_span(&o, ray);                                                           \
    }                                                                                             \
    static double kind##_rounding(const void *self, sgt_vec3 p)                                   \
    {                                                                                             \
        orbit o;                                                                                  \
        return sgt_orbit_of_##kind(self, &o).param ? (double)NAN : sgt_level_rounding(&o, p);     \
    }                                                                                             \
    static double kind##_estimate(const void *self, sgt_vec3 p)                                   \
    {                                                                                             \
        orbit o;                                                                                  \
        double f;                                                                                 \
        return sgt_orbit_of_##kind(self, &o).param ? (double)NAN : sgt_level_estimate(&o, p, &f); \
    }                                                                                             \
    static sgt_interval kind##_enclose(const void *self, const sgt_ray *ray, sgt_interval t,      \
                                       sgt_interval *slope)                                       \
    {                                                                                             \
        orbit o;                                                                                  \
        *slope = (sgt_interval){NAN, NAN};                                                        \
        return sgt_orbit_of_##kind(self, &o).param ? *slope : enclose_by(&o, ray, t, slope);      \
    }                                                                                             \
    static sgt_hit kind##_meet(const void *self, const sgt_ray *ray, const sgt_options *opt)      \
    {                                                                                             \
        orbit o;                                                                                  \
        if (sgt_orbit_of_##kind(self, &o).param) return hit_without(SGT_INVALID, ray, 0);         \
        return first_of(&o, ray, opt);                                                            \
    }                                                                                             \
    static sgt_status kind##_all(const void *self, const sgt_ray *ray, const sgt_options *opt,    \
                                 sgt_list *list)                                                  \
    {                                                                                             \
        orbit o;                                                                                  \
        if (sgt_orbit_of_##kind(self, &o).param) return SGT_INVALID;                              \
        sgt_level_march(&o, ray, opt, true, list);                                                \
        return 0;                                                                                 \
    }                                                                                             \
    static size_t kind##_lanes(const void *self, const sgt_tile *tile, const sgt_options *opt)    \
    {                                                                                             \
        orbit o;                                                                                  \
        if (!sgt_orbit_of_##kind(self, &o).param) return sgt_level_lanes(&o, tile, opt);          \
        memset(tile->hits.status, SGT_HARD, tile->n);                                             \
        return tile->n;                                                                           \
    }                                                                                             \
    static const struct sgt_builtin_ops kind##_builtin = {                                        \
        .meet = kind##_meet, .all = kind##_all, .lanes = kind##_lanes, .tile = SGT_MOST_TILE};    \
    const sgt_surface_ops sgt_##kind##_ops = {.name = #kind,                                      \
                                              .value = kind##_value,                              \
                                              .span = kind##_span,                                \
                                              .rounding = kind##_rounding,                        \
                                              .estimate = kind##_estimate,                        \
                                              .enclose = kind##_enclose,                          \
                                              .own_ = &kind##_builtin};                           \
    double sgt_##kind##_potential(const sgt_##kind *s, sgt_vec3 p, sgt_vec3 *grad)                \
    {                                                                                             \
        orbit o;                                                                                  \
        if (!sgt_orbit_of_##kind(s, &o).param) return sgt_level_potential(&o, p, grad);           \
        if (grad) *grad = (sgt_vec3){NAN, NAN, NAN};                                              \
        return NAN;                                                                               \
    }                                                                                             \
    sgt_objection sgt_##kind##_object(const void *self)                                           \
    {                                                                                             \
        orbit o;                                                                                  \
        return sgt_orbit_of_##kind(self, &o);                                                     \
    }

LEVEL_SET(julia)
LEVEL_SET(mandelbrot)
