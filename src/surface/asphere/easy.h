// SPDX-License-Identifier: MIT
/* asphere/easy.h - an asphere met as in a lane: no branch, a fixed number of evaluations, a bound at the
 * end.
 *
 * G = w - (c rho + (1 + k) c w^2) / 2 with rho = x^2 + y^2 and w = z - P(rho) (poly.c).  It is taken along
 * (x0, y0, 0) + tau d, from the point on the vertex plane.
 *
 * WHY APART.  The polynomial form has no square root, and its second derivative has a bound at hand.  So a
 * few rounds prove a root.  Instructions as multiples (even aspheres of tests/cost/cases.c, 400 rays, by
 * callgrind for x86-64-v3):
 *
 *                                               first root     with a rim   near the seed
 *     as a user's surface, one ray              11             2.9          3.1
 *     as a user's surface, a batch              111            17           18
 *     without this file, one ray                9.1            1.9          2.0
 *     without the loops (lanes = NULL), a batch 10             11           11
 *
 * THE SEED.  The conic by itself has A tau^2 - 2 B tau + C = 0.  With e = A C / B^2 its root near the
 * vertex is tau = C / (2 B) (1 + e/4 + ...).  There G' = B sqrt(1 - e), so 1 / G' = (1 + e/2 + ...) / B.
 * No square root is needed: what the series omit is less than P.  If |e| >= 15/16, a ray is not easy: it
 * grazes the conic, with a slope below a quarter of that at the vertex plane, and would take rounds in vain.
 * One step with that slope from G, P included, gives the start.  Nor is a ray easy if |B| > 8 |n|: it comes
 * from the side, and meets the vertex plane too far from its root (rho0 > 4 rho, below).
 *
 * A ROUND is two steps.  The first is Newton's step from tau_1 to tau_2, with G and G'.  The second
 * evaluates G only and reuses the slope: tau_3 = tau_2 + step, step = -G(tau_2) / s, with s = G'(tau_1) as
 * computed.  Lens surfaces are done after one round.  A ray that is not done takes another round from
 * tau_3, if the second step was at most half the first.
 *
 * SHARP ENOUGH.  e below bounds the rounding of G.  If it is at most 24 u (|w| + |z|), as for a conic, the
 * result is as sharp as the sag.  If it is more, terms cancel.  Or c = 0: first Q counts a[i] some 11 (i + 1)
 * times, so a Schmidt plate, a[1] r^4 alone, has e = 24.6 u |z|.  Then the result is taken where neither t
 * nor the point needs more:
 *     e / |s| <= 4 u |t0|, so tau_err <= 1.16 * 9/8 * 4 u |t0| + u |tau|, and t_err <= 7 u |t0| if |tau| is
 *         at most |t0| / 4 (for a plate 5 away, 5.7e-16 for 2.2e-16; lane_of refuses more than 40 u |t|),
 *     e <= 4 u r: the point is known across the surface as well as its own x and y are.
 * That holds up to r^6.  Higher powers multiply the rounding of rho by more: of r^10 a point was 13 ulps of
 * the largest term off the surface, and 12 are allowed (tests/oracle/test_random.cpp).
 * Other forms, in twice the precision, are sharper, at 8 to 140 times the cost.  THE BOUND holds for any e:
 * this is no part of the proof.
 *
 * THE BOUND.  Let H = |tau_2 - tau_1| + 2 |step| + 2^-40 |tau_2| + 2^-50 |t0|, and M >= |G''| within H of
 * tau_2.  Let G' there differ from s by at most Delta = 2 M H + 2^-30 |s| <= |s| / 8.  Then G' keeps its
 * sign, and |G'| >= 7/8 |s|.  G(tau_2) is known to e.  So the root exists, it lies within 8/7 (|G| + e) /
 * |s| <= 4/7 H of tau_2, and by the mean value theorem
 *     |root - tau_3| <= 8/7 (e + |step| Delta) / |s|.
 * It is the only root within H, and [t - t_err, t + t_err] is inside: |step| and that bound are below 0.6
 * H.  Putting t together loses 2 u (|t0| + 2 |tau|), below a quarter of what H allows for it.  So each
 * root is proven.  Its side of the rim is decided as for a conic (conic/easy.h), with tau_err in place of
 * 48 u |tau|.
 *
 * M = |c| a + |(1 + k) c| (W1^2 + |w| W2) + W2 (poly.c), with a = l^2 + m^2.  It uses first = sum (i+1)
 * |a_i| rho^i >= |P'| at the largest rho of the cell, rho' = 1.0625 rho + 17 a H^2 >= (sqrt rho + H sqrt
 * a)^2:
 *     |w'| <= W1 = |n| + 2 first (|x l| + |y m| + 2 a H), with x and y at tau_1,
 *     |w''| <= W2 = 2 a first (2 T - 1) for T terms,
 *         since |P''| <= (T - 1) first / rho' and (x l + y m)^2 <= rho' a.
 *
 * ROUNDING, in units of u = 2^-53.  x0 is off by 2 |x0|, and x by that and |x|.  2 (|x x0| + |y y0|) <=
 * rho + rho0, so rho is off by 6 rho + 2 rho0.  P is off by first times that and 2 rho first (each of T
 * fmas rounds once).  With Q = 9 rho + 2 rho0
 *     w is off by first Q + |z| + |w|,
 *     G by e = |v| (error of w) + |c| Q / 2 + 3 |w| (1 + |(1 + k) c w|),  v = 1 - (1 + k) c w.
 * s is off by at most 2^-37 of the sum of the magnitudes of its terms, 2 W1 + |c| |x l + y m|.  (v
 * contributes |(1 + k) c| e / |v| W1, with e < 2^-46 / |(1 + k) c| and |v| > 2^-8.)  That sum has to be
 * below 64 |s|.  rho0 <= 4 rho is required: a start not too far away.  Underflow, that of z at t0
 * included, is below 2^-1060 in G.
 *
 * BY CONSTANTS.  Half of the work of a round is that bound.  So another one is asked first, with sums of the
 * surface instead of the ray's own; rays that it leaves get THE BOUND.  The constants are those of a disc of
 * radius R, D = R^2, in which the terms are weak (wavy_constants).  With F = `first` at D and chi =
 * |(1 + k) c^2| D
 *     F <= |c| / 8,  chi <= 1/2,
 * and on the sheet within the disc |(1 + k) c w| <= kappa = chi / 2 + 0.172 chi^2 <= 0.293: it is
 * 1 - sqrt(1 - chi), or, if 1 + k < 0, sqrt(1 + chi) - 1 <= chi / 2.  Without such a disc (c = 0, or strong
 * terms) THE BOUND alone is asked.
 *
 * The cell is within the disc if 17/16 rho + 17 a H^2 <= D.  Then |x l + y m| <= R sqrt a there, and with
 * B = |n| + q sqrt a, q = (2 F + |c|) R,
 *     |w'| <= B,  |w''| <= a W with W = 2 F (2 T - 1),  B^2 <= N2 = 5/4 n^2 + 5 q^2 a.
 * M = (|c| + (1.1 + kappa) W) a + |(1 + k) c| N2, if |(1 + k) c w| <= kappa + 0.1 in the cell.  It is: at
 * tau_2 it is at most kappa.  Let it change by at most y <= |(1 + k) c| B H from there.  s is a slope in the
 * cell, of v w' and c (x l + y m), so |s| <= (1 + kappa + y) B.  Delta <= |s| / 8 bounds 2 M H, and M holds
 * |(1 + k) c| B^2.  So y B <= |(1 + k) c| B^2 H <= |s| / 16, and y <= (1.3 + y) / 16 < 0.09.  So the root is
 * on the sheet, too.
 *
 * e = q1 (9 rho + 2 rho0) + q2 |z| + q3 |w|, as |v| <= V = 1 + kappa: q1 = V F + |c| / 2, q2 = V, q3 = 4 V.
 * The magnitudes of the terms of s are at most 2 B, and N2 < 2^10 s^2 takes that to 64 |s|.  |v| at tau_1 is
 * at least 0.6, and |(1 + k) c| times what w is off by there is below 2^-46: rho0 <= 4 rho <= 4 D makes
 * Q <= 17 D, |(1 + k) c w| is below 0.4, |(1 + k) c| F D at most 1/16, and |z| at most |w| + F D.
 * H = |tau_2 - tau_1| + 2 (|step| + e / |s|) + 2^-40 |tau_2| + 2^-50 |t0|, so 2 (|G| + e) / |s| <= H.
 * |step| Delta <= e / 8 is asked for, whatever t_tol.  The rounding of tau_3 by 2 u |step| is less than what
 * 1.16 - 8/7 leaves of |step| 2^-30; that by u |tau_3| is added.
 *
 * SHARP ENOUGH needs no test.  On the sheet |w| >= 0.44 |c| rho, as 1 + sqrt(1 + chi) <= 2.23, and
 * |z| >= |w| - F rho.  With rho0 <= 4 rho the first part of e is at most 11.5 u |c| rho.  Of 25 u (|z| + |w|)
 * the others leave 23.6 u |z| + 19.7 u |w|, which is 16.1 u |c| rho at least.
 *
 * STRONG TERMS.  Where the disc is less than an eighth of what the rim encloses, most rays would ask the
 * constants in vain, and would not be done after one round.  So they are not asked, and two more of Newton's
 * steps come before the first round.
 *
 * t_err is at most 14.4 % wider than by THE BOUND, 2 % in the mean: observed, 720,000 rays of 60 surfaces.
 * tests/unit/test_disc.c compares the constants with what they stand for. */
#ifndef SGT_SURFACE_ASPHERE_EASY_H
#define SGT_SURFACE_ASPHERE_EASY_H

#include "../../num/bits.h"
#include "../sag/poly.h"
#include "../sag/lanes.h"

enum { ROUNDS = 4, MOST_EASY = 2 * ROUNDS + 4, FEW_TERMS = 4, ALL_TERMS = 8 }; /* MOST_EASY: evaluations */

static const double STRONG = -2;

/* What all rays of a surface share. */
typedef struct wavy {
    double c, abs_c, k, k1, ck, abs_ck;
    double a[ALL_TERMS], slope[ALL_TERMS], size[ALL_TERMS];  /* a_i, (i+1) a_i, its magnitude */
    double bend;              /* 2 (2 T - 1) */
    double rim2, single;      /* n^2 > single a: at most one root within the rim */
    double domain2;           /* r^2 of the rim or the equator */
    double room;              /* of a proof: 98 u rims; rim2 is then where a root is certain */
    bool proof;
    bool side;                /* what is left goes to the form from the side: GRAZING in side.h */
    double enough;            /* 4 u, or 0: SHARP ENOUGH */
    double most_e;            /* 2^-46 / |ck|: v, at least 2^-8, is off by at most 2^-38 */
    /* BY CONSTANTS.  disc: D, or -1, or STRONG.  wide: 2 F + |c|; n1 a + 1.25 n^2 = N2; m1 a + m2 N2 = 2 M; e
     * with u.  first: n^2 > first a: F is monotone within the disc. */
    double disc, kappa, wide, n1, m1, m2, q1, q2, q3, first;
} wavy;

/* Returns false if no ray of the surface is easy. */
SGT_INLINE bool wavy_of(const shape *s, bool proof, wavy *v)
{
    double rim2 = s->rim2 < 0x1p1000 ? s->rim2 : 0x1p1000;
    *v = (wavy){.c = s->c,
                .abs_c = fabs(s->c),
                .k = s->k,
                .k1 = 1 + s->k,
                .ck = s->ck,
                .abs_ck = fabs(s->ck),
                .bend = 2 * (2 * s->terms - 1),
                .rim2 = proof ? sure_rim2(rim2) : rim2,
                .room = proof ? 98 * SGT_U * sqrt(rim2) : 0,
                .proof = proof,
                .single = single_limit(s),
                .domain2 = s->domain2,
                .enough = s->terms <= 4 ? 4 * SGT_U : 0,
                .most_e = s->ck == 0 ? HUGE_VAL : 0x1p-46 / fabs(s->ck),
                .disc = -1};
    double number = 1;
    for (int i = 0; i < s->terms; i++, number++)
        v->a[i] = s->a[i], v->slope[i] = number * s->a[i], v->size[i] = fabs(v->slope[i]);
    return v->abs_c < 0x1p60 && fabs(s->k) < 0x1p60;
}

/* Is a direction with this square of usual length? */
SGT_INLINE mask usual_length(double d2) { return MASK(d2 > 0x1p-78) & MASK(d2 < 0x1p78); }

/* Written out: a loop inside the loop over rays would keep the compiler from vectorising that. */
SGT_INLINE double horner(const double *a, int terms, double rho)
{
    double h = 0;
    if (terms > FEW_TERMS)
        h = sgt_fma(sgt_fma(sgt_fma(sgt_fma(a[7], rho, a[6]), rho, a[5]), rho, a[4]), rho, a[3]);
    else h = a[3];
    return sgt_fma(sgt_fma(sgt_fma(h, rho, a[2]), rho, a[1]), rho, a[0]);
}

/* log2 |x| + 1023 in steps of 2^-40, off by less than 0.09. */
SGT_INLINE long long rough_log2(double x)
{
    long long bits;
    memcpy(&bits, &x, sizeof bits);
    return (bits & 0x7fffffffffffffff) >> 12;
}

/* r^2 up to which (i + 1) |a[i]| r^(2 i) is some 2^-(3.6 + i) |c| at most.  A guess will do; but in another
 * unit of length, by a power of two, it has to be the same.  So it is made of integers. */
SGT_INLINE double wavy_weak2(const shape *s)
{
    const long long octave = 1LL << 40, up = 2048 * octave; /* above 0 a quotient is rounded down */
    long long c = rough_log2(s->c) - 17 * octave / 4, least = 2222 * octave;
    for (int i = 1; i < s->terms; i++) {
        c += up;
        long long of = (c - rough_log2(s->a[i])) / i;
        least = of < least ? of : least;
    }
    least += 1023 * octave - 11 * octave / 8 - up;
    least = least > 0 ? least << 12 : 0;
    double r2;
    memcpy(&r2, &least, sizeof r2);
    return r2;
}

/* The constants of BY CONSTANTS, of what wavy_of has made.  disc stays -1 if there is no such disc, and is
 * STRONG if the terms are (STRONG TERMS). */
SGT_INLINE void wavy_constants(const shape *s, wavy *v)
{
    const double c = v->abs_c;
    if (!(c > 0x1p-60)) return;
    const double most = larger(v->abs_ck * c, 0.125 * (c * c)); /* the sheet; a slope of the base of 2 */
    double D = 1.125 * s->rim2, F = HUGE_VAL;
    D = D * most < 0.5 ? D : 0.5 / most;
    if (s->rim2 < HUGE_VAL) F = horner(v->size, ALL_TERMS, D);
    if (!(F <= 0.08 * c)) D = smaller(wavy_weak2(s), D), F = horner(v->size, ALL_TERMS, D);
    F *= 1 + 0x1p-40;
    if (s->rim2 < HUGE_VAL && 8 * D < s->rim2) {
        v->disc = STRONG;
        return;
    }
    if (!(F <= 0.125 * c && D > 0x1p-400 && D < 0x1p400)) return;
    const double chi = v->abs_ck * c * D,
                 kappa = chi * sgt_fma(0.172, chi, 0.5) * (1 + 0x1p-20), V = 1 + kappa,
                 wide = 2 * F + c, u = 1.01 * SGT_U, steep = 1.5 * c + 2 * F;
    v->disc = D, v->kappa = kappa, v->wide = wide, v->n1 = 5 * (wide * wide * D);
    v->m1 = 2 * sgt_fma(1.1 + kappa, v->bend * F, c), v->m2 = 2 * v->abs_ck;
    v->q1 = u * (V * F + 0.5 * c), v->q2 = u * V, v->q3 = u * (4 * V);
    v->first = steep * steep * D * (1 + 0x1p-18);
}

/* `horner` with the derivative. */
SGT_INLINE double horner_slope(const double *a, int terms, double rho, double *slope)
{
    double h = a[3], d = 0;
    if (terms > FEW_TERMS) {
        h = sgt_fma(a[7], rho, a[6]), d = a[7];
        d = sgt_fma(d, rho, h), h = sgt_fma(h, rho, a[5]);
        d = sgt_fma(d, rho, h), h = sgt_fma(h, rho, a[4]);
        d = sgt_fma(d, rho, h), h = sgt_fma(h, rho, a[3]);
    }
    d = sgt_fma(d, rho, h), h = sgt_fma(h, rho, a[2]);
    d = sgt_fma(d, rho, h), h = sgt_fma(h, rho, a[1]);
    d = sgt_fma(d, rho, h), h = sgt_fma(h, rho, a[0]);
    *slope = d;
    return h;
}

/* The ray at the vertex plane, and tau of the start. */
typedef struct wavy_start { double x, y, t0, t0_lo, tau; } wavy_start;

SGT_INLINE double wavy_g(const wavy *s, double rho, double z, double h, double *w, double *ckw)
{
    *w = sgt_fma(-rho, h, z), *ckw = s->ck * *w;
    return sgt_fma(-0.5, sgt_fma(s->c, rho, *ckw * *w), *w);
}

SGT_INLINE wavy_start wavy_begin(const wavy *s, int terms, const vertex_place *at, const sgt_ray *ray,
                                 double *g, double *slope)
{
    const double l = ray->d.x, m = ray->d.y, n = ray->d.z;
    wavy_start r = {.x = at->x, .y = at->y, .t0 = at->t0, .t0_lo = at->t0_lo};
    double a = l * l + m * m, A = s->c * sgt_fma(s->k1, n * n, a), B = sgt_fma(-s->c, r.x * l + r.y * m, n),
           C = s->c * (r.x * r.x + r.y * r.y);
    double inverse = 1 / B, q = C * inverse, e = A * inverse * q,
           tau = q * sgt_fma(0.125, e, 0.5), w, ckw;
    tau = chosen(MASK(fabs(e) < 0.9375) & MASK(B * B <= 64 * (n * n)), tau, (double)NAN);
    double x = sgt_fma(tau, l, r.x), y = sgt_fma(tau, m, r.y), rho = x * x + y * y;
    *g = wavy_g(s, rho, tau * n, horner(s->a, terms, rho), &w, &ckw);
    *slope = B;
    r.tau = tau - *g * (inverse * sgt_fma(0.5, e, 1));
    return r;
}

/* The first half of a round: Newton's step from tau_1 to tau_2.  It keeps the inverse of the slope,
 * dw/dtau, and slant = |x l| + |y m|.  g and slope are for a watcher. */
typedef struct wavy_newton { double tau2, step2, inverse, dw, slant, g, slope, tau1; } wavy_newton;

SGT_INLINE wavy_newton wavy_half(const wavy *s, int terms, double x0, double y0, double tau1,
                                 const sgt_ray *ray)
{
    const double l = ray->d.x, m = ray->d.y, n = ray->d.z;
    double x = sgt_fma(tau1, l, x0), y = sgt_fma(tau1, m, y0), rho = x * x + y * y, w, ckw, xl = x * l,
           ym = y * m, half = xl + ym;
    double dh, h = horner_slope(s->a, terms, rho, &dh), dp = sgt_fma(rho, dh, h);
    double g = wavy_g(s, rho, tau1 * n, h, &w, &ckw), dw = sgt_fma(-(dp + dp), half, n);
    double slope = sgt_fma(-s->c, half, (1 - ckw) * dw), inverse = 1 / slope, step2 = g * inverse;
    return (wavy_newton){tau1 - step2, step2, inverse, dw, fabs(xl) + fabs(ym), g, slope, tau1};
}

/* STRONG TERMS: the start after two more steps, if they lead anywhere. */
SGT_INLINE double wavy_strong(const wavy *s, int terms, double x0, double y0, double tau, const sgt_ray *ray)
{
    const double one = wavy_half(s, terms, x0, y0, tau, ray).tau2,
                 next = wavy_half(s, terms, x0, y0, one, ray).tau2;
    return chosen(MASK(fabs(next) < HUGE_VAL), next, tau);
}

/* The result of a round.  tau and tau_err: the root with its bound, which is NaN if nothing is certain.
 * v: 1 - (1 + k) c w there.  near: for lane_of.  again: another round may succeed where this one did not.
 * g: for a watcher. */
typedef struct wavy_round { double tau, tau_err, v, near, g; mask again; } wavy_round;

SGT_INLINE wavy_round wavy_bound(const wavy *s, int terms, double x0, double y0, double t0,
                                 const wavy_newton *at, const sgt_ray *ray, double t_tol)
{
    const double l = ray->d.x, m = ray->d.y, n = ray->d.z;
    double x = sgt_fma(at->tau2, l, x0), y = sgt_fma(at->tau2, m, y0), rho = x * x + y * y, z = at->tau2 * n,
           w, ckw;
    double g = wavy_g(s, rho, z, horner(s->a, terms, rho), &w, &ckw), step = g * at->inverse, as = fabs(step),
           ai = fabs(at->inverse), aw = fabs(w);
    double a = l * l + m * m, n2 = n * n,
           H = sgt_fma(0x1p-50, fabs(t0), sgt_fma(0x1p-40, fabs(at->tau2), fabs(at->step2) + (as + as))),
           wide = sgt_fma(17 * a, H * H, 1.0625 * rho);
    double first = horner(s->size, terms, wide), rho0 = x0 * x0 + y0 * y0;
    double W1 = sgt_fma(first + first, sgt_fma(a, H + H, at->slant), fabs(n)), W2 = s->bend * (a * first);
    double M = sgt_fma(s->abs_ck, sgt_fma(sgt_fma(W1, H, aw), W2, W1 * W1), sgt_fma(s->abs_c, a, W2));
    double off = sgt_fma(M * (H + H), ai, 0x1p-30); /* Delta / |s| */
    double Q = sgt_fma(9, rho, rho0 + rho0), az = fabs(z), ackw = fabs(ckw);
    double e = 1.01 * SGT_U
               * sgt_fma(fabs(1 - ckw), sgt_fma(first, Q, az + aw),
                         sgt_fma(0.5 * s->abs_c, Q, (3 * aw) * (1 + ackw)));
    double noise = e * ai, tau = at->tau2 - step,
           tau_err
           = sgt_fma(1.16, sgt_fma(as, off, noise), sgt_fma(SGT_U, fabs(tau) + (as + as), 0x1p-1000 * ai));
    double terms_of_slope = sgt_fma(2, W1, s->abs_c * at->slant);
    mask again = MASK(off < 0x1p20), close = MASK(rho0 <= 4 * rho);
    mask sure = again & MASK(off <= 0.125) & MASK(2 * (as + noise) <= H) & MASK(terms_of_slope * ai < 64) &
                close & usual_length(a + n2) & MASK(ackw < 1 - 0x1p-8) & MASK(e < s->most_e) &
                MASK(s->abs_ck * (W1 * H) < 0x1p-10);
    sure &= MASK(e <= 25 * SGT_U * (aw + az)) |
            (MASK(noise <= s->enough * fabs(t0)) & MASK(e * e <= 16 * SGT_U * SGT_U * rho));
    sure &= MASK(8 * (as * off) <= noise) | MASK(tau_err <= 0.5 * t_tol); /* if not, it can be sharper */
    return (wavy_round){.tau = tau,
                        .tau_err = chosen(sure, tau_err, (double)NAN),
                        .v = sgt_fma(s->ck, step * at->dw, 1 - ckw),
                        .near = sgt_fma(ai, sgt_fma(rho, first + (first + s->abs_c), az), fabs(tau)),
                        .g = g,
                        .again = again & ~sure & MASK(as <= 0.5 * fabs(at->step2)) & close &
                                 MASK(rho <= 4 * s->domain2)};
}

/* May BY CONSTANTS have an answer for the cell of a step from tau_1?  If not, wavy_bound_within has none. */
SGT_INLINE mask wavy_within(const wavy *s, double x0, double y0, double tau1, const sgt_ray *ray)
{
    const double l = ray->d.x, m = ray->d.y;
    double x = sgt_fma(tau1, l, x0), y = sgt_fma(tau1, m, y0);
    return MASK(x * x + y * y <= s->disc * (1 + 0x1p-20));
}

/* G at tau_2, for wavy_bound_within. */
typedef struct wavy_second { double rho, w, g; } wavy_second;

SGT_INLINE wavy_second wavy_second_of(const wavy *s, int terms, double x0, double y0, double tau2,
                                      const sgt_ray *ray)
{
    const double l = ray->d.x, m = ray->d.y, n = ray->d.z;
    double x = sgt_fma(tau2, l, x0), y = sgt_fma(tau2, m, y0), rho = x * x + y * y, w, ckw,
           g = wavy_g(s, rho, tau2 * n, horner(s->a, terms, rho), &w, &ckw);
    return (wavy_second){rho, w, g};
}

/* The same by constants of the surface (BY CONSTANTS).  `again` is not set, slant not read. */
SGT_INLINE wavy_round wavy_bound_within(const wavy *s, double x0, double y0, double t0, const wavy_newton *at,
                                        const wavy_second *there, const sgt_ray *ray)
{
    const double l = ray->d.x, m = ray->d.y, n = ray->d.z, rho = there->rho, w = there->w, ckw = s->ck * w;
    double step = there->g * at->inverse, as = fabs(step), ai = fabs(at->inverse), aw = fabs(w),
           az = fabs(at->tau2 * n);
    double a = l * l + m * m, n2 = n * n, rho0 = x0 * x0 + y0 * y0, N2 = sgt_fma(s->n1, a, 1.25 * n2);
    double e = sgt_fma(s->q3, aw,
                       sgt_fma(s->q2, az, sgt_fma(9 * s->q1, rho, sgt_fma(2 * s->q1, rho0, 0x1p-999)))),
           noise = e * ai, tau = at->tau2 - step;
    double H = sgt_fma(2, as + noise,
                       sgt_fma(0x1p-50, fabs(t0), sgt_fma(0x1p-40, fabs(at->tau2), fabs(at->step2)))),
           off = sgt_fma(sgt_fma(s->m2, N2, s->m1 * a) * H, ai, 0x1p-30), both = sgt_fma(as, off, noise),
           tau_err = sgt_fma(1.16, both, SGT_U * fabs(tau));
    mask sure = MASK(off <= 0.125) & MASK(both <= 1.125 * noise) & MASK(N2 * (ai * ai) < 0x1p10) &
                MASK(rho0 <= 4 * rho) & usual_length(a + n2) & MASK(fabs(ckw) <= s->kappa) &
                MASK(a * (H * H) <= sgt_fma(-0.0625, rho, s->disc * (1.0 / 17)));
    return (wavy_round){.tau = tau,
                        .tau_err = chosen(sure, tau_err, (double)NAN),
                        .v = sgt_fma(s->ck, step * at->dw, 1 - ckw),
                        .near = sgt_fma(ai, sgt_fma(rho, s->wide, az), fabs(tau)),
                        .g = there->g};
}

/* Have the constants no answer because the steps were too long, so that they have one after another round?
 * tau: of that round.  (A choice: then THE BOUND, as dear as a round, is not asked.)  tau_1 is within the
 * disc, too: a tile of which no ray is asks no constants, and its rays are not to depend on each other. */
SGT_INLINE mask wavy_nears(const wavy *s, double x0, double y0, const wavy_newton *at, double tau,
                           const sgt_ray *ray)
{
    const double left = fabs(at->tau2 - tau);
    return wavy_within(s, x0, y0, at->tau1, ray) & wavy_within(s, x0, y0, tau, ray) &
           MASK(left <= 0x1p-6 * fabs(at->step2)) & MASK(left > 0x1p-38 * fabs(tau));
}

/* A round of a single ray by constants; tau_err is NaN if they have no answer. */
SGT_INLINE wavy_round wavy_bound_first(const wavy *s, int terms, const wavy_start *r, const wavy_newton *at,
                                       const sgt_ray *ray)
{
    if (!(s->disc > 0)) return (wavy_round){.tau_err = (double)NAN};
    const wavy_second there = wavy_second_of(s, terms, r->x, r->y, at->tau2, ray);
    return wavy_bound_within(s, r->x, r->y, r->t0, at, &there, ray);
}

/* The same, and else by THE BOUND, but for wavy_nears.  last: no other round may follow. */
SGT_INLINE wavy_round wavy_bound_either(const wavy *s, int terms, const wavy_start *r, const wavy_newton *at,
                                        bool last, const sgt_ray *ray, double t_tol)
{
    wavy_round q = wavy_bound_first(s, terms, r, at, ray);
    if (q.tau_err == q.tau_err) return q;
    q.again = MASK(true);
    if (s->disc > 0 && !last && wavy_nears(s, r->x, r->y, at, q.tau, ray)) return q;
    return wavy_bound(s, terms, r->x, r->y, r->t0, at, ray, t_tol);
}

/* |x l| + |y m| at tau_1, as wavy_half has it. */
SGT_INLINE double wavy_slant(double x0, double y0, double tau1, const sgt_ray *ray)
{
    const double l = ray->d.x, m = ray->d.y;
    return fabs(sgt_fma(tau1, l, x0) * l) + fabs(sgt_fma(tau1, m, y0) * m);
}

/* Is the root certainly within the rim, given that its point as computed is within rim2? */
SGT_INLINE mask wavy_sure(const wavy *s, double x, double y, double t0, double tau_err, double l, double m)
{
    return MASK(
        sgt_fma(fabs(l) + fabs(m), tau_err + 1024 * SGT_U * SGT_U * fabs(t0), 2 * SGT_U * (fabs(x) + fabs(y)))
        <= s->room);
}

/* Is F monotone all along the chord within the rim? */
SGT_INLINE mask wavy_single(const wavy *s, double l, double m, double n)
{
    return MASK(n * n > s->single * (l * l + m * m));
}

/* True if the ray has no beginning, is not parallel to the axis, and wavy_single fails.  Then nothing can
 * tell that a root is the first. */
SGT_INLINE mask wavy_hopeless(const wavy *s, const sgt_ray *ray)
{
    const double tmin = ray->tmin, l = ray->d.x, m = ray->d.y, n = ray->d.z;
    return MASK(tmin == -HUGE_VAL) & MASK(fabs(l) + fabs(m) > 0) & ~wavy_single(s, l, m, n);
}

/* The square of the largest slope within r^2 <= r2, raised by more than rounding.  Infinite if the base
 * has no bound there. */
SGT_INLINE double wavy_slope2(const wavy *s, int terms, double r2)
{
    double phi2 = sgt_fma(-s->ck * s->c, r2, 1),
           steep = (s->abs_c / sqrt(phi2 - 0x1p-30) + 2 * horner(s->size, terms, r2)) * (1 + 0x1p-20);
    return chosen(MASK(phi2 < HUGE_VAL), bounded_limit(steep, r2), HUGE_VAL);
}

/* Is the direction nearer to the plane than to the axis?  Else no more is asked (GRAZING). */
SGT_INLINE mask wavy_along(const sgt_ray *ray)
{
    const double l = ray->d.x, m = ray->d.y, n = ray->d.z;
    return MASK(n * n < l * l + m * m);
}

/* r^2 where the ray is at t, raised by far more than rounding and tau_err. */
SGT_INLINE double wavy_r2(double x, double y, double t, double l, double m)
{
    double px = sgt_fma(t, l, x), py = sgt_fma(t, m, y);
    return (px * px + py * py) * (1 + 0x1p-10);
}

/* How far the surface may be from the plane z = 0 at that r^2, on the side from which the ray comes (side
 * is 1 if n > 0, else -1).  It is the sum of the terms of one sign.  The base, where it is defined, adds
 * at most c r^2. */
SGT_INLINE double wavy_ahead(const wavy *s, int terms, double r2, double side)
{
    double h = 0, base = larger(-side * s->c, 0);
    if (terms > FEW_TERMS) {
        h = sgt_fma(h, r2, larger(-side * s->a[7], 0)), h = sgt_fma(h, r2, larger(-side * s->a[6], 0));
        h = sgt_fma(h, r2, larger(-side * s->a[5], 0)), h = sgt_fma(h, r2, larger(-side * s->a[4], 0));
    }
    h = sgt_fma(h, r2, larger(-side * s->a[3], 0)), h = sgt_fma(h, r2, larger(-side * s->a[2], 0));
    h = sgt_fma(h, r2, larger(-side * s->a[1], 0)), h = sgt_fma(h, r2, larger(-side * s->a[0], 0));
    return r2 * (base + h) * (1 + 0x1p-10);
}

/* THE FIRST ROOT, WITHOUT A RIM OR WITH A WIDE ONE.  r^2 is convex along a ray.  So between the start and the
 * root at tau, r^2 is at most R^2, the larger of the two values.  If the slope within R allows it, F is
 * monotone there, and no root is between.  For what is left see CONVEX and comes_near in asphere/side.h.
 *
 * A start nearer to the root than 2^-20 |t| is left to other forms.  So tau_err, at most 40 u |t|, moves
 * r^2 by less than 2^-14 of itself. */
SGT_INLINE mask wavy_first_from(const wavy *s, int terms, double t0, double x0, double y0, double tau,
                                const sgt_ray *ray)
{
    const double ox = ray->o.x, oy = ray->o.y, tmin = ray->tmin, l = ray->d.x, m = ray->d.y, n = ray->d.z;
    double a = l * l + m * m, root2 = wavy_r2(x0, y0, tau, l, m), t = t0 + tau,
           start = chosen(MASK(fabs(l) + fabs(m) > 0), tmin, t), start2 = wavy_r2(ox, oy, start, l, m);
    return MASK(larger(start2, root2) < 0x1p900) & MASK(t - tmin > 0x1p-20 * fabs(t)) &
           MASK(fabs(start) < HUGE_VAL) & MASK(n * n > wavy_slope2(s, terms, larger(start2, root2)) * a);
}

/* The same where start and root are within the disc of BY CONSTANTS: then wavy_first_from says so, too. */
SGT_INLINE mask wavy_first_within(const wavy *s, double t0, double x0, double y0, double tau,
                                  const sgt_ray *ray)
{
    const double ox = ray->o.x, oy = ray->o.y, tmin = ray->tmin, l = ray->d.x, m = ray->d.y, n = ray->d.z;
    double a = l * l + m * m, root2 = wavy_r2(x0, y0, tau, l, m), t = t0 + tau,
           start = chosen(MASK(fabs(l) + fabs(m) > 0), tmin, t), start2 = wavy_r2(ox, oy, start, l, m);
    return MASK(larger(start2, root2) <= s->disc) & MASK(t - tmin > 0x1p-20 * fabs(t)) &
           MASK(fabs(start) < HUGE_VAL) & MASK(n * n > s->first * a);
}

/* The root, for lane_of. */
SGT_INLINE near_root wavy_root(double x, double y, double t0, double t0_lo, double tau, double tau_err)
{
    double small = t0_lo + tau, t = t0 + small, reach = fabs(t) + fabs(small);
    return (near_root){.x = x, .y = y, .tau = tau, .t = t, .t_err = sgt_fma(1.01 * SGT_U, reach, tau_err),
                       .tau_err = tau_err, .t0 = t0, .small = small};
}

/* If the ray starts in the vertex, nothing has underflowed, and the errors are 0.  A bound that is NaN
 * stays NaN. */
SGT_INLINE near_root wavy_exactly(const near_root *r, mask exact)
{
    near_root at = *r;
    at.t_err = chosen(exact, 0 * r->t_err, r->t_err), at.tau_err = chosen(exact, 0 * r->tau_err, r->tau_err);
    return at;
}

SGT_INLINE lane wavy_end_any(const wavy *s, int terms, const near_root *r, const wavy_round *q, mask exact,
                             const sgt_ray *ray, double t_tol, bool whole)
{
    const double l = ray->d.x, m = ray->d.y, n = ray->d.z;
    double x = sgt_fma(r->tau, l, r->x), y = sgt_fma(r->tau, m, r->y), rho = x * x + y * y,
           dp = horner(s->slope, terms, rho), g = -s->c / q->v - (dp + dp);
    near_root at = wavy_exactly(r, exact);
    return lane_any(&at, ray, t_tol, whole, &(lane_end){r->tau * n, g, q->near}, s->rim2, exact,
                    MASK(fabs(r->t) < 0x1p300) & MASK(g * (g * rho) <= STEEP2));
}

/* AWAY.  The ray certainly misses.  By the slope, the root is the only one within the rim and as far out
 * as the root.  And it is not accepted, because it is one of these:
 * - beyond tmax;
 * - before tmin, or the start itself by half of what accept.h allows (G' is off from 1 / inverse by at
 *   most an eighth);
 * - beyond the rim, by far more than p_err.
 *
 * root: from wavy_root. */
SGT_INLINE mask wavy_away(const wavy *s, int terms, const near_root *root, double v, double inverse,
                          const sgt_ray *ray)
{
    const double oz = ray->o.z, l = ray->d.x, m = ray->d.y, n = ray->d.z, tmin = ray->tmin, tmax = ray->tmax;
    mask exact = at_vertex(root->x, root->y, oz);
    near_root own = wavy_exactly(root, exact);
    const near_root *r = &own;
    double px = sgt_fma(r->tau, l, r->x), py = sgt_fma(r->tau, m, r->y), pz = r->tau * n,
           rho = px * px + py * py, at = fabs(r->t), side = fabs(l) + fabs(m);
    double dp = horner(s->slope, terms, rho), g = fabs(s->c / v + (dp + dp)),
           width = 0.5 * START_ULPS * (v * sgt_fma(g, rho, fabs(pz))) * fabs(inverse);
    double off = sgt_fma(side, r->tau_err + 1024 * SGT_U * SGT_U * fabs(r->t0),
                     SGT_U * (2 * (fabs(r->x) + fabs(r->y)) + (fabs(px) + fabs(py))));
    double edge = s->rim2 * (1 + 0x1p-20), slope2 = wavy_slope2(s, terms, larger(rho * (1 + 0x1p-10), edge));
    mask only = MASK(n * n > slope2 * (l * l + m * m)) | MASK(side == 0);
    mask before = MASK(r->t + r->t_err <= tmin + width),
         after = MASK(r->t - END_ERRORS * (r->t_err + SGT_U * at) > tmax);
    mask beyond = MASK(rho - 3 * (fabs(px) + fabs(py) + off) * off > edge);
    mask is_ray = MASK(tmin <= tmax) & MASK(tmin < HUGE_VAL) & MASK(tmax > -HUGE_VAL) & MASK(rho < HUGE_VAL);
    return is_ray & only & (before | after | beyond) & MASK(r->t_err < HUGE_VAL) & MASK(at < 0x1p300)
           & (MASK(at + r->t_err > LEAST_PLACE) | exact);
}

#endif
