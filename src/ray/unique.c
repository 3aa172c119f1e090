// SPDX-License-Identifier: MIT
/* ray/unique.c - the root near the seed, proven to be the only one.
 *
 * AT ONCE.  Most often the surface knows (sgt_builtin_ops.unique: a loop over lanes; a single ray is a
 * tile of one). It knows in these cases:
 * - F is monotone along the ray within the rim;
 * - the other root of a conic is on the other sheet, beyond the rim or outside the ray's ends; or that
 *   root is certainly accepted;
 * - no ring of an asphere holds another root.
 *
 * ELSE every root is asked for.  There has to be exactly one, and it has to be decided.  If the clear
 * aperture is narrower than the surface, the ray is cut first:
 *
 *     surface                     the ray is cut to                 roots outside the aperture
 *     with `meet`                 three times its chord with the    skipped, if certainly outside the chord
 *                                 aperture's cylinder, so that no
 *                                 root within is taken for the start
 *     met by its operations       that chord and a part in 2^20     the aperture is the rim: beyond it there
 *                                                                   may be other roots, and the edge of the
 *                                                                   surface's domain
 *
 * NEARER.  A root is outside the clear aperture.  Is there another one inside?  No, if the root is the
 * only one within a radius R of the axis, with R not less than the root's own radius.  R is rounded up so
 * that many rays share it.  It depends on nothing but the root. */
#include "unique.h"

#include "../num/bits.h"
#include "../num/lanes.h"

#include "../surface/sag/sag.h"
#include "answer.h"

enum { FEW = 4 };

bool sgt_unique_tile(sgt_surface s, const sgt_tile *tile, double rim2, unsigned long long unique[],
                     sgt_interval others[])
{
    if (s.ops->own_ && s.ops->own_->unique) return s.ops->own_->unique(s.self, tile, rim2, unique, others);
    bool itself = answers_itself(s.ops);
    /* level sets: the first root was asked for */
    memset(unique, itself ? 0xff : 0, tile->n * sizeof *unique);
    return itself;
}

/* What `unique` says of one ray; 0: nothing is known.  *other is set if there certainly is another root. */
static unsigned long long at_once(sgt_surface s, const sgt_ray *ray, double rim2, sgt_interval *other)
{
    unsigned long long unique;
    sgt_tile one = {.n = 1, .rays = rays_of(ray)};
    sgt_unique_tile(s, &one, rim2, &unique, other);
    return unique;
}

/* A watcher of a second search, whose evaluations are counted on from `before`. */
typedef struct counting { sgt_watch *watch; void *data; int before; } counting;

static int watch_on(void *data, const sgt_step *step)
{
    const counting *c = data;
    sgt_step own = *step;
    own.eval += c->before;
    return c->watch(c->data, &own);
}

void sgt_prove_unique(sgt_surface s, const sgt_ray *ray, double rim2, const sgt_options *opt, sgt_hit *hit)
{
    if (answers_itself(s.ops) && !s.ops->own_->unique) return;
    sgt_interval other;
    unsigned long long known = hit->status > 0 ? at_once(s, ray, rim2, &other) : 0;
    if (known == SGT_NOT_UNIQUE && (other.lo > hit->t || other.hi < hit->t)) {
        double lo = other.lo < hit->lo ? other.lo : hit->lo, hi = other.hi > hit->hi ? other.hi : hit->hi;
        *hit = hit_undecided(SGT_UNPROVEN, ray, hit->evals, lo, hi);
        return;
    }
    if (known && known != SGT_NOT_UNIQUE) return;
    sgt_ray cut = *ray;
    stretch chord = sgt_chord(ray, rim2);
    double more = chord.hi - chord.lo;
    if (!answers_itself(s.ops)) more *= 0x1p-20;
    if (chord.lo - more > cut.tmin) cut.tmin = chord.lo - more;
    if (chord.hi + more < cut.tmax) cut.tmax = chord.hi + more;
    sgt_hit found[FEW], none = hit_without(SGT_UNPROVEN, ray, hit->evals);
    sgt_list list = {.hits = found, .cap = FEW, .count = 0};
    sgt_options own = *opt;
    counting told = {opt->watch, opt->watch_data, hit->evals};
    if (opt->watch) own.watch = watch_on, own.watch_data = &told;
    if (!(cut.tmin < cut.tmax)) {
        *hit = none;
        return;
    }
    if (!answers_itself(s.ops)) { /* proven like a user's surface */
        sgt_hit again = sgt_prove_within(s, &cut, rim2, &own);
        again.evals += hit->evals;
        bool same = again.status > 0 && again.lo <= hit->hi && again.hi >= hit->lo;
        if (again.status == SGT_MISS || (again.status > 0 && !same)) { /* another, or it is on the edge */
            double lo = again.status > 0 && again.lo < hit->lo ? again.lo : hit->lo;
            double hi = again.status > 0 && again.hi > hit->hi ? again.hi : hit->hi;
            *hit = hit_undecided(SGT_UNPROVEN, ray, again.evals, lo, hi);
        } else if (same) {
            hit->evals = again.evals;
        } else {
            *hit = again;
        }
        return;
    }
    own.proof = SGT_PROVE_ROOT;
    s.ops->own_->all(s.self, &cut, &own, &list);
    none.evals += list.evals, hit->evals += list.evals;
    double lo = hit->lo, hi = hit->hi;
    int others = 0, itself = 0;
    for (int i = 0; i < list.count && i < FEW; i++) {
        const sgt_hit *h = &found[i];
        if (h->status == SGT_STOPPED) none.status = SGT_STOPPED;
        double r2 = h->p.x * h->p.x + h->p.y * h->p.y, off = 4 * (fabs(h->p.x) + fabs(h->p.y)) * h->p_err;
        if (h->status != SGT_STOPPED && (h->hi < chord.lo || h->lo > chord.hi)) continue;
        if (h->status > 0 && r2 - off > rim2 * (1 + 0x1p-50)) continue;
        bool same = h->status > 0 && h->lo <= hit->hi && h->hi >= hit->lo;
        itself += same, others += !same;
        if (h->lo < lo) lo = h->lo;
        if (h->hi > hi) hi = h->hi;
    }
    if (hit->status > 0 && itself == 1 && others == 0 && list.count <= FEW) return;
    if (list.count > FEW && list.last.hi > hi) hi = list.last.hi;
    *hit = hit_undecided(none.status, ray, none.evals, lo, hi);
}

/* ------------------------------------------------------------------------------ nearer */

/* R^2: a power of two, above r^2 by more than rounding.  Infinite if r^2 is not in (2^-800, 2^800). */
static double radius2_about(double x, double y)
{
    double r2 = (x * x + y * y) * (1 + 0x1p-20);
    return r2 > 0x1p-800 && r2 < 0x1p800 ? 2 * inverse_of_scale((sgt_vec3){r2, 0, 0}) : HUGE_VAL;
}

static const sgt_extent *extent_about(sgt_surface s, double radius2, sgt_extents *kept)
{
    int power;
    (void)binary_mantissa(radius2, &power);
    size_t k = (unsigned)power % SGT_EXTENTS;
    if (kept->radius2[k] == radius2) return &kept->of[k];
    kept->radius2[k] = radius2;
    s.ops->own_->extent_within(s.self, sqrt(radius2), false, &kept->of[k]);
    return &kept->of[k];
}

void sgt_none_nearer(sgt_surface s, const sgt_tile *tile, sgt_extents *kept, unsigned long long none[])
{
    const struct sgt_builtin_ops *builtin = s.ops->own_;
    size_t n = tile->n;
    double within2[SGT_FEW], radius2[SGT_FEW] = {0}, steep[SGT_FEW] = {0};
    double lo[SGT_FEW], hi[SGT_FEW], least[SGT_FEW];
    memset(none, 0, n * sizeof *none);
    for (size_t i = 0; i < n; i++) within2[i] = radius2_about(tile->hits.p[0][i], tile->hits.p[1][i]);
    if (builtin && is_catalogue(s.ops) && builtin->extent_within) {
        for (size_t i = 0; i < n; i++) {
            static const sgt_extent nothing = SGT_NO_EXTENT;
            const sgt_extent *e = &nothing;
            if (within2[i] < HUGE_VAL) e = extent_about(s, within2[i], kept);
            radius2[i] = e->radius2, steep[i] = e->steep;
        }
        builtin->chords(n, tile->rays, radius2, steep, NULL, lo, hi, least);
        for (size_t i = 0; i < n; i++) none[i] = MASK(least[i] > 0);
    } else if (builtin && builtin->unique) {
        unsigned long long unique[SGT_FEW];
        for (size_t i = 0; i < n; i++) {
            bool asked = false; /* already asked with an earlier ray */
            for (size_t k = 0; k < i; k++) asked = asked || within2[k] == within2[i];
            if (asked) continue;
            builtin->unique(s.self, tile, within2[i], unique, NULL);
            for (size_t k = i; k < n; k++)
                if (within2[k] == within2[i]) none[k] = MASK(unique[k] == ~0ULL);
        }
    }
}
