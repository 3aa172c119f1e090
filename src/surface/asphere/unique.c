// SPDX-License-Identifier: MIT
/* asphere/unique.c - a root of an asphere was met near the vertex: is it the only one within the rim?  And
 * a ray that leaves the surface: does it meet nothing?
 *
 * If |n| > L sqrt a, F is monotone along the ray within the rim (poly.h, single_limit).  If that does not
 * decide, the aperture is divided into sixteen rings about the axis.
 *
 * BY STEEPNESS.  Let q = |n| / sqrt a, and let r0 be the distance from the axis at which the ray meets the
 * vertex plane.  At r the ray is at least q (r - r0) away from that plane.  A rising ray is above the plane
 * ahead of that point, and below it behind.  With S = s + P:
 * - If S < q (inner - r0) in a ring, the ring has no root ahead.
 * - If -S < q (inner - r0) in a ring, or the ray did not come from there, the ring has no root behind.
 * - In rings with |dS/dr| < q everywhere, F is monotone.
 *
 * There is only one root if for some J the first J rings are of the last kind and the others have no root.
 * So let K be the least over J of the largest of these limits: q > K is sufficient.
 *
 * RING BY RING.  This is for rays on which that does not decide, such as those nearly parallel to the
 * vertex plane.  On a piece of the ray (piece.h) F' = n - S'(r) u is within bounds, with u = dr / dtau = a
 * s / r.  If F rises on each piece that may have a root, there is at most one root: behind it F is above
 * zero, and stays there.  The same holds if it falls on each.  If no piece may have a root, the ray is a
 * miss.
 *
 * WHY APART.  Without the rings a proof goes on to the cells: 4.6 times the instructions for an asphere
 * without a rim (near the seed, SGT_PROVE_FIRST; rays of tests/cost/cases.c, by callgrind).  Where the slope
 * decides they cost nothing.  Rays that pass by: without `sgt_asphere_pass` single rays from the side cost up
 * to 1.56 times as much, and the mean of 384 kinds of single rays, most of which meet the surface, is 0.97.
 *
 * BOUNDS.  Let a ring be m +- h in rho.  P' differs from P'(m) by at most |P''(m)| h + third h^2 / 2, and P
 * from P(m) by at most |P'(m)| h + second h^2 / 2.  Here second and third are the bounds of `magnitude` at
 * the outer edge of the ring.  s and ds/drho are monotone.  2^-40 of all terms is added for rounding. */
#include "asphere.h"
#include "../sag/piece.h"
#include "side.h"

enum { RINGS = 16 };

/* inner: the inner edge.  slope: a bound on |dS/dr|.  least, most: bounds of dS/dr with its sign.  above,
 * below: bounds of S and -S. */
typedef struct slope_rings {
    double width, inner[RINGS], slope[RINGS], least[RINGS], most[RINGS], above[RINGS], below[RINGS];
} slope_rings;

SGT_KERNEL
static void asphere_rings(const shape *s, slope_rings *out)
{
    double m[RINGS], h[RINGS], outer2[RINGS], p[RINGS], p1[RINGS], p2[RINGS], first[RINGS], second[RINGS],
        third[RINGS];
    double width = sqrt(s->domain2) * (1 + 0x1p-40) / RINGS, c = s->c, ckc = s->ck * s->c;
    out->width = width;
    LANES for (int j = 0; j < RINGS; j++) {
        double inner = j * width, outer = (j + 1) * width;
        out->inner[j] = inner, outer2[j] = outer * outer;
        m[j] = 0.5 * (outer * outer + inner * inner),
        h[j] = (0.5 + 0x1p-40) * (outer * outer - inner * inner);
        p[j] = p1[j] = p2[j] = first[j] = second[j] = third[j] = 0;
    }
    /* For Q = P / rho: P' = Q + rho Q', P'' = 2 Q' + rho Q''.  p2 is Q'' / 2, and `third` is half of its
     * derivative too. */
    for (int i = s->terms - 1; i >= 0; i--) {
        double a = s->a[i], by = (i + 1) * fabs(a);
        LANES for (int j = 0; j < RINGS; j++) {
            p2[j] = p2[j] * m[j] + p1[j], p1[j] = p1[j] * m[j] + p[j], p[j] = p[j] * m[j] + a;
            third[j] = third[j] * outer2[j] + second[j], second[j] = second[j] * outer2[j] + first[j],
            first[j] = first[j] * outer2[j] + by;
        }
    }
    LANES for (int j = 0; j < RINGS; j++) {
        double rho = outer2[j], rho_in = out->inner[j] * out->inner[j], d1 = p[j] + m[j] * p1[j],
               d2 = 2 * (p1[j] + m[j] * p2[j]);
        double near = sqrt(larger(1 - ckc * rho_in, 0)), far = sqrt(larger(1 - ckc * rho, 0)),
               s1 = 0.5 * c / near, s2 = 0.5 * c / far;
        double tilt = fabs(d2) * h[j] + third[j] * (h[j] * h[j]) + 0x1p-40 * (fabs(s1) + fabs(s2) + first[j]);
        double rise = fabs(d1) * h[j] + 0.5 * second[j] * (h[j] * h[j]) +
                      0x1p-40 * rho * (fabs(c) + first[j]);
        double z1 = c * rho_in / (1 + near), z2 = c * rho / (1 + far), z = m[j] * p[j];
        double slope = 2 * (out->inner[j] + width) * (larger(fabs(s1 + d1), fabs(s2 + d1)) + tilt),
               above = larger(z1, z2) + z + rise, below = larger(-z1, -z2) - z + rise;
        double in = 2 * out->inner[j], end = 2 * (out->inner[j] + width); /* dS/dr = 2 r (s' + P') */
        double least = lesser(s1, s2) + d1 - tilt, most = larger(s1, s2) + d1 + tilt;
        out->slope[j] = chosen(MASK(slope < HUGE_VAL), slope, HUGE_VAL); /* NaN too */
        out->least[j] = least * chosen(MASK(least > 0), in, end);
        out->most[j] = most * chosen(MASK(most > 0), end, in);
        out->above[j] = chosen(MASK(above < HUGE_VAL), above, HUGE_VAL),
        out->below[j] = chosen(MASK(below < HUGE_VAL), below, HUGE_VAL);
    }
}

/* For one ray, or for a tile the largest of its rays: r0, and how far from the axis the ray may come from
 * and go to. */
typedef struct ring_slopes { double r0, from, to; } ring_slopes;

SGT_INLINE void ring_widen(ring_slopes *most, ring_slopes one)
{
    most->r0 = larger(one.r0, most->r0), most->from = larger(one.from, most->from),
    most->to = larger(one.to, most->to);
}

/* K, or a little more.  rises: n > 0. */
static double steepness(const slope_rings *g, ring_slopes way, bool rises)
{
    const double *ahead = rises ? g->above : g->below, *behind = rises ? g->below : g->above;
    double lead[RINGS + 1], tail = 0, least = HUGE_VAL;
    lead[0] = 0;
    for (int j = 0; j < RINGS; j++) lead[j + 1] = larger(lead[j], g->slope[j]);
    for (int j = RINGS;; j--) {
        double k = larger(lead[j], tail);
        least = k < least ? k : least;
        if (j == 0 || !(g->inner[j - 1] > way.r0)) break;
        double in = g->inner[j - 1],
               height = larger(in <= way.to ? ahead[j - 1] : 0, in <= way.from ? behind[j - 1] : 0);
        tail = larger(tail, height / (in - way.r0));
    }
    return least * (1 + 0x1p-20);
}

/* For all rays.  q2 is the square of q. */
SGT_KERNEL
static void asphere_courses(const sgt_tile *tile, double *q2, ring_slopes *way)
{
    const sgt_rays rows = tile->rays;
    const double slack = 1 + 0x1p-20;
    size_t count = tile->n;
    LANES for (size_t i = 0; i < count; i++) {
        const sgt_ray ray = lane_ray_of(&rows, i);
        const vertex_place at = to_vertex_plane(&ray);
        double a = ray.d.x * ray.d.x + ray.d.y * ray.d.y, n2 = ray.d.z * ray.d.z, t0 = at.t0,
               r0 = slack * sqrt(at.x * at.x + at.y * at.y), side = slack * sqrt(a), off = 0x1p-40 * fabs(t0);
        q2[i] = chosen(MASK(a > 0x1p-400) & MASK(n2 > 0x1p-200), n2 / a, (double)NAN);
        way[i].r0 = r0, way[i].from = r0 + side * larger(t0 - ray.tmin + off, 0),
        way[i].to = r0 + side * larger(ray.tmax - t0 + off, 0);
    }
}

/* ---------------------------------------------------------------------- ring by ring */

/* All bits set if there is at most one root: on every piece F has none or rises, or on every piece F has
 * none or falls.  s and u are in the ranges given behind the point nearest the axis, and in those with the
 * other sign before it.  NaN proves nothing. */
SGT_KERNEL
static mask asphere_one_root(const slope_rings *g, const line *w)
{
    const double more = 1 + 0x1p-40, less = 1 - 0x1p-40, a = w->a, n = w->n, far = w->nearest + w->aside;
    mask rises = MASK(true), falls = rises;
#pragma omp simd reduction(& : rises, falls)
    for (int j = 0; j < RINGS; j++) {
        double in = g->inner[j], out = (in + g->width) * more;
        piece p = piece_of(w, in, out);
        double u_in = a * larger(p.s_in, 0) / larger(larger(in, far) * more, 0x1p-500) * less,
               u_out = a * p.s_out / out * more;
        double most = larger(g->most[j] * u_in, g->most[j] * u_out),
               least = lesser(g->least[j] * u_in, g->least[j] * u_out);
        double unsure = 0x1p-40 * (fabs(n) + fabs(most) + fabs(least));
        mask behind = p.passed_by | is_apart(w, p.s_in, p.s_out, -g->below[j], g->above[j]),
             before = p.passed_by | is_apart(w, -p.s_out, -p.s_in, -g->below[j], g->above[j]);
        rises &= (behind | MASK(n - most > unsure)) & (before | MASK(n + least > unsure));
        falls &= (behind | MASK(n - least < -unsure)) & (before | MASK(n + most < -unsure));
    }
    return rises | falls;
}

/* For the rays that sgt_lanes_monotone leaves: all at once, then each by itself. */
bool sgt_asphere_unique(const shape *s, const sgt_tile *tile, mask unique[])
{
    double q2[SGT_TILE], k;
    ring_slopes way[SGT_TILE], most = {0, 0, 0};
    slope_rings g;
    bool all = true, rise = false, fall = false;
    if (!(s->domain2 < 0x1p600 && s->domain2 > 0x1p-600)) return false;
    asphere_rings(s, &g);
    k = steepness(&g, (ring_slopes){HUGE_VAL, 0, 0}, true); /* monotone everywhere */
    if (k * k < single_limit(s) && sgt_lanes_steeper(k * k, tile, unique)) return true;
    asphere_courses(tile, q2, way);
    for (size_t i = 0; i < tile->n; i++) {
        if (unique[i]) continue;
        ring_widen(&most, way[i]);
        *(tile->rays.d[2][i] > 0 ? &rise : &fall) = true;
    }
    k = larger(rise ? steepness(&g, most, true) : 0, fall ? steepness(&g, most, false) : 0);
    for (size_t i = 0; i < tile->n; i++) {
        if (unique[i]) continue;
        double own = q2[i] > k * k || tile->n == 1 ? k : steepness(&g, way[i], tile->rays.d[2][i] > 0);
        unique[i] = MASK(q2[i] > own * own);
        if (!unique[i]) {
            const sgt_rays *r = &tile->rays;
            line w = line_of((sgt_vec3){r->o[0][i], r->o[1][i], r->o[2][i]},
                             (sgt_vec3){r->d[0][i], r->d[1][i], r->d[2][i]}, r->tmin[i], r->tmax[i]);
            unique[i] = line_in_range(&w) & asphere_one_root(&g, &w);
        }
        all &= unique[i] != 0;
    }
    return all;
}

/* ------------------------------------------------------------------------- misses */

SGT_KERNEL
static mask asphere_passed_by(const slope_rings *g, const line *w)
{
    double left = 0;
#pragma omp simd reduction(+ : left)
    for (int j = 0; j < RINGS; j++) {
        piece p = piece_of(w, g->inner[j], (g->inner[j] + g->width) * (1 + 0x1p-40));
        mask apart = is_apart(w, p.s_in, p.s_out, -g->below[j], g->above[j])
                     & is_apart(w, -p.s_out, -p.s_in, -g->below[j], g->above[j]);
        left += (p.passed_by | apart) != 0 ? 0.0 : 1.0;
    }
    return MASK(left == 0);
}

/* THE CONE, for all rays at once.  Take a ray that leaves the vertex plane.  In one unit of tau, r grows by
 * at most sqrt a, and the height above that plane, on the side the ray goes to, grows by |n|.  The ray
 * begins at r0 and h0, so at r it is at least h0 + q max(r - r0, 0) high.
 *
 * If the sag of a ring is less than that at its inner edge, the ray passes the ring.  A ring farther out
 * than r0 may also be so flat that F is monotone in it: |dS/dr| < q.  The ray enters it above the surface,
 * since it has passed all rings before, and stays above.
 *
 * The same holds all the way if the ray begins in the vertex, at t = 0, where F is 0: the start is not
 * accepted.  (There r0 is set slightly below 0, so that the first ring is farther out too.)  2^-40 is far
 * more than rounding. */
typedef struct cones { double high[SGT_TILE], r[SGT_TILE], q[SGT_TILE]; } cones;

/* Sets asked[i] to those of the rays asked about that leave the vertex plane.  Returns their number. */
SGT_KERNEL
static double cones_of(const sgt_tile *tile, mask asked[], cones *e)
{
    const double *ox = tile->rays.o[0], *oy = tile->rays.o[1], *oz = tile->rays.o[2], *l = tile->rays.d[0],
                 *m = tile->rays.d[1], *n = tile->rays.d[2], *tmin = tile->rays.tmin, *tmax = tile->rays.tmax,
                 off = 0x1p-40;
    double some = 0;
#pragma omp simd reduction(+ : some)
    for (size_t i = 0; i < tile->n; i++) {
        double scale = scale_of((sgt_vec3){l[i], m[i], n[i]}), ls = l[i] * scale, ms = m[i] * scale,
               ns = n[i] * scale, a = ls * ls + ms * ms, n2 = ns * ns;
        double tl = tmin[i] * l[i], tm = tmin[i] * m[i], tn = tmin[i] * n[i], x = ox[i] + tl, y = oy[i] + tm,
               z = oz[i] + tn;
        double high = copysign(1, n[i]) * z - off * (fabs(oz[i]) + fabs(tn));
        mask vertex = at_vertex(ox[i], oy[i], oz[i]) & MASK(tmin[i] == 0);
        mask is = asked[i] & MASK(a > 0x1p-400) & MASK(a < 0x1p400) & MASK(n2 > 0x1p-200) & MASK(n2 < 0x1p400)
                  & MASK(tmin[i] <= tmax[i]) & (vertex | MASK(high > 0x1p-400));
        double r = sqrt(x * x + y * y) * (1 + off) + off * (fabs(ox[i]) + fabs(tl) + fabs(oy[i]) + fabs(tm));
        e->high[i] = high, e->q[i] = sqrt(n2 / a) * (1 - off), e->r[i] = chosen(vertex, -0x1p-1000, r);
        asked[i] = is, some += chosen(is, 1, 0);
    }
    return some;
}

SGT_KERNEL
static void asphere_over(const slope_rings *g, const sgt_tile *tile, const cones *e, mask over[])
{
    const double *n = tile->rays.d[2], less = 1 - 0x1p-40;
    for (int j = 0; j < RINGS; j++) {
        const double in = g->inner[j] * less, slope = g->slope[j], above = g->above[j], below = g->below[j];
        LANES for (size_t i = 0; i < tile->n; i++) {
            double q = e->q[i], out = in - e->r[i], sag = chosen(MASK(n[i] > 0), above, below);
            over[i] &=
                (MASK(slope < q) & MASK(out > 0)) | MASK(sag < (e->high[i] + q * larger(out, 0)) * less);
        }
    }
}

/* LEAVING.  Let a ray start on the surface, at a root that is the only one near it and is not accepted (FROM
 * ON IT in side.h), or in the vertex.  In a ring with |dS/dr| < q, F n rises all the time.  In a ring of
 * which the sag is below the cone, F n > 0.  Let each ring be of one of these kinds.  That of the start is of
 * the first, as it holds the start.  So F n > 0 behind the start as long as the ray is in that ring, then in
 * the next one, and so on, also if it comes back to one: nothing is met.  The height of the cone may be
 * negative where the ray begins. */
SGT_KERNEL
static double asphere_starts(const wavy *self, const sgt_tile *tile, mask asked[], cones *e)
{
    const sgt_rays rows = tile->rays;
    const wavy own = *self, *s = &own;
    const convex b = {.sign = 1, .ckc = s->ck * s->c}; /* all that side_on_of reads */
    const double off = 0x1p-40;
    size_t count = tile->n;
    double some = 0;
#pragma omp simd reduction(+ : some)
    for (size_t i = 0; i < count; i++) {
        const sgt_ray ray = lane_ray_of(&rows, i);
        const double x = ray.o.x, y = ray.o.y, z = ray.o.z, n2 = ray.d.z * ray.d.z,
                     a = ray.d.x * ray.d.x + ray.d.y * ray.d.y;
        side_on at = side_on_of(s, &b, ALL_TERMS, &ray);
        mask vertex = at_vertex(x, y, z) & MASK(ray.tmin == 0),
             is = asked[i] & MASK(a > 0x1p-400) & MASK(n2 > 0x1p-200) & MASK(ray.tmin <= ray.tmax) &
                  (vertex | at.rises | at.falls);
        double high = copysign(1, ray.d.z) * z;
        e->high[i] = high - off * fabs(z), e->q[i] = sqrt(n2 / a) * (1 - off),
        e->r[i] = chosen(vertex, -0x1p-1000, sqrt(x * x + y * y) * (1 + off));
        asked[i] = is, some += chosen(is, 1, 0);
    }
    return some;
}

SGT_KERNEL
static void asphere_leaves(const slope_rings *g, const sgt_tile *tile, const cones *e, mask over[])
{
    const double *n = tile->rays.d[2], off = 0x1p-40;
    for (int j = 0; j < RINGS; j++) {
        const double in = g->inner[j] * (1 - off), slope = g->slope[j], above = g->above[j],
                     below = g->below[j];
        LANES for (size_t i = 0; i < tile->n; i++) {
            double q = e->q[i], least = e->high[i] + q * larger(in - e->r[i], 0),
                   sag = chosen(MASK(n[i] > 0), above, below);
            over[i] &= MASK(slope < q) | MASK(sag < least - off * fabs(least));
        }
    }
}

/* May a ray start on it?  At such a start |G| is at most START_ULPS of twice these terms. */
SGT_KERNEL
static mask asphere_may_start(const wavy *self, const sgt_tile *tile)
{
    const wavy own = *self, *s = &own;
    const double *ox = tile->rays.o[0], *oy = tile->rays.o[1], *oz = tile->rays.o[2];
    size_t count = tile->n;
    mask any = 0;
    _Pragma("omp simd reduction(| : any)") for (size_t i = 0; i < count; i++)
    {
        double x = ox[i], y = oy[i], z = oz[i], rho = x * x + y * y, w, ckw,
               g = wavy_g(s, rho, z, horner(s->a, ALL_TERMS, rho), &w, &ckw),
               terms = fabs(z) + rho * (s->abs_c + 2 * horner(s->size, ALL_TERMS, rho));
        any |= MASK(fabs(g) <= 0x1p-40 * terms);
    }
    return any;
}

bool sgt_asphere_may_start(const wavy *v, const sgt_tile *tile) { return asphere_may_start(v, tile) != 0; }

void sgt_asphere_leave(const shape *s, const wavy *v, const sgt_tile *tile, mask leaves[])
{
    slope_rings g;
    cones e;
    if (s->domain2 < 0x1p600 && s->domain2 > 0x1p-600 && asphere_starts(v, tile, leaves, &e) > 0) {
        asphere_rings(s, &g);
        asphere_leaves(&g, tile, &e, leaves);
    } else
        memset(leaves, 0, tile->n * sizeof *leaves);
}

/* FROM A START.  Which rays start on the surface, and is F monotone within the rim, or linear, so that they
 * meet nothing else (single)?  behind: the sign of F behind the start; 0: not known.  Returns all bits set if
 * that is all. */
SGT_INLINE mask lane_from_start(const wavy *self, int terms, const sgt_tile *tile, mask single[],
                                double *restrict behind)
{
    const sgt_rays rows = tile->rays;
    const wavy own = *self, *s = &own;
    const convex b = {.sign = 1, .ckc = s->ck * s->c};
    size_t count = tile->n;
    mask all = MASK(true);
    _Pragma("omp simd reduction(& : all)") for (size_t i = 0; i < count; i++)
    {
        const sgt_ray ray = lane_ray_of(&rows, i);
        const double l = ray.d.x, m = ray.d.y, n = ray.d.z;
        side_on at = side_on_of(s, &b, terms, &ray);
        mask on = (at.rises | at.falls) & usual_length((l * l + m * m) + n * n) & MASK(ray.tmax > 0),
             alone = on & (wavy_single(s, l, m, n) | MASK(fabs(l) + fabs(m) == 0));
        behind[i] = chosen(on, chosen(at.rises, 1, -1), 0), single[i] = alone;
        all &= alone;
    }
    return all;
}

SGT_KERNEL
static mask asphere_few_from_start(const wavy *s, const sgt_tile *tile, mask single[], double *behind)
{
    return lane_from_start(s, FEW_TERMS, tile, single, behind);
}
SGT_KERNEL
static mask asphere_all_from_start(const wavy *s, const sgt_tile *tile, mask single[], double *behind)
{
    return lane_from_start(s, ALL_TERMS, tile, single, behind);
}

bool sgt_asphere_from_start(const wavy *v, int terms, const sgt_tile *tile, mask misses[], double behind[])
{
    return terms > FEW_TERMS ? asphere_all_from_start(v, tile, misses, behind) != 0
                             : asphere_few_from_start(v, tile, misses, behind) != 0;
}

/* The cones of rays that start on the surface. */
SGT_KERNEL
static void asphere_start_cones(const sgt_tile *tile, mask asked[], cones *e)
{
    const sgt_rays rows = tile->rays;
    const double off = 0x1p-40;
    size_t count = tile->n;
    LANES for (size_t i = 0; i < count; i++)
    {
        const sgt_ray ray = lane_ray_of(&rows, i);
        const double x = ray.o.x, y = ray.o.y, z = ray.o.z, n2 = ray.d.z * ray.d.z,
                     a = ray.d.x * ray.d.x + ray.d.y * ray.d.y;
        e->high[i] = copysign(1, ray.d.z) * z - off * fabs(z), e->q[i] = sqrt(n2 / a) * (1 - off);
        e->r[i] = sqrt(x * x + y * y) * (1 + off);
        asked[i] = MASK(a > 0x1p-400) & MASK(n2 > 0x1p-200);
    }
}

void sgt_asphere_past_rings(const shape *s, const sgt_tile *tile, mask misses[], const double behind[])
{
    double own[6][SGT_TILE];
    unsigned char number[SGT_TILE];
    mask over[SGT_TILE];
    slope_rings g;
    cones e;
    size_t some = 0;
    const sgt_rays *r = &tile->rays;
    const double *const row[6] = {r->o[0], r->o[1], r->o[2], r->d[0], r->d[1], r->d[2]};
    if (!(s->domain2 < 0x1p600 && s->domain2 > 0x1p-600)) return;
    for (size_t i = 0; i < tile->n; i++)
        if (behind[i] != 0 && !misses[i]) number[some++] = (unsigned char)i;
    if (!some) return;
    for (int k = 0; k < 6; k++)
        for (size_t j = 0; j < some; j++) own[k][j] = row[k][number[j]];
    const sgt_tile few = {.n = some,
                          .rays = {.o = {own[0], own[1], own[2]},
                                   .d = {own[3], own[4], own[5]},
                                   .tmin = own[0],
                                   .tmax = own[0]}}; /* the ends are not read */
    asphere_start_cones(&few, over, &e);
    asphere_rings(s, &g);
    asphere_leaves(&g, &few, &e, over);
    for (size_t j = 0; j < some; j++) misses[number[j]] |= over[j];
}

/* Does the ray start on the surface, in its rings, so that the root nearest by is the start, and not
 * accepted?  Then *before is a t before that root. */
static bool starts_on_it(const shape *s, const sgt_ray *ray, double *before)
{
    double rho = ray->o.x * ray->o.x + ray->o.y * ray->o.y, dp,
           w = ray->o.z - polynomial(s->terms, s->a, rho, &dp), g = w - 0.5 * (s->c * rho + s->ck * w * w),
           v_err;
    if (ray->tmin != 0 || !(fabs(g) <= 0x1p-40 * (fabs(ray->o.z) + fabs(w)) && rho <= s->domain2))
        return false;
    local q = local_at(ray, 0, 0);
    sample at = sgt_poly_sample(s, &q, 0);
    meeting start;
    bool steady;
    sgt_poly_bound(s, &q, 0, &at);
    if (!sgt_poly_certify(s, &q, &at, 0, 0, &start, &v_err, &steady)) return false;
    *before = start.t - 2 * start.t_err;
    return start.v > 16 * v_err && is_start(&start, ray, q.scale);
}

/* If the ray starts in the vertex at t = 0, or on the surface, and has at most one root from there on, that
 * root is the start itself, and is not accepted. */
void sgt_asphere_pass(const shape *s, const sgt_tile *tile, mask passes[])
{
    const sgt_rays *r = &tile->rays;
    slope_rings g;
    cones e;
    mask over[SGT_TILE];
    bool any = false, in_range = s->domain2 < 0x1p600 && s->domain2 > 0x1p-600;
    memcpy(over, passes, tile->n * sizeof over[0]);
    if (in_range && cones_of(tile, over, &e) > 0) {
        asphere_rings(s, &g);
        any = true;
        asphere_over(&g, tile, &e, over);
    } else {
        memset(over, 0, tile->n * sizeof over[0]);
    }
    for (size_t i = 0; i < tile->n; i++) {
        if (!passes[i] || over[i]) continue;
        sgt_vec3 o = {r->o[0][i], r->o[1][i], r->o[2][i]}, d = {r->d[0][i], r->d[1][i], r->d[2][i]};
        double tmin = r->tmin[i], tmax = r->tmax[i];
        passes[i] = 0;
        double from = tmin;
        bool is_ray = tmin <= tmax && tmin < HUGE_VAL && tmax > -HUGE_VAL,
             vertex = at_vertex(o.x, o.y, o.z) && tmin == 0,
             starts = vertex || (is_ray && starts_on_it(s, &(sgt_ray){o, d, tmin, tmax}, &from));
        line w = line_of(o, d, from < tmin ? from : tmin, tmax);
        if (!(in_range && is_ray && line_in_range(&w) && (starts || w.from > 0))) continue;
        if (!any) asphere_rings(s, &g);
        any = true;
        passes[i] = starts ? asphere_one_root(&g, &w) : asphere_passed_by(&g, &w);
    }
}
