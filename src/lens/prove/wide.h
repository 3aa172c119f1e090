// SPDX-License-Identifier: MIT
/* wide.h - one ray through every lens of a box of many parameters, at first order with a rest.
 *
 * A WIDE number is a set of functions of the parameters s[0] ... s[WIDE - 1], each from -1 to 1:
 *
 *     |x(s) - (c + sum of by[i] s[i])| <= rest   all over the box.
 *
 * It costs as much as it has parameters, where a model of beam.h costs the square, so it can have sixty four.
 * Operations hold what they do to all members, and what they round: each adds GRAIN of the sizes of what went
 * in, far more than the few hundred roundings of 2^-53 that there are. */
#ifndef SGT_PROVE_WIDE_H
#define SGT_PROVE_WIDE_H
#include <sagitta/beam.h>

enum { WIDE = 64 };
typedef struct wide {
    double c, rest, by[WIDE];
} wide;

void sgt_wide_of(double x, wide *out);
/* An interval, whatever the parameters. */
void sgt_wide_between(sgt_interval x, wide *out);
/* How far it goes from c at most; its largest magnitude; its values. */
double sgt_wide_spread(const wide *x);
double sgt_wide_size(const wide *x);
sgt_interval sgt_wide_range(const wide *x);

/* The result may be an argument. */
void sgt_wide_plus(const wide *x, double k, wide *out);
void sgt_wide_scaled(const wide *x, double k, wide *out);
void sgt_wide_added(const wide *x, double k, const wide *y, wide *out); /* x + k y */
void sgt_wide_product(const wide *x, const wide *y, wide *out);
void sgt_wide_inverse(const wide *x, wide *out);                 /* no finite rest if x may be 0 */
void sgt_wide_turn(const wide *angle, wide *cosine, wide *sine); /* radians */
void sgt_wide_rest(wide *x, double more);

/* A line in a frame: where it meets the plane z = 0, and its slopes along z; light runs toward ahead z. */
typedef struct wide_line {
    wide x, y, u, v;
    double ahead;
} wide_line;

/* From a frame to another: p becomes M p + o. */
typedef struct wide_motion {
    wide M[3][3], o[3];
    bool turns;
} wide_motion;
/* false: the line may run along the plane. */
bool sgt_wide_moved(const wide_motion *by, wide_line *line);

/* A sag that is added to that of a conic, and what is true of it within the wider aperture: of its height
 * and of its two slopes, and of the size of its gradient. */
typedef struct wide_shape {
    sgt_surface surface;
    sgt_interval all[3];
    double steep;
} wide_shape;
/* semi_diameter: of the conic.  false: it is not known. */
bool sgt_wide_shape(sgt_surface surface, double semi_diameter, wide_shape *out);

/* An element and what of it varies; the line is in its frame, wherever that is. */
typedef struct wide_element {
    const sgt_element *e;        /* its pose is not read */
    const wide *c;               /* what is added to its curvature; NULL: nothing */
    const wide *before, *behind; /* indices, in front and behind */
    size_t shapes;               /* added to its sag: the sum of amount[k] of shape[k] */
    const wide_shape *shape;
    const wide *amount;
} wide_element;

typedef enum wide_fate {
    WIDE_PASSED, /* in every lens */
    WIDE_MAYBE,  /* some lens may clip it; the line is that of those that do not */
    WIDE_ENDED,  /* it gets through in no lens */
    WIDE_UNKNOWN
} wide_fate;

/* Carries the line through the element.  point: x and y where it is met.  why, if it is not known. */
wide_fate sgt_wide_through(const wide_element *of, wide_line *line, wide point[2], sgt_box_why *why);

#endif
