/* phase.h - an ideal thin lens: the direction behind it, and the path that it adds.
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
 * WITHOUT CANCELLATION.  The two terms are alike where p is small.  With n2 (w' + w0') = n1 (w + w0) - p / f
 * and s = S(w) + S(w0), s' that behind,
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
 * Together they are at most p^2 / |f| (1 + |n2 - n1| / n2) + 2 |n2 - n1| p.  Each is made with some 30
 * roundings, of sums whose terms are bounded by the same: E is off by 2 u (|E| + 2 c |F| p), which is
 * 2 u (1 + 2 |F| p) of H.  So W is off by 64 u of
 *
 *     (p^2 / |f| (1 + |n2 - n1| / n2) + |n2 - n1| p) (1 + p / (n2 |f|)),
 *
 * counted, not proven in every step; 6.5 u is the most that tests have seen.
 *
 * Test: tests/unit/test_phase.c, tests/batch/test_trace_batch.c, tests/oracle/test_phase.py (50 digits). */
#ifndef SGT_SYSTEM_PHASE_H
#define SGT_SYSTEM_PHASE_H

#include "trace.h"

SGT_INLINE bool is_phase_length(double a) { return fabs(a) >= 0x1p-500 && fabs(a) <= 0x1p500; }

SGT_INLINE bool is_phase_sound(const sgt_element *e)
{
    const sgt_phase *a = e->phase;
    if (!a) return true;
    const unsigned long long *r = a->reserved_;
    if (a->kind != SGT_IDEAL_LENS || (r[0] | r[1] | r[2] | r[3] | r[4] | r[5])) return false;
    double object = fabs(a->object_distance);
    return is_phase_length(a->focal_length) && (object == 0 || object == HUGE_VAL || is_phase_length(object));
}

/* What is the same for all rays. */
typedef struct thin_lens {
    double front, front_lo;      /* n1 |f| */
    double behind, bend;         /* n2 |f|, negative for a mirror; the sign of f */
    double n2, r, k, power, vergence; /* r = n1 / n2, k = 1 - r, power = 1 / (n2 f), vergence = 1 / a */
} thin_lens;

/* The phase is sound. */
SGT_INLINE thin_lens thin_lens_of(const sgt_phase *a, double n1, double n2, bool mirror)
{
    double f = a->focal_length, size = fabs(f), object = a->object_distance;
    twofold front = two_product(n1, size);
    return (thin_lens){.front = front.hi, .front_lo = front.lo,
                       .behind = mirror ? -n2 * size : n2 * size, .bend = copysign(1, f), .n2 = n2,
                       .r = n1 / n2, .k = (n2 - n1) / n2, .power = 1 / (n2 * f),
                       .vergence = object == 0 ? 0 : 1 / object};
}

/* The direction behind, and the excess it was made with. */
typedef struct focused { sgt_vec3 d; double e; } focused;

SGT_INLINE focused focus_by(thin_lens by, sgt_vec3 p, sgt_vec3 d)
{
    double c = by.bend * fabs(d.z);
    sgt_vec3 v = {sgt_fma(by.front_lo, d.x, difference_of_products(by.front, d.x, c, p.x)),
                  sgt_fma(by.front_lo, d.y, difference_of_products(by.front, d.y, c, p.y)), by.behind * d.z};
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
    double e0x = sgt_fma(-near, x, d.x), e0y = sgt_fma(-near, y, d.y), e02 = e0x * e0x + e0y * e0y;
    double Ex = sgt_fma(-far, x, r * d.x), Ey = sgt_fma(-far, y, r * d.y);
    double h0 = sqrt(c2 + e02), H = sqrt(c2 + (Ex * Ex + Ey * Ey)), H0 = sqrt(c2 + r * r * e02), s = H + H0;
    double bends = sgt_fma(by.k, d.x, far * x) * (d.x + Ex) + sgt_fma(by.k, d.y, far * y) * (d.y + Ey);
    double shorter = bends / (1 + H) + by.k * (1 + r) * e02 / (h0 + H0);
    double along = x * (d.x + e0x) + y * (d.y + e0y);
    return by.n2 * ((r * along * (shorter / (1 + h0)) - far * (x * x + y * y)) / s);
}

#endif
