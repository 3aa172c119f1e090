// SPDX-License-Identifier: MIT
/* toroidal_ahead.c - toroidal.c, looked along without the root of its sweep (ahead.c).
 *
 * With z_p the profile at y, e the rise of the sweep and w = z - z_p, e is the root near 0 of c_x (x^2 +
 * e^2) = 2 q e, and F = w - e.  So F = 0 is a root of
 *     G = c_x (x^2 + w^2) - 2 q w = c_x (x^2 + z^2) - 2 z + g(y),    g = 2 z_p - c_x z_p^2:
 * a quadratic function of t and one of y alone, which is linear in t.  The other root has c_x z > 1 (as m =
 * q - c_x e >= 0, and q - c_x w = 1 - c_x z).  F is not defined where q = 1 - c_x z_p < 0, nor beyond the
 * end of the profile.
 *
 * OVER A STRETCH |y| is between two numbers.  The conic's height, slope and second derivative, c y^2 / (1 +
 * phi), c y / phi and c / phi^3, are monotone in |y|, and so are the sums of the powers with a > 0, and of
 * those with a < 0.  Hence z_p, z_p' and z_p'' lie between sums of their values at the ends, and
 *     g'' = 2 z_p'' q - 2 c_x z_p'^2.
 * While q >= 0, g grows with z_p.
 *
 * ROUNDING.  y is off by less than 2^-50 (|o_y| + |t d_y|); |y| is made that much wider.  phi^2 is off by
 * less than 2^-50 (1 + |(1 + k) c^2 y^2|), and made wider; the rest is as in ahead.c.
 *
 * THE TAIL.  Behind t let |y| grow from Y, and S = Y / |d_y|.  With p the last power and its a, let |a| Y^p
 * be above twice the sum of all other terms there.  It stays so, as none of them grows faster (p >= 2; the
 * conic has no end, and grows as y^2 at most).  So |z_p| >= |a| y^p / 2 = L (1 + s / S)^p, at t + s, with
 * the sign of a.  The rest of G is at most (|G_0| + |G_1| S + |G_2| S^2) (1 + s / S)^2, from its
 * coefficients at t.  If c_x a < 0, |g| is at least |c_x| z_p^2 + 2 |z_p|, and G has its sign where that is
 * more at s = 0. */
#include "ahead.h"

typedef struct toroidal_way {
    const sgt_toroidal *a;
    int terms;
    double k1c2; /* (1 + k) c^2 */
    const sgt_ahead *ray;
    ahead_quadratics rest; /* G without g */
} toroidal_way;

/* ------------------------------------------------------------------------- the profile */

/* Sums of the powers at |y|: of those with a > 0, and those with a < 0; z, z', z''. */
typedef struct ahead_powers {
    ahead_row up[3], down[3];
} ahead_powers;

/* With P the sum of a y^(2i) and R = y^2: z = R P, z' = 2 y (P + R P'), z'' = 2 (P + R P') + 4 R (2 P' + R
 * P''). */
SGT_INLINE void powers_about(const toroidal_way *w, int terms, size_t first, size_t n,
                             const double *restrict y, ahead_powers *restrict out)
{
    double up[8], down[8];
    for (int j = 0; j < terms; j++) up[j] = larger(w->a->a[j], 0), down[j] = larger(-w->a->a[j], 0);
    LANES for (size_t i = first; i < n; i++)
    {
        const double far = y[i], R = far * far;
        double p = 0, d = 0, dd = 0, q = 0, e = 0, ee = 0;
        UNROLLED for (int j = terms - 1; j >= 0; j--)
        {
            dd = dd * R + d, d = d * R + p, p = p * R + up[j];
            ee = ee * R + e, e = e * R + q, q = q * R + down[j];
        }
        const double by = p + R * d, more = d + R * dd, by_2 = q + R * e, more_2 = e + R * ee;
        out->up[0][i] = R * p, out->up[1][i] = 2 * (far * by), out->up[2][i] = 2 * by + 8 * (R * more);
        out->down[0][i] = R * q, out->down[1][i] = 2 * (far * by_2);
        out->down[2][i] = 2 * by_2 + 8 * (R * more_2);
    }
}

#define POWERS(NAME, TERMS)                                                                             \
    SGT_KERNEL                                                                                          \
    static void NAME(const toroidal_way *w, size_t first, size_t n, const double *y, ahead_powers *out) \
    {                                                                                                   \
        powers_about(w, TERMS, first, n, y, out);                                                       \
    }
POWERS(powers_few, 4)
POWERS(powers_many, 8)

/* Terms that are not there are 0. */
static void powers_at(const toroidal_way *w, size_t first, size_t n, const double *y, ahead_powers *out)
{
    (w->terms <= 4 ? powers_few : powers_many)(w, first, n, y, out);
}

/* z_p, z_p' of |y| and z_p'' where |y| is between from and to; none: it is nowhere defined. */
typedef struct profiles {
    ahead_row lo[3], hi[3], none;
} profiles;

SGT_INLINE void profile_by(const toroidal_way *w, bool flat, bool falls, bool slim, const ahead_powers *near,
                           const ahead_powers *far, size_t first, size_t n, const double *restrict from,
                           const double *restrict to, profiles *restrict out)
{
    const double c = fabs(w->a->c), sign = w->a->c < 0 ? -1 : 1, k1c2 = w->k1c2;
    LANES for (size_t i = first; i < n; i++)
    {
        const double a = from[i], b = to[i], width = b - a, bent_a = k1c2 * a * a, bent_b = k1c2 * b * b,
                     off_a = 0x1p-48 * (1 + fabs(bent_a)), off_b = 0x1p-48 * (1 + fabs(bent_b)),
                     phi2_a = 1 - bent_a, phi2_b = 1 - bent_b, phi_a = sqrt(larger(phi2_a + off_a, 0)),
                     phi_b = sqrt(larger(phi2_b - off_b, 0));
        double z_a = c * a * a / (1 + phi_a), z_b = c * b * b / (1 + phi_b), s_a = c * a / phi_a,
               s_b = c * b / phi_b, low = phi_a, high = phi_b;
        if (!falls) high = sqrt(larger(phi2_a - off_a, 0)), low = sqrt(larger(phi2_b + off_b, 0));
        double b_a = c / (low * low * low), b_b = c / (high * high * high);
        if (flat) z_a = z_b = s_a = s_b = b_a = b_b = 0;
        double up0 = near->up[0][i], up1 = near->up[1][i], up2 = near->up[2][i], down0 = near->down[0][i],
               down1 = near->down[1][i], down2 = near->down[2][i];
        const double U0 = far->up[0][i], U1 = far->up[1][i], U2 = far->up[2][i], D0 = far->down[0][i],
                     D1 = far->down[1][i], D2 = far->down[2][i];
        if (slim) {
            up0 = larger(U0 - width * U1, 0), up1 = larger(U1 - width * U2, 0), up2 = 0;
            down0 = larger(D0 - width * D1, 0), down1 = larger(D1 - width * D2, 0), down2 = 0;
        }
        const double off0 = AHEAD_LOST * (z_b + U0 + D0) + AHEAD_LEAST,
                     off1 = AHEAD_LOST * (s_b + U1 + D1) + AHEAD_LEAST,
                     off2 = AHEAD_LOST * (b_b + U2 + D2) + AHEAD_LEAST;
        out->lo[0][i] = (sign > 0 ? z_a : -z_b) + (up0 - D0) - off0;
        out->hi[0][i] = (sign > 0 ? z_b : -z_a) + (U0 - down0) + off0;
        out->lo[1][i] = (sign > 0 ? s_a : -s_b) + (up1 - D1) - off1;
        out->hi[1][i] = (sign > 0 ? s_b : -s_a) + (U1 - down1) + off1;
        out->lo[2][i] = (sign > 0 ? b_a : -b_b) + (up2 - D2) - off2;
        out->hi[2][i] = (sign > 0 ? b_b : -b_a) + (U2 - down2) + off2;
        out->none[i] = chosen(MASK(phi2_a < -off_a), 1, 0);
    }
}

#define PROFILE(NAME, FLAT, FALLS, SLIM)                                                                     \
    SGT_KERNEL                                                                                               \
    static void NAME(const toroidal_way *w, const ahead_powers *near, const ahead_powers *far, size_t first, \
                     size_t n, const double *from, const double *to, profiles *out)                          \
    {                                                                                                        \
        profile_by(w, FLAT, FALLS, SLIM, near, far, first, n, from, to, out);                                \
    }
PROFILE(flat_profile, true, true, false)
PROFILE(round_profile, false, true, false)
PROFILE(opening_profile, false, false, false)
PROFILE(flat_point, true, true, true)
PROFILE(round_point, false, true, true)
PROFILE(opening_point, false, false, true)

/* phi falls with |y| if 1 + k > 0, else it grows: the greatest z'' is at the end where phi is least. */
static void profile_over(const toroidal_way *w, size_t first, size_t n, const double *from, const double *to,
                         profiles *out)
{
    ahead_powers near, far;
    powers_at(w, first, n, from, &near), powers_at(w, first, n, to, &far);
    (w->a->c == 0  ? flat_profile
     : w->k1c2 > 0 ? round_profile
                   : opening_profile)(w, &near, &far, first, n, from, to, out);
}

/* The same where these are next to each other: the powers and their slopes are at `from` what they are at
 * `to`, less their greatest derivative times the width; and z_p'' is not known well. */
static void profile_at(const toroidal_way *w, size_t first, size_t n, const double *from, const double *to,
                       profiles *out)
{
    ahead_powers far;
    powers_at(w, first, n, to, &far);
    (w->a->c == 0  ? flat_point
     : w->k1c2 > 0 ? round_point
                   : opening_point)(w, &far, &far, first, n, from, to, out);
}

/* |y| over a stretch, made wider. */
SGT_INLINE sgt_interval width_along(double o, double d, double from, double to)
{
    double a = o + from * d, b = o + to * d,
           off = 0x1p-50 * (fabs(o) + larger(fabs(from), fabs(to)) * fabs(d)), lo = smaller(fabs(a), fabs(b));
    lo = chosen((MASK(a > 0) & MASK(b > 0)) | (MASK(a <= 0) & MASK(b <= 0)), lo, 0);
    return (sgt_interval){larger(lo - off, 0), larger(fabs(a), fabs(b)) + off};
}

SGT_KERNEL
static void widths_over(const sgt_ahead *e, size_t first, size_t n, const double *from, const double *to,
                        double *restrict lo, double *restrict hi)
{
    LANES for (size_t i = first; i < n; i++)
    {
        sgt_interval y = width_along(e->o[1][i], e->d[1][i], from[i], to[i]);
        lo[i] = y.lo, hi[i] = y.hi;
    }
}

/* ---------------------------------------------------------------------------- looks */

SGT_INLINE double of_height(double c_x, double z) { return z * (2 - c_x * z); }

/* g, from the range of z_p. */
SGT_INLINE sgt_interval swept_over(double c_x, sgt_interval z)
{
    double most = larger(-z.lo, z.hi), off = AHEAD_LOST * most * (2 + fabs(c_x) * most) + AHEAD_LEAST,
           a = of_height(c_x, z.lo), b = of_height(c_x, z.hi), lo = smaller(a, b), hi = larger(a, b),
           top = 1 / c_x; /* g is greatest there, or least, and 1 / c_x */
    const mask low = MASK(c_x * z.lo < 1 + 0x1p-40), high = MASK(c_x * z.hi < 1 - 0x1p-40);
    top = chosen(low ^ high, top, a);
    return (sgt_interval){smaller(lo, top) - off, larger(hi, top) + off};
}

SGT_KERNEL
static void toroidal_looks(const toroidal_way *w, size_t first, size_t n, const double *t, const double *y_lo,
                           const profiles *of, ahead_looks *restrict out)
{
    const double c_x = w->a->c_x, b = fabs(c_x);
    LANES for (size_t i = first; i < n; i++)
    {
        const double x = t[i], d = w->ray->d[1][i], far = fabs(x), dy = fabs(d);
        const ahead_quadratic rest = ahead_quadratic_of(&w->rest, i);
        const sgt_interval z = {of->lo[0][i], of->hi[0][i]}, s = {of->lo[1][i], of->hi[1][i]},
                           g = swept_over(c_x, z);
        const double height = 0.5 * (z.lo + z.hi), middle = 0.5 * (s.lo + s.hi),
                     steep = chosen(MASK(w->ray->o[1][i] + x * d < 0), -middle, middle),
                     slopes = larger(-s.lo, s.hi), heights = larger(-z.lo, z.hi);
        const double err = ahead_off(rest, far) + (0.5 * (g.hi - g.lo) + AHEAD_LOST * larger(-g.lo, g.hi));
        double slope_err =
            AHEAD_LOST * (2 * rest.m2 * far + rest.m1) + AHEAD_LEAST +
            dy * ((s.hi - s.lo) * (1 + b * heights) + slopes * b * (z.hi - z.lo)) * (1 + 0x1p-20);
        slope_err += chosen(MASK(y_lo[i] == 0), 4 * dy * slopes * (1 + b * heights), 0);
        out->g[i] = ahead_value(rest, x) + 0.5 * (g.lo + g.hi);
        out->slope[i] = 2 * rest.c2 * x + rest.c1 + 2 * d * steep * (1 - c_x * height);
        out->err[i] = chosen(MASK(of->none[i] == 0), err, HUGE_VAL), out->slope_err[i] = slope_err;
    }
}

static void toroidal_way_at(const void *self, size_t first, size_t n, const double *t, ahead_looks *out)
{
    const toroidal_way *w = self;
    ahead_row lo, hi;
    profiles of;
    widths_over(w->ray, first, n, t, t, lo, hi);
    profile_at(w, first, n, lo, hi, &of);
    toroidal_looks(w, first, n, t, lo, &of, out);
}

/* -------------------------------------------------------------------- over a stretch */

/* c_x z > 1 at both ends. */
SGT_INLINE mask is_above_axis(double c_x, double o, double d, double from, double to)
{
    const double a = o + from * d, b = o + to * d,
                 off = 0x1p-40 * (fabs(o) + larger(fabs(from), fabs(to)) * fabs(d));
    return MASK(smaller(c_x * a, c_x * b) > 1 + 0x1p-40 + fabs(c_x) * off);
}

SGT_KERNEL
static void toroidal_stretches(const toroidal_way *w, size_t first, size_t n, const double *from,
                               const double *to, const profiles *of, ahead_overs *restrict out)
{
    const double c_x = w->a->c_x, b = fabs(c_x);
    LANES for (size_t i = first; i < n; i++)
    {
        const ahead_quadratic p = ahead_quadratic_of(&w->rest, i);
        const sgt_interval z = {of->lo[0][i], of->hi[0][i]}, s = {of->lo[1][i], of->hi[1][i]},
                           g = swept_over(c_x, z), rest = ahead_range(p, from[i], to[i]);
        const double heights = larger(-z.lo, z.hi), slopes = larger(-s.lo, s.hi), b_lo = of->lo[2][i],
                     b_hi = of->hi[2][i], bends = larger(-b_lo, b_hi), most = 1 + b * heights,
                     lost = AHEAD_LOST * most; /* q = 1 - c_x z_p */
        const double q_lo = 1 - larger(c_x * z.lo, c_x * z.hi) - lost,
                     q_hi = 1 - smaller(c_x * z.lo, c_x * z.hi) + lost;
        double lo = g.lo + rest.lo, hi = g.hi + rest.hi, more = AHEAD_LOST * (fabs(lo) + fabs(hi));
        const double c0 = b_lo * q_lo, c1 = b_lo * q_hi, c2 = b_hi * q_lo, c3 = b_hi * q_hi,
                     least = larger(larger(s.lo, -s.hi), 0), steep2 = slopes * slopes, flat2 = least * least;
        const double low = smaller(smaller(c0, c1), smaller(c2, c3)) - larger(c_x * steep2, c_x * flat2),
                     high = larger(larger(c0, c1), larger(c2, c3)) - smaller(c_x * steep2, c_x * flat2),
                     dy = w->ray->d[1][i], by = 2 * dy * dy, twice = 2 * p.c2,
                     off = AHEAD_LOST * (2 * p.m2 + by * (bends * most + b * steep2)) + AHEAD_LEAST;
        const mask none = is_above_axis(c_x, w->ray->o[2][i], w->ray->d[2][i], from[i], to[i]) |
                          MASK(of->none[i] != 0) | MASK(q_hi < 0),
                   known = MASK(bends < HUGE_VAL) & MASK(steep2 < HUGE_VAL);
        out->none[i] = chosen(none, 1, 0);
        out->g_lo[i] = lo - more, out->g_hi[i] = hi + more;
        out->bend_lo[i] = chosen(known, twice + by * low - off, -HUGE_VAL);
        out->bend_hi[i] = chosen(known, twice + by * high + off, HUGE_VAL);
    }
}

static void toroidal_way_over(const void *self, size_t first, size_t n, const double *from, const double *to,
                              ahead_overs *out)
{
    const toroidal_way *w = self;
    ahead_row lo, hi;
    profiles of;
    widths_over(w->ray, first, n, from, to, lo, hi);
    profile_over(w, first, n, lo, hi, &of);
    toroidal_stretches(w, first, n, from, to, &of, out);
}

/* ------------------------------------------------------------------------- the tail */

/* Along the profile g is a number. */
SGT_INLINE double flat_tail(const toroidal_way *w, size_t i, double t, double sign)
{
    const ahead_quadratic r = ahead_quadratic_of(&w->rest, i), slope = {r.c1, 2 * r.c2, 0, r.m1, 2 * r.m2, 0};
    return sign != 0 && ahead_keeps(slope, t, sign) != 0 ? 1 : 0;
}

static void toroidal_way_tail(const void *self, size_t first, size_t n, const double *t, const double *sign,
                              double *none)
{
    const toroidal_way *w = self;
    const double c_x = w->a->c_x, c = fabs(w->a->c), last = w->terms ? w->a->a[w->terms - 1] : 0;
    const bool grows = w->terms > 0 && !(w->k1c2 > 0) && c_x * last <= 0;
    ahead_row Y = {0};
    ahead_powers p;
    for (size_t i = first; i < n; i++) {
        const double o = w->ray->o[1][i], d = w->ray->d[1][i];
        none[i] = d == 0 ? flat_tail(w, i, t[i], sign[i]) : 0;
        Y[i] = larger(fabs(o + t[i] * d) - 0x1p-40 * (fabs(o) + fabs(t[i] * d)), 0);
    }
    if (!grows) return;
    powers_at(w, first, n, Y, &p);
    for (size_t i = first; i < n; i++) {
        const double d = w->ray->d[1][i], y = w->ray->o[1][i] + t[i] * d, S = Y[i] / fabs(d),
                     far = fabs(t[i]);
        if (!(y * d > 0 && Y[i] > 0)) continue;
        double own = fabs(last);
        for (int j = 0; j < w->terms; j++) own *= Y[i] * Y[i];
        const double conic = c * Y[i] * Y[i] / (1 + sqrt(1 - w->k1c2 * Y[i] * Y[i]));
        if (!(own > 2.01 * (conic + (p.up[0][i] + p.down[0][i] - own)))) continue;
        const double L = 0.49 * own, g2 = w->rest.m2[i], g1 = w->rest.m1[i] + 2 * far * g2,
                     g0 = w->rest.m0[i] + far * (w->rest.m1[i] + far * g2);
        none[i] = L * (2 + fabs(c_x) * L) > 1.01 * (g0 + S * (g1 + S * g2)) ? 1 : 0;
    }
}

/* ------------------------------------------------------------------------ the start */

/* THE START.  G = -(m + p) F with p = 1 - c_x z, and m = p + c_x F: at a root they are the same.  The
 * terms are |x s_x| + |y s_y| + |z|, with s_x = c_x x / m and s_y = z_p' q / m. */
SGT_KERNEL
static void start_widths(const toroidal_way *w, size_t first, size_t n, const double *t, const double *f,
                         const double *least, double *restrict width, double *restrict to)
{
    const double c_x = w->a->c_x, b = fabs(c_x);
    LANES for (size_t i = first; i < n; i++)
    {
        const double at = 1 - c_x * (w->ray->o[2][i] + t[i] * w->ray->d[2][i]),
                     K = 2 * at + b * f[i] + 0x1p-40;
        width[i] = f[i] * K / least[i] * (1 + 0x1p-20), to[i] = t[i] + width[i];
    }
}

SGT_KERNEL
static void start_terms(const toroidal_way *w, size_t first, size_t n, const double *t, const double *f,
                        const double *width, const double *y, const profiles *of, ahead_starts *restrict out)
{
    const double c_x = w->a->c_x, b = fabs(c_x);
    LANES for (size_t i = first; i < n; i++)
    {
        const double dx = w->ray->d[0][i], dz = fabs(w->ray->d[2][i]), step = width[i],
                     height = w->ray->o[2][i] + t[i] * w->ray->d[2][i], at = 1 - c_x * height,
                     K = 2 * at + b * f[i] + 0x1p-40,
                     steep = larger(larger(of->lo[1][i], -of->hi[1][i]), 0); /* q >= m = p */
        const sgt_interval p = ahead_about(at, b * dz * step + 0x1p-40), z = ahead_about(height, dz * step),
                           x = ahead_about(w->ray->o[0][i] + t[i] * dx,
                                           fabs(dx) * step + 0x1p-40 * fabs(t[i] * dx));
        const mask known = MASK(at > 0) & MASK(p.lo > 0) & MASK(step < HUGE_VAL) & MASK(of->none[i] == 0);
        out->width[i] = chosen(known, step, (double)NAN);
        out->ratio[i] = K / (2 * p.lo);
        out->terms[i] = (b * (x.lo * x.lo) + y[i] * steep * p.lo) / p.hi + z.lo;
    }
}

static void toroidal_way_start(const void *self, size_t first, size_t n, const double *t, const double *f,
                               const double *least, ahead_starts *out)
{
    const toroidal_way *w = self;
    ahead_row width, to, lo, hi;
    profiles of;
    start_widths(w, first, n, t, f, least, width, to);
    widths_over(w->ray, first, n, t, to, lo, hi);
    profile_at(w, first, n, lo, hi, &of);
    start_terms(w, first, n, t, f, width, lo, &of, out);
}

/* ------------------------------------------------------------------- where it begins */

SGT_KERNEL
static void toroidal_way_begin(toroidal_way *restrict w, size_t n, sgt_ahead *restrict e)
{
    const double c_x = w->a->c_x, k1c2 = w->k1c2, end = 1 / sqrt(larger(k1c2, 0));
    LANES for (size_t i = 0; i < n; i++)
    {
        const ahead_quadratic x2 = ahead_square(e->o[0][i], e->d[0][i]),
                              z2 = ahead_square(e->o[2][i], e->d[2][i]),
                              z = ahead_linear(e->o[2][i], e->d[2][i]);
        ahead_quadratic_put(&w->rest, i,
                            ahead_sum(ahead_scaled(ahead_sum(x2, z2), c_x), ahead_scaled(z, -2)));
        /* a t behind which c_x z > 1 */
        const double from = e->from[i], over = (1 / c_x - z.c0) / z.c1;
        double behind = over + 0x1p-20 * (fabs(over) + fabs(z.c0 / z.c1) + fabs(from)), to = e->to[i];
        const mask above = MASK(c_x * z.c1 > 0) & MASK(behind > from) & MASK(behind < to) &
                           is_above_axis(c_x, z.c0, z.c1, behind, behind);
        to = chosen(above, behind, to);
        /* a t behind which the profile has ended */
        const double oy = e->o[1][i], dy = e->d[1][i], there = (copysign(end, dy) - oy) / dy,
                     far = there + 0x1p-20 * (fabs(there) + fabs(oy / dy) + fabs(from));
        const sgt_interval y = width_along(oy, dy, far, far);
        const double bent = k1c2 * y.lo * y.lo;
        const mask ends = MASK(k1c2 > 0) & MASK(far > from) & MASK(far < to) &
                          MASK((oy + far * dy) * dy > 0) & MASK(1 - bent < -(0x1p-48 * (1 + fabs(bent))));
        e->to[i] = chosen(ends, far, to);
    }
}

void sgt_toroidal_ahead(const departure_sag *s, size_t n, sgt_ahead *e)
{
    static const ahead_ops ops = {toroidal_way_at, toroidal_way_over, toroidal_way_tail, toroidal_way_start};
    const sgt_toroidal *a = s->self;
    const size_t rows = ahead_rows(n);
    toroidal_way w;
    w.a = a, w.k1c2 = (1 + a->k) * a->c * a->c, w.ray = e;
    w.terms = (int)(sizeof a->a / sizeof a->a[0]);
    while (w.terms > 0 && a->a[w.terms - 1] == 0) w.terms--;
    toroidal_way_begin(&w, rows, e);
    ahead_drop_unusual(a->c, a->c_x, rows, e);
    sgt_look_ahead(&ops, &w, n, 0.4, e);
}
