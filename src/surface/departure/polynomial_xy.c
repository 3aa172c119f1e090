// SPDX-License-Identifier: MIT
/* polynomial_xy.c - P = sum of a[i][j] x^i y^j.
 *
 * Each row is summed by Horner's rule in y: w = sum of a[i][j] y^j, with dw/dy.  The rows are summed by
 * Horner's rule in x.  The derivative is carried along: (sum h)' = h' x + h.
 *
 * ROUNDING.  Each step is one fma.  It rounds by at most u of its result, and this enters P multiplied
 * only by the powers behind it.  The bound follows the same steps (Higham 2002, section 5.1).  x and y are
 * exact.
 *
 * BOUNDS.  The same steps on intervals, as middle and radius: |h x - h_m x_m| <= |h_m| x_r + h_r (|x_m| +
 * x_r).  Over a small region they give the values at its middle and little more.  Over a region about the
 * origin they give the sums of the terms' magnitudes. */
#include "bend.h"
#include "departure.h"

enum { MOST_ROWS = 32 };

/* Row i without the zeros at its end. */
typedef struct xy_row { const double *a; size_t terms; } xy_row;

static xy_row xy_row_of(sgt_numbers a, size_t i)
{
    xy_row e = {a.x + i * a.columns, a.columns};
    while (e.terms > 0 && e.a[e.terms - 1] == 0) e.terms--;
    return e;
}

static size_t xy_rows_of(sgt_numbers a) { return a.columns > 0 ? a.rows : 0; }

/* ---------------------------------------------------------------------------------- P and gradient */

SGT_INLINE void polynomial_in(size_t n, sgt_numbers a, const double *restrict x, const double *restrict y,
                              double *restrict p, double *restrict px, double *restrict py)
{
    double w[DEPARTURE_BLOCK], dw[DEPARTURE_BLOCK];
    LANES for (size_t k = 0; k < n; k++) p[k] = px[k] = py[k] = 0;
    for (size_t i = xy_rows_of(a); i-- > 0;) {
        xy_row of = xy_row_of(a, i);
        LANES for (size_t k = 0; k < n; k++) w[k] = dw[k] = 0;
        /* Four terms for one load and store.  Zeros come first. */
        for (size_t j = of.terms + 3 - (of.terms + 3) % 4; j > 0; j -= 4) {
            double a3 = j > of.terms ? 0 : of.a[j - 1], a2 = j > of.terms + 1 ? 0 : of.a[j - 2],
                   a1 = j > of.terms + 2 ? 0 : of.a[j - 3], a0 = of.a[j - 4];
            LANES for (size_t k = 0; k < n; k++) {
                double t = y[k], d = dw[k], h = w[k];
                d = sgt_fma(d, t, h), h = sgt_fma(h, t, a3);
                d = sgt_fma(d, t, h), h = sgt_fma(h, t, a2);
                d = sgt_fma(d, t, h), h = sgt_fma(h, t, a1);
                d = sgt_fma(d, t, h), h = sgt_fma(h, t, a0);
                dw[k] = d, w[k] = h;
            }
        }
        LANES for (size_t k = 0; k < n; k++) {
            px[k] = sgt_fma(px[k], x[k], p[k]);
            p[k] = sgt_fma(p[k], x[k], w[k]);
            py[k] = sgt_fma(py[k], x[k], dw[k]);
        }
    }
}

/* For a single point the compiler removes the inner loops. */
SGT_KERNEL
static void polynomial_at(size_t n, sgt_numbers a, const double *restrict x, const double *restrict y,
                          double *restrict p, double *restrict px, double *restrict py)
{
    if (n == 1) polynomial_in(1, a, x, y, p, px, py);
    else polynomial_in(n, a, x, y, p, px, py);
}

/* The same sums of P alone. */
SGT_KERNEL
static void polynomial_alone(size_t n, sgt_numbers a, const double *restrict x, const double *restrict y,
                             double *restrict p)
{
    double w[DEPARTURE_BLOCK];
    LANES for (size_t k = 0; k < n; k++) p[k] = 0;
    for (size_t i = xy_rows_of(a); i-- > 0;) {
        xy_row of = xy_row_of(a, i);
        LANES for (size_t k = 0; k < n; k++) w[k] = 0;
        for (size_t j = of.terms + 3 - (of.terms + 3) % 4; j > 0; j -= 4) {
            double a3 = j > of.terms ? 0 : of.a[j - 1], a2 = j > of.terms + 1 ? 0 : of.a[j - 2],
                   a1 = j > of.terms + 2 ? 0 : of.a[j - 3], a0 = of.a[j - 4];
            LANES for (size_t k = 0; k < n; k++) {
                double t = y[k];
                w[k] = sgt_fma(sgt_fma(sgt_fma(sgt_fma(w[k], t, a3), t, a2), t, a1), t, a0);
            }
        }
        LANES for (size_t k = 0; k < n; k++) p[k] = sgt_fma(p[k], x[k], w[k]);
    }
}

static void xy_p(const void *self, size_t n, const double *x, const double *y, double *p)
{
    polynomial_alone(n, ((const sgt_polynomial_xy *)self)->a, x, y, p);
}

static void xy_at(const void *self, size_t n, const double *x, const double *y, sag_values out)
{
    polynomial_at(n, ((const sgt_polynomial_xy *)self)->a, x, y, out.p, out.px, out.py);
}

/* ------------------------------------------------------------------------------------- rounding */

/* A computed number, and how far it is off. */
typedef struct xy_rounded { double is, err; } xy_rounded;

/* h x + a, without fma, which may be a function call.  The numbers differ from those of polynomial_at by
 * at most their errors.  That changes the bound by u times as much. */
static xy_rounded xy_horner(xy_rounded h, double x, xy_rounded a)
{
    double is = h.is * x + a.is;
    return (xy_rounded){is, h.err * fabs(x) + a.err + SGT_U * fabs(is) + 0x1p-1074};
}

static void xy_rounding(const void *self, double x, double y, double *p_err, double *grad_err)
{
    sgt_numbers a = ((const sgt_polynomial_xy *)self)->a;
    xy_rounded p = {0, 0}, px = p, py = p;
    for (size_t i = xy_rows_of(a); i-- > 0;) {
        xy_row of = xy_row_of(a, i);
        xy_rounded w = {0, 0}, dw = w;
        for (size_t j = of.terms; j-- > 0;) {
            dw = xy_horner(dw, y, w);
            w = xy_horner(w, y, (xy_rounded){of.a[j], 0});
        }
        px = xy_horner(px, x, p);
        p = xy_horner(p, x, w);
        py = xy_horner(py, x, dw);
    }
    *p_err = 1.01 * p.err;
    *grad_err = 1.01 * larger(px.err, py.err);
}

/* A term is rounded j + 1 times in its row and i + 1 times over the rows. */
static void xy_noise(const void *self, double radius, double e[2])
{
    sgt_numbers a = ((const sgt_polynomial_xy *)self)->a;
    double power = 1; /* radius to the degree d, or from d = 2 on to d - 2 */
    e[0] = e[1] = 0;
    for (size_t d = 0; a.columns > 0 && d + 1 < a.rows + a.columns; d++) {
        double sum = 0;
        for (size_t i = d < a.columns ? 0 : d + 1 - a.columns; i < a.rows && i <= d; i++)
            sum += fabs(a.x[i * a.columns + (d - i)]);
        e[d > 1] += 1.01 * SGT_U * ((double)d + 2) * sum * power;
        power = d == 1 ? 1 : power * radius;
    }
}

/* --------------------------------------------------------------------------------------- bounds */

typedef struct disc { double middle, radius; } disc;

/* h x + a. */
static disc xy_over(disc h, disc x, disc a)
{
    double product = h.middle * x.middle, middle = product + a.middle;
    double radius = fabs(h.middle) * x.radius + h.radius * (fabs(x.middle) + x.radius) + a.radius;
    return (disc){middle, radius * (1 + 0x1p-50) + 0x1p-52 * (fabs(product) + fabs(middle)) + 0x1p-1060};
}

static disc disc_of(sgt_interval x)
{
    double middle = 0.5 * x.lo + 0.5 * x.hi;
    return (disc){middle, (0.5 * x.hi - 0.5 * x.lo) * (1 + 0x1p-50) + 0x1p-52 * fabs(middle)};
}

static double xy_greatest(disc e) { return fabs(e.middle) + e.radius; }

static double xy_bounded(double x) { return x < HUGE_VAL ? x * (1 + 0x1p-40) : HUGE_VAL; }

/* Over a disc.  There x^i y^j is far less than in the corners of the square, where both are r. */
static bounds disc_bounds(sgt_numbers a, double r)
{
    double h[MOST_HALF_POWERS], size = 0, px = 0, py = 0, xx = 0, xy = 0, yy = 0;
    half_powers(a.rows + a.columns, h);
    for (size_t i = 0; i < a.rows; i++)
        for (size_t j = 0; j < a.columns; j++) {
            double most = fabs(a.x[i * a.columns + j]), n = (double)i, m = (double)j;
            if (most == 0) continue;
            most *= larger(integer_power(r, (unsigned)(i + j)),
                           DBL_MIN); /* if the power underflows, more than it */
            size += most * corner_of(h, i, j), most /= r;
            if (i > 0) px += most * n * corner_of(h, i - 1, j);
            if (j > 0) py += most * m * corner_of(h, i, j - 1);
            most /= r;
            if (i > 1) xx += most * n * (n - 1) * corner_of(h, i - 2, j);
            if (i > 0 && j > 0) xy += most * n * m * corner_of(h, i - 1, j - 1);
            if (j > 1) yy += most * m * (m - 1) * corner_of(h, i, j - 2);
        }
    const double up = 1 + 0x1p-30;
    return (bounds){xy_bounded(size * up), xy_bounded(length_of(px, py) * up), norm_of(xx, xy, yy) * up};
}

static const double XY_STEEP = 64; /* beyond it the disc is tried; below, the square is as good */

static int xy_bounds_over(const void *self, region *where, bounds *out)
{
    sgt_numbers a = ((const sgt_polynomial_xy *)self)->a;
    disc none = {0, 0}, p = none, px = none, py = none, pxx = none, pxy = none, pyy = none,
         x = disc_of(where->x), y = disc_of(where->y);
    for (size_t i = xy_rows_of(a); i-- > 0;) {
        xy_row of = xy_row_of(a, i);
        disc w = none, dw = none, ddw = none; /* the second derivatives halved */
        for (size_t j = of.terms; j-- > 0;) {
            ddw = xy_over(ddw, y, dw);
            dw = xy_over(dw, y, w);
            w = xy_over(w, y, (disc){of.a[j], 0});
        }
        pxx = xy_over(pxx, x, px), px = xy_over(px, x, p), p = xy_over(p, x, w);
        pxy = xy_over(pxy, x, py), py = xy_over(py, x, dw);
        pyy = xy_over(pyy, x, ddw);
    }
    double size = xy_greatest(p), ax = xy_greatest(px), ay = xy_greatest(py), axx = 2 * xy_greatest(pxx),
           axy = xy_greatest(pxy), ayy = 2 * xy_greatest(pyy);
    *out = (bounds){xy_bounded(size), xy_bounded(length_of(ax, ay)), norm_of(axx, axy, ayy)};
    if (out->steep > XY_STEEP && a.rows + a.columns <= MOST_HALF_POWERS
        && is_disc(xy_greatest(x), xy_greatest(y), where->r_hi)) {
        bounds by_disc = disc_bounds(a, where->r_hi);
        if (by_disc.bend < out->bend) *out = by_disc;
    }
    return 1;
}

/* P alone: by the same steps, and in a disc about the origin no more than the terms there add up to. */
static sgt_interval xy_range(const void *self, const region *where)
{
    sgt_numbers a = ((const sgt_polynomial_xy *)self)->a;
    disc p = {0, 0}, x = disc_of(where->x), y = disc_of(where->y);
    for (size_t i = xy_rows_of(a); i-- > 0;) {
        xy_row of = xy_row_of(a, i);
        disc w = {0, 0};
        for (size_t j = of.terms; j-- > 0;) w = xy_over(w, y, (disc){of.a[j], 0});
        p = xy_over(p, x, w);
    }
    double radius = xy_bounded(p.radius) + 0x1p-40 * fabs(p.middle);
    sgt_interval square = {p.middle - radius, p.middle + radius};
    if (!(radius < HUGE_VAL)) square = sgt_interval_all();
    const double r = where->r_hi;
    if (a.rows + a.columns > MOST_HALF_POWERS || !is_disc(xy_greatest(x), xy_greatest(y), r)) return square;
    double h[MOST_HALF_POWERS], size = 0;
    half_powers(a.rows + a.columns, h);
    for (size_t i = 0; i < xy_rows_of(a); i++) {
        xy_row of = xy_row_of(a, i);
        double power = integer_power(r, (unsigned)i);
        for (size_t j = 0; j < of.terms; j++, power *= r)
            if (of.a[j] != 0) size += fabs(of.a[j]) * larger(power, DBL_MIN) * corner_of(h, i, j);
    }
    size = xy_bounded(size * (1 + 0x1p-30));
    if (!(size < HUGE_VAL)) return square;
    return sgt_interval_between(larger(square.lo, -size), -larger(-square.hi, -size));
}

/* The noise and the gradient by degree: both are sums over the terms of a degree, times a power of r. */
static double xy_along_off(const void *self, double radius)
{
    sgt_numbers a = ((const sgt_polynomial_xy *)self)->a;
    double h[MOST_HALF_POWERS], size[2 * MOST_ROWS] = {0}, steep[2 * MOST_ROWS] = {0}, power = 1, off = 0;
    if (xy_rows_of(a) == 0) return 0; /* it may name any number of columns */
    half_powers(a.rows + a.columns, h);
    size_t degrees = 1;
    for (size_t i = 0; i < xy_rows_of(a); i++) {
        xy_row of = xy_row_of(a, i);
        for (size_t j = 0; j < of.terms; j++) {
            double most = fabs(of.a[j]);
            size[i + j] += most;
            if (i > 0) steep[i + j] += most * (double)i * corner_of(h, i - 1, j);
            if (j > 0) steep[i + j] += most * (double)j * corner_of(h, i, j - 1);
        }
        if (i + of.terms > degrees) degrees = i + of.terms;
    }
    for (size_t d = 0; d < degrees; d++, power = larger(power * radius, DBL_MIN))
        off += power * (1.01 * SGT_U * ((double)d + 2) * size[d] + 0x1p-46 * steep[d]);
    return xy_bounded(off * (1 + 0x1p-30));
}

/* ------------------------------------------------------------------------------------ sensitivities */

SGT_KERNEL
static void polynomial_second(size_t n, sgt_numbers a, const double *restrict x, const double *restrict y,
                              double *restrict pxx, double *restrict pxy, double *restrict pyy)
{
    double p[DEPARTURE_BLOCK], px[DEPARTURE_BLOCK], py[DEPARTURE_BLOCK], w[DEPARTURE_BLOCK],
        dw[DEPARTURE_BLOCK], ddw[DEPARTURE_BLOCK];
    LANES for (size_t k = 0; k < n; k++) p[k] = px[k] = py[k] = pxx[k] = pxy[k] = pyy[k] = 0;
    for (size_t i = xy_rows_of(a); i-- > 0;) {
        xy_row of = xy_row_of(a, i);
        LANES for (size_t k = 0; k < n; k++) w[k] = dw[k] = ddw[k] = 0;
        for (size_t j = of.terms; j-- > 0;) {
            double next = of.a[j];
            LANES for (size_t k = 0; k < n; k++) {
                ddw[k] = sgt_fma(ddw[k], y[k], 2 * dw[k]);
                dw[k] = sgt_fma(dw[k], y[k], w[k]);
                w[k] = sgt_fma(w[k], y[k], next);
            }
        }
        LANES for (size_t k = 0; k < n; k++) {
            pxx[k] = sgt_fma(pxx[k], x[k], 2 * px[k]);
            px[k] = sgt_fma(px[k], x[k], p[k]);
            p[k] = sgt_fma(p[k], x[k], w[k]);
            pxy[k] = sgt_fma(pxy[k], x[k], py[k]);
            py[k] = sgt_fma(py[k], x[k], dw[k]);
            pyy[k] = sgt_fma(pyy[k], x[k], ddw[k]);
        }
    }
}

SGT_NARROW(void, sgt_xy_second,
           (const void *self, size_t n, const double *x, const double *y, double *pxx, double *pxy,
            double *pyy))
{
    polynomial_second(n, ((const sgt_polynomial_xy *)self)->a, x, y, pxx, pxy, pyy);
}

static size_t xy_parameters(const void *self)
{
    sgt_numbers a = ((const sgt_polynomial_xy *)self)->a;
    return a.rows * a.columns;
}

/* x^i y^j, i x^(i-1) y^j, j x^i y^(j-1). */
SGT_KERNEL
static void monomial(size_t i, size_t j, size_t n, const double *restrict x, const double *restrict y,
                     double *restrict p, double *restrict px, double *restrict py)
{
    /* x^(i-1), y^(j-1), or 1 */
    double u[DEPARTURE_BLOCK], v[DEPARTURE_BLOCK], di = (double)i, dj = (double)j;
    LANES for (size_t k = 0; k < n; k++) u[k] = v[k] = 1;
    for (size_t m = 1; m < i; m++)
        LANES for (size_t k = 0; k < n; k++) u[k] *= x[k];
    for (size_t m = 1; m < j; m++)
        LANES for (size_t k = 0; k < n; k++) v[k] *= y[k];
    LANES for (size_t k = 0; k < n; k++) {
        double xi = chosen(MASK(i > 0), u[k] * x[k], 1), yj = chosen(MASK(j > 0), v[k] * y[k], 1);
        p[k] = xi * yj;
        px[k] = di * u[k] * yj;
        py[k] = dj * xi * v[k];
    }
}

SGT_NARROW(void, sgt_xy_by_parameter,
           (const void *self, size_t j, size_t n, const double *x, const double *y, sag_values out))
{
    size_t columns = ((const sgt_polynomial_xy *)self)->a.columns;
    monomial(j / columns, j % columns, n, x, y, out.p, out.px, out.py);
}

static sgt_objection xy_object(const void *self)
{
    sgt_numbers a = ((const sgt_polynomial_xy *)self)->a;
    const char *reason = a.rows == 0 || a.columns == 0 ? NULL
                         : a.rows > MOST_ROWS || a.columns > MOST_ROWS
                             ? "must have at most 32 rows and 32 columns"
                         : !a.x                                     ? "has no numbers"
                         : !numbers_finite(a.rows * a.columns, a.x) ? "must be finite"
                                                                    : NULL;
    return (sgt_objection){reason ? "coefficients" : NULL, reason};
}

/* Home is the first power of two at which the slopes of all terms may add up to 1. */
static bool xy_along(const void *self, sgt_course *out)
{
    sgt_numbers a = ((const sgt_polynomial_xy *)self)->a;
    double sum[2 * MOST_ROWS] = {0};
    *out = (sgt_course){0, false, 0};
    for (size_t i = 0; i < xy_rows_of(a); i++) {
        xy_row of = xy_row_of(a, i);
        for (size_t j = 0; j < of.terms; j++) sum[i + j] += fabs(of.a[j]) * (double)(i + j);
        if (of.terms > 0 && i + of.terms - 1 > out->degree) out->degree = i + of.terms - 1;
    }
    if (out->degree < 2) return true;
    double r = 0x1p-20, slope = 0;
    for (int k = 0; k < 60 && !(slope >= 1); k++) {
        r *= 2, slope = 0;
        for (size_t d = out->degree; d > 1; d--) slope = (slope + sum[d]) * r;
    }
    out->home = slope >= 1 && slope < HUGE_VAL ? r : 0;
    return true;
}

static const departure polynomial_xy_departure = {
    .at = xy_at, .rounding = xy_rounding, .bounds = xy_bounds_over, .second = sgt_xy_second,
    .parameters = xy_parameters, .by_parameter = sgt_xy_by_parameter, .object = xy_object, .noise = xy_noise,
    .range = xy_range, .along = xy_along, .along_off = xy_along_off, .alone = xy_p};

DEPARTURE_ON_CONIC(polynomial_xy, sgt_polynomial_xy)
