// SPDX-License-Identifier: MIT
/* tolerance.h (of the room) - a lens whose tolerances are asked about. */
#ifndef SGT_TOLERANCE_TOLERANCE_H
#define SGT_TOLERANCE_TOLERANCE_H
#include "../base/arena.h"

#include <sagitta/edit.h>
#include <sagitta/tolerance.h>

/* A surface that some entry puts off, as it is designed. */
typedef struct off_surface {
    size_t number;              /* from 1 */
    bool curved, by_radius;     /* its curvature is put off; by its radius alone, as the file gives it */
    bool fringed;               /* by fringes: a plane becomes a sphere */
    bool shaped, thick, placed, indexed;
    double radius, curvature, thickness;
    double *index;              /* [wavelengths] */
    double rim;                 /* of the irregularity; several of one surface have one */
    size_t terms;
    sgt_pose pose;              /* as the lens has it */
    bool by_origin;
    sgt_vec3 decenter, tilt;    /* as the file has them */
} off_surface;

struct sgt_tolerancing {
    const sgt_lens *of;
    sgt_lens *base;             /* the same, without pickups and solves */
    arena memory;
    sgt_tolerancing_options opt;
    sgt_study_options study;    /* for one lens: in one thread */
    void (*run)(void *context, size_t tasks, void (*task)(void *data, size_t i), void *data);
    void *context;
    size_t count;
    const sgt_tolerance *entry; /* [count] */
    size_t surfaces;
    off_surface *surface;       /* [surfaces] */
    size_t edits, text;         /* the most that a point needs */
    double um;                  /* the unit of length */
    double nominal, image;      /* the figure, and the paraxial image, as designed */
    sgt_vec2 *chief;            /* [fields]: of the boresight, where chief rays end as designed */
};

/* (build.c) Finds the surfaces that are off.  false: `error`. */
bool sgt_off_surfaces(sgt_tolerancing *t, sgt_error *error);

/* (build.c) Makes `lens`, a copy of the base, that of a point.  false: `error`. */
bool sgt_build_at(const sgt_tolerancing *t, sgt_lens *lens, const double value[], sgt_error *error);

/* (figure.c) The figure of a lens.  false: no memory. */
bool sgt_figure_of(const sgt_tolerancing *t, const sgt_lens *lens, double *figure, sgt_error *error);

/* (figure.c) What the figure needs of the lens as designed: sets t->nominal.  false: `error`. */
bool sgt_figure_begin(sgt_tolerancing *t, sgt_error *error);

/* Derivatives of the figure by each entry, and of the first compensator, which follows; [count] of both.
 * NaN: there is none, as of the compensators.  even: the figure is 0 and grows to either side. */
typedef struct slopes {
    double *figure, *compensator;
    bool even;
} slopes;

/* (slope.c) At a point with its compensators set.  false: no memory. */
bool sgt_slopes_at(const sgt_tolerancing *t, const double value[], slopes *out, sgt_error *error);

/* (figure.c) Of a point: seeks the compensators and sets them.  lens: a copy of the base. */
bool sgt_figure_at(const sgt_tolerancing *t, sgt_lens *lens, double value[], double *figure,
                   sgt_error *error);

#endif
