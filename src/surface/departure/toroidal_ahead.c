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
#include "../../num/bits.h"
#include "ahead.h"

typedef struct toroidal_way {
    const sgt_toroidal *a;
    int terms;
    double k1c2; /* (1 + k) c^2 */
    double ox, dx, oy, dy, oz, dz;
    ahead_poly rest; /* G without g */
} toroidal_way;

/* Sums of the powers at |y|: of those with a > 0, and those with a < 0; z, z', z''. */
typedef struct ahead_powers {
    double up[3], down[3];
} ahead_powers;

/* With P the sum of a y^(2i) and R = y^2: z = R P, z' = 2 y (P + R P'), z'' = 2 (P + R P') + 4 R (2 P' + R
 * P''). */
static ahead_powers powers_at(const toroidal_way *w, double y)
{
    double R = y * y, p[2] = {0, 0}, d[2] = {0, 0}, dd[2] = {0, 0};
    for (int i = w->terms - 1; i >= 0; i--) {
        const double a = w->a->a[i], part[2] = {larger(a, 0), larger(-a, 0)};
        for (int j = 0; j < 2; j++)
            dd[j] = dd[j] * R + d[j], d[j] = d[j] * R + p[j], p[j] = p[j] * R + part[j];
    }
    ahead_powers out;
    for (int j = 0; j < 2; j++) {
        double first = p[j] + R * d[j], *to = j ? out.down : out.up;
        to[0] = R * p[j], to[1] = 2 * (y * first), to[2] = 2 * first + 8 * (R * (d[j] + R * dd[j]));
    }
    return out;
}

/* The conic's z, z', z'' at |y|, of |c|, with phi^2 as given. */
static void conic_at(double c, double y, double phi2, double out[3])
{
    double phi = sqrt(larger(phi2, 0));
    out[0] = c * y * y / (1 + phi), out[1] = c * y / phi, out[2] = c / (phi * phi * phi);
}

/* z_p, z_p' of |y| and z_p'' where |y| is between from and to.  false: it is nowhere defined.  Where these
 * are next to each other, the powers and their slopes are at `from` what they are at `to`, less their
 * greatest derivative times the width; and z_p'' is not known well. */
static bool profile_over(const toroidal_way *w, double from, double to, sgt_interval out[3])
{
    const double c = fabs(w->a->c), bent_from = w->k1c2 * from * from, bent_to = w->k1c2 * to * to;
    double least[3], most[3], phi2_from = 1 - bent_from, phi2_to = 1 - bent_to,
                              off_from = 0x1p-48 * (1 + fabs(bent_from)),
                              off_to = 0x1p-48 * (1 + fabs(bent_to));
    if (phi2_from < -off_from) return false;
    /* phi falls with |y| if 1 + k > 0, else it grows: the greatest z'' is at the end where phi is least */
    const bool falls = w->k1c2 > 0;
    conic_at(c, from, phi2_from + off_from, least);
    conic_at(c, to, phi2_to - off_to, most);
    if (!falls) {
        double near[3], far[3];
        conic_at(c, from, phi2_from - off_from, near), conic_at(c, to, phi2_to + off_to, far);
        least[2] = far[2], most[2] = near[2];
    }
    const ahead_powers far = powers_at(w, to);
    ahead_powers near = {{0, 0, 0}, {0, 0, 0}};
    if (to - from <= 0x1p-20 * to)
        for (int j = 0; j < 2; j++)
            near.up[j] = far.up[j] - (to - from) * far.up[j + 1],
            near.down[j] = far.down[j] - (to - from) * far.down[j + 1];
    else
        near = powers_at(w, from);
    for (int j = 0; j < 3; j++) {
        double lo = w->a->c >= 0 ? least[j] : -most[j], hi = w->a->c >= 0 ? most[j] : -least[j],
               off = AHEAD_LOST * (most[j] + far.up[j] + far.down[j]) + AHEAD_LEAST;
        if (c == 0) lo = hi = 0, off = AHEAD_LOST * (far.up[j] + far.down[j]) + AHEAD_LEAST;
        out[j] = (sgt_interval){lo + (near.up[j] - far.down[j]) - off, hi + (far.up[j] - near.down[j]) + off};
    }
    return true;
}

/* |y| over a stretch, made wider. */
static sgt_interval width_over(const toroidal_way *w, double from, double to)
{
    double a = w->oy + from * w->dy, b = w->oy + to * w->dy,
           off = 0x1p-50 * (fabs(w->oy) + larger(fabs(from), fabs(to)) * fabs(w->dy)),
           lo = smaller(fabs(a), fabs(b));
    if ((a > 0) != (b > 0)) lo = 0;
    return (sgt_interval){larger(lo - off, 0), larger(fabs(a), fabs(b)) + off};
}

static double of_height(double c_x, double z) { return z * (2 - c_x * z); }

/* g, from the range of z_p. */
static sgt_interval swept_over(double c_x, sgt_interval z)
{
    double most = larger(-z.lo, z.hi), off = AHEAD_LOST * most * (2 + fabs(c_x) * most) + AHEAD_LEAST,
           a = of_height(c_x, z.lo), b = of_height(c_x, z.hi), lo = smaller(a, b), hi = larger(a, b);
    double top = 1 / c_x; /* g is greatest there, or least, and 1 / c_x */
    if ((c_x * z.lo < 1 + 0x1p-40) != (c_x * z.hi < 1 - 0x1p-40)) lo = smaller(lo, top), hi = larger(hi, top);
    return (sgt_interval){lo - off, hi + off};
}

static ahead_look toroidal_way_at(const void *self, double t)
{
    const toroidal_way *w = self;
    const double c_x = w->a->c_x;
    sgt_interval y = width_over(w, t, t), z[3];
    ahead_look at = sgt_ahead_poly_at(&w->rest, t);
    if (!profile_over(w, y.lo, y.hi, z)) return (ahead_look){0, 0, HUGE_VAL, HUGE_VAL};
    sgt_interval g = swept_over(c_x, z[0]);
    double height = 0.5 * (z[0].lo + z[0].hi), steep = 0.5 * (z[1].lo + z[1].hi);
    if (w->oy + t * w->dy < 0) steep = -steep;
    at.g += 0.5 * (g.lo + g.hi), at.slope += 2 * w->dy * steep * (1 - c_x * height);
    at.err += 0.5 * (g.hi - g.lo) + AHEAD_LOST * larger(-g.lo, g.hi);
    const double slopes = larger(-z[1].lo, z[1].hi), heights = larger(-z[0].lo, z[0].hi);
    at.slope_err +=
        fabs(w->dy) *
        ((z[1].hi - z[1].lo) * (1 + fabs(c_x) * heights) + slopes * fabs(c_x) * (z[0].hi - z[0].lo)) *
        (1 + 0x1p-20);
    if (y.lo == 0) at.slope_err += 4 * fabs(w->dy) * slopes * (1 + fabs(c_x) * heights);
    return at;
}

/* c_x z > 1 at both ends. */
static bool is_above_axis(const toroidal_way *w, double from, double to)
{
    const double c_x = w->a->c_x, a = w->oz + from * w->dz, b = w->oz + to * w->dz,
                 off = 0x1p-40 * (fabs(w->oz) + larger(fabs(from), fabs(to)) * fabs(w->dz));
    return smaller(c_x * a, c_x * b) > 1 + 0x1p-40 + fabs(c_x) * off;
}

/* 1 - c_x z_p. */
static sgt_interval radius_over(double c_x, sgt_interval z)
{
    double most = 1 + fabs(c_x) * larger(-z.lo, z.hi), lost = AHEAD_LOST * most;
    return (sgt_interval){1 - larger(c_x * z.lo, c_x * z.hi) - lost,
                          1 - smaller(c_x * z.lo, c_x * z.hi) + lost};
}

static bool toroidal_way_off(const void *self, double from, double to)
{
    const toroidal_way *w = self;
    sgt_interval y = width_over(w, from, to), z[3];
    return is_above_axis(w, from, to) || !profile_over(w, y.lo, y.hi, z) ||
           radius_over(w->a->c_x, z[0]).hi < 0;
}

static ahead_over toroidal_way_over(const void *self, double from, double to)
{
    const toroidal_way *w = self;
    const double c_x = w->a->c_x;
    const ahead_over none = {SGT_ANY_NUMBER, SGT_ANY_NUMBER, true};
    sgt_interval y = width_over(w, from, to), z[3];
    if (is_above_axis(w, from, to) || !profile_over(w, y.lo, y.hi, z)) return none;
    double heights = larger(-z[0].lo, z[0].hi), slopes = larger(-z[1].lo, z[1].hi),
           bends = larger(-z[2].lo, z[2].hi);
    double most = 1 + fabs(c_x) * heights;
    const sgt_interval q = radius_over(c_x, z[0]);
    if (q.hi < 0) return none;
    sgt_interval g = swept_over(c_x, z[0]), rest = sgt_ahead_poly_over(&w->rest, from, to);
    g.lo += rest.lo, g.hi += rest.hi;
    double lost = AHEAD_LOST * (fabs(g.lo) + fabs(g.hi));
    g.lo -= lost, g.hi += lost;
    const double c0 = z[2].lo * q.lo, c1 = z[2].lo * q.hi, c2 = z[2].hi * q.lo, c3 = z[2].hi * q.hi;
    double steep2 = slopes * slopes, flat2 = z[1].lo > 0   ? z[1].lo * z[1].lo
                                             : z[1].hi < 0 ? z[1].hi * z[1].hi
                                                           : 0;
    double lo = smaller(smaller(c0, c1), smaller(c2, c3)) - larger(c_x * steep2, c_x * flat2),
           hi = larger(larger(c0, c1), larger(c2, c3)) - smaller(c_x * steep2, c_x * flat2);
    double by = 2 * w->dy * w->dy, twice = 2 * w->rest.c[2],
           off = AHEAD_LOST * (2 * w->rest.most[2] + by * (bends * most + fabs(c_x) * steep2)) + AHEAD_LEAST;
    sgt_interval bend = {twice + by * lo - off, twice + by * hi + off};
    if (!(bends < HUGE_VAL && steep2 < HUGE_VAL)) bend = (sgt_interval)SGT_ANY_NUMBER;
    return (ahead_over){g, bend, false};
}

static bool toroidal_way_tail(const void *self, double t, double sign)
{
    const toroidal_way *w = self;
    const double c_x = w->a->c_x, y = w->oy + t * w->dy, lost = 0x1p-40 * (fabs(w->oy) + fabs(t * w->dy));
    if (w->dy == 0) { /* g is a number */
        const ahead_poly *r = &w->rest,
                         slope = {1, {r->c[1], 2 * r->c[2], 0, 0, 0}, {r->most[1], 2 * r->most[2], 0, 0, 0}};
        return sign != 0 && sgt_ahead_poly_keeps(&slope, t, sign);
    }
    if (!(y * w->dy > 0) || w->terms == 0 || w->k1c2 > 0) return false;
    const double Y = fabs(y) - lost, last = w->a->a[w->terms - 1], S = Y / fabs(w->dy);
    if (!(Y > 0 && c_x * last <= 0)) return false;
    double conic[3];
    const ahead_powers p = powers_at(w, Y);
    double own = fabs(last);
    for (int i = 0; i < w->terms; i++) own *= Y * Y;
    conic_at(fabs(w->a->c), Y, 1 - w->k1c2 * Y * Y, conic);
    if (!(own > 2.01 * (conic[0] + (p.up[0] + p.down[0] - own)))) return false;
    const double L = 0.49 * own, g2 = w->rest.most[2], g1 = w->rest.most[1] + 2 * fabs(t) * g2,
                 g0 = w->rest.most[0] + fabs(t) * (w->rest.most[1] + fabs(t) * g2);
    return L * (2 + fabs(c_x) * L) > 1.01 * (g0 + S * (g1 + S * g2));
}

/* THE START.  G = -(m + p) F with p = 1 - c_x z, and m = p + c_x F: at a root they are the same.  The
 * terms are |x s_x| + |y s_y| + |z|, with s_x = c_x x / m and s_y = z_p' q / m. */
static bool toroidal_way_start(const void *self, double t, double f, double least, ahead_start *out)
{
    const toroidal_way *w = self;
    const double c_x = w->a->c_x, b = fabs(c_x), height = w->oz + t * w->dz, at = 1 - c_x * height,
                 K = 2 * at + b * f + 0x1p-40;
    out->width = f * K / least * (1 + 0x1p-20);
    const sgt_interval p = ahead_about(at, b * fabs(w->dz) * out->width + 0x1p-40),
                       z = ahead_about(height, fabs(w->dz) * out->width),
                       x = ahead_about(w->ox + t * w->dx,
                                       fabs(w->dx) * out->width + 0x1p-40 * fabs(t * w->dx)),
                       y = width_over(w, t, t + out->width);
    sgt_interval of[3];
    if (!(at > 0 && p.lo > 0 && out->width < HUGE_VAL) || !profile_over(w, y.lo, y.hi, of)) return false;
    double steep = larger(larger(of[1].lo, -of[1].hi), 0); /* q >= m = p */
    out->ratio = K / (2 * p.lo);
    out->terms = (b * (x.lo * x.lo) + y.lo * steep * p.lo) / p.hi + z.lo;
    return true;
}

/* A t behind which c_x z > 1, or the profile has ended, if that is before `to`. */
static double toroidal_way_ends(const toroidal_way *w, double from, double to)
{
    const double c_x = w->a->c_x, over = (1 / c_x - w->oz) / w->dz,
                 behind = over + 0x1p-20 * (fabs(over) + fabs(w->oz / w->dz) + fabs(from));
    if (c_x * w->dz > 0 && behind > from && behind < to && is_above_axis(w, behind, behind)) to = behind;
    if (w->k1c2 > 0) {
        double far = (copysign(1 / sqrt(w->k1c2), w->dy) - w->oy) / w->dy,
               off = fabs(far) + fabs(w->oy / w->dy);
        sgt_interval unused[3];
        far += 0x1p-20 * (off + fabs(from));
        if (far > from && far < to && (w->oy + far * w->dy) * w->dy > 0) {
            sgt_interval y = width_over(w, far, far);
            if (!profile_over(w, y.lo, y.hi, unused)) to = far;
        }
    }
    return to;
}

sgt_ahead_kind sgt_toroidal_ahead(const departure_sag *s, const sgt_ray *ray, sgt_ahead *ahead)
{
    static const ahead_ops ops = {toroidal_way_at, toroidal_way_over, toroidal_way_off, toroidal_way_tail,
                                  toroidal_way_start};
    const sgt_toroidal *a = s->self;
    if (!ahead_usual(ray, a->c, a->c_x)) return AHEAD_OPEN;
    const ahead_poly x = ahead_linear(ray->o.x, ray->d.x), z = ahead_linear(ray->o.z, ray->d.z);
    toroidal_way w = {.a = a,
                      .k1c2 = (1 + a->k) * a->c * a->c,
                      .ox = ray->o.x,
                      .dx = ray->d.x,
                      .oy = ray->o.y,
                      .dy = ray->d.y,
                      .oz = ray->o.z,
                      .dz = ray->d.z};
    w.terms = (int)(sizeof a->a / sizeof a->a[0]);
    while (w.terms > 0 && a->a[w.terms - 1] == 0) w.terms--;
    w.rest = ahead_sum(ahead_scaled(ahead_sum(ahead_product(&x, &x), ahead_product(&z, &z)), a->c_x),
                       ahead_scaled(z, -2));
    ahead->to = toroidal_way_ends(&w, ahead->from, ahead->to), ahead->part = 0.4;
    return sgt_look_ahead(&ops, &w, ahead);
}
