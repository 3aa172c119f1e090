/* intersect.c - one ray meets one surface: the door, and what is checked there. */
#include "../solve/root.h"
#include "../surface/sag.h"
#include "general.h"

/* x - x is 0 for a finite x, NaN for another: one comparison for all. */
static double not_finite(sgt_vec3 v) { return (v.x - v.x) + (v.y - v.y) + (v.z - v.z); }

/* tmax = 0 with tmin >= 0 stands for infinity. */
static bool ray_valid(sgt_ray *ray)
{
    double big = larger(fabs(ray->d.x), larger(fabs(ray->d.y), fabs(ray->d.z)));
    if (!(not_finite(ray->o) + not_finite(ray->d) == 0 && big >= DBL_MIN)) return false;
    if (ray->tmax == 0 && ray->tmin >= 0) ray->tmax = HUGE_VAL;
    return ray->tmin <= ray->tmax && ray->tmin < HUGE_VAL && ray->tmax > -HUGE_VAL;
}

sgt_hit sgt_intersect(sgt_surface s, sgt_ray ray, const sgt_options *opt)
{
    static const sgt_options none = {0};
    bool valid = s.ops && s.ops->value && ray_valid(&ray) && sgt_options_valid(opt);
    if (!opt) opt = &none;
    if (!valid) return hit_without(SGT_INVALID, &ray, 0);
    if (!s.ops->sag_) return sgt_intersect_general(s, &ray, opt);
    return s.ops->sag_->meet(s.self, &ray, opt);
}
