// SPDX-License-Identifier: MIT
/* slope.c - derivatives of the figure by what is off.
 *
 * A figure F is the root of the sum of the squares of residuals r, whose derivatives J by the entries are
 * those of ../figure: rays go through once and back, and the lens of a point is made by sgt_build_at,
 * whatever an entry puts off.  It moves by r . J / F.  Where r = 0, as of the boresight of the design, it has
 * a kink: it grows by |J| to either side.
 *
 * COMPENSATORS follow an entry v.  A paraxial one by c' = d image / dv, since it keeps the image at its
 * place. Those that seek the best figure keep g = J_c . r, half the gradient of F^2, at 0; so with the
 * derivatives
 *
 *     g_cv + g_cc c' = 0,
 *
 * each along v with the paraxial one.  Both follow: r moves by A = J_v + the sum of J_c c', F by r . A / F.
 * g is exact at any point, its derivatives are differences of the fourth order, over a quarter of the box at
 * most.  What they are off moves F by r . J_c, nearly 0.  At an end of its box a compensator stays. */
#include "../figure/figure.h"
#include "tolerance.h"

#include <stdio.h>
#include <string.h>

/* Residuals, and derivatives by some entries, at any point. */
typedef struct residuals {
    const sgt_tolerancing *t;
    size_t count, *entry; /* [count]: the entries */
    double *point;        /* [t->count]: where they are asked for */
    double *x, *step;     /* [count] */
    const char **name;    /* [count]: for errors, which nobody reads */
    lens_numbers by;
    sgt_study_options study;
    sgt_wavelength primary;
    sgt_figure *figure;
    size_t rows;
    double *r, *j; /* [rows], [rows * count] */
} residuals;

typedef struct sloping {
    const sgt_tolerancing *t;
    arena memory;
    sgt_lens *lens;
    const double *value; /* [count]: a point with its compensators set */
    double *point;       /* [count]: room */
    bool *none;          /* [count]: no derivative */
    double *follow;      /* [count]: c' of the paraxial one by each entry */
    residuals all, seek; /* by all entries; by the compensators that seek and are at no end */
    double *bend;        /* g_cc: [seek.count^2] */
    double *moved;       /* g_cv of an entry, then c': [seek.count] */
} sloping;

static bool no_memory(const sgt_error *error) { return strcmp(error->words, "no memory") == 0; }

static void *room_for(sloping *s, size_t count, size_t size)
{
    void *room = sgt_arena_take(&s->memory, count * size + 1);
    if (room) memset(room, 0, count * size);
    return room;
}

/* A power of two, about half of the box: steps are then exact. */
static double step_of_entry(const sgt_tolerance *e) { return ldexp(1, ilogb((e->upper - e->lower) / 2)); }

/* Is it a compensator of this kind that is not at an end of its box? */
static bool follows(const sloping *s, size_t i, sgt_compensation kind)
{
    const sgt_tolerance *e = &s->t->entry[i];
    return e->compensator == kind && s->value[i] > e->lower && s->value[i] < e->upper;
}

/* ------------------------------------------------------------------------ residuals */

static bool put_point(const void *context, sgt_lens *lens, const double from[], const double to[],
                      sgt_error *error)
{
    const residuals *w = context;
    (void)from;
    for (size_t k = 0; k < w->count; k++) w->point[w->entry[k]] = to[k];
    return sgt_build_at(w->t, lens, w->point, error);
}

/* The study: fields that are given by themselves weigh alike; a boresight has the primary wavelength. */
static bool set_study(sloping *s, residuals *w)
{
    const sgt_tolerancing *t = s->t;
    w->study = t->study;
    if (t->study.fields && !t->study.field) {
        sgt_lens_field *at = room_for(s, t->study.fields, sizeof *at);
        if (!at) return false;
        for (size_t i = 0; i < t->study.fields; i++) at[i] = t->study.field_at[i], at[i].weight = 1;
        w->study.field_at = at;
    }
    if (t->opt.figure != SGT_TOLERANCING_BORESIGHT) return true;
    w->primary = (sgt_wavelength){.number = t->of->primary + 1};
    w->study.every_wavelength = false;
    w->study.wavelengths = t->of->wavelengths > 0, w->study.wavelength = &w->primary;
    return true;
}

/* By the w->count entries w->entry.  false: there are none, or no memory. */
static bool begin_residuals(sloping *s, residuals *w, sgt_error *error)
{
    static const sgt_figure_kind kinds[] = {[SGT_TOLERANCING_SPOT] = SGT_FIGURE_SPOT,
                                            [SGT_TOLERANCING_OPD] = SGT_FIGURE_OPD,
                                            [SGT_TOLERANCING_BORESIGHT] = SGT_FIGURE_CHIEF};
    const sgt_figure_options kind = {.kind = kinds[s->t->opt.figure], .reference = s->t->opt.reference};
    w->t = s->t;
    w->point = room_for(s, s->t->count, sizeof *w->point), w->x = room_for(s, w->count, sizeof *w->x);
    w->step = room_for(s, w->count, sizeof *w->step), w->name = room_for(s, w->count, sizeof *w->name);
    if (!w->point || !w->x || !w->step || !w->name || !set_study(s, w)) return false;
    memcpy(w->point, s->value, s->t->count * sizeof *w->point);
    for (size_t k = 0; k < w->count; k++) {
        w->name[k] = "tolerances", w->step[k] = step_of_entry(&s->t->entry[w->entry[k]]);
        w->x[k] = s->value[w->entry[k]];
    }
    w->by =
        (lens_numbers){.count = w->count, .path = w->name, .step = w->step, .context = w, .put = put_point};
    if (!sgt_build_at(s->t, s->lens, s->value, error)) return false;
    w->figure = sgt_figure_by(s->lens, &w->study, &kind, &w->by, w->x, error);
    if (!w->figure) return false;
    w->rows = sgt_figure_size(w->figure).residuals;
    w->r = room_for(s, w->rows, sizeof *w->r), w->j = room_for(s, w->rows * w->count, sizeof *w->j);
    return w->r && w->j;
}

static double weight_of_field(const sgt_tolerancing *t, size_t i)
{
    const sgt_study_options *o = &t->study;
    if (!o->fields) return t->of->field[i].weight;
    return o->field ? t->of->field[o->field[i] - 1].weight : 1;
}

/* Of the boresight: from where chief rays are designed to end, each field by its weight. */
static void weigh_chiefs(residuals *w)
{
    double total = 0;
    for (size_t k = 0; k < w->rows; k += 2) total += weight_of_field(w->t, k / 2);
    for (size_t k = 0; k < w->rows; k++) {
        const double share = sqrt(weight_of_field(w->t, k / 2) / total);
        const sgt_vec2 *designed = &w->t->chief[k / 2];
        w->r[k] = share * (w->r[k] - (k % 2 ? designed->y : designed->x));
        for (size_t i = 0; i < w->count; i++) w->j[k * w->count + i] *= share;
    }
}

static bool residuals_at(residuals *w, const double point[], sgt_error *error)
{
    sgt_figure_out out = {.residual = w->r, .jacobian = w->j};
    memcpy(w->point, point, w->t->count * sizeof *w->point);
    for (size_t k = 0; k < w->count; k++) w->x[k] = point[w->entry[k]];
    if (!sgt_figure_eval(w->figure, w->x, &out, error)) return false;
    for (size_t k = 0; k < w->rows; k++)
        if (isnan(w->r[k])) w->r[k] = 0; /* of a ray that is lost; so is its row of j */
    if (w->t->opt.figure == SGT_TOLERANCING_BORESIGHT) weigh_chiefs(w);
    return true;
}

/* ------------------------------------------------------------------------ compensators */

/* Of values at -2h, -h, (none at 0), h, 2h. */
static double differ_at(const double v[5], double h)
{
    return (8 * (v[3] - v[1]) - (v[4] - v[0])) / (12 * h);
}

/* s->follow[i]: how the paraxial image moves, all other entries and the compensators at 0.  Where there is
 * none the compensator stays. */
static bool find_follow(sloping *s, size_t i, sgt_error *error)
{
    const double h = step_of_entry(&s->t->entry[i]);
    double image[5] = {0};
    memset(s->point, 0, s->t->count * sizeof *s->point);
    for (int k = -2; k <= 2; k++) {
        sgt_first_order data;
        s->point[i] = k * h;
        if (k == 0) continue;
        if (!sgt_build_at(s->t, s->lens, s->point, error) ||
            !sgt_lens_first_order(s->lens, (double)NAN, &data, NULL, error))
            return false;
        image[k + 2] = data.image;
    }
    const double by = differ_at(image, h);
    s->follow[i] = isnan(by) ? 0 : by;
    return true;
}

/* out[k]: how g of each compensator that seeks moves with entry i. */
static bool move_gradient(sloping *s, size_t i, double out[], sgt_error *error)
{
    residuals *w = &s->seek;
    const size_t n = w->count;
    const double h = step_of_entry(&s->t->entry[i]) / 8;
    double *g = s->moved + n; /* [5 * n] */
    for (int k = -2; k <= 2; k++) {
        if (k == 0) continue;
        memcpy(s->point, s->value, s->t->count * sizeof *s->point);
        s->point[i] += k * h;
        for (size_t c = 0; c < s->t->count; c++)
            if (follows(s, c, SGT_COMPENSATE_PARAXIAL)) s->point[c] += k * h * s->follow[i];
        if (!residuals_at(w, s->point, error)) return false;
        for (size_t m = 0; m < n; m++) {
            double sum = 0;
            for (size_t row = 0; row < w->rows; row++) sum += w->r[row] * w->j[row * n + m];
            g[m * 5 + (size_t)(k + 2)] = sum;
        }
    }
    for (size_t m = 0; m < n; m++) out[m] = differ_at(g + 5 * m, h);
    return true;
}

/* Makes s->moved the c' that keep g at 0: elimination, of a matrix that is positive definite at a minimum. */
static void solve_moved(sloping *s, double a[])
{
    const size_t n = s->seek.count;
    double *x = s->moved;
    memcpy(a, s->bend, n * n * sizeof *a);
    for (size_t k = 0; k < n; k++) x[k] = -x[k];
    for (size_t k = 0; k < n; k++)
        for (size_t i = k + 1; i < n; i++) {
            const double by = a[i * n + k] / a[k * n + k];
            for (size_t c = k; c < n; c++) a[i * n + c] -= by * a[k * n + c];
            x[i] -= by * x[k];
        }
    for (size_t k = n; k-- > 0;) {
        for (size_t c = k + 1; c < n; c++) x[k] -= a[k * n + c] * x[c];
        x[k] /= a[k * n + k];
    }
}

/* Residuals by the compensators that seek, and how g moves with these. */
static bool begin_seeking(sloping *s, sgt_error *error)
{
    residuals *w = &s->seek;
    w->entry = room_for(s, s->t->count, sizeof *w->entry);
    for (size_t c = 0; c < s->t->count && w->entry; c++)
        if (follows(s, c, SGT_COMPENSATE_FIGURE)) w->entry[w->count++] = c;
    if (!w->entry) return false;
    if (w->count == 0) return true;
    s->bend = room_for(s, 2 * w->count * w->count, sizeof *s->bend); /* and room to solve */
    s->moved = room_for(s, 6 * w->count, sizeof *s->moved);
    if (!s->bend || !s->moved || !begin_residuals(s, w, error)) return false;
    for (size_t k = 0; k < w->count; k++) {
        if (!move_gradient(s, w->entry[k], s->moved, error)) return false;
        for (size_t m = 0; m < w->count; m++) s->bend[m * w->count + k] = s->moved[m];
    }
    return true;
}

/* -------------------------------------------------------------------------- the slopes */

/* Entry i with what follows it.  false: no memory, or *error says why there is none. */
static bool find_slope(sloping *s, size_t i, double f, slopes *out, sgt_error *error)
{
    static const double ROUNDING = 0x1p-42; /* of a sum: what is less is 0, as by symmetry */
    const sgt_tolerancing *t = s->t;
    const residuals *all = &s->all;
    bool paraxial = false;
    size_t first = 0;
    while (first < t->count && !t->entry[first].compensator) first++;
    for (size_t c = 0; c < t->count; c++) paraxial = paraxial || follows(s, c, SGT_COMPENSATE_PARAXIAL);
    if (paraxial && !find_follow(s, i, error)) return false;
    if (s->seek.count > 0) {
        if (!move_gradient(s, i, s->moved, error)) return false;
        solve_moved(s, s->bend + s->seek.count * s->seek.count);
    }
    double sum = 0, size = 0, square = 0;
    for (size_t row = 0; row < all->rows; row++) {
        const double *j = all->j + row * t->count;
        double moved = j[i];
        for (size_t c = 0; c < t->count && paraxial; c++)
            if (follows(s, c, SGT_COMPENSATE_PARAXIAL)) moved += j[c] * s->follow[i];
        for (size_t k = 0; k < s->seek.count; k++) moved += j[s->seek.entry[k]] * s->moved[k];
        sum += all->r[row] * moved, size += fabs(all->r[row] * moved), square += moved * moved;
    }
    out->figure[i] = f == 0 ? sqrt(square) : fabs(sum) <= ROUNDING * size ? 0 : sum / f;
    if (first == t->count) return true;
    out->compensator[i] = follows(s, first, SGT_COMPENSATE_PARAXIAL) ? s->follow[i] : 0;
    for (size_t k = 0; k < s->seek.count; k++)
        if (s->seek.entry[k] == first) out->compensator[i] = s->moved[k];
    return true;
}

/* false: no memory, or *error says why there are none. */
static bool find_slopes(sloping *s, slopes *out, sgt_error *error)
{
    const sgt_tolerancing *t = s->t;
    residuals *all = &s->all;
    double square = 0;
    s->point = room_for(s, t->count, sizeof *s->point), s->none = room_for(s, t->count, sizeof *s->none);
    s->follow = room_for(s, t->count, sizeof *s->follow);
    all->entry = room_for(s, t->count, sizeof *all->entry), all->count = t->count;
    if (!s->point || !s->none || !s->follow || !all->entry) return false;
    for (size_t i = 0; i < t->count; i++) all->entry[i] = i;
    if (!begin_residuals(s, all, error) || !residuals_at(all, s->value, error)) return false;
    bool none = false; /* of a compensator */
    for (size_t i = 0; i < t->count; i++) {
        s->none[i] = sgt_figure_has_none(all->figure, i);
        none = none || (s->none[i] && t->entry[i].compensator);
    }
    if (none) return true;
    if (!begin_seeking(s, error)) return false;
    for (size_t row = 0; row < all->rows; row++) square += all->r[row] * all->r[row];
    out->even = t->opt.figure == SGT_TOLERANCING_BORESIGHT || square == 0;
    for (size_t i = 0; i < t->count; i++)
        if (!t->entry[i].compensator && !s->none[i] &&
            !find_slope(s, i, out->even ? 0 : sqrt(square), out, error) && no_memory(error))
            return false;
    return true;
}

bool sgt_slopes_at(const sgt_tolerancing *t, const double value[], slopes *out, sgt_error *error)
{
    sloping s = {.t = t, .memory = {.allocator = t->memory.allocator}, .value = value};
    out->even = false;
    for (size_t i = 0; i < t->count; i++) out->figure[i] = out->compensator[i] = (double)NAN;
    *error = (sgt_error){.words = "no memory"}; /* stands, if that is why the next fail */
    s.lens = sgt_lens_copy(t->base, error);
    const bool fine = s.lens && find_slopes(&s, out, error);
    sgt_figure_free(s.all.figure);
    sgt_figure_free(s.seek.figure);
    sgt_lens_free(s.lens);
    sgt_arena_free(&s.memory);
    return fine || !no_memory(error);
}
