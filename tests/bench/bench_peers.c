// SPDX-License-Identifier: MIT
/* bench_peers.c - see bench_peers.h. */
#include "bench_peers.h"

#include <math.h>
#include <string.h>

#if defined(HAVE_CLONES)
#define CLONES __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define CLONES
#endif
#define INLINE static inline __attribute__((always_inline))

/* --------------------------------------------------------------------- copies */

/* Side by side it must stay: gcc would take it apart into eight calls of memcpy. */
#if defined(__GNUC__) && !defined(__clang__)
#define ONE_LOOP __attribute__((optimize("no-tree-loop-distribute-patterns")))
#else
#define ONE_LOOP
#endif

CLONES ONE_LOOP void peer_copy(size_t n, sgt_rays rays, sgt_hits out)
{
    const double *a = rays.o[0], *b = rays.o[1], *c = rays.o[2], *d = rays.d[0], *e = rays.d[1],
                 *f = rays.d[2];
    double *t = out.t, *t_err = out.t_err, *px = out.p[0], *py = out.p[1], *pz = out.p[2];
    double *nx = out.n[0], *ny = out.n[1], *nz = out.n[2];
#pragma omp simd
    for (size_t i = 0; i < n; i++) {
        t[i] = a[i], t_err[i] = b[i];
        px[i] = c[i], py[i] = d[i], pz[i] = e[i];
        nx[i] = f[i], ny[i] = a[i], nz[i] = b[i];
    }
    memset(out.status, SGT_HIT, n);
}

void peer_copy_arrays(size_t n, sgt_rays rays, sgt_hits out)
{
    const double *from[8] = {rays.o[0], rays.o[1], rays.o[2], rays.d[0],
                             rays.d[1], rays.d[2], rays.o[0], rays.o[1]};
    double *to[8] = {out.t, out.t_err, out.p[0], out.p[1], out.p[2], out.n[0], out.n[1], out.n[2]};
    for (int k = 0; k < 8; k++) memcpy(to[k], from[k], n * sizeof(double));
    memset(out.status, SGT_HIT, n);
}

CLONES ONE_LOOP void peer_copy_traced(size_t n, sgt_rays rays, sgt_traced out)
{
    const double *a = rays.o[0], *b = rays.o[1], *c = rays.o[2], *d = rays.d[0], *e = rays.d[1],
                 *f = rays.d[2];
    double *x = out.o[0], *y = out.o[1], *z = out.o[2], *l = out.d[0], *m = out.d[1], *k = out.d[2];
#pragma omp simd
    for (size_t i = 0; i < n; i++)
        x[i] = a[i], y[i] = b[i], z[i] = c[i], l[i] = d[i], m[i] = e[i], k[i] = f[i];
    memset(out.fate, SGT_PASSED, n);
}

/* ------------------------------------------------------------------ the formula */

typedef struct value { double f; sgt_vec3 n; } value;

/* F = z - s(x, y) and its gradient. */
INLINE value formula(const sgt_even_asphere *s, bool asphere, double x, double y, double z)
{
    double r2 = x * x + y * y;
    double root = sqrt(1 - (1 + s->k) * s->c * s->c * r2);
    double sag = s->c * r2 / (1 + root), slope = s->c / root;
    if (asphere) {
        const double *a = s->a;
        sag += r2 * (a[0] + r2 * (a[1] + r2 * (a[2] + r2 * a[3])));
        slope += 2 * a[0] + r2 * (4 * a[1] + r2 * (6 * a[2] + r2 * 8 * a[3]));
    }
    return (value){z - sag, {-slope * x, -slope * y, 1}};
}

INLINE sgt_vec3 along(sgt_vec3 o, sgt_vec3 d, double t)
{
    return (sgt_vec3){o.x + t * d.x, o.y + t * d.y, o.z + t * d.z};
}

/* t of the conic from a point on the vertex plane, by the form of the quadratic formula that does not
 * cancel. */
INLINE double conic_root(const sgt_even_asphere *s, sgt_vec3 p, sgt_vec3 d)
{
    double a = s->c * (d.x * d.x + d.y * d.y + (1 + s->k) * d.z * d.z);
    double b = d.z - s->c * (d.x * p.x + d.y * p.y);
    double c = s->c * (p.x * p.x + p.y * p.y);
    return c / (b + copysign(sqrt(b * b - a * c), b));
}

INLINE double newton_step(const sgt_even_asphere *s, sgt_vec3 p, sgt_vec3 d)
{
    value v = formula(s, true, p.x, p.y, p.z);
    return v.f / (v.n.x * d.x + v.n.y * d.y + v.n.z * d.z);
}

/* Steps of a fixed number, unrolled: three from the conic's root settle every ray and surface here. */
INLINE double asphere_root(const sgt_even_asphere *s, sgt_vec3 p, sgt_vec3 d)
{
    double t = conic_root(s, p, d);
    t -= newton_step(s, along(p, d, t), d);
    t -= newton_step(s, along(p, d, t), d);
    t -= newton_step(s, along(p, d, t), d);
    return t;
}

INLINE double asphere_root_at_leisure(const sgt_even_asphere *s, sgt_vec3 p, sgt_vec3 d)
{
    double t = conic_root(s, p, d);
    for (int i = 0; i < 100; i++) {
        double step = newton_step(s, along(p, d, t), d);
        t -= step;
        if (!(fabs(step) > 1e-8)) break;
    }
    return t;
}

/* ------------------------------------------------------------ one surface, batch */

INLINE void meet(const sgt_even_asphere *s, bool asphere, size_t n, const sgt_rays *rays, const sgt_hits *out)
{
    const sgt_even_asphere own = *s;
    const double *ox = rays->o[0], *oy = rays->o[1], *oz = rays->o[2], *dx = rays->d[0], *dy = rays->d[1],
                 *dz = rays->d[2];
    double *t = out->t, *px = out->p[0], *py = out->p[1], *pz = out->p[2], *nx = out->n[0], *ny = out->n[1],
           *nz = out->n[2];
#pragma omp simd
    for (size_t i = 0; i < n; i++) {
        sgt_vec3 d = {dx[i], dy[i], dz[i]}, o = {ox[i], oy[i], oz[i]};
        double t0 = -o.z / d.z;
        sgt_vec3 p = along(o, d, t0);
        double root = t0 + (asphere ? asphere_root(&own, p, d) : conic_root(&own, p, d));
        p = along(o, d, root);
        value v = formula(&own, asphere, p.x, p.y, p.z);
        t[i] = root;
        px[i] = p.x, py[i] = p.y, pz[i] = p.z;
        nx[i] = v.n.x, ny[i] = v.n.y, nz[i] = v.n.z;
    }
    for (size_t i = 0; i < n; i++) out->status[i] = t[i] == t[i] ? SGT_HIT : SGT_MISS;
}

CLONES void peer_closed_form(const sgt_even_asphere *s, size_t n, sgt_rays rays, sgt_hits out)
{
    meet(s, false, n, &rays, &out);
}
CLONES void peer_newton(const sgt_even_asphere *s, size_t n, sgt_rays rays, sgt_hits out)
{
    meet(s, true, n, &rays, &out);
}

/* -------------------------------------------------------- a surface of one's own */

static double own_value(const void *self, sgt_vec3 p, sgt_vec3 *grad)
{
    value v = formula(self, true, p.x, p.y, p.z);
    if (grad) *grad = v.n;
    return v.f;
}

CLONES static void own_values(const void *self, size_t n, sgt_points points, sgt_values out)
{
    const sgt_even_asphere own = *(const sgt_even_asphere *)self;
    const double *x = points.p[0], *y = points.p[1], *z = points.p[2];
    double *f = out.f, *gx = out.grad[0], *gy = out.grad[1], *gz = out.grad[2];
    if (gx) {
#pragma omp simd
        for (size_t i = 0; i < n; i++) {
            value v = formula(&own, true, x[i], y[i], z[i]);
            f[i] = v.f, gx[i] = v.n.x, gy[i] = v.n.y, gz[i] = v.n.z;
        }
    } else {
#pragma omp simd
        for (size_t i = 0; i < n; i++) f[i] = formula(&own, true, x[i], y[i], z[i]).f;
    }
}

/* For r <= 4 the sag is within [0, 0.9] and its slope below 0.5 (of the conic and the asphere of
 * bench_shared.h).  So the surface lies in that slab, and where a ray is within r = 4 all through it and
 * climbs faster than the slope, F grows along it. */
typedef struct bounds { double lo, hi, seed, single; } bounds;

INLINE bounds own_bounds(sgt_vec3 o, sgt_vec3 d)
{
    double a = -o.z / d.z, b = (0.9 - o.z) / d.z;
    double ax = o.x + a * d.x, ay = o.y + a * d.y, bx = o.x + b * d.x, by = o.y + b * d.y;
    bool within = (ax * ax + ay * ay < 16) & (bx * bx + by * by < 16) &
                  (0.25 * (d.x * d.x + d.y * d.y) < d.z * d.z);
    return (bounds){(a < b ? a : b) - 0x1p-40, (a < b ? b : a) + 0x1p-40, a, within ? 1.0 : 0.0};
}

static sgt_span own_span(const void *self, const sgt_ray *ray)
{
    (void)self;
    bounds b = own_bounds(ray->o, ray->d);
    return (sgt_span){.lo = b.lo, .hi = b.hi, .seed = b.seed, .single = b.single != 0};
}

/* `single` is made narrow in a loop of its own: bytes among doubles keep a loop from becoming vector code. */
CLONES static void own_spans(const void *self, size_t n, sgt_rays rays, sgt_spans out)
{
    (void)self;
    double single[PEER_TILE];
    for (size_t at = 0; at < n; at += PEER_TILE) {
        size_t here = n - at < PEER_TILE ? n - at : PEER_TILE;
        const double *ox = rays.o[0] + at, *oy = rays.o[1] + at, *oz = rays.o[2] + at;
        const double *dx = rays.d[0] + at, *dy = rays.d[1] + at, *dz = rays.d[2] + at;
        double *lo = out.lo + at, *hi = out.hi + at, *seed = out.seed + at;
#pragma omp simd
        for (size_t i = 0; i < here; i++) {
            bounds b = own_bounds((sgt_vec3){ox[i], oy[i], oz[i]}, (sgt_vec3){dx[i], dy[i], dz[i]});
            lo[i] = b.lo, hi[i] = b.hi, seed[i] = b.seed, single[i] = b.single;
        }
        for (size_t i = 0; i < here; i++) out.single[at + i] = single[i] != 0;
    }
}

const sgt_surface_ops peer_own_value = {.name = "own", .value = own_value, .span = own_span};
const sgt_surface_ops peer_own_values = {
    .name = "own", .value = own_value, .span = own_span, .values = own_values};
const sgt_surface_ops peer_own_spans = {
    .name = "own", .value = own_value, .span = own_span, .values = own_values, .spans = own_spans};

/* -------------------------------------------------------------------- sequences */

/* d' = r d + (c' - r c) N, c' = sqrt(1 - r^2 (1 - c^2)), c = d . N. */
INLINE sgt_vec3 refracted(sgt_vec3 d, sgt_vec3 n, double ratio)
{
    double length = sqrt(n.x * n.x + n.y * n.y + n.z * n.z);
    n.x /= length, n.y /= length, n.z /= length;
    double c = d.x * n.x + d.y * n.y + d.z * n.z;
    double along_normal = sqrt(1 - ratio * ratio * (1 - c * c)) - ratio * c;
    return (sgt_vec3){ratio * d.x + along_normal * n.x, ratio * d.y + along_normal * n.y,
                      ratio * d.z + along_normal * n.z};
}

/* One element: the ray comes and goes in the frame of e's vertex, which is z_before behind that of the one
 * before. */
INLINE void pass(const peer_element *e, bool asphere, bool at_leisure, double z_before, double ratio,
                 sgt_vec3 *o, sgt_vec3 *d)
{
    o->z -= z_before;
    sgt_vec3 p = along(*o, *d, -o->z / d->z);
    p.z = 0;
    double t = !asphere   ? conic_root(&e->surface, p, *d)
             : at_leisure ? asphere_root_at_leisure(&e->surface, p, *d)
                          : asphere_root(&e->surface, p, *d);
    *o = along(p, *d, t);
    *d = refracted(*d, formula(&e->surface, asphere, o->x, o->y, o->z).n, ratio);
}

CLONES void peer_trace(size_t elements, const peer_element e[], size_t n, sgt_rays rays, sgt_traced out)
{
    for (size_t i = 0; i < n; i++) {
        sgt_vec3 o = {rays.o[0][i], rays.o[1][i], rays.o[2][i]},
                 d = {rays.d[0][i], rays.d[1][i], rays.d[2][i]};
        double index = 1, z = 0;
        for (size_t k = 0; k < elements; k++) {
            pass(&e[k], e[k].asphere, true, e[k].z - z, index / e[k].index, &o, &d);
            index = e[k].index, z = e[k].z;
        }
        out.o[0][i] = o.x, out.o[1][i] = o.y, out.o[2][i] = o.z + z;
        out.d[0][i] = d.x, out.d[1][i] = d.y, out.d[2][i] = d.z;
        out.fate[i] = SGT_PASSED;
    }
}

INLINE void pass_tile(const peer_element *e, bool asphere, double z_before, double ratio, size_t n,
                      double *const o[3], double *const d[3])
{
    const peer_element own = *e;
    double *x = o[0], *y = o[1], *z = o[2], *l = d[0], *m = d[1], *k = d[2];
#pragma omp simd
    for (size_t i = 0; i < n; i++) {
        sgt_vec3 p = {x[i], y[i], z[i]}, q = {l[i], m[i], k[i]};
        pass(&own, asphere, false, z_before, ratio, &p, &q);
        x[i] = p.x, y[i] = p.y, z[i] = p.z, l[i] = q.x, m[i] = q.y, k[i] = q.z;
    }
}

CLONES void peer_trace_tiles(size_t elements, const peer_element e[], size_t n, sgt_rays rays, sgt_traced out)
{
    for (size_t i = 0; i < n; i += PEER_TILE) {
        size_t here = n - i < PEER_TILE ? n - i : PEER_TILE;
        double *o[3] = {out.o[0] + i, out.o[1] + i, out.o[2] + i},
               *d[3] = {out.d[0] + i, out.d[1] + i, out.d[2] + i};
        for (int j = 0; j < 3; j++)
            memcpy(o[j], rays.o[j] + i, here * sizeof(double)),
                memcpy(d[j], rays.d[j] + i, here * sizeof(double));
        double index = 1, z = 0;
        for (size_t k = 0; k < elements; k++) {
            if (e[k].asphere)
                pass_tile(&e[k], true, e[k].z - z, index / e[k].index, here, o, d);
            else
                pass_tile(&e[k], false, e[k].z - z, index / e[k].index, here, o, d);
            index = e[k].index, z = e[k].z;
        }
        for (size_t j = 0; j < here; j++) o[2][j] += z;
        memset(out.fate + i, SGT_PASSED, here);
    }
}
