// SPDX-License-Identifier: MIT
/* sweep.c - sagitta sweep: the picture, shares of fates against the field, a panel for each wavelength.
 *
 * With --over PATH the figures of an analysis against a number of the lens: each step is the lens with
 * another value, asked anew.  Which analysis it is has to be known before the options are read, since they
 * are its own. */
#include "commands.h"
#include "../base/memory.h"
#include "../look/look.h"

#include <math.h>
#include <string.h>

enum { FATES = 7 };

/* In per cent. */
static double sweep_share(const sgt_sweep_row *r, int which)
{
    const size_t each[FATES] = {r->passed, r->missed, r->clipped, r->tir, r->lost, r->none,
                                  r->evanescent};
    return 100 * (double)each[which] / (double)r->rays;
}

static chart_panel sweep_panel(const look *l, size_t band)
{
    static const char *const names[FATES] = {"passed", "missed", "clipped", "totally reflected", "lost",
                                             "no such ray", "evanescent"};
    static const chart_mark marks[FATES] = {CHART_NO_MARK, CHART_TRIANGLE, CHART_CROSS, CHART_RING,
                                            CHART_SQUARE, CHART_DIAMOND, CHART_RING};
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

/* ----------------------------------------------------- over a number of the lens */

static const char *over_path, *over_column;
static double over_from = (double)NAN, over_to = (double)NAN;
static int over_steps = 46;

static void take_over(void *into, const option_row *row, const char *value)
{
    (void)into;
    if (strcmp(row->name, "over") == 0) over_path = value;
    else if (strcmp(row->name, "of") == 0) over_column = value;
    else if (strcmp(row->name, "from") == 0) over_from = options_number(row->name, value);
    else if (strcmp(row->name, "to") == 0) over_to = options_number(row->name, value);
    else if (strcmp(row->name, "steps") == 0)
        over_steps = (int)options_integer(row->name, value, 2, 1000000);
}

static const char *figure_of(const look *l)
{
    if (over_column) return over_column;
    return look_column(l, "rms") < l->of->columns ? "rms" : l->of->draw_y;
}

static void check_over(look *l)
{
    if (over_column && look_column(l, over_column) == l->of->columns)
        fail_usage("--of: %s has no column \"%s\"", l->of->name, over_column);
    if (l->picture && look_column(l, "px") < l->of->columns)
        fail_usage("--picture: %s has a row for each ray, and no figure of a field", l->of->name);
    if (l->picture && !figure_of(l)) fail_usage("--picture goes with --of COLUMN here");
}

static void draw_over(const look *l) { look_draw_over(l, over_path, figure_of(l)); }

#define OVER_ROW                                                                                       \
    {"over", "PATH",                                                                                   \
     "the figures of an analysis against a number of the lens: surfaces[3].thickness\n"                \
     "PATH is a place in the lens file (docs/lens_file.md#paths).  With --from and --to",              \
     OPTION_TAKE, .take = take_over},                                                                  \
    {"figure", "WORD", "with --over: which analysis (default spot); its options may be given, too",    \
     OPTION_TAKE, .take = take_over},                                                                  \
    {"of", "COLUMN", "with --over: what the picture shows (default rms, where there is one)",          \
     OPTION_TAKE, .take = take_over}
static const option_row sweep_own[] = {OVER_ROW, {0}};
static const option_row over_own[] = {
    OVER_ROW,
    {"from", "X", "the first value of PATH,", OPTION_TAKE, .take = take_over},
    {"to", "X", "and the last", OPTION_TAKE, .take = take_over},
    {"steps", "N", "how many values (default 46)", OPTION_TAKE, .take = take_over},
    {0},
};

/* The value of an option as it is given: --over X, --over=X; NULL: it is not. */
static const char *argument_of(const char *name, int argc, char *argv[])
{
    const size_t length = strlen(name);
    for (int i = 1; i < argc; i++) {
        const char *a = argv[i];
        if (strncmp(a, "--", 2) != 0 || strncmp(a + 2, name, length) != 0) continue;
        if (a[2 + length] == '=') return a + 3 + length;
        if (!a[2 + length]) return i + 1 < argc ? argv[i + 1] : "";
    }
    return NULL;
}

static exit_status sweep_run(const command *c, int argc, char *argv[])
{
    const char *figure = argument_of("figure", argc, argv);
    const look_over over = {.analysis = figure ? figure : "spot", .path = &over_path, .from = &over_from,
                            .to = &over_to, .steps = &over_steps};
    if (!argument_of("over", argc, argv)) {
        if (figure || argument_of("of", argc, argv)) fail_usage("--figure and --of go with --over");
        return look_run(c, &(look_way){.draw = draw_sweep, .own = sweep_own}, argc, argv);
    }
    return look_run(c, &(look_way){.draw = draw_over, .own = over_own, .over = &over, .check = check_over},
                    argc, argv);
}

const command command_sweep = {
    .name = "sweep", .brief = "what becomes of rays, against the field; figures against any number",
    .often = "from to steps over hexapolar grid wavelength picture proof format output",
    .examples = "  sagitta sweep examples/lenses/double_gauss.yaml --to 30 --steps 7\n"
                "  sagitta sweep examples/lenses/double_gauss.yaml --picture sweep.svg\n"
                "  sagitta sweep examples/lenses/cooke_triplet.yaml --over surfaces[6].thickness --from 42 "
                "--to 43\n",
    .run = sweep_run,
};
