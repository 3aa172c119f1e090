// SPDX-License-Identifier: MIT
/* asphere/side.c - rays from the side: the loops of asphere/side.h, and the single ray.
 *
 * WHY APART.  Without them each such ray of a batch is met by itself: 1,960 ns for a ray along the vertex
 * plane into a bowl, 300 for one that passes 40 beside a rim of 5 (even asphere c = 0.1, k = -0.6; 48
 * and 20 with them). */
#include "graze.h"

#include "asphere.h"

/* Tells the watcher of F at tau. */
static void side_tell(const shape *h, const sgt_ray *ray, tally *w, const local *at, double tau,
                      sgt_move move)
{
    if (!w->stopped) observe(h, ray, w, at, tau, move, -HUGE_VAL, HUGE_VAL);
}

/* A ray that grazes, by graze.h.  Returns true if it is met. */
static bool graze_met(const wavy *s, const convex *b, const sgt_ray *ray, double scale, lane *e, tally *w,
                      const shape *h, const sgt_ray *from)
{
    const graze_seed seed = graze_seed_of(s, b, ALL_TERMS, ray);
    const local at = {.t0 = 0, .scale = scale};
    if (!seed.asked) return false;
    side_tell(h, from, w, &at, seed.t, SGT_SEED);
    wavy_newton step = graze_begin(s, b, ALL_TERMS, seed.t, ray);
    mask again = ~graze_ready(s, b, &step, ray);
    side_tell(h, from, w, &at, step.tau2 + step.step2, SGT_NEWTON);
    for (int i = 2; i < GRAZE_STEPS && again; i++) {
        side_tell(h, from, w, &at, step.tau2, SGT_NEWTON);
        step = graze_next(s, ALL_TERMS, step.tau2, ray);
        again = ~graze_ready(s, b, &step, ray);
    }
    side_tell(h, from, w, &at, step.tau2, SGT_NEWTON);
    const double t_tol = w->opt->t_tol / scale;
    const graze_root r = graze_root_at(s, ALL_TERMS, step.tau2, ray, t_tol);
    *e = graze_lane(s, b, ALL_TERMS, &r.q, step.tau2, r.inverse, &r.root, ray, t_tol);
    return e->hit && !w->stopped;
}

/* One ray with explicit ends, as asphere_easy_at. */
SGT_INLINE easy_answer beside_at(const wavy *s, bool grazing, const sgt_ray *ray, double scale, lane *e,
                                 tally *w, const shape *h, const sgt_ray *from)
{
    const double t_tol = w->opt->t_tol / scale;
    const bool first = w->opt->pick != SGT_NEAR_SEED;
    convex b = convex_of(s);
    if (grazing && graze_met(s, &b, ray, scale, e, w, h, from)) return EASY_HIT;
    if (w->stopped) return EASY_NOT;
    side_stretch r = side_stretch_of(&b, ray);
    if (r.away) return EASY_MISS;
    if (!r.chord) return EASY_NOT;
    side_question ask = {r.q, side_way_of(s, ALL_TERMS, &r, ray), r.to, r.chord, {0, 0}};
    side_seed seed = side_seed_of(s, &b, ALL_TERMS, first, &ask, ray);
    local at = {.t0 = r.t0, .scale = scale};
    side_tell(h, from, w, &at, ask.way.from, SGT_PROBE);
    side_tell(h, from, w, &at, r.to, SGT_PROBE);
    if (seed.close && !seed.away && ray->tmin == 0 && !w->stopped) {
        ask.on = side_on_of(s, &b, ALL_TERMS, ray);
        seed = side_seed_of(s, &b, ALL_TERMS, first, &ask, ray);
        side_tell(h, from, w, &at, -r.t0, SGT_PROBE);
    }
    if (w->stopped || !(seed.above | seed.below)) return seed.away && !w->stopped ? EASY_MISS : EASY_NOT;
    wavy_newton step = {.tau2 = seed.tau};
    for (int i = 0; i < SIDE_STEPS && (i == 0 || !side_ready(&step, seed.tau)); i++) {
        seed.tau = step.tau2;
        step = side_step(s, ALL_TERMS, &r.q, seed.tau, ray);
        if (i == 0) step = side_turned(&step, seed.tau, side_bend(s, &b, ray), seed.above ? -b.sign : b.sign);
        side_tell(h, from, w, &at, seed.tau, i ? SGT_NEWTON : SGT_SEED);
    }
    side_round end = side_bound(s, ALL_TERMS, &r.q, r.t0, &step, ray, t_tol);
    side_tell(h, from, w, &at, step.tau2, SGT_NEWTON);
    side_sharper root = {r.q, r.t0, end.at};
    if (end.blunt) {
        side_tell(h, from, w, &at, end.at.tau, SGT_NEWTON);
        root = side_sharp(s, &b, ALL_TERMS, r.t0, step.inverse, &end, ray, t_tol);
    }
    const side_found found = {root.t0, ask.way.r2, step.inverse, seed.above, seed.below};
    *e = side_lane(s, &b, ALL_TERMS, &root.q, &found, &root.root, ray, t_tol);
    return e->hit && !w->stopped ? EASY_HIT : EASY_NOT;
}

/* Answers a ray that easy.h has left.  Its evaluations are counted and reported, whatever the answer.  A
 * direction of unusual length is scaled as there. */
SGT_NARROW(easy_answer, sgt_asphere_beside,
           (const wavy *s, const shape *h, bool grazing, const sgt_ray *ray, lane *e, tally *w))
{
    const sgt_vec3 d = ray->d;
    double scale = scale_of(d);
    if (usual_length((d.x * d.x + d.y * d.y) + d.z * d.z))
        return beside_at(s, grazing, ray, 1, e, w, h, ray);
    if (!ends_are_whole(ray, scale)) return EASY_NOT;
    const sgt_ray along = along_scaled(ray, scale);
    easy_answer is = beside_at(s, grazing, &along, scale, e, w, h, ray);
    return is == EASY_HIT ? easy_unscaled(e, scale) : is;
}

/* So many rays at a time: a stack holds a small room. */
enum { SIDE_TILE = SGT_TILE / 2 };

/* What the loops leave for each other.  of: the rows of a lane_to, if the rays have been put side by side. */
typedef struct beside_room {
    _Alignas(64) double x[SIDE_TILE];
    double y[SIDE_TILE], z[SIDE_TILE], rho0[SIDE_TILE], t0[SIDE_TILE], from[SIDE_TILE], to[SIDE_TILE],
        r2[SIDE_TILE], tau[SIDE_TILE], tau2[SIDE_TILE], step2[SIDE_TILE], inverse[SIDE_TILE], dw[SIDE_TILE],
        slant[SIDE_TILE];
    mask asked[SIDE_TILE], off[SIDE_TILE], away[SIDE_TILE], above[SIDE_TILE], below[SIDE_TILE],
        again[SIDE_TILE], starts[2][SIDE_TILE], close[SIDE_TILE], on[SIDE_TILE];
    const mask *rises, *falls; /* as in a side_on: none, or `starts` */
    int steps[SIDE_TILE];
    bool afar;
    double of[10][SIDE_TILE];
    lane_ends ends;
} beside_room;

/* The stretch of each ray: `asked` is set where one is known.  Returns all bits set if there are such. */
SGT_KERNEL
static mask asphere_beside_stretch(const convex *bent, const sgt_tile *tile, beside_room *r)
{
    const sgt_rays rows = tile->rays;
    const convex mine = *bent, *b = &mine; /* a copy, so that no output can alias it */
    size_t count = tile->n;
    mask any = 0, afar = 0;
    _Pragma("omp simd reduction(| : any, afar)") for (size_t i = 0; i < count; i++)
    {
        const sgt_ray ray = lane_ray_of(&rows, i);
        side_stretch one = side_stretch_of(b, &ray);
        r->x[i] = one.q.x, r->y[i] = one.q.y, r->z[i] = one.q.z, r->rho0[i] = one.q.rho0, r->t0[i] = one.t0,
        r->from[i] = one.from, r->to[i] = one.to;
        const double far = fabs(ray.o.x) + fabs(ray.o.y) + fabs(ray.o.z); /* the rays have not been checked */
        mask hard = usual_length((ray.d.x * ray.d.x + ray.d.y * ray.d.y) + ray.d.z * ray.d.z) &
                    MASK(far < HUGE_VAL),
             left = hard & ~one.away & one.chord;
        r->away[i] = hard & one.away, r->asked[i] = left;
        r->r2[i] = one.r2, r->off[i] = 0, r->close[i] = one.afar;
        afar |= left & one.afar;
        any |= left;
    }
    r->afar = afar != 0;
    return any;
}

/* Do all rays certainly pass by, as their stretches tell? */
SGT_KERNEL
static mask asphere_all_past(const convex *bent, const sgt_tile *tile)
{
    const sgt_rays rows = tile->rays;
    const convex mine = *bent, *b = &mine;
    size_t count = tile->n;
    mask all = MASK(true);
    _Pragma("omp simd reduction(& : all)") for (size_t i = 0; i < count; i++)
    {
        const sgt_ray ray = lane_ray_of(&rows, i);
        const double far = fabs(ray.o.x) + fabs(ray.o.y) + fabs(ray.o.z),
                     d2 = (ray.d.x * ray.d.x + ray.d.y * ray.d.y) + ray.d.z * ray.d.z;
        all &= side_stretch_of(b, &ray).away & usual_length(d2) & MASK(far < HUGE_VAL);
    }
    return all;
}

bool sgt_asphere_lanes_past(const convex *b, const sgt_tile *tile) { return asphere_all_past(b, tile) != 0; }

/* Makes the stretches that are afar (`close` tells) shorter, as side_way_of does.  off is set where `from`
 * has moved.  (In a loop for each
 * round: of both in one gcc 12 makes branches.) */
SGT_INLINE void beside_ways(const wavy *self, int terms, const sgt_tile *tile, beside_room *r)
{
    const sgt_rays rows = tile->rays;
    const wavy own = *self, *s = &own;
    size_t count = tile->n;
    for (int round = 0; round < 2; round++)
        LANES for (size_t i = 0; i < count; i++)
        {
            const sgt_ray ray = lane_ray_of(&rows, i);
            double from = r->from[i];
            side_way way = {from, r->r2[i], 0};
            way = comes_near(s, terms, way, 0, &(side_local){r->x[i], r->y[i], r->z[i], 0}, &ray);
            mask afar = r->close[i];
            r->from[i] = chosen(afar, way.from, from), r->r2[i] = chosen(afar, way.r2, r->r2[i]);
            r->off[i] |= afar & MASK(way.from > from);
        }
}

/* The seeds.  any: a root is looked for; close: a ray may start on the surface, and has tmin = 0. */
typedef struct beside_said {
    mask any, close;
} beside_said;

SGT_INLINE beside_said beside_seeds(const wavy *self, const convex *bent, int terms, bool first,
                             const sgt_tile *tile, beside_room *r)
{
    const sgt_rays rows = tile->rays;
    const wavy own = *self, *s = &own;
    const convex mine = *bent, *b = &mine;
    size_t count = tile->n;
    const mask *rises = r->rises, *falls = r->falls;
    mask any = 0, some = 0;
    _Pragma("omp simd reduction(| : any, some)") for (size_t i = 0; i < count; i++)
    {
        const sgt_ray ray = lane_ray_of(&rows, i);
        const side_question ask = {{r->x[i], r->y[i], r->z[i], r->rho0[i]},
                                   {r->from[i], r->r2[i], r->off[i]},
                                   r->to[i],
                                   r->asked[i],
                                   {rises[i], falls[i]}};
        side_seed one = side_seed_of(s, b, terms, first, &ask, &ray);
        r->tau2[i] = one.tau, r->above[i] = one.above, r->below[i] = one.below;
        mask close = one.close & ~one.away & MASK(ray.tmin == 0);
        r->away[i] |= one.away, r->close[i] = close;
        mask again = one.above | one.below;
        r->again[i] = again;
        any |= again, some |= close;
    }
    return (beside_said){any, some};
}

/* Which of the rays that may start on the surface do?  Returns all bits set if some do. */
SGT_KERNEL
static mask asphere_beside_on(const wavy *self, const convex *bent, const sgt_tile *tile, beside_room *r)
{
    const sgt_rays rows = tile->rays;
    const wavy own = *self, *s = &own;
    const convex mine = *bent, *b = &mine;
    size_t count = tile->n;
    mask any = 0;
    _Pragma("omp simd reduction(| : any)") for (size_t i = 0; i < count; i++)
    {
        const sgt_ray ray = lane_ray_of(&rows, i);
        side_on one = side_on_of(s, b, ALL_TERMS, &ray);
        mask asked = r->on[i];
        r->starts[0][i] = asked & one.rises, r->starts[1][i] = asked & one.falls;
        any |= asked & (one.rises | one.falls);
    }
    return any;
}

/* A step for the rays that need one, the first one turned.  Returns all bits set if some need another. */
SGT_INLINE mask beside_step(const wavy *self, const convex *bent, int terms, bool turned,
                            const sgt_tile *tile, beside_room *r)
{
    const convex mine = *bent, *b = &mine;
    const sgt_rays rows = tile->rays;
    const wavy own = *self, *s = &own;
    size_t count = tile->n;
    mask any = 0;
    _Pragma("omp simd reduction(| : any)") for (size_t i = 0; i < count; i++)
    {
        const sgt_ray ray = lane_ray_of(&rows, i);
        side_local q = {r->x[i], r->y[i], r->z[i], r->rho0[i]};
        mask again = r->again[i];
        double tau2 = r->tau2[i], step2 = r->step2[i], /* a ray that is done keeps its step */
               tau = chosen(again, tau2, r->tau[i]);
        double A = side_bend(s, b, &ray), wanted = chosen(r->above[i], -b->sign, b->sign);
        wavy_newton h = side_step(s, terms, &q, tau, &ray);
        if (turned) h = side_turned(&h, tau, A, wanted);
        r->tau[i] = tau, r->tau2[i] = chosen(again, h.tau2, tau2),
        r->step2[i] = chosen(again, h.step2, step2);
        r->inverse[i] = h.inverse, r->dw[i] = h.dw, r->slant[i] = h.slant;
        again &= ~side_ready(&h, tau);
        r->again[i] = again;
        any |= again;
    }
    return any;
}

/* Plain roots: tau_err is left in tau2, v in from, near in to.  Returns all bits set if some are blunt; they
 * are in `again`, and what side_sharp needs of them in tau, step2 and dw. */
SGT_INLINE mask beside_ends(const wavy *self, int terms, const sgt_tile *tile, beside_room *r)
{
    const sgt_rays rows = tile->rays;
    const double *t_tol = tile->t_tol;
    const wavy own = *self, *s = &own;
    size_t count = tile->n;
    mask any = 0;
    _Pragma("omp simd reduction(| : any)") for (size_t i = 0; i < count; i++)
    {
        const sgt_ray ray = lane_ray_of(&rows, i);
        side_local q = {r->x[i], r->y[i], r->z[i], r->rho0[i]};
        wavy_newton h = {.tau2 = r->tau2[i], .step2 = r->step2[i], .inverse = r->inverse[i], .dw = r->dw[i],
                         .slant = r->slant[i]};
        side_round end = side_bound(s, terms, &q, r->t0[i], &h, &ray, t_tol[i]);
        mask blunt = end.blunt & (r->above[i] | r->below[i]);
        r->tau[i] = end.at.tau, r->tau2[i] = end.at.tau_err, r->from[i] = end.at.v, r->to[i] = end.at.near;
        r->step2[i] = end.rough, r->dw[i] = end.off, r->again[i] = blunt;
        any |= blunt;
    }
    return any;
}

/* side_sharp of the blunt roots. */
SGT_INLINE void beside_sharp(const wavy *self, const convex *bent, int terms, const sgt_tile *tile,
                             beside_room *r)
{
    const sgt_rays rows = tile->rays;
    const double *t_tol = tile->t_tol;
    const wavy own = *self, *s = &own;
    const convex mine = *bent, *b = &mine;
    size_t count = tile->n;
    LANES for (size_t i = 0; i < count; i++)
    {
        const sgt_ray ray = lane_ray_of(&rows, i);
        const side_round end = {{.tau = r->tau[i]}, r->step2[i], r->dw[i], r->again[i]};
        const side_sharper e = side_sharp(s, b, terms, r->t0[i], r->inverse[i], &end, &ray, t_tol[i]);
        const mask is = r->again[i];
        r->x[i] = chosen(is, e.q.x, r->x[i]), r->y[i] = chosen(is, e.q.y, r->y[i]),
        r->z[i] = chosen(is, e.q.z, r->z[i]), r->t0[i] = chosen(is, e.t0, r->t0[i]);
        r->tau[i] = chosen(is, e.root.tau, r->tau[i]), r->tau2[i] = chosen(is, e.root.tau_err, r->tau2[i]);
        r->from[i] = chosen(is, e.root.v, r->from[i]), r->to[i] = chosen(is, e.root.near, r->to[i]);
    }
}

/* The answers. */
SGT_INLINE void beside_told(const wavy *self, const convex *bent, int terms, lane_wish wish,
                            const sgt_tile *tile, lane_to to, const beside_room *r)
{
    const sgt_rays rows = tile->rays;
    const double *t_tol = tile->t_tol;
    const wavy own = *self, *s = &own;
    const convex mine = *bent, *b = &mine;
    size_t count = tile->n;
    LANES for (size_t i = 0; i < count; i++)
    {
        const sgt_ray ray = lane_ray_of(&rows, i);
        const side_local q = {r->x[i], r->y[i], r->z[i], 0};
        const side_found found = {r->t0[i], r->r2[i], r->inverse[i], r->above[i], r->below[i]};
        const wavy_round at = {.tau = r->tau[i], .tau_err = r->tau2[i], .v = r->from[i], .near = r->to[i]};
        lane e = side_lane(s, b, terms, &q, &found, &at, &ray, t_tol[i]);
        LANE_STORE(to, i, e, wish);
    }
}

#define BESIDE_WAYS(name, terms)                                                     \
    SGT_KERNEL static void name(const wavy *s, const sgt_tile *tile, beside_room *r) \
    {                                                                                \
        beside_ways(s, terms, tile, r);                                              \
    }
#define BESIDE_SEEDS(name, terms, first)                                                  \
    SGT_KERNEL static beside_said name(const wavy *s, const convex *b, const sgt_tile *tile, \
                                       beside_room *r)                                    \
    {                                                                                     \
        return beside_seeds(s, b, terms, first, tile, r);                                 \
    }
#define BESIDE_STEP(name, terms, turned)                                                              \
    SGT_KERNEL static mask name(const wavy *s, const convex *b, const sgt_tile *tile, beside_room *r) \
    {                                                                                                 \
        return beside_step(s, b, terms, turned, tile, r);                                             \
    }
#define BESIDE_ENDS(name, terms)                                                     \
    SGT_KERNEL static mask name(const wavy *s, const sgt_tile *tile, beside_room *r) \
    {                                                                                \
        return beside_ends(s, terms, tile, r);                                       \
    }
#define BESIDE_SHARP(name, terms)                                                                     \
    SGT_KERNEL static void name(const wavy *s, const convex *b, const sgt_tile *tile, beside_room *r) \
    {                                                                                                 \
        beside_sharp(s, b, terms, tile, r);                                                           \
    }
#define BESIDE_TOLD(name, terms, wish)                                                            \
    SGT_KERNEL static void name(const wavy *s, const convex *b, const sgt_tile *tile, lane_to to, \
                                const beside_room *r)                                             \
    {                                                                                             \
        beside_told(s, b, terms, wish, tile, to, r);                                              \
    }

BESIDE_WAYS(asphere_beside_few_ways, FEW_TERMS)
BESIDE_WAYS(asphere_beside_ways, ALL_TERMS)
BESIDE_SEEDS(asphere_beside_few_first, FEW_TERMS, true)
BESIDE_SEEDS(asphere_beside_few_near, FEW_TERMS, false)
BESIDE_SEEDS(asphere_beside_first, ALL_TERMS, true)
BESIDE_SEEDS(asphere_beside_near, ALL_TERMS, false)
BESIDE_STEP(asphere_beside_few_turned, FEW_TERMS, true)
BESIDE_STEP(asphere_beside_turned, ALL_TERMS, true)
BESIDE_STEP(asphere_beside_few_step, FEW_TERMS, false)
BESIDE_STEP(asphere_beside_step, ALL_TERMS, false)
BESIDE_ENDS(asphere_beside_few_ends, FEW_TERMS)
BESIDE_ENDS(asphere_beside_ends, ALL_TERMS)
BESIDE_SHARP(asphere_beside_few_sharp, FEW_TERMS)
BESIDE_SHARP(asphere_beside_sharp, ALL_TERMS)
BESIDE_TOLD(asphere_beside_few_told, FEW_TERMS, LANE_PLAIN)
BESIDE_TOLD(asphere_beside_few_told_rich, FEW_TERMS, LANE_RICH)
BESIDE_TOLD(asphere_beside_told, ALL_TERMS, LANE_RICH)

/* Statuses.  Returns how many rays are left. */
SGT_KERNEL
static size_t beside_status(size_t n, const mask *hit, const mask *away, sgt_status *restrict status)
{
    mask hard = 0;
    _Pragma("omp simd reduction(+ : hard)") for (size_t i = 0; i < n; i++)
    {
        mask met = hit[i], gone = away[i] & ~met;
        status[i] = (signed char)((int)(met & (SGT_HIT - SGT_HARD)) + (int)(gone & (SGT_MISS - SGT_HARD)) +
                                  SGT_HARD);
        hard -= ~(met | gone);
    }
    return (size_t)hard;
}

/* The surface, and what is asked for. */
typedef struct beside {
    const wavy *s;
    const convex *b;
    bool few, first; /* few terms; the first root */
} beside;

/* From the seeds to the answers. */
SGT_NOINLINE static void beside_roots(const beside *of, lane_wish wish, const sgt_tile *tile, lane_to to,
                                      beside_room *r)
{
    const wavy *s = of->s;
    const convex *b = of->b;
    const bool few = of->few, counts = tile->hits.evals;
    const size_t n = tile->n;
    mask again = MASK(true);
    for (int k = 0; k < SIDE_STEPS && again; k++) {
        for (size_t i = 0; counts && i < n; i++) r->steps[i] += r->again[i] != 0;
        if (k == 0)
            again = (few ? asphere_beside_few_turned : asphere_beside_turned)(s, b, tile, r);
        else
            again = (few ? asphere_beside_few_step : asphere_beside_step)(s, b, tile, r);
    }
    mask blunt = (few ? asphere_beside_few_ends : asphere_beside_ends)(s, tile, r);
    for (size_t i = 0; blunt && counts && i < n; i++) r->steps[i] += r->again[i] != 0;
    if (blunt) (few ? asphere_beside_few_sharp : asphere_beside_sharp)(s, b, tile, r);
    (!few                ? asphere_beside_told
     : wish >= LANE_FINE ? asphere_beside_few_told_rich
                         : asphere_beside_few_told)(s, b, tile, to, r);
}

/* Answers a tile of which all rays are hard.  begun: as in an easy_tried; a ray without a start for the
 * rounds of easy.h has taken one evaluation there.  Returns how many are left. */
SGT_NOINLINE static size_t beside_all(const beside *of, lane_wish wish, const sgt_tile *tile,
                                      const bool *begun, lane_to to, beside_room *r)
{
    const wavy *s = of->s;
    const convex *b = of->b;
    const bool few = of->few, first = of->first;
    const sgt_hits *hits = &tile->hits;
    const size_t n = tile->n;
    if (hits->evals) memset(r->steps, 0, n * sizeof *r->steps);
    bool left = asphere_beside_stretch(b, tile, r) != 0;
    if (left && r->afar) (few ? asphere_beside_few_ways : asphere_beside_ways)(s, tile, r);
    static const mask none[SIDE_TILE];
    r->rises = r->falls = none;
    if (!left) {
        memset(r->on, 0, n * sizeof *r->on), memset(r->above, 0, n * sizeof *r->above);
        memset(r->below, 0, n * sizeof *r->below);
    }
    for (int k = 0; k < 2 && left; k++) {
        const beside_said some =
            few ? (first ? asphere_beside_few_first : asphere_beside_few_near)(s, b, tile, r)
                : (first ? asphere_beside_first : asphere_beside_near)(s, b, tile, r);
        if (k == 0) memcpy(r->on, r->close, n * sizeof *r->on);
        if (k > 0 || !some.close || !asphere_beside_on(s, b, tile, r)) {
            left = some.any != 0;
            break;
        }
        r->rises = r->starts[0], r->falls = r->starts[1];
    }
    if (!left) memset(r->ends.hit, 0, n * sizeof *r->ends.hit);
    if (left) beside_roots(of, wish, tile, to, r);
    for (size_t i = 0; hits->evals && i < n; i++) { /* of a hit and of a hard ray with that of F at the end */
        int evals = (begun[i] ? hits->evals[i] : 2) + (r->asked[i] ? 2 : 0) + (r->on[i] ? 1 : 0) -
                    (r->away[i] ? 1 : 0);
        if (r->above[i] | r->below[i]) evals += r->steps[i] + 1;
        hits->evals[i] = evals;
    }
    return beside_status(n, r->ends.hit, r->away, hits->status);
}

/* ------------------------------------------------------------------- rays that graze */

/* What the loops of graze.h leave for each other.  t: the guesses.  t2: where the steps have come to, then T.
 * The rest is a graze_root.  steps: evaluations. */
typedef struct graze_room {
    _Alignas(64) double t[SIDE_TILE];
    double t2[SIDE_TILE], x[SIDE_TILE], y[SIDE_TILE], z[SIDE_TILE], inverse[SIDE_TILE], tau[SIDE_TILE],
        tau_err[SIDE_TILE], v[SIDE_TILE], near[SIDE_TILE];
    mask again[SIDE_TILE];
    int steps[SIDE_TILE];
    lane_ends ends;
} graze_room;

/* graze_seed_of for all rays.  asked[i]: it is to be tried from t[i]; if not, t[i] is NaN.  Returns all bits
 * set if all of them graze by graze_bent, asked or not. */
SGT_INLINE mask lane_seeds(const wavy *self, const convex *bent, int terms, const sgt_tile *tile,
                           double *restrict t, mask *restrict asked)
{
    const sgt_rays rows = tile->rays;
    const wavy own = *self, *s = &own;
    const convex mine = *bent, *b = &mine;
    size_t count = tile->n;
    mask all = MASK(true);
    _Pragma("omp simd reduction(& : all)") for (size_t i = 0; i < count; i++)
    {
        const sgt_ray ray = lane_ray_of(&rows, i);
        const graze_seed one = graze_seed_of(s, b, terms, &ray);
        const double far = fabs(ray.o.x) + fabs(ray.o.y) + fabs(ray.o.z),
                     d2 = (ray.d.x * ray.d.x + ray.d.y * ray.d.y) + ray.d.z * ray.d.z;
        const mask is = one.asked & usual_length(d2) & MASK(far < HUGE_VAL);
        t[i] = chosen(is, one.t, (double)NAN), asked[i] = is;
        all &= one.grazes;
    }
    return all;
}

SGT_KERNEL
static mask asphere_few_seeds(const wavy *s, const convex *b, const sgt_tile *tile, double *t, mask *asked)
{
    return lane_seeds(s, b, FEW_TERMS, tile, t, asked);
}
SGT_KERNEL
static mask asphere_all_seeds(const wavy *s, const convex *b, const sgt_tile *tile, double *t, mask *asked)
{
    return lane_seeds(s, b, ALL_TERMS, tile, t, asked);
}

static mask graze_seeds(const wavy *s, const convex *b, bool few, const sgt_tile *tile, double *t,
                        mask *asked)
{
    return (few ? asphere_few_seeds : asphere_all_seeds)(s, b, tile, t, asked);
}

/* Do all rays of a tile graze in one way or the other? */
SGT_KERNEL
static mask asphere_all_graze(const wavy *self, const convex *bent, const sgt_tile *tile)
{
    const sgt_rays rows = tile->rays;
    const wavy own = *self, *s = &own;
    const convex mine = *bent, *b = &mine;
    size_t count = tile->n;
    mask all = MASK(true);
    _Pragma("omp simd reduction(& : all)") for (size_t i = 0; i < count; i++)
    {
        const sgt_ray ray = lane_ray_of(&rows, i);
        all &= grazes(s, b, ALL_TERMS, &ray);
    }
    return all;
}

bool sgt_asphere_lanes_graze(const wavy *s, const convex *b, int terms, const sgt_tile *tile,
                             easy_tried *tried)
{
    sgt_tile one = *tile;
    one.n = 1;
    if (!asphere_all_graze(s, b, &one)) return false;
    return graze_seeds(s, b, terms <= FEW_TERMS, tile, tried->t, tried->asked) ||
           asphere_all_graze(s, b, tile);
}

/* graze_begin, or graze_next of the rays that are not ready.  Returns all bits set if some are not yet. */
SGT_INLINE mask lane_graze(const wavy *self, const convex *bent, int terms, bool begin, const sgt_tile *tile,
                           const double *t, graze_room *r)
{
    const sgt_rays rows = tile->rays;
    const wavy own = *self, *s = &own;
    const convex mine = *bent, *b = &mine;
    size_t count = tile->n;
    mask any = 0;
    _Pragma("omp simd reduction(| : any)") for (size_t i = 0; i < count; i++)
    {
        const sgt_ray ray = lane_ray_of(&rows, i);
        const wavy_newton h =
            begin ? graze_begin(s, b, terms, t[i], &ray) : graze_next(s, terms, r->t2[i], &ray);
        mask again = ~graze_ready(s, b, &h, &ray);
        if (begin) {
            again &= MASK(t[i] == t[i]);
            r->t2[i] = h.tau2;
        } else {
            const mask asked = r->again[i];
            r->t2[i] = chosen(asked, h.tau2, r->t2[i]), again &= asked;
        }
        r->again[i] = again;
        any |= again;
    }
    return any;
}

SGT_INLINE void lane_graze_roots(const wavy *self, int terms, const sgt_tile *tile, graze_room *r)
{
    const sgt_rays rows = tile->rays;
    const double *t_tol = tile->t_tol;
    const wavy own = *self, *s = &own;
    size_t count = tile->n;
    LANES for (size_t i = 0; i < count; i++)
    {
        const sgt_ray ray = lane_ray_of(&rows, i);
        const graze_root e = graze_root_at(s, terms, r->t2[i], &ray, t_tol[i]);
        r->x[i] = e.q.x, r->y[i] = e.q.y, r->z[i] = e.q.z, r->inverse[i] = e.inverse;
        r->tau[i] = e.root.tau, r->tau_err[i] = e.root.tau_err, r->v[i] = e.root.v, r->near[i] = e.root.near;
    }
}

SGT_INLINE mask lane_graze_told(const wavy *self, const convex *bent, int terms, lane_wish wish,
                                const sgt_tile *tile, lane_to to, const mask *asked, const graze_room *r)
{
    const sgt_rays rows = tile->rays;
    const double *t_tol = tile->t_tol;
    const wavy own = *self, *s = &own;
    const convex mine = *bent, *b = &mine;
    size_t count = tile->n;
    mask all = MASK(true);
    _Pragma("omp simd reduction(& : all)") for (size_t i = 0; i < count; i++)
    {
        const sgt_ray ray = lane_ray_of(&rows, i);
        const side_local q = {r->x[i], r->y[i], r->z[i], 0};
        const wavy_round at = {.tau = r->tau[i], .tau_err = r->tau_err[i], .v = r->v[i], .near = r->near[i]};
        lane e = graze_lane(s, b, terms, &q, r->t2[i], r->inverse[i], &at, &ray, t_tol[i]);
        e.hit &= asked[i];
        LANE_STORE(to, i, e, wish);
        all &= e.hit;
    }
    return all;
}

#define GRAZE_STEP(name, terms, begin)                                                         \
    SGT_KERNEL static mask name(const wavy *s, const convex *b, const sgt_tile *tile, const double *t, \
                                graze_room *r)                                                 \
    {                                                                                          \
        return lane_graze(s, b, terms, begin, tile, t, r);                                     \
    }
#define GRAZE_ROOTS(name, terms)                                                    \
    SGT_KERNEL static void name(const wavy *s, const sgt_tile *tile, graze_room *r) \
    {                                                                               \
        lane_graze_roots(s, terms, tile, r);                                        \
    }
#define GRAZE_TOLD(name, terms, wish)                                                               \
    SGT_KERNEL static mask name(const wavy *s, const convex *b, const sgt_tile *tile, lane_to to,   \
                                const mask *asked, const graze_room *r)                             \
    {                                                                                               \
        return lane_graze_told(s, b, terms, wish, tile, to, asked, r);                              \
    }

GRAZE_STEP(asphere_graze_few_begin, FEW_TERMS, true)
GRAZE_STEP(asphere_graze_begin, ALL_TERMS, true)
GRAZE_STEP(asphere_graze_few_next, FEW_TERMS, false)
GRAZE_STEP(asphere_graze_next, ALL_TERMS, false)
GRAZE_ROOTS(asphere_graze_few_roots, FEW_TERMS)
GRAZE_ROOTS(asphere_graze_roots, ALL_TERMS)
GRAZE_TOLD(asphere_graze_few_told, FEW_TERMS, LANE_PLAIN)
GRAZE_TOLD(asphere_graze_few_told_rich, FEW_TERMS, LANE_RICH)
GRAZE_TOLD(asphere_graze_told, ALL_TERMS, LANE_RICH)

/* Answers rays by graze.h: t, asked as in an easy_tried.  Returns how many are left; those are hard.  Of a
 * ray that was asked in vain `begun` is set, and evals counts what that took. */
SGT_NOINLINE static size_t graze_all(const beside *of, lane_wish wish, const sgt_tile *tile, bool *begun,
                                     const double *t, const mask *asked, lane_to to, graze_room *r)
{
    const wavy *s = of->s;
    const convex *b = of->b;
    const bool few = of->few;
    const size_t n = tile->n;
    const sgt_hits *hits = &tile->hits;
    mask again = (few ? asphere_graze_few_begin : asphere_graze_begin)(s, b, tile, t, r);
    for (size_t i = 0; hits->evals && i < n; i++) r->steps[i] = 2;
    for (int k = 2; k < GRAZE_STEPS && again; k++) {
        for (size_t i = 0; hits->evals && i < n; i++) r->steps[i] += r->again[i] != 0;
        again = (few ? asphere_graze_few_next : asphere_graze_next)(s, b, tile, t, r);
    }
    (few ? asphere_graze_few_roots : asphere_graze_roots)(s, tile, r);
    const mask all = (!few               ? asphere_graze_told
                      : wish >= LANE_FINE ? asphere_graze_few_told_rich
                                          : asphere_graze_few_told)(s, b, tile, to, asked, r);
    for (size_t i = 0; hits->evals && i < n; i++)
        if (asked[i]) hits->evals[i] = r->steps[i] + 3;
    if (all) {
        memset(hits->status, SGT_HIT, n);
        return 0;
    }
    size_t hard = 0;
    for (size_t i = 0; i < n; i++) {
        const bool hit = to.hit[i] != 0;
        hits->status[i] = hit ? SGT_HIT : SGT_HARD, hard += !hit;
        if (!hit && asked[i]) begun[i] = true;
    }
    return hard;
}

/* The same of rays that have not been asked.  Some may not graze. */
SGT_NOINLINE static size_t graze_some(const beside *of, const sgt_tile *tile, bool *begun, lane_to to)
{
    graze_room r;
    double t[SIDE_TILE];
    mask asked[SIDE_TILE], any = 0;
    graze_seeds(of->s, of->b, of->few, tile, t, asked);
    for (size_t i = 0; i < tile->n; i++) any |= asked[i];
    if (any) return graze_all(of, LANE_RICH, tile, begun, t, asked, to, &r);
    memset(tile->hits.status, SGT_HARD, tile->n);
    return tile->n;
}

/* A tile of which all rays graze.  Returns how many are left. */
SGT_NOINLINE static size_t graze_tile(const beside *of, const sgt_tile *tile, easy_tried *tried)
{
    graze_room r;
    size_t hard = 0;
    for (size_t i = 0, n; i < tile->n; i += n) {
        n = tile->n - i < SIDE_TILE ? tile->n - i : SIDE_TILE;
        const sgt_tile part = tile_part(tile, i, n);
        hard += graze_all(of, lane_wish_of(&part), &part, tried->begun + i, tried->t + i, tried->asked + i,
                          lane_to_of(&part, &r.ends), &r);
    }
    return hard;
}

/* The same for the hard rays of a tile alone: they are put side by side.  grazing: by graze.h, those that
 * graze; else from the side. */
SGT_NOINLINE static size_t beside_few(const beside *of, bool grazing, const sgt_tile *tile, bool *begun,
                                      beside_room *r)
{
    double ray[9][SIDE_TILE], (*out)[SIDE_TILE] = r->of;
    int evals[SIDE_TILE];
    sgt_status status[SIDE_TILE];
    bool own[SIDE_TILE];
    unsigned char number[SIDE_TILE];
    const sgt_rays *all = &tile->rays;
    const sgt_hits *hits = &tile->hits;
    const double *const from[9] = {all->o[0], all->o[1], all->o[2],  all->d[0],   all->d[1],
                                   all->d[2], all->tmin, all->tmax, tile->t_tol};
    const lane_to to = {out[0], out[1], out[2], out[3], out[4],     out[5],
                        out[6], out[7], out[8], out[9], r->ends.hit};
    size_t hard = 0;
    for (size_t i = 0; i < tile->n;) {
        size_t n = 0;
        for (; i < tile->n && n < SIDE_TILE; i++)
            if (hits->status[i] == SGT_HARD) number[n++] = (unsigned char)i;
        for (int k = 0; k < 9; k++)
            for (size_t j = 0; j < n; j++) ray[k][j] = from[k][number[j]];
        for (size_t j = 0; j < n; j++) own[j] = begun[number[j]];
        for (size_t j = 0; hits->evals && j < n; j++) evals[j] = hits->evals[number[j]];
        const sgt_tile few = {.n = n,
                              .rays = {.o = {ray[0], ray[1], ray[2]},
                                       .d = {ray[3], ray[4], ray[5]},
                                       .tmin = ray[6],
                                       .tmax = ray[7]},
                              .t_tol = ray[8],
                              .hits = {.status = status, .evals = hits->evals ? evals : NULL}};
        hard += grazing ? graze_some(of, &few, own, to) : beside_all(of, LANE_RICH, &few, own, to, r);
        for (size_t j = 0; j < n; j++) {
            size_t k = number[j];
            hits->status[k] = status[j], begun[k] = own[j];
            if (hits->evals) hits->evals[k] = evals[j];
            if (status[j] != SGT_HIT) continue;
            sgt_hit one = hit_of_lane(&(lane){to.t[j], to.t_err[j], to.t_lo[j], to.px[j], to.py[j], to.pz[j],
                                              to.nx[j], to.ny[j], to.p_err[j], to.hit[j]},
                                      hits->evals ? evals[j] : 0, 0);
            put_hit(hits, k, &one);
        }
    }
    return hard;
}

/* Answers hard rays of a tile. */
size_t sgt_asphere_lanes_beside(const wavy *s, const shape *h, const convex *b, bool first,
                                const sgt_tile *tile, size_t before, easy_tried *tried)
{
    beside_room r;
    const beside of = {s, b, h->terms <= FEW_TERMS, first};
    size_t hard = 0;
    if (tried->some)
        before = tried->all ? graze_tile(&of, tile, tried) : beside_few(&of, true, tile, tried->begun, &r);
    if (before == 0) return 0;
    if (before < tile->n) return beside_few(&of, false, tile, tried->begun, &r);
    for (size_t i = 0, n; i < tile->n; i += n) {
        n = tile->n - i < SIDE_TILE ? tile->n - i : SIDE_TILE;
        const sgt_tile part = tile_part(tile, i, n);
        hard += beside_all(&of, lane_wish_of(&part), &part, tried->begun + i, lane_to_of(&part, &r.ends), &r);
    }
    return hard;
}

/* ------------------------------------------------------------------- leaving a bowl */

/* LEAVING A BOWL.  Let S be bent in one way as far as it goes, up to r = R, and let a ray start on it, at a
 * root that is the only one near it and is not accepted (FROM ON IT).  sigma F is concave along the ray as
 * long as r <= R, which is one stretch.  So
 *     if it falls at the start,    it falls on, and the ray misses;
 *     if it rises,                 it is > 0 behind the start, and has one zero at most;
 *     and if it is > 0 at the end, it has none: the ray misses.
 *
 * THE END is where r^2 = R^2.  z is taken at D, where r^2 = E with E = R^2 (1 + 2^-20): with a = l^2 + m^2
 * and b = x l + y m at the start, D a = sqrt(d) - b, d = b^2 + a (E - r^2).  The end is before it by
 *     (sqrt(d) - sqrt(d - a (E - R^2))) / a <= (E - R^2) / sqrt(d).
 * So sigma z there is at least sigma z(D) - |n| (E - R^2) / sqrt(d), and if that is above the highest of S,
 * sigma F is above 0.  As r^2 <= R^2 as computed, E - r^2 is known to 2^-30 of itself, and d and its root as
 * well; the sum of z by 2^-40 of its terms. */
SGT_KERNEL
static void asphere_past_rim(const convex *b, const sgt_tile *tile, mask misses[], const double behind[])
{
    const sgt_rays rows = tile->rays;
    const double sign = b->sign, most = (sign > 0 ? b->high : b->low) * (1 + 0x1p-30), edge2 = b->edge2;
    size_t count = tile->n;
    LANES for (size_t i = 0; i < count; i++)
    {
        const sgt_ray ray = lane_ray_of(&rows, i);
        const double x = ray.o.x, y = ray.o.y, z = ray.o.z, l = ray.d.x, m = ray.d.y, n = ray.d.z;
        double a = l * l + m * m, along = x * l + y * m, d = along * along + a * (edge2 - (x * x + y * y)),
               root = sqrt(d), up = sign * (z * a + n * (root - along)) - most * a,
               unsure = 0x1p-30 * (fabs(z) * a + fabs(n) * (root + fabs(along))),
               rises = sign * behind[i];
        mask past = MASK((up - unsure) * root > 0x1p-19 * (fabs(n) * (a * edge2)));
        misses[i] |= MASK(rises < 0) | (MASK(rises > 0) & past);
    }
}

void sgt_asphere_past_rim(const convex *b, const sgt_tile *tile, mask misses[], const double behind[])
{
    asphere_past_rim(b, tile, misses, behind);
}

/* log2 x + 1023, off by less than 0.09, of a positive number; of 0 it is 0. */
SGT_INLINE double left_log(double x)
{
    unsigned long long bits;
    memcpy(&bits, &x, sizeof bits);
    bits = bits >> 32 | 0x4330000000000000ull; /* 2^52 + the upper half */
    memcpy(&x, &bits, sizeof bits);
    return (x - 0x1p52) * 0x1p-20;
}

/* 2^(y - 1023) to a tenth; y is made one of 1 to 2046. */
SGT_INLINE double left_power(double y)
{
    unsigned long long bits;
    y = larger(smaller(y, 2046), 1) * 0x1p20 + 0x1p52;
    memcpy(&bits, &y, sizeof bits);
    bits <<= 32;
    memcpy(&y, &bits, sizeof y);
    return y;
}

/* A step of Newton on z - P - c r^2 / 2, whose root is not before that of F, if that falls. */
SGT_INLINE double left_nearer(const wavy *s, int terms, double sign, const sgt_ray *ray, double tau)
{
    const double l = ray->d.x, m = ray->d.y, n = ray->d.z;
    double x = sgt_fma(tau, l, ray->o.x), y = sgt_fma(tau, m, ray->o.y), z = sgt_fma(tau, n, ray->o.z),
           rho = x * x + y * y, dh, h = horner_slope(s->a, terms, rho, &dh) + 0.5 * s->c,
           f = sgt_fma(-rho, h, z), slope = sgt_fma(-2 * sgt_fma(rho, dh, h), x * l + y * m, n);
    return chosen(MASK(sign * f < 0) & MASK(sign * slope < 0), tau - f / slope, tau);
}

/* THE ROOT is looked for from the start as the local origin, with t0 = 0.  The guess is beyond it, mostly:
 * from there Newton's steps on a concave function lead to the root.  It is the lesser of
 *     D,
 *     the other root of the conic of curvature c + 2 a[0], if it is on this sheet.
 * Where the powers outgrow the base (tall), it may also be, for each i, where the ray has the r of its start
 * again, and from there on s farther, with
 *     |a[i]| (a s^2)^(i + 1) = |n| s if sigma n > 0, else s = 0,
 * and left_nearer makes it better. */
SGT_INLINE void left_seeds(const wavy *s, const convex *b, int terms, bool tall, const sgt_tile *tile,
                           beside_room *r)
{
    const sgt_rays rows = tile->rays;
    const double edge2 = b->edge2, bowl = b->bowl, ck = s->ck, sign = b->sign;
    const wavy own = *s;
    const size_t count = tile->n;
    double log_a[ALL_TERMS];
    for (int i = 0; tall && i < terms; i++) log_a[i] = left_log(larger(sign * s->a[i], 0));
    LANES for (size_t i = 0; i < count; i++)
    {
        const sgt_ray ray = lane_ray_of(&rows, i);
        const double x = ray.o.x, y = ray.o.y, z = ray.o.z, l = ray.d.x, m = ray.d.y, n = ray.d.z;
        double a = l * l + m * m, along = x * l + y * m, rho = x * x + y * y, by = 1 / a,
               to = (sqrt(along * along + a * (edge2 - rho)) - along) * by,
               A = sgt_fma(bowl, a, ck * (n * n)), B = n - sgt_fma(bowl, along, ck * (z * n)),
               tau = 2 * B / A;
        mask conic = MASK(tau > 0) & MASK(ck * sgt_fma(tau, n, z) < 1);
        if (tall) {
            double log_n = left_log(larger(sign * n, 0)), log_side = left_log(a) - 1023, far = 2046;
            UNROLLED
            for (int k = 0; k < terms; k++)
                far = smaller(far, (log_n - log_a[k] - (k + 1) * log_side) * (1.0 / (2 * k + 1)) + 1023);
            far = smaller(sgt_fma(1.05, left_power(far), -2 * smaller(along, 0) * by), to);
            tau = chosen(conic & MASK(tau < far), tau, far);
            tau = left_nearer(&own, terms, sign, &ray, tau), tau = left_nearer(&own, terms, sign, &ray, tau);
        } else
            tau = chosen(conic & MASK(tau < to), tau, to);
        r->tau2[i] = tau;
        r->x[i] = x, r->y[i] = y, r->z[i] = z, r->rho0[i] = rho, r->t0[i] = 0;
        r->r2[i] = rho * (1 + 0x1p-10);
        r->above[i] = r->again[i] = MASK(true), r->below[i] = 0;
    }
}

#define LEFT_SEEDS(name, terms, tall)                                                                 \
    SGT_KERNEL static void name(const wavy *s, const convex *b, const sgt_tile *tile, beside_room *r) \
    {                                                                                                 \
        left_seeds(s, b, terms, tall, tile, r);                                                       \
    }
LEFT_SEEDS(asphere_left_seeds, FEW_TERMS, false)
LEFT_SEEDS(asphere_left_few_tall, FEW_TERMS, true)
LEFT_SEEDS(asphere_left_all_tall, ALL_TERMS, true)

/* Do the powers outgrow the base, or is there no end? */
static bool left_is_tall(const wavy *s, const convex *b)
{
    const double high = b->sign > 0 ? b->high : b->low;
    return !(high < HUGE_VAL && high <= 4 * (s->abs_c * b->edge2));
}

/* The answers of rays that are not met, with z computed anew (ANEW in side.h). */
SGT_KERNEL
static void asphere_left_anew(const wavy *self, const convex *bent, const sgt_tile *tile, lane_to to,
                              const beside_room *r)
{
    const sgt_rays rows = tile->rays;
    const double *t_tol = tile->t_tol;
    const wavy own = *self, *s = &own;
    const convex mine = *bent, *b = &mine;
    size_t count = tile->n;
    LANES for (size_t i = 0; i < count; i++)
    {
        const sgt_ray ray = lane_ray_of(&rows, i);
        const side_local q = {r->x[i], r->y[i], r->z[i], 0};
        const side_found found = {r->t0[i], r->r2[i], r->inverse[i], r->above[i], r->below[i]};
        const wavy_round at = {.tau = r->tau[i], .tau_err = r->tau2[i], .v = r->from[i], .near = r->to[i]};
        lane e = side_lane_at(s, b, ALL_TERMS, true, &q, &found, &at, &ray, t_tol[i]);
        LANE_STORE_IF(to, i, e, e.hit & ~to.hit[i]);
    }
}

/* The rays that rise are put side by side. */
void sgt_asphere_left_bowl(const wavy *s, int terms, const convex *b, const sgt_tile *tile,
                           const mask misses[], const double behind[])
{
    static const double zero[SIDE_TILE];
    beside_room r;
    double ray[7][SIDE_TILE], (*out)[SIDE_TILE] = r.of;
    double unwanted[SGT_TILE], *give[10];
    unsigned char number[SGT_TILE];
    const beside of = {s, b, terms <= FEW_TERMS, true};
    const sgt_rays *all = &tile->rays;
    const sgt_hits *hits = &tile->hits;
    const lane_outputs rows = lane_outputs_of(hits);
    const double *x = all->o[0], *y = all->o[1], *z = all->o[2], *l = all->d[0], *m = all->d[1],
                 *n = all->d[2], *tmax = all->tmax;
    const lane_to to = {out[0], out[1], out[2], out[3], out[4],     out[5],
                        out[6], out[7], out[8], out[9], r.ends.hit};
    size_t left = 0;
    for (int k = 0; k < 10; k++) give[k] = rows.of[k] ? rows.of[k] : unwanted;
    for (size_t i = 0; i < tile->n; i++) {
        number[left] = (unsigned char)i;
        left += !misses[i] & (behind[i] != 0);
    }
    for (size_t from = 0, some; from < left; from += some) {
        const unsigned char *own = number + from;
        some = left - from < SIDE_TILE ? left - from : SIDE_TILE;
        for (size_t j = 0; j < some; j++) {
            const size_t i = own[j];
            ray[0][j] = x[i], ray[1][j] = y[i], ray[2][j] = z[i], ray[3][j] = l[i], ray[4][j] = m[i];
            ray[5][j] = n[i], ray[6][j] = tmax[i];
        }
        const sgt_tile few = {.n = some,
                              .rays = {.o = {ray[0], ray[1], ray[2]},
                                       .d = {ray[3], ray[4], ray[5]},
                                       .tmin = zero,
                                       .tmax = ray[6]},
                              .t_tol = zero,
                              .hits = {.evals = hits->evals}}; /* a flag: these are not its rows */
        if (hits->evals) memset(r.steps, 0, some * sizeof *r.steps);
        (!left_is_tall(s, b) ? asphere_left_seeds : of.few ? asphere_left_few_tall : asphere_left_all_tall)(
            s, b, &few, &r);
        beside_roots(&of, lane_wish_of(tile), &few, to, &r);
        mask every = MASK(true);
        for (size_t j = 0; j < some; j++) every &= r.ends.hit[j];
        if (!every) asphere_left_anew(s, b, &few, to, &r);
        for (size_t j = 0; hits->evals && j < some; j++) hits->evals[own[j]] = 3 + r.steps[j];
        for (size_t j = 0; j < some; j++) { /* of a ray that is not met: NaN */
            const size_t i = own[j];
            hits->status[i] = r.ends.hit[j] ? SGT_HIT : SGT_HARD;
            UNROLLED for (int k = 0; k < 10; k++) give[k][i] = out[k][j];
        }
    }
}
