// SPDX-License-Identifier: MIT
/* glass.c - the index of a glass by its dispersion formula.
 *
 * All formulas are sums of few kinds of terms (include/sagitta/lens.h lists them): powers of
 * the wavelength w, and resonances.  Each is worked out in double as it is written; pow, sqrt
 * and division of the C library are good to an ulp, and the sums have at most a dozen terms.
 * The error is some ulps of the largest term: the tests hold it to 1e-15 of n for all glasses
 * that ship, at up to six wavelengths in their ranges, against 50 digits.  Near a pole of a
 * resonance no such bound holds.
 *
 * Formula 8 is Lorentz and Lorenz's: with x = (n^2 - 1) / (n^2 + 2), n^2 = (1 + 2 x) / (1 - x).
 *
 * THE MODEL GLASS follows Buchdahl (Optical aberration coefficients, 1954; Robb and Mercado,
 * Applied Optics 22, 1983, 1198): in v = x / (1 + 2.5 x) the index of a glass is nearly a
 * parabola.  What OpticStudio does is not published; where its indices are known the two
 * differ by 2e-7 at 0.63 um and 2.5e-5 at 0.92 um. */
#include "forms.h"

#include <sagitta/lens.h>

#include <math.h>
#include <stdio.h>
#include <string.h>

static const struct { const char *name; double um; } line[] = {
    {"i", 0.3650146},  {"h", 0.4046561},  {"g", 0.4358343}, {"F'", 0.4799914}, {"F", 0.4861327},
    {"e", 0.5460740},  {"d", 0.5875618},  {"D", 0.5892938}, {"C'", 0.6438469}, {"C", 0.6562725},
    {"r", 0.7065188},  {"s", 0.85211},    {"t", 1.01398},
};

double sgt_spectral_line(const char *name)
{
    for (size_t i = 0; i < sizeof line / sizeof *line; i++)
        if (strcmp(name, line[i].name) == 0) return line[i].um;
    return (double)NAN;
}

/* ------------------------------------------------------------------ terms */

/* The i-th coefficient, from 0; 0 beyond the last. */
static double at(const sgt_glass *g, size_t i) { return i < g->count ? g->coefficient[i] : 0; }

/* Sum of c[i] w^2 / (w^2 - pole), pole c[i+1] or its square, from `first` on. */
static double resonances(const sgt_glass *g, size_t first, size_t end, bool squared, double w2)
{
    double sum = 0;
    for (size_t i = first; i < end; i += 2) {
        double pole = squared ? at(g, i + 1) * at(g, i + 1) : at(g, i + 1);
        if (at(g, i) != 0) sum += at(g, i) * w2 / (w2 - pole); /* a term of 0 has no pole */
    }
    return sum;
}

/* Sum of c[i] w^c[i+1], from `first` on. */
static double powers(const sgt_glass *g, size_t first, double w)
{
    double sum = 0;
    for (size_t i = first; i < g->count; i += 2) sum += at(g, i) * pow(w, at(g, i + 1));
    return sum;
}

/* Sum of c[first + i] w^exponent[i]. */
static double laurent(const sgt_glass *g, size_t count, const int exponent[], double w)
{
    double sum = 0;
    for (size_t i = 0; i < count; i++) sum += at(g, i) * pow(w, exponent[i]);
    return sum;
}

static double herzberger(const sgt_glass *g, double w2)
{
    double l = 1 / (w2 - 0.028);
    return at(g, 0) + at(g, 1) * l + at(g, 2) * l * l + at(g, 3) * w2 + at(g, 4) * w2 * w2 +
           at(g, 5) * w2 * w2 * w2;
}

static double generalised(const sgt_glass *g, double w)
{
    double w2 = w * w, sum = at(g, 0);
    for (size_t i = 1; i < 9; i += 4)
        if (at(g, i) != 0) sum += at(g, i) * pow(w, at(g, i + 1)) / (w2 - pow(at(g, i + 2), at(g, i + 3)));
    return sum + powers(g, 9, w);
}

static double gases(const sgt_glass *g, double w2)
{
    double sum = 1 + at(g, 0);
    for (size_t i = 1; i < g->count; i += 2)
        if (at(g, i) != 0) sum += at(g, i) / (at(g, i + 1) - 1 / w2);
    return sum;
}

/* Straight lines through pairs of wavelength and index. */
static double between(const sgt_glass *g, double w)
{
    const double *c = g->coefficient;
    if (g->count == 2) return c[1];
    size_t low = 0, high = g->count / 2 - 1; /* of pairs */
    while (high - low > 1) {
        size_t middle = low + (high - low) / 2;
        *(c[2 * middle] <= w ? &low : &high) = middle;
    }
    const double *p = c + 2 * low, *q = c + 2 * high;
    if (w == q[0]) return q[1];
    return p[1] + (q[1] - p[1]) * ((w - p[0]) / (q[0] - p[0]));
}

static double buchdahl(double w)
{
    double x = w - 0.5875618;
    return x / (1 + 2.5 * x);
}

static double model(const sgt_glass *g, double w)
{
    double nd = at(g, 0), vd = at(g, 1);
    if (vd == 0) return nd;
    double vF = buchdahl(0.4861327), vC = buchdahl(0.6562725), vg = buchdahl(0.4358343);
    double FC = (nd - 1) / vd, gF = (0.6438 - 0.001682 * vd + at(g, 2)) * FC;
    /* a (vF - vC) + b (vF^2 - vC^2) = FC and a (vg - vF) + b (vg^2 - vF^2) = gF: both divided by
     * their first factors, and subtracted. */
    double first = FC / (vF - vC), second = gF / (vg - vF);
    double b = (second - first) / (vg - vC), a = first - b * (vF + vC), v = buchdahl(w);
    return nd + v * (a + b * v);
}

/* --------------------------------------------------------------- formulas */

static double root(double n2) { return n2 > 0 ? sqrt(n2) : (double)NAN; }

static double by_formula(const sgt_glass *g, double w)
{
    static const int extended[] = {0, 2, -2, -4, -6, -8, -10, -12};
    static const int extended_2[] = {0, 2, -2, -4, -6, -8, 4, 6};
    static const int extended_3[] = {0, 2, 4, -2, -4, -6, -8, -10, -12};
    double w2 = w * w, x;
    switch (g->formula) {
    case 1: return root(1 + at(g, 0) + resonances(g, 1, g->count, true, w2));
    case 2: return root(1 + at(g, 0) + resonances(g, 1, g->count, false, w2));
    case 3: return root(at(g, 0) + powers(g, 1, w));
    case 4: return root(generalised(g, w));
    case 5: return at(g, 0) + powers(g, 1, w);
    case 6: return gases(g, w2);
    case 7: return herzberger(g, w2);
    case 8:
        x = at(g, 0) + resonances(g, 1, 3, false, w2) + at(g, 3) * w2;
        return root((1 + 2 * x) / (1 - x));
    case 9:
        x = w - at(g, 4);
        return root(at(g, 0) + (at(g, 1) != 0 ? at(g, 1) / (w2 - at(g, 2)) : 0) +
                    (at(g, 3) != 0 ? at(g, 3) * x / (x * x + at(g, 5)) : 0));
    case SGT_DISPERSION_AGF + 1: return root(laurent(g, 6, extended, w));
    case SGT_DISPERSION_AGF + 2: return root(1 + resonances(g, 0, 6, false, w2));
    case SGT_DISPERSION_AGF + 3: return herzberger(g, w2);
    case SGT_DISPERSION_AGF + 4:
        return root(1 + at(g, 0) + resonances(g, 1, 3, true, w2) +
                    (at(g, 3) != 0 ? at(g, 3) / (w2 - at(g, 4) * at(g, 4)) : 0));
    case SGT_DISPERSION_AGF + 5: return at(g, 0) + at(g, 1) / w + at(g, 2) / pow(w, 3.5);
    case SGT_DISPERSION_AGF + 6: return root(1 + resonances(g, 0, 8, false, w2));
    case SGT_DISPERSION_AGF + 7:
        return root(at(g, 0) + (at(g, 1) != 0 ? at(g, 1) / (w2 - at(g, 2)) : 0) - at(g, 3) * w2);
    case SGT_DISPERSION_AGF + 8: return root(at(g, 0) + resonances(g, 1, 3, false, w2) - at(g, 3) * w2);
    case SGT_DISPERSION_AGF + 9: return root(at(g, 0) + resonances(g, 1, 5, false, w2));
    case SGT_DISPERSION_AGF + 10: return root(laurent(g, 8, extended, w));
    case SGT_DISPERSION_AGF + 11: return root(1 + resonances(g, 0, 10, false, w2));
    case SGT_DISPERSION_AGF + 12: return root(laurent(g, 8, extended_2, w));
    case SGT_DISPERSION_AGF + 13: return root(laurent(g, 9, extended_3, w));
    case SGT_DISPERSION_PAIRS: return between(g, w);
    case SGT_DISPERSION_MODEL: return model(g, w);
    default: return (double)NAN;
    }
}

const char *sgt_glass_fault(const sgt_glass *g)
{
    static const size_t needed[] = {6, 6, 6, 5, 3, 8, 4, 4, 5, 8, 10, 8, 9};
    static const size_t most[] = {0, 0, 0, 0, 0, 0, 6, 4, 6}; /* 0: any number */
    for (size_t i = 0; i < sizeof g->reserved_ / sizeof *g->reserved_; i++)
        if (g->reserved_[i]) return "a member of a later version of sagitta";
    int agf = g->formula - SGT_DISPERSION_AGF;
    bool pairs = g->formula == SGT_DISPERSION_PAIRS, of_model = g->formula == SGT_DISPERSION_MODEL;
    if (!(g->formula >= 1 && g->formula <= 9) && !(agf >= 1 && agf <= 13) && !pairs && !of_model)
        return "no such dispersion formula";
    if (g->count == 0) return "no coefficients";
    for (size_t i = 0; i < g->count; i++)
        if (!isfinite(g->coefficient[i])) return "a coefficient is not finite";
    if (agf >= 1 && agf <= 13 && g->count < needed[agf - 1]) return "fewer coefficients than the formula has";
    if (g->formula <= 9 && most[g->formula - 1] && g->count > most[g->formula - 1])
        return "more coefficients than the formula has";
    if (g->formula <= 6 && g->count > 1 && g->count % 2 == 0) return "a coefficient without its partner";
    if (pairs && g->count % 2) return "a wavelength without an index";
    for (size_t i = 0; pairs && i < g->count; i += 2) {
        if (!(g->coefficient[i] > 0)) return "a wavelength that is not positive";
        if (!(g->coefficient[i + 1] > 0)) return "an index that is not positive";
        if (i && !(g->coefficient[i] > g->coefficient[i - 2])) return "wavelengths that do not rise";
    }
    if (of_model && !(g->coefficient[0] > 0)) return "nd is not positive";
    if (of_model && !(at(g, 1) >= 0)) return "vd is negative";
    if (!isfinite(g->from) || !isfinite(g->to) || !(g->from >= 0) || !(g->to >= g->from))
        return "the range of wavelengths is not one";
    return NULL;
}

bool sgt_glass_sound(const sgt_glass *g, sgt_error *error)
{
    const char *fault = sgt_glass_fault(g);
    if (!fault || !error) return !fault;
    *error = (sgt_error){.line = g->line};
    snprintf(error->file, sizeof error->file, "%s", g->file ? g->file : "");
    snprintf(error->key, sizeof error->key, "%s", g->name ? g->name : "");
    snprintf(error->words, sizeof error->words, "%s", fault);
    return false;
}

double sgt_glass_index(const sgt_glass *g, double um)
{
    if (!(um > 0) || !isfinite(um) || sgt_glass_fault(g)) return (double)NAN;
    double n = by_formula(g, um);
    return n > 0 && isfinite(n) ? n : (double)NAN;
}

bool sgt_glass_covers(const sgt_glass *g, double um)
{
    if (g->from == 0 && g->to == 0) return um > 0 && isfinite(um);
    return um >= g->from && um <= g->to;
}
