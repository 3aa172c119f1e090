// SPDX-License-Identifier: MIT
/* lot.c - from the world into an object's frame and back.
 *
 * An object's frame is placed by a similarity, p = origin + scale R q, so a ray's parameter is the
 * same number in both: with d / scale for a direction, t counts lengths of the world's d.
 *
 * A lot of rays at a time is taken into an object's frame, as arrays, and put to the library as one batch.
 * An answer does not depend on its neighbours, so neither does a picture on the lots.
 *
 * A ray that starts on an object starts, there, from the point that the library gave and not from
 * what rounding made of it on the way through the world.  It is put to sgt_leave_batch, with all others of
 * the lot that start on the same object.  So the root at the start is left out however far p_err says that
 * the point may be off, and no distance has to be chosen for it.  With a coarse t_tol that is far, and the
 * point that the library starts from instead may be on another fold.  On a closed surface the sign of F
 * tells: a ray that left for the outside can only enter, where F falls, and one inside can only leave.  A
 * root the other way is the start again, and is passed by. */
#include "lot.h"

/* Of the world into a frame that is `small` times as fine. */
static inline vec3 direction_in(const sgt_pose *p, double small, vec3 d)
{
    return scaled((vec3){dot(p->ex, d), dot(p->ey, d), dot(p->ez, d)}, small);
}

static inline vec3 point_in(const sgt_pose *p, double small, vec3 at)
{
    return direction_in(p, small, subtract(at, p->origin));
}

static void put_vector(row a[3], size_t i, vec3 v) { a[0][i] = v.x, a[1][i] = v.y, a[2][i] = v.z; }

sgt_ray ray_in(const object *o, const beam *b)
{
    double small = 1 / o->scale;
    return (sgt_ray){.o = b->from == o ? b->at.p : point_in(&o->pose, small, b->o),
                     .d = direction_in(&o->pose, small, b->d)};
}

static bool is_start_again(const object *o, double side, sgt_status status, vec3 n, vec3 d)
{
    return !o->sheet && status > 0 && side * dot(n, d) > 0;
}

static double side_at(const object *o, const beam *b) { return b->from == o ? b->side : 0; }

/* Does the ray, looked at from lo on, start on the object? */
static bool starts_on(const object *o, const beam *b, double lo) { return b->from == o && lo == 0; }

/* How far a root may be off in t.  To the library's own bound comes what the way into the frame has
 * rounded of the ray's points, three products and sums of a point and of a direction, and how far the point
 * it starts at may be off: that moves a root by so much along the normal.  With t_tol nothing is told apart
 * by less than that, and the order is that of t. */
static double error_of(const object *o, const beam *b, const sgt_ray *ray, double t, double t_err, vec3 n)
{
    if (o->options.t_tol > 0) return 0;
    double reach = length(ray->o) + fabs(t) * length(ray->d) + length(o->pose.origin) / o->scale,
           off = b->from == o ? b->at.p_err : 0;
    double moved = (16 * 0x1p-53 * reach + off) * length(n) / fabs(dot(n, ray->d));
    return t_err + (moved < HUGE_VAL ? moved : 0);
}

/* The first look at a ray: from a start on the object itself it has *ray begin there. */
static sgt_hit first_hit(const object *o, const beam *b, sgt_ray *ray)
{
    if (!starts_on(o, b, ray->tmin)) return sgt_intersect(o->surface, *ray, &o->options);
    sgt_start from = {.p = b->at.p, .n = b->at.n, .p_err = b->at.p_err, .d = ray->d, .tmax = ray->tmax};
    sgt_crossing next = sgt_leave(o->surface, &from, &o->options);
    *ray = next.ray;
    return next.hit;
}

/* The start is passed by as often as it is found.  evals is the sum. */
event event_alone(const object *o, const beam *b, double tmin, double far, double side)
{
    sgt_ray ray = ray_in(o, b);
    ray = sgt_ray_between(ray.o, ray.d, tmin, far); /* both may be 0 */
    for (int i = 0, spent = 0;; i++) {
        if (!(ray.tmin < far)) return (event){.evals = spent};
        sgt_hit hit = i == 0 ? first_hit(o, b, &ray) : sgt_intersect(o->surface, ray, &o->options);
        spent += hit.evals;
        if (i < 8 && is_start_again(o, side, hit.status, hit.n, ray.d)) {
            ray.tmin = hit.t;
            continue;
        }
        double err = hit.status > 0 ? error_of(o, b, &ray, hit.t, hit.t_err, hit.n) : 0;
        event e = {hit.status, spent, hit.t, hit.t - err, hit.t + err, hit.p, hit.n, hit.p_err};
        /* what is left of the ray, where the library says nothing of the place */
        if (e.status < 0)
            e.lo = hit.lo > ray.tmin ? hit.lo : ray.tmin, e.hi = hit.hi > e.lo && hit.hi < far ? hit.hi : far;
        return e;
    }
}

void lot_add(lot *l, const beam *b, double lo, double far)
{
    size_t i = l->n++;
    l->beam[i] = b;
    put_vector(l->world_o, i, b->o);
    put_vector(l->world_d, i, b->d);
    l->lo[i] = lo, l->far[i] = far;
}

static sgt_hits hits_of(lot *l)
{
    return (sgt_hits){.status = l->status,
                      .evals = l->evals,
                      .t = l->t,
                      .t_err = l->t_err,
                      .p = {l->p[0], l->p[1], l->p[2]},
                      .n = {l->n_at[0], l->n_at[1], l->n_at[2]},
                      .p_err = l->p_err};
}

/* All of the lot start on the object, or none. */
static void ask(lot *l, const object *o, bool leaving)
{
    if (!leaving) {
        sgt_rays rays = {.o = {l->o[0], l->o[1], l->o[2]},
                         .d = {l->d[0], l->d[1], l->d[2]},
                         .tmin = l->lo,
                         .tmax = l->far};
        sgt_intersect_batch(o->surface, l->n, rays, hits_of(l), &o->options);
        return;
    }
    row n[3], p_err;
    for (size_t i = 0; i < l->n; i++) {
        const spot *at = &l->beam[i]->at;
        put_vector(l->o, i, at->p);
        put_vector(n, i, at->n);
        p_err[i] = at->p_err;
    }
    sgt_starts from = {.p = {l->o[0], l->o[1], l->o[2]},
                       .n = {n[0], n[1], n[2]},
                       .p_err = p_err,
                       .d = {l->d[0], l->d[1], l->d[2]},
                       .tmax = l->far};
    sgt_leave_batch(o->surface, l->n, from, hits_of(l), NULL, &o->options);
}

/* Those of a lot that start on the object, or the others, as a lot of their own. */
static void ask_some(lot *l, const object *o, bool leaving)
{
    lot some;
    size_t of[LOT];
    some.n = 0;
    for (size_t i = 0; i < l->n; i++) {
        if (starts_on(o, l->beam[i], l->lo[i]) != leaving) continue;
        size_t k = some.n++;
        of[k] = i, some.beam[k] = l->beam[i], some.lo[k] = l->lo[i], some.far[k] = l->far[i];
        put_vector(some.o, k, vector_of(l->o, i));
        put_vector(some.d, k, vector_of(l->d, i));
    }
    ask(&some, o, leaving);
    for (size_t k = 0; k < some.n; k++) {
        size_t i = of[k];
        l->status[i] = some.status[k], l->evals[i] = some.evals[k], l->t[i] = some.t[k];
        l->t_err[i] = some.t_err[k], l->p_err[i] = some.p_err[k];
        put_vector(l->p, i, vector_of(some.p, k));
        put_vector(l->n_at, i, vector_of(some.n_at, k));
    }
}

void lot_meet(lot *l, const object *o)
{
    const sgt_pose pose = o->pose;
    const double small = 1 / o->scale;
    const size_t n = l->n;
    size_t starts = 0;
    #pragma omp simd
    for (size_t i = 0; i < n; i++) {
        put_vector(l->o, i, point_in(&pose, small, vector_of(l->world_o, i)));
        put_vector(l->d, i, direction_in(&pose, small, vector_of(l->world_d, i)));
    }
    for (size_t i = 0; i < n; i++) {
        if (l->beam[i]->from == o) put_vector(l->o, i, l->beam[i]->at.p);
        starts += starts_on(o, l->beam[i], l->lo[i]);
    }
    if (starts == 0 || starts == n) {
        ask(l, o, starts > 0);
    } else {
        ask_some(l, o, true);
        ask_some(l, o, false);
    }
    for (size_t i = 0; i < n; i++) {
        const beam *b = l->beam[i];
        if (!is_start_again(o, side_at(o, b), l->status[i], vector_of(l->n_at, i), vector_of(l->d, i)))
            continue;
        event e = event_alone(o, b, l->lo[i], l->far[i], b->side);
        l->status[i] = e.status, l->evals[i] = e.evals, l->t[i] = e.t;
        l->t_err[i] = e.hi - e.t, l->p_err[i] = e.p_err;
        put_vector(l->p, i, e.p);
        put_vector(l->n_at, i, e.n);
    }
}

/* A batch tells no stretch: an undecided ray is asked once more, by itself. */
event lot_event(lot *l, size_t i, const object *o)
{
    const beam *b = l->beam[i];
    sgt_status status = (sgt_status)l->status[i];
    if (status < 0) {
        event e = event_alone(o, b, l->lo[i], l->far[i], side_at(o, b));
        e.evals += l->evals[i];
        return e;
    }
    sgt_ray ray = {.o = vector_of(l->o, i), .d = vector_of(l->d, i)};
    double err = status > 0 ? error_of(o, b, &ray, l->t[i], l->t_err[i], vector_of(l->n_at, i)) : 0;
    return (event){status, l->evals[i], l->t[i], l->t[i] - err, l->t[i] + err, vector_of(l->p, i),
                   vector_of(l->n_at, i), l->p_err[i]};
}
