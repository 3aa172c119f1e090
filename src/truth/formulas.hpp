// SPDX-License-Identifier: MIT
// formulas.hpp - F of each built-in surface by its definition in surfaces.h, for any type of number; a row
// for each type.
//
// The command's trade measures errors by it, and the oracles of tests/ judge the library by it.  It shares no
// code and no method with the library: where the library has a recurrence, here is the explicit sum, product
// or root.  Digits are lost so, which is why the numbers have 113 bits.
//
//   conic, sags on it   ISO 10110-12, in the form that is finite for c = 0
//   toroid, biconic     ISO 10110-12 as well, by their two curvatures
//   Chebyshev   T_n(u) = Re (u + i sqrt(1 - u^2))^n; beyond 1 the same with a real root (Mason and
//               Handscomb 2002, 1.2)
//   Zernike     R(rho) = sum of (-1)^k C(n - k, k) C(n - 2k, (n - m)/2 - k) rho^(n - 2k): equation 1 of Noll
//               (1976) with its factorials as binomials; rho^m cos(m theta) = Re (x + i y)^m
//   Q_con       P_m^(0,4)(2x - 1) = sum of C(m, s) C(m + 4, s) (x - 1)^s x^(m - s) (Szego 1939, 4.3.2)
//   Q_bfs       orthogonal in slope (Forbes 2007, section 3): take the derivatives by u of
//               u^2 (1 - u^2) Q(u^2).  The mean of the product of two of them, weighted by 1 / sqrt(1 - u^2),
//               is 1 for the same Q and 0 for different Q.  Found by Gram and Schmidt from x Q.  The mean is
//               taken over points equally spaced in the arc sine of u, for which it is exact
//   grid        the sum of heights times Keys' (1981) kernel; heights beyond the border by his equation 25
//   level sets  the orbit Q -> Q^p + c by its definition, with full quaternion products (Norton 1982)
//
// Parameters are in the order in which surfaces.h numbers them for sensitivities, and of the same type of
// number as the point.  So a `dual` for a parameter gives the derivative by it, and a dual of duals gives the
// mixed ones.  The numbers of a level set, which has no such derivatives, are read from its struct.
//
// To add a type: FORMULA in its row of types.def.  A formula that does not fit there is written here: its
// parameters, its formula, and a row in `rows`, which comes before what types.def says.
#ifndef TRUTH_FORMULAS_HPP
#define TRUTH_FORMULAS_HPP
#include "orbit.hpp"
#include "quad.hpp"

#include <sagitta/surfaces.h>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace catalogue {

using oracle::quad;
using oracle::square_root;

// ------------------------------------------------------------------ numbers

// A constant known to 113 bits times a number.
inline double times(quad c, double x) { return oracle::to_double(c) * x; }
inline quad times(quad c, quad x) { return c * x; }

// A number and its derivatives by N others (Clifford's dual numbers).
template <class T, int N> struct dual {
    T a, v[N];
    dual() : a(0) { std::fill(v, v + N, T(0)); }
    template <class S, class = typename std::enable_if<std::is_convertible<S, T>::value>::type>
    dual(const S &s) : a(s)
    {
        std::fill(v, v + N, T(0));
    }
    static dual variable(const T &s, int i)
    {
        dual x(s);
        x.v[i] = T(1);
        return x;
    }
    dual operator-() const
    {
        dual r;
        r.a = -a;
        for (int i = 0; i < N; i++) r.v[i] = -v[i];
        return r;
    }
    friend dual operator+(dual x, const dual &y)
    {
        x.a = x.a + y.a;
        for (int i = 0; i < N; i++) x.v[i] = x.v[i] + y.v[i];
        return x;
    }
    friend dual operator-(const dual &x, const dual &y) { return x + -y; }
    friend dual operator*(const dual &x, const dual &y)
    {
        dual r;
        r.a = x.a * y.a;
        for (int i = 0; i < N; i++) r.v[i] = x.a * y.v[i] + x.v[i] * y.a;
        return r;
    }
    friend dual operator*(const dual &x, quad y)
    {
        dual r;
        r.a = times(y, x.a);
        for (int i = 0; i < N; i++) r.v[i] = times(y, x.v[i]);
        return r;
    }
    friend dual operator/(const dual &x, const dual &y)
    {
        dual r;
        r.a = x.a / y.a;
        for (int i = 0; i < N; i++) r.v[i] = (x.v[i] - r.a * y.v[i]) / y.a;
        return r;
    }
    friend bool operator>(const dual &x, double y) { return x.a > y; }
};

template <class T, int N> dual<T, N> square_root(const dual<T, N> &x)
{
    dual<T, N> r;
    r.a = square_root(x.a);
    for (int i = 0; i < N; i++) r.v[i] = x.v[i] / (r.a + r.a);
    return r;
}

inline double plain(double x) { return x; }
inline double plain(quad x) { return oracle::to_double(x); }
template <class T, int N> double plain(const dual<T, N> &x) { return plain(x.a); }

// Are the number and its derivatives 0?  A term with it is left out.
inline bool nothing(double x) { return x == 0; }
inline bool nothing(quad x) { return x == 0; }
template <class T, int N> bool nothing(const dual<T, N> &x)
{
    for (int i = 0; i < N; i++)
        if (!nothing(x.v[i])) return false;
    return nothing(x.a);
}
template <class T> bool nothing(const T &) { return false; } // numbers of other libraries

template <class T, int N> dual<T, N> times(quad c, const dual<T, N> &x) { return x * c; }
template <class T> T times(quad c, const T &x) { return x * T(oracle::to_double(c)); } // of other libraries

template <class T> T power(const T &x, int n)
{
    T result(1.0), square = x;
    for (; n > 0; n >>= 1) {
        if (n & 1) result = result * square;
        if (n > 1) square = square * square;
    }
    return result;
}

template <class T> struct complex {
    T re, im;
    friend complex operator*(const complex &x, const complex &y)
    {
        return {x.re * y.re - x.im * y.im, x.re * y.im + x.im * y.re};
    }
};

inline quad binomial(int n, int k)
{
    if (k < 0 || k > n) return 0;
    quad b = 1;
    for (int i = 1; i <= k; i++) b = b * (n - k + i) / i; // each is an integer
    return b;
}

// By its series, for |x| <= pi / 2.
inline quad sine(quad x)
{
    quad sum = 0, term = x;
    for (int i = 1; i < 60; i++) {
        sum += term;
        term *= -x * x / ((2 * i) * (2 * i + 1));
    }
    return sum;
}
inline quad half_pi()
{
    return quad(0x1.921fb54442d18p0) + quad(0x1.1a62633145c07p-54) + quad(-0x1.f1976b7ed8fbcp-110);
}

// -------------------------------------------------------------------- conic

template <class T> T conic_sag(const T &c, const T &k, const T &r2)
{
    return c * r2 / (T(1.0) + square_root(T(1.0) - (T(1.0) + k) * c * c * r2));
}

// --------------------------------------------------------------- polynomials

// T_0 ... T_(n - 1) at u.
template <class T> std::vector<T> chebyshev_at(const T &u, int n)
{
    std::vector<T> result;
    const T beside = T(1.0) - u * u;
    if (plain(beside) >= 0) {
        const complex<T> w = {u, square_root(beside)};
        complex<T> turned = {T(1.0), T(0.0)};
        for (int i = 0; i < n; i++, turned = turned * w) result.push_back(turned.re);
        return result;
    }
    const T root = square_root(-beside), up = u + root, down = u - root;
    for (int i = 0; i < n; i++) result.push_back((power(up, i) + power(down, i)) / T(2.0));
    return result;
}

// (n, m); m < 0: a sine.
inline std::pair<int, int> noll(int j)
{
    for (int n = 0, at = 1;; n++)
        for (int m = n % 2; m <= n; m += 2) {
            if (m == 0) {
                if (at++ == j) return {n, 0};
                continue;
            }
            for (int i = 0; i < 2; i++, at++)
                if (at == j) return {n, at % 2 == 0 ? m : -m};
        }
}

inline std::pair<int, int> fringe(int j)
{
    for (int half = 0, at = 1;; half++) // (n + m) / 2
        for (int m = half; m >= 0; m--) {
            const int n = 2 * half - m;
            if (at++ == j) return {n, m};
            if (m > 0 && at++ == j) return {n, -m};
        }
}

// The factors of rho^m rho2^i, i = 0 ... (n - m) / 2.
inline const std::vector<quad> &radial(int n, int m)
{
    static std::map<std::pair<int, int>, std::vector<quad>> known;
    std::vector<quad> &c = known[{n, m}];
    if (c.empty()) {
        const int most = (n - m) / 2;
        for (int i = 0; i <= most; i++) {
            const int k = most - i;
            c.push_back((k % 2 ? -1 : 1) * binomial(n - k, k) * binomial(n - 2 * k, most - k));
        }
    }
    return c;
}

inline quad zernike_norm(int n, int m, int normalised)
{
    return !normalised ? quad(1) : square_root(m == 0 ? quad(n + 1) : quad(2 * n + 2));
}

// x and y in units of norm.
template <class T> T zernike_at(int n, int m, const T &x, const T &y)
{
    const int order = std::abs(m);
    const T rho2 = x * x + y * y;
    complex<T> turned = {T(1.0), T(0.0)};
    for (int i = 0; i < order; i++) turned = turned * complex<T>{x, y};
    T sum(0.0), up(1.0);
    for (quad c : radial(n, order)) {
        sum = sum + times(c, up);
        up = up * rho2;
    }
    return sum * (m < 0 ? turned.im : turned.re);
}

// The sum of a[j - 1] Z_j; powers that the terms share are computed once.
template <class T> T zernike_sum(const sgt_zernike &s, const T *a, const T &x, const T &y)
{
    const int terms = static_cast<int>(s.a.rows * s.a.columns);
    std::vector<complex<T>> turned = {{T(1.0), T(0.0)}};
    std::vector<T> up = {T(1.0)};
    const T rho2 = x * x + y * y;
    T total(0.0);
    for (int j = 1; j <= terms; j++) {
        static std::vector<std::pair<int, int>> index[2];
        std::vector<std::pair<int, int>> &known = index[s.order == SGT_FRINGE];
        while (static_cast<int>(known.size()) < j) {
            const int next = static_cast<int>(known.size()) + 1;
            known.push_back(s.order == SGT_FRINGE ? fringe(next) : noll(next));
        }
        if (nothing(a[j - 1])) continue;
        const int n = known[static_cast<std::size_t>(j - 1)].first,
                  m = known[static_cast<std::size_t>(j - 1)].second, order = std::abs(m);
        while (static_cast<int>(turned.size()) <= order) turned.push_back(turned.back() * complex<T>{x, y});
        const std::vector<quad> &c = radial(n, order);
        while (up.size() < c.size()) up.push_back(up.back() * rho2);
        T sum(0.0);
        for (std::size_t i = 0; i < c.size(); i++) sum = sum + times(c[i], up[i]);
        const complex<T> &w = turned[static_cast<std::size_t>(order)];
        total = total + times(zernike_norm(n, m, s.normalised), a[j - 1] * sum * (m < 0 ? w.im : w.re));
    }
    return total;
}

// C(m, s) C(m + 4, s), s = 0 ... m.
inline const std::vector<quad> &q_con_factors(int m)
{
    static std::map<int, std::vector<quad>> known;
    std::vector<quad> &c = known[m];
    for (int s = 0; c.size() <= static_cast<std::size_t>(m); s++)
        c.push_back(binomial(m, s) * binomial(m + 4, s));
    return c;
}

// From the powers of x - 1 and of x.
template <class T> T q_con_of(int m, const std::vector<T> &less, const std::vector<T> &of_x)
{
    const std::vector<quad> &c = q_con_factors(m);
    T sum(0.0);
    for (std::size_t s = 0; s < c.size(); s++) sum = sum + times(c[s], less[s] * of_x[c.size() - 1 - s]);
    return sum;
}

template <class T> std::vector<T> powers(const T &x, std::size_t n)
{
    std::vector<T> p = {T(1.0)};
    while (p.size() < n) p.push_back(p.back() * x);
    return p;
}

template <class T> T q_con_at(int m, const T &x)
{
    const std::size_t n = static_cast<std::size_t>(m) + 1;
    return q_con_of(m, powers(T(x - T(1.0)), n), powers(x, n));
}

// Q_bfs: the next one is (-x Q_m - sum of along[m][j] Q_j) / size[m].
class slopes {
public:
    static const slopes &up_to(int most)
    {
        static slopes known;
        known.extend(most);
        return known;
    }
    template <class T> std::vector<T> at(const T &x, int n) const
    {
        std::vector<T> q = {T(1.0)};
        for (std::size_t m = 0; static_cast<int>(q.size()) < n; m++) {
            T next = -x * q[m];
            for (std::size_t j = 0; j <= m; j++) next = next - times(along_[m][j], q[j]);
            q.push_back(times(1 / size_[m], next));
        }
        return q;
    }

private:
    enum { points = 160 }; // on the quarter circle: the mean is exact up to degree 640
    std::vector<std::vector<quad>> along_, value_, by_x_;
    std::vector<quad> size_, u_;

    quad slope(std::size_t i, quad q, quad dq) const // d/du of (x - x^2) Q(x), x = u^2
    {
        const quad u = u_[i], x = u * u;
        return 2 * u * ((1 - 2 * x) * q + (x - x * x) * dq);
    }
    quad mean(const std::vector<quad> &q, const std::vector<quad> &dq, const std::vector<quad> &r,
              const std::vector<quad> &dr) const
    {
        quad sum = 0;
        for (std::size_t i = 0; i < points; i++) sum += slope(i, q[i], dq[i]) * slope(i, r[i], dr[i]);
        return sum / static_cast<int>(points);
    }
    void extend(int most)
    {
        if (u_.empty()) {
            for (int i = 0; i < points; i++) u_.push_back(sine(half_pi() * (2 * i + 1) / (2 * points)));
            value_.push_back(std::vector<quad>(points, quad(1)));
            by_x_.push_back(std::vector<quad>(points, quad(0)));
        }
        while (static_cast<int>(value_.size()) < most) {
            const std::size_t m = value_.size() - 1;
            std::vector<quad> q(points), dq(points), along(m + 1, quad(0));
            for (std::size_t i = 0; i < points; i++) {
                const quad x = u_[i] * u_[i];
                q[i] = -x * value_[m][i];
                dq[i] = -value_[m][i] - x * by_x_[m][i];
            }
            for (int twice = 0; twice < 2; twice++)
                for (std::size_t j = 0; j <= m; j++) {
                    const quad part = mean(q, dq, value_[j], by_x_[j]);
                    along[j] += part;
                    for (std::size_t i = 0; i < points; i++)
                        q[i] -= part * value_[j][i], dq[i] -= part * by_x_[j][i];
                }
            const quad size = square_root(mean(q, dq, q, dq));
            for (std::size_t i = 0; i < points; i++) q[i] /= size, dq[i] /= size;
            along_.push_back(along);
            size_.push_back(size);
            value_.push_back(q);
            by_x_.push_back(dq);
        }
    }
};

// Keys' kernel of a = -1/2.
template <class T> T keys(const T &at)
{
    const T s = plain(at) < 0 ? -at : at;
    if (plain(s) <= 1) return (T(1.5) * s - T(2.5)) * s * s + T(1.0);
    if (plain(s) < 2) return ((T(-0.5) * s + T(2.5)) * s - T(4.0)) * s + T(2.0);
    return T(0.0);
}

// The height at i and j, which may be one beyond the grid.
inline quad height(const sgt_numbers &z, long i, long j)
{
    const long rows = static_cast<long>(z.rows), columns = static_cast<long>(z.columns);
    if (i < 0) return 3 * height(z, 0, j) - 3 * height(z, 1, j) + height(z, 2, j);
    if (i >= rows) return 3 * height(z, rows - 1, j) - 3 * height(z, rows - 2, j) + height(z, rows - 3, j);
    if (j < 0) return 3 * height(z, i, 0) - 3 * height(z, i, 1) + height(z, i, 2);
    if (j >= columns)
        return 3 * height(z, i, columns - 1) - 3 * height(z, i, columns - 2) + height(z, i, columns - 3);
    return z.x[i * columns + j];
}

template <class T> T grid_at(const sgt_grid &s, const T &x, const T &y)
{
    const long rows = static_cast<long>(s.z.rows), columns = static_cast<long>(s.z.columns);
    const T u = x / T(s.step_x) + T(0.5 * static_cast<double>(columns - 1)),
            v = y / T(s.step_y) + T(0.5 * static_cast<double>(rows - 1));
    if (!(plain(u) >= 0 && plain(u) <= static_cast<double>(columns - 1) && plain(v) >= 0 &&
          plain(v) <= static_cast<double>(rows - 1)))
        return T(static_cast<double>(NAN));
    const long i0 = std::min(static_cast<long>(plain(v)), rows - 2),
               j0 = std::min(static_cast<long>(plain(u)), columns - 2);
    T sum(0.0);
    for (long i = i0 - 1; i <= i0 + 2; i++) {
        T row(0.0);
        for (long j = j0 - 1; j <= j0 + 2; j++)
            row = row + times(height(s.z, i, j), keys(u - T(static_cast<double>(j))));
        sum = sum + row * keys(v - T(static_cast<double>(i)));
    }
    return sum;
}

// ---------------------------------------------------------------- departures
//
// P(x, y) of a sag on a conic base of curvature c; a: its own parameters.

inline std::size_t count_of(const sgt_numbers &a) { return a.rows * a.columns; }
inline void append(std::vector<double> *p, const double *x, std::size_t n) { p->insert(p->end(), x, x + n); }
inline void append(std::vector<double> *p, const sgt_numbers &a) { append(p, a.x, count_of(a)); }
template <class S> const S &as(const void *self) { return *static_cast<const S *>(self); }

template <class T> T no_departure(const void *, const T &, const T *, const T &, const T &) { return T(0.0); }

template <class T> T even_departure(const void *, const T &, const T *a, const T &x, const T &y)
{
    const T r2 = x * x + y * y;
    T sum(0.0);
    for (int i = 0; i < 8; i++) sum = sum + a[i] * power(r2, i + 1);
    return sum;
}

// On the axis r has no derivative.  There odd powers of r are left out, even for a cone, as in surfaces.h.
template <class T> T odd_departure(const void *, const T &, const T *a, const T &x, const T &y)
{
    const T r2 = x * x + y * y;
    T sum(0.0);
    bool odd = false;
    for (int i = 0; i < 16; i += 2) odd = odd || !nothing(a[i]);
    for (int i = 1; i < 16; i += 2) sum = sum + a[i] * power(r2, (i + 1) / 2);
    if (!odd || plain(r2) == 0) return sum;
    const T r = square_root(r2);
    for (int i = 0; i < 16; i += 2) sum = sum + a[i] * r * power(r2, i / 2);
    return sum;
}

template <class T> T polynomial_departure(const void *self, const T &, const T *a, const T &x, const T &y)
{
    const sgt_polynomial_xy &s = as<sgt_polynomial_xy>(self);
    std::vector<T> xs, ys;
    T sum(0.0);
    for (std::size_t i = 0; i < s.a.rows; i++) xs.push_back(power(x, static_cast<int>(i)));
    for (std::size_t j = 0; j < s.a.columns; j++) ys.push_back(power(y, static_cast<int>(j)));
    for (std::size_t i = 0; i < s.a.rows; i++)
        for (std::size_t j = 0; j < s.a.columns; j++)
            if (!nothing(a[i * s.a.columns + j])) sum = sum + a[i * s.a.columns + j] * xs[i] * ys[j];
    return sum;
}

template <class T> T chebyshev_departure(const void *self, const T &, const T *a, const T &x, const T &y)
{
    const sgt_chebyshev &s = as<sgt_chebyshev>(self);
    T sum(0.0);
    if (!count_of(s.a)) return sum;
    const std::vector<T> u = chebyshev_at(T(x / T(s.norm_x)), static_cast<int>(s.a.rows));
    const std::vector<T> v = chebyshev_at(T(y / T(s.norm_y)), static_cast<int>(s.a.columns));
    for (std::size_t i = 0; i < s.a.rows; i++) {
        T row(0.0);
        for (std::size_t j = 0; j < s.a.columns; j++)
            if (!nothing(a[i * s.a.columns + j])) row = row + a[i * s.a.columns + j] * v[j];
        if (!nothing(row)) sum = sum + u[i] * row;
    }
    return sum;
}

template <class T> T zernike_departure(const void *self, const T &, const T *a, const T &x, const T &y)
{
    const sgt_zernike &s = as<sgt_zernike>(self);
    return count_of(s.a) ? zernike_sum(s, a, T(x / T(s.norm)), T(y / T(s.norm))) : T(0.0);
}

template <class T> T q_con_departure(const void *self, const T &, const T *a, const T &x, const T &y)
{
    const sgt_q_con &s = as<sgt_q_con>(self);
    T sum(0.0);
    if (!count_of(s.a)) return sum;
    const T u2 = (x * x + y * y) / (T(s.norm) * T(s.norm));
    const std::vector<T> less = powers(T(u2 - T(1.0)), count_of(s.a)), of_u2 = powers(u2, count_of(s.a));
    for (std::size_t m = 0; m < count_of(s.a); m++)
        if (!nothing(a[m])) sum = sum + a[m] * q_con_of(static_cast<int>(m), less, of_u2);
    return u2 * u2 * sum;
}

template <class T> T q_bfs_departure(const void *self, const T &c, const T *a, const T &x, const T &y)
{
    const sgt_q_bfs &s = as<sgt_q_bfs>(self);
    T sum(0.0);
    const T r2 = x * x + y * y, u2 = r2 / (T(s.norm) * T(s.norm)), root = square_root(T(1.0) - c * c * r2);
    if (!count_of(s.a)) return sum / root; // NaN where the conic ends, too
    const int n = static_cast<int>(count_of(s.a));
    const std::vector<T> q = slopes::up_to(n).at(u2, n);
    for (std::size_t m = 0; m < count_of(s.a); m++) sum = sum + a[m] * q[m];
    return u2 * (T(1.0) - u2) * sum / root;
}

template <class T> T grid_departure(const void *self, const T &, const T *, const T &x, const T &y)
{
    const sgt_grid &s = as<sgt_grid>(self);
    return count_of(s.z) ? grid_at(s, x, y) : T(0.0);
}

template <class T>
T sum_departure(const void *self, const T &, const T *a, const T &x, const T &y); // below the rows

// ---------------------------------------------------------------- other sags

template <class T> T toroidal_sag(const void *, const T &, const T *p, const T &x, const T &y)
{
    T profile = conic_sag(p[0], p[1], T(y * y));
    for (int i = 0; i < 8; i++) profile = profile + p[3 + i] * power(T(y * y), i + 1);
    const T q = T(1.0) - p[2] * profile;
    if (!(plain(q) > 0)) return T(static_cast<double>(NAN));
    return profile + p[2] * x * x / (q + square_root(q * q - p[2] * p[2] * x * x));
}

template <class T> T biconic_sag(const void *, const T &, const T *p, const T &x, const T &y)
{
    const T one(1.0);
    return (p[0] * x * x + p[2] * y * y) /
           (one + square_root(one - (one + p[1]) * p[0] * p[0] * x * x - (one + p[3]) * p[2] * p[2] * y * y));
}

// -------------------------------------------------------------------- bodies

template <class T> T quadric_level(const void *, const T *p, const T &x, const T &y, const T &z)
{
    return p[0] * x * x + p[1] * y * y + p[2] * z * z + p[3] * x * y + p[4] * y * z + p[5] * x * z +
           p[6] * x + p[7] * y + p[8] * z + p[9];
}

template <class T> T ellipsoid_level(const void *, const T *p, const T &x, const T &y, const T &z)
{
    const T one(1.0), b = p[0] * (one - p[1]);
    return ((x * x + y * y) / (p[0] * p[0]) + z * z / (b * b) - one) * p[0] / T(2.0);
}

// ((rho - R)^2 + z^2 - r^2) / (2 r); for a spindle the quartic over 8 r R (R + r).
template <class T> T torus_level(const void *, const T *p, const T &x, const T &y, const T &z)
{
    const T r2 = x * x + y * y;
    if (plain(p[1]) <= plain(p[0])) {
        const T off = square_root(r2) - p[0];
        return (off * off + z * z - p[1] * p[1]) / (p[1] + p[1]);
    }
    const T w = r2 + z * z + p[0] * p[0] - p[1] * p[1];
    return (w * w - T(4.0) * p[0] * p[0] * r2) / (T(8.0) * p[0] * p[1] * (p[0] + p[1]));
}

// ---------------------------------------------------------------- level sets

// The root of x^p = x + |c|; for a mandelbrot, where |c| = |x|, of x^p = 2 x.  By Newton from above, since
// both are convex there.
inline quad safe_escape(quad c, int p, bool mandelbrot)
{
    quad x = 3 + c, next = 2 + c;
    while (next < x) {
        x = next;
        const quad g = power(x, p) - (mandelbrot ? 2 * x : x + c),
                   slope = p * power(x, p - 1) - (mandelbrot ? 2 : 1);
        next = x - g / slope;
    }
    return x;
}

using oracle::constant;
using oracle::quaternion;

// F = (u - 1) / (u + 1), u = |Q_N|^2 / E^2.  c NULL: a mandelbrot; c is the point, and the orbit starts at 0.
template <class T, class S> T level_set(const S &s, const double *c, const T &x, const T &y, const T &z)
{
    static const double own[3][4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}};
    const double *axis[3] = {s.ex, s.ey, s.ez};
    bool given = false;
    for (const double *e : axis) given = given || e[0] != 0 || e[1] != 0 || e[2] != 0 || e[3] != 0;
    for (int i = 0; i < 3 && !given; i++) axis[i] = own[i];
    static const double zero[4] = {0, 0, 0, 0};
    const quaternion<T> at = constant<T>(s.at) + x * constant<T>(axis[0]) + y * constant<T>(axis[1]) +
                             z * constant<T>(axis[2]);
    const quaternion<T> start = c ? at : constant<T>(zero), by = c ? constant<T>(c) : at;
    const int power = s.power ? s.power : 2, iterations = s.iterations ? s.iterations : 10;
    quad size = 0;
    for (int i = 0; c && i < 4; i++) size += quad(c[i]) * c[i];
    const quad escape = s.escape != 0 ? quad(s.escape) : safe_escape(square_root(size), power, !c);
    int n;
    const quaternion<T> q = oracle::orbit(start, by, power, iterations, 1e30, &n);
    const T u = times(1 / (escape * escape), oracle::dot(q, q));
    return (u - T(1.0)) / (u + T(1.0));
}

template <class T> T julia_level(const void *self, const T *, const T &x, const T &y, const T &z)
{
    return level_set(as<sgt_julia>(self), as<sgt_julia>(self).c, x, y, z);
}

template <class T> T mandelbrot_level(const void *self, const T *, const T &x, const T &y, const T &z)
{
    return level_set(as<sgt_mandelbrot>(self), static_cast<const double *>(nullptr), x, y, z);
}

// ------------------------------------------------------------------ the rows

template <class T> struct row {
    const sgt_surface_ops *ops;
    // how many numbers of a conic base come first in the struct: 2; Q_bfs: 1 (k = 0); 0: no base
    int base;
    T (*sag)
    (const void *self, const T &c, const T *a, const T &x,
     const T &y); // without the base; NULL: it has a level
    T (*level)(const void *self, const T *p, const T &x, const T &y, const T &z);
};

// What types.def says.  Of a type that has a row below it is not asked.
#define SAYS(text) T(static_cast<double>(NAN))
#define FORMULA(...) (__VA_ARGS__)
#define TYPE(KIND, type, NAME, file, formula, ...)                                                      \
    template <class T> T type##_listed(const void *self, const T &, const T *p, const T &x, const T &y) \
    {                                                                                                   \
        const sgt_##NAME &s = as<sgt_##NAME>(self);                                                     \
        static_cast<void>(s), static_cast<void>(p), static_cast<void>(x), static_cast<void>(y);         \
        return formula;                                                                                 \
    }
#include "../types.def"
#undef TYPE

// The row of a surface's type; NULL: there is none.
template <class T> const row<T> *row_of(const sgt_surface &s)
{
    static const row<T> rows[] = {
        {&sgt_conic_ops, 2, no_departure<T>, nullptr}, // plane and sphere are conics
        {&sgt_even_asphere_ops, 2, even_departure<T>, nullptr},
        {&sgt_odd_asphere_ops, 2, odd_departure<T>, nullptr},
        {&sgt_polynomial_xy_ops, 2, polynomial_departure<T>, nullptr},
        {&sgt_chebyshev_ops, 2, chebyshev_departure<T>, nullptr},
        {&sgt_zernike_ops, 2, zernike_departure<T>, nullptr},
        {&sgt_q_con_ops, 2, q_con_departure<T>, nullptr},
        {&sgt_q_bfs_ops, 1, q_bfs_departure<T>, nullptr},
        {&sgt_grid_ops, 2, grid_departure<T>, nullptr},
        {&sgt_sum_ops, 2, sum_departure<T>, nullptr},
        {&sgt_toroidal_ops, 0, toroidal_sag<T>, nullptr},
        {&sgt_biconic_ops, 0, biconic_sag<T>, nullptr}, // a cylinder is one
        {&sgt_quadric_ops, 0, nullptr, quadric_level<T>},
        {&sgt_ellipsoid_ops, 0, nullptr, ellipsoid_level<T>},
        {&sgt_torus_ops, 0, nullptr, torus_level<T>},
        {&sgt_julia_ops, 0, nullptr, julia_level<T>},
        {&sgt_mandelbrot_ops, 0, nullptr, mandelbrot_level<T>},
#define TYPE(KIND, type, NAME, ...) {&sgt_##NAME##_ops, 2, type##_listed<T>, nullptr},
#include "../types.def"
#undef TYPE
    };
    for (const row<T> &r : rows)
        if (r.ops == s.ops) return &r;
    return nullptr;
}

// The parameters after those of the base, or all if there is no base; of a sum those of each term in turn.
inline std::vector<double> parameters_beyond_base(const sgt_surface &s)
{
    std::vector<double> p;
    const row<double> *r = row_of<double>(s);
    const sgt_builtin *b = sgt_builtins();
    while (b->ops != s.ops) b++;
    for (const sgt_param *of = b->params; of->name && b->family != SGT_FAMILY_LEVEL_SET; of++) {
        const std::string key = of->name;
        if (key == "semi_diameter" || key == "sag" || !key.compare(0, 4, "norm") ||
            !key.compare(0, 4, "step") || (r->base > 0 && (key == "curvature" || key == "conic")))
            continue;
        const void *at = static_cast<const char *>(s.self) + of->offset;
        if (of->kind == SGT_PARAM_REAL || of->kind == SGT_PARAM_VECTOR)
            append(&p, static_cast<const double *>(at), static_cast<std::size_t>(of->count));
        if (of->kind == SGT_PARAM_LIST || of->kind == SGT_PARAM_TABLE)
            append(&p, *static_cast<const sgt_numbers *>(at));
        if (of->kind != SGT_PARAM_TERMS) continue;
        for (std::size_t i = 0; i < as<sgt_sum>(s.self).count; i++) {
            const std::vector<double> own = parameters_beyond_base(as<sgt_sum>(s.self).terms[i]);
            append(&p, own.data(), own.size());
        }
    }
    return p;
}

// A term's base is not used, except for the c in the root of a Q_bfs.
template <class T> T sum_departure(const void *self, const T &, const T *a, const T &x, const T &y)
{
    const sgt_sum &s = as<sgt_sum>(self);
    T sum(0.0);
    for (std::size_t i = 0; i < s.count; i++) {
        const row<T> *term = row_of<T>(s.terms[i]);
        const T c(term->base == 1 ? *static_cast<const double *>(s.terms[i].self) : 0);
        sum = sum + term->sag(s.terms[i].self, c, a, x, y);
        a += parameters_beyond_base(s.terms[i]).size();
    }
    return sum;
}

// ------------------------------------------------------------------------- F

inline std::vector<double> parameters_of(const sgt_surface &s)
{
    std::vector<double> p;
    if (const row<double> *r = row_of<double>(s)) {
        const std::vector<double> more = parameters_beyond_base(s);
        append(&p, static_cast<const double *>(s.self), static_cast<std::size_t>(r->base));
        append(&p, more.data(), more.size());
    }
    return p;
}

// Is the surface a sag on a conic base?
inline bool base_of(const sgt_surface &s)
{
    const row<double> *r = row_of<double>(s);
    return r && r->base > 0;
}

// NaN where it is not defined.
template <class T> T level(const sgt_surface &s, const T *p, const T &x, const T &y, const T &z)
{
    const row<T> *r = row_of<T>(s);
    if (!r) return T(static_cast<double>(NAN));
    if (r->level) return r->level(s.self, p, x, y, z);
    const T c = r->base > 0 ? p[0] : T(0.0), sag = r->sag(s.self, c, p + r->base, x, y);
    return r->base > 0 ? z - (conic_sag(c, r->base > 1 ? p[1] : T(0.0), x * x + y * y) + sag) : z - sag;
}

// A function with the same zeros that is smooth where a conic base ends: with w = z - P it is
// w - (c r^2 + (1 + k) c w^2) / 2, a polynomial in w.  (It is zero on the other sheet of the base too.)
// Without a conic base of two numbers it is F.
template <class T> T smooth_level(const sgt_surface &s, const T *p, const T &x, const T &y, const T &z)
{
    const row<T> *r = row_of<T>(s);
    if (!r || r->base < 2) return level(s, p, x, y, z);
    const T w = z - r->sag(s.self, p[0], p + 2, x, y);
    return w - p[0] * (x * x + y * y + (T(1.0) + p[1]) * w * w) / T(2.0);
}

// The same with the parameters stored in the surface.
template <class T> struct formula {
    sgt_surface surface;
    std::vector<T> p;
    explicit formula(const sgt_surface &s) : surface(s)
    {
        for (double x : parameters_of(s)) p.push_back(T(x));
    }
    T operator()(const T &x, const T &y, const T &z) const { return level(surface, p.data(), x, y, z); }
    T smooth(const T &x, const T &y, const T &z) const { return smooth_level(surface, p.data(), x, y, z); }
};

} // namespace catalogue
#endif
