// SPDX-License-Identifier: MIT
/* ray/lanes.c - many rays and a surface that is met by its operations: the quick form of step.h with loops
 * around it.
 *
 * LANE_COUNT rays are taken at a time.  Each number of theirs is a row.  What the single ray does step by
 * step is done here phase by phase.  Each phase works on the lanes that are still in it; they are moved to
 * the front of the rows.
 *
 *     approach      the span is asked, and the ray made local
 *     march         if the first of several roots is wanted: equal steps, until two neighbours have unlike
 *                   signs
 *     Newton        from the seed, or from the secant of those two
 *     ends          if Newton has failed and there is at most one root: the signs at the ends of the span
 *     probes        the signs beside the root; not needed if the slope along the span is bounded from below
 *     acceptance    is the root accepted, and what is reported of it
 *
 * In each phase the points are made (by the loop before, where it can).  `values` is called for all of
 * them at once; of a departure `values_rounded`, which gives the bound on its rounding too.  One or two loops
 * look at the answers.
 *
 * VECTOR CODE.  To keep gcc 12 vectorising, select with doubles instead of bools, and never select twice
 * on one condition in one loop.  Lanes that are done and not yet moved away are asked again at the same
 * point, and nothing of theirs changes.  In a march they are moved as soon as a quarter of the lanes are
 * done; in Newton's steps, which are few, when three quarters are.
 *
 * A LANE NEVER CHANGES ITS NEIGHBOUR.  No statement but those of the moves has two lanes in it.  A lane
 * for which the quick form has no answer is left to the single ray.  No point is asked for outside the
 * stretch that is searched.  The surface is not given a ray that sgt_intersect would reject. */
#include "../num/lanes.h"
#include "../solve/root.h"
#include "general.h"
#include "../solve/step.h"
#include "wings.h"

#include <stddef.h>

enum { LANE_COUNT = 64, ABREAST = 8 };
typedef double row[LANE_COUNT];

/* The state of a lane is its phase, and in the end a status or SGT_HARD. */
enum { MARCH = 10, VALLEY, NEWTON, FAILED, READY, ROOT, DOUBTED };

/* The rows up to `most2` are moved with a lane.  The rows of a union serve phases that do not overlap. */
typedef struct lanes {
    _Alignas(64) row x;              /* the ray made local; each row begins a cache line */
    row y, z, l, m, n, t0, scale;
    row tmin, tmax, t_tol, lo, hi, single;
    /* last: the size of the step before; of a root, the slope.  first: |g| where the search began, < 0 if
     * not yet known. */
    row tau, last, first, evals;
    row f, fx, fy, fz, g_err;        /* F at tau, the gradient, a bound on F's error */
    union { row at, left; };         /* march: the point before and F there; root: the points beside it */
    union { row g, right, whole; };  /* whole: a bound on all of F's error */
    union { row slope, beside; };
    union { row sign, tau_err; };
    union { row dt, seed; };
    row end;                         /* of a march; of a root, the sign on its left */
    union { row defined, most2; };   /* march: was F defined? (No built-in sag is marched along.) */
    row px, py, pz;                  /* the point asked for */
    row slot, state, least;          /* least: a lower bound on |g'| along the span; 0 if not known */
    union { row noise0, steep; };    /* of a body, as `firsts` has it */
    row noise1;                      /* with noise0 and most2, of a sag without a rim: vicinity.h */
    row qf, qx, qy, qz;              /* F beside a root; what one loop leaves to the next */
    /* 0, for around_of.  It is kept here because gcc cannot know it after a call. */
    double none;
} lanes;

enum { MOVED = offsetof(lanes, qf) / sizeof(row) };

typedef struct lanes_job {
    sgt_surface s;
    const sgt_options *opt;
    double budget;
    double near;        /* 1: the root near the seed is wanted, else 0 */
    double back;        /* back of approach_of */
    double rim2;        /* r^2 at the surface's rim */
    double margin;      /* margin of acceptance_of, as for the single ray */
    double walks_from;  /* a stretch that begins behind it can be marched; infinite: none */
    bool slopes;        /* the spans come with bounds on the slope */
    bool steep;         /* `firsts` does */
    bool moved;         /* some lane is not at its place */
    sgt_shared shared;  /* what the surface shares, if it has `share` */
    vicinities *kept;   /* what is known of parts of it, */
    slopes_known *within; /* and near the seed */
    sgt_shared bare;    /* bare_of shared */
    bool rows;          /* what the departure adds to the rounding differs from lane to lane */
    bool rounded;       /* `whole` is set in every lane that Newton's steps were tried on */
    lanes *a;
    /* What `values` is given, made once.  If it were built in smaller pieces for each call, its copy would
     * have to wait for those stores. */
    sgt_points points;
    sgt_values f, q;    /* F at tau; F beside a root */
} lanes_job;

SGT_KERNEL
static size_t count_of(const lanes *a, size_t n, double state)
{
    double count = 0;
#pragma omp simd reduction(+ : count)
    for (size_t i = 0; i < n; i++) count += a->state[i] == state ? 1.0 : 0.0;
    return (size_t)count;
}

/* Moves the lanes of that state to the front.  Returns how many there are. */
static size_t front(lanes_job *w, size_t n, double state)
{
    size_t i = 0, count = count_of(w->a, n, state);
    if (count == n || count == 0) return count;
    double *rows = w->a->x;
    for (size_t j = n - 1; i < count; i++) {
        if (w->a->state[i] == state) continue;
        while (w->a->state[j] != state) j--;
        if (j < i) break;
        w->moved = true;
        for (size_t k = 0; k < MOVED; k++) {
            double other = rows[k * LANE_COUNT + i];
            rows[k * LANE_COUNT + i] = rows[k * LANE_COUNT + j], rows[k * LANE_COUNT + j] = other;
        }
    }
    return count;
}

/* The ray of lane i.  Not a function: gcc 12 does not vectorise around the struct that one returns. */
#define LOCAL_OF(a, i) {.x = a->x[i], .y = a->y[i], .z = a->z[i], .l = a->l[i], .m = a->m[i], .n = a->n[i]}

/* -------------------------------------------------------------------- evaluations */

SGT_KERNEL
static void points(lanes *a, size_t n, const double *tau)
{
#pragma omp simd
    for (size_t i = 0; i < n; i++) {
        a->px[i] = a->x[i] + tau[i] * a->l[i];
        a->py[i] = a->y[i] + tau[i] * a->m[i];
        a->pz[i] = a->z[i] + tau[i] * a->n[i];
    }
}

/* Sets the slope, and what rounding of the point does to F. */
SGT_KERNEL
static void around_all(const lanes *a, size_t n, const double *tau, const sgt_values *f, double *slope,
                       double *g_err)
{
    const double *fx = f->grad[0], *fy = f->grad[1], *fz = f->grad[2];
    double none = a->none;
#pragma omp simd
    for (size_t i = 0; i < n; i++) {
        local q = LOCAL_OF(a, i);
        sgt_vec3 p = {a->px[i], a->py[i], a->pz[i]}, grad = {fx[i], fy[i], fz[i]};
        around at = around_of(&q, tau[i], p, grad, none);
        slope[i] = at.slope, g_err[i] = at.place;
    }
}

/* The same.  Returns how many lanes are so near the root that the surface's own rounding has to be asked
 * for. */
SGT_KERNEL
static double around_close(const lanes *a, size_t n, const double *tau, const sgt_values *f, double *slope,
                           double *g_err, const double *last, double f_tol)
{
    const double *g = f->f, *fx = f->grad[0], *fy = f->grad[1], *fz = f->grad[2];
    double none = a->none, near = 0;
#pragma omp simd reduction(+ : near)
    for (size_t i = 0; i < n; i++) {
        local q = LOCAL_OF(a, i);
        sgt_vec3 p = {a->px[i], a->py[i], a->pz[i]}, grad = {fx[i], fy[i], fz[i]};
        around at = around_of(&q, tau[i], p, grad, none);
        near += close_of(g[i], at.slope, at.place, last[i], f_tol) ? 1.0 : 0.0;
        slope[i] = at.slope, g_err[i] = at.place;
    }
    return near;
}

/* F and its gradient at the points, and the surface's own rounding, which is set as add_noise leaves it.
 * false: none of them is.  (Without a bound on the slope it is asked for only where a lane is close.) */
static bool ask_rounded(lanes_job *w, size_t n, const sgt_values *out, double *own)
{
    const sgt_surface_ops *ops = w->s.ops;
    const lanes *a = w->a;
    const double *const rows[3] = {a->noise0, a->noise1, a->most2};
    return (w->slopes || w->steep) && ops->own_->values_rounded &&
           ops->own_->values_rounded(w->s.self, w->rows ? &w->bare : &w->shared, w->rows ? rows : NULL, n,
                                     w->points, *out, own);
}

/* Adds the surface's own rounding where close_of says so; everywhere if last is NULL. */
SGT_KERNEL
static void add_roundings(size_t n, const double *restrict f, const double *restrict slope,
                          const double *restrict last, double f_tol, const double *restrict own,
                          double *restrict g_err)
{
    if (last) {
        _Pragma("omp simd") for (size_t i = 0; i < n; i++) {
            double bound = own[i] >= 0 ? own[i] : HUGE_VAL,
                   close = close_of(f[i], slope[i], g_err[i], last[i], f_tol) ? 1.0 : 0.0;
            g_err[i] += close != 0 ? bound : 0;
        }
    } else {
        _Pragma("omp simd") for (size_t i = 0; i < n; i++) g_err[i] += own[i] >= 0 ? own[i] : HUGE_VAL;
    }
}

SGT_KERNEL
static void add_noise(const lanes *a, size_t n, double *own)
{
#pragma omp simd
    for (size_t i = 0; i < n; i++)
        own[i] += sgt_noise_at(a->noise0[i], a->noise1[i], a->most2[i],
                                 a->px[i] * a->px[i] + a->py[i] * a->py[i]);
}

/* How many of the bounds are known.  (Too short a loop for tests/build/vectorised.py to judge.) */
SGT_NOINLINE static double known_all(size_t n, const double *own)
{
    double known = 0;
#pragma omp simd reduction(+ : known)
    for (size_t i = 0; i < n; i++) known += own[i] >= 0 ? 1.0 : 0.0;
    return known;
}

/* Sets the slope, and the bound on F's error.  slope may be the row of the gradient's first component.
 * last: as for close_of; NULL: always ask for the surface's own rounding.  known: that, if ask_rounded has
 * set it, else NULL. */
static void bound(lanes_job *w, size_t n, const double *tau, const sgt_values *f, double *slope,
                    double *g_err, const double *last, double *known)
{
    const sgt_surface_ops *ops = w->s.ops;
    const lanes *a = w->a;
    if (!last) around_all(a, n, tau, f, slope, g_err);
    else if (around_close(a, n, tau, f, slope, g_err, last, w->opt->f_tol) == 0) return;
    if (!ops->rounding) return;
    double asked[LANE_COUNT], *own = known ? known : asked,
           none = is_catalogue(ops) ? HUGE_VAL : 0; /* for a bound that is none */
    if (!known && is_catalogue(ops) && ops->own_->roundings &&
        ops->own_->roundings(w->s.self, w->rows ? &w->bare : &w->shared, n, w->points, f->f, own)) {
        if (w->rows) add_noise(a, n, own);
        known = own;
    }
    if (known) {
        bool all = known_all(n, own) == (double)n;
        for (size_t i = 0; !all && i < n; i++) /* rare: beyond the rim */
            if (!(own[i] >= 0)) own[i] = ops->rounding(w->s.self, (sgt_vec3){a->px[i], a->py[i], a->pz[i]});
        add_roundings(n, f->f, slope, last, w->opt->f_tol, own, g_err);
        return;
    }
    for (size_t i = 0; i < n; i++) {
        if (!close_of(f->f[i], slope[i], g_err[i], last ? last[i] : (double)NAN, w->opt->f_tol)) continue;
        double here = ops->rounding(w->s.self, (sgt_vec3){a->px[i], a->py[i], a->pz[i]});
        g_err[i] += here >= 0 ? here : none;
    }
}

/* ----------------------------------------------------------------------- approach */

/* Two loops, by way of int: bytes and doubles in one loop make long code. */
SGT_KERNEL
static void lanes_widen(size_t n, double *restrict out, const bool *restrict of)
{
    int wide[LANE_COUNT];
#pragma omp simd
    for (size_t i = 0; i < n; i++) wide[i] = of[i];
#pragma omp simd
    for (size_t i = 0; i < n; i++) out[i] = wide[i];
}

SGT_KERNEL
static void single_all(lanes *a, size_t n)
{
#pragma omp simd
    for (size_t i = 0; i < n; i++) a->single[i] = a->least[i] > 0 ? 1.0 : 0.0;
}

/* How many numbers of a row are above 0. */
static double above_zero(size_t n, const double *of)
{
    double count = 0;
#pragma omp simd reduction(+ : count)
    for (size_t i = 0; i < n; i++) count += of[i] > 0 ? 1.0 : 0.0;
    return count;
}

/* Marks the lanes that are to be asked, and returns how many.  The rows of the others are not used.
 * seedless: 1 if lanes without a seed are, too. */
SGT_KERNEL
static double nearby_asked(const lanes *a, size_t n, double seedless, double *asked)
{
    double some = 0;
#pragma omp simd reduction(+ : some)
    for (size_t i = 0; i < n; i++) {
        double is = ((a->single[i] == 0) & ((fabs(a->seed[i]) < HUGE_VAL) | (seedless > 0))) ? 1.0 : 0.0;
        asked[i] = is, some += is;
    }
    return some;
}

/* How many lanes have a bound on the slope, and do not start low? */
SGT_KERNEL
static double single_from_above(const lanes *a, const sgt_rays *r, size_t n)
{
    const double *ox = r->o[0], *oy = r->o[1], *oz = r->o[2];
    double count = 0;
#pragma omp simd reduction(+ : count)
    for (size_t i = 0; i < n; i++) {
        bool away = (a->tmin[i] != 0) | (fabs(oz[i]) > 0.5 * (fabs(ox[i]) + fabs(oy[i])));
        count += ((a->least[i] > 0) & away) ? 1.0 : 0.0;
    }
    return count;
}

/* And how many have one that is not a weak bound, or do not start low? */
SGT_KERNEL
static double steadily_single(const lanes *a, const sgt_rays *r, size_t n)
{
    const double *ox = r->o[0], *oy = r->o[1], *oz = r->o[2], *dx = r->d[0], *dy = r->d[1], *dz = r->d[2];
    double count = 0;
#pragma omp simd reduction(+ : count)
    for (size_t i = 0; i < n; i++) {
        double least = a->least[i], steep = 0.25 * fabs(dz[i]) * scale_of((sgt_vec3){dx[i], dy[i], dz[i]});
        bool away = (a->tmin[i] != 0) | (least >= steep) | (fabs(oz[i]) > 0.5 * (fabs(ox[i]) + fabs(oy[i])));
        count += ((least > 0) & away) ? 1.0 : 0.0;
    }
    return count;
}

/* Lanes with a bound on the slope that is not weak begin at their start, if that is next to the seed. */
SGT_KERNEL
static void seed_starts(lanes *a, const sgt_rays *r, size_t n)
{
    const double *ox = r->o[0], *oy = r->o[1], *oz = r->o[2], *dx = r->d[0], *dy = r->d[1], *dz = r->d[2];
#pragma omp simd
    for (size_t i = 0; i < n; i++) {
        const sgt_vec3 d = {dx[i], dy[i], dz[i]};
        double least = a->least[i], steep = 0.25 * fabs(d.z) * scale_of(d);
        mask starts = starts_at_root((sgt_vec3){ox[i], oy[i], oz[i]}, d, a->tmin[i], a->seed[i]);
        a->seed[i] = chosen(starts & MASK(least > 0) & MASK(least >= steep), 0, a->seed[i]);
    }
}

/* As nearby_asked, where the chord can be marched along: lanes without a seed begin in the middle of it. */
static double chords_asked(lanes *a, bool rimmed, const sgt_rays *r, size_t n, double *asked)
{
    double some = 0;
    for (size_t i = 0; i < n; i++) {
        const sgt_vec3 o = {r->o[0][i], r->o[1][i], r->o[2][i]}, d = {r->d[0][i], r->d[1][i], r->d[2][i]};
        asked[i] = 0;
        if (a->single[i] != 0 && !(rimmed && starts_weakly(o, d, a->tmin[i], a->least[i]))) continue;
        a->single[i] = 0; /* a stretch that is found may be a part of the chord */
        a->seed[i] = chord_seed(a->seed[i], a->lo[i], a->hi[i], a->tmin[i], a->tmax[i]);
        asked[i] = fabs(a->seed[i]) < HUGE_VAL ? 1.0 : 0.0, some += asked[i];
    }
    return some;
}

/* For sags with several roots along the whole ray: the stretch on which F is monotone (vicinity.h).  No
 * root on the stretch is not a miss, so the lane is not single.  The rows of the local ray are free as
 * yet. */
static void lanes_nearby(lanes_job *w, sgt_rays rays, size_t n)
{
    lanes *a = w->a;
    w->rows = false;
    if (!w->s.ops->own_->extent_within) return;
    bool chords = w->near == 0 && marches_chord(&w->shared);
    bool rimmed = chords && w->rim2 < HUGE_VAL;
    double all = (double)n, seedless = asks_ahead(&w->shared, w->near != 0) ? 1 : 0;
    if (rimmed && single_from_above(a, &rays, n) == all) return;
    if (rimmed) seed_starts(a, &rays, n);
    if (rimmed && steadily_single(a, &rays, n) == all) return;
    if (chords && !rimmed && above_zero(n, a->least) == all) return;
    if ((chords ? chords_asked(a, rimmed, &rays, n, a->x) : nearby_asked(a, n, seedless, a->x)) == 0) return;
    w->rows = !(w->shared.noise[0] < HUGE_VAL);
    vicinity v = {.tmin = a->tmin,
                  .tmax = a->tmax,
                  .seed = a->seed,
                  .asked = a->x,
                  .lo = a->lo,
                  .hi = a->hi,
                  .least = a->least,
                  .noise = {a->noise0, a->noise1, a->most2},
                  .evals = a->evals,
                  .budget = w->budget,
                  .work = {a->y,  a->z,  a->l,  a->m,  a->n,     a->t0, a->scale, a->tau,   a->last, a->first,
                           a->f,  a->fx, a->fy, a->fz, a->g_err, a->at, a->g,     a->slope, a->sign, a->end,
                           a->px, a->py, a->pz, a->qf, a->qx,    a->qy, a->qz,    a->t_tol, a->state}};
    sgt_vicinity_of(w->s, n, rays, w->near != 0 ? w->within : NULL, &w->shared, w->kept, &v);
}

/* Takes the spans of the whole surface, in f, fx and fy, for the lanes that are left as they were. */
SGT_KERNEL
static void take_whole(lanes *a, size_t n)
{
#pragma omp simd
    for (size_t i = 0; i < n; i++) {
        double seed = a->fy[i], asked = a->x[i], lo = a->lo[i], hi = a->hi[i];
        mask inside = MASK(seed == seed),
             kept = inside & (MASK(a->least[i] > 0) | (MASK(asked == 0) & MASK(lo > hi)));
        a->lo[i] = chosen(kept, lo, a->f[i]), a->hi[i] = chosen(kept, hi, a->fx[i]);
        a->seed[i] = seed;
        a->noise0[i] = chosen(inside, a->noise0[i], (double)NAN);
        a->noise1[i] = chosen(inside, a->noise1[i], (double)NAN);
        a->most2[i] = chosen(inside, a->most2[i], (double)NAN);
    }
}

/* If no bound on the slope holds for the whole surface, only the vicinity can give one, and is asked at
 * once.  If it does for all lanes, the spans of the whole surface need not be known: they would change
 * nothing.  (Each seed is then within a part of its span, and so within the span.  The ends of both are made
 * by the same steps, each of which is monotone in the radius, rounding included.)  A lane with a seed outside
 * of its span is one without a seed. */
static bool spans_nearby(lanes_job *w, sgt_rays rays, size_t n)
{
    const struct sgt_builtin_ops *builtin = w->s.ops->own_;
    lanes *a = w->a;
    if (w->near == 0 || !builtin->seeds || !builtin->extent_within || w->shared.steep < HUGE_VAL)
        return false;
    builtin->seeds(w->s.self, &w->shared, n, rays, a->seed);
    single_all(a, n); /* none is */
    for (size_t i = 0; i < n; i++) a->lo[i] = a->hi[i] = 0;
    lanes_nearby(w, rays, n);
    if (above_zero(n, a->least) == (double)n) return true;
    double none[LANE_COUNT];
    builtin->spans(w->s.self, &w->shared, n, rays, (sgt_spans){a->f, a->fx, a->fy, NULL}, none);
    take_whole(a, n);
    return true;
}

static void spans(lanes_job *w, const sgt_tile *tile, size_t from, size_t n)
{
    const sgt_surface_ops *ops = w->s.ops;
    lanes *a = w->a;
    sgt_rays rays = rays_from(&tile->rays, from);
    bool single[LANE_COUNT];
    for (size_t i = 0; i < n; i++) a->least[i] = a->evals[i] = 0;
    if (ops->first && w->near == 0) {
        rays.tmin = a->tmin, rays.tmax = a->tmax;
        const sgt_spans to = {a->lo, a->hi, a->seed, single};
        if (w->steep) ops->own_->firsts(w->s.self, n, rays, to, a->steep);
        else if (ops->firsts) ops->firsts(w->s.self, n, rays, to);
        for (size_t i = 0; i < n && !ops->firsts; i++) {
            sgt_ray ray = ray_of(&rays, i);
            sgt_span span = ops->first(w->s.self, &ray);
            a->lo[i] = span.lo, a->hi[i] = span.hi, a->seed[i] = span.seed, single[i] = span.single;
        }
        for (size_t i = 0; i < n; i++)
            if (!single[i]) a->lo[i] = -HUGE_VAL, a->hi[i] = HUGE_VAL; /* the whole ray: no miss */
        lanes_widen(n, a->single, single);
        return;
    }
    if (w->slopes) {
        if (spans_nearby(w, rays, n)) return;
        ops->own_->spans(w->s.self, &w->shared, n, rays, (sgt_spans){a->lo, a->hi, a->seed, NULL}, a->least);
        single_all(a, n);
        lanes_nearby(w, rays, n);
        return;
    }
    spans_of(w->s, n, rays, (sgt_spans){a->lo, a->hi, a->seed, single});
    lanes_widen(n, a->single, single);
}

SGT_INLINE void make_local(const lanes_job *w, const sgt_tile *tile, size_t from, size_t n, bool everywhere)
{
    lanes *a = w->a;
    const double *ox = tile->rays.o[0] + from, *oy = tile->rays.o[1] + from, *oz = tile->rays.o[2] + from;
    const double *dx = tile->rays.d[0] + from, *dy = tile->rays.d[1] + from, *dz = tile->rays.d[2] + from,
                 *t_tol = tile->t_tol + from;
    double back = w->back;
    bool slopes = w->slopes;
#pragma omp simd
    for (size_t i = 0; i < n; i++) {
        sgt_vec3 o = {ox[i], oy[i], oz[i]}, d = {dx[i], dy[i], dz[i]};
        sgt_interval cut = {a->tmin[i], a->tmax[i]}, span = {a->lo[i], a->hi[i]};
        approach at = approach_of(o, d, cut, span, a->seed[i], back, everywhere,
                                  slopes & (a->least[i] > 0));
        a->f[i] = (at.seeded ? 1.0 : 0.0) + (at.middle ? 0.5 : 0.0),
        a->fx[i] = (at.passes ? 0.0 : 1.0) + (at.known ? 0.0 : 2.0);
        a->x[i] = at.q.x, a->y[i] = at.q.y, a->z[i] = at.q.z;
        a->l[i] = at.q.l, a->m[i] = at.q.m, a->n[i] = at.q.n;
        a->t0[i] = at.q.t0, a->scale[i] = at.q.scale;
        a->lo[i] = at.lo, a->hi[i] = at.hi;
        a->t_tol[i] = t_tol[i] * at.inverse;
        if (everywhere) a->end[i] = far_end(o, at.q.l, at.q.m, at.q.n, at.q.t0, at.nearest, at.lo);
        a->tau[i] = 0, a->last[i] = DBL_MAX, a->first[i] = -1;
    }
}

/* Makes the rays local and chooses their first phase.  Returns how many begin with Newton's steps. */
SGT_KERNEL
static double approach_lanes(const lanes_job *w, const sgt_tile *tile, size_t from, size_t n)
{
    lanes *a = w->a;
    const double *t_tol = tile->t_tol + from;
    double near = w->near, walks_from = w->walks_from, starting = 0;
    if (walks_from < HUGE_VAL && !w->s.ops->span) make_local(w, tile, from, n, true);
    else make_local(w, tile, from, n, false);
    /* gcc vectorises these two loops.  In one loop it would branch, as the same conditions are selected by
     * and tested again. */
#pragma omp simd reduction(+ : starting)
    for (size_t i = 0; i < n; i++) {
        double single = a->single[i], one = single + near + a->least[i];
        bool starts = (one > 0) & (a->f[i] + 0.5 * single >= 1), walks = (one == 0) & (a->lo[i] > walks_from);
        double state = starts ? (double)NEWTON : (double)SGT_HARD;
        state = walks ? (double)MARCH : state;
        state = a->fx[i] > 1 ? (double)SGT_HARD : state;
        state = a->fx[i] < 1 ? (double)SGT_MISS : state;
        state = t_tol[i] >= 0 ? state : (double)SGT_HARD;
        starting += state == NEWTON ? 1.0 : 0.0;
        a->state[i] = state;
    }
    return starting;
}

/* -------------------------------------------------------------------------- march */

/* Sets the steps of the march, and an end if the ray has none. */
SGT_KERNEL
static void march_begin(lanes *a, size_t n, double dt_min, bool everywhere)
{
#pragma omp simd
    for (size_t i = 0; i < n; i++) {
        double lo = a->lo[i],
               end = a->hi[i] < HUGE_VAL ? a->hi[i]
                     : everywhere        ? a->end[i]
                                         : HUGE_VAL,
               given = dt_min / a->scale[i], own = (end - lo) * (1.0 / MARCH_STEPS);
        a->end[i] = end;
        a->dt[i] = dt_min > 0 ? given : own;
        double state = end < HUGE_VAL ? a->state[i] : (double)SGT_HARD;
        a->state[i] = lo < end ? state : (double)SGT_HARD;
        a->tau[i] = lo, a->defined[i] = 0;
        /* no point before the first */
        a->at[i] = -HUGE_VAL, a->g[i] = (double)NAN, a->slope[i] = a->sign[i] = 0;
    }
}

SGT_INLINE mark lanes_before(const lanes *a, size_t i)
{
    return (mark){a->at[i], a->g[i], a->slope[i], a->sign[i]};
}
SGT_INLINE mark after(const lanes *a, size_t i) { return (mark){a->tau[i], a->f[i], a->qx[i], a->qf[i]}; }

/* n rounded up to full registers: a few lanes cost as much as a register of them.  Lanes from n on are in
 * another phase. */
SGT_INLINE size_t filled(size_t n) { return (n + ABREAST - 1) / ABREAST * ABREAST; }

/* Looks at the step to tau, and makes the next; k steps were taken before.  A lane before a valley waits
 * for march_over.  known: the slope is in qx, and g_err is set.  Returns how many go on. */
SGT_INLINE double march_steps(lanes *a, size_t n, double k, bool known, double none)
{
    double more = 0;
#pragma omp simd reduction(+ : more)
    for (size_t i = 0; i < filled(n); i++) {
        local q = LOCAL_OF(a, i);
        double f = a->f[i], tau = a->tau[i], end = a->end[i], defined = a->defined[i], phase = a->state[i],
               slope, g_err;
        if (known) {
            slope = a->qx[i], g_err = a->g_err[i];
        } else {
            sgt_vec3 p = {a->px[i], a->py[i], a->pz[i]}, grad = {a->fx[i], a->fy[i], a->fz[i]};
            around at = around_of(&q, tau, p, grad, none);
            slope = at.slope, g_err = at.place;
        }
        mark was = lanes_before(a, i);
        double sign = sign_of(f, g_err), both = was.sign * sign, falls = -was.sign * was.slope,
               rises = was.sign * slope, next = a->lo[i] + (k + 1) * a->dt[i];
        double valley = falls < rises ? falls : rises,
               told = fabs(sign) + (f == f ? 0.0 : 1.0) + (tau < end ? 0.0 : 1.0);
        valley = both < valley ? both : valley;
        defined = f == f ? 1.0 : defined;
        double seen = defined != 0 ? (double)SGT_UNPROVEN : (double)SGT_UNDEFINED,
               state = tau < end ? (double)MARCH : seen;
        state = both < 0 ? (double)NEWTON : state;
        state = valley > 0 ? (double)VALLEY : state;
        state = told == 0 ? (double)SGT_HARD : state;
        state = tau > was.tau ? state : (double)SGT_HARD;
        state = phase == MARCH ? state : phase;
        next = next < end ? next : end;
        bool goes = state == MARCH;
        more += goes ? 1.0 : 0.0;
        a->evals[i] += phase == MARCH ? 1.0 : 0.0;
        a->at[i] = goes ? tau : was.tau, a->g[i] = goes ? f : was.g;
        a->slope[i] = goes ? slope : was.slope, a->sign[i] = goes ? sign : was.sign;
        a->qx[i] = slope, a->qf[i] = sign;
        tau = goes ? next : tau;
        a->tau[i] = tau;
        a->defined[i] = defined;
        a->state[i] = state;
    }
    return more;
}

SGT_KERNEL
static double march_step(lanes *a, size_t n, double k, double none)
{
    return march_steps(a, n, k, false, none);
}
SGT_KERNEL
static double march_step_known(lanes *a, size_t n, double k) { return march_steps(a, n, k, true, 0); }

/* The lanes before a valley, one by one: hard, or marching on. */
static void march_over(lanes *a, size_t n, double k)
{
    for (size_t i = 0; i < n; i++) {
        if (a->state[i] != VALLEY) continue;
        mark was = lanes_before(a, i), is = after(a, i);
        if (dip_of(was, is)) {
            a->state[i] = SGT_HARD;
        } else if (!(is.tau < a->end[i])) {
            a->state[i] = a->defined[i] != 0 ? SGT_UNPROVEN : SGT_UNDEFINED;
        } else {
            double next = a->lo[i] + (k + 1) * a->dt[i];
            a->at[i] = is.tau, a->g[i] = is.g, a->slope[i] = is.slope, a->sign[i] = is.sign;
            a->tau[i] = next < a->end[i] ? next : a->end[i];
            a->state[i] = MARCH;
        }
    }
}

/* If nothing was seen, the answer is the stretch.  The lane is hard if nothing of it is left between the
 * ray's ends, or if it goes on behind the end of the march. */
static void march_end(lanes *a, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        if (a->state[i] != SGT_UNPROVEN && a->state[i] != SGT_UNDEFINED) continue;
        double from = (a->t0[i] + a->lo[i]) * a->scale[i], to = (a->t0[i] + a->hi[i]) * a->scale[i];
        from -= 2 * SGT_U * fabs(from), to += 2 * SGT_U * fabs(to);
        from = larger(from, a->tmin[i]), to = to < a->tmax[i] ? to : a->tmax[i];
        if (from > to || !(a->hi[i] <= a->end[i])) a->state[i] = SGT_HARD;
    }
}

/* Where the march has ended between unlike signs, Newton begins at the secant of the two. */
SGT_KERNEL
static void lanes_bracket(lanes *a, size_t n)
{
#pragma omp simd
    for (size_t i = 0; i < n; i++) {
        double at = a->at[i], tau = a->tau[i], g = a->g[i], f = a->f[i], width = tau - at, gm = fabs(g),
               gb = fabs(f);
        double seed = secant_of((mark){.tau = at, .g = g}, (mark){.tau = tau, .g = f}), state = a->state[i];
        bool crossed = state == NEWTON;
        double start = seed > at ? (double)NEWTON : (double)SGT_HARD;
        start = seed < tau ? start : (double)SGT_HARD;
        gm = gm < HUGE_VAL ? gm : 0, gb = gb < HUGE_VAL ? gb : 0;
        gm = larger(gm, gb);
        a->lo[i] = crossed ? at : a->lo[i];
        a->hi[i] = crossed ? tau : a->hi[i];
        a->tau[i] = crossed ? seed : tau;
        a->last[i] = crossed ? width : a->last[i];
        a->first[i] = crossed ? gm : a->first[i];
        a->state[i] = crossed ? start : state;
    }
}

static void lanes_march(lanes_job *w, size_t n)
{
    lanes *a = w->a;
    march_begin(a, n, w->opt->dt_min, !w->s.ops->span);
    size_t all = n;
    n = front(w, n, MARCH);
    for (double k = 0; n > 0; k++) {
        if (k + 1 >= w->budget) { /* spent, but for what confirms a root */
            for (size_t i = 0; i < n; i++)
                a->state[i] = a->state[i] == MARCH ? (double)SGT_HARD : a->state[i];
            break;
        }
        double more;
        points(a, n, a->tau);
        values_of(w->s, n, w->points, w->f);
        if (w->s.ops->rounding) {
            bound(w, n, a->tau, &w->f, a->qx, a->g_err, a->last, NULL);
            more = march_step_known(a, n, k);
        } else {
            more = march_step(a, n, k, a->none);
        }
        if (more < (double)n) march_over(a, n, k);
        if (4 * more <= 3 * (double)n) n = front(w, n, MARCH);
    }
    march_end(a, all);
    lanes_bracket(a, all);
}

/* ------------------------------------------------------------------ Newton's steps */

SGT_KERNEL
static void newton_begin(lanes *a, size_t n)
{
#pragma omp simd
    for (size_t i = 0; i < n; i++) {
        double first = a->first[i], f = fabs(a->f[i]);
        a->first[i] = first < 0 ? f : first;
    }
}

/* What is known of F's error before a step: nothing; what `bound` has set, the slope in qx and g_err; the
 * surface's own rounding, as ask_rounded has set it, and each a bound: then this is `bound` as well, and
 * `whole` is set to all of F's error, which g_err has only of a lane that is close. */
typedef enum step_known { PLACE_ALONE, BOUND_SET, OWN_SET } step_known;

/* Makes the step, and the points it leads to.  Returns how many go on.  A lane that is done writes values
 * that change nothing.  Leaving its rows as they are would be a branch. */
SGT_INLINE double newton_steps(lanes *a, size_t n, bool last_one, double f_tol, step_known known, double none,
                               const double *restrict own)
{
    double more = 0, again = last_one ? FAILED : NEWTON;
    size_t count = known == OWN_SET ? n : filled(n);
#pragma omp simd reduction(+ : more)
    for (size_t i = 0; i < count; i++) {
        local q = LOCAL_OF(a, i);
        double f = a->f[i], tau = a->tau[i], last = a->last[i], phase = a->state[i], slope, g_err;
        if (known == BOUND_SET) {
            slope = a->qx[i], g_err = a->g_err[i];
        } else {
            sgt_vec3 p = {a->px[i], a->py[i], a->pz[i]}, grad = {a->fx[i], a->fy[i], a->fz[i]};
            around at = around_of(&q, tau, p, grad, none);
            slope = at.slope, g_err = at.place;
        }
        if (known == OWN_SET) {
            double whole = g_err + own[i];
            a->whole[i] = whole;
            g_err = close_of(f, slope, g_err, last, f_tol) ? whole : g_err;
        }
        searched in = {a->lo[i], a->hi[i], a->least[i]};
        newton s = newton_of(f, slope, g_err, tau, last, in, a->t_tol[i], f_tol);
        double state = s.go >= 0 ? again : (double)FAILED;
        state = s.ready >= 0 ? (double)READY : state;
        state = phase == NEWTON ? state : phase;
        double step = state == NEWTON ? s.step : 0, size = state == NEWTON ? s.size : HUGE_VAL,
               goes = state == NEWTON ? 1.0 : 0.0;
        tau -= step;
        more += goes;
        a->evals[i] += phase == NEWTON ? 1.0 : 0.0;
        a->tau[i] = tau;
        a->px[i] = q.x + tau * q.l, a->py[i] = q.y + tau * q.m, a->pz[i] = q.z + tau * q.n;
        a->last[i] = size < last ? size : last;
        if (known != BOUND_SET) a->g_err[i] = g_err;
        a->state[i] = state;
    }
    return more;
}

SGT_KERNEL
static double newton_step(lanes *a, size_t n, bool last_one, double f_tol, double none)
{
    return newton_steps(a, n, last_one, f_tol, PLACE_ALONE, none, NULL);
}
SGT_KERNEL
static double newton_step_known(lanes *a, size_t n, bool last_one, double f_tol)
{
    return newton_steps(a, n, last_one, f_tol, BOUND_SET, 0, NULL);
}
SGT_KERNEL
static double newton_step_rounded(lanes *a, size_t n, bool last_one, double f_tol, double none,
                                  const double *restrict own)
{
    return newton_steps(a, n, last_one, f_tol, OWN_SET, none, own);
}

static void solve(lanes_job *w, size_t n)
{
    lanes *a = w->a;
    double f_tol = w->opt->f_tol, own[LANE_COUNT];
    points(a, n, a->tau);
    w->rounded = true;
    for (int i = 1; n > 0; i++) {
        double more;
        bool known = ask_rounded(w, n, &w->f, own);
        if (!known) values_of(w->s, n, w->points, w->f);
        if (i == 1) newton_begin(a, n);
        if (known && known_all(n, own) == (double)n) {
            more = newton_step_rounded(a, n, i == QUICK_STEPS, f_tol, a->none, own);
        } else if (w->s.ops->rounding) {
            bound(w, n, a->tau, &w->f, a->qx, a->g_err, a->last, known ? own : NULL);
            more = newton_step_known(a, n, i == QUICK_STEPS, f_tol);
            w->rounded = false;
        } else {
            more = newton_step(a, n, i == QUICK_STEPS, f_tol, a->none);
            w->rounded = false;
        }
        if (4 * more <= (double)n) n = front(w, n, NEWTON); /* to move a lane costs more than a step */
    }
}

/* ------------------------------------------------------------------- beside a root */

/* The signs at `tau`, whose points are set. */
static void signs(lanes_job *w, size_t n, const double *tau, double *sign)
{
    lanes *a = w->a;
    double own[LANE_COUNT];
    bool known = ask_rounded(w, n, &w->q, own);
    if (!known) values_of(w->s, n, w->points, w->q);
    bound(w, n, tau, &w->q, a->qx, sign, NULL, known ? own : NULL);
    for (size_t i = 0; i < n; i++) sign[i] = sign_of(a->qf[i], sign[i]);
}

/* Clears doubtful signs.  Beside a root |F| is greater than at it; where it is not, as next to a pole, the
 * sign is doubtful. */
SGT_KERNEL
static void unless_greater(const lanes *a, size_t n, double *sign)
{
#pragma omp simd
    for (size_t i = 0; i < n; i++) sign[i] = fabs(a->qf[i]) > fabs(a->f[i]) ? sign[i] : 0;
}

SGT_KERNEL
static void ends(lanes *a, size_t n)
{
#pragma omp simd
    for (size_t i = 0; i < n; i++) {
        bool finite = (a->lo[i] > -HUGE_VAL) & (a->hi[i] < HUGE_VAL) & (a->single[i] != 0);
        a->state[i] = finite ? (double)FAILED : (double)SGT_HARD;
    }
}

/* A miss has one certain sign at both ends of a span with at most one root.  If `least` is known and F is
 * not defined at one end, gone_by decides. */
SGT_NOINLINE static void miss(lanes_job *w, size_t n)
{
    lanes *a = w->a;
    if (!n) return;
    ends(a, n);
    n = front(w, n, FAILED);
    if (!n) return;
    points(a, n, a->lo);
    signs(w, n, a->lo, a->end);
    points(a, n, a->hi);
    signs(w, n, a->hi, a->beside);
    for (size_t i = 0; i < n; i++) {
        a->evals[i] += 2;
        bool none = a->end[i] * a->beside[i] > 0 || gone_by(a->end[i], a->beside[i], a->n[i], a->least[i]);
        a->state[i] = none && a->evals[i] <= w->budget ? (double)SGT_MISS : (double)SGT_HARD;
    }
}

/* How far to look from where Newton's steps have ended.  A lane that is ready by f_tol need not look.  If
 * |F| has grown, it is not at a root.  Returns how many lanes are to look. */
SGT_KERNEL
static double lanes_probe_begin(lanes *a, size_t n, double f_tol)
{
    double more = 0;
#pragma omp simd reduction(+ : more)
    for (size_t i = 0; i < n; i++) {
        double slope = a->fx[i] * a->l[i] + a->fy[i] * a->m[i] + a->fz[i] * a->n[i], g = fabs(a->f[i]);
        double tau_err = 2 * (g + a->g_err[i]) / fabs(slope),
               flat = tau_err < HUGE_VAL ? (double)ROOT : (double)SGT_HARD;
        a->dt[i] = width_of(a->f[i], slope, a->g_err[i], a->tau[i], a->t_tol[i],
                            (searched){a->lo[i], a->hi[i], a->least[i]});
        a->tau_err[i] = tau_err;
        a->last[i] = slope;
        double phase = a->state[i], state = g <= f_tol ? flat : (double)READY;
        state = g <= a->first[i] ? state : (double)SGT_HARD;
        state = phase == READY ? state : phase;
        more += state == READY ? 1.0 : 0.0;
        a->state[i] = state;
    }
    return more;
}

/* Sets both sides, and the points on the left.  Returns how many lanes have both sides inside the stretch. */
SGT_KERNEL
static double probe_sides(lanes *a, size_t n)
{
    double more = 0;
#pragma omp simd reduction(+ : more)
    for (size_t i = 0; i < n; i++) {
        double tau = a->tau[i], width = a->dt[i], left = tau - width, right = tau + width;
        bool inside = (left >= a->lo[i]) & (right <= a->hi[i]);
        a->tau_err[i] = larger(tau - left, right - tau);
        left = inside ? left : tau, right = inside ? right : tau;
        a->left[i] = left, a->right[i] = right;
        a->px[i] = a->x[i] + left * a->l[i], a->py[i] = a->y[i] + left * a->m[i],
        a->pz[i] = a->z[i] + left * a->n[i];
        a->dt[i] = 4 * width;
        more += inside ? 1.0 : 0.0;
        a->state[i] = inside ? (double)READY : (double)SGT_HARD;
    }
    return more;
}

/* What the signs say.  To the right of a pole F does not have the sign of the slope.  Returns how many are
 * to be asked again. */
SGT_KERNEL
static double probe_end(lanes *a, size_t n, double doubtful)
{
    double more = 0;
#pragma omp simd reduction(+ : more)
    for (size_t i = 0; i < n; i++) {
        double both = a->end[i] * a->beside[i], most = larger(both, -a->last[i] * a->beside[i]),
               state = most < 0 ? (double)ROOT : (double)SGT_HARD;
        state = both == 0 ? doubtful : state;
        more += state == READY ? 1.0 : 0.0;
        a->evals[i] += 2;
        a->state[i] = state;
    }
    return more;
}

/* Certifies the lanes whose slope along the span has a bound.  off: a bound on F's error.  Returns how
 * many still have to be asked beside the root. */
SGT_KERNEL
static double lanes_certify(lanes *a, size_t n, const double *off, const double *least)
{
    double more = 0;
#pragma omp simd reduction(+ : more)
    for (size_t i = 0; i < n; i++) {
        certified c = certified_of(a->tau[i], a->f[i], off[i], (searched){a->lo[i], a->hi[i], least[i]});
        double before = a->tau_err[i], phase = a->state[i], root = c.inside ? (double)ROOT : (double)READY;
        double state = phase == READY ? root : phase;
        a->tau_err[i] = state == ROOT && phase == READY ? c.tau_err : before;
        more += state == READY ? 1.0 : 0.0;
        a->state[i] = state;
    }
    return more;
}

/* lanes_probe_begin and lanes_certify in one: sets tau_err of each lane, and returns how many are certified.
 * Their states are left.  `whole` is set, and there is no f_tol. */
SGT_KERNEL
static double certify_ready(lanes *a, size_t n, const double *least)
{
    double done = 0;
#pragma omp simd reduction(+ : done)
    for (size_t i = 0; i < n; i++) {
        searched in = {a->lo[i], a->hi[i], least[i]};
        certified c = certified_of(a->tau[i], a->f[i], a->whole[i], in);
        a->tau_err[i] = c.tau_err;
        double is = c.inside ? 1.0 : 0.0;
        is = a->state[i] == READY ? is : 0;
        done += fabs(a->f[i]) <= a->first[i] ? is : 0;
    }
    return done;
}

SGT_KERNEL
static void set_states(lanes *a, size_t n, double state)
{
#pragma omp simd
    for (size_t i = 0; i < n; i++) a->state[i] = state;
}

/* For the lanes on which Newton's steps have been tried. */
static void probe(lanes_job *w, size_t n)
{
    lanes *a = w->a;
    const bool bounded = w->slopes || w->steep;
    const double *least = w->steep ? a->steep : a->least;
    if (bounded && w->rounded && !(w->opt->f_tol > 0) && certify_ready(a, n, least) == (double)n) {
        set_states(a, n, ROOT);
        return;
    }
    if (lanes_probe_begin(a, n, w->opt->f_tol > 0 ? w->opt->f_tol : -1) < (double)n) {
        miss(w, front(w, n, FAILED));
        n = front(w, n, READY);
    }
    if (bounded && n) {
        /* Without a t_tol a lane is ready by |F|, so it is close, and g_err has all of the rounding.  With
         * one the last step may be above the rounding. */
        bool again = !w->rounded && above_zero(n, a->t_tol) > 0;
        if (again) bound(w, n, a->tau, &w->f, a->qx, a->end, NULL, NULL);
        const double *off = w->rounded ? a->whole : again ? a->end : a->g_err;
        n = lanes_certify(a, n, off, least) > 0 ? front(w, n, READY) : 0;
    }
    for (int k = 1; n > 0; k++) {
        if (probe_sides(a, n) < (double)n) n = front(w, n, READY);
        if (!n) break;
        signs(w, n, a->left, a->end);
        unless_greater(a, n, a->end);
        points(a, n, a->right);
        signs(w, n, a->right, a->beside);
        unless_greater(a, n, a->beside);
        n = probe_end(a, n, k < PROBES ? (double)READY : (double)SGT_HARD) > 0 ? front(w, n, READY) : 0;
    }
}

/* ---------------------------------------------------------------------- acceptance */

/* Sets what is reported of every lane, in rows that are not needed any more: t in last, t_err in first,
 * t_lo in dt, p_err in end.  The gradient and the point stay where they are.  Returns how many are hits. */
SGT_KERNEL
static double lanes_take(lanes *a, size_t n, double budget, double rim2, double margin)
{
    double hits = 0;
#pragma omp simd reduction(+ : hits)
    for (size_t i = 0; i < n; i++) {
        double tau = a->tau[i];
        local q = LOCAL_OF(a, i);
        q.t0 = a->t0[i], q.scale = a->scale[i];
        sgt_vec3 p = {q.x + tau * q.l, q.y + tau * q.m, q.z + tau * q.n};
        around at = around_of(&q, tau, p, (sgt_vec3){a->fx[i], a->fy[i], a->fz[i]}, 0);
        double away = ((a->single[i] == 0) & (a->least[i] > 0)) ? END_ERRORS : margin; /* see vicinity.h */
        acceptance h = acceptance_of(&q, tau, a->tau_err[i], at,
                                     (limits){a->tmin[i], a->tmax[i], rim2, away});
        double doubt = a->least[i] > 0 ? (double)DOUBTED : (double)SGT_HARD;
        double off = h.off ? (double)SGT_MISS : doubt, state = a->single[i] != 0 ? off : (double)SGT_HARD;
        state = h.accepted ? (double)SGT_HIT : state;
        state = a->evals[i] <= budget ? state : (double)SGT_HARD;
        double phase = a->state[i];
        state = phase == ROOT ? state : phase;
        hits += state == SGT_HIT ? 1.0 : 0.0;
        a->state[i] = state;
        a->last[i] = h.t, a->first[i] = h.t_err, a->dt[i] = h.t_lo, a->end[i] = h.p_err;
        a->px[i] = p.x, a->py[i] = p.y, a->pz[i] = p.z;
    }
    return hits;
}

/* The lanes of which lanes_take could not tell whether the root is accepted, as in sgt_walk_sharpen. */
SGT_NOINLINE static void take_doubted(lanes_job *w, const sgt_tile *tile, size_t from, size_t n)
{
    lanes *a = w->a;
    const sgt_rays *r = &tile->rays;
    for (size_t i = 0; i < n; i++) {
        if (a->state[i] != DOUBTED) continue;
        size_t k = from + (size_t)a->slot[i];
        local q = LOCAL_OF(a, i);
        q.t0 = a->t0[i], q.scale = a->scale[i];
        sgt_vec3 grad = {a->fx[i], a->fy[i], a->fz[i]}, p = {a->px[i], a->py[i], a->pz[i]};
        sgt_vec3 o = {r->o[0][k], r->o[1][k], r->o[2][k]};
        double tau = a->tau[i], g = a->f[i], lo = a->lo[i], hi = a->hi[i];
        around at = around_of(&q, tau, p, grad, 0);
        a->state[i] = SGT_HARD;
        for (int j = 0; j < SHARPER && a->state[i] == (double)SGT_HARD && a->evals[i] + j <= w->budget; j++) {
            if (j) {
                q = moved_onto(&q, o, tau - g / at.slope, &lo, &hi);
                tau = 0, p = (sgt_vec3){q.x + tau * q.l, q.y + tau * q.m, q.z + tau * q.n};
                g = w->s.ops->value(w->s.self, p, &grad);
                at = around_of(&q, tau, p, grad, 0);
            }
            sharpened s = sharpened_of(w->s, &q, tau, g, at, (searched){lo, hi, a->least[i]},
                                       (limits){a->tmin[i], a->tmax[i], w->rim2, w->margin});
            if (!s.known || !(s.h.accepted | s.h.off)) continue;
            a->state[i] = s.h.accepted ? (double)SGT_HIT : (double)SGT_MISS, a->evals[i] += j;
            a->last[i] = s.h.t, a->first[i] = s.h.t_err, a->dt[i] = s.h.t_lo, a->end[i] = s.h.p_err;
            a->px[i] = p.x, a->py[i] = p.y, a->pz[i] = p.z;
            a->fx[i] = grad.x, a->fy[i] = grad.y, a->fz[i] = grad.z;
        }
    }
}

enum { TOLD = 10 };

/* Moves the lanes back to their places, and sets those without a root to NaN.  Returns how many are hard. */
static size_t lanes_settle(const lanes_job *w, size_t n, bool hits, double *const row_of[TOLD])
{
    lanes *a = w->a;
    for (size_t i = 0; i < n && w->moved; i++)
        for (size_t k; (k = (size_t)a->slot[i]) != i;) {
            double slot = a->slot[k], state = a->state[k], evals = a->evals[k];
            a->slot[k] = a->slot[i], a->state[k] = a->state[i], a->evals[k] = a->evals[i];
            a->slot[i] = slot, a->state[i] = state, a->evals[i] = evals;
            for (size_t j = 0; j < TOLD; j++) {
                double other = row_of[j][k];
                row_of[j][k] = row_of[j][i], row_of[j][i] = other;
            }
        }
    if (hits) return 0;
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < TOLD && !(a->state[i] > 0); j++) row_of[j][i] = (double)NAN;
    return count_of(a, n, SGT_HARD);
}

/* Copies each row to the caller's array, if it is wanted.  By vectors: a memcpy of unknown length is
 * slower, in code for any processor. */
SGT_KERNEL
static void copy(size_t n, double *const outs[TOLD], double *const rows[TOLD], size_t from)
{
    for (size_t j = 0; j < TOLD; j++) {
        if (!outs[j]) continue;
        double *out = outs[j] + from;
        const double *of = rows[j];
#pragma omp simd
        for (size_t i = 0; i < n; i++) out[i] = of[i];
    }
}

SGT_KERNEL
static void lanes_narrow(const lanes *a, size_t n, sgt_status *status, int *evals)
{
    int state[LANE_COUNT];
#pragma omp simd
    for (size_t i = 0; i < n; i++) state[i] = (int)a->state[i];
#pragma omp simd
    for (size_t i = 0; i < n; i++) status[i] = (signed char)state[i];
    if (!evals) return;
#pragma omp simd
    for (size_t i = 0; i < n; i++) evals[i] = (int)a->evals[i];
}

/* hits: all lanes are hits.  Returns how many are hard. */
static size_t write(const lanes_job *w, size_t n, bool hits, const sgt_hits *h, size_t from)
{
    lanes *a = w->a;
    double *const row_of[TOLD] = {a->last, a->first, a->dt, a->end, a->px, a->py, a->pz, a->fx, a->fy, a->fz};
    double *const out[TOLD] = {h->t,    h->t_err, h->t_lo, h->p_err, h->p[0],
                               h->p[1], h->p[2],  h->n[0], h->n[1],  h->n[2]};
    size_t hard = lanes_settle(w, n, hits, row_of);
    copy(n, out, row_of, from);
    lanes_narrow(a, n, h->status + from, h->evals ? h->evals + from : NULL);
    return hard;
}

/* ----------------------------------------------------------------------- all phases */

/* Answers at most LANE_COUNT rays that are valid; their tmin and tmax are in their lanes.  Returns how many
 * are hard. */
static size_t lanes_run(lanes_job *w, const sgt_tile *tile, size_t from, size_t n)
{
    lanes *a = w->a;
    w->moved = false;
    for (size_t i = n; i < filled(n); i++) a->state[i] = SGT_HARD;
    spans(w, tile, from, n);
    size_t solving = n;
    if (approach_lanes(w, tile, from, n) < (double)n) {
        size_t marching = front(w, n, MARCH);
        if (marching) lanes_march(w, marching);
        solving = front(w, n, NEWTON);
    }
    if (solving) {
        solve(w, solving);
        probe(w, solving);
    }
    bool hits = lanes_take(a, n, w->budget, w->rim2, w->margin) == (double)n;
    if (!hits) take_doubted(w, tile, from, n);
    return write(w, n, hits, &tile->hits, from);
}

/* Sets the state to 1 if the ray is valid, else to 0.  Returns how many are valid. */
SGT_KERNEL
static double door(lanes *a, const sgt_tile *tile, size_t from, size_t n)
{
    const double *ox = tile->rays.o[0] + from, *oy = tile->rays.o[1] + from, *oz = tile->rays.o[2] + from,
                 *tmin = tile->rays.tmin + from;
    const double *dx = tile->rays.d[0] + from, *dy = tile->rays.d[1] + from, *dz = tile->rays.d[2] + from,
                 *tmax = tile->rays.tmax + from;
    double valid = 0;
#pragma omp simd reduction(+ : valid)
    for (size_t i = 0; i < n; i++) {
        sgt_ray ray = {{ox[i], oy[i], oz[i]}, {dx[i], dy[i], dz[i]}, tmin[i], tmax[i]};
        double is = ray_valid(&ray) ? 1.0 : 0.0;
        valid += is;
        a->state[i] = is;
        a->tmin[i] = ray.tmin, a->tmax[i] = ray.tmax;
    }
    return valid;
}

size_t sgt_lanes_general(sgt_surface s, const sgt_tile *tile, const sgt_options *opt)
{
    const sgt_surface_ops *ops = s.ops;
    bool jumps = is_catalogue(ops) && ops->own_->jumps && ops->own_->jumps(s.self);
    /* one by one: a proof (proof.c), an F that jumps, or invalid parameters */
    if (opt->proof || jumps || !parameters_valid(s) || !rim_in_range(rim2_of_surface(s))) {
        memset(tile->hits.status, SGT_HARD, tile->n);
        return tile->n;
    }
    lanes a;
    sgt_options own = *opt;
    if (is_catalogue(ops)) own.f_tol = 0; /* as read_of in answer.c */
    memo *known = tile->memo;
    if (!known->begun) memo_begin(known);
    slopes_known *within = tile->slopes ? tile->slopes : &known->near;
    lanes_job w = {.s = s, .opt = &own, .a = &a, .kept = &known->kept, .within = within,
                   .near = opt->pick == SGT_NEAR_SEED,
                   .back = ops->enclose || ops->clearance ? 0x1p-50 : 0,
                   .budget = opt->max_evals ? opt->max_evals : SGT_DEFAULT_EVALS, .rim2 = rim2_of_surface(s),
                   .margin = ops->first && opt->pick != SGT_NEAR_SEED ? END_ERRORS : 0,
                   .slopes = is_catalogue(ops) && ops->own_->spans,
                   .steep = is_catalogue(ops) && ops->own_->firsts && opt->pick != SGT_NEAR_SEED,
                   .walks_from = ops->first || ops->enclose || ops->clearance ||
                                         (opt->dt_min > 0 && ops->estimate)
                                     ? HUGE_VAL
                                     : -HUGE_VAL};
    size_t hard = 0;
    a.none = 0;
    if (is_catalogue(ops) && ops->own_->share) {
        if (!within->shares) ops->own_->share(s.self, &within->shared);
        within->shares = true, w.shared = within->shared, w.bare = bare_of(w.shared);
    }
    for (int i = 0; i < LANE_COUNT; i++) a.slot[i] = i; /* lanes_settle restores this after each run */
    w.points = (sgt_points){{a.px, a.py, a.pz}};
    w.f = (sgt_values){a.f, {a.fx, a.fy, a.fz}}, w.q = (sgt_values){a.qf, {a.qx, a.qy, a.qz}};
    for (size_t i = 0, n; i < tile->n; i += n) {
        size_t most = tile->n - i < LANE_COUNT ? tile->n - i : LANE_COUNT;
        n = most;
        if (door(&a, tile, i, most) < (double)most)
            for (n = 0; n < most && a.state[n] != 0;) n++;
        if (n) hard += lanes_run(&w, tile, i, n);
        else tile->hits.status[i] = SGT_HARD, hard++, n = 1;
    }
    return hard;
}
