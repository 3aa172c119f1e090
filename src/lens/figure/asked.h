// SPDX-License-Identifier: MIT
/* asked.h - a figure, and an evaluation of it: what figure.c has and the files of its kinds share. */
#ifndef SGT_FIGURE_ASKED_H
#define SGT_FIGURE_ASKED_H
#include "figure.h"

struct sgt_figure {
    sgt_allocator allocator;
    arena memory;
    sgt_lens *lens;
    sgt_study_options study;
    looking how;
    sgt_figure_options opt;
    lens_numbers by;
    double *x;      /* [by.count]: as the lens has them */
    bool *none;     /* [by.count]: set where there is no derivative; NULL: that is refused */
    sgt_edit *edit; /* [by.count]: of a figure by paths, room for those of all */
    sgt_figure_count size;
};

/* An evaluation. */
typedef struct asked {
    sgt_figure *of;
    sgt_figure_out *out;
    sgt_error *error;
    look_of_lens at;
    layout in;
    flock rays;
    size_t paths;                /* 0: no derivatives are wanted */
    motion *motion;              /* [paths] */
    double *residual, *jacobian; /* of the caller, or room */
    /* of the group that is summed: an rms and its gradient */
    double *sum, *sum_error, *moved;
    bool bounds;   /* errors are wanted */
    double *chief; /* [FLOCK_ROWS * paths]: how a chief ray's end moves */
    double *chief_error;
} asked;

/* Numbers, zeroed, until the evaluation ends; NULL: no memory, and it has failed. */
static inline double *sgt_asked_room(asked *a, size_t count)
{
    return sgt_ask_room(&a->at.ask, count, sizeof(double));
}

static inline bool sgt_asked_failed(const asked *a) { return a->at.ask.failed; }

/* (chief.c) Traces a chief ray, and takes all of its end back: a->chief.  false: it failed. */
bool sgt_chief_trace(asked *a, size_t field, size_t slot, bool unbent, bool vignetted, sgt_ray_change *end);

/* (chief.c) A bound on where the chief ray that was traced last ends. */
double sgt_chief_error(const asked *a);

/* (sums.c) Rays of a field and wavelength at their places in residual and jacobian: `each` numbers a ray. */
typedef struct ray_group {
    size_t first, count, each;
} ray_group;

/* (sums.c) Of rays, or of several groups of them: its residuals e with weights w become sqrt(share w / W) e;
 * the rms of those is value[i].  about_mean: less their weighted mean. */
void sgt_sum_up(asked *a, size_t value, ray_group g, const double weight[], double share, bool about_mean,
                double off, double own_error[]);

/* (sums.c) The root of the weighted mean of the squares of all values before the last. */
void sgt_sum_values(asked *a, const double share[]);

/* (sums.c) Shares of fields x bands, which add up to 1.  each: of every wavelength; else of fields. */
double *sgt_sum_shares(asked *a, bool each);

/* (sums.c) What became of a ray, as a weight; NaN residuals of what is lost. */
double sgt_sum_weight(asked *a, const flock *f, size_t k, double weight, size_t row, size_t each);

/* (sums.c) How residual row + k * each + c moves with path m, less what `chief` moves by. */
void sgt_sum_moves(asked *a, size_t c, size_t each, size_t row, const double chief[], double error[]);

/* (sums.c) Room for the errors of a Jacobian; NULL: they are not wanted. */
double *sgt_sum_errors(asked *a);

/* The kinds: false, it failed.  (chief.c, spot.c, front.c) */
bool sgt_figure_chiefs(asked *a);
bool sgt_figure_efl(asked *a);
bool sgt_figure_distortion(asked *a);
bool sgt_figure_spots(asked *a);
bool sgt_figure_fronts(asked *a);

#endif
