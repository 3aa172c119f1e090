// SPDX-License-Identifier: MIT
/* lot.h - rays of the world meet one object, many at a time. */
#ifndef RENDER_LOT_H
#define RENDER_LOT_H
#include "meet.h"

/* A stretch of a ray; lo > hi: nothing of it. */
typedef struct stretch { double lo, hi; } stretch;

/* What an object answers along a ray: a hit at t, or, with a negative status, that it cannot tell of the
 * stretch from lo to hi. */
typedef struct event {
    sgt_status status;
    int evals;
    double t, lo, hi; /* a hit: lo and hi are t, less and more by its error */
    vec3 p, n;        /* in the object's frame; n is F's gradient */
    double p_err;
} event;

/* Some rays, a row for each number: in the world, in the frame of an object, and their hits with it.
 * Looked for is from lo to far; lo 0: from where the ray starts. */
enum { LOT = 256 };
typedef double row[LOT];
typedef struct lot {
    size_t n;
    const beam *beam[LOT];
    row world_o[3], world_d[3], lo, far, o[3], d[3], t, t_err, p[3], n_at[3], p_err;
    sgt_status status[LOT];
    int evals[LOT];
} lot;

static inline vec3 vector_of(row a[3], size_t i) { return (vec3){a[0][i], a[1][i], a[2][i]}; }

void lot_add(lot *l, const beam *b, double lo, double far);

/* Every ray's hit with one object. */
void lot_meet(lot *l, const object *o);

/* The i-th ray's answer, after lot_meet. */
event lot_event(lot *l, size_t i, const object *o);

/* A ray by itself, from tmin to far.  tmin is 0, or where the object was met last; `side` is where the ray
 * went from there, as in a beam, or 0: not known. */
event event_alone(const object *o, const beam *b, double tmin, double far, double side);

/* The ray in the object's frame.  It begins where the library put it, if it starts on the object. */
sgt_ray ray_in(const object *o, const beam *b);

#endif
