// SPDX-License-Identifier: MIT
/* ends.c - where the rays of a field end, and how sure that is.
 *
 * THE LAUNCH RAY is itself rounded.  Each of its numbers is off by some ulps: for the point at the end
 * that is a few times `grain` (sgt_end_error).  A ray from afar starts on a plane in space, at
 * p + (wave - p . d) d; what rounding does to that along d is in the path at once, and no more than
 * LAUNCH ulps of the numbers that go into it.  With ideal lenses the rest counts as well: `path_grain`.
 *
 * THE ERROR OF A DIRECTION.  A plane stands across the ray at the distance L behind its end.  The exact ray
 * meets the last element within p_err of the end, and that plane within the error there (sgt_trace_error):
 * so the angle between both rays is at most the sum of both over L.  L is FAR times the lens, and the plane's
 * own rounding is of the order of u.
 *
 * AIMED RAYS by a fitted map (aim_map.c) are traced through the whole lens at once.  Their hits at the stop
 * tell which of them meet their points there; the others are aimed one by one, and traced again.  That is so
 * where the trace asks for the roots that aiming asks for: near the seed, to rounding, without proofs.
 *
 * MANY RAYS go side by side, some hundred at a time, through the loops of sgt_trace_batch and
 * sgt_trace_error_batch, whose numbers are those of one ray to the bit.  One by one is the chief ray alone,
 * whatever clips it, and what an afocal lens needs besides. */
#include "launch.h"

static const double ULP = 0x1p-53, LAUNCH = 6, GRAINS = 4;

enum { PART = 128 }; /* rays side by side, at most */
#define SIDE_BY_SIDE _Pragma("omp simd")

/* A bound on the error of a point, and of a path. */
static double point_error(double point, double grain)
{
    const double off = point + GRAINS * grain;
    return isnan(off) ? HUGE_VAL : off;
}

static double path_error(const sgt_colour_beam *of, sgt_vec3 o, double path, double grain)
{
    const sgt_field_beam *b = of->beam;
    const double reach = length3(o) + fabs(b->wave) + fabs(b->pupil);
    const double index = of->before == 0 ? 1 : of->before;
    const double launch = b->finite ? 0 : LAUNCH * ULP * index * reach, off = path + GRAINS * grain + launch;
    return isnan(off) ? HUGE_VAL : off;
}

double sgt_direction_error(const sgt_launcher *from, const sgt_element e[], double before,
                           const sgt_ray *launch, const sgt_ray_end *end)
{
    static const sgt_conic flat;
    const double FAR = 0x1p10;
    const size_t count = from->lens->count;
    const sgt_pose *pose = &e[count - 1].pose;
    double away = (double)NAN, length = length3(end->p) + fabs(from->lens->surface[0].z);
    sgt_element *more = sgt_launch_take(from, count + 1, sizeof *more);
    sgt_passage *passages = sgt_launch_take(from, count + 1, sizeof *passages);
    for (size_t i = 0; i < count; i++) length += length3(e[i].pose.origin);
    length = FAR * (length > 0 ? length : 1);
    if (more && passages) {
        sgt_end_error off;
        sgt_ray ray = *launch;
        const sgt_vec3 d = out_of3(pose, end->d), at = along3(pose->origin, 1, out_of3(pose, end->p));
        const sgt_vec3 x = fabs(d.x) < 0.5 ? (sgt_vec3){1, 0, 0} : (sgt_vec3){0, 1, 0};
        const sgt_vec3 ey = unit3(cross3(d, x)), ex = cross3(ey, d);
        for (size_t i = 0; i < count; i++) more[i] = e[i];
        more[count - 1].index = 0, more[count - 1].phase = NULL; /* the last one bends no light here */
        more[count] = (sgt_element){.surface = {&sgt_conic_ops, &flat},
                                    .pose = {.origin = along3(at, length, d), .ex = ex, .ey = ey, .ez = d}};
        if (sgt_trace(count + 1, more, before, &ray, passages, NULL, NULL) == count + 1 &&
            sgt_trace_error(count + 1, more, before, launch, passages, &off))
            away = off.point + GRAINS * off.grain;
    }
    sgt_launch_forget(from, more);
    sgt_launch_forget(from, passages);
    return isnan(away) ? HUGE_VAL : 1.01 * (away + end->p_err) / length;
}

/* The square of 1 / cos of an angle of incidence: so that the root is drawn once, of the largest. */
static inline double slant_of(sgt_vec3 n, sgt_vec3 d)
{
    const double along = dot3(n, d);
    return dot3(n, n) * dot3(d, d) / (along * along);
}

static void follow(const sgt_colour_beam *of, const sgt_launched *l, sgt_passage passages[], sgt_ray_end *out)
{
    const sgt_element *e = of->e;
    const size_t count = of->from->lens->count;
    sgt_ray ray = l->ray;
    size_t passed = sgt_trace(count, e, of->before, &ray, passages, &out->fate, NULL);
    out->element = passed < count ? passed : count - 1;
    const sgt_passage *last = &passages[out->element];
    double slant = 0;
    out->status = last->hit.status, out->folded = l->folded;
    out->proven = passed == count;
    sgt_vec3 d = l->ray.d, in = d;
    for (size_t i = 0; i <= out->element; i++) {
        const sgt_hit *hit = &passages[i].hit;
        in = into3(&e[i].pose, d);
        if (hit->status > 0) slant = fmax(slant, slant_of(hit->n, in));
        d = out_of3(&e[i].pose, passages[i].direction);
        out->evals += hit->evals;
        out->t_err = fmax(out->t_err, hit->t_err);
        out->proven = out->proven && hit->status == SGT_HIT;
    }
    out->condition = sqrt(slant);
    if (passed < count) return;
    sgt_end_error off;
    sgt_trace_error(count, e, of->before, &l->ray, passages, &off);
    out->p = last->hit.p, out->d = in, out->opl = last->opl;
    out->p_err = point_error(off.point, off.grain);
    out->opl_err = path_error(of, l->ray.o, off.path, off.path_grain);
    if (of->from->lens->afocal) out->d_err = sgt_direction_error(of->from, e, of->before, &l->ray, out);
}

#define NOWHERE {(double)NAN, (double)NAN, (double)NAN}

/* Ends as they are where no ray was traced.  (Each is a copy of the first.  gcc 12 would clear a copy of what
 * is constant by `rep stos`, which takes longer than all else that is told of a ray.) */
static void begin_ends(size_t count, sgt_ray_end out[])
{
    static const sgt_ray_end untraced = {
        .fate = SGT_LOST, .status = SGT_EXHAUSTED, .p = NOWHERE, .d = NOWHERE, .opl = (double)NAN,
        .p_err = (double)NAN, .opl_err = (double)NAN, .d_err = (double)NAN};
    if (count) out[0] = untraced;
    for (size_t i = 1; i < count; i++) out[i] = out[0];
}

static void set_untraced(const sgt_pupil_point *at, const sgt_launched *l, sgt_ray_end *out)
{
    out->px = at->x, out->py = at->y, out->weight = at->weight;
    out->aimed = l->status, out->within = l->within;
}

/* -------------------------------------------------------------- many rays at once */

/* Rays that were launched, number by number, and what their traces leave: [rays] each.  Of what is not wanted
 * the arrays are there, but nothing is told in them. */
typedef struct many {
    size_t rays;
    unsigned wanted;
    double *o[3], *d[3];
    double *turned[3];          /* room for directions, and */
    const double *in[3];        /* the directions in front of an element, in its frame */
    sgt_fate *fate;
    int *passed;
    sgt_passages *at;           /* [elements] */
    sgt_end_errors off;
    double *t_err, *condition;
    int *evals;
    sgt_status *met;            /* 1: a hit at every element so far */
} many;

enum { END_ERRORS = END_POINT_ERROR | END_PATH_ERROR };

/* The arrays of a passage at `number`, [rays] each: those that are wanted of the element with `behind`
 * elements behind it.  Errors and slants need all elements; else points and paths are told at the last one,
 * and directions in front of it.  aimed: where it is seen whether a ray met its point. */
static sgt_passages passage_of(unsigned wanted, size_t behind, bool aimed, size_t rays, double *number,
                               int *evals, sgt_status *status)
{
    const bool errors = wanted & END_ERRORS, slant = wanted & END_SLANT, point = wanted & END_POINT;
    sgt_passages p = {.hits.status = status};
    for (int k = 0; k < 3; k++, number += 3 * rays) {
        if (errors || aimed || (point && behind == 0)) p.hits.p[k] = number;
        if (errors || slant) p.hits.n[k] = number + rays;
        if (errors || slant || (point && behind == 1)) p.direction[k] = number + 2 * rays;
    }
    if (errors) p.hits.t = number;
    if (errors || aimed) p.hits.p_err = number + rays;
    if (slant) p.hits.t_err = number + 2 * rays;
    if (wanted & END_PATH && behind == 0) p.opl = number + 3 * rays;
    if (wanted & END_EVALS) p.hits.evals = evals;
    return p;
}

/* Room for it as one block: [elements] passages in front, then numbers.  NULL: no memory. */
static many *many_new(const sgt_launcher *from, size_t rays, unsigned wanted)
{
    enum { NUMBERS = 13, OTHERS = 15, BYTES = 4 };
    const bool aims = from->aim != SGT_LENS_AIM_PUPIL;
    const size_t count = from->lens->count, each = NUMBERS * sizeof(double) + sizeof(int) + 1;
    const size_t size = sizeof(many) + count * (sizeof(sgt_passages) + rays * each) +
                        rays * (OTHERS * sizeof(double) + 2 * sizeof(int) + BYTES) + 64;
    char *room = sgt_launch_take(from, size, 1);
    if (!room) return NULL;
    many *m = (void *)room;
    *m = (many){.rays = rays, .wanted = wanted, .at = (void *)(room + sizeof *m)};
    double *number = (double *)(void *)(m->at + count), *others = number + count * NUMBERS * rays;
    for (int k = 0; k < 3; k++, others += 3 * rays)
        m->o[k] = others, m->d[k] = others + rays, m->turned[k] = others + 2 * rays;
    if (wanted & END_POINT_ERROR) m->off.point = others, m->off.grain = others + rays;
    if (wanted & END_PATH_ERROR) m->off.path = others + 2 * rays, m->off.path_grain = others + 3 * rays;
    m->t_err = others + 4 * rays, m->condition = others + 5 * rays;
    int *whole = (int *)(void *)(others + 6 * rays);
    m->passed = whole, m->evals = whole + rays, whole += 2 * rays;
    sgt_status *status = (sgt_status *)(whole + count * rays);
    for (size_t i = 0; i < count; i++, number += NUMBERS * rays, whole += rays, status += rays) {
        const bool aimed = aims && i == from->lens->stop;
        m->at[i] = passage_of(wanted, count - 1 - i, aimed, rays, number, whole, status);
    }
    m->fate = (sgt_fate *)status, m->met = (sgt_status *)(m->fate + rays);
    return m;
}

static bool is_turned(const sgt_pose *pose) { return dot3(pose->ex, pose->ex) != 0; }

/* Sets the directions in front of element i, in its frame: as they were told, if nothing is turned. */
static void directions_at(many *m, const sgt_element e[], size_t i, size_t rays)
{
    const sgt_pose *before = i > 0 ? &e[i - 1].pose : NULL, *pose = &e[i].pose;
    const bool turned = (before && is_turned(before)) || is_turned(pose);
    double *const *told = i > 0 ? m->at[i - 1].direction : m->d;
    const double *dx = told[0], *dy = told[1], *dz = told[2];
    double *x = m->turned[0], *y = m->turned[1], *z = m->turned[2];
    for (int k = 0; k < 3; k++) m->in[k] = turned ? m->turned[k] : told[k];
    for (size_t k = 0; turned && k < rays; k++) {
        const sgt_vec3 own = {dx[k], dy[k], dz[k]};
        const sgt_vec3 in = into3(pose, before ? out_of3(before, own) : own);
        x[k] = in.x, y[k] = in.y, z[k] = in.z;
    }
}

/* How slanting rays meet an element (the square, as above), and how far off t is.  A ray that did not get
 * there has the status 0, and NaN. */
static void slant_at(const many *m, const sgt_passages *p, size_t rays)
{
    const double *nx = p->hits.n[0], *ny = p->hits.n[1], *nz = p->hits.n[2], *t_err = p->hits.t_err;
    const double *x = m->in[0], *y = m->in[1], *z = m->in[2];
    double *condition = m->condition, *most = m->t_err;
    const sgt_status *status = p->hits.status;
    double met[PART];
    for (size_t k = 0; k < rays; k++) met[k] = status[k] > 0;
    SIDE_BY_SIDE for (size_t k = 0; k < rays; k++)
    {
        const sgt_vec3 n = {nx[k], ny[k], nz[k]}, d = {x[k], y[k], z[k]};
        const double c = slant_of(n, d), own = met[k] != 0 ? c : 0;
        condition[k] = own > condition[k] ? own : condition[k]; /* not a NaN */
    }
    SIDE_BY_SIDE for (size_t k = 0; k < rays; k++) most[k] = t_err[k] > most[k] ? t_err[k] : most[k];
}

/* Traces the rays that are in m, and sets all else of it that is wanted. */
static void trace_many(const sgt_colour_beam *of, many *m, size_t rays, const sgt_options *opt)
{
    const sgt_element *e = of->e;
    const double before = of->before;
    const size_t count = of->from->lens->count;
    const sgt_rays launch = {.o = {m->o[0], m->o[1], m->o[2]}, .d = {m->d[0], m->d[1], m->d[2]}};
    sgt_trace_batch(count, e, before, rays, launch, (sgt_traced){.fate = m->fate, .passed = m->passed}, m->at,
                    opt);
    if (m->wanted & END_ERRORS)
        sgt_trace_error_batch(count, e, before, &(sgt_traces){rays, launch, m->at}, m->off);
    for (size_t k = 0; k < rays; k++) m->t_err[k] = m->condition[k] = 0, m->evals[k] = 0, m->met[k] = 1;
    for (size_t i = 0; i < count; i++) {
        const sgt_hits *h = &m->at[i].hits;
        const sgt_status *status = h->status;
        sgt_status *met = m->met;
        SIDE_BY_SIDE for (size_t k = 0; k < rays; k++) met[k] = status[k] == SGT_HIT ? met[k] : 0;
        for (size_t k = 0; h->evals && k < rays; k++) m->evals[k] += h->evals[k];
        if (!(m->wanted & END_SLANT)) continue;
        directions_at(m, e, i, rays);
        slant_at(m, &m->at[i], rays);
    }
    for (size_t k = 0; m->wanted & END_SLANT && k < rays; k++) m->condition[k] = sqrt(m->condition[k]);
    if (m->wanted & END_POINT) directions_at(m, e, count - 1, rays);
}

/* The end of ray k of m, as `follow` tells it. */
static void tell_end(const sgt_colour_beam *of, const many *m, size_t k, sgt_ray_end *out)
{
    const sgt_lens *lens = of->from->lens;
    const size_t count = lens->count, passed = (size_t)m->passed[k];
    const sgt_passages *last = &m->at[count - 1];
    const sgt_vec3 o = {m->o[0][k], m->o[1][k], m->o[2][k]};
    const unsigned wanted = m->wanted;
    out->element = passed < count ? passed : count - 1;
    out->fate = m->fate[k], out->status = m->at[out->element].hits.status[k];
    out->proven = passed == count && m->met[k];
    out->condition = m->condition[k], out->evals = m->evals[k], out->t_err = m->t_err[k];
    if (passed < count) return;
    if (wanted & END_POINT) {
        out->p = (sgt_vec3){last->hits.p[0][k], last->hits.p[1][k], last->hits.p[2][k]};
        out->d = (sgt_vec3){m->in[0][k], m->in[1][k], m->in[2][k]};
    }
    if (wanted & END_POINT_ERROR) out->p_err = point_error(m->off.point[k], m->off.grain[k]);
    if (wanted & END_PATH) out->opl = last->opl[k];
    if (wanted & END_PATH_ERROR)
        out->opl_err = path_error(of, o, m->off.path[k], m->off.path_grain[k]);
    if (wanted & END_POINT_ERROR && lens->afocal) {
        const sgt_ray ray = {.o = o, .d = {m->d[0][k], m->d[1][k], m->d[2][k]}};
        out->d_err = sgt_direction_error(of->from, of->e, of->before, &ray, out);
    }
}

/* Rays that were not aimed: all are there. */
static void trace_unaimed(const sgt_colour_beam *of, many *m, size_t count, const sgt_pupil_point at[],
                          const sgt_options *opt, sgt_ray_end out[])
{
    static const sgt_launched there = {.status = SGT_MET};
    sgt_launch_unaimed(of->beam, count, at, m->o, m->d);
    trace_many(of, m, count, opt);
    begin_ends(count, out);
    for (size_t i = 0; i < count; i++) {
        set_untraced(&at[i], &there, &out[i]);
        tell_end(of, m, i, &out[i]);
    }
}

/* Those that are there are put side by side. */
static void trace_aimed(const sgt_colour_beam *of, many *m, size_t count, const sgt_launched launched[],
                        const sgt_pupil_point at[], const sgt_options *opt, sgt_ray_end out[])
{
    size_t there = 0;
    begin_ends(count, out);
    for (size_t i = 0; i < count; i++) {
        const sgt_ray *ray = &launched[i].ray;
        set_untraced(&at[i], &launched[i], &out[i]);
        if (launched[i].status != SGT_MET) continue;
        m->o[0][there] = ray->o.x, m->o[1][there] = ray->o.y, m->o[2][there] = ray->o.z;
        m->d[0][there] = ray->d.x, m->d[1][there] = ray->d.y, m->d[2][there++] = ray->d.z;
    }
    if (there) trace_many(of, m, there, opt);
    for (size_t i = 0, k = 0; i < count; i++) {
        if (launched[i].status != SGT_MET) continue;
        out[i].folded = launched[i].folded;
        tell_end(of, m, k++, &out[i]);
    }
}

struct sgt_ends_room {
    size_t part;
    sgt_element *own;
    sgt_launched *launched;     /* and of those that a map has not led to their points: */
    sgt_pupil_point other[PART];
    sgt_ray_end other_end[PART];
    many *m;
    sgt_aim_room *aims;         /* NULL: rays are not aimed */
    sgt_ray_end *end;
};

void sgt_ends_room_free(const sgt_launcher *from, sgt_ends_room *r)
{
    if (!r) return;
    sgt_aim_room_free(from, r->aims);
    sgt_launch_forget(from, r->m);
    sgt_launch_forget(from, r->launched);
    sgt_launch_forget(from, r->own);
    sgt_launch_forget(from, r->end);
    sgt_launch_forget(from, r);
}

sgt_ends_room *sgt_ends_room_new(const sgt_launcher *from, size_t count, unsigned wanted, size_t ends)
{
    enum { FEWEST = 8, HITS = 1 << 16 }; /* rays at a time; fewer of a long row of elements */
    const size_t surfaces = from->lens->count, fit = HITS / surfaces;
    const size_t most = fit < FEWEST ? FEWEST : fit < PART ? fit : PART;
    const bool aims = from->aim != SGT_LENS_AIM_PUPIL;
    sgt_ends_room *r = sgt_launch_take(from, 1, sizeof *r);
    if (!r) return NULL;
    r->part = count < most ? count : most;
    r->own = sgt_launch_take(from, surfaces, sizeof *r->own);
    r->launched = sgt_launch_take(from, aims ? r->part : 0, sizeof *r->launched);
    r->m = many_new(from, r->part, wanted);
    r->aims = aims ? sgt_aim_room_new(from, r->part) : NULL;
    r->end = sgt_launch_take(from, ends, sizeof *r->end);
    if (r->own && r->launched && r->m && r->end && (r->aims || !aims)) return r;
    sgt_ends_room_free(from, r);
    return NULL;
}

/* Does a trace ask for the roots that aiming asks for? */
static bool asks_as_aims(const sgt_options *opt)
{
    return !opt || (opt->pick != SGT_FIRST && opt->proof == SGT_ESTIMATE && opt->t_tol == 0 && !opt->watch);
}

/* By the fitted map; those that it leaves are aimed and traced again. */
static void trace_guessed(const sgt_colour_beam *of, sgt_ends_room *r, size_t count,
                          const sgt_pupil_point at[], const sgt_options *opt, sgt_ray_end out[])
{
    static const sgt_launched there = {.status = SGT_MET};
    many *m = r->m;
    size_t left[PART];
    sgt_aim_guess(of, r->aims, count, at, m->o, m->d);
    trace_many(of, m, count, opt);
    const sgt_traced traced = {.fate = m->fate, .passed = m->passed};
    const size_t missed =
        sgt_aim_missed(r->aims, count, at, m->o, m->d, traced, &m->at[of->from->lens->stop].hits, left);
    begin_ends(count, out);
    for (size_t i = 0, k = 0; i < count; i++) {
        if (k < missed && left[k] == i) {
            r->other[k++] = at[i];
            continue;
        }
        set_untraced(&at[i], &there, &out[i]);
        tell_end(of, m, i, &out[i]);
    }
    if (missed == 0) return;
    sgt_aim_map plain = *of->map;
    sgt_colour_beam searched = *of;
    plain.fitted = false, searched.map = &plain;
    sgt_aim_rays(&searched, r->aims, missed, r->other, r->launched);
    trace_aimed(of, m, missed, r->launched, r->other, opt, r->other_end);
    for (size_t k = 0; k < missed; k++) out[left[k]] = r->other_end[k];
}

sgt_ray_end *sgt_trace_ends(const sgt_colour_beam *of, sgt_ends_room *r, size_t count,
                            const sgt_pupil_point at[], const sgt_options *opt, sgt_ray_end out[])
{
    sgt_ray_end *const all = out ? out : r->end;
    sgt_colour_beam own = *of;
    const bool guessed = of->map && of->map->fitted && asks_as_aims(opt);
    out = all, own.e = r->own;
    sgt_launch_ending(of->from->lens->count, of->e, r->own);
    for (size_t first = 0; first < count; first += r->part, at += r->part, out += r->part) {
        const size_t rays = count - first < r->part ? count - first : r->part;
        if (!r->aims) {
            trace_unaimed(&own, r->m, rays, at, opt, out);
        } else if (guessed) {
            trace_guessed(&own, r, rays, at, opt, out);
        } else {
            sgt_aim_rays(&own, r->aims, rays, at, r->launched);
            trace_aimed(&own, r->m, rays, r->launched, at, opt, out);
        }
    }
    return all;
}

bool sgt_trace_pupil(const sgt_launcher *from, const sgt_field_beam *b, const sgt_element e[],
                     double index_before, const sgt_pupil_rays *rays, const sgt_options *opt,
                     sgt_error *error)
{
    if (!PLAIN(from, b, "sgt_field_beam", error)) return false;
    sgt_ends_room *room = sgt_ends_room_new(from, rays->count, END_ALL, 0);
    if (!room) return sgt_launch_memory(from, error);
    const sgt_colour_beam of = {from, b, e, index_before, NULL};
    sgt_trace_ends(&of, room, rays->count, rays->at, opt, rays->end);
    sgt_ends_room_free(from, room);
    return true;
}

void sgt_ends_as_angles(const sgt_vec3 *axis, size_t count, const sgt_ray_end end[], sgt_ray_end out[])
{
    const double MILLI = 1e3;
    const sgt_vec3 z = *axis, ey = unit3(cross3(z, (sgt_vec3){1, 0, 0})), ex = cross3(ey, z);
    for (size_t i = 0; i < count; i++) {
        const sgt_vec3 d = end[i].d, off = minus3(d, z); /* whose parts across the axis lose no digits */
        out[i] = end[i];
        const double ahead = dot3(d, z);
        out[i].p = (sgt_vec3){MILLI * atan2(dot3(off, ex), ahead), MILLI * atan2(dot3(off, ey), ahead), 0};
        out[i].p_err = MILLI * (end[i].d_err + 0x1p-51);
    }
}

bool sgt_trace_chief(const sgt_launcher *from, const sgt_field_beam *b, const sgt_element e[],
                     double index_before, sgt_ray_end *out, sgt_error *error)
{
    static const sgt_pupil_point centre = {0, 0, 1};
    const size_t count = from->lens->count;
    sgt_passage *passages = sgt_launch_take(from, count, sizeof *passages);
    sgt_element *own = sgt_launch_take(from, 2 * count, sizeof *own), *open = own ? own + count : NULL;
    sgt_launched launched;
    bool fine = (passages && own) || sgt_launch_memory(from, error);
    if (fine) sgt_launch_ending(count, e, own);
    fine = fine && sgt_launch_rays(from, b, own, index_before, 1, &centre, &launched, error);
    if (fine) {
        begin_ends(1, out);
        set_untraced(&centre, &launched, out);
        if (launched.status == SGT_MET) {
            sgt_trace_through(count, own, index_before, &launched.ray, open, passages, &out->fate);
            follow(&(sgt_colour_beam){from, b, open, index_before, NULL}, &launched, passages, out);
            if (out->fate == SGT_PASSED && !from->lens->afocal)
                out->d_err = sgt_direction_error(from, open, index_before, &launched.ray, out);
        }
    }
    sgt_launch_forget(from, own);
    sgt_launch_forget(from, passages);
    return fine;
}
