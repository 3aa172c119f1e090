/* surfaces.h - the built-in surfaces.
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
 * above 1e150, or so small that its square is below 2^-960, it is.
 * Source: ISO 10110-12. */
typedef struct sgt_conic { double c, k, semi_diameter; } sgt_conic;

/* The conic plus the sum of a[i] r^(2i + 2), i = 0 ... 7: up to r^16; a[i] in
 * 1/length^(2i + 1).  With every a[i] zero it is solved as the conic it is. */
typedef struct sgt_asphere { double c, k, semi_diameter, a[8]; } sgt_asphere;

extern SGT_API const sgt_surface_ops sgt_conic_ops, sgt_asphere_ops;

/* The same list as data: for a parser, a benchmark, a test of them all.  Ends
 * with a row of zeros.  A row is a type as a lens file names it: "plane",
 * "sphere" and "conic" share one struct and one table of operations, and differ
 * in the parameters that may be given.  unit is a power of length, as text ("1",
 * "length", "1/length"); the legal values are lo <= x <= hi, all finite; count > 1
 * is a list, that may be given shorter. */
typedef struct sgt_param { const char *name, *unit; size_t offset; int count; double lo, hi; } sgt_param;
typedef struct sgt_builtin { const char *type; const sgt_surface_ops *ops; size_t size; const sgt_param *params; } sgt_builtin;

extern SGT_API const sgt_builtin sgt_builtins[];

#ifdef __cplusplus
}
#endif
#endif /* SAGITTA_SURFACES_H */
