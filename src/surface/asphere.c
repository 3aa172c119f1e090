/* asphere.c - a conic plus the sum P of a[i] r^(2i+2): Newton's method, certified.
 *
 * F = z - s(r^2) - P(r^2) is solved in the polynomial form G of form.c, which has its roots, and by
 * the certificate there.
 *
 * QUICK.  Newton from the conic's root near the vertex, each step at most half the last.  Three or four
 * evaluations on lens surfaces.  That the root is the only one within the rim is certain where
 *     |n| > L sqrt(a),  L = max |grad s| over the rim,  a = l^2 + m^2:
 * then F is monotone along the chord.
 * CAREFUL.  All else: the march in asphere_march.c, which is certain too, only slower.
 *
 * The last evaluation of a hit is that of F at the point returned. */
#include "asphere.h"

#include "../solve/root.h"

/* ------------------------------------------------------------------ quick */

/* F is monotone along the chord within the rim, by its slope. */
SGT_INLINE bool single(const shape *s, const local *q)
{
    double a = q->l * q->l + q->m * q->m, r2 = s->domain2, unused;
    if (!(r2 < HUGE_VAL)) return a == 0;
    double phi2 = 1 - s->ck * s->c * r2;
    if (!(phi2 > 0x1p-30)) return false; /* the equator is inside */
    double conic = fabs(s->c) / sqrt(phi2), steep = (conic + 2 * magnitude(s->terms, s->a, r2, &unused)) * (1 + 0x1p-20);
    return q->n * q->n > steep * steep * r2 * a;
}

/* true: a hit. */
SGT_INLINE bool quick(const shape *s, const sgt_ray *ray, meeting *out, double *seed, tally *w)
{
    const sgt_options *opt = w->opt;
    local q = local_at_vertex_plane(ray);
    double a = q.l * q.l + q.m * q.m, k1 = 1 + s->k;
    double A = s->c * (a + k1 * q.n * q.n), B = q.n - s->c * (q.x * q.l + q.y * q.m), C = s->c * (q.x * q.x + q.y * q.y);
    double D = B * B - A * C, tau = C / (B + copysign(sqrt(D), B)), last = HUGE_VAL;
    if (!(tau > -HUGE_VAL && tau < HUGE_VAL)) tau = 0; /* the conic is not met: from the vertex plane */
    *seed = q.t0 + tau;
    if (!(fabs(q.n) >= 0x1p-10)) return false;
    double t_tol = opt->t_tol / q.scale;
    sgt_move move = SGT_SEED;
    for (int i = 0; i < 12 && w->evals < w->budget; i++) {
        sample at = form_at(s, &q, tau);
        observe(w, &q, tau, &at, move, -HUGE_VAL, HUGE_VAL);
        if (w->stopped) return false;
        move = SGT_NEWTON;
        double step = -at.g / at.slope, v_err;
        bool steady, close = fabs(at.g) <= 0x1p-20 * (fabs(at.z) + fabs(at.w)) || fabs(step) <= t_tol, shrinks = fabs(step) <= 0.5 * last; /* not of NaN */
        last = fabs(step);
        if (close || !shrinks) {
            sgt_form_bound(s, &q, tau, &at);
            if (!shrinks && !(fabs(at.g) <= at.g_err)) return false; /* noise at the root is no reason to give up */
            if (!sgt_form_certify(s, &q, &at, tau, t_tol, out, &v_err, &steady)) return false;
            if (steady) {
                if (!(out->v > 16 * v_err)) return false;
                /* a start too far off for the terms at the root, or for t, or a steep place: once more from there */
                double fx = fabs(out->n.x), fy = fabs(out->n.y), far = at.ex * fx + at.ey * fy + at.ez;
                double here = fabs(at.x) * fx + fabs(at.y) * fy + fabs(at.z) + at.first * (at.x * at.x + at.y * at.y);
                if ((far > 3 * here || fx * fx + fy * fy > STEEP2 || !sharp(out, opt->t_tol)) && !sgt_form_settle(s, ray, q.t0, q.t0_lo + tau, out, &v_err, w)) return false;
                bool whole = single(s, &q), near = opt->pick == SGT_NEAR_SEED;
                return (near || whole) && counts(out, ray, s->rim2, q.scale) && out->t_err < HUGE_VAL;
            }
        }
        tau += step;
    }
    return false;
}

/* -------------------------------------------------------------- together */

static int terms_of(const sgt_asphere *s)
{
    int terms = 8;
    while (terms > 0 && s->a[terms - 1] == 0) terms--;
    return terms;
}

static shape shape_of(const sgt_asphere *s, int terms)
{
    return (shape){.c = s->c, .k = s->k, .ck = (1 + s->k) * s->c, .terms = terms, .a = s->a, .rim2 = rim2_of(s->semi_diameter),
                   .domain2 = domain2_of(s->c, s->k, s->semi_diameter)};
}

/* x - x is 0 for a finite x, NaN for another. */
static bool asphere_valid(const sgt_asphere *s)
{
    double sum = (s->c - s->c) + (s->k - s->k) + (s->semi_diameter - s->semi_diameter);
    for (int i = 0; i < 8; i++) sum += s->a[i] - s->a[i];
    return sum == 0 && s->semi_diameter >= 0;
}

SGT_CLONES
static sgt_hit asphere_meet(const void *self, const sgt_ray *ray, const sgt_options *opt)
{
    const sgt_asphere *s = self;
    if (!asphere_valid(s)) return hit_without(SGT_INVALID, ray, 0);
    int terms = terms_of(s);
    if (!terms) return sgt_conic_meet(s->c, s->k, s->semi_diameter, ray, opt);
    shape h = shape_of(s, terms);
    if (!rim_in_range(h.rim2)) return hit_without(SGT_UNPROVEN, ray, 0);
    meeting at;
    double seed;
    tally w = {.opt = opt, .budget = opt->max_evals ? opt->max_evals : SGT_DEFAULT_EVALS};
    if (quick(&h, ray, &at, &seed, &w)) return hit_at(&at, SGT_HIT, asphere_f(&h, at.p), SGT_NEWTON, ray, &w);
    if (w.stopped) return hit_without(SGT_STOPPED, ray, w.evals);
    return sgt_asphere_march(&h, ray, seed, &w, NULL);
}

static sgt_status asphere_all(const void *self, const sgt_ray *ray, const sgt_options *opt, sgt_list *list)
{
    const sgt_asphere *s = self;
    int terms = terms_of(s);
    if (!asphere_valid(s)) return SGT_INVALID;
    if (!terms) return sgt_conic_all(s->c, s->k, s->semi_diameter, ray, opt, list);
    shape h = shape_of(s, terms);
    tally w = {.opt = opt, .budget = opt->max_evals ? opt->max_evals : SGT_DEFAULT_EVALS};
    if (rim_in_range(h.rim2)) sgt_asphere_march(&h, ray, (double)NAN, &w, list);
    else add_stretch(list, &w, SGT_UNPROVEN, ray, -HUGE_VAL, HUGE_VAL);
    return SGT_MISS;
}

static double asphere_value(const void *self, sgt_vec3 p, sgt_vec3 *grad)
{
    const sgt_asphere *s = self;
    int terms = terms_of(s);
    double r2 = p.x * p.x + p.y * p.y, phi, slope, dp = 0, sag = conic_sag(s->c, s->k, r2, &phi, &slope);
    if (terms) sag += polynomial(terms, s->a, r2, &dp);
    slope += dp;
    if (grad) *grad = (sgt_vec3){-2 * p.x * slope, -2 * p.y * slope, 1};
    return p.z - sag;
}

static double asphere_rounding(const void *self, sgt_vec3 p)
{
    const sgt_asphere *s = self;
    int terms = terms_of(s);
    double r2 = p.x * p.x + p.y * p.y, phi, slope, dp, second, base = conic_sag(s->c, s->k, r2, &phi, &slope), sag = base, noise = 0;
    if (terms) {
        sag += polynomial(terms, s->a, r2, &dp);
        noise = 4 * r2 * magnitude(terms, s->a, r2, &second) + fabs(sag); /* r2 itself is off by 2 u */
    }
    return 1.01 * SGT_U * (conic_sag_rounding(s->c, s->k, r2, base, phi) + noise + fabs(p.z - sag));
}

static sgt_span asphere_span(const void *self, const sgt_ray *ray)
{
    const sgt_asphere *s = self;
    shape h = shape_of(s, terms_of(s));
    sgt_span span = sgt_sag_span(s->c, s->k, s->semi_diameter, ray, !h.terms);
    if (h.terms) {
        local q = local_at_vertex_plane(ray);
        span.single = q.n != 0 && single(&h, &q);
    }
    return span;
}

static const struct sgt_own asphere_own = {.meet = asphere_meet, .all = asphere_all};

const sgt_surface_ops sgt_asphere_ops = {.name = "even_asphere", .value = asphere_value, .span = asphere_span,
                                         .rounding = asphere_rounding, .own_ = &asphere_own};
