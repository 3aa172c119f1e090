// SPDX-License-Identifier: MIT
/* look.h - a subcommand that asks an analysis of sagitta_lens (study.h), and prints and draws the answer.
 *
 * Nothing is computed here: the library has the analyses, their columns and their settings, in tables. */
#ifndef TOOL_LOOK_H
#define TOOL_LOOK_H
#include "../draw/chart.h"
#include "../job/job.h"
#include "../show/table.h"

#include <sagitta/study.h>

/* The rays of a spot, as they come before its rows: the first so many at most. */
enum { LOOK_ENDS = 20000 };
typedef struct look_ends { size_t count, room; sgt_ray_end *end; } look_ends;

/* What was asked and what came of it: all that a picture needs. */
typedef struct look {
    shared_options shared;
    job_options job;
    const char *picture;        /* NULL: none */
    const sgt_analysis *of;
    const sgt_setting **set;    /* [sets]: the settings that were given */
    size_t sets;
    void *options;              /* of the analysis */
    sgt_study *study;
    lens primary, *band; /* [bands]: the lens at its primary wavelength, and at those that are asked for */
    size_t bands;
    field_list fields;
    double um;                  /* the unit of length in micrometres; NaN: it is not known */
    table *table;
    sgt_study_total total;
    char *row;                  /* [rows] with a picture: each of of->row_size bytes */
    size_t rows, room;
    look_ends *ends;            /* [fields * surfaces * bands] if the picture wants them */
    size_t surfaces;
    /* over a number of the lens (over.c) */
    bool over;
    double at, *row_at;         /* its value now, and at each row that is kept */
    size_t step, row_at_room;   /* from 0 */
} look;

/* An option that makes another analysis of it: "--zernike 10" is the analysis zernike with terms 10. */
typedef struct look_view {
    const char *option, *analysis, *setting, *help;
    bool several;               /* its setting is a text, of several with semicolons between */
} look_view;

/* An analysis asked at each of several values of a number of the lens; its rows begin with the value. */
typedef struct look_over {
    const char *analysis;
    const char **path;
    double *from, *to;          /* NaN: not given */
    int *steps;
} look_over;

/* What a subcommand adds to its analysis. */
typedef struct look_way {
    const look_view *view;      /* ends with {NULL} */
    const option_row *own;      /* options of the command's own; ends with {NULL}.  NULL: none */
    const look_over *over;      /* what is asked again and again; NULL: nothing */
    bool ends;                  /* the picture wants the rays of a spot */
    const char *(*analysis)(
        look *l); /* the options that were given may choose another one.  NULL: they do not */
    const char *(*counted)(const look *l); /* of what --progress counts: "boxes".  NULL: it is not shown */
    void (*check)(look *l);     /* before anything is read; a fault ends the command.  NULL: none */
    void (*draw)(const look *l); /* NULL: as draw_x and draw_y of the analysis say */
    exit_status (*end)(look *l); /* the last lines under the table, and the exit status; its rows are kept.
                                    NULL: what became of the rays */
} look_way;

/* The command has the name of its analysis; its options and most of its help are those of the library. */
exit_status look_run(const command *c, const look_way *way, int argc, char *argv[]);

/* The study that l->job and l->shared ask for, of the analysis l->of; sets l->primary, band and fields.  It
 * reads the lens.  *threads must last as long as the study. */
sgt_study_options look_study(look *l, const job_points_asked *points, int *threads);

/* A command for an analysis that has none of its own. */
command look_command(const sgt_analysis *a);

/* Is this setting of the analysis given? */
bool look_given(const look *l, const char *setting);

/* ------------------------------------------------------------------ for pictures */

const void *look_row(const look *l, size_t i);

/* The rows of another analysis of the same study, with the same options. */
look look_again(const look *l, const char *analysis);

/* A double of a row by the place of its column, and the column of a name; of->columns: there is none. */
double look_value(const look *l, const void *row, size_t place);
size_t look_column(const look *l, const char *name);

/* Its name and unit as this lens has them: "ey (mm)". */
const char *look_label(const look *l, const char *name);
const char *look_unit(const look *l, const char *name);

/* Which of the wavelengths this is; l->bands: none.  Which of the fields has this number. */
size_t look_band_of(const look *l, double um);
size_t look_field_of(const look *l, size_t number);

/* Texts that last until the command ends. */
const char *look_signed(double x);                         /* with the minus sign of the axes */
const char *look_title(const look *l, const char *what);   /* "Cooke triplet: spots" */
const char *look_lens_line(const look *l);                 /* its wavelengths, unit, and what is proven */
const char *look_fates_line(const look *l, const sgt_fates *f); /* "316 rays: 300 passed, 16 clipped" */
const char *look_field_name(const look *l, size_t field);  /* "field 2: 14°" */
const char *look_field_words(const look *l, size_t number); /* the option for it: "--fields 2" */
size_t look_colour(const look *l, size_t band);            /* bluer where the wavelength is shorter */
const char *look_wavelength_name(const look *l, size_t band); /* "0.5876 µm", or NULL */
const char *look_field_axis(const look *l);                /* "field angle (degrees)" */

/* What became of the rays, for the last lines under a table. */
void look_verdict(const look *l);

/* ---------------------------------------------------------------------- the parts */

/* (curves.c) A panel for each field (or one), a curve for each wavelength: draw_y against draw_x. */
void look_draw_curves(const look *l);

/* (curves.c) The column of a name against the value of the path. */
void look_draw_over(const look *l, const char *path, const char *figure);

/* (help.c) Prints the columns: context is a look_help. */
typedef struct look_help { const sgt_analysis *of; const look_view *view; } look_help;
void look_print_columns(const void *context);
const char *look_column_words(const void *context); /* their names, with blanks between */

/* The rays by default, as an option: "--hexapolar 10". */
const char *look_default_rays(const sgt_analysis *a);

#endif
