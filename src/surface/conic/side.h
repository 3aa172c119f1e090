// SPDX-License-Identifier: MIT
/* conic/side.h - a conic met in closed form from the point of the ray nearest the vertex, without a branch:
 * rays that run along the surface, or enter a bowl from the side; last, rays that start on it.  The loops
 * are in conic/lanes.c.
 *
 * WHY.  Such a ray meets the vertex plane far from its root.  Seen from there the terms of the equation
 * cancel, and the root that comes first is the far one: easy.h leaves it.
 *
 * THE EQUATION is that of conic.c.  The local origin (x, y, z) = o + t0 d is right to u of each coordinate
 * (moved_along in num/local.h), and t0 is a double.  With Aa, Ba and Ca the sums of the magnitudes of the
 * terms, A is off by 4 u Aa, B by 7 u Ba and C by 7 u Ca:
 *     A   k1, its product, the sum (by fma), c                                        4
 *     B   (1 + k) z n: z, k1, two products; three sums at most, by c (fma), |n|       7
 *     C   (1 + k) z^2: z twice, k1, two products; the sum, by c (fma), 2 z            7
 * Rounding of D = B^2 - A C, by u (|A C| + D), moves the root as another u of Aa and of Ca would, and by u
 * / 2 of itself: |A C| <= b^2.  So to first order
 *     |dtau| <= u ((2.5 Aa tau^2 + 7 Ba |tau| + 4 Ca) / S + 3 |tau|),    S = sqrt D.
 * Only rays with D > 2^-6 (Ba^2 + Aa Ca) are met.  There the relative change of D is below 2^-42, and a
 * factor of 1.01 covers the higher orders.
 *
 * WHICH ROOT.  Where |A| > 2^-10 Aa both roots are right to a part in 2^40.  The earlier one is the first
 * root, unless it is certainly not accepted: off the sheet, beyond the rim, or before or behind the ends,
 * by a part in 2^20 (AWAY in easy.h).  For the root near the seed one of the two has to be such.  If both
 * are, or if D is below -2^-20 of its terms, the ray misses.  A root that may be the start is not met here,
 * but by met_from_on.
 *
 * SHARP.  Where the ray runs along the surface S is small, and C is a difference: tau is off by thousands
 * of u. So the root is solved for once more, from the point at t0 + tau, which is a double.  Its
 * coordinates are known to 4 u^2 of themselves, and C in twice the precision: each product adds 5 u^2 and
 * each sum 3 u^2, so C is off by at most 40 u^2 Ca, and what is left of tau by half of that over S.  The
 * quotient itself is off by a part of less than 2^14 u where Ba <= 2^8 S.  What is left has to be within
 * the first bound, or it is not this root.
 *
 * THE START, here the local origin, must not be too far away: its terms must be at most twice those at the
 * root.  Else little is known of the first bound.
 *
 * THE POINT.  Rounding of x and y takes it off the surface by u of |x F_x| + |y F_y|.  Where that is more
 * than 4 |z| (a strongly oblate conic) the careful form computes z anew.
 *
 * THE RIM is stated in computed numbers.  The point is off by no more than 64 u rims by tau, and a few u r
 * by its own rounding; so its r^2 is within 140 u of the true one, less than what easy.h counts with
 * (PROVEN).
 *
 * UNDERFLOW.  The direction is between 2^-41 and 2^42 long (usual_direction), Ca between 2^-400 and 2^400,
 * |c| within 2^+-60, and |1 + k| below 2^61.  What underflows is below 2^-900, and no part in 2^400 of u
 * Ca. */
#ifndef SGT_SURFACE_CONIC_SIDE_H
#define SGT_SURFACE_CONIC_SIDE_H

#include "easy.h"

SGT_INLINE bool usual_direction(double scale) { return scale > 0x1p-40 && scale < 0x1p40; }

/* e: the ray met, where e.hit is set.  away: it certainly misses.  blunt: it would be met if t were sharp;
 * the root is at `at`, to within `off`. */
typedef struct side_answer {
    lane e;
    mask away, blunt;
    double at, off;
} side_answer;

/* One coordinate of o + t d, to 4 u^2 of itself. */
SGT_INLINE twofold place_of_root(double o, double t, double d)
{
    twofold p = two_product(t, d), s = two_sum(o, p.hi);
    return two_sum(s.hi, s.lo + p.lo);
}

/* Is the root at t0 + tau certainly not accepted?  Its point is (x, y, z) + tau d. */
SGT_INLINE mask side_gone(const bowl *s, double x, double y, double z, double t0, double tau, double l,
                          double m, double n, double tmin, double tmax)
{
    double px = sgt_fma(tau, l, x), py = sgt_fma(tau, m, y), pz = sgt_fma(tau, n, z), t = t0 + tau,
           slack = 0x1p-20 * (fabs(t0) + fabs(tau));
    return MASK(s->ck * pz > 1 + 0x1p-8) | MASK(px * px + py * py > s->rim2 * (1 + 0x1p-20)) |
           MASK(t - slack > tmax) | MASK(t + slack < tmin);
}

SGT_INLINE side_answer met_from_side(const bowl *s, bool first, double ox, double oy, double oz, double l,
                                     double m, double n, double tmin, double tmax, double t_tol)
{
    const double sure = s->proof;
    double a = l * l + m * m, n2 = n * n, d2 = a + n2, t0 = -(ox * l + oy * m + oz * n) / d2;
    double x = moved_along(ox, t0, l), y = moved_along(oy, t0, m), z = moved_along(oz, t0, n);
    double xl = x * l, ym = y * m, kz = s->k1 * z, kzn = kz * n, kzz = kz * z, r2 = x * x + y * y;
    double A = s->c * sgt_fma(s->k1, n2, a), B = sgt_fma(-s->c, xl + ym + kzn, n),
           C = sgt_fma(s->c, r2 + kzz, -2 * z);
    double Aa = sgt_fma(s->extra, n2, fabs(A)),
           Ba = sgt_fma(s->abs_c, fabs(xl) + fabs(ym) + fabs(kzn), fabs(n)),
           Ca = sgt_fma(s->abs_c, r2 + fabs(kzz), 2 * fabs(z));
    double D = sgt_fma(B, B, -A * C), size = sgt_fma(Ba, Ba, Aa * Ca), S = sqrt(larger(D, 0)),
           b = B + copysign(S, B), one = C / b, other = b / A;
    mask usual = MASK(Ca > 0x1p-400) & MASK(Ca < 0x1p400) & MASK(fabs(t0) < 0x1p300) & MASK(tmin <= tmax) &
                 MASK(tmin < HUGE_VAL) & MASK(tmax > -HUGE_VAL),
         two = usual & MASK(D > 0x1p-6 * size) & MASK(fabs(A) > 0x1p-10 * Aa);
    mask swapped = MASK(other < one);
    double early = chosen(swapped, other, one), late = chosen(swapped, one, other);
    mask no_early = two & side_gone(s, x, y, z, t0, early, l, m, n, tmin, tmax),
         no_late = two & side_gone(s, x, y, z, t0, late, l, m, n, tmin, tmax);

    double tau = chosen(no_early, late, early), size_tau = fabs(tau), t = t0 + tau;
    double tau_err =
        1.01 * SGT_U * ((2.5 * Aa * (tau * tau) + 7 * Ba * size_tau + 4 * Ca) / S + 3 * size_tau);
    double pz = sgt_fma(tau, n, z), w = s->ck * pz, px = sgt_fma(tau, l, x), py = sgt_fma(tau, m, y),
           cr2 = s->abs_c * (px * px + py * py), width = sgt_fma(fabs(pz), 1 + fabs(w), cr2) / S,
           spread = Aa * (tau * tau) + 2 * (Ba * size_tau) + Ca, terms = cr2 + fabs(pz) * (2 + fabs(w));

    near_root r = {.x = x,
                   .y = y,
                   .tau = tau,
                   .t = t,
                   .t_err = sgt_fma(1.01 * SGT_U, fabs(t), tau_err),
                   .tau_err = tau_err,
                   .t0 = t0,
                   .small = tau};
    mask wanted = two & MASK(fabs(w) < 1 - 0x1p-8) & MASK(spread <= 2 * terms) &
                  MASK(tau_err * (fabs(l) + fabs(m)) * 0x1p46 <= 64 * SGT_U * s->reach);
    wanted &= MASK(cr2 <= 4 * fabs(pz) * (1 - w));
    if (!first) wanted &= no_early | no_late;
    wanted &= MASK(sure * (Aa + Aa) * r.t_err < S);
    side_answer told = {.away = (usual & MASK(D < -0x1p-20 * size)) | (no_early & no_late)};
    told.e = lane_of(&r, l, m, n, false, tmin, tmax, t_tol, pz, -s->c / (1 - w), width, s->rim2, MASK(false),
                     wanted & ~told.away);
    told.e.p_err += 2.1 * SGT_U * fabs(z);
    told.at = t, told.off = tau_err;
    told.blunt = wanted & ~told.away & ~told.e.hit & MASK(r.t_err > larger(40 * SGT_U * fabs(t), t_tol));
    return told;
}

/* SHARP.  The root of such a ray, from the point at `at`, where it was found to within `off`. */
SGT_INLINE lane sharp_from_side(const bowl *s, double at, double off, double ox, double oy, double oz,
                                double l, double m, double n, double tmin, double tmax, double t_tol)
{
    twofold X = place_of_root(ox, at, l), Y = place_of_root(oy, at, m), Z = place_of_root(oz, at, n);
    twofold r2 = twofold_sum(twofold_product(X, X), twofold_product(Y, Y)),
            kzz = twofold_product((twofold){s->k1, s->k1_lo}, twofold_product(Z, Z)),
            C = twofold_difference(twofold_scaled(twofold_sum(r2, kzz), s->c), (twofold){2 * Z.hi, 2 * Z.lo});
    double xl = X.hi * l, ym = Y.hi * m, kzn = s->k1 * Z.hi * n,
           A = s->c * sgt_fma(s->k1, n * n, l * l + m * m), B = sgt_fma(-s->c, xl + ym + kzn, n),
           Ba = sgt_fma(s->abs_c, fabs(xl) + fabs(ym) + fabs(kzn), fabs(n)),
           Ca = sgt_fma(s->abs_c, r2.hi + fabs(kzz.hi), 2 * fabs(Z.hi)),
           S = sqrt(larger(sgt_fma(B, B, -A * C.hi), 0)), tau = C.hi / (B + copysign(S, B)), t = at + tau,
           tau_err = 1.01 * SGT_U * (20 * SGT_U * (Ca / S) + 0x1p14 * fabs(tau));
    mask same = MASK(fabs(tau) <= 2 * (off + SGT_U * fabs(at))) & MASK(Ba <= 0x1p8 * S) &
                MASK(Ca > 0x1p-400) & MASK(Ca < 0x1p400);
    double px = sgt_fma(tau, l, X.hi), py = sgt_fma(tau, m, Y.hi), pz = sgt_fma(tau, n, Z.hi), w = s->ck * pz,
           near = sgt_fma(fabs(pz), 1 + fabs(w), s->abs_c * (px * px + py * py)) / S;
    near_root r = {.x = X.hi,
                   .y = Y.hi,
                   .tau = tau,
                   .t = t,
                   .t_err = sgt_fma(1.01 * SGT_U, fabs(t), tau_err),
                   .tau_err = tau_err,
                   .t0 = at,
                   .small = tau};
    lane e = lane_of(&r, l, m, n, false, tmin, tmax, t_tol, pz, -s->c / (1 - w), near, s->rim2, MASK(false),
                     same & MASK(fabs(w) < 1 - 0x1p-8));
    e.p_err += 2.1 * SGT_U * fabs(Z.hi);
    return e;
}

/* FROM ON THE SURFACE.  About the start o itself C is nearly 0.  So the root t1 = C / 2 B there is known, and
 * the other one is without a square root
 *     t = 2 B / A - t1.
 * All three are worked out in twice the precision: off by 27 u^2 of their terms (conic.c, CAREFUL).  So where
 * B^2 > 2^-60 Ba^2 and A > 2^-20 Aa, their doubles are right to 1.01 u, and 2 B / A to 3.1 u.  t1 is off by
 *     A t1^2 / 2 B, its second order: below u |t| if |t1| <= 2^-27 |t|,
 *     27 u^2 Ca / 2 B: below u |t| / 4 if Aa Ca <= 2^45 B^2,
 * and by 2 u of itself.  With the rounding of the difference t is off by less than 6 u of itself; 8 is taken.
 *
 * t1 is the start: |t1| S is at most 3/4 of what the rule allows (sagitta.h, sgt_ray), S = |B| to 2^-26, and
 * so are the terms at the root those at o.  It is not accepted, so t alone is asked for, whatever is picked.
 * The ray misses if t is before the start, off the sheet or beyond the rim by the margins of side_gone;
 * rounding of the point is far below these (low, near). */
SGT_INLINE side_answer met_from_on(const bowl *s, double ox, double oy, double oz, double l, double m,
                                   double n, double tmin, double tmax, double t_tol)
{
    const double sure = s->proof;
    const twofold k1 = {s->k1, s->k1_lo};
    twofold zz = twofold_product(k1, two_product(oz, oz)), zn = twofold_product(k1, two_product(oz, n)),
            nn = twofold_product(k1, two_product(n, n)), xl = two_product(ox, l), ym = two_product(oy, m),
            r2 = twofold_sum(two_product(ox, ox), two_product(oy, oy));
    twofold A2 = twofold_scaled(twofold_sum(twofold_sum(two_product(l, l), two_product(m, m)), nn), s->c),
            B2 = twofold_difference(twofold_of(n),
                                    twofold_scaled(twofold_sum(twofold_sum(xl, ym), zn), s->c)),
            C2 = twofold_difference(twofold_scaled(twofold_sum(r2, zz), s->c), twofold_of(2 * oz));
    double A = A2.hi, B = B2.hi, C = C2.hi, size = fabs(B),
           Aa = sgt_fma(s->extra, n * n, fabs(A)),
           Ba = sgt_fma(s->abs_c, fabs(xl.hi) + fabs(ym.hi) + fabs(zn.hi), fabs(n)),
           Ca = sgt_fma(s->abs_c, r2.hi + fabs(zz.hi), 2 * fabs(oz));
    double first = 0.5 * C / B, t = 2 * B / A - first, at = fabs(t), w0 = s->ck * oz,
           rule = 0.75 * START_ULPS * sgt_fma(s->abs_c, r2.hi, fabs(oz * (1 - w0)));
    mask usual = MASK(Ca > 0x1p-400) & MASK(Ca < 0x1p400) & MASK(Ba > 0x1p-400) & MASK(Ba < 0x1p400) &
                 MASK(tmin == 0) & MASK(tmax > 0),
         known = usual & MASK(B * B > 0x1p-60 * (Ba * Ba)) & MASK(fabs(A) > 0x1p-20 * Aa) &
                 MASK(Aa * Ca <= 0x1p45 * (B * B)) & MASK(fabs(first) <= 0x1p-27 * at) &
                 MASK(fabs(first) * size <= rule);
    double tau_err = 8 * SGT_U * at, pz = sgt_fma(t, n, oz), w = s->ck * pz, px = sgt_fma(t, l, ox),
           py = sgt_fma(t, m, oy), across = fabs(l) + fabs(m),
           width = sgt_fma(fabs(pz), 1 + fabs(w), s->abs_c * (px * px + py * py)) / size;
    mask low = MASK(fabs(s->ck * (t * n)) <= 0x1p30),
         near = MASK(at * across <= 0x1p20 * (fabs(px) + fabs(py))),
         gone = known & side_gone(s, ox, oy, oz, 0, t, l, m, n, tmin, tmax) &
                (MASK(t < 0) | MASK(t > tmax) | (low & near));
    near_root r = {.x = ox, .y = oy, .tau = t, .t = t, .t_err = tau_err, .tau_err = tau_err, .small = t};
    mask wanted = known & low & MASK(fabs(w) < 1 - 0x1p-8) &
                  MASK(tau_err * across * 0x1p46 <= 64 * SGT_U * s->reach) &
                  MASK(sure * (Aa + Aa) * tau_err < size);
    side_answer told = {.away = gone};
    told.e = lane_of(&r, l, m, n, false, tmin, tmax, t_tol, pz, -s->c / (1 - w), width, s->rim2, MASK(false),
                     wanted & ~gone);
    told.e.p_err += 2.1 * SGT_U * fabs(oz);
    return told;
}

#endif
