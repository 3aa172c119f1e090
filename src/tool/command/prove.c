// SPDX-License-Identifier: MIT
/* prove.c - sagitta prove: its views (--elements, --regions, --limit), what breaks a limit, and maps of the
 * pupil. */
#include "commands.h"
#include "../base/memory.h"
#include "../look/look.h"

#include <math.h>
#include <sagitta/prove.h>
#include <string.h>

static bool is_view(const look *l, const char *name) { return strcmp(l->of->name, name) == 0; }

/* ---------------------------------------------------- the fields and wavelengths between
 *
 * --fields all and --wavelengths all are those between, too: these are other analyses. */
static bool all_wavelengths;

static void take_all_wavelengths(void *into, const option_row *row, const char *value)
{
    (void)into;
    options_word(row, value);
    all_wavelengths = true;
}

static const option_row prove_own[] = {
    {"wavelengths", "all",
     "all: those between, too, from the shortest to the longest one.  And --fields all: the fields\n"
     "between, too.  Then there is a row for each bound, and --limit goes with it.  Default: each\n"
     "field and wavelength of the lens by itself",
     OPTION_TAKE, .words = "all", .take = take_all_wavelengths},
    {0},
};

static const char *analysis_of(look *l)
{
    const bool limits = is_view(l, "prove_limits");
    if (!l->job.all_fields && !all_wavelengths) return l->of->name;
    if (!limits && strcmp(l->of->name, "prove") != 0)
        fail_usage("--%s: not of all fields or wavelengths; a box of the pupil is of one field",
                   is_view(l, "prove_elements") ? "elements" : "regions");
    if (l->shared.picture) fail_usage("--picture: pupils are drawn of single fields at single wavelengths");
    return limits ? "prove_between_limits" : "prove_between";
}

static bool is_between(const look *l)
{
    return is_view(l, "prove_between") || is_view(l, "prove_between_limits");
}

static const char *counted_of(const look *l)
{
    return is_between(l) ? "parts of the fields and wavelengths" : "boxes";
}

static void check_prove(look *l)
{
    if (is_between(l)) {
        sgt_prove_options *o = l->options;
        o->between = l->job.all_fields ? all_wavelengths ? 0 : 1 : 2;
        return;
    }

    if (l->job.no_apertures && is_view(l, "prove_elements"))
        fail_usage("--no-apertures: then no ray is clipped, and there is no clearance; leave out --elements");
}

/* ------------------------------------------------------------------------ limits */

static const char *wavelength_um(double um)
{
    if (isnan(um)) return "";
    return memory_print(" --wavelength %.17g%s", um, strchr(memory_print("%.17g", um), '.') ? "" : ".0");
}

static const char *wavelength_of_row(const look *l, double um)
{
    const size_t b = look_band_of(l, um);
    if (isnan(um) || b == l->bands) return "";
    if (l->band[b].chosen) return memory_print(" --wavelength %zu", (size_t)l->band[b].chosen);
    return wavelength_um(um);
}

/* How many limits are proven, broken, undecided, empty. */
static void count_verdict(size_t count[4], int verdict)
{
    count[verdict == SGT_LIMIT_PROVEN   ? 0
          : verdict == SGT_LIMIT_BROKEN ? 1
          : verdict == SGT_LIMIT_EMPTY  ? 3
                                        : 2]++;
}

static exit_status end_verdicts(const look *l, const size_t count[4])
{
    table_line(l->table, "%zu of %zu proven%s%s%s.", count[0], l->rows,
               count[1] ? memory_print(", %zu broken", count[1]) : "",
               count[2] ? memory_print(", %zu undecided: more --boxes may decide them", count[2]) : "",
               count[3] ? memory_print(", %zu empty: no ray passes", count[3]) : "");
    return count[1] ? EXIT_BROKEN : count[2] || count[3] ? EXIT_UNDECIDED : EXIT_DECIDED;
}

static const char *quoted_lens(const look *l)
{
    const char *quote = strpbrk(l->job.lens, " '()&;") ? "\"" : "";
    return memory_print("%s%s%s", quote, l->job.lens, quote);
}

/* Options that the ray needs as well; rays are those of the paraxial pupil. */
static const char *again_of(const look *l)
{
    const char *aims = l->primary.of->aim == SGT_LENS_AIM_PUPIL ? "" : " --aim paraxial";
    return memory_print("%s%s", l->job.again ? l->job.again : "",
                        l->job.again && strstr(l->job.again, "--aim") ? "" : aims);
}

static void say_broken_between(const look *l, const sgt_prove_between_limit_row *r)
{
    const bool finite = isfinite(l->primary.of->object_distance);
    table_line(
        l->table,
        "Limit %zu is broken by this ray, of %.6g:\n    sagitta diagnose %s --field-at \"%.17g %.17g %s\"%s "
        "--pupil \"%.17g %.17g\"%s",
        r->limit, r->seen, quoted_lens(l), r->fx, r->fy, finite ? "object_height" : "angle",
        wavelength_um(r->um), r->px, r->py, again_of(l));
    if (!isnan(r->low_px))
        table_line(l->table, "    and by the one with the smallest difference, --pupil \"%.17g %.17g\"",
                   r->low_px, r->low_py);
}

static exit_status end_between_limits(const look *l)
{
    size_t count[4] = {0};
    bool told[SGT_PROVE_LIMITS + 1] = {false};
    for (size_t i = 0; i < l->rows; i++) {
        const sgt_prove_between_limit_row *r = look_row(l, i);
        count_verdict(count, r->verdict);
        if (r->verdict != SGT_LIMIT_BROKEN || told[r->limit]) continue;
        told[r->limit] = true;
        say_broken_between(l, r);
    }
    return end_verdicts(l, count);
}

static void say_broken(const look *l, const sgt_prove_limit_row *r)
{
    table_line(l->table,
               "Limit %zu is broken by this ray, of %.6g:\n    sagitta diagnose %s %s%s --pupil "
                         "\"%.17g %.17g\"%s", r->limit, r->seen, quoted_lens(l),
               look_field_words(l, r->field), wavelength_of_row(l, r->wavelength), r->px, r->py, again_of(l));
}

/* The first ray that breaks each limit, and how many hold. */
static exit_status end_limits(const look *l)
{
    size_t count[4] = {0};
    bool told[SGT_PROVE_LIMITS + 1] = {false};
    for (size_t i = 0; i < l->rows; i++) {
        const sgt_prove_limit_row *r = look_row(l, i);
        count_verdict(count, r->verdict);
        if (r->verdict != SGT_LIMIT_BROKEN || isnan(r->px) || told[r->limit]) continue;
        told[r->limit] = true;
        say_broken(l, r);
    }
    return end_verdicts(l, count);
}

static exit_status end_prove(look *l)
{
    const char *primary = lens_primary(l->primary.of);
    if (primary) table_line(l->table, "%s", primary);
    if (is_view(l, "prove_limits")) return end_limits(l);
    if (is_view(l, "prove_between_limits")) return end_between_limits(l);
    return l->total.fates.lost ? EXIT_UNDECIDED : EXIT_DECIDED;
}

/* ------------------------------------------------------------------------ the map
 *
 * A net of PIXELS squares of which each has the colour of the box that its middle lies in.  A square that
 * lies across the edge of a box is left blank, unless the box is smaller than SHOWN squares: so the boxes
 * that
 * were cut are seen. */
enum { PIXELS = 480, SHOWN = 5 };

/* What a box shows: 0 passes, 1 not decided, 2 and on: a fate at an element. */
typedef struct shown { size_t count; const char **name; } shown_kinds;

static const char *region_name(const sgt_prove_region_row *r)
{
    static const char *const ends[] = {[SGT_CLIPPED] = "clipped", [SGT_TIR] = "totally reflected",
                                       [SGT_EVANESCENT] = "evanescent", [SGT_MISSED] = "missed"};
    if (r->fate == SGT_PASSED) return "passes";
    if (r->fate == SGT_LOST) return "not decided";
    return memory_print("%s at %zu", ends[r->fate], r->element);
}

static double kind_of(shown_kinds *k, const char *name)
{
    for (size_t i = 0; i < k->count; i++)
        if (strcmp(k->name[i], name) == 0) return (double)i;
    k->name = memory_grow(k->name, k->count + 1, sizeof *k->name);
    k->name[k->count] = name;
    return (double)k->count++;
}

/* The distance of a point from the edge of the box, in squares; below 0: outside. */
static double inside_by(const sgt_prove_region_row *r, double radius, double angle)
{
    const double scale = PIXELS / 2.0;
    double by = radius - r->r0;
    if (r->r0 == 0) by = 2;
    by = fmin(by, r->r1 - radius);
    if (r->angle1 - r->angle0 < 360)
        by = fmin(by, radius * fmin(angle - r->angle0, r->angle1 - angle) * 3.14159265358979 / 180);
    return by * scale;
}

static void fill_box(double value[], const sgt_prove_region_row *r, double kind)
{
    const double size = fmin(r->r1 - r->r0, r->r1 * (r->angle1 - r->angle0) * 3.14159265358979 / 180);
    const bool edged = size * PIXELS / 2 > SHOWN;
    double low[2] = {1, 1}, high[2] = {-1, -1};
    for (int i = 0; i <= 8; i++)
        for (int k = 0; k < 2; k++) {
            const double a = (r->angle0 + (r->angle1 - r->angle0) * i / 8) * 3.14159265358979 / 180;
            const double at[2] = {(k ? r->r1 : r->r0) * cos(a), (k ? r->r1 : r->r0) * sin(a)};
            for (int c = 0; c < 2; c++) low[c] = fmin(low[c], at[c]), high[c] = fmax(high[c], at[c]);
        }
    /* (between these points an arc bulges by less than a twelfth of its box's angle) */
    const double more = 0.08 * r->r1 * fmin(1, (r->angle1 - r->angle0) / 45) + 2.0 / PIXELS;
    const int first = (int)fmax(0, floor((low[0] - more + 1) / 2 * PIXELS));
    const int last = (int)fmin(PIXELS - 1, ceil((high[0] + more + 1) / 2 * PIXELS));
    const int bottom = (int)fmax(0, floor((low[1] - more + 1) / 2 * PIXELS));
    const int top = (int)fmin(PIXELS - 1, ceil((high[1] + more + 1) / 2 * PIXELS));
    for (int j = bottom; j <= top; j++)
        for (int i = first; i <= last; i++) {
            const double x = (2 * i + 1.0) / PIXELS - 1, y = (2 * j + 1.0) / PIXELS - 1;
            double angle = atan2(y, x) * 180 / 3.14159265358979;
            if (angle < 0) angle += 360;
            const double by = inside_by(r, hypot(x, y), angle);
            if (by >= 0) value[j * PIXELS + i] = edged && by < 0.6 ? (double)NAN : kind;
        }
}

/* --steps: what passes at each field, at least and at most. */
static void draw_vignetting(const look *l)
{
    chart_series *series = memory_take(2 * l->bands, sizeof *series);
    const sgt_prove_row *last = l->rows ? look_row(l, l->rows - 1) : NULL;
    const bool upright = last && last->fx == 0;
    for (size_t b = 0; b < l->bands; b++) {
        double *x = memory_take(l->rows + 1, sizeof *x), *least = memory_take(l->rows + 1, sizeof *least),
               *most = memory_take(l->rows + 1, sizeof *most);
        size_t count = 0;
        for (size_t i = 0; i < l->rows; i++) {
            const sgt_prove_row *r = look_row(l, i);
            if (look_band_of(l, r->wavelength) != b) continue;
            x[count] = upright ? r->fy : hypot(r->fx, r->fy), least[count] = r->passes;
            most[count++] = r->passes + r->undecided;
        }
        const char *name = l->bands > 1 ? look_wavelength_name(l, b) : NULL;
        const chart_series one = {.name = name ? name : "at least", .colour = look_colour(l, b), .line = true,
                                  .mark = CHART_RING, .count = count, .x = x, .y = least};
        series[2 * b] = series[2 * b + 1] = one;
        series[2 * b + 1].y = most, series[2 * b + 1].dash = CHART_DASHED,
                       series[2 * b + 1].mark = CHART_NO_MARK;
        series[2 * b + 1].name = "at most";
    }
    const chart_panel panel = {.x_label = look_field_axis(l),
                               .y_label = "passes (% of the pupil)",
                               .y_high = 100,
                               .series_count = 2 * l->bands,
                               .series = series};
    const char *line[] = {look_lens_line(l), "proven of all rays of the pupil"};
    chart_write(l->picture, &(chart){.title = look_title(l, "what passes, against the field"),
                                     .line = line,
                                     .lines = 2,
                                     .panels = 1,
                                     .panel = &panel});
}

static void draw_pupils(const look *asked)
{
    if (look_given(asked, "steps")) {
        draw_vignetting(asked);
        return;
    }
    const look boxes = is_view(asked, "prove_regions") ? *asked : look_again(asked, "prove_regions"),
            *l = &boxes;
    const size_t panels = l->fields.count * l->bands;
    shown_kinds kinds = {.count = 0};
    chart_map *map = memory_take(panels, sizeof *map);
    chart_panel *panel = memory_take(panels, sizeof *panel);
    double *share = memory_take(3 * panels, sizeof *share);
    kind_of(&kinds, "passes"), kind_of(&kinds, "not decided");
    for (size_t p = 0; p < panels; p++) {
        double *value = memory_take((size_t)PIXELS * PIXELS, sizeof *value);
        for (size_t i = 0; i < (size_t)PIXELS * PIXELS; i++) value[i] = (double)NAN;
        map[p] = (chart_map){.columns = PIXELS, .rows = PIXELS, .x_low = -1, .x_high = 1, .y_low = -1,
                             .y_high = 1, .value = value, .label = "fate"};
    }
    for (size_t i = 0; i < l->rows; i++) {
        const sgt_prove_region_row *r = look_row(l, i);
        const size_t p = look_field_of(l, r->field) * l->bands + look_band_of(l, r->wavelength);
        if (p >= panels) continue;
        fill_box((double *)(uintptr_t)map[p].value, r, kind_of(&kinds, region_name(r)));
        share[3 * p + (r->fate == SGT_PASSED ? 0 : r->fate == SGT_LOST ? 2 : 1)] += r->share;
    }
    for (size_t p = 0; p < panels; p++) {
        const char *name = look_field_name(l, p / l->bands);
        const char **note_of = memory_take(1, sizeof *note_of);
        *note_of = memory_print("%.4g %% passes, %.4g %% stops, %.2g %% not decided", share[3 * p],
                                share[3 * p + 1], share[3 * p + 2]);
        map[p].kinds = kinds.name, map[p].kind_count = kinds.count;
        panel[p] = (chart_panel){.title = l->bands > 1 ? memory_print("%s, %s", name,
                                                                      look_wavelength_name(l, p % l->bands))
                                                       : name,
                                 .x_label = "px", .y_label = "py", .square = true, .map = &map[p],
                                 .note = note_of, .notes = 1};
    }
    const char *line[] = {look_lens_line(l), "proven of all rays of each box of the pupil"};
    chart_write(l->picture, &(chart){.title = look_title(l, "every ray of the pupil"), .line = line,
            .lines = 2,
                                     .columns = l->bands > 1 ? l->bands : 0, .panels = panels,
                                     .panel = panel});
}

static exit_status prove_run(const command *c, int argc, char *argv[])
{
    static const look_view views[] = {
        {"elements", "prove_elements", NULL, "a row for each element: where rays end, incidence, clearance",
         false},
        {"regions", "prove_regions", NULL, "a row for each box of the pupil", false},
        {"limit", "prove_limits", "limit",
         "is it true of every ray? \"spot < 0.02\"; several with semicolons between, or --limit again\n"
         "pass > X (per cent of the pupil's area), ex, ey, spot, rms < X (length; afocal: mrad), opd, "
         "wavefront < X (waves, peak to valley and rms), incidence[ELEMENT] < X (degrees), "
         "clearance[ELEMENT] > X (from the edge of the clear aperture)",
         true},
        {NULL, NULL, NULL, NULL, false}};
    return look_run(c,
                    &(look_way){.view = views,
                                .own = prove_own,
                                .analysis = analysis_of,
                                .counted = counted_of,
                                .check = check_prove,
                                .draw = draw_pupils,
                                .end = end_prove},
                    argc, argv);
}

const command command_prove = {
    .name = "prove", .brief = "every ray of the pupil: what certainly passes, and bounds",
    .often = "fields field wavelength limit elements regions undecided boxes picture threads format output",
    .examples = "  sagitta prove examples/lenses/cooke_triplet.yaml\n"
                "  sagitta prove examples/lenses/cooke_triplet.yaml --limit \"spot < 0.05; pass > 99\"\n"
                "  sagitta prove examples/lenses/cooke_triplet.yaml --picture pupils.svg\n",
    .docs = "docs/prove.md",
    .exits = "  0  at most --undecided of each pupil is undecided; or every limit is proven\n"
             "  1  more is undecided; or a limit is undecided, or no ray passes, and none is broken\n"
             "  2  wrong arguments\n"
             "  3  bad input, or output that cannot be written\n"
             "  4  a limit is broken\n",
    .run = prove_run,
};
