/* general.h - a ray and any surface, by nothing but what its operations answer. */
#ifndef SGT_RAY_GENERAL_H
#define SGT_RAY_GENERAL_H
#include "../surface/builtin.h"

/* x - x is 0 for a finite x, NaN for another: one comparison for all. */
SGT_INLINE double not_finite(sgt_vec3 v) { return (v.x - v.x) + (v.y - v.y) + (v.z - v.z); }

/* tmax = 0 with tmin >= 0 stands for infinity. */
SGT_INLINE bool ray_valid(sgt_ray *ray)
{
    double big = larger(fabs(ray->d.x), larger(fabs(ray->d.y), fabs(ray->d.z)));
    bool endless = (ray->tmax == 0) & (ray->tmin >= 0),
         ends = endless | ((ray->tmin <= ray->tmax) & (ray->tmax > -HUGE_VAL));
    ray->tmax = endless ? HUGE_VAL : ray->tmax;
    return (not_finite(ray->o) + not_finite(ray->d) == 0) & (big >= DBL_MIN) & ends & (ray->tmin < HUGE_VAL);
}

/* r^2 within which a root of a surface met by its operations counts. */
SGT_INLINE double rim2_of_surface(sgt_surface s)
{
    return s.ops->own_ && s.ops->own_->rim ? rim2_of(s.ops->own_->rim(s.self)) : HUGE_VAL;
}

/* A built-in surface that does not answer by itself says whether it is one; the table of a user has to be
 * whole. */
SGT_INLINE bool parameters_valid(sgt_surface s)
{
    return is_catalogue(s.ops) ? !s.ops->own_->object(s.self).reason : is_whole(s.ops);
}

/* sgt_intersect of a ray that may be written to. */
sgt_hit sgt_intersect_copy(sgt_surface s, sgt_ray *ray, const sgt_options *opt);

/* ray and opt have been checked, tmax made explicit. */
sgt_hit sgt_intersect_general(sgt_surface s, const sgt_ray *ray, const sgt_options *opt);

/* Every entry; a list's first is what the other returns. */
void sgt_intersect_all_general(sgt_surface s, const sgt_ray *ray, const sgt_options *opt, sgt_list *list);

/* The same where no proof is asked for. */
sgt_hit sgt_search_first(sgt_surface s, const sgt_ray *ray, const sgt_options *opt);
void sgt_search_all(sgt_surface s, const sgt_ray *ray, const sgt_options *opt, sgt_list *list);

/* A tile of rays and a surface of a user, as sgt_builtin_ops.sweep of builtin.h answers it: how many rays
 * are left SGT_HARD. */
size_t sgt_lanes_general(sgt_surface s, const sgt_tile *tile, const sgt_options *opt);

#endif
