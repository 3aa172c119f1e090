// SPDX-License-Identifier: MIT
// specimens.h - random surfaces of the catalogue, points on them and rays at them.
//
// A part has an aperture h, log-uniform from 1e-3 to 1e3.  The base is one for which h is inside the domain
// (now and then all of it), or flat; a departure is at most `strong` h, log-uniform from 1e-6 to a tenth,
// the sum of its terms at h.  In two of three cases h is the semi_diameter.  Quadrics, ellipsoids and tori
// are of size h about the origin.
#ifndef TESTS_CATALOGUE_SPECIMENS_H
#define TESTS_CATALOGUE_SPECIMENS_H

#include "formulas.h"

#include "../oracle/cases.h"

#include <memory>

namespace catalogue {

using oracle::generator;

struct specimen {
    std::string type;
    sgt_surface s;
    double h;    // how far out it is looked at
    double rim;  // its semi_diameter, 0: none
    bool sag;
    std::vector<std::shared_ptr<void>> kept;

    template <class S> S *keep(const S &parameters)
    {
        std::shared_ptr<S> p = std::make_shared<S>(parameters);
        kept.push_back(p);
        return p.get();
    }
    sgt_numbers numbers(std::size_t rows, std::size_t columns, std::vector<double> x)
    {
        return {keep(std::move(x))->data(), rows, columns};
    }
};

// The types of these families, behind the names that are given.
inline std::vector<const char *> types_of(std::vector<const char *> found, bool of_sags, bool of_bodies)
{
    for (const sgt_builtin *b = sgt_builtins(); b->type; b++)
        if ((of_sags && b->family == SGT_FAMILY_DEPARTURE) || (of_bodies && b->family == SGT_FAMILY_BODY))
            found.push_back(b->type);
    return found;
}

// The types that are met by their operations: all but conics, even aspheres and level sets.
static const std::vector<const char *> types = types_of({}, true, true), sags = types_of({}, true, false);

inline const sgt_builtin *row_named(const std::string &type)
{
    const sgt_builtin *b = sgt_builtins();
    while (b->type && type != b->type) b++;
    return b;
}

inline const sgt_builtin *row_of_ops(const sgt_surface_ops *ops)
{
    const sgt_builtin *b = sgt_builtins();
    while (b->ops != ops) b++;
    return b;
}

inline double *first_number(const sgt_surface &s)
{
    return static_cast<double *>(const_cast<void *>(s.self));
}

// Where the rim of a sag is.
inline double *rim_of(const specimen &s)
{
    const sgt_param *p = row_of_ops(s.s.ops)->params;
    while (std::strcmp(p->name, "semi_diameter")) p++;
    return first_number(s.s) + p->offset / sizeof(double);
}

// A curvature and a conic constant that leave room for h.
inline void random_base(generator &g, double h, double *c, double *k)
{
    *k = g.chance(0.3) ? 0 : g.chance(0.2) ? -1 : g.uniform(-3, 2);
    *c = g.chance(0.15) ? 0 : g.sign() * g.log_uniform(1e-3, 0.9) / h;
    const double e = (1 + *k) * *c * *c * h * h;
    if (e > 0.9) *c *= std::sqrt(0.9 / e);
}

// n numbers, together of size `size`, the later ones smaller as often as not.
inline std::vector<double> random_terms(generator &g, std::size_t n, double size)
{
    std::vector<double> a(n);
    const double falling = g.chance(0.5) ? 1 : std::pow(1e-3, 1 / static_cast<double>(n));
    double now = 1, sum = 0;
    for (double &x : a) {
        x = g.chance(0.15) ? 0 : now * g.uniform(-1, 1);
        sum += std::fabs(x);
        now *= falling;
    }
    for (double &x : a) x *= sum > 0 ? size / sum : 0;
    return a;
}

// The size of a list: mostly a few, now and then `most`.
inline std::size_t random_length(generator &g, int few, int most)
{
    return static_cast<std::size_t>(g.chance(0.05) ? most : g.chance(0.05) ? 0 : 1 + g.below(few));
}

// Of a type that is known by its row alone: its specimen, whose rim is 4, at the scale of h.  The numbers
// without a base and a rim are as large, or smaller, by up to size / h over that of the specimen.
inline sgt_surface departure_like_specimen(generator &g, specimen *s, const sgt_builtin *row, double h,
                                           double size)
{
    std::vector<double> &with = *s->keep(std::vector<double>(row->size / sizeof(double) + 1));
    char *self = reinterpret_cast<char *>(with.data());
    std::memcpy(self, row->specimen, row->size);
    for (const sgt_param *p = row->params; p->name; p++) {
        const std::string key = p->name;
        const bool base = key == "curvature" || key == "conic" || key == "semi_diameter";
        const auto scaled = [&](double x, int i, int j) {
            const int power = p->unit.length + i * p->unit.by_i + j * p->unit.by_j;
            return base ? 0 : x * std::pow(h / 4, power) * g.uniform(0.5, 1);
        };
        if (p->kind == SGT_PARAM_REAL || p->kind == SGT_PARAM_VECTOR) {
            double *x = reinterpret_cast<double *>(self + p->offset);
            for (int i = 0; i < p->count; i++) x[i] = scaled(x[i], i, 0);
        } else if (p->kind == SGT_PARAM_LIST || p->kind == SGT_PARAM_TABLE) {
            sgt_numbers &a = *reinterpret_cast<sgt_numbers *>(self + p->offset);
            std::vector<double> x(a.x, a.x + a.rows * a.columns);
            for (std::size_t i = 0; i < x.size(); i++) {
                const int m = static_cast<int>(i / a.columns), n = static_cast<int>(i % a.columns);
                x[i] = p->kind == SGT_PARAM_LIST ? scaled(x[i], n, 0) : scaled(x[i], m, n);
                x[i] *= g.chance(0.3) ? 0 : std::fmin(1, size / (1e-3 * h));
            }
            a = s->numbers(a.rows, a.columns, x);
        }
    }
    return {row->ops, self};
}

// Its departure is at most `size` within h (of a toroid and a biconic a tenth of h); c, k and semi_diameter
// are 0.
inline sgt_surface random_departure(generator &g, specimen *s, const std::string &of, double h, double size,
                                    bool large)
{
    if (of == "odd_asphere") {
        sgt_odd_asphere a = {};
        const std::vector<double> terms = random_terms(g, random_length(g, 8, 16), size);
        for (std::size_t i = 0; i < terms.size(); i++)
            a.a[i] = terms[i] / std::pow(h, static_cast<double>(i) + 1);
        if (g.chance(0.5)) a.a[0] = 0;
        return {&sgt_odd_asphere_ops, s->keep(a)};
    }
    if (of == "even_asphere") {
        sgt_even_asphere a = {};
        const std::vector<double> terms = random_terms(g, random_length(g, 4, 8), size);
        for (std::size_t i = 0; i < terms.size(); i++)
            a.a[i] = terms[i] / std::pow(h, 2 * static_cast<double>(i) + 2);
        return {&sgt_even_asphere_ops, s->keep(a)};
    }
    if (of == "polynomial_xy") {
        const std::size_t rows = random_length(g, 6, large ? 32 : 8),
                          columns = rows ? 1 + random_length(g, 5, large ? 31 : 7) : 0;
        std::vector<double> a = random_terms(g, rows * columns, size);
        for (std::size_t i = 0; i < rows; i++)
            for (std::size_t j = 0; j < columns; j++)
                a[i * columns + j] /= std::pow(h, static_cast<double>(i + j));
        return {&sgt_polynomial_xy_ops, s->keep(sgt_polynomial_xy{0, 0, 0, s->numbers(rows, columns, a)})};
    }
    if (of == "chebyshev") {
        const std::size_t rows = random_length(g, 7, large ? 20 : 8),
                          columns = rows ? 1 + random_length(g, 6, large ? 19 : 7) : 0;
        return {&sgt_chebyshev_ops,
                s->keep(sgt_chebyshev{0, 0, 0, h * g.uniform(0.9, 1.5), h * g.uniform(0.9, 1.5),
                                      s->numbers(rows, columns, random_terms(g, rows * columns, size))})};
    }
    if (of == "zernike") {
        const std::size_t n = random_length(g, 36, large ? 231 : 45);
        sgt_zernike z = {0,
                         0,
                         0,
                         h * g.uniform(0.95, 1.3),
                         g.chance(0.5) ? SGT_NOLL : SGT_FRINGE,
                         g.chance(0.5),
                         s->numbers(1, n, random_terms(g, n, size))};
        return {&sgt_zernike_ops, s->keep(z)};
    }
    if (of == "q_con" || of == "q_bfs") {
        const std::size_t n = random_length(g, 8, large ? 30 : 12);
        const sgt_numbers a = s->numbers(1, n, random_terms(g, n, size));
        const double norm = h * g.uniform(0.98, 1.2);
        if (of == "q_con") return {&sgt_q_con_ops, s->keep(sgt_q_con{0, 0, 0, norm, a})};
        return {&sgt_q_bfs_ops, s->keep(sgt_q_bfs{0, 0, norm, a})};
    }
    if (of == "toroidal")
        return {&sgt_toroidal_ops, s->keep(sgt_toroidal{g.uniform(-0.1, 0.1) / h,
                                                        g.uniform(-2, 1),
                                                        g.uniform(-0.1, 0.1) / h,
                                                        0,
                                                        {size / h / h, size / h / h / h / h}})};
    if (of == "biconic")
        return {&sgt_biconic_ops, s->keep(sgt_biconic{g.uniform(-0.1, 0.1) / h, g.uniform(-2, 1),
                                                      g.uniform(-0.1, 0.1) / h, g.uniform(-2, 1), 0})};
    if (of != "grid") return departure_like_specimen(g, s, row_named(of), h, size);
    const std::size_t rows = 4 + static_cast<std::size_t>(g.below(large ? 30 : 12)),
                      columns = 4 + static_cast<std::size_t>(g.below(large ? 30 : 12));
    std::vector<double> z(rows * columns);
    double a[6];
    for (double &x : a) x = g.uniform(-1, 1);
    const double rough = g.chance(0.5) ? 0 : g.log_uniform(1e-3, 0.3);
    for (std::size_t i = 0; i < rows; i++)
        for (std::size_t j = 0; j < columns; j++) {
            const double x = 2.0 * double(j) / double(columns - 1) - 1,
                         y = 2.0 * double(i) / double(rows - 1) - 1;
            z[i * columns + j] = size / 3 *
                                 (a[0] * x + a[1] * y * x + a[2] * x * x + a[3] * y * y * x +
                                  a[4] * std::cos(3 * x + 2 * y) + rough * g.uniform(-1, 1));
        }
    const double wide = g.chance(0.8) ? 1.02 : 0.8;
    sgt_grid *grid = s->keep(sgt_grid{0, 0, 0, 2 * h * wide * g.uniform(1, 1.2) / double(columns - 1),
                                      2 * h * wide / double(rows - 1), s->numbers(rows, columns, z), 0, 0,
                                      0});
    if (g.chance(0.7)) sgt_grid_measure(grid);
    return {&sgt_grid_ops, grid};
}

// large: long lists among them.
inline specimen random_specimen(generator &g, const std::string &type, bool large = false)
{
    specimen s = {};
    s.type = type;
    const double h = s.h = g.chance(0.5) ? g.uniform(0.5, 20) : g.log_uniform(1e-3, 1e3),
                 strong = g.log_uniform(1e-6, 0.1);
    s.rim = g.chance(0.67) ? h : 0;
    s.sag = true;
    double c, k;
    random_base(g, h, &c, &k);
    if (type == "toroidal") {
        sgt_toroidal t = {c, k, g.chance(0.2) ? 0 : g.sign() * g.log_uniform(1e-3, 0.7) / h, s.rim, {}};
        const std::vector<double> terms = random_terms(g, random_length(g, 4, 8), strong * h);
        for (std::size_t i = 0; i < terms.size(); i++)
            t.a[i] = terms[i] / std::pow(h, 2 * static_cast<double>(i) + 2);
        s.s = {&sgt_toroidal_ops, s.keep(t)};
    } else if (type == "biconic" || type == "cylinder") {
        sgt_biconic b = {0, 0, c, k, s.rim};
        if (type == "biconic") random_base(g, h, &b.c_x, &b.k_x);
        const double e = (1 + b.k_x) * b.c_x * b.c_x + (1 + k) * c * c;
        if (e * h * h > 0.9) b.c_x *= std::sqrt(0.45 / (e * h * h)), b.c_y *= std::sqrt(0.45 / (e * h * h));
        s.s = {&sgt_biconic_ops, s.keep(b)};
    } else if (type == "quadric") {
        s.sag = false;
        s.rim = 0;
        sgt_quadric q = {};
        const int kind = g.below(4);
        for (double &x : q.squares) x = kind == 0 ? g.uniform(0.2, 2) : g.chance(0.2) ? 0 : g.uniform(-2, 2);
        if (kind > 1)
            for (double &x : q.products) x = g.chance(0.4) ? 0 : g.uniform(-1, 1);
        for (double &x : q.linear) x = g.chance(0.4) ? 0 : h * g.uniform(-1, 1);
        q.constant = g.chance(0.15) ? 0 : -h * h * (g.chance(0.7) ? g.uniform(0.2, 2) : g.uniform(-1, 1));
        q.linear[2] += q.squares[0] == 0 && q.squares[1] == 0 && q.squares[2] == 0 ? h : 0;
        s.s = {&sgt_quadric_ops, s.keep(q)};
    } else if (type == "ellipsoid") {
        s.sag = false;
        s.rim = 0;
        s.s = {&sgt_ellipsoid_ops,
               s.keep(sgt_ellipsoid{h, g.chance(0.2)   ? 0
                                       : g.chance(0.3) ? 1 / 298.257223563
                                       : g.chance(0.5) ? g.uniform(-2, 0.95)
                                                       : g.sign() * g.log_uniform(1e-12, 0.5)})};
    } else if (type == "torus") {
        s.sag = false;
        s.rim = 0;
        const double minor = h * (g.chance(0.15) ? g.uniform(1, 2) : g.log_uniform(0.02, 0.95));
        s.s = {&sgt_torus_ops, s.keep(sgt_torus{h, g.chance(0.03) ? h : minor})};
    } else {
        if (type == "sum") {
            std::vector<sgt_surface> terms;
            static const char *const kinds[] = {"odd_asphere", "polynomial_xy", "chebyshev", "zernike",
                                                "q_con",       "q_bfs",         "grid",      "even_asphere",
                                                "toroidal",    "biconic"};
            const int n = g.chance(0.03) ? 16 : g.chance(0.03) ? 0 : 1 + g.below(4);
            for (int i = 0; i < n; i++) {
                const std::string kind = kinds[g.below(g.chance(0.8) ? 8 : 10)];
                terms.push_back(random_departure(g, &s, kind, h, strong * h / n, large && n < 4));
                if (kind != "toroidal" && kind != "biconic" && g.chance(0.3))
                    first_number(terms.back())[0] = g.uniform(-0.5, 0.5) / h; // read by q_bfs alone
            }
            const std::vector<sgt_surface> &own = *s.keep(terms);
            s.s = {&sgt_sum_ops, s.keep(sgt_sum{0, 0, 0, own.data(), own.size()})};
        } else s.s = random_departure(g, &s, type, h, strong * h, large);
        double *p = first_number(s.s);
        if (type == "q_bfs") {
            if (std::fabs(c) * h > 0.9) c = 0.9 / h * (c < 0 ? -1 : 1);
            p[0] = c, p[1] = s.rim;
        } else p[0] = c, p[1] = k, p[2] = s.rim;
    }
    return s;
}

// T_n(t) as a polynomial: its coefficients by t^0 ... t^n.
inline std::vector<double> chebyshev_polynomial(int n)
{
    std::vector<double> before(1, 1.0), now = {0, 1};
    if (n == 0) return before;
    for (int k = 1; k < n; k++) {
        std::vector<double> next(static_cast<std::size_t>(k) + 2);
        for (std::size_t i = 0; i < now.size(); i++) next[i + 1] = 2 * now[i];
        for (std::size_t i = 0; i < before.size(); i++) next[i] -= before[i];
        before = now, now = next;
    }
    return now;
}

// A flat or weakly curved sag with ridges, many or one: a departure of one high order, or a grid that is 0
// but in some of its rows or columns.  *height: of a ridge; *ridges: how many there are across, at most.
inline specimen ridged_specimen(generator &g, const std::string &type, double *height, int *ridges)
{
    specimen s = {};
    s.type = type, s.sag = true;
    const double h = s.h = g.log_uniform(0.1, 10), by = *height = h * g.log_uniform(1e-3, 0.05);
    s.rim = g.chance(0.5) ? h : 0;
    const double c = g.chance(0.5) ? 0 : 0.02 * g.uniform(-1, 1) / h;
    const int n = 4 + g.below(5);
    *ridges = 2 * n;
    if (type == "grid") {
        const std::size_t along = static_cast<std::size_t>(4 + g.below(10)),
                          across = static_cast<std::size_t>(8 + g.below(g.chance(0.5) ? 20 : 150));
        const bool turned = g.chance(0.5);
        std::vector<double> z(along * across);
        const auto raise = [&](std::size_t i, double to) {
            for (std::size_t j = 0; j < along; j++) z[turned ? i * along + j : j * across + i] = to;
        };
        const int many = g.chance(0.3) ? 3 + g.below(8) : 1 + g.below(3);
        for (int i = 0; i < many; i++)
            raise(static_cast<std::size_t>(g.below(static_cast<int>(across))), by * g.uniform(0.1, 1));
        if (g.chance(0.1)) raise(0, by);
        if (g.chance(0.1)) raise(across - 1, by);
        const std::size_t rows = turned ? across : along, columns = turned ? along : across;
        sgt_grid *grid = s.keep(sgt_grid{c, 0, s.rim, 2.02 * h / double(columns - 1),
                                         2.02 * h / double(rows - 1), s.numbers(rows, columns, z), 0, 0, 0});
        if (g.chance(0.7)) sgt_grid_measure(grid);
        *ridges = static_cast<int>(across);
        s.s = {&sgt_grid_ops, grid};
    } else if (type == "chebyshev") {
        const std::size_t rows = static_cast<std::size_t>(g.chance(0.3) ? 0 : 5 + g.below(20)),
                          columns = static_cast<std::size_t>(rows ? g.below(4) : 5 + g.below(20));
        std::vector<double> a((rows + 1) * (columns + 1));
        a.back() = by;
        *ridges = static_cast<int>(rows + columns);
        s.s = {&sgt_chebyshev_ops, s.keep(sgt_chebyshev{c, 0, s.rim, 1.05 * h, 1.05 * h,
                                                        s.numbers(rows + 1, columns + 1, a)})};
    } else if (type == "zernike") {
        std::vector<double> a(static_cast<std::size_t>(30 + g.below(200)));
        a.back() = by;
        *ridges = 24;
        const sgt_numbers list = s.numbers(1, a.size(), a);
        const sgt_zernike z = {c, 0, s.rim, 1.02 * h, g.chance(0.5) ? SGT_NOLL : SGT_FRINGE, false, list};
        s.s = {&sgt_zernike_ops, s.keep(z)};
    } else if (type == "q_con" || type == "q_bfs") {
        std::vector<double> a(static_cast<std::size_t>(5 + g.below(25)));
        a.back() = by;
        *ridges = 2 * static_cast<int>(a.size());
        const sgt_numbers list = s.numbers(1, a.size(), a);
        if (type == "q_con") s.s = {&sgt_q_con_ops, s.keep(sgt_q_con{c, 0, s.rim, h, list})};
        else s.s = {&sgt_q_bfs_ops, s.keep(sgt_q_bfs{c, s.rim, h, list})};
    } else if (type == "odd_asphere" || type == "toroidal") { // T_2n(r / h) or T_2n(y / h), n at most 8
        const std::vector<double> t = chebyshev_polynomial(2 * n);
        sgt_odd_asphere odd = {c, 0, s.rim, {}};
        sgt_toroidal swept = {c, 0, c, s.rim, {}};
        for (int i = 0; i < n; i++) {
            const double a = by * t[2 * static_cast<std::size_t>(i) + 2] / std::pow(h, 2 * i + 2);
            odd.a[2 * i + 1] = swept.a[i] = a;
        }
        s.s = type == "toroidal" ? sgt_surface{&sgt_toroidal_ops, s.keep(swept)}
                                 : sgt_surface{&sgt_odd_asphere_ops, s.keep(odd)};
    } else { // T_m(x / h) as an XY polynomial, by itself or as the term of a sum
        const std::vector<double> t = chebyshev_polynomial(2 * n);
        std::vector<double> a(t.size());
        for (std::size_t i = 0; i < t.size(); i++) a[i] = by * t[i] / std::pow(h, static_cast<double>(i));
        const bool turned = g.chance(0.5);
        const sgt_numbers table = s.numbers(turned ? 1 : a.size(), turned ? a.size() : 1, a);
        s.s = {&sgt_polynomial_xy_ops, s.keep(sgt_polynomial_xy{c, 0, s.rim, table})};
        if (type == "sum") {
            const std::vector<sgt_surface> &terms = *s.keep(std::vector<sgt_surface>(1, s.s));
            s.s = {&sgt_sum_ops, s.keep(sgt_sum{c, 0, s.rim, terms.data(), 1})};
        }
    }
    return s;
}

// ------------------------------------------------------------------ printing

inline void print_numbers(const sgt_numbers &a)
{
    std::printf(" %zu x %zu {", a.rows, a.columns);
    for (std::size_t i = 0; i < count_of(a); i++) std::printf("%s%a", i ? ", " : "", a.x[i]);
    std::printf("}");
}
inline void print_list(const void *x, int n)
{
    for (int i = 0; i < n; i++) std::printf(" %a", static_cast<const double *>(x)[i]);
}

inline void print_surface(const sgt_surface &s)
{
    std::printf("    %s:", s.ops->name);
    if (s.ops == &sgt_even_asphere_ops) print_list(s.self, 11);
    if (s.ops == &sgt_odd_asphere_ops) print_list(s.self, 19);
    if (s.ops == &sgt_polynomial_xy_ops)
        print_list(s.self, 3), print_numbers(static_cast<const sgt_polynomial_xy *>(s.self)->a);
    if (s.ops == &sgt_chebyshev_ops)
        print_list(s.self, 5), print_numbers(static_cast<const sgt_chebyshev *>(s.self)->a);
    if (s.ops == &sgt_zernike_ops) {
        const sgt_zernike &z = *static_cast<const sgt_zernike *>(s.self);
        print_list(s.self, 4);
        std::printf(" %s%s", z.order == SGT_NOLL ? "noll" : "fringe", z.normalised ? " normalised" : "");
        print_numbers(z.a);
    }
    if (s.ops == &sgt_q_con_ops)
        print_list(s.self, 4), print_numbers(static_cast<const sgt_q_con *>(s.self)->a);
    if (s.ops == &sgt_q_bfs_ops)
        print_list(s.self, 3), print_numbers(static_cast<const sgt_q_bfs *>(s.self)->a);
    if (s.ops == &sgt_grid_ops)
        print_list(s.self, 5), print_numbers(static_cast<const sgt_grid *>(s.self)->z);
    if (s.ops == &sgt_toroidal_ops) print_list(s.self, 12);
    if (s.ops == &sgt_biconic_ops) print_list(s.self, 5);
    if (s.ops == &sgt_quadric_ops) print_list(s.self, 10);
    if (s.ops == &sgt_ellipsoid_ops || s.ops == &sgt_torus_ops) print_list(s.self, 2);
    if (s.ops == &sgt_sum_ops) {
        const sgt_sum &sum = *static_cast<const sgt_sum *>(s.self);
        print_list(s.self, 3);
        std::printf(" of %zu:\n", sum.count);
        for (std::size_t i = 0; i < sum.count; i++) print_surface(sum.terms[i]);
        return;
    }
    std::printf("\n");
}

// --------------------------------------------------------------------- points

// A point near the surface, within `reach` of h: a sag's at x, y, else along a line.
inline sgt_vec3 random_point(generator &g, const specimen &s, const formula<double> &f, double reach)
{
    const double r = reach * s.h * std::sqrt(g.uniform(0, 1)), about = g.uniform(0, 6.283185307179586),
                 x = r * std::cos(about), y = r * std::sin(about);
    if (s.sag) {
        const double sag = -f(x, y, 0.0);
        return {x, y,
                (sag == sag ? sag : 0) + (g.chance(0.5) ? 0 : s.h * g.sign() * g.log_uniform(1e-12, 1))};
    }
    if (s.type == "torus") { // on it, to rounding
        const sgt_torus &t = *static_cast<const sgt_torus *>(s.s.self);
        const double a = g.uniform(0, 6.283185307179586),
                     off = t.minor * (g.chance(0.7) ? 1 : g.uniform(0, 2)), w = t.major + off * std::cos(a);
        return {w * std::cos(about), w * std::sin(about), off * std::sin(a)};
    }
    const double z = g.uniform(-reach, reach) * s.h;
    if (s.type == "ellipsoid") {
        const sgt_ellipsoid &e = *static_cast<const sgt_ellipsoid *>(s.s.self);
        const double u = g.uniform(-1, 1), w = std::sqrt(1 - u * u) * e.a,
                     off = g.chance(0.7) ? 1 : g.uniform(0, 2);
        return {off * w * std::cos(about), off * w * std::sin(about), off * u * e.a * (1 - e.f)};
    }
    // Down the z axis to where the quadric is, if it is.
    const double f0 = f(x, y, z), f1 = f(x, y, z + s.h), f2 = f(x, y, z - s.h), A = (f1 + f2) / 2 - f0,
                 B = (f1 - f2) / 2, D = B * B - 4 * A * f0;
    const double q = -(B + (B < 0 ? -1 : 1) * std::sqrt(D > 0 ? D : 0)) / 2,
                 to = D > 0 && q != 0 ? f0 / q : 0;
    return {x, y, z + s.h * (std::fabs(to) < 10 ? to : 0)};
}

} // namespace catalogue
#endif
