// SPDX-License-Identifier: MIT
/* only_batch.c - the only root near the seed, proven for a tile of rays that have no bound on the slope all
 * along their chords: THE ONLY ROOT of by_slope.c, in loops.  Each ray gets the answer that it gets alone, or
 * is left SGT_HARD. */
#include "batch.h"
#include "general.h"
#include "only.h"
#include "proof.h"
#include "vicinity.h"

/* The way back of some rays of a tile, and what is found on it. */
enum { FEW_BACK = 32 };
typedef double back_row[FEW_BACK];
typedef struct ways_back {
    back_row d[3], tmin, tmax, t, t_err, t_lo, p[3], n[3], p_err;
    int evals[FEW_BACK];
    sgt_status status[FEW_BACK];
} ways_back;

/* The first roots of a tile.  Rays for which none is proven, nor that there is none, become SGT_HARD. */
static void find_firsts(sgt_surface s, const sgt_shared *shared, const sgt_tile *tile,
                        const sgt_options *first, sgt_interval part[])
{
    const sgt_options estimate = sgt_quick_estimate(first);
    if (sgt_lanes_general(s, tile, &estimate) < tile->n) sgt_quick_prove_first(s, shared, tile, first, part);
    else memset(tile->hits.status, SGT_HARD, tile->n * sizeof *tile->hits.status);
}

static sgt_hit found_of(const sgt_hits *h, size_t i)
{
    const sgt_interval about = sgt_about(h->t[i], h->t_err[i]);
    return (sgt_hit){.status = h->status[i], .evals = h->evals[i], .t = h->t[i], .t_err = h->t_err[i],
                     .t_lo = h->t_lo[i], .lo = about.lo, .hi = about.hi, .p_err = h->p_err[i],
                     .p = {h->p[0][i], h->p[1][i], h->p[2][i]}, .n = {h->n[0][i], h->n[1][i], h->n[2][i]}};
}

/* Of at most FEW_BACK rays.  A ray that is already SGT_HARD, or missed, goes the way back as well, from its
 * own origin: what is found is not read. */
static void unique_of_few(sgt_surface s, const sgt_shared *shared, const sgt_tile *tile,
                          const sgt_options *opt)
{
    ways_back w;
    sgt_interval part[FEW_BACK], other[FEW_BACK];
    bool back[FEW_BACK], any = false;
    const sgt_hits *h = &tile->hits;
    sgt_options first = *opt;
    first.pick = SGT_FIRST;
    find_firsts(s, shared, tile, &first, part);
    for (size_t i = 0; i < tile->n; i++) {
        sgt_span span;
        const sgt_ray ray = ray_of(&tile->rays, i);
        const bool there = sgt_proof_bounds_by(s, &ray, &tile->memo->kept.tails, &span);
        back[i] = false, w.tmin[i] = w.tmax[i] = 0;
        w.d[0][i] = -ray.d.x, w.d[1][i] = -ray.d.y, w.d[2][i] = -ray.d.z;
        if (!there) {
            const sgt_hit none = hit_without(SGT_MISS, &ray, 0);
            put_hit(h, i, &none);
        } else if (!(span.hi < HUGE_VAL)) {
            h->status[i] = SGT_HARD;
        } else if (h->status[i] == SGT_HIT) {
            const sgt_ray way = way_back(&ray, span.hi, h->t[i], part[i]);
            back[i] = leaves_enough(opt, h->evals[i]) && !isnan(way.tmin);
            if (back[i]) any = true, w.tmin[i] = way.tmin, w.tmax[i] = way.tmax;
            else h->status[i] = SGT_HARD;
        }
    }
    if (!any) return;
    const sgt_tile behind = {
        .n = tile->n, .t_tol = tile->t_tol, .memo = tile->memo,
        .rays = {.d = {w.d[0], w.d[1], w.d[2]}, .tmin = w.tmin, .tmax = w.tmax,
                 .o = {tile->rays.o[0], tile->rays.o[1], tile->rays.o[2]}},
        .hits = {.status = w.status, .evals = w.evals, .t = w.t, .t_err = w.t_err, .t_lo = w.t_lo,
                 .p = {w.p[0], w.p[1], w.p[2]}, .n = {w.n[0], w.n[1], w.n[2]}, .p_err = w.p_err}};
    first.max_evals = FOR_BACK;
    find_firsts(s, shared, &behind, &first, other);
    for (size_t i = 0; i < tile->n; i++) {
        if (!back[i]) continue;
        const sgt_ray ray = ray_of(&tile->rays, i);
        const sgt_hit last = found_of(&behind.hits, i);
        sgt_hit hit = found_of(h, i);
        const other_end end = last.status == SGT_HIT
                                  ? other_end_of(part[i], (sgt_interval){last.lo, last.hi}, ray.tmax)
                                  : NOT_KNOWN;
        hit.evals += last.evals;
        if (end == ANOTHER) hit = hit_undecided(SGT_UNPROVEN, &ray, hit.evals, hit.lo, -last.lo);
        if (end == NOT_KNOWN) hit.status = SGT_HARD;
        put_hit(h, i, &hit);
    }
}

bool sgt_asks_quick_unique(sgt_surface s, const sgt_shared *shared, const sgt_tile *tile,
                           const sgt_options *opt)
{
    double lo[SGT_QUICK], hi[SGT_QUICK], seed[SGT_QUICK], least[SGT_QUICK];
    bool none = asks_unique(opt) && s.ops->own_->extent_within;
    if (!none) return false;
    s.ops->own_->spans(s.self, shared, tile->n, tile->rays, (sgt_spans){lo, hi, seed, NULL}, least);
    for (size_t i = 0; i < tile->n; i++) none = none && !(least[i] > 0 || lo[i] > hi[i]);
    return none;
}

size_t sgt_quick_unique(sgt_surface s, const sgt_shared *shared, const sgt_tile *tile, const sgt_options *opt)
{
    size_t hard = 0;
    if (!tile->memo->begun) memo_begin(tile->memo);
    for (size_t from = 0; from < tile->n; from += FEW_BACK) {
        const sgt_tile few = tile_part(tile, from, tile->n - from < FEW_BACK ? tile->n - from : FEW_BACK);
        unique_of_few(s, shared, &few, opt);
    }
    for (size_t i = 0; i < tile->n; i++) hard += tile->hits.status[i] == SGT_HARD;
    return hard;
}
