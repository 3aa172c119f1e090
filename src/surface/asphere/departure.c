// SPDX-License-Identifier: MIT
/* asphere/departure.c - the terms of an even asphere by themselves, for a sum (departure/sum.c): P =
 * p(rho), with rho = r^2 and p the sum of a[i] rho^(i+1).
 *
 * grad P = 2 p' (x, y), P_xx = 2 p' + 4 p'' x^2, and so on.  Horner's rule rounds each term at most 2 i + 2
 * times, and rho carries 2 roundings.  With M = the sum of (i + 1) |a[i]| rho^i, P is off by at most 4 u
 * rho M.  For r <= R the sums of magnitudes bound p' and p''.  The greater eigenvalue of the second
 * derivative is at most 2 |p'| + 4 |p''| rho. */
#include "asphere.h"
#include "../departure/departure.h"

static int terms_count(const sgt_even_asphere *s)
{
    int n = 8;
    while (n > 0 && s->a[n - 1] == 0) n--;
    return n;
}

/* p, p' and p'' / 2 for each rho. */
SGT_KERNEL
static void terms_horner(int terms, const double *a, size_t n, const double *restrict x,
                         const double *restrict y, double *restrict p, double *restrict p1,
                         double *restrict p2)
{
    double rho[DEPARTURE_BLOCK];
    LANES for (size_t i = 0; i < n; i++) rho[i] = x[i] * x[i] + y[i] * y[i], p[i] = p1[i] = p2[i] = 0;
    for (int j = terms; j >= 0; j--) {
        double coefficient = j ? a[j - 1] : 0;
        LANES for (size_t i = 0; i < n; i++) {
            p2[i] = p2[i] * rho[i] + p1[i];
            p1[i] = p1[i] * rho[i] + p[i];
            p[i] = p[i] * rho[i] + coefficient;
        }
    }
}

static void asphere_at(const void *self, size_t n, const double *x, const double *y, sag_values out)
{
    const sgt_even_asphere *s = self;
    double p1[DEPARTURE_BLOCK], p2[DEPARTURE_BLOCK];
    terms_horner(terms_count(s), s->a, n, x, y, out.p, p1, p2);
    for (size_t i = 0; i < n; i++) out.px[i] = 2 * p1[i] * x[i], out.py[i] = 2 * p1[i] * y[i];
}

static void terms_rounding(const void *self, double x, double y, double *p_err, double *grad_err)
{
    const sgt_even_asphere *s = self;
    double rho = x * x + y * y, second, first = magnitude(terms_count(s), s->a, rho, &second);
    *p_err = 5 * SGT_U * rho * first;
    /* p' has two more roundings for each term, and rho has two. */
    *grad_err = 2 * SGT_U * larger(fabs(x), fabs(y)) * (20 * first + 3 * rho * second);
}

static void asphere_noise(const void *self, double radius, double e[2])
{
    const sgt_even_asphere *s = self;
    double second;
    e[0] = 0, e[1] = 5 * SGT_U * magnitude(terms_count(s), s->a, radius * radius * (1 + 0x1p-40), &second);
}

static int asphere_bounds(const void *self, region *where, bounds *out)
{
    const sgt_even_asphere *s = self;
    double rho = where->r_hi * where->r_hi, second, first = magnitude(terms_count(s), s->a, rho, &second),
           up = 1 + 0x1p-40;
    *out = (bounds){rho * first * up, 2 * where->r_hi * first * up, (2 * first + 4 * second * rho) * up};
    return 1;
}

/* Over a ring, by Horner's rule. */
SGT_NARROW(sgt_interval, sgt_asphere_range, (const void *self, const region *where))
{
    const sgt_even_asphere *s = self;
    sgt_interval rho = sgt_interval_square(sgt_interval_between(where->r_lo, where->r_hi)), p = {0, 0};
    for (int i = terms_count(s) - 1; i >= 0; i--)
        p = sgt_interval_product(sgt_interval_sum(p, sgt_interval_of(s->a[i])), rho);
    return p;
}

static void asphere_second(const void *self, size_t n, const double *x, const double *y, double *pxx,
                           double *pxy, double *pyy)
{
    const sgt_even_asphere *s = self;
    double p[DEPARTURE_BLOCK], p1[DEPARTURE_BLOCK], p2[DEPARTURE_BLOCK];
    terms_horner(terms_count(s), s->a, n, x, y, p, p1, p2);
    for (size_t i = 0; i < n; i++) {
        double bent = 8 * p2[i]; /* p2 is half of p'' */
        pxx[i] = 2 * p1[i] + bent * (x[i] * x[i]), pxy[i] = bent * (x[i] * y[i]),
        pyy[i] = 2 * p1[i] + bent * (y[i] * y[i]);
    }
}

static size_t asphere_parameters(const void *self) { (void)self; return 8; }

static void asphere_by_parameter(const void *self, size_t j, size_t n, const double *x, const double *y,
                                 sag_values out)
{
    (void)self;
    for (size_t i = 0; i < n; i++) {
        double rho = x[i] * x[i] + y[i] * y[i], power = 1; /* rho^j */
        for (size_t m = 0; m < j; m++) power *= rho;
        double slope = 2 * (double)(j + 1) * power;
        out.p[i] = power * rho, out.px[i] = slope * x[i], out.py[i] = slope * y[i];
    }
}

static sgt_objection asphere_object(const void *self)
{
    const sgt_even_asphere *s = self;
    if (!numbers_finite(8, s->a)) return (sgt_objection){"coefficients", "must be finite"};
    return (sgt_objection){NULL, NULL};
}

static bool asphere_along(const void *self, sgt_course *out)
{
    *out = (sgt_course){2 * (size_t)terms_count(self), true, 0};
    return true;
}

const departure sgt_asphere_departure = {
    .at = asphere_at, .rounding = terms_rounding, .bounds = asphere_bounds, .range = sgt_asphere_range,
    .second = asphere_second, .parameters = asphere_parameters, .by_parameter = asphere_by_parameter,
    .object = asphere_object, .noise = asphere_noise, .along = asphere_along};
