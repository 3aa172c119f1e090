// SPDX-License-Identifier: MIT
/* asphere.c - a conic plus the sum P of a[i] r^(2i+2): Newton's method, certified.
 *
 * F = z - s(r^2) - P(r^2) is solved in the polynomial form G of poly.c.  G has the roots of F, and poly.c
 * has the certificate for a root of it.  The forms, in the order in which a ray meets them:
 *
 * EASY.  Four evaluations on lens surfaces, for the single ray and for lanes: asphere/easy.h.  It answers
 * first roots without a rim too.  If it ends without a hit, the ray may start on the surface, and leave it
 * (LEAVING in asphere/unique.c).
 *
 * FROM THE SIDE.  What is not easy, from the point of the ray nearest the vertex: asphere/side.h.  It answers
 * where the sag is bent in one way, and rays that pass by.  Not under proof.
 *
 * QUICK.  For what is not easy.  Newton's method from the conic's root near the vertex, each step at most
 * half the last.  If t is not sharp, the root is settled from there.  The root is certainly the only one
 * within the rim if
 *     |n| > L sqrt(a),  L = max |grad s| over the rim,  a = l^2 + m^2:
 * F is then monotone along the chord.  If that root is the start itself, the ray misses.  Only such a root
 * can be told to be the first one, so first roots are looked for on these rays only.
 *
 * Why apart: the cells alone would do.  Without it (192 pairs of an asphere and a kind of ray each, by
 * callgrind) rays near the seed cost 1.14 times as much in the mean, up to 9.1 times, and first roots up to
 * 2.7 times where the slope allows one root.  Where it does not, asking in vain cost up to 1.9 times as much.
 *
 * CAREFUL.  All else: the march in classify.c, which is certain too, but slower.
 *
 * THE ONLY ROOT near the seed, under proof: the same test.  If it does not decide, asphere/unique.c.
 *
 * The last evaluation of a hit is that of F at the point returned. */
#include "asphere.h"

#include "../../solve/root.h"
#include "../../solve/ways.h"
#include "../conic/conic.h"
#include "side.h"
#include "../sag/second.h"

/* ------------------------------------------------------------------- easy */

/* Is the root at tau the first one by the bend of F (side.h)? */
SGT_NOINLINE static bool is_first_bent(const wavy *s, const bent_root *r, const sgt_ray *ray)
{
    convex b = convex_of(s);
    bool is = false;
    for (int rounds = 1; rounds <= 2 && !is; rounds++) is = first_of_bent(s, &b, ALL_TERMS, rounds, r, ray);
    return is;
}

/* Does the ray start on the surface, and meet nothing else? */
SGT_NOINLINE static bool asphere_leaves_it(const wavy *s, const shape *h, const sgt_ray *ray)
{
    mask leaves = MASK(true);
    sgt_tile one = {.n = 1, .rays = rays_of(ray)};
    if (!sgt_asphere_may_start(s, &one)) return false;
    sgt_asphere_leave(h, s, &one, &leaves);
    return leaves != 0;
}

/* Does the form from the side have the first word? */
SGT_NOINLINE static bool grazes_at(const wavy *s, const sgt_ray *ray)
{
    const convex b = convex_of(s);
    return grazes(s, &b, ALL_TERMS, ray) != 0;
}

/* How far the rounds of a ray have come. */
typedef struct easy_rounds {
    wavy_start r;
    wavy_round q;
    double inverse;
    int evals;
} easy_rounds;

/* The answer after the rounds.  The ray has explicit ends. */
SGT_NOINLINE
static easy_answer easy_judged(const wavy *s, const shape *h, bool first, const easy_rounds *at,
                               const sgt_ray *ray, double t_tol, lane *e)
{
    const wavy_start r = at->r;
    const wavy_round q = at->q;
    near_root root = wavy_root(r.x, r.y, r.t0, r.t0_lo, q.tau, q.tau_err);
    const lane end = wavy_end_any(s, ALL_TERMS, &root, &q, at_vertex(r.x, r.y, ray->o.z), ray, t_tol, false);
    *e = lane_if_met(&end);
    if (!e->hit) {
        bool misses = wavy_away(s, ALL_TERMS, &root, q.v, at->inverse, ray) ||
                      (q.tau == q.tau && asphere_leaves_it(s, h, ray));
        return misses ? EASY_MISS : EASY_NOT;
    }
    bool is_first = !first || wavy_single(s, ray->d.x, ray->d.y, ray->d.z);
    if (!is_first)
        is_first = (s->disc > 0 && wavy_first_within(s, r.t0, r.x, r.y, q.tau, ray)) ||
                   wavy_first_from(s, ALL_TERMS, r.t0, r.x, r.y, q.tau, ray) ||
                   is_first_bent(s, &(bent_root){r.t0, r.x, r.y, q.tau, at->inverse}, ray);
    return is_first && (!s->proof || wavy_sure(s, r.x, r.y, r.t0, q.tau_err, ray->d.x, ray->d.y) != 0)
               ? EASY_HIT
               : EASY_NOT;
}

/* One ray with explicit ends.  Its evaluations are counted and reported, whatever the answer.  h, from: for a
 * watcher. */
static easy_answer asphere_easy_at(const wavy *s, bool first, const sgt_ray *ray, double scale, lane *e,
                                   tally *w, const shape *h, const sgt_ray *from)
{
    const double t_tol = w->opt->t_tol / scale;
    double g, slope;
    const vertex_place vertex = to_vertex_plane(ray);
    wavy_start r = wavy_begin(s, ALL_TERMS, &vertex, ray, &g, &slope);
    wavy_round q = {.tau = r.tau, .again = MASK(true)};
    wavy_newton half = {.inverse = 0};
    local at = {.t0 = r.t0, .t0_lo = r.t0_lo, .scale = scale};
    observe(h, from, w, &at, r.tau + g / slope, SGT_SEED, -HUGE_VAL, HUGE_VAL);
    if (first && wavy_hopeless(s, ray)) return EASY_NOT;
    if (first && s->side && wavy_along(ray) && grazes_at(s, ray)) return EASY_GRAZES;
    if (s->disc == STRONG && r.tau == r.tau && !w->stopped) {
        q.tau = wavy_strong(s, ALL_TERMS, r.x, r.y, r.tau, ray);
        observe(h, from, w, &at, r.tau, SGT_NEWTON, -HUGE_VAL, HUGE_VAL);
        if (!w->stopped) observe(h, from, w, &at, q.tau, SGT_NEWTON, -HUGE_VAL, HUGE_VAL);
    }
    for (int i = 0; i < ROUNDS && q.again && r.tau == r.tau && !w->stopped; i++) {
        double tau = q.tau;
        half = wavy_half(s, ALL_TERMS, r.x, r.y, tau, ray);
        q = wavy_bound_either(s, ALL_TERMS, &r, &half, i + 1 == ROUNDS, ray, t_tol);
        observe(h, from, w, &at, tau, SGT_NEWTON, -HUGE_VAL, HUGE_VAL);
        if (!w->stopped) observe(h, from, w, &at, half.tau2, SGT_NEWTON, -HUGE_VAL, HUGE_VAL);
    }
    if (w->stopped || !(r.tau == r.tau)) return EASY_NOT;
    return easy_judged(s, h, first, &(easy_rounds){r, q, half.inverse, w->evals}, ray, t_tol, e);
}

/* A direction of unusual length is scaled by a power of two.  For usual lengths that would change no bit. */
static easy_answer easy(const wavy *s, const shape *h, const sgt_ray *ray, lane *e, tally *w)
{
    const sgt_options *opt = w->opt;
    const sgt_vec3 d = ray->d;
    bool first = opt->pick != SGT_NEAR_SEED;
    double scale = scale_of(d);
    if (usual_length((d.x * d.x + d.y * d.y) + d.z * d.z))
        return asphere_easy_at(s, first, ray, 1, e, w, h, ray);
    if (!ends_are_whole(ray, scale)) return EASY_NOT;
    const sgt_ray along = along_scaled(ray, scale);
    easy_answer is = asphere_easy_at(s, first, &along, scale, e, w, h, ray);
    return is == EASY_HIT ? easy_unscaled(e, scale) : is;
}

/* What the loops of a tile leave for each other. */
typedef struct wavy_room {
    _Alignas(64) double x[SGT_TILE];
    double y[SGT_TILE], t0[SGT_TILE], t0_lo[SGT_TILE], from[SGT_TILE], tau[SGT_TILE], tau_err[SGT_TILE],
        v[SGT_TILE], near[SGT_TILE];
    double tau2[SGT_TILE], step2[SGT_TILE], inverse[SGT_TILE], dw[SGT_TILE];
    mask again[SGT_TILE], next[SGT_TILE];
    lane_ends ends;
    bool grazes; /* some do */
} wavy_room;

/* Removes the hits whose side of the rim is not certain.  Returns all bits set if none was removed. */
SGT_KERNEL
static mask asphere_sure_all(const wavy *self, const sgt_tile *tile, wavy_room *room)
{
    const wavy own = *self, *s = &own;
    const double *l = tile->rays.d[0], *m = tile->rays.d[1];
    size_t count = tile->n;
    mask all = MASK(true);
    _Pragma("omp simd reduction(& : all)") for (size_t i = 0; i < count; i++) {
        mask hit = room->ends.hit[i] &
                   wavy_sure(s, room->x[i], room->y[i], room->t0[i], room->tau_err[i], l[i], m[i]);
        room->ends.hit[i] = hit;
        all &= hit;
    }
    return all;
}

/* Is the root of each hit the first one?  The answers are in room->again. */
SGT_INLINE bool all_first(const wavy *s, int terms, const sgt_tile *tile, wavy_room *room)
{
    const sgt_rays rows = tile->rays;
    size_t count = tile->n;
    mask every = MASK(true);
    if (s->single < HUGE_VAL || !(s->disc > 0))
        _Pragma("omp simd reduction(& : every)") for (size_t i = 0; i < count; i++)
        {
            const sgt_ray ray = lane_ray_of(&rows, i);
            mask is = wavy_single(s, ray.d.x, ray.d.y, ray.d.z) | ~room->ends.hit[i];
            room->again[i] = is;
            every &= is;
        }
    else
        _Pragma("omp simd reduction(& : every)") for (size_t i = 0; i < count; i++)
        {
            const sgt_ray ray = lane_ray_of(&rows, i);
            mask is = wavy_first_within(s, room->t0[i], room->x[i], room->y[i], room->tau[i], &ray) |
                      ~room->ends.hit[i];
            room->again[i] = is;
            every &= is;
        }
    if (every) return true;
    every = MASK(true);
    _Pragma("omp simd reduction(& : every)") for (size_t i = 0; i < count; i++)
    {
        const sgt_ray ray = lane_ray_of(&rows, i);
        mask is = room->again[i] |
                  wavy_first_from(s, terms, room->t0[i], room->x[i], room->y[i], room->tau[i], &ray);
        room->again[i] = is;
        every &= is;
    }
    return every != 0;
}

/* The rays that all_first leaves, side by side: mostly they are few.  from, r2, off: as in a side_way. */
typedef struct bent_rays {
    const double *x, *y, *t0, *tau, *inverse, *l, *m, *n, *tmin;
} bent_rays;
typedef struct bent_room {
    _Alignas(64) double of[9][SGT_TILE], from[SGT_TILE], r2[SGT_TILE];
    mask known[SGT_TILE], off[SGT_TILE], is[SGT_TILE];
    size_t number[SGT_TILE];
} bent_room;

/* first_of_bent of them, with `rounds` of comes_near.  (In a loop for each part: of all in one gcc 12 makes
 * branches.) */
SGT_INLINE mask bent_lanes(const wavy *self, int terms, int rounds, size_t count, const bent_rays *rays,
                           bent_room *r)
{
    const wavy own = *self, *s = &own;
    const convex bent = convex_of(s), *b = &bent;
    const double *x = rays->x, *y = rays->y, *t0 = rays->t0, *tau = rays->tau, *inverse = rays->inverse,
                 *l = rays->l, *m = rays->m, *n = rays->n, *tmin = rays->tmin;
    LANES for (size_t i = 0; i < count; i++)
    {
        const sgt_ray ray = {.d = {l[i], m[i], n[i]}, .tmin = tmin[i]};
        bent_start at = bent_start_of(b, &(bent_root){t0[i], x[i], y[i], tau[i], 0}, &ray);
        r->from[i] = at.from, r->r2[i] = at.r2, r->known[i] = at.known, r->off[i] = 0;
    }
    for (int round = 0; round < rounds; round++)
        LANES for (size_t i = 0; i < count; i++)
        {
            const sgt_ray ray = {.d = {l[i], m[i], n[i]}};
            double from = r->from[i];
            side_way way = {from, r->r2[i], 0};
            way = comes_near(s, terms, way, wavy_r2(x[i], y[i], tau[i], l[i], m[i]),
                             &(side_local){x[i], y[i], 0, 0}, &ray);
            r->from[i] = way.from, r->r2[i] = way.r2;
            r->off[i] |= MASK(way.from > from);
        }
    mask every = MASK(true);
    _Pragma("omp simd reduction(& : every)") for (size_t i = 0; i < count; i++)
    {
        const sgt_ray ray = {.d = {l[i], m[i], n[i]}};
        side_way way = {r->from[i], r->r2[i], r->off[i]};
        mask is = r->known[i] & bent_is_first(s, b, terms, &way, inverse[i], &ray);
        r->is[i] = is;
        every &= is;
    }
    return every;
}

SGT_KERNEL
static mask asphere_lanes_few_bent(const wavy *s, int rounds, size_t count, const bent_rays *rays,
                                   bent_room *r)
{
    return bent_lanes(s, FEW_TERMS, rounds, count, rays, r);
}
SGT_KERNEL
static mask asphere_lanes_all_bent(const wavy *s, int rounds, size_t count, const bent_rays *rays,
                                   bent_room *r)
{
    return bent_lanes(s, ALL_TERMS, rounds, count, rays, r);
}

/* The same as all_first for those that are left, by the bend of F (side.h). */
SGT_NOINLINE static bool all_bent(const wavy *s, int terms, const sgt_tile *tile, wavy_room *room)
{
    bent_room r;
    const double *const *const d = tile->rays.d;
    const bent_rays all = {room->x, room->y, room->t0, room->tau, room->inverse,
                           d[0],    d[1],    d[2],     tile->rays.tmin},
                    few = {r.of[0], r.of[1], r.of[2], r.of[3], r.of[4],
                           r.of[5], r.of[6], r.of[7], r.of[8]};
    const double *const from[9] = {all.x, all.y, all.t0, all.tau, all.inverse, all.l, all.m, all.n, all.tmin};
    for (int rounds = 1; rounds <= 2; rounds++) {
        size_t left = 0;
        for (size_t i = 0; i < tile->n; i++)
            if (!room->again[i]) r.number[left++] = i;
        const bent_rays *rays = left == tile->n ? &all : &few;
        for (int k = 0; k < 9 && rays == &few; k++)
            for (size_t i = 0; i < left; i++) r.of[k][i] = from[k][r.number[i]];
        bool every =
            (terms > FEW_TERMS ? asphere_lanes_all_bent : asphere_lanes_few_bent)(s, rounds, left, rays, &r);
        for (size_t i = 0; i < left; i++) room->again[r.number[i]] = r.is[i];
        if (every) return true;
    }
    return false;
}

SGT_INLINE void lane_away(const wavy *self, int terms, const sgt_tile *tile, wavy_room *room)
{
    const sgt_rays rows = tile->rays;
    const wavy own = *self, *s = &own;
    size_t count = tile->n;
    LANES for (size_t i = 0; i < count; i++) {
        const sgt_ray ray = lane_ray_of(&rows, i);
        near_root r =
            wavy_root(room->x[i], room->y[i], room->t0[i], room->t0_lo[i], room->tau[i], room->tau_err[i]);
        room->again[i] = wavy_away(s, terms, &r, room->v[i], room->inverse[i], &ray);
    }
}

SGT_KERNEL
static void asphere_lanes_few_away(const wavy *s, const sgt_tile *tile, wavy_room *room)
{
    lane_away(s, FEW_TERMS, tile, room);
}

SGT_KERNEL
static void asphere_lanes_all_away(const wavy *s, const sgt_tile *tile, wavy_room *room)
{
    lane_away(s, ALL_TERMS, tile, room);
}

/* Gives SGT_MISS to the hard rays that certainly miss, and returns the number still hard.  A miss has one
 * evaluation less: a hit's last one is F at the point. */
static size_t without_misses(const wavy *s, int terms, const sgt_tile *tile, wavy_room *room, size_t hard)
{
    if (terms > FEW_TERMS) asphere_lanes_all_away(s, tile, room);
    else asphere_lanes_few_away(s, tile, room);
    for (size_t i = 0; i < tile->n; i++) {
        if (tile->hits.status[i] != SGT_HARD || !room->again[i]) continue;
        tile->hits.status[i] = SGT_MISS, hard--;
        if (tile->hits.evals) tile->hits.evals[i]--;
    }
    return hard;
}

SGT_KERNEL
static void asphere_unmet(const lane_to *to, size_t count) { lane_unmet(to, false, count); }

SGT_KERNEL
static void asphere_unmet_rich(const lane_to *to, size_t count) { lane_unmet(to, true, count); }

/* The last loop: point, gradient, acceptance.  vertex: also for rays that start in the vertex. */
SGT_INLINE mask lane_ending(const wavy *s, int terms, lane_wish wish, bool vertex, const sgt_tile *tile,
                             wavy_room *room)
{
    const sgt_rays rows = tile->rays;
    const double *t_tol = tile->t_tol;
    size_t count = tile->n;
    const bool whole = wish == LANE_BARE;
    const lane_to to = lane_to_of(tile, &room->ends);
    mask all = MASK(true);
    _Pragma("omp simd reduction(& : all)") for (size_t i = 0; i < count; i++) {
        const sgt_ray ray = lane_ray_of(&rows, i);
        near_root r =
            wavy_root(room->x[i], room->y[i], room->t0[i], room->t0_lo[i], room->tau[i], room->tau_err[i]);
        mask exact = vertex ? at_vertex(r.x, r.y, ray.o.z) : 0;
        const wavy_round q = {.v = room->v[i], .near = room->near[i]};
        lane e = wavy_end_any(s, terms, &r, &q, exact, &ray, t_tol[i], whole);
        LANE_STORE_ALL(to, i, e, wish);
        all &= e.hit;
    }
    if (!all) (wish >= LANE_FINE ? asphere_unmet_rich : asphere_unmet)(&to, count);
    return all;
}

/* The rays that graze do not begin.  Returns all bits set if there are such. */
SGT_KERNEL
static mask asphere_lanes_grazing(const wavy *self, const convex *bent, const sgt_tile *tile, wavy_room *room)
{
    const sgt_rays rows = tile->rays;
    const wavy own = *self, *s = &own;
    const convex mine = *bent, *b = &mine;
    size_t count = tile->n;
    mask any = 0;
    _Pragma("omp simd reduction(| : any)") for (size_t i = 0; i < count; i++) {
        const sgt_ray ray = lane_ray_of(&rows, i);
        const mask is = grazes(s, b, ALL_TERMS, &ray);
        room->from[i] = chosen(is, (double)NAN, room->from[i]);
        any |= is;
    }
    return any;
}

/* convex_of, once in the code of the loops. */
SGT_NOINLINE static void tile_bend_of(const wavy *s, convex *b) { *b = convex_of(s); }

SGT_NOINLINE static mask without_grazing(const wavy *s, const sgt_tile *tile, wavy_room *room)
{
    convex b;
    tile_bend_of(s, &b);
    return asphere_lanes_grazing(s, &b, tile, room);
}

/* THE BOUND of easy.h for the rays from `begin` to `end`; some: but for those that have one by constants
 * (again[i]).  Then again[i]: another round may succeed.  Returns all bits set if it is any. */
SGT_INLINE mask lane_bound(const wavy *self, int terms, bool some, const sgt_tile *tile, wavy_room *room,
                           size_t begin, size_t end)
{
    const sgt_rays rows = tile->rays;
    const double *t_tol = tile->t_tol;
    const wavy own = *self, *s = &own;
    mask any = 0;
    _Pragma("omp simd reduction(| : any)") for (size_t i = begin; i < end; i++)
    {
        const sgt_ray ray = lane_ray_of(&rows, i);
        const double x = room->x[i], y = room->y[i];
        const wavy_newton h = {.tau2 = room->tau2[i],
                               .step2 = room->step2[i],
                               .inverse = room->inverse[i],
                               .dw = room->dw[i],
                               .slant = wavy_slant(x, y, room->from[i], &ray)};
        wavy_round q = wavy_bound(s, terms, x, y, room->t0[i], &h, &ray, t_tol[i]);
        if (some) {
            const mask had = room->again[i];
            q.again &= ~had;
            q.tau = chosen(had, room->tau[i], q.tau), q.tau_err = chosen(had, room->tau_err[i], q.tau_err);
            q.v = chosen(had, room->v[i], q.v), q.near = chosen(had, room->near[i], q.near);
        }
        room->tau[i] = q.tau, room->tau_err[i] = q.tau_err, room->v[i] = q.v, room->near[i] = q.near,
        room->again[i] = q.again;
        any |= q.again;
    }
    return any;
}

#define LANES_BOUND(name, terms, some)                                                                \
    SGT_KERNEL static mask name(const wavy *s, const sgt_tile *tile, wavy_room *room, size_t begin,   \
                                size_t end)                                                           \
    {                                                                                                 \
        return lane_bound(s, terms, some, tile, room, begin, end);                                    \
    }

LANES_BOUND(asphere_lanes_few_bound, FEW_TERMS, false)
LANES_BOUND(asphere_lanes_few_bound_some, FEW_TERMS, true)
LANES_BOUND(asphere_lanes_all_bound, ALL_TERMS, false)
LANES_BOUND(asphere_lanes_all_bound_some, ALL_TERMS, true)

/* Of the rays that have no bound by constants (again[i] is 0): which do not want another one, as they are to
 * make a round more (wavy_nears, into `next`), or have not begun?  Then again[i] is set. */
SGT_KERNEL
static mask asphere_near_rays(const wavy *self, bool last, const sgt_tile *tile, wavy_room *room)
{
    const sgt_rays rows = tile->rays;
    const wavy own = *self, *s = &own;
    const mask more = MASK(!last);
    size_t count = tile->n;
    mask any = 0;
    _Pragma("omp simd reduction(| : any)") for (size_t i = 0; i < count; i++)
    {
        const sgt_ray ray = lane_ray_of(&rows, i);
        const wavy_newton h = {.tau2 = room->tau2[i], .step2 = room->step2[i], .tau1 = room->from[i]};
        const mask had = room->again[i],
                   next = ~had & more & wavy_nears(s, room->x[i], room->y[i], &h, room->tau[i], &ray);
        room->next[i] = next, room->again[i] = had | next | ~MASK(room->from[i] == room->from[i]);
        any |= next;
    }
    return any;
}

/* The same of a whole tile, for the parts of it in which some ray has no bound by constants.  last: no other
 * round may follow. */
SGT_NOINLINE static mask lane_bounds(const wavy *s, int terms, bool last, const sgt_tile *tile,
                                     wavy_room *room)
{
    enum { PART = 16 };
    mask any = asphere_near_rays(s, last, tile, room);
    const mask nears = any;
    size_t from = 0;
    for (size_t i = 0; i < tile->n; i += PART) {
        const size_t end = i + PART < tile->n ? i + PART : tile->n;
        mask had = MASK(true);
        for (size_t j = i; j < end; j++) had &= room->again[j];
        if (had) memset(room->again + i, 0, (end - i) * sizeof had);
        if (had || end == tile->n) {
            const size_t to = had ? i : end;
            if (from < to)
                any |= (terms > FEW_TERMS ? asphere_lanes_all_bound_some : asphere_lanes_few_bound_some)(
                    s, tile, room, from, to);
            from = end;
        }
    }
    for (size_t i = 0; nears && i < tile->n; i++) room->again[i] |= room->next[i];
    return any;
}

/* The seeds, in two loops or `at_once` in one.  Returns all bits set if wavy_hopeless or `grazes` may have
 * something to say. */
SGT_INLINE mask lane_begin(const wavy *self, int terms, bool first, bool at_once, const sgt_tile *tile,
                           wavy_room *room)
{
    const sgt_rays rows = tile->rays;
    const wavy own = *self, *s = &own;
    size_t count = tile->n;
    mask odd = 0;
    if (!at_once)
        LANES for (size_t i = 0; i < count; i++)
        {
            const sgt_ray ray = lane_ray_of(&rows, i);
            const vertex_place at = to_vertex_plane(&ray);
            room->x[i] = at.x, room->y[i] = at.y, room->t0[i] = at.t0, room->t0_lo[i] = at.t0_lo;
        }
    _Pragma("omp simd reduction(| : odd)") for (size_t i = 0; i < count; i++)
    {
        const sgt_ray ray = lane_ray_of(&rows, i);
        vertex_place at;
        double g, slope;
        if (at_once) {
            at = to_vertex_plane(&ray);
            room->x[i] = at.x, room->y[i] = at.y, room->t0[i] = at.t0, room->t0_lo[i] = at.t0_lo;
        } else
            at = (vertex_place){.x = room->x[i], .y = room->y[i]};
        room->from[i] = wavy_begin(s, terms, &at, &ray, &g, &slope).tau;
        if (first) odd |= wavy_along(&ray) | MASK(ray.tmin == -HUGE_VAL);
    }
    return odd;
}

/* The rounds from the seeds.  Returns how many; extra[i]: how many more than one ray i takes, if any does. */
SGT_INLINE int lane_rounds(const wavy *self, int terms, const sgt_tile *tile, wavy_room *room, int extra[])
{
    const sgt_rays rows = tile->rays;
    const wavy own = *self, *s = &own;
    size_t count = tile->n;
    int rounds = 1;
    for (;; rounds++) {
        mask near = 0, any = 0;
        _Pragma("omp simd reduction(| : near)") for (size_t i = 0; i < count; i++)
        {
            const sgt_ray ray = lane_ray_of(&rows, i);
            const double tau1 = room->from[i];
            wavy_newton h = wavy_half(s, terms, room->x[i], room->y[i], tau1, &ray);
            room->tau2[i] = h.tau2, room->step2[i] = h.step2, room->inverse[i] = h.inverse,
            room->dw[i] = h.dw;
            near |= wavy_within(s, room->x[i], room->y[i], tau1, &ray);
        }
        if (near) {
            LANES for (size_t i = 0; i < count; i++)
            {
                const sgt_ray ray = lane_ray_of(&rows, i);
                wavy_second at = wavy_second_of(s, terms, room->x[i], room->y[i], room->tau2[i], &ray);
                room->near[i] = at.rho, room->v[i] = at.w, room->tau[i] = at.g;
            }
            mask every = MASK(true);
            _Pragma("omp simd reduction(& : every)") for (size_t i = 0; i < count; i++)
            {
                const sgt_ray ray = lane_ray_of(&rows, i);
                const wavy_newton h = {.tau2 = room->tau2[i],
                                       .step2 = room->step2[i],
                                       .inverse = room->inverse[i],
                                       .dw = room->dw[i]};
                const wavy_second at = {room->near[i], room->v[i], room->tau[i]};
                wavy_round q = wavy_bound_within(s, room->x[i], room->y[i], room->t0[i], &h, &at, &ray);
                const mask is = MASK(q.tau_err == q.tau_err);
                room->tau[i] = q.tau, room->tau_err[i] = q.tau_err, room->v[i] = q.v, room->near[i] = q.near,
                room->again[i] = is;
                every &= is;
            }
            if (every) break;
            any = lane_bounds(self, terms, rounds == ROUNDS, tile, room);
        } else
            any = (terms > FEW_TERMS ? asphere_lanes_all_bound : asphere_lanes_few_bound)(self, tile, room, 0,
                                                                                          count);
        if (!any || rounds == ROUNDS) break;
        /* Rays that are done take another round too, with the same result. */
        for (size_t i = 0; i < count; i++) {
            extra[i] = (rounds > 1 ? extra[i] : 0) + (room->again[i] ? 1 : 0);
            if (room->again[i]) room->from[i] = room->tau[i];
        }
    }
    return rounds;
}

SGT_KERNEL
static int asphere_lanes_few_rounds(const wavy *s, const sgt_tile *tile, wavy_room *room, int extra[])
{
    return lane_rounds(s, FEW_TERMS, tile, room, extra);
}
SGT_KERNEL
static int asphere_lanes_all_rounds(const wavy *s, const sgt_tile *tile, wavy_room *room, int extra[])
{
    return lane_rounds(s, ALL_TERMS, tile, room, extra);
}

/* STRONG TERMS: one more step. */
SGT_INLINE void lane_strong(const wavy *self, int terms, const sgt_tile *tile, wavy_room *room)
{
    const sgt_rays rows = tile->rays;
    const wavy own = *self, *s = &own;
    size_t count = tile->n;
    LANES for (size_t i = 0; i < count; i++)
    {
        const sgt_ray ray = lane_ray_of(&rows, i);
        room->from[i] = wavy_strong(s, terms, room->x[i], room->y[i], room->from[i], &ray);
    }
}

SGT_KERNEL
static void asphere_lanes_few_strong(const wavy *s, const sgt_tile *tile, wavy_room *room)
{
    lane_strong(s, FEW_TERMS, tile, room);
}
SGT_KERNEL
static void asphere_lanes_all_strong(const wavy *s, const sgt_tile *tile, wavy_room *room)
{
    lane_strong(s, ALL_TERMS, tile, room);
}

#define LANES_BEGIN(name, terms, first)                                                              \
    SGT_KERNEL static mask name(const wavy *s, const sgt_tile *tile, wavy_room *room)                \
    {                                                                                                \
        return tile->far ? lane_begin(s, terms, first, true, tile, room)                             \
                         : lane_begin(s, terms, first, false, tile, room);                           \
    }

LANES_BEGIN(asphere_lanes_few_begin_near, FEW_TERMS, false)
LANES_BEGIN(asphere_lanes_few_begin_first, FEW_TERMS, true)
LANES_BEGIN(asphere_lanes_all_begin_near, ALL_TERMS, false)
LANES_BEGIN(asphere_lanes_all_begin_first, ALL_TERMS, true)

SGT_INLINE size_t lane_terms(const wavy *self, int terms, bool first, lane_wish wish, const sgt_tile *tile,
                             wavy_room *room)
{
    const sgt_rays rows = tile->rays;
    const wavy own = *self, *s = &own; /* a copy, so that no output can alias it */
    size_t count = tile->n;
    const mask odd =
        terms > FEW_TERMS
            ? (first ? asphere_lanes_all_begin_first : asphere_lanes_all_begin_near)(self, tile, room)
            : (first ? asphere_lanes_few_begin_first : asphere_lanes_few_begin_near)(self, tile, room);
    if (odd)
        LANES for (size_t i = 0; i < count; i++)
        {
            const sgt_ray ray = lane_ray_of(&rows, i);
            room->from[i] = chosen(wavy_hopeless(s, &ray), (double)NAN, room->from[i]);
        }
    room->grazes = odd && s->side && without_grazing(self, tile, room);
    size_t begun = 0;
    while (begun < count && !(room->from[begun] == room->from[begun])) begun++;
    if (begun == count) { /* no ray: they come from the side, say */
        for (size_t i = 0; i < count; i++) room->tau[i] = (double)NAN, room->ends.hit[i] = 0;
        lane_nothing(tile);
        return lane_told(tile, &room->ends, 4, 0);
    }
    const int evals = 4 + (self->disc == STRONG ? 2 : 0);
    if (self->disc == STRONG)
        (terms > FEW_TERMS ? asphere_lanes_all_strong : asphere_lanes_few_strong)(self, tile, room);
    int extra[SGT_TILE];
    const int rounds = (terms > FEW_TERMS ? asphere_lanes_all_rounds : asphere_lanes_few_rounds)(
        self, tile, room, extra);
    mask all = lane_ending(s, terms, wish, false, tile, room), vertex = 0;
    for (size_t i = 0; !all && i < count; i++)
        vertex |= at_vertex(room->x[i], room->y[i], tile->rays.o[2][i]);
    if (vertex) all = lane_ending(s, terms, wish, true, tile, room);
    if (first && !all_first(s, terms, tile, room) && !all_bent(self, terms, tile, room)) {
        all = 0;
        LANES for (size_t i = 0; i < count; i++) room->ends.hit[i] &= room->again[i];
    }
    if (s->proof) all &= asphere_sure_all(self, tile, room);
    size_t hard = lane_told(tile, &room->ends, evals, all);
    for (size_t i = 0; tile->hits.evals && rounds > 1 && i < count; i++) tile->hits.evals[i] += 2 * extra[i];
    return 24 * hard > count ? without_misses(self, terms, tile, room, hard) : hard; /* a few go one by one */
}

#define LANES_OF_TERMS(name, terms, first, wish)                                                \
    SGT_KERNEL static size_t name(const wavy *s, const sgt_tile *tile, wavy_room *room)         \
    {                                                                                           \
        return lane_terms(s, terms, first, wish, tile, room);                                   \
    }

LANES_OF_TERMS(asphere_lanes_few_near_bare, FEW_TERMS, false, LANE_BARE)
LANES_OF_TERMS(asphere_lanes_few_near, FEW_TERMS, false, LANE_PLAIN)
LANES_OF_TERMS(asphere_lanes_few_near_fine, FEW_TERMS, false, LANE_FINE)
LANES_OF_TERMS(asphere_lanes_few_first, FEW_TERMS, true, LANE_PLAIN)
LANES_OF_TERMS(asphere_lanes_few_near_rich, FEW_TERMS, false, LANE_RICH)
LANES_OF_TERMS(asphere_lanes_few_first_rich, FEW_TERMS, true, LANE_RICH)
LANES_OF_TERMS(asphere_lanes_near_bare, ALL_TERMS, false, LANE_BARE)
LANES_OF_TERMS(asphere_lanes_near, ALL_TERMS, false, LANE_RICH)
LANES_OF_TERMS(asphere_lanes_first, ALL_TERMS, true, LANE_RICH)

/* ------------------------------------------------------------------ quick */

/* Is F monotone along the chord within the rim, by the bound on its slope? */
SGT_INLINE bool single(const shape *s, const local *q)
{
    double a = q->l * q->l + q->m * q->m;
    return q->l == 0 && q->m == 0 ? q->n != 0
                                  : q->n * q->n > single_limit(s) * a; /* along the axis F is linear */
}

/* Returns true for a hit.  If it returns false with *miss set, the ray misses: the start is the only root
 * within the rim. */
SGT_INLINE bool asphere_quick(const shape *s, const sgt_ray *ray, meeting *out, double *seed, bool *miss,
                              tally *w)
{
    const sgt_options *opt = w->opt;
    local q = local_at_vertex_plane(ray);
    double a = q.l * q.l + q.m * q.m, k1 = 1 + s->k;
    double A = s->c * (a + k1 * q.n * q.n), B = q.n - s->c * (q.x * q.l + q.y * q.m),
           C = s->c * (q.x * q.x + q.y * q.y);
    double D = B * B - A * C, tau = C / (B + copysign(sqrt(D), B)), last = HUGE_VAL;
    if (!(tau > -HUGE_VAL && tau < HUGE_VAL)) tau = 0; /* the conic is not met: begin at the vertex plane */
    *seed = q.t0 + tau;
    bool whole = single(s, &q);
    if (!(whole || opt->pick == SGT_NEAR_SEED)) return false;
    if (!(fabs(q.n) >= 0x1p-10 && direction_is_whole(&q, ray->d))) return false;
    double t_tol = opt->t_tol / q.scale;
    sgt_move move = SGT_SEED;
    for (int i = 0; i < 12 && w->evals < w->budget; i++) {
        sample at = poly_at(s, &q, tau);
        observe(s, ray, w, &q, tau, move, -HUGE_VAL, HUGE_VAL);
        if (w->stopped) return false;
        move = SGT_NEWTON;
        double step = -at.g / at.slope, v_err;
        /* False for NaN. */
        bool steady, close = fabs(at.g) <= 0x1p-20 * (fabs(at.z) + fabs(at.w)) || fabs(step) <= t_tol,
                     shrinks = fabs(step) <= 0.5 * last;
        last = fabs(step);
        if (close || !shrinks) {
            sgt_poly_bound(s, &q, tau, &at);
            /* At the root, steps are noise; that is no reason to give up. */
            if (!shrinks && !(fabs(at.g) <= at.g_err)) return false;
            if (!sgt_poly_certify(s, &q, &at, tau, t_tol, out, &v_err, &steady)) return false;
            if (steady) {
                if (!(out->v > 16 * v_err)) return false;
                *miss = whole && out->p.x * out->p.x + out->p.y * out->p.y <= s->rim2
                        && !rim_hidden(out, s->rim2) && is_start(out, ray, q.scale);
                if (*miss) return false;
                /* Solve once more from the root in three cases: the start is too far away for the terms at
                 * the root, the place is steep, or t is not sharp. */
                double fx = fabs(out->n.x), fy = fabs(out->n.y), far = at.ex * fx + at.ey * fy + at.ez;
                double here = fabs(at.x) * fx + fabs(at.y) * fy + fabs(at.z) +
                              at.first * (at.x * at.x + at.y * at.y);
                if ((far > 3 * here || fx * fx + fy * fy > STEEP2 || !sharp(out, opt->t_tol)) &&
                    !sgt_poly_settle(s, ray, q.t0, q.t0_lo + tau, out, &v_err, w))
                    return false;
                if (opt->proof != SGT_ESTIMATE &&
                    (rim_hidden(out, s->rim2) || !sgt_poly_unique(s, ray, out, w) || w->stopped))
                    return false;
                if (fabs(out->t - ray->tmax)
                    <= larger(END_ERRORS * (out->t_err + SGT_U * fabs(out->t)), TINY))
                    return false; /* the march decides whether it is accepted */
                return accepted(out, ray, s->rim2, q.scale) && out->t_err < HUGE_VAL &&
                       !place_is_tiny(&q, out->t, out->p);
            }
        }
        tau += step;
    }
    return false;
}

/* -------------------------------------------------------------- together */

static int asphere_terms_of(const sgt_even_asphere *s)
{
    int terms = 8;
    while (terms > 0 && s->a[terms - 1] == 0) terms--;
    return terms;
}

SGT_INLINE shape shape_of(const sgt_even_asphere *s, int terms)
{
    return (shape){.c = s->c, .k = s->k, .ck = (1 + s->k) * s->c, .terms = terms, .a = s->a,
                   .rim2 = rim2_of(s->semi_diameter), .domain2 = domain2_of(s->c, s->k, s->semi_diameter)};
}

/* x - x is 0 for a finite x, NaN otherwise. */
static bool asphere_valid(const sgt_even_asphere *s)
{
    double sum = (s->c - s->c) + (s->k - s->k) + (s->semi_diameter - s->semi_diameter);
    for (int i = 0; i < 8; i++) sum += s->a[i] - s->a[i];
    return sum == 0 && s->semi_diameter >= 0;
}

static bool passes_by(const shape *s, const sgt_ray *ray)
{
    mask passes = MASK(true);
    sgt_tile one = {.n = 1, .rays = rays_of(ray)};
    sgt_asphere_pass(s, &one, &passes);
    return passes != 0;
}

/* done: the rounds of the easy form, which have not met the ray; NULL if they have not been made. */
SGT_NARROW(sgt_hit, sgt_asphere_first,
           (const sgt_even_asphere *s, int terms, const struct easy_rounds *done, const sgt_ray *ray,
            const sgt_options *opt))
{
    if (!ray_valid(ray) || !asphere_valid(s)) return hit_without(SGT_INVALID, ray, 0);
    shape h = shape_of(s, terms);
    if (!rim_in_range(h.rim2)) return hit_without(SGT_UNPROVEN, ray, 0);
    meeting at;
    double seed;
    tally w = {.opt = opt, .budget = opt->max_evals ? opt->max_evals : SGT_DEFAULT_EVALS,
               .evals = done ? done->evals : 0};
    wavy v;
    lane e;
    bool tried = w.budget > MOST_EASY && wavy_of(&h, opt->proof != SGT_ESTIMATE, &v);
    if (tried) wavy_constants(&h, &v), v.side = !v.proof && w.budget > MOST_EASY + SIDE_LOOKS;
    easy_answer is = EASY_NOT;
    if (done) is = easy_judged(&v, &h, opt->pick != SGT_NEAR_SEED, done, ray, opt->t_tol, &e);
    else if (tried) is = easy(&v, &h, ray, &e, &w);
    const bool grazing = is == EASY_GRAZES;
    if (grazing) is = EASY_NOT;
    if (is == EASY_NOT && tried && v.side && !w.stopped)
        is = sgt_asphere_beside(&v, &h, grazing, ray, &e, &w);
    const bool spared = grazing && is == EASY_NOT && !w.stopped && w.evals + MOST_EASY < w.budget;
    if (spared && !passes_by(&h, ray)) v.side = false, is = easy(&v, &h, ray, &e, &w); /* the rounds */
    if (is == EASY_HIT) {
        double f = asphere_f(&h, (sgt_vec3){e.px, e.py, e.pz});
        if (opt->watch)
            tell(&w, SGT_NEWTON, e.t, f, e.nx * ray->d.x + e.ny * ray->d.y + ray->d.z, e.t - e.t_err,
                 e.t + e.t_err);
        else w.evals++;
        return w.stopped ? hit_without(SGT_STOPPED, ray, w.evals) : hit_of_lane(&e, w.evals, f);
    }
    if (w.stopped) return hit_without(SGT_STOPPED, ray, w.evals);
    if (is == EASY_MISS || passes_by(&h, ray))
        return hit_without(SGT_MISS, ray, w.evals);
    bool miss = false;
    if (asphere_quick(&h, ray, &at, &seed, &miss, &w))
        return hit_at(&at, SGT_HIT, asphere_f(&h, at.p), SGT_NEWTON, ray, &w);
    if (w.stopped) return hit_without(SGT_STOPPED, ray, w.evals);
    if (miss) return hit_without(SGT_MISS, ray, w.evals);
    return sgt_asphere_march(&h, ray, seed, &w, NULL);
}

/* A limit on n^2 / a that single_limit does not exceed, without a root or a quotient.  Where (1 + k) (c r)^2
 * is at most 1/2, r^2 = rim2 is the domain's own, and phi^2 is at least 1/2.  Else it is infinite. */
SGT_INLINE double single_at_most(const shape *h)
{
    double unused, bent = h->ck * h->c * h->rim2,
           steep = (1.5 * fabs(h->c) + 2 * magnitude(h->terms, h->a, h->rim2, &unused)) * (1 + 0x1p-10);
    return bent <= 0.5 ? bounded_limit(steep, h->rim2) : HUGE_VAL;
}

/* wavy_single, if single_at_most does not tell it. */
SGT_NOINLINE static bool is_single(const sgt_even_asphere *s, int terms, const sgt_ray *ray)
{
    const shape h = shape_of(s, terms);
    const wavy v = {.single = single_limit(&h)};
    return wavy_single(&v, ray->d.x, ray->d.y, ray->d.z) != 0;
}

static sgt_hit meet_few_by_rounds(const sgt_even_asphere *, int, const sgt_ray *, const sgt_options *);
static sgt_hit meet_by_rounds(const sgt_even_asphere *, int, const sgt_ray *, const sgt_options *);
static sgt_hit prove_by_rounds(const sgt_even_asphere *, int, const sgt_ray *, const sgt_options *);

SGT_INLINE sgt_hit by_rounds(const sgt_even_asphere *s, int most, bool proof, int terms, const sgt_ray *ray,
                             const sgt_options *opt)
{
    return (proof                ? prove_by_rounds
            : most <= FEW_TERMS ? meet_few_by_rounds
                                : meet_by_rounds)(s, terms, ray, opt);
}

/* The easy form, with a number of terms that the compiler knows: those that are 0 change no bit.  There is no
 * watcher, and the budget suffices.  The ray has not been checked, but its direction is usual.  One that is
 * met is valid, as wavy_end finds it between its ends and within the rim; and so is the surface.
 *
 * What takes roots and quotients of the surface's numbers is worked out only where it decides: the domain
 * where a round has not ended, and the limit of wavy_single where single_at_most has not told. */
SGT_INLINE sgt_hit asphere_easily(const sgt_even_asphere *self, int terms, int most, bool proof, bool rounds,
                                  const sgt_ray *ray, const sgt_options *opt)
{
    shape h = {.c = self->c, .k = self->k, .ck = (1 + self->k) * self->c, .terms = most, .a = self->a,
               .rim2 = rim2_of(self->semi_diameter), .domain2 = HUGE_VAL};
    const bool first = opt->pick != SGT_NEAR_SEED;
    const double l = ray->d.x, m = ray->d.y, n = ray->d.z, t_tol = opt->t_tol;
    wavy own, *s = &own;
    if (!rounds && h.c == 0) return by_rounds(self, most, proof, terms, ray, opt);
    if (!rim_in_range(h.rim2) || !wavy_of(&h, proof, s))
        return sgt_asphere_first(self, terms, NULL, ray, opt);
    s->single = single_at_most(&h);
    s->bend = 2 * (2 * terms - 1), s->enough = terms <= 4 ? 4 * SGT_U : 0;
    wavy_constants(&h, s);
    if (first && ((!proof && wavy_along(ray)) || wavy_hopeless(s, ray)))
        return sgt_asphere_first(self, terms, NULL, ray, opt);
    if (!rounds && !(s->disc > 0)) return by_rounds(self, most, proof, terms, ray, opt);
    double g, slope;
    const vertex_place vertex = to_vertex_plane(ray);
    const wavy_start r = wavy_begin(s, most, &vertex, ray, &g, &slope);
    int evals = 1;
    if (!(r.tau == r.tau)) return sgt_asphere_first(self, terms, NULL, ray, opt);
    wavy_round q = {.tau = r.tau, .again = MASK(true)};
    double inverse = 0;
    if (!rounds) {
        const wavy_newton half = wavy_half(s, most, r.x, r.y, r.tau, ray);
        q = wavy_bound_first(s, most, &r, &half, ray), q.again = 0;
        inverse = half.inverse, evals = 3;
        if (!(q.tau_err == q.tau_err))
            return by_rounds(self, most, proof, terms, ray, opt);
    }
    if (rounds && s->disc == STRONG) q.tau = wavy_strong(s, most, r.x, r.y, r.tau, ray), evals += 2;
    for (int i = 0; i < ROUNDS && q.again; i++) {
        const wavy_newton half = wavy_half(s, most, r.x, r.y, q.tau, ray);
        const bool last = i + 1 == ROUNDS;
        q = wavy_bound_either(s, most, &r, &half, last, ray, t_tol);
        if (q.again && s->domain2 == HUGE_VAL) {
            s->domain2 = domain2_within(h.c, h.k, h.rim2);
            q = wavy_bound_either(s, most, &r, &half, last, ray, t_tol);
        }
        inverse = half.inverse, evals += 2;
    }
    near_root root = wavy_root(r.x, r.y, r.t0, r.t0_lo, q.tau, q.tau_err);
    const lane end = wavy_end_any(s, most, &root, &q, at_vertex(r.x, r.y, ray->o.z), ray, t_tol, false),
               e = lane_if_met(&end);
    if (!e.hit || (proof && !wavy_sure(s, r.x, r.y, r.t0, q.tau_err, l, m)) ||
        (first && !wavy_single(s, l, m, n) && !(h.rim2 < HUGE_VAL && is_single(self, terms, ray)) &&
         !(s->disc > 0 && wavy_first_within(s, r.t0, r.x, r.y, q.tau, ray)) &&
         !wavy_first_from(s, most, r.t0, r.x, r.y, q.tau, ray)))
        return sgt_asphere_first(self, terms, &(easy_rounds){r, q, inverse, evals}, ray, opt);
    return hit_of_lane(&e, evals + 1, asphere_f(&h, (sgt_vec3){e.px, e.py, e.pz}));
}

/* rounds: all of them.  Else the first one by constants; if there are none, or that has no answer, it begins
 * anew. */
#define MEETS(NAME, MOST, PROOF, EACH)                                                                     \
    SGT_NOINLINE static sgt_hit NAME(const sgt_even_asphere *s, int terms, const sgt_ray *ray,             \
                                     const sgt_options *opt)                                               \
    {                                                                                                      \
        return asphere_easily(s, terms, MOST, PROOF, EACH, ray, opt);                                      \
    }
MEETS(meet_few, FEW_TERMS, false, false)
MEETS(meet_all, ALL_TERMS, false, false)
MEETS(prove_few, FEW_TERMS, true, false)
MEETS(prove_all, ALL_TERMS, true, false)
MEETS(meet_few_by_rounds, FEW_TERMS, false, true)
MEETS(meet_by_rounds, ALL_TERMS, false, true)
MEETS(prove_by_rounds, ALL_TERMS, true, true)

static sgt_hit asphere_meet(const void *self, const sgt_ray *ray, const sgt_options *opt)
{
    const sgt_even_asphere *s = self;
    const double l = ray->d.x, m = ray->d.y, n = ray->d.z, rim = s->semi_diameter;
    const int terms = asphere_terms_of(s);
    if (!terms) return sgt_conic_meet(s->c, s->k, rim, ray, opt);
    WENT(WAY_ROUNDS);
    if (opt->watch || !(rim >= 0 && rim < HUGE_VAL) || !usual_length((l * l + m * m) + n * n) ||
        (opt->max_evals && opt->max_evals <= MOST_EASY + SIDE_LOOKS))
        return sgt_asphere_first(s, terms, NULL, ray, opt);
    if (opt->proof != SGT_ESTIMATE) return (terms <= FEW_TERMS ? prove_few : prove_all)(s, terms, ray, opt);
    return (terms <= FEW_TERMS ? meet_few : meet_all)(s, terms, ray, opt);
}

static sgt_status asphere_all(const void *self, const sgt_ray *ray, const sgt_options *opt, sgt_list *list)
{
    const sgt_even_asphere *s = self;
    int terms = asphere_terms_of(s);
    if (!asphere_valid(s)) return SGT_INVALID;
    if (!terms) return sgt_conic_all(s->c, s->k, s->semi_diameter, ray, opt, list);
    shape h = shape_of(s, terms);
    tally w = {.opt = opt, .budget = opt->max_evals ? opt->max_evals : SGT_DEFAULT_EVALS};
    if (rim_in_range(h.rim2)) sgt_asphere_march(&h, ray, (double)NAN, &w, list);
    else add_stretch(list, &w, SGT_UNPROVEN, ray, -HUGE_VAL, HUGE_VAL);
    list->evals = w.evals;
    return SGT_MISS;
}

static double asphere_value(const void *self, sgt_vec3 p, sgt_vec3 *grad)
{
    const sgt_even_asphere *s = self;
    int terms = asphere_terms_of(s);
    double r2 = p.x * p.x + p.y * p.y, phi, slope, dp = 0, sag = conic_sag(s->c, s->k, r2, &phi, &slope);
    if (terms) sag += polynomial(terms, s->a, r2, &dp);
    slope += dp;
    if (grad) *grad = (sgt_vec3){-2 * p.x * slope, -2 * p.y * slope, 1};
    return p.z - sag;
}

static double asphere_rounding(const void *self, sgt_vec3 p)
{
    const sgt_even_asphere *s = self;
    int terms = asphere_terms_of(s);
    double r2 = p.x * p.x + p.y * p.y, phi, slope, dp, second, base = conic_sag(s->c, s->k, r2, &phi, &slope),
           sag = base, noise = 0;
    if (terms) {
        sag += polynomial(terms, s->a, r2, &dp);
        noise = 4 * r2 * magnitude(terms, s->a, r2, &second) + fabs(sag); /* r2 itself is off by 2 u */
    }
    return 1.01 * SGT_U * (conic_sag_rounding(s->c, s->k, r2, base, phi) + noise + fabs(p.z - sag));
}

static sgt_span asphere_span(const void *self, const sgt_ray *ray)
{
    const sgt_even_asphere *s = self;
    shape h = shape_of(s, asphere_terms_of(s));
    sgt_span span = sgt_sag_span(s->c, s->k, s->semi_diameter, ray, !h.terms);
    if (h.terms) {
        local q = local_at_vertex_plane(ray);
        span.single = single(&h, &q);
    }
    return span;
}

static sgt_interval asphere_enclose(const void *self, const sgt_ray *ray, sgt_interval t, sgt_interval *slope)
{
    const sgt_even_asphere *s = self;
    *slope = (sgt_interval){-HUGE_VAL, HUGE_VAL};
    if (!asphere_valid(s)) return *slope;
    shape h = shape_of(s, asphere_terms_of(s));
    return sgt_sag_enclose(&h, ray, 0, t, slope);
}

/* Which rays of a tile are hard, and may be answered with the evaluations that are known of them?  Those on
 * which the rounds of the easy form ended, along the direction as given; all if the loops of side.c have
 * asked them (beside). */
static void asphere_hard(bool beside, const sgt_tile *tile, const easy_tried *tried, mask hard[])
{
    const double *const *o = tile->rays.o, *const *d = tile->rays.d;
    for (size_t i = 0; i < tile->n; i++) {
        double d2 = (d[0][i] * d[0][i] + d[1][i] * d[1][i]) + d[2][i] * d[2][i],
               far = fabs(o[0][i]) + fabs(o[1][i]) + fabs(o[2][i]);
        hard[i] = MASK(tile->hits.status[i] == SGT_HARD && usual_length(d2) && far < HUGE_VAL &&
                       (beside || tried->ended[i]));
    }
}

/* Gives SGT_MISS to these.  hard: how many were.  Returns how many are left. */
static size_t asphere_missed(const sgt_tile *tile, const mask misses[], size_t hard)
{
    for (size_t i = 0; i < tile->n; i++) {
        if (!misses[i]) continue;
        tile->hits.status[i] = SGT_MISS, hard--;
        if (tile->hits.evals) tile->hits.evals[i]--;
    }
    return hard;
}

/* Of hard rays those that leave the surface, and those that pass it (asphere/unique.c), as for a single ray.
 */
SGT_NOINLINE static size_t asphere_without_leaving(const shape *s, const wavy *v, const sgt_tile *tile,
                                                   const easy_tried *tried, size_t hard)
{
    mask leaves[SGT_TILE];
    if (!sgt_asphere_may_start(v, tile)) return hard;
    asphere_hard(false, tile, tried, leaves);
    sgt_asphere_leave(s, v, tile, leaves);
    return asphere_missed(tile, leaves, hard);
}

SGT_NOINLINE static size_t asphere_without_passing(const shape *s, bool beside, const sgt_tile *tile,
                                                   const easy_tried *tried, size_t hard)
{
    mask passes[SGT_TILE];
    asphere_hard(beside, tile, tried, passes);
    sgt_asphere_pass(s, tile, passes);
    return asphere_missed(tile, passes, hard);
}

/* The loops of easy.h.  Apart, so that its room and that of the loops after it are not on the stack at
 * once. */
SGT_NOINLINE static size_t asphere_easy_lanes(const wavy *v, int terms, bool near, const sgt_tile *tile,
                                              easy_tried *tried)
{
    wavy_room room;
    size_t hard;
    const lane_wish wish = lane_wish_of(tile);
    const bool few = terms <= FEW_TERMS;
    if (wish == LANE_BARE && near)
        hard = few ? asphere_lanes_few_near_bare(v, tile, &room) : asphere_lanes_near_bare(v, tile, &room);
    else if (!few)
        hard = near ? asphere_lanes_near(v, tile, &room) : asphere_lanes_first(v, tile, &room);
    else if (wish == LANE_FINE && near)
        hard = asphere_lanes_few_near_fine(v, tile, &room);
    else if (wish >= LANE_FINE)
        hard =
            near ? asphere_lanes_few_near_rich(v, tile, &room) : asphere_lanes_few_first_rich(v, tile, &room);
    else
        hard = near ? asphere_lanes_few_near(v, tile, &room) : asphere_lanes_few_first(v, tile, &room);
    tried->some = room.grazes;
    for (size_t i = 0; hard && i < tile->n; i++)
        tried->begun[i] = room.from[i] == room.from[i], tried->ended[i] = room.tau[i] == room.tau[i];
    return hard;
}

/* A tile of which the first ray runs along.  Returns false, and answers nothing, if some do not graze: else
 * none begins.  (wavy_begin and wavy_hopeless do not matter then.) */
SGT_NOINLINE static bool asphere_none_begins(const wavy *v, int terms, const convex *b, const sgt_tile *tile,
                                             easy_tried *tried)
{
    const size_t n = tile->n;
    tried->all = sgt_asphere_lanes_graze(v, b, terms, tile, tried);
    if (!tried->all) return false;
    for (size_t i = 0; i < n; i++) tried->some |= tried->asked[i] != 0;
    if (!tried->some) lane_nothing(tile); /* else graze.h writes all rays */
    memset(tile->hits.status, SGT_HARD, n);
    for (size_t i = 0; tile->hits.evals && i < n; i++) tile->hits.evals[i] = 4;
    memset(tried->begun, 0, n * sizeof *tried->begun), memset(tried->ended, 0, n * sizeof *tried->ended);
    return true;
}

/* A tile of which all rays miss, as is told without the rounds of easy.h: they pass the rim by, or start in
 * the vertex and meet nothing else.  What the first ray does is a guess for all of them.  A single ray makes
 * the rounds before, so this is not asked where its evaluations are wanted. */
SGT_NOINLINE static bool asphere_all_miss(const shape *h, const wavy *v, const sgt_tile *tile, bool vertex)
{
    const size_t n = tile->n;
    bool all = true;
    if (vertex) {
        mask leaves[SGT_TILE];
        const double *const *o = tile->rays.o, *const *d = tile->rays.d;
        for (size_t i = 0; i < n; i++) {
            const double d2 = (d[0][i] * d[0][i] + d[1][i] * d[1][i]) + d[2][i] * d[2][i];
            leaves[i] = at_vertex(o[0][i], o[1][i], o[2][i]) & usual_length(d2), all &= leaves[i] != 0;
        }
        if (all) sgt_asphere_leave(h, v, tile, leaves);
        for (size_t i = 0; i < n; i++) all &= leaves[i] != 0;
    } else {
        convex b;
        tile_bend_of(v, &b);
        all = sgt_asphere_lanes_past(&b, tile);
    }
    if (!all) return false;
    lane_nothing(tile);
    memset(tile->hits.status, SGT_MISS, n);
    return true;
}

/* Does the first ray of a tile seem to miss in one of these ways? */
SGT_INLINE bool seems_to_miss(const wavy *v, const sgt_ray *ray, bool *vertex)
{
    const double x = ray->o.x, y = ray->o.y, z = ray->o.z, n = ray->d.z, l = n * x - z * ray->d.x,
                 m = n * y - z * ray->d.y; /* n times the point on the vertex plane */
    *vertex = at_vertex(x, y, z) && ray->tmin == 0 && !(v->single < HUGE_VAL);
    return *vertex || (v->side && l * l + m * m > 1.125 * v->domain2 * (n * n));
}

static size_t asphere_lanes(const void *self, const sgt_tile *tile, const sgt_options *opt)
{
    const sgt_even_asphere *s = self;
    wavy v;
    easy_tried tried;
    tried.all = tried.some = false;
    int terms = asphere_terms_of(s);
    bool near = opt->pick == SGT_NEAR_SEED,
         enough = !opt->max_evals || opt->max_evals > MOST_EASY;
    if (asphere_valid(s) && !terms) return sgt_conic_lanes(s->c, s->k, s->semi_diameter, tile, opt);
    if (asphere_valid(s) && enough) {
        shape h = shape_of(s, terms);
        if (rim_in_range(h.rim2) && wavy_of(&h, opt->proof != SGT_ESTIMATE, &v)) {
            wavy_constants(&h, &v);
            v.side = !v.proof && (!opt->max_evals || opt->max_evals > MOST_EASY + SIDE_LOOKS);
            const sgt_rays rows = tile->rays;
            const sgt_ray ray = lane_ray_of(&rows, 0);
            bool vertex;
            if (!tile->hits.evals && seems_to_miss(&v, &ray, &vertex) &&
                asphere_all_miss(&h, &v, tile, vertex))
                return 0;
            const bool along = !near && v.side && wavy_along(&ray);
            convex b;
            if (along) tile_bend_of(&v, &b);
            size_t hard = tile->n;
            if (!along || !asphere_none_begins(&v, terms, &b, tile, &tried))
                hard = asphere_easy_lanes(&v, terms, near, tile, &tried);
            if (24 * hard > tile->n) hard = asphere_without_leaving(&h, &v, tile, &tried, hard);
            const bool beside = 24 * hard > tile->n && v.side;
            if (beside && !along) tile_bend_of(&v, &b);
            if (beside) hard = sgt_asphere_lanes_beside(&v, &h, &b, !near, tile, hard, &tried);
            return 8 * hard > tile->n ? asphere_without_passing(&h, beside, tile, &tried, hard)
                                      : hard; /* a few go one by one */
        }
    }
    memset(tile->hits.status, SGT_HARD, tile->n);
    return tile->n;
}

static bool asphere_unique(const void *self, const sgt_tile *tile, double rim2, mask unique[],
                           sgt_interval others[])
{
    const sgt_even_asphere *s = self;
    int terms = asphere_terms_of(s);
    shape h = shape_of(s, terms);
    if (rim2 < h.rim2) h.rim2 = rim2, h.domain2 = domain2_within(s->c, s->k, rim2);
    if (terms) return sgt_lanes_monotone(&h, tile, unique) || sgt_asphere_unique(&h, tile, unique);
    return sgt_conic_unique(s->c, s->k, s->semi_diameter, tile, rim2, unique, others);
}

static bool asphere_on(const void *self, size_t n, const double *const p[3], double on[])
{
    const sgt_even_asphere *s = self;
    if (asphere_terms_of(s)) return false;
    sgt_conic_on(s->c, s->k, n, p, on);
    return true;
}

static bool asphere_behind(const void *self, size_t n, const sgt_rays *rays, double side[])
{
    const sgt_even_asphere *s = self;
    if (asphere_terms_of(s)) return false;
    sgt_conic_behind(s->c, s->k, n, rays, side);
    return true;
}

/* SGT_MISS or SGT_HARD.  Returns how many are hard. */
SGT_KERNEL
static size_t asphere_left(size_t n, const mask misses[], sgt_status *restrict status)
{
    mask hard = 0;
    _Pragma("omp simd reduction(+ : hard)") for (size_t i = 0; i < n; i++)
    {
        const mask gone = misses[i];
        status[i] = (signed char)((int)(gone & (SGT_MISS - SGT_HARD)) + SGT_HARD);
        hard -= ~gone;
    }
    return (size_t)hard;
}

static size_t asphere_leave(const void *self, const sgt_tile *tile, double behind[])
{
    const sgt_even_asphere *s = self;
    const int terms = asphere_terms_of(s);
    const size_t n = tile->n;
    sgt_status *status = tile->hits.status;
    wavy v;
    mask misses[SGT_TILE];
    memset(status, SGT_HARD, n);
    if (!asphere_valid(s)) return n;
    if (!terms) return sgt_conic_leave(s->c, s->k, s->semi_diameter, tile, behind);
    const shape h = shape_of(s, terms);
    if (!rim_in_range(h.rim2) || !wavy_of(&h, false, &v)) return n;
    bool all = sgt_asphere_from_start(&v, terms, tile, misses, behind), bowl = false;
    convex b;
    if (!all) {
        tile_bend_of(&v, &b);
        bowl = is_bowl(&b);
        if (bowl) sgt_asphere_past_rim(&b, tile, misses, behind);
        else sgt_asphere_past_rings(&h, tile, misses, behind);
    }
    lane_nothing(tile);
    for (size_t i = 0; tile->hits.evals && i < n; i++) tile->hits.evals[i] = 1;
    size_t hard = all ? 0 : asphere_left(n, misses, status);
    if (all || !hard) memset(status, SGT_MISS, n);
    if (hard && bowl) sgt_asphere_left_bowl(&v, terms, &b, tile, misses, behind);
    for (size_t i = 0; hard && bowl && i < n; i++) hard -= status[i] == SGT_HIT;
    for (size_t i = 0; hard && i < n; i++)
        if (status[i] == SGT_HARD) behind[i] = 0;
    return hard;
}

static bool asphere_values_rounded(const void *self, const sgt_shared *shared, const double *const rows[3],
                                   size_t n, sgt_points p, sgt_values out, double own[])
{
    const sgt_even_asphere *s = self;
    const shape h = shape_of(s, asphere_terms_of(s));
    (void)shared, (void)rows;
    sgt_sag_values_rounded(&h, n, p, out, own);
    return true;
}

static bool asphere_even_sag(const void *self, sgt_even_sag *sag)
{
    const sgt_even_asphere *s = self;
    *sag = (sgt_even_sag){s->c, s->k, s->semi_diameter, asphere_terms_of(s), s->a};
    return asphere_valid(s);
}

static const struct sgt_builtin_ops asphere_builtin = {.meet = asphere_meet,
                                                       .all = asphere_all,
                                                       .lanes = asphere_lanes,
                                                       .unique = asphere_unique,
                                                       .on = asphere_on,
                                                       .behind = asphere_behind,
                                                       .leave = asphere_leave,
                                                       .even_sag = asphere_even_sag,
                                                       .departure = &sgt_asphere_departure,
                                                       .values_rounded = asphere_values_rounded};

const sgt_surface_ops sgt_even_asphere_ops = {
    .name = "even_asphere", .value = asphere_value, .span = asphere_span, .rounding = asphere_rounding,
    .enclose = asphere_enclose, .own_ = &asphere_builtin, .second = sgt_asphere_second,
    .parameters = sgt_asphere_parameters, .by_parameter = sgt_asphere_by_parameter};
