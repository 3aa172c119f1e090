// SPDX-License-Identifier: MIT
/* compound.c - union, intersection and difference of objects, and clips.
 *
 * INSIDE.  A point is inside an object where F < 0, outside where F > 0.  Of a union, an intersection, a
 * difference that follows by logic.  Along a ray it can change only at a root of one of the parts.  Between
 * roots one value of F tells; its sign is certain if |F| is above its rounding, and above what the error of
 * the point makes of it.  Else, and where F is not defined, it is not known; and what is not known is carried
 * through the logic (S. C. Kleene, 1938): outside of one part a point is outside of the intersection,
 * whatever the others are.
 *
 * THE SEARCH.  Each part is asked for its first root, all rays at a time.  The nearest root of all is looked
 * at: if the body is the same on both sides of it, it is hidden, and its part is asked for its next root.
 * Else it is the body's first hit.  So a part is asked no more often than it has hidden roots in front, and a
 * ray that meets no part costs a batch each.  (sgt_intersect_all finds the same roots; it looks for all of
 * them at once, and of a fractal there are hundreds behind the first.)
 *
 * ROOTS TOGETHER.  A root is known to an error.  Roots whose errors overlap are looked at together, since
 * their order is not known.  If the body is another in front of them than behind, it is met there, whatever
 * the order is.  If it is the same, and would be the same for all states of those parts, nothing is met.
 * Else a sliver, or an edge that is touched, may be there or not: undecided.
 *
 * UNDECIDED.  A part may answer that it cannot tell of a stretch.  If the body is the same whatever the part
 * is there, no harm is done.  Else the ray is undecided, counted as such, and goes on behind, as if nothing
 * were there.  So a hit without an undecided stretch before it is the first, as surely as the parts' own are.
 *
 * A TOUCH (a graze of one part) changes no side.  It is a touch of the body if the body depends on that part
 * there.
 *
 * WHAT IS LEFT OUT.  A body that is bounded is nowhere outside of its surface's span.  So what is intersected
 * with it, or taken from it, is asked of that stretch only, and a little more.
 *
 * CLIPS.  A ball and a box leave one stretch of a ray, by computed numbers, and nothing is asked beyond
 * it.  That of a region (another body) is asked at each hit: is this point inside?  What lies nearer to the
 * region's border than rounding lets tell is undecided. */
#include "compound.h"

#include "fail.h"

#include <stdlib.h>
#include <string.h>

static const double U = 0x1p-53, FAR_AWAY = 1e300;
enum { EVENTS_MOST = 1000 };

/* Three values: the lesser is `and`, the greater `or`. */
typedef signed char state;
enum { OUTSIDE = 0, UNKNOWN = 1, INSIDE = 2 };

static int least(int a, int b) { return a < b ? a : b; }
static int most(int a, int b) { return a > b ? a : b; }

/* Of a tree, from the states of all objects. */
static int state_of(const scene *s, int at, const state of[])
{
    const knot *k = &s->knot[at];
    if (k->op == PART) return of[k->object];
    int all = k->op == UNION ? OUTSIDE : INSIDE;
    for (int child = at + 1; child < k->end; child = s->knot[child].end) {
        int one = state_of(s, child, of);
        if (k->op == DIFFERENCE && child > at + 1) one = INSIDE - one;
        all = k->op == UNION ? most(all, one) : least(all, one);
    }
    return all;
}

/* Of an object, at the beam's point at t, which is known to t_err. */
static state state_at(const object *o, const beam *b, double t, double t_err)
{
    sgt_ray ray = ray_in(o, b);
    const sgt_surface_ops *ops = o->surface.ops;
    vec3 p = along(ray.o, t, ray.d), n = {0};
    double f = ops->value(o->surface.self, p, &n);
    double reach = length(ray.o) + fabs(t) * length(ray.d) + length(o->pose.origin) / o->scale;
    double start = b->from == o && !(o->options.t_tol > 0) ? b->at.p_err : 0;
    double off = 2 * length(n) * (16 * U * reach + start + t_err * length(ray.d)) +
                 (ops->rounding ? ops->rounding(o->surface.self, p) : 0);
    return (state)(f < -off ? INSIDE : f > off ? OUTSIDE : UNKNOWN);
}

/* --------------------------------------------------------------- what can be met */

static stretch both(stretch a, stretch b)
{
    return (stretch){a.lo > b.lo ? a.lo : b.lo, a.hi < b.hi ? a.hi : b.hi};
}

static const stretch WHOLE = {-HUGE_VAL, HUGE_VAL};

/* A stretch outside of which the tree is not. */
static stretch bounds_of(const scene *s, int at, const beam *b)
{
    const knot *k = &s->knot[at];
    stretch all = WHOLE;
    if (k->op == PART) {
        const object *o = &s->object[k->object];
        if (!o->bounded) return all;
        sgt_ray ray = ray_in(o, b);
        sgt_span span = o->surface.ops->span(o->surface.self, &ray);
        double more = 1e-9 * (fabs(span.lo) + fabs(span.hi));
        return (stretch){span.lo - more, span.hi + more};
    }
    if (k->op == DIFFERENCE) return bounds_of(s, at + 1, b);
    for (int child = at + 1; child < k->end; child = s->knot[child].end) {
        stretch one = bounds_of(s, child, b);
        if (k->op == INTERSECTION) all = both(all, one);
        else if (child == at + 1) all = one;
        else if (all.lo > all.hi) all = one;
        else if (one.lo <= one.hi)
            all = (stretch){one.lo < all.lo ? one.lo : all.lo, one.hi > all.hi ? one.hi : all.hi};
    }
    return all;
}

/* Where each part of the tree has to be looked for. */
static void ranges_of(const scene *s, int first_part, int at, const beam *b, stretch in, stretch ranges[])
{
    const knot *k = &s->knot[at];
    if (k->op == PART) ranges[k->object - first_part] = in;
    if (k->op == INTERSECTION)
        for (int child = at + 1; child < k->end; child = s->knot[child].end)
            in = both(in, bounds_of(s, child, b));
    stretch first = k->op == DIFFERENCE ? both(in, bounds_of(s, at + 1, b)) : in;
    for (int child = at + 1; child < k->end; child = s->knot[child].end)
        ranges_of(s, first_part, child, b, child > at + 1 ? first : in, ranges);
}

/* The stretch of a ray in a ball or a box. */
static stretch clipped(const clip *c, const beam *b)
{
    vec3 from = subtract(b->o, c->pose.origin);
    double o[3] = {dot(c->pose.ex, from), dot(c->pose.ey, from), dot(c->pose.ez, from)};
    double d[3] = {dot(c->pose.ex, b->d), dot(c->pose.ey, b->d), dot(c->pose.ez, b->d)};
    double half[3] = {c->half.x * c->scale, c->half.y * c->scale, c->half.z * c->scale};
    stretch in = WHOLE;
    if (c->kind == CLIP_BALL) {
        double t = -dot(from, b->d),
               near2 = half[0] * half[0] - dot(along(from, t, b->d), along(from, t, b->d));
        double way = near2 >= 0 ? sqrt(near2) : -1;
        return (stretch){t - way, t + way};
    }
    for (int i = 0; i < 3; i++) {
        double t1 = (-half[i] - o[i]) / d[i], t2 = (half[i] - o[i]) / d[i];
        stretch slab = t1 < t2 ? (stretch){t1, t2} : (stretch){t2, t1};
        if (d[i] == 0) slab = fabs(o[i]) <= half[i] ? WHOLE : (stretch){1, -1};
        in = both(in, slab);
    }
    return in;
}

/* ------------------------------------------------------------------- one ray */

/* A body's ray, on its way. */
typedef struct walk {
    const scene *s;
    const body *of;
    const beam *beam;
    double far;
    const stretch *range;   /* of each part, and */
    event *next;            /* what it answers next */
    state *now;             /* of each object of the scene */
    answer *a;
} walk;

static event *event_of(const walk *w, int k) { return &w->next[k - w->of->first]; }

/* The objects that hang on a tree, in order of the row. */
#define EACH_PART(s, root, k)                                                        \
    for (int at_ = (root), k; at_ < (s)->knot[root].end; at_++)                      \
        if (k = (s)->knot[at_].object, (s)->knot[at_].op == PART)

/* A part's next answer, behind the last. */
static void go_on(walk *w, int k)
{
    const object *o = &w->s->object[k];
    event *e = event_of(w, k);
    double end = w->range[k - w->of->first].hi, to = end < w->far ? end : w->far,
           from = e->status > 0 ? e->t : e->hi;
    double rise = dot(e->n, ray_in(o, w->beam).d);
    double side = e->status == SGT_HIT && rise != 0 ? (rise > 0 ? 1 : -1) : 0;
    *e = event_alone(o, w->beam, from, to, side);
    w->a->evals += e->evals;
}

/* Where a part is, in front of its event (before) or behind. */
static state beside(const object *o, const beam *b, const event *e, bool before)
{
    double rise = dot(e->n, ray_in(o, b).d);
    if (e->status != SGT_HIT || !(fabs(rise) > 0)) return UNKNOWN;
    return (rise < 0) == before ? OUTSIDE : INSIDE;
}

/* Is the hit left by all clips?  INSIDE: yes. */
static state kept(const walk *w, const event *e)
{
    state all = INSIDE;
    for (int i = 0; i < w->of->clips; i++) {
        const clip *c = &w->of->clip[i];
        if (c->kind == CLIP_BALL || c->kind == CLIP_BOX) continue;
        EACH_PART(w->s, c->knot, k) {
            w->now[k] = state_at(&w->s->object[k], w->beam, e->t, e->hi - e->t);
            w->a->evals++;
        }
        int one = state_of(w->s, c->knot, w->now);
        all = (state)least(all, c->kind == CLIP_INSIDE ? one : INSIDE - one);
    }
    return all;
}

/* The events that overlap, from the nearest on.  false: there is none. */
static bool gather(const walk *w, stretch *all, bool among[], int *count)
{
    int root = w->of->knot;
    *all = (stretch){HUGE_VAL, -HUGE_VAL}, *count = 0;
    EACH_PART(w->s, root, k) {
        among[k] = false;
        if (event_of(w, k)->status != SGT_MISS && event_of(w, k)->lo < all->lo)
            *all = (stretch){event_of(w, k)->lo, event_of(w, k)->hi};
    }
    for (bool more = all->lo <= all->hi; more;) {
        more = false;
        EACH_PART(w->s, root, k) {
            const event *e = event_of(w, k);
            if (among[k] || e->status == SGT_MISS || e->lo > all->hi) continue;
            among[k] = more = true, ++*count;
            if (e->hi > all->hi) all->hi = e->hi;
        }
    }
    return *count > 0;
}

/* Which of the events among is the body's?  They are gone through in the order of t, from the states in
 * front of all; it is that at which the body becomes what it is behind all.  -1: none. */
static int changer(const walk *w, bool among[], int behind)
{
    int root = w->of->knot;
    for (;;) {
        int first = -1;
        EACH_PART(w->s, root, k)
            if (among[k] && (first < 0 || event_of(w, k)->t < event_of(w, first)->t)) first = k;
        if (first < 0) return -1;
        among[first] = false;
        w->now[first] = beside(&w->s->object[first], w->beam, event_of(w, first), false);
        if (state_of(w->s, root, w->now) == behind) return first;
    }
}

static void set_states(walk *w, const bool among[], int known, bool before)
{
    EACH_PART(w->s, w->of->knot, k)
        if (among[k])
            w->now[k] = known >= 0 ? (state)known : beside(&w->s->object[k], w->beam, event_of(w, k), before);
}

/* What the events make of the body.  Returns the part that is met, or -1; *undecided says more.  One event
 * alone is where that part changes, or may: from which side to which does not matter. */
static int judge(walk *w, const stretch *all, bool among[], int count, sgt_status *undecided)
{
    const scene *s = w->s;
    int root = w->of->knot, one = -1;
    sgt_status worst = SGT_MISS;
    EACH_PART(s, root, k)
        if (among[k]) {
            one = k, w->now[k] = UNKNOWN;
            if (event_of(w, k)->status < 0) worst = event_of(w, k)->status;
        }
    double t = all->hi < FAR_AWAY ? 0.5 * all->lo + 0.5 * all->hi : all->lo;
    EACH_PART(s, root, k)
        if (!among[k]) {
            w->now[k] = state_at(&s->object[k], w->beam, t, worst < 0 ? 0 : 0.5 * (all->hi - all->lo));
            w->a->evals++;
        }
    if (state_of(s, root, w->now) != UNKNOWN) return -1;
    *undecided = worst < 0 ? worst : SGT_UNPROVEN;
    if (worst < 0) return -1;
    bool alone = count == 1;
    set_states(w, among, alone ? OUTSIDE : -1, true);
    int before = state_of(s, root, w->now);
    set_states(w, among, alone ? INSIDE : -1, false);
    int behind = state_of(s, root, w->now);
    if (before == UNKNOWN || behind == UNKNOWN || before == behind) return -1;
    set_states(w, among, -1, true);
    int met = alone ? one : changer(w, among, behind);
    if (met >= 0) *undecided = SGT_MISS;
    return met;
}

/* Goes from event to event up to the first hit. */
static void go(walk *w)
{
    bool among[MOST_OBJECTS], again[MOST_OBJECTS];
    stretch all;
    answer *a = w->a;
    int count;
    for (int i = 0; gather(w, &all, among, &count); i++) {
        sgt_status undecided = SGT_MISS;
        if (i == EVENTS_MOST) {
            a->undecided = a->undecided ? a->undecided : SGT_EXHAUSTED;
            return;
        }
        memcpy(again, among, sizeof again);
        int met = judge(w, &all, among, count, &undecided);
        if (met >= 0) {
            state left = kept(w, event_of(w, met));
            if (left == INSIDE) {
                a->object = &w->s->object[met], a->hit = *event_of(w, met);
                return;
            }
            if (left == UNKNOWN) undecided = SGT_UNPROVEN;
        }
        if (undecided && !a->undecided) a->undecided = undecided;
        EACH_PART(w->s, w->of->knot, k)
            if (again[k]) go_on(w, k);
    }
}

/* ------------------------------------------------------------------ many rays */

static stretch allowed(const body *of, const beam *b, double far)
{
    stretch in = {0, far};
    for (int i = 0; i < of->clips; i++)
        if (of->clip[i].kind == CLIP_BALL || of->clip[i].kind == CLIP_BOX)
            in = both(in, clipped(&of->clip[i], b));
    return in;
}

/* Every ray's first answer of one part; range and next have a place for each part of each ray. */
static void ask(const scene *s, const body *of, int part, size_t n, const beam b[], const stretch range[],
                event next[], answer a[])
{
    const object *o = &s->object[of->first + part];
    size_t parts = (size_t)of->parts, asked[LOT];
    lot l;
    l.n = 0;
    for (size_t i = 0; i < n; i++) {
        stretch in = range[i * parts + (size_t)part];
        next[i * parts + (size_t)part] = (event){.status = SGT_MISS};
        if (!(in.lo < in.hi)) continue;
        asked[l.n] = i;
        lot_add(&l, &b[i], in.lo, in.hi);
    }
    lot_meet(&l, o);
    for (size_t j = 0; j < l.n; j++) {
        event *e = &next[asked[j] * parts + (size_t)part];
        *e = lot_event(&l, j, o);
        a[asked[j]].evals += e->evals;
    }
}

void body_meet(const scene *s, const body *of, size_t n, const beam b[], const double far[], answer a[])
{
    size_t parts = (size_t)of->parts;
    stretch *range = room(NULL, n * parts, sizeof *range);
    event *next = room(NULL, n * parts, sizeof *next);
    state now[MOST_OBJECTS];
    for (size_t i = 0; i < n; i++) {
        a[i] = (answer){.undecided = SGT_MISS};
        ranges_of(s, of->first, of->knot, &b[i], allowed(of, &b[i], far[i]), &range[i * parts]);
    }
    for (int part = 0; part < of->parts; part++) ask(s, of, part, n, b, range, next, a);
    for (size_t i = 0; i < n; i++) {
        walk w = {s, of, &b[i], far[i], &range[i * parts], &next[i * parts], now, &a[i]};
        go(&w);
    }
    free(range), free(next);
}
