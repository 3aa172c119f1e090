/* info.c - sagitta info: first-order data and Seidel sums of a lens. */
#include "commands.h"

#include "../base/memory.h"
#include "../job/options.h"
#include "../read/lens.h"
#include "../job/job.h"
#include "../job/launch.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

static const char info_help[] =
    "sagitta info LENS [options]\n"
    "\n"
    "Prints the first-order data of a lens, at its primary wavelength or those that are asked for;\n"
    "with --seidel its Seidel sums by surface.\n"
    "\n"
    "Paraxial rays go from vertex to vertex along the unfolded axis: tilts, decentres and breaks do\n"
    "not count.  The last surface is the image.  Lengths have the unit of the lens; - (text), nan (csv),\n"
    "null (json): there is none.\n"
    "\n"
    "Columns of csv and json, a row for each wavelength; rows of text\n"
    "  wavelength         micrometres\n"
    "  efl, efl_image     focal length 1/power, and |n'|/power in the image medium\n"
    "  ffd, bfd           from the first vertex to the front focus; from the last vertex before the\n"
    "                     image to the rear focus\n"
    "  focus, image       the rear focus, and the paraxial image, from the image surface\n"
    "  f_number           |efl| / diameter of the entrance pupil\n"
    "  working_f_number   1 / (2 n' u') of the marginal ray\n"
    "  magnification      of an object at a distance\n"
    "  entrance_pupil, entrance_radius\n"
    "                     from the first vertex; its semi-diameter\n"
    "  exit_pupil, exit_radius\n"
    "                     from the image surface; its semi-diameter\n"
    "  stop_radius        height of the marginal ray at the stop\n"
    "  front_principal, rear_principal, front_nodal, rear_nodal\n"
    "                     from the first vertex; from the image surface\n"
    "  image_height       paraxial, of the field that is farthest from the axis\n"
    "  lagrange           invariant n (u ybar - ubar y) of the marginal ray and that chief ray\n"
    "  petzval            radius of the Petzval surface\n"
    "\n"
    "With --parabasal a row for each field: the same along its real chief ray, which is aimed at the\n"
    "centre of the stop, in two sections, for folded, tilted and freeform lenses: efl_x, efl_y,\n"
    "focus_x, focus_y, image_x, image_y, magnification_x, magnification_y (distances along the ray,\n"
    "from the image surface), power_xy (not 0: the sections mix, and there is no such data).\n"
    "\n"
    "With --seidel a row for each surface, and their sum: spherical, coma, astigmatism, petzval,\n"
    "distortion (S1 to S5, wavefront, in lengths), axial, lateral (colour, over the lens's wavelengths).\n"
    "\n"
    "Options\n"
    "  --parabasal        along the real chief rays, at the first wavelength that is asked for\n"
    "  --seidel           the Seidel sums, at the first wavelength that is asked for\n"
    "  --wavelength W     as for sagitta trace: a number in the lens, micrometres, a spectral line, or\n"
    "                     all; may be repeated\n"
    "  --glass PATH       glasses of a catalogue (.agf, .yml, .csv) or a folder of them\n"
    "  --strict           what a reader leaves out, and a wavelength outside the range of a glass, are\n"
    "                     errors\n"
    "  --format F         text (for people, the default), csv or json\n"
    "  --hex              numbers in hexadecimal\n"
    "  --output FILE      write to FILE instead of standard output\n"
    "  --help, --version\n"
    "\n"
    "Exit status\n"
    "  0  done\n"
    "  2  wrong arguments\n"
    "  3  bad input, or output that cannot be written\n";

/* The quantities, in the order of the columns. */
static const struct { const char *name, *what; size_t offset; } quantity[] = {
#define QUANTITY(name, what) {#name, what, offsetof(sgt_first_order, name)}
    QUANTITY(wavelength, "micrometres"),
    QUANTITY(efl, "focal length, 1 / power"),
    QUANTITY(efl_image, "focal length in the image medium"),
    QUANTITY(ffd, "front focus, from the first vertex"),
    QUANTITY(bfd, "rear focus, from the last vertex before the image"),
    QUANTITY(focus, "rear focus, from the image surface"),
    QUANTITY(image, "paraxial image, from the image surface"),
    QUANTITY(f_number, "|efl| / diameter of the entrance pupil"),
    QUANTITY(working_f_number, "1 / (2 n' u') of the marginal ray"),
    QUANTITY(magnification, "of an object at a distance"),
    QUANTITY(entrance_pupil, "from the first vertex"),
    QUANTITY(entrance_radius, "its semi-diameter"),
    QUANTITY(exit_pupil, "from the image surface"),
    QUANTITY(exit_radius, "its semi-diameter"),
    QUANTITY(stop_radius, "height of the marginal ray at the stop"),
    QUANTITY(front_principal, "from the first vertex"),
    QUANTITY(rear_principal, "from the image surface"),
    QUANTITY(front_nodal, "from the first vertex"),
    QUANTITY(rear_nodal, "from the image surface"),
    QUANTITY(image_height, "of the outermost field"),
    QUANTITY(lagrange, "n (u ybar - ubar y)"),
    QUANTITY(petzval, "radius of the Petzval surface"),
#undef QUANTITY
};
enum { QUANTITIES = sizeof quantity / sizeof quantity[0], SEIDEL_COLUMNS = 9 };

static double value_of(const sgt_first_order *o, int k)
{
    double x;
    memcpy(&x, (const char *)o + quantity[k].offset, sizeof x);
    return x;
}

typedef struct info_arguments {
    table_target target;
    job_options job;
    bool seidel, parabasal;
} info_arguments;

static info_arguments info_arguments_of(int argc, char *argv[])
{
    enum { SEIDEL = OPTION_AFTER_JOB, PARABASAL };
    static const struct option known[] = {
        {"seidel", no_argument, NULL, SEIDEL}, {"parabasal", no_argument, NULL, PARABASAL},
        {"wavelength", required_argument, NULL, JOB_WAVELENGTH},
        {"glass", required_argument, NULL, JOB_GLASS},
        {"strict", no_argument, NULL, JOB_STRICT},
        {"format", required_argument, NULL, OPTION_FORMAT},
        {"output", required_argument, NULL, OPTION_OUTPUT},
        {"hex", no_argument, NULL, OPTION_HEX},
        {"help", no_argument, NULL, OPTION_HELP},
        {"version", no_argument, NULL, OPTION_VERSION},
        {0},
    };
    shared_options shared = {.threads = 0};
    info_arguments a = {.job = {.several = true}};
    for (int code; (code = getopt_long(argc, argv, "h", known, NULL)) != -1;) {
        if (code == 'h' || code == OPTION_HELP) print_and_end("%s", info_help);
        if (code == SEIDEL) a.seidel = true;
        else if (code == PARABASAL) a.parabasal = true;
        else if (!job_take(&a.job, code)) options_take(&shared, code, info_help);
    }
    if (optind == argc) fail_usage("the lens file is missing: sagitta info LENS");
    if (optind + 1 < argc)
        fail_usage("unexpected argument \"%s\"; info takes one lens file", argv[optind + 1]);
    a.job.lens = argv[optind];
    a.target = shared.target;
    return a;
}

static sgt_first_order first_order_at(const lens *l, sgt_seidel seidel[], const char **why_not)
{
    sgt_first_order o;
    sgt_lens_error e;
    if (!sgt_lens_first_order(l->of, l->wavelength, &o, seidel, why_not, &e)) lens_refuse(&e);
    return o;
}

/* csv and json: a row for each wavelength. */
static void write_by_columns(const info_arguments *a, const lens_list *at)
{
    column columns[QUANTITIES];
    for (int k = 0; k < QUANTITIES; k++) columns[k] = (column){quantity[k].name, COLUMN_EXACT};
    table *t = table_begin(&a->target, QUANTITIES, columns);
    for (size_t i = 0; i < at->count; i++) {
        sgt_first_order o = first_order_at(&at->lens[i], NULL, NULL);
        for (int k = 0; k < QUANTITIES; k++) table_number(t, value_of(&o, k));
    }
    table_end(t);
}

/* Text: a row for each quantity, a column for each wavelength. */
static void write_by_rows(const info_arguments *a, const lens_list *at)
{
    column *columns = memory_take(at->count + 2, sizeof *columns);
    sgt_first_order *o = memory_take(at->count, sizeof *o);
    columns[0] = (column){"quantity", COLUMN_WORD};
    for (size_t i = 0; i < at->count; i++) {
        o[i] = first_order_at(&at->lens[i], NULL, NULL);
        columns[i + 1] = (column){"value", COLUMN_NUMBER};
    }
    columns[at->count + 1] = (column){"is", COLUMN_WORD};
    table *t = table_begin(&a->target, at->count + 2, columns);
    for (int k = 0; k < QUANTITIES; k++) {
        table_word(t, quantity[k].name);
        for (size_t i = 0; i < at->count; i++) table_number(t, value_of(&o[i], k));
        table_word(t, quantity[k].what);
    }
    const sgt_lens *l = at->lens[0].of;
    table_line(t, "%s%s%zu surfaces, stop: surface %zu%s.  Unit of length: %.20s.", l->name,
               *l->name ? ": " : "", l->count, l->stop + 1, l->stop_marked ? "" : " (none is marked)",
               *l->units ? l->units : "that of the lens");
    table_end(t);
}

static void seidel_row(table *t, const char *surface, const char *type, const sgt_seidel *s)
{
    const double x[] = {s->spherical, s->coma, s->astigmatism, s->petzval, s->distortion, s->chromatic[0],
                        s->chromatic[1]};
    table_word(t, surface);
    table_word(t, type);
    for (int k = 0; k < 7; k++) table_number(t, x[k]);
}

static void write_seidel(const info_arguments *a, const lens *l)
{
    static const column columns[SEIDEL_COLUMNS] = {
        {"surface", COLUMN_WORD},      {"type", COLUMN_WORD},          {"spherical", COLUMN_NUMBER},
        {"coma", COLUMN_NUMBER},       {"astigmatism", COLUMN_NUMBER}, {"petzval", COLUMN_NUMBER},
        {"distortion", COLUMN_NUMBER}, {"axial", COLUMN_NUMBER},       {"lateral", COLUMN_NUMBER},
    };
    sgt_seidel *s = memory_take(l->count, sizeof *s), sum = {.spherical = 0};
    const char *why_not;
    first_order_at(l, s, &why_not);
    if (why_not) note("%s: no Seidel sums: %s", l->of->file, why_not);
    table *t = table_begin(&a->target, SEIDEL_COLUMNS, columns);
    for (size_t i = 0; i < l->count; i++) {
        char number[24];
        snprintf(number, sizeof number, "%zu", i + 1);
        seidel_row(t, number, l->surface[i].type, &s[i]);
        sum.spherical += s[i].spherical, sum.coma += s[i].coma, sum.astigmatism += s[i].astigmatism;
        sum.petzval += s[i].petzval, sum.distortion += s[i].distortion;
        for (int k = 0; k < 2; k++) sum.chromatic[k] += s[i].chromatic[k];
    }
    seidel_row(t, "sum", "", &sum);
    table_end(t);
}

/* What the numbers leave out. */
static void note_limits(const sgt_lens *l)
{
    bool tilted = false, sections = false;
    for (size_t i = 0; i < l->count; i++) {
        const sgt_pose *p = &l->element[i].pose;
        const char *type = l->surface[i].type;
        tilted = tilted || l->surface[i].off_axis || l->surface[i].folded || p->ex.x != 0 || p->ex.y != 0 ||
                 p->ex.z != 0 || p->origin.x != 0 || p->origin.y != 0;
        sections = sections || strcmp(type, "toroidal") == 0 || strcmp(type, "biconic") == 0 ||
                   strcmp(type, "cylinder") == 0;
    }
    if (tilted) note("%s: tilts, decentres and breaks do not count in these data", l->file);
    if (sections) note("%s: these data are of the y-z section; a surface is another in x-z", l->file);
    if (l->field_kind == SGT_FIELD_REAL_IMAGE_HEIGHT)
        note("%s: real image heights are taken as paraxial ones in these data", l->file);
}

/* A row for each field whose chief ray gets through. */
static void write_parabasal(const info_arguments *a, const lens *l)
{
    static const column columns[] = {
        {"field", COLUMN_COUNT},     {"efl_x", COLUMN_NUMBER},           {"efl_y", COLUMN_NUMBER},
        {"focus_x", COLUMN_NUMBER},  {"focus_y", COLUMN_NUMBER},         {"image_x", COLUMN_NUMBER},
        {"image_y", COLUMN_NUMBER},  {"magnification_x", COLUMN_NUMBER}, {"magnification_y", COLUMN_NUMBER},
        {"power_xy", COLUMN_NUMBER},
    };
    launch_how how = launch_by(l, l->of->telecentric ? LAUNCH_AT_PUPIL : LAUNCH_AT_STOP);
    const launch_pattern middle = launch_points(SGT_PATTERN_FAN, 1, 0);
    sgt_element *open = memory_take(l->count, sizeof *open);
    for (size_t i = 0; i < l->count; i++) {
        open[i] = l->element[i];
        open[i].semi_diameter = 0, open[i].aperture = NULL;
    }
    sgt_passage *passage = memory_take(l->count, sizeof *passage);
    table *t = table_begin(&a->target, sizeof columns / sizeof columns[0], columns);
    for (size_t f = 0; f < l->of->fields; f++) {
        ray_list chief = {.count = 0};
        launch_field(&chief, &how, l, f, l->of->field_kind, l->of->field[f], &middle);
        sgt_parabasal p = {.efl = {(double)NAN, (double)NAN}};
        bool fine = false;
        if (chief.count) {
            sgt_ray ray = chief.ray[0].ray;
            sgt_trace(l->count, open, l->index_before, &ray, passage, NULL, NULL);
            fine = sgt_lens_parabasal(l->count, open, l->index_before, isfinite(l->of->object_distance),
                                      &chief.ray[0].ray, passage, &p);
        }
        if (!fine)
            note("field %zu: its chief ray does not get through, or a surface has no second derivatives",
                 f + 1);
        const double mixed = fmax(fabs(p.power[0][1]), fabs(p.power[1][0]));
        const double x[] = {p.efl[0],   p.efl[1],           p.focus[0],         p.focus[1], p.image[0],
                            p.image[1], p.magnification[0], p.magnification[1], mixed};
        table_count(t, (long long)f + 1);
        for (int k = 0; k < 9; k++) table_number(t, fine ? x[k] : (double)NAN);
    }
    table_end(t);
}

exit_status command_info(int argc, char *argv[])
{
    info_arguments a = info_arguments_of(argc, argv);
    lens_list at = job_lenses(&a.job);
    if (!a.parabasal) note_limits(at.lens[0].of);
    if (a.seidel && a.parabasal) fail_usage("give --seidel or --parabasal, not both");
    if (a.seidel) write_seidel(&a, &at.lens[0]);
    else if (a.parabasal) write_parabasal(&a, &at.lens[0]);
    else if (a.target.format == TABLE_TEXT) write_by_rows(&a, &at);
    else write_by_columns(&a, &at);
    return EXIT_DECIDED;
}
