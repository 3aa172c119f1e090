// SPDX-License-Identifier: MIT
/* spot.c - the spot of rays at the last element.
 *
 * SUMS over rays are exact (exact.h): products with weights and squares of distances are not rounded, so
 * neither blocks nor their order have a part in a bit.  About the centroid the rays are traced twice: the
 * largest distance from a point needs the point.
 *
 * ERROR.  An rms is a norm of the distances, each weighted: if each point is off by p_err, it is off by
 * the same norm of the p_err at most (the triangle inequality).  So is the centroid, by their mean, and
 * hence the rms about it by no more.  What is left is rounding, in units of 2^-53 of the rms: that of a
 * distance counts once, that of the three sums half each, and of their sum, quotient and root half, half and
 * one; for wavelengths together two for each.
 *
 * DIGITS is what rounding leaves certain of the rms; SAMPLING is another matter: how much the rms changes if
 * half as many rays across the pupil are taken. */
#include "run.h"
#include "spot.h"

#include <string.h>

/* ---------------------------------------------------------------------- sums */

/* Rays of one weight: their number, and what was not added yet. */
typedef struct same_weight { double w; size_t rays; exact_run first, second, off; } same_weight;

static void middle_end_of(same_weight *r, middle_sum *m)
{
    sgt_exact_run_end(&r->first, &m->x, r->w), sgt_exact_run_end(&r->second, &m->y, r->w);
    sgt_exact_run_end(&r->off, &m->off, r->w), exact_add_product(&m->w, (double)r->rays, r->w);
    r->rays = 0;
}

void sgt_middle_add(middle_sum *m, sgt_vec2 from, size_t count, const sgt_ray_end end[])
{
    same_weight r = {.first = RUN_OF_FIRST, .second = RUN_OF_FIRST, .off = RUN_OF_FIRST};
    for (size_t i = 0; i < count; i++) {
        const sgt_ray_end *e = &end[i];
        if (e->fate != SGT_PASSED) continue;
        if (e->weight != r.w || r.rays == RUN_MOST) middle_end_of(&r, m), r.w = e->weight;
        r.rays++;
        exact_run_add(&r.first, &m->x, r.w, e->p.x - from.x);
        exact_run_add(&r.second, &m->y, r.w, e->p.y - from.y);
        exact_run_add(&r.off, &m->off, r.w, e->p_err);
    }
    middle_end_of(&r, m);
}

void sgt_middle_merge(middle_sum *m, const middle_sum *more)
{
    sgt_exact_merge(&m->w, &more->w), sgt_exact_merge(&m->off, &more->off);
    sgt_exact_merge(&m->x, &more->x), sgt_exact_merge(&m->y, &more->y);
}

spot_middle sgt_middle_rounded(const middle_sum *m)
{
    return (spot_middle){sgt_exact_value(&m->w, NULL), sgt_exact_value(&m->x, NULL),
                         sgt_exact_value(&m->y, NULL), sgt_exact_value(&m->off, NULL)};
}

void sgt_middle_join(spot_middle *m, const spot_middle *more, double weight)
{
    if (weight == 0) return;
    m->w += weight * more->w, m->x += weight * more->x, m->y += weight * more->y;
    m->off += weight * more->off;
}

sgt_vec2 sgt_middle_of(const spot_middle *m)
{
    const double none = (double)NAN;
    return m->w > 0 ? (sgt_vec2){m->x / m->w, m->y / m->w} : (sgt_vec2){none, none};
}

/* Of the square of the largest distance: below it a distance is less, however the squares are rounded. */
static const double NEARER = 0.999;

static void spread_end_of(same_weight *r, spread_sum *s)
{
    sgt_exact_run_end(&r->first, &s->x2, r->w), sgt_exact_run_end(&r->second, &s->y2, r->w);
    sgt_exact_run_end(&r->off, &s->off, r->w), exact_add_product(&s->w, (double)r->rays, r->w);
    r->rays = 0;
}

void sgt_spread_add(spread_sum *s, sgt_vec2 about, size_t count, const sgt_ray_end end[])
{
    same_weight r = {.first = RUN_OF_SQUARE, .second = RUN_OF_SQUARE, .off = RUN_OF_SQUARE};
    s->rays += count;
    for (size_t i = 0; i < count; i++) {
        const sgt_ray_end *e = &end[i];
        if (e->fate != SGT_PASSED) continue;
        const double x = e->p.x - about.x, y = e->p.y - about.y;
        if (e->weight != r.w || r.rays == RUN_MOST) spread_end_of(&r, s), r.w = e->weight;
        r.rays++, s->passed++;
        exact_run_square(&r.first, &s->x2, r.w, x), exact_run_square(&r.second, &s->y2, r.w, y);
        exact_run_square(&r.off, &s->off, r.w, e->p_err);
        if (!(x * x + y * y < NEARER * s->far * s->far)) s->far = fmax(s->far, hypot(x, y));
    }
    spread_end_of(&r, s);
}

void sgt_spread_merge(spread_sum *s, const spread_sum *more)
{
    s->rays += more->rays, s->passed += more->passed, s->far = fmax(s->far, more->far);
    sgt_exact_merge(&s->w, &more->w), sgt_exact_merge(&s->off, &more->off);
    sgt_exact_merge(&s->x2, &more->x2), sgt_exact_merge(&s->y2, &more->y2);
}

spot_spread sgt_spread_rounded(const spread_sum *s)
{
    return (spot_spread){.rays = s->rays, .passed = s->passed, .far = s->far,
                         .w = sgt_exact_value(&s->w, NULL), .x2 = sgt_exact_value(&s->x2, NULL),
                         .y2 = sgt_exact_value(&s->y2, NULL), .off = sgt_exact_value(&s->off, NULL)};
}

void sgt_spread_join(spot_spread *s, const spot_spread *more, double weight)
{
    s->rays += more->rays, s->passed += more->passed, s->far = fmax(s->far, more->far), s->joined++;
    if (weight == 0) return;
    s->w += weight * more->w, s->x2 += weight * more->x2, s->y2 += weight * more->y2;
    s->off += weight * more->off;
}

sgt_spot sgt_spread_of(const spot_spread *s, sgt_vec2 about)
{
    const double none = (double)NAN;
    sgt_spot out = {.rays = s->rays,
                    .passed = s->passed,
                    .reference = {none, none},
                    .rms = none,
                    .rms_x = none,
                    .rms_y = none,
                    .geometric = none,
                    .error = none};
    if (!(s->w > 0)) return out;
    out.reference = about, out.geometric = isnan(about.x + about.y) ? none : s->far;
    out.rms_x = sqrt(s->x2 / s->w), out.rms_y = sqrt(s->y2 / s->w), out.rms = sqrt((s->x2 + s->y2) / s->w);
    out.error = sqrt(s->off / s->w) + (double)(2 + s->joined) * 0x1p-51 * out.rms;
    return out;
}

sgt_spot sgt_spot_of(size_t groups, const sgt_ends group[], const sgt_vec2 *reference)
{
    static const sgt_vec2 origin;
    spot_middle middle = {.w = 0};
    spot_spread all = {.rays = 0};
    for (size_t g = 0; g < groups && !reference; g++) {
        middle_sum of = {.w = {{0}, 0, 0}};
        sgt_middle_add(&of, origin, group[g].count, group[g].end);
        const spot_middle own = sgt_middle_rounded(&of);
        sgt_middle_join(&middle, &own, group[g].weight);
    }
    const sgt_vec2 about = reference ? *reference : sgt_middle_of(&middle);
    for (size_t g = 0; g < groups; g++) {
        spread_sum of = {.rays = 0};
        sgt_spread_add(&of, about, group[g].count, group[g].end);
        const spot_spread own = sgt_spread_rounded(&of);
        sgt_spread_join(&all, &own, group[g].weight);
    }
    return sgt_spread_of(&all, about);
}

double sgt_airy_radius(double wavelength, double working_f_number)
{
    return 1.2196698912665045 * wavelength * working_f_number; /* the first zero of J1, over pi */
}

/* ------------------------------------------------------------------ the study */

bool sgt_spots_begin(sgt_asking *a, bool centroid, const sgt_list *defocus, spots *out)
{
    const bool moved = defocus && defocus->count > 0;
    *out = (spots){.ask = a, .centroid = centroid, .moved = moved,
                   .surfaces = moved ? defocus->count : 1};
    out->z = sgt_ask_room(a, out->surfaces, sizeof *out->z);
    out->chief_element = sgt_ask_room(a, out->surfaces, sizeof *out->chief_element);
    out->element = sgt_ask_room(a, out->surfaces * a->bands, sizeof *out->element);
    out->cells = a->fields * out->surfaces * a->bands;
    if (a->failed) return false;
    for (size_t s = 0; s < out->surfaces; s++) {
        out->z[s] = moved ? defocus->at[s] : 0;
        out->chief_element[s] = sgt_ask_moved(a, &a->primary, out->z[s]);
        for (size_t b = 0; b < a->bands; b++)
            out->element[s * a->bands + b] = sgt_ask_moved(a, &a->band[b], out->z[s]);
    }
    out->chief = a->failed ? NULL : sgt_ask_chiefs(a, out->surfaces, out->chief_element);
    out->centre = sgt_ask_room(a, a->fields * out->surfaces, sizeof *out->centre);
    for (size_t i = 0; i < a->fields * out->surfaces && !a->failed; i++) {
        out->centre[i] = out->chief[i];
        if (a->lens->afocal) sgt_ends_as_angles(&out->chief[i].d, 1, &out->chief[i], &out->centre[i]);
    }
    return !a->failed;
}

bool sgt_spots_place(const pass *p, size_t i, cell *out, sgt_error *fault)
{
    const spots *w = p->data;
    const sgt_asking *a = p->ask;
    const size_t bands = a->bands, f = i / bands / w->surfaces, s = i / bands % w->surfaces;
    (void)fault;
    out->beam = &a->beam[f], out->element = w->element[s * bands + i % bands];
    out->before = a->band[i % bands].before;
    return true;
}

void sgt_spots_lost(const pass *p, size_t i, sgt_lost_ray *out)
{
    const spots *w = p->data;
    const size_t bands = p->ask->bands;
    sgt_lost_study(p, i / bands / w->surfaces * bands + i % bands, out);
    out->defocus = w->z[i / bands % w->surfaces];
}

void sgt_spots_angles(const spots *w, size_t i, size_t count, sgt_ray_end end[])
{
    if (w->ask->lens->afocal) sgt_ends_as_angles(&w->chief[i / w->ask->bands].d, count, end, end);
}

/* The sums of one pattern. */
typedef struct spot_sums {
    const spots *of;
    spot_middle *middle;      /* [cells], about the centroid */
    spot_spread *own, *all;   /* [cells]: about the reference of the cell, and that of all bands; about the
                                 chief ray they are one */
    sgt_fates *fates;         /* [cells]; NULL: not wanted */
} spot_sums;

static sgt_vec2 about_all(const spots *w, const spot_middle middle[], size_t i)
{
    const size_t bands = w->ask->bands, panel = i / bands;
    spot_middle all = {.w = 0};
    if (!w->centroid) return (sgt_vec2){w->centre[panel].p.x, w->centre[panel].p.y};
    for (size_t b = 0; b < bands; b++)
        sgt_middle_join(&all, &middle[panel * bands + b], sgt_spots_weight(w->ask, b));
    return sgt_middle_of(&all);
}

static sgt_vec2 about_own(const spots *w, const spot_middle middle[], size_t i)
{
    return w->centroid ? sgt_middle_of(&middle[i]) : about_all(w, middle, i);
}

static void middle_block(const pass *p, size_t i, size_t count, sgt_ray_end end[], void *sum)
{
    const spot_sums *s = p->data;
    sgt_spots_angles(s->of, i, count, end);
    sgt_middle_add(sum, (sgt_vec2){0, 0}, count, end);
}

void sgt_spots_merge_middles(const void *p, void *into, const void *more)
{
    (void)p;
    sgt_middle_merge(into, more);
}

static void middle_end(const pass *p, size_t i, const sgt_fates *fates, void *sum)
{
    const spot_sums *s = p->data;
    (void)fates;
    s->middle[i] = sgt_middle_rounded(sum);
}

/* Are there sums about two centroids: that of the cell, and of all bands? */
static bool about_two(const spots *w) { return w->centroid && w->ask->bands > 1; }

static void spread_block(const pass *p, size_t i, size_t count, sgt_ray_end end[], void *sum)
{
    const spot_sums *s = p->data;
    spread_sum *two = sum;
    sgt_spots_angles(s->of, i, count, end);
    sgt_spread_add(&two[0], about_own(s->of, s->middle, i), count, end);
    if (about_two(s->of)) sgt_spread_add(&two[1], about_all(s->of, s->middle, i), count, end);
}

static void merge_spreads(const void *of, void *into, const void *more)
{
    const pass *p = of;
    const spot_sums *s = p->data;
    spread_sum *two = into;
    const spread_sum *other = more;
    sgt_spread_merge(&two[0], &other[0]);
    if (about_two(s->of)) sgt_spread_merge(&two[1], &other[1]);
}

static void spread_take(const pass *p, size_t i, size_t count, const sgt_ray_end end[], const void *sum)
{
    const spot_sums *s = p->data;
    const sgt_asking *a = p->ask;
    const size_t panel = i / a->bands;
    (void)sum;
    a->sink->ends(a->sink->context, panel / s->of->surfaces, panel % s->of->surfaces, i % a->bands, count,
                  end);
}

static void spread_end(const pass *p, size_t i, const sgt_fates *fates, void *sum)
{
    const spot_sums *s = p->data;
    const spread_sum *two = sum;
    s->own[i] = sgt_spread_rounded(&two[0]);
    if (about_two(s->of)) s->all[i] = sgt_spread_rounded(&two[1]);
    if (s->fates) s->fates[i] = *fates;
}

/* (Both passes find their cells by `of`, the first member of what they are given.) */
static bool place_of_sums(const pass *p, size_t i, cell *out, sgt_error *fault)
{
    pass of = *p;
    const spot_sums *s = p->data;
    of.data = (void *)(uintptr_t)s->of;
    return sgt_spots_place(&of, i, out, fault);
}

static void lost_of_sums(const pass *p, size_t i, sgt_lost_ray *out)
{
    pass of = *p;
    const spot_sums *s = p->data;
    of.data = (void *)(uintptr_t)s->of;
    sgt_spots_lost(&of, i, out);
}

static spot_sums sums_of(const spots *w, const sgt_pupil *points, bool counts)
{
    sgt_asking *a = w->ask;
    spot_sums s = {.of = w};
    s.middle = sgt_ask_room(a, w->cells, sizeof *s.middle);
    s.own = s.all = sgt_ask_room(a, w->cells, sizeof *s.own);
    if (about_two(w)) s.all = sgt_ask_room(a, w->cells, sizeof *s.all);
    if (counts) s.fates = sgt_ask_room(a, w->cells, sizeof *s.fates);
    pass p = {.ask = a, .points = points, .cells = w->cells, .wanted = END_POINT, .data = &s,
              .place = place_of_sums, .lost = lost_of_sums};
    if (a->failed) return s;
    if (counts && !a->study->rms_alone) p.wanted |= END_POINT_ERROR; /* coarse: for its rms alone */
    a->counts = false;
    p.size = sizeof(middle_sum), p.block = middle_block, p.merge = sgt_spots_merge_middles;
    p.exact = true, p.end = middle_end, p.before = true;
    if (w->centroid && !sgt_ask_pass(&p)) return s;
    p.before = false;
    a->counts = counts;
    if (counts && a->sink->ends) {
        const size_t most = a->sink->ends_most;
        p.wanted = END_ALL, p.takes_ends = true, p.take = spread_take;
        p.shown = most ? (most + PUPIL_PART - 1) / PUPIL_PART : SIZE_MAX;
    }
    p.size = (about_two(w) ? 2 : 1) * sizeof(spread_sum), p.block = spread_block, p.merge = merge_spreads;
    p.end = spread_end;
    sgt_ask_pass(&p);
    return s;
}

/* ----------------------------------------------------------------------- rows */

static double index_behind(const sgt_asking *a, const band *b)
{
    double index = b->before == 0 ? 1 : b->before;
    for (size_t i = 0; i + 1 < a->lens->count; i++)
        if (b->element[i].index != SGT_MIRROR && b->element[i].index != 0) index = b->element[i].index;
    return index;
}

double sgt_spots_airy(const sgt_asking *a, const band *b)
{
    const double wavelength = b->at.um / a->study->um;
    if (a->lens->afocal) /* 1.22 wavelength / (n diameter of the beam) */
        return 1e3 * sgt_airy_radius(wavelength, 0.5 / (index_behind(a, b) * b->data.exit_radius));
    return sgt_airy_radius(wavelength, b->data.f_number_working);
}

/* A row for one wavelength leaves its weight out, which may be 0. */
typedef struct spot_part { sgt_spot of; double off, rms_coarse; sgt_fates fates; } spot_part;

static void spot_row(const spots *w, size_t panel, double um, const band *airy, const spot_part *part)
{
    const sgt_asking *a = w->ask;
    const sgt_spot *s = &part->of;
    sgt_vec2 way = {0, 0}; /* afocal: of the chief ray from z of the last surface */
    if (a->lens->afocal) {
        const sgt_ray_end *chief = &w->chief[panel];
        const sgt_vec3 axis = {0, 0, copysign(1, chief->d.z)};
        sgt_ray_end end;
        sgt_ends_as_angles(&axis, 1, chief, &end);
        way = (sgt_vec2){end.p.x, end.p.y};
    }
    const sgt_spot_row row = {.field = a->number[panel / w->surfaces],
                              .wavelength = um,
                              .rays = s->rays,
                              .passed = s->passed,
                              .x = s->reference.x + way.x,
                              .y = s->reference.y + way.y,
                              .rms = s->rms,
                              .rms_x = s->rms_x,
                              .rms_y = s->rms_y,
                              .geometric = isnan(s->rms) ? (double)NAN : s->geometric,
                              .airy = sgt_spots_airy(a, airy),
                              .digits = sgt_digits(s->rms, s->error + (w->centroid ? 0 : part->off)),
                              .sampling = s->rms - part->rms_coarse,
                              .fates = sgt_fates_row(&part->fates),
                              .defocus = w->z[panel % w->surfaces],
                              .xy_err = part->off,
                              .rms_err = s->error + (w->centroid ? 0 : part->off)};
    sgt_ask_row(a, &row);
}

static double off_of(const spots *w, const spot_middle *m, size_t panel)
{
    return w->centroid ? m->off / m->w : w->centre[panel].p_err;
}

static void spot_rows(const spots *w, const spot_sums *fine, const spot_sums *coarse, size_t panel)
{
    const sgt_asking *a = w->ask;
    const size_t first = panel * a->bands;
    spot_spread all = {.rays = 0}, all_coarse = {.rays = 0};
    spot_middle middle = {.w = 0};
    spot_part together = {.off = 0};
    for (size_t b = 0; b < a->bands; b++) {
        const size_t i = first + b;
        const double weight = sgt_spots_weight(a, b);
        const spot_part part = {
            .of = sgt_spread_of(&fine->own[i], about_own(w, fine->middle, i)),
            .rms_coarse = sgt_spread_of(&coarse->own[i], about_own(w, coarse->middle, i)).rms,
            .off = off_of(w, &fine->middle[i], panel), .fates = fine->fates[i]};
        sgt_spread_join(&all, &fine->all[i], weight), sgt_spread_join(&all_coarse, &coarse->all[i], weight);
        sgt_middle_join(&middle, &fine->middle[i], weight);
        sgt_fates_add(&together.fates, &part.fates);
        spot_row(w, panel, a->band[b].at.um, &a->band[b], &part);
    }
    together.of = sgt_spread_of(&all, about_all(w, fine->middle, first));
    together.rms_coarse = sgt_spread_of(&all_coarse, about_all(w, coarse->middle, first)).rms;
    together.off = off_of(w, &middle, panel);
    spot_row(w, panel, SGT_ALL_WAVELENGTHS, a->bands == 1 ? &a->band[0] : &a->primary, &together);
}

void sgt_spots_say_reference(const spots *w)
{
    static const char words[] = "the chief ray does not get through, so there is no reference";
    const sgt_asking *a = w->ask;
    for (size_t i = 0; i < a->fields * w->surfaces && !w->centroid; i++) {
        const size_t number = a->number[i / w->surfaces];
        if (w->chief[i].fate == SGT_PASSED) continue;
        if (w->moved)
            sgt_ask_say(a, SGT_STUDY_NOTE, "field %zu, defocus %g: %s", number, w->z[i % w->surfaces], words);
        else sgt_ask_say(a, SGT_STUDY_NOTE, "field %zu: %s", number, words);
    }
}

static bool ask_spot(sgt_asking *a)
{
    const sgt_spot_options *o = a->options;
    spots w;
    if (a->lens->afocal && o->defocus.count)
        sgt_ask_say(a, SGT_STUDY_NOTE, "defocus: not used; the angles of an afocal lens are the same at each "
                                       "image surface");
    if (!sgt_spots_begin(a, o->reference == 1, &o->defocus, &w)) return false;
    sgt_spots_say_reference(&w);
    const spot_sums coarse = sums_of(&w, &a->coarse, false);
    const spot_sums fine = a->failed ? coarse : sums_of(&w, &a->fine, true);
    for (size_t i = 0; i < a->fields * w.surfaces && !a->failed; i++) spot_rows(&w, &fine, &coarse, i);
    sgt_ask_say(a, SGT_STUDY_LEGEND, "rms, geometric: %sabout %s.  airy: radius.",
                a->lens->afocal ? "angles " : "",
                w.centroid ? "the centroid" : "the chief ray of the primary wavelength");
    sgt_ask_say(a, SGT_STUDY_LEGEND,
                "digits: of rms, certain in spite of rounding.  sampling: rms less that of half as many rays "
                "across.");
    return true;
}

#define SPOT_AT(member) offsetof(sgt_spot_row, member)
static const sgt_column spot_columns[] = {
    COLUMN_FIELD(sgt_spot_row),
    COLUMN_WAVELENGTH(sgt_spot_row, 0),
    {.name = "rays", SGT_COLUMN_COUNT, SGT_UNIT_NONE, 0, SPOT_AT(rays), 0, "how many were sent"},
    {.name = "passed", SGT_COLUMN_COUNT, SGT_UNIT_NONE, 0, SPOT_AT(passed), 0,
     "how many reached the image: the others do not count"},
    {.name = "x", SGT_COLUMN_NUMBER, SGT_UNIT_IMAGE, 0, SPOT_AT(x), SPOT_AT(xy_err),
     "the reference: distances are from here"},
    {.name = "y", SGT_COLUMN_NUMBER, SGT_UNIT_IMAGE, 0, SPOT_AT(y), SPOT_AT(xy_err),
     "in the frame of the last surface"},
    {.name = "rms", SGT_COLUMN_NUMBER, SGT_UNIT_IMAGE, 0, SPOT_AT(rms), SPOT_AT(rms_err),
     "root of the mean square of the distances,"},
    {.name = "rms_x", SGT_COLUMN_NUMBER, SGT_UNIT_IMAGE, 0, SPOT_AT(rms_x), SPOT_AT(rms_err), "of their x"},
    {.name = "rms_y", SGT_COLUMN_NUMBER, SGT_UNIT_IMAGE, 0, SPOT_AT(rms_y), SPOT_AT(rms_err),
     "and of their y"},
    {.name = "geometric", SGT_COLUMN_NUMBER, SGT_UNIT_IMAGE, 0, SPOT_AT(geometric), 0,
     "the largest distance"},
    {.name = "airy", SGT_COLUMN_NUMBER, SGT_UNIT_IMAGE, 0, SPOT_AT(airy), 0,
     "the radius of the first dark ring of diffraction, 1.22 wavelength working F-number (paraxial).  Empty "
     "if the unit or the wavelength is not given"},
    {.name = "digits", SGT_COLUMN_COUNT, SGT_UNIT_NONE, 0, SPOT_AT(digits), 0,
     "so many decimal digits of rms are certain in spite of rounding"},
    {.name = "sampling", SGT_COLUMN_ERROR, SGT_UNIT_IMAGE, 0, SPOT_AT(sampling), 0,
     "rms, less that of half as many rays across the pupil: so much more or less depends on the rays that "
     "are taken"},
    COLUMN_FATES(sgt_spot_row),
    {.name = "defocus", SGT_COLUMN_EXACT, SGT_UNIT_LENGTH, SGT_COLUMN_GROUPS | SGT_COLUMN_GIVEN,
     SPOT_AT(defocus), 0,
     "how far the image surface was moved"},
    {.name = "xy_err", SGT_COLUMN_ERROR, SGT_UNIT_IMAGE, SGT_COLUMN_DETAIL, SPOT_AT(xy_err), 0,
     "rounding puts neither x nor y off by more"},
};

static const sgt_setting spot_settings[] = {
    {.name = "reference", SGT_SETTING_WORD, offsetof(sgt_spot_options, reference), "chief|centroid", 0, 0,
     "chief (the default): where the chief ray of the primary wavelength ends; centroid: the mean of the "
     "rays of the row"},
    {.name = "defocus", SGT_SETTING_NUMBERS, offsetof(sgt_spot_options, defocus), NULL, 0, 0,
     "moves the image surface along its own z; several: one after another"},
};

const sgt_analysis sgt_spot_analysis = {
    .name = "spot", .title = "spots",
    .help = "The spots of a lens: how rays of each field and wavelength scatter about a point of the image.",
    .pattern = SGT_PATTERN_HEXAPOLAR, .rays = 10, ROWS_OF(sgt_spot_row, spot_columns),
    OPTIONS_OF(sgt_spot_options), SETTINGS_OF(spot_settings), .ask = ask_spot};
