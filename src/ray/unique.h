// SPDX-License-Identifier: MIT
/* unique.h - is the root that was met the only one?
 *
 * Functions in unique.c, but for those named by_slope and quick, in by_slope.c, or as it is said. */
#ifndef SGT_RAY_UNIQUE_H
#define SGT_RAY_UNIQUE_H
#include "../surface/builtin.h"

/* *hit comes from a search under SGT_NEAR_SEED; if it is positive, it is proven to be a root
 * (SGT_PROVE_ROOT).  It stays as it is if no other accepted root lies on the ray within r^2 <= rim2
 * (HUGE_VAL: anywhere).  Else it becomes UNPROVEN, with [lo, hi] about all the roots.  A hit that was
 * UNPROVEN before stays so, with such a stretch. */
void sgt_prove_unique(sgt_surface s, const sgt_ray *ray, double rim2, const sgt_options *opt, sgt_hit *hit);

/* What is certain at once for a tile, as sgt_builtin_ops.unique of builtin.h says it.  Without that: all
 * bits set for level sets, which have only first roots, and 0 for others. */
bool sgt_unique_tile(sgt_surface s, const sgt_tile *tile, double rim2, unsigned long long unique[],
                     sgt_interval others[]);

/* The root near the seed, proven to be the only one within r^2 <= rim2.  It takes one evaluation more than
 * an estimate. true: *hit is that root, or STOPPED.  false: it is not proven, and hit->evals evaluations
 * have been spent. */
bool sgt_meet_by_slope(sgt_surface s, const sgt_ray *ray, double rim2, const sgt_options *opt, sgt_hit *hit);

/* The same for the hits of a tile that was answered without a proof; its tmin and tmax are not read.  Sets
 * proven[i] and returns how many are.  For these, t_err, p_err and evals become those of a proof.  All of
 * status, t, t_err, t_lo, p, p_err and evals have to be there. */
size_t sgt_unique_by_slope(sgt_surface s, const sgt_tile *tile, double rim2, bool proven[]);

/* QUICK PROOFS, of sags made by departure/departure.c: an estimate, proven where a bound on the slope along
 * the chord, or a part of it, says that it has one root at most.  Are they tried first? */
bool sgt_quick_proof_offered(sgt_surface s, const sgt_options *opt);

/* Of one ray.  true: *hit is the answer, or STOPPED.  false: the ray is left to others, and hit->evals
 * evaluations have been spent.  only: a hit is also the only root on the ray. */
bool sgt_quick_proof_one(sgt_surface s, const sgt_ray *ray, const sgt_options *opt, sgt_hit *hit);
bool sgt_quick_proof_only(sgt_surface s, const sgt_ray *ray, const sgt_options *opt, sgt_hit *hit);

/* As sgt_quick_proof_one, with what a batch keeps of parts of the surface (vicinity.h): the same bits at less
 * cost. */
struct memo;
bool sgt_quick_proof_kept(sgt_surface s, const sgt_ray *ray, const sgt_options *opt, struct memo *known,
                          sgt_hit *hit);

/* Of a tile of at most SGT_QUICK valid rays, answered by sgt_lanes_general under the options of
 * sgt_quick_estimate; each array of its hits is there.  Rays that are not proven become SGT_HARD; returns how
 * many.  shared: what `share` of the surface gives. */
enum { SGT_QUICK = 64 };
size_t sgt_quick_prove(sgt_surface s, const sgt_shared *shared, const sgt_tile *tile, const sgt_options *opt);

sgt_options sgt_quick_estimate(const sgt_options *opt);

/* The same for first roots.  part[i]: the part of the ray in which it is, and no other root. */
void sgt_quick_prove_first(sgt_surface s, const sgt_shared *shared, const sgt_tile *tile,
                           const sgt_options *first, sgt_interval part[]);

/* Is the only root near the seed to be proven, and has no ray of the tile a bound all along its chord?  Then
 * sgt_quick_unique answers it as sgt_quick_proof_one does, without an estimate before.  It returns how many
 * rays are left SGT_HARD.  (only_batch.c) */
bool sgt_asks_quick_unique(sgt_surface s, const sgt_shared *shared, const sgt_tile *tile,
                           const sgt_options *opt);
size_t sgt_quick_unique(sgt_surface s, const sgt_shared *shared, const sgt_tile *tile,
                        const sgt_options *opt);

/* For at most SGT_FEW rays that were met near the seed, at hits.p; nothing else of the hits is read.  Sets
 * none[i] to all bits set if certainly no other accepted root lies as near to the axis as that one, or
 * nearer; else to 0.  kept: what is known of the surface within some radii; an entry with radius2 0 is
 * empty. */
enum { SGT_FEW = 8, SGT_EXTENTS = 4 };
typedef struct sgt_extents { double radius2[SGT_EXTENTS]; sgt_extent of[SGT_EXTENTS]; } sgt_extents;
void sgt_none_nearer(sgt_surface s, const sgt_tile *tile, sgt_extents *kept, unsigned long long none[]);

/* Does the proof ask whether the root is the only one? */
static inline bool asks_unique(const sgt_options *opt)
{
    return opt->proof == SGT_PROVE_FIRST && opt->pick == SGT_NEAR_SEED;
}

/* Is a proof in a trace first tried by the slope? */
static inline bool proves_by_slope(sgt_surface s, const sgt_options *opt)
{
    return opt->proof != SGT_ESTIMATE && opt->pick == SGT_NEAR_SEED && s.ops && is_catalogue(s.ops) &&
           s.ops->own_->share_within;
}

#endif
