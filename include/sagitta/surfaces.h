// SPDX-License-Identifier: MIT
/* surfaces.h - the built-in surfaces: the sags of optics, quadrics and tori, and level
 * sets of quaternion orbits.
 *
 * Each is a plain struct of numbers and one table of operations.  A struct owns nothing:
 * there is nothing to free, and a copy is an assignment.  What it points to belongs to
 * the caller and must stay in place during a call.  All of it may be shared between
 * threads.
 *
 * UNITS.  Lengths have any one unit, the same in the surface and the ray.
 *
 * SAGS.  A sag is F = z - s(x, y) in its own frame, with the vertex at the origin.  F is
 * NaN where s is not defined.  r^2 = x^2 + y^2.  A struct of zeros is a plane,
 * unless zeros are not valid for it (a normalisation, an order, the heights of a grid).
 *
 * THE RIM.  semi_diameter is the radius of the rim: a root with r > semi_diameter is not
 * accepted.  F itself knows nothing of the rim.  For all sags of this header:
 *   - 0: no rim, all r.  2^500 (3e150) and more: the same.
 *   - The rim is soft by a part in 2^44: r^2 <= semi_diameter^2 (1 + 2^-44) is within.
 *     So a marginal ray at 0.5000000000000004 is inside 0.5.
 *   - Below 2^-480 (3e-145): every answer is SGT_UNPROVEN.
 *   - Negative or NaN: SGT_INVALID.
 *
 * SGT_INVALID is the answer if a parameter is NaN, infinite, or outside the range beside
 * it.
 *
 * PARAMETERS.  For derivatives (sensitivity.h) each surface says which numbers are its
 * parameters, and in what order.  semi_diameter and normalisations are never among them.
 *
 * The examples are compiled and run by tests/build/header_examples.py.  `s` is what
 * sgt_intersect takes. */
#ifndef SAGITTA_SURFACES_H
#define SAGITTA_SURFACES_H
#include <sagitta/sagitta.h>
#ifdef __cplusplus
extern "C" {
#endif

/* ------------------------------------------------------- conics and even aspheres */

/* s = c r^2 / (1 + sqrt(1 - (1 + k) c^2 r^2)): plane, sphere and all conics of
 * revolution.  Where |c| r is beyond 1e150, or coordinates are beyond 1e150 radii apart,
 * an answer may be SGT_UNPROVEN.  Parameters: c, k.  Source: ISO 10110-12.  Example:
 *
 *     sgt_conic mirror = {.c = -1 / 200.0, .k = -1, .semi_diameter = 25};
 *     sgt_surface s = {&sgt_conic_ops, &mirror};
 */
typedef struct sgt_conic {
    double c;              /* curvature 1/R, 1/length; finite.  0: a plane.  Above 0: the
                              centre is at +z */
    double k;              /* conic constant; finite.  0: a sphere.  -1: a paraboloid.
                              Below -1: one sheet of a hyperboloid.  Above 0: an oblate
                              ellipsoid */
    double semi_diameter;  /* of the rim, length; 0: none */
} sgt_conic;

/* The conic plus the sum of a[i] r^(2i + 2), i = 0 ... 7: from r^2 to r^16.  If every
 * a[i] is zero, it is solved as the conic it is.  Parameters: c, k, a[0] ... a[7].
 * Example:
 *
 *     sgt_even_asphere lens = {.c = 1 / 50.0, .k = -0.5, .a = {0, 1e-6, -2e-9}};
 *     sgt_surface s = {&sgt_even_asphere_ops, &lens};
 */
typedef struct sgt_even_asphere {
    double c, k;           /* of the conic: see sgt_conic */
    double semi_diameter;  /* of the rim, length; 0: none */
    double a[8];           /* coefficients, 1/length^(2i + 1); finite */
} sgt_even_asphere;

extern SGT_API const sgt_surface_ops sgt_conic_ops, sgt_even_asphere_ops;

/* ------------------------------- sags that are not of revolution, or not even
 *
 * From here on surfaces are met by their operations, as a user's are.
 *
 * BOUNDS.  The bounds on F are rigorous.  What rounding of the point does to F is taken
 * to first order; under a proof nothing is.
 *
 * SPEED.  A batch is fast if semi_diameter is given and the gradient within it is not so
 * steep that a ray could meet the surface twice.  So is a single ray.  Without
 * semi_diameter, a miss is often SGT_UNPROVEN if tmax is infinite, and so is a first root
 * if tmin is.
 *
 * A DEPARTURE P(x, y) on a conic base is
 *     s = c r^2 / (1 + sqrt(1 - (1 + k) c^2 r^2)) + P(x, y),
 * with c, k and semi_diameter as in sgt_conic.  SGT_INVALID: a number that is not finite,
 * a negative semi_diameter, a normalisation that is not above 0, a list longer than said.
 * Parameters: c, k and the coefficients in their order, unless something else is said. */

/* Numbers that the caller keeps, row by row: x[i * columns + j].  A list is one row. */
typedef struct sgt_numbers {
    const double *x;
    size_t        rows, columns;
} sgt_numbers;

/* P = sum of a[i] r^(i + 1), i = 0 ... 15: from r to r^16.  With a[0] the vertex is the
 * tip of a cone; the gradient there is given as that of the rest.
 * Source: the odd asphere of lens programs.  Example:
 *
 *     sgt_odd_asphere lens = {.c = 1 / 50.0, .a = {0, 0, 1e-5}};
 *     sgt_surface s = {&sgt_odd_asphere_ops, &lens};
 */
typedef struct sgt_odd_asphere {
    double c, k;           /* of the conic: see sgt_conic */
    double semi_diameter;  /* of the rim, length; 0: none */
    double a[16];          /* coefficients, 1/length^i; finite */
} sgt_odd_asphere;

/* P = sum of a[i][j] x^i y^j.  Example, P = 0.01 x + 0.002 x y:
 *
 *     const double xy[2][2] = {{0, 0}, {0.01, 0.002}};
 *     sgt_polynomial_xy plate = {.semi_diameter = 10, .a = {&xy[0][0], 2, 2}};
 *     sgt_surface s = {&sgt_polynomial_xy_ops, &plate};
 */
typedef struct sgt_polynomial_xy {
    double      c, k;           /* of the conic: see sgt_conic */
    double      semi_diameter;  /* of the rim, length; 0: none */
    sgt_numbers a;              /* a[i][j], 1/length^(i + j - 1); at most 32 rows and 32
                                   columns */
} sgt_polynomial_xy;

/* P = sum of a[i][j] T_i(x / norm_x) T_j(y / norm_y), T_n(cos u) = cos n u.  Beyond
 * norm_x and norm_y the same polynomials.  Source: Mason and Handscomb 2002, section 1.2.
 * Example, P = 0.01 T_2(x / 10):
 *
 *     const double t[3] = {0, 0, 0.01};
 *     sgt_chebyshev plate = {.norm_x = 10, .norm_y = 10, .a = {t, 3, 1}};
 *     sgt_surface s = {&sgt_chebyshev_ops, &plate};
 */
typedef struct sgt_chebyshev {
    double      c, k;            /* of the conic: see sgt_conic */
    double      semi_diameter;   /* of the rim, length; 0: none */
    double      norm_x, norm_y;  /* normalisations, length; above 0 */
    sgt_numbers a;               /* a[i][j], length; at most 64 rows and 64 columns */
} sgt_chebyshev;

/* The order of Zernike's polynomials.
 * SGT_NOLL: Noll 1976, J. Opt. Soc. Am. 66, 207.  Even j are cosines.
 * SGT_FRINGE: Wyant and Creath 1992, Applied Optics and Optical Engineering XI, 1, table
 * III.  1 piston, 2 x, 3 y, 4 defocus, ...: groups of equal n + m, in each group m falls,
 * cosine before sine.  What some programs call 37 (n = 12, m = 0) is 49 in that order. */
typedef enum sgt_zernike_order { SGT_NOLL = 1, SGT_FRINGE = 2 } sgt_zernike_order;

/* P = sum of a[j - 1] Z_j(r / norm, theta), with x = r cos theta.  Beyond norm the same
 * polynomials.  Example, 0.001 of defocus:
 *
 *     const double z[4] = {0, 0, 0, 0.001};
 *     sgt_zernike plate = {.norm = 10, .order = SGT_FRINGE, .a = {z, 1, 4}};
 *     sgt_surface s = {&sgt_zernike_ops, &plate};
 */
typedef struct sgt_zernike {
    double      c, k;           /* of the conic: see sgt_conic */
    double      semi_diameter;  /* of the rim, length; 0: none */
    double      norm;           /* the radius of the unit circle, length; above 0 */
    int         order;          /* SGT_NOLL or SGT_FRINGE */
    int         normalised;     /* 0: each radial polynomial is 1 at norm.  1: times
                                   sqrt(n + 1), or sqrt(2 n + 2) if m is not 0; then the
                                   mean square over the circle is 1 */
    sgt_numbers a;              /* a list, length; at most 5151 terms (Noll's to radial
                                   order 100) */
} sgt_zernike;

/* P = u^4 sum of a[m] Qcon_m(u^2), u = r / norm, Qcon_m(x) = P_m^(0,4)(2 x - 1) of
 * Jacobi.  Source: Forbes 2007 (Opt. Express 15, 5218), section 2; ISO 10110-12:2019.
 * Example:
 *
 *     const double q[2] = {0.01, -0.002};
 *     sgt_q_con lens = {.c = 1 / 50.0, .k = -1, .norm = 10, .a = {q, 1, 2}};
 *     sgt_surface s = {&sgt_q_con_ops, &lens};
 */
typedef struct sgt_q_con {
    double      c, k;           /* of the conic: see sgt_conic */
    double      semi_diameter;  /* of the rim, length; 0: none */
    double      norm;           /* normalisation, length; above 0 */
    sgt_numbers a;              /* a list, length; at most 64 terms */
} sgt_q_con;

/* P = u^2 (1 - u^2) / sqrt(1 - c^2 r^2) sum of a[m] Qbfs_m(u^2), u = r / norm, on a
 * sphere: k = 0, which is not a parameter.  Source: Forbes 2007, section 3; recurrences:
 * Forbes 2010 (Opt. Express 18, 19700).  Example:
 *
 *     const double q[2] = {0.01, -0.002};
 *     sgt_q_bfs lens = {.c = 1 / 50.0, .norm = 10, .a = {q, 1, 2}};
 *     sgt_surface s = {&sgt_q_bfs_ops, &lens};
 */
typedef struct sgt_q_bfs {
    double      c;              /* curvature of the sphere, 1/length; finite */
    double      semi_diameter;  /* of the rim, length; 0: none */
    double      norm;           /* normalisation, length; above 0 */
    sgt_numbers a;              /* a list, length; at most 64 terms */
} sgt_q_bfs;

/* P from measured heights z[i][j] at
 *     x = (j - (columns - 1) / 2) step_x,   y = (i - (rows - 1) / 2) step_y,
 * by bicubic convolution (Keys 1981, IEEE Trans. ASSP 29, 1153, a = -1/2).  P passes
 * through every height and has a continuous gradient.  Beyond the edge the heights are
 * continued by Keys' boundary condition.  Outside the grid P is not defined.  Parameters:
 * c and k only.  Example:
 *
 *     const double heights[4][4] = {{0, 0, 0, 0}, {0, .01, .01}, {0, .01, .01}, {0}};
 *     sgt_grid plate = {.step_x = 1, .step_y = 1, .z = {&heights[0][0], 4, 4}};
 *     sgt_grid_measure(&plate);
 *     sgt_surface s = {&sgt_grid_ops, &plate};
 */
typedef struct sgt_grid {
    double      c, k;            /* of the conic: see sgt_conic */
    double      semi_diameter;   /* of the rim, length; 0: none */
    double      step_x, step_y;  /* between the heights, length; above 0 */
    sgt_numbers z;               /* the heights, length; 4 ... 4096 rows and columns */
    double height, steep, bend;  /* written by sgt_grid_measure; 0: not measured */
} sgt_grid;

/* Passes over the heights once and writes bounds on |P| (height), |grad P| (steep) and
 * the second derivative of P (bend).  Call it again after a change of z or of the steps.
 * Without it every ray passes over the heights that it may need, which is right, and
 * slow. */
SGT_API void sgt_grid_measure(sgt_grid *grid);

extern SGT_API const sgt_surface_ops sgt_odd_asphere_ops, sgt_polynomial_xy_ops,
    sgt_chebyshev_ops, sgt_zernike_ops, sgt_q_con_ops, sgt_q_bfs_ops, sgt_grid_ops;

/* The sum of the departures of `terms` on one conic base.  A term is one of these:
 *   - an even asphere, or one of the surfaces above with a departure.  Its own base and
 *     rim are not read, except the c of a q_bfs, which its root needs;
 *   - a toroid or a biconic (below), with all of its sag.
 * Another sum is not a term.  Parameters: c, k, and those of each term in order (a term
 * of the first kind: without its c and k).  Example:
 *
 *     const double z[4] = {0, 0, 0, 0.001};
 *     const sgt_even_asphere asphere = {.a = {0, 1e-6}};
 *     const sgt_zernike figure = {.norm = 10, .order = SGT_NOLL, .a = {z, 1, 4}};
 *     const sgt_surface terms[] = {{&sgt_even_asphere_ops, &asphere},
 *                                  {&sgt_zernike_ops, &figure}};
 *     sgt_sum lens = {.c = 1 / 50.0, .semi_diameter = 8, .terms = terms, .count = 2};
 *     sgt_surface s = {&sgt_sum_ops, &lens};
 */
typedef struct sgt_sum {
    double             c, k;           /* of the conic: see sgt_conic */
    double             semi_diameter;  /* of the rim, length; 0: none */
    const sgt_surface *terms;          /* kept by the caller */
    size_t             count;          /* of terms; 0 ... 16 */
} sgt_sum;

/* A profile swept about an axis parallel to y through z = 1 / c_x.  The profile is
 *     z_p(y) = c y^2 / (1 + sqrt(1 - (1 + k) c^2 y^2)) + sum of a[i] y^(2i + 2),
 * and the sag, with q = 1 - c_x z_p > 0,
 *     s = z_p + c_x x^2 / (q + sqrt(q^2 - c_x^2 x^2)).
 * Parameters: c, k, c_x, a[0] ... a[7].  Example:
 *
 *     sgt_toroidal mirror = {.c = 1 / 100.0, .c_x = 1 / 40.0, .semi_diameter = 10};
 *     sgt_surface s = {&sgt_toroidal_ops, &mirror};
 */
typedef struct sgt_toroidal {
    double c, k;           /* of the profile, as of a conic in y */
    double c_x;            /* curvature of the sweep, 1/length; finite.  0: straight */
    double semi_diameter;  /* of the rim, length; 0: none */
    double a[8];           /* of the profile, 1/length^(2i + 1); finite */
} sgt_toroidal;

/* s = (c_x x^2 + c_y y^2) / (1 + sqrt(1 - (1 + k_x) c_x^2 x^2 - (1 + k_y) c_y^2 y^2)).
 * With c_x = 0 it is a cylinder.  Parameters: c_x, k_x, c_y, k_y.  Example:
 *
 *     sgt_biconic lens = {.c_x = 1 / 50.0, .c_y = 1 / 60.0, .k_y = -1};
 *     sgt_surface s = {&sgt_biconic_ops, &lens};
 */
typedef struct sgt_biconic {
    double c_x, k_x;       /* curvature (1/length) and conic constant in x; finite */
    double c_y, k_y;       /* the same in y */
    double semi_diameter;  /* of the rim, length; 0: none */
} sgt_biconic;

extern SGT_API const sgt_surface_ops sgt_sum_ops, sgt_toroidal_ops, sgt_biconic_ops;

/* ------------------------------------------------------ surfaces about the origin */

/* Any quadric, both sheets:
 *     F = squares . (x^2, y^2, z^2) + products . (x y, y z, x z) + linear . (x, y, z)
 *         + constant.
 * SGT_INVALID: a number that is not finite; squares, products and linear all zero.  The
 * seed is the first crossing of the whole line.  Parameters: the ten numbers in that
 * order.  Example, a cone about z:
 *
 *     sgt_quadric cone = {.squares = {1, 1, -0.25}};
 *     sgt_surface s = {&sgt_quadric_ops, &cone};
 */
typedef struct sgt_quadric {
    double squares[3];   /* of x^2, y^2, z^2 */
    double products[3];  /* of x y, y z, x z */
    double linear[3];    /* of x, y, z; in units of squares times length */
    double constant;     /* in units of squares times length^2 */
} sgt_quadric;

/* The ellipsoid of revolution about z, with the polar radius b = a (1 - f):
 *     F = ((x^2 + y^2) / a^2 + z^2 / b^2 - 1) a / 2.
 * On the equator F is a distance to first order.  The seed is the first crossing of the
 * whole line.  Parameters: a, f.  Example:
 *
 *     sgt_ellipsoid ball = {.a = 2, .f = 0.1};
 *     sgt_surface s = {&sgt_ellipsoid_ops, &ball};
 */
typedef struct sgt_ellipsoid {
    double a;  /* equatorial radius, length; above 0 */
    double f;  /* flattening (a - b) / a, finite; below 1.  Below 0: prolate */
} sgt_ellipsoid;

/* The torus about z, with R = major and r = minor:
 *     (x^2 + y^2 + z^2 + R^2 - r^2)^2 = 4 R^2 (x^2 + y^2).
 * With rho^2 = x^2 + y^2, F = ((rho - R)^2 + z^2 - r^2) / 2 r: near the surface a
 * distance to first order.  If minor > major it is a spindle, with its inner part; F is
 * then the quartic over 8 r R (R + r).  Where R + r is above 2^330 (1e99), of a spindle
 * 2^240, or below the inverse, its powers leave the range of doubles, and rays are mostly
 * undecided.  Parameters: major, minor.  Example:
 *
 *     sgt_torus ring = {.major = 1, .minor = 0.4};
 *     sgt_surface s = {&sgt_torus_ops, &ring};
 */
typedef struct sgt_torus {
    double major;  /* radius of the circle in the middle of the tube, length; above 0 */
    double minor;  /* radius of the tube, length; above 0 */
} sgt_torus;

extern SGT_API const sgt_surface_ops sgt_quadric_ops, sgt_ellipsoid_ops, sgt_torus_ops;

/* -------------------------------------------------------------------- level sets */

/* The level set |Q_N| = escape of the orbit Q_{j+1} = Q_j^p + c of quaternions that
 * starts at Q_0 = at + x ex + y ey + z ez.  That is any three-dimensional slice, at any
 * angle and scale, of the four-dimensional Julia set.
 *
 * F = (u - 1) / (u + 1) with u = |Q_N|^2 / escape^2: -1 ... 0 inside, 0 ... 1 outside.
 * It cannot overflow.  There are no parameters for derivatives.
 *
 * SGT_INVALID: a number outside of the ranges below; axes that are not independent; an N
 * with which a large c takes the derivative out of the range of a double: G = p R^(p-1)
 * is above 16, and G^N above 2^480, R being the safe escape (of a mandelbrot the escape).
 *
 * HOW MANY LEVELS.  Where an orbit is expanded at each level, as nearly everywhere on a
 * Julia set, the surface of 60 to 100 levels is as near the set as a double resolves.
 * Where it is not, more are seen: past c = 1/4 + x it takes pi / sqrt(x) levels, past
 * -3/4 + i x it takes pi / x.  The limit shows x of 1e-7 and 3e-4.  The cost is in
 * proportion to N.  Finer than doubles resolve, hits are where F changes its sign, and n
 * need not point to a side; under proof such rays are SGT_UNPROVEN.  Where N is above 100
 * and the derivative leaves the range of a double, the gradient is NaN and a ray
 * undecided.
 *
 * Sources: Norton 1982 (SIGGRAPH Computer Graphics 16, 197); Hart, Sandin, Kauffman 1989
 * (23, 289).  Example:
 *
 *     sgt_julia set = {.c = {-0.2, 0.8, 0, 0}, .iterations = 8};
 *     sgt_surface s = {&sgt_julia_ops, &set};
 */
typedef struct sgt_julia {
    double c[4];                 /* finite, each at most 1e6 in magnitude */
    double at[4];                /* the slice's point at the origin; the same range */
    double ex[4], ey[4], ez[4];  /* its axes, 1/length; each 1e-100 ... 1e100 long.  All
                                    zero: the first three components */
    double escape;               /* from the safe one (less a part in 2^40) to 1e6.  0:
                                    the safe one, the root of x^p = x + |c| */
    int    iterations;           /* N, 1 ... 10000; 0: 10 */
    int    power;                /* p, 2 ... 8; 0: 2 */
} sgt_julia;

/* The same orbit from Q_0 = 0 with c = at + x ex + y ey + z ez: Q_1 is the point itself.
 * The safe escape is 2^(1/(p-1)).  All else is as for sgt_julia.  Example:
 *
 *     sgt_mandelbrot set = {.iterations = 8};
 *     sgt_surface s = {&sgt_mandelbrot_ops, &set};
 */
typedef struct sgt_mandelbrot {
    double at[4];
    double ex[4], ey[4], ez[4];
    double escape;
    int    iterations, power;
} sgt_mandelbrot;

extern SGT_API const sgt_surface_ops sgt_julia_ops, sgt_mandelbrot_ops;

/* The potential log|Q_n| / p^n at p, of the orbit continued until |Q_n| > 2^32, or to the
 * larger of n = 200 and N.  That is beyond the level set.  If grad is not NULL, *grad is
 * set to the gradient (1/length).
 *
 * F = tanh(log(|Q_N| / escape)).  So the normal of a hit is already along the gradient of
 * the potential at level N, which is smooth there.  The gradient given here is nearer to
 * the normal of the set itself, and has its finer folds.
 *
 * 0 and a zero gradient: the orbit does not escape, or p^n is above 2^900.  NaN: the
 * parameters are invalid.  It is right to rounding where |Q_0| < 1e150; farther out to a
 * part in 100, and the gradient is 0.  Source: Douady and Hubbard 1982 (C. R. Acad. Sci.
 * 294, 123).  Example:
 *
 *     sgt_julia set = {.c = {-0.2, 0.8, 0, 0}};
 *     sgt_vec3 p = {0, 0, 2}, n;
 *     double potential = sgt_julia_potential(&set, p, &n);
 */
SGT_API double sgt_julia_potential(const sgt_julia *s, sgt_vec3 p, sgt_vec3 *grad);
SGT_API double sgt_mandelbrot_potential(const sgt_mandelbrot *s, sgt_vec3 p,
                                        sgt_vec3 *grad);

/* ---------------------------------------------------------- the same list as data */

/* How a parameter is stored at its offset. */
typedef enum sgt_param_kind {
    SGT_PARAM_REAL,   /* a double.  count > 1: a list of up to count doubles, the rest
                         zero */
    SGT_PARAM_VECTOR, /* exactly count doubles */
    SGT_PARAM_WHOLE,  /* an int */
    SGT_PARAM_LIST,   /* an sgt_numbers of one row, of up to count numbers */
    SGT_PARAM_TABLE,  /* an sgt_numbers of up to count rows and count columns */
    SGT_PARAM_WORD,   /* an int: 1 for the first of `words`, 2 for the second, ...; 0: not
                         given */
    SGT_PARAM_TRUTH,  /* an int: 0 or 1 */
    SGT_PARAM_TERMS   /* an sgt_surface pointer, followed by a size_t: up to count
                         surfaces */
} sgt_param_kind;

/* A unit by its exponents: that of length is length + i by_i + j by_j.  i is the index in
 * a list; in a table i is the row and j the column; else both are 0. */
typedef struct sgt_param_unit {
    int length, by_i, by_j;
    int time;  /* exponent of time; 0 except of a potential (geo.h) */
} sgt_param_unit;

/* A parameter of a type.  Two parameters may be two names for one number ("slice" is
 * at[3]): then only one of them can be given. */
typedef struct sgt_param {
    const char *name;    /* as in a lens file */
    sgt_param_unit    unit;
    size_t      offset;  /* in the struct, bytes */
    int         count;   /* see sgt_param_kind */
    double      lo, hi;  /* the legal values: lo <= x <= hi, all finite */
    sgt_param_kind    kind;
    const char *words;   /* of an SGT_PARAM_WORD, separated by |; else NULL */
    unsigned long long reserved_[2];
} sgt_param;

/* The first parameter that makes a struct SGT_INVALID, and why.  {NULL, NULL}: none. */
typedef struct sgt_objection {
    const char *param, *reason;
} sgt_objection;

/* What a type is. */
typedef enum sgt_family {
    SGT_FAMILY_OTHER,      /* a user's, or one of another library */
    SGT_FAMILY_CONIC,      /* a sag that is met in closed form */
    SGT_FAMILY_ASPHERE,    /* a sag that is met by a polynomial with the roots of F */
    SGT_FAMILY_DEPARTURE,  /* a sag that is met by its operations */
    SGT_FAMILY_BODY,       /* about the origin; met by its operations */
    SGT_FAMILY_LEVEL_SET   /* of an orbit; `estimate` is a bound on it */
} sgt_family;

/* A type, as a lens file names it.  "plane", "sphere" and "conic" share one struct and
 * one table of operations; they differ in the parameters that may be given. */
typedef struct sgt_builtin {
    const char            *type;
    const sgt_surface_ops *ops;
    size_t                 size;    /* of the struct, bytes */
    const sgt_param       *params;  /* ends with a row of zeros */
    sgt_objection (*object)(const void *self);  /* what is wrong beyond the ranges of
                                                   params; NULL: the ranges suffice */
    void (*prepare)(void *self);  /* computes, from valid parameters, the members that
                                     need to be computed only once; NULL: none do */
    sgt_family  family;
    const void *specimen;  /* a usual surface of the type, of a few units of length, to
                              test and to try.  NULL: there is none */
    unsigned long long reserved_[4];
} sgt_builtin;

/* All types, for a parser, a benchmark, or a test of them all.  Ends with a row of zeros.
 * Example:
 *
 *     int count = 0;
 *     for (const sgt_builtin *b = sgt_builtins(); b->type; b++) count++;
 *
 * Constant, never NULL, and the same address at each call.  (A function: a program copies
 * exported data as long as they were when it was linked, and this list grows.) */
SGT_API const sgt_builtin *sgt_builtins(void);

/* The first row with the operations of s; of another surface the row of zeros. */
SGT_API const sgt_builtin *sgt_builtin_of(sgt_surface s);

/* Where the number that a lens file calls `key`, such as "semi_diameter", stands in
 * s.self.  All rows with the operations of s are searched.  NULL: s has no such number,
 * or is not of a built-in type. */
SGT_API const double *sgt_number_of(sgt_surface s, const char *key);

/* Is s a sag, F = z - s(x, y)?  If not (a body, a level set), it has no vertex and no
 * profile.  The test: dF/dz is exactly 1 at (0, 0, 0) and at (0, 0, 1).  So a multiple of
 * a sag is not one, and another surface that passes the test is taken for a sag. */
SGT_API bool sgt_is_sag(sgt_surface s);

#ifdef __cplusplus
}
#endif
#endif /* SAGITTA_SURFACES_H */
