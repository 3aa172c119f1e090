// SPDX-License-Identifier: MIT
/* rays.c - rays of a field through a lens, and back: how sums of their ends move with numbers of the file.
 *
 * THE CHAIN.  The gradient of a sum s of a ray's end has its derivatives by all numbers of the trace, the
 * launch ray o, d among them.  With the motion of these numbers
 *
 *     ds = sum of s_a da + s_o . do + s_d . dd.
 *
 * THE LAUNCH RAY is that of beam.c (../optics), differentiated: with q the point of the pupil after
 * vignetting and p = (R q, z) its place, from afar o = p + (wave - p . d) d; else o is the object and d = (p
 * - o) / |p - o|; of a telecentric object d goes along (cone q, 1).  The change of d along d itself changes
 * no end.
 *
 * AIMED RAYS meet a point w = R q of the stop.  Their family is that of the beam: all lines through the
 * object, or all with the direction.  Take any change of o, d that goes with the object or the direction;
 * what is left is a move by (a, b) along two vectors across d, of d or of o, which the stop decides: with the
 * gradients of its point, of two rows,
 *
 *     S1 a + S2 b = dw - (what the point moves without them).
 *
 * Newton's search has no part in it (the implicit function theorem). */
#include "figure.h"

#include <string.h>

enum { LAUNCH_NUMBERS = 6 }; /* of a trace, before all others */

static double *numbers(sgt_asking *a, size_t count) { return sgt_ask_room(a, count, sizeof(double)); }

/* Which numbers of the trace any motion moves. */
static bool moves(size_t motions, const motion of[], const layout *in, size_t j)
{
    for (size_t m = 0; m < motions; m++) {
        if (j < 6 && of[m].beams) return true;
        for (size_t s = 0; s < in->slots; s++)
            if (of[m].by[s * in->trace + j] != 0) return true;
    }
    return false;
}

/* Does any number of a phase move? */
static bool phases_move(size_t motions, const motion of[], const layout *in)
{
    for (size_t m = 0; m < motions; m++)
        for (size_t j = in->phase; j < in->axes; j++)
            if (of[m].by[j] != 0) return true;
    return false;
}

bool sgt_flock_begin(flock *f, look_of_lens *at, const layout *in, size_t motions, const motion *of)
{
    sgt_asking *a = &at->ask;
    const size_t count = a->lens->count;
    const bool aims = a->from->aim != SGT_LENS_AIM_PUPIL;
    *f = (flock){.at = at, .in = in, .elements = count};
    f->own = sgt_ask_room(a, count, sizeof *f->own), f->open = sgt_ask_room(a, count, sizeof *f->open);
    f->passage = sgt_ask_room(a, count, sizeof *f->passage);
    f->passages = sgt_ask_room(a, count, sizeof *f->passages);
    f->fate = sgt_ask_room(a, FLOCK, sizeof *f->fate);
    double *room = numbers(a, (12 * count + 6) * FLOCK);
    sgt_status *status = sgt_ask_room(a, count * FLOCK, sizeof *status);
    f->gradient = sgt_ask_room(a, FLOCK_ROWS * in->trace, sizeof *f->gradient);
    f->to_stop = sgt_ask_room(a, 2 * in->trace, sizeof *f->to_stop);
    if (a->failed) return false;
    for (int k = 0; k < 3; k++, room += 2 * FLOCK) f->o[k] = room, f->d[k] = room + FLOCK;
    for (size_t i = 0; i < count; i++, status += FLOCK) {
        sgt_passages *p = &f->passages[i];
        p->hits.status = status, p->hits.t = room, p->opl = room + FLOCK, room += 2 * FLOCK;
        p->hits.p_err = room, room += FLOCK;
        for (int k = 0; k < 3; k++, room += 3 * FLOCK)
            p->hits.p[k] = room, p->hits.n[k] = room + FLOCK, p->direction[k] = room + 2 * FLOCK;
    }
    f->stop_numbers = sgt_trace_parameters(a->lens->stop + 1, a->lens->element);
    for (size_t j = 0; j < in->trace && motions; j++) {
        if (!(j < 6 && aims) && !moves(motions, of, in, j)) continue;
        for (size_t r = 0; r < FLOCK_ROWS; r++) f->gradient[r * in->trace + j] = numbers(a, FLOCK);
        for (size_t r = 0; aims && j < f->stop_numbers && r < 2; r++)
            f->to_stop[r * f->stop_numbers + j] = numbers(a, FLOCK);
    }
    f->stop_phases = sgt_phase_parameters(a->lens->stop + 1, a->lens->element);
    f->bends = motions && phases_move(motions, of, in);
    if (f->bends) {
        f->ray_row = numbers(a, FLOCK_ROWS * in->phases);
        f->by_phase = sgt_ask_room(a, FLOCK_ROWS * in->phases, sizeof *f->by_phase);
        f->phase_to_stop = sgt_ask_room(a, 2 * f->stop_phases + 1, sizeof *f->phase_to_stop);
        for (size_t j = 0; !a->failed && j < FLOCK_ROWS * in->phases; j++) f->by_phase[j] = numbers(a, FLOCK);
        for (size_t j = 0; !a->failed && j < 2 * f->stop_phases; j++) f->phase_to_stop[j] = numbers(a, FLOCK);
    }
    return !a->failed;
}

static sgt_traces traces_of(const flock *f)
{
    return (sgt_traces){
        f->count, {.o = {f->o[0], f->o[1], f->o[2]}, .d = {f->d[0], f->d[1], f->d[2]}}, f->passages};
}

bool sgt_flock_trace(flock *f, size_t field, size_t slot, size_t count, const sgt_pupil_point point[],
                     bool chief, bool unbent, bool vignetted)
{
    const sgt_asking *a = &f->at->ask;
    const band *b = sgt_look_slot(f->at, slot);
    const sgt_launcher *from = a->from;
    sgt_launched launched[FLOCK];
    f->field = field, f->slot = slot, f->count = count, f->before = b->before, f->beam = a->beam[field],
    f->vignetted = vignetted;
    if (!vignetted)
        f->beam.shift = (sgt_vec2){0, 0}, f->beam.scale = (sgt_vec2){1, 1}, f->beam.turn = (sgt_vec2){1, 0};
    sgt_launch_ending(f->elements, b->element, f->own);
    if (unbent) f->own[f->elements - 1].index = 0;
    memcpy(f->point, point, count * sizeof *point);
    if (!sgt_launch_rays(from, &f->beam, f->own, f->before, count, point, launched, NULL)) return false;
    for (size_t k = 0; k < count; k++) {
        const sgt_ray *ray = &launched[k].ray;
        const double none = (double)NAN;
        f->there[k] = launched[k].status == SGT_MET;
        f->o[0][k] = f->there[k] ? ray->o.x : none, f->d[0][k] = ray->d.x;
        f->o[1][k] = ray->o.y, f->d[1][k] = ray->d.y, f->o[2][k] = ray->o.z, f->d[2][k] = ray->d.z;
    }
    if (chief && f->there[0]) {
        sgt_trace_through(f->elements, f->own, f->before, &launched[0].ray, f->open, f->passage, f->fate);
        memcpy(f->own, f->open, f->elements * sizeof *f->own);
    }
    sgt_trace_batch(f->elements, f->own, f->before, count, traces_of(f).rays, (sgt_traced){.fate = f->fate},
                    f->passages, NULL);
    return true;
}

sgt_ray_change sgt_flock_end(const flock *f, size_t k)
{
    const sgt_passages *p = &f->passages[f->elements - 1];
    return (sgt_ray_change){{p->hits.p[0][k], p->hits.p[1][k], p->hits.p[2][k]},
                            {p->direction[0][k], p->direction[1][k], p->direction[2][k]},
                            p->opl[k]};
}

void sgt_flock_errors(const flock *f, double point[])
{
    const sgt_traces traces = traces_of(f);
    double grain[FLOCK];
    sgt_trace_error_batch(f->elements, f->own, f->before, &traces,
                          (sgt_end_errors){.point = point, .grain = grain});
    for (size_t k = 0; k < f->count; k++) point[k] += 4 * grain[k];
}

/* Passage i of ray k; what a trace of one ray tells. */
static sgt_passage column_passage(const sgt_passages *p, size_t k)
{
    const sgt_hits *h = &p->hits;
    return (sgt_passage){.hit = {.status = h->status[k],
                                 .t = h->t[k],
                                 .p_err = h->p_err[k],
                                 .p = {h->p[0][k], h->p[1][k], h->p[2][k]},
                                 .n = {h->n[0][k], h->n[1][k], h->n[2][k]}},
                         .direction = {p->direction[0][k], p->direction[1][k], p->direction[2][k]},
                         .opl = p->opl[k]};
}

static sgt_vec3 column_weight(double *const w[3], size_t k)
{
    return (sgt_vec3){w[0] ? w[0][k] : 0, w[1] ? w[1][k] : 0, w[2] ? w[2][k] : 0};
}

/* As sgt_trace_gradient_batch, by the numbers of phases, ray by ray.  What did not pass is not asked. */
static void phases_back(flock *f, size_t elements, size_t count, size_t rows, const sgt_ray_changes weight[],
                        double *const to[])
{
    for (size_t k = 0; k < f->count; k++) {
        if (!f->there[k] || f->fate[k] != SGT_PASSED) continue;
        sgt_ray_change w[FLOCK_ROWS];
        for (size_t r = 0; r < rows; r++)
            w[r] = (sgt_ray_change){column_weight(weight[r].p, k), column_weight(weight[r].d, k),
                                    weight[r].opl ? weight[r].opl[k] : 0};
        for (size_t i = 0; i < elements; i++) f->passage[i] = column_passage(&f->passages[i], k);
        const sgt_ray ray = {.o = {f->o[0][k], f->o[1][k], f->o[2][k]},
                             .d = {f->d[0][k], f->d[1][k], f->d[2][k]}};
        sgt_phase_gradient(elements, f->own, f->before, &ray, f->passage, rows, w, f->ray_row);
        for (size_t j = 0; j < rows * count; j++) to[j][k] = f->ray_row[j];
    }
}

void sgt_flock_back(flock *f, size_t rows, const sgt_ray_changes weight[])
{
    double one[FLOCK], zero[FLOCK] = {0};
    const size_t stop = f->at->ask.lens->stop;
    const sgt_traces traces = traces_of(f);
    f->rows = rows;
    sgt_trace_gradient_batch(f->elements, f->own, f->before, &traces, rows, weight, f->gradient);
    if (f->bends) phases_back(f, f->elements, f->in->phases, rows, weight, f->by_phase);
    if (f->at->ask.from->aim == SGT_LENS_AIM_PUPIL) return;
    for (size_t k = 0; k < FLOCK; k++) one[k] = 1;
    const sgt_ray_changes point[2] = {{.p = {one, zero, zero}}, {.p = {zero, one, zero}}};
    sgt_trace_gradient_batch(stop + 1, f->own, f->before, &traces, 2, point, f->to_stop);
    if (f->bends) phases_back(f, stop + 1, f->stop_phases, 2, point, f->phase_to_stop);
}

/* ------------------------------------------------------------------------ the launch */

static sgt_vec3 three(const double x[]) { return (sgt_vec3){x[0], x[1], x[2]}; }

/* The numbers of a beam as they stand in a row, and their changes. */
typedef struct beam_change {
    sgt_vec3 object, direction;
    double pupil, radius, cone, wave;
    sgt_vec2 shift, scale, turn;
} beam_change;

static beam_change change_of(const double x[BEAM_NUMBERS], bool vignetted)
{
    beam_change c = {three(x), three(x + 3), x[6], x[7], x[8], x[9], {0, 0}, {0, 0}, {0, 0}};
    if (vignetted) c.shift = (sgt_vec2){x[10], x[11]}, c.scale = (sgt_vec2){x[12], x[13]};
    if (vignetted) c.turn = (sgt_vec2){x[14], x[15]};
    return c;
}

/* How a point of the pupil moves. */
static sgt_vec2 point_change(const sgt_field_beam *b, const beam_change *c, sgt_pupil_point at)
{
    const double u = b->shift.x + at.x * b->scale.x, v = b->shift.y + at.y * b->scale.y;
    const double du = c->shift.x + at.x * c->scale.x, dv = c->shift.y + at.y * c->scale.y;
    return (sgt_vec2){du * b->turn.x - dv * b->turn.y + u * c->turn.x - v * c->turn.y,
                      du * b->turn.y + dv * b->turn.x + u * c->turn.y + v * c->turn.x};
}

/* How the launch ray moves; aimed: apart from what the stop decides. */
static void launch_change(const sgt_field_beam *b, const beam_change *c, sgt_pupil_point at, bool aimed,
                          const sgt_ray *ray, sgt_vec3 *o, sgt_vec3 *d)
{
    const sgt_vec2 q = sgt_vignetted(b, at.x, at.y), dq = point_change(b, c, at);
    const sgt_vec3 p = {b->radius * q.x, b->radius * q.y, b->pupil};
    const sgt_vec3 dp = {c->radius * q.x + b->radius * dq.x, c->radius * q.y + b->radius * dq.y, c->pupil};
    *o = c->object, *d = (sgt_vec3){0, 0, 0};
    if (!b->finite) {
        const double way = b->wave - dot3(p, b->direction);
        *d = c->direction;
        if (aimed) {
            *o = along3(*o, c->wave - dot3(ray->o, *d), ray->d);
            return;
        }
        *o = along3(along3(dp, c->wave - dot3(dp, b->direction) - dot3(p, *d), b->direction), way, *d);
    } else if (aimed) {
        return;
    } else if (b->cone > 0) {
        const sgt_vec3 w = {b->cone * q.x, b->cone * q.y, 1};
        const sgt_vec3 dw = {c->cone * q.x + b->cone * dq.x, c->cone * q.y + b->cone * dq.y, 0};
        *d = along3((sgt_vec3){0, 0, 0}, 1 / length3(w), dw);
    } else {
        const sgt_vec3 w = minus3(p, b->object);
        *d = along3((sgt_vec3){0, 0, 0}, copysign(1 / length3(w), w.z), minus3(dp, c->object));
    }
}

/* -------------------------------------------------------------------------- the chain */

/* Adds the part of a row by numbers from `begin` to `end`; error (may be NULL): what may be off in it. */
static void by_numbers(double *const gradient[], size_t begin, size_t end, const double by[],
                       const double off[], size_t rays, double sum[], double error[])
{
    static const double TRACE = 0x1p-44; /* what the gradient may be off by, of each term: observed */
    for (size_t j = begin; j < end; j++) {
        const double *g = gradient[j], b = by[j], o = off[j] + TRACE * fabs(by[j]);
        if (b == 0 || !g) continue;
        for (size_t k = 0; k < rays; k++) sum[k] += g[k] * b;
        for (size_t k = 0; error && k < rays; k++) error[k] += fabs(g[k]) * o;
    }
}

/* What is told to be off in the part of the launch ray. */
static const double LAUNCH = 0x1p-38;

static double by_launch(double *const gradient[], sgt_vec3 o, sgt_vec3 d, size_t k)
{
    if (!gradient[0]) return 0;
    return gradient[0][k] * o.x + gradient[1][k] * o.y + gradient[2][k] * o.z + gradient[3][k] * d.x +
           gradient[4][k] * d.y + gradient[5][k] * d.z;
}

/* Two vectors of unit length across d. */
static void across(sgt_vec3 d, sgt_vec3 *u, sgt_vec3 *v)
{
    const sgt_vec3 away = fabs(d.x) < fabs(d.y) ? (sgt_vec3){1, 0, 0} : (sgt_vec3){0, 1, 0};
    *u = unit3(cross3(d, away)), *v = unit3(cross3(d, *u));
}

/* What the stop decides: adds to o or d what moves the ray by `wanted` there, less what o and d do. */
static void meet_stop(const flock *f, const double wanted[2], size_t k, const sgt_ray *ray, sgt_vec3 *o,
                      sgt_vec3 *d)
{
    static const sgt_vec3 none = {0, 0, 0};
    sgt_vec3 e[2];
    double s[2][2], left[2];
    across(ray->d, &e[0], &e[1]);
    for (size_t r = 0; r < 2; r++) {
        double *const *g = f->to_stop + r * f->stop_numbers;
        left[r] = wanted[r] - by_launch(g, *o, *d, k);
        for (int i = 0; i < 2; i++)
            s[r][i] = f->beam.finite ? by_launch(g, none, e[i], k) : by_launch(g, e[i], none, k);
    }
    const double determinant = s[0][0] * s[1][1] - s[0][1] * s[1][0];
    const double a = (left[0] * s[1][1] - left[1] * s[0][1]) / determinant;
    const double b = (left[1] * s[0][0] - left[0] * s[1][0]) / determinant;
    sgt_vec3 *to = f->beam.finite ? d : o;
    *to = along3(along3(*to, a, e[0]), b, e[1]);
}

/* Of an aimed ray: how its point of the stop has to move, apart from what the numbers move it by; what may be
 * off in that. */
static void stop_change(const flock *f, const motion *m, const beam_change *c, size_t k, double moved[2],
                        double off[2])
{
    const double height = f->at->number[f->in->stop], dh = m->by[f->in->stop], own = m->error[f->in->stop];
    const sgt_vec2 q = sgt_vignetted(&f->beam, f->point[k].x, f->point[k].y);
    const sgt_vec2 dq = point_change(&f->beam, c, f->point[k]);
    moved[0] = dh * q.x + height * dq.x - moved[0], moved[1] = dh * q.y + height * dq.y - moved[1];
    off[0] += own * fabs(q.x), off[1] += own * fabs(q.y);
}

/* What may be off in the part of the launch ray, of that part: LAUNCH, or as the numbers of the beam and of
 * the stop are, the worst of them. */
static double launch_error(const flock *f, const motion *m, size_t beam)
{
    double worst = LAUNCH;
    for (size_t i = 0; i <= BEAM_NUMBERS; i++) {
        const size_t at = i < BEAM_NUMBERS ? beam + i : f->in->stop;
        if (m->by[at] != 0) worst = fmax(worst, m->error[at] / fabs(m->by[at]));
    }
    return worst;
}

void sgt_flock_move(const flock *f, const motion *m, size_t row, double out[], double error[])
{
    const layout *in = f->in;
    const sgt_asking *a = &f->at->ask;
    const bool aims = a->from->aim != SGT_LENS_AIM_PUPIL;
    const double *by = m->by + f->slot * in->trace, *by_off = m->error + f->slot * in->trace;
    const size_t beam = in->beams + f->field * BEAM_NUMBERS;
    const beam_change c = change_of(m->by + beam, f->vignetted);
    double *const *g = f->gradient + row * in->trace;
    const double launch = launch_error(f, m, beam);
    double at_stop[2][FLOCK] = {{0}}, off_stop[2][FLOCK] = {{0}};
    for (size_t k = 0; k < f->count; k++) out[k] = 0;
    for (size_t k = 0; error && k < f->count; k++) error[k] = 0;
    by_numbers(g, LAUNCH_NUMBERS, in->trace, by, by_off, f->count, out, error);
    for (size_t r = 0; aims && r < 2; r++)
        by_numbers(f->to_stop + r * f->stop_numbers, LAUNCH_NUMBERS, f->stop_numbers, by, by_off, f->count,
                   at_stop[r], error ? off_stop[r] : NULL);
    if (f->bends) {
        const double *wave = m->by + in->phase + f->slot * in->phases,
                     *wave_off = m->error + in->phase + f->slot * in->phases;
        by_numbers(f->by_phase + row * in->phases, 0, in->phases, wave, wave_off, f->count, out, error);
        for (size_t r = 0; aims && r < 2; r++)
            by_numbers(f->phase_to_stop + r * f->stop_phases, 0, f->stop_phases, wave, wave_off, f->count,
                       at_stop[r], error ? off_stop[r] : NULL);
    }
    for (size_t k = 0; k < f->count; k++) {
        if (!f->there[k] || f->fate[k] != SGT_PASSED) {
            out[k] = 0;
            if (error) error[k] = 0;
            continue;
        }
        if (!m->beams && !aims) continue;
        const sgt_ray ray = {.o = {f->o[0][k], f->o[1][k], f->o[2][k]},
                             .d = {f->d[0][k], f->d[1][k], f->d[2][k]}};
        sgt_vec3 o, d;
        launch_change(&f->beam, &c, f->point[k], aims, &ray, &o, &d);
        double moved[2] = {at_stop[0][k], at_stop[1][k]}, off[2] = {off_stop[0][k], off_stop[1][k]};
        if (aims) {
            sgt_vec3 off_o = {0, 0, 0}, off_d = {0, 0, 0};
            stop_change(f, m, &c, k, moved, off);
            meet_stop(f, moved, k, &ray, &o, &d);
            if (error) meet_stop(f, off, k, &ray, &off_o, &off_d);
            if (error) error[k] += fabs(by_launch(g, off_o, off_d, k));
        }
        const double term = by_launch(g, o, d, k);
        out[k] += term;
        if (error) error[k] += launch * fabs(term);
    }
}
