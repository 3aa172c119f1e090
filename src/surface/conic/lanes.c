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

SGT_INLINE size_t lane_bowl(const bowl *self, bool plane, bool first, bool proof, lane_wish wish,
                            const sgt_tile *tile, bowl_room *room)
{
    const bowl own = *self, *s = &own; /* a copy, so that no output can alias it */
    const double *ox = tile->rays.o[0], *oy = tile->rays.o[1], *oz = tile->rays.o[2], *l = tile->rays.d[0],
                 *m = tile->rays.d[1], *n = tile->rays.d[2], *tmin = tile->rays.tmin, *tmax = tile->rays.tmax,
                 *t_tol = tile->t_tol;
    size_t count = tile->n;
    const bool whole = wish == LANE_BARE;
    LANES for (size_t i = 0; i < count; i++) {
        near_root r = plane ? plane_start(s, proof, ox[i], oy[i], oz[i], l[i], m[i], n[i])
                            : easy_start(s, first, proof, ox[i], oy[i], oz[i], l[i], m[i], n[i]);
        room->x[i] = r.x, room->y[i] = r.y, room->tau[i] = r.tau, room->t[i] = r.t, room->t_err[i] = r.t_err;
        if (wish >= LANE_FINE) room->t0[i] = r.t0, room->small[i] = r.small;
        if (wish == LANE_RICH) room->tau_err[i] = r.tau_err;
    }
    lane_to to = lane_to_of(tile, &room->ends);
    mask all = MASK(true);
    _Pragma("omp simd reduction(& : all)") for (size_t i = 0; i < count; i++) {
        near_root r = {
            .x = room->x[i], .y = room->y[i], .tau = room->tau[i], .t = room->t[i], .t_err = room->t_err[i]};
        if (wish >= LANE_FINE) r.t0 = room->t0[i], r.small = room->small[i];
        if (wish == LANE_RICH) r.tau_err = room->tau_err[i];
        double begin = whole ? -HUGE_VAL : tmin[i], end = whole ? HUGE_VAL : tmax[i];
        lane e = plane ? plane_end(s, &r, l[i], m[i], n[i], whole, begin, end, t_tol[i])
                       : easy_end(s, &r, l[i], m[i], n[i], whole, begin, end, t_tol[i]);
        LANE_STORE(to, i, e, wish);
        all &= e.hit;
    }
    return lane_told(tile, &room->ends, 1, all);
}

/* easy_away of all rays. */
SGT_KERNEL
static void conic_lanes_away(const bowl *self, const sgt_tile *tile, mask *away, mask *far_gone)
{
    const bowl own = *self, *s = &own;
    const double *ox = tile->rays.o[0], *oy = tile->rays.o[1], *oz = tile->rays.o[2], *l = tile->rays.d[0],
                 *m = tile->rays.d[1], *n = tile->rays.d[2], *tmin = tile->rays.tmin, *tmax = tile->rays.tmax;
    size_t count = tile->n;
    LANES for (size_t i = 0; i < count; i++) {
        verdicts v = easy_away(s, ox[i], oy[i], oz[i], l[i], m[i], n[i], tmin[i], tmax[i]);
        away[i] = v.away, far_gone[i] = v.far_gone;
    }
}

SGT_KERNEL
static void conic_lanes_plane_away(const bowl *self, const sgt_tile *tile, mask *away)
{
    const bowl own = *self, *s = &own;
    const double *ox = tile->rays.o[0], *oy = tile->rays.o[1], *oz = tile->rays.o[2], *l = tile->rays.d[0],
                 *m = tile->rays.d[1], *n = tile->rays.d[2], *tmin = tile->rays.tmin, *tmax = tile->rays.tmax;
    size_t count = tile->n;
    LANES
    for (size_t i = 0; i < count; i++)
        away[i] = plane_away(s, ox[i], oy[i], oz[i], l[i], m[i], n[i], tmin[i], tmax[i]);
}

/* What is known of the far roots of all rays. */
SGT_KERNEL
static void conic_lanes_far(const bowl *self, const sgt_tile *tile, mask *gone, mask *accepted, double *far,
                            double *slack)
{
    const bowl own = *self, *s = &own;
    const double *ox = tile->rays.o[0], *oy = tile->rays.o[1], *oz = tile->rays.o[2], *l = tile->rays.d[0],
                 *m = tile->rays.d[1], *n = tile->rays.d[2], *tmin = tile->rays.tmin, *tmax = tile->rays.tmax;
    size_t count = tile->n;
    LANES for (size_t i = 0; i < count; i++) {
        verdicts v = easy_away(s, ox[i], oy[i], oz[i], l[i], m[i], n[i], tmin[i], tmax[i]);
        gone[i] = v.far_gone, accepted[i] = v.far_accepted, far[i] = v.far, slack[i] = v.slack;
    }
}

#define LANES_OF_BOWL(name, plane, first, proof, wish)                                          \
    SGT_KERNEL static size_t name(const bowl *s, const sgt_tile *tile, bowl_room *room)         \
    {                                                                                           \
        return lane_bowl(s, plane, first, proof, wish, tile, room);                             \
    }

LANES_OF_BOWL(conic_lanes_plane_bare, true, false, false, LANE_BARE)
LANES_OF_BOWL(conic_lanes_plane, true, false, false, LANE_PLAIN)
LANES_OF_BOWL(conic_lanes_plane_fine, true, false, false, LANE_FINE)
LANES_OF_BOWL(conic_lanes_plane_rich, true, false, false, LANE_RICH)
LANES_OF_BOWL(conic_lanes_plane_sure, true, false, true, LANE_PLAIN)
LANES_OF_BOWL(conic_lanes_plane_sure_rich, true, false, true, LANE_RICH)
LANES_OF_BOWL(conic_lanes_near_bare, false, false, false, LANE_BARE)
LANES_OF_BOWL(conic_lanes_near, false, false, false, LANE_PLAIN)
LANES_OF_BOWL(conic_lanes_near_fine, false, false, false, LANE_FINE)
LANES_OF_BOWL(conic_lanes_near_rich, false, false, false, LANE_RICH)
LANES_OF_BOWL(conic_lanes_near_sure, false, false, true, LANE_PLAIN)
LANES_OF_BOWL(conic_lanes_near_sure_rich, false, false, true, LANE_RICH)
LANES_OF_BOWL(conic_lanes_first, false, true, false, LANE_PLAIN)
LANES_OF_BOWL(conic_lanes_first_rich, false, true, false, LANE_RICH)
LANES_OF_BOWL(conic_lanes_first_sure, false, true, true, LANE_PLAIN)
LANES_OF_BOWL(conic_lanes_first_sure_rich, false, true, true, LANE_RICH)

/* The same for rays that start near the surface or on it too (conic/easy.h, NEARBY).  One loop, because few
 * tiles are met so. */
SGT_INLINE size_t lane_nearby(const bowl *self, bool plane, bool first, lane_wish wish, const sgt_tile *tile,
                              bowl_room *room)
{
    const bowl own = *self, *s = &own;
    const double *ox = tile->rays.o[0], *oy = tile->rays.o[1], *oz = tile->rays.o[2], *l = tile->rays.d[0],
                 *m = tile->rays.d[1], *n = tile->rays.d[2], *tmin = tile->rays.tmin, *tmax = tile->rays.tmax,
                 *t_tol = tile->t_tol;
    lane_to to = lane_to_of(tile, &room->ends);
    mask all = MASK(true);
    _Pragma("omp simd reduction(& : all)") for (size_t i = 0; i < tile->n; i++) {
        lane e = plane ? plane_at_start(s, ox[i], oy[i], oz[i], l[i], m[i], n[i], tmin[i], tmax[i], t_tol[i])
                       : easy_or_nearby(s, first, ox[i], oy[i], oz[i], l[i], m[i], n[i], tmin[i], tmax[i],
                                        t_tol[i]);
        LANE_STORE(to, i, e, wish);
        all &= e.hit;
    }
    return lane_told(tile, &room->ends, 1, all);
}

#define LANES_NEARBY(name, plane, first, wish)                                                  \
    SGT_KERNEL static size_t name(const bowl *s, const sgt_tile *tile, bowl_room *room)         \
    {                                                                                           \
        return lane_nearby(s, plane, first, wish, tile, room);                                  \
    }

LANES_NEARBY(conic_lanes_plane_nearby, true, false, LANE_RICH)
LANES_NEARBY(conic_lanes_near_nearby, false, false, LANE_PLAIN)
LANES_NEARBY(conic_lanes_near_nearby_rich, false, false, LANE_RICH)
LANES_NEARBY(conic_lanes_first_nearby, false, true, LANE_PLAIN)
LANES_NEARBY(conic_lanes_first_nearby_rich, false, true, LANE_RICH)

/* met_from_side of all rays.  `sooner` are those that a single ray meets before it, by easy_at or
 * nearby_at. */
typedef struct side_blunt {
    mask is[SGT_TILE];
    double at[SGT_TILE], off[SGT_TILE];
} side_blunt;
typedef struct side_room {
    double of[10][SGT_TILE]; /* the rows of a lane_to, if some rays have an answer already */
    lane_ends ends;
    mask away[SGT_TILE], sooner[SGT_TILE];
    side_blunt blunt;
} side_room;

SGT_INLINE void lane_sooner(const bowl *s, bool first, const sgt_tile *tile, const mask *far_gone, mask *no)
{
    const double *ox = tile->rays.o[0], *oy = tile->rays.o[1], *oz = tile->rays.o[2], *l = tile->rays.d[0],
                 *m = tile->rays.d[1], *n = tile->rays.d[2], *tmin = tile->rays.tmin, *tmax = tile->rays.tmax,
                 *t_tol = tile->t_tol;
    size_t count = tile->n;
    LANES for (size_t i = 0; i < count; i++) {
        near_root r = easy_start(s, false, false, ox[i], oy[i], oz[i], l[i], m[i], n[i]);
        mask met = easy_end(s, &r, l[i], m[i], n[i], false, tmin[i], tmax[i], t_tol[i]).hit;
        r.t_err = easy_start(s, false, true, ox[i], oy[i], oz[i], l[i], m[i], n[i]).t_err;
        met |= nearby(s, &r, ox[i], oy[i], oz[i], l[i], m[i], n[i], tmin[i], tmax[i], t_tol[i]).hit;
        if (first) {
            double begun = easy_start(s, true, false, ox[i], oy[i], oz[i], l[i], m[i], n[i]).t_err;
            met &= MASK(begun == begun) | far_gone[i];
        }
        no[i] = met;
    }
}

SGT_INLINE void lane_side(const bowl *self, bool first, const sgt_tile *tile, const mask *far_gone,
                          lane_to to, side_blunt *blunt, mask *away, mask *no)
{
    const bowl own = *self, *s = &own;
    const double *ox = tile->rays.o[0], *oy = tile->rays.o[1], *oz = tile->rays.o[2], *l = tile->rays.d[0],
                 *m = tile->rays.d[1], *n = tile->rays.d[2], *tmin = tile->rays.tmin, *tmax = tile->rays.tmax,
                 *t_tol = tile->t_tol;
    size_t count = tile->n;
    mask any = 0;
    _Pragma("omp simd reduction(| : any)") for (size_t i = 0; i < count; i++)
    {
        double t_err = easy_start(s, false, false, ox[i], oy[i], oz[i], l[i], m[i], n[i]).t_err;
        any |= MASK(t_err == t_err); /* else neither the easy form nor `nearby` meets it */
        no[i] = 0;
    }
    if (any) lane_sooner(s, first, tile, far_gone, no);
    mask again = 0;
    _Pragma("omp simd reduction(| : again)") for (size_t i = 0; i < count; i++)
    {
        side_answer a =
            met_from_side(s, first, ox[i], oy[i], oz[i], l[i], m[i], n[i], tmin[i], tmax[i], t_tol[i]);
        LANE_STORE(to, i, a.e, LANE_RICH);
        away[i] = a.away, blunt->is[i] = a.blunt, blunt->at[i] = a.at, blunt->off[i] = a.off;
        again |= a.blunt;
    }
    if (!again) return;
    LANES for (size_t i = 0; i < count; i++)
    {
        lane e = sharp_from_side(s, blunt->at[i], blunt->off[i], ox[i], oy[i], oz[i], l[i], m[i], n[i],
                                 tmin[i], tmax[i], t_tol[i]);
        mask is = blunt->is[i];
        to.t[i] = chosen(is, e.t, to.t[i]), to.t_err[i] = chosen(is, e.t_err, to.t_err[i]),
        to.t_lo[i] = chosen(is, e.t_lo, to.t_lo[i]), to.px[i] = chosen(is, e.px, to.px[i]),
        to.py[i] = chosen(is, e.py, to.py[i]), to.pz[i] = chosen(is, e.pz, to.pz[i]),
        to.nx[i] = chosen(is, e.nx, to.nx[i]), to.ny[i] = chosen(is, e.ny, to.ny[i]),
        to.nz[i] = chosen(is & e.hit, 1, to.nz[i]), to.p_err[i] = chosen(is, e.p_err, to.p_err[i]),
        to.hit[i] |= is & e.hit;
    }
}

SGT_KERNEL
static void conic_lanes_side_first(const bowl *s, const sgt_tile *tile, const mask *far_gone, lane_to to,
                                   side_blunt *blunt, mask *away, mask *sooner)
{
    lane_side(s, true, tile, far_gone, to, blunt, away, sooner);
}
SGT_KERNEL
static void conic_lanes_side_near(const bowl *s, const sgt_tile *tile, const mask *far_gone, lane_to to,
                                  side_blunt *blunt, mask *away, mask *sooner)
{
    lane_side(s, false, tile, far_gone, to, blunt, away, sooner);
}

/* met_from_on of the rays that have no answer yet. */
SGT_KERNEL
static void conic_lanes_on(const bowl *self, const sgt_tile *tile, lane_to to, mask *away)
{
    const bowl own = *self, *s = &own;
    const double *ox = tile->rays.o[0], *oy = tile->rays.o[1], *oz = tile->rays.o[2], *l = tile->rays.d[0],
                 *m = tile->rays.d[1], *n = tile->rays.d[2], *tmin = tile->rays.tmin, *tmax = tile->rays.tmax,
                 *t_tol = tile->t_tol;
    size_t count = tile->n;
    LANES for (size_t i = 0; i < count; i++) {
        side_answer a = met_from_on(s, ox[i], oy[i], oz[i], l[i], m[i], n[i], tmin[i], tmax[i], t_tol[i]);
        mask had = to.hit[i] | away[i];
        lane e = {chosen(had, to.t[i], a.e.t),   chosen(had, to.t_err[i], a.e.t_err),
                  chosen(had, to.t_lo[i], a.e.t_lo), chosen(had, to.px[i], a.e.px),
                  chosen(had, to.py[i], a.e.py), chosen(had, to.pz[i], a.e.pz),
                  chosen(had, to.nx[i], a.e.nx), chosen(had, to.ny[i], a.e.ny),
                  chosen(had, to.p_err[i], a.e.p_err), to.hit[i] | (~had & a.e.hit)};
        LANE_STORE(to, i, e, LANE_RICH);
        away[i] |= ~had & a.away;
    }
}

/* Answers the hard rays of a tile by met_from_side, and met_from_on if `on`; no proof is asked for.  before:
 * how many there are.  Returns how many are left. */
SGT_NOINLINE static size_t conic_lanes_beside(const bowl *s, bool first, bool on, const sgt_tile *tile,
                                              const mask *far_gone, size_t before)
{
    side_room r;
    const sgt_hits *h = &tile->hits;
    size_t hard = 0;
    lane_to to = {r.of[0], r.of[1], r.of[2], r.of[3], r.of[4],   r.of[5],
                  r.of[6], r.of[7], r.of[8], r.of[9], r.ends.hit};
    if (before == tile->n) to = lane_to_of(tile, &r.ends);
    (first ? conic_lanes_side_first : conic_lanes_side_near)(s, tile, far_gone, to, &r.blunt, r.away,
                                                             r.sooner);
    if (on) conic_lanes_on(s, tile, to, r.away);
    for (size_t i = 0; i < tile->n; i++) {
        if (h->status[i] != SGT_HARD) continue;
        double scale = scale_of((sgt_vec3){tile->rays.d[0][i], tile->rays.d[1][i], tile->rays.d[2][i]});
        bool met = r.ends.hit[i] != 0, none = r.sooner[i] || !(met || r.away[i]) || !usual_direction(scale);
        hard += none;
        if (none) continue;
        h->status[i] = met ? SGT_HIT : SGT_MISS;
        if (!met) continue;
        if (h->evals) h->evals[i] = 1;
        if (before == tile->n) continue;
        sgt_hit one = hit_of_lane(&(lane){to.t[i], to.t_err[i], to.t_lo[i], to.px[i], to.py[i], to.pz[i],
                                          to.nx[i], to.ny[i], to.p_err[i], to.hit[i]},
                                  1, 0);
        put_hit(h, i, &one);
    }
    return hard;
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

/* Is that why the loop for AWAY leaves rays over?  The first ray's t is not sharp (lane_of) if t_err / u is
 * above 40 |t|.  That is 25 |tau| + |t|, about 25 times the sag and the distance g, above 40 g.  If it has no
 * t_err, as from the side, `nearby` has no answer either. */
static bool begins_close(const bowl *s, const sgt_tile *tile)
{
    double x = tile->rays.o[0][0], y = tile->rays.o[1][0], z = tile->rays.o[2][0],
           sag = 0.5 * s->c * (x * x + y * y + s->k1 * z * z);
    double t_err =
        easy_start(s, false, true, x, y, z, tile->rays.d[0][0], tile->rays.d[1][0], tile->rays.d[2][0]).t_err;
    return t_err == t_err && fabs(z - sag) <= 0.625 * fabs(sag);
}

/* Traces ask for near roots of whole lines, and for t_lo with paths: so there are loops for these alone. */
static size_t lane_near(const bowl *s, lane_wish wish, bool nearby, const sgt_tile *tile, bowl_room *room)
{
    bool rich = wish >= LANE_FINE, fine = wish == LANE_FINE, bare = wish == LANE_BARE;
    if (nearby && s->c == 0) return conic_lanes_plane_nearby(s, tile, room);
    if (nearby)
        return rich ? conic_lanes_near_nearby_rich(s, tile, room) : conic_lanes_near_nearby(s, tile, room);
    if (s->c == 0 && s->proof)
        return rich ? conic_lanes_plane_sure_rich(s, tile, room) : conic_lanes_plane_sure(s, tile, room);
    if (bare && !s->proof)
        return s->c == 0 ? conic_lanes_plane_bare(s, tile, room) : conic_lanes_near_bare(s, tile, room);
    if (s->c == 0 && fine) return conic_lanes_plane_fine(s, tile, room);
    if (s->c == 0) return rich ? conic_lanes_plane_rich(s, tile, room) : conic_lanes_plane(s, tile, room);
    if (s->proof)
        return rich ? conic_lanes_near_sure_rich(s, tile, room) : conic_lanes_near_sure(s, tile, room);
    if (fine) return conic_lanes_near_fine(s, tile, room);
    return rich ? conic_lanes_near_rich(s, tile, room) : conic_lanes_near(s, tile, room);
}

static size_t lane_first(const bowl *s, lane_wish wish, bool nearby, const sgt_tile *tile, bowl_room *room)
{
    bool rich = wish >= LANE_FINE;
    if (nearby)
        return rich ? conic_lanes_first_nearby_rich(s, tile, room) : conic_lanes_first_nearby(s, tile, room);
    if (s->proof)
        return rich ? conic_lanes_first_sure_rich(s, tile, room) : conic_lanes_first_sure(s, tile, room);
    return rich ? conic_lanes_first_rich(s, tile, room) : conic_lanes_first(s, tile, room);
}

/* Finds first hits by the near root, as is usual if the surface bulges toward the ray.  If more than an
 * eighth of the tile is hard, it looks at the far roots, which come first, for those that are not accepted,
 * and for misses. */
size_t sgt_conic_lanes(double c, double k, double semi_diameter, const sgt_tile *tile, const sgt_options *opt)
{
    bowl_room room;
    bowl s;
    sgt_status *status = tile->hits.status;
    mask away[SGT_TILE], far_gone[SGT_TILE];
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
    bool nearby = from == NEARBY,
         later = from == LEAVING || hollow; /* later: misses first, then hits */
    size_t hard = tile->n;
    if (later) memset(status, SGT_HARD, tile->n);
    else
        hard = first ? lane_first(&s, wish, nearby, tile, &room) : lane_near(&s, wish, nearby, tile, &room);
    if (from == AWAY && !later && 8 * hard > tile->n && begins_close(&s, tile)) {
        nearby = true;
        hard = first ? lane_first(&s, wish, nearby, tile, &room) : lane_near(&s, wish, nearby, tile, &room);
    }
    if (8 * hard <= tile->n) return hard; /* one by one */
    if (c == 0) conic_lanes_plane_away(&s, tile, away);
    else conic_lanes_away(&s, tile, away, far_gone);
    mask nearest = 0; /* rays whose near root may be accepted and was not computed */
    for (size_t i = 0; i < tile->n; i++) {
        if (status[i] == SGT_HIT) far_gone[i] = MASK(true);
        else nearest |= ~away[i] & (first ? far_gone[i] : MASK(later));
    }
    if (nearest)
        lane_near(&s, wish, nearby, tile, &room); /* all rays: those found before get the same answer */
    else if (later) lane_nothing(tile, &room.ends);
    hard = 0;
    for (size_t i = 0; i < tile->n; i++) {
        bool met = status[i] == SGT_HIT && (!first || far_gone[i]);
        status[i] = met ? SGT_HIT : away[i] ? SGT_MISS : SGT_HARD;
        if (!met && tile->hits.evals) tile->hits.evals[i] = 0;
        hard += status[i] == SGT_HARD;
    }
    if (c == 0 || s.proof || 8 * hard <= tile->n) return hard;
    return conic_lanes_beside(&s, first, from == LEAVING, tile, far_gone, hard);
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
    conic_lanes_far(&b, tile, gone, accepted, far, slack);
    mask all = MASK(true);
    for (size_t i = 0; i < tile->n; i++) {
        unique[i] |= gone[i], all &= unique[i];
        if (unique[i] || !accepted[i]) continue;
        unique[i] = SGT_NOT_UNIQUE;
        if (others) others[i] = (sgt_interval){far[i] - slack[i], far[i] + slack[i]};
    }
    return all != 0;
}
