// SPDX-License-Identifier: MIT
/* wings.h - a march through the wings of a sag, or along its chord with the rim (wings.c), and the rungs of
 * radii. */
#ifndef SGT_RAY_WINGS_H
#define SGT_RAY_WINGS_H

#include "../num/lanes.h"

#include "vicinity.h"

#include <string.h>

enum { FINER = 47, FINE = 49, COARSE = 52 };

/* The next rung above r.  digits: COARSE, a power of two; FINE, an eighth of one; FINER, a thirty-second.
 * Infinite if r >= 2^400; never below 2^-400. */
SGT_INLINE double rung_above(double r, int digits)
{
    unsigned long long bits, unit = 1ULL << digits;
    double above = larger(r, 0x1p-401);
    memcpy(&bits, &above, sizeof bits);
    bits = (bits & ~(unit - 1)) + unit;
    memcpy(&above, &bits, sizeof above);
    return chosen(MASK(r < 0x1p400), above, HUGE_VAL);
}

/* The last rung that is not above r; 0 outside of that range. */
SGT_INLINE double rung_below(double r, int digits)
{
    unsigned long long bits;
    if (!(r >= 0x1p-400 && r < 0x1p400)) return 0;
    memcpy(&bits, &r, sizeof bits);
    bits &= ~((1ULL << digits) - 1);
    memcpy(&r, &bits, sizeof r);
    return r;
}

/* Not below the distance of the point at t from the axis.  If the ray comes from afar, x and y are known
 * to an ulp of their terms. */
SGT_INLINE double radius_at(double ox, double oy, double dx, double dy, double t)
{
    double tl = t * dx, tm = t * dy, x = ox + tl, y = oy + tm;
    return sqrt(x * x + y * y) + 0x1p-51 * ((fabs(ox) + fabs(tl)) + (fabs(oy) + fabs(tm)));
}

/* The place at which the rung is kept. */
SGT_INLINE int place_of(double rung, int digits, int places)
{
    unsigned long long bits;
    memcpy(&bits, &rung, sizeof bits);
    return (int)((bits >> digits) % (unsigned)places);
}

/* Is the profile asked of this row first?  It is if the ray leaves the surface, and, if `far` is set, if it
 * begins sixteen times as far from the axis as its seed is. */
SGT_INLINE bool sgt_early(const sgt_rays *r, const vicinity *v, const double *from, bool far, size_t i)
{
    double t = v->seed[i], x = r->o[0][i] + t * r->d[0][i], y = r->o[1][i] + t * r->d[1][i],
           x0 = r->o[0][i] + from[i] * r->d[0][i], y0 = r->o[1][i] + from[i] * r->d[1][i];
    bool leaves = (from[i] > v->tmin[i]) | !(t >= v->tmin[i]),
         afar = !(x0 * x0 + y0 * y0 < 256 * (x * x + y * y));
    return (v->asked[i] > 0) & (leaves | (afar & far));
}

/* Asks the profile of the rows that are sgt_early, from `from` on.  Moves `from` to a t before which nothing
 * is met. */
void sgt_begin_by_profile(sgt_surface s, size_t n, const sgt_rays *r, double *from, vicinities *kept,
                          const vicinity *v);

/* Marches along each row that is asked, from `from` on, and answers in v.  The rows of `from` may be among
 * those of v->work.  If the surface has an edge, only the rows that begin behind the seed are asked
 * (behind), or only the others.  Evaluations are counted in v, and told if v has a watcher. */
void sgt_march_wings(sgt_surface s, size_t n, sgt_rays rays, const double *from, bool behind,
                     const sgt_shared *bare, vicinities *kept, const vicinity *v);

/* Can the chord with the rim be marched along? */
SGT_INLINE bool marches_chord(const sgt_shared *whole)
{
    return whole->radius2 < HUGE_VAL && whole->steep < HUGE_VAL && whole->bent.hi < HUGE_VAL &&
           whole->noise[0] + whole->noise[1] < HUGE_VAL;
}

/* Marches along each row that is asked, from `from` on, as far as somewhat beyond the seed or the vertex
 * plane, within a box about that stretch.  Answers in v, as above; without a root nothing is found.  asked is
 * set to -1 where F is monotone all along, and nothing was evaluated. */
void sgt_march_box(sgt_surface s, size_t n, sgt_rays rays, const double *from, const sgt_shared *bare,
                   vicinities *kept, const vicinity *v);

/* The seed, or the middle of the chord, or NaN if no part of the ray is in it. */
SGT_INLINE double chord_seed(double seed, double lo, double hi, double tmin, double tmax)
{
    double from = larger(lo, tmin), to = hi < tmax ? hi : tmax, middle = 0.5 * from + 0.5 * to;
    return fabs(seed) < HUGE_VAL || !(from < to && fabs(middle) < HUGE_VAL) ? seed : middle;
}

/* May a ray start on a sag?  One that begins higher above the vertex plane than half of its distance from the
 * axis comes from elsewhere, as a rule. */
SGT_INLINE bool starts_low(sgt_vec3 o, double tmin)
{
    return tmin == 0 && fabs(o.z) <= 0.5 * (fabs(o.x) + fabs(o.y));
}

/* May a ray start on the surface, and is the bound on its slope so much less than the slope that rounding of
 * F may be more than the rule of the start?  Such a ray is marched, although it has one root at most. */
SGT_INLINE bool starts_weakly(sgt_vec3 o, sgt_vec3 d, double tmin, double least)
{
    return starts_low(o, tmin) && least > 0 && least < 0.25 * fabs(d.z) * scale_of(d);
}

/* Is the start a better seed than this one, for a ray with one root at most?  It is that root, mostly, if the
 * ray starts low, and so near the seed that the departure may be what is between them. */
SGT_INLINE mask starts_at_root(sgt_vec3 o, sgt_vec3 d, double tmin, double seed)
{
    const double low = fabs(o.x) + fabs(o.y); /* as in starts_low */
    return MASK(tmin == 0) & MASK(fabs(o.z) <= 0.5 * low) &
           MASK(fabs(seed) * (fabs(d.x) + fabs(d.y) + fabs(d.z)) < 0x1p-6 * low);
}

/* Marches along the chord of each row that is asked, within [v->lo, v->hi], and answers in v, as above.  A
 * ray without a root in it is a miss. */
void sgt_march_chord(sgt_surface s, size_t n, sgt_rays rays, const sgt_shared *whole, const vicinity *v);

#endif
