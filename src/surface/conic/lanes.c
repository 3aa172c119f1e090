// SPDX-License-Identifier: MIT
/* conic/lanes.c - a tile of rays and a conic or a plane: loops over the lanes of conic/easy.h.
 *
 * WHY APART.  Without these loops (lanes = NULL) a batch costs 12 times the instructions; by the lanes of
 * ray/lanes.c, as a user's surface, 25 times (counted as in conic.c). */
#include "side.h"
#include "../sag/poly.h"

/* What the first loop leaves for the second. */
typedef struct bowl_room {
    _Alignas(64) double x[SGT_TILE];
    double y[SGT_TILE], tau[SGT_TILE], t[SGT_TILE], t_err[SGT_TILE], tau_err[SGT_TILE], t0[SGT_TILE],
        small[SGT_TILE];
    lane_ends ends;
} bowl_room;

SGT_KERNEL
static void conic_lanes_unmet(const lane_to *to, size_t count) { lane_unmet(to, false, count); }

SGT_KERNEL
static void conic_lanes_unmet_rich(const lane_to *to, size_t count) { lane_unmet(to, true, count); }

/* Of a conic in three loops, each with a short chain of operations (sag/lanes.h), or `at_once` in one. */
SGT_INLINE size_t lane_bowl(const bowl *self, bool plane, bool first, bool proof, bool at_once,
                            lane_wish wish, const sgt_tile *tile, bowl_room *room)
{
    const sgt_rays rows = tile->rays;
    const double *t_tol = tile->t_tol;
    const bowl own = *self, *s = &own; /* a copy, so that no output can alias it */
    size_t count = tile->n;
    const bool whole = wish == LANE_BARE;
    if (!at_once) {
        LANES for (size_t i = 0; i < count; i++)
        {
            const sgt_ray ray = lane_ray_of(&rows, i);
            const vertex_place at = to_vertex_plane(&ray);
            room->x[i] = at.x, room->y[i] = at.y, room->t0[i] = at.t0, room->small[i] = at.t0_lo;
        }
        LANES for (size_t i = 0; i < count; i++)
        {
            const sgt_ray ray = lane_ray_of(&rows, i);
            const vertex_place at = {room->t0[i], room->small[i], room->x[i], room->y[i]};
            near_root r = easy_start_at(s, first, proof, at, &ray);
            room->tau[i] = r.tau, room->t[i] = r.t, room->t_err[i] = r.t_err;
            if (wish >= LANE_FINE) room->small[i] = r.small;
            if (wish == LANE_RICH) room->tau_err[i] = r.tau_err;
        }
    }
    const lane_to to = lane_to_of(tile, &room->ends);
    mask all = MASK(true);
    _Pragma("omp simd reduction(& : all)") for (size_t i = 0; i < count; i++)
    {
        const sgt_ray ray = lane_ray_of(&rows, i);
        near_root r;
        if (at_once)
            r = plane ? plane_start(s, proof, &ray) : easy_start(s, first, proof, &ray);
        else {
            r = (near_root){.x = room->x[i],
                            .y = room->y[i],
                            .tau = room->tau[i],
                            .t = room->t[i],
                            .t_err = room->t_err[i]};
            if (wish >= LANE_FINE) r.t0 = room->t0[i], r.small = room->small[i];
            if (wish == LANE_RICH) r.tau_err = room->tau_err[i];
        }
        lane e = plane ? plane_end_any(s, &r, &ray, t_tol[i], whole)
                       : easy_end_any(s, &r, &ray, t_tol[i], whole);
        LANE_STORE_ALL(to, i, e, wish);
        all &= e.hit;
    }
    if (!all) (wish >= LANE_FINE ? conic_lanes_unmet_rich : conic_lanes_unmet)(&to, count);
    return lane_told(tile, &room->ends, 1, all);
}

/* easy_away of all rays.  Returns all bits set if all of them miss. */
SGT_KERNEL
static mask conic_lanes_away(const bowl *self, const sgt_tile *tile, mask *away, mask *far_gone, mask *start)
{
    const sgt_rays rows = tile->rays;
    const bowl own = *self, *s = &own;
    size_t count = tile->n;
    mask all = MASK(true);
    _Pragma("omp simd reduction(& : all)") for (size_t i = 0; i < count; i++) {
        const sgt_ray ray = lane_ray_of(&rows, i);
        verdicts v = easy_away(s, &ray);
        away[i] = v.away, far_gone[i] = v.far_gone, start[i] = v.start;
        all &= v.away;
    }
    return all;
}

SGT_KERNEL
static mask conic_lanes_plane_away(const bowl *self, const sgt_tile *tile, mask *away)
{
    const sgt_rays rows = tile->rays;
    const bowl own = *self, *s = &own;
    size_t count = tile->n;
    mask all = MASK(true);
    _Pragma("omp simd reduction(& : all)") for (size_t i = 0; i < count; i++) {
        const sgt_ray ray = lane_ray_of(&rows, i);
        away[i] = plane_away(s, &ray);
        all &= away[i];
    }
    return all;
}

/* What is known of the far roots of all rays. */
SGT_KERNEL
SGT_NARROW(void, sgt_conic_lanes_far,
           (const bowl *self, const sgt_tile *tile, mask *gone, mask *accepted, double *far, double *slack))
{
    const sgt_rays rows = tile->rays;
    const bowl own = *self, *s = &own;
    size_t count = tile->n;
    LANES for (size_t i = 0; i < count; i++) {
        const sgt_ray ray = lane_ray_of(&rows, i);
        verdicts v = easy_away(s, &ray);
        gone[i] = v.far_gone, accepted[i] = v.far_accepted, far[i] = v.far, slack[i] = v.slack;
    }
}

#define LANES_OF_BOWL(name, plane, first, proof, at_once, wish)                                 \
    SGT_KERNEL static size_t name(const bowl *s, const sgt_tile *tile, bowl_room *room)         \
    {                                                                                           \
        return lane_bowl(s, plane, first, proof, at_once, wish, tile, room);                    \
    }

LANES_OF_BOWL(conic_lanes_plane_bare, true, false, false, true, LANE_BARE)
LANES_OF_BOWL(conic_lanes_plane, true, false, false, true, LANE_PLAIN)
LANES_OF_BOWL(conic_lanes_plane_fine, true, false, false, true, LANE_FINE)
LANES_OF_BOWL(conic_lanes_plane_rich, true, false, false, true, LANE_RICH)
LANES_OF_BOWL(conic_lanes_plane_sure, true, false, true, true, LANE_PLAIN)
LANES_OF_BOWL(conic_lanes_plane_sure_rich, true, false, true, true, LANE_RICH)
LANES_OF_BOWL(conic_lanes_near_bare, false, false, false, false, LANE_BARE)
LANES_OF_BOWL(conic_lanes_near, false, false, false, false, LANE_PLAIN)
LANES_OF_BOWL(conic_lanes_near_fine, false, false, false, false, LANE_FINE)
LANES_OF_BOWL(conic_lanes_near_rich, false, false, false, false, LANE_RICH)
LANES_OF_BOWL(conic_lanes_near_sure, false, false, true, false, LANE_PLAIN)
LANES_OF_BOWL(conic_lanes_near_sure_rich, false, false, true, false, LANE_RICH)
LANES_OF_BOWL(conic_lanes_near_at_once, false, false, false, true, LANE_PLAIN)
LANES_OF_BOWL(conic_lanes_near_at_once_rich, false, false, false, true, LANE_RICH)
LANES_OF_BOWL(conic_lanes_first, false, true, false, false, LANE_PLAIN)
LANES_OF_BOWL(conic_lanes_first_rich, false, true, false, false, LANE_RICH)
LANES_OF_BOWL(conic_lanes_first_sure, false, true, true, false, LANE_PLAIN)
LANES_OF_BOWL(conic_lanes_first_sure_rich, false, true, true, false, LANE_RICH)
LANES_OF_BOWL(conic_lanes_first_at_once, false, true, false, true, LANE_PLAIN)
LANES_OF_BOWL(conic_lanes_first_at_once_rich, false, true, false, true, LANE_RICH)

/* A root as the last loop finds it in the room: if t, point and gradient are all that is wanted.  A place in
 * t0 is pz, one in small is the end's `near`. */
SGT_INLINE void room_take(bowl_room *room, size_t i, const root_there *r)
{
    room->x[i] = r->at.x, room->y[i] = r->at.y, room->tau[i] = r->at.tau, room->t[i] = r->at.t;
    room->t_err[i] = chosen(r->also, r->at.t_err, (double)NAN);
    room->t0[i] = r->pz, room->small[i] = r->near;
}

SGT_INLINE lane room_end(const bowl *s, const bowl_room *room, size_t i, mask exact, const sgt_ray *ray,
                         double t_tol)
{
    const root_there r = {.at = {.x = room->x[i],
                                 .y = room->y[i],
                                 .tau = room->tau[i],
                                 .t = room->t[i],
                                 .t_err = room->t_err[i]},
                          .pz = room->t0[i],
                          .w = s->ck * room->t0[i],
                          .near = room->small[i],
                          .exact = exact,
                          .also = MASK(true)};
    return lane_of_root(s, &r, ray, t_tol);
}

/* The same for rays that start near the surface or on it too (conic/easy.h, NEARBY). */
SGT_INLINE size_t lane_nearby(const bowl *self, bool plane, bool first, lane_wish wish, const sgt_tile *tile,
                              bowl_room *room)
{
    const sgt_rays rows = tile->rays;
    const double *t_tol = tile->t_tol;
    const bowl own = *self, *s = &own;
    const bool two = wish == LANE_PLAIN;
    size_t count = tile->n;
    LANES for (size_t i = 0; i < (two ? count : 0); i++)
    {
        const sgt_ray ray = lane_ray_of(&rows, i);
        const root_there r = sharper_root(s, first, &ray, t_tol[i]);
        room_take(room, i, &r);
    }
    lane_to to = lane_to_of(tile, &room->ends);
    mask all = MASK(true);
    _Pragma("omp simd reduction(& : all)") for (size_t i = 0; i < count; i++) {
        const sgt_ray ray = lane_ray_of(&rows, i);
        lane e = two     ? room_end(s, room, i, at_vertex(ray.o.x, ray.o.y, ray.o.z), &ray, t_tol[i])
                 : plane ? plane_at_start(s, &ray, t_tol[i])
                         : easy_or_nearby(s, first, &ray, t_tol[i]);
        LANE_STORE(to, i, e, wish);
        all &= e.hit;
    }
    return lane_told(tile, &room->ends, 1, all);
}

#define LANES_NEARBY(name, plane, first, wish)                                                  \
    SGT_KERNEL                                                                                  \
    static size_t name(const bowl *s, const sgt_tile *tile, bowl_room *room)                    \
    {                                                                                           \
        return lane_nearby(s, plane, first, wish, tile, room);                                  \
    }

LANES_NEARBY(conic_lanes_plane_nearby, true, false, LANE_RICH)
LANES_NEARBY(conic_lanes_near_nearby, false, false, LANE_PLAIN)
LANES_NEARBY(conic_lanes_near_nearby_rich, false, false, LANE_RICH)
LANES_NEARBY(conic_lanes_first_nearby, false, true, LANE_PLAIN)
LANES_NEARBY(conic_lanes_first_nearby_rich, false, true, LANE_RICH)

/* What leaves_from knows of a tile. */
typedef struct leave_room {
    double tau[SGT_TILE], tau_err[SGT_TILE], inverse[SGT_TILE], behind[SGT_TILE];
    mask start[SGT_TILE], away[SGT_TILE], met[SGT_TILE];
    lane_ends ends;
} leave_room;

/* What the loops of side.h leave for each other: guesses. */
typedef struct side_room {
    double at[SGT_TILE];
    lane_ends ends;
    mask away[SGT_TILE];
} side_room;

/* Which rays does a single ray try from the vertex plane, or as one that starts on the surface, before it is
 * met from the side?  For the others neither the easy form nor `nearby` has a root.  far_gone: whether
 * another root does not matter, as it is gone, or may be, or near the seed; else a root is tried only if no
 * other comes before it.  Returns all bits set if there are any. */
SGT_KERNEL
SGT_NARROW(mask, sgt_conic_lanes_tried,
           (const bowl *self, const sgt_tile *tile, const mask *far_gone, mask *tried))
{
    const sgt_rays rows = tile->rays;
    const bowl own = *self, *s = &own;
    size_t count = tile->n;
    mask any = 0;
    _Pragma("omp simd reduction(| : any)") for (size_t i = 0; i < count; i++)
    {
        const sgt_ray ray = lane_ray_of(&rows, i);
        mask is = easy_tries(s, far_gone[i], &ray) | starts_on(s, &ray);
        tried[i] = is;
        any |= is;
    }
    return any;
}

/* Which of these does a single ray meet there, by easy_at or nearby_at? */
SGT_INLINE void lane_sooner(const bowl *self, bool first, const sgt_tile *tile, const mask *far_gone,
                            mask *tried)
{
    const sgt_rays rows = tile->rays;
    const double *t_tol = tile->t_tol;
    const bowl own = *self, *s = &own;
    size_t count = tile->n;
    LANES for (size_t i = 0; i < count; i++)
    {
        const sgt_ray ray = lane_ray_of(&rows, i);
        near_root r = easy_start(s, false, false, &ray);
        mask met = easy_end(s, &r, &ray, t_tol[i]).hit;
        r.t_err = easy_start(s, false, true, &ray).t_err;
        met |= nearby(s, &r, &ray, t_tol[i]).hit;
        if (first) {
            double begun = easy_start(s, true, false, &ray).t_err;
            met &= MASK(begun == begun) | far_gone[i];
        }
        tried[i] &= met;
    }
}

SGT_KERNEL
SGT_NARROW(void, sgt_conic_lanes_sooner_first,
           (const bowl *s, const sgt_tile *tile, const mask *far_gone, mask *tried))
{
    lane_sooner(s, true, tile, far_gone, tried);
}
SGT_KERNEL
SGT_NARROW(void, sgt_conic_lanes_sooner_near,
           (const bowl *s, const sgt_tile *tile, const mask *far_gone, mask *tried))
{
    lane_sooner(s, false, tile, far_gone, tried);
}

/* Is a direction such that a single ray is not scaled?  (Not all for which usual_direction is true.) */
SGT_INLINE mask side_usual(const sgt_ray *ray)
{
    double d2 = ray->d.x * ray->d.x + ray->d.y * ray->d.y + ray->d.z * ray->d.z;
    return MASK(d2 > 0x1p-76) & MASK(d2 < 0x1p80);
}

/* What the guesses of a tile say: may any of its rays be tried before, or be gone where it first meets the
 * surface? */
typedef struct side_guesses {
    mask tried, twice;
} side_guesses;

/* A ray that is not to be met here has NaN for `at`, and is not. */
SGT_INLINE side_guesses lane_guess(const bowl *self, bool first, const sgt_tile *tile, side_room *r)
{
    const sgt_rays rows = tile->rays;
    const bowl own = *self, *s = &own;
    size_t count = tile->n;
    mask tried = 0, twice = 0;
    _Pragma("omp simd reduction(| : tried, twice)") for (size_t i = 0; i < count; i++)
    {
        const sgt_ray ray = lane_ray_of(&rows, i);
        const side_guess a = side_guess_of(s, first, &ray);
        const mask usual = side_usual(&ray);
        r->at[i] = chosen(usual, a.at, (double)NAN), r->away[i] = a.away & usual;
        tried |= a.tried, twice |= a.twice;
    }
    return (side_guesses){tried, twice};
}

/* met_from_side of all rays: rich. */
SGT_INLINE void lane_side(const bowl *self, bool first, const sgt_tile *tile, lane_to to, side_room *r)
{
    const sgt_rays rows = tile->rays;
    const double *t_tol = tile->t_tol;
    bowl own = *self, *s = &own;
    size_t count = tile->n;
    own.proof = false; /* as it is in these loops */
    LANES for (size_t i = 0; i < count; i++)
    {
        const sgt_ray ray = lane_ray_of(&rows, i);
        const side_answer a = met_from_side(s, first, r->at[i], &ray, t_tol[i]);
        r->away[i] |= a.away;
        LANE_STORE(to, i, a.e, LANE_RICH);
    }
}

/* The same where t, point and gradient are all that is wanted.  quick: no root has to be shown to be gone. */
SGT_INLINE void lane_side_plain(const bowl *self, bool first, bool quick, const sgt_tile *tile, lane_to to,
                                side_room *r, bowl_room *room)
{
    const sgt_rays rows = tile->rays;
    const double *t_tol = tile->t_tol;
    bowl own = *self, *s = &own;
    size_t count = tile->n;
    own.proof = false;
    LANES for (size_t i = 0; i < count; i++)
    {
        const sgt_ray ray = lane_ray_of(&rows, i);
        const side_left a = side_root_at(s, first, quick, r->at[i], &ray);
        const side_place *p = &a.root;
        const root_there q = side_there(s, &p->at, p->tau, p->tau_err, p->inverse, p->wanted, &ray);
        if (!quick) r->away[i] |= a.away;
        room_take(room, i, &q);
    }
    LANES for (size_t i = 0; i < count; i++)
    {
        const sgt_ray ray = lane_ray_of(&rows, i);
        lane e = room_end(s, room, i, MASK(false), &ray, t_tol[i]);
        LANE_STORE(to, i, e, LANE_PLAIN);
    }
}

SGT_KERNEL
static side_guesses conic_lanes_guess_first(const bowl *s, const sgt_tile *tile, side_room *r)
{
    return lane_guess(s, true, tile, r);
}
SGT_KERNEL
static side_guesses conic_lanes_guess_near(const bowl *s, const sgt_tile *tile, side_room *r)
{
    return lane_guess(s, false, tile, r);
}

SGT_KERNEL
static void conic_lanes_side_first(const bowl *s, const sgt_tile *tile, lane_to to, side_room *r)
{
    lane_side(s, true, tile, to, r);
}
SGT_KERNEL
static void conic_lanes_side_near(const bowl *s, const sgt_tile *tile, lane_to to, side_room *r)
{
    lane_side(s, false, tile, to, r);
}

#define LANES_SIDE(name, first, quick)                                                         \
    SGT_KERNEL static void name(const bowl *s, const sgt_tile *tile, lane_to to, side_room *r, \
                                bowl_room *room)                                               \
    {                                                                                          \
        lane_side_plain(s, first, quick, tile, to, r, room);                                   \
    }

LANES_SIDE(conic_lanes_side_first_quick, true, true)
LANES_SIDE(conic_lanes_side_first_plain, true, false)
LANES_SIDE(conic_lanes_side_near_quick, false, true)

static side_guesses conic_lanes_guess(const bowl *s, bool first, const sgt_tile *tile, side_room *r)
{
    return (first ? conic_lanes_guess_first : conic_lanes_guess_near)(s, tile, r);
}

/* room: NULL, or free for what loops leave for each other. */
static void conic_lanes_side(const bowl *s, bool first, bool quick, const sgt_tile *tile, lane_to to,
                             side_room *r, bowl_room *room)
{
    const bool plain = room && lane_wish_of(tile) < LANE_FINE;
    if (plain && quick)
        (first ? conic_lanes_side_first_quick : conic_lanes_side_near_quick)(s, tile, to, r, room);
    else if (plain && first)
        conic_lanes_side_first_plain(s, tile, to, r, room);
    else
        (first ? conic_lanes_side_first : conic_lanes_side_near)(s, tile, to, r);
}

/* first_from_on.  start: which rays it has the first word for (starts_on, and a first root is asked for);
 * then nothing else is tried for them.  Of the others it answers those that have no answer yet. */
SGT_KERNEL
static void conic_lanes_on(const bowl *self, const sgt_tile *tile, const mask *start, lane_to to, mask *away,
                           mask *tried)
{
    const bowl own = *self, *s = &own;
    const sgt_rays rows = tile->rays;
    const double *t_tol = tile->t_tol;
    size_t count = tile->n;
    LANES for (size_t i = 0; i < count; i++)
    {
        const sgt_ray ray = lane_ray_of(&rows, i);
        side_answer a = first_from_on(s, start[i], &ray, t_tol[i]);
        mask usual = side_usual(&ray), at_once = start[i] & usual & (a.e.hit | a.away),
             had = (to.hit[i] | away[i] | ~usual) & ~at_once;
        LANE_STORE_IF(to, i, a.e, ~had);
        away[i] = (away[i] & had) | (~had & a.away);
        tried[i] &= ~at_once;
    }
}

/* Writes that all rays of a tile miss.  rows: none has been written yet. */
static size_t lane_all_missed(const sgt_tile *tile, bool rows)
{
    if (rows) lane_nothing(tile);
    memset(tile->hits.status, SGT_MISS, tile->n);
    if (tile->hits.evals) memset(tile->hits.evals, 0, tile->n * sizeof *tile->hits.evals);
    return 0;
}

/* leaves_from of all rays.  Returns true if all of them miss, and their sides are known. */
SGT_KERNEL
static bool conic_lanes_leave(const bowl *self, const sgt_tile *tile, leave_room *room)
{
    const bowl own = *self, *s = &own;
    const sgt_rays rows = tile->rays;
    size_t count = tile->n;
    mask all = MASK(true);
    _Pragma("omp simd reduction(& : all)") for (size_t i = 0; i < count; i++)
    {
        const sgt_ray ray = lane_ray_of(&rows, i);
        side_start q = leaves_from(s, &ray);
        mask usual = side_usual(&ray), met = q.met & usual, away = q.away & usual;
        room->start[i] = q.start, room->away[i] = away, room->met[i] = met;
        room->tau[i] = q.tau, room->tau_err[i] = q.tau_err, room->inverse[i] = q.inverse;
        room->behind[i] = q.behind;
        all &= away & MASK(q.behind != 0);
    }
    return all != 0;
}

/* The answers to the rays that have met it.  (Of all rays: to put them side by side takes longer.) */
SGT_INLINE void lane_left(const bowl *self, lane_wish wish, const sgt_tile *tile, lane_to to,
                          const leave_room *room)
{
    const bowl own = *self, *s = &own;
    const sgt_rays rows = tile->rays;
    const double *t_tol = tile->t_tol;
    size_t count = tile->n;
    LANES for (size_t i = 0; i < count; i++)
    {
        const sgt_ray ray = lane_ray_of(&rows, i);
        const side_place r =
            left_in_doubles(s, room->tau[i], room->tau_err[i], room->inverse[i], room->met[i], &ray);
        lane e = side_hit(s, &r.at, r.tau, r.tau_err, r.inverse, r.wanted, &ray, t_tol[i]);
        LANE_STORE(to, i, e, wish);
    }
}

SGT_KERNEL
static void conic_lanes_left(const bowl *s, const sgt_tile *tile, lane_to to, const leave_room *room)
{
    lane_left(s, LANE_PLAIN, tile, to, room);
}
SGT_KERNEL
static void conic_lanes_left_rich(const bowl *s, const sgt_tile *tile, lane_to to, const leave_room *room)
{
    lane_left(s, LANE_RICH, tile, to, room);
}

/* Which points are on the surface, as a ray's start is?  1 or 0. */
SGT_KERNEL
static void conic_lanes_points(const bowl *self, size_t count, const double *const p[3], double *restrict on)
{
    const bowl own = *self, *s = &own;
    const double *x = p[0], *y = p[1], *z = p[2];
    LANES for (size_t i = 0; i < count; i++)
    {
        const sgt_ray ray = {{x[i], y[i], z[i]}, {0, 0, 0}, 0, 0};
        on[i] = chosen(starts_on(s, &ray) & MASK(fabs(s->ck * z[i]) < 1 - 0x1p-8), 1, 0);
    }
}

/* The side behind starts on the surface, as leaves_from has it. */
SGT_KERNEL
static void conic_lanes_behind(const bowl *self, size_t count, const sgt_rays *from, double *restrict side)
{
    const bowl own = *self, *s = &own;
    const double *ox = from->o[0], *oy = from->o[1], *oz = from->o[2], *l = from->d[0], *m = from->d[1],
                 *n = from->d[2];
    LANES for (size_t i = 0; i < count; i++)
    {
        const sgt_ray ray = {{ox[i], oy[i], oz[i]}, {l[i], m[i], n[i]}, 0, HUGE_VAL};
        side[i] = leaves_from(s, &ray).behind;
    }
}

/* The first roots of rays that start on the surface, and of no others. */
SGT_KERNEL
static void conic_lanes_started(const bowl *self, const sgt_tile *tile, lane_to to, mask *away)
{
    const bowl own = *self, *s = &own;
    const sgt_rays rows = tile->rays;
    const double *t_tol = tile->t_tol;
    size_t count = tile->n;
    LANES for (size_t i = 0; i < count; i++)
    {
        const sgt_ray ray = lane_ray_of(&rows, i);
        side_answer a = first_from_on(s, MASK(true), &ray, t_tol[i]);
        mask start = starts_on(s, &ray) & side_usual(&ray);
        a.e.hit &= start;
        LANE_STORE(to, i, a.e, LANE_RICH);
        away[i] = start & a.away;
    }
}

static const mask NONE[SGT_TILE];

/* Writes the status and evals of n rays, from the rows `hit` and `away`.  Returns how many have no answer. */
SGT_KERNEL
static size_t side_status(const sgt_tile *tile, const mask *hit, const mask *away, const mask *tried)
{
    const sgt_hits *h = &tile->hits;
    mask hard = 0;
    sgt_status *status = h->status;
    const size_t count = tile->n;
    _Pragma("omp simd reduction(+ : hard)") for (size_t i = 0; i < count; i++)
    {
        mask met = hit[i] & ~tried[i], gone = away[i] & ~(hit[i] | tried[i]);
        status[i] = (signed char)((int)(met & (SGT_HIT - SGT_HARD)) + (int)(gone & (SGT_MISS - SGT_HARD)) +
                                  SGT_HARD);
        hard -= ~(met | gone);
    }
    for (size_t i = 0; h->evals && i < tile->n; i++) h->evals[i] = h->status[i] == SGT_HIT;
    return (size_t)hard;
}

/* Answers the rays of a tile from the side, and by met_from_on if `start` is not NULL; no proof is asked for.
 * tried: those that a single ray meets before that.  Returns how many are left. */
SGT_NOINLINE static size_t conic_lanes_beside(const bowl *s, bool first, const sgt_tile *tile,
                                              const mask *start, mask *tried)
{
    side_room r;
    lane_to to = lane_to_of(tile, &r.ends);
    conic_lanes_guess(s, first, tile, &r);
    conic_lanes_side(s, first, false, tile, to, &r, NULL);
    if (start) conic_lanes_on(s, tile, start, to, r.away, tried);
    return side_status(tile, r.ends.hit, r.away, tried);
}

/* Answers the rays of a tile that start on the surface.  Returns how many are left.  away: a free row. */
SGT_NOINLINE static size_t conic_lanes_on_first(const bowl *s, const sgt_tile *tile, mask *away)
{
    lane_ends ends;
    conic_lanes_started(s, tile, lane_to_of(tile, &ends), away);
    return side_status(tile, ends.hit, away, NONE);
}

/* The hard rays of a tile, side by side.  The last one fills the lanes up to a multiple of eight. */
typedef struct few_rays {
    size_t n;
    sgt_tile tile; /* n, and the lanes filled up */
    double ray[9][SGT_TILE];
    int evals[SGT_TILE];
    sgt_status status[SGT_TILE];
    unsigned char number[SGT_TILE];
} few_rays;

/* out: rows that are free. */
static void take_few(const sgt_tile *tile, double out[][SGT_TILE], few_rays *f)
{
    const sgt_rays *of = &tile->rays;
    const double *const from[9] = {of->o[0], of->o[1], of->o[2],  of->d[0],   of->d[1],
                                   of->d[2], of->tmin, of->tmax, tile->t_tol};
    double(*ray)[SGT_TILE] = f->ray;
    size_t n = 0, lanes;
    for (size_t i = 0; i < tile->n; i++) /* no branch: which rays are hard is not foreseen */
        f->number[n] = (unsigned char)i, n += tile->hits.status[i] == SGT_HARD;
    for (lanes = n; lanes % 8 != 0; lanes++) f->number[lanes] = f->number[n - 1];
    for (size_t j = 0; j < lanes; j++) {
        const size_t i = f->number[j];
        UNROLLED for (int k = 0; k < 9; k++) ray[k][j] = from[k][i];
    }
    f->n = n;
    f->tile = (sgt_tile){.n = lanes,
                         .rays = {.o = {ray[0], ray[1], ray[2]},
                                  .d = {ray[3], ray[4], ray[5]},
                                  .tmin = ray[6],
                                  .tmax = ray[7]},
                         .t_tol = ray[8],
                         .hits = {.status = f->status,
                                  .evals = f->evals,
                                  .t = out[0],
                                  .t_err = out[1],
                                  .t_lo = out[2],
                                  .p = {out[3], out[4], out[5]},
                                  .n = {out[6], out[7], out[8]},
                                  .p_err = out[9]}};
}

/* Their answers.  Returns how many have none. */
static size_t give_few(const sgt_tile *tile, double out[][SGT_TILE], const few_rays *f)
{
    const sgt_hits *h = &tile->hits;
    const lane_outputs wanted = lane_outputs_of(h);
    double unwanted[SGT_TILE], *to[10];
    size_t left = 0;
    for (int k = 0; k < 10; k++) to[k] = wanted.of[k] ? wanted.of[k] : unwanted;
    for (size_t j = 0; j < f->n; j++) {
        const size_t i = f->number[j];
        h->status[i] = f->status[j], left += f->status[j] == SGT_HARD;
        UNROLLED for (int k = 0; k < 10; k++) to[k][i] = out[k][j];
    }
    for (size_t j = 0; h->evals && j < f->n; j++) h->evals[f->number[j]] = f->evals[j];
    return left;
}

/* The same for the hard rays of a tile alone.  far_gone, start: of all rays, as in verdicts; they are put
 * side by side as well.  out: rows that are free. */
SGT_NOINLINE static size_t conic_lanes_few(const bowl *s, bool first, const sgt_tile *tile,
                                           mask *far_gone, mask *start,
                                           double out[][SGT_TILE])
{
    few_rays few;
    mask tried[SGT_TILE], any = 0;
    take_few(tile, out, &few);
    const size_t n = few.tile.n;
    for (size_t j = 0; j < few.n; j++) {
        size_t i = few.number[j]; /* j at least */
        far_gone[j] = first ? far_gone[i] | start[i] : MASK(true);
        any |= start[i], start[j] = first ? start[i] : 0;
    }
    for (size_t j = few.n; j < n; j++) far_gone[j] = far_gone[few.n - 1], start[j] = start[few.n - 1];
    size_t left = n;
    if (first && any) left = conic_lanes_on_first(s, &few.tile, tried); /* mostly that is all */
    if (8 * left > n && sgt_conic_lanes_tried(s, &few.tile, far_gone, tried))
        (first ? sgt_conic_lanes_sooner_first : sgt_conic_lanes_sooner_near)(s, &few.tile, far_gone, tried);
    if (8 * left > n) conic_lanes_beside(s, first, &few.tile, any ? start : NULL, tried);
    return give_few(tile, out, &few);
}

/* The first roots of rays of which some are not known to miss.  Returns how many are left.  (If these are
 * few, they are put side by side, and asked once more whether they are met.) */
SGT_NOINLINE static size_t lane_left_over(const bowl *s, const sgt_tile *tile, leave_room *room,
                                          double out[][SGT_TILE])
{
    const lane_to to = lane_to_of(tile, &room->ends);
    const mask *hit = room->ends.hit;
    mask others = 0;
    for (size_t i = 0; i < tile->n; i++) others -= ~room->away[i];
    if (16 * others > tile->n)
        (lane_wish_of(tile) < LANE_FINE ? conic_lanes_left : conic_lanes_left_rich)(
            s, tile, to, room);
    else
        lane_nothing(tile), hit = NONE;
    const size_t left = side_status(tile, hit, room->away, NONE);
    memset(room->met, 0xff, tile->n * sizeof *room->met);
    return left ? conic_lanes_few(s, true, tile, room->met, room->start, out) : 0;
}

/* The first roots of a tile whose rays start on the surface.  Returns false, and answers nothing, if most do
 * not; else *hard is how many are left. */
SGT_NOINLINE static bool conic_lanes_leaving(const bowl *s, const sgt_tile *tile, double out[][SGT_TILE],
                                             size_t *hard)
{
    leave_room room;
    size_t n = tile->n, starts = 0;
    if (conic_lanes_leave(s, tile, &room)) {
        *hard = lane_all_missed(tile, true);
        return true;
    }
    for (size_t i = 0; i < n; i++) starts += room.start[i] != 0;
    if (2 * starts < n) return false;
    *hard = lane_left_over(s, tile, &room, out);
    return true;
}

/* Where the first ray of a tile starts.  It is a guess for all of them, and affects only the time:
 *
 *   AWAY     away from the surface
 *   NEARBY   so near the surface that t would not be sharp
 *   LEAVING  on the surface; that root is not accepted */
typedef enum beginning { AWAY, NEARBY, LEAVING } beginning;

static beginning beginning_of(const bowl *s, const sgt_tile *tile)
{
    double x = tile->rays.o[0][0], y = tile->rays.o[1][0], z = tile->rays.o[2][0],
           g = fabs(z - 0.5 * s->c * (x * x + y * y + s->k1 * z * z));
    if (!(g <= 0x1p-6 * fabs(z))) return AWAY;
    return tile->rays.tmin[0] >= 0 && g <= 0x1p-44 * fabs(z) ? LEAVING : NEARBY;
}

/* Does the first ray start in the vertex?  There all terms are 0, and no rule tells that it is on the surface
 * (starts_on).  `away` knows it, and mostly has answers for all of such a tile. */
SGT_INLINE bool in_vertex(const sgt_tile *tile)
{
    const sgt_rays rows = tile->rays;
    const sgt_ray ray = lane_ray_of(&rows, 0);
    return at_vertex(ray.o.x, ray.o.y, ray.o.z) != 0;
}

/* Is that why the loop for AWAY leaves rays over?  The first ray's t is not sharp (lane_of) if t_err / u is
 * above 40 |t|.  That is 25 |tau| + |t|, about 25 times the sag and the distance g, above 40 g.  If it has no
 * t_err, as from the side, `nearby` has no answer either. */
static bool begins_close(const bowl *s, const sgt_tile *tile)
{
    const sgt_rays rows = tile->rays;
    const sgt_ray ray = lane_ray_of(&rows, 0);
    double x = ray.o.x, y = ray.o.y, z = ray.o.z, sag = 0.5 * s->c * (x * x + y * y + s->k1 * z * z),
           t_err = easy_start(s, false, true, &ray).t_err;
    return t_err == t_err && fabs(z - sag) <= 0.625 * fabs(sag);
}

/* From memory one loop reads and writes while it computes; three would read first.  Of a few rays the loops
 * cost more than the chains. */
static bool one_loop(const sgt_tile *tile) { return tile->far || tile->n < 16; }

/* Traces ask for near roots of whole lines, and for t_lo with paths: so there are loops for these alone. */
static size_t lane_near(const bowl *s, lane_wish wish, bool nearby, const sgt_tile *tile, bowl_room *room)
{
    bool rich = wish >= LANE_FINE, fine = wish == LANE_FINE, bare = wish == LANE_BARE;
    if (nearby && s->c == 0) return conic_lanes_plane_nearby(s, tile, room);
    if (nearby)
        return (rich ? conic_lanes_near_nearby_rich : conic_lanes_near_nearby)(s, tile, room);
    if (s->c == 0 && s->proof)
        return rich ? conic_lanes_plane_sure_rich(s, tile, room) : conic_lanes_plane_sure(s, tile, room);
    if (bare && !s->proof)
        return s->c == 0 ? conic_lanes_plane_bare(s, tile, room) : conic_lanes_near_bare(s, tile, room);
    if (s->c == 0 && fine) return conic_lanes_plane_fine(s, tile, room);
    if (s->c == 0) return rich ? conic_lanes_plane_rich(s, tile, room) : conic_lanes_plane(s, tile, room);
    if (s->proof)
        return rich ? conic_lanes_near_sure_rich(s, tile, room) : conic_lanes_near_sure(s, tile, room);
    if (one_loop(tile))
        return (rich ? conic_lanes_near_at_once_rich : conic_lanes_near_at_once)(s, tile, room);
    if (fine) return conic_lanes_near_fine(s, tile, room);
    return rich ? conic_lanes_near_rich(s, tile, room) : conic_lanes_near(s, tile, room);
}

static size_t lane_first(const bowl *s, lane_wish wish, bool nearby, const sgt_tile *tile, bowl_room *room)
{
    bool rich = wish >= LANE_FINE;
    if (nearby)
        return (rich ? conic_lanes_first_nearby_rich : conic_lanes_first_nearby)(s, tile, room);
    if (s->proof)
        return rich ? conic_lanes_first_sure_rich(s, tile, room) : conic_lanes_first_sure(s, tile, room);
    if (one_loop(tile))
        return (rich ? conic_lanes_first_at_once_rich : conic_lanes_first_at_once)(s, tile, room);
    return rich ? conic_lanes_first_rich(s, tile, room) : conic_lanes_first(s, tile, room);
}

/* Does the first ray run along the surface?  Then all are tried from the side at once. */
SGT_INLINE bool runs_along(const bowl *s, const sgt_tile *tile)
{
    const sgt_rays rows = tile->rays;
    const sgt_ray ray = lane_ray_of(&rows, 0);
    return ray.d.z * ray.d.z < ray.d.x * ray.d.x + ray.d.y * ray.d.y && !easy_tries(s, MASK(true), &ray);
}

/* A tile that runs along the surface: rays from the side first, then misses.  Returns false if a single ray
 * would try more than an eighth of them from the vertex plane, or from on the surface; then nothing is
 * answered. */
SGT_NOINLINE static bool conic_lanes_along(const bowl *s, bool first, const sgt_tile *tile, bowl_room *room,
                                           size_t *hard)
{
    sgt_status *status = tile->hits.status;
    mask tried[SGT_TILE], away[SGT_TILE], start[SGT_TILE];
    size_t n = tile->n, sooner = 0;
    side_room r;
    memset(away, 0xff, n * sizeof *away), memset(tried, 0, n * sizeof *tried);
    const side_guesses guess = conic_lanes_guess(s, first, tile, &r);
    if (guess.tried && sgt_conic_lanes_tried(s, tile, away, tried))
        for (size_t i = 0; i < n; i++) sooner += tried[i] != 0;
    if (8 * sooner > n) return false;
    conic_lanes_side(s, first, !guess.twice, tile, lane_to_of(tile, &r.ends), &r, room);
    *hard = side_status(tile, r.ends.hit, r.away, tried);
    if (8 * *hard <= n) return true;
    conic_lanes_away(s, tile, away, tried, start);
    for (size_t i = 0; i < n; i++) {
        if (status[i] != SGT_HARD || !away[i]) continue;
        status[i] = SGT_MISS, --*hard;
    }
    return true;
}

/* Finds first hits by the near root, as is usual if the surface bulges toward the ray.  If more than an
 * eighth of the tile is hard, it looks at the far roots, which come first, for those that are not accepted,
 * and for misses; then from the side, or from on the surface.  Rays that leave the surface begin with that.
 */
size_t sgt_conic_lanes(double c, double k, double semi_diameter, const sgt_tile *tile, const sgt_options *opt)
{
    union {
        bowl_room easy;
        double rows[10][SGT_TILE];
    } room;
    bowl s;
    sgt_status *status = tile->hits.status;
    mask away[SGT_TILE], far_gone[SGT_TILE], start[SGT_TILE];
    if (!conic_valid(c, k, semi_diameter) ||
        !bowl_of(c, k, rim2_of(semi_diameter), opt->proof != SGT_ESTIMATE, &s)) {
        memset(status, SGT_HARD, tile->n);
        return tile->n;
    }
    const lane_wish wish = lane_wish_of(tile);
    bool first = opt->pick != SGT_NEAR_SEED && c != 0;
    beginning from = beginning_of(&s, tile);
    bool hollow =
        first && c * tile->rays.d[2][0] < 0; /* as the first ray sees it: its far root may be first */
    size_t hard = tile->n;
    if (c != 0 && !s.proof && from == AWAY && runs_along(&s, tile) &&
        conic_lanes_along(&s, first, tile, &room.easy, &hard))
        return hard;
    const bool at_once = first && !s.proof;
    if (at_once && from == LEAVING && !in_vertex(tile)) {
        if (conic_lanes_leaving(&s, tile, room.rows, &hard)) return hard;
        from = AWAY; /* the first ray is one of a few */
    }
    bool nearby = from == NEARBY, later = from == LEAVING || hollow; /* later: misses first, then hits */
    if (later) memset(status, SGT_HARD, tile->n);
    else
        hard = first ? lane_first(&s, wish, nearby, tile, &room.easy)
                     : lane_near(&s, wish, nearby, tile, &room.easy);
    if (from == AWAY && !later && 8 * hard > tile->n && begins_close(&s, tile)) {
        nearby = true;
        hard = first ? lane_first(&s, wish, nearby, tile, &room.easy)
                     : lane_near(&s, wish, nearby, tile, &room.easy);
    }
    if (8 * hard <= tile->n) return hard; /* one by one */
    const mask all = c == 0 ? conic_lanes_plane_away(&s, tile, away)
                            : conic_lanes_away(&s, tile, away, far_gone, start);
    if (all) return lane_all_missed(tile, later);
    mask nearest = 0; /* rays whose near root may be accepted and was not computed */
    for (size_t i = 0; i < tile->n; i++) {
        if (at_once) far_gone[i] &= ~start[i];
        if (status[i] == SGT_HIT) far_gone[i] = MASK(true);
        else nearest |= ~away[i] & (first ? far_gone[i] : MASK(later));
    }
    if (nearest)
        lane_near(&s, wish, nearby, tile, &room.easy); /* all: those found before get the same answer */
    else if (later)
        lane_nothing(tile);
    hard = 0;
    for (size_t i = 0; i < tile->n; i++) {
        bool met = status[i] == SGT_HIT && (!first || far_gone[i]);
        status[i] = met ? SGT_HIT : away[i] ? SGT_MISS : SGT_HARD;
        if (!met && tile->hits.evals) tile->hits.evals[i] = 0;
        hard += status[i] == SGT_HARD;
    }
    if (c == 0 || s.proof || 8 * hard <= tile->n) return hard;
    return conic_lanes_few(&s, first, tile, far_gone, start, room.rows);
}

/* A point is on a plane if its z is 0; else it is nowhere near by the rule of the start. */
static void plane_points(size_t n, const double *z, double on[])
{
    for (size_t i = 0; i < n; i++) on[i] = z[i] == 0 ? 1.0 : 0.0;
}

/* F is z, which rises with n from 0 on. */
static void plane_behind(size_t count, const double *z, const double *n, double side[])
{
    for (size_t i = 0; i < count; i++)
        side[i] = z[i] == 0 ? (n[i] > 0 ? 1.0 : 0.0) - (n[i] < 0 ? 1.0 : 0.0) : 0.0;
}

void sgt_conic_on(double c, double k, size_t n, const double *const p[3], double on[])
{
    bowl s;
    if (conic_valid(c, k, 0) && c == 0)
        plane_points(n, p[2], on);
    else if (conic_valid(c, k, 0) && bowl_of(c, k, HUGE_VAL, false, &s))
        conic_lanes_points(&s, n, p, on);
    else
        memset(on, 0, n * sizeof *on);
}

void sgt_conic_behind(double c, double k, size_t n, const sgt_rays *rays, double side[])
{
    bowl s;
    if (conic_valid(c, k, 0) && c == 0)
        plane_behind(n, rays->o[2], rays->d[2], side);
    else if (conic_valid(c, k, 0) && bowl_of(c, k, HUGE_VAL, false, &s))
        conic_lanes_behind(&s, n, rays, side);
    else
        memset(side, 0, n * sizeof *side);
}

/* A plane: rays that start in it meet nothing else, and F is z.  Returns true if that is known of all. */
SGT_KERNEL
static bool conic_lanes_plane_leave(const sgt_tile *tile, double *restrict behind)
{
    const sgt_rays rows = tile->rays;
    const double *x = rows.o[0], *y = rows.o[1], *z = rows.o[2], *l = rows.d[0], *m = rows.d[1],
                 *n = rows.d[2], *tmax = rows.tmax;
    size_t count = tile->n;
    mask all = MASK(true);
    _Pragma("omp simd reduction(& : all)") for (size_t i = 0; i < count; i++)
    {
        double n2 = n[i] * n[i], d2 = (l[i] * l[i] + m[i] * m[i]) + n2, r2 = x[i] * x[i] + y[i] * y[i];
        mask leaves = MASK(z[i] == 0) & MASK(n2 > 0x1p-200) & MASK(d2 < 0x1p200) & MASK(r2 < 0x1p600) &
                      MASK(tmax[i] > 0);
        behind[i] = chosen(leaves, copysign(1, n[i]), 0);
        all &= leaves;
    }
    return all != 0;
}

/* The tile of a plane.  Returns how many are left. */
static size_t plane_leave(const sgt_tile *tile, double behind[])
{
    size_t hard = 0;
    if (conic_lanes_plane_leave(tile, behind)) memset(tile->hits.status, SGT_MISS, tile->n);
    else
        for (size_t i = 0; i < tile->n; i++) {
            tile->hits.status[i] = behind[i] != 0 ? SGT_MISS : SGT_HARD;
            hard += behind[i] == 0;
        }
    lane_nothing(tile);
    if (tile->hits.evals) memset(tile->hits.evals, 0, tile->n * sizeof *tile->hits.evals);
    return hard;
}

size_t sgt_conic_leave(double c, double k, double semi_diameter, const sgt_tile *tile, double behind[])
{
    bowl s;
    leave_room room;
    double out[10][SGT_TILE];
    size_t n = tile->n, off = 0, hard;
    sgt_status *status = tile->hits.status;
    memset(status, SGT_HARD, n);
    if (!conic_valid(c, k, semi_diameter) || !bowl_of(c, k, rim2_of(semi_diameter), false, &s)) return n;
    if (c == 0) return plane_leave(tile, behind);
    bool all = conic_lanes_leave(&s, tile, &room);
    memcpy(behind, room.behind, n * sizeof *behind);
    if (all) return lane_all_missed(tile, true);
    for (size_t i = 0; i < n; i++) off += !room.start[i] | (behind[i] == 0); /* not known to be on it */
    if (8 * off > n) return n;
    for (size_t i = 0; off && i < n; i++) behind[i] = room.start[i] ? behind[i] : 0;
    hard = lane_left_over(&s, tile, &room, out);
    for (size_t i = 0; off && i < n; i++) {
        if (behind[i] != 0) continue;
        hard += status[i] != SGT_HARD;
        status[i] = SGT_HARD;
    }
    return hard;
}

/* A ray is unique if its far root is certainly not accepted: F is monotone within the rim, or the far root
 * is gone.  If the far root certainly is accepted, it is SGT_NOT_UNIQUE.  If the root that was met is the
 * far one itself, it is accepted, so it is never said to be gone. */
bool sgt_conic_unique(double c, double k, double semi_diameter, const sgt_tile *tile, double rim2,
                      mask unique[], sgt_interval others[])
{
    mask gone[SGT_TILE], accepted[SGT_TILE];
    double far[SGT_TILE], slack[SGT_TILE], own = rim2_of(semi_diameter);
    bowl b;
    shape s = {.c = c, .k = k, .ck = (1 + k) * c, .rim2 = rim2 < own ? rim2 : own};
    s.domain2 = domain2_within(c, k, s.rim2);
    if (c == 0) memset(unique, 0xff, tile->n * sizeof *unique);
    if (c == 0 || sgt_lanes_monotone(&s, tile, unique)) return true;
    if (!bowl_of(c, k, s.rim2, false, &b)) return false;
    sgt_conic_lanes_far(&b, tile, gone, accepted, far, slack);
    mask all = MASK(true);
    for (size_t i = 0; i < tile->n; i++) {
        unique[i] |= gone[i], all &= unique[i];
        if (unique[i] || !accepted[i]) continue;
        unique[i] = SGT_NOT_UNIQUE;
        if (others) others[i] = (sgt_interval){far[i] - slack[i], far[i] + slack[i]};
    }
    return all != 0;
}
