/* bundle_sag.c - a bundle of lines meets an even asphere.
 *
 * On a line (x, y, 0) + t d the root of F = z - S(r^2), S = s + P the sag of surfaces.h, is searched for all
 * lines at once, within r <= L.
 *
 *   1. z of a root is one of S(r^2), r <= L: so t is in a first interval T.
 *   2. T is cut into PIECES.  On each, r^2 of all lines is in an interval, S in another, and t in that over
 * dz. What is left of the pieces is the new T; some ROUNDS of that.  If nothing is left, no line meets it.
 *   3. Newton's step for intervals (Moore 1966, Interval Analysis, chapter 7): if the slope dF/dt has one
 * sign on T for all lines, with m in T, t = m - F(m) / slope.  F(m) is a form, and so then is t.  If its
 * range is inside of T, each line has a root there.  T is cut down to it.
 *
 * WHICH ROOT.  sgt_trace looks for the root near the seed.  If that is outside the aperture and another
 * inside, it takes the other; roots beyond the rim are none.  So:
 *
 *     L = least of aperture, rim, edge   if each line has a root within L, and just one, it is the one
 *     L = lesser of rim and edge         else: every root there is, is within L, and thus in T
 *
 * The edge is that of the conic base.  If there is neither rim nor edge, lines that are not certainly within
 * the aperture are UNKNOWN. */
#include "bundle.h"

enum { PIECES = 8, ROUNDS = 3, STEPS = 2, TERMS = 8 };

/* All over some interval of r^2: S, dS/d(r^2), and is it certainly defined? */
typedef struct sag_range {
    sgt_interval sag, slope;
    bool defined;
} sag_range;

static sag_range sag_over(const sgt_asphere *s, sgt_interval rho)
{
    sgt_interval c = sgt_interval_of(s->c), k1 = sgt_interval_sum(sgt_interval_of(1), sgt_interval_of(s->k));
    sgt_interval one = sgt_interval_of(1), bend = sgt_interval_product(sgt_interval_product(c, k1), c);
    sgt_interval phi2 = sgt_interval_difference(one, sgt_interval_product(bend, rho));
    sgt_interval phi = sgt_interval_square_root(phi2);
    sgt_interval base = sgt_interval_quotient(sgt_interval_product(c, rho), sgt_interval_sum(one, phi));
    sgt_interval sum = sgt_interval_of(0), slope = sum;
    for (int i = TERMS - 1; i >= 0; i--) {
        sgt_interval a = sgt_interval_of(s->a[i]);
        slope = sgt_interval_sum(sgt_interval_product(slope, rho), sgt_interval_scaled(a, i + 1));
        sum = sgt_interval_product(sgt_interval_sum(sum, a), rho);
    }
    sgt_interval steep = sgt_interval_quotient(sgt_interval_scaled(c, 0.5), phi);
    return (sag_range){sgt_interval_sum(base, sum), sgt_interval_sum(steep, slope), phi2.lo > 0};
}

/* The same of a form: S, and dS/d(r^2). */
static linear sag_form(const sgt_asphere *s, linear rho, linear *slope)
{
    linear k1 = form_plus(form_of(s->k), 1), bend = form_scaled(form_scaled(k1, s->c), s->c);
    linear phi = form_root(form_plus(form_negative(form_product(bend, rho)), 1));
    linear base = form_quotient(form_scaled(rho, s->c), form_plus(phi, 1)), sum = form_of(0);
    *slope = sum;
    for (int i = TERMS - 1; i >= 0; i--) {
        if (s->a[i] == 0 && form_size(sum) == 0) continue;
        *slope = form_sum(form_product(*slope, rho), form_scaled(form_of(s->a[i]), i + 1));
        sum = form_product(form_plus(sum, s->a[i]), rho);
    }
    *slope = form_sum(*slope, form_quotient(form_of(0.5 * s->c), phi));
    return form_sum(base, sum);
}

/* The ranges of the lines. */
typedef struct line_ranges {
    sgt_interval x, y, dx, dy, dz;
} line_ranges;

static sgt_interval rho_over(const line_ranges *w, sgt_interval t)
{
    sgt_interval x = sgt_interval_sum(w->x, sgt_interval_product(t, w->dx)),
                 y = sgt_interval_sum(w->y, sgt_interval_product(t, w->dy));
    return sgt_interval_sum(sgt_interval_square(x), sgt_interval_square(y));
}

/* Steps 1 and 2: all roots with r^2 <= L2 are in the answer. */
static sgt_interval sag_hull(const sgt_asphere *s, const line_ranges *w, double L2)
{
    const sgt_interval within = {0, L2};
    sgt_interval t = sgt_interval_quotient(sag_over(s, within).sag, w->dz);
    for (int round = 0; round < ROUNDS && t.lo <= t.hi && sgt_interval_width(t) < HUGE_VAL; round++) {
        sgt_interval left = sgt_interval_empty();
        double wide = (t.hi - t.lo) / PIECES;
        for (int i = 0; i < PIECES; i++) {
            sgt_interval piece = {i == 0 ? t.lo : t.lo + i * wide,
                                  i + 1 == PIECES ? t.hi : t.lo + (i + 1) * wide};
            sgt_interval rho = sgt_interval_intersection(rho_over(w, piece), within);
            if (sgt_interval_is_empty(rho)) continue;
            sgt_interval at = sgt_interval_quotient(sag_over(s, rho).sag, w->dz);
            left = sgt_interval_hull(left, sgt_interval_intersection(piece, at));
        }
        t = left;
    }
    return t;
}

/* Step 3.  GONE: no root in *t.  THERE: *root contains all; *exists: each line has one. */
static bundle_fate sag_newton(const sgt_asphere *s, const bundle_lines *w, const line_ranges *range,
                              sgt_interval t, linear *root, double *sign, bool *exists)
{
    sgt_interval flat = sgt_interval_sum(sgt_interval_square(range->dx), sgt_interval_square(range->dy));
    sgt_interval outward = form_range(form_sum(form_product(w->x, w->d.x), form_product(w->y, w->d.y)));
    *exists = false;
    for (int i = 0; i < STEPS; i++) {
        double m = sgt_interval_middle(t);
        sag_range all = sag_over(s, rho_over(range, t));
        sgt_interval half = sgt_interval_sum(outward, sgt_interval_product(t, flat));
        sgt_interval by = sgt_interval_scaled(sgt_interval_product(half, all.slope), 2);
        sgt_interval slope = sgt_interval_difference(range->dz, by);
        bool up = sgt_interval_is_positive(slope), down = sgt_interval_is_negative(slope);
        if (!all.defined || !(up || down)) return BUNDLE_UNKNOWN;
        linear x = form_sum(w->x, form_scaled(w->d.x, m)), y = form_sum(w->y, form_scaled(w->d.y, m)), steep;
        linear F = form_difference(form_scaled(w->d.z, m),
                                   sag_form(s, form_sum(form_square(x), form_square(y)), &steep));
        sgt_interval inverse = sgt_interval_quotient(sgt_interval_of(1), slope);
        *root = form_sum(form_of(m), form_negative(form_product(F, form_between(inverse))));
        sgt_interval next = form_range(*root);
        if (!(next.hi - next.lo < HUGE_VAL)) return BUNDLE_UNKNOWN;
        *exists = *exists || (next.lo > t.lo && next.hi < t.hi);
        t = sgt_interval_intersection(t, next);
        if (sgt_interval_is_empty(t)) return BUNDLE_GONE;
        *sign = up ? 1 : -1;
    }
    return BUNDLE_THERE;
}

static void sag_hit(const sgt_asphere *s, const bundle_lines *w, linear t, double sign, bundle_hit *h)
{
    linear x = form_sum(w->x, form_product(t, w->d.x)), y = form_sum(w->y, form_product(t, w->d.y)), steep;
    linear rho = form_sum(form_square(x), form_square(y));
    (void)sag_form(s, rho, &steep);
    linear by = form_scaled(steep, -2);
    h->p = (form3){x, y, form_product(t, w->d.z)};
    h->n = (form3){form_product(by, x), form_product(by, y), form_of(1)};
    h->size2 = form_plus(form_product(form_square(by), rho), 1);
    h->slope = form_dot(h->n, w->d), h->sign = sign;
}

bundle_fate sgt_bundle_sag(const sgt_asphere *s, double aperture, const bundle_lines *w, bundle_hit *h)
{
    static const double MORE = 1 + 0x1p-40;
    const double rim = is_open(s->semi_diameter) ? HUGE_VAL : s->semi_diameter, k1 = 1 + s->k;
    const double edge = k1 > 0 && s->c != 0 ? 1 / (fabs(s->c) * sqrt(k1)) : HUGE_VAL;
    const double most = rim < edge ? rim : edge, least = aperture < most ? aperture : most;
    bool bare = true;
    for (int i = 0; i < TERMS; i++) bare = bare && s->a[i] == 0;
    if (bare) return sgt_bundle_conic(s->c, s->k, rim, aperture, w, h);
    const line_ranges range = {form_range(w->x), form_range(w->y), form_range(w->d.x), form_range(w->d.y),
                               form_range(w->d.z)};
    linear t;
    double sign;
    bool exists;
    if (!(least < 0x1p400)) return BUNDLE_UNKNOWN;
    sgt_interval hull = least < most ? sag_hull(s, &range, least * least * MORE) : sgt_interval_empty();
    if (!sgt_interval_is_empty(hull) && sag_newton(s, w, &range, hull, &t, &sign, &exists) == BUNDLE_THERE &&
        exists) {
        sag_hit(s, w, t, sign, h);
        linear r2 = form_sum(form_square(h->p.x), form_square(h->p.y));
        if (form_range(r2).hi < least * least * (2 - MORE)) return BUNDLE_THERE;
    }
    if (!(most < 0x1p400)) return BUNDLE_UNKNOWN;
    hull = sag_hull(s, &range, most * most * MORE);
    if (sgt_interval_is_empty(hull)) return BUNDLE_GONE;
    bundle_fate fate = sag_newton(s, w, &range, hull, &t, &sign, &exists);
    if (fate == BUNDLE_THERE) sag_hit(s, w, t, sign, h);
    return fate;
}
