// SPDX-License-Identifier: MIT
/*
 * sagitta.h - where does a ray meet a surface, and how sure is the answer?
 *
 * A surface is a function F of a point, with F(p) = 0 on the surface.  Along a ray
 * p(t) = o + t d that is one equation in one unknown, g(t) = F(o + t d) = 0, with the
 * slope g'(t) = grad F . d.  sagitta solves it by Newton's method inside a bracket that
 * only ever shrinks.  The gradient is used as it comes and is never normalised.
 *
 * A root is a t with g(t) = 0.  It is *accepted* if it lies between the ends of the ray
 * and within the rim of the surface, and is not the root at the start (see sgt_ray).
 *
 * Five rules hold everywhere:
 *   - Zero means default.  {0} and NULL options are valid and sensible.
 *   - Structs do not change their size.  What a later version adds takes room from
 *     `reserved_`, the last member.  Leave it zero in what you fill in: {0} and
 *     designated initialisers do.  In what the library fills in it is zero, so a member
 *     that this library does not know yet reads as 0.  (docs/api_rules.md, "How the
 *     interface grows")
 *   - NaN means undefined.  A surface answers NaN where it does not exist.
 *   - Nothing is allocated, nothing is global, nothing is printed.  Parameters are
 *     borrowed for the length of the call.  So every function may run in any number of
 *     threads on the same surface.
 *   - Rounding must be to nearest (the C default) while a function of the library runs.
 */
#ifndef SAGITTA_SAGITTA_H
#define SAGITTA_SAGITTA_H

#include <stdbool.h>
#include <stddef.h>

/* On Windows a program says nothing of DLLs: one header serves the DLL and the static
 * library.  With a dllimport &sgt_conic_ops would not be a constant, and no table of
 * surfaces could be static.  Without it the linker of mingw-w64 finds the table in the
 * DLL ("auto-import"), and the start-up code enters its address.  Functions go through
 * the import library.  src/meson.build says what the DLL exports. */
#if !defined(SGT_API)
#if defined(__GNUC__) && !defined(_WIN32) && !defined(__CYGWIN__)
#define SGT_API __attribute__((visibility("default")))
#else
#define SGT_API
#endif
#endif

/* An enumeration of one byte, of which a batch writes arrays. */
#if !defined(SGT_ONE_BYTE) && defined(__GNUC__)
#define SGT_ONE_BYTE __attribute__((__packed__))
#elif !defined(SGT_ONE_BYTE)
#error "define SGT_ONE_BYTE to what makes an enumeration one byte long"
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* --------------------------------------------------------------- version */

/* The version of this header.  SGT_VERSION is one number, for #if and for comparison:
 * 10000 major + 100 minor + patch, so 300 is 0.3.0. */
#define SGT_VERSION_MAJOR 0
#define SGT_VERSION_MINOR 3
#define SGT_VERSION_PATCH 0
#define SGT_VERSION \
    (10000 * SGT_VERSION_MAJOR + 100 * SGT_VERSION_MINOR + SGT_VERSION_PATCH)

/* The version of the library that the program runs with: as text ("0.3.0", constant,
 * never NULL), and as a number like SGT_VERSION.  It may be later than the header's. */
SGT_API const char *sgt_version(void);
SGT_API int         sgt_version_number(void);

/* ------------------------------------------------------------ arithmetic */

/* What is wrong with the arithmetic of the calling thread: 0, or a sum of these. */
typedef enum sgt_arithmetic_fault {
    SGT_FLUSHES = 1,            /* results below 2.2e-308 become zero (flush-to-zero) */
    SGT_DENORMALS_ARE_ZERO = 2, /* numbers below 2.2e-308 are read as zero */
    SGT_NOT_TO_NEAREST = 4      /* rounding is not to nearest */
} sgt_arithmetic_fault;

/* Every bound of this library takes each operation as rounded to nearest, and small
 * numbers as they are (IEEE 754-2019, sections 4.3.1 and 3.3: roundTiesToEven, gradual
 * underflow).  Two things change that for a thread: fesetround, and -Ofast or -ffast-math
 * when a program or a library is LINKED with them (gcc then sets flush-to-zero as it is
 * loaded).  Then no bound holds, and nothing is proven.
 *
 * The functions of this library do not look, and print nothing.  So ask once in each
 * thread that traces, after all libraries are loaded; threads begin with what the thread
 * that makes them has.  sgt_check, the command and the package for Python ask by
 * themselves.  It costs a few nanoseconds. */
SGT_API int sgt_arithmetic(void);

/* Names the faults in `arithmetic`, an answer of sgt_arithmetic, in a few words.  Of 0 it
 * says that there is none.  Constant, never NULL. */
SGT_API const char *sgt_arithmetic_text(int arithmetic);

/* ---------------------------------------------------------------- errors */

/* What is wrong with a call.
 *
 * ONE WAY.  What became of a ray is a status, of each ray by itself.  All else that may
 * be wrong is reported as follows: the function returns false or NULL, and sets the
 * sgt_error that its last parameter points to (NULL: not wanted).  You need not set it
 * before the call, and may read it only after a failure.  SGT_INVALID is a status, as it
 * is about a ray; sgt_explain_intersect, sgt_explain_trace and sgt_explain_aim put it
 * into words.  A function that you write and the library calls returns a constant text,
 * or NULL if nothing is wrong.
 *
 * Texts end with a zero.  One that is too long is cut; of a file the end is kept. */
typedef struct sgt_error {
    char   file[256];   /* empty: none is to blame */
    size_t line;        /* of the file, from 1; 0: no line */
    size_t column;      /* of a text that is not in a file: the first character that is
                           wrong, from 1, in bytes; 0: no character is to blame */
    char   key[128];    /* the record, key or member, such as "CD"; may be empty */
    char   words[1400]; /* a sentence without a full stop */
    unsigned long long reserved_[4];
} sgt_error;

/* ------------------------------------------------------------------ rays */

typedef struct sgt_vec3 { double x, y, z; /* of a point or a direction */ } sgt_vec3;

/* The points o + t d with tmin <= t <= tmax.
 *
 * UNITS.  o and d are in the length unit of the surface.  d may have any length but
 * zero.  t is in lengths of d.
 *
 * ENDS.  tmin and tmax are taken as they stand, with one exception: both 0, as {0} leaves
 * them, mean the half-line that begins at o, tmax = INFINITY.  So if you give tmin alone,
 * give INFINITY as well.  If you compute tmax, make the ray by sgt_ray_between, which
 * takes ends as they stand: a tmax that comes out as 0 beside a tmin of 0 would mean
 * INFINITY here.  -INFINITY and INFINITY mean the whole line.  At tmax a root is accepted
 * if its computed t is at most tmax.
 *
 * THE START.  The root at the start itself is not accepted: a finite tmin stands for
 * "leave the surface you may be on".  Precisely, a root t is not accepted if
 *     t <= tmin + t_err + 2^-48 (|x Fx| + |y Fy| + |z Fz|) / |grad F . d| + 2^-50 |t|,
 * the products taken at the root.  If each coordinate of a point on the surface is off by
 * up to 16 ulps, the root of a ray from there is at most that far from tmin.  A root
 * within 2^-1000 (length) of the start is also the start: all products may be 0 there.
 * Where the gradient nearly vanishes, rounding hides how large the bound is.  If a root
 * may be the one at the start, it is then UNPROVEN; it is never dropped.
 * To get the root at the start, give tmin = -INFINITY or a tmin a little less than
 * zero. */
typedef struct sgt_ray {
    sgt_vec3 o;     /* origin, length; finite */
    sgt_vec3 d;     /* direction; finite, its largest component not subnormal or 0 */
    double   tmin;  /* lengths of d; below INFINITY */
    double   tmax;  /* lengths of d; tmin ... INFINITY.  Both +0: INFINITY (ENDS) */
} sgt_ray;

/* The points o + t d with tmin <= t <= tmax, whatever these are.  With tmin = tmax, such
 * as 0 and 0, the only point is the start, so that no root is accepted.  (It stores a
 * tmax of 0 as -0, which is the same number.) */
SGT_API sgt_ray sgt_ray_between(sgt_vec3 o, sgt_vec3 d, double tmin, double tmax);

/* The numbers from lo to hi; interval.h computes with them. */
typedef struct sgt_interval { double lo, hi; } sgt_interval;

/* Many rays: one array for each number of sgt_ray.  Ends that are given are taken as they
 * stand, as by sgt_ray_between, also 0 and 0. */
typedef struct sgt_rays {
    const double *o[3], *d[3];
    const double *tmin;  /* NULL: 0 */
    const double *tmax;  /* NULL: INFINITY */
} sgt_rays;

/* -------------------------------------------------------------- surfaces */

/* Where on a ray a surface can be met.  lo > hi: the ray misses it. */
typedef struct sgt_span {
    double lo, hi;  /* no root lies outside [lo, hi]; lengths of d, may be infinite */
    double seed;    /* a good first guess, or NaN */
    bool   single;  /* promises at most one root in [lo, hi], at which F changes sign.
                       Then the first root found is the first, and equal signs at both
                       ends prove a miss */
} sgt_span;

/* Many points, many values, many spans: one array for each number. */
typedef struct sgt_points { const double *p[3]; } sgt_points;
typedef struct sgt_values { double *f, *grad[3]; } sgt_values;
typedef struct sgt_spans { double *lo, *hi, *seed; bool *single; } sgt_spans;

/* Many enclosures: the intervals of g, [lo, hi], and of its slope. */
typedef struct sgt_enclosures { double *lo, *hi, *slope_lo, *slope_hi; } sgt_enclosures;

/* What a surface can do.  `self` is the pointer of sgt_surface, `p` is a point (length).
 *
 * Only `value` is required.  Each further function makes the solver faster or its answer
 * surer.
 *
 * The table grows at its end from version to version.  Use designated initialisers, in
 * this order in C++: {.name = "torus", .value = torus_value}. */
typedef struct sgt_surface_ops {
    /* How long this table is, in bytes.  0, the default: the table of version 0.2, whose
     * last member is `by_parameter`.  A program that offers a member of a later version
     * sets sizeof(sgt_surface_ops); members beyond `size` are not read.  If it is not 0
     * and less than the table of version 0.2, a user's surface is SGT_INVALID. */
    size_t size;

    /* The built-in surfaces' own; leave it NULL. */
    const struct sgt_builtin_ops *own_;

    /* For messages; may be NULL. */
    const char *name;

    /* F(p), or NaN where F is not defined.  If grad is not NULL, *grad is set to the
     * gradient, not normalised.  F may have any unit: it may be a distance or not. */
    double (*value)(const void *self, sgt_vec3 p, sgt_vec3 *grad);

    /* A bounding volume and a guess, as seen along one ray.  Read only o and d of the
     * ray: the solver cuts the answer to [tmin, tmax] itself.
     * NULL: the whole ray, without a guess; see sgt_intersect for ends at infinity. */
    sgt_span (*span)(const void *self, const sgt_ray *ray);

    /* A bound on |computed F(p) - exact F(p)|, with p taken as exact; in units of F.
     * NULL: all answers are about F as computed, not about the exact F. */
    double (*rounding)(const void *self, sgt_vec3 p);

    /* A radius about p (length) within which the surface certainly is not.  Where F is
     * NaN, a radius within which F has no zero.  Zero, less, or NaN: nothing is known. */
    double (*clearance)(const void *self, sgt_vec3 p);

    /* A guess at that radius, without any promise.  Used only if dt_min > 0. */
    double (*estimate)(const void *self, sgt_vec3 p);

    /* An interval that contains g(t) = F(o + t d), and in *slope (never NULL) one that
     * contains g'(t), over the whole of t: of the exact F, with all that your arithmetic
     * here rounds.  interval.h helps to write it.  t is finite, in lengths of d.  Read
     * only o and d of the ray.
     *   - Either interval may be as wide as it must be.  -INFINITY to INFINITY says
     *     nothing, and so does a NaN.
     *   - lo > hi: F is undefined all over t, and so has no zero there.
     *   - A slope with two finite ends also says that F is defined and continuous all
     *     over t.  Where it may not be, return a slope with an end at infinity.
     * The ray need not be the caller's: for a distant origin it is the same line from an
     * origin nearby. */
    sgt_interval (*enclose)(const void *self, const sgt_ray *ray, sgt_interval t,
                            sgt_interval *slope);

    /* `value` at n points, to the last bit: F, and the gradient if grad[0] is not NULL
     * (the other two are then not NULL either).  Batches are fast if the compiler can
     * make vector code of its loop. */
    void (*values)(const void *self, size_t n, sgt_points p, sgt_values out);

    /* `span` of n rays, to the last bit.  Only o and d are given; no output is NULL. */
    void (*spans)(const void *self, size_t n, sgt_rays rays, sgt_spans out);

    /* `span`, narrowed to the first accepted root on [tmin, tmax] of the ray.  Read tmin
     * and tmax here; tmax may be infinite.
     * If `single` is set, [lo, hi] contains at most one root, F changes sign there, and
     * if that root is not accepted then no root on the ray is.  If `single` is not set,
     * the answer promises nothing, and the solver uses `span`.  It also uses `span` if
     * it does not settle in the stretch that `first` gives.
     * It is called only if the first root is wanted.  It makes convex bodies as quick to
     * meet as sags. */
    sgt_span (*first)(const void *self, const sgt_ray *ray);

    /* `first` of n rays, to the last bit.  tmin and tmax are given; no output is NULL. */
    void (*firsts)(const void *self, size_t n, sgt_rays rays, sgt_spans out);

    /* The next three are for derivatives (sensitivity.h).
     * The second derivatives of F at n points: xx, xy, xz, yy, yz, zz.  No array is
     * NULL. */
    void (*second)(const void *self, size_t n, sgt_points p, double *const out[6]);

    /* How many parameters F has derivatives by.  For built-in surfaces their order is
     * given in surfaces.h. */
    size_t (*parameters)(const void *self);

    /* dF / d(parameter j), j < parameters(self), and its gradient by the point, at n
     * points.  grad[0] may be NULL: the gradient is not wanted. */
    void (*by_parameter)(const void *self, size_t j, size_t n, sgt_points p,
                         sgt_values out);

    /* From here on members are of version 0.3, and read only if `size` covers them.
     *
     * `enclose` for n cells at once.
     *
     *     n           how many cells
     *     rays        the ray of each cell; one ray may have many.  Only o and d are
     *                 given
     *     t_lo, t_hi  cell i is [t_lo[i], t_hi[i]], both finite, in lengths of d
     *     out         the intervals; slope_lo and slope_hi NULL: slopes are not wanted
     *
     *   - The promises are those of `enclose`, which has to be offered as well.  The
     *     intervals may be other ones: wider, or narrower.
     *   - The answer for a cell does not depend on the other cells, nor on its place
     *     among them, to the last bit (of an interval that is not a NaN).
     * The solver searches for first roots by it, of one ray and of many side by side,
     * unless the surface has `first`, or the span is single and no proof is asked for.
     * Such a root is proven, whatever options.proof is, and as sharp as rounding allows
     * (t_tol is not read).  Grazes and roots beside an end of the ray are left to
     * `enclose`. */
    void (*encloses)(const void *self, size_t n, sgt_rays rays, const double *t_lo,
                     const double *t_hi, sgt_enclosures out);

    /* F all over a box of points, for boxes of rays (beam.h).
     *
     *     at        x, y and z of the points, length; ends may be infinite, or one number
     *     f         written: contains F of every point
     *     gradient  written: each derivative contains that of every point
     *     second    written: the same of the second derivatives: xx, xy, xz, yy, yz, zz
     *
     * All are of the exact F, with all that your arithmetic here rounds; interval.h helps
     * to write it.  An interval may be as wide as it must be; -INFINITY to INFINITY says
     * nothing.  true: F is defined all over the box, and twice differentiable, where the
     * intervals are finite.  false: it may not be; then only f is read, of the points
     * where F is defined, and lo > hi says that it is nowhere. */
    bool (*box)(const void *self, const sgt_interval at[3], sgt_interval *f,
                sgt_interval gradient[3], sgt_interval second[6]);
} sgt_surface_ops;

/* A surface: what it can do, and its parameters (borrowed). */
typedef struct sgt_surface {
    const sgt_surface_ops *ops;
    const void            *self;
} sgt_surface;

/* --------------------------------------------------------------- answers */

/* Positive: met, at hit.t.  Zero: certainly not met.  Negative: undecided.
 * One byte, alone and in arrays: `sgt_status status[n]` is what sgt_hits takes. */
typedef enum SGT_ONE_BYTE sgt_status {
    SGT_HIT       =  1,  /* F changes sign at t: through zero, or in a jump, but not at a
                            pole */
    SGT_GRAZE     =  2,  /* |F| is within its rounding all over [lo, hi], and no change of
                            sign is certain: the ray touches there, as far as can be told.
                            (Or it lies in the plane: then t is where it starts, or where
                            it enters the rim) */
    SGT_MISS      =  0,  /* F has no accepted root on the ray */
    SGT_UNPROVEN  = -1,  /* no root was found and none was excluded; or one was found, but
                            it is uncertain whether it is accepted */
    SGT_UNDEFINED = -2,  /* the search ended in a region where F is NaN */
    SGT_EXHAUSTED = -3,  /* max_evals was spent, and no proof was asked for.  [lo, hi] is
                            what was left to search.  In sgt_root t is the best point
                            so far */
    SGT_STOPPED   = -4,  /* the watcher asked to stop */
    SGT_INVALID   = -5   /* the input makes no sense:
                            - a direction that is zero, subnormal or not finite;
                            - an origin that is not finite;
                            - a NaN end, tmin > tmax, tmin = INFINITY, tmax = -INFINITY;
                            - no `value`, or a table of operations that is too short;
                            - a built-in surface with a parameter that is NaN or infinite,
                              or with a negative semi_diameter;
                            - an option that is NaN or negative;
                            - a member for later versions that is not zero.
                            sgt_explain_intersect says which */
} sgt_status;

/* An answer.  If status is zero or negative, t is NaN, unless sgt_status says
 * otherwise. */
typedef struct sgt_hit {
    sgt_status status;
    int        evals;   /* evaluations of F spent; the same with and without a watcher */
    double     t;       /* the root, in lengths of d */
    double     t_err;   /* |t - root| <= t_err, in lengths of d.  On built-in surfaces a
                           bound by error analysis.  On a user's an estimate that trusts
                           `rounding` */
    double     t_lo;    /* t + t_lo is as close to the root as the method can tell: nearer
                           than t by itself if the origin is far */
    double     lo, hi;  /* the stretch of the ray that the status is about, in lengths of
                           d.  Of a root: t +- t_err, rounded outward.  Of an undecided
                           first root: the first stretch that is not decided.  No accepted
                           root lies before it; behind it was not searched */
    double     f;       /* F at p, as `value` gives it.  NaN if rounding has put p outside
                           the domain (the equator of a sphere) */
    sgt_vec3   p;       /* the point (length).  Not o + t d but better, from local
                           coordinates */
    sgt_vec3   n;       /* the gradient of F at p, not normalised */
    double     p_err;   /* the point on the surface is within p_err of p (length) */
    unsigned long long reserved_[2];
} sgt_hit;

/* "hit", "graze", "miss", "unproven", "undefined", "exhausted", "stopped" or "invalid".
 * Never NULL; "?" for any other number. */
SGT_API const char *sgt_status_text(sgt_status status);

/* --------------------------------------------------------------- solving */

/* How the t of an evaluation was chosen. */
typedef enum sgt_move {
    SGT_SEED,     /* the first guess, or an end of the search */
    SGT_MARCH,    /* the next step along the ray */
    SGT_NEWTON,   /* a Newton step */
    SGT_BISECT,   /* the middle of the bracket */
    SGT_RETREAT,  /* back from a NaN, toward a point where F is known to be defined */
    SGT_PROBE     /* beside a root, to see F change sign */
} sgt_move;

/* "seed", "march", "newton", "bisect", "retreat" or "probe". */
SGT_API const char *sgt_move_text(sgt_move move);

/* What was evaluated. */
typedef enum sgt_step_kind {
    SGT_AT_POINT,  /* F and its slope at t */
    SGT_OVER_CELL  /* bounds on F and on its slope, all over [lo, hi] */
} sgt_step_kind;

/* One evaluation, as a watcher sees it.  All t are in lengths of d, on the caller's ray.
 *
 * ROUNDING OF t.  A search has an origin of its own on the ray: near the surface, at its
 * seed, or at an end of the ray.  So t, lo and hi are rounded by at most 2^-50 times the
 * largest of |t|, |lo|, |hi|, the distances to these places and that from o to the
 * frame's origin.  The last point of a hit is that of the answer: t is hit.t, f is hit.f,
 * `slope` is by hit.n, and lo and hi are t -+ t_err.  Somewhere between lo and hi F and
 * its slope have exactly these values.
 *
 *     member            at a point                     over a cell
 *     t                 the point                      the middle of the cell
 *     f, slope          F and dF/dt there, as `value`  NaN: F was not evaluated
 *                       gives them; NaN where F is
 *                       not defined
 *     lo, hi            the bracket, or what is left   the ends of the cell; the same
 *                       of the search                  number if it is a single t
 *     f_lo, f_hi        both f                         F is nowhere outside of them.
 *                                                      -INFINITY, INFINITY: not known;
 *                                                      NaN: F is nowhere defined
 *     slope_lo,         both slope                     the same of dF/dt
 *     slope_hi
 *
 */
typedef struct sgt_step {
    size_t        ray;     /* its index in a batch; 0 for a single ray */
    int           eval;    /* from 1 */
    sgt_move      move;    /* how t, or the cell, was chosen */
    sgt_step_kind kind;
    double        t;
    double        f;
    double        slope;
    double        lo, hi;
    double        f_lo, f_hi;
    double        slope_lo, slope_hi;
    unsigned long long reserved_[4];
} sgt_step;

/* Called once for each evaluation; data is options.watch_data.  Nonzero: stop. */
typedef int sgt_watch(void *data, const sgt_step *step);

/* Which root is the answer, if a ray has several? */
typedef enum sgt_pick {
    SGT_PICK_DEFAULT,  /* the first in sgt_intersect, near the seed in sgt_trace */
    SGT_FIRST,         /* the smallest t: what an eye sees */
    SGT_NEAR_SEED      /* the root that the surface's own guess leads to (for a sag, the
                          crossing of the vertex plane): what a lens designer means */
} sgt_pick;

/* What must be proven before a status may be positive or zero?
 *
 * What cannot be proven, and what max_evals ends, is UNPROVEN, with [lo, hi] the stretch
 * that is left.  So is a root if rounding hides on which side of the rim (semi_diameter)
 * it lies.  A GRAZE says what it always says, and not that there is a root.
 *
 * A proof is by error analysis or by intervals (interval.h), and trusts no estimate.  It
 * is available for built-in surfaces, and for a user's that offers `enclose`.  Without
 * `enclose` a hit is UNPROVEN under either proof, with lo and hi about the root that was
 * seen. */
typedef enum sgt_proof {
    SGT_ESTIMATE,     /* no more than what sgt_intersect promises */
    SGT_PROVE_ROOT,   /* exactly one root of F lies in [t - t_err, t + t_err] */
    SGT_PROVE_FIRST   /* and no accepted root lies before it.  With SGT_NEAR_SEED: and no
                         other accepted root lies on the ray at all; [lo, hi] is then
                         about all of them.  In traces "on the ray" is the chord of the
                         clear aperture, if there is one; the aperture itself is a
                         comparison of computed numbers.  A level set has only first
                         roots, whatever `pick` says.  A MISS is proven too */
} sgt_proof;

/* All zero is the default.  A NaN or a negative number is SGT_INVALID. */
typedef struct sgt_options {
    double     t_tol;       /* stop when t is known to this, in lengths of d; 0: to
                               rounding.  t_err is a bound all the same.  On a level set
                               roots closer together than this may be reported as one;
                               under a proof level sets do not read it */
    double     f_tol;       /* stop when |F| is at most this; 0: never on |F| alone.  Read
                               for a user's surface and by sgt_root only */
    double     dt_min;      /* the least step of a march, in lengths of d; 0: as
                               sgt_intersect says.  On level sets (julia, mandelbrot) a
                               number above 0 asks for the fast way: no proof, and thin
                               parts may be skipped.  The built-in sags do not read it */
    int        max_evals;   /* give up on a root after this many evaluations; 0: 2000.  A
                               root found by then is still confirmed, by one more */
    sgt_pick   pick;        /* which root */
    sgt_proof  proof;       /* what must be proven */
    sgt_watch *watch;       /* called once for each evaluation; NULL: nobody */
    void      *watch_data;  /* its first argument */
    unsigned long long reserved_[2]; /* leave it zero */
} sgt_options;

/* The hit that options.pick asks for.  opt may be NULL.
 *
 * BUILT-IN SURFACES.  Every status is certain, by running error analysis.  It is about
 * the surface whose parameters are exactly the stored doubles, and the ray whose doubles
 * are given.  What cannot be decided is UNPROVEN.
 * The exception is a level set with dt_min > 0.  It is marched in steps of the larger of
 * `estimate` and dt_min.  A ray on which no change of sign is seen is UNPROVEN, unless it
 * misses the set's ball.
 * sgt_proof says what options.proof adds.
 *
 * A USER'S SURFACE.  How certain is it that a hit is the first, and that a miss is one?
 *   - If the surface offers span.single or enclose, it is certain.
 *   - If it offers clearance, it is certain, except in stretches below dt_min (0: 2^-20
 *     of the stretch searched).
 *   - If it offers none of these, or with `estimate` and dt_min > 0, it is not certain.
 *     The hit is then the first that a march can see.  Its steps are dt_min (0: 1/64 of
 *     the stretch), or the estimate if that is larger.
 * If a march sees no root, the answer is UNPROVEN if one of its steps was uncertain,
 * else MISS.
 * Newton's step never lengthens a step of a march.
 *
 * ENDS AT INFINITY, of a user's surface without `enclose`.  If tmax is infinite, steps
 * are as above while the ray is nearer to the origin of the surface's frame than its
 * start.  Behind that come 128 more, each longer than the last by half.  So far out the
 * rounding of the point may make F zero, and the answer is then a graze.  If tmin is
 * -INFINITY, there is no first root to find: the answer is UNPROVEN.  Give a span with
 * two ends.
 *
 * Iteration counts may change between versions.  What a status means may not. */
SGT_API sgt_hit sgt_intersect(sgt_surface s, sgt_ray ray, const sgt_options *opt);

/* Many answers: one array for each number of sgt_hit.  An array that is NULL is not
 * wanted and not written.  Of p and of n give all three arrays or none. */
typedef struct sgt_hits {
    sgt_status *status;
    int        *evals;
    double     *t, *t_err, *t_lo;
    double     *p[3], *n[3];
    double     *p_err;
    unsigned long long reserved_[2]; /* leave it zero: else every ray is SGT_INVALID */
} sgt_hits;

/* One hit for each of n rays.  Returns the number of positive statuses.
 *
 *     n     how many rays; each array of rays and hits has n numbers
 *     rays  o is a length, tmin and tmax are in lengths of d
 *     hits  written, in the units of sgt_hit
 *     opt   NULL, or the options
 *
 * Each answer is the one that sgt_intersect would give, bit for bit (a NaN for a NaN),
 * whatever its neighbours are and whatever the processor.  No ray changes the
 * answer of another.
 *
 * Outputs must not overlap the rays or each other.  Nothing is allocated.  The stack
 * needed is below 80 KiB (a few KiB more if the library was built without optimisation).
 *
 * If options.watch is set, the rays run one by one, in order.  sgt_step.ray is then the
 * index of the ray.  A watcher that asks to stop, stops that ray.
 *
 * Built-in surfaces are fast, and so is a user's that offers `values`; with `spans` it is
 * faster still.  Without `values` a user's `value` is called point by point.  If a first
 * root has to be searched for by clearance, enclose or estimate, the rays are answered
 * one by one; with `encloses` many together. */
SGT_API size_t sgt_intersect_batch(sgt_surface s, size_t n, sgt_rays rays, sgt_hits hits,
                                   const sgt_options *opt);

/* Many rays and answers in single precision: one array for each number of sgt_ray and of
 * sgt_hit. */
typedef struct sgt_rays_f {
    const float *o[3], *d[3];
    const float *tmin;  /* NULL: 0 */
    const float *tmax;  /* NULL: INFINITY */
} sgt_rays_f;

typedef struct sgt_hits_f {
    sgt_status *status;
    float      *t, *t_err;
    float      *p[3], *n[3];
    float      *p_err;
    unsigned long long reserved_[2]; /* leave it zero: else every ray is SGT_INVALID */
} sgt_hits_f;

/* As sgt_intersect_batch, for rays and answers of floats: less memory, and twice as many
 * rays in a register.  The surface is that of the doubles of its parameters, and the ray
 * that of the floats given, exactly.
 *
 *   - The status is the one that sgt_intersect_batch gives to the same ray in double.
 *   - |t - root| <= t_err, and the surface is within p_err of p: certain, as in double.
 *     t_err is some 2^-23 |t| or more; t_tol allows more, and never asks for less.
 *   - n is within some 2^-15 of its length; no bound is told.
 *
 * Planes, conics and even aspheres with a semi_diameter are met in float arithmetic.  A
 * ray that is not certainly met so (a miss, a graze, a root beside the rim or the start)
 * is asked in double, as is every ray of another surface; that costs more than
 * sgt_intersect_batch.  A t or p beyond the largest float is that float with the sign,
 * and its bound is INFINITY.  An n beyond it is infinite.
 *
 * The same bits whatever the neighbours and the processor.  Outputs must not overlap the
 * rays or each other.  Nothing is allocated; the stack needed is below 96 KiB. */
SGT_API size_t sgt_intersect_batch_f(sgt_surface s, size_t n, sgt_rays_f rays,
                                     sgt_hits_f hits, const sgt_options *opt);

/* Why do sgt_intersect and its kin answer SGT_INVALID to these?  opt, hits and error may
 * be NULL: no options, none of a batch, not wanted.  false: `error` names the first
 * argument that makes no sense.  A member for later versions that is not zero is named by
 * its place in `reserved_`: the program was compiled for a later version, and asks for
 * what this one does not have.  true: nothing is wrong. */
SGT_API bool sgt_explain_intersect(sgt_surface s, const sgt_ray *ray,
                                   const sgt_options *opt, const sgt_hits *hits,
                                   sgt_error *error);

/* Every hit, in order of t.  Returns how many there are: 0 is a miss.  Returns
 * SGT_INVALID (negative) where sgt_intersect would say so.
 *
 *     cap   how many entries `hits` has room for; no more are written
 *     hits  written; may be NULL if cap is 0
 *     opt   NULL, or the options; `pick` is not read
 *
 * An entry is one of these:
 *   - a root.  The ray enters if n . d < 0 (F falls) and leaves if n . d > 0;
 *   - a graze, as one entry;
 *   - a stretch of the ray that could not be decided.  It has a negative status and
 *     stands in its place in the order.  t +- t_err, that is [lo, hi], covers it.  p, n
 *     and f are NaN.
 * Outside the entries there is no root, wherever sgt_intersect would be certain of that.
 * A march that is not certain reports the roots it sees, and not what it may have skipped
 * between and behind them.  If it sees none, it reports the whole stretch as UNPROVEN.
 *
 * max_evals is spent on each root anew.  All roots together may spend 1024 times as much.
 * Where it runs out, or where the watcher stops the search, the rest of the ray is the
 * last entry, EXHAUSTED or STOPPED. */
SGT_API int sgt_intersect_all(sgt_surface s, sgt_ray ray, int cap, sgt_hit hits[],
                              const sgt_options *opt);

/* --------------------------------------------------------------- leaving */

/* sgt_leave follows a ray that starts where another has met the surface: reflected,
 * refracted, straight on, or toward a lamp.  It finds the next crossing.  You choose no
 * offset to push the ray off the surface.  A start is a hit and a direction:
 *
 *     sgt_start on = {.p = hit.p, .n = hit.n, .p_err = hit.p_err, .d = d};
 *     sgt_crossing next = sgt_leave(surface, &on, NULL);
 *
 * The surface is within p_err of p.  The ray begins at a point o of the surface, within
 * p_err and 4 ulps (of the largest coordinate) of p.  The root at o is not accepted.  If
 * the rule of sgt_ray covers how far p may be off, o is p.  If no point of the surface is
 * found so near, o is p as well; then a root just beside it may be accepted. */
typedef struct sgt_start {
    sgt_vec3 p;      /* length; finite */
    sgt_vec3 n;      /* the gradient of F there, or a multiple of it; zero: not known */
    double   p_err;  /* length; 0 or more, finite */
    sgt_vec3 d;      /* as in sgt_ray */
    double   tmax;   /* lengths of d.  0: INFINITY.  For an end at 0 itself give -0 */
    unsigned long long reserved_[2]; /* leave it zero: else the answer is SGT_INVALID */
} sgt_start;

/* The next crossing. */
typedef struct sgt_crossing {
    sgt_hit hit;   /* as sgt_intersect gives it of `ray`.  Of an even asphere numbers may
                      differ by what t_err allows, and evals too */
    sgt_ray ray;   /* from o along d; hit.t counts from o.  tmin is 0.  If rounding hides
                      the root at o, tmin is somewhat more; no other root is before it */
    int     side;  /* 1 or -1: the sign of F between the start and hit.t; of a miss, right
                      behind the start.  0: the sign is not certain, or the hit is
                      undecided */
    unsigned long long reserved_[2];
} sgt_crossing;

/* The first accepted root behind the start.  opt may be NULL; its pick is not read.
 *
 * THE SIDE.  1 and -1 are certain where the status is (sgt_intersect).  From a start
 * inside the rim, F has that sign along the ray up to the hit; of a miss, as long as the
 * ray is inside the rim.  So read inside or outside from the sign; do not count
 * crossings.  On a user's surface without `rounding`, F is trusted as computed.  Your
 * p_err is trusted too: of a start farther off the surface that misses, the side may be
 * the one that a start on the surface would have.
 *
 * A MARCH by steps (a user's surface without `enclose`) may skip roots.  If the slopes at
 * start and hit say that an odd number was skipped, the hit is UNPROVEN (t_tol 0).  An
 * even number, and any number before a miss, is not noticed.
 *
 * AT A TANGENT, where d lies in the tangent plane, the start may be one root or two.
 * Roots within the rule of sgt_ray are dropped together, and the side is that behind
 * them.  If a root may lie farther off, and that cannot be decided, the hit is
 * UNPROVEN, with the stretch in hit.lo and hit.hi. */
SGT_API sgt_crossing sgt_leave(sgt_surface s, const sgt_start *from,
                               const sgt_options *opt);

/* Many starts: one array for each number of sgt_start. */
typedef struct sgt_starts {
    const double *p[3], *n[3]; /* n[0] NULL: not known */
    const double *p_err;       /* NULL: 0 */
    const double *d[3];
    const double *tmax;        /* NULL: INFINITY.  Unlike in sgt_rays a 0 is INFINITY as
                                  well; -0 is an end at 0 */
    unsigned long long reserved_[2]; /* leave it zero: else all are SGT_INVALID */
} sgt_starts;

/* sgt_leave of n starts, bit for bit.  Returns the number of positive statuses.
 *
 *     n     how many starts; each array of from, hits and side has n numbers
 *     from  p and p_err are lengths, tmax is in lengths of d
 *     hits  written, in the units of sgt_hit
 *     side  written: 1, -1 or 0 as in sgt_crossing; NULL: not wanted
 *     opt   NULL, or the options; `pick` is not read
 *
 * t counts from o, which is not an output: p + t d is off from the hit by up to p_err and
 * 4 ulps.  Take the point from hits.p, or call sgt_leave to get o.  Outputs must not
 * overlap the starts or each other.  All else is as in sgt_intersect_batch, except the
 * stack, which is below 150 KiB. */
SGT_API size_t sgt_leave_batch(sgt_surface s, size_t n, sgt_starts from, sgt_hits hits,
                               signed char *side, const sgt_options *opt);

/* Why does sgt_leave answer SGT_INVALID?  As sgt_explain_intersect: false, and `error`
 * names the first argument that makes no sense: "from.p_err", say. */
SGT_API bool sgt_explain_leave(sgt_surface s, const sgt_start *from,
                               const sgt_options *opt, const sgt_hits *hits,
                               sgt_error *error);

/* ------------------------------------------------- the solver, by itself */

/* What the solver keeps between steps.  Not for programs: its members may change.  Its
 * size does not. */
struct sgt_root_private {
    double g_lo, g_hi;                   /* g at lo and hi; NaN: not known */
    double last, g_last;                 /* the last t at which g was defined, its g */
    double step, step_before;            /* the last step and the one before */
    double candidate, width;             /* of a probe: where, how far to each side */
    double hole;                         /* the last t at which g was NaN */
    double t_tol, f_tol;
    int    budget;                       /* of evaluations */
    int    sign_lo, sign_hi, sign_last;  /* of g; 0: not certain */
    int    sign_left, sign_right;        /* of g beside the candidate; 0: not yet known */
    int    side;                         /* the side of the candidate that is asked for */
    int    overshoots, bisections, retreats, sampled;
    int    quick, probes;                /* quick form: its stage, looks beside a root */
    bool   bracketed, single, done;
    double first, least, own;            /* first |g|, a bound on |g'|, more rounding */
    double reserved[11];
};

/* Newton in a bracket, turned inside out: it never calls you.  Evaluate g and g' at r.t,
 * hand them over, and repeat while it asks for more.  Example:
 *
 *     double g, dg;
 *     sgt_root r = sgt_root_begin((sgt_span){.lo = 0, .hi = 2, .seed = 1}, NULL);
 *     do g = cos(r.t), dg = -sin(r.t); while (sgt_root_next(&r, g, dg));
 *
 * It looks for one root in [span.lo, span.hi].  The slope may be wrong, zero, infinite or
 * NaN: that costs evaluations and nothing else.  Of the options it reads t_tol, f_tol and
 * max_evals.  It ends with one of these:
 *   SGT_HIT      g changes sign within t_err of t.  Or |g| <= f_tol, if f_tol is given:
 *                t_err is then twice what |g| and the slope make it
 *   SGT_GRAZE    |g| <= g_err at t, and no certain change of sign is near
 *   SGT_MISS     one sign at both ends, and span.single
 *   SGT_UNPROVEN, SGT_UNDEFINED, SGT_EXHAUSTED   as everywhere
 *   SGT_INVALID  lo > hi, a NaN end, or a bad option: already at begin, and the first
 *                sgt_root_next returns false
 * A pole at which g changes sign is a root to this solver: look at |g|. */
typedef struct sgt_root {
    double     t;       /* where to evaluate next; at the end the answer */
    double     lo, hi;  /* the bracket */
    double     t_err;   /* the error of t, as above */
    int        evals;   /* how many evaluations it has been given so far */
    sgt_move   move;    /* how t was chosen */
    sgt_status status;  /* at the end: how it ended */
    double     g_err;   /* how far g may be off; set by you before a step.  0: exact */
    struct sgt_root_private private_;
} sgt_root;

/* The start: where to evaluate first.  opt may be NULL. */
SGT_API sgt_root sgt_root_begin(sgt_span span, const sgt_options *opt);

/* Takes g and g' at r->t.  true: evaluate at the new r->t.  false: r->status is final. */
SGT_API bool sgt_root_next(sgt_root *r, double g, double slope);

#ifdef __cplusplus
}
#endif
#endif /* SAGITTA_SAGITTA_H */
