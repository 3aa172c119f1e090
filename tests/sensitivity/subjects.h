// SPDX-License-Identifier: MIT
// subjects.h - random surfaces for the tests of sensitivities, each with its formula once more, for numbers
// of any kind.
//
// A subject has
//     surface()      what the library is asked;
//     parameters()   where each parameter is kept, in the order of surfaces.h, so that a test can change
//                    it, and how much
//                    of it moves the surface by about a length where it is met;
//     formula(a, x, y, z)   F for parameters and points of type T; written from the definition in
//                           surfaces.h, by powers
//                    and explicit polynomials where the library has recurrences;
//     ray(g)         one that meets it well, as a rule;
//     near(p)        whether it has: not near the edge of its domain, nor out where high powers rule.
// To add one: a class, and a line in each_subject.
#ifndef SENSITIVITY_SUBJECTS_H
#define SENSITIVITY_SUBJECTS_H

#include "../oracle/cases.h"

#include <sagitta/sensitivity.h>
#include <sagitta/surfaces.h>

#include <vector>

namespace subjects {

using oracle::generator;

struct parameter { double *at, unit; };

constexpr double REACH = 4; // rays are aimed at points of a sag with |x|, |y| < 0.7 of it

inline bool near_sag(const sgt_vec3 &p) { return std::hypot(p.x, p.y) < REACH; }

// Aimed at a random point of a sag, from either side, with a direction of any length.
inline sgt_ray ray_to_sag(generator &g)
{
    const double x = g.uniform(-0.7, 0.7) * REACH, y = g.uniform(-0.7, 0.7) * REACH, l = g.uniform(-0.5, 0.5),
                 m = g.uniform(-0.5, 0.5);
    const double length = g.log_uniform(0.3, 3), way = g.sign(), far = g.uniform(2, 20);
    return {{x - far * l * way, y - far * m * way, -far * way},
            {l * length * way, m * length * way, length * way},
            0,
            0};
}

// From outside toward a point of a body about the origin.
inline sgt_ray ray_to_body(generator &g, double radius, double inside)
{
    sgt_vec3 at, from;
    do from = {g.uniform(-1, 1), g.uniform(-1, 1), g.uniform(-1, 1)};
    while (from.x * from.x + from.y * from.y + from.z * from.z < 0.3);
    do at = {g.uniform(-1, 1), g.uniform(-1, 1), g.uniform(-1, 1)};
    while (at.x * at.x + at.y * at.y + at.z * at.z > 1);
    const double far = 6 * radius, length = g.log_uniform(0.1, 1);
    from = {from.x * far, from.y * far, from.z * far};
    return {from,
            {(at.x * inside - from.x) * length, (at.y * inside - from.y) * length,
             (at.z * inside - from.z) * length},
            0,
            0};
}

template <class T> T power(const T &x, std::size_t n)
{
    T p(1.0);
    for (std::size_t i = 0; i < n; i++) p *= x;
    return p;
}

template <class T> T conic_sag(const T &c, const T &k, const T &r2)
{
    using std::sqrt;
    return c * r2 / (1.0 + sqrt(1.0 - (1.0 + k) * c * c * r2));
}

// What sags on a conic base share.  One in five has a flat base.
struct base {
    double c, k;
    explicit base(generator &g)
        : c(g.chance(0.2) ? 0 : g.uniform(-0.1, 0.1)), k(g.chance(0.2) ? -1 : g.uniform(-3, 2))
    {
    }
};

class conic {
public:
    static const char *name() { return "conic"; }
    explicit conic(generator &g)
    {
        const base b(g);
        s = {b.c, b.k, 0};
    }
    sgt_surface surface() const { return {&sgt_conic_ops, &s}; }
    std::vector<parameter> parameters() { return {{&s.c, 0.1}, {&s.k, 1}}; }
    sgt_ray ray(generator &g) const { return ray_to_sag(g); }
    bool near(const sgt_vec3 &p) const { return near_sag(p); }
    template <class T> T formula(const std::vector<T> &a, const T &x, const T &y, const T &z) const
    {
        return z - conic_sag<T>(a[0], a[1], x * x + y * y);
    }

private:
    sgt_conic s;
};

class asphere {
public:
    static const char *name() { return "asphere"; }
    explicit asphere(generator &g)
    {
        const base b(g);
        s = {b.c, b.k, g.chance(0.5) ? 2 * REACH : 0, {}};
        for (std::size_t i = 0; i < 8; i++)
            if (g.chance(0.7)) s.a[i] = g.uniform(-0.02, 0.02) * REACH / power(REACH * REACH, i + 1);
    }
    sgt_surface surface() const { return {&sgt_even_asphere_ops, &s}; }
    std::vector<parameter> parameters()
    {
        std::vector<parameter> all = {{&s.c, 0.1}, {&s.k, 1}};
        for (std::size_t i = 0; i < 8; i++) all.push_back({&s.a[i], 1 / power(REACH * REACH, i + 1)});
        return all;
    }
    sgt_ray ray(generator &g) const { return ray_to_sag(g); }
    bool near(const sgt_vec3 &p) const { return near_sag(p); }
    template <class T> T formula(const std::vector<T> &a, const T &x, const T &y, const T &z) const
    {
        const T r2 = x * x + y * y;
        T f = z - conic_sag<T>(a[0], a[1], r2);
        for (std::size_t i = 0; i < 8; i++) f -= a[2 + i] * power(r2, i + 1);
        return f;
    }
private:
    sgt_even_asphere s;
};

// ------------------------------------------------------------------ departures on a conic base

// A subject whose parameters are c, k and a list of `count`.
template <class Struct> class on_conic {
public:
    on_conic(const on_conic &) = delete;
    sgt_ray ray(generator &g) const { return ray_to_sag(g); }
    bool near(const sgt_vec3 &p) const { return near_sag(p); }
    std::vector<parameter> parameters()
    {
        std::vector<parameter> all = {{&s.c, 0.1}, {&s.k, 1}};
        for (std::size_t i = 0; i < a.size(); i++) all.push_back({&a[i], unit[i]});
        return all;
    }
    template <class T> T z_of_base(const std::vector<T> &of, const T &x, const T &y, const T &z) const
    {
        return z - conic_sag<T>(of[0], of[1], x * x + y * y);
    }

protected:
    explicit on_conic(generator &g) : s()
    {
        const base b(g);
        s.c = b.c, s.k = b.k;
    }
    void add(generator &g, double times, double one)
    {
        unit.push_back(one);
        a.push_back(g.chance(0.1) ? 0 : g.uniform(-times, times) * one);
    }
    Struct s;
    std::vector<double> a, unit;
};

class odd_asphere {
public:
    static const char *name() { return "odd asphere"; }
    explicit odd_asphere(generator &g) : s()
    {
        const base b(g);
        s.c = b.c, s.k = b.k;
        for (std::size_t i = 0; i < 16; i++)
            if (g.chance(0.7)) s.a[i] = g.uniform(-0.03, 0.03) / power(REACH, i);
    }
    sgt_surface surface() const { return {&sgt_odd_asphere_ops, &s}; }
    std::vector<parameter> parameters()
    {
        std::vector<parameter> all = {{&s.c, 0.1}, {&s.k, 1}};
        for (std::size_t i = 0; i < 16; i++) all.push_back({&s.a[i], 1 / power(REACH, i + 1)});
        return all;
    }
    sgt_ray ray(generator &g) const { return ray_to_sag(g); }
    bool near(const sgt_vec3 &p) const
    {
        return near_sag(p) && std::hypot(p.x, p.y) > 0.2;
    } // the tip of the cone
    template <class T> T formula(const std::vector<T> &of, const T &x, const T &y, const T &z) const
    {
        using std::sqrt;
        const T r2 = x * x + y * y, r = sqrt(r2);
        T f = z - conic_sag<T>(of[0], of[1], r2);
        for (std::size_t i = 0; i < 16; i++) f -= of[2 + i] * power(r, i + 1);
        return f;
    }
private:
    sgt_odd_asphere s;
};

class polynomial_xy : public on_conic<sgt_polynomial_xy> {
public:
    enum { ROWS = 3, COLUMNS = 5 };
    static const char *name() { return "polynomial"; }
    explicit polynomial_xy(generator &g) : on_conic(g)
    {
        for (std::size_t i = 0; i < ROWS; i++)
            for (std::size_t j = 0; j < COLUMNS; j++) add(g, 0.1, 1 / power(REACH, i + j));
        s.a = {a.data(), ROWS, COLUMNS};
    }
    sgt_surface surface() const { return {&sgt_polynomial_xy_ops, &s}; }
    template <class T> T formula(const std::vector<T> &of, const T &x, const T &y, const T &z) const
    {
        T f = z_of_base(of, x, y, z);
        for (std::size_t i = 0; i < ROWS; i++)
            for (std::size_t j = 0; j < COLUMNS; j++)
                f -= of[2 + i * COLUMNS + j] * power(x, i) * power(y, j);
        return f;
    }
};

class chebyshev : public on_conic<sgt_chebyshev> {
public:
    enum { ROWS = 5, COLUMNS = 3 };
    static const char *name() { return "Chebyshev"; }
    explicit chebyshev(generator &g) : on_conic(g)
    {
        for (int i = 0; i < ROWS * COLUMNS; i++) add(g, 0.03, 1);
        s.norm_x = g.uniform(1, 1.5) * REACH, s.norm_y = g.uniform(1, 1.5) * REACH;
        s.a = {a.data(), ROWS, COLUMNS};
    }
    sgt_surface surface() const { return {&sgt_chebyshev_ops, &s}; }
    template <class T> T formula(const std::vector<T> &of, const T &x, const T &y, const T &z) const
    {
        T f = z_of_base(of, x, y, z);
        for (std::size_t i = 0; i < ROWS; i++)
            for (std::size_t j = 0; j < COLUMNS; j++)
                f -= of[2 + i * COLUMNS + j] * first_kind(i, x / s.norm_x) * first_kind(j, y / s.norm_y);
        return f;
    }
private:
    template <class T> static T first_kind(std::size_t n, const T &u)
    {
        const T u2 = u * u;
        return n == 0   ? T(1.0)
               : n == 1 ? u
               : n == 2 ? 2.0 * u2 - 1.0
               : n == 3 ? (4.0 * u2 - 3.0) * u
                        : 8.0 * u2 * (u2 - 1.0) + 1.0;
    }
};

class zernike : public on_conic<sgt_zernike> {
public:
    enum { TERMS = 11 };
    static const char *name() { return "Zernike"; }
    explicit zernike(generator &g) : on_conic(g)
    {
        for (int i = 0; i < TERMS; i++) add(g, 0.03, 1);
        s.norm = g.uniform(1, 1.5) * REACH, s.order = g.chance(0.5) ? SGT_NOLL : SGT_FRINGE,
        s.normalised = g.chance(0.5);
        s.a = {a.data(), 1, TERMS};
    }
    sgt_surface surface() const { return {&sgt_zernike_ops, &s}; }
    template <class T> T formula(const std::vector<T> &of, const T &x, const T &y, const T &z) const
    {
        const T u = x / s.norm, v = y / s.norm, q = u * u + v * v;
        const T piston(1.0), focus = 2.0 * q - 1.0, sine2 = 2.0 * u * v, cosine2 = u * u - v * v,
                             coma = 3.0 * q - 2.0;
        const T cosine3 = u * (u * u - 3.0 * v * v), sine3 = v * (3.0 * u * u - v * v),
                spherical = 6.0 * q * q - 6.0 * q + 1.0;
        const T noll[TERMS] = {piston,   u,        v,     focus,   sine2,    cosine2,
                               coma * v, coma * u, sine3, cosine3, spherical};
        const T fringe[TERMS] = {piston,   u,        v,         focus,   cosine2, sine2,
                                 coma * u, coma * v, spherical, cosine3, sine3};
        const double noll2[TERMS] = {1, 4, 4, 3, 6, 6, 8, 8, 8, 8, 5},
                     fringe2[TERMS] = {1, 4, 4, 3, 6, 6, 8, 8, 5, 8, 8};
        T f = z_of_base(of, x, y, z);
        for (std::size_t j = 0; j < TERMS; j++)
            f -= of[2 + j] * (s.order == SGT_NOLL ? noll[j] : fringe[j]) *
                 (s.normalised ? std::sqrt(s.order == SGT_NOLL ? noll2[j] : fringe2[j]) : 1.0);
        return f;
    }
};

class q_con : public on_conic<sgt_q_con> {
public:
    enum { TERMS = 5 };
    static const char *name() { return "Q-con"; }
    explicit q_con(generator &g) : on_conic(g)
    {
        for (int i = 0; i < TERMS; i++) add(g, 0.05, 1);
        s.norm = g.uniform(1, 1.5) * REACH;
        s.a = {a.data(), 1, TERMS};
    }
    sgt_surface surface() const { return {&sgt_q_con_ops, &s}; }
    template <class T> T formula(const std::vector<T> &of, const T &x, const T &y, const T &z) const
    {
        const T q = (x * x + y * y) / (s.norm * s.norm);
        T f = z_of_base(of, x, y, z);
        for (std::size_t n = 0; n < TERMS; n++) { // P_n^(0,4)(2 q - 1) by Rodrigues' formula
            T sum(0.0);
            for (std::size_t i = 0; i <= n; i++)
                sum += over(n, i) * over(n + 4, i) * power(q - 1.0, i) * power(q, n - i);
            f -= of[2 + n] * q * q * sum;
        }
        return f;
    }
private:
  static double over(std::size_t n, std::size_t i)
  {
      return i == 0 ? 1 : over(n - 1, i - 1) * static_cast<double>(n) / static_cast<double>(i);
  }
};

class q_bfs {
public:
    enum { TERMS = 4 };
    static const char *name() { return "Q-bfs"; }
    explicit q_bfs(generator &g) : s()
    {
        s.c = base(g).c, s.norm = g.uniform(1, 1.5) * REACH;
        for (double &one : a) one = g.uniform(-0.05, 0.05);
        s.a = {a, 1, TERMS};
    }
    q_bfs(const q_bfs &) = delete;
    sgt_surface surface() const { return {&sgt_q_bfs_ops, &s}; }
    std::vector<parameter> parameters() { return {{&s.c, 0.1}, {a, 1}, {a + 1, 1}, {a + 2, 1}, {a + 3, 1}}; }
    sgt_ray ray(generator &g) const { return ray_to_sag(g); }
    bool near(const sgt_vec3 &p) const { return near_sag(p); }
    template <class T> T formula(const std::vector<T> &of, const T &x, const T &y, const T &z) const
    {
        using std::sqrt;
        const T r2 = x * x + y * y, q = r2 / (s.norm * s.norm);
        const T terms = of[1] + of[2] * (13.0 - 16.0 * q) / std::sqrt(19.0) +
                        of[3] * (29.0 - 4.0 * q * (25.0 - 19.0 * q)) * std::sqrt(2.0 / 95) +
                        of[4] * (207.0 - 4.0 * q * (315.0 - q * (577.0 - 320.0 * q))) * std::sqrt(2.0 / 2545);
        return z - conic_sag<T>(of[0], T(0.0), r2) - q * (1.0 - q) * terms / sqrt(1.0 - of[0] * of[0] * r2);
    }
private:
    sgt_q_bfs s;
    double a[TERMS];
};

// The number without its derivatives.
inline double plain(double x) { return x; }
template <class T> auto plain(const T &x) -> decltype(double(x.a)) { return x.a; }
template <class T> auto plain(const T &x) -> decltype(double(x.f.a)) { return x.f.a; }

class grid {
public:
    enum { ROWS = 13, COLUMNS = 15 };
    static const char *name() { return "grid"; }
    explicit grid(generator &g) : s()
    {
        const base b(g);
        s.c = b.c, s.k = b.k, s.step_x = g.uniform(0.9, 1.1), s.step_y = g.uniform(0.9, 1.1);
        for (double &one : height) one = g.uniform(-0.02, 0.02);
        s.z = {height, ROWS, COLUMNS};
    }
    grid(const grid &) = delete;
    sgt_surface surface() const { return {&sgt_grid_ops, &s}; }
    std::vector<parameter> parameters() { return {{&s.c, 0.1}, {&s.k, 1}}; }
    sgt_ray ray(generator &g) const { return ray_to_sag(g); }
    bool near(const sgt_vec3 &p) const // not where one cell meets the next: the second derivatives jump there
    {
        const double u = p.x / s.step_x, v = p.y / s.step_y; // COLUMNS and ROWS are odd
        return near_sag(p) && std::fabs(u - std::round(u)) > 0.03 && std::fabs(v - std::round(v)) > 0.03;
    }
    template <class T> T formula(const std::vector<T> &of, const T &x, const T &y, const T &z) const
    {
        const T u = x / s.step_x + 0.5 * (COLUMNS - 1), v = y / s.step_y + 0.5 * (ROWS - 1);
        const int column = static_cast<int>(std::floor(plain(u))),
                  row = static_cast<int>(std::floor(plain(v)));
        T f = z - conic_sag<T>(of[0], of[1], x * x + y * y);
        for (int i = row - 1; i <= row + 2; i++)
            for (int j = column - 1; j <= column + 2; j++)
                f -= height[i * COLUMNS + j] * weight<T>(v - double(i)) * weight<T>(u - double(j));
        return f;
    }
private:
    template <class T> static T weight(T t) // Keys' equation 15
    {
        if (plain(t) < 0) t = 0.0 - t;
        return plain(t) < 1 ? (1.5 * t - 2.5) * t * t + 1.0 : ((2.5 - 0.5 * t) * t - 4.0) * t + 2.0;
    }
    sgt_grid s;
    double height[ROWS * COLUMNS];
};

// An even asphere and a polynomial of two rows and two columns.
class sum {
public:
    static const char *name() { return "sum"; }
    explicit sum(generator &g) : s(), even(), plane()
    {
        const base b(g);
        for (std::size_t i = 0; i < 8; i++)
            even.a[i] = g.uniform(-0.02, 0.02) * REACH / power(REACH * REACH, i + 1);
        for (double &one : a) one = g.uniform(-0.02, 0.02);
        plane.a = {a, 2, 2};
        terms[0] = {&sgt_even_asphere_ops, &even}, terms[1] = {&sgt_polynomial_xy_ops, &plane};
        s = {b.c, b.k, 0, terms, 2};
    }
    sum(const sum &) = delete;
    sgt_surface surface() const { return {&sgt_sum_ops, &s}; }
    std::vector<parameter> parameters()
    {
        std::vector<parameter> all = {{&s.c, 0.1}, {&s.k, 1}};
        for (std::size_t i = 0; i < 8; i++) all.push_back({&even.a[i], 1 / power(REACH * REACH, i + 1)});
        for (double &one : a) all.push_back({&one, 0.1});
        return all;
    }
    sgt_ray ray(generator &g) const { return ray_to_sag(g); }
    bool near(const sgt_vec3 &p) const { return near_sag(p); }
    template <class T> T formula(const std::vector<T> &of, const T &x, const T &y, const T &z) const
    {
        const T r2 = x * x + y * y;
        T f = z - conic_sag<T>(of[0], of[1], r2) - (of[10] + of[11] * y + of[12] * x + of[13] * x * y);
        for (std::size_t i = 0; i < 8; i++) f -= of[2 + i] * power(r2, i + 1);
        return f;
    }
private:
    sgt_sum s;
    sgt_even_asphere even;
    sgt_polynomial_xy plane;
    double a[4];
    sgt_surface terms[2];
};

// ---------------------------------------------------------------- sags with a formula of their own

class toroidal {
public:
    static const char *name() { return "toroidal"; }
    explicit toroidal(generator &g) : s()
    {
        const base b(g);
        s.c = b.c, s.k = b.k, s.c_x = base(g).c;
        for (std::size_t i = 0; i < 8; i++)
            if (g.chance(0.7)) s.a[i] = g.uniform(-0.02, 0.02) * REACH / power(REACH * REACH, i + 1);
    }
    sgt_surface surface() const { return {&sgt_toroidal_ops, &s}; }
    std::vector<parameter> parameters()
    {
        std::vector<parameter> all = {{&s.c, 0.1}, {&s.k, 1}, {&s.c_x, 0.1}};
        for (std::size_t i = 0; i < 8; i++) all.push_back({&s.a[i], 1 / power(REACH * REACH, i + 1)});
        return all;
    }
    sgt_ray ray(generator &g) const { return ray_to_sag(g); }
    bool near(const sgt_vec3 &p) const { return near_sag(p); }
    template <class T> T formula(const std::vector<T> &of, const T &x, const T &y, const T &z) const
    {
        using std::sqrt;
        const T y2 = y * y;
        T profile = conic_sag<T>(of[0], of[1], y2);
        for (std::size_t i = 0; i < 8; i++) profile += of[3 + i] * power(y2, i + 1);
        const T c = of[2], q = 1.0 - c * profile;
        return z - profile - c * x * x / (q + sqrt(q * q - c * c * x * x));
    }
private:
    sgt_toroidal s;
};

class biconic {
public:
    static const char *name() { return "biconic"; }
    explicit biconic(generator &g) : s()
    {
        const base x(g), y(g);
        s = {x.c, x.k, y.c, y.k, 0};
    }
    sgt_surface surface() const { return {&sgt_biconic_ops, &s}; }
    std::vector<parameter> parameters() { return {{&s.c_x, 0.1}, {&s.k_x, 1}, {&s.c_y, 0.1}, {&s.k_y, 1}}; }
    sgt_ray ray(generator &g) const { return ray_to_sag(g); }
    bool near(const sgt_vec3 &p) const { return near_sag(p); }
    template <class T> T formula(const std::vector<T> &of, const T &x, const T &y, const T &z) const
    {
        using std::sqrt;
        const T x2 = x * x, y2 = y * y;
        return z - (of[0] * x2 + of[2] * y2) / (1.0 + sqrt(1.0 - (1.0 + of[1]) * of[0] * of[0] * x2 -
                                                           (1.0 + of[3]) * of[2] * of[2] * y2));
    }
private:
    sgt_biconic s;
};

// ------------------------------------------------------------------------ about the origin

class quadric {
public:
    static const char *name() { return "quadric"; }
    explicit quadric(generator &g) : s()
    {
        for (double &one : s.squares) one = g.uniform(0.7, 1.5);
        if (g.chance(0.3)) s.squares[g.below(3)] = g.uniform(-0.2, 0.1);
        for (double &one : s.products) one = g.uniform(-0.2, 0.2);
        for (double &one : s.linear) one = g.uniform(-0.2, 0.2);
        s.constant = g.uniform(-3, -1);
    }
    sgt_surface surface() const { return {&sgt_quadric_ops, &s}; }
    std::vector<parameter> parameters()
    {
        std::vector<parameter> all;
        for (double &one : s.squares) all.push_back({&one, 1});
        for (double &one : s.products) all.push_back({&one, 1});
        for (double &one : s.linear) all.push_back({&one, 1});
        all.push_back({&s.constant, 1});
        return all;
    }
    sgt_ray ray(generator &g) const { return ray_to_body(g, 2, 0.5); }
    bool near(const sgt_vec3 &p) const { return std::hypot(p.x, p.y, p.z) < 20; }
    template <class T> T formula(const std::vector<T> &of, const T &x, const T &y, const T &z) const
    {
        return of[0] * x * x + of[1] * y * y + of[2] * z * z + of[3] * x * y + of[4] * y * z + of[5] * x * z +
               of[6] * x + of[7] * y + of[8] * z + of[9];
    }
private:
    sgt_quadric s;
};

class ellipsoid {
public:
    static const char *name() { return "ellipsoid"; }
    explicit ellipsoid(generator &g) : s() { s.a = g.uniform(1, 3), s.f = g.uniform(-0.5, 0.5); }
    sgt_surface surface() const { return {&sgt_ellipsoid_ops, &s}; }
    std::vector<parameter> parameters() { return {{&s.a, 1}, {&s.f, 1}}; }
    sgt_ray ray(generator &g) const { return ray_to_body(g, s.a, 0.4 * s.a); }
    bool near(const sgt_vec3 &) const { return true; }
    template <class T> T formula(const std::vector<T> &of, const T &x, const T &y, const T &z) const
    {
        const T a2 = of[0] * of[0], b = of[0] * (1.0 - of[1]);
        return 0.5 * of[0] * ((x * x + y * y) / a2 + z * z / (b * b) - 1.0);
    }
private:
    sgt_ellipsoid s;
};

// F as src/surface/body/torus.c has it: surfaces.h promises the surface, not how long its gradient is.
class torus {
public:
    static const char *name() { return "torus"; }
    explicit torus(generator &g) : s()
    {
        s.major = g.uniform(1, 2),
        s.minor = s.major * (g.chance(0.7) ? g.uniform(0.2, 0.9) : g.uniform(1.1, 1.5));
    }
    sgt_surface surface() const { return {&sgt_torus_ops, &s}; }
    std::vector<parameter> parameters() { return {{&s.major, 1}, {&s.minor, 1}}; }
    sgt_ray ray(generator &g) const
    {
        sgt_ray ray = ray_to_body(g, s.major + s.minor,
                                  0.5 * s.minor); // toward the middle of the tube somewhere
        const double angle = g.uniform(-3.14, 3.14);
        ray.o.x += s.major * std::cos(angle), ray.o.y += s.major * std::sin(angle);
        return ray;
    }
    bool near(const sgt_vec3 &p) const { return std::hypot(p.x, p.y) > 0.1; }
    template <class T> T formula(const std::vector<T> &of, const T &x, const T &y, const T &z) const
    {
        using std::sqrt;
        const T rho = sqrt(x * x + y * y), R = of[0], r = of[1], rest = z * z - r * r;
        const T outer = (rho - R) * (rho - R) + rest, inner = (rho + R) * (rho + R) + rest;
        return s.minor <= s.major ? outer / (2.0 * r) : outer * inner / (8.0 * r * R * (R + r));
    }
private:
    sgt_torus s;
};

// ------------------------------------------------------------------------------ a user's

// An implicit surface of a user, that offers all of this: a Dupin-like quartic, F = (x^2 + y^2 / b)^2 + z^2
// - r^2.
struct quartic_numbers { double b, r; };

inline double quartic_value(const void *self, sgt_vec3 p, sgt_vec3 *grad)
{
    const quartic_numbers &s = *static_cast<const quartic_numbers *>(self);
    const double q = p.x * p.x + p.y * p.y / s.b;
    if (grad) *grad = {4 * q * p.x, 4 * q * p.y / s.b, 2 * p.z};
    return q * q + p.z * p.z - s.r * s.r;
}

inline void quartic_second(const void *self, std::size_t n, sgt_points p, double *const out[6])
{
    const quartic_numbers &s = *static_cast<const quartic_numbers *>(self);
    for (std::size_t i = 0; i < n; i++) {
        const double x = p.p[0][i], y = p.p[1][i], q = x * x + y * y / s.b;
        out[0][i] = 4 * q + 8 * x * x, out[1][i] = 8 * x * y / s.b, out[2][i] = 0;
        out[3][i] = 4 * q / s.b + 8 * y * y / (s.b * s.b), out[4][i] = 0, out[5][i] = 2;
    }
}

inline std::size_t quartic_parameters(const void *) { return 2; }

inline void quartic_by_parameter(const void *self, std::size_t j, std::size_t n, sgt_points p, sgt_values out)
{
    const quartic_numbers &s = *static_cast<const quartic_numbers *>(self);
    for (std::size_t i = 0; i < n; i++) {
        const double x = p.p[0][i], y = p.p[1][i], q = x * x + y * y / s.b, qb = -y * y / (s.b * s.b);
        out.f[i] = j == 0 ? 2 * q * qb : -2 * s.r;
        if (!out.grad[0]) continue;
        out.grad[0][i] = j == 0 ? 4 * x * qb : 0;
        out.grad[1][i] = j == 0 ? 4 * y / s.b * qb - 4 * q * y / (s.b * s.b) : 0;
        out.grad[2][i] = 0;
    }
}

class quartic {
public:
    static const char *name() { return "a user's"; }
    explicit quartic(generator &g) : ops(), s{g.uniform(0.5, 2), g.uniform(1, 2)}
    {
        ops.name = "quartic";
        ops.value = quartic_value;
        ops.second = quartic_second;
        ops.parameters = quartic_parameters;
        ops.by_parameter = quartic_by_parameter;
    }
    sgt_surface surface() const { return {&ops, &s}; }
    std::vector<parameter> parameters() { return {{&s.b, 1}, {&s.r, 1}}; }
    sgt_ray ray(generator &g) const { return ray_to_body(g, 2, 0.4); }
    bool near(const sgt_vec3 &) const { return true; }
    template <class T> T formula(const std::vector<T> &a, const T &x, const T &y, const T &z) const
    {
        const T q = x * x + y * y / a[0];
        return q * q + z * z - a[1] * a[1];
    }
private:
    sgt_surface_ops ops;
    quartic_numbers s;
};

// visit.operator()<Subject>(): once for each kind.
template <class Visit> void each_subject(Visit &visit)
{
    visit.template of<conic>();
    visit.template of<asphere>();
    visit.template of<odd_asphere>();
    visit.template of<polynomial_xy>();
    visit.template of<chebyshev>();
    visit.template of<zernike>();
    visit.template of<q_con>();
    visit.template of<q_bfs>();
    visit.template of<grid>();
    visit.template of<sum>();
    visit.template of<toroidal>();
    visit.template of<biconic>();
    visit.template of<quadric>();
    visit.template of<ellipsoid>();
    visit.template of<torus>();
    visit.template of<quartic>();
}

} // namespace subjects
#endif
