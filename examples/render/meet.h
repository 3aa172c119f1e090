// SPDX-License-Identifier: MIT
/* meet.h - rays of the world meet the objects of a scene, many at a time. */
#ifndef RENDER_MEET_H
#define RENDER_MEET_H
#include "scene.h"

#include <stdint.h>

/* A point of an object, in the object's own frame, as the library gave it. */
typedef struct spot {
    vec3 p, n;             /* n: F's gradient */
    double p_err;
} spot;

/* Light, followed against its way.  It may start on a surface: then `from` is the object, `at` where, and
 * `side` says where the ray goes: +1 to where F > 0. */
typedef struct beam {
    vec3 o, d;             /* d is of unit length */
    double far;            /* nothing beyond is looked for */
    const object *from;    /* NULL: starts in the open */
    spot at;
    double side;
    const object *medium;  /* what it is inside of; NULL: air */
} beam;

typedef struct meeting {
    const object *object;  /* the first that is met; NULL: none, and only status and evals are told */
    /* of the hit; or negative: what an object answered that could not tell of the way there */
    sgt_status status;
    int evals;             /* spent on all objects */
    double t, t_err;       /* t_err: as the library gives it, of a body of several its error in t */
    /* in the world; n of unit length, as the object's `normal` says, toward where the ray came from */
    vec3 p, n;
    spot at;               /* the same place in the object's own frame */
    double side;           /* where it came from: +1 where F > 0 */
} meeting;

/* What rays came to; added up over all of them. */
enum { UNDECIDED_KINDS = 5 };
typedef struct tally { uint64_t rays, evals, undecided[UNDECIDED_KINDS]; } tally; /* [-1 - status] */
void tally_add(tally *to, const tally *of);

/* One meeting for each of n beams. */
void meet(const scene *s, size_t n, const beam b[], meeting m[], tally *sum);

/* A beam that leaves the point of a meeting. */
beam leaving(const meeting *m, vec3 direction, double far, double side, const object *medium);

#endif
