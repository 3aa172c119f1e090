/* field.c - sagitta field: field curvature, astigmatism and distortion along the real chief ray. */
#include "commands.h"
#include "../base/memory.h"
#include "../draw/chart.h"
#include "../look/look.h"

#include <math.h>
#include <string.h>

static const char field_help[] =
    "sagitta field LENS [options]\n"
    "\n"
    "Field curvature, astigmatism and distortion: what rays near the real chief ray of each field do.\n"
    "\n"
    "Columns\n"
    "  field, wavelength  the field, counted from 1 (with --steps the step); micrometres\n"
    "  tangential, sagittal\n"
    "                     where rays near the chief ray meet, in the plane of the field and across it:\n"
    "                     along z of the image surface, from where the chief ray meets it (length)\n"
    "  distortion         how much the image is higher than without: a fraction; see --distortion\n"
    "  fx, fy             the field, as the lens gives it: degrees, or a height (length)\n"
    "  fate               of the chief ray\n"
    "  x, y, xy_err       where it meets the image, and how far rounding may have put that off (length)\n"
    "  ideal              the height of the image without distortion (length)\n"
    "  tangential_dioptre, sagittal_dioptre, x_mrad, y_mrad, xy_err_mrad, ideal_mrad\n"
    "                     instead, if the lens is afocal: vergences at the last surface (1/m), and angles\n"
    "                     of the chief ray from its z (milliradians)\n"
    "  digits             so many decimal digits of the image's height are certain\n"
    "  lacks              (csv, json, npy) the surface without second derivatives, for which tangential,\n"
    "                     sagittal and digits are not known; 0: none\n"
    "\n"
    "Options\n"
    "  --distortion D     tan (the default): the ideal height is efl tan(angle), of an object at a\n"
    "                     distance magnification times its height; theta: efl times the angle\n"
    "  --steps N          N fields from the axis to that of the lens which is farthest from it, in place\n"
    "                     of its own.  The picture has as many, or 33\n";

typedef struct field_arguments {
    look_options look;
    sgt_distortion distortion;
    long steps;
} field_arguments;

static field_arguments field_arguments_of(int argc, char *argv[])
{
    enum { DISTORTION = OPTION_AFTER_LOOK, STEPS, STEPS_MOST = 1000000 };
    static const struct option known[] = {
        {"distortion", required_argument, NULL, DISTORTION}, {"steps", required_argument, NULL, STEPS},
        LOOK_OPTIONS, {0},
    };
    field_arguments a = {.distortion = SGT_DISTORTION_TAN};
    for (int code; (code = getopt_long(argc, argv, LOOK_LETTERS, known, NULL)) != -1;) {
        if (code == DISTORTION) {
            a.distortion = strcmp(optarg, "theta") == 0 ? SGT_DISTORTION_THETA : SGT_DISTORTION_TAN;
            if (a.distortion == SGT_DISTORTION_TAN && strcmp(optarg, "tan") != 0)
                fail_usage("--distortion must be tan or theta, not \"%s\"", optarg);
        } else if (code == STEPS) {
            a.steps = options_integer("steps", optarg, 2, STEPS_MOST);
        } else {
            look_take_option(&a.look, code, field_help);
        }
    }
    look_take_lens(&a.look, argc, argv, "field");
    const job_options *o = &a.look.job;
    if (o->pupils || o->pattern_given || o->across)
        fail_usage("a pattern of rays is of no use here: the rays are those near the chief ray");
    if (a.look.shared.solver.proof)
        fail_usage("--proof: field follows chief rays and proves nothing; spot, fan, opd, map and sweep do");
    return a;
}

/* The i-th of `steps` fields from the axis to the farthest. */
static sgt_lens_field field_step(const look *l, size_t i, size_t steps)
{
    const sgt_lens_field *far = look_farthest(l);
    const double u = (double)i / (double)(steps - 1);
    return (sgt_lens_field){.x = u * far->x, .y = u * far->y, .weight = 1};
}

static sgt_field_point field_point(const look *l, const field_arguments *a, const look_band *band,
                                   sgt_lens_field at)
{
    const sgt_field_beam beam = look_beam(l, l->fields.kind, at);
    sgt_field_point p;
    const double dioptre = l->primary.lens.of->afocal ? 1e6 / l->um : 1; /* of 1 / length */
    if (!sgt_field_curve(l->from, &beam, band->element, band->lens.index_before, &band->data, a->distortion,
                         &p, NULL))
        fail_input("out of memory");
    p.tangential *= dioptre, p.sagittal *= dioptre;
    return p;
}

static void field_row(table *t, look *l, size_t number, const look_band *band, sgt_lens_field at,
                      const sgt_field_point *p)
{
    const sgt_ray_end end = {.aimed = p->aimed, .fate = p->fate, .within = p->within};
    look_count(&l->fates, &end);
    look_lost(l, band, look_text("%s --no-apertures", look_field_option(l->fields.kind, &at)), &end);
    table_count(t, (long long)number + 1);
    look_number(t, band->lens.wavelength);
    look_number(t, p->tangential);
    look_number(t, p->sagittal);
    look_number(t, p->distortion);
    table_number(t, at.x);
    table_number(t, at.y);
    look_fate_cell(t, &end);
    const double each[] = {p->image.x, p->image.y, p->error, p->ideal};
    for (size_t i = 0; i < sizeof each / sizeof *each; i++) look_number(t, each[i]);
    table_count(t, look_digits(hypot(p->image.x, p->image.y), p->error));
    if (l->asked->shared.target.format != TABLE_TEXT) table_count(t, (long long)p->lacks);
}

/* ---------------------------------------------------------------- picture */

/* [0], [1]: the tangential and the sagittal curve, [2]: distortion in per cent; all against the field. */
typedef struct field_curves { double *field, *value[3]; } field_curves;

static field_curves field_curves_of(const look *l, const field_arguments *a, const look_band *band,
                                    size_t steps)
{
    field_curves c = {.field = memory_take(steps, sizeof(double))};
    for (int k = 0; k < 3; k++) c.value[k] = memory_take(steps, sizeof(double));
    for (size_t i = 0; i < steps; i++) {
        const sgt_lens_field at = field_step(l, i, steps);
        const sgt_field_point p = field_point(l, a, band, at);
        c.field[i] = look_farthest(l)->x == 0 ? at.y : hypot(at.x, at.y);
        c.value[0][i] = p.tangential, c.value[1][i] = p.sagittal, c.value[2][i] = 100 * p.distortion;
    }
    return c;
}

/* What an image without distortion is, unless the lens is afocal. */
static const char *field_ideal(const look *l, const field_arguments *a)
{
    if (a->distortion == SGT_DISTORTION_THETA) return "f theta";
    return isfinite(l->primary.lens.of->object_distance) ? "the magnification" : "f tan(theta)";
}

static void draw_field(const look *l, const field_arguments *a)
{
    enum { STEPS = 33 };
    const size_t steps = a->steps ? (size_t)a->steps : STEPS;
    chart_series *focus = memory_take(2 * l->bands, sizeof *focus),
                 *shift = memory_take(l->bands, sizeof *shift);
    for (size_t b = 0; b < l->bands; b++) {
        const field_curves c = field_curves_of(l, a, &l->band[b], steps);
        const char *name = look_wavelength_name(&l->band[b]);
        for (size_t k = 0; k < 2; k++)
            focus[2 * b + k] = (chart_series){.name = k ? name : NULL,
                                              .colour = look_colour(l, b),
                                              .line = true,
                                              .dash = k ? CHART_SOLID : CHART_DASHED,
                                              .count = steps,
                                              .x = c.value[k],
                                              .y = c.field};
        shift[b] = (chart_series){.name = name,
                                  .colour = look_colour(l, b),
                                  .line = true,
                                  .count = steps,
                                  .x = c.value[2],
                                  .y = c.field};
    }
    const char *units = l->primary.lens.units;
    const bool afocal = l->primary.lens.of->afocal;
    const sgt_lens_field *far = look_farthest(l);
    const double end = far->x == 0 ? far->y : hypot(far->x, far->y);
    const chart_rule zero = {.upright = true};
    static const char *const dashes[] = {"solid: sagittal, dashed: tangential"};
    const chart_panel panel[] = {
        {.title = "field curvature",
         .x_label = afocal ? "vergence at the last surface (dioptres)"
                           : look_text("z from the image (%s)", *units ? units : "length"),
         .y_label = look_field_axis(l),
         .y_low = fmin(end, 0),
         .y_high = fmax(end, 0),
         .series_count = 2 * l->bands,
         .series = focus,
         .note = dashes,
         .notes = 1,
         .rules = 1,
         .rule = &zero},
        {.title = afocal ? "distortion of angles" : look_text("distortion against %s", field_ideal(l, a)),
         .x_label = "distortion (%)",
         .y_label = look_field_axis(l),
         .y_low = fmin(end, 0),
         .y_high = fmax(end, 0),
         .series_count = l->bands,
         .series = shift,
         .rules = 1,
         .rule = &zero},
    };
    const char *line[] = {look_lens_line(l), "along the real chief ray"};
    chart_write(l->asked->picture,
                &(chart){.title = look_title(l, "field curves"), .line = line, .lines = 2, .columns = 2,
                         .panels = 2, .panel = panel, .same_y = true});
}

exit_status command_field(int argc, char *argv[])
{
    column columns[] = {
        {"field", COLUMN_COUNT}, {"wavelength", COLUMN_EXACT}, {"tangential", COLUMN_NUMBER},
        {"sagittal", COLUMN_NUMBER}, {"distortion", COLUMN_NUMBER}, {"fx", COLUMN_NUMBER},
        {"fy", COLUMN_NUMBER}, {"fate", COLUMN_CODE}, {"x", COLUMN_NUMBER}, {"y", COLUMN_NUMBER},
        {"xy_err", COLUMN_ERROR}, {"ideal", COLUMN_NUMBER}, {"digits", COLUMN_COUNT}, {"lacks", COLUMN_COUNT},
    };
    enum { COUNT = sizeof columns / sizeof columns[0] };
    const field_arguments a = field_arguments_of(argc, argv);
    look l = look_begin(&a.look);
    const size_t count = a.steps ? (size_t)a.steps : l.fields.count;
    const bool afocal = l.primary.lens.of->afocal;
    if (afocal && a.distortion == SGT_DISTORTION_THETA)
        note("--distortion theta: not used; of an afocal lens tangents of angles are compared");
    if (afocal && isnan(l.um))
        note("units of the lens must be mm, cm, m, um or in for vergences in dioptres");
    if (afocal) {
        columns[2].name = "tangential_dioptre", columns[3].name = "sagittal_dioptre";
        columns[8].name = "x_mrad", columns[9].name = "y_mrad", columns[10].name = "xy_err_mrad";
        columns[11].name = "ideal_mrad";
    }
    const bool text = a.look.shared.target.format == TABLE_TEXT; /* a sentence tells what lacks */
    size_t lacks = 0;
    table *t = table_begin(&a.look.shared.target, text ? COUNT - 1 : COUNT, columns);
    for (size_t f = 0; f < count; f++) {
        if (f > 0) table_gap(t);
        const sgt_lens_field at = a.steps ? field_step(&l, f, count) : l.fields.at[f];
        for (size_t b = 0; b < l.bands; b++) {
            const sgt_field_point p = field_point(&l, &a, &l.band[b], at);
            field_row(t, &l, a.steps ? f : l.fields.number[f], &l.band[b], at, &p);
            if (!lacks) lacks = p.lacks;
        }
    }
    if (afocal)
        table_line(t, "Vergences at the last surface, in dioptres (1/m); angles of the chief ray from its "
                      "z.\ndistortion: of tangents, against the angular magnification.");
    else
        table_line(t, "tangential, sagittal: z from the image surface.  distortion: a fraction, against %s.",
                   field_ideal(&l, &a));
    if (lacks)
        table_line(t, "No tangential and sagittal image, and no digits, where a chief ray goes through "
                      "surface %zu: its type (%s) has no second derivatives.",
                   lacks, l.primary.lens.surface[lacks - 1].type);
    look_verdict(t, &l);
    table_end(t);
    if (a.look.picture) draw_field(&l, &a);
    return look_status(&l);
}
