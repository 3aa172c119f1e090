// SPDX-License-Identifier: MIT
/* figure.h (of the room) - a lens as a row of numbers, and how a number of its file moves them. */
#ifndef SGT_FIGURE_FIGURE_H
#define SGT_FIGURE_FIGURE_H
#include "../study/analyses.h"
#include "../study/study.h"

#include <sagitta/figure.h>

/* A lens that is looked at: its study, and all numbers that its rays hang on. */
typedef struct look_of_lens {
    sgt_study *study;
    sgt_asking ask;
    double *number; /* [layout.end]; NULL: not listed yet */
} look_of_lens;

/* Where the numbers stand.  A slot is a wavelength of the study, or, the last, the primary one. */
enum { BEAM_NUMBERS = 16, FIRST_NUMBERS = 3, AXES = 9 };
typedef struct place {
    size_t at, end;
    const sgt_param *of;
} place;
typedef struct places_in_struct {
    size_t count;
    place *at;
} places_in_struct;
typedef struct layout {
    size_t trace, slots; /* numbers of a trace (sgt_trace_parameters), a row for each slot; turns are
                            left 0: they are in the axes */
    size_t phases, phase; /* numbers of phases (sgt_phase_parameters), a row for each slot, from there on */
    size_t axes;         /* [elements * 9] */
    size_t beams;        /* [fields * 16]: the members of sgt_field_beam in order, but `front` */
    size_t stop;         /* the height on the stop that the rim of the pupil is aimed at */
    size_t first;        /* [slots * 3]: efl, exit_pupil, 1 / exit_pupil */
    size_t ideal;        /* [fields * slots]: the height of an image without distortion */
    size_t fixed;        /* what must not move: numbers that are no parameters */
    size_t weights;      /* of fields and wavelengths, and the wavelengths; the same */
    size_t end;
    const places_in_struct *of; /* [2 * elements]: where the numbers of its surface stand in its struct;
                                   then those of its phase's waves */
} layout;

/* Which faults are told: of a figure with its lens. */
typedef struct looking {
    const sgt_study_options *options;
    const sgt_analysis *of;
    bool path;  /* optical paths matter */
    bool first; /* first-order data do, not by the rays alone */
} looking;

/* (look.c) Looks at a lens, with points of the pupil; or without, and wavefronts begin anywhere.  false:
 * `error` says why.  look_end frees in either case. */
bool sgt_look_begin(look_of_lens *l, const sgt_lens *lens, const looking *how, bool points, sgt_error *error);
void sgt_look_end(look_of_lens *l);

/* (look.c) Lists its numbers; *out is set if they are the first.  false: no memory, or a lens whose numbers
 * are others than in *out. */
bool sgt_look_list(look_of_lens *l, layout *out, bool first);

/* The elements of a slot, and the index in front. */
static inline const band *sgt_look_slot(const look_of_lens *l, size_t slot)
{
    return slot < l->ask.bands ? &l->ask.band[slot] : &l->ask.primary;
}

/* How the numbers move with one of the file. */
typedef struct motion {
    double *by, *error; /* [layout.end], with turns; estimates of the error */
    bool beams;         /* any number of a beam, or of the stop's size */
} motion;

/* Numbers that a lens is made with: those at paths of its file, or others. */
typedef struct lens_numbers {
    size_t count;
    const char *const *path; /* [count]: their paths, or what they are called in an error */
    const double *step;      /* [count]: steps of differences; NULL: as the paths say */
    const void *context;
    /* Makes `lens`, that has the numbers `from`, one with the numbers `to`.  false: it is as it was */
    bool (*put)(const void *context, sgt_lens *lens, const double from[], const double to[],
                sgt_error *error);
} lens_numbers;

/* (figure.c) As sgt_figure_new, by other numbers than those at paths: x of `lens`.  Where there is no
 * derivative it is 0, and figure_has_none tells so after an evaluation.  What `by` points to has to last. */
sgt_figure *sgt_figure_by(const sgt_lens *lens, const sgt_study_options *study, const sgt_figure_options *opt,
                          const lens_numbers *by, const double x[], sgt_error *error);
bool sgt_figure_has_none(const sgt_figure *f, size_t m);

/* (motion.c) A lens that is moved by its numbers: a copy that may be edited, with the numbers it has and
 * those that are wanted; how its rays' numbers are looked at, where they stand, and what they are now. */
typedef struct moved_lens {
    const lens_numbers *of;
    sgt_lens *copy;
    double *has, *wanted;       /* [of->count] */
    const looking *how;
    const layout *at;
    const look_of_lens *now;
} moved_lens;

/* By number m of those wanted.  false: `error` names the path. */
bool sgt_motion_of(const moved_lens *l, size_t m, motion *out, sgt_error *error);

/* (rays.c) Rays of one field and slot: launched, traced, and gone back. */
enum { FLOCK = 64 };
typedef struct flock {
    const look_of_lens *at;
    const layout *in;
    size_t elements, stop_numbers;
    sgt_element *own, *open; /* [elements]: as rays meet them */
    sgt_passage *passage;    /* [elements], of one ray */
    sgt_passages *passages;
    size_t field, slot, count;
    sgt_field_beam beam;
    bool vignetted; /* its vignetting counts */
    double before;
    sgt_pupil_point point[FLOCK];
    double *o[3], *d[3]; /* [FLOCK]: the launch rays; NaN: there is none */
    sgt_fate *fate;
    bool there[FLOCK];
    double **gradient; /* [rows * in->trace], each [FLOCK] or NULL */
    double **to_stop;  /* [2 * in->trace] */
    bool bends;        /* a number of a phase moves */
    double **by_phase; /* [rows * in->phases], each [FLOCK], all if it bends; else NULL */
    double **phase_to_stop; /* [2 * stop_phases] */
    size_t stop_phases;
    double *ray_row;   /* [rows * in->phases]: of one ray */
    size_t rows;
} flock;

enum { FLOCK_ROWS = 7 };
/* Room, from the memory of the look.  needed: of all motions, NULL: no derivatives.  false: no memory. */
bool sgt_flock_begin(flock *f, look_of_lens *at, const layout *in, size_t motions, const motion *of);

/* Traces the rays of a field and slot through points of the pupil.  chief: whatever clips it, one point.
 * unbent: the last element bends nothing.  false: no memory. */
bool sgt_flock_trace(flock *f, size_t field, size_t slot, size_t count, const sgt_pupil_point point[],
                     bool chief, bool unbent, bool vignetted);

/* Where ray k is at the last element. */
sgt_ray_change sgt_flock_end(const flock *f, size_t k);

/* Bounds on the points where the rays are, one for each. */
void sgt_flock_errors(const flock *f, double point[]);

/* Takes `rows` weighted sums of the ends back (aim.h): before sgt_flock_move. */
void sgt_flock_back(flock *f, size_t rows, const sgt_ray_changes weight[]);

/* How row r of all rays moves: out[k].  error (may be NULL): an estimate.  0 where no ray passed. */
void sgt_flock_move(const flock *f, const motion *m, size_t row, double out[], double error[]);

#endif
