// SPDX-License-Identifier: MIT
/* vicinity.h - the part of a sag that one ray needs: the stretch of the ray along which F is monotone,
 * whatever the surface does farther out.
 *
 * THE IDEA.  r^2 is convex along a ray.  So between two points of the ray r is at most the larger of the
 * two, R.  A surface cut off at R has a rim, and with it F may be monotone along the chord, if the slope
 * within R is small enough (departure/departure.c, THE SPAN).  One of the two points is the seed, where a
 * root is looked for.  The other is where the search begins.  If the chord begins before the search does,
 * a root within the chord is the first root.  If there is no root in the chord, nothing is known: there
 * may be one farther out.  For the root near the seed there is no second point, and a root within the
 * chord is the answer.
 *
 * WHERE THE SEARCH BEGINS.  Within R the sag is between two heights.  No root is below or above both, and the
 * search may begin where the ray comes between them.  If that point is nearer to the axis, R is smaller, and
 * the heights are closer: repeat.  For a ray from afar at a lens R soon becomes the radius of the lens.
 *
 * A MISS.  If the surface ends, its rings have heights (builtin.h).  A ray that is above or below them on
 * every piece of it (piece.h) misses.  This decides rays that leave a surface without a rim.  If it says
 * too little, F is looked at all the way out (wings.c).
 *
 * LEAVING.  A ray with tmin = 0 may start on the surface, within the heights of a circle R about its
 * start.  Let |F'| be at least a > 0 along the chord in that circle, by its slope.  It is at most 2 |n| -
 * a there.  So F has one root in the chord at most.  If |F| at the origin, with all that is rounded, is at
 * most f, that root lies within f / a of the start.  It is not accepted if that times 2 |n| - a is less
 * than 0.98 of the reach of the rule of the start (accept.h).  The reach is that of the terms T at the
 * start; they are asked for at the root, which is within e = 2^-48 T / (2 |n| - a), and change by less:
 * - Let S bound the slope in the circle.  As |n| - S sqrt(l^2 + m^2) is a > 0, the change of x, y and z adds
 *   2.5 |n| e at most, which is less than 2^-46 T.
 * - That of the gradient: the circle is 0.125 r wider than the start is far from the axis.  For terms of
 *   order k the second derivative is 8 k S / r at most in its middle (Bernstein's inequality for the
 *   gradient on the line), and for a base 11 S / r, as it is defined at 1.125 r.  It adds less than
 *   12 k |n| e, or 2^-44 k T.
 * - Rounding of the gradient moves the terms by no more than 32 times what it does to F (proof.c), and that
 *   is less than 2^-48 T here.
 * Wide bounds on rounding make f great, and so nothing is dropped that could be told from the start.  So
 * nothing is met up to the end of the chord.  From there on r grows.  In one unit of tau it grows by
 * sqrt(l^2 + m^2) at most, and the height by |n|: the cone of asphere/unique.c begins at the end of the
 * chord, and no ring matters that lies within R.  A ray that is above or below the cone's height in all
 * others is a miss, after one look.  If f is too great for that, nothing is said here.  Of the rest a later
 * beginning is known: the first piece of the ray that is neither above nor below its ring.
 *
 * FROM AFAR the surface may be so steep within R that the chord says nothing, and a root farther out may
 * be the first.  There F is looked at, point by point, on the way in (wings.c).
 *
 * WITHIN A RIM all this is known of the whole surface.  The ray is followed along its chord with the rim at
 * once (wings.c): a ray that grazes the surface, or enters a bowl from the side.
 *
 * A MIRROR WITHOUT A RIM, in grazing incidence, has no circle in which it is gentle: the rays come from a
 * thousand lengths along it, and across them it ends after sixty.  So it is followed through a box (wings.c),
 * and also where it may begin on the mirror.
 *
 * AHEAD.  A toroid, a biconic and a grid without a rim know what is ahead of a ray
 * (surface/departure/ahead.c): nothing, or a stretch with one root at most, which Newton's steps are left to
 * find, with looks beside it.  They are asked of rays that leave the surface, that have no seed, and that no
 * circle has decided: eight at once, and those that need more steps than most side by side again.
 *
 * THE PROFILE.  A q_con, q_bfs or odd asphere without a rim has a table of its profile (profile.c).  It is
 * asked first of rays that leave the surface, and of those that begin so far out that no circle says
 * anything; of others where the circle says too little.  It is made when the first ray needs it.
 *
 * RUNGS.  To know the surface within R costs more than a root.  So R is rounded up to a power of two or,
 * if that says too little, to an eighth of one; and many rays share it.  It depends on nothing but the ray
 * and the surface: a ray in a batch has the same R as by itself.
 *
 * THE ROUNDING of the departure has one bound for all points within a radius.  It is taken at the eighth
 * of a power of two next above the seed's radius, as high powers of r make much more of a wider one. */
#ifndef SGT_RAY_VICINITY_H
#define SGT_RAY_VICINITY_H

#include "profile_table.h"
#include "tail.h"

/* What is known of a surface within some radii, each at a place of its own; radius 0: the place is empty. */
enum { BOXES = 16, VICINITIES = 16, NOISES = 32, RINGS = 80, RINGS_FEW = 28, ALONGS = 4, WINGS_ROWS = 29,
       VICINITY_ROWS = WINGS_ROWS, VICINITY_MOST = 64 /* rays at a time */ };
typedef struct ring { double radius, steep; sgt_interval bent; double noise[2]; } ring;
typedef struct rings { bool any; ring of[RINGS]; } rings; /* of wings.c */
typedef struct rings_few { bool any; ring of[RINGS_FEW]; } rings_few;
typedef struct box { double x, y, steep; sgt_by_axis axis; double noise[2]; bool noisy; } box;
/* Of sgt_extent, what the stretch is made of; low and high are its z. */
typedef struct known_part { double radius2, steep, low, high, steep_x, steep_y; } known_part;
typedef struct vicinities {
    /* A sag with a profile has its table in place of boxes, and of most rings. */
    union {
        struct { rings rings; box boxes[BOXES]; };
        struct { rings_few few; sgt_profile_table table; };
    };
    double radius[VICINITIES], noise_radius[NOISES], noise[NOISES][2];
    known_part part[VICINITIES];
    sgt_tails tails;
    bool any_heights, any_boxes, any_bent, any_along, any_table, has_table;
    sgt_interval bent; /* within the rim */
    double along[ALONGS][2]; /* of along.c */
    sgt_heights heights; /* of the whole surface */
} vicinities;

/* For the root near the seed: what is known of an element within some radii, at a place each (radius 0: the
 * place is empty).  A trace keeps that of its first elements for all tiles.  shares: `shared` is set. */
enum { SLOPES = 8 };
typedef struct slopes {
    double radius[SLOPES], radius2[SLOPES], steep[SLOPES];
    bool shares;
    sgt_shared shared;
} slopes_known;

SGT_INLINE void slopes_begin(slopes_known *s)
{
    for (int i = 0; i < SLOPES; i++) s->radius[i] = 0;
    s->shares = false;
}

/* What is worked out once for a batch: what the surface shares, and what is known of parts of it. */
typedef struct memo {
    bool begun; /* set by who reads the rest first */
    slopes_known near;
    vicinities kept;
} memo;

SGT_INLINE void vicinities_begin(vicinities *v)
{
    for (int i = 0; i < VICINITIES; i++) v->radius[i] = 0;
    for (int i = 0; i < NOISES; i++) v->noise_radius[i] = 0;
    v->rings.any = v->tails.any = v->any_heights = v->any_boxes = v->any_bent = v->any_along = false;
    v->any_table = false;
}

SGT_INLINE void memo_begin(memo *m) { m->begun = true, slopes_begin(&m->near), vicinities_begin(&m->kept); }

/* Some rays, a row each.
 *
 *     asked, before    1: to be looked at, and the seed is a number, but for asks_ahead; 0: not
 *     lo, hi, before   of a surface with a rim: the span, read for the rows that are asked
 *     asked, after     1: nothing was found
 *                      0, lo > hi: a miss
 *                      0, lo <= hi: [lo, hi] is the stretch, `least` a lower bound on |dF/dtau| all along it
 *                      (sgt_builtin_ops, spans), and the seed may have been changed
 *
 * At r^2 <= noise[2] from the axis the departure adds noise[0] + noise[1] r^2 to the rounding of F
 * (sgt_shared); NaN where that is not known (sgt_noise_at).  Evaluations spent are added to evals.  If `told`
 * is not NULL there is one row only, and its watcher is told of them.  work: scratch rows. */
typedef struct vicinity {
    const double *tmin, *tmax;
    double *seed, *asked, *lo, *hi, *least, *noise[3], *evals, budget;
    const double *begun; /* what evals is before; NULL: 0 */
    double *clear; /* NULL, or raised, where nothing was found, to a t up to which no root is accepted (tmin
                    * is the start all the same) */
    tally *told;
    double *work[VICINITY_ROWS];
} vicinity;

SGT_INLINE sgt_shared bare_of(sgt_shared s)
{
    s.noise[0] = s.noise[1] = 0, s.most2 = HUGE_VAL;
    return s;
}

/* May a row without a seed be asked?  Only what is ahead of it is. */
SGT_INLINE bool asks_ahead(const sgt_shared *whole, bool near) { return !near && whole->ahead; }

/* Fills v.  s has extent_within; `whole` is what it shares; the ends of the rays are explicit.  near: NULL if
 * the first root is wanted, and not that near the seed. */
void sgt_vicinity_of(sgt_surface s, size_t n, sgt_rays rays, slopes_known *near, const sgt_shared *whole,
                     vicinities *kept, const vicinity *v);

/* Is no root accepted on the ray, as `ahead` has it (sgt_shared)? */
bool sgt_nothing_ahead(sgt_surface s, const sgt_ray *ray);

/* The heights of the whole surface. */
SGT_INLINE const sgt_heights *heights_about(sgt_surface s, vicinities *kept)
{
    if (!kept->any_heights) s.ops->own_->heights(s.self, &kept->heights);
    kept->any_heights = true;
    return &kept->heights;
}

/* At least the gradient of the sag at this point, and about it. */
double sgt_steep_about(sgt_surface s, double x, double y, vicinities *kept);

#endif
