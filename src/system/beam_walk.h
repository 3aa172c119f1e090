// SPDX-License-Identifier: MIT
/* beam_walk.h - a box of rays through the elements of a lens, by models (model.h).
 *
 * All is exact arithmetic on the doubles of the lens, but for what models add; and that is more than any
 * trace in doubles is off by (THE SLACK).  What is said is so said of both.
 *
 * 1. MEETING A SURFACE F = 0.  The lines cross the vertex plane at (x, y, 0), with the unit direction d; on
 *    them G(t) = F(x + t dx, y + t dy, t dz).  Newton's steps in models, t - G / G', each twice as many
 *    orders: from the root of the middle line, one gives the slopes and a second one the second order.  Their
 *    rests are dropped.  So P(s) is a polynomial, and no more is claimed of it.  Now G(P) is worked out as
 *    a model, and |G(P)| <= B for all lines.  If |G'| >= m > 0 for all t within `reach` of P, and
 *    B / m < reach, each line has a root there, and only one there: t = P +- B / m.  (Moore's and Krawczyk's
 *    test about the root of each line by itself, and not about one number for all: so what is left is of
 *    third order, as G(P) is.)
 *
 * 2. IS IT THE ONE THAT sgt_trace MEANS?  It is, if it is within aperture and rim, and no other root of
 *    the line is.
 *      A conic has two roots at most.  The near one, by the sign of G' (bundle_conic.c), is taken if it is on
 *      the sheet, and within the rim and the aperture, whatever the other is.  If it is outside, the other
 * has to be excluded. Of the other sags all roots with r <= L are in an interval T of t, in which G' has one
 * sign for all lines: so there is one at most (sgt_bundle_sag_only).
 *
 * 3. THE APERTURE: r^2 is a model, and so its range is known to the third order.  Items: sgt_aperture_over,
 *    and where that is not certain, circles, ellipses and rectangles by models, too.
 *
 * 4. BENDING as in trace.h: f = (1 - r^2) / (r g + sign(g) sqrt(D)), with g = n . d of a known sign.  D > 0
 *    for all, or all are reflected, or the box is cut.
 *
 * 5. A SAG WITHOUT EDGE may have other roots far out, and none of them is meant: searches begin at seeds, and
 *    take the root that these lead to.  On a line let the root be t, and let a seed be within `reach` of it.
 *    If on all of [t - reach, t + reach] G' has one sign and m <= |G'| <= M with M / m = 1 + q, then a step
 *    of Newton from within takes an error e to e (1 - G'(xi) / G'), at most q |e|.  So all steps stay within,
 *    and with q <= 1/4 each is less than half of the last, as searches ask for before they trust steps.  Nor
 *    has a stretch about the seed on which F is monotone any other root: this one goes on monotone to t.
 *
 * THE SLACK.  BEAM_SLACK is added to d at each element.  Of F as it is computed at most a few u of its terms
 * are lost, of a departure its own bound; BEAM_SLACK of that is added to B.  A trace stops at t_tol, 2^-48 of
 * an aperture: added to t.  Axes are orthonormal to 2^-50 only. */
#ifndef SGT_SYSTEM_BEAM_WALK_H
#define SGT_SYSTEM_BEAM_WALK_H
#include "beam.h"
#include "beam_bodies.h"
#include "beam_sags.h"
#include "model.h"
#include "phase.h"
#include "waves.h"

#include "../num/bits.h"

#include "../surface/departure/departure.h"

#define BEAM_SLACK BUNDLE_SLACK
static const double SEED_SLOPES = 1.25; /* the greatest over the least */
static const double EDGE_IN = 1 - 0x1p-38, EDGE_OUT = 1 + 0x1p-38; /* of squares */
enum { EVEN_TERMS = 8, STEPS = 5, WIDENINGS = 3, SCALAR_STEPS = 40 };

/* ----------------------------------------------------------------------- the numbers */

static const sgt_model *number_of(const beam_task *task, size_t element, sgt_box_what what, size_t which)
{
    for (size_t i = 0; i < task->lens->numbers; i++) {
        const sgt_box_number *a = &task->lens->number[i];
        if (a->element == element && a->what == what && a->which == which) return a->value;
    }
    return NULL;
}

SGT_COLD static model changed(const beam_task *task, size_t element, sgt_box_what what, size_t which,
                              double own)
{
    const sgt_model *by = number_of(task, element, what, which);
    return by ? model_plus(model_read(by), own) : model_number(own);
}

SGT_COLD static bool varies(const beam_task *task, size_t element, sgt_box_what what)
{
    for (size_t i = 0; i < task->lens->numbers; i++) {
        const sgt_box_number *a = &task->lens->number[i];
        if (a->element == element && a->what == what) return true;
    }
    return false;
}

/* ---------------------------------------------------------------------- the surfaces */

typedef enum shape_kind { SHAPE_CONIC, SHAPE_EVEN, SHAPE_DEPARTURE, SHAPE_BODY, SHAPE_NONE } shape_kind;

/* A surface in models.  k1: 1 + k. */
typedef struct beam_shape {
    shape_kind kind;
    sgt_surface surface;
    bool varied, body;
    double c0, k0, rim;
    model c, k1, a[EVEN_TERMS];
    const double *even;
    const departure *of;
} beam_shape;

SGT_COLD static void beam_shape_of(const beam_task *task, size_t element, beam_shape *s)
{
    const sgt_surface surface = in_set(task->lens->e[element].surface);
    s->surface = surface, s->kind = SHAPE_NONE, s->varied = false, s->even = NULL, s->of = NULL;
    if (surface.ops == &sgt_conic_ops) {
        const sgt_conic *q = surface.self;
        s->kind = SHAPE_CONIC, s->c0 = q->c, s->k0 = q->k, s->rim = q->semi_diameter;
    } else if (surface.ops && sgt_bundle_has_sag(surface)) {
        if (surface.ops == &sgt_even_asphere_ops) {
            const sgt_even_asphere *q = surface.self;
            s->kind = SHAPE_EVEN, s->c0 = q->c, s->k0 = q->k, s->rim = q->semi_diameter, s->even = q->a;
        } else {
            surface.ops->own_->base(surface.self, &s->c0, &s->k0);
            s->kind = SHAPE_DEPARTURE;
            s->of = surface.ops->own_->departure, s->rim = surface.ops->own_->rim(surface.self);
        }
    } else {
        if (surface.ops && !varies(task, element, SGT_BOX_SURFACE) && beam_has_box(surface, &s->body))
            s->kind = SHAPE_BODY;
        return;
    }
    if (is_open(s->rim)) s->rim = HUGE_VAL;
    s->varied = varies(task, element, SGT_BOX_SURFACE);
    if (s->varied && s->kind == SHAPE_DEPARTURE) {
        s->kind = SHAPE_NONE;
        return;
    }
    s->c = changed(task, element, SGT_BOX_SURFACE, 0, s->c0);
    s->k1 = changed(task, element, SGT_BOX_SURFACE, 1, s->k0);
    s->k1 = model_made(model_plus(s->k1, 1), fabs(s->k0) + 1);
    for (size_t i = 0; i < EVEN_TERMS && s->even; i++)
        s->a[i] = changed(task, element, SGT_BOX_SURFACE, i + 2, s->even[i]);
}

SGT_COLD static double greatest(sgt_interval x) { return larger(fabs(x.lo), fabs(x.hi)); }
SGT_COLD static double beam_least(sgt_interval x) { return x.lo > 0 ? x.lo : x.hi < 0 ? -x.hi : 0; }

/* A curvature, times x. */
SGT_COLD static model by_c(const beam_shape *s, model x)
{
    return s->varied ? model_product(s->c, x) : model_scaled(x, s->c0);
}

/* The sag and its slopes; off: how far a trace's own are off.  false: not known, or not defined all over. */
SGT_COLD static bool sag_models_of(const beam_shape *s, const model *x, const model *y, sag_models *out)
{
    const model rho = model_sum(model_square(*x), model_square(*y));
    const double far2 = model_size(&rho) + rho.e;
    model sum = model_number(0), slope = model_number(0);
    double size = 0;
    for (int i = EVEN_TERMS - 1; i >= 0 && s->even; i--) {
        const bool first = sum.e == 0;
        size = (size + fabs(s->a[i].c)) * far2;
        if (first && s->even[i] == 0 && !s->varied) continue;
        slope = first ? model_scaled(s->a[i], i + 1)
                      : model_sum(model_product(slope, rho), model_scaled(s->a[i], i + 1));
        if (s->varied)
            sum = model_product(model_sum(sum, s->a[i]), rho);
        else
            sum = first ? model_scaled(rho, s->even[i]) : model_product(model_plus(sum, s->even[i]), rho);
    }
    if (s->varied || s->c0 != 0) {
        const model c_rho = by_c(s, rho),
                    phi2 = model_plus(model_negative(model_product(s->k1, by_c(s, c_rho))), 1);
        const model phi = model_root(phi2);
        if (!(phi.e < HUGE_VAL)) return false;
        const model base = model_quotient(c_rho, model_plus(phi, 1));
        size += model_size(&base) / beam_least(model_range(phi));
        sum = model_sum(sum, base);
        slope = model_sum(slope, by_c(s, model_scaled(model_inverse(phi), 0.5)));
    }
    out->off = BEAM_SLACK * size;
    slope = model_scaled(slope, 2);
    out->s = sum, out->x = model_product(slope, *x), out->y = model_product(slope, *y);
    if (s->of) {
        sag_models more;
        if (!departure_models(s->surface, x, y, &more)) return false;
        out->s = model_sum(out->s, more.s);
        out->x = model_sum(out->x, more.x), out->y = model_sum(out->y, more.y);
        out->off += more.off;
    }
    return out->s.e < HUGE_VAL && out->x.e < HUGE_VAL && out->y.e < HUGE_VAL;
}

/* F and a vector along its gradient at p.  off: of F as a trace has it. */
typedef struct shape_value {
    model f;
    model3 n;
    double off;
} shape_value;

SGT_COLD static bool shape_at(const beam_shape *s, const model3 *p, shape_value *v)
{
    if (s->kind == SHAPE_CONIC) {
        const model r2 = model_sum(model_square(p->x), model_square(p->y)), k1z = model_product(s->k1, p->z);
        const model all = model_sum(r2, model_product(k1z, p->z)), sag = by_c(s, model_scaled(all, 0.5));
        v->f = model_difference(p->z, sag);
        v->n = (model3){model_negative(by_c(s, p->x)), model_negative(by_c(s, p->y)),
                        model_plus(model_negative(by_c(s, k1z)), 1)};
        v->off = BEAM_SLACK *
                 (model_size(&p->z) + fabs(s->c0) * (model_size(&r2) + model_size(&k1z) * model_size(&p->z)));
        return v->f.e < HUGE_VAL;
    }
    if (s->kind == SHAPE_BODY) return body_models(s->surface, p, &v->f, &v->n, &v->off);
    sag_models sag;
    if (!sag_models_of(s, &p->x, &p->y, &sag)) return false;
    v->f = model_difference(p->z, sag.s);
    v->n = (model3){model_negative(sag.x), model_negative(sag.y), model_number(1)};
    v->off = sag.off + BEAM_SLACK * model_size(&p->z);
    return true;
}

/* --------------------------------------------------------------------------- beam_hit */

/* The lines at a surface: they cross its vertex plane at (x, y, 0), with the unit direction d. */
typedef struct beam_lines {
    model x, y;
    model3 d;
} beam_lines;

/* Where they meet it; size2: n . n, slope: n . d, of this sign on all lines. */
typedef struct beam_hit {
    model t;
    model3 p, n;
    model slope, size2;
    double sign;
} beam_hit;

SGT_COLD static model3 beam_point(const beam_lines *w, model t)
{
    return (model3){model_sum(w->x, model_product(t, w->d.x)), model_sum(w->y, model_product(t, w->d.y)),
                    model_product(t, w->d.z)};
}

/* The root of the line in the middle, by Newton's steps in plain numbers. */
SGT_COLD static double middle_root(const beam_shape *s, const beam_lines *w)
{
    double t = 0;
    if (s->kind == SHAPE_BODY) {
        const sgt_ray middle = {{w->x.c, w->y.c, 0}, {w->d.x.c, w->d.y.c, w->d.z.c}, -HUGE_VAL, HUGE_VAL};
        const sgt_options near = {.pick = SGT_NEAR_SEED};
        return sgt_intersect(s->surface, middle, &near).t;
    }
    for (int i = 0; i < SCALAR_STEPS; i++) {
        const sgt_vec3 d = {w->d.x.c, w->d.y.c, w->d.z.c}, p = {w->x.c + t * d.x, w->y.c + t * d.y, t * d.z};
        sgt_vec3 n;
        const double f = s->surface.ops->value(s->surface.self, p, &n), step = f / dot(n, d);
        if (!(fabs(step) < HUGE_VAL)) break;
        t -= step;
        if (fabs(step) <= 0x1p-46 * (fabs(p.x) + fabs(p.y) + fabs(t))) break;
    }
    return t;
}

/* Step 1 of the head.  more: what is added to t.  false: it is not certain that each line has such a root. */
SGT_COLD static bool beam_meet(const beam_shape *s, const beam_lines *w, double more, beam_hit *m)
{
    model t = model_number(middle_root(s, w));
    shape_value v;
    double off = 0, slowest = 0;
    for (int step = 0;; step++) {
        t.e = 0;
        const model3 p = beam_point(w, t);
        if (!shape_at(s, &p, &v)) return false;
        const model slope = model_dot(&v.n, &w->d), inverse = model_inverse(slope);
        if (!(inverse.e < HUGE_VAL)) return false;
        off = greatest(model_range(v.f)) + v.off, slowest = beam_least(model_range(slope));
        if (step == STEPS || (step >= 2 && model_size(&v.f) <= 0.5 * v.f.e + v.off)) break;
        t = model_difference(t, model_product(v.f, inverse));
    }
    double reach = 1.125 * off / slowest + MODEL_LEAST;
    for (int i = 0; i < WIDENINGS; i++, reach *= 2) {
        t.e = reach;
        m->p = beam_point(w, t);
        if (!shape_at(s, &m->p, &v)) return false;
        m->slope = model_dot(&v.n, &w->d);
        const sgt_interval range = model_range(m->slope);
        const double least = beam_least(range);
        if (!(off < reach * least * (1 - 0x1p-40))) continue;
        if (more > 0) {
            t.e += more;
            m->p = beam_point(w, t);
            if (!shape_at(s, &m->p, &v)) return false;
            m->slope = model_dot(&v.n, &w->d);
            if (!(beam_least(model_range(m->slope)) > 0)) return false;
        }
        m->t = t, m->n = v.n, m->sign = range.lo > 0 ? 1 : -1;
        m->size2 = model_sum(model_square(v.n.x), model_sum(model_square(v.n.y), model_square(v.n.z)));
        return true;
    }
    return false;
}

/* --------------------------------------------------------------- which root is meant */

typedef enum fate_of_box {
    ALL_IN,
    ALL_CLIPPED,
    ALL_MISS,
    ALL_CLIPPED_OR_MISS,
    MAY_BE_BOTH,
    NOT_MET,
    NO_EDGE_KNOWN
} fate_of_box;

typedef enum side { INSIDE, OUTSIDE, EITHER } side;
SGT_COLD static side beam_side_of(sgt_interval r2, double edge)
{
    if (!(edge < HUGE_VAL)) return INSIDE;
    if (r2.hi < edge * edge * EDGE_IN) return INSIDE;
    return r2.lo > edge * edge * EDGE_OUT ? OUTSIDE : EITHER;
}

/* Is the other root of the conic certainly not on its sheet, or outside the aperture?  *off_sheet: the
 * former.  b = B + slope of the near root (bundle_conic.c). */
SGT_COLD static bool other_is_out(const beam_shape *s, const beam_lines *w, double aperture, const model *A,
                         const model *b, bool *off_sheet)
{
    const model k1c = by_c(s, s->k1), far = model_product(k1c, model_product(*b, w->d.z));
    model on = model_difference(*A, far);
    on = model_wider(on, BEAM_SLACK * (model_size(A) + model_size(&far)));
    const bool up = model_above(*A, 0), down = model_below(*A, 0);
    *off_sheet = true;
    if (!s->varied && s->c0 == 0) return true;
    if ((up && model_below(on, 0)) || (down && model_above(on, 0))) return true;
    *off_sheet = false;
    if (!(aperture < HUGE_VAL)) return false;
    if (up || down) {
        const model t = model_quotient(*b, *A);
        const model3 p = beam_point(w, t);
        if (model_above(model_sum(model_square(p.x), model_square(p.y)), aperture * aperture * EDGE_OUT))
            return true;
    }
    if (!(model_range(s->k1).hi <= 0)) return false;
    const double z = beam_least(model_range(model_product(w->d.z, *b)));
    const double most = greatest(model_range(*A)), c = greatest(model_range(s->c));
    return 2 * z * (1 - BEAM_SLACK) / (most * c) > aperture * aperture * EDGE_OUT;
}

SGT_COLD static fate_of_box meet_conic(const beam_shape *s, const beam_lines *w, double aperture, double more,
                              beam_hit *m)
{
    const model3 *d = &w->d;
    const model across = model_sum(model_product(w->x, d->x), model_product(w->y, d->y));
    const model B = model_difference(d->z, by_c(s, across));
    const double sign = model_above(B, 0) ? 1 : model_below(B, 0) ? -1 : 0;
    model A = model_sum(model_number(1), model_product(model_plus(s->k1, -1), model_square(d->z)));
    A = model_wider(by_c(s, A), fabs(s->c0) * BEAM_SLACK * (1 + model_size(&s->k1)));
    if (sign == 0 || !beam_meet(s, w, more, m) || m->sign != sign) {
        const model C = by_c(s, model_sum(model_square(w->x), model_square(w->y)));
        const model square = model_square(B), product = model_product(A, C);
        const model D = model_difference(square, product);
        return model_below(D, -0x1p-40 * (model_size(&square) + model_size(&product))) ? ALL_MISS : NOT_MET;
    }
    const model b = model_sum(B, m->slope);
    const sgt_interval r2 = model_range(model_sum(model_square(m->p.x), model_square(m->p.y)));
    const sgt_interval on = model_range(m->n.z);
    const side in = beam_side_of(r2, aperture), rim = beam_side_of(r2, s->rim);
    const bool here = on.lo > 0x1p-40, gone = on.hi < -0x1p-40;
    if (here && in == INSIDE && rim == INSIDE) return ALL_IN;
    bool off_sheet;
    if (!other_is_out(s, w, smaller(aperture, s->rim), &A, &b, &off_sheet))
        return in == EITHER || rim == EITHER ? MAY_BE_BOTH : NOT_MET;
    if (gone) return off_sheet ? ALL_MISS : NOT_MET;
    if (!here) return NOT_MET;
    if (in == OUTSIDE && rim == INSIDE) return ALL_CLIPPED;
    if (rim == OUTSIDE) return off_sheet ? ALL_MISS : ALL_CLIPPED_OR_MISS;
    return in == OUTSIDE ? ALL_CLIPPED_OR_MISS : MAY_BE_BOTH;
}

/* All of a model as the e of a form. */
SGT_COLD static linear form_about(model x) { return form_between(model_range(x)); }

/* sgt_bundle_sag_only of an even asphere whose numbers vary, by intervals: the heights of all points with
 * r <= L, then three times the heights of those that the lines may meet. */
SGT_COLD static bool even_only(const beam_shape *s, const beam_lines *w, double L, bool *none)
{
    const sgt_interval dx = model_range(w->d.x), dy = model_range(w->d.y), dz = model_range(w->d.z),
                       x0 = model_range(w->x), y0 = model_range(w->y), c = model_range(s->c),
                       k1 = model_range(s->k1), across = {-L, L}, one = {1, 1}, within = {0, L * L};
    sgt_interval t = sgt_interval_all(), x = across, y = across;
    *none = false;
    for (int round = 0; round < 4; round++) {
        sgt_interval rho = sgt_interval_sum(sgt_interval_square(x), sgt_interval_square(y)), sum = {0, 0},
                     slope = {0, 0};
        rho = sgt_interval_intersection(rho, within);
        if (sgt_interval_is_empty(rho)) {
            *none = true;
            return true;
        }
        for (int i = EVEN_TERMS - 1; i >= 0; i--) {
            const sgt_interval a = model_range(s->a[i]);
            slope = sgt_interval_sum(sgt_interval_product(slope, rho), sgt_interval_scaled(a, i + 1));
            sum = sgt_interval_product(sgt_interval_sum(sum, a), rho);
        }
        const sgt_interval c2 = sgt_interval_product(k1, sgt_interval_square(c)),
                           phi2 = sgt_interval_difference(one, sgt_interval_product(c2, rho)),
                           phi = sgt_interval_square_root(phi2);
        const sgt_interval base =
            sgt_interval_quotient(sgt_interval_product(c, rho), sgt_interval_sum(one, phi));
        slope = sgt_interval_sum(slope, sgt_interval_quotient(sgt_interval_scaled(c, 0.5), phi));
        t = sgt_interval_intersection(t, sgt_interval_quotient(sgt_interval_sum(sum, base), dz));
        *none = sgt_interval_is_empty(t);
        if (*none) return true;
        if (!(sgt_interval_width(t) < HUGE_VAL)) return false;
        const sgt_interval fx = sgt_interval_sum(x0, sgt_interval_product(t, dx)),
                           fy = sgt_interval_sum(y0, sgt_interval_product(t, dy));
        const sgt_interval far = sgt_interval_sum(sgt_interval_square(fx), sgt_interval_square(fy));
        if (phi2.lo > 0 && sgt_interval_is_in(far, rho)) { /* the slope is that all over t */
            const sgt_interval out =
                sgt_interval_sum(sgt_interval_product(fx, dx), sgt_interval_product(fy, dy));
            slope = sgt_interval_difference(dz, sgt_interval_scaled(sgt_interval_product(out, slope), 2));
            if (sgt_interval_is_positive(slope) || sgt_interval_is_negative(slope)) return true;
        }
        x = sgt_interval_intersection(fx, across), y = sgt_interval_intersection(fy, across);
    }
    return false;
}

SGT_COLD static bool sag_only(const beam_shape *s, const beam_lines *w, double L, const bundle_lines *by,
                     sag_kept *kept, bool *none)
{
    return s->varied ? even_only(s, w, L, none) : sgt_bundle_sag_only(s->surface, L, by, kept, none);
}

/* The base whose root is the seed, as seed_of has it in departure.c.  Of toroids and biconics it is not that
 * of `base`, and may have the curvature c + lean along x and c - lean along y. */
typedef struct seed_base { double c, lean; model k1; bool any, own; } seed_base;

SGT_COLD static seed_base seed_base_of(const beam_shape *s)
{
    sgt_shared shared = {0};
    const struct sgt_builtin_ops *own = s->surface.ops->own_;
    if (own && own->share) own->share(s->surface.self, &shared);
    const double lean = shared.by_axis ? shared.lean : 0;
    if (lean == 0 && shared.c == shared.base_c)
        return (seed_base){.k1 = s->k1, .any = s->varied || s->c0 != 0};
    return (seed_base){shared.c, lean, model_number(shared.k1), true, true};
}

/* c xx + c yy + lean (xx - yy). */
SGT_COLD static model seed_bends(const beam_shape *s, const seed_base *b, model xx, model yy)
{
    if (!b->own) return by_c(s, model_sum(xx, yy));
    return model_sum(model_scaled(xx, b->c + b->lean), model_scaled(yy, b->c - b->lean));
}

/* A sag without any edge: the root is the one that searches are led to by their seeds, which are where the
 * line crosses the vertex plane, t = 0, and where it meets the base (5 of the head), or C / B where it misses
 * that (seed_of in departure.c). */
SGT_COLD static bool is_at_seeds(const beam_shape *s, const beam_lines *w, const beam_hit *m)
{
    double reach = greatest(model_range(m->t));
    const seed_base base = seed_base_of(s);
    if (base.own && s->varied) return false;
    if (base.any) {
        const model x_way = w->d.x, y_way = w->d.y, by_k = model_product(base.k1, model_square(w->d.z));
        const model B = model_difference(
            w->d.z, seed_bends(s, &base, model_product(w->x, x_way), model_product(w->y, y_way)));
        const model A = model_sum(seed_bends(s, &base, model_square(x_way), model_square(y_way)),
                                  base.own ? model_scaled(by_k, base.c) : by_c(s, by_k));
        const model C = seed_bends(s, &base, model_square(w->x), model_square(w->y));
        const model square = model_square(B), product = model_product(A, C),
                    D = model_difference(square, product);
        const double grain = 0x1p-40 * (model_size(&square) + model_size(&product));
        const bool up = model_above(B, 0), down = model_below(B, 0), missed = model_below(D, -grain);
        if (!(missed || model_above(D, grain)) || !(up || down)) return false;
        const model root = missed ? model_number(0) : model_root(D); /* where the base is missed: C / B */
        const model seed = model_quotient(C, model_sum(B, up ? root : model_negative(root)));
        reach = larger(reach, greatest(model_range(model_difference(m->t, seed))));
    }
    shape_value v;
    const model t = model_wider(m->t, reach * (1 + 0x1p-30));
    const model3 p = beam_point(w, t);
    if (!(reach < HUGE_VAL) || !shape_at(s, &p, &v)) return false;
    const sgt_interval slope = model_range(model_dot(&v.n, &w->d));
    return greatest(slope) <= SEED_SLOPES * beam_least(slope);
}

SGT_COLD static fate_of_box meet_sag(const beam_shape *s, const beam_lines *w, double aperture, double more,
                            sag_kept kept[2], beam_hit *m)
{
    static const double MORE = 1 + 0x1p-36;
    const sgt_interval bend =
        sgt_interval_product(model_range(s->k1), sgt_interval_square(model_range(s->c)));
    const double edge = bend.lo > 0 ? (1 + 0x1p-50) / sqrt(bend.lo) : HUGE_VAL; /* of the base: at most */
    const double most = smaller(s->rim, edge), least = smaller(aperture, most);
    const bundle_lines by = {
        form_about(w->x), form_about(w->y), {form_about(w->d.x), form_about(w->d.y), form_about(w->d.z)}};
    if (!(least < 0x1p400)) {
        if (!beam_meet(s, w, more, m)) return NOT_MET;
        return is_at_seeds(s, w, m) ? ALL_IN : NO_EDGE_KNOWN;
    }
    bool none = false, only = sag_only(s, w, least * MORE, &by, &kept[0], &none);
    if (only && none) {
        if (least == most) return ALL_MISS;
        return ALL_CLIPPED_OR_MISS;
    }
    if (!beam_meet(s, w, more, m)) return NOT_MET;
    const sgt_interval r2 = model_range(model_sum(model_square(m->p.x), model_square(m->p.y)));
    const side in = beam_side_of(r2, aperture), rim = beam_side_of(r2, s->rim);
    if (in == INSIDE && rim == INSIDE) return only ? ALL_IN : NOT_MET;
    if (in == EITHER || rim == EITHER) return MAY_BE_BOTH;
    /* a root outside, and none inside? */
    bool nowhere = false;
    const bool wide = most < 0x1p400 && least < most && sag_only(s, w, most * MORE, &by, &kept[1], &nowhere);
    if (in == OUTSIDE && rim == INSIDE && wide) return ALL_CLIPPED;
    return NOT_MET;
}

/* Of all lines, in pieces of t: what of `within` may have a root, r <= L, and whether each line has one at
 * most there.  Pieces are halved as long as there are any left. */
typedef struct left {
    sgt_interval t;
    bool none, only;
} left;
enum { HALVINGS = 8, WAITING = 32 };

/* A formula's surface is within its ball and its box, by all but roundings. */
SGT_COLD static void formula_cut(sgt_surface s, sgt_interval at[3])
{
    if (s.ops != &sgt_formula_ops) return;
    const sgt_formula *f = s.self;
    const double most = f->ball * (1 + 0x1p-36), lo[3] = {f->lo.x, f->lo.y, f->lo.z},
                 hi[3] = {f->hi.x, f->hi.y, f->hi.z};
    bool boxed = false;
    for (int i = 0; i < 3; i++) boxed = boxed || lo[i] != 0 || hi[i] != 0;
    for (int i = 0; i < 3; i++) {
        const double edge = 0x1p-36 * (fabs(lo[i]) + fabs(hi[i]));
        if (f->ball > 0) at[i] = sgt_interval_intersection(at[i], (sgt_interval){-most, most});
        if (boxed) at[i] = sgt_interval_intersection(at[i], (sgt_interval){lo[i] - edge, hi[i] + edge});
    }
}

SGT_COLD static left body_left(const beam_shape *s, const beam_lines *w, double L, sgt_interval within)
{
    const sgt_interval x0 = model_range(w->x), y0 = model_range(w->y),
                       d[3] = {model_range(w->d.x), model_range(w->d.y), model_range(w->d.z)},
                       across = {-L, L};
    struct {
        sgt_interval t;
        int depth;
    } stack[WAITING];
    int height = 0;
    left out = {sgt_interval_empty(), false, false};
    sgt_interval at[3], f, g[3], h[6];
    const double far =
        0x1p4 * (sgt_interval_greatest(x0) + sgt_interval_greatest(y0) + (L < HUGE_VAL ? L : 0) + 1);
    const double cuts[] = {within.lo, -0x1p10 * far, -far, 0, far, 0x1p10 * far, within.hi};
    for (size_t i = 0; i + 1 < sizeof cuts / sizeof *cuts; i++) {
        const sgt_interval t = sgt_interval_intersection(
            within, (sgt_interval){i == 0 ? within.lo : cuts[i], i == 5 ? within.hi : cuts[i + 1]});
        if (t.lo < t.hi) stack[height].t = t, stack[height++].depth = 0;
    }
    while (height > 0) {
        const sgt_interval t = stack[--height].t;
        const int depth = stack[height].depth;
        at[0] = sgt_interval_intersection(box_sum(x0, sgt_interval_product(t, d[0])), across);
        at[1] = sgt_interval_intersection(box_sum(y0, sgt_interval_product(t, d[1])), across);
        at[2] = sgt_interval_product(t, d[2]);
        formula_cut(s->surface, at);
        if (sgt_interval_is_empty(at[0]) || sgt_interval_is_empty(at[1]) || sgt_interval_is_empty(at[2]))
            continue;
        box_over(s->surface, at, &f, g, h);
        if (!(sgt_interval_width(t) < HUGE_VAL) && s->surface.ops == &sgt_quadric_ops) {
            const sgt_interval o[3] = {x0, y0, {0, 0}};
            f = quadric_beyond(s->surface.self, o, d, sgt_interval_quotient((sgt_interval){1, 1}, t));
        }
        if (!sgt_interval_has(f, 0)) continue;
        const double m = sgt_interval_middle(t);
        if (depth == HALVINGS || height + 2 > WAITING || !(sgt_interval_width(t) < HUGE_VAL)) {
            out.t = sgt_interval_hull(out.t, t);
            continue;
        }
        stack[height].t = (sgt_interval){t.lo, m}, stack[height++].depth = depth + 1;
        stack[height].t = (sgt_interval){m, t.hi}, stack[height++].depth = depth + 1;
    }
    out.none = sgt_interval_is_empty(out.t);
    if (out.none || !(sgt_interval_width(out.t) < HUGE_VAL)) return out;
    at[0] = box_sum(x0, sgt_interval_product(out.t, d[0])),
    at[1] = box_sum(y0, sgt_interval_product(out.t, d[1]));
    at[2] = sgt_interval_product(out.t, d[2]);
    if (!box_over(s->surface, at, &f, g, h)) return out;
    sgt_interval slope = sgt_interval_product(g[0], d[0]);
    slope = box_sum(slope, box_sum(sgt_interval_product(g[1], d[1]), sgt_interval_product(g[2], d[2])));
    out.only = sgt_interval_is_positive(slope) || sgt_interval_is_negative(slope);
    return out;
}

/* Is the point within ball and box of a formula, by a margin? */
SGT_COLD static bool formula_has(const beam_shape *s, const beam_hit *m)
{
    if (s->surface.ops != &sgt_formula_ops) return true;
    const sgt_formula *f = s->surface.self;
    const model r2 = model_sum(model_square(m->p.x), model_sum(model_square(m->p.y), model_square(m->p.z)));
    if (f->ball > 0 && !model_below(r2, f->ball * f->ball * EDGE_IN)) return false;
    const double lo[3] = {f->lo.x, f->lo.y, f->lo.z}, hi[3] = {f->hi.x, f->hi.y, f->hi.z};
    const model *const p[3] = {&m->p.x, &m->p.y, &m->p.z};
    if (lo[0] == 0 && lo[1] == 0 && lo[2] == 0 && hi[0] == 0 && hi[1] == 0 && hi[2] == 0) return true;
    for (int i = 0; i < 3; i++) {
        const double edge = 0x1p-38 * (fabs(lo[i]) + fabs(hi[i]));
        if (!model_above(*p[i], lo[i] + edge) || !model_below(*p[i], hi[i] - edge)) return false;
    }
    return true;
}

/* A body is met where its first crossing is inside the aperture, or its only one inside. */
SGT_COLD static fate_of_box meet_body(const beam_shape *s, const beam_lines *w, double aperture, double more,
                             beam_hit *m)
{
    const double L = aperture * (1 + 0x1p-36);
    const bool met = beam_meet(s, w, more, m) && formula_has(s, m);
    const side in =
        met ? beam_side_of(model_range(model_sum(model_square(m->p.x), model_square(m->p.y))), aperture)
            : EITHER;
    if (met && in == EITHER) return MAY_BE_BOTH;
    if (met && in == INSIDE && s->body) {
        const left before = body_left(s, w, HUGE_VAL, (sgt_interval){-HUGE_VAL, model_range(m->t).hi});
        if (before.only) return ALL_IN;
    }
    const left within = body_left(s, w, L, sgt_interval_all());
    if (met && in == INSIDE) return within.only ? ALL_IN : NOT_MET;
    const left all = aperture < HUGE_VAL ? body_left(s, w, HUGE_VAL, sgt_interval_all()) : within;
    if (all.none) return ALL_MISS;
    if (met && in == OUTSIDE && (all.only || within.none)) return ALL_CLIPPED;
    return within.none ? ALL_CLIPPED_OR_MISS : NOT_MET;
}

/* --------------------------------------------------------------------------- bending */

SGT_COLD static void beam_unit(model3 *d)
{
    const model length2 = model_sum(model_square(d->x), model_sum(model_square(d->y), model_square(d->z)));
    const model by = model_inverse(model_root(length2));
    d->x = model_product(d->x, by), d->y = model_product(d->y, by), d->z = model_product(d->z, by);
}

/* An index, or one over one. */
typedef struct index_models {
    model n1, n2, r, k;
    bool same, mirror;
} index_models;

/* d' = r d + f n.  D: under the root, over n . n; 0 of a mirror.  false: *fate says why there is none. */
SGT_COLD static bool bend_plain(const index_models *by, const beam_hit *m, model3 *d, sgt_interval *behind,
                       sgt_fate *fate)
{
    model f;
    *fate = SGT_LOST;
    if (by->mirror) {
        f = model_scaled(model_quotient(m->slope, m->size2), -2);
        d->x = model_sum(d->x, model_product(f, m->n.x));
        d->y = model_sum(d->y, model_product(f, m->n.y));
        d->z = model_sum(d->z, model_product(f, m->n.z));
        return true;
    }
    const model rg = model_product(by->r, m->slope), square = model_square(rg),
                kn = model_product(by->k, m->size2);
    const model D = model_sum(square, kn);
    const double least = 0x1p-40 * (model_size(&square) + model_size(&kn));
    const sgt_interval range = model_range(D);
    if (range.hi < -least) *fate = SGT_TIR;
    if (!(range.lo > least)) return false;
    const model root = model_root(D), down = model_sum(rg, m->sign > 0 ? root : model_negative(root));
    f = model_quotient(by->k, down);
    d->x = model_sum(model_product(by->r, d->x), model_product(f, m->n.x));
    d->y = model_sum(model_product(by->r, d->y), model_product(f, m->n.y));
    d->z = model_sum(model_product(by->r, d->z), model_product(f, m->n.z));
    *behind = sgt_interval_square_root(sgt_interval_quotient(range, model_range(m->size2)));
    return true;
}

/* An ideal lens (system.h): W is n2 N(w') - n1 N(w), N = p . (w + w0) / (S(w) + S(w0)). */
SGT_COLD static model ideal_term(const model3 *p, const model *wx, const model *wy, const model *w0x,
                                 const model *w0y)
{
    const model S = model_root(model_plus(model_sum(model_square(*wx), model_square(*wy)), 1));
    const model S0 = model_root(model_plus(model_sum(model_square(*w0x), model_square(*w0y)), 1));
    const model along =
        model_sum(model_product(p->x, model_sum(*wx, *w0x)), model_product(p->y, model_sum(*wy, *w0y)));
    return model_quotient(along, model_sum(S, S0));
}

/* 1 / (n2 f) */
SGT_COLD static model ideal_power(double f, model i2)
{
    return model_wider(model_scaled(i2, 1 / f), BEAM_SLACK / fabs(f) * model_size(&i2));
}

SGT_COLD static bool bend_ideal(const sgt_phase *phase, const index_models *by, const model3 *p, model3 *d,
                       model *path)
{
    const bool up = model_above(d->z, 0x1p-40), down = model_below(d->z, -0x1p-40);
    if (!up && !down) return false;
    const model inverse = model_inverse(up ? d->z : model_negative(d->z)), i2 = model_inverse(by->n2);
    const sgt_vec2 f = focal_lengths(phase);
    const model Fx = ideal_power(f.x, i2), Fy = ideal_power(f.y, i2);
    const double near = phase->object_distance == 0 ? 0 : 1 / phase->object_distance;
    const model wx = model_product(d->x, inverse), wy = model_product(d->y, inverse);
    const model ex = model_difference(model_product(by->r, wx), model_product(Fx, p->x)),
                ey = model_difference(model_product(by->r, wy), model_product(Fy, p->y));
    const model w0x = model_difference(wx, model_scaled(p->x, near)),
                w0y = model_difference(wy, model_scaled(p->y, near));
    const model e0x = model_product(by->r, w0x), e0y = model_product(by->r, w0y);
    const model front = model_product(by->n1, ideal_term(p, &wx, &wy, &w0x, &w0y));
    const model back = model_product(by->n2, ideal_term(p, &ex, &ey, &e0x, &e0y));
    const model W = model_difference(back, front);
    *path = model_sum(*path, model_wider(W, BEAM_SLACK * (model_size(&front) + model_size(&back))));
    const model S = model_inverse(model_root(model_plus(model_sum(model_square(ex), model_square(ey)), 1)));
    d->x = model_product(ex, S), d->y = model_product(ey, S);
    d->z = up != by->mirror ? S : model_negative(S);
    return d->z.e < HUGE_VAL;
}

/* A phase in waves (system.h).  false: as bend_plain, or *unknown: W has no bounds. */
SGT_COLD static bool bend_waves(const sgt_element *e, const model *per_wave, const index_models *by,
                                const beam_hit *m, model3 *d, model *path, sgt_fate *fate, bool *unknown)
{
    const sgt_surface waves = in_set(e->phase->waves);
    beam_shape s = {.kind = SHAPE_NONE};
    sag_models W;
    *fate = SGT_LOST, *unknown = true;
    if (e->phase->kind != SGT_PHASE_SAG || !waves.ops->own_) return false;
    if (waves.ops == &sgt_conic_ops) {
        const sgt_conic *q = waves.self;
        s.c0 = q->c, s.k0 = q->k;
    } else if (waves.ops == &sgt_even_asphere_ops) {
        const sgt_even_asphere *q = waves.self;
        s.c0 = q->c, s.k0 = q->k, s.even = q->a;
        for (int i = 0; i < EVEN_TERMS; i++) s.a[i] = model_number(q->a[i]);
    } else if (sgt_bundle_has_sag(waves)) {
        waves.ops->own_->base(waves.self, &s.c0, &s.k0);
        s.of = waves.ops->own_->departure;
    } else {
        return false;
    }
    s.surface = waves, s.c = model_number(s.c0), s.k1 = model_made(model_number(1 + s.k0), 1 + fabs(s.k0));
    if (!sag_models_of(&s, &m->p.x, &m->p.y, &W)) return false;
    *unknown = false;
    const model gx = model_product(*per_wave, W.x), gy = model_product(*per_wave, W.y);
    const model3 u = {model_sum(model_product(by->n1, d->x), gx), model_sum(model_product(by->n1, d->y), gy),
                      model_product(by->n1, d->z)};
    const model inverse = model_inverse(m->size2), k = model_product(model_dot(&u, &m->n), inverse);
    const model3 t = {model_difference(u.x, model_product(k, m->n.x)),
                      model_difference(u.y, model_product(k, m->n.y)),
                      model_difference(u.z, model_product(k, m->n.z))};
    const model n2 = model_square(by->n2), t2 = model_dot(&t, &t), q = model_difference(n2, t2);
    const sgt_interval range = model_range(q);
    const double least = 0x1p-40 * (model_size(&n2) + model_size(&t2));
    if (range.hi < -least) *fate = SGT_EVANESCENT;
    if (!(range.lo > least)) return false;
    const model root = model_root(model_product(q, inverse)), over = model_inverse(by->n2);
    const model along = (m->sign > 0) != by->mirror ? root : model_negative(root);
    d->x = model_product(model_sum(t.x, model_product(along, m->n.x)), over);
    d->y = model_product(model_sum(t.y, model_product(along, m->n.y)), over);
    d->z = model_product(model_sum(t.z, model_product(along, m->n.z)), over);
    *path = model_sum(*path, model_product(*per_wave, model_wider(W.s, W.off)));
    return d->z.e < HUGE_VAL;
}

/* ------------------------------------------------------------------------- the frames */

typedef struct frame {
    bool turned, varied;
    sgt_pose pose;
    model3 move, turn;
    bool spun;
} frame;

/* By the angle about an axis: (a, b) are the components across it, in right-handed order. */
SGT_COLD static void turn_pair(const model *c, const model *s, double sign, model *a, model *b)
{
    const model sb = model_product(*s, *b), sa = model_product(*s, *a);
    const model ca = model_product(*c, *a), cb = model_product(*c, *b);
    *a = sign > 0 ? model_difference(ca, sb) : model_sum(ca, sb);
    *b = sign > 0 ? model_sum(cb, sa) : model_difference(cb, sa);
}

SGT_COLD static void frame_of(const beam_task *task, size_t i, frame *f)
{
    f->pose = task->lens->e[i].pose;
    f->turned = is_turned(&f->pose);
    f->varied = varies(task, i, SGT_BOX_ORIGIN), f->spun = varies(task, i, SGT_BOX_TURN);
    if (f->varied)
        f->move = (model3){changed(task, i, SGT_BOX_ORIGIN, 0, 0), changed(task, i, SGT_BOX_ORIGIN, 1, 0),
                           changed(task, i, SGT_BOX_ORIGIN, 2, 0)};
    if (f->spun)
        f->turn = (model3){changed(task, i, SGT_BOX_TURN, 0, 0), changed(task, i, SGT_BOX_TURN, 1, 0),
                           changed(task, i, SGT_BOX_TURN, 2, 0)};
}

/* R = Rz Ry Rx turns the element's axes; sign -1: by its transpose, Rx^T first. */
SGT_COLD static void spin(const frame *f, double sign, model3 *a)
{
    const model cx = model_turned(f->turn.x, true), sx = model_turned(f->turn.x, false);
    const model cy = model_turned(f->turn.y, true), sy = model_turned(f->turn.y, false);
    const model cz = model_turned(f->turn.z, true), sz = model_turned(f->turn.z, false);
    if (sign > 0) {
        turn_pair(&cx, &sx, 1, &a->y, &a->z);
        turn_pair(&cy, &sy, 1, &a->z, &a->x);
        turn_pair(&cz, &sz, 1, &a->x, &a->y);
    } else {
        turn_pair(&cz, &sz, -1, &a->x, &a->y);
        turn_pair(&cy, &sy, -1, &a->z, &a->x);
        turn_pair(&cx, &sx, -1, &a->y, &a->z);
    }
}

SGT_COLD static void beam_into(const frame *f, model3 *a)
{
    if (f->turned)
        *a = (model3){model_along(a, f->pose.ex), model_along(a, f->pose.ey), model_along(a, f->pose.ez)};
    if (f->spun) spin(f, -1, a);
}

SGT_COLD static void beam_out_of(const frame *f, model3 *a)
{
    if (f->spun) spin(f, 1, a);
    if (!f->turned) return;
    const sgt_vec3 ex = f->pose.ex, ey = f->pose.ey, ez = f->pose.ez;
    *a = (model3){model_along(a, (sgt_vec3){ex.x, ey.x, ez.x}), model_along(a, (sgt_vec3){ex.y, ey.y, ez.y}),
                  model_along(a, (sgt_vec3){ex.z, ey.z, ez.z})};
}

SGT_COLD static void moved_by(const frame *f, double sign, model3 *p)
{
    const sgt_vec3 o = f->pose.origin;
    *p = (model3){model_plus(p->x, sign * o.x), model_plus(p->y, sign * o.y), model_plus(p->z, sign * o.z)};
    if (!f->varied) return;
    if (sign > 0)
        *p = (model3){model_sum(p->x, f->move.x), model_sum(p->y, f->move.y), model_sum(p->z, f->move.z)};
    else
        *p = (model3){model_difference(p->x, f->move.x), model_difference(p->y, f->move.y),
                      model_difference(p->z, f->move.z)};
}

/* -------------------------------------------------------------------------- the walk */

SGT_COLD static int to_divide(const model *const by[], int n)
{
    int best = -1;
    double most = 0;
    for (int i = 0; i < MODEL_N; i++) {
        double sum = 0;
        for (int k = 0; k < n; k++) sum += model_changes(by[k], i);
        if (sum > most) most = sum, best = i;
    }
    return best;
}

SGT_COLD static sgt_box_verdict cut(sgt_box_end *out, size_t i, sgt_box_why why, const model3 *p)
{
    out->verdict = SGT_BOX_CUT, out->why = why, out->element = i;
    out->divide = to_divide((const model *const[]){&p->x, &p->y}, 2);
    return SGT_BOX_CUT;
}

SGT_COLD static sgt_box_verdict stopped(sgt_box_end *out, size_t i, sgt_fate fate, unsigned causes)
{
    out->verdict = SGT_BOX_STOPPED, out->element = i, out->fate = fate, out->causes = causes;
    return SGT_BOX_STOPPED;
}

SGT_COLD static void tell_at(const sgt_element *e, const beam_hit *m, sgt_box_at *at)
{
    const sgt_interval r2 = model_range(model_sum(model_square(m->p.x), model_square(m->p.y)));
    const sgt_interval r = sgt_interval_square_root(r2), slope = model_range(model_square(m->slope));
    const double edge = is_open(e->semi_diameter) ? HUGE_VAL : e->semi_diameter;
    *at = (sgt_box_at){.x = model_range(m->p.x), .y = model_range(m->p.y), .z = model_range(m->p.z)};
    at->cosine = sgt_interval_square_root(sgt_interval_quotient(slope, model_range(m->size2)));
    at->cosine = sgt_interval_intersection(at->cosine, (sgt_interval){0, 1});
    at->behind = at->cosine;
    at->margin = edge < HUGE_VAL ? sgt_interval_difference(sgt_interval_of(edge), r)
                                 : (sgt_interval){HUGE_VAL, HUGE_VAL};
    at->items = HUGE_VAL;
}

/* Of the angle between the unit direction d and the normal. */
SGT_COLD static sgt_interval cosine_of(const beam_hit *m, const model3 *d)
{
    const double size = model_size(&m->n.x) + model_size(&m->n.y) + model_size(&m->n.z);
    const model along = model_wider(model_dot(&m->n, d), BEAM_SLACK * size);
    const sgt_interval square = sgt_interval_square(model_range(along));
    const sgt_interval cosine =
        sgt_interval_square_root(sgt_interval_quotient(square, model_range(m->size2)));
    return sgt_interval_intersection(cosine, (sgt_interval){0, 1});
}

SGT_COLD static sgt_interval root_within(sgt_interval r2)
{
    return sgt_interval_square_root(sgt_interval_intersection(r2, (sgt_interval){0, HUGE_VAL}));
}

/* How far all points are beyond the edge of an item, below 0 inside: 0, if that is not known here. */
SGT_COLD static bool item_level(const sgt_aperture_item *i, const beam_hit *m, sgt_interval *level)
{
    const model dx = model_plus(m->p.x, -i->centre.x), dy = model_plus(m->p.y, -i->centre.y);
    if (i->shape == SGT_CIRCLE || i->shape == SGT_ANNULUS) {
        const sgt_interval r2 = model_range(model_sum(model_square(dx), model_square(dy)));
        const sgt_interval r = root_within(r2);
        *level = sgt_interval_difference(r, sgt_interval_of(i->radius));
        if (i->shape == SGT_ANNULUS && i->inner > 0) {
            const sgt_interval within = sgt_interval_difference(sgt_interval_of(i->inner), r);
            *level = (sgt_interval){larger(level->lo, within.lo), larger(level->hi, within.hi)};
        }
        return i->radius < HUGE_VAL;
    }
    if (i->shape != SGT_RECTANGLE && i->shape != SGT_ELLIPSE) return false;
    double c, s;
    sgt_turns(1, &i->degrees, &c, &s);
    const model qx = model_sum(model_scaled(dx, c), model_scaled(dy, s)),
                qy = model_difference(model_scaled(dy, c), model_scaled(dx, s));
    if (i->shape == SGT_RECTANGLE) {
        const sgt_interval x = sgt_interval_difference(sgt_interval_absolute(model_range(qx)),
                                                       sgt_interval_of(i->half.x)),
                           y = sgt_interval_difference(sgt_interval_absolute(model_range(qy)),
                                                       sgt_interval_of(i->half.y));
        *level = (sgt_interval){larger(x.lo, y.lo), larger(x.hi, y.hi)};
        return i->half.x < HUGE_VAL && i->half.y < HUGE_VAL;
    }
    const double least = smaller(i->half.x, i->half.y);
    if (!(least > 0x1p-400) || !(larger(i->half.x, i->half.y) < HUGE_VAL)) return false;
    const model ux = model_scaled(qx, 1 / i->half.x), uy = model_scaled(qy, 1 / i->half.y);
    const sgt_interval r2 = model_range(model_sum(model_square(ux), model_square(uy)));
    const sgt_interval r = root_within(r2);
    *level = sgt_interval_scaled(sgt_interval_difference(r, sgt_interval_of(1)), least);
    return true;
}

/* As sgt_aperture_over; but round items and straight ones by models, which follow an edge. */
SGT_COLD static int items_over(const sgt_aperture *a, const beam_hit *m, double *away)
{
    const sgt_interval x = model_range(m->p.x), y = model_range(m->p.y);
    int all = 1;
    *away = HUGE_VAL;
    for (size_t k = 0; k < a->count; k++) {
        const sgt_aperture_item *i = &a->items[k];
        sgt_interval level;
        double far = 0;
        int through = sgt_aperture_over(&(sgt_aperture){.count = 1, .items = i}, x, y, &far);
        if (through == 0 && item_level(i, m, &level)) {
            const bool round = i->shape == SGT_CIRCLE || i->shape == SGT_ANNULUS;
            const double soft = 0x1p-38 * (greatest(x) + greatest(y) + fabs(i->centre.x) + fabs(i->centre.y) +
                                           (round ? i->radius : larger(i->half.x, i->half.y))) + 0x1p-490;
            if (i->obscuring) level = sgt_interval_negative(level);
            if (level.lo > soft) through = -1;
            if (level.hi < -soft) through = 1, far = -level.hi - soft;
        }
        if (through < 0) return -1;
        if (through == 0) all = 0;
        else *away = smaller(*away, far);
    }
    if (all == 0) *away = 0;
    return all;
}

SGT_COLD static void indices_of(const beam_task *task, size_t i, const model *n1, bool n1_varied,
                                bool *varied, index_models *by)
{
    const sgt_element *e = &task->lens->e[i];
    const sgt_model *own = number_of(task, i, SGT_BOX_INDEX, 0);
    by->n1 = *n1, by->mirror = e->index == SGT_MIRROR;
    by->n2 = own && !by->mirror            ? model_read(own)
             : e->index == 0 || by->mirror ? *n1
                                           : model_number(e->index);
    *varied = own && !by->mirror ? true : e->index == 0 || by->mirror ? n1_varied : false;
    by->same = by->mirror || (!own && (e->index == 0 || (!n1_varied && e->index == n1->c)));
    if (by->same) {
        by->r = model_number(1), by->k = model_number(0);
        return;
    }
    const model i2 = model_inverse(by->n2);
    by->r = model_product(by->n1, i2);
    by->k = model_product(model_product(model_difference(by->n2, by->n1), i2),
                          model_product(model_sum(by->n2, by->n1), i2));
}

SGT_COLD static bool is_positive(model x) { return model_above(x, 0) && model_range(x).hi < HUGE_VAL; }

#ifdef MODEL_SERIES
SGT_COLD static void launch_of(const beam_task *task, model3 *p, model3 *d)
{
    const sgt_series *o = task->from->p, *along = task->from->d;
    *p = (model3){series_read(&o[0]), series_read(&o[1]), series_read(&o[2])};
    *d = (model3){series_read(&along[0]), series_read(&along[1]), series_read(&along[2])};
}

SGT_COLD static void write_ray(const model3 *p, const model3 *d, model path, sgt_series_ray *out)
{
    series_write(p->x, &out->p[0]), series_write(p->y, &out->p[1]), series_write(p->z, &out->p[2]);
    series_write(d->x, &out->d[0]), series_write(d->y, &out->d[1]), series_write(d->z, &out->d[2]);
    series_write(path, &out->opl);
}
#else
SGT_COLD static void launch_of(const beam_task *task, model3 *p, model3 *d)
{
    const sgt_model *o = task->launch->o, *along = task->launch->d;
    *p = (model3){model_read(&o[0]), model_read(&o[1]), model_read(&o[2])};
    *d = (model3){model_read(&along[0]), model_read(&along[1]), model_read(&along[2])};
}
#endif

SGT_COLD static sgt_box_verdict box_walk(const beam_task *task, sgt_box_end *out)
{
    const sgt_box_lens *lens = task->lens;
    const double launch_index = lens->index_before == 0 ? 1 : lens->index_before;
    model3 p, d;
    launch_of(task, &p, &d);
    const sgt_model *before = number_of(task, SGT_BOX_BEFORE, SGT_BOX_INDEX, 0);
    model index = before ? model_read(before) : model_number(launch_index), path = model_number(0);
    bool index_varied = before != NULL;
    beam_unit(&d);
    if (!is_positive(index)) return cut(out, 0, SGT_BOX_UNSOUND, &p);
    const double given = BEAM_SLACK * (model_size(&p.x) + model_size(&p.y) + model_size(&p.z));
    p.x = model_wider(p.x, given), p.y = model_wider(p.y, given), p.z = model_wider(p.z, given);
    if (!(d.z.e < HUGE_VAL)) return cut(out, 0, SGT_BOX_TOO_LARGE, &p);
    for (size_t i = 0; i < lens->elements; i++) {
        const sgt_element *e = &lens->e[i];
        beam_shape s;
        frame f;
        beam_hit m;
        beam_lines w;
        index_models by;
        bool varied;
        frame_of(task, i, &f), beam_shape_of(task, i, &s);
        indices_of(task, i, &index, index_varied, &varied, &by);
        if (!is_positive(by.n2)) return cut(out, i, SGT_BOX_UNSOUND, &p);
        moved_by(&f, -1, &p);
        beam_into(&f, &p), beam_into(&f, &d);
        const double grain = BEAM_SLACK * (model_size(&p.x) + model_size(&p.y) + model_size(&p.z));
        p.x = model_wider(p.x, grain), p.y = model_wider(p.y, grain), p.z = model_wider(p.z, grain);
        d.x = model_wider(d.x, BEAM_SLACK), d.y = model_wider(d.y, BEAM_SLACK),
        d.z = model_wider(d.z, BEAM_SLACK);
#ifdef MODEL_SERIES
        if (task->arriving && i + 1 == lens->elements) write_ray(&p, &d, path, task->arriving);
#endif
        const model t0 = model_negative(model_quotient(p.z, d.z));
        w.x = model_sum(p.x, model_product(t0, d.x)), w.y = model_sum(p.y, model_product(t0, d.y)), w.d = d;
        const model3 plane = {w.x, w.y, model_number(0)};
        if (!(w.x.e < HUGE_VAL && w.y.e < HUGE_VAL)) return cut(out, i, SGT_BOX_AT_PLANE, &p);
        if (s.kind == SHAPE_NONE) return cut(out, i, SGT_BOX_NO_BOUNDS, &plane);
        const double aperture = is_open(e->semi_diameter) ? HUGE_VAL : e->semi_diameter;
        const double tolerance =
            0x1p-46 * (aperture < HUGE_VAL ? aperture : model_size(&w.x) + model_size(&w.y));
        sag_kept kept[2] = {{.known = false}, {.known = false}};
        if (task->room) memcpy(kept, &task->room[i], sizeof kept);
        const bool conic = s.kind == SHAPE_CONIC;
        const fate_of_box fate = conic                  ? meet_conic(&s, &w, aperture, tolerance, &m)
                                 : s.kind == SHAPE_BODY ? meet_body(&s, &w, aperture, tolerance, &m)
                                                        : meet_sag(&s, &w, aperture, tolerance, kept, &m);
        if (task->room) memcpy(&task->room[i], kept, sizeof kept);
        switch (fate) {
        case ALL_IN:
            break;
        case ALL_CLIPPED:
            return stopped(out, i, SGT_CLIPPED, 1u << SGT_CLIPPED);
        case ALL_MISS:
            return stopped(out, i, SGT_MISSED, 1u << SGT_MISSED);
        case ALL_CLIPPED_OR_MISS:
            return stopped(out, i, SGT_LOST, 1u << SGT_CLIPPED | 1u << SGT_MISSED);
        case MAY_BE_BOTH:
            if (task->at) tell_at(e, &m, &task->at[i]);
            return cut(out, i, SGT_BOX_AT_EDGE, &m.p);
        case NOT_MET:
            return cut(out, i, SGT_BOX_AT_SURFACE, &plane);
        case NO_EDGE_KNOWN:
            return cut(out, i, SGT_BOX_NO_EDGE, &m.p);
        }
        sgt_box_at *at = task->at ? &task->at[i] : NULL;
        if (at) tell_at(e, &m, at);
        if (e->aperture) {
            double away = 0;
            const int through = items_over(e->aperture, &m, &away);
            if (at) at->items = through > 0 ? away : 0;
            if (through < 0) return stopped(out, i, SGT_CLIPPED, 1u << SGT_CLIPPED);
            if (through == 0) return cut(out, i, SGT_BOX_AT_EDGE, &m.p);
        }
        const model way = model_product(index, model_sum(t0, m.t));
        path = model_sum(path, model_wider(way, BEAM_SLACK * model_size(&way)));
        sgt_fate end = SGT_PASSED;
        bool unknown = false, passed = true;
        sgt_interval behind = {0, 1};
        if (e->phase && is_in_waves(e->phase)) {
            const sgt_model *order = number_of(task, i, SGT_BOX_PER_WAVE, 0);
            const model per_wave = order ? model_read(order) : model_number(e->phase->per_wave);
            passed = bend_waves(e, &per_wave, &by, &m, &d, &path, &end, &unknown);
        } else if (e->phase) {
            passed = bend_ideal(e->phase, &by, &m.p, &d, &path), end = SGT_LOST;
        } else if (by.mirror || !by.same) {
            passed = bend_plain(&by, &m, &d, &behind, &end);
            if (at && !by.mirror) at->behind = sgt_interval_intersection(behind, (sgt_interval){0, 1});
        }
        if (!passed && end == SGT_LOST)
            return cut(out, i, unknown ? SGT_BOX_NO_BOUNDS : SGT_BOX_AT_BENDING, &m.p);
        if (!passed) return stopped(out, i, end, 1u << end);
        if (at && e->phase) at->behind = cosine_of(&m, &d);
        p = m.p;
        if (i + 1 == lens->elements) break;
        index = by.n2, index_varied = varied;
        beam_out_of(&f, &p), beam_out_of(&f, &d);
        moved_by(&f, 1, &p);
    }
    d.x = model_wider(d.x, BEAM_SLACK), d.y = model_wider(d.y, BEAM_SLACK),
    d.z = model_wider(d.z, BEAM_SLACK);
    out->verdict = SGT_BOX_PASSED, out->element = lens->elements, out->fate = SGT_PASSED;
#ifdef MODEL_SERIES
    write_ray(&p, &d, path, task->ends);
#else
    model_write(p.x, &out->p[0]), model_write(p.y, &out->p[1]), model_write(p.z, &out->p[2]);
    model_write(d.x, &out->d[0]), model_write(d.y, &out->d[1]), model_write(d.z, &out->d[2]);
    model_write(path, &out->opl);
#endif
    if (p.x.e + p.y.e + p.z.e + path.e < HUGE_VAL) return SGT_BOX_PASSED;
    return cut(out, lens->elements, SGT_BOX_TOO_LARGE, &p);
}

#endif
