/* job.c - a lens and the rays to send through it. */
#include "job.h"

#include "../show/frame.h"
#include "launch.h"
#include "../base/memory.h"

#include <limits.h>
#include <math.h>
#include <sagitta/lens.h>
#include <string.h>

enum { FAN_DEFAULT = 5, RAYS_MOST = 1000000000 };

const char job_help[] =
    "  --field DEG        angle of a field in the y-z plane, in degrees; the chief ray of a positive\n"
    "                     field climbs toward +y.  May be repeated.  Default: the fields of the lens\n"
    "  --fan N            N rays across the entrance pupil in y, from edge to edge (default 5)\n"
    "  --grid N           a square grid of N x N rays over the pupil, without those outside its circle\n"
    "  --rays FILE        rays from a file instead, in the global frame: csv with a header row,\n"
    "                     ox,oy,oz,dx,dy,dz and optionally id; FILE may be - for standard input\n"
    "  --skip-bad         skip bad rows of the file, and say how many\n"
    "  --wavelength W     a whole number: the lens's W-th wavelength, counted from 1 (default 1).\n"
    "                     With a point: micrometres.  Or a spectral line: i h g F' F e d D C' C r s t\n"
    "  --glass PATH       glasses of a catalogue (.agf, .yml, .csv) or a folder of them, before those\n"
    "                     that ship.  May be repeated\n"
    "  --no-apertures     ignore the clear apertures: clip no ray\n";

static void take_wavelength(job_options *o)
{
    o->wavelength = -1, o->um = sgt_spectral_line(optarg);
    if (!isnan(o->um)) return;
    if (!strchr(optarg, '.')) {
        if (!strpbrk(optarg, "0123456789"))
            fail_usage("--wavelength must be a whole number, micrometres with a point, or a spectral line "
                       "(i h g F' F e d D C' C r s t), not \"%s\"", optarg);
        o->wavelength = options_integer("wavelength", optarg, 1, INT_MAX);
        return;
    }
    o->um = options_number("wavelength", optarg);
    if (!(o->um > 0)) fail_usage("--wavelength must be positive, not %s micrometres", optarg);
}

bool job_take(job_options *o, int code)
{
    switch (code) {
    case JOB_FIELD:
        if (strchr(optarg, ','))
            fail_usage("--field takes one angle, not %s; for several angles repeat --field", optarg);
        o->field = memory_room(o->field, o->fields, &o->capacity, sizeof *o->field);
        o->field[o->fields] = (sgt_lens_field){.y = options_number("field", optarg), .weight = 1};
        if (!(fabs(o->field[o->fields++].y) < 90))
            fail_usage("--field must be between -90 and 90 degrees, not %s", optarg);
        return true;
    case JOB_FAN: o->fan = options_integer("fan", optarg, 1, RAYS_MOST); return true;
    case JOB_GRID: o->grid = options_integer("grid", optarg, 1, RAYS_MOST); return true;
    case JOB_RAYS: o->rays = optarg; return true;
    case JOB_SKIP_BAD: o->skip_bad = true; return true;
    case JOB_WAVELENGTH: take_wavelength(o); return true;
    case JOB_GLASS: lens_glass_folder(optarg), o->glass = true; return true;
    case JOB_NO_APERTURES: o->no_apertures = true; return true;
    default: return false;
    }
}

sgt_ray job_own_ray(const sgt_pose *pose, const sgt_ray *ray)
{
    return (sgt_ray){.o = frame_point_in(pose, ray->o), .d = frame_direction_in(pose, ray->d),
                     .tmin = -HUGE_VAL, .tmax = HUGE_VAL};
}

job job_read(const job_options *o)
{
    if (o->fan && o->grid) fail_usage("give --fan or --grid, not both");
    if (o->rays && (o->fields || o->fan || o->grid))
        fail_usage("give --rays, or --field with --fan or --grid, not both");
    lens_wavelength at = {.place = o->wavelength > 0 ? (size_t)o->wavelength : 0,
                          .um = o->wavelength < 0 ? o->um : (double)NAN};
    job j = {.lens = lens_read(o->lens, at)};
    j.element = memory_take(j.lens.count, sizeof *j.element);
    memcpy(j.element, j.lens.element, j.lens.count * sizeof *j.element);
    for (size_t i = 0; o->no_apertures && i < j.lens.count; i++) j.element[i].semi_diameter = 0;
    if (o->rays) {
        j.rays.threads = o->threads;
        rays_read(&j.rays, o->rays, o->skip_bad);
        if (j.rays.ended)
            note("%s: tmin, tmax: not used; through a lens the whole line of a ray is searched", o->rays);
        return j;
    }
    j.field = o->fields ? o->field : j.lens.of->field;
    j.fields = o->fields ? o->fields : j.lens.of->fields;
    j.field_kind = o->fields ? SGT_FIELD_ANGLE : j.lens.of->field_kind;
    pupil_pattern pattern = o->grid ? PUPIL_GRID : PUPIL_FAN;
    long n = o->grid ? o->grid : o->fan ? o->fan : FAN_DEFAULT;
    for (size_t f = 0; f < j.fields; f++)
        launch_field(&j.rays, &j.lens, f, j.field_kind, j.field[f], pattern, n);
    if (!j.rays.count)
        fail_usage("--grid %ld: no ray lies inside the pupil's circle; use 1, or 3 or more", n);
    return j;
}
