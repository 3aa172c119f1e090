/* ends.c - where the rays of a field end, and how sure that is.
 *
 * THE LAUNCH RAY is itself rounded.  Each of its numbers is off by some ulps: for the point at the end
 * that is a few times `grain` (sgt_end_error).  A ray from afar starts on a plane in space, at
 * p + (wave - p . d) d; what rounding does to that along d is in the path at once, and no more than
 * LAUNCH ulps of the numbers that go into it. */
#include "launch.h"

static const double ULP = 0x1p-53, LAUNCH = 6, GRAINS = 4;

static double launch_error(const sgt_field_beam *b, const sgt_ray *ray, double index)
{
    if (b->finite) return 0;
    return LAUNCH * ULP * index * (length3(ray->o) + fabs(b->wave) + fabs(b->pupil));
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
    out->opl_err = off.path + launch_error(b, &l->ray, before == 0 ? 1 : before);
}

bool sgt_trace_pupil(const sgt_launcher *from, const sgt_field_beam *b, const sgt_element e[],
                     double index_before, size_t count, const sgt_pupil_point at[], const sgt_options *opt,
                     sgt_ray_end out[])
{
    const double none = (double)NAN;
    const sgt_vec3 nowhere = {none, none, none};
    sgt_passage *passages = sgt_launch_take(from, from->lens->count, sizeof *passages);
    sgt_launched *launched = sgt_launch_take(from, count, sizeof *launched);
    bool fine = passages && launched && sgt_launch_rays(from, b, e, index_before, count, at, launched);
    for (size_t i = 0; fine && i < count; i++) {
        out[i] = (sgt_ray_end){.px = at[i].x,
                               .py = at[i].y,
                               .weight = at[i].weight,
                               .aimed = launched[i].status,
                               .within = launched[i].within,
                               .fate = SGT_LOST,
                               .status = SGT_EXHAUSTED,
                               .p = nowhere,
                               .d = nowhere,
                               .opl = none,
                               .p_err = none,
                               .opl_err = none};
        if (launched[i].status == SGT_MET)
            follow(from, b, e, index_before, &launched[i], opt, passages, &out[i]);
    }
    sgt_launch_forget(from, launched);
    sgt_launch_forget(from, passages);
    return fine;
}

sgt_element *sgt_open_elements(const sgt_launcher *from, const sgt_element e[])
{
    const size_t count = from->lens->count;
    sgt_element *open = sgt_launch_take(from, count, sizeof *open);
    for (size_t i = 0; open && i < count; i++)
        open[i] = e[i], open[i].semi_diameter = 0, open[i].aperture = NULL;
    return open;
}

bool sgt_trace_chief(const sgt_launcher *from, const sgt_field_beam *b, const sgt_element e[],
                     double index_before, sgt_ray_end *out)
{
    static const sgt_pupil_point centre = {0, 0, 1};
    sgt_element *open = sgt_open_elements(from, e);
    bool fine = open && sgt_trace_pupil(from, b, open, index_before, 1, &centre, NULL, out);
    sgt_launch_forget(from, open);
    return fine;
}
