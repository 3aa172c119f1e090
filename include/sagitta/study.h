// SPDX-License-Identifier: MIT
/* study.h - what a designer asks of a lens: spots, fans, path differences, field curves,
 * maps, sweeps, encircled energy, illumination, proofs (prove.h).  Part of sagitta_lens.
 * The command, Python and C ask here, and get the same bits.
 *
 * A STUDY is fields x wavelengths x points of the pupil.  Fields and wavelengths count
 * from 1, as in the lens file.  An ANALYSIS is computed of it, and answers in rows.
 *
 *     sgt_study *study = sgt_study_new(lens, NULL, &error);
 *     sgt_sink sink = {.row = take};       void take(void *context, const void *row)
 *     sgt_study_run(study, sgt_analysis_named("spot"), NULL, &sink, NULL, &error);
 *     sgt_study_free(study);
 *
 * Here `take` gets const sgt_spot_row, one after another.  An analysis also says in
 * tables which columns its rows have and which settings it takes (sgt_column,
 * sgt_setting): so a program can ask for any by its name, and print what comes.
 *
 * NUMBERS.  Rays are traced in blocks of 128 points.  Sums over rays are exact, and
 * rounded once, or those of blocks are added in a tree of the blocks' numbers.  So bits
 * depend neither on threads nor on machines (sgt_shard), and memory does not grow with
 * the number of rays.  Each number that comes from traced rays has a bound on
 * what rounding does to it, or its certain `digits`.
 *
 * AIMED RAYS.  If a field has 256 points or more at a wavelength, most of its aimed rays
 * come from a map that is fitted to 91 rays.  Each is traced to the stop and must meet
 * its point there; the others are searched for.  So their last bits may differ from
 * those of sgt_trace_pupil, which searches for each. */
#ifndef SAGITTA_STUDY_H
#define SAGITTA_STUDY_H
#include <sagitta/analysis.h>
#ifdef __cplusplus
extern "C" {
#endif

/* ------------------------------------------------------------------------ the study */

/* A wavelength: that of the lens with this number, from 1; 0: `um` micrometres. */
typedef struct sgt_wavelength { size_t number; double um; } sgt_wavelength;

/* One of several shares of a study, for as many machines; or the study put together of
 * them.  Which rays a share has depends on its number alone.
 *
 *     number  1 to `of`: this share is computed, and given to `write`.  Rows and remarks
 *             are not told, and totals are those of the share.
 *             0: what all `of` shares wrote is asked for by `read`, share by share from
 *             its beginning on, and the answer is that of one run, to the bit
 *     write, read  false: it failed, and so does the study
 *     next    NULL.  Or several programs share a study at the same time: in each pass
 *             of it, `next` is asked for the number of a share that no other program
 *             has, from 1 to its `of`, and `write` gets what that share makes.  It
 *             returns 0 when all shares of the pass are written, by whomever.  `number`
 *             0 then reads them, and is told rows; any other one reads only what later
 *             passes depend on.  Each of them has `write` and `read`
 *
 * Study, analysis and options have to be the same each time, and so have the members of
 * the sink that are not NULL.  What is written is made for the same version of the
 * library on a machine of the same kind; whoever keeps it has to guard it. */
typedef struct sgt_shard {
    size_t number, of;
    void  *context;
    bool (*write)(void *context, size_t size, const void *bytes);
    bool (*read)(void *context, size_t number, size_t size, void *bytes);
    size_t (*next)(void *context, size_t of);
    unsigned long long reserved_[2];
} sgt_shard;

/* Zeros are the defaults. */
typedef struct sgt_study_options {
    const sgt_allocator *allocator; /* NULL: malloc */
    const sgt_lens_aim  *aim;       /* NULL: as the lens says */
    const sgt_options   *solver;    /* of sgt_trace, with the proof that is asked for */
    bool open;                      /* apertures clip no ray */

    /* 0: all fields of the lens.  Else those of the numbers field[i], from 1; if `field`
     * is NULL, field_at[i] in the kind of the lens, or *field_kind */
    size_t                fields;
    const size_t         *field;
    const sgt_lens_field *field_at;
    const sgt_field_kind *field_kind;

    /* 0: all of the lens, or the primary one where the analysis says so (primary_alone),
     * unless `every_wavelength` */
    size_t                wavelengths;
    const sgt_wavelength *wavelength;
    bool                  every_wavelength;

    /* The points of the pupil.  NULL and zeros: the pattern of the analysis, with the
     * rays that it names.
     *
     *     pattern        which pattern
     *     rays           the n of sgt_pupil_points; 0: as many as suit the pattern
     *     across         used if not 0, in place of `rays`: how many rays there are
     *                    across the pupil (random, sobol: as many as a grid would have)
     *     points, point  used if not 0, in place of a pattern: how many points, and these
     */
    const sgt_pattern     *pattern;
    size_t                 rays, across;
    uint64_t               seed;      /* of a random pattern; 0: 1 */
    size_t                 points;
    const sgt_pupil_point *point;

    /* How work goes into threads: calls task(data, i) once for each i < tasks, in any
     * order and any threads, and returns when all are done.  NULL: one after another */
    void (*run)(void *context, size_t tasks, void (*task)(void *data, size_t i),
                void *data);
    void *context;

    /* Each point of the pupil weighs alike.  false: by the area that it stands for, as
     * sgt_pupil_points has it; only points of a hexapolar pattern differ in that */
    bool equal_weights;
    const sgt_shard *shard;  /* NULL: all of it, here */
    unsigned long long reserved_[2]; /* leave it zero */
} sgt_study_options;

typedef struct sgt_study sgt_study;

/* The lens, and what the options point to, have to last as long as the study.  NULL:
 * `error` (may be NULL) says what is wrong: no memory, no marginal ray to the real stop.
 * Fields, wavelengths and points are looked at when the study is asked. */
SGT_API sgt_study *sgt_study_new(const sgt_lens *lens, const sgt_study_options *opt,
                                 sgt_error *error);
SGT_API void       sgt_study_free(sgt_study *study); /* NULL: nothing */

/* The unit of length of a lens in micrometres; NaN: it does not say, or is not known. */
SGT_API double sgt_lens_unit(const sgt_lens *lens);

/* ---------------------------------------------------------------------- an analysis */

/* What the number of a column is, and how it is shown. */
typedef enum sgt_column_kind {
    SGT_COLUMN_NUMBER,      /* double; NaN: there is none */
    SGT_COLUMN_EXACT,       /* double that was given, to be shown in full */
    SGT_COLUMN_ERROR,       /* double: a bound, to be shown with two digits */
    SGT_COLUMN_WAVELENGTH,  /* double, um; NaN: none; SGT_ALL_WAVELENGTHS */
    SGT_COLUMN_COUNT,       /* size_t */
    SGT_COLUMN_PLACE,       /* size_t, from 1; 0: there is none */
    SGT_COLUMN_WHOLE,       /* double, a whole number of either sign */
    SGT_COLUMN_FATE,        /* int: an sgt_fate, or SGT_NO_RAY */
    SGT_COLUMN_VERDICT,     /* int: an sgt_limit_verdict (prove.h) */
    SGT_COLUMN_QUANTITY     /* int: an sgt_prove_quantity (prove.h) */
} sgt_column_kind;

/* As a wavelength: all together, as the lens weighs them. */
#define SGT_ALL_WAVELENGTHS 0.0

/* As a fate: it is proven that there is no such ray. */
#define SGT_NO_RAY (-2)

/* "passed", "clipped", "tir", "evanescent", "missed", "lost" or "none". */
SGT_API const char *sgt_study_fate_text(int fate);

/* What the unit of a column depends on. */
typedef enum sgt_dimension {
    SGT_UNIT_NONE,
    SGT_UNIT_MICROMETRE,
    SGT_UNIT_LENGTH,   /* of the lens */
    SGT_UNIT_IMAGE,    /* the same; of an afocal lens mrad, and the name ends in _mrad */
    SGT_UNIT_FOCUS,    /* the same; of an afocal lens 1/m, and the name has
                          _dioptre */
    SGT_UNIT_FIELD,    /* as fields of the lens have it: degrees or a length */
    SGT_UNIT_SWEEP,    /* degrees, or a length if the object is at a distance */
    SGT_UNIT_WAVE,
    SGT_UNIT_PERCENT,
    SGT_UNIT_PUPIL,    /* radii of the pupil */
    SGT_UNIT_DEGREE
} sgt_dimension;

enum {
    SGT_COLUMN_GROUPS = 1,  /* where it changes, a new group of rows begins */
    SGT_COLUMN_DETAIL = 2,  /* too much for a page that people read */
    SGT_COLUMN_PROVEN = 4,  /* there only if a proof is asked for */
    SGT_COLUMN_GIVEN = 8    /* there only if the setting of the same name is given */
};

typedef struct sgt_column {
    const char     *name;
    sgt_column_kind kind;
    sgt_dimension   dimension;
    unsigned        flags;
    size_t          offset;      /* in the row */
    size_t          error;       /* the offset of a double that bounds its error;
                                    0: none */
    const char     *help;
    unsigned long long reserved_[4];
} sgt_column;

typedef enum sgt_setting_kind {
    SGT_SETTING_FLAG,     /* bool */
    SGT_SETTING_COUNT,    /* size_t, from `least` to `most`; 0: the default */
    SGT_SETTING_WORD,     /* int: the place in `words`, which are separated by | */
    SGT_SETTING_NUMBER,   /* sgt_list of at most one */
    SGT_SETTING_NUMBERS,  /* sgt_list */
    SGT_SETTING_TEXT      /* const char *, zero-ended; NULL: the default */
} sgt_setting_kind;

/* Finite numbers. */
typedef struct sgt_list { size_t count; const double *at; } sgt_list;

typedef struct sgt_setting {
    const char      *name;
    sgt_setting_kind kind;
    size_t           offset;     /* in the options of the analysis */
    const char      *words;
    size_t           least, most;
    const char      *help;
    unsigned long long reserved_[4];
} sgt_setting;

typedef struct sgt_asking sgt_asking; /* a study that is being asked (src/lens/study) */

/* Plain data of the library. */
typedef struct sgt_analysis {
    const char  *name, *title, *help;
    bool         primary_alone;  /* by default at the primary wavelength */
    bool         no_fields;      /* it takes no fields */
    bool         no_rays;        /* it takes no points of the pupil, and no proof */
    sgt_pattern  pattern;        /* by default, with `rays` for its n */
    size_t       rays;
    const char  *part_of;        /* the analysis of which it is another view; or NULL */
    const char  *draw_x, *draw_y; /* a picture: this column against that one; or NULL */
    size_t       row_size, columns;
    const sgt_column *column;
    size_t       options_size, settings;
    size_t       options_room;   /* offset of reserved_ in the options; from there to
                                    options_size all must be zero */
    const sgt_setting *setting;
    bool       (*ask)(sgt_asking *of);
    unsigned long long reserved_[4];
} sgt_analysis;

/* The analyses, one after another; NULL: there are no more. */
SGT_API const sgt_analysis *sgt_analysis_at(size_t place);

/* NULL: there is none of that name. */
SGT_API const sgt_analysis *sgt_analysis_named(const char *name);

/* The column or the setting at a place, from 0; NULL: there are no more. */
SGT_API const sgt_column  *sgt_analysis_column(const sgt_analysis *analysis,
                                               size_t place);
SGT_API const sgt_setting *sgt_analysis_setting(const sgt_analysis *analysis,
                                                size_t place);

/* A column as this study fills it.
 *
 *     options  of the analysis, or NULL
 *     column   its place, from 0
 *     name     written, zero-ended
 *     unit     written, zero-ended: "mm", "mrad", "%"; "" if it has none or the lens does
 *              not say
 *
 * false: this study has no such column. */
SGT_API bool sgt_study_column(const sgt_study *study, const sgt_analysis *analysis,
                              const void *options, size_t column, char name[32],
                              char unit[32]);

/* How many rays met which fate. */
typedef struct sgt_fates {
    size_t rays, passed, missed, clipped, tir;
    size_t lost;                 /* could not be decided, or aiming found none */
    size_t none;                 /* proven: there is no such ray */
    size_t unfound;              /* how many of the lost rays aiming did not find */
    double within;               /* proven: none of the unfound rays is nearer than this
                                    to the centre of the pupil, in its radii; 0: not
                                    proven */
    size_t folded;               /* on a fold of the pupil */
    size_t proven;               /* passed, and proven at each surface */
    size_t evanescent;           /* the order of a phase does not exist for them */
    unsigned long long reserved_[3];
} sgt_fates;

/* A ray that was lost, and how to ask for it again. */
typedef struct sgt_lost_ray {
    size_t         field;        /* its number; 0: it is `at` of `kind` */
    sgt_field_kind kind;
    sgt_lens_field at;
    sgt_wavelength wavelength;
    double         px, py;
    double         defocus;
    bool           open;
    unsigned long long reserved_[2];
} sgt_lost_ray;

/* All rays of a run. */
typedef struct sgt_study_total {
    sgt_fates    fates;
    sgt_lost_ray lost;           /* the first, if fates.lost is not 0 */
    unsigned long long reserved_[4];
} sgt_study_total;

typedef enum sgt_remark_of_study {
    SGT_STUDY_NOTE,              /* something lacks */
    SGT_STUDY_LEGEND             /* what the numbers are */
} sgt_remark_of_study;

/* Where answers go.  All calls come from the thread that asks, in the order of the rows;
 * what they are given lasts until they return.  They may come from inside of `run`, while
 * other threads work.  NULL: not wanted. */
typedef struct sgt_sink {
    void  *context;
    void (*row)(void *context, const void *row);
    void (*say)(void *context, sgt_remark_of_study kind, const char *sentence);
    /* The rays of which a spot is made, before its rows: field and wavelength count from
     * 0 among those of the study, `surface` among the image surfaces */
    void (*ends)(void *context, size_t field, size_t surface, size_t wavelength,
                 size_t count, const sgt_ray_end end[]);
    size_t ends_most; /* 0: all of them; else the first so many of each spot, or some
                         more: up to the end of their block */
    unsigned long long reserved_[3];
} sgt_sink;

/* Computes an analysis of a study.
 *
 *     options  those of the analysis, or NULL; reserved_ must be zero
 *     sink     where rows and remarks go; reserved_ must be zero
 *     total    NULL, or written: what became of all rays
 *
 * false: `error` (may be NULL) says why; some rows may have been given out before.  A
 * wrong setting is reported with its name as the key, and line 0. */
SGT_API bool sgt_study_run(const sgt_study *study, const sgt_analysis *analysis,
                           const void *options, const sgt_sink *sink,
                           sgt_study_total *total, sgt_error *error);

/* How many decimal digits of a value are certain, if it is off by no more than error: 0
 * to 16. */
SGT_API size_t sgt_digits(double value, double error);

/* ------------------------------------------------------ the rows of each analysis
 *
 * In all of them: field counts from 1, wavelength is in um, lengths are in the unit of
 * the lens and in the frame of its last surface.  For an afocal lens SGT_UNIT_IMAGE are
 * angles in milliradians. */

/* What became of the rays of a row. */
typedef struct sgt_fate_counts {
    size_t missed, clipped, tir, lost, none, proven, evanescent;
} sgt_fate_counts;

/* "ends": where the rays end; the study itself. */
typedef struct sgt_ends_row {
    size_t field;
    double wavelength;
    int    fate;
    size_t element;              /* where it ended, from 1; 0: it was not traced */
    sgt_ray_end end;
    double opl_err;              /* how far rounding puts end.opl off, to first order */
    unsigned long long reserved_[1];
} sgt_ends_row;

/* "spot": a row for each wavelength, then one for all. */
typedef struct sgt_spot_options {
    int      reference;          /* 0 chief: the chief ray of the primary wavelength; 1
                                    centroid: the mean of the rays of the row */
    sgt_list defocus;            /* moves the image surface along its own z */
    unsigned long long reserved_[4];
} sgt_spot_options;

typedef struct sgt_spot_row {
    size_t field;
    double wavelength;
    size_t rays, passed;
    double x, y;                 /* the reference */
    double rms, rms_x, rms_y, geometric, airy;
    size_t digits;               /* of rms */
    double sampling;             /* rms, less that of half as many rays across */
    sgt_fate_counts fates;
    double defocus;
    double xy_err, rms_err;      /* bounds on the error of x and y, and of rms */
    unsigned long long reserved_[2];
} sgt_spot_row;

/* "fan": transverse errors from the chief ray of the primary wavelength. */
typedef struct sgt_fan_row {
    size_t field;
    double wavelength, px, py;
    int    fate;
    double ex, ey, e_err;
    unsigned long long reserved_[2];
} sgt_fan_row;

/* "opd", "wavefront" (the same, summed up), "zernike" (fitted by polynomials): paths in
 * waves, less that of the chief ray of the same wavelength. */
typedef struct sgt_opd_options {
    bool   afocal;               /* against a plane; the default if the lens is afocal */
    size_t terms;                /* zernike: how many; 0: 37 */
    int    order;                /* zernike: 0 Noll, 1 fringe */
    unsigned long long reserved_[4];
} sgt_opd_options;

typedef struct sgt_opd_row {
    size_t field;
    double wavelength, px, py;
    int    fate;
    double opd, opd_err;
    unsigned long long reserved_[2];
} sgt_opd_row;

typedef struct sgt_wavefront_row {
    size_t field;
    double wavelength, pv, rms;
    size_t digits;               /* of rms */
    double sampling;
    size_t rays, passed;
    sgt_fate_counts fates;
    double rms_err;
    unsigned long long reserved_[2];
} sgt_wavefront_row;

typedef struct sgt_zernike_row {
    size_t field;
    double wavelength;
    size_t term, n;
    double m;                    /* a whole number; negative: a sine */
    double coefficient, residual;
    unsigned long long reserved_[2];
} sgt_zernike_row;

/* "field": curvature and distortion along the chief rays. */
typedef struct sgt_field_options {
    int    distortion;           /* an sgt_distortion */
    size_t steps;                /* fields from the axis to the farthest; 0: those of the
                                    study */
    unsigned long long reserved_[4];
} sgt_field_options;

typedef struct sgt_field_row {
    size_t field;
    double wavelength, tangential, sagittal;
    double distortion_percent;
    double fx, fy;
    int    fate;
    double x, y, xy_err, ideal;
    size_t digits, lacks;        /* as in sgt_field_point */
    unsigned long long reserved_[2];
} sgt_field_row;

/* "map": what becomes of rays over the pupil, or of one ray over a square of fields. */
typedef struct sgt_map_options {
    int    over;                 /* 0 the pupil of each field; 1 the field */
    size_t steps;                /* steps x steps fields; 0: 21 */
    unsigned long long reserved_[4];
} sgt_map_options;

typedef struct sgt_map_row {
    size_t field;                /* over the field: the point, from 1 */
    double wavelength, fx, fy, px, py;
    int    fate;
    size_t element;              /* where it ended, from 1; 0: it was not traced */
    size_t evals;
    double t_err, condition;
    unsigned long long reserved_[2];
} sgt_map_row;

/* "sweep": how many rays meet which fate, against the field. */
typedef struct sgt_sweep_options {
    sgt_list from, to;           /* none: from the axis to twice the farthest field */
    size_t   steps;              /* 0: 46 */
    unsigned long long reserved_[4];
} sgt_sweep_options;

typedef struct sgt_sweep_row {
    double at, wavelength;
    size_t rays, passed, missed, clipped, tir, lost, none;
    double evals;
    size_t proven, evanescent;
    unsigned long long reserved_[1];
} sgt_sweep_row;

/* "energy": how much of the light falls within a radius about the centroid or the chief
 * ray. */
typedef struct sgt_energy_options {
    int      reference;          /* 0 centroid: of all wavelengths together; 1 chief */
    sgt_list radius;             /* in the unit of the image; none: `steps` of them,
                                    to the largest distance in any field */
    size_t   steps;              /* 0: 20 */
    unsigned long long reserved_[4];
} sgt_energy_options;

typedef struct sgt_energy_row {
    size_t field;
    double wavelength, radius;
    double fraction;             /* of the light that passes: 0 to 1 */
    double unsure;               /* the share of rays for which it is uncertain on which
                                    side of the radius they lie: fraction is off by no
                                    more */
    double sampling;             /* fraction, less that of half as many rays across */
    unsigned long long reserved_[2];
} sgt_energy_row;

/* "illumination": how much of the pupil passes, and what reaches the image of it. */
typedef struct sgt_illumination_row {
    size_t field;
    double wavelength;
    size_t rays, passed;
    double fraction;             /* of the area of the pupil whose rays pass: 0 to 1 */
    double cos4;                 /* cos^4 of the angle of the chief ray of the wavelength
                                    from the z axis of the last element; NaN: the chief
                                    ray does not reach it */
    double illumination;         /* fraction cos4 */
    double unsure;               /* the share of rays that were lost: the fraction is too
                                    small by no more */
    double sampling;             /* fraction, less that of half as many rays across */
    sgt_fate_counts fates;
    double cos4_err, illumination_err; /* bounds on the error of each */
    unsigned long long reserved_[2];
} sgt_illumination_row;

#ifdef __cplusplus
}
#endif
#endif
