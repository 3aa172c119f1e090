/* job.c - a lens and the rays to send through it. */
#include "job.h"

#include "../show/frame.h"
#include "../base/memory.h"

#include <limits.h>
#include <math.h>
#include <sagitta/lens.h>
#include <stdio.h>
#include <string.h>

enum { RAYS_MOST = 1000000000, SIDE_MOST = 30000 };

/* The patterns, and how many points each has without a number. */
static const struct { const char *name; long points;
} patterns[] = {
    [SGT_PATTERN_FAN] = {"fan", 5},
    [SGT_PATTERN_GRID] = {"grid", 11},
    [SGT_PATTERN_HEXAPOLAR] = {"hexapolar", 6},
    [SGT_PATTERN_RANDOM] = {"random", 100},
    [SGT_PATTERN_SOBOL] = {"sobol", 128},
    [SGT_PATTERN_CELLS] = {"cells", 20},
    [SGT_PATTERN_CROSS] = {"cross", 21},
};
enum { PATTERNS = sizeof patterns / sizeof patterns[0] };
static const char ONE_PATTERN[] =
    "give one of --fan, --grid, --hexapolar, --random, --sobol, --cells, --cross, --pattern";
static const char PATTERN_NAMES[] = "fan, grid, hexapolar, random, sobol, cells or cross";

/* The help in parts, and the whole of it. */
#define FIELDS_HELP                                                                                     \
    "  --field DEG        angle of a field in the y-z plane, in degrees; the chief ray of a positive\n" \
    "                     field climbs toward +y.  May be repeated\n"                                   \
    "  --field-at \"X Y K\" a field: two numbers, as `fields` of a lens file has them.  K is angle,\n"    \
    "                     object_height, paraxial_image_height or real_image_height; left out: as\n"     \
    "                     the lens has it.  May be repeated, with the same K\n"                          \
    "  --fields LIST      fields of the lens by their numbers, counted from 1: 1,3.  Or all, the default\n"

#define PATTERNS_HELP                                                                                        \
    "  --fan N            N rays across the entrance pupil in y, from edge to edge\n"                        \
    "  --grid N           a square grid of N x N rays over the pupil, without those outside its circle\n"    \
    "  --hexapolar N      the centre, and N rings of 6, 12, 18 ... rays\n"                                   \
    "  --random N         N random rays, uniform over the area; --seed S (default 1) draws others\n"         \
    "  --sobol N          N rays that fill the area evenly\n"                                                \
    "  --cells N          the centres of the cells of a square of N x N, those in the circle\n"              \
    "  --cross N          N rays across in y, and N in x\n"                                                  \
    "  --pattern P        fan, grid, hexapolar, random, sobol, cells or cross, with as many rays as suit;\n" \
    "  --rays-across N    or so many across the pupil (of random and sobol as many as a grid would have)\n"  \
    "  --chief            the ray through the centre of the pupil: --pupil \"0 0\"\n"                        \
    "  --pupil \"PX PY\"    the ray through a point of the pupil, in radii of it.  May be repeated\n"

#define AIM_HELP                                                                                           \
    "  --aim A            where px, py are: paraxial, in the paraxial entrance pupil; real: on the stop\n" \
    "                     (its radius is the marginal ray's height there).  Default: as the lens says.\n"  \
    "                     Rays are searched in 600 pupil radii, and in all that rims in front let\n"       \
    "                     through.  Only if rims bound them can it be proven that there is no such ray.\n" \
    "                     Else a ray that is not found is undecided\n"

#define FILE_HELP                                                                                      \
    "  --rays FILE        rays from a file instead, in the global frame: csv with a header row,\n"     \
    "                     ox,oy,oz,dx,dy,dz and optionally id; FILE may be - for standard input; or\n" \
    "                     an array of NumPy, NAME.npy, or a folder with an array for each column\n"    \
    "  --skip-bad         skip bad rows of the file, and say how many\n"

#define WAVELENGTH_HELP                                                                          \
    "  --wavelength W     a whole number: the lens's W-th wavelength, counted from 1.  With a\n" \
    "                     point: micrometres.  Or a spectral line: i h g F' F e d D C' C r s\n"  \
    "                     t.  Or all: those of the lens, one after another; also W,W... and\n"   \
    "                     --wavelength repeated.\n"

#define LENS_HELP                                                                                          \
    "  --glass PATH       glasses of a catalogue (.agf, .yml, .csv) or a folder of them, before those\n"   \
    "                     that ship.  May be repeated.  If several makers have a name, the first of the\n"  \
    "                     lens's `makers` decides; else such a catalogue; else SCHOTT, OHARA, HOYA, CDGM,\n" \
    "                     HIKARI, SUMITA\n"                                                                \
    "  --strict           what the reader of a .zmx file leaves out, and a wavelength outside the range\n" \
    "                     of a glass, are errors\n"                                                        \
    "  --no-apertures     ignore the clear apertures: clip no ray\n"

const char job_fields_help[] = FIELDS_HELP, job_patterns_help[] = PATTERNS_HELP, job_aim_help[] = AIM_HELP,
           job_wavelength_help[] = WAVELENGTH_HELP, job_lens_help[] = LENS_HELP;
const char job_help[] = FIELDS_HELP PATTERNS_HELP
    "  none of these      --fan 5\n" AIM_HELP FILE_HELP WAVELENGTH_HELP
    "                     Default: its primary one\n" LENS_HELP;

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

static void take_wavelength(job_options *o)
{
    if (strcmp(optarg, "all") == 0) {
        o->all_wavelengths = true;
        return;
    }
    for (char *rest = memory_text(optarg, strlen(optarg)), *word; (word = next_word(&rest));) {
        o->wavelength = memory_room(o->wavelength, o->wavelengths, &o->wavelength_capacity,
                                    sizeof *o->wavelength);
        o->wavelength[o->wavelengths++] = wavelength_of(word);
    }
}

/* --fan N and its like. */
static void take_points(job_options *o, sgt_pattern pattern)
{
    const bool square = pattern == SGT_PATTERN_GRID || pattern == SGT_PATTERN_CELLS ||
                        pattern == SGT_PATTERN_HEXAPOLAR;
    const long most = square ? SIDE_MOST : RAYS_MOST;
    if (o->pattern_given) fail_usage("%s", ONE_PATTERN);
    o->pattern = pattern, o->pattern_given = true;
    o->points = options_integer(patterns[pattern].name, optarg, 1, most);
}

static void take_pattern(job_options *o)
{
    int i = 0;
    if (o->pattern_given) fail_usage("%s", ONE_PATTERN);
    while (i < PATTERNS && strcmp(optarg, patterns[i].name) != 0) i++;
    if (i == PATTERNS) fail_usage("--pattern must be %s, not \"%s\"", PATTERN_NAMES, optarg);
    o->pattern = (sgt_pattern)i, o->pattern_given = true;
}

static void take_pupil(job_options *o, const char *text)
{
    double x, y;
    char more;
    if (sscanf(text, "%lf %lf %c", &x, &y, &more) != 2 || !(fabs(x) <= 100) || !(fabs(y) <= 100))
        fail_usage("--pupil must be two numbers, \"PX PY\", in radii of the pupil, not \"%s\"", text);
    o->pupil = memory_room(o->pupil, o->pupils, &o->pupil_capacity, sizeof *o->pupil);
    o->pupil[o->pupils++] = (sgt_pupil_point){x, y, 1};
}

static void take_fields(job_options *o)
{
    if (strcmp(optarg, "all") == 0) return; /* the default */
    for (char *rest = memory_text(optarg, strlen(optarg)), *word; (word = next_word(&rest));) {
        o->number = memory_room(o->number, o->numbers, &o->number_capacity, sizeof *o->number);
        o->number[o->numbers++] = (size_t)options_integer("fields", word, 1, INT_MAX) - 1;
    }
}

static void take_field(job_options *o)
{
    if (strcmp(optarg, "all") == 0) return; /* those of the lens: the default */
    if (strchr(optarg, ','))
        fail_usage("--field takes one angle, not %s; for several angles repeat --field", optarg);
    if (o->field_at) fail_usage("give --field or --field-at, not both");
    o->field = memory_room(o->field, o->fields, &o->capacity, sizeof *o->field);
    o->field[o->fields] = (sgt_lens_field){.y = options_number("field", optarg), .weight = 1};
    if (!(fabs(o->field[o->fields++].y) < 90))
        fail_usage("--field must be between -90 and 90 degrees, not %s", optarg);
}

static const char *const kinds[] = {[SGT_FIELD_ANGLE] = "angle",
                                    [SGT_FIELD_OBJECT_HEIGHT] = "object_height",
                                    [SGT_FIELD_PARAXIAL_IMAGE_HEIGHT] = "paraxial_image_height",
                                    [SGT_FIELD_REAL_IMAGE_HEIGHT] = "real_image_height"};
enum { KINDS = sizeof kinds / sizeof kinds[0] };

const char *job_field_kind(sgt_field_kind kind) { return kinds[kind]; }

static void take_field_at(job_options *o)
{
    sgt_lens_field f = {.weight = 1};
    char kind[40] = "", more;
    const int n = sscanf(optarg, "%lf %lf %39s %c", &f.x, &f.y, kind, &more);
    size_t k = 0;
    while (k < KINDS && strcmp(kind, kinds[k]) != 0) k++;
    if (n < 2 || n > 3 || !isfinite(f.x) || !isfinite(f.y) || (n == 3 && k == KINDS))
        fail_usage("--field-at must be \"X Y\" or \"X Y KIND\", KIND angle, object_height, "
                   "paraxial_image_height or real_image_height, not \"%s\"", optarg);
    const char *own = n == 3 ? kinds[k] : NULL;
    if (o->fields && (!o->field_at || own != o->field_kind))
        fail_usage("give --field, or --field-at with the same KIND each time");
    o->field_at = true, o->field_kind = own;
    o->field = memory_room(o->field, o->fields, &o->capacity, sizeof *o->field);
    o->field[o->fields++] = f;
}

/* Notes an option that a command which repeats the rays has to be given, too. */
static void give_again(job_options *o, const char *option, const char *value)
{
    const char *before = o->again ? o->again : "";
    const size_t size = strlen(before) + strlen(option) + (value ? strlen(value) : 0) + 8;
    char *all = memory_take(size, 1);
    snprintf(all, size, value ? "%s --%s \"%s\"" : "%s --%s", before, option, value);
    o->again = all;
}

bool job_take(job_options *o, int code)
{
    switch (code) {
    case JOB_FIELD: take_field(o); return true;
    case JOB_FIELD_AT: take_field_at(o); return true;
    case JOB_FIELDS: take_fields(o); return true;
    case JOB_CHIEF: take_pupil(o, "0 0"); return true;
    case JOB_PUPIL: take_pupil(o, optarg); return true;
    case JOB_ACROSS: o->across = options_integer("rays-across", optarg, 1, SIDE_MOST); return true;
    case JOB_CELLS: take_points(o, SGT_PATTERN_CELLS); return true;
    case JOB_CROSS: take_points(o, SGT_PATTERN_CROSS); return true;
    case JOB_FAN:
    case JOB_GRID:
    case JOB_HEXAPOLAR:
    case JOB_RANDOM:
    case JOB_SOBOL: take_points(o, (sgt_pattern)(code - JOB_FAN)); return true;
    case JOB_PATTERN: take_pattern(o); return true;
    case JOB_SEED: o->seed = options_integer("seed", optarg, 1, LONG_MAX); return true;
    case JOB_RAYS: o->rays = optarg; return true;
    case JOB_SKIP_BAD: o->skip_bad = true; return true;
    case JOB_WAVELENGTH: take_wavelength(o); return true;
    case JOB_GLASS: lens_glass_folder(optarg), o->glass = true, give_again(o, "glass", optarg); return true;
    case JOB_AIM:
        give_again(o, "aim", optarg);
        o->aim_given = true, o->aimed = strcmp(optarg, "real") == 0;
        if (!o->aimed && strcmp(optarg, "paraxial") != 0)
            fail_usage("--aim must be paraxial or real, not \"%s\"", optarg);
        return true;
    case JOB_STRICT: o->strict = true, give_again(o, "strict", NULL); return true;
    case JOB_NO_APERTURES: o->no_apertures = true, give_again(o, "no-apertures", NULL); return true;
    default: return false;
    }
}

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
    if (o->strict) lens_be_strict();
    sgt_lens *of = lens_open(o->lens);
    const lens_wavelength primary = {.um = (double)NAN};
    lens_list all = {.count = o->all_wavelengths ? of->wavelengths : o->wavelengths ? o->wavelengths : 1};
    all.lens = memory_take(all.count, sizeof *all.lens);
    for (size_t i = 0; i < all.count; i++)
        all.lens[i] = lens_at(of, o->all_wavelengths ? (lens_wavelength){.place = i + 1}
                                  : o->wavelengths   ? o->wavelength[i]
                                                     : primary);
    return all;
}

void job_move(sgt_pose *pose, double z)
{
    const bool straight = pose->ex.x == 0 && pose->ex.y == 0 && pose->ex.z == 0;
    const sgt_vec3 along = straight ? (sgt_vec3){0, 0, 1} : pose->ez;
    pose->origin.x += z * along.x, pose->origin.y += z * along.y, pose->origin.z += z * along.z;
}

sgt_element *job_elements(const job_options *o, const lens *l)
{
    sgt_element *element = memory_take(l->count, sizeof *element);
    memcpy(element, l->element, l->count * sizeof *element);
    for (size_t i = 0; o->no_apertures && i < l->count; i++)
        element[i].semi_diameter = 0, element[i].aperture = NULL;
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

/* The N of a pattern that has so many rays across the pupil. */
static long points_across(sgt_pattern pattern, long across)
{
    const double QUARTER = 0.785398163397448; /* pi / 4: a circle in its square */
    if (pattern == SGT_PATTERN_HEXAPOLAR) return across / 2 ? across / 2 : 1;
    if (pattern != SGT_PATTERN_RANDOM && pattern != SGT_PATTERN_SOBOL) return across;
    return (long)ceil(QUARTER * (double)across * (double)across);
}

launch_pattern job_points(const job_options *o, sgt_pattern otherwise, long n)
{
    if (o->pupils && (o->pattern_given || o->across))
        fail_usage("give --chief and --pupil, or a pattern, not both");
    if (o->points && o->across) fail_usage("--rays-across goes with --pattern");
    const sgt_pattern pattern = o->pattern_given ? o->pattern : otherwise;
    if (o->seed && pattern != SGT_PATTERN_RANDOM) fail_usage("--seed goes with --random N");
    if (o->pupils) {
        for (size_t i = 0; i < o->pupils; i++) o->pupil[i].weight = 1 / (double)o->pupils;
        return (launch_pattern){.count = o->pupils, .at = o->pupil};
    }
    const long count = o->across                    ? points_across(pattern, o->across)
                       : o->points                  ? o->points
                       : n > 0 && !o->pattern_given ? n
                                                    : patterns[pattern].points;
    const launch_pattern points = launch_points(pattern, (size_t)count, o->seed ? (uint64_t)o->seed : 1);
    if (!points.count)
        fail_usage("--grid %ld: no ray lies inside the pupil's circle; use 1, or 3 or more", count);
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

const launch *job_part(const job_lens *at, size_t first, size_t count, launch room[], size_t *there)
{
    if (!at->plan.fields) return rays_part(&at->rays, first, count, room, there);
    launch_part(&at->plan, first, count, room);
    for (*there = 0; *there < count && room[*there].status == SGT_MET;) ++*there;
    for (size_t i = *there + 1; i < count; i++) {
        if (room[i].status != SGT_MET) continue;
        const launch l = room[i];
        memmove(&room[*there + 1], &room[*there], (i - *there) * sizeof l);
        room[(*there)++] = l;
    }
    return room;
}

void job_end_parts(job *j)
{
    if (!j->how) return;
    j->undecided = j->how->undecided;
    launch_note(j->how, j->wavelengths);
}

job job_read(const job_options *o)
{
    if (o->rays && (o->fields || o->numbers || o->pattern_given || o->pupils || o->across))
        fail_usage("give --rays, or --field with --fan, --grid or another pattern, not both");
    if (o->rays && o->seed) fail_usage("--seed goes with --random N");
    job j = {.wavelengths = 0};
    read_wavelengths(&j, o);
    if (o->rays) {
        j.rays.threads = o->threads, j.rays.parts = o->parts;
        rays_read(&j.rays, o->rays, o->skip_bad);
        if (j.rays.ended)
            note("%s: tmin, tmax: not used; through a lens the whole line of a ray is searched", o->rays);
        for (size_t c = 0; c < j.wavelengths; c++) j.at[c].rays = j.rays;
        return j;
    }
    const field_list fields = job_fields(o, &j.lens);
    j.field = fields.at, j.fields = fields.count, j.field_number = fields.number, j.field_kind = fields.kind;
    launch_pattern *points = memory_take(1, sizeof *points);
    *points = job_points(o, SGT_PATTERN_FAN, 0);
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
