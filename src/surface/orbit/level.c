// SPDX-License-Identifier: MIT
/* level.c - every root of a level set |Q_N| = E along a ray, in order, none missed.
 *
 * THE CHORD.  The set lies in the ball |Q_0| <= E_0.  The ray is made local at its point nearest the
 * centre of the ball, and the ball cuts it to a chord.  A ray that passes outside is a miss.
 *
 * THE CELLS cover the chord, nearest first.  orbit.h defines outside, inside and monotone.  Outside and
 * inside cells hold no root.  In a monotone cell |Q_N|^2 has a slope between S- and S+ of one sign.  So a
 * root, if it exists, lies in m - (|Q_N(m)|^2 - E^2 -+ g_err) / [S-, S+] (interval Newton; Moore 1966,
 * Nickel 1971).  There are three cases:
 * - That interval is wholly inside the cell: the root exists and is the only one.
 * - It is beyond the cell's end: the part before it is free of roots.
 * - It is before the cell's start: there is no root.  The side on which the cell begins is known from the
 *   cell before.
 *
 * A cell that is none of these is made smaller, unless its variation is already below the rounding of
 * |Q_N|^2.  Then it joins an undecided stretch, which ends with the next decided cell.  Unlike sides are a
 * crossing.  Like ones are a graze if |F| was within a few roundings all over the stretch, else UNPROVEN.
 *
 * THE START.  A ray that starts on the surface has no cell before it that gives the side.  If the root of
 * a monotone cell about the start may be on either side of the cell's beginning, the cell is laid slightly
 * earlier, so that the root is inside.  That root is not accepted, and behind it the side is known.  Such
 * rays start with a short cell, which doubles (first_course).
 *
 * T_TOL ends the bracket of a root as soon as it is narrow enough.  It also ends an undecided cell if its
 * first half is at most t_tol long and F seems to have another sign in its middle than at its start.  One
 * look at the middle only makes the change of sign certain, and it is reported as a root.  If neither
 * helps, the cells are those without t_tol.
 *
 * A BRACKET is narrowed by interval Newton.  Each cell lies where Newton's method on F takes the middle of
 * the last one.  (F is tanh(log(|Q_N| / E)), nearly linear over many lengths where |Q_N|^2 is not.)  It is
 * as wide as the guess may be off by the variation of the slope.  Mostly three cells reach rounding.
 *
 * UNDER PROOF a root has to be in a monotone cell twice as long as [t - t_err, t + t_err].  Then it
 * exists, since F changes sign, and is the only one.  From far away one ulp of t, and so t_err, may be
 * long compared with the set.  Then a shorter cell about the root is monotone, and the rest of [t - t_err,
 * t + t_err] is covered by cells without a root.  t_tol is not read, because a change of sign over that
 * much may be of three roots.  dt_min is not read either.
 *
 * THE FAST WAY, dt_min > 0: steps of the larger of dt_min and Hart's estimate A log(A / E) / (2
 * |dQ_N/dp|).  F is evaluated between them, and a change of sign is a bracket for Newton's method.  Thin
 * parts may be skipped. */
#include "level.h"

#include "march_f.h"
#include "../../solve/root.h"
#include "../builtin.h"

typedef struct level_walk {
    path path;
    const orbit *orbit;
    const sgt_ray *ray;
    tally told;
    local q;
    double t_tol, least; /* of tau; what rounding leaves of it */
    bool all, done;
    sgt_list *list;
} level_walk;

sgt_span sgt_level_span(const orbit *o, const sgt_ray *ray)
{
    path w;
    local q;
    double lo, hi;
    escape s = escape_of(o);
    if (chord_of(o, s.limit + s.over, ray, &q, &w, &lo, &hi) < 0)
        return (sgt_span){.lo = 1, .hi = 0, .seed = NAN};
    double slack = 0x1p-48 * (fabs(q.t0) + fabs(lo) + fabs(hi));
    if (!(hi - lo < HUGE_VAL)) return (sgt_span){.lo = -HUGE_VAL, .hi = HUGE_VAL, .seed = NAN};
    return (sgt_span){.lo = end_below(q.t0 + lo - slack, q.scale),
                      .hi = end_above(q.t0 + hi + slack, q.scale), .seed = NAN};
}

/* ----------------------------------------------------------------- entries */

static void tell_of(level_walk *w, sgt_move move, double tau, double lo, double hi)
{
    double slope, f = sgt_orbit_value(&w->path, tau, &slope), t0 = w->q.t0, scale = w->q.scale;
    tell(&w->told, move, (t0 + tau) * scale, f, slope / scale, (t0 + lo) * scale, (t0 + hi) * scale);
    w->done = w->done || w->told.stopped;
}

/* Counts one more evaluation, at tau. */
SGT_INLINE void look_on(level_walk *w, sgt_move move, double tau, double lo, double hi)
{
    if (w->told.opt->watch) tell_of(w, move, tau, lo, hi);
    else w->told.evals++;
}

static void level_add(level_walk *w, sgt_hit *hit)
{
    hit->evals = w->told.evals - w->told.before;
    w->told.before = w->told.evals;
    next_root(&w->told);
    sgt_list_add(w->list, hit);
    w->done = w->done || !w->all;
}

static void level_stretch(level_walk *w, sgt_status status, double lo, double hi)
{
    int count = w->list->count;
    add_stretch(w->list, &w->told, status, w->ray, (w->q.t0 + lo) * w->q.scale, (w->q.t0 + hi) * w->q.scale);
    w->done = w->done || (w->list->count > count && !w->all);
}

bool sgt_level_unique(const orbit *o, path *w, const sgt_ray *ray, double t, double t_lo, double t_err)
{
    local q;
    double lo, hi;
    chord_of(o, first_escape(w), ray, &q, w, &lo, &hi);
    return sgt_orbit_monotone(w, (t / q.scale - q.t0) + t_lo / q.scale, 2 * (t_err / q.scale));
}

enum { PROOF_CELLS = 256 }; /* on one side; mostly about a dozen */

/* True if no root lies in [lo, hi].  h: half the first cell.  False if some cell cannot tell. */
static bool free_of_roots(level_walk *w, double lo, double hi, double h)
{
    course k = {.tau = lo, .hi = hi, .h = h};
    for (int i = 0; k.tau < hi; i++) {
        cell_place at = lay(&k);
        cell e;
        if (i == PROOF_CELLS || spent(&w->told)) return false;
        sgt_orbit_cell(&w->path, at.m, at.h, &e);
        look_on(w, SGT_PROBE, at.m, k.tau, hi);
        if (w->told.stopped) return false;
        bool none = e.verdict == CELL_OUTSIDE || e.verdict == CELL_INSIDE;
        if (e.verdict == CELL_MONOTONE) {
            sighting n = sight_of(w->path.E * w->path.E, &e, at.h);
            none = n.lo > at.h || n.hi < -at.h;
        }
        if (none) k.tau = at.end;
        k.h = at.h * (none ? 2 : 0.5);
    }
    return true;
}

/* Is the root within tau_err of tau the only one in [t - t_err, t + t_err]? */
static bool only_root(level_walk *w, const meeting *h, double tau, double tau_err)
{
    double far = h->t_err / w->q.scale;
    look_on(w, SGT_PROBE, tau, tau - 2 * far, tau + 2 * far);
    if (w->told.stopped) return false;
    if (sgt_level_unique(w->orbit, &w->path, w->ray, h->t, h->t_lo, h->t_err)) return true;
    /* The ends, and the difference t / scale - t0, are rounded: each by an ulp of what is added here. */
    double t = h->t / w->q.scale - w->q.t0, end = far + 0x1p-50 * (far + fabs(t)), half = 1.25 * far;
    while (half > 1.1 * tau_err && !sgt_orbit_monotone(&w->path, tau, half)) half *= 0.5;
    double inner = half * (1 - 0x1p-20) - 0x1p-50 * fabs(tau);
    return inner > tau_err && free_of_roots(w, t - end, tau - inner, half) &&
           free_of_roots(w, tau + inner, t + end, half);
}

/* Adds a root or a graze within tau_err of tau, unless it is outside the ray's ends or is the start.
 * Returns false if the watcher has stopped the search before. */
static bool add_root(level_walk *w, sgt_status status, double tau, double tau_err)
{
    meeting h;
    meeting_place(&h, &w->q, tau, tau_err);
    h.v = 1;
    double f = sgt_level_value(w->orbit, h.p, &h.n);
    look_on(w, SGT_NEWTON, tau, tau - tau_err, tau + tau_err);
    if (w->told.stopped) return false;
    double terms = fabs(h.p.x * h.n.x) + fabs(h.p.y * h.n.y) + fabs(h.p.z * h.n.z);
    bool steep = w->path.before > 0 && !(terms < 0x1p480); /* or the gradient is NaN: no start can be told */
    if (!root_in_range(&h) || steep) { /* t is out of range in lengths of d */
        level_stretch(w, SGT_UNPROVEN, -HUGE_VAL, HUGE_VAL);
        return true;
    }
    if (!root_accepted(&h, &w->q, w->ray->tmin, w->ray->tmax)) return true;
    if (w->told.opt->proof != SGT_ESTIMATE && status == SGT_HIT) {
        bool only = only_root(w, &h, tau, tau_err);
        if (w->told.stopped) return false;
        if (!only) {
            double far = h.t_err / w->q.scale;
            level_stretch(w, SGT_UNPROVEN, tau - far, tau + far);
            return true;
        }
    }
    sgt_hit hit = hit_found(status, 0, f, &h);
    level_add(w, &hit);
    return true;
}

/* ----------------------------------------------------------- the certified march */

/* Finds the root in the bracket.  Returns false if the search is over before it was reported. */
static bool level_polish(level_walk *w, bracket *p)
{
    double E2 = w->path.E * w->path.E, wanted = larger(w->t_tol, w->least);
    bool on = root_error(p) > wanted;
    while (on && !w->done && !spent(&w->told)) {
        cell e;
        sgt_orbit_cell(&w->path, p->m, p->h, &e);
        look_on(w, SGT_NEWTON, p->m, p->lo, p->hi);
        sighting n = sight_of(E2, &e, p->h);
        on = narrow(p, &e, &n, w->path.iterations, E2, wanted, w->least);
    }
    int count = w->list->count;
    if (w->told.stopped || !add_root(w, SGT_HIT, p->m, root_error(p))) return false;
    /* the budget ended it, and so wide a bracket could not be told from the start: it is left */
    return !on || w->done || w->list->count > count;
}

/* Cells that the march may need next, looked at together. */
typedef struct ahead { double m[4], h[4]; cell seen[4]; bool known[4]; } ahead;

static const cell *level_look_at(const level_walk *w, ahead *a, cell_place at, course k)
{
    for (int i = 0; i < 4; i++)
        if (a->known[i] && a->m[i] == at.m && a->h[i] == at.h) return &a->seen[i];
    for (int i = 0; i < 4; i++) {
        a->m[i] = at.m, a->h[i] = at.h;
        k.tau = at.end, k.h = at.h, faster(&k);
        if (at.end < k.hi) at = lay(&k);
    }
    sgt_orbit_cells(&w->path, a->m, a->h, a->seen, a->known);
    return &a->seen[0];
}

/* A march (solve/cells.h).  e: the cell at hand; n: where a root of it can be, if it is monotone.
 * about: that may be before the cell or in it.  ends: the root at the end of an undecided stretch is in the
 * cell at hand.  here: the sign of F where the cell begins or, with `ends`, behind the root; for the march
 * to ask once. */
typedef struct level_cells {
    level_walk *w;
    ahead *near;
    const cell *e;
    sighting n;
    bool about, ends;
    int here;
} level_cells;

SGT_INLINE bool level_over(void *self)
{
    const level_walk *w = ((level_cells *)self)->w;
    return w->done || spent(&w->told);
}

SGT_INLINE int level_sign(void *self, cells *c, double tau)
{
    level_cells *s = self;
    int here = s->here;
    (void)c, (void)tau;
    s->here = 0;
    return here;
}

SGT_INLINE bool level_dark(void *self, cells *c, sgt_status status)
{
    level_walk *w = ((level_cells *)self)->w;
    const undecided *dark = &c->dark;
    double middle = 0.5 * (dark->lo + dark->hi), half = 0.5 * (dark->hi - dark->lo) * (1 + 4 * SGT_U);
    if (status == SGT_HIT || (status == SGT_GRAZE && dark->before && dark->after))
        return add_root(w, status, middle, half);
    level_stretch(w, SGT_UNPROVEN, dark->lo, dark->hi);
    return true;
}

/* What follows from the cell at hand (decide of course.h).  The march has mostly been moved on by it. */
SGT_INLINE cells_kind level_turn(void *self, cells *c)
{
    level_cells *s = self;
    level_walk *w = s->w;
    const cell *e = s->e;
    course *k = &c->k;
    cell_place at = c->at;
    double tau = k->tau, E2 = w->path.E * w->path.E, found, err;
    bracket root;
    cell middle;
    turn what = RARE;
    if (s->ends) {
        s->ends = false, k->side = e->qv < 0 ? -1 : 1;
        return CELLS_MONOTONE;
    }
    const course_limits bounds = {w->path.iterations, E2, w->t_tol, w->least};
    if (!(c->dark.any && s->about)) what = decide(k, &at, e, &s->n, &bounds, &root);
    switch (what) {
    case ON: return CELLS_AGAIN;
    case ROOT:
        if (!level_polish(w, &root)) k->tau = tau; /* the root is part of what is left */
        return CELLS_AGAIN;
    case ACROSS:
        if (spent(&w->told)) return CELLS_AGAIN;
        sgt_orbit_cell(&w->path, at.m, 0, &middle);
        look_on(w, SGT_PROBE, at.m, tau, k->hi);
        if (!w->done && found_across(k, &at, middle.verdict, &w->t_tol, &found, &err)
            && !add_root(w, SGT_HIT, found, err))
            k->tau = tau;
        return CELLS_AGAIN;
    case RARE: break;
    }
    if (s->about && !c->dark.any) { /* the start is on the surface: begin before it */
        k->tau = tau - 4 * at.h;
        return CELLS_AGAIN;
    }
    bool hopeless = e->W < HUGE_VAL && (fabs(e->qv) + e->W) * at.h <= 4 * e->g_err;
    if (!hopeless && !(at.h <= 2 * SGT_U * fabs(at.m))) return CELLS_OPEN;
    c->touches = e->W < HUGE_VAL && fabs(e->A2 - E2) <= 5 * e->g_err;
    s->here = (int)k->side, k->side = 0;
    return CELLS_NOISE;
}

SGT_INLINE cells_kind level_classify(void *self, cells *c)
{
    level_cells *s = self;
    level_walk *w = s->w;
    double m = c->at.m, h = c->at.h;
    const cell *e = s->e = level_look_at(w, s->near, c->at, c->k);
    look_on(w, SGT_MARCH, m, c->k.tau, c->k.hi);
    if (w->done) return CELLS_AGAIN;
    bool monotone = e->verdict == CELL_MONOTONE,
         bright = e->verdict == CELL_OUTSIDE || e->verdict == CELL_INSIDE;
    s->n = monotone ? sight_of(w->path.E * w->path.E, e, h) : (sighting){0, 0, 0, 0};
    s->about = monotone && c->k.side == 0 && s->n.lo < -h && s->n.hi > -h;
    if (!c->dark.any) return CELLS_LATER;
    int falls = e->qv < 0 ? 1 : -1;
    if (s->about && s->n.hi < h) {
        s->ends = true, s->here = -falls, c->dark.hi = m + s->n.hi;
        return CELLS_MONOTONE;
    }
    if (!bright && (!monotone || s->about)) return CELLS_LATER;
    s->here = bright ? e->verdict == CELL_OUTSIDE ? 1 : -1 : s->n.lo >= -h ? falls : -falls;
    return CELLS_MONOTONE;
}

/* ----------------------------------------------------- its beginning, in floats */

enum { AHEAD_F = 8 };

/* The cells that a march in floats may need next, looked at together. */
typedef struct ahead_f {
    float tau[AHEAD_F], step[AHEAD_F], growth[AHEAD_F];
    float m[AHEAD_F], h[AHEAD_F], end[AHEAD_F], odd[AHEAD_F], verdict[AHEAD_F];
    float a[AHEAD_F], b[AHEAD_F], c[AHEAD_F], d[AHEAD_F], pa[AHEAD_F], pb[AHEAD_F], pc[AHEAD_F], pd[AHEAD_F],
        e[AHEAD_F], over[AHEAD_F], left[AHEAD_F];
} ahead_f;

/* Four cells, one behind another; and for each the shorter one, if it is open. */
static int next_ahead(const ahead_f *s, int i)
{
    return s->verdict[i] != OUT && i < 4 ? i + 4 : i < 3 ? i + 1 : -1;
}

/* Is the first cell on the way that is not decided on its way still? */
static bool ahead_waits(const ahead_f *s)
{
    int i = 0;
    while (i >= 0 && s->verdict[i] != LIVE && s->verdict[i] != CLOSE) i = next_ahead(s, i);
    return i >= 0 && s->verdict[i] == LIVE;
}

SGT_INLINE void march_ahead(ahead_f *s, const ray_f *ray, const march_f *set, bool mandelbrot)
{
    const ray_f r = *ray;
    const march_f w = *set;
#pragma omp simd
    for (int l = 0; l < AHEAD_F; l++) {
        flight_f f = begin_f(&r, &w, s->m[l], s->h[l], s->odd[l]);
        s->a[l] = f.a, s->b[l] = f.b, s->c[l] = f.c, s->d[l] = f.d, s->pa[l] = f.pa, s->pb[l] = f.pb,
        s->pc[l] = f.pc, s->pd[l] = f.pd;
        s->e[l] = f.e, s->over[l] = f.over, s->left[l] = f.left, s->verdict[l] = f.verdict;
    }
    do {
#pragma omp simd
        for (int l = 0; l < AHEAD_F; l++) {
            flight_f f = {s->a[l], s->b[l], s->c[l], s->d[l], s->pa[l], s->pb[l], s->pc[l], s->pd[l], s->e[l],
                          s->over[l], s->left[l], s->verdict[l]}, n = f;
            if (mandelbrot) n = begin_f(&r, &w, s->m[l], s->h[l], s->odd[l]);
            on_a_level_f(&f, &n, &w, mandelbrot);
            on_a_level_f(&f, &n, &w, mandelbrot);
            s->a[l] = f.a, s->b[l] = f.b, s->c[l] = f.c, s->d[l] = f.d, s->pa[l] = f.pa, s->pb[l] = f.pb,
            s->pc[l] = f.pc, s->pd[l] = f.pd;
            s->e[l] = f.e, s->over[l] = f.over, s->left[l] = f.left, s->verdict[l] = f.verdict;
        }
    } while (ahead_waits(s));
}

SGT_KERNEL static void ahead_julia(ahead_f *s, const ray_f *r, const march_f *w)
{
    march_ahead(s, r, w, false);
}
SGT_KERNEL static void ahead_mandelbrot(ahead_f *s, const ray_f *r, const march_f *w)
{
    march_ahead(s, r, w, true);
}

/* Lays cell 0 and those that may follow. */
static void lay_ahead(ahead_f *s, const ray_f *r)
{
    float tau = r->tau, step = r->step, growth = r->growth, hi = r->hi;
    for (int i = 0; i < 4; i++) {
        const cell_f at = lay_f(tau, hi, step);
        s->tau[i] = tau, s->step[i] = step, s->growth[i] = growth;
        s->m[i] = at.m, s->h[i] = at.h, s->end[i] = at.end, s->odd[i] = at.odd;
        growth = grown_f(growth), tau = at.end, step = at.h * growth;
    }
#pragma omp simd
    for (int i = 0; i < 4; i++) {
        float half = s->h[i] * 0.5f;
        const cell_f at = lay_f(s->tau[i], hi, half);
        s->tau[i + 4] = s->tau[i], s->step[i + 4] = half, s->growth[i + 4] = shrunk_f(s->growth[i]);
        s->m[i + 4] = at.m, s->h[i + 4] = at.h, s->end[i + 4] = at.end, s->odd[i + 4] = at.odd;
    }
}

/* Uses the looks.  Returns false if the march in floats is over. */
static bool settle_ahead(level_walk *w, const ahead_f *s, ray_f *r, const march_f *set, double hi)
{
    const double unit = unit_f_of(w->path.along_size).inverse;
    for (int i = 0; i >= 0; i = next_ahead(s, i)) {
        float verdict = s->verdict[i], h = s->h[i];
        bool out = verdict == OUT;
        if (verdict == LIVE) return true;
        if (verdict == CLOSE) return false;
        if (!out && !(h > shortest_f(verdict, r->side, r->t_tol, r->least, set->E2))) return false;
        look_on(w, SGT_MARCH, (double)s->m[i] * unit, (double)s->tau[i] * unit, hi);
        r->evals += 1, r->growth = out ? grown_f(s->growth[i]) : shrunk_f(s->growth[i]);
        r->step = h * (out ? r->growth : 0.5f);
        if (out) r->tau = s->end[i], r->side = 1;
        if (!(r->tau < r->hi) || r->evals >= set->budget || w->done) return false;
    }
    return true;
}

/* The march as far as floats go (march_f.h).  Returns the course from there. */
static course march_in_floats(level_walk *w, course k)
{
    const march_f set = march_f_of(w->orbit, &w->path, w->told.budget);
    const quaternion at[2] = {w->path.start, w->path.along};
    const double size[2] = {w->path.start_size, w->path.along_size};
    ray_f r = ray_f_of(&set, at, size, k, w->t_tol, w->least);
    ahead_f s;
    for (bool on = r.tau < r.hi && !spent(&w->told); on; on = settle_ahead(w, &s, &r, &set, k.hi)) {
        lay_ahead(&s, &r);
        (w->path.mandelbrot ? ahead_mandelbrot : ahead_julia)(&s, &r, &set);
    }
    return course_after(k, &r, size[1]);
}

/* The march over [lo, hi] of a chord that begins at `start`. */
static void level_march(level_walk *w, double start, double lo, double hi)
{
    ahead near;
    for (int i = 0; i < 4; i++) near.known[i] = false;
    level_cells s = {.w = w, .near = &near};
    course k = first_course(start, lo, hi);
    if (w->path.power == 2 && w->path.iterations <= MOST_LEVELS) k = march_in_floats(w, k);
    cells c = {.k = k, .back = lo, .leap = 1};
    cells_march(&c, &s, (cells_ops){level_over, level_classify, level_turn, level_sign, level_dark});
    double from = cells_reached(&c);
    if (w->told.stopped) level_stretch(w, SGT_STOPPED, from, hi);
    else if (!w->done && (c.k.tau < hi || c.dark.any)) level_stretch(w, SGT_EXHAUSTED, from, hi);
}

/* ------------------------------------------------------------------- the fast way */

/* The distance, and F itself in *f. */
static double estimate_at(const orbit *o, const estimator *s, quaternion q, double *f)
{
    slice_orbit at = slice_orbit_at(s, q);
    for (int k = o->mandelbrot ? 1 : 0; k < o->iterations && at.A2 < FAR_ENOUGH * s->E2; k++) {
        if (o->power == 2) {
            at = slice_orbit_squared(at, s, o->mandelbrot);
            continue;
        }
        at.growth2 *= s->power2 * small_power(at.A2, o->power - 1);
        if (o->mandelbrot) at.growth2 = (sqrt(at.growth2) + 1) * (sqrt(at.growth2) + 1);
        power_of r = power_only((quaternion){at.a, at.b, sqrt(at.rest), 0}, o->power);
        at = (slice_orbit){r.s + s->along_c.a, r.f * at.b + s->im, at.rest * (r.f * r.f), 0, at.growth2};
        at.A2 = at.a * at.a + (at.b * at.b + at.rest);
    }
    return estimate_of(s, at.A2, at.growth2, f);
}

double sgt_level_estimate(const orbit *o, sgt_vec3 p, double *f)
{
    quaternion q = quaternion_at(o, p.x, p.y, p.z);
    estimator s = estimator_of(o, o->mandelbrot ? q : o->c);
    return estimate_at(o, &s, q, f);
}

static void march_fast(level_walk *w, double lo, double hi, double dt_min)
{
    const orbit *o = w->orbit;
    WENT(WAY_STEPS);
    double inverse = 1 / sqrt(w->q.l * w->q.l + w->q.m * w->q.m + w->q.n * w->q.n), last = lo, last_f = NAN,
           tau = lo, f;
    estimator s = estimator_of(o, o->c);
    bool any = false;
    for (;;) {
        if (spent(&w->told)) {
            level_stretch(w, SGT_EXHAUSTED, last, hi);
            return;
        }
        quaternion q = quaternion_sum(w->path.start, quaternion_times(w->path.along, tau));
        if (o->mandelbrot) s = estimator_of(o, q);
        double away = estimate_at(o, &s, q, &f) * inverse;
        look_on(w, SGT_MARCH, tau, last, hi);
        if (w->done) break;
        if (last_f * f < 0) { /* a change of sign, so a root: as certain as the two signs */
            int before = w->list->count;
            bracket root = {.lo = last, .hi = tau, .a = last, .b = tau, .falls = last_f > 0 ? 1 : -1};
            step_to(&root, tau, f * (tau - last) / (f - last_f), 0, 0.125 * (tau - last));
            if (!level_polish(w, &root)) break;
            any = any || w->list->count > before;
            if (w->done) break;
        }
        if (!(tau < hi)) break;
        if (f != 0) last = tau, last_f = f;
        double next = tau + larger(away, dt_min);
        tau = next > hi ? hi : next > tau ? next : next_double(tau);
    }
    if (w->told.stopped) level_stretch(w, SGT_STOPPED, last, hi);
    else if (!any && !w->done) level_stretch(w, SGT_UNPROVEN, lo, hi);
}

int sgt_level_march(const orbit *o, const sgt_ray *ray, const sgt_options *opt, bool all, sgt_list *list)
{
    level_walk w;
    double lo, hi;
    set_of(o, &w.path);
    if (chord_of(o, first_escape(&w.path), ray, &w.q, &w.path, &lo, &hi) < 0) return 0;
    w.orbit = o, w.ray = ray, w.all = all, w.done = false, w.list = list;
    w.told = (tally){.opt = opt, .budget = opt->max_evals ? opt->max_evals : SGT_DEFAULT_EVALS};
    if (!(hi - lo > 0 && hi - lo < HUGE_VAL)) {
        level_stretch(&w, SGT_UNPROVEN, -HUGE_VAL, HUGE_VAL); /* out of range */
        return 0;
    }
    double scale = w.q.scale, tmin = ray->tmin / scale - w.q.t0, tmax = ray->tmax / scale - w.q.t0;
    w.t_tol = opt->proof == SGT_ESTIMATE ? opt->t_tol / scale : 0;
    w.least = 0x1p-48 * (larger(fabs(lo), fabs(hi)) + w.path.start_size / w.path.along_size);
    double start = lo;
    cut_to_ends(&w.q, tmin, tmax, &lo, &hi);
    if (lo > hi || tmin > hi || tmax < lo) return 0;
    if (opt->dt_min > 0 && opt->proof == SGT_ESTIMATE) march_fast(&w, lo, hi, opt->dt_min / scale);
    else level_march(&w, start, lo, hi);
    list->evals = w.told.evals;
    return w.told.evals - w.told.before;
}
