/* sag_enclose.c - g and g' of a sag over a stretch of a ray, by intervals.
 *
 * g(t) = z - s(rho) - P(rho), rho = x^2 + y^2, s = c rho / (1 + phi), phi^2 = 1 - (1 + k) c^2 rho, P the sum of
 * a[i] rho^(i+1).  With h = (x dx + y dy), half of rho', and A = dx^2 + dy^2:
 *     s' = c / (2 phi),   s'' = s' (1 + k) (c / phi)^2 / 2   (of rho),
 *     g'  = dz - 2 (s' + P') h,
 *     g'' = -2 s' (1 + k) (c h / phi)^2 - 4 P'' h^2 - 2 A (s' + P').
 *
 * THE ENDS.  At one t all of it is thin.  A coordinate o + t d is three doubles by error-free product and sums, so that
 * an origin far off costs nothing; rho and phi^2 come in twice the precision, and only then are rounded to an
 * interval.  g at the two ends of the stretch is so known to a few ulps of z, s and P.
 *
 * BETWEEN THEM.  h grows along the ray, so its range is that of its ends.  Where it has one sign rho has its extremes at the ends, else its
 * least is that of the whole line, (ox dy - oy dx)^2 / A.  s (its sign is that of c) grows with rho and phi goes one way, z is linear: the ranges
 * of all of these are those of their ends.  P, P' and P'' are Horner's form on rho >= 0, which is never wider than
 * the sum of its terms' ranges.  So there are, of g and g' over the whole stretch, w long,
 *     the natural forms: the formulas above;
 *     the chord: g is between its ends but for -g'' w^2 / 8 (what linear interpolation leaves out is g'' (t - lo) (t - hi) / 2);
 *     the tangents: g' is within g'' w of what it is at either end;
 *     and where g' has one sign, g is between its ends.
 * All hold, so their intersection does.  The first is what counts on long stretches, the others on short ones, where the width
 * beyond the true range falls with w^2.
 *
 * THE DOMAIN.  Where phi^2 < 0 all over the stretch, g is undefined there and both intervals are empty.  Where phi^2 may reach
 * 0 within it, g is that of the part where phi^2 >= 0 (|s| <= 1 / ((1 + k) |c|) and rho <= 1 / ((1 + k) c^2)), and the slope, which has a pole there, may
 * be anything.
 *
 * RANGE.  d is scaled by a power of two to [1, 2); of coordinates so small or so large that twice the precision does not
 * hold, intervals are made at once.  What overflows ends at infinity.  t may have infinite ends. */
#include "form.h"

#include <sagitta/interval.h>

enum { MOST_TERMS = 8 };

/* A sag and a ray: c, |c|, 1 + k, the scaled direction, a = l^2 + m^2, and the coefficients of P, P' and P'' / rho^0. */
typedef struct scene { sgt_interval c, size, k1, l, m, n, a, p[MOST_TERMS], first[MOST_TERMS], second[MOST_TERMS]; int terms; } scene;

/* What depends on rho alone: |s| and what it is made of. */
typedef struct ring { sgt_interval rho, phi2, sag; } ring;

/* One t; half is h for the scaled direction, slope dg/dtau. */
typedef struct place { sgt_interval x, y, z, half, g, slope; ring at; } place;

/* x y where y >= 0. */
SGT_INLINE sgt_interval times(sgt_interval x, sgt_interval y)
{
    return sgt_interval_between(-sgt_product_above(-x.lo, x.lo >= 0 ? y.lo : y.hi), sgt_product_above(x.hi, x.hi >= 0 ? y.hi : y.lo));
}

SGT_INLINE sgt_interval scaled(sgt_interval x, double by) { return times(x, sgt_interval_of(by)); }
SGT_INLINE sgt_interval twice(sgt_interval x) { return scaled(x, 2); }

/* x, off by at most by. */
SGT_INLINE sgt_interval rounded(twofold x, double by) { return sgt_interval_between(-sgt_sum_above(-x.hi, by - x.lo), sgt_sum_above(x.hi, x.lo + by)); }

/* The sum of a[i] rho^i. */
SGT_INLINE sgt_interval series(int terms, const sgt_interval *a, sgt_interval rho)
{
    if (terms < 1) return sgt_interval_of(0);
    sgt_interval h = a[terms - 1];
    for (int i = terms - 2; i >= 0; i--) h = sgt_interval_sum(times(h, rho), a[i]);
    return h;
}

/* o + t d: o + p is s + e, and e with the rest of p is f + r, so that it is s + f + r exactly.  As a twofold right to 4 u^2. */
SGT_INLINE twofold coordinate_at(double o, double d, double t, sgt_interval *x)
{
    twofold p = two_product(t, d), s = two_sum(o, p.hi), f = two_sum(s.lo, p.lo);
    double size = fabs(p.hi);
    s = two_sum(s.hi, f.hi);
    if ((size > 0x1p-960 && size < 0x1p1000 && fabs(o) < 0x1p1000) || t == 0 || d == 0)
        *x = sgt_interval_between(-sgt_sum_above(-s.hi, sgt_sum_above(-s.lo, -f.lo)), sgt_sum_above(s.hi, sgt_sum_above(s.lo, f.lo)));
    else
        *x = sgt_interval_sum(sgt_interval_of(o), sgt_interval_product(sgt_interval_of(t), sgt_interval_of(d)));
    return s;
}

/* phi^2, in intervals. */
SGT_INLINE sgt_interval phi2_of(const scene *f, sgt_interval rho)
{
    return sgt_interval_difference(sgt_interval_of(1), times(times(f->k1, times(f->size, rho)), f->size));
}

/* |s|; empty where phi^2 < 0. */
SGT_INLINE sgt_interval sag_of(const scene *f, sgt_interval rho, sgt_interval phi2)
{
    return sgt_interval_quotient(times(f->size, rho), sgt_interval_sum(sgt_interval_of(1), sgt_interval_square_root(phi2)));
}

SGT_INLINE void place_at(const scene *f, const shape *s, const sgt_ray *ray, double t, place *e)
{
    twofold x = coordinate_at(ray->o.x, ray->d.x, t, &e->x), y = coordinate_at(ray->o.y, ray->d.y, t, &e->y);
    coordinate_at(ray->o.z, ray->d.z, t, &e->z);
    e->half = sgt_interval_sum(sgt_interval_product(e->x, f->l), sgt_interval_product(e->y, f->m));
    /* rho to 2 * 4 + 5 + 3 = 16 u^2, the product to 32 u^2; what underflows is below 2^-170 of them */
    twofold rho = twofold_sum(twofold_product(x, x), twofold_product(y, y)), k1 = two_sum(1, s->k);
    twofold bent = twofold_scaled(twofold_product(twofold_scaled(rho, s->c), k1), s->c), phi2 = twofold_difference(twofold_of(1), bent);
    bool fine = rho.hi > 0x1p-900 && rho.hi < 0x1p1000;
    e->at.rho = fine ? rounded(rho, 0x1p-101 * rho.hi) : sgt_interval_sum(sgt_interval_square(e->x), sgt_interval_square(e->y));
    fine = fine && fabs(s->c) < 0x1p600 && fabs(s->k) < 0x1p200 && fabs(bent.hi) < 0x1p900;
    e->at.phi2 = fine ? rounded(phi2, 0x1p-100 * (1 + fabs(bent.hi))) : phi2_of(f, e->at.rho);
    e->at.sag = sag_of(f, e->at.rho, e->at.phi2);
    sgt_interval w = f->terms ? sgt_interval_difference(e->z, times(series(f->terms, f->p, e->at.rho), e->at.rho)) : e->z;
    e->g = s->c < 0 ? sgt_interval_sum(w, e->at.sag) : sgt_interval_difference(w, e->at.sag);
}

/* s' + P'. */
SGT_INLINE sgt_interval steepness(const scene *f, sgt_interval rho, sgt_interval phi2, sgt_interval *of_sag)
{
    *of_sag = sgt_interval_quotient(f->c, twice(sgt_interval_square_root(phi2)));
    return f->terms ? sgt_interval_sum(*of_sag, series(f->terms, f->first, rho)) : *of_sag;
}

/* dg/dtau. */
SGT_INLINE sgt_interval slope_of(const scene *f, sgt_interval steep, sgt_interval half)
{
    return sgt_interval_difference(f->n, twice(sgt_interval_product(steep, half)));
}

/* A lower bound of rho on the whole line. */
SGT_INLINE double least_rho(const scene *f, const sgt_ray *ray)
{
    twofold cross = twofold_difference(two_product(ray->o.x, f->m.lo), two_product(ray->o.y, f->l.lo));
    double size = fabs(cross.hi) * (1 - 0x1p-50);
    if (!(size > 0x1p-900 && size < HUGE_VAL) || f->l.lo < f->l.hi || f->m.lo < f->m.hi) return 0;
    return larger(sgt_interval_quotient(sgt_interval_square(sgt_interval_of(size)), f->a).lo, 0);
}

SGT_INLINE sgt_interval scaled_by(double x, double power) { return sgt_interval_product(sgt_interval_of(x), sgt_interval_of(power)); }

SGT_CLONES
static sgt_interval enclose(const shape *s, const sgt_ray *ray, sgt_interval t, sgt_interval *slope)
{
    double scale = scale_of(ray->d), inverse = 1 / scale;
    scene f = {.c = {s->c, s->c}, .size = {fabs(s->c), fabs(s->c)}, .terms = s->terms};
    f.k1 = sgt_interval_sum(sgt_interval_of(1), sgt_interval_of(s->k));
    f.l = scaled_by(ray->d.x, scale), f.m = scaled_by(ray->d.y, scale), f.n = scaled_by(ray->d.z, scale);
    for (int i = 0; i < s->terms; i++) {
        f.p[i] = sgt_interval_of(s->a[i]);
        f.first[i] = scaled_by(s->a[i], i + 1);
        if (i) f.second[i - 1] = scaled_by(s->a[i], (i + 1) * i);
    }
    f.a = sgt_interval_sum(sgt_interval_square(f.l), sgt_interval_square(f.m));

    place a, b;
    place_at(&f, s, ray, t.lo, &a);
    if (t.lo < t.hi) place_at(&f, s, ray, t.hi, &b);
    else b = a;

    ring near = a.half.lo >= 0 ? a.at : b.at;
    if (!(a.half.lo >= 0 || b.half.hi <= 0)) {
        near.rho = sgt_interval_of(least_rho(&f, ray));
        near.phi2 = phi2_of(&f, near.rho);
        near.sag = sag_of(&f, near.rho, near.phi2);
    }
    sgt_interval phi2 = sgt_interval_hull(sgt_interval_hull(a.at.phi2, b.at.phi2), near.phi2);
    if (phi2.hi < 0) return *slope = sgt_interval_empty();
    sgt_interval rho = {near.rho.lo, larger(a.at.rho.hi, b.at.rho.hi)}, sag = {near.sag.lo, larger(a.at.sag.hi, b.at.sag.hi)};
    if (!(phi2.lo > 0) && f.k1.lo > 0) {
        sgt_interval edge = sgt_interval_quotient(sgt_interval_of(1), times(f.k1, f.size)), rim = sgt_interval_quotient(edge, f.size);
        sag.hi = edge.hi;
        if (rim.hi < rho.hi) rho.hi = rim.hi;
    }
    sgt_interval z = sgt_interval_hull(a.z, b.z), w = f.terms ? sgt_interval_difference(z, times(series(f.terms, f.p, rho), rho)) : z;
    sgt_interval g = s->c < 0 ? sgt_interval_sum(w, sag) : sgt_interval_difference(w, sag);
    if (!(phi2.lo > 0)) return g;

    sgt_interval half = {a.half.lo, b.half.hi}, of_sag, bend, steep = steepness(&f, a.at.rho, a.at.phi2, &of_sag);
    a.slope = b.slope = slope_of(&f, steep, a.half);
    if (t.lo < t.hi) {
        steep = steepness(&f, b.at.rho, b.at.phi2, &of_sag);
        b.slope = slope_of(&f, steep, b.half);
        steep = steepness(&f, rho, phi2, &of_sag);
        sgt_interval curl = sgt_interval_quotient(sgt_interval_square(sgt_interval_product(f.c, half)), phi2);
        bend = sgt_interval_sum(sgt_interval_product(times(of_sag, curl), f.k1), times(steep, f.a));
        if (f.terms > 1) bend = sgt_interval_sum(bend, twice(times(series(f.terms - 1, f.second, rho), sgt_interval_square(half))));
        sgt_interval length = scaled_by(sgt_interval_width(t), inverse), reach = {0, length.hi}; /* bend = -g'' / 2 */
        sgt_interval chord = times(bend, (sgt_interval){0, sgt_interval_square(reach).hi}), turn = twice(times(bend, reach));
        *slope = sgt_interval_intersection(slope_of(&f, steep, half), sgt_interval_intersection(sgt_interval_difference(a.slope, turn), sgt_interval_sum(b.slope, turn)));
        sgt_interval ends = sgt_interval_hull(a.g, b.g);
        if (!(slope->lo >= 0 || slope->hi <= 0)) ends = sgt_interval_sum(ends, scaled(chord, 0.25));
        g = sgt_interval_intersection(g, ends);
    } else {
        g = a.g, *slope = a.slope;
    }
    *slope = sgt_interval_product(*slope, sgt_interval_of(inverse));
    return g;
}

sgt_interval sgt_sag_enclose(const shape *s, const sgt_ray *ray, sgt_interval t, sgt_interval *slope)
{
    sgt_vec3 o = ray->o, d = ray->d;
    *slope = sgt_interval_all();
    if (isnan(t.lo) || isnan(t.hi) || !((o.x - o.x) + (o.y - o.y) + (o.z - o.z) + (d.x - d.x) + (d.y - d.y) + (d.z - d.z) == 0)) return *slope;
    if (t.lo > t.hi) return *slope = sgt_interval_empty();
    return enclose(s, ray, t, slope);
}
