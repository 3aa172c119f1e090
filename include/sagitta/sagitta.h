/*
 * sagitta.h - where does a ray meet a surface, and how sure is the answer?
 *
 * A surface is a function F with F(p) = 0 on it.  Along a ray p(t) = o + t d
 * that is one equation in one unknown, g(t) = F(o + t d) = 0, with the slope
 * g'(t) = grad F . d; sagitta solves it by Newton's method, with the gradient
 * as it comes (never normalised), inside a bracket that only ever shrinks.
 *
 * Three rules hold everywhere in this header:
 *   - zero means default: {0} and NULL options are valid and sensible;
 *   - NaN means undefined: a surface answers NaN where it does not exist;
 *   - nothing is allocated, nothing is global, nothing is printed, and
 *     parameters are borrowed for the length of the call: every function may
 *     run in any number of threads on the same surface.  Rounding must be to
 *     nearest (the C default) while a function of the library runs.
 */
#ifndef SAGITTA_SAGITTA_H
#define SAGITTA_SAGITTA_H

#include <stdbool.h>
#include <stddef.h>

/* On Windows a program says nothing of DLLs: one header serves the DLL and the static
 * library.  With a dllimport &sgt_conic_ops would be no constant, and no table of surfaces
 * could be static.  Without it the linker of mingw-w64 finds the table in the DLL
 * ("auto-import") and the start-up code enters its address; functions go through the import
 * library.  What the DLL exports is said when it is linked (src/meson.build). */
#if !defined(SGT_API)
#if defined(__GNUC__) && !defined(_WIN32) && !defined(__CYGWIN__)
#define SGT_API __attribute__((visibility("default")))
#else
#define SGT_API
#endif
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* --------------------------------------------------------------- version */

/* The version of this header.  SGT_VERSION is one number, for #if and for comparison:
 * 10000 major + 100 minor + patch, so 200 is 0.2.0. */
#define SGT_VERSION_MAJOR 0
#define SGT_VERSION_MINOR 2
#define SGT_VERSION_PATCH 0
#define SGT_VERSION \
    (10000 * SGT_VERSION_MAJOR + 100 * SGT_VERSION_MINOR + SGT_VERSION_PATCH)

/* The version of the library that the program runs with, as text ("0.2.0") and as the
 * number SGT_VERSION.  It may be a later one than that of the header.  The text is
 * constant and never NULL. */
SGT_API const char *sgt_version(void);
SGT_API int         sgt_version_number(void);

/* ------------------------------------------------------------------ rays */

typedef struct sgt_vec3 { double x, y, z; } sgt_vec3;

/* The points o + t d, t in [tmin, tmax].  o and t d are in the length unit of
 * the surface; d may have any length but zero, and t counts in lengths of d.
 * tmax = 0 with tmin >= 0 stands for infinity, so that {0} ends is the half-line;
 * -INFINITY and INFINITY are the whole line.
 *
 * The root at the start itself does not count: a finite tmin stands for "leave
 * the surface you may be on".  Precisely, a root t does not count where
 *     t <= tmin + t_err + 2^-48 (|x Fx| + |y Fy| + |z Fz|) / |grad F . d| + 2^-50 |t|,
 * the products taken at the root: no farther from tmin than 16 ulps in each
 * coordinate of a point on the surface can put it.  Where rounding hides how far that
 * is (the gradient nearly vanishes), a root that it may be is UNPROVEN, never dropped.
 * Give tmin = -INFINITY, or a tmin a little less than zero, to have such a root.  At tmax a root counts if
 * its computed t is at most tmax. */
typedef struct sgt_ray { sgt_vec3 o, d; double tmin, tmax; } sgt_ray;

typedef struct sgt_interval { double lo, hi; } sgt_interval;

/* Many rays: one array per number.  tmin left NULL is 0, tmax left NULL is INFINITY. */
typedef struct sgt_rays { const double *o[3], *d[3], *tmin, *tmax; } sgt_rays;

/* -------------------------------------------------------------- surfaces */

/* Where on a ray a surface can be met: no root lies outside [lo, hi], which may
 * be infinite; seed is a good first guess, or NaN; single promises that there is
 * at most one root and that F changes sign at it, so that the first one found is
 * the first and that two ends of one sign are a proof of a miss.  lo > hi: the
 * ray passes by. */
typedef struct sgt_span { double lo, hi, seed; bool single; } sgt_span;

/* Many points, many answers, many spans: the same names, one array per number. */
typedef struct sgt_points { const double *p[3]; } sgt_points;
typedef struct sgt_values { double *f, *grad[3]; } sgt_values;
typedef struct sgt_spans { double *lo, *hi, *seed; bool *single; } sgt_spans;

/* What a surface can do.  Only `value` is required; each further answer a
 * surface can give makes the solver faster, or its answer surer.  The list grows
 * at its end: use designated initialisers. */
typedef struct sgt_surface_ops {
    /* How long this table is, in bytes.  0, the default: it ends with by_parameter, the last
     * member of version 0.2.  To offer a member that is marked as later, set it to
     * sizeof(sgt_surface_ops); members beyond `size` are not read.  A number that is not 0
     * and less than the table of 0.2 makes a surface of a user SGT_INVALID. */
    size_t size;

    /* The built-in surfaces' own; leave it NULL. */
    const struct sgt_own *own_;

    const char *name;

    /* F(p), NaN where F is not defined, and its gradient - not normalised -
     * where grad is not NULL.  Any length unit: F may be a distance or not. */
    double (*value)(const void *self, sgt_vec3 p, sgt_vec3 *grad);

    /* A bounding volume and a guess, seen along one ray.  Only o and d are to be
     * read: the solver cuts the answer to [tmin, tmax] itself.  Absent: the whole
     * ray, without a guess; sgt_intersect says what is made of ends at infinity. */
    sgt_span (*span)(const void *self, const sgt_ray *ray);

    /* A bound on |computed F(p) - exact F(p)|, p taken as exact.  Without it, all
     * that is said is said of F as computed. */
    double (*rounding)(const void *self, sgt_vec3 p);

    /* A distance (length) from p within which the surface certainly is not.  Zero,
     * less, or NaN: nothing can be said.  At a point where F is not defined it is the
     * distance within which F is nowhere zero. */
    double (*clearance)(const void *self, sgt_vec3 p);

    /* A guess at that distance, promised to nobody: used with dt_min > 0 alone. */
    double (*estimate)(const void *self, sgt_vec3 p);

    /* Intervals that contain g(t) = F(o + t d), and g' in *slope (never NULL), over the
     * whole of t, rounding included; t is finite, in lengths of d, and only o and d are
     * to be read.  Both may be as wide as they must: -INFINITY to INFINITY says nothing,
     * and so does a NaN.  lo > hi: F is undefined all over t, and so nowhere zero.  A slope
     * with two finite ends says besides that F is defined and continuous all over t: where it
     * may not be, let the slope be infinite.  The ray need not be the
     * caller's: from afar it is the same line from an origin nearby.  interval.h has what it
     * takes to write one. */
    sgt_interval (*enclose)(const void *self, const sgt_ray *ray, sgt_interval t, sgt_interval *slope);

    /* `value` at n points, to the last bit: F, and its gradient where grad[0] is not NULL
     * (then no other is).  A loop that the compiler makes vector code of is what makes
     * batches fast. */
    void (*values)(const void *self, size_t n, sgt_points p, sgt_values out);

    /* `span` of n rays, to the last bit; o and d alone are given, no output is NULL. */
    void (*spans)(const void *self, size_t n, sgt_rays rays, sgt_spans out);

    /* `span`, narrowed to the first root that counts on [tmin, tmax] of the ray, which are to be read here (tmax may be
     * infinite): with single there is at most one root in [lo, hi], F changes sign at it, and if none there counts, none
     * on the ray does.  Without single nothing is said, and the solver goes by `span`, as it does where this fails.  Asked
     * where the first root is wanted: it makes convex bodies as quick to meet as sags. */
    sgt_span (*first)(const void *self, const sgt_ray *ray);

    /* `first` of n rays, to the last bit; tmin and tmax are given, no output is NULL. */
    void (*firsts)(const void *self, size_t n, sgt_rays rays, sgt_spans out);

    /* For sensitivities (sensitivity.h).  The second derivatives of F at n points: xx, xy, xz, yy, yz, zz; no array is NULL. */
    void (*second)(const void *self, size_t n, sgt_points p, double *const out[6]);

    /* How many parameters F has derivatives by; their order is that of surfaces.h. */
    size_t (*parameters)(const void *self);

    /* dF / d(parameter j), j < parameters(self), and its gradient by the point, at n points; grad[0] may be NULL. */
    void (*by_parameter)(const void *self, size_t j, size_t n, sgt_points p, sgt_values out);
} sgt_surface_ops;

/* A surface: what it does, and the parameters it does it with (borrowed). */
typedef struct sgt_surface { const sgt_surface_ops *ops; const void *self; } sgt_surface;

/* --------------------------------------------------------------- answers */

/* Positive: met, at hit.t.  Zero: certainly not met.  Negative: undecided. */
typedef enum sgt_status {
    SGT_HIT       =  1,  /* F changes sign at t: through zero, or in a jump, but not at a pole */
    SGT_GRAZE     =  2,  /* |F| is within its rounding all over [lo, hi] and no change of sign
                            is certain: the ray touches there as far as can be told
                            (or lies in the plane: then t is where it starts, or enters the rim) */
    SGT_MISS      =  0,  /* F has no root on the ray that counts */
    SGT_UNPROVEN  = -1,  /* no root was found, yet none was excluded (or one was found
                            and it could not be told whether it counts) */
    SGT_UNDEFINED = -2,  /* the search ran into a region where F is NaN */
    SGT_EXHAUSTED = -3,  /* max_evals was spent (without a proof asked for); [lo, hi] is what was
                            left to search; in sgt_root t is the best point so far */
    SGT_STOPPED   = -4,  /* the watcher asked to stop */
    SGT_INVALID   = -5   /* a direction that is zero, subnormal or not finite; an origin that
                            is not finite; a NaN end, tmin > tmax, tmin = INFINITY or tmax =
                            -INFINITY; no `value`; a built-in surface with a parameter that is
                            NaN or infinite, or a negative semi_diameter; an option that is NaN
                            or negative */
} sgt_status;

/* Where status is zero or less, t is NaN unless said otherwise above. */
typedef struct sgt_hit {
    sgt_status status;
    int        evals;  /* evaluations of F spent (watched or not, the same) */
    double     t;      /* in lengths of d */
    double     t_err;  /* |t - root| <= t_err.  A bound by error analysis on the built-in
                          surfaces; on a user's an estimate, that trusts `rounding` */
    double     t_lo;   /* t + t_lo is as close to the root as the method can tell, closer
                          than one double where the origin is far */
    double     lo, hi; /* the stretch of the ray that the status speaks of: of a root, t +- t_err rounded
                          outward; of an undecided first root the first that is not decided (none
                          that counts is before it, what is behind it was not asked) */
    double     f;      /* F at p as `value` gives it; NaN where rounding has put p outside
                          the domain (the equator of a sphere) */
    sgt_vec3   p, n;   /* the point, and the gradient of F there, not normalised */
    double     p_err;  /* the point on the surface is this near p (length); p is not
                          o + t d but better, from local coordinates */
} sgt_hit;

/* "hit", "graze", "miss", "unproven", "undefined", "exhausted", "stopped",
 * "invalid"; never NULL, "?" for any other number. */
SGT_API const char *sgt_status_text(sgt_status status);

/* --------------------------------------------------------------- solving */

/* How the t of an evaluation was chosen. */
typedef enum sgt_move {
    SGT_SEED,     /* the first guess, or an end of the search */
    SGT_MARCH,    /* the next step along the ray */
    SGT_NEWTON,   /* a Newton step */
    SGT_BISECT,   /* the middle of the bracket */
    SGT_RETREAT,  /* back from a NaN, toward a point known to be defined */
    SGT_PROBE     /* beside a root, to see F change sign */
} sgt_move;

SGT_API const char *sgt_move_text(sgt_move move);      /* "seed", "march", ... */

/* One evaluation, as a watcher sees it: how t was chosen, and what F was there.
 * On a steep or grazing stretch a built-in surface is solved in its polynomial
 * form; f and slope are then of that form, which has the same roots. */
typedef struct sgt_step {
    size_t ray;               /* its index in a batch; 0 for a single ray */
    int eval; sgt_move move;  /* eval counts from 1 */
    double t, f, slope;       /* t is the ray's own */
    double lo, hi;            /* the bracket, or what is left of the search */
} sgt_step;

typedef int sgt_watch(void *data, const sgt_step *step);  /* nonzero: stop */

/* Which root is the answer, where a ray has several? */
typedef enum sgt_pick {
    SGT_PICK_DEFAULT,  /* first in sgt_intersect, near the seed in sgt_trace */
    SGT_FIRST,         /* the smallest t: what an eye sees */
    SGT_NEAR_SEED      /* the one the surface's own guess leads to (a sag: the crossing of
                          the vertex plane): what a lens designer means */
} sgt_pick;

/* What must be proven before a status may be positive or zero?  What is not, and what
 * max_evals ends, is UNPROVEN, with [lo, hi] the stretch that is left; a GRAZE says what it
 * always says, and not that there is a root.  A proof is by error analysis or by intervals
 * (interval.h), and trusts no estimate: built-in surfaces have it, and surfaces of a user that
 * offer `enclose`; without, a hit is UNPROVEN under either, and lo and hi are about the root
 * that was seen.  A root whose side of the rim (semi_diameter) rounding hides is UNPROVEN too. */
typedef enum sgt_proof {
    SGT_ESTIMATE,     /* nothing more than what sgt_intersect promises */
    SGT_PROVE_ROOT,   /* one root of F, and only one, lies in [t - t_err, t + t_err] */
    SGT_PROVE_FIRST   /* and none that counts lies before it; for SGT_NEAR_SEED: and no other
                         that counts lies on the ray at all (in traces: on the chord of the
                         clear aperture, where there is one; the aperture itself is a
                         comparison of computed numbers), [lo, hi] being about all of them.
                         A level set has but first roots, whatever `pick` says.  A MISS is
                         proven too */
} sgt_proof;

typedef struct sgt_options {
    double     t_tol;      /* stop when t is known to this (lengths of d); 0: to rounding.
                              t_err is a bound all the same.  On a level set roots closer
                              together than this may be told as one; under a proof they do not
                              read it */
    double     f_tol;      /* stop when |F| is at most this; 0: never on |F| alone.  Surfaces
                              of a user and sgt_root only */
    double     dt_min;     /* the least step of a march, in lengths of d; 0: as sgt_intersect
                              says.  Of level sets (julia, mandelbrot) a step above 0 asks for
                              the fast way: no proof, and thin parts may be passed by.
                              The built-in sags do not read it */
    int        max_evals;  /* give up on a root after this many evaluations;  0: 2000.  A root
                              found by then is still confirmed, by one more */
    sgt_pick   pick;
    sgt_proof  proof;
    sgt_watch *watch;      /* called once per evaluation;           NULL: nobody */
    void      *watch_data;
} sgt_options;

/* The hit that `pick` asks for; opt may be NULL.
 *
 * Built-in surfaces: every status is certain, by running error analysis, for the
 * surface whose parameters are exactly the stored doubles and the ray whose
 * doubles are given; what cannot be told is UNPROVEN.  Level sets with dt_min > 0 are
 * the exception: they are marched in steps of the larger of `estimate` and dt_min, and a
 * ray on which no change of sign is seen is UNPROVEN, unless it passes the set's ball by.
 * What options.proof adds to that says sgt_proof.
 *
 * A user's surface: that a first hit is the first, and that a miss is one, is certain
 * where the surface offers span.single or enclose; by clearance it is certain but for
 * stretches shorter than dt_min (0: 2^-20 of the stretch searched).  With neither, or with
 * `estimate` and dt_min > 0, the hit is the first that a march in steps of dt_min (0:
 * 1/64 of the stretch) or of the estimate, if that is larger, can see.  A march that sees
 * no root is UNPROVEN if one of its steps was uncertain, else MISS.  Newton's step never
 * lengthens a step of a march.
 * Toward a far end at infinity steps go as far as the ray is nearer to the origin of the
 * surface's frame than its start is, and grow by half each from there on, 128 of them; a
 * near end at infinity has no first root to be found, and is UNPROVEN.  A span is better.
 *
 * Iteration counts may change between versions; what a status means may not. */
SGT_API sgt_hit sgt_intersect(sgt_surface s, sgt_ray ray, const sgt_options *opt);

/* The same answers as arrays; those left NULL are not wanted, and not written. */
typedef struct sgt_hits {
    signed char *status;  /* an sgt_status */
    int    *evals;
    double *t, *t_err, *t_lo;
    double *p[3], *n[3];  /* all three of one, or none */
    double *p_err;
} sgt_hits;

/* One hit for each of n rays; opt may be NULL.  Each answer is the one that
 * sgt_intersect would give, bit for bit (a NaN for a NaN), whatever its neighbours are and
 * whatever the processor: a lane never changes its neighbour.  Returns the number of
 * positive statuses.  Outputs must not overlap the rays or each other.  Nothing is
 * allocated; the stack needed is below 80 KiB (of a library built without optimisation a few
 * KiB more).  Where options.watch is set the rays run one
 * by one, in order; sgt_step.ray is the index of the ray, and a watcher that stops, stops
 * that ray.
 *
 * Fast are the built-in surfaces, and surfaces of a user that offer `values`; with
 * `spans` as well faster still.  Without `values` a user's `value` is asked point by point,
 * and where a first root has to be searched for by clearance, enclose or estimate the rays
 * are answered one by one. */
SGT_API size_t sgt_intersect_batch(sgt_surface s, size_t n, sgt_rays rays, sgt_hits hits, const sgt_options *opt);

/* Every hit, in order of t; opt may be NULL, and its pick is not read.  Writes at most
 * cap of them (hits may be NULL where cap is 0) and returns how many there are: 0 is a
 * miss.  SGT_INVALID (negative) where sgt_intersect would say so.
 *
 * The ray enters where n . d < 0 (F falls) and leaves where n . d > 0; a graze is one
 * entry.  A stretch of the ray that could not be decided is an entry of negative status,
 * in its place in the order, with t +- t_err, that is [lo, hi], covering it; p, n and f
 * are then NaN.  max_evals is spent on each root anew, and all roots together may spend
 * 1024 times as much.  Where it runs out, or where the watcher stops the search, what is
 * left of the ray is the last entry, EXHAUSTED or STOPPED.
 * Outside what is reported there is no root, where sgt_intersect would be certain
 * of it.  A march that is not certain tells the roots it sees, and not what it may have
 * passed by between and behind them; one that sees none reports the whole stretch as
 * UNPROVEN. */
SGT_API int sgt_intersect_all(sgt_surface s, sgt_ray ray, int cap, sgt_hit hits[], const sgt_options *opt);

/* ------------------------------------------------- the solver, by itself */

/* Newton in a bracket, turned inside out: it never calls you.  Evaluate g and
 * g' at r.t, hand them over, repeat while it asks for more:
 *
 *     double g, dg;
 *     sgt_root r = sgt_root_begin((sgt_span){ .lo = 0, .hi = 2, .seed = 1 }, NULL);
 *     do g = cos(r.t), dg = -sin(r.t); while (sgt_root_next(&r, g, dg));
 *
 * It looks for one root in [span.lo, span.hi]; the slope may be wrong, zero,
 * infinite or NaN: it only costs evaluations.  From the options it reads t_tol,
 * f_tol and max_evals.  Ends in
 *   SGT_HIT    g changes sign within t_err of t (or |g| <= f_tol, if given: t_err is
 *              then twice what |g| and the slope make it)
 *   SGT_GRAZE  |g| <= g_err at t and no certain change of sign near
 *   SGT_MISS   one sign at both ends and span.single
 *   SGT_UNPROVEN, SGT_UNDEFINED, SGT_EXHAUSTED  as everywhere
 *   SGT_INVALID  lo > hi, or a NaN end, or a bad option: already at begin, and
 *                the first sgt_root_next returns false
 * A pole at which g changes sign is a root to this solver: look at |g|. */
struct sgt_root_private { /* not for programs; of 256 bytes in every version */
    double g_lo, g_hi;              /* g at lo and hi; NaN: not known */
    double last, g_last;            /* the last point where g was defined */
    double step, step_before;       /* the last step and the one before */
    double candidate, width;        /* of a probe */
    double hole;                    /* the last NaN */
    double t_tol, f_tol;
    int    budget;
    int    sign_lo, sign_hi, sign_last; /* signs of g there; 0: not certain */
    int    sign_left, sign_right;   /* signs found beside the candidate; 0: none yet */
    int    side;                    /* of the candidate that is asked for; 0: none */
    int    overshoots, bisections, retreats, sampled;
    bool   bracketed, single, done;
    double reserved[15];
};

typedef struct sgt_root {
    double t, lo, hi, t_err;          /* where to evaluate next; the bracket; the error */
    int evals;
    sgt_move move; sgt_status status;
    double g_err;                     /* set by you, before any step: how far g may be off;
                                         0: exact */
    struct sgt_root_private private_; /* the solver's own */
} sgt_root;

SGT_API sgt_root sgt_root_begin(sgt_span span, const sgt_options *opt);
SGT_API bool     sgt_root_next(sgt_root *r, double g, double slope);

#ifdef __cplusplus
}
#endif
#endif /* SAGITTA_SAGITTA_H */
