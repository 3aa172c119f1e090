// SPDX-License-Identifier: MIT
/* quadratic.h - rays and surfaces of the second degree: the parabola, its roots, and what is certain of
 * them.
 *
 * Along x + tau d the surface is g = A tau^2 + 2 B tau + C.  The local origin x is near the surface, so a
 * distant ray loses nothing.  The coefficients are computed there in doubles.  Each is off by at most E =
 * 16 u times the sum of the magnitudes of its terms, Aa, Ba or Ca.  Hence D = B^2 - A C is off by at most
 *     De = 64 u (Ba^2 + Aa Ca).
 * If D < -De, there is certainly no root.  With q = -(B + sign(B) sqrt D) the roots are C / q and q / A,
 * without a difference of like numbers (Press et al. 2007, section 5.6).
 *
 * HOW FAR A ROOT CAN BE OFF.  Let S^2 = D > 16 De, and spread = Aa tau^2 + 2 Ba |tau| + Ca.  At an exact
 * root the computed parabola is at most E spread(tau).  From a root of its own toward the vertex it grows
 * by at least S times the distance.  So the two roots are at most 2 E spread / S apart.  The factor 2 is
 * there because spread belongs at the other of the two.  It suffices: with N = Ba^2 + Aa Ca <= D / 64 E
 * and |tau| <= Ca / S, 16 E^2 Aa spread <= D, so over that distance spread at most doubles.
 *
 * The same holds for q / A if |A| > 2^-20 Aa, since |q| <= 2^23 S.  For smaller A (a ray nearly along the
 * axis of a paraboloid) with |q| <= 3 S, C / q is still right, and q / A is right to half of itself as
 * long as |A| > 8 E Aa.  If Aa = 0, there is only one root.
 *
 * THE VERTEX -B / A PARTS THE TWO.  `first` gives one of two stretches:
 * - from just before the first root to the vertex: only the first root is in it.  Given if that root is
 *   certainly accepted (the rule is at sgt_ray in sagitta.h; the solver may have a t_err of a few times
 *   the rule's own width).
 * - from the vertex to just behind the second root: only the second is in it.  Given if the first is
 *   certainly not accepted.
 *
 * WHY APART.  The two stretches come without a search.  Without `first` and `firsts` the enclosures answer:
 * an ellipsoid and a quadric then cost 9.6 times the instructions one by one, 47 and 57 times in a batch.  As
 * a user's surface (own_ = NULL besides) it is 2.5 and 2.9, 13 and 17 times (300 rays each, by callgrind).
 *
 * Nothing is promised in three cases: between these two; if D is not above 16 De (the ray touches); and if
 * the distance from the vertex is within what a double can tell of t.
 *
 * A START ON THE SURFACE is between these two: the roots about x are off by more than the rule's own width.
 * So rays without a promise are looked at from the start.  Let g there be known within e, and s the slope.
 * If 64 |A| (|g| + e) <= s^2, a root lies within 1.02 (|g| + e) / |s| of the start, and the other is at least
 * 0.9 |s / A| from it.  The near one is the first if s and A have unlike signs (g falls toward the vertex, as
 * A is its bend).  It is the start if |g| is within half of the rule's width, and e is no more than 16
 * widths, as everywhere (accept.h; proof_take of ray/proof.c).  Then the second is behind the vertex.  If the
 * start is the second, no root is accepted. */
#ifndef SGT_SURFACE_BODY_QUADRATIC_H
#define SGT_SURFACE_BODY_QUADRATIC_H

#include "../../num/expansion.h"
#include "../../num/lanes.h"
#include "../departure/departure.h"
#include "../builtin.h"

#include <sagitta/interval.h>

#define COEFFICIENT 0x1p-49  /* E */
#define DISCRIMINANT 0x1p-47 /* De / (Ba^2 + Aa Ca) */

typedef struct parabola { double A, B, C, Aa, Ba, Ca; } parabola;

/* The ray with its local origin near the surface. */
typedef struct near_ray { sgt_vec3 x, d; double t0, scale, inverse; } near_ray;

typedef struct crossings {
    double lo, hi;              /* no root is outside; lo > hi: there is none */
    double mid, first, second;  /* mid parts the roots */
    double first_off, slope;    /* how far the first can be off; half of |dg/dtau| there */
    mask none, one, two;        /* the number of roots, where it is certain */
} crossings;

SGT_INLINE double quadratic_spread(const parabola *p, double tau)
{
    return (p->Aa * fabs(tau) + 2 * p->Ba) * fabs(tau) + p->Ca;
}

SGT_INLINE crossings crossings_of(const parabola *p, double t0)
{
    crossings c;
    double A = p->A, B = p->B, D = B * B - A * p->C, size = p->Ba * p->Ba + p->Aa * p->Ca,
           De = DISCRIMINANT * size, aA = fabs(A);
    double s = sqrt(D > 0 ? D : 0), q = -(B + copysign(s, B)), near = p->C / q, away = q / A,
           inverse = 1 / aA, off = 0x1p-50 * fabs(t0);
    mask fine = MASK(size > TINY) & MASK(size < HUGE_VAL), clear = MASK(D > 16 * De) & fine,
         linear = MASK(p->Aa == 0);
    mask steep = MASK(aA > 0x1p-20 * p->Aa),
         flat = MASK(aA > 8 * COEFFICIENT * p->Aa) & MASK(fabs(q) <= 3 * s);
    mask constant = linear & MASK(p->Ba == 0);
    c.none = (fine & MASK(D < -De)) | (constant & MASK(fabs(p->C) > COEFFICIENT * p->Ca));

    double near_spread = quadratic_spread(p, near), away_spread = quadratic_spread(p, away),
           unit = 2 * COEFFICIENT / s;
    double near_off = unit * near_spread + 4 * SGT_U * fabs(near),
           away_off = chosen(steep, unit * away_spread + 4 * SGT_U * fabs(away), 0.5 * fabs(away));
    mask order = MASK(near <= away);
    double second_off = chosen(order, away_off, near_off);
    c.mid = -B / A, c.slope = s;
    c.first = chosen(order, near, away), c.second = chosen(order, away, near),
    c.first_off = chosen(order, near_off, away_off);
    double before = c.mid - c.first, behind = c.second - c.mid, gap = 0.0625 * (c.second - c.first);
    c.two = clear & (steep | flat);
    mask parted = MASK(before > c.first_off + off) & MASK(behind > second_off + off) & MASK(gap < HUGE_VAL);
    c.one = clear & linear;

    /* With two roots: about them.  Otherwise about the vertex, if there is one.  For a linear equation:
     * about its root. */
    double half = ((1 + 0x1p-3) * sqrt((D > 0 ? D : 0) + De) + 0x1p-28 * fabs(B) + 2 * COEFFICIENT * p->Ba) *
                  inverse;
    mask about = steep & fine & MASK(half < HUGE_VAL);
    double lo = chosen(about, c.mid - half, -HUGE_VAL), hi = chosen(about, c.mid + half, HUGE_VAL),
           room = 8 * near_off + 0x1p-10 * near_spread / s;
    lo = chosen(c.two & parted, c.first - (8 * c.first_off + gap), lo),
    hi = chosen(c.two & parted, c.second + (8 * second_off + gap), hi);
    lo = chosen(c.one, near - room, lo), hi = chosen(c.one, near + room, hi);
    c.two &= parted;
    c.first = chosen(c.one, near, c.first), c.first_off = chosen(c.one, near_off, c.first_off);
    mask guessed = MASK(D > 0) & (steep | flat), lonely = clear & ~guessed;
    c.first = chosen(guessed, c.first, chosen(lonely, near, chosen(about, c.mid, (double)NAN)));
    c.lo = chosen(c.none, 1.0, lo), c.hi = chosen(c.none, -1.0, hi);
    return c;
}

/* In the ray's own t, rounded outward. */
SGT_INLINE double quadratic_below(const near_ray *r, double tau)
{
    return end_below((r->t0 + tau) - 0x1p-51 * (fabs(r->t0) + fabs(tau)), r->scale);
}
SGT_INLINE double quadratic_above(const near_ray *r, double tau)
{
    return end_above((r->t0 + tau) + 0x1p-51 * (fabs(r->t0) + fabs(tau)), r->scale);
}

/* The start of the ray, which is o + from d. */
SGT_INLINE sgt_vec3 outset_of(sgt_vec3 o, sgt_vec3 d, double from)
{
    return (sgt_vec3){moved_along(o.x, from, d.x), moved_along(o.y, from, d.y), moved_along(o.z, from, d.z)};
}

/* leaves: the start may be the second root. */
typedef struct lane_span { double lo, hi, seed; mask single, leaves; } lane_span;

SGT_INLINE lane_span quadratic_span(const near_ray *r, const crossings *c)
{
    lane_span a = {.seed = (r->t0 + c->first) * r->scale, .single = c->none | c->one};
    a.lo = chosen(c->none, 1.0, chosen(MASK(c->lo > -HUGE_VAL), quadratic_below(r, c->lo), -HUGE_VAL));
    a.hi = chosen(c->none, -1.0, chosen(MASK(c->hi < HUGE_VAL), quadratic_above(r, c->hi), HUGE_VAL));
    return a;
}

/* terms: |x Fx| + |y Fy| + |z Fz| at the first root, in the unit of the parabola. */
SGT_INLINE lane_span quadratic_first(const near_ray *r, const crossings *c, double terms, double tmin)
{
    lane_span a = quadratic_span(r, c);
    double from = tmin * r->inverse, gap = c->first - (from - r->t0),
           width = START_ULPS * terms / (2 * c->slope);
    double at = chosen(MASK(fabs(from) < HUGE_VAL), fabs(from), 0),
           blur = 2 * c->first_off + 0x1p-50 * (fabs(r->t0) + fabs(c->first) + at);
    mask two = c->two & MASK((c->second - c->first) * r->scale > 0x1p-900); /* else mid may not part them */
    mask accepted = two & MASK(gap > 8 * width + 16 * blur + 0x1p-45 * at),
         behind = two & MASK(gap + blur < 0.75 * width);
    double mid = (r->t0 + c->mid) * r->scale;
    a.hi = chosen(accepted, mid, a.hi), a.lo = chosen(behind, mid, a.lo);
    a.seed = chosen(behind, (r->t0 + c->second) * r->scale, a.seed);
    a.single |= accepted | behind;
    a.leaves = behind & MASK(fabs(c->second - (from - r->t0)) < 0x1p-20 * (c->second - c->first));
    return a;
}

/* g at the start, and a bound on its error; the slope along the local d, and on its error; the terms. */
typedef struct outset { double g, g_err, slope, slope_err, terms; } outset;
typedef struct outsets {
    double g[DEPARTURE_BLOCK], g_err[DEPARTURE_BLOCK], slope[DEPARTURE_BLOCK], slope_err[DEPARTURE_BLOCK],
        terms[DEPARTURE_BLOCK];
} outsets;

/* What `a`, of quadratic_first, does not promise of a start on the surface.  Other rays keep `a`. */
SGT_INLINE lane_span quadratic_leave(const near_ray *r, const crossings *c, const parabola *p, lane_span a,
                                     outset b, double tmin)
{
    double g = fabs(b.g), e = b.g_err + 2 * SGT_U * b.terms, steep = fabs(b.slope),
        width = START_ULPS * b.terms;
    /* where all terms vanish no rounding hides g; what underflow hides is within START_LEAST */
    mask exact = MASK(g == 0) & MASK(e == 0) & MASK(steep > TINY);
    mask two = c->two & MASK((c->second - c->first) * r->scale > 0x1p-900),
         on = two & (~a.single | a.leaves) & MASK(fabs(tmin) < HUGE_VAL) &
              MASK(g <= 0.5 * width + 0.125 * e) & MASK(e <= 16 * width) &
              MASK(64 * fabs(p->A) * (g + e) <= steep * steep) &
              MASK(steep > 0x1p10 * b.slope_err) & (MASK(width > TINY) | exact);
    mask first = on & MASK(b.slope * p->A < 0), last = on & MASK(b.slope * p->A > 0);
    a.lo = chosen(first, (r->t0 + c->mid) * r->scale, a.lo);
    a.seed = chosen(first, (r->t0 + c->second) * r->scale, a.seed);
    a.lo = chosen(last, 1.0, a.lo), a.hi = chosen(last, -1.0, a.hi);
    a.single |= first | last;
    return a;
}

/* Above 0: single.  Not 1: quadratic_leave may know more. */
SGT_INLINE double settled_of(lane_span a)
{
    return chosen(a.leaves, 2.0, chosen(a.single, 1.0, 0.0));
}

enum { FEW_LEAVE = 16 }; /* rays of a block, and more: its first ray is looked at */

/* Defines span and first, single and in lanes, for a surface of this kind:
 *
 *   SELF                       its type
 *   APPROACH(s, o, d, &p, &r)  makes the parabola and the local ray
 *   TERMS(s, &r, tau)          the terms at tau
 *   BEGINNING(s, p, d)         what is known at the point p, d being the local direction
 *
 * Truth values are written by a loop of their own: a loop with bytes beside doubles is not vectorised.
 *
 * NAME_all_leaving runs only for blocks with a ray that NAME_all_firsts leaves open.  Where the first ray
 * starts on the surface, most do, and it runs at once: it gives what the other gives, and more. */
#define QUADRATIC_LANES(NAME, SELF, APPROACH, ANSWER, KIND)                                            \
    KIND                                                                                               \
    static void NAME(const SELF *self, size_t n, const double *restrict ox, const double *restrict oy, \
                     const double *restrict oz, const double *restrict dx, const double *restrict dy,  \
                     const double *restrict dz, const double *restrict tmin, double *restrict lo,      \
                     double *restrict hi, double *restrict seed, double *restrict single)              \
    {                                                                                                  \
        const SELF s = *self;                                                                          \
        (void)tmin;                                                                                    \
        LANES for (size_t i = 0; i < n; i++)                                                           \
        {                                                                                              \
            parabola p;                                                                                \
            near_ray r;                                                                                \
            APPROACH(&s, (sgt_vec3){ox[i], oy[i], oz[i]}, (sgt_vec3){dx[i], dy[i], dz[i]}, &p, &r);    \
            crossings c = crossings_of(&p, r.t0);                                                      \
            lane_span a = ANSWER;                                                                      \
            lo[i] = a.lo, hi[i] = a.hi, seed[i] = a.seed, single[i] = settled_of(a);                   \
        }                                                                                              \
    }

#define QUADRATIC_SPANS(NAME, SELF, APPROACH, TERMS, BEGINNING)                                             \
    QUADRATIC_LANES(NAME##_all_spans, SELF, APPROACH, quadratic_span(&r, &c), SGT_KERNEL)                   \
    QUADRATIC_LANES(NAME##_all_firsts, SELF, APPROACH,                                                      \
                    quadratic_first(&r, &c, TERMS(&s, &r, c.first), tmin[i]), SGT_KERNEL)                   \
    SGT_KERNEL                                                                                              \
    static void NAME##_all_outsets(const SELF *self, size_t n, const sgt_rays *rays, outsets *restrict out) \
    {                                                                                                       \
        const SELF s = *self;                                                                               \
        const double *ox = rays->o[0], *oy = rays->o[1], *oz = rays->o[2], *dx = rays->d[0],                \
                     *dy = rays->d[1], *dz = rays->d[2], *tmin = rays->tmin;                                \
        LANES for (size_t i = 0; i < n; i++)                                                                \
        {                                                                                                   \
            sgt_vec3 d = {dx[i], dy[i], dz[i]};                                                             \
            double scale = scale_of(d), from = tmin[i] * inverse_of_scale(d);                               \
            d.x *= scale, d.y *= scale, d.z *= scale;                                                       \
            outset b = BEGINNING(&s, outset_of((sgt_vec3){ox[i], oy[i], oz[i]}, d, from), d);               \
            out->g[i] = b.g, out->g_err[i] = b.g_err, out->slope[i] = b.slope,                              \
            out->slope_err[i] = b.slope_err, out->terms[i] = b.terms;                                       \
        }                                                                                                   \
    }                                                                                                       \
    SGT_KERNEL                                                                                              \
    static void NAME##_all_leaving(const SELF *self, size_t n, const sgt_rays *rays, const outsets *from,   \
                                   double *restrict lo, double *restrict hi, double *restrict seed,         \
                                   double *restrict single)                                                 \
    {                                                                                                       \
        const SELF s = *self;                                                                               \
        const double *ox = rays->o[0], *oy = rays->o[1], *oz = rays->o[2], *dx = rays->d[0],                \
                     *dy = rays->d[1], *dz = rays->d[2], *tmin = rays->tmin;                                \
        LANES for (size_t i = 0; i < n; i++)                                                                \
        {                                                                                                   \
            parabola p;                                                                                     \
            near_ray r;                                                                                     \
            APPROACH(&s, (sgt_vec3){ox[i], oy[i], oz[i]}, (sgt_vec3){dx[i], dy[i], dz[i]}, &p, &r);         \
            crossings c = crossings_of(&p, r.t0);                                                           \
            outset b = {from->g[i], from->g_err[i], from->slope[i], from->slope_err[i], from->terms[i]};    \
            lane_span a = quadratic_first(&r, &c, TERMS(&s, &r, c.first), tmin[i]);                         \
            a = quadratic_leave(&r, &c, &p, a, b, tmin[i]);                                                 \
            lo[i] = a.lo, hi[i] = a.hi, seed[i] = a.seed, single[i] = settled_of(a);                        \
        }                                                                                                   \
    }                                                                                                       \
    SGT_NOINLINE                                                                                            \
    static void NAME##_unsettled(const void *self, size_t n, sgt_rays rays, sgt_spans out, size_t i)        \
    {                                                                                                       \
        double single[DEPARTURE_BLOCK];                                                                     \
        outsets from;                                                                                       \
        sgt_rays own = rays_from(&rays, i);                                                                 \
        own.tmin = rays.tmin + i;                                                                           \
        NAME##_all_outsets(self, n, &own, &from);                                                           \
        NAME##_all_leaving(self, n, &own, &from, out.lo + i, out.hi + i, out.seed + i, single);             \
        for (size_t j = 0; j < n; j++) out.single[i + j] = single[j] > 0;                                   \
    }                                                                                                       \
    static bool NAME##_begins_on(const SELF *s, const sgt_rays *r, size_t i)                                \
    {                                                                                                       \
        sgt_vec3 d = {r->d[0][i], r->d[1][i], r->d[2][i]};                                                  \
        double scale = scale_of(d), from = r->tmin[i] * inverse_of_scale(d);                                \
        d.x *= scale, d.y *= scale, d.z *= scale;                                                           \
        outset b = BEGINNING(s, outset_of((sgt_vec3){r->o[0][i], r->o[1][i], r->o[2][i]}, d, from), d);     \
        return fabs(b.g) <= START_ULPS * b.terms;                                                           \
    }                                                                                                       \
    static void NAME##_blocks(const void *self, size_t n, sgt_rays rays, sgt_spans out, bool first)         \
    {                                                                                                       \
        double single[DEPARTURE_BLOCK];                                                                     \
        for (size_t i = 0, few; i < n; i += few) {                                                          \
            few = n - i < DEPARTURE_BLOCK ? n - i : DEPARTURE_BLOCK;                                        \
            if (first && few >= FEW_LEAVE && NAME##_begins_on(self, &rays, i)) {                            \
                NAME##_unsettled(self, few, rays, out, i);                                                  \
                continue;                                                                                   \
            }                                                                                               \
            (first ? NAME##_all_firsts : NAME##_all_spans)(                                                 \
                self, few, rays.o[0] + i, rays.o[1] + i, rays.o[2] + i, rays.d[0] + i, rays.d[1] + i,       \
                rays.d[2] + i, first ? rays.tmin + i : NULL, out.lo + i, out.hi + i, out.seed + i, single); \
            bool settled = true;                                                                            \
            for (size_t j = 0; j < few; j++)                                                                \
                out.single[i + j] = single[j] > 0, settled &= single[j] == 1;                               \
            if (!first || settled) continue;                                                                \
            NAME##_unsettled(self, few, rays, out, i);                                                      \
        }                                                                                                   \
    }                                                                                                       \
    static void NAME##_spans(const void *self, size_t n, sgt_rays rays, sgt_spans out)                      \
    {                                                                                                       \
        NAME##_blocks(self, n, rays, out, false);                                                           \
    }                                                                                                       \
    static void NAME##_firsts(const void *self, size_t n, sgt_rays rays, sgt_spans out)                     \
    {                                                                                                       \
        NAME##_blocks(self, n, rays, out, true);                                                            \
    }                                                                                                       \
    static sgt_span NAME##_one(const void *self, const sgt_ray *ray, bool first)                            \
    {                                                                                                       \
        sgt_span a;                                                                                         \
        double single;                                                                                      \
        const sgt_vec3 *o = &ray->o, *d = &ray->d;                                                          \
        (first ? NAME##_all_firsts : NAME##_all_spans)(self, 1, &o->x, &o->y, &o->z, &d->x, &d->y, &d->z,   \
                                                       first ? &ray->tmin : NULL, &a.lo, &a.hi, &a.seed,    \
                                                       &single);                                            \
        a.single = single > 0;                                                                              \
        if (first && single != 1)                                                                           \
            NAME##_unsettled(self, 1, rays_of(ray), (sgt_spans){&a.lo, &a.hi, &a.seed, &a.single}, 0);      \
        return a;                                                                                           \
    }                                                                                                       \
    static sgt_span NAME##_span(const void *self, const sgt_ray *ray)                                       \
    {                                                                                                       \
        return NAME##_one(self, ray, false);                                                                \
    }                                                                                                       \
    static sgt_span NAME##_first(const void *self, const sgt_ray *ray) { return NAME##_one(self, ray, true); }

SGT_INLINE near_ray near_ray_of(sgt_vec3 d)
{
    double scale = scale_of(d);
    return (near_ray){
        .d = {d.x * scale, d.y * scale, d.z * scale}, .scale = scale, .inverse = inverse_of_scale(d)};
}

SGT_INLINE void near_ray_at(near_ray *r, sgt_vec3 o, double t0)
{
    r->t0 = t0;
    r->x = (sgt_vec3){moved_along(o.x, t0, r->d.x), moved_along(o.y, t0, r->d.y),
                      moved_along(o.z, t0, r->d.z)};
}

/* ------------------------------------------------------------------ by intervals
 *
 * Let m be the middle of the stretch.  The coefficients about m are known in twice the precision, off by
 * 2^-96 of their terms.  g = C + tau (2 B + A tau) with tau in t - m.  The slope 2 (B + A tau) is exact as
 * an interval.  If it has one sign, g lies between its ends.  Otherwise g lies beyond them by at most A
 * w^2 / 4, where w is the length, and no farther than C - B^2 / A. */
typedef struct fine_parabola { twofold A, B, C; double Aa, Ba, Ca; } fine_parabola;

#define FINE_COEFFICIENT 0x1p-96

SGT_INLINE sgt_interval fine_interval(twofold x, double by)
{
    return sgt_interval_between(-sgt_sum_above(-x.hi, sgt_sum_above(by, -x.lo)),
                                sgt_sum_above(x.hi, sgt_sum_above(x.lo, by)));
}

/* The ray over t, about its middle, in units of the scaled direction.  fine_ray_of returns false if the
 * numbers are outside the range in which twice the precision holds. */
typedef struct fine_ray { twofold x, y, z; double l, m, n; sgt_interval tau; double inverse; } fine_ray;

SGT_INLINE bool fine_range(double o, double l, double at)
{
    double p = fabs(l * at), most = 0x1p400;
    return fabs(o) < most && p < most && (at == 0 || l == 0 || p > 0x1p-400) &&
           (l == 0 || fabs(l) > 0x1p-400) && (o == 0 || fabs(o) > 0x1p-400);
}

/* Moves an end outward if it is so near 0 that its products vanish. */
SGT_INLINE double fine_end(double t, double by, double outward)
{
    double p = t * by, least = 0x1p-400;
    if (!(fabs(p) < least) || t == 0) return p;
    return (t > 0) == (outward > 0) ? outward * least : 0;
}

/* o + (t0 + t) l.  Returns false if the parts omitted by twice the precision exceed 2^-100 of it. */
static inline bool fine_along(double o, double l, double t0, double t, twofold *x)
{
    if (t0 == 0) {
        *x = coordinate(o, l, t, 0);
        return true;
    }
    expansion e = expansion_along(o, l, t0, t);
    *x = two_sum(e.part[0], e.part[1]);
    return fabs(e.part[2]) + fabs(e.part[3]) + fabs(e.part[4]) <= 0x1p-100 * fabs(x->hi);
}

/* t is counted from t0. */
SGT_INLINE bool fine_ray_of(const sgt_ray *ray, double t0, sgt_interval t, fine_ray *r)
{
    double scale = scale_of(ray->d), inverse = inverse_of_scale(ray->d), lo = fine_end(t.lo, inverse, -1),
           hi = fine_end(t.hi, inverse, 1), far = 0x1p390;
    double mid = fabs(lo) < far ? (fabs(hi) < far ? 0.5 * lo + 0.5 * hi : lo) : fabs(hi) < far ? hi : 0;
    r->l = ray->d.x * scale, r->m = ray->d.y * scale, r->n = ray->d.z * scale, r->inverse = inverse;
    if (!(scale > 0x1p-1000 && scale < 0x1p1000)) return false;
    if (fabs(mid) < 0x1p-400) mid = 0;
    t0 *= inverse;
    if (!fine_range(ray->o.x, r->l, t0) || !fine_range(ray->o.y, r->m, t0) || !fine_range(ray->o.z, r->n, t0))
        return false;
    if (!fine_range(ray->o.x, r->l, mid) || !fine_range(ray->o.y, r->m, mid) ||
        !fine_range(ray->o.z, r->n, mid))
        return false;
    r->tau = sgt_interval_between(-sgt_sum_above(-lo, mid), sgt_sum_above(hi, -mid));
    return fine_along(ray->o.x, r->l, t0, mid, &r->x) && fine_along(ray->o.y, r->m, t0, mid, &r->y) &&
           fine_along(ray->o.z, r->n, t0, mid, &r->z);
}

SGT_INLINE sgt_interval fine_enclose(const fine_parabola *p, const fine_ray *r, sgt_interval *slope)
{
    sgt_interval A = fine_interval(p->A, FINE_COEFFICIENT * p->Aa),
                 B = fine_interval(p->B, FINE_COEFFICIENT * p->Ba),
                 C = fine_interval(p->C, FINE_COEFFICIENT * p->Ca);
    sgt_interval twice = sgt_interval_scaled(B, 2), lo = sgt_interval_of(r->tau.lo),
                 hi = sgt_interval_of(r->tau.hi);
    sgt_interval from = sgt_interval_product(A, lo), to = sgt_interval_product(A, hi), g = C;
    sgt_interval left = sgt_interval_sum(twice, sgt_interval_scaled(from, 2)),
                 right = sgt_interval_sum(twice, sgt_interval_scaled(to, 2));
    *slope = sgt_interval_hull(left, right);
    if (r->tau.lo != 0 || r->tau.hi != 0) {
        sgt_interval ends = sgt_interval_hull(
            sgt_interval_sum(C, sgt_interval_product(lo, sgt_interval_sum(twice, from))),
            sgt_interval_sum(C, sgt_interval_product(hi, sgt_interval_sum(twice, to))));
        g = ends;
        if (!(slope->lo >= 0 || slope->hi <= 0)) {
            double width = sgt_interval_width(r->tau);
            sgt_interval sunk = sgt_interval_scaled(
                sgt_interval_product(A, sgt_interval_square(sgt_interval_of(width))), -0.25);
            g = sgt_interval_sum(ends, sgt_interval_hull(sunk, sgt_interval_of(0)));
            if (A.lo > 0 || A.hi < 0) {
                sgt_interval turn = sgt_interval_difference(C,
                                                            sgt_interval_quotient(sgt_interval_square(B), A));
                g = sgt_interval_intersection(g, sgt_interval_hull(ends, turn));
            }
        }
    }
    *slope = sgt_interval_scaled(*slope, r->inverse);
    return g;
}

/* o + (t0 + t) d, if nothing better is known. */
SGT_INLINE sgt_interval plain_line(double o, double d, double t0, sgt_interval t)
{
    sgt_interval from = sgt_interval_of(o);
    if (t0 != 0) from = sgt_interval_sum(from, sgt_interval_scaled(sgt_interval_of(t0), d));
    return sgt_interval_sum(from, sgt_interval_scaled(t, d));
}

/* Returns false if t or the ray is not a stretch to enclose g over.  *g and *slope are then the answer. */
SGT_INLINE bool stretch_valid(const sgt_ray *ray, sgt_interval t, sgt_interval *g, sgt_interval *slope)
{
    sgt_vec3 o = ray->o, d = ray->d;
    *g = *slope = sgt_interval_all();
    if (isnan(t.lo) || isnan(t.hi) ||
        !((o.x - o.x) + (o.y - o.y) + (o.z - o.z) + (d.x - d.x) + (d.y - d.y) + (d.z - d.z) == 0))
        return false;
    if (t.lo > t.hi) *g = *slope = sgt_interval_empty();
    return t.lo <= t.hi;
}

#endif
