// SPDX-License-Identifier: MIT
/* aim.c - the launch ray of a beam that meets a wanted point at the stop (aim.h).
 *
 * Two equations, x(u, v) = X and y(u, v) = Y, in a box.  x and y are smooth where the way of the ray stays
 * the same, and not defined where it stops at a surface.
 *
 * EACH STEP is safeguarded as that of the root search is (solve/root.c): it is never trusted.  With J the
 * derivatives, in units of the box, and f the miss:
 *
 *     Newton's   J s = -f.  In a lens it is nearly linear: 3 to 5 steps from the middle of the box
 *     at an edge of the box, if s goes out of it there, the other parameter alone, by least squares
 *     then       s, s/2, s/4, ...  HALVES times, moved into the box, until |f| is less.  A ray that does
 *                not get to the stop counts as a miss without bound
 *     damped     (J^T J + m I) s = -J^T f for some m, if none of these is good, or J is singular
 *
 * Each accepted step makes |f| less.  So the search ends: at the point, at a minimum that is not 0, at an
 * edge, or with its budget.  It then goes to the next start.
 *
 * ARRIVED.  Rounding puts x and y off by `error`, and the numbers of the ray itself have a grain
 * (aim_bound.c). A miss of AIM_NOISE times both is as good as none.  Newton's steps go on below that, down to
 * half an ulp of the launch ray, or until one of them does not make it less.
 *
 * Many points at a time: aim_batch.c.  The step itself is in aim.h, for both. */
#include "aim.h"

enum { BOXES = 1500, HALVES = 10, STARTS = 12, SCAN = 64 };
enum { FIRST_STARTS = 2, FIRST_SCAN = 8 };
/* A ray of the beam that got to the stop. */
typedef struct aim_ray {
    double u, v;
    sgt_ray ray;
    sgt_vec2 f;
    double miss;
    size_t clipped;
} aim_ray;

typedef struct aim_search {
    const aim_task *task;
    double wide[2], tol; /* the sizes of the box */
    double steep;        /* how far the last derivatives say that an ulp of the launch ray moves its end */
    int traces, most;
    size_t next; /* of the starts */
    int walked;  /* starts of ours whose rays got there */
    sgt_fate fate; /* of the last ray that did not get there */
    size_t element;
} aim_search;

/* ---------------------------------------------------------------------- rays */

sgt_ray sgt_beam_ray(const sgt_beam *b, double u, double v)
{
    sgt_vec3 o = plus_times(plus_times(b->o, u, b->ou), v, b->ov);
    sgt_vec3 d = plus_times(plus_times(b->d, u, b->du), v, b->dv);
    return (sgt_ray){.o = o, .d = d};
}

/* Traces the ray at (u, v), moved into the box.  false: it does not get there. */
static bool aim_at(aim_search *s, double u, double v, aim_ray *r)
{
    const aim_task *task = s->task;
    sgt_fate fate;
    size_t element;
    r->u = aim_within(u, task->beam->u), r->v = aim_within(v, task->beam->v);
    r->ray = sgt_beam_ray(task->beam, r->u, r->v);
    s->traces++;
    if (!sgt_aim_trace(task, &r->ray, &fate, &element, &r->clipped)) {
        s->fate = fate, s->element = element;
        return false;
    }
    sgt_vec3 p = task->passages[task->stop].hit.p;
    r->f = (sgt_vec2){p.x - task->wanted.x, p.y - task->wanted.y};
    r->miss = sqrt(r->f.x * r->f.x + r->f.y * r->f.y);
    return r->miss < HUGE_VAL;
}

/* ----------------------------------------------------------------- derivatives */

/* By differences, where a surface has no second derivatives.  false: a ray beside it does not get there. */
static bool aim_differences(aim_search *s, const aim_ray *r, aim_slopes *j)
{
    for (int k = 0; k < 2; k++) {
        double h = 0x1p-20, u = r->u, v = r->v;
        const sgt_interval box = k == 0 ? s->task->beam->u : s->task->beam->v;
        if ((k == 0 ? u : v) > 0.5 * box.lo + 0.5 * box.hi) h = -h;
        aim_ray other;
        j->x[k] = j->y[k] = 0;
        if (s->wide[k] == 0) continue;
        if (!aim_at(s, k == 0 ? u + h * s->wide[0] : u, k == 1 ? v + h * s->wide[1] : v, &other))
            return false;
        j->x[k] = (other.f.x - r->f.x) / h, j->y[k] = (other.f.y - r->f.y) / h;
    }
    return true;
}

/* Derivatives of the point at the stop.  What the stop does to light has no say in it: it is traced alone and
 * without its phase, from where the ray left the element in front. */
static void aim_sensitivity(const aim_task *t, const sgt_ray *launch, sgt_ray_change c[2])
{
    const size_t stop = t->stop;
    sgt_element bare = t->e[stop];
    sgt_ray from = *launch;
    if (!bare.phase) {
        sgt_trace_sensitivity(stop + 1, t->e, t->index_before, launch, t->passages, 2, c, c);
        return;
    }
    bare.phase = NULL, bare.index = 0;
    if (stop > 0) {
        const sgt_pose *pose = &t->e[stop - 1].pose;
        const sgt_passage *p = &t->passages[stop - 1];
        sgt_trace_sensitivity(stop, t->e, t->index_before, launch, t->passages, 2, c, c);
        for (int k = 0; k < 2; k++) c[k].p = out_of(pose, c[k].p), c[k].d = out_of(pose, c[k].d);
        from.o = plus(pose->origin, out_of(pose, p->hit.p)), from.d = out_of(pose, p->direction);
    }
    sgt_trace_sensitivity(1, &bare, 1, &from, &t->passages[stop], 2, c, c);
}

/* The passages are those of r. */
static bool aim_slopes_at(aim_search *s, const aim_ray *r, aim_slopes *j)
{
    const aim_task *t = s->task;
    const sgt_beam *b = t->beam;
    sgt_ray_change c[2] = {aim_change(s->wide[0], b->ou, b->du), aim_change(s->wide[1], b->ov, b->dv)};
    aim_sensitivity(t, &r->ray, c);
    for (int k = 0; k < 2; k++) j->x[k] = c[k].p.x, j->y[k] = c[k].p.y;
    double sum = aim_size(j);
    if (!(sum < HUGE_VAL)) {
        if (!aim_differences(s, r, j)) return false;
        sum = aim_size(j);
    }
    s->steep = aim_steep(b, s->wide[0], &r->ray, sum);
    return true;
}

/* ------------------------------------------------------------------------ steps */

/* Tries r + s, r + s/2, ..., at most `halves` halvings.  true: *r is the new ray, with its passages.  *missed
 * is set if rays did not get there. */
static bool aim_take(aim_search *s, aim_ray *r, sgt_vec2 step, int halves, bool *missed)
{
    double part = 1;
    for (int i = 0; i <= halves && s->traces < s->most; i++, part *= 0.5) {
        aim_ray next;
        double u = r->u + part * step.x * s->wide[0], v = r->v + part * step.y * s->wide[1];
        if (!(fabs(u) < HUGE_VAL && fabs(v) < HUGE_VAL)) return false;
        bool there = aim_at(s, u, v, &next);
        if (next.u == r->u && next.v == r->v) return false; /* at the edge, or less than an ulp */
        if (there && aim_is_less(next.miss, r->miss, part)) {
            *r = next;
            return true;
        }
        if (!there) *missed = true;
    }
    return false;
}

/* Is the miss of r as little as can be told?  The passages are those of r; *error is that of its end. */
static bool is_there(const aim_search *s, const aim_ray *r, double *error)
{
    double grain;
    *error = sgt_aim_error(s->task, &r->ray, &grain);
    double noise = *error + grain;
    if (!(noise < HUGE_VAL)) { /* no second derivatives: some hundred ulps, and the grain of the launch ray */
        sgt_vec3 p = s->task->passages[s->task->stop].hit.p;
        noise = s->task->passages[s->task->stop].hit.p_err + 0x1p-46 * (fabs(p.x) + fabs(p.y)) + s->steep;
    }
    return r->miss <= s->tol || r->miss <= AIM_NOISE * noise;
}

/* From r on, with its passages.  Sets *r to the best ray, with its passages, and *error if it is there. */
static sgt_aim_reason aim_walk(aim_search *s, aim_ray *r, double *error)
{
    static const double DAMPED[] = {1e-4, 1e-2, 1, 100};
    const sgt_beam *box = s->task->beam;
    bool edge = false, missed = false, last = true; /* last: the passages are those of r */
    s->steep = 0;
    for (int i = 0; i < AIM_STEPS && s->traces < s->most; i++) {
        aim_slopes j;
        aim_ray best = *r;
        if (aim_is_enough(r->miss, s->tol, s->steep)) break;
        edge = missed = false;
        last = false;
        if (!aim_slopes_at(s, r, &j))
            missed = true;
        else {
            sgt_vec2 step = aim_step(&j, r->f, 0, false, false);
            bool out_u = goes_out(r->u, box->u, step.x), out_v = goes_out(r->v, box->v, step.y);
            edge = out_u || out_v;
            if (edge) step = aim_step(&j, r->f, 0, out_u, out_v);
            bool small = aim_is_small(step);
            bool better = aim_take(s, r, step, small ? 0 : HALVES, &missed);
            for (size_t m = 0; m < 4 && !better && !small && r->miss > 0; m++) {
                step = aim_step(&j, r->f, DAMPED[m], false, false);
                better = aim_take(s, r, step, 0, &missed);
            }
            last = better;
            if (better) continue;
        }
        *r = best;
        break;
    }
    aim_ray again = *r;
    if (!last && !aim_at(s, r->u, r->v, &again)) return SGT_AIM_CUT; /* never: it was traced before */
    *r = again;
    if (is_there(s, r, error)) return SGT_AIM_ARRIVED;
    if (s->traces >= s->most) return SGT_AIM_SPENT;
    return missed ? SGT_AIM_CUT : edge ? SGT_AIM_AT_EDGE : SGT_AIM_STUCK;
}

/* ----------------------------------------------------------------------- starts */

/* The digits of i in the base, behind the point: Halton's sequence. */
static double aim_digits(int i, int base)
{
    double x = 0, place = 1;
    for (; i > 0; i /= base) place /= base, x += place * (i % base);
    return x;
}

/* Start i: the user's, the middle, then all over the box. */
sgt_vec2 sgt_aim_start(const aim_task *task, const sgt_aim_options *opt, size_t i)
{
    const sgt_interval u = task->beam->u, v = task->beam->v;
    if (i < opt->starts) return (sgt_vec2){aim_within(opt->start[i].x, u), aim_within(opt->start[i].y, v)};
    int k = (int)(i - opt->starts);
    double a = k == 0 ? 0.5 : aim_digits(k, 2), b = k == 0 ? 0.5 : aim_digits(k, 3);
    return (sgt_vec2){aim_within(u.lo + a * (u.hi - u.lo), u), aim_within(v.lo + b * (v.hi - v.lo), v)};
}

static sgt_attempt aim_try(aim_search *s, sgt_vec2 from, aim_ray *r, double *error)
{
    int before = s->traces;
    s->fate = SGT_PASSED, s->element = 0;
    sgt_attempt a = {.from = from, .to = from, .miss = (double)NAN, .reason = SGT_AIM_NO_WAY};
    if (aim_at(s, from.x, from.y, r)) {
        a.reason = aim_walk(s, r, error);
        a.to = (sgt_vec2){r->u, r->v}, a.miss = r->miss;
    }
    a.fate = s->fate, a.element = s->element, a.traces = s->traces - before;
    return a;
}

/* A search from one start, told to the caller. */
static sgt_aim_reason aim_told(aim_search *s, const sgt_aim_options *opt, sgt_aiming *out, sgt_vec2 from,
                               aim_ray *r, double *error)
{
    sgt_attempt a = aim_try(s, from, r, error);
    if (out->attempts < opt->room && opt->attempt) opt->attempt[out->attempts] = a;
    out->attempts++;
    return a.reason;
}

/* Goes on with the starts, until one arrives, or `most` of ours have led nowhere, or ours are `last`. */
static bool aim_from_starts(aim_search *s, const sgt_aim_options *opt, int most, size_t last, sgt_aiming *out,
                            aim_ray *r, double *error)
{
    for (; s->next < opt->starts + last && s->walked < most && s->traces < s->most; s->next++) {
        sgt_aim_reason reason = aim_told(s, opt, out, sgt_aim_start(s->task, opt, s->next), r, error);
        if (reason == SGT_AIM_ARRIVED) return true;
        if (s->next >= opt->starts && reason != SGT_AIM_NO_WAY) s->walked++;
    }
    return false;
}

/* Proves that there is no ray, or finds it. */
static bool aim_or_proof(aim_search *s, const sgt_aim_options *opt, sgt_aiming *out, aim_ray *r,
                         double *error)
{
    aim_proof w = sgt_aim_proof_of(s->task, opt->max_boxes ? opt->max_boxes : BOXES);
    aim_verdict verdict;
    bool met = false;
    while (!met && (verdict = sgt_aim_proof_next(&w)) == PROOF_LOOK)
        met = aim_told(s, opt, out, (sgt_vec2){w.u, w.v}, r, error) == SGT_AIM_ARRIVED;
    out->boxes = w.boxes;
    if (!met && verdict == PROOF_DONE) out->status = SGT_NO_SUCH_RAY;
    return met;
}

/* A few starts find most rays; where there is none, a proof costs less than many starts do. */
static bool aim_find(aim_search *s, const sgt_aim_options *opt, sgt_aiming *out, aim_ray *r, double *error)
{
    if (aim_from_starts(s, opt, FIRST_STARTS, FIRST_SCAN, out, r, error)) return true;
    if (opt->max_boxes >= 0 && aim_or_proof(s, opt, out, r, error)) return true;
    return out->status != SGT_NO_SUCH_RAY && aim_from_starts(s, opt, STARTS, SCAN, out, r, error);
}

/* ---------------------------------------------------------------------- the call */

static bool aim_finite(sgt_vec3 a) { return isfinite(a.x) && isfinite(a.y) && isfinite(a.z); }
static bool aim_is_box(sgt_interval x) { return isfinite(x.lo) && isfinite(x.hi) && x.lo <= x.hi; }

bool sgt_aim_sound(const aim_task *t, const sgt_aim_options *opt)
{
    const sgt_beam *b = t->beam;
    if (!aim_finite(b->o) || !aim_finite(b->ou) || !aim_finite(b->ov) || !aim_finite(b->d) ||
        !aim_finite(b->du) || !aim_finite(b->dv) || !aim_is_box(b->u) || !aim_is_box(b->v))
        return false;
    if (is_zero(b->d) && is_zero(b->du) && is_zero(b->dv)) return false;
    for (size_t i = 0; i < opt->starts; i++)
        if (!isfinite(opt->start[i].x) || !isfinite(opt->start[i].y)) return false;
    if (!ROOM_IS_ZERO(b)) return false;
    return isfinite(t->wanted.x) && isfinite(t->wanted.y) && opt->tol >= 0 && opt->max_traces >= 0 &&
           ROOM_IS_ZERO(opt);
}

sgt_aimed sgt_aim(size_t stop, const sgt_element e[], double index_before, const sgt_beam *beam,
                  sgt_vec2 wanted, sgt_passage passages[], const sgt_aim_options *opt, sgt_aiming *out)
{
    const double none = (double)NAN;
    const sgt_aim_options given = opt ? *opt : (sgt_aim_options){0};
    const aim_task task = {stop, e, index_before, beam, wanted, passages};
    sgt_aiming own, *a = out ? out : &own;
    *a = (sgt_aiming){.status = SGT_AIMED_INVALID,
                      .u = none,
                      .v = none,
                      .point = {none, none},
                      .miss = none,
                      .ray = {{none, none, none}, {none, none, none}, none, none}};
    if (!sgt_aim_sound(&task, &given)) return a->status;
    aim_search s = {.task = &task,
                    .wide = {beam->u.hi - beam->u.lo, beam->v.hi - beam->v.lo},
                    .tol = given.tol,
                    .most = given.max_traces ? given.max_traces : AIM_TRACES};
    aim_ray r;
    double error = none;
    a->status = SGT_AIMED_UNDECIDED;
    if (aim_find(&s, &given, a, &r, &error)) {
        const sgt_vec3 p = passages[stop].hit.p;
        a->status = SGT_MET, a->u = r.u, a->v = r.v, a->ray = r.ray, a->point = (sgt_vec2){p.x, p.y};
        a->miss = aim_told_miss(r.miss, error), a->clipped = r.clipped;
    }
    a->traces = s.traces;
    return a->status;
}

const char *sgt_aimed_text(sgt_aimed aimed)
{
    switch (aimed) {
    case SGT_MET:
        return "met";
    case SGT_NO_SUCH_RAY:
        return "no such ray";
    case SGT_AIMED_UNDECIDED:
        return "undecided";
    case SGT_AIMED_INVALID:
        return "invalid";
    }
    return "?";
}
