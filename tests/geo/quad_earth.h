// SPDX-License-Identifier: MIT
// quad_earth.h - heights, levels of gravity and a geoid in quadruple precision: oracles that share neither
// code nor method with the library.
//
// THE HEIGHT.  The foot of p = (r, z) on the ellipsoid is (a^2 r / (a^2 + m), b^2 z / (b^2 + m)), m the
// greatest root of (a r / (a^2 + m))^2 + (b z / (b^2 + m))^2 = 1; that is convex and falls, so that Newton
// from the left, where one term alone is 1, never leaves that side (Eberly 2013).  Then p - foot = m (r /
// (a^2 + m), z / (b^2 + m)), without cancellation.
//
// GRAVITY.  U = GM / E atan(E / u) + omega^2 a^2 / 2 q(u) / q(b) (sin^2 beta - 1/3) + omega^2 rho^2 / 2 in
// ellipsoidal coordinates (Heiskanen and Moritz 1967, equation 2-62), atan and q by their series in E / u:
// right outside the ellipsoid, and some way in.
//
// THE GEOID.  Its own reader, and the cubics in Hermite's form; in double: a slope of 1e-3 makes 1e-12 m of
// what that rounds.
#ifndef QUAD_EARTH_H
#define QUAD_EARTH_H

#include <sagitta/sagitta.h>

#include <cfloat>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <vector>

namespace earth {

#if LDBL_MANT_DIG == 113
typedef long double quad;
#else
__extension__ typedef __float128 quad;
#endif

inline double rounded(quad x) { return static_cast<double>(x); }

inline quad root(quad x)
{
    double guess = std::sqrt(rounded(x));
    if (!(guess > 0)) return 0;
    quad s = guess;
    s = (s + x / s) / 2;
    return (s + x / s) / 2;
}

struct vec { quad x, y, z; };
inline vec exact(const sgt_vec3 &p) { return {p.x, p.y, p.z}; }
inline vec at(const sgt_ray &ray, quad t)
{
    return {ray.o.x + t * ray.d.x, ray.o.y + t * ray.d.y, ray.o.z + t * ray.d.z};
}

// ------------------------------------------------------------------- height

struct ellipsoid { double a, f; };
constexpr ellipsoid WGS84 = {6378137, 1 / 298.257223563};

template <typename T> T multiplier(T a2, T b2, T r, T z, T m, T enough)
{
    for (int i = 0; i < 60; i++) {
        T x = r / (a2 + m), y = z / (b2 + m), g = a2 * x * x + b2 * y * y - 1,
          slope = -2 * (a2 * x * x / (a2 + m) + b2 * y * y / (b2 + m)), step = g / slope;
        m -= step;
        if (!(step > enough * a2 || step < -enough * a2)) break;
    }
    return m;
}

inline quad height(const ellipsoid &e, const vec &p, vec *up = nullptr)
{
    quad a = e.a, b = a * (1 - quad(e.f)), r = root(p.x * p.x + p.y * p.y), z = p.z < 0 ? -p.z : p.z,
         a2 = a * a, b2 = b * b;
    double left = std::fmax(rounded(a * r - a2), rounded(b * z - b2));
    double guess = multiplier<double>(rounded(a2), rounded(b2), rounded(r), rounded(z), left, 1e-14);
    quad m = multiplier<quad>(a2, b2, r, z, guess, 1e-29), x = r / (a2 + m), y = z / (b2 + m),
         length = root(x * x + y * y);
    if (up) {
        quad flat = r > 0 ? x / length / r : 0;
        *up = {p.x * flat, p.y * flat, (p.z < 0 ? -y : y) / length};
    }
    return m * length;
}

// In double, to 1e-7 m: to look about with.
inline double about(const ellipsoid &e, double x, double y, double z, double up[3])
{
    double b = e.a * (1 - e.f), a2 = e.a * e.a, b2 = b * b, r = std::sqrt(x * x + y * y), side = std::fabs(z);
    double m = multiplier<double>(a2, b2, r, side, std::fmax(e.a * r - a2, b * side - b2), 1e-14),
           u = r / (a2 + m), v = side / (b2 + m), length = std::sqrt(u * u + v * v);
    up[0] = r > 0 ? u / length * x / r : 0, up[1] = r > 0 ? u / length * y / r : 0,
    up[2] = (z < 0 ? -v : v) / length;
    return m * length;
}

// ------------------------------------------------------------------ gravity

constexpr double GM = 3986004418e5, OMEGA = 7292115e-11;

inline quad atan_series(quad x, bool q) // atan x, or q(u) of x = E / u
{
    quad sum = 0, power = x, x2 = x * x;
    for (int k = 0; k < 24; k++, power *= -x2)
        sum += power * (q ? -quad(2 * k) / ((2 * k + 1) * (2 * k + 3)) : quad(1) / (2 * k + 1));
    return sum;
}

inline quad potential(const vec &p)
{
    static const quad a = WGS84.a, b = a * (1 - quad(WGS84.f)), E2 = a * a - b * b, E = root(E2),
                      q0 = atan_series(E / b, true);
    quad rho2 = p.x * p.x + p.y * p.y, r2 = rho2 + p.z * p.z, d = r2 - E2,
         u2 = (d + root(d * d + 4 * E2 * p.z * p.z)) / 2, u = root(u2), sine2 = p.z * p.z / u2,
         spin = quad(OMEGA) * OMEGA / 2;
    return GM / E * atan_series(E / u, false) +
           spin * a * a * atan_series(E / u, true) / q0 * (sine2 - quad(1) / 3) + spin * rho2;
}

// F of level_gravity.
inline quad over_level(const vec &p, double h)
{
    static thread_local double last = NAN;
    static thread_local quad level;
    if (!(last == h)) last = h, level = GM / potential({quad(WGS84.a) + h, 0, 0});
    return GM / potential(p) - level;
}

// -------------------------------------------------------------------- geoid

struct grid {
    int rows = 0, columns = 0;
    double west = 0;
    std::vector<float> z;

    bool read(const char *path)
    {
        std::FILE *file = std::fopen(path, "rb");
        std::vector<unsigned char> bytes;
        unsigned char part[65536];
        for (size_t n; file && (n = std::fread(part, 1, sizeof part, file)) > 0;)
            bytes.insert(bytes.end(), part, part + n);
        if (file) std::fclose(file);
        if (bytes.size() < 40) return false;
        auto whole = [&](size_t from, int n) {
            uint64_t x = 0;
            for (int i = 0; i < n; i++) x = x * 256 + bytes[from + static_cast<size_t>(i)];
            return x;
        };
        uint64_t bits = whole(8, 8);
        std::memcpy(&west, &bits, 8);
        rows = static_cast<int>(whole(32, 4)), columns = static_cast<int>(whole(36, 4));
        for (size_t i = 40; i + 4 <= bytes.size(); i += 4) {
            uint32_t four = static_cast<uint32_t>(whole(i, 4));
            float x;
            std::memcpy(&x, &four, 4);
            z.push_back(x);
        }
        return z.size() == static_cast<size_t>(rows) * static_cast<size_t>(columns);
    }
    double node(int i, int j) const
    {
        if (i < 0 || i >= rows) i = i < 0 ? -i : 2 * rows - 2 - i, j += columns / 2;
        return static_cast<double>(z[static_cast<size_t>(i * columns + ((j % columns) + columns) % columns)]);
    }
    static double cubic(const double p[4], double s) // Hermite
    {
        double m1 = (p[2] - p[0]) / 2, m2 = (p[3] - p[1]) / 2, d = p[2] - p[1];
        return p[1] + s * (m1 + s * ((3 * d - 2 * m1 - m2) + s * (m1 + m2 - 2 * d)));
    }
    double undulation(double latitude, double longitude) const // degrees
    {
        double y = (latitude + 90) / 180 * (rows - 1),
               x = std::fmod((longitude - west) / 360 * columns + 2 * columns, columns), along[4];
        int i = static_cast<int>(std::floor(y)), j = static_cast<int>(std::floor(x));
        if (i > rows - 2) i = rows - 2;
        for (int k = 0; k < 4; k++) {
            double across[4];
            for (int m = 0; m < 4; m++) across[m] = node(i - 1 + k, j - 1 + m);
            along[k] = cubic(across, x - j);
        }
        return cubic(along, y - i);
    }
    double below(double x, double y, double upward) const
    {
        const double pi = std::acos(-1.0);
        return undulation(std::asin(upward > 1    ? 1
                                    : upward < -1 ? -1
                                                  : upward) *
                              180 / pi,
                          std::atan2(y, x) * 180 / pi);
    }
    quad over(const vec &p, double h) const // F
    {
        vec up;
        quad high = height(WGS84, p, &up);
        const double pi = std::acos(-1.0);
        return high -
               undulation(std::atan2(rounded(up.z), std::hypot(rounded(up.x), rounded(up.y))) * 180 / pi,
                          std::atan2(rounded(p.y), rounded(p.x)) * 180 / pi) -
               h;
    }
    double about(const vec &p, double h) const // to 1e-6 m
    {
        double up[3], high = earth::about(WGS84, rounded(p.x), rounded(p.y), rounded(p.z), up);
        return high - below(rounded(p.x), rounded(p.y), up[2]) - h;
    }
};

} // namespace earth

#endif
