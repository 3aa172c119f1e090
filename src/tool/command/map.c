// SPDX-License-Identifier: MIT
/* map.c - sagitta map: the picture, a map for each field and wavelength, or for each wavelength. */
#include "commands.h"
#include "../base/memory.h"
#include "../look/net.h"

#include <math.h>
#include <string.h>

typedef enum map_number { MAP_FATE, MAP_ELEMENT, MAP_EVALS, MAP_T_ERR, MAP_CONDITION } map_number;
static const char *const map_names[] = {"fate", "element", "evals", "t_err", "condition"};
static map_number map_of;

static void take_of(void *into, const option_row *row, const char *value)
{
    (void)into;
    map_of = (map_number)options_word(row, value);
}

static const option_row map_own[] = {
    {"of", "NUMBER", "what the picture shows: fate (the default), element, evals, t_err, condition",
     OPTION_TAKE, .words = "fate element evals t_err condition", .take = take_of},
    {0},
};

static bool over_field(const look *l) { return ((const sgt_map_options *)l->options)->over == 1; }

static void check_map(look *l)
{
    const sgt_map_options *o = l->options;
    const job_options *j = &l->job;
    size_t n;
    bool cells;
    if (o->steps && !o->over) fail_usage("--steps goes with --over field; over the pupil give --cells N");
    if (o->over && (j->points || j->pupils > 1))
        fail_usage("--over field sends one ray of each field: the chief ray, or that of one --pupil");
    if (l->picture && !o->over && !look_is_net(l, &n, &cells))
        fail_usage("--picture: a map is drawn of --cells N or --grid N%s",
                   j->pupils ? ", not of --pupil" : "");
}

/* What became of a ray as a number: the element where it ended, 0 if it passed; or its fate. */
static size_t map_kind(const look *l, const sgt_map_row *row)
{
    enum { PASSED, MISSED, CLIPPED, TIR, LOST, NONE, EVANESCENT };
    if (row->fate == SGT_NO_RAY) return map_of == MAP_FATE ? NONE : l->primary.count + 1;
    if (row->fate == SGT_PASSED) return PASSED;
    if (map_of == MAP_ELEMENT) return row->element;
    return row->fate == SGT_MISSED    ? MISSED
           : row->fate == SGT_CLIPPED ? CLIPPED
           : row->fate == SGT_TIR     ? TIR
           : row->fate == SGT_EVANESCENT ? EVANESCENT
                                         : LOST;
}

/* Names for those kinds that there are. */
typedef struct map_kinds { size_t count; const char **name; double *place; } map_kinds;

static map_kinds map_kinds_of(const look *l)
{
    static const char *const fates[] = {"passed", "missed",     "clipped", "totally reflected",
                                        "lost",   "no such ray", "evanescent"};
    const lens *of = &l->primary;
    const bool fate = map_of == MAP_FATE;
    const size_t most = fate ? sizeof fates / sizeof *fates : of->count + 2;
    map_kinds k = {.count = 0};
    if (!fate && map_of != MAP_ELEMENT) return k;
    bool *there = memory_take(most, sizeof *there);
    k.name = memory_take(most, sizeof *k.name), k.place = memory_take(most, sizeof *k.place);
    for (size_t i = 0; i < l->rows; i++) there[map_kind(l, look_row(l, i))] = true;
    for (size_t i = 0; i < most; i++) {
        if (!there[i]) continue;
        k.place[i] = (double)k.count;
        k.name[k.count++] = fate            ? fates[i]
                            : i == 0        ? "passed"
                            : i > of->count ? "no such ray"
                                            : memory_print("ends at %zu (%s)", i, of->surface[i - 1].type);
    }
    return k;
}

static double map_value(const look *l, const map_kinds *kinds, const sgt_map_row *row)
{
    if (kinds->count) return kinds->place[map_kind(l, row)];
    if (!row->element) return (double)NAN;
    return map_of == MAP_EVALS ? (double)row->evals : map_of == MAP_T_ERR ? row->t_err : row->condition;
}

/* Over the field the rows are those of the net, from below: values in their order. */
static chart_map map_over_field(const look *l, size_t first, size_t count, double value[], const char *label)
{
    const size_t n = (size_t)lround(sqrt((double)count));
    const sgt_map_row *last = look_row(l, first + count - 1);
    const double edge = n > 1 ? last->fx * (1 + 1 / (double)(n - 1)) : last->fx;
    return (chart_map){.columns = n, .rows = n, .x_low = -edge, .x_high = edge, .y_low = -edge,
                       .y_high = edge, .value = value, .label = label};
}

static const char *map_title(const look *l, size_t panel)
{
    const char *name = look_wavelength_name(l, panel % l->bands);
    if (over_field(l)) return name ? name : "";
    const char *field = look_field_name(l, panel / l->bands);
    return l->bands > 1 ? memory_print("%s, %s", field, name) : field;
}

static void draw_fates(const look *l)
{
    const bool field = over_field(l);
    const size_t panels = field ? l->bands : l->fields.count * l->bands, points = l->rows / panels;
    const map_kinds kinds = map_kinds_of(l);
    const char *label = look_label(l, map_names[map_of]);
    chart_map *map = memory_take(panels, sizeof *map);
    chart_panel *panel = memory_take(panels, sizeof *panel);
    size_t n;
    bool cells;
    look_is_net(l, &n, &cells);
    for (size_t p = 0; p < panels; p++) {
        double *value = memory_take(points, sizeof *value);
        for (size_t i = 0; i < points; i++) value[i] = map_value(l, &kinds, look_row(l, p * points + i));
        map[p] = field ? map_over_field(l, p * points, points, value, label)
                       : look_net(l, p * points, points, n, cells, value, label);
        map[p].kinds = kinds.count ? kinds.name : NULL, map[p].kind_count = kinds.count;
        panel[p] = (chart_panel){.title = map_title(l, p), .square = true, .map = &map[p],
                                 .x_label = field ? memory_print("x, %s", look_field_axis(l)) : "px",
                                 .y_label = field ? memory_print("y, %s", look_field_axis(l)) : "py"};
    }
    if (!kinds.count) look_same_scale(panels, map);
    const char *line[] = {look_lens_line(l), look_fates_line(l, &l->total.fates)};
    const char *number = map_of == MAP_FATE      ? "fates"
                         : map_of == MAP_ELEMENT ? "where rays end"
                                                 : map_names[map_of];
    const char *what = memory_print("%s, over the %s", number, field ? "field" : "pupil");
    chart_write(l->picture, &(chart){.title = look_title(l, what), .line = line, .lines = 2,
                                     .panels = panels, .panel = panel});
}

static exit_status map_run(const command *c, int argc, char *argv[])
{
    return look_run(c, &(look_way){.draw = draw_fates, .check = check_map, .own = map_own}, argc, argv);
}

const command command_map = {
    .name = "map", .brief = "where rays are lost, over pupil or field",
    .often = "over cells steps of fields field wavelength picture proof format output",
    .examples = "  sagitta map examples/lenses/double_gauss.yaml --cells 11\n"
                "  sagitta map examples/lenses/double_gauss.yaml --over field --of evals --picture map.png\n",
    .run = map_run,
};
