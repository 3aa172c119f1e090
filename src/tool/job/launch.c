/* launch.c - the entrance pupil, and the rays of a field through it.
 *
 * PARAXIAL RAYS.  Two are traced from the first vertex, with heights y and slopes u.  Refraction:
 * n'u' = n u - y C (n' - n).  Transfer: y' = y + t u'.  After a mirror the index changes its
 * sign, as the thickness does (Welford 1986, Aberrations of Optical Systems, 3.2).  One ray
 * starts with y = 1, u = 0, the other with y = 0, u = 1.  Tilts, decentres and breaks do not
 * count: vertices stand on the unfolded axis.
 *
 * THE PUPIL is the image of the stop's centre in object space.  The rays meet the stop at the
 * heights A and B.  A ray with y = -p u crosses the axis at z = p and meets the stop at height
 * u (B - p A).  So it goes through the stop's centre if p = B / A.  If A = 0 the pupil is at
 * infinity.  A stop of the semi-diameter r is seen from in front as one of r / |A|.
 *
 * ITS SIZE may be given by the light behind the lens.  The first ray leaves with n'u' = -P, the
 * power; the focal length is 1 / P.  From an axial object at the distance D the marginal ray
 * has y = D u, and leaves with n'u' = K u.  Its working F-number is 1 / (2 |K u|).
 *
 * A FIELD of the angles a, b: its chief ray, through the pupil's centre, has the slopes tan a in x
 * and tan b in y, so a positive field climbs.  An object at a finite distance D is then at height
 * -(D + p) tan.  A paraxial image height h: the slope is h P / n from afar (n in front); else the
 * object is at h / m, with m = n / K, the magnification (Lagrange's invariant).
 *
 * OBJECT AT INFINITY: the rays start on one wavefront, a plane at right angles to their
 * direction, so that their optical path lengths can be compared.  The plane lies in front of
 * the pupil and of all surfaces. */
#include "launch.h"

#include "../show/frame.h"
#include "../show/profile.h"

#include <math.h>

static const double RADIAN = 0.017453292519943295; /* pi / 180 */
static const double AT_INFINITY = 0x1p-40;         /* |A| below this is rounding: A starts as 1 */
static const double SOFT_EDGE = 1 + 0x1p-44;       /* of r^2, as for the library's rims */

/* The two rays: heights, slopes, and the medium and the z at which they are. */
typedef struct paraxial { double y[2], u[2], index, z; } paraxial;

static void go_to(paraxial *p, double z)
{
    for (int r = 0; r < 2; r++) p->y[r] += (z - p->z) * p->u[r];
    p->z = z;
}

/* Through the first n elements.  An element that cannot be passed is an error; key: what to give instead;
 * where: of the element, for the message. */
static paraxial through(const lens *l, size_t n, const char *key, const char *where)
{
    const double step = (l->of->pupil == SGT_PUPIL_RADIUS ? l->of->pupil_size : 0x1p-10) *
                        0x1p-30; /* so small that (C step)^2 is negligible */
    paraxial p = {.y = {1, 0}, .u = {0, 1}, .index = l->index_before, .z = l->surface[0].z};
    for (size_t i = 0; i < n; i++) {
        const sgt_lens_surface *s = &l->surface[i];
        if (s->off_axis)
            lens_fail(l, key, "needed: element %zu, %s, is tilted or off the axis", i + 1, where);
        go_to(&p, s->z);
        double c = profile_curvature(&l->element[i], step);
        if (isnan(c)) lens_fail(l, key, "needed: element %zu, %s, has no vertex curvature", i + 1, where);
        double behind = copysign(l->index[i], s->mirror ? -p.index : p.index);
        for (int r = 0; r < 2; r++) p.u[r] = (p.index * p.u[r] - p.y[r] * c * (behind - p.index)) / behind;
        p.index = behind;
    }
    return p;
}

/* The rays in the plane of the stop. */
static paraxial at_stop(const lens *l)
{
    size_t stop = l->of->stop;
    paraxial p = through(l, stop, "pupil.distance", "in front of the stop");
    if (l->surface[stop].off_axis)
        lens_fail(l, "pupil.distance", "needed: element %zu, the stop, is tilted or off the axis", stop + 1);
    go_to(&p, l->surface[stop].z);
    return p;
}

/* The distance of the entrance pupil from the first vertex, along z. */
static double pupil_distance(const lens *l)
{
    if (!isnan(l->of->pupil_distance)) return l->of->pupil_distance;
    paraxial stop = at_stop(l);
    double p = stop.y[1] / stop.y[0];
    if (!(fabs(stop.y[0]) > AT_INFINITY) || !isfinite(p))
        lens_fail(l, "pupil.distance", "needed: the paraxial image of the stop (element %zu) is at infinity",
                  l->of->stop + 1);
    return p;
}

/* The power of the lens, and the K of its head. */
static double power_of(const paraxial *p) { return -p->index * p->u[0]; }
static double k_of(const lens *l, const paraxial *p)
{
    return p->index * (p->u[0] * l->of->object_distance + p->u[1]);
}

static double power_or_fail(const lens *l, const paraxial *p, const char *key)
{
    double power = power_of(p);
    if (!(fabs(power) > 0)) lens_fail(l, key, "the lens has no power, so this says nothing");
    return power;
}

/* The semi-diameter of the entrance pupil.  p: its distance from the first vertex. */
static double pupil_radius(const lens *l, double p)
{
    const sgt_lens *of = l->of;
    const double d = of->object_distance, size = of->pupil_size;
    const char *instead = "pupil.semi_diameter", *where = "for the F-number";
    paraxial all;
    double slope = (double)NAN, radius = (double)NAN;
    switch (of->pupil) {
    case SGT_PUPIL_NONE:
        lens_fail(l, instead,
                  "missing: the pupil has no size to send rays through (or give rays with --rays FILE)");
    case SGT_PUPIL_RADIUS: return size;
    case SGT_PUPIL_WORKING_F_NUMBER:
        all = through(l, l->count, instead, where);
        if (isfinite(d)) {
            slope = 1 / (2 * size * fabs(k_of(l, &all)));
            break;
        } /* from afar it is the other one */
        return fabs(1 / power_or_fail(l, &all, "pupil.working_f_number")) / (2 * size);
    case SGT_PUPIL_F_NUMBER:
        all = through(l, l->count, instead, where);
        return fabs(1 / power_or_fail(l, &all, "pupil.f_number")) / (2 * size);
    case SGT_PUPIL_OBJECT_NA: slope = tan(asin(size / l->index_before)); break;
    case SGT_PUPIL_OBJECT_ANGLE: slope = tan(size * RADIAN); break;
    case SGT_PUPIL_STOP_SIZE:
        if (!(l->surface[of->stop].size > 0))
            lens_fail(l, "pupil.stop_size", "the stop, element %zu, has no semi_diameter and no draw_to",
                      of->stop + 1);
        return l->surface[of->stop].size / fabs(at_stop(l).y[0]);
    }
    if (of->pupil != SGT_PUPIL_WORKING_F_NUMBER && !isfinite(d))
        lens_fail(l, "pupil", "an aperture at the object, but that is at infinity");
    radius = slope * fabs(d + p);
    if (!(radius > 0 && isfinite(radius))) lens_fail(l, "pupil", "has no size: the aperture is too wide");
    return radius;
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

typedef struct beam {
    double pupil, radius, wave;    /* z of the pupil; the wavefront is the plane direction . p = wave */
    sgt_vec3 direction;    /* of the chief ray */
    bool finite;
    sgt_vec3 object;       /* if finite: the point the rays come from */
} beam;

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

static beam beam_of(const lens *l, sgt_field_kind kind, sgt_lens_field at)
{
    const double d = l->of->object_distance, first = l->surface[0].z, p = pupil_distance(l);
    beam b = {.pupil = first + p, .radius = pupil_radius(l, p), .finite = isfinite(d)};
    double hx = at.x, hy = at.y;
    if (kind == SGT_FIELD_REAL_IMAGE_HEIGHT)
        lens_fail(l, "field_type",
                  "rays for a real image height need aiming, which is not there yet; give --field or --rays");
    if (kind == SGT_FIELD_PARAXIAL_IMAGE_HEIGHT) {
        paraxial all = through(l, l->count, "field_type: angle", "for the image height");
        double by = b.finite ? k_of(l, &all) / l->index_before
                             : power_or_fail(l, &all, "field_type") / l->index_before;
        hx *= by, hy *= by;
        if (!b.finite) hx = degrees_of(hx), hy = degrees_of(hy), kind = SGT_FIELD_ANGLE;
    } else if (kind == SGT_FIELD_ANGLE && b.finite) {
        if (d + p == 0) lens_fail(l, "object.distance", "the object lies in the entrance pupil");
        hx = -(d + p) * tan(hx * RADIAN), hy = -(d + p) * tan(hy * RADIAN);
    }
    if (b.finite) {
        b.object = (sgt_vec3){hx, hy, first - d};
        return b;
    }
    b.direction = direction_at(hx, hy);
    /* from (x, y, pupil) back along the direction to the wavefront, s = hypot(dx, dy), c = dz:
     * z = pupil - (x dx + y dy + pupil c - wave) c <= pupil s^2 + a s c + wave c */
    double s = hypot(b.direction.x, b.direction.y), c = b.direction.z;
    b.wave = (front(l, b.pupil, b.radius) - b.pupil * s * s - b.radius * s * c) / c;
    return b;
}

static sgt_ray ray_through(const beam *b, double x, double y)
{
    sgt_vec3 p = {x, y, b->pupil};
    if (!b->finite)
        return (sgt_ray){.o = vector_along(p, b->direction, b->wave - vector_dot(p, b->direction)),
                         .d = b->direction};
    sgt_vec3 d = vector_minus(p, b->object);
    /* light runs along +z even if the pupil lies in front of the object */
    double length = copysign(vector_length(d), d.z);
    return (sgt_ray){.o = b->object, .d = {d.x / length, d.y / length, d.z / length}};
}

void launch_field(ray_list *list, const lens *l, size_t field, sgt_field_kind kind, sgt_lens_field at,
                  pupil_pattern pattern, long n)
{
    beam b = beam_of(l, kind, at);
    double a = b.radius;
    /* quotients of whole numbers: the rays are symmetric to the last bit */
    double last = n > 1 ? (double)(n - 1) : 1;
    for (long i = 0; i < (pattern == PUPIL_GRID ? n : 1); i++)
        for (long j = 0; j < n; j++) {
            double x = pattern == PUPIL_GRID ? (double)(2 * i - (n - 1)) / last : 0;
            double y = (double)(2 * j - (n - 1)) / last;
            if (x * x + y * y > SOFT_EDGE) continue;
            rays_add(list, (launch){.ray = ray_through(&b, a * x, a * y), .number = list->count,
                                    .field = field, .px = x, .py = y});
        }
}
