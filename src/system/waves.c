// SPDX-License-Identifier: MIT
/* waves.c - phases in waves: their functions, errors and bounds, and which orders there are (waves.h).
 *
 * A FORM OF G.  Of a sag bundle_sag.c has the slopes.  Of a formula of x, y and z, with m the middle of the
 * box and the second derivatives H enclosed all over it, each component of the gradient is
 *
 *     g_i(m + v) in g_i(m) + sum over j of H_ij v_j.
 *
 * So it is of a quadric, and of a user's function with bounds.
 *
 * WHICH ORDERS.  t = p + a g, a = per_wave, p and g the parts of n1 d and of grad W along the surface.  So
 * |t| < n2 is g^2 a^2 + 2 p . g a + p^2 - n2^2 < 0: a is between the roots. */
#include "waves.h"

#include "../ray/general.h"
#include "../surface/departure/departure.h"
#include "../surface/formula/formula.h"
#include "bundle.h"
#include "end_error.h"

/* -------------------------------------------------------------------- the function */

bool sgt_waves_sound(const sgt_phase *a)
{
    const sgt_surface s = in_set(a->waves);
    if (!is_in_waves(a) || !ROOM_IS_ZERO(a) || !(is_faceted(a) || isfinite(a->per_wave))) return false;
    if (!s.ops || !s.ops->value || !is_whole(s.ops)) return false;
    const struct sgt_builtin_ops *own = s.ops->own_;
    if (!own) return true;
    if (s.ops == &sgt_conic_ops) {
        const sgt_conic *q = s.self;
        return isfinite(q->c) && isfinite(q->k);
    }
    if (s.ops == &sgt_even_asphere_ops) return sgt_bundle_has_sag(s);
    if (has_sag(a) && !own->departure) return false;
    return own->object && !own->object(s.self).reason;
}

/* The polynomial of an even asphere without a conic has a loop over points (departure.h), which the surface
 * has not.  NULL: it is not one. */
static const departure *polynomial_of(sgt_surface s, bool sag)
{
    if (!sag || s.ops != &sgt_even_asphere_ops) return NULL;
    return ((const sgt_even_asphere *)s.self)->c == 0 ? s.ops->own_->departure : NULL;
}

static void terms_at(sgt_surface s, const departure *of, size_t n, sgt_points p, double *w,
                          double *const g[3])
{
    for (size_t i = 0, few; i < n; i += few) {
        few = n - i < DEPARTURE_BLOCK ? n - i : DEPARTURE_BLOCK;
        of->at(s.self, few, p.p[0] + i, p.p[1] + i, (sag_values){w + i, g[0] + i, g[1] + i});
        for (size_t k = i; k < i + few; k++) g[2][k] = 0;
    }
}

/* Of F and its gradient; where F is not finite the gradient is NaN. */
SGT_INLINE waves_here waves_made(bool sag, double f, sgt_vec3 g)
{
    const double none = f - f;
    return sag ? (waves_here){-f, {none - g.x, none - g.y, none}}
               : (waves_here){f, {none + g.x, none + g.y, none + g.z}};
}

waves_here sgt_waves_at(const sgt_phase *a, sgt_vec3 p)
{
    const sgt_surface s = in_set(a->waves);
    const bool sag = has_sag(a);
    sgt_vec3 g = {0, 0, 0}; /* a value that is NaN need not set it */
    const departure *of = polynomial_of(s, sag);
    if (of) {
        double w;
        terms_at(s, of, 1, (sgt_points){{&p.x, &p.y, NULL}}, &w, (double *const[3]){&g.x, &g.y, &g.z});
        return waves_made(false, w, g);
    }
    if (sag) p.z = 0;
    const double f = s.ops->value(s.self, p, &g);
    return waves_made(sag, f, g);
}

SGT_INLINE void waves_all_of(bool sag, size_t n, double *w, double *gx, double *gy, double *gz)
{
#pragma omp simd
    for (size_t i = 0; i < n; i++) {
        const waves_here h = waves_made(sag, w[i], (sgt_vec3){gx[i], gy[i], gz[i]});
        w[i] = h.w, gx[i] = h.g.x, gy[i] = h.g.y, gz[i] = h.g.z;
    }
}

SGT_KERNEL
static void waves_all(bool sag, size_t n, double *restrict w, double *restrict gx, double *restrict gy,
                      double *restrict gz)
{
    if (sag) waves_all_of(true, n, w, gx, gy, gz);
    else waves_all_of(false, n, w, gx, gy, gz);
}

static const double origin[WAVES_MOST];

/* A point whose x is NaN is not shown to the function: the origin takes its place. */
void sgt_waves_tile(const sgt_phase *a, size_t n, sgt_points p, double *w, double *const g[3])
{
    const sgt_surface s = in_set(a->waves);
    const bool sag = has_sag(a);
    const departure *of = polynomial_of(s, sag);
    double x[WAVES_MOST];
    if (of) {
        terms_at(s, of, n, p, w, g);
        waves_all(false, n, w, g[0], g[1], g[2]);
        return;
    }
    bool all = true;
    for (size_t i = 0; i < n; i++) all = all && p.p[0][i] == p.p[0][i];
    for (size_t i = 0; !all && i < n; i++) x[i] = p.p[0][i] == p.p[0][i] ? p.p[0][i] : 0;
    values_of(s, n, (sgt_points){{all ? p.p[0] : x, p.p[1], sag ? origin : p.p[2]}},
              (sgt_values){w, {g[0], g[1], g[2]}});
    waves_all(sag, n, w, g[0], g[1], g[2]);
}

bool sgt_waves_second(const sgt_phase *a, size_t n, sgt_points p, double *const out[6])
{
    const sgt_surface s = in_set(a->waves);
    const bool sag = has_sag(a), has = s.ops->second != NULL;
    if (sag) p.p[2] = origin;
    if (has) s.ops->second(s.self, n, p, out);
    for (int k = 0; k < 6; k++) {
        const bool by_z = k == 2 || k > 3;
        for (size_t i = 0; !has && i < n; i++) out[k][i] = (double)NAN;
        for (size_t i = 0; has && sag && i < n; i++) out[k][i] = by_z ? 0 : -out[k][i];
    }
    return has;
}

/* -------------------------------------------------------------------------- errors */

static const sgt_interval AXES[3][3] = {{{1, 1}, {0, 0}, {0, 0}}, {{0, 0}, {1, 1}, {0, 0}},
                                      {{0, 0}, {0, 0}, {1, 1}}};

/* The gradient of a formula of x, y, z over a box, and its second derivatives, xx, xy, xz, yy, yz, zz, unless
 * NULL. */
static bool formula_slopes(const void *self, const sgt_interval at[3], sgt_interval g[3],
                           sgt_interval second[6])
{
    const sgt_tape *tape = ((const sgt_formula *)self)->tape;
    const sgt_interval r = sgt_interval_hypotenuse(at[0], at[1]);
    int k = 0;
    for (int i = 0; i < 3; i++)
        for (int j = i; j < 3; j++, k++) {
            const formula_jet jet = sgt_formula_jet(tape, at, r, AXES[i], AXES[j], second != NULL);
            if (second) second[k] = jet.uv;
            g[i] = jet.u, g[j] = jet.v;
        }
    return true;
}

static const sgt_tape *formula_tape(sgt_surface s)
{
    if (s.ops == &sgt_formula_ops) return ((const sgt_formula *)s.self)->tape;
    return s.ops == &sgt_formula_sag_ops ? ((const sgt_formula_sag *)s.self)->tape : NULL;
}

bool sgt_has_kinks(sgt_surface s)
{
    const sgt_tape *tape = formula_tape(s);
    for (int i = 0; tape && i < tape->steps; i++) {
        const int op = tape->step[i].op;
        if (op == FORMULA_ABS || op == FORMULA_MIN || op == FORMULA_MAX || op == FORMULA_HYPOT) return true;
    }
    return false;
}

/* The same of a quadric. */
static bool quadric_slopes(const void *self, const sgt_interval at[3], sgt_interval g[3], sgt_interval second[6])
{
    const sgt_quadric *q = self;
    static const int xx[3] = {0, 3, 5}, of[3][3] = {{-1, 0, 2}, {0, -1, 1}, {2, 1, -1}};
    for (int i = 0; i < 3; i++) {
        g[i] = sgt_interval_sum(sgt_interval_scaled(at[i], 2 * q->squares[i]), sgt_interval_of(q->linear[i]));
        for (int j = 0; j < 3; j++)
            if (j != i) g[i] = sgt_interval_sum(g[i], sgt_interval_scaled(at[j], q->products[of[i][j]]));
        if (second) second[xx[i]] = sgt_interval_of(2 * q->squares[i]);
    }
    if (second) second[1] = sgt_interval_of(q->products[0]), second[4] = sgt_interval_of(q->products[1]);
    if (second) second[2] = sgt_interval_of(q->products[2]);
    return true;
}

static double farthest_from(double x, sgt_interval in)
{
    const double off = larger(sgt_sum_above(in.hi, -x), sgt_sum_above(x, -in.lo));
    return in.lo <= in.hi && off < HUGE_VAL ? larger(off, 0) : HUGE_VAL;
}

/* The gradient of s, or of F, within `by` of p. */
static void slopes_near(const sgt_tape *tape, sgt_vec3 p, double by, sgt_interval g[3])
{
    const double x[3] = {p.x, p.y, p.z};
    sgt_interval at[3];
    for (int i = 0; i < 3; i++)
        at[i] = sgt_interval_between(-sgt_sum_above(-x[i], by), sgt_sum_above(x[i], by));
    const sgt_interval r = sgt_interval_hypotenuse(at[0], at[1]);
    const formula_jet xy = sgt_formula_jet(tape, at, r, AXES[0], AXES[1], false);
    g[0] = xy.u, g[1] = xy.v, g[2] = sgt_interval_of(0);
    if (tape->kind == SGT_FORMULA_XYZ) g[2] = sgt_formula_jet(tape, at, r, AXES[2], AXES[2], false).u;
}

static double off_near(const sgt_tape *tape, sgt_vec3 p, double by, sgt_vec3 g)
{
    sgt_interval near[3];
    slopes_near(tape, p, by, near);
    return farthest_from(g.x, near[0]) + farthest_from(g.y, near[1]) + farthest_from(g.z, near[2]);
}

double sgt_kink_off(sgt_surface s, sgt_vec3 p, double p_err, sgt_vec3 n)
{
    const bool sag = s.ops == &sgt_formula_sag_ops;
    return off_near(formula_tape(s), p, p_err, sag ? (sgt_vec3){-n.x, -n.y, 0} : n);
}

/* Of the gradient of a conic's sag, or of that of an even asphere with this base. */
static double gradient_off(const sgt_even_asphere *a, sgt_vec3 p)
{
    return of_gradient(GRADIENT_OF_ASPHERE, a, p, (sgt_vec3){0, 0, 1}, 1, 1, 1);
}

waves_off sgt_waves_off(const sgt_phase *a, sgt_vec3 p, double p_err, waves_here here)
{
    const sgt_surface s = in_set(a->waves);
    const struct sgt_builtin_ops *own = s.ops->own_;
    if (has_sag(a)) p.z = 0;
    waves_off off = {64 * SGT_U * fabs(here.w), 64 * SGT_U * size_of(here.g)};
    if (s.ops->rounding) off.w = s.ops->rounding(s.self, p);
    if (polynomial_of(s, has_sag(a))) {
        double each;
        own->departure->rounding(s.self, p.x, p.y, &off.w, &each);
        off.g = 1.5 * each;
    } else if (s.ops == &sgt_conic_ops || s.ops == &sgt_even_asphere_ops) {
        const sgt_conic *q = s.self;
        const sgt_even_asphere base = {.c = q->c, .k = q->k};
        off.g = gradient_off(s.ops == &sgt_conic_ops ? &base : s.self, p);
    } else if (s.ops == &sgt_formula_ops) {
        off.g = off_near(formula_tape(s), p, sgt_has_kinks(s) ? p_err : 0, here.g);
    } else if (own && own->departure) {
        sgt_even_asphere base = {.c = 0};
        double w_err, grad_err;
        own->departure->rounding(s.self, p.x, p.y, &w_err, &grad_err);
        if (own->base) own->base(s.self, &base.c, &base.k);
        off.g = 1.5 * grad_err + gradient_off(&base, p) + SGT_U * size_of(here.g);
        if (sgt_has_kinks(s)) off.g = larger(off.g, off_near(formula_tape(s), p, p_err, here.g));
    }
    return off;
}

/* ------------------------------------------------------------------------- bundles */

/* The gradient of W all over the points.  false: nothing is known of it. */
static bool waves_forms(const sgt_phase *a, form3 p, form3 *g)
{
    const sgt_surface s = in_set(a->waves);
    if (has_sag(a) && s.ops->own_) {
        g->z = form_of(0);
        return sgt_bundle_sag_slopes(s, p.x, p.y, &g->x, &g->y);
    }
    sgt_waves_bounds *slopes = s.ops->own_ ? NULL : a->bounds;
    if (s.ops == &sgt_formula_ops) slopes = formula_slopes;
    if (s.ops == &sgt_quadric_ops) slopes = quadric_slopes;
    if (!slopes) return false;
    const sgt_interval box[3] = {form_range(p.x), form_range(p.y), form_range(p.z)},
                       middle[3] = {sgt_interval_of(p.x.c), sgt_interval_of(p.y.c), sgt_interval_of(p.z.c)};
    sgt_interval at[3], unread[3], second[6];
    if (!slopes(s.self, middle, at, second) || !slopes(s.self, box, unread, second)) return false;
    const linear v[3] = {form_plus(p.x, -p.x.c), form_plus(p.y, -p.y.c), form_plus(p.z, -p.z.c)};
    linear *const to[3] = {&g->x, &g->y, &g->z};
    static const int place[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};
    for (int i = 0; i < 3; i++) {
        *to[i] = form_between(at[i]);
        for (int j = 0; j < 3; j++)
            *to[i] = form_sum(*to[i], form_product(form_between(second[place[i][j]]), v[j]));
        if (!(to[i]->e < HUGE_VAL)) return false;
    }
    return true;
}

bool sgt_waves_bundle(const sgt_element *e, double n1, const bundle_hit *h, form3 *d, bundle_fate *fate)
{
    const double n2 = index_behind(e, n1), a = e->phase->per_wave;
    form3 g;
    *fate = BUNDLE_UNKNOWN;
    if (!waves_forms(e->phase, h->p, &g)) return false;
    const bool facets = is_faceted(e->phase);
    form3 n = h->n;
    linear size2 = h->size2;
    if (facets) {
        n = (form3){form_negative(g.x), form_negative(g.y), form_of(1)}, size2 = form_dot(n, n);
        g = (form3){form_of(0), form_of(0), form_of(0)};
        if (!form_above(form_scaled(form_dot(*d, n), h->sign), 0)) return false;
    }
    const form3 u = {form_sum(form_scaled(d->x, n1), form_scaled(g.x, a)),
                     form_sum(form_scaled(d->y, n1), form_scaled(g.y, a)),
                     form_sum(form_scaled(d->z, n1), form_scaled(g.z, a))};
    const linear inverse = form_inverse(size2), k = form_product(form_dot(u, n), inverse);
    const form3 t = {form_difference(u.x, form_product(k, n.x)), form_difference(u.y, form_product(k, n.y)),
                     form_difference(u.z, form_product(k, n.z))};
    const linear t2 = form_sum(form_square(t.x), form_sum(form_square(t.y), form_square(t.z)));
    const linear q = form_difference(form_square(form_of(n2)), t2);
    if (form_below(q, 0)) {
        *fate = BUNDLE_GONE;
        return false;
    }
    const double sign = e->index == SGT_MIRROR ? -h->sign : h->sign, by = 1 / n2;
    const linear along = form_scaled(form_root(form_product(q, inverse)), sign);
    const linear over = {by, 0, 0, SGT_U * by};
    d->x = form_product(form_sum(t.x, form_product(along, n.x)), over);
    d->y = form_product(form_sum(t.y, form_product(along, n.y)), over);
    d->z = form_product(form_sum(t.z, form_product(along, n.z)), over);
    return !facets || form_above(form_scaled(form_dot(*d, h->n), sign), 0);
}

/* ---------------------------------------------------------------------- which orders */

sgt_phased sgt_phase_at(const sgt_element *e, double index_before, sgt_vec3 d, const sgt_hit *hit)
{
    const double none = (double)NAN, n1 = index_before == 0 ? 1 : index_before;
    sgt_phased out = {none, {none, none, none}, none, none, {none, none}, {0}};
    if (!e->phase || is_faceted(e->phase) || !sgt_waves_sound(e->phase) || !is_sound(e, n1)) return out;
    const double n2 = index_behind(e, n1);
    const waves_here here = sgt_waves_at(e->phase, hit->p);
    sgt_vec3 n = times(scale_of(hit->n), hit->n);
    n = times(1 / sqrt(dot(n, n)), n);
    const sgt_vec3 p = across(times(n1, d), n), g = across(here.g, n);
    const double A = dot(g, g), B = dot(p, g), C = (size_of(p) - n2) * (size_of(p) + n2), D = B * B - A * C;
    out.waves = here.w, out.gradient = here.g, out.limit = n2;
    out.along = size_of(plus_times(p, e->phase->per_wave, g));
    const double root = sqrt(D), far = -(B + copysign(root, B));
    if (A > 0) out.per_wave = sgt_interval_hull(sgt_interval_of(far / A), sgt_interval_of(C / far));
    if (A == 0 && C < 0) out.per_wave = sgt_interval_all();
    if ((A == 0 && C >= 0) || D < 0) out.per_wave = sgt_interval_empty();
    return out;
}
