/* unique.h - is the root that was met the only one? */
#ifndef SGT_RAY_UNIQUE_H
#define SGT_RAY_UNIQUE_H
#include "../surface/builtin.h"

/* *hit is positive, proven to be a root (SGT_PROVE_ROOT), of SGT_NEAR_SEED.  It stays as it is where no
 * other root that counts lies on the ray within r^2 <= rim2 (HUGE_VAL: anywhere); else it is UNPROVEN, [lo,
 * hi] about all of them.  One that was UNPROVEN before stays so, with such a stretch. */
void sgt_prove_unique(sgt_surface s, const sgt_ray *ray, double rim2, const sgt_options *opt, sgt_hit *hit);

/* Of a tile, at once, what is certain: as sgt_builtin_ops's alone. */
bool sgt_unique_tile(sgt_surface s, const sgt_tile *tile, double rim2, unsigned long long unique[],
                     sgt_interval others[]);

/* The root near the seed, proven to be the only one within r^2 <= rim2 by one evaluation more than an
 * estimate takes; false: it is not, and hit->evals evaluations have been spent.  A search that was stopped
 * is true. */
bool sgt_meet_by_slope(sgt_surface s, const sgt_ray *ray, double rim2, const sgt_options *opt, sgt_hit *hit);

/* The same of hits that a tile was answered with without a proof, tmin and tmax apart: proven[i], and how
 * many.  Of these t_err, p_err and evals are then as a proof has them; status, t, t_lo and p are read, and
 * all have to be there. */
size_t sgt_unique_by_slope(sgt_surface s, const sgt_tile *tile, double rim2, bool proven[]);

/* Of at most SGT_FEW rays that were met near the seed, at hits.p, which is all that is read of the hits:
 * none[i] is all bits set where certainly no other root that counts lies as near to the axis as that one, or
 * nearer, else 0. kept: what is known of the surface within some radii; radius 0: nothing. */
enum { SGT_FEW = 8, SGT_EXTENTS = 4 };
typedef struct sgt_extents { double radius2[SGT_EXTENTS]; sgt_extent of[SGT_EXTENTS]; } sgt_extents;
void sgt_none_nearer(sgt_surface s, const sgt_tile *tile, sgt_extents *kept, unsigned long long none[]);

/* Does the proof ask for it? */
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
