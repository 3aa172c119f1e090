// SPDX-License-Identifier: MIT
/* shape.h - the shape of an element, for those who draw it: the sag of a surface, its
 * section by a plane, and the part of it that is in use.  Part of sagitta_lens.
 *
 * Lengths have the unit of the surface.  Points are in the element's own frame; pose is
 * not read.  Nothing is allocated or kept.  The surface must be valid: sgt_intersect of
 * it must not be SGT_INVALID.
 *
 * Every function may run in any number of threads. */
#ifndef SAGITTA_SHAPE_H
#define SAGITTA_SHAPE_H
#include <sagitta/lens.h>
#ifdef __cplusplus
extern "C" {
#endif

/* The sag: z of the surface at x, y, on the sheet of its vertex.  It is where a line
 * parallel to z is met, by a search with SGT_NEAR_SEED; so z is as exact as the answer
 * of that is, on most types a few roundings.  NaN: there is no surface at x, y (its rim
 * is nearer, or it does not reach so far), the search was undecided, x or y is not
 * finite, or the surface is not a sag (sgt_is_sag). */
SGT_API double sgt_sag_at(sgt_surface s, double x, double y);

/* The largest radius up to `wanted` (finite, above 0) at which the surface exists at the
 * four points on the axes x and y, to 2^-39 of `wanted`; 0: there is none.  It is also
 * taken to exist nearer to the vertex.  Of a sag. */
SGT_API double sgt_whole_radius(sgt_surface s, double wanted);

/* The most strokes that a section has. */
enum { SGT_SECTION_MOST = 32768 };

/* The section of an element's surface by a plane, as short strokes in no order.  Of any
 * surface with a `value`; meant for those that are not sags: ellipsoids, tori, formulas.
 *
 *     reach          how far from the axis `along` the section is looked for; length
 *     across, along  the axes of the plane through the element's origin; of length 1, at
 *                    right angles
 *     room           how many strokes `stroke` has room for
 *     stroke         written: from stroke[k][0] to stroke[k][1], in the element's frame;
 *                    length
 *
 * The section is looked for within `reach` (finite, above 0) of the axis `along`.  If
 * semi_diameter is 0, and the surface meets the axis `across` no farther out than 4
 * reach, it is looked for on the whole surface.
 *
 * The plane is covered by a net of 128 by 128 cells.  In each cell in which F changes its
 * sign, a stroke is a straight line between the points of the cell's sides where F, taken
 * as linear between the corners, is 0.  So if F is smooth, strokes are off the surface by
 * an amount proportional to the square of a cell's size.  Parts smaller than a cell may
 * be missing.  A level set has details finer than any net.
 *
 * Writes as many strokes as there are, but no more than room, and returns how many there
 * are; stroke may be NULL if room is 0.  0: the plane does not meet the surface, or
 * reach is not above 0. */
SGT_API size_t sgt_section(const sgt_element *e, double reach, sgt_vec3 across,
                           sgt_vec3 along, size_t room, sgt_vec3 stroke[][2]);

/* ------------------------------------------------------------------ the part in use */

enum { SGT_RIM_POINTS = 128 /* of the line about a part */ };

/* A part of a sag: a closed line about a middle in x, y of the element. */
typedef struct sgt_part {
    sgt_vec2 middle;
    sgt_vec2 rim[SGT_RIM_POINTS];  /* from x toward y; the last joins the first */
    const sgt_aperture_item *item; /* whose edge it is; NULL: none */
    unsigned long long reserved_[2];
} sgt_part;

/* Where rays met an element: how far from its axis, and the box about the points in its
 * x, y.  radius 0: no ray met it. */
typedef struct sgt_footprint {
    double   radius;
    sgt_vec2 low, high;
} sgt_footprint;

/* Half the height of the rim of an element.  It is the first of these that there is:
 *   - its semi_diameter;
 *   - how far from the axis its first aperture item that is an opening (not obscuring,
 *     not a spider) reaches;
 *   - given->size;
 *   - 1.1 met->radius;
 *   - `otherwise`.
 * given: as in sgt_lens; NULL: nothing more is known of the element.  met: where rays met
 * it; NULL: no ray did. */
SGT_API double sgt_half_height(const sgt_element *e, const sgt_lens_surface *given,
                               const sgt_footprint *met, double otherwise);

/* The part of a sag that light uses, as a drawing shows it.  It is
 *   - the first item of its aperture that is an opening, if that is beside the axis,
 *     given->mirror is set, or there is no semi_diameter; no side of it is farther out
 *     than sgt_half_height without met;
 *   - else, if it is a mirror whose height is known from the rays alone, and they met it
 *     clear of its axis: an ellipse about them, 1.1 times as wide as they are;
 *   - else the circle of sgt_half_height about the axis; it ends where the surface does:
 *     see sgt_whole_radius.
 * given, met and otherwise: as above. */
SGT_API sgt_part sgt_part_in_use(const sgt_element *e, const sgt_lens_surface *given,
                                 const sgt_footprint *met, double otherwise);

/* The edge of an aperture item other than a spider; sides without end are as far out as
 * `most`.  inner: the inner circle of an annulus. */
SGT_API sgt_part sgt_part_of_item(const sgt_aperture_item *item, double most,
                                  bool inner);

/* The largest stretch of the line middle + t u inside the rim, from t = *low to *high;
 * false: the rim does not cross the line.  u has length 1. */
SGT_API bool sgt_part_along(const sgt_part *p, sgt_vec2 u, double *low, double *high);

#ifdef __cplusplus
}
#endif
#endif
