// SPDX-License-Identifier: MIT
/* aim.h - what the searches for aimed rays share (aim.c, aim_map.c, aim_field.c). */
#ifndef SGT_OPTICS_AIM_H
#define SGT_OPTICS_AIM_H
#include "launch.h"

enum { AIM_PART = 128 }; /* rays that are aimed side by side, at most */

/* A question to sgt_aim, and what is known of the rays that are not there. */
typedef struct aim_search {
    size_t element;
    const sgt_element *e;
    double before;
    sgt_passage *passages;
    size_t starts;
    sgt_vec2 start[2];
    bool chief;            /* it is wanted whatever clips it */
    const sgt_element *open; /* of a fitted map: the elements without apertures, */
    sgt_element *own;      /* and room for them */
    int home;              /* of REACH: the box where the chief ray was found */
    double within;         /* radii of the pupil: it is proven that no ray there meets the point */
    sgt_attempt nearest;
} aim_search;

/* Some rays side by side, and how they met the elements up to the stop. */
typedef struct aim_many {
    sgt_passages *at;           /* [stop + 1] */
    sgt_passages *guide;        /* [stop + 1]: of which the last one alone is told, by p, */
    double *guide_err;          /* and p_err, if that is asked */
    sgt_vec2 wanted[AIM_PART], start[2 * AIM_PART];
    sgt_aiming found[AIM_PART];
    double o[3][AIM_PART], d[3][AIM_PART], change[12][AIM_PART];
    /* of the fitted map: its rays, and those that it leaves (here, and not on the stack, of which threads of
     * some systems have little) */
    double x[AIM_PART], y[AIM_PART], u[AIM_PART], v[AIM_PART];
    sgt_fate fate[AIM_PART];
    int passed[AIM_PART];
    size_t left[AIM_PART];
    sgt_pupil_point other[AIM_PART];
    sgt_launched own[AIM_PART];
} aim_many;

struct sgt_aim_room {
    sgt_colour_beam of;         /* the beam; e is `bare` */
    sgt_beam f;                 /* its rays, as a family */
    aim_search search;
    sgt_passage *passages;
    sgt_element *bare, *open, *clear; /* without a phase of the stop; without apertures; room for others */
    aim_many *many;
    sgt_aim_map own;            /* if it comes without a map */
    size_t part;
};

/* The rays of a beam by their coordinates in the pupil, or the slopes of the cone.  (aim.c, as all but the
 * last) */
sgt_beam sgt_aim_family(const sgt_field_beam *b);

/* The ray in the box of f.  max_traces and max_boxes: of sgt_aim. */
sgt_aiming sgt_aim_in_box(aim_search *s, const sgt_beam *f, sgt_vec2 wanted, int max_traces, int max_boxes);

/* The ray of the whole family f.  *where: of REACH, the box where it was looked for last. */
sgt_aiming sgt_aim_in_family(aim_search *s, const sgt_beam *f, sgt_vec2 wanted, int *where);

/* Sets the beam and the elements up to the stop. */
void sgt_aim_begin(sgt_aim_room *r, const sgt_colour_beam *of);

/* The chief ray of the room's beam, and the linear map about it. */
sgt_aim_map sgt_aim_chief(const sgt_aim_room *r);

/* Rays by search; m->at and r->passages: room.  r->of.map: set. */
void sgt_aim_search_for(sgt_aim_room *r, size_t count, const sgt_pupil_point at[], sgt_launched out[]);

#endif
