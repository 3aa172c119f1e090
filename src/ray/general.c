// SPDX-License-Identifier: MIT
/* general.c - the search for a root on a ray, for any surface, without a proof.  It uses nothing but what
 * the surface's operations answer.
 *
 * THE RAY IS MADE LOCAL first.  The direction is scaled by a power of two.  The origin is moved, with
 * error-free products and sums, to one of these points: the surface's own guess, the middle of its span,
 * or the point of the ray nearest the origin of the surface's frame.  walk.c evaluates F from there.
 *
 * THE ORDER OF TRIALS.  search_along goes down this list until one of them has the answer:
 *
 *     wanted                       tried, if                      how
 *     1 the first root             the surface has `first`        as one root within `first`, if that is
 *                                                                 single; asked even if the span is single
 *     2 one root, span not single  a sag with extent_within and   as one root on the stretch where F is
 *                                  a seed (built in)              monotone (vicinity.h)
 *     3 the root near the seed,    there is a seed, or the span   the quick form (step.h), from the seed or
 *       or span.single             is single and has two ends     from the middle of the span
 *     4 the same                   always                         the solver of solve/root.c, in the span
 *     5 what is left               `enclose`, built in, or an     proof.c, which needs no ends
 *                                  end at infinity
 *     6                            `enclose`, two finite ends     enclosed.c
 *                                  (5 and 6: not dt_min > 0 and
 *                                  `estimate`, of a user's)
 *     7                            a finite near end, or the      a march, in steps
 *                                  root near the seed
 *                                  else                           nothing: UNPROVEN
 *
 * THE MARCH.  A step is as long as the longest of these:
 * - the clearance, if it is above dt_min: no root can be missed in it;
 * - dt_min, or its default (step sizes are in sagitta.h, sgt_intersect): a root can be missed;
 * - the estimate, if dt_min > 0 is given: a root can be missed.
 *
 * Two neighbouring points with unlike signs are a bracket.  Two with like signs, between which |F| first
 * falls and then rises, hold a minimum of |F|.  If the tangents at the two meet beyond zero, the minimum
 * is searched by bisecting the sign of the slope.  A change of sign found on the way is a bracket again.
 *
 * A feature thinner than a step, and not announced by the slopes, is not seen.  So a march with such steps
 * that finds nothing is UNPROVEN.
 *
 * A FAR END AT INFINITY.  A surface is written about the origin of its frame, and looked at from outside.
 * So equal steps go on until the ray is farther from that origin than its start is.  From there on each
 * step is half again as long as the last.  From a near end at infinity there is no first step. */
#include "general.h"

#include "../num/bits.h"
#include "../solve/ways.h"
#include "proof.h"
#include "walk.h"
#include "wings.h"

#include <sagitta/interval.h>

/* 1.5^128, to nearest: the 128 far steps grow by half each. */
static const double GROWN = 0x1.d59239a436969p+74;

/* |F| falls after a and rises before b.  Is there a change of sign between?  If so, *m is set to a point of
 * the other sign, or of no certain sign. */
static bool dips(walk *w, point a, point b, point *m)
{
    int sign = sign_at(&a);
    for (int i = 0; i < 60 && !over(w); i++) {
        if (!dip_of(mark_of(&a), mark_of(&b))) return false;
        *m = sgt_walk_look(w, (i & 1) ? 0.5 * (a.tau + b.tau) : tangents_meet(mark_of(&a), mark_of(&b)),
                           SGT_MARCH, a.tau, b.tau);
        if (isnan(m->g) || sign * m->g < 0 || !sign_at(m)) return !isnan(m->g);
        if (sign * m->at.slope < 0) a = *m;
        else b = *m;
    }
    return false;
}

/* Finds the roots between a and b, the ends of one step. */
static void search_step(walk *w, const point *a, const point *b)
{
    double past;
    point m, c = *a;
    if (sign_at(a) * sign_at(b) < 0) {
        sgt_walk_between(w, a, b, &past);
        if (!(past > a->tau && past < b->tau) || over(w)) return;
        c = sgt_walk_look(w, past, SGT_MARCH, past, b->tau); /* another root may follow in this step */
    }
    if (!dips(w, c, *b, &m)) return;
    if (sign_at(&m)) { /* two roots, one on each side of m */
        sgt_walk_between(w, &c, &m, &past);
        if (!over(w)) sgt_walk_between(w, &m, b, &past);
        return;
    }
    /* The ray touches, as far as can be told. */
    sgt_root r = sgt_walk_begin(w, (sgt_span){.lo = c.tau, .hi = b->tau, .seed = m.tau});
    if (sgt_walk_sign(w, &c)) sgt_root_tell(&r, c.tau, c.g);
    point at = m;
    sgt_walk_solve(w, &r, &at);
    sgt_walk_take(w, &r, at);
}

/* Marches from lo to hi by dt; each step is `growth` times the last.  A step is longer if the clearance or
 * the estimate allows it.  *reached is set to the start of the last step.  false: the search is over
 * before hi. */
static bool search_march(walk *w, double lo, double hi, double dt, double growth, double *reached)
{
    const sgt_surface_ops *ops = w->s.ops;
    WENT(WAY_STEPS);
    bool guess = w->told.opt->dt_min > 0 && ops->estimate;
    double length = sqrt(w->q.l * w->q.l + w->q.m * w->q.m + w->q.n * w->q.n), next = lo;
    double all = ops->clearance ? (double)NAN : HUGE_VAL;
    point a = sgt_walk_glance(w, lo, SGT_MARCH, lo, hi, all), b;
    for (long long i = 1; !over(w) && next < hi; i++, dt *= growth) {
        *reached = a.tau;
        double clear = ops->clearance ? ops->clearance(w->s.self, a.at.p) / length * (1 - 0x1p-40) : 0;
        double away = guess ? ops->estimate(w->s.self, a.at.p) / length : 0;
        next = growth > 1 || ops->clearance || guess ? a.tau + dt : lo + (double)i * dt;
        w->uncertain = w->uncertain || !(a.tau + clear >= next);
        if (away > dt && away < HUGE_VAL) next = larger(next, a.tau + away);
        if (clear > dt) next = larger(next, a.tau + clear);
        if (!(next < hi)) next = hi;
        if (!(next > a.tau)) { /* dt is below an ulp of lo: step to the next double */
            w->uncertain = true;
            if (!(dt > 0) || i > 1LL << 40) return false;
            next = sgt_next_above(a.tau);
            if (next > hi) return false;
        }
        b = sgt_walk_glance(w, next, SGT_MARCH, a.tau, hi, all);
        /* b is on a root: take it from just before */
        if (!sign_at(&b) && !isnan(b.g) && next < hi)
            b = sgt_walk_look(w, next - 0.01 * (next - a.tau), SGT_MARCH, a.tau, hi);
        if (!sign_at(&a) && !isnan(a.g)) { /* the start is on the surface: begin just behind it */
            double off = smaller(8 * (fabs(a.g) + a.g_err) / fabs(a.at.slope), 0.25 * (next - a.tau));
            a = sgt_walk_look(w, a.tau + (off > 0 ? off : 0.25 * (next - a.tau)), SGT_MARCH, a.tau, hi);
        }
        if (!over(w)) search_step(w, &a, &b);
        a = b;
        next = b.tau;
    }
    return !over(w);
}

/* Marches over [lo, hi]; hi may be infinite.  nearest: the t0 nearest the origin of the surface's frame. */
static void steps(walk *w, double lo, double hi, double nearest)
{
    const sgt_options *opt = w->told.opt;
    const sgt_ray *ray = w->ray;
    double length = sqrt(w->q.l * w->q.l + w->q.m * w->q.m + w->q.n * w->q.n), reached = lo, from = lo;
    double end = hi;
    bool far = !isfinite(hi), more = true;
    int before = w->list->count;
    if (!isfinite(lo))
        lo = nearest - sqrt(ray->o.x * ray->o.x + ray->o.y * ray->o.y + ray->o.z * ray->o.z) / length -
             w->q.t0;
    if (far) end = far_end(ray->o, w->q.l, w->q.m, w->q.n, w->q.t0, nearest, lo);
    double dt = opt->dt_min > 0 ? opt->dt_min / w->q.scale
                                : (end - lo) * (w->s.ops->clearance ? 0x1p-20 : 1.0 / MARCH_STEPS);
    w->uncertain = far || lo != from;
    if (lo < end) more = search_march(w, lo, end, dt, 1, &reached);
    if (more && far) { /* far steps: the last is 1e22 times the first */
        double first = dt > 0 ? dt : 0x1p-20 / length, last = end + first * (GROWN - 1) / 0.5;
        if (last < HUGE_VAL) more = search_march(w, end, last, first, 1.5, &reached);
    }
    if (w->found) return;
    if (over(w)) sgt_walk_stretch(w, w->told.stopped ? SGT_STOPPED : SGT_EXHAUSTED, reached, hi);
    else if (w->list->count == before && w->told.evals && !w->defined)
        sgt_walk_stretch(w, SGT_UNDEFINED, from, hi);
    else if (w->list->count == before && w->uncertain) sgt_walk_stretch(w, SGT_UNPROVEN, from, hi);
}

/* The ray made local.  back: a root at the near end of the span is to be inside. */
static approach approach_by(const sgt_ray *ray, const sgt_span *span, bool back, bool early)
{
    return approach_of(ray->o, ray->d, (sgt_interval){ray->tmin, ray->tmax},
                       (sgt_interval){span->lo, span->hi}, span->seed, back ? 0x1p-50 : 0, true, early);
}

/* The quick form.  It is tried from the seed, or from the middle if the span is single and has two ends.
 * true: it has the answer, a hit that has been added, or a miss. */
static bool quickly(walk *w, const approach *a, bool single)
{
    walked root;
    if (!a->seeded && !(single && a->middle)) return false;
    if (sgt_walk_quick(w, (sgt_interval){a->lo, a->hi}, 0, DBL_MAX, -1, &root))
        return sgt_walk_take_quick(w, root.at, root.tau_err)
               || (single && (w->off || (w->least > 0 && sgt_walk_sharpen(w, root.at, a->lo, a->hi))));
    return single && sgt_walk_quick_miss(w, a->lo, a->hi);
}

/* The same within the span that `first` gives, if that is single. */
static bool first_of_several(walk *w)
{
    const sgt_ray *ray = w->ray;
    const sgt_surface_ops *ops = w->s.ops;
    const bool told_steep = is_catalogue(ops) && ops->own_->first;
    double steep = 0;
    sgt_span span = told_steep ? ops->own_->first(w->s.self, ray, &steep) : ops->first(w->s.self, ray);
    if (!span.single) return false;
    approach a = approach_by(ray, &span, w->s.ops->enclose || w->s.ops->clearance, false);
    if (a.passes) return true;
    w->q = a.q;
    w->lo = a.lo, w->hi = a.hi;
    w->t_tol = w->told.opt->t_tol / a.q.scale;
    w->margin = END_ERRORS, w->steep = steep;
    bool told = a.known && quickly(w, &a, true);
    w->margin = 0, w->steep = 0;
    return told;
}

/* The same for one root on the stretch of the ray where F is monotone (vicinity.h).  kept: what is known of
 * parts of the surface.  *clear: up to there no root is accepted. */
SGT_NOINLINE
static bool root_nearby_by(walk *w, const sgt_span *span, bool near, vicinities *kept, double *clear)
{
    const sgt_ray *ray = w->ray;
    const sgt_surface_ops *ops = w->s.ops;
    double seed = span->seed, asked = 1, lo = span->lo, hi = span->hi, least = 0, evals = w->told.evals,
           begun = evals, work[VICINITY_ROWS];
    if (!near && marches_chord(&w->shared)) seed = chord_seed(seed, lo, hi, ray->tmin, ray->tmax);
    const bool seedless = asks_ahead(&w->shared, near) && !marches_chord(&w->shared);
    if (!(fabs(seed) < HUGE_VAL) && !seedless) return false;
    const double whole = w->least;
    slopes_known within;
    slopes_begin(&within);
    vicinity v = {.tmin = &ray->tmin, .tmax = &ray->tmax, .seed = &seed,
                  .asked = &asked, .lo = &lo, .hi = &hi, .least = &least,
                  .noise = {&w->noise[0], &w->noise[1], &w->noise[2]},
                  .evals = &evals, .budget = w->told.budget, .begun = &begun, .told = &w->told,
                  .clear = clear};
    for (int i = 0; i < VICINITY_ROWS; i++) v.work[i] = &work[i];
    sgt_rays one = rays_of(ray);
    sgt_vicinity_of(w->s, 1, one, near ? &within : NULL, &w->shared, kept, &v);
    w->nearby = !(w->shared.noise[0] < HUGE_VAL);
    if (w->nearby) w->shared = bare_of(w->shared);
    if (asked != 0 || w->told.stopped) return false;
    if (lo > hi) return true; /* the ray misses the whole surface */
    sgt_span part = {.lo = lo, .hi = hi, .seed = seed};
    approach a = approach_by(ray, &part, ops->enclose, true);
    if (a.passes || !a.known || !a.seeded) return false;
    w->q = a.q;
    w->lo = a.lo, w->hi = a.hi, w->least = least;
    w->t_tol = w->told.opt->t_tol / a.q.scale;
    w->margin = END_ERRORS;
    bool told = quickly(w, &a, false);
    w->margin = 0, w->least = whole;
    return told;
}

/* The same where nothing is known.  A frame of its own: a caller that keeps what is known has no second
 * place for it. */
SGT_NOINLINE
static bool root_nearby_alone(walk *w, const sgt_span *span, bool near, double *clear)
{
    vicinities own;
    vicinities_begin(&own);
    return root_nearby_by(w, span, near, &own, clear);
}

/* kept: NULL if nothing is known. */
static bool root_nearby(walk *w, const sgt_span *span, bool near, vicinities *kept, double *clear)
{
    if (!is_catalogue(w->s.ops) || !w->s.ops->own_->extent_within) return false;
    return kept ? root_nearby_by(w, span, near, kept, clear) : root_nearby_alone(w, span, near, clear);
}

/* Replaces an infinite end by one 16 times as far from the point nearest the frame's origin as the ray's
 * start is from that origin.  Without this solve/root.c would sample among the floating-point numbers, and
 * the answer would depend on the unit of length.  What lies beyond is left to proof.c. */
static void cut_to_reach(const approach *a, const sgt_ray *ray, sgt_span *s)
{
    const sgt_vec3 o = ray->o;
    double away = 16 * sqrt(o.x * o.x + o.y * o.y + o.z * o.z) /
                  sqrt(a->q.l * a->q.l + a->q.m * a->q.m + a->q.n * a->q.n),
           nearest = a->nearest - a->q.t0;
    if (!(away < HUGE_VAL)) return;
    if (s->lo == -HUGE_VAL && nearest - away < s->hi) s->lo = nearest - away;
    if (s->hi == HUGE_VAL && nearest + away > s->lo) s->hi = nearest + away;
}

/* Steps 3 and 4.  true: they have the answer. */
static bool one_root(walk *w, const approach *a, const sgt_span *span, bool near)
{
    sgt_surface s = w->s;
    w->hidden.t = (double)NAN;
    if (quickly(w, a, span->single)) return true;
    bool hidden = span->single && is_catalogue(s.ops) && s.ops->enclose && !isnan(w->hidden.t) && !over(w);
    if (hidden && sgt_prove_found(s, w->ray, &w->told, w->hidden.t, w->hidden.t_lo, w->hidden.t_err, w->list))
        return true;
    if (over(w)) return false;
    double seed = a->seeded ? span->seed / a->q.scale - a->q.t0 : near ? a->nearest - a->q.t0 : (double)NAN;
    sgt_span cut = {.lo = a->lo, .hi = a->hi, .seed = seed, .single = span->single};
    if (s.ops->enclose) cut_to_reach(a, w->ray, &cut);
    bool whole = cut.lo == a->lo && cut.hi == a->hi;
    point at = {.tau = (double)NAN};
    sgt_root r = sgt_walk_begin(w, cut);
    sgt_walk_solve(w, &r, &at);
    /* proof.c knows over what length the ray touches */
    if (is_catalogue(s.ops) && r.status == SGT_GRAZE) r.status = SGT_UNPROVEN;
    return sgt_walk_take(w, &r, at) ||
           (span->single && ((whole && r.status == SGT_MISS) || (r.status > 0 && w->off)));
}

/* Adds the entries there are.  Returns the evaluations spent since the last entry.  kept: as in
 * root_nearby. */
typedef enum search_for { ONE_QUICKLY, ONE, EVERY } search_for;

static int search_along(sgt_surface s, const sgt_ray *ray, const sgt_options *opt, search_for what,
                        vicinities *kept, sgt_list *list)
{
    const bool all = what == EVERY;
    walk w;
    walk_begin(&w, s, ray, opt, list);
    w.all = all, w.rim2 = rim2_of_surface(s);
    bool near = opt->pick == SGT_NEAR_SEED && !all;
    if (is_catalogue(s.ops) && s.ops->own_->share) s.ops->own_->share(s.self, &w.shared);
    /* step 1 */
    if (!near && !all && s.ops->first && first_of_several(&w)) return w.told.evals - w.told.before;
    sgt_span span = {.lo = -HUGE_VAL, .hi = HUGE_VAL, .seed = (double)NAN};
    if (is_catalogue(s.ops) && s.ops->own_->span) span = s.ops->own_->span(s.self, &w.shared, ray, &w.least);
    else if (s.ops->span) span = s.ops->span(s.self, ray);
    /* step 2 */
    const bool low = span.single && !near && starts_low(ray->o, ray->tmin) && w.rim2 < HUGE_VAL &&
                     is_catalogue(s.ops) && s.ops->own_->extent_within && marches_chord(&w.shared),
               weak = low && starts_weakly(ray->o, ray->d, ray->tmin, w.least);
    if (low && w.least > 0 && !weak && !all && starts_at_root(ray->o, ray->d, ray->tmin, span.seed))
        span.seed = 0;
    double clear = -HUGE_VAL;
    if (!all && (!span.single || weak) && root_nearby(&w, &span, near, kept, &clear))
        return w.told.evals - w.told.before;
    approach a = approach_by(ray, &span, s.ops->enclose || s.ops->clearance,
                             span.single && is_catalogue(s.ops) && s.ops->own_->spans);
    if (a.passes) return w.told.evals - w.told.before;
    double lo = a.lo, hi = a.hi;
    w.q = a.q;
    w.lo = lo, w.hi = hi;
    w.t_tol = opt->t_tol / a.q.scale;
    w.from_tmin = a.from_tmin;
    if (!a.known) {
        sgt_walk_stretch(&w, SGT_UNPROVEN, -HUGE_VAL, HUGE_VAL);
        return 0;
    }

    bool jumps = is_catalogue(s.ops) && s.ops->own_->jumps && s.ops->own_->jumps(s.self);
    if ((span.single || near) && !jumps && !w.told.stopped && one_root(&w, &a, &span, near))
        return w.told.evals - w.told.before;
    const bool asks = !all && is_catalogue(s.ops) && asks_ahead(&w.shared, near) && !w.told.stopped;
    if (asks && sgt_nothing_ahead(s, ray)) return w.told.evals - w.told.before;
    /* steps 5, 6 and 7 */
    bool own = !is_catalogue(s.ops), guesses = own && opt->dt_min > 0 && s.ops->estimate;
    if (over(&w) || what == ONE_QUICKLY)
        sgt_walk_stretch(&w, w.told.stopped ? SGT_STOPPED : SGT_EXHAUSTED, lo, hi);
    else if (s.ops->enclose && !guesses && own && isfinite(lo) && isfinite(hi)) sgt_walk_enclosed(&w, lo, hi);
    else if (s.ops->enclose && !guesses) sgt_prove_rest(s, ray, &w.told, all, near, clear, list);
    else if (isfinite(lo) || near) steps(&w, lo, hi, a.nearest);
    else sgt_walk_stretch(&w, SGT_UNPROVEN, lo, hi);
    return w.told.evals - w.told.before;
}

static sgt_hit search_one(sgt_surface s, const sgt_ray *ray, const sgt_options *opt, search_for what,
                          vicinities *kept)
{
    sgt_list list = {.cap = 0, .count = 0};
    int evals = search_along(s, ray, opt, what, kept, &list);
    return first_entry(&list, ray, evals);
}

sgt_hit sgt_search_first(sgt_surface s, const sgt_ray *ray, const sgt_options *opt)
{
    return search_one(s, ray, opt, ONE, NULL);
}

sgt_hit sgt_search_first_kept(sgt_surface s, const sgt_ray *ray, const sgt_options *opt,
                              struct vicinities *kept)
{
    return search_one(s, ray, opt, ONE, kept);
}

sgt_hit sgt_search_quickly(sgt_surface s, const sgt_ray *ray, const sgt_options *opt, vicinities *kept)
{
    return search_one(s, ray, opt, ONE_QUICKLY, kept);
}

void sgt_search_all(sgt_surface s, const sgt_ray *ray, const sgt_options *opt, sgt_list *list)
{
    search_along(s, ray, opt, EVERY, NULL, list);
}
