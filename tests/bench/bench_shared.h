// SPDX-License-Identifier: MIT
// bench_shared.h - what the benchmarks of sags have in common: the surfaces, the peers that take one ray at
// a time, the clock and its table.
#ifndef BENCH_SHARED_H
#define BENCH_SHARED_H
#include <algorithm>
#include <benchmark/benchmark.h>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>
#include <sagitta/surfaces.h>
#include "bench_subjects.h"
#ifdef HAVE_BOOST
#include <boost/math/tools/roots.hpp>
#endif
#ifdef HAVE_GSL
#include <gsl/gsl_errno.h>
#include <gsl/gsl_roots.h>
#endif

namespace bench {

// -------------------------------------------------------------- the surfaces

struct Case {
    const char *name;
    double c, k, a2, a3, a4;  // of r^4, r^6, r^8
    bool asphere;
};
const Case CASES[] = {
    { "plane", 0, 0, 0, 0, 0, false },
    { "sphere", 0.1, 0, 0, 0, 0, false },
    { "paraboloid", 0.1, -1, 0, 0, 0, false },
    { "conic", 0.1, -0.6, 0, 0, 0, false },
    { "asphere", 0.1, -0.6, 1e-4, -2e-6, 1e-8, true },
};

struct Answer { double t; sgt_vec3 p, n; };

// F = z - s(x, y) and its gradient, as one writes them by hand.
inline double value(const Case &s, sgt_vec3 p, sgt_vec3 &n)
{
    double r2 = p.x * p.x + p.y * p.y;
    double root = std::sqrt(1 - (1 + s.k) * s.c * s.c * r2);
    double sag = s.c * r2 / (1 + root), slope = s.c / root;
    if (s.asphere) {
        sag += r2 * r2 * (s.a2 + r2 * (s.a3 + r2 * s.a4));
        slope += r2 * (4 * s.a2 + r2 * (6 * s.a3 + r2 * 8 * s.a4));
    }
    n = { -slope * p.x, -slope * p.y, 1 };
    return p.z - sag;
}

inline sgt_vec3 along(const sgt_ray &ray, double t)
{
    return { ray.o.x + t * ray.d.x, ray.o.y + t * ray.d.y, ray.o.z + t * ray.d.z };
}

inline std::pair<double, double> value_and_slope(const Case &s, const sgt_ray &ray, double t)
{
    sgt_vec3 n;
    double f = value(s, along(ray, t), n);
    return { f, n.x * ray.d.x + n.y * ray.d.y + n.z * ray.d.z };
}

inline Answer answer(const Case &s, const sgt_ray &ray, double t)
{
    Answer a = { t, along(ray, t), { 0, 0, 0 } };
    value(s, a.p, a.n);
    return a;
}

// All the iterations start where the ray meets the vertex plane; those whose end
// is ours to choose end with the first step below 1e-8 |t|: what is left after it
// is of the order of its square.
inline double seed(const sgt_ray &ray) { return -ray.o.z / ray.d.z; }
constexpr double LAST_STEP = 1e-8;

// ----------------------------------------------------- the peers, ray by ray

inline Answer by_newton(const Case &s, const sgt_ray &ray)
{
    double t = seed(ray);
    for (int i = 0; i < 100; i++) {
        std::pair<double, double> g = value_and_slope(s, ray, t);
        double step = g.first / g.second;
        t -= step;
        if (!(std::fabs(step) > LAST_STEP * std::fabs(t)))
            break;
    }
    return answer(s, ray, t);
}

// The conics only: from the point on the vertex plane, by the quadratic formula
// in the form that does not cancel.
inline Answer by_closed_form(const Case &s, const sgt_ray &ray)
{
    double t0 = seed(ray);
    sgt_vec3 p = along(ray, t0), d = ray.d;
    double a = s.c * (d.x * d.x + d.y * d.y + (1 + s.k) * d.z * d.z);
    double b = d.z - s.c * (d.x * p.x + d.y * p.y);
    double c = s.c * (p.x * p.x + p.y * p.y);
    double t = c / (b + std::copysign(std::sqrt(b * b - a * c), b));
    return answer(s, ray, t0 + t);
}

#ifdef HAVE_BOOST
// Asked for all 53 bits; and for 31, which Boost's manual advises (0.6 of them:
// the step that brings those doubles their number).
template <int bits>
Answer by_boost(const Case &s, const sgt_ray &ray)
{
    boost::uintmax_t most = 100;
    double t = boost::math::tools::newton_raphson_iterate(
        [&](double at) { return value_and_slope(s, ray, at); }, seed(ray), 0.0, 20.0, bits, most);
    return answer(s, ray, t);
}
#endif

#ifdef HAVE_GSL
struct Equation { const Case *s; const sgt_ray *ray; };

inline double gsl_value(double t, void *data)
{
    Equation *e = static_cast<Equation *>(data);
    return value_and_slope(*e->s, *e->ray, t).first;
}
inline double gsl_slope(double t, void *data)
{
    Equation *e = static_cast<Equation *>(data);
    return value_and_slope(*e->s, *e->ray, t).second;
}
inline void gsl_both(double t, void *data, double *f, double *df)
{
    Equation *e = static_cast<Equation *>(data);
    std::pair<double, double> g = value_and_slope(*e->s, *e->ray, t);
    *f = g.first;
    *df = g.second;
}

inline Answer by_gsl(const Case &s, const sgt_ray &ray)
{
    static gsl_root_fdfsolver *solver = gsl_root_fdfsolver_alloc(gsl_root_fdfsolver_newton);
    Equation equation = { &s, &ray };
    gsl_function_fdf function = { gsl_value, gsl_slope, gsl_both, &equation };
    double t = seed(ray), before;
    gsl_root_fdfsolver_set(solver, &function, t);
    for (int i = 0; i < 100; i++) {
        before = t;
        if (gsl_root_fdfsolver_iterate(solver) != GSL_SUCCESS)
            break;
        t = gsl_root_fdfsolver_root(solver);
        if (gsl_root_test_delta(t, before, 0, LAST_STEP) == GSL_SUCCESS)
            break;
    }
    return answer(s, ray, t);
}
#endif

struct Peer {
    const char *name;
    Answer (*solve)(const Case &, const sgt_ray &);
    bool asphere;  // can it?
};
const Peer PEERS[] = {
    { "newton-by-hand", by_newton, true },
    { "closed-form-by-hand", by_closed_form, false },
#ifdef HAVE_BOOST
    { "boost-newton_raphson_iterate", by_boost<53>, true },
    { "boost-newton_raphson_iterate-31-bits", by_boost<31>, true },
#endif
#ifdef HAVE_GSL
    { "gsl-fdfsolver_newton", by_gsl, true },
#endif
};

struct Surface {  // a case as sagitta takes it
    sgt_conic conic;
    sgt_even_asphere asphere;
    sgt_surface surface() const
    {
        if (is_asphere)
            return { &sgt_even_asphere_ops, &asphere };
        return { &sgt_conic_ops, &conic };
    }
    bool is_asphere;
    explicit Surface(const Case &s)
        : conic(), asphere(), is_asphere(s.asphere)
    {
        conic.c = asphere.c = s.c;
        conic.k = asphere.k = s.k;
        asphere.semi_diameter = 4;
        asphere.a[1] = s.a2;
        asphere.a[2] = s.a3;
        asphere.a[3] = s.a4;
    }
};

// ---------------------------------------------------------------- the clock

struct Row {  // of the csv: `pass` does `items` of work
    std::string of, variant;
    double items;
    std::function<void()> pass;
    std::string name() const { return of + "/" + variant; }
};

class Table : public benchmark::ConsoleReporter {  // prints medians and spreads, keeps each time
public:
    explicit Table(const std::vector<Row> &rows) : ConsoleReporter(OO_Tabular)
    {
        for (const Row &row : rows)
            items[row.name()] = row.items;
    }
    void ReportRuns(const std::vector<Run> &runs) override
    {
        std::vector<Run> shown;
        for (const Run &one : runs)
            if (one.run_type == Run::RT_Iteration) {
                const std::string &name = one.run_name.function_name;
                times[name].push_back(one.cpu_accumulated_time / static_cast<double>(one.iterations) /
                                      items[name] * 1e9);
            } else if (one.aggregate_name == "median" || one.aggregate_name == "cv") {
                shown.push_back(one);
            }
        if (!shown.empty())
            ConsoleReporter::ReportRuns(shown);
    }
    double median(const std::string &name) const  // ns; NaN: not run
    {
        auto found = times.find(name);
        if (found == times.end())
            return NAN;
        std::vector<double> sorted = found->second;
        std::sort(sorted.begin(), sorted.end());
        size_t n = sorted.size();
        return (sorted[(n - 1) / 2] + sorted[n / 2]) / 2;
    }
private:
    std::map<std::string, double> items;
    std::map<std::string, std::vector<double>> times;
};

// Runs the rows, the repetitions of all shuffled among each other, and prints the medians as csv.  words:
// options of Google Benchmark, which those of the command line overrule.  false: one of these was not
// understood.
inline bool run(const std::vector<Row> &rows, std::vector<std::string> words, int argc, char **argv,
                Table &table)
{
    words.insert(words.begin(), argv[0]);
    words.push_back("--benchmark_enable_random_interleaving=true");
    words.insert(words.end(), argv + 1, argv + argc);
    std::vector<char *> arguments;
    for (std::string &word : words)
        arguments.push_back(&word[0]);
    int count = static_cast<int>(arguments.size());
    arguments.push_back(nullptr);
    benchmark::Initialize(&count, arguments.data());
    if (benchmark::ReportUnrecognizedArguments(count, arguments.data()))
        return false;
#ifndef HAVE_BOOST
    std::printf("skipped: Boost.Math was not found when this was built\n");
#endif
#ifndef HAVE_GSL
    std::printf("skipped: GSL was not found when this was built\n");
#endif
    for (const Row &row : rows)
        benchmark::RegisterBenchmark(row.name().c_str(), [&row](benchmark::State &state) {
            for (auto _ : state)
                row.pass();
            state.SetItemsProcessed(
                static_cast<int64_t>(static_cast<double>(state.iterations()) * row.items));
        })->Unit(benchmark::kMicrosecond);
    benchmark::RunSpecifiedBenchmarks(&table);
    std::printf("\ncase,variant,ns,per_second\n");
    for (const Row &row : rows) {
        double ns = table.median(row.name());
        if (!std::isnan(ns))
            std::printf("%s,%s,%.2f,%.4g\n", row.of.c_str(), row.variant.c_str(), ns, 1e9 / ns);
    }
    return true;
}

} // namespace bench
#endif
