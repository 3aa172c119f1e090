/* opd.c - sagitta opd: optical path differences in waves, their summary, and Zernike polynomials. */
#include "commands.h"
#include "../base/memory.h"
#include "../draw/chart.h"
#include "../look/lines.h"
#include "../look/look.h"
#include "../look/net.h"

#include <math.h>
#include <string.h>

static const char opd_help[] =
    "sagitta opd LENS [options]\n"
    "\n"
    "Optical path differences of the rays of a field, in waves: the path of a ray to the reference sphere,\n"
    "less that of the chief ray of the same wavelength.  Positive: the ray's path is longer.\n"
    "\n"
    "The sphere is about the point where the chief ray meets the image.  Its radius is the distance from\n"
    "there to the centre of the paraxial exit pupil (primary wavelength).  If that pupil is at infinity,\n"
    "paths end at the foot of the perpendicular from the point on the ray.\n"
    "\n"
    "Columns, for two lines across the pupil or another pattern of rays\n"
    "  field, wavelength  the field, counted from 1; micrometres\n"
    "  px, py             the point of the pupil, in radii of it\n"
    "  fate               passed; missed, clipped, tir, lost; none: proven, no such ray\n"
    "  opd, opd_err       the difference, and how far rounding may have put it off (waves)\n"
    "\n"
    "Columns of --summary, over an area\n"
    "  pv, rms            largest less smallest; root of the mean square about the mean (waves)\n"
    "  digits             so many decimal digits of rms are certain in spite of rounding\n"
    "  sampling           rms, less that of half as many rays across the pupil\n"
    "  rays, passed, missed, clipped, tir, lost, none, proven\n"
    "                     how many rays, and what became of them (sagitta spot --help)\n"
    "\n"
    "Columns of --zernike, over an area\n"
    "  term, n, m         the number of the polynomial, its order, its azimuthal frequency: positive of\n"
    "                     cosines, negative of sines; the angle is from px toward py\n"
    "  coefficient        by least squares (waves)\n"
    "  residual           root of the mean square of what the fit leaves (waves)\n"
    "\n"
    "Options\n"
    "  --afocal           for light that leaves as parallel rays: against a plane across the chief ray\n"
    "                     (the default if the lens says `afocal: true`)\n"
    "  --summary          a row for each field and wavelength\n"
    "  --zernike N        fits the first N Zernike polynomials\n"
    "  --order O          noll (the default; Noll 1976; each has the mean square 1), or fringe (Wyant and\n"
    "                     Creath 1992; each is 1 at the edge)\n";

typedef struct opd_arguments {
    look_options look;
    bool summary, afocal;
    long terms;                 /* 0: no fit */
    sgt_zernike_order order;
} opd_arguments;

enum { TERMS_MOST = 5151 };

static opd_arguments opd_arguments_of(int argc, char *argv[])
{
    enum { SUMMARY = OPTION_AFTER_LOOK, ZERNIKE, ORDER, AFOCAL };
    static const struct option known[] = {
        {"summary", no_argument, NULL, SUMMARY}, {"zernike", required_argument, NULL, ZERNIKE},
        {"order", required_argument, NULL, ORDER}, {"afocal", no_argument, NULL, AFOCAL}, LOOK_OPTIONS, {0},
    };
    opd_arguments a = {.look.pattern = "--cross 41; with --summary or --zernike --cells 32",
                       .order = SGT_NOLL};
    bool order = false;
    for (int code; (code = getopt_long(argc, argv, LOOK_LETTERS, known, NULL)) != -1;) {
        if (code == SUMMARY) {
            a.summary = true;
        } else if (code == AFOCAL) {
            a.afocal = true;
        } else if (code == ZERNIKE) {
            a.terms = options_integer("zernike", optarg, 1, TERMS_MOST);
        } else if (code == ORDER) {
            order = true, a.order = strcmp(optarg, "fringe") == 0 ? SGT_FRINGE : SGT_NOLL;
            if (a.order == SGT_NOLL && strcmp(optarg, "noll") != 0)
                fail_usage("--order must be noll or fringe, not \"%s\"", optarg);
        } else {
            look_take_option(&a.look, code, opd_help);
        }
    }
    look_take_lens(&a.look, argc, argv, "opd");
    if (a.summary && a.terms) fail_usage("give --summary or --zernike, not both");
    if (order && !a.terms) fail_usage("--order goes with --zernike N");
    return a;
}

/* The rays of a field at a wavelength, and their differences in waves. */
typedef struct opd_of { sgt_ray_end *end; double *waves, *error; bool reference; } opd_of;

typedef struct opd_work {
    const opd_arguments *asked;
    bool afocal;                /* asked for, or of the lens */
    look look;
    launch_pattern points, coarse;
    table *table;
    opd_of fine, half;          /* rooms for points and coarse */
    look_lines *lines;          /* [fields]; NULL: they are not drawn */
    double **map;               /* [fields * bands]: waves, [points]; NULL: they are not drawn */
    size_t rows;
} opd_work;

static opd_of opd_room(size_t count)
{
    return (opd_of){.end = memory_take(count, sizeof(sgt_ray_end)),
                    .waves = memory_take(count, sizeof(double)),
                    .error = memory_take(count, sizeof(double))};
}

static void opd_trace(opd_work *w, size_t field, const look_band *band, const launch_pattern *points,
                      bool counted, opd_of *of)
{
    look *l = &w->look;
    const sgt_field_beam *beam = &l->beam[field];
    const double scale = l->um / band->lens.wavelength;
    look_trace(l, beam, band, band->element, points, counted, of->end);
    const sgt_ray_end chief = look_chief(l, beam, band, band->element);
    sgt_reference about;
    of->reference = sgt_reference_of(band->lens.of, &l->primary.data, band->element, band->lens.index_before,
                                     &chief, w->afocal, &about, NULL);
    for (size_t i = 0; i < points->count; i++) {
        of->waves[i] = of->error[i] = (double)NAN;
        if (!of->reference) continue;
        of->waves[i] = scale * sgt_opd(&about, &of->end[i], &of->error[i]);
        of->error[i] *= scale;
    }
}

/* "field 2", and the wavelength where there are several. */
static const char *opd_name(const look *l, size_t field, const look_band *band)
{
    const size_t number = l->fields.number[field] + 1;
    return l->bands > 1 ? look_text("field %zu, %s", number, look_wavelength_name(band))
                        : look_text("field %zu", number);
}

/* Says why cells of rays that passed are empty. */
static void opd_note_empty(const opd_work *w, const char *name, const opd_of *of)
{
    size_t without = 0;
    for (size_t i = 0; i < w->points.count; i++)
        without += of->end[i].fate == SGT_PASSED && isnan(of->waves[i]);
    if (!of->reference)
        note("%s: the chief ray does not get through, so there is no reference", name);
    else if (without)
        note("%s: %zu ray%s passed and %s no path difference: the reference sphere is missed, or has no "
             "radius",
             name, without, without == 1 ? "" : "s", without == 1 ? "has" : "have");
}

static void opd_gap(opd_work *w)
{
    if (w->rows++ > 0) table_gap(w->table);
}

static void opd_ray_rows(opd_work *w, size_t field, const look_band *band, const opd_of *of)
{
    opd_gap(w);
    for (size_t i = 0; i < w->points.count; i++) {
        look_cells(w->table, &w->look, field, band);
        table_number(w->table, of->end[i].px);
        table_number(w->table, of->end[i].py);
        look_fate_cell(w->table, &of->end[i]);
        look_number(w->table, of->waves[i]);
        look_number(w->table, of->error[i]);
    }
}

static void opd_summary_row(opd_work *w, size_t field, const look_band *band, const opd_of *of)
{
    table *t = w->table;
    look_fates fates = {.rays = 0};
    for (size_t i = 0; i < w->points.count; i++) look_count(&fates, &of->end[i]);
    const sgt_wavefront front = sgt_wavefront_of(w->points.count, of->end, of->waves, of->error);
    opd_trace(w, field, band, &w->coarse, false, &w->half);
    const sgt_wavefront coarse = sgt_wavefront_of(w->coarse.count, w->half.end, w->half.waves, w->half.error);
    look_cells(t, &w->look, field, band);
    look_number(t, front.most - front.least);
    look_number(t, front.rms);
    table_count(t, look_digits(front.rms, front.error));
    look_number(t, front.rms - coarse.rms);
    table_count(t, (long long)fates.rays);
    table_count(t, (long long)fates.passed);
    look_fate_cells(t, &w->look, &fates);
}

/* The order and the azimuthal frequency of a polynomial, counted from 1 (surfaces.h has the sources). */
static void zernike_numbers(sgt_zernike_order order, long term, long *n, long *m)
{
    long q = 0, left = term - 1;
    if (order == SGT_FRINGE) { /* groups of 2 q + 1 with n + m = 2 q, m = q, q, q - 1, ... */
        for (; left > 2 * q; q++) left -= 2 * q + 1;
        *m = left % 2 ? -(q - left / 2) : q - left / 2;
        *n = 2 * q - (q - left / 2);
        return;
    }
    for (; left > q; q++) left -= q + 1; /* Noll: orders n = q; |m| grows, even terms are cosines */
    *n = q;
    *m = q % 2 ? 1 + 2 * (left / 2) : 2 * ((left + 1) / 2);
    if (term % 2) *m = -*m;
}

static void opd_zernike_rows(opd_work *w, size_t field, const look_band *band, const opd_of *of)
{
    const size_t terms = (size_t)w->asked->terms, count = w->points.count;
    double *coefficient = memory_take(terms, sizeof *coefficient), residual;
    double *x = memory_take(count, sizeof *x), *y = memory_take(count, sizeof *y),
           *weight = memory_take(count, sizeof *weight);
    for (size_t i = 0; i < count; i++)
        x[i] = of->end[i].px, y[i] = of->end[i].py, weight[i] = of->end[i].weight;
    if (!sgt_zernike_fit(w->asked->order, terms, count, x, y, of->waves, weight, coefficient, &residual,
                         NULL, NULL)) {
        note("%s: the rays that passed do not determine %zu polynomials, or there is no memory; take more "
             "rays, or fewer terms",
             opd_name(&w->look, field, band), terms);
        for (size_t i = 0; i < terms; i++) coefficient[i] = (double)NAN;
        residual = (double)NAN;
    }
    opd_gap(w);
    for (size_t i = 0; i < terms; i++) {
        long n, m;
        zernike_numbers(w->asked->order, (long)i + 1, &n, &m);
        look_cells(w->table, &w->look, field, band);
        table_count(w->table, (long long)i + 1);
        table_count(w->table, n);
        table_count(w->table, m);
        look_number(w->table, coefficient[i]);
        look_number(w->table, residual);
    }
}

static table *opd_table(const opd_work *w)
{
    static const column first[] = {{"field", COLUMN_COUNT}, {"wavelength", COLUMN_EXACT}};
    static const column ray[] = {
        {"px", COLUMN_NUMBER}, {"py", COLUMN_NUMBER}, {"fate", COLUMN_CODE}, {"opd", COLUMN_NUMBER},
        {"opd_err", COLUMN_ERROR},
    };
    static const column summary[] = {
        {"pv", COLUMN_NUMBER}, {"rms", COLUMN_NUMBER}, {"digits", COLUMN_COUNT}, {"sampling", COLUMN_ERROR},
        {"rays", COLUMN_COUNT}, {"passed", COLUMN_COUNT},
    };
    static const column zernike[] = {
        {"term", COLUMN_COUNT}, {"n", COLUMN_COUNT}, {"m", COLUMN_COUNT}, {"coefficient", COLUMN_NUMBER},
        {"residual", COLUMN_NUMBER},
    };
    enum { FIRST = 2, RAY = 5, SUMMARY = 6, ROOM = FIRST + SUMMARY + LOOK_FATES };
    column *columns = memory_take(ROOM, sizeof *columns);
    size_t n = FIRST;
    memcpy(columns, first, sizeof first);
    if (w->asked->terms) memcpy(columns + n, zernike, sizeof zernike), n += RAY;
    else if (!w->asked->summary) memcpy(columns + n, ray, sizeof ray), n += RAY;
    else
        memcpy(columns + n, summary, sizeof summary), n += SUMMARY,
            n += look_fate_columns(&w->look, columns + n);
    return table_begin(&w->look.asked->shared.target, n, columns);
}

static void opd_lines_under(const opd_work *w)
{
    const sgt_first_order *o = &w->look.primary.data;
    table_line(w->table, "In waves; positive: the path is longer than the chief ray's to the reference %s.",
               w->afocal                 ? "plane"
               : isfinite(o->exit_pupil) ? "sphere"
                                         : "sphere, of infinite radius");
    if (w->asked->terms)
        table_line(w->table, "Zernike polynomials in %s over px, py.",
                   w->asked->order == SGT_NOLL ? "Noll's order, each with a mean square of 1"
                                               : "fringe order, each 1 at the edge");
    look_verdict(w->table, &w->look);
}

/* Is this pattern an area on a square net, as a map needs it? */
static bool opd_is_map(const opd_work *w)
{
    return w->points.n && (w->points.pattern == SGT_PATTERN_CELLS || w->points.pattern == SGT_PATTERN_GRID);
}

/* Keeps what the picture needs of a field at a wavelength; the differences are copied. */
static void opd_keep(opd_work *w, size_t field, size_t b, const opd_of *of)
{
    if (w->map) {
        double *waves = memory_take(w->points.count, sizeof *waves);
        memcpy(waves, of->waves, w->points.count * sizeof *waves);
        w->map[field * w->look.bands + b] = waves;
    } else if (w->lines) {
        if (b == 0) w->lines[field] = look_lines_for(&w->look, &w->points);
        for (size_t i = 0; i < w->points.count; i++)
            look_lines_add(&w->lines[field], b, &of->end[i], of->waves[i], of->waves[i]);
    }
}

static void draw_opd_maps(const opd_work *w)
{
    const look *l = &w->look;
    const size_t panels = l->fields.count * l->bands;
    chart_panel *panel = memory_take(panels, sizeof *panel);
    chart_map *map = memory_take(panels, sizeof *map);
    for (size_t i = 0; i < panels; i++) {
        const look_band *band = &l->band[i % l->bands];
        map[i] = look_net(&w->points, w->map[i], "waves");
        map[i].about_zero = true;
        panel[i] = (chart_panel){
            .title = look_text("%s, %.6g \302\265m", look_field_name(l, i / l->bands), band->lens.wavelength),
            .x_label = "px", .y_label = "py", .square = true, .map = &map[i]};
    }
    const char *line[] = {look_lens_line(l), "in waves, against the chief ray of each wavelength",
                          look_fates_line(l, &l->fates)};
    chart_write(l->asked->picture, &(chart){.title = look_title(l, "wavefronts"), .line = line, .lines = 3,
                                            .columns = l->bands > 1 ? l->bands : 0, .panels = panels,
                                            .panel = panel});
}

static void draw_opd(const opd_work *w)
{
    if (w->map) draw_opd_maps(w);
    else
        look_lines_draw(&w->look, w->lines, "optical path differences",
                        "in waves, against the chief ray of each wavelength", "opd (waves)", "opd (waves)");
}

/* A wave is a length: both have to be known. */
static void check_waves(const look *l, bool afocal)
{
    const lens *of = &l->primary.lens;
    for (size_t b = 0; b < l->bands; b++)
        if (isnan(l->band[b].lens.wavelength))
            fail_usage("%s gives no wavelengths, and the differences are told in waves: give --wavelength",
                       of->of->file);
    if (isnan(l->um))
        lens_fail(of, "units", "must be mm, cm, m, um or in for differences in waves%s%s",
                  *of->units ? ", not " : "; it is missing", of->units);
    if (!afocal && !isfinite(l->primary.data.exit_pupil))
        note("the exit pupil is at infinity or not known (sagitta info): the reference sphere has an "
             "infinite radius");
}

exit_status command_opd(int argc, char *argv[])
{
    enum { ACROSS = 41, CELLS = 32 };
    const opd_arguments a = opd_arguments_of(argc, argv);
    const bool area = a.summary || a.terms;
    opd_work w = {.asked = &a, .points = job_points(&a.look.job, area ? SGT_PATTERN_CELLS : SGT_PATTERN_CROSS,
                                                    area ? CELLS : ACROSS)};
    const bool map = a.look.picture && opd_is_map(&w), lines = a.look.picture && !map;
    if (lines) look_lines_check(&w.points);
    w.look = look_begin(&a.look);
    look *l = &w.look;
    w.afocal = a.afocal || l->primary.lens.of->afocal;
    check_waves(l, w.afocal);
    w.coarse = look_coarser(l, &w.points);
    w.fine = opd_room(w.points.count), w.half = opd_room(w.coarse.count);
    if (lines) w.lines = memory_take(l->fields.count, sizeof *w.lines);
    if (map) w.map = memory_take(l->fields.count * l->bands, sizeof *w.map);
    w.table = opd_table(&w);
    for (size_t f = 0; f < l->fields.count; f++)
        for (size_t b = 0; b < l->bands; b++) {
            const look_band *band = &l->band[b];
            opd_trace(&w, f, band, &w.points, true, &w.fine);
            opd_note_empty(&w, opd_name(l, f, band), &w.fine);
            opd_keep(&w, f, b, &w.fine);
            if (a.summary) opd_summary_row(&w, f, band, &w.fine);
            else if (a.terms) opd_zernike_rows(&w, f, band, &w.fine);
            else opd_ray_rows(&w, f, band, &w.fine);
        }
    opd_lines_under(&w);
    table_end(w.table);
    if (a.look.picture) draw_opd(&w);
    return look_status(l);
}
