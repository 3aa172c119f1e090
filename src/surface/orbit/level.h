// SPDX-License-Identifier: MIT
/* level.h - the roots of a level set of an orbit along a ray. */
#ifndef SGT_SURFACE_ORBIT_LEVEL_H
#define SGT_SURFACE_ORBIT_LEVEL_H

#include "orbit.h"
#include "../builtin.h"

/* Adds the entries in order.  If `all` is false, stops after the first.  Returns the evaluations spent
 * since the last entry. */
int sgt_level_march(const orbit *o, const sgt_ray *ray, const sgt_options *opt, bool all, sgt_list *list);

/* True if there is only one root in [t - t_err, t + t_err]: F is monotone over twice that.  w has to be
 * set_of the set; it is changed to the path of the ray. */
bool sgt_level_unique(const orbit *o, path *w, const sgt_ray *ray, double t, double t_lo, double t_err);

/* The stretch of t outside which |Q_0| (Mandelbrot: |Q_1|) is above the largest E_k.  If there is none, lo
 * > hi. */
sgt_span sgt_level_span(const orbit *o, const sgt_ray *ray);

/* A guess at the distance to the level set, 0 if F <= 0.  *f is F. */
double sgt_level_estimate(const orbit *o, sgt_vec3 p, double *f);

/* F, and its gradient unless grad is NULL. */
double sgt_level_value(const orbit *o, sgt_vec3 p, sgt_vec3 *grad);

/* How far F can be off at p, in units of F. */
double sgt_level_rounding(const orbit *o, sgt_vec3 p);

/* log |Q_n| / p^n at the first level n with |Q_n| beyond 2^32, or 0 if there is none.  Also its gradient,
 * unless grad is NULL. */
double sgt_level_potential(const orbit *o, sgt_vec3 p, sgt_vec3 *grad);

/* `lanes` of sgt_builtin_ops. */
size_t sgt_level_lanes(const orbit *o, const sgt_tile *tile, const sgt_options *opt);

#endif
