/* surfaces.h - the built-in surfaces: sags of optics, quadrics and tori, and level sets of quaternion orbits.
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
 * 0.5000000000000004 is inside 0.5.  A semi_diameter of 2^500 (3e150) or more is no
 * limit, as 0 is, and one below 2^-480 (3e-145) makes every answer SGT_UNPROVEN: of all
 * surfaces here.  Where |c| r is beyond 1e150 or coordinates are beyond 1e150 radii
 * apart an answer may be SGT_UNPROVEN.
 * Source: ISO 10110-12. */
typedef struct sgt_conic { double c, k, semi_diameter; } sgt_conic;

/* The conic plus the sum of a[i] r^(2i + 2), i = 0 ... 7: up to r^16; a[i] in
 * 1/length^(2i + 1).  With every a[i] zero it is solved as the conic it is. */
typedef struct sgt_asphere { double c, k, semi_diameter, a[8]; } sgt_asphere;

extern SGT_API const sgt_surface_ops sgt_conic_ops, sgt_asphere_ops;

/* ------------------------------------------------- sags that are not of revolution, or not even
 *
 * From here on surfaces are met by their operations, as a user's are, with bounds that are rigorous of F; what rounding of the point
 * does to F is taken to first order, but under a proof, which takes nothing so.  A batch is fast where semi_diameter is given
 * and the gradient within it is not too steep for the ray to be met twice; so is a single ray.  Without semi_diameter a miss is often
 * SGT_UNPROVEN on a ray without an end, and so is a first root on one without a beginning.
 *
 * A departure P(x, y) on a conic base: s = c r^2 / (1 + sqrt(1 - (1 + k) c^2 r^2)) + P, with c, k and
 * semi_diameter as above.  A row that is invalid answers SGT_INVALID: a number that is not finite, a negative
 * semi_diameter, a normalisation that is not above 0, a list longer than said.
 * For sensitivities the parameters are c, k and the coefficients in their order (but where said). */

/* Numbers that the caller keeps, row by row: x[i * columns + j].  A list is one row. */
typedef struct sgt_numbers { const double *x; size_t rows, columns; } sgt_numbers;

/* P = sum of a[i] r^(i + 1), i = 0 ... 15; a[i] in 1/length^i.  With a[0] the vertex is the tip of a cone: there the
 * gradient is given as that of the rest.  Source: the odd asphere of lens programs. */
typedef struct sgt_odd_asphere { double c, k, semi_diameter, a[16]; } sgt_odd_asphere;

/* P = sum of a[i][j] x^i y^j, at most 32 rows and 32 columns; in 1/length^(i + j - 1). */
typedef struct sgt_polynomial_xy { double c, k, semi_diameter; sgt_numbers a; } sgt_polynomial_xy;

/* P = sum of a[i][j] T_i(x / norm_x) T_j(y / norm_y), at most 64 rows and 64 columns; a in length.  T_n(cos u) = cos n u,
 * and beyond norm_x and norm_y the same polynomials.  Source: Mason and Handscomb 2002, section 1.2. */
typedef struct sgt_chebyshev { double c, k, semi_diameter, norm_x, norm_y; sgt_numbers a; } sgt_chebyshev;

/* P = sum of a[j - 1] Z_j(r / norm, theta), x = r cos theta, at most 5151 terms (Noll's to radial order 100); a in length.
 * order: SGT_NOLL (Noll 1976, J. Opt. Soc. Am. 66, 207: even j are cosines) or SGT_FRINGE (Wyant and Creath 1992, Applied
 * Optics and Optical Engineering XI, 1, table III: 1 piston, 2 x, 3 y, 4 defocus, ...: groups of equal n + m, in each m falling,
 * cosine before sine; what some programs call 37, n = 12 and m = 0, is 49 in that order).
 * normalised: 0, each radial polynomial is 1 at norm; else times sqrt(n + 1), sqrt(2 n + 2) where m is not 0: then the mean
 * square over the circle is 1.  Beyond norm the same polynomials. */
typedef enum sgt_zernike_order { SGT_NOLL = 1, SGT_FRINGE = 2 } sgt_zernike_order;
typedef struct sgt_zernike { double c, k, semi_diameter, norm; int order, normalised; sgt_numbers a; } sgt_zernike;

/* P = u^4 sum of a[m] Qcon_m(u^2), u = r / norm, Qcon_m(x) = P_m^(0,4)(2 x - 1) of Jacobi; at most 64 terms; a in length.
 * Source: Forbes 2007 (Opt. Express 15, 5218), section 2; ISO 10110-12:2019. */
typedef struct sgt_q_con { double c, k, semi_diameter, norm; sgt_numbers a; } sgt_q_con;

/* P = u^2 (1 - u^2) / sqrt(1 - c^2 r^2) sum of a[m] Qbfs_m(u^2) on a sphere (k = 0, and no parameter); at most 64 terms; a in length.
 * Source: Forbes 2007, section 3; the recurrences Forbes 2010 (Opt. Express 18, 19700). */
typedef struct sgt_q_bfs { double c, semi_diameter, norm; sgt_numbers a; } sgt_q_bfs;

/* P by bicubic convolution (Keys 1981, IEEE Trans. ASSP 29, 1153, a = -1/2) of the heights z[i][j] at
 * x = (j - (columns - 1) / 2) step_x, y = (i - (rows - 1) / 2) step_y: through every height, with a continuous gradient; beyond
 * the edge the heights are continued by Keys' boundary condition.  4 ... 4096 rows and columns.  Undefined outside the grid.
 * The parameters for sensitivities are c and k alone. */
typedef struct sgt_grid {
    double c, k, semi_diameter, step_x, step_y;
    sgt_numbers z;
    double height, steep, bend;  /* see sgt_grid_measure; 0: not measured */
} sgt_grid;

/* Passes over the heights once and writes bounds on |P|, |grad P| and the second derivative of P.  Without, every ray passes over the
 * heights that it may need, which is right, and slow.  Again after a change of z or the steps. */
SGT_API void sgt_grid_measure(sgt_grid *grid);

extern SGT_API const sgt_surface_ops sgt_odd_asphere_ops, sgt_polynomial_xy_ops, sgt_chebyshev_ops, sgt_zernike_ops, sgt_q_con_ops, sgt_q_bfs_ops,
    sgt_grid_ops;

/* The sum of the departures of `terms` on one conic base: each an even asphere or one of the surfaces above, of whose own base and
 * rim nothing is read (but the c of a q_bfs, in its root); or a toroid or a biconic, with all of its sag; but no other sum.
 * At most 16 terms, kept by the caller.  Parameters: c, k, and those of each term, of the former after their c and k, in order. */
typedef struct sgt_sum { double c, k, semi_diameter; const sgt_surface *terms; size_t count; } sgt_sum;

/* The profile z_p(y) = c y^2 / (1 + sqrt(1 - (1 + k) c^2 y^2)) + sum of a[i] y^(2i + 2), swept about an axis parallel to y
 * through z = 1 / c_x: s = z_p + c_x x^2 / (q + sqrt(q^2 - c_x^2 x^2)), q = 1 - c_x z_p > 0.  c_x = 0: straight in x.
 * Parameters: c, k, c_x, a[0] ... a[7]. */
typedef struct sgt_toroidal { double c, k, c_x, semi_diameter, a[8]; } sgt_toroidal;

/* s = (c_x x^2 + c_y y^2) / (1 + sqrt(1 - (1 + k_x) c_x^2 x^2 - (1 + k_y) c_y^2 y^2)).  A cylinder is the one with c_x = 0.
 * Parameters: c_x, k_x, c_y, k_y. */
typedef struct sgt_biconic { double c_x, k_x, c_y, k_y, semi_diameter; } sgt_biconic;

extern SGT_API const sgt_surface_ops sgt_sum_ops, sgt_toroidal_ops, sgt_biconic_ops;

/* --------------------------------------------------------------- surfaces about the origin */

/* F = squares . (x^2, y^2, z^2) + products . (x y, y z, x z) + linear . (x, y, z) + constant: any quadric, both sheets.
 * SGT_INVALID: a number that is not finite, or squares, products and linear all zero.
 * The seed is the first crossing of the whole line.  Parameters: the ten numbers in that order. */
typedef struct sgt_quadric { double squares[3], products[3], linear[3], constant; } sgt_quadric;

/* The ellipsoid of revolution about z: equatorial radius a > 0, flattening f = (a - b) / a < 1, b the polar radius (f < 0: prolate).
 * F = (x^2 + y^2) / a^2 + z^2 / b^2 - 1, times a / 2: on the equator a distance to first order.  The seed is the first crossing of the whole
 * line.  Parameters: a, f. */
typedef struct sgt_ellipsoid { double a, f; } sgt_ellipsoid;

/* The torus about z: (x^2 + y^2 + z^2 + R^2 - r^2)^2 = 4 R^2 (x^2 + y^2), R = major > 0, r = minor > 0 (minor > major: a spindle,
 * with its inner part).  F = ((rho - R)^2 + z^2 - r^2) / 2 r, rho^2 = x^2 + y^2, near the surface a distance to first order; of a
 * spindle the quartic over 8 r R (R + r).  Parameters: major, minor. */
typedef struct sgt_torus { double major, minor; } sgt_torus;

extern SGT_API const sgt_surface_ops sgt_quadric_ops, sgt_ellipsoid_ops, sgt_torus_ops;

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
    SGT_WHOLE,   /* an int */
    SGT_LIST,    /* sgt_numbers of one row, of up to count numbers */
    SGT_TABLE,   /* sgt_numbers, of up to count rows and count columns */
    SGT_WORD,    /* an int: 1 for the first of the words in `unit`, which are parted by |, 2 for the second, ...; 0: not given */
    SGT_TRUTH,   /* an int: 0 or 1 */
    SGT_TERMS    /* sgt_surface pointer, followed by a size_t: up to count surfaces */
} sgt_kind;
typedef struct sgt_param { const char *name, *unit; size_t offset; int count; double lo, hi; sgt_kind kind; } sgt_param;
typedef struct sgt_objection { const char *param, *reason; } sgt_objection;
typedef struct sgt_builtin {
    const char *type;
    const sgt_surface_ops *ops;
    size_t size;
    const sgt_param *params;
    sgt_objection (*object)(const void *self);
    void (*prepare)(void *self);  /* works out what can be worked out once, of valid parameters; absent: nothing can */
} sgt_builtin;

extern SGT_API const sgt_builtin sgt_builtins[];

#ifdef __cplusplus
}
#endif
#endif /* SAGITTA_SURFACES_H */
