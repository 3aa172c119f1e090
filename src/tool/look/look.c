/* look.c - the lens at each wavelength, and its rays in threads.
 *
 * Pupil and fields are defined at one wavelength, the primary one of the lens, so all wavelengths share a
 * launcher.  What a ray does depends on that ray alone: parts may be traced in any order. */
#include "look.h"

#include "../base/input.h"
#include "../base/memory.h"
#include "../base/tiles.h"
#include "../draw/chart.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* ---------------------------------------------------------------- options */

static const char look_help[] =
    "  --picture FILE     draws it: svg, png or pdf, by the ending of the name\n"
    "  --proof P          estimate, root or first: what must be proven of each hit (sagitta trace --help);\n"
    "                     a ray for which it is not is lost\n";

void look_take_option(look_options *o, int code, const char *help)
{
    char all[HELP_SIZE];
    o->shared.scales = true;
    if (job_take(&o->job, code)) return;
    if (code == LOOK_PICTURE) {
        chart_check("picture", optarg);
        o->picture = optarg;
        return;
    }
    int n = snprintf(all, sizeof all, "%s%s%s", help, look_help, o->no_fields ? "" : job_fields_help);
    if (o->pattern)
        n += snprintf(all + n, sizeof all - (size_t)n, "%s  none of these      %s\n", job_patterns_help,
                      o->pattern);
    snprintf(all + n, sizeof all - (size_t)n, "%s%s                     Default: %s\n%s%s%s", job_aim_help,
             job_wavelength_help, o->primary_alone ? "its primary one" : "all", job_lens_help,
             options_threads_help, options_rows_help);
    options_take(&o->shared, code, all);
}

void look_take_lens(look_options *o, int argc, char *argv[], const char *name)
{
    if (optind == argc) fail_usage("the lens file is missing: sagitta %s LENS", name);
    if (optind + 1 < argc)
        fail_usage("unexpected argument \"%s\"; %s takes one lens file", argv[optind + 1], name);
    if (o->job.rays) fail_usage("--rays: %s launches the rays of fields; sagitta trace takes a file", name);
    if (o->job.skip_bad) fail_usage("--skip-bad goes with --rays; %s launches the rays of fields", name);
    o->job.lens = argv[optind];
    o->job.several = true;
    if (!o->primary_alone && !o->job.wavelengths) o->job.all_wavelengths = true;
    if (!o->picture) return;
    if (o->shared.target.path) output_check("output", o->shared.target.path);
    output_reserve("picture", o->picture);
}

/* --------------------------------------------------------------- the lens */

static look_band band_of(const look_options *o, const lens *l)
{
    const sgt_lens *of = l->of;
    look_band b = {.lens = *l, .element = job_elements(&o->job, l), .weight = 1};
    sgt_error e;
    if (l->chosen && of->wavelength_weight) b.weight = of->wavelength_weight[l->chosen - 1];
    if (!sgt_lens_first_order(of, l->wavelength, &b.data, NULL, &e)) lens_refuse(&e);
    return b;
}

/* The unit of length in micrometres. */
static double micrometres_of(const char *units)
{
    static const struct { const char *name; double um; } known[] = {
        {"mm", 1e3}, {"cm", 1e4}, {"m", 1e6}, {"um", 1}, {"\302\265m", 1}, {"in", 25400}, {"inch", 25400},
        {"millimetres", 1e3}, {"millimeters", 1e3}, {"metres", 1e6}, {"meters", 1e6},
    };
    for (size_t i = 0; i < sizeof known / sizeof *known; i++)
        if (strcmp(units, known[i].name) == 0) return known[i].um;
    return (double)NAN;
}

const sgt_lens_field *look_farthest(const look *l)
{
    const sgt_lens_field *far = &l->fields.at[0];
    for (size_t i = 1; i < l->fields.count; i++)
        if (hypot(l->fields.at[i].x, l->fields.at[i].y) > hypot(far->x, far->y)) far = &l->fields.at[i];
    return far;
}

/* The field of the latest look_beam. */
static sgt_field_kind latest_kind;
static sgt_lens_field latest_field;

sgt_field_beam look_beam(const look *l, sgt_field_kind kind, sgt_lens_field at)
{
    sgt_field_beam beam;
    sgt_error e;
    latest_kind = kind, latest_field = at;
    if (!sgt_launch_field(l->from, kind, &at, &beam, &e)) lens_refuse(&e);
    return beam;
}

look look_begin(const look_options *o)
{
    look l = {.asked = o, .threads = options_threads(&o->shared)};
    const lens_list lenses = job_lenses(&o->job);
    sgt_lens *of = lenses.lens[0].of;
    const lens primary =
        of->wavelength ? lens_at(of, (lens_wavelength){.um = (double)NAN}) : lenses.lens[0];
    l.bands = lenses.count;
    l.band = memory_take(l.bands, sizeof *l.band);
    for (size_t i = 0; i < l.bands; i++) l.band[i] = band_of(o, &lenses.lens[i]);
    l.primary = band_of(o, &primary);
    options_note_unread(&o->shared, primary.count, l.primary.element);
    l.from = launch_by(&primary, job_aim(&o->job, of)).from;
    l.fields = job_fields(&o->job, &primary);
    l.beam = memory_take(l.fields.count, sizeof *l.beam);
    for (size_t i = 0; i < l.fields.count; i++) l.beam[i] = look_beam(&l, l.fields.kind, l.fields.at[i]);
    l.um = micrometres_of(primary.units);
    return l;
}

/* --------------------------------------------------------------- the rays */

typedef struct look_work {
    const look *look;
    const sgt_field_beam *beam;
    const sgt_element *element;
    double before;
    const sgt_pupil_point *at;
    sgt_ray_end *end;
} look_work;

static void trace_part(void *data, const tile *t)
{
    const look_work *w = data;
    if (!sgt_trace_pupil(w->look->from, w->beam, w->element, w->before, t->count, w->at + t->first,
                         &w->look->asked->shared.solver, w->end + t->first, NULL))
        fail_input("out of memory");
}

static void nothing_more(void *data, const tile *t)
{
    (void)data, (void)t;
}

const char *look_field_option(sgt_field_kind kind, const sgt_lens_field *at)
{
    if (kind == SGT_FIELD_ANGLE && at->x == 0) return look_text(" --field %.17g", at->y);
    return look_text(" --field-at \"%.17g %.17g %s\"", at->x, at->y, job_field_kind(kind));
}

/* One of the fields that are asked for, or that of the latest look_beam. */
static const char *field_of_beam(const look *l, const sgt_field_beam *beam)
{
    for (size_t f = 0; f < l->fields.count; f++) {
        if (beam != &l->beam[f]) continue;
        if (l->asked->job.fields) return look_field_option(l->fields.kind, &l->fields.at[f]);
        return look_text(" --fields %zu", l->fields.number[f] + 1);
    }
    return look_field_option(latest_kind, &latest_field);
}

static const char *wavelength_option(const look_band *band)
{
    if (band->lens.chosen) return look_text(" --wavelength %zu", band->lens.chosen);
    if (isnan(band->lens.wavelength)) return "";
    const char *um = look_text("%.17g", band->lens.wavelength);
    return look_text(" --wavelength %s%s", um, strchr(um, '.') ? "" : ".0");
}

void look_lost(look *l, const look_band *band, const char *options, const sgt_ray_end *end)
{
    static const char *const proof[] = {"estimate", "root", "first"};
    const sgt_options *s = &l->asked->shared.solver;
    const char *again = l->asked->job.again ? l->asked->job.again : "";
    if (end->aimed == SGT_NO_SUCH_RAY || end->fate != SGT_LOST || l->lost) return;
    l->lost = look_text("%s%s%s --pupil \"%.17g %.17g\"%s%s%s%s%s", options, l->options ? l->options : "",
                        wavelength_option(band), end->px,
                        end->py, again, s->proof ? look_text(" --proof %s", proof[s->proof]) : "",
                        s->pick == SGT_NEAR_SEED ? " --pick near-seed" : s->pick ? " --pick first" : "",
                        s->max_evals ? look_text(" --max-evals %d", s->max_evals) : "",
                        s->dt_min > 0 ? look_text(" --dt-min %.17g", s->dt_min)
                        : s->t_tol > 0 ? look_text(" --t-tol %.17g", s->t_tol) : "");
}

void look_trace(look *l, const sgt_field_beam *beam, const look_band *band, const sgt_element *element,
                const launch_pattern *points, bool counted, sgt_ray_end end[])
{
    look_work w = {.look = l, .beam = beam, .element = element, .before = band->lens.index_before,
                   .at = points->at, .end = end};
    const tiling in = {.rays = points->count, .threads = l->threads, .share = SHARE_MOST,
                       .most = points->count < 8 * TILE_RAYS ? TILE_RAYS / 8 : TILE_RAYS};
    tiles_run(&in, &w, trace_part, nothing_more);
    for (size_t i = 0; counted && i < points->count; i++) {
        look_count(&l->fates, &end[i]);
        if (l->fates.lost && !l->lost) look_lost(l, band, field_of_beam(l, beam), &end[i]);
    }
}

sgt_ray_end look_chief(const look *l, const sgt_field_beam *beam, const look_band *band,
                       const sgt_element *element)
{
    sgt_ray_end end;
    if (!sgt_trace_chief(l->from, beam, element, band->lens.index_before, &end, NULL))
        fail_input("out of memory");
    return end;
}

launch_pattern look_coarser(const look *l, const launch_pattern *points)
{
    const bool area = points->pattern == SGT_PATTERN_RANDOM || points->pattern == SGT_PATTERN_SOBOL;
    const size_t n = points->n / (area ? 4 : 2);
    const long seed = l->asked->job.seed;
    if (n == 0) return (launch_pattern){.count = 0};
    return launch_points(points->pattern, n, seed ? (uint64_t)seed : 1);
}

void look_count(look_fates *f, const sgt_ray_end *end)
{
    f->rays++, f->folded += end->folded;
    if (end->aimed == SGT_AIMED_UNDECIDED) {
        f->within = f->unfound ? fmin(f->within, end->within) : end->within;
        f->unfound++;
    }
    if (end->aimed == SGT_NO_SUCH_RAY) f->none++;
    else if (end->fate == SGT_PASSED) f->passed++, f->proven += end->proven;
    else if (end->fate == SGT_MISSED) f->missed++;
    else if (end->fate == SGT_CLIPPED) f->clipped++;
    else if (end->fate == SGT_TIR) f->tir++;
    else f->lost++;
}

/* ------------------------------------------------------------------ words */

int look_digits(double value, double error)
{
    enum { MOST = 16 };
    if (!(error >= 0) || isnan(value) || isinf(error)) return 0;
    const double digits = error > 0 ? floor(log10(fabs(value) / error)) : MOST;
    return digits > MOST ? MOST : digits > 0 ? (int)digits : 0;
}

const char *look_fate(const sgt_ray_end *end)
{
    return end->aimed == SGT_NO_SUCH_RAY ? "none" : sgt_fate_text(end->fate);
}

void look_fate_cell(table *t, const sgt_ray_end *end)
{
    table_code(t, end->aimed == SGT_NO_SUCH_RAY ? LOOK_NONE : (int)end->fate, look_fate(end));
}

void look_cells(table *t, const look *l, size_t field, const look_band *band)
{
    table_count(t, (long long)l->fields.number[field] + 1);
    look_number(t, band->lens.wavelength);
}

/* The columns of text are fewer, unless they are asked for. */
static bool is_text(const look *l)
{
    const table_target *to = &l->asked->shared.target;
    return to->format == TABLE_TEXT && !to->columns;
}

size_t look_fate_columns(const look *l, column *to)
{
    static const char *const names[] = {"missed", "clipped", "tir", "lost", "none", "proven"};
    const size_t count = is_text(l) ? 0 : l->asked->shared.solver.proof ? LOOK_FATES : LOOK_FATES - 1;
    for (size_t i = 0; i < count; i++) to[i] = (column){names[i], COLUMN_COUNT};
    return count;
}

void look_fate_cells(table *t, const look *l, const look_fates *f)
{
    const size_t each[] = {f->missed, f->clipped, f->tir, f->lost, f->none, f->proven};
    column unused[LOOK_FATES];
    for (size_t i = 0, n = look_fate_columns(l, unused); i < n; i++) table_count(t, (long long)each[i]);
}

void look_number(table *t, double value)
{
    if (isnan(value)) table_empty(t);
    else table_number(t, value);
}

const char *look_text(const char *format, ...)
{
    char text[1000];
    va_list more;
    va_start(more, format);
    vsnprintf(text, sizeof text, format, more);
    va_end(more);
    return memory_text(text, strlen(text));
}

const char *look_fates_line(const look *l, const look_fates *f)
{
    const struct { size_t n; const char *word; } each[] = {
        {f->passed, "passed"}, {f->missed, "missed a surface"}, {f->clipped, "clipped"},
        {f->tir, "totally reflected"}, {f->lost, "lost"}, {f->none, "not there, as is proven"},
    };
    char text[400];
    int n = snprintf(text, sizeof text, "%zu ray%s:", f->rays, f->rays == 1 ? "" : "s");
    for (size_t i = 0; i < sizeof each / sizeof *each; i++)
        if (each[i].n)
            n += snprintf(text + n, sizeof text - (size_t)n, "%s %zu %s", text[n - 1] == ':' ? "" : ",",
                          each[i].n, each[i].word);
    if (l->asked->shared.solver.proof)
        n += snprintf(text + n, sizeof text - (size_t)n, "; %zu proven", f->proven);
    if (f->folded) snprintf(text + n, sizeof text - (size_t)n, "; %zu on a fold of the pupil", f->folded);
    return memory_text(text, strlen(text));
}

void look_verdict(table *t, const look *l)
{
    const char *primary = lens_primary(l->primary.lens.of);
    if (primary) table_line(t, "%s", primary);
    table_line(t, "%s.", look_fates_line(l, &l->fates));
    const look_fates *f = &l->fates;
    if (!f->lost) return;
    if (f->unfound && f->within > 0)
        table_line(t, "%zu lost, as aiming did not find them: none lies within %g pupil radii; beyond that "
                      "there may be some.", f->unfound, f->within);
    else if (f->unfound)
        table_line(t, "%zu lost, as aiming did not find them; there may be some.", f->unfound);
    const char *quote = strpbrk(l->asked->job.lens, " '()&;") ? "\"" : "";
    table_line(t, "What becomes of a lost ray could not be decided.  This shows the first:\n"
                  "    sagitta diagnose %s%s%s%s", quote, l->asked->job.lens, quote, l->lost ? l->lost : "");
}

exit_status look_status(const look *l) { return l->fates.lost ? EXIT_UNDECIDED : EXIT_DECIDED; }

double look_small(const look *l, double length) { return isnan(l->um) ? length : length * l->um; }

const char *look_small_unit(const look *l)
{
    const char *units = l->primary.lens.units;
    return !isnan(l->um) ? "\302\265m" : *units ? units : "units of the lens";
}

const char *look_title(const look *l, const char *what)
{
    const lens *of = &l->primary.lens;
    const char *file = strrchr(of->of->file, '/');
    return look_text("%s: %s", *of->name ? of->name : file ? file + 1 : of->of->file, what);
}

size_t look_colour(const look *l, size_t band)
{
    size_t shorter = 0;
    for (size_t b = 0; b < l->bands; b++) {
        const double one = l->band[b].lens.wavelength, own = l->band[band].lens.wavelength;
        shorter += one < own || (one == own && b < band);
    }
    return shorter;
}

const char *look_wavelength_name(const look_band *band)
{
    return isnan(band->lens.wavelength) ? NULL : look_text("%.6g \302\265m", band->lens.wavelength);
}

const char *look_lens_line(const look *l)
{
    char text[400] = "";
    size_t n = 0;
    for (size_t i = 0; i < l->bands && n < sizeof text - 40 && !isnan(l->band[i].lens.wavelength); i++)
        n += (size_t)snprintf(text + n, sizeof text - n, "%s%.6g", i ? ", " : "", l->band[i].lens.wavelength);
    const char *units = l->primary.lens.units;
    if (strcmp(units, "in") == 0) units = "inches";
    return look_text("%s%slengths in %s%s", text, n ? " \302\265m; " : "",
                     *units ? units : "the unit of the lens",
                     l->asked->shared.solver.proof == SGT_PROVE_FIRST  ? "; every hit proven to be the first"
                     : l->asked->shared.solver.proof == SGT_PROVE_ROOT ? "; every root proven"
                                                                       : "");
}

const char *look_signed(double x) { return look_text("%s%g", x < 0 ? "\342\210\222" : "", fabs(x)); }

const char *look_field_name(const look *l, size_t field)
{
    const sgt_lens_field *at = &l->fields.at[field];
    const char *units = l->primary.lens.units;
    const char *unit = l->fields.kind == SGT_FIELD_ANGLE ? "\302\260" : *units ? look_text(" %s", units) : "";
    const size_t number = l->fields.number[field] + 1;
    return at->x == 0 ? look_text("field %zu: %s%s", number, look_signed(at->y), unit)
                      : look_text("field %zu: %s, %s%s", number, look_signed(at->x), look_signed(at->y),
                                  unit);
}

const char *look_field_axis(const look *l)
{
    const char *units = l->primary.lens.units;
    const char *what = l->fields.kind == SGT_FIELD_ANGLE           ? "field angle"
                       : l->fields.kind == SGT_FIELD_OBJECT_HEIGHT ? "object height"
                                                                   : "image height";
    return look_text("%s (%s)", what,
                     l->fields.kind == SGT_FIELD_ANGLE ? "degrees"
                     : *units                          ? units
                                                       : "length");
}
