// SPDX-License-Identifier: MIT
/* model.h - numbers along a cell of a ray, as straight lines with a bound on the rest.
 *
 * A cell is t = m + h tau, tau from -1 to 1.  A model {c, s, e} stands for every function of tau that is
 * within e of c + s tau all over the cell: a Taylor model of first order (K. Makino and M. Berz, 1996).
 * Intervals forget that two numbers come from the same t; lines keep it, so what is left out falls with h^2.
 * What every operation rounds is added to e: U = 2^-53 of each result, counted, with some to spare for the
 * rounding of e itself.  2^-1000 is more than all that underflows.
 *
 * A jet is a model of a number and one of its derivative by t. */
#ifndef RENDER_MODEL_H
#define RENDER_MODEL_H
#include "vector.h"

static const double U = 0x1p-53;

typedef struct model { double c, s, e; } model;

static inline double size_of(model a) { return fabs(a.c) + fabs(a.s); }
static inline double lowest(model a) { return a.c - (fabs(a.s) + a.e) - 4 * U * (size_of(a) + a.e); }
static inline double highest(model a) { return a.c + (fabs(a.s) + a.e) + 4 * U * (size_of(a) + a.e); }

/* o + t d */
static inline model on_ray(double o, double d, double m, double h)
{
    return (model){o + m * d, h * d, 4 * U * (fabs(o) + fabs(m * d) + fabs(h * d)) + 0x1p-1000};
}

/* Two sums: U of each. */
static inline model plus(model a, model b)
{
    model x = {a.c + b.c, a.s + b.s, 0};
    x.e = (a.e + b.e) * (1 + 4 * U) + 2 * U * size_of(x);
    return x;
}

static inline model negative(model a) { return (model){-a.c, -a.s, a.e}; }
static inline model minus(model a, model b) { return plus(a, negative(b)); }

/* By a power of 2. */
static inline model scaled_model(model a, double by) { return (model){by * a.c, by * a.s, by * a.e}; }

/* s s' tau^2 is within s s' / 2 of s s' / 2.  c has two products and a sum, s the same, and s s' is
 * rounded: below 3 U of the product of the sizes. */
static inline model product(model a, model b)
{
    double bend = 0.5 * (a.s * b.s), A = size_of(a), B = size_of(b);
    return (model){a.c * b.c + bend, a.c * b.s + a.s * b.c,
                   (A * b.e + B * a.e + a.e * b.e + fabs(bend) + 4 * U * (A * B)) * (1 + 16 * U) + 0x1p-1000};
}

/* f(c + by) = f0 + f1 by + a rest from 0 to `rest`, for |by| <= |s| + e.  f0 and f1 are each within 3 U. */
static inline model bent(model a, double f0, double f1, double rest)
{
    double own = 0.5 * fabs(rest) + 8 * U * (fabs(f0) + fabs(f1) * size_of(a) + fabs(rest));
    return (model){f0 + 0.5 * rest, f1 * a.s, (fabs(f1) * a.e + own) * (1 + 16 * U) + 0x1p-1000};
}

/* lowest(a) > 0 in these two.  The second derivative is greatest at the low end. */
static inline model inverse_of(model a)
{
    double f0 = 1 / a.c, low = lowest(a), by = fabs(a.s) + a.e;
    return bent(a, f0, -f0 / a.c, by * by / (low * low * low) * (1 + 16 * U));
}

static inline model root_of(model a)
{
    double f0 = sqrt(a.c), low = lowest(a), by = fabs(a.s) + a.e;
    return bent(a, f0, 0.5 / f0, -by * by / (8 * low * sqrt(low)) * (1 + 16 * U));
}

/* --------------------------------------------------------------------- jets */

typedef struct jet { model f, d; } jet;

static inline jet jet_on_ray(double o, double d, double m, double h)
{
    return (jet){on_ray(o, d, m, h), {d, 0, 0}};
}

static inline jet jet_plus(jet a, jet b) { return (jet){plus(a.f, b.f), plus(a.d, b.d)}; }
static inline jet jet_minus(jet a, jet b) { return (jet){minus(a.f, b.f), minus(a.d, b.d)}; }
static inline jet jet_scaled(jet a, double by) { return (jet){scaled_model(a.f, by), scaled_model(a.d, by)}; }

/* Without `slope` the derivative is left at zero, and means nothing. */
static inline jet jet_product(jet a, jet b, bool slope)
{
    jet x = {.f = product(a.f, b.f)};
    if (slope) x.d = plus(product(a.f, b.d), product(a.d, b.f));
    return x;
}

static inline jet jet_square(jet a, bool slope)
{
    jet x = {.f = product(a.f, a.f)};
    if (slope) x.d = scaled_model(product(a.f, a.d), 2);
    return x;
}

/* lowest(a) > 0 in these two.  (1 / a)' = -a' / a^2. */
static inline jet jet_inverse(jet a, bool slope)
{
    jet x = {.f = inverse_of(a.f)};
    if (slope) x.d = negative(product(a.d, product(x.f, x.f)));
    return x;
}

/* w is the inverse of a: (sqrt a)' = a' sqrt(a) w / 2. */
static inline jet jet_root(jet a, jet w, bool slope)
{
    jet x = {.f = root_of(a.f)};
    if (slope) x.d = scaled_model(product(product(a.d, x.f), w.f), 0.5);
    return x;
}

#endif
