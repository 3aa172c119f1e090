/* ray/unique.c - the root near the seed, proven to be the only one.
 *
 * Most often the surface knows at once (sgt_own, alone; a loop over lanes, of which one ray is a tile of one): along the ray
 * F is monotone within the rim; the other root of a conic is on the other sheet, beyond the rim or outside the ray's ends, or
 * it certainly counts; no ring of an asphere holds another.  Where it does not, every root is asked for: there has to be
 * one, and it decided.  With a clear aperture narrower than the surface the ray is cut to three times its chord with the
 * aperture's cylinder, so that no root within is taken for the start of what is left, and what is certainly outside of that
 * chord is passed over.  Of a surface that is met by its operations it is cut to that chord and a part in 2^20, and the
 * aperture is its rim: beyond it there may be other roots, and the edge of its domain.
 *
 * BY THE SLOPE.  Within the aperture a sag made by departure/departure.c has |dF/dtau| >= least all along most rays, tau in lengths of the
 * scaled direction.  Then F at one point, in the aperture or next to it, decides everything: there is one root in the chord, within
 * |F| / least of that point.  The point is o + (t + t_lo) d of a hit that nobody has proven, each coordinate right to u of itself, which
 * moves F by no more than the steepest gradient in the aperture times that: nothing is taken to first order.  Two or three calls of the surface for all rays
 * of a tile, where enclosures cost as much as a dozen for each.
 *
 * NEARER.  A root is outside the clear aperture; is there another, inside?  Not where it is the only one
 * within a radius R of the axis that is not less than its own.  R is rounded up, so that many rays share it,
 * and depends on nothing but the root. */
#include "unique.h"

#include "../num/bits.h"
#include "../num/lanes.h"

#include "../surface/sag/sag.h"
#include "general.h"
#include "prove.h"

enum { FEW = 4, BLOCK = 64 };

bool sgt_alone_tile(sgt_surface s, const sgt_tile *tile, double rim2, unsigned long long alone[], sgt_interval others[])
{
    if (s.ops->own_ && s.ops->own_->alone) return s.ops->own_->alone(s.self, tile, rim2, alone, others);
    bool itself = answers_itself(s.ops);
    memset(alone, itself ? 0xff : 0, tile->n * sizeof *alone); /* level sets: the first is what was asked for */
    return itself;
}

/* 0: nothing is known. */
static unsigned long long at_once(sgt_surface s, const sgt_ray *ray, double rim2, sgt_interval *other)
{
    unsigned long long alone;
    sgt_tile one = {.n = 1, .rays = {{&ray->o.x, &ray->o.y, &ray->o.z}, {&ray->d.x, &ray->d.y, &ray->d.z}, &ray->tmin, &ray->tmax}};
    sgt_alone_tile(s, &one, rim2, &alone, other);
    return alone;
}

/* A watcher of a second search, which counts on. */
typedef struct counting { sgt_watch *watch; void *data; int before; } counting;

static int watch_on(void *data, const sgt_step *step)
{
    const counting *c = data;
    sgt_step own = *step;
    own.eval += c->before;
    return c->watch(c->data, &own);
}

void sgt_prove_alone(sgt_surface s, const sgt_ray *ray, double rim2, const sgt_options *opt, sgt_hit *hit)
{
    if (answers_itself(s.ops) && !s.ops->own_->alone) return;
    sgt_interval other;
    unsigned long long known = hit->status > 0 ? at_once(s, ray, rim2, &other) : 0;
    if (known == SGT_NOT_ALONE && (other.lo > hit->t || other.hi < hit->t)) {
        double lo = other.lo < hit->lo ? other.lo : hit->lo, hi = other.hi > hit->hi ? other.hi : hit->hi;
        *hit = hit_undecided(SGT_UNPROVEN, ray, hit->evals, lo, hi);
        return;
    }
    if (known && known != SGT_NOT_ALONE) return;
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
    if (!answers_itself(s.ops)) { /* it is proven as a surface of a user is */
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

/* ------------------------------------------------------------------- by the slope */

typedef double row[BLOCK];

/* What a block of rays is asked. */
typedef struct block { row lo, hi, seed, least, x, y, z, tau_lo, f, own; } block;

SGT_KERNEL
static void points_of(block *b, size_t n, const double *restrict ox, const double *restrict oy, const double *restrict oz, const double *restrict dx,
                      const double *restrict dy, const double *restrict dz, const double *restrict t, const double *restrict t_lo)
{
    LANES for (size_t i = 0; i < n; i++) {
        sgt_vec3 d = {dx[i], dy[i], dz[i]};
        double scale = scale_of(d), inverse = inverse_of_scale(d), from = t[i] * inverse, rest = t_lo[i] * inverse;
        mask met = MASK(fabs(from) < HUGE_VAL) & MASK(fabs(rest) < HUGE_VAL);
        from = chosen(met, from, 0), rest = chosen(met, rest, 0);
        b->x[i] = coordinate(ox[i], dx[i] * scale, from, rest).hi;
        b->y[i] = coordinate(oy[i], dy[i] * scale, from, rest).hi;
        b->z[i] = coordinate(oz[i], dz[i] * scale, from, rest).hi;
        b->tau_lo[i] = rest;
    }
}

/* t_err and p_err of a hit that is proven, as sgt_alone_by_slope says. */
static bool proven_by(const block *b, size_t i, const sgt_shared *shared, const sgt_tile *tile, size_t k, double rim2)
{
    const sgt_hits *h = &tile->hits;
    sgt_vec3 d = {tile->rays.d[0][k], tile->rays.d[1][k], tile->rays.d[2][k]};
    double scale = scale_of(d), x = b->x[i], y = b->y[i], z = b->z[i], far = fabs(x) + fabs(y) + fabs(z), t = h->t[k];
    double moved = SGT_U * (shared->steep * (fabs(x) + fabs(y)) + fabs(z)) + 0x1p-100 * (1 + shared->steep) * fabs(b->tau_lo[i]);
    double e = (fabs(b->f[i]) + 1.01 * (b->own[i] + moved)) / b->least[i] * (1 + 8 * SGT_U);
    double t_err = larger(h->t_err[k], (fabs(h->t_lo[k]) + e * scale) * (1 + 8 * SGT_U));
    double px = h->p[0][k], py = h->p[1][k], pz = h->p[2][k];
    double p_err = (fabs(px - x) + fabs(py - y) + fabs(pz - z) + (fabs(d.x) + fabs(d.y) + fabs(d.z)) * scale * e + 1.01 * SGT_U * far) * (1 + 8 * SGT_U);
    double r2 = px * px + py * py, hidden = 1.01 * ((2 * (fabs(px) + fabs(py)) + p_err) * p_err + 4 * SGT_U * r2);
    bool inside = !(rim2 < HUGE_VAL) || rim2 - r2 > hidden;
    if (!(h->status[k] == SGT_HIT && b->least[i] > 0 && inside && t - t_err > b->lo[i] && t + t_err < b->hi[i])) return false;
    h->t_err[k] = t_err, h->p_err[k] = larger(h->p_err[k], p_err);
    h->evals[k]++;
    return true;
}

size_t sgt_alone_by_slope(sgt_surface s, const sgt_tile *tile, double rim2, bool proven[])
{
    const struct sgt_own *own = s.ops->own_;
    size_t count = 0;
    memset(proven, 0, tile->n * sizeof *proven);
    if (!is_catalogue(s.ops) || !own->share_within || !own->spans) return 0;
    /* None was met: perhaps the parameters are invalid, and nothing is to be asked of them. */
    size_t first = 0;
    while (first < tile->n && tile->hits.status[first] != SGT_HIT) first++;
    if (first == tile->n) return 0;
    sgt_shared shared;
    block b;
    own->share_within(s.self, sqrt(rim2), &shared);
    double own_rim2 = rim2_of_surface(s);
    for (size_t from = 0, n; from < tile->n; from += n) {
        n = tile->n - from < BLOCK ? tile->n - from : BLOCK;
        const sgt_rays *r = &tile->rays;
        sgt_rays rays = {.o = {r->o[0] + from, r->o[1] + from, r->o[2] + from}, .d = {r->d[0] + from, r->d[1] + from, r->d[2] + from}};
        sgt_points p = {{b.x, b.y, b.z}};
        own->spans(s.self, &shared, n, rays, (sgt_spans){b.lo, b.hi, b.seed, NULL}, b.least);
        points_of(&b, n, rays.o[0], rays.o[1], rays.o[2], rays.d[0], rays.d[1], rays.d[2], tile->hits.t + from, tile->hits.t_lo + from);
        s.ops->values(s.self, n, p, (sgt_values){.f = b.f});
        bool all = own->roundings && own->roundings(s.self, &shared, n, p, b.f, b.own);
        for (size_t i = 0; i < n; i++) {
            size_t k = from + i;
            if (tile->hits.status[k] != SGT_HIT || !(b.least[i] > 0)) continue;
            if (!all || !(b.own[i] >= 0)) b.own[i] = s.ops->rounding(s.self, (sgt_vec3){b.x[i], b.y[i], b.z[i]});
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
    signed char status = SGT_HIT;
    bool proven;
    sgt_tile one = {.n = 1, .rays = {{&ray->o.x, &ray->o.y, &ray->o.z}, {&ray->d.x, &ray->d.y, &ray->d.z}, &ray->tmin, &ray->tmax},
                    .hits = {.status = &status, .evals = &hit->evals, .t = &hit->t, .t_err = &hit->t_err, .t_lo = &hit->t_lo, .p = {&hit->p.x, &hit->p.y, &hit->p.z}, .p_err = &hit->p_err}};
    if (!sgt_alone_by_slope(s, &one, rim2, &proven)) return false;
    sgt_interval about = sgt_about(hit->t, hit->t_err);
    hit->lo = about.lo, hit->hi = about.hi;
    sgt_step step = {.eval = hit->evals, .move = SGT_PROBE, .t = hit->t, .f = hit->f, .slope = hit->n.x * ray->d.x + hit->n.y * ray->d.y + hit->n.z * ray->d.z, .lo = about.lo, .hi = about.hi};
    if (opt->watch && opt->watch(opt->watch_data, &step)) *hit = hit_without(SGT_STOPPED, ray, hit->evals);
    return true;
}

/* ------------------------------------------------------------------------------ nearer */

/* R^2: a power of two above r^2, by more than rounding; infinite where r is out of range. */
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
    s.ops->own_->extent_within(s.self, sqrt(radius2), &kept->of[k]);
    return &kept->of[k];
}

void sgt_none_nearer(sgt_surface s, const sgt_tile *tile, sgt_extents *kept, unsigned long long none[])
{
    const struct sgt_own *own = s.ops->own_;
    size_t n = tile->n;
    double within2[SGT_FEW], radius2[SGT_FEW] = {0}, steep[SGT_FEW] = {0};
    double lo[SGT_FEW], hi[SGT_FEW], least[SGT_FEW];
    memset(none, 0, n * sizeof *none);
    for (size_t i = 0; i < n; i++) within2[i] = radius2_about(tile->hits.p[0][i], tile->hits.p[1][i]);
    if (own && is_catalogue(s.ops) && own->extent_within) {
        for (size_t i = 0; i < n; i++) {
            const sgt_extent nothing = {0, HUGE_VAL, HUGE_VAL, HUGE_VAL}, *e = &nothing;
            if (within2[i] < HUGE_VAL) e = extent_about(s, within2[i], kept);
            radius2[i] = e->radius2, steep[i] = e->steep;
        }
        own->chords(n, tile->rays, radius2, steep, lo, hi, least);
        for (size_t i = 0; i < n; i++) none[i] = MASK(least[i] > 0);
    } else if (own && own->alone) {
        unsigned long long alone[SGT_FEW];
        for (size_t i = 0; i < n; i++) {
            bool asked = false; /* with an earlier one */
            for (size_t k = 0; k < i; k++) asked = asked || within2[k] == within2[i];
            if (asked) continue;
            own->alone(s.self, tile, within2[i], alone, NULL);
            for (size_t k = i; k < n; k++)
                if (within2[k] == within2[i]) none[k] = MASK(alone[k] == ~0ULL);
        }
    }
}
