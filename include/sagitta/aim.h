/* aim.h - how the end of a traced ray changes with the ray and with the lens, and the ray
 * that goes through a wanted point.
 *
 * Lengths are in the unit of the lens, angles in radians.  Every function may run in any
 * number of threads on the same elements.  Nothing is allocated; the stack needed is
 * below 80 KiB.  Answers have the same bits on every processor. */
#ifndef SAGITTA_AIM_H
#define SAGITTA_AIM_H
#include <sagitta/sensitivity.h>
#include <sagitta/system.h>
#ifdef __cplusplus
extern "C" {
#endif

/* --------------------------------------------------- derivatives of a whole trace
 *
 * WHAT IS DIFFERENTIATED.  The end of a ray that sgt_trace took through e[0] ... e[n-1]:
 *     p     passages[n-1].hit.p, IN THE FRAME OF THE LAST ELEMENT
 *     d     passages[n-1].direction, in that frame, of unit length
 *     opl   passages[n-1].opl
 * In that frame an image plane sees the spot where it sees it, however the lens moves.
 * With n = 0 it is the launch ray itself, with its direction made of unit length.
 *
 * METHOD.  The chain rule over the elements, with no ray traced again and no difference
 * taken.  At a surface it is the implicit function theorem (sensitivity.h).  Bending is
 * d' = r d + f n, with the gradient n as it comes (r = n1 / n2; -2 f = d . n / n . n at a
 * mirror).  With S = d' . n its derivative is
 *     df  = -(f / S) (d' . dn + r n . dd) - dr (d . d') / S,
 *     dd' = r dd + f dn + n df + dr d.
 * Source for the chain of a lens: Feder 1968, J. Opt. Soc. Am. 58, 1494; for the reverse
 * sweep: Griewank and Walther 2008, Evaluating Derivatives, chapter 3.
 *
 * THE ROOT STAYS.  They are derivatives of the root that was met and of the fate that the
 * ray had.  No derivative tells of an edge, of another root, or of a ray that stops.
 *
 * ACCURACY.  A few roundings of the terms of each sum, and the errors of sensitivity.h at
 * each surface.  At grazing incidence, in front of a surface or behind it, all grows
 * without bound, and so does the error.  Where |n|^2 leaves the range of a double, the
 * answers are infinite or NaN.
 *
 * WHAT IS MISSING.  Both functions return the sum of the SGT_LACKS_... of the elements.
 * Without second derivatives of a surface that bends, d behind it is NaN, and so is all
 * that it has a say in.  Where a hit is not positive, all is NaN.  If the ray passed all
 * but the last element, and met that one, p and opl are right and d is NaN. */

/* A change of a ray: of its point, its direction, and its path. */
typedef struct sgt_ray_change {
    sgt_vec3 p, d;
    double   opl;
} sgt_ray_change;

/* Forward: the changes of the end by changes of the launch ray.
 *
 *     launch    as it was given to sgt_trace; its direction may have any length
 *     passages  as sgt_trace left them, of all n elements
 *     columns   how many changes
 *     change    by how much the launch ray changes: p is that of launch->o, d that of
 *               launch->d, opl is added to the path.  Global frame
 *     out       by how much the end changes.  It may be the same array as change
 *
 * The change of launch->d along launch->d changes nothing but the length of it.  Two
 * columns aim in a pupil; six are the whole Jacobian by the ray.  The second derivatives
 * of a surface are worked out once for all columns. */
SGT_API int sgt_trace_sensitivity(size_t n, const sgt_element e[], double index_before,
                                  const sgt_ray *launch, const sgt_passage passages[],
                                  size_t columns, const sgt_ray_change change[],
                                  sgt_ray_change out[]);

/* The numbers that a trace depends on, in this order.
 *
 *     0 ... 2   launch->o: x, y, z              length
 *     3 ... 5   launch->d: x, y, z              of launch->d
 *     6         index_before
 *     then for each element, from sgt_trace_parameters(i, e) on:
 *     m         the parameters of its surface, in the order of surfaces.h;
 *               m = sgt_parameters(e[i].surface)
 *     3         pose.origin: x, y, z            length, global frame
 *     3         a turn of the element about its own x, y and z axis through its origin,
 *               right-handed                    radians
 *     1         index, behind it.  0 where it is SGT_MIRROR or 0 (as in front)
 *
 * Returns how many they are up to element n: 7 and m + 7 of each.  A thickness is no
 * number of its own: it moves all elements behind it, so its derivative is the sum of
 * theirs by origin. */
SGT_API size_t sgt_trace_parameters(size_t n, const sgt_element e[]);

/* Reverse: the gradients of `rows` numbers by all parameters of the trace at once.
 *
 *     weight    number r is weight[r].p . p + weight[r].d . d + weight[r].opl * opl.
 *               With a weight of 1 for one of the seven components it is that one, and
 *               seven rows are the whole Jacobian
 *     gradient  rows * sgt_trace_parameters(n, e) numbers, row by row
 *
 * All else is as for sgt_trace_sensitivity.  A sweep backward costs a small multiple of
 * the trace, however many parameters there are, and no work space: what it needs of each
 * element is in the passages.  Eight rows share a sweep. */
SGT_API int sgt_trace_gradient(size_t n, const sgt_element e[], double index_before,
                               const sgt_ray *launch, const sgt_passage passages[],
                               size_t rows, const sgt_ray_change weight[],
                               double gradient[]);

#ifdef __cplusplus
}
#endif
#endif
