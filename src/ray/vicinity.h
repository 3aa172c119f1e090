/* vicinity.h - a sag where one ray meets it: the stretch of that ray along which F is monotone, whatever
 * becomes of the surface farther out.
 *
 * r^2 is convex along a ray.  So between two of its points r is at most the larger of their two, R; and a
 * surface cut off at R has the rim that makes F monotone along the chord, if the slope within R allows it
 * (departure/departure.c, THE SPAN).  Of the two points one is where a root is looked for, the seed; the
 * other is where the search begins.  A root within the chord, which begins before the search does, is then
 * the first.  Nothing is said of a ray that has no root there: it may have one farther out.  Near the seed
 * there is no second point, and a root within the chord is the one.
 *
 * WHERE THE SEARCH BEGINS.  Within R the sag is at most S, so no root is where |z| > S, and the ray may as
 * well begin where it enters |z| <= S.  Where that is nearer to the axis R is smaller, and S with it: the
 * same again.  Of a ray from afar at a lens R is soon that of the lens.
 *
 * PASSED BY.  Where the surface ends, its rings have heights (builtin.h), and a ray that is above or below
 * them on every piece of it (piece.h) meets nothing: so a ray that leaves the surface, where it has no rim.
 * Where that says too little, F is looked at all the way out (wings.c).
 *
 * FROM AFAR the surface may be so steep within R that this says nothing, and a root farther out may be the
 * first: there F is looked at, point by point, on the way in (wings.c).
 *
 * RUNGS.  What is known of the surface within R costs more than a root.  So R is rounded up, to a power of
 * two or, where that says too little, to an eighth of one, and many rays share it.  It depends on nothing
 * but the ray and the surface: a ray in a batch has the R it has alone.
 *
 * THE ROUNDING of the departure, one bound for all within a radius, is that of the eighth next to the seed:
 * high powers of r would make much more of a wider one. */
#ifndef SGT_RAY_VICINITY_H
#define SGT_RAY_VICINITY_H

#include "../surface/builtin.h"

/* What is known of a surface within some radii, each at a place of its own; radius 0: nothing is there. */
enum { VICINITIES = 16, NOISES = 32, RINGS = 64, WINGS_ROWS = 28, VICINITY_ROWS = WINGS_ROWS };
typedef struct ring { double radius, steep, bend, noise[2]; } ring;
typedef struct rings { bool any; ring of[RINGS]; } rings; /* of wings.c */
typedef struct vicinities {
    double radius[VICINITIES], noise_radius[NOISES], noise[NOISES][2];
    sgt_extent extent[VICINITIES];
    rings rings;
    bool any_heights;
    sgt_heights heights; /* of the whole surface */
} vicinities;

SGT_INLINE void vicinities_begin(vicinities *v)
{
    for (int i = 0; i < VICINITIES; i++) v->radius[i] = 0;
    for (int i = 0; i < NOISES; i++) v->noise_radius[i] = 0;
    v->rings.any = v->any_heights = false;
}

/* Of some rays, a row each.  asked: 1, else 0; of one that is asked the seed is a number.  After the call
 * it is 1 where nothing was found; 0 with lo > hi where nothing is met; else lo, hi and least are those of
 * the stretch, and the seed may be another: `least` bounds |dF/dtau| from below all along it
 * (sgt_builtin_ops, spans).  Within r^2 <= noise[2] of the axis F is off by noise[0] + noise[1] r^2
 * (sgt_shared), where that is known.  What was spent is added to evals, and told, of a row by itself,
 * unless that is NULL. */
typedef struct vicinity {
    const double *tmin, *tmax;
    double *seed, *asked, *lo, *hi, *least, *noise[3], *evals, budget;
    tally *told;
    double *work[VICINITY_ROWS];
} vicinity;

/* What the departure adds to the rounding of F at a point of that r^2, unless that is much nearer to the
 * axis than the radius that it is known for; the base's is `roundings` of bare_of. */
SGT_INLINE double vicinity_noise(double e0, double e1, double most2, double r2)
{
    return ((r2 <= most2) & (r2 >= 0.25 * most2)) ? 1.01 * sgt_fma(e1, r2, e0) : (double)NAN;
}

SGT_INLINE sgt_shared bare_of(sgt_shared s)
{
    s.noise[0] = s.noise[1] = 0, s.most2 = HUGE_VAL;
    return s;
}

/* Of a surface that has extent_within, `whole` being what it shares; the ends of the rays are explicit. */
void sgt_vicinity_of(sgt_surface s, size_t n, sgt_rays rays, bool near, const sgt_shared *whole,
                     vicinities *kept, const vicinity *v);

#endif
