// SPDX-License-Identifier: MIT
/* beam.h - a box of rays through a lens as a whole: what is true of every ray in it.
 *
 * sgt_trace answers for one ray.  sgt_box_trace answers for all rays of a box: a launch
 * ray that depends on a few parameters (place in the pupil, field, wavelength, numbers of
 * the lens), each of which goes from one end to the other.  The answer is a proof:
 *
 *     PASSED    every ray of the box passes every element
 *     STOPPED   every ray ends at the one element that is named
 *     CUT       neither is certain of so large a box: divide it
 *
 * With PASSED comes where they end: point, direction and path as functions of the
 * parameters, as far as the second order, with a bound on all that this leaves out.
 *
 * Every function may run in any number of threads on the same elements.  Nothing is
 * allocated; the stack needed is below 80 KiB.
 *
 * Sources: Berz and Makino 1998 (Reliable Computing 4, 361), Makino and Berz 2003 (Int.
 * J. Pure Appl. Math. 4, 379) for Taylor models; Moore 1966 (Interval Analysis, chapter
 * 7), Krawczyk 1969 (Computing 4, 187) and Neumaier 1990 (Interval Methods for Systems
 * of Equations, chapter 5) for a root that certainly exists, and is the only one. */
#ifndef SAGITTA_BEAM_H
#define SAGITTA_BEAM_H
#include <sagitta/interval.h>
#include <sagitta/system.h>
#ifdef __cplusplus
extern "C" {
#endif

/* ---------------------------------------------------------------------- models
 *
 * A model of `n` parameters s[0] ... s[n - 1], each from -1 to 1, is the set of functions
 * x with, all over the box,
 *
 *   |x(s) - (c + sum of by[i] s[i] + sum over i <= j of pair[(i, j)] s[i] s[j])| <= rest
 *
 * pair[(i, j)] is at SGT_MODEL_PAIR(i, j).  Members of parameters that there are not are
 * 0: a model of n parameters is one of more, too.  A rest that is infinite or NaN says
 * that nothing is known of x.
 *
 * The operations below contain what they do to all members of their arguments, rounding
 * included.  If x has the width h in the parameters, what is left out of the second order
 * is of h^3. */
enum { SGT_MODEL_PARAMETERS = 8, SGT_MODEL_PAIRS = 36 /* at most, of a model */ };
#define SGT_MODEL_PAIR(i, j) /* the place of the parameters i and j in `pair` */ \
    ((i) <= (j) ? (j) * ((j) + 1) / 2 + (i) : (i) * ((i) + 1) / 2 + (j))

typedef struct sgt_model {
    double c;                           /* at the middle of the box */
    double by[SGT_MODEL_PARAMETERS];    /* slopes */
    double pair[SGT_MODEL_PAIRS];       /* of second order */
    double rest;                        /* 0 or above */
    unsigned long long reserved_[2];
} sgt_model;

/* The number x; x + e s[i], with x the middle of `range` and e half its width: the
 * parameter i going through `range`, which has to be finite.  i is below
 * SGT_MODEL_PARAMETERS. */
SGT_API sgt_model sgt_model_of(double x);
SGT_API sgt_model sgt_model_parameter(int i, sgt_interval range);

/* Any function with values in `range`. */
SGT_API sgt_model sgt_model_between(sgt_interval range);

/* A ring sector: x = r cos(a), y = r sin(a), with r parameter i going through `radius`,
 * and a parameter j, through `angle`, in radians; |angle| at most 100. */
SGT_API void sgt_model_polar(int i, sgt_interval radius, int j, sgt_interval angle,
                             sgt_model *x, sgt_model *y);

/* x + y, x y, k x, x + k, 1 / x and the square root.  The result may be an argument.  An
 * inverse of what may be 0 has no finite rest; nor has the root of what may be negative
 * or 0. */
SGT_API void sgt_model_sum(const sgt_model *x, const sgt_model *y, sgt_model *out);
SGT_API void sgt_model_difference(const sgt_model *x, const sgt_model *y, sgt_model *out);
SGT_API void sgt_model_product(const sgt_model *x, const sgt_model *y, sgt_model *out);
SGT_API void sgt_model_scaled(const sgt_model *x, double k, sgt_model *out);
SGT_API void sgt_model_plus(const sgt_model *x, double k, sgt_model *out);
SGT_API void sgt_model_inverse(const sgt_model *x, sgt_model *out);
SGT_API void sgt_model_root(const sgt_model *x, sgt_model *out);

/* All values of x over the box; all numbers if nothing is known. */
SGT_API sgt_interval sgt_model_range(const sgt_model *x);

/* The mean of x over the box, the parameters spread evenly: the integral of x by all
 * parameters over 2^n. */
SGT_API sgt_interval sgt_model_mean(const sgt_model *x);

/* x at s, of which as many are read as x has parameters that are not 0. */
SGT_API sgt_interval sgt_model_at(const sgt_model *x,
                                  const double s[SGT_MODEL_PARAMETERS]);

/* ------------------------------------------------------------------ what is traced */

/* The launch ray, global frame, as sgt_trace takes it: o is a length, d of any length.
 * The models are those of a ray in exact numbers.  A ray of doubles that is within
 * rounding of it (2^-48 of |o| and |d|) is in the answers, too.
 *
 *     parameters   1 ... SGT_MODEL_PARAMETERS.  Few are cheap: of the time of 5 to 8, 3
 *                  and 4 take a third, 1 and 2 a sixth */
typedef struct sgt_box_launch {
    int       parameters;
    sgt_model o[3], d[3];
    unsigned long long reserved_[2]; /* leave it zero */
} sgt_box_launch;

/* A number of the lens that depends on the parameters. */
typedef enum sgt_box_what {
    SGT_BOX_INDEX = 1,  /* the index behind the element, in place of e.index, whatever
                           that is unless SGT_MIRROR.  Elements behind it whose e.index is
                           0 have it as well.  which: 0.  element: SGT_BOX_BEFORE for
                           index_before */
    SGT_BOX_PER_WAVE,   /* per_wave of its phase, in place of it.  which: 0 */
    SGT_BOX_ORIGIN,     /* what is added to pose.origin; which: 0, 1, 2 for x, y, z */
    SGT_BOX_TURN,       /* a turn of the element about its own axis `which`, through its
                           origin, right-handed, in radians.  Of several axes, it is first
                           turned about x, then y, then z, as by sgt_pose_tilted */
    SGT_BOX_SURFACE     /* what is added to parameter `which` of its surface, in the order
                           of surfaces.h.  Known for conics and even aspheres: else CUT,
                           SGT_BOX_NO_BOUNDS */
} sgt_box_what;
#define SGT_BOX_BEFORE ((size_t)-1)

typedef struct sgt_box_number {
    size_t           element;   /* from 0 */
    sgt_box_what     what;
    size_t           which;
    const sgt_model *value;
    unsigned long long reserved_[2]; /* leave it zero */
} sgt_box_number;

/* The lens and what of it varies. */
typedef struct sgt_box_lens {
    size_t             elements;
    const sgt_element *e;
    double             index_before;  /* in front of e[0]; 0: 1 */
    size_t                numbers;    /* how many; 0: the lens is as it stands */
    const sgt_box_number *number;     /* in any order; of one number at most one */
    unsigned long long reserved_[2];  /* leave it zero */
} sgt_box_lens;

/* ----------------------------------------------------------------------- answers */

typedef enum sgt_box_verdict {
    SGT_BOX_PASSED  = 1,  /* all pass all elements */
    SGT_BOX_STOPPED = 0,  /* all pass the elements in front of `element`, and none it */
    SGT_BOX_CUT     = -1  /* that is not certain */
} sgt_box_verdict;

/* What a box is cut for.  NO_BOUNDS and UNSOUND stay however small it is. */
typedef enum sgt_box_why {
    SGT_BOX_NOTHING,     /* it is not cut */
    SGT_BOX_AT_EDGE,     /* some rays may be inside an aperture, and some outside */
    SGT_BOX_AT_SURFACE,  /* it is not certain that each ray meets it, at the root that is
                            meant */
    SGT_BOX_AT_BENDING,  /* some may be bent, some totally reflected or evanescent */
    SGT_BOX_AT_PLANE,    /* rays may run along the vertex plane of the element */
    SGT_BOX_TOO_LARGE,   /* the bounds are infinite */
    SGT_BOX_NO_EDGE,     /* a sag without aperture, rim or edge, whose root is far from
                            where a search begins, or steep against the rays: that it is
                            the one that is found is not certain.  A semi_diameter
                            decides it, a smaller box perhaps */
    SGT_BOX_NO_BOUNDS,   /* the surface, or the phase, has no bounds over a box of points:
                            a level set, a spindle torus, a user's without `box`; waves
                            that are not a built-in sag */
    SGT_BOX_UNSOUND      /* sgt_trace would say SGT_INVALID, or the call makes no sense */
} sgt_box_why;

/* All rays of the box at one element, in its frame. */
typedef struct sgt_box_at {
    sgt_interval x, y, z;  /* the points met */
    sgt_interval cosine;   /* of the angle of incidence, 0 ... 1 */
    sgt_interval behind;   /* of the angle behind it, refracted, 0 ... 1 */
    sgt_interval margin;   /* semi_diameter less the distance from the axis, length.  No
                              semi_diameter: infinite */
    double       items;    /* the same from the edges of the items of `aperture`: all
                              points are at least this far (length, in x and y) from
                              where one clips; 0: not known; no items: INFINITY */
    unsigned long long reserved_[3];
} sgt_box_at;

/* What became of the box. */
typedef struct sgt_box_end {
    sgt_box_verdict verdict;
    sgt_box_why     why;      /* it is cut */
    size_t          element;  /* where it was stopped or cut; PASSED: their number */
    sgt_fate        fate;     /* STOPPED: by what.  SGT_LOST: by one of `causes` */
    unsigned        causes;   /* STOPPED: the sum of 1 << fate of those that may be: rays
                                 that are not inside an aperture may be clipped or miss */
    int             divide;   /* CUT: the parameter that it is best to divide; -1: none,
                                 as the answer would be the same */
    sgt_model       p[3];     /* PASSED: in the frame of the last element, the point */
    sgt_model       d[3];     /* and the direction behind it, of unit length */
    sgt_model       opl;      /* and the optical path from the launch, length, with what
                                 phases add.  STOPPED and CUT: these are not set */
    unsigned long long reserved_[4];
} sgt_box_end;

/* Room for what boxes of one lens share, one for each element; zero before the first
 * call.  Threads have their own, or copies. */
typedef struct sgt_box_room { double kept[8]; } sgt_box_room;

/* Takes the box through the elements of the lens.
 *
 *     lens    borrowed for the length of the call
 *     launch  the rays
 *     room    lens->elements of them; NULL: the same answers, slower
 *     at      lens->elements of them, written as far as the box came, the element that
 *             stopped it, or at whose edge it is cut, included if all rays met it; NULL:
 *             not wanted
 *     out     written
 *
 * Returns out->verdict.
 *
 * WHAT IS SAID.  Of the exact rays of the doubles of the lens: of each ray whose numbers
 * are those of the models at some s in [-1, 1]^n.  And of the rays that sgt_trace
 * computes of these with default options: what a box decides has a margin of 2^-40 or
 * more at each edge, and all models have a rest that holds the rounding of such a trace
 * (where F hardly depends on t sgt_trace may stop earlier, which the t_err of its hit
 * tells: the ray is then within that).
 *   PASSED    its fate is SGT_PASSED, and point, direction and path are in p, d, opl
 *   STOPPED   its fate is one of `causes` at that element (or SGT_LOST there, if it
 *             cannot tell)
 * A user's surface is met as its own operations let sgt_trace find roots: what is said is
 * then of the exact rays, and of those for which it finds the root that there is.
 *
 * HOW FINE.  rest shrinks with the third power of the box on conics and most departures;
 * with the second power at formulas, tori and users' surfaces, of which second
 * derivatives are enclosed; with the first at borders of cells of grids (docs/notes/
 * beam.md has figures). */
SGT_API sgt_box_verdict sgt_box_trace(const sgt_box_lens *lens,
                                      const sgt_box_launch *launch, sgt_box_room room[],
                                      sgt_box_at at[], sgt_box_end *out);

/* --------------------------------------------------------------- series, for a pupil
 *
 * A series of the two parameters s and t, each from -1 to 1, is the set of functions x
 * with, all over the box,
 *
 *   |x(s, t) - sum over i + j <= SGT_SERIES_ORDER of k[(i, j)] s^i t^j| <= rest
 *
 * k[(i, j)] is at SGT_SERIES_PLACE(i, j).  All else is as said of models.  What is left
 * out is of the order h^7 in the width h: so of rays through a pupil, whose numbers are
 * smooth, one box of a series does what some thousand boxes of models do, and takes the
 * time of about eight. */

/* The order of a series, and how many numbers k it has. */
enum { SGT_SERIES_ORDER = 6, SGT_SERIES_TERMS = 28 };

/* The place in k of the number of s^i t^j; i, j at least 0, i + j <= SGT_SERIES_ORDER. */
#define SGT_SERIES_PLACE(i, j) (((i) + (j)) * ((i) + (j) + 1) / 2 + (j))

typedef struct sgt_series {
    double k[SGT_SERIES_TERMS];
    double rest;                     /* 0 or above */
    unsigned long long reserved_[3];
} sgt_series;

/* As of models.  polar: the radius is s, the angle t.  i is 0 or 1. */
SGT_API sgt_series sgt_series_of(double x);
SGT_API sgt_series sgt_series_parameter(int i, sgt_interval range);
SGT_API sgt_series sgt_series_between(sgt_interval range);
SGT_API void sgt_series_polar(sgt_interval radius, sgt_interval angle, sgt_series *x,
                              sgt_series *y);
SGT_API void sgt_series_sum(const sgt_series *x, const sgt_series *y, sgt_series *out);
SGT_API void sgt_series_difference(const sgt_series *x, const sgt_series *y,
                                   sgt_series *out);
SGT_API void sgt_series_product(const sgt_series *x, const sgt_series *y,
                                sgt_series *out);
SGT_API void sgt_series_scaled(const sgt_series *x, double k, sgt_series *out);
SGT_API void sgt_series_plus(const sgt_series *x, double k, sgt_series *out);
SGT_API void sgt_series_inverse(const sgt_series *x, sgt_series *out);
SGT_API void sgt_series_root(const sgt_series *x, sgt_series *out);
SGT_API sgt_interval sgt_series_range(const sgt_series *x);
SGT_API sgt_interval sgt_series_at(const sgt_series *x, double s, double t);

/* The mean over the box with the weight 1 + w s, |w| <= 1: over a ring sector of the
 * middle radius c and half width h, w = h / c, or 1 if it has the centre. */
SGT_API sgt_interval sgt_series_mean(const sgt_series *x, double w);

/* A ray of a box. */
typedef struct sgt_series_ray {
    sgt_series p[3], d[3];           /* a point; the direction */
    sgt_series opl;                  /* the optical path up to the point */
    unsigned long long reserved_[4];
} sgt_series_ray;

/* sgt_box_trace by series.  Its numbers of the lens may depend on s and t.
 *
 *     launch    p and d are read, as o and d of sgt_box_launch
 *     arriving  NULL, or written if the last element is reached: the ray in front of
 *               it, in its frame, d of unit length, opl from the launch to p
 *     ends      written if PASSED: as p, d and opl of sgt_box_end, which are not set */
SGT_API sgt_box_verdict sgt_series_trace(const sgt_box_lens *lens,
                                         const sgt_series_ray *launch,
                                         sgt_box_room room[], sgt_box_at at[],
                                         sgt_series_ray *arriving, sgt_series_ray *ends,
                                         sgt_box_end *out);

/* "passed", "stopped" or "cut"; and a few words for each reason.  Never NULL. */
SGT_API const char *sgt_box_verdict_text(sgt_box_verdict verdict);
SGT_API const char *sgt_box_why_text(sgt_box_why why);

#ifdef __cplusplus
}
#endif
#endif
