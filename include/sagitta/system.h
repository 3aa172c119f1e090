/* system.h - rays through a row of surfaces, in the order given: a lens.
 *
 * Every function may run in any number of threads on the same elements.  Nothing is
 * allocated. */
#ifndef SAGITTA_SYSTEM_H
#define SAGITTA_SYSTEM_H
#include <sagitta/sagitta.h>
#ifdef __cplusplus
extern "C" {
#endif

/* -------------------------------------------------------------------- elements */

/* Takes local coordinates to global: p = origin + x ex + y ey + z ez. */
typedef struct sgt_pose {
    sgt_vec3 origin;      /* length */
    sgt_vec3 ex, ey, ez;  /* axes: of unit length and at right angles.  All zero: no turn,
                             and no cost */
} sgt_pose;

/* The pose at `origin` whose axes are the global ones turned by Rz Ry Rx.  The angles are
 * in degrees, right-handed.  Multiples of 90 are exact. */
SGT_API sgt_pose sgt_pose_tilted(sgt_vec3 origin, sgt_vec3 degrees);

/* For later versions: see sgt_element. */
struct sgt_aperture;
struct sgt_phase;

/* The index of a mirror.  Indices stay positive behind it. */
#define SGT_MIRROR (-1.0)

/* A surface in a row.  Members that are left zero have their defaults: at the origin, not
 * turned, the index as in front, no aperture.  Example:
 *
 *     sgt_conic front = {.c = 1 / 22.0}, back = {.c = -1 / 435.0};
 *     sgt_element lens[] = {
 *         {.surface = {&sgt_conic_ops, &front}, .index = 1.62, .semi_diameter = 9.5},
 *         {.surface = {&sgt_conic_ops, &back}, .pose = {.origin = {0, 0, 3}}, .index =
 *         1},
 *     };
 */
typedef struct sgt_element {
    sgt_surface surface;        /* parameters in the element's own frame */
    sgt_pose    pose;           /* of that frame */
    double      index;          /* refractive index behind it, above 0 and finite.
                                   SGT_MIRROR: it reflects.  0: as in front */
    double      semi_diameter;  /* of the clear aperture, length; soft by a part in 2^44.
                                   0, or 2^500 and more: none */

    /* For later versions, that may give them a meaning.  Leave them zero.  If one is not,
     * a ray that comes to this element is SGT_LOST with hit.status SGT_INVALID. */
    const struct sgt_aperture *aperture;
    const struct sgt_phase    *phase;
    unsigned long long         reserved_[6];
} sgt_element;

/* What became of a ray at an element.  Negative is undecided, as everywhere. */
typedef enum sgt_fate {
    SGT_PASSED  =  1,
    SGT_CLIPPED =  2,  /* met outside the clear aperture and certainly not inside it.  For
                          a user's surface without `enclose`, and without a proof: no root
                          was found inside */
    SGT_TIR     =  3,  /* total internal reflection */
    SGT_MISSED  =  0,  /* the surface is certainly not on the ray's line */
    SGT_LOST    = -1   /* hit.status says why */
} sgt_fate;

/* "passed", "clipped", "tir", "missed" or "lost". */
SGT_API const char *sgt_fate_text(sgt_fate fate);

/* ------------------------------------------------------------------- one ray */

/* An element as a ray met it, in the element's own frame.
 *
 * WHICH RAY t_err IS ABOUT.  For the first element it is the launch ray as given, with a
 * direction of any length.  For the others it is the ray from hit.p of the passage
 * before, along the direction of that passage: these very doubles, taken from frame to
 * frame by the axes and origins as stored.  The surface is shown that ray as rounded into
 * its frame.  What the rounding does to the root is in t_err, lo, hi and p_err.
 *
 * WHERE IT IS LESS.  If the ray nearly touches, |n . d| < 2^-22 |n|, that effect is
 * included only in part: the given ray may as well have two roots nearby, or none.
 * status, fate and what a proof says are about the rounded ray.  t_err of a graze, too,
 * is as good as its first order.
 *
 * LENGTHS.  Axes that are of unit length but for rounding change lengths by 2^-51.  At
 * the first element t is in the lengths of the launch ray, at the others in those of the
 * element's frame. */
typedef struct sgt_passage {
    sgt_hit  hit;        /* hit.t is a length: the direction in front is of unit length */
    sgt_vec3 direction;  /* behind the surface, of unit length; zero unless passed */
    double   opl;        /* the sum of index * length from the launch to here.  A stretch
                            travelled backwards (t < 0) is negative */
} sgt_passage;

/* Traces a ray through e[0] ... e[n-1] in this order.  Returns how many elements it
 * passed: n is all of them.
 *
 *     ray           in: the launch ray.  The whole line of it is traced; tmin and tmax
 *                   are not read.  At return: it starts at the last point passed, in the
 *                   global frame, with a direction of unit length
 *     index_before  the refractive index in front of e[0]; 0: 1
 *     passages      NULL, or room for n.  passages[i] says how element i was met, the one
 *                   that stopped the ray included
 *     fate          NULL, or what became of the ray at last
 *     opt           NULL, or the options
 *
 * WHICH ROOT.  Of the roots on the line the one near the surface's own guess is meant
 * (options.pick decides otherwise).  The guess is span.seed.  A user's surface without
 * one is met nearest the point of the line that is nearest the origin of its frame.  If
 * that root lies outside the clear aperture and another lies inside, that one is meant.
 *
 * A PROOF (options.proof) is asked for at each root.  With SGT_PROVE_FIRST the root has
 * to be the only accepted one within the clear aperture; without an aperture, on the
 * line.  A ray for which that cannot be said is SGT_LOST, UNPROVEN.  (With options.pick
 * SGT_FIRST it is as sgt_intersect has it.)
 *
 * SGT_LOST with hit.status SGT_INVALID: a bad ray; an index that is negative (but
 * SGT_MIRROR) or not finite; an element with a member for later versions that is not
 * zero. */
SGT_API size_t sgt_trace(size_t n, const sgt_element e[], double index_before,
                         sgt_ray *ray, sgt_passage passages[], sgt_fate *fate,
                         const sgt_options *opt);

/* ------------------------------------------------------------------ many rays */

/* What became of many rays.  An array that is NULL is not wanted. */
typedef struct sgt_traced {
    signed char *fate;    /* an sgt_fate, as sgt_trace tells it */
    int    *passed;       /* how many elements the ray passed */
    double *o[3], *d[3];  /* the ray at return, as sgt_trace leaves it.  These may be the
                             arrays the rays came in.  Give all three of one, or none */
    double *opl;          /* at the last point passed; 0: there is none; NaN: a bad ray */
} sgt_traced;

/* One element as many rays met it.  An array that is NULL is not wanted.  If a ray did
 * not reach the element: status SGT_MISS, evals 0, the direction zero, all else NaN. */
typedef struct sgt_passages {
    sgt_hits hits;
    double  *direction[3], *opl;
} sgt_passages;

/* sgt_trace of n rays, each bit for bit the same (a NaN for a NaN).  Returns how many
 * rays passed all elements.  passages: NULL, or one entry for each element.
 *
 * Rays are taken through all elements some hundred at a time, in the processor's cache.
 * If options.watch is set, they run one by one, in order; sgt_step.ray is then the index
 * of the ray.  Nothing is allocated; the stack needed is below 80 KiB. */
SGT_API size_t sgt_trace_batch(size_t elements, const sgt_element e[],
                               double index_before, size_t n, sgt_rays rays,
                               sgt_traced out, const sgt_passages passages[],
                               const sgt_options *opt);

#ifdef __cplusplus
}
#endif
#endif
