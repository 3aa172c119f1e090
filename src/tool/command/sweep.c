/* sweep.c - sagitta sweep: how many rays meet which fate, against the field. */
#include "commands.h"
#include "../base/memory.h"
#include "../draw/chart.h"
#include "../look/look.h"

#include <math.h>

static const char sweep_help[] =
    "sagitta sweep LENS [options]\n"
    "\n"
    "Counts what becomes of the rays of one field after another, in the y-z plane.  No number is of the\n"
    "image, so an afocal lens has the same columns.\n"
    "\n"
    "Columns\n"
    "  at                 the field: its angle in degrees, or, of an object at a distance, its height\n"
    "  wavelength         micrometres\n"
    "  rays               how many were sent\n"
    "  passed, missed, clipped, tir, lost\n"
    "                     what became of them; lost: it could not be decided\n"
    "  none               proven: the rims in front of the stop let no such ray through.  A ray that\n"
    "                     aiming did not find, without a proof, is lost\n"
    "  evals              the mean number of evaluations of a ray, at all elements together\n"
    "  proven             with --proof: rays that passed and were proven at each surface\n"
    "\n"
    "Options\n"
    "  --from A, --to B   the range.  By default from the axis to twice the field of the lens which is\n"
    "                     farthest from it, or to 89 degrees if it has none\n"
    "  --steps N          how many fields (default 46)\n";

typedef struct sweep_arguments {
    look_options look;
    double from, to;            /* NaN: not given */
    long steps;
} sweep_arguments;

static double sweep_end(const char *option)
{
    const double value = options_number(option, optarg);
    if (!isfinite(value)) fail_usage("--%s must be finite, not %s", option, optarg);
    return value;
}

static sweep_arguments sweep_arguments_of(int argc, char *argv[])
{
    enum { FROM = OPTION_AFTER_LOOK, TO, STEPS, STEPS_DEFAULT = 46, STEPS_MOST = 1000000 };
    static const struct option known[] = {
        {"from", required_argument, NULL, FROM}, {"to", required_argument, NULL, TO},
        {"steps", required_argument, NULL, STEPS}, LOOK_OPTIONS, {0},
    };
    sweep_arguments a = {.look = {.pattern = "--hexapolar 10", .no_fields = true, .primary_alone = true},
                         .from = (double)NAN, .to = (double)NAN, .steps = STEPS_DEFAULT};
    for (int code; (code = getopt_long(argc, argv, LOOK_LETTERS, known, NULL)) != -1;) {
        if (code == FROM) a.from = sweep_end("from");
        else if (code == TO) a.to = sweep_end("to");
        else if (code == STEPS) a.steps = options_integer("steps", optarg, 2, STEPS_MOST);
        else look_take_option(&a.look, code, sweep_help);
    }
    look_take_lens(&a.look, argc, argv, "sweep");
    if (a.look.job.fields || a.look.job.numbers)
        fail_usage("--field, --fields: sweep takes --from and --to");
    return a;
}

typedef struct sweep_step { double at, evals; look_fates fates; } sweep_step;

typedef struct sweep_work {
    const sweep_arguments *asked;
    look look;
    bool angle;
    double from, to;
    size_t steps;
    launch_pattern points;
    sgt_ray_end *end;           /* [points], of one field after another */
    sweep_step *step;           /* [bands * steps] */
} sweep_work;

/* Twice the farthest field of the lens. */
static double sweep_far(const look *l, bool angle)
{
    const double DEGREE = 57.29577951308232, MOST = 89;
    double far = 0;
    for (size_t f = 0; f < l->fields.count; f++) {
        const sgt_field_beam *b = &l->beam[f];
        far = fmax(far, angle ? DEGREE * atan(hypot(b->direction.x, b->direction.y) / fabs(b->direction.z))
                              : hypot(b->object.x, b->object.y));
    }
    if (!angle) return 2 * far;
    return far > 0 ? fmin(2 * far, MOST) : MOST;
}

static void sweep_range(sweep_work *w)
{
    const sweep_arguments *a = w->asked;
    w->from = isnan(a->from) ? 0 : a->from;
    w->to = isnan(a->to) ? sweep_far(&w->look, w->angle) : a->to;
    if (w->from == w->to)
        fail_usage("--from and --to are the same: %g; give a range of %s", w->to,
                   w->angle ? "angles" : "object heights");
    if (w->angle && !(fabs(w->from) < 90 && fabs(w->to) < 90))
        fail_usage("--from, --to: angles must be between -90 and 90 degrees, not %g to %g", w->from, w->to);
}

static sweep_step sweep_at(sweep_work *w, const look_band *band, double at)
{
    look *l = &w->look;
    const sgt_field_beam beam = look_beam(l, w->angle ? SGT_FIELD_ANGLE : SGT_FIELD_OBJECT_HEIGHT,
                                          (sgt_lens_field){.y = at, .weight = 1});
    look_trace(l, &beam, band, band->element, &w->points, true, w->end);
    sweep_step s = {.at = at};
    for (size_t i = 0; i < w->points.count; i++)
        look_count(&s.fates, &w->end[i]), s.evals += w->end[i].evals;
    s.evals /= (double)w->points.count;
    return s;
}

static void sweep_row(table *t, const look *l, const look_band *band, const sweep_step *s)
{
    const look_fates *f = &s->fates;
    const size_t each[] = {f->rays, f->passed, f->missed, f->clipped, f->tir, f->lost, f->none};
    table_number(t, s->at);
    look_number(t, band->lens.wavelength);
    for (size_t i = 0; i < sizeof each / sizeof *each; i++) table_count(t, (long long)each[i]);
    table_number(t, s->evals);
    if (l->asked->shared.solver.proof) table_count(t, (long long)f->proven);
}

static double sweep_share(const look_fates *f, int which)
{
    const size_t each[] = {f->passed, f->missed, f->clipped, f->tir, f->lost, f->none};
    return 100 * (double)each[which] / (double)f->rays;
}

static void draw_sweep(const sweep_work *w)
{
    enum { FATES = 6 };
    static const char *const names[FATES] = {"passed", "missed", "clipped", "totally reflected", "lost",
                                             "no such ray"};
    static const chart_mark marks[FATES] = {CHART_NO_MARK, CHART_TRIANGLE, CHART_CROSS, CHART_RING,
                                            CHART_SQUARE, CHART_DIAMOND};
    const look *l = &w->look;
    chart_panel *panel = memory_take(l->bands, sizeof *panel);
    for (size_t b = 0; b < l->bands; b++) {
        const sweep_step *s = &w->step[b * w->steps];
        chart_series *series = memory_take(FATES, sizeof *series);
        size_t n = 0;
        for (int k = 0; k < FATES; k++) {
            double *x = memory_take(w->steps, sizeof *x), *y = memory_take(w->steps, sizeof *y);
            bool any = k == 0;
            for (size_t i = 0; i < w->steps; i++) {
                x[i] = s[i].at, y[i] = sweep_share(&s[i].fates, k);
                any = any || y[i] > 0;
            }
            if (any)
                series[n++] = (chart_series){.name = names[k], .colour = (size_t)k, .mark = marks[k],
                                             .line = true, .count = w->steps, .x = x, .y = y};
        }
        const char *name = look_wavelength_name(&l->band[b]), *units = l->primary.lens.units;
        panel[b] =
            (chart_panel){.title = l->bands > 1 ? name : NULL,
                          .x_label = w->angle ? "field angle (degrees)"
                                              : look_text("object height (%s)", *units ? units : "length"),
                          .y_label = "rays (%)",
                          .x_low = fmin(w->from, w->to),
                          .x_high = fmax(w->from, w->to),
                          .y_high = 100,
                          .series_count = n,
                          .series = series};
    }
    const char *line[] = {look_lens_line(l), look_fates_line(l, &l->fates)};
    chart_write(l->asked->picture, &(chart){.title = look_title(l, "fates against the field"), .line = line,
                                            .lines = 2, .panels = l->bands, .panel = panel});
}

exit_status command_sweep(int argc, char *argv[])
{
    enum { RINGS = 10 };
    static const column columns[] = {
        {"at", COLUMN_NUMBER}, {"wavelength", COLUMN_EXACT}, {"rays", COLUMN_COUNT}, {"passed", COLUMN_COUNT},
        {"missed", COLUMN_COUNT}, {"clipped", COLUMN_COUNT}, {"tir", COLUMN_COUNT}, {"lost", COLUMN_COUNT},
        {"none", COLUMN_COUNT}, {"evals", COLUMN_NUMBER}, {"proven", COLUMN_COUNT},
    };
    enum { COUNT = sizeof columns / sizeof columns[0] };
    const sweep_arguments a = sweep_arguments_of(argc, argv);
    sweep_work w = {.asked = &a, .steps = (size_t)a.steps,
                    .points = job_points(&a.look.job, SGT_PATTERN_HEXAPOLAR, RINGS)};
    w.end = memory_take(w.points.count, sizeof *w.end);
    w.look = look_begin(&a.look);
    w.angle = !isfinite(w.look.primary.lens.of->object_distance);
    sweep_range(&w);
    table *t = table_begin(&a.look.shared.target, a.look.shared.solver.proof ? COUNT : COUNT - 1, columns);
    w.step = memory_take(w.look.bands * w.steps, sizeof *w.step);
    for (size_t b = 0; b < w.look.bands; b++) {
        if (b > 0) table_gap(t);
        for (size_t i = 0; i < w.steps; i++) {
            const double at = w.from + (w.to - w.from) * (double)i / (double)(w.steps - 1);
            w.step[b * w.steps + i] = sweep_at(&w, &w.look.band[b], at);
            sweep_row(t, &w.look, &w.look.band[b], &w.step[b * w.steps + i]);
        }
    }
    look_verdict(t, &w.look);
    table_end(t);
    if (a.look.picture) draw_sweep(&w);
    return look_status(&w.look);
}
