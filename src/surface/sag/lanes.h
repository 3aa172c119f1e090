// SPDX-License-Identifier: MIT
/* sag/lanes.h - a tile of rays met quickly: what conic and asphere share.
 *
 * A tile is met in a few loops.  The first goes from the ray to the vertex plane, others from there to its
 * root.  The last goes to the point and the gradient, and decides whether the root is accepted.  Between
 * the loops a ray is a `near_root`, in arrays that stay in the first-level cache.
 *
 * One loop would do.  But a square root, three quotients and what lies between them are a chain of some 150
 * cycles.  A processor looks some 300 instructions ahead, and one loop has 130 for a register of rays: it
 * would wait.  With loops of shorter chains it works on several registers of rays at once.  A conic takes 76
 * cycles for four rays in one loop and 57 in three (llvm-mca, Zen 3, AVX2).  The chain of a plane is short.
 * From memory one loop is faster: it reads and writes while it computes (`far` of sgt_tile;
 * docs/data/batches.md).
 *
 * NaN is written for rays that are not met, and only in tiles that have such a ray (lane_unmet). */
#ifndef SGT_SURFACE_SAG_LANES_H
#define SGT_SURFACE_SAG_LANES_H

#include "../../num/lanes.h"
#include "../builtin.h"

/* Ray i of the rows of a tile.  (They are copied for the loop, so that no output can alias the pointers.) */
SGT_INLINE sgt_ray lane_ray_of(const sgt_rays *r, size_t i)
{
    return (sgt_ray){
        {r->o[0][i], r->o[1][i], r->o[2][i]}, {r->d[0][i], r->d[1][i], r->d[2][i]}, r->tmin[i], r->tmax[i]};
}

/* The same ray along a direction multiplied by `scale`. */
SGT_INLINE sgt_ray along_scaled(const sgt_ray *ray, double scale)
{
    sgt_vec3 d = ray->d;
    return (sgt_ray){ray->o, {d.x * scale, d.y * scale, d.z * scale}, ray->tmin / scale, ray->tmax / scale};
}

/* One coordinate of o + t d, to 4 u^2 of itself.  The last sum is one of a large number and a small one
 * (Dekker 1971).  It is without an error where s.hi is the smaller, too: then o and p.hi have cancelled, and
 * s.hi is a multiple of an ulp of what is left. */
SGT_INLINE twofold place_of_root(double o, double t, double d)
{
    twofold p = two_product(t, d), s = two_sum(o, p.hi);
    return quick_two_sum(s.hi, s.lo + p.lo);
}

/* The ray at its root: t = t0 + small, at the point (x, y, 0) + tau d.  tau_err bounds the error of tau.
 * If the quick form gives no answer, t_err is NaN. */
typedef struct near_root { double x, y, tau, t, t_err, tau_err, t0, small; } near_root;

/* The ray met.  hit: certainly met, and the root is accepted.  If not, the rest is NaN, or what `any` in the
 * name of a function says: it means nothing. */
typedef struct lane { double t, t_err, t_lo, px, py, pz, nx, ny, p_err; mask hit; } lane;

/* The same, or NaN of a ray that is not met. */
SGT_INLINE lane lane_if_met(const lane *e)
{
    const double none = (double)NAN;
    const mask hit = e->hit;
    return (lane){chosen(hit, e->t, none),  chosen(hit, e->t_err, none), chosen(hit, e->t_lo, none),
                  chosen(hit, e->px, none), chosen(hit, e->py, none),    chosen(hit, e->pz, none),
                  chosen(hit, e->nx, none), chosen(hit, e->ny, none),    chosen(hit, e->p_err, none),
                  hit};
}

/* Where the ray meets the vertex plane: the point (x, y, 0), at t0 + t0_lo.  Each coordinate is rounded
 * twice, by at most u of itself and of t0_lo l.  t0 + t0_lo is off by 9 u^2 |t0|.  With S or the slope as
 * steep as the loops allow, either error moves a root by at most 64 times as much.  The term 1024 u^2 |t0|
 * in p_err covers both, and is negligible beside an ulp of t0. */
typedef struct vertex_place {
    double t0, t0_lo, x, y;
} vertex_place;

SGT_INLINE vertex_place to_vertex_plane(const sgt_ray *ray)
{
    double inverse = 1 / ray->d.z, t0 = -ray->o.z * inverse,
           t0_lo = sgt_fma(-t0, ray->d.z, -ray->o.z) * inverse;
    return (vertex_place){t0, t0_lo, sgt_fma(t0_lo, ray->d.x, sgt_fma(t0, ray->d.x, ray->o.x)),
                          sgt_fma(t0_lo, ray->d.y, sgt_fma(t0, ray->d.y, ray->o.y))};
}

/* A root nearer than this to the origin of t is left to the careful forms: there underflow is no longer
 * small beside an ulp of t.  (If |n| > 2^-100, underflow takes less than 2^-970 from t0_lo and tau.)  There
 * is one exception: if the ray starts in the vertex, nothing can underflow, and t = 0 is exact. */
static const double LEAST_T = 0x1p-900;

SGT_INLINE mask at_vertex(double x, double y, double oz) { return MASK((fabs(x) + fabs(y)) + fabs(oz) == 0); }

/* Is the root accepted?  These are the rules of accept.h, applied where they are certain by a wide margin:
 * - the start is farther from the root than any rounding (64 near exceeds what START_ULPS is a part of);
 * - so is tmax;
 * - t is as sharp as it can be.
 *
 * g makes the gradient (g px, g py, 1) from (px, py).  exact: the ray starts where it meets the surface,
 * and nothing has been rounded.  If an end is then about as near as what underflows, the ray is left to the
 * careful forms.  Beside a t_err of LEAST_PLACE underflow is negligible, so t may then be 0.
 *
 * whole: the ends are -inf and inf, and are not read.  What is asked of them is true of a t below 2^1000, as
 * t_err is finite with it.  (A ray that is not met here is asked by itself.) */
typedef struct lane_end {
    double pz, g, near;
} lane_end;

SGT_INLINE lane lane_any(const near_root *r, const sgt_ray *ray, double t_tol, bool whole,
                         const lane_end *there, double rim2, mask exact, mask also)
{
    const double pz = there->pz, g = there->g, near = there->near;
    const double l = ray->d.x, m = ray->d.y, n = ray->d.z, tmin = ray->tmin, tmax = ray->tmax;
    double px = sgt_fma(r->tau, l, r->x), py = sgt_fma(r->tau, m, r->y), at = fabs(r->t),
           r2 = px * px + py * py;
    mask between = MASK(at + near < 0x1p1000), apart = exact;
    if (!whole) {
        between = MASK(r->t - r->t_err - tmin > 0x1p-42 * (at + near)) &
                  MASK(sgt_fma(END_ERRORS, r->t_err, r->t) <= tmax);
        apart &= MASK(tmin < -LEAST_PLACE) & MASK(tmax > LEAST_PLACE);
    }
    mask hit = also & MASK(r->t_err <= larger(40 * SGT_U * at, t_tol)) & between & MASK(r2 <= rim2)
               & (MASK(at + r->t_err > LEAST_PLACE) | apart);
    lane e = {.hit = hit, .t = r->t,  .t_err = r->t_err, .px = px,
              .py = py,   .pz = pz,   .nx = px * g,      .ny = py * g};
    e.t_lo = two_sum(r->t0, r->small).lo;
    double length = fabs(l) + fabs(m) + fabs(n),
           place = (2 * (fabs(r->x) + fabs(r->y)) + (fabs(px) + fabs(py))) + fabs(pz);
    e.p_err = 1.01 * sgt_fma(length, r->tau_err + 1024 * SGT_U * SGT_U * fabs(r->t0), SGT_U * place);
    return e;
}

/* The same, and NaN of a ray that is not met. */
SGT_INLINE lane lane_of(const near_root *r, const sgt_ray *ray, double t_tol, const lane_end *there,
                        double rim2, mask exact, mask also)
{
    const lane e = lane_any(r, ray, t_tol, false, there, rim2, exact, also);
    return lane_if_met(&e);
}

/* The answer of the easy form for a single ray.  EASY_NOT: none. */
typedef enum easy_answer { EASY_NOT, EASY_GRAZES, EASY_MISS, EASY_HIT } easy_answer;

/* Takes a hit along a scaled direction to the ray's own t.  EASY_NOT if t leaves its range. */
SGT_INLINE easy_answer easy_unscaled(lane *e, double scale)
{
    bool exact = e->t == 0; /* no other t is 0 in a lane */
    e->t *= scale, e->t_err *= scale, e->t_lo *= scale;
    return e->t_err < HUGE_VAL && (exact || fabs(e->t) > LEAST_T) && fabs(e->t) < HUGE_VAL ? EASY_HIT
                                                                                           : EASY_NOT;
}

/* The hit of a single ray, as in a tile. */
SGT_INLINE sgt_hit hit_of_lane(const lane *e, int evals, double f)
{
    meeting h = {.t = e->t, .t_lo = e->t_lo, .t_err = e->t_err, .p_err = e->p_err,
                 .p = {e->px, e->py, e->pz}, .n = {e->nx, e->ny, 1}};
    return hit_found(SGT_HIT, evals, f, &h);
}

/* Where the second loop writes.  Outputs that are not wanted go to one array in the first-level cache. */
typedef struct lane_ends {
    _Alignas(64) double unwanted[SGT_TILE];
    mask hit[SGT_TILE];
} lane_ends;

typedef struct lane_to { double *t, *t_err, *t_lo, *px, *py, *pz, *nx, *ny, *nz, *p_err; mask *hit; } lane_to;

SGT_INLINE lane_to lane_to_of(const sgt_tile *tile, lane_ends *ends)
{
    const sgt_hits *h = &tile->hits;
    double *no = ends->unwanted;
    return (lane_to){h->t ? h->t : no, h->t_err ? h->t_err : no, h->t_lo ? h->t_lo : no,
                     h->p[0] ? h->p[0] : no, h->p[0] ? h->p[1] : no, h->p[0] ? h->p[2] : no,
                     h->n[0] ? h->n[0] : no, h->n[0] ? h->n[1] : no, h->n[0] ? h->n[2] : no,
                     h->p_err ? h->p_err : no, ends->hit};
}

/* What is wanted besides point and gradient: nothing, of whole lines; t and t_err; t_lo as for paths; p_err
 * too. */
typedef enum lane_wish { LANE_BARE, LANE_PLAIN, LANE_FINE, LANE_RICH } lane_wish;

/* Stores whatever a lane has, without a look at hit: lane_unmet follows if a ray of the tile is not met. */
#define LANE_STORE_ALL(to, i, e, wish)                                         \
    do {                                                                       \
        (to).px[i] = (e).px, (to).py[i] = (e).py, (to).pz[i] = (e).pz;         \
        if ((wish) != LANE_BARE) (to).t[i] = (e).t, (to).t_err[i] = (e).t_err; \
        (to).nx[i] = (e).nx, (to).ny[i] = (e).ny, (to).nz[i] = 1;              \
        (to).hit[i] = (e).hit;                                                 \
        if ((wish) >= LANE_FINE) (to).t_lo[i] = (e).t_lo;                      \
        if ((wish) == LANE_RICH) (to).p_err[i] = (e).p_err;                    \
    } while (0)

#define LANE_STORE(to, i, e, wish)                           \
    do {                                                     \
        LANE_STORE_ALL(to, i, e, wish);                      \
        (to).nz[i] = chosen((e).hit, 1, (double)NAN);        \
    } while (0)

/* After LANE_STORE_ALL of `count` rays: NaN for those that are not met.  rich: t_lo and p_err are stored. */
SGT_INLINE void lane_unmet(const lane_to *to, bool rich, size_t count)
{
    const lane_to own = *to;
    LANES for (size_t i = 0; i < count; i++)
    {
        lane e = {.t = own.t[i],
                  .t_err = own.t_err[i],
                  .px = own.px[i],
                  .py = own.py[i],
                  .pz = own.pz[i],
                  .nx = own.nx[i],
                  .ny = own.ny[i],
                  .hit = own.hit[i]};
        if (rich) e.t_lo = own.t_lo[i], e.p_err = own.p_err[i];
        e = lane_if_met(&e);
        if (rich)
            LANE_STORE(own, i, e, LANE_RICH);
        else
            LANE_STORE(own, i, e, LANE_PLAIN);
    }
}

/* Stores all of a lane if `is`, and leaves what is there if not. */
#define LANE_STORE_IF(to, i, e, is)                                                                 \
    do {                                                                                            \
        const mask now = is;                                                                        \
        (to).t[i] = chosen(now, (e).t, (to).t[i]);                                                  \
        (to).t_err[i] = chosen(now, (e).t_err, (to).t_err[i]);                                      \
        (to).t_lo[i] = chosen(now, (e).t_lo, (to).t_lo[i]);                                         \
        (to).px[i] = chosen(now, (e).px, (to).px[i]), (to).py[i] = chosen(now, (e).py, (to).py[i]); \
        (to).pz[i] = chosen(now, (e).pz, (to).pz[i]), (to).nx[i] = chosen(now, (e).nx, (to).nx[i]); \
        (to).ny[i] = chosen(now, (e).ny, (to).ny[i]);                                               \
        (to).nz[i] = chosen(now, chosen((e).hit, 1, (double)NAN), (to).nz[i]);                      \
        (to).p_err[i] = chosen(now, (e).p_err, (to).p_err[i]);                                      \
        (to).hit[i] = ((e).hit & now) | ((to).hit[i] & ~now);                                       \
    } while (0)

SGT_INLINE lane_wish lane_wish_of(const sgt_tile *tile)
{
    const sgt_hits *h = &tile->hits;
    if (h->p_err || h->t_lo) return h->p_err ? LANE_RICH : LANE_FINE;
    return tile->whole && !h->t && !h->t_err ? LANE_BARE : LANE_PLAIN;
}

/* The rows that are wanted of hits; NULL: not wanted. */
typedef struct lane_outputs { double *of[10]; } lane_outputs;

SGT_INLINE lane_outputs lane_outputs_of(const sgt_hits *h)
{
    const bool p = h->p[0], n = h->n[0];
    return (lane_outputs){{h->t, h->t_err, h->t_lo, h->p[0], p ? h->p[1] : NULL, p ? h->p[2] : NULL, h->n[0],
                           n ? h->n[1] : NULL, n ? h->n[2] : NULL, h->p_err}};
}

/* Writes what LANE_STORE writes for rays that are not met. */
SGT_INLINE void lane_nothing(const sgt_tile *tile)
{
    const lane_outputs to = lane_outputs_of(&tile->hits);
    const size_t count = tile->n;
    double *r[10];
    int rows = 0;
    for (int k = 0; k < 10; k++)
        if (to.of[k]) r[rows++] = to.of[k];
    if (!rows) return;
    for (int k = rows; k < 10; k++) r[k] = r[0];
    double *a = r[0], *b = r[1], *c = r[2], *d = r[3], *e = r[4], *f = r[5], *g = r[6], *h = r[7], *p = r[8],
           *q = r[9];
    LANES for (size_t i = 0; i < count; i++) /* one loop: a third of the instructions of ten */
    {
        a[i] = b[i] = c[i] = d[i] = e[i] = f[i] = g[i] = h[i] = p[i] = q[i] = (double)NAN;
    }
}

/* Writes status and evals.  A ray without a hit gets SGT_HARD.  all: every ray has a hit.  Returns the
 * number of hard rays. */
SGT_INLINE size_t lane_told(const sgt_tile *tile, const lane_ends *ends, int evals, mask all)
{
    sgt_status *status = tile->hits.status;
    size_t hard = 0;
    if (all) memset(status, SGT_HIT, tile->n);
    for (size_t i = 0; !all && i < tile->n; i++) {
        status[i] = (signed char)((int)(ends->hit[i] & (SGT_HIT - SGT_HARD)) + SGT_HARD);
        hard += ends->hit[i] == 0;
    }
    for (size_t i = 0; tile->hits.evals && i < tile->n; i++) tile->hits.evals[i] = evals;
    return hard;
}

#endif
