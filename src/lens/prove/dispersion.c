// SPDX-License-Identifier: MIT
/* dispersion.c - the index of a glass over a range of wavelengths, as a model of beam.h.
 *
 * The formulas are those of glass/glass.c (sagitta/lens.h lists them), with the operations of models in place
 * of those of numbers: each holds what it does to all wavelengths of the range.  A power w^e is Taylor's
 * series about the middle c of the range of w,
 *
 *     w^e = c^e + e c^(e-1) (w - c) + e (e - 1) / 2 c^(e-2) (w - c)^2 + R,
 *     |R| <= |e (e - 1) (e - 2)| / 6 max w^(e-3) |w - c|^3,
 *
 * where the largest power is that at one end of the range.
 *
 * ROUNDING.  sgt_glass_index is off by some ulps of the largest term.  GRAIN of the sizes of all terms is
 * added to the rest, some thousand of them.
 *
 * A TABLE of indices is joined by straight lines: that is no law of the glass, so nothing is said of what is
 * between. */
#include "dispersion.h"

#include <sagitta/interval.h>

#include <math.h>

static const double GRAIN = 0x1p-42;

typedef struct terms { const sgt_glass *g; sgt_model w, w2, sum; double size; } terms;

static double coefficient_of(const terms *t, size_t i) { return i < t->g->count ? t->g->coefficient[i] : 0; }

static sgt_model power_model(const sgt_model *w, double e)
{
    const sgt_interval range = sgt_model_range(w);
    const double c = w->c, far = fmax(range.hi - c, c - range.lo);
    const double most = fmax(pow(range.lo, e - 3), pow(range.hi, e - 3));
    sgt_model off, square, out;
    if (!(range.lo > 0)) return sgt_model_between((sgt_interval){-HUGE_VAL, HUGE_VAL});
    sgt_model_plus(w, -c, &off), sgt_model_product(&off, &off, &square);
    sgt_model_scaled(&off, e * pow(c, e - 1), &out);
    sgt_model_scaled(&square, e * (e - 1) / 2 * pow(c, e - 2), &square);
    sgt_model_sum(&out, &square, &out), sgt_model_plus(&out, pow(c, e), &out);
    const double left = fabs(e * (e - 1) * (e - 2)) / 6 * most * far * far * far;
    out.rest += left * (1 + GRAIN) + GRAIN * (fabs(out.c) + sgt_interval_greatest(sgt_model_range(&out)));
    return out;
}

static void add(terms *t, double k, const sgt_model *x)
{
    sgt_model scaled;
    sgt_model_scaled(x, k, &scaled);
    sgt_model_sum(&t->sum, &scaled, &t->sum);
    t->size += fabs(k) * sgt_interval_greatest(sgt_model_range(x));
}

static void add_fixed(terms *t, double k) { sgt_model_plus(&t->sum, k, &t->sum), t->size += fabs(k); }

static void add_power(terms *t, double k, double e)
{
    if (k == 0) return;
    const sgt_model p = power_model(&t->w, e);
    add(t, k, &p);
}

static void add_powers(terms *t, size_t first)
{
    for (size_t i = first; i < t->g->count; i += 2)
        add_power(t, coefficient_of(t, i), coefficient_of(t, i + 1));
}

static void add_laurent(terms *t, size_t count, const int exponent[])
{
    for (size_t i = 0; i < count; i++) add_power(t, coefficient_of(t, i), exponent[i]);
}

/* 1 / (x - pole) */
static sgt_model over(const sgt_model *x, double pole)
{
    sgt_model out;
    sgt_model_plus(x, -pole, &out);
    out.rest += GRAIN * fabs(pole);
    sgt_model_inverse(&out, &out);
    return out;
}

static void add_resonances(terms *t, size_t first, size_t end, bool squared)
{
    for (size_t i = first; i < end; i += 2) {
        const double by = coefficient_of(t, i), c = coefficient_of(t, i + 1);
        if (by == 0) continue;
        sgt_model r = over(&t->w2, squared ? c * c : c);
        sgt_model_product(&r, &t->w2, &r);
        add(t, by, &r);
    }
}

static void add_herzberger(terms *t)
{
    const sgt_model l = over(&t->w2, 0.028);
    sgt_model l2;
    sgt_model_product(&l, &l, &l2);
    add_fixed(t, coefficient_of(t, 0)), add(t, coefficient_of(t, 1), &l), add(t, coefficient_of(t, 2), &l2);
    add_power(t, coefficient_of(t, 3), 2), add_power(t, coefficient_of(t, 4), 4);
    add_power(t, coefficient_of(t, 5), 6);
}

static void add_generalised(terms *t)
{
    add_fixed(t, coefficient_of(t, 0));
    for (size_t i = 1; i < 9; i += 4) {
        if (coefficient_of(t, i) == 0) continue;
        const sgt_model p = power_model(&t->w, coefficient_of(t, i + 1));
        sgt_model r = over(&t->w2, pow(coefficient_of(t, i + 2), coefficient_of(t, i + 3)));
        sgt_model_product(&r, &p, &r);
        add(t, coefficient_of(t, i), &r);
    }
    add_powers(t, 9);
}

static void add_gases(terms *t)
{
    const sgt_model under = power_model(&t->w, -2);
    add_fixed(t, 1 + coefficient_of(t, 0));
    for (size_t i = 1; i < t->g->count; i += 2) {
        sgt_model r = over(&under, coefficient_of(t, i + 1));
        if (coefficient_of(t, i) != 0) add(t, -coefficient_of(t, i), &r);
    }
}

/* k / (w^2 - pole) */
static void add_over(terms *t, double k, double pole)
{
    if (k == 0) return;
    const sgt_model r = over(&t->w2, pole);
    add(t, k, &r);
}

static void add_model(terms *t)
{
    const double nd = coefficient_of(t, 0), vd = coefficient_of(t, 1), d = 0.5875618;
    add_fixed(t, nd);
    if (vd == 0) return;
    /* as glass.c has it */
    const double line[3] = {0.4861327 - d, 0.6562725 - d, 0.4358343 - d};
    double v[3];
    for (int i = 0; i < 3; i++) v[i] = line[i] / (1 + 2.5 * line[i]);
    const double FC = (nd - 1) / vd, gF = (0.6438 - 0.001682 * vd + coefficient_of(t, 2)) * FC;
    const double first = FC / (v[0] - v[1]), second = gF / (v[2] - v[0]);
    const double b = (second - first) / (v[2] - v[1]), a = first - b * (v[0] + v[1]);
    sgt_model x, under, square;
    sgt_model_plus(&t->w, -d, &x);
    sgt_model_scaled(&x, 2.5, &under), sgt_model_plus(&under, 1, &under), sgt_model_inverse(&under, &under);
    sgt_model_product(&x, &under, &x), sgt_model_product(&x, &x, &square);
    add(t, a, &x), add(t, b, &square);
}

static void take_root(terms *t)
{
    t->sum.rest += GRAIN * t->size;
    sgt_model_root(&t->sum, &t->sum);
    t->size = sgt_interval_greatest(sgt_model_range(&t->sum));
}

/* Formula 8: n^2 = (1 + 2 x) / (1 - x), x the sum. */
static void take_lorentz(terms *t)
{
    sgt_model above, below;
    t->sum.rest += GRAIN * t->size;
    sgt_model_scaled(&t->sum, 2, &above), sgt_model_plus(&above, 1, &above);
    sgt_model_scaled(&t->sum, -1, &below), sgt_model_plus(&below, 1, &below);
    sgt_model_inverse(&below, &below), sgt_model_product(&above, &below, &t->sum);
    t->size = sgt_interval_greatest(sgt_model_range(&t->sum));
}

static bool add_formula(terms *t)
{
    static const int extended[] = {0, 2, -2, -4, -6, -8, -10, -12};
    static const int extended_2[] = {0, 2, -2, -4, -6, -8, 4, 6};
    static const int extended_3[] = {0, 2, 4, -2, -4, -6, -8, -10, -12};
    bool root = true;
    switch (t->g->formula) {
    case 1: add_fixed(t, 1 + coefficient_of(t, 0)), add_resonances(t, 1, t->g->count, true); break;
    case 2: add_fixed(t, 1 + coefficient_of(t, 0)), add_resonances(t, 1, t->g->count, false); break;
    case 3: add_fixed(t, coefficient_of(t, 0)), add_powers(t, 1); break;
    case 4: add_generalised(t); break;
    case 5: add_fixed(t, coefficient_of(t, 0)), add_powers(t, 1), root = false; break;
    case 6: add_gases(t), root = false; break;
    case 7: add_herzberger(t), root = false; break;
    case 8:
        add_fixed(t, coefficient_of(t, 0)), add_resonances(t, 1, 3, false);
        add_power(t, coefficient_of(t, 3), 2), take_lorentz(t);
        break;
    case 9: {
        sgt_model x, under;
        add_fixed(t, coefficient_of(t, 0)), add_over(t, coefficient_of(t, 1), coefficient_of(t, 2));
        sgt_model_plus(&t->w, -coefficient_of(t, 4), &x), sgt_model_product(&x, &x, &under);
        sgt_model_plus(&under, coefficient_of(t, 5), &under), sgt_model_inverse(&under, &under);
        sgt_model_product(&x, &under, &x);
        if (coefficient_of(t, 3) != 0) add(t, coefficient_of(t, 3), &x);
        break;
    }
    case SGT_DISPERSION_AGF + 1: add_laurent(t, 6, extended); break;
    case SGT_DISPERSION_AGF + 2: add_fixed(t, 1), add_resonances(t, 0, 6, false); break;
    case SGT_DISPERSION_AGF + 3: add_herzberger(t), root = false; break;
    case SGT_DISPERSION_AGF + 4:
        add_fixed(t, 1 + coefficient_of(t, 0)), add_resonances(t, 1, 3, true);
        add_over(t, coefficient_of(t, 3), coefficient_of(t, 4) * coefficient_of(t, 4));
        break;
    case SGT_DISPERSION_AGF + 5:
        add_fixed(t, coefficient_of(t, 0)), add_power(t, coefficient_of(t, 1), -1);
        add_power(t, coefficient_of(t, 2), -3.5), root = false;
        break;
    case SGT_DISPERSION_AGF + 6: add_fixed(t, 1), add_resonances(t, 0, 8, false); break;
    case SGT_DISPERSION_AGF + 7:
        add_fixed(t, coefficient_of(t, 0)), add_over(t, coefficient_of(t, 1), coefficient_of(t, 2));
        add_power(t, -coefficient_of(t, 3), 2);
        break;
    case SGT_DISPERSION_AGF + 8:
        add_fixed(t, coefficient_of(t, 0)), add_resonances(t, 1, 3, false);
        add_power(t, -coefficient_of(t, 3), 2);
        break;
    case SGT_DISPERSION_AGF + 9: add_fixed(t, coefficient_of(t, 0)), add_resonances(t, 1, 5, false); break;
    case SGT_DISPERSION_AGF + 10: add_laurent(t, 8, extended); break;
    case SGT_DISPERSION_AGF + 11: add_fixed(t, 1), add_resonances(t, 0, 10, false); break;
    case SGT_DISPERSION_AGF + 12: add_laurent(t, 8, extended_2); break;
    case SGT_DISPERSION_AGF + 13: add_laurent(t, 9, extended_3); break;
    case SGT_DISPERSION_PAIRS:
        if (t->g->count != 2) return false;
        add_fixed(t, coefficient_of(t, 1)), root = false;
        break;
    case SGT_DISPERSION_MODEL: add_model(t), root = false; break;
    default: return false;
    }
    if (root) take_root(t);
    return true;
}

bool sgt_dispersion(const sgt_glass *glass, const sgt_model *um, sgt_model *out)
{
    terms t = {.g = glass, .w = *um, .sum = sgt_model_of(0)};
    sgt_model_product(um, um, &t.w2);
    if (!(sgt_model_range(um).lo > 0) || !add_formula(&t)) return false;
    t.sum.rest += GRAIN * t.size;
    *out = t.sum;
    return sgt_model_range(out).lo > 0 && isfinite(out->rest);
}
