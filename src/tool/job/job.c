// SPDX-License-Identifier: MIT
/* job.c - a lens and the rays to send through it. */
#include "job.h"

#include "../show/frame.h"
#include "../base/memory.h"

#include <limits.h>
#include <math.h>
#include <sagitta/lens.h>
#include <stdio.h>
#include <string.h>

/* Of random rays: as many as a double counts (their weight is 1 / N).  Sobol's numbers have 32 bits, and
 * begin again after 3.37e9 points.  The others are rows of points or nets, which nobody wants longer. */
#define RANDOM_MOST (long)(LONG_MAX < INT64_C(1000000000000000) ? LONG_MAX : INT64_C(1000000000000000))
#define SOBOL_MOST (long)(LONG_MAX < INT64_C(3000000000) ? LONG_MAX : INT64_C(3000000000))
enum { RAYS_MOST = 1000000000, SIDE_MOST = 30000, FAN_DEFAULT = 5 };

static const double NANOMETRES = 100; /* um: light so long is rarer than a slip of the unit */
static const char LINES[] = "i h g F' F e d D C' C r s t";

static lens_wavelength wavelength_of(const char *text)
{
    double um = sgt_spectral_line(text);
    if (!isnan(um)) return (lens_wavelength){.um = um};
    if (!strchr(text, '.')) {
        if (!strpbrk(text, "0123456789"))
            fail_usage(
                "--wavelength must be a whole number, micrometres with a point, a spectral line (%s), or "
                "all, not \"%s\"",
                LINES, text);
        return (lens_wavelength){.place = (size_t)options_integer("wavelength", text, 1, INT_MAX)};
    }
    um = options_number("wavelength", text);
    if (!(um > 0)) fail_usage("--wavelength must be positive, not %s micrometres", text);
    if (um >= NANOMETRES)
        fail_usage("--wavelength %s would be micrometres; for %g nanometres write %g", text, um, um / 1000);
    return (lens_wavelength){.um = um};
}

/* The next part of a list with commas; NULL: there is none. */
static char *next_word(char **rest)
{
    char *word = *rest, *comma = word ? strchr(word, ',') : NULL;
    if (comma) *comma = 0;
    *rest = comma ? comma + 1 : NULL;
    return word;
}

static void take_wavelength(void *into, const option_row *row, const char *value)
{
    job_options *o = into;
    (void)row;
    if (strcmp(value, "all") == 0) {
        o->all_wavelengths = true;
        return;
    }
    for (char *rest = memory_text(value, strlen(value)), *word; (word = next_word(&rest));) {
        o->wavelength = memory_room(o->wavelength, o->wavelengths, &o->wavelength_capacity,
                                    sizeof *o->wavelength);
        o->wavelength[o->wavelengths++] = wavelength_of(word);
    }
}

/* --fan N and its like; `least` of the row is the pattern, `most` the greatest N. */
static void take_points(void *into, const option_row *row, const char *value)
{
    job_options *o = into;
    if (o->points)
        fail_usage("give one of --fan, --grid, --hexapolar, --random, --sobol, --cells, --cross");
    o->pattern = (sgt_pattern)row->least;
    o->points = options_integer(row->name, value, 1, row->most);
}

static void take_seed(void *into, const option_row *row, const char *value)
{
    ((job_options *)into)->seed = options_integer(row->name, value, 1, LONG_MAX);
}

/* Of --chief, which has no value, too. */
static void take_pupil(void *into, const option_row *row, const char *value)
{
    job_options *o = into;
    double x = 0, y = 0;
    char more;
    if (row->value &&
        (sscanf(value, "%lf %lf %c", &x, &y, &more) != 2 || !(fabs(x) <= 100) || !(fabs(y) <= 100)))
        fail_usage("--pupil must be two numbers, \"PX PY\", in radii of the pupil, not \"%s\"", value);
    o->pupil = memory_room(o->pupil, o->pupils, &o->pupil_capacity, sizeof *o->pupil);
    o->pupil[o->pupils++] = (sgt_pupil_point){x, y, 1};
}

static void take_fields(void *into, const option_row *row, const char *value)
{
    job_options *o = into;
    if (strcmp(value, "all") == 0) {
        o->all_fields = true; /* the default, but for sagitta prove */
        return;
    }
    for (char *rest = memory_text(value, strlen(value)), *word; (word = next_word(&rest));) {
        o->number = memory_room(o->number, o->numbers, &o->number_capacity, sizeof *o->number);
        o->number[o->numbers++] = (size_t)options_integer(row->name, word, 1, INT_MAX) - 1;
    }
}

static void add_field(job_options *o, sgt_lens_field f)
{
    o->field = memory_room(o->field, o->fields, &o->capacity, sizeof *o->field);
    o->field[o->fields++] = f;
}

static void take_field(void *into, const option_row *row, const char *value)
{
    job_options *o = into;
    if (strcmp(value, "all") == 0) fail_usage("--field all is now --fields all, the default");
    if (strchr(value, ','))
        fail_usage("--field takes one angle, not %s; for several angles repeat --field", value);
    if (o->field_at) fail_usage("give --field or --field-at, not both");
    const double angle = options_number(row->name, value);
    if (!(fabs(angle) < 90)) fail_usage("--field must be between -90 and 90 degrees, not %s", value);
    add_field(o, (sgt_lens_field){.y = angle, .weight = 1});
}

static const char *const kinds[] = {[SGT_FIELD_ANGLE] = "angle",
                                    [SGT_FIELD_OBJECT_HEIGHT] = "object_height",
                                    [SGT_FIELD_PARAXIAL_IMAGE_HEIGHT] = "paraxial_image_height",
                                    [SGT_FIELD_REAL_IMAGE_HEIGHT] = "real_image_height"};
enum { KINDS = sizeof kinds / sizeof kinds[0] };

const char *job_field_kind(sgt_field_kind kind) { return kinds[kind]; }

static void take_field_at(void *into, const option_row *row, const char *value)
{
    job_options *o = into;
    sgt_lens_field f = {.weight = 1};
    char kind[40] = "", more;
    const int n = sscanf(value, "%lf %lf %39s %c", &f.x, &f.y, kind, &more);
    size_t k = 0;
    (void)row;
    while (k < KINDS && strcmp(kind, kinds[k]) != 0) k++;
    if (n < 2 || n > 3 || !isfinite(f.x) || !isfinite(f.y) || (n == 3 && k == KINDS))
        fail_usage("--field-at must be \"X Y\" or \"X Y KIND\", KIND angle, object_height, "
                   "paraxial_image_height or real_image_height, not \"%s\"", value);
    const char *own = n == 3 ? kinds[k] : NULL;
    if (o->fields && (!o->field_at || own != o->field_kind))
        fail_usage("give --field, or --field-at with the same KIND each time");
    o->field_at = true, o->field_kind = own;
    add_field(o, f);
}

/* Options that a command which repeats the rays has to be given, too: they are noted, then taken. */
static void take_again(void *into, const option_row *row, const char *value)
{
    job_options *o = into;
    const char *before = o->again ? o->again : "";
    const size_t size = strlen(before) + strlen(row->name) + (value ? strlen(value) : 0) + 8;
    char *all = memory_take(size, 1);
    const char *quote = value && strchr(value, '"') ? "'" : "\"";
    if (value) snprintf(all, size, "%s --%s %s%s%s", before, row->name, quote, value, quote);
    else snprintf(all, size, "%s --%s", before, row->name);
    o->again = all;
    if (strcmp(row->name, "aim") == 0) o->aim_given = true, o->aimed = options_word(row, value);
    else if (strcmp(row->name, "glass") == 0) lens_glass_folder(value);
    else if (strcmp(row->name, "strict") == 0) lens_be_strict();
    else if (strcmp(row->name, "configuration") == 0) lens_configuration(value);
    else if (strcmp(row->name, "set") == 0) lens_edit_value(SGT_EDIT_SET_TEXT, row->name, value);
    else o->no_apertures = true;
}

#define POINTS(name, pattern, most, help) \
    {name, "N", help, OPTION_TAKE, 0, pattern, most, .take = take_points}

static const option_row field_rows[] = {
    {"field", "DEG",
     "angle of a field in the y-z plane, in degrees.  May be repeated\n"
     "The chief ray of a positive field climbs toward +y",
     OPTION_TAKE, .take = take_field},
    {"field-at", "\"X Y K\"",
     "a field: two numbers, as `fields` of a lens file has them\n"
     "K is angle, object_height, paraxial_image_height or real_image_height; left out: as the\n"
     "lens has it.  May be repeated, with the same K",
     OPTION_TAKE, .take = take_field_at},
    {"fields", "LIST", "fields of the lens by their numbers, counted from 1: 1,3.  Or all, the default",
     OPTION_TAKE, .take = take_fields},
    {0},
};
static const option_row pattern_rows[] = {
    POINTS("fan", SGT_PATTERN_FAN, RAYS_MOST, "N rays across the entrance pupil in y, from edge to edge"),
    POINTS("grid", SGT_PATTERN_GRID, SIDE_MOST,
           "a square grid of N x N rays over the pupil, without those outside its circle"),
    POINTS("hexapolar", SGT_PATTERN_HEXAPOLAR, SIDE_MOST, "the centre, and N rings of 6, 12, 18 ... rays"),
    POINTS("random", SGT_PATTERN_RANDOM, RANDOM_MOST, "N random rays, uniform over the area"),
    {"seed", "S", "other random rays (default 1)", OPTION_TAKE, .take = take_seed},
    POINTS("sobol", SGT_PATTERN_SOBOL, SOBOL_MOST, "N rays that fill the area evenly"),
    POINTS("cells", SGT_PATTERN_CELLS, SIDE_MOST,
           "the centres of the cells of a square of N x N, those in the circle"),
    POINTS("cross", SGT_PATTERN_CROSS, RAYS_MOST, "N rays across in y, and N in x"),
    {"chief", NULL, "the ray through the centre of the pupil: --pupil \"0 0\"", OPTION_TAKE,
     .take = take_pupil},
    {"pupil", "\"PX PY\"", "the ray through a point of the pupil, in radii of it.  May be repeated",
     OPTION_TAKE,
     .take = take_pupil},
    {"pattern", "P", "--pattern P is now --P N: --fan N, --grid N, --hexapolar N, --random N and so on",
     .kind = OPTION_REFUSED},
    {"rays-across", "N",
     "--rays-across N is now the N of --fan, --grid, --cells or --cross, and twice that of --hexapolar",
     .kind = OPTION_REFUSED},
    {0},
};
static const option_row aim_rows[] = {
    {"aim", "A",
     "what the points of the pupil are of: paraxial or real\n"
     "paraxial: of the paraxial entrance pupil; real: of the stop (its radius is the marginal\n"
     "ray's height there).  Default: as the lens says.  Rays are searched in 600 pupil radii,\n"
     "and in all that rims in front let through.  Only if rims bound them can it be proven\n"
     "that there is no such ray.  Else a ray that is not found is undecided",
     OPTION_TAKE, .words = "paraxial real", .take = take_again},
    {0},
};
static const option_row file_rows[] = {
    {"rays", "FILE",
     "rays from a file instead, in the global frame\n"
     "csv with a header row, ox,oy,oz,dx,dy,dz and optionally id; FILE may be - for standard\n"
     "input; or an array of NumPy, NAME.npy, or a folder with an array for each column",
     OPTION_TEXT, .to = offsetof(job_options, rays)},
    {"skip-bad", NULL, "skip bad rows of the file, and say how many", OPTION_FLAG,
     .to = offsetof(job_options, skip_bad)},
    {0},
};
static const option_row wavelength_rows[] = {
    {"wavelength", "W",
     "a wavelength of the lens, counted from 1; or micrometres, with a point; or all\n"
     "Or a spectral line: i h g F' F e d D C' C r s t.  Several: W,W..., or --wavelength\n"
     "repeated.  Default: the primary one; of spot, fan, opd and field all of the lens",
     OPTION_TAKE, .take = take_wavelength},
    {0},
};
static const option_row glass_rows[] = {
    {"configuration", "N",
     "of a file with several configurations, the N-th, counted from 1; or its name; or all\n"
     "Default: the values of the file itself; of a .zmx file the active one, of a .seq file the\n"
     "first position of its zoom.  all: a table of all of them, with a column `configuration`;\n"
     "of import and edit the file with all of them.  --set is made of the one that is chosen",
     OPTION_TAKE, .take = take_again},
    {"set", "PATH=VALUE",
     "the lens with another value: surfaces[3].thickness=4.5, \"surfaces[front].glass=N-SF6\"\n"
     "PATH is a place in the lens file (docs/lens_file.md#paths), VALUE is YAML.  May be repeated",
     OPTION_TAKE, .take = take_again},
    {"glass", "PATH",
     "glasses of a catalogue (.agf, .yml, .csv) or a folder of them.  May be repeated\n"
     "They come before those that ship.  If several makers have a name, the first of the\n"
     "lens's `makers` decides; else such a catalogue; else SCHOTT, OHARA, HOYA, CDGM, HIKARI,\n"
     "SUMITA",
     OPTION_TAKE, .take = take_again},
    {"strict", NULL,
     "what a reader leaves out is an error\n"
     "So is a wavelength outside the range of a glass",
     OPTION_TAKE, .take = take_again},
    {0},
};
static const option_row aperture_rows[] = {
    {"no-apertures", NULL, "ignore the clear apertures: clip no ray", OPTION_TAKE, .take = take_again},
    {0},
};
const option_group job_fields_options = {OPTIONS_OF_JOB, "Fields", .row = field_rows},
                   job_pattern_options = {OPTIONS_OF_JOB, "Rays", .row = pattern_rows},
                   job_aim_options = {OPTIONS_OF_JOB, NULL, .row = aim_rows},
                   job_file_options = {OPTIONS_OF_RAYS, NULL, .row = file_rows},
                   job_wavelength_options = {OPTIONS_OF_JOB, "The lens", .row = wavelength_rows},
                   job_glass_options = {OPTIONS_OF_JOB, NULL, .row = glass_rows},
                   job_aperture_options = {OPTIONS_OF_JOB, NULL, .row = aperture_rows},
                   job_no_fields = {OPTIONS_OF_JOB, NULL, .row = field_rows, .hidden = true},
                   job_no_pattern = {OPTIONS_OF_JOB, NULL, .row = pattern_rows, .hidden = true},
                   job_no_file = {OPTIONS_OF_RAYS, NULL, .row = file_rows, .hidden = true};

sgt_ray job_own_ray(const sgt_pose *pose, const sgt_ray *ray)
{
    return (sgt_ray){.o = frame_point_in(pose, ray->o), .d = frame_direction_in(pose, ray->d),
                     .tmin = -HUGE_VAL, .tmax = HUGE_VAL};
}

lens_list job_lenses(const job_options *o)
{
    if (!o->several && (o->all_wavelengths || o->wavelengths > 1))
        fail_usage("--wavelength: give one wavelength");
    if (o->all_wavelengths && o->wavelengths) fail_usage("give --wavelength all, or single ones, not both");
    sgt_lens *of = o->of ? o->of : lens_open(o->lens);
    const lens_wavelength primary = {.um = (double)NAN};
    lens_list all = {.count = o->all_wavelengths ? of->wavelengths : o->wavelengths ? o->wavelengths : 1};
    all.lens = memory_take(all.count, sizeof *all.lens);
    for (size_t i = 0; i < all.count; i++)
        all.lens[i] = lens_at(of, o->all_wavelengths ? (lens_wavelength){.place = i + 1}
                                  : o->wavelengths   ? o->wavelength[i]
                                                     : primary);
    return all;
}

lens_list job_lenses_of_each(const job_options *o, lens_each *all)
{
    lens_list list = {.count = 0};
    *all = lens_open_each(o->lens);
    if (!all->count) return job_lenses(o);
    for (size_t i = 0; i < all->count; i++) {
        job_options one = *o;
        one.of = all->at[i];
        const lens_list own = job_lenses(&one);
        list.lens = memory_grow(list.lens, list.count + own.count, sizeof *list.lens);
        for (size_t k = 0; k < own.count; k++) {
            lens *l = &list.lens[list.count++];
            *l = own.lens[k], l->configuration = i + 1, l->configuration_name = all->name[i];
        }
    }
    return list;
}

void job_move(sgt_pose *pose, double z)
{
    const bool straight = pose->ex.x == 0 && pose->ex.y == 0 && pose->ex.z == 0;
    const sgt_vec3 along = straight ? (sgt_vec3){0, 0, 1} : pose->ez;
    pose->origin.x += z * along.x, pose->origin.y += z * along.y, pose->origin.z += z * along.z;
}

const sgt_element *job_elements(const job_options *o, const lens *l)
{
    if (!o->no_apertures) return l->element;
    sgt_element *element = memory_take(l->count, sizeof *element);
    memcpy(element, l->element, l->count * sizeof *element);
    for (size_t i = 0; i < l->count; i++) element[i].semi_diameter = 0, element[i].aperture = NULL;
    return element;
}

/* Sets the lens at each wavelength, with its elements. */
static void read_wavelengths(job *j, const job_options *o)
{
    lens_list all = job_lenses(o);
    j->wavelengths = all.count;
    j->at = memory_take(all.count, sizeof *j->at);
    for (size_t c = 0; c < all.count; c++) {
        lens *l = &all.lens[c];
        if (o->defocus != 0) {
            sgt_element *moved = memory_take(l->count, sizeof *moved);
            memcpy(moved, l->element, l->count * sizeof *moved);
            job_move(&moved[l->count - 1].pose, o->defocus);
            l->element = moved;
        }
        j->at[c] = (job_lens){.lens = *l, .element = job_elements(o, l)};
    }
    j->lens = j->at[0].lens, j->element = j->at[0].element;
}

const sgt_lens_aim *job_aim(const job_options *o, const sgt_lens *l)
{
    static const sgt_lens_aim pupil = SGT_LENS_AIM_PUPIL, stop = SGT_LENS_AIM_STOP;
    if (!o->aim_given) return NULL;
    if (!o->aimed) return &pupil;
    return l->aim == SGT_LENS_AIM_REAL_STOP ? NULL : &stop;
}

field_list job_fields(const job_options *o, const lens *l)
{
    const sgt_lens *of = l->of;
    if (o->fields && o->numbers)
        fail_usage("give %s or --fields, not both", o->field_at ? "--field-at" : "--field");
    field_list list = {.count = o->fields ? o->fields : o->numbers ? o->numbers : of->fields,
                       .at = o->fields ? o->field : of->field,
                       .kind = o->fields ? SGT_FIELD_ANGLE : of->field_kind};
    size_t *number = memory_take(list.count, sizeof *number);
    for (size_t i = 0; i < list.count; i++) number[i] = i;
    list.number = o->numbers ? o->number : number;
    for (size_t k = 0; o->field_at && k < KINDS; k++)
        if (!o->field_kind || o->field_kind == kinds[k]) {
            list.kind = o->field_kind ? (sgt_field_kind)k : of->field_kind;
            break;
        }
    if (!o->numbers) return list;
    sgt_lens_field *at = memory_take(list.count, sizeof *at);
    for (size_t i = 0; i < list.count; i++) {
        if (o->number[i] >= of->fields)
            fail_usage("--fields %zu: %s has %zu field%s", o->number[i] + 1, of->file, of->fields,
                       of->fields == 1 ? "" : "s");
        at[i] = of->field[o->number[i]];
    }
    list.at = at;
    return list;
}

job_points_asked job_points_of(const job_options *o, sgt_pattern otherwise)
{
    const sgt_pattern pattern = o->points ? o->pattern : otherwise;
    if (o->pupils && o->points) fail_usage("give --chief and --pupil, or a pattern, not both");
    if (o->seed && pattern != SGT_PATTERN_RANDOM) fail_usage("--seed goes with --random N");
    for (size_t i = 0; i < o->pupils; i++) o->pupil[i].weight = 1 / (double)o->pupils;
    return (job_points_asked){.pattern = pattern, .rays = (size_t)o->points,
                              .seed = o->seed ? (uint64_t)o->seed : 1, .count = o->pupils, .at = o->pupil};
}

launch_pattern job_points(const job_options *o, sgt_pattern otherwise, size_t n)
{
    const job_points_asked asked = job_points_of(o, otherwise);
    if (asked.count) return (launch_pattern){.count = asked.count, .at = asked.at};
    const size_t count = asked.rays ? asked.rays : n;
    const launch_pattern points = launch_points(asked.pattern, count, asked.seed);
    if (!points.count)
        fail_usage("--grid %zu: no ray lies inside the pupil's circle; use 1, or 3 or more", count);
    return points;
}

/* The rays are made when they are needed. */
static void plan_rays(job *j, const launch_pattern *points)
{
    sgt_field_beam *beam = memory_take(j->fields, sizeof *beam);
    for (size_t f = 0; f < j->fields; f++) beam[f] = launch_beam(j->how, j->field_kind, j->field[f]);
    for (size_t c = 0; c < j->wavelengths; c++)
        j->at[c].plan = (launch_plan){.how = j->how, .traced = &j->at[c].lens,
                                      .element = j->at[c].element, .fields = j->fields,
                                      .beam = beam, .points = points};
    j->how->count = j->fields * points->count;
}

size_t job_count(const job_lens *at)
{
    return at->plan.fields ? at->plan.fields * at->plan.points->count : at->rays.count;
}

void job_part(const job_lens *at, size_t first, size_t count, ray_block *to)
{
    if (at->plan.fields) launch_part(&at->plan, first, count, to);
    else rays_part(&at->rays, first, count, to);
}

void job_end_parts(job *j)
{
    if (!j->how) return;
    j->undecided = j->how->undecided;
    launch_note(j->how, j->wavelengths);
}

job job_read(const job_options *o)
{
    if (o->rays && (o->fields || o->numbers || o->points || o->pupils))
        fail_usage("give --rays, or --field with --fan, --grid or another pattern, not both");
    if (o->rays && o->seed) fail_usage("--seed goes with --random N");
    job j = {.wavelengths = 0};
    read_wavelengths(&j, o);
    if (o->rays) {
        j.rays.threads = o->threads, j.rays.parts = o->parts, j.rays.some = shard_is();
        rays_read(&j.rays, o->rays, o->skip_bad);
        if (j.rays.ended)
            note("%s: tmin, tmax: not used; through a lens the whole line of a ray is searched", o->rays);
        for (size_t c = 0; c < j.wavelengths; c++) j.at[c].rays = j.rays;
        return j;
    }
    const field_list fields = job_fields(o, &j.lens);
    j.field = fields.at, j.fields = fields.count, j.field_number = fields.number, j.field_kind = fields.kind;
    launch_pattern *points = memory_take(1, sizeof *points);
    *points = job_points(o, SGT_PATTERN_FAN, FAN_DEFAULT);
    const sgt_lens_aim *aim = job_aim(o, j.lens.of);
    const bool aimed = (aim ? *aim : j.lens.of->aim) != SGT_LENS_AIM_PUPIL;
    j.how = memory_take(1, sizeof *j.how);
    *j.how = launch_by(&j.lens, aim);
    j.how->field_number = j.field_number;
    if (o->parts) {
        plan_rays(&j, points);
        return j;
    }
    for (size_t c = 0; c < j.wavelengths; c++) {
        if (c > 0 && !aimed) { /* the same rays at all wavelengths */
            j.at[c].rays = j.at[0].rays;
            continue;
        }
        j.how->count = 0;
        for (size_t f = 0; f < j.fields; f++)
            launch_field(&j.at[c].rays, j.how, &j.at[c].lens, j.at[c].element, f, j.field_kind, j.field[f],
                         points);
    }
    j.rays = j.at[0].rays;
    job_end_parts(&j);
    return j;
}
