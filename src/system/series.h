// SPDX-License-Identifier: MIT
/* series.h - numbers that depend on two parameters, to the order SERIES_ORDER but for a bound: the models of
 * model.h for the pupil, where rests have to be small.
 *
 * A model is the set of functions x of s and t in [-1, 1] with
 *
 *     |x(s, t) - sum over i + j <= SERIES_ORDER of k_ij s^i t^j| <= e.
 *
 * WHY SO MANY.  Rests know nothing of each other: they are bent, carried on and added as if each was of another
 * ray.  So they grow from surface to surface, and not the terms of the polynomials, which cancel as the
 * aberrations of the surfaces do.  Of second order, a box a tenth of a pupil wide left out 1e-3 of a
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
#ifndef SGT_SYSTEM_SERIES_H
#define SGT_SYSTEM_SERIES_H

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
static sgt_interval model_range(model x)
{
    double lo = x.k[0], hi = x.k[0], size = model_size(&x), rest = x.e;
    for (int p = 0; p < 2; p++) {
        const double a = fabs(x.k[1 + p]), b = x.k[3 + 2 * p];
        const double top = a < 2 * fabs(b) ? -a * a / (4 * b) : 0;
        hi += b < 0 && a < -2 * b ? top : b + a;
        lo += b > 0 && a < 2 * b ? top : b - a;
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

static model model_sum(model x, model y)
{
    x.e += y.e;
    for (int i = 0; i < SERIES_TERMS; i++) x.k[i] += y.k[i];
    return model_made(x, model_size(&x));
}

static model model_difference(model x, model y)
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
static model model_scaled(model x, double k)
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

/* (Unrolled: 210 products.  In loops over rows of memory it takes five times the instructions; and with rows in
 * vectors, shifted, half of these, but twice the time, as loads wait for stores.) */
static model model_product(model x, model y)
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

static model model_unknown(void)
{
    model x = model_number(0);
    x.e = HUGE_VAL;
    return x;
}

static inline double series_least(sgt_interval x) { return x.lo > 0 ? x.lo : x.hi < 0 ? -x.hi : 0; }

/* Nothing is known if 0 may be in y. */
static model model_quotient(model x, model y)
{
    const double least = series_least(model_range(y)), by = 1 / y.k[0];
    model q = model_number(0);
    double taken[SERIES_TERMS] = {0};
    if (!(least > 0)) return model_unknown();
    for (int d = 0; d <= SERIES_ORDER; d++) {
        for (int j = 0; j <= d; j++) q.k[SERIES_AT(d) + j] = (x.k[SERIES_AT(d) + j] - taken[SERIES_AT(d) + j]) * by;
        series_add(taken, q.k, d, y.k, 1, SERIES_ORDER - d);
    }
    const model left = model_difference(x, model_product(q, y));
    q.e = (fabs(left.k[0]) + model_away(&left)) / least * MODEL_MORE + MODEL_LEAST;
    return q.e < HUGE_VAL ? q : model_unknown();
}

static model model_inverse(model x) { return model_quotient(model_number(1), x); }

/* Nothing is known if x may be 0 or less. */
static model model_root(model x)
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

static model MODEL_USED model_between(sgt_interval range)
{
    model x = model_number(sgt_interval_middle(range));
    x.e = larger(range.hi - x.c, x.c - range.lo);
    return model_made(x, fabs(x.c) + x.e);
}

/* The cosine (a quarter of a turn on) and the sine, by the terms of Taylor's series about the middle.  No
 * derivative is above 1. */
static model MODEL_USED model_turned(model x, bool cosine)
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
static double MODEL_USED model_changes(const model *x, int i)
{
    double sum = 0;
    for (int d = 1; d <= SERIES_ORDER; d++)
        for (int j = i == 1; j <= d - (i == 0); j++) sum += fabs(x->k[SERIES_AT(d) + j]);
    return sum;
}

#endif
