// SPDX-License-Identifier: MIT
/* beam.c - the rays of a field as a family: from an object point, or a wavefront, through the pupil.
 *
 * A FIELD of the angles a, b: its chief ray, through the pupil's centre, has the slopes tan a in x
 * and tan b in y, so a positive field climbs.  An object at a finite distance D is then at height
 * -(D + p) tan.  A paraxial image height h: the slope is h P / n from afar (P the power, n the
 * index in front); else the object is at h / m, m the magnification.  The points of a tilted object have
 * these x and y, and so much of z as its slopes say.
 *
 * OBJECT AT INFINITY: the rays start on one wavefront, a plane at right angles to their
 * direction, so that their optical path lengths can be compared.  The plane lies in front of
 * the pupil and of all surfaces. */
#include "launch.h"

#include <sagitta/surfaces.h>

#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

static const double TO_RADIANS = 0.017453292519943295; /* pi / 180 */

bool sgt_launch_fail(const sgt_launcher *from, sgt_error *error, const char *key, const char *words, ...)
{
    if (!error) return false;
    *error = (sgt_error){.line = 0};
    const char *file = from->lens ? from->lens->file : "";
    size_t length = strlen(file), cut = length < sizeof error->file ? 0 : length - sizeof error->file + 1;
    snprintf(error->file, sizeof error->file, "%s", file + cut);
    snprintf(error->key, sizeof error->key, "%s", key);
    error->line = *key ? from->lens->line : 0;
    va_list more;
    va_start(more, words);
    vsnprintf(error->words, sizeof error->words, words, more);
    va_end(more);
    return false;
}

bool sgt_launch_memory(const sgt_launcher *from, sgt_error *error)
{
    return sgt_launch_fail(from, error, "", "no memory");
}

bool sgt_launch_plain(const sgt_launcher *from, const unsigned long long reserved[], size_t count,
                      const char *type, sgt_error *error)
{
    for (size_t i = 0; i < count; i++)
        if (reserved[i]) {
            sgt_launch_fail(from, error, "", "the program asks for a member that %s of sagitta %s has not",
                            type, sgt_version());
            if (error) snprintf(error->key, sizeof error->key, "%s.reserved_[%zu]", type, i);
            return false;
        }
    return true;
}

void *sgt_launch_take(const sgt_launcher *from, size_t count, size_t size)
{
    const sgt_allocator *a = &from->allocator;
    if (count > SIZE_MAX / 2 / size) return NULL;
    return a->resize(a->context, NULL, count ? count * size : size);
}

void sgt_launch_forget(const sgt_launcher *from, void *room)
{
    if (room) from->allocator.resize(from->allocator.context, room, 0);
}

/* ---------------------------------------------------------------- the pupil */

/* Paraxial rays cannot pass an element, and so `key` must be given. */
static bool fail_without_vertex(const sgt_launcher *from, sgt_error *error, const char *key,
                                size_t number, const char *where)
{
    const char *why = from->lens->surface[number - 1].off_axis ? "is tilted or off the axis"
                                                               : "has no vertex curvature";
    return sgt_launch_fail(from, error, key, "needed: element %zu, %s, %s", number, where, why);
}

static bool has_pupil(const sgt_launcher *from, sgt_error *error)
{
    const sgt_lens *l = from->lens;
    const sgt_first_order *o = &from->data;
    static const char infinite[] = "needed: the paraxial image of the stop (element %zu) is at infinity";
    if (isnan(o->entrance_pupil)) {
        size_t bad = o->without_vertex;
        if (bad && bad <= l->stop)
            return fail_without_vertex(from, error, "pupil.distance", bad, "in front of the stop");
        return sgt_launch_fail(from, error, "pupil.distance", infinite, l->stop + 1);
    }
    if (isnan(l->pupil_distance) && l->surface[l->stop].off_axis)
        return fail_without_vertex(from, error, "pupil.distance", l->stop + 1, "the stop");
    if (o->entrance_radius > 0 && isfinite(o->entrance_radius)) return true;
    bool at_object = l->pupil == SGT_PUPIL_OBJECT_NA || l->pupil == SGT_PUPIL_OBJECT_ANGLE;
    if (l->pupil == SGT_PUPIL_NONE)
        return sgt_launch_fail(from, error, "pupil.semi_diameter",
                               "missing: the pupil has no size to send rays through (or give rays with "
                               "--rays FILE)");
    if (at_object && !isfinite(l->object_distance))
        return sgt_launch_fail(from, error, "pupil", "an aperture at the object, but that is at infinity");
    if (l->pupil == SGT_PUPIL_STOP_SIZE && !(l->surface[l->stop].size > 0))
        return sgt_launch_fail(from, error, "pupil.stop_size",
                               "the stop, element %zu, has no semi_diameter and no draw_to", l->stop + 1);
    if (o->without_vertex)
        return fail_without_vertex(from, error, "pupil.semi_diameter", o->without_vertex, "for its size");
    return sgt_launch_fail(from, error, "pupil", "has no size: %s",
                           o->power == 0 ? "the lens has no power" : "the aperture is too wide");
}

/* The z of the rim of an element at y = height in its own frame; NaN: no sag, or not there. */
static double rim_at(const sgt_element *e, double height)
{
    const sgt_surface s = e->surface;
    if (!sgt_is_sag(s)) return (double)NAN;
    sgt_ray line = {.o = {0, height, 0}, .d = {0, 0, 1}, .tmin = -HUGE_VAL, .tmax = HUGE_VAL};
    sgt_hit hit = sgt_intersect(s, line, &(sgt_options){.pick = SGT_NEAR_SEED});
    return hit.status > 0 ? hit.p.z : (double)NAN;
}

/* The z of a plane in front of the pupil and of every surface.  A mirror may send light back to surfaces in
 * front of the first. */
static double front_of(const sgt_launcher *from, double pupil, double radius)
{
    double z = pupil;
    for (size_t i = 0; i < from->lens->count; i++) {
        const sgt_element *e = &from->element[i];
        z = fmin(z, e->pose.origin.z);
        for (int side = -1; side <= 1; side += 2) {
            sgt_vec3 rim = {0, side * e->semi_diameter, rim_at(e, side * e->semi_diameter)};
            z = fmin(z, e->pose.origin.z + out_of3(&e->pose, rim).z); /* fmin ignores a NaN */
        }
    }
    return z - radius;
}

/* ---------------------------------------------------------------- the fields */

/* The direction of a chief ray from its angles in degrees.  (In the y-z plane it is exactly (0, sin, cos).)
 */
static sgt_vec3 direction_at(double x, double y)
{
    if (x == 0) return (sgt_vec3){0, sin(y * TO_RADIANS), cos(y * TO_RADIANS)};
    return unit3((sgt_vec3){tan(x * TO_RADIANS), tan(y * TO_RADIANS), 1});
}

static double degrees_of(double slope) { return atan(slope) / TO_RADIANS; }

/* Sets the slope of the marginal rays of a telecentric object. */
static bool set_cone(const sgt_launcher *from, sgt_field_kind kind, const sgt_lens_field *at, double *cone,
                     sgt_error *error)
{
    const sgt_lens *l = from->lens;
    if (l->pupil != SGT_PUPIL_OBJECT_NA && l->pupil != SGT_PUPIL_OBJECT_ANGLE)
        return sgt_launch_fail(from, error, "pupil",
                               "must be object_na or object_angle, since the object space is telecentric");
    if (kind == SGT_FIELD_ANGLE && (at->x != 0 || at->y != 0))
        return sgt_launch_fail(from, error, "field_type",
                               "of a telecentric object a field is a height: give object_height");
    *cone = l->pupil == SGT_PUPIL_OBJECT_NA ? tan(asin(l->pupil_size / from->before))
                                            : tan(l->pupil_size * TO_RADIANS);
    if (*cone > 0 && isfinite(*cone)) return true;
    return sgt_launch_fail(from, error, "pupil", "has no size: the aperture is too wide");
}

void sgt_beam_point(const sgt_launcher *from, sgt_field_beam *b, double x, double y)
{
    if (b->finite) {
        const sgt_lens *l = from->lens;
        const double tilt = l->object_slope.x * x + l->object_slope.y * y;
        b->object = (sgt_vec3){x, y, l->surface[0].z - l->object_distance + tilt};
        return;
    }
    b->direction = direction_at(x, y);
    /* from (x, y, pupil) back along the direction to the wavefront, s = hypot(dx, dy), c = dz:
     * z = pupil - (x dx + y dy + pupil c - wave) c <= pupil s^2 + a s c + wave c */
    double s = hypot(b->direction.x, b->direction.y), c = b->direction.z;
    b->wave = (b->front - b->pupil * s * s - b->radius * s * c) / c;
}

bool sgt_beam_of_field(const sgt_launcher *from, sgt_field_kind kind, const sgt_lens_field *at,
                       sgt_field_beam *b, sgt_error *error)
{
    const sgt_lens *l = from->lens;
    const sgt_first_order *o = &from->data;
    if (!PLAIN(from, at, "sgt_lens_field", error)) return false;
    if (!l->telecentric && !has_pupil(from, error)) return false;
    const double d = l->object_distance, p = o->entrance_pupil;
    const sgt_vec3 turn = sgt_pose_tilted((sgt_vec3){0, 0, 0}, (sgt_vec3){0, 0, at->angle}).ex;
    *b = (sgt_field_beam){.pupil = l->surface[0].z + p, .radius = o->entrance_radius, .finite = isfinite(d),
                          .shift = {at->dx, at->dy}, .scale = {1 - at->cx, 1 - at->cy},
                          .turn = at->angle == 0 ? (sgt_vec2){1, 0} : (sgt_vec2){turn.x, turn.y}};
    double x = at->x, y = at->y;
    if (kind == SGT_FIELD_ANGLE && !(fabs(x) < 90 && fabs(y) < 90))
        return sgt_launch_fail(from, error, "fields",
                               "angles must be between -90 and 90 degrees, not [%g, %g]", x, y);
    if (!b->finite) b->front = from->any_front ? b->pupil : front_of(from, b->pupil, b->radius);
    if (l->telecentric && !set_cone(from, kind, at, &b->cone, error)) return false;
    if (kind == SGT_FIELD_REAL_IMAGE_HEIGHT) return true;
    if (kind == SGT_FIELD_PARAXIAL_IMAGE_HEIGHT) {
        double by = b->finite ? 1 / o->magnification : o->power / from->before;
        if (!isfinite(by) || by == 0)
            return sgt_launch_fail(from, error, "field_type",
                                   "there is no paraxial image; give --field or --rays");
        x *= by, y *= by;
        if (!b->finite) x = degrees_of(x), y = degrees_of(y);
    } else if (kind == SGT_FIELD_ANGLE && b->finite && b->cone == 0) {
        if (d + p == 0)
            return sgt_launch_fail(from, error, "object.distance", "the object lies in the entrance pupil");
        x = -(d + p) * tan(x * TO_RADIANS), y = -(d + p) * tan(y * TO_RADIANS);
    }
    sgt_beam_point(from, b, x, y);
    if (b->finite && b->object.z > l->surface[0].z)
        return sgt_launch_fail(from, error, "object.slope",
                               "the point [%g, %g] of the object lies behind the first vertex", x, y);
    return true;
}

/* ------------------------------------------------------------------ the rays */

static inline sgt_vec2 vignetted(const sgt_field_beam *b, double x, double y)
{
    double u = b->shift.x + x * b->scale.x, v = b->shift.y + y * b->scale.y;
    if (b->turn.y == 0 && b->turn.x == 1) return (sgt_vec2){u, v};
    return (sgt_vec2){u * b->turn.x - v * b->turn.y, u * b->turn.y + v * b->turn.x};
}

static inline sgt_ray field_ray(const sgt_field_beam *b, double x, double y)
{
    const sgt_vec3 p = {b->radius * x, b->radius * y, b->pupil};
    if (b->cone > 0) return (sgt_ray){.o = b->object, .d = unit3((sgt_vec3){b->cone * x, b->cone * y, 1})};
    if (!b->finite)
        return (sgt_ray){.o = along3(p, b->wave - dot3(p, b->direction), b->direction), .d = b->direction};
    sgt_vec3 d = minus3(p, b->object);
    /* light runs along +z even if the pupil lies in front of the object */
    double length = copysign(length3(d), d.z);
    return (sgt_ray){.o = b->object, .d = {d.x / length, d.y / length, d.z / length}};
}

sgt_vec2 sgt_vignetted(const sgt_field_beam *b, double x, double y) { return vignetted(b, x, y); }

sgt_ray sgt_field_ray(const sgt_field_beam *b, double x, double y) { return field_ray(b, x, y); }

void sgt_launch_unaimed(const sgt_field_beam *beam, size_t count, const sgt_pupil_point at[],
                        double *const o[3], double *const d[3])
{
    const sgt_field_beam b = *beam; /* no column lies in it, so its members are read once */
    for (size_t i = 0; i < count; i++) {
        const sgt_vec2 q = vignetted(&b, at[i].x, at[i].y);
        const sgt_ray ray = field_ray(&b, q.x, q.y);
        o[0][i] = ray.o.x, o[1][i] = ray.o.y, o[2][i] = ray.o.z;
        d[0][i] = ray.d.x, d[1][i] = ray.d.y, d[2][i] = ray.d.z;
    }
}
