// SPDX-License-Identifier: MIT
/* course.h - how a march over a level set goes on, for one ray and for many.
 *
 * The set lies in the ball |Q_0| <= E_0.  The ray is made local at its point nearest the centre of the
 * ball, and the ball cuts it to a chord.  `decide` turns the verdict of a cell into the next step of the
 * march.  `narrow` applies a verdict to the bracket of a root.  Both leave rare cases to the caller. */
#ifndef SGT_SURFACE_ORBIT_COURSE_H
#define SGT_SURFACE_ORBIT_COURSE_H

#include "cell.h"
#include "../../solve/cells.h"
#include "../builtin.h"

#include <sagitta/interval.h>

/* ------------------------------------------------------------------- setup */

SGT_INLINE quaternion along_of(const orbit *o, double l, double m, double n)
{
    return (quaternion){l * o->x.a + m * o->y.a + n * o->z.a, l * o->x.b + m * o->y.b + n * o->z.b,
                        l * o->x.c + m * o->y.c + n * o->z.c, l * o->x.d + m * o->y.d + n * o->z.d};
}

SGT_INLINE void path_of(const orbit *o, sgt_vec3 at, double l, double m, double n, path *w)
{
    w->start = quaternion_at(o, at.x, at.y, at.z);
    w->along = along_of(o, l, m, n);
    w->along_size = fabs(l) * o->x_length + fabs(m) * o->y_length + fabs(n) * o->z_length;
    w->start_size = o->at_length + fabs(at.x) * o->x_length + fabs(at.y) * o->y_length +
                    fabs(at.z) * o->z_length;
}

/* How many levels are not kept. */
SGT_INLINE int levels_before(const orbit *o)
{
    return o->iterations > SGT_KEPT ? o->iterations - SGT_KEPT : 0;
}

/* E_k = limit + over, where `over` is `growth` times greater at each level.  This is the tangent of
 * orbit.h, taken from E_N to the first level that is kept and back.  All is rounded up, so growth is below
 * the true one. */
typedef struct escape { double limit, over, growth; } escape;

static inline escape escape_of(const orbit *o)
{
    double up = 1 + 0x1p-46, growth = o->stretch * (1 - 0x1p-45), q = 1 / growth;
    escape s = {(o->mandelbrot ? o->c_abs : o->safe) * up, 0, growth};
    s.over = larger((o->E + o->E_err) * up - s.limit, 0) * (1 + 0x1p-40);
    int from = levels_before(o) ? levels_before(o) : o->mandelbrot ? 1 : 0;
    for (int k = from; k < o->iterations; k++) s.over *= q;
    return s;
}

/* Copies to a path what it takes from its set. */
static inline void set_of(const orbit *o, path *w)
{
    w->c = o->c, w->c_abs = o->c_abs, w->E = o->E, w->E_err = o->E_err;
    w->iterations = o->iterations, w->power = o->power, w->mandelbrot = o->mandelbrot;
    w->before = levels_before(o);
    escape s = escape_of(o);
    if (o->mandelbrot) w->escape[0] = HUGE_VAL;
    for (int k = first_kept(w); k <= o->iterations; k++, s.over *= s.growth)
        w->escape[k - w->before] = s.limit + s.over;
}

/* The point of the ray nearest the centre: where it is, and how near. */
typedef struct course_approach { double middle, off2, V, slip; } course_approach;

SGT_INLINE course_approach course_approach_of(const path *w)
{
    double V2 = quaternion_dot(w->along, w->along), b = -quaternion_dot(w->start, w->along) / V2;
    quaternion off = quaternion_sum(w->start, quaternion_times(w->along, b));
    return (course_approach){b, quaternion_dot(off, off), sqrt(V2), 32 * SGT_U * w->along_size};
}

/* Half the chord of the ball |Q| <= radius.  Negative: the ray passes outside.  NaN or infinite: out of
 * range.  `along` is off by `slip` (a large part of it, if axes nearly cancel).  Over the chord that moves
 * the ray by slip times half the chord, at most the radius over what is left of |along|. */
SGT_INLINE double half_chord(const path *w, const course_approach *a, double radius)
{
    double err = 32 * SGT_U * w->start_size + a->slip * (fabs(a->middle) + 4 * radius / (a->V - a->slip));
    radius = radius * (1 + 0x1p-40) + err;
    double left = radius * radius - a->off2, half = (sqrt(left < 0 ? 0 : left) + err) / a->V * (1 + 0x1p-40);
    return a->V > 2 * a->slip ? left < 0 ? -1 : half : HUGE_VAL;
}

/* Moves the origin of the ray to its point nearest the centre of the ball, and gives the chord there.
 * Returns half the chord; it is negative if the ray passes outside. */
SGT_INLINE double chord_of(const orbit *o, double radius, const sgt_ray *ray, local *q, path *w, double *lo,
                           double *hi)
{
    double scale = scale_of(ray->d);
    quaternion far = quaternion_at(o, ray->o.x, ray->o.y, ray->o.z),
               v = along_of(o, ray->d.x * scale, ray->d.y * scale, ray->d.z * scale);
    *q = local_at(ray, -quaternion_dot(far, v) / quaternion_dot(v, v), 0);
    path_of(o, (sgt_vec3){q->x, q->y, q->z}, q->l, q->m, q->n, w);
    course_approach a = course_approach_of(w);
    double half = half_chord(w, &a, radius);
    *lo = a.middle - half, *hi = a.middle + half;
    return half;
}

/* Keeps roots at the very ends inside.  The code that adds a root decides about them. */
SGT_INLINE void cut_to_ends(const local *q, double tmin, double tmax, double *lo, double *hi)
{
    double slack = 0x1p-44 * (fabs(*lo) + fabs(*hi)) + 0x1p-50 * fabs(q->t0);
    *lo = tmin > *lo ? tmin - slack : *lo;
    *hi = tmax < *hi ? tmax + slack : *hi;
}

/* ------------------------------------------------------------------- the march */

/* The first course, over [lo, hi] of a chord that begins at `from`.  A ray that starts within the ball may
 * well start on the surface, so it starts with a short cell, and cells become longer fast. */
SGT_INLINE course first_course(double from, double lo, double hi)
{
    bool within = lo > from;
    return (course){lo, hi, (within ? 0.0003 : 0.1) * (hi - lo), within ? 2 : 1, 0};
}

/* The bracket [lo, hi] of a root.  m is the best guess.  [a, b] is where the signs of F as computed place
 * it: a guide, not a proof.  h is half the next cell about m to look at.  falls is 1 if F falls, -1 if it
 * rises. */
typedef struct bracket { double lo, hi, a, b, m, h, falls, looks; } bracket;

static inline double root_error(const bracket *p) { return larger(p->hi - p->m, p->m - p->lo); }

/* If the slope varies by W over h, a Newton step s ends within W s^2 / (2 |qv| h) of the root and a little
 * more.  The next cell is twice as long. */
static inline void step_to(bracket *p, double from, double step, double wide, double least)
{
    double next = from - step;
    p->h = larger(wide * step * step, least);
    if (!(next >= p->a && next <= p->b)) next = 0.5 * (p->a + p->b), p->h = p->b - p->a; /* NaN too */
    if (p->h > p->b - p->a) p->h = p->b - p->a;
    p->m = next;
}

/* The sign of F in the middle of a cell as computed: a guide, not a proof.  If e->level < levels, the
 * middle is outside. */
static inline double seen_in_middle(const cell *e, int levels, double E2)
{
    return e->level < levels ? 1 : e->verdict == CELL_INSIDE ? -1 : e->A2 - E2;
}

typedef enum turn { ON, ROOT, ACROSS, RARE } turn;

/* What follows from the verdict of a cell:
 *
 *   ON      The course is set to the next cell.
 *   ROOT    Its bracket is in *p, and the course is set to the cell behind it.
 *   ACROSS  [tau, m] is no longer than t_tol, and F seems to change its sign there.  Look at m only, then
 *           call `found_across`.
 *   RARE    None of these.  The course and the cell are unchanged, except for h of the course.
 *
 * The cells do not depend on t_tol until ROOT or ACROSS.  t_tol costs at most one look, and mostly saves
 * some. */
typedef struct course_limits {
    int levels;
    double E2, t_tol, least;
} course_limits;

static inline turn decide(course *k, const cell_place *at, const cell *e, const sighting *n,
                          const course_limits *to, bracket *p)
{
    const double least = to->least;
    double m = at->m, end = at->end, h = at->h;
    k->h = h;
    if (e->verdict == CELL_OUTSIDE || e->verdict == CELL_INSIDE) {
        k->side = e->verdict == CELL_OUTSIDE ? 1 : -1, k->tau = end, faster(k);
        return ON;
    }
    if (e->verdict == CELL_MONOTONE) {
        double falls = e->qv < 0 ? 1 : -1, side = k->side; /* F falls along the ray, or rises */
        if (side == 0) {
            /* Is the root before the cell, or in it?  A cell that begins earlier, or a shorter one, will
             * tell. */
            if (n->lo < -h && n->hi > -h) {
                double width = larger(n->hi - n->lo, least);
                if (h <= 4 * least) return RARE;
                if (width <= 0.25 * h) k->tau = m + n->lo - width;
                else slower(k);
                return ON;
            }
            side = n->lo >= -h ? falls : -falls; /* root behind the start of the cell, or before it */
        }
        if (side != falls || n->lo > h) {
            k->side = side, k->tau = end, faster(k);
            return ON;
        }
        if (n->hi <= h) {
            *p = (bracket){.lo = larger(k->tau, m + n->lo), .hi = m + n->hi, .falls = falls};
            p->a = p->lo, p->b = p->hi;
            step_to(p, m, n->newton, n->wide, least);
            k->side = -side, k->tau = end, faster(k);
            return ROOT;
        }
        if (m + n->lo > k->tau + 0.25 * h) { /* up to there no root */
            k->side = side, k->tau = m + n->lo, k->h = 0.6 * (n->hi - n->lo);
            return ON;
        }
        k->side = side;
    }
    bool hopeless = e->W < HUGE_VAL && (fabs(e->qv) + e->W) * h <= 4 * e->g_err;
    if (hopeless || h <= 2 * SGT_U * fabs(m)) return RARE;
    if (h <= to->t_tol && k->side * seen_in_middle(e, to->levels, to->E2) < 0) return ACROSS;
    slower(k);
    return ON;
}

/* Ends ACROSS, with the verdict v of m only (h = 0).  Returns true if a root is certain within *err of
 * *root.  Returns false if rounding hides the sign at m.  It may do so in the next cells too, so the ray
 * goes on without a tolerance. */
static inline bool found_across(course *k, const cell_place *at, cell_verdict v, double *t_tol, double *root,
                                double *err)
{
    double there = v == CELL_OUTSIDE ? 1 : v == CELL_INSIDE ? -1 : 0;
    if (!(there * k->side < 0)) {
        *t_tol = 0;
        slower(k);
        return false;
    }
    *root = 0.5 * (k->tau + at->m), *err = larger(*root - k->tau, at->m - *root) * (1 + 4 * SGT_U);
    k->side = there, k->tau = at->m;
    return true;
}

/* ------------------------------------------------------------------- the fast way */

/* What an estimate needs of the set, whatever the point.  c and Im Q span two dimensions.  With Im c on
 * one axis, the norm of Q follows from (a, b, |rest|^2). */
typedef struct estimator { quaternion along_c; double im, E2, power2, inverse_length; } estimator;

/* c: for the Mandelbrot set the point. */
SGT_INLINE estimator estimator_of(const orbit *o, quaternion c)
{
    double im = sqrt(c.b * c.b + c.c * c.c + c.d * c.d), inverse = im > 0 ? 1 / im : 0;
    return (estimator){.along_c = {c.a, c.b * inverse, c.c * inverse, c.d * inverse}, .im = im,
                       .E2 = o->E * o->E, .power2 = (double)(o->power * o->power),
                       .inverse_length = 1 / larger(o->x_length, larger(o->y_length, o->z_length))};
}

/* An orbit in the plane of 1 and Im c, with |rest|^2 outside that plane.  growth >= |dQ_k/dQ_0|. */
typedef struct slice_orbit { double a, b, rest, A2, growth2; } slice_orbit;

#define FAR_ENOUGH 128 /* of A2 / E^2: beyond it the estimate hardly changes */

SGT_INLINE slice_orbit slice_orbit_at(const estimator *s, quaternion q)
{
    double n2 = q.b * q.b + (q.c * q.c + q.d * q.d),
           b = q.b * s->along_c.b + (q.c * s->along_c.c + q.d * s->along_c.d);
    return (slice_orbit){q.a, b, larger(n2 - b * b, 0), q.a * q.a + n2, 1};
}

SGT_INLINE slice_orbit slice_orbit_squared(slice_orbit q, const estimator *s, bool mandelbrot)
{
    q.growth2 *= 4 * q.A2;
    if (mandelbrot) q.growth2 = (sqrt(q.growth2) + 1) * (sqrt(q.growth2) + 1);
    double real = q.a * q.a - (q.b * q.b + q.rest), twice = 2 * q.a;
    q.a = real + s->along_c.a, q.b = twice * q.b + s->im, q.rest *= twice * twice;
    q.A2 = q.a * q.a + (q.b * q.b + q.rest);
    return q;
}

/* The distance, and F itself in *f.  Hart's estimate contains log|Q|.  log(x) >= 3 (x^2 - 1) / (x^2 + 4 x
 * + 1) for x >= 1 (Pade) is close enough for x < 12. */
SGT_INLINE double estimate_of(const estimator *s, double A2, double growth2, double *f)
{
    double x2 = A2 / s->E2, x = sqrt(x2),
           d = 1.5 * (x2 - 1) / (x2 + 4 * x + 1) * sqrt(A2 / growth2) * s->inverse_length;
    double within = (A2 - s->E2) / (A2 + s->E2), beyond = A2 > 0 ? 1 : (double)NAN;
    *f = A2 < HUGE_VAL ? within : beyond;
    d = A2 > s->E2 ? d : 0, d = A2 < HUGE_VAL ? d : 0;
    return d < HUGE_VAL ? d : 0;
}

/* ------------------------------------------------------------------- a root's bracket */

/* Applies a look at p->m, p->h.  Returns false if the bracket is as narrow as wanted, or cannot become
 * narrower. */
static inline bool narrow(bracket *p, const cell *e, const sighting *n, int levels, double E2, double wanted,
                          double least)
{
    double m = p->m, h = p->h;
    bool far = e->level < levels;
    if (seen_in_middle(e, levels, E2) * p->falls > 0) p->a = m;
    else p->b = m;
    if (++p->looks >= 60) return false;
    if (far) {
        step_to(p, m, (double)NAN, 0, least);
    } else if (e->verdict == CELL_MONOTONE) {
        double slip = SGT_U * fabs(m);
        if (n->lo >= -h && n->hi <= h) {
            p->lo = larger(p->lo, m + n->lo - slip), p->hi = -larger(-p->hi, -(m + n->hi + slip));
            p->a = p->lo, p->b = p->hi;
            step_to(p, m, n->newton, n->wide, least);
            /* The bracket cannot become narrower, */
            bool to_rounding = p->hi - p->lo <= 8 * e->g_err / fabs(e->qv);
            /* and Newton's step has settled. */
            if (root_error(p) <= wanted || (to_rounding && p->h <= 2 * least)) return false;
        } else { /* the cell has to hold what rounding leaves of the root */
            step_to(p, m, n->newton, n->wide, larger(least, larger(h, 4 * e->g_err / fabs(e->qv))));
        }
    } else {
        if (h <= least) return false;
        step_to(p, m, n->newton, 0, larger(least, 0.125 * h));
    }
    return p->b > p->a;
}

/* ------------------------------------------------------------------- a root */

/* Is the root in (tmin, tmax], and not the start itself (the rule of sgt_ray in sagitta.h)? */
SGT_INLINE bool root_accepted(const meeting *h, const local *q, double tmin, double tmax)
{
    double terms = fabs(h->p.x * h->n.x) + fabs(h->p.y * h->n.y) + fabs(h->p.z * h->n.z);
    double slope = fabs(h->n.x * q->l + h->n.y * q->m + h->n.z * q->n),
           gap = h->t - tmin - h->t_err - 8 * SGT_U * fabs(h->t);
    /* Where F = 1 to rounding, both sides are 0. */
    bool started = (tmin == -HUGE_VAL) | ((gap > 0) & (gap * slope >= START_ULPS * terms * q->scale));
    return started & (h->t <= tmax);
}

/* Is t in range, in lengths of d? */
SGT_INLINE bool root_in_range(const meeting *h) { return (h->t_err < HUGE_VAL) & (fabs(h->t) < HUGE_VAL); }

#endif
