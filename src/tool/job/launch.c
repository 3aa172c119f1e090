/* launch.c - the entrance pupil, and the rays of a field through it.
 *
 * THE PUPIL is the image of the stop's centre in object space.  Trace two paraxial rays
 * from the first vertex to the stop, with heights y and slopes u.  Refraction: n'u' = n u -
 * y C (n' - n).  Transfer: y' = y + t u'.  After a mirror the index changes its sign, as the
 * thickness does (Welford 1986, Aberrations of Optical Systems, 3.2).  One ray starts with
 * y = 1, u = 0 and meets the stop at height A; the other with y = 0, u = 1 and meets it at
 * B.  A ray with y = -p u crosses the axis at z = p and meets the stop at height u (B - p A).
 * So it goes through the stop's centre if p = B / A.  If A = 0 the pupil is at infinity.
 *
 * A FIELD of a degrees: its chief ray, through the pupil's centre, lies in the y-z plane and
 * runs along (0, sin a, cos a), so a positive field climbs toward +y.  An object at a finite
 * distance D is then at height -(D + p) tan a.
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

/* The distance of the entrance pupil from the first vertex, along z. */
static double pupil_distance(const lens *l)
{
    if (!isnan(l->pupil_distance)) return l->pupil_distance;
    const double step = l->pupil_semi_diameter * 0x1p-30; /* so small that (C step)^2 is negligible */
    double y[2] = {1, 0}, u[2] = {0, 1}, index = l->object_index, z = l->surface[0].z;
    for (size_t i = 0; i <= l->stop; i++) {
        const lens_surface *s = &l->surface[i];
        if (s->off_axis)
            document_fail(&l->source, l->source.root, "pupil.distance",
                          "needed: element %zu, which is not behind the stop, is tilted or off the axis",
                          i + 1);
        for (int r = 0; r < 2; r++) y[r] += (s->z - z) * u[r];
        z = s->z;
        if (i == l->stop) break;
        double c = profile_curvature(&l->element[i], step);
        if (isnan(c))
            document_fail(&l->source, l->source.root, "pupil.distance",
                          "needed: element %zu, in front of the stop, has no vertex curvature", i + 1);
        double behind = copysign(s->index, s->mirror ? -index : index);
        for (int r = 0; r < 2; r++) u[r] = (index * u[r] - y[r] * c * (behind - index)) / behind;
        index = behind;
    }
    double p = y[1] / y[0];
    if (!(fabs(y[0]) > AT_INFINITY) || !isfinite(p))
        document_fail(&l->source, l->source.root, "pupil.distance",
                      "needed: the paraxial image of the stop (element %zu) is at infinity", l->stop + 1);
    return p;
}

/* The z of a plane in front of the pupil and of every surface.  A mirror may send light back to surfaces in
 * front of the first. */
static double front(const lens *l, double pupil)
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
    return z - l->pupil_semi_diameter;
}

typedef struct beam {
    double pupil, wave;    /* z of the pupil; the wavefront is the plane direction . p = wave */
    sgt_vec3 direction;    /* of the chief ray */
    bool finite;
    sgt_vec3 object;       /* if finite: the point the rays come from */
} beam;

static beam beam_of(const lens *l, double degrees)
{
    double angle = degrees * RADIAN, a = l->pupil_semi_diameter;
    beam b = {.pupil = l->surface[0].z + pupil_distance(l), .finite = isfinite(l->object_distance)};
    b.direction = (sgt_vec3){0, sin(angle), cos(angle)};
    if (b.finite) {
        double z = l->surface[0].z - l->object_distance;
        b.object = (sgt_vec3){0, -(b.pupil - z) * tan(angle), z};
        if (b.pupil == z)
            document_fail(&l->source, l->source.root, "object.distance",
                          "the object lies in the entrance pupil");
    }
    /* from (0, y, pupil) back along the direction to the wavefront:
     * z = pupil - (y sin + pupil cos - wave) cos <= pupil sin^2 + a |sin| cos + wave cos */
    double s = b.direction.y, c = b.direction.z;
    b.wave = (front(l, b.pupil) - b.pupil * s * s - a * fabs(s) * c) / c;
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

void launch_field(ray_list *list, const lens *l, size_t field, double degrees, pupil_pattern pattern, long n)
{
    if (isnan(l->pupil_semi_diameter))
        document_fail(&l->source, l->source.root, "pupil.semi_diameter",
                      "missing: the pupil has no size to send rays through (or give rays with --rays FILE)");
    beam b = beam_of(l, degrees);
    double a = l->pupil_semi_diameter;
    /* quotients of whole numbers: the rays are symmetric to the last bit */
    double last = n > 1 ? (double)(n - 1) : 1;
    for (long i = 0; i < (pattern == PUPIL_GRID ? n : 1); i++)
        for (long j = 0; j < n; j++) {
            double x = pattern == PUPIL_GRID ? (double)(2 * i - (n - 1)) / last : 0;
            double y = (double)(2 * j - (n - 1)) / last;
            if (x * x + y * y > SOFT_EDGE) continue;
            rays_add(list,
                     (launch){.ray = ray_through(&b, a * x, a * y), .number = list->count, .field = field});
        }
}
