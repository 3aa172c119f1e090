// SPDX-License-Identifier: MIT
/* conic.h - the conic by its parameters.  An asphere without terms calls it. */
#ifndef SGT_SURFACE_CONIC_CONIC_H
#define SGT_SURFACE_CONIC_CONIC_H

#include "../sag/sag.h"

/* As the members of sgt_builtin_ops.  c: curvature (1/length); k: conic constant; semi_diameter: length, 0
 * if there is no rim.  opt is never NULL. */
sgt_hit sgt_conic_meet(double c, double k, double semi_diameter, const sgt_ray *ray, const sgt_options *opt);
sgt_status sgt_conic_all(double c, double k, double semi_diameter, const sgt_ray *ray,
                         const sgt_options *opt, sgt_list *list);
size_t sgt_conic_lanes(double c, double k, double semi_diameter, const sgt_tile *tile,
                       const sgt_options *opt);
void sgt_conic_on(double c, double k, size_t n, const double *const p[3], double on[]);
void sgt_conic_behind(double c, double k, size_t n, const sgt_rays *rays, double side[]);
size_t sgt_conic_leave(double c, double k, double semi_diameter, const sgt_tile *tile, double behind[]);
bool sgt_conic_unique(double c, double k, double semi_diameter, const sgt_tile *tile, double rim2,
                     unsigned long long unique[], sgt_interval others[]);

#endif
