// SPDX-License-Identifier: MIT
/* formula.h (of the room) - what is worked out from a tape.
 *
 *     values.c    F and its derivatives at many points, in doubles
 *     enclose.c   F and its derivatives over intervals, one cell at a time, as tight as interval.h
 *     enclose_lanes.c   F and its slope along a ray, many cells at a time, not as tight, and quick
 *     implicit.c  the surface F(x, y, z) = 0
 *     sag.c       the sag z = s(x, y)
 *
 * The tape is as tape.h says. */
#ifndef SGT_SURFACE_FORMULA_FORMULA_H
#define SGT_SURFACE_FORMULA_FORMULA_H

#include "tape.h"

#include <sagitta/interval.h>

/* F at n points, and its gradient where grad[0] is not NULL.  A lane's bits do not depend on n.  z and
 * grad[2] are not read of a tape of SGT_FORMULA_XY, and may be NULL. */
void sgt_formula_values(const sgt_tape *tape, size_t n, sgt_points p, sgt_values out);

/* The same of a radial tape (tape.h). */
void sgt_formula_radial(const sgt_tape *tape, size_t n, sgt_points p, sgt_values out);

/* The mixed second derivative of F by u and v at n points, and F, F_u, F_v.  0, 1, 2 are x, y, z; u may be a
 * parameter besides, 3 + j.  Outputs that are NULL are not written. */
typedef struct formula_mixed { double *f, *u, *v, *uv; } formula_mixed;
void sgt_formula_mixed(const sgt_tape *tape, size_t u, size_t v, size_t n, sgt_points p, formula_mixed out);

/* The same over intervals: x, y, z in `at`, r = sqrt(x^2 + y^2) in `r`, in which it is enclosed besides.
 * du[k], dv[k]: the derivatives of x, y, z by u and v.  Derivatives in directions are made so.
 *
 * - f is empty if F is undefined all over.
 * - A derivative with two finite ends also says that F is defined and continuous all over, and if its kinks
 *   are in there, that the derivatives nearby lie in it (the mean value theorem holds).
 * - uv with two finite ends says that of F_u and F_v.
 * - second false: uv is not worked out. */
typedef struct formula_jet {
    sgt_interval f, u, v, uv;
    bool whole;
} formula_jet; /* whole: defined all over */
formula_jet sgt_formula_jet(const sgt_tape *tape, const sgt_interval at[3], sgt_interval r,
                            const sgt_interval du[3], const sgt_interval dv[3], bool second);

/* F and its slope over n cells, as `enclose` of sagitta.h promises: cell i is t_lo[i] <= t <= t_hi[i] on ray
 * i of `rays`, of which o and d are read.  The value is empty (lo > hi) where F is undefined all over the
 * cell. out.slope_lo NULL: slopes are not wanted.  A lane's bits do not depend on n, nor on its neighbours.
 */
void sgt_formula_encloses(const sgt_tape *tape, size_t n, sgt_rays rays, const double *t_lo,
                          const double *t_hi, sgt_enclosures out);

/* The same of a radial tape (tape.h), by s: F, F_s, F_s again, and F_ss. */
formula_jet sgt_formula_radial_jet(const sgt_tape *tape, sgt_interval s, bool second);

/* May F jump in the region where it is defined?  Only the cut of an atan2 is such a place. */
bool sgt_formula_jumps(const sgt_tape *tape, const sgt_interval at[3], sgt_interval r);

/* How far F as computed by sgt_formula_values can be from F, at any point of the region.  HUGE_VAL: not
 * known. */
double sgt_formula_noise(const sgt_tape *tape, const sgt_interval at[3], sgt_interval r);

#endif
