// SPDX-License-Identifier: MIT
/* bundle.c - a bundle of rays through a lens, by forms (form.h).
 *
 * All is exact arithmetic on the doubles of the lens, but for what forms add.  So what is said is said of the
 * exact rays, and of the computed ones if they differ from these by less than the slack (BUNDLE_SLACK).
 *
 * A LENGTH OF ONE.  d is of unit length in theory.  Axes are orthonormal to 2^-50 only, and sgt_trace makes
 * directions of unit length again behind them.  BUNDLE_SLACK is added to d at each element, far more than
 * both.
 *
 * A PHASE: an ideal lens is phase_forms (phase.h), and the length; the others are waves.c.
 *
 * BENDING as in trace.h: f = (1 - r^2) / (r g + sign(g) sqrt(D)), with g = n . d of a known sign. */
#include "bundle.h"

/* ----------------------------------------------------------------------- bending */

static form3 bundle_unit(form3 d)
{
    linear length2 = form_sum(form_square(d.x), form_sum(form_square(d.y), form_square(d.z)));
    linear by = form_inverse(form_root(length2));
    return (form3){form_product(d.x, by), form_product(d.y, by), form_product(d.z, by)};
}

/* d behind the surface.  false: *fate says why there is none. */
static bool bundle_bend(const sgt_element *e, double n1, const bundle_hit *h, form3 *d, bundle_fate *fate)
{
    double n2 = index_behind(e, n1), r = n1 / n2;
    bending by = bending_of(n1, n2, e->index == SGT_MIRROR);
    *fate = BUNDLE_UNKNOWN;
    if (e->phase && is_in_waves(e->phase)) return sgt_waves_bundle(e, n1, h, d, fate);
    if (e->phase) {
        if (!phase_forms(e->phase, n1, n2, by.kind == BACK, h->p, d)) return false;
        *d = bundle_unit(*d);
        return true;
    }
    if (by.kind == STRAIGHT) return true;
    linear f, rd = {r, 0, 0, 4 * SGT_U * r}, k = {by.k, 0, 0, 8 * SGT_U * fabs(by.k)};
    if (by.kind == BACK) {
        f = form_scaled(form_quotient(h->slope, h->size2), -2), rd = form_of(1);
    } else {
        linear rg = form_product(rd, h->slope);
        linear D = form_sum(form_square(rg), form_product(k, h->size2));
        if (form_below(D, 0)) {
            *fate = BUNDLE_GONE;
            return false;
        }
        f = form_quotient(k, form_sum(rg, form_scaled(form_root(D), h->sign)));
    }
    d->x = form_sum(form_product(rd, d->x), form_product(f, h->n.x));
    d->y = form_sum(form_product(rd, d->y), form_product(f, h->n.y));
    d->z = form_sum(form_product(rd, d->z), form_product(f, h->n.z));
    return true;
}

/* ------------------------------------------------------------------------- trace */

static form3 bundle_into(const sgt_pose *pose, form3 a)
{
    if (!is_turned(pose)) return a;
    return (form3){form_along(a, pose->ex), form_along(a, pose->ey), form_along(a, pose->ez)};
}

static form3 bundle_out(const sgt_pose *pose, form3 a)
{
    if (!is_turned(pose)) return a;
    sgt_vec3 ex = pose->ex, ey = pose->ey, ez = pose->ez;
    return (form3){form_along(a, (sgt_vec3){ex.x, ey.x, ez.x}), form_along(a, (sgt_vec3){ex.y, ey.y, ez.y}),
                   form_along(a, (sgt_vec3){ex.z, ey.z, ez.z})};
}

/* a + u au + v av, u and v in their intervals. */
static linear bundle_number(double a, double au, double av, sgt_interval u, sgt_interval v)
{
    double um = sgt_interval_middle(u), vm = sgt_interval_middle(v);
    linear fu = form_made(um, larger(u.hi - um, um - u.lo), 0, 0, fabs(u.lo) + fabs(u.hi)),
           fv = form_made(vm, 0, larger(v.hi - vm, vm - v.lo), 0, fabs(v.lo) + fabs(v.hi));
    linear by_u = form_scaled(fu, au), by_v = form_scaled(fv, av);
    double grain = FORM_ROUND * (fabs(a) + form_size(by_u) + form_size(by_v)); /* of the ray in doubles */
    return form_wider(form_sum(form_of(a), form_sum(by_u, by_v)), grain);
}

static form3 bundle_vector(sgt_vec3 a, sgt_vec3 au, sgt_vec3 av, sgt_interval u, sgt_interval v)
{
    return (form3){bundle_number(a.x, au.x, av.x, u, v), bundle_number(a.y, au.y, av.y, u, v),
                   bundle_number(a.z, au.z, av.z, u, v)};
}

static form3 bundle_slack(form3 d)
{
    return (form3){form_wider(d.x, BUNDLE_SLACK), form_wider(d.y, BUNDLE_SLACK),
                   form_wider(d.z, BUNDLE_SLACK)};
}

static bundle_fate bundle_meet(const sgt_element *e, const bundle_lines *w, sag_kept kept[2], bundle_hit *h)
{
    const double aperture = is_open(e->semi_diameter) ? HUGE_VAL : e->semi_diameter;
    const sgt_surface s = in_set(e->surface);
    if (s.ops == &sgt_conic_ops) {
        const sgt_conic *q = s.self;
        return sgt_bundle_conic(q->c, q->k, is_open(q->semi_diameter) ? HUGE_VAL : q->semi_diameter, aperture,
                                w, h);
    }
    return sgt_bundle_sag(s, aperture, w, kept, h);
}

bundle_fate sgt_bundle_trace(const aim_task *task, sgt_interval u, sgt_interval v, sag_kept (*kept)[2],
                             linear *x, linear *y)
{
    const sgt_beam *b = task->beam;
    form3 p = bundle_vector(b->o, b->ou, b->ov, u, v),
          d = bundle_unit(bundle_vector(b->d, b->du, b->dv, u, v));
    double index = task->index_before == 0 ? 1 : task->index_before;
    for (size_t i = 0;; i++) {
        const sgt_element *e = &task->e[i];
        const sgt_vec3 from = e->pose.origin;
        form3 o = {form_plus(p.x, -from.x), form_plus(p.y, -from.y), form_plus(p.z, -from.z)};
        o = bundle_into(&e->pose, o), d = bundle_slack(bundle_into(&e->pose, d));
        bundle_lines w = {.d = d};
        linear t = form_negative(form_quotient(o.z, d.z)); /* NaN if a ray may be along the plane */
        w.x = form_sum(o.x, form_product(t, d.x)), w.y = form_sum(o.y, form_product(t, d.y));
        if (!(w.x.e < HUGE_VAL && w.y.e < HUGE_VAL)) return BUNDLE_UNKNOWN;
        bundle_hit h;
        sag_kept own[2] = {{.known = false}, {.known = false}};
        bundle_fate fate = bundle_meet(e, &w, i < AIM_KEPT ? kept[i] : own, &h);
        if (fate != BUNDLE_THERE) return fate;
        *x = h.p.x, *y = h.p.y;
        if (i == task->stop) return BUNDLE_THERE;
        if (!bundle_bend(e, index, &h, &d, &fate)) return fate;
        index = index_behind(e, index);
        p = bundle_out(&e->pose, h.p), d = bundle_out(&e->pose, d);
        p = (form3){form_plus(p.x, from.x), form_plus(p.y, from.y), form_plus(p.z, from.z)};
    }
}

/* ----------------------------------------------------------------------- offered */

static bool offered_here(sgt_surface surface)
{
    if (surface.ops != &sgt_conic_ops) return surface.ops && sgt_bundle_has_sag(surface);
    const sgt_conic *s = surface.self;
    return isfinite(s->c) && isfinite(s->k) && s->semi_diameter >= 0;
}

bool sgt_bundle_offered(const aim_task *task)
{
    double index = task->index_before == 0 ? 1 : task->index_before;
    for (size_t i = 0; i <= task->stop; i++) {
        const sgt_element *e = &task->e[i];
        if (!is_plain(e) || !is_phase_sound(e) || !is_aperture_sound(e) || !is_sound(e, index)) return false;
        if (!offered_here(in_set(e->surface))) return false;
        index = index_behind(e, index);
    }
    return true;
}
