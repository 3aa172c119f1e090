// SPDX-License-Identifier: MIT
/* toroidal.c - a profile z_p(y), a conic and even powers, swept about an axis parallel to y.
 *
 * THE SAG.  Let t = c_x x and q = 1 - c_x z_p.  q is the profile's distance from the axis z = 1 / c_x,
 * over the radius of x.  Then
 *     s = z_p + e,   e = t x / (q + m),   m = sqrt(q^2 - t^2) = sqrt((q - |t|) (q + |t|)).
 * There is no division by c_x, so c_x = 0 is a profile drawn straight along x.  e is the root near 0 of
 * c_x (x^2 + e^2) = 2 q e, and m = q - c_x e.
 *
 * THE DERIVATIVES are all quotients by m:
 *     s_x = t / m,                    s_y = z_p' q / m,
 *     s_xx = c_x q^2 / m^3,           s_xy = c_x t q z_p' / m^3,
 *     s_yy = z_p'' q / m + c_x t^2 z_p'^2 / m^3.
 * For a parameter a of the profile
 *     s_a = z_a q / m,    s_ax = z_a c_x t q / m^3,    s_ay = z_a' q / m + z_a c_x t^2 z_p' / m^3.
 * For the conic, with phi = sqrt(1 - (1 + k) c^2 y^2),
 *     z_c = y^2 / (phi (1 + phi)),                 z_c' = y / phi^3,
 *     z_k = c^3 y^4 / (2 phi (1 + phi)^2),         z_k' = c^3 y^3 / (2 phi^3).
 * Since q + c_x z_p = 1,
 *     s_c_x = (x^2 + e (e + 2 z_p)) / (2 m),       its gradient (q x, z_p' t x) / m^3.
 *
 * CONVEX.  Without powers z_p is convex for c > 0, whatever k is, and q is concave if c_x > 0, too.  The
 * points (x, y, z) on and above the surface, up to z = 1 / c_x, are those with |(c_x x, 1 - c_x z)| <= q(y).
 * A length is convex, so these are a convex set, and s is convex.  If both are negative, it is concave.
 *
 * ROUNDING, with u = 2^-53.  The conic's part is as in biconic.c, with one term.  The term a y^(2i+2) is
 * rounded at most 3 i + 4 times, and those of P'(y^2) 4 i + 4 times.  Hence 4 u y^2 first and 4 u (first +
 * y^2 second), with the sums of poly.h.  q - |t| and q + |t| are off by the errors of q and t.  m is off
 * by the error of its square over the sum of m and its least value, and never by more than the root of
 * that error.  All else are quotients by m and q + m.  They are carried on line by line, and enlarged by
 * 2^-20.
 *
 * BOUNDS.  By intervals, from the formulas above, over |x| and |y|.  For a steep toroid |y| is cut into
 * eight slices.  In each of them x^2 is at most r_hi^2 - y^2.  A single rectangle has a corner beyond the
 * rim, where the surface is steeper, or not defined.
 *
 * BY SIZE.  About the axis, where the toroid is gentle, sums of magnitudes say as much at a twentieth of the
 * cost.  Let |x| <= X, |y| <= Y, r <= R, phi >= f.  Then
 *     |z_p| <= Z y^2,        Z = |c| / (1 + f) + sum (i + 1) |a_i| Y^(2i),
 *     |z_p'| <= D |y|,       D = |c| / f + 2 sum (i + 1) |a_i| Y^(2i),
 *     z_p'' in c / phi^3 +- 2 sum (i + 1) (2i + 1) |a_i| Y^(2i),
 *     q <= Q = 1 + |c_x| Z Y^2,
 *     m^2 >= 1 - 2 |c_x| Z y^2 - c_x^2 x^2, over the rectangle, and over the disc,
 * and 1 <= q / m <= Q / m, m <= q.  So s_xx / c_x is at least 1 / q >= 1 / Q, and |grad s| is at most R times
 * the larger of |c_x| / m and D Q / m.  All numbers are positive and rounded some dozens of times; 2^-20 is
 * added. */
#include "bend.h"
#include "departure.h"

enum { TOROIDAL_TERMS = 8, TOROIDAL_SLICES = 8 };
static const double TOROIDAL_GENTLE = 1; /* a slope below this needs no slices */

static int toroidal_terms_of(const sgt_toroidal *s)
{
    int terms = TOROIDAL_TERMS;
    while (terms > 0 && s->a[terms - 1] == 0) terms--;
    return terms;
}

/* h = sum of a[i] y^(2i), and dh, its derivative by y^2. */
SGT_INLINE void powers_of(const sgt_toroidal *s, size_t n, const double *restrict y, double *restrict h,
                          double *restrict dh)
{
    int terms = toroidal_terms_of(s);
    const double last = terms ? s->a[terms - 1] : 0;
    LANES for (size_t i = 0; i < n; i++) h[i] = last, dh[i] = 0;
    for (int j = terms - 2; j >= 0; j--) {
        const double a = s->a[j];
        LANES for (size_t i = 0; i < n; i++) {
            double rho = y[i] * y[i];
            dh[i] = dh[i] * rho + h[i];
            h[i] = h[i] * rho + a;
        }
    }
}

/* The profile and the sweep at one point, from h and dh of powers_of. */
typedef struct swept { double phi, z, dz, t, q, m, e; } swept;

SGT_INLINE swept swept_at(double c, double k1, double c_x, double x, double y, double h, double dh)
{
    swept s;
    double rho = y * y, v = c * y;
    s.phi = sqrt(1 - k1 * v * v);
    s.z = v * y / (1 + s.phi) + rho * h;
    /* At the equator the slope is huge but finite; beyond it, NaN. */
    s.dz = v / larger(s.phi, 0x1p-400) + 2 * y * (h + rho * dh) + (s.phi - s.phi);
    s.t = c_x * x, s.q = 1 - c_x * s.z;
    s.m = sqrt(chosen(MASK(s.q > 0), (s.q - fabs(s.t)) * (s.q + fabs(s.t)), (double)NAN));
    s.e = s.t * x / (s.q + s.m);
    return s;
}

SGT_KERNEL
static void toroidal_sag(const sgt_toroidal *self, size_t n, const double *restrict px,
                         const double *restrict py, double *restrict p, double *restrict gx,
                         double *restrict gy)
{
    const double c = self->c, k1 = 1 + self->k, c_x = self->c_x;
    double h[DEPARTURE_BLOCK], dh[DEPARTURE_BLOCK];
    powers_of(self, n, py, h, dh);
    LANES for (size_t i = 0; i < n; i++) {
        swept s = swept_at(c, k1, c_x, px[i], py[i], h[i], dh[i]);
        double over_m = 1 / larger(s.m, 0x1p-400) + (s.m - s.m);
        p[i] = s.z + s.e;
        gx[i] = s.t * over_m;
        gy[i] = s.dz * (s.q * over_m);
    }
}

static void toroidal_at(const void *self, size_t n, const double *x, const double *y, sag_values out)
{
    toroidal_sag(self, n, x, y, out.p, out.px, out.py);
}

/* How far a root can be off whose square d is off by d_err.  *low: its least value. */
static double root_off(double d, double d_err, double *low)
{
    double root = sqrt(d), by_root = sqrt(d_err);
    *low = sqrt(larger(d - d_err, 0));
    return ((root + *low) * by_root > d_err ? d_err / (root + *low) : by_root) + SGT_U * root;
}

static void toroidal_off(const void *self, double x, double y, double *p_err, double *grad_err)
{
    const sgt_toroidal *a = self;
    const double u = SGT_U, least = 0x1p-1060, more = 1 + 0x1p-20;
    int terms = toroidal_terms_of(a);
    double h, dh, second, first = magnitude(terms, a->a, y * y, &second), low, m_low;
    powers_of(a, 1, &y, &h, &dh);
    swept s = swept_at(a->c, 1 + a->k, a->c_x, x, y, h, dh);
    *p_err = *grad_err = HUGE_VAL;
    if (!(s.m >= 0)) return; /* NaN; the sag may still exist */

    double rho = y * y, v = a->c * y, term = fabs((1 + a->k) * v * v), w = 1 + s.phi;
    double phi_err = root_off(s.phi * s.phi, u * (5 * term + 4 * s.phi * s.phi) * more, &low) + u * s.phi;
    double conic = fabs(v * y / w), w_low = larger(w - (phi_err + u * w), 1);
    double z_err = conic * (4 * u + (phi_err + u * w) / w_low) + 4 * u * rho * first + u * fabs(s.z);
    double t = fabs(s.t), near = s.q - t, far = s.q + t;
    double q_err = fabs(a->c_x) * z_err + u * (fabs(a->c_x * s.z) + fabs(s.q)),
           near_err = q_err + u * (t + fabs(near)), far_err = q_err + u * (t + far);
    double m_err = root_off(
        s.m * s.m, (near_err * far + far_err * (near + near_err) + 4 * u * s.m * s.m) * more, &m_low);
    double sum = s.q + s.m, sum_low = sum - (q_err + m_err + u * sum), e = fabs(s.e);
    if (!(sum_low > 0)) return;
    double e_err = e * (4 * u + (q_err + m_err + u * sum) / sum_low);
    *p_err = (z_err + e_err + u * fabs(s.z + s.e)) * more + least;
    if (!(*p_err < HUGE_VAL)) *p_err = HUGE_VAL; /* NaN too */
    if (!(low > 0 && m_low > 0)) return;

    double of_conic = fabs(v / s.phi), of_powers = 2 * fabs(y) * (first + rho * second);
    double dz_err = of_conic * (3 * u + phi_err / low) + 4 * u * of_powers + 2 * u * fabs(s.dz);
    double m_part = m_err / m_low + 4 * u, gx_err = t / s.m * m_part;
    double gy_err = (dz_err * (s.q + q_err) + fabs(s.dz) * q_err) / m_low + fabs(s.dz * s.q) / s.m * m_part;
    *grad_err = larger(gx_err, gy_err) * more + least;
    if (!(*grad_err < HUGE_VAL)) *grad_err = HUGE_VAL;
}

/* P'(rho), with P'' in *second and P in *sum, for P = sum of a[i] rho^(i+1). */
static sgt_interval powers_over(const sgt_toroidal *a, sgt_interval rho, bool slopes, sgt_interval *sum,
                                sgt_interval *second)
{
    sgt_interval h = {0, 0}, dh = {0, 0}, ddh = {0, 0};
    for (int i = toroidal_terms_of(a) - 1; i >= 0; i--) {
        sgt_interval of = sgt_interval_of(a->a[i]), first = sgt_interval_scaled(of, i + 1);
        if (slopes && i > 0)
            ddh = sgt_interval_sum(sgt_interval_product(ddh, rho), sgt_interval_scaled(first, i));
        if (slopes) dh = sgt_interval_sum(sgt_interval_product(dh, rho), first);
        h = sgt_interval_sum(sgt_interval_product(h, rho), of);
    }
    *sum = sgt_interval_product(h, rho), *second = ddh;
    return dh;
}

/* |x| and |y| of a rectangle, and what is known of s over it.  q_most and m_least bound q and m.
 * slice_bounds returns what `bounds` does, but does not cut a region. */
typedef struct toroidal_slice {
    sgt_interval x, y, s;
    double q_most, m_least;
    bounds most;
    sgt_by_axis axis;
    bool heights; /* no more than s is wanted */
} toroidal_slice;

static int slice_bounds(const sgt_toroidal *a, toroidal_slice *at)
{
    sgt_interval one = {1, 1}, c = sgt_interval_of(a->c), c_x = sgt_interval_of(a->c_x),
                 rho = sgt_interval_square(at->y), v = sgt_interval_product(c, at->y);
    sgt_interval phi2 = sgt_interval_difference(
        one, sgt_interval_product(sgt_interval_sum(one, sgt_interval_of(a->k)), sgt_interval_square(v)));
    if (phi2.hi < 0) return 0;
    sgt_interval phi = sgt_interval_square_root(phi2), p, ddp,
                 dp = powers_over(a, rho, !at->heights, &p, &ddp);
    sgt_interval z = sgt_interval_sum(
        sgt_interval_quotient(sgt_interval_product(v, at->y), sgt_interval_sum(one, phi)), p);
    sgt_interval q = sgt_interval_difference(one, sgt_interval_product(c_x, z)),
                 t = sgt_interval_absolute(sgt_interval_product(c_x, at->x));
    sgt_interval near = sgt_interval_difference(q, t), far = sgt_interval_sum(q, t);
    if (!(q.hi > 0 && near.hi >= 0)) return 0;
    at->q_most = q.hi;
    bool whole = phi2.lo >= 0 && q.lo > 0 && near.lo >= 0;
    sgt_interval some = {0, HUGE_VAL};
    q = sgt_interval_intersection(q, some), near = sgt_interval_intersection(near, some),
    far = sgt_interval_intersection(far, some);
    sgt_interval m = sgt_interval_square_root(sgt_interval_product(near, far)), sum = sgt_interval_sum(q, m);
    sgt_interval e = sgt_interval_quotient(sgt_interval_product(c_x, sgt_interval_square(at->x)), sum);
    at->s = sgt_interval_sum(z, e), at->m_least = whole ? m.lo : 0;
    if (at->heights) return whole ? 1 : -1;
    /* where it may be undefined, size is infinite: no graze is told by it */
    at->most = (bounds){whole ? sgt_interval_greatest(at->s) : HUGE_VAL, HUGE_VAL, HUGE_VAL};
    at->axis = (sgt_by_axis)SGT_NO_AXES;
    if (!(whole && phi.lo > 0 && m.lo > 0)) return whole ? 1 : -1;

    sgt_interval dz = sgt_interval_product(
        at->y, sgt_interval_sum(sgt_interval_quotient(c, phi), sgt_interval_scaled(dp, 2)));
    sgt_interval ddz = sgt_interval_sum(
        sgt_interval_quotient(c, sgt_interval_power(phi, 3)),
        sgt_interval_sum(sgt_interval_scaled(dp, 2), sgt_interval_scaled(sgt_interval_product(rho, ddp), 4)));
    sgt_interval by_m = sgt_interval_quotient(q, m), sx = sgt_interval_quotient(t, m),
                 sy = sgt_interval_product(dz, by_m);
    sgt_interval bent = sgt_interval_quotient(c_x, m), across = sgt_interval_product(sx, dz);
    sgt_interval xx = sgt_interval_product(bent, sgt_interval_square(by_m)),
                 xy = sgt_interval_product(bent, sgt_interval_product(by_m, across));
    sgt_interval yy = sgt_interval_sum(sgt_interval_product(ddz, by_m),
                                       sgt_interval_product(bent, sgt_interval_square(across)));
    at->most.steep =
        sgt_interval_square_root(sgt_interval_sum(sgt_interval_square(sx), sgt_interval_square(sy))).hi;
    sgt_by_axis *by = &at->axis;
    *by = (sgt_by_axis){sgt_interval_greatest(sx), sgt_interval_greatest(sy), sgt_interval_greatest(xy), 0,
                        xx, yy};
    at->most.bend = norm_of(sgt_interval_greatest(xx), by->xy, sgt_interval_greatest(yy));
    return 1;
}

/* See CONVEX. */
static double toroidal_turn(const sgt_toroidal *a)
{
    if (toroidal_terms_of(a)) return 0;
    return a->c >= 0 && a->c_x >= 0 ? 1 : a->c <= 0 && a->c_x <= 0 ? -1 : 0;
}

/* As `bounds`, over this many slices.  *where is not cut. */
static int sliced(const sgt_toroidal *a, const region *where, int slices, bounds *out, sgt_by_axis *all,
                  sgt_interval *range, double *q_most, double *m_least)
{
    sgt_interval x = sgt_interval_absolute(where->x), y = sgt_interval_absolute(where->y);
    double r2 = sgt_product_above(where->r_hi, where->r_hi);
    bool some = false, whole = true;
    *out = (bounds){0, 0, 0}, *range = sgt_interval_empty(), *q_most = 0,
    *all = (sgt_by_axis){0, 0, 0, toroidal_turn(a), sgt_interval_empty(), sgt_interval_empty()},
    *m_least = HUGE_VAL;
    for (int i = 0; i < slices; i++) {
        double from = y.lo + (y.hi - y.lo) * i / slices,
               to = i + 1 < slices ? y.lo + (y.hi - y.lo) * (i + 1) / slices : y.hi;
        toroidal_slice at = {.x = x, .y = {from, to}};
        double x2 = sgt_sum_above(r2, -sgt_interval_square(at.y).lo); /* at most */
        at.x = x2 >= 0 ? sgt_interval_intersection(x, sgt_interval_between(0, sgt_square_root_above(x2)))
                       : sgt_interval_empty();
        if (sgt_interval_is_empty(at.x)) continue;
        int defined = slice_bounds(a, &at);
        whole = whole && defined == 1;
        if (!defined) continue;
        some = true;
        *range = sgt_interval_hull(*range, at.s);
        *q_most = larger(*q_most, at.q_most), *m_least = -larger(-*m_least, -at.m_least);
        out->size = larger(out->size, at.most.size), out->steep = larger(out->steep, at.most.steep),
        out->bend = larger(out->bend, at.most.bend);
        const sgt_by_axis e = at.axis;
        *all = (sgt_by_axis){larger(all->x, e.x), larger(all->y, e.y), larger(all->xy, e.xy), all->turn,
                             sgt_interval_hull(all->xx, e.xx), sgt_interval_hull(all->yy, e.yy)};
    }
    return !some ? 0 : whole ? 1 : -1;
}

/* Uses slices only if one rectangle is steep and has its corners beyond the rim. */
static int toroidal_over(const sgt_toroidal *a, const region *where, bounds *out, sgt_by_axis *axis,
                         sgt_interval *range, double *q_most, double *m_least)
{
    double x = sgt_interval_greatest(where->x), y = sgt_interval_greatest(where->y), r = where->r_hi;
    int defined = sliced(a, where, 1, out, axis, range, q_most, m_least);
    if (defined && !(defined == 1 && out->steep < TOROIDAL_GENTLE) && x * x + y * y > r * r * (1 + 0x1p-20))
        return sliced(a, where, TOROIDAL_SLICES, out, axis, range, q_most, m_least);
    return defined;
}

SGT_NARROW(int, sgt_toroidal_apart,
           (const void *self, region *where, bounds *out, sgt_by_axis *axis,
            sgt_interval *heights))
{
    const sgt_toroidal *a = self;
    double q_most, m_least;
    int defined = toroidal_over(a, where, out, axis, heights, &q_most, &m_least);
    if (defined != -1) return defined;
    sgt_interval one = {1, 1}, A = sgt_interval_product(sgt_interval_sum(one, sgt_interval_of(a->k)),
                                                        sgt_interval_square(sgt_interval_of(a->c)));
    sgt_interval far = sgt_interval_quotient(sgt_interval_of(q_most),
                                             sgt_interval_absolute(sgt_interval_of(a->c_x)));
    if (a->c_x != 0) where->x = sgt_interval_intersection(where->x, sgt_interval_between(-far.hi, far.hi));
    if (A.lo > 0)
        far = sgt_interval_square_root(sgt_interval_quotient(one, A)),
        where->y = sgt_interval_intersection(where->y, sgt_interval_between(-far.hi, far.hi));
    return sgt_interval_is_empty(where->x) || sgt_interval_is_empty(where->y) ? 0 : -1;
}

static int toroidal_bounds(const void *self, region *where, bounds *out)
{
    sgt_by_axis unused;
    sgt_interval heights;
    return sgt_toroidal_apart(self, where, out, &unused, &heights);
}

/* The profile where |y| is at most r: bent = (1 + k) c^2 r^2, the least phi of its conic, the conic's own
 * term over y^2, and of its powers `magnitude` (sag/poly.h). */
typedef struct profile_size { double bent, phi, conic, first, second; } profile_size;

static bool profile_within(const sgt_toroidal *a, double radius, profile_size *s)
{
    double r2 = radius * radius;
    s->bent = (1 + a->k) * a->c * a->c * r2;
    double phi2 = 1 - larger(s->bent, 0);
    s->phi = sqrt(phi2), s->conic = fabs(a->c) / (1 + s->phi),
    s->first = magnitude(toroidal_terms_of(a), a->a, r2, &s->second);
    return phi2 > 0x1p-20;
}

/* m^2 where |z_p| <= z y^2, |x| and |y| are at most these, and r at most r. */
static double least_m2(const sgt_toroidal *a, double z, double x, double y, double r)
{
    const double c_x = fabs(a->c_x), t = c_x * x,
                 in_box = 1 - (2 * z * c_x * (y * y) + t * t) * (1 + 0x1p-20),
                 in_disc = 1 - larger(2 * z * c_x, c_x * c_x) * (r * r) * (1 + 0x1p-20);
    return larger(in_box, in_disc);
}

/* BY SIZE; as by_axis.  false: not gentle. */
static bool toroidal_by_size(const sgt_toroidal *a, const region *where, bounds *out, sgt_by_axis *axis,
                             sgt_interval *heights)
{
    const double x = where->x.hi, y = where->y.hi, r = where->r_hi, more = 1 + 0x1p-20;
    profile_size s;
    if (!(where->x.lo == -x && where->y.lo == -y && r < 0x1p400 && profile_within(a, y, &s))) return false;
    const double c_x = fabs(a->c_x), c = fabs(a->c), y2 = y * y, z = s.conic + s.first,
                 m2 = least_m2(a, z, x, y, r);
    if (!(m2 > 0.25)) return false;
    const double m = sqrt(m2), q = (1 + c_x * z * y2) * more, by_m = q / m, cube = q / (m * m2),
                 slope = c / s.phi + 2 * s.first, gx = c_x / m * x, gy = slope * by_m * y,
                 in_box = sqrt(gx * gx + gy * gy), in_disc = larger(c_x / m, slope * by_m) * r;
    const double steep = (in_box < in_disc ? in_box : in_disc) * more;
    if (!(steep < TOROIDAL_GENTLE)) return false;
    const double powers = 2 * s.first + 4 * y2 * s.second, phi_most = sqrt(1 - (s.bent < 0 ? s.bent : 0)),
                 least = c / (phi_most * phi_most * phi_most), most = c / (s.phi * s.phi * s.phi);
    /* Of a profile that is bent upward; else both are reversed. */
    const double lo = (least - powers) * (least < powers ? by_m : 1), hi = (most + powers) * by_m,
                 turned = c_x * (c_x * x) * (c_x * x) * (slope * y) * (slope * y) / (m * m2);
    const sgt_interval xx = {c_x / q, c_x * q * cube},
                       yy = a->c < 0 ? sgt_interval_between(-hi, -lo) : sgt_interval_between(lo, hi);
    const double off = 0x1p-20 * (hi + powers + turned), turn = a->c_x < 0 ? -1 : 1;
    axis->x = gx * more, axis->y = gy * more, axis->turn = toroidal_turn(a);
    axis->xy = c_x * (c_x * x) * (slope * y) * cube * more;
    axis->xx = turn < 0 ? sgt_interval_between(-xx.hi * more, -xx.lo / more)
                        : sgt_interval_between(xx.lo / more, xx.hi * more);
    axis->yy = sgt_interval_between(yy.lo - (turn < 0 ? turned : 0) - off,
                                    yy.hi + (turn > 0 ? turned : 0) + off);
    const double profile = z * y2 * more, sweep = c_x * x * x / (2 * m) * more;
    const bool bowl = s.first == 0;
    heights->lo = -((bowl && a->c > 0 ? 0 : profile) + (turn < 0 ? sweep : 0)) * more;
    heights->hi = ((bowl && a->c < 0 ? 0 : profile) + (turn > 0 ? sweep : 0)) * more;
    out->size = (profile + sweep) * more, out->steep = steep;
    out->bend = norm_of(sgt_interval_greatest(axis->xx), axis->xy, sgt_interval_greatest(axis->yy)) * more;
    return out->bend < HUGE_VAL;
}

static int toroidal_about(const void *self, region *where, bounds *out, sgt_by_axis *axis,
                          sgt_interval *heights)
{
    if (toroidal_by_size(self, where, out, axis, heights)) return 1;
    return sgt_toroidal_apart(self, where, out, axis, heights);
}

/* The lines of toroidal_off with the worst values where |y| <= most, q at most and m at least those given.
 * Each part of the sag is at most a number times x^2 or y^2. */
static void noise_of(const sgt_toroidal *a, double most, const profile_size *s, double q, double m,
                     double e[2])
{
    const double u = SGT_U, r2 = most * most, phi = s->phi, conic = s->conic, first = s->first,
                 c_x = fabs(a->c_x);
    if (!(m > 0x1p-10 * q)) return;
    double w_err = u * (5 * fabs(s->bent) + 4 + 4 * fabs(s->bent)) / (1.99 * phi * (1 + phi)) + 3 * u;
    double z = conic + first, z_err = conic * (4 * u + w_err) + 4 * u * first + u * z; /* over y^2 */
    double q_err = c_x * z_err * r2 + u * (c_x * z * r2 + q),
           m_err = (2 * q * (q_err + 2 * u * q) + q * (q_err + 3 * u * q) + 4 * u * q * q) / (1.99 * m) +
                   2 * u * q;
    /* Over x^2. */
    double lanes = c_x / (2 * m), lane_err = lanes * (4 * u + (q_err + m_err) / (1.99 * m) + u);
    e[0] = 0x1p-1060, e[1] = larger(z_err + u * z, lane_err + u * lanes) * (1 + 0x1p-16);
}

static void noise_over(const void *self, const region *where, double e[2])
{
    bounds most;
    profile_size s;
    sgt_by_axis axis;
    sgt_interval range;
    double q, m, y = where->y.hi;
    if (profile_within(self, y, &s) && toroidal_over(self, where, &most, &axis, &range, &q, &m) == 1)
        noise_of(self, y, &s, q, m, e);
}

static void toroidal_noise(const void *self, double radius, double e[2])
{
    noise_over(self, &(region){{-radius, radius}, {-radius, radius}, 0, radius}, e);
}

/* q and m by size.  Only where this says too little intervals are asked. */
static bool noise_by_size(const sgt_toroidal *a, double y, const profile_size *s, double q, double m2,
                          double e[2])
{
    if (m2 > 0.25) noise_of(a, y, s, q, sqrt(m2), e);
    return m2 > 0.25;
}

SGT_NARROW(void, sgt_toroidal_noise_about, (const void *self, double radius, double e[2]))
{
    const sgt_toroidal *a = self;
    profile_size s;
    if (!profile_within(a, radius, &s)) return;
    double c_x = fabs(a->c_x), r2 = radius * radius * (1 + 0x1p-20), z = c_x * (s.conic + s.first);
    if (!noise_by_size(a, radius, &s, 1 + z * r2, 1 - larger(2 * z, c_x * c_x) * r2, e))
        toroidal_noise(a, radius, e);
}

static void toroidal_noise_in_box(const void *self, double x, double y, double e[2])
{
    const sgt_toroidal *a = self;
    profile_size s;
    if (!profile_within(a, y, &s)) return;
    double more = 1 + 0x1p-20, c_x = fabs(a->c_x), t = c_x * x * more,
           z = c_x * (s.conic + s.first) * (y * y) * more;
    region where = {{-x, x}, {-y, y}, 0, sqrt(x * x + y * y) * (1 + 0x1p-40)};
    if (!noise_by_size(a, y, &s, 1 + z, 1 - 2 * z - t * t, e)) noise_over(a, &where, e);
}

SGT_NARROW(sgt_interval, sgt_toroidal_range, (const void *self, const region *where))
{
    const double r2 = sgt_product_above(where->r_hi, where->r_hi);
    toroidal_slice at = {.x = sgt_interval_absolute(where->x), .y = sgt_interval_absolute(where->y),
                         .heights = true};
    const double x2 = sgt_sum_above(r2, -sgt_interval_square(at.y).lo); /* as in `sliced` */
    if (!(x2 >= 0)) return sgt_interval_empty();
    at.x = sgt_interval_intersection(at.x, sgt_interval_between(0, sgt_square_root_above(x2)));
    if (sgt_interval_is_empty(at.x) || !slice_bounds(self, &at)) return sgt_interval_empty();
    sgt_interval range = at.s;
    /* q - c_x e = m >= 0, so c_x s is at most 1: there the sweep turns back. */
    double c_x = ((const sgt_toroidal *)self)->c_x;
    sgt_interval back = sgt_interval_quotient(sgt_interval_of(1), sgt_interval_of(c_x));
    if (c_x > 0 && back.hi < range.hi) range.hi = back.hi;
    if (c_x < 0 && back.lo > range.lo) range.lo = back.lo;
    return range;
}

SGT_KERNEL
static void toroidal_bent(const sgt_toroidal *self, size_t n, const double *restrict px,
                          const double *restrict py, double *restrict pxx, double *restrict pxy,
                          double *restrict pyy)
{
    const double c = self->c, k1 = 1 + self->k, c_x = self->c_x;
    double h[DEPARTURE_BLOCK], dh[DEPARTURE_BLOCK], ddh[DEPARTURE_BLOCK];
    int terms = toroidal_terms_of(self);
    powers_of(self, n, py, h, dh);
    /* The second derivative of rho h by rho: the sum of i (i + 1) a[i] rho^(i-1). */
    LANES for (size_t i = 0; i < n; i++) ddh[i] = 0;
    for (int j = terms - 1; j > 0; j--) {
        const double a = j * (j + 1) * self->a[j];
        LANES for (size_t i = 0; i < n; i++) ddh[i] = ddh[i] * (py[i] * py[i]) + a;
    }
    LANES for (size_t i = 0; i < n; i++) {
        double x = px[i], y = py[i], rho = y * y;
        swept s = swept_at(c, k1, c_x, x, y, h[i], dh[i]);
        double ddz = c / (s.phi * s.phi * s.phi) + 2 * (h[i] + rho * dh[i]) + 4 * rho * ddh[i];
        double over_m = 1 / s.m, by_m = s.q * over_m, bent = c_x * over_m, across = s.t * over_m * s.dz;
        pxx[i] = bent * by_m * by_m;
        pxy[i] = bent * by_m * across;
        pyy[i] = ddz * by_m + bent * across * across;
    }
}

SGT_NARROW(void, sgt_toroidal_second,
           (const void *self, size_t n, const double *x, const double *y, double *pxx, double *pxy,
            double *pyy))
{
    toroidal_bent(self, n, x, y, pxx, pxy, pyy);
}

static size_t toroidal_parameter_count(const void *self) { (void)self; return 3 + TOROIDAL_TERMS; }

SGT_KERNEL
static void toroidal_by(const sgt_toroidal *self, size_t j, size_t n, const double *restrict px,
                        const double *restrict py, double *restrict p, double *restrict gx,
                        double *restrict gy)
{
    const double c = self->c, k1 = 1 + self->k, c_x = self->c_x, order = j < 3 ? 0 : 2 * (double)(j - 2);
    double h[DEPARTURE_BLOCK], dh[DEPARTURE_BLOCK], za[DEPARTURE_BLOCK], dza[DEPARTURE_BLOCK];
    powers_of(self, n, py, h, dh);
    /* For the profile: z_a and z_a'. */
    if (j < 2) {
        const double by_c = j == 0 ? 1 : 0, by_k = j == 0 ? 0 : 0.5 * (c * c * c);
        LANES for (size_t i = 0; i < n; i++) {
            double y = py[i], rho = y * y, v = c * y, phi = sqrt(1 - k1 * v * v), over_phi = 1 / phi,
                   over_w = 1 / (1 + phi);
            double by = by_c + by_k * rho * over_w;
            za[i] = rho * over_phi * over_w * by;
            dza[i] = y * (over_phi * over_phi * over_phi) * (by_c + by_k * rho);
        }
    } else {
        LANES for (size_t i = 0; i < n; i++) za[i] = 1;
        for (size_t m = 3; m < j; m++)
            LANES for (size_t i = 0; i < n; i++) za[i] *= py[i] * py[i];
        LANES for (size_t i = 0; i < n; i++) dza[i] = order * za[i] * py[i], za[i] *= py[i] * py[i];
    }
    if (j == 2) {
        LANES for (size_t i = 0; i < n; i++) {
            swept s = swept_at(c, k1, c_x, px[i], py[i], h[i], dh[i]);
            double over_m = 1 / s.m, cube = over_m * over_m * over_m;
            p[i] = 0.5 * (px[i] * px[i] + s.e * (s.e + 2 * s.z)) * over_m;
            gx[i] = s.q * px[i] * cube;
            gy[i] = s.dz * s.t * px[i] * cube;
        }
    } else {
        LANES for (size_t i = 0; i < n; i++) {
            swept s = swept_at(c, k1, c_x, px[i], py[i], h[i], dh[i]);
            double over_m = 1 / s.m, by_m = s.q * over_m, bent = za[i] * c_x * over_m, lean = s.t * over_m;
            p[i] = za[i] * by_m;
            gx[i] = bent * lean * by_m;
            gy[i] = dza[i] * by_m + bent * lean * lean * s.dz;
        }
    }
}

SGT_NARROW(void, sgt_toroidal_by_parameter_of,
           (const void *self, size_t j, size_t n, const double *x, const double *y, sag_values out))
{
    toroidal_by(self, j, n, x, y, out.p, out.px, out.py);
}

static sgt_objection toroidal_objection(const void *self)
{
    const sgt_toroidal *a = self;
    if (!(fabs(a->c) < HUGE_VAL)) return (sgt_objection){"curvature", "must be finite"};
    if (!(fabs(a->k) < HUGE_VAL)) return (sgt_objection){"conic", "must be finite"};
    if (!(fabs(a->c_x) < HUGE_VAL)) return (sgt_objection){"curvature_x", "must be finite"};
    if (!numbers_finite(TOROIDAL_TERMS, a->a)) return (sgt_objection){"coefficients", "must be finite"};
    return (sgt_objection){NULL, NULL};
}

static const departure toroidal_departure = {.at = toroidal_at,
                                             .rounding = toroidal_off,
                                             .bounds = toroidal_bounds,
                                             .range = sgt_toroidal_range,
                                             .second = sgt_toroidal_second,
                                             .parameters = toroidal_parameter_count,
                                             .by_parameter = sgt_toroidal_by_parameter_of,
                                             .object = toroidal_objection,
                                             .noise = sgt_toroidal_noise_about,
                                             .noise_in_box = toroidal_noise_in_box,
                                             .by_axis = toroidal_about,
                                             .ahead = sgt_toroidal_ahead};

/* The seed: a conic with both curvatures. */
static departure_sag toroidal_on_conic(const sgt_toroidal *a)
{
    double c_y = a->c + 2 * a->a[0];
    return (departure_sag){.c = 0.5 * (a->c_x + c_y),
                           .lean = 0.5 * (a->c_x - c_y),
                           .k = fabs(a->c_x) > fabs(c_y) ? 0 : a->k,
                           .semi_diameter = a->semi_diameter,
                           .of = &toroidal_departure,
                           .self = a};
}

DEPARTURE_OPS(toroidal, sgt_toroidal, toroidal_on_conic)
