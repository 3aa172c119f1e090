// SPDX-License-Identifier: MIT
/* beam_series.c - the walk of beam_walk.h for boxes of two parameters, by series; and series for the caller
 * (model.h). */
#define MODEL_SERIES
#include "beam_walk.h"

_Static_assert(SERIES_AT(SERIES_ORDER + 1) == (int)SGT_SERIES_TERMS, "the public series");

sgt_box_verdict sgt_box_walk_series(const beam_task *task, sgt_box_end *out) { return box_walk(task, out); }

sgt_series sgt_series_of(double x)
{
    sgt_series out = {.rest = 0};
    out.k[0] = x;
    return out;
}

sgt_series sgt_series_parameter(int i, sgt_interval range)
{
    const double middle = sgt_interval_middle(range), half = larger(range.hi - middle, middle - range.lo);
    if (!(i == 0 || i == 1) || !isfinite(range.lo) || !isfinite(range.hi))
        return (sgt_series){.rest = HUGE_VAL};
    sgt_series out = sgt_series_of(middle);
    out.k[1 + i] = half, out.rest = 2 * SGT_U * (fabs(middle) + half) + MODEL_LEAST;
    return out;
}

sgt_series sgt_series_between(sgt_interval range)
{
    sgt_series out;
    series_write(model_between(range), &out);
    return out;
}

void sgt_series_polar(sgt_interval radius, sgt_interval angle, sgt_series *x, sgt_series *y)
{
    const sgt_series r = sgt_series_parameter(0, radius), a = sgt_series_parameter(1, angle);
    const model of = series_read(&r), by = series_read(&a);
    series_write(model_product(of, model_turned(by, true)), x);
    series_write(model_product(of, model_turned(by, false)), y);
}

void sgt_series_sum(const sgt_series *x, const sgt_series *y, sgt_series *out)
{
    series_write(model_sum(series_read(x), series_read(y)), out);
}

void sgt_series_difference(const sgt_series *x, const sgt_series *y, sgt_series *out)
{
    series_write(model_difference(series_read(x), series_read(y)), out);
}

void sgt_series_product(const sgt_series *x, const sgt_series *y, sgt_series *out)
{
    series_write(model_product(series_read(x), series_read(y)), out);
}

void sgt_series_scaled(const sgt_series *x, double k, sgt_series *out)
{
    series_write(model_scaled(series_read(x), k), out);
}

void sgt_series_plus(const sgt_series *x, double k, sgt_series *out)
{
    series_write(model_plus(series_read(x), k), out);
}

void sgt_series_inverse(const sgt_series *x, sgt_series *out)
{
    series_write(model_inverse(series_read(x)), out);
}

void sgt_series_root(const sgt_series *x, sgt_series *out) { series_write(model_root(series_read(x)), out); }

/* A rest that is not finite, or anything that is a NaN. */
static bool series_is_known(const sgt_series *x)
{
    double sum = x->rest;
    for (int i = 0; i < SERIES_TERMS; i++) sum += fabs(x->k[i]);
    return sum - sum == 0;
}

sgt_interval sgt_series_range(const sgt_series *x)
{
    return series_is_known(x) ? model_range(series_read(x)) : sgt_interval_all();
}

/* The mean of s^n is 1 / (n + 1) for even n, and 0 for odd.  With the weight 1 + w s, |w| <= 1, the odd ones
 * have w / (n + 2). */
sgt_interval sgt_series_mean(const sgt_series *x, double w)
{
    double sum = 0, size = 0;
    if (!series_is_known(x) || !(fabs(w) <= 1)) return sgt_interval_all();
    for (int d = 0; d <= SERIES_ORDER; d++)
        for (int j = 0; j <= d; j += 2) {
            const int i = d - j;
            const double by = i % 2 == 0 ? 1.0 / (i + 1) : w / (i + 2);
            const double mean = x->k[SERIES_AT(d) + j] * by / (j + 1);
            sum += mean, size += fabs(mean);
        }
    return sgt_interval_about(sum, (x->rest + MODEL_ROUND * size) * MODEL_MORE + MODEL_LEAST);
}

sgt_interval sgt_series_at(const sgt_series *x, double s, double t)
{
    double sum = 0, size = 0;
    if (!series_is_known(x) || !(fabs(s) <= 1 && fabs(t) <= 1)) return sgt_interval_all();
    for (int d = SERIES_ORDER; d >= 0; d--) {
        for (int j = 0; j <= d; j++) {
            double term = x->k[SERIES_AT(d) + j];
            for (int i = 0; i < d - j; i++) term *= s;
            for (int i = 0; i < j; i++) term *= t;
            sum += term, size += fabs(term);
        }
    }
    return sgt_interval_about(sum, (x->rest + MODEL_ROUND * size) * MODEL_MORE + MODEL_LEAST);
}
