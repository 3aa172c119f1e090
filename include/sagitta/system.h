/* system.h - a ray through a row of surfaces, in the order it meets them. */
#ifndef SAGITTA_SYSTEM_H
#define SAGITTA_SYSTEM_H
#include <sagitta/sagitta.h>
#ifdef __cplusplus
extern "C" {
#endif

/* Takes local coordinates to global: p = origin + x ex + y ey + z ez.  The axes
 * are of unit length and at right angles; all-zero axes: no turn, and no cost. */
typedef struct sgt_pose { sgt_vec3 origin, ex, ey, ez; } sgt_pose;

/* The pose at `origin` whose axes are the global ones turned by Rz Ry Rx, in
 * degrees, right-handed (multiples of 90 are exact). */
SGT_API sgt_pose sgt_pose_tilted(sgt_vec3 origin, sgt_vec3 degrees);

/* Both are for later versions. */
struct sgt_aperture;
struct sgt_phase;

/* An element of a row: a surface, where it stands, what is behind it, how far it is open.
 * Members that are left zero have their defaults, so {0} but for the surface is valid: at
 * the origin, not turned, no change of index, no aperture. */
typedef struct sgt_element {
    sgt_surface surface;
    sgt_pose    pose;
    double      index;          /* refractive index behind it; SGT_MIRROR; 0: as in front */
    double      semi_diameter;  /* of the clear aperture, soft by a part in 2^44; 0, or 2^500
                                   and more: none */
    const struct sgt_aperture *aperture;  /* NULL: none.  Anything else makes this version
                                             lose the ray: SGT_LOST, SGT_INVALID */
    const struct sgt_phase    *phase;     /* NULL: none.  Anything else: the same */
    unsigned long long reserved_[6];      /* zero.  Anything else: the same */
} sgt_element;
#define SGT_MIRROR (-1.0)

/* What became of a ray at an element.  Negative is undecided, as everywhere. */
typedef enum sgt_fate {
    SGT_PASSED  =  1,
    SGT_CLIPPED =  2,    /* met outside the clear aperture, and certainly not inside; without a
                            proof, of a user's surface without `enclose`: none was found inside */
    SGT_TIR     =  3,    /* total internal reflection */
    SGT_MISSED  =  0,    /* the surface is certainly not on the ray's line */
    SGT_LOST    = -1     /* hit.status says why */
} sgt_fate;

SGT_API const char *sgt_fate_text(sgt_fate fate);  /* "passed", "clipped", "tir", ... */

/* An element as a ray met it: all in the element's own frame.
 *
 * Which ray t_err speaks of.  For the first element it is the launch ray as given, with a
 * direction of any length.  For the others it starts at hit.p of the passage before, along
 * that passage's direction: these very doubles, taken from frame to frame by the axes and
 * origins as stored.  The surface is shown that ray as rounded into its frame; what the
 * rounding does to the root is in t_err, lo, hi and p_err.  Where the ray nearly touches,
 * |n . d| < 2^-22 |n|, it is there only in part: the given ray may as well have two roots
 * near by, or none.  status, fate and what a proof says are of the rounded ray, and t_err of
 * a graze too is as good as its first order.
 * Axes that are of unit length but for rounding change lengths by 2^-51: t counts those of the
 * launch ray at the first element, and those of the element's frame behind it. */
typedef struct sgt_passage {
    sgt_hit  hit;        /* hit.t in lengths (the direction in front is of unit length) */
    sgt_vec3 direction;  /* behind the surface, of unit length; zero unless passed */
    double   opl;        /* sum of index * length from the launch to here, signed: a
                            stretch travelled backwards (t < 0) counts negative */
} sgt_passage;

/* Traces ray, the whole line of it (tmin and tmax are not read), through e[0]
 * ... e[n-1] and returns how many it passed: n is all of them.  Of the roots on
 * the line the one near the surface's own guess is meant (options.pick decides
 * otherwise); where that lies outside the clear aperture and another lies inside,
 * that one.  A proof (options.proof) is asked of each root; with SGT_PROVE_FIRST it is the only
 * one that counts within the clear aperture, or, where there is none, on the line: a ray of
 * which that cannot be said is SGT_LOST, UNPROVEN (for options.pick SGT_FIRST: as
 * sgt_intersect has it).  At return ray starts at the last point passed, in the global frame,
 * its direction of unit length; passages[i], where passages is not NULL, says how
 * element i was met, the one that stopped the ray included; fate (may be NULL)
 * says what became of the ray at last.  index_before is the refractive index in
 * front of e[0] (0: 1).  An index that is negative (but SGT_MIRROR) or not finite,
 * or a bad ray: SGT_LOST with hit.status SGT_INVALID. */
SGT_API size_t sgt_trace(size_t n, const sgt_element e[], double index_before, sgt_ray *ray,
                         sgt_passage passages[], sgt_fate *fate, const sgt_options *opt);

/* What became of many rays; arrays left NULL are not wanted. */
typedef struct sgt_traced {
    signed char *fate;      /* an sgt_fate, as sgt_trace tells it */
    int    *passed;         /* how many elements the ray passed */
    double *o[3], *d[3];    /* the ray at return, as sgt_trace leaves it; these may be the
                               arrays the rays came in.  All three of one, or none */
    double *opl;            /* at the last point passed; 0 where there is none, NaN of a bad ray */
} sgt_traced;

/* One element as many rays met it; arrays left NULL are not wanted.  Where a ray did not
 * reach the element: status SGT_MISS, evals 0, the direction zero, all else NaN. */
typedef struct sgt_passages {
    sgt_hits hits;
    double *direction[3], *opl;
} sgt_passages;

/* sgt_trace of n rays, each bit for bit the same (a NaN for a NaN).  passages, where not
 * NULL, has one entry for each element.  Returns how many rays passed all elements.  Rays are
 * taken through all elements some hundred at a time, in the processor's cache.  Where
 * options.watch is set they run one by one, in order; sgt_step.ray is the index of the ray.
 * Nothing is allocated; the stack needed is below 80 KiB. */
SGT_API size_t sgt_trace_batch(size_t elements, const sgt_element e[], double index_before, size_t n, sgt_rays rays,
                               sgt_traced out, const sgt_passages passages[], const sgt_options *opt);

#ifdef __cplusplus
}
#endif
#endif
