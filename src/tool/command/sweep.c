/* sweep.c - sagitta sweep: the picture, shares of fates against the field, a panel for each wavelength. */
#include "commands.h"
#include "../base/memory.h"
#include "../look/look.h"

#include <math.h>

enum { FATES = 6 };

/* In per cent. */
static double sweep_share(const sgt_sweep_row *r, int which)
{
    const size_t each[FATES] = {r->passed, r->missed, r->clipped, r->tir, r->lost, r->none};
    return 100 * (double)each[which] / (double)r->rays;
}

static chart_panel sweep_panel(const look *l, size_t band)
{
    static const char *const names[FATES] = {"passed", "missed", "clipped", "totally reflected", "lost",
                                             "no such ray"};
    static const chart_mark marks[FATES] = {CHART_NO_MARK, CHART_TRIANGLE, CHART_CROSS, CHART_RING,
                                            CHART_SQUARE, CHART_DIAMOND};
    const size_t steps = l->rows / l->bands;
    const sgt_sweep_row *first = look_row(l, band * steps), *last = first + steps - 1;
    chart_series *series = memory_take(FATES, sizeof *series);
    size_t n = 0;
    for (int k = 0; k < FATES; k++) {
        double *x = memory_take(steps, sizeof *x), *y = memory_take(steps, sizeof *y);
        bool any = k == 0;
        for (size_t i = 0; i < steps; i++) {
            x[i] = first[i].at, y[i] = sweep_share(&first[i], k);
            any = any || y[i] > 0;
        }
        if (any)
            series[n++] = (chart_series){.name = names[k], .colour = (size_t)k, .mark = marks[k],
                                         .line = true, .count = steps, .x = x, .y = y};
    }
    return (chart_panel){.title = l->bands > 1 ? look_wavelength_name(l, band) : NULL,
                         .x_label = isfinite(l->primary.of->object_distance)
                                        ? memory_print("object height (%s)", look_unit(l, "at"))
                                        : "field angle (degrees)",
                         .y_label = "rays (%)", .x_low = fmin(first->at, last->at),
                         .x_high = fmax(first->at, last->at), .y_high = 100, .series_count = n,
                         .series = series};
}

static void draw_sweep(const look *l)
{
    chart_panel *panel = memory_take(l->bands, sizeof *panel);
    for (size_t b = 0; b < l->bands; b++) panel[b] = sweep_panel(l, b);
    const char *line[] = {look_lens_line(l), look_fates_line(l, &l->total.fates)};
    chart_write(l->picture, &(chart){.title = look_title(l, l->of->title), .line = line, .lines = 2,
                                     .panels = l->bands, .panel = panel});
}

static exit_status sweep_run(const command *c, int argc, char *argv[])
{
    return look_run(c, &(look_way){.draw = draw_sweep}, argc, argv);
}

const command command_sweep = {
    .name = "sweep", .brief = "what becomes of rays, against the field",
    .often = "from to steps hexapolar grid wavelength picture proof format output",
    .examples = "  sagitta sweep examples/lenses/double_gauss.yaml --to 30 --steps 7\n"
                "  sagitta sweep examples/lenses/double_gauss.yaml --picture sweep.svg\n",
    .run = sweep_run,
};
