// SPDX-License-Identifier: MIT
/* asphere/side.h - an even asphere met from the point of the ray nearest the vertex, without a branch: rays
 * that run along the surface, enter a bowl from the side, or pass by.  The loops are in asphere/side.c.
 *
 * WHY.  Such a ray meets the vertex plane far from its root, or not at all, and easy.h leaves it.  And where
 * the bound on the slope allows a second root, nothing there tells which is the first.
 *
 * CONVEX.  Let S be the sag and sigma S'' >= 0 for all r <= R, with S'' its second derivative in r and sigma
 * = 1 or -1.  As S'(0) = 0, sigma S' / r >= 0 too.  These two are the curvatures of S.  So sigma F = sigma (z
 * - S) is concave along each stretch of a ray within R.  r^2 is convex along a ray: the stretch between two
 * points is within the larger r of the two.  For a conic S'' = c / phi^3, with phi^2 = 1 - (1 + k) c^2 r^2.
 * That is c sigma at least, or, if (1 + k) c^2 < 0, what it is at R.  The terms add (2 i + 2) (2 i + 1) a[i]
 * r^(2 i); those of the sign of sigma are left out, but for a[0], which is constant.
 *
 * That is far from sharp where a term outgrows another.  So S'' is bounded ring by ring, too: in thirty-two
 * rings of the same area up to the rim or the equator.  In each the terms of the sign of sigma are taken at
 * the inner edge, the others at the outer one.  The base is |c| (1 + 1.5 (1 + k) c^2 r^2) at least, the
 * tangent at r = 0 of a convex function of r^2.  S is convex up to the first ring in which this does not
 * show.
 *
 * A concave function has two zeros at most: it rises at the first, and falls at the second.  Let the stretch
 * begin where the ray does, or where r comes below the rim, and end likewise.  Then
 *     a root at which sigma F rises                                  is the first,
 *     the same, if sigma F > 0 at the end of the stretch             is the only one,
 *     a root at which it falls, if sigma F > 0 at the beginning      is the only one,
 *     sigma F > 0 at the beginning and at the end                    is a miss.
 *
 * FROM ON IT.  A ray may start on the surface, at o within the rim, with tmin = 0.  If G there is within
 * half of what the rule of the start allows, and G' keeps its sign within H = 4 (|G| + e) / |G'| (THE BOUND
 * of easy.h), the root at the start is the only one within H, and is not accepted.  At H F has the sign of
 * its slope.  So if sigma F rises at the start, it is > 0 at the beginning of what is left.  If it falls,
 * it falls on: a ray that is within R all along misses, and any ray does where S is convex to its end.
 *
 * PASSING BY.  The sag within the rim, or up to the equator, is between two heights (wavy_ahead of easy.h).
 * If the ray is above or below both of them along its whole stretch, or if the stretch is empty, it misses.
 *
 * THE ROOT.  The conic of curvature c + 2 a[0] gives the first guess, one root of the two, or the place where
 * they fall together.  Newton's steps on G lead from there to the root.  The last steps, and the bound with
 * its argument, are those of easy.h, with z = z0 + tau n.
 *
 * ROUNDING, in units of u.  The local origin (x0, y0, z0) is right to u of each coordinate (moved_along in
 * num/local.h), and its t0 is a double.  x = fma(tau, l, x0) is off by |x0| + |x|, so rho is off by 5 rho +
 * rho0: 2 (|x x0| + |y y0|) <= rho + rho0, 2 rho by the last rounding of x and y, 2 rho by the products and
 * the sum.  Horner's rule rounds P by another first rho.  With Q = 6 rho + rho0
 *     w is off by first Q + |z0| + |z| + |w|,
 *     G by e = |v| (error of w) + |c| Q / 2 + 3 |(1 + k) c| w^2 + |G|.
 * (|c| rho / 2 of the second is the rounding of the inner fma.)  The slope is as good as that of easy.h.
 * There 2 W1 stands for |v| W1: far out on a hyperboloid v is more than 2, and is taken itself.  v is off by
 * e |(1 + k) c| / v, which has to be below 2^-38, or below 2^-38 v.
 *
 * SHARP.  Where the ray runs along the surface, or its local origin is far from the root, t is not sharp:
 * known to some hundreds of u.  Then G is computed once more, from the point at T = t0 + tau, which is a
 * double.  Its coordinates are known to 4 u^2 of themselves (place_of_root), and sums and products are taken
 * with what they lose.  Of 8 terms Horner's rule is off by (16 u)^2 of its own, so G is off by u |G| and 2^9
 * u^2 of the terms of e above; 2^12 is taken.  The root R is the only one within H of tau_2, and so is T:
 * both are within 5/8 H of it. So by the mean value theorem, with the slope s of THE BOUND, R = T - G / s (1
 * + epsilon),    |epsilon| <= 8/7 Delta / |s|.
 *
 * THE POINT.  Rounding of x, x0, y, y0 and z0 takes it off the surface by u of their parts of F.  So a ray is
 * met only if (|x| + |x0|) |F_x| + (|y| + |y0|) |F_y| <= 12 |z| and |z0| <= 2 |z| there.  Where the slope S'
 * is large, that sum may be 4 |z| sqrt(1 + S'^2): then the point is 4 u |z| off, measured along the normal.
 *
 * HEIGHTS.  Where S is convex (or concave) as far as the surface goes, it only rises (or falls) with r, as
 * S'(0) = 0: it lies between 0 and what it is where it ends.  Else the terms of either sign bound it
 * (wavy_ahead).
 *
 * PAST THE HEIGHTS of the surface within the rim or the equator there is no root, so a stretch ends where the
 * ray comes there.  So a ray that leaves needs no F next to the equator, and less has to be
 * convex.
 *
 * AN END of a stretch is moved outward: in r^2 by 2^-20, in t by 2^-50 of its terms.  So nothing rests on its
 * last digits, and F there is that of the point as it is, with the bound e.
 *
 * UNDERFLOW.  rho is between 2^-400 and 2^400 at the root; what underflows is below 2^-1000 in G, which is
 * added. */
#ifndef SGT_SURFACE_ASPHERE_SIDE_H
#define SGT_SURFACE_ASPHERE_SIDE_H

#include "../../num/bits.h"
#include "easy.h"

/* Evaluations: both ends, the start, the steps, the bound, and SHARP; before them those of graze.h. */
enum { SIDE_STEPS = 12, GRAZE_STEPS = 7, SIDE_LOOKS = SIDE_STEPS + 5 + GRAZE_STEPS + 1 };

/* What all rays of a surface share.
 *
 *   sign         sigma
 *   round, constant, flat
 *                sigma S'' is at least `round` (of the base, at r = 0), plus constant = 2 max(sigma a[0], 0),
 *                less the sum of flat[i] r^(2 i)
 *   ckc          (1 + k) c^2
 *   bent2        sigma S'' >= 0 up to that r^2, by rings; short of the equator by 2^-9
 *   edge2, edge  r^2 of the rim or the equator, made greater by 2^-20; its root
 *   high, low    the sag within it is between -low and high
 *   bowl         c + 2 a[0]
 *   abs_ck       |(1 + k) c|
 *   ck_lo        what (1 + k) c is more than its double */
typedef struct convex {
    double sign, round, constant, flat[ALL_TERMS], ckc, abs_ck, bent2, edge2, edge, high, low, bowl, ck_lo;
    bool everywhere, whole; /* no term has the other sign; sigma S'' >= 0 wherever S is */
} convex;

/* r^2 up to which sigma S'' >= 0, by rings; 0 if it is not known. */
SGT_INLINE double bent_by_rings(const wavy *s, const convex *b)
{
    enum { RINGS_OF_BEND = 32 };
    double least[RINGS_OF_BEND], own[ALL_TERMS] = {0},
           width = b->edge2 * ((1 + 0x1p-9) / RINGS_OF_BEND); /* wavy_r2 of the edge is in the last */
    int rings = 0;
    for (int i = 1; i < ALL_TERMS; i++)
        own[i] = larger(b->sign * s->a[i], 0) * ((2 * i + 2) * (2 * i + 1));
    LANES for (int j = 0; j < RINGS_OF_BEND; j++)
    {
        double in = j * width, out = (j + 1) * width * (1 + 0x1p-40), phi2 = 1 - b->ckc * out,
               base = b->round * chosen(MASK(b->ckc < 0), 1 / (phi2 * sqrt(phi2)), 1 + 1.5 * (b->ckc * in));
        least[j] = (base + b->constant + horner(own, ALL_TERMS, in)) * (1 - 0x1p-20) -
                   horner(b->flat, ALL_TERMS, out) * (1 + 0x1p-20) - 0x1p-900;
    }
    while (rings < RINGS_OF_BEND && least[rings] > 0) rings++;
    double r2 = rings * width;
    return r2 < 0x1p400 ? r2 : 0; /* a NaN, without an edge: 0 */
}

/* The sag where a stretch may end (AN END): somewhat beyond the rim, or at the equator.  phi may be 0 there,
 * so the base is off by 2^-25 of itself. */
SGT_INLINE double sag_at_edge(const wavy *s, const convex *b)
{
    const double r2 = b->ckc * b->edge2 < 1 ? b->edge2 : s->domain2, phi = sqrt(larger(1 - b->ckc * r2, 0));
    return s->c * r2 / (1 + phi) * (1 + 0x1p-24) + r2 * horner(s->a, ALL_TERMS, r2);
}

SGT_INLINE convex convex_of(const wavy *s)
{
    convex b = {.sign = s->c != 0 ? copysign(1, s->c) : 0,
                .round = s->abs_c,
                .ckc = s->ck * s->c,
                .abs_ck = s->abs_ck,
                .edge2 = s->domain2 * (1 + 0x1p-20),
                .bowl = s->c + 2 * s->a[0],
                .ck_lo = sgt_fma(s->k1, s->c, -s->ck) + two_sum(1, s->k).lo * s->c,
                .everywhere = true};
    for (int i = 0; i < ALL_TERMS && b.sign == 0; i++)
        if (s->a[i] != 0) b.sign = copysign(1, s->a[i]);
    for (int i = 0; i < ALL_TERMS; i++) {
        b.flat[i] = larger(-b.sign * s->a[i], 0) * ((2 * i + 2) * (2 * i + 1));
        b.everywhere = b.everywhere && !(b.flat[i] > 0);
    }
    b.constant = 2 * larger(b.sign * s->a[0], 0);
    b.edge = sqrt(b.edge2);
    b.bent2 = bent_by_rings(s, &b);
    b.whole = b.bent2 > b.edge2;
    const double most2 = b.ckc > 0 ? (1 - 0x1p-9) / b.ckc : HUGE_VAL; /* at the equator S ends */
    b.bent2 = smaller(b.bent2, most2);
    if (b.edge2 < HUGE_VAL) {
        b.high = wavy_ahead(s, ALL_TERMS, b.edge2, -1), b.low = wavy_ahead(s, ALL_TERMS, b.edge2, 1);
        if (b.whole) { /* HEIGHTS */
            double most = b.sign * sag_at_edge(s, &b) + 0x1p-30 * (b.high + b.low);
            b.high = b.sign > 0 ? smaller(most, b.high) : 0, b.low = b.sign < 0 ? smaller(most, b.low) : 0;
        }
    } else {
        bool rises = s->c > 0, falls = s->c < 0;
        for (int i = 0; i < ALL_TERMS; i++) rises = rises || s->a[i] > 0, falls = falls || s->a[i] < 0;
        b.high = rises ? HUGE_VAL : 0, b.low = falls ? HUGE_VAL : 0;
    }
    return b;
}

/* Is sigma S'' >= 0 for r^2 <= r2? */
SGT_INLINE mask is_convex(const convex *b, int terms, double r2)
{
    double phi2 = 1 - b->ckc * r2, round = b->round / chosen(MASK(b->ckc < 0), phi2 * sqrt(phi2), 1);
    return MASK(r2 <= b->bent2) |
           (MASK(phi2 > 0x1p-10) & MASK(r2 < 0x1p400) &
            (MASK(b->everywhere) | MASK((round + b->constant) * (1 - 0x1p-20) >
                                        horner(b->flat, terms, r2) * (1 + 0x1p-20) + 0x1p-900)));
}

/* The local origin, and its r^2. */
typedef struct side_local {
    double x, y, z, rho0;
} side_local;

/* A stretch before a root, made shorter.  from: where it begins, at (x + from l, y + from m, z + from n).
 * r2: of the larger r of its ends.  off: there F has the sign of -n for certain, and so all the way before.
 * */
typedef struct side_way {
    double from, r2;
    mask off;
} side_way;

/* Within r <= R the surface is ahead of the vertex plane by h = wavy_ahead(R^2) at most.  So a ray that
 * begins beyond that height meets nothing before it comes down to it.  There it is nearer to the axis,
 * mostly, and h is less: from afar a few rounds lead to where the surface is. */
SGT_INLINE side_way comes_near(const wavy *s, int terms, side_way way, double root2, const side_local *q,
                               const sgt_ray *ray)
{
    const double l = ray->d.x, m = ray->d.y, n = ray->d.z;
    double side = copysign(1, n),
           h = wavy_ahead(s, terms, way.r2, side) * (1 + 0x1p-10) + 0x1p-30 * fabs(q->z),
           at = (-h - side * q->z) / fabs(n), r2 = wavy_r2(q->x, q->y, at, l, m);
    mask off = MASK(h < HUGE_VAL) & MASK(at > way.from) & MASK(r2 <= way.r2);
    return (side_way){chosen(off, at, way.from), chosen(off, larger(r2, root2), way.r2), way.off | off};
}

/* A root that easy.h has met at t0 + tau.  (x0, y0): on the vertex plane, as there.  inverse: 1 / G'. */
typedef struct bent_root {
    double t0, x0, y0, tau, inverse;
} bent_root;

/* Where the stretch before it begins.  r2: of the larger r of its ends.  known: the stretch is. */
typedef struct bent_start {
    double from, r2;
    mask known;
} bent_start;

SGT_INLINE bent_start bent_start_of(const convex *b, const bent_root *r, const sgt_ray *ray)
{
    const double t0 = r->t0, x0 = r->x0, y0 = r->y0, tau = r->tau;
    const double tmin = ray->tmin, l = ray->d.x, m = ray->d.y;
    double a = l * l + m * m, across = x0 * m - y0 * l, disc = a * b->edge2 - across * across, by = 1 / a,
           enters = -(x0 * l + y0 * m) * by - sqrt(larger(disc, 0)) * by, t = t0 + tau,
           starts = tmin - t0 - 0x1p-50 * (fabs(tmin) + fabs(t0)),
           from = chosen(MASK(enters > starts), enters, starts);
    mask known = MASK(disc > 0) & MASK(fabs(from) < HUGE_VAL) & MASK(t - tmin > 0x1p-20 * fabs(t)) &
                 MASK(fabs(x0) + fabs(y0) <= 0x1p16 * b->edge) & MASK(from < tau);
    return (bent_start){from, larger(wavy_r2(x0, y0, from, l, m), wavy_r2(x0, y0, tau, l, m)), known};
}

/* Is that root the first one of the stretch, since F is monotone or bent in one way up to it?  inverse: 1 /
 * G' at the root. */
SGT_INLINE mask bent_is_first(const wavy *s, const convex *b, int terms, const side_way *way, double inverse,
                              const sgt_ray *ray)
{
    const double l = ray->d.x, m = ray->d.y, n = ray->d.z;
    mask rises = MASK(b->sign * inverse > 0), falls = MASK(b->sign * inverse < 0),
         above = way->off & MASK(b->sign * n < 0);
    return MASK(n * n > wavy_slope2(s, terms, way->r2) * (l * l + m * m)) |
           (is_convex(b, terms, way->r2) & (rises | (falls & above)));
}

/* Both, for a single ray.  The stretch is made shorter `rounds` times. */
SGT_INLINE mask first_of_bent(const wavy *s, const convex *b, int terms, int rounds, const bent_root *r,
                              const sgt_ray *ray)
{
    const side_local q = {r->x0, r->y0, 0, 0};
    const double l = ray->d.x, m = ray->d.y;
    bent_start at = bent_start_of(b, r, ray);
    side_way way = {at.from, at.r2, 0};
    for (int i = 0; i < rounds; i++)
        way = comes_near(s, terms, way, wavy_r2(r->x0, r->y0, r->tau, l, m), &q, ray);
    return at.known & bent_is_first(s, b, terms, &way, r->inverse, ray);
}

/* The sign of sigma F at the end of a stretch: certainly positive, certainly negative, or neither.  close:
 * it may be on the surface by the rule of the start (half of which is 16 u of the terms, and e is u of them
 * at least). */
typedef struct side_end {
    double r2;
    mask above, below, close;
} side_end;

/* The error of G, over u. */
SGT_INLINE double side_noise(const wavy *s, const side_local *q, double rho, double z, double first, double g,
                             double w, double ckw)
{
    double Q = sgt_fma(6, rho, q->rho0), aw = fabs(w), ackw = fabs(ckw);
    return sgt_fma(fabs(1 - ckw), sgt_fma(first, Q, fabs(z) + fabs(q->z) + aw),
                   sgt_fma(0.5 * s->abs_c, Q, sgt_fma(3 * aw, ackw, fabs(g))));
}

/* Is sigma F > 0 at tau, as all of the surface is on the other side of the ray there? */
SGT_INLINE mask past_heights(const convex *b, const side_local *q, double tau, const sgt_ray *ray)
{
    double z = sgt_fma(tau, ray->d.z, q->z), unsure = 0x1p-30 * (fabs(q->z) + fabs(z));
    return (MASK(b->sign > 0) & MASK(z - unsure > b->high)) |
           (MASK(b->sign < 0) & MASK(z + unsure < -b->low));
}

SGT_INLINE side_end side_end_at(const wavy *s, const convex *b, int terms, const side_local *q, double tau,
                                const sgt_ray *ray)
{
    const double l = ray->d.x, m = ray->d.y, n = ray->d.z;
    double x = sgt_fma(tau, l, q->x), y = sgt_fma(tau, m, q->y), z = sgt_fma(tau, n, q->z),
           rho = x * x + y * y, w, ckw;
    double g = wavy_g(s, rho, z, horner(s->a, terms, rho), &w, &ckw), first = horner(s->size, terms, rho),
           e = sgt_fma(1.01 * SGT_U, side_noise(s, q, rho, z, first, g, w, ckw), 0x1p-1000), up = b->sign * g;
    mask known = MASK(fabs(ckw) < 1 - 0x1p-8) & MASK(b->ckc * rho < 1 - 0x1p-10) & MASK(e < s->most_e);
    return (side_end){rho * (1 + 0x1p-10), known & MASK(up > e), known & MASK(up < -e),
                      MASK(fabs(g) <= 64 * e)};
}

/* A step of Newton on G, and what the bound needs of it.  It is the last if it is short (side_ready). */
SGT_INLINE wavy_newton side_step(const wavy *s, int terms, const side_local *q, double tau,
                                 const sgt_ray *ray)
{
    const double l = ray->d.x, m = ray->d.y, n = ray->d.z;
    double x = sgt_fma(tau, l, q->x), y = sgt_fma(tau, m, q->y), z = sgt_fma(tau, n, q->z),
           rho = x * x + y * y, w, ckw, xl = x * l, ym = y * m, half = xl + ym;
    double dh, h = horner_slope(s->a, terms, rho, &dh), dp = sgt_fma(rho, dh, h);
    double g = wavy_g(s, rho, z, h, &w, &ckw), dw = sgt_fma(-(dp + dp), half, n);
    double slope = sgt_fma(-s->c, half, (1 - ckw) * dw), inverse = 1 / slope, step = g * inverse;
    return (wavy_newton){tau - step, step, inverse, dw, fabs(xl) + fabs(ym), g, slope, tau};
}

/* The same step, toward the root at which the slope has the sign of `wanted`: with G'' of the conic, -A, a
 * quadratic equation.  Newton's steps alone take ten where two roots are near each other, or end at the
 * other. */
SGT_INLINE wavy_newton side_turned(const wavy_newton *h, double tau, double A, double wanted)
{
    mask flat = MASK(A == 0), direct = MASK(h->slope * wanted > 0) | flat;
    double root = chosen(flat, h->slope,
                         copysign(sqrt(larger(sgt_fma(2 * A, h->g, h->slope * h->slope), 0)), wanted)),
           step = chosen(direct, 2 * h->g, root - h->slope) / chosen(direct, h->slope + root, A);
    return (wavy_newton){tau - step, step, h->inverse, h->dw, h->slant, h->g, h->slope, tau};
}

/* G'' of the conic of curvature c + 2 a[0], over -1. */
SGT_INLINE double side_bend(const wavy *s, const convex *b, const sgt_ray *ray)
{
    const double l = ray->d.x, m = ray->d.y, n = ray->d.z;
    return sgt_fma(b->bowl, l * l + m * m, s->ck * (n * n));
}

/* The bound squares a step.  What is left after it is then below an ulp, unless the root is flat. */
SGT_INLINE mask side_ready(const wavy_newton *step, double tau)
{
    return ~MASK(fabs(step->step2) > 0x1p-22 * (fabs(tau) + fabs(step->tau2)));
}

/* How far the slope 1 / ai may be off, over itself: 2^-37 of its terms (THE BOUND), twice. */
SGT_INLINE double slope_off(double terms, double ai) { return larger(0x1p-30, 0x1p-36 * (terms * ai)); }

/* As wavy_bound.  rough: the bound on tau where the root is certain, off as there.  blunt: the root is
 * certain, but t is not sharp (SHARP). */
typedef struct side_round {
    wavy_round at;
    double rough, off;
    mask blunt;
} side_round;

SGT_INLINE side_round side_bound(const wavy *s, int terms, const side_local *q, double t0,
                                 const wavy_newton *at, const sgt_ray *ray, double t_tol)
{
    const double l = ray->d.x, m = ray->d.y, n = ray->d.z;
    double x = sgt_fma(at->tau2, l, q->x), y = sgt_fma(at->tau2, m, q->y), z = sgt_fma(at->tau2, n, q->z),
           rho = x * x + y * y, w, ckw;
    double g = wavy_g(s, rho, z, horner(s->a, terms, rho), &w, &ckw), step = g * at->inverse, as = fabs(step),
           ai = fabs(at->inverse), aw = fabs(w), az = fabs(z), a = l * l + m * m;
    double H = sgt_fma(0x1p-50, fabs(t0), sgt_fma(0x1p-40, fabs(at->tau2), fabs(at->step2) + (as + as))),
           wide = sgt_fma(17 * a, H * H, 1.0625 * rho), first = horner(s->size, terms, wide);
    double W1 = sgt_fma(first + first, sgt_fma(a, H + H, at->slant), fabs(n)), W2 = s->bend * (a * first);
    double M = sgt_fma(s->abs_ck, sgt_fma(sgt_fma(W1, H, aw), W2, W1 * W1), sgt_fma(s->abs_c, a, W2));
    double terms_of_slope = sgt_fma(larger(2, 1 - ckw), W1, s->abs_c * at->slant),
           off = sgt_fma(M * (H + H), ai, slope_off(terms_of_slope, ai)); /* Delta / |s| */
    double e = 1.01 * SGT_U * side_noise(s, q, rho, z, first, g, w, ckw), noise = e * ai,
           tau = at->tau2 - step, t = fabs(t0 + tau);
    double tau_err =
        sgt_fma(1.16, sgt_fma(as, off, noise), sgt_fma(SGT_U, fabs(tau) + (as + as), 0x1p-1000 * ai));
    mask known = MASK(off <= 0.125) & MASK(2 * (as + noise) <= H) & MASK(ckw < 1 - 0x1p-8) &
                 MASK(e < s->most_e * larger(1, 0x1p8 * ((1 - ckw) * (1 - ckw)))) &
                 MASK(s->abs_ck * (W1 * H) < 0x1p-10) & MASK(rho > 0x1p-400) & MASK(rho < 0x1p400),
         sure = known & MASK(q->rho0 <= 4 * rho) & MASK(fabs(q->z) <= 2 * az) &
                MASK(sgt_fma(1.01 * SGT_U, t, tau_err) <= larger(40 * SGT_U * t, t_tol));
    sure &= MASK(e <= 24 * SGT_U * (aw + az)) |
            (MASK(noise <= s->enough * t) & MASK(e * e <= 16 * SGT_U * SGT_U * rho));
    sure &= MASK(8 * (as * off) <= noise) | MASK(tau_err <= 0.5 * t_tol);
    wavy_round end = {.tau = tau,
                      .tau_err = chosen(sure, tau_err, (double)NAN),
                      .v = sgt_fma(s->ck, step * at->dw, 1 - ckw),
                      .near = sgt_fma(ai, sgt_fma(rho, first + (first + s->abs_c), az), fabs(tau)),
                      .g = g,
                      .again = MASK(false)};
    return (side_round){end, tau_err, off, known & ~sure};
}

/* What is known of a ray before a root is looked for.  t0, q: the local origin.  from, to: the stretch.
 * away: it certainly misses.  chord: the stretch is known.  r2: where it begins.  afar: it is to be made
 * shorter (side_way_of).  That is left where S is convex as far out, and z is of no great height: there F
 * tells the sign at the beginning. */
typedef struct side_stretch {
    side_local q;
    double t0, from, to, r2;
    mask away, chord, afar;
} side_stretch;

SGT_INLINE side_stretch side_stretch_of(const convex *b, const sgt_ray *ray)
{
    const double ox = ray->o.x, oy = ray->o.y, oz = ray->o.z, l = ray->d.x, m = ray->d.y, n = ray->d.z,
                 tmin = ray->tmin, tmax = ray->tmax;
    double a = l * l + m * m, d2 = a + n * n, t0 = -(ox * l + oy * m + oz * n) / d2, side = fabs(l) + fabs(m);
    side_local q = {moved_along(ox, t0, l), moved_along(oy, t0, m), moved_along(oz, t0, n), 0};
    q.rho0 = q.x * q.x + q.y * q.y;
    double across = q.x * m - q.y * l, beside = fabs(q.x) + fabs(q.y), disc = a * b->edge2 - across * across,
           by = 1 / a, half = sqrt(larger(disc, 0)) * by, centre = -(q.x * l + q.y * m) * by;
    double starts = tmin - t0 - 0x1p-50 * (fabs(tmin) + fabs(t0)),
           ends = tmax - t0 + 0x1p-50 * (fabs(tmax) + fabs(t0)), enters = centre - half,
           leaves = centre + half;
    double from = chosen(MASK(enters > starts), enters, starts),
           past = (chosen(MASK(n > 0), b->high, b->low) * (1 + 0x1p-20) + 0x1p-28 * fabs(q.z) + 0x1p-900 -
                   copysign(1, n) * q.z) /
                  fabs(n),
           end = chosen(MASK(leaves < ends), leaves, ends),
           to = chosen(MASK(past < end) & MASK(past > from), past, end), z1 = sgt_fma(from, n, q.z),
           z2 = sgt_fma(to, n, q.z),
           unsure = 0x1p-30 * (fabs(q.z) + smaller(fabs(z1), fabs(z2))); /* one end may be infinite */
    mask usual = MASK(a > 0x1p-60 * d2) & MASK(fabs(t0) < 0x1p300) & MASK(tmin <= tmax) &
                 MASK(tmin < HUGE_VAL) & MASK(tmax > -HUGE_VAL) & MASK(beside < 0x1p400);
    mask chord = usual & MASK(disc > 0) & MASK(beside <= 0x1p16 * b->edge);
    mask away = usual & MASK(fabs(across) > sqrt(a) * b->edge * (1 + 0x1p-20) + 0x1p-48 * beside * side);
    away |= chord & (MASK(from > to) | MASK(smaller(z1, z2) - unsure > b->high) |
                     MASK(larger(z1, z2) + unsure < -b->low));
    double r2 = wavy_r2(q.x, q.y, from, l, m);
    return (side_stretch){q,    t0,   from,  to,
                          r2,   away, chord, MASK(z1 * n <= 0) & (MASK(r2 > b->bent2) |
                                                                  MASK(b->abs_ck * fabs(z1) > 0.5))};
}

/* The stretch made shorter at its beginning, if it is afar. */
SGT_INLINE side_way side_way_of(const wavy *s, int terms, const side_stretch *of, const sgt_ray *ray)
{
    side_way way = {of->from, of->r2, 0};
    if (!of->afar) return way;
    way = comes_near(s, terms, way, 0, &of->q, ray);
    return comes_near(s, terms, way, 0, &of->q, ray);
}

/* Does sigma F rise or fall where a ray starts on the surface?  Neither: it is not known to start there. */
typedef struct side_on {
    mask rises, falls;
} side_on;

SGT_INLINE side_on side_on_of(const wavy *s, const convex *b, int terms, const sgt_ray *ray)
{
    const double ox = ray->o.x, oy = ray->o.y, oz = ray->o.z, l = ray->d.x, m = ray->d.y, n = ray->d.z,
                 tmin = ray->tmin;
    side_local q = {ox, oy, oz, ox * ox + oy * oy};
    wavy_newton at = side_step(s, terms, &q, 0, ray);
    double a = l * l + m * m, rho = q.rho0, dp = horner(s->slope, terms, rho), w, ckw,
           g = wavy_g(s, rho, oz, horner(s->a, terms, rho), &w, &ckw), ai = fabs(at.inverse), v = 1 - ckw;
    double e = sgt_fma(1.01 * SGT_U,
                       side_noise(s, &q, rho, oz, horner(s->size, terms, rho), g, w, ckw), 0x1p-1000),
           near = (fabs(g) + e) * ai, H = 4 * near,
           first = horner(s->size, terms, sgt_fma(17 * a, H * H, 1.0625 * rho));
    double W1 = sgt_fma(first + first, sgt_fma(a, H + H, at.slant), fabs(n)), W2 = s->bend * (a * first),
           M = sgt_fma(s->abs_ck, sgt_fma(sgt_fma(W1, H, fabs(w)), W2, W1 * W1), sgt_fma(s->abs_c, a, W2)),
           width = 0.5 * START_ULPS * (v * sgt_fma(fabs(s->c / v + (dp + dp)), rho, fabs(oz))) * ai;
    mask on = MASK(tmin == 0) & MASK(2 * near <= width) &
              MASK(sgt_fma(M * (H + H), ai, slope_off(sgt_fma(2, W1, s->abs_c * at.slant), ai)) <= 0.125) &
              MASK(fabs(ckw) < 1 - 0x1p-8) & MASK(e < s->most_e) & MASK(s->abs_ck * (W1 * H) < 0x1p-10) &
              MASK(rho > 0x1p-400) & MASK(rho < 0x1p400) & MASK(b->ckc * rho < 1 - 0x1p-10) &
              MASK(rho <= s->domain2);
    return (side_on){on & MASK(b->sign * at.inverse > 0), on & MASK(b->sign * at.inverse < 0)};
}

/* What is asked of a ray: the local origin, the stretch from `way` on to `to`, if it is known (chord), and
 * what is known of its start. */
typedef struct side_question {
    side_local q;
    side_way way;
    double to;
    mask chord;
    side_on on;
} side_question;

/* The ends of the stretch, and where Newton's steps begin.  above: sigma F > 0 at the beginning, so a root at
 * which it falls is wanted.  below: it is < 0 there, so one at which it rises is.  Neither: no root is looked
 * for.  Both are 0 for a ray that misses, as `away` tells.  close: the ray may start on the surface, so that
 * `on` has to be known.  Near the seed either of two roots may be the answer:
 * it is the one near the vertex plane, as of a conic (conic/side.h), of curvature c + 2 a[0]. */
typedef struct side_seed {
    double tau;
    mask above, below, away, close;
} side_seed;

SGT_INLINE side_seed side_seed_of(const wavy *s, const convex *b, int terms, bool first,
                                  const side_question *ask, const sgt_ray *ray)
{
    const double l = ray->d.x, m = ray->d.y, n = ray->d.z;
    const side_local *q = &ask->q;
    const side_on on = ask->on;
    const double from = ask->way.from, to = ask->to;
    mask chord = ask->chord;
    side_end begin = side_end_at(s, b, terms, q, from, ray), end = side_end_at(s, b, terms, q, to, ray);
    begin.above |= ask->way.off & MASK(b->sign * n < 0), begin.below |= ask->way.off & MASK(b->sign * n > 0);
    end.above |= past_heights(b, q, to, ray);
    begin.above = (begin.above & ~on.falls) | on.rises, begin.below &= ~(on.rises | on.falls);
    double both = larger(ask->way.r2, end.r2), half = q->x * l + q->y * m;
    mask bent = is_convex(b, terms, both),
         away = chord & ((begin.above & end.above & bent) | (on.falls & (bent | MASK(b->whole))));
    double A = side_bend(s, b, ray), B = n - sgt_fma(b->bowl, half, s->ck * q->z * n),
           C = sgt_fma(b->bowl, q->rho0, s->ck * q->z * q->z - 2 * q->z), D = sgt_fma(B, B, -A * C),
           sum = B + copysign(sqrt(larger(D, 0)), B);
    mask above = begin.above, below = begin.below;
    if (!first) { /* is the later of two roots the one near the vertex plane? */
        double at = q->z / n, slope = sgt_fma(A, at, B);
        mask later = below & ~(end.above & bent) & MASK(A * slope < 0);
        above |= later, below &= ~later;
        chord &= MASK(b->edge2 < HUGE_VAL) & MASK(fabs(slope) > 0x1p-20 * (fabs(A * at) + fabs(B)));
    }
    mask sign = MASK(b->sign * B > 0), one = (sign & below) | ~(sign | below);
    double tau = chosen(one, C, sum) / chosen(one, sum, A);
    tau = chosen(MASK(A == 0) & ~one, chosen(below, from, to), tau); /* no matter which zero */
    tau = chosen(MASK(tau > from), tau, from), tau = chosen(MASK(tau < to), tau, to);
    chord &= ~away;
    return (side_seed){tau, chord & above, chord & below, away, chord & begin.close & ~ask->way.off};
}

/* ANEW.  For other points z is computed from x and y, as `snap` of sag/sag.h does it, with r^2 in twice the
 * precision and where phi > 1/2.  P is off by 3 u of r^2 times the sum of (i + 1) |a[i]| r^(2 i).  The point
 * moves along z by the slope times how far x and y are off. */

/* The root from side_bound.  t0: of the local origin; r2 of the way; above, below as in a side_seed; inverse:
 * 1 / G' at the root. */
typedef struct side_found {
    double t0, r2, inverse;
    mask above, below;
} side_found;

/* What is known of it: t0, and is it certainly the one that is asked for? */
typedef struct side_known {
    double t0;
    mask known;
} side_known;

SGT_INLINE lane side_lane_if(const wavy *s, int terms, bool anew, const side_local *q, const wavy_round *at,
                             side_known is, const sgt_ray *ray, double t_tol)
{
    const double l = ray->d.x, m = ray->d.y, n = ray->d.z;
    double t = is.t0 + at->tau;
    near_root r = {.x = q->x,
                   .y = q->y,
                   .tau = at->tau,
                   .t = t,
                   .t_err = sgt_fma(1.01 * SGT_U, fabs(t), at->tau_err),
                   .tau_err = at->tau_err,
                   .t0 = is.t0,
                   .small = at->tau};
    double px = sgt_fma(at->tau, l, q->x), py = sgt_fma(at->tau, m, q->y), rho = px * px + py * py,
           dp = horner(s->slope, terms, rho), g = -s->c / at->v - (dp + dp), pz = sgt_fma(at->tau, n, q->z),
           steep2 = g * (g * rho), inherited = fabs(g) * (rho + (fabs(px * q->x) + fabs(py * q->y)));
    mask place = MASK(steep2 < 0x1p40) &
                 (MASK(inherited <= 12 * fabs(pz)) |
                  (MASK(steep2 > 8) & MASK(inherited * inherited <= 16 * (pz * pz) * (1 + steep2))));
    double off = 0;
    if (anew) {
        const twofold r2 = square_radius(px, py);
        double phi2 = 1 - s->ck * s->c * r2.hi, phi = sqrt(phi2), base = s->c * r2.hi / (1 + phi);
        pz = sgt_fma(r2.hi, horner(s->a, terms, r2.hi), base) + sgt_fma(0.5 * s->c, 1 / phi, dp) * r2.lo;
        place = MASK(steep2 <= STEEP2) & MASK(phi2 > 0.25);
        off = SGT_U * sgt_fma(24, fabs(base), sgt_fma(4 * r2.hi, horner(s->size, terms, r2.hi), fabs(pz)));
    }
    lane e = lane_of(&r, ray, t_tol, &(lane_end){pz, g, at->near}, s->rim2, MASK(false),
                     is.known & MASK(fabs(t) < 0x1p300) & place);
    e.p_err += 2.1 * SGT_U * fabs(q->z);
    if (anew) e.p_err = sgt_fma(e.p_err * (1 + 0x1p-20), 1 + (fabs(e.nx) + fabs(e.ny)), off);
    return e;
}

SGT_INLINE lane side_lane_at(const wavy *s, const convex *b, int terms, bool anew, const side_local *q,
                             const side_found *found, const wavy_round *at, const sgt_ray *ray, double t_tol)
{
    double px = sgt_fma(at->tau, ray->d.x, q->x), py = sgt_fma(at->tau, ray->d.y, q->y),
           rho = px * px + py * py, rises = b->sign * found->inverse;
    mask known = ((found->below & MASK(rises > 0)) | (found->above & MASK(rises < 0))) &
                 (MASK(b->whole) | is_convex(b, terms, larger(found->r2, rho * (1 + 0x1p-10))));
    return side_lane_if(s, terms, anew, q, at, (side_known){found->t0, known}, ray, t_tol);
}

SGT_INLINE lane side_lane(const wavy *s, const convex *b, int terms, const side_local *q,
                          const side_found *found, const wavy_round *at, const sgt_ray *ray, double t_tol)
{
    return side_lane_at(s, b, terms, false, q, found, at, ray, t_tol);
}

/* P / rho at rho by Horner's rule, with what its products and sums lose (Graillat, Langlois, Louvet 2009,
 * Japan J. Indust. Appl. Math. 26, 191). */
SGT_INLINE twofold horner_long(const double *a, int terms, double rho)
{
    twofold h = {a[terms - 1], 0};
    UNROLLED
    for (int i = terms - 2; i >= 0; i--) {
        twofold p = two_product(h.hi, rho), s = two_sum(p.hi, a[i]);
        h = (twofold){s.hi, sgt_fma(h.lo, rho, p.lo + s.lo)};
    }
    return h;
}

/* SHARP.  A blunt root: G once more, at the double nearest to the root as far as it is known.  It is at t0,
 * the point there is q, and the root beside it is what side_lane takes. */
typedef struct side_sharper {
    side_local q;
    double t0;
    wavy_round root;
} side_sharper;

SGT_INLINE side_sharper side_sharp(const wavy *s, const convex *b, int terms, double t0, double inverse,
                                   const side_round *end, const sgt_ray *ray, double t_tol)
{
    const double l = ray->d.x, m = ray->d.y, n = ray->d.z, at = t0 + end->at.tau;
    twofold X = place_of_root(ray->o.x, at, l), Y = place_of_root(ray->o.y, at, m),
            Z = place_of_root(ray->o.z, at, n), xx = two_product(X.hi, X.hi), yy = two_product(Y.hi, Y.hi),
            r2 = two_sum(xx.hi, yy.hi), h = horner_long(s->a, terms, r2.hi);
    double rho = r2.hi, rho_lo = r2.lo + (sgt_fma(2 * X.hi, X.lo, xx.lo) + sgt_fma(2 * Y.hi, Y.lo, yy.lo)),
           dp = horner(s->slope, terms, rho), first = horner(s->size, terms, rho);
    twofold p = two_product(-rho, h.hi), w = two_sum(Z.hi, p.hi), round = two_product(s->c, rho),
            ww = two_product(w.hi, w.hi), cww = two_product(s->ck, ww.hi), bent = two_sum(round.hi, cww.hi),
            g2 = two_sum(w.hi, -0.5 * bent.hi);
    double w_lo = w.lo + (Z.lo + sgt_fma(-dp, rho_lo, sgt_fma(-rho, h.lo, p.lo))),
           lo = bent.lo + (sgt_fma(s->c, rho_lo, round.lo) +
                           sgt_fma(s->ck, sgt_fma(2 * w.hi, w_lo, ww.lo), sgt_fma(b->ck_lo, ww.hi, cww.lo))),
           g = g2.hi + (g2.lo + (w_lo - 0.5 * lo)), ckw = s->ck * w.hi, ai = fabs(inverse);
    const side_local q = {X.hi, Y.hi, Z.hi, rho};
    double noise = 0x1p-94 * side_noise(s, &q, rho, Z.hi, first, g, w.hi, ckw), tau = -g * inverse,
           size = fabs(tau),
           tau_err =
               sgt_fma(1.16, sgt_fma(size, end->off, noise * ai), sgt_fma(4 * SGT_U, size, 0x1p-1000 * ai));
    double x = sgt_fma(tau, l, X.hi), y = sgt_fma(tau, m, Y.hi), z = fabs(sgt_fma(tau, n, Z.hi)),
           dw = sgt_fma(-(dp + dp), X.hi * l + Y.hi * m, n);
    mask near = MASK(rho <= 4 * (x * x + y * y)) & MASK(fabs(Z.hi) <= 2 * z) &
                (MASK(size * end->off <= 4 * SGT_U * ai * (fabs(w.hi) + z)) | MASK(tau_err <= 0.5 * t_tol)),
         same = near & end->blunt & MASK(size <= 2 * (end->rough + SGT_U * fabs(at))) & MASK(rho > 0x1p-400) &
                MASK(rho < 0x1p400);
    const wavy_round root = {.tau = tau,
                             .tau_err = chosen(same, tau_err, (double)NAN),
                             .v = sgt_fma(-s->ck, tau * dw, 1 - ckw), /* at the root */
                             .near = sgt_fma(ai, sgt_fma(rho, first + (first + s->abs_c), fabs(Z.hi)), size)};
    return (side_sharper){q, at, root};
}

/* GRAZING.  If the bound on the slope within the rim fails, and a ray that runs along meets the conic at less
 * than 14 degrees from it, or not at all, the rounds of easy.h mostly end in doubt: about t, or about which
 * root is the first.  The form from the side costs more than a round, but less than rounds that end in doubt.
 * So it is asked first where it answers nearly all such rays:
 * - the surface is bent in one way as far out as the start, or as far as it goes (graze_bent; graze.h has the
 *   first word), or
 * - the slope at the start is too great for wavy_first_from.
 * This is a choice between forms each of which is certain; a ray that the form from the side leaves makes the
 * rounds after all, alone.  A ray without a beginning is not among these (wavy_hopeless).
 *
 * graze_conic: the equation A t^2 - 2 B t + C of the conic of curvature c + 2 a[0], from o, and B^2 - A C,
 * the square of its slope.  From very far away that says little. */
typedef struct graze_conic {
    double B, C, D;
} graze_conic;

SGT_INLINE graze_conic graze_conic_of(const wavy *s, const convex *b, const sgt_ray *ray)
{
    const double x = ray->o.x, y = ray->o.y, z = ray->o.z, l = ray->d.x, m = ray->d.y, n = ray->d.z;
    double A = side_bend(s, b, ray), ckz = s->ck * z, B = n - sgt_fma(b->bowl, x * l + y * m, ckz * n),
           C = sgt_fma(b->bowl, x * x + y * y, sgt_fma(ckz, z, -2 * z));
    return (graze_conic){B, C, sgt_fma(B, B, -A * C)};
}

/* Does the ray run along, meet that conic at less than 14 degrees, and begin? */
SGT_INLINE mask graze_flat(const wavy *s, const graze_conic *q, const sgt_ray *ray)
{
    const double l = ray->d.x, m = ray->d.y, n = ray->d.z;
    return wavy_along(ray) & MASK(16 * q->D < (l * l + m * m) + n * n) & ~wavy_single(s, l, m, n) &
           MASK(ray->tmin > -HUGE_VAL);
}

SGT_INLINE mask graze_bent(const wavy *s, const convex *b, const graze_conic *q, const sgt_ray *ray)
{
    const double r2 = wavy_r2(ray->o.x, ray->o.y, ray->tmin, ray->d.x, ray->d.y);
    return graze_flat(s, q, ray) & MASK(smaller(r2, b->edge2) <= b->bent2);
}

SGT_INLINE mask grazes(const wavy *s, const convex *b, int terms, const sgt_ray *ray)
{
    const double l = ray->d.x, m = ray->d.y, n = ray->d.z, r2 = wavy_r2(ray->o.x, ray->o.y, ray->tmin, l, m);
    const graze_conic q = graze_conic_of(s, b, ray);
    return graze_bent(s, b, &q, ray) |
           (graze_flat(s, &q, ray) & MASK(!(n * n > wavy_slope2(s, terms, r2) * (l * l + m * m))));
}

/* The single ray, and a tile (asphere/side.c); no proof is asked for.  grazing: it grazes, and is asked first
 * here. */
easy_answer sgt_asphere_beside(const wavy *s, const shape *h, bool grazing, const sgt_ray *ray, lane *e,
                               tally *w);

/* Which rays of a tile with tmin = 0 start on the surface, and meet nothing else, by the slope within the rim
 * (asphere/unique.c)?  behind[i]: the sign of F right behind such a start; 0: it is not known to be one.
 * Returns true if all misses[i] are set. */
bool sgt_asphere_from_start(const wavy *v, int terms, const sgt_tile *tile, mask misses[], double behind[]);

/* Sets misses[i] of those that meet nothing else, by rings (LEAVING in asphere/unique.c). */
void sgt_asphere_past_rings(const shape *s, const sgt_tile *tile, mask misses[], const double behind[]);

/* The same where the surface is bent in one way as far as it goes (LEAVING A BOWL in asphere/side.c). */
void sgt_asphere_past_rim(const convex *b, const sgt_tile *tile, mask misses[], const double behind[]);

/* Meets those that are left, of such a surface.  Gives SGT_HIT to some. */
void sgt_asphere_left_bowl(const wavy *s, int terms, const convex *b, const sgt_tile *tile,
                           const mask misses[], const double behind[]);

/* Is it bent in one way as far as it goes? */
SGT_INLINE bool is_bowl(const convex *b) { return b->whole || b->everywhere; }

/* Which rays start on the surface, or in the vertex, and certainly meet nothing else?  By the cone
 * (asphere/unique.c).  leaves[i] stays as it is if that is so, otherwise it is set to 0.  hits and t_tol are
 * not read. */
void sgt_asphere_leave(const shape *s, const wavy *v, const sgt_tile *tile, mask leaves[]);

/* false: none of the rays starts there. */
bool sgt_asphere_may_start(const wavy *v, const sgt_tile *tile);

/* What has been tried with each ray of a tile.  begun: the rounds of easy.h had a start, or graze.h was asked
 * in vain.  ended: the rounds ended at a number.  some: graze.h may be asked for some rays.  all: all rays
 * graze, and t, asked are those of a graze_seed. */
typedef struct easy_tried {
    bool begun[SGT_TILE], ended[SGT_TILE], some, all;
    double t[SGT_TILE];
    mask asked[SGT_TILE];
} easy_tried;

/* Do all rays of a tile graze, by graze_bent or by the slope at the start?  If so, t and asked are set; the
 * caller sets `all`. */
bool sgt_asphere_lanes_graze(const wavy *s, const convex *b, int terms, const sgt_tile *tile,
                             easy_tried *tried);

/* Do all rays of a tile certainly pass by, beyond the edge or past the heights? */
bool sgt_asphere_lanes_past(const convex *b, const sgt_tile *tile);

/* Answers hard rays of a tile.  before: how many are hard.  Returns how many are left. */
size_t sgt_asphere_lanes_beside(const wavy *s, const shape *h, const convex *b, bool first,
                                const sgt_tile *tile, size_t before, easy_tried *tried);

#endif
