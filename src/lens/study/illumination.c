// SPDX-License-Identifier: MIT
/* illumination.c - vignetting and relative illumination.
 *
 * `fraction` is the share of the pupil whose rays reach the image: the weight of the rays that pass, over the
 * weight of all.  A small piece of the image that faces the axis receives light in proportion to the solid
 * angle of the pupil, seen from it, times the cosine of incidence.  If the exit pupil is flat, small and
 * uniform, both together fall as cos^4 of the angle at which the chief ray arrives: its distance grows as
 * 1 / cos, which counts twice, its own area is foreshortened, and so is that of the image.  So
 *
 *     illumination = fraction cos^4(angle)
 *
 * is an estimate: where the pupil itself grows with the field (pupil aberration), more light arrives.
 *
 * THE ANGLE is that of the chief ray, of the same wavelength, from the z axis of the last element, in front
 * of it.  What clips the chief ray does not matter.
 *
 * ERROR.  A ray that was lost may have passed: `unsure` is the weight of these, so the true sum lies between
 * fraction and fraction + unsure.  |d cos^4 / d angle| = 4 cos^3 sin <= 3/4 sqrt 3 < 1.3; so a direction that
 * is off by the angle e moves cos^4 by less than 1.3 e.  The rounding of cos^4 is below 8 u, u = 2^-53: a
 * cosine off by 2 u, and two squarings.  Sums of n weights are off by n u each. */
#include "analyses.h"
#include "study.h"

typedef struct share { double all, passed, lost; } share;

typedef struct shares {
    share *of;                  /* [cells] */
    sgt_fates *fates;           /* [cells] */
} shares;

static void share_block(const pass *p, size_t i, size_t count, sgt_ray_end end[], void *sum)
{
    share *s = sum;
    (void)p, (void)i;
    for (size_t k = 0; k < count; k++) {
        const int fate = sgt_fate_of(&end[k]);
        s->all += end[k].weight;
        if (fate == SGT_PASSED) s->passed += end[k].weight;
        if (fate == SGT_LOST) s->lost += end[k].weight;
    }
}

static void share_take(const pass *p, size_t i, size_t count, const sgt_ray_end end[], const void *sum)
{
    const shares *w = p->data;
    const share *more = sum;
    (void)count, (void)end;
    w->of[i].all += more->all, w->of[i].passed += more->passed, w->of[i].lost += more->lost;
}

static void share_end(const pass *p, size_t i, const sgt_fates *fates, void *sum)
{
    (void)sum;
    const shares *w = p->data;
    w->fates[i] = *fates;
}

static bool share_all(sgt_asking *a, const sgt_pupil *points, shares *out)
{
    const size_t cells = a->fields * a->bands;
    const pass p = {.ask = a, .points = points, .cells = cells, .size = sizeof(share), .data = out,
                    .place = sgt_place_study, .lost = sgt_lost_study, .block = share_block,
                    .take = share_take, .end = share_end};
    out->of = sgt_ask_room(a, cells, sizeof *out->of);
    out->fates = sgt_ask_room(a, cells, sizeof *out->fates);
    return !a->failed && sgt_ask_pass(&p);
}

/* cos^4 of the chief ray of cell i, NaN: it does not reach the image.  *error: a bound. */
static double chief_cos4(sgt_asking *a, size_t i, double *error)
{
    const double STEEPEST = 1.3, ROUNDING = 0x1p-50;
    const sgt_field_beam *beam = &a->beam[i / a->bands];
    const band *b = &a->band[i % a->bands];
    sgt_ray_end chief;
    *error = (double)NAN;
    if (!sgt_trace_chief(a->from, beam, b->element, b->before, &chief, NULL)) {
        sgt_ask_fail(a, "", "no memory");
        return *error;
    }
    if (chief.fate != SGT_PASSED) return *error;
    *error = STEEPEST * chief.d_err + ROUNDING;
    const double cos2 = chief.d.z * chief.d.z / dot3(chief.d, chief.d);
    return cos2 * cos2;
}

static bool ask_illumination(sgt_asking *a)
{
    shares fine, coarse;
    if (!share_all(a, &a->fine, &fine)) return false;
    a->counts = false;
    if (!share_all(a, &a->coarse, &coarse)) return false;
    for (size_t i = 0; i < a->fields * a->bands; i++) {
        const share *s = &fine.of[i];
        const sgt_fates *f = &fine.fates[i];
        double off;
        sgt_illumination_row row = {.field = a->number[i / a->bands],
                                    .wavelength = a->band[i % a->bands].at.um, .rays = f->rays,
                                    .passed = f->passed, .fraction = s->passed / s->all,
                                    .unsure = s->lost / s->all, .fates = sgt_fates_row(f)};
        row.sampling = row.fraction - coarse.of[i].passed / coarse.of[i].all;
        row.cos4 = chief_cos4(a, i, &off);
        if (a->failed) return false;
        row.cos4_err = off;
        row.illumination = row.fraction * row.cos4;
        row.illumination_err = row.unsure * row.cos4 +
                               row.fraction * (row.cos4_err + (double)f->rays * 0x1p-52 * row.cos4);
        if (isnan(row.cos4))
            sgt_ask_say(a, SGT_STUDY_NOTE, "field %zu: the chief ray does not reach the image, so there is "
                        "no cos^4.", row.field);
        sgt_ask_row(a, &row);
    }
    sgt_ask_say(a, SGT_STUDY_LEGEND, "illumination: the fraction of the pupil that passes, times cos^4 of "
                "the chief ray's angle at the image.");
    return true;
}

#define AT(member) offsetof(sgt_illumination_row, member)
static const sgt_column illumination_columns[] = {
    COLUMN_FIELD(sgt_illumination_row),
    COLUMN_WAVELENGTH(sgt_illumination_row, 0),
    {.name = "rays", SGT_COLUMN_COUNT, SGT_UNIT_NONE, 0, AT(rays), 0, "how many were sent"},
    {.name = "passed", SGT_COLUMN_COUNT, SGT_UNIT_NONE, 0, AT(passed), 0, "how many reached the image"},
    {.name = "fraction", SGT_COLUMN_NUMBER, SGT_UNIT_NONE, 0, AT(fraction), 0,
     "of the area of the pupil: how much passes, 0 to 1"},
    {.name = "cos4", SGT_COLUMN_NUMBER, SGT_UNIT_NONE, 0, AT(cos4), AT(cos4_err),
     "cos^4 of the angle between the chief ray and the z axis of the last surface, in front of it"},
    {.name = "illumination", SGT_COLUMN_NUMBER, SGT_UNIT_NONE, 0, AT(illumination), AT(illumination_err),
     "fraction times cos4: 1 for a field on the axis that loses nothing"},
    {.name = "unsure", SGT_COLUMN_ERROR, SGT_UNIT_NONE, 0, AT(unsure), 0,
     "the share of rays that were lost: the fraction is too small by no more"},
    {.name = "sampling", SGT_COLUMN_ERROR, SGT_UNIT_NONE, 0, AT(sampling), 0,
     "fraction, less that of half as many rays across the pupil"},
    COLUMN_FATES(sgt_illumination_row),
    {.name = "cos4_err", SGT_COLUMN_ERROR, SGT_UNIT_NONE, SGT_COLUMN_DETAIL, AT(cos4_err), 0,
     "rounding puts cos4 off by no more,"},
    {.name = "illumination_err", SGT_COLUMN_ERROR, SGT_UNIT_NONE, SGT_COLUMN_DETAIL, AT(illumination_err), 0,
     "nor rounding and lost rays the illumination"},
};

const sgt_analysis sgt_illumination_analysis = {
    .name = "illumination", .title = "vignetting and relative illumination",
    .help = "The fraction of the pupil whose rays reach the image, for each field and wavelength, and that "
            "fraction times cos^4 of the angle at which the chief ray arrives.",
    .pattern = SGT_PATTERN_CELLS, .rays = 64, .draw_x = "field", .draw_y = "illumination",
    ROWS_OF(sgt_illumination_row, illumination_columns), .ask = ask_illumination};
