// SPDX-License-Identifier: MIT
/* conic/easy.h - a conic or a plane met as in a lane: closed form from the vertex plane, without a branch.
 * The equation is in conic.c, with what happens to the rays that are not easy.  The loops are in
 * conic/lanes.c.
 *
 * EASY.  For nearly every ray of an optical system.  A lane of vector code and a single ray are computed
 * the same way, from the vertex plane, with explicit fma.  Aa >= |A|, Ba >= |B| and |C| are the sums of the
 * magnitudes of the terms.  x is rounded twice.  The errors are: A 4 u Aa, B 5 u Ba, C 7 u |C|, and D u (D
 * + |AC|) beyond what these contribute.  To first order, with S = sqrt D, tau = C / b and |b| = |B| + S,
 *     |dtau| <= u ((2.5 Aa tau^2 + 5 Ba |tau| + 3.5 |C|) / S + 3.5 |tau|).
 * Let Ba^2 + Aa |C| <= q D.  Then Ba <= sqrt(q) S and |C| = |tau b| <= (1 + sqrt q) S |tau|.  Also Aa |C|
 * <= q D, and Aa tau^2 <= q S |tau|.  So
 *     q = 4/3 gives |dtau| <= 20.2 u |tau|; 24 is taken,
 *     q = 4   gives |dtau| <= 34 u |tau|; 48 is taken.
 * t0 + t0_lo is off by 9 u^2 |t0|.  That moves the start along the ray's image in the vertex plane, and tau
 * by no more than 2^-30 of an ulp of t0.
 *
 * A ray is not easy if
 * - q > 4: it grazes;
 * - S > 4 |n|: the start is so far away that its terms exceed those at the root;
 * - 16 D < l^2 + m^2: it meets the surface at less than 14 degrees (flat, but not under a proof).  The first
 *   two conditions leave half of such rays.  side.h is for all of them: a tile of both kinds costs twice as
 *   much;
 * - |w| = |(1 + k) c z| > 1 - 2^-8: near the equator, or on another sheet;
 * - the first root is asked for, and the other one may be before it.  The other root is b / A.  Its
 *   magnitude is the greater one, and it is behind if b A > 0.
 *
 * |c| lies within 2^+-60, n^2 above 2^-200 and r below 2^300.  Then underflow is too small to matter.
 * Overflow makes D infinite or NaN, or makes t a number that does not exceed tmin by a part of itself.
 *
 * AWAY.  A ray that certainly misses, by the same coefficients and with much room for their rounding.
 * Either D is below -2^-20 of its terms.  Or D is above 2^-10 of them, so that each root is right to a part
 * in 2^40, and each root is one of these:
 * - off the sheet,
 * - beyond the rim,
 * - before or behind the ends by a part in 2^20,
 * - the start itself.
 *
 * The distances from tmin tell which of the two is the start, by a factor of 4.  t0 - tmin is off by 3 u
 * |t0|, so roots closer together than that could be confused.  But there the rule of the start (2^-50 |t|
 * of it) hides both.
 *
 * The error of t0 + t0_lo moves x and y by e <= 2^-98 |t0| (|l| + |m|), whatever they are.  If e sqrt(Aa
 * |c|) <= 2^-30 |n|, it moves D by less than 2^-29 of its terms, since 2 |n| sqrt(Aa |c|) |x| is below
 * their sum.  If e is below 2^-38 rims, it moves a root by less than 2^-37 rims.
 *
 * PROVEN.  The bound on t proves a root.  The roots are 2 S / |A| apart.  So if 2 t_err < S / Aa, the root
 * is the only one in [t - t_err, t + t_err].
 *
 * The root is certainly within the rim if its r^2 is at most rim^2 (1 - 464 u).  For |C| <= (1 + sqrt q) S
 * |tau| <= 12 |z|, and |z| <= |c| r^2 on the sheet (k >= -1 or not).  So (x, y) lies within sqrt(12) r of
 * the axis, and |tau| sqrt a <= 4.47 r.  (x, y) is off by 2 u of itself.  The point is off by that, 48 u
 * |tau| sqrt a and u r, 223 u r in all.  r^2 is off by 2 r times that and 4 u of itself.  The error of t0 +
 * t0_lo, 9 u^2 |t0|, moves the root by at most 64 times as much (sag/lanes.h).  That is below 5 u rim if
 * |t0| (|l| + |m|) <= 2^46 rim.  (The soft rim, 512 u above a^2, leaves 48 u to spare for a ray at a
 * itself.) */
#ifndef SGT_SURFACE_CONIC_EASY_H
#define SGT_SURFACE_CONIC_EASY_H

#include "conic.h"
#include "../sag/lanes.h"

/* x - x is 0 for a finite x, NaN otherwise. */
SGT_INLINE bool conic_valid(double c, double k, double semi_diameter)
{
    return (c - c) + (k - k) + (semi_diameter - semi_diameter) == 0 && semi_diameter >= 0;
}

/* A bowl is a plane, sphere or conic as the loops need it: what all its rays share.
 *
 *   c, abs_c     the curvature and its magnitude
 *   k1 + k1_lo   1 + k
 *   ck           (1 + k) c
 *   extra        extra n^2 + |A| >= Aa
 *   rim2         the square of the rim.  It is finite, so that no infinite point is inside.  Under a proof
 *                it is that within which a root is certainly inside
 *   reach        2^46 rims
 *   flat         a ray is not easy if 4 D is below flat (l^2 + m^2)
 *   proof        a proof is asked for */
typedef struct bowl { double c, abs_c, k1, k1_lo, ck, extra, rim2, reach, flat; bool proof; } bowl;

/* Returns false if no ray of the surface is easy. */
SGT_INLINE bool bowl_of(double c, double k, double rim2, bool proof, bowl *s)
{
    double most = rim2 < 0x1p600 ? rim2 : 0x1p600;
    *s = (bowl){c, fabs(c), 1 + k, two_sum(1, k).lo, (1 + k) * c, 1 + k < 0 ? 2 * fabs(1 + k) * fabs(c) : 0,
                proof ? sure_rim2(most) : most, 0x1p46 * sqrt(most), proof ? 0 : 0.25, proof};
    return (c == 0 || (fabs(c) > 0x1p-60 && fabs(c) < 0x1p60)) && fabs(k) < 0x1p60 && rim_in_range(rim2);
}

/* The equation from the vertex plane, and S^2 = D of it.  size: Ba^2 + Aa |C|. */
typedef struct bowl_terms {
    vertex_place at;
    double a, n2, A, Aa, B, C, D, size;
} bowl_terms;

SGT_INLINE bowl_terms bowl_terms_at(const bowl *s, vertex_place at, const sgt_ray *ray)
{
    const double l = ray->d.x, m = ray->d.y, n = ray->d.z;
    bowl_terms g = {.at = at, .a = l * l + m * m, .n2 = n * n};
    double x = g.at.x, y = g.at.y, xl = x * l, ym = y * m,
           Ba = sgt_fma(s->abs_c, fabs(xl) + fabs(ym), fabs(n));
    g.A = s->c * sgt_fma(s->k1, g.n2, g.a), g.B = sgt_fma(-s->c, xl + ym, n), g.C = s->c * (x * x + y * y);
    g.Aa = sgt_fma(s->extra, g.n2, fabs(g.A));
    g.D = sgt_fma(g.B, g.B, -g.A * g.C), g.size = sgt_fma(Ba, Ba, g.Aa * fabs(g.C));
    return g;
}

SGT_INLINE bowl_terms bowl_terms_of(const bowl *s, const sgt_ray *ray)
{
    return bowl_terms_at(s, to_vertex_plane(ray), ray);
}

/* With D <= 16 n^2 it leaves n^2 > 2^-196. */
static const double LEAST_D4 = 0x1p-190;

/* D4: sums, because products are the most frequent operation here. */
SGT_INLINE near_root easy_start_at(const bowl *s, bool first, bool proof, vertex_place at,
                                   const sgt_ray *ray)
{
    const bowl_terms g = bowl_terms_at(s, at, ray);
    double D4 = (g.D + g.D) + (g.D + g.D);
    double S = sqrt(g.D), b = g.B + copysign(S, g.B), tau = g.C / b, small = g.at.t0_lo + tau,
           t = g.at.t0 + small, reach = fabs(t) + fabs(small);
    double tau_err = (D4 >= g.size + g.size + g.size ? 24 * SGT_U : 48 * SGT_U) * fabs(tau);
    double none = (double)NAN,
           t_err = sgt_fma(1.01 * SGT_U, reach, tau_err); /* one choice after another: shorter than masks */
    t_err = D4 > larger(sgt_fma(s->flat, g.a, LEAST_D4), g.size) ? t_err : none;
    t_err = D4 <= 64 * g.n2 ? t_err : none;
    if (proof) t_err = (g.Aa + g.Aa) * t_err < S ? t_err : none;
    if (proof) t_err = fabs(g.at.t0) * (fabs(ray->d.x) + fabs(ray->d.y)) <= s->reach ? t_err : none;
    if (first) t_err = copysign(1, b) * g.A > 0x1p-40 * g.Aa ? t_err : none;
    return (near_root){.x = g.at.x,
                       .y = g.at.y,
                       .tau = tau,
                       .t = t,
                       .t_err = t_err,
                       .tau_err = tau_err,
                       .t0 = g.at.t0,
                       .small = small};
}

SGT_INLINE near_root easy_start(const bowl *s, bool first, bool proof, const sgt_ray *ray)
{
    return easy_start_at(s, first, proof, to_vertex_plane(ray), ray);
}

/* May easy_start give a root near the vertex, which is the first one unless far_gone?  If not, its t_err is
 * NaN. */
SGT_INLINE mask easy_tries(const bowl *s, mask far_gone, const sgt_ray *ray)
{
    const bowl_terms g = bowl_terms_of(s, ray);
    const double flat = (1 - 0x1p-20) * sgt_fma(s->flat, g.a, LEAST_D4); /* `nearby` has another D */
    return MASK(4 * g.D > larger(flat, g.size)) & MASK(g.D <= 16 * g.n2) &
           (far_gone | MASK(copysign(1, g.B) * g.A > 0x1p-40 * g.Aa));
}

SGT_INLINE lane easy_end_any(const bowl *s, const near_root *r, const sgt_ray *ray, double t_tol, bool whole)
{
    const double n = ray->d.z;
    double pz = r->tau * n, w = s->ck * pz, g = -s->c / (1 - w);
    return lane_any(r, ray, t_tol, whole, &(lane_end){pz, g, fabs(r->tau)}, s->rim2, MASK(false),
                    MASK(fabs(w) < 1 - 0x1p-8));
}

SGT_INLINE lane easy_end(const bowl *s, const near_root *r, const sgt_ray *ray, double t_tol)
{
    const lane e = easy_end_any(s, r, ray, t_tol, false);
    return lane_if_met(&e);
}

/* True if t0 + tau is certainly not accepted.  Its point is (x, y, 0) + tau d. */
SGT_INLINE mask gone(const bowl *s, double x, double y, double t0, double tau, const sgt_ray *ray)
{
    const double l = ray->d.x, m = ray->d.y, n = ray->d.z, tmin = ray->tmin, tmax = ray->tmax;
    double px = sgt_fma(tau, l, x), py = sgt_fma(tau, m, y), t = t0 + tau,
           slack = 0x1p-20 * (fabs(t0) + fabs(tau));
    return MASK(s->ck * (tau * n) > 1 + 0x1p-8) | MASK(px * px + py * py > s->rim2 * (1 + 0x1p-20)) |
           MASK(t - slack > tmax) | MASK(t + slack < tmin);
}

/* Does the ray start on the quadric?  Then its root nearest tmin is the start itself, which is not accepted
 * (accept.h).  At the start G = z - c (r^2 + (1 + k) z^2) / 2 is off by 6 u of its terms.  So that root is
 * within (|G| + 6 u terms) / S of tmin.  As much again covers the curvature of G, where D is above 2^-10 of
 * its terms.  Half of what the rule allows is left. */
SGT_INLINE mask is_on_quadric(const bowl *s, double x, double y, double z)
{
    double r2 = x * x + y * y, w = s->ck * z, G = z - 0.5 * sgt_fma(s->c, r2, w * z),
           terms = sgt_fma(s->abs_c, r2, fabs(z) * (1 + fabs(w)));
    return MASK(fabs(G) + 6 * SGT_U * terms < 0.5 * START_ULPS * sgt_fma(s->abs_c, r2, fabs(z * (1 - w))))
           & MASK(terms > 0x1p-600);
}

SGT_INLINE mask starts_on(const bowl *s, const sgt_ray *ray)
{
    const double tmin = ray->tmin;
    return is_on_quadric(s, sgt_fma(tmin, ray->d.x, ray->o.x), sgt_fma(tmin, ray->d.y, ray->o.y),
                         sgt_fma(tmin, ray->d.z, ray->o.z));
}

/* away: neither root is accepted.  For the far root: far_gone: it is certainly not accepted; far_accepted:
 * it certainly is.  It lies in far +- slack.  start: as starts_on. */
typedef struct verdicts {
    mask away, far_gone, far_accepted, start;
    double far, slack;
} verdicts;

/* True if the root is certainly accepted, by the margins of `gone`.  |G'| there is S. */
SGT_INLINE mask conic_stays(const bowl *s, double x, double y, double t0, double tau, const sgt_ray *ray,
                            double S)
{
    const double l = ray->d.x, m = ray->d.y, n = ray->d.z, tmin = ray->tmin, tmax = ray->tmax;
    double px = sgt_fma(tau, l, x), py = sgt_fma(tau, m, y), pz = tau * n, w = s->ck * pz,
           r2 = px * px + py * py, t = t0 + tau, slack = 0x1p-20 * (fabs(t0) + fabs(tau));
    return MASK(w < 1 - 0x1p-8) & MASK(r2 < s->rim2 * (1 - 0x1p-20)) & MASK(t + slack < tmax)
           & MASK(t - slack > tmin)
           & MASK((t - tmin) * S > 0x1p-20 * sgt_fma(s->abs_c, r2, fabs(pz) * (1 + fabs(w))));
}

SGT_INLINE verdicts easy_away(const bowl *s, const sgt_ray *ray)
{
    const double oz = ray->o.z, l = ray->d.x, m = ray->d.y, tmin = ray->tmin, tmax = ray->tmax;
    const bowl_terms g = bowl_terms_of(s, ray);
    const double x = g.at.x, y = g.at.y, t0 = g.at.t0;
    double r2 = x * x + y * y, S = sqrt(larger(g.D, 0)), b = g.B + copysign(S, g.B), near = g.C / b,
           far = b / g.A;
    double to_near = fabs((t0 - tmin) + near), to_far = fabs((t0 - tmin) + far);
    double reach = fabs(t0) * (fabs(l) + fabs(m)), off = 0x1p-98 * reach;
    mask usual = MASK(off * off * (g.Aa * s->abs_c) <= 0x1p-60 * g.n2) & MASK(reach <= 0x1p14 * s->reach) &
                 MASK(g.n2 > 0x1p-200) & MASK(g.a + g.n2 < 0x1p200) & MASK(r2 < 0x1p600) &
                 MASK(g.size < 0x1p600) & MASK(tmin <= tmax) & MASK(tmin < HUGE_VAL) & MASK(tmax > -HUGE_VAL);
    mask real = MASK(g.D > 0x1p-10 * g.size), start = starts_on(s, ray),
         two = MASK(fabs(g.A) > 0x1p-10 * g.Aa);
    mask far_gone = two & (gone(s, x, y, t0, far, ray) | (start & MASK(to_far < 0.25 * to_near)));
    mask from_it = at_vertex(x, y, oz) & MASK(tmin >= 0); /* near is t = 0, the start itself */
    mask near_gone = gone(s, x, y, t0, near, ray) | (start & two & MASK(to_near < 0.25 * to_far)) | from_it;
    far_gone &= usual & real;
    double slack = 0x1p-20 * (fabs(t0) + fabs(far));
    mask far_accepted =
        usual & real & two & MASK(fabs(far - near) > 2 * slack) & conic_stays(s, x, y, t0, far, ray, S);
    mask missed = usual & MASK(g.D < -0x1p-20 * g.size);
    return (verdicts){missed | (far_gone & near_gone), far_gone, far_accepted, start, t0 + far, slack};
}

/* A plane: the same with tau = 0. */
SGT_INLINE near_root plane_start(const bowl *s, bool proof, const sgt_ray *ray)
{
    const double l = ray->d.x, m = ray->d.y, n = ray->d.z;
    const vertex_place at = to_vertex_plane(ray);
    const double t0 = at.t0, t0_lo = at.t0_lo, x = at.x, y = at.y;
    double t = t0 + t0_lo, reach = fabs(t) + fabs(t0_lo);
    mask good = MASK(n * n > 0x1p-200);
    if (proof) good &= MASK(fabs(t0) * (fabs(l) + fabs(m)) <= s->reach);
    return (near_root){.x = x, .y = y, .t = t, .t_err = chosen(good, 1.01 * SGT_U * reach, (double)NAN),
                       .t0 = t0, .small = t0_lo};
}

SGT_INLINE lane plane_end_any(const bowl *s, const near_root *r, const sgt_ray *ray, double t_tol, bool whole)
{
    return lane_any(r, ray, t_tol, whole, &(lane_end){0, 0, 0}, s->rim2, MASK(false), MASK(true));
}

SGT_INLINE lane plane_end(const bowl *s, const near_root *r, const sgt_ray *ray, double t_tol)
{
    const lane e = plane_end_any(s, r, ray, t_tol, false);
    return lane_if_met(&e);
}

/* AWAY for a plane.  It has one root, which is the start itself if the ray begins on it. */
SGT_INLINE mask plane_away(const bowl *s, const sgt_ray *ray)
{
    const double oz = ray->o.z, l = ray->d.x, m = ray->d.y, n = ray->d.z, tmin = ray->tmin, tmax = ray->tmax;
    const vertex_place at = to_vertex_plane(ray);
    const double t0 = at.t0, x = at.x, y = at.y;
    double d2 = (l * l + m * m) + n * n, r2 = x * x + y * y;
    mask usual = MASK(fabs(t0) * (fabs(l) + fabs(m)) <= 0x1p14 * s->reach) & MASK(n * n > 0x1p-200)
                 & MASK(d2 < 0x1p200) & MASK(r2 < 0x1p600) & MASK(tmin <= tmax) & MASK(tmin < HUGE_VAL)
                 & MASK(tmax > -HUGE_VAL);
    return usual & (gone(s, x, y, t0, 0, ray) | (MASK(oz == 0) & MASK(tmin >= 0)));
}

/* As `plane_start` and `plane_end`, also for rays that start on the plane: then all is 0, and t is exact. */
SGT_INLINE lane plane_at_start(const bowl *s, const sgt_ray *ray, double t_tol)
{
    const double oz = ray->o.z;
    near_root r = plane_start(s, true, ray);
    return lane_of(&r, ray, t_tol, &(lane_end){0, 0, 0}, s->rim2, MASK(oz == 0), MASK(true));
}

SGT_INLINE bool easy_at(const bowl *s, bool first, const sgt_ray *ray, double t_tol, lane *e)
{
    near_root r = s->c == 0 ? plane_start(s, s->proof, ray) : easy_start(s, first, s->proof, ray);
    *e = s->c == 0 ? plane_end(s, &r, ray, t_tol) : easy_end(s, &r, ray, t_tol);
    return e->hit != 0;
}

/* NEARBY.  For a ray that starts near the surface, compared with its distance from the vertex plane.  There
 * t = t0 + tau cancels and is not sharp.  So the root is computed once more, by the same equation from the
 * ray's own origin.  Only C cancels there, so C is summed with what its products and sums lose.
 *
 * C is off by u of itself and 64 u^2 of its terms (as from there, in side.h), so by 2 u of itself if it is
 * above 2^-47 of them.  B has one term more than in EASY, and is off by 7 u Ba.  q = 4/3 then gives |dt| <=
 * 23 u |t|; 24 is taken.  What underflows is no part in 2^400 of C.
 *
 * It is the same root that EASY has met from the vertex plane, with no accepted root before it: the two
 * differ by less than their errors.  If the ray starts in the vertex, all is 0 and t is exact, as for a
 * plane.  Each coordinate of the point is rounded once. */

/* c (p + q + r). */
SGT_INLINE twofold scaled_sum(double c, twofold p, twofold q, twofold r)
{
    twofold s = two_sum(p.hi, q.hi), all = two_sum(s.hi, r.hi), scaled = two_product(c, all.hi);
    return (twofold){scaled.hi, sgt_fma(c, (s.lo + all.lo) + ((p.lo + q.lo) + r.lo), scaled.lo)};
}

/* a b, with the low part of a. */
SGT_INLINE twofold longer_product(twofold a, double b)
{
    twofold p = two_product(a.hi, b);
    return (twofold){p.hi, sgt_fma(a.lo, b, p.lo)};
}

/* A root as lane_of takes it; w is (1 + k) c z there. */
typedef struct root_there {
    near_root at;
    double pz, w, near;
    mask exact, also;
} root_there;

SGT_INLINE root_there nearby_root(const bowl *s, const near_root *at, const sgt_ray *ray)
{
    const double ox = ray->o.x, oy = ray->o.y, oz = ray->o.z, l = ray->d.x, m = ray->d.y, n = ray->d.z;
    const twofold kz = longer_product((twofold){s->k1, s->k1_lo}, oz), zz = longer_product(kz, oz),
                  xx = two_product(ox, ox), yy = two_product(oy, oy), round = scaled_sum(s->c, xx, yy, zz),
                  C2 = two_sum(round.hi, -2 * oz);
    double a = l * l + m * m, n2 = n * n, A = s->c * sgt_fma(s->k1, n2, a),
           Aa = sgt_fma(s->extra, n2, fabs(A)), C = C2.hi + (C2.lo + round.lo);
    double xl = ox * l, ym = oy * m, kzn = kz.hi * n, B = sgt_fma(-s->c, xl + ym + kzn, n),
           Ba = sgt_fma(s->abs_c, fabs(xl) + fabs(ym) + fabs(kzn), fabs(n));
    double D = sgt_fma(B, B, -A * C), size = sgt_fma(Ba, Ba, Aa * fabs(C)), S = sqrt(D),
           t = C / (B + copysign(S, B));
    double px = sgt_fma(t, l, ox), py = sgt_fma(t, m, oy), pz = sgt_fma(t, n, oz), w = s->ck * pz,
           side = fabs(l) + fabs(m);
    double terms = sgt_fma(s->abs_c, (xx.hi + yy.hi) + fabs(zz.hi), 2 * fabs(oz)),
           around = sgt_fma(s->abs_c, px * px + py * py, fabs(pz) * (2 + fabs(w)));
    near_root r = {.x = ox, .y = oy, .tau = t, .t = t, .t_err = 25.1 * SGT_U * fabs(t),
                   .tau_err = 25.1 * SGT_U * fabs(t), .small = t};
    mask exact = at_vertex(ox, oy, oz),
         sharp = MASK(fabs(C) > sgt_fma(0x1p-47, terms, 0x1p-447)) & MASK(terms < 0x1p400);
    mask same = MASK(fabs(t - at->t) <= 4 * at->t_err) & MASK(4 * D >= 3 * size)
                & MASK(fabs(t) * side <= 0x1p-44 * s->reach) & MASK((Aa + Aa) * r.t_err < S) &
                MASK(4 * D > s->flat * a);
    same &= (sharp | exact) & MASK(fabs(w) < 1 - 0x1p-8);
    return (root_there){r, pz, w, around / fabs(n), exact, same};
}

SGT_INLINE lane lane_of_root(const bowl *s, const root_there *r, const sgt_ray *ray, double t_tol)
{
    return lane_of(&r->at, ray, t_tol, &(lane_end){r->pz, -s->c / (1 - r->w), r->near}, s->rim2,
                   r->exact, r->also);
}

SGT_INLINE lane nearby(const bowl *s, const near_root *at, const sgt_ray *ray, double t_tol)
{
    const root_there r = nearby_root(s, at, ray);
    return lane_of_root(s, &r, ray, t_tol);
}

/* The root of easy_start if it is sharp (lane_of), else that nearby.  Another root than a single ray has is
 * never met so: it tries both, and that of easy_start first. */
SGT_INLINE root_there sharper_root(const bowl *s, bool first, const sgt_ray *ray, double t_tol)
{
    const near_root a = easy_start(s, first, true, ray);
    const root_there b = nearby_root(s, &a, ray);
    const double pz = a.tau * ray->d.z, w = s->ck * pz, at = fabs(a.t);
    const mask e = MASK(a.t_err <= larger(40 * SGT_U * at, t_tol)) & MASK(at + a.t_err > LEAST_PLACE) &
                   MASK(fabs(w) < 1 - 0x1p-8);
    return (root_there){{chosen(e, a.x, b.at.x), chosen(e, a.y, b.at.y), chosen(e, a.tau, b.at.tau),
                         chosen(e, a.t, b.at.t), chosen(e, a.t_err, b.at.t_err),
                         chosen(e, a.tau_err, b.at.tau_err), chosen(e, a.t0, b.at.t0),
                         chosen(e, a.small, b.at.small)},
                        chosen(e, pz, b.pz),
                        chosen(e, w, b.w),
                        chosen(e, fabs(a.tau), b.near),
                        b.exact, /* if e, it says nothing */
                        e | b.also};
}

SGT_INLINE lane easy_or_nearby(const bowl *s, bool first, const sgt_ray *ray, double t_tol)
{
    const root_there r = sharper_root(s, first, ray, t_tol);
    return lane_of_root(s, &r, ray, t_tol);
}

SGT_INLINE bool nearby_at(const bowl *s, bool first, const sgt_ray *ray, double t_tol, lane *e)
{
    near_root at = easy_start(s, first, true, ray);
    *e = s->c == 0 ? plane_at_start(s, ray, t_tol) : nearby(s, &at, ray, t_tol);
    return e->hit != 0;
}

#endif
