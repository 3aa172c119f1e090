/* bundle.c - a bundle of rays through a lens, by forms (form.h), and its meeting with a conic.
 *
 * All is exact arithmetic on the doubles of the lens, but for what forms add.  So what is said is said of the
 * exact rays, and of the computed ones if they differ from these by less than the slack (SLACK).
 *
 * A LENGTH OF ONE.  d is of unit length in theory.  Axes are orthonormal to 2^-50 only, and sgt_trace makes
 * directions of unit length again behind them.  SLACK is added to d at each element, far more than both.
 *
 * A CONIC.  A line crosses the vertex plane at (x, y, 0).  On it c (x^2 + y^2 + k1 z^2) - 2 z, k1 = 1 + k, is
 * A t^2 - 2 B t + C with
 *
 *     A = c (1 + k dz^2),   B = dz - c (x dx + y dy),   C = c (x^2 + y^2),   D = B^2 - A C.
 *
 * The root near the vertex is t = C / b, b = B + sign(B) sqrt(D); the other is b / A.  With
 * n = (-c x, -c y, v), v = 1 - k1 c z, the gradient of z - s times v,
 *
 *     n . d = sign(B) sqrt(D),   n . n = 1 + k c z (k1 c z - 2).
 *
 * No quotient by v: a ray at the equator is none of special note.  A root is on the sheet where v >= 0.  If
 * D < 0 for all rays, or v < 0, none meets it.
 *
 * THE OTHER ROOT may be meant instead only if it is on the sheet, and (ray/intersect.c, trace.c)
 *
 *     the near one is not on the sheet, or is outside the rim;
 *     or the near one is outside the aperture, and the other inside.
 *
 * The part is UNKNOWN unless that is excluded.  The other root has 1 - k1 c z = (A - k1 c dz b) / A.  Where A
 * may be 0 it may be at infinity.  If k1 <= 0, it is on the sheet only with c z >= 0, where r^2 >= 2 |z| /
 * |c|: so it is far out if |z| = |dz b / A| is large.
 *
 * BENDING as in trace.h: f = (1 - r^2) / (r g + sign(g) sqrt(D)), with g = n . d of a known sign. */
#include "bundle.h"

static const double SLACK = 0x1p-46;
/* A rim and an aperture are soft by a part in 2^44. */
static const double SOFT = 1 + 0x1p-40;

static bool form_below(linear x, double limit) { return form_range(x).hi < limit; }
static bool form_above(linear x, double limit) { return form_range(x).lo > limit; }

/* ------------------------------------------------------------------------- conic */

/* Is the other root of the conic certainly not meant? */
static bool other_excluded(double c, double k, double rim, double aperture, const bundle_lines *w, linear A,
                           linear b, const bundle_hit *near)
{
    double k1 = 1 + k;
    if (c == 0) return true; /* there is none */
    linear bent_z = form_scaled(form_product(b, w->d.z), k1 * c), on = form_difference(A, bent_z); /* v A */
    on = form_wider(on, SLACK * (form_size(A) + form_size(bent_z))); /* k1 c has been rounded */
    if ((form_above(A, 0) && form_below(on, 0)) || (form_below(A, 0) && form_above(on, 0))) return true;
    if (!form_above(near->n.z, SLACK)) return false;
    linear r2 = form_sum(form_square(near->p.x), form_square(near->p.y));
    bool in_rim = !(rim < HUGE_VAL) || form_below(r2, rim * rim * (1 - SLACK));
    if (!in_rim) return false;
    if (!(aperture < HUGE_VAL) || form_below(r2, aperture * aperture * (1 - SLACK))) return true;
    if (form_above(A, 0) || form_below(A, 0)) {
        linear t = form_quotient(b, A), x = form_sum(w->x, form_product(t, w->d.x)),
               y = form_sum(w->y, form_product(t, w->d.y));
        if (form_above(form_sum(form_square(x), form_square(y)), aperture * aperture * SOFT)) return true;
    }
    if (k1 > 0) return false;
    sgt_interval z = sgt_interval_absolute(form_range(form_product(w->d.z, b))), a = form_range(A);
    double most = sgt_interval_greatest(a), away2 = 2 * z.lo * (1 - SLACK) / (most * fabs(c));
    return away2 > aperture * aperture * SOFT;
}

bundle_fate sgt_bundle_conic(double c, double k, double rim, double aperture, const bundle_lines *w,
                             bundle_hit *h)
{
    const form3 d = w->d;
    linear r2 = form_sum(form_square(w->x), form_square(w->y));
    linear across = form_sum(form_product(w->x, d.x), form_product(w->y, d.y));
    linear A = form_scaled(form_plus(form_scaled(form_square(d.z), k), 1), c);
    A = form_wider(A, fabs(c) * SLACK * (1 + fabs(k)));
    linear B = form_difference(d.z, form_scaled(across, c)), C = form_scaled(r2, c);
    linear D = form_difference(form_square(B), form_product(A, C));
    if (form_below(D, 0)) return BUNDLE_GONE;
    bool up = form_above(B, 0);
    if (!up && !form_below(B, 0)) return BUNDLE_UNKNOWN;
    linear root = form_root(D), slope = up ? root : form_negative(root), b = form_sum(B, slope);
    linear t = form_quotient(C, b);
    h->p = (form3){form_sum(w->x, form_product(t, d.x)), form_sum(w->y, form_product(t, d.y)),
                   form_product(t, d.z)};
    linear cz = form_scaled(h->p.z, c), k1cz = form_sum(cz, form_scaled(cz, k));
    h->n = (form3){form_scaled(h->p.x, -c), form_scaled(h->p.y, -c), form_plus(form_negative(k1cz), 1)};
    h->size2 = form_plus(form_scaled(form_product(cz, form_plus(k1cz, -2)), k), 1);
    h->slope = slope, h->sign = up ? 1 : -1;
    if (!other_excluded(c, k, rim, aperture, w, A, b, h)) return BUNDLE_UNKNOWN;
    return form_below(h->n.z, 0) ? BUNDLE_GONE : BUNDLE_THERE;
}

/* ----------------------------------------------------------------------- bending */

/* d behind the surface.  false: *fate says why there is none. */
static bool bundle_bend(const sgt_element *e, double n1, const bundle_hit *h, form3 *d, bundle_fate *fate)
{
    double n2 = index_behind(e, n1), r = n1 / n2;
    bending by = bending_of(n1, n2, e->index == SGT_MIRROR);
    if (by.kind == STRAIGHT) return true;
    linear f, rd = {r, 0, 0, 4 * SGT_U * r}, k = {by.k, 0, 0, 8 * SGT_U * fabs(by.k)};
    *fate = BUNDLE_UNKNOWN;
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

static form3 bundle_unit(form3 d)
{
    linear length2 = form_sum(form_square(d.x), form_sum(form_square(d.y), form_square(d.z)));
    linear by = form_inverse(form_root(length2));
    return (form3){form_product(d.x, by), form_product(d.y, by), form_product(d.z, by)};
}

static form3 bundle_slack(form3 d)
{
    return (form3){form_wider(d.x, SLACK), form_wider(d.y, SLACK), form_wider(d.z, SLACK)};
}

static bundle_fate bundle_meet(const sgt_element *e, const bundle_lines *w, bundle_hit *h)
{
    const double aperture = is_open(e->semi_diameter) ? HUGE_VAL : e->semi_diameter;
    const sgt_surface s = in_set(e->surface);
    if (s.ops == &sgt_conic_ops) {
        const sgt_conic *q = s.self;
        return sgt_bundle_conic(q->c, q->k, is_open(q->semi_diameter) ? HUGE_VAL : q->semi_diameter, aperture,
                                w, h);
    }
    return sgt_bundle_sag(s.self, aperture, w, h);
}

bundle_fate sgt_bundle_trace(const aim_task *task, sgt_interval u, sgt_interval v, linear *x, linear *y)
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
        bundle_fate fate = bundle_meet(e, &w, &h);
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

static bool offered_sag(sgt_surface surface)
{
    if (surface.ops == &sgt_conic_ops) {
        const sgt_conic *s = surface.self;
        return isfinite(s->c) && isfinite(s->k) && s->semi_diameter >= 0;
    }
    if (surface.ops != &sgt_asphere_ops) return false;
    const sgt_asphere *s = surface.self;
    bool all = isfinite(s->c) && isfinite(s->k) && s->semi_diameter >= 0;
    for (int i = 0; i < 8; i++) all = all && isfinite(s->a[i]);
    return all;
}

bool sgt_bundle_offered(const aim_task *task)
{
    double index = task->index_before == 0 ? 1 : task->index_before;
    for (size_t i = 0; i <= task->stop; i++) {
        const sgt_element *e = &task->e[i];
        if (!is_plain(e) || e->phase || !is_aperture_sound(e) || !is_sound(e, index)) return false;
        if (!offered_sag(in_set(e->surface))) return false;
        index = index_behind(e, index);
    }
    return true;
}
