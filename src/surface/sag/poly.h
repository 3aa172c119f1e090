/* poly.h - a sag in polynomial form, with bounds: poly.c says how. */
#ifndef SGT_SURFACE_SAG_POLY_H
#define SGT_SURFACE_SAG_POLY_H

#include "sag.h"

/* P(rho) = sum of a[i] rho^(i+1) and P'. */
SGT_INLINE double polynomial(int terms, const double *a, double rho, double *slope)
{
    double h = terms ? a[terms - 1] : 0, dh = 0;
    for (int i = terms - 2; i >= 0; i--) {
        dh = dh * rho + h;
        h = h * rho + a[i];
    }
    *slope = h + rho * dh;
    return rho * h;
}

/* first = sum of (i+1) |a[i]| rho^i, a bound on |P'|, and its derivative, a bound on |P''|, both for
 * all of [0, rho].  |P| <= rho first.  Horner's rule rounds the term a[i] rho^(i+1) at most 2i + 2
 * times, so P is off by at most 2 u rho first (Higham 2002, section 5.1). */
SGT_INLINE double magnitude(int terms, const double *a, double rho, double *second)
{
    double h = terms ? terms * fabs(a[terms - 1]) : 0, dh = 0;
    for (int i = terms - 2; i >= 0; i--) {
        dh = dh * rho + h;
        h = h * rho + (i + 1) * fabs(a[i]);
    }
    *second = dh;
    return h;
}

/* A sag as it is solved: its terms counted (none: a conic), (1 + k) c at hand. */
typedef struct shape { double c, k, ck; int terms; const double *a; double rim2, domain2; } shape;

/* steep^2 r2.  From 2^500 on it is no limit: below, what has underflown in a, where l and m are tiny and n is
 * not, is far below n^2 even so times.  A slope below LEAST_STEEP is taken for that, so that its square does
 * not underflow. */
static const double LEAST_STEEP = 0x1p-250;

SGT_INLINE double bounded_limit(double steep, double r2)
{
    steep = steep < LEAST_STEEP ? LEAST_STEEP : steep; /* NaN stays */
    double limit = steep * steep * r2;
    return limit < 0x1p500 ? limit : HUGE_VAL;
}

/* F is monotone along the chord within the rim where n^2 is above this times a; infinite without a rim, or
 * with the equator inside. */
SGT_INLINE double single_limit(const shape *s)
{
    double r2 = s->domain2, unused, phi2 = 1 - s->ck * s->c * r2;
    if (!(r2 < HUGE_VAL && phi2 > 0x1p-30 && phi2 < HUGE_VAL)) return HUGE_VAL;
    double steep = (fabs(s->c) / sqrt(phi2) + 2 * magnitude(s->terms, s->a, r2, &unused)) * (1 + 0x1p-20);
    return bounded_limit(steep, r2);
}

/* Rays whose chord is so: alone[i] has all bits set, else 0; true: all of them. */
bool sgt_lanes_monotone(const shape *s, const sgt_tile *tile, unsigned long long unique[]);

/* The same with a limit of the caller's. */
bool sgt_lanes_steeper(double limit, const sgt_tile *tile, unsigned long long unique[]);

/* G at one point of the ray, and what is known of it. */
typedef struct sample {
    double g, slope;          /* G and dG/dtau */
    double g_err, slope_err;  /* how far they can be off */
    double lost, slope_lost;  /* what of that is underflow */
    double v, v_err;          /* 1 - (1 + k) c w */
    double w, w_err, dw;      /* z - P, dw/dtau */
    double dp;                /* P' */
    double first, second;     /* magnitude() at rho */
    double x, y, z, ex, ey, ez;
} sample;

/* G, its slope, and what they are made of; no errors yet. */
SGT_INLINE sample poly_at(const shape *s, const local *q, double tau)
{
    sample e;
    e.x = q->x + tau * q->l, e.y = q->y + tau * q->m, e.z = q->z + tau * q->n;
    double rho = e.x * e.x + e.y * e.y, half_drho = e.x * q->l + e.y * q->m;
    e.w = e.z - polynomial(s->terms, s->a, rho, &e.dp);
    e.v = 1 - s->ck * e.w;
    e.dw = q->n - 2 * e.dp * half_drho;
    e.g = e.w - 0.5 * (s->c * rho + s->ck * e.w * e.w);
    e.slope = e.v * e.dw - s->c * half_drho;
    return e;
}

/* Adds the errors. */
void sgt_poly_bound(const shape *s, const local *q, double tau, sample *e);

/* Both. */
sample sgt_poly_sample(const shape *s, const local *q, double tau);

/* The same with G itself in twice the precision; q->t0 + q->t0_lo is the local origin. */
sample sgt_poly_sample_fine(const shape *s, const sgt_ray *ray, const local *q, double tau);

/* A bound on |d2G/dtau2| over [tau - h, tau + h]; at: the sample at tau. */
double sgt_poly_bend(const shape *s, const local *q, const sample *at, double h);

/* No root on the sheet in [tau - h, tau + h], for certain: there z - P and the conic's sag have no value
 * in common.  at: the sample at tau. */
bool sgt_poly_apart(const shape *s, const local *q, const sample *at, double h);

/* The sign of F itself, z - P against s: 0 where it is not certain, or the point not certainly in the
 * domain. */
int sgt_poly_side(const shape *s, const sample *at);

/* Is there a root near tau, and how near?  On true, *out has the root with its bound, one
 * Newton step from tau.  steady says that a further step would bring nothing. */
bool sgt_poly_certify(const shape *s, const local *q, const sample *at, double tau, double t_tol,
                      meeting *out, double *v_err, bool *steady);

/* From t0 + t0_lo (scaled, near a root) with the origin moved there.  false: the root is too flat. */
bool sgt_poly_settle(const shape *s, const sgt_ray *ray, double t0, double t0_lo, meeting *out, double *v_err,
                     tally *w);

/* There is no root but one in [t - t_err, t + t_err]: G is monotone over twice as much.  One evaluation. */
bool sgt_poly_unique(const shape *s, const sgt_ray *ray, const meeting *at, tally *w);

/* g and g' over t0 + t (sgt_builtin_ops, enclose): enclose.c says how. */
sgt_interval sgt_sag_enclose(const shape *s, const sgt_ray *ray, double t0, sgt_interval t,
                             sgt_interval *slope);

/* One evaluation told to the watcher, in the ray's t. */
SGT_INLINE void observe(tally *w, const local *q, double tau, const sample *e, sgt_move move, double lo,
                        double hi)
{
    tell(w, move, (q->t0 + (q->t0_lo + tau)) * q->scale, e->g, e->slope / q->scale, (q->t0 + lo) * q->scale,
         (q->t0 + hi) * q->scale);
}

SGT_INLINE double asphere_f(const shape *s, sgt_vec3 p)
{
    double r2 = p.x * p.x + p.y * p.y, phi, slope, dp;
    return p.z - (conic_sag(s->c, s->k, r2, &phi, &slope) + polynomial(s->terms, s->a, r2, &dp));
}

#endif
