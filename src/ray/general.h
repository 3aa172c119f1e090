// SPDX-License-Identifier: MIT
/* general.h - one ray, or a tile of rays, and a surface that is met by its operations (`value`,
 * `span`, `enclose` ...).
 *
 * Such a surface is a user's, or a built-in one without `meet` (is_catalogue in builtin.h).  The functions
 * are in intersect.c, general.c and lanes.c. */
#ifndef SGT_RAY_GENERAL_H
#define SGT_RAY_GENERAL_H
#include "../surface/builtin.h"

/* 0 if all three are finite, else NaN: x - x is 0 for a finite x and NaN for any other.  So one comparison
 * tests all of them. */
SGT_INLINE double not_finite(sgt_vec3 v) { return (v.x - v.x) + (v.y - v.y) + (v.z - v.z); }

/* Is the ray valid, as sgt_ray and SGT_INVALID of sagitta.h say?  Its ends are explicit (explicit_end). */
SGT_INLINE bool ray_valid(const sgt_ray *ray)
{
    double big = larger(fabs(ray->d.x), larger(fabs(ray->d.y), fabs(ray->d.z)));
    bool ends = (ray->tmin <= ray->tmax) & (ray->tmax > -HUGE_VAL);
    return (not_finite(ray->o) + not_finite(ray->d) == 0) & (big >= DBL_MIN) & ends & (ray->tmin < HUGE_VAL);
}

/* The r^2 within which a root of a surface met by its operations is accepted; HUGE_VAL without a rim. */
SGT_INLINE double rim2_of_surface(sgt_surface s)
{
    return s.ops->own_ && s.ops->own_->rim ? rim2_of(s.ops->own_->rim(s.self)) : HUGE_VAL;
}

/* A built-in surface without `meet` checks its own parameters (`object`).  One with `meet` returns
 * SGT_INVALID itself.  The table of any surface but the former has to be whole (is_whole). */
SGT_INLINE bool parameters_valid(sgt_surface s)
{
    return is_catalogue(s.ops) ? !s.ops->own_->object(s.self).reason : is_whole(s.ops);
}

/* sgt_intersect, with the ray by address: its tmax is made explicit (explicit_end).  In intersect.c. */
sgt_hit sgt_intersect_copy(sgt_surface s, sgt_ray *ray, const sgt_options *opt);

/* As sgt_intersect_general and sgt_intersect_all_general of answer.h, without a proof: options.proof is not
 * read.  In general.c. */
sgt_hit sgt_search_first(sgt_surface s, const sgt_ray *ray, const sgt_options *opt);
void sgt_search_all(sgt_surface s, const sgt_ray *ray, const sgt_options *opt, sgt_list *list);

/* Answers a tile of rays as sgt_builtin_ops.lanes of builtin.h does.  Returns how many rays are left
 * SGT_HARD.  In lanes.c. */
size_t sgt_lanes_general(sgt_surface s, const sgt_tile *tile, const sgt_options *opt);

#endif
