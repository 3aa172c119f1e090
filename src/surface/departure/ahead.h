// SPDX-License-Identifier: MIT
/* ahead.h - a function G of t along a ray, whose roots hold all roots of F: looked along from a point on
 * (ahead.c). */
#ifndef SGT_SURFACE_DEPARTURE_AHEAD_H
#define SGT_SURFACE_DEPARTURE_AHEAD_H

#include "departure.h"

/* What rounding can do: of a sum of at most 2^9 terms, and of as many factors, it is less than this part of
 * the sum of their magnitudes.  AHEAD_LEAST: underflow. */
static const double AHEAD_LOST = 0x1p-43, AHEAD_LEAST = 0x1p-900;

/* G and G' at t, to within err and slope_err; infinite or NaN: not known. */
typedef struct ahead_look {
    double g, slope, err, slope_err;
} ahead_look;

/* Over a stretch: G lies in g, and G'' in bend.  none: F has no root in it, whatever G has. */
typedef struct ahead_over {
    sgt_interval g, bend;
    bool none;
} ahead_over;

/* A polynomial in t, up to t^4, and the sums of the magnitudes of what its coefficients are made of. */
typedef struct ahead_poly {
    int degree;
    double c[5], most[5];
} ahead_poly;

/* Of a root of F behind a point at which |F| is at most f: it is at most `width` behind; the terms of the
 * rule of the start are at least `terms` at it; and |K| at the point is at most `ratio` times that at the
 * root, where G = K F.  false: not known. */
typedef struct ahead_start {
    double width, terms, ratio;
} ahead_start;

typedef struct ahead_ops {
    ahead_look (*at)(const void *w, double t);
    ahead_over (*over)(const void *w, double from, double to);
    /* Has F certainly no root there?  For short stretches. */
    bool (*off)(const void *w, double from, double to);
    /* Has F certainly no root at t or beyond it?  G has the sign `sign` at t. */
    bool (*tail)(const void *w, double t, double sign);
    /* |G'| is at least `least` from t on, as far as matters. */
    bool (*start)(const void *w, double t, double f, double least, ahead_start *out);
} ahead_ops;

sgt_ahead_kind sgt_look_ahead(const ahead_ops *ops, const void *w, sgt_ahead *ahead);

ahead_look sgt_ahead_poly_at(const ahead_poly *p, double t);
/* The range of a polynomial of degree 2 at most.  `to` is finite. */
sgt_interval sgt_ahead_poly_over(const ahead_poly *p, double from, double to);
/* The second derivative. */
ahead_poly sgt_ahead_poly_bend(const ahead_poly *p);
/* Has p the sign `sign`, or is it 0, at t and beyond it? */
bool sgt_ahead_poly_keeps(const ahead_poly *p, double t, double sign);

/* Is each number 0, or far from where a product of four of them underflows or overflows? */
SGT_INLINE bool ahead_usual(const sgt_ray *ray, double c, double c_2)
{
    const double all[] = {ray->o.x, ray->o.y, ray->o.z, ray->d.x, ray->d.y, ray->d.z, c, c_2};
    for (int i = 0; i < 8; i++)
        if (all[i] != 0 && !(fabs(all[i]) > 0x1p-100 && fabs(all[i]) < 0x1p100)) return false;
    return true;
}

/* The least and the greatest of |x|, `off` about it. */
SGT_INLINE sgt_interval ahead_about(double x, double off)
{
    double far = fabs(x);
    off += 0x1p-40 * far;
    return (sgt_interval){larger(far - off, 0), far + off};
}

/* o + t d. */
SGT_INLINE ahead_poly ahead_linear(double o, double d)
{
    return (ahead_poly){1, {o, d, 0, 0, 0}, {fabs(o), fabs(d), 0, 0, 0}};
}

/* k p. */
SGT_INLINE ahead_poly ahead_scaled(ahead_poly p, double k)
{
    for (int i = 0; i <= p.degree; i++) p.c[i] *= k, p.most[i] *= fabs(k);
    return p;
}

SGT_INLINE ahead_poly ahead_sum(ahead_poly p, ahead_poly q)
{
    for (int i = 0; i <= q.degree; i++) p.c[i] += q.c[i], p.most[i] += q.most[i];
    if (q.degree > p.degree) p.degree = q.degree;
    return p;
}

/* Of degree 4 at most. */
SGT_INLINE ahead_poly ahead_product(const ahead_poly *p, const ahead_poly *q)
{
    ahead_poly r = {.degree = p->degree + q->degree};
    for (int i = 0; i <= p->degree; i++)
        for (int j = 0; j <= q->degree; j++)
            r.c[i + j] += p->c[i] * q->c[j], r.most[i + j] += p->most[i] * q->most[j];
    return r;
}

#endif
