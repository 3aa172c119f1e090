// SPDX-License-Identifier: MIT
// scaling.h - random surfaces at another unit of length, and what their answers are then.
#ifndef TESTS_CATALOGUE_SCALING_H
#define TESTS_CATALOGUE_SCALING_H

#include "judge.h"

namespace catalogue
{

// ------------------------------------------------------------------ surfaces at another scale

inline const sgt_builtin *row_of(const std::string &type)
{
    for (const sgt_builtin *row = sgt_builtins(); row->type; row++)
        if (type == row->type) return row;
    return nullptr;
}
inline const sgt_builtin *row_of(const sgt_surface_ops *ops)
{
    for (const sgt_builtin *row = sgt_builtins(); row->type; row++)
        if (row->ops == ops) return row;
    return nullptr;
}

// Of number i of a list, or of number j of row i of a table.
inline int power_of(const sgt_param_unit &u, int i, int j) { return u.length + i * u.by_i + j * u.by_j; }

struct scaling {
    std::vector<std::shared_ptr<void>> kept;
    double most;                        // of squares, or of fourth powers, neither is lost
    bool exact = true, moderate = true; // no number is rounded; all are below `most` and above its inverse
    explicit scaling(const std::string &type)
    {
        const bool fourth =
            type == "torus" || type == "toroidal" || type == "biconic" || type == "cylinder" || type == "sum";
        most = fourth ? 0x1p230 : 0x1p480;
    }

    double number(double x, int by)
    {
        const double y = std::ldexp(x, by);
        if (y != 0 && !(std::fabs(y) >= DBL_MIN && std::fabs(y) <= DBL_MAX)) exact = false;
        if (x != 0 && y == 0) exact = false;
        if (y != 0 && !(std::fabs(y) > 1 / most && std::fabs(y) < most)) moderate = false;
        return y;
    }
    sgt_vec3 vector(const sgt_vec3 &a, int by) { return {number(a.x, by), number(a.y, by), number(a.z, by)}; }

    sgt_surface surface(const sgt_builtin *row, const sgt_surface &s, int k)
    {
        std::shared_ptr<std::vector<double>> room =
            std::make_shared<std::vector<double>>(row->size / sizeof(double) + 2);
        kept.push_back(room);
        char *to = reinterpret_cast<char *>(room->data());
        std::memcpy(to, s.self, row->size);
        for (const sgt_param *p = row->params; p->name; p++) {
            if (!std::strcmp(p->name, "slice")) continue; // a part of `at`
            if (p->kind == SGT_PARAM_REAL || p->kind == SGT_PARAM_VECTOR) {
                double *x = reinterpret_cast<double *>(to + p->offset);
                for (int i = 0; i < p->count; i++) x[i] = number(x[i], k * power_of(p->unit, i, 0));
            } else if (p->kind == SGT_PARAM_LIST || p->kind == SGT_PARAM_TABLE) {
                sgt_numbers a;
                std::memcpy(&a, to + p->offset, sizeof a);
                std::shared_ptr<std::vector<double>> x =
                    std::make_shared<std::vector<double>>(a.x, a.x + a.rows * a.columns);
                for (std::size_t i = 0; i < x->size(); i++) {
                    const int at_row = static_cast<int>(i / a.columns),
                              at_column = static_cast<int>(i % a.columns);
                    (*x)[i] =
                        number((*x)[i], k * power_of(p->unit, p->kind == SGT_PARAM_LIST ? at_column : at_row,
                                                     at_column));
                }
                kept.push_back(x);
                a.x = x->data();
                std::memcpy(to + p->offset, &a, sizeof a);
            } else if (p->kind == SGT_PARAM_TERMS) {
                const sgt_surface *terms;
                std::size_t count;
                std::memcpy(&terms, to + p->offset, sizeof terms);
                std::memcpy(&count, to + p->offset + sizeof terms, sizeof count);
                std::shared_ptr<std::vector<sgt_surface>> own = std::make_shared<std::vector<sgt_surface>>();
                for (std::size_t i = 0; i < count; i++)
                    own->push_back(surface(row_of(terms[i].ops), terms[i], k));
                kept.push_back(own);
                terms = own->data();
                std::memcpy(to + p->offset, &terms, sizeof terms);
            }
        }
        if (s.ops == &sgt_grid_ops) {
            sgt_grid *grid = reinterpret_cast<sgt_grid *>(to);
            if (grid->steep > 0) sgt_grid_measure(grid); // it was
        }
        return {s.ops, to};
    }
    sgt_surface surface(const specimen &s, int k) { return surface(row_of(s.type), s.s, k); }
};

// ------------------------------------------------------------------ surfaces and rays

// A surface, and another of about its shape that rays are aimed at.
struct target {
    specimen s, shape;
};

inline target random_target(generator &g, const std::string &type)
{
    target t = {};
    if (type == "plane" || type == "sphere" || type == "conic" || type == "even_asphere") {
        t.shape = random_specimen(g, "sum");
        sgt_sum sum = *static_cast<const sgt_sum *>(t.shape.s.self);
        sum.count = 0;
        sgt_even_asphere a = {type == "plane" ? 0 : sum.c,
                         type == "plane" || type == "sphere" ? 0 : sum.k,
                         sum.semi_diameter,
                         {}};
        if (type == "sphere" && a.c * a.c * t.shape.h * t.shape.h > 0.9)
            a.c *= 0.9 / (std::fabs(a.c) * t.shape.h);
        t.s = t.shape;
        if (type == "even_asphere") {
            const std::vector<double> terms =
                random_terms(g, random_length(g, 4, 8), t.s.h * g.log_uniform(1e-6, 0.1));
            for (std::size_t i = 0; i < terms.size(); i++)
                a.a[i] = terms[i] / std::pow(t.s.h, 2 * static_cast<double>(i) + 2);
            t.s.s = {&sgt_even_asphere_ops, t.s.keep(a)};
            sum.terms = t.s.keep(t.s.s), sum.count = 1;
        } else
            t.s.s = {&sgt_conic_ops, t.s.keep(sgt_conic{a.c, a.k, a.semi_diameter})};
        sum.c = a.c, sum.k = a.k;
        t.shape.s.self = t.s.keep(sum);
        t.s.type = t.shape.type = type;
    } else if (type == "julia" || type == "mandelbrot") {
        t.shape = random_specimen(g, "ellipsoid");
        t.s = t.shape;
        t.s.type = type;
        const double h = t.s.h, e = 1.2 / h;
        sgt_julia j = {};
        sgt_mandelbrot m = {};
        for (double &x : j.c) x = g.uniform(-0.6, 0.6);
        j.ex[0] = m.ex[0] = j.ey[1] = m.ey[1] = j.ez[2] = m.ez[2] = e;
        if (g.chance(0.5)) j.ez[3] = m.ez[3] = e * g.uniform(-1, 1);
        j.at[3] = m.at[3] = g.uniform(-0.1, 0.1);
        j.iterations = m.iterations = 3 + g.below(8);
        j.power = m.power = g.chance(0.7) ? 2 : 3;
        if (type == "julia")
            t.s.s = {&sgt_julia_ops, t.s.keep(j)};
        else
            t.s.s = {&sgt_mandelbrot_ops, t.s.keep(m)};
    } else
        t.s = t.shape = random_specimen(g, type);
    return t;
}

// ------------------------------------------------------------------ comparison

// Near the smallest normal number an error bound has a number added that does not scale.
inline bool same(double a, double b)
{
    return a == b || (a != a && b != b) || (std::fabs(a) < 1e-290 && std::fabs(b) < 1e-290);
}
inline bool same(const sgt_vec3 &a, const sgt_vec3 &b)
{
    return same(a.x, b.x) && same(a.y, b.y) && same(a.z, b.z);
}
// The ends of what is not decided: a far one may stand for the greatest number.
inline bool same_end(double a, double b)
{
    return same(a, b) || (std::fabs(a) > 1e300 && std::fabs(b) > 1e300 && (a > 0) == (b > 0));
}

inline double times(double x, int k) { return std::ldexp(x, k); }
inline sgt_vec3 times(const sgt_vec3 &a, int k) { return {times(a.x, k), times(a.y, k), times(a.z, k)}; }

// What a hit is where t is in units 2^t, a point in units of 2^k, F of 2^f.
inline sgt_hit expected(sgt_hit h, int t, int k, int f)
{
    for (double *x : {&h.t, &h.t_err, &h.t_lo, &h.lo, &h.hi}) *x = times(*x, t);
    h.p = times(h.p, k), h.p_err = times(h.p_err, k);
    h.n = times(h.n, f - k), h.f = times(h.f, f);
    return h;
}

inline const char *difference(const sgt_hit &a, const sgt_hit &b)
{
    if (a.status != b.status) return "status";
    if (a.evals != b.evals) return "evals";
    const bool numbers = a.status < 0 || (same(a.t, b.t) && same(a.t_err, b.t_err));
    const bool at_zero = a.status > 0 && a.t == 0 && b.t == 0; // t_err is what underflow may hide
    if (!at_zero && !(numbers && same(a.t_lo, b.t_lo) && same_end(a.lo, b.lo) && same_end(a.hi, b.hi)))
        return "t, t_err, t_lo, lo or hi";
    if (!(same(a.p, b.p) && same(a.n, b.n) && same(a.f, b.f) && same(a.p_err, b.p_err)))
        return "the point, the normal or F";
    return nullptr;
}

} // namespace catalogue
#endif
