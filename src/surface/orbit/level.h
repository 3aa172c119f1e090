/* level.h - the roots of a level set of an orbit along a ray. */
#ifndef SGT_SURFACE_ORBIT_LEVEL_H
#define SGT_SURFACE_ORBIT_LEVEL_H

#include "orbit.h"
#include "../builtin.h"

/* Adds the entries in order, and stops after the first where `all` is false; returns the
 * evaluations spent since the last entry. */
int sgt_level_march(const orbit *o, const sgt_ray *ray, const sgt_options *opt, bool all, sgt_list *list);

/* There is no root but one in [t - t_err, t + t_err]: F is monotone over twice as much.  w is one of the
 * set; it becomes that of the ray. */
bool sgt_level_unique(const orbit *o, path *w, const sgt_ray *ray, double t, double t_lo, double t_err);

/* The stretch of t outside which |Q_0| (Mandelbrot: |Q_1|) is above the greatest E_k: lo > hi where there
 * is none. */
sgt_span sgt_level_span(const orbit *o, const sgt_ray *ray);

/* A guess at the distance to the level set, 0 where F <= 0, and F itself. */
double sgt_level_estimate(const orbit *o, sgt_vec3 p, double *f);

/* F, and its gradient where grad is not NULL. */
double sgt_level_value(const orbit *o, sgt_vec3 p, sgt_vec3 *grad);

/* How far F can be off at p, in units of F. */
double sgt_level_rounding(const orbit *o, sgt_vec3 p);

/* log |Q_n| / p^n at the first level n whose |Q_n| is beyond 2^32, 0 where there is none; and its gradient
 * where grad is not NULL. */
double sgt_level_potential(const orbit *o, sgt_vec3 p, sgt_vec3 *grad);

/* sgt_builtin_ops's sweep. */
size_t sgt_level_lanes(const orbit *o, const sgt_tile *tile, const sgt_options *opt);

#endif
