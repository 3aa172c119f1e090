// SPDX-License-Identifier: MIT
/* chain_batch.c - the links of a tile of rays at one element (chain_batch.h). */
#include "chain_batch.h"

/* ---------------------------------------------------------------------- frames */

SGT_KERNEL
static void into_frame(const sgt_pose *pose, size_t n, const double *x, const double *y, const double *z,
                       chain_vectors *out)
{
    const sgt_pose axes = *pose;
    LANES for (size_t i = 0; i < n; i++) chain_put(out, i, to_local(&axes, (sgt_vec3){x[i], y[i], z[i]}));
}

SGT_KERNEL
static void out_of_frame(const sgt_pose *pose, size_t n, const double *x, const double *y, const double *z,
                         chain_vectors *out)
{
    const sgt_pose axes = *pose;
    LANES for (size_t i = 0; i < n; i++) chain_put(out, i, to_global(&axes, (sgt_vec3){x[i], y[i], z[i]}));
}

void sgt_chain_into(const sgt_pose *pose, size_t n, chain_vectors *a)
{
    if (is_turned(pose)) into_frame(pose, n, a->x, a->y, a->z, a);
}

void sgt_chain_out_of(const sgt_pose *pose, size_t n, chain_vectors *a)
{
    if (is_turned(pose)) out_of_frame(pose, n, a->x, a->y, a->z, a);
}

SGT_KERNEL
static void launch_directions(size_t n, const double *x, const double *y, const double *z, chain_vectors *out)
{
    LANES for (size_t i = 0; i < n; i++) chain_put(out, i, unit_of((sgt_vec3){x[i], y[i], z[i]}).d);
}

/* Sets view.d to the directions in front of element i, in its frame: to those of the passages themselves, if
 * nothing is turned. */
static void directions_in_front(const chain_work *work, size_t i, chain_tile *b)
{
    const sgt_pose *before = i > 0 ? &work->e[i - 1].pose : NULL, *pose = &b->e->pose;
    const double *const *launch = work->rays->d;
    const size_t first = b->first, n = b->n;
    chain_vectors *out = &b->front;
    chain_arrays from = {launch[0] + first, launch[1] + first, launch[2] + first};
    if (i > 0) from = chain_arrays_of(work->passages[i - 1].direction, first);
    b->view.d = from;
    if (i == 0)
        launch_directions(n, from.x, from.y, from.z, out);
    else if (is_turned(before))
        out_of_frame(before, n, from.x, from.y, from.z, out);
    else if (b->turned)
        into_frame(pose, n, from.x, from.y, from.z, out);
    else
        return;
    if (b->turned && (i == 0 || is_turned(before))) into_frame(pose, n, out->x, out->y, out->z, out);
    b->view.d = (chain_arrays){out->x, out->y, out->z};
}

/* ----------------------------------------------------------------------- links */

/* 1 where the status is positive, else 0.  Two loops, by way of int: bytes and doubles in one loop make long
 * code.  Returns how many there are. */
SGT_KERNEL
static int which_met(size_t n, const sgt_status *status, double *out)
{
    int wide[CHAIN_RAYS], count = 0;
#pragma omp simd reduction(+ : count)
    for (size_t i = 0; i < n; i++) wide[i] = status[i] > 0, count += wide[i];
    LANES for (size_t i = 0; i < n; i++) out[i] = wide[i];
    return count;
}

SGT_INLINE void link_by(bend_kind kind, chain_tile *b)
{
    const bending by = {kind, b->by.r, b->by.k};
    const chain_view v = b->view;
    const size_t n = b->n;
    LANES for (size_t i = 0; i < n; i++)
    {
        const chain_slope s = chain_slope_of(by, chain_from(v.d, i), chain_from(v.normal, i),
                                             chain_from(v.after, i), b->met[i] != 0 ? 1 : (double)NAN);
        b->inverse[i] = s.inverse, b->by_S[i] = s.by_S, b->f[i] = s.f, b->passed[i] = s.passed;
    }
}

SGT_KERNEL
static void link_all(chain_tile *b)
{
    switch (b->by.kind) {
    case BY_PHASE:
    case STRAIGHT:
        link_by(STRAIGHT, b);
        break;
    case BY_WAVES:
        link_by(BY_WAVES, b);
        break;
    case BACK:
        link_by(BACK, b);
        break;
    case ON:
    case ON_BY_SINE:
        link_by(ON, b);
        break;
    }
}

void sgt_chain_tile_place(const chain_work *work, size_t i, size_t first, size_t n, chain_tile *b)
{
    const sgt_passages *passage = &work->passages[i];
    chain_view *v = &b->view;
    chain_link all;
    b->n = n, b->first = first, b->e = &work->e[i], b->s = chain_surface(b->e->surface);
    b->turned = is_turned(&b->e->pose);
    b->by = chain_set(b->e, chain_index(work->e, i, work->index_before), &all);
    b->bends = all.bends, b->phased = all.phased;
    *v = (chain_view){.t = passage->hits.t + first,
                      .inverse = b->inverse,
                      .by_S = b->by_S,
                      .f = b->f,
                      .passed = b->passed,
                      .r = all.r,
                      .n1 = all.n1,
                      .n2 = all.n2,
                      .own_index = all.own_index};
    v->p = chain_arrays_of(passage->hits.p, first), v->normal = chain_arrays_of(passage->hits.n, first);
    v->after = chain_arrays_of(passage->direction, first);
    v->xx = b->h[0], v->xy = b->h[1], v->xz = b->h[2], v->yy = b->h[3], v->yz = b->h[4], v->zz = b->h[5];
    directions_in_front(work, i, b);
}

void sgt_chain_tile_at(const chain_work *work, size_t i, size_t first, size_t n, chain_tile *b)
{
    const sgt_passages *passage = &work->passages[i];
    const chain_view *v = &b->view;
    int met = (int)n;
    sgt_chain_tile_place(work, i, first, n, b);
    b->shown = (sgt_points){{v->p.x, v->p.y, v->p.z}};
    if (passage->hits.status)
        met = which_met(n, passage->hits.status + first, b->met);
    else
        for (size_t j = 0; j < n; j++) b->met[j] = 1;
    link_all(b);
    if (met != 0 && met != (int)n) {
        size_t some = 0;
        while (b->met[some] == 0) some++;
        for (size_t j = 0; j < n; j++) chain_put(&b->place, j, chain_from(v->p, b->met[j] != 0 ? j : some));
        b->shown = (sgt_points){{b->place.x, b->place.y, b->place.z}};
    }
    if (b->phased && b->bends)
        sgt_waves_tile(b->e->phase, n, b->shown, b->waves[0],
                       (double *const[3]){b->waves[1], b->waves[2], b->waves[3]});
}

bool sgt_chain_tile_second(chain_tile *b)
{
    double *const out[6] = {b->h[0], b->h[1], b->h[2], b->h[3], b->h[4], b->h[5]};
    if (b->s.ops->second)
        b->s.ops->second(b->s.self, b->n, b->shown, out);
    else
        for (int k = 0; k < 6; k++)
            for (size_t i = 0; i < b->n; i++) b->h[k][i] = (double)NAN;
    if (!b->phased) return b->s.ops->second != NULL;
    double *const by[6] = {b->by_waves[0], b->by_waves[1], b->by_waves[2],
                           b->by_waves[3], b->by_waves[4], b->by_waves[5]};
    const bool has = sgt_waves_second(b->e->phase, b->n, b->shown, by);
    for (int k = 0; k < 6; k++)
        for (size_t i = 0; i < b->n; i++) by[k][i] *= second_factor(b->e->phase);
    return has && b->s.ops->second;
}
