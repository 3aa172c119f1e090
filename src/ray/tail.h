// SPDX-License-Identifier: MIT
/* tail.h - the part of a ray far out at which nothing is met, known at once.
 *
 * Of many sags the last terms outgrow all others from some radius on (sgt_builtin_ops.tail): the sag is
 * s L (r / R)^2 or more beyond R, with s = +-1 and L > 0.  On the ray r^2 = r0^2 + a w^2, with w counted from
 * the point nearest the axis, z0 the height there, and z = z0 +- n w.  So on one side of that point nothing
 * is met at R and beyond if s z < L at R, and the sag grows faster than s z from there on:
 *
 *     2 a w L >= R^2 g at R, where g = +-s n is the slope of s z outward, or g <= 0.
 *
 * (The left side is R^2 times the slope of L (r / R)^2, and grows with w.)  R is one of a table, so many rays
 * share what is known of it: powers of two, and eighths of one. */
#ifndef SGT_RAY_TAIL_H
#define SGT_RAY_TAIL_H

#include "../surface/builtin.h"

/* What is known of the tail beyond some radii, each at a place of its own; radius 0: the place is empty.
 * any: not all are. */
enum { TAILS = 16 };
typedef struct sgt_tails { bool any; double radius[TAILS], least[TAILS]; } sgt_tails;

/* A ray about the point nearest the axis, its direction scaled to 1 ... 2 by a power of two, and t with it: t
 * there; bounds on r^2; z, and what it may be off; n, and l^2 + m^2. */
typedef struct sgt_outlook { double t, near2, far2, z, off, n, a; } sgt_outlook;

sgt_outlook sgt_outlook_of(sgt_vec3 o, sgt_vec3 d);

/* How far from that point the ray is at r2, if r^2 is least2 there; 0 if it is nowhere so near, or that is
 * not known. */
SGT_INLINE double sgt_way_to(const sgt_outlook *e, double r2, double least2)
{
    double w2 = (r2 - least2) / e->a;
    return w2 > 0 && w2 < HUGE_VAL ? sqrt(w2) : 0;
}

/* The next three are for a surface that is `tailed` (sgt_shared).  On the way in from t, where the ray is at
 * most r from the axis, or the surface ends at r: the last t before which nothing is certainly met, or t. */
double sgt_past_tail(sgt_surface s, const sgt_outlook *e, double t, double r, sgt_tails *kept);

/* Is nothing met at this radius and beyond, on the way in (side -1), or out (1)? */
bool sgt_clear_beyond(sgt_surface s, const sgt_outlook *e, double radius, double side, sgt_tails *kept);

/* Is nothing met from t on, on the way out? */
bool sgt_leaves_by_tail(sgt_surface s, const sgt_outlook *e, double t, sgt_tails *kept);

/* A t, not before `from`, up to which the ray is above or below every piece of a surface of these heights
 * that it passes; HUGE_VAL: all along. */
double sgt_clear_by_heights(const sgt_heights *g, const sgt_ray *ray, double from);

/* Is it so all along? */
bool sgt_passes_by(const sgt_heights *g, const sgt_ray *ray, double from);

/* Cuts the span to where a root may be. */
void sgt_cut_tails(sgt_surface s, const sgt_ray *ray, sgt_span *span, sgt_tails *kept);

#endif
