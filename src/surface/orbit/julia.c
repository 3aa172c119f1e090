/* julia.c - level sets of Q^p + c, as surfaces: the quaternion Julia and Mandelbrot sets.
 *
 * F = (u - 1) / (u + 1), u = |Q_N|^2 / E^2: the same roots as |Q_N|^2 - E^2, which overflows at N = 12.
 * Its gradient is 4 E^2 / (|Q_N|^2 + E^2)^2 times that of |Q_N|^2 / 2, which is T^T Q_N with the Jacobian
 * tensor T = dQ_N/dp = J(Q_{N-1}) ... J(Q_0) [ex ey ez].  The product is taken from the left, y_N = Q_N,
 * y_k = J(Q_k)^T y_{k+1}: one quaternion on the way back instead of three columns on the way, and
 * grad = (<ex, y_0>, <ey, y_0>, <ez, y_0>).  J(Q) x = sum of Q^i x Q^(p-1-i); since <y, a x b> =
 * <conj(a) y conj(b), x>, its transpose is J(conj(Q)): the same formula.  In the Mandelbrot set each level adds
 * c, so grad = y_N + ... + y_1 in place of y_0: the added identity.
 *
 * ROUNDING.  |Q_N| is off by at most e, the recursion of orbit.h with h = 0, and F is monotone in |Q_N|.
 *
 * Tests: tests/oracle/test_levels.cpp, test_brute.cpp, test_ceres.cpp, tests/unit/test_levels.c. */
#include "../../num/elementary.h"
#include "level.h"

#include "course.h"

enum { FAR_LEVELS = 200 };

/* Q at every level: at[first] ... at[return value], where A2 > most or level = last. */
static int levels_of(const orbit *o, sgt_vec3 p, int last, double most, quaternion at[])
{
    quaternion q = quaternion_at(o, p.x, p.y, p.z), c = o->mandelbrot ? q : o->c;
    int k = o->mandelbrot ? 1 : 0;
    at[k] = q;
    while (k < last && quaternion_dot(q, q) < most) {
        power_of r = power_alone(q, o->power);
        q = (quaternion){r.s + c.a, r.f * q.b + c.b, r.f * q.c + c.c, r.f * q.d + c.d};
        at[++k] = q;
    }
    return k;
}

/* y, the derivative of a number by Q_n, back to the point. */
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
    if (n < o->iterations || !(A2 < HUGE_VAL)) { /* u > 2^64: 1 to the last bit; or not a number */
        if (A2 >= 0 || (isfinite(p.x) && isfinite(p.y) && isfinite(p.z))) return 1; /* a finite point, and infinity less infinity */
        if (grad) *grad = (sgt_vec3){NAN, NAN, NAN};
        return NAN;
    }
    if (grad) *grad = back_to_point(o, at, n, quaternion_times(quaternion_times(at[n], inverse), 4 * (E2 * inverse)));
    return (A2 - E2) * inverse;
}

static double rounding_at(const orbit *o, sgt_vec3 p)
{
    quaternion at[SGT_LEVELS + 1];
    double E2 = o->E * o->E, size = o->at_length + fabs(p.x) * o->x_length + fabs(p.y) * o->y_length + fabs(p.z) * o->z_length;
    int n = levels_of(o, p, o->iterations, 0x1p64 * (1 + E2), at);
    double given = 8 * SGT_U * size, e = given;
    for (int k = o->mandelbrot ? 1 : 0; k < n; k++)
        e = next_e(sqrt(quaternion_dot(at[k], at[k])), 0, e, 0, o->c_abs, o->power) + (o->mandelbrot ? given : 0);
    double A2 = quaternion_dot(at[n], at[n]), A = sqrt(A2);
    e *= 1 + 0x1p-40;
    if (n < o->iterations || !(A2 < HUGE_VAL)) return A > 2 * e ? 0x1p-50 : 2; /* 1 it is, by far */
    double off = (2 * A + e) * e + 8 * SGT_U * A2 + 4 * o->E * o->E_err, least = larger(A - e, 0), wide = least * least + E2;
    double f_err = 2 * (E2 / wide) * (off / wide) + 8 * SGT_U;
    return f_err < 2 ? f_err : 2; /* F lies in [-1, 1] */
}

static double potential_at(const orbit *o, sgt_vec3 p, sgt_vec3 *grad)
{
    quaternion at[FAR_LEVELS + 1];
    int n = levels_of(o, p, FAR_LEVELS, 0x1p64, at);
    double A2 = quaternion_dot(at[n], at[n]), scale = 1 / twofold_power(o->power, (unsigned)n).hi;
    if (grad) *grad = (sgt_vec3){0, 0, 0};
    if (A2 < 0x1p64) return 0;
    if (!(A2 < HUGE_VAL)) { /* farther than squares reach */
        bool finite = isfinite(p.x) && isfinite(p.y) && isfinite(p.z);
        double far = larger(fabs(p.x) * o->x_length, larger(fabs(p.y) * o->y_length, fabs(p.z) * o->z_length));
        return !finite ? (double)NAN : scale * logarithm(far < HUGE_VAL ? far : DBL_MAX);
    }
    if (grad) *grad = back_to_point(o, at, n, quaternion_times(at[n], scale / A2));
    return scale * 0.5 * logarithm(A2);
}

/* About the middle of t, in the scaled direction: of a d that is very short the squares would be lost.  Where the ray is
 * so far off that squares overflow nothing is said. */
static sgt_interval enclose_by(const orbit *o, const sgt_ray *ray, sgt_interval t, sgt_interval *slope)
{
    path w;
    double scale = scale_of(ray->d), lo = t.lo / scale, hi = t.hi / scale, m = 0.5 * lo + 0.5 * hi;
    double h = larger(hi - m, m - lo) * (1 + 4 * SGT_U) + 0x1p-1070; /* what has underflown */
    *slope = (sgt_interval){-HUGE_VAL, HUGE_VAL};
    if (t.lo > t.hi) return *slope = (sgt_interval){HUGE_VAL, -HUGE_VAL};
    local q = local_at(ray, m, 0);
    double far = (fabs(q.x) + fabs(q.y) + fabs(q.z)) + 2 * h;
    if (!(far < 0x1p480)) return (sgt_interval){-1, 1};
    set_of(o, &w);
    path_of(o, (sgt_vec3){q.x, q.y, q.z}, q.l, q.m, q.n, &w);
    sgt_interval g = sgt_orbit_enclose(&w, 0, h, slope);
    slope->lo = slope->lo / scale - 0x1p-1074, slope->hi = slope->hi / scale + 0x1p-1074;
    return g;
}

/* ------------------------------------------------------- the two surfaces */

static sgt_hit first_of(const orbit *o, const sgt_ray *ray, const sgt_options *opt)
{
    sgt_list list = {.cap = 0, .count = 0};
    int evals = sgt_level_march(o, ray, opt, false, &list);
    return first_entry(&list, ray, evals);
}

#define LEVEL_SET(kind)                                                                                              \
    static double kind##_value(const void *self, sgt_vec3 p, sgt_vec3 *grad)                                         \
    {                                                                                                                \
        orbit o;                                                                                                     \
        if (!sgt_orbit_of_##kind(self, &o).param) return sgt_level_value(&o, p, grad);                                      \
        if (grad) *grad = (sgt_vec3){NAN, NAN, NAN};                                                                 \
        return NAN;                                                                                                  \
    }                                                                                                                \
    static sgt_span kind##_span(const void *self, const sgt_ray *ray)                                                \
    {                                                                                                                \
        orbit o;                                                                                                     \
        if (sgt_orbit_of_##kind(self, &o).param) return (sgt_span){.lo = -HUGE_VAL, .hi = HUGE_VAL, .seed = NAN};    \
        return sgt_level_span(&o, ray);                                                                              \
    }                                                                                                                \
    static double kind##_rounding(const void *self, sgt_vec3 p)                                                      \
    {                                                                                                                \
        orbit o;                                                                                                     \
        return sgt_orbit_of_##kind(self, &o).param ? (double)NAN : rounding_at(&o, p);                                       \
    }                                                                                                                \
    static double kind##_estimate(const void *self, sgt_vec3 p)                                                      \
    {                                                                                                                \
        orbit o;                                                                                                     \
        double f;                                                                                                    \
        return sgt_orbit_of_##kind(self, &o).param ? (double)NAN : sgt_level_estimate(&o, p, &f);                            \
    }                                                                                                                \
    static sgt_interval kind##_enclose(const void *self, const sgt_ray *ray, sgt_interval t, sgt_interval *slope)    \
    {                                                                                                                \
        orbit o;                                                                                                     \
        *slope = (sgt_interval){NAN, NAN};                                                                           \
        return sgt_orbit_of_##kind(self, &o).param ? *slope : enclose_by(&o, ray, t, slope);                         \
    }                                                                                                                \
    static sgt_hit kind##_meet(const void *self, const sgt_ray *ray, const sgt_options *opt)                         \
    {                                                                                                                \
        orbit o;                                                                                                     \
        if (sgt_orbit_of_##kind(self, &o).param) return hit_without(SGT_INVALID, ray, 0);                            \
        return first_of(&o, ray, opt);                                                                               \
    }                                                                                                                \
    static sgt_status kind##_all(const void *self, const sgt_ray *ray, const sgt_options *opt, sgt_list *list)       \
    {                                                                                                                \
        orbit o;                                                                                                     \
        if (sgt_orbit_of_##kind(self, &o).param) return SGT_INVALID;                                                 \
        sgt_level_march(&o, ray, opt, true, list);                                                                   \
        return 0;                                                                                                    \
    }                                                                                                                \
    static size_t kind##_sweep(const void *self, const sgt_tile *tile, const sgt_options *opt)                       \
    {                                                                                                                \
        orbit o;                                                                                                     \
        if (!sgt_orbit_of_##kind(self, &o).param) return sgt_level_sweep(&o, tile, opt);                             \
        memset(tile->hits.status, SGT_HARD, tile->n);                                                                \
        return tile->n;                                                                                              \
    }                                                                                                                \
    static const struct sgt_own kind##_own = {.meet = kind##_meet, .all = kind##_all, .sweep = kind##_sweep, .tile = SGT_MOST_TILE}; \
    const sgt_surface_ops sgt_##kind##_ops = {.name = #kind, .value = kind##_value, .span = kind##_span,             \
                                              .rounding = kind##_rounding, .estimate = kind##_estimate,              \
                                              .enclose = kind##_enclose, .own_ = &kind##_own};                       \
    double sgt_##kind##_potential(const sgt_##kind *s, sgt_vec3 p, sgt_vec3 *grad)                                   \
    {                                                                                                                \
        orbit o;                                                                                                     \
        if (!sgt_orbit_of_##kind(s, &o).param) return potential_at(&o, p, grad);                                     \
        if (grad) *grad = (sgt_vec3){NAN, NAN, NAN};                                                                 \
        return NAN;                                                                                                  \
    }                                                                                                                \
    sgt_objection sgt_##kind##_object(const void *self)                                                              \
    {                                                                                                                \
        orbit o;                                                                                                     \
        return sgt_orbit_of_##kind(self, &o);                                                                        \
    }

LEVEL_SET(julia)
LEVEL_SET(mandelbrot)
