// SPDX-License-Identifier: MIT
/* opd.c - sagitta opd: its views (--summary, --zernike N), and pictures of wavefronts: maps of an area, else
 * lines across the pupil. */
#include "commands.h"
#include "../base/memory.h"
#include "../look/lines.h"
#include "../look/net.h"

#include <string.h>

static bool opd_is_map(const look *l)
{
    size_t n;
    bool cells;
    return look_is_net(l, &n, &cells);
}

static void check_opd(look *l)
{
    if (l->picture && !opd_is_map(l)) look_lines_check(l);
}

static const char opd_against[] = "in waves, against the chief ray of each wavelength";

static void draw_opd_maps(const look *asked, const look *l)
{
    const size_t panels = l->fields.count * l->bands, points = l->rows / panels,
                 value = look_column(l, "opd");
    chart_panel *panel = memory_take(panels, sizeof *panel);
    chart_map *map = memory_take(panels, sizeof *map);
    double *waves = memory_take(points, sizeof *waves);
    size_t n;
    bool cells;
    look_is_net(asked, &n, &cells);
    for (size_t i = 0; i < panels; i++) {
        for (size_t k = 0; k < points; k++) waves[k] = look_value(l, look_row(l, i * points + k), value);
        map[i] = look_net(l, i * points, points, n, cells, waves, "waves");
        map[i].about_zero = true;
        panel[i] = (chart_panel){.title = memory_print("%s, %s", look_field_name(l, i / l->bands),
                                                    look_wavelength_name(l, i % l->bands)),
                                 .x_label = "px", .y_label = "py", .square = true, .map = &map[i]};
    }
    look_same_scale(panels, map);
    const char *line[] = {look_lens_line(l), opd_against, look_fates_line(l, &l->total.fates)};
    chart_write(l->picture, &(chart){.title = look_title(l, "wavefronts"), .line = line, .lines = 3,
                                     .columns = l->bands > 1 ? l->bands : 0, .panels = panels,
                                     .panel = panel});
}

/* Drawn are the rays, also of those that are summed up in the table. */
static void draw_opd(const look *asked)
{
    const bool summed = strcmp(asked->of->name, "opd") != 0;
    const look rays = summed ? look_again(asked, "opd") : *asked, *l = &rays;
    if (opd_is_map(asked)) draw_opd_maps(asked, l);
    else look_lines_draw(l, opd_against, "opd", "opd");
}

static exit_status opd_run(const command *c, int argc, char *argv[])
{
    static const look_view views[] = {
        {"summary", "wavefront", NULL, "a row for each field and wavelength", false},
        {"zernike", "zernike", "terms", "fits the first N Zernike polynomials", false},
        {NULL, NULL, NULL, NULL, false}};
    return look_run(c, &(look_way){.view = views, .check = check_opd, .draw = draw_opd}, argc, argv);
}

const command command_opd = {
    .name = "opd", .brief = "optical path differences, Zernike polynomials",
    .often = "fields field cross cells wavelength summary zernike order picture format output",
    .examples = "  sagitta opd examples/lenses/cooke_triplet.yaml --summary\n"
                "  sagitta opd examples/lenses/cooke_triplet.yaml --zernike 11 --picture opd.svg\n",
    .run = opd_run,
};
