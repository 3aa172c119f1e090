// SPDX-License-Identifier: MIT
/* bundle_sag.c - a bundle of lines meets an even asphere, or a departure from a conic.
 *
 * On a line (x, y, 0) + t d the root of F = z - S, S = s(r^2) + P(x, y) the sag of surfaces.h, is searched
 * for all lines at once, within r <= L.
 *
 *   1. z of a root is one of S, r <= L: so t is in a first interval T.
 *   2. T is cut into PIECES.  On each, x and y of all lines are in a box, S in an interval, and t in that
 *      over dz.  What is left of the pieces is the new T; some ROUNDS of that.  If nothing is left, no line
 *      meets it.
 *   3. T is made twice as long.  Newton's step for intervals (Moore 1966, Interval Analysis, chapter 7): if
 *      the slope dF/dt has one sign on T for all lines, with m in T, t = m - F(m) / slope.  F(m) is a form,
 *      and so then is t.  If its range is inside of T, each line has a root there, and only one.
 *
 * A departure gives P and its gradient at the middle of a box, with bounds on their errors, and one on its
 * second derivative in the box (departure.h).  So P is a form but for a bound of second order, and its
 * gradient a number but for one of first order: parts that departures bend have to be smaller.
 *
 * WHICH ROOT.  sgt_trace looks for the root near the seed.  If that is outside the aperture and another
 * inside, it takes the other; roots beyond the rim are none.  So:
 *
 *     L = least of aperture, rim, edge   if each line has a root within L, and just one, it is the one
 *     L = lesser of rim and edge         else: every root there is, is within L, and thus in T
 *
 * The edge is that of the conic base.  If there is neither rim nor edge, lines that are not certainly within
 * the aperture are UNKNOWN. */
#include "bundle.h"

#include "../surface/departure/departure.h"

enum { PIECES = 8, ROUNDS = 3, STEPS = 2, TERMS = 8 };

/* a: of the even polynomial, or NULL.  of: the departure, or NULL. */
typedef struct sag_model {
    double c, k, rim;
    const double *a;
    const departure *of;
    const void *self;
} sag_model;

/* All over a box of x and y: S; dS/d(r^2) of the part that is of r^2 alone; the gradient of the rest.
 * defined: certainly, all over. */
typedef struct sag_range {
    sgt_interval sag, slope, px, py;
    bool defined;
} sag_range;

/* ------------------------------------------------------------------ the departure */

static sgt_interval sag_within(double size)
{
    return size < HUGE_VAL ? sgt_interval_between(-size, size) : sgt_interval_all();
}

/* P and its gradient at the middle of a box, and what they are off by as computed.  false: not known. */
typedef struct sag_middle {
    double x, y, p, px, py, p_err, grad_err;
} sag_middle;

static bool sag_middle_of(const sag_model *s, double x, double y, sag_middle *m)
{
    m->x = x, m->y = y;
    s->of->at(s->self, 1, &m->x, &m->y, (sag_values){&m->p, &m->px, &m->py});
    s->of->rounding(s->self, x, y, &m->p_err, &m->grad_err);
    return fabs(m->p) + fabs(m->px) + fabs(m->py) + m->p_err + m->grad_err < HUGE_VAL;
}

/* The box as a region, r at most `most`; see bounds of a departure. */
static int sag_bounds(const sag_model *s, sgt_interval x, sgt_interval y, double most, region *where,
                      bounds *b)
{
    sgt_interval r2 = sgt_interval_sum(sgt_interval_square(x), sgt_interval_square(y));
    sgt_interval r = sgt_interval_square_root(r2);
    *where = (region){.x = x, .y = y, .r_lo = r.lo, .r_hi = r.hi < most ? r.hi : most};
    *b = (bounds){HUGE_VAL, HUGE_VAL, HUGE_VAL};
    if (!(r.hi < 0x1p400)) return -1;
    int defined = s->of->bounds(s->self, where, b);
    b->size += FORM_LEAST, b->steep += FORM_LEAST, b->bend += FORM_LEAST;
    return defined;
}

/* Adds P to what is known of the rest. */
static void departure_over_box(const sag_model *s, sgt_interval x, sgt_interval y, double most,
                               sag_range *all)
{
    region where;
    bounds b;
    sag_middle m;
    int defined = sag_bounds(s, x, y, most, &where, &b);
    all->px = all->py = sag_within(b.steep);
    if (defined == 0) all->sag = sgt_interval_empty();
    if (defined <= 0) all->defined = false;
    sgt_interval p = sag_within(b.size);
    double mx = sgt_interval_middle(x), my = sgt_interval_middle(y);
    sgt_interval vx = sgt_interval_difference(x, sgt_interval_of(mx)),
                 vy = sgt_interval_difference(y, sgt_interval_of(my));
    double v = sgt_sum_above(sgt_interval_greatest(vx), sgt_interval_greatest(vy));
    bool whole = defined > 0 && where.r_hi < most; /* else the middle may be outside of the region */
    if (whole && b.bend < HUGE_VAL && sag_middle_of(s, mx, my, &m)) {
        double off = sgt_sum_above(m.grad_err, sgt_product_above(b.bend, v));
        all->px = sgt_interval_intersection(all->px, sgt_interval_about(m.px, off));
        all->py = sgt_interval_intersection(all->py, sgt_interval_about(m.py, off));
        sgt_interval run =
            sgt_interval_sum(sgt_interval_product(all->px, vx), sgt_interval_product(all->py, vy));
        p = sgt_interval_intersection(p, sgt_interval_sum(sgt_interval_about(m.p, m.p_err), run));
    }
    all->sag = sgt_interval_sum(all->sag, p);
}

/* P as a form, and its gradient: P(m + v) is P(m) + grad P(m) . v +- bend |v|^2 / 2.  NaN: not known. */
static linear departure_form(const sag_model *s, linear x, linear y, linear *px, linear *py)
{
    region where;
    bounds b;
    sag_middle m;
    const linear none = {(double)NAN, 0, 0, 0};
    *px = *py = none;
    if (sag_bounds(s, form_range(x), form_range(y), HUGE_VAL, &where, &b) <= 0 || !(b.bend < HUGE_VAL) ||
        !sag_middle_of(s, x.c, y.c, &m))
        return none;
    linear vx = form_plus(x, -x.c), vy = form_plus(y, -y.c);
    double v =
        (sgt_interval_greatest(form_range(vx)) + sgt_interval_greatest(form_range(vy))) * (1 + FORM_ROUND);
    double off = (m.grad_err + b.bend * v) * (1 + FORM_ROUND);
    *px = form_wider(form_of(m.px), off), *py = form_wider(form_of(m.py), off);
    linear run = form_sum(form_scaled(vx, m.px), form_scaled(vy, m.py));
    double rest = (m.p_err + m.grad_err * v + 0.5 * b.bend * v * v) * (1 + FORM_ROUND);
    return form_wider(form_plus(run, m.p), rest);
}

/* ------------------------------------------------------------------------ the sag */

/* within: r^2 of what is asked for. */
static sag_range sag_over(const sag_model *s, sgt_interval x, sgt_interval y, sgt_interval within)
{
    sgt_interval rho = sgt_interval_sum(sgt_interval_square(x), sgt_interval_square(y));
    rho = sgt_interval_intersection(rho, within);
    sgt_interval c = sgt_interval_of(s->c), k1 = sgt_interval_sum(sgt_interval_of(1), sgt_interval_of(s->k));
    sgt_interval one = sgt_interval_of(1), bend = sgt_interval_product(sgt_interval_product(c, k1), c);
    sgt_interval phi2 = sgt_interval_difference(one, sgt_interval_product(bend, rho));
    sgt_interval phi = sgt_interval_square_root(phi2);
    sgt_interval base = sgt_interval_quotient(sgt_interval_product(c, rho), sgt_interval_sum(one, phi));
    sgt_interval sum = sgt_interval_of(0), slope = sum;
    for (int i = TERMS - 1; i >= 0 && s->a; i--) {
        sgt_interval a = sgt_interval_of(s->a[i]);
        slope = sgt_interval_sum(sgt_interval_product(slope, rho), sgt_interval_scaled(a, i + 1));
        sum = sgt_interval_product(sgt_interval_sum(sum, a), rho);
    }
    sgt_interval steep = sgt_interval_quotient(sgt_interval_scaled(c, 0.5), phi);
    sag_range all = {.sag = sgt_interval_sum(base, sum),
                     .slope = sgt_interval_sum(steep, slope),
                     .px = {0, 0},
                     .py = {0, 0},
                     .defined = phi2.lo > 0};
    if (s->of) departure_over_box(s, x, y, sgt_interval_square_root(within).hi, &all);
    return all;
}

/* S, dS/d(r^2) of the part of r^2 alone, and the gradient of the rest. */
typedef struct sag_linear {
    linear sag, slope, px, py;
} sag_linear;

static sag_linear sag_form(const sag_model *s, linear x, linear y)
{
    linear rho = form_sum(form_square(x), form_square(y));
    linear k1 = form_plus(form_of(s->k), 1), bend = form_scaled(form_scaled(k1, s->c), s->c);
    linear phi = form_root(form_plus(form_negative(form_product(bend, rho)), 1));
    linear base = form_quotient(form_scaled(rho, s->c), form_plus(phi, 1)), sum = form_of(0), slope = sum;
    for (int i = TERMS - 1; i >= 0 && s->a; i--) {
        if (s->a[i] == 0 && form_size(sum) == 0) continue;
        slope = form_sum(form_product(slope, rho), form_scaled(form_of(s->a[i]), i + 1));
        sum = form_product(form_plus(sum, s->a[i]), rho);
    }
    slope = form_sum(slope, form_quotient(form_of(0.5 * s->c), phi));
    sag_linear l = {form_sum(base, sum), slope, form_of(0), form_of(0)};
    if (s->of) l.sag = form_sum(l.sag, departure_form(s, x, y, &l.px, &l.py));
    return l;
}

/* ------------------------------------------------------------------------ the lines */

typedef struct line_ranges {
    sgt_interval x, y, dx, dy, dz;
} line_ranges;

static sgt_interval line_at(sgt_interval from, sgt_interval t, sgt_interval way)
{
    return sgt_interval_sum(from, sgt_interval_product(t, way));
}

/* Steps 1 and 2: all roots with r <= L are in the answer. */
static sgt_interval sag_hull(const sag_model *s, const line_ranges *w, double L)
{
    const sgt_interval within = {0, L * L}, across = {-L, L};
    sgt_interval t = sgt_interval_quotient(sag_over(s, across, across, within).sag, w->dz);
    for (int round = 0; round < ROUNDS && t.lo <= t.hi && sgt_interval_width(t) < HUGE_VAL; round++) {
        sgt_interval left = sgt_interval_empty();
        double wide = (t.hi - t.lo) / PIECES;
        for (int i = 0; i < PIECES; i++) {
            sgt_interval piece = {i == 0 ? t.lo : t.lo + i * wide,
                                  i + 1 == PIECES ? t.hi : t.lo + (i + 1) * wide};
            sgt_interval x = line_at(w->x, piece, w->dx), y = line_at(w->y, piece, w->dy);
            x = sgt_interval_intersection(x, across), y = sgt_interval_intersection(y, across);
            if (sgt_interval_is_empty(x) || sgt_interval_is_empty(y)) continue;
            sgt_interval at = sgt_interval_quotient(sag_over(s, x, y, within).sag, w->dz);
            left = sgt_interval_hull(left, sgt_interval_intersection(piece, at));
        }
        t = left;
    }
    return t;
}

/* dF/dt of all lines over t; empty of doubt only if all->defined. */
static sgt_interval sag_slope(const sag_model *s, const bundle_lines *w, const line_ranges *range,
                              sgt_interval t, bool *defined)
{
    sgt_interval x = line_at(range->x, t, range->dx), y = line_at(range->y, t, range->dy);
    sag_range all = sag_over(s, x, y, (sgt_interval){0, HUGE_VAL});
    sgt_interval flat = sgt_interval_sum(sgt_interval_square(range->dx), sgt_interval_square(range->dy));
    sgt_interval outward = form_range(form_sum(form_product(w->x, w->d.x), form_product(w->y, w->d.y)));
    sgt_interval half = sgt_interval_sum(outward, sgt_interval_product(t, flat));
    sgt_interval by = sgt_interval_scaled(sgt_interval_product(half, all.slope), 2);
    sgt_interval px = sgt_interval_product(all.px, range->dx), py = sgt_interval_product(all.py, range->dy);
    *defined = all.defined;
    return sgt_interval_difference(range->dz, sgt_interval_sum(by, sgt_interval_sum(px, py)));
}

/* Step 3.  GONE: no root in t.  THERE: *root contains all; *exists: each line has one. */
static bundle_fate sag_newton(const sag_model *s, const bundle_lines *w, const line_ranges *range,
                              sgt_interval t, linear *root, double *sign, bool *exists)
{
    double more = 0.5 * (t.hi - t.lo) + 0x1p-40 * (fabs(t.lo) + fabs(t.hi)) + FORM_LEAST;
    *exists = false;
    t.lo -= more,
        t.hi += more; /* else the step could not end inside of it, as T is all that is known before */
    for (int i = 0; i < STEPS; i++) {
        double m = sgt_interval_middle(t);
        bool defined;
        sgt_interval slope = sag_slope(s, w, range, t, &defined);
        bool up = sgt_interval_is_positive(slope), down = sgt_interval_is_negative(slope);
        if (!defined || !(up || down)) return BUNDLE_UNKNOWN;
        linear x = form_sum(w->x, form_scaled(w->d.x, m)), y = form_sum(w->y, form_scaled(w->d.y, m));
        linear F = form_difference(form_scaled(w->d.z, m), sag_form(s, x, y).sag);
        sgt_interval inverse = sgt_interval_quotient(sgt_interval_of(1), slope);
        *root = form_sum(form_of(m), form_negative(form_product(F, form_between(inverse))));
        sgt_interval next = form_range(*root);
        if (!(next.hi - next.lo < HUGE_VAL)) return BUNDLE_UNKNOWN;
        *exists = *exists || (next.lo > t.lo && next.hi < t.hi);
        t = sgt_interval_intersection(t, next);
        if (sgt_interval_is_empty(t)) return BUNDLE_GONE;
        *sign = up ? 1 : -1;
    }
    return BUNDLE_THERE;
}

static void sag_hit(const sag_model *s, const bundle_lines *w, linear t, double sign, bundle_hit *h)
{
    linear x = form_sum(w->x, form_product(t, w->d.x)), y = form_sum(w->y, form_product(t, w->d.y));
    sag_linear at = sag_form(s, x, y);
    linear by = form_scaled(at.slope, -2);
    h->p = (form3){x, y, form_product(t, w->d.z)};
    h->n = (form3){form_difference(form_product(by, x), at.px), form_difference(form_product(by, y), at.py),
                   form_of(1)};
    h->size2 = form_plus(form_sum(form_square(h->n.x), form_square(h->n.y)), 1);
    h->slope = form_dot(h->n, w->d), h->sign = sign;
}

/* ------------------------------------------------------------------------- the call */

static sag_model model_of(sgt_surface surface)
{
    sag_model m = {.self = surface.self};
    if (surface.ops == &sgt_even_asphere_ops) {
        const sgt_even_asphere *s = surface.self;
        m.c = s->c, m.k = s->k, m.rim = s->semi_diameter;
        for (int i = 0; i < TERMS; i++)
            if (s->a[i] != 0) m.a = s->a;
    } else {
        surface.ops->own_->base(surface.self, &m.c, &m.k);
        m.of = surface.ops->own_->departure, m.rim = surface.ops->own_->rim(surface.self);
    }
    if (is_open(m.rim)) m.rim = HUGE_VAL;
    return m;
}

bool sgt_bundle_has_sag(sgt_surface surface)
{
    const struct sgt_builtin_ops *own = surface.ops->own_;
    if (surface.ops != &sgt_even_asphere_ops)
        return own && own->departure && own->base && own->rim && own->object &&
               !own->object(surface.self).param;
    const sgt_even_asphere *s = surface.self;
    bool all = isfinite(s->c) && isfinite(s->k) && s->semi_diameter >= 0;
    for (int i = 0; i < TERMS; i++) all = all && isfinite(s->a[i]);
    return all;
}

bundle_fate sgt_bundle_sag(sgt_surface surface, double aperture, const bundle_lines *w, bundle_hit *h)
{
    static const double MORE = 1 + 0x1p-40;
    const sag_model model = model_of(surface), *s = &model;
    const double k1 = 1 + s->k, edge = k1 > 0 && s->c != 0 ? 1 / (fabs(s->c) * sqrt(k1)) : HUGE_VAL;
    const double most = s->rim < edge ? s->rim : edge, least = aperture < most ? aperture : most;
    if (!s->a && !s->of) return sgt_bundle_conic(s->c, s->k, s->rim, aperture, w, h);
    const line_ranges range = {form_range(w->x), form_range(w->y), form_range(w->d.x), form_range(w->d.y),
                               form_range(w->d.z)};
    linear t;
    double sign;
    bool exists;
    if (!(least < 0x1p400)) return BUNDLE_UNKNOWN;
    sgt_interval hull = least < most ? sag_hull(s, &range, least * MORE) : sgt_interval_empty();
    if (!sgt_interval_is_empty(hull) && sag_newton(s, w, &range, hull, &t, &sign, &exists) == BUNDLE_THERE &&
        exists) {
        sag_hit(s, w, t, sign, h);
        linear r2 = form_sum(form_square(h->p.x), form_square(h->p.y));
        if (form_range(r2).hi < least * least * (2 - MORE)) return BUNDLE_THERE;
    }
    if (!(most < 0x1p400)) return BUNDLE_UNKNOWN;
    hull = sag_hull(s, &range, most * MORE);
    if (sgt_interval_is_empty(hull)) return BUNDLE_GONE;
    bundle_fate fate = sag_newton(s, w, &range, hull, &t, &sign, &exists);
    if (fate == BUNDLE_THERE) sag_hit(s, w, t, sign, h);
    return fate;
}

bool sgt_bundle_sag_points(sgt_surface surface, double reach, sgt_interval *x, sgt_interval *z)
{
    sag_model model = {.rim = HUGE_VAL};
    if (surface.ops == &sgt_conic_ops) {
        const sgt_conic *q = surface.self;
        model.c = q->c, model.k = q->k;
        if (!is_open(q->semi_diameter)) model.rim = q->semi_diameter;
    } else {
        if (!surface.ops || !sgt_bundle_has_sag(surface)) return false;
        model = model_of(surface);
    }
    const double k1 = 1 + model.k, edge = k1 > 0 && model.c != 0 ? 1 / (fabs(model.c) * sqrt(k1)) : HUGE_VAL;
    if (!(reach < model.rim)) reach = model.rim;
    if (!(reach < edge)) reach = edge;
    if (!(reach < 0x1p400)) return false;
    reach *= 1 + 0x1p-40;
    *x = (sgt_interval){-reach, reach};
    *z = sag_over(&model, *x, *x, (sgt_interval){0, reach * reach}).sag;
    return isfinite(z->lo) && isfinite(z->hi);
}
