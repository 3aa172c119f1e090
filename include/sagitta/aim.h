// SPDX-License-Identifier: MIT
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
 * WHAT IS DIFFERENTIATED.  The end of a ray that sgt_trace took through all elements e:
 *     p     hit.p of the last passage, IN THE FRAME OF THE LAST ELEMENT
 *     d     direction of the last passage, in that frame, of unit length
 *     opl   opl of the last passage
 * So if the last element is an image plane, p is where the spot falls on it, even if the
 * plane moves.  Without elements the end is the launch ray itself, with its direction
 * made of unit length.
 *
 * METHOD.  The chain rule over the elements, with no ray traced again and no difference
 * taken.  At a surface it is the implicit function theorem (sensitivity.h).  Bending is
 * d' = r d + f n, with the gradient n as it comes (r = n1 / n2; -2 f = d . n / n . n at a
 * mirror).  With S = d' . n its derivative is
 *     df  = -(f / S) (d' . dn + r n . dd) - dr (d . d') / S,
 *     dd' = r dd + f dn + n df + dr d.
 * An ideal lens has closed forms of its own, of the direction and of the path.  A phase
 * in waves bends as a surface does, with its gradient and second derivatives besides.
 * Source for the chain of a lens: Feder 1968, J. Opt. Soc. Am. 58, 1494; for the reverse
 * sweep: Griewank and Walther 2008, Evaluating Derivatives, chapter 3.
 *
 * THE ROOT STAYS.  They are the derivatives as long as the ray meets the same roots and
 * has the same fate.  They do not show that it is about to meet an edge or another root,
 * or to be stopped.
 *
 * ACCURACY.  A few roundings of the terms of each sum, and the errors of sensitivity.h at
 * each surface.  At grazing incidence, in front of a surface or behind it, all grows
 * without bound, and so does the error.  Where |n|^2 leaves the range of a double, the
 * answers are infinite or NaN.
 *
 * WHAT IS MISSING.  Both functions return the sum of the SGT_LACKS_... of the elements.
 * Without second derivatives of a surface that bends, or of a phase in waves, d behind it
 * is NaN, and so is all that depends on it.  (An ideal lens does not bend by its normal,
 * and needs none.)  Where a hit is not positive, all is NaN.  If the ray passed all but
 * the last element, and met that one, p and opl are right and d is NaN. */

/* A change of a ray: of its point, its direction, and its path. */
typedef struct sgt_ray_change {
    sgt_vec3 p, d;
    double   opl;
} sgt_ray_change;

/* Forward: the changes of the end by changes of the launch ray.
 *
 *     launch    as it was given to sgt_trace; its direction may have any length
 *     passages  as sgt_trace left them, of all elements
 *     columns   how many changes
 *     change    by how much the launch ray changes: p is that of launch->o, d that of
 *               launch->d, opl is added to the path.  Global frame
 *     out       by how much the end changes.  It may be the same array as change
 *
 * The change of launch->d along launch->d changes nothing but the length of it.  Two
 * columns aim in a pupil; six are the whole Jacobian by the ray.  The second derivatives
 * of a surface are worked out once for all columns. */
SGT_API int sgt_trace_sensitivity(size_t elements, const sgt_element e[],
                                  double index_before, const sgt_ray *launch,
                                  const sgt_passage passages[], size_t columns,
                                  const sgt_ray_change change[],
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
 * The numbers of a phase are not among them: sgt_phase_gradient.
 *
 * Returns how many there are: 7, and m + 7 for each element.  A thickness is not one of
 * them.  It moves all elements behind it, so the derivative by it is the sum of their
 * derivatives by origin. */
SGT_API size_t sgt_trace_parameters(size_t elements, const sgt_element e[]);

/* Reverse: the gradients of `rows` numbers by all parameters of the trace at once.
 *
 *     weight    number r is weight[r].p . p + weight[r].d . d + weight[r].opl * opl.
 *               With a weight of 1 for one of the seven components it is that one, and
 *               seven rows are the whole Jacobian
 *     gradient  rows * sgt_trace_parameters(elements, e) numbers, row by row
 *
 * All else is as for sgt_trace_sensitivity.  A sweep backward costs a small multiple of
 * the trace, however many parameters there are, and no work space: what it needs of each
 * element is in the passages.  Eight rows share a sweep. */
SGT_API int sgt_trace_gradient(size_t elements, const sgt_element e[],
                               double index_before, const sgt_ray *launch,
                               const sgt_passage passages[], size_t rows,
                               const sgt_ray_change weight[], double gradient[]);

/* The numbers of phases that a trace depends on: for each element that has one, in order,
 *
 *     an ideal lens   3   focal_length, focal_length_y, object_distance.  If the second
 *                         is 0, the first is that of both axes, and the derivative by
 *                         the second is 0.  So it is by an object_distance that is 0 or
 *                         infinite
 *     a phase in      1   per_wave, the order times the wavelength
 *     waves           m   the parameters of its `waves`; m = sgt_parameters(phase->waves)
 *     facets          1   0, in the place of per_wave
 *                     m   the parameters of their sag
 *
 * Returns how many there are. */
SGT_API size_t sgt_phase_parameters(size_t elements, const sgt_element e[]);

/* sgt_trace_gradient by these numbers.  The wavelength L moves per_wave by the order, and
 * each index by its dispersion: the derivative by L is the sum of
 *
 *     order * that by per_wave             of each phase in waves
 *     dn/dL * that by the index            of each element (sgt_trace_gradient), and by
 *                                          index_before
 *
 *     gradient  rows * sgt_phase_parameters(elements, e) numbers, row by row
 *
 * All else is as for sgt_trace_gradient.  SGT_LACKS_PARAMETERS: `waves` tells no
 * derivatives by its parameters.  What depends on opl behind facets is NaN. */
SGT_API int sgt_phase_gradient(size_t elements, const sgt_element e[],
                               double index_before, const sgt_ray *launch,
                               const sgt_passage passages[], size_t rows,
                               const sgt_ray_change weight[], double gradient[]);

/* ------------------------------------------------------------ the error of the end */

/* How far rounding moves the end of a ray. */
typedef struct sgt_end_error {
    double point; /* x and y of the last hit.p, in its frame, from the exact ray's */
    double path;  /* opl, without what `point` adds: the path to the foot of the
                     perpendicular from a fixed point near the end on the ray.  opl itself
                     is off by at most path + index * point where the last element is
                     plane; its slope s makes that path + index * point * sqrt(1 + s^2) */
    double grain; /* how far an ulp of each number of the launch ray moves the point */
    double path_grain; /* how far it changes the path, except by moving the launch point
                          along the ray.  0 if there is no phase: by Fermat's principle
                          the change is then of second order */
    unsigned long long reserved_[2];
} sgt_end_error;

/* Bounds on the errors of the end of a ray: how far it is from the exact ray that begins
 * as the launch ray stands.
 *
 *     elements, e, index_before   as they were given to sgt_trace
 *     launch                      the launch ray as it was given to sgt_trace
 *     passages                    as sgt_trace left them, for a ray that passed all
 *                                 elements, or that met the last one
 *     out                         written; lengths in the unit of the lens
 *
 * METHOD.  Each element adds p_err, t_err and the rounding of a direction.  For the point
 * they go through the derivatives of the rest of the lens, with a half added for the
 * second order; the rounding of directions is observed, not proven (src/system/trace.h).
 * For the path there is Fermat's principle: between surfaces that are met exactly it is
 * stationary, so a point that is off the surface by p_err adds |n d - n' d'| p_err, and
 * directions nothing of first order.  How far opl is from the path through the points is
 * computed, in twice the precision.  That principle does not hold for ideal lenses.  If
 * there is a phase, the errors go through the derivatives of the path, as those of the
 * point do, and the bound of W of system.h is added.  How far the gradient of a user's
 * phase is off is a guess, 2^-47 of it.
 *
 * point is NaN where a surface that bends has no second derivatives; so are path and
 * path_grain, if there is also a phase.  false: a hit is not positive; all is NaN. */
SGT_API bool sgt_trace_error(size_t elements, const sgt_element e[], double index_before,
                             const sgt_ray *launch, const sgt_passage passages[],
                             sgt_end_error *out);

/* ------------------------------------------------------------------- many rays at once
 *
 * The functions above, for the rays of a batch that was traced.  Each number is the one
 * that the function for one ray gives, bit for bit (a NaN for a NaN), whatever its
 * neighbours are.
 *
 * Arrays have n numbers.  Outputs must not overlap inputs or each other, unless it is
 * said.  A ray whose hit at an element is not positive is not shown to the surface there.
 *
 * Rays go through all elements 64 at a time, in loops over rays; phases go ray by ray,
 * and surfaces as fast as their `second` and `by_parameter` are.  12 numbers an
 * element are read of each ray.  So take some hundred rays at a time from sgt_trace_batch
 * to here: then they are still in the processor's cache. */

/* A batch of rays and how it went through the lens. */
typedef struct sgt_traces {
    size_t   n;                   /* how many rays */
    sgt_rays rays;                /* the launch rays as they were given to
                                     sgt_trace_batch; o and d are read, in the global
                                     frame */
    const sgt_passages *passages; /* as sgt_trace_batch left them, one entry for each
                                     element.  hits.status (NULL: all were met), hits.t,
                                     hits.p, hits.n and direction are read */
} sgt_traces;

/* Changes of many rays, one array for each number of sgt_ray_change.  p and d: all three
 * arrays, or none.  NULL: of an input, no change; of an output, not wanted. */
typedef struct sgt_ray_changes {
    double *p[3], *d[3], *opl;
    unsigned long long reserved_[2]; /* leave it zero: else SGT_LACKS_MEMBER */
} sgt_ray_changes;

/* sgt_trace_sensitivity of n rays.
 *
 *     columns  how many changes
 *     change   change[j]: column j of each ray
 *     out      written: out[j], column j; they may be the arrays of change */
SGT_API int sgt_trace_sensitivity_batch(size_t elements, const sgt_element e[],
                                        double index_before, const sgt_traces *traces,
                                        size_t columns,
                                        const sgt_ray_changes change[],
                                        const sgt_ray_changes out[]);

/* sgt_trace_gradient of n rays.
 *
 *     weight    weight[r]: number r of each ray
 *     gradient  rows * sgt_trace_parameters(elements, e) arrays, row by row; one that is
 *               NULL is not wanted.  All parameters of a surface unwanted: it is not
 *               asked for them */
SGT_API int sgt_trace_gradient_batch(size_t elements, const sgt_element e[],
                                     double index_before, const sgt_traces *traces,
                                     size_t rows, const sgt_ray_changes weight[],
                                     double *const gradient[]);

/* The numbers of sgt_end_error of many rays.  An array that is NULL is not wanted.  If
 * path is not wanted and no element has a phase, the path is not worked out again, a
 * third of the work. */
typedef struct sgt_end_errors {
    double *point, *path, *grain, *path_grain;
    unsigned long long reserved_[2]; /* leave it zero: else all is NaN */
} sgt_end_errors;

/* sgt_trace_error of n rays.  Returns for how many rays all hits are positive.
 *
 *     traces  hits.p_err of the passages is also read, and opl of the last one if path
 *             is wanted
 *     out     written; lengths in the unit of the lens */
SGT_API size_t sgt_trace_error_batch(size_t elements, const sgt_element e[],
                                     double index_before, const sgt_traces *traces,
                                     sgt_end_errors out);

/* ------------------------------------------------------------------------- aiming */

/* A family of launch rays with two parameters:
 *     o(u, v) = o + u ou + v ov,   d(u, v) = d + u du + v dv.
 * From an object point: ou = ov = 0, and the direction varies.  A beam from afar: du = dv
 * = 0, and the origin varies in a plane.  Both may vary.  A vector that is left zero does
 * not.  u and v have any unit; all numbers are finite. */
typedef struct sgt_beam {
    sgt_vec3 o, ou, ov;  /* length */
    sgt_vec3 d, du, dv;  /* of any length */
    sgt_interval u, v;   /* lo <= hi: the box that is searched, ends included */
    unsigned long long reserved_[2]; /* leave it zero */
} sgt_beam;

/* A launch ray of the beam, from its origin on. */
SGT_API sgt_ray sgt_beam_ray(const sgt_beam *beam, double u, double v);

/* What became of it.  Negative is undecided, as everywhere. */
typedef enum sgt_aimed {
    SGT_MET           =  1,  /* `ray` meets the point, within `miss` */
    SGT_NO_SUCH_RAY   =  0,  /* proven: no launch ray of the box meets it */
    SGT_AIMED_UNDECIDED = -1,  /* none was found, and none excluded: see the attempts */
    SGT_AIMED_INVALID   = -2   /* a number of the beam, the point or the options is NaN,
                                infinite, or not in its range; no direction at all; a
                                member for later versions that is not zero.
                                sgt_explain_aim says which */
} sgt_aimed;

/* "met", "no such ray", "undecided" or "invalid". */
SGT_API const char *sgt_aimed_text(sgt_aimed aimed);

/* How the search from one start ended. */
typedef enum sgt_aim_reason {
    SGT_AIM_ARRIVED,  /* at the point */
    SGT_AIM_NO_WAY,   /* the start itself does not get to the stop: fate and element */
    SGT_AIM_CUT,      /* rays that would be nearer do not get there: fate and element of
                         the last one */
    SGT_AIM_AT_EDGE,  /* the nearest ray is on the edge of the box */
    SGT_AIM_STUCK,    /* the miss has a minimum that is not 0, or cannot be made less */
    SGT_AIM_SPENT     /* max_traces was spent */
} sgt_aim_reason;

typedef struct sgt_attempt {
    sgt_vec2       from, to;  /* (u, v) at its start, and of the best ray */
    double         miss;      /* of the best ray, length; NaN: no ray has got there */
    sgt_aim_reason reason;
    sgt_fate       fate;      /* of the last ray that did not reach the stop; SGT_PASSED:
                                 all reached it */
    size_t         element;   /* where that ray ended, from 0 */
    int            traces;    /* spent */
    unsigned long long reserved_[2];
} sgt_attempt;

/* Zeros are the defaults. */
typedef struct sgt_aim_options {
    double tol;             /* a miss of that length is good enough; 0: as little as
                               rounding allows */
    size_t starts;          /* how many points `start` has */
    const sgt_vec2 *start;  /* (u, v) to begin at, such as the answers for neighbouring
                               points.  They are tried first, in order.  One outside the
                               box is moved into it */
    int max_traces;         /* of the search; 0: 400 */
    int max_boxes;          /* of the proof that there is no such ray; 0: 1500, some
                               milliseconds; below 0: no proof is tried */
    size_t       room;      /* of attempt[]: further starts are not recorded */
    sgt_attempt *attempt;   /* written */
    unsigned long long reserved_[4]; /* leave it zero */
} sgt_aim_options;

/* The answer.  If nothing is met, all numbers but the counts are NaN. */
typedef struct sgt_aiming {
    sgt_aimed status;
    double    u, v;
    sgt_ray   ray;       /* the launch ray: to be traced as it stands */
    sgt_vec2  point;     /* where it meets the stop, as traced */
    double    miss;      /* the exact ray meets the stop within `miss` of the wanted
                            point, by x and y.  See BOUND */
    size_t    clipped;   /* the first of e[0 ... stop] whose semi_diameter or aperture
                            clips it; stop + 1: none does */
    size_t    attempts;  /* starts that were tried */
    int       traces, boxes; /* spent on the search and on the proof */
    unsigned long long reserved_[2];
} sgt_aiming;

/* The launch ray of the beam that meets element `stop` where x and y of its frame are
 * those wanted, after e[0] ... e[stop - 1] in order.
 *
 *     stop          the element that is aimed at, from 0; e[0] ... e[stop] are read
 *     index_before  in front of e[0]; 0: 1
 *     beam          the family of launch rays, and the box that is searched
 *     wanted        the point, by x and y of the frame of e[stop]; length
 *     passages      room for stop + 1: how the best ray of the last attempt went.  If the
 *                   point is met, that is the ray of the answer
 *     opt           NULL, or the options
 *     out           written; NULL: not wanted
 *
 * Returns the status, as in *out.
 *
 * WHICH RAYS GET THERE.  The roots, the refraction and the mirrors are those of sgt_trace
 * without options.  Apertures are ignored: a ray that is clipped goes on (`clipped` says
 * which element clips it).  The ray must meet the surface of the stop, but need not go on
 * behind it.
 *
 * METHOD.  Newton's for two equations, by the derivatives of sgt_trace_sensitivity.  A
 * step is taken only if it makes the miss less.  Else it is halved, as it is if its ray
 * misses a surface or is totally reflected.  Where the derivatives are singular, or no
 * step along Newton's is good, a damped step is taken (Levenberg 1944, Quart. Appl. Math.
 * 2, 164; Marquardt 1963, J. SIAM 11, 431).  Steps end at the edge of the box.  The
 * starts are yours, then the middle of the box, then points all over it (Halton 1960,
 * Numer. Math. 2, 84).  After a few of them the proof is tried, then the rest.
 *
 * THE FIRST FOUND.  If several rays of the box meet the point, one of them is the answer,
 * mostly the one nearest to the first start.
 *
 * BOUND.  miss = |point - wanted| + the error of `point`.  That is p_err of the hit, and
 * what the errors of all elements before do to it: p_err of each, and the rounding of
 * each direction, by the derivatives of the end by both.  It is of first order, with a
 * half added.  The rounding of directions is observed (src/system/trace.h), not proven.
 * NaN: a surface has no second derivatives.
 *
 * THE PROOF of SGT_NO_SUCH_RAY is tried if no start arrives.  The box is divided, and
 * each part is traced as a whole: all numbers are linear in (u, v) with a bound on what
 * that leaves out and on all rounding (Taylor models of the first order: Makino and Berz
 * 2003, Int. J. Pure Appl. Math. 4, 379).  A part is done if no ray of it gets to the
 * stop, or none to the point.  It is about the exact rays, and covers every root that
 * sgt_trace may mean.  It is offered for all sags of surfaces.h, in any frames, with
 * ideal lenses on them or not.  It is not for bodies, level sets and a user's surfaces:
 * their `enclose` is about one ray.  What is often left undecided: points that are nearly
 * met; rays that graze; aspheres and departures without a rim (semi_diameter of the
 * surface), where rays pass outside of the element's aperture, as roots far out might be
 * meant. */
SGT_API sgt_aimed sgt_aim(size_t stop, const sgt_element e[], double index_before,
                          const sgt_beam *beam, sgt_vec2 wanted, sgt_passage passages[],
                          const sgt_aim_options *opt, sgt_aiming *out);

/* Points that a beam is aimed at together, and the answers. */
typedef struct sgt_aims {
    size_t n;                     /* how many points */
    const sgt_vec2 *wanted;       /* n points, by x and y of the stop's frame; length */
    sgt_aiming *out;              /* n answers, or NULL */
    const sgt_passages *passages; /* stop + 1 entries; each with the arrays hits.status,
                                     t, p, n, p_err and direction, of n.  At return: those
                                     of sgt_aim for each point, to the stop.  Other arrays
                                     that are there are written as well */
} sgt_aims;

/* sgt_aim at n points: the same answers, bit for bit, counts included.
 *
 *     aims  the points and the answers
 *     room  work space for stop + 1 passages
 *     opt   as for one point.  start: opt->starts of them for each point; those of point
 *           i are start[i * starts] and on.  attempt: room of them for each point, those
 *           of point i are attempt[i * room] and on
 *
 * Returns how many points are met.  The points go together, by full steps of Newton from
 * the first start.  A point that needs anything else (a step that is halved or damped or
 * ends at the edge of the box, another start, a proof) is left to sgt_aim.  So good
 * starts save much: each round costs one and a half traces.  The passages of a point that
 * is not met are those of a ray that met nothing.  The stack needed is below 96 KiB. */
SGT_API size_t sgt_aim_batch(size_t stop, const sgt_element e[], double index_before,
                             const sgt_beam *beam, const sgt_aims *aims,
                             sgt_passage room[], const sgt_aim_options *opt);

/* Why does sgt_aim answer SGT_AIMED_INVALID?  As sgt_explain_intersect. */
SGT_API bool sgt_explain_aim(size_t stop, const sgt_element e[], double index_before,
                             const sgt_beam *beam, sgt_vec2 wanted,
                             const sgt_aim_options *opt, sgt_error *error);

/* Bounds on u and v of the rays that meet a point of the stop and that the rims in front
 * let through.
 *
 *     stop          the element of the point, from 0; e[0] ... e[stop] are read
 *     index_before  in front of e[0]; 0: 1
 *     beam          its box, u and v, is not read
 *     wanted        the point, by x and y of the frame of e[stop]; length
 *     u, v          written: the bounds
 *
 * Rims are semi_diameter, what `aperture` lets through, the semi_diameter of the surface,
 * and the edge of a conic with k > -1.  They count up to the first element that bends
 * rays, and at it; or up to the stop, where the point itself is the bound.
 * The family has one origin or one direction: du = dv = 0 or ou = ov = 0.
 *
 * true: they are bounds.  They may be empty (lo > hi): then there is no such ray.
 * false: nothing bounds u or v. */
SGT_API bool sgt_beam_bounds(size_t stop, const sgt_element e[], double index_before,
                             const sgt_beam *beam, sgt_vec2 wanted, sgt_interval *u,
                             sgt_interval *v);

#ifdef __cplusplus
}
#endif
#endif
