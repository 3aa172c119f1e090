// SPDX-License-Identifier: MIT
/* own.h - surfaces of this program's own: what the library does not have.
 *
 * Each is a struct of numbers and a table of operations, as the library's are, and has a row
 * of the library's own kind (sgt_builtin), so that the scene reader treats both alike. */
#ifndef RENDER_OWN_H
#define RENDER_OWN_H
#include "vector.h"

#include <sagitta/surfaces.h>

/* The level set |v_N| = escape of the orbit v_1 = p, v_{j+1} = v_j^8 + p of triplex numbers.
 * Zero means default: escape 2, iterations 5; escape is at least 1.2 and at most 100. */
typedef struct mandelbulb { double escape; int iterations; } mandelbulb;
extern const sgt_surface_ops mandelbulb_ops;
enum { BULB_MOST_ITERATIONS = 16 };

/* The edge of a lens: a cylinder about the z axis, from z = from to z = to. */
typedef struct edge { double radius, from, to; } edge;
extern const sgt_surface_ops edge_ops;

/* A box about the origin: half the lengths of its edges, along x, y and z. */
typedef struct box { double half[3]; } box;
extern const sgt_surface_ops box_ops;

/* Menger's sponge in the cube of half edge 1, and Sierpinski's tetrahedron with the corner (1, 1, 1), after
 * so many steps; 0 is the default, 3 and 5. */
typedef struct menger { int iterations; } menger;
typedef struct sierpinski { int iterations; } sierpinski;
extern const sgt_surface_ops menger_ops, sierpinski_ops;
enum { MENGER_MOST = 12, SIERPINSKI_MOST = 20 };

/* The level set |v_N| = 18 of the orbit v_1 = p, v_{n+1} = 2 (folds of v_n) + p; iterations 0: 6. */
typedef struct mandelbox { int iterations; } mandelbox;
extern const sgt_surface_ops mandelbox_ops;
enum { MANDELBOX_MOST = 12 };

/* Ends with a row of zeros. */
extern const sgt_builtin own_surfaces[];

/* The i-th of many. */
static inline vec3 own_at(const double *const a[3], size_t i) { return (vec3){a[0][i], a[1][i], a[2][i]}; }

/* Where a ray is inside a ball about the origin; the ball is drawn larger by a part in
 * 10^9, for what rounding does to the ends.  Without a branch: a loop around it becomes vector code. */
static inline sgt_span own_ball(double radius, vec3 o, vec3 d)
{
    double a = dot(d, d), t = -dot(o, d) / a; /* nearest the centre */
    vec3 p = along(o, t, d);
    double half2 = (radius * radius * (1 + 1e-9) - dot(p, p)) / a, half = sqrt(half2 < 0 ? 0 : half2);
    return (sgt_span){.lo = half2 < 0 ? 1 : t - half, .hi = half2 < 0 ? -1 : t + half, .seed = (double)NAN};
}

#endif
