// SPDX-License-Identifier: MIT
// elementary.hpp - exp, log, sin and their kin in 113 bits, for any number with + - * / (a __float128 here).
//
// No library of such functions is needed.  Each function is reduced to a Taylor series of an argument that is
// so small that some 30 terms reach 2^-116; the sum ends when a term no longer counts.  Errors are at most
// 2^-108 of the value: observed, the worst is 2^-109.8 (tests/formula/test_text.cpp, against Arb).
//
//   exp    x = k log 2 + r, |r| < 0.35; log 2 as two numbers, so that k times the first one is exact
//   log    x = 2^k m, m about 1; log m = 2 artanh ((m - 1) / (m + 1)), relatively exact near 1
//   sin    x = k pi/2 + r, |r| < 0.8; pi/2 as four doubles, and k times each is exact for |k| up to 2^53.
//          Farther out it is NaN: not known in 113 bits
//   atan   atan x = pi/2 - atan(1/x) for x > 1; atan x = 2 atan(x / (1 + sqrt(1 + x^2))), three times
//   sinh   by its series for |x| < 1/2, where exp(x) - exp(-x) would cancel
#ifndef TRUTH_ELEMENTARY_HPP
#define TRUTH_ELEMENTARY_HPP
#include "quad.hpp"

namespace oracle {

const quad half_turn =
    2 * (quad(0x1.921fb54442d18p+0) + quad(0x1.1a62633145c07p-54) - quad(0x1.f1976b7ed8fbcp-110));

inline quad nearest_whole(quad x) // |x| < 2^60
{
    return quad(static_cast<long long>(x < 0 ? x - quad(0.5) : x + quad(0.5)));
}

// x 2^k; each step is exact as long as the result is no subnormal number.
inline quad scaled(quad x, int k)
{
    for (; k > 0; k -= k < 512 ? k : 512) x *= quad(std::ldexp(1.0, k < 512 ? k : 512));
    for (; k < 0; k += k > -512 ? -k : 512) x *= quad(std::ldexp(1.0, k > -512 ? k : -512));
    return x;
}

// The sum of term, term * by / (i (i + 1)), ... for i = first, first + 2, ...
inline quad series_by_two(quad term, quad by, int first)
{
    quad sum = 0;
    for (int i = first; i < 200 && sum + term != sum; i += 2) {
        sum += term;
        term *= by / (i * (i + 1));
    }
    return sum;
}

inline quad exponential(quad x)
{
    if (!(magnitude(x) < 11000)) return x > 0 ? quad(INFINITY) : x < 0 ? quad(0) : quad(NAN);
    const quad first = quad(0x1.62e42fefa39efp-1),
               second = quad(0x1.abc9e3b39803fp-56) + quad(0x1.7b57a079a1934p-111);
    const quad k = nearest_whole(x / first), r = x - k * first - k * second;
    quad sum = 0, term = 1;
    for (int i = 1; i < 60 && sum + term != sum; i++) {
        sum += term;
        term *= r / i;
    }
    return scaled(sum, static_cast<int>(k));
}

// NaN for x <= 0.
inline quad logarithm(quad x)
{
    if (!(x > 0) || x - x != 0) return x > 0 ? x : quad(NAN);
    int k = 0;
    while (x > quad(0x1p512)) x *= quad(0x1p-512), k += 512;
    while (x < quad(0x1p-512)) x *= quad(0x1p512), k -= 512;
    int more;
    const double about = std::frexp(to_double(x), &more); // 1/2 to 1
    if (about < 0.7) more--;
    const quad m = scaled(x, -more), s = (m - 1) / (m + 1), s2 = s * s;
    quad sum = 0, power = s;
    for (int i = 1; i < 200 && sum + power / i != sum; i += 2) {
        sum += power / i;
        power *= s2;
    }
    const quad count = k + more, first = quad(0x1.62e42fefa39efp-1),
               second = quad(0x1.abc9e3b39803fp-56) + quad(0x1.7b57a079a1934p-111);
    return count * first + (count * second + 2 * sum);
}

struct sine_and_cosine {
    quad sine, cosine;
};

inline sine_and_cosine on_circle(quad x)
{
    if (!(magnitude(x) < quad(0x1p53))) return {quad(NAN), quad(NAN)};
    const quad p[4] = {quad(0x1.921fb54442d18p+0), quad(0x1.1a62633145c07p-54), quad(-0x1.f1976b7ed8fbcp-110),
                       quad(0x1.4cf98e804177dp-164)};
    const quad k = nearest_whole(x / p[0]);
    quad r = x;
    for (quad part : p) r -= k * part;
    const quad s = series_by_two(r, -r * r, 2), c = series_by_two(1, -r * r, 1);
    switch (static_cast<long long>(k) & 3) {
    case 0: return {s, c};
    case 1: return {c, -s};
    case 2: return {-s, -c};
    default: return {-c, s};
    }
}
inline quad sine_of(quad x) { return on_circle(x).sine; }
inline quad cosine_of(quad x) { return on_circle(x).cosine; }
inline quad tangent(quad x)
{
    const sine_and_cosine at = on_circle(x);
    return at.sine / at.cosine;
}

inline quad arc_tangent(quad x)
{
    if (x < 0) return -arc_tangent(-x);
    if (x > 1) return half_turn / 2 - arc_tangent(1 / x);
    int halved = 0;
    for (; halved < 3; halved++) x = x / (1 + square_root(1 + x * x));
    const quad by = -x * x;
    quad sum = 0, power = x;
    for (int i = 1; i < 200 && sum + power / i != sum; i += 2) {
        sum += power / i;
        power *= by;
    }
    return scaled(sum, halved);
}

// The angle of (x, y), -pi to pi; NaN at (0, 0).
inline quad angle_of(quad y, quad x)
{
    if (x == 0 && y == 0) return quad(NAN);
    if (y < 0) return -angle_of(-y, x);
    if (magnitude(x) < y) return half_turn / 2 - arc_tangent(x / y);
    return x > 0 ? arc_tangent(y / x) : half_turn - arc_tangent(y / -x);
}

// NaN beyond 1.  (1 - x)(1 + x) keeps its digits where x is near 1.
inline quad arc_sine(quad x) { return angle_of(x, square_root((1 - x) * (1 + x))); }
inline quad arc_cosine(quad x) { return angle_of(square_root((1 - x) * (1 + x)), x); }

inline quad hyperbolic_sine(quad x)
{
    if (magnitude(x) < quad(0.5)) return series_by_two(x, x * x, 2);
    return (exponential(x) - exponential(-x)) / 2;
}
inline quad hyperbolic_cosine(quad x) { return (exponential(x) + exponential(-x)) / 2; }
inline quad hyperbolic_tangent(quad x)
{
    if (x < 0) return -hyperbolic_tangent(-x);
    if (x < quad(0.5)) return hyperbolic_sine(x) / hyperbolic_cosine(x);
    return 1 - 2 / (exponential(2 * x) + 1);
}

// By Newton from the double's root: 53 bits, 105, 113.
inline quad cube_root(quad x)
{
    if (x < 0) return -cube_root(-x);
    if (x == 0 || x - x != 0) return x;
    quad scale = 1;
    while (x > quad(0x1p900)) x *= quad(0x1p-900), scale *= quad(0x1p300);
    while (x < quad(0x1p-900)) x *= quad(0x1p900), scale *= quad(0x1p-300);
    quad y = std::cbrt(to_double(x));
    y -= (y - x / (y * y)) / 3;
    return scale * (y - (y - x / (y * y)) / 3);
}

} // namespace oracle
#endif
