// SPDX-License-Identifier: MIT
/* lines.c - a field has two panels: the line in y, and that in x. */
#include "lines.h"

#include "../base/memory.h"

#include <math.h>

void look_lines_check(look *l)
{
    const job_options *o = &l->job;
    const job_points_asked asked = job_points_of(o, l->of->pattern);
    const bool fits = asked.pattern == SGT_PATTERN_FAN || asked.pattern == SGT_PATTERN_CROSS;
    size_t count[2] = {0, 0};
    if (!l->picture || (fits && !asked.count)) return;
    const launch_pattern points = job_points(o, l->of->pattern, l->of->rays);
    for (size_t i = 0; i < points.count; i++) {
        sgt_pupil_point at;
        launch_points_part(&points, i, 1, &at);
        count[0] += at.x == 0, count[1] += at.y == 0;
    }
    if (count[0] < 2 && count[1] < 2)
        fail_usage("--picture: these rays are on no line across the pupil; give --cross N or --fan N");
}

/* One line of a field at a wavelength, in the order of its points. */
static chart_series line_of(const look *l, size_t field, size_t band, int k, const char *name)
{
    const size_t px = look_column(l, "px"), py = look_column(l, "py"), value = look_column(l, name);
    const size_t number = look_column(l, "field"), um = look_column(l, "wavelength");
    double *x = memory_take(l->rows + 1, sizeof *x), *y = memory_take(l->rows + 1, sizeof *y);
    size_t count = 0;
    for (size_t r = 0; r < l->rows; r++) {
        const void *row = look_row(l, r);
        const double along = look_value(l, row, k ? px : py), across = look_value(l, row, k ? py : px);
        if (across != 0 || look_field_of(l, (size_t)look_value(l, row, number)) != field ||
            look_band_of(l, look_value(l, row, um)) != band)
            continue;
        size_t i = count++; /* a cross sends its centre with the line in y: it reaches that in x first */
        for (; i > 0 && x[i - 1] > along; i--) x[i] = x[i - 1], y[i] = y[i - 1];
        x[i] = along, y[i] = look_value(l, row, value);
    }
    return (chart_series){.name = look_wavelength_name(l, band), .colour = look_colour(l, band),
                          .mark = CHART_NO_MARK, .dash = (chart_dash)(look_colour(l, band) % 3),
                          .line = true, .count = count, .x = x, .y = y};
}

void look_lines_draw(const look *l, const char *line, const char *tangential, const char *sagittal)
{
    chart_panel *panel = memory_take(2 * l->fields.count, sizeof *panel);
    size_t n = 0;
    bool both = true;
    for (size_t f = 0; f < l->fields.count; f++)
        for (int k = 0; k < 2; k++) {
            chart_series *series = memory_take(l->bands, sizeof *series);
            const char *name = k ? sagittal : tangential;
            for (size_t b = 0; b < l->bands; b++) series[b] = line_of(l, f, b, k, name);
            both = both && series[0].count > 1;
            if (series[0].count < 2) continue;
            panel[n++] = (chart_panel){
                .title = memory_print("%s, %s", look_field_name(l, f), k ? "sagittal" : "tangential"),
                .x_label = k ? "px (pupil radii)" : "py (pupil radii)", .y_label = look_label(l, name),
                .x_low = -1, .x_high = 1, .series_count = l->bands, .series = series};
        }
    const char *lines[] = {look_lens_line(l), line, look_fates_line(l, &l->total.fates)};
    chart_write(l->picture,
                &(chart){.title = look_title(l, l->of->title), .line = lines, .lines = 3,
                         .columns = both ? 2 : 0, .panels = n, .panel = panel, .same_x = true,
                         .same_y = true});
}
