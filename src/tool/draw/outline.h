// SPDX-License-Identifier: MIT
/* outline.h - the shape of an element as a picture shows it: sections, rim, holes; in the global frame. */
#ifndef TOOL_OUTLINE_H
#define TOOL_OUTLINE_H
#include "view.h"

#include "../job/job.h"

#include <sagitta/shape.h>

enum { OUTLINE_POINTS = 65, RIM_POINTS = SGT_RIM_POINTS };

typedef enum piece_kind {
    PIECE_SURFACE, /* light meets the element there */
    PIECE_BLOCKED, /* an aperture clips it, and there is something that does */
    PIECE_FINE     /* helps the eye: a section in the view in space, a rim in a section */
} piece_kind;

typedef struct outline_piece {
    piece_kind kind;
    bool solid; /* the whole inside of the line blocks light */
    size_t count;
    sgt_vec3 *at; /* [count], joined by a line */
} outline_piece;

typedef struct outline {
    double half;                 /* half its height; 0: no section, or the surface is not a sag */
    sgt_vec3 at[OUTLINE_POINTS]; /* its section from the lower end to the upper */
    sgt_vec3 rim[RIM_POINTS];    /* closed; NaN where there is no surface */
    sgt_vec3 up, ahead;          /* the direction of the section, and its own z axis */
    bool mirror, stop, dummy;    /* dummy: the medium does not change, and it is not the last */
    double lens;                 /* the sign of the focal length of an ideal lens in this section; 0: none */
    bool phase;                  /* it has a phase in waves */
    double back;                 /* +1 or -1: the side of its own z that is away from the light */
    outline_piece *piece;        /* [pieces]: what is drawn */
    size_t pieces, piece_room;
    sgt_vec3 (*stroke)[2]; /* [strokes], of a surface that is not a sag: its sections */
    size_t strokes;
} outline;

/* The outline of element i.  met: where rays met it; all: and any of the elements, for one that no ray met.
 * back: as in the outline. */
outline outline_of(const job *j, const view_axes *v, size_t i, const sgt_footprint *met, double all,
                   double back);

/* An end of an outline (side: 0 lower, 1 upper), moved along its section to height `half`. */
sgt_vec3 outline_corner(const outline *o, int side, double half);

/* Half the height of the outline's rim, if an element's file or its apertures give it; else 0. */
double outline_known(const job *j, size_t i);

#endif
