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
 * MANY RAYS go side by side, some hundred at a time, through the loops of sgt_trace_batch and
 * sgt_trace_error_batch, whose numbers are those of one ray to the bit.  One by one is the chief ray alone,
 * whatever clips it, and what an afocal lens needs besides. */
#include "launch.h"

static const double ULP = 0x1p-53, LAUNCH = 6, GRAINS = 4;

static double launch_error(const sgt_field_beam *b, const sgt_ray *ray, double index)
{
    if (b->finite) return 0;
    return LAUNCH * ULP * index * (length3(ray->o) + fabs(b->wave) + fabs(b->pupil));
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

/* The bounds of a ray that passed. */
static void set_errors(const sgt_field_beam *b, const sgt_launched *l, double before,
                       const sgt_end_error *off, sgt_ray_end *out)
{
    out->p_err = off->point + GRAINS * off->grain;
    if (isnan(out->p_err)) out->p_err = HUGE_VAL;
    out->opl_err = off->path + GRAINS * off->path_grain + launch_error(b, &l->ray, before == 0 ? 1 : before);
    if (isnan(out->opl_err)) out->opl_err = HUGE_VAL;
}

static void follow(const sgt_launcher *from, const sgt_field_beam *b, const sgt_element e[], double before,
                   const sgt_launched *l, const sgt_options *opt, sgt_passage passages[], sgt_ray_end *out)
{
    const size_t count = from->lens->count;
    sgt_ray ray = l->ray;
    size_t passed = sgt_trace(count, e, before, &ray, passages, &out->fate, opt);
    out->element = passed < count ? passed : count - 1;
    const sgt_passage *last = &passages[out->element];
    out->status = last->hit.status, out->folded = l->folded;
    out->proven = passed == count;
    sgt_vec3 d = l->ray.d, in = d;
    for (size_t i = 0; i <= out->element; i++) {
        const sgt_hit *hit = &passages[i].hit;
        in = into3(&e[i].pose, d);
        if (hit->status > 0)
            out->condition = fmax(out->condition, length3(hit->n) * length3(in) / fabs(dot3(hit->n, in)));
        d = out_of3(&e[i].pose, passages[i].direction);
        out->evals += hit->evals;
        out->t_err = fmax(out->t_err, hit->t_err);
        out->proven = out->proven && hit->status == SGT_HIT;
    }
    if (passed < count) return;
    sgt_end_error off;
    sgt_trace_error(count, e, before, &l->ray, passages, &off);
    out->p = last->hit.p, out->d = in, out->opl = last->opl;
    set_errors(b, l, before, &off, out);
    if (from->lens->afocal) out->d_err = sgt_direction_error(from, e, before, &l->ray, out);
}

static sgt_ray_end not_traced(const sgt_pupil_point *at, const sgt_launched *l)
{
    const double none = (double)NAN;
    const sgt_vec3 nowhere = {none, none, none};
    return (sgt_ray_end){.px = at->x, .py = at->y, .weight = at->weight, .aimed = l->status,
                         .within = l->within, .fate = SGT_LOST, .status = SGT_EXHAUSTED, .p = nowhere,
                         .d = nowhere, .opl = none, .p_err = none, .opl_err = none, .d_err = none};
}

/* -------------------------------------------------------------- many rays at once */

/* Rays that were launched, number by number, and what their traces leave: [rays] each. */
typedef struct many {
    size_t rays;
    double *o[3], *d[3];
    double *in[3];              /* the direction in front of an element, in its frame */
    sgt_fate *fate;
    int *passed;
    sgt_passages *at;           /* [elements] */
    sgt_end_errors off;
    double *t_err, *condition;
    int *evals;
    bool *met;           /* a hit at every element so far */
} many;

/* Room for it as one block: [elements] passages in front, then numbers.  NULL: no memory. */
static many *many_new(const sgt_launcher *from, size_t rays)
{
    enum { NUMBERS = 13, OTHERS = 15, BYTES = 4 };
    const size_t count = from->lens->count, each = NUMBERS * sizeof(double) + sizeof(int) + 1;
    const size_t size = sizeof(many) + count * (sizeof(sgt_passages) + rays * each) +
                        rays * (OTHERS * sizeof(double) + 2 * sizeof(int) + BYTES) + 64;
    char *room = sgt_launch_take(from, size, 1);
    if (!room) return NULL;
    many *m = (void *)room;
    *m = (many){.rays = rays, .at = (void *)(room + sizeof *m)};
    double *number = (double *)(void *)(m->at + count);
    for (size_t i = 0; i < count; i++) {
        sgt_passages *p = &m->at[i];
        *p = (sgt_passages){.opl = number};
        number += rays;
        for (int k = 0; k < 3; k++)
            p->hits.p[k] = number, p->hits.n[k] = number + rays, p->direction[k] = number + 2 * rays,
            number += 3 * rays;
        p->hits.t = number, p->hits.t_err = number + rays, p->hits.p_err = number + 2 * rays,
        number += 3 * rays;
    }
    for (int k = 0; k < 3; k++)
        m->o[k] = number, m->d[k] = number + rays, m->in[k] = number + 2 * rays, number += 3 * rays;
    m->off = (sgt_end_errors){.point = number, .path = number + rays, .grain = number + 2 * rays,
                              .path_grain = number + 3 * rays};
    m->t_err = number + 4 * rays, m->condition = number + 5 * rays, number += 6 * rays;
    int *whole = (int *)(void *)number;
    m->passed = whole, m->evals = whole + rays, whole += 2 * rays;
    for (size_t i = 0; i < count; i++) m->at[i].hits.evals = whole, whole += rays;
    sgt_status *status = (sgt_status *)whole;
    for (size_t i = 0; i < count; i++) m->at[i].hits.status = status, status += rays;
    m->fate = (sgt_fate *)status, m->met = (bool *)(m->fate + rays);
    return m;
}

/* An element: what it cost, and the directions in front of it and behind; of the last one those in front, in
 * its frame, stay.  A ray that did not get there has the status 0 and no evaluations, and NaN else. */
static void pass_element(many *m, const sgt_pose *pose, const sgt_passages *p, size_t rays, bool last)
{
    const bool turned = dot3(pose->ex, pose->ex) != 0;
    const double *nx = p->hits.n[0], *ny = p->hits.n[1], *nz = p->hits.n[2], *t_err = p->hits.t_err;
    double *x = m->in[0], *y = m->in[1], *z = m->in[2], *condition = m->condition, *most = m->t_err;
    for (size_t k = 0; k < rays && turned; k++) {
        const sgt_vec3 in = into3(pose, (sgt_vec3){x[k], y[k], z[k]});
        x[k] = in.x, y[k] = in.y, z[k] = in.z;
    }
    for (size_t k = 0; k < rays; k++) {
        const sgt_vec3 n = {nx[k], ny[k], nz[k]}, d = {x[k], y[k], z[k]};
        const double c = length3(n) * length3(d) / fabs(dot3(n, d)), own = p->hits.status[k] > 0 ? c : 0;
        condition[k] = own > condition[k] ? own : condition[k]; /* not a NaN */
        most[k] = t_err[k] > most[k] ? t_err[k] : most[k];
    }
    for (size_t k = 0; k < rays; k++) m->evals[k] += p->hits.evals[k];
    for (size_t k = 0; k < rays; k++) m->met[k] = m->met[k] && p->hits.status[k] == SGT_HIT;
    for (size_t k = 0; k < rays && !last; k++) {
        const sgt_vec3 out =
            out_of3(pose, (sgt_vec3){p->direction[0][k], p->direction[1][k], p->direction[2][k]});
        x[k] = out.x, y[k] = out.y, z[k] = out.z;
    }
}

/* Traces the rays that are in m, and sets all else of it. */
static void trace_many(const sgt_launcher *from, const sgt_element e[], double before, many *m, size_t rays,
                       const sgt_options *opt)
{
    const size_t count = from->lens->count;
    const sgt_rays launch = {.o = {m->o[0], m->o[1], m->o[2]}, .d = {m->d[0], m->d[1], m->d[2]}};
    sgt_trace_batch(count, e, before, rays, launch, (sgt_traced){.fate = m->fate, .passed = m->passed}, m->at,
                    opt);
    sgt_trace_error_batch(count, e, before, rays, launch, m->at, m->off);
    for (size_t k = 0; k < rays; k++) {
        m->in[0][k] = m->d[0][k], m->in[1][k] = m->d[1][k], m->in[2][k] = m->d[2][k];
        m->t_err[k] = m->condition[k] = 0, m->evals[k] = 0, m->met[k] = 1;
    }
    for (size_t i = 0; i < count; i++) pass_element(m, &e[i].pose, &m->at[i], rays, i + 1 == count);
}

/* The end of ray k of m, as `follow` tells it. */
static void tell_end(const sgt_launcher *from, const sgt_field_beam *b, const sgt_element e[], double before,
                     const many *m, size_t k, const sgt_launched *l, sgt_ray_end *out)
{
    const size_t count = from->lens->count, passed = (size_t)m->passed[k];
    const sgt_passages *last = &m->at[count - 1];
    out->element = passed < count ? passed : count - 1;
    out->fate = m->fate[k], out->status = m->at[out->element].hits.status[k];
    out->folded = l->folded, out->proven = passed == count && m->met[k];
    out->condition = m->condition[k], out->evals = m->evals[k], out->t_err = m->t_err[k];
    if (passed < count) return;
    out->p = (sgt_vec3){last->hits.p[0][k], last->hits.p[1][k], last->hits.p[2][k]};
    out->d = (sgt_vec3){m->in[0][k], m->in[1][k], m->in[2][k]}, out->opl = last->opl[k];
    set_errors(b, l, before,
               &(sgt_end_error){.point = m->off.point[k], .path = m->off.path[k], .grain = m->off.grain[k],
                                .path_grain = m->off.path_grain[k]}, out);
    if (from->lens->afocal) out->d_err = sgt_direction_error(from, e, before, &l->ray, out);
}

/* Some rays: those that are there are put side by side. */
static void trace_part(const sgt_launcher *from, const sgt_field_beam *b, const sgt_element e[],
                       double before, many *m, size_t count, const sgt_launched launched[],
                       const sgt_pupil_point at[], const sgt_options *opt, sgt_ray_end out[])
{
    size_t there = 0;
    for (size_t i = 0; i < count; i++) {
        const sgt_ray *ray = &launched[i].ray;
        out[i] = not_traced(&at[i], &launched[i]);
        if (launched[i].status != SGT_MET) continue;
        m->o[0][there] = ray->o.x, m->o[1][there] = ray->o.y, m->o[2][there] = ray->o.z;
        m->d[0][there] = ray->d.x, m->d[1][there] = ray->d.y, m->d[2][there++] = ray->d.z;
    }
    if (there) trace_many(from, e, before, m, there, opt);
    for (size_t i = 0, k = 0; i < count; i++)
        if (launched[i].status == SGT_MET) tell_end(from, b, e, before, m, k++, &launched[i], &out[i]);
}

bool sgt_trace_pupil(const sgt_launcher *from, const sgt_field_beam *b, const sgt_element e[],
                     double index_before, size_t count, const sgt_pupil_point at[], const sgt_options *opt,
                     sgt_ray_end out[], sgt_error *error)
{
    enum { MOST = 128, FEWEST = 8, HITS = 1 << 16 }; /* rays at a time; fewer of a long row of elements */
    const size_t surfaces = from->lens->count, fit = HITS / surfaces;
    const size_t most = fit < FEWEST ? FEWEST : fit < MOST ? fit : MOST, part = count < most ? count : most;
    sgt_element *own = sgt_launch_take(from, surfaces, sizeof *own);
    sgt_launched *launched = sgt_launch_take(from, part, sizeof *launched);
    many *m = many_new(from, part);
    bool fine = (own && launched && m) || sgt_launch_memory(from, error);
    if (fine) sgt_launch_ending(surfaces, e, own);
    for (size_t first = 0; first < count && fine; first += part) {
        const size_t rays = count - first < part ? count - first : part;
        fine = sgt_launch_rays(from, b, own, index_before, rays, at + first, launched, error);
        if (fine) trace_part(from, b, own, index_before, m, rays, launched, at + first, opt, out + first);
    }
    sgt_launch_forget(from, m);
    sgt_launch_forget(from, launched);
    sgt_launch_forget(from, own);
    return fine;
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
    sgt_element *own = sgt_launch_take(from, 2 * count, sizeof *own), *open = own + count;
    sgt_launched launched;
    bool fine = (passages && own) || sgt_launch_memory(from, error);
    if (fine) sgt_launch_ending(count, e, own);
    fine = fine && sgt_launch_rays(from, b, own, index_before, 1, &centre, &launched, error);
    if (fine) {
        *out = not_traced(&centre, &launched);
        if (launched.status == SGT_MET) {
            sgt_trace_through(count, own, index_before, &launched.ray, open, passages, &out->fate);
            follow(from, b, open, index_before, &launched, NULL, passages, out);
            if (out->fate == SGT_PASSED && !from->lens->afocal)
                out->d_err = sgt_direction_error(from, open, index_before, &launched.ray, out);
        }
    }
    sgt_launch_forget(from, own);
    sgt_launch_forget(from, passages);
    return fine;
}
