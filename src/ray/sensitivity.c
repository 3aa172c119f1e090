// SPDX-License-Identifier: MIT
/* sensitivity.c - derivatives of a hit, by the implicit function theorem (sensitivity.h).
 *
 * Rays are taken BLOCK at a time.  Each number of theirs is a row, and each step is a loop over a row.
 * Let q = do + t dd be the shift of the point, F_j the derivative of F by the parameter a_j, H the second
 * derivatives of F.  With
 *
 *     s = n . d,    w = dt/dq = -n / s,    dt/da_j = -F_j / s,
 *
 * the changes are
 *
 *     dp = q + d dt,                         dn = H dp + grad F_j da_j:
 *     dp_i/dq_j = (i = j) + d_i w_j,         dn_i/dq_j = H_ij + (H d)_i w_j,
 *                                            dn_i/da_j = (H d)_i dt/da_j + grad F_j.
 *
 * All have the factor 1 / s, which is set to NaN where a ray was not met.  The point of such a ray is
 * never given to the surface: a neighbour's takes its place.
 *
 * ROUNDING, with u = 2^-53.  1/s rounds once, and each product once or twice.  So w is within 2 1/2 u of
 * -n / s, beside the error of the sum of products s: 3 u (|nx dx| + |ny dy| + |nz dz|) / |s|. */
#include "../surface/builtin.h"
#include "../num/lanes.h"
#include "../num/room.h"

#include <sagitta/sensitivity.h>

#include <stdbool.h>
#include <string.h>

enum { BLOCK = 128 };
typedef double row[BLOCK];

typedef struct sensitivity_block {
    _Alignas(64) row inverse;            /* -1 / s */
    row met, place[3], shifts[3], h[6], hd[3], t, f, g[3];
    double *w[3];                        /* `shifts`, or the caller's */
    sgt_surface s;
    size_t n, count;                     /* rays, and how many of them were met */
    const double *d[3], *normal[3];
    sgt_points p;                        /* the hits' points, or `place` */
} sensitivity_block;

/* The place of each entry of H in xx, xy, xz, yy, yz, zz. */
static const int ENTRY[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};

/* ------------------------------------------------------------------------- rows */

/* 1 where the status is positive, else 0.  Two loops, by way of int: bytes and doubles in one loop make
 * long code. */
SGT_KERNEL
static void positive(size_t n, const sgt_status *status, double *out)
{
    int wide[BLOCK];
    LANES for (size_t i = 0; i < n; i++) wide[i] = status[i] > 0;
    LANES for (size_t i = 0; i < n; i++) out[i] = wide[i];
}

/* Sets -1 / s and w.  met: 1 or 0.  Returns how many were met. */
SGT_KERNEL
static double invert(sensitivity_block *b)
{
    const double *dx = b->d[0], *dy = b->d[1], *dz = b->d[2], *nx = b->normal[0], *ny = b->normal[1],
                 *nz = b->normal[2];
    double *met = b->met, *inverse = b->inverse, *wx = b->w[0], *wy = b->w[1], *wz = b->w[2], count = 0;
#pragma omp simd reduction(+ : count)
    for (size_t i = 0; i < b->n; i++) {
        double s = nx[i] * dx[i] + ny[i] * dy[i] + nz[i] * dz[i];
        double is = nx[i] == nx[i] ? met[i] : 0, one = is != 0 ? -1 / s : (double)NAN;
        inverse[i] = one, met[i] = is;
        wx[i] = nx[i] * one, wy[i] = ny[i] * one, wz[i] = nz[i] * one;
        count += is;
    }
    return count;
}

SGT_KERNEL
static void sensitivity_fill(size_t n, double value, double *out)
{
    LANES for (size_t i = 0; i < n; i++) out[i] = value;
}

SGT_KERNEL
static void sensitivity_choose(size_t n, const double *which, const double *a, double other, double *out)
{
    LANES for (size_t i = 0; i < n; i++) out[i] = which[i] != 0 ? a[i] : other;
}

SGT_KERNEL
static void sensitivity_product(size_t n, const double *a, const double *b, double *out)
{
    LANES for (size_t i = 0; i < n; i++) out[i] = a[i] * b[i];
}

/* c + a b */
SGT_KERNEL
static void sum(size_t n, const double *c, const double *a, const double *b, double *out)
{
    LANES for (size_t i = 0; i < n; i++) out[i] = c[i] + a[i] * b[i];
}

SGT_KERNEL
static void sum_one(size_t n, double c, const double *a, const double *b, double *out)
{
    LANES for (size_t i = 0; i < n; i++) out[i] = c + a[i] * b[i];
}

SGT_KERNEL
static void add_times(size_t n, double factor, const double *a, double *to)
{
    LANES for (size_t i = 0; i < n; i++) to[i] += factor * a[i];
}

SGT_KERNEL
static void sensitivity_dot(size_t n, const double *ax, const double *ay, const double *az, const double *bx,
                            const double *by, const double *bz, double *out)
{
    LANES for (size_t i = 0; i < n; i++) out[i] = ax[i] * bx[i] + ay[i] * by[i] + az[i] * bz[i];
}

/* ------------------------------------------------------------------------ a block */

static void sensitivity_begin(sensitivity_block *b, sgt_surface s, size_t n, const double *const d[3],
                              const sgt_hits *hits, double *const w[3], size_t from)
{
    b->s = s, b->n = n;
    for (int i = 0; i < 3; i++) {
        b->d[i] = d[i] + from, b->normal[i] = hits->n[i] + from, b->p.p[i] = hits->p[i] + from;
        b->w[i] = w && w[i] ? w[i] + from : b->shifts[i];
    }
    if (hits->status) positive(n, hits->status + from, b->met);
    else sensitivity_fill(n, 1, b->met);
    b->count = (size_t)invert(b);
    if (b->count == 0 || b->count == n) return;
    size_t first = 0;
    while (b->met[first] == 0) first++;
    for (int i = 0; i < 3; i++)
        sensitivity_choose(n, b->met, b->p.p[i], b->p.p[i][first], b->place[i]), b->p.p[i] = b->place[i];
}

/* H; NaN if the surface has none.  Any value where no ray was met. */
static void sensitivity_second(sensitivity_block *b)
{
    double *const out[6] = {b->h[0], b->h[1], b->h[2], b->h[3], b->h[4], b->h[5]};
    if (b->count > 0 && b->s.ops->second) b->s.ops->second(b->s.self, b->n, b->p, out);
    else for (int k = 0; k < 6; k++) sensitivity_fill(b->n, (double)NAN, out[k]);
}

static void second_times(const sensitivity_block *b, int i, const double *x, const double *y, const double *z,
                         double *out)
{
    sensitivity_dot(b->n, b->h[ENTRY[i][0]], b->h[ENTRY[i][1]], b->h[ENTRY[i][2]], x, y, z, out);
}

/* H d. */
static void sensitivity_bend(sensitivity_block *b)
{
    for (int i = 0; i < 3; i++) second_times(b, i, b->d[0], b->d[1], b->d[2], b->hd[i]);
}

/* F_j, and its gradient if wanted. */
static void parameter(sensitivity_block *b, size_t j, bool gradient)
{
    sgt_values out = {b->f, {NULL, NULL, NULL}};
    for (int i = 0; i < 3 && gradient; i++) out.grad[i] = b->g[i];
    if (b->count > 0) {
        b->s.ops->by_parameter(b->s.self, j, b->n, b->p, out);
        return;
    }
    sensitivity_fill(b->n, (double)NAN, b->f);
    for (int i = 0; i < 3 && gradient; i++) sensitivity_fill(b->n, (double)NAN, b->g[i]);
}

/* --------------------------------------------------------------- public functions */

/* The surface with the operations of this set of instructions; none if its table is not whole (is_whole). */
static sgt_surface offered(sgt_surface s)
{
    static const sgt_surface_ops nothing = {0};
    s = in_set(s);
    if (s.ops && !is_whole(s.ops)) s.ops = &nothing;
    return s;
}

static bool has_parameters(sgt_surface s) { return s.ops && s.ops->parameters && s.ops->by_parameter; }
static int lacks(bool second, bool parameters)
{
    return (second ? SGT_LACKS_SECOND : 0) | (parameters ? SGT_LACKS_PARAMETERS : 0);
}

size_t sgt_parameters(sgt_surface s)
{
    s = offered(s);
    return has_parameters(s) ? s.ops->parameters(s.self) : 0;
}

int sgt_differentiate(sgt_surface s, const sgt_ray *ray, const sgt_hit *hit, sgt_change by_o[3],
                      sgt_change by_a[])
{
    s = offered(s);
    sensitivity_block b;
    double d[3] = {ray->d.x, ray->d.y, ray->d.z}, p[3] = {hit->p.x, hit->p.y, hit->p.z},
           n[3] = {hit->n.x, hit->n.y, hit->n.z};
    sgt_status status = hit->status > 0;
    sgt_hits hits = {.status = &status, .p = {p, p + 1, p + 2}, .n = {n, n + 1, n + 2}};
    sensitivity_begin(&b, s, 1, (const double *const[3]){d, d + 1, d + 2}, &hits, NULL, 0);
    sensitivity_second(&b);
    sensitivity_bend(&b);
    for (int j = 0; by_o && j < 3; j++) {
        double c[6];
        for (int i = 0; i < 3; i++)
            sum_one(1, i == j, d + i, b.w[j], c + i), sum(1, b.h[ENTRY[i][j]], b.hd[i], b.w[j], c + 3 + i);
        by_o[j] = (sgt_change){b.w[j][0], {c[0], c[1], c[2]}, {c[3], c[4], c[5]}};
    }
    for (size_t j = 0, count = by_a ? sgt_parameters(s) : 0; j < count; j++) {
        double c[6];
        parameter(&b, j, true);
        sensitivity_product(1, b.f, b.inverse, b.t);
        for (int i = 0; i < 3; i++)
            sensitivity_product(1, d + i, b.t, c + i), sum(1, b.g[i], b.hd[i], b.t, c + 3 + i);
        by_a[j] = (sgt_change){b.t[0], {c[0], c[1], c[2]}, {c[3], c[4], c[5]}};
    }
    return lacks((by_o || (by_a && has_parameters(s))) && !(s.ops && s.ops->second),
                 by_a && !has_parameters(s));
}

/* The j-th array of a list, from the ray `at` on. */
static double *listed(double *const *list, size_t j, size_t at)
{
    return list && list[j] ? list[j] + at : NULL;
}

int sgt_differentiate_batch(sgt_surface s, size_t n, sgt_rays rays, sgt_hits hits, sgt_jacobian out)
{
    s = offered(s);
    sensitivity_block b;
    bool turns = false, lists = out.t_by_a != NULL, turn_lists = false;
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) turns |= out.n_by_o[i][j] != NULL;
        lists |= out.p_by_a[i] || out.n_by_a[i], turn_lists |= out.n_by_a[i] != NULL;
    }
    size_t count = lists ? sgt_parameters(s) : 0;
    for (size_t at = 0; at < n; at += BLOCK) {
        size_t here = n - at < BLOCK ? n - at : BLOCK;
        sensitivity_begin(&b, s, here, rays.d, &hits, out.t_by_o, at);
        if (turns || turn_lists) sensitivity_second(&b), sensitivity_bend(&b);
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++) {
                if (out.p_by_o[i][j]) sum_one(here, i == j, b.d[i], b.w[j], out.p_by_o[i][j] + at);
                if (out.n_by_o[i][j]) sum(here, b.h[ENTRY[i][j]], b.hd[i], b.w[j], out.n_by_o[i][j] + at);
            }
        for (size_t j = 0; j < count; j++) {
            double *t = listed(out.t_by_a, j, at), *p[3], *turn[3];
            bool moved = false, turned = false;
            for (int i = 0; i < 3; i++) {
                p[i] = listed(out.p_by_a[i], j, at), turn[i] = listed(out.n_by_a[i], j, at);
                moved |= p[i] != NULL, turned |= turn[i] != NULL;
            }
            if (!t && !moved && !turned) continue;
            parameter(&b, j, turned);
            if (!t) t = b.t;
            sensitivity_product(here, b.f, b.inverse, t);
            for (int i = 0; i < 3; i++) {
                if (p[i]) sensitivity_product(here, b.d[i], t, p[i]);
                if (turn[i]) sum(here, b.g[i], b.hd[i], t, turn[i]);
            }
        }
    }
    return lacks((turns || (turn_lists && has_parameters(s))) && !(s.ops && s.ops->second),
                 lists && !has_parameters(s)) |
           (ROOM_IS_ZERO(&out) ? 0 : SGT_LACKS_MEMBER);
}

/* The shift do + t dd, in three rows. */
static void shift(const sensitivity_block *b, const sgt_rays *change, const double *t, size_t at,
                  double *q[3])
{
    for (int i = 0; i < 3; i++) {
        if (change->o[0] && change->d[0]) sum(b->n, change->o[i] + at, t + at, change->d[i] + at, q[i]);
        else if (change->d[0]) sensitivity_product(b->n, t + at, change->d[i] + at, q[i]);
        else if (change->o[0]) memcpy(q[i], change->o[i] + at, b->n * sizeof(double));
        else sensitivity_fill(b->n, 0, q[i]);
    }
}

int sgt_differentiate_forward(sgt_surface s, size_t n, sgt_rays rays, sgt_hits hits, sgt_rays change,
                              const double da[], sgt_changes out)
{
    s = offered(s);
    sensitivity_block b;
    row shifted[3], turned[3];
    double *q[3] = {shifted[0], shifted[1], shifted[2]};
    bool turns = out.n[0] != NULL;
    size_t count = da ? sgt_parameters(s) : 0;
    for (size_t at = 0; at < n; at += BLOCK) {
        size_t here = n - at < BLOCK ? n - at : BLOCK;
        sensitivity_begin(&b, s, here, rays.d, &hits, NULL, at);
        shift(&b, &change, hits.t, at, q);
        sensitivity_dot(here, b.normal[0], b.normal[1], b.normal[2], q[0], q[1], q[2], b.t);
        if (da && !has_parameters(s)) sensitivity_fill(here, (double)NAN, b.t);
        for (int i = 0; i < 3 && turns; i++) sensitivity_fill(here, 0, turned[i]);
        for (size_t j = 0; j < count; j++) {
            if (da[j] == 0) continue;
            parameter(&b, j, turns);
            add_times(here, da[j], b.f, b.t);
            for (int i = 0; i < 3 && turns; i++) add_times(here, da[j], b.g[i], turned[i]);
        }
        sensitivity_product(here, b.t, b.inverse, b.t);
        for (int i = 0; i < 3; i++) sum(here, q[i], b.d[i], b.t, q[i]); /* q is now dp */
        if (out.t) memcpy(out.t + at, b.t, here * sizeof(double));
        for (int i = 0; i < 3 && out.p[0]; i++) memcpy(out.p[i] + at, q[i], here * sizeof(double));
        if (!turns) continue;
        sensitivity_second(&b);
        for (int i = 0; i < 3; i++) {
            second_times(&b, i, q[0], q[1], q[2], b.f);
            add_times(here, 1, b.f, turned[i]);
            memcpy(out.n[i] + at, turned[i], here * sizeof(double));
        }
    }
    return lacks(turns && !(s.ops && s.ops->second), da && !has_parameters(s));
}
