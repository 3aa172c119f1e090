// SPDX-License-Identifier: MIT
/* spot.c - sagitta spot: the picture of the spots. */
#include "commands.h"
#include "../base/memory.h"
#include "../look/look.h"

#include <math.h>

/* The row of all wavelengths of a field on an image surface: the last of its bands + 1. */
static const sgt_spot_row *spot_together(const look *l, size_t panel)
{
    return look_row(l, panel * (l->bands + 1) + l->bands);
}

/* Of an afocal lens x and y of the ends are angles from the chief ray; those of the rows are from z. */
static sgt_vec2 spot_centre(const look *l, const sgt_spot_row *row)
{
    const bool centroid = ((const sgt_spot_options *)l->options)->reference == 1;
    if (l->primary.of->afocal && !centroid) return (sgt_vec2){0, 0};
    return (sgt_vec2){row->x, row->y};
}

static chart_series spot_series(const look *l, size_t panel, size_t b)
{
    const look_ends *e = &l->ends[panel * l->bands + b];
    const sgt_vec2 centre = spot_centre(l, spot_together(l, panel));
    double *x = memory_take(e->count, sizeof *x), *y = memory_take(e->count, sizeof *y);
    for (size_t i = 0; i < e->count; i++)
        x[i] = e->end[i].p.x - centre.x, y[i] = e->end[i].p.y - centre.y;
    return (chart_series){.name = look_wavelength_name(l, b), .colour = look_colour(l, b),
                          .mark = (chart_mark)(CHART_DOT + look_colour(l, b) % 3), .count = e->count, .x = x,
                          .y = y};
}

static sgt_fates spot_fates(const look *l, const sgt_spot_row *row)
{
    const sgt_fate_counts *f = &row->fates;
    sgt_fates all = {.rays = row->rays, .passed = row->passed, .missed = f->missed, .clipped = f->clipped,
                     .tir = f->tir, .lost = f->lost, .none = f->none, .proven = f->proven,
                     .evanescent = f->evanescent};
    (void)l;
    return all;
}

static const char *spot_title(const look *l, size_t panel, const sgt_spot_row *row)
{
    const char *name = look_field_name(l, panel / l->surfaces), *units = l->primary.units;
    if (!look_given(l, "defocus")) return name;
    return memory_print("%s, z %s%s%s%s", name, row->defocus < 0 ? "" : "+", look_signed(row->defocus),
                     *units ? " " : "", units);
}

static chart_panel spot_panel(const look *l, size_t panel, double half)
{
    const sgt_spot_row *row = spot_together(l, panel);
    const char *unit = look_unit(l, "rms");
    const sgt_fates fates = spot_fates(l, row);
    chart_series *series = memory_take(l->bands, sizeof *series);
    for (size_t b = 0; b < l->bands; b++) series[b] = spot_series(l, panel, b);
    chart_circle *circle = memory_take(1, sizeof *circle);
    *circle =
        (chart_circle){.radius = row->airy, .name = memory_print("Airy disc, %.4g \302\265m",
                                         l->bands == 1 ? l->band[0].wavelength : l->primary.wavelength)};
    const char **note = memory_take(2, sizeof *note);
    note[0] = isnan(row->rms) ? isnan(row->x) && row->passed ? "no reference" : "no ray passed"
                              : memory_print("RMS %.4g, largest %.4g %s", row->rms, row->geometric, unit);
    note[1] = look_fates_line(l, &fates);
    return (chart_panel){.title = spot_title(l, panel, row), .x_label = memory_print("x (%s)", unit),
                         .y_label = memory_print("y (%s)", unit), .note = note, .notes = 2, .square = true,
                         .bar = true, .x_low = -half, .x_high = half, .y_low = -half, .y_high = half,
                         .series_count = l->bands, .series = series, .circles = isnan(row->airy) ? 0U : 1U,
                         .circle = circle};
}

static void draw_spots(const look *l)
{
    const size_t panels = l->fields.count * l->surfaces;
    double half = 0;
    for (size_t i = 0; i < panels; i++) half = fmax(half, spot_together(l, i)->geometric);
    half = 1.05 * fmax(half, spot_together(l, 0)->airy);
    chart_panel *panel = memory_take(panels, sizeof *panel);
    for (size_t i = 0; i < panels; i++) panel[i] = spot_panel(l, i, half);
    const bool centroid = ((const sgt_spot_options *)l->options)->reference == 1;
    bool more = false;
    for (size_t i = 0; i < panels * l->bands; i++) more = more || l->ends[i].count == LOOK_ENDS;
    const char *line[] = {look_lens_line(l),
                          centroid ? "about the centroid" : "about the chief ray of the primary wavelength",
                          look_fates_line(l, &l->total.fates),
                          memory_print("drawn: the first %d rays of a field and wavelength", LOOK_ENDS)};
    chart_write(l->picture, &(chart){.title = look_title(l, l->of->title), .line = line, .lines = 3U + more,
                                     .columns = look_given(l, "defocus") ? l->surfaces : 0, .panels = panels,
                                     .panel = panel, .same_x = true, .same_y = true});
}

static exit_status spot_run(const command *c, int argc, char *argv[])
{
    return look_run(c, &(look_way){.draw = draw_spots, .ends = true}, argc, argv);
}

const command command_spot = {
    .name = "spot", .brief = "spot diagrams: how rays scatter at the image",
    .often = "fields field hexapolar grid wavelength reference defocus picture proof format output",
    .examples = "  sagitta spot examples/lenses/cooke_triplet.yaml\n"
                "  sagitta spot examples/lenses/cooke_triplet.yaml --hexapolar 20 --picture spots.svg\n",
    .run = spot_run,
};
