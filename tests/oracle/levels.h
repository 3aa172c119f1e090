// SPDX-License-Identifier: MIT
// levels.h - level sets of quaternion orbits by the textbook, for any scalar.
//
// An oracle for tests: the orbit Q -> Q^p + c is followed as it is written down, with whole
// quaternion products, in double, in quadruple precision, on dual numbers (the value and its
// derivative along a ray) and on the Jets of Ceres.  It shares no code with the library.
//
// The gradient, by hand.  Q^p changes by J(Q) h = sum over i of Q^i h Q^(p-1-i) when Q changes by
// h, which is a matrix of 4 x 4: the sum of L(Q^i) R(Q^(p-1-i)), L and R the matrices of products
// from the left and from the right.  So T = dQ_n/dQ_0 goes T(0) = 1, T(n+1) = J(Q_n) T(n); for a
// Mandelbrot set T = dQ_n/dc goes T(0) = 0, T(n+1) = J(Q_n) T(n) + 1, since c itself moves.  Then
// grad |Q_N|^2 = 2 T^t Q_N, whose products with the axes of the slice are the gradient in x, y, z,
// and F = (u - 1) / (u + 1) has grad F = 2 grad u / (u + 1)^2, u = |Q_N|^2 / E^2.
#ifndef ORACLE_LEVELS_H
#define ORACLE_LEVELS_H

#include "../../src/truth/orbit.hpp"
#include "cases.h"

#include <sagitta/surfaces.h>

#include <initializer_list>

namespace oracle {

struct level {
    bool mandelbrot; // s.c is not read then
    sgt_julia s;     // with nothing left to a default
};

// The same for both; the caller keeps *m in place while it is used.
inline sgt_surface as_surface(const level &f, sgt_mandelbrot *m)
{
    if (!f.mandelbrot) return {&sgt_julia_ops, &f.s};
    *m = sgt_mandelbrot();
    std::memcpy(m->at, f.s.at, sizeof m->at);
    std::memcpy(m->ex, f.s.ex, sizeof m->ex);
    std::memcpy(m->ey, f.s.ey, sizeof m->ey);
    std::memcpy(m->ez, f.s.ez, sizeof m->ez);
    m->escape = f.s.escape;
    m->iterations = f.s.iterations;
    m->power = f.s.power;
    return {&sgt_mandelbrot_ops, m};
}

// --------------------------------------------------------------- quaternions (orbit.hpp)

// A point of the slice, as a quaternion.
template <class T> quaternion<T> in_slice(const level &f, const T &x, const T &y, const T &z)
{
    return constant<T>(f.s.at) + x * constant<T>(f.s.ex) + y * constant<T>(f.s.ey) + z * constant<T>(f.s.ez);
}

// A number and its derivative.
template <class T> struct dual {
    T v, d;
    dual(T value = T(0), T derivative = T(0)) : v(value), d(derivative) {}
    friend dual operator+(const dual &x, const dual &y) { return {x.v + y.v, x.d + y.d}; }
    friend dual operator-(const dual &x, const dual &y) { return {x.v - y.v, x.d - y.d}; }
    friend dual operator*(const dual &x, const dual &y) { return {x.v * y.v, x.v * y.d + x.d * y.v}; }
    friend dual operator/(const dual &x, const dual &y)
    {
        return {x.v / y.v, (x.d * y.v - x.v * y.d) / (y.v * y.v)};
    }
    friend bool operator>(const dual &x, double y) { return x.v > T(y); }
};

// --------------------------------------------------------------------- orbits

// Q_n, n at most `levels`; fewer if |Q|^2 is beyond `far`: from there on it only grows.
template <class T>
quaternion<T> orbit(const level &f, const quaternion<T> &point, int levels, double far, int *n)
{
    static const double zero[4] = {0, 0, 0, 0};
    const quaternion<T> c = f.mandelbrot ? point : constant<T>(f.s.c);
    return orbit(f.mandelbrot ? constant<T>(zero) : point, c, f.s.power, levels, far, n);
}

// |Q_N|^2 - E^2, or what it has grown to before, which has the same sign.
template <class T> T excess(const level &f, const T &x, const T &y, const T &z, double far = 1e30)
{
    int n;
    const quaternion<T> q = orbit(f, in_slice(f, x, y, z), f.s.iterations, far, &n);
    return dot(q, q) - T(f.s.escape) * T(f.s.escape);
}

// F itself.
template <class T> T level_value(const level &f, const T &x, const T &y, const T &z, double far = 1e30)
{
    const T g = excess(f, x, y, z, far), e = T(f.s.escape) * T(f.s.escape);
    return g / (g + e + e);
}

// The smallest escape that is safe: the root of x^p = x + |c|, |c| = 0 for a Mandelbrot set's
// (there |c| <= E is all that is known of it: x^p = 2 x), rounded up by a part in 2^50.
inline double safe_escape(const level &f)
{
    const double *c = f.s.c,
                 size = f.mandelbrot ? 0 : std::sqrt(c[0] * c[0] + c[1] * c[1] + c[2] * c[2] + c[3] * c[3]),
                 p = f.s.power;
    if (f.mandelbrot) return std::pow(2, 1 / (p - 1)) * (1 + 0x1p-50);
    double lo = 1, hi = 2 + size;
    for (int i = 0; i < 200; i++) {
        const double x = (lo + hi) / 2;
        (std::pow(x, p) < x + size ? lo : hi) = x;
    }
    return hi * (1 + 0x1p-50);
}

// --------------------------------------------------------------- random cases

inline void random_unit(generator &g, double v[4])
{
    for (;;) {
        double sum = 0;
        for (int i = 0; i < 4; i++) v[i] = g.uniform(-1, 1), sum += v[i] * v[i];
        if (!(sum > 0.01 && sum < 1)) continue;
        for (int i = 0; i < 4; i++) v[i] /= std::sqrt(sum);
        return;
    }
}

// Powers 2 ... 8, half of them 2; N = 1 ... 12; |c| up to 2, and the classic ones; slices plain,
// shifted, tilted, scaled and askew; the safe escape and larger ones.
inline level random_level(generator &g)
{
    static const double classic[4][4] = {
        {-0.083, 0, -0.83, -0.025}, {-0.2, 0.8, 0, 0}, {-1, 0.2, 0, 0}, {-0.125, -0.256, 0.847, 0.0895}};
    level f = {};
    f.mandelbrot = g.chance(0.25);
    f.s.power = g.chance(0.5) ? 2 : 2 + g.below(7);
    f.s.iterations = 1 + g.below(12);
    if (!f.mandelbrot) {
        double way[4], size = g.chance(0.2) ? 2 : g.uniform(0, 2);
        random_unit(g, way);
        if (g.chance(0.05)) size = 0;
        for (int i = 0; i < 4; i++) f.s.c[i] = size * way[i];
        if (g.chance(0.3)) std::memcpy(f.s.c, classic[g.below(4)], sizeof f.s.c);
    }
    const bool tilted = g.chance(0.5), askew = tilted && g.chance(0.5);
    double *axis[3] = {f.s.ex, f.s.ey, f.s.ez}, upright[3][4];
    for (int i = 0; i < 3; i++) {
        axis[i][i] = 1;
        double left = 0; // of the axis, at right angles to those before
        while (tilted && !(left > 0.2)) {
            random_unit(g, axis[i]);
            std::memcpy(upright[i], axis[i], sizeof upright[i]);
            for (int j = 0; j < i; j++) {
                double inner = 0;
                for (int k = 0; k < 4; k++) inner += axis[i][k] * upright[j][k];
                for (int k = 0; k < 4; k++) upright[i][k] -= inner * upright[j][k];
            }
            left = 0;
            for (double u : upright[i]) left += u * u;
            for (double &u : upright[i]) u /= std::sqrt(left);
            if (!askew) std::memcpy(axis[i], upright[i], sizeof upright[i]);
        }
    }
    if (g.chance(0.5)) {
        const double unit = g.chance(0.1) ? g.log_uniform(1e-9, 1e9) : g.log_uniform(0.1, 10);
        for (auto &a : axis)
            for (int k = 0; k < 4; k++) a[k] *= unit * (askew ? g.uniform(0.5, 2) : 1);
    }
    if (g.chance(0.5))
        for (double &a : f.s.at) a = g.uniform(-0.4, 0.4);
    f.s.escape = safe_escape(f);
    if (g.chance(0.3)) f.s.escape *= 1 + g.log_uniform(1e-3, 10);
    return f;
}

// How long the axes are, about: lengths of the slice are of this size over it.
inline double axis_length(const level &f)
{
    double sum = 0;
    for (const double *a : {f.s.ex, f.s.ey, f.s.ez})
        for (int k = 0; k < 4; k++) sum += a[k] * a[k];
    return std::sqrt(sum / 3);
}

inline sgt_vec3 random_point(generator &g, double size)
{
    return {g.uniform(-size, size), g.uniform(-size, size), g.uniform(-size, size)};
}
inline sgt_vec3 random_way(generator &g)
{
    const double z = g.uniform(-1, 1), a = g.uniform(0, 6.283185307179586), r = std::sqrt(1 - z * z);
    return {r * std::cos(a), r * std::sin(a), z};
}

// From outside (or, one in five, from inside), at a point where the set is likely to be.
inline sgt_ray random_ray(generator &g, const level &f)
{
    const double size = 1 / axis_length(f), length = g.chance(0.5) ? 1 : g.log_uniform(1e-3, 1e3);
    const sgt_vec3 at = random_point(g, g.uniform(0.1, 1) * size), d = random_way(g);
    const double away = g.chance(0.2) ? 0 : size * (g.chance(0.1) ? g.log_uniform(1, 1e6) : g.uniform(2, 6));
    return {{at.x - away * d.x, at.y - away * d.y, at.z - away * d.z},
            {length * d.x, length * d.y, length * d.z},
            0,
            0};
}

// Everything of a case in hexadecimal, as C writes it.
inline void print_level(const level &f)
{
    std::printf("    %s power %d iterations %d escape %a", f.mandelbrot ? "mandelbrot" : "julia", f.s.power,
                f.s.iterations, f.s.escape);
    const char *const name[] = {"c", "at", "ex", "ey", "ez"};
    const double *const list[] = {f.s.c, f.s.at, f.s.ex, f.s.ey, f.s.ez};
    for (int i = 0; i < 5; i++)
        std::printf(" %s {%a, %a, %a, %a}", name[i], list[i][0], list[i][1], list[i][2], list[i][3]);
    std::printf("\n");
}

} // namespace oracle
#endif
