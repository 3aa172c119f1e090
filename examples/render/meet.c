// SPDX-License-Identifier: MIT
/* meet.c - the first of all bodies.
 *
 * Body after body is asked, a lot of rays at a time, no farther than what is met already.  An answer does not
 * depend on its neighbours, so neither does a picture on the lots. */
#include "meet.h"

#include "compound.h"
#include "normal.h"

/* One ray and one body, no farther than `far`. */
static sgt_status undecided_of(const scene *s, const body *of, const beam *b, double far)
{
    answer a;
    const object *o = &s->object[of->first];
    if (body_is_plain(s, of)) return event_alone(o, b, 0, far, b->from == o ? b->side : 0).status;
    body_meet(s, of, 1, b, &far, &a);
    return a.undecided;
}

/* What the first body says that cannot tell of the way to t; zero: none. */
static sgt_status undecided_before(const scene *s, const beam *b, double t)
{
    sgt_status status = SGT_MISS;
    for (int i = 0; i < s->bodies && status >= 0; i++) status = undecided_of(s, &s->body[i], b, t);
    return status < 0 ? status : SGT_MISS;
}

/* A hit is in the world what it is in its object's frame. */
static void place(const beam *b, meeting *m)
{
    const object *o = m->object;
    m->p = along(o->pose.origin, o->scale, turned(&o->pose, m->at.p));
    m->n = turned(&o->pose, normal_at(o, m->at.p, m->at.n));
    if (!(length(m->n) > 0)) m->n = scaled(b->d, -1); /* no direction to be had: toward the eye */
    if (dot(m->n, b->d) > 0) m->n = scaled(m->n, -1);
    m->side = dot(turned(&o->pose, m->at.n), b->d) < 0 ? 1 : -1; /* by the gradient, whatever n is */
}

static void meet_plain(const object *o, lot *l, meeting m[], sgt_status undecided[])
{
    lot_meet(l, o);
    for (size_t i = 0; i < l->n; i++) {
        m[i].evals += l->evals[i];
        if (l->status[i] < 0 && !undecided[i]) undecided[i] = (sgt_status)l->status[i];
        if (!(l->status[i] > 0 && l->t[i] < l->far[i])) continue;
        m[i].object = o, m[i].status = (sgt_status)l->status[i], m[i].t = l->far[i] = l->t[i];
        m[i].t_err = l->t_err[i];
        m[i].at = (spot){vector_of(l->p, i), vector_of(l->n_at, i), l->p_err[i]};
    }
}

static void meet_compound(const scene *s, const body *of, const beam b[], lot *l, meeting m[],
                          sgt_status undecided[])
{
    answer a[LOT];
    body_meet(s, of, l->n, b, l->far, a);
    for (size_t i = 0; i < l->n; i++) {
        m[i].evals += a[i].evals;
        if (a[i].undecided && !undecided[i]) undecided[i] = a[i].undecided;
        if (!(a[i].object && a[i].hit.t < l->far[i])) continue;
        m[i].object = a[i].object, m[i].status = a[i].hit.status, m[i].t = l->far[i] = a[i].hit.t;
        m[i].t_err = a[i].hit.hi - a[i].hit.t;
        m[i].at = (spot){a[i].hit.p, a[i].hit.n, a[i].hit.p_err};
    }
}

static void meet_lot(const scene *s, size_t n, const beam b[], meeting m[], tally *sum)
{
    lot l;
    sgt_status undecided[LOT] = {0};
    l.n = 0;
    for (size_t i = 0; i < n; i++) {
        m[i] = (meeting){.status = SGT_MISS};
        lot_add(&l, &b[i], 0, b[i].far);
    }
    for (int k = 0; k < s->bodies; k++) {
        const body *of = &s->body[k];
        if (body_is_plain(s, of)) meet_plain(&s->object[of->first], &l, m, undecided);
        else meet_compound(s, of, b, &l, m, undecided);
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
