/* conic/easy.h - a conic or a plane met as lanes are: closed form from the vertex plane, no branch.
 * conic.c has the equation, and what becomes of the rays that are not easy; conic/lanes.c the loops.
 *
 * EASY.  Nearly every ray of an optical system: one lane of vector code, and one ray alone the same way.
 * From the vertex plane, with explicit fma, and Aa >= |A|, Ba >= |B|, |C| the sums of the magnitudes of
 * their terms; x is rounded twice, A is off by 4 u Aa, B by 5 u Ba, C by 7 u |C|, D by u (D + |AC|) beyond
 * what these make of it.  To first order
 *     |dtau| <= u ((2.5 Aa tau^2 + 5 Ba |tau| + 3.5 |C|) / S + 3.5 |tau|),   S = sqrt D, tau = C / b, |b| =
 *         |B| + S.
 * Let Ba^2 + Aa |C| <= q D.  Then Ba <= sqrt(q) S, |C| = |tau b| <= (1 + sqrt q) S |tau| and Aa |C| <= q D,
 * Aa tau^2 <= q S |tau|.  So q = 4/3 gives |dtau| <= 20.2 u |tau|, q = 4 gives 34 u |tau|; 24 and 48 are
 * taken, and q > 4, a ray that grazes, is not accepted.  What t0 + t0_lo is off by, 9 u^2 |t0|, moves the
 * start along the ray's image in the vertex plane and is no more than 2^-30 of an ulp of t0 to tau.  Not
 * accepted either: S > 4 |n|, a start so far off that its terms are more than those at the root; |w| = |(1
 * + k) c z| > 1 - 2^-8, near the equator, or on another sheet; and where the first root is asked for, one
 * whose other may be before it: that is b / A, whose magnitude is the greater, and which is behind if b A >
 * 0.  |c| lies within 2^+-60, n^2 above 2^-200 and r below 2^300: then what underflows is too small to
 * matter, and what overflows makes D infinite or NaN, or t no number that is greater than tmin by a part of
 * itself.
 *
 * AWAY.  A ray that certainly misses, by the same coefficients and with much room for their rounding: D
 * below -2^-20 of its terms; or D above 2^-10 of them, so that either root is right to a part in 2^40, and
 * each of the two off the sheet, beyond the rim, before or behind the ends by a part in 2^20, or the start
 * itself.  Which of the two the start is, the distances from tmin tell, by a factor of 4; t0 - tmin is off
 * by 3 u |t0|, so roots closer together than that could be taken for each other, but there the rule of the
 * start (2^-50 |t| of it) hides both.  What t0 + t0_lo is off by moves x and y by e <= 2^-98 |t0| (|l| +
 * |m|), whatever they are.  It moves D by less than 2^-29 of its terms where e sqrt(Aa |c|) <= 2^-30 |n|,
 * since 2 |n| sqrt(Aa |c|) |x| is below their sum; and a root by less than 2^-37 rims where e is below
 * 2^-38 of them.
 *
 * PROVEN.  The bound on t proves a root.  It is the only one in [t - t_err, t + t_err] where 2 t_err < S /
 * Aa, since the roots are 2 S / |A| apart.  Within the rim it is for certain if its r^2 is at most rim^2 (1
 * - 464 u).  For |C| <= (1 + sqrt q) S |tau| <= 12 |z|, and |z| <= |c| r^2 on the sheet (k >= -1 or not),
 * so (x, y) lies within sqrt(12) r of the axis and |tau| sqrt a <= 4.47 r; it is off by 2 u of itself, the
 * point by that, 48 u |tau| sqrt a and u r, 223 u r in all, and r^2 by 2 r times that and 4 u of itself.
 * What t0 + t0_lo is off by, 9 u^2 |t0|, moves the root by 64 times as much at most (sag/lanes.h), below 5
 * u rim where |t0| (|l| + |m|) <= 2^46 rim.  (The soft rim, 512 u above a^2, leaves a ray at a itself 48 u
 * to spare.) */
#ifndef SGT_SURFACE_CONIC_EASY_H
#define SGT_SURFACE_CONIC_EASY_H

#include "conic.h"
#include "../sag/lanes.h"

/* x - x is 0 for a finite x, NaN for another. */
SGT_INLINE bool conic_valid(double c, double k, double semi_diameter)
{
    return (c - c) + (k - k) + (semi_diameter - semi_diameter) == 0 && semi_diameter >= 0;
}

/* What a surface brings to all its rays; extra n^2 + |A| >= Aa; rim2 is finite, so that no infinite point
 * is inside.  Where a proof is asked for rim2 is the one within which a root is certain, and reach 2^46
 * rims. */
typedef struct bowl { double c, abs_c, k1, k1_lo, ck, extra, rim2, reach; bool proof; } bowl;

/* false: no ray is easy. */
SGT_INLINE bool bowl_of(double c, double k, double rim2, bool proof, bowl *s)
{
    double most = rim2 < 0x1p600 ? rim2 : 0x1p600;
    *s = (bowl){c,
                fabs(c),
                1 + k,
                two_sum(1, k).lo,
                (1 + k) * c,
                1 + k < 0 ? 2 * fabs(1 + k) * fabs(c) : 0,
                proof ? sure_rim2(most) : most,
                0x1p46 * sqrt(most),
                proof};
    return (c == 0 || (fabs(c) > 0x1p-60 && fabs(c) < 0x1p60)) && fabs(k) < 0x1p60 && rim_in_range(rim2);
}

SGT_INLINE near_root easy_start(const bowl *s, bool first, bool proof, double ox, double oy, double oz,
                                double l, double m, double n)
{
    double t0, t0_lo, x, y;
    to_vertex_plane(ox, oy, oz, l, m, n, &t0, &t0_lo, &x, &y);
    double xl = x * l, ym = y * m, a = l * l + m * m, n2 = n * n;
    double A = s->c * sgt_fma(s->k1, n2, a), B = sgt_fma(-s->c, xl + ym, n), C = s->c * (x * x + y * y);
    double Aa = sgt_fma(s->extra, n2, fabs(A)), Ba = sgt_fma(s->abs_c, fabs(xl) + fabs(ym), fabs(n));
    double D = sgt_fma(B, B, -A * C), size = sgt_fma(Ba, Ba, Aa * fabs(C)), D4 = (D + D) + (D + D);
    double S = sqrt(D), b = B + copysign(S, B), tau = C / b, small = t0_lo + tau, t = t0 + small,
           reach = fabs(t) + fabs(small);
    /* sums: products are what there is most of */
    double n4 = (n2 + n2) + (n2 + n2), n16 = (n4 + n4) + (n4 + n4);
    double tau_err = (D4 >= size + size + size ? 24 * SGT_U : 48 * SGT_U) * fabs(tau);
    double none = (double)NAN,
           t_err = sgt_fma(1.01 * SGT_U, reach, tau_err); /* one choice after another: shorter than masks */
    t_err = D4 > size ? t_err : none;
    t_err = D <= n16 ? t_err : none;
    t_err = n2 > 0x1p-200 ? t_err : none;
    if (proof) t_err = (Aa + Aa) * t_err < S ? t_err : none;
    if (proof) t_err = fabs(t0) * (fabs(l) + fabs(m)) <= s->reach ? t_err : none;
    if (first) t_err = copysign(1, b) * A > 0x1p-40 * Aa ? t_err : none;
    return (near_root){
        .x = x, .y = y, .tau = tau, .t = t, .t_err = t_err, .tau_err = tau_err, .t0 = t0, .small = small};
}

SGT_INLINE lane easy_end(const bowl *s, const near_root *r, double l, double m, double n, double tmin,
                         double tmax, double t_tol)
{
    double pz = r->tau * n, w = s->ck * pz, g = -s->c / (1 - w);
    return lane_of(r, l, m, n, tmin, tmax, t_tol, pz, g, fabs(r->tau), s->rim2, MASK(false),
                   MASK(fabs(w) < 1 - 0x1p-8));
}

/* t0 + tau does not count; its point is (x, y, 0) + tau d. */
SGT_INLINE mask gone(const bowl *s, double x, double y, double t0, double tau, double l, double m, double n,
                     double tmin, double tmax)
{
    double px = sgt_fma(tau, l, x), py = sgt_fma(tau, m, y), t = t0 + tau,
           slack = 0x1p-20 * (fabs(t0) + fabs(tau));
    return MASK(s->ck * (tau * n) > 1 + 0x1p-8) | MASK(px * px + py * py > s->rim2 * (1 + 0x1p-20)) |
           MASK(t - slack > tmax) | MASK(t + slack < tmin);
}

/* The ray starts on the quadric: its root nearest tmin is the start itself, which does not count
 * (accept.h).  At the start G = z - c (r^2 + (1 + k) z^2) / 2 is off by 6 u of its terms, so that root is
 * within (|G| + 6 u terms) / S of tmin, and as much again makes up for G's curvature, where D is above
 * 2^-10 of its terms; half of what the rule allows is left. */
SGT_INLINE mask starts_on(const bowl *s, double ox, double oy, double oz, double l, double m, double n,
                          double tmin)
{
    double x = sgt_fma(tmin, l, ox), y = sgt_fma(tmin, m, oy), z = sgt_fma(tmin, n, oz), r2 = x * x + y * y,
           w = s->ck * z;
    double G = z - 0.5 * sgt_fma(s->c, r2, w * z), terms = sgt_fma(s->abs_c, r2, fabs(z) * (1 + fabs(w)));
    return MASK(fabs(G) + 6 * SGT_U * terms < 0.5 * START_ULPS * sgt_fma(s->abs_c, r2, fabs(z * (1 - w))))
           & MASK(terms > 0x1p-600);
}

/* Neither root counts; and of the far one alone: it does not, it does, it is in far +- slack. */
typedef struct verdicts { mask away, far_gone, far_accepted; double far, slack; } verdicts;

/* It counts, as certainly as `gone` says that it does not; S is G' there, but for its sign. */
SGT_INLINE mask conic_stays(const bowl *s, double x, double y, double t0, double tau, double l, double m,
                            double n, double tmin, double tmax, double S)
{
    double px = sgt_fma(tau, l, x), py = sgt_fma(tau, m, y), pz = tau * n, w = s->ck * pz,
           r2 = px * px + py * py, t = t0 + tau, slack = 0x1p-20 * (fabs(t0) + fabs(tau));
    return MASK(w < 1 - 0x1p-8) & MASK(r2 < s->rim2 * (1 - 0x1p-20)) & MASK(t + slack < tmax)
           & MASK(t - slack > tmin)
           & MASK((t - tmin) * S > 0x1p-20 * sgt_fma(s->abs_c, r2, fabs(pz) * (1 + fabs(w))));
}

SGT_INLINE verdicts easy_away(const bowl *s, double ox, double oy, double oz, double l, double m, double n,
                              double tmin, double tmax)
{
    double t0, t0_lo, x, y;
    to_vertex_plane(ox, oy, oz, l, m, n, &t0, &t0_lo, &x, &y);
    double xl = x * l, ym = y * m, a = l * l + m * m, n2 = n * n, r2 = x * x + y * y;
    double A = s->c * sgt_fma(s->k1, n2, a), B = sgt_fma(-s->c, xl + ym, n), C = s->c * r2;
    double Aa = sgt_fma(s->extra, n2, fabs(A)), Ba = sgt_fma(s->abs_c, fabs(xl) + fabs(ym), fabs(n));
    double D = sgt_fma(B, B, -A * C), size = sgt_fma(Ba, Ba, Aa * fabs(C)), S = sqrt(larger(D, 0)),
           b = B + copysign(S, B), near = C / b, far = b / A;
    double to_near = fabs((t0 - tmin) + near), to_far = fabs((t0 - tmin) + far);
    double reach = fabs(t0) * (fabs(l) + fabs(m)), off = 0x1p-98 * reach;
    mask usual = MASK(off * off * (Aa * s->abs_c) <= 0x1p-60 * n2) & MASK(reach <= 0x1p14 * s->reach) &
                 MASK(n2 > 0x1p-200) & MASK(a + n2 < 0x1p200) & MASK(r2 < 0x1p600) & MASK(size < 0x1p600) &
                 MASK(tmin <= tmax) & MASK(tmin < HUGE_VAL) & MASK(tmax > -HUGE_VAL);
    mask real = MASK(D > 0x1p-10 * size), start = starts_on(s, ox, oy, oz, l, m, n, tmin),
         two = MASK(fabs(A) > 0x1p-10 * Aa);
    mask far_gone =
        two & (gone(s, x, y, t0, far, l, m, n, tmin, tmax) | (start & MASK(to_far < 0.25 * to_near)));
    mask from_it = at_vertex(x, y, oz) & MASK(tmin >= 0); /* near is t = 0, and the start */
    mask near_gone = gone(s, x, y, t0, near, l, m, n, tmin, tmax)
                     | (start & two & MASK(to_near < 0.25 * to_far)) | from_it;
    far_gone &= usual & real;
    double slack = 0x1p-20 * (fabs(t0) + fabs(far));
    mask far_accepted = usual & real & two & MASK(fabs(far - near) > 2 * slack) &
                        conic_stays(s, x, y, t0, far, l, m, n, tmin, tmax, S);
    return (verdicts){(usual & MASK(D < -0x1p-20 * size)) | (far_gone & near_gone), far_gone, far_accepted,
                      t0 + far, slack};
}

/* A plane: the same with tau = 0. */
SGT_INLINE near_root plane_start(const bowl *s, bool proof, double ox, double oy, double oz, double l,
                                 double m, double n)
{
    double t0, t0_lo, x, y;
    to_vertex_plane(ox, oy, oz, l, m, n, &t0, &t0_lo, &x, &y);
    double t = t0 + t0_lo, reach = fabs(t) + fabs(t0_lo);
    mask good = MASK(n * n > 0x1p-200);
    if (proof) good &= MASK(fabs(t0) * (fabs(l) + fabs(m)) <= s->reach);
    return (near_root){.x = x,
                       .y = y,
                       .t = t,
                       .t_err = chosen(good, 1.01 * SGT_U * reach, (double)NAN),
                       .t0 = t0,
                       .small = t0_lo};
}

SGT_INLINE lane plane_end(const bowl *s, const near_root *r, double l, double m, double n, double tmin,
                          double tmax, double t_tol)
{
    return lane_of(r, l, m, n, tmin, tmax, t_tol, 0, 0, 0, s->rim2, MASK(false), MASK(true));
}

/* AWAY, of a plane: it has one root, the start itself where the ray begins on it. */
SGT_INLINE mask plane_away(const bowl *s, double ox, double oy, double oz, double l, double m, double n,
                           double tmin, double tmax)
{
    double t0, t0_lo, x, y;
    to_vertex_plane(ox, oy, oz, l, m, n, &t0, &t0_lo, &x, &y);
    double d2 = (l * l + m * m) + n * n, r2 = x * x + y * y;
    mask usual = MASK(fabs(t0) * (fabs(l) + fabs(m)) <= 0x1p14 * s->reach) & MASK(n * n > 0x1p-200)
                 & MASK(d2 < 0x1p200) & MASK(r2 < 0x1p600) & MASK(tmin <= tmax) & MASK(tmin < HUGE_VAL)
                 & MASK(tmax > -HUGE_VAL);
    return usual & (gone(s, x, y, t0, 0, l, m, n, tmin, tmax) | (MASK(oz == 0) & MASK(tmin >= 0)));
}

/* The same as `plane_start` and `plane_end`, of rays that start on it too: all is 0 then, and t exact. */
SGT_INLINE lane plane_at_start(const bowl *s, double ox, double oy, double oz, double l, double m, double n,
                               double tmin, double tmax, double t_tol)
{
    near_root r = plane_start(s, true, ox, oy, oz, l, m, n);
    return lane_of(&r, l, m, n, tmin, tmax, t_tol, 0, 0, 0, s->rim2, MASK(oz == 0), MASK(true));
}

SGT_INLINE bool easy_at(const bowl *s, bool first, sgt_vec3 o, sgt_vec3 d, double tmin, double tmax,
                        double t_tol, lane *e)
{
    near_root r = s->c == 0 ? plane_start(s, s->proof, o.x, o.y, o.z, d.x, d.y, d.z)
                            : easy_start(s, first, s->proof, o.x, o.y, o.z, d.x, d.y, d.z);
    *e = s->c == 0 ? plane_end(s, &r, d.x, d.y, d.z, tmin, tmax, t_tol)
                   : easy_end(s, &r, d.x, d.y, d.z, tmin, tmax, t_tol);
    return e->hit != 0;
}

/* NEARBY.  A ray that starts near the surface, for how far that is from the vertex plane: t = t0 + tau
 * cancels, and is not sharp.  Its root once more, by the same equation from the ray's own origin, where C is
 * all that cancels: in twice the precision.  C is off by 27 u^2 of its terms, so by u of itself where it is
 * above 2^-47 of them; B, with one term more than in EASY, by 7 u Ba; and q = 4/3 gives |dt| <= 23 u |t|, of
 * which 24 are taken.  It is the root that EASY has met from the vertex plane, and that no other counts
 * before: the two differ by less than their errors. Where the ray starts in the vertex all is 0 and t is
 * exact, as from on a plane.  The point is rounded once in each coordinate. */
SGT_INLINE lane nearby(const bowl *s, const near_root *at, double ox, double oy, double oz, double l,
                       double m, double n, double tmin, double tmax, double t_tol)
{
    twofold zz = two_product(oz, oz), k1zz = twofold_product((twofold){s->k1, s->k1_lo}, zz);
    twofold C2 = twofold_difference(
        twofold_scaled(twofold_sum(twofold_sum(two_product(ox, ox), two_product(oy, oy)), k1zz), s->c),
        twofold_of(2 * oz));
    double a = l * l + m * m, n2 = n * n, A = s->c * sgt_fma(s->k1, n2, a),
           Aa = sgt_fma(s->extra, n2, fabs(A)), C = C2.hi;
    double xl = ox * l, ym = oy * m, kzn = s->k1 * oz * n, B = sgt_fma(-s->c, xl + ym + kzn, n),
           Ba = sgt_fma(s->abs_c, fabs(xl) + fabs(ym) + fabs(kzn), fabs(n));
    double D = sgt_fma(B, B, -A * C), size = sgt_fma(Ba, Ba, Aa * fabs(C)), S = sqrt(D),
           t = C / (B + copysign(S, B));
    double px = sgt_fma(t, l, ox), py = sgt_fma(t, m, oy), pz = sgt_fma(t, n, oz), w = s->ck * pz,
           g = -s->c / (1 - w), side = fabs(l) + fabs(m);
    double terms = sgt_fma(s->abs_c, ox * ox + oy * oy + fabs(k1zz.hi), 2 * fabs(oz)),
           around = sgt_fma(s->abs_c, px * px + py * py, fabs(pz) * (2 + fabs(w)));
    near_root r = {.x = ox,
                   .y = oy,
                   .tau = t,
                   .t = t,
                   .t_err = 25.1 * SGT_U * fabs(t),
                   .tau_err = 25.1 * SGT_U * fabs(t),
                   .small = t};
    mask exact = at_vertex(ox, oy, oz),
         sharp = MASK(fabs(C) > 0x1p-47 * terms) & MASK(terms > 0x1p-400) & MASK(terms < 0x1p400);
    mask same = MASK(fabs(t - at->t) <= 4 * at->t_err) & MASK(4 * D >= 3 * size)
                & MASK(fabs(t) * side <= 0x1p-44 * s->reach) & MASK((Aa + Aa) * r.t_err < S);
    return lane_of(&r, l, m, n, tmin, tmax, t_tol, pz, g, around / fabs(n), s->rim2, exact,
                   same & (sharp | exact) & MASK(fabs(w) < 1 - 0x1p-8));
}

/* Of both, in one lane. */
SGT_INLINE lane easy_or_nearby(const bowl *s, bool first, double ox, double oy, double oz, double l, double m,
                               double n, double tmin, double tmax, double t_tol)
{
    near_root r = easy_start(s, first, true, ox, oy, oz, l, m, n);
    lane a = easy_end(s, &r, l, m, n, tmin, tmax, t_tol),
         b = nearby(s, &r, ox, oy, oz, l, m, n, tmin, tmax, t_tol);
    mask e = a.hit;
    return (lane){chosen(e, a.t, b.t),   chosen(e, a.t_err, b.t_err), chosen(e, a.t_lo, b.t_lo),
                  chosen(e, a.px, b.px), chosen(e, a.py, b.py),       chosen(e, a.pz, b.pz),
                  chosen(e, a.nx, b.nx), chosen(e, a.ny, b.ny),       chosen(e, a.p_err, b.p_err),
                  a.hit | b.hit};
}

SGT_INLINE bool nearby_at(const bowl *s, bool first, sgt_vec3 o, sgt_vec3 d, double tmin, double tmax,
                          double t_tol, lane *e)
{
    near_root at = easy_start(s, first, true, o.x, o.y, o.z, d.x, d.y, d.z);
    *e = s->c == 0 ? plane_at_start(s, o.x, o.y, o.z, d.x, d.y, d.z, tmin, tmax, t_tol)
                   : nearby(s, &at, o.x, o.y, o.z, d.x, d.y, d.z, tmin, tmax, t_tol);
    return e->hit != 0;
}

#endif
