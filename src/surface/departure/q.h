// SPDX-License-Identifier: MIT
/* q.h - what Forbes' polynomials of a radius share: a sum of orthogonal polynomials in v = (r / norm)^2.
 *
 * p_0 = 1, p_1 = alpha_0 + beta_0 v, p_(m+1) = (alpha_m + beta_m v) p_m - gamma_m p_(m-1).  The sum S of
 * b[m] p_m and its derivatives by v are computed from the last term on (Clenshaw 1955, Math. Tables Aids
 * Comput. 9, 118):
 *     s_m = b[m] + (alpha_m + beta_m v) s_(m+1) - gamma_(m+1) s_(m+2),                     S = s_0,
 *     d_m = (alpha_m + beta_m v) d_(m+1) - gamma_(m+1) d_(m+2) + beta_m s_(m+1),           S' = d_0,
 * and so on.
 *
 * ROUNDING.  Let rounding add e_m to s_m, and e'_m to d_m.  It acts as if e_m were added to b[m].  So S is
 * off by exactly the sum of e_m p_m, and S' by that of e_m p_m' and of e'_m p_m.  |e_m| is known from the
 * computed s_m, and |p_m| and |v p_m'| from the theory of the polynomials.  So the bound does not grow by
 * a factor for each term, as the recurrence of magnitudes would. */
#ifndef SGT_SURFACE_DEPARTURE_Q_H
#define SGT_SURFACE_DEPARTURE_Q_H

#include "departure.h"

enum { Q_TERMS = 64 };

/* gamma is that of m + 1. */
typedef struct q_step { double alpha, beta, gamma; } q_step;
typedef q_step q_steps(size_t m);

/* Of a q_bfs: S is the sum of b[m] p_m, p_0 = 1, p_1 = 3 - 4 v, p_(m+1) = (2 - 4 v) p_m - p_(m-1).  b_err:
 * how far each b is off.  Returns how many there are.  (q_bfs.c) */
size_t sgt_q_bfs_basis(const sgt_q_bfs *s, double b[Q_TERMS], double b_err[Q_TERMS]);

/* The length of the list without the zeros at its end. */
SGT_INLINE size_t q_terms(sgt_numbers a)
{
    size_t terms = a.rows * a.columns;
    while (terms > 0 && a.x[terms - 1] == 0) terms--;
    return terms;
}

/* Two terms at a time, to save loads and stores.  If their number is odd, a zero is put before them. */
SGT_INLINE void q_sum(q_steps *step, size_t terms, const double *b, size_t n, const double *restrict v,
                      double *restrict s, double *restrict ds)
{
    double s2[DEPARTURE_BLOCK], ds2[DEPARTURE_BLOCK];
    LANES for (size_t i = 0; i < n; i++) s[i] = ds[i] = s2[i] = ds2[i] = 0;
    for (size_t m = terms + terms % 2; m > 0; m -= 2) {
        q_step e = step(m - 1), f = step(m - 2);
        double eb = m > terms ? 0 : b[m - 1], fb = b[m - 2];
        LANES for (size_t i = 0; i < n; i++) {
            double te = sgt_fma(e.beta, v[i], e.alpha), tf = sgt_fma(f.beta, v[i], f.alpha);
            double de = sgt_fma(te, ds[i], sgt_fma(e.beta, s[i], -e.gamma * ds2[i])),
                   se = sgt_fma(te, s[i], sgt_fma(-e.gamma, s2[i], eb));
            double df = sgt_fma(tf, de, sgt_fma(f.beta, se, -f.gamma * ds[i])),
                   sf = sgt_fma(tf, se, sgt_fma(-f.gamma, s[i], fb));
            s2[i] = se, ds2[i] = de, s[i] = sf, ds[i] = df;
        }
    }
}

SGT_INLINE void q_second(q_steps *step, size_t terms, const double *b, size_t n, const double *restrict v,
                         double *restrict s, double *restrict ds, double *restrict dds)
{
    double s2[DEPARTURE_BLOCK], ds2[DEPARTURE_BLOCK], dds2[DEPARTURE_BLOCK];
    LANES for (size_t i = 0; i < n; i++) s[i] = ds[i] = dds[i] = s2[i] = ds2[i] = dds2[i] = 0;
    for (size_t m = terms; m-- > 0;) {
        q_step e = step(m);
        double bm = b[m];
        LANES for (size_t i = 0; i < n; i++) {
            double t = sgt_fma(e.beta, v[i], e.alpha);
            double dde = sgt_fma(t, dds[i], sgt_fma(2 * e.beta, ds[i], -e.gamma * dds2[i])),
                   de = sgt_fma(t, ds[i], sgt_fma(e.beta, s[i], -e.gamma * ds2[i]));
            double se = sgt_fma(t, s[i], sgt_fma(-e.gamma, s2[i], bm));
            dds2[i] = dds[i], ds2[i] = ds[i], s2[i] = s[i], dds[i] = dde, ds[i] = de, s[i] = se;
        }
    }
}

/* s >= f |p_m|, ds >= f |v p_m'|, where the factor f may depend on v. */
typedef struct q_weight { double s, ds; } q_weight;

/* S and S'; f times the error of S of q_sum, and f v times that of its S'.  v is exact.  b_err: the errors
 * of b; NULL: b is exact.  step_err: the error of alpha, beta and gamma, in u.
 *
 * Without fma, which may be a function call.  The numbers differ from those of q_sum by at most their
 * errors.  That changes the bound by u times as much. */
typedef struct q_rounded { double s, ds, s_err, ds_err; } q_rounded;

SGT_INLINE q_rounded q_rounding(q_steps *step, const q_weight *weights, size_t terms, const double *b,
                                const double *b_err, double step_err, double v)
{
    double s = 0, ds = 0, s2 = 0, ds2 = 0, s_err = 0, ds_err = 0;
    for (size_t m = terms; m-- > 0;) {
        q_step e = step(m);
        q_weight w = weights[m];
        double t = e.beta * v + e.alpha, t_err = fabs(t) + step_err * (fabs(e.alpha) + fabs(e.beta * v));
        double h = b[m] - e.gamma * s2, dh = e.beta * s - e.gamma * ds2, sm = t * s + h, dsm = t * ds + dh;
        double err = SGT_U * (t_err * fabs(s) + step_err * fabs(e.gamma * s2) + fabs(h) + fabs(sm)) +
                     (b_err ? b_err[m] : 0);
        double derr = SGT_U * (t_err * fabs(ds) + step_err * fabs(e.beta * s) +
                               (1 + step_err) * fabs(e.gamma * ds2) + fabs(dh) + fabs(dsm));
        s_err += w.s * err;
        ds_err += w.ds * err + w.s * (v * derr);
        s2 = s, ds2 = ds, s = sm, ds = dsm;
    }
    return (q_rounded){s, ds, s_err, ds_err};
}

/* A polynomial of degree n that is at most 1 on [-1, 1] is at most this to the power n at u > 1
 * (Chebyshev): ln |T_n| grows as n times its logarithm. */
SGT_INLINE double q_growth(double u) { return u > 1 ? u + sqrt(u * u - 1) : 1; }

/* w^n. */
SGT_INLINE double q_power(double w, size_t n)
{
    double p = 1;
    for (; n > 0; n /= 2, w *= w)
        if (n % 2) p *= w;
    return p;
}

/* T_n(u), u > 1, from the power n of q_growth: what such a polynomial is at most. */
SGT_INLINE double q_most(double power) { return 0.5 * (power + 1 / power); }

/* What underflows in a bound of one term.  It is negligible by itself, but the coefficient may be large. */
#define Q_LOST 0x1p-1040

/* A bound, rounded upward.  NaN becomes no bound. */
SGT_INLINE double q_bound(double x) { return x < HUGE_VAL ? x * (1 + 0x1p-40) : HUGE_VAL; }

#endif
