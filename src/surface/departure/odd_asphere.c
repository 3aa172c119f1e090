// SPDX-License-Identifier: MIT
/* odd_asphere.c - P = sum of a[i] r^(i+1): odd and even powers of the distance from the axis.
 *
 * a[0] r is a cone, and P is split at its tip.  With h(r) = sum over i > 0 of a[i] r^(i-1),
 *     P = r (a[0] + r h),    grad P = (x, y) G,    G = P'/r = a[0]/r + 2 h + r h'.
 * All but a[0]/r is smooth at r = 0.  There a[0]/r is omitted: (0, 0) is the mean of the cone's gradients.
 * The second derivative is P'' along the radius and G across it: pxx = G + (x/r)^2 (P'' - G), pxy = (x y /
 * r^2) (P'' - G), with P'' - G = -a[0]/r + r (3 h' + r h'').  Its norm is the greater of |P''| and |G|.
 * At the tip of a cone there is none: NaN.
 *
 * ROUNDING.  h and its derivatives are computed by Horner's rule, each step one fma.  That is stable: a
 * step rounds by at most u of its result, and this enters the sum multiplied only by the powers of r
 * behind it.  The bound follows the same steps (Higham 2002, section 5.1).  r is off by 2 u r: 2 u in r^2,
 * halved by the root, and u of the root.  This moves P by 2 u r |P'|, and G by 2 u |P'' - G|.  For the
 * latter the sum of the magnitudes of its terms is taken.
 *
 * BOUNDS.  Each term is monotone in r >= 0.  So the rising terms at one end and the falling terms at the
 * other bound the sum. */
#include "radial.h"

enum { ODD_TERMS = 16 };

/* The number of terms without the zeros at the end. */
static int odd_terms_of(const double *a)
{
    int terms = ODD_TERMS;
    while (terms > 0 && a[terms - 1] == 0) terms--;
    return terms;
}

SGT_INLINE double radius(double x, double y) { return sqrt(x * x + y * y); }

/* a / r, and 0 at the tip. */
SGT_INLINE double by_radius(double a, double r) { return chosen(MASK(r > 0), a / r, 0); }

/* MOST terms or fewer; a cone has a[0]. */
SGT_INLINE void odd_of(size_t n, int most, bool cone, const double *given, const double *restrict x,
                       const double *restrict y, sag_values out)
{
    double *restrict p = out.p, *restrict px = out.px, *restrict py = out.py;
    double a[ODD_TERMS];
    for (int k = 0; k < ODD_TERMS; k++) a[k] = given[k];
    LANES for (size_t i = 0; i < n; i++) {
        double r = radius(x[i], y[i]), h = 0, dh = 0;
        UNROLLED
        for (int k = most - 1; k > 0; k--) dh = sgt_fma(dh, r, h), h = sgt_fma(h, r, a[k]);
        double tip = cone ? by_radius(a[0], r) : chosen(MASK(r > 0), a[0], 0);
        double G = tip + sgt_fma(r, dh, h + h);
        p[i] = r * sgt_fma(r, h, a[0]);
        px[i] = x[i] * G, py[i] = y[i] * G;
    }
}

/* Terms that are zero, and what a[0] = 0 divided by r is, are the same bits with more or fewer of them.  For
 * a single point the compiler removes the loop. */
SGT_INLINE void odd_in(size_t n, int terms, const double *a, const double *x, const double *y, sag_values out)
{
    if (a[0] != 0) odd_of(n, ODD_TERMS, true, a, x, y, out);
    else if (terms <= 6) odd_of(n, 6, false, a, x, y, out);
    else if (terms <= 10) odd_of(n, 10, false, a, x, y, out);
    else odd_of(n, ODD_TERMS, false, a, x, y, out);
}

SGT_KERNEL
static void odd_at(size_t n, int terms, const double *a, const double *x, const double *y, sag_values out)
{
    if (n == 1) odd_in(1, terms, a, x, y, out);
    else odd_in(n, terms, a, x, y, out);
}

static void odd_sag(const void *self, size_t n, const double *x, const double *y, sag_values out)
{
    const sgt_odd_asphere *s = self;
    odd_at(n, odd_terms_of(s->a), s->a, x, y, out);
}

SGT_INLINE double odd_rounded(double x) { return SGT_U * fabs(x) + 0x1p-1074; }

/* Without fma, which may be a function call.  The numbers differ from those of odd_at by at most their
 * errors.  That changes the bound by u times as much. */
static void odd_rounding(const void *self, double x, double y, double *p_err, double *grad_err)
{
    const double *a = ((const sgt_odd_asphere *)self)->a;
    double r = radius(x, y), h = 0, dh = 0, h_err = 0, dh_err = 0, bent = 0, sum = fabs(a[0]);
    int terms = odd_terms_of(a);
    for (int k = terms - 1; k > 0; k--) {
        dh = dh * r + h;
        dh_err = dh_err * r + h_err + odd_rounded(dh);
        h = h * r + a[k];
        h_err = h_err * r + odd_rounded(h);
        bent = bent * r + (k + 1) * (k - 1) * fabs(a[k]);
        sum += fabs(a[k]);
    }
    double tip = by_radius(a[0], r), smooth = r * dh + (h + h), G = tip + smooth, inner = r * h + a[0],
           far = larger(fabs(x), fabs(y));
    double G_err = odd_rounded(tip) + (r * dh_err + 2 * h_err) + odd_rounded(smooth) + odd_rounded(G);
    *p_err = 1.01 * (r * (r * h_err + odd_rounded(inner) + 2 * SGT_U * r * (fabs(G) + G_err)) +
                     odd_rounded(r * inner));
    *grad_err = 1.01 * (far * (G_err + 2 * SGT_U * (fabs(tip) + bent)) + odd_rounded(far * G));
    /* Squares underflow. */
    if (terms > 0 && r < 0x1p-480) *p_err += 0x1p-470 * sum, *grad_err += 3 * fabs(a[0]) + 0x1p-470 * sum;
}

/* A term is rounded i times in h and twice after it, and carries the 2 u of r i + 1 times. */
SGT_INLINE void odd_noises_of(size_t n, int most, const double *a, const double *restrict radius,
                              double *restrict e0, double *restrict e1)
{
    double weight[ODD_TERMS], tip = fabs(a[0]);
    for (int k = 0; k < ODD_TERMS; k++) weight[k] = (3 * k + 4) * fabs(a[k]);
    LANES for (size_t i = 0; i < n; i++) {
        double r = radius[i], sum = 0;
        UNROLLED
        for (int k = most - 1; k > 0; k--) sum = sum * r + weight[k];
        e0[i] = 1.01 * SGT_U * 4 * tip * r + 0x1p-470 * tip;
        e1[i] = 1.01 * SGT_U * sum;
    }
}

SGT_KERNEL
static void odd_noises_at(size_t n, int terms, const double *a, const double *radius, double *e0, double *e1)
{
    if (terms <= 10) odd_noises_of(n, 10, a, radius, e0, e1);
    else odd_noises_of(n, ODD_TERMS, a, radius, e0, e1);
}

static void odd_noises(const void *self, size_t n, const double *radius, double *e0, double *e1)
{
    const double *a = ((const sgt_odd_asphere *)self)->a;
    odd_noises_at(n, odd_terms_of(a), a, radius, e0, e1);
}

static void odd_noise(const void *self, double radius, double e[2])
{
    const double *a = ((const sgt_odd_asphere *)self)->a;
    odd_noises_of(1, odd_terms_of(a), a, &radius, &e[0], &e[1]);
}

/* The least and the greatest value of a sum of monotone terms, and the sum of their magnitudes. */
typedef struct odd_range { double lo, hi, size; } odd_range;

/* Adds a times a number in [lo, hi], hi >= lo >= 0.  lost: a number below TINY has lost digits to
 * underflow, and is taken as lying between 0 and TINY. */
SGT_INLINE void odd_add(odd_range *sum, double a, double lo, double hi, bool lost)
{
    if (a == 0) return; /* hi may be infinite */
    if (lost && lo < TINY) lo = 0;
    if (lost && hi < TINY) hi = TINY;
    sum->lo += a * (a > 0 ? lo : hi);
    sum->hi += a * (a > 0 ? hi : lo);
    sum->size += fabs(a) * larger(lo, hi);
}

/* Each end is off by less than 2^-46 of the magnitudes. */
static double odd_greatest(odd_range e)
{
    double most = larger(-e.lo, e.hi) + 0x1p-40 * e.size;
    return most < HUGE_VAL ? most : HUGE_VAL;
}

SGT_INLINE bounds sums_over(const double *a, int terms, double lo, double hi, bool lost)
{
    double lo_power = 1, hi_power = 1; /* r^(i-1) */
    odd_range size = {0}, steep = {0}, bend = {0}, across = {0};
    odd_add(&size, a[0], lo, hi, lost);
    odd_add(&steep, a[0], 1, 1, lost);
    if (a[0] != 0) odd_add(&across, a[0], 1 / hi, 1 / lo, lost);
    for (int i = 1; i < terms; i++, lo_power *= lo, hi_power *= hi) {
        odd_add(&bend, i * (i + 1) * a[i], lo_power, hi_power, lost);
        odd_add(&across, (i + 1) * a[i], lo_power, hi_power, lost);
        odd_add(&steep, (i + 1) * a[i], lo_power * lo, hi_power * hi, lost);
        odd_add(&size, a[i], lo_power * lo * lo, hi_power * hi * hi, lost);
    }
    return (bounds){odd_greatest(size), odd_greatest(steep),
                    larger(odd_greatest(bend), odd_greatest(across))};
}

static bounds sums_of_lost(const double *a, int terms, double lo, double hi)
{
    return sums_over(a, terms, lo, hi, true);
}

/* The highest power is r^terms.  It is above TINY if r is above 2^-60. */
static int odd_bounds_over(const void *self, region *where, bounds *out)
{
    const double *a = ((const sgt_odd_asphere *)self)->a;
    double lo = where->r_lo, hi = where->r_hi, deep = 0x1p-60;
    int terms = odd_terms_of(a);
    bool lost = hi < deep || (lo > 0 && lo < deep);
    *out = lost ? sums_of_lost(a, terms, lo, hi) : sums_over(a, terms, lo, hi, false);
    return 1;
}

/* Of a power that underflows, what is left out is below 2^-1000. */
static double odd_tail(const void *self, double radius)
{
    const double *a = ((const sgt_odd_asphere *)self)->a;
    double power[ODD_TERMS], r = 1;
    size_t terms = (size_t)odd_terms_of(a);
    if (!(radius > 0x1p-60)) return 0;
    for (size_t m = 0; m < terms; m++) power[m] = r *= radius;
    return radial_tail(power, 1, terms, a, NULL, false);
}

/* The least of the radii, but for factors of two, at which |a[i]| r^(i+1) is `times` r. */
static double odd_reach(const double *a, size_t terms, int times)
{
    double least = HUGE_VAL;
    for (size_t i = 1; i < terms; i++) {
        if (a[i] == 0) continue;
        int n = times - binary_exponent(a[i]), k = (int)i;
        double r = power_of_two(n >= 0 ? n / k : -((k - 1 - n) / k));
        least = r < least ? r : least;
    }
    return least;
}

static bool odd_profile(const void *self, sgt_profile *out)
{
    const double *a = ((const sgt_odd_asphere *)self)->a;
    const size_t terms = (size_t)odd_terms_of(a);
    if (terms < 3) return false;
    *out = (sgt_profile){.terms = terms + 1, .core = odd_reach(a, terms, -6), .from = odd_reach(a, terms, 4)};
    for (size_t i = 0; i < terms; i++) out->c[i + 1] = a[i], out->size[i + 1] = fabs(a[i]);
    return out->core > 0x1p-300 && out->from < 0x1p300;
}

SGT_KERNEL
static void odd_second(size_t n, int terms, const double *a, const double *restrict x,
                       const double *restrict y, double *restrict pxx, double *restrict pxy,
                       double *restrict pyy)
{
    double r[DEPARTURE_BLOCK], h[DEPARTURE_BLOCK], dh[DEPARTURE_BLOCK], half_ddh[DEPARTURE_BLOCK], tip = a[0];
    LANES for (size_t i = 0; i < n; i++) r[i] = radius(x[i], y[i]), h[i] = dh[i] = half_ddh[i] = 0;
    for (int k = terms - 1; k > 0; k--) {
        double next = a[k];
        LANES for (size_t i = 0; i < n; i++) {
            half_ddh[i] = sgt_fma(half_ddh[i], r[i], dh[i]);
            dh[i] = sgt_fma(dh[i], r[i], h[i]);
            h[i] = sgt_fma(h[i], r[i], next);
        }
    }
    LANES for (size_t i = 0; i < n; i++) {
        double cone = tip != 0 ? tip / r[i] : 0, G = cone + sgt_fma(r[i], dh[i], h[i] + h[i]);
        double along = r[i] * sgt_fma(3, dh[i], 2 * r[i] * half_ddh[i]) - cone; /* P'' - G */
        double cosine = by_radius(x[i], r[i]), sine = by_radius(y[i], r[i]);
        pxx[i] = sgt_fma(cosine * cosine, along, G);
        pxy[i] = cosine * sine * along;
        pyy[i] = sgt_fma(sine * sine, along, G);
    }
}

SGT_NARROW(void, sgt_odd_bend,
           (const void *self, size_t n, const double *x, const double *y, double *pxx, double *pxy,
            double *pyy))
{
    const sgt_odd_asphere *s = self;
    odd_second(n, odd_terms_of(s->a), s->a, x, y, pxx, pxy, pyy);
}

static size_t odd_parameters(const void *self)
{
    (void)self;
    return ODD_TERMS;
}

/* r^(j+1), and its gradient (j + 1) r^(j-1) (x, y). */
SGT_KERNEL
static void odd_power(size_t j, size_t n, const double *restrict x, const double *restrict y,
                      double *restrict p, double *restrict px, double *restrict py)
{
    double r[DEPARTURE_BLOCK], q[DEPARTURE_BLOCK], times = (double)j + 1;
    LANES for (size_t i = 0; i < n; i++) r[i] = radius(x[i], y[i]),
                                         q[i] = chosen(MASK(j > 0), 1, by_radius(1, r[i]));
    for (size_t k = 1; k < j; k++)
        LANES for (size_t i = 0; i < n; i++) q[i] *= r[i];
    LANES for (size_t i = 0; i < n; i++) {
        p[i] = q[i] * r[i] * r[i];
        px[i] = times * q[i] * x[i], py[i] = times * q[i] * y[i];
    }
}

SGT_NARROW(void, sgt_odd_by_parameter,
           (const void *self, size_t j, size_t n, const double *x, const double *y, sag_values out))
{
    (void)self;
    odd_power(j, n, x, y, out.p, out.px, out.py);
}

static sgt_objection odd_object(const void *self)
{
    return numbers_finite(ODD_TERMS, ((const sgt_odd_asphere *)self)->a)
               ? (sgt_objection){NULL, NULL}
               : (sgt_objection){"coefficients", "must be finite"};
}

static const departure odd_asphere_departure = {
    .at = odd_sag, .rounding = odd_rounding, .bounds = odd_bounds_over, .second = sgt_odd_bend,
    .parameters = odd_parameters, .by_parameter = sgt_odd_by_parameter, .object = odd_object,
    .noise = odd_noise,
    .noises = odd_noises, .tail = odd_tail, .profile = odd_profile,
    .heights_first = true};

DEPARTURE_ON_CONIC(odd_asphere, sgt_odd_asphere)
