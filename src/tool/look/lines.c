/* lines.c - a field has two panels: the line in y, and that in x. */
#include "lines.h"

#include "../base/memory.h"
#include "../draw/chart.h"

#include <math.h>

void look_lines_check(const launch_pattern *points)
{
    size_t count[2] = {0, 0};
    for (size_t i = 0; i < points->count; i++)
        count[0] += points->at[i].x == 0, count[1] += points->at[i].y == 0;
    if (count[0] < 2 && count[1] < 2)
        fail_usage("--picture: these rays are on no line across the pupil; give --cross N or --fan N");
}

look_lines look_lines_for(const look *l, const launch_pattern *points)
{
    look_lines all = {.bands = l->bands};
    for (int k = 0; k < 2; k++) {
        all.line[k] = memory_take(l->bands, sizeof *all.line[k]);
        for (size_t b = 0; b < l->bands; b++) {
            all.line[k][b].at = memory_take(points->count, sizeof(double));
            all.line[k][b].value = memory_take(points->count, sizeof(double));
        }
    }
    return all;
}

/* Keeps the points of a line in order.  A cross sends its centre with the line in y, so the centre reaches
 * the line in x first. */
static void add_to_line(struct look_line *line, double at, double value)
{
    size_t i = line->count++;
    for (; i > 0 && line->at[i - 1] > at; i--)
        line->at[i] = line->at[i - 1], line->value[i] = line->value[i - 1];
    line->at[i] = at, line->value[i] = value;
}

void look_lines_add(look_lines *of, size_t band, const sgt_ray_end *end, double tangential, double sagittal)
{
    if (end->px == 0) add_to_line(&of->line[0][band], end->py, tangential);
    if (end->py == 0) add_to_line(&of->line[1][band], end->px, sagittal);
}

static chart_panel lines_panel(const look *l, const look_lines *of, size_t field, int k, const char *label)
{
    chart_series *series = memory_take(of->bands, sizeof *series);
    for (size_t b = 0; b < of->bands; b++)
        series[b] = (chart_series){.name = look_wavelength_name(&l->band[b]),
                                   .colour = look_colour(l, b),
                                   .mark = CHART_NO_MARK,
                                   .dash = (chart_dash)(look_colour(l, b) % 3),
                                   .line = true,
                                   .count = of->line[k][b].count,
                                   .x = of->line[k][b].at,
                                   .y = of->line[k][b].value};
    return (chart_panel){.title =
                             look_text("%s, %s", look_field_name(l, field), k ? "sagittal" : "tangential"),
                         .x_label = k ? "px (pupil radii)" : "py (pupil radii)",
                         .y_label = label,
                         .x_low = -1,
                         .x_high = 1,
                         .series_count = of->bands,
                         .series = series};
}

void look_lines_draw(const look *l, const look_lines of[], const char *what, const char *line,
                     const char *tangential_label, const char *sagittal_label)
{
    size_t n = 0;
    chart_panel *panel = memory_take(2 * l->fields.count, sizeof *panel);
    const bool any[2] = {of[0].line[0][0].count > 1, of[0].line[1][0].count > 1};
    for (size_t f = 0; f < l->fields.count; f++)
        for (int k = 0; k < 2; k++)
            if (any[k]) panel[n++] = lines_panel(l, &of[f], f, k, k ? sagittal_label : tangential_label);
    const char *lines[] = {look_lens_line(l), line, look_fates_line(l, &l->fates)};
    chart_write(l->asked->picture,
                &(chart){.title = look_title(l, what), .line = lines, .lines = 3,
                         .columns = any[0] && any[1] ? 2 : 0, .panels = n, .panel = panel, .same_x = true,
                         .same_y = true});
}
