/* general.c - any surface, by nothing but what its operations answer.
 *
 * The ray is made local first: the direction scaled by a power of two, the origin moved, with
 * error-free products and sums, to the surface's own guess, or the middle of its span, or the point of
 * the ray nearest the origin of its frame.  F is evaluated at the local point x + tau d; what rounding of
 * that point does to F, e_i |F_i| per coordinate, is added to the surface's own `rounding`.
 *
 * One root (span.single, or the root near the seed): the solver of solve/root.c, in the span.
 *
 * The first of several: a march from the near end in steps of dt_min.  Two neighbours of unlike sign
 * are a bracket.  Two of like sign between which |F| first falls and then rises hold a minimum of |F|:
 * where the tangents at the two meet beyond zero it is searched by bisecting the sign of the slope, and
 * a change of sign found on the way is a bracket again.  What is thinner than a step and is not
 * announced by the slopes is not seen; so a march that finds nothing is UNPROVEN.
 *
 * A change of sign through a pole is no root: |F| at the end of the search is greater than where it
 * began, and at the ends of the bracket, and it is passed by.  Toward a far end at infinity
 * the steps go on until the ray is farther from the origin of the surface's frame than where it starts
 * from (a surface is written about its origin, and looked at from outside); from there on each is half
 * again as long as the last.  From a near end at infinity there is no first step. */
#include "general.h"

#include "../solve/root.h"
#include "../surface/sag.h"

typedef struct point { double tau, g, slope, g_err, terms; sgt_vec3 p, n; double p_err; } point;

typedef struct walk {
    sgt_surface s;
    const sgt_ray *ray;
    const sgt_options *opt;
    local q;
    int evals, budget;
    bool stopped, spent, defined;
    double first; /* |g| where the solver began */
    bool told;    /* whether the root that does not count can be told not to */
} walk;

enum { STEPS = 64, FAR_STEPS = 128 };

static point look(walk *w, double tau, sgt_move move, double lo, double hi)
{
    const local *q = &w->q;
    double tl = tau * q->l, tm = tau * q->m, tn = tau * q->n;
    point e = {.tau = tau, .p = {q->x + tl, q->y + tm, q->z + tn}};
    if (w->stopped || w->evals >= w->budget) {
        w->spent = !w->stopped;
        e.g = e.slope = NAN;
        return e;
    }
    e.g = w->s.ops->value(w->s.self, e.p, &e.n);
    e.slope = e.n.x * q->l + e.n.y * q->m + e.n.z * q->n;
    double ex = q->xa + fabs(tl) + fabs(e.p.x), ey = q->ya + fabs(tm) + fabs(e.p.y), ez = q->za + fabs(tn) + fabs(e.p.z);
    double place = SGT_U * (ex * fabs(e.n.x) + ey * fabs(e.n.y) + ez * fabs(e.n.z));
    e.p_err = SGT_U * (ex + ey + ez);
    e.terms = fabs(e.p.x * e.n.x) + fabs(e.p.y * e.n.y) + fabs(e.p.z * e.n.z);
    e.g_err = place >= 0 ? place : 0; /* NaN: a gradient that says nothing */
    if (w->s.ops->rounding) {
        double own = w->s.ops->rounding(w->s.self, e.p);
        e.g_err += own >= 0 ? own : 0; /* a bound that is none is none */
    }
    w->evals++;
    w->defined = w->defined || !isnan(e.g);
    if (w->opt->watch) {
        sgt_step step = {.eval = w->evals, .move = move, .t = (q->t0 + tau) * q->scale, .f = e.g, .slope = e.slope / q->scale,
                         .lo = (q->t0 + lo) * q->scale, .hi = (q->t0 + hi) * q->scale};
        if (w->opt->watch(w->opt->watch_data, &step)) w->stopped = true;
    }
    return e;
}

static int sign_at(const point *e) { return e->g > e->g_err ? 1 : e->g < -e->g_err ? -1 : 0; }

/* Runs the solver; *at is the point it ended on. */
static sgt_root solve(walk *w, sgt_root r, point *at)
{
    w->first = HUGE_VAL;
    while (!w->stopped && !w->spent) {
        *at = look(w, r.t, r.move, r.lo, r.hi);
        if (w->spent) break;
        if (w->first == HUGE_VAL && fabs(at->g) < HUGE_VAL) w->first = fabs(at->g);
        r.g_err = at->g_err;
        if (!sgt_root_next(&r, at->g, at->slope)) break;
    }
    return r;
}

static sgt_root begin(const walk *w, sgt_span span)
{
    return sgt_root_begin(span, &(sgt_options){.t_tol = w->opt->t_tol / w->q.scale, .f_tol = w->opt->f_tol, .max_evals = w->budget});
}

/* What the solver found, as a hit; false where it does not count. */
static bool take(walk *w, const sgt_root *r, point at, sgt_hit *hit)
{
    const local *q = &w->q;
    w->told = false;
    if (r->status <= 0) return false;
    if (at.tau != r->t) {
        at = look(w, r->t, SGT_NEWTON, r->lo, r->hi);
        if (w->spent || w->stopped) return false;
    }
    if (!(fabs(at.g) <= w->first + 16 * at.g_err)) return false; /* a pole: it grew */
    twofold t = two_sum(q->t0, r->t);
    double width = START_ULPS * at.terms / fabs(at.slope), length = fabs(q->l) + fabs(q->m) + fabs(q->n);
    *hit = (sgt_hit){.status = r->status, .t = t.hi * q->scale, .t_lo = t.lo * q->scale,
                     .t_err = (fabs(t.lo) + r->t_err) * (1 + 4 * SGT_U) * q->scale, .f = at.g, .p = at.p, .n = at.n,
                     .p_err = length * r->t_err + 1.01 * at.p_err};
    hit->lo = hit->t - hit->t_err, hit->hi = hit->t + hit->t_err;
    width = (width < HUGE_VAL ? width * q->scale : 0) + 8 * SGT_U * fabs(hit->t);
    double tmin = w->ray->tmin;
    w->told = hit->t - hit->t_err > w->ray->tmax || hit->t + hit->t_err <= tmin || hit->t_err <= width + 64 * SGT_U * fabs(tmin);
    bool started = tmin == -HUGE_VAL || hit->t > tmin + (hit->t_err + width);
    return started && hit->t <= w->ray->tmax;
}

/* A root between a and b, whose signs differ; false: none that counts, *past is behind it. */
static bool between(walk *w, const point *a, const point *b, sgt_hit *hit, double *past)
{
    sgt_root r = begin(w, (sgt_span){.lo = a->tau, .hi = b->tau, .seed = a->tau - a->g * (b->tau - a->tau) / (b->g - a->g)});
    point at = *a;
    sgt_root_tell(&r, a->tau, a->g);
    sgt_root_tell(&r, b->tau, b->g);
    r = solve(w, r, &at);
    *past = r.hi;
    if (w->stopped || w->spent) return false;
    double ga = fabs(a->g) < HUGE_VAL ? fabs(a->g) : 0, gb = fabs(b->g) < HUGE_VAL ? fabs(b->g) : 0;
    bool pole = fabs(at.g) > larger(ga, gb);
    w->first = larger(w->first, larger(ga, gb)); /* the solver may have begun on the root itself */
    return !pole && take(w, &r, at, hit);
}

/* |F| falls after a and rises before b: is there a change of sign between?  *m is then its point. */
static bool dips(walk *w, point a, point b, point *m)
{
    int sign = sign_at(&a);
    if (!(sign && sign == sign_at(&b) && sign * a.slope < 0 && sign * b.slope > 0)) return false;
    for (int i = 0; i < 60 && !w->stopped && !w->spent; i++) {
        /* where the tangents meet, and how low that is: the minimum of a convex |F| is above it */
        double t = (b.g - a.g + a.slope * a.tau - b.slope * b.tau) / (a.slope - b.slope);
        double low = a.g + a.slope * (t - a.tau);
        if (sign * low > 0 || !(t > a.tau && t < b.tau)) return false;
        *m = look(w, (i & 1) ? 0.5 * (a.tau + b.tau) : t, SGT_MARCH, a.tau, b.tau);
        if (isnan(m->g) || sign * m->g < 0 || !sign_at(m)) return !isnan(m->g);
        if (sign * m->slope < 0) a = *m;
        else b = *m;
    }
    return false;
}

/* One step of a march, from a to b; the first hit in it that counts. */
static bool step(walk *w, const point *a, const point *b, sgt_hit *hit)
{
    double past;
    point m;
    if (sign_at(a) * sign_at(b) < 0) {
        if (between(w, a, b, hit, &past)) return true;
        if (!(past > a->tau && past < b->tau)) return false;
        point c = look(w, past, SGT_MARCH, past, b->tau); /* it does not count: another may follow at once */
        return dips(w, c, *b, &m) && between(w, &c, &m, hit, &past);
    }
    if (!dips(w, *a, *b, &m)) return false;
    if (sign_at(&m)) return between(w, a, &m, hit, &past) || between(w, &m, b, hit, &past);
    sgt_root r = begin(w, (sgt_span){.lo = a->tau, .hi = b->tau, .seed = m.tau}); /* touches as far as can be told */
    sgt_root_tell(&r, a->tau, a->g);
    point at = m;
    r = solve(w, r, &at);
    return take(w, &r, at, hit);
}

/* From lo to hi by dt, each step `growth` times the last; the first hit that counts. */
static bool march(walk *w, double lo, double hi, double dt, double growth, sgt_hit *hit)
{
    point a = look(w, lo, SGT_MARCH, lo, hi), b;
    double next = lo;
    for (long i = 1; !w->stopped && !w->spent && next < hi; i++, dt *= growth) {
        next = growth > 1 ? next + dt : lo + (double)i * dt;
        if (!(next < hi)) next = hi;
        if (!(next > a.tau)) { /* a step below an ulp of lo: the first that is one */
            if (!(dt > 0) || i > 1L << 40) return false;
            next = nextafter(a.tau, HUGE_VAL);
            if (next > hi) return false;
        }
        b = look(w, next, SGT_MARCH, a.tau, hi);
        if (!sign_at(&b) && !isnan(b.g) && next < hi) b = look(w, next - 0.01 * (next - a.tau), SGT_MARCH, a.tau, hi); /* on a root: from beside it */
        if (!sign_at(&a) && !isnan(a.g)) { /* the start is on the surface: from just behind it */
            double off = fmin(8 * (fabs(a.g) + a.g_err) / fabs(a.slope), 0.25 * (next - a.tau));
            a = look(w, a.tau + (off > 0 ? off : 0.25 * (next - a.tau)), SGT_MARCH, a.tau, hi);
        }
        if (step(w, &a, &b, hit)) return true;
        a = b;
    }
    return false;
}

sgt_hit sgt_intersect_general(sgt_surface s, const sgt_ray *ray, const sgt_options *opt)
{
    walk w = {.s = s, .ray = ray, .opt = opt, .budget = opt->max_evals ? opt->max_evals : SGT_DEFAULT_EVALS};
    sgt_span span = {.lo = -HUGE_VAL, .hi = HUGE_VAL, .seed = NAN};
    if (s.ops->span) span = s.ops->span(s.self, ray);
    if (span.lo > span.hi) return hit_without(SGT_MISS, ray, 0);
    double scale = scale_of(ray->d), nearest = nearest_to_vertex(ray);
    double lo = fmax(span.lo, ray->tmin) / scale, hi = fmin(span.hi, ray->tmax) / scale, seed = span.seed / scale; /* fmax, fmin: a NaN end is no end */
    if (lo > hi) return hit_without(SGT_MISS, ray, 0);
    bool near = opt->pick == SGT_NEAR_SEED, seeded = isfinite(seed);
    double t0 = seeded ? seed : isfinite(lo) && isfinite(hi) ? 0.5 * lo + 0.5 * hi : nearest;
    w.q = local_at(ray, t0 < lo ? lo : t0 > hi ? hi : t0, 0);
    if (!isfinite(w.q.x) || !isfinite(w.q.y) || !isfinite(w.q.z)) return hit_without(SGT_UNPROVEN, ray, 0);
    if (ray->tmax / scale <= hi) hi += 0x1p-44 * fabs(hi); /* a root at tmax is to be inside */
    lo -= w.q.t0, hi -= w.q.t0;

    sgt_hit hit = hit_without(SGT_UNPROVEN, ray, 0);
    bool found = false;
    if (span.single || near) {
        point at = {.tau = NAN};
        sgt_root r = solve(&w, begin(&w, (sgt_span){.lo = lo, .hi = hi, .seed = seeded ? seed - w.q.t0 : near ? nearest - w.q.t0 : (double)NAN, .single = span.single}), &at);
        if (!w.stopped && !w.spent) {
            found = take(&w, &r, at, &hit);
            if (span.single && !found && !w.stopped && !w.spent && (r.status == SGT_MISS || (r.status > 0 && w.told))) return hit_without(SGT_MISS, ray, w.evals);
        }
    }
    if (!found && !w.stopped && !w.spent && (isfinite(lo) || near)) {
        double length = sqrt(w.q.l * w.q.l + w.q.m * w.q.m + w.q.n * w.q.n);
        double away = sqrt(ray->o.x * ray->o.x + ray->o.y * ray->o.y + ray->o.z * ray->o.z) / length;
        bool far = !isfinite(hi);
        if (!isfinite(lo)) lo = nearest - away - w.q.t0;
        if (far) hi = larger(nearest + 1.25 * away - w.q.t0, lo); /* not at a round number of radii, where a root may be */
        double dt = opt->dt_min > 0 ? opt->dt_min / scale : (hi - lo) / STEPS;
        if (lo < hi) found = march(&w, lo, hi, dt, 1, &hit);
        if (!found && far) { /* grows to 1e22 times the first */
            double first = dt > 0 ? dt : 0x1p-20 / length, end = hi + first * (pow(1.5, FAR_STEPS) - 1) / 0.5;
            if (end < HUGE_VAL) found = march(&w, hi, end, first, 1.5, &hit);
        }
    }
    if (w.stopped) return hit_without(SGT_STOPPED, ray, w.evals);
    if (found) {
        hit.evals = w.evals;
        return hit;
    }
    sgt_status status = w.spent ? SGT_EXHAUSTED : w.evals && !w.defined ? SGT_UNDEFINED : SGT_UNPROVEN;
    return hit_without(status, ray, w.evals);
}
