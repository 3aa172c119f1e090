/* job.c - a lens and the rays to send through it. */
#include "job.h"

#include "../show/frame.h"
#include "launch.h"
#include "../base/memory.h"

#include <limits.h>
#include <math.h>
#include <sagitta/lens.h>
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
};
enum { PATTERNS = sizeof patterns / sizeof patterns[0] };
static const char ONE_PATTERN[] = "give one of --fan, --grid, --hexapolar, --random, --sobol, --pattern";

const char job_help[] =
    "  --field DEG        angle of a field in the y-z plane, in degrees; the chief ray of a positive\n"
    "                     field climbs toward +y.  May be repeated.  Default, or all: the fields of\n"
    "                     the lens\n"
    "  --fan N            N rays across the entrance pupil in y, from edge to edge (default 5)\n"
    "  --grid N           a square grid of N x N rays over the pupil, without those outside its circle\n"
    "  --hexapolar N      the centre, and N rings of 6, 12, 18 ... rays\n"
    "  --random N         N random rays, uniform over the area; --seed S (default 1) draws others\n"
    "  --sobol N          N rays that fill the area evenly\n"
    "  --pattern P        fan, grid, hexapolar, random or sobol, with a number of rays that suits\n"
    "  --aim A            where px, py are: paraxial, in the paraxial entrance pupil; real: on the stop\n"
    "                     (its radius is the marginal ray's height there).  Default: as the lens says\n"
    "  --rays FILE        rays from a file instead, in the global frame: csv with a header row,\n"
    "                     ox,oy,oz,dx,dy,dz and optionally id; FILE may be - for standard input\n"
    "  --skip-bad         skip bad rows of the file, and say how many\n"
    "  --wavelength W     a whole number: the lens's W-th wavelength, counted from 1 (default: its\n"
    "                     primary one).  With a point: micrometres.  Or a spectral line:\n"
    "                     i h g F' F e d D C' C r s t.  Or all: those of the lens, one after another;\n"
    "                     also with --wavelength repeated (trace only)\n"
    "  --glass PATH       glasses of a catalogue (.agf, .yml, .csv) or a folder of them, before those\n"
    "                     that ship.  May be repeated\n"
    "  --strict           what the reader of a .zmx file leaves out, and a wavelength outside the range\n"
    "                     of a glass, are errors\n"
    "  --no-apertures     ignore the clear apertures: clip no ray\n";

static const double NANOMETRES = 100; /* um: light so long is rarer than a slip of the unit */
static const char LINES[] = "i h g F' F e d D C' C r s t";

static lens_wavelength wavelength_of(const char *text)
{
    double um = sgt_spectral_line(text);
    if (!isnan(um)) return (lens_wavelength){.um = um};
    if (strchr(text, ','))
        fail_usage("--wavelength takes one, not %s; for several repeat --wavelength", text);
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

static void take_wavelength(job_options *o)
{
    if (strcmp(optarg, "all") == 0) {
        o->all_wavelengths = true;
        return;
    }
    o->wavelength = memory_room(o->wavelength, o->wavelengths, &o->wavelength_capacity,
                                sizeof *o->wavelength);
    o->wavelength[o->wavelengths++] = wavelength_of(optarg);
}

/* --fan N and its like. */
static void take_points(job_options *o, sgt_pattern pattern)
{
    long most = pattern == SGT_PATTERN_GRID || pattern == SGT_PATTERN_HEXAPOLAR ? SIDE_MOST : RAYS_MOST;
    if (o->points) fail_usage("%s", ONE_PATTERN);
    o->pattern = pattern;
    o->points = options_integer(patterns[pattern].name, optarg, 1, most);
}

static void take_pattern(job_options *o)
{
    int i = 0;
    if (o->points) fail_usage("%s", ONE_PATTERN);
    while (i < PATTERNS && strcmp(optarg, patterns[i].name) != 0) i++;
    if (i == PATTERNS)
        fail_usage("--pattern must be fan, grid, hexapolar, random or sobol, not \"%s\"", optarg);
    o->pattern = (sgt_pattern)i, o->points = patterns[i].points;
}

static void take_field(job_options *o)
{
    if (strcmp(optarg, "all") == 0) return; /* those of the lens: the default */
    if (strchr(optarg, ','))
        fail_usage("--field takes one angle, not %s; for several angles repeat --field", optarg);
    o->field = memory_room(o->field, o->fields, &o->capacity, sizeof *o->field);
    o->field[o->fields] = (sgt_lens_field){.y = options_number("field", optarg), .weight = 1};
    if (!(fabs(o->field[o->fields++].y) < 90))
        fail_usage("--field must be between -90 and 90 degrees, not %s", optarg);
}

bool job_take(job_options *o, int code)
{
    switch (code) {
    case JOB_FIELD: take_field(o); return true;
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
    case JOB_GLASS: lens_glass_folder(optarg), o->glass = true; return true;
    case JOB_AIM:
        o->aim_given = true, o->aimed = strcmp(optarg, "real") == 0;
        if (!o->aimed && strcmp(optarg, "paraxial") != 0)
            fail_usage("--aim must be paraxial or real, not \"%s\"", optarg);
        return true;
    case JOB_STRICT: o->strict = true; return true;
    case JOB_NO_APERTURES: o->no_apertures = true; return true;
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

/* Sets the lens at each wavelength, with its elements. */
static void read_wavelengths(job *j, const job_options *o)
{
    lens_list all = job_lenses(o);
    j->wavelengths = all.count;
    j->at = memory_take(all.count, sizeof *j->at);
    for (size_t c = 0; c < all.count; c++) {
        const lens *l = &all.lens[c];
        sgt_element *element = memory_take(l->count, sizeof *element);
        memcpy(element, l->element, l->count * sizeof *element);
        for (size_t i = 0; o->no_apertures && i < l->count; i++)
            element[i].semi_diameter = 0, element[i].aperture = NULL;
        j->at[c] = (job_lens){.lens = *l, .element = element};
    }
    j->lens = j->at[0].lens, j->element = j->at[0].element;
}

/* Where rays are sent: as --aim says, else as the lens does. */
static launch_aim aim_of(const job_options *o, const sgt_lens *l)
{
    if (o->aim_given && !o->aimed) return LAUNCH_AT_PUPIL;
    if (l->aim == SGT_AIM_REAL_STOP) return LAUNCH_AT_REAL_STOP;
    return o->aimed || l->aim == SGT_AIM_STOP ? LAUNCH_AT_STOP : LAUNCH_AT_PUPIL;
}

job job_read(const job_options *o)
{
    if (o->rays && (o->fields || o->points))
        fail_usage("give --rays, or --field with --fan, --grid or another pattern, not both");
    if (o->seed && o->pattern != SGT_PATTERN_RANDOM) fail_usage("--seed goes with --random N");
    job j = {.wavelengths = 0};
    read_wavelengths(&j, o);
    if (o->rays) {
        j.rays.threads = o->threads;
        rays_read(&j.rays, o->rays, o->skip_bad);
        if (j.rays.ended)
            note("%s: tmin, tmax: not used; through a lens the whole line of a ray is searched", o->rays);
        for (size_t c = 0; c < j.wavelengths; c++) j.at[c].rays = j.rays;
        return j;
    }
    j.field = o->fields ? o->field : j.lens.of->field;
    j.fields = o->fields ? o->fields : j.lens.of->fields;
    j.field_kind = o->fields ? SGT_FIELD_ANGLE : j.lens.of->field_kind;
    const long n = o->points ? o->points : patterns[SGT_PATTERN_FAN].points;
    const launch_pattern points = launch_points(o->pattern, (size_t)n, o->seed ? (uint64_t)o->seed : 1);
    const lens primary = lens_for_launch(&j.lens);
    launch_how how = launch_by(&primary, aim_of(o, j.lens.of));
    for (size_t c = 0; c < j.wavelengths; c++) {
        if (c > 0 && how.aim == LAUNCH_AT_PUPIL) { /* the same rays at all wavelengths */
            j.at[c].rays = j.at[0].rays;
            continue;
        }
        how.count = 0;
        for (size_t f = 0; f < j.fields; f++)
            launch_field(&j.at[c].rays, &how, &j.at[c].lens, f, j.field_kind, j.field[f], &points);
    }
    j.rays = j.at[0].rays, j.undecided = how.undecided;
    if (how.none + how.undecided)
        note("%zu of %zu rays are not there: of %zu that is proven", how.none + how.undecided,
             how.count * j.wavelengths, how.none);
    if (!how.count)
        fail_usage("--grid %ld: no ray lies inside the pupil's circle; use 1, or 3 or more", n);
    return j;
}
