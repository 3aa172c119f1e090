// SPDX-License-Identifier: MIT
/* q_bfs.c - Forbes' mild aspheres, on a sphere: P = v (1 - v) S(v) / sqrt(1 - c^2 r^2), v = (r / norm)^2,
 * S = sum of a[m] Qbfs_m(v).
 *
 * THE POLYNOMIALS.  The Qbfs make the mean square of the slope the sum of the squares of a[m].  They have
 * no three-term recurrence of their own, but are made of polynomials that have one (Forbes 2010, Opt.
 * Express 18, 19700, section 3): P_0 = 2, P_1 = 6 - 8 v, P_(m+1) = (2 - 4 v) P_m - P_(m-1), and
 *     P_m = f_m Q_m + g_(m-1) Q_(m-1) + h_(m-2) Q_(m-2),
 *     h_m = -(m + 1)(m + 2) / (2 f_m),    g_m = -(1 + g_(m-1) h_(m-1)) / f_(m+1),
 *     f_m^2 = m (m + 1) + 3 - g_(m-1)^2 - h_(m-2)^2,
 * from f_0 = 2, f_1 = sqrt(19) / 2, g_0 = -1/2.  So S = sum of b[m] P_m with b[m] = (a[m] - g_m b[m+1] -
 * h_m b[m+2]) / f_m, from the last on.  1 / f_m and g_m are tables, to the last bit.  q.h sums P_m / 2,
 * whose p_1 is 3 - 4 v.
 *
 * BOUNDS.  Let u = r / norm = sin t and M = 2 m + 1.  Then P_m / 2 = sin(M t) / sin t.  For each term T =
 * v (1 - v) P_m / 2, with derivatives by u,
 *     T = u (1 - u^2) sin M t,    T' = (1 - 3 u^2) sin M t + M u cos t cos M t,
 *     T'' = -(M^2 + 6) u sin M t + M (2 - 5 u^2) cos M t / cos t,
 * where |sin M t| <= min(1, M t) and |cos M t / cos t| <= min(M, 1 / cos t).  A sum A sin + B cos is at
 * most the root of A^2 + B^2.  Beyond u = 1, sin M t is +-T_M(u) of Chebyshev.  T_M and its
 * derivatives increase there, so their values at the far end are taken (chebyshev.c has the same steps).
 *
 * THE FACTOR.  With w = 1 - c^2 r^2, 1 / sqrt(w) has the derivatives c^2 r w^-3/2 and c^2 w^-3/2 + 3 c^4
 * r^2 w^-5/2 by r, and r^2 c w^-3/2 by c.  All grow with r.  w is off by 4 u c^2 r^2 + u w.  P is
 * undefined where w <= 0. */
#include "q.h"
#include "radial.h"

static const double inverse_f[Q_TERMS] = {
    0.5, 0.45883146774112354, 0.3446012188022555, 0.28033098596050243,
    0.2336456817283482, 0.201140963881341, 0.1760051378001599, 0.15672249033989533,
    0.14105217888403448, 0.12834107981661874, 0.11764670151969596, 0.10865091940142944,
    0.1008904486072137, 0.09419358614009363, 0.08830663835607402, 0.08312925278314795,
    0.07851104198943115, 0.07438958659241567, 0.07067015376518695, 0.06731194089522395,
    0.06425233543154905, 0.061463564642503715, 0.05890260069568376, 0.056549895766745406,
    0.054374911588187316, 0.05236349616408997, 0.05049337934410108, 0.048754066414236095,
    0.0471289364959538, 0.04561004410307892, 0.04418473425903072, 0.042846881958661424,
    0.04158668250019942, 0.04039933879571035, 0.03927713714056564, 0.03821626735240959,
    0.03721057777323908, 0.03625700397128306, 0.03535058015346421, 0.03448881384306349,
    0.03366765260686461, 0.03288504852991061, 0.03213766185011277, 0.03142379439525525,
    0.03074066905706457, 0.030086865847361637, 0.029460056646703793, 0.028859044960904245,
    0.02828186447135252, 0.02772749989513425, 0.027194279078748083, 0.026681334912506145,
    0.02618723639461718, 0.025711238521121473, 0.025252109491834353, 0.024809205654797845,
    0.024381460922135043, 0.02396831633223769, 0.02356884455532753, 0.023182557839548805,
    0.022808645753437985, 0.022446680768897206, 0.02209595149857697, 0.021756081624467613,
};
static const double g[Q_TERMS] = {
    -0.5, -0.5735393346764044, -0.61665481259351, -0.6377529930601431,
    -0.6513619300049629, -0.6603092839386494, -0.6669046163343583, -0.671806923160116,
    -0.6756880560871842, -0.6787738021621034, -0.6813274542329577, -0.6834459248545621,
    -0.6852527890058269, -0.6867962357387358, -0.6881417576448091, -0.6893159306629362,
    -0.6903566430966384, -0.6912797220658243, -0.6921085875884454, -0.6928532411294558,
    -0.6935289301488446, -0.6941422797653467, -0.694703639829564, -0.6952175705475755,
    -0.6956913425829038, -0.6961281963460186, -0.6965333882070073, -0.6969092833845622,
    -0.6972597758223124, -0.6975866319742294, -0.6978927976264612, -0.6981796184595651,
    -0.6984493639649606, -0.6987030771718313, -0.6989425347207163, -0.6991685574693051,
    -0.6993825560411249, -0.6995851852382965, -0.6997775792668038, -0.6999602668108649,
    -0.7001341701768363, -0.7002997208789938, -0.7004576765836422, -0.7006083929646025,
    -0.7007524982037037, -0.7008902880849174, -0.7010222878247344, -0.7011487454068746,
    -0.7012701033424026, -0.7013865710909288, -0.7014985241166646, -0.7016061405527946,
    -0.7017097410483548, -0.701809478052869, -0.7019056270489684, -0.7019983192684813,
    -0.7020877927080524, -0.7021741609475821, -0.7022576306627666, -0.702338300651886,
    -0.7024163512569984, -0.7024918688228254, -0.7025650114217071, -0.7026358548464484,
};

static q_step bfs_step(size_t m) { return (q_step){m == 0 ? 3 : 2, -4, 1}; }

/* b for P_m / 2, and its errors.  Returns the number of terms. */
static size_t basis(sgt_numbers a, double *b, double *b_err)
{
    size_t terms = q_terms(a);
    double b1 = 0, b2 = 0, err1 = 0, err2 = 0;
    for (size_t m = terms; m-- > 0;) {
        double k = (double)m, by_f = inverse_f[m], h = 0.5 * (k + 1) * (k + 2) * by_f,
               inner = sgt_fma(h, b2, a.x[m]), sum = sgt_fma(-g[m], b1, inner), now = by_f * sum;
        double err = SGT_U * (2 * fabs(h * b2) + fabs(g[m] * b1) + fabs(inner) + fabs(sum)) + h * err2 +
                     fabs(g[m]) * err1;
        err = 1.001 * (by_f * err + 2 * SGT_U * fabs(now));
        b2 = b1, err2 = err1, b1 = now, err1 = err;
        b[m] = 2 * now;
        if (b_err) b_err[m] = 2 * err;
    }
    return terms;
}

size_t sgt_q_bfs_basis(const sgt_q_bfs *s, double b[Q_TERMS], double b_err[Q_TERMS])
{
    return basis(s->a, b, b_err);
}

/* ------------------------------------------------------------------------------------- bounds of one term */

/* T_n and its two derivatives by u at u >= 1: t, n s and n ds.  No term of a step is negative. */
typedef struct far_sine { double n, t, s, ds; } far_sine;

SGT_INLINE far_sine far_sine_next(far_sine e, double u)
{
    double n = e.n + 1;
    return (far_sine){n, u * e.t + (u - 1) * (u + 1) * e.s, u * e.s + e.t, u * e.ds + n * e.s};
}

static far_sine far_sine_of(size_t M, double u)
{
    far_sine e = {0, 1, 0, 0};
    for (size_t i = 0; i < M; i++) e = far_sine_next(e, u);
    return e;
}

/* Bounds on T, T' and T'' over [0, u].  e: of M, where u > 1. */
static bounds bfs_term_bounds(size_t m, double u, far_sine e)
{
    double M = 2 * (double)m + 1, v = u * u, beyond = v - 1;
    if (u > 1) {
        double first = M * e.s;
        return (bounds){larger(0.385, u * beyond * e.t),
                        larger(2 + 0.5 * M, (3 * v - 1) * e.t + u * beyond * first),
                        /* not below the bound within u <= 1 */
                        6 * u * e.t + 2 * (3 * v - 1) * first + u * beyond * (M * e.ds)};
    }
    double cosine = sqrt(larger(1 - v, 0)), vm = v < 0.5 ? v : 0.5, us = u < 0.577 ? u * (1 - v) : 0.3850,
           sine = 1.5708 * M * u, B = M * sqrt(vm * (1 - vm));
    double A = larger(1, 3 * v - 1), root = sqrt(A * A + B * B), plain = A * sine + B,
           steep_sine = sine < 1 ? sine : 1;
    double quotient = M * cosine < 1 ? M : 1 / cosine;
    return (bounds){us * steep_sine + (u > 0 ? Q_LOST : 0), plain < root ? plain : root,
                    (M * M + 6) * u * steep_sine + M * larger(2, 5 * v - 2) * quotient};
}

/* Beyond u = 1, |T| is u (u^2 - 1) T_M, and -T has the sign of (-1)^m.  T_(M+2) / T_M increases, and so does
 * the factor, which is at least 1. */
static double bfs_tail(const void *self, double radius)
{
    const sgt_q_bfs *s = self;
    double b[Q_TERMS], b_err[Q_TERMS], size[Q_TERMS], u = radius / s->norm * (1 - 0x1p-50);
    if (!(u > 1)) return 0;
    size_t terms = basis(s->a, b, b_err);
    far_sine sine = far_sine_of(1, u);
    for (size_t m = 0; m < terms; m++, sine = far_sine_next(far_sine_next(sine, u), u))
        size[m] = u * ((u - 1) * (u + 1)) * sine.t;
    return -radial_tail(size, 0, terms, b, b_err, true);
}

/* p_m = sin M t / sin t = M - M (M^2 - 1) v / 3! + M (M^2 - 1) (M^2 - 9) v^2 / 5! - ... */
static bool bfs_profile(const void *self, sgt_profile *out)
{
    const sgt_q_bfs *s = self;
    double b[Q_TERMS], b_err[Q_TERMS];
    const size_t terms = q_terms(s->a);
    if (terms == 0 || terms + 2 > PROFILE_TERMS) return false;
    basis(s->a, b, b_err);
    *out = (sgt_profile){
        .terms = terms + 2, .norm2 = s->norm * s->norm, .bent = s->c * s->c, .from = s->norm};
    for (size_t m = 0; m < terms; m++) {
        double M = 2 * (double)m + 1, term = M, most = fabs(b[m]) + 0x1p46 * b_err[m];
        for (size_t j = 0; j <= m; j++) {
            double odd = 2 * (double)j + 1, by = b[m] * term, size = most * fabs(term);
            out->c[j + 1] += by, out->size[j + 1] += size, out->c[j + 2] -= by, out->size[j + 2] += size;
            term *= (odd - M) * (odd + M) / ((odd + 1) * (odd + 2));
        }
    }
    return true;
}

/* With the factor u: u p_m = sin M t, and u v p_m' = (M u cos M t / cos t - sin M t) / 2. */
static void bfs_weigh(size_t terms, double v, q_weight *weights)
{
    double u = sqrt(v), cosine = sqrt(larger(1 - v, 0));
    far_sine e = far_sine_of(1, u); /* read beyond 1 */
    for (size_t m = 0; m < terms; m++) {
        double M = 2 * (double)m + 1, sine = 1.5708 * M * u;
        if (u > 1) {
            weights[m] = (q_weight){e.t * (1 + 0x1p-40), 0.5 * (u * (M * e.s) + e.t) * (1 + 0x1p-40)};
            e = far_sine_next(far_sine_next(e, u), u);
            continue;
        }
        if (!(sine < 1)) sine = 1;
        weights[m] = (q_weight){sine, 0.5 * (M * u * (M * cosine < 1 ? M : 1 / cosine) + sine)};
    }
}

static bounds bfs_all_bounds(const sgt_q_bfs *s, double r)
{
    double b[Q_TERMS], b_err[Q_TERMS], u = r / s->norm * (1 + 0x1p-50), by_norm = 1 / s->norm;
    bounds T = {0, 0, 0};
    far_sine sine = far_sine_of(u > 1 ? 1 : 0, u);
    for (size_t m = 0, terms = basis(s->a, b, b_err); m < terms; m++) {
        bounds e = bfs_term_bounds(m, u, sine);
        if (u > 1) sine = far_sine_next(far_sine_next(sine, u), u);
        double most = fabs(b[m]) + b_err[m];
        T.size += most * e.size, T.steep += most * e.steep, T.bend += most * e.bend;
    }
    if (!(T.size + T.steep + T.bend > 0)) return (bounds){q_bound(T.size), q_bound(T.steep), q_bound(T.bend)};
    double cr = s->c * r * (1 + 0x1p-50), w = 1 - cr * cr, c2 = s->c * s->c;
    if (!(w > 0x1p-30)) return (bounds){HUGE_VAL, HUGE_VAL, HUGE_VAL};
    T.steep *= by_norm, T.bend *= by_norm * by_norm;
    double f = 1 / sqrt(w * (1 - 0x1p-20)), f3 = f * f * f, df = c2 * r * f3,
           ddf = c2 * f3 + 3 * c2 * r * (c2 * r) * (f3 * f * f);
    return (bounds){q_bound(T.size * f), q_bound(T.steep * f + T.size * df),
                    q_bound(T.bend * f + 2 * T.steep * df + T.size * ddf)};
}

static int bfs_bounds_over(const void *self, region *where, bounds *out)
{
    const sgt_q_bfs *s = self;
    double lo = s->c * where->r_lo, hi = s->c * where->r_hi;
    *out = bfs_all_bounds(s, where->r_hi);
    if (fabs(lo) > 1 + 0x1p-40) return 0;
    if (!(fabs(hi) > 1 - 0x1p-40)) return 1;
    double rim = 1 / fabs(s->c) * (1 + 0x1p-40);
    *out = (bounds){HUGE_VAL, HUGE_VAL, HUGE_VAL};
    where->x = sgt_interval_intersection(where->x, sgt_interval_between(-rim, rim));
    where->y = sgt_interval_intersection(where->y, sgt_interval_between(-rim, rim));
    if (where->r_hi > rim) where->r_hi = rim;
    return -1;
}

/* ---------------------------------------------------------------------------------- P and gradient */

/* 1 / sqrt(1 - c^2 r^2). */
SGT_INLINE double factor_at(double c, double r2)
{
    double w = 1 - c * (c * r2);
    return 1 / sqrt(chosen(MASK(w > 0), w, (double)NAN));
}

/* With U = v (1 - v): P = U S f, grad P = (x, y) (2 / norm^2 ((1 - 2 v) S + U S') f + U S c^2 f^3). */
SGT_INLINE void q_bfs_in(size_t n, size_t terms, const double *b, double c, double norm2,
                         const double *restrict x, const double *restrict y, sag_values out)
{
    double *restrict p = out.p, *restrict px = out.px, *restrict py = out.py;
    double v[DEPARTURE_BLOCK], s[DEPARTURE_BLOCK], ds[DEPARTURE_BLOCK], scale = 2 / norm2, c2 = c * c;
    LANES for (size_t i = 0; i < n; i++) v[i] = (x[i] * x[i] + y[i] * y[i]) / norm2;
    q_sum(bfs_step, terms, b, n, v, s, ds);
    LANES for (size_t i = 0; i < n; i++) {
        double f = factor_at(c, x[i] * x[i] + y[i] * y[i]), U = v[i] * (1 - v[i]), is = U * s[i] * f;
        double G = sgt_fma(scale * f, sgt_fma(U, ds[i], (1 - 2 * v[i]) * s[i]), is * (c2 * (f * f)));
        p[i] = is;
        px[i] = x[i] * G, py[i] = y[i] * G;
    }
}

/* For a single point the compiler removes the inner loops. */
SGT_KERNEL
static void q_bfs_at(size_t n, size_t terms, const double *b, double c, double norm2, const double *x,
                     const double *y, sag_values out)
{
    if (n == 1) q_bfs_in(1, terms, b, c, norm2, x, y, out);
    else q_bfs_in(n, terms, b, c, norm2, x, y, out);
}

static void bfs_at(const void *self, size_t n, const double *x, const double *y, sag_values out)
{
    const sgt_q_bfs *s = self;
    double b[Q_TERMS];
    size_t terms = basis(s->a, b, NULL);
    q_bfs_at(n, terms, b, s->c, s->norm * s->norm, x, y, out);
}

/* v is off by 4 u v, which is 2 u r in r.  That moves v (1 - v) S by its derivative times as much, and the
 * slope by the second derivative times as much.  w is off as the head says; e is the resulting relative
 * error of f. */
static void bfs_rounding(const void *self, double x, double y, double *p_err, double *grad_err)
{
    const sgt_q_bfs *s = self;
    double b[Q_TERMS], b_err[Q_TERMS], r2 = x * x + y * y, r = sqrt(r2), v = r2 / (s->norm * s->norm),
                                       u = r / s->norm, c = s->c;
    size_t terms = basis(s->a, b, b_err);
    q_weight weights[Q_TERMS];
    bfs_weigh(terms, v, weights);
    q_rounded S = q_rounding(bfs_step, weights, terms, b, b_err, 0, v);
    sgt_q_bfs flat = *s;
    flat.c = 0;
    bounds T = bfs_all_bounds(&flat, r * (1 + 0x1p-40));
    double w = 1 - c * (c * r2), f = factor_at(c, r2), U = v * (1 - v), rest = fabs(1 - v),
           c2f2 = c * c * f * f;
    double e = SGT_U * (2.5 * (c * c * r2) / w + 2.5); /* of f: half of w's, the root, the quotient */
    /* Of U S. */
    double first = (1 - 2 * v) * S.s, second = U * S.ds, by_v = 2 * u / s->norm,
           slope = by_v * (fabs(first) + fabs(second));
    double slope_err = 2 / s->norm * (fabs(1 - 2 * v) * S.s_err + rest * S.ds_err) + 4 * SGT_U * r * T.bend +
                       9 * SGT_U * slope;
    double size = fabs(U * S.s), size_err = u * rest * S.s_err +
                                            2 * SGT_U * r * (by_v * fabs(first + second) + slope_err) +
                                            3 * SGT_U * size;
    *p_err = 1.01 * f * (size_err + (e + SGT_U) * size);
    *grad_err = 1.01 * f *
                (slope_err + (e + SGT_U) * slope + r * c2f2 * (size_err + (3 * e + 8 * SGT_U) * size));
    /* Squares underflow. */
    if (terms > 0) *p_err += 0x1p-1000, *grad_err += v < 0x1p-900 ? 2 * r * T.bend + 0x1p-500 : 0x1p-1000;
}

/* The range next to the edge: v (1 - v) S at the middle of the ring, plus or minus what its slope allows,
 * over sqrt(w), which falls to 0. */
static sgt_interval bfs_range(const void *self, const region *where)
{
    sgt_q_bfs flat = *(const sgt_q_bfs *)self;
    double c = flat.c, lo = where->r_lo, hi = where->r_hi,
           rim = c != 0 ? 1 / fabs(c) * (1 + 0x1p-40) : HUGE_VAL;
    if (hi > rim) hi = rim;
    if (lo > hi) return sgt_interval_empty();
    flat.c = 0;
    double m = 0.5 * lo + 0.5 * hi, zero = 0, p, px, py, p_err, unused;
    bfs_at(&flat, 1, &m, &zero, (sag_values){&p, &px, &py});
    bfs_rounding(&flat, m, 0, &p_err, &unused);
    double off = p_err + bfs_all_bounds(&flat, hi).steep * (0.5 * (hi - lo)) * (1 + 0x1p-40), most = p + off,
           least = p - off;
    if (!(off < HUGE_VAL) || (least <= 0 && most >= 0)) return sgt_interval_all();
    double w = larger(1 - c * lo * (c * lo), 0) + 0x1p-50, by = (1 - 0x1p-40) / sqrt(w);
    return least > 0 ? sgt_interval_between(least * by, HUGE_VAL)
                     : sgt_interval_between(-HUGE_VAL, most * by);
}

/* As in q_con.c.  What the errors of v (1 - v) S sum to for b[m] = 1, over v, is below 1.31 (m + 1)^3 + 12
 * (m + 1).  (Computed: 9, 33, 69, 125 for the first, 3.43e5 for the last.)  (1 - v) P_m / 2 is at most 2 m
 * + 1. */
static void bfs_noise(const void *self, double radius, double e[2])
{
    const sgt_q_bfs *s = self;
    double b[Q_TERMS], b_err[Q_TERMS], grown = q_growth(radius / s->norm), sum = 0, size = 0,
                                       cr2 = s->c * radius * (s->c * radius), w = 1 - cr2 * (1 + 0x1p-40);
    for (size_t m = 0, terms = basis(s->a, b, b_err); m < terms; m++) {
        double k = (double)m + 1, power = q_most(q_power(grown, 2 * m + 4));
        sum += ((1.31 * k * k + 12) * k * SGT_U * fabs(b[m]) + (2 * k - 1) * b_err[m]) * power;
        size += (2 * k - 1) * fabs(b[m]) * power;
    }
    e[0] = 0, e[1] = !(size > 0) ? 0
                     : w > 0x1p-30
                         ? 1.01 * (sum + SGT_U * size * (2.5 * cr2 / w + 3.5)) / sqrt(w) / (s->norm * s->norm)
                         : HUGE_VAL;
}

/* ------------------------------------------------------------------------------------ sensitivities */

/* By r^2, with primes by v and V = U S: P' = (V' / norm^2) f + V c^2 f^3 / 2, P'' = (V'' / norm^4) f + (V'
 * / norm^2) c^2 f^3 + V c^4 f^5 3 / 4. */
SGT_KERNEL
SGT_NARROW(void, sgt_q_bfs_second,
           (const void *self, size_t n, const double *restrict x, const double *restrict y,
            double *restrict pxx, double *restrict pxy, double *restrict pyy))
{
    const sgt_q_bfs *bfs = self;
    const double c = bfs->c, norm2 = bfs->norm * bfs->norm;
    double b[Q_TERMS];
    size_t terms = basis(bfs->a, b, NULL);
    double v[DEPARTURE_BLOCK], s[DEPARTURE_BLOCK], ds[DEPARTURE_BLOCK], dds[DEPARTURE_BLOCK],
        scale = 1 / norm2, c2 = c * c;
    LANES for (size_t i = 0; i < n; i++) v[i] = (x[i] * x[i] + y[i] * y[i]) / norm2;
    q_second(bfs_step, terms, b, n, v, s, ds, dds);
    LANES for (size_t i = 0; i < n; i++) {
        double f = factor_at(c, x[i] * x[i] + y[i] * y[i]), cf = c2 * (f * f), U = v[i] * (1 - v[i]),
               dU = 1 - 2 * v[i];
        double V = U * s[i], dV = scale * sgt_fma(U, ds[i], dU * s[i]),
               ddV = scale * scale * sgt_fma(U, dds[i], 2 * (dU * ds[i] - s[i]));
        double G = 2 * f * sgt_fma(0.5 * cf, V, dV), bent = 4 * f * (ddV + cf * sgt_fma(0.75 * cf, V, dV));
        pxx[i] = sgt_fma(x[i] * x[i], bent, G);
        pxy[i] = x[i] * y[i] * bent;
        pyy[i] = sgt_fma(y[i] * y[i], bent, G);
    }
}

static size_t bfs_parameters(const void *self)
{
    sgt_numbers a = ((const sgt_q_bfs *)self)->a;
    return a.rows * a.columns;
}

SGT_NARROW(void, sgt_q_bfs_by_parameter,
           (const void *self, size_t j, size_t n, const double *x, const double *y, sag_values out))
{
    const sgt_q_bfs *s = self;
    double unit[Q_TERMS] = {0};
    unit[j] = 1;
    sgt_q_bfs one = {s->c, s->semi_diameter, s->norm, {unit, 1, j + 1}};
    bfs_at(&one, n, x, y, out);
}

/* dP/dc = P q with q = r^2 c f^2, and grad q = (x, y) 2 c f^4. */
SGT_KERNEL
static void curved(size_t n, double c, const double *restrict x, const double *restrict y, double *restrict p,
                   double *restrict px, double *restrict py)
{
    LANES for (size_t i = 0; i < n; i++) {
        double r2 = x[i] * x[i] + y[i] * y[i], f = factor_at(c, r2), f2 = f * f, q = c * r2 * f2,
               G = 2 * c * (f2 * f2) * p[i];
        px[i] = sgt_fma(px[i], q, x[i] * G), py[i] = sgt_fma(py[i], q, y[i] * G);
        p[i] *= q;
    }
}

static void by_curvature(const void *self, size_t n, const double *x, const double *y, sag_values out)
{
    bfs_at(self, n, x, y, out);
    curved(n, ((const sgt_q_bfs *)self)->c, x, y, out.p, out.px, out.py);
}

static sgt_objection bfs_object(const void *self)
{
    const sgt_q_bfs *s = self;
    if (!(fabs(s->c) < HUGE_VAL)) return (sgt_objection){"curvature", "must be finite"};
    if (!(s->norm > 0 && s->norm < HUGE_VAL)) return (sgt_objection){"norm", "must be above 0"};
    return object_to_list("coefficients", s->a, Q_TERMS, "must have at most 64 numbers");
}

static const departure q_bfs_departure = {
    .at = bfs_at, .rounding = bfs_rounding, .bounds = bfs_bounds_over, .range = bfs_range,
    .second = sgt_q_bfs_second, .parameters = bfs_parameters, .by_parameter = sgt_q_bfs_by_parameter,
    .object = bfs_object, .noise = bfs_noise, .by_curvature = by_curvature, .tail = bfs_tail,
    .profile = bfs_profile};

static departure_sag on_sphere(const sgt_q_bfs *s)
{
    return (departure_sag){.c = s->c, .k = 0, .semi_diameter = s->semi_diameter, .base = true,
                           .of = &q_bfs_departure, .self = s, .fixed_k = true};
}

DEPARTURE_OPS(q_bfs, sgt_q_bfs, on_sphere)
