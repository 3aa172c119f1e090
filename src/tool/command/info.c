// SPDX-License-Identifier: MIT
/* info.c - sagitta info: first-order data and Seidel sums of a lens, as text and csv; json is that of
 * info_json.c. */
#include "commands.h"

#include "info.h"

#include "../base/memory.h"
#include "../job/options.h"
#include "../read/lens.h"

#include <math.h>
#include <sagitta/analysis.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

/* The quantities in the order of csv: the name, as in json, what it is, and what is lacking if it is not
 * there. */
typedef enum lack { POWER, OBJECT, PUPIL, SIZE, CURVE, WAVELENGTH } lack;
static const struct { const char *name, *what; lack needs; size_t offset; } quantity[] = {
#define QUANTITY(member, name, what, needs) {name, what, needs, offsetof(sgt_first_order, member)}
    QUANTITY(wavelength, "wavelength", "micrometres", WAVELENGTH),
    QUANTITY(efl, "efl", "focal length, 1 / power", POWER),
    QUANTITY(efl_image, "efl_image", "focal length in the image medium", POWER),
    QUANTITY(ffd, "ffd", "front focus, from the first vertex", POWER),
    QUANTITY(bfd, "bfd", "rear focus, from the last vertex before the image", POWER),
    QUANTITY(focus, "focus", "rear focus, from the image surface", POWER),
    QUANTITY(image, "image", "paraxial image, from the image surface", POWER),
    QUANTITY(f_number, "f_number", "|efl| / diameter of the entrance pupil", SIZE),
    {"f_number_working", "1 / (2 n' u') of the marginal ray", SIZE,
     offsetof(sgt_first_order, f_number_working)},
    QUANTITY(magnification, "magnification", "of the object", OBJECT),
    QUANTITY(entrance_pupil, "entrance_pupil.z", "from the first vertex", PUPIL),
    QUANTITY(entrance_radius, "entrance_pupil.radius", "semi-diameter of the entrance pupil", SIZE),
    QUANTITY(exit_pupil, "exit_pupil.z", "from the image surface", PUPIL),
    QUANTITY(exit_radius, "exit_pupil.radius", "semi-diameter of the exit pupil", SIZE),
    QUANTITY(stop_radius, "stop_radius", "height of the marginal ray at the stop", SIZE),
    QUANTITY(front_principal, "front_principal", "front principal point, from the first vertex", POWER),
    QUANTITY(rear_principal, "rear_principal", "rear principal point, from the image surface", POWER),
    QUANTITY(front_nodal, "front_nodal", "front nodal point, from the first vertex", POWER),
    QUANTITY(rear_nodal, "rear_nodal", "rear nodal point, from the image surface", POWER),
    QUANTITY(image_height, "image_height", "paraxial, of the field farthest from the axis", POWER),
    QUANTITY(lagrange, "lagrange", "invariant n (u ybar - ubar y) of marginal and chief ray", SIZE),
    {"petzval_radius", "radius of the Petzval surface", CURVE,
     offsetof(sgt_first_order, petzval_radius)},
    QUANTITY(angular_magnification, "angular_magnification", "slope of the chief ray behind by that in front",
             PUPIL),
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

static const option_row info_rows[] = {
    {"seidel", NULL, "the Seidel sums, at the first wavelength that is asked for", OPTION_FLAG,
     .to = offsetof(info_arguments, seidel)},
    {"parabasal", NULL, "along the real chief rays, at the first wavelength that is asked for", OPTION_FLAG,
     .to = offsetof(info_arguments, parabasal)},
    {0},
};
static const option_group info_own = {OPTIONS_OWN, "Options", .row = info_rows};

static exit_status info_run(const command *c, int argc, char *argv[]);

static const char info_all[] =
    "Paraxial rays go from vertex to vertex along the unfolded axis: tilts, decentres and breaks do\n"
    "not count.  Surfaces count from 1; the last is the image.  Lengths have the unit of the lens.\n"
    "- (text), nan (csv), null (json): there is none.\n"
    "\n"
    "Quantities, as text and json name them\n"
    "  wavelength         micrometres\n"
    "  efl, efl_image     focal length 1/power, and |n'|/power in the image medium\n"
    "  ffd, bfd           from the first vertex to the front focus; from the last vertex before the\n"
    "                     image to the rear focus\n"
    "  focus, image       the rear focus, and the paraxial image, from the image surface\n"
    "  f_number           |efl| / diameter of the entrance pupil\n"
    "  f_number_working   1 / (2 n' u') of the marginal ray\n"
    "  magnification      of an object at a distance; none for one at infinity\n"
    "  entrance_pupil     z, from the first vertex; radius, its semi-diameter\n"
    "  exit_pupil         z, from the image surface; radius\n"
    "  stop_radius        height of the marginal ray at the stop\n"
    "  front_principal, rear_principal, front_nodal, rear_nodal\n"
    "                     from the first vertex; from the image surface\n"
    "  image_height       of the paraxial image, from the axis, never negative.  Text, csv: of the field\n"
    "                     that is farthest from the axis; json: a list, one for each field\n"
    "  lagrange           invariant n (u ybar - ubar y) of the marginal ray and that chief ray\n"
    "  petzval_radius     radius of the Petzval surface\n"
    "\n"
    "csv has a row for each wavelength.  There the pupils are entrance_pupil.z, entrance_pupil.radius,\n"
    "exit_pupil.z, exit_pupil.radius, as in text.\n"
    "\n"
    "json is one object; with --wavelength all, or several, a list of them.  Beside the quantities it\n"
    "has name, units, fields ({x, y, kind, weight}), wavelengths, surfaces (how many), stop (which),\n"
    "seidel (by surface), seidel_sum, and parabasal: {fields: [...]}, an object for each field.  If\n"
    "seidel or parabasal is null, seidel_why_not or parabasal_why_not says why.\n"
    "\n"
    "With --parabasal a row for each field: the same along its real chief ray, which is aimed at the\n"
    "centre of the stop, in two sections, for folded, tilted and freeform lenses: efl_x, efl_y,\n"
    "focus_x, focus_y, image_x, image_y, magnification_x, magnification_y (distances along the ray,\n"
    "from the image surface), power_xy (not 0: the sections mix, and there is no such data).\n"
    "\n"
    "With --seidel a row for each surface, and their sum: spherical, coma, astigmatism, petzval,\n"
    "distortion (S1 to S5, wavefront, in lengths), axial, lateral (colour, over the lens's wavelengths).\n";

const command command_info = {
    .name = "info", .usage = "LENS [options]", .brief = "focal length, pupils, Seidel sums",
    .what = "Prints the first-order data of a lens, at its primary wavelength or those that are asked "
            "for; with --seidel its Seidel sums by surface, with --parabasal data along its real chief "
            "rays.  json has all.",
    .often = "seidel parabasal configuration wavelength glass strict format output hex",
    .examples = "  sagitta info examples/lenses/cooke_triplet.yaml\n"
                "  sagitta info examples/lenses/cooke_triplet.yaml --seidel --format csv\n",
    .docs = "docs/rays.md (what the numbers are)", .all = info_all, .exits = "  0  done\n"
             "  2  wrong arguments\n"
             "  3  bad input, or output that cannot be written\n",
    .group = {&info_own, &job_wavelength_options, &job_glass_options, &options_output}, .run = info_run,
};

static info_arguments info_arguments_of(const command *c, int argc, char *argv[])
{
    shared_options shared = {.threads = 0};
    info_arguments a = {.job = {.several = true}};
    command_read(c, &a, &a.job, &shared, argc, argv);
    a.job.lens = command_file(c, "lens file", argc, argv);
    a.target = shared.target;
    return a;
}

sgt_first_order info_first_order(const lens *l, sgt_seidel seidel[])
{
    sgt_first_order o;
    sgt_error e;
    if (!sgt_lens_first_order(l->of, l->wavelength, &o, seidel, &e)) lens_refuse(&e);
    return o;
}

/* csv: a row for each wavelength. */
static void write_by_columns(const info_arguments *a, const lens_list *at)
{
    column columns[QUANTITIES];
    for (int k = 0; k < QUANTITIES; k++) columns[k] = (column){quantity[k].name, COLUMN_EXACT};
    table *t = table_begin(&a->target, QUANTITIES, columns);
    for (size_t i = 0; i < at->count; i++) {
        table_lead(t, at->lens[i].configuration);
        sgt_first_order o = info_first_order(&at->lens[i], NULL);
        for (int k = 0; k < QUANTITIES; k++) table_number(t, value_of(&o, k));
    }
    table_end(t);
}

/* Why a quantity is not there. */
static const char *why_none(const sgt_lens *l, const sgt_first_order *o, lack of)
{
    if (of == WAVELENGTH) return "none: the lens gives no wavelengths";
    if (of == OBJECT && !isfinite(l->object_distance)) return "none: the object is at infinity";
    if (of == PUPIL && l->telecentric) return "none: at infinity, the lens is telecentric";
    if (isnan(o->power)) return "none: the power of the lens is not known";
    if (of == PUPIL && l->stop == l->count - 1) return "none: the stop is the image surface";
    if (of == PUPIL) return "none: at infinity";
    if (of == CURVE) return "none: it is flat";
    if (of == SIZE && isnan(o->entrance_radius))
        return l->telecentric              ? "none: the entrance pupil is at infinity"
               : l->pupil == SGT_PUPIL_NONE ? "none: the lens gives no size of its pupil"
                                            : "none: the pupil has no size";
    if (o->power == 0) return "none: the lens is afocal, it has no power";
    return "none: at infinity";
}

/* A sentence about the lens, under its table. */
static void say_lens(table *t, const sgt_lens *l, const sgt_first_order *o)
{
    static const char *const kinds[] = {[SGT_FIELD_ANGLE] = "by angle, in degrees",
                                        [SGT_FIELD_OBJECT_HEIGHT] = "by object height",
                                        [SGT_FIELD_PARAXIAL_IMAGE_HEIGHT] = "by paraxial image height",
                                        [SGT_FIELD_REAL_IMAGE_HEIGHT] = "by real image height"};
    char object[100] = "infinity";
    const sgt_vec2 tilt = l->object_slope;
    if (isfinite(l->object_distance) && (tilt.x != 0 || tilt.y != 0))
        snprintf(object, sizeof object, "%.9g in front of the first surface, tilted by slopes %.6g, %.6g",
                 l->object_distance, tilt.x, tilt.y);
    else if (isfinite(l->object_distance))
        snprintf(object, sizeof object, "%.9g in front of the first surface", l->object_distance);
    table_line(t, "%s%s%zu surface%s, stop: surface %zu%s.  Unit of length: %.20s.", l->name,
               *l->name ? ": " : "", l->count, l->count == 1 ? "" : "s", l->stop + 1,
               l->stop_marked ? "" : " (none is marked)",
               *l->units ? l->units : "that of the lens");
    table_line(t, "Object: at %s.  %zu field%s %s.", object, l->fields, l->fields == 1 ? "" : "s",
               kinds[l->field_kind]);
    if (l->afocal)
        table_line(t, "Afocal: light leaves as parallel rays.  spot, fan and field answer in angles, opd "
                      "compares with a plane.");
    const char *primary = lens_primary(l);
    if (primary) table_line(t, "%s", primary);
    const size_t many = sgt_lens_configurations(l);
    const char *names = "";
    for (size_t i = 1; i <= many; i++) {
        const char *name = sgt_lens_configuration_name(l, i);
        names = memory_print("%s%s%zu%s%s", names, i > 1 ? ", " : "", i, *name ? " " : "", name);
    }
    if (many)
        table_line(t, "These are the values of the file itself.  Configurations: %s; --configuration all "
                      "shows them.", names);
    if (o->without_vertex)
        table_line(t, "Surface %zu stands off the axis, or has no curvature at its vertex: the power is not "
                      "known.  Try --parabasal.", o->without_vertex);
}

/* Text: a row for each quantity, a column for each wavelength, of each configuration where all are shown. */
static void write_by_rows(const info_arguments *a, const lens_list *at, const lens_each *all)
{
    column *columns = memory_take(at->count + 2, sizeof *columns);
    sgt_first_order *o = memory_take(at->count, sizeof *o);
    columns[0] = (column){"quantity", COLUMN_WORD};
    for (size_t i = 0; i < at->count; i++) {
        o[i] = info_first_order(&at->lens[i], NULL);
        const lens *one = &at->lens[i];
        columns[i + 1] = (column){!one->configuration         ? "value"
                                  : *one->configuration_name ? one->configuration_name
                                                             : memory_print("%zu", one->configuration),
                                  COLUMN_NUMBER};
    }
    columns[at->count + 1] = (column){"is", COLUMN_WORD};
    const sgt_lens *l = at->lens[0].of;
    table_target target = a->target;
    target.leads = false; /* each has its own column */
    table *t = table_begin(&target, at->count + 2, columns);
    for (int k = 0; k < QUANTITIES; k++) {
        bool there = false;
        table_word(t, quantity[k].name);
        for (size_t i = 0; i < at->count; i++) {
            table_number(t, value_of(&o[i], k));
            there = there || !isnan(value_of(&o[i], k));
        }
        table_word(t, there ? quantity[k].what : why_none(l, &o[0], quantity[k].needs));
    }
    if (all->count) table_line(t, "%s  Below, the first of them.", lens_each_line(all));
    say_lens(t, l, &o[0]);
    table_end(t);
}

sgt_seidel info_seidel_sum(const lens *l, const sgt_seidel s[])
{
    sgt_seidel sum = {.spherical = 0};
    for (size_t i = 0; i < l->count; i++) {
        sum.spherical += s[i].spherical, sum.coma += s[i].coma, sum.astigmatism += s[i].astigmatism;
        sum.petzval += s[i].petzval, sum.distortion += s[i].distortion;
        for (int k = 0; k < 2; k++) sum.chromatic[k] += s[i].chromatic[k];
    }
    return sum;
}

static void seidel_row(table *t, const char *surface, const char *type, const sgt_seidel *s)
{
    const double x[] = {s->spherical, s->coma, s->astigmatism, s->petzval, s->distortion, s->chromatic[0],
                        s->chromatic[1]};
    table_word(t, surface);
    table_word(t, type);
    for (int k = 0; k < 7; k++) table_number(t, x[k]);
}

/* " at 0.55 micrometres, lengths in mm": for the line over a table. */
static const char *conditions(const lens *l)
{
    static char text[100];
    char at[50] = "";
    if (!isnan(l->wavelength)) snprintf(at, sizeof at, " at %.9g micrometres", l->wavelength);
    snprintf(text, sizeof text, "%s, lengths in %.20s", at, *l->units ? l->units : "the unit of the lens");
    return text;
}

/* The line over the Seidel sums. */
static void say_sums(table *t, const lens *l)
{
    double least = HUGE_VAL, most = 0;
    char colour[100] = "0, the lens has one wavelength";
    for (size_t i = 0; l->of->wavelength && i < l->of->wavelengths; i++)
        least = fmin(least, l->of->wavelength[i]), most = fmax(most, l->of->wavelength[i]);
    if (!l->of->wavelength) snprintf(colour, sizeof colour, "0, the lens gives no wavelengths");
    if (most > least) snprintf(colour, sizeof colour, "from %.9g to %.9g micrometres", least, most);
    table_line(t, "Seidel sums (wavefront)%s.  Axial and lateral colour: %s.", conditions(l), colour);
}

/* Is it the first wavelength of a configuration? */
static bool is_first(const lens_list *at, size_t i)
{
    return i == 0 || at->lens[i].configuration != at->lens[i - 1].configuration;
}

/* The line over the rows of a configuration. */
static void say_configuration(table *t, const lens *l)
{
    const char *name = l->configuration ? l->configuration_name : "";
    table_lead(t, l->configuration);
    if (l->configuration) table_line(t, "Configuration %zu%s%s.", l->configuration, *name ? ", " : "", name);
}

static void write_sums(table *t, const lens *l)
{
    sgt_seidel *s = memory_take(l->count, sizeof *s);
    const char *without = info_first_order(l, s).without_seidel;
    if (without) note("%s: no Seidel sums: %s", l->of->file, without);
    say_configuration(t, l);
    say_sums(t, l);
    for (size_t i = 0; i < l->count; i++) {
        char number[24];
        snprintf(number, sizeof number, "%zu", i + 1);
        seidel_row(t, number, l->surface[i].type, &s[i]);
    }
    const sgt_seidel sum = info_seidel_sum(l, s);
    seidel_row(t, "sum", "", &sum);
}

static void write_seidel(const info_arguments *a, const lens_list *at)
{
    static const column columns[SEIDEL_COLUMNS] = {
        {"surface", COLUMN_WORD},      {"type", COLUMN_WORD},          {"spherical", COLUMN_NUMBER},
        {"coma", COLUMN_NUMBER},       {"astigmatism", COLUMN_NUMBER}, {"petzval", COLUMN_NUMBER},
        {"distortion", COLUMN_NUMBER}, {"axial", COLUMN_NUMBER},       {"lateral", COLUMN_NUMBER},
    };
    table *t = table_begin(&a->target, SEIDEL_COLUMNS, columns);
    for (size_t i = 0; i < at->count; i++)
        if (is_first(at, i)) write_sums(t, &at->lens[i]);
    table_end(t);
}

/* Each kind of field is proportional to its image height: that of the farthest is known. */
double *info_image_heights(const lens *l, const sgt_first_order *o)
{
    static const double radian = 0.017453292519943295; /* pi / 180 */
    double *height = memory_take(l->of->fields, sizeof *height), most = 0;
    for (size_t i = 0; i < l->of->fields; i++) {
        double x = l->of->field[i].x, y = l->of->field[i].y;
        if (l->of->field_kind == SGT_FIELD_ANGLE) x = tan(x * radian), y = tan(y * radian);
        height[i] = hypot(x, y), most = fmax(most, height[i]);
    }
    for (size_t i = 0; i < l->of->fields; i++)
        height[i] = most > 0 ? height[i] / most * o->image_height : o->image_height;
    return height;
}

/* What the numbers leave out. */
static void note_limits(const sgt_lens *l)
{
    lens_note_image(l);
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

/* ------------------------------------------------------------- chief rays */

/* "FILE:LINE: key: words" */
static const char *fault_of(const sgt_error *e)
{
    const char *words = memory_print("%s%s%s", e->key, *e->key ? ": " : "", e->words);
    return !*e->file ? words
           : e->line ? memory_print("%s:%zu: %s", e->file, e->line, words)
                     : memory_print("%s: %s", e->file, words);
}

info_chief *info_chiefs(const lens *l)
{
    info_chief *out = memory_take(l->of->fields, sizeof *out);
    for (size_t f = 0; f < l->of->fields; f++) {
        sgt_error e;
        const bool known = sgt_field_parabasal(l->of, l->wavelength, f + 1, &out[f].of, &e);
        out[f].why_not = known ? NULL : fault_of(&e);
    }
    return out;
}

/* A row for each field. */
static void write_chiefs(table *t, const lens *l)
{
    const info_chief *chief = info_chiefs(l);
    say_configuration(t, l);
    table_line(t, "Along the real chief ray of each field%s.", conditions(l));
    for (size_t f = 0; f < l->of->fields; f++) {
        const sgt_parabasal *p = &chief[f].of;
        if (chief[f].why_not) note("field %zu: %s", f + 1, chief[f].why_not);
        table_count(t, (long long)f + 1);
        for (int k = 0; k < 2; k++) table_number(t, p->efl[k]);
        for (int k = 0; k < 2; k++) table_number(t, p->focus[k]);
        for (int k = 0; k < 2; k++) table_number(t, p->image[k]);
        for (int k = 0; k < 2; k++) table_number(t, p->magnification[k]);
        table_number(t, p->power_xy);
    }
}

static void write_parabasal(const info_arguments *a, const lens_list *at)
{
    static const column columns[] = {
        {"field", COLUMN_COUNT},     {"efl_x", COLUMN_NUMBER},           {"efl_y", COLUMN_NUMBER},
        {"focus_x", COLUMN_NUMBER},  {"focus_y", COLUMN_NUMBER},         {"image_x", COLUMN_NUMBER},
        {"image_y", COLUMN_NUMBER},  {"magnification_x", COLUMN_NUMBER}, {"magnification_y", COLUMN_NUMBER},
        {"power_xy", COLUMN_NUMBER},
    };
    table *t = table_begin(&a->target, sizeof columns / sizeof columns[0], columns);
    for (size_t i = 0; i < at->count; i++)
        if (is_first(at, i)) write_chiefs(t, &at->lens[i]);
    table_end(t);
}

static exit_status info_run(const command *c, int argc, char *argv[])
{
    info_arguments a = info_arguments_of(c, argc, argv);
    if (a.seidel && a.parabasal) fail_usage("give --seidel or --parabasal, not both");
    lens_each all;
    lens_list at = job_lenses_of_each(&a.job, &all);
    a.target.leads = all.count;
    const bool json = a.target.format == TABLE_JSON;
    if ((json || !a.parabasal) && !lens_quiet()) note_limits(at.lens[0].of);
    if (json) info_json(&a.target, &at, a.job.all_wavelengths || a.job.wavelengths > 1 || all.count);
    else if (a.seidel) write_seidel(&a, &at);
    else if (a.parabasal) write_parabasal(&a, &at);
    else if (a.target.format == TABLE_TEXT) write_by_rows(&a, &at, &all);
    else write_by_columns(&a, &at);
    return EXIT_DECIDED;
}
