// SPDX-License-Identifier: MIT
/* sum.c - several departures on one conic base.
 *
 * P = P_1 + P_2 + ..., where each P_i is the departure of a surface.  They are summed in the order of the
 * terms.  Each sum rounds by u of what has been summed so far.  So n - 1 sums round by at most (n - 1) u
 * sum |P_i|.  Bounds add, over the region where all are defined. */
#include "departure.h"

enum { MOST_TERMS = 16 };

static const departure *of(const sgt_surface *term) { return in_set(*term).ops->own_->departure; }

static void sum_at(const void *self, size_t n, const double *x, const double *y, sag_values out)
{
    const sgt_sum *s = self;
    double p[DEPARTURE_BLOCK], px[DEPARTURE_BLOCK], py[DEPARTURE_BLOCK];
    for (size_t i = 0; i < n; i++) out.p[i] = out.px[i] = out.py[i] = 0;
    for (size_t k = 0; k < s->count; k++) {
        of(&s->terms[k])->at(s->terms[k].self, n, x, y, (sag_values){p, px, py});
        for (size_t i = 0; i < n; i++) out.p[i] += p[i], out.px[i] += px[i], out.py[i] += py[i];
    }
}

static void sum_alone(const void *self, size_t n, const double *x, const double *y, double *p)
{
    const sgt_sum *s = self;
    double own[DEPARTURE_BLOCK], unread[2][DEPARTURE_BLOCK];
    for (size_t i = 0; i < n; i++) p[i] = 0;
    for (size_t k = 0; k < s->count; k++) {
        const departure *term = of(&s->terms[k]);
        if (term->alone) term->alone(s->terms[k].self, n, x, y, own);
        else term->at(s->terms[k].self, n, x, y, (sag_values){own, unread[0], unread[1]});
        for (size_t i = 0; i < n; i++) p[i] += own[i];
    }
}

static void sum_rounding(const void *self, double x, double y, double *p_err, double *grad_err)
{
    const sgt_sum *s = self;
    double p, px, py, e, g, size = 0, steep = 0, most = SGT_U * (double)s->count;
    *p_err = *grad_err = 0;
    for (size_t k = 0; k < s->count; k++) {
        of(&s->terms[k])->at(s->terms[k].self, 1, &x, &y, (sag_values){&p, &px, &py});
        of(&s->terms[k])->rounding(s->terms[k].self, x, y, &e, &g);
        *p_err += e, *grad_err += g;
        size += fabs(p), steep += larger(fabs(px), fabs(py));
    }
    *p_err = 1.01 * (*p_err + most * size), *grad_err = 1.01 * (*grad_err + most * steep);
}

static void sum_noise(const void *self, double radius, double e[2])
{
    const sgt_sum *s = self;
    double sizes = 0;
    e[0] = e[1] = 0;
    for (size_t k = 0; k < s->count; k++) {
        const departure *term = of(&s->terms[k]);
        double own[2] = {(double)NAN, (double)NAN};
        region where = {{-radius, radius}, {-radius, radius}, 0, radius};
        bounds b = {HUGE_VAL, HUGE_VAL, HUGE_VAL};
        if (term->noise) term->noise(s->terms[k].self, radius, own);
        term->bounds(s->terms[k].self, &where, &b);
        e[0] += own[0], e[1] += own[1], sizes += b.size;
    }
    if (s->count > 1) e[0] = 1.01 * (e[0] + SGT_U * (double)s->count * sizes);
}

static int sum_bounds(const void *self, region *where, bounds *out)
{
    const sgt_sum *s = self;
    int all = 1;
    bounds sum = {0, 0, 0};
    for (size_t k = 0; k < s->count; k++) {
        bounds b;
        int defined = of(&s->terms[k])->bounds(s->terms[k].self, where, &b);
        if (!defined) return 0;
        if (defined < 0) all = -1;
        sum.size += b.size, sum.steep += b.steep, sum.bend += b.bend;
    }
    *out = (bounds){sum.size * (1 + 0x1p-40), sum.steep * (1 + 0x1p-40), sum.bend * (1 + 0x1p-40)};
    return all;
}

static sgt_interval sum_range(const void *self, const region *where)
{
    const sgt_sum *s = self;
    sgt_interval sum = {0, 0};
    for (size_t k = 0; k < s->count; k++) {
        const departure *term = of(&s->terms[k]);
        region part = *where;
        bounds b = {HUGE_VAL, HUGE_VAL, HUGE_VAL};
        if (!term->range && !term->bounds(s->terms[k].self, &part, &b)) return sgt_interval_empty();
        sgt_interval p = sgt_interval_between(-b.size, b.size);
        if (term->range) p = term->range(s->terms[k].self, where);
        if (sgt_interval_is_empty(p)) return p;
        sum = sgt_interval_sum(sum, p);
    }
    return sum;
}

/* Known if all have the same sign. */
static double sum_tail(const void *self, double radius)
{
    const sgt_sum *s = self;
    double sum = 0;
    for (size_t k = 0; k < s->count; k++) {
        const departure *term = of(&s->terms[k]);
        double own = term->tail ? term->tail(s->terms[k].self, radius) : 0;
        if (own == 0 || (sum != 0 && signbit(own) != signbit(sum))) return 0; /* a product may be 0 */
        sum += own * (1 - 0x1p-40);
    }
    return sum;
}

SGT_NARROW(void, sgt_sum_second,
           (const void *self, size_t n, const double *x, const double *y, double *pxx, double *pxy,
            double *pyy))
{
    const sgt_sum *s = self;
    double xx[DEPARTURE_BLOCK], xy[DEPARTURE_BLOCK], yy[DEPARTURE_BLOCK];
    for (size_t i = 0; i < n; i++) pxx[i] = pxy[i] = pyy[i] = 0;
    for (size_t k = 0; k < s->count; k++) {
        of(&s->terms[k])->second(s->terms[k].self, n, x, y, xx, xy, yy);
        for (size_t i = 0; i < n; i++) pxx[i] += xx[i], pxy[i] += xy[i], pyy[i] += yy[i];
    }
}

static size_t sum_parameters(const void *self)
{
    const sgt_sum *s = self;
    size_t count = 0;
    for (size_t k = 0; k < s->count; k++) count += of(&s->terms[k])->parameters(s->terms[k].self);
    return count;
}

SGT_NARROW(void, sgt_sum_by_parameter,
           (const void *self, size_t j, size_t n, const double *x, const double *y, sag_values out))
{
    const sgt_sum *s = self;
    const sgt_surface *term = s->terms;
    for (size_t own; j >= (own = of(term)->parameters(term->self)); term++) j -= own;
    of(term)->by_parameter(term->self, j, n, x, y, out);
}

static sgt_objection sum_object(const void *self)
{
    const sgt_sum *s = self;
    sgt_objection fine = {NULL, NULL};
    if (s->count > MOST_TERMS) return (sgt_objection){"terms", "too many: 16 are the most"};
    if (s->count && !s->terms) return (sgt_objection){"terms", "is not there"};
    for (size_t k = 0; k < s->count; k++) {
        const sgt_surface *term = &s->terms[k];
        if (!term->ops || in_set(*term).ops == &sgt_sum_ops || !term->ops->own_ || !of(term) || !term->self)
            return (sgt_objection){"terms", "holds what is no sag, or another sum"};
        if (of(term)->object(term->self).reason)
            return (sgt_objection){"terms", "holds one whose parameters are not valid"};
    }
    return fine;
}

static bool sum_along(const void *self, sgt_course *out)
{
    const sgt_sum *s = self;
    *out = (sgt_course){0, true, 0};
    for (size_t k = 0; k < s->count; k++) {
        const departure *term = of(&s->terms[k]);
        sgt_course own;
        if (!term->along || !term->noise || !term->along(s->terms[k].self, &own)) return false;
        if (own.degree > out->degree) out->degree = own.degree;
        if (!(out->home > 0) || (own.home > 0 && own.home < out->home)) out->home = own.home;
        out->even = out->even && own.even;
    }
    return true;
}

static const departure sum_departure = {
    .at = sum_at, .rounding = sum_rounding, .bounds = sum_bounds, .range = sum_range,
    .second = sgt_sum_second,
    .parameters = sum_parameters, .by_parameter = sgt_sum_by_parameter, .object = sum_object,
    .noise = sum_noise,
    .tail = sum_tail, .along = sum_along, .alone = sum_alone};

DEPARTURE_ON_CONIC(sum, sgt_sum)
