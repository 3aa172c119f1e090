// SPDX-License-Identifier: MIT
/* by_slope.c - a root proven by a lower bound on the slope.
 *
 * THE IDEA.  Take a sag made by departure/departure.c, within the aperture.  Along most rays |dF/dtau| >=
 * least there, with tau in lengths of the scaled direction.  Then F at one point, in the aperture or next
 * to it, decides everything: the chord has one root, within |F| / least of that point.
 *
 * A HIT that nobody has proven is the point.  It is proven if the root is away from the rim, and from the
 * ends of the chord.  Apart from traces, which have no ends, it must also be certainly accepted
 * (near_an_end).
 * A MISS is proven if the chord is empty, or lies beyond the ends of the ray.  Else F is looked at where the
 * chord begins, and ends, between the ends of the ray.  F rises along the chord where n > 0.  So no root is
 * behind a point at which F has the sign of n, or before one at which it has the other.
 * Other rays are left to proof.c.
 *
 * A PART OF THE CHORD is enough where another argument says that the first root is in it, or that there is
 * none: that of vicinity.h, which holds for a ray that starts before the part, or was followed to it, and for
 * a root near the seed, which need not be the first.  So it is asked where the slope has no bound all along
 * the chord: without a rim, and where rays graze.
 *
 * THE ONLY ROOT, where parts of the chord are asked: it is the first root of the ray, and the first one of
 * a ray that comes from beyond all roots (tail.h) the other way.  Those two are the same if the second is in
 * the part of the first, in which there is one root at most.  If it is beyond that part, there are two.
 *
 * THE BOUND.  The point is o + (t + t_lo) d.  Each coordinate is right to u of itself.  That moves F by no
 * more than the steepest gradient in the aperture times it; nothing is taken to first order.  Where F is
 * looked at apart from a trace, no product on the way to the point has underflown (fine).
 *
 * THE COST.  Two or three calls of the surface for all rays of a tile.  Enclosures cost as much as a dozen
 * calls for each ray.  With the estimate, a proof in a batch takes 1.5 to 2 times an estimate
 * (tests/bench/bench_proof_catalogue.cpp). */
#include "unique.h"

#include "../num/lanes.h"
#include "../solve/root.h"
#include "../solve/step.h"

#include "general.h"
#include "only.h"
#include "proof.h"
#include "wings.h"

enum { BLOCK = SGT_QUICK };

typedef double row[BLOCK];

/* The rows of one block of rays: `spans` (lo, hi, seed, least), the point, the scaled t_lo, F there and
 * its rounding.  fine: 1 where no product underflows on the way to the point. */
typedef struct slope_block {
    row lo, hi, seed, least, x, y, z, tau_lo, fine, f, gx, gy, gz, own;
} slope_block;

/* Is t l, the way along one axis, 0 or a normal number with all its bits? */
SGT_INLINE mask is_whole_way(double t, double l)
{
    return MASK(t == 0) | MASK(l == 0) | (MASK(fabs(t * l) > TINY) & MASK(fabs(t * l) < HUGE_VAL));
}

SGT_KERNEL
static void points_of(slope_block *b, size_t n, const sgt_rays *rays, const double *restrict t,
                      const double *restrict t_lo)
{
    const double *ox = rays->o[0], *oy = rays->o[1], *oz = rays->o[2], *dx = rays->d[0], *dy = rays->d[1],
                 *dz = rays->d[2];
    LANES for (size_t i = 0; i < n; i++) {
        sgt_vec3 d = {dx[i], dy[i], dz[i]};
        double scale = scale_of(d), inverse = inverse_of_scale(d), from = t[i] * inverse,
               rest = t_lo[i] * inverse;
        double l = d.x * scale, m = d.y * scale, r = d.z * scale;
        mask met = MASK(fabs(from) < HUGE_VAL) & MASK(fabs(rest) < HUGE_VAL),
             whole = MASK(l * inverse == d.x) & MASK(m * inverse == d.y) & MASK(r * inverse == d.z) &
                     MASK(from * scale == t[i]) & MASK(rest * scale == t_lo[i]);
        from = chosen(met, from, 0), rest = chosen(met, rest, 0);
        b->x[i] = coordinate(ox[i], l, from, rest).hi;
        b->y[i] = coordinate(oy[i], m, from, rest).hi;
        b->z[i] = coordinate(oz[i], r, from, rest).hi;
        b->tau_lo[i] = rest;
        mask fine = is_whole_way(from, l) & is_whole_way(from, m) & is_whole_way(from, r) &
                    is_whole_way(rest, l) & is_whole_way(rest, m) & is_whole_way(rest, r);
        b->fine[i] = chosen(fine & met & whole, 1, 0);
    }
}

/* Is the k-th hit proven?  If so, sets its t_err and p_err as sgt_unique_by_slope says.  steep: as in
 * sgt_shared, of a part of the surface that holds the point. */
static bool proven_by(const slope_block *b, size_t i, double steep, const sgt_tile *tile, size_t k,
                      double rim2)
{
    const sgt_hits *h = &tile->hits;
    sgt_vec3 d = {tile->rays.d[0][k], tile->rays.d[1][k], tile->rays.d[2][k]};
    double scale = scale_of(d), x = b->x[i], y = b->y[i], z = b->z[i], far = fabs(x) + fabs(y) + fabs(z),
           t = h->t[k];
    double moved = SGT_U * (steep * (fabs(x) + fabs(y)) + fabs(z)) +
                   0x1p-100 * (1 + steep) * fabs(b->tau_lo[i]);
    double e = (fabs(b->f[i]) + 1.01 * (b->own[i] + moved)) / b->least[i] * (1 + 8 * SGT_U);
    double t_err = larger(h->t_err[k], (fabs(h->t_lo[k]) + e * scale) * (1 + 8 * SGT_U));
    double px = h->p[0][k], py = h->p[1][k], pz = h->p[2][k];
    double p_err = (fabs(px - x) + fabs(py - y) + fabs(pz - z) +
                    (fabs(d.x) + fabs(d.y) + fabs(d.z)) * scale * e + 1.01 * SGT_U * far) *
                   (1 + 8 * SGT_U);
    p_err = larger(h->p_err[k], p_err);
    double r2 = px * px + py * py,
           hidden = 1.01 * ((2 * (fabs(px) + fabs(py)) + p_err) * p_err + 4 * SGT_U * r2);
    bool inside = !(rim2 < HUGE_VAL) || rim2 - r2 > hidden;
    if (!(h->status[k] == SGT_HIT && b->least[i] > 0 && inside && t - t_err > b->lo[i] &&
          t + t_err < b->hi[i]))
        return false;
    h->t_err[k] = t_err, h->p_err[k] = p_err;
    return true;
}

/* F at the points of the block, and its rounding.  noise: NULL, or rows as values_rounded of builtin.h has
 * them. */
static void look(slope_block *b, sgt_surface s, const sgt_shared *shared, const double *const noise[3],
                 size_t n)
{
    const struct sgt_builtin_ops *builtin = s.ops->own_;
    sgt_points p = {{b->x, b->y, b->z}};
    sgt_values at = {b->f, {b->gx, b->gy, b->gz}};
    if (noise && builtin->values_rounded) {
        sgt_shared bare = bare_of(*shared);
        if (builtin->values_rounded(s.self, &bare, noise, n, p, at, b->own)) return;
    }
    s.ops->values(s.self, n, p, at);
    if (!builtin->roundings || !builtin->roundings(s.self, shared, n, p, b->f, b->own))
        for (size_t i = 0; i < n; i++) b->own[i] = (double)NAN;
}

/* Asks for the rounding at a point by itself, where there is no bound for many at once. */
static void round_one(slope_block *b, sgt_surface s, size_t i)
{
    if (!(b->own[i] >= 0)) b->own[i] = s.ops->rounding(s.self, (sgt_vec3){b->x[i], b->y[i], b->z[i]});
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
        builtin->spans(s.self, &shared, n, rays, (sgt_spans){b.lo, b.hi, b.seed, NULL}, b.least);
        points_of(&b, n, &rays, tile->hits.t + from, tile->hits.t_lo + from);
        look(&b, s, &shared, NULL, n);
        for (size_t i = 0; i < n; i++) {
            size_t k = from + i;
            if (tile->hits.status[k] != SGT_HIT || !(b.least[i] > 0)) continue;
            round_one(&b, s, i);
            proven[k] = proven_by(&b, i, shared.steep, tile, k, own_rim2);
            count += proven[k];
            if (proven[k]) tile->hits.evals[k]++;
        }
    }
    return count;
}

bool sgt_meet_by_slope(sgt_surface s, const sgt_ray *ray, double rim2, const sgt_options *opt, sgt_hit *hit)
{
    sgt_options plain = *opt;
    plain.proof = SGT_ESTIMATE, plain.f_tol = 0;
    hit->evals = 0;
    if (!parameters_valid(s) || !ray_valid(ray) || !rim_in_range(rim2_of_surface(s))) return false;
    *hit = sgt_search_first(s, ray, &plain);
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

/* -------------------------------------------------------------- one ray and batches */

/* An estimate with more evaluations than that is not proven here. */
enum { QUICK = 64 };

/* Rays that are to be proven: a tile of at most BLOCK, answered without a proof.  All arrays of its hits are
 * there. */
typedef struct quick_proof {
    sgt_surface s;
    const sgt_shared *shared;
    const sgt_tile *tile;
    double rim2, budget;
    tally *told;           /* of the only ray, if it has a watcher; else NULL */
    vicinities *kept;      /* NULL: nothing but the whole chord is asked */
    slopes_known *near;    /* NULL: the first root is wanted */
    slope_block b;
    row t, rest;           /* where F is looked at */
    row steep;             /* as in sgt_shared, of a part of the surface that holds that point */
    bool parts;            /* some are asked */
    row asked;             /* 1: the part of a chord that sgt_vicinity_of gives is taken, if it gives one */
    row noise[3];          /* of these rays */
    double work[VICINITY_ROWS][BLOCK];
} quick_proof;

bool sgt_quick_proof_offered(sgt_surface s, const sgt_options *opt)
{
    const sgt_surface_ops *ops = s.ops;
    return opt->proof != SGT_ESTIMATE && is_catalogue(ops) && ops->own_->share && ops->own_->spans &&
           ops->values && ops->rounding && parameters_valid(s) && rim_in_range(rim2_of_surface(s)) &&
           !(ops->own_->jumps && ops->own_->jumps(s.self));
}

sgt_options sgt_quick_estimate(const sgt_options *opt)
{
    sgt_options own = *opt;
    own.proof = SGT_ESTIMATE, own.f_tol = 0;
    own.max_evals = opt->max_evals && opt->max_evals < QUICK ? opt->max_evals : QUICK;
    return own;
}

/* What is left of the chord between the ends of the ray. */
static sgt_interval left_of(const quick_proof *w, size_t i)
{
    double lo = w->b.lo[i], hi = w->b.hi[i], tmin = w->tile->rays.tmin[i], tmax = w->tile->rays.tmax[i];
    tmax += 0x1p-44 * fabs(tmax); /* a computed t may still be tmax */
    return (sgt_interval){lo > tmin ? lo : tmin, hi < tmax ? hi : tmax};
}

/* Looks at F: at the hits; of a miss where the chord begins, or ends. */
static void look_along(quick_proof *w, bool ends)
{
    const sgt_hits *h = &w->tile->hits;
    const sgt_rays *r = &w->tile->rays;
    size_t n = w->tile->n;
    for (size_t i = 0; i < n; i++) {
        sgt_interval left = left_of(w, i);
        bool met = h->status[i] > 0;
        w->t[i] = met ? h->t[i] : ends ? left.hi : left.lo, w->rest[i] = met ? h->t_lo[i] : 0;
    }
    points_of(&w->b, n, r, w->t, w->rest);
    const double *rows[3] = {w->noise[0], w->noise[1], w->noise[2]};
    look(&w->b, w->s, w->shared, w->parts && !(w->shared->noise[0] < HUGE_VAL) ? rows : NULL, n);
}

/* Takes a part of the chord for the rays that have no bound on the slope along the whole of it. */
static void take_parts(quick_proof *w)
{
    slope_block *b = &w->b;
    const sgt_rays *r = &w->tile->rays;
    const sgt_hits *h = &w->tile->hits;
    size_t n = w->tile->n;
    double *evals = w->t, *begun = w->rest, some = 0; /* rows that are free as yet */
    bool chords = !w->near && marches_chord(w->shared);
    for (size_t i = 0; i < n; i++) w->steep[i] = w->shared->steep, w->asked[i] = 0;
    for (size_t i = 0; i < n && w->kept; i++) {
        if (b->least[i] > 0 || b->lo[i] > b->hi[i]) continue;
        if (chords) b->seed[i] = chord_seed(b->seed[i], b->lo[i], b->hi[i], r->tmin[i], r->tmax[i]);
        bool open = (h->status[i] == SGT_HIT || h->status[i] == SGT_MISS) && fabs(b->seed[i]) < HUGE_VAL;
        w->asked[i] = open ? 1 : 0, some += w->asked[i];
    }
    w->parts = some > 0;
    if (!w->parts) return;
    row left;
    for (size_t i = 0; i < n; i++) {
        w->noise[0][i] = w->noise[1][i] = w->noise[2][i] = (double)NAN;
        evals[i] = begun[i] = h->evals[i];
    }
    memcpy(left, w->asked, sizeof left);
    vicinity v = {.tmin = r->tmin, .tmax = r->tmax, .seed = b->seed, .asked = left, .lo = b->lo, .hi = b->hi,
                  .least = b->least, .noise = {w->noise[0], w->noise[1], w->noise[2]}, .evals = evals,
                  .budget = w->budget, .begun = begun, .told = w->told};
    for (int k = 0; k < VICINITY_ROWS; k++) v.work[k] = w->work[k];
    sgt_vicinity_of(w->s, n, *r, w->near, w->shared, w->kept, &v);
    for (size_t i = 0; i < n; i++) {
        if (w->asked[i] == 0) { /* as if it had been by itself */
            w->noise[0][i] = w->noise[1][i] = w->noise[2][i] = (double)NAN;
            continue;
        }
        h->evals[i] = (int)evals[i];
        if (left[i] != 0) b->least[i] = 0, b->lo[i] = -HUGE_VAL, b->hi[i] = HUGE_VAL;
        else if (b->lo[i] <= b->hi[i] && !(w->steep[i] < HUGE_VAL))
            w->steep[i] = sgt_steep_about(w->s, h->p[0][i], h->p[1][i], w->kept);
    }
}

/* The sign of F where it was looked at; 0 if that is not certain. */
static double sign_there(const quick_proof *w, size_t i)
{
    const slope_block *b = &w->b;
    double x = fabs(b->x[i]), y = fabs(b->y[i]), z = fabs(b->z[i]), steep = w->steep[i],
           err = b->own[i] + SGT_U * (steep * (x + y) + z) + 0x1p-100 * (1 + steep) * fabs(b->tau_lo[i]);
    return b->fine[i] > 0 && err >= 0 ? sign_of(b->f[i], 1.01 * err) : 0;
}

static bool certainly_accepted(const quick_proof *w, size_t i)
{
    const sgt_hits *h = &w->tile->hits;
    sgt_ray ray = ray_of(&w->tile->rays, i);
    sgt_hit hit = {.t = h->t[i], .t_err = h->t_err[i], .p = {h->p[0][i], h->p[1][i], h->p[2][i]},
                   .n = {h->n[0][i], h->n[1][i], h->n[2][i]}};
    return hit.t_err < HUGE_VAL && h->p_err[i] < HUGE_VAL && !near_an_end(&ray, &hit);
}

static void tell_look(const quick_proof *w, size_t i)
{
    const slope_block *b = &w->b;
    sgt_vec3 d = {w->tile->rays.d[0][i], w->tile->rays.d[1][i], w->tile->rays.d[2][i]};
    if (!w->told || w->told->stopped) return;
    tell(w->told, SGT_PROBE, w->t[i] + w->rest[i], b->f[i],
         b->gx[i] * d.x + b->gy[i] * d.y + b->gz[i] * d.z, b->lo[i], b->hi[i]);
}

/* A part far out may be so steep, and F be known so little there, that enclosures know t far better: a bound
 * on t_err beside t and the root's coordinates. */
static const double TOO_WIDE = 0x1p-40;

/* Does the look prove the answer? */
static bool is_proven(const quick_proof *w, size_t i, bool ends)
{
    const sgt_hits *h = &w->tile->hits;
    const slope_block *b = &w->b;
    sgt_vec3 d = {w->tile->rays.d[0][i], w->tile->rays.d[1][i], w->tile->rays.d[2][i]};
    double n = d.z, far = fabs(b->x[i]) + fabs(b->y[i]) + fabs(b->z[i]),
           most = TOO_WIDE * (fabs(h->t[i]) + far * scale_of(d));
    if (h->status[i] > 0)
        return b->fine[i] > 0 && proven_by(b, i, w->steep[i], w->tile, i, w->rim2) &&
               (w->asked[i] == 0 || h->t_err[i] <= most) && certainly_accepted(w, i);
    return sign_there(w, i) * (ends ? -n : n) > 0;
}

/* Makes the rays that are not proven SGT_HARD, and returns how many are. */
static size_t prove_tile(quick_proof *w)
{
    const sgt_hits *h = &w->tile->hits;
    const slope_block *b = &w->b;
    size_t n = w->tile->n, hard = 0, open = 0;
    bool asks[BLOCK];
    w->s.ops->own_->spans(w->s.self, w->shared, n, w->tile->rays,
                          (sgt_spans){w->b.lo, w->b.hi, w->b.seed, NULL}, w->b.least);
    take_parts(w);
    for (size_t i = 0; i < n; i++) {
        sgt_interval left = left_of(w, i);
        bool missed = h->status[i] == SGT_MISS, one = b->least[i] > 0 && !(missed && w->asked[i] != 0),
             passes = missed && (b->lo[i] > b->hi[i] || (one && left.lo > left.hi));
        asks[i] = one && !passes && (missed || h->status[i] == SGT_HIT) && h->evals[i] + 2 <= w->budget;
        open += asks[i];
        if (!asks[i] && !passes) h->status[i] = SGT_HARD, hard++;
    }
    for (int ends = 0; ends < 2 && open > 0; ends++) {
        look_along(w, ends);
        for (size_t i = 0; i < n; i++) {
            if (!asks[i]) continue;
            round_one(&w->b, w->s, i);
            tell_look(w, i);
            h->evals[i]++;
            bool proven = is_proven(w, i, ends);
            if (!proven && !ends && h->status[i] == SGT_MISS) continue;
            asks[i] = false, open--;
            if (!proven) h->status[i] = SGT_HARD, hard++;
        }
    }
    return hard;
}

/* May a part of a chord prove what is asked?  It says nothing of the roots beyond. */
static bool takes_parts(sgt_surface s, const sgt_options *opt)
{
    return !asks_unique(opt) && s.ops->own_->extent_within;
}

static void quick_proof_of(quick_proof *w, sgt_surface s, const sgt_shared *shared, const sgt_tile *tile,
                           memo *known, const sgt_options *opt)
{
    w->s = s, w->shared = shared, w->tile = tile, w->told = NULL, w->rim2 = rim2_of_surface(s);
    w->kept = known ? &known->kept : NULL;
    w->near = known && opt->pick == SGT_NEAR_SEED ? &known->near : NULL;
    w->budget = opt->max_evals ? opt->max_evals : SGT_DEFAULT_EVALS;
}

size_t sgt_quick_prove(sgt_surface s, const sgt_shared *shared, const sgt_tile *tile, const sgt_options *opt)
{
    quick_proof w;
    quick_proof_of(&w, s, shared, tile, takes_parts(s, opt) ? tile->memo : NULL, opt);
    return prove_tile(&w);
}

void sgt_quick_prove_first(sgt_surface s, const sgt_shared *shared, const sgt_tile *tile,
                           const sgt_options *first, sgt_interval part[])
{
    quick_proof w;
    quick_proof_of(&w, s, shared, tile, tile->memo, first);
    (void)prove_tile(&w);
    for (size_t i = 0; i < tile->n; i++) part[i] = (sgt_interval){w.b.lo[i], w.b.hi[i]};
}

/* Proves *hit, an estimate.  false: it is not proven.  evals are counted on either way.  known: NULL if the
 * whole chord is to be asked.  part: the chord, or the part of it, in which there is one root at most. */
SGT_NOINLINE static bool prove_one(sgt_surface s, const sgt_shared *shared, const sgt_ray *ray,
                                   memo *known, const sgt_options *opt, sgt_hit *hit, sgt_interval *part)
{
    quick_proof w;
    sgt_status status = (sgt_status)hit->status;
    tally told = {.opt = opt, .evals = hit->evals};
    sgt_tile one = {.n = 1, .rays = rays_of(ray),
                    .hits = {.status = &status, .evals = &hit->evals, .t = &hit->t, .t_err = &hit->t_err,
                             .t_lo = &hit->t_lo, .p = {&hit->p.x, &hit->p.y, &hit->p.z},
                             .n = {&hit->n.x, &hit->n.y, &hit->n.z}, .p_err = &hit->p_err}};
    quick_proof_of(&w, s, shared, &one, known, opt);
    if (opt->watch) w.told = &told;
    bool proven = prove_tile(&w) == 0;
    if (told.stopped) *hit = hit_without(SGT_STOPPED, ray, told.evals);
    if (proven && hit->status > 0) {
        sgt_interval about = sgt_about(hit->t, hit->t_err);
        hit->lo = about.lo, hit->hi = about.hi;
    }
    *part = (sgt_interval){w.b.lo[0], w.b.hi[0]};
    return proven || told.stopped;
}

/* known: NULL, no part of the chord is taken; else it may have been begun.  part: as in prove_one. */
static bool quick_proof_by(sgt_surface s, const sgt_ray *ray, const sgt_options *opt, memo *known,
                           sgt_hit *hit, sgt_interval *part)
{
    sgt_shared shared;
    sgt_options estimate = sgt_quick_estimate(opt);
    double least = 0;
    s.ops->own_->share(s.self, &shared);
    sgt_span span = s.ops->own_->span(s.self, &shared, ray, &least);
    hit->evals = 0;
    bool whole = least > 0 || span.lo > span.hi;
    if (!(whole || known)) return false;
    if (known && !known->begun) memo_begin(known);
    *hit = sgt_search_quickly(s, ray, &estimate, known ? &known->kept : NULL);
    if (hit->status == SGT_STOPPED) return true;
    return prove_one(s, &shared, ray, whole ? NULL : known, opt, hit, part);
}

/* A watcher of the way back, whose evaluations are counted on from `before`. */
typedef struct watching_back { const sgt_options *opt; int before; } watching_back;

static int watch_back(void *data, const sgt_step *step)
{
    const watching_back *b = data;
    sgt_step own = *step;
    own.eval += b->before, own.t = -step->t, own.lo = -step->hi, own.hi = -step->lo;
    own.slope = -step->slope, own.slope_lo = -step->slope_hi, own.slope_hi = -step->slope_lo;
    return b->opt->watch(b->opt->watch_data, &own);
}

/* true: *hit, the first root, is the only one, or UNPROVEN as there is another, or STOPPED. */
static bool judge_last(sgt_surface s, const sgt_ray *ray, const sgt_options *first, memo *known,
                       double beyond, sgt_interval part, sgt_hit *hit)
{
    const sgt_ray back = way_back(ray, beyond, hit->t, part);
    sgt_options own = *first;
    watching_back told = {first, hit->evals};
    sgt_hit last;
    sgt_interval other;
    if (first->watch) own.watch = watch_back, own.watch_data = &told;
    own.max_evals = FOR_BACK;
    if (!leaves_enough(first, hit->evals) || isnan(back.tmin)) return false;
    const bool proven = quick_proof_by(s, &back, &own, known, &last, &other);
    hit->evals += last.evals;
    if (last.status == SGT_STOPPED) {
        *hit = hit_without(SGT_STOPPED, ray, hit->evals);
        return true;
    }
    if (!proven || last.status <= 0) return false;
    const other_end end = other_end_of(part, (sgt_interval){last.lo, last.hi}, ray->tmax);
    if (end == ANOTHER) *hit = hit_undecided(SGT_UNPROVEN, ray, hit->evals, hit->lo, -last.lo);
    return end != NOT_KNOWN;
}

/* As sgt_quick_proof_one, of the only root, by parts. */
static bool quick_proof_unique(sgt_surface s, const sgt_ray *ray, const sgt_options *opt, memo *known,
                               sgt_hit *hit)
{
    sgt_options first = *opt;
    sgt_interval part;
    sgt_span span;
    first.pick = SGT_FIRST;
    hit->evals = 0;
    if (!sgt_proof_bounds(s, ray, &span)) {
        *hit = hit_without(SGT_MISS, ray, 0);
        return true;
    }
    return span.hi < HUGE_VAL && quick_proof_by(s, ray, &first, known, hit, &part) &&
           (hit->status <= 0 || judge_last(s, ray, &first, known, span.hi, part, hit));
}

bool sgt_quick_proof_kept(sgt_surface s, const sgt_ray *ray, const sgt_options *opt, memo *known,
                          sgt_hit *hit)
{
    sgt_interval part;
    if (quick_proof_by(s, ray, opt, takes_parts(s, opt) ? known : NULL, hit, &part)) return true;
    return asks_unique(opt) && s.ops->own_->extent_within && hit->evals == 0 &&
           quick_proof_unique(s, ray, opt, known, hit);
}

bool sgt_quick_proof_one(sgt_surface s, const sgt_ray *ray, const sgt_options *opt, sgt_hit *hit)
{
    memo known;
    known.begun = false;
    return sgt_quick_proof_kept(s, ray, opt, &known, hit);
}

bool sgt_quick_proof_only(sgt_surface s, const sgt_ray *ray, const sgt_options *opt, sgt_hit *hit)
{
    sgt_interval part;
    return quick_proof_by(s, ray, opt, NULL, hit, &part);
}
