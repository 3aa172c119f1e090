// SPDX-License-Identifier: MIT
/* tolerance.h - how badly a lens may be built: what each tolerance of its file does to a
 * figure, and what all of them do together, by many lenses built at random.  Part of
 * sagitta_lens.
 *
 * A TOLERANCE says what is off and by how much: the radius of a surface, a thickness, the
 * place or tilt of a surface or of several together, an index, the shape.  It is an entry
 * of `tolerances` in the lens file (docs/tolerance.md).  All of them are a BOX: entry i
 * may be anything from lower to upper.  A point of the box is an array with a number for
 * each entry, in the order of the file; 0 everywhere is the lens as designed.
 *
 * A COMPENSATOR is an entry that is not off by chance: when the lens has been built it is
 * set within its box so that the figure, or the paraxial focus, is best.
 *
 * A FIGURE (sgt_tolerancing_figure) is one number for the whole lens: the smaller, the
 * better.  NaN: the lens cannot be judged, for example because a chief ray does not get
 * through.
 *
 *     sgt_tolerancing *t = sgt_tolerancing_new(lens, NULL, &error);
 *     sgt_tolerancing_trials(t, 1, 0, 10000, take, NULL, &error);
 *     sgt_tolerancing_free(t);       void take(void *context, const sgt_trial *trial)
 *
 * A lens of a point is made by edits of the lens (edit.h).  So sgt_tolerancing_lens
 * written as a file and read anew has the same figure.
 *
 * THREADS.  Functions that take a const sgt_tolerancing may run in any number of threads
 * at once. */
#ifndef SAGITTA_TOLERANCE_H
#define SAGITTA_TOLERANCE_H
#include <sagitta/study.h>
#ifdef __cplusplus
extern "C" {
#endif

/* --------------------------------------------------------------- what a file says */

/* What is off, and the unit of lower and upper.  x, y and z are the axes of the first of
 * the surfaces as it is designed. */
typedef enum sgt_tolerance_kind {
    SGT_TOLERANCE_RADIUS,       /* the vertex radius: length */
    SGT_TOLERANCE_FRINGES,      /* the curvature, in fringes of power: n fringes change it
                                   by n wavelength / over^2 */
    SGT_TOLERANCE_THICKNESS,    /* behind the surface: length.  What follows moves */
    SGT_TOLERANCE_DECENTER_X,   /* lengths.  What follows stays */
    SGT_TOLERANCE_DECENTER_Y,
    SGT_TOLERANCE_DECENTER_Z,
    SGT_TOLERANCE_TILT_X,       /* degrees, right-handed, about the pivot.  What */
    SGT_TOLERANCE_TILT_Y,       /* follows stays */
    SGT_TOLERANCE_TILT_Z,
    SGT_TOLERANCE_INDEX,        /* behind the surface, alike at all wavelengths */
    SGT_TOLERANCE_IRREGULARITY  /* the shape, in fringes: n of them add to the sag
                                   n wavelength / 2 Z(r / over), Z the one of `term` */
} sgt_tolerance_kind;

typedef enum sgt_distribution {
    SGT_UNIFORM,       /* from lower to upper */
    SGT_NORMAL,        /* about the middle, cut at lower and upper, 2 sigma off */
    SGT_ENDS           /* lower or upper, each in half of the cases */
} sgt_distribution;

typedef enum sgt_compensation {
    SGT_NO_COMPENSATOR,
    SGT_COMPENSATE_FIGURE,   /* the best figure within the box */
    SGT_COMPENSATE_PARAXIAL  /* the paraxial image is as far from the image surface as it
                                is designed: of the last thickness alone */
} sgt_compensation;

typedef struct sgt_tolerance {
    sgt_tolerance_kind kind;
    sgt_distribution   distribution;
    sgt_compensation   compensator;
    size_t first, last;      /* the surfaces that are off, from 1 */
    double lower, upper;     /* lower < upper */
    double wavelength;       /* of fringes, um */
    double over;             /* of fringes: the semi-diameter that is tested; else 0 */
    double pivot;            /* of tilts: from the first vertex along its z */
    size_t term;             /* of irregularity: the number of the polynomial in the
                                fringe order (SGT_FRINGE) */
    size_t line;             /* of the file */
    const char *name;        /* "" where not given */
    unsigned long long reserved_[4];
} sgt_tolerance;

/* The tolerances of a lens: how many, and *list (may be NULL) the first of them.  They
 * last until the lens is edited. */
SGT_API size_t sgt_lens_tolerances(const sgt_lens *lens, const sgt_tolerance **list);

/* What an entry is about in a few words, "surface 2 radius" or its name, zero-ended. */
enum { SGT_TOLERANCE_SIZE = 80 };
SGT_API void sgt_tolerance_text(const sgt_tolerance *tolerance,
                                char text[SGT_TOLERANCE_SIZE]);

/* The unit of lower and upper: "fringe", "degree", "", or that of the lens. */
SGT_API const char *sgt_tolerance_unit(const sgt_lens *lens, const sgt_tolerance *of);

/* ------------------------------------------------------------------ a figure */

/* Fields weigh as field_weights of the lens says; those of sgt_study_options.field_at
 * alike. */
typedef enum sgt_tolerancing_figure {
    /* The root of the weighted mean square of */
    SGT_TOLERANCING_SPOT, /* the rms radius of each field's spot, all wavelengths together
                             ("spot" of study.h) */
    SGT_TOLERANCING_OPD,  /* the rms path difference of each field and wavelength, in
                             waves ("wavefront") */
    SGT_TOLERANCING_BORESIGHT /* how far each field's chief ray ends from where it ends in
                                 the design (x and y of "spot"); 0 as designed */
} sgt_tolerancing_figure;

/* Zeros are the defaults. */
typedef struct sgt_tolerancing_options {
    sgt_tolerancing_figure figure;
    const sgt_study_options *study; /* fields, rays, threads ...; NULL: as there */
    int reference;                  /* of SGT_TOLERANCING_SPOT, as in sgt_spot_options */
    unsigned long long reserved_[4]; /* leave it zero */
} sgt_tolerancing_options;

typedef struct sgt_tolerancing sgt_tolerancing;

/* The lens, and what the options point to, must last as long as the sgt_tolerancing.  Do
 * not edit the lens meanwhile.  Pickups and solves of its file keep their values: a lens
 * that is built has none.  NULL: `error` (may be NULL) says why, and names the tolerance
 * that is not possible. */
SGT_API sgt_tolerancing *sgt_tolerancing_new(const sgt_lens *lens,
                                             const sgt_tolerancing_options *opt,
                                             sgt_error *error);
SGT_API void sgt_tolerancing_free(sgt_tolerancing *t); /* NULL: nothing */

/* The figure of the lens as designed, with nothing compensated. */
SGT_API double sgt_tolerancing_nominal(const sgt_tolerancing *t);

/* Sets *figure to that of a point of the box, value[i] of entry i.  Compensators are
 * sought, whatever their value is, and set.  false: `error` says why. */
SGT_API bool sgt_tolerancing_at(const sgt_tolerancing *t, double value[],
                                double *figure, sgt_error *error);

/* The lens of a point, compensators as they are given, without its tolerances; free it by
 * sgt_lens_free. */
SGT_API sgt_lens *sgt_tolerancing_lens(const sgt_tolerancing *t, const double value[],
                                       sgt_error *error);

/* ----------------------------------------------------------------- sensitivity */

/* One entry at its lower and its upper end, all others 0, with the compensators set.  A
 * change is that of the figure, from the lens as designed with its compensators set.
 *
 * derivative: of the figure there, by exact derivatives of all rays, compensators
 * following; linear is it times each end.  So at an end of its box a compensator stays.
 * A figure that is 0, such as a boresight, grows to both sides: the derivative is then by
 * |value|.  It is 0 where the figure grows by the square alone, such as that of a
 * symmetric lens of which a part is tilted.  NaN: there is none, as figure.h tells (NOT
 * DIFFERENTIATED).  No derivative tells of rays that come to be clipped. */
typedef struct sgt_sensitivity {
    size_t entry;               /* from 0 */
    double figure_lower, figure_upper;
    double change_lower, change_upper;
    double worse;               /* the greater change */
    double compensator_lower, compensator_upper; /* the first one's value; NaN: none */
    double derivative;          /* of the figure, by the unit of lower and upper */
    double linear_lower, linear_upper;
    double compensator_derivative; /* of the first one; NaN: none */
    unsigned long long reserved_[4];
} sgt_sensitivity;

typedef struct sgt_sensitivity_sum {
    double nominal;             /* the compensators at 0 */
    double compensated;         /* the compensators set */
    double estimate;            /* compensated plus the root of the sum, over the entries,
                                   of the mean square of the two changes */
    unsigned long long reserved_[4];
} sgt_sensitivity_sum;

/* What each entry does by itself.
 *
 *     count  written: the number n of entries that are not compensators
 *     row    room for all entries; row[0 ... n - 1] are written, the worst first, those
 *            with a NaN before all
 *     sum    written
 *
 * false: `error` (may be NULL) says why. */
SGT_API bool sgt_tolerancing_sensitivity(const sgt_tolerancing *t, size_t *count,
                                         sgt_sensitivity row[],
                                         sgt_sensitivity_sum *sum, sgt_error *error);

/* ------------------------------------------------------------- the worst case, proven
 *
 * Not of lenses that were built, but of every lens of the box: each ray of the figure is
 * carried through all of them together, at first order in each entry with a bound on all
 * else (src/lens/tolerance/worst.c).  What is proven is about the figure as defined
 * above: its rays, not those between them.
 *
 * A compensator that seeks the best figure may do better than the bound: the figure is no
 * larger with it set.  Not known, and refused: `opd`; an afocal lens; rays that are aimed
 * at the stop; fields by image heights; more than 62 entries; fringes or radii of other
 * surfaces than planes, spheres, conics and even aspheres. */

/* Zeros are the defaults. */
typedef struct sgt_worst_options {
    sgt_list limit;        /* at most one: is the figure at most that in every lens? */
    size_t boxes;          /* at most so many boxes of lenses; 0: 32 */
    unsigned long long reserved_[4]; /* leave it zero */
} sgt_worst_options;

typedef struct sgt_worst_case {
    double bound;         /* no lens in tolerance has a larger figure; infinite: it is not
                             known */
    double seen;          /* the largest figure of a lens that was built; NaN: it has
                             none, and is worse than any */
    int    verdict;       /* of the limit: sgt_limit_verdict of prove.h.  Broken: by the
                             lens that was seen.  Without a limit: undecided */
    size_t boxes, lenses; /* carried through, and built */
    size_t element;       /* if the bound is infinite: where, from 1; 0: at none */
    const char *why;      /* and why; else "" */
    unsigned long long reserved_[8];
} sgt_worst_case;

/* The worst case.
 *
 *     out    written
 *     value  room for all entries: written, the lens that was seen, compensators as set
 *     cuts   room for all entries, or NULL: how many boxes were cut along each
 *
 * false: `error` (may be NULL) says why.  Bits do not depend on threads. */
SGT_API bool sgt_tolerancing_worst(const sgt_tolerancing *t,
                                   const sgt_worst_options *opt, sgt_worst_case *out,
                                   double value[], size_t cuts[], sgt_error *error);

/* ----------------------------------------------------------------- Monte Carlo */

/* One lens built at random. */
typedef struct sgt_trial {
    uint64_t      number;
    double        figure;
    const double *value;        /* of each entry, the compensators as they were set */
    unsigned long long reserved_[4];
} sgt_trial;

/* The values of the entries in a trial; those of compensators are 0.  They depend on the
 * seed, the number of the trial and the place of the entry, and on nothing else: the bits
 * are the same on every system. */
SGT_API void sgt_tolerancing_draw(const sgt_tolerancing *t, uint64_t seed, uint64_t trial,
                                  double value[]);

/* Builds lenses at random, and calls `take` for each, in order.
 *
 *     seed          of all draws
 *     first, count  the numbers of the trials: first ... first + count - 1
 *     take          called from the thread that asks
 *     context       its first argument
 *
 * Bits do not depend on threads, nor on how trials are split. */
SGT_API bool sgt_tolerancing_trials(const sgt_tolerancing *t, uint64_t seed,
                                    uint64_t first, uint64_t count,
                                    void (*take)(void *context, const sgt_trial *trial),
                                    void *context, sgt_error *error);

/* ------------------------------------------------------- quantiles, free of a model
 *
 * The k-th smallest of n values is at or above the quantile p exactly if fewer than k of
 * them lie below that quantile.  How many lie below it is a binomial number, whatever the
 * distribution (David and Nagaraja 2003, Order Statistics, 7.1). */

/* An estimate and an interval that contains the true value in at least the share
 * `confidence` of all cases.  If n values are too few for an end, that end is NaN (of a
 * share 0 or 1). */
typedef struct sgt_confidence { double estimate, lower, upper; } sgt_confidence;

/* The quantile p of n values that rise; a NaN counts as beyond all and stands last.  The
 * estimate is the k-th smallest, k = ceil(n p). */
SGT_API sgt_confidence sgt_quantile(size_t n, const double sorted[], double p,
                                     double confidence);

/* The share of a population in which k of n draws were seen to have a property (Clopper
 * and Pearson 1934). */
SGT_API sgt_confidence sgt_share(size_t k, size_t n, double confidence);

#ifdef __cplusplus
}
#endif
#endif /* SAGITTA_TOLERANCE_H */
