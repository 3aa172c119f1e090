/* surfaces.h - the built-in surfaces: sags of optics, and level sets of quaternion orbits.
 *
 * Each is a plain struct of numbers - nothing owned, nothing to free, memcpy is a
 * copy - and one table of operations.  Zero is a plane for every sag.  A sag is
 * F = z - s(x, y) in its own frame, the vertex at the origin; F is NaN where s is
 * not defined.  A root outside semi_diameter does not count; F itself knows
 * nothing of it. */
#ifndef SAGITTA_SURFACES_H
#define SAGITTA_SURFACES_H
#include <sagitta/sagitta.h>
#ifdef __cplusplus
extern "C" {
#endif

/* s = c r^2 / (1 + sqrt(1 - (1 + k) c^2 r^2)), for r <= semi_diameter (0: all r).
 * c: curvature, 1/length (0: a plane; the centre of a positive one is at +z).
 * k: conic constant (0 sphere, -1 paraboloid; below -1 one sheet of a
 * hyperboloid, above 0 an oblate ellipsoid).  The rim is soft by a part in 2^44:
 * r^2 <= semi_diameter^2 (1 + 2^-44) counts, so that a marginal ray at
 * 0.5000000000000004 is inside 0.5.  Where |c| r is beyond 1e150 or coordinates
 * are beyond 1e150 radii apart an answer may be SGT_UNPROVEN; where semi_diameter is
 * 1e150 or more, or so small that its square is below 2^-960, it is.
 * Source: ISO 10110-12. */
typedef struct sgt_conic { double c, k, semi_diameter; } sgt_conic;

/* The conic plus the sum of a[i] r^(2i + 2), i = 0 ... 7: up to r^16; a[i] in
 * 1/length^(2i + 1).  With every a[i] zero it is solved as the conic it is. */
typedef struct sgt_asphere { double c, k, semi_diameter, a[8]; } sgt_asphere;

extern SGT_API const sgt_surface_ops sgt_conic_ops, sgt_asphere_ops;

/* The level set |Q_N| = escape of the orbit Q_{j+1} = Q_j^p + c of quaternions that
 * starts at Q_0 = at + x ex + y ey + z ez: any three-dimensional slice, at any angle and
 * scale, of the four-dimensional set.  F = (u - 1) / (u + 1) with u = |Q_N|^2 / escape^2:
 * -1 ... 0 inside, 0 ... 1 outside, and it cannot overflow.  Zero means default:
 * iterations 10, power 2, escape the smallest that is safe (the root of x^p = x + |c|),
 * axes that are all zero the first three components.  SGT_INVALID: a number that is not
 * finite, iterations outside 1 ... 100, power outside 2 ... 8, an escape below the safe
 * one (by more than a part in 2^40) or above 1e6, axes that are not independent, a
 * component of c or `at` above 1e6, axes longer than 1e100 or shorter than 1e-100, or
 * iterations so many that the derivative leaves the range of a double: (p R^(p-1))^N above
 * 2^480, where R is the safe escape (of a mandelbrot the escape).
 * Sources: Norton 1982 (SIGGRAPH Computer Graphics 16, 197); Hart, Sandin, Kauffman
 * 1989 (23, 289). */
typedef struct sgt_julia {
    double c[4], at[4], ex[4], ey[4], ez[4];
    double escape;
    int    iterations, power;
} sgt_julia;

/* The same orbit from Q_0 = 0 with c = at + x ex + y ey + z ez: Q_1 is the point
 * itself.  The safe escape is 2^(1/(p-1)). */
typedef struct sgt_mandelbrot {
    double at[4], ex[4], ey[4], ez[4];
    double escape;
    int    iterations, power;
} sgt_mandelbrot;

extern SGT_API const sgt_surface_ops sgt_julia_ops, sgt_mandelbrot_ops;

/* The potential log|Q_n| / p^n of the orbit continued until |Q_n| > 2^32, or to n = 200:
 * beyond N, then, where the level set is.  F = tanh(log(|Q_N| / escape)), so the normal of
 * a hit is already along the gradient of the potential at level N, which is smooth there;
 * the one given here is nearer to that of the set itself, and has its finer folds.  grad
 * may be NULL; 0 and a zero gradient where the orbit does not escape; NaN where the
 * parameters are invalid.  Right to rounding where |Q_0| < 1e150; farther out to a part in
 * 100, and the gradient 0.  Source: Douady and Hubbard 1982 (C. R. Acad. Sci. 294, 123). */
SGT_API double sgt_julia_potential(const sgt_julia *s, sgt_vec3 p, sgt_vec3 *grad);
SGT_API double sgt_mandelbrot_potential(const sgt_mandelbrot *s, sgt_vec3 p, sgt_vec3 *grad);

/* The same list as data: for a parser, a benchmark, a test of them all.  Ends
 * with a row of zeros.  A row is a type as a lens file names it: "plane",
 * "sphere" and "conic" share one struct and one table of operations, and differ
 * in the parameters that may be given.  unit is a power of length, as text ("1",
 * "length", "1/length"); the legal values are lo <= x <= hi, all finite.  Two
 * parameters may be two names for one number ("slice" is at[3]): then only one of them
 * can be given.  What a range cannot say, `object` does: the first parameter that makes
 * the struct SGT_INVALID and why, or {NULL, NULL}; absent: the ranges say it all. */
typedef enum sgt_kind {
    SGT_REAL,    /* a double; count > 1: a list of up to count, the rest zero */
    SGT_VECTOR,  /* exactly count doubles */
    SGT_WHOLE    /* an int */
} sgt_kind;
typedef struct sgt_param { const char *name, *unit; size_t offset; int count; double lo, hi; sgt_kind kind; } sgt_param;
typedef struct sgt_objection { const char *param, *reason; } sgt_objection;
typedef struct sgt_builtin {
    const char *type;
    const sgt_surface_ops *ops;
    size_t size;
    const sgt_param *params;
    sgt_objection (*object)(const void *self);
} sgt_builtin;

extern SGT_API const sgt_builtin sgt_builtins[];

#ifdef __cplusplus
}
#endif
#endif /* SAGITTA_SURFACES_H */
