// SPDX-License-Identifier: MIT
/* trace.c - a ray through a row of surfaces: place, meet, clip, bend, and on.
 *
 * trace.h has the arithmetic of the launch and of one element, and says where the ray is kept between two.
 * trace_batch.c has a loop around it.  This file has the choice of the root that is meant, and all that is
 * rare.
 *
 * NO LOOP HERE SEARCHES by itself: each asks sgt_intersect or sgt_intersect_all.  sgt_ask_inside asks from
 * both ends of the chord before it asks for every root, four questions at most.
 *
 * THE NORMAL is the gradient as the surface gives it, never normalised there.  Near the equator of a
 * sphere its components grow without bound.
 *
 *     its square is out of range     it is scaled by a power of two
 *     one component is infinite      it is a normal along that axis
 *     two are, or one is NaN, or     it names no direction.  The ray is SGT_LOST, with the reason
 *                                    SGT_UNDEFINED,
 *     all are zero                   unless the indices are equal: then no normal is needed */
#include "trace.h"

#include "../ray/unique.h"
#include "phase.h"

/* ------------------------------------------------------------------ launch */

SGT_INLINE bool is_finite(sgt_vec3 a) { return isfinite(a.x) && isfinite(a.y) && isfinite(a.z); }

/* Makes a direction in a turned frame of unit length.  false: it is zero, subnormal or not finite, as the
 * axes then are. */
SGT_INLINE bool make_unit(sgt_vec3 *d)
{
    double e = excess(*d);
    if (fabs(e) <= NEAR_UNIT) {
        *d = kept_unit(*d, e);
        return true;
    }
    if (!is_finite(*d) || !(largest(*d) >= DBL_MIN)) return false;
    sgt_vec3 v = times(scale_of(*d), *d);
    double length = sqrt(dot(v, v));
    v = (sgt_vec3){v.x / length, v.y / length, v.z / length};
    *d = corrected(v, excess(v));
    return true;
}

SGT_INLINE bool launch(const sgt_ray *ray, const sgt_element *first, double index, state *at)
{
    const sgt_pose nowhere = {.origin = ray->o}, *pose = first ? &first->pose : &nowhere;
    *at = (state){.base = pose->origin, .first = true, .index = index == 0 ? 1 : index};
    if (!is_finite(ray->o) || !is_finite(ray->d) || !(largest(ray->d) >= DBL_MIN)) return false;
    launched l = launch_from(ray->o, ray->d, pose->origin, is_turned(pose));
    sgt_vec3 q = minus(ray->o, pose->origin);
    bool near = is_finite(q) && isfinite(l.t0); /* else it is left where it is, for the surface to reject */
    at->d = l.d;
    at->offset = near ? l.offset : q;
    at->t0 = near ? l.t0 : 0;
    return true;
}

bool sgt_launch(const sgt_ray *ray, const sgt_element *first, double index, state *at)
{
    return launch(ray, first, index, at);
}

/* A watcher of the first element, which is told the t of the launch ray. */
typedef struct shifted { sgt_watch *watch; void *data; double t0; } shifted;

static int watch_shifted(void *data, const sgt_step *step)
{
    const shifted *s = data;
    sgt_step own = *step;
    own.t += s->t0, own.lo += s->t0, own.hi += s->t0;
    return s->watch(s->data, &own);
}

/* Makes the errors those of the ray as given (trace.h). */
SGT_INLINE void trace_widen(sgt_hit *hit, const state *at, const sgt_pose *pose, bool turned,
                            const sgt_ray *ray)
{
    const sgt_vec3 base = at->base, origin = pose->origin;
    const met_ray met = {at->offset, ray->o, ray->d, hit->n, hit->t};
    const bool before = at->turned;
    widening by;
    if (at->first)
        by = widening_by(aside_of(base, origin, turned, true, false), true, turned, was_moved(at->t0) ? 1 : 0,
                         met);
    else if (turned || before)
        by = widening_by(aside_of(base, origin, turned, false, before), false, true, 1, met);
    else
        by = widening_by(aside_of(base, origin, false, false, false), false, false, 1, met);
    hit->t_err += by.t, hit->p_err += by.p;
}

/* Makes the answer on the ray in the element's frame one on the ray as given; its errors only if they are
 * reported. */
SGT_INLINE void tell_of_given(sgt_hit *hit, const state *at, const sgt_pose *pose, bool turned,
                              const sgt_ray *ray, bool told)
{
    if (told) trace_widen(hit, at, pose, turned, ray);
    if (at->t0 != 0) {
        hit_place h = from_launch(at->t0, (hit_place){hit->t, hit->t_lo, hit->t_err});
        hit->t = h.t, hit->t_lo = h.t_lo, hit->t_err = h.t_err;
        hit->lo += at->t0, hit->hi += at->t0;
    }
    if (hit->status <= 0) return;
    sgt_interval about = sgt_about(hit->t, hit->t_err);
    if (about.lo < hit->lo) hit->lo = about.lo;
    if (about.hi > hit->hi) hit->hi = about.hi;
}

/* ------------------------------------------------------------------ meeting */

/* How many roots of a chord are looked at.  If there are more, it is UNPROVEN. */
enum { FEW = 4 };

/* The roots `beside` were met outside the aperture, one after the other, from the ends of the chord
 * inward.  On what is left no root was met.  But what is left begins at a root, and a root next to that is
 * taken for the start.  So all roots of the chord are asked for.  Is another one inside, or may one be?
 * The one nearest to the first that was met is meant. */
static sgt_hit ask_all(sgt_surface surface, const sgt_ray *chord, double aperture2, const sgt_options *opt,
                       const sgt_hit beside[], int besides, bool *inside)
{
    sgt_hit found[FEW], meant = beside[besides - 1];
    int count = sgt_intersect_all(surface, *chord, FEW, found, opt), evals = 0;
    double nearest = HUGE_VAL;
    bool any = false, stopped = false;
    for (int i = 0; i < count && i < FEW && !stopped; i++) {
        const sgt_hit *h = &found[i];
        bool again = false; /* already known to be outside */
        for (int j = 0; j < besides; j++)
            again = again || (h->status > 0 && h->lo <= beside[j].hi && h->hi >= beside[j].lo);
        double away = larger(h->lo - beside[0].t, beside[0].t - h->hi);
        stopped = h->status == SGT_STOPPED;
        if (stopped || (!again && !(h->status > 0 && !is_inside(h->p, aperture2)) && !(away >= nearest)))
            meant = *h, any = true, nearest = away;
        evals += h->evals;
    }
    if (count > FEW && !stopped) meant = hit_without(SGT_UNPROVEN, chord, 0), any = true;
    if (meant.status < 0) meant.t = meant.t_err = (double)NAN; /* as in a single answer */
    meant.evals = evals;
    *inside = any && meant.status > 0;
    return meant;
}

/* A graze may be longer than its t_err says (the ray lies in the surface as far as can be told).  It is
 * reported at its beginning.  Is another part of it inside? */
static bool reaches_inside(const sgt_ray *ray, const sgt_hit *hit, double aperture2)
{
    const sgt_vec3 o = ray->o, d = ray->d;
    if (hit->status != SGT_GRAZE || !(hit->hi - hit->lo > 4 * hit->t_err)) return false;
    double t = -(o.x * d.x + o.y * d.y) / (d.x * d.x + d.y * d.y);
    t = larger(hit->lo, t < hit->hi ? t : hit->hi);
    return is_inside((sgt_vec3){o.x + t * d.x, o.y + t * d.y, 0}, aperture2);
}

sgt_hit sgt_ask_inside(sgt_surface surface, sgt_ray chord, double aperture2, const sgt_options *opt,
                       bool *inside)
{
    enum { ENDS = 2 };
    const sgt_ray whole = chord;
    sgt_hit beside[ENDS], hit = sgt_intersect(surface, chord, opt);
    double middle = 0.5 * chord.tmin + 0.5 * chord.tmax;
    int besides = 0;
    *inside = hit.status > 0 && is_inside(hit.p, aperture2);
    while (hit.status > 0 && !*inside && besides < ENDS) {
        if (reaches_inside(&whole, &hit, aperture2))
            return hit_undecided(SGT_UNPROVEN, &whole, hit.evals, hit.lo, hit.hi);
        beside[besides++] = hit;
        if (hit.t < middle) chord.tmin = hit.hi; /* not t, from where the same root may be found again */
        else chord.tmax = hit.lo;
        if (!(chord.tmin < chord.tmax)) break;
        sgt_hit next = sgt_intersect(surface, chord, opt);
        next.evals += hit.evals;
        *inside = next.status > 0 && is_inside(next.p, aperture2);
        hit = next;
    }
    if (!besides || *inside || hit.status == SGT_STOPPED) return hit;
    int evals = hit.evals;
    hit = ask_all(surface, &whole, aperture2, opt, beside, besides, inside);
    hit.evals += evals;
    return hit;
}

/* Is it a root near the seed, as it was asked for, with no root nearer to the axis? */
static bool is_nearest(sgt_surface surface, const sgt_ray *ray, const sgt_options *opt, const sgt_hit *hit)
{
    unsigned long long none;
    sgt_extents kept = {.radius2 = {0}};
    double x = hit->p.x, y = hit->p.y;
    sgt_tile one = {.n = 1, .rays = rays_of(ray), .hits = {.p = {&x, &y, NULL}}};
    if (!is_near(hit->status, opt)) return false;
    sgt_none_nearer(surface, &one, &kept, &none);
    return none;
}

/* Chooses the hit that is meant.  *hit is the answer on the whole line; *inside is set if the choice is
 * within the clear aperture.  Only an answer that is, or may be, inside overrules the first one. */
static void trace_choose(sgt_surface surface, sgt_ray ray, double aperture2, const sgt_options *opt,
                         sgt_hit *hit, bool *inside)
{
    *inside = hit->status > 0 && is_inside(hit->p, aperture2);
    if (*inside || !(aperture2 < HUGE_VAL) || !is_worth_more(hit->status)) return;
    if (is_nearest(surface, &ray, opt, hit) || !cut_to_chord(&ray, aperture2)) return;
    sgt_hit other = sgt_ask_inside(surface, ray, aperture2, opt, inside);
    hit->evals = other.evals += hit->evals;
    if (*inside || may_be_inside(surface, opt, other.status)) *hit = other;
}

/* ------------------------------------------------------------------ bending */

/* Sets *q to a vector along n with components of at most 2, and one of at least 1 (2^-51 if n is
 * subnormal).  false: n names no direction. */
SGT_INLINE bool along_normal(sgt_vec3 n, sgt_vec3 *q)
{
    if (isnan(n.x) || isnan(n.y) || isnan(n.z)) return false;
    int infinite = !isfinite(n.x) + !isfinite(n.y) + !isfinite(n.z);
    if (infinite == 1) {
        *q = (sgt_vec3){!isfinite(n.x) ? copysign(1, n.x) : 0, !isfinite(n.y) ? copysign(1, n.y) : 0,
                        !isfinite(n.z) ? copysign(1, n.z) : 0};
        return true;
    }
    if (infinite > 1 || is_zero(n)) return false;
    *q = times(scale_of(n), n);
    return true;
}

SGT_INLINE sgt_fate trace_bend(const bending *by, sgt_vec3 *d, sgt_vec3 n)
{
    if (by->kind == STRAIGHT) return SGT_PASSED;
    if (!in_range(dot(n, n)) && !along_normal(n, &n)) return SGT_LOST;
    bent b = bent_by(by->kind, by->r, by->k, *d, n);
    if (b.D < 0) return SGT_TIR;
    if (where_good(b, 1) == 0) return SGT_LOST; /* indices too unlike for a double */
    *d = b.d;
    return SGT_PASSED;
}

/* The same by a phase in waves at p, which makes *path longer, or by facets there. */
static sgt_fate bend_by_waves(const sgt_element *e, double n1, double n2, sgt_vec3 p, sgt_vec3 n, sgt_vec3 *d,
                              twofold *path)
{
    const kick by = kick_of(e->phase, n1, n2, e->index == SGT_MIRROR);
    const waves_here here = sgt_waves_at(e->phase, p);
    if (!in_range(dot(n, n)) && !along_normal(n, &n)) return SGT_LOST;
    const bool facets = is_faceted(e->phase);
    const kicked b = facets ? facet_by(by.back, by, here.g, *d, n) : kick_by(by.back, by, here.g, *d, n);
    if (b.q <= 0) return facets ? SGT_TIR : SGT_EVANESCENT;
    if (where_kicked(b, 1) == 0) return SGT_LOST;
    *path = kick_path(path_per_wave(e->phase), here.w, *path);
    *d = b.d;
    return SGT_PASSED;
}

/* By a phase of either kind; sets *d, and makes *path longer if a caller wants it. */
SGT_NOINLINE static sgt_fate bend_by_phase(const sgt_element *e, double n1, double n2, bool told,
                                           const sgt_hit *hit, sgt_vec3 *d, twofold *path)
{
    const sgt_vec3 p = hit->p;
    if (is_in_waves(e->phase)) return bend_by_waves(e, n1, n2, p, hit->n, d, path);
    thin_lens by = thin_lens_of(e->phase, n1, n2, e->index == SGT_MIRROR);
    focused b = focus_by(by, p, *d);
    if (where_focused(b, 1) == 0) return SGT_LOST;
    if (told) *path = twofold_sum(*path, twofold_of(phase_path(by, p, *d)));
    *d = b.d;
    return SGT_PASSED;
}

/* --------------------------------------------------------------- the trace */

sgt_passage sgt_not_met(sgt_status why)
{
    const double none = (double)NAN;
    return (sgt_passage){
        .hit = {.status = why, .evals = 0, .t = none, .t_err = none, .t_lo = none, .lo = none, .hi = none,
                .f = none, .p_err = none, .p = {none, none, none}, .n = {none, none, none},
                .reserved_ = {0, 0}},
        .direction = {0, 0, 0}, .opl = none, .reserved_ = {0, 0}};
}

/* One element.  sound: as in sgt_pass; told: the caller wants the passage. */
SGT_INLINE sgt_fate pass(const sgt_element *e, bool sound, state *at, const sgt_options *opt,
                         const sgt_hit *met, bool told, sgt_passage *passage)
{
    bool mirror = e->index == SGT_MIRROR, turned = is_turned(&e->pose), inside;
    double n1 = at->index, n2 = index_behind(e, n1);
    if (!sound || !is_sound(e, n1)) return *passage = sgt_not_met(SGT_INVALID), SGT_LOST;

    sgt_ray ray = {.o = plus(minus(at->base, e->pose.origin), at->offset), .d = at->d, .tmin = -HUGE_VAL,
                   .tmax = HUGE_VAL};
    if (turned) {
        ray.o = to_local(&e->pose, ray.o), ray.d = to_local(&e->pose, ray.d);
        if (!make_unit(&ray.d)) return *passage = sgt_not_met(SGT_INVALID), SGT_LOST;
    }
    sgt_options own = *opt;
    if (own.t_tol == 0) own.t_tol = tolerance(is_open(e->semi_diameter), e->semi_diameter, ray.o, ray.d);
    bool only = asks_unique(&own); /* the only root that is meant, within the clear aperture */
    if (only) own.proof = SGT_PROVE_ROOT;
    shifted shift = {opt->watch, opt->watch_data, at->t0};
    if (at->t0 != 0 && opt->watch) own.watch = watch_shifted, own.watch_data = &shift;
    const sgt_surface surface = in_set(e->surface);
    double aperture2 = aperture2_of(e->semi_diameter);
    bool slopes = aperture2 > 0 && proves_by_slope(surface, &own), proven = slopes && met;
    sgt_hit hit;
    int spent = 0;
    if (met) hit = *met;
    else if (slopes)
        proven = sgt_meet_by_slope(surface, &ray, aperture2, &own, &hit), spent = proven ? 0 : hit.evals;
    if (!met && !proven) hit = sgt_intersect(surface, ray, &own), hit.evals += spent;
    if (proven) inside = hit.status > 0;
    else trace_choose(surface, ray, aperture2, &own, &hit, &inside);
    own.proof = opt->proof;
    if (inside && only && !proven) sgt_prove_unique(surface, &ray, aperture2_around(aperture2), &own, &hit);
    if (!met) tell_of_given(&hit, at, &e->pose, turned, &ray, told); /* else the batch has done it */
    *passage = (sgt_passage){.hit = hit, .direction = {0, 0, 0}, .opl = (double)NAN, .reserved_ = {0, 0}};
    if (hit.status == SGT_MISS) return SGT_MISSED;
    if (hit.status < 0) return SGT_LOST;

    twofold path = longer(at->path, n1, hit.t, hit.t_lo);
    passage->opl = path.hi;
    if (!inside || is_obstructed(e, hit.p)) return SGT_CLIPPED;

    bending by = bending_of(n1, n2, mirror);
    sgt_vec3 d = ray.d;
    sgt_fate fate;
    if (e->phase) by.kind = BY_PHASE, fate = bend_by_phase(e, n1, n2, told, &hit, &d, &path);
    else fate = trace_bend(&by, &d, hit.n);
    if (fate == SGT_LOST) { /* no normal there, or no direction behind */
        *passage = sgt_not_met(SGT_UNDEFINED);
        passage->hit.evals = hit.evals;
    }
    if (fate != SGT_PASSED) return fate;
    passage->direction = d, passage->opl = path.hi;
    if (by.kind != STRAIGHT) { /* else the global direction stays as it is, to the bit */
        at->d = turned ? to_global(&e->pose, d) : d;
        if (turned) make_unit(&at->d);
    }
    at->base = e->pose.origin;
    at->offset = turned ? to_global(&e->pose, hit.p) : hit.p;
    at->t0 = 0, at->first = false, at->turned = turned;
    at->index = n2;
    at->path = path;
    return SGT_PASSED;
}

sgt_fate sgt_pass(const sgt_element *e, bool sound, state *at, const sgt_options *opt, const sgt_hit *met,
                  sgt_passage *passage)
{
    return pass(e, sound, at, opt, met, true, passage);
}

size_t sgt_trace(size_t elements, const sgt_element e[], double index_before, sgt_ray *ray,
                 sgt_passage passages[], sgt_fate *fate, const sgt_options *opt)
{
    sgt_options options = opt ? *opt : (sgt_options){0};
    if (options.pick == SGT_PICK_DEFAULT) options.pick = SGT_NEAR_SEED;
    state at;
    sgt_fate last = SGT_PASSED;
    size_t passed = 0, plain = 0;
    while (plain < elements && is_plain(&e[plain])) plain++; /* 22 instructions each; in `pass` 49 */
    if (launch(ray, elements ? e : NULL, index_before, &at)) {
        ray->d = at.d;
    } else {
        last = SGT_LOST;
        if (passages && elements) passages[0] = sgt_not_met(SGT_INVALID);
    }
    while (last == SGT_PASSED && passed < elements) {
        sgt_passage unread, *passage = passages ? &passages[passed] : &unread;
        bool sound = passed < plain && is_aperture_sound(&e[passed]) && is_phase_sound(&e[passed]);
        last = pass(&e[passed], sound, &at, &options, NULL, passages != NULL, passage);
        if (last != SGT_PASSED) break;
        passed++;
        ray->o = plus(at.base, at.offset), ray->d = at.d;
    }
    if (fate) *fate = last;
    return passed;
}

const char *sgt_fate_text(sgt_fate fate)
{
    switch (fate) {
    case SGT_PASSED: return "passed";
    case SGT_CLIPPED: return "clipped";
    case SGT_TIR: return "tir";
    case SGT_EVANESCENT: return "evanescent";
    case SGT_MISSED: return "missed";
    case SGT_LOST: return "lost";
    }
    return "?";
}
