// SPDX-License-Identifier: MIT
// brute.h - where a ray meets the level set |Q_N| = E of a quaternion orbit, by small steps.
//
// An oracle for tests: it shares neither code nor method with the library.
//
// Inside or outside.  F is below zero where |Q_N| < E.  With E no smaller than the root R* of
// x^p = x + |c|, an orbit beyond E goes on growing (|Q^p + c| >= |Q|^p - |c| > |Q|), so a point is
// outside if and only if any of |Q_0| ... |Q_N| is above E, and an orbit may be left there.  For
// the Mandelbrot set, where c is the point, so it is with E >= 2^(1/(p-1)): from Q_1 = c on, an
// orbit beyond max(E, |c|) grows.
//
// Three numbers a point.  Q^p lies in the plane of 1 and Im Q: with Q = a + v and s = |v|^2,
// Q^p = A + f v, where (A, f) follow from (a + i |v|)^p = A + i f |v|: from Q^k to Q^(k+1)
//     A' = a A - s f,  f' = a f + A;  for p = 2: A = a^2 - s, f = 2 a.
// A turn or a reflection of the imaginary space changes no length; one that takes Im c onto the
// first axis leaves Q = (a, b, y, z), and y and z enter only by r = y^2 + z^2:
//     a' = A + Re c,  b' = f b +- |Im c|,  r' = f^2 r,  s = b^2 + r.
// For the Mandelbrot set the orbit stays in the plane of 1 and Im c, so b = |Im c| and r = 0.
//
// Steps.  Blocks of points one step apart go through the same operations, which the compiler
// turns into vectors; a block whose points are all outside is left at once.  Each two neighbours
// of which one is inside and one is not bracket a root, which bisection then takes to the last bit.
// Two roots between neighbours are not seen; that is what a finer step is for.
//
// Where rounding matters the orbit is also here in 113 bits, by Hamilton's product.
#ifndef ORACLE_BRUTE_H
#define ORACLE_BRUTE_H

#include "quad.h"

#include <array>

namespace brute {

using oracle::quad;
using quaternion = std::array<double, 4>;

struct level_set {
    bool mandelbrot;
    int power, iterations;
    double escape;
    quaternion c, at, axis[3];
};

struct vector3 {
    double x, y, z;
};

struct ray {
    vector3 o, d;
};

// ------------------------------------------------------------- in double

// The ray in four dimensions, Im c turned onto the first imaginary axis.
struct line {
    int levels;
    double bound, real, imaginary; // E^2; c
    quaternion start, slope;
    double enters, leaves; // the ball |Q| <= E: outside it there is nothing; enters > leaves: missed

    line(const level_set &s, const ray &r)
        : levels(s.iterations - s.mandelbrot), bound(s.escape * s.escape), real(s.c[0])
    {
        for (std::size_t i = 0; i < 4; i++) {
            start[i] = s.at[i] + r.o.x * s.axis[0][i] + r.o.y * s.axis[1][i] + r.o.z * s.axis[2][i];
            slope[i] = r.d.x * s.axis[0][i] + r.d.y * s.axis[1][i] + r.d.z * s.axis[2][i];
        }
        const double length = std::sqrt(s.c[1] * s.c[1] + s.c[2] * s.c[2] + s.c[3] * s.c[3]);
        imaginary = s.c[1] > 0 ? -length : length;
        if (length > 0) { // Householder: the mirror that takes Im c to -+ |Im c| on the axis
            const quaternion mirror = {0, s.c[1] - imaginary, s.c[2], s.c[3]};
            const double norm = mirror[1] * mirror[1] + mirror[2] * mirror[2] + mirror[3] * mirror[3];
            for (quaternion *q : {&start, &slope}) {
                const double along = 2 * (mirror[1] * (*q)[1] + mirror[2] * (*q)[2] + mirror[3] * (*q)[3]) /
                                     norm;
                for (std::size_t i = 1; i < 4; i++) (*q)[i] -= along * mirror[i];
            }
        }
        double vv = 0, pv = 0, pp = 0;
        for (std::size_t i = 0; i < 4; i++)
            vv += slope[i] * slope[i], pv += start[i] * slope[i], pp += start[i] * start[i];
        const double half = std::sqrt(pv * pv - vv * (pp - bound)) / vv; // NaN where the ray misses the ball
        const bool met = half >= 0;
        enters = met ? -pv / vv - half - 1e-9 : 1;
        leaves = met ? -pv / vv + half + 1e-9 : 0;
    }
};

// How many of the points t, t + step ... are inside; if any, largest[] has the largest |Q_k|^2 of
// each: inside are those with largest <= bound.  (An orbit that overflows to NaN has passed the
// bound before, and `largest` keeps that.)
template <int lanes, int power, bool mandelbrot>
int count_inside(const line &l, double t, double step, double largest[])
{
    double a[lanes], b[lanes], r[lanes], real[lanes], imaginary[lanes];
    for (int i = 0; i < lanes; i++) {
        const double u = t + i * step, x = l.start[1] + u * l.slope[1];
        const double y = l.start[2] + u * l.slope[2], z = l.start[3] + u * l.slope[3];
        a[i] = real[i] = l.start[0] + u * l.slope[0];
        b[i] = imaginary[i] = mandelbrot ? std::sqrt(x * x + y * y + z * z) : x;
        r[i] = mandelbrot ? 0 : y * y + z * z;
        largest[i] = 0;
    }
    for (int k = 0;; k++) {
        int inside = 0;
        for (int i = 0; i < lanes; i++) {
            const double aa = a[i] * a[i], s = mandelbrot ? b[i] * b[i] : b[i] * b[i] + r[i];
            largest[i] = aa + s > largest[i] ? aa + s : largest[i];
            inside += largest[i] <= l.bound;
            double A = aa - s, f = 2 * a[i];
            for (int n = 2; n < power; n++) {
                const double before = A;
                A = a[i] * A - s * f;
                f = a[i] * f + before;
            }
            a[i] = A + (mandelbrot ? real[i] : l.real);
            b[i] = f * b[i] + (mandelbrot ? imaginary[i] : l.imaginary);
            if (!mandelbrot) r[i] *= f * f;
        }
        if (!inside || k == l.levels) return inside;
    }
}

typedef int counter(const line &l, double t, double step, double largest[]);

template <int lanes, int power = 2>
counter *counter_for(const level_set &s)
{
    if constexpr (power < 8)
        if (s.power != power) return counter_for<lanes, power + 1>(s);
    return s.mandelbrot ? count_inside<lanes, power, true> : count_inside<lanes, power, false>;
}

inline bool is_inside(const level_set &s, const line &l, double t)
{
    double largest;
    return counter_for<1>(s)(l, t, 0, &largest) != 0;
}

// A root: inside at one of lo and hi and outside at the other; F rises where the ray leaves.
struct change {
    double lo, hi, t;
    bool rises;
};

// Every change that steps of this length see on t >= 0, or the first alone.
inline std::vector<change> changes(const level_set &s, const line &l, double step, bool first_only)
{
    const int lanes = 64;
    std::vector<change> found;
    double largest[lanes];
    counter *const count = counter_for<lanes>(s), *const one = counter_for<1>(s);
    const double from = std::max(0.0, l.enters);
    bool inside = is_inside(s, l, from);
    double last = from;
    for (double i = 0; from + (i - 1) * step < l.leaves; i += lanes) {
        const double t = from + i * step;
        const int n = count(l, t, step, largest);
        for (int k = 0; k < lanes && n != (inside ? lanes : 0); k++) {
            const double here = t + k * step;
            if ((n != 0 && largest[k] <= l.bound) != inside) {
                double lo = k ? t + (k - 1) * step : last, hi = here, unused;
                const change bracket = {lo, hi, 0, inside};
                for (double m; (m = lo + (hi - lo) / 2) > lo && m < hi;)
                    ((one(l, m, 0, &unused) != 0) == inside ? lo : hi) = m;
                found.push_back({bracket.lo, bracket.hi, hi, inside});
                if (first_only) return found;
                inside = !inside;
            }
        }
        last = t + (lanes - 1) * step;
    }
    return found;
}

// ------------------------------------------------------------ in 113 bits

class exact_line {
public:
  exact_line(const level_set &s, const ray &r)
      : mandelbrot_(s.mandelbrot), power_(s.power), levels_(s.iterations - s.mandelbrot),
        bound_(quad(s.escape) * s.escape)
  {
      for (std::size_t i = 0; i < 4; i++) {
          c_[i] = s.c[i];
          start_[i] = quad(s.at[i]) + quad(r.o.x) * s.axis[0][i] + quad(r.o.y) * s.axis[1][i] +
                      quad(r.o.z) * s.axis[2][i];
          slope_[i] = quad(r.d.x) * s.axis[0][i] + quad(r.d.y) * s.axis[1][i] + quad(r.d.z) * s.axis[2][i];
      }
    }

    // |Q_N|^2 / E^2 - 1, or that of the first Q_k beyond E: of F's sign.
    quad excess(quad t) const
    {
        quad q[4], c[4];
        for (int i = 0; i < 4; i++) {
            q[i] = start_[i] + t * slope_[i];
            c[i] = mandelbrot_ ? q[i] : c_[i];
        }
        for (int k = 0;; k++) {
            const quad size = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
            if (size > bound_ || k == levels_) return size / bound_ - 1;
            quad p[4] = {q[0] * q[0] - (size - q[0] * q[0]), 2 * q[0] * q[1], 2 * q[0] * q[2],
                         2 * q[0] * q[3]};
            for (int n = 2; n < power_; n++) {
                const quad w = p[0] * q[0] - p[1] * q[1] - p[2] * q[2] - p[3] * q[3];
                const quad x = p[0] * q[1] + p[1] * q[0] + p[2] * q[3] - p[3] * q[2];
                const quad y = p[0] * q[2] - p[1] * q[3] + p[2] * q[0] + p[3] * q[1];
                const quad z = p[0] * q[3] + p[1] * q[2] - p[2] * q[1] + p[3] * q[0];
                p[0] = w, p[1] = x, p[2] = y, p[3] = z;
            }
            for (int i = 0; i < 4; i++) q[i] = p[i] + c[i];
        }
    }
    bool is_inside(quad t) const { return excess(t) <= 0; }

    // Does F change sign in [lo, hi], as far as 64 steps tell?
    bool changes_within(quad lo, quad hi) const
    {
        const bool inside = is_inside(lo);
        for (int i = 1; i <= 64; i++)
            if (is_inside(lo + (hi - lo) * i / 64) != inside) return true;
        return false;
    }

    // The root that bisection finds between two points of different sign.
    quad root(quad lo, quad hi) const
    {
        const bool inside = is_inside(lo);
        for (int i = 0; i < 90; i++) {
            const quad m = (lo + hi) / 2;
            (is_inside(m) == inside ? lo : hi) = m;
        }
        return (lo + hi) / 2;
    }

private:
    bool mandelbrot_;
    int power_, levels_;
    quad bound_, c_[4], start_[4], slope_[4];
};

} // namespace brute
#endif
