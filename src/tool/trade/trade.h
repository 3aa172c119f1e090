// SPDX-License-Identifier: MIT
/* trade.h - what sagitta trade tries, and who does what.
 *
 *     command/trade.c  the arguments, and the table
 *     cases.c          surfaces, rays and the settings to try on them
 *     effects.c        what a setting changes, in words
 *     plot.c           the picture
 *
 * Times and errors: ../../truth/measure.h. */
#ifndef TOOL_TRADE_H
#define TOOL_TRADE_H
#include "../job/job.h"
#include "../../truth/measure.h"

/* The values of a knob, given or by default. */
typedef struct knob_list { size_t count; double value[16]; } knob_list;

typedef struct trade_options {
    job_options job;
    const char *surface;       /* --surface; NULL: job.lens, or if that is NULL the default set */
    ray_list rays;             /* --ray */
    knob_list t_tol, dt_min, max_evals, iterations;
    sgt_pick pick;             /* SGT_PICK_DEFAULT: try both */
    size_t proofs;             /* 0: try root and first */
    sgt_proof proof[3];
    double seconds;
} trade_options;

/* "t_tol": what stands before the = in the names of a knob's settings. */
extern const char *const trade_knob_name[KNOBS];

/* Makes all cases and their settings. */
trade trade_cases(const trade_options *o);

/* Says of every setting, once measured, in its `effect` what it changes against the base; "" for the base. */
void trade_say_effects(trade *t);

/* file: as chart_check takes it. */
void trade_picture(const char *file, const trade *t);

#endif
