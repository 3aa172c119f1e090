// SPDX-License-Identifier: MIT
/* value.c - F of a level set at a point: its value and gradient, its rounding, and the potential.
 *
 * F = (u - 1) / (u + 1) with u = |Q_N|^2 / E^2.  It has the roots of |Q_N|^2 - E^2, which overflows at N =
 * 12.
 *
 * THE GRADIENT is 4 E^2 / (|Q_N|^2 + E^2)^2 times that of |Q_N|^2 / 2.  The latter is T^T Q_N, with the
 * Jacobian tensor T = dQ_N/dp = J(Q_{N-1}) ... J(Q_0) [ex ey ez].  The product is taken from the left: y_N
 * = Q_N, y_k = J(Q_k)^T y_{k+1}.  That is one quaternion on the way back in place of three columns on the
 * way forward.  Then grad = (<ex, y_0>, <ey, y_0>, <ez, y_0>).
 *
 * J(Q) x = sum of Q^i x Q^(p-1-i).  Since <y, a x b> = <conj(a) y conj(b), x>, its transpose is
 * J(conj(Q)), the same formula.  In the Mandelbrot set each level adds c, whose derivative is the
 * identity.  So y_0 is replaced by y_N + ... + y_1.
 *     The way back needs every Q_k.  With more levels than are kept here the columns of T go forward, one
 * axis after another.  The gradient is NaN if they overflow.
 *
 * ROUNDING.  |Q_N| is off by at most e, the recursion of orbit.h with h = 0, and F is monotone in |Q_N|. */
#include "../../num/elementary.h"
#include "course.h"
#include "level.h"

enum { FAR_LEVELS = 200 }; /* of the potential, if N is not above it */

static quaternion next_of(const orbit *o, quaternion q, quaternion c)
{
    power_of r = power_only(q, o->power);
    return (quaternion){r.s + c.a, r.f * q.b + c.b, r.f * q.c + c.c, r.f * q.d + c.d};
}

/* Q at every level: at[first] ... at[return value].  It stops where |Q|^2 >= most, or at level `last`. */
static int levels_of(const orbit *o, sgt_vec3 p, int last, double most, quaternion at[])
{
    quaternion q = quaternion_at(o, p.x, p.y, p.z), c = o->mandelbrot ? q : o->c;
    int k = o->mandelbrot ? 1 : 0;
    at[k] = q;
    while (k < last && quaternion_dot(q, q) < most) q = at[++k] = next_of(o, q, c);
    return k;
}

/* The same from Q = *q at level k on, without keeping them. */
static int levels_on(const orbit *o, sgt_vec3 p, int k, int last, double most, quaternion *q)
{
    quaternion c = o->mandelbrot ? quaternion_at(o, p.x, p.y, p.z) : o->c;
    while (k < last && quaternion_dot(*q, *q) < most) *q = next_of(o, *q, c), k++;
    return k;
}

/* <y, dQ_n> along an axis: by the orbit with its derivative. */
static double along_axis(const orbit *o, sgt_vec3 p, int n, quaternion axis, quaternion y)
{
    quaternion q = quaternion_at(o, p.x, p.y, p.z), c = o->mandelbrot ? q : o->c, v = axis;
    for (int k = o->mandelbrot ? 1 : 0; k < n; k++) orbit_step(&q, &v, c, axis, o->power, o->mandelbrot);
    return quaternion_dot(y, v);
}

static sgt_vec3 forward_to(const orbit *o, sgt_vec3 p, int n, quaternion y)
{
    sgt_vec3 g = {along_axis(o, p, n, o->x, y), along_axis(o, p, n, o->y, y), along_axis(o, p, n, o->z, y)};
    return isfinite(g.x) && isfinite(g.y) && isfinite(g.z) ? g : (sgt_vec3){NAN, NAN, NAN};
}

/* Takes y, the derivative of a number by Q_n, back to the point. */
static sgt_vec3 back_to_point(const orbit *o, const quaternion at[], int n, quaternion y)
{
    quaternion sum = y, none = {0, 0, 0, 0};
    for (int k = n - 1; k >= (o->mandelbrot ? 1 : 0); k--) {
        quaternion conjugate = {at[k].a, -at[k].b, -at[k].c, -at[k].d};
        orbit_step(&conjugate, &y, none, none, o->power, false);
        sum = o->mandelbrot ? quaternion_sum(sum, y) : y;
    }
    return (sgt_vec3){quaternion_dot(o->x, sum), quaternion_dot(o->y, sum), quaternion_dot(o->z, sum)};
}

double sgt_level_value(const orbit *o, sgt_vec3 p, sgt_vec3 *grad)
{
    quaternion at[SGT_KEPT + 1];
    const int kept = o->iterations - levels_before(o);
    double E2 = o->E * o->E, most = 0x1p64 * (1 + E2);
    int n = levels_of(o, p, kept, most, at);
    quaternion q = at[n];
    if (n == kept) n = levels_on(o, p, n, o->iterations, most, &q);
    double A2 = quaternion_dot(q, q), inverse = 1 / (A2 + E2);
    if (grad) *grad = (sgt_vec3){0, 0, 0};
    if (n < o->iterations || !(A2 < HUGE_VAL)) { /* u > 2^64: 1 to the last bit; or NaN */
        /* The point is finite, and infinity was subtracted from infinity. */
        if (A2 >= 0 || (isfinite(p.x) && isfinite(p.y) && isfinite(p.z))) return 1;
        if (grad) *grad = (sgt_vec3){NAN, NAN, NAN};
        return NAN;
    }
    if (grad) {
        quaternion y = quaternion_times(quaternion_times(q, inverse), 4 * (E2 * inverse));
        *grad = n > kept ? forward_to(o, p, n, y) : back_to_point(o, at, n, y);
    }
    return (A2 - E2) * inverse;
}

double sgt_level_rounding(const orbit *o, sgt_vec3 p)
{
    double E2 = o->E * o->E, most = 0x1p64 * (1 + E2),
           size = o->at_length + fabs(p.x) * o->x_length + fabs(p.y) * o->y_length + fabs(p.z) * o->z_length;
    double given = 8 * SGT_U * size, e = given, up = levels_before(o) ? UP : 1;
    quaternion q = quaternion_at(o, p.x, p.y, p.z), c = o->mandelbrot ? q : o->c;
    int n = o->mandelbrot ? 1 : 0;
    double A2 = quaternion_dot(q, q);
    for (; n < o->iterations && A2 < most; n++) {
        e = up * next_e(sqrt(A2), 0, e, 0, o->c_abs, o->power) + (o->mandelbrot ? given : 0);
        q = next_of(o, q, c), A2 = quaternion_dot(q, q);
    }
    double A = sqrt(A2);
    e *= 1 + 0x1p-40;
    if (n < o->iterations || !(A2 < HUGE_VAL)) return A > 2 * e ? 0x1p-50 : 2; /* certainly 1 */
    double off = (2 * A + e) * e + 8 * SGT_U * A2 + 4 * o->E * o->E_err, least = larger(A - e, 0),
           wide = least * least + E2;
    double f_err = 2 * (E2 / wide) * (off / wide) + 8 * SGT_U;
    return f_err < 2 ? f_err : 2; /* F lies in [-1, 1] */
}

double sgt_level_potential(const orbit *o, sgt_vec3 p, sgt_vec3 *grad)
{
    quaternion at[FAR_LEVELS + 1];
    int n = levels_of(o, p, FAR_LEVELS, 0x1p64, at);
    quaternion q = at[n];
    if (n == FAR_LEVELS) n = levels_on(o, p, n, o->iterations, 0x1p64, &q);
    /* Below 2^-900 the potential is 0, before p^n overflows. */
    double A2 = quaternion_dot(q, q), power = twofold_power(o->power, (unsigned)n).hi,
           scale = power < 0x1p900 ? 1 / power : 0;
    if (grad) *grad = (sgt_vec3){0, 0, 0};
    if (A2 < 0x1p64) return 0;
    if (!(A2 < HUGE_VAL)) { /* too far for squares */
        bool finite = isfinite(p.x) && isfinite(p.y) && isfinite(p.z);
        double far = larger(fabs(p.x) * o->x_length,
                            larger(fabs(p.y) * o->y_length, fabs(p.z) * o->z_length));
        return !finite ? (double)NAN : scale * logarithm(far < HUGE_VAL ? far : DBL_MAX);
    }
    if (grad) {
        quaternion y = quaternion_times(q, scale / A2);
        *grad = n > FAR_LEVELS ? forward_to(o, p, n, y) : back_to_point(o, at, n, y);
    }
    return scale * 0.5 * logarithm(A2);
}
