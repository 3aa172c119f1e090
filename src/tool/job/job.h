// SPDX-License-Identifier: MIT
/* job.h - a lens and the rays to send through it, as the arguments ask for them. */
#ifndef TOOL_JOB_H
#define TOOL_JOB_H
#include "../read/lens.h"
#include "launch.h"
#include "options.h"
#include "../read/rays.h"

typedef struct job_options {
    const char *lens, *rays;          /* files */
    sgt_lens *of;                     /* the lens if it is there already; NULL: that of the file */
    sgt_lens_field *field;            /* --field, one after another */
    size_t fields, capacity;
    bool field_at;                    /* those of --field-at, not of --field */
    const char *field_kind;           /* its KIND; NULL: as the lens has it */
    size_t *number;                   /* --fields, one after another, from 0 */
    size_t numbers, number_capacity;
    bool all_fields;                  /* --fields all */
    sgt_pupil_point *pupil;           /* --pupil and --chief, one after another */
    size_t pupils, pupil_capacity;
    long points;                      /* the N of --fan N and its like; 0: not given */
    sgt_pattern pattern;              /* then */
    long seed;                        /* of --random; 0: not given */
    bool aimed, aim_given;            /* --aim real; --aim */
    lens_wavelength *wavelength;      /* --wavelength, one after another */
    size_t wavelengths, wavelength_capacity;
    bool all_wavelengths;             /* --wavelength all */
    bool several;                     /* set by a command that takes several wavelengths */
    bool parts;                       /* set by a command that calls job_part */
    bool skip_bad, no_apertures;
    char *again;                      /* --set, --glass, --strict, --aim, --no-apertures as given; or NULL */
    int threads;                      /* to read rays with; 0: one */
    double defocus;                   /* set by a command: moves the last element along its own z */
} job_options;

/* The groups of OPTIONS_OF_JOB. */
extern const option_group job_fields_options, job_pattern_options, job_aim_options, job_file_options,
    job_wavelength_options, job_glass_options, job_aperture_options;
#define JOB_GROUPS                                                                           \
    &job_fields_options, &job_pattern_options, &job_aim_options, &job_file_options,          \
    &job_wavelength_options, &job_glass_options, &job_aperture_options
/* For commands that tell why they do not take them. */
extern const option_group job_no_fields, job_no_pattern, job_no_file;

/* The lens at a wavelength; its elements, without apertures for --no-apertures; the rays for it: `rays`, or
 * for a job in parts the plan. */
typedef struct job_lens {
    lens lens;
    const sgt_element *element;
    ray_list rays;
    launch_plan plan;         /* of no fields: there is none */
} job_lens;

typedef struct job {
    size_t wavelengths;       /* one for each --wavelength */
    job_lens *at;
    lens lens;                /* the first */
    const sgt_element *element;
    ray_list rays;            /* those of the first wavelength */
    launch_how *how;          /* NULL: rays from a file */
    size_t undecided;         /* how many rays aiming has neither found nor excluded */
    size_t fields;            /* 0: the rays came from a file */
    const sgt_lens_field *field;
    const size_t *field_number; /* as in field_list */
    sgt_field_kind field_kind;
} job;

/* Rays of a job in parts: how many at each wavelength, those that are not there included; and some of them,
 * at most TILE_RAYS. */
size_t job_count(const job_lens *at);
void job_part(const job_lens *at, size_t first, size_t count, ray_block *to);

/* Notes what aiming did not find, when all parts are taken. */
void job_end_parts(job *j);

/* The whole line of a ray, from -infinity to infinity, in an element's own frame. */
sgt_ray job_own_ray(const sgt_pose *pose, const sgt_ray *ray);

/* The lens at each wavelength that is asked for. */
typedef struct lens_list { size_t count; lens *lens; } lens_list;
lens_list job_lenses(const job_options *o);

/* The same for each configuration, one after another, where all are asked for.  *all has them. */
lens_list job_lenses_of_each(const job_options *o, lens_each *all);

/* The fields that are asked for: those of --field, those of --fields, or all of the lens. */
typedef struct field_list {
    size_t count;
    const sgt_lens_field *at;
    const size_t *number;     /* of each in the lens, from 0; with --field from 0 on */
    sgt_field_kind kind;
} field_list;
field_list job_fields(const job_options *o, const lens *l);

/* The KIND of --field-at. */
const char *job_field_kind(sgt_field_kind kind);

/* The points of the pupil that are asked for; without any, those of `otherwise`, n of them. */
launch_pattern job_points(const job_options *o, sgt_pattern otherwise, size_t n);

/* The same without the points: what was asked for, as sgt_study_options has it (study.h).  otherwise: the
 * pattern if none was. */
typedef struct job_points_asked {
    sgt_pattern pattern;
    size_t rays;              /* 0: no pattern was asked for */
    uint64_t seed;
    size_t count;             /* of single points */
    const sgt_pupil_point *at;
} job_points_asked;
job_points_asked job_points_of(const job_options *o, sgt_pattern otherwise);

/* Where rays are sent: NULL is as the lens says. */
const sgt_lens_aim *job_aim(const job_options *o, const sgt_lens *l);

/* Moves an element along its own z. */
void job_move(sgt_pose *pose, double z);

/* The elements without apertures for --no-apertures. */
const sgt_element *job_elements(const job_options *o, const lens *l);

/* Reads the lens and the rays.  Any error ends the command. */
job job_read(const job_options *o);

#endif
