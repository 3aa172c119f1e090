// SPDX-License-Identifier: MIT
/* q_con.c - Forbes' strong aspheres: P = v^2 S(v), v = (r / norm)^2, S = sum of a[m] Qcon_m(v), where
 * Qcon_m(v) = P_m^(0,4)(2 v - 1) of Jacobi.
 *
 * The recurrence is that of Jacobi's polynomials (Abramowitz and Stegun, 22.7.1) with alpha = 0, beta = 4,
 * in v.  q.h sums it.
 *
 * BOUNDS.  With u = r / norm each term is R(u) = u^4 Qcon_m(u^2).  That is the radial polynomial of
 * Zernike of degree n = 2 m + 4 and order 4, with R(1) = 1.  So on [0, 1]
 *     |R| <= 1,    |R'| <= R'(1) = N = (n (n + 2) - 16) / 2,    |R''| <= R''(1) = ((2 N - 4) N + 32) / 4,
 * because R' is a sum of radial polynomials with coefficients that are not negative (Janssen 2014, J. Eur.
 * Opt. Soc. Rapid Publ. 9, 14028).  By Bernstein's inequality, with sine^2 = 1 - u^2,
 *     |R'| <= n / sine,    |R''| <= (n^2 + n u / sine) / sine^2.
 * Near the axis the maxima of the polynomials themselves are lower.  They are at v = 0 (Szego, Orthogonal
 * Polynomials, 7.32):
 *     |Q| <= B4,    |Q'| <= (m + 5) B5,    |Q''| <= (m + 5) (m + 6) B6,
 * where Bi is the binomial coefficient of m + 4 over i.  Beyond u = 1 all three
 * increase, and are greatest at the far end (radial.h).  Next to 1 they are at most q_growth(u)^n times as
 * great.
 *
 * These bounds of terms add up to ten times what terms of both signs do.  Where that matters, P'' and P'/r
 * are asked at some nodes (samples.h).
 *
 * The second derivative of P is P'' along the radius and P'/r across it.  Bounds on P'' are enough: P'/r
 * is a mean of P'' over [0, r]. */
#include "q.h"
#include "radial.h"
#include "samples.h"

static q_step con_step(size_t m)
{
    double k = (double)m, den = (k + 1) * (k + 2) * (k + 5), square = (k + 2) * (k + 3), odd = 2 * k + 5;
    return (q_step){-odd * (square + 4) / den, 2 * odd * square / den,
                    (k + 1) * (k + 4) * (k + 5) / ((k + 2) * (k + 3) * (k + 6))};
}

/* Apart, so that what is asked far more often is not longer. */
SGT_NOINLINE static bounds con_beyond_norm(size_t m, double u) { return radial_beyond(m, 4, u); }

/* Bounds on R, R' and R'' over [0, u]. */
static bounds con_term_bounds(size_t m, double u)
{
    if (u > FAR_BEYOND) return con_beyond_norm(m, u);
    double k = (double)m, n = 2 * k + 4, N = 0.5 * (n * (n + 2) - 16), v = u * u, sine2 = 1 - v,
           sine = sqrt(larger(sine2, 0));
    double b4 = (k + 4) * (k + 3) * (k + 2) * (k + 1) / 24, q1 = (k + 5) * (b4 * k / 5),
           q2 = q1 * (k + 6) * (k - 1) / 6;
    bounds e = {1, N, 0.25 * ((2 * N - 4) * N + 32)},
           bernstein = {1, n / sine, (n * n + n * u / sine) / sine2};
    double lost = u > 0 ? Q_LOST : 0;
    bounds axis = {v * v * b4 + lost, u * v * (4 * b4 + 2 * v * q1) + lost,
                   v * (12 * b4 + v * (18 * q1 + v * 4 * q2)) + lost};
    if (u < 1 && bernstein.steep < e.steep) e.steep = bernstein.steep;
    if (u < 1 && bernstein.bend < e.bend) e.bend = bernstein.bend;
    if (axis.size < e.size) e.size = axis.size;
    if (axis.steep < e.steep) e.steep = axis.steep;
    if (axis.bend < e.bend) e.bend = axis.bend;
    double grown = u > 1 ? q_power(q_growth(u), 2 * m + 4) : 1;
    return (bounds){e.size * grown, e.steep * grown, e.bend * grown};
}

/* With the factor v^2: v^2 Q = R, v^3 Q' = (u R' - 4 R) / 2. */
static q_weight con_weigh(size_t m, double v)
{
    double u = sqrt(v);
    bounds e = con_term_bounds(m, u);
    return (q_weight){e.size, 0.5 * u * e.steep + 2 * e.size};
}

static bounds con_all_bounds(const sgt_q_con *s, double r)
{
    double u = r / s->norm * (1 + 0x1p-50);
    bounds sum = {0, 0, 0};
    for (size_t m = 0, terms = q_terms(s->a); m < terms; m++) {
        bounds e = con_term_bounds(m, u);
        double a = fabs(s->a.x[m]);
        if (a > 0) sum.size += a * e.size, sum.steep += a * e.steep, sum.bend += a * e.bend;
    }
    return (bounds){q_bound(sum.size), q_bound(sum.steep / s->norm), q_bound(sum.bend / s->norm / s->norm)};
}

/* R_(m+1) / R_m increases where u >= 1, as all zeros are nearer and lie between each other. */
static double con_tail(const void *self, double radius)
{
    const sgt_q_con *s = self;
    double u = radius / s->norm * (1 - 0x1p-50);
    double size[Q_TERMS];
    size_t terms = q_terms(s->a);
    if (!(u >= 1)) return 0;
    for (size_t m = 0; m < terms; m++) size[m] = con_beyond_norm(m, u).size;
    return radial_tail(size, 0, terms, s->a.x, NULL, false);
}

/* Q_m = (-1)^m B4 2F1(-m, m + 5; 5; v), as P_m^(0,4)(x) = (-1)^m P_m^(4,0)(-x) (Szego 1975, 4.1.3 and
 * 4.21.2). */
static bool con_profile(const void *self, sgt_profile *out)
{
    const sgt_q_con *s = self;
    const size_t terms = q_terms(s->a);
    if (terms == 0 || terms + 2 > PROFILE_TERMS) return false;
    *out = (sgt_profile){.terms = terms + 2, .norm2 = s->norm * s->norm, .from = s->norm};
    for (size_t m = 0; m < terms; m++) {
        double k = (double)m, a = s->a.x[m], b4 = (k + 4) * (k + 3) * (k + 2) * (k + 1) / 24,
               term = m % 2 ? -a * b4 : a * b4;
        for (size_t j = 0; j <= m; j++) {
            double i = (double)j;
            out->c[j + 2] += term, out->size[j + 2] += fabs(term);
            term *= -(k - i) * (k + 5 + i) / ((5 + i) * (1 + i));
        }
    }
    return true;
}

static int con_bounds_over(const void *self, region *where, bounds *out)
{
    *out = con_all_bounds(self, where->r_hi);
    return 1;
}

/* P = v (v S), grad P = (x, y) v (2 S + v S') 2 / norm^2. */
SGT_INLINE void q_con_in(size_t n, size_t terms, const double *a, double norm2, const double *restrict x,
                         const double *restrict y, sag_values out)
{
    double *restrict p = out.p, *restrict px = out.px, *restrict py = out.py;
    double v[DEPARTURE_BLOCK], s[DEPARTURE_BLOCK], ds[DEPARTURE_BLOCK], scale = 2 / norm2;
    LANES for (size_t i = 0; i < n; i++) v[i] = (x[i] * x[i] + y[i] * y[i]) / norm2;
    q_sum(con_step, terms, a, n, v, s, ds);
    LANES for (size_t i = 0; i < n; i++) {
        double G = v[i] * sgt_fma(v[i], ds[i], s[i] + s[i]) * scale;
        p[i] = v[i] * (v[i] * s[i]);
        px[i] = x[i] * G, py[i] = y[i] * G;
    }
}

/* For a single point the compiler removes the inner loops. */
SGT_KERNEL
static void q_con_at(size_t n, size_t terms, const double *a, double norm2, const double *x, const double *y,
                     sag_values out)
{
    if (n == 1) q_con_in(1, terms, a, norm2, x, y, out);
    else q_con_in(n, terms, a, norm2, x, y, out);
}

static void con_at(const void *self, size_t n, const double *x, const double *y, sag_values out)
{
    const sgt_q_con *s = self;
    q_con_at(n, q_terms(s->a), s->a.x, s->norm * s->norm, x, y, out);
}

/* v is off by 4 u v, which is 2 u r in r.  That moves P by P' times as much.  It moves the gradient, r G,
 * by 2 u r |P'' - G|. */
typedef struct con_off { double p, slope, slope_err; } con_off;

static con_off con_off_at(const sgt_q_con *s, double r2, double r)
{
    double v = r2 / (s->norm * s->norm);
    const size_t terms = q_terms(s->a);
    q_weight weights[Q_TERMS];
    for (size_t m = 0; m < terms; m++) weights[m] = con_weigh(m, v);
    q_rounded e = q_rounding(con_step, weights, terms, s->a.x, NULL, 1, v);
    double inner = sgt_fma(v, e.ds, e.s + e.s), by_r = 2 / r * (v * v), slope = fabs(by_r * inner),
           p = fabs(v * (v * e.s)),
           slope_err = v > 0 ? 2 / r * (2 * e.s_err + e.ds_err) + 7 * SGT_U * slope : 0,
           off = 1.01 * (e.s_err + 2 * SGT_U * p + 2 * SGT_U * r * (v > 0 ? slope + slope_err : 0));
    return (con_off){off, slope, slope_err};
}

static void con_rounding(const void *self, double x, double y, double *p_err, double *grad_err)
{
    const sgt_q_con *s = self;
    double r2 = x * x + y * y, r = sqrt(r2);
    con_off e = con_off_at(s, r2, r);
    bounds b = con_all_bounds(s, r * (1 + 0x1p-40));
    *p_err = e.p, *grad_err = 1.01 * (e.slope_err + 4 * SGT_U * r * b.bend);
    if (b.size > 0) *p_err += 0x1p-1000, *grad_err += 0x1p-1000;
}

/* Where a term is not 0, its bound is not. */
static double con_size_rounding(const void *self, double x, double y)
{
    const sgt_q_con *s = self;
    double r2 = x * x + y * y, r = sqrt(r2), off = con_off_at(s, r2, r).p;
    return r > 0 && q_terms(s->a) > 0 ? off + 0x1p-1000 : off;
}

/* What q_rounding and the rest of `rounding` would sum to for a[m] = 1, over v.  Its maximum over v <= 1
 * is below (m + 1)^2 (12.5 + (m + 1)^2 / 30) for each m.  (Computed at 20,000 v: 12, 49, 99.7, 164 for the
 * first, 5.47e5 for the last.) */
static void con_noise(const void *self, double radius, double e[2])
{
    const sgt_q_con *s = self;
    double grown = q_growth(radius / s->norm), sum = 0;
    for (size_t m = 0, terms = q_terms(s->a); m < terms; m++) {
        double square = ((double)m + 1) * ((double)m + 1);
        sum += fabs(s->a.x[m]) * square * (12.5 + square / 30) * q_most(q_power(grown, 2 * m + 4));
    }
    e[0] = 0, e[1] = 1.01 * SGT_U * sum / (s->norm * s->norm);
}

/* By v, P' = v (2 S + v S') and P'' = 2 S + v (4 S' + v S''). */
SGT_KERNEL
SGT_NARROW(void, sgt_q_con_second,
           (const void *self, size_t n, const double *restrict x, const double *restrict y,
            double *restrict pxx, double *restrict pxy, double *restrict pyy))
{
    const sgt_q_con *con = self;
    const double norm2 = con->norm * con->norm;
    double v[DEPARTURE_BLOCK], s[DEPARTURE_BLOCK], ds[DEPARTURE_BLOCK], dds[DEPARTURE_BLOCK],
        scale = 2 / norm2;
    LANES for (size_t i = 0; i < n; i++) v[i] = (x[i] * x[i] + y[i] * y[i]) / norm2;
    q_second(con_step, q_terms(con->a), con->a.x, n, v, s, ds, dds);
    LANES for (size_t i = 0; i < n; i++) {
        double G = v[i] * sgt_fma(v[i], ds[i], 2 * s[i]) * scale,
               bent = scale * scale * sgt_fma(v[i], sgt_fma(v[i], dds[i], 4 * ds[i]), 2 * s[i]);
        pxx[i] = sgt_fma(x[i] * x[i], bent, G);
        pxy[i] = x[i] * y[i] * bent;
        pyy[i] = sgt_fma(y[i] * y[i], bent, G);
    }
}

/* P'' along the radius and P'/r across it are polynomials of v, of degree `terms` at most.  They are summed
 * to less than 2^-30 of `most`, the sum of the bounds of their terms (16 of them; Clenshaw, as in q.h). */
static bool q_con_bent(const void *self, double radius, double most, sgt_interval *out)
{
    const sgt_q_con *s = self;
    const size_t nodes = SAMPLES_A_DEGREE * q_terms(s->a);
    double x[DEPARTURE_BLOCK], y[DEPARTURE_BLOCK], along[DEPARTURE_BLOCK], mixed[DEPARTURE_BLOCK],
        across[DEPARTURE_BLOCK], lo = HUGE_VAL, hi = -HUGE_VAL;
    if (nodes == 0 || nodes > DEPARTURE_BLOCK) return false;
    /* v = (1 + cos a) / 2 where u = cos(a / 2) */
    for (size_t j = 0; j < nodes; j++) x[j] = radius * sample_node(j, 2 * nodes), y[j] = 0;
    sgt_q_con_second(self, nodes, x, y, along, mixed, across);
    bool finite = true;
    for (size_t j = 0; j < nodes; j++) {
        double low = along[j] < across[j] ? along[j] : across[j], high = larger(along[j], across[j]);
        finite &= fabs(along[j]) + fabs(across[j]) < HUGE_VAL;
        lo = lo < low ? lo : low, hi = larger(hi, high);
    }
    *out = sampled_range(lo, hi, 0x1p-30 * most);
    return finite;
}

static size_t con_parameters(const void *self)
{
    sgt_numbers a = ((const sgt_q_con *)self)->a;
    return a.rows * a.columns;
}

SGT_NARROW(void, sgt_q_con_by_parameter,
           (const void *self, size_t j, size_t n, const double *x, const double *y, sag_values out))
{
    const sgt_q_con *s = self;
    double unit[Q_TERMS] = {0};
    unit[j] = 1;
    q_con_at(n, j + 1, unit, s->norm * s->norm, x, y, out);
}

static sgt_objection con_object(const void *self)
{
    const sgt_q_con *s = self;
    if (!(s->norm > 0 && s->norm < HUGE_VAL)) return (sgt_objection){"norm", "must be above 0"};
    return object_to_list("coefficients", s->a, Q_TERMS, "must have at most 64 numbers");
}

static const departure q_con_departure = {
    .at = con_at, .rounding = con_rounding, .bounds = con_bounds_over, .second = sgt_q_con_second,
    .parameters = con_parameters, .by_parameter = sgt_q_con_by_parameter, .object = con_object,
    .noise = con_noise, .size_rounding = con_size_rounding,
    .tail = con_tail, .bent = q_con_bent, .profile = con_profile};

DEPARTURE_ON_CONIC(q_con, sgt_q_con)
