// SPDX-License-Identifier: MIT
/* tolerance.c - sagitta tolerance: what each tolerance of a lens does, and what all do together. */
#include "commands.h"

#include "../base/input.h"
#include "../base/memory.h"
#include "../look/look.h"
#include "../read/lens.h"

#include <limits.h>
#include <math.h>
#include <sagitta/prove.h>
#include <sagitta/tolerance.h>
#include <stdlib.h>
#include <string.h>

typedef struct tolerance_options {
    int figure, reference, trials, first, seed, boxes;
    bool proven;
    double confidence; /* per cent */
    double *limit;     /* [limits] */
    size_t limits;
    const char *worst;
} tolerance_options;

static void take_limit(void *into, const option_row *row, const char *value)
{
    tolerance_options *o = into;
    o->limit = memory_grow(o->limit, o->limits + 1, sizeof *o->limit);
    o->limit[o->limits++] = options_number(row->name, value);
}

static void take_confidence(void *into, const option_row *row, const char *value)
{
    const double x = options_number(row->name, value);
    if (!(x > 0 && x < 100)) fail_usage("--confidence must be between 0 and 100 per cent, not %g", x);
    ((tolerance_options *)into)->confidence = x;
}

static void take_picture_of(void *into, const option_row *row, const char *value)
{
    chart_check(row->name, value);
    ((shared_options *)into)->picture = value;
}

static const option_row tolerance_rows[] = {
    {"figure", "WORD",
     "what is to be small: spot (the default), opd or boresight\n"
     "spot: root mean square of the spot radii of all fields; opd: of the path differences, in waves; "
     "boresight: of how far the chief rays of the fields end from where they are designed to",
     OPTION_WORD, .to = offsetof(tolerance_options, figure), .words = "spot opd boresight"},
    {"reference", "WORD", "of a spot: chief (the default), the chief ray, or centroid", OPTION_WORD,
     .to = offsetof(tolerance_options, reference), .words = "chief centroid"},
    {"trials", "N",
     "Monte Carlo: N lenses built at random\n"
     "Text has quantiles of the figure; csv, json and npy have a row for each trial",
     OPTION_WHOLE, .to = offsetof(tolerance_options, trials), .least = 1, .most = INT_MAX},
    {"first", "I",
     "the number of the first trial: 0 if it is not given\n"
     "Trial I is the same in every run, so that trials can be split over machines",
     OPTION_WHOLE, .to = offsetof(tolerance_options, first), .least = 0, .most = INT_MAX},
    {"trial-seed", "N", "other trials; 1 if it is not given", OPTION_WHOLE,
     .to = offsetof(tolerance_options, seed), .least = 0, .most = INT_MAX},
    {"worst-case", NULL,
     "a figure that no lens in tolerance exceeds, proven; and the worst that was found\n"
     "With --limit: proven, broken by that lens, or undecided",
     OPTION_FLAG, .to = offsetof(tolerance_options, proven)},
    {"boxes", "N", "of --worst-case: at most N boxes of lenses; 32 if it is not given", OPTION_WHOLE,
     .to = offsetof(tolerance_options, boxes), .least = 1, .most = INT_MAX},
    {"limit", "X",
     "the yield: the share of trials whose figure is at most X; several\n"
     "Of --worst-case one: is it at most X in every lens?",
     OPTION_TAKE, .take = take_limit},
    {"confidence", "PERCENT", "of the intervals of quantiles and yields; 95 if it is not given", OPTION_TAKE,
     .take = take_confidence},
    {"worst", "FILE", "write the lens of the worst trial, or that --worst-case found, as it was built",
     OPTION_TEXT, .to = offsetof(tolerance_options, worst)},
    {0},
};
static const option_row picture_rows[] = {
    {"picture", "FILE", "draw the yield against the figure: svg, png or pdf, by the ending of the name",
     OPTION_TAKE, .take = take_picture_of},
    {0},
};
static const option_group tolerance_own = {OPTIONS_OWN, "Options", .row = tolerance_rows},
                          picture_group = {OPTIONS_SHARED, NULL, .row = picture_rows};

/* What is asked, and what came of it. */
typedef struct tolerating {
    tolerance_options own;
    look look;
    const sgt_lens *lens;
    const sgt_tolerance *entry; /* [count] */
    size_t count;
    sgt_tolerancing *of;
    const char *unit; /* of the figure */
    table *rows;      /* of the trials; NULL: not wanted */
    double *figure;   /* [done]: of the trials */
    size_t done;
    sgt_trial worst;
    double *worst_value;
    /* of --configuration all */
    size_t configuration; /* its number; 0: there is one lens */
    const char *name;
    table *together;      /* of all sensitivities; NULL: it is not begun */
    size_t columns;       /* of it, and the unit of its figure */
    const char *first_unit;
} tolerating;

static const char *entry_name(const tolerating *w, size_t i)
{
    char text[SGT_TOLERANCE_SIZE];
    sgt_tolerance_text(&w->entry[i], text);
    return memory_print("%s", text);
}

static const char *figure_name(const tolerating *w)
{
    static const char *const names[] = {"root mean square spot radius", "root mean square path difference",
                                        "root mean square way of the chief rays"};
    return names[w->own.figure];
}

/* -------------------------------------------------------------------- sensitivity */

static void put_head(column head[], const char *unit[], size_t *count, const char *name, column_kind kind,
                     const char *of)
{
    unit[*count] = of, head[(*count)++] = (column){name, kind};
}

static void put_maybe(table *t, double x)
{
    if (isnan(x))
        table_empty(t);
    else
        table_number(t, x);
}

static void print_sensitivity(tolerating *w)
{
    enum { COLUMNS = 14 };
    const sgt_lens *l = w->lens;
    sgt_error e;
    sgt_sensitivity_sum sum;
    size_t count;
    sgt_sensitivity *row = memory_take(w->count, sizeof *row);
    size_t compensator = 0;
    while (compensator < w->count && !w->entry[compensator].compensator) compensator++;
    const bool compensated = compensator < w->count, text = w->look.shared.target.format == TABLE_TEXT;
    const char *of = compensated ? sgt_tolerance_unit(l, &w->entry[compensator]) : "";
    if (!sgt_tolerancing_sensitivity(w->of, &count, row, &sum, &e)) lens_refuse(&e);
    column head[COLUMNS];
    const char *unit[COLUMNS];
    size_t columns = 0;
    put_head(head, unit, &columns, "tolerance", COLUMN_WORD, "");
    put_head(head, unit, &columns, "lower", COLUMN_EXACT, "");
    put_head(head, unit, &columns, "upper", COLUMN_EXACT, "");
    put_head(head, unit, &columns, "unit", COLUMN_WORD, "");
    put_head(head, unit, &columns, "change_lower", COLUMN_NUMBER, w->unit);
    put_head(head, unit, &columns, "change_upper", COLUMN_NUMBER, w->unit);
    put_head(head, unit, &columns, "derivative", COLUMN_NUMBER, "");
    if (!text) put_head(head, unit, &columns, "linear_lower", COLUMN_NUMBER, w->unit);
    put_head(head, unit, &columns, "linear_upper", COLUMN_NUMBER, w->unit);
    if (!text) put_head(head, unit, &columns, "figure_lower", COLUMN_NUMBER, w->unit);
    if (!text) put_head(head, unit, &columns, "figure_upper", COLUMN_NUMBER, w->unit);
    if (compensated) put_head(head, unit, &columns, "compensator_lower", COLUMN_NUMBER, of);
    if (compensated) put_head(head, unit, &columns, "compensator_upper", COLUMN_NUMBER, of);
    if (compensated && !text) put_head(head, unit, &columns, "compensator_derivative", COLUMN_NUMBER, "");
    table_target target = w->look.shared.target;
    target.unit = unit, target.word_size = SGT_TOLERANCE_SIZE;
    if (w->together && (w->columns != columns || strcmp(w->first_unit, w->unit) != 0))
        fail_usage("--configuration all: configuration %zu has other columns or units than the first; ask "
                   "for it alone", w->configuration);
    if (!w->together) w->together = table_begin(&target, columns, head), w->columns = columns;
    w->first_unit = w->unit;
    table *t = w->together;
    table_lead(t, w->configuration);
    if (w->configuration)
        table_line(t, "Configuration %zu%s%s.", w->configuration, *w->name ? ", " : "", w->name);
    for (size_t i = 0; i < count; i++) {
        const sgt_sensitivity *r = &row[i];
        const sgt_tolerance *a = &w->entry[r->entry];
        table_word(t, entry_name(w, r->entry));
        table_number(t, a->lower), table_number(t, a->upper);
        table_word(t, sgt_tolerance_unit(l, a));
        put_maybe(t, r->change_lower), put_maybe(t, r->change_upper);
        put_maybe(t, r->derivative);
        if (!text) put_maybe(t, r->linear_lower);
        put_maybe(t, r->linear_upper);
        if (!text) put_maybe(t, r->figure_lower), put_maybe(t, r->figure_upper);
        if (compensated) put_maybe(t, r->compensator_lower), put_maybe(t, r->compensator_upper);
        if (compensated && !text) put_maybe(t, r->compensator_derivative);
    }
    const char *space = *w->unit ? " " : "";
    table_line(t, "The worst first.  figure: %s.  change: from that as designed.", figure_name(w));
    table_line(t, "derivative: of the figure, by the unit of the tolerance%s.  linear_upper: times upper.",
               compensated ? ", compensators following" : "");
    table_line(t, "as designed: %.6g%s%s", sum.nominal, space, w->unit);
    if (compensated)
        table_line(t, "with its compensators set: %.6g%s%s.  compensator: %s", sum.compensated, space,
                   w->unit, entry_name(w, compensator));
    table_line(t, "estimate, by the root of the sum of squares: %.6g%s%s%s", sum.estimate, space, w->unit,
               w->configuration ? "\n" : "");
}

/* --------------------------------------------------------------------------- trials */

/* A name for a column: "s2_radius", "s2_3_tilt_x", or the name that the file gives. */
static const char *column_name(const tolerating *w, size_t i)
{
    char *text = memory_print("%s", entry_name(w, i)), *to = text;
    if (!*w->entry[i].name) {
        const char *key = strchr(strchr(text, ' ') + 1, ' ');
        if (w->entry[i].first != w->entry[i].last) key = strchr(strchr(key + 1, ' ') + 1, ' ');
        text = w->entry[i].first == w->entry[i].last
                   ? memory_print("s%zu_%s", w->entry[i].first, key + 1)
                   : memory_print("s%zu_%zu_%s", w->entry[i].first, w->entry[i].last, key + 1);
    }
    for (to = text; *to; to++)
        if (strchr(" ,\"'", *to)) *to = '_';
    return text;
}

static void begin_rows(tolerating *w)
{
    column *head = memory_take(w->count + 2, sizeof *head);
    const char **unit = memory_take(w->count + 2, sizeof *unit);
    head[0] = (column){"trial", COLUMN_COUNT}, unit[0] = "";
    head[1] = (column){"figure", COLUMN_NUMBER}, unit[1] = w->unit;
    for (size_t i = 0; i < w->count; i++) {
        const char *name = column_name(w, i);
        for (size_t k = 0; k < i + 2; k++)
            if (strcmp(head[k].name, name) == 0) name = memory_print("%s_%zu", name, i + 1), k = 0;
        head[i + 2] = (column){name, COLUMN_NUMBER}, unit[i + 2] = sgt_tolerance_unit(w->lens, &w->entry[i]);
    }
    w->look.shared.target.unit = unit;
    w->rows = table_begin(&w->look.shared.target, w->count + 2, head);
}

static void take_trial(void *context, const sgt_trial *trial)
{
    tolerating *w = context;
    const bool worse = w->done == 0 || (!isnan(w->worst.figure) && !(trial->figure <= w->worst.figure));
    w->figure[w->done++] = trial->figure;
    if (worse) {
        w->worst = *trial;
        memcpy(w->worst_value, trial->value, w->count * sizeof *w->worst_value);
    }
    if (!w->rows) return;
    table_count(w->rows, (long long)trial->number);
    put_maybe(w->rows, trial->figure);
    for (size_t i = 0; i < w->count; i++) table_number(w->rows, trial->value[i]);
}

/* A NaN stands last: the lens cannot be used. */
static int by_figure(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return isnan(x) || isnan(y) ? isnan(x) - isnan(y) : (x > y) - (x < y);
}

static void put_confidence(table *t, sgt_confidence q)
{
    put_maybe(t, q.estimate), put_maybe(t, q.lower), put_maybe(t, q.upper);
}

static void print_quantiles(tolerating *w)
{
    static const double percent[] = {10, 20, 50, 80, 90, 95, 98, 99};
    static const column head[] = {{"trials", COLUMN_NUMBER},
                                  {"figure", COLUMN_NUMBER},
                                  {"lower", COLUMN_NUMBER},
                                  {"upper", COLUMN_NUMBER}};
    const char *const unit[] = {"%", w->unit, w->unit, w->unit};
    const double confidence = w->own.confidence / 100;
    w->look.shared.target.unit = unit;
    table *t = table_begin(&w->look.shared.target, sizeof head / sizeof *head, head);
    for (size_t i = 0; i < sizeof percent / sizeof *percent; i++) {
        table_number(t, percent[i]);
        put_confidence(t, sgt_quantile(w->done, w->figure, percent[i] / 100, confidence));
    }
    const char *space = *w->unit ? " " : "";
    size_t none = 0;
    while (none < w->done && isnan(w->figure[w->done - 1 - none])) none++;
    table_line(t, "%%: of %zu trials, those whose figure, the %s, is at most this.", w->done, figure_name(w));
    table_line(t, "lower, upper: the true quantile lies between, with %g %% confidence.", w->own.confidence);
    for (size_t i = 0; i < w->own.limits; i++) {
        size_t k = 0;
        while (k < w->done && w->figure[k] <= w->own.limit[i]) k++;
        const sgt_confidence q = sgt_share(k, w->done, confidence);
        table_line(t, "yield at %g%s%s: %.4g %% (%.4g to %.4g %%)", w->own.limit[i], space, w->unit,
                   100 * q.estimate, 100 * q.lower, 100 * q.upper);
    }
    table_line(t, "as designed: %.6g%s%s", sgt_tolerancing_nominal(w->of), space, w->unit);
    table_line(t, "the worst is trial %llu: %.6g%s%s", (unsigned long long)w->worst.number, w->worst.figure,
               space, w->unit);
    if (none) table_line(t, "%zu have no figure: a chief ray, or every ray, does not get through", none);
    table_end(t);
}

static void draw_yield(const tolerating *w)
{
    enum { POINTS = 400, BOUNDS = 99 };
    const size_t n = w->done < POINTS ? w->done : POINTS;
    double *x = memory_take(n, sizeof *x), *y = memory_take(n, sizeof *y);
    double *low = memory_take(BOUNDS, sizeof *low), *high = memory_take(BOUNDS, sizeof *high);
    double *share = memory_take(BOUNDS, sizeof *share);
    for (size_t i = 0; i < n; i++) {
        const size_t k = (i + 1) * w->done / n;
        x[i] = w->figure[k - 1], y[i] = 100 * (double)k / (double)w->done;
    }
    for (size_t i = 0; i < BOUNDS; i++) {
        share[i] = (double)(i + 1) * 100 / (BOUNDS + 1);
        const sgt_confidence q = sgt_quantile(w->done, w->figure, share[i] / 100, w->own.confidence / 100);
        low[i] = q.lower, high[i] = q.upper;
    }
    const char *within = memory_print("%g %% confidence", w->own.confidence);
    const chart_series series[] = {{.name = "yield", .line = true, .count = n, .x = x, .y = y},
                                   {.name = within,
                                    .dash = CHART_DASHED,
                                    .line = true,
                                    .colour = 1,
                                    .count = BOUNDS,
                                    .x = low,
                                    .y = share},
                                   {.name = within,
                                    .dash = CHART_DASHED,
                                    .line = true,
                                    .colour = 1,
                                    .count = BOUNDS,
                                    .x = high,
                                    .y = share}};
    chart_rule *rule = memory_take(w->own.limits + 1, sizeof *rule);
    rule[0] = (chart_rule){
        .upright = true, .at = sgt_tolerancing_nominal(w->of), .name = "as designed", .dash = CHART_DOTTED};
    for (size_t i = 0; i < w->own.limits; i++)
        rule[i + 1] =
            (chart_rule){.upright = true, .at = w->own.limit[i], .name = "limit", .dash = CHART_DASHED};
    const char *what = figure_name(w);
    const chart_panel panel = {.x_label = *w->unit ? memory_print("%s (%s)", what, w->unit) : what,
                               .y_label = "trials (%)",
                               .y_high = 100,
                               .series_count = 3,
                               .series = series,
                               .rules = w->own.limits + 1,
                               .rule = rule};
    size_t set = 0; /* the compensators: they are not off */
    for (size_t i = 0; i < w->count; i++) set += w->entry[i].compensator != SGT_NO_COMPENSATOR;
    const char *and = set == 0 ? "" : memory_print(", %zu compensator%s", set, set == 1 ? "" : "s");
    const char *line[] = {memory_print("%zu trials, %zu tolerance%s%s, seed %d", w->done, w->count - set,
                                       w->count - set == 1 ? "" : "s", and, w->own.seed)};
    chart_write(
        w->look.picture,
        &(chart){
            .title = look_title(&w->look, "yield"), .line = line, .lines = 1, .panels = 1, .panel = &panel});
}

static void write_worst(const tolerating *w)
{
    sgt_error e;
    size_t length;
    sgt_lens *built = sgt_tolerancing_lens(w->of, w->worst_value, &e);
    if (!built) lens_refuse(&e);
    const char *text = sgt_lens_yaml(built, &length);
    if (!text) fail_input("%s: could not be written as YAML", w->own.worst);
    output_fill("worst", w->own.worst, text, length);
    sgt_lens_free(built);
}

static void run_trials(tolerating *w)
{
    const tolerance_options *o = &w->own;
    const bool text = w->look.shared.target.format == TABLE_TEXT;
    sgt_error e;
    w->figure = memory_take((size_t)o->trials, sizeof *w->figure);
    w->worst_value = memory_take(w->count + 1, sizeof *w->worst_value);
    if (!text) begin_rows(w);
    if (!sgt_tolerancing_trials(w->of, (uint64_t)o->seed, (uint64_t)o->first, (uint64_t)o->trials, take_trial,
                                w, &e))
        lens_refuse(&e);
    qsort(w->figure, w->done, sizeof *w->figure, by_figure);
    if (text)
        print_quantiles(w);
    else
        table_end(w->rows);
    if (o->worst) write_worst(w);
    if (w->look.picture) draw_yield(w);
}

/* ------------------------------------------------------------------------ the worst case */

static exit_status print_worst_case(tolerating *w)
{
    static const column head[] = {{"tolerance", COLUMN_WORD}, {"lower", COLUMN_EXACT},
                                  {"upper", COLUMN_EXACT},    {"unit", COLUMN_WORD},
                                  {"worst", COLUMN_NUMBER},   {"cuts", COLUMN_COUNT},
                                  {"bound", COLUMN_NUMBER},   {"seen", COLUMN_NUMBER}};
    const char *const unit[] = {"", "", "", "", "", "", w->unit, w->unit};
    const sgt_worst_options opt = {.limit = {w->own.limits, w->own.limit}, .boxes = (size_t)w->own.boxes};
    const bool text = w->look.shared.target.format == TABLE_TEXT;
    sgt_worst_case found;
    sgt_error e;
    size_t *cuts = memory_take(w->count + 1, sizeof *cuts);
    w->worst_value = memory_take(w->count + 1, sizeof *w->worst_value);
    if (!sgt_tolerancing_worst(w->of, &opt, &found, w->worst_value, cuts, &e)) lens_refuse(&e);
    table_target target = w->look.shared.target;
    target.unit = unit, target.word_size = SGT_TOLERANCE_SIZE;
    table *t = table_begin(&target, sizeof head / sizeof *head - (text ? 2 : 0), head);
    for (size_t i = 0; i < w->count; i++) {
        const sgt_tolerance *a = &w->entry[i];
        table_word(t, entry_name(w, i));
        table_number(t, a->lower), table_number(t, a->upper);
        table_word(t, sgt_tolerance_unit(w->lens, a));
        table_number(t, w->worst_value[i]), table_count(t, (long long)cuts[i]);
        if (!text) table_number(t, found.bound), put_maybe(t, found.seen);
    }
    const char *space = *w->unit ? " " : "";
    table_line(t,
               "worst: the worst lens that was found, of %zu that were built.  cuts: boxes halved along it.",
               found.lenses);
    table_line(t, "figure: %s; of this lens %.6g%s%s", figure_name(w), found.seen, space, w->unit);
    if (found.bound < HUGE_VAL)
        table_line(t, "proven: no lens in tolerance has a figure above %.6g%s%s  (%zu boxes)", found.bound,
                   space, w->unit, found.boxes);
    else if (found.element)
        table_line(t, "no bound is known: element %zu: %s", found.element, found.why);
    else
        table_line(t, "no bound is known: %s", found.why);
    if (w->own.limits)
        table_line(t, "limit %g%s%s: %s", w->own.limit[0], space, w->unit,
                   sgt_limit_verdict_text(found.verdict));
    table_end(t);
    if (w->own.worst) write_worst(w);
    if (found.verdict == SGT_LIMIT_BROKEN) return EXIT_BROKEN;
    return w->own.limits ? found.verdict == SGT_LIMIT_PROVEN ? EXIT_DECIDED : EXIT_UNDECIDED
           : found.bound < HUGE_VAL ? EXIT_DECIDED : EXIT_UNDECIDED;
}

/* ---------------------------------------------------------------------- the command */

static exit_status tolerance_run(const command *c, int argc, char *argv[]);

const command command_tolerance = {
    .name = "tolerance",
    .usage = "LENS [options]",
    .brief = "how badly a lens may be built",
    .what = "What the tolerances of a lens file do to a figure: each at both ends, or with --trials all "
            "together, in lenses built at random.  Compensators are set first.",
    .often = "figure trials worst-case limit worst trial-seed fields hexapolar picture threads format output",
    .examples = "  sagitta tolerance examples/lenses/triplet_tolerances.yaml\n"
                "  sagitta tolerance examples/lenses/triplet_tolerances.yaml --trials 1000 --limit 0.02\n",
    .docs = "docs/tolerance.md",
    .exits = "  0  done\n"
             "  1  the worst case, or its limit, is undecided\n"
             "  2  wrong arguments\n"
             "  3  bad input, or output that cannot be written\n"
             "  4  a lens in tolerance breaks the limit of the worst case\n",
    .group = {&tolerance_own, &picture_group, &job_fields_options, &job_pattern_options, &job_no_file,
              &job_aim_options, &job_wavelength_options, &job_glass_options, &job_aperture_options,
              &options_in_threads, &options_rows},
    .run = tolerance_run,
};

static sgt_tolerancing *tolerancings[1];

static void free_tolerancing(void) { sgt_tolerancing_free(tolerancings[0]); }

/* The answer of a lens, or of one of its configurations. */
static exit_status tolerance_of_lens(tolerating *w)
{
    static bool registered;
    look *l = &w->look;
    sgt_error e;
    int threads;
    const job_points_asked points = job_points_of(&l->job, l->of->pattern);
    const sgt_study_options study = look_study(l, &points, &threads);
    lens_write_check("worst", w->own.worst);
    if (w->own.worst) output_reserve("worst", w->own.worst);
    if (l->picture) output_reserve("picture", l->picture);
    w->lens = l->primary.of;
    w->count = sgt_lens_tolerances(w->lens, &w->entry);
    if (!w->count)
        lens_fail(&l->primary, "tolerances",
                  "missing; a list of what may be off, as tolerances: [{surface: 1, radius: 0.02}] "
                  "(docs/tolerance.md), in a lens file: sagitta import FILE -o LENS makes one of .zmx "
                  "and .seq");
    w->unit = w->own.figure == SGT_TOLERANCING_OPD ? "waves" : w->lens->afocal ? "mrad" : w->lens->units;
    const sgt_tolerancing_options options = {
        .figure = (sgt_tolerancing_figure)w->own.figure, .study = &study, .reference = w->own.reference};
    free_tolerancing(), tolerancings[0] = NULL;
    w->of = tolerancings[0] = sgt_tolerancing_new(w->lens, &options, &e);
    if (!w->of) lens_refuse(&e);
    if (!registered) atexit(free_tolerancing);
    registered = true;
    if (w->own.proven) return print_worst_case(w);
    if (w->own.trials)
        run_trials(w);
    else
        print_sensitivity(w);
    return EXIT_DECIDED;
}

static exit_status tolerance_run(const command *c, int argc, char *argv[])
{
    tolerating w = {.own = {.seed = 1, .confidence = 95}};
    look *l = &w.look;
    command_read(c, &w.own, &l->job, &l->shared, argc, argv);
    l->job.lens = command_file(c, "lens file", argc, argv), l->job.several = true;
    l->of = sgt_analysis_named(w.own.figure == SGT_TOLERANCING_OPD ? "wavefront" : "spot");
    l->picture = l->shared.picture;
    if (l->job.rays) fail_usage("--rays: tolerance launches the rays of fields; sagitta trace takes a file");
    if (l->job.skip_bad) fail_usage("--skip-bad goes with --rays; tolerance launches the rays of fields");
    if (w.own.figure == SGT_TOLERANCING_BORESIGHT && (l->job.pupils || l->job.points))
        fail_usage("a pattern of rays is of no use here: the chief rays alone are traced");
    if (w.own.figure && w.own.reference) fail_usage("--reference goes with --figure spot");
    if (w.own.proven && w.own.trials) fail_usage("--worst-case and --trials: ask for one of them");
    if (w.own.boxes && !w.own.proven) fail_usage("--boxes goes with --worst-case");
    if (w.own.proven && w.own.limits > 1) fail_usage("--worst-case has one --limit");
    if (!w.own.trials && !w.own.proven && (w.own.limits || w.own.worst))
        fail_usage("--limit and --worst go with --trials N or --worst-case");
    if (!w.own.trials && (l->picture || w.own.first)) fail_usage("--picture and --first go with --trials N");
    if (!l->job.wavelengths) l->job.all_wavelengths = true;
    exit_status status = EXIT_DECIDED;
    const lens_each all = lens_open_each(l->job.lens);
    if (all.count && (w.own.trials || w.own.proven))
        fail_usage("--%s: of one configuration; give its number or name, not --configuration all",
                   w.own.trials ? "trials" : "worst-case");
    l->shared.target.leads = all.count;
    for (size_t i = 0; i < (all.count ? all.count : 1); i++) {
        if (all.count) l->job.of = all.at[i], w.configuration = i + 1, w.name = all.name[i];
        status = tolerance_of_lens(&w);
    }
    if (w.together) table_end(w.together);
    return status;
}
