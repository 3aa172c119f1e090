// SPDX-License-Identifier: MIT
/* measure.h - how far off the settings of a call are, and how long they take (measure.c).
 *
 *     c.setting[i].truth = measure_truth(&c, &c.setting[i]);     every setting needs one
 *     measure_all(&trade, seconds);
 *
 * A case is a surface or a lens, the rays for it, and the settings to try.  All room that this needs comes
 * from the case's `take`. */
#ifndef TRUTH_MEASURE_H
#define TRUTH_MEASURE_H
#include "quad.h"

#include <sagitta/system.h>

/* The option that a setting changes. */
typedef enum knob {
    KNOB_NONE, KNOB_CALL, KNOB_OUTPUTS, KNOB_T_TOL, KNOB_MAX_EVALS, KNOB_PICK, KNOB_PROOF, KNOB_DT_MIN,
    KNOB_ITERATIONS, KNOB_FLOATS, KNOBS
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
    bool floats;               /* by sgt_intersect_batch_f, of the rays rounded to floats; of a surface */
    const truth *truth;        /* [rays] */
    bool other_model;          /* truth is that of another surface: t_err does not bound the error */

    double ns, ns_low, ns_high; /* median time per ray, and its range (measure.c), in nanoseconds */
    double evals, error_median, error_99, error_worst;
    double path_worst, waves_worst;         /* of a lens */
    size_t undecided, wrong;
    bool best;
    char effect[160];          /* room for whoever says in words what it changes */
} setting;

/* A lens, and of its units and wavelength what makes a path a number of waves. */
typedef struct measured_lens {
    size_t count;
    const sgt_element *element; /* [count] */
    double index_before;
    double length, wavelength; /* in one unit: the length that 1 is in the lens; NaN: not known */
    const char *units;         /* for people; "" where not known */
} measured_lens;

/* Zeroed room for `count` things of `size` bytes, never NULL, which the asker frees when all is done. */
typedef void *measure_room(size_t count, size_t size);

typedef struct trade_case {
    measure_room *take;
    const char *name;
    char about[400];           /* a line for people */
    const measured_lens *lens; /* NULL: a surface */
    size_t rays;
    sgt_ray *ray;              /* [rays] */
    sgt_rays columns;          /* the same rays as arrays */
    sgt_rays_f columns_f;      /* and rounded to floats; o[0] NULL: no setting asks for floats */
    setting *setting;
    size_t settings, capacity;
} trade_case;

typedef struct trade { trade_case *list; size_t count, capacity; } trade;

/* The base, with which the other settings are compared: the default, or the largest N; NULL if none. */
const setting *measure_base(const trade_case *c);

/* Are time and results the same, as far as repeated runs can tell? */
bool measure_same(const setting *a, const setting *b);

/* Ratios up to which two times, or two errors, are the same: a smaller gain of time is not worth a knob, and
 * rounding errors scatter so much. */
#define MEASURE_SAME_TIME 1.1
#define MEASURE_SAME_ERROR 2

/* Is a slower than b by more than its range and by more than MEASURE_SAME_TIME? */
bool measure_slower(const setting *a, const setting *b);

/* Does a give all that b gives: outputs and proof? */
bool measure_gives(const setting *a, const setting *b);

/* Rounds to `digits` significant digits. */
double measure_rounded(double x, int digits);

/* Measures every setting, for about so many seconds, and finds which are best. */
void measure_all(trade *t, double seconds);

/* The true answers, [rays], for the surface or lens of a setting and the root that it picks. */
const truth *measure_truth(const trade_case *c, const setting *s);

/* The most evaluations that a ray takes (of a lens: at one element). */
int measure_most_evals(const trade_case *c, const setting *s);

#endif
