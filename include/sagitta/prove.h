// SPDX-License-Identifier: MIT
/* prove.h - every ray of a pupil: what certainly passes, and bounds that no ray of it
 * leaves.  Part of sagitta_lens.
 *
 * The pupil of a field at a wavelength is divided into boxes of radius and angle.  The
 * rays of a box are carried through the lens together (beam.h): all pass, all stop at one
 * element, or it is not decided.  Boxes that are not decided, or whose bounds are wide,
 * are halved.  So what is told is proven of every ray, and not sampled.
 *
 * The answers are analyses of study.h, with the fields, wavelengths and threads of a
 * study:
 *
 *     "prove"           shares of the pupil, and bounds      sgt_prove_row
 *     "prove_elements"  the same at each element             sgt_prove_element_row
 *     "prove_regions"   the boxes                            sgt_prove_region_row
 *     "prove_limits"    limits: proven, broken or undecided  sgt_prove_limit_row
 *     "prove_samples"   the same beside rays of a pattern    sgt_prove_sample_row
 *     "prove_between"   bounds for the fields and wavelengths between those of the lens
 *                                                            sgt_prove_between_row
 *     "prove_between_limits"  limits for these               sgt_prove_between_limit_row
 *
 *     sgt_prove_options options = {.limit = "spot < 0.02"};
 *     sgt_study_run(study, sgt_analysis_named("prove_limits"), &options, &sink, NULL,
 *                   &error);
 *
 * WHICH RAYS.  Those through the points of the unit disc of the pupil that sgt_study
 * sends
 * rays through if it does not aim: the paraxial entrance pupil, or the cone of a
 * telecentric object, with the vignetting of the field.  A lens that aims at its stop has
 * other points: a remark says so.
 *
 * WHAT IS PROVEN is about the exact rays through the surfaces, indices and apertures as
 * stored.  An undecided box is counted in: its rays may pass or not, and bounds hold for
 * them as well. */
#ifndef SAGITTA_PROVE_H
#define SAGITTA_PROVE_H
#include <sagitta/study.h>
#ifdef __cplusplus
extern "C" {
#endif

/* Zeros are the defaults. */
typedef struct sgt_prove_options {
    sgt_list undecided;     /* the share of the pupil's area, in per cent, that may stay
                               undecided; none: 0.1.  Above 0 */
    size_t boxes;           /* at most so many boxes a field and wavelength; 0: 10000.
                               "prove_between": for each part: of a line of fields
                               there are 8, of each triangle 4, of wavelengths twice
                               as many */
    const char *limit;      /* of "prove_limits": limits with semicolons between, as
                               sgt_prove_limit_read has them */
    int between;            /* of "prove_between": 0 all fields and all wavelengths
                               between; 1 fields, at each wavelength of the study;
                               2 wavelengths, of each field of the study */
    size_t steps;           /* of "prove": so many fields from the axis to the farthest
                               one, 2 or more; 0: those of the study */
    unsigned long long reserved_[2]; /* leave it zero */
} sgt_prove_options;

/* "prove".  Shares are per cent of the area of the pupil.  A bound that is not known is
 * infinite, and a number that there is not is NaN. */
typedef struct sgt_prove_row {
    size_t field;
    double wavelength;
    double passes, stops, undecided; /* certainly; they add up to 100 */
    double missed, clipped, tir, evanescent; /* parts of `stops` */
    /* No ray that passes is beyond; and the largest of a ray that was traced.  px, py:
     * that ray.  From the chief ray of the primary wavelength, as "spot" has it */
    double ex, ex_seen, ex_px, ex_py;
    double ey, ey_seen, ey_px, ey_py;
    double spot, spot_seen, spot_px, spot_py;
    /* rms distance from that chief ray over the area that passes: between */
    double rms_least, rms;
    /* path differences in waves, as "opd" has them: largest less smallest */
    double opd_least, opd_most;      /* no difference is beyond */
    double pv, pv_seen, low_px, low_py, high_px, high_py;
    double opd_rms_least, opd_rms;   /* about the mean: between */
    size_t boxes;                    /* how many were carried through */
    size_t spent;                    /* 1: the budget was spent, so more boxes would give
                                        closer bounds; 0: not */
    double fx, fy;                   /* the field, as those of the study are given */
    unsigned long long reserved_[6];
} sgt_prove_row;

/* "prove_elements". */
typedef struct sgt_prove_element_row {
    size_t field;
    double wavelength;
    size_t element;                  /* from 1 */
    double missed, clipped, tir, evanescent; /* shares that certainly end here */
    double incidence, incidence_seen, incidence_px, incidence_py; /* degrees */
    double clearance, clearance_seen, clearance_px, clearance_py; /* length: how far the
                                        rays that pass stay from the edge of the clear
                                        aperture; NaN: it has none */
    double height;                   /* length: how far they are from the axis of the
                                        element at most */
    unsigned long long reserved_[4];
} sgt_prove_element_row;

/* "prove_regions": a box of the pupil, a part of a ring about its centre. */
typedef struct sgt_prove_region_row {
    size_t field;
    double wavelength;
    double r0, r1;                   /* radii of the pupil */
    double angle0, angle1;           /* degrees, from px toward py */
    int    fate;                     /* all its rays: SGT_PASSED ...; SGT_LOST: not
                                        decided */
    size_t element;                  /* where they end, from 1; if not decided, where that
                                        is in doubt; 0: all pass */
    double share;                    /* per cent of the pupil's area */
    unsigned long long reserved_[2];
} sgt_prove_region_row;

typedef enum sgt_limit_verdict {
    SGT_LIMIT_PROVEN = 1,     /* it holds for every ray that passes, and some ray does */
    SGT_LIMIT_BROKEN = 0,     /* px, py is a ray that passes and breaks it; of a mean or a
                                 share: it is certainly beyond */
    SGT_LIMIT_UNDECIDED = -1, /* the budget was spent, or rounding forbids it */
    SGT_LIMIT_EMPTY = -2      /* certainly no ray passes, so there is nothing to prove.
                                 (Not of pass: that is broken then.) */
} sgt_limit_verdict;

/* "proven", "broken", "undecided" or "empty". */
SGT_API const char *sgt_limit_verdict_text(int verdict);

/* "prove_limits". */
typedef struct sgt_prove_limit_row {
    size_t field;
    double wavelength;
    size_t limit;                    /* which, from 1 */
    int    verdict;                  /* sgt_limit_verdict */
    double value;                    /* of the limit */
    double bound;                    /* no ray is beyond this */
    double seen;                     /* of a ray that was traced; of a mean or a share the
                                        other bound */
    double px, py;                   /* this ray; NaN: there is none */
    double undecided;                /* per cent of the pupil's area where it may be
                                        broken; 0 unless the verdict is undecided */
    size_t boxes;
    unsigned long long reserved_[4];
} sgt_prove_limit_row;

/* "prove_between": a bound for every ray of the fields and wavelengths between those of
 * the study, and the worst ray that was traced.
 *
 *     fields       the convex hull of those of the study: a line, or an area.  From afar,
 *                  of the slopes of their chief rays; else of the points of the object
 *     wavelengths  from the shortest to the longest one
 *
 * Chief rays are those through the centre of the paraxial pupil.  If fields differ in
 * their vignetting, none is taken, as a remark says. */
typedef struct sgt_prove_between_row {
    size_t field;                    /* 0: all fields between */
    double wavelength;               /* SGT_ALL_WAVELENGTHS: all between */
    int    quantity;                 /* sgt_prove_quantity: ex, ey, spot, opd, incidence,
                                        clearance */
    size_t element;                  /* of the last two, from 1; else 0 */
    double bound;                    /* no ray is beyond */
    double seen;                     /* of the worst ray that was traced: */
    double fx, fy;                   /* its field, degrees from afar, else the point of
                                        the object */
    double um;                       /* its wavelength */
    double px, py;                   /* where it goes through the pupil; of opd, the one
                                        with the largest difference, */
    double low_px, low_py;           /* and with the smallest.  NaN: of others */
    size_t boxes;                    /* of the whole field and wavelength */
    size_t spent;                    /* 1: more boxes would give a closer bound */
    unsigned long long reserved_[4];
} sgt_prove_between_row;

/* "prove_between_limits".  Limits are of ex, ey, spot, opd, incidence and clearance. */
typedef struct sgt_prove_between_limit_row {
    size_t field;
    double wavelength;
    size_t limit;                    /* which, from 1 */
    int    verdict;                  /* sgt_limit_verdict */
    double value, bound, seen;
    double fx, fy, um, px, py, low_px, low_py; /* as above */
    double undecided;                /* per cent of fields, wavelengths and pupil where
                                        it may be broken */
    size_t boxes;
    unsigned long long reserved_[4];
} sgt_prove_between_limit_row;

/* "prove_samples": the points of the pupil of the study, beside the proof.  A remark says
 * what they miss: a region that is lost where none of them fell (above 0.05 % of the
 * pupil), a share that is off by more than 1 %, a worst ray that is 1.1 times theirs. */
typedef struct sgt_prove_sample_row {
    size_t field;
    double wavelength;
    size_t rays, passed;
    double sampled;                  /* per cent of their weights that passes */
    double passes, stops, undecided; /* per cent of the area of the pupil, certainly */
    double spot_sampled, spot_seen, spot; /* the largest distance from the chief ray: of
                                        the sample, of a ray that the proof traced, of any
                                        ray at most */
    double pv_sampled, pv_seen, pv;  /* largest less smallest path difference, waves */
    size_t missed;                   /* how many remarks there were */
    unsigned long long reserved_[4];
} sgt_prove_sample_row;

/* What a limit is about. */
typedef enum sgt_prove_quantity {
    SGT_PROVE_PASSES,     /* pass: share of the pupil's area, per cent */
    SGT_PROVE_EX,         /* ex, ey: |x|, |y| from the chief ray, as `spot` */
    SGT_PROVE_EY,
    SGT_PROVE_SPOT,       /* spot: the distance from the chief ray.  Length; of an afocal
                             lens mrad */
    SGT_PROVE_RMS,        /* rms: of that distance, over the area that passes */
    SGT_PROVE_OPD,        /* opd: path differences, largest less smallest, waves */
    SGT_PROVE_OPD_RMS,    /* wavefront: their rms about the mean, waves */
    SGT_PROVE_INCIDENCE,  /* incidence: the angle, degrees */
    SGT_PROVE_CLEARANCE   /* clearance: the distance from the edge of a clear aperture */
} sgt_prove_quantity;

/* "spot" and so on, as in limits.  Never NULL. */
SGT_API const char *sgt_prove_quantity_text(int quantity);

/* A limit.  pass and clearance are to be above the value, the others below. */
typedef struct sgt_prove_limit {
    sgt_prove_quantity quantity;
    size_t element;       /* of incidence and clearance: from 1; 0: all elements */
    double value;
    size_t or_equal;      /* 1: or equal to it, >= or <=; 0: not */
    unsigned long long reserved_[2];
} sgt_prove_limit;

/* Reads limits: "spot < 0.02; incidence[3] < 40; pass > 99.9".
 *
 *     text    NAME < NUMBER, or for pass and clearance NAME > NUMBER, with semicolons
 *             between; or <= and >=, which hold at the value too.  NAME is pass, ex,
 *             ey, spot, rms, opd, wavefront, incidence, clearance; the last two with an
 *             element in brackets or without
 *     most    room for so many
 *     limit   written
 *     error   may be NULL; says what is wrong
 *
 * Returns how many there are; 0: the text is at fault, or there are more than `most`. */
SGT_API size_t sgt_prove_limit_read(const char *text, size_t most,
                                    sgt_prove_limit limit[], sgt_error *error);

/* The limit in words, zero-ended: "incidence[3] < 40". */
enum { SGT_PROVE_LIMIT_SIZE = 64, SGT_PROVE_LIMITS = 16 };
SGT_API void sgt_prove_limit_text(const sgt_prove_limit *limit,
                                  char text[SGT_PROVE_LIMIT_SIZE]);

#ifdef __cplusplus
}
#endif
#endif
