// SPDX-License-Identifier: MIT
/* sag.h - the conic base that every sag has: its formulas, its domain and its span. */
#ifndef SGT_SURFACE_SAG_SAG_H
#define SGT_SURFACE_SAG_SAG_H

#include "../builtin.h"

/* s(r^2) = c r^2 / (1 + phi), with phi = sqrt(1 - (1 + k) c^2 r^2).  *slope is ds/d(r^2) = c / (2 phi).
 * NaN outside the domain. */
SGT_INLINE double conic_sag(double c, double k, double r2, double *phi, double *slope)
{
    double cr2 = c * r2;
    *phi = sqrt(1 - (1 + k) * c * cr2);
    if (*phi == HUGE_VAL) { /* c^2 r^2 has overflowed: the sag is on the asymptote, to the last bit */
        double sag = copysign(sqrt(r2 / -(1 + k)), c);
        *slope = sag / (2 * r2);
        return sag;
    }
    *slope = c / (2 * *phi);
    return cr2 / (1 + *phi);
}

/* How far conic_sag can be off, in units of u.  r2 carries 3 roundings, and (1 + k) c (c r^2) five more.
 * So phi^2 is off by u (9 |1 + k| c^2 r^2 + 1), and phi by that / (2 phi) + u phi.  s follows phi by
 * |ds/dphi| = |s| / (1 + phi), and adds 6 roundings of its own. */
SGT_INLINE double conic_sag_rounding(double c, double k, double r2, double s, double phi)
{
    return fabs(s) * (6 + (9 * fabs((1 + k) * c * c * r2) + 1 + 2 * phi * phi) / (2 * phi * (1 + phi)));
}

/* A squared slope.  Beyond it snap leaves z as it is, except where x and y round by ulps of z, and the
 * careful forms treat the point. */
static const double STEEP2 = 64;

/* x^2 + y^2 = hi + lo, exact but for the rounding of lo. */
SGT_INLINE twofold square_radius(double x, double y)
{
    twofold xx = two_product(x, x), yy = two_product(y, y), r2 = two_sum(xx.hi, yy.hi);
    return (twofold){r2.hi, r2.lo + (xx.lo + yy.lo)};
}

/* s(x, y) to a few roundings of itself near the equator, where phi^2 is a small difference. */
double sgt_conic_sag_fine(double c, double k, double x, double y);

/* Computes z anew from x and y in two cases: the surface is not steep, or rounding of x and y alone would
 * be ulps of z.  Then F(p) is within a few roundings of its terms, however small these are.  Examples are a
 * chief ray near the vertex, and a strongly oblate conic.  The point moves along z by at most the slope
 * times the error in x and y.  p is P(r^2) of an asphere, known to p_err. */
SGT_INLINE void snap(meeting *h, double c, double k, twofold r2, double p, double p_err)
{
    double steep2 = h->n.x * h->n.x + h->n.y * h->n.y;
    h->sag = NAN;
    if (!(r2.hi > TINY) && (h->p.x != 0 || h->p.y != 0)) return; /* r^2 has underflowed */
    double inherited = steep2 <= STEEP2 ? 0 : fabs(h->p.x * h->n.x) + fabs(h->p.y * h->n.y);
    if (steep2 <= STEEP2 || (inherited * inherited > 4 * h->p.z * h->p.z * (1 + steep2) && steep2 < 0x1p40)) {
        double phi, slope, rough = conic_sag(c, k, r2.hi, &phi, &slope), sag = rough + slope * r2.lo;
        if (!(phi > 0.5)) sag = sgt_conic_sag_fine(c, k, h->p.x, h->p.y);
        if (!(fabs(sag) < HUGE_VAL)) return;
        h->sag = rough;
        h->p.z = sag + p;
        h->p_err = (1 + (fabs(h->n.x) + fabs(h->n.y))) * h->p_err * (1 + 0x1p-20)
                 + SGT_U * (24 * fabs(sag) + fabs(h->p.z)) + p_err; /* 24: conic_sag_rounding at phi = 1/2 */
    }
}

/* The stretch of the ray, in its own t, where r^2 <= radius2 (1 + 2^-43).  If radius2 is infinite, it is
 * the whole ray.  If lo > hi, the ray passes outside. */
typedef struct stretch { double lo, hi; } stretch;
stretch sgt_chord(const sgt_ray *ray, double radius2);

/* The square of the largest r within the rim at which the sag is defined.  It is never so small that
 * squares lose digits. */
SGT_INLINE double domain2_within(double c, double k, double rim2)
{
    double k1 = 1 + k, edge = k1 > 0 && c != 0 ? 1 / (fabs(c) * sqrt(k1)) : HUGE_VAL,
           edge2 = larger(edge * edge * (1 + 16 * SGT_U), TINY);
    return rim2 < edge2 ? rim2 : edge2;
}

SGT_INLINE double domain2_of(double c, double k, double semi_diameter)
{
    return domain2_within(c, k, rim2_of(semi_diameter));
}

/* The span of a sag on a conic base.  It is the chord of its domain, with the conic's root near the vertex
 * as the seed.  Set `bare` if the sag is that conic and nothing else; only then can `single` be set. */
sgt_span sgt_sag_span(double c, double k, double semi_diameter, const sgt_ray *ray, bool bare);

#endif
