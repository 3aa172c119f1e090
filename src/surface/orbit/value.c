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
 *
 * ROUNDING.  |Q_N| is off by at most e, the recursion of orbit.h with h = 0, and F is monotone in |Q_N|. */
#include "../../num/elementary.h"
#include "level.h"

enum { FAR_LEVELS = 200 };

/* Q at every level: at[first] ... at[return value].  It stops where |Q|^2 >= most, or at level `last`. */
static int levels_of(const orbit *o, sgt_vec3 p, int last, double most, quaternion at[])
{
    quaternion q = quaternion_at(o, p.x, p.y, p.z), c = o->mandelbrot ? q : o->c;
    int k = o->mandelbrot ? 1 : 0;
    at[k] = q;
    while (k < last && quaternion_dot(q, q) < most) {
        power_of r = power_only(q, o->power);
        q = (quaternion){r.s + c.a, r.f * q.b + c.b, r.f * q.c + c.c, r.f * q.d + c.d};
        at[++k] = q;
    }
    return k;
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
    quaternion at[SGT_LEVELS + 1];
    double E2 = o->E * o->E;
    int n = levels_of(o, p, o->iterations, 0x1p64 * (1 + E2), at);
    double A2 = quaternion_dot(at[n], at[n]), inverse = 1 / (A2 + E2);
    if (grad) *grad = (sgt_vec3){0, 0, 0};
    if (n < o->iterations || !(A2 < HUGE_VAL)) { /* u > 2^64: 1 to the last bit; or NaN */
        /* The point is finite, and infinity was subtracted from infinity. */
        if (A2 >= 0 || (isfinite(p.x) && isfinite(p.y) && isfinite(p.z))) return 1;
        if (grad) *grad = (sgt_vec3){NAN, NAN, NAN};
        return NAN;
    }
    if (grad)
        *grad = back_to_point(o, at, n,
                              quaternion_times(quaternion_times(at[n], inverse), 4 * (E2 * inverse)));
    return (A2 - E2) * inverse;
}

double sgt_level_rounding(const orbit *o, sgt_vec3 p)
{
    quaternion at[SGT_LEVELS + 1];
    double E2 = o->E * o->E,
           size = o->at_length + fabs(p.x) * o->x_length + fabs(p.y) * o->y_length + fabs(p.z) * o->z_length;
    int n = levels_of(o, p, o->iterations, 0x1p64 * (1 + E2), at);
    double given = 8 * SGT_U * size, e = given;
    for (int k = o->mandelbrot ? 1 : 0; k < n; k++)
        e = next_e(sqrt(quaternion_dot(at[k], at[k])), 0, e, 0, o->c_abs, o->power) +
            (o->mandelbrot ? given : 0);
    double A2 = quaternion_dot(at[n], at[n]), A = sqrt(A2);
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
    double A2 = quaternion_dot(at[n], at[n]), scale = 1 / twofold_power(o->power, (unsigned)n).hi;
    if (grad) *grad = (sgt_vec3){0, 0, 0};
    if (A2 < 0x1p64) return 0;
    if (!(A2 < HUGE_VAL)) { /* too far for squares */
        bool finite = isfinite(p.x) && isfinite(p.y) && isfinite(p.z);
        double far = larger(fabs(p.x) * o->x_length,
                            larger(fabs(p.y) * o->y_length, fabs(p.z) * o->z_length));
        return !finite ? (double)NAN : scale * logarithm(far < HUGE_VAL ? far : DBL_MAX);
    }
    if (grad) *grad = back_to_point(o, at, n, quaternion_times(at[n], scale / A2));
    return scale * 0.5 * logarithm(A2);
}
