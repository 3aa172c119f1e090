// SPDX-License-Identifier: MIT
/* by_slope.c - a root proven by a lower bound on the slope.
 *
 * THE IDEA.  Take a sag made by departure/departure.c, within the aperture.  Along most rays |dF/dtau| >=
 * least there, with tau in lengths of the scaled direction.  Then F at one point, in the aperture or next
 * to it, decides everything: the chord has one root, within |F| / least of that point.
 *
 * THE BOUND.  The point is o + (t + t_lo) d of a hit that nobody has proven.  Each coordinate is right to
 * u of itself.  That moves F by no more than the steepest gradient in the aperture times it; nothing is
 * taken to first order.
 *
 * THE COST.  Two or three calls of the surface for all rays of a tile.  Enclosures cost as much as a dozen
 * calls for each ray. */
#include "unique.h"

#include "../num/lanes.h"

#include "general.h"

enum { BLOCK = 64 };

typedef double row[BLOCK];

/* The rows of one block of rays: `spans` (lo, hi, seed, least), the point, the scaled t_lo, F there and
 * its rounding. */
typedef struct slope_block { row lo, hi, seed, least, x, y, z, tau_lo, f, own; } slope_block;

SGT_KERNEL
static void points_of(slope_block *b, size_t n, const double *restrict ox, const double *restrict oy,
                      const double *restrict oz, const double *restrict dx, const double *restrict dy,
                      const double *restrict dz, const double *restrict t, const double *restrict t_lo)
{
    LANES for (size_t i = 0; i < n; i++) {
        sgt_vec3 d = {dx[i], dy[i], dz[i]};
        double scale = scale_of(d), inverse = inverse_of_scale(d), from = t[i] * inverse,
               rest = t_lo[i] * inverse;
        mask met = MASK(fabs(from) < HUGE_VAL) & MASK(fabs(rest) < HUGE_VAL);
        from = chosen(met, from, 0), rest = chosen(met, rest, 0);
        b->x[i] = coordinate(ox[i], dx[i] * scale, from, rest).hi;
        b->y[i] = coordinate(oy[i], dy[i] * scale, from, rest).hi;
        b->z[i] = coordinate(oz[i], dz[i] * scale, from, rest).hi;
        b->tau_lo[i] = rest;
    }
}

/* Is the k-th hit proven?  If so, sets its t_err, p_err and evals as sgt_unique_by_slope says. */
static bool proven_by(const slope_block *b, size_t i, const sgt_shared *shared, const sgt_tile *tile,
                      size_t k, double rim2)
{
    const sgt_hits *h = &tile->hits;
    sgt_vec3 d = {tile->rays.d[0][k], tile->rays.d[1][k], tile->rays.d[2][k]};
    double scale = scale_of(d), x = b->x[i], y = b->y[i], z = b->z[i], far = fabs(x) + fabs(y) + fabs(z),
           t = h->t[k];
    double moved = SGT_U * (shared->steep * (fabs(x) + fabs(y)) + fabs(z)) +
                   0x1p-100 * (1 + shared->steep) * fabs(b->tau_lo[i]);
    double e = (fabs(b->f[i]) + 1.01 * (b->own[i] + moved)) / b->least[i] * (1 + 8 * SGT_U);
    double t_err = larger(h->t_err[k], (fabs(h->t_lo[k]) + e * scale) * (1 + 8 * SGT_U));
    double px = h->p[0][k], py = h->p[1][k], pz = h->p[2][k];
    double p_err = (fabs(px - x) + fabs(py - y) + fabs(pz - z) +
                    (fabs(d.x) + fabs(d.y) + fabs(d.z)) * scale * e + 1.01 * SGT_U * far) *
                   (1 + 8 * SGT_U);
    double r2 = px * px + py * py,
           hidden = 1.01 * ((2 * (fabs(px) + fabs(py)) + p_err) * p_err + 4 * SGT_U * r2);
    bool inside = !(rim2 < HUGE_VAL) || rim2 - r2 > hidden;
    if (!(h->status[k] == SGT_HIT && b->least[i] > 0 && inside && t - t_err > b->lo[i] &&
          t + t_err < b->hi[i]))
        return false;
    h->t_err[k] = t_err, h->p_err[k] = larger(h->p_err[k], p_err);
    h->evals[k]++;
    return true;
}

size_t sgt_unique_by_slope(sgt_surface s, const sgt_tile *tile, double rim2, bool proven[])
{
    const struct sgt_builtin_ops *builtin = s.ops->own_;
    size_t count = 0;
    memset(proven, 0, tile->n * sizeof *proven);
    if (!is_catalogue(s.ops) || !builtin->share_within || !builtin->spans) return 0;
    /* If no ray was met, the parameters may be invalid.  Then the surface must not be asked anything. */
    size_t first = 0;
    while (first < tile->n && tile->hits.status[first] != SGT_HIT) first++;
    if (first == tile->n) return 0;
    sgt_shared shared;
    slope_block b;
    builtin->share_within(s.self, sqrt(rim2), &shared);
    double own_rim2 = rim2_of_surface(s);
    for (size_t from = 0, n; from < tile->n; from += n) {
        n = tile->n - from < BLOCK ? tile->n - from : BLOCK;
        sgt_rays rays = rays_from(&tile->rays, from);
        sgt_points p = {{b.x, b.y, b.z}};
        builtin->spans(s.self, &shared, n, rays, (sgt_spans){b.lo, b.hi, b.seed, NULL}, b.least);
        points_of(&b, n, rays.o[0], rays.o[1], rays.o[2], rays.d[0], rays.d[1], rays.d[2],
                  tile->hits.t + from, tile->hits.t_lo + from);
        s.ops->values(s.self, n, p, (sgt_values){.f = b.f});
        bool all = builtin->roundings && builtin->roundings(s.self, &shared, n, p, b.f, b.own);
        for (size_t i = 0; i < n; i++) {
            size_t k = from + i;
            if (tile->hits.status[k] != SGT_HIT || !(b.least[i] > 0)) continue;
            if (!all || !(b.own[i] >= 0))
                b.own[i] = s.ops->rounding(s.self, (sgt_vec3){b.x[i], b.y[i], b.z[i]});
            proven[k] = proven_by(&b, i, &shared, tile, k, own_rim2);
            count += proven[k];
        }
    }
    return count;
}

bool sgt_meet_by_slope(sgt_surface s, const sgt_ray *ray, double rim2, const sgt_options *opt, sgt_hit *hit)
{
    sgt_options plain = *opt;
    plain.proof = SGT_ESTIMATE;
    *hit = sgt_intersect(s, *ray, &plain);
    if (hit->status == SGT_STOPPED) return true;
    double r2 = hit->p.x * hit->p.x + hit->p.y * hit->p.y;
    if (hit->status != SGT_HIT || r2 > rim2) return false;
    sgt_status status = SGT_HIT;
    bool proven;
    sgt_tile one = {.n = 1, .rays = rays_of(ray),
                    .hits = {.status = &status, .evals = &hit->evals, .t = &hit->t, .t_err = &hit->t_err,
                             .t_lo = &hit->t_lo, .p = {&hit->p.x, &hit->p.y, &hit->p.z},
                             .p_err = &hit->p_err}};
    if (!sgt_unique_by_slope(s, &one, rim2, &proven)) return false;
    sgt_interval about = sgt_about(hit->t, hit->t_err);
    hit->lo = about.lo, hit->hi = about.hi;
    double slope = hit->n.x * ray->d.x + hit->n.y * ray->d.y + hit->n.z * ray->d.z;
    sgt_step step = step_at(hit->evals, SGT_PROBE, hit->t, hit->f, slope, about.lo, about.hi);
    if (opt->watch && opt->watch(opt->watch_data, &step)) *hit = hit_without(SGT_STOPPED, ray, hit->evals);
    return true;
}
