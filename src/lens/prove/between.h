// SPDX-License-Identifier: MIT
/* between.h - the rays of all fields and wavelengths between those of a lens, by boxes of up to five sides.
 */
#ifndef SGT_PROVE_BETWEEN_H
#define SGT_PROVE_BETWEEN_H
#include "carry.h"

#include <sagitta/prove.h>

/* The sides of a box: two of the field, the wavelength, radius and angle (in turns) in the pupil. */
enum { SIDE_U, SIDE_V, SIDE_WAVE, SIDE_RADIUS, SIDE_TURN, SIDES };

/* Fields are slopes of the chief ray from afar, else points of the object: a u, v goes to
 * a + u (b - a) + u v (c - b), u and v from 0 to 1.  So 0, 1 or 2 of them count. */
typedef struct between_patch { sgt_vec2 a, b, c; } between_patch;

/* Rays that are asked for together. */
typedef struct between_cell {
    const sgt_launcher *from;
    sgt_field_beam beam;         /* of any of the fields; its point or direction is not read */
    int field_sides;             /* 0, 1 or 2 */
    size_t patches;
    const between_patch *patch;
    double um[2], primary;       /* wavelengths from um[0] to um[1]; NaN: none is known */
    double unit;                 /* the unit of length in micrometres; NaN: not known */
    const sgt_element *e;        /* as rays end, at um[0] */
    const sgt_element *e_primary; /* at the primary wavelength */
    double before, before_primary;
    const sgt_first_order *data; /* at the primary wavelength */
    bool (*reference)(const sgt_lens *lens, const sgt_first_order *data, const sgt_element e[], double before,
                      const sgt_ray_end *chief, bool afocal, sgt_reference *out, sgt_error *error);
    double (*opd)(const sgt_reference *of, const sgt_ray_end *end,
                  double *error); /* sgt_reference_of, sgt_opd */
} between_cell;

/* Why there is no enclosure of the lens over the wavelengths of a cell; NULL: there is.  element: which,
 * from 0. */
const char *sgt_between_lacks(const between_cell *of, size_t *element);

/* The largest value of a ray that was traced, and which it is.  NaN: of none. */
typedef struct between_seen { double value, at[SIDES]; size_t patch; } between_seen;

/* Its field (degrees from afar, else a point of the object), its wavelength and point of the pupil. */
typedef struct between_ray { double fx, fy, um, px, py; } between_ray;
between_ray sgt_between_ray(const between_cell *of, const between_seen *seen);

/* What is bounded: as of carry.h, but Q_HIGH is largest less smallest path difference of one field and
 * wavelength, and Q_LOW is not used. */
typedef struct between_asked {
    const between_cell *cell;
    size_t boxes;                /* the budget of a part */
    size_t limits;               /* 0: all bounds are wanted */
    const sgt_prove_limit *limit;
} between_asked;

/* The largest values of rays at a net of points, improved by steps to neighbours. */
typedef struct between_net {
    between_seen *seen;          /* [quantities]; of Q_HIGH the ray with the largest difference, */
    between_seen low;            /* and the one with the smallest, of the same field and wavelength */
    size_t passed, lost_chiefs;  /* how many rays passed; of how many fields the chief ray does not */
} between_net;
bool sgt_between_look(const between_asked *asked,
                      between_net *out); /* false: no memory.  _forget in either case */
void sgt_between_forget(const between_asked *asked, between_net *net);

/* Which quantities a limit is about: how many, from *first on in steps. */
size_t sgt_between_quantities(const between_cell *of, const sgt_prove_limit *limit, size_t *first,
                              size_t *step);

/* Fields and wavelengths are divided into so many parts. */
size_t sgt_between_parts(const between_cell *of);

/* What is known of a part.  It is followed by `most` and `seen`, [quantities] each. */
typedef struct between_part {
    size_t boxes, spent, passed; /* how many were carried; is the budget spent; does any ray pass */
    double undecided;            /* the share of its boxes, by their sides, that may break a limit */
    size_t hopeless, element;    /* 1: no box can be decided there, */
    int    why;                  /* as this says (sgt_box_why) */
} between_part;
size_t sgt_between_part_size(const between_cell *of);
double *sgt_between_most(const between_cell *of, between_part *part);
between_seen *sgt_between_part_seen(const between_cell *of, between_part *part);

/* Proves part i; net: what was seen before.  false: no memory. */
bool sgt_between_prove(const between_asked *asked, const between_net *net, size_t i, between_part *out);

#endif
