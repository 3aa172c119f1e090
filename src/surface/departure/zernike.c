// SPDX-License-Identifier: MIT
/* zernike.c - a sum of Zernike's circle polynomials on a conic.
 *
 * Let zeta = (x + i y) / norm and s = |zeta|^2.  The polynomials of one m and radial orders n = m + 2 k
 * are the real part (cosine) and the imaginary part (sine) of zeta^m, times Q_k(s) = P_k^(0,m)(2 s - 1) of
 * Jacobi: R_n^m(u) = u^m Q_k(u^2) (Born and Wolf, section 9.2.1).  So for each m there are two sums over
 * k, C(s) and S(s), and
 *     P = sum over m of C Re zeta^m + S Im zeta^m.
 * The gradient needs Q_k' and the powers zeta^(m-1): d zeta^m / dx = m zeta^(m-1) / norm, and d/dy is i
 * times that.  There is no angle and no division by r, so it is as smooth at the axis as elsewhere.
 *
 * Q_k = lambda_k q_k, where q_k is monic in s and lambda_k is the binomial coefficient of n over k.  The
 * recurrence is (Szego 1975, 4.5.1)
 *     q_k+1 = (s - beta_k) q_k - gamma_k q_k-1,   q_0 = 1,
 *     beta_k = 1/2 + m^2 / (2 n (n + 2)),   gamma_k = (n^2 - m^2)^2 / (16 n^2 (n^2 - 1)),
 * and q_k' by its derivative.  Upward it is stable on 0 <= s <= 1.  All zeros of the q_k are there, so q_k
 * is nowhere the lesser of the two solutions.  The loop over the points is the inner one, with four orders
 * at a time.  What is carried from one four to the next goes to memory and back.
 *
 * ROUNDING, in units of u = 2^-53.  A step rounds by at most (2 beta_j - 1/2 + |s - beta_j|) |q_j| + 2
 * gamma_j |q_j-1| + |q_j+1|.  This reaches q_k multiplied by the solution of the recurrence that is 0 at j
 * and 1 at j + 1.  So does the rounding of a step of q_j'; the rounding of q_j reaches q_k' by the
 * derivative of that solution.  Three errors are added:
 * - s is off by 4 s.
 * - zeta^m is off by 3 m of itself: x and y over norm 1, and a product of complex numbers with fma 2
 *   (Jeannerod, Kornerup, Louvet, Muller 2017, Math. Comp. 86, 881).
 * - The coefficients are off by 2 k + 3.
 *
 * Times u^m lambda_k, that is a polynomial of degree n in u for each choice of signs.  A bound of it
 * follows from its values at 8 (n + 2) points (Ehlich and Zeller 1964, Math. Z. 86, 41).  It was computed
 * for every n <= 142 and every m, and `rounding` has simple functions of n above it.  Beyond the circle a
 * polynomial of degree n exceeds its maximum on the circle by at most the factor (v + sqrt(v^2 - 1))^n, v
 * = r / norm.
 *
 * BOUNDS.  The derivatives of V = R_n^m(u) e^(i m theta) by zeta and by its conjugate are sums of
 * polynomials of this kind with coefficients >= 0 (Noll 1976, eq. 13).  All of these are 1 at zeta = 1 and
 * nowhere greater, so every derivative is greatest there.  By the differential equation of R, with L = n
 * (n + 2) - m^2,
 *     |grad V| <= R'(1) = L / 2,    |second derivative| <= R''(1) = (L (L - 4) + 4 m^2) / 8.
 * Within u < 1 also |grad| <= n / sqrt(1 - u^2) (Bernstein's inequality for a ball: Sarantopoulos 1991,
 * Math. Proc. Camb. Phil. Soc. 110, 307).  Applied twice, by way of the circle of radius^2 (1 + u^2) / 2,
 * it gives |second derivative| <= 2 n (n - 1) / (1 - u^2).  Beyond the circle, by the same
 * sums, every derivative is greatest at the far end of the real axis: the values are R, R' and R'' there
 * (radial.h). */
#include "bend.h"
#include "radial.h"
#include "samples.h"

/* The orders of one m: k <= 71 (Fringe: (k + m + 1)^2 - 2 m <= 5151), rounded up to a multiple of four. */
enum { MOST_TERMS = 5151, MOST_ORDERS = 72, MOST_DEGREE = 142 };

/* The index in the list of the first polynomial of order n = m + 2 k.  For m = 0 it is the only one; for
 * other m the sine stands beside the cosine. */
static size_t zernike_place(const sgt_zernike *z, size_t m, size_t k)
{
    size_t n = m + 2 * k, half = m + k;
    if (z->order == SGT_NOLL) return n * (n + 1) / 2 + (m > 0 ? m - 1 : 0);
    return (half + 1) * (half + 1) - 2 * m - 1;
}

static bool cosine_first(const sgt_zernike *z, size_t m, size_t first)
{
    return z->order != SGT_NOLL || m == 0 || first % 2 == 1;
}

static size_t length(const sgt_zernike *z) { return z->a.rows * z->a.columns; }

static double unit(const sgt_zernike *z, size_t m, size_t k)
{
    return z->normalised ? sqrt((double)(m + 2 * k + 1) * (m > 0 ? 2 : 1)) : 1;
}

/* The polynomials of one m: the recurrence, and the coefficients of the q_k. */
typedef struct harmonic {
    size_t count;
    double m;
    const double *beta, *gamma;
    double own_beta[MOST_ORDERS], own_gamma[MOST_ORDERS], c[MOST_ORDERS], s[MOST_ORDERS];
} harmonic;

/* Numbers of the recurrence, of m and n.  RATIO: of lambda_k+1 to lambda_k.  They are whole numbers, exact up
 * to the quotients.  The first ones are constants: they took three quarters of an evaluation at one point. */
#define BETA(m, n) (0.5 + (m) * (m) / ((n) > 0 ? 2 * (n) * ((n) + 2) : 1))
#define GAMMA(m, n)                                                                                          \
    (((n) * (n) - (m) * (m)) * ((n) * (n) - (m) * (m)) / ((n) > 1 ? 16 * ((n) * (n)) * ((n) * (n) - 1) : 1))
#define RATIO(m, n, k) (((n) + 1) * ((n) + 2) / (((k) + 1) * ((m) + (k) + 1)))

enum { LOW_ORDERS = 8, LOW_HARMONICS = 8 };
typedef struct low_orders { double beta[LOW_ORDERS], gamma[LOW_ORDERS], lambda[LOW_ORDERS]; } low_orders;

#define EACH_ORDER(NUMBER, m)                                                                                \
    {NUMBER(m, m), NUMBER(m, m + 2), NUMBER(m, m + 4), NUMBER(m, m + 6), NUMBER(m, m + 8),                   \
     NUMBER(m, m + 10), NUMBER(m, m + 12), NUMBER(m, m + 14)}
#define LAMBDA1(m) (1 * RATIO(m, m, 0.0))
#define LAMBDA2(m) (LAMBDA1(m) * RATIO(m, m + 2, 1.0))
#define LAMBDA3(m) (LAMBDA2(m) * RATIO(m, m + 4, 2.0))
#define LAMBDA4(m) (LAMBDA3(m) * RATIO(m, m + 6, 3.0))
#define LAMBDA5(m) (LAMBDA4(m) * RATIO(m, m + 8, 4.0))
#define LAMBDA6(m) (LAMBDA5(m) * RATIO(m, m + 10, 5.0))
#define LAMBDA7(m) (LAMBDA6(m) * RATIO(m, m + 12, 6.0))
#define LOW(m)                                                                                               \
    {EACH_ORDER(BETA, (m)), EACH_ORDER(GAMMA, (m)),                                                          \
     {1, LAMBDA1((m)), LAMBDA2((m)), LAMBDA3((m)), LAMBDA4((m)), LAMBDA5((m)), LAMBDA6((m)), LAMBDA7((m))}}
static const low_orders low[LOW_HARMONICS] = {LOW(0.0), LOW(1.0), LOW(2.0), LOW(3.0),
                                              LOW(4.0), LOW(5.0), LOW(6.0), LOW(7.0)};

/* The recurrence, and c and s made coefficients of the q_k, of more orders than are constants. */
SGT_NOINLINE static void many_orders(const sgt_zernike *z, size_t m, harmonic *h)
{
    const double of_m = h->m;
    const size_t count = h->count;
    double lambda = 1;
    for (size_t i = 0; i < count; i++) {
        const double n = of_m + (double)(2 * i), scale = lambda * unit(z, m, i);
        h->own_beta[i] = BETA(of_m, n), h->own_gamma[i] = GAMMA(of_m, n);
        h->c[i] *= scale, h->s[i] *= scale;
        lambda *= RATIO(of_m, n, (double)i);
    }
    h->beta = h->own_beta, h->gamma = h->own_gamma;
}

/* If `only` is below the number of terms, that coefficient is 1 and all others are 0.  count: up to the
 * last one that is not 0.  Places are as zernike_place has them: their differences grow by a constant. */
SGT_INLINE void gather(const sgt_zernike *z, size_t only, size_t m, harmonic *h)
{
    const size_t terms = length(z), more = z->order == SGT_NOLL ? 4 : 2;
    const double *a = z->a.x;
    size_t k = 0, count = 0, step = 2 * m + 3;
    for (size_t at = zernike_place(z, m, 0); at < terms; at += step, step += more, k++) {
        const bool first = cosine_first(z, m, at);
        const size_t cosine = first ? at : at + 1, sine = m == 0 ? terms : first ? at + 1 : at;
        h->c[k] = only < terms ? cosine == only : cosine < terms ? a[cosine] : 0;
        h->s[k] = only < terms ? sine == only : sine < terms ? a[sine] : 0;
        if (h->c[k] != 0 || h->s[k] != 0) count = k + 1;
    }
    h->m = (double)m, h->count = count;
    if (m >= LOW_HARMONICS || count > LOW_ORDERS) {
        many_orders(z, m, h);
        return;
    }
    const low_orders *of = &low[m];
    h->beta = of->beta, h->gamma = of->gamma;
    for (size_t i = 0; i < count; i++) {
        const double scale = of->lambda[i] * unit(z, m, i);
        h->c[i] *= scale, h->s[i] *= scale;
    }
}

/* For all points:
 *
 *   x, y, s         zeta and s
 *   re, im          zeta^m
 *   re1, im1        zeta^(m-1)
 *   q, q1, d, d1    q_k, q_k-1 and their derivatives
 *   c, sn, dc, ds   C, S, C', S': the sums over k and their derivatives
 *   p, g            the sums over m of C Re zeta^m + S Im zeta^m, and of the same with C' and S'
 *   gx, gy          the sums over m of its derivatives by x and y, with C and S as constants */
typedef struct zernike_work {
    double x[DEPARTURE_BLOCK], y[DEPARTURE_BLOCK], s[DEPARTURE_BLOCK], re[DEPARTURE_BLOCK],
        im[DEPARTURE_BLOCK], re1[DEPARTURE_BLOCK], im1[DEPARTURE_BLOCK];
    double q[DEPARTURE_BLOCK], q1[DEPARTURE_BLOCK], d[DEPARTURE_BLOCK], d1[DEPARTURE_BLOCK];
    double c[DEPARTURE_BLOCK], sn[DEPARTURE_BLOCK], dc[DEPARTURE_BLOCK], ds[DEPARTURE_BLOCK];
    double p[DEPARTURE_BLOCK], g[DEPARTURE_BLOCK], gx[DEPARTURE_BLOCK], gy[DEPARTURE_BLOCK];
} zernike_work;

SGT_INLINE void zernike_begin(zernike_work *w, double norm, size_t n, const double *x, const double *y)
{
    LANES
    for (size_t i = 0; i < n; i++) {
        double px = x[i] / norm, py = y[i] / norm;
        w->x[i] = px, w->y[i] = py, w->s[i] = sgt_fma(px, px, py * py);
        w->re[i] = 1, w->im[i] = 0, w->re1[i] = 0, w->im1[i] = 0;
        w->p[i] = 0, w->g[i] = 0, w->gx[i] = 0, w->gy[i] = 0;
    }
}

/* To the next m. */
SGT_INLINE void zernike_turn(zernike_work *w, size_t n)
{
    LANES
    for (size_t i = 0; i < n; i++) {
        double re = w->re[i], im = w->im[i], x = w->x[i], y = w->y[i];
        w->re1[i] = re, w->im1[i] = im;
        w->re[i] = sgt_fma(re, x, -im * y), w->im[i] = sgt_fma(re, y, im * x);
    }
}

#define STEP(K)                                                                            \
    do {                                                                                   \
        double a = s - beta##K, q2, d2;                                                    \
        c = sgt_fma(c##K, q, c), sn = sgt_fma(s##K, q, sn), dc = sgt_fma(c##K, d, dc),     \
        ds = sgt_fma(s##K, d, ds);                                                         \
        q2 = sgt_fma(a, q, -gamma##K * q1), d2 = sgt_fma(a, d, sgt_fma(-gamma##K, d1, q)); \
        q1 = q, q = q2, d1 = d, d = d2;                                                    \
    } while (0)

/* Adds one to four orders from k on.  slopes: the derivatives, too.  `first`, `steps` and `slopes` are
 * constants after inlining. */
SGT_INLINE void add_orders(const harmonic *h, size_t k, bool first, int steps, bool slopes, zernike_work *w,
                           size_t n)
{
    const size_t k1 = steps > 1 ? k + 1 : k, k2 = steps > 2 ? k + 2 : k, k3 = steps > 3 ? k + 3 : k;
    const double beta0 = h->beta[k], beta1 = h->beta[k1], beta2 = h->beta[k2], beta3 = h->beta[k3];
    const double gamma0 = h->gamma[k], gamma1 = h->gamma[k1], gamma2 = h->gamma[k2], gamma3 = h->gamma[k3];
    const double c0 = h->c[k], c1 = h->c[k1], c2 = h->c[k2], c3 = h->c[k3];
    const double s0 = h->s[k], s1 = h->s[k1], s2 = h->s[k2], s3 = h->s[k3];
    LANES
    for (size_t i = 0; i < n; i++) {
        double s = w->s[i], q = first ? 1 : w->q[i], q1 = first ? 0 : w->q1[i], d = first ? 0 : w->d[i],
               d1 = first ? 0 : w->d1[i];
        double c = first ? 0 : w->c[i], sn = first ? 0 : w->sn[i], dc = first ? 0 : w->dc[i],
               ds = first ? 0 : w->ds[i];
        STEP(0);
        if (steps > 1) STEP(1);
        if (steps > 2) STEP(2);
        if (steps > 3) STEP(3);
        if (steps > 3) w->q[i] = q, w->q1[i] = q1; /* fewer: the end */
        if (steps > 3 && slopes) w->d[i] = d, w->d1[i] = d1;
        w->c[i] = c, w->sn[i] = sn;
        if (slopes) w->dc[i] = dc, w->ds[i] = ds;
    }
}

SGT_INLINE void sum_orders(const harmonic *h, bool slopes, zernike_work *w, size_t n)
{
    switch (h->count) {
    case 1: add_orders(h, 0, true, 1, slopes, w, n); return;
    case 2: add_orders(h, 0, true, 2, slopes, w, n); return;
    case 3: add_orders(h, 0, true, 3, slopes, w, n); return;
    default: add_orders(h, 0, true, 4, slopes, w, n);
    }
    size_t k = 4;
    for (; k + 4 <= h->count; k += 4) add_orders(h, k, false, 4, slopes, w, n);
    switch (h->count - k) {
    case 1: add_orders(h, k, false, 1, slopes, w, n); return;
    case 2: add_orders(h, k, false, 2, slopes, w, n); return;
    case 3: add_orders(h, k, false, 3, slopes, w, n); return;
    default: return;
    }
}

SGT_INLINE void add_harmonic(const harmonic *h, bool slopes, zernike_work *w, size_t n)
{
    const double m = h->m;
    LANES
    for (size_t i = 0; i < n; i++) {
        double re = w->re[i], im = w->im[i], re1 = w->re1[i], im1 = w->im1[i], c = w->c[i], s = w->sn[i],
               mc = m * c, ms = m * s;
        w->p[i] = sgt_fma(c, re, sgt_fma(s, im, w->p[i]));
        if (!slopes) continue;
        w->g[i] = sgt_fma(w->dc[i], re, sgt_fma(w->ds[i], im, w->g[i]));
        w->gx[i] = sgt_fma(mc, re1, sgt_fma(ms, im1, w->gx[i]));
        w->gy[i] = sgt_fma(ms, re1, sgt_fma(-mc, im1, w->gy[i]));
    }
}

SGT_INLINE void sum_harmonics(const sgt_zernike *z, size_t only, bool slopes, size_t n, const double *x,
                              const double *y, double *restrict p, double *restrict px, double *restrict py)
{
    zernike_work w;
    harmonic h;
    const double back = 1 / z->norm;
    zernike_begin(&w, z->norm, n, x, y);
    for (size_t m = 0; zernike_place(z, m, 0) < length(z); m++) {
        if (m > 0) zernike_turn(&w, n);
        gather(z, only, m, &h);
        if (h.count == 0) continue;
        sum_orders(&h, slopes, &w, n);
        add_harmonic(&h, slopes, &w, n);
        if (only < MOST_TERMS) break; /* all others are 0 */
    }
    LANES
    for (size_t i = 0; i < n; i++) p[i] = w.p[i];
    if (!slopes) return;
    LANES
    for (size_t i = 0; i < n; i++) {
        double g2 = w.g[i] + w.g[i];
        px[i] = sgt_fma(g2, w.x[i], w.gx[i]) * back,
        py[i] = sgt_fma(g2, w.y[i], w.gy[i]) * back;
    }
}

SGT_KERNEL
static void zernike_sums(const sgt_zernike *z, size_t only, size_t n, const double *x, const double *y,
                         double *p, double *px, double *py)
{
    sum_harmonics(z, only, true, n, x, y, p, px, py);
}

/* The same at one point, without the loops. */
SGT_NOINLINE
static void zernike_alone(const sgt_zernike *z, const double *x, const double *y, double *p, double *px,
                          double *py)
{
    sum_harmonics(z, MOST_TERMS, true, 1, x, y, p, px, py);
}

/* P alone: what only its gradient reads is not computed. */
SGT_KERNEL
static void zernike_sums_alone(const sgt_zernike *z, size_t n, const double *x, const double *y, double *p)
{
    sum_harmonics(z, MOST_TERMS, false, n, x, y, p, NULL, NULL);
}

static void zernike_p(const void *self, size_t n, const double *x, const double *y, double *p)
{
    zernike_sums_alone(self, n, x, y, p);
}

static void zernike_at(const void *self, size_t n, const double *x, const double *y, sag_values out)
{
    if (n == 1) zernike_alone(self, x, y, out.p, out.px, out.py);
    else zernike_sums(self, MOST_TERMS, n, x, y, out.p, out.px, out.py);
}

static size_t zernike_parameters(const void *self) { return length(self); }

SGT_NARROW(void, sgt_zernike_by_parameter,
           (const void *self, size_t j, size_t n, const double *x, const double *y, sag_values out))
{
    zernike_sums(self, j, n, x, y, out.p, out.px, out.py);
}

/* Of q_k'' and q_k-1'', and of C and S: the second derivatives by s. */
typedef struct zernike_bending {
    double b[DEPARTURE_BLOCK], b1[DEPARTURE_BLOCK], c[DEPARTURE_BLOCK], s[DEPARTURE_BLOCK];
} zernike_bending;

/* As sum_orders, one order at a time, with these. */
SGT_INLINE void sum_bending(const harmonic *h, zernike_work *w, zernike_bending *e, size_t n)
{
    LANES
    for (size_t i = 0; i < n; i++) {
        w->q[i] = 1, w->q1[i] = w->d[i] = w->d1[i] = e->b[i] = e->b1[i] = 0;
        w->c[i] = w->sn[i] = w->dc[i] = w->ds[i] = e->c[i] = e->s[i] = 0;
    }
    for (size_t k = 0; k < h->count; k++) {
        const double beta = h->beta[k], gamma = h->gamma[k], ck = h->c[k], sk = h->s[k];
        LANES
        for (size_t i = 0; i < n; i++) {
            double a = w->s[i] - beta, q = w->q[i], d = w->d[i], b = e->b[i];
            w->c[i] = sgt_fma(ck, q, w->c[i]), w->dc[i] = sgt_fma(ck, d, w->dc[i]),
            e->c[i] = sgt_fma(ck, b, e->c[i]);
            w->sn[i] = sgt_fma(sk, q, w->sn[i]), w->ds[i] = sgt_fma(sk, d, w->ds[i]),
            e->s[i] = sgt_fma(sk, b, e->s[i]);
            w->q[i] = sgt_fma(a, q, -gamma * w->q1[i]), w->d[i] = sgt_fma(a, d, sgt_fma(-gamma, w->d1[i], q)),
            e->b[i] = sgt_fma(a, b, sgt_fma(-gamma, e->b1[i], d + d));
            w->q1[i] = q, w->d1[i] = d, e->b1[i] = b;
        }
    }
}

/* As zernike_sums, one order at a time, with the second derivatives by s.  For T = C Re zeta^m + S Im zeta^m
 *     T_xx = 4 x^2 T'' + 2 T' + 4 x T'_x + m (m - 1) (C Re zeta^(m-2) + S Im zeta^(m-2)),   and so on,
 * where ' and '' apply to C and S, and _x and _y to zeta^m. */
SGT_KERNEL
static void zernike_bends(const sgt_zernike *z, size_t n, const double *x, const double *y,
                          double *restrict pxx, double *restrict pxy, double *restrict pyy)
{
    zernike_work w;
    harmonic h;
    zernike_bending e;
    double re2[DEPARTURE_BLOCK], im2[DEPARTURE_BLOCK];
    const double back = 1 / z->norm, back2 = back * back;
    zernike_begin(&w, z->norm, n, x, y);
    LANES
    for (size_t i = 0; i < n; i++) pxx[i] = pxy[i] = pyy[i] = re2[i] = im2[i] = 0;
    for (size_t m = 0; zernike_place(z, m, 0) < length(z); m++) {
        LANES
        for (size_t i = 0; i < n; i++) re2[i] = w.re1[i], im2[i] = w.im1[i];
        if (m > 0) zernike_turn(&w, n);
        gather(z, MOST_TERMS, m, &h);
        if (h.count == 0) continue;
        sum_bending(&h, &w, &e, n);
        const double m1 = h.m, m2 = h.m * (h.m - 1);
        LANES
        for (size_t i = 0; i < n; i++) {
            double X = w.x[i], Y = w.y[i], re = w.re[i], im = w.im[i], c = w.c[i], s = w.sn[i],
                   dc = m1 * w.dc[i], ds = m1 * w.ds[i];
            double t2 = 4 * sgt_fma(e.c[i], re, e.s[i] * im), t1 = 2 * sgt_fma(w.dc[i], re, w.ds[i] * im);
            double tx = 2 * sgt_fma(dc, w.re1[i], ds * w.im1[i]),
                   ty = 2 * sgt_fma(ds, w.re1[i], -dc * w.im1[i]);
            double u = m2 * sgt_fma(c, re2[i], s * im2[i]), v = m2 * sgt_fma(s, re2[i], -c * im2[i]);
            pxx[i] += sgt_fma(X, sgt_fma(X, t2, tx + tx), t1 + u);
            pxy[i] += sgt_fma(X, sgt_fma(Y, t2, ty), sgt_fma(Y, tx, v));
            pyy[i] += sgt_fma(Y, sgt_fma(Y, t2, ty + ty), t1 - u);
        }
    }
    LANES
    for (size_t i = 0; i < n; i++) pxx[i] *= back2, pxy[i] *= back2, pyy[i] *= back2;
}

/* AT NODES.  Let W = C - i S, so that T = Re(W zeta^m), and let D and D' be the derivatives by zeta and by
 * its conjugate.  The second derivative of T has the mean 2 D D' T of its two eigenvalues, and they are 4
 * |D^2 T| apart, over norm^2, with
 *     D D' T = Re (s W'' + (m + 1) W') zeta^m,
 *     D^2 T = ((s^2 W'' + 2 m s W' + m (m - 1) W) zeta^(m-2) + the conjugate of W'' zeta^(m+2)) / 2.
 * So at a distance u it is at most
 *     2 |s W'' + (m + 1) W'| u^m + |s^2 W'' + 2 m s W' + m (m - 1) W| u^(m-2) + |W''| u^(m+2)
 * in any direction, and that of P the sum over m of these.  Along a line through the axis, in one direction,
 * that of P is a polynomial of u, of a degree of at most n - 2: samples.h.  With n <= 34 all of it is rounded
 * by less than 2^-30 of the sum of the terms' bounds. */
SGT_KERNEL
static void bends_at(const sgt_zernike *z, size_t n, const double *x, const double *y, double *restrict most)
{
    zernike_work w;
    zernike_bending e;
    harmonic h;
    double power[DEPARTURE_BLOCK];
    zernike_begin(&w, z->norm, n, x, y);
    LANES
    for (size_t i = 0; i < n; i++) most[i] = 0, power[i] = 1;
    for (size_t m = 0; zernike_place(z, m, 0) < length(z); m++) {
        gather(z, MOST_TERMS, m, &h);
        if (h.count > 0) sum_bending(&h, &w, &e, n);
        const double count = h.count > 0 ? 1 : 0, m1 = h.m + 1, m2 = 2 * h.m, m3 = h.m * (h.m - 1);
        LANES
        for (size_t i = 0; i < n; i++) {
            double s = w.s[i], u = sqrt(s), p = power[i], c1 = w.dc[i], s1 = w.ds[i], c2 = s * e.c[i],
                   s2 = s * e.s[i];
            double a = c2 + m1 * c1, b = s2 + m1 * s1, d = s * (c2 + m2 * c1) + m3 * w.c[i],
                   f = s * (s2 + m2 * s1) + m3 * w.sn[i];
            double all = p * (2 * sqrt(a * a + b * b) + sqrt(d * d + f * f) / s + sqrt(c2 * c2 + s2 * s2));
            most[i] += count > 0 ? all : 0;
            power[i] = p * u;
        }
    }
}

SGT_NARROW(void, sgt_zernike_second,
           (const void *self, size_t n, const double *x, const double *y, double *pxx, double *pxy,
            double *pyy))
{
    zernike_bends(self, n, x, y, pxx, pxy, pyy);
}

/* A polynomial of degree n exceeds its maximum on the circle at u by at most the nth power of this.
 * Within the circle it is 1. */
static double growth(double u) { return u > 1 ? (u + sqrt(u * u - 1)) * (1 + 0x1p-30) : 1; }

/* Far out, infinity times 0 is NaN: then there is no bound. */
static double zernike_known(double x) { return x < HUGE_VAL ? x : HUGE_VAL; }

/* Sums of |a| over the terms of each degree, with the largest normalisation.  Returns the number of
 * degrees. */
static size_t by_degree(const sgt_zernike *z, double sum[MOST_DEGREE + 1])
{
    size_t terms = length(z), degrees = 0;
    if (z->order == SGT_NOLL) {
        for (size_t i = 0; i < terms; degrees++) {
            size_t last = i + degrees < terms ? i + degrees + 1 : terms;
            for (sum[degrees] = 0; i < last; i++) sum[degrees] += fabs(z->a.x[i]);
        }
    } else {
        size_t most = 0;
        while (most * most < terms) most++; /* n + m < 2 most */
        degrees = most > 0 ? 2 * most - 1 : 0;
        for (size_t n = 0; n < degrees; n++) sum[n] = 0;
        for (size_t half = 0; half < most; half++)
            for (size_t i = half * half, last = i + 2 * half + 1, n = half; i < last && i < terms; i++) {
                sum[n] += fabs(z->a.x[i]);
                if ((i - half * half) % 2 == 1) n++;
            }
    }
    for (size_t n = 0; z->normalised && n < degrees; n++) sum[n] *= sqrt((double)(2 * n + 2));
    return degrees;
}

/* Each sum rounds once for each term that goes through it: over k, then two for each m, then three. */
static double zernike_sums_of(const sgt_zernike *z, size_t degrees)
{
    return z->order == SGT_NOLL ? 2.5 * (double)degrees + 4 : 1.5 * (double)degrees + 6;
}

/* In units of u, a polynomial of degree n is off by at most the lesser of
 *     1.7 n^2 + 3 n + 4 and (2 n + 4) / (v sqrt(1 - v^2)),   v = r / norm.
 * Each of its derivatives is off by at most the lesser of 0.42 n^4 + 1.6 n^3 + 4 n^2 and 2.1 n^2 / (v (1 -
 * v^2)), over norm. */
static void zernike_rounding(const void *self, double x, double y, double *p_err, double *grad_err)
{
    const sgt_zernike *z = self;
    double sum[MOST_DEGREE + 1], v = sqrt(x * x + y * y) / z->norm, inside = v < 1 ? (1 - v) * (1 + v) : 0,
                                 root = sqrt(inside), w = growth(v);
    size_t degrees = by_degree(z, sum);
    double sums = zernike_sums_of(z, degrees), by_root = root > 0 ? 1 / root : HUGE_VAL,
           by_p = v * root > 0 ? 1 / (v * root) : HUGE_VAL,
           by_grad = by_p < HUGE_VAL ? by_p / root : HUGE_VAL;
    double p = 0, grad = 0, grown = 1;
    for (size_t i = 0; i < degrees; i++, grown *= w) {
        double n = (double)i, n2 = n * n, a = sum[i] * grown;
        double p_most = 1.7 * n2 + 3 * n + 4, p_here = (2 * n + 4) * by_p,
               grad_most = n2 * (0.42 * n2 + 1.6 * n + 4), grad_here = 2.1 * n2 * by_grad;
        p += a * ((p_most < p_here ? p_most : p_here) + sums);
        if (i > 0)
            grad += a * ((grad_most < grad_here ? grad_most : grad_here) +
                         sums * (n > by_root ? n * by_root : n2));
    }
    double up = SGT_U * (1 + 0x1p-20);
    *p_err = zernike_known(p * up), *grad_err = zernike_known(grad / z->norm * up);
}

static void zernike_noise(const void *self, double radius, double e[2])
{
    const sgt_zernike *z = self;
    double sum[MOST_DEGREE + 1], w = growth(radius / z->norm * (1 + 0x1p-50)), p = 0, grown = 1;
    size_t degrees = by_degree(z, sum);
    for (size_t i = 0; i < degrees; i++, grown *= w)
        p += sum[i] * grown * (1.7 * (double)(i * i) + 3 * (double)i + 4 + zernike_sums_of(z, degrees));
    e[0] = zernike_known(p * SGT_U * (1 + 0x1p-20)), e[1] = 0;
}

/* Apart, so that what is asked far more often is not longer. */
SGT_NOINLINE static bounds zernike_beyond(size_t k, size_t m, double u) { return radial_beyond(k, m, u); }

static int zernike_bounds(const void *self, region *where, bounds *out)
{
    const sgt_zernike *z = self;
    size_t terms = length(z);
    double across = larger(fabs(where->x.lo), fabs(where->x.hi)),
           along = larger(fabs(where->y.lo), fabs(where->y.hi));
    double corner = length_of(across, along) * (1 + 0x1p-50), r = corner < where->r_hi ? corner : where->r_hi;
    double u = r / z->norm * (1 + 0x1p-50), inside = u < 1 ? (1 - u) * (1 + u) : 0, root = sqrt(inside),
           size = 0, steep = 0, bend = 0;
    const bool far = u > FAR_BEYOND; /* nearer, all is at most w^n times as great as at 1 */
    const double by_root = root > 0 ? 1 / root : HUGE_VAL, by_inside = inside > 0 ? 1 / inside : HUGE_VAL;
    const double w = far ? 1 : growth(u);
    double grown = 1;
    for (size_t m = 0; zernike_place(z, m, 0) < terms; m++, grown *= w) {
        double power = grown; /* w^n */
        for (size_t k = 0, at; (at = zernike_place(z, m, k)) < terms; k++, power *= w * w) {
            double a = fabs(z->a.x[at]), b = m > 0 && at + 1 < terms ? fabs(z->a.x[at + 1]) : 0;
            /* >= sqrt(a^2 + b^2) */
            double both = ((a > b ? a : b) + 0.4142136 * (a > b ? b : a)) * unit(z, m, k) * power;
            if (far && both == 0) continue;
            double n = (double)(m + 2 * k), m2 = (double)(m * m), l = n * (n + 2) - m2, n2 = 2 * n * (n - 1);
            double first = 0.5 * l, second = 0.125 * (l * (l - 4) + 4 * m2);
            bounds e = far ? zernike_beyond(k, m, u)
                           : (bounds){1, first * root > n ? n * by_root : first,
                                      second * inside > n2 ? n2 * by_inside : second};
            size += both * e.size, steep += both * e.steep, bend += both * e.bend;
        }
    }
    double up = 1 + 0x1p-30;
    *out = (bounds){zernike_known(size * up), zernike_known(steep / z->norm * up),
                    zernike_known(bend / z->norm / z->norm * up)};
    return 1;
}

static bool zernike_bent(const void *self, double radius, double most, sgt_interval *out)
{
    const sgt_zernike *z = self;
    double sum[MOST_DEGREE + 1], x[DEPARTURE_BLOCK] = {0}, y[DEPARTURE_BLOCK] = {0}, at[DEPARTURE_BLOCK];
    double greatest = 0;
    const size_t degrees = by_degree(z, sum), nodes = degrees > 3 ? SAMPLES_A_DEGREE * (degrees - 3) : 0;
    if (nodes == 0 || nodes > 2 * DEPARTURE_BLOCK) return false;
    for (size_t j = 0; j < nodes / 2; j++) x[j] = radius * sample_node(j, nodes);
    bends_at(z, nodes / 2, x, y, at);
    bool finite = true;
    for (size_t j = 0; j < nodes / 2; j++) greatest = larger(greatest, at[j]), finite &= at[j] < HUGE_VAL;
    greatest = greatest / z->norm / z->norm;
    *out = sampled_range(-greatest, greatest, 0x1p-30 * most);
    return finite;
}

static sgt_objection zernike_object(const void *self)
{
    const sgt_zernike *z = self;
    if (!(z->norm > 0 && z->norm < HUGE_VAL)) return (sgt_objection){"norm", "must be above 0"};
    if (z->order != SGT_NOLL && z->order != SGT_FRINGE)
        return (sgt_objection){"order", "must be noll or fringe"};
    if (z->normalised != 0 && z->normalised != 1) return (sgt_objection){"normalised", "must be 0 or 1"};
    return object_to_list("coefficients", z->a, MOST_TERMS, "must be at most 5151 numbers");
}

static bool zernike_along(const void *self, sgt_course *out)
{
    const sgt_zernike *z = self;
    double sum[MOST_DEGREE + 1];
    size_t degrees = by_degree(z, sum);
    *out = (sgt_course){degrees > 0 ? degrees - 1 : 0, false, z->norm};
    return true;
}

static const departure zernike_departure = {
    .at = zernike_at, .rounding = zernike_rounding, .bounds = zernike_bounds, .second = sgt_zernike_second,
    .parameters = zernike_parameters, .by_parameter = sgt_zernike_by_parameter, .object = zernike_object,
    .noise = zernike_noise, .bent = zernike_bent, .along = zernike_along,
    .alone = zernike_p};

DEPARTURE_ON_CONIC(zernike, sgt_zernike)
