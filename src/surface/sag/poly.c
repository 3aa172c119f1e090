// SPDX-License-Identifier: MIT
/* poly.c - a sag in polynomial form: what is known of it at a point, and near a root.
 *
 * THE EQUATION.  F = z - s(r^2) - P(r^2), where s is the conic of conic.c and P is the sum of a[i]
 * r^(2i+2).  With w = z - P the sag is the sheet v = 1 - (1 + k) c w >= 0 of the polynomial surface
 *     G = w - (c r^2 + (1 + k) c w^2) / 2,       F = 2 G / (v + phi).
 * The solver works on G.  It has the sign of F and, where v > 0, the roots of F.  It needs no square root
 * and exists everywhere.  At the equator it is smooth, and F is not.  On the surface grad F = grad G / v.
 * So near a root Newton's step on G is Newton's step on F, with the gradient at its own length.
 *
 * THE BOUND.  Three numbers decide at a point tau: |G| with its rounding e, |G'| less its rounding, and M
 * >= |G''| nearby.  If M (|G| + e) <= G'^2 / 8, there is a root within h = 1.25 (|G| + e) / |G'|
 * (Kantorovich 1948; Ortega and Rheinboldt 1970, 12.6).  After the step -G / G' the root is within
 *     (e + M h^2 / 2 + |step| slope_err) / |G'|.
 * The rounding e follows the arithmetic:
 * - a coordinate carries the error of the local origin (num/local.h) plus two roundings;
 * - P is off by what magnitude() says;
 * - G adds a few u of its terms.
 *
 * M is made of magnitudes of P' and P'' at the far end in r:
 *     |w'| <= W1 = |n| + |P'| |rho'|,  |w''| <= W2 = |P''| rho'^2 + 2 a |P'|,  a = l^2 + m^2,
 *     M = |c| a + |(1 + k) c| (W1^2 + |w| W2) + W2.
 *
 * UNDERFLOW.  A product below 2^-1022 is off by up to 2^-1075, whatever its size.  Its remainder in twice
 * the precision is off by as much if the product is below 2^-969.  `lost` and `slope_lost` bound what that
 * does to G and G' on its way through the formulas, rho and (1 + k) c included.  They allow POLY_LOST =
 * 2^-1066 for each product and everything that it is a part of.  In Horner's rule the loss grows by rho at
 * each step.  From rho = 2^53 on no product of Horner's rule underflows.
 *
 * SETTLING.  To settle a root that is known roughly, the origin of the ray is moved onto it.  G is then
 * evaluated in twice the precision, so t is right to its last bit or nearly.  If t itself is near zero (a
 * start on the surface), five times the precision is used.
 *
 * Why not in solve/root.c: that works in doubles from one origin.  Without settling the cells have to be
 * met again in twice the precision: every root of an even asphere then costs 1.9 times the instructions
 * (rays of tests/cost/cases.c, by callgrind), with the same t_err. */
#include "../../num/lanes.h"
#include "poly.h"

#include "../../num/expansion.h"

static const double POLY_LOST = 0x1p-1066;

/* A bound on what P and P' at rho lose by underflow. */
static double lost_in_powers(double rho)
{
    double rho2 = rho * rho, rho4 = rho2 * rho2;
    return rho < 0x1p53 ? POLY_LOST * (1 + rho4 * rho4) : 0;
}

/* Adds the losses by underflow to the errors. */
static void underflow(const shape *s, double rho, double half_terms, sample *e)
{
    if (e->x == 0 && e->y == 0 && e->z == 0) return; /* here every product is exactly 0 */
    double w = fabs(e->w), ckw = fabs(s->ck * w), by_power = lost_in_powers(rho),
           lost_w = by_power + POLY_LOST * (1 + e->first);
    double lost_dw = 2 * (by_power + POLY_LOST * e->second) * half_terms + POLY_LOST * (1 + 2 * e->first);
    e->lost = (1 + ckw) * lost_w + POLY_LOST * (1 + fabs(s->c) + w) + (POLY_LOST * w) * w;
    e->slope_lost = (1 + ckw) * lost_dw + POLY_LOST * (1 + fabs(s->c) + w * fabs(e->dw));
    e->w_err += lost_w, e->g_err += e->lost, e->slope_err += e->slope_lost;
}

void sgt_poly_bound(const shape *s, const local *q, double tau, sample *e)
{
    double x = fabs(e->x), y = fabs(e->y), rho = x * x + y * y, half_terms = fabs(x * q->l) + fabs(y * q->m);
    e->first = magnitude(s->terms, s->a, rho, &e->second);
    /* in units of u */
    e->ex = q->xa + fabs(tau * q->l) + x, e->ey = q->ya + fabs(tau * q->m) + y,
    e->ez = q->za + fabs(tau * q->n) + fabs(e->z);
    double rho_err = 2 * (x * e->ex + y * e->ey) + 2 * rho;
    double w = fabs(e->w), w_err = e->first * (rho_err + 2 * rho) + e->ez + w, ckw = fabs(s->ck * w);
    e->w_err = 1.01 * SGT_U * w_err;
    e->g_err = 1.01 * SGT_U *
               ((fabs(e->v) + (4 * (1 + ckw) + fabs(s->ck) * w_err) * SGT_U) * w_err +
                0.5 * fabs(s->c) * (rho_err + 3 * rho) + 3 * ckw * w + 3 * w);
    e->slope_err = 32 * SGT_U *
                   (fabs(e->v) * (fabs(q->n) + 2 * (e->first + e->second * rho_err) * half_terms) +
                    fabs(s->c) * half_terms + (1 + fabs(s->ck) * w_err) * fabs(e->dw));
    e->v_err = SGT_U * (fabs(s->ck) * w_err + 4 * ckw + 1);
    e->lost = e->slope_lost = 0;
    double least = e->g_err < e->slope_err ? e->g_err : e->slope_err,
           most = e->first + e->second + ckw + w + fabs(s->c) + 0x1p60 * rho;
    /* If not, underflow is negligible beside these errors. */
    if (!(least > 0x1p-400 && most < 0x1p100)) underflow(s, rho, half_terms, e);
}

sample sgt_poly_sample(const shape *s, const local *q, double tau)
{
    sample e = poly_at(s, q, tau);
    sgt_poly_bound(s, q, tau, &e);
    return e;
}

double sgt_poly_bend(const shape *s, const local *q, const sample *at, double h)
{
    double xl = fabs(at->x) + h * fabs(q->l), ym = fabs(at->y) + h * fabs(q->m);
    double a = q->l * q->l + q->m * q->m, half = fabs(at->x * q->l + at->y * q->m) + h * a;
    /* A bound on rho over the cell.  It is at most (|x| + h |l|)^2 + (|y| + h |m|)^2.  The exact value at
     * the larger end is tighter: rho + 2 h |rho'/2| + a h^2. */
    double rho = at->x * at->x + at->y * at->y + 2 * h * fabs(at->x * q->l + at->y * q->m) + a * h * h;
    double bound = xl * xl + ym * ym, second;
    rho = (rho < bound ? rho : bound) * (1 + 0x1p-40);
    double first = magnitude(s->terms, s->a, rho, &second), drho = 2 * half;
    double w1 = fabs(q->n) + first * drho, w2 = second * drho * drho + 2 * a * first;
    double w = fabs(at->w) + at->w_err + h * w1;
    double bend = (fabs(s->c) * a + fabs(s->ck) * (w1 * w1 + w * w2) + w2) * (1 + 0x1p-30);
    if (bend > 0x1p-400 && drho < 0x1p60 && w1 < 0x1p300) return bend; /* underflow is negligible beside it */
    return bend + (POLY_LOST * (1 + w * w2) + (POLY_LOST * w1) * w1 +
                   (lost_in_powers(rho) * (1 + drho)) * (1 + drho));
}

double sgt_conic_sag_fine(double c, double k, double x, double y)
{
    twofold r2 = twofold_sum(two_product(x, x), two_product(y, y));
    twofold phi2 = twofold_difference(
        twofold_of(1), twofold_scaled(twofold_product(twofold_scaled(two_sum(1, k), c), r2), c));
    return phi2.hi < 0 ? (double)NAN : c * r2.hi / (1 + sqrt(phi2.hi));
}

/* A bound on the magnitude of the conic's sag at rho: from below if outward is 1, from above if it is -1.
 * phi^2 is rounded by less than 2^-48. */
static double sag_bound(const shape *s, double rho, double outward)
{
    double phi2 = 1 - s->ck * s->c * rho + outward * 0x1p-48;
    return s->c * rho / (1 + sqrt(larger(phi2, 0))) * (1 - outward * 0x1p-48);
}

/* A test for points far from the surface.  There G is of little use: it contains w^2, so M is needlessly
 * large.  Over the cell rho is a parabola, with an exact range.  s is monotone in rho.  w differs from its
 * tangent by at most W2 h^2 / 2. */
bool sgt_poly_apart(const shape *s, const local *q, const sample *at, double h)
{
    double a = q->l * q->l + q->m * q->m, half = fabs(at->x * q->l + at->y * q->m),
           rho = at->x * at->x + at->y * at->y, second;
    double high = (rho + 2 * half * h + a * h * h) * (1 + 0x1p-40),
           low = half < a * h ? rho - half * half / a : rho - 2 * half * h + a * h * h;
    double blur = 4 * SGT_U * (fabs(at->x) * at->ex + fabs(at->y) * at->ey); /* of rho, by its coordinates */
    high += blur;
    low = larger(low - 0x1p-40 * high - blur, 0);
    double edge = s->ck * s->c > 0 ? 1 / (s->ck * s->c) * (1 + 0x1p-40) : HUGE_VAL;
    if (low > edge) return true;
    if (high > edge) high = edge;
    double first = magnitude(s->terms, s->a, high, &second), drho = 2 * (half + h * a);
    double steep = fabs(at->dw) + 0x1p-45 * (fabs(q->n) + 2 * at->first * half);
    double reach = (steep * h + 0.5 * (second * drho * drho + 2 * a * first) * h * h) * (1 + 0x1p-30) +
                   at->w_err;
    reach += at->lost + at->slope_lost * h;
    /* The sags of least and of greatest magnitude. */
    double near = sag_bound(s, low, 1), far = sag_bound(s, high, -1);
    double below = at->w - reach, above = at->w + reach; /* if near or far is NaN, both tests fail */
    return (below > near && below > far) || (above < near && above < far);
}

int sgt_poly_side(const shape *s, const sample *at)
{
    double rho = at->x * at->x + at->y * at->y,
           slack = 0x1p-46 * rho + 4 * SGT_U * (fabs(at->x) * at->ex + fabs(at->y) * at->ey),
           edge = s->ck * s->c * (rho + slack);
    if (!(edge < 1 - 0x1p-40)) return 0;
    double near = sag_bound(s, larger(rho - slack, 0), 1), far = sag_bound(s, rho + slack, -1);
    double off = at->w_err + at->lost, below = at->w - off, above = at->w + off;
    return below > near && below > far ? 1 : above < near && above < far ? -1 : 0;
}

bool sgt_poly_certify(const shape *s, const local *q, const sample *at, double tau, double t_tol,
                      meeting *out, double *v_err, bool *steady)
{
    double g_err = at->g_err + (place_underflows(q) ? 0x1p-1070 : 0);
    double slope = fabs(at->slope) - at->slope_err, g = fabs(at->g) + g_err;
    double h = 1.25 * g / slope;
    *steady = false;
    if (!(slope > POLY_LOST && h < HUGE_VAL)) return false;
    double bend = sgt_poly_bend(s, q, at, h);
    if (!(6.4 * bend * h <= slope)) return false;
    double step = -at->g / at->slope, curved = 0.5 * bend * h * h, noise = g_err + fabs(step) * at->slope_err;
    double tau_err = 1.01 * (noise + curved) / slope + 2 * SGT_U * fabs(step);
    *steady = curved <= noise || tau_err <= 0.5 * t_tol;
    meeting_place(out, q, tau + step, tau_err + SGT_U * fabs(tau + step));
    out->v = at->v - s->ck * at->dw * step;
    out->slope = fabs(at->slope);
    *v_err = 2 * at->v_err + fabs(s->ck * at->dw) * (tau_err + 0x1p-50 * fabs(step)) +
             fabs(s->ck) * bend * h * h;
    twofold rho = square_radius(out->p.x, out->p.y);
    double dp, p = polynomial(s->terms, s->a, rho.hi, &dp), inverse = -s->c / out->v - 2 * dp;
    out->n = (sgt_vec3){out->p.x * inverse, out->p.y * inverse, 1};
    snap(out, s->c, s->k, rho, p + dp * rho.lo, SGT_U * 6 * rho.hi * at->first);
    return true;
}

/* G, G' and v at a point in twice the precision.  Errors:
 * - a coordinate: 3 u^2 of itself
 * - rho: 14 u^2
 * - a term of P: (i + 1) (14 + 5 + 3) u^2
 * - w: 24 u^2 rho first + 6 u^2 |z|
 * - G: 32 u^2 of its terms
 * - P': no more than w of its own terms, (i + 1) |a[i]| rho^i times i
 * - G': 2^-97 of its terms */
static void residual(const shape *s, const local *q, twofold x, twofold y, twofold z, sample *at)
{
    twofold rho = twofold_sum(twofold_product(x, x), twofold_product(y, y)),
            p = twofold_of(s->terms ? s->a[s->terms - 1] : 0), dp = twofold_of(0);
    for (int i = s->terms - 2; i >= 0; i--) {
        dp = twofold_sum(twofold_product(dp, rho), p);
        p = twofold_sum(twofold_product(p, rho), twofold_of(s->a[i]));
    }
    dp = twofold_sum(p, twofold_product(rho, dp));
    twofold w = twofold_difference(z, twofold_product(p, rho)), ck = twofold_scaled(two_sum(1, s->k), s->c),
            v = twofold_difference(twofold_of(1), twofold_product(ck, w));
    twofold bent = twofold_sum(twofold_scaled(rho, s->c), twofold_product(ck, twofold_product(w, w)));
    twofold g = twofold_difference(w, twofold_times_power(bent, 0.5));
    twofold half_drho = twofold_sum(twofold_scaled(x, q->l), twofold_scaled(y, q->m));
    twofold dw = twofold_difference(twofold_of(q->n), twofold_product(twofold_times_power(dp, 2), half_drho));
    twofold slope = twofold_difference(twofold_product(v, dw), twofold_scaled(half_drho, s->c));
    double poly = rho.hi * at->first, ckw = fabs(ck.hi * w.hi),
           half_terms = fabs(x.hi * q->l) + fabs(y.hi * q->m);
    at->g = g.hi + g.lo;
    at->g_err = 2 * SGT_TWOFOLD * (fabs(s->c) * rho.hi + (1 + ckw) * (poly + fabs(z.hi))) +
                SGT_U * fabs(at->g) + at->lost;
    at->v = v.hi;
    at->v_err = 2 * SGT_TWOFOLD * (1 + ckw + fabs(s->ck) * (poly + fabs(z.hi))) + SGT_U * fabs(v.hi);
    at->slope = slope.hi + slope.lo;
    at->slope_err = 0x1p-97 * ((1 + ckw + fabs(s->ck) * (poly + fabs(z.hi))) *
                                   (fabs(q->n) + 2 * (at->first + at->second * rho.hi) * half_terms) +
                               fabs(s->c) * half_terms) +
                    SGT_U * fabs(at->slope) + at->slope_lost;
}

static void residual_at(const shape *s, const sgt_ray *ray, const local *q, double tau, sample *at)
{
    twofold t = two_sum(q->t0, q->t0_lo + tau);
    residual(s, q, coordinate(ray->o.x, q->l, t.hi, t.lo), coordinate(ray->o.y, q->m, t.hi, t.lo),
             coordinate(ray->o.z, q->n, t.hi, t.lo), at);
}

sample sgt_poly_sample_fine(const shape *s, const sgt_ray *ray, const local *q, double tau)
{
    sample at = sgt_poly_sample(s, q, tau);
    residual_at(s, ray, q, tau, &at);
    return at;
}

static expansion poly_place(double o, double d, double t0, double t0_lo)
{
    twofold a = two_product(t0, d), b = two_product(t0_lo, d);
    return expansion_of_list(5, (double[]){b.lo, b.hi, a.lo, a.hi, o}, 0);
}

/* G at t0 + t0_lo in five times the precision. */
static void fine_residual(const shape *s, const sgt_ray *ray, const local *q, sample *at)
{
    expansion x = poly_place(ray->o.x, q->l, q->t0, q->t0_lo),
              y = poly_place(ray->o.y, q->m, q->t0, q->t0_lo),
              z = poly_place(ray->o.z, q->n, q->t0, q->t0_lo);
    expansion rho = expansion_sum(expansion_product(x, x), expansion_product(y, y)), p = expansion_of(0);
    for (int i = s->terms - 1; i >= 0; i--)
        p = expansion_product(expansion_sum(p, expansion_of(s->a[i])), rho);
    expansion w = expansion_sum(z, expansion_negative(p)),
              ck = expansion_scaled(expansion_sum(expansion_of(1), expansion_of(s->k)), s->c);
    expansion bent = expansion_sum(expansion_scaled(rho, s->c),
                                   expansion_product(ck, expansion_product(w, w)));
    expansion g = expansion_sum(w, expansion_scaled(bent, -0.5));
    at->g = expansion_value(&g, &at->g_err);
    at->g_err += at->lost;
}

void sgt_poly_tell(const shape *s, const sgt_ray *ray, tally *w, const local *q, double tau, sgt_move move,
                   double lo, double hi)
{
    local at = local_at(ray, q->t0, q->t0_lo);
    double x = at.x + tau * at.l, y = at.y + tau * at.m, z = at.z + tau * at.n, r2 = x * x + y * y;
    double phi, slope, dp, p = polynomial(s->terms, s->a, r2, &dp);
    double f = z - (conic_sag(s->c, s->k, r2, &phi, &slope) + p);
    double along = at.n - 2 * (slope + dp) * (x * at.l + y * at.m), t0 = at.t0;
    tell(w, move, (t0 + (at.t0_lo + tau)) * at.scale, f, isnan(f) ? (double)NAN : along / at.scale,
         (t0 + lo) * at.scale, (t0 + hi) * at.scale);
}

bool sgt_poly_settle(const shape *s, const sgt_ray *ray, double t0, double t0_lo, meeting *out, double *v_err,
                     tally *w)
{
    bool steady = false, fine = false;
    double last = HUGE_VAL;
    for (int i = 0; i < 9 && !w->stopped; i++) {
        if (w->evals >= w->budget) return false;
        local q = local_at(ray, t0, t0_lo);
        sample at = sgt_poly_sample(s, &q, 0);
        if (fine) fine_residual(s, ray, &q, &at);
        else residual_at(s, ray, &q, 0, &at);
        observe(s, ray, w, &q, 0, SGT_NEWTON, -HUGE_VAL, HUGE_VAL);
        if (w->stopped || !sgt_poly_certify(s, &q, &at, 0, 0, out, v_err, &steady)) return false;
        twofold next = two_sum(t0, t0_lo - at.g / at.slope);
        bool still = next.hi == t0 && next.lo == t0_lo;
        if (steady || still) {
            if (out->t_err <= 4 * SGT_U * fabs(out->t) || (fine && (still || out->t_err > 0.5 * last)) ||
                is_start(out, ray, q.scale))
                return true;
            fine = true;
        }
        last = out->t_err;
        t0 = next.hi, t0_lo = next.lo;
    }
    return !w->stopped;
}

bool sgt_poly_unique(const shape *s, const sgt_ray *ray, const meeting *at, tally *w)
{
    double scale = scale_of(ray->d), h = 2 * at->t_err / scale;
    local q = local_at(ray, at->t / scale, at->t_lo / scale);
    sample e = sgt_poly_sample(s, &q, 0);
    observe(s, ray, w, &q, 0, SGT_PROBE, -h, h);
    return fabs(e.slope) - e.slope_err > sgt_poly_bend(s, &q, &e, h) * h; /* false for NaN */
}

/* ------------------------------------------------------------------------ many points */

enum { POINTS = 64 };

/* What is known of the points before their terms are added. */
typedef struct poly_points {
    double r2[POINTS], slope[POINTS], base[POINTS], phi[POINTS], h[POINTS], dh[POINTS], size[POINTS];
} poly_points;

/* Returns all bits set if phi of some is infinite: conic_sag has another formula there. */
SGT_KERNEL
static mask poly_bases(const shape *s, size_t n, const double *x, const double *y, poly_points *w)
{
    const double c = s->c, k = s->k;
    mask any = 0;
    _Pragma("omp simd reduction(| : any)") for (size_t i = 0; i < n; i++)
    {
        double r2 = x[i] * x[i] + y[i] * y[i], cr2 = c * r2, phi = sqrt(1 - (1 + k) * c * cr2);
        w->r2[i] = r2, w->phi[i] = phi, w->slope[i] = c / (2 * phi), w->base[i] = cr2 / (1 + phi);
        any |= MASK(phi == HUGE_VAL);
    }
    return any;
}

/* `polynomial` and `magnitude`: h, dh and size. */
SGT_KERNEL
static void poly_terms(const shape *s, size_t n, poly_points *w)
{
    const double last = s->a[s->terms - 1];
    for (size_t i = 0; i < n; i++) w->h[i] = last, w->dh[i] = 0, w->size[i] = s->terms * fabs(last);
    for (int j = s->terms - 2; j >= 0; j--) {
        const double a = s->a[j], by = (j + 1) * fabs(a);
        LANES for (size_t i = 0; i < n; i++)
        {
            double rho = w->r2[i];
            w->dh[i] = w->dh[i] * rho + w->h[i], w->h[i] = w->h[i] * rho + a;
            w->size[i] = w->size[i] * rho + by;
        }
    }
}

SGT_KERNEL
static void poly_values(const shape *s, size_t n, const sgt_points *p, const poly_points *w,
                        const sgt_values *out, double *restrict own)
{
    const double *x = p->p[0], *y = p->p[1], *z = p->p[2];
    double *restrict f = out->f, *restrict gx = out->grad[0], *restrict gy = out->grad[1],
                     *restrict gz = out->grad[2];
    const double c = s->c, k = s->k;
    const mask terms = MASK(s->terms > 0);
    LANES for (size_t i = 0; i < n; i++)
    {
        double r2 = w->r2[i], base = w->base[i], all = base + r2 * w->h[i],
               steep = w->slope[i] + (w->h[i] + r2 * w->dh[i]), sag = chosen(terms, all, base),
               slope = chosen(terms, steep, w->slope[i]),
               noise = chosen(terms, 4 * r2 * w->size[i] + fabs(all), 0);
        f[i] = z[i] - sag, gx[i] = -2 * x[i] * slope, gy[i] = -2 * y[i] * slope, gz[i] = 1;
        own[i] = 1.01 * SGT_U
                 * (conic_sag_rounding(c, k, r2, base, w->phi[i]) + noise + fabs(z[i] - sag));
    }
}

void sgt_sag_values_rounded(const shape *s, size_t n, sgt_points p, sgt_values out, double own[])
{
    poly_points w;
    for (size_t at = 0, few; at < n; at += few) {
        const sgt_points there = {{p.p[0] + at, p.p[1] + at, p.p[2] + at}};
        const sgt_values to = {out.f + at, {out.grad[0] + at, out.grad[1] + at, out.grad[2] + at}};
        few = n - at < POINTS ? n - at : POINTS;
        mask odd = poly_bases(s, few, there.p[0], there.p[1], &w);
        for (size_t i = 0; odd && i < few; i++)
            if (w.phi[i] == HUGE_VAL) w.base[i] = conic_sag(s->c, s->k, w.r2[i], &w.phi[i], &w.slope[i]);
        if (s->terms) poly_terms(s, few, &w);
        else memset(w.h, 0, sizeof w.h), memset(w.dh, 0, sizeof w.dh), memset(w.size, 0, sizeof w.size);
        poly_values(s, few, &there, &w, &to, own + at);
    }
}
