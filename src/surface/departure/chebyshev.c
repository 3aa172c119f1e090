// SPDX-License-Identifier: MIT
/* chebyshev.c - a sum of products of Chebyshev polynomials of x and of y, on a conic.
 *
 * T_n and U_n-1 = T_n' / n are computed by the addition theorem of the angle.  With x = cos u and w = 1 -
 * x^2 = (1 - x)(1 + x):
 *     T_n+1 = x T_n - w U_n-1,   U_n = x U_n-1 + T_n.
 * On (T, sqrt(w) U) a step is a rotation by u, so the rounding of a step does not grow.  The three-term
 * recurrence makes it n times as large near |x| = 1, and so does Clenshaw's sum.  Beyond |x| = 1 all terms
 * of a step have one sign.
 *
 * For a block of points the T_j and T_j' of y are tabulated, 20 columns at a time.  Then each coefficient
 * costs two fma, one for B_i = sum over j of a_ij T_j and one for B_i'.  P = sum of T_i B_i, P_x = sum of
 * T_i' B_i, P_y = sum of T_i B_i'.  Two rows and four columns are taken at once, so that arithmetic takes
 * the time, and not loads and stores.
 *
 * ROUNDING, in units of u = 2^-53, with sigma = sqrt w.  1 - x^2 is off by 3 of itself.  So a step rounds
 * T_n+1 by |T_n+1| + 4 |w U_n-1| and U_n by |U_n|; on (T, sigma U) that is k = sqrt 2 + 4 sigma at most.
 * After n steps T_n is off by at most n k, and U_n-1 by n k / sigma.  By the second line of the step U_n
 * is off by the error of U_n-1, that of T_n, and n + 1.  So U_n-1 is also off by at most (k + 1) n^2 / 2 +
 * n.  Beyond |x| = 1 a step adds at most 5 to the relative error of both.  x / norm is off by 1 of itself:
 * that moves T_n by |x T_n'| and T_n' by |x T_n''|.  A term goes through at most 24 sums of its row's
 * panel, and one for each row and panel.
 *
 * BOUNDS within |x| <= 1:
 *     |T_n| <= 1,    |T_n'| <= min(n^2, n / sigma),
 *     |T_n''| = |x T_n' - n^2 T_n| / w <= (n / sigma + n^2) / w, and <= n^2 (n^2 - 1) / 3
 * (V. A. Markov; Mason and Handscomb 2002, section 2.4.5).  Beyond, all derivatives increase, so their
 * values at the far end are taken.
 *
 * Far out, over a disc of radius r, r = R norm, more is known.  T_i(x) / x^i increases beyond 1, because
 * all its zeros are nearer.  So |T_i(x)| <= T_i(R) max(x / R, 1 / R)^i, and likewise for the derivatives.
 * Over the disc the product of two such factors is at most the maximum of x^i y^j, unless one of them is 1
 * / R^i. */
#include "bend.h"
#include "departure.h"

enum { MOST = 64, PANEL = 20, STRIP = 32, NONE = MOST * MOST };

/* For all points: the argument, 1 - x^2, T_n and U_n-1. */
typedef struct turning { double x[STRIP], w[STRIP], t[STRIP], u[STRIP]; } turning;

SGT_INLINE void start(turning *a, double norm, size_t n, const double *x)
{
    LANES
    for (size_t i = 0; i < n; i++) {
        double v = x[i] / norm;
        a->x[i] = v, a->w[i] = (1 - v) * (1 + v), a->t[i] = 1, a->u[i] = 0;
    }
}

SGT_INLINE void turn_one(double x, double w, double *t, double *u)
{
    double t1 = sgt_fma(x, *t, -w * *u);
    *u = sgt_fma(x, *u, *t), *t = t1;
}

/* The coefficient, or 0 beyond the table.  If only < NONE, that one is 1 and all others are 0. */
static double coefficient(const sgt_chebyshev *s, size_t only, size_t i, size_t j)
{
    if (i >= s->a.rows || j >= s->a.columns) return 0;
    size_t at = i * s->a.columns + j;
    return only < NONE ? at == only : s->a.x[at];
}

SGT_INLINE void sum_products(const sgt_chebyshev *s, size_t only, size_t n, const double *x, const double *y,
                             double *restrict p, double *restrict px, double *restrict py)
{
    turning a, b;
    double t[PANEL][STRIP], d[PANEL][STRIP]; /* T_j and T_j' of the panel */
    double b0[STRIP], b1[STRIP], d0[STRIP], d1[STRIP];
    size_t rows = s->a.rows, columns = s->a.columns;
    LANES
    for (size_t i = 0; i < n; i++) p[i] = px[i] = py[i] = 0;
    start(&b, s->norm_y, n, y);
    for (size_t from = 0; from < columns; from += PANEL) {
        size_t wide = columns - from < PANEL ? (columns - from + 3) / 4 * 4 : PANEL;
        for (size_t j = 0; j < wide; j++) {
            const double degree = (double)(from + j);
            double *restrict tj = t[j], *restrict dj = d[j];
            LANES
            for (size_t i = 0; i < n; i++) {
                double tn = b.t[i], un = b.u[i];
                tj[i] = tn, dj[i] = degree * un;
                turn_one(b.x[i], b.w[i], &tn, &un);
                b.t[i] = tn, b.u[i] = un;
            }
        }
        start(&a, s->norm_x, n, x);
        for (size_t row = 0; row < rows; row += 2) {
            LANES
            for (size_t i = 0; i < n; i++) b0[i] = b1[i] = d0[i] = d1[i] = 0;
            for (size_t j = 0; j < wide; j += 4) {
                const double a00 = coefficient(s, only, row, from + j),
                             a01 = coefficient(s, only, row, from + j + 1);
                const double a02 = coefficient(s, only, row, from + j + 2),
                             a03 = coefficient(s, only, row, from + j + 3);
                const double a10 = coefficient(s, only, row + 1, from + j),
                             a11 = coefficient(s, only, row + 1, from + j + 1);
                const double a12 = coefficient(s, only, row + 1, from + j + 2),
                             a13 = coefficient(s, only, row + 1, from + j + 3);
                const double *restrict t0 = t[j], *restrict t1 = t[j + 1], *restrict t2 = t[j + 2],
                                       *restrict t3 = t[j + 3];
                const double *restrict e0 = d[j], *restrict e1 = d[j + 1], *restrict e2 = d[j + 2],
                                       *restrict e3 = d[j + 3];
                LANES
                for (size_t i = 0; i < n; i++) {
                    double v0 = t0[i], v1 = t1[i], v2 = t2[i], v3 = t3[i], w0 = e0[i], w1 = e1[i], w2 = e2[i],
                           w3 = e3[i];
                    b0[i] = sgt_fma(a03, v3, sgt_fma(a02, v2, sgt_fma(a01, v1, sgt_fma(a00, v0, b0[i]))));
                    b1[i] = sgt_fma(a13, v3, sgt_fma(a12, v2, sgt_fma(a11, v1, sgt_fma(a10, v0, b1[i]))));
                    d0[i] = sgt_fma(a03, w3, sgt_fma(a02, w2, sgt_fma(a01, w1, sgt_fma(a00, w0, d0[i]))));
                    d1[i] = sgt_fma(a13, w3, sgt_fma(a12, w2, sgt_fma(a11, w1, sgt_fma(a10, w0, d1[i]))));
                }
            }
            const double degree = (double)row, next = degree + 1;
            LANES
            for (size_t i = 0; i < n; i++) {
                double tn = a.t[i], un = a.u[i], tm = tn, um = un;
                turn_one(a.x[i], a.w[i], &tm, &um);
                p[i] = sgt_fma(tm, b1[i], sgt_fma(tn, b0[i], p[i]));
                px[i] = sgt_fma(next * um, b1[i], sgt_fma(degree * un, b0[i], px[i]));
                py[i] = sgt_fma(tm, d1[i], sgt_fma(tn, d0[i], py[i]));
                turn_one(a.x[i], a.w[i], &tm, &um);
                a.t[i] = tm, a.u[i] = um;
            }
        }
    }
    const double back_x = 1 / s->norm_x, back_y = 1 / s->norm_y;
    LANES
    for (size_t i = 0; i < n; i++) px[i] *= back_x, py[i] *= back_y;
}

SGT_KERNEL
static void chebyshev_sums(const sgt_chebyshev *s, size_t only, size_t n, const double *x, const double *y,
                           double *p, double *px, double *py)
{
    sum_products(s, only, n, x, y, p, px, py);
}

/* The same at one point, without the loops. */
SGT_NOINLINE
static void chebyshev_alone(const sgt_chebyshev *s, const double *x, const double *y, double *p, double *px,
                            double *py)
{
    sum_products(s, NONE, 1, x, y, p, px, py);
}

static void strips(const sgt_chebyshev *s, size_t only, size_t n, const double *x, const double *y,
                   sag_values out)
{
    for (size_t i = 0; i < n; i += STRIP)
        chebyshev_sums(s, only, n - i < STRIP ? n - i : STRIP, x + i, y + i, out.p + i, out.px + i,
                       out.py + i);
}

static void chebyshev_at(const void *self, size_t n, const double *x, const double *y, sag_values out)
{
    if (n == 1) chebyshev_alone(self, x, y, out.p, out.px, out.py);
    else strips(self, NONE, n, x, y, out);
}

static size_t chebyshev_parameters(const void *self)
{
    const sgt_chebyshev *s = self;
    return s->a.rows * s->a.columns;
}

/* T_n and dT_n/dx. */
SGT_KERNEL
static void one_polynomial(double norm, size_t degree, size_t n, const double *x, double *restrict t,
                           double *restrict slope)
{
    const double back = (double)degree / norm;
    double u[DEPARTURE_BLOCK], v[DEPARTURE_BLOCK], w[DEPARTURE_BLOCK];
    LANES
    for (size_t i = 0; i < n; i++) {
        double at = x[i] / norm;
        v[i] = at, w[i] = (1 - at) * (1 + at), t[i] = 1, u[i] = 0;
    }
    for (size_t k = 0; k < degree; k++) {
        LANES
        for (size_t i = 0; i < n; i++) {
            double tn = t[i], un = u[i];
            turn_one(v[i], w[i], &tn, &un);
            t[i] = tn, u[i] = un;
        }
    }
    LANES
    for (size_t i = 0; i < n; i++) slope[i] = back * u[i];
}

SGT_KERNEL
static void chebyshev_product(size_t n, const double *a, const double *da, const double *b, const double *db,
                              double *restrict p, double *restrict px, double *restrict py)
{
    LANES
    for (size_t i = 0; i < n; i++) p[i] = a[i] * b[i], px[i] = da[i] * b[i], py[i] = a[i] * db[i];
}

SGT_NARROW(void, sgt_chebyshev_by_parameter,
           (const void *self, size_t j, size_t n, const double *x, const double *y, sag_values out))
{
    const sgt_chebyshev *s = self;
    double a[DEPARTURE_BLOCK], da[DEPARTURE_BLOCK], b[DEPARTURE_BLOCK], db[DEPARTURE_BLOCK];
    one_polynomial(s->norm_x, j / s->a.columns, n, x, a, da);
    one_polynomial(s->norm_y, j % s->a.columns, n, y, b, db);
    chebyshev_product(n, a, da, b, db, out.p, out.px, out.py);
}

/* U_n-1 and its derivative V_n-1 by the same theorem: U_n' = U_n-1 + x U_n-1' + n U_n-1, and T_n'' = n
 * U_n-1'. */
typedef struct chebyshev_bending {
    double x[DEPARTURE_BLOCK], w[DEPARTURE_BLOCK], t[DEPARTURE_BLOCK], u[DEPARTURE_BLOCK], v[DEPARTURE_BLOCK];
} chebyshev_bending;

SGT_INLINE void start_bending(chebyshev_bending *a, double norm, size_t n, const double *x)
{
    LANES
    for (size_t i = 0; i < n; i++) {
        double v = x[i] / norm;
        a->x[i] = v, a->w[i] = (1 - v) * (1 + v), a->t[i] = 1, a->u[i] = a->v[i] = 0;
    }
}

SGT_INLINE void turn_bending(chebyshev_bending *a, double degree, size_t n)
{
    LANES
    for (size_t i = 0; i < n; i++) {
        double x = a->x[i], t = a->t[i], u = a->u[i];
        a->v[i] = sgt_fma(x, a->v[i], sgt_fma(degree, u, u));
        a->t[i] = sgt_fma(x, t, -a->w[i] * u), a->u[i] = sgt_fma(x, u, t);
    }
}

SGT_KERNEL
static void chebyshev_bends(const sgt_chebyshev *s, size_t n, const double *x, const double *y,
                            double *restrict pxx, double *restrict pxy, double *restrict pyy)
{
    chebyshev_bending a, b;
    double b0[DEPARTURE_BLOCK], b1[DEPARTURE_BLOCK], b2[DEPARTURE_BLOCK];
    LANES
    for (size_t i = 0; i < n; i++) pxx[i] = pxy[i] = pyy[i] = 0;
    start_bending(&a, s->norm_x, n, x);
    for (size_t row = 0; row < s->a.rows; row++) {
        const double degree = (double)row;
        start_bending(&b, s->norm_y, n, y);
        LANES
        for (size_t i = 0; i < n; i++) b0[i] = b1[i] = b2[i] = 0;
        for (size_t column = 0; column < s->a.columns; column++) {
            const double c = s->a.x[row * s->a.columns + column], cn = c * (double)column;
            LANES
            for (size_t i = 0; i < n; i++)
                b0[i] = sgt_fma(c, b.t[i], b0[i]), b1[i] = sgt_fma(cn, b.u[i], b1[i]),
                b2[i] = sgt_fma(cn, b.v[i], b2[i]);
            turn_bending(&b, (double)column, n);
        }
        LANES
        for (size_t i = 0; i < n; i++) {
            pxx[i] = sgt_fma(degree * a.v[i], b0[i], pxx[i]),
            pxy[i] = sgt_fma(degree * a.u[i], b1[i], pxy[i]), pyy[i] = sgt_fma(a.t[i], b2[i], pyy[i]);
        }
        turn_bending(&a, degree, n);
    }
    const double back_x = 1 / s->norm_x, back_y = 1 / s->norm_y;
    LANES
    for (size_t i = 0; i < n; i++)
        pxx[i] = pxx[i] * back_x * back_x, pxy[i] = pxy[i] * back_x * back_y,
        pyy[i] = pyy[i] * back_y * back_y;
}

SGT_NARROW(void, sgt_chebyshev_second,
           (const void *self, size_t n, const double *x, const double *y, double *pxx, double *pxy,
            double *pyy))
{
    chebyshev_bends(self, n, x, y, pxx, pxy, pyy);
}

/* Far out, infinity times 0 is NaN: then there is no bound. */
static double chebyshev_known(double x) { return x < HUGE_VAL ? x : HUGE_VAL; }

/* The maxima of |T_n|, |T_n'|, |T_n''| for |argument| <= x. */
typedef struct sizes { double t[MOST], d[MOST], e[MOST]; } sizes;

static void chebyshev_sizes_of(double x, size_t count, sizes *out)
{
    double w = (1 - x) * (1 + x), root = sqrt(w > 0 ? w : 0), t = 1, u = 0, v = 0;
    if (x > 1) {
        for (size_t i = 0; i < count; i++) {
            double n = (double)i, turned = x * t - w * u;
            out->t[i] = t, out->d[i] = n * u, out->e[i] = n * v;
            v = x * v + (n + 1) * u, u = x * u + t, t = turned;
        }
        return;
    }
    const double over = root > 0 ? 1 / root : HUGE_VAL, over2 = w > 0 ? 1 / w : HUGE_VAL;
    for (size_t i = 0; i < count; i++) {
        double n = (double)i, n2 = n * n, most = n2 * (n2 - 1) * (1.0 / 3), d = n > over ? n * over : n2,
               e = i > 0 ? (d + n2) * over2 : 0;
        out->t[i] = 1, out->d[i] = d, out->e[i] = most > e ? e : most;
    }
}

/* The same at a point, with the errors of T_n and T_n' there, in units of u. */
typedef struct errors { sizes of; double t[MOST], d[MOST]; } errors;

static void errors_of(double x, size_t count, errors *out)
{
    double w = x < 1 ? (1 - x) * (1 + x) : 0, sigma = sqrt(w), k = x <= 1 ? 1.4143 + 4 * sigma : 5,
           over = sigma > 0 ? k / sigma : HUGE_VAL;
    chebyshev_sizes_of(x, count, &out->of);
    for (size_t i = 0; i < count; i++) {
        double n = (double)i, slow = 0.5 * (k + 1) * n + 1, u = slow < over ? slow : over; /* times n */
        double d = x <= 1 ? n * n * u : 5 * n * out->of.d[i];
        out->t[i] = n * k * out->of.t[i] + x * out->of.d[i];
        out->d[i] = d + out->of.d[i] + x * out->of.e[i];
    }
}

/* For each column the sums over the rows of |a| times |T_i|, its error, |T_i'|, and its error. */
SGT_KERNEL
static void column_sums(const sgt_chebyshev *s, const errors *of, double *restrict t, double *restrict t_err,
                        double *restrict d, double *restrict d_err)
{
    const size_t columns = s->a.columns;
    LANES
    for (size_t j = 0; j < columns; j++) t[j] = t_err[j] = d[j] = d_err[j] = 0;
    for (size_t i = 0; i < s->a.rows; i++) {
        const double *a = columns ? s->a.x + i * columns : NULL, size = of->of.t[i], size_err = of->t[i],
                     first = of->of.d[i], first_err = of->d[i];
        LANES
        for (size_t j = 0; j < columns; j++) {
            double c = fabs(a[j]);
            t[j] = sgt_fma(c, size, t[j]), t_err[j] = sgt_fma(c, size_err, t_err[j]),
            d[j] = sgt_fma(c, first, d[j]), d_err[j] = sgt_fma(c, first_err, d_err[j]);
        }
    }
}

/* The number of sums that a term goes through, at most. */
static double chebyshev_sums_of(const sgt_chebyshev *s)
{
    return (double)((s->a.columns < PANEL ? s->a.columns : PANEL) +
                    s->a.rows * ((s->a.columns + PANEL - 1) / PANEL));
}

static void chebyshev_rounding(const void *self, double x, double y, double *p_err, double *grad_err)
{
    const sgt_chebyshev *s = self;
    errors a, b;
    double t[MOST], t_err[MOST], d[MOST], d_err[MOST], p = 0, px = 0, py = 0;
    double sums = chebyshev_sums_of(s);
    errors_of(fabs(x) / s->norm_x, s->a.rows, &a);
    errors_of(fabs(y) / s->norm_y, s->a.columns, &b);
    column_sums(s, &a, t, t_err, d, d_err);
    for (size_t j = 0; j < s->a.columns; j++) {
        double tj = b.of.t[j], dj = b.of.d[j];
        p += (t_err[j] + sums * t[j]) * tj + t[j] * b.t[j];
        /* + 3: T_i' itself, 1 / norm and its product. */
        px += (d_err[j] + (sums + 3) * d[j]) * tj + d[j] * b.t[j];
        py += (t_err[j] + (sums + 3) * t[j]) * dj + t[j] * b.d[j];
    }
    px /= s->norm_x, py /= s->norm_y;
    double up = SGT_U * (1 + 0x1p-20);
    *p_err = chebyshev_known(p * up), *grad_err = chebyshev_known((px > py ? px : py) * up);
}

/* sigma <= 1, so k <= 5.4143.  |x T_n'| is greatest at the far end. */
static void chebyshev_noise_in_box(const void *self, double x, double y, double e[2])
{
    const sgt_chebyshev *s = self;
    sizes a, b;
    x = x / s->norm_x * (1 + 0x1p-50), y = y / s->norm_y * (1 + 0x1p-50);
    double sums = chebyshev_sums_of(s), p = 0;
    chebyshev_sizes_of(x, s->a.rows, &a);
    chebyshev_sizes_of(y, s->a.columns, &b);
    for (size_t i = 0; i < s->a.rows; i++) {
        double of_x = 5.4143 * (double)i * a.t[i] + x * a.d[i] + sums * a.t[i], inner = 0, inner_err = 0;
        for (size_t j = 0; j < s->a.columns; j++) {
            double c = fabs(s->a.x[i * s->a.columns + j]);
            inner += c * b.t[j], inner_err += c * (5.4143 * (double)j * b.t[j] + y * b.d[j]);
        }
        p += of_x * inner + a.t[i] * inner_err;
    }
    e[0] = chebyshev_known(p * SGT_U * (1 + 0x1p-20)), e[1] = 0;
}

static void chebyshev_noise(const void *self, double radius, double e[2])
{
    chebyshev_noise_in_box(self, radius, radius, e);
}

/* The maximum, over a disc, of the factors of T_i and T_j derived a and b times, beside their values at
 * the far end (see the head of this file). */
static double in_disc(const double *h, const double *x_low, const double *y_low, size_t i, size_t j, size_t a,
                      size_t b)
{
    return i < a || j < b ? 0 : larger(corner_of(h, i - a, j - b), larger(x_low[i - a], y_low[j - b]));
}

/* Bounds of |P| and its derivatives. */
typedef struct entries { double size, px, py, xx, xy, yy; } entries;

static entries chebyshev_entries(const sgt_chebyshev *s, const region *where)
{
    sizes a, b;
    double across = larger(fabs(where->x.lo), fabs(where->x.hi)),
           along = larger(fabs(where->y.lo), fabs(where->y.hi));
    if (across > where->r_hi) across = where->r_hi;
    if (along > where->r_hi) along = where->r_hi;
    chebyshev_sizes_of(across / s->norm_x * (1 + 0x1p-50), s->a.rows, &a);
    chebyshev_sizes_of(along / s->norm_y * (1 + 0x1p-50), s->a.columns, &b);
    double size = 0, px = 0, py = 0, xx = 0, xy = 0, yy = 0, u = across / s->norm_x, v = along / s->norm_y;
    bool disc = is_disc(across, along, where->r_hi) && u > FAR_BEYOND && v > FAR_BEYOND;
    if (disc) {
        double h[2 * MOST], x_low[MOST], y_low[MOST];
        half_powers(s->a.rows + s->a.columns, h);
        x_low[0] = y_low[0] = 1;
        for (size_t i = 1; i < MOST; i++) x_low[i] = x_low[i - 1] / u, y_low[i] = y_low[i - 1] / v;
        for (size_t i = 0; i < s->a.rows; i++)
            for (size_t j = 0; j < s->a.columns; j++) {
                double c = fabs(s->a.x[i * s->a.columns + j]);
                if (c == 0) continue;
                size += c * a.t[i] * b.t[j] * in_disc(h, x_low, y_low, i, j, 0, 0);
                px += c * a.d[i] * b.t[j] * in_disc(h, x_low, y_low, i, j, 1, 0),
                    py += c * a.t[i] * b.d[j] * in_disc(h, x_low, y_low, i, j, 0, 1);
                xx += c * a.e[i] * b.t[j] * in_disc(h, x_low, y_low, i, j, 2, 0),
                    xy += c * a.d[i] * b.d[j] * in_disc(h, x_low, y_low, i, j, 1, 1),
                    yy += c * a.t[i] * b.e[j] * in_disc(h, x_low, y_low, i, j, 0, 2);
            }
    }
    for (size_t i = 0; i < s->a.rows && !disc; i++) {
        double c0 = 0, c1 = 0, c2 = 0;
        for (size_t j = 0; j < s->a.columns; j++) {
            double c = fabs(s->a.x[i * s->a.columns + j]);
            c0 += c * b.t[j], c1 += c * b.d[j], c2 += c * b.e[j];
        }
        size += a.t[i] * c0, px += a.d[i] * c0, py += a.t[i] * c1;
        xx += a.e[i] * c0, xy += a.d[i] * c1, yy += a.t[i] * c2;
    }
    px /= s->norm_x, py /= s->norm_y, xx = xx / s->norm_x / s->norm_x, xy = xy / s->norm_x / s->norm_y,
                                      yy = yy / s->norm_y / s->norm_y;
    return (entries){size, px, py, xx, xy, yy};
}

static int chebyshev_bounds_by(entries e, double bend, bounds *out)
{
    double up = 1 + 0x1p-30;
    *out = (bounds){chebyshev_known(e.size * up), chebyshev_known(length_of(e.px, e.py) * up),
                    chebyshev_known(bend * up)};
    return 1;
}

static int chebyshev_bounds(const void *self, region *where, bounds *out)
{
    entries e = chebyshev_entries(self, where);
    return chebyshev_bounds_by(e, norm_of(e.xx, e.xy, e.yy), out);
}

static int chebyshev_bounds_along(const void *self, region *where, double l, double m, bounds *out)
{
    entries e = chebyshev_entries(self, where);
    return chebyshev_bounds_by(e, e.xx * (l * l) + 2 * e.xy * fabs(l * m) + e.yy * (m * m), out);
}

static sgt_objection chebyshev_object(const void *self)
{
    const sgt_chebyshev *s = self;
    if (!(s->norm_x > 0 && s->norm_x < HUGE_VAL)) return (sgt_objection){"norm_x", "must be above 0"};
    if (!(s->norm_y > 0 && s->norm_y < HUGE_VAL)) return (sgt_objection){"norm_y", "must be above 0"};
    if (s->a.rows > MOST || s->a.columns > MOST)
        return (sgt_objection){"coefficients", "must be at most 64 rows and 64 columns"};
    if (s->a.rows == 0 || s->a.columns == 0) return (sgt_objection){NULL, NULL};
    if (!s->a.x) return (sgt_objection){"coefficients", "has no numbers"};
    if (!numbers_finite(s->a.rows * s->a.columns, s->a.x))
        return (sgt_objection){"coefficients", "must be finite"};
    return (sgt_objection){NULL, NULL};
}

/* The noise over a disc that is wider than both norms.  Each factor that T_i, T_i' or the error of T_i is
 * bounded by in chebyshev_noise_in_box is at most what `in_disc` takes for it.  So the noise is one sum of
 * the terms' sizes over the disc, not over the square, where T_i T_j may be 2^((i + j) / 2) times that. */
static double chebyshev_along_off(const void *self, double radius)
{
    const sgt_chebyshev *s = self;
    region where = {{-radius, radius}, {-radius, radius}, 0, radius};
    entries e = chebyshev_entries(s, &where);
    double steps = 5.4143 * (double)(s->a.rows + s->a.columns) + chebyshev_sums_of(s), steep = e.px + e.py;
    double off = SGT_U * (steps * e.size + radius * steep) + 0x1p-46 * radius * steep, noise[2];
    if (!(radius > FAR_BEYOND * larger(s->norm_x, s->norm_y))) {
        chebyshev_noise(self, radius, noise);
        off = noise[0] + 0x1p-46 * radius * steep;
    }
    return chebyshev_known(off * (1 + 0x1p-20));
}

enum { ALONG_TERMS = 40, ALONG_POINTS = 8 };

/* The noise at points with |x| and |y| at most these.  All that chebyshev_noise_in_box takes for [-1, 1] is
 * at most its value at 1, from where on it increases.  Of degrees below ALONG_TERMS. */
SGT_NOINLINE
static void noise_at_points(const sgt_chebyshev *s, const double *restrict x, const double *restrict y,
                            double *restrict out)
{
    double t[ALONG_TERMS][ALONG_POINTS], off[ALONG_TERMS][ALONG_POINTS], v[ALONG_POINTS], w[ALONG_POINTS],
        now[ALONG_POINTS], u[ALONG_POINTS], p[ALONG_POINTS];
    const double sums = chebyshev_sums_of(s), k = 5.4143;
    /* a table without rows may name any number of columns */
    const size_t rows = s->a.columns > 0 ? s->a.rows : 0, columns = rows > 0 ? s->a.columns : 0;
    LANES for (size_t i = 0; i < ALONG_POINTS; i++) {
        v[i] = larger(y[i] / s->norm_y, 1) * (1 + 0x1p-50);
        w[i] = (1 - v[i]) * (1 + v[i]), now[i] = 1, u[i] = 0;
        p[i] = 0;
    }
    for (size_t j = 0; j < columns; j++) {
        const double degree = (double)j;
        LANES for (size_t i = 0; i < ALONG_POINTS; i++) {
            double one = now[i], slope = u[i];
            t[j][i] = one, off[j][i] = degree * (k * one + v[i] * slope);
            now[i] = v[i] * one - w[i] * slope, u[i] = v[i] * slope + one;
        }
    }
    LANES for (size_t i = 0; i < ALONG_POINTS; i++) {
        v[i] = larger(x[i] / s->norm_x, 1) * (1 + 0x1p-50);
        w[i] = (1 - v[i]) * (1 + v[i]), now[i] = 1, u[i] = 0;
    }
    for (size_t i = 0; i < rows; i++) {
        const double degree = (double)i, *a = s->a.x + i * columns;
        double size[ALONG_POINTS], more[ALONG_POINTS];
        LANES for (size_t l = 0; l < ALONG_POINTS; l++) size[l] = more[l] = 0;
        for (size_t j = 0; j < columns; j++) {
            const double c = fabs(a[j]);
            LANES for (size_t l = 0; l < ALONG_POINTS; l++)
                size[l] = sgt_fma(c, t[j][l], size[l]), more[l] = sgt_fma(c, off[j][l], more[l]);
        }
        LANES for (size_t l = 0; l < ALONG_POINTS; l++) {
            double one = now[l], slope = u[l], own = degree * (k * one + v[l] * slope) + sums * one;
            p[l] += own * size[l] + one * more[l];
            now[l] = v[l] * one - w[l] * slope, u[l] = v[l] * slope + one;
        }
    }
    LANES for (size_t i = 0; i < ALONG_POINTS; i++) out[i] = p[i] * SGT_U * (1 + 0x1p-20);
}

static void chebyshev_along_noise(const void *self, const double *x, const double *y, double *out)
{
    noise_at_points(self, x, y, out);
}

static bool chebyshev_along(const void *self, sgt_course *out)
{
    const sgt_chebyshev *s = self;
    size_t all = s->a.rows > 0 && s->a.columns > 0 ? s->a.rows + s->a.columns - 2 : 0;
    *out = (sgt_course){all, false, larger(s->norm_x, s->norm_y)};
    return true;
}

static const departure chebyshev_departure = {
    .at = chebyshev_at, .rounding = chebyshev_rounding, .bounds = chebyshev_bounds,
    .second = sgt_chebyshev_second, .parameters = chebyshev_parameters,
    .by_parameter = sgt_chebyshev_by_parameter,
    .object = chebyshev_object, .noise = chebyshev_noise,
    .noise_in_box = chebyshev_noise_in_box, .bounds_along = chebyshev_bounds_along,
    .along = chebyshev_along, .along_off = chebyshev_along_off,
    .along_noise = chebyshev_along_noise};

DEPARTURE_ON_CONIC(chebyshev, sgt_chebyshev)
