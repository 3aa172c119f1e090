// One ray at a time through sgt_intersect, beside what a person would otherwise
// write or take: Newton by hand, the closed form by hand, Boost.Math's
// newton_raphson_iterate, GSL's root_fdfsolver.  All do the same work on the same
// million rays in one run: t to rounding, the point, and the gradient of
// z - s(x, y).  That they do is checked before the clock starts.
//
//     build/tests/tests/bench/bench_one_ray [--benchmark_... of Google Benchmark]
//
// The repetitions of all variants are shuffled among each other, so that a busy
// moment of the machine falls on no one side.  Ends with the medians as csv:
// case,variant,ns,per_second.
#include <algorithm>
#include <benchmark/benchmark.h>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <string>
#include <utility>
#include <vector>
#include <sagitta/surfaces.h>
#ifdef HAVE_BOOST
#include <boost/math/tools/roots.hpp>
#endif
#ifdef HAVE_GSL
#include <gsl/gsl_errno.h>
#include <gsl/gsl_roots.h>
#endif

namespace {

// ------------------------------------------------------------------ the rays

constexpr size_t RAYS = 1000000;

class Random {  // splitmix64: Steele, Lea, Flood, OOPSLA 2014
public:
    double unit()
    {
        uint64_t z = state += 0x9e3779b97f4a7c15u;
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
        return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-53;
    }
private:
    uint64_t state = 0x1234567;
};

// Origins uniform in the disk of radius 2.5 at z = -5, l and m uniform in +-0.15.
const std::vector<sgt_ray> &rays()
{
    static const std::vector<sgt_ray> all = [] {
        std::vector<sgt_ray> made(RAYS);
        Random random;
        for (sgt_ray &ray : made) {
            double r = 2.5 * std::sqrt(random.unit()), phi = 2 * M_PI * random.unit();
            double l = 0.15 * (2 * random.unit() - 1), m = 0.15 * (2 * random.unit() - 1);
            ray = { { r * std::cos(phi), r * std::sin(phi), -5 }, { l, m, std::sqrt(1 - l * l - m * m) }, 0, 0 };
        }
        return made;
    }();
    return all;
}

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

// -------------------------------------------------------------- the variants

Answer by_newton(const Case &s, const sgt_ray &ray)
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
Answer by_closed_form(const Case &s, const sgt_ray &ray)
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

double gsl_value(double t, void *data)
{
    Equation *e = static_cast<Equation *>(data);
    return value_and_slope(*e->s, *e->ray, t).first;
}
double gsl_slope(double t, void *data)
{
    Equation *e = static_cast<Equation *>(data);
    return value_and_slope(*e->s, *e->ray, t).second;
}
void gsl_both(double t, void *data, double *f, double *df)
{
    Equation *e = static_cast<Equation *>(data);
    std::pair<double, double> g = value_and_slope(*e->s, *e->ray, t);
    *f = g.first;
    *df = g.second;
}

Answer by_gsl(const Case &s, const sgt_ray &ray)
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

struct Variant {
    const char *name;
    Answer (*solve)(const Case &, const sgt_ray &);  // NULL: sagitta
    bool asphere;                                    // can it?
};
const Variant VARIANTS[] = {
    { "sagitta", nullptr, true },
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
    sgt_asphere asphere;
    sgt_surface surface() const
    {
        if (is_asphere)
            return { &sgt_asphere_ops, &asphere };
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

// ----------------------------------------------------- the same work by each

double off(sgt_vec3 a, sgt_vec3 b)
{
    return std::max(std::fabs(a.x - b.x), std::max(std::fabs(a.y - b.y), std::fabs(a.z - b.z)));
}

bool same_work()
{
    bool same = true;
    for (const Case &s : CASES) {
        Surface ours(s);
        double worst[sizeof VARIANTS / sizeof VARIANTS[0]] = { 0 };
        size_t without = 0;
        for (const sgt_ray &ray : rays()) {
            sgt_hit hit = sgt_intersect(ours.surface(), ray, nullptr);
            without += hit.status != SGT_HIT;
            for (size_t v = 1; v < sizeof VARIANTS / sizeof VARIANTS[0]; v++)
                if (!s.asphere || VARIANTS[v].asphere) {
                    Answer a = VARIANTS[v].solve(s, ray);
                    double d = std::max(std::fabs(a.t - hit.t), std::max(off(a.p, hit.p), off(a.n, hit.n)));
                    worst[v] = d <= worst[v] ? worst[v] : d;
                }
        }
        // Lengths up to 6: one ulp of t is 8.9e-16.
        for (size_t v = 1; v < sizeof VARIANTS / sizeof VARIANTS[0]; v++)
            if (!(worst[v] < 8e-15)) {
                std::printf("%s, %s: off by %g\n", s.name, VARIANTS[v].name, worst[v]);
                same = false;
            }
        if (without) {
            std::printf("%s: %zu rays without a hit\n", s.name, without);
            same = false;
        }
    }
    return same;
}

// -------------------------------------------------------------------- timing

void run(benchmark::State &state, const Case &s, const Variant &variant)
{
    const std::vector<sgt_ray> &all = rays();
    if (variant.solve) {
        for (auto _ : state)
            for (const sgt_ray &ray : all) {
                Answer a = variant.solve(s, ray);
                benchmark::DoNotOptimize(a);
            }
    } else {
        Surface ours(s);
        sgt_surface surface = ours.surface();
        for (auto _ : state)
            for (const sgt_ray &ray : all) {
                sgt_hit hit = sgt_intersect(surface, ray, nullptr);
                benchmark::DoNotOptimize(hit);
            }
    }
    state.SetItemsProcessed(static_cast<int64_t>(state.iterations() * RAYS));
}

class Table : public benchmark::ConsoleReporter {  // prints medians and spreads, keeps each time
public:
    Table() : ConsoleReporter(OO_Tabular) {}
    void ReportRuns(const std::vector<Run> &runs) override
    {
        std::vector<Run> shown;
        for (const Run &one : runs)
            if (one.run_type == Run::RT_Iteration)
                times[one.run_name.function_name].push_back(
                    one.cpu_accumulated_time / static_cast<double>(one.iterations) / RAYS * 1e9);
            else if (one.aggregate_name == "median" || one.aggregate_name == "cv")
                shown.push_back(one);
        if (!shown.empty())
            ConsoleReporter::ReportRuns(shown);
    }
    void csv()
    {
        std::printf("\ncase,variant,ns,per_second\n");
        for (const Case &s : CASES)
            for (const Variant &variant : VARIANTS) {
                auto found = times.find(std::string(s.name) + "/" + variant.name);
                if (found == times.end())
                    continue;
                std::vector<double> &sorted = found->second;
                std::sort(sorted.begin(), sorted.end());
                size_t n = sorted.size();
                double ns = (sorted[(n - 1) / 2] + sorted[n / 2]) / 2;
                std::printf("%s,%s,%.2f,%.4g\n", s.name, variant.name, ns, 1e9 / ns);
            }
    }
private:
    std::map<std::string, std::vector<double>> times;
};

} // namespace

int main(int argc, char **argv)
{
    if (!same_work())
        return 1;
    std::vector<std::string> words = { argv[0], "--benchmark_repetitions=7", "--benchmark_min_time=0.1",
                                       "--benchmark_enable_random_interleaving=true" };
    words.insert(words.end(), argv + 1, argv + argc);
    std::vector<char *> arguments;
    for (std::string &word : words)
        arguments.push_back(&word[0]);
    int count = static_cast<int>(arguments.size());
    arguments.push_back(nullptr);
    benchmark::Initialize(&count, arguments.data());
    if (benchmark::ReportUnrecognizedArguments(count, arguments.data()))
        return 2;

#ifndef HAVE_BOOST
    std::printf("skipped: Boost.Math was not found when this was built\n");
#endif
#ifndef HAVE_GSL
    std::printf("skipped: GSL was not found when this was built\n");
#endif
    for (const Case &s : CASES)
        for (const Variant &variant : VARIANTS)
            if (!s.asphere || variant.asphere)
                benchmark::RegisterBenchmark((std::string(s.name) + "/" + variant.name).c_str(),
                                             [&](benchmark::State &state) { run(state, s, variant); })
                    ->Unit(benchmark::kMillisecond);
    Table table;
    benchmark::RunSpecifiedBenchmarks(&table);
    table.csv();
    return 0;
}
