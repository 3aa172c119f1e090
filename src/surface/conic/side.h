// SPDX-License-Identifier: MIT
/* conic/side.h - a conic met in closed form from the point of the ray nearest the vertex, without a branch:
 * rays that run along the surface, or enter a bowl from the side; last, rays that start on it.  The loops
 * are in conic/lanes.c.
 *
 * WHY.  Such a ray meets the vertex plane far from its root.  Seen from there the terms of the equation
 * cancel, and the root that comes first is the far one: easy.h leaves it.
 *
 * THE EQUATION is that of conic.c.  The local origin (x, y, z) = o + t0 d is right to u of each coordinate,
 * and t0 is a double.  With Aa, Ba and Ca the sums of the magnitudes of the
 * terms, A is off by 4 u Aa, B by 7 u Ba and C by 7 u Ca:
 *     A   k1, its product, the sum (by fma), c                                        4
 *     B   (1 + k) z n: z, k1, two products; three sums at most, by c (fma), |n|       7
 *     C   (1 + k) z^2: z twice, k1, two products; the sum, by c (fma), 2 z            7
 * So where D = B^2 - A C is below -2^-20 (Ba^2 + Aa Ca), there is no root.
 *
 * WHICH ROOT.  Its two roots are known in doubles, roughly: S is a difference, and where the ray runs along
 * the surface they may be off by thousands of u.  One of them is guessed to be the answer (side_guess_of),
 * and t is a double near it.  A guess affects only whether there is an answer: all that follows is certain
 * by itself, seen from the point at t.
 *
 * FROM THERE the terms of the equation do not cancel.  The coordinates are known to 4 u^2 of themselves, as
 * X.hi + X.lo.  C is summed with the errors of its products and sums (Ogita, Rump, Oishi 2005, SIAM J. Sci.
 * Comput. 26, 1955): it is off by u |C| and by
 *     53 u^2 |c| (X^2 + Y^2 + |1 + k| Z^2): the coordinates 8, the parts of (1 + k) Z^2 19 at most, the sum
 *         of what is lost, 12 u in all, 26,
 *     9 u^2 of the same by the product with c, and 15 u^2 (|c| (...) + 2 |Z|) by the sums with -2 Z,
 * together by 79 u^2 Ca; 128 is taken.  With e = A C / B^2 the root is
 *     tau = B / A (1 - sqrt(1 - e)) = C / B (1/2 + e / 8 + e^2 / 16 + ...),
 * and |e| <= 2^-13 leaves 2^-42 of it.  B is off by 7 u Ba.  So where Ba <= 2^12 |B| the quotient is right to
 * 2^16 u, and tau is off by 64 u^2 Ca / |B| more.  An ulp of t has to be small beside the distance of the
 * roots, which are equal and opposite in slope: G' is -B at the one, and B at the other.
 *
 * THE OTHER ROOT is at 2 B / A - tau.  B is right to 2^-38 of itself, and A to 2^-40 where |A| > 2^-10 Aa: so
 * 2 B / A is, to 2^-37.  It is the later one if that is positive.  If not, the root is the first one only if
 * the other is certainly not accepted: off the sheet, beyond the rim, or before or behind the ends, by a part
 * in 2^20 and more than it is off (side_gone; low, near: its point is known well enough).  If neither is
 * accepted, or if D is below -2^-20 of its terms, the ray misses.  A root that may be the start is not met
 * here, but by first_from_on.
 *
 * Near the seed the root near the vertex plane is wanted, C / b from there (conic.c), unless it is gone.  It
 * has A tau - B of the sign of -B, with B taken at that plane.  B falls by A tau along the ray, so there it
 * is B + A Z / n.
 *
 * THE POINT.  From very far away an ulp of t is a large step.  So the terms at t have to be at most twice
 * those at the root, or the step rounds by more than these.  Rounding of x and y takes it off the surface by
 * u of |x F_x| + |y F_y|.  Where that is more than 4 |z| (a strongly oblate conic) the careful form computes
 * z anew.
 *
 * THE RIM is stated in computed numbers.  The point is off by no more than 64 u rims by tau, and a few u r
 * by its own rounding.  So its r^2 is within 140 u of the true one, less than what easy.h counts with
 * (PROVEN).
 *
 * UNDERFLOW.  The direction is between 2^-41 and 2^42 long (usual_direction), |c| within 2^+-60, and |1 + k|
 * below 2^61.  What underflows is below 2^-900, and Ca is taken to be greater by 2^-400: no part in 2^300 of
 * u^2 of it.  In D that is below 2^-690, as A is below 2^206, or a part in 2^600 of B^2.  What overflows
 * makes tau_err or D no finite number. */
#ifndef SGT_SURFACE_CONIC_SIDE_H
#define SGT_SURFACE_CONIC_SIDE_H

#include "easy.h"

SGT_INLINE bool usual_direction(double scale) { return scale > 0x1p-40 && scale < 0x1p40; }

/* e: the ray met, where e.hit is set.  away: it certainly misses. */
typedef struct side_answer {
    lane e;
    mask away;
} side_answer;

/* The local origin (x, y, z), at t0. */
typedef struct side_origin {
    double x, y, z, t0;
} side_origin;

/* Is the root at t0 + tau, off by `err` at most, certainly not accepted?  Its point is (x, y, z) + tau d. */
SGT_INLINE mask side_gone(const bowl *s, const side_origin *q, double tau, double err, const sgt_ray *ray)
{
    const double l = ray->d.x, m = ray->d.y, n = ray->d.z, tmin = ray->tmin, tmax = ray->tmax;
    double px = sgt_fma(tau, l, q->x), py = sgt_fma(tau, m, q->y), pz = sgt_fma(tau, n, q->z),
           t = q->t0 + tau, slack = sgt_fma(0x1p-20, fabs(q->t0) + fabs(tau), err + err);
    return MASK(s->ck * pz > 1 + 0x1p-8) | MASK(px * px + py * py > s->rim2 * (1 + 0x1p-20)) |
           MASK(t - slack > tmax) | MASK(t + slack < tmin);
}

/* Which root may be the answer: it is near t = at, which is NaN if the ends are in no order.  away: the ray
 * certainly misses.  tried: may the easy form try it, or does it start on the surface?  (D is the same from
 * each point of a ray.)  twice: the root that it would be is gone, as far as doubles tell. */
typedef struct side_guess {
    double at;
    mask away, tried, twice;
} side_guess;

/* May starts_on be true?  At least where it is: there G is below 2^-49 of |c| r^2 + |z| + |w z|, and off by
 * less than 2^-50 of that. */
SGT_INLINE mask may_start_on(const bowl *s, const sgt_ray *ray)
{
    const double x = sgt_fma(ray->tmin, ray->d.x, ray->o.x), y = sgt_fma(ray->tmin, ray->d.y, ray->o.y),
                 z = sgt_fma(ray->tmin, ray->d.z, ray->o.z), cr2 = s->c * (x * x + y * y),
                 wz = s->ck * z * z, G = sgt_fma(-0.5, cr2 + wz, z);
    return MASK(fabs(G) <= 0x1p-44 * ((fabs(cr2) + fabs(wz)) + fabs(z)));
}

/* Is the root at t0 + tau off the sheet, beyond the rim or outside of the ends, as far as doubles tell? */
SGT_INLINE mask side_outside(const bowl *s, const side_origin *q, double tau, const sgt_ray *ray)
{
    double px = sgt_fma(tau, ray->d.x, q->x), py = sgt_fma(tau, ray->d.y, q->y),
           pz = sgt_fma(tau, ray->d.z, q->z), t = q->t0 + tau;
    return MASK(s->ck * pz > 1) | MASK(px * px + py * py > s->rim2) | MASK(t > ray->tmax) |
           MASK(t < ray->tmin);
}

SGT_INLINE side_guess side_guess_of(const bowl *s, bool first, const sgt_ray *ray)
{
    const double ox = ray->o.x, oy = ray->o.y, oz = ray->o.z, l = ray->d.x, m = ray->d.y, n = ray->d.z;
    double a = l * l + m * m, n2 = n * n, t0 = -(ox * l + oy * m + oz * n) / (a + n2), x = sgt_fma(t0, l, ox),
           y = sgt_fma(t0, m, oy), z = sgt_fma(t0, n, oz);
    double xl = x * l, ym = y * m, kz = s->k1 * z, kzn = kz * n, kzz = kz * z, r2 = x * x + y * y;
    double A = s->c * sgt_fma(s->k1, n2, a), B = sgt_fma(-s->c, xl + ym + kzn, n),
           C = sgt_fma(s->c, r2 + kzz, -2 * z);
    double Aa = sgt_fma(s->extra, n2, fabs(A)),
           Ba = sgt_fma(s->abs_c, fabs(xl) + fabs(ym) + fabs(kzn), fabs(n)),
           Ca = sgt_fma(s->abs_c, r2 + fabs(kzz), 2 * fabs(z));
    double D = sgt_fma(B, B, -A * C), size = sgt_fma(Ba, Ba, Aa * Ca), b = B + copysign(sqrt(D), B),
           one = C / b, other = b / A;
    mask ends = MASK(ray->tmax - ray->tmin >= 0), /* NaN if both are the same infinity */
        swapped = MASK(other < one);
    double early = chosen(swapped, other, one), late = chosen(swapped, one, other);
    const side_origin q = {x, y, z, t0};
    mask second = side_outside(s, &q, early, ray), twice = second;
    if (!first) {
        mask wish = MASK(A * sgt_fma(A, z / n, B) < 0), gone = side_outside(s, &q, late, ray);
        twice = (wish & gone) | (second & ~wish), second |= wish & ~gone;
    }
    double slack = 0x1p-40 * size;
    mask tried = MASK(D - slack <= 16 * n2) & MASK(4 * (D + slack) > s->flat * a * (1 - 0x1p-20));
    return (side_guess){chosen(ends, t0 + chosen(second, late, early), (double)NAN),
                        ends & MASK(D < sgt_fma(-0x1p-20, size, -0x1p-600)), tried | may_start_on(s, ray),
                        twice};
}

/* Such a root at (x, y, z) + tau d, where |G'| is 1 / |inverse|. */
SGT_INLINE root_there side_there(const bowl *s, const side_origin *q, double tau, double tau_err,
                                 double inverse, mask wanted, const sgt_ray *ray)
{
    const double l = ray->d.x, m = ray->d.y, n = ray->d.z;
    double t = q->t0 + tau, px = sgt_fma(tau, l, q->x), py = sgt_fma(tau, m, q->y),
           pz = sgt_fma(tau, n, q->z), w = s->ck * pz,
           width = sgt_fma(fabs(pz), 1 + fabs(w), s->abs_c * (px * px + py * py)) * fabs(inverse);
    const near_root r = {.x = q->x,
                         .y = q->y,
                         .tau = tau,
                         .t = t,
                         .t_err = sgt_fma(1.01 * SGT_U, fabs(t), tau_err),
                         .tau_err = tau_err,
                         .t0 = q->t0,
                         .small = tau};
    return (root_there){r, pz, w, width, MASK(false), wanted & MASK(fabs(w) < 1 - 0x1p-8)};
}

SGT_INLINE lane side_hit(const bowl *s, const side_origin *q, double tau, double tau_err, double inverse,
                         mask wanted, const sgt_ray *ray, double t_tol)
{
    const root_there r = side_there(s, q, tau, tau_err, inverse, wanted, ray);
    lane e = lane_of_root(s, &r, ray, t_tol);
    e.p_err += 2.1 * SGT_U * fabs(q->z);
    return e;
}

/* A root as side_hit takes it; wanted: it is the answer. */
typedef struct side_place {
    side_origin at;
    double tau, tau_err, inverse;
    mask wanted;
} side_place;

/* A root, and whether the ray certainly misses. */
typedef struct side_left {
    side_place root;
    mask away;
} side_left;

/* The root near t = at.  away: neither root is accepted.  quick: it is not asked whether a root is gone; then
 * fewer rays have an answer, and those that have one have the same. */
SGT_INLINE side_left side_root_at(const bowl *s, bool first, bool quick, double at, const sgt_ray *ray)
{
    const double ox = ray->o.x, oy = ray->o.y, oz = ray->o.z, l = ray->d.x, m = ray->d.y, n = ray->d.z;
    twofold X = place_of_root(ox, at, l), Y = place_of_root(oy, at, m), Z = place_of_root(oz, at, n),
            xx = two_product(X.hi, X.hi), yy = two_product(Y.hi, Y.hi), kz = two_product(s->k1, Z.hi),
            kzz = two_product(kz.hi, Z.hi), r2 = two_sum(xx.hi, yy.hi), all = two_sum(r2.hi, kzz.hi),
            bent = two_product(s->c, all.hi), rest = two_sum(bent.hi, -2 * Z.hi);
    double kz_lo = sgt_fma(s->k1, Z.lo, sgt_fma(s->k1_lo, Z.hi, kz.lo)),
           half = X.hi * X.lo + Y.hi * Y.lo, /* x and y alike */
           lo = sgt_fma(2, half, xx.lo + yy.lo) + sgt_fma(kz.hi, Z.lo, sgt_fma(kz_lo, Z.hi, kzz.lo)),
           C = rest.hi +
               (sgt_fma(-2, Z.lo, rest.lo) + sgt_fma(s->c, (r2.lo + all.lo) + lo, bent.lo));
    double a = l * l + m * m, n2 = n * n, A = s->c * sgt_fma(s->k1, n2, a),
           Aa = sgt_fma(s->extra, n2, fabs(A)), xl = X.hi * l, ym = Y.hi * m, kzn = kz.hi * n,
           B = sgt_fma(-s->c, xl + ym + kzn, n), by = 1 / B,
           Ba = sgt_fma(s->abs_c, fabs(xl) + fabs(ym) + fabs(kzn), fabs(n)),
           Ca = sgt_fma(s->abs_c, r2.hi + fabs(kzz.hi), sgt_fma(2, fabs(Z.hi), 0x1p-400)), q = C * by,
           e = A * by * q, tau = q * sgt_fma(e, sgt_fma(0.0625, e, 0.125), 0.5), size = fabs(B),
           across = fabs(l) + fabs(m),
           tau_err = sgt_fma(64.64 * SGT_U * SGT_U * Ca, fabs(by), 1.01 * 0x1p16 * SGT_U * fabs(tau));
    const side_origin here = {X.hi, Y.hi, Z.hi, at};
    mask known = MASK(sgt_fma(0x1p-43 * fabs(at), Aa, 0x1p-12 * Ba) <= size) & MASK(fabs(e) <= 0x1p-13) &
                 MASK(fabs(A) > 0x1p-10 * Aa) &
                 MASK(tau_err * across <= 64 * SGT_U * 0x1p-46 * s->reach),
         right = MASK(A * B > 0), far_gone = 0;
    if (!quick) {
        double far = 2 * B / A, to_far = fabs(far);
        mask low = MASK(fabs(s->ck * (far * n)) <= 0x1p20),
             near = MASK(to_far * across <= 0x1p-33 * s->reach);
        far_gone = low & near & side_gone(s, &here, far - tau, 0x1p-36 * to_far, ray);
    }
    if (!first) {
        double slope = sgt_fma(A, Z.hi / n, B);
        right = MASK(B * slope > 0) & MASK(fabs(slope) > 0x1p-20 * sgt_fma(Aa, fabs(Z.hi / n), Ba));
    }
    right |= far_gone;
    if (s->proof) known &= MASK(2.1 * Aa * sgt_fma(1.01 * SGT_U, fabs(at + tau), tau_err) < size);
    double px = sgt_fma(tau, l, X.hi), py = sgt_fma(tau, m, Y.hi), pz = sgt_fma(tau, n, Z.hi), w = s->ck * pz,
           cr2 = s->abs_c * (px * px + py * py), terms = sgt_fma(fabs(pz), 1 + fabs(w), cr2);
    mask round = MASK(cr2 <= 4 * fabs(pz) * (1 - w)) & MASK(sgt_fma(Ba + Ba, fabs(tau), Ca) <= terms + terms);
    return (side_left){{here, tau, tau_err, by, known & right & round},
                       quick ? 0 : known & far_gone & side_gone(s, &here, tau, tau_err, ray)};
}

SGT_INLINE side_answer met_from_side(const bowl *s, bool first, double at, const sgt_ray *ray, double t_tol)
{
    const side_left e = side_root_at(s, first, false, at, ray);
    return (side_answer){side_hit(s, &e.root.at, e.root.tau, e.root.tau_err, e.root.inverse, e.root.wanted,
                                  ray, t_tol),
                         e.away};
}

/* FROM ON THE SURFACE.  About the start o itself C is nearly 0.  So the root t1 = C / 2 B there is known, and
 * the other one is without a square root
 *     t = 2 B / A - t1.
 * All three are sums of three products and one more term, summed with what products and sums lose: off by u
 * of themselves and 64 u^2 of their terms (as C in FROM THERE).  So where B^2 > 2^-60 Ba^2 and A > 2^-20 Aa,
 * they are right to 1.01 u, and 2 B / A to 3.1 u.  t1 is off by
 *     A t1^2 / 2 B, its second order: below u |t| if |t1| <= 2^-27 |t|,
 *     32 u^2 Ca / B: below u |t| / 4 if Aa Ca <= 2^45 B^2,
 * and by 2 u of itself.  With the rounding of the difference t is off by less than 6 u of itself; 8 is taken.
 *
 * t1 is the start: |t1| S is at most 3/4 of what the rule allows (sagitta.h, sgt_ray), S = |B| to 2^-26, and
 * so are the terms at the root those at o.  It is not accepted, so t alone is asked for, whatever is picked.
 * THE POINT at t is off along the ray by 6 u |t|, which may be much beside its own coordinates: a start may
 * be farther from the vertex.  Then it is moved by G / B: G there is off by 6 u of its terms, its slope -B.
 *
 * The ray misses if t is before the start, off the sheet or beyond the rim by the margins of side_gone;
 * rounding of the point is far below these (low, near).
 *
 * A first root of a ray for which starts_on is true is asked for here at once (without a proof): neither
 * easy_at nor a part of `away` can have another answer. */

SGT_INLINE side_left left_from_on(const bowl *s, const sgt_ray *ray)
{
    const double ox = ray->o.x, oy = ray->o.y, oz = ray->o.z, l = ray->d.x, m = ray->d.y, n = ray->d.z,
                 tmin = ray->tmin, tmax = ray->tmax, sure = s->proof;
    const twofold k1 = {s->k1, s->k1_lo}, kz = longer_product(k1, oz), zn = longer_product(kz, n),
                  zz = longer_product(kz, oz), xl = two_product(ox, l), ym = two_product(oy, m),
                  xx = two_product(ox, ox), yy = two_product(oy, oy);
    twofold A2 = scaled_sum(s->c, two_product(l, l), two_product(m, m),
                            longer_product(longer_product(k1, n), n)),
            bent = scaled_sum(s->c, xl, ym, zn), round = scaled_sum(s->c, xx, yy, zz),
            B2 = two_sum(n, -bent.hi), C2 = two_sum(round.hi, -2 * oz);
    double A = A2.hi + A2.lo, B = B2.hi + (B2.lo - bent.lo), C = C2.hi + (C2.lo + round.lo), size = fabs(B),
           r2 = xx.hi + yy.hi, Aa = sgt_fma(s->extra, n * n, fabs(A)),
           Ba = sgt_fma(s->abs_c, fabs(xl.hi) + fabs(ym.hi) + fabs(zn.hi), fabs(n)),
           Ca = sgt_fma(s->abs_c, r2 + fabs(zz.hi), 2 * fabs(oz));
    double by = 1 / B, first = 0.5 * C * by, t = 2 * B / A - first, at = fabs(t), w0 = s->ck * oz,
           rule = 0.75 * START_ULPS * sgt_fma(s->abs_c, r2, fabs(oz * (1 - w0)));
    mask usual = MASK(Ca > 0x1p-400) & MASK(Ca < 0x1p400) & MASK(Ba > 0x1p-400) & MASK(Ba < 0x1p400) &
                 MASK(tmin == 0) & MASK(tmax > 0),
         known = usual & MASK(B * B > 0x1p-60 * (Ba * Ba)) & MASK(fabs(A) > 0x1p-20 * Aa) &
                 MASK(Aa * Ca <= 0x1p45 * (B * B)) & MASK(fabs(first) <= 0x1p-27 * at) &
                 MASK(fabs(first) * size <= rule);
    double tau_err = 8 * SGT_U * at, pz = sgt_fma(t, n, oz), w = s->ck * pz, px = sgt_fma(t, l, ox),
           py = sgt_fma(t, m, oy), across = fabs(l) + fabs(m), r2_there = px * px + py * py,
           terms = sgt_fma(fabs(pz), 1 + fabs(w), s->abs_c * r2_there),
           off = pz - 0.5 * sgt_fma(s->c, r2_there, w * pz), /* G, with the slope -B */
           more = chosen(MASK(at * size > 2 * terms), off * by, 0);
    mask low = MASK(fabs(s->ck * (t * n)) <= 0x1p30),
         near = MASK(at * across <= 0x1p20 * (fabs(px) + fabs(py))),
         gone = known & side_gone(s, &(side_origin){ox, oy, oz, 0}, t, 0, ray) &
                (MASK(t < 0) | MASK(t > tmax * (1 + 32 * SGT_U)) | (low & near));
    mask wanted = known & low & MASK(fabs(w) < 1 - 0x1p-8) &
                  MASK(tau_err * across * 0x1p46 <= 64 * SGT_U * s->reach) &
                  MASK(sure * (Aa + Aa) * tau_err < size);
    return (side_left){{{px, py, pz, t}, more, tau_err, by, wanted & ~gone}, gone};
}

SGT_INLINE side_answer met_from_on(const bowl *s, const sgt_ray *ray, double t_tol)
{
    const side_left e = left_from_on(s, ray);
    return (side_answer){
        side_hit(s, &e.root.at, e.root.tau, e.root.tau_err, e.root.inverse, e.root.wanted, ray, t_tol),
        e.away};
}

/* LEAVING IN DOUBLES.  What is known of a ray that starts on the surface, and has tmin = 0.
 *
 *   away    it certainly misses
 *   behind  the sign of F behind the start; 0: not known
 *   met     it meets the surface at tau, if anywhere; tau_err, inverse as in a side_root
 *   start   as starts_on has it, if tmin is 0
 *
 * With B^2 > 2^-40 (Ba^2 + Aa Ca) the slope at the start has the sign of B, and the other root, 2 |B / A|
 * away, is 2^9 times as far as what the rule of the start drops: F has that sign between them.
 *
 * With |B| > 2^-16 Ba, |A| > 2^-16 Aa and Aa Ca <= 2^14 B^2 the other root is at 2 B / A to 2^-33 of it.
 * So by low and near its point is known to 2^-24, and the margins of side_gone are 2^-20.  Its point need not
 * be known where t is negative, or is beyond tmax by more than it is off.
 *
 * THE ROOT is 2 B / A - t1, with t1 = C / 2 B = -G / B, and G as in starts_on: it is off by 6 u of its terms
 * (Ca at most), and is below 2^-49 of them.  So |t1| <= 2^-36 |t|, and its second order, A t1^2 / 2 B, is
 * below u |t|.  A is off by 4 u Aa.  B is n less a sum: its products and sums round by 4 u of b = |c| (|x l|
 * + |y m| + |(1 + k) z n|) at most, the last step by u |B|.  The quotient and the difference round by u
 * each.  With |2 B / A| = |t|, which is right to 2^-33, the root is to first order off by
 *     u ((2 Aa t^2 + 4 b |t| + 6 terms) / |B| + 5 |t|).
 * Where that is at most 38 u |t|, Aa is below 9 |A|, and b below 9 |B|: 1.01 covers the second order.  The
 * point is moved by G / B as in left_from_on, but sooner.  Then t is off by 7 u of the terms there over |B|:
 * 6 of G, one of the point's rounding.  Half of u |t| covers that the slope is -B to 42 u.  (Without that a
 * point was off by up to 11 u of its terms, and the rule of the start drops 16.) */
typedef struct side_start {
    mask away, met, start;
    double behind, tau, tau_err, inverse;
} side_start;

SGT_INLINE side_start leaves_from(const bowl *s, const sgt_ray *ray)
{
    const double x = ray->o.x, y = ray->o.y, z = ray->o.z, l = ray->d.x, m = ray->d.y, n = ray->d.z;
    double kz = s->k1 * z, xl = x * l, ym = y * m, kzn = kz * n, r2 = x * x + y * y, n2 = n * n,
           A = s->c * sgt_fma(s->k1, n2, l * l + m * m), B = sgt_fma(-s->c, xl + ym + kzn, n),
           Aa = sgt_fma(s->extra, n2, fabs(A)),
           bent = s->abs_c * (fabs(xl) + fabs(ym) + fabs(kzn)), Ba = bent + fabs(n),
           Ca = sgt_fma(s->abs_c, r2 + fabs(kz * z), 2 * fabs(z)), B2 = B * B, round = Aa * Ca,
           size = fabs(B),
           w = s->ck * z, G = z - 0.5 * sgt_fma(s->c, r2, w * z),
           terms = sgt_fma(s->abs_c, r2, fabs(z) * (1 + fabs(w)));
    mask usual = MASK(Ca > 0x1p-400) & MASK(Ca < 0x1p400) & MASK(Ba > 0x1p-400) & MASK(Ba < 0x1p400) &
                 MASK(fabs(w) < 1 - 0x1p-8),
         known =
             usual & MASK(size > 0x1p-16 * Ba) & MASK(fabs(A) > 0x1p-16 * Aa) & MASK(round <= 0x1p14 * B2),
         sloped = usual & MASK(B2 > 0x1p-40 * sgt_fma(Ba, Ba, round)),
         start = MASK(ray->tmin == 0) & is_on_quadric(s, x, y, z);
    double inverse = 1 / B, t = sgt_fma(G, inverse, 2 * B / A), at = fabs(t), across = fabs(l) + fabs(m),
           px = sgt_fma(t, l, x), py = sgt_fma(t, m, y), pz = sgt_fma(t, n, z),
           tau_err = 1.01 * SGT_U *
                     sgt_fma(fabs(inverse), sgt_fma(sgt_fma(2 * Aa, at, 4 * bent), at, 6 * terms), 5 * at);
    mask low = MASK(fabs(s->ck * (t * n)) <= 0x1p8),
         near = MASK(at * across <= 0x1p8 * (fabs(px) + fabs(py))),
         beyond = MASK(s->ck * pz > 1 + 0x1p-8) | MASK(px * px + py * py > s->rim2 * (1 + 0x1p-20)),
         gone = MASK(t < 0) | MASK(at * (1 - 0x1p-20) > ray->tmax) | (low & near & beyond),
         away = known & gone & MASK(ray->tmax > 0) & start;
    return (side_start){.away = away,
                        .met = known & start & ~away & MASK(tau_err <= 38 * SGT_U * at) &
                               MASK(tau_err * across * 0x1p46 <= 64 * SGT_U * s->reach),
                        .start = start,
                        .behind = chosen(sloped, copysign(1, B), 0),
                        .tau = t,
                        .tau_err = tau_err,
                        .inverse = inverse};
}

/* That root, for side_hit. */
SGT_INLINE side_place left_in_doubles(const bowl *s, double t, double tau_err, double inverse, mask met,
                                      const sgt_ray *ray)
{
    double px = sgt_fma(t, ray->d.x, ray->o.x), py = sgt_fma(t, ray->d.y, ray->o.y),
           pz = sgt_fma(t, ray->d.z, ray->o.z), w = s->ck * pz, r2 = px * px + py * py, at = fabs(t),
           terms = sgt_fma(fabs(pz), 1 + fabs(w), s->abs_c * r2),
           off = pz - 0.5 * sgt_fma(s->c, r2, w * pz);
    double as_t = terms * fabs(inverse);
    mask moved = MASK(at + at > as_t);
    return (side_place){{px, py, pz, t},
                        chosen(moved, off * inverse, 0),
                        chosen(moved, 1.01 * SGT_U * sgt_fma(7, as_t, at), tau_err),
                        inverse,
                        met};
}

/* The first root of a ray for which starts_on is true, in doubles if it is met so.  quick: else it is asked
 * as any other. */
SGT_INLINE side_answer first_from_on(const bowl *s, mask quick, const sgt_ray *ray, double t_tol)
{
    const side_start q = leaves_from(s, ray);
    const side_left e = left_from_on(s, ray);
    const mask met = quick & q.met;
    const side_place a = left_in_doubles(s, q.tau, q.tau_err, q.inverse, met, ray), b = e.root;
    const side_origin from = {chosen(met, a.at.x, b.at.x), chosen(met, a.at.y, b.at.y),
                              chosen(met, a.at.z, b.at.z), chosen(met, a.at.t0, b.at.t0)};
    return (side_answer){side_hit(s, &from, chosen(met, a.tau, b.tau), chosen(met, a.tau_err, b.tau_err),
                                  chosen(met, a.inverse, b.inverse), met | b.wanted, ray, t_tol),
                         (quick & q.away) | (~met & e.away)};
}

#endif
