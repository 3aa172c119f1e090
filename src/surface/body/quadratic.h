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
 * axis of a paraboloid) with |q| <= 3 S, C / q is still right, and q / A is right to half of itself as long
 * as |A| > 8 E Aa.  If Aa = 0, there is only one root: what has underflown in A is below 2^-1060, and moves
 * it by nothing if Ca is below 2^900 Ba^2.
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
 * THE SLOPE ABOUT A ROOT.  |dg/dtau| is 2 S at both roots and falls evenly to 0 at the vertex, V = S / |A|
 * from them.  A stretch that holds a root ends S / 16 |A| from it on that side, as computed, if the root is
 * off by less than half of that.  S is off by at most 1/32 of itself and |A| by 1/8, so it ends at most 0.11
 * V from the root, and |dg/dtau| >= 2 (1 - 0.11) 0.968 S > 1.7 S all over it: a root there needs no look
 * beside it.
 *
 * Proofs rest on these promises (ray/cells_batch.c), as they do on spans: both are by the bounds above.
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
#include "../../num/interval_lanes.h"
#include "../../num/lanes.h"
#include "../departure/departure.h"
#include "../builtin.h"

#include <sagitta/interval.h>

#define COEFFICIENT 0x1p-49  /* E */
#define DISCRIMINANT 0x1p-47 /* De / (Ba^2 + Aa Ca) */
#define STEEPNESS 1.6        /* THE SLOPE ABOUT A ROOT, over S */

typedef struct parabola { double A, B, C, Aa, Ba, Ca; } parabola;

/* The ray with its local origin near the surface. */
typedef struct near_ray { sgt_vec3 x, d; double t0, scale, inverse; } near_ray;

typedef struct crossings {
    double lo, hi;              /* no root is outside; lo > hi: there is none */
    double mid, first, second;  /* mid parts the roots */
    double first_off, second_off; /* how far they can be off */
    double slope;               /* half of |dg/dtau| at either */
    double reach;               /* a sixteenth of the way from a root to the vertex */
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
         linear = MASK(p->Aa == 0) & MASK(0x1p-900 * p->Ca <= p->Ba * p->Ba);
    mask steep = MASK(aA > 0x1p-20 * p->Aa),
         flat = MASK(aA > 8 * COEFFICIENT * p->Aa) & MASK(fabs(q) <= 3 * s);
    mask constant = MASK(p->Aa == 0) & MASK(p->Ba == 0);
    c.none = (fine & MASK(D < -De)) | (constant & MASK(fabs(p->C) > COEFFICIENT * p->Ca));

    double near_spread = quadratic_spread(p, near), away_spread = quadratic_spread(p, away),
           unit = 2 * COEFFICIENT / s;
    double near_off = unit * near_spread + 4 * SGT_U * fabs(near),
           away_off = chosen(steep, unit * away_spread + 4 * SGT_U * fabs(away), 0.5 * fabs(away));
    mask order = MASK(near <= away);
    double second_off = chosen(order, away_off, near_off);
    c.mid = -B / A, c.slope = s, c.reach = 0x1p-4 * s * inverse;
    c.first = chosen(order, near, away), c.second = chosen(order, away, near),
    c.first_off = chosen(order, near_off, away_off), c.second_off = second_off;
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

/* leaves: the start may be the second root.  steep: STEEPNESS, in the unit of the parabola; 0: not known. */
typedef struct lane_span { double lo, hi, seed, steep; mask single, leaves; } lane_span;

SGT_INLINE lane_span quadratic_span(const near_ray *r, const crossings *c)
{
    lane_span a = {.seed = (r->t0 + c->first) * r->scale, .single = c->none | c->one,
                   .steep = chosen(c->one, STEEPNESS * c->slope, 0)};
    a.lo = chosen(c->none, 1.0, chosen(MASK(c->lo > -HUGE_VAL), quadratic_below(r, c->lo), -HUGE_VAL));
    a.hi = chosen(c->none, -1.0, chosen(MASK(c->hi < HUGE_VAL), quadratic_above(r, c->hi), HUGE_VAL));
    return a;
}

/* Where a stretch that holds one of two roots may end on the side of the vertex, and still be steep. */
SGT_INLINE mask quadratic_steep(const near_ray *r, const crossings *c, double root, double off)
{
    return MASK(off + 0x1p-46 * (fabs(r->t0) + fabs(root)) < 0.5 * c->reach);
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
    double mid = (r->t0 + c->mid) * r->scale, after = (r->t0 + (c->first + c->reach)) * r->scale,
           before = (r->t0 + (c->second - c->reach)) * r->scale;
    mask steep = accepted & quadratic_steep(r, c, c->first, c->first_off),
         steep_behind = behind & quadratic_steep(r, c, c->second, c->second_off);
    a.hi = chosen(steep, after, chosen(accepted, mid, a.hi));
    a.lo = chosen(steep_behind, before, chosen(behind, mid, a.lo));
    a.seed = chosen(behind, (r->t0 + c->second) * r->scale, a.seed);
    a.steep = chosen(steep | steep_behind, STEEPNESS * c->slope, a.steep);
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
    mask rises = first & quadratic_steep(r, c, c->second, c->second_off);
    double before = (r->t0 + (c->second - c->reach)) * r->scale;
    a.lo = chosen(rises, before, chosen(first, (r->t0 + c->mid) * r->scale, a.lo));
    a.seed = chosen(first, (r->t0 + c->second) * r->scale, a.seed);
    a.steep = chosen(rises, STEEPNESS * c->slope, chosen(first | last, 0, a.steep));
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
 *   UNIT(s)                    F over the parabola
 *   TERMS(s, &r, tau)          the terms at tau
 *   BEGINNING(s, p, d)         what is known at the point p, d being the local direction
 *
 * Truth values are written by a loop of their own: a loop with bytes beside doubles is not vectorised.
 *
 * NAME_all_leaving runs only for blocks with a ray that NAME_all_firsts leaves open.  Where the first ray
 * starts on the surface, most do, and it runs at once: it gives what the other gives, and more. */
#define QUADRATIC_LANES(NAME, SELF, APPROACH, ANSWER, STEEP, KIND)                                     \
    KIND                                                                                               \
    static void NAME(const SELF *self, size_t n, const double *restrict ox, const double *restrict oy, \
                     const double *restrict oz, const double *restrict dx, const double *restrict dy,  \
                     const double *restrict dz, const double *restrict tmin, double *restrict lo,      \
                     double *restrict hi, double *restrict seed, double *restrict single,              \
                     double *restrict steep)                                                           \
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
            STEEP                                                                                      \
        }                                                                                              \
    }

#define QUADRATIC_SPANS(NAME, SELF, APPROACH, UNIT, TERMS, BEGINNING)                                       \
    QUADRATIC_LANES(NAME##_all_spans, SELF, APPROACH, quadratic_span(&r, &c), (void)steep;, SGT_KERNEL)     \
    QUADRATIC_LANES(NAME##_all_firsts, SELF, APPROACH,                                                      \
                    quadratic_first(&r, &c, TERMS(&s, &r, c.first), tmin[i]),                               \
                    steep[i] = a.steep * UNIT(&s);, SGT_KERNEL)                                             \
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
                                   double *restrict single, double *restrict steep)                         \
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
            steep[i] = a.steep * UNIT(&s);                                                                  \
        }                                                                                                   \
    }                                                                                                       \
    SGT_NOINLINE                                                                                            \
    static void NAME##_unsettled(const void *self, size_t n, sgt_rays rays, sgt_spans out, double steep[],  \
                                 size_t i)                                                                  \
    {                                                                                                       \
        double single[DEPARTURE_BLOCK];                                                                     \
        outsets from;                                                                                       \
        sgt_rays own = rays_from(&rays, i);                                                                 \
        own.tmin = rays.tmin + i;                                                                           \
        NAME##_all_outsets(self, n, &own, &from);                                                           \
        NAME##_all_leaving(self, n, &own, &from, out.lo + i, out.hi + i, out.seed + i, single, steep);      \
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
    static void NAME##_blocks(const void *self, size_t n, sgt_rays rays, sgt_spans out, bool first,         \
                              double steep[])                                                               \
    {                                                                                                       \
        double single[DEPARTURE_BLOCK], unread[DEPARTURE_BLOCK];                                            \
        for (size_t i = 0, few; i < n; i += few) {                                                          \
            few = n - i < DEPARTURE_BLOCK ? n - i : DEPARTURE_BLOCK;                                        \
            double *own = steep ? steep + i : unread;                                                       \
            if (first && few >= FEW_LEAVE && NAME##_begins_on(self, &rays, i)) {                            \
                NAME##_unsettled(self, few, rays, out, own, i);                                             \
                continue;                                                                                   \
            }                                                                                               \
            (first ? NAME##_all_firsts : NAME##_all_spans)(                                                 \
                self, few, rays.o[0] + i, rays.o[1] + i, rays.o[2] + i, rays.d[0] + i, rays.d[1] + i,       \
                rays.d[2] + i, first ? rays.tmin + i : NULL, out.lo + i, out.hi + i, out.seed + i, single,  \
                own);                                                                                       \
            bool settled = true;                                                                            \
            for (size_t j = 0; j < few; j++)                                                                \
                out.single[i + j] = single[j] > 0, settled &= single[j] == 1;                               \
            if (!first || settled) continue;                                                                \
            NAME##_unsettled(self, few, rays, out, own, i);                                                 \
        }                                                                                                   \
    }                                                                                                       \
    static void NAME##_spans(const void *self, size_t n, sgt_rays rays, sgt_spans out)                      \
    {                                                                                                       \
        NAME##_blocks(self, n, rays, out, false, NULL);                                                     \
    }                                                                                                       \
    static void NAME##_firsts(const void *self, size_t n, sgt_rays rays, sgt_spans out)                     \
    {                                                                                                       \
        NAME##_blocks(self, n, rays, out, true, NULL);                                                      \
    }                                                                                                       \
    static void NAME##_steep_firsts(const void *self, size_t n, sgt_rays rays, sgt_spans out,               \
                                    double steep[])                                                         \
    {                                                                                                       \
        NAME##_blocks(self, n, rays, out, true, steep);                                                     \
    }                                                                                                       \
    static sgt_span NAME##_one(const void *self, const sgt_ray *ray, bool first, double *steep)             \
    {                                                                                                       \
        sgt_span a;                                                                                         \
        double single;                                                                                      \
        const sgt_vec3 *o = &ray->o, *d = &ray->d;                                                          \
        (first ? NAME##_all_firsts : NAME##_all_spans)(self, 1, &o->x, &o->y, &o->z, &d->x, &d->y, &d->z,   \
                                                       first ? &ray->tmin : NULL, &a.lo, &a.hi, &a.seed,    \
                                                       &single, steep);                                     \
        a.single = single > 0;                                                                              \
        if (first && single != 1)                                                                           \
            NAME##_unsettled(self, 1, rays_of(ray), (sgt_spans){&a.lo, &a.hi, &a.seed, &a.single}, steep,   \
                             0);                                                                            \
        return a;                                                                                           \
    }                                                                                                       \
    static sgt_span NAME##_span(const void *self, const sgt_ray *ray)                                       \
    {                                                                                                       \
        double unread;                                                                                      \
        return NAME##_one(self, ray, false, &unread);                                                       \
    }                                                                                                       \
    static sgt_span NAME##_steep_first(const void *self, const sgt_ray *ray, double *steep)                 \
    {                                                                                                       \
        return NAME##_one(self, ray, true, steep);                                                          \
    }                                                                                                       \
    static sgt_span NAME##_first(const void *self, const sgt_ray *ray)                                      \
    {                                                                                                       \
        double unread;                                                                                      \
        return NAME##_one(self, ray, true, &unread);                                                        \
    }

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

/* --------------------------------------------------------------------- cells in lanes
 *
 * The same for many cells at once, for proofs (sgt_builtin_ops.encloses): t0 is 0, and what is out of range
 * is not known.  That is NaN inside, and all numbers outside.
 *
 * ROUNDING.  Let w be the greater |tau| of a cell.  In units of the scaled direction
 *     2 (B + A tau)          is worked out in doubles, in three roundings of at most u (2 |B| + 2 |A| w).
 *                            LANE_ROUNDING = 16 u of that is subtracted and added.  So is what A.hi and B.hi
 *                            leave of A and B: their low parts and E (Aa w + Ba), E = FINE_COEFFICIENT
 *     tau (2 B + A tau)      has its extremes at the ends of the cell or at -B / A, moved into the cell.  The
 *                            quotient is off by 2 u of itself, and the parabola by |A| tau^2 (2 u)^2 there.
 *                            Each value is rounded three times, by at most u w (2 |B| + |A| w).  16 u of
 *                            that is added, and what is left of A and B as above
 *     its sum with C.hi      is rounded once, and the bound is subtracted with another rounding: 4 u of the
 *                            result is added, and what C.hi leaves of C
 * LANE_LOST is more than underflow takes from a product here, as all numbers but 0 are within 2^-300 and
 * 2^300, and tau is 0 or above 2^-900 where its products count: below it they are less than 2^-600. */
#define LANE_ROUNDING (16 * SGT_U)
#define LANE_LOST 0x1p-600

typedef struct lane_cell { two_ends g, slope; } lane_cell;

SGT_INLINE mask lane_fits(double x)
{
    double size = fabs(x);
    return MASK(x == 0) | (MASK(size > 0x1p-300) & MASK(size < 0x1p300));
}

/* o + t l. */
SGT_INLINE twofold lane_along(double o, double l, double t)
{
    return twofold_sum(twofold_of(o), two_product(t, l));
}

/* Are all products of it split exactly? */
SGT_INLINE mask lane_way(double o, double l, double t)
{
    double way = fabs(l * t);
    return lane_fits(o) & lane_fits(l) & MASK(way < 0x1p300) &
           (MASK(way > 0x1p-300) | MASK(t == 0) | MASK(l == 0));
}

/* The ray about the middle of the cell, in units of the scaled direction; tau has 0 in it.  Returns whether
 * all is known. */
SGT_INLINE mask lane_ray(fine_ray *r, sgt_vec3 o, sgt_vec3 d, double t_lo, double t_hi)
{
    double scale = scale_of(d), inverse = inverse_of_scale(d), lo = t_lo * inverse, hi = t_hi * inverse,
           mid = 0.5 * lo + 0.5 * hi;
    mid = chosen(MASK(fabs(mid) < 0x1p-300), 0, mid);
    double l = d.x * scale, m = d.y * scale, n = d.z * scale;
    r->x = lane_along(o.x, l, mid), r->y = lane_along(o.y, m, mid), r->z = lane_along(o.z, n, mid);
    r->l = l, r->m = m, r->n = n, r->inverse = inverse;
    double from = (lo - mid) - fabs(lo - mid) * 0x1p-52, to = (hi - mid) + fabs(hi - mid) * 0x1p-52;
    r->tau.lo = lesser_of(from, 0), r->tau.hi = greater_of(to, 0); /* of 2^-300 and less, mid is not inside */
    return MASK(scale > 0x1p-300) & MASK(scale < 0x1p300) & MASK(lo * scale == t_lo) &
           MASK(hi * scale == t_hi) & MASK(fabs(lo) < 0x1p300) & MASK(fabs(hi) < 0x1p300) &
           MASK(l * inverse == d.x) & MASK(m * inverse == d.y) & MASK(n * inverse == d.z) &
           lane_way(o.x, l, mid) & lane_way(o.y, m, mid) & lane_way(o.z, n, mid);
}

SGT_INLINE double moved_within(double x, double lo, double hi)
{
    x = x > lo ? x : lo; /* of a NaN: lo */
    return x < hi ? x : hi;
}

/* The least of tau (2 b + a tau) for tau in the cell, but for rounding. */
SGT_INLINE double lane_least(double a, double b, double lo, double hi)
{
    double turn = moved_within(-b / a, lo, hi), p = lo * (2 * b + a * lo), q = hi * (2 * b + a * hi),
           v = turn * (2 * b + a * turn);
    return lesser_of(lesser_of(p, q), v);
}

/* g and its slope by tau. */
SGT_INLINE void lane_parabola(const fine_parabola *p, const fine_ray *r, lane_cell *e)
{
    double lo = r->tau.lo, hi = r->tau.hi, w = greater_of(-lo, hi), a = p->A.hi, b = p->B.hi, c = p->C.hi;
    double a_err = fabs(p->A.lo) + FINE_COEFFICIENT * p->Aa, b_err = fabs(p->B.lo) + FINE_COEFFICIENT * p->Ba,
           c_err = fabs(p->C.lo) + FINE_COEFFICIENT * p->Ca;
    double aw = fabs(a) * w, left = 2.5 * (b_err + a_err * w),
           off = LANE_ROUNDING * (2 * fabs(b) + 2 * aw) + left + LANE_LOST,
           swing = w * (LANE_ROUNDING * (2 * fabs(b) + aw) + left) + 1.25 * c_err + LANE_LOST;
    double rise = greater_of(a * lo, a * hi), fall = lesser_of(a * lo, a * hi),
           least = c + lane_least(a, b, lo, hi), most = c - lane_least(-a, -b, lo, hi);
    e->slope.lo = 2 * (b + fall) - off, e->slope.hi = 2 * (b + rise) + off;
    e->g.lo = least - (swing + 4 * SGT_U * fabs(least)), e->g.hi = most + (swing + 4 * SGT_U * fabs(most));
}

/* What is told of an end: all numbers where it is not known. */
SGT_INLINE double cell_end(double end, double by, double off, mask known, double all)
{
    double x = end * by, out = x + copysign(fabs(x) * off + 2 * LANE_LEAST, all);
    return chosen(known & MASK(fabs(out) < HUGE_VAL), out, all);
}

/* Defines NAME_encloses for a surface whose cells CELL(&s, &r, &e) encloses, but for the factor FACTOR > 0,
 * which is right to 6 u.  s is of type SHARED, made of its parameters by MADE.  KNOWN: are the parameters in
 * range?  (What is local to a cell is in a function of its own: of structs in the loop itself gcc 12 makes
 * arrays, and no vector code.) */
#define LANE_CELLS(NAME, SHARED, MADE, CELL, FACTOR, KNOWN)                                                 \
    SGT_INLINE void NAME##_told(const SHARED *shared, double ox, double oy, double oz, double dx, double dy, \
                                double dz, double t_lo, double t_hi, double *lo, double *hi,                \
                                double *slope_lo, double *slope_hi)                                         \
    {                                                                                                       \
        const SHARED s = *shared;                                                                           \
        fine_ray r;                                                                                         \
        lane_cell e;                                                                                        \
        mask known = lane_ray(&r, (sgt_vec3){ox, oy, oz}, (sgt_vec3){dx, dy, dz}, t_lo, t_hi) & (KNOWN);    \
        double by = (FACTOR) * r.inverse, off = LANE_OFF(8);                                                \
        CELL(&s, &r, &e);                                                                                   \
        *lo = cell_end(e.g.lo, (FACTOR), off, known, -HUGE_VAL);                                           \
        *hi = cell_end(e.g.hi, (FACTOR), off, known, HUGE_VAL);                                            \
        *slope_lo = cell_end(e.slope.lo, by, off, known, -HUGE_VAL);                                       \
        *slope_hi = cell_end(e.slope.hi, by, off, known, HUGE_VAL);                                        \
    }                                                                                                       \
    SGT_KERNEL                                                                                              \
    static void NAME##_cells(const SHARED *shared, size_t n, const sgt_rays *rays, const double *t_lo,      \
                             const double *t_hi, const sgt_enclosures *out)                                 \
    {                                                                                                       \
        const SHARED s = *shared;                                                                           \
        const double *ox = rays->o[0], *oy = rays->o[1], *oz = rays->o[2], *dx = rays->d[0],                \
                     *dy = rays->d[1], *dz = rays->d[2];                                                    \
        double *lo = out->lo, *hi = out->hi, *slope_lo = out->slope_lo, *slope_hi = out->slope_hi;          \
        LANES for (size_t i = 0; i < n; i++)                                                                \
        {                                                                                                   \
            double a, b, c, d;                                                                              \
            NAME##_told(&s, ox[i], oy[i], oz[i], dx[i], dy[i], dz[i], t_lo[i], t_hi[i], &a, &b, &c, &d);    \
            lo[i] = a, hi[i] = b, slope_lo[i] = c, slope_hi[i] = d;                                         \
        }                                                                                                   \
    }                                                                                                       \
    static void NAME##_encloses(const void *self, size_t n, sgt_rays rays, const double *t_lo,              \
                                const double *t_hi, sgt_enclosures out)                                     \
    {                                                                                                       \
        SHARED s = MADE(self);                                                                              \
        NAME##_cells(&s, n, &rays, t_lo, t_hi, &out);                                                       \
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
