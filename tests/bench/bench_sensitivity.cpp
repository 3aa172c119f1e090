// SPDX-License-Identifier: MIT
// sgt_differentiate_batch beside sgt_intersect_batch on the same rays: what do the derivatives cost?
//
//     build/tests/bench/bench_sensitivity [--benchmark_... of Google Benchmark]
//
// 1e3: rays and answers are in the processor's cache.  1e6: both come from memory, and all answers go
// there.  1e6-tiles: the rays come from memory, a thousand at a time, and the answers are used up before
// the next thousand (they stay in the cache): so sensitivity.h advises.
//
// Before the clock starts the batch has answered, and every 17th ray's answer was compared with the single
// ray's, to the last bit.  The repetitions of all are shuffled among each other; the csv has the medians,
// case,variant,ns,per_second, per ray.  Behind it stands what is to be reached: batch-and-sensitivities, dt
// by the ray and by every parameter, within 2 times batch (status, t, t_err, p, n).
#include <cstring>
#include <deque>
#include <sagitta/sensitivity.h>
#include "bench_shared.h"

using namespace bench;

namespace {

constexpr size_t TILE = 1000;

struct Subject { const char *name; sgt_surface surface; };

sgt_conic plane, sphere, conic;
sgt_even_asphere three, eight, term;
sgt_odd_asphere odd_asphere;
sgt_polynomial_xy polynomial_xy, tilt;
sgt_chebyshev chebyshev;
sgt_zernike zernike;
sgt_q_con q_con;
sgt_q_bfs q_bfs;
sgt_grid grid;
sgt_sum sum;
sgt_surface terms[2] = { { &sgt_even_asphere_ops, &term }, { &sgt_polynomial_xy_ops, &tilt } };
sgt_toroidal toroidal;
sgt_biconic biconic;
sgt_quadric quadric;
sgt_ellipsoid ellipsoid;
sgt_torus torus;
double coefficients[36], heights[41 * 41];

// A table of so many, the one smaller than the other the higher its order.
sgt_numbers table(size_t rows, size_t columns) { return { coefficients, rows, columns }; }

template <class Sag>
void base(Sag &s)
{
    s.c = 0.1;
    s.k = -0.6;
    s.semi_diameter = 4;
}

std::vector<Subject> subjects()
{
    Random random;
    for (double &a : coefficients)
        a = 1e-2 * (2 * random.unit() - 1);
    for (double &z : heights)
        z = 1e-2 * (2 * random.unit() - 1);
    sphere.c = conic.c = 0.1;
    conic.k = -0.6;
    base(three), base(eight), base(odd_asphere), base(polynomial_xy), base(chebyshev), base(zernike),
        base(q_con), base(grid), base(sum), base(toroidal);
    const double a[8] = { 1e-5, 1e-4, -2e-6, 1e-8, 3e-10, -1e-11, 2e-13, -1e-15 };
    std::copy(a + 1, a + 4, three.a + 1), std::copy(a, a + 8, eight.a), std::copy(a, a + 4, term.a),
        std::copy(a, a + 4, toroidal.a);
    for (int i = 0; i < 8; i++)
        odd_asphere.a[i] = coefficients[i] / std::pow(4.0, i);
    static double powers[25];
    for (int i = 0; i < 5; i++)
        for (int j = 0; j < 5; j++)
            powers[5 * i + j] = coefficients[5 * i + j] / std::pow(4.0, i + j);
    polynomial_xy.a = { powers, 5, 5 };
    tilt.a = { powers, 2, 2 };
    chebyshev.norm_x = chebyshev.norm_y = zernike.norm = q_con.norm = q_bfs.norm = 5;
    chebyshev.a = table(5, 5);
    zernike.a = table(1, 36);
    zernike.order = SGT_NOLL;
    q_con.a = q_bfs.a = table(1, 8);
    q_bfs.c = 0.1, q_bfs.semi_diameter = 4;
    grid.step_x = grid.step_y = 0.3;
    grid.z = { heights, 41, 41 };
    sum.terms = terms, sum.count = 2;
    toroidal.c_x = 0.05;
    biconic = { 0.1, -0.6, 0.05, -1, 4 };
    quadric = { { 1, 1.2, 0.8 }, { 0.1, 0.2, 0.1 }, { 0, 0, -20 }, 0 };
    ellipsoid = { 4, 0.1 };
    torus = { 2, 1.5 };
    return {
        { "plane", { &sgt_conic_ops, &plane } },
        { "sphere", { &sgt_conic_ops, &sphere } },
        { "conic", { &sgt_conic_ops, &conic } },
        { "asphere-3-terms", { &sgt_even_asphere_ops, &three } },
        { "asphere-8-terms", { &sgt_even_asphere_ops, &eight } },
        { "odd-asphere", { &sgt_odd_asphere_ops, &odd_asphere } },
        { "polynomial-5x5", { &sgt_polynomial_xy_ops, &polynomial_xy } },
        { "chebyshev-5x5", { &sgt_chebyshev_ops, &chebyshev } },
        { "zernike-36", { &sgt_zernike_ops, &zernike } },
        { "q-con-8", { &sgt_q_con_ops, &q_con } },
        { "q-bfs-8", { &sgt_q_bfs_ops, &q_bfs } },
        { "grid-41x41", { &sgt_grid_ops, &grid } },
        { "sum", { &sgt_sum_ops, &sum } },
        { "toroidal", { &sgt_toroidal_ops, &toroidal } },
        { "biconic", { &sgt_biconic_ops, &biconic } },
        { "quadric", { &sgt_quadric_ops, &quadric } },
        { "ellipsoid", { &sgt_ellipsoid_ops, &ellipsoid } },
        { "torus", { &sgt_torus_ops, &torus } },
    };
}

struct Size { const char *name; size_t n, answers; };
const Size SIZES[] = { { "1e3", TILE, TILE }, { "1e6", RAYS, RAYS }, { "1e6-tiles", RAYS, TILE } };

// Arrays of doubles in one block, each at a line of the cache.
class Block {
public:
    Block(size_t arrays, size_t n) : stride((n + 15) / 8 * 8), block(arrays * stride + 8)
    {
        first = block.data();
        while (reinterpret_cast<uintptr_t>(first) % 64 != 0)
            first++;
    }
    double *next() { return first + stride * taken++; }
private:
    size_t stride, taken = 0;
    std::vector<double> block;
    double *first;
};

enum What { BATCH, RAY, SENSITIVITIES, TURNS };  // the derivatives of t by the ray; by all; and those of n

struct Work {
    Work(const Subject &of, const Size &size)
        : subject(of), n(size.n), answers(size.answers), count(sgt_parameters(of.surface)), in(6, n),
          out(17 + 4 * count, answers), status(answers)
    {
        for (double *&array : ray)
            array = in.next();
        for (size_t i = 0; i < n; i++) {
            const sgt_ray &one = rays()[i];
            ray[0][i] = one.o.x, ray[1][i] = one.o.y, ray[2][i] = one.o.z;
            ray[3][i] = one.d.x, ray[4][i] = one.d.y, ray[5][i] = one.d.z;
        }
        hits = {};
        hits.status = status.data();
        hits.t = out.next();
        hits.t_err = out.next();
        for (int i = 0; i < 3; i++)
            hits.p[i] = out.next(), hits.n[i] = out.next();
        for (int i = 0; i < 3; i++)
            by_ray[i] = out.next();
        for (size_t j = 0; j < count; j++)
            by_parameter.push_back(out.next());
        for (int i = 0; i < 3; i++)
            for (size_t j = 0; j < count; j++)
                turned[i].push_back(out.next());
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 2; j++)
                turned_by_ray[i][j] = out.next();
    }
    void batch(size_t from)
    {
        sgt_intersect_batch(subject.surface, answers, from_ray(from), hits, nullptr);
    }
    void differentiate(size_t from, What what)
    {
        sgt_jacobian jacobian = {};
        for (int i = 0; i < 3; i++) {
            jacobian.t_by_o[i] = by_ray[i];
            if (what == TURNS)
                jacobian.n_by_a[i] = turned[i].data();
            for (int j = 0; j < 2 && what == TURNS; j++)
                jacobian.n_by_o[i][j] = turned_by_ray[i][j];
        }
        if (what != RAY)
            jacobian.t_by_a = by_parameter.data();
        sgt_differentiate_batch(subject.surface, answers, from_ray(from), hits, jacobian);
    }
    // Every 17th ray of the last tile.
    bool right()
    {
        size_t from = n - answers, wrong = 0;
        batch(from);
        differentiate(from, SENSITIVITIES);
        for (size_t i = 0; i < answers; i += 17) {
            sgt_ray one = rays()[from + i];
            sgt_hit hit = sgt_intersect(subject.surface, one, nullptr);
            std::vector<sgt_change> a(count);
            sgt_change o[3];
            sgt_differentiate(subject.surface, &one, &hit, o, a.data());
            bool same = true;
            for (int j = 0; j < 3; j++)
                same &= equal(by_ray[j][i], o[j].t);
            for (size_t j = 0; j < count; j++)
                same &= equal(by_parameter[j][i], a[j].t);
            wrong += !same;
        }
        if (wrong)
            std::printf("%s: %zu rays are wrong\n", subject.name, wrong);
        return wrong == 0;
    }
    Subject subject;
    size_t n, answers, count;
private:
  static bool equal(double a, double b)
  {
      return std::memcmp(&a, &b, sizeof a) == 0 || (std::isnan(a) && std::isnan(b));
  }
  sgt_rays from_ray(size_t i) const
  {
      return {{ray[0] + i, ray[1] + i, ray[2] + i}, {ray[3] + i, ray[4] + i, ray[5] + i}, nullptr, nullptr};
  }
    Block in, out;
    std::vector<sgt_status> status;
    std::vector<double *> by_parameter, turned[3];
    double *ray[6], *by_ray[3], *turned_by_ray[3][2];
    sgt_hits hits;
};

struct Variant { const char *name; bool batch, differentiate; What what; };
const Variant VARIANTS[] = {
    { "batch", true, false, BATCH },
    { "batch-and-by-ray", true, true, RAY },
    { "batch-and-sensitivities", true, true, SENSITIVITIES },
    { "batch-and-sensitivities-and-of-n", true, true, TURNS },
};

void pass(Work &w, const Variant &v)
{
    for (size_t from = 0; from < w.n; from += w.answers) {
        w.batch(from);
        if (v.differentiate)
            w.differentiate(from, v.what);
    }
}

} // namespace

int main(int argc, char **argv)
{
    std::deque<Work> works;
    std::vector<Row> rows;
    std::vector<std::string> cases;
    for (const Subject &subject : subjects())
        for (const Size &size : SIZES) {
            if (&size == SIZES + 1 && sgt_parameters(subject.surface) > 10)
                continue;
            works.emplace_back(subject, size);
            Work &work = works.back();
            if (!work.right())
                return 1;
            cases.push_back(std::string(subject.name) + "-" + size.name);
            for (const Variant &v : VARIANTS)
                rows.push_back(
                    {cases.back(), v.name, static_cast<double>(work.n), [&work, &v] { pass(work, v); }});
        }
    Table table(rows);
    if (!run(rows, { "--benchmark_repetitions=9", "--benchmark_min_time=0.02" }, argc, argv, table))
        return 2;
    std::printf("\n%-28s %10s %12s %12s %12s\n", "", "batch, ns", "by ray", "by all", "and of n");
    for (const std::string &one : cases) {
        double plain = table.median(one + "/batch");
        if (std::isnan(plain))
            continue;
        std::printf("%-28s %10.2f", one.c_str(), plain);
        for (const Variant &v : VARIANTS)
            if (v.differentiate)
                std::printf(" %7.2f times", table.median(one + "/" + v.name) / plain);
        std::printf("\n");
    }
    std::printf("to reach: by all at most 2 times\n");
    return 0;
}
