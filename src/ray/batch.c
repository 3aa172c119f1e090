// SPDX-License-Identifier: MIT
/* batch.c - many rays and one surface: tiles, and which function answers for them.
 *
 * QUICK, THEN CAREFUL.  A tile of rays is given to the surface's `lanes`, or to sgt_lanes_general.  That
 * is the quick form of the single ray with a loop around it: the same operations on each ray, in the same
 * order, and so the same bits.  It marks these rays as SGT_HARD:
 * - rays that the quick form cannot answer;
 * - rays that are not valid.
 *
 * Hard rays go one by one through sgt_intersect.  So does a ray alone, at once: lanes would cost more.
 *
 * Under SGT_PROVE_FIRST near the seed, a ray that was met may have another root (not_unique).  If it
 * certainly has, it is made UNPROVEN at once.  If it may have, it is hard. */
#include "batch.h"

#include "../num/lanes.h"
#include "../solve/root.h"
#include "../solve/ways.h"
#include "answer.h"
#include "cells_batch.h"
#include "unique.h"
#include "vicinity.h"
#include "general.h"

#include <string.h>

enum { FEW_LEFT = 3 }; /* from so many rays on lanes cost less than single rays */

/* How many statuses are positive, eight at a time.  A status is below 127, so adding 127 to a byte sets
 * its sign bit if the status is positive.  A negative status has its sign bit set already; that bit is
 * masked out. */
static size_t positives(const sgt_status status[], size_t n)
{
    const unsigned long long low = 0x7f7f7f7f7f7f7f7f, ones = 0x0101010101010101;
    size_t sum = 0, i = 0;
    if (n > 0 && status[0] == SGT_HIT && memcmp(status, status + 1, n - 1) == 0) return n; /* all alike */
    for (; i + 8 <= n; i += 8) {
        unsigned long long s;
        memcpy(&s, status + i, 8);
        sum += ((((s & low) + low) & ~s) >> 7 & ones) * ones >> 56;
    }
    for (; i < n; i++) sum += status[i] > 0;
    return sum;
}

/* Sets a[i] to NaN for rays that have another root.  For rays that were not met it is NaN already, or
 * still to be written. */
SGT_KERNEL
static void hide(size_t n, const unsigned long long unique[], double *a)
{
    LANES for (size_t i = 0; i < n; i++) a[i] = chosen(MASK(unique[i] == SGT_NOT_UNIQUE), (double)NAN, a[i]);
}

/* For rays that were met: UNPROVEN if they have another root, SGT_HARD if they may have one.  Returns how
 * many became hard. */
static size_t not_unique(sgt_surface s, const sgt_tile *tile)
{
    unsigned long long unique[SGT_TILE];
    size_t more = 0;
    if (s.ops->own_->unique(s.self, tile, HUGE_VAL, unique, NULL)) return 0;
    bool others = false;
    for (size_t i = 0; i < tile->n; i++) {
        if (!(tile->hits.status[i] > 0)) continue;
        if (!unique[i]) tile->hits.status[i] = SGT_HARD, more++;
        if (unique[i] == SGT_NOT_UNIQUE) tile->hits.status[i] = SGT_UNPROVEN, others = true;
    }
    if (others) {
        const sgt_hits *h = &tile->hits;
        double *const arrays[] = {h->t,    h->t_err, h->t_lo, h->p_err, h->p[0],
                                  h->p[1], h->p[2],  h->n[0], h->n[1],  h->n[2]};
        for (size_t k = 0; k < sizeof arrays / sizeof arrays[0]; k++)
            if (arrays[k]) hide(tile->n, unique, arrays[k]);
    }
    return more;
}

/* Runs of at least `least` rays with that status go through the quick form in lanes.  Returns how many rays
 * of the tile are then hard. */
static size_t runs_of(sgt_surface s, const sgt_tile *tile, const sgt_options *opt, size_t hard, sgt_status of,
                      size_t least)
{
    for (size_t i = 0, n; i < tile->n; i += n) {
        n = 1;
        if (tile->hits.status[i] != of) continue;
        while (i + n < tile->n && tile->hits.status[i + n] == of) n++;
        if (n < least) continue;
        sgt_tile run = tile_part(tile, i, n);
        hard -= n - sgt_lanes_general(s, &run, opt);
    }
    return hard;
}

/* By a closed form, and what it leaves in lanes where that is not a ray or two: of these each costs less by
 * itself. */
static size_t by_closed_form(sgt_surface s, const sgt_tile *tile, const sgt_options *opt)
{
    const size_t hard = s.ops->own_->easy(s.self, tile, opt->pick == SGT_NEAR_SEED);
    return hard >= FEW_LEFT ? runs_of(s, tile, opt, hard, SGT_HARD, FEW_LEFT) : hard;
}

/* The first root, by cells. */
static size_t by_cells_in_lanes(sgt_surface s, const sgt_tile *tile, const sgt_options *opt)
{
    size_t hard = sgt_cells_tile(s, tile, opt);
    return hard ? runs_of(s, tile, opt, hard, SGT_SINGLE, 1) : 0;
}

/* Estimates that are proven without enclosures.  Returns how many rays are left SGT_HARD.  (Not in the frame
 * of by_tiles, which is below that of each ray that is left.) */
SGT_NOINLINE static size_t quick_proofs(sgt_surface s, const sgt_tile *tile, const sgt_options *opt)
{
    double x[10][SGT_QUICK];
    sgt_status status[SGT_QUICK];
    int evals[SGT_QUICK];
    sgt_shared shared;
    sgt_options estimate = sgt_quick_estimate(opt);
    size_t hard = 0;
    s.ops->own_->share(s.self, &shared);
    for (size_t from = 0, n; from < tile->n; from += n) {
        size_t most = tile->n - from < SGT_QUICK ? tile->n - from : SGT_QUICK;
        sgt_tile part = tile_part(tile, from, most);
        part.hits = (sgt_hits){.status = status, .evals = evals, .t = x[0], .t_err = x[1], .t_lo = x[2],
                               .p = {x[3], x[4], x[5]}, .n = {x[6], x[7], x[8]}, .p_err = x[9]};
        for (n = 0; n < most; n++) { /* the surface is not given a ray that is not valid */
            sgt_ray ray = ray_of(&part.rays, n);
            if (!ray_valid(&ray)) break;
        }
        part.n = n;
        size_t left = n;
        if (n > 0 && sgt_asks_quick_unique(s, &shared, &part, opt))
            left = sgt_quick_unique(s, &shared, &part, opt);
        else if (n > 0 && sgt_lanes_general(s, &part, &estimate) < n)
            left = sgt_quick_prove(s, &shared, &part, opt);
        if (left < n) {
            hard += left;
            for (size_t i = 0; i < n; i++) {
                sgt_hit hit = {.status = status[i], .evals = evals[i], .t = x[0][i], .t_err = x[1][i],
                               .t_lo = x[2][i], .p = {x[3][i], x[4][i], x[5][i]},
                               .n = {x[6][i], x[7][i], x[8][i]}, .p_err = x[9][i]};
                put_hit(&tile->hits, from + i, &hit);
            }
            continue;
        }
        n = n > 0 ? n : 1;
        memset(tile->hits.status + from, SGT_HARD, n), hard += n;
    }
    return hard;
}

/* Would a single ray ask for parts of the surface?  Then it shares what the tile knows of them. */
static bool takes_kept(sgt_surface s, const sgt_tile *tile, const sgt_options *opt)
{
    return tile->memo && s.ops && s.ops->own_ && is_catalogue(s.ops) && !answers_itself(s.ops) &&
           s.ops->own_->extent_within && !sgt_cells_offered(s, opt) && parameters_valid(s) &&
           rim_in_range(rim2_of_surface(s)) &&
           (opt->proof == SGT_ESTIMATE || sgt_quick_proof_offered(s, opt));
}

/* As sgt_intersect for a ray of such a tile.  (Its f_tol is not read, as in answer.c.) */
static sgt_hit met_with_kept(sgt_surface s, sgt_ray ray, const sgt_options *opt, memo *known)
{
    sgt_options own = *opt;
    own.f_tol = 0, ray.tmax = explicit_end(&ray);
    if (!ray_valid(&ray)) return hit_without(SGT_INVALID, &ray, 0);
    if (opt->proof != SGT_ESTIMATE) return sgt_prove_kept(s, &ray, &own, known);
    return sgt_search_first_kept(s, &ray, &own, &known->kept);
}

/* Answers the hard rays of the tile.  Returns how many of all are met. */
static size_t hard_met(sgt_surface s, const sgt_tile *tile, const sgt_options *opt, size_t hard)
{
    sgt_options own = *opt;
    const bool kept = hard > 0 && takes_kept(s, tile, opt);
    if (kept && !tile->memo->begun) memo_begin(tile->memo);
    for (size_t i = 0; hard > 0; i++) {
        if (tile->hits.status[i] != SGT_HARD) continue;
        own.t_tol = tile->t_tol[i];
        WENT(WAY_SINGLE);
        sgt_hit hit = kept ? met_with_kept(s, ray_of(&tile->rays, i), &own, tile->memo)
                           : sgt_intersect(s, ray_of(&tile->rays, i), &own);
        put_hit(&tile->hits, i, &hit);
        hard--;
    }
    return positives(tile->hits.status, tile->n);
}

static size_t tile_met(sgt_surface s, const sgt_tile *tile, const sgt_options *opt)
{
    size_t hard = tile->n;
    if (s.ops && s.ops->own_ && s.ops->own_->lanes) hard = s.ops->own_->lanes(s.self, tile, opt);
    else if (easy_offered(s, opt)) hard = by_closed_form(s, tile, opt);
    else if (s.ops && s.ops->value && !answers_itself(s.ops))
        hard = (sgt_cells_offered(s, opt) ? by_cells_in_lanes : sgt_lanes_general)(s, tile, opt);
    else memset(tile->hits.status, SGT_HARD, tile->n);
    if (hard < tile->n && s.ops->own_ && s.ops->own_->unique && asks_unique(opt)) hard += not_unique(s, tile);
    return hard_met(s, tile, opt, hard);
}

size_t sgt_intersect_tile(sgt_surface s, const sgt_tile *tile, const sgt_options *opt)
{
    memo known;
    sgt_tile own = *tile;
    known.begun = false;
    own.memo = &known;
    return tile_met(s, &own, opt);
}

int sgt_watch_numbered(void *data, const sgt_step *step)
{
    const numbered *n = data;
    sgt_step own = *step;
    own.ray = n->ray;
    return n->watch(n->data, &own);
}

static size_t one_alone(sgt_surface s, const sgt_rays *rays, const sgt_hits *hits, const sgt_options *opt)
{
    sgt_ray ray = ray_of(rays, 0);
    sgt_hit hit = sgt_intersect_copy(s, &ray, opt);
    put_hit(hits, 0, &hit);
    return hit.status > 0;
}

static size_t one_by_one(sgt_surface s, size_t n, const sgt_rays *rays, const sgt_hits *hits,
                         const sgt_options *opt)
{
    sgt_options own = *opt;
    numbered told = {opt->watch, opt->watch_data, 0};
    if (opt->watch) own.watch = sgt_watch_numbered, own.watch_data = &told;
    size_t met = 0;
    for (size_t i = 0; i < n; i++) {
        told.ray = i;
        sgt_hit hit = sgt_intersect(s, ray_of(rays, i), &own);
        put_hit(hits, i, &hit);
        met += hit.status > 0;
    }
    return met;
}

static void given_ends(size_t n, const double given[], double tmax[])
{
    for (size_t i = 0; i < n; i++) tmax[i] = given_end(given[i]);
}

/* The large frame and the addresses of the arrays are not set up for a ray alone. */
SGT_NOINLINE static size_t by_tiles(sgt_surface s, size_t n, const sgt_rays *rays, const sgt_hits *hits,
                                    const sgt_options *opt)
{
    sgt_status status[SGT_MOST_TILE];
    double tmin[SGT_MOST_TILE], tmax[SGT_MOST_TILE], t_tol[SGT_MOST_TILE];
    size_t met = 0, most = s.ops && s.ops->own_ && s.ops->own_->tile ? s.ops->own_->tile : SGT_TILE;
    bool by_operations = s.ops && s.ops->value && !answers_itself(s.ops),
         cells = by_operations && sgt_cells_offered(s, opt),
         proofs = by_operations && !cells && sgt_quick_proof_offered(s, opt);
    if (cells) most = SGT_MOST_TILE; /* of a short tile's last rays few slots are busy */
    memo known;
    known.begun = false;
    for (size_t i = 0; i < most && i < n; i++) tmin[i] = 0, tmax[i] = HUGE_VAL, t_tol[i] = opt->t_tol;
    for (size_t i = 0; i < n; i += most) {
        sgt_tile tile = {.n = n - i < most ? n - i : most, .t_tol = t_tol, .hits = hits_from(hits, i),
                         .rays = rays_from(rays, i), .memo = &known, .far = n > SGT_FAR};
        tile.rays.tmin = rays->tmin ? rays->tmin + i : tmin, tile.rays.tmax = tmax;
        if (rays->tmax) given_ends(tile.n, rays->tmax + i, tmax);
        if (!tile.hits.status) tile.hits.status = status;
        met += proofs ? hard_met(s, &tile, opt, quick_proofs(s, &tile, opt))
                      : tile_met(s, &tile, opt);
    }
    return met;
}

size_t sgt_intersect_batch(sgt_surface s, size_t n, sgt_rays rays, sgt_hits hits, const sgt_options *opt)
{
    static const sgt_options none = {0};
    if (!opt) opt = &none;
    if (!ROOM_IS_ZERO(&hits)) opt = &sgt_options_invalid;
    if (n == 1) return one_alone(s, &rays, &hits, opt);
    s = in_set(s);
    if (opt->watch || !sgt_options_valid(opt)) return one_by_one(s, n, &rays, &hits, opt);
    return by_tiles(s, n, &rays, &hits, opt);
}
