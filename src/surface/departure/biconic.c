// SPDX-License-Identifier: MIT
/* biconic.c - two curvatures and two conic constants, under one root.
 *
 * THE SAG.  s = N / w with w = 1 + phi, N = c_x x^2 + c_y y^2, phi^2 = D = 1 - A x^2 - B y^2, A = (1 +
 * k_x) c_x^2, and B likewise.  This is the form of lens programs.  No curvature is a special case.
 *
 * THE DERIVATIVES follow from N = s w:
 *     s_x = x G_x,   G_x = (2 c_x + A h) / w,   h = s / phi,   and for y likewise,
 *     s_ij = G_i [i = j] + M_ij x_i x_j,   M_ij = (G_i A_j + G_j A_i + h A_i A_j / phi) / (phi w),
 *         with A_x = A, A_y = B.
 * For a parameter q, with N_q and E = -D_q / 2 (so that phi_q = -E / phi),
 *     s_q = (N_q + h E) / w,
 *     s_qi = (N_qi + (s_i E + s E_i) / phi + s_q A_i x_i / phi + h E A_i x_i / phi^2) / w,
 *     for c: N_q = x^2, E = (1 + k) c x^2;   for k: N_q = 0, E = c^2 x^2 / 2.
 * All is computed from u = c_x x and v = c_y y.  So c^2, which may overflow, does not occur by itself in
 * s.
 *
 * ROUNDING, with e = 2^-53.  Each term of N is rounded 3 times, and the terms of D 5 times.  phi is off by
 * the error of D over sqrt(D) + sqrt(D - its error), and never by more than the root of that error; 1 / w,
 * w >= 1, carries it.  Only this grows toward the edge of the domain.  From there the error is carried on
 * line by line, as the lines of `at` are, and enlarged by 2^-20 for its own rounding.
 *
 * BOUNDS.  N and D are linear in (x^2, y^2).  That point lies in a rectangle less the corner that x^2 +
 * y^2 <= r_hi^2 cuts off.  So their extremes are at the corners of that pentagon.  From them, by
 * intervals, the lines above.  |grad s|^2 = G_x^2 x^2 + G_y^2 y^2 is bounded in the same way.  The norm of
 * diag(G) + (M_ij x_i x_j) has two bounds: the norm of the magnitudes, and the greatest |G| + the greatest
 * |M| r^2.  For a sphere the second is what a sphere has at r_hi. */
#include "../../num/bits.h"
#include "bend.h"
#include "departure.h"

SGT_KERNEL
static void biconic_sag(const sgt_biconic *self, size_t n, const double *restrict px,
                        const double *restrict py, double *restrict p, double *restrict gx,
                        double *restrict gy)
{
    const double cx = self->c_x, cy = self->c_y, kx = 1 + self->k_x, ky = 1 + self->k_y, ax = kx * cx,
                 ay = ky * cy;
    LANES for (size_t i = 0; i < n; i++) {
        double x = px[i], y = py[i], u = cx * x, v = cy * y;
        double phi = sqrt((1 - kx * u * u) - ky * v * v), over_w = 1 / (1 + phi);
        double s = (u * x + v * y) * over_w;
        /* At the equator the gradient is huge but finite, not NaN. */
        double h = s / larger(phi, 0x1p-400);
        p[i] = s;
        gx[i] = u * (2 + ax * h) * over_w;
        gy[i] = v * (2 + ay * h) * over_w;
    }
}

static void biconic_at(const void *self, size_t n, const double *x, const double *y, sag_values out)
{
    biconic_sag(self, n, x, y, out.p, out.px, out.py);
}

static void biconic_off(const void *self, double x, double y, double *p_err, double *grad_err)
{
    const sgt_biconic *b = self;
    const double e = SGT_U, least = 0x1p-1060, more = 1 + 0x1p-20;
    double u = b->c_x * x, v = b->c_y * y, kx = 1 + b->k_x, ky = 1 + b->k_y, tx = kx * u * u, ty = ky * v * v,
           d1 = 1 - tx, d = d1 - ty;
    double d_err = e * (5 * (fabs(tx) + fabs(ty)) + fabs(d1) + fabs(d)) * more, phi = sqrt(d),
           low = sqrt(larger(d - d_err, 0)), rest = phi + low;
    *p_err = *grad_err = HUGE_VAL;
    if (!(d >= 0)) return; /* NaN; the sag may still exist */
    double root = sqrt(d_err), phi_err = (rest * root > d_err ? d_err / rest : root) + e * phi;
    double w = 1 + phi, w_err = phi_err + e * w, w_low = larger(w - w_err, 1),
           terms = fabs(u * x) + fabs(v * y), s = (u * x + v * y) / w;
    double s_err = (3 * e * terms + fabs(s) * w_err) / w_low + e * fabs(s);
    *p_err = s_err * more + least;
    if (!(low > 0)) return;
    double h = s / phi, h_err = (s_err + fabs(h) * phi_err) / low + e * fabs(h), worst = 0;
    for (int j = 0; j < 2; j++) {
        double a = j ? ky * b->c_y : kx * b->c_x, c = fabs(j ? v : u), q = fabs(a * h), t = fabs(2 + a * h);
        double t_err = fabs(a) * h_err + 3 * e * q + e * t;
        worst = larger(worst, c * (t_err + t * (w_err / w_low + 4 * e)) / w_low);
    }
    *grad_err = worst * more + least;
    if (!(*grad_err < HUGE_VAL)) *grad_err = HUGE_VAL; /* NaN too */
}

/* Corners of the set of (x^2, y^2). */
typedef struct pentagon { double x[5], y[5]; } pentagon;

static pentagon squares_in(const region *where)
{
    sgt_interval x = sgt_interval_square(where->x), y = sgt_interval_square(where->y);
    double r2 = sgt_product_above(where->r_hi, where->r_hi), x_far, y_far, x_by, y_by;
    x_far = smaller(x.hi, larger(sgt_sum_above(r2, -y.lo), x.lo));
    y_far = smaller(y.hi, larger(sgt_sum_above(r2, -x.lo), y.lo));
    x_by = smaller(x_far, larger(sgt_sum_above(r2, -y_far), x.lo));
    y_by = smaller(y_far, larger(sgt_sum_above(r2, -x_far), y.lo));
    return (pentagon){{x.lo, x_far, x_far, x_by, x.lo}, {y.lo, y.lo, y_by, y_far, y_far}};
}

/* a X + b Y over the pentagon. */
static sgt_interval linear_over(const pentagon *at, sgt_interval a, sgt_interval b)
{
    sgt_interval all = sgt_interval_empty();
    for (int i = 0; i < 5; i++)
        all = sgt_interval_hull(
            all, sgt_interval_sum(sgt_interval_scaled(a, at->x[i]), sgt_interval_scaled(b, at->y[i])));
    return all;
}

/* The part of x outside of which A x^2 + B Y > 1 for all the Y. */
static sgt_interval clipped(sgt_interval x, sgt_interval a, sgt_interval by)
{
    if (!(a.lo > 0)) return x;
    sgt_interval far = sgt_interval_square_root(
        sgt_interval_quotient(sgt_interval_difference(sgt_interval_of(1), by), a));
    return sgt_interval_intersection(x, sgt_interval_between(-far.hi, far.hi));
}

/* (1 + k) c^2. */
static sgt_interval biconic_bent_by(double c, double k)
{
    sgt_interval of = sgt_interval_of(c);
    return sgt_interval_product(
        sgt_interval_product(sgt_interval_sum(sgt_interval_of(1), sgt_interval_of(k)), of), of);
}

/* phi and s over the region, which is cut to the domain.  Returns what `bounds` does. */
static int biconic_over(const sgt_biconic *b, region *where, sgt_interval *root, sgt_interval *sag)
{
    sgt_interval one = {1, 1}, cx = sgt_interval_of(b->c_x), cy = sgt_interval_of(b->c_y),
                 A = biconic_bent_by(b->c_x, b->k_x), B = biconic_bent_by(b->c_y, b->k_y);
    pentagon at = squares_in(where);
    sgt_interval D = sgt_interval_difference(one, linear_over(&at, A, B));
    int defined = 1;
    if (D.hi < 0) return 0;
    if (!(D.lo >= 0)) {
        defined = -1;
        where->x = clipped(where->x, A, sgt_interval_product(B, sgt_interval_square(where->y)));
        where->y = clipped(where->y, B, sgt_interval_product(A, sgt_interval_square(where->x)));
        if (sgt_interval_is_empty(where->x) || sgt_interval_is_empty(where->y)) return 0;
        at = squares_in(where);
    }
    *root = sgt_interval_square_root(D);
    *sag = sgt_interval_quotient(linear_over(&at, cx, cy), sgt_interval_sum(one, *root));
    return defined;
}

SGT_NARROW(sgt_interval, sgt_biconic_range, (const void *self, const region *where))
{
    region part = *where;
    sgt_interval phi, s;
    return biconic_over(self, &part, &phi, &s) ? s : sgt_interval_empty();
}

/* G + M x^2 where |x| is at most this. */
static sgt_interval entry_of(sgt_interval G, sgt_interval M, double x)
{
    double x2 = x * x, lo = G.lo - larger(-M.lo, 0) * x2, hi = G.hi + larger(M.hi, 0) * x2,
           off = 0x1p-40 * (larger(-G.lo, G.hi) + larger(-M.lo, M.hi) * x2);
    return sgt_interval_between(lo - off, hi + off);
}

SGT_NARROW(int, sgt_biconic_apart,
           (const void *self, region *where, bounds *out, sgt_by_axis *axis,
            sgt_interval *heights))
{
    const sgt_biconic *b = self;
    sgt_interval phi, s, cx = sgt_interval_of(b->c_x), cy = sgt_interval_of(b->c_y),
                         A = biconic_bent_by(b->c_x, b->k_x), B = biconic_bent_by(b->c_y, b->k_y);
    int defined = biconic_over(b, where, &phi, &s);
    if (!defined) return 0;
    pentagon at = squares_in(where);
    sgt_interval w = sgt_interval_sum(sgt_interval_of(1), phi);
    /* Where it may be undefined, size is infinite: no graze is told by it. */
    *out = (bounds){defined == 1 ? sgt_interval_greatest(s) : HUGE_VAL, HUGE_VAL, HUGE_VAL};
    *heights = s;
    if (!(phi.lo > 0)) return defined;

    sgt_interval h = sgt_interval_quotient(s, phi), s2 = sgt_interval_quotient(h, phi),
                 of = sgt_interval_product(phi, w);
    sgt_interval Gx = sgt_interval_quotient(
        sgt_interval_sum(sgt_interval_scaled(cx, 2), sgt_interval_product(A, h)), w);
    sgt_interval Gy = sgt_interval_quotient(
        sgt_interval_sum(sgt_interval_scaled(cy, 2), sgt_interval_product(B, h)), w);
    sgt_interval xx = sgt_interval_sum(sgt_interval_scaled(sgt_interval_product(Gx, A), 2),
                                       sgt_interval_product(s2, sgt_interval_square(A)));
    sgt_interval yy = sgt_interval_sum(sgt_interval_scaled(sgt_interval_product(Gy, B), 2),
                                       sgt_interval_product(s2, sgt_interval_square(B)));
    sgt_interval xy = sgt_interval_sum(
        sgt_interval_sum(sgt_interval_product(Gx, B), sgt_interval_product(Gy, A)),
        sgt_interval_product(s2, sgt_interval_product(A, B)));
    double gx = sgt_interval_greatest(Gx), gy = sgt_interval_greatest(Gy),
           x = sgt_interval_greatest(where->x), y = sgt_interval_greatest(where->y);
    sgt_interval by_x = sgt_interval_quotient(xx, of), by_y = sgt_interval_quotient(yy, of);
    double mx = sgt_interval_greatest(by_x), my = sgt_interval_greatest(by_y);
    double mxy = sgt_interval_greatest(sgt_interval_quotient(xy, of)), more = 1 + 0x1p-40, r = where->r_hi;
    sgt_interval steep2 = linear_over(&at, sgt_interval_square(sgt_interval_of(gx)),
                                      sgt_interval_square(sgt_interval_of(gy)));
    out->steep = sgt_square_root_above(steep2.hi);
    *axis = (sgt_by_axis){gx * x * more, gy * y * more, mxy * (x * y) * more, 0,
                          entry_of(Gx, by_x, x), entry_of(Gy, by_y, y)};
    double by_entry = norm_of(gx + mx * (x * x), mxy * (x * y), gy + my * (y * y)) * more;
    double by_r = (larger(gx, gy) + larger(larger(mx, my), mxy) * (r * r)) * more;
    out->bend = by_r < by_entry ? by_r : by_entry;
    return defined;
}

/* BY SIZE: as by_axis about the axis, where the surface is gentle, by sums of magnitudes: a twentieth of the
 * cost.  Let |x| <= X, |y| <= Y, r <= R, phi in [f, F] and |s| <= S.  With N and D above
 *     f^2 = 1 - (A_+ X^2 + B_+ Y^2), or 1 - larger(A_+, B_+) R^2,   F^2 = 1 + A_- X^2 + B_- Y^2,
 *     |G_x| <= (2 |c_x| + |A| H) / (1 + f),   H = S / f,
 *     G_x in 2 c_x / (1 + phi) +- |A| H / (1 + f),
 * and M by its formula.  All are rounded some dozens of times; 2^-20 is added.  false: not gentle. */
static bool biconic_by_size(const sgt_biconic *b, const region *where, bounds *out, sgt_by_axis *axis,
                            sgt_interval *heights)
{
    const double x = where->x.hi, y = where->y.hi, r = where->r_hi, more = 1 + 0x1p-20;
    const double x2 = x * x, y2 = y * y, r2 = r * r, A = (1 + b->k_x) * b->c_x * b->c_x,
                 B = (1 + b->k_y) * b->c_y * b->c_y, a_size = fabs(A),
                 b_size = fabs(B), a_up = larger(A, 0), b_up = larger(B, 0);
    if (!(where->x.lo == -x && where->y.lo == -y && r < 0x1p400)) return false;
    const double in_box = 1 - (a_up * x2 + b_up * y2) * more, in_disc = 1 - larger(a_up, b_up) * r2 * more,
                 f2 = larger(in_box, in_disc);
    if (!(f2 > 0.25)) return false;
    const double f = sqrt(f2), w = 1 + f, of = f * w,
                 w_most = 1 + sqrt(1 + (larger(-A, 0) * x2 + larger(-B, 0) * y2) * more);
    const double cx = fabs(b->c_x), cy = fabs(b->c_y), size = (cx * x2 + cy * y2) / w * more, h = size / f,
                 gx_off = a_size * h / w, gy_off = b_size * h / w, gx = (2 * cx / w + gx_off) * more,
                 gy = (2 * cy / w + gy_off) * more;
    const double mx = (2 * gx * a_size + h / f * (a_size * a_size)) / of * more,
                 my = (2 * gy * b_size + h / f * (b_size * b_size)) / of * more,
                 mxy = (gx * b_size + gy * a_size + h / f * (a_size * b_size)) / of * more;
    const double by_box = sqrt(gx * gx * x2 + gy * gy * y2), by_disc = larger(gx, gy) * r,
                 steep = (by_box < by_disc ? by_box : by_disc) * more;
    if (!(steep < 1)) return false;
    const double x_most = gx + mx * x2, y_most = gy + my * y2, xy = mxy * (x * y),
                 x_least = 2 * cx / w_most / more - (gx_off + mx * x2) * more,
                 y_least = 2 * cy / w_most / more - (gy_off + my * y2) * more;
    *axis = (sgt_by_axis){gx * x * more, gy * y * more, xy * more, 0,
                          b->c_x < 0 ? sgt_interval_between(-x_most * more, -x_least)
                                     : sgt_interval_between(x_least, x_most * more),
                          b->c_y < 0 ? sgt_interval_between(-y_most * more, -y_least)
                                     : sgt_interval_between(y_least, y_most * more)};
    heights->lo = -(larger(-b->c_x, 0) * x2 + larger(-b->c_y, 0) * y2) / w * more;
    heights->hi = (larger(b->c_x, 0) * x2 + larger(b->c_y, 0) * y2) / w * more;
    out->size = size, out->steep = steep;
    const double by_entry = norm_of(x_most, xy, y_most),
                 by_r = larger(gx, gy) + larger(larger(mx, my), mxy) * r2;
    out->bend = (by_r < by_entry ? by_r : by_entry) * more;
    return out->bend < HUGE_VAL;
}

static int biconic_about(const void *self, region *where, bounds *out, sgt_by_axis *axis,
                         sgt_interval *heights)
{
    if (biconic_by_size(self, where, out, axis, heights)) return 1;
    return sgt_biconic_apart(self, where, out, axis, heights);
}

static int biconic_bounds(const void *self, region *where, bounds *out)
{
    sgt_by_axis unused;
    sgt_interval heights;
    return sgt_biconic_apart(self, where, out, &unused, &heights);
}

/* The lines of biconic_off, if the magnitudes of the two terms of D are at most t together, and their sum is
 * at most `most`; c is the greater curvature. */
static void biconic_noise_of(const sgt_biconic *b, double t, double most, double e[2])
{
    const double u = SGT_U, c = larger(fabs(b->c_x), fabs(b->c_y));
    double phi2 = 1 - most, phi = sqrt(phi2);
    if (!(phi2 > 0x1p-20)) return;
    double w_err = u * (7 * t + 2) / (1.99 * phi * (1 + phi)) + 2 * u; /* over w */
    e[0] = 0x1p-1060, e[1] = c / (1 + phi) * (4 * u + w_err) * (1 + 0x1p-20);
}

/* With (1 + k) c^2 of the worse axis in all directions.  All grow with the radius. */
static void biconic_noise(const void *self, double radius, double e[2])
{
    const sgt_biconic *b = self;
    const double ax = (1 + b->k_x) * b->c_x * b->c_x, ay = (1 + b->k_y) * b->c_y * b->c_y;
    biconic_noise_of(b, larger(fabs(ax), fabs(ay)) * (radius * radius),
                     larger(larger(ax, ay), 0) * (radius * radius), e);
}

static void biconic_noise_in_box(const void *self, double x, double y, double e[2])
{
    const sgt_biconic *b = self;
    const double u = b->c_x * x, v = b->c_y * y, tx = (1 + b->k_x) * (u * u), ty = (1 + b->k_y) * (v * v);
    biconic_noise_of(b, fabs(tx) + fabs(ty), larger(tx, 0) + larger(ty, 0), e);
}

SGT_KERNEL
static void biconic_bent(const sgt_biconic *self, size_t n, const double *restrict px,
                         const double *restrict py, double *restrict pxx, double *restrict pxy,
                         double *restrict pyy)
{
    const double cx = self->c_x, cy = self->c_y, kx = 1 + self->k_x, ky = 1 + self->k_y, ax = kx * cx,
                 ay = ky * cy;
    LANES for (size_t i = 0; i < n; i++) {
        double x = px[i], y = py[i], u = cx * x, v = cy * y, phi = sqrt((1 - kx * u * u) - ky * v * v),
               over_w = 1 / (1 + phi), over_phi = 1 / phi;
        /* f = -grad phi */
        double h = (u * x + v * y) * over_w * over_phi, fx = ax * u * over_phi, fy = ay * v * over_phi;
        double gx = (2 + ax * h) * over_w, gy = (2 + ay * h) * over_w;
        pxx[i] = cx * gx + (2 * u * gx * fx + h * fx * fx) * over_w;
        pyy[i] = cy * gy + (2 * v * gy * fy + h * fy * fy) * over_w;
        pxy[i] = (u * gx * fy + v * gy * fx + h * fx * fy) * over_w;
    }
}

static void biconic_second(const void *self, size_t n, const double *x, const double *y, double *pxx,
                           double *pxy, double *pyy)
{
    biconic_bent(self, n, x, y, pxx, pxy, pyy);
}

static size_t biconic_parameter_count(const void *self) { (void)self; return 4; }

/* By c or k of the x axis.  Those of y are the same with the axes exchanged, also in `out`. */
SGT_KERNEL
static void biconic_by_axis(const sgt_biconic *b, bool by_c, size_t n, const double *restrict px,
                            const double *restrict py, sag_values out)
{
    const double cx = b->c_x, kx = 1 + b->k_x, cy = b->c_y, ky = 1 + b->k_y;
    double *restrict p = out.p, *restrict gx = out.px, *restrict gy = out.py;
    const double ax = kx * cx, ay = ky * cy, n_by = by_c ? 1 : 0, e_by = by_c ? ax : 0.5 * cx * cx;
    LANES for (size_t i = 0; i < n; i++) {
        double x = px[i], y = py[i], u = cx * x, v = cy * y, phi = sqrt((1 - kx * u * u) - ky * v * v),
               over_w = 1 / (1 + phi), over_phi = 1 / phi;
        double s = (u * x + v * y) * over_w, h = s * over_phi, fx = ax * u * over_phi, fy = ay * v * over_phi;
        double sx = u * (2 + ax * h) * over_w, sy = v * (2 + ay * h) * over_w, ex = e_by * x,
               e = ex * x * over_phi;
        double by = (n_by * (x * x) + s * e) * over_w, rest = by + h * e;
        p[i] = by;
        gx[i] = (2 * n_by * x + sx * e + 2 * h * ex + rest * fx) * over_w;
        gy[i] = (sy * e + rest * fy) * over_w;
    }
}

static void biconic_by_parameter_of(const void *self, size_t j, size_t n, const double *x, const double *y,
                                    sag_values out)
{
    const sgt_biconic *b = self, turned = {.c_x = b->c_y, .k_x = b->k_y, .c_y = b->c_x, .k_y = b->k_x};
    if (j < 2) biconic_by_axis(b, j == 0, n, x, y, out);
    else biconic_by_axis(&turned, j == 2, n, y, x, (sag_values){out.p, out.py, out.px});
}

static sgt_objection biconic_objection(const void *self)
{
    const sgt_biconic *b = self;
    const double numbers[] = {b->c_x, b->k_x, b->c_y, b->k_y};
    static const char *const names[] = {"curvature_x", "conic_x", "curvature_y", "conic_y"};
    for (int i = 0; i < 4; i++)
        if (!(fabs(numbers[i]) < HUGE_VAL)) return (sgt_objection){names[i], "must be finite"};
    return (sgt_objection){NULL, NULL};
}

static const departure biconic_departure = {.at = biconic_at,
                                            .rounding = biconic_off,
                                            .bounds = biconic_bounds,
                                            .range = sgt_biconic_range,
                                            .second = biconic_second,
                                            .parameters = biconic_parameter_count,
                                            .by_parameter = biconic_by_parameter_of,
                                            .object = biconic_objection,
                                            .noise = biconic_noise,
                                            .noise_in_box = biconic_noise_in_box,
                                            .by_axis = biconic_about,
                                            .ahead = sgt_biconic_ahead};

/* The seed: a conic with both curvatures, and the conic constant of the stronger axis. */
static departure_sag biconic_on_conic(const sgt_biconic *b)
{
    double k = fabs(b->c_x) > fabs(b->c_y) ? b->k_x : b->k_y;
    double A = (1 + b->k_x) * b->c_x * b->c_x, B = (1 + b->k_y) * b->c_y * b->c_y, least = A < B ? A : B,
           reach = least > 0x1p-900 ? (1 + 0x1p-40) / sqrt(least) : 0;
    return (departure_sag){.c = 0.5 * (b->c_x + b->c_y),
                           .lean = 0.5 * (b->c_x - b->c_y),
                           .k = k,
                           .semi_diameter = b->semi_diameter,
                           .of = &biconic_departure,
                           .self = b,
                           .reach = reach};
}

DEPARTURE_OPS(biconic, sgt_biconic, biconic_on_conic)
