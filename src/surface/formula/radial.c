// SPDX-License-Identifier: MIT
/* radial.c - a sag that depends on s = x^2 + y^2 alone, and its derivative by s.
 *
 * Such a tape (tape.h) has one variable.  Each register is a row of numbers and a row of their derivatives by
 * s, and each operation one loop over both.  dF/dx = 2 x dF/ds, and dF/dy likewise.  That is a fraction of
 * the work of two derivatives: aspheres cost half as much.
 *
 * Powers of 3 to 8 are products, as few as there can be.  What has no loop of its own goes by local.c. */
#include "formula.h"

#include "local.h"

enum { NUMBERS = 1536 }; /* 12 KiB */

typedef struct radial_run {
    const sgt_tape *tape;
    size_t n, lanes;
    double number[NUMBERS];
} radial_run;

typedef struct dual { double *v, *d; } dual;

static dual dual_of(radial_run *w, int reg)
{
    double *row = w->number + (size_t)reg * 2 * w->lanes;
    return (dual){row, row + w->lanes};
}

typedef void radial_kernel(size_t n, const double *restrict a, const double *restrict da,
                           const double *restrict b, const double *restrict db, double u, double *restrict v,
                           double *restrict d);

/* x, p: the first operand and its derivative; y, q: the second; u: the uniform one; r: V. */
#define RADIAL(NAME, V, D)                                                                        \
    SGT_KERNEL                                                                                    \
    static void NAME(size_t n, const double *restrict a, const double *restrict da,               \
                     const double *restrict b, const double *restrict db, double u,               \
                     double *restrict v, double *restrict d)                                      \
    {                                                                                             \
        (void)b, (void)db, (void)u;                                                               \
        LANES for (size_t i = 0; i < n; i++)                                                      \
        {                                                                                         \
            double x = a[i], p = da[i], r = V;                                                    \
            v[i] = r, d[i] = D;                                                                   \
        }                                                                                         \
    }
#define RADIAL_2(NAME, V, D)                                                                      \
    SGT_KERNEL                                                                                    \
    static void NAME(size_t n, const double *restrict a, const double *restrict da,               \
                     const double *restrict b, const double *restrict db, double u,               \
                     double *restrict v, double *restrict d)                                      \
    {                                                                                             \
        (void)u;                                                                                  \
        LANES for (size_t i = 0; i < n; i++)                                                      \
        {                                                                                         \
            double x = a[i], p = da[i], y = b[i], q = db[i], r = V;                               \
            v[i] = r, d[i] = D;                                                                   \
        }                                                                                         \
    }

/* A quotient by 0 is NaN (local.h). */
SGT_INLINE double by(double x, double y) { return chosen(MASK(y != 0), x / y, (double)NAN); }

RADIAL_2(radial_add, x + y, p + q)
RADIAL_2(radial_sub, x - y, p - q)
RADIAL_2(radial_mul, x *y, x *q + y * p)
RADIAL_2(radial_div, by(x, y), by(p - r * q, y))
RADIAL(radial_add_to, x + u, p)
RADIAL(radial_sub_from, u - x, -p)
RADIAL(radial_mul_by, u *x, u *p)
RADIAL(radial_div_by, by(x, u), by(p, u))
RADIAL(radial_over, by(u, x), -(by(r, x) * p))
RADIAL(radial_neg, -x, -p)
RADIAL(radial_square, x *x, 2 * x * p)
RADIAL(radial_sqrt, sqrt(x), by(0.5, r) * p)
RADIAL(radial_3, x *x *x, 3 * (x * x) * p)
RADIAL(radial_4, (x * x) * (x * x), 4 * (x * x * x) * p)
RADIAL(radial_5, (x * x) * (x * x) * x, 5 * ((x * x) * (x * x)) * p)
RADIAL(radial_6, (x * x * x) * (x * x * x), 6 * ((x * x) * (x * x) * x) * p)
RADIAL(radial_7, (x * x * x) * (x * x * x) * x, 7 * ((x * x * x) * (x * x * x)) * p)
RADIAL(radial_8, ((x * x) * (x * x)) * ((x * x) * (x * x)), 8 * ((x * x * x) * (x * x * x) * x) * p)

static radial_kernel *power_kernel(int n)
{
    static radial_kernel *const of[] = {radial_3, radial_4, radial_5, radial_6, radial_7, radial_8};
    return n >= 3 && n <= 8 ? of[n - 3] : NULL;
}

/* NULL: by local.c.  u_a, u_b: is that operand uniform? */
static radial_kernel *kernel_of(const formula_step *s, bool u_a, bool u_b)
{
    switch (s->op) {
    case FORMULA_ADD: return u_a || u_b ? radial_add_to : radial_add;
    case FORMULA_SUB: return u_a ? radial_sub_from : u_b ? radial_add_to : radial_sub;
    case FORMULA_MUL: return u_a || u_b ? radial_mul_by : radial_mul;
    case FORMULA_DIV: return u_a ? radial_over : u_b ? radial_div_by : radial_div;
    case FORMULA_NEG: return radial_neg;
    case FORMULA_SQUARE: return radial_square;
    case FORMULA_SQRT: return radial_sqrt;
    case FORMULA_POWER: return power_kernel(s->n);
    default: return NULL;
    }
}

static void radial_by_rule(radial_run *w, const formula_step *s, dual a, dual b, double u, dual out)
{
    formula_row va, vb, uniform;
    for (size_t i = 0; i < w->n; i++) uniform[i] = u;
    sgt_formula_local((formula_op)s->op, s->n, w->n, a.v ? a.v : uniform, b.v ? b.v : uniform, true,
                      (formula_local){.v = out.v, .va = va, .vb = vb});
    if (a.v && b.v) sgt_row_products(w->n, va, a.d, vb, b.d, out.d);
    else sgt_row_product(w->n, a.v ? va : vb, a.v ? a.d : b.d, out.d);
}

static void radial_step(radial_run *w, const formula_step *s)
{
    const dual none = {NULL, NULL};
    bool two = s->op <= FORMULA_REAL_POWER, u_a = s->a >= FORMULA_UNIFORM,
         u_b = two && s->b >= FORMULA_UNIFORM;
    double u = u_a || u_b ? w->tape->middle[(u_a ? s->a : s->b) - FORMULA_UNIFORM] : 0;
    dual a = u_a ? none : dual_of(w, s->a), b = !two || u_b ? none : dual_of(w, s->b);
    dual out = dual_of(w, s->out);
    radial_kernel *kernel = kernel_of(s, u_a, u_b);
    if (!kernel) radial_by_rule(w, s, a, b, u, out);
    else if (u_a) kernel(w->n, b.v, b.d, NULL, NULL, u, out.v, out.d);
    else kernel(w->n, a.v, a.d, b.v, b.d, s->op == FORMULA_SUB ? -u : u, out.v, out.d);
}

SGT_KERNEL
static void radial_begin(size_t n, const double *restrict x, const double *restrict y, double *restrict s,
                         double *restrict d)
{
    LANES for (size_t i = 0; i < n; i++) s[i] = x[i] * x[i] + y[i] * y[i], d[i] = 1;
}

SGT_KERNEL
static void radial_end(size_t n, const double *restrict x, const double *restrict by_s, double *restrict out)
{
    LANES for (size_t i = 0; i < n; i++) out[i] = 2 * x[i] * by_s[i];
}

void sgt_formula_radial(const sgt_tape *tape, size_t n, sgt_points p, sgt_values out)
{
    radial_run w; /* its numbers are not cleared */
    size_t most = NUMBERS / (2 * (size_t)tape->registers) / 8 * 8;
    w.tape = tape, w.lanes = most < FORMULA_BLOCK ? most : FORMULA_BLOCK;
    if (n < w.lanes) w.lanes = n;
    dual s = dual_of(&w, tape->step[2].out), last = dual_of(&w, tape->step[tape->steps - 1].out);
    for (size_t i = 0; i < n; i += w.n) {
        w.n = n - i < w.lanes ? n - i : w.lanes;
        radial_begin(w.n, p.p[0] + i, p.p[1] + i, s.v, s.d);
        for (int j = 3; j < tape->steps; j++) radial_step(&w, &tape->step[j]);
        for (size_t k = 0; k < w.n; k++) out.f[i + k] = last.v[k];
        for (int k = 0; k < 2 && out.grad[0]; k++) radial_end(w.n, p.p[k] + i, last.d, out.grad[k] + i);
    }
}
