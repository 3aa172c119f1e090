// SPDX-License-Identifier: MIT
/* bench_peers.h - what a careful person would write over arrays: no bounds, no choice of a root, nothing
 * checked.
 *
 * In C, so that they are built as the library is: its flags, its clones, or the one kind that -Dclones
 * names.  A surface is z = s(x, y), a conic and the terms a[0] r^2 ... a[3] r^8 (of a sgt_even_asphere the
 * rest is not read). */
#ifndef BENCH_PEERS_H
#define BENCH_PEERS_H
#include <sagitta/surfaces.h>
#include <sagitta/system.h>
#ifdef __cplusplus
extern "C" {
#endif

enum { PEER_TILE = 256 };

/* The bytes of a batch, to and fro: the 48 of a ray in, and of status, t, t_err, p, n 65 out.  All arrays
 * side by side; and one array after the other, which the C library does past the cache where they are long.
 */
void peer_copy(size_t n, sgt_rays rays, sgt_hits out);
void peer_copy_arrays(size_t n, sgt_rays rays, sgt_hits out);
/* The same of a trace: 48 in, and of fate, o, d 49 out. */
void peer_copy_traced(size_t n, sgt_rays rays, sgt_traced out);

/* status, t, p, n of a conic by the quadratic formula; of any surface by Newton from the conic's root, the
 * number of steps fixed. */
void peer_closed_form(const sgt_even_asphere *s, size_t n, sgt_rays rays, sgt_hits out);
void peer_newton(const sgt_even_asphere *s, size_t n, sgt_rays rays, sgt_hits out);

/* A surface of a user's own, the same formula: value and span; those with `values`; those with `spans` as
 * well. */
extern const sgt_surface_ops peer_own_value, peer_own_values, peer_own_spans;

/* A row of surfaces, their vertices on the z axis, traced as a textbook has it: to the vertex plane, to the
 * surface, refraction by Snell's law in vectors.  Spheres and conics by the quadratic formula, aspheres by
 * Newton from there: ray by ray until a step is below 1e-8, which leaves its square; in tiles, element by
 * element, by steps of a fixed number. */
typedef struct peer_element {
    sgt_even_asphere surface;
    bool asphere;
    double z, index;
} peer_element;
void peer_trace(size_t elements, const peer_element e[], size_t n, sgt_rays rays, sgt_traced out);
void peer_trace_tiles(size_t elements, const peer_element e[], size_t n, sgt_rays rays, sgt_traced out);

#ifdef __cplusplus
}
#endif
#endif
