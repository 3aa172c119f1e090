/* meet.c - from the world into an object's frame and back, and the first of all objects.
 *
 * An object's frame is placed by a similarity, p = origin + scale R q, so a ray's parameter is the
 * same number in both: with d / scale for a direction, t counts lengths of the world's d.
 *
 * A lot of rays at a time is taken into an object's frame, as arrays, and put to the library as one batch.
 * Object after object is asked no farther than what is met already.  An answer does not depend on
 * its neighbours, so neither does a picture on the lots.
 *
 * A ray that starts on an object starts, there, from the point that the library gave and not from
 * what rounding made of it on the way through the world; the library then leaves out the root at the
 * start by itself.  Where t_tol is coarse that point may be off by p_err, and the ray, a flat one
 * above all, may find the surface it starts on once more.  On a closed surface the sign of F tells: a ray
 * that left for the outside can only enter, where F falls, and one inside can only leave.  A root
 * the other way is the start again, and is passed by.  No distance has to be chosen for it. */
#include "meet.h"

#include "normal.h"

static vec3 turned(const sgt_pose *p, vec3 v) /* into the world */
{
    return along(along(scaled(p->ex, v.x), v.y, p->ey), v.z, p->ez);
}

/* Of the world into a frame that is `small` times as fine. */
static inline vec3 direction_in(const sgt_pose *p, double small, vec3 d)
{
    return scaled((vec3){dot(p->ex, d), dot(p->ey, d), dot(p->ez, d)}, small);
}

static inline vec3 point_in(const sgt_pose *p, double small, vec3 at)
{
    return direction_in(p, small, subtract(at, p->origin));
}

static bool is_start_again(const object *o, const beam *b, sgt_status status, vec3 n, vec3 d)
{
    return b->from == o && !o->sheet && status > 0 && b->side * dot(n, d) > 0;
}

/* A ray by itself: the start is passed by as often as it is found.  hit.evals is the sum. */
static sgt_hit meet_alone(const object *o, const beam *b, double far)
{
    double small = 1 / o->scale;
    sgt_ray ray = {.o = b->from == o ? b->at : point_in(&o->pose, small, b->o),
                   .d = direction_in(&o->pose, small, b->d),
                   .tmax = far};
    for (int i = 0, spent = 0;; i++) {
        sgt_hit hit = sgt_intersect(o->surface, ray, &o->options);
        hit.evals = spent += hit.evals;
        if (i == 8 || !is_start_again(o, b, hit.status, hit.n, ray.d)) return hit;
        ray.tmin = hit.t;
    }
}

/* Some rays, a row for each number: in the world, in the frame of an object, and their hits with it. */
enum { LOT = 256 };
typedef double row[LOT];
typedef struct lot {
    row world_o[3], world_d[3], far, o[3], d[3], t, p[3], n[3];
    signed char status[LOT];
    int evals[LOT];
} lot;

static vec3 vector_of(row a[3], size_t i) { return (vec3){a[0][i], a[1][i], a[2][i]}; }
static void put_vector(row a[3], size_t i, vec3 v) { a[0][i] = v.x, a[1][i] = v.y, a[2][i] = v.z; }

/* Every ray's hit with one object. */
static void meet_object(const object *o, size_t n, const beam b[], lot *l)
{
    const sgt_pose pose = o->pose;
    const double small = 1 / o->scale;
    #pragma omp simd
    for (size_t i = 0; i < n; i++) {
        put_vector(l->o, i, point_in(&pose, small, vector_of(l->world_o, i)));
        put_vector(l->d, i, direction_in(&pose, small, vector_of(l->world_d, i)));
    }
    for (size_t i = 0; i < n; i++)
        if (b[i].from == o) put_vector(l->o, i, b[i].at);
    sgt_rays rays = {.o = {l->o[0], l->o[1], l->o[2]}, .d = {l->d[0], l->d[1], l->d[2]}, .tmax = l->far};
    sgt_hits hits = {.status = l->status,
                     .evals = l->evals,
                     .t = l->t,
                     .p = {l->p[0], l->p[1], l->p[2]},
                     .n = {l->n[0], l->n[1], l->n[2]}};
    sgt_intersect_batch(o->surface, n, rays, hits, &o->options);
    for (size_t i = 0; i < n; i++) {
        if (!is_start_again(o, &b[i], l->status[i], vector_of(l->n, i), vector_of(l->d, i))) continue;
        sgt_hit hit = meet_alone(o, &b[i], l->far[i]);
        l->status[i] = (signed char)hit.status, l->evals[i] = hit.evals, l->t[i] = hit.t;
        put_vector(l->p, i, hit.p);
        put_vector(l->n, i, hit.n);
    }
}

/* What the first object says that cannot tell of the way to t; zero: none. */
static sgt_status undecided_before(const scene *s, const beam *b, double t)
{
    sgt_status status = SGT_MISS;
    for (int i = 0; i < s->objects && status >= 0; i++) status = meet_alone(&s->object[i], b, t).status;
    return status < 0 ? status : SGT_MISS;
}

/* A hit is in the world what it is in its object's frame; m->n is F's gradient there. */
static void place(const beam *b, meeting *m)
{
    const object *o = m->object;
    vec3 gradient = m->n;
    m->p = along(o->pose.origin, o->scale, turned(&o->pose, m->at));
    m->n = turned(&o->pose, normal_at(o, m->at, gradient));
    if (!(length(m->n) > 0)) m->n = scaled(b->d, -1); /* no direction to be had: toward the eye */
    if (dot(m->n, b->d) > 0) m->n = scaled(m->n, -1);
    m->side = dot(turned(&o->pose, gradient), b->d) < 0 ? 1 : -1; /* by the gradient, whatever n is */
}

static void meet_lot(const scene *s, size_t n, const beam b[], meeting m[], tally *sum)
{
    lot l;
    sgt_status undecided[LOT] = {0};
    for (size_t i = 0; i < n; i++) {
        m[i] = (meeting){.status = SGT_MISS};
        put_vector(l.world_o, i, b[i].o);
        put_vector(l.world_d, i, b[i].d);
        l.far[i] = b[i].far;
    }
    for (int k = 0; k < s->objects; k++) {
        const object *o = &s->object[k];
        meet_object(o, n, b, &l);
        for (size_t i = 0; i < n; i++) {
            m[i].evals += l.evals[i];
            if (l.status[i] < 0 && !undecided[i]) undecided[i] = l.status[i];
            if (!(l.status[i] > 0 && l.t[i] < l.far[i])) continue;
            m[i].object = o, m[i].status = l.status[i], m[i].t = l.far[i] = l.t[i];
            m[i].at = vector_of(l.p, i), m[i].n = vector_of(l.n, i);
        }
    }
    for (size_t i = 0; i < n; i++) {
        /* or was it behind? */
        if (undecided[i] && m[i].object) undecided[i] = undecided_before(s, &b[i], m[i].t);
        if (undecided[i]) m[i].status = undecided[i], sum->undecided[-1 - undecided[i]]++;
        if (m[i].object) place(&b[i], &m[i]);
        sum->evals += (uint64_t)m[i].evals;
    }
    sum->rays += n;
}

void meet(const scene *s, size_t n, const beam b[], meeting m[], tally *sum)
{
    for (size_t i = 0; i < n; i += LOT) meet_lot(s, n - i < LOT ? n - i : LOT, b + i, m + i, sum);
}

void tally_add(tally *to, const tally *of)
{
    to->rays += of->rays;
    to->evals += of->evals;
    for (int i = 0; i < UNDECIDED_KINDS; i++) to->undecided[i] += of->undecided[i];
}

beam leaving(const meeting *m, vec3 direction, double far, double side, const object *medium)
{
    return (beam){.o = m->p,
                  .d = direction,
                  .far = far,
                  .from = m->object,
                  .at = m->at,
                  .side = side,
                  .medium = medium};
}
