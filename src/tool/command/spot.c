/* spot.c - sagitta spot: where the rays of each field meet the image.
 *
 * DIGITS is what rounding leaves certain of the rms; SAMPLING is another matter: how much the rms changes if
 * half as many rays across the pupil are taken. */
#include "commands.h"
#include "../base/memory.h"
#include "../draw/chart.h"
#include "../look/look.h"

#include <math.h>
#include <string.h>

static const char spot_help[] =
    "sagitta spot LENS [options]\n"
    "\n"
    "The spots of a lens: how rays of each field and wavelength scatter about a point of the image.\n"
    "\n"
    "Columns (lengths in the unit of the lens, in the frame of the last surface)\n"
    "  field, wavelength  the field, counted from 1; micrometres, or all (a NaN in npy): together, as the\n"
    "                     lens weighs its wavelengths\n"
    "  rays, passed       how many were sent, and how many reached the image: the others do not count\n"
    "  x, y               the reference: distances are from here\n"
    "  rms, rms_x, rms_y  root of the mean square of the distances, and of their x and y\n"
    "  geometric          the largest distance\n"
    "  airy               the radius of the first dark ring of diffraction, 1.22 wavelength working\n"
    "                     F-number (paraxial).  Empty if the unit or the wavelength is not given\n"
    "  digits             so many decimal digits of rms are certain in spite of rounding\n"
    "  sampling           rms, less that of half as many rays across the pupil.  So much more or less\n"
    "                     depends on the rays that are taken\n"
    "  missed, clipped, tir, lost, none\n"
    "                     what became of the other rays; none: proven, no such ray;\n"
    "  proven             with --proof: rays that passed and were proven at each surface (all of these\n"
    "                     in csv and json; in text the line below tells it)\n"
    "  defocus            with --defocus\n"
    "  x_mrad, ... sampling_mrad\n"
    "                     instead of x to sampling, if the lens is afocal: angles in milliradians.  Those\n"
    "                     of the reference are from z of the last surface, the others from the reference\n"
    "\n"
    "Options\n"
    "  --reference R      chief (the default): where the chief ray of the primary wavelength ends;\n"
    "                     centroid: the mean of the rays of the row\n"
    "  --defocus Z        moves the image surface by Z along its own z; may be repeated, or Z,Z...\n";

typedef struct spot_arguments {
    look_options look;
    bool centroid;
    double *defocus;                /* one after another */
    size_t defocuses, capacity;
} spot_arguments;

static void spot_take_defocus(spot_arguments *a)
{
    char *rest, *list = memory_text(optarg, strlen(optarg));
    for (char *word = strtok_r(list, ",", &rest); word; word = strtok_r(NULL, ",", &rest)) {
        a->defocus = memory_room(a->defocus, a->defocuses, &a->capacity, sizeof *a->defocus);
        a->defocus[a->defocuses] = options_number("defocus", word);
        if (!isfinite(a->defocus[a->defocuses++])) fail_usage("--defocus must be finite, not %s", word);
    }
    if (!a->defocuses) fail_usage("--defocus must be a length, not \"%s\"", optarg);
}

static spot_arguments spot_arguments_of(int argc, char *argv[])
{
    enum { REFERENCE = OPTION_AFTER_LOOK, DEFOCUS };
    static const struct option known[] = {
        {"reference", required_argument, NULL, REFERENCE}, {"defocus", required_argument, NULL, DEFOCUS},
        LOOK_OPTIONS, {0},
    };
    spot_arguments a = {.look.pattern = "--hexapolar 10"};
    for (int code; (code = getopt_long(argc, argv, LOOK_LETTERS, known, NULL)) != -1;) {
        if (code == DEFOCUS) {
            spot_take_defocus(&a);
        } else if (code == REFERENCE) {
            a.centroid = strcmp(optarg, "centroid") == 0;
            if (!a.centroid && strcmp(optarg, "chief") != 0)
                fail_usage("--reference must be chief or centroid, not \"%s\"", optarg);
        } else {
            look_take_option(&a.look, code, spot_help);
        }
    }
    look_take_lens(&a.look, argc, argv, "spot");
    return a;
}

/* The spots of a field on one image surface. */
typedef struct spot_panel {
    sgt_vec2 chief;        /* the end of the chief ray; NaN: it did not get there */
    sgt_vec2 way;          /* afocal: its angles from z of the last surface; else 0 */
    double chief_err;      /* a bound on what is off there */
    sgt_ends *ends;        /* [bands]; they last only if there is a picture */
    sgt_spot *of, all;     /* [bands], and together */
    double *sampling, sampling_all;
    look_fates *fates, fates_all;
} spot_panel;

typedef struct spot_work {
    const spot_arguments *asked;
    look look;
    launch_pattern points, coarse;
    sgt_ray_end **fine, **half; /* [bands]: rooms for points and coarse */
    table *table;
    size_t surfaces;       /* image surfaces: one, or each defocus */
    spot_panel *panel;     /* [fields * surfaces] */
} spot_work;

/* The elements with the last one moved along its own z. */
static sgt_element *spot_defocused(const look_band *b, double z)
{
    const size_t count = b->lens.count;
    sgt_element *e = memory_take(count, sizeof *e);
    memcpy(e, b->element, count * sizeof *e);
    job_move(&e[count - 1].pose, z);
    return e;
}

/* Rooms for the rays of each wavelength. */
static sgt_ray_end **spot_rooms(const look *l, const launch_pattern *points)
{
    sgt_ray_end **room = memory_take(l->bands, sizeof *room);
    for (size_t b = 0; b < l->bands; b++) room[b] = memory_take(points->count, sizeof *room[b]);
    return room;
}

/* Is distance from the chief ray asked for, and the chief ray is not there? */
static bool spot_lacks_reference(const spot_work *w, const spot_panel *p)
{
    return !w->asked->centroid && isnan(p->chief.x);
}

static void spot_note(const spot_work *w, size_t field, double z, const spot_panel *p)
{
    const size_t number = w->look.fields.number[field] + 1;
    if (spot_lacks_reference(w, p))
        note("field %zu%s: the chief ray does not get through, so there is no reference", number,
             w->asked->defocuses ? look_text(", defocus %g", z) : "");
}

/* Are its numbers angles, in milliradians? */
static bool spot_afocal(const look *l) { return l->primary.lens.of->afocal; }

/* In the unit of the picture. */
static double spot_small(const look *l, double x) { return spot_afocal(l) ? x : look_small(l, x); }

static const char *spot_unit(const look *l) { return spot_afocal(l) ? "mrad" : look_small_unit(l); }

/* A row for one wavelength leaves its weight out, which may be 0. */
static spot_panel spot_panel_of(spot_work *w, size_t field, double z)
{
    look *l = &w->look;
    const sgt_field_beam *beam = &l->beam[field];
    spot_panel p = {.ends = memory_take(l->bands, sizeof *p.ends), .of = memory_take(l->bands, sizeof *p.of),
                    .sampling = memory_take(l->bands, sizeof *p.sampling),
                    .fates = memory_take(l->bands, sizeof *p.fates)};
    sgt_ends *coarse = memory_take(l->bands, sizeof *coarse);
    const sgt_ray_end chief = look_chief(l, beam, &l->primary, spot_defocused(&l->primary, z));
    const bool afocal = spot_afocal(l);
    const sgt_vec3 axis = {0, 0, copysign(1, chief.d.z)};
    sgt_ray_end centre = chief, way = chief;
    if (afocal) sgt_ends_as_angles(&chief.d, 1, &chief, &centre), sgt_ends_as_angles(&axis, 1, &chief, &way);
    p.chief = (sgt_vec2){centre.p.x, centre.p.y}, p.chief_err = centre.p_err;
    if (afocal) p.way = (sgt_vec2){way.p.x, way.p.y};
    const sgt_vec2 *about = w->asked->centroid ? NULL : &p.chief;
    for (size_t b = 0; b < l->bands; b++) {
        const look_band *band = &l->band[b];
        const sgt_element *e = spot_defocused(band, z);
        const double weight = l->bands > 1 ? band->weight : 1;
        const sgt_ray_end *end = w->fine[b], *half = w->half[b];
        l->options = w->asked->defocuses ? look_text(" --defocus %.17g", z) : NULL;
        look_trace(l, beam, band, e, &w->points, true, w->fine[b]);
        look_trace(l, beam, band, e, &w->coarse, false, w->half[b]);
        if (afocal) sgt_ends_as_angles(&chief.d, w->points.count, end, w->fine[b]);
        if (afocal) sgt_ends_as_angles(&chief.d, w->coarse.count, half, w->half[b]);
        p.ends[b] = (sgt_ends){w->points.count, end, weight};
        coarse[b] = (sgt_ends){w->coarse.count, half, weight};
        p.of[b] = sgt_spot_of(1, &(sgt_ends){w->points.count, end, 1}, about);
        p.sampling[b] = p.of[b].rms - sgt_spot_of(1, &(sgt_ends){w->coarse.count, half, 1}, about).rms;
        for (size_t i = 0; i < w->points.count; i++)
            look_count(&p.fates[b], &end[i]), look_count(&p.fates_all, &end[i]);
    }
    p.all = sgt_spot_of(l->bands, p.ends, about);
    p.sampling_all = p.all.rms - sgt_spot_of(l->bands, coarse, about).rms;
    return p;
}

/* ------------------------------------------------------------------ table */

/* Of the image space. */
static double spot_index(const look_band *b)
{
    return b->lens.count > 1 ? b->lens.index[b->lens.count - 2] : b->lens.index_before;
}

static double spot_airy(const look *l, const look_band *b)
{
    if (spot_afocal(l)) /* 1.22 wavelength / (n diameter of the beam) */
        return 1e3 * sgt_airy_radius(b->lens.wavelength / l->um, 0.5 / (spot_index(b) * b->data.exit_radius));
    return sgt_airy_radius(b->lens.wavelength / l->um, b->data.f_number_working);
}

/* The wavelength of the Airy disc of a field: the primary one, or the only one that is traced. */
static const look_band *spot_airy_band(const look *l) { return l->bands == 1 ? &l->band[0] : &l->primary; }

/* band: NULL, all of them.  off: a bound on what is off in the reference. */
static void write_spot(const spot_work *w, size_t field, const look_band *band, const sgt_spot *s, double off,
                       double sampling, const look_fates *fates, double z, sgt_vec2 way)
{
    const look *l = &w->look;
    table *t = w->table;
    if (band) look_cells(t, l, field, band);
    else table_count(t, (long long)l->fields.number[field] + 1);
    if (!band && l->asked->shared.target.format == TABLE_NPY) table_empty(t); /* a NaN */
    else if (!band) table_word(t, "all");
    table_count(t, (long long)s->rays);
    table_count(t, (long long)s->passed);
    const double each[] = {s->reference.x + way.x, s->reference.y + way.y, s->rms, s->rms_x, s->rms_y,
                           isnan(s->rms) ? (double)NAN : s->geometric,
                           spot_airy(l, band ? band : spot_airy_band(l))};
    for (size_t i = 0; i < sizeof each / sizeof *each; i++) look_number(t, each[i]);
    table_count(t, look_digits(s->rms, s->error + off));
    look_number(t, sampling);
    look_fate_cells(t, l, fates);
    if (w->asked->defocuses) table_number(t, z);
}

static table *spot_table(const spot_work *w)
{
    static const column head[] = {
        {"field", COLUMN_COUNT},   {"wavelength", COLUMN_EXACT}, {"rays", COLUMN_COUNT},
        {"passed", COLUMN_COUNT},  {"x", COLUMN_NUMBER},         {"y", COLUMN_NUMBER},
        {"rms", COLUMN_NUMBER},    {"rms_x", COLUMN_NUMBER},     {"rms_y", COLUMN_NUMBER},
        {"geometric", COLUMN_NUMBER}, {"airy", COLUMN_NUMBER},   {"digits", COLUMN_COUNT},
        {"sampling", COLUMN_ERROR},
    };
    enum { COUNT = sizeof head / sizeof head[0] };
    column *columns = memory_take(COUNT + LOOK_FATES + 1, sizeof *columns);
    size_t n = COUNT;
    memcpy(columns, head, sizeof head);
    for (size_t i = 0; spot_afocal(&w->look) && i < COUNT; i++)
        if (i >= 4 && i != 11) columns[i].name = look_text("%s_mrad", head[i].name);
    n += look_fate_columns(&w->look, columns + n);
    if (w->asked->defocuses) columns[n++] = (column){"defocus", COLUMN_EXACT};
    return table_begin(&w->look.asked->shared.target, n, columns);
}

static void spot_rows(const spot_work *w, size_t field, size_t surface)
{
    const look *l = &w->look;
    const spot_panel *p = &w->panel[field * w->surfaces + surface];
    const double z = w->asked->defocuses ? w->asked->defocus[surface] : 0;
    const double off = w->asked->centroid ? 0 : p->chief_err;
    if (field + surface > 0) table_gap(w->table);
    for (size_t b = 0; b < l->bands; b++)
        write_spot(w, field, &l->band[b], &p->of[b], off, p->sampling[b], &p->fates[b], z, p->way);
    if (l->bands > 1 || l->asked->shared.target.format != TABLE_TEXT)
        write_spot(w, field, NULL, &p->all, off, p->sampling_all, &p->fates_all, z, p->way);
}

/* ---------------------------------------------------------------- picture */

/* The distances of the rays of a group from the reference. */
static chart_series spot_series(const look *l, const spot_panel *p, size_t b)
{
    const sgt_ends *g = &p->ends[b];
    double *x = memory_take(g->count, sizeof *x), *y = memory_take(g->count, sizeof *y);
    for (size_t i = 0; i < g->count; i++) {
        x[i] = spot_small(l, g->end[i].p.x - p->all.reference.x);
        y[i] = spot_small(l, g->end[i].p.y - p->all.reference.y);
    }
    return (chart_series){.name = look_wavelength_name(&l->band[b]),
                          .colour = look_colour(l, b),
                          .mark = (chart_mark)(CHART_DOT + look_colour(l, b) % 3),
                          .count = g->count,
                          .x = x,
                          .y = y};
}

static chart_panel spot_chart_panel(const spot_work *w, size_t field, size_t surface, double half)
{
    const look *l = &w->look;
    const spot_panel *p = &w->panel[field * w->surfaces + surface];
    chart_series *series = memory_take(l->bands, sizeof *series);
    for (size_t b = 0; b < l->bands; b++) series[b] = spot_series(l, p, b);
    const look_band *band = spot_airy_band(l);
    const double airy = spot_small(l, spot_airy(l, band));
    chart_circle *circle = memory_take(1, sizeof *circle);
    *circle = (chart_circle){.radius = airy,
                             .name = look_text("Airy disc, %.4g \302\265m", band->lens.wavelength)};
    const char **note = memory_take(2, sizeof *note);
    note[0] = spot_lacks_reference(w, p) ? "no reference"
              : isnan(p->all.rms)        ? "no ray passed"
                                         : look_text("RMS %.4g, largest %.4g %s", spot_small(l, p->all.rms),
                                                     spot_small(l, p->all.geometric), spot_unit(l));
    note[1] = look_fates_line(l, &p->fates_all);
    const char *name = look_field_name(l, field);
    if (w->asked->defocuses)
        name = look_text("%s, z %s%s%s%s", name, w->asked->defocus[surface] < 0 ? "" : "+",
                         look_signed(w->asked->defocus[surface]), *l->primary.lens.units ? " " : "",
                         l->primary.lens.units);
    return (chart_panel){.title = name, .x_label = look_text("x (%s)", spot_unit(l)),
                         .y_label = look_text("y (%s)", spot_unit(l)), .note = note, .notes = 2,
                         .square = true, .bar = true, .x_low = -half, .x_high = half, .y_low = -half,
                         .y_high = half, .series_count = l->bands, .series = series,
                         .circles = isnan(airy) ? 0U : 1U, .circle = circle};
}

static void draw_spots(const spot_work *w)
{
    const look *l = &w->look;
    const size_t panels = l->fields.count * w->surfaces;
    double half = 0;
    for (size_t i = 0; i < panels; i++) half = fmax(half, spot_small(l, w->panel[i].all.geometric));
    half = 1.05 * fmax(half, spot_small(l, spot_airy(l, spot_airy_band(l))));
    chart_panel *panel = memory_take(panels, sizeof *panel);
    for (size_t i = 0; i < panels; i++)
        panel[i] = spot_chart_panel(w, i / w->surfaces, i % w->surfaces, half);
    const char *line[] = {look_lens_line(l),
                          w->asked->centroid ? "about the centroid"
                                             : "about the chief ray of the primary wavelength",
                          look_fates_line(l, &l->fates)};
    chart_write(l->asked->picture,
                &(chart){.title = look_title(l, "spots"), .line = line, .lines = 3,
                         .columns = w->asked->defocuses ? w->surfaces : 0, .panels = panels, .panel = panel,
                         .same_x = true, .same_y = true});
}

exit_status command_spot(int argc, char *argv[])
{
    enum { RINGS = 10 };
    const spot_arguments a = spot_arguments_of(argc, argv);
    spot_work w = {.asked = &a, .points = job_points(&a.look.job, SGT_PATTERN_HEXAPOLAR, RINGS),
                   .surfaces = a.defocuses ? a.defocuses : 1};
    w.look = look_begin(&a.look);
    if (a.defocuses && spot_afocal(&w.look))
        note("--defocus: not used; the angles of an afocal lens are the same at each image surface");
    w.coarse = look_coarser(&w.look, &w.points);
    w.panel = memory_take(w.look.fields.count * w.surfaces, sizeof *w.panel);
    w.fine = spot_rooms(&w.look, &w.points), w.half = spot_rooms(&w.look, &w.coarse);
    w.table = spot_table(&w);
    for (size_t f = 0; f < w.look.fields.count; f++)
        for (size_t s = 0; s < w.surfaces; s++) {
            const double z = a.defocuses ? a.defocus[s] : 0;
            w.panel[f * w.surfaces + s] = spot_panel_of(&w, f, z);
            spot_note(&w, f, z, &w.panel[f * w.surfaces + s]);
            spot_rows(&w, f, s);
            if (a.look.picture) w.fine = spot_rooms(&w.look, &w.points);
        }
    const char *about = a.centroid ? "the centroid" : "the chief ray of the primary wavelength";
    if (spot_afocal(&w.look))
        table_line(w.table, "rms_mrad, geometric_mrad: angles about %s.  airy_mrad: radius.", about);
    else
        table_line(w.table, "rms, geometric: about %s.  airy: radius.  Unit of length: %s.", about,
                   *w.look.primary.lens.units ? w.look.primary.lens.units : "that of the lens");
    look_verdict(w.table, &w.look);
    table_end(w.table);
    if (a.look.picture) draw_spots(&w);
    return look_status(&w.look);
}
