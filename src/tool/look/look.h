/* look.h - what the analyses of a lens share: their options, the lens at each wavelength, the beams of its
 * fields, and where their rays end. */
#ifndef TOOL_LOOK_H
#define TOOL_LOOK_H
#include "../job/job.h"

#include <sagitta/analysis.h>

typedef struct look_options {
    shared_options shared;
    job_options job;
    const char *picture;        /* NULL: none */
    /* Set by the analysis; zeros fit one that takes fields and no pattern. */
    const char *pattern;        /* for --help: the rays by default; NULL: it takes no pattern */
    bool no_fields;             /* for --help: it takes no --field and no --fields */
    bool primary_alone;         /* by default at the primary wavelength, not at all of the lens */
} look_options;

enum { LOOK_PICTURE = OPTION_AFTER_JOB, OPTION_AFTER_LOOK };

/* To be put into the table of options of an analysis, which ends with {0}. */
#define LOOK_OPTIONS                                    \
    {"picture", required_argument, NULL, LOOK_PICTURE}, \
    JOB_OPTIONS, PROOF_OPTION, THREADS_OPTION, ROWS_OPTIONS, SHARED_OPTIONS
#define LOOK_LETTERS ROWS_LETTERS

/* Takes an option that is none of the analysis's own.  help: what --help says before that of the rays. */
void look_take_option(look_options *o, int code, const char *help);

/* The lens from the arguments that are left.  name: of the analysis. */
void look_take_lens(look_options *o, int argc, char *argv[], const char *name);

/* How many rays met which fate. */
typedef struct look_fates {
    size_t rays, passed, missed, clipped, tir, lost;
    size_t none;                /* aiming has proven that there is no such ray */
    size_t unfound;             /* (of those that are lost) that aiming has not found */
    double within;              /* of these: none lies within so many radii of the pupil; 0: not proven */
    size_t folded;              /* (of those that were launched) that are on a fold of the pupil */
    size_t proven;              /* (of those that passed) */
} look_fates;

/* The lens at a wavelength. */
typedef struct look_band {
    lens lens;
    sgt_element *element;
    sgt_first_order data;
    double weight;
} look_band;

typedef struct look {
    const look_options *asked;
    int threads;
    size_t bands;
    look_band *band;            /* [bands], of the wavelengths that are asked for */
    look_band primary;          /* of the lens */
    sgt_launcher *from;
    field_list fields;
    sgt_field_beam *beam;       /* [fields.count] */
    double um;                  /* the unit of length in micrometres; NaN: it is not known */
    look_fates fates;           /* of all rays of look_trace */
    const char *options;        /* of what is traced now, for `lost`; NULL: none */
    const char *lost;           /* the options of sagitta diagnose that show the first lost ray; NULL: none */
} look;

/* Reads the lens and sets what is above, by default for all its wavelengths.  Of a lens without wavelengths
 * `primary` is the first band.  Any error ends the command. */
look look_begin(const look_options *o);

/* That of the fields of the lens which is farthest from the axis. */
const sgt_lens_field *look_farthest(const look *l);

/* The beam of any field. */
sgt_field_beam look_beam(const look *l, sgt_field_kind kind, sgt_lens_field at);

/* Where the rays of a beam end, in threads.  element: those of the band, or the same with another last one.
 * counted: they are added to l->fates.  end: [points->count]. */
void look_trace(look *l, const sgt_field_beam *beam, const look_band *band, const sgt_element *element,
                const launch_pattern *points, bool counted, sgt_ray_end end[]);

/* The end of the chief ray, whatever clips it. */
sgt_ray_end look_chief(const look *l, const sgt_field_beam *beam, const look_band *band,
                       const sgt_element *element);

/* Notes how to ask for a ray again, if it is the first that is lost.  options: of the field and more. */
void look_lost(look *l, const look_band *band, const char *options, const sgt_ray_end *end);

/* The options of a field. */
const char *look_field_option(sgt_field_kind kind, const sgt_lens_field *at);

/* The same pattern with half as many rays across the pupil; none where that cannot be. */
launch_pattern look_coarser(const look *l, const launch_pattern *points);

void look_count(look_fates *f, const sgt_ray_end *end);

/* A number, or an empty cell for a NaN. */
void look_number(table *t, double value);

/* How many decimal digits of a value are certain: 0 to 16. */
int look_digits(double value, double error);

/* "passed", "lost" and so on, or "none": there is no such ray.  The cell has sgt_fate as its code, or
 * LOOK_NONE. */
enum { LOOK_NONE = -2 };
const char *look_fate(const sgt_ray_end *end);
void look_fate_cell(table *t, const sgt_ray_end *end);

/* The cells of a field's number (from 1) and of a wavelength, which is empty where there is none. */
void look_cells(table *t, const look *l, size_t field, const look_band *band);

/* The columns that say what became of the rays that did not pass, and their cells.  Text has none of them:
 * the line below the table tells it of all. */
size_t look_fate_columns(const look *l, column *to);
enum { LOOK_FATES = 6 };
void look_fate_cells(table *t, const look *l, const look_fates *f);

/* The last lines under a table for people: what became of the rays. */
void look_verdict(table *t, const look *l);

exit_status look_status(const look *l);

/* ---------------------------------------------------------------- for pictures */

/* A length as pictures show it: micrometres, or the unit of the lens where that is not known. */
double look_small(const look *l, double length);
const char *look_small_unit(const look *l);

/* Texts that last until the command ends. */
const char *look_text(const char *format, ...) LIKE_PRINTF(1, 2);
const char *look_signed(double x);                         /* with the minus sign of the axes */
const char *look_title(const look *l, const char *what);   /* "Cooke triplet: spots" */
const char *look_lens_line(const look *l);                 /* its wavelengths, unit, and what is proven */
const char *look_fates_line(const look *l, const look_fates *f); /* "316 rays: 300 passed, 16 clipped" */
const char *look_field_name(const look *l, size_t field);  /* "field 2: 14°" */
size_t look_colour(const look *l, size_t band);            /* bluer where the wavelength is shorter */
const char *look_wavelength_name(const look_band *band);   /* "0.5876 µm", or NULL */
const char *look_field_axis(const look *l);                /* "field (degrees)" */

#endif
