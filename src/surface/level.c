/* level.c - every root of a level set |Q_N| = E along a ray, in order, none missed.
 *
 * The ray is made local at its point nearest the centre of the set's ball (the set lies in |Q_0| <= E_0);
 * the ball cuts it to a chord, and a ray that passes by is done.  The chord is covered by cells, nearest
 * first; orbit.h says what makes a cell outside, inside or monotone.  Outside and inside cells hold no root.
 * In a monotone cell |Q_N|^2 has a slope between S- and S+ of one sign, so the root of the whole, if there is
 * one, lies in m - (|Q_N(m)|^2 - E^2 -+ g_err) / [S-, S+] (interval Newton; Moore 1966, Nickel 1971): wholly
 * inside the cell it exists and is the only one; beyond the cell's end, the part before it is
 * free of roots; before its start there is none, since the side on which the cell begins is
 * known: it is that of the cell before.  A cell that is none of these is made smaller, unless its variation
 * is already below the rounding of |Q_N|^2: then it joins an undecided stretch, which ends with the next
 * cell that is decided: unlike sides are a crossing; like ones a graze if |F| was within a few roundings all over it,
 * else UNPROVEN.
 *
 * h is halved after a failure, and after a success multiplied by a factor that itself has grown by 1.08 (to 1.2 at
 * most) and after a failure shrunk by 0.8 (to 0.7 at least): on the way toward a surface cells have to shrink, and learn it.
 * The best of some dozens tried on 640 x 480 rays at two sets, N = 7, and a flat optimum: 68 levels of the orbit a ray,
 * 73 with fixed factors of 1.15 and 0.35.  A Newton step out of a failed cell could only shorten it, and did not pay.
 *
 * A root's bracket is narrowed by Newton's method on F, which is tanh(log(|Q_N| / E)) and so nearly linear
 * over many lengths where |Q_N|^2 is not, and at last by interval Newton over a cell about it as wide
 * as the last step: that bounds the error.
 *
 * THE FAST WAY, dt_min > 0: steps of the larger of dt_min and Hart's estimate A log(A / E) / (2 |dQ_N/dp|), F looked
 * at between them; a change of sign is a bracket for Newton's method.  Thin parts are passed by. */
#include "level.h"

#include "../solve/root.h"
#include "sag.h"

typedef struct walk {
    path path;
    const orbit *orbit;
    const sgt_ray *ray;
    tally told;
    local q;
    double t_tol;     /* of tau */
    bool all, done;
    sgt_list *list;
} walk;

/* The length of the next cell, and by what it has lately been growing, or shrinking. */
typedef struct pace { double h, growth; } pace;

static pace faster(pace p)
{
    double growth = p.growth * 1.08;
    growth = growth < 1.2 ? growth : 1.2;
    return (pace){p.h * growth, growth};
}

static pace slower(pace p) { return (pace){0.5 * p.h, larger(0.8 * p.growth, 0.7)}; }

/* ------------------------------------------------------------------- setup */

/* E_N = E; then one true root, and from there on the tangent of the concave (x + |c|)^(1/p) at its fixed point
 * R*, which is above it: E_k = R* + (E_{k+1} - R*) / (p R*^(p-1)). */
static void escapes(const orbit *o, double escape[])
{
    double up = 1 + 0x1p-46, limit = (o->mandelbrot ? o->c_abs : o->safe) * up, E = (o->E + o->E_err) * up;
    int k = o->iterations;
    escape[k--] = E;
    if (E > limit * (1 + 0x1p-30)) {
        double root = (o->power == 2 ? sqrt(E + o->c_abs) : pow(E + o->c_abs, 1.0 / o->power)) * up, q = 1 / o->stretch * up, over = root - limit;
        for (; k >= 0 && over > limit * 0x1p-30; k--, over *= q) escape[k] = limit + over;
        limit = limit + larger(over, 0);
    }
    for (; k >= 0; k--) escape[k] = limit;
}

static quaternion along_of(const orbit *o, double l, double m, double n)
{
    return (quaternion){l * o->x.a + m * o->y.a + n * o->z.a, l * o->x.b + m * o->y.b + n * o->z.b,
                        l * o->x.c + m * o->y.c + n * o->z.c, l * o->x.d + m * o->y.d + n * o->z.d};
}

static void path_of(const orbit *o, sgt_vec3 at, double l, double m, double n, path *w)
{
    w->start = quaternion_at(o, at.x, at.y, at.z);
    w->along = along_of(o, l, m, n);
    w->along_size = fabs(l) * o->x_length + fabs(m) * o->y_length + fabs(n) * o->z_length;
    w->start_size = o->at_length + fabs(at.x) * o->x_length + fabs(at.y) * o->y_length + fabs(at.z) * o->z_length;
    w->c = o->c, w->c_abs = o->c_abs, w->E = o->E, w->E_err = o->E_err;
    w->iterations = o->iterations, w->power = o->power, w->mandelbrot = o->mandelbrot;
}

void sgt_level_path(const orbit *o, const sgt_ray *ray, path *w)
{
    path_of(o, ray->o, ray->d.x, ray->d.y, ray->d.z, w);
    escapes(o, w->escape);
}

/* The ray's point nearest the centre: where, and how near. */
typedef struct approach { double middle, off2, V, slip; } approach;

static approach approach_of(const path *w)
{
    double V2 = quaternion_dot(w->along, w->along), b = -quaternion_dot(w->start, w->along) / V2;
    quaternion off = quaternion_sum(w->start, quaternion_times(w->along, b));
    return (approach){b, quaternion_dot(off, off), sqrt(V2), 32 * SGT_U * w->along_size};
}

/* Half the chord of the ball |Q| <= radius; negative: passes by; NaN or infinite: out of range.  `along` is off by
 * `slip` (much of it, where axes nearly cancel), which over the chord moves the ray by slip times its half, at most the
 * radius over what is left of |along|. */
static double half_chord(const path *w, const approach *a, double radius)
{
    if (!(a->V > 2 * a->slip)) return HUGE_VAL;
    double err = 32 * SGT_U * w->start_size + a->slip * (fabs(a->middle) + 4 * radius / (a->V - a->slip));
    radius = radius * (1 + 0x1p-40) + err;
    double left = radius * radius - a->off2;
    return left < 0 ? -1 : (sqrt(left) + err) / a->V * (1 + 0x1p-40);
}

/* The ray with its origin moved to its point nearest the centre of the ball, and the chord there.  false: the ray
 * passes by, or [lo, hi] is empty. */
static bool chord_of(const orbit *o, const sgt_ray *ray, local *q, path *w, double *lo, double *hi)
{
    double scale = scale_of(ray->d), half;
    quaternion far = quaternion_at(o, ray->o.x, ray->o.y, ray->o.z), v = along_of(o, ray->d.x * scale, ray->d.y * scale, ray->d.z * scale);
    *q = local_at(ray, -quaternion_dot(far, v) / quaternion_dot(v, v), 0);
    path_of(o, (sgt_vec3){q->x, q->y, q->z}, q->l, q->m, q->n, w);
    approach a = approach_of(w);
    escapes(o, w->escape);
    half = half_chord(w, &a, w->escape[o->mandelbrot ? 1 : 0]);
    *lo = a.middle - half, *hi = a.middle + half;
    return !(half < 0);
}

sgt_span sgt_level_span(const orbit *o, const sgt_ray *ray)
{
    path w;
    local q;
    double lo, hi;
    if (!chord_of(o, ray, &q, &w, &lo, &hi)) return (sgt_span){.lo = 1, .hi = 0, .seed = NAN};
    double slack = 0x1p-48 * (fabs(q.t0) + fabs(lo) + fabs(hi));
    if (!(hi - lo < HUGE_VAL)) return (sgt_span){.lo = -HUGE_VAL, .hi = HUGE_VAL, .seed = NAN};
    return (sgt_span){.lo = (q.t0 + lo - slack) * q.scale, .hi = (q.t0 + hi + slack) * q.scale, .seed = NAN};
}

/* ----------------------------------------------------------------- entries */

static void tell_of(walk *w, sgt_move move, double tau, double lo, double hi)
{
    double slope, f = sgt_orbit_value(&w->path, tau, &slope), t0 = w->q.t0, scale = w->q.scale;
    tell(&w->told, move, (t0 + tau) * scale, f, slope / scale, (t0 + lo) * scale, (t0 + hi) * scale);
    w->done = w->done || w->told.stopped;
}

/* One evaluation more, at tau. */
SGT_INLINE void look_on(walk *w, sgt_move move, double tau, double lo, double hi)
{
    if (w->told.opt->watch) tell_of(w, move, tau, lo, hi);
    else w->told.evals++;
}

static void add(walk *w, sgt_hit *hit)
{
    hit->evals = w->told.evals - w->told.before;
    w->told.before = w->told.root = w->told.evals;
    sgt_list_add(w->list, hit);
    w->done = w->done || !w->all;
}

static void stretch(walk *w, sgt_status status, double lo, double hi)
{
    int count = w->list->count;
    add_stretch(w->list, &w->told, status, w->ray, (w->q.t0 + lo) * w->q.scale, (w->q.t0 + hi) * w->q.scale);
    w->done = w->done || (w->list->count > count && !w->all);
}

/* A root within tau_err of tau, or a graze: an entry, unless it is before or after the ray's ends, or its
 * start.  false: the watcher has stopped the search before. */
static bool add_root(walk *w, sgt_status status, double tau, double tau_err)
{
    meeting h;
    meeting_place(&h, &w->q, tau, tau_err);
    h.v = 1;
    double f = sgt_level_value(w->orbit, h.p, &h.n);
    look_on(w, SGT_NEWTON, tau, tau - tau_err, tau + tau_err);
    if (w->told.stopped) return false;
    double terms = fabs(h.p.x * h.n.x) + fabs(h.p.y * h.n.y) + fabs(h.p.z * h.n.z);
    double slope = fabs(h.n.x * w->q.l + h.n.y * w->q.m + h.n.z * w->q.n), tmin = w->ray->tmin;
    double gap = h.t - tmin - h.t_err - 8 * SGT_U * fabs(h.t);
    bool started = tmin == -HUGE_VAL || (gap > 0 && gap * slope >= START_ULPS * terms * w->q.scale); /* F = 1, to rounding: 0 and 0 */
    if (!(h.t_err < HUGE_VAL && fabs(h.t) < HUGE_VAL)) { /* t is out of range in lengths of d */
        stretch(w, SGT_UNPROVEN, -HUGE_VAL, HUGE_VAL);
        return true;
    }
    if (!started || h.t > w->ray->tmax) return true;
    add(w, &(sgt_hit){.status = status, .t = h.t, .t_err = h.t_err, .t_lo = h.t_lo, .lo = h.t - h.t_err, .hi = h.t + h.t_err,
                      .f = f, .p = h.p, .n = h.n, .p_err = h.p_err});
    return true;
}

/* ----------------------------------------------------------- the certified march */

/* Where the root of a monotone cell about m is: m + [lo, hi]. */
static sgt_interval newton_interval(const walk *w, const cell *e)
{
    double E2 = w->path.E * w->path.E, g = e->A2 - E2, most = fabs(g) + e->g_err, least = larger(fabs(g) - e->g_err, 0);
    double flat = 2 * (fabs(e->qv) - e->W), steep = 2 * (fabs(e->qv) + e->W), slack = 1 + 0x1p-48;
    double far = most / flat * slack, near = least / steep / slack;
    if (fabs(g) <= e->g_err) return (sgt_interval){-far, far};
    return (g > 0) == (e->qv < 0) ? (sgt_interval){near, far} : (sgt_interval){-far, -near};
}

/* The root in [lo, hi], where F is monotone (or, on the fast way, at least changes its sign), from a first guess; falls:
 * 1 if F falls, -1 if it rises.  false: the search was stopped before it was told. */
static bool polish(walk *w, double lo, double hi, double start, int falls)
{
    /* [a, b] is where the signs of F as computed say it is: a guide, and no proof */
    double a = lo, b = hi, tau = start > lo && start < hi ? start : 0.5 * (lo + hi), least = 0x1p-48 * (fabs(tau) + w->path.start_size / w->path.along_size);
    double wanted = larger(w->t_tol, least);
    for (int i = 0; i < 80 && 0.5 * (hi - lo) > wanted && !w->done && !spent(&w->told); i++) {
        double slope, f = sgt_orbit_value(&w->path, tau, &slope), step = -f / slope;
        look_on(w, i ? SGT_NEWTON : SGT_SEED, tau, lo, hi);
        if (f * falls > 0) a = tau;
        else b = tau;
        double next = tau + step;
        if (!(next >= a && next <= b)) next = 0.5 * (a + b), step = b - a; /* NaN too */
        tau = next;
        if (fabs(step) > larger(0.25 * wanted, 0x1p-18 * (hi - lo)) && i < 50) continue;
        /* one certified step about where Newton has come to: as wide as it takes to hold the root */
        double h = larger(4 * fabs(step), least);
        for (int j = 0; j < 8 && !w->done && !spent(&w->told); j++, h *= 8) {
            cell e;
            sgt_orbit_cell(&w->path, tau, h, &e);
            look_on(w, SGT_PROBE, tau, tau - h, tau + h);
            if (e.verdict == CELL_OPEN) break;
            if (e.verdict != CELL_MONOTONE) continue;
            sgt_interval n = newton_interval(w, &e);
            if (!(n.lo >= -h && n.hi <= h)) continue;
            double slip = SGT_U * fabs(tau);
            lo = larger(lo, tau + n.lo - slip), hi = -larger(-hi, -(tau + n.hi + slip));
            if (hi - lo <= larger(8 * e.g_err / fabs(e.qv), wanted)) i = 80; /* nothing more to be had */
            a = lo, b = hi, tau = 0.5 * (lo + hi);
            break;
        }
    }
    tau = 0.5 * (lo + hi);
    return !w->told.stopped && add_root(w, SGT_HIT, tau, larger(hi - tau, tau - lo));
}

/* A stretch where rounding hides the sign of F: before it, behind it, and whether |F| was within a few of its
 * roundings all over. */
typedef struct dark_stretch { bool any, touches; double lo; int side; } dark_stretch;

/* It ends at tau, with a cell where F has the sign `here`.  false: not told. */
static bool end_dark(walk *w, const dark_stretch *dark, double tau, int here)
{
    double middle = 0.5 * (dark->lo + tau), half = 0.5 * (tau - dark->lo) * (1 + 4 * SGT_U);
    if (dark->side * here < 0) return add_root(w, SGT_HIT, middle, half);
    if (dark->side && dark->touches) return add_root(w, SGT_GRAZE, middle, half);
    stretch(w, SGT_UNPROVEN, dark->lo, tau);
    return true;
}

/* A cell as it is laid: [tau, end], or what is left of [tau, hi], about m; h is as it came out. */
typedef struct place { double m, h, end; } place;

static place lay(double tau, double h, double hi)
{
    if (2 * h > hi - tau) h = 0.5 * (hi - tau);
    double m = tau + h, end = m + h;
    if (!(m > tau && end > m)) m = nextafter(tau, HUGE_VAL), end = nextafter(m, HUGE_VAL);
    return (place){m, larger(m - tau, end - m), end};
}

/* Cells that the march may come to next, looked at together. */
typedef struct ahead { double m[4], h[4]; cell seen[4]; bool known[4]; } ahead;

static const cell *look_at(const walk *w, ahead *a, place at, pace p, double hi)
{
    for (int i = 0; i < 4; i++)
        if (a->known[i] && a->m[i] == at.m && a->h[i] == at.h) return &a->seen[i];
    place all[4] = {at, at, at, at};
    for (int i = 1; i < 4 && all[i - 1].end < hi; i++) {
        p = faster((pace){all[i - 1].h, p.growth});
        all[i] = lay(all[i - 1].end, p.h, hi);
    }
    for (int i = 0; i < 4; i++) a->m[i] = all[i].m, a->h[i] = all[i].h;
    sgt_orbit_cells(&w->path, a->m, a->h, a->seen, a->known);
    return &a->seen[0];
}

/* The march proper, over [lo, hi]. */
static void march(walk *w, double lo, double hi)
{
    double tau = lo;
    pace p = {0.1 * (hi - lo), 1};
    dark_stretch dark = {.any = false};
    ahead near;
    for (int i = 0; i < 4; i++) near.known[i] = false;
    int side = 0; /* the sign of F where the cells so far end; 0: not known */
    while (tau < hi && !w->done && !spent(&w->told)) {
        place at = lay(tau, p.h, hi);
        const cell *e = look_at(w, &near, at, p, hi);
        double m = at.m, end = at.end, h = at.h;
        p.h = h;
        look_on(w, SGT_MARCH, m, tau, hi);
        if (w->done) break;
        bool monotone = e->verdict == CELL_MONOTONE, empty = e->verdict == CELL_OUTSIDE || e->verdict == CELL_INSIDE;
        int falls = monotone && e->qv < 0 ? 1 : -1; /* F falls along the ray, or rises: of use in a monotone cell */
        sgt_interval n = {0, 0};
        if (monotone) {
            n = newton_interval(w, e);
            if (side == 0 && n.lo < -h && n.hi > -h) { /* before the cell, or in it? */
                if (!dark.any) { /* at the very start, which is on the surface: from before it */
                    if (h > 0x1p-40 * (hi - lo)) p = slower(p);
                    else lo = tau = tau - 4 * h;
                    continue;
                }
                monotone = n.hi < h;
                if (monotone) { /* behind the root, if it is one, the sign is known */
                    if (!end_dark(w, &dark, m + n.hi, -falls)) break;
                    dark.any = false, side = -falls, tau = end, p = faster(p);
                    continue;
                }
            } else if (side == 0) {
                side = n.lo >= -h ? falls : -falls; /* the root is behind the start of the cell, or before it */
            }
        }
        int here = e->verdict == CELL_OUTSIDE ? 1 : e->verdict == CELL_INSIDE ? -1 : monotone ? side : 0;
        if (here && dark.any) { /* the undecided stretch ends here */
            if (!end_dark(w, &dark, tau, here)) break;
            dark.any = false;
            if (w->done) break;
        }
        if (empty || (monotone && (side != falls || n.lo > h))) {
            side = here, tau = end, p = faster(p);
        } else if (monotone && n.hi <= h) {
            double E2 = w->path.E * w->path.E, step = (e->A2 - E2) * (e->A2 + E2) / (4 * E2 * e->qv); /* F / F' */
            if (!polish(w, larger(tau, m + n.lo), m + n.hi, m - step, falls)) break;
            side = -side, tau = end, p = faster(p);
        } else if (monotone && m + n.lo > tau + 0.25 * h) { /* up to there no root */
            tau = m + n.lo;
            p.h = 0.6 * (n.hi - n.lo);
        } else {
            bool hopeless = e->W < HUGE_VAL && (fabs(e->qv) + e->W) * h <= 4 * e->g_err;
            if (!hopeless && 2 * h <= w->t_tol && side) { /* closer than asked for: a change of sign is enough */
                cell right;
                sgt_orbit_cell(&w->path, end, 0, &right);
                look_on(w, SGT_PROBE, end, tau, hi);
                int there = right.verdict == CELL_OUTSIDE ? 1 : right.verdict == CELL_INSIDE ? -1 : 0;
                if (there * side < 0) {
                    if (w->done || !add_root(w, SGT_HIT, m, h * (1 + 4 * SGT_U))) break;
                    side = there, tau = end;
                    continue;
                }
            }
            if (hopeless || h <= 2 * SGT_U * fabs(m)) {
                if (!dark.any) dark = (dark_stretch){.any = true, .touches = true, .lo = tau, .side = side};
                dark.touches = dark.touches && e->W < HUGE_VAL && fabs(e->A2 - w->path.E * w->path.E) <= 5 * e->g_err;
                side = 0, tau = end;
            } else {
                p = slower(p);
            }
        }
    }
    double from = dark.any ? dark.lo : tau;
    if (w->told.stopped) stretch(w, SGT_STOPPED, from, hi);
    else if (!w->done && tau < hi) stretch(w, SGT_EXHAUSTED, from, hi);
    else if (!w->done && dark.any) stretch(w, SGT_UNPROVEN, from, hi);
}

/* ------------------------------------------------------------------- the fast way */

/* What an estimate needs of the set, whatever the point.  c and Im Q span two dimensions: with Im c on one axis, the
 * norm of Q follows from (a, b, |rest|^2). */
typedef struct estimator { quaternion along_c; double im, E2, power2, inverse_length; } estimator;

/* c: of the Mandelbrot set the point. */
static estimator estimator_of(const orbit *o, quaternion c)
{
    double im = sqrt(c.b * c.b + c.c * c.c + c.d * c.d), inverse = im > 0 ? 1 / im : 0;
    return (estimator){.along_c = {c.a, c.b * inverse, c.c * inverse, c.d * inverse}, .im = im, .E2 = o->E * o->E,
                       .power2 = (double)(o->power * o->power), .inverse_length = 1 / larger(o->x_length, larger(o->y_length, o->z_length))};
}

/* The distance, and F itself.  Hart's estimate is of |Q|; log(x) >= 3 (x^2 - 1) / (x^2 + 4 x + 1), x >= 1 (Pade), is near
 * enough for x < 12. */
static double estimate_at(const orbit *o, const estimator *s, quaternion q, double *f)
{
    double a = q.a, n2 = q.b * q.b + (q.c * q.c + q.d * q.d), b = q.b * s->along_c.b + (q.c * s->along_c.c + q.d * s->along_c.d);
    double rest = larger(n2 - b * b, 0), growth2 = 1, A2 = a * a + n2; /* growth >= |dQ_k/dQ_0| */
    for (int k = o->mandelbrot ? 1 : 0; k < o->iterations && A2 < 128 * s->E2; k++) {
        growth2 *= s->power2 * (o->power == 2 ? A2 : small_power(A2, o->power - 1));
        if (o->mandelbrot) growth2 = (sqrt(growth2) + 1) * (sqrt(growth2) + 1);
        power_of r = o->power == 2 ? (power_of){a * a - (b * b + rest), 2 * a, 0, 0} : power_alone((quaternion){a, b, sqrt(rest), 0}, o->power);
        a = r.s + s->along_c.a, b = r.f * b + s->im, rest *= r.f * r.f;
        A2 = a * a + (b * b + rest);
    }
    if (!(A2 < HUGE_VAL)) {
        *f = A2 > 0 ? 1 : NAN;
        return 0;
    }
    *f = (A2 - s->E2) / (A2 + s->E2);
    if (!(A2 > s->E2)) return 0;
    double x2 = A2 / s->E2, x = sqrt(x2), d = 1.5 * (x2 - 1) / (x2 + 4 * x + 1) * sqrt(A2 / growth2) * s->inverse_length;
    return d < HUGE_VAL ? d : 0;
}

double sgt_level_estimate(const orbit *o, sgt_vec3 p, double *f)
{
    quaternion q = quaternion_at(o, p.x, p.y, p.z);
    estimator s = estimator_of(o, o->mandelbrot ? q : o->c);
    return estimate_at(o, &s, q, f);
}

static void march_fast(walk *w, double lo, double hi, double dt_min)
{
    const orbit *o = w->orbit;
    double inverse = 1 / sqrt(w->q.l * w->q.l + w->q.m * w->q.m + w->q.n * w->q.n), last = lo, last_f = NAN, tau = lo, f;
    estimator s = estimator_of(o, o->c);
    bool any = false;
    for (;;) {
        if (spent(&w->told)) {
            stretch(w, SGT_EXHAUSTED, last, hi);
            return;
        }
        quaternion q = quaternion_sum(w->path.start, quaternion_times(w->path.along, tau));
        if (o->mandelbrot) s = estimator_of(o, q);
        double away = estimate_at(o, &s, q, &f) * inverse;
        look_on(w, SGT_MARCH, tau, last, hi);
        if (w->done) break;
        if (last_f * f < 0) { /* a change of sign, and so a root: as certain as the two signs */
            int before = w->list->count;
            if (!polish(w, last, tau, tau - f * (tau - last) / (f - last_f), last_f > 0 ? 1 : -1)) break;
            any = any || w->list->count > before;
            if (w->done) break;
        }
        if (!(tau < hi)) break;
        if (f != 0) last = tau, last_f = f;
        double next = tau + larger(away, dt_min);
        tau = next > hi ? hi : next > tau ? next : nextafter(tau, HUGE_VAL);
    }
    if (w->told.stopped) stretch(w, SGT_STOPPED, last, hi);
    else if (!any && !w->done) stretch(w, SGT_UNPROVEN, lo, hi);
}

int sgt_level_march(const orbit *o, const sgt_ray *ray, const sgt_options *opt, bool all, sgt_list *list)
{
    walk w;
    double lo, hi;
    if (!chord_of(o, ray, &w.q, &w.path, &lo, &hi)) return 0;
    w.orbit = o, w.ray = ray, w.all = all, w.done = false, w.list = list;
    w.told = (tally){.opt = opt, .budget = opt->max_evals ? opt->max_evals : SGT_DEFAULT_EVALS};
    double scale = w.q.scale, tmin = ray->tmin / scale - w.q.t0, tmax = ray->tmax / scale - w.q.t0;
    w.t_tol = opt->t_tol / scale;
    if (!(hi - lo > 0 && hi - lo < HUGE_VAL)) {
        stretch(&w, SGT_UNPROVEN, -HUGE_VAL, HUGE_VAL); /* out of range */
        return 0;
    }
    /* roots at the very ends are to be inside: add_root has the last word */
    double slack = 0x1p-44 * (fabs(lo) + fabs(hi)) + 0x1p-50 * fabs(w.q.t0);
    if (tmin > lo) lo = tmin - slack;
    if (tmax < hi) hi = tmax + slack;
    if (lo > hi || tmin > hi || tmax < lo) return 0;
    if (opt->dt_min > 0) march_fast(&w, lo, hi, opt->dt_min / scale);
    else march(&w, lo, hi);
    return w.told.evals - w.told.before;
}
