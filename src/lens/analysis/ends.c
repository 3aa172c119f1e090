/* ends.c - where the rays of a field end, and how sure that is.
 *
 * THE LAUNCH RAY is itself rounded.  Each of its numbers is off by some ulps: for the point at the end
 * that is a few times `grain` (sgt_end_error).  A ray from afar starts on a plane in space, at
 * p + (wave - p . d) d; what rounding does to that along d is in the path at once, and no more than
 * LAUNCH ulps of the numbers that go into it.
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

static sgt_ray_end not_traced(const sgt_pupil_point *at, sgt_aimed status)
{
    const double none = (double)NAN;
    const sgt_vec3 nowhere = {none, none, none};
    return (sgt_ray_end){.px = at->x, .py = at->y, .weight = at->weight, .aimed = status, .fate = SGT_LOST,
                         .status = SGT_EXHAUSTED, .p = nowhere, .d = nowhere, .opl = none, .p_err = none,
                         .opl_err = none};
}

bool sgt_trace_pupil(const sgt_launcher *from, const sgt_field_beam *b, const sgt_element e[],
                     double index_before, size_t count, const sgt_pupil_point at[], const sgt_options *opt,
                     sgt_ray_end out[])
{
    sgt_passage *passages = sgt_launch_take(from, from->lens->count, sizeof *passages);
    sgt_launched *launched = sgt_launch_take(from, count, sizeof *launched);
    bool fine = passages && launched && sgt_launch_rays(from, b, e, index_before, count, at, launched);
    for (size_t i = 0; fine && i < count; i++) {
        out[i] = not_traced(&at[i], launched[i].status);
        if (launched[i].status == SGT_MET)
            follow(from, b, e, index_before, &launched[i], opt, passages, &out[i]);
    }
    sgt_launch_forget(from, launched);
    sgt_launch_forget(from, passages);
    return fine;
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
                     double index_before, sgt_ray_end *out)
{
    static const sgt_pupil_point centre = {0, 0, 1};
    const size_t count = from->lens->count;
    sgt_passage *passages = sgt_launch_take(from, count, sizeof *passages);
    sgt_element *open = sgt_launch_take(from, count, sizeof *open);
    sgt_launched launched;
    bool fine = passages && open && sgt_launch_rays(from, b, e, index_before, 1, &centre, &launched);
    if (fine) {
        *out = not_traced(&centre, launched.status);
        if (launched.status == SGT_MET) {
            sgt_trace_through(count, e, index_before, &launched.ray, open, passages, &out->fate);
            follow(from, b, open, index_before, &launched, NULL, passages, out);
        }
    }
    sgt_launch_forget(from, open);
    sgt_launch_forget(from, passages);
    return fine;
}
