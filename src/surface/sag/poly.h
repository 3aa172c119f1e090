// SPDX-License-Identifier: MIT
/* poly.h - a sag in polynomial form, with bounds.  The equation and the bounds are derived in poly.c. */
#ifndef SGT_SURFACE_SAG_POLY_H
#define SGT_SURFACE_SAG_POLY_H

#include "sag.h"

/* P(rho) = sum of a[i] rho^(i+1), and *slope = P'. */
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

/* Returns first = sum of (i+1) |a[i]| rho^i and, in *second, its derivative.  first is a bound on |P'| and
 * second on |P''|, both on all of [0, rho].  |P| <= rho first.  Horner's rule rounds the term a[i]
 * rho^(i+1) at most 2i + 2 times.  So P is off by at most 2 u rho first (Higham 2002, section 5.1). */
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

/* A sag as it is solved.  ck is (1 + k) c.  terms is the number of coefficients; 0: a conic. */
typedef struct shape { double c, k, ck; int terms; const double *a; double rim2, domain2; } shape;

/* steep^2 r2, used as a limit on n^2 / a.  A limit of 2^500 or more is taken as infinite.  Below that, a
 * may have lost something to underflow (l and m tiny, n not), but even limit times that loss is far below
 * n^2.  A slope below LEAST_STEEP is raised to it, so that its square does not underflow. */
static const double LEAST_STEEP = 0x1p-250;

SGT_INLINE double bounded_limit(double steep, double r2)
{
    steep = steep < LEAST_STEEP ? LEAST_STEEP : steep; /* NaN stays */
    double limit = steep * steep * r2;
    return limit < 0x1p500 ? limit : HUGE_VAL;
}

/* If n^2 is above this limit times a = l^2 + m^2, F is monotone along the chord within the rim.  Infinite
 * without a rim, or if the equator is inside. */
SGT_INLINE double single_limit(const shape *s)
{
    double r2 = s->domain2, unused, phi2 = 1 - s->ck * s->c * r2;
    if (!(r2 < HUGE_VAL && phi2 > 0x1p-30 && phi2 < HUGE_VAL)) return HUGE_VAL;
    double steep = (fabs(s->c) / sqrt(phi2) + 2 * magnitude(s->terms, s->a, r2, &unused)) * (1 + 0x1p-20);
    return bounded_limit(steep, r2);
}

/* Which rays have such a chord?  Sets unique[i] to all bits set if ray i has, else to 0.  Returns true if
 * all have. */
bool sgt_lanes_monotone(const shape *s, const sgt_tile *tile, unsigned long long unique[]);

/* The same with a limit given by the caller. */
bool sgt_lanes_steeper(double limit, const sgt_tile *tile, unsigned long long unique[]);

/* G at one point of the ray, and what is known of it. */
typedef struct sample {
    double g, slope;          /* G and dG/dtau */
    double g_err, slope_err;  /* how far they can be off */
    double lost, slope_lost;  /* the part of that due to underflow */
    double v, v_err;          /* 1 - (1 + k) c w */
    double w, w_err, dw;      /* w = z - P, and dw/dtau */
    double dp;                /* P' */
    double first, second;     /* magnitude() at rho */
    double x, y, z, ex, ey, ez;
} sample;

/* G, its slope and their parts, without errors. */
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

/* Adds the errors to a sample of poly_at. */
void sgt_poly_bound(const shape *s, const local *q, double tau, sample *e);

/* poly_at, then sgt_poly_bound. */
sample sgt_poly_sample(const shape *s, const local *q, double tau);

/* The same with G, its slope and v in twice the precision.  The local origin of q is q->t0 + q->t0_lo. */
sample sgt_poly_sample_fine(const shape *s, const sgt_ray *ray, const local *q, double tau);

/* A bound on |d2G/dtau2| over [tau - h, tau + h].  at: the sample at tau. */
double sgt_poly_bend(const shape *s, const local *q, const sample *at, double h);

/* True if certainly no root on the sheet lies in [tau - h, tau + h]: there z - P and the conic's sag have
 * no value in common.  at: the sample at tau. */
bool sgt_poly_apart(const shape *s, const local *q, const sample *at, double h);

/* The sign of F itself, from z - P against s.  0 if the sign is not certain, or if the point is not
 * certainly in the domain. */
int sgt_poly_side(const shape *s, const sample *at);

/* Is there a root near tau?  If so, returns true with the root and its bound in *out, after one Newton step
 * from tau.  *steady: a further step would gain nothing. */
bool sgt_poly_certify(const shape *s, const local *q, const sample *at, double tau, double t_tol,
                      meeting *out, double *v_err, bool *steady);

/* F, its gradient and a bound on its rounding at n points: the bits of `value` and `rounding` of a conic or
 * an even asphere. */
void sgt_sag_values_rounded(const shape *s, size_t n, sgt_points p, sgt_values out, double own[]);

/* Is the root the start itself, however it is computed (rule of sgt_ray)? */
SGT_INLINE bool is_start(const meeting *h, const sgt_ray *ray, double scale)
{
    double terms = h->v * (fabs(h->p.x * h->n.x) + fabs(h->p.y * h->n.y) + fabs(h->p.z)),
           width = START_ULPS * terms * scale / h->slope;
    return h->t + h->t_err <= ray->tmin + (width < HUGE_VAL ? width : 0) * (1 - 0x1p-20);
}

/* Settles the root near t0 + t0_lo (scaled), with the origin moved there.  Of a root that is the start
 * itself the last bits are not asked for.  Returns false if the root is too flat to be certified, if the
 * budget of evaluations is spent, or if the watcher stops. */
bool sgt_poly_settle(const shape *s, const sgt_ray *ray, double t0, double t0_lo, meeting *out, double *v_err,
                     tally *w);

/* True if there is only one root in [t - t_err, t + t_err]: G is monotone over twice that.  Costs one
 * evaluation. */
bool sgt_poly_unique(const shape *s, const sgt_ray *ray, const meeting *at, tally *w);

/* g and g' over t0 + t, as `enclose` of sgt_builtin_ops.  The method is in enclose.c. */
sgt_interval sgt_sag_enclose(const shape *s, const sgt_ray *ray, double t0, sgt_interval t,
                             sgt_interval *slope);

/* Tells the watcher of F, not of G, at tau from q->t0 + q->t0_lo of the ray. */
SGT_COLD void sgt_poly_tell(const shape *s, const sgt_ray *ray, tally *w, const local *q, double tau,
                            sgt_move move, double lo, double hi);

/* Counts one evaluation of G, and reports it to the watcher, if there is one. */
SGT_INLINE void observe(const shape *s, const sgt_ray *ray, tally *w, const local *q, double tau,
                        sgt_move move, double lo, double hi)
{
    if (w->opt->watch) sgt_poly_tell(s, ray, w, q, tau, move, lo, hi);
    else w->evals++;
}

SGT_INLINE double asphere_f(const shape *s, sgt_vec3 p)
{
    double r2 = p.x * p.x + p.y * p.y, phi, slope, dp;
    return p.z - (conic_sag(s->c, s->k, r2, &phi, &slope) + polynomial(s->terms, s->a, r2, &dp));
}

#endif
