// SPDX-License-Identifier: MIT
/* sensitivity.h - how a hit changes with the ray and with the surface: derivatives, for
 * an optimiser.
 *
 * METHOD.  The hit is where F(o + t d; a) = 0, a the parameters.  Move the origin by do,
 * the direction by dd and the parameters by da.  The root stays a root (the implicit
 * function theorem) if
 *     dt = -(n . (do + t dd) + F_a . da) / s,       s = n . d,
 *     dp = do + t dd + d dt,
 *     dn = H dp + (grad F_a) . da.
 * n is the gradient of F as sgt_hit has it, F_a the derivatives of F by the parameters, H
 * its second derivatives.  No root is searched again: all is worked out at the hit by the
 * formulas of the surface, without differences.
 *
 * DIRECTION.  There are no outputs for it.  dd acts as a shift t dd of the origin does,
 * so each derivative by d is t times the one by o.
 *
 * PARAMETERS.  surfaces.h says which there are, and in what order.
 *     conic              c, k
 *     even asphere       c, k, a[0] ... a[7], those that are zero too
 *     others             c, k and the coefficients, unless surfaces.h says something else
 *     julia, mandelbrot  none, and no second derivatives
 *     a user's           what its operations offer (second, parameters, by_parameter)
 * semi_diameter is not a parameter: it moves no root.
 *
 * UNIT NORMAL.  n is not of unit length.  The change of the unit normal u = n / |n| is
 *     du = (dn - u (u . dn)) / |n|,
 * and that of a reflected direction r = d - 2 u (u . d) is
 *     dr = dd - 2 (u (du . d + u . dd) + du (u . d)).
 *
 * ACCURACY.  The errors are a few roundings of each term (of the largest, if terms
 * cancel), and the error of s.  If the ray grazes, c = |n| |d| / |s| is large: the root
 * runs away from any change, and all outputs are large and uncertain.  With u = 2^-53,
 * dt/do is off by up to
 *     8 u c + p_err |H d| / |s| + p_err |H| / |n|
 * of its largest component, and the other outputs with it.
 *   - The first term: s is a sum of three products.
 *   - The second and third: s and n are those at p, and the root is within p_err of p.
 *   - Where the radius of curvature is far below the surface's own lengths, as at the
 *     pinch of a torus, u times these lengths stands in place of a smaller p_err: they
 *     are rounded on the way to n.
 *   - Conics and even aspheres polish the roots of grazing rays in twice the precision.
 *     Their dt/do is also within 64 u c (20 u c has been seen).
 *   - Other surfaces know a root, along the ray, to about u c lengths, since their F has
 *     a rounding of its own; one more Newton step from p would be off by as much.  So the
 *     second term is about u c^2: at c = 1e6 a relative 1e-4, and at c = 1e8 hardly a
 *     digit is left.
 *   - Where s = 0, all are infinite or NaN.
 *   - second and by_parameter are taken at p as rounded.  Near the equator of a sphere,
 *     1 - (1 + k) c^2 r^2 = q << 1 (c the curvature), that is a relative 2^-53 / q, and
 *     NaN if rounding has put p outside the domain.  The derivatives of t and p by the
 *     ray need neither of them and are as good as n.
 *
 * NOT SAID.  They are the derivatives of the root that was met.  No derivative
 * says whether another root comes before it, or whether it leaves the rim.
 *
 * Every function may run in any number of threads.  Nothing is allocated, and the stack
 * needed is below 80 KiB.  Answers have the same bits on every processor, alone and among
 * any others. */
#ifndef SAGITTA_SENSITIVITY_H
#define SAGITTA_SENSITIVITY_H
#include <sagitta/sagitta.h>
#ifdef __cplusplus
extern "C" {
#endif

/* How many parameters the surface has derivatives by; 0: none are offered. */
SGT_API size_t sgt_parameters(sgt_surface s);

/* What was wanted and is not offered.  The functions below return the sum of
 * these; 0: nothing is missing.  Outputs that need it are NaN; all others are right. */
enum {
    SGT_LACKS_SECOND = 1,     /* no second derivatives: no changes of n are known */
    SGT_LACKS_PARAMETERS = 2, /* no derivatives by parameters: it has none then */
    SGT_LACKS_MEMBER = 4      /* the outputs have a member of a later version than this
                                 library, which is not written */
};

/* A column of the Jacobian: by how much t, p and n change with one number. */
typedef struct sgt_change {
    double   t;
    sgt_vec3 p, n;
} sgt_change;

/* The Jacobian of one hit.  All NaN if the status of the hit is not positive.
 *     by_o  NULL: not wanted.  by_o[0 ... 2] are by o.x, o.y, o.z
 *     by_a  NULL: not wanted.  by_a[j] is by parameter j; sgt_parameters(s) of them */
SGT_API int sgt_differentiate(sgt_surface s, const sgt_ray *ray, const sgt_hit *hit,
                              sgt_change by_o[3], sgt_change by_a[]);

/* The Jacobian of many hits: one array for each number.  An array that is NULL is not
 * wanted and not computed.  Each list may be NULL as well.
 *
 * To read dp from memory costs more than to work it out where it is needed.  With e_j the
 * unit vector it is
 *     dp/do_j = e_j + d t_by_o[j],     dp/da_j = d t_by_a[j]. */
typedef struct sgt_jacobian {
    double *t_by_o[3];           /* [j]: dt/do_j */
    double *p_by_o[3][3];        /* [i][j]: dp_i/do_j */
    double *n_by_o[3][3];        /* [i][j]: dn_i/do_j */
    double *const *t_by_a;       /* a list of sgt_parameters(s) arrays; [j]: dt/da_j */
    double *const *p_by_a[3];    /* [i]: such a list, of dp_i/da_j */
    double *const *n_by_a[3];    /* [i]: such a list, of dn_i/da_j */
    unsigned long long reserved_[4]; /* leave it zero: else SGT_LACKS_MEMBER */
} sgt_jacobian;

/* The Jacobian of n hits.  Each number is the one that sgt_differentiate gives, bit for
 * bit.
 *
 *     n     how many hits; each array has n numbers
 *     rays  as they were given to sgt_intersect_batch; d is read
 *     hits  as sgt_intersect_batch left them; p, n and, if it is given, status are read
 *     out   written
 *
 * If the status of a ray is not positive, or its n is NaN, all outputs for it are NaN,
 * and the operations of the surface do not get to see it.  Outputs must not overlap the
 * inputs or each other.
 *
 * If a surface has many parameters, arrays that do not fit into the processor's cache
 * cost more than the arithmetic.  Take a thousand rays or so at a time, and use their
 * results before the next. */
SGT_API int sgt_differentiate_batch(sgt_surface s, size_t n, sgt_rays rays, sgt_hits hits,
                                    sgt_jacobian out);

/* The changes of many hits.  An array that is NULL is not wanted. */
typedef struct sgt_changes {
    double *t, *p[3], *n[3];
} sgt_changes;

/* The Jacobian times a change, through one surface after the other.
 *     change  by how much origins and directions change: change.o, change.d.  All three
 *             arrays of one, or none: no change.  tmin and tmax are not read
 *     da      by how much the parameters change, the same for all rays.  NULL: no change.
 *             A parameter whose da is 0 is not asked for
 *     out     the changes of t, p and n
 * If directions change, t of the hits is also read. */
SGT_API int sgt_differentiate_forward(sgt_surface s, size_t n, sgt_rays rays,
                                      sgt_hits hits, sgt_rays change, const double da[],
                                      sgt_changes out);

#ifdef __cplusplus
}
#endif
#endif /* SAGITTA_SENSITIVITY_H */
