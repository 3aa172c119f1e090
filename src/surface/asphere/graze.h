// SPDX-License-Identifier: MIT
/* asphere/graze.h - the first root of a ray that grazes an even asphere from its outside: one root is
 * guessed, and certain from where it is.  The loops, and the single ray, are in asphere/side.c.
 *
 * WHY.  The form from the side (side.h) asks F at both ends of a stretch, bounds the root in doubles, finds
 * that t is not sharp, and computes G once more in twice the precision.  Where S is bent in one way, none of
 * that is needed but the last: a root at which sigma F rises is the first one, whatever F is at the ends.
 * By instructions (x86-64-v3) a ray takes 195 to 250 so, and 324 to 430 from the side; 97 is a first hit of a
 * lens (docs/notes/ordinary_input.md).
 *
 * FIRST.  sigma F is concave along each stretch of a ray within r <= R where sigma S'' >= 0 up to R (CONVEX
 * in side.h).  If it rises at a root within R, it is below 0 on the stretch before it.  The stretch begins
 * where the ray does, or where r comes below the edge, the rim or the equator: before that no root is
 * accepted.  As r^2 is convex along the ray, r^2 is at most the larger of that at the root and
 *     min(r^2 at the start, r^2 of the edge)
 * there.  So no root of a quadratic equation has to be taken.  bent2 (side.h) has to be as much.
 *
 * ASKED is a ray that grazes (GRAZING in side.h), if that bound holds for its start, sigma G is certainly
 * below 0 at o, and the conic of the guess rises there.  All others go to the form from the side.  So does a
 * ray that has no answer here: it may pass, and then no root is found.
 *
 * THE GUESS.  With the conic of curvature c + 2 a[0] G is (A t^2 - 2 B t + C) / -2, seen from o.  The root at
 * which sigma G rises is t = C / (B + sigma sqrt D), D = B^2 - A C, without a difference as sigma B > 0.
 * From there a quadratic equation with G and G' of the asphere (side_turned) leads to the right one of two
 * roots; Newton's steps go on until what the next one leaves is small, or six have been made.  All of this is
 * in doubles, from o, and nothing rests on it: what follows is certain by itself.
 *
 * FROM THERE.  T is the double at which they end.  The point at T is known to 4 u^2 of its coordinates
 * (place_of_root), and so is rho to 32 u^2 of itself.  With w = z - P
 *     G = (z - c rho / 2) - (P + (1 + k) c w^2 / 2).
 * The first difference is taken with what sums and products lose; what rho and z are more than a double goes
 * in by first order.  The second bracket is small where the terms are, and in doubles.  In u it is off by
 *     v rho first      Horner's rule: u first of P / rho, which is in w too (first = sum (i+1) |a_i| rho^i),
 *     3 |(1 + k) c w^2|      (1 + k) c by 2, two products, halved; w itself by 1,
 *     rho first + |(1 + k) c w^2| / 2      the last sum,
 * and G by 2 u of itself, and by less than 2^9 u^2 of its terms z, c rho and rho first (as SHARP in side.h);
 * 2^16 is taken.  2 u |G| is in what is added for tau below.
 *
 * THE BOUND is that of easy.h with s the slope at T.  H = 4 |tau| + 2^-40 |T|, tau = -G / s, and G' differs
 * from s by M H + 2^-37 of its terms at most within H (slope_off takes more): Delta.  first is taken at
 * rho' = 1.0625 rho + 17 a H^2, which is no less than anywhere within H.  Where Delta <= |s| / 8 and
 * 2 (|G| + e) / |s| <= H, the root exists, is the only one within H, and
 *     |root - (T + tau)| <= 8/7 (e + |tau| Delta) / |s|.
 * It is on the sheet: |(1 + k) c w| < 1 - 2^-8 at T, and changes by less than 2^-10.  w is off by less than
 * u (|w| + |z| + 2 rho first), so (1 + k) c w by 2^-46, as |(1 + k) c| (|z| + 2 rho first) <= 2^5.
 *
 * SHARP ENOUGH.  The point may be 8 u (|w| + |z|) off the surface by e and Delta (side_bound allows 24).  Its
 * terms at T are at most twice those at the root, as T is a step away.
 *
 * Tests: tests/oracle/test_grazing.cpp and test_scale.cpp, tests/batch/test_batch.c, tests/catalogue. */
#ifndef SGT_SURFACE_ASPHERE_GRAZE_H
#define SGT_SURFACE_ASPHERE_GRAZE_H

#include "side.h"

/* t: the guess.  grazes: as graze_bent has it.  asked: is the guess to be tried?  (The ray need not have been
 * checked, but its direction is usual.) */
typedef struct graze_seed {
    double t;
    mask grazes, asked;
} graze_seed;

SGT_INLINE graze_seed graze_seed_of(const wavy *s, const convex *b, int terms, const sgt_ray *ray)
{
    const double x = ray->o.x, y = ray->o.y, z = ray->o.z;
    const graze_conic q = graze_conic_of(s, b, ray);
    double rho = x * x + y * y, w, ckw, g = wavy_g(s, rho, z, horner(s->a, terms, rho), &w, &ckw);
    mask below = MASK(b->sign * g < -0x1p-30 * (fabs(z) + fabs(w))) & MASK(b->sign * q.B > 0);
    double t = q.C / (q.B + b->sign * sqrt(larger(q.D, 0)));
    const mask bent = graze_bent(s, b, &q, ray);
    return (graze_seed){t, bent, bent & below};
}

/* The steps: the first one turned.  Returns the second. */
SGT_INLINE wavy_newton graze_begin(const wavy *s, const convex *b, int terms, double t, const sgt_ray *ray)
{
    const side_local o = {ray->o.x, ray->o.y, ray->o.z, 0};
    wavy_newton at = side_step(s, terms, &o, t, ray);
    at = side_turned(&at, t, side_bend(s, b, ray), b->sign);
    return side_step(s, terms, &o, at.tau2, ray);
}

SGT_INLINE wavy_newton graze_next(const wavy *s, int terms, double t, const sgt_ray *ray)
{
    const side_local o = {ray->o.x, ray->o.y, ray->o.z, 0};
    return side_step(s, terms, &o, t, ray);
}

/* Is what Newton's step leaves so little that its square, by the bend, is below an ulp of z?  (A guess.) */
SGT_INLINE mask graze_ready(const wavy *s, const convex *b, const wavy_newton *at, const sgt_ray *ray)
{
    const double l = ray->d.x, m = ray->d.y, n = ray->d.z;
    double bend = sgt_fma(fabs(b->bowl), l * l + m * m, s->abs_ck * (n * n)),
           left = bend * (at->step2 * at->step2) * fabs(at->inverse), z = sgt_fma(at->tau2, n, ray->o.z);
    return MASK(bend * (left * left) <= 0x1p-54 * fabs(z)) &
           MASK(fabs(at->step2) <= 0x1p-10 * fabs(at->tau2));
}

/* The root beside T, as side_lane takes it.  inverse: 1 / G'. */
typedef struct graze_root {
    side_local q;
    double inverse;
    wavy_round root;
} graze_root;

SGT_INLINE graze_root graze_root_at(const wavy *s, int terms, double at, const sgt_ray *ray, double t_tol)
{
    const double l = ray->d.x, m = ray->d.y, n = ray->d.z;
    const twofold X = place_of_root(ray->o.x, at, l), Y = place_of_root(ray->o.y, at, m),
                  Z = place_of_root(ray->o.z, at, n), xx = two_product(X.hi, X.hi),
                  yy = two_product(Y.hi, Y.hi), r2 = two_sum(xx.hi, yy.hi), round = two_product(s->c, r2.hi),
                  big = two_sum(Z.hi, -0.5 * round.hi);
    const double rho = r2.hi,
                 rho_lo = r2.lo + (sgt_fma(2 * X.hi, X.lo, xx.lo) + sgt_fma(2 * Y.hi, Y.lo, yy.lo)),
                 h = horner(s->a, terms, rho), dp = horner(s->slope, terms, rho), xl = X.hi * l,
                 ym = Y.hi * m, half = xl + ym, w = sgt_fma(-rho, h, Z.hi), ckw = s->ck * w, v = 1 - ckw,
                 lo = big.lo + sgt_fma(v, sgt_fma(-dp, rho_lo, Z.lo), -0.5 * sgt_fma(s->c, rho_lo, round.lo)),
                 g = (big.hi - sgt_fma(rho, h, (0.5 * ckw) * w)) + lo, dw = sgt_fma(-(dp + dp), half, n),
                 inverse = 1 / sgt_fma(-s->c, half, v * dw);
    const double ai = fabs(inverse), tau = -g * inverse, as = fabs(tau), a = l * l + m * m, aw = fabs(w),
                 az = fabs(Z.hi), cww = fabs(ckw * w), H = sgt_fma(0x1p-40, fabs(at), 4 * as),
                 first = horner(s->size, terms, sgt_fma(17 * a, H * H, 1.0625 * rho)), bent = rho * first,
                 slant = fabs(xl) + fabs(ym), W1 = sgt_fma(first + first, sgt_fma(a, H + H, slant), fabs(n)),
                 W2 = s->bend * (a * first),
                 M = sgt_fma(s->abs_ck, sgt_fma(sgt_fma(W1, H, aw), W2, W1 * W1), sgt_fma(s->abs_c, a, W2)),
                 off = sgt_fma(M * H, ai, slope_off(sgt_fma(2, W1, s->abs_c * slant), ai)),
                 e = sgt_fma(1.01 * SGT_U, sgt_fma(bent, fabs(v) + 1, 3.5 * cww),
                             sgt_fma(0x1p-90, bent + az + fabs(round.hi), 0x1p-1000)),
                 noise = e * ai, both = sgt_fma(as, off, noise),
                 tau_err = sgt_fma(1.16, both, 4 * SGT_U * as), z = fabs(sgt_fma(tau, n, Z.hi));
    const mask known = MASK(off <= 0.125) & MASK(2 * (as + noise) <= H) & MASK(fabs(ckw) < 1 - 0x1p-8) &
                       MASK(s->abs_ck * (az + (bent + bent)) <= 0x1p5) &
                       MASK(s->abs_ck * (W1 * H) < 0x1p-10) & MASK(rho > 0x1p-400) & MASK(rho < 0x1p400),
               sure = known & MASK(a * (H * H) <= 0x1p-4 * rho) & MASK(az <= z + z) &
                      (MASK(both <= 8 * SGT_U * ai * (aw + z)) | MASK(tau_err <= 0.5 * t_tol));
    return (graze_root){{X.hi, Y.hi, Z.hi, rho},
                        inverse,
                        {.tau = tau,
                         .tau_err = chosen(sure, tau_err, (double)NAN),
                         .v = sgt_fma(-s->ck, tau * dw, v), /* at the root */
                         .near = sgt_fma(ai, sgt_fma(rho, first + (first + s->abs_c), az), as)}};
}

/* The answer.  FIRST; t0: T. */
SGT_INLINE lane graze_lane(const wavy *s, const convex *b, int terms, const side_local *q, double t0,
                           double inverse, const wavy_round *at, const sgt_ray *ray, double t_tol)
{
    const double r2 = wavy_r2(q->x, q->y, at->tau, ray->d.x, ray->d.y);
    const mask known = MASK(b->sign * inverse > 0) & MASK(r2 <= b->bent2);
    return side_lane_if(s, terms, false, q, at, (side_known){t0, known}, ray, t_tol);
}

#endif
