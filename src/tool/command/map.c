/* map.c - sagitta map: what becomes of rays over the pupil or over the field, point by point. */
#include "commands.h"
#include "../base/memory.h"
#include "../draw/chart.h"
#include "../look/look.h"
#include "../look/net.h"

#include <math.h>
#include <string.h>

static const char map_help[] =
    "sagitta map LENS [options]\n"
    "\n"
    "What becomes of rays, and what they cost: over the pupil of each field (the default), or of one ray of\n"
    "each field over a square of fields.  Where does this lens lose rays?  No number is of the image, so an\n"
    "afocal lens has the same columns.\n"
    "\n"
    "Columns\n"
    "  field, wavelength  the field, counted from 1, or over the field the point; micrometres\n"
    "  fx, fy             the field, as the lens gives it: degrees, or a height (length)\n"
    "  px, py             the point of the pupil, in radii of it\n"
    "  fate, element      passed; missed, clipped, tir, lost; none: proven, no such ray.\n"
    "                     Where it ended, counted from 1\n"
    "  evals              evaluations at all elements together\n"
    "  t_err              the largest bound on the error of a length between elements (length)\n"
    "  condition          the largest 1 / cos of an angle of incidence: a surface that is off along its\n"
    "                     normal moves the hit by so many times as much\n"
    "\n"
    "Options\n"
    "  --over O           pupil (the default) or field: from minus to plus the field of the lens which is\n"
    "                     farthest from the axis, in x and y, by the chief ray or that of --pupil\n"
    "  --steps N          N x N fields (default 21)\n"
    "  --of NUMBER        what the picture shows: fate (the default), element, evals, t_err, condition\n";

typedef enum map_number {
    MAP_FATE,
    MAP_ELEMENT,
    MAP_EVALS,
    MAP_T_ERR,
    MAP_CONDITION,
    MAP_NUMBERS
} map_number;
static const char *const map_names[] = {"fate", "element", "evals", "t_err", "condition"};

typedef struct map_arguments {
    look_options look;
    bool over_field;
    long steps;
    map_number of;
} map_arguments;

static map_arguments map_arguments_of(int argc, char *argv[])
{
    enum { OVER = OPTION_AFTER_LOOK, STEPS, OF, STEPS_MOST = 10000 };
    static const struct option known[] = {
        {"over", required_argument, NULL, OVER}, {"steps", required_argument, NULL, STEPS},
        {"of", required_argument, NULL, OF}, LOOK_OPTIONS, {0},
    };
    map_arguments a = {.look = {.pattern = "--cells 41", .primary_alone = true}};
    for (int code; (code = getopt_long(argc, argv, LOOK_LETTERS, known, NULL)) != -1;) {
        if (code == OVER) {
            a.over_field = strcmp(optarg, "field") == 0;
            if (!a.over_field && strcmp(optarg, "pupil") != 0)
                fail_usage("--over must be pupil or field, not \"%s\"", optarg);
        } else if (code == STEPS) {
            a.steps = options_integer("steps", optarg, 2, STEPS_MOST);
        } else if (code == OF) {
            for (a.of = MAP_FATE; a.of < MAP_NUMBERS && strcmp(optarg, map_names[a.of]) != 0;) a.of++;
            if (a.of == MAP_NUMBERS)
                fail_usage("--of must be fate, element, evals, t_err or condition, not \"%s\"", optarg);
        } else {
            look_take_option(&a.look, code, map_help);
        }
    }
    look_take_lens(&a.look, argc, argv, "map");
    if (a.steps && !a.over_field) fail_usage("--steps goes with --over field; over the pupil give --cells N");
    if (a.over_field && (a.look.job.pattern_given || a.look.job.across || a.look.job.pupils > 1))
        fail_usage("--over field sends one ray of each field: the chief ray, or that of one --pupil");
    if (a.look.picture && !a.over_field && a.look.job.pattern_given &&
        a.look.job.pattern != SGT_PATTERN_CELLS && a.look.job.pattern != SGT_PATTERN_GRID)
        fail_usage("--picture: a map is drawn of --cells N or --grid N");
    if (a.look.picture && !a.over_field && a.look.job.pupils)
        fail_usage("--picture: a map is drawn of --cells N or --grid N, not of --pupil");
    return a;
}

typedef struct map_panel { const char *title; launch_pattern points; const sgt_ray_end *end; } map_panel;

typedef struct map_work {
    const map_arguments *asked;
    look look;
    table *table;
    size_t panels;
    map_panel *panel;          /* without a picture all share the ends of the last */
    size_t steps;              /* over the field */
    double half;               /* of its square */
} map_work;

static void map_row(map_work *w, size_t number, const look_band *band, sgt_lens_field at,
                    const sgt_ray_end *end)
{
    table *t = w->table;
    const bool traced = end->aimed == SGT_MET;
    table_count(t, (long long)number);
    look_number(t, band->lens.wavelength);
    const double each[] = {at.x, at.y, end->px, end->py};
    for (size_t i = 0; i < sizeof each / sizeof *each; i++) table_number(t, each[i]);
    look_fate_cell(t, end);
    if (traced) table_count(t, (long long)end->element + 1);
    else table_empty(t);
    table_count(t, end->evals);
    look_number(t, traced ? end->t_err : (double)NAN);
    look_number(t, traced ? end->condition : (double)NAN);
}

static void map_pupils(map_work *w)
{
    enum { CELLS = 41 };
    look *l = &w->look;
    const launch_pattern points = job_points(&w->asked->look.job, SGT_PATTERN_CELLS, CELLS);
    sgt_ray_end *end = NULL;
    w->panel = memory_take(l->fields.count * l->bands, sizeof *w->panel);
    for (size_t f = 0; f < l->fields.count; f++)
        for (size_t b = 0; b < l->bands; b++) {
            const look_band *band = &l->band[b];
            if (!end || l->asked->picture) end = memory_take(points.count, sizeof *end);
            look_trace(l, &l->beam[f], band, band->element, &points, true, end);
            const char *name = look_wavelength_name(band), *field = look_field_name(l, f);
            if (w->panels > 0) table_gap(w->table);
            for (size_t i = 0; i < points.count; i++)
                map_row(w, l->fields.number[f] + 1, band, l->fields.at[f], &end[i]);
            w->panel[w->panels++] =
                (map_panel){.title = l->bands > 1 ? look_text("%s, %s", field, name) : field,
                            .points = points,
                            .end = end};
        }
}

/* One ray of each field of a net of steps x steps, row by row from below. */
static void map_fields(map_work *w)
{
    look *l = &w->look;
    const job_options *o = &w->asked->look.job;
    const sgt_lens_field *far = look_farthest(l);
    const size_t n = w->steps, count = n * n;
    const launch_pattern one = job_points(o, SGT_PATTERN_FAN, 1);
    sgt_lens_field *at = memory_take(count, sizeof *at);
    sgt_pupil_point *net = memory_take(count, sizeof *net);
    w->half = fmax(fabs(far->x), fabs(far->y));
    if (w->half == 0) fail_usage("--over field: the lens has no field off the axis; give --field");
    w->panel = memory_take(l->bands, sizeof *w->panel);
    for (size_t i = 0; i < count; i++) {
        net[i].x = 2 * (double)(i % n) / (double)(n - 1) - 1,
        net[i].y = 2 * (double)(i / n) / (double)(n - 1) - 1;
        at[i] = (sgt_lens_field){.x = w->half * net[i].x, .y = w->half * net[i].y, .weight = 1};
    }
    for (size_t b = 0; b < l->bands; b++) {
        const look_band *band = &l->band[b];
        sgt_ray_end *end = memory_take(count, sizeof *end);
        for (size_t i = 0; i < count; i++) {
            const sgt_field_beam beam = look_beam(l, l->fields.kind, at[i]);
            look_trace(l, &beam, band, band->element, &one, true, &end[i]);
            if (i == 0 && b > 0) table_gap(w->table);
            map_row(w, i + 1, band, at[i], &end[i]);
        }
        const char *name = look_wavelength_name(band);
        w->panel[w->panels++] = (map_panel){
            .title = name ? name : "", .end = end,
            .points = {.count = count, .n = n, .at = net, .pattern = SGT_PATTERN_GRID}};
    }
}

/* ---------------------------------------------------------------- picture */

/* What became of a ray as a number: the element where it ended, 0 if it passed; or its fate. */
static size_t map_kind(const map_work *w, const sgt_ray_end *end)
{
    enum { PASSED, MISSED, CLIPPED, TIR, LOST, NONE };
    if (end->aimed == SGT_NO_SUCH_RAY)
        return w->asked->of == MAP_FATE ? NONE : w->look.primary.lens.count + 1;
    if (end->fate == SGT_PASSED) return PASSED;
    if (w->asked->of == MAP_ELEMENT) return end->element + 1;
    return end->fate == SGT_MISSED    ? MISSED
           : end->fate == SGT_CLIPPED ? CLIPPED
           : end->fate == SGT_TIR     ? TIR
                                      : LOST;
}

/* Names for those kinds that there are. */
typedef struct map_kinds { size_t count; const char **name; double *place; } map_kinds;

static map_kinds map_kinds_of(const map_work *w)
{
    static const char *const fates[] = {"passed", "missed",     "clipped", "totally reflected",
                                        "lost",   "no such ray"};
    const lens *l = &w->look.primary.lens;
    const bool fate = w->asked->of == MAP_FATE;
    const size_t most = fate ? sizeof fates / sizeof *fates : l->count + 2;
    map_kinds k = {.count = 0};
    if (!fate && w->asked->of != MAP_ELEMENT) return k;
    bool *there = memory_take(most, sizeof *there);
    k.name = memory_take(most, sizeof *k.name), k.place = memory_take(most, sizeof *k.place);
    for (size_t p = 0; p < w->panels; p++)
        for (size_t i = 0; i < w->panel[p].points.count; i++) there[map_kind(w, &w->panel[p].end[i])] = true;
    for (size_t i = 0; i < most; i++) {
        if (!there[i]) continue;
        k.place[i] = (double)k.count;
        k.name[k.count++] = fate          ? fates[i]
                            : i == 0      ? "passed"
                            : i > l->count ? "no such ray"
                                          : look_text("ends at %zu (%s)", i, l->surface[i - 1].type);
    }
    return k;
}

static double map_value(const map_work *w, const map_kinds *kinds, const sgt_ray_end *end)
{
    if (kinds->count) return kinds->place[map_kind(w, end)];
    if (end->aimed != SGT_MET) return (double)NAN;
    return w->asked->of == MAP_EVALS ? end->evals : w->asked->of == MAP_T_ERR ? end->t_err : end->condition;
}

static void map_draw(const map_work *w)
{
    const look *l = &w->look;
    const map_kinds kinds = map_kinds_of(w);
    const char *units = l->primary.lens.units;
    const char *label = w->asked->of == MAP_T_ERR ? look_text("t_err (%s)", *units ? units : "length")
                                                   : map_names[w->asked->of];
    chart_map *map = memory_take(w->panels, sizeof *map);
    chart_panel *panel = memory_take(w->panels, sizeof *panel);
    for (size_t p = 0; p < w->panels; p++) {
        const map_panel *of = &w->panel[p];
        double *value = memory_take(of->points.count, sizeof *value);
        for (size_t i = 0; i < of->points.count; i++) value[i] = map_value(w, &kinds, &of->end[i]);
        map[p] = look_net(&of->points, value, label);
        map[p].kinds = kinds.count ? kinds.name : NULL, map[p].kind_count = kinds.count;
        if (w->asked->over_field)
            map[p].x_low *= w->half, map[p].x_high *= w->half, map[p].y_low *= w->half,
                map[p].y_high *= w->half;
        panel[p] =
            (chart_panel){.title = of->title,
                          .square = true,
                          .map = &map[p],
                          .x_label = w->asked->over_field ? look_text("x, %s", look_field_axis(l)) : "px",
                          .y_label = w->asked->over_field ? look_text("y, %s", look_field_axis(l)) : "py"};
    }
    const char *line[] = {look_lens_line(l), look_fates_line(l, &l->fates)};
    const char *number = w->asked->of == MAP_FATE      ? "fates"
                         : w->asked->of == MAP_ELEMENT ? "where rays end"
                                                       : map_names[w->asked->of];
    const char *what = look_text("%s, over the %s", number, w->asked->over_field ? "field" : "pupil");
    chart_write(l->asked->picture, &(chart){.title = look_title(l, what), .line = line, .lines = 2,
                                            .panels = w->panels, .panel = panel});
}

exit_status command_map(int argc, char *argv[])
{
    enum { STEPS = 21 };
    static const column columns[] = {
        {"field", COLUMN_COUNT}, {"wavelength", COLUMN_EXACT}, {"fx", COLUMN_NUMBER}, {"fy", COLUMN_NUMBER},
        {"px", COLUMN_NUMBER}, {"py", COLUMN_NUMBER}, {"fate", COLUMN_CODE}, {"element", COLUMN_COUNT},
        {"evals", COLUMN_COUNT}, {"t_err", COLUMN_ERROR}, {"condition", COLUMN_NUMBER},
    };
    const map_arguments a = map_arguments_of(argc, argv);
    map_work w = {.asked = &a, .steps = a.steps ? (size_t)a.steps : STEPS};
    w.look = look_begin(&a.look);
    w.table = table_begin(&a.look.shared.target, sizeof columns / sizeof columns[0], columns);
    if (a.over_field) map_fields(&w);
    else map_pupils(&w);
    look_verdict(w.table, &w.look);
    table_end(w.table);
    if (a.look.picture) map_draw(&w);
    return look_status(&w.look);
}
