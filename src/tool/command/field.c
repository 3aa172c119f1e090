// SPDX-License-Identifier: MIT
/* field.c - sagitta field: the picture of field curvature, astigmatism and distortion.
 *
 * A curve needs more points than a lens has fields: with --picture there are STEPS of them, from the axis to
 * the farthest, and the table has these. */
#include "commands.h"
#include "../base/memory.h"
#include "../look/look.h"

#include <math.h>
#include <string.h>

static void check_field(look *l)
{
    enum { STEPS = 33 };
    sgt_field_options *o = l->options;
    if (l->picture && !o->steps) o->steps = STEPS;
    for (const char *name = l->shared.target.columns; name;
         name = strchr(name, ',') ? strchr(name, ',') + 1 : NULL)
        if (strcspn(name, ",") == strlen("distortion") &&
            strncmp(name, "distortion", strlen("distortion")) == 0)
            fail_usage("--columns: distortion is named distortion_percent, and is in per cent");
}

/* What an image without distortion is, unless the lens is afocal. */
static const char *field_ideal(const look *l)
{
    const sgt_field_options *o = l->options;
    const bool finite = isfinite(l->primary.of->object_distance);
    switch ((sgt_distortion)o->distortion) {
    case SGT_DISTORTION_THETA: return "f theta";
    case SGT_DISTORTION_TAN_SURFACE:
        return finite ? "the magnification, on the surface" : "f tan(theta) on the surface";
    case SGT_DISTORTION_THETA_SURFACE: return "f theta on the surface";
    default: return finite ? "the magnification" : "f tan(theta)";
    }
}

/* The field of a row, along the line from the axis to the farthest. */
static double field_height(const sgt_field_row *row, const sgt_field_row *far)
{
    return far->fx == 0 ? row->fy : hypot(row->fx, row->fy);
}

/* The rows are those of one field after another, each with all wavelengths. */
static chart_series field_series(const look *l, size_t band, const char *name)
{
    const size_t steps = l->rows / l->bands, place = look_column(l, name);
    const sgt_field_row *far = look_row(l, l->rows - 1);
    double *x = memory_take(steps, sizeof *x), *y = memory_take(steps, sizeof *y);
    for (size_t i = 0; i < steps; i++) {
        const sgt_field_row *row = look_row(l, i * l->bands + band);
        x[i] = look_value(l, row, place), y[i] = field_height(row, far);
    }
    return (chart_series){.name = look_wavelength_name(l, band), .colour = look_colour(l, band), .line = true,
                          .count = steps, .x = x, .y = y};
}

static void draw_field(const look *l)
{
    static const char *const dashes[] = {"solid: sagittal, dashed: tangential"};
    chart_series *focus = memory_take(2 * l->bands, sizeof *focus),
                 *shift = memory_take(l->bands, sizeof *shift);
    for (size_t b = 0; b < l->bands; b++) {
        focus[2 * b] = field_series(l, b, "tangential"), focus[2 * b + 1] = field_series(l, b, "sagittal");
        focus[2 * b].name = NULL, focus[2 * b].dash = CHART_DASHED;
        shift[b] = field_series(l, b, "distortion_percent");
    }
    const bool afocal = l->primary.of->afocal;
    const sgt_field_row *far = look_row(l, l->rows - 1);
    const double end = field_height(far, far);
    const chart_rule zero = {.upright = true};
    const chart_panel panel[] = {
        {.title = "field curvature", .x_label = afocal ? "vergence at the last surface (dioptres)"
                           : memory_print("z from the image (%s)", look_unit(l, "sagittal")),
         .y_label = look_field_axis(l), .y_low = fmin(end, 0), .y_high = fmax(end, 0),
         .series_count = 2 * l->bands, .series = focus, .note = dashes, .notes = 1, .rules = 1,
         .rule = &zero},
        {.title = afocal ? "distortion of angles" : memory_print("distortion against %s", field_ideal(l)),
         .x_label = "distortion (%)", .y_label = look_field_axis(l), .y_low = fmin(end, 0),
         .y_high = fmax(end, 0), .series_count = l->bands, .series = shift, .rules = 1, .rule = &zero},
    };
    const char *line[] = {look_lens_line(l), "along the real chief ray"};
    chart_write(l->picture, &(chart){.title = look_title(l, l->of->title), .line = line, .lines = 2,
                                     .columns = 2, .panels = 2, .panel = panel, .same_y = true});
}

static exit_status field_run(const command *c, int argc, char *argv[])
{
    return look_run(c, &(look_way){.draw = draw_field, .check = check_field}, argc, argv);
}

const command command_field = {
    .name = "field", .brief = "field curvature, astigmatism, distortion",
    .often = "fields steps field distortion wavelength aim picture format output",
    .examples = "  sagitta field examples/lenses/cooke_triplet.yaml\n"
                "  sagitta field examples/lenses/cooke_triplet.yaml --steps 11 --picture field.svg\n",
    .run = field_run,
};
