// SPDX-License-Identifier: MIT
/* bundle_sag.c - a bundle of lines meets an even asphere, or a departure from a conic.
 *
 * On a line (x, y, 0) + t d the root of F = z - S, S = s(r^2) + P(x, y) the sag of surfaces.h, is searched
 * for all lines at once, within r <= L.
 *
 *   1. z of a root is one of S, r <= L: so t is in a first interval T.  (That S is kept for later boxes.)
 *      Step 3 is tried with T.  Mostly that is enough; if the slope may be 0 somewhere in T, step 2 makes it
 *      smaller.
 *   2. For t in T, x and y of all lines are in a box, S in an interval, and t in that over dz: the new T, and
 *      so on, while that makes it much smaller, up to ROUNDS times.  If the lines run farther along the
 *      surface in T than they are apart, T is cut into PIECES for that; else pieces would have nearly the
 *      same box.  If nothing is left, no line meets it.
 *   3. T is made twice as long.  Newton's step for intervals (Moore 1966, Interval Analysis, chapter 7): if
 *      the slope dF/dt has one sign on T for all lines, with m in T, t = m - F(m) / slope.  F(m) is a form,
 *      and so then is t.  If its range is inside of T, each line has a root there, and only one.  The step
 *      is taken twice, the second time with the slope over what is left of T.  m is about the root of the
 *      line in the middle, so that F(m) is small, and is the same in both.
 *
 * A departure gives P and its gradient at a point, with bounds on their errors, and one on its second
 * derivative in a box (departure.h).  So P is a form but for a bound of second order, and its gradient a
 * number but for one of first order: parts that departures bend have to be smaller.  Bounds and P are what
 * costs most.  Step 3 asks for bounds once, as all its points are in the box of its T, and mostly for one P.
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

enum { PIECES = 8, ROUNDS = 4, GUESSES = 2, MIDDLES = 4, TERMS = 8 };
static const double STILL = 0.7; /* of the length of T: what a round leaves that is the last */

/* a: of the even polynomial, or NULL.  of: the departure, or NULL.  bend: (1 + k) c^2. */
typedef struct sag_model {
    double c, k, rim;
    sgt_interval bend;
    const double *a;
    const departure *of;
    const void *self;
} sag_model;

/* ------------------------------------------------------------------ the departure */

static sgt_interval sag_within(double size)
{
    return size < HUGE_VAL ? sgt_interval_between(-size, size) : sgt_interval_all();
}

/* P and its gradient at a point, and what they are off by as computed.  false: not known. */
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

/* How far points of a box are from a middle, at most. */
static double sag_away(const sag_middle *m, sgt_interval x, sgt_interval y)
{
    const sgt_interval vx = sgt_interval_difference(x, sgt_interval_of(m->x)),
                       vy = sgt_interval_difference(y, sgt_interval_of(m->y));
    return sgt_sum_above(sgt_interval_greatest(vx), sgt_interval_greatest(vy));
}

/* A derivative of P, `at` in the middle, within v of it; b: of all that. */
static sgt_interval sag_derivative(double at, const sag_middle *m, const bounds *b, double v)
{
    const double off = sgt_sum_above(m->grad_err, sgt_product_above(b->bend, v));
    return sgt_interval_intersection(sag_within(b->steep), sgt_interval_about(at, off));
}

/* P over a box, where it is defined; empty: nowhere. */
static sgt_interval sag_part_over(const sag_model *s, sgt_interval x, sgt_interval y, double most)
{
    region where;
    bounds b;
    sag_middle m;
    const int defined = sag_bounds(s, x, y, most, &where, &b);
    const sgt_interval p = sag_within(b.size);
    if (defined == 0) return sgt_interval_empty();
    const bool whole = defined > 0 && where.r_hi < most; /* else the middle may be outside of the region */
    if (!whole || !(b.bend < HUGE_VAL) ||
        !sag_middle_of(s, sgt_interval_middle(x), sgt_interval_middle(y), &m))
        return p;
    const double v = sag_away(&m, x, y);
    const sgt_interval px = sag_derivative(m.px, &m, &b, v), py = sag_derivative(m.py, &m, &b, v);
    const sgt_interval run =
        sgt_interval_sum(sgt_interval_product(px, sgt_interval_difference(x, sgt_interval_of(m.x))),
                         sgt_interval_product(py, sgt_interval_difference(y, sgt_interval_of(m.y))));
    return sgt_interval_intersection(p, sgt_interval_sum(sgt_interval_about(m.p, m.p_err), run));
}

/* ------------------------------------------------------------------------ the sag */

/* The round part of S is that of r^2 = rho alone: c rho / (1 + phi) and the even terms, where phi is the root
 * of 1 - (1 + k) c^2 rho.  Its slope is the derivative by rho: c / (2 phi), and that of the terms.  within:
 * the rho that are asked for. */
typedef struct round_place { sgt_interval rho, phi2, phi; } round_place;

static round_place round_over(const sag_model *s, sgt_interval x, sgt_interval y, sgt_interval within)
{
    sgt_interval rho = sgt_interval_sum(sgt_interval_square(x), sgt_interval_square(y));
    rho = sgt_interval_intersection(rho, within);
    const sgt_interval phi2 = sgt_interval_difference(sgt_interval_of(1), sgt_interval_product(s->bend, rho));
    return (round_place){rho, phi2, sgt_interval_square_root(phi2)};
}

/* S over a box, r at most L. */
static sgt_interval sag_over(const sag_model *s, sgt_interval x, sgt_interval y, double L)
{
    const round_place at = round_over(s, x, y, (sgt_interval){0, L * L});
    sgt_interval sum = sgt_interval_of(0);
    for (int i = TERMS - 1; i >= 0 && s->a; i--)
        sum = sgt_interval_product(sgt_interval_sum(sum, sgt_interval_of(s->a[i])), at.rho);
    sum = sgt_interval_sum(sgt_interval_quotient(sgt_interval_scaled(at.rho, s->c),
                                                 sgt_interval_sum(sgt_interval_of(1), at.phi)),
                           sum);
    return s->of ? sgt_interval_sum(sum, sag_part_over(s, x, y, L)) : sum;
}

/* The slope of the round part over a box; *defined: it certainly is, all over. */
static sgt_interval round_slope(const sag_model *s, sgt_interval x, sgt_interval y, bool *defined)
{
    const round_place at = round_over(s, x, y, (sgt_interval){0, HUGE_VAL});
    sgt_interval slope = sgt_interval_of(0);
    for (int i = TERMS - 1; i >= 0 && s->a; i--)
        slope = sgt_interval_sum(sgt_interval_product(slope, at.rho),
                                 sgt_interval_scaled(sgt_interval_of(s->a[i]), i + 1));
    *defined = at.phi2.lo > 0;
    const sgt_interval half_c = sgt_interval_scaled(sgt_interval_of(s->c), 0.5);
    return sgt_interval_sum(sgt_interval_quotient(half_c, at.phi), slope);
}

/* The same at the points of forms. */
typedef struct round_forms { linear rho, phi; } round_forms;

static round_forms round_forms_of(const sag_model *s, linear x, linear y)
{
    const linear rho = form_sum(form_square(x), form_square(y));
    return (round_forms){
        rho, form_root(form_plus(form_negative(form_product(form_between(s->bend), rho)), 1))};
}

static linear round_form(const sag_model *s, linear x, linear y)
{
    const round_forms at = round_forms_of(s, x, y);
    linear sum = form_of(0);
    for (int i = TERMS - 1; i >= 0 && s->a; i--)
        if (s->a[i] != 0 || !form_is_zero(sum)) sum = form_product(form_plus(sum, s->a[i]), at.rho);
    return form_sum(form_quotient(form_scaled(at.rho, s->c), form_plus(at.phi, 1)), sum);
}

static linear round_slope_form(const sag_model *s, linear x, linear y)
{
    const round_forms at = round_forms_of(s, x, y);
    linear slope = form_of(0);
    for (int i = TERMS - 1; i >= 0 && s->a; i--)
        if (s->a[i] != 0 || !form_is_zero(slope))
            slope = form_sum(form_product(slope, at.rho), form_scaled(form_of(s->a[i]), i + 1));
    return form_sum(slope, form_quotient(form_of(0.5 * s->c), at.phi));
}

/* Points of forms as they are from a middle, and how far at most. */
typedef struct sag_offset { linear x, y; double away; } sag_offset;

static sag_offset sag_offset_of(const sag_middle *m, linear x, linear y)
{
    const linear vx = form_plus(x, -m->x), vy = form_plus(y, -m->y);
    const double away = sgt_interval_greatest(form_range(vx)) + sgt_interval_greatest(form_range(vy));
    return (sag_offset){vx, vy, away * (1 + FORM_ROUND)};
}

/* P(m + v) is P(m) + grad P(m) . v +- bend |v|^2 / 2. */
static linear sag_part_form(const sag_middle *m, linear x, linear y, double bend)
{
    const sag_offset v = sag_offset_of(m, x, y);
    const linear run = form_sum(form_scaled(v.x, m->px), form_scaled(v.y, m->py));
    const double rest = m->p_err + m->grad_err * v.away + 0.5 * bend * v.away * v.away;
    return form_wider(form_plus(run, m->p), rest * (1 + FORM_ROUND));
}

/* ------------------------------------------------------------------------ the lines */

typedef struct line_ranges {
    sgt_interval x, y, dx, dy, dz;
} line_ranges;

static sgt_interval line_at(sgt_interval from, sgt_interval t, sgt_interval way)
{
    return sgt_interval_sum(from, sgt_interval_product(t, way));
}

/* Those t of T that may be of roots, r <= L. */
static sgt_interval sag_left(const sag_model *s, const line_ranges *w, double L, sgt_interval t)
{
    const sgt_interval across = {-L, L};
    const sgt_interval x = sgt_interval_intersection(line_at(w->x, t, w->dx), across),
                       y = sgt_interval_intersection(line_at(w->y, t, w->dy), across);
    if (sgt_interval_is_empty(x) || sgt_interval_is_empty(y)) return sgt_interval_empty();
    return sgt_interval_intersection(t, sgt_interval_quotient(sag_over(s, x, y, L), w->dz));
}

/* Do the lines run farther along the surface in T than they are apart? */
static bool sag_runs_far(const line_ranges *w, sgt_interval t)
{
    const double run = larger(sgt_interval_greatest(w->dx), sgt_interval_greatest(w->dy));
    return sgt_interval_width(t) * run > larger(sgt_interval_width(w->x), sgt_interval_width(w->y));
}

/* Step 1: all roots with r <= L are in the answer. */
static sgt_interval sag_first(const sag_model *s, const line_ranges *w, double L, sag_kept *kept)
{
    const sgt_interval across = {-L, L};
    if (!kept->known) *kept = (sag_kept){true, sag_over(s, across, across, L)};
    return sgt_interval_quotient(kept->z, w->dz);
}

/* Step 2: all roots in t with r <= L are in the answer. */
static sgt_interval sag_hull(const sag_model *s, const line_ranges *w, double L, sgt_interval t)
{
    for (int round = 0; round < ROUNDS && t.lo <= t.hi && sgt_interval_width(t) < HUGE_VAL; round++) {
        const int pieces = sag_runs_far(w, t) ? PIECES : 1;
        const double whole = t.hi - t.lo, wide = whole / pieces;
        sgt_interval left = sgt_interval_empty();
        for (int i = 0; i < pieces; i++) {
            const sgt_interval piece = {i == 0 ? t.lo : t.lo + i * wide,
                                        i + 1 == pieces ? t.hi : t.lo + (i + 1) * wide};
            left = sgt_interval_hull(left, sag_left(s, w, L, piece));
        }
        t = left;
        if (!(t.hi - t.lo < STILL * whole)) break;
    }
    return t;
}

/* Where the lines meet the surface, as step 3 finds it.  exists: each line has a root.  m, b: of P, if there
 * is one, in a box that has m and all roots. */
typedef struct sag_root { linear t; double sign; bool exists; sag_middle m; bounds b; } sag_root;

/* What the slope of the lines is made of, for all t: x dx + y dy at t = 0, and dx^2 + dy^2. */
typedef struct line_slopes { sgt_interval outward, flat; } line_slopes;

static line_slopes line_slopes_of(const bundle_lines *w, const line_ranges *range)
{
    return (line_slopes){form_range(form_sum(form_product(w->x, w->d.x), form_product(w->y, w->d.y))),
                         sgt_interval_sum(sgt_interval_square(range->dx), sgt_interval_square(range->dy))};
}

/* The places of all lines over t. */
typedef struct line_box { sgt_interval x, y; } line_box;

static line_box line_box_of(const line_ranges *range, sgt_interval t)
{
    return (line_box){line_at(range->x, t, range->dx), line_at(range->y, t, range->dy)};
}

/* dF/dt of all lines over t; *defined: there is no doubt of that.  known: m and b are read. */
static sgt_interval sag_slope(const sag_model *s, const line_ranges *range, const line_slopes *by,
                              sgt_interval t, const line_box *over, const sag_root *known, bool *defined)
{
    const sgt_interval half = sgt_interval_sum(by->outward, sgt_interval_product(t, by->flat)),
                       slope = round_slope(s, over->x, over->y, defined);
    sgt_interval sum = sgt_interval_scaled(sgt_interval_product(half, slope), 2);
    if (s->of) {
        const sag_middle *m = &known->m;
        const double v = sag_away(m, over->x, over->y);
        const sgt_interval px = sag_derivative(m->px, m, &known->b, v),
                           py = sag_derivative(m->py, m, &known->b, v);
        sum = sgt_interval_sum(sum, sgt_interval_sum(sgt_interval_product(px, range->dx),
                                                     sgt_interval_product(py, range->dy)));
    }
    return sgt_interval_difference(range->dz, sum);
}

/* The line in the middle, by plain numbers: F at t less what P adds, and dF/dt. */
typedef struct line_value { double x, y, f, slope; } line_value;

static line_value line_value_at(const sag_model *s, const bundle_lines *w, double t)
{
    const double dx = w->d.x.c, dy = w->d.y.c, dz = w->d.z.c, x = w->x.c + t * dx, y = w->y.c + t * dy,
                 rho = x * x + y * y, phi = sqrt(1 - s->bend.hi * rho);
    double sum = 0, slope = 0;
    for (int i = TERMS - 1; i >= 0 && s->a; i--)
        slope = slope * rho + (i + 1) * s->a[i], sum = (sum + s->a[i]) * rho;
    sum += s->c * rho / (1 + phi), slope += 0.5 * s->c / phi;
    return (line_value){x, y, t * dz - sum, dz - 2 * (x * dx + y * dy) * slope};
}

static double in_interval(sgt_interval t, double m)
{
    return m >= t.lo && m <= t.hi ? m : sgt_interval_middle(t);
}

/* About the root of the line in the middle, in t; of a departure *m is P nearby.  Another P is worked out
 * while that one is farther away than the lines are apart.  false: P is not known. */
static bool sag_guess(const sag_model *s, const bundle_lines *w, sgt_interval t, double *guess, sag_middle *m)
{
    const double apart = form_linear(w->x) + form_linear(w->y), run = fabs(w->d.x.c) + fabs(w->d.y.c);
    double at = sgt_interval_middle(t);
    for (int i = 0; i < GUESSES; i++) {
        const line_value v = line_value_at(s, w, at);
        at = in_interval(t, at - v.f / v.slope);
    }
    for (int i = 0; i < MIDDLES && s->of; i++) {
        const line_value v = line_value_at(s, w, at);
        if (!sag_middle_of(s, v.x, v.y, m)) return false;
        const double before = at, slope = v.slope - (m->px * w->d.x.c + m->py * w->d.y.c);
        at = in_interval(t, at - (v.f - m->p) / slope);
        if (fabs(at - before) * run <= apart) break;
    }
    *guess = at;
    return true;
}

/* Newton's step from m in t for the forms F(m), *t cut down to what is left.  GONE: nothing is. */
static bundle_fate sag_step(double m, linear F, sgt_interval slope, sgt_interval *t, sag_root *root)
{
    const bool up = sgt_interval_is_positive(slope), down = sgt_interval_is_negative(slope);
    if (!(up || down)) return BUNDLE_UNKNOWN;
    const sgt_interval inverse = sgt_interval_quotient(sgt_interval_of(1), slope);
    root->t = form_sum(form_of(m), form_negative(form_product(F, form_between(inverse))));
    const sgt_interval next = form_range(root->t);
    if (!(next.hi - next.lo < HUGE_VAL)) return BUNDLE_UNKNOWN;
    root->exists = root->exists || (next.lo > t->lo && next.hi < t->hi);
    root->sign = up ? 1 : -1;
    *t = sgt_interval_intersection(*t, next);
    return sgt_interval_is_empty(*t) ? BUNDLE_GONE : BUNDLE_THERE;
}

/* Step 3.  GONE: no root in t.  THERE: root->t contains all. */
static bundle_fate sag_newton(const sag_model *s, const bundle_lines *w, const line_ranges *range,
                              sgt_interval t, sag_root *root)
{
    const double more = 0.5 * (t.hi - t.lo) + 0x1p-40 * (fabs(t.lo) + fabs(t.hi)) + FORM_LEAST;
    const line_slopes by = line_slopes_of(w, range);
    double m;
    bool defined;
    region where;
    /* else the step could not end inside of it, as T is all that is known before */
    t.lo -= more, t.hi += more;
    root->exists = false;
    line_box over = line_box_of(range, t);
    if (s->of && !(sag_bounds(s, over.x, over.y, HUGE_VAL, &where, &root->b) > 0 && root->b.bend < HUGE_VAL))
        return BUNDLE_UNKNOWN;
    if (!sag_guess(s, w, t, &m, &root->m)) return BUNDLE_UNKNOWN;
    sgt_interval slope = sag_slope(s, range, &by, t, &over, root, &defined);
    if (!defined) return BUNDLE_UNKNOWN;
    const linear x = form_sum(w->x, form_scaled(w->d.x, m)), y = form_sum(w->y, form_scaled(w->d.y, m));
    linear F = form_difference(form_scaled(w->d.z, m), round_form(s, x, y));
    if (s->of) F = form_difference(F, sag_part_form(&root->m, x, y, root->b.bend));
    const bundle_fate fate = sag_step(m, F, slope, &t, root);
    if (fate != BUNDLE_THERE) return fate;
    t = sgt_interval_hull(t, sgt_interval_of(m)); /* the slope is needed from m to the root */
    over = line_box_of(range, t);
    slope = sag_slope(s, range, &by, t, &over, root, &defined);
    return sag_step(m, F, slope, &t, root);
}

/* The slopes of S at x, y.  m, b: of P, as above. */
static void sag_slopes(const sag_model *s, const sag_middle *m, const bounds *b, linear x, linear y,
                       linear *by_x, linear *by_y)
{
    const linear by = form_scaled(round_slope_form(s, x, y), 2);
    *by_x = form_product(by, x), *by_y = form_product(by, y);
    if (!s->of) return;
    const double off = (m->grad_err + b->bend * sag_offset_of(m, x, y).away) * (1 + FORM_ROUND);
    *by_x = form_wider(form_plus(*by_x, m->px), off);
    *by_y = form_wider(form_plus(*by_y, m->py), off);
}

static void sag_hit(const sag_model *s, const bundle_lines *w, const sag_root *root, bundle_hit *h)
{
    const linear t = root->t;
    linear x = form_sum(w->x, form_product(t, w->d.x)), y = form_sum(w->y, form_product(t, w->d.y));
    linear by_x, by_y;
    sag_slopes(s, &root->m, &root->b, x, y, &by_x, &by_y);
    h->p = (form3){x, y, form_product(t, w->d.z)};
    h->n = (form3){form_negative(by_x), form_negative(by_y), form_of(1)};
    h->size2 = form_plus(form_sum(form_square(h->n.x), form_square(h->n.y)), 1);
    h->slope = form_dot(h->n, w->d), h->sign = root->sign;
}

/* ------------------------------------------------------------------------- the call */

static sgt_interval bend_of(double c, double k)
{
    const sgt_interval k1 = sgt_interval_sum(sgt_interval_of(1), sgt_interval_of(k));
    return sgt_interval_scaled(sgt_interval_scaled(k1, c), c);
}

static sag_model model_of(sgt_surface surface)
{
    sag_model m = {.self = surface.self};
    if (surface.ops == &sgt_conic_ops) {
        const sgt_conic *q = surface.self;
        m.c = q->c, m.k = q->k, m.rim = q->semi_diameter;
    } else if (surface.ops == &sgt_even_asphere_ops) {
        const sgt_even_asphere *s = surface.self;
        m.c = s->c, m.k = s->k, m.rim = s->semi_diameter;
        for (int i = 0; i < TERMS; i++)
            if (s->a[i] != 0) m.a = s->a;
    } else {
        surface.ops->own_->base(surface.self, &m.c, &m.k);
        m.of = surface.ops->own_->departure, m.rim = surface.ops->own_->rim(surface.self);
    }
    if (is_open(m.rim)) m.rim = HUGE_VAL;
    m.bend = bend_of(m.c, m.k);
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

/* Steps 1 to 3 for roots with r <= L.  *exists: each line has one. */
static bundle_fate sag_meet(const sag_model *s, const bundle_lines *w, double L, sag_kept *kept,
                            bundle_hit *h, bool *exists)
{
    const line_ranges range = {form_range(w->x), form_range(w->y), form_range(w->d.x), form_range(w->d.y),
                               form_range(w->d.z)};
    sgt_interval t = sag_first(s, &range, L, kept);
    bundle_fate fate = BUNDLE_UNKNOWN;
    sag_root root;
    if (sgt_interval_is_empty(t)) return BUNDLE_GONE;
    if (sgt_interval_width(t) < HUGE_VAL) fate = sag_newton(s, w, &range, t, &root);
    if (fate == BUNDLE_UNKNOWN) {
        t = sag_hull(s, &range, L, t);
        if (sgt_interval_is_empty(t)) return BUNDLE_GONE;
        fate = sag_newton(s, w, &range, t, &root);
    }
    *exists = root.exists;
    if (fate != BUNDLE_THERE) return fate;
    sag_hit(s, w, &root, h);
    const linear r2 = form_sum(form_square(h->p.x), form_square(h->p.y));
    return form_above(r2, L * L) ? BUNDLE_GONE : BUNDLE_THERE;
}

bundle_fate sgt_bundle_sag(sgt_surface surface, double aperture, const bundle_lines *w, sag_kept kept[2],
                           bundle_hit *h)
{
    static const double MORE = 1 + 0x1p-40;
    const sag_model model = model_of(surface), *s = &model;
    const double k1 = 1 + s->k, edge = k1 > 0 && s->c != 0 ? 1 / (fabs(s->c) * sqrt(k1)) : HUGE_VAL;
    const double most = s->rim < edge ? s->rim : edge, least = aperture < most ? aperture : most;
    bool exists;
    if (!s->a && !s->of) return sgt_bundle_conic(s->c, s->k, s->rim, aperture, w, h);
    if (!(least < 0x1p400)) return BUNDLE_UNKNOWN;
    if (least < most && sag_meet(s, w, least * MORE, &kept[0], h, &exists) == BUNDLE_THERE && exists) {
        linear r2 = form_sum(form_square(h->p.x), form_square(h->p.y));
        if (form_range(r2).hi < least * least * (2 - MORE)) return BUNDLE_THERE;
    }
    return most < 0x1p400 ? sag_meet(s, w, most * MORE, &kept[1], h, &exists) : BUNDLE_UNKNOWN;
}

/* Roots with r <= L are in t, as of steps 1 and 2, and one at most if the slope has one sign in it. */
bool sgt_bundle_sag_only(sgt_surface surface, double L, const bundle_lines *w, sag_kept *kept, bool *none)
{
    const sag_model model = model_of(surface), *s = &model;
    const line_ranges range = {form_range(w->x), form_range(w->y), form_range(w->d.x), form_range(w->d.y),
                               form_range(w->d.z)};
    const line_slopes by = line_slopes_of(w, &range);
    sgt_interval t = sag_first(s, &range, L, kept);
    for (int round = 0; round < 2; round++) {
        *none = sgt_interval_is_empty(t);
        if (*none) return true;
        if (!(sgt_interval_width(t) < HUGE_VAL)) return false;
        const line_box over = line_box_of(&range, t);
        sag_root at = {.sign = 0};
        region where;
        const bool bounded =
            !s->of || (sag_bounds(s, over.x, over.y, HUGE_VAL, &where, &at.b) > 0 && at.b.bend < HUGE_VAL &&
                       sag_middle_of(s, sgt_interval_middle(over.x), sgt_interval_middle(over.y), &at.m));
        bool defined = false;
        sgt_interval slope = sgt_interval_all();
        if (bounded) slope = sag_slope(s, &range, &by, t, &over, &at, &defined);
        if (defined && (sgt_interval_is_positive(slope) || sgt_interval_is_negative(slope))) return true;
        if (round == 0) t = sag_hull(s, &range, L, t);
    }
    return false;
}

bool sgt_bundle_sag_slopes(sgt_surface surface, linear x, linear y, linear *by_x, linear *by_y)
{
    const sag_model s = model_of(surface);
    sag_middle m = {.x = 0};
    bounds b = {0, 0, 0};
    region where;
    if (s.of && !(sag_bounds(&s, form_range(x), form_range(y), HUGE_VAL, &where, &b) > 0 &&
                  b.bend < HUGE_VAL && sag_middle_of(&s, x.c, y.c, &m)))
        return false;
    sag_slopes(&s, &m, &b, x, y, by_x, by_y);
    return by_x->e < HUGE_VAL && by_y->e < HUGE_VAL;
}

bool sgt_bundle_sag_points(sgt_surface surface, double reach, sgt_interval *x, sgt_interval *z)
{
    if (!surface.ops || !(surface.ops == &sgt_conic_ops || sgt_bundle_has_sag(surface))) return false;
    const sag_model model = model_of(surface);
    const double k1 = 1 + model.k, edge = k1 > 0 && model.c != 0 ? 1 / (fabs(model.c) * sqrt(k1)) : HUGE_VAL;
    if (!(reach < model.rim)) reach = model.rim;
    if (!(reach < edge)) reach = edge;
    if (!(reach < 0x1p400)) return false;
    reach *= 1 + 0x1p-40;
    *x = (sgt_interval){-reach, reach};
    *z = sag_over(&model, *x, *x, reach);
    return isfinite(z->lo) && isfinite(z->hi);
}
