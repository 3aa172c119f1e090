// SPDX-License-Identifier: MIT
/* curves.c - one column against another, as an analysis says: a panel for each field (one for all if
 * that is the field), a curve for each wavelength, in the order of the rows. */
#include "look.h"

#include "../base/memory.h"

#include <math.h>
#include <string.h>

/* Which panel and which curve a row is of. */
typedef struct place { size_t panel, curve; } place;

static bool against_field(const look *l) { return l->of->draw_x && strcmp(l->of->draw_x, "field") == 0; }

/* What is drawn against the field has one panel for all of them. */
static bool panel_each_field(const look *l)
{
    return look_column(l, "field") < l->of->columns && (l->over || !against_field(l));
}

/* Do all fields lie in the y-z plane?  Then an axis of fields has their angles or heights, else numbers. */
static bool fields_upright(const look *l)
{
    bool upright = true;
    for (size_t i = 0; i < l->fields.count; i++) upright = upright && l->fields.at[i].x == 0;
    return upright;
}

static double x_of_row(const look *l, size_t i)
{
    const void *row = look_row(l, i);
    if (l->over) return l->row_at[i];
    const double x = look_value(l, row, look_column(l, l->of->draw_x));
    return against_field(l) && fields_upright(l) ? l->fields.at[look_field_of(l, (size_t)x)].y : x;
}

static const char *label_of_x(const look *l)
{
    if (!against_field(l)) return look_label(l, l->of->draw_x);
    return fields_upright(l) ? look_field_axis(l) : "number of the field";
}

static place place_of_row(const look *l, const void *row)
{
    const size_t field = look_column(l, "field"), wavelength = look_column(l, "wavelength");
    place p = {0, 0};
    if (panel_each_field(l)) p.panel = look_field_of(l, (size_t)look_value(l, row, field));
    if (wavelength < l->of->columns) p.curve = look_band_of(l, look_value(l, row, wavelength));
    return p;
}

static chart_series curve_of(const look *l, const char *figure, place at)
{
    const size_t y = look_column(l, figure);
    /* (of fields only those that are asked have a value) */
    chart_series s = {.line = true, .mark = against_field(l) && !l->over ? CHART_RING : CHART_NO_MARK};
    double *xs = memory_take(l->rows + 1, sizeof *xs), *ys = memory_take(l->rows + 1, sizeof *ys);
    for (size_t i = 0; i < l->rows; i++) {
        const void *row = look_row(l, i);
        const place own = place_of_row(l, row);
        if (own.panel != at.panel || own.curve != at.curve) continue;
        xs[s.count] = x_of_row(l, i), ys[s.count++] = look_value(l, row, y);
    }
    const bool together = at.curve == l->bands;
    s.name = together ? l->bands > 1 ? "all wavelengths" : NULL : look_wavelength_name(l, at.curve);
    s.colour = together ? l->bands : look_colour(l, at.curve);
    s.dash = together ? CHART_DASHED : CHART_SOLID;
    s.x = xs, s.y = ys;
    return s;
}

static void draw_columns(const look *l, const char *x_label, const char *figure, const char *title)
{
    const bool fields = panel_each_field(l);
    const size_t panels = fields ? l->fields.count : 1;
    chart_panel *panel = memory_take(panels, sizeof *panel);
    for (size_t p = 0; p < panels; p++) {
        chart_series *series = memory_take(l->bands + 1, sizeof *series);
        size_t count = 0;
        for (size_t b = 0; b <= l->bands; b++) {
            if (b == l->bands && l->bands == 1) continue; /* the same as the one wavelength */
            const chart_series s = curve_of(l, figure, (place){p, b});
            if (s.count) series[count++] = s;
        }
        panel[p] = (chart_panel){.title = fields ? look_field_name(l, p) : NULL,
                                 .x_label = x_label, .y_label = look_label(l, figure),
                                 .series_count = count, .series = series};
    }
    const char *line[] = {look_lens_line(l), look_fates_line(l, &l->total.fates)};
    chart_write(l->picture, &(chart){.title = look_title(l, title), .line = line, .lines = 2,
                                     .panels = panels, .panel = panel, .same_x = true, .same_y = true});
}

void look_draw_curves(const look *l)
{
    if (!l->of->draw_x) note("--picture: %s has none", l->of->name);
    else draw_columns(l, label_of_x(l), l->of->draw_y, l->of->title);
}

void look_draw_over(const look *l, const char *path, const char *figure)
{
    draw_columns(l, path, figure, memory_print("%s over %s", figure, path));
}
