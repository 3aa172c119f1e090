// SPDX-License-Identifier: MIT
/* cells_batch.c - first roots by cells, many rays side by side: for surfaces that offer `encloses`, and for
 * proofs of the bodies of the catalogue, which have one of their own (builtin.h).
 *
 * A SLOT holds one ray on its march.  In each round every slot asks about one cell, and one call of
 * `encloses` answers for all.  A ray that is decided leaves its slot, and the next one takes it.  So the
 * surface works in full vectors, although no two rays take the same number of cells.  A ray by itself has
 * one slot.  What is said of a cell does not depend on its neighbours, and neither does what follows from
 * it here: so batches have the bits of single rays.
 *
 * WHAT IS CERTAIN rests on the enclosures alone.  Let the march stand at a, with no accepted root before
 * it, and let G and S be the intervals of g and g' over the cell [a, b].  `sign` is the certain sign of g
 * at a, 0 if it is not known; `least` > 0 is a lower bound on |g(a)|, where known.
 *
 *     0 is not in G           no root in the cell, and the sign at b is that of G.  (lo > hi: F is undefined
 *                             all over the cell.  Then no sign is known.)
 *     S is bounded, 0 is not  g is continuous and monotone in the cell.  If |g| rises from a on, no root is
 *     in S                    in it.  If |g| falls, G at b decides: with the same sign there is none, with
 *                             the other exactly one.  If the sign at a is not known, it is asked first
 *     S is bounded            |g| falls no faster than S says.  So no root lies before a + least / |S|; the
 *                             march moves on to 2^-10 less than that, where |g| is still above 0
 *     else                    the cell is made shorter
 *
 * A ROOT.  The bracket [a, b] has exactly one root.  Newton's steps on `value` find a t near it, which is
 * nothing but a guess.  Then G at t, and S over X, an interval about t, are asked for.  By the mean value
 * theorem a root in X lies in t - G / S.  If that lies inside X, g has unlike signs at the ends of X, or is
 * zero there: X has exactly one root (Moore 1966; Hansen and Walster 2004, chapter 9).  If t - G / S also
 * lies in [a, b], it is the root of the bracket.  So the hit is proven, whether a proof is asked for or not.
 * F as `value` has it must be 0 there within 2^10 roundings; if not, `encloses` and `value` are not about
 * one F, and nothing is said.
 *
 * A BODY (quadric, ellipsoid, torus) says by `firsts`, for most rays, that the ray has no root, or gives a
 * stretch with one root at most.  If that is not accepted, no other is.  That is rigorous, by the analysis of
 * errors in its head, as spans are, but for roots that it takes for the start: near a line in which two
 * planes meet the terms of the rule are nothing but rounding.  So a ray whose start is not away from the
 * surface is left (are_away).  Else the stretch is a bracket.  Its root is refined from the seed and
 * certified by the enclosures, as above.  (The sign before it is not known, but that of the slope is.)  A
 * stretch whose seed is beyond the ends of the ray, and the span of other rays, are searched by cells.  The
 * enclosures of a body know F at a point to far more than a double has.  So X is made wider by what rounding
 * does to `value`, and t + t_lo is right to rounding of t_lo.
 *
 * THE START.  If 0 is in G at the start, the near end of a monotone cell, the sign there cannot be told.  It
 * need not be.  If the cell has a root, that is within |G| / |S| of the start, and there is no other.  It is
 * the start by the rule of accept.h if the error of such a root, half the width of G over |S|, is no more
 * than 16 widths of the rule (as in proof_take of proof.c), and F as `value` has it says that it is within
 * half of one.  Behind the cell the sign is that of S.  If S is too wide for that, the cell is made shorter.
 * Where F rounds little (a polynomial of low degree), 0 is often not in G: the start is a hit whose
 * coordinates were rounded, and the root lies certainly behind it.  If it does so within 2^-30 of the cell,
 * it is looked at in the same way.  If it is not the start, the march goes on.
 * proof.c would bisect these rays down to rounding, at 25 to 100 times the cost of a first hit.  This costs
 * 1.1 to 1.7 times (gyroid, quartic, sphere, torus as formulas, batches of 1000; observed).
 *
 * THE LENGTH OF A CELL is only a guess, from the last answer.  Over a cell of length w, g was K w wide and S
 * was B w wide.  Let c be |g| where the next cell begins, as the middles of G and S have it, and s the slope
 * of |g|.  The next cell is the longest of these, but at most 4 w, and w/2 if nothing was decided:
 *
 *     2.2 c / (K - s)    a cell of length h excludes 0 if c + s h/2 > K h/2
 *     |s| / B            S will not change its sign in it (1.5 times that, if |g| rises: then it has no root)
 *     1.6 c / |s|        1.6 Newton steps, if |g| falls and S stays away from 0 so far: the cell has the root
 *
 * Behind the last point of a cell it is 1.6 Newton steps, w to 4 w.
 *
 * COST, 640 x 480 rays into a ball of 1.6 (tests/bench/bench_cells.cpp), cells a ray, those that certify a
 * root included: Barth's sextic 11.6, Clebsch 8.0, Chmutov of degree 8 8.3, a gyroid 8.7.  The march of a
 * cell takes 5 ns with AVX-512.
 *
 * WHAT IS LEFT is SGT_HARD, and goes through answer.c:
 * - rays without two finite ends, with numbers out of range, or from so far that an ulp of t is coarse;
 * - a cell at the resolution of t, or more than MOST_CELLS of them: grazes, singular points;
 * - a sign that is not certain at the end of a monotone cell, and a start that THE START does not settle;
 * - a root that is near an end of the ray, by a wide margin (DOUBT);
 * - a root that is not certified. */
#include "cells_batch.h"

#include "../num/lanes.h"
#include "../solve/root.h"
#include "../solve/step.h"
#include "../solve/ways.h"

#include <string.h>

/* SLOTS: of the march.  MEETINGS: roots that are refined together.  QUEUE: rays that are prepared together.
 * NEWTON_STEPS is never spent but by a value that lies. */
enum { SLOTS = 16, MEETINGS = 16, QUEUE = 64, NEWTON_STEPS = 16, MOST_CELLS = 200 };

/* How many times farther from an end than rounding can tell a root has to be. */
static const double DOUBT = 0x1p12;

/* Of a cell: a root nearer to the start may be the start itself. */
static const double NEAR_START = 0x1p-30;

/* What a slot asks for: the cell, or its first or last point.  How it leaves. */
enum { CELL, FIRST_POINT, LAST_POINT };
enum { STAYS, PASSED, BRACKET, STARTED, GIVEN_UP };

/* A row for each number.  a, b: the cell; end: of the search; h: the length to be tried next. */
typedef struct slots {
    double o[3][SLOTS], d[3][SLOTS];
    double a[SLOTS], b[SLOTS], end[SLOTS], sign[SLOTS], least[SLOTS], asks[SLOTS], evals[SLOTS], ray[SLOTS];
    double steep_lo[SLOTS], steep_hi[SLOTS]; /* the slope over the cell whose points are asked for */
    double t_lo[SLOTS], t_hi[SLOTS];         /* what is asked for, and the answers */
    double g_lo[SLOTS], g_hi[SLOTS], slope_lo[SLOTS], slope_hi[SLOTS], leave[SLOTS];
    size_t count;
} slots;

/* Brackets whose roots are refined.  The first MEETINGS cells asked for are the points t, the others X. */
typedef struct meetings {
    double o[3][2 * MEETINGS], d[3][2 * MEETINGS], t_lo[2 * MEETINGS], t_hi[2 * MEETINGS];
    double g_lo[2 * MEETINGS], g_hi[2 * MEETINGS], slope_lo[2 * MEETINGS], slope_hi[2 * MEETINGS];
    double a[MEETINGS], b[MEETINGS], tmin[MEETINGS], tmax[MEETINGS], evals[MEETINGS], ray[MEETINGS];
    double sign[MEETINGS], noise[MEETINGS]; /* noise: the width of G at a point */
    double terms[MEETINGS];                 /* of the gradient that the last step took */
    double x[MEETINGS], y[MEETINGS], z[MEETINGS], l[MEETINGS], m[MEETINGS], n[MEETINGS], t0[MEETINGS],
        scale[MEETINGS], inverse[MEETINGS]; /* the ray made local */
    double tau[MEETINGS], lo[MEETINGS], hi[MEETINGS], last[MEETINGS], asks[MEETINGS], steep[MEETINGS];
    double px[MEETINGS], py[MEETINGS], pz[MEETINGS], f[MEETINGS], fx[MEETINGS], fy[MEETINGS], fz[MEETINGS];
    double tau_err[MEETINGS], least[MEETINGS], room[MEETINGS];
    double t[MEETINGS], t_err[MEETINGS], t_over[MEETINGS], p_err[MEETINGS], good[MEETINGS];
    size_t count;
} meetings;

/* Rays that are prepared, from number `from` of the tile on: what is searched, and if (READY), or where the
 * root of a stretch is refined at once, from its seed (AT_SEED). */
typedef struct queue {
    double lo[QUEUE], hi[QUEUE], seed[QUEUE], state[QUEUE];
    size_t from, next, count;
} queue;
enum { READY = 1, AT_SEED };

/* told: of the only ray, if it has a watcher; else NULL.  f: what `value` says at its hit. */
typedef struct cell_search {
    sgt_surface s;
    sgt_enclose_many *encloses;
    const sgt_options *opt;
    const sgt_tile *tile;
    double budget;
    bool proof, own; /* own: of sgt_builtin_ops */
    tally *told;
    double f;
    queue *queue;
    slots *slots;
    meetings *meetings;
    size_t hard;
} cell_search;

/* -------------------------------------------------------------------------- rays in */

/* Cuts the span to the ray, and looks whether all numbers are in range.  A root at an end of the span, or at
 * tmax, is to be inside. */
SGT_KERNEL
static void cells_cut(size_t n, const sgt_rays *rays, size_t from, double *lo, double *hi, double *state)
{
    const double *ox = rays->o[0] + from, *oy = rays->o[1] + from, *oz = rays->o[2] + from,
                 *dx = rays->d[0] + from, *dy = rays->d[1] + from, *dz = rays->d[2] + from,
                 *tmin = rays->tmin + from, *tmax = rays->tmax + from;
    LANES for (size_t i = 0; i < n; i++)
    {
        sgt_vec3 d = {dx[i], dy[i], dz[i]};
        double from_t = lo[i], to_t = hi[i], scale = scale_of(d), inverse = inverse_of_scale(d);
        double first = tmin[i], last = tmax[i] + 0x1p-44 * fabs(tmax[i]);
        double begin = fabs(from_t) < HUGE_VAL ? fabs(from_t) : 0,
               stop = fabs(to_t) < HUGE_VAL ? fabs(to_t) : 0;
        double room = 0x1p-50 * (begin + stop), a = from_t - room, b = to_t + room;
        bool misses = from_t > to_t;
        a = a >= first ? a : first, b = b <= last ? b : last;
        double far = larger(fabs(a), fabs(b)), length = b - a,
               most = larger(fabs(ox[i]), larger(fabs(oy[i]), fabs(oz[i])));
        bool whole = (dx[i] * scale * inverse == d.x) & (dy[i] * scale * inverse == d.y) &
                     (dz[i] * scale * inverse == d.z);
        bool fits = (length > 0x1p-20 * far) & (far * inverse < 0x1p400) & (most < 0x1p400) &
                    (length * inverse > 0x1p-400) & (inverse > 0x1p-400) & (inverse < 0x1p400) & whole;
        double known = fits ? (double)READY : (double)SGT_HARD;
        lo[i] = a, hi[i] = b;
        state[i] = (misses | (a > b)) ? (double)SGT_MISS : known;
    }
}

static void give(const cell_search *j, size_t i, sgt_status status, double evals)
{
    static const sgt_hit none = {.t = (double)NAN,
                                 .t_err = (double)NAN,
                                 .t_lo = (double)NAN,
                                 .p = {(double)NAN, (double)NAN, (double)NAN},
                                 .n = {(double)NAN, (double)NAN, (double)NAN},
                                 .p_err = (double)NAN};
    sgt_hit hit = none;
    hit.status = status, hit.evals = (int)evals;
    put_hit(&j->tile->hits, i, &hit);
}

static void leave_hard(cell_search *j, size_t i, double evals)
{
    give(j, i, (sgt_status)SGT_HARD, evals);
    j->hard++;
}

/* The rounding of F at n points of a body. */
static void round_own(const cell_search *j, size_t n, sgt_points p, const double f[], double own[])
{
    const sgt_surface_ops *ops = j->s.ops;
    if (ops->own_->roundings && ops->own_->roundings(j->s.self, NULL, n, p, f, own)) return;
    for (size_t i = 0; i < n; i++)
        own[i] = ops->rounding(j->s.self, (sgt_vec3){p.p[0][i], p.p[1][i], p.p[2][i]});
}

/* Of n rays from `from` on: is the start so far from the surface that it is no root, and none was taken for
 * it?  One is if F there is within 2^-48 of the terms of its gradient, and a few roundings. */
SGT_NOINLINE static void are_away(const cell_search *j, size_t from, size_t n, bool away[])
{
    double p[3][QUEUE], f[QUEUE], grad[3][QUEUE];
    const sgt_rays *r = &j->tile->rays;
    for (size_t i = 0; i < n; i++) {
        double tmin = r->tmin[from + i], t = tmin > -HUGE_VAL ? tmin : 0;
        for (int c = 0; c < 3; c++) p[c][i] = moved_along(r->o[c][from + i], t, r->d[c][from + i]);
    }
    j->s.ops->values(j->s.self, n, (sgt_points){{p[0], p[1], p[2]}},
                     (sgt_values){f, {grad[0], grad[1], grad[2]}});
    double own[QUEUE];
    round_own(j, n, (sgt_points){{p[0], p[1], p[2]}}, f, own);
    for (size_t i = 0; i < n; i++) {
        double terms = 0;
        for (int c = 0; c < 3; c++) terms += fabs(p[c][i] * grad[c][i]);
        away[i] = r->tmin[from + i] == -HUGE_VAL || fabs(f[i]) > 0x1p-40 * terms + 0x1p10 * own[i];
    }
}

/* Prepares the next rays.  The surface is not given a ray that is not valid.  false: there are none. */
static bool refill(cell_search *j)
{
    queue *q = j->queue;
    const sgt_surface_ops *ops = j->s.ops;
    size_t left = j->tile->n - q->from - q->count, n = 0;
    q->from += q->count, q->next = q->count = 0;
    for (size_t most = left < QUEUE ? left : QUEUE; n < most; n++) {
        sgt_ray ray = ray_of(&j->tile->rays, q->from + n);
        if (!ray_valid(&ray)) break;
    }
    if (left == 0) return false;
    if (n == 0) {
        leave_hard(j, q->from, 0);
        q->next = q->count = 1;
        return true;
    }
    bool single[QUEUE] = {false}, away[QUEUE] = {false};
    sgt_rays rays = rays_from(&j->tile->rays, q->from);
    sgt_spans spans = {q->lo, q->hi, q->seed, single};
    if (!j->own) {
        spans_of(j->s, n, rays, spans);
    } else {
        rays.tmin = j->tile->rays.tmin + q->from, rays.tmax = j->tile->rays.tmax + q->from;
        ops->firsts(j->s.self, n, rays, spans);
        are_away(j, q->from, n, away);
        for (size_t i = 0; i < n; i++) {
            if (single[i]) continue;
            sgt_ray ray = ray_of(&rays, i);
            sgt_span span = ops->span(j->s.self, &ray);
            q->lo[i] = span.lo, q->hi[i] = span.hi;
        }
    }
    cells_cut(n, &j->tile->rays, q->from, q->lo, q->hi, q->state);
    for (size_t i = 0; i < n; i++) {
        if (single[i] && !j->proof && q->state[i] != SGT_MISS) q->state[i] = SGT_SINGLE;
        if (!j->own) continue;
        if (!away[i]) q->state[i] = SGT_HARD;
        if (single[i] && q->state[i] == READY && q->seed[i] > q->lo[i] && q->seed[i] < q->hi[i])
            q->state[i] = AT_SEED;
    }
    q->count = n;
    return true;
}

static void refine_seed(cell_search *j, size_t i, double lo, double hi, double seed);

/* Gives slot k the next ray that has to be searched.  false: there is none. */
static bool fill_slot(cell_search *j, size_t k)
{
    queue *q = j->queue;
    slots *s = j->slots;
    for (;;) {
        while (q->next == q->count)
            if (!refill(j)) return false;
        size_t at = q->next++, i = q->from + at;
        if (q->state[at] == (double)SGT_MISS)
            give(j, i, SGT_MISS, 0);
        else if (q->state[at] == (double)SGT_HARD)
            leave_hard(j, i, 0);
        else if (q->state[at] == AT_SEED)
            refine_seed(j, i, q->lo[at], q->hi[at], q->seed[at]);
        else if (q->state[at] != READY)
            give(j, i, (sgt_status)SGT_SINGLE, 0), j->hard++;
        else {
            double lo = q->lo[at], hi = q->hi[at];
            for (int c = 0; c < 3; c++)
                s->o[c][k] = j->tile->rays.o[c][i], s->d[c][k] = j->tile->rays.d[c][i];
            s->a[k] = s->t_lo[k] = lo, s->b[k] = s->t_hi[k] = lo + 0.2 * (hi - lo), s->end[k] = hi;
            s->sign[k] = s->least[k] = s->evals[k] = s->steep_lo[k] = s->steep_hi[k] = 0;
            s->asks[k] = CELL, s->ray[k] = (double)i;
            return true;
        }
    }
}

/* ------------------------------------------------------------------------ the march */

/* Chosen by bits, as `chosen` of num/lanes.h is by its meaning.  gcc 12 makes branches of many choices by one
 * condition, and then no vector code.  It cannot see what these masks are. */
SGT_INLINE double either(mask m, double yes, double no)
{
    unsigned long long y, n;
    memcpy(&y, &yes, sizeof y), memcpy(&n, &no, sizeof n);
    y = (y & m) | (n & ~m);
    memcpy(&yes, &y, sizeof y);
    return yes;
}

/* What follows from an answer: the next cell or point, or how the ray leaves. */
SGT_INLINE double march_on(slots *s, size_t k, double budget)
{
    double a = s->a[k], b = s->b[k], end = s->end[k], sign = s->sign[k], least = s->least[k],
           asks = s->asks[k], evals = s->evals[k] + 1, w = b - a;
    double g_lo = s->g_lo[k], g_hi = s->g_hi[k];
    const mask cell = MASK(asks == CELL), at_first = MASK(asks == FIRST_POINT), at_last = ~(cell | at_first);
    double lo = either(cell, s->slope_lo[k], s->steep_lo[k]),
           hi = either(cell, s->slope_hi[k], s->steep_hi[k]);
    /* The sign of G.  A NaN says nothing. */
    const mask above = MASK(g_lo > 0) & MASK(g_lo <= g_hi), below = MASK(g_hi < 0) & MASK(g_lo <= g_hi),
               decided = above | below, nowhere = MASK(g_lo > g_hi) & cell;
    double here = either(above, 1, either(below, -1, 0)), size = either(above, g_lo, -g_hi);
    double known = either(at_first, here, sign);    /* the sign at a, 0: not known */
    double down = either(MASK(known < 0), hi, -lo); /* |g| falls at most so fast */
    const mask bounded = MASK(lo > -HUGE_VAL) & MASK(hi < HUGE_VAL) & MASK(lo <= hi),
               monotone = bounded & (MASK(lo > 0) | MASK(hi < 0)), signless = MASK(known == 0),
               rises = monotone & ~signless & MASK(down < 0), falls = monotone & ~signless & MASK(down > 0);
    /* The move by the slope.  2^-10 of `least` is left: the sum of a and `reach` may round by 2^-53 of b. */
    const mask open =
        cell & ~decided & ~nowhere & ~monotone & bounded & ~signless & MASK(least > 0) & MASK(down > 0);
    double reach = either(open, least / down * (1 - 0x1p-10), 0), shrunk = least * 0x1p-11;
    double worth = larger(0x1p-4 * w, 0x1p-40 * larger(fabs(a), fabs(b)));
    const mask through = MASK(reach >= w), moves = ~through & MASK(reach > worth);
    /* what follows */
    const mask same = MASK(here * sign > 0),
               past = (cell & (decided | nowhere)) | (~at_last & rises) | through | (at_last & same),
               to_first = cell & ~past & monotone & signless, to_last = ~at_last & ~past & falls,
               found = at_last & decided & ~same, lost = ~cell & ~decided;
    double flat = either(MASK(lo > 0), lo, -hi); /* |g| changes at least so fast, in a monotone cell */
    const mask points = to_first | to_last,
               begins = at_first & decided & falls & MASK(size < NEAR_START * flat * w);
    double moved = either(moves, reach, 0), next = either(past & ~lost, b, a + moved);
    double held = either(moves | through, shrunk, either(at_first, size, least)),
           behind = either(decided, size, held);
    double new_sign = either(past, either(decided, here, sign), known),
           new_least = either(past, behind, held);
    new_sign = either(nowhere, 0, new_sign), new_least = either(nowhere, 0, new_least);
    /* The next length; all of it is a guess. */
    double side = either(MASK(new_sign != 0), new_sign, either(MASK(g_lo + g_hi > 0), 1, -1));
    double middle = 0.5 * (g_lo + g_hi) * side, slope = 0.5 * (lo + hi) * side, per = 1 / w,
           wide = (g_hi - g_lo) * per, bend = (hi - lo) * per, half = 0.5 * slope * w;
    double start = middle + either(past, half, slope * moved - half);
    start = either(MASK(start > new_least), start, new_least);
    double clears = 2.2 * start / (wide - slope), to_root = start / -slope, one_way = fabs(slope) / bend;
    double falling =
        either(MASK(bend * to_root < -1.5 * slope) & MASK(1.6 * to_root > one_way), 1.6 * to_root, one_way);
    double length = either(MASK(slope < 0), falling, 1.5 * one_way), left = w - moved;
    length = either(MASK(length > clears), length, clears);
    double shortest = either(past, 0.3 * w, 0.1 * left), longest = either(past, 4 * w, 0.5 * left);
    length = either(MASK(length > shortest), length, shortest); /* of a NaN, too */
    length = either(MASK(length < longest), length, longest);
    /* behind a point: as far as Newton's step tells, and not shorter than the cell before */
    double ahead = 1.6 * middle / -slope;
    ahead = either(MASK(ahead > w), ahead, w), ahead = either(MASK(ahead < 4 * w), ahead, 4 * w);
    length = either(cell, length, either(at_last, ahead, w));
    double stop = either(MASK(next + 1.125 * length < end), next + length, end);
    stop = either(points | found | lost, b, stop);
    /* how the ray leaves */
    const mask gone = past & MASK(next >= end),
               fine = MASK(stop - next > 0x1p-44 * larger(fabs(next), fabs(stop)));
    double leave = either(fine & MASK(evals < budget) & ~lost, STAYS, GIVEN_UP);
    leave = either(found, BRACKET, either(gone & ~lost, PASSED, leave));
    leave = either((lost & at_first) | (begins & MASK(leave == STAYS)), STARTED, leave);
    s->a[k] = next, s->b[k] = stop, s->sign[k] = new_sign, s->least[k] = new_least, s->evals[k] = evals;
    s->asks[k] = either(to_first, FIRST_POINT, either(to_last, LAST_POINT, CELL));
    s->steep_lo[k] = lo, s->steep_hi[k] = hi;
    s->t_lo[k] = either(to_last, b, next), s->t_hi[k] = either(to_first, a, stop);
    s->leave[k] = leave;
    return leave;
}

/* Returns 0 if no ray leaves. */
SGT_KERNEL
static double march_all(slots *s, size_t n, double budget)
{
    double leaving = 0;
#pragma omp simd reduction(+ : leaving)
    for (size_t k = 0; k < n; k++) leaving += march_on(s, k, budget);
    return leaving;
}

/* The watcher of the only ray is told of a cell, or of a point; before the march goes on. */
static void tell_enclosure(cell_search *j, sgt_move move, double t_lo, double t_hi, double g_lo, double g_hi,
                           double slope_lo, double slope_hi)
{
    if (!j->told || j->told->stopped) return;
    tell_cell(j->told, move, t_lo, t_hi, (sgt_interval){g_lo, g_hi}, (sgt_interval){slope_lo, slope_hi});
}

/* ------------------------------------------------------------------------- a root */

/* From a point near b: Newton's step from there. */
SGT_INLINE void meeting_begin(meetings *s, size_t k)
{
    sgt_vec3 d = {s->d[0][k], s->d[1][k], s->d[2][k]};
    double scale = scale_of(d), inverse = inverse_of_scale(d), a = s->a[k], b = s->b[k];
    double g = 0.5 * (s->g_lo[k] + s->g_hi[k]), slope = 0.5 * (s->slope_lo[k] + s->slope_hi[k]);
    double t = b - g / slope, middle = 0.5 * a + 0.5 * b;
    bool inside = (t > a) & (t < b);
    double step = inside ? b - t : 0; /* 0: nothing is known of how steps shrink */
    t = inside ? t : middle;
    double l = d.x * scale, m = d.y * scale, n = d.z * scale, t0 = t * inverse;
    s->noise[k] = s->g_hi[k] - s->g_lo[k];
    s->scale[k] = scale, s->inverse[k] = inverse, s->l[k] = l, s->m[k] = m, s->n[k] = n, s->t0[k] = t0;
    double x = moved_along(s->o[0][k], t0, l), y = moved_along(s->o[1][k], t0, m),
           z = moved_along(s->o[2][k], t0, n);
    s->x[k] = x, s->y[k] = y, s->z[k] = z;
    s->px[k] = x, s->py[k] = y, s->pz[k] = z;
    s->tau[k] = 0, s->lo[k] = a * inverse - t0, s->hi[k] = b * inverse - t0;
    s->last[k] = step * inverse, s->asks[k] = 1;
}

SGT_KERNEL
static void meetings_begin(meetings *s, size_t n)
{
    LANES for (size_t k = 0; k < n; k++) meeting_begin(s, k);
}

/* The terms of the gradient at the point asked for. */
SGT_INLINE double terms_of(const meetings *s, size_t k)
{
    return fabs(s->px[k] * s->fx[k]) + fabs(s->py[k] * s->fy[k]) + fabs(s->pz[k] * s->fz[k]);
}

/* One step of Newton's, in a bracket that shrinks.  It is the last one if the next is below the rounding of
 * t, as far as the last two tell. */
SGT_INLINE double meeting_step(meetings *s, size_t k)
{
    double tau = s->tau[k], f = s->f[k], asks = s->asks[k], lo = s->lo[k], hi = s->hi[k], last = s->last[k],
           l = s->l[k], m = s->m[k], n = s->n[k];
    double slope = s->fx[k] * l + s->fy[k] * m + s->fz[k] * n, sign = s->sign[k];
    sign = sign == 0 ? -slope : sign; /* not known, in a stretch in which the sign of the slope is */
    double side = f * sign;
    lo = side > 0 ? tau : lo, hi = side > 0 ? hi : tau;
    double next = tau - f / slope, middle = 0.5 * (lo + hi);
    next = ((next >= lo) & (next <= hi)) ? next : middle;
    double size = fabs(next - tau), ratio = size / last, fine = 0x1p-53 * larger(fabs(s->t0[k]), fabs(tau)),
           left = size * (ratio * ratio);
    double more = ((left > fine) & (size > 0)) ? 1.0 : 0.0;
    bool on = asks != 0;
    tau = on ? next : tau;
    s->evals[k] += asks;
    s->asks[k] = on ? more : 0;
    s->tau[k] = tau, s->lo[k] = lo, s->hi[k] = hi, s->last[k] = on ? size : last;
    /* one that waits for others is asked again, elsewhere */
    s->steep[k] = on ? slope : s->steep[k];
    s->terms[k] = on ? terms_of(s, k) : s->terms[k];
    s->px[k] = s->x[k] + tau * l, s->py[k] = s->y[k] + tau * m, s->pz[k] = s->z[k] + tau * n;
    return on ? more : 0;
}

SGT_KERNEL
static double meetings_step(meetings *s, size_t n)
{
    double more = 0;
#pragma omp simd reduction(+ : more)
    for (size_t k = 0; k < n; k++) more += meeting_step(s, k);
    return more;
}

/* The point t and the interval X about it, wider than what rounding of F leaves of the root.  The enclosures
 * of a built-in surface are sharper than `value`: own.  That rounds by a few ulps of the terms of its
 * gradient. */
SGT_INLINE void meeting_ask(meetings *s, size_t k, size_t n, bool own)
{
    double t = (s->t0[k] + s->tau[k]) * s->scale[k], steep = fabs(s->steep[k]) * s->inverse[k];
    double noise = own ? s->noise[k] + 0x1p-50 * s->terms[k] : s->noise[k];
    double pad = 8 * noise / steep + 0x1p-49 * fabs(t) + 4 * s->last[k] * s->scale[k] * 0x1p-20;
    double whole = s->b[k] - s->a[k];
    pad = pad < whole ? pad : whole; /* NaN, too */
    s->t_lo[k] = s->t_hi[k] = t, s->t_lo[n + k] = t - pad, s->t_hi[n + k] = t + pad;
    for (int c = 0; c < 3; c++) s->o[c][n + k] = s->o[c][k], s->d[c][n + k] = s->d[c][k];
}

SGT_KERNEL
static void meetings_ask(meetings *s, size_t n, bool own)
{
    if (own) {
        LANES for (size_t k = 0; k < n; k++) meeting_ask(s, k, n, true);
    } else {
        LANES for (size_t k = 0; k < n; k++) meeting_ask(s, k, n, false);
    }
}

/* t - G / S, about t: is it inside X, and in the bracket? */
SGT_INLINE void meeting_certify(meetings *s, size_t k, size_t n)
{
    double t = s->t_lo[k], g_lo = s->g_lo[k], g_hi = s->g_hi[k], lo = s->slope_lo[n + k],
           hi = s->slope_hi[n + k];
    double q = g_lo / lo, r = g_lo / hi, u = g_hi / lo, v = g_hi / hi, up = 1 + 0x1p-50;
    double least = -larger(larger(-q, -r), larger(-u, -v)), most = larger(larger(q, r), larger(u, v));
    double from = -most - (0x1p-51 * fabs(most) + DBL_MIN), to = -least + (0x1p-51 * fabs(least) + DBL_MIN);
    double before = larger(t - s->t_lo[n + k], 0), behind = larger(s->t_hi[n + k] - t, 0), in = 1 - 0x1p-40;
    bool monotone = (lo > -HUGE_VAL) & (hi < HUGE_VAL) & (lo <= hi) & ((lo > 0) | (hi < 0)),
         inside = (-from < before * in) & (to < behind * in) & (-from <= (t - s->a[k]) * in) &
                  (to <= (s->b[k] - t) * in) & (g_lo <= g_hi);
    double shift = 0.5 * from + 0.5 * to, inverse = s->inverse[k];
    double t0 = t * inverse, tau = shift * inverse;
    s->noise[k] = g_hi - g_lo;
    s->steep[k] = (lo > 0 ? lo : -hi) * s->scale[k];
    s->room[k] = (before < behind ? before : behind) * in;
    s->tau_err[k] = (larger(to - shift, shift - from) * up + DBL_MIN) * inverse;
    s->good[k] = (inside & monotone & (s->asks[k] == 0)) ? 1.0 : 0.0;
    s->t0[k] = t0, s->tau[k] = tau;
    double x = moved_along(s->o[0][k], t0, s->l[k]), y = moved_along(s->o[1][k], t0, s->m[k]),
           z = moved_along(s->o[2][k], t0, s->n[k]);
    s->x[k] = x, s->y[k] = y, s->z[k] = z;
    s->px[k] = x + tau * s->l[k], s->py[k] = y + tau * s->m[k], s->pz[k] = z + tau * s->n[k];
    s->evals[k] += 3; /* the two, and F at the point */
}

SGT_KERNEL
static void meetings_certify(meetings *s, size_t n)
{
    LANES for (size_t k = 0; k < n; k++) meeting_certify(s, k, n);
}

/* Is the root accepted, by a wide margin?  The terms of the rule of the start are those of the gradient as
 * computed.  Rounding moves them by a part of what it does to F, times the degree: 64 of that. */
SGT_INLINE void meeting_take(meetings *s, size_t k)
{
    local q = {.x = s->x[k], .y = s->y[k], .z = s->z[k], .l = s->l[k], .m = s->m[k], .n = s->n[k],
               .t0 = s->t0[k], .scale = s->scale[k]};
    sgt_vec3 p = {s->px[k], s->py[k], s->pz[k]}, grad = {s->fx[k], s->fy[k], s->fz[k]};
    double tau = s->tau[k], tau_err = s->tau_err[k], noise = s->noise[k], tmin = s->tmin[k];
    around at = around_of(&q, tau, p, grad, 0);
    acceptance h = acceptance_of(&q, tau, tau_err, at, (limits){tmin, s->tmax[k], HUGE_VAL, END_ERRORS});
    double terms = fabs(p.x * grad.x) + fabs(p.y * grad.y) + fabs(p.z * grad.z) + 64 * noise,
           width = START_ULPS * terms / s->steep[k] * q.scale + 8 * SGT_U * fabs(h.t);
    bool away = (tmin == -HUGE_VAL) | (h.t - tmin > DOUBT * (width + h.t_err)),
         same = fabs(s->f[k]) <= 0x1p10 * (noise + at.place),
         unique = fabs(h.t - s->t_lo[k]) + h.t_err < s->room[k];
    bool good = h.accepted & away & same & unique & (s->good[k] != 0) & (h.p_err < HUGE_VAL);
    s->t[k] = h.t, s->t_err[k] = h.t_err, s->t_over[k] = h.t_lo, s->p_err[k] = h.p_err;
    s->good[k] = good ? 1.0 : 0.0;
}

SGT_KERNEL
static void meetings_take(meetings *s, size_t n) { LANES for (size_t k = 0; k < n; k++) meeting_take(s, k); }

static void value_all(const cell_search *j, meetings *s, size_t n)
{
    values_of(j->s, n, (sgt_points){{s->px, s->py, s->pz}}, (sgt_values){s->f, {s->fx, s->fy, s->fz}});
}

/* The watcher of the only ray is told of F at the point asked for, t0 + tau. */
static void tell_value(cell_search *j, const meetings *s, sgt_move move)
{
    if (!j->told || j->told->stopped) return;
    double slope = s->fx[0] * s->l[0] + s->fy[0] * s->m[0] + s->fz[0] * s->n[0];
    tell(j->told, move, (s->t0[0] + s->tau[0]) * s->scale[0], s->f[0], slope * s->inverse[0], s->a[0],
         s->b[0]);
}

/* Answers all brackets there are. */
static void meet(cell_search *j)
{
    meetings *s = j->meetings;
    const size_t n = s->count;
    double more = 1;
    s->count = 0;
    meetings_begin(s, n);
    for (int i = 0; i < NEWTON_STEPS && more > 0; i++) {
        value_all(j, s, n);
        tell_value(j, s, SGT_NEWTON);
        more = meetings_step(s, n);
    }
    meetings_ask(s, n, j->own);
    sgt_rays rays = {{s->o[0], s->o[1], s->o[2]}, {s->d[0], s->d[1], s->d[2]}, NULL, NULL};
    j->encloses(j->s.self, 2 * n, rays, s->t_lo, s->t_hi,
                (sgt_enclosures){s->g_lo, s->g_hi, s->slope_lo, s->slope_hi});
    for (size_t i = 0; j->told && i < 2; i++)
        tell_enclosure(j, SGT_PROBE, s->t_lo[i], s->t_hi[i], s->g_lo[i], s->g_hi[i], s->slope_lo[i],
                       s->slope_hi[i]);
    meetings_certify(s, n);
    value_all(j, s, n);
    if (j->own) {
        double own[MEETINGS];
        round_own(j, n, (sgt_points){{s->px, s->py, s->pz}}, s->f, own);
        for (size_t k = 0; k < n; k++) s->noise[k] += own[k];
    }
    tell_value(j, s, SGT_PROBE);
    meetings_take(s, n);
    j->f = s->f[0];
    for (size_t k = 0; k < n; k++) {
        size_t i = (size_t)s->ray[k];
        if (!(s->good[k] != 0)) {
            leave_hard(j, i, s->evals[k]);
            continue;
        }
        sgt_hit hit = {.status = SGT_HIT,
                       .evals = (int)s->evals[k],
                       .t = s->t[k],
                       .t_err = s->t_err[k],
                       .t_lo = s->t_over[k],
                       .p = {s->px[k], s->py[k], s->pz[k]},
                       .n = {s->fx[k], s->fy[k], s->fz[k]},
                       .p_err = s->p_err[k]};
        put_hit(&j->tile->hits, i, &hit);
    }
}

/* A bracket [a, b] on ray i; the first of the meetings' rows that are not set by others. */
static size_t new_meeting(cell_search *j, size_t i, double a, double b)
{
    meetings *m = j->meetings;
    size_t to = m->count++;
    for (int c = 0; c < 3; c++)
        m->o[c][to] = j->tile->rays.o[c][i], m->d[c][to] = j->tile->rays.d[c][i];
    m->a[to] = a, m->b[to] = b, m->sign[to] = m->evals[to] = 0;
    m->ray[to] = (double)i, m->tmin[to] = j->tile->rays.tmin[i], m->tmax[to] = j->tile->rays.tmax[i];
    return to;
}

/* Slot k has a bracket, and G at its far end. */
static void add_meeting(cell_search *j, size_t k)
{
    const slots *s = j->slots;
    meetings *m = j->meetings;
    size_t to = new_meeting(j, (size_t)s->ray[k], s->a[k], s->b[k]);
    m->sign[to] = s->sign[k], m->evals[to] = s->evals[k];
    m->g_lo[to] = s->g_lo[k], m->g_hi[to] = s->g_hi[k], m->slope_lo[to] = s->slope_lo[k],
    m->slope_hi[to] = s->slope_hi[k];
    if (m->count == MEETINGS) meet(j);
}

/* Ray i has a stretch with one root at most, and the seed is near it.  With this G and S at the far end
 * Newton's steps begin there. */
static void refine_seed(cell_search *j, size_t i, double lo, double hi, double seed)
{
    meetings *m = j->meetings;
    size_t to = new_meeting(j, i, lo, hi);
    m->g_lo[to] = m->g_hi[to] = hi - seed, m->slope_lo[to] = m->slope_hi[to] = 1;
    if (m->count == MEETINGS) meet(j);
}

/* ----------------------------------------------------------------------- the stream */

static void move_slot(slots *s, size_t to, size_t from)
{
    double *rows = s->o[0];
    for (size_t r = 0; r < offsetof(slots, count) / (SLOTS * sizeof(double)); r++)
        rows[r * SLOTS + to] = rows[r * SLOTS + from];
}

/* G at the start, the near end of a monotone cell, has 0 in it, or |g| falls to 0 just behind (THE START).
 * The march goes on, behind the cell or in a shorter one, or as it would have, or the ray is given up.
 * f, n: F and its gradient at p, the start. */
static void settle_start(slots *s, size_t k, sgt_vec3 p, double f, sgt_vec3 n, double budget)
{
    double a = s->a[k], b = s->b[k], g_lo = s->g_lo[k], g_hi = s->g_hi[k], lo = s->steep_lo[k],
           hi = s->steep_hi[k], w = b - a, flat = lo > 0 ? lo : -hi, steep = lo > 0 ? hi : -lo,
           noise = g_hi - g_lo, last = (lo > 0 ? -g_lo : g_hi) / flat; /* no root of the cell is behind it */
    double terms = fabs(p.x * n.x) + fabs(p.y * n.y) + fabs(p.z * n.z) - 64 * noise,
           slope = fabs(n.x * s->d[0][k] + n.y * s->d[1][k] + n.z * s->d[2][k]);
    slope = slope < flat ? flat : slope > steep ? steep : slope; /* of a NaN: NaN */
    double reach = START_ULPS * terms / slope, evals = s->evals[k] + 1,
           most = larger(fabs(s->d[0][k]), larger(fabs(s->d[1][k]), fabs(s->d[2][k])));
    bool near = 0.5 * noise / flat <= 16 * reach && fabs(f) <= 0.5 * reach * slope + 0.125 * noise,
         open = !(g_lo > 0 || g_hi < 0), /* the sign there is not known */
         start = g_lo <= g_hi && last < 0.25 * w && (near || last * most <= START_LEAST),
         shorter = !start && flat < 0.25 * steep && 0.125 * w > 0x1p-40 * fabs(a) && evals < budget;
    s->evals[k] = evals;
    if (!open && !start) {
        s->leave[k] = evals < budget ? STAYS : GIVEN_UP;
        return;
    }
    if (start) s->a[k] = b, s->sign[k] = lo > 0 ? 1 : -1, s->least[k] = 0.5 * flat * w;
    double next = start ? b + 2 * w : a + 0.125 * w;
    s->b[k] = next < s->end[k] ? next : s->end[k];
    s->t_lo[k] = s->a[k], s->t_hi[k] = s->b[k], s->asks[k] = CELL;
    s->leave[k] = !(start || shorter) ? GIVEN_UP : s->a[k] < s->end[k] ? STAYS : PASSED;
}

/* Settles the starts of all slots that ask for it. */
static void settle_starts(cell_search *j)
{
    slots *s = j->slots;
    size_t at[SLOTS], n = 0;
    double p[3][SLOTS], f[SLOTS], grad[3][SLOTS];
    for (size_t k = 0; k < s->count; k++) {
        if (s->leave[k] != STARTED) continue;
        s->leave[k] = !j->own && (s->g_lo[k] > 0 || s->g_hi[k] < 0) ? STAYS : GIVEN_UP;
        if (j->own) continue;
        if (s->a[k] != j->tile->rays.tmin[(size_t)s->ray[k]]) continue; /* not the start,
            but that of a span */
        for (int c = 0; c < 3; c++) p[c][n] = moved_along(s->o[c][k], s->a[k], s->d[c][k]);
        at[n++] = k;
    }
    if (n > 0)
        values_of(j->s, n, (sgt_points){{p[0], p[1], p[2]}}, (sgt_values){f, {grad[0], grad[1], grad[2]}});
    for (size_t i = 0; i < n; i++) {
        sgt_vec3 d = {s->d[0][at[i]], s->d[1][at[i]], s->d[2][at[i]]}, n_i = {grad[0][i], grad[1][i],
                                                                              grad[2][i]};
        if (j->told && !j->told->stopped)
            tell(j->told, SGT_PROBE, s->a[at[i]], f[i], n_i.x * d.x + n_i.y * d.y + n_i.z * d.z, s->a[at[i]],
                 s->b[at[i]]);
        settle_start(s, at[i], (sgt_vec3){p[0][i], p[1][i], p[2][i]}, f[i], n_i, j->budget);
    }
}

static void answer_slot(cell_search *j, size_t k)
{
    const slots *s = j->slots;
    size_t i = (size_t)s->ray[k];
    if (s->leave[k] == PASSED)
        give(j, i, SGT_MISS, s->evals[k]);
    else if (s->leave[k] == BRACKET)
        add_meeting(j, k);
    else
        leave_hard(j, i, s->evals[k]);
}

static void stream_rays(cell_search *j)
{
    slots *s = j->slots;
    sgt_rays rays = {{s->o[0], s->o[1], s->o[2]}, {s->d[0], s->d[1], s->d[2]}, NULL, NULL};
    sgt_enclosures out = {s->g_lo, s->g_hi, s->slope_lo, s->slope_hi};
    while (s->count < SLOTS && fill_slot(j, s->count)) s->count++;
    while (s->count > 0 && !(j->told && j->told->stopped)) {
        j->encloses(j->s.self, s->count, rays, s->t_lo, s->t_hi, out);
        if (j->told)
            tell_enclosure(j, s->asks[0] == CELL ? SGT_MARCH : SGT_PROBE, s->t_lo[0], s->t_hi[0], s->g_lo[0],
                           s->g_hi[0], s->slope_lo[0], s->slope_hi[0]);
        if (march_all(s, s->count, j->budget) == 0) continue;
        settle_starts(j);
        for (size_t k = s->count; k-- > 0;) {
            if (s->leave[k] == STAYS) continue;
            answer_slot(j, k);
            if (fill_slot(j, k)) continue;
            s->count--;
            if (k < s->count) move_slot(s, k, s->count);
        }
    }
    if (j->meetings->count > 0 && !(j->told && j->told->stopped)) meet(j);
}

/* ------------------------------------------------------------- public in the library */

/* The cells of one ray: at most half of what it may spend, so that there is something left for answer.c. */
static double budget_of(const sgt_options *opt)
{
    int most = (opt->max_evals ? opt->max_evals : SGT_DEFAULT_EVALS) / 2;
    return most < MOST_CELLS ? most : MOST_CELLS;
}

/* The enclosures that are asked for; NULL: none. */
static sgt_enclose_many *cells_of(const sgt_surface_ops *ops, const sgt_options *opt)
{
    if (ops->own_ && ops->own_->encloses) return opt->proof != SGT_ESTIMATE ? ops->own_->encloses : NULL;
    return ops->first ? NULL : encloses_of(ops);
}

bool sgt_cells_offered(sgt_surface s, const sgt_options *opt)
{
    const sgt_surface_ops *ops = s.ops;
    return parameters_valid(s) && cells_of(ops, opt) && opt->pick != SGT_NEAR_SEED &&
           !(ops->own_ && ops->own_->rim) && !(opt->f_tol > 0) && !(opt->dt_min > 0 && ops->estimate) &&
           budget_of(opt) > 0;
}

static size_t search(cell_search *j)
{
    queue q = {.from = 0};
    slots s;
    meetings m;
    s.count = m.count = 0;
    j->encloses = cells_of(j->s.ops, j->opt), j->own = j->s.ops->own_ && j->s.ops->own_->encloses;
    j->budget = budget_of(j->opt),
    j->proof = j->opt->proof != SGT_ESTIMATE;
    j->queue = &q, j->slots = &s, j->meetings = &m;
    stream_rays(j);
    j->queue = NULL, j->slots = NULL, j->meetings = NULL;
    return j->hard;
}

size_t sgt_cells_tile(sgt_surface s, const sgt_tile *tile, const sgt_options *opt)
{
    cell_search j = {.s = s, .opt = opt, .tile = tile};
    return search(&j);
}

bool sgt_cells_first(sgt_surface s, const sgt_ray *ray, const sgt_options *opt, sgt_hit *hit)
{
    sgt_status status = SGT_HARD;
    int evals = 0;
    meeting a = {.t = (double)NAN};
    sgt_tile tile = {.n = 1,
                     .rays = rays_of(ray),
                     .hits = {.status = &status,
                              .evals = &evals,
                              .t = &a.t,
                              .t_err = &a.t_err,
                              .t_lo = &a.t_lo,
                              .p = {&a.p.x, &a.p.y, &a.p.z},
                              .n = {&a.n.x, &a.n.y, &a.n.z},
                              .p_err = &a.p_err}};
    tally told = {.opt = opt, .budget = 0};
    cell_search j = {.s = s, .opt = opt, .tile = &tile, .told = opt->watch ? &told : NULL};
    search(&j);
    if (told.stopped) {
        *hit = hit_without(SGT_STOPPED, ray, told.evals);
        return true;
    }
    *hit = hit_without(SGT_MISS, ray, evals);
    if (status == SGT_HIT) *hit = hit_found(SGT_HIT, evals, j.f, &a);
    return status == SGT_HIT || status == SGT_MISS;
}
