// SPDX-License-Identifier: MIT
/* aim_batch.c - rays of a beam through many wanted points (aim.h).
 *
 * NEWTON'S STEPS FROM THE FIRST START lead straight to most points.  So the rays of a tile take them
 * together: sgt_trace_batch traces them, sgt_trace_sensitivity_batch differentiates, and what one ray does
 * with that (aim.c) is done with each.  Those that have arrived, or cannot be made better, wait for the
 * others.  At the end all are traced once more, for their passages, and sgt_trace_error_batch says how far
 * off they may be.
 *
 * THE SAME BITS as sgt_aim.  A ray that would do anything else there leaves the tile: a step to an edge, a
 * step that is halved or damped, a ray that does not get there, derivatives that are not known, an end that
 * is not at the point.  sgt_aim answers it, from the beginning.  A ray that is clipped on its way goes on by
 * itself (sgt_aim_trace), and stays in the tile.
 *
 * THE PASSAGES of the caller are the room.  Every tile works at their beginning, and its results are moved to
 * their place.  So the last tile is the first to be worked on. */
#include "aim.h"

#include <string.h>

enum { POINTS = 64, ROUNDS = 30 };
typedef double aim_row[POINTS];

/* Its search goes on; it cannot be made better; sgt_aim is to answer. */
typedef enum aim_state { AIM_MOVES, AIM_RESTS, AIM_LEFT } aim_state;

/* The best ray of a point so far. */
typedef struct aim_best {
    double u, v, x, y, miss, steep; /* steep: as in aim_search (aim.c) */
    size_t clipped;
    int traces;
    aim_state state;
    bool small, last; /* the step that is tried is small; the last ray is the best one */
} aim_best;

typedef struct aim_tile {
    aim_task task;          /* of the point that is looked at */
    const sgt_vec2 *wanted; /* of the tile's points */
    const sgt_passages *passages;
    sgt_passage *room;
    double wide[2], tol;
    int most;
    size_t n; /* its points */
    aim_best best[POINTS];
    size_t count;             /* the rays below, */
    unsigned char of[POINTS]; /* and the points that they are of */
    aim_row u, v, ox, oy, oz, dx, dy, dz;
    sgt_fate fate[POINTS];
    size_t clipped[POINTS]; /* by which element first; stop + 1: by none */
} aim_tile;

static sgt_ray tile_ray(const aim_tile *w, size_t k)
{
    return (sgt_ray){.o = {w->ox[k], w->oy[k], w->oz[k]}, .d = {w->dx[k], w->dy[k], w->dz[k]}};
}

static sgt_traces traces_in(const aim_tile *w)
{
    return (sgt_traces){w->count, {.o = {w->ox, w->oy, w->oz}, .d = {w->dx, w->dy, w->dz}}, w->passages};
}

/* Adds the ray at (u, v), moved into the box, to those that are to be traced. */
static void add_ray(aim_tile *w, size_t point, double u, double v)
{
    const size_t k = w->count++;
    const sgt_beam *beam = w->task.beam;
    u = aim_within(u, beam->u), v = aim_within(v, beam->v);
    const sgt_ray ray = sgt_beam_ray(beam, u, v);
    w->of[k] = (unsigned char)point, w->u[k] = u, w->v[k] = v;
    w->ox[k] = ray.o.x, w->oy[k] = ray.o.y, w->oz[k] = ray.o.z;
    w->dx[k] = ray.d.x, w->dy[k] = ray.d.y, w->dz[k] = ray.d.z;
}

/* Traces the rays, and goes on with those that are clipped on their way.  fate: SGT_PASSED, they get there.
 */
static void trace_rays(aim_tile *w)
{
    const aim_task *task = &w->task;
    const size_t all = task->stop + 1;
    const sgt_traced out = {.fate = w->fate};
    const sgt_options options = {.pick = SGT_NEAR_SEED};
    const sgt_rays rays = traces_in(w).rays;
    sgt_trace_batch(all, task->e, task->index_before, w->count, rays, out, w->passages, &options);
    for (size_t k = 0; k < w->count; k++) {
        w->clipped[k] = all;
        if (w->fate[k] == SGT_PASSED) continue;
        const sgt_ray ray = tile_ray(w, k);
        sgt_fate fate;
        size_t element;
        const bool there = sgt_aim_trace(task, &ray, &fate, &element, &w->clipped[k]);
        w->fate[k] = there ? SGT_PASSED : SGT_LOST;
        for (size_t i = 0; there && i < all; i++) tell_passage(&w->passages[i], k, &w->room[i]);
    }
}

/* The miss of ray k. */
static double miss_of(const aim_tile *w, size_t k, sgt_vec2 *f)
{
    const sgt_hits *last = &w->passages[w->task.stop].hits;
    const sgt_vec2 wanted = w->wanted[w->of[k]];
    *f = (sgt_vec2){last->p[0][k] - wanted.x, last->p[1][k] - wanted.y};
    return sqrt(f->x * f->x + f->y * f->y);
}

/* Takes ray k for the best of its point if it is better, or the first. */
static void take_ray(aim_tile *w, size_t k, bool first)
{
    aim_best *b = &w->best[w->of[k]];
    sgt_vec2 f;
    const double miss = miss_of(w, k, &f);
    const bool moved = first || w->u[k] != b->u || w->v[k] != b->v;
    b->traces++;
    b->last = moved && (first || aim_is_less(miss, b->miss, 1));
    if (w->fate[k] != SGT_PASSED || !(miss < HUGE_VAL))
        b->state = AIM_LEFT;
    else if (!b->last)
        b->state = b->small ? AIM_RESTS : AIM_LEFT;
    else {
        b->u = w->u[k], b->v = w->v[k], b->x = f.x, b->y = f.y, b->miss = miss, b->clipped = w->clipped[k];
        if (aim_is_enough(miss, w->tol, b->steep)) b->state = AIM_RESTS;
    }
}

/* The derivatives of x and y by u and by v. */
typedef struct aim_derivatives {
    aim_row p[2][3];
} aim_derivatives;

SGT_NOINLINE static void differentiate(const aim_tile *w, aim_derivatives *out)
{
    const sgt_beam *b = w->task.beam;
    aim_row column[2][6];
    sgt_ray_changes change[2] = {{.opl = NULL}, {.opl = NULL}}, end[2] = {{.opl = NULL}, {.opl = NULL}};
    for (int j = 0; j < 2; j++) {
        const sgt_ray_change c =
            j ? aim_change(w->wide[1], b->ov, b->dv) : aim_change(w->wide[0], b->ou, b->du);
        const double of[6] = {c.p.x, c.p.y, c.p.z, c.d.x, c.d.y, c.d.z};
        for (int i = 0; i < 6; i++)
            for (size_t k = 0; k < w->count; k++) column[j][i][k] = of[i];
        for (int i = 0; i < 3; i++)
            change[j].p[i] = column[j][i], change[j].d[i] = column[j][3 + i], end[j].p[i] = out->p[j][i];
    }
    const sgt_traces traces = traces_in(w);
    sgt_trace_sensitivity_batch(w->task.stop + 1, w->task.e, w->task.index_before, &traces, 2, change, end);
}

/* Newton's step of ray k, which is the best one of its point. */
static void step_ray(aim_tile *w, size_t k, const aim_derivatives *by)
{
    const sgt_beam *beam = w->task.beam;
    aim_best *b = &w->best[w->of[k]];
    const aim_slopes j = {{by->p[0][0][k], by->p[1][0][k]}, {by->p[0][1][k], by->p[1][1][k]}};
    const double size = aim_size(&j);
    const sgt_ray ray = tile_ray(w, k);
    const sgt_vec2 step = aim_step(&j, (sgt_vec2){b->x, b->y}, 0, false, false);
    const double u = b->u + step.x * w->wide[0], v = b->v + step.y * w->wide[1];
    b->steep = aim_steep(beam, w->wide[0], &ray, size), b->small = aim_is_small(step);
    if (!(size < HUGE_VAL) || goes_out(b->u, beam->u, step.x) || goes_out(b->v, beam->v, step.y) ||
        !(fabs(u) < HUGE_VAL && fabs(v) < HUGE_VAL) || b->traces + 2 > w->most)
        b->state = AIM_LEFT;
    else
        add_ray(w, w->of[k], u, v); /* to a place that has been read */
}

/* Is what differs from point to point as it has to be? */
static bool is_question(sgt_vec2 wanted, const sgt_aim_options *opt)
{
    bool fine = isfinite(wanted.x) && isfinite(wanted.y);
    for (size_t i = 0; i < opt->starts; i++)
        fine = fine && isfinite(opt->start[i].x) && isfinite(opt->start[i].y);
    return fine;
}

/* Takes the steps of all points together, until none moves any more. */
static void move_all(aim_tile *w, const sgt_aim_options *opt)
{
    aim_derivatives by;
    w->count = 0;
    for (size_t i = 0; i < w->n; i++) {
        sgt_aim_options own = *opt;
        if (own.starts) own.start += i * own.starts;
        const sgt_vec2 from = sgt_aim_start(&w->task, &own, 0);
        w->best[i] = (aim_best){.state = AIM_MOVES};
        if (is_question(w->wanted[i], &own))
            add_ray(w, i, from.x, from.y);
        else
            w->best[i].state = AIM_LEFT;
    }
    for (int round = 0; w->count; round++) {
        size_t still = 0;
        trace_rays(w);
        for (size_t k = 0; k < w->count; k++) {
            take_ray(w, k, round == 0);
            still += w->best[w->of[k]].state == AIM_MOVES;
        }
        if (still == 0) return;
        differentiate(w, &by);
        const size_t count = w->count;
        w->count = 0;
        for (size_t k = 0; k < count; k++) {
            if (w->best[w->of[k]].state != AIM_MOVES) continue;
            if (round < ROUNDS)
                step_ray(w, k, &by);
            else
                w->best[w->of[k]].state = AIM_LEFT;
        }
    }
}

/* Makes the passages those of the best rays of the points that have not left, one after the other. */
static void trace_best(aim_tile *w)
{
    bool there = w->count == w->n;
    for (size_t i = 0; i < w->n; i++) {
        aim_best *b = &w->best[i];
        there = there && b->state == AIM_RESTS && b->last;
        if (b->state == AIM_RESTS && !b->last) b->traces++;
    }
    if (there) return; /* they are */
    w->count = 0;
    for (size_t i = 0; i < w->n; i++)
        if (w->best[i].state == AIM_RESTS) add_ray(w, i, w->best[i].u, w->best[i].v);
    if (w->count) trace_rays(w);
}

/* Moves number k of an array to number i. */
#define MOVED(array) ((array) ? (void)((array)[i] = (array)[k]) : (void)0)
static void move_passages(const aim_tile *w, size_t k, size_t i)
{
    for (size_t j = 0; i != k && j <= w->task.stop; j++) {
        const sgt_passages *p = &w->passages[j];
        MOVED(p->hits.status), MOVED(p->hits.evals), MOVED(p->hits.t), MOVED(p->hits.t_err);
        MOVED(p->hits.t_lo), MOVED(p->hits.p_err), MOVED(p->opl);
        for (int x = 0; x < 3; x++) MOVED(p->hits.p[x]), MOVED(p->hits.n[x]), MOVED(p->direction[x]);
    }
}

/* The answer for ray k of point i, whose error is known; false: it is not there. */
static bool tell_ray(const aim_tile *w, size_t k, double error, double grain, sgt_attempt *attempt,
                     sgt_aiming *out)
{
    const aim_best *b = &w->best[w->of[k]];
    const sgt_hits *last = &w->passages[w->task.stop].hits;
    if (!(error + grain < HUGE_VAL) || !(b->miss <= w->tol || b->miss <= AIM_NOISE * (error + grain)))
        return false;
    *out = (sgt_aiming){.status = SGT_MET,
                        .u = b->u,
                        .v = b->v,
                        .ray = tile_ray(w, k),
                        .point = {last->p[0][k], last->p[1][k]},
                        .miss = aim_told_miss(b->miss, error),
                        .clipped = b->clipped,
                        .attempts = 1,
                        .traces = b->traces};
    if (attempt) {
        const sgt_vec2 to = {b->u, b->v};
        *attempt = (sgt_attempt){.from = attempt->from,
                                 .to = to,
                                 .miss = b->miss,
                                 .reason = SGT_AIM_ARRIVED,
                                 .fate = SGT_PASSED,
                                 .traces = b->traces};
    }
    return true;
}

/* What sgt_aim says of a point. */
static sgt_aimed ask_alone(const aim_tile *w, size_t i, size_t at, const sgt_aim_options *opt,
                           sgt_aiming *out)
{
    const sgt_passage nothing = sgt_not_met(SGT_MISS);
    sgt_aim_options own = *opt;
    const aim_task *t = &w->task;
    if (own.starts) own.start += i * own.starts;
    if (own.attempt) own.attempt += i * own.room;
    const sgt_aimed status =
        sgt_aim(t->stop, t->e, t->index_before, t->beam, w->wanted[i], w->room, &own, out);
    for (size_t j = 0; j <= t->stop; j++)
        tell_passage(&w->passages[j], at, status == SGT_MET ? &w->room[j] : &nothing);
    return status;
}

/* The points from `first` on; opt, out: those of the tile. */
static size_t aim_together(aim_tile *w, size_t first, const sgt_aim_options *opt, sgt_aiming out[])
{
    aim_row error, grain;
    sgt_end_errors errors = {.point = error, .grain = grain};
    size_t met = 0;
    move_all(w, opt);
    trace_best(w);
    const sgt_traces traces = traces_in(w);
    if (w->count) sgt_trace_error_batch(w->task.stop + 1, w->task.e, w->task.index_before, &traces, errors);
    for (size_t k = w->count; k-- > 0;) { /* from the last one on: a place is read before it is written */
        const size_t i = w->of[k];
        sgt_aiming own;
        sgt_attempt *attempt = opt->room && opt->attempt ? &opt->attempt[i * opt->room] : NULL;
        sgt_aim_options at = *opt;
        if (at.starts) at.start += i * at.starts;
        if (attempt) attempt->from = sgt_aim_start(&w->task, &at, 0);
        if (!tell_ray(w, k, error[k], grain[k], attempt, &own)) {
            w->best[i].state = AIM_LEFT;
            continue;
        }
        met++;
        move_passages(w, k, first + i);
        if (out) out[i] = own;
    }
    for (size_t i = 0; i < w->n; i++) {
        if (w->best[i].state != AIM_LEFT) continue;
        sgt_aiming own;
        met += ask_alone(w, i, first + i, opt, out ? &out[i] : &own) == SGT_MET;
    }
    return met;
}

size_t sgt_aim_batch(size_t stop, const sgt_element e[], double index_before, const sgt_beam *beam,
                     const sgt_aims *aims, sgt_passage room[], const sgt_aim_options *opt)
{
    const sgt_passages *passages = aims->passages;
    sgt_aiming *const out = aims->out;
    const size_t n = aims->n;
    sgt_aim_options given = opt ? *opt : (sgt_aim_options){0};
    aim_tile w = {.task = {stop, e, index_before, beam, {0, 0}, room},
                  .passages = passages,
                  .room = room,
                  .tol = given.tol,
                  .most = given.max_traces ? given.max_traces : AIM_TRACES};
    for (size_t j = 0; j <= stop; j++) /* asked for what only a later version has: sgt_aim refuses */
        if (!ROOM_IS_ZERO(&passages[j]) || !ROOM_IS_ZERO(&passages[j].hits)) given.reserved_[0] = 1;
    sgt_aim_options common = given;
    size_t met = 0;
    common.starts = 0; /* they differ */
    w.wide[0] = beam->u.hi - beam->u.lo, w.wide[1] = beam->v.hi - beam->v.lo;
    for (size_t tiles = (n + POINTS - 1) / POINTS; tiles-- > 0;) {
        const size_t first = tiles * POINTS;
        sgt_aim_options own = given;
        if (own.starts) own.start += first * own.starts;
        if (own.attempt) own.attempt += first * own.room;
        w.wanted = aims->wanted + first, w.n = n - first < POINTS ? n - first : POINTS;
        if (sgt_aim_sound(&w.task, &common) && !e[stop].phase) {
            met += aim_together(&w, first, &own, out ? out + first : NULL);
            continue;
        }
        for (size_t i = 0; i < w.n; i++) {
            sgt_aiming one;
            met += ask_alone(&w, i, first + i, &own, out ? &out[first + i] : &one) == SGT_MET;
        }
    }
    return met;
}
