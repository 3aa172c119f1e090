/* trade.h - what sagitta trade tries, what it finds, and who does what.
 *
 *     command/trade.c  the arguments, and the table
 *     cases.c          surfaces, rays and the settings to try on them
 *     measure.c        times and errors
 *     plot.c           the picture */
#ifndef TOOL_TRADE_H
#define TOOL_TRADE_H
#include "../job/job.h"
#include "../../truth/quad.h"

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

/* The option that a setting changes. */
typedef enum knob {
    KNOB_NONE, KNOB_CALL, KNOB_OUTPUTS, KNOB_T_TOL, KNOB_MAX_EVALS, KNOB_PICK, KNOB_PROOF, KNOB_DT_MIN,
    KNOB_ITERATIONS, KNOBS
} knob;

/* The outputs asked for.
 * LEAST: t; of a lens the last point.
 * USUAL: status, t, t_err, p, n; of a lens the last point, direction, fate and path.
 * ALL: every output; of a lens the record of each element as well. */
typedef enum outputs { OUTPUTS_LEAST, OUTPUTS_USUAL, OUTPUTS_ALL } outputs;

/* The true answer of a ray.  path, kind, passed, point: of a lens. */
typedef struct truth {
    bool known;                /* false: undecided at full accuracy, or Newton in 113 bits did not settle */
    bool met;                  /* hit; of a lens: passed every element */
    signed char kind;          /* of a lens: the fate */
    int passed;
    quad t, path;
    quad3 point;
} truth;

typedef struct setting {
    char name[40];
    knob turned;
    sgt_surface surface;       /* unused for a lens */
    sgt_options options;
    outputs outputs;
    bool single;               /* one call for each ray, and no batch */
    const truth *truth;        /* [rays] */
    bool other_model;          /* truth is that of another surface: t_err does not bound the error */

    double ns, ns_low, ns_high; /* median time per ray, and its range (measure.c), in nanoseconds */
    double evals, error_median, error_99, error_worst;
    double path_worst, waves_worst;         /* of a lens */
    size_t undecided, wrong;
    bool best;
    char effect[160];          /* what it changes against the base, in words; "" for the base */
} setting;

typedef struct trade_case {
    const char *name;
    char about[400];           /* a line for people */
    const job *lens;           /* NULL: a surface */
    size_t rays;
    sgt_ray *ray;              /* [rays] */
    sgt_rays columns;          /* the same rays as arrays */
    setting *setting;
    size_t settings, capacity;
} trade_case;

typedef struct trade { trade_case *list; size_t count, capacity; } trade;

/* "t_tol": what stands before the = in the names of a knob's settings. */
extern const char *const trade_knob_name[KNOBS];

/* The base, with which the other settings are compared: the default, or the largest N; NULL if none. */
const setting *trade_base(const trade_case *c);

/* Are time and results the same, as far as repeated runs can tell? */
bool trade_same(const setting *a, const setting *b);

/* Makes all cases and their settings. */
trade trade_cases(const trade_options *o);

/* Measures every setting, for about so many seconds. */
void trade_measure(trade *t, double seconds);

/* The true answers, [rays], for the surface or lens of a setting and the root that it picks. */
const truth *trade_truth(const trade_case *c, const setting *s);

/* The most evaluations that a ray takes (of a lens: at one element). */
int trade_most_evals(const trade_case *c, const setting *s);

/* file: as chart_check takes it. */
void trade_picture(const char *file, const trade *t);

#endif
