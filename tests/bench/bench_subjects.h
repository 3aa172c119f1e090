// SPDX-License-Identifier: MIT
// bench_subjects.h - the rays of the benchmarks of sags, and a surface of each type beyond the conic.
#ifndef BENCH_SUBJECTS_H
#define BENCH_SUBJECTS_H
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>
#include <sagitta/surfaces.h>

namespace bench {

// ------------------------------------------------------------------ the rays

constexpr size_t RAYS = 1000000;

class Random {  // splitmix64: Steele, Lea, Flood, OOPSLA 2014
public:
    explicit Random(uint64_t seed = 0x1234567) : state(seed) {}
    double unit()
    {
        uint64_t z = state += 0x9e3779b97f4a7c15u;
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
        return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-53;
    }
private:
    uint64_t state;
};

// Origins uniform in the disk of radius 2.5 at z = -5, l and m uniform in +-0.15.
inline const std::vector<sgt_ray> &rays()
{
    static const std::vector<sgt_ray> all = [] {
        std::vector<sgt_ray> made(RAYS);
        Random random;
        for (sgt_ray &ray : made) {
            double r = 2.5 * std::sqrt(random.unit()), phi = 2 * M_PI * random.unit();
            double l = 0.15 * (2 * random.unit() - 1), m = 0.15 * (2 * random.unit() - 1);
            ray = {{r * std::cos(phi), r * std::sin(phi), -5}, {l, m, std::sqrt(1 - l * l - m * m)}, 0, 0};
        }
        return made;
    }();
    return all;
}

// -------------------------------------------------------------- the surfaces

namespace catalogue {

constexpr double RIM = 4, C = 0.1, K = -0.6;

// Number i of the coefficients: of both signs, falling.
inline double coefficient(size_t i, double first)
{
    return (i % 3 == 1 ? -first : first) / (1 + 0.5 * static_cast<double>(i) * static_cast<double>(i));
}

class Kept {  // what the surfaces below point to
public:
    template <class S> const S *keep(const S &s)
    {
        std::shared_ptr<S> p = std::make_shared<S>(s);
        all.push_back(p);
        return p.get();
    }
    sgt_numbers list(size_t n, double first)
    {
        return table(1, n, [=](size_t, size_t j) { return coefficient(j, first); });
    }
    template <class Of> sgt_numbers table(size_t rows, size_t columns, Of of)
    {
        std::vector<double> x(rows * columns);
        for (size_t i = 0; i < rows; i++)
            for (size_t j = 0; j < columns; j++)
                x[i * columns + j] = of(i, j);
        return { keep(x)->data(), rows, columns };
    }
private:
    std::vector<std::shared_ptr<void>> all;
};

inline sgt_numbers powers(Kept &kept, size_t n)  // of degree 2 and more; each at most 0.01 at the rim
{
    return kept.table(n, n, [](size_t i, size_t j) {
        return i + j < 2 ? 0 : coefficient(i + j, 0.01) / std::pow(RIM, static_cast<double>(i + j));
    });
}

inline sgt_numbers waves(Kept &kept, size_t n)
{
    return kept.table(n, n, [](size_t i, size_t j) { return coefficient(i + j, 0.005); });
}

inline const sgt_grid *grid(Kept &kept, size_t n, double rim)
{
    double step = 2.1 * RIM / static_cast<double>(n - 1);
    sgt_numbers z = kept.table(n, n, [=](size_t i, size_t j) {
        double x = (static_cast<double>(j) - 0.5 * static_cast<double>(n - 1)) * step / RIM,
               y = (static_cast<double>(i) - 0.5 * static_cast<double>(n - 1)) * step / RIM;
        return 0.01 * std::cos(2 * x + y) + 0.003 * std::sin(3 * y - x);
    });
    sgt_grid g = { C, K, rim, step, step, z, 0, 0, 0 };
    sgt_grid_measure(&g);
    return kept.keep(g);
}

struct Subject {
    std::string name;
    const char *type;  // its row in docs/surfaces.md
    sgt_surface s;
    bool sag;
};

inline std::vector<Subject> subjects(Kept &kept, double rim = RIM)
{
    sgt_zernike fringe16 = {C, K, rim, RIM, SGT_FRINGE, 0, kept.list(16, 0.01)}, fringe37 = fringe16,
                noll = fringe16;
    fringe37.a = kept.list(37, 0.01), noll.order = SGT_NOLL, noll.normalised = 1,
    noll.a = kept.list(231, 0.005);
    sgt_even_asphere even = { C, K, rim, { 0, 1e-4, -2e-6, 1e-8 } };
    sgt_odd_asphere odd = { C, K, rim, { 0, 0, 5e-4, 1e-4, -2e-5, -2e-6, 1e-7, 1e-8 } };
    sgt_toroidal toroid = { C, K, 0.07, rim, { 0, 1e-4, -2e-6, 1e-8 } };
    const sgt_zernike *wave = kept.keep(fringe16);
    std::vector<sgt_surface> terms = {{&sgt_zernike_ops, wave}, {&sgt_even_asphere_ops, kept.keep(even)}};
    const std::vector<sgt_surface> *both = kept.keep(terms);
    sgt_quadric saddle = { { 0.05, 0.04, 0.01 }, { 0.01, 0.005, -0.005 }, { 0.02, 0.01, -1 }, -0.2 };
    std::vector<Subject> all = {
        {"conic", "conic", {&sgt_conic_ops, kept.keep(sgt_conic{C, K, rim})}, true},
        {"even_asphere", "even_asphere", {&sgt_even_asphere_ops, kept.keep(even)}, true},
        {"odd_asphere, to r^8", "odd_asphere", {&sgt_odd_asphere_ops, kept.keep(odd)}, true},
        {"polynomial_xy, 3 x 3",
         "polynomial_xy",
         {&sgt_polynomial_xy_ops, kept.keep(sgt_polynomial_xy{C, K, rim, powers(kept, 3)})},
         true},
        {"polynomial_xy, 10 x 10",
         "polynomial_xy",
         {&sgt_polynomial_xy_ops, kept.keep(sgt_polynomial_xy{C, K, rim, powers(kept, 10)})},
         true},
        {"toroidal, to y^8", "toroidal", {&sgt_toroidal_ops, kept.keep(toroid)}, true},
        {"biconic", "biconic", {&sgt_biconic_ops, kept.keep(sgt_biconic{C, K, 0.07, 0.3, rim})}, true},
        {"cylinder", "cylinder", {&sgt_biconic_ops, kept.keep(sgt_biconic{0, 0, C, K, rim})}, true},
        {"zernike, fringe, 16", "zernike", {&sgt_zernike_ops, wave}, true},
        {"zernike, fringe, 37", "zernike", {&sgt_zernike_ops, kept.keep(fringe37)}, true},
        {"zernike, noll, 231", "zernike", {&sgt_zernike_ops, kept.keep(noll)}, true},
        {"chebyshev, 5 x 5",
         "chebyshev",
         {&sgt_chebyshev_ops, kept.keep(sgt_chebyshev{C, K, rim, RIM, RIM, waves(kept, 5)})},
         true},
        {"chebyshev, 20 x 20",
         "chebyshev",
         {&sgt_chebyshev_ops, kept.keep(sgt_chebyshev{C, K, rim, RIM, RIM, waves(kept, 20)})},
         true},
        {"q_con, 8",
         "q_con",
         {&sgt_q_con_ops, kept.keep(sgt_q_con{C, K, rim, RIM, kept.list(8, 0.01)})},
         true},
        {"q_bfs, 8", "q_bfs", {&sgt_q_bfs_ops, kept.keep(sgt_q_bfs{C, rim, RIM, kept.list(8, 0.01)})}, true},
        {"grid, 64 x 64", "grid", {&sgt_grid_ops, grid(kept, 64, rim)}, true},
        {"grid, 512 x 512", "grid", {&sgt_grid_ops, grid(kept, 512, rim)}, true},
        {"sum, zernike 16 + even_asphere",
         "sum",
         {&sgt_sum_ops, kept.keep(sgt_sum{C, K, rim, both->data(), both->size()})},
         true},
        {"quadric", "quadric", {&sgt_quadric_ops, kept.keep(saddle)}, false},
        {"torus", "torus", {&sgt_torus_ops, kept.keep(sgt_torus{2, 1.5})}, false},
        {"ellipsoid", "ellipsoid", {&sgt_ellipsoid_ops, kept.keep(sgt_ellipsoid{5, 0.2})}, false},
    };
    for (const sgt_builtin *b = sgt_builtins(); b->type; b++) {  // any other, by its specimen, of rim RIM
        bool known = b->family == SGT_FAMILY_CONIC || b->family == SGT_FAMILY_LEVEL_SET;
        for (const Subject &s : all)
            known = known || s.s.ops == b->ops;
        if (!known)
            all.push_back({b->type, b->type, {b->ops, b->specimen}, b->family == SGT_FAMILY_DEPARTURE});
    }
    return all;
}

} // namespace catalogue
} // namespace bench
#endif
