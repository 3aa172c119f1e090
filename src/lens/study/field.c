// SPDX-License-Identifier: MIT
/* field.c - field curvature, astigmatism and distortion along the chief rays of a study: curves.c for each
 * field and wavelength.  Apertures and vignetting do not count. */
#include "analyses.h"
#include "study.h"

typedef struct curve {
    sgt_asking *ask;
    size_t steps;               /* 0: the fields of the study */
    sgt_distortion distortion;
    size_t lacks;               /* the first element without second derivatives */
    double dioptre;             /* of 1 / length, if the lens is afocal; else 1 */
} curve;

typedef struct curve_point { bool placed; sgt_lens_field at; sgt_field_point of; sgt_error fault;
} curve_point;

/* Cells are field * bands + band. */
static bool curve_work(void *data, size_t i, void *slot)
{
    const curve *c = data;
    const sgt_asking *a = c->ask;
    const band *b = &a->band[i % a->bands];
    const size_t f = i / a->bands;
    curve_point *p = slot;
    sgt_field_beam beam;
    p->placed = true;
    if (c->steps) {
        const sgt_lens_field *far = sgt_ask_farthest(a);
        const double u = (double)f / (double)(c->steps - 1);
        p->at = (sgt_lens_field){.x = u * far->x, .y = u * far->y, .weight = 1};
        p->placed = sgt_launch_field(a->from, a->kind, &p->at, &beam, &p->fault);
    } else {
        p->at = a->at[f], beam = a->beam[f];
    }
    return !p->placed ||
           sgt_field_curve(a->from, &beam, b->element, b->before, &b->data, c->distortion, &p->of,
                           NULL);
}

static void curve_take(void *data, size_t i, void *slot)
{
    curve *c = data;
    sgt_asking *a = c->ask;
    const curve_point *p = slot;
    const size_t f = i / a->bands;
    if (!p->placed) {
        a->failed = true, *a->error = p->fault;
        return;
    }
    const sgt_field_point *of = &p->of;
    const sgt_ray_end end = {.aimed = of->aimed, .fate = of->fate, .within = of->within};
    const size_t lost = a->total.fates.lost;
    sgt_fates_count(&a->total.fates, &end);
    if (a->total.fates.lost > lost && lost == 0)
        a->total.lost = (sgt_lost_ray){.kind = a->kind, .at = p->at, .wavelength = a->band[i % a->bands].at,
                                       .open = true};
    if (!c->lacks) c->lacks = of->lacks;
    const sgt_field_row row = {
        .field = c->steps ? f + 1 : a->number[f], .wavelength = a->band[i % a->bands].at.um,
        .tangential = of->tangential * c->dioptre, .sagittal = of->sagittal * c->dioptre,
        .distortion_percent = 100 * of->distortion, .fx = p->at.x, .fy = p->at.y, .fate = sgt_fate_of(&end),
        .x = of->image.x, .y = of->image.y, .xy_err = of->error, .ideal = of->ideal,
        .digits = sgt_digits(hypot(of->image.x, of->image.y), of->error), .lacks = of->lacks};
    sgt_ask_row(a, &row);
}

static const char *ideal_words(const sgt_asking *a, sgt_distortion distortion)
{
    const bool finite = isfinite(a->lens->object_distance);
    switch (distortion) {
    case SGT_DISTORTION_TAN: return finite ? "the magnification" : "f tan(theta)";
    case SGT_DISTORTION_THETA: return "f theta";
    case SGT_DISTORTION_TAN_SURFACE:
        return finite ? "the magnification on the image surface"
                      : "f tan(theta), scaled to the image surface";
    default: return "f theta, scaled to the image surface";
    }
}

static bool ask_field(sgt_asking *a)
{
    const sgt_field_options *o = a->options;
    const bool afocal = a->lens->afocal;
    curve c = {.ask = a, .steps = o->steps, .dioptre = afocal ? 1e6 / a->study->um : 1,
               .distortion = (sgt_distortion)o->distortion};
    if (o->steps == 1) return sgt_ask_refuse(a, "steps", "2 or more");
    if (afocal && o->distortion)
        sgt_ask_say(a, SGT_STUDY_NOTE, "distortion: of an afocal lens tangents of angles are compared, "
                                       "whatever is asked for");
    if (afocal && isnan(a->study->um))
        sgt_ask_say(a, SGT_STUDY_NOTE, "units of the lens must be mm, cm, m, um or in for vergences in "
                                       "dioptres");
    const rounds r = {.tasks = (c.steps ? c.steps : a->fields) * a->bands, .size = sizeof(curve_point),
                      .data = &c, .work = curve_work, .take = curve_take};
    if (!sgt_shard_rounds(a, &r)) return false;
    if (afocal)
        sgt_ask_say(a, SGT_STUDY_LEGEND,
                    "Vergences at the last surface, in dioptres (1/m); angles of the chief "
                    "ray from its z.\ndistortion: of tangents, against the angular magnification.");
    else
        sgt_ask_say(a, SGT_STUDY_LEGEND,
                    "tangential, sagittal: z from the image surface.  distortion: against "
                    "%s.",
                    ideal_words(a, c.distortion));
    if (c.lacks)
        sgt_ask_say(a, SGT_STUDY_LEGEND,
                    "No tangential and sagittal image, and no digits, where a chief ray goes "
                    "through surface %zu: its type (%s) has no second derivatives.",
                    c.lacks, a->lens->surface[c.lacks - 1].type);
    return true;
}

#define FIELD_AT(member) offsetof(sgt_field_row, member)
static const sgt_column field_columns[] = {
    COLUMN_FIELD(sgt_field_row),
    COLUMN_WAVELENGTH(sgt_field_row, 0),
    {.name = "tangential", SGT_COLUMN_NUMBER, SGT_UNIT_FOCUS, 0, FIELD_AT(tangential), 0,
     "where rays near the chief ray meet, in the plane of the field"},
    {.name = "sagittal", SGT_COLUMN_NUMBER, SGT_UNIT_FOCUS, 0, FIELD_AT(sagittal), 0,
     "and across it: along z of the image surface, from where the chief ray meets it; of an afocal lens "
     "vergences at the last surface"},
    {.name = "distortion_percent", SGT_COLUMN_NUMBER, SGT_UNIT_PERCENT, 0, FIELD_AT(distortion_percent), 0,
     "how much the image is higher than without"},
    {.name = "fx", SGT_COLUMN_NUMBER, SGT_UNIT_FIELD, 0, FIELD_AT(fx), 0, "the field,"},
    {.name = "fy", SGT_COLUMN_NUMBER, SGT_UNIT_FIELD, 0, FIELD_AT(fy), 0,
     "as the lens gives it: degrees, or a height"},
    COLUMN_OF_FATE(sgt_field_row),
    {.name = "x", SGT_COLUMN_NUMBER, SGT_UNIT_IMAGE, 0, FIELD_AT(x), FIELD_AT(xy_err),
     "where the chief ray meets the image;"},
    {.name = "y", SGT_COLUMN_NUMBER, SGT_UNIT_IMAGE, 0, FIELD_AT(y), FIELD_AT(xy_err),
     "of an afocal lens its angles from z of the last surface"},
    {.name = "xy_err", SGT_COLUMN_ERROR, SGT_UNIT_IMAGE, 0, FIELD_AT(xy_err), 0,
     "rounding puts neither x nor y off by more"},
    {.name = "ideal", SGT_COLUMN_NUMBER, SGT_UNIT_IMAGE, 0, FIELD_AT(ideal), 0,
     "the height of the image without distortion"},
    {.name = "digits", SGT_COLUMN_COUNT, SGT_UNIT_NONE, 0, FIELD_AT(digits), 0,
     "so many decimal digits of the image's height are certain"},
    {.name = "lacks", SGT_COLUMN_COUNT, SGT_UNIT_NONE, SGT_COLUMN_DETAIL, FIELD_AT(lacks), 0,
     "the surface without second derivatives, for which tangential, sagittal and digits are not known; 0: "
     "none"},
};

static const sgt_setting field_settings[] = {
    {.name = "distortion", SGT_SETTING_WORD, offsetof(sgt_field_options, distortion),
     "tan|theta|tan-surface|theta-surface" /* as sgt_distortion has them */, 0, 0,
     "tan (the default): the ideal height is efl tan(angle), of an object at a distance magnification times "
     "its height; theta: efl times the angle; tan-surface, theta-surface: the same, scaled to the image "
     "surface where it stands, by the paraxial chief ray: the scale of images near the axis"},
    {.name = "steps", SGT_SETTING_COUNT, offsetof(sgt_field_options, steps), NULL, 2, 1000000,
     "so many fields from the axis to that of the study which is farthest from it, in place of its own"},
};

const sgt_analysis sgt_field_analysis = {
    .name = "field", .title = "field curves",
    .help = "Field curvature, astigmatism and distortion: what rays near the real chief ray of each field "
            "do.",
    .no_rays = true, ROWS_OF(sgt_field_row, field_columns), OPTIONS_OF(sgt_field_options),
    SETTINGS_OF(field_settings), .ask = ask_field};
