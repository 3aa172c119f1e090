// SPDX-License-Identifier: MIT
/* enclose.c - g and g' of a sag over a stretch of a ray, by intervals.
 *
 * g(t) = z - s(rho) - P(rho), with rho = x^2 + y^2, s = c rho / (1 + phi), phi^2 = 1 - (1 + k) c^2 rho, and
 * P the sum of a[i] rho^(i+1).  Let h = x dx + y dy (half of rho'), A = dx^2 + dy^2 and X = ox dy - oy dx.
 * Then A rho = h^2 + X^2, hence
 *     g' = dz - c h / phi - 2 P' h,
 *     -g'' / 2 = c (A - (1 + k) c^2 X^2) / (2 phi^3) + 2 P'' h^2 + A P'.
 * The bracket is A phi^2 at the point of the line nearest the axis.  So it is not negative if the line
 * meets the domain.  Hence c h / phi never falls along the ray: a conic is convex.  If c is negative, the
 * mirror image is solved: c, a, z and g with the other sign.
 *
 * t is counted from t0: what is given and enclosed is g(t0 + t).
 *
 * THE ENDS.  At one t all intervals are thin.  A coordinate o + t d is three doubles by error-free product
 * and sums, so a distant origin costs nothing.  rho, h, X and phi^2 are computed in twice the precision,
 * and only then rounded to an interval.  So g is known to two or three ulps of the largest of z, s and P,
 * and g' to a few ulps of its terms.
 *
 * BETWEEN THEM.  h and c h / phi never fall, and z is linear: their ranges are those of their ends.  If h
 * has one sign, rho has its extremes at the ends.  Else its least value is that of the whole line, X^2 / A.
 * s grows with rho, and phi is monotone in it.  P, P' and P'' are taken by Horner's rule on rho >= 0; that
 * is never wider than the sum of the ranges of its terms.  Over the whole stretch, w long, the following
 * hold:
 * - the natural forms of g and g', which are the formulas above (for a conic that of g' is exact);
 * - the tangents: g' differs from that of either end by at most g'' w, and g from that of either end by g'
 *   w;
 * - the chord: g lies between its ends, but for -g'' / 2 times 0 ... w^2 / 4 (linear interpolation omits
 *   g'' / 2 (t - lo) (t - hi));
 * - if g' has one sign, g lies between its ends.
 *
 * So their intersection holds too.  On long stretches the natural forms are the tightest.  On short ones
 * the others leave a width beyond the true range that falls with w^2.
 *
 * THE DOMAIN.  If phi^2 < 0 all over the stretch, g is undefined there, and both intervals are empty.  If
 * phi^2 may be 0 or less somewhere, g is that of the part where it is positive (s <= 1 / ((1 + k) c), rho
 * <= 1 / ((1 + k) c^2)).  The slope has its pole there, and nothing is said of it.
 *
 * RANGE.  d is scaled by a power of two to [1, 2).  Coordinates too small or too large for twice the
 * precision are made intervals at once.  What overflows becomes an end at infinity, and t may have such
 * ends. */
#include "../../num/expansion.h"
#include "poly.h"

#include <sagitta/interval.h>

enum { MOST_TERMS = 8 };

/* c >= 0, k and 1 + k, the scaled direction, A, and the coefficients of P, P' and P''. */
typedef struct scene {
    double c, k, scale;
    sgt_interval k1, l, m, n, a, p[MOST_TERMS], first[MOST_TERMS], second[MOST_TERMS];
    int terms;
} scene;

/* Functions of rho.  phi and s are for the part of phi^2 that is not negative. */
typedef struct interval_ring { sgt_interval rho, phi2, phi, sag; } interval_ring;

/* z, h, g and the functions of rho at one t. */
typedef struct interval_place { sgt_interval z, half, g; interval_ring at; } interval_place;

/* The operations of interval.h, for known signs and nonempty intervals.  A NaN at an end stays.  These are
 * functions even with hardware fma: inlined they would take 50 KB more and be no faster. */
static sgt_interval interval_plus(sgt_interval x, sgt_interval y)
{
    return sgt_interval_between(-sgt_sum_above(-x.lo, -y.lo), sgt_sum_above(x.hi, y.hi));
}

static sgt_interval interval_minus(sgt_interval x, sgt_interval y)
{
    return sgt_interval_between(-sgt_sum_above(-x.lo, y.hi), sgt_sum_above(x.hi, -y.lo));
}

SGT_INLINE sgt_interval hull(sgt_interval x, sgt_interval y)
{
    return sgt_interval_between(x.lo < y.lo ? x.lo : y.lo, larger(x.hi, y.hi));
}

/* x y, for y >= 0. */
static sgt_interval interval_times(sgt_interval x, sgt_interval y)
{
    return sgt_interval_between(-sgt_product_above(-x.lo, x.lo >= 0 ? y.lo : y.hi),
                                sgt_product_above(x.hi, x.hi >= 0 ? y.hi : y.lo));
}

SGT_INLINE sgt_interval scaled(sgt_interval x, double by) { return interval_times(x, sgt_interval_of(by)); }

/* x / y, for x >= 0 and y > 0. */
static sgt_interval interval_over(sgt_interval x, sgt_interval y)
{
    return sgt_interval_between(y.hi < HUGE_VAL ? -sgt_quotient_above(-x.lo, y.hi) : 0,
                                sgt_quotient_above(x.hi, y.lo));
}

/* x +- by, for moderate numbers. */
SGT_INLINE sgt_interval interval_rounded(twofold x, double by)
{
    return sgt_interval_between(-sgt_sum_above(-x.hi, by - x.lo), sgt_sum_above(x.hi, x.lo + by));
}

/* The sum of a[i] rho^i. */
SGT_INLINE sgt_interval series(int terms, const sgt_interval *a, sgt_interval rho)
{
    sgt_interval h = a[terms - 1];
    for (int i = terms - 2; i >= 0; i--) h = interval_plus(interval_times(h, rho), a[i]);
    return h;
}

/* o + (t0 + t) d as s + rest +- slip.  exact: the products have lost nothing.  If t0 = 0, it is s + f.lo
 * exactly: o + p = s + e, and f is e plus the rest of p.  f.lo, and rest in any case, is below 4 u^2 of the
 * sum. */
typedef struct triple { twofold s; double rest, slip; bool exact; } triple;

SGT_INLINE bool splits(double p, double t, double d)
{
    return (fabs(p) > 0x1p-960 && fabs(p) < 0x1p1000) || t == 0 || d == 0;
}

static triple triple_from(double o, double d, double t0, double t)
{
    expansion e = expansion_along(o, d, t0, t);
    twofold s = two_sum(e.part[0], e.part[1]);
    double slip = (fabs(e.part[3]) + fabs(e.part[4])) * (1 + 0x1p-40);
    bool fine = fabs(e.part[2]) + slip <= 4 * SGT_U * SGT_U * fabs(s.hi);
    return (triple){s, e.part[2], slip,
                    fine && splits(t0 * d, t0, d) && splits(t * d, t, d) && fabs(o) < 0x1p1000};
}

SGT_INLINE triple triple_of(double o, double d, double t0, double t)
{
    if (t0 != 0) return triple_from(o, d, t0, t);
    twofold p = d == 0 ? twofold_of(0) : two_product(t, d), s = two_sum(o, p.hi), f = two_sum(s.lo, p.lo);
    return (triple){two_sum(s.hi, f.hi), f.lo, 0, splits(p.hi, t, d) && fabs(o) < 0x1p1000};
}

SGT_INLINE sgt_interval range_of(const triple *x, double o, double d, double t0, double t)
{
    sgt_interval by = sgt_interval_of(d), from = sgt_interval_of(o), rest = sgt_interval_of(x->rest);
    if (x->slip > 0) rest = sgt_interval_about(x->rest, x->slip);
    if (x->exact)
        return sgt_interval_between(-sgt_sum_above(-x->s.hi, sgt_sum_above(-x->s.lo, -rest.lo)),
                                    sgt_sum_above(x->s.hi, sgt_sum_above(x->s.lo, rest.hi)));
    if (t0 != 0) from = sgt_interval_sum(from, sgt_interval_product(sgt_interval_of(t0), by));
    return sgt_interval_sum(from, sgt_interval_product(sgt_interval_of(t), by));
}

SGT_INLINE void phi2_of(const scene *f, interval_ring *e)
{
    sgt_interval c = sgt_interval_of(f->c);
    e->phi2 = interval_minus(sgt_interval_of(1),
                             interval_times(interval_times(f->k1, interval_times(e->rho, c)), c));
}

SGT_INLINE void sag_of(const scene *f, interval_ring *e)
{
    e->phi = sgt_interval_between(e->phi2.lo > 0 ? sgt_square_root_below(e->phi2.lo) : 0,
                                  e->phi2.hi < 0 ? 0 : sgt_square_root_above(e->phi2.hi));
    e->sag = interval_over(scaled(e->rho, f->c), interval_plus(sgt_interval_of(1), e->phi));
}

static interval_place place_at(const scene *f, sgt_vec3 o, sgt_vec3 d, double t0, double t)
{
    interval_place e;
    triple x = triple_of(o.x, d.x, t0, t), y = triple_of(o.y, d.y, t0, t), z = triple_of(o.z, d.z, t0, t);
    e.z = range_of(&z, o.z, d.z, t0, t);
    /* Errors: rho 2 * 4 + 5 + 3 = 16 u^2, the term subtracted from 1 32 u^2, h 12 u^2 of its terms.
     * Underflow adds less than 2^-170 of them. */
    twofold rho = twofold_sum(twofold_product(x.s, x.s), twofold_product(y.s, y.s)),
            xl = twofold_scaled(x.s, f->l.lo), ym = twofold_scaled(y.s, f->m.lo);
    double terms = fabs(xl.hi) + fabs(ym.hi);
    bool fine = x.exact && y.exact && rho.hi > 0x1p-800 && rho.hi < 0x1p1000;
    e.at.rho = interval_rounded(rho, 0x1p-101 * rho.hi);
    e.half = interval_rounded(twofold_sum(xl, ym), 0x1p-101 * terms);
    if (!fine || !(terms > 0x1p-800) || f->l.lo < f->l.hi || f->m.lo < f->m.hi) {
        sgt_interval rx = range_of(&x, o.x, d.x, t0, t), ry = range_of(&y, o.y, d.y, t0, t);
        e.half = sgt_interval_sum(sgt_interval_product(rx, f->l), sgt_interval_product(ry, f->m));
        if (!fine) e.at.rho = sgt_interval_sum(sgt_interval_square(rx), sgt_interval_square(ry));
    }
    twofold bent = twofold_scaled(twofold_product(twofold_scaled(rho, f->c), two_sum(1, f->k)), f->c),
            phi2 = twofold_difference(twofold_of(1), bent);
    if (fine && f->c < 0x1p600 && fabs(f->k) < 0x1p200 && fabs(bent.hi) < 0x1p900)
        e.at.phi2 = interval_rounded(phi2, 0x1p-100 * (1 + fabs(bent.hi)));
    else phi2_of(f, &e.at);
    sag_of(f, &e.at);
    e.g = interval_minus(e.z, e.at.sag);
    if (f->terms) e.g = interval_minus(e.g, interval_times(series(f->terms, f->p, e.at.rho), e.at.rho));
    return e;
}

/* 2 P' h. */
SGT_INLINE sgt_interval wave_of(const scene *f, sgt_interval rho, sgt_interval half)
{
    return f->terms ? scaled(sgt_interval_product(series(f->terms, f->first, rho), half), 2)
                    : sgt_interval_of(0);
}

/* |X| = |ox dy - oy dx|. */
SGT_INLINE sgt_interval cross_of(const scene *f, sgt_vec3 o)
{
    twofold cross = twofold_difference(two_product(o.x, f->m.lo), two_product(o.y, f->l.lo));
    double size = fabs(cross.hi);
    if (size > 0x1p-800 && size < 0x1p500 && f->l.lo == f->l.hi && f->m.lo == f->m.hi)
        return interval_rounded((twofold){size, cross.hi > 0 ? cross.lo : -cross.lo}, 0x1p-101 * size);
    return sgt_interval_absolute(sgt_interval_difference(sgt_interval_product(sgt_interval_of(o.x), f->m),
                                                         sgt_interval_product(sgt_interval_of(o.y), f->l)));
}

SGT_INLINE sgt_interval product_of(double a, double b)
{
    return sgt_interval_between(-sgt_product_above(-a, b), sgt_product_above(a, b));
}

static sgt_interval enclose(const scene *f, sgt_vec3 o, sgt_vec3 d, double t0, sgt_interval t,
                            sgt_interval *slope)
{
    interval_place a = place_at(f, o, d, t0, t.lo), b = t.lo < t.hi ? place_at(f, o, d, t0, t.hi) : a;
    sgt_interval half = {a.half.lo, b.half.hi}, z = hull(a.z, b.z), cross = cross_of(f, o);
    interval_ring all = half.lo >= 0 ? a.at : b.at; /* first at the least rho, then over the whole stretch */
    if (!(half.lo >= 0 || half.hi <= 0)) {
        all.rho = sgt_interval_of(larger(sgt_interval_quotient(sgt_interval_square(cross), f->a).lo, 0));
        phi2_of(f, &all);
        sag_of(f, &all);
    }
    all.rho.hi = larger(a.at.rho.hi, b.at.rho.hi);
    all.phi2 = hull(all.phi2, hull(a.at.phi2, b.at.phi2));
    all.phi = hull(all.phi, hull(a.at.phi, b.at.phi));
    all.sag.hi = larger(a.at.sag.hi, b.at.sag.hi);
    if (all.phi2.hi < 0) return *slope = sgt_interval_empty();
    bool whole = all.phi2.lo > 0;
    sgt_interval c = sgt_interval_of(f->c);
    if (!whole && f->k1.lo > 0) {
        sgt_interval edge = sgt_interval_quotient(sgt_interval_of(1), interval_times(f->k1, c)),
                     rim = sgt_interval_quotient(edge, c);
        all.sag.hi = edge.hi;
        if (rim.hi < all.rho.hi) all.rho.hi = rim.hi;
    }
    sgt_interval g = interval_minus(z, all.sag);
    if (f->terms) g = interval_minus(g, interval_times(series(f->terms, f->p, all.rho), all.rho));
    if (!whole) return g;

    sgt_interval from = interval_minus(f->n, interval_times(a.half, interval_over(c, a.at.phi))),
                 to = interval_minus(f->n, interval_times(b.half, interval_over(c, b.at.phi)));
    *slope = interval_minus(sgt_interval_between(to.lo, from.hi), wave_of(f, all.rho, half));
    if (t.lo < t.hi) {
        sgt_interval reach = {0, sgt_product_above(sgt_interval_width(t), 1 / f->scale)},
                     ends = hull(a.g, b.g);
        sgt_interval k = interval_minus(f->a,
                                        interval_times(f->k1, sgt_interval_square(interval_times(cross, c))));
        k.lo = larger(k.lo, 0);
        /* -g'' / 2 */
        sgt_interval bend = scaled(interval_over(interval_times(k, c), interval_times(all.phi2, all.phi)),
                                   0.5);
        if (f->terms) {
            bend = interval_plus(bend, interval_times(series(f->terms, f->first, all.rho), f->a));
            if (f->terms > 1)
                bend = interval_plus(bend, scaled(interval_times(series(f->terms - 1, f->second, all.rho),
                                                                 sgt_interval_square(half)),
                                                  2));
            from = interval_minus(from, wave_of(f, a.at.rho, a.half)),
            to = interval_minus(to, wave_of(f, b.at.rho, b.half));
            sgt_interval turn = scaled(interval_times(bend, reach), 2);
            *slope = sgt_interval_intersection(
                *slope, sgt_interval_intersection(interval_minus(from, turn), interval_plus(to, turn)));
        }
        if (!(slope->lo >= 0 || slope->hi <= 0)) {
            sgt_interval change = interval_times(*slope, reach);
            g = sgt_interval_intersection(
                g, sgt_interval_intersection(interval_plus(a.g, change), interval_minus(b.g, change)));
            ends = interval_plus(ends, scaled(interval_times(bend, interval_times(reach, reach)), 0.25));
        }
        g = sgt_interval_intersection(g, ends);
    } else g = a.g;
    *slope = sgt_interval_product(*slope, sgt_interval_of(1 / f->scale));
    return g;
}

sgt_interval sgt_sag_enclose(const shape *s, const sgt_ray *ray, double t0, sgt_interval t,
                             sgt_interval *slope)
{
    sgt_vec3 o = ray->o, d = ray->d;
    double sign = s->c < 0 ? -1 : 1, scale = scale_of(d);
    *slope = sgt_interval_all();
    if (isnan(t.lo) || isnan(t.hi) ||
        !((o.x - o.x) + (o.y - o.y) + (o.z - o.z) + (d.x - d.x) + (d.y - d.y) + (d.z - d.z) == 0))
        return *slope;
    if (t.lo > t.hi) return *slope = sgt_interval_empty();
    o.z *= sign, d.z *= sign;
    scene f = {.c = fabs(s->c), .k = s->k, .terms = s->terms, .scale = scale};
    f.k1 = sgt_interval_sum(sgt_interval_of(1), sgt_interval_of(s->k));
    f.l = product_of(d.x, scale), f.m = product_of(d.y, scale), f.n = product_of(d.z, scale);
    f.a = interval_plus(sgt_interval_square(f.l), sgt_interval_square(f.m));
    for (int i = 0; i < s->terms; i++) {
        f.p[i] = sgt_interval_of(sign * s->a[i]);
        f.first[i] = product_of(f.p[i].lo, i + 1);
        if (i) f.second[i - 1] = product_of(f.p[i].lo, (i + 1) * i);
    }
    sgt_interval g = enclose(&f, o, d, t0, t, slope);
    if (sign < 0) *slope = sgt_interval_negative(*slope);
    return sign < 0 ? sgt_interval_negative(g) : g;
}
