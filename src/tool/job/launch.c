/* launch.c - the entrance pupil, and the rays of a field through it.
 *
 * THE PUPIL is that of the first-order data (sgt_lens_first_order): at the primary wavelength, the
 * paraxial image of the stop in object space, of the size that the lens defines.
 *
 * A FIELD of the angles a, b: its chief ray, through the pupil's centre, has the slopes tan a in x
 * and tan b in y, so a positive field climbs.  An object at a finite distance D is then at height
 * -(D + p) tan.  A paraxial image height h: the slope is h P / n from afar (P the power, n the
 * index in front); else the object is at h / m, m the magnification.
 *
 * AIMING at the stop, and fields by real image heights: aim.c.
 *
 * OBJECT AT INFINITY: the rays start on one wavefront, a plane at right angles to their
 * direction, so that their optical path lengths can be compared.  The plane lies in front of
 * the pupil and of all surfaces. */
#include "launch.h"

#include "aim.h"
#include "../base/memory.h"
#include "../show/frame.h"
#include "../show/profile.h"

#include <math.h>

static const double RADIAN = 0.017453292519943295; /* pi / 180 */

static sgt_first_order first_order_of(const lens *l)
{
    sgt_first_order o;
    sgt_lens_error e;
    if (!sgt_lens_first_order(l->of, l->wavelength, &o, NULL, NULL, &e)) lens_refuse(&e);
    return o;
}

/* Ends the command: paraxial rays cannot pass an element, and so `key` must be given. */
_Noreturn static void fail_without_vertex(const lens *l, const char *key, size_t number, const char *where)
{
    const char *why = l->surface[number - 1].off_axis ? "is tilted or off the axis"
                                                      : "has no vertex curvature";
    lens_fail(l, key, "needed: element %zu, %s, %s", number, where, why);
}

static void require_pupil(const lens *l, const sgt_first_order *o)
{
    const sgt_lens *of = l->of;
    static const char infinite[] = "needed: the paraxial image of the stop (element %zu) is at infinity";
    if (isnan(o->entrance_pupil)) {
        size_t bad = o->without_vertex;
        if (bad && bad <= of->stop) fail_without_vertex(l, "pupil.distance", bad, "in front of the stop");
        lens_fail(l, "pupil.distance", infinite, of->stop + 1);
    }
    if (isnan(of->pupil_distance) && l->surface[of->stop].off_axis)
        fail_without_vertex(l, "pupil.distance", of->stop + 1, "the stop");
    if (o->entrance_radius > 0 && isfinite(o->entrance_radius)) return;
    bool at_object = of->pupil == SGT_PUPIL_OBJECT_NA || of->pupil == SGT_PUPIL_OBJECT_ANGLE;
    if (of->pupil == SGT_PUPIL_NONE)
        lens_fail(l, "pupil.semi_diameter",
                  "missing: the pupil has no size to send rays through (or give rays with --rays FILE)");
    if (at_object && !isfinite(of->object_distance))
        lens_fail(l, "pupil", "an aperture at the object, but that is at infinity");
    if (of->pupil == SGT_PUPIL_STOP_SIZE && !(l->surface[of->stop].size > 0))
        lens_fail(l, "pupil.stop_size", "the stop, element %zu, has no semi_diameter and no draw_to",
                  of->stop + 1);
    if (o->without_vertex) fail_without_vertex(l, "pupil.semi_diameter", o->without_vertex, "for its size");
    lens_fail(l, "pupil", "has no size: %s",
              o->power == 0 ? "the lens has no power" : "the aperture is too wide");
}

/* The z of a plane in front of the pupil and of every surface.  A mirror may send light back to surfaces in
 * front of the first. */
static double front(const lens *l, double pupil, double radius)
{
    double z = pupil;
    for (size_t i = 0; i < l->count; i++) {
        const sgt_element *e = &l->element[i];
        z = fmin(z, e->pose.origin.z);
        for (int side = -1; side <= 1; side += 2) {
            sgt_vec3 rim = {0, side * e->semi_diameter, profile_sag(e, 0, side * e->semi_diameter)};
            z = fmin(z, frame_point_out(&e->pose, rim).z); /* fmin ignores a NaN */
        }
    }
    return z - radius;
}

/* The direction of a chief ray from its angles in degrees.  (In the y-z plane it is exactly (0, sin, cos).)
 */
static sgt_vec3 direction_at(double x, double y)
{
    if (x == 0) return (sgt_vec3){0, sin(y * RADIAN), cos(y * RADIAN)};
    sgt_vec3 d = {tan(x * RADIAN), tan(y * RADIAN), 1};
    double length = vector_length(d);
    return (sgt_vec3){d.x / length, d.y / length, d.z / length};
}

static double degrees_of(double slope) { return atan(slope) / RADIAN; }

/* The slope of the marginal rays of a telecentric object. */
static double cone_of(const lens *l, sgt_field_kind kind, sgt_lens_field at)
{
    const sgt_lens *of = l->of;
    if (of->pupil != SGT_PUPIL_OBJECT_NA && of->pupil != SGT_PUPIL_OBJECT_ANGLE)
        lens_fail(l, "pupil", "must be object_na or object_angle, since the object space is telecentric");
    if (kind == SGT_FIELD_ANGLE && (at.x != 0 || at.y != 0))
        lens_fail(l, "field_type", "of a telecentric object a field is a height: give object_height");
    double slope = of->pupil == SGT_PUPIL_OBJECT_NA ? tan(asin(of->pupil_size / l->index_before))
                                                    : tan(of->pupil_size * RADIAN);
    if (!(slope > 0 && isfinite(slope))) lens_fail(l, "pupil", "has no size: the aperture is too wide");
    return slope;
}

void beam_point(beam *b, const lens *l, double x, double y)
{
    if (b->finite) {
        b->object = (sgt_vec3){x, y, l->surface[0].z - l->of->object_distance};
        return;
    }
    b->direction = direction_at(x, y);
    /* from (x, y, pupil) back along the direction to the wavefront, s = hypot(dx, dy), c = dz:
     * z = pupil - (x dx + y dy + pupil c - wave) c <= pupil s^2 + a s c + wave c */
    double s = hypot(b->direction.x, b->direction.y), c = b->direction.z;
    b->wave = (b->front - b->pupil * s * s - b->radius * s * c) / c;
}

static beam beam_of(const launch_how *how, sgt_field_kind kind, sgt_lens_field at)
{
    const lens *l = &how->lens;
    const sgt_first_order *o = &how->data;
    if (!l->of->telecentric) require_pupil(l, o);
    const double d = l->of->object_distance, first = l->surface[0].z, p = o->entrance_pupil;
    beam b = {.pupil = first + p, .radius = o->entrance_radius, .finite = isfinite(d)};
    double hx = at.x, hy = at.y;
    if (!b.finite) b.front = front(l, b.pupil, b.radius);
    if (l->of->telecentric) b.cone = cone_of(l, kind, at);
    if (kind == SGT_FIELD_REAL_IMAGE_HEIGHT) {
        aim_field(how, &b, at);
        return b;
    }
    if (kind == SGT_FIELD_PARAXIAL_IMAGE_HEIGHT) {
        double by = b.finite ? 1 / o->magnification : o->power / l->index_before;
        if (!isfinite(by) || by == 0)
            lens_fail(l, "field_type", "there is no paraxial image; give --field or --rays");
        hx *= by, hy *= by;
        if (!b.finite) hx = degrees_of(hx), hy = degrees_of(hy);
    } else if (kind == SGT_FIELD_ANGLE && b.finite && b.cone == 0) {
        if (d + p == 0) lens_fail(l, "object.distance", "the object lies in the entrance pupil");
        hx = -(d + p) * tan(hx * RADIAN), hy = -(d + p) * tan(hy * RADIAN);
    }
    beam_point(&b, l, hx, hy);
    return b;
}

/* x, y: in the unit circle of the pupil. */
sgt_ray beam_ray(const beam *b, double x, double y)
{
    sgt_vec3 p = {b->radius * x, b->radius * y, b->pupil};
    if (b->cone > 0) {
        sgt_vec3 slopes = {b->cone * x, b->cone * y, 1};
        double length = vector_length(slopes);
        return (sgt_ray){.o = b->object, .d = {slopes.x / length, slopes.y / length, 1 / length}};
    }
    if (!b->finite)
        return (sgt_ray){.o = vector_along(p, b->direction, b->wave - vector_dot(p, b->direction)),
                         .d = b->direction};
    sgt_vec3 d = vector_minus(p, b->object);
    /* light runs along +z even if the pupil lies in front of the object */
    double length = copysign(vector_length(d), d.z);
    return (sgt_ray){.o = b->object, .d = {d.x / length, d.y / length, d.z / length}};
}

launch_pattern launch_points(sgt_pattern pattern, size_t n, uint64_t seed)
{
    size_t count = sgt_pupil_points(pattern, n, seed, 0, NULL);
    sgt_pupil_point *at = memory_take(count, sizeof *at);
    sgt_pupil_points(pattern, n, seed, count, at);
    return (launch_pattern){count, at};
}

launch_how launch_by(const lens *l, launch_aim aim)
{
    launch_how how = {.lens = *l, .data = first_order_of(l), .aim = aim};
    if (aim != LAUNCH_AT_PUPIL && !l->of->telecentric) how.stop_radius = aim_stop_radius(&how);
    return how;
}

beam launch_axial_beam(const launch_how *how)
{
    return beam_of(how, SGT_FIELD_ANGLE, (sgt_lens_field){.y = 0});
}

void launch_field(ray_list *list, launch_how *how, const lens *traced, size_t field, sgt_field_kind kind,
                  sgt_lens_field at, const launch_pattern *points)
{
    beam b = beam_of(how, kind, at);
    const sgt_vec3 turn = sgt_pose_tilted((sgt_vec3){0, 0, 0}, (sgt_vec3){0, 0, at.angle}).ex;
    const bool turned = turn.x != 0 || turn.y != 0, aimed = how->aim != LAUNCH_AT_PUPIL && b.cone == 0;
    aim_start start = {.known = false};
    for (size_t i = 0; i < points->count; i++) {
        double x = points->at[i].x, y = points->at[i].y;
        double u = at.dx + x * (1 - at.cx), v = at.dy + y * (1 - at.cy);
        sgt_vec2 q = turned ? (sgt_vec2){u * turn.x - v * turn.y, u * turn.y + v * turn.x} : (sgt_vec2){u, v};
        launch l = {.number = how->count++, .field = field, .px = x, .py = y};
        if (!aimed) l.ray = beam_ray(&b, q.x, q.y);
        else if (!aim_ray(how, traced, &b, q, &l, &start)) continue;
        rays_add(list, l);
    }
}
