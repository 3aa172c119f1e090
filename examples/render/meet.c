/* meet.c - from the world into an object's frame and back, and the first of all objects.
 *
 * An object's frame is placed by a similarity, p = origin + scale R q, so a ray's parameter is the
 * same number in both: with d / scale for a direction, t counts lengths of the world's d.
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
    if (dot(p->ex, p->ex) == 0) return v;
    return along(along(scaled(p->ex, v.x), v.y, p->ey), v.z, p->ez);
}

static vec3 turned_back(const sgt_pose *p, vec3 v)
{
    if (dot(p->ex, p->ex) == 0) return v;
    return (vec3){dot(p->ex, v), dot(p->ey, v), dot(p->ez, v)};
}

static sgt_hit meet_object(const object *o, const beam *b, double far, int *evals)
{
    bool starts_here = b->from == o;
    sgt_ray ray = {.o = starts_here ? b->at : scaled(turned_back(&o->pose, subtract(b->o, o->pose.origin)), 1 / o->scale),
                   .d = scaled(turned_back(&o->pose, b->d), 1 / o->scale), .tmax = far};
    for (int i = 0;; i++) {
        sgt_hit hit = sgt_intersect(o->surface, ray, &o->options);
        *evals += hit.evals;
        bool start_again = starts_here && o->solid && hit.status > 0 && b->side * dot(hit.n, ray.d) > 0;
        if (!start_again || i == 8) return hit;
        ray.tmin = hit.t;
    }
}

void tally_add(tally *to, const tally *of)
{
    to->rays += of->rays;
    to->evals += of->evals;
    for (int i = 0; i < UNDECIDED_KINDS; i++) to->undecided[i] += of->undecided[i];
}

bool meet(const scene *s, const beam *b, double far, meeting *m, tally *sum, sgt_status *status, int *evals)
{
    int spent = 0;
    double unsure = HUGE_VAL; /* where the first undecided stretch begins */
    sgt_status why = SGT_MISS;
    sgt_hit first = {.status = SGT_MISS, .t = far};
    m->object = NULL;
    for (int i = 0; i < s->objects; i++) {
        sgt_hit hit = meet_object(&s->object[i], b, first.t, &spent);
        if (hit.status > 0 && hit.t < first.t) first = hit, m->object = &s->object[i];
        if (hit.status < 0 && !(hit.lo >= unsure)) unsure = hit.lo, why = hit.status;
    }
    bool undecided = why < 0 && !(unsure > first.t);
    sum->rays++;
    sum->evals += (uint64_t)spent;
    if (undecided) sum->undecided[-1 - why]++;
    if (status) *status = undecided ? why : first.status;
    if (evals) *evals = spent;
    if (!m->object) return false;
    const object *o = m->object;
    m->t = first.t;
    m->at = first.p;
    m->p = along(o->pose.origin, o->scale, turned(&o->pose, first.p));
    m->n = turned(&o->pose, normal_at(o, &first));
    if (!(length(m->n) > 0)) m->n = scaled(b->d, -1); /* no direction to be had: toward the eye */
    if (dot(m->n, b->d) > 0) m->n = scaled(m->n, -1);
    m->side = dot(turned(&o->pose, first.n), b->d) < 0 ? 1 : -1; /* by the gradient, whatever n is */
    return true;
}

beam leaving(const meeting *m, vec3 direction, double side, const object *medium)
{
    return (beam){.o = m->p, .d = direction, .from = m->object, .at = m->at, .side = side, .medium = medium};
}
