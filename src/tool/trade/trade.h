/* trade.h - what sagitta trade tries, what it finds, and who does what.
 *
 *     trade.c          the arguments, and the table
 *     cases.c    surfaces, rays and the settings to try on them
 *     measure.c  times and errors
 *     plot.c     the picture */
#ifndef TOOL_TRADE_H
#define TOOL_TRADE_H
#include "../job/job.h"
#include "quad.h"

/* Values of a knob, from the command line or by default. */
typedef struct knob_list { size_t count; double value[16]; } knob_list;

typedef struct trade_options {
    job_options job;
    const char *surface;       /* --surface; NULL: job.lens, or else the default set */
    ray_list rays;             /* --ray */
    knob_list t_tol, dt_min, max_evals, iterations;
    sgt_pick pick;             /* SGT_PICK_DEFAULT: each */
    size_t proofs;             /* 0: each */
    sgt_proof proof[3];
    double seconds;
} trade_options;

/* What a user turns. */
typedef enum knob {
    KNOB_NONE,
    KNOB_CALL,
    KNOB_OUTPUTS,
    KNOB_T_TOL,
    KNOB_MAX_EVALS,
    KNOB_PICK,
    KNOB_PROOF,
    KNOB_DT_MIN,
    KNOB_ITERATIONS,
    KNOBS
} knob;

/* Outputs asked for.  Of a surface: t; status, t, t_err, p, n; all there are.  Of a lens: where
 * the ray ends; that, its direction, fate and path; each element's record as well. */
typedef enum outputs { OUTPUTS_LEAST, OUTPUTS_USUAL, OUTPUTS_ALL } outputs;

/* Per ray what is so.  path: of a lens. */
typedef struct truth {
    bool known;                /* false: undecided even at full care, or no rest in 113 bits */
    bool met;                  /* a lens: passed all */
    signed char kind;          /* a lens: the fate; a surface: unused */
    int passed;
    quad t, path;
    quad3 point;
} truth;

typedef struct setting {
    char name[40];
    knob turned;
    sgt_surface surface;       /* of a lens: unused */
    sgt_options options;
    outputs outputs;
    bool single;               /* one ray a call, and not the batch */
    const truth *truth;        /* [rays] */
    bool other_model;          /* truth is another surface's: t_err does not speak of it */

    double ns, ns_low, ns_high; /* the median of the rounds, and their spread: see measure.c */
    double evals, error_median, error_99, error_worst;
    double path_worst, waves_worst;         /* of a lens */
    size_t undecided, wrong;
    bool best;
    char effect[160];          /* in words, against the case's base; of the base: empty */
} setting;

typedef struct trade_case {
    const char *name;
    char about[400];           /* a line for people */
    const job *lens;           /* NULL: a surface */
    size_t rays;
    sgt_ray *ray;              /* [rays], and the same as arrays */
    sgt_rays columns;
    setting *setting;
    size_t settings, capacity;
} trade_case;

typedef struct trade {
    trade_case *list;
    size_t count, capacity;
} trade;

/* "t_tol": what stands before = in the names of the knob's settings. */
extern const char *const trade_knob_name[KNOBS];

/* What the others of a case are compared with: the default, or the deepest N; NULL: there is none. */
const setting *trade_base(const trade_case *c);

/* Is what it costs and gives the same, as far as repeated runs can tell? */
bool trade_same(const setting *a, const setting *b);

/* All that is to be tried. */
trade trade_cases(const trade_options *o);

/* Fills in what is found. */
void trade_measure(trade *t, double seconds);

/* What is so, for each ray, of the surface or lens of this setting and the root it picks. */
const truth *trade_truth(const trade_case *c, const setting *s);

/* The most evaluations that a ray takes (of a lens, at one element). */
int trade_most_evals(const trade_case *c, const setting *s);

void trade_picture_check(void);
void trade_picture(const char *file, const trade *t);

#endif
