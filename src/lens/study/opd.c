// SPDX-License-Identifier: MIT
/* opd.c - optical path differences in waves: ray by ray, summed up, or fitted by polynomials.
 *
 * Each wavelength has its own chief ray and so its own reference; the exit pupil is that of the primary one.
 */
#include "analyses.h"
#include "study.h"
#include "wavefront.h"
#include "zernike_fit.h"

#include <stdio.h>
#include <string.h>

/* What of an end makes a difference, and how far it is off. */
enum { OPD_OF_END = END_POINT | END_PATH, OPD_ERROR = END_POINT_ERROR | END_PATH_ERROR };

/* Chief rays at each wavelength, and what is to be made of the rays: cells are field * bands + band. */
typedef struct opds {
    sgt_asking *ask;
    bool afocal;
    size_t cells;
    sgt_reference *about;
    bool *there;
    double *scale;              /* [bands]: waves of a length */
    size_t *without;            /* [cells]: rays that passed and have no difference */
    sgt_wavefront_sum *sum;     /* [cells] */
    sgt_fates *fates;           /* [cells] */
    struct zernike_work *zernike;
} opds;

typedef struct differences {
    double waves[PUPIL_PART], error[PUPIL_PART];
    size_t without;             /* rays that passed and have none */
} differences;

/* The same, summed up. */
typedef struct summed { sgt_wavefront_sum sum; size_t without; } summed;

static bool opd_chief(void *data, size_t i, void *slot)
{
    const opds *w = data;
    const sgt_asking *a = w->ask;
    const band *b = &a->band[i % a->bands];
    return sgt_trace_chief(a->from, &a->beam[i / a->bands], b->element, b->before, slot, NULL);
}

static void opd_keep_chief(void *data, size_t i, void *slot)
{
    opds *w = data;
    const sgt_asking *a = w->ask;
    const band *b = &a->band[i % a->bands];
    w->there[i] = sgt_reference_of(a->lens, &a->primary.data, b->element, b->before, slot, w->afocal,
                                   &w->about[i], NULL);
}

/* A wave is a length: both have to be known. */
static bool opd_check(sgt_asking *a, bool afocal)
{
    const char *units = a->lens->units;
    for (size_t b = 0; b < a->bands; b++)
        if (isnan(a->band[b].at.um))
            return sgt_ask_fail(a, "wavelengths",
                                "the lens gives none, and the differences are told in waves: "
                                "give a wavelength");
    if (isnan(a->study->um))
        return sgt_ask_fail(a, "units", "must be mm, cm, m, um or in for differences in waves%s%s",
                            *units ? ", not " : "; it is missing", units);
    for (size_t i = 0; i + 1 < a->lens->count; i++) {
        const sgt_phase *p = a->lens->element[i].phase;
        if (p && p->kind == SGT_FACETS)
            return sgt_ask_fail(a, "facets",
                                "facets (element %zu) give light no wavefront, so there are no path "
                                "differences",
                                i + 1);
        if (p && p->focal_length_y != 0 && p->focal_length_y != p->focal_length)
            sgt_ask_say(a, SGT_STUDY_NOTE,
                        "element %zu, an ideal lens of two powers: it gives light no wavefront, "
                        "and paths beside its two sections are a convention",
                        i + 1);
    }
    if (!afocal && !isfinite(a->primary.data.exit_pupil))
        sgt_ask_say(a, SGT_STUDY_NOTE, "the exit pupil is at infinity or not known (sagitta info): the "
                                       "reference sphere has an infinite radius");
    return true;
}

static bool opds_begin(sgt_asking *a, opds *w)
{
    const sgt_opd_options *o = a->options;
    *w = (opds){.ask = a, .afocal = o->afocal || a->lens->afocal, .cells = a->fields * a->bands};
    if (!opd_check(a, w->afocal)) return false;
    w->about = sgt_ask_room(a, w->cells, sizeof *w->about);
    w->there = sgt_ask_room(a, w->cells, sizeof *w->there);
    w->scale = sgt_ask_room(a, a->bands, sizeof *w->scale);
    w->without = sgt_ask_room(a, w->cells, sizeof *w->without);
    if (a->failed) return false;
    for (size_t b = 0; b < a->bands; b++) w->scale[b] = a->study->um / a->band[b].at.um;
    const rounds r = {.tasks = w->cells, .size = sizeof(sgt_ray_end), .data = w, .work = opd_chief,
                      .take = opd_keep_chief};
    return sgt_ask_rounds(a, &r);
}

static void opd_block(const pass *p, size_t i, size_t count, sgt_ray_end end[], void *sum)
{
    const opds *w = p->data;
    differences *d = sum;
    const double scale = w->scale[i % p->ask->bands];
    for (size_t k = 0; k < count; k++) {
        d->waves[k] = d->error[k] = (double)NAN;
        if (!w->there[i]) continue;
        d->waves[k] = scale * sgt_opd(&w->about[i], &end[k], &d->error[k]);
        d->error[k] *= scale;
    }
    for (size_t k = 0; k < count; k++) d->without += end[k].fate == SGT_PASSED && isnan(d->waves[k]);
}

/* "field 2", and the wavelength where there are several. */
static void opd_say(const opds *w, size_t i, const char *words)
{
    const sgt_asking *a = w->ask;
    const size_t number = a->number[i / a->bands];
    if (a->bands == 1) sgt_ask_say(a, SGT_STUDY_NOTE, "field %zu: %s", number, words);
    else
        sgt_ask_say(a, SGT_STUDY_NOTE, "field %zu, %.6g \302\265m: %s", number, a->band[i % a->bands].at.um,
                    words);
}

/* Says why cells of rays that passed are empty. */
static void opd_say_empty(const opds *w, size_t i)
{
    char words[200];
    const size_t without = w->without[i];
    snprintf(words, sizeof words,
             "%zu ray%s passed and %s no path difference: the reference sphere is missed, "
             "or has no radius",
             without, without == 1 ? "" : "s", without == 1 ? "has" : "have");
    if (!w->there[i]) opd_say(w, i, "the chief ray does not get through, so there is no reference");
    else if (without) opd_say(w, i, words);
}

static pass opd_pass(sgt_asking *a, opds *w, const sgt_pupil *points)
{
    return (pass){.ask = a, .points = points, .cells = w->cells, .wanted = OPD_OF_END | OPD_ERROR,
                  .data = w, .size = sizeof(differences), .place = sgt_place_study,
                  .lost = sgt_lost_study, .block = opd_block};
}

static void opd_say_legend(const opds *w)
{
    const sgt_asking *a = w->ask;
    sgt_ask_say(a, SGT_STUDY_LEGEND, "In waves; positive: the path is longer than the chief ray's to the "
                                     "reference %s.",
                w->afocal                           ? "plane"
                : isfinite(a->primary.data.exit_pupil) ? "sphere"
                                                    : "sphere, of infinite radius");
}

/* ------------------------------------------------------------------ ray by ray */

static void opd_take(const pass *p, size_t i, size_t count, const sgt_ray_end end[], const void *sum)
{
    opds *w = p->data;
    const sgt_asking *a = p->ask;
    const differences *d = sum;
    w->without[i] += d->without;
    for (size_t k = 0; k < count; k++) {
        const sgt_opd_row row = {.field = a->number[i / a->bands], .wavelength = a->band[i % a->bands].at.um,
                                 .px = end[k].px, .py = end[k].py, .fate = sgt_fate_of(&end[k]),
                                 .opd = d->waves[k], .opd_err = d->error[k]};
        sgt_ask_row(a, &row);
    }
}

static void opd_end(const pass *p, size_t i, const sgt_fates *fates, void *sum)
{
    (void)fates, (void)sum;
    opd_say_empty(p->data, i);
}

static bool ask_opd(sgt_asking *a)
{
    opds w;
    if (!opds_begin(a, &w)) return false;
    pass p = opd_pass(a, &w, &a->fine);
    p.take = opd_take, p.end = opd_end, p.takes_ends = true;
    opd_say_legend(&w);
    return sgt_ask_pass(&p);
}

/* ------------------------------------------------------------------- summed up */

static void front_block(const pass *p, size_t i, size_t count, sgt_ray_end end[], void *sum)
{
    differences d = {.without = 0};
    summed *f = sum;
    opd_block(p, i, count, end, &d);
    f->without = d.without;
    sgt_wavefront_add(&f->sum, count, end, d.waves, d.error);
}

static void front_merge(const void *p, void *into, const void *more)
{
    summed *f = into;
    const summed *other = more;
    (void)p;
    f->without += other->without;
    sgt_wavefront_merge(&f->sum, &other->sum);
}

static void front_end(const pass *p, size_t i, const sgt_fates *fates, void *sum)
{
    opds *w = p->data;
    const summed *f = sum;
    w->fates[i] = *fates, w->without[i] = f->without;
    memcpy(&w->sum[i], &f->sum, sizeof f->sum);
}

static bool front_sums(sgt_asking *a, opds *w, const sgt_pupil *points, bool counts)
{
    pass p = opd_pass(a, w, points);
    w->sum = sgt_ask_room(a, w->cells, sizeof *w->sum);
    w->fates = sgt_ask_room(a, w->cells, sizeof *w->fates);
    a->counts = counts;
    if (!counts || a->study->rms_alone) p.wanted = OPD_OF_END; /* coarse: for its rms alone */
    p.size = sizeof(summed), p.block = front_block, p.merge = front_merge, p.end = front_end;
    p.exact = true;
    return !a->failed && sgt_ask_pass(&p);
}

static bool ask_wavefront(sgt_asking *a)
{
    opds w;
    if (!opds_begin(a, &w) || !front_sums(a, &w, &a->coarse, false)) return false;
    const sgt_wavefront_sum *coarse = w.sum;
    if (!front_sums(a, &w, &a->fine, true)) return false;
    for (size_t i = 0; i < w.cells; i++) {
        const sgt_wavefront front = sgt_wavefront_sum_of(&w.sum[i]), half = sgt_wavefront_sum_of(&coarse[i]);
        const sgt_wavefront_row row = {
            .field = a->number[i / a->bands], .wavelength = a->band[i % a->bands].at.um,
            .pv = front.most - front.least, .rms = front.rms,
            .digits = sgt_digits(front.rms, sgt_wavefront_rms_error(&w.sum[i])),
            .sampling = front.rms - half.rms, .rays = w.fates[i].rays, .passed = w.fates[i].passed,
            .fates = sgt_fates_row(&w.fates[i]), .rms_err = front.error};
        opd_say_empty(&w, i);
        sgt_ask_row(a, &row);
    }
    opd_say_legend(&w);
    return true;
}

/* ----------------------------------------------------------------- polynomials */

enum { TERMS = 37, TERMS_MOST = ZERNIKE_TERMS_MOST };

/* The order and the azimuthal frequency of a polynomial, counted from 1 (surfaces.h has the sources). */
static void zernike_numbers(int order, size_t term, size_t *n, double *m)
{
    size_t q = 0, left = term - 1, frequency;
    if (order == SGT_FRINGE) { /* groups of 2 q + 1 with n + m = 2 q, m = q, q, q - 1, ... */
        for (; left > 2 * q; q++) left -= 2 * q + 1;
        frequency = q - left / 2;
        *m = left % 2 ? -(double)frequency : (double)frequency;
        *n = 2 * q - frequency;
        return;
    }
    for (; left > q; q++) left -= q + 1; /* Noll: orders n = q; |m| grows, even terms are cosines */
    frequency = q % 2 ? 1 + 2 * (left / 2) : 2 * ((left + 1) / 2);
    *n = q, *m = term % 2 ? -(double)frequency : (double)frequency;
    if (frequency == 0) *m = 0;
}

static size_t terms_of(const opds *w)
{
    const sgt_opd_options *o = w->ask->options;
    return o->terms ? o->terms : TERMS;
}

static sgt_zernike_order order_of(const opds *w)
{
    const sgt_opd_options *o = w->ask->options;
    return o->order ? SGT_FRINGE : SGT_NOLL;
}

/* Many rays are fitted by sums, in threads, about a fit of some rays of each cell; others, and cells where
 * these are not like the rest, by blocks (zernike_fit.c). */
enum { SAMPLE = 16, WORTH = 256, SUMS_MOST = 127 }; /* rays, a term; terms, so that sums are small */

typedef struct zernike_work {
    size_t terms, cells;
    bool *fits, *pending;       /* [cells]: pending, to be fitted by blocks */
    double *residual;           /* [cells] */
    double *coefficient;        /* [cells * terms] */
    zernike_triangle own, *about; /* of the cell that is fitted by blocks; [cells], of the sample */
    double *own_room;
    zernike_block block;
} zernike_work;

/* The rows of a block of ends. */
static void zernike_block_in(const opds *w, size_t count, const sgt_ray_end end[], const differences *d,
                             zernike_block *out)
{
    double x[PUPIL_PART], y[PUPIL_PART], weight[PUPIL_PART];
    for (size_t k = 0; k < count; k++) x[k] = end[k].px, y[k] = end[k].py, weight[k] = end[k].weight;
    sgt_zernike_block_of(order_of(w), terms_of(w), count, x, y, d->waves, weight, out);
}

static void zernike_take(const pass *p, size_t i, size_t count, const sgt_ray_end end[], const void *sum)
{
    opds *w = p->data;
    zernike_work *z = w->zernike;
    const differences *d = sum;
    if (p->ask->counts) w->without[i] += d->without;
    if (!z->pending[i]) return;
    zernike_block_in(w, count, end, d, &z->block);
    sgt_zernike_absorb(&z->own, &z->block);
}

static void zernike_end(const pass *p, size_t i, const sgt_fates *fates, void *sum)
{
    const opds *w = p->data;
    zernike_work *z = w->zernike;
    (void)fates, (void)sum;
    if (z->pending[i])
        z->fits[i] = sgt_zernike_solve(&z->own, z->coefficient + i * z->terms, &z->residual[i]);
    z->own = sgt_zernike_triangle_in(z->terms, z->own_room);
}

/* The same of a sample: its triangle is kept. */
static void sample_take(const pass *p, size_t i, size_t count, const sgt_ray_end end[], const void *sum)
{
    const opds *w = p->data;
    zernike_work *z = w->zernike;
    zernike_block_in(w, count, end, sum, &z->block);
    sgt_zernike_absorb(&z->about[i], &z->block);
}

static void sample_end(const pass *p, size_t i, const sgt_fates *fates, void *sum)
{
    const opds *w = p->data;
    zernike_work *z = w->zernike;
    (void)fates, (void)sum;
    z->pending[i] = !sgt_zernike_solve(&z->about[i], z->coefficient + i * z->terms, NULL);
}

/* The sums of a block: how many rays passed and have no difference, then those of zernike_fit.h. */
static void sums_block(const pass *p, size_t i, size_t count, sgt_ray_end end[], void *sum)
{
    const opds *w = p->data;
    const zernike_work *z = w->zernike;
    double *without = sum;
    zernike_block b = {.column = without + 1 + sgt_zernike_sums_room(z->terms)};
    differences d = {.without = 0};
    opd_block(p, i, count, end, &d);
    *without = (double)d.without;
    if (z->pending[i]) return;
    zernike_block_in(w, count, end, &d, &b);
    sgt_zernike_sums(&z->about[i], z->coefficient + i * z->terms, &b, without + 1);
}

static void sums_merge(const void *of, void *into, const void *more)
{
    const pass *p = of;
    double *to = into;
    const double *other = more;
    for (size_t k = 0; k < p->size / sizeof *to; k++) to[k] += other[k];
}

static void sums_end(const pass *p, size_t i, const sgt_fates *fates, void *sum)
{
    opds *w = p->data;
    zernike_work *z = w->zernike;
    double *without = sum;
    (void)fates;
    w->without[i] = (size_t)*without;
    if (z->pending[i]) return;
    z->fits[i] = sgt_zernike_joined(&z->about[i], without + 1, z->coefficient + i * z->terms,
                                    &z->residual[i]);
    z->pending[i] = !z->fits[i];
}

static bool zernike_begin(opds *w, zernike_work *z)
{
    sgt_asking *a = w->ask;
    const size_t terms = terms_of(w);
    *z = (zernike_work){.terms = terms, .cells = w->cells};
    z->fits = sgt_ask_room(a, w->cells, sizeof *z->fits);
    z->pending = sgt_ask_room(a, w->cells, sizeof *z->pending);
    z->residual = sgt_ask_room(a, w->cells, sizeof *z->residual);
    z->coefficient = sgt_ask_room(a, w->cells * terms, sizeof *z->coefficient);
    z->own_room = sgt_ask_room(a, sgt_zernike_triangle_room(terms), sizeof *z->own_room);
    z->block.column = sgt_ask_room(a, sgt_zernike_block_room(terms), sizeof *z->block.column);
    if (a->failed) return false;
    z->own = sgt_zernike_triangle_in(terms, z->own_room);
    for (size_t i = 0; i < w->cells; i++) z->pending[i] = true;
    w->zernike = z;
    return true;
}

/* By sums: leaves `pending` the cells that it does not fit. */
static bool zernike_by_sums(opds *w, zernike_work *z)
{
    sgt_asking *a = w->ask;
    const size_t triangle = sgt_zernike_triangle_room(z->terms);
    const size_t across = (size_t)ceil(sqrt(1.28 * SAMPLE * (double)z->terms)); /* 4 / pi: in the circle */
    size_t *row = sgt_ask_room(a, sgt_pupil_rows(SGT_PATTERN_CELLS, across) + 1, sizeof *row);
    double *rooms = sgt_ask_room(a, w->cells * triangle, sizeof *rooms);
    z->about = sgt_ask_room(a, w->cells, sizeof *z->about);
    if (a->failed) return false;
    for (size_t i = 0; i < w->cells; i++)
        z->about[i] = sgt_zernike_triangle_in(z->terms, rooms + i * triangle);
    const sgt_pupil sample = sgt_pupil_of(SGT_PATTERN_CELLS, across, 1, row);
    pass p = opd_pass(a, w, &sample);
    p.wanted = OPD_OF_END, p.takes_ends = true, p.take = sample_take, p.end = sample_end, p.before = true;
    a->counts = false;
    if (!sgt_ask_pass(&p)) return false;
    a->counts = true;
    p = opd_pass(a, w, &a->fine);
    p.wanted = OPD_OF_END;
    p.size = (1 + sgt_zernike_sums_room(z->terms)) * sizeof(double);
    p.spare = sgt_zernike_block_room(z->terms) * sizeof(double);
    p.block = sums_block, p.merge = sums_merge, p.end = sums_end;
    if (!sgt_ask_pass(&p)) return false;
    a->counts = false;
    return true;
}

/* By blocks: the cells that are pending; `rest`: those that sums have left. */
static bool zernike_by_blocks(opds *w, bool rest)
{
    pass p = opd_pass(w->ask, w, &w->ask->fine);
    p.alone = rest;
    p.wanted = OPD_OF_END, p.takes_ends = true, p.take = zernike_take, p.end = zernike_end;
    return sgt_ask_pass(&p);
}

static void zernike_rows(const opds *w, size_t i)
{
    const sgt_asking *a = w->ask;
    const zernike_work *z = w->zernike;
    const double *coefficient = z->coefficient + i * z->terms;
    char words[200];
    opd_say_empty(w, i);
    snprintf(words, sizeof words,
             "the rays that passed do not determine %zu polynomials; take more rays, or fewer terms",
             z->terms);
    if (!z->fits[i]) opd_say(w, i, words);
    for (size_t k = 0; k < z->terms; k++) {
        sgt_zernike_row row = {.field = a->number[i / a->bands],
                               .wavelength = a->band[i % a->bands].at.um, .term = k + 1,
                               .coefficient = z->fits[i] ? coefficient[k] : (double)NAN,
                               .residual = z->fits[i] ? z->residual[i] : (double)NAN};
        zernike_numbers((int)order_of(w), k + 1, &row.n, &row.m);
        sgt_ask_row(a, &row);
    }
}

static bool ask_zernike(sgt_asking *a)
{
    const sgt_opd_options *o = a->options;
    opds w;
    if (o->terms > TERMS_MOST)
        return sgt_ask_refuse(a, "terms", "%zu polynomials; at most %d", o->terms, TERMS_MOST);
    if (!opds_begin(a, &w)) return false;
    zernike_work z;
    if (!zernike_begin(&w, &z)) return false;
    const bool sums = z.terms <= SUMS_MOST && a->fine.count >= WORTH * z.terms;
    if (sums && !zernike_by_sums(&w, &z)) return false;
    bool some = false;
    for (size_t i = 0; i < w.cells; i++) some = some || z.pending[i];
    if (some && !zernike_by_blocks(&w, sums)) return false;
    for (size_t i = 0; i < w.cells; i++) zernike_rows(&w, i);
    opd_say_legend(&w);
    sgt_ask_say(a, SGT_STUDY_LEGEND, "Zernike polynomials in %s over px, py.",
                o->order ? "fringe order, each 1 at the edge"
                         : "Noll's order, each with a mean square of 1");
    return true;
}

/* ---------------------------------------------------------------------- tables */

#define RAY(member) offsetof(sgt_opd_row, member)
static const sgt_column opd_columns[] = {
    COLUMN_FIELD(sgt_opd_row),
    COLUMN_WAVELENGTH(sgt_opd_row, SGT_COLUMN_GROUPS),
    COLUMN_PUPIL(sgt_opd_row, px, py),
    COLUMN_OF_FATE(sgt_opd_row),
    {.name = "opd", SGT_COLUMN_NUMBER, SGT_UNIT_WAVE, 0, RAY(opd), RAY(opd_err), "the difference"},
    {.name = "opd_err", SGT_COLUMN_ERROR, SGT_UNIT_WAVE, 0, RAY(opd_err), 0,
     "and how far rounding may have put it off"},
};

#define FRONT(member) offsetof(sgt_wavefront_row, member)
static const sgt_column wavefront_columns[] = {
    {.name = "field", SGT_COLUMN_COUNT, SGT_UNIT_NONE, 0, FRONT(field), 0, "the field, counted from 1"},
    COLUMN_WAVELENGTH(sgt_wavefront_row, 0),
    {.name = "pv", SGT_COLUMN_NUMBER, SGT_UNIT_WAVE, 0, FRONT(pv), FRONT(rms_err), "largest less smallest"},
    {.name = "rms", SGT_COLUMN_NUMBER, SGT_UNIT_WAVE, 0, FRONT(rms), FRONT(rms_err),
     "root of the mean square about the mean"},
    {.name = "digits", SGT_COLUMN_COUNT, SGT_UNIT_NONE, 0, FRONT(digits), 0,
     "so many decimal digits of rms are certain in spite of rounding"},
    {.name = "sampling", SGT_COLUMN_ERROR, SGT_UNIT_WAVE, 0, FRONT(sampling), 0,
     "rms, less that of half as many rays across the pupil"},
    {.name = "rays", SGT_COLUMN_COUNT, SGT_UNIT_NONE, 0, FRONT(rays), 0, "how many were sent"},
    {.name = "passed", SGT_COLUMN_COUNT, SGT_UNIT_NONE, 0, FRONT(passed), 0, "how many reached the image"},
    COLUMN_FATES(sgt_wavefront_row),
};

#define TERM(member) offsetof(sgt_zernike_row, member)
static const sgt_column zernike_columns[] = {
    COLUMN_FIELD(sgt_zernike_row),
    COLUMN_WAVELENGTH(sgt_zernike_row, SGT_COLUMN_GROUPS),
    {.name = "term", SGT_COLUMN_COUNT, SGT_UNIT_NONE, 0, TERM(term), 0, "the number of the polynomial,"},
    {.name = "n", SGT_COLUMN_COUNT, SGT_UNIT_NONE, 0, TERM(n), 0, "its order,"},
    {.name = "m", SGT_COLUMN_WHOLE, SGT_UNIT_NONE, 0, TERM(m), 0,
     "its azimuthal frequency: positive of cosines, negative of sines; the angle is from px toward py"},
    {.name = "coefficient", SGT_COLUMN_NUMBER, SGT_UNIT_WAVE, 0, TERM(coefficient), 0, "by least squares"},
    {.name = "residual", SGT_COLUMN_NUMBER, SGT_UNIT_WAVE, 0, TERM(residual), 0,
     "root of the mean square of what the fit leaves"},
};

#define AFOCAL_SETTING                                                                                      \
    {                                                                                                       \
        .name = "afocal", SGT_SETTING_FLAG, offsetof(sgt_opd_options, afocal), NULL, 0, 0,                  \
            "for light that leaves as parallel rays: against a plane across the chief ray (the default if " \
            "the lens "                                                                                     \
            "says `afocal: true`)"                                                                          \
    }
static const sgt_setting opd_settings[] = {AFOCAL_SETTING};
static const sgt_setting zernike_settings[] = {
    AFOCAL_SETTING,
    {.name = "terms", SGT_SETTING_COUNT, offsetof(sgt_opd_options, terms), NULL, 1, TERMS_MOST,
     "how many polynomials (default 37)"},
    {.name = "order", SGT_SETTING_WORD, offsetof(sgt_opd_options, order), "noll|fringe", 0, 0,
     "noll (the default; Noll 1976; each has the mean square 1), or fringe (Wyant and Creath 1992; each is 1 "
     "at the edge)"},
};

#define OPD_HELP                                                                                            \
    "the path of a ray to the reference sphere, less that of the chief ray of the same wavelength.  "       \
    "Positive: "                                                                                            \
    "the ray's path is longer.\n\nThe sphere is about the point where the chief ray meets the image.  Its " \
    "radius "                                                                                               \
    "is the distance from there to the centre of the paraxial exit pupil (primary wavelength).  If that "   \
    "pupil is "                                                                                             \
    "at infinity, paths end at the foot of the perpendicular from the point on the ray."

const sgt_analysis sgt_opd_analysis = {
    .name = "opd", .title = "optical path differences",
    .help = "Optical path differences of the rays of a field, in waves: " OPD_HELP,
    .pattern = SGT_PATTERN_CROSS, .rays = 41, .draw_x = "py", .draw_y = "opd",
    ROWS_OF(sgt_opd_row, opd_columns), OPTIONS_OF(sgt_opd_options), SETTINGS_OF(opd_settings),
    .ask = ask_opd};

const sgt_analysis sgt_wavefront_analysis = {
    .name = "wavefront", .title = "wavefronts", .part_of = "opd",
    .help = "Wavefronts, summed up over an area of the pupil, in waves: " OPD_HELP,
    .pattern = SGT_PATTERN_CELLS, .rays = 32, ROWS_OF(sgt_wavefront_row, wavefront_columns),
    OPTIONS_OF(sgt_opd_options), SETTINGS_OF(opd_settings), .ask = ask_wavefront};

const sgt_analysis sgt_zernike_analysis = {
    .name = "zernike", .title = "Zernike polynomials", .part_of = "opd",
    .help = "Zernike polynomials, fitted to path differences over an area of the pupil, in waves: " OPD_HELP,
    .pattern = SGT_PATTERN_CELLS, .rays = 32, ROWS_OF(sgt_zernike_row, zernike_columns),
    OPTIONS_OF(sgt_opd_options), SETTINGS_OF(zernike_settings), .ask = ask_zernike};
