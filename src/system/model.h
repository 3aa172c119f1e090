// SPDX-License-Identifier: MIT
/* model.h - numbers that depend on MODEL_N parameters, to the second order but for a bound: Taylor models.
 *
 * A model is the set of functions x of s in [-1, 1]^N with
 *
 *     |x(s) - (c + a . s + sum over i <= j of q_ij s_i s_j)| <= e   wherever x is defined.
 *
 * An operation returns a model that contains what it does to members of its arguments (Makino and Berz 2003,
 * Int. J. Pure Appl. Math. 4, 379; with e in place of their intervals).  form.h is the same of the first
 * order in two parameters, which costs a fifth.
 *
 * WHAT IS LEFT OUT.  With L and Q the sums of the magnitudes of a and of q, in a product it is
 *
 *     L Q' + Q L' + Q Q' + e (|c'| + L' + Q' + e') + e' (|c| + L + Q):
 *
 * third order, as L is of first order and Q of second.  A function f is f(c) + f' d + f'' d^2 / 2 and at most
 * |f'''| |d|^3 / 6 more, d = x - c, the greatest |f'''| over the range.
 *
 * ROUNDING.  A coefficient is rounded up to eight times.  What that loses is at most ROUND of the magnitudes
 * that were added up.  e is a sum of up to a hundred terms, none below 0, and is made larger by MORE; and by
 * a number that no underflow reaches.  A NaN or an infinity in a model says that nothing is known.  So tests
 * are written to be false for them.
 *
 * This file is compiled for several N; all in it is static.  q_ij is at j (j + 1) / 2 + i.  With MODEL_SERIES
 * models are of two parameters and of higher order (below). */
#if defined(MODEL_2) || defined(MODEL_SERIES)
#define MODEL_N 2
#elif defined(MODEL_4)
#define MODEL_N 4
#else
#define MODEL_N 8
#endif
#ifndef SGT_SYSTEM_MODEL_H
#define SGT_SYSTEM_MODEL_H
#include "trace.h"

#include <sagitta/beam.h>

#define MODEL_USED __attribute__((unused))

#ifdef MODEL_SERIES
/* ------------------------------------------------------------------------ series
 *
 * Numbers that depend on two parameters, to the order SERIES_ORDER but for a bound: models for the pupil,
 * where rests have to be small.
 *
 * A model is the set of functions x of s and t in [-1, 1] with
 *
 *     |x(s, t) - sum over i + j <= SERIES_ORDER of k_ij s^i t^j| <= e.
 *
 * WHY SO MANY.  Rests know nothing of each other: they are bent, carried on and added as if each was of
 * another ray.  So they grow from surface to surface, and not the terms of the polynomials, which cancel as
 * the aberrations of the surfaces do.  Of second order, a box a tenth of a pupil wide left out 1e-3 of a
 * coordinate at each surface.  Each order more leaves out a tenth of that.
 *
 * WHAT IS LEFT OUT.  With n_d the sum of the magnitudes of order d, a product leaves out
 *
 *     sum over d + d' > SERIES_ORDER of n_d n'_d'  +  e (|x'| + e') + e' |x|.
 *
 * Quotient and root are found order by order, and nothing is claimed of them.  Then they are put to the test:
 *
 *     x / y - q = (x - q y) / y,     sqrt(x) - r = (x - r^2) / (sqrt(x) + r),
 *
 * and the residuals are worked out by products, with all that these leave out, rounding too.
 *
 * ROUNDING.  A coefficient is a sum of (SERIES_ORDER / 2 + 1)^2 products at most, some of them twice: below
 * MODEL_ROUND of the magnitudes.  MODEL_MORE covers the sums of up to a hundred magnitudes in e. */

#define SERIES_ORDER SGT_SERIES_ORDER
#define SERIES_TERMS SGT_SERIES_TERMS
#define MODEL_ROUND (64 * SGT_U)
#define MODEL_MORE (1 + 0x1p-44)
#define MODEL_LEAST 0x1p-900

/* k_ij is at (d, j), d = i + j: SERIES_AT(d) + j. */
#define SERIES_AT(d) ((d) * ((d) + 1) / 2)

typedef struct model {
    union {
        double k[SERIES_TERMS], c;
    };
    double e;
} model;

static inline model model_number(double c)
{
    model x = {{{0}}, 0};
    x.k[0] = c;
    return x;
}

static inline double model_size(const model *x)
{
    double sum = 0;
    for (int i = 0; i < SERIES_TERMS; i++) sum += fabs(x->k[i]);
    return sum;
}

/* |x - c| at most. */
static inline double model_away(const model *x)
{
    double sum = x->e;
    for (int i = 1; i < SERIES_TERMS; i++) sum += fabs(x->k[i]);
    return sum * MODEL_MORE;
}

/* The same with e made sound: `size` is the sum of the magnitudes that were rounded. */
static inline model model_made(model x, double size)
{
    x.e = x.e * MODEL_MORE + MODEL_ROUND * size + MODEL_LEAST;
    return x;
}

static inline model model_wider(model x, double by)
{
    x.e = (x.e + by) * MODEL_MORE;
    return x;
}

/* a s + b s^2 is at its ends, or between them where its slope is 0.  Even powers are from 0 to 1. */
SGT_HOT static sgt_interval model_range(model x)
{
    double lo = x.k[0], hi = x.k[0], size = model_size(&x), rest = x.e;
    for (int p = 0; p < 2; p++) {
        const double a = fabs(x.k[1 + p]), bend = x.k[3 + 2 * p];
        const double top = a < 2 * fabs(bend) ? -a * a / (4 * bend) : 0;
        hi += bend < 0 && a < -2 * bend ? top : bend + a;
        lo += bend > 0 && a < 2 * bend ? top : bend - a;
    }
    rest += fabs(x.k[4]);
    for (int d = 3; d <= SERIES_ORDER; d++)
        for (int j = 0; j <= d; j++) {
            const double k = x.k[SERIES_AT(d) + j];
            if (d % 2 == 0 && j % 2 == 0)
                hi += k > 0 ? k : 0, lo += k < 0 ? k : 0;
            else
                rest += fabs(k);
        }
    rest = rest * MODEL_MORE + 2 * MODEL_ROUND * size + MODEL_LEAST;
    return (sgt_interval){lo - rest, hi + rest};
}

static inline model model_negative(model x)
{
    for (int i = 0; i < SERIES_TERMS; i++) x.k[i] = -x.k[i];
    return x;
}

SGT_HOT static model model_sum(model x, model y)
{
    x.e += y.e;
    for (int i = 0; i < SERIES_TERMS; i++) x.k[i] += y.k[i];
    return model_made(x, model_size(&x));
}

SGT_HOT static model model_difference(model x, model y)
{
    x.e += y.e;
    for (int i = 0; i < SERIES_TERMS; i++) x.k[i] -= y.k[i];
    return model_made(x, model_size(&x));
}

static inline model model_plus(model x, double k)
{
    x.k[0] += k;
    return model_made(x, fabs(x.k[0]));
}

/* Times a number known exactly. */
SGT_HOT static model model_scaled(model x, double k)
{
    x.e *= fabs(k);
    for (int i = 0; i < SERIES_TERMS; i++) x.k[i] *= k;
    return model_made(x, model_size(&x));
}

/* The part of order d of x, times all of y that is of order `most` at most. */
static inline void series_add(double p[SERIES_TERMS], const double x[], int d, const double y[], int first,
                              int most)
{
    for (int i = 0; i <= d; i++) {
        const double by = x[SERIES_AT(d) + i];
        if (by == 0) continue;
        for (int g = first; g <= most; g++) {
            double *row = p + SERIES_AT(d + g) + i;
            const double *other = y + SERIES_AT(g);
            for (int j = 0; j <= g; j++) row[j] += by * other[j];
        }
    }
}

static inline void series_norms(const model *x, double norm[SERIES_ORDER + 1])
{
    _Pragma("GCC unroll 8") for (int d = 0; d <= SERIES_ORDER; d++)
    {
        norm[d] = 0;
        _Pragma("GCC unroll 8") for (int j = 0; j <= d; j++) norm[d] += fabs(x->k[SERIES_AT(d) + j]);
    }
}

/* (Unrolled: 210 products.  In loops over rows of memory it takes half as long again; and with rows in
 * vectors, shifted, two and a half times, as loads wait for stores.) */
SGT_HOT static model model_product(model x, model y)
{
    double n[SERIES_ORDER + 1], m[SERIES_ORDER + 1], size = 0, other = 0, above = 0, left = 0;
    model p;
    _Pragma("GCC unroll 8") for (int J = 0; J <= SERIES_ORDER; J++)
        _Pragma("GCC unroll 8") for (int I = 0; I <= SERIES_ORDER - J; I++)
        {
            double sum = 0;
            _Pragma("GCC unroll 8") for (int j = 0; j <= J; j++)
                _Pragma("GCC unroll 8") for (int i = 0; i <= I; i++)
                    sum += x.k[SERIES_AT(i + j) + j] * y.k[SERIES_AT(I - i + J - j) + J - j];
            p.k[SERIES_AT(I + J) + J] = sum;
        }
    series_norms(&x, n), series_norms(&y, m);
    for (int d = 0; d <= SERIES_ORDER; d++) size += n[d], other += m[d];
    for (int d = 1; d <= SERIES_ORDER; d++) above += m[SERIES_ORDER + 1 - d], left += n[d] * above;
    p.e = left + x.e * (other + y.e) + y.e * size;
    return model_made(p, size * other);
}

SGT_HOT static model model_unknown(void)
{
    model x = model_number(0);
    x.e = HUGE_VAL;
    return x;
}

static inline double series_least(sgt_interval x) { return x.lo > 0 ? x.lo : x.hi < 0 ? -x.hi : 0; }

/* Nothing is known if 0 may be in y. */
SGT_HOT static model model_quotient(model x, model y)
{
    const double least = series_least(model_range(y)), by = 1 / y.k[0];
    model q = model_number(0);
    double taken[SERIES_TERMS] = {0};
    if (!(least > 0)) return model_unknown();
    for (int d = 0; d <= SERIES_ORDER; d++) {
        for (int j = 0; j <= d; j++)
            q.k[SERIES_AT(d) + j] = (x.k[SERIES_AT(d) + j] - taken[SERIES_AT(d) + j]) * by;
        series_add(taken, q.k, d, y.k, 1, SERIES_ORDER - d);
    }
    const model left = model_difference(x, model_product(q, y));
    q.e = (fabs(left.k[0]) + model_away(&left)) / least * MODEL_MORE + MODEL_LEAST;
    return q.e < HUGE_VAL ? q : model_unknown();
}

SGT_HOT static model model_inverse(model x) { return model_quotient(model_number(1), x); }

/* Nothing is known if x may be 0 or less. */
SGT_HOT static model model_root(model x)
{
    const sgt_interval range = model_range(x);
    model r = model_number(0);
    double square[SERIES_TERMS] = {0};
    if (!(range.lo > 0)) return model_unknown();
    r.k[0] = sqrt(x.k[0]);
    for (int d = 1; d <= SERIES_ORDER; d++) {
        /* `square` has the products of orders 1 to d - 1 that make up order d */
        for (int j = 0; j <= d; j++)
            r.k[SERIES_AT(d) + j] = (x.k[SERIES_AT(d) + j] - square[SERIES_AT(d) + j]) * (0.5 / r.k[0]);
        for (int g = 1; g <= d && g + d <= SERIES_ORDER; g++) {
            double two[SERIES_TERMS] = {0};
            series_add(two, r.k, d, r.k, g, g);
            for (int j = 0; j <= d + g; j++)
                square[SERIES_AT(d + g) + j] += (g < d ? 2 : 1) * two[SERIES_AT(d + g) + j];
        }
    }
    const model left = model_difference(x, model_product(r, r));
    const double down = sqrt(range.lo) * (1 - 0x1p-40) + model_range(r).lo;
    if (!(down > 0)) return model_unknown();
    r.e = (fabs(left.k[0]) + model_away(&left)) / down * MODEL_MORE + MODEL_LEAST;
    return r.e < HUGE_VAL ? r : model_unknown();
}

SGT_HOT static model MODEL_USED model_between(sgt_interval range)
{
    model x = model_number(sgt_interval_middle(range));
    x.e = larger(range.hi - x.c, x.c - range.lo);
    return model_made(x, fabs(x.c) + x.e);
}

/* The cosine (a quarter of a turn on) and the sine, by the terms of Taylor's series about the middle.  No
 * derivative is above 1. */
SGT_HOT static model MODEL_USED model_turned(model x, bool cosine)
{
    const sgt_interval at = sgt_interval_of(x.c), s = sgt_interval_sine(at), c = sgt_interval_cosine(at);
    const double sm = sgt_interval_middle(s), cm = sgt_interval_middle(c), d = model_away(&x);
    const double turn[4] = {cosine ? cm : sm, cosine ? -sm : cm, cosine ? -cm : -sm, cosine ? sm : -cm};
    double by[SERIES_ORDER + 1], rest = 1, all = 0;
    if (!(d < 1)) { /* of little use: of the first order only */
        const double most = d < HUGE_VAL ? d : HUGE_VAL;
        return model_wider(model_number(turn[0]), most + 0x1p-50);
    }
    for (int k = 0; k <= SERIES_ORDER; k++) {
        by[k] = (k == 0 ? 1 : by[k - 1] / k), all += rest, rest = rest * d / (k + 1);
    }
    model v = x, sum = model_number(turn[SERIES_ORDER % 4] * by[SERIES_ORDER]);
    v.k[0] = 0;
    for (int k = SERIES_ORDER; k-- > 0;)
        sum = model_plus(model_product(sum, v), turn[k % 4] * by[k]);
    return model_wider(sum, rest * MODEL_MORE + 0x1p-49 * (1 + all));
}

/* How much x changes with parameter i. */
SGT_HOT static double MODEL_USED model_changes(const model *x, int i)
{
    double sum = 0;
    for (int d = 1; d <= SERIES_ORDER; d++)
        for (int j = i == 1; j <= d - (i == 0); j++) sum += fabs(x->k[SERIES_AT(d) + j]);
    return sum;
}

#else

#define MODEL_Q (MODEL_N * (MODEL_N + 1) / 2)
typedef struct model {
    double c, a[MODEL_N], q[MODEL_Q], e;
} model;

#define MODEL_ROUND (16 * SGT_U)
#define MODEL_MORE (1 + 0x1p-44)
#define MODEL_LEAST 0x1p-900

static inline model model_number(double c)
{
    model x = {.c = c};
    return x;
}

static inline double model_linear(const model *x)
{
    double sum = 0;
    for (int i = 0; i < MODEL_N; i++) sum += fabs(x->a[i]);
    return sum;
}

static inline double model_bent(const model *x)
{
    double sum = 0;
    for (int i = 0; i < MODEL_Q; i++) sum += fabs(x->q[i]);
    return sum;
}

/* The greatest |x|, and |x - c|, at most. */
static inline double model_away(const model *x)
{
    return (model_linear(x) + model_bent(x) + x->e) * MODEL_MORE;
}
static inline double model_size(const model *x) { return fabs(x->c) + model_linear(x) + model_bent(x); }

/* The same with e made sound: `size` is the sum of the magnitudes that were rounded. */
static inline model model_made(model x, double size)
{
    x.e = x.e * MODEL_MORE + MODEL_ROUND * size + MODEL_LEAST;
    return x;
}

static inline model model_wider(model x, double by)
{
    x.e = (x.e + by) * MODEL_MORE;
    return x;
}

SGT_HOT static model MODEL_USED model_between(sgt_interval range)
{
    model x = model_number(sgt_interval_middle(range));
    x.e = larger(range.hi - x.c, x.c - range.lo);
    return model_made(x, fabs(x.c) + x.e);
}

/* a s + b s^2 is at its ends, or between them where its slope is 0. */
SGT_HOT static sgt_interval model_range(model x)
{
    double lo = x.c, hi = x.c, size = fabs(x.c), rest = x.e;
    for (int j = 0; j < MODEL_N; j++) {
        const double a = fabs(x.a[j]), *row = x.q + j * (j + 1) / 2, b = row[j];
        const double top = a < 2 * fabs(b) ? -a * a / (4 * b) : 0;
        hi += b < 0 && a < -2 * b ? top : b + a;
        lo += b > 0 && a < 2 * b ? top : b - a;
        for (int i = 0; i < j; i++) rest += fabs(row[i]);
        size += a + fabs(b);
    }
    rest = rest * MODEL_MORE + 2 * MODEL_ROUND * size + MODEL_LEAST;
    return (sgt_interval){lo - rest, hi + rest};
}

static inline model model_negative(model x)
{
    x.c = -x.c;
    for (int i = 0; i < MODEL_N; i++) x.a[i] = -x.a[i];
    for (int i = 0; i < MODEL_Q; i++) x.q[i] = -x.q[i];
    return x;
}

SGT_HOT static model model_sum(model x, model y)
{
    x.c += y.c, x.e += y.e;
    for (int i = 0; i < MODEL_N; i++) x.a[i] += y.a[i];
    for (int i = 0; i < MODEL_Q; i++) x.q[i] += y.q[i];
    return model_made(x, model_size(&x));
}

SGT_HOT static model model_difference(model x, model y)
{
    x.c -= y.c, x.e += y.e;
    for (int i = 0; i < MODEL_N; i++) x.a[i] -= y.a[i];
    for (int i = 0; i < MODEL_Q; i++) x.q[i] -= y.q[i];
    return model_made(x, model_size(&x));
}

static inline model model_plus(model x, double k)
{
    x.c += k;
    return model_made(x, fabs(x.c));
}

/* Times a number known exactly. */
SGT_HOT static model model_scaled(model x, double k)
{
    x.c *= k, x.e *= fabs(k);
    for (int i = 0; i < MODEL_N; i++) x.a[i] *= k;
    for (int i = 0; i < MODEL_Q; i++) x.q[i] *= k;
    return model_made(x, model_size(&x));
}

SGT_HOT static model model_product(model x, model y)
{
    model p;
    const double l = model_linear(&x), m = model_linear(&y), q = model_bent(&x), r = model_bent(&y);
    const double size = fabs(x.c) + l + q, other = fabs(y.c) + m + r;
    p.c = x.c * y.c;
    for (int i = 0; i < MODEL_N; i++) p.a[i] = x.c * y.a[i] + y.c * x.a[i];
    for (int i = 0; i < MODEL_Q; i++) p.q[i] = x.c * y.q[i] + y.c * x.q[i];
    for (int j = 0; j < MODEL_N; j++) {
        double *row = p.q + j * (j + 1) / 2;
        for (int i = 0; i < j; i++) row[i] += x.a[i] * y.a[j] + x.a[j] * y.a[i];
        row[j] += x.a[j] * y.a[j];
    }
    p.e = l * r + q * m + q * r + x.e * (other + y.e) + y.e * size;
    return model_made(p, size * other);
}

/* f0 + f1 d + f2 d^2, d = x - c, and `rest` more.  f0, f1, f2 are off by 8 u of themselves at most. */
SGT_HOT static model model_made_of(model x, double f0, double f1, double f2, double rest)
{
    model d = x;
    d.c = 0;
    const double l = model_linear(&d), q = model_bent(&d), away = l + q + d.e, a1 = fabs(f1), a2 = fabs(f2);
    model y = {.c = f0};
    for (int i = 0; i < MODEL_N; i++) y.a[i] = f1 * d.a[i];
    for (int i = 0; i < MODEL_Q; i++) y.q[i] = f1 * d.q[i];
    for (int j = 0; j < MODEL_N; j++) {
        double *row = y.q + j * (j + 1) / 2;
        for (int i = 0; i < j; i++) row[i] += 2 * f2 * d.a[i] * d.a[j];
        row[j] += f2 * d.a[j] * d.a[j];
    }
    y.e = a1 * d.e + a2 * (2 * l * q + q * q + d.e * (2 * (l + q) + d.e)) + rest;
    return model_made(y, fabs(f0) + a1 * away + a2 * away * away);
}

SGT_HOT static model model_unknown(void)
{
    model x = model_number(0);
    x.e = HUGE_VAL;
    return x;
}

/* 1 / x = 1/c - d / c^2 + d^2 / c^3 - d^3 / (c^3 x).  Nothing is known if 0 may be in x. */
SGT_HOT static model model_inverse(model x)
{
    const sgt_interval range = model_range(x);
    const double least = range.lo > 0 ? range.lo : -range.hi, i = 1 / x.c, d = model_away(&x),
                 di = d * fabs(i);
    if (!(least > 0) || !(d < HUGE_VAL)) return model_unknown();
    return model_made_of(x, i, -i * i, i * i * i, di * di * di / least * MODEL_MORE);
}

/* The third derivative of the root is 3 / 8 x^(-5/2).  Nothing is known if x may be 0 or less. */
SGT_HOT static model model_root(model x)
{
    const sgt_interval range = model_range(x);
    const double d = model_away(&x);
    if (!(range.lo > 0) || !(d < HUGE_VAL)) return model_unknown();
    const double s = sqrt(x.c), i = 0.5 / s, least = sqrt(range.lo);
    const double rest = d * d * d / (16 * least * range.lo * range.lo);
    return model_made_of(x, s, i, -0.25 * i / x.c, rest * MODEL_MORE);
}

static inline model model_quotient(model x, model y) { return model_product(x, model_inverse(y)); }

/* The cosine (a quarter of a turn on) and the sine: no derivative is above 1. */
SGT_HOT static model MODEL_USED model_turned(model x, bool cosine)
{
    const sgt_interval at = sgt_interval_of(x.c), s = sgt_interval_sine(at), c = sgt_interval_cosine(at);
    const double d = model_away(&x), sm = sgt_interval_middle(s), cm = sgt_interval_middle(c);
    const double rest = d * d * d / 6 * MODEL_MORE + 0x1p-50 * (1 + d + d * d);
    if (!(d < HUGE_VAL)) return model_unknown();
    return cosine ? model_made_of(x, cm, -sm, -0.5 * cm, rest) : model_made_of(x, sm, cm, -0.5 * sm, rest);
}

/* How much x changes with parameter i. */
SGT_HOT static double MODEL_USED model_changes(const model *x, int i)
{
    double sum = fabs(x->a[i]);
    for (int j = 0; j < MODEL_N; j++) sum += fabs(x->q[SGT_MODEL_PAIR(i, j)]);
    return sum;
}

#endif

static inline bool model_below(model x, double limit) { return model_range(x).hi < limit; }
static inline bool model_above(model x, double limit) { return model_range(x).lo > limit; }
static inline model model_square(model x) { return model_product(x, x); }

typedef struct model3 {
    model x, y, z;
} model3;

SGT_HOT static model MODEL_USED model_dot(const model3 *a, const model3 *b)
{
    return model_sum(model_product(a->x, b->x),
                     model_sum(model_product(a->y, b->y), model_product(a->z, b->z)));
}

/* a . x of three numbers known exactly. */
SGT_HOT static model MODEL_USED model_along(const model3 *a, sgt_vec3 x)
{
    return model_sum(model_scaled(a->x, x.x), model_sum(model_scaled(a->y, x.y), model_scaled(a->z, x.z)));
}

#ifdef MODEL_SERIES
/* From and to the public structs. */
SGT_HOT static model MODEL_USED model_read(const sgt_model *x)
{
    model y = model_number(x->c);
    y.e = x->rest, y.k[1] = x->by[0], y.k[2] = x->by[1];
    y.k[3] = x->pair[SGT_MODEL_PAIR(0, 0)], y.k[4] = x->pair[SGT_MODEL_PAIR(0, 1)];
    y.k[5] = x->pair[SGT_MODEL_PAIR(1, 1)];
    return y;
}

static model MODEL_USED series_read(const sgt_series *x)
{
    model y = model_number(0);
    memcpy(y.k, x->k, sizeof y.k);
    y.e = x->rest;
    return y;
}

static void MODEL_USED series_write(model x, sgt_series *out)
{
    *out = (sgt_series){.rest = x.e < HUGE_VAL ? x.e : HUGE_VAL};
    memcpy(out->k, x.k, sizeof x.k);
}
#else
/* From and to the public struct. */
SGT_HOT static model model_read(const sgt_model *x)
{
    model y;
    y.c = x->c, y.e = x->rest;
    for (int i = 0; i < MODEL_N; i++) y.a[i] = x->by[i];
    for (int i = 0; i < MODEL_Q; i++) y.q[i] = x->pair[i];
    return y;
}

SGT_HOT static void MODEL_USED model_write(model x, sgt_model *out)
{
    *out = (sgt_model){.c = x.c, .rest = x.e};
    for (int i = 0; i < MODEL_N; i++) out->by[i] = x.a[i];
    for (int i = 0; i < MODEL_Q; i++) out->pair[i] = x.q[i];
    if (!(x.e < HUGE_VAL)) out->rest = HUGE_VAL;
}

#endif

#endif
