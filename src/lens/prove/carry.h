// SPDX-License-Identifier: MIT
/* carry.h - a box of the pupil through the lens: what becomes of all its rays, and bounds on where they end.
 * */
#ifndef SGT_PROVE_CARRY_H
#define SGT_PROVE_CARRY_H
#include "disc.h"

#include "../optics/launch.h"

/* What is bounded from above: |x|, |y| and the distance from the reference, in the unit of the image; a path
 * difference and its negative, in waves; and of each element the angle of incidence in degrees, the negative
 * of the distance from the edge of the clear aperture, and the distance from the axis of its frame. */
enum { Q_EX, Q_EY, Q_SPOT, Q_HIGH, Q_LOW, Q_OF_ELEMENTS };
enum { Q_INCIDENCE, Q_INSIDE, Q_HEIGHT, Q_EACH };
static inline size_t prove_quantities(size_t elements) { return Q_OF_ELEMENTS + Q_EACH * elements; }
static inline size_t prove_at_element(size_t element, int of)
{
    return Q_OF_ELEMENTS + Q_EACH * element + (size_t)of;
}

/* A field at a wavelength. */
typedef struct prove_cell {
    const sgt_launcher *from;
    const sgt_field_beam *beam;
    size_t count;
    const sgt_element *e;      /* as rays end at the last of them (sgt_launch_ending) */
    double before;
    bool afocal;
    bool has_reference;        /* else nothing is known of ex, ey, spot */
    sgt_vec3 reference;        /* where the chief ray of the primary wavelength ends; afocal: its direction */
    double reference_err;
    bool has_opd;              /* else nothing is known of path differences */
    sgt_reference about;
    double (*opd)(const sgt_reference *of, const sgt_ray_end *end, double *error); /* sgt_opd */
    double waves;              /* of a length */
    double middle;             /* waves: any number near the mean of the differences */
} prove_cell;

/* What is known of the rays of a box. */
typedef struct prove_box {
    sector of;
    int fate;                  /* of all of them; SGT_LOST: not decided */
    size_t element;            /* where they end, or where it is in doubt, from 0 */
    sgt_box_why why;           /* it is not decided */
    bool hopeless;             /* halving it is of no use */
    bool bounded;              /* not decided, yet its bounds are those of the rays that may pass */
    /* Of a box that is not decided, but cut at edges of clear apertures: these parts of the disc's area
     * certainly pass, certainly end, and of these so much at the element; else 0 */
    double in, out, out_here;
    int divide;                /* not decided: 0 the radius, 1 the angle is best halved; -1: either */
    /* What a mean over the area is made of, f the square of the distance and w the difference less
     * `middle`: integrals over the box, in parts of the area of the disc; and their ranges */
    sgt_interval f_sum, w_sum, ww_sum, f, w, ww;
} prove_box;

typedef struct carry_room carry_room;
carry_room *sgt_carry_room_new(const prove_cell *of); /* NULL: no memory */
void sgt_carry_room_free(const prove_cell *of, carry_room *room);

/* box->of is given, the rest is set; bound[prove_quantities(count)]: upper bounds for all rays that pass. */
void sgt_carry(const prove_cell *of, carry_room *room, prove_box *box, double bound[]);

/* One ray, as traced; value[]: what is bounded, if it passed. */
sgt_fate sgt_carry_ray(const prove_cell *of, carry_room *room, double x, double y, double value[]);

#endif
