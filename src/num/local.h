// SPDX-License-Identifier: MIT
/* local.h - a ray made local: the origin moved near the surface, the direction scaled.
 *
 * THE DIRECTION is scaled by a power of two, so that its largest component lies in [1, 2).  t_ray = t *
 * scale, exactly.
 *
 * THE ORIGIN is moved to a point t0 of the ray near the surface, by error-free products and sums or by one
 * fma.  So the new origin is right to a relative u in each coordinate, however far the old one was: a ray
 * from 1e12 away is as good as one from nearby.
 *
 * WHERE TO depends on the caller:
 *
 *     the vertex plane, z = 0 (local_at_vertex_plane)     conic, asphere: the constant term of the conic's
 *                                                         equation, c r^2, is then free of cancellation
 *     the point nearest the vertex (nearest_to_vertex)    rays nearly parallel to that plane
 *     the point nearest the axis                          chords: sag/chord.c
 *     a root, to polish it                                sag/poly.c
 *     the seed, the middle of the span, or the point      surfaces met by their operations: step.h
 *     nearest the origin of the frame
 *     nearest the set's centre; the middle of a stretch   level sets: orbit/course.h, orbit/julia.c */
#ifndef SGT_NUM_LOCAL_H
#define SGT_NUM_LOCAL_H

#include "exact.h"

#include <float.h>
#include <sagitta/sagitta.h>
#include <string.h>

static const double TINY = 0x1p-960;        /* below it, rounding is no longer relative */
static const double LEAST_PLACE = 0x1p-480; /* a smaller number has a square below TINY */

typedef struct local {
    double x, y, z;       /* the local origin */
    double xa, ya, za;    /* its x is off by at most u * xa, and so on; |x| if it is right to u */
    double l, m, n;       /* the scaled direction */
    double t0, t0_lo;     /* the local origin is o + (t0 + t0_lo) d, in t of the scaled d */
    double t0_err;        /* t0_lo is off by at most this */
    double scale;         /* t_ray = t * scale */
} local;

/* The power of two that brings the largest component of d to [1, 2). */
SGT_INLINE double scale_of(sgt_vec3 d)
{
    double big = larger(fabs(d.x), larger(fabs(d.y), fabs(d.z)));
    unsigned long long bits;
    memcpy(&bits, &big, sizeof bits);
    bits = (2046ULL << 52) - (bits & 0x7ff0000000000000ULL); /* 2^-e from 2^e */
    double scale;
    memcpy(&scale, &bits, sizeof scale);
    return big < 0x1p1023 ? scale : 0x1p-1023;
}

/* An end of a stretch in the ray's own t, outward.  If it is subnormal, the product loses less than
 * DBL_MIN. */
SGT_INLINE double end_below(double t, double scale) { return t * scale - DBL_MIN; }
SGT_INLINE double end_above(double t, double scale) { return t * scale + DBL_MIN; }

/* One coordinate of o + t0 d, right to u of itself however far o is. */
SGT_INLINE double moved_along(double o, double t0, double d) { return sgt_fma(t0, d, o); }

/* 1 / scale_of(d), exactly: the power of two in its largest component. */
SGT_INLINE double inverse_of_scale(sgt_vec3 d)
{
    double big = larger(fabs(d.x), larger(fabs(d.y), fabs(d.z)));
    unsigned long long bits;
    memcpy(&bits, &big, sizeof bits);
    bits &= 0x7ff0000000000000ULL;
    memcpy(&big, &bits, sizeof big);
    return big;
}

/* The local origin where the ray meets the vertex plane; NaN if n = 0. */
SGT_INLINE local local_at_vertex_plane(const sgt_ray *ray)
{
    local q;
    q.scale = scale_of(ray->d);
    q.l = ray->d.x * q.scale, q.m = ray->d.y * q.scale, q.n = ray->d.z * q.scale;
    double inverse = 1 / q.n;
    q.t0 = -ray->o.z * inverse;
    /* what t0 leaves of z is a double, up to a last bit: the quotient is within an ulp or two */
    q.t0_lo = sgt_fma(-q.t0, q.n, -ray->o.z) * inverse;
    twofold px = two_product(q.t0, q.l), py = two_product(q.t0, q.m);
    twofold sx = two_sum(ray->o.x, px.hi), sy = two_sum(ray->o.y, py.hi);
    q.x = sx.hi + (sx.lo + px.lo + q.t0_lo * q.l);
    q.y = sy.hi + (sy.lo + py.lo + q.t0_lo * q.m);
    q.z = 0;
    q.t0_err = 8 * SGT_U * fabs(q.t0_lo);
    /* the small terms are below 4 u (|o| + |t0 l|), and rounded four times */
    q.xa = fabs(q.x) + 16 * SGT_U * (fabs(ray->o.x) + fabs(px.hi));
    q.ya = fabs(q.y) + 16 * SGT_U * (fabs(ray->o.y) + fabs(py.hi));
    q.za = 0;
    return q;
}

/* One coordinate of o + (t0 + t0_lo) d, right to 3 u^2 of the greater of the result and t0_lo d. */
SGT_INLINE twofold coordinate(double o, double d, double t0, double t0_lo)
{
    return twofold_sum(twofold_sum(twofold_of(o), two_product(t0, d)), two_product(t0_lo, d));
}

/* The local origin at t0 + t0_lo, in t of the scaled direction. */
SGT_INLINE local local_at(const sgt_ray *ray, double t0, double t0_lo)
{
    local q;
    q.scale = scale_of(ray->d);
    q.l = ray->d.x * q.scale, q.m = ray->d.y * q.scale, q.n = ray->d.z * q.scale;
    q.t0 = t0, q.t0_lo = t0_lo, q.t0_err = 0;
    q.x = coordinate(ray->o.x, q.l, t0, t0_lo).hi;
    q.y = coordinate(ray->o.y, q.m, t0, t0_lo).hi;
    q.z = coordinate(ray->o.z, q.n, t0, t0_lo).hi;
    q.xa = fabs(q.x), q.ya = fabs(q.y), q.za = fabs(q.z);
    return q;
}

/* Have products with t0 underflown?  The local origin's coordinates are then off by 2^-1070 at most. */
SGT_INLINE bool place_underflows(const local *q)
{
    double x = fabs(q->l * q->t0), y = fabs(q->m * q->t0), z = fabs(q->n * q->t0);
    return q->t0 != 0 && ((q->l != 0 && x < TINY) || (q->m != 0 && y < TINY) || (q->n != 0 && z < TINY));
}

/* Was the direction scaled exactly, with no component underflown? */
SGT_INLINE bool direction_is_whole(const local *q, sgt_vec3 d)
{
    double inverse = inverse_of_scale(d);
    return q->l * inverse == d.x && q->m * inverse == d.y && q->n * inverse == d.z;
}

/* Does neither end underflow in the t of the scaled direction?  An end that becomes 0 would be where the
 * ray starts. */
SGT_INLINE bool ends_are_whole(const sgt_ray *ray, double scale)
{
    return ray->tmin / scale * scale == ray->tmin && ray->tmax / scale * scale == ray->tmax;
}

/* Is the ray, all the way to p at t, so near the vertex that squares of its coordinates have underflown,
 * and t_err does not cover it? */
SGT_INLINE bool place_is_tiny(const local *q, double t, sgt_vec3 p)
{
    double far = larger(fabs(p.x), larger(fabs(p.y), fabs(p.z)));
    return far > 0 && far < LEAST_PLACE && fabs(t) < LEAST_PLACE * q->scale;
}

/* The t0 nearest the vertex, right to an ulp or so, which is enough. */
SGT_INLINE double nearest_to_vertex(const sgt_ray *ray)
{
    double s = scale_of(ray->d), l = ray->d.x * s, m = ray->d.y * s, n = ray->d.z * s;
    return -(ray->o.x * l + ray->o.y * m + ray->o.z * n) / (l * l + m * m + n * n);
}

#endif
