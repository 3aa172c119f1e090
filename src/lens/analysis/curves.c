/* curves.c - where rays near a chief ray meet, and how far its image lies from where it should.
 *
 * THE TANGENTIAL PLANE holds the axis and the field: the object's direction, or its point.  The sections
 * along it and across it are those of parabasal.c; where they mix (a lens without symmetry about that
 * plane) a focus is where a ray fan of the section has no slope.
 *
 * THE IDEAL HEIGHT from afar is that of a paraxial ray at the focus, n u / P for the slope u: it depends on
 * the slope alone.  For f theta the slope is replaced by the angle. */
#include "launch.h"

#include "../parabasal.h"

/* The direction of the field across the axis, and what the image height is in proportion to. */
typedef struct field_way { sgt_vec2 h; double size; } field_way;

static field_way way_of(const sgt_field_beam *b, const sgt_ray *chief, sgt_distortion distortion)
{
    sgt_vec2 v = b->finite ? (sgt_vec2){b->object.x, b->object.y}
                           : (sgt_vec2){chief->d.x / chief->d.z, chief->d.y / chief->d.z};
    double size = hypot(v.x, v.y);
    if (size == 0) return (field_way){{0, 1}, 0};
    const sgt_vec2 h = {v.x / size, v.y / size};
    return (field_way){h, !b->finite && distortion == SGT_DISTORTION_THETA ? atan(size) : size};
}

static double ideal_of(const sgt_launcher *from, const sgt_field_beam *b, const sgt_first_order *data)
{
    const double index = from->before == 0 ? 1 : from->before;
    return b->finite ? data->magnification : data->efl * index;
}

/* The same of elements that clip nothing; room: a passage for each. */
static bool curve_of(const sgt_launcher *from, const sgt_field_beam *b, const sgt_element e[],
                     double index_before, const sgt_first_order *data, sgt_distortion distortion,
                     sgt_passage passages[], sgt_field_point *out)
{
    const double none = (double)NAN;
    const size_t count = from->lens->count;
    const sgt_pupil_point centre = {0, 0, 1};
    *out = (sgt_field_point){.fate = SGT_LOST, .image = {none, none}, .error = none, .tangential = none,
                             .sagittal = none, .ideal = none, .distortion = none};
    sgt_launched chief;
    if (!sgt_launch_rays(from, b, e, index_before, 1, &centre, &chief)) return false;
    sgt_ray ray = chief.ray;
    size_t passed = 0;
    if (chief.status == SGT_MET) passed = sgt_trace(count, e, index_before, &ray, passages, &out->fate, NULL);
    out->element = passed < count ? passed : count - 1;
    if (passed == count) {
        const field_way way = way_of(b, &chief.ray, distortion);
        const sgt_passage *last = &passages[count - 1];
        sgt_end_error off;
        sgt_parabasal near;
        double foci[2];
        sgt_trace_error(count, e, index_before, &chief.ray, passages, &off);
        out->image = (sgt_vec2){last->hit.p.x, last->hit.p.y};
        out->error = off.point + 4 * off.grain;
        if (isnan(out->error)) out->error = HUGE_VAL;
        if (sgt_parabasal_about((sgt_vec3){way.h.y, -way.h.x, 0}, count, e, index_before, b->finite,
                                &chief.ray, passages, &near, foci))
            out->sagittal = foci[0] * last->direction.z, out->tangential = foci[1] * last->direction.z;
        out->ideal = ideal_of(from, b, data) * way.size;
        if (out->ideal != 0)
            out->distortion =
                (out->image.x * way.h.x + out->image.y * way.h.y - out->ideal) / out->ideal;
    }
    return true;
}

bool sgt_field_curve(const sgt_launcher *from, const sgt_field_beam *b, const sgt_element e[],
                     double index_before, const sgt_first_order *data, sgt_distortion distortion,
                     sgt_field_point *out)
{
    sgt_passage *passages = sgt_launch_take(from, from->lens->count, sizeof *passages);
    sgt_element *open = sgt_open_elements(from, e);
    bool fine = passages && open && curve_of(from, b, open, index_before, data, distortion, passages, out);
    sgt_launch_forget(from, open);
    sgt_launch_forget(from, passages);
    return fine;
}
