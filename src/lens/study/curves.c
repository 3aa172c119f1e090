// SPDX-License-Identifier: MIT
/* curves.c - where rays near a chief ray meet, and how far its image lies from where it should.
 *
 * THE TANGENTIAL PLANE holds the axis and the field: the object's direction, or its point.  The sections
 * along it and across it are those of parabasal.c; where they mix (a lens without symmetry about that
 * plane) a focus is where rays of a section have no distance from the chief ray along it.  The height of the
 * image is told along the plane as it is carried to the image, whose frame may be turned.
 *
 * THE IDEAL HEIGHT from afar is that of a paraxial ray at the focus, n u / P for the slope u: it depends on
 * the slope alone.  For f theta the slope is replaced by the angle.
 *
 * AT THE SURFACE.  If the image surface stands at z in front of the focus, every image on it is scaled by
 * the way of the chief rays from the focus: at height h' and with the slope u' they meet it at h' - u' z.
 * For the slope 1 in front u' is the paraxial angular magnification; from a point at the height 1, at the
 * distance d in front of the first vertex, the slope in front is -1 / (d + entrance pupil).  If the object is
 * telecentric the chief ray comes parallel to the axis, and leaves through the rear focus.
 *
 * AFOCAL.  In place of heights there are the angles of the chief ray from z of the image, and their tangents
 * are compared: without distortion that behind is the paraxial angular magnification times that in front.
 * In place of foci there are vergences, index over distance: 0 is parallel light, positive converges. */
#include "../optics/launch.h"

#include "../optics/parabasal.h"

/* The direction of the field across the axis, and what the image height is in proportion to. */
typedef struct field_way { sgt_vec2 h; double size; } field_way;

static field_way way_of(const sgt_field_beam *b, const sgt_ray *chief, sgt_distortion distortion)
{
    sgt_vec2 v = b->finite ? (sgt_vec2){b->object.x, b->object.y}
                           : (sgt_vec2){chief->d.x / chief->d.z, chief->d.y / chief->d.z};
    double size = hypot(v.x, v.y);
    if (size == 0) return (field_way){{0, 1}, 0};
    const sgt_vec2 h = {v.x / size, v.y / size};
    const bool theta = distortion == SGT_DISTORTION_THETA || distortion == SGT_DISTORTION_THETA_SURFACE;
    return (field_way){h, !b->finite && theta ? atan(size) : size};
}

static double ideal_of(const sgt_field_beam *b, const sgt_first_order *data, double before)
{
    const double index = before == 0 ? 1 : before;
    return b->finite ? data->magnification : data->efl * index;
}

/* The same on the image surface. */
static double ideal_here(const sgt_launcher *from, const sgt_field_beam *b, const sgt_first_order *data,
                         double before)
{
    const sgt_lens *l = from->lens;
    const double there = ideal_of(b, data, before);
    double slope = data->angular_magnification;
    if (b->finite) slope /= -(l->object_distance + data->entrance_pupil);
    if (b->finite && l->telecentric) slope = there / (data->image - data->focus);
    return there - slope * data->image;
}

/* A chief ray of a field, and how it went through a lens at its wavelength. */
typedef struct chief_course {
    const sgt_launcher *from;
    const sgt_field_beam *beam;
    const sgt_element *element;
    double before;
    const sgt_first_order *data;
    const sgt_ray *launch;
    const sgt_passage *passages;
} chief_course;

/* Where the rays near it meet; NULL: not known.  And the direction of the field on the image. */
typedef struct near_rays { const sgt_sections *sections; sgt_vec3 along; } near_rays;

/* The same of an afocal image space: angles in milliradians, and vergences. */
static void tell_angles(const chief_course *c, const field_way *way, const near_rays *near,
                        sgt_field_point *out)
{
    const double MILLI = 1e3, before = c->before;
    const sgt_element *e = c->element;
    const sgt_passage *last = &c->passages[c->from->lens->count - 1];
    const sgt_vec3 d = last->direction, axis = {0, 0, copysign(1, d.z)}, along = near->along;
    double index = before == 0 ? 1 : before;
    for (size_t i = 0; i + 1 < c->from->lens->count; i++)
        if (e[i].index != SGT_MIRROR && e[i].index != 0) index = e[i].index;
    if (near->sections) {
        const double s = near->sections->focus[0], t = near->sections->focus[1];
        out->sagittal = isnan(s) ? 0 : index / s, out->tangential = isnan(t) ? 0 : index / t;
    }
    sgt_ray_end end = {.p = last->hit.p, .d = d, .p_err = out->error}, angles;
    end.d_err = sgt_direction_error(c->from, e, before, c->launch, &end);
    sgt_ends_as_angles(&axis, 1, &end, &angles);
    out->image = (sgt_vec2){angles.p.x, angles.p.y}, out->error = angles.p_err;
    const double slope = (d.x * along.x + d.y * along.y) / hypot(along.x, along.y) / d.z;
    const double ideal = c->beam->finite ? (double)NAN : c->data->angular_magnification * way->size;
    out->ideal = MILLI * atan(ideal);
    if (ideal != 0) out->distortion = (slope - ideal) / ideal;
}

/* The first element, from 1, without the second derivatives that it needs; 0: there is none. */
static size_t lacking(size_t elements, const sgt_element e[], double before, const sgt_ray *chief,
                      const sgt_passage passages[])
{
    const sgt_ray_change change = {.d = {1, 0, 0}};
    sgt_ray_change out;
    for (size_t i = 1; i < elements; i++) { /* the last one bends no light */
        const int lacks = sgt_trace_sensitivity(i, e, before, chief, passages, 1, &change, &out);
        if (lacks & SGT_LACKS_SECOND) return i;
    }
    return 0;
}

/* What the passages of a chief ray tell. */
static void tell_curve(const chief_course *c, sgt_distortion distortion, sgt_field_point *out)
{
    const size_t count = c->from->lens->count;
    const sgt_element *e = c->element;
    const field_way way = way_of(c->beam, c->launch, distortion);
    const sgt_passage *last = &c->passages[count - 1];
    near_rays near = {.along = {way.h.x, way.h.y, 0}};
    sgt_end_error off;
    sgt_parabasal first_order;
    sgt_sections sections;
    sgt_trace_error(count, e, c->before, c->launch, c->passages, &off);
    out->image = (sgt_vec2){last->hit.p.x, last->hit.p.y};
    out->error = off.point + 4 * off.grain;
    if (isnan(out->error)) out->error = HUGE_VAL;
    const sgt_chief_ray chief = {count, e, c->before, c->launch, c->passages, c->beam->finite};
    const bool known =
        sgt_parabasal_about(&chief, (sgt_vec3){way.h.y, -way.h.x, 0}, &first_order, &sections);
    if (!known) out->lacks = lacking(count, e, c->before, c->launch, c->passages);
    if (known) {
        out->sagittal = sections.focus[0] * last->direction.z;
        out->tangential = sections.focus[1] * last->direction.z;
        near = (near_rays){&sections, sections.along[1]};
    }
    const double height = (out->image.x * near.along.x + out->image.y * near.along.y) /
                          hypot(near.along.x, near.along.y);
    if (c->from->lens->afocal) {
        tell_angles(c, &way, &near, out);
        return;
    }
    const bool here =
        distortion == SGT_DISTORTION_TAN_SURFACE || distortion == SGT_DISTORTION_THETA_SURFACE;
    out->ideal = (here ? ideal_here(c->from, c->beam, c->data, c->before)
                       : ideal_of(c->beam, c->data, c->before)) * way.size;
    if (out->ideal != 0) out->distortion = (height - out->ideal) / out->ideal;
}

bool sgt_field_curve(const sgt_launcher *from, const sgt_field_beam *beam, const sgt_element e[],
                     double index_before, const sgt_first_order *data, sgt_distortion distortion,
                     sgt_field_point *out, sgt_error *error)
{
    static const sgt_pupil_point centre = {0, 0, 1};
    const double none = (double)NAN;
    const size_t count = from->lens->count;
    sgt_field_beam b = *beam;
    b.shift = (sgt_vec2){0, 0}, b.scale = (sgt_vec2){1, 1}, b.turn = (sgt_vec2){1, 0};
    *out = (sgt_field_point){.fate = SGT_LOST, .image = {none, none}, .error = none, .tangential = none,
                             .sagittal = none, .ideal = none, .distortion = none};
    sgt_launched chief;
    sgt_passage *passages = sgt_launch_take(from, count, sizeof *passages);
    sgt_element *own = sgt_launch_take(from, 2 * count, sizeof *own), *open = own ? own + count : NULL;
    bool fine = (passages && own) || sgt_launch_memory(from, error);
    if (fine) sgt_launch_ending(count, e, own), own[count - 1].index = 0; /* nor does it reflect totally */
    fine = fine && sgt_launch_rays(from, &b, own, index_before, 1, &centre, &chief, error);
    if (fine) {
        size_t passed = 0;
        if (chief.status == SGT_MET)
            passed = sgt_trace_through(count, own, index_before, &chief.ray, open, passages, &out->fate);
        out->aimed = chief.status, out->within = chief.within;
        out->element = passed < count ? passed : count - 1;
        const chief_course c = {from, &b, open, index_before, data, &chief.ray, passages};
        if (passed == count) tell_curve(&c, distortion, out);
    }
    sgt_launch_forget(from, own);
    sgt_launch_forget(from, passages);
    return fine;
}
