// SPDX-License-Identifier: MIT
/* front.c - the figure opd: path differences of wavefronts.
 *
 * A PATH DIFFERENCE (../study/wavefront.c) is, with v = p - c, b = v . d and h^2 = v^2 - b^2,
 *
 *     OPD = L - L0 + n (h^2 / G - b),    G = R + root,  root = +-sqrt(R^2 - h^2) with the sign of R,
 *
 * and without h^2 / G where R is infinite.  With K = 1 / G + h^2 / (2 G^2 root) it moves by
 *
 *     dL - dL0 + n (2 K v - (2 K b + 1) d) . (dp - dc) - n (2 K b + 1) v . dd
 *              - n h^2 / G^2 (1 + R / root) dR + dn (h^2 / G - b) :
 *
 * one weighted sum of the end for each ray, and the chief ray's. */
#include "asked.h"

/* The place of the index of the image space among the numbers of a trace. */
static size_t image_index(const flock *f)
{
    size_t at = 6;
    for (size_t i = 0; i + 1 < f->elements; i++)
        if (f->own[i].index != SGT_MIRROR && f->own[i].index != 0)
            at = sgt_trace_parameters(i + 1, f->own) - 1;
    return at;
}

/* A path difference, the weights by which the end of the ray moves it, and its derivatives by R and n. */
typedef struct opd_change {
    double opd, by_radius, by_index;
    sgt_vec3 p, d;
} opd_change;

static opd_change opd_moved(const sgt_reference *of, const sgt_ray_change *end)
{
    const double n = of->index, R = of->radius;
    const sgt_vec3 v = minus3(end->p, of->centre), d = end->d, none = {0, 0, 0};
    const double b = dot3(v, d), base = end->opl - of->opl;
    if (of->kind == SGT_REFERENCE_INFINITE)
        return (opd_change){base - n * b, 0, -b, along3(none, -n, d), along3(none, -n, v)};
    const sgt_vec3 across = along3(v, -b, d);
    const double h2 = dot3(across, across), root = copysign(sqrt(R * R - h2), R), G = R + root;
    const double K = 1 / G + h2 / (2 * G * G * root), back = 2 * K * b + 1;
    return (opd_change){base + n * (h2 / G - b), -n * h2 / (G * G) * (1 + R / root), h2 / G - b,
                        along3(along3(none, 2 * n * K, v), -n * back, d), along3(none, -n * back, v)};
}

/* How a number of the file moves the reference, and what may be off in radius and index.  (What is off in
 * the chief ray is off alike in its neighbours: it is not counted twice.) */
typedef struct reference_change {
    sgt_vec3 centre;
    double opl, radius, index, radius_off, index_off;
} reference_change;

/* from_pupil: from the exit pupil to the centre; exit and index: their places among the numbers.  Of a pupil
 * that is far away the reciprocal is known better. */
static reference_change reference_moved(const asked *a, size_t m, const sgt_reference *of,
                                        sgt_vec3 from_pupil, size_t exit, size_t index)
{
    const double *c = a->chief + m;
    const motion *by = &a->motion[m];
    const size_t next = a->paths;
    reference_change r = {.centre = {c[0], c[next], c[2 * next]},
                          .opl = c[6 * next],
                          .index = by->by[index],
                          .index_off = by->error[index]};
    if (of->kind == SGT_REFERENCE_INFINITE) return r;
    const double z = a->at.number[exit], inverse_off = z * z * by->error[exit + 1];
    const bool far = inverse_off < by->error[exit];
    const sgt_vec3 moved = minus3(r.centre, (sgt_vec3){0, 0, far ? -z * z * by->by[exit + 1] : by->by[exit]});
    r.radius = dot3(from_pupil, moved) / of->radius;
    r.radius_off = far ? inverse_off : by->error[exit];
    return r;
}

static bool front_of_cell(asked *a, size_t panel, const double share[], double own_error[], double weight[])
{
    const sgt_asking *ask = &a->at.ask;
    const size_t field = panel / ask->bands, b = panel % ask->bands, points = ask->fine.count,
                 paths = a->paths;
    const double waves = a->at.study->um / ask->band[b].at.um;
    const ray_group g = {panel * points, points, 1};
    sgt_ray_change end;
    sgt_reference reference;
    flock *f = &a->rays;
    double off = 0;
    if (!sgt_chief_trace(a, field, b, true, true, &end)) return false;
    const sgt_ray_end chief = {.fate = SGT_PASSED, .p = end.p, .d = end.d, .opl = end.opl};
    if (!sgt_reference_of(ask->lens, &ask->primary.data, f->own, f->before, &chief, false, &reference,
                          a->error))
        return false;
    const sgt_vec3 from_pupil = minus3(end.p, (sgt_vec3){0, 0, ask->primary.data.exit_pupil});
    const size_t exit = a->in.first + ask->bands * FIRST_NUMBERS + 1;
    const size_t index = b * a->in.trace + image_index(f);
    for (size_t i = 0; i < points; i += f->count) {
        const size_t part = i % PUPIL_PART, whole = i - part;
        const size_t most = points - whole < PUPIL_PART ? points - whole : PUPIL_PART;
        const size_t count = most - part < FLOCK ? most - part : FLOCK;
        sgt_pupil_point at[PUPIL_PART];
        sgt_pupil_part(&ask->fine, whole, most, at);
        if (!sgt_flock_trace(f, field, b, count, at + part, false, true, true))
            return sgt_ask_fail(&a->at.ask, "", "no memory");
        a->out->rays += count;
        opd_change diff[FLOCK];
        double w[FLOCK_ROWS][FLOCK];
        for (size_t k = 0; k < count; k++) {
            const sgt_ray_change ray = sgt_flock_end(f, k);
            diff[k] = opd_moved(&reference, &ray);
            a->residual[g.first + i + k] = waves * diff[k].opd;
            weight[i + k] = sgt_sum_weight(a, f, k, at[part + k].weight, g.first + i + k, 1);
            w[0][k] = diff[k].p.x, w[1][k] = diff[k].p.y, w[2][k] = diff[k].p.z;
            w[3][k] = diff[k].d.x, w[4][k] = diff[k].d.y, w[5][k] = diff[k].d.z, w[6][k] = 1;
            if (weight[i + k] > 0) off = fmax(off, 0x1p-49 * waves * (fabs(ray.opl) + fabs(reference.opl)));
        }
        if (!paths) continue;
        const sgt_ray_changes all = {{w[0], w[1], w[2]}, {w[3], w[4], w[5]}, w[6], {0}};
        sgt_flock_back(f, 1, &all);
        a->out->backward += count;
        sgt_sum_moves(a, 0, 1, g.first + i, NULL, own_error);
        for (size_t k = 0; k < count; k++) {
            if (!(f->there[k] && f->fate[k] == SGT_PASSED)) continue;
            for (size_t m = 0; m < paths; m++) {
                const reference_change r = reference_moved(a, m, &reference, from_pupil, exit, index);
                const opd_change *o = &diff[k];
                double *to = &a->jacobian[(g.first + i + k) * paths + m];
                *to += -dot3(o->p, r.centre) - r.opl + o->by_radius * r.radius + o->by_index * r.index;
                *to *= waves;
                if (!own_error) continue;
                to = &own_error[(g.first + i + k) * paths + m];
                *to += fabs(o->by_radius) * r.radius_off + fabs(o->by_index) * r.index_off;
                *to *= waves;
            }
        }
    }
    sgt_sum_up(a, panel, g, weight, share[panel], true, off, own_error);
    return true;
}

bool sgt_figure_fronts(asked *a)
{
    const sgt_asking *ask = &a->at.ask;
    for (size_t i = 0; i + 1 < ask->lens->count; i++)
        if (ask->lens->element[i].phase && ask->lens->element[i].phase->kind == SGT_IDEAL_LENS && a->paths)
            return sgt_ask_fail(&a->at.ask, "", "no derivatives of paths through an ideal lens (element %zu)",
                                i + 1);
    for (size_t i = 0; i + 1 < ask->lens->count; i++)
        if (ask->lens->element[i].phase && ask->lens->element[i].phase->kind == SGT_FACETS && a->paths)
            return sgt_ask_fail(&a->at.ask, "", "facets give light no wavefront (element %zu)", i + 1);
    if (isnan(a->at.study->um))
        return sgt_ask_fail(&a->at.ask, "units", "must be mm, cm, m, um or in for differences in waves");
    for (size_t b = 0; b < ask->bands; b++)
        if (isnan(ask->band[b].at.um))
            return sgt_ask_fail(&a->at.ask, "wavelengths", "missing: paths are in waves");
    double *share = sgt_sum_shares(a, true), *error = sgt_sum_errors(a),
           *weight = sgt_asked_room(a, ask->fine.count);
    for (size_t i = 0; i < ask->fields * ask->bands && !sgt_asked_failed(a); i++)
        if (!front_of_cell(a, i, share, error, weight)) return false;
    if (!sgt_asked_failed(a)) sgt_sum_values(a, share);
    return !sgt_asked_failed(a);
}
