// SPDX-License-Identifier: MIT
/* phase.h - what a phase does to light: an ideal thin lens here, of one power or of two; a phase in waves in
 * waves.h.
 *
 * WHAT A KIND HAS TO OFFER.  The rest of the library asks for these things, and knows nothing else of it:
 *
 *                                               ideal lens         in waves
 *     are its numbers in range?                 is_phase_sound     sgt_waves_sound
 *     the direction behind it; in batches, too  focus_by           kick_by
 *     W, the path that it adds                  phase_path         kick_path
 *     the derivatives of both (chain.h)         phase_slopes_of    waves_forward, waves_backward
 *     how far rounding puts both off            phase_off_of       sgt_waves_off       (aim_bound.c)
 *     the directions behind of a bundle         phase_forms        sgt_waves_bundle    (bundle.c)
 *
 * So another kind is a case in each of these, and in no other place.
 *
 * AN IDEAL LENS follows.
 *
 * THE DIRECTION.  With u = l / |n|, v = m / |n|, n2 u' = n1 u - x / f.  Times n2 |n| |f| that is
 *
 *     l' : m' : n' = n1 |f| l -+ |n| x : n1 |f| m -+ |n| y : n2 |f| n,    - for f > 0,
 *
 * without a quotient.  n1 |f| is kept as front + front_lo, exactly.  With u = 2^-53, the difference of
 * products with front is right to 2 u of itself, and front_lo l is added with one rounding.  So l' is off by
 * 3 u of itself and 2 u^2 n1 |f l|, however much cancels: a ray from the focal point is parallel to the axis
 * as well as its doubles say.  n' is off by 2 u of itself.  The vector is scaled by a power of two and made
 * of unit length, with one Newton step.  In all a component is off by 8 u, if |n| >= 2^-50 n1 / n2 (1.8 u is
 * the most that tests have seen).
 *
 * TWO POWERS.  f is fx in the first row and fy in the second.  The rows then have the factors |fx| and |fy|,
 * so each is taken by |f0 / f|, where f0 is the shorter of both: two roundings more, 7 u in all.  An infinite
 * f is a row without power, n1 |f0| l.  If f is one, the factors are 1, and each bit is that of the lens of
 * one power.
 *
 * THE PATH.  Let p = (x, y), w = (u, v), S(w) = sqrt(1 + w^2), and a the object's distance in front.  The
 * ray comes from q = p - a w in the object plane.  A ray from there through the vertex has w0 = w - p / a,
 * and behind n2 w0' = n1 w0.  The image is at b behind, n2 / b = 1 / f - n1 / a.  All rays from q go through
 * one point there, and w0' - w' = p / b.  The paths of the two rays are
 *
 *     n1 a S(w) + W + n2 b S(w')   and   n1 a S(w0) + n2 b S(w0').
 *
 * They are to be equal.  As a (S(w0) - S(w)) = a (w0^2 - w^2) / (S(w0) + S(w)), and a (w0 - w) = -p,
 *
 *     W = n2 p . (w' + w0') / (S(w') + S(w0')) - n1 p . (w + w0) / (S(w) + S(w0)).
 *
 * a and b are gone, but for w0: both may be infinite or negative.  From afar w0 = w, and the second term is
 * n1 p . (l, m), the path from a plane wavefront through the vertex.
 *
 * OF TWO POWERS nothing images a point, and there is no wavefront.  From afar n2 w' = n1 w - (x / fx, y /
 * fy), and the field w' / S(w') over the plane has the curl (1 / fx - 1 / fy) u' v' / (n2 S(w')^3), so it is
 * no gradient of a path.  W is the same formula, with the slopes of this lens: a convention of ours.  With p
 * in one of the two sections all above holds, as w0' - w' = p / b with the b of that section: the rays of a
 * fan through the vertex have equal paths to its line focus.  For a ray parallel to the axis W is, for every
 * p, the integral of that field along the line from the vertex to p:
 *
 *     W = -(x^2 / fx + y^2 / fy) / (1 + S(w')).
 *
 * WITHOUT CANCELLATION.  The two terms are alike where p is small.  p / f is (x / fx, y / fy) and p^2 / f the
 * product of p with it.  With n2 (w' + w0') = n1 (w + w0) - p / f and s = S(w) + S(w0), s' that behind,
 *
 *     W = n1 p . (w + w0) (s - s') / (s s') - p^2 / (f s'),
 *     S(w) - S(w')   = (w - w') . (w + w') / (S(w) + S(w')),     n2 (w - w') = (n2 - n1) w + p / f,
 *     S(w0) - S(w0') = (1 - r^2) w0^2 / (S(w0) + S(w0')),        r = n1 / n2.
 *
 * Below all of it is multiplied by c = |n|, so that nothing grows without bound at grazing incidence:
 *
 *     e = c w = (l, m), e0 = c w0, E = c w', h0 = c S(w0), H = c S(w'), H0 = c S(w0'), and c S(w) = 1.
 *
 * THE BOUND.  |e + e0| <= 1 + h0, |e + E| <= 1 + H, (1 + r) |e0| <= h0 + H0, c <= H and c <= H0.  So with
 * F = 1 / (n2 f) the parts of W are at most, p being its length,
 *
 *     n1 p c |F| p / (H + H0)             <= n1 p^2 |F| / 2
 *     n1 p |1 - r| |e| / (H + H0)         <= |n2 - n1| p (1 + p |F| / 2), as r |e| <= |E| + c |F| p
 *     n1 p |1 - r| |e0| / (H + H0)        <= |n2 - n1| p, as r |e0| <= H0
 *     n2 |F| c p^2 / (H + H0)             <= n2 p^2 |F| / 2
 *
 * with |f| the shorter one.  Together they are at most p^2 / |f| (1 + |n2 - n1| / n2) + 2 |n2 - n1| p.  Each
 * is made with some 30 roundings, of sums whose terms are bounded by the same: E is off by 2 u (|E| + 2 c |F|
 * p), which is 2 u (1 + 2 |F| p) of H.  So W is off by 64 u of
 *
 *     (p^2 / |f| (1 + |n2 - n1| / n2) + |n2 - n1| p) (1 + p / (n2 |f|)),
 *
 * counted, not proven in every step; 6.5 u is the most that tests have seen.
 *
 * THE DERIVATIVES.  With s = 1 or -1 the sign of n, dw = (dl, dm) / |n| - s w dn / |n|.  Then
 *
 *     n2 dw' = n1 dw - dp / f + w dn1 - w' dn2,   dw0 = dw - dp / a,
 *     n2 dw0' = n1 dw0 + w0 dn1 - w0' dn2.
 *
 * d' is e / |e| with e = (u', v', -+1), and |e| = 1 / |n'|.  So dd' = |n'| (de - d' (d' . de)).  Each term of
 * W is m = N / T with N = p . (w + w0) and T = S(w) + S(w0), and behind the same with a stroke:
 *
 *     W = n2 m' - n1 m,   dm = (dN - m dT) / T,   dT = w . dw / S(w) + w0 . dw0 / S(w0).
 *
 * The two terms of dW are alike where the lens is weak.  They are at most n1 and n2 times a slope (by p), or
 * p (by the direction, times |n|), and dW is off by some u of that.  It is no gradient of an eikonal: an
 * ideal lens that images one plane without aberration does not fulfil the sine condition, so no lens of any
 * shape does what it does to all rays.  Therefore W changes to first order with the direction, too.
 *
 * BUNDLES.  d' is along (r l - |n| x F, r m - |n| y F, -+n), r = n1 / n2, each F of its row.  Forms (form.h)
 * take care of all but r and F, each of which is off by 2 u.
 *
 * Test: tests/unit/test_phase.c, tests/batch/test_trace_batch.c, tests/oracle/test_phase.py (50 digits);
 * derivatives, errors and bundles: tests/sensitivity/test_ideal.cpp. */
#ifndef SGT_SYSTEM_PHASE_H
#define SGT_SYSTEM_PHASE_H

#include "waves.h"

SGT_INLINE bool is_phase_length(double a) { return fabs(a) >= 0x1p-500 && fabs(a) <= 0x1p500; }

SGT_INLINE bool is_phase_sound(const sgt_element *e)
{
    const sgt_phase *a = e->phase;
    if (!a) return true;
    if (a->kind != SGT_IDEAL_LENS) return sgt_waves_sound(a);
    if (!ROOM_IS_ZERO(a)) return false;
    const double object = fabs(a->object_distance), fx = fabs(a->focal_length), fy = fabs(a->focal_length_y);
    const bool both = fy == 0
                          ? is_phase_length(fx)
                          : (fx == HUGE_VAL || is_phase_length(fx)) &&
                                (fy == HUGE_VAL || is_phase_length(fy)) && (fx < HUGE_VAL || fy < HUGE_VAL);
    return both && (object == 0 || object == HUGE_VAL || is_phase_length(object));
}

/* The focal lengths along x and y.  Infinite: no power. */
SGT_INLINE sgt_vec2 focal_lengths(const sgt_phase *a)
{
    return (sgt_vec2){a->focal_length, a->focal_length_y == 0 ? a->focal_length : a->focal_length_y};
}

/* The shorter one, with its sign. */
SGT_INLINE double shorter_of(sgt_vec2 f) { return fabs(f.x) <= fabs(f.y) ? f.x : f.y; }

/* A row of an ideal lens: n1 |f|, the sign of f (0: infinite), |f0 / f| and f0 / f, 0 where f is infinite. */
typedef struct lens_row {
    double front, front_lo, bend, part, share;
} lens_row;

/* What is the same for all rays. */
typedef struct thin_lens {
    lens_row x, y;
    double behind;                    /* n2 |f0|, negative for a mirror */
    double n2, r, k, power, vergence; /* r = n1 / n2, k = 1 - r, power = 1 / (n2 f0), vergence = 1 / a */
} thin_lens;

SGT_INLINE lens_row lens_row_of(double n1, double f, double f0)
{
    const bool powerless = fabs(f) == HUGE_VAL;
    const twofold front = two_product(n1, fabs(powerless ? f0 : f));
    const double share = powerless ? 0 : f0 / f;
    return (lens_row){front.hi, front.lo, powerless ? 0 : copysign(1, f), powerless ? 1 : fabs(share), share};
}

/* The phase is sound. */
SGT_INLINE thin_lens thin_lens_of(const sgt_phase *a, double n1, double n2, bool mirror)
{
    const sgt_vec2 f = focal_lengths(a);
    const double f0 = shorter_of(f), size = fabs(f0), object = a->object_distance;
    return (thin_lens){.x = lens_row_of(n1, f.x, f0),
                       .y = lens_row_of(n1, f.y, f0),
                       .behind = mirror ? -n2 * size : n2 * size,
                       .n2 = n2,
                       .r = n1 / n2,
                       .k = (n2 - n1) / n2,
                       .power = 1 / (n2 * f0),
                       .vergence = object == 0 ? 0 : 1 / object};
}

/* The direction behind, and the excess it was made with. */
typedef struct focused { sgt_vec3 d; double e; } focused;

SGT_INLINE double focus_row(lens_row by, double c, double p, double d)
{
    return by.part * sgt_fma(by.front_lo, d, difference_of_products(by.front, d, by.bend * c, p));
}

SGT_INLINE focused focus_by(thin_lens by, sgt_vec3 p, sgt_vec3 d)
{
    const double c = fabs(d.z);
    sgt_vec3 v = {focus_row(by.x, c, p.x, d.x), focus_row(by.y, c, p.y, d.y), by.behind * d.z};
    v = times(scale_of(v), v);
    v = times(1 / sqrt(dot(v, v)), v);
    focused out = {v, excess(v)};
    out.d = corrected(v, out.e);
    return out;
}

/* `if_so` if there is such a direction, else 0; 0 for NaN.  Selects only, no branches. */
SGT_INLINE double where_focused(focused b, double if_so)
{
    double onward = fabs(b.d.z) > 0 ? if_so : 0;
    return fabs(b.e) <= NEAR_UNIT ? onward : 0;
}

/* W.  d: the direction in front. */
SGT_INLINE double phase_path(thin_lens by, sgt_vec3 p, sgt_vec3 d)
{
    double x = p.x, y = p.y, c = fabs(d.z), c2 = c * c, near = c * by.vergence, far = c * by.power, r = by.r;
    double qx = by.x.share * x, qy = by.y.share * y;
    double e0x = sgt_fma(-near, x, d.x), e0y = sgt_fma(-near, y, d.y), e02 = e0x * e0x + e0y * e0y;
    double Ex = sgt_fma(-far, qx, r * d.x), Ey = sgt_fma(-far, qy, r * d.y);
    double h0 = sqrt(c2 + e02), H = sqrt(c2 + (Ex * Ex + Ey * Ey)), H0 = sqrt(c2 + r * r * e02), s = H + H0;
    double bends = sgt_fma(by.k, d.x, far * qx) * (d.x + Ex) + sgt_fma(by.k, d.y, far * qy) * (d.y + Ey);
    double shorter = bends / (1 + H) + by.k * (1 + r) * e02 / (h0 + H0);
    double along = x * (d.x + e0x) + y * (d.y + e0y);
    return by.n2 * ((r * along * (shorter / (1 + h0)) - far * (qx * x + qy * y)) / s);
}

/* ------------------------------------------------------------------ derivatives */

/* Of d' (three rows) and W (the last one): by p, by d, and by the indices in front and behind. */
enum { PHASE_ROWS = 4, PHASE_PATH = 3 };
typedef struct phase_slopes {
    sgt_vec3 by_p[PHASE_ROWS], by_d[PHASE_ROWS];
    double by_n1[PHASE_ROWS], by_n2[PHASE_ROWS];
} phase_slopes;

/* A term m = N / T of W at the slopes w and w0, and its derivatives by p, by w and by w0. */
typedef struct phase_term { double m; sgt_vec2 by_p, by_w, by_w0; } phase_term;

SGT_INLINE phase_term phase_term_of(sgt_vec3 p, sgt_vec2 w, sgt_vec2 w0)
{
    const double S = sqrt(1 + w.x * w.x + w.y * w.y), S0 = sqrt(1 + w0.x * w0.x + w0.y * w0.y);
    const double by = 1 / (S + S0), x = w.x + w0.x, y = w.y + w0.y, m = (p.x * x + p.y * y) * by;
    const double at = m / S, at0 = m / S0;
    return (phase_term){m,
                        {x * by, y * by},
                        {(p.x - at * w.x) * by, (p.y - at * w.y) * by},
                        {(p.x - at0 * w0.x) * by, (p.y - at0 * w0.y) * by}};
}

/* Row i, from the derivatives g by w and h by p. */
SGT_INLINE void phase_row(phase_slopes *s, int i, sgt_vec2 g, sgt_vec2 h, sgt_vec2 w, sgt_vec3 d)
{
    const double c = 1 / fabs(d.z);
    s->by_p[i] = (sgt_vec3){h.x, h.y, 0};
    s->by_d[i] = (sgt_vec3){c * g.x, c * g.y, -(g.x * w.x + g.y * w.y) / d.z};
}

/* At p, with d in front and `after` behind. */
SGT_INLINE void phase_slopes_of(const sgt_phase *phase, double n1, double n2, sgt_vec3 p, sgt_vec3 d,
                                sgt_vec3 after, phase_slopes *s)
{
    const double object = phase->object_distance, near = object == 0 ? 0 : 1 / object;
    const sgt_vec2 length = focal_lengths(phase), power = {1 / length.x, 1 / length.y},
                   F = {power.x / n2, power.y / n2};
    const double r = n1 / n2, i2 = 1 / n2, c = 1 / fabs(d.z);
    const double n = fabs(after.z), c2 = 1 / n;
    const sgt_vec2 w = {c * d.x, c * d.y}, w0 = {w.x - near * p.x, w.y - near * p.y};
    const sgt_vec2 e = {c2 * after.x, c2 * after.y}, e0 = {r * w0.x, r * w0.y};
    const double to[3] = {after.x, after.y, after.z};
    for (int i = 0; i < PHASE_PATH; i++) {
        const double u = n * ((i == 0) - to[i] * after.x), v = n * ((i == 1) - to[i] * after.y);
        phase_row(s, i, (sgt_vec2){r * u, r * v}, (sgt_vec2){-F.x * u, -F.y * v}, w, d);
        s->by_n1[i] = i2 * (u * w.x + v * w.y), s->by_n2[i] = -i2 * (u * e.x + v * e.y);
    }
    const phase_term front = phase_term_of(p, w, w0), behind = phase_term_of(p, e, e0);
    const sgt_vec2 f = front.by_w, f0 = front.by_w0, b = behind.by_w, b0 = behind.by_w0;
    const double vergence = n1 * near;
    phase_row(s, PHASE_PATH, (sgt_vec2){n1 * (b.x + b0.x - f.x - f0.x), n1 * (b.y + b0.y - f.y - f0.y)},
              (sgt_vec2){n2 * behind.by_p.x - n1 * front.by_p.x - power.x * b.x - vergence * (b0.x - f0.x),
                         n2 * behind.by_p.y - n1 * front.by_p.y - power.y * b.y - vergence * (b0.y - f0.y)},
              w, d);
    s->by_n1[PHASE_PATH] = b.x * w.x + b.y * w.y + b0.x * w0.x + b0.y * w0.y - front.m;
    s->by_n2[PHASE_PATH] = behind.m - (b.x * e.x + b.y * e.y + b0.x * e0.x + b0.y * e0.y);
}

/* The numbers of an ideal lens, in this order; and the derivatives of d' and W by them.  With n2 w' = n1 w -
 * p / f a focal length moves n2 w' by p / f^2, in its row; one that is given once moves both rows.  The
 * object distance a moves w0 by p / a^2, and n2 w0' by n1 times that. */
enum { LENS_BY_X, LENS_BY_Y, LENS_BY_OBJECT, LENS_NUMBERS };

SGT_INLINE void phase_by_numbers(const sgt_phase *phase, double n1, double n2, sgt_vec3 p, sgt_vec3 d,
                                 sgt_vec3 after, double by[LENS_NUMBERS][PHASE_ROWS])
{
    const double object = phase->object_distance, near = object == 0 ? 0 : 1 / object;
    const sgt_vec2 f = focal_lengths(phase), more = {p.x / f.x / f.x, p.y / f.y / f.y};
    const double r = n1 / n2, c = 1 / fabs(d.z), n = fabs(after.z), c2 = 1 / n;
    const sgt_vec2 w = {c * d.x, c * d.y}, w0 = {w.x - near * p.x, w.y - near * p.y};
    const sgt_vec2 e = {c2 * after.x, c2 * after.y}, e0 = {r * w0.x, r * w0.y};
    const double to[3] = {after.x, after.y, after.z};
    const phase_term front = phase_term_of(p, w, w0), behind = phase_term_of(p, e, e0);
    const sgt_vec2 f0 = front.by_w0, b = behind.by_w, b0 = behind.by_w0;
    for (int i = 0; i < PHASE_PATH; i++) {
        by[LENS_BY_X][i] = n / n2 * ((i == 0) - to[i] * after.x) * more.x;
        by[LENS_BY_Y][i] = n / n2 * ((i == 1) - to[i] * after.y) * more.y;
        by[LENS_BY_OBJECT][i] = 0;
    }
    by[LENS_BY_X][PHASE_PATH] = b.x * more.x, by[LENS_BY_Y][PHASE_PATH] = b.y * more.y;
    by[LENS_BY_OBJECT][PHASE_PATH] = n1 * near * near * ((b0.x - f0.x) * p.x + (b0.y - f0.y) * p.y);
    for (int i = 0; i < PHASE_ROWS && phase->focal_length_y == 0; i++)
        by[LENS_BY_X][i] += by[LENS_BY_Y][i], by[LENS_BY_Y][i] = 0;
}

/* ----------------------------------------------------------------------- errors */

/* How far rounding puts a component of the direction behind off, and W, where p and d are as they stand. */
typedef struct phase_off { double direction, path; } phase_off;

SGT_INLINE phase_off phase_off_of(const sgt_phase *phase, double n1, double n2, sgt_vec3 p, sgt_vec3 d)
{
    const double f = fabs(shorter_of(focal_lengths(phase))), by = sqrt(p.x * p.x + p.y * p.y),
                 change = fabs(n2 - n1);
    const double size = (by * (by / f) * (1 + change / n2) + change * by) * (1 + by / (n2 * f));
    return (phase_off){fabs(d.z) >= 0x1p-50 * n1 / n2 ? 8 * SGT_U : HUGE_VAL, 64 * SGT_U * size};
}

/* ---------------------------------------------------------------------- bundles */

/* *d becomes a vector along the directions behind, of any length.  false: nothing is known of so large a
 * part. */
SGT_INLINE bool phase_forms(const sgt_phase *phase, double n1, double n2, bool mirror, form3 p, form3 *d)
{
    const sgt_vec2 f = focal_lengths(phase);
    const double r = n1 / n2, Fx = 1 / (n2 * f.x), Fy = 1 / (n2 * f.y), least = 0x1p-48 * larger(1, r);
    const linear ratio = {r, 0, 0, 4 * SGT_U * r};
    const linear to_x = {Fx, 0, 0, 4 * SGT_U * fabs(Fx)}, to_y = {Fy, 0, 0, 4 * SGT_U * fabs(Fy)};
    if (!form_above(d->z, least) && !form_below(d->z, -least)) return false; /* along it, or both ways */
    const linear n = form_above(d->z, least) ? d->z : form_negative(d->z);
    d->x = form_difference(form_product(ratio, d->x), form_product(form_product(n, to_x), p.x));
    d->y = form_difference(form_product(ratio, d->y), form_product(form_product(n, to_y), p.y));
    if (mirror) d->z = form_negative(d->z);
    return true;
}

#endif
