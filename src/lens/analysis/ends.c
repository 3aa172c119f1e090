/* ends.c - where the rays of a field end, and how sure that is.
 *
 * THE LAUNCH RAY is itself rounded.  Each of its numbers is off by some ulps: for the point at the end
 * that is a few times `grain` (sgt_end_error).  A ray from afar starts on a plane in space, at
 * p + (wave - p . d) d; what rounding does to that along d is in the path at once, and no more than
 * LAUNCH ulps of the numbers that go into it.  With ideal lenses the rest counts as well: `path_grain`.
 *
 * THE ERROR OF A DIRECTION.  A plane stands across the ray at the distance L behind its end.  The exact ray
 * meets the last element within p_err of the end, and that plane within the error there (sgt_trace_error):
 * so the angle between both rays is at most the sum of both over L.  L is FAR times the lens, and the plane's
 * own rounding is of the order of u.
 *
 * THE LAST ELEMENT is where rays end.  An ideal lens there would add its own path to theirs, though the
 * light that it bends is looked at no more: so it counts as the plane that it stands on.
 *
 * WHATEVER CLIPS.  Sizes and references are those of rays through the surfaces, and do not depend on which
 * of them are obscured.  But a semi_diameter has a say in which root is meant (sgt_trace).  It clips a ray
 * only where no root lies inside, and then the root is the one without it.  So a ray that it clips is traced
 * again without that semi_diameter alone.  The items of an aperture have no say in the root. */
#include "launch.h"

static const double ULP = 0x1p-53, LAUNCH = 6, GRAINS = 4;

static double launch_error(const sgt_field_beam *b, const sgt_ray *ray, double index)
{
    if (b->finite) return 0;
    return LAUNCH * ULP * index * (length3(ray->o) + fabs(b->wave) + fabs(b->pupil));
}

double sgt_direction_error(const sgt_launcher *from, const sgt_element e[], double before,
                           const sgt_ray *launch, const sgt_ray_end *end)
{
    static const sgt_conic flat;
    const double FAR = 0x1p10;
    const size_t count = from->lens->count;
    const sgt_pose *pose = &e[count - 1].pose;
    double away = (double)NAN, length = length3(end->p) + fabs(from->lens->surface[0].z);
    sgt_element *more = sgt_launch_take(from, count + 1, sizeof *more);
    sgt_passage *passages = sgt_launch_take(from, count + 1, sizeof *passages);
    for (size_t i = 0; i < count; i++) length += length3(e[i].pose.origin);
    length = FAR * (length > 0 ? length : 1);
    if (more && passages) {
        sgt_end_error off;
        sgt_ray ray = *launch;
        const sgt_vec3 d = out_of3(pose, end->d), at = along3(pose->origin, 1, out_of3(pose, end->p));
        const sgt_vec3 x = fabs(d.x) < 0.5 ? (sgt_vec3){1, 0, 0} : (sgt_vec3){0, 1, 0};
        const sgt_vec3 ey = unit3(cross3(d, x)), ex = cross3(ey, d);
        for (size_t i = 0; i < count; i++) more[i] = e[i];
        more[count - 1].index = 0, more[count - 1].phase = NULL; /* the last one bends no light here */
        more[count] = (sgt_element){.surface = {&sgt_conic_ops, &flat},
                                    .pose = {.origin = along3(at, length, d), .ex = ex, .ey = ey, .ez = d}};
        if (sgt_trace(count + 1, more, before, &ray, passages, NULL, NULL) == count + 1 &&
            sgt_trace_error(count + 1, more, before, launch, passages, &off))
            away = off.point + GRAINS * off.grain;
    }
    sgt_launch_forget(from, more);
    sgt_launch_forget(from, passages);
    return isnan(away) ? HUGE_VAL : 1.01 * (away + end->p_err) / length;
}

static void follow(const sgt_launcher *from, const sgt_field_beam *b, const sgt_element e[], double before,
                   const sgt_launched *l, const sgt_options *opt, sgt_passage passages[], sgt_ray_end *out)
{
    const size_t count = from->lens->count;
    sgt_ray ray = l->ray;
    size_t passed = sgt_trace(count, e, before, &ray, passages, &out->fate, opt);
    out->element = passed < count ? passed : count - 1;
    const sgt_passage *last = &passages[out->element];
    out->status = last->hit.status, out->folded = l->folded;
    out->proven = passed == count;
    sgt_vec3 d = l->ray.d, in = d;
    for (size_t i = 0; i <= out->element; i++) {
        const sgt_hit *hit = &passages[i].hit;
        in = into3(&e[i].pose, d);
        if (hit->status > 0)
            out->condition = fmax(out->condition, length3(hit->n) * length3(in) / fabs(dot3(hit->n, in)));
        d = out_of3(&e[i].pose, passages[i].direction);
        out->evals += hit->evals;
        out->t_err = fmax(out->t_err, hit->t_err);
        out->proven = out->proven && hit->status == SGT_HIT;
    }
    if (passed < count) return;
    sgt_end_error off;
    sgt_trace_error(count, e, before, &l->ray, passages, &off);
    out->p = last->hit.p, out->d = in, out->opl = last->opl;
    out->p_err = off.point + GRAINS * off.grain;
    if (isnan(out->p_err)) out->p_err = HUGE_VAL;
    out->opl_err = off.path + GRAINS * off.path_grain + launch_error(b, &l->ray, before == 0 ? 1 : before);
    if (isnan(out->opl_err)) out->opl_err = HUGE_VAL;
    if (from->lens->afocal) out->d_err = sgt_direction_error(from, e, before, &l->ray, out);
}

static sgt_ray_end not_traced(const sgt_pupil_point *at, const sgt_launched *l)
{
    const double none = (double)NAN;
    const sgt_vec3 nowhere = {none, none, none};
    return (sgt_ray_end){.px = at->x, .py = at->y, .weight = at->weight, .aimed = l->status,
                         .within = l->within, .fate = SGT_LOST, .status = SGT_EXHAUSTED, .p = nowhere,
                         .d = nowhere, .opl = none, .p_err = none, .opl_err = none, .d_err = none};
}

void sgt_launch_ending(size_t count, const sgt_element e[], sgt_element out[])
{
    for (size_t i = 0; i < count; i++) out[i] = e[i];
    if (out[count - 1].phase) out[count - 1].index = 0, out[count - 1].phase = NULL;
}

bool sgt_trace_pupil(const sgt_launcher *from, const sgt_field_beam *b, const sgt_element e[],
                     double index_before, size_t count, const sgt_pupil_point at[], const sgt_options *opt,
                     sgt_ray_end out[], sgt_error *error)
{
    sgt_element *own = sgt_launch_take(from, from->lens->count, sizeof *own);
    sgt_passage *passages = sgt_launch_take(from, from->lens->count, sizeof *passages);
    sgt_launched *launched = sgt_launch_take(from, count, sizeof *launched);
    bool fine = (own && passages && launched) || sgt_launch_memory(from, error);
    if (fine) sgt_launch_ending(from->lens->count, e, own);
    fine = fine && sgt_launch_rays(from, b, own, index_before, count, at, launched, error);
    for (size_t i = 0; fine && i < count; i++) {
        out[i] = not_traced(&at[i], &launched[i]);
        if (launched[i].status == SGT_MET)
            follow(from, b, own, index_before, &launched[i], opt, passages, &out[i]);
    }
    sgt_launch_forget(from, launched);
    sgt_launch_forget(from, passages);
    sgt_launch_forget(from, own);
    return fine;
}

void sgt_ends_as_angles(const sgt_vec3 *axis, size_t count, const sgt_ray_end end[], sgt_ray_end out[])
{
    const double MILLI = 1e3;
    const sgt_vec3 z = *axis, ey = unit3(cross3(z, (sgt_vec3){1, 0, 0})), ex = cross3(ey, z);
    for (size_t i = 0; i < count; i++) {
        const sgt_vec3 d = end[i].d, off = minus3(d, z); /* whose parts across the axis lose no digits */
        out[i] = end[i];
        const double ahead = dot3(d, z);
        out[i].p = (sgt_vec3){MILLI * atan2(dot3(off, ex), ahead), MILLI * atan2(dot3(off, ey), ahead), 0};
        out[i].p_err = MILLI * (end[i].d_err + 0x1p-51);
    }
}

size_t sgt_trace_through(size_t n, const sgt_element e[], double before, const sgt_ray *launch,
                         sgt_element open[], sgt_passage passages[], sgt_fate *fate)
{
    for (size_t i = 0; i < n; i++) open[i] = e[i], open[i].aperture = NULL;
    for (size_t left = n;; left--) { /* each time one more element is open */
        sgt_ray ray = *launch;
        size_t passed = sgt_trace(n, open, before, &ray, passages, fate, NULL);
        if (*fate != SGT_CLIPPED || left == 0) return passed;
        open[passed].semi_diameter = 0;
    }
}

bool sgt_trace_chief(const sgt_launcher *from, const sgt_field_beam *b, const sgt_element e[],
                     double index_before, sgt_ray_end *out, sgt_error *error)
{
    static const sgt_pupil_point centre = {0, 0, 1};
    const size_t count = from->lens->count;
    sgt_passage *passages = sgt_launch_take(from, count, sizeof *passages);
    sgt_element *own = sgt_launch_take(from, 2 * count, sizeof *own), *open = own + count;
    sgt_launched launched;
    bool fine = (passages && own) || sgt_launch_memory(from, error);
    if (fine) sgt_launch_ending(count, e, own);
    fine = fine && sgt_launch_rays(from, b, own, index_before, 1, &centre, &launched, error);
    if (fine) {
        *out = not_traced(&centre, &launched);
        if (launched.status == SGT_MET) {
            sgt_trace_through(count, own, index_before, &launched.ray, open, passages, &out->fate);
            follow(from, b, open, index_before, &launched, NULL, passages, out);
        }
    }
    sgt_launch_forget(from, own);
    sgt_launch_forget(from, passages);
    return fine;
}
