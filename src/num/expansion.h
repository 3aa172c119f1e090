// SPDX-License-Identifier: MIT
/* expansion.h - numbers as unevaluated sums of PARTS doubles, each number with its own error bound.
 *
 * Sums and products of doubles are error-free as sums of doubles (exact.h).  The parts of a result are
 * distilled: error-free sums of neighbours are passed over the list until the large ones are at its end
 * (Ogita, Rump and Oishi 2005, SIAM J. Sci. Comput. 26, 1955, VecSum).  The PARTS greatest are kept, and
 * the magnitudes of the others are added to `err`.  So the rounding needs no analysis: the bound is
 * counted as it happens, and an operation whose result fits is exact.
 *
 * It is slow: a few hundred operations each.  It is used only where twice the precision leaves the last
 * bits of t unknown, as on a ray that starts on the surface: t is 1e-17, from numbers near 1. */
#ifndef SGT_NUM_EXPANSION_H
#define SGT_NUM_EXPANSION_H

#include "exact.h"

enum { PARTS = 5, PASSES = 6 };

typedef struct expansion { double part[PARTS], err; } expansion; /* greatest first */

static inline expansion expansion_of_list(int n, double *x, double err)
{
    expansion e = {.err = err};
    for (int pass = 0; pass < PASSES; pass++)
        for (int i = 1; i < n; i++) {
            twofold s = two_sum(x[i], x[i - 1]);
            x[i] = s.hi, x[i - 1] = s.lo;
        }
    for (int i = 0; i < n; i++) {
        if (i < PARTS) e.part[i] = x[n - 1 - i];
        else e.err += fabs(x[n - 1 - i]) * (1 + 0x1p-40);
    }
    return e;
}

static inline expansion expansion_of(double a) { return (expansion){.part = {a}}; }

static inline double expansion_size(const expansion *a)
{
    double size = a->err;
    for (int i = 0; i < PARTS; i++) size += fabs(a->part[i]);
    return size * (1 + 0x1p-40);
}

static inline expansion expansion_sum(expansion a, expansion b)
{
    double x[2 * PARTS];
    for (int i = 0; i < PARTS; i++) { /* the small ones first: fewer passes are needed */
        x[2 * i] = a.part[PARTS - 1 - i];
        x[2 * i + 1] = b.part[PARTS - 1 - i];
    }
    return expansion_of_list(2 * PARTS, x, (a.err + b.err) * (1 + 0x1p-40));
}

static inline expansion expansion_product(expansion a, expansion b)
{
    double x[PARTS * (PARTS + 1)],
        err = (a.err * expansion_size(&b) + b.err * expansion_size(&a)) * (1 + 0x1p-40);
    int n = 0;
    for (int sum = PARTS - 1; sum >= 0; sum--)
        for (int i = 0; i <= sum; i++) {
            twofold p = two_product(a.part[i], b.part[sum - i]);
            x[n++] = p.lo, x[n++] = p.hi;
        }
    for (int i = 0; i < PARTS; i++)
        for (int j = PARTS - i; j < PARTS; j++) err += fabs(a.part[i] * b.part[j]) * (1 + 0x1p-40);
    return expansion_of_list(n, x, err);
}

static inline expansion expansion_scaled(expansion a, double b)
{
    return expansion_product(a, expansion_of(b));
}

static inline expansion expansion_negative(expansion a)
{
    for (int i = 0; i < PARTS; i++) a.part[i] = -a.part[i];
    return a;
}

/* o + (t0 + t) d, exactly. */
static inline expansion expansion_along(double o, double d, double t0, double t)
{
    twofold p = two_product(t0, d), q = two_product(t, d);
    double parts[] = {q.lo, p.lo, q.hi, p.hi, o};
    return expansion_of_list(5, parts, 0);
}

/* The nearest double, or nearly; *err is set to a bound on what it leaves out. */
static inline double expansion_value(const expansion *a, double *err)
{
    double v = 0, rest = a->err;
    for (int i = PARTS - 1; i >= 0; i--) v += a->part[i];
    for (int i = 0; i < PARTS; i++) rest += SGT_U * fabs(a->part[i]) * (i ? 2 * PARTS : 1);
    *err = rest * (1 + 0x1p-40) + SGT_U * fabs(v);
    return v;
}

#endif
