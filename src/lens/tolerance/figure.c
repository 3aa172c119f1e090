// SPDX-License-Identifier: MIT
/* figure.c - the figure of a lens, and the compensators that make it best.
 *
 * A compensator is sought by parabolas through the square of the figure at three places: of the spot against
 * the last thickness that square is a parabola, since rays are straight lines behind the last glass and
 * apertures do not change; of anything else it nearly is one where the figure is smallest.  The search ends
 * when the parabola has foretold the new value within FORETOLD of it, so the figure is then within some
 * FORETOLD of the least one.  Several compensators are sought in turn until a round gains no more. */
#include "../study/study.h"
#include "tolerance.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const double FORETOLD = 1e-7;

/* ------------------------------------------------------------------------ a figure */

typedef struct squares {
    const sgt_tolerancing *t;
    const sgt_lens *lens;
    size_t field;               /* of the study, from 0: the next one */
    sgt_vec2 *chief;            /* of the boresight: to be set; NULL: it is known */
    double sum, weight;
} squares;

static void add_square(squares *s, size_t field, double weight, double rms)
{
    const sgt_study_options *o = &s->t->study;
    const bool of_lens = !o->fields || o->field;
    const double w = weight * (of_lens ? s->lens->field[field - 1].weight : 1);
    if (!(w > 0)) return;
    s->sum += w * rms * rms, s->weight += w;
}

static void add_spot(void *context, const void *row)
{
    const sgt_spot_row *r = row;
    if (r->wavelength == SGT_ALL_WAVELENGTHS) add_square(context, r->field, 1, r->rms);
}

static void add_boresight(void *context, const void *row)
{
    const sgt_spot_row *r = row;
    squares *s = context;
    if (r->wavelength != SGT_ALL_WAVELENGTHS) return;
    if (s->chief) s->chief[s->field] = (sgt_vec2){r->x, r->y};
    const sgt_vec2 as_designed = s->t->chief[s->field++];
    add_square(s, r->field, 1, hypot(r->x - as_designed.x, r->y - as_designed.y));
}

static void add_wavefront(void *context, const void *row)
{
    const sgt_wavefront_row *r = row;
    squares *s = context;
    double weight = 1;
    for (size_t i = 0; s->lens->wavelength && i < s->lens->wavelengths; i++)
        if (s->lens->wavelength[i] == r->wavelength) weight = s->lens->wavelength_weight[i];
    add_square(s, r->field, weight, r->rms);
}

static bool run_figure(const sgt_tolerancing *t, squares *s, sgt_error *error)
{
    static const struct { const char *analysis; void (*row)(void *context, const void *row); } of[] = {
        [SGT_TOLERANCING_SPOT] = {"spot", add_spot},
        [SGT_TOLERANCING_OPD] = {"wavefront", add_wavefront},
        [SGT_TOLERANCING_BORESIGHT] = {"spot", add_boresight}};
    const sgt_spot_options of_spot = {.reference = t->opt.reference};
    const sgt_sink sink = {.context = s, .row = of[t->opt.figure].row};
    sgt_study *study = sgt_study_new(s->lens, &t->study, error);
    if (study) study->rms_alone = true; /* a third of the time */
    const void *options = t->opt.figure == SGT_TOLERANCING_OPD ? NULL : &of_spot;
    const bool fine = study && sgt_study_run(study, sgt_analysis_named(of[t->opt.figure].analysis), options,
                                             &sink, NULL, error);
    sgt_study_free(study);
    return fine;
}

bool sgt_figure_of(const sgt_tolerancing *t, const sgt_lens *lens, double *figure, sgt_error *error)
{
    squares s = {.t = t, .lens = lens};
    const bool fine = run_figure(t, &s, error);
    *figure = fine ? sqrt(s.sum / s.weight) : (double)NAN;
    return fine;
}

bool sgt_figure_begin(sgt_tolerancing *t, sgt_error *error)
{
    static const sgt_pattern centre = SGT_PATTERN_FAN;
    if (t->opt.figure == SGT_TOLERANCING_BORESIGHT) {
        const size_t fields = t->study.fields ? t->study.fields : t->of->fields;
        squares s = {.t = t, .lens = t->base};
        t->opt.reference = 0; /* the chief ray, alone: no other is needed */
        t->study.pattern = &centre, t->study.rays = 1, t->study.points = 0, t->study.across = 0;
        t->chief = s.chief = sgt_arena_take(&t->memory, fields * sizeof *t->chief);
        if (!t->chief || !run_figure(t, &s, error)) return false;
    }
    return sgt_figure_of(t, t->base, &t->nominal, error);
}

/* --------------------------------------------------------------------- compensators */

typedef struct search_at {
    const sgt_tolerancing *t;
    sgt_lens *lens;
    double *value;
    sgt_error *error;
    bool failed;
} search_at;

/* A lens that has no figure, because it has no rays, say, is worse than any. */
static double square_at(search_at *s, size_t i, double x)
{
    double f;
    s->value[i] = x;
    if (s->failed || !sgt_build_at(s->t, s->lens, s->value, s->error)) {
        s->failed = true;
        return HUGE_VAL;
    }
    if (!sgt_figure_of(s->t, s->lens, &f, s->error)) s->failed = strcmp(s->error->words, "no memory") == 0;
    return isnan(f) ? HUGE_VAL : f * f;
}

typedef struct tried {
    double x, f;
} tried;

static void sort_tried(tried p[4])
{
    for (int i = 1; i < 4; i++)
        for (int k = i; k > 0 && p[k].f < p[k - 1].f; k--) {
            const tried one = p[k];
            p[k] = p[k - 1], p[k - 1] = one;
        }
}

/* The least of the parabola through three points, and its value there; NaN: it has none. */
static tried parabola(const tried p[3])
{
    const double x0 = p[0].x, a = p[1].x - x0, b = p[2].x - x0, fa = p[1].f - p[0].f, fb = p[2].f - p[0].f;
    const double bend = (fb / b - fa / a) / (b - a), slope = fa / a - bend * a;
    const double step = -slope / (2 * bend);
    if (!(bend > 0) || !isfinite(step)) return (tried){(double)NAN, (double)NAN};
    return (tried){x0 + step, p[0].f + slope * step / 2};
}

static double in_box(const sgt_tolerance *e, double x) { return fmin(fmax(x, e->lower), e->upper); }

/* Sets value[i] to the best; returns the square there.  It begins at value[i]. */
static double seek(search_at *s, size_t i)
{
    enum { BUDGET = 20 };
    const sgt_tolerance *e = &s->t->entry[i];
    const double x0 = s->value[i], range = e->upper - e->lower, first = range / 8;
    tried p[4] = {{.x = x0}, {.x = in_box(e, x0 + first)}, {.x = in_box(e, x0 - first)}, {.f = HUGE_VAL}};
    if (p[1].x == x0) p[1].x = x0 - 2 * first;
    if (p[2].x == x0) p[2].x = x0 + 2 * first;
    for (int k = 0; k < 3; k++) p[k].f = square_at(s, i, p[k].x);
    sort_tried(p);
    for (int n = 0; n < BUDGET && !s->failed; n++) {
        tried next = parabola(p);
        const double foretold = next.f;
        if (isnan(next.x)) /* downhill, or where there are figures */
            next.x = isfinite(p[1].f) ? p[0].x + 2 * (p[0].x - p[1].x) : (p[0].x + p[1].x) / 2;
        const bool inside = next.x > e->lower && next.x < e->upper;
        next.x = in_box(e, next.x);
        /* at the end of its range, or no nearer than its last digits: it stays there */
        if (fabs(next.x - p[0].x) <= 1e-12 * range) break;
        next.f = square_at(s, i, next.x);
        p[3] = next;
        sort_tried(p);
        if (inside && fabs(next.f - foretold) <= FORETOLD * fabs(next.f)) break;
        p[3].f = HUGE_VAL;
    }
    s->value[i] = p[0].x;
    return p[0].f;
}

static bool paraxial_image(const sgt_lens *lens, double *image, sgt_error *error)
{
    sgt_first_order data;
    if (!sgt_lens_first_order(lens, (double)NAN, &data, NULL, error)) return false;
    *image = data.image;
    return true;
}

bool sgt_figure_at(const sgt_tolerancing *t, sgt_lens *lens, double value[], double *figure, sgt_error *error)
{
    enum { ROUNDS = 10 };
    search_at s = {.t = t, .lens = lens, .value = value, .error = error};
    size_t sought = 0, last = 0;
    for (size_t i = 0; i < t->count; i++) {
        if (t->entry[i].compensator) value[i] = 0;
        if (t->entry[i].compensator == SGT_COMPENSATE_FIGURE) sought++, last = i;
    }
    for (size_t i = 0; i < t->count; i++) {
        double image;
        if (t->entry[i].compensator != SGT_COMPENSATE_PARAXIAL) continue;
        if (!sgt_build_at(t, lens, value, error) || !paraxial_image(lens, &image, error)) return false;
        const double way = image - t->image;
        value[i] = isfinite(way) ? in_box(&t->entry[i], way) : 0;
    }
    double before = HUGE_VAL, now = HUGE_VAL;
    for (int round = 0; round < ROUNDS && sought && !s.failed; round++) {
        for (size_t i = 0; i < t->count; i++)
            if (t->entry[i].compensator == SGT_COMPENSATE_FIGURE) now = seek(&s, i);
        if (sought == 1 || !(before - now > FORETOLD * now)) break;
        before = now;
    }
    if (!sought) now = square_at(&s, last, t->count ? value[last] : 0);
    *figure = isfinite(now) ? sqrt(now) : (double)NAN;
    return !s.failed;
}
