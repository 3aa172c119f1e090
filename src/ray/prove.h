/* prove.h - a ray and a surface that is met by its operations, where a proof is asked for: options.proof is not SGT_ESTIMATE. */
#ifndef SGT_RAY_PROVE_H
#define SGT_RAY_PROVE_H
#include "general.h"

/* As sgt_intersect_general, and as sgt_intersect_all_general. */
sgt_hit sgt_prove(sgt_surface s, const sgt_ray *ray, const sgt_options *opt);
void    sgt_prove_all(sgt_surface s, const sgt_ray *ray, const sgt_options *opt, sgt_list *list);

/* As sgt_prove, only roots within r^2 <= rim2 count. */
sgt_hit sgt_prove_within(sgt_surface s, const sgt_ray *ray, double rim2, const sgt_options *opt);

/* The same search where no proof is asked for, of what has been begun: the rest of its budget, every root of `all`, else the first, or
 * the one nearest to the seed, is added. */
void sgt_prove_rest(sgt_surface s, const sgt_ray *ray, tally *told, bool all, bool near, sgt_list *list);

/* A root that has been found at t + t_lo, right to t_err, on a ray that meets no other, where rounding hides
 * whether it counts. true: it is decided, and added if it counts, or cannot be told. */
bool sgt_prove_found(sgt_surface s, const sgt_ray *ray, tally *told, double t, double t_lo, double t_err,
                     sgt_list *list);

/* The ray with its origin moved along it to near `about`, exactly (prove.c); the t0 of that, 0 where there is none. */
double sgt_move_exactly(const sgt_ray *ray, double about, sgt_ray *moved);

#endif
