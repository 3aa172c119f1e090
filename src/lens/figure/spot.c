// SPDX-License-Identifier: MIT
/* spot.c - the figure spot: where rays meet the image, from the chief ray or the centroid. */
#include "asked.h"

/* Of a field: all wavelengths are one group. */
static bool spot_of_field(asked *a, size_t field, const double share[], double own_error[], double weight[])
{
    const sgt_asking *ask = &a->at.ask;
    const size_t points = ask->fine.count, each = 2, paths = a->paths;
    const bool centroid = a->of->opt.reference == 1;
    const ray_group g = {field * ask->bands * points * each, ask->bands * points, each};
    double one[FLOCK], zero[FLOCK] = {0}, off = 0, chief_off = 0, total = 0;
    sgt_ray_change end = {{0, 0, 0}, {0, 0, 0}, 0};
    flock *f = &a->rays;
    for (size_t k = 0; k < FLOCK; k++) one[k] = 1;
    const sgt_ray_changes x_and_y[2] = {{.p = {one, zero, zero}}, {.p = {zero, one, zero}}};
    if (!centroid && !sgt_chief_trace(a, field, ask->bands, false, true, &end)) return false;
    if (!centroid && a->bounds) chief_off = sgt_chief_error(a);
    for (size_t i = 0; i < ask->bands * points; i += f->count) {
        const size_t b = i / points, first = i % points, row = g.first + i * each;
        const size_t part = first % PUPIL_PART, left = points - first;
        size_t count = left < FLOCK ? left : FLOCK;
        sgt_pupil_point at[PUPIL_PART];
        const size_t whole = first - part, most = points - whole < PUPIL_PART ? points - whole : PUPIL_PART;
        sgt_pupil_part(&ask->fine, whole, most, at);
        if (count > most - part) count = most - part;
        if (!sgt_flock_trace(f, field, b, count, at + part, false, false, true))
            return sgt_ask_fail(&a->at.ask, "", "no memory");
        a->out->rays += count;
        const double band_weight = ask->bands > 1 ? ask->band[b].weight : 1;
        double point[FLOCK];
        if (a->bounds) sgt_flock_errors(f, point);
        for (size_t k = 0; k < count; k++) {
            const sgt_ray_change ray = sgt_flock_end(f, k);
            a->residual[row + each * k] = ray.p.x - end.p.x,
                                     a->residual[row + each * k + 1] = ray.p.y - end.p.y;
            weight[i + k] = sgt_sum_weight(a, f, k, band_weight * at[part + k].weight, row + each * k, each);
            total += weight[i + k];
            if (a->bounds && weight[i + k] > 0) off += weight[i + k] * point[k] * point[k];
        }
        if (!paths) continue;
        sgt_flock_back(f, 2, x_and_y);
        a->out->backward += count;
        sgt_sum_moves(a, 0, each, row, centroid ? NULL : a->chief, own_error);
        sgt_sum_moves(a, 1, each, row, centroid ? NULL : a->chief + paths, own_error);
    }
    sgt_sum_up(a, field, g, weight, share[field], centroid, sqrt(off / total) + chief_off, own_error);
    return true;
}

bool sgt_figure_spots(asked *a)
{
    double *share = sgt_sum_shares(a, false), *error = sgt_sum_errors(a);
    double *weight = sgt_asked_room(a, a->at.ask.bands * a->at.ask.fine.count);
    for (size_t field = 0; field < a->at.ask.fields && !sgt_asked_failed(a); field++)
        if (!spot_of_field(a, field, share, error, weight)) return false;
    if (!sgt_asked_failed(a)) sgt_sum_values(a, share);
    return !sgt_asked_failed(a);
}
