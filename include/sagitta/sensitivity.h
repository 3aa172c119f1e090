/* sensitivity.h - how the answer of sgt_intersect changes with the ray and with the surface: what an optimiser needs.
 *
 * The hit is where F(o + t d; a) = 0, a the parameters of the surface.  Move the origin by do, the direction by dd and
 * the parameters by da, and the root stays a root if (the implicit function theorem)
 *     dt = -(n . (do + t dd) + F_a . da) / s,       s = n . d,
 *     dp = do + t dd + d dt,
 *     dn = H dp + (grad F_a) . da,
 * n the gradient of F as sgt_hit has it, F_a the derivatives of F by the parameters, H its second derivatives.  No root is
 * searched again: all is worked out at the hit, by the formulas of the surface, without differences.
 *
 * THE DIRECTION needs no outputs of its own: dd acts as a shift t dd of the origin does, so each derivative by d is
 * t times that by o.
 *
 * WHICH PARAMETERS, and their order, says surfaces.h: of a conic c, k; of an even asphere c, k, a[0] ... a[7], those that
 * are zero too; of the others c, k and the coefficients, but where said.  semi_diameter is none: it moves no root.  Level
 * sets (julia, mandelbrot) have none, and no second derivatives.  A surface of a user has what its operations offer
 * (sgt_surface_ops: second, parameters, by_parameter).
 *
 * n IS NOT OF UNIT LENGTH.  Of the unit normal u = n / |n| the change is du = (dn - u (u . dn)) / |n|; of a reflected
 * direction r = d - 2 u (u . d) it is dr = dd - 2 (u (du . d + u . dd) + du (u . d)).
 *
 * HOW GOOD.  A few roundings of each term, where terms cancel of the largest, and what s is
 * off by.  Where the ray grazes, c = |n| |d| / |s| is large: the root runs away from any
 * change, and all outputs are large and uncertain.  dt/do is off by up to
 *     8 u c + p_err |H d| / |s| + p_err |H| / |n|,     u = 2^-53,
 * of its largest component, and the other outputs with it.  First, s is a sum of three
 * products.  Second and third, s and n are those at p, and the root is within p_err of p.  Where the
 * radius of curvature is far below the surface's own lengths, as at the pinch of a torus, u times these
 * lengths stands in place of a smaller p_err: they are rounded on the way to n.  Conics and even aspheres
 * polish the roots of grazing rays in twice the precision: their dt/do is
 * within 64 u c besides (20 u c has been seen).  Other surfaces know a root, along the ray,
 * to about u c lengths, since their F has a rounding of its own; one more Newton step from p
 * would be off by as much.  So the second is about u c^2: at c = 1e6 a relative 1e-4, and at
 * c = 1e8 hardly a digit is left.  Where s = 0 all are infinite or NaN.
 *
 * They are the derivatives of the root that was met: that another comes before it, or that
 * it passes the rim, no derivative tells.  What second and by_parameter say of p they say of
 * p as rounded: near the equator of a sphere, 1 - (1 + k) c^2 r^2 = q << 1 (c the
 * curvature), that is a relative 2^-53 / q, and NaN where rounding has put p outside the
 * domain (the derivatives of t and p by the ray need neither of them and are as good as n).
 *
 * Every function may run in any number of threads; nothing is allocated, and the stack needed is below 80 KiB.  Answers
 * have the same bits on every processor, alone and among any others. */
#ifndef SAGITTA_SENSITIVITY_H
#define SAGITTA_SENSITIVITY_H
#include <sagitta/sagitta.h>
#ifdef __cplusplus
extern "C" {
#endif

/* How many parameters the surface has derivatives by; 0: none are offered. */
SGT_API size_t sgt_parameters(sgt_surface s);

/* What was wanted and is not to be had of this surface: the sum of these is returned, 0 where nothing is missing.  The
 * outputs that need it are NaN, all others are as they should be. */
enum {
    SGT_LACKS_SECOND = 1,      /* it offers no second derivatives: no changes of n are known */
    SGT_LACKS_PARAMETERS = 2   /* it offers no derivatives by parameters, of which it has none then */
};

/* A column of the Jacobian: by how much t, p and n change with one number. */
typedef struct sgt_change { double t; sgt_vec3 p, n; } sgt_change;

/* One ray and its hit: by_o[0 ... 2], by o.x, o.y, o.z; by_a[j], by parameter j, sgt_parameters(s) of them.  NULL: not
 * wanted.  All NaN where the status of the hit is not positive. */
SGT_API int sgt_differentiate(sgt_surface s, const sgt_ray *ray, const sgt_hit *hit, sgt_change by_o[3], sgt_change by_a[]);

/* The Jacobian of many hits: one array per number, NULL = not wanted and not computed.  t_by_o[j] is dt/do_j, p_by_o[i][j]
 * dp_i/do_j; t_by_a is a list of as many arrays as there are parameters, t_by_a[j] of dt/da_j, and p_by_a[i] is one of dp_i/da_j;
 * n likewise.  Each list and each array in one may be NULL.
 *
 * To read dp from memory costs more than to work it out where it is needed: it is
 *     dp/do_j = e_j + d t_by_o[j],     dp/da_j = d t_by_a[j],     e_j the unit vector. */
typedef struct sgt_jacobian {
    double *t_by_o[3], *p_by_o[3][3], *n_by_o[3][3];
    double *const *t_by_a, *const *p_by_a[3], *const *n_by_a[3];
} sgt_jacobian;

/* The Jacobian of n hits, as sgt_intersect_batch has left them: of the rays d is read, of the hits p, n and, where it is
 * given, status: rays whose status is not positive, or whose n is NaN, have NaN everywhere, and are not shown to the
 * surface.  Each number is the one that sgt_differentiate gives, bit for bit.  Outputs must not overlap the inputs or each
 * other.
 *
 * Where a surface has many parameters, arrays that do not fit into the processor's cache cost more than the arithmetic:
 * take a thousand rays or so at a time, and use up what they have given before the next. */
SGT_API int sgt_differentiate_batch(sgt_surface s, size_t n, sgt_rays rays, sgt_hits hits, sgt_jacobian out);

/* The Jacobian times a change, through one surface after the other: origins and directions change by change.o and change.d (all
 * three arrays of one, or none: no change; tmin and tmax are not read), the parameters by da, the same for all rays (NULL: no
 * change; a parameter whose da is 0 is not asked for).  Written are the changes of t, p and n, those arrays that are
 * not NULL.  Of the hits t is read too, where directions change. */
typedef struct sgt_changes { double *t, *p[3], *n[3]; } sgt_changes;

SGT_API int sgt_differentiate_forward(sgt_surface s, size_t n, sgt_rays rays, sgt_hits hits, sgt_rays change, const double da[], sgt_changes out);

#ifdef __cplusplus
}
#endif
#endif /* SAGITTA_SENSITIVITY_H */
