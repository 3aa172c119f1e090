// SPDX-License-Identifier: MIT
// The surfaces beyond conics and even aspheres, through sgt_intersect_batch and the single ray, beside
// their formula by itself and Boost's Newton on it.
//
//     build/tests/bench/bench_catalogue [--benchmark_... of Google Benchmark]
//
// Per surface 1000 rays of bench_subjects.h, the arrays in the processor's cache:
//     first, near            a batch, the first root and the one near the seed
//     one-first, one-near    sgt_intersect in a loop
//     formula                `values` at the points of the answers, in blocks of 64 as the batch asks for
//                            them
//     boost-...              from the vertex plane, on the surface's own `value`; sags only
// Before the clock starts each batch is compared with the single ray's answers, to the last bit, and
// Boost's t with them within 1e-13.  The repetitions of all are shuffled among each other; the csv has the
// medians in ns per ray (formula: per point).  Behind it stands a table, one line for each surface: what
// docs/surfaces_table.py puts into docs/surfaces.md.  times: a batch of first roots, divided by what as
// many evaluations cost in the formula alone.
#include <cstring>
#include <deque>
#include "bench_shared.h"

using namespace bench;
using namespace bench::catalogue;

namespace {

constexpr size_t N = 1000, BLOCK = 64;

struct Arrays {
    Arrays() : in(6, std::vector<double>(N)), out(10, std::vector<double>(N)), status(N), evals(N)
    {
        for (size_t i = 0; i < N; i++) {
            const sgt_ray &ray = rays()[i];
            in[0][i] = ray.o.x, in[1][i] = ray.o.y, in[2][i] = ray.o.z;
            in[3][i] = ray.d.x, in[4][i] = ray.d.y, in[5][i] = ray.d.z;
        }
    }
    sgt_rays given() const
    {
        return {{in[0].data(), in[1].data(), in[2].data()},
                {in[3].data(), in[4].data(), in[5].data()},
                nullptr,
                nullptr};
    }
    sgt_hits hits(bool everything)  // else status, t, t_err, p, n
    {
        sgt_hits h = {};
        h.status = status.data(), h.t = out[0].data(), h.t_err = out[1].data();
        for (size_t k = 0; k < 3; k++)
            h.p[k] = out[2 + k].data(), h.n[k] = out[5 + k].data();
        if (everything)
            h.evals = evals.data(), h.t_lo = out[8].data(), h.p_err = out[9].data();
        return h;
    }
    std::vector<std::vector<double>> in, out;
    std::vector<sgt_status> status;
    std::vector<int> evals;
};

struct Work {
    Subject of;
    double met, evals_first, evals_near;  // means of a ray
    size_t points;
    std::vector<double> at;               // where the surface is met, all x, all y, all z
};

sgt_options picking(sgt_pick pick)
{
    sgt_options opt = {};
    opt.pick = pick;
    return opt;
}

void one_by_one(const Work &w, Arrays &a, sgt_pick pick)
{
    sgt_hits h = a.hits(false);
    const sgt_options opt = picking(pick);
    for (size_t i = 0; i < N; i++) {
        sgt_hit hit = sgt_intersect(w.of.s, rays()[i], &opt);
        h.status[i] = hit.status;
        h.t[i] = hit.t, h.t_err[i] = hit.t_err;
        h.p[0][i] = hit.p.x, h.p[1][i] = hit.p.y, h.p[2][i] = hit.p.z;
        h.n[0][i] = hit.n.x, h.n[1][i] = hit.n.y, h.n[2][i] = hit.n.z;
    }
}

void batch(const Work &w, Arrays &a, sgt_pick pick)
{
    const sgt_options opt = picking(pick);
    sgt_intersect_batch(w.of.s, N, a.given(), a.hits(false), &opt);
}

void formula(const Work &w)
{
    double out[4][BLOCK];
    const double *x = w.at.data();
    for (size_t i = 0, few; i < w.points; i += few, x += few) {
        few = std::min(BLOCK, w.points - i);
        w.of.s.ops->values(w.of.s.self, few, {{x, x + w.points, x + 2 * w.points}},
                           {out[0], {out[1], out[2], out[3]}});
        benchmark::DoNotOptimize(out);
    }
}

#ifdef HAVE_BOOST
double by_boost(const sgt_surface &s, const sgt_ray &ray)
{
    boost::uintmax_t most = 100;
    return boost::math::tools::newton_raphson_iterate(
        [&](double t) {
            sgt_vec3 n;
            double f = s.ops->value(s.self, along(ray, t), &n);
            return std::make_pair(f, n.x * ray.d.x + n.y * ray.d.y + n.z * ray.d.z);
        }, seed(ray), 0.0, 20.0, 31, most);
}

void boost_by_one(const Work &w, Arrays &a)
{
    for (size_t i = 0; i < N; i++) {
        const sgt_ray &ray = rays()[i];
        double t = by_boost(w.of.s, ray);
        sgt_vec3 p = along(ray, t), n;
        w.of.s.ops->value(w.of.s.self, p, &n);
        a.out[0][i] = t, a.out[2][i] = p.x, a.out[3][i] = p.y, a.out[4][i] = p.z, a.out[5][i] = n.x,
        a.out[6][i] = n.y, a.out[7][i] = n.z;
    }
}
#endif

bool same(double a, double b)
{
    return std::memcmp(&a, &b, sizeof a) == 0 || (std::isnan(a) && std::isnan(b));
}

// Compares, and fills in what is counted.
bool right(Work &w)
{
    size_t wrong = 0, hits = 0;
    std::vector<double> at[3];
    for (sgt_pick pick : { SGT_FIRST, SGT_NEAR_SEED }) {
        Arrays a;
        const sgt_options opt = picking(pick);
        sgt_hits h = a.hits(true);
        sgt_intersect_batch(w.of.s, N, a.given(), h, &opt);
        double evals = 0;
        for (size_t i = 0; i < N; i++) {
            sgt_hit one = sgt_intersect(w.of.s, rays()[i], &opt);
            const double p[] = { one.p.x, one.p.y, one.p.z }, n[] = { one.n.x, one.n.y, one.n.z };
            bool good = h.status[i] == one.status && h.evals[i] == one.evals && same(h.t[i], one.t) &&
                        same(h.t_err[i], one.t_err) && same(h.t_lo[i], one.t_lo) &&
                        same(h.p_err[i], one.p_err);
            for (int k = 0; k < 3; k++)
                good = good && same(h.p[k][i], p[k]) && same(h.n[k][i], n[k]);
            wrong += !good;
            evals += one.evals;
            if (pick != SGT_FIRST || one.status != SGT_HIT)
                continue;
            hits++;
            for (int k = 0; k < 3; k++)
                at[k].push_back(p[k]);
#ifdef HAVE_BOOST
            wrong += w.of.sag && !(std::fabs(by_boost(w.of.s, rays()[i]) - one.t) < 1e-13);
#endif
        }
        (pick == SGT_FIRST ? w.evals_first : w.evals_near) = evals / static_cast<double>(N);
    }
    w.met = static_cast<double>(hits) / static_cast<double>(N);
    w.points = hits;
    for (std::vector<double> &x : at)
        w.at.insert(w.at.end(), x.begin(), x.end());
    if (wrong)
        std::printf("%s: %zu rays are wrong\n", w.of.name.c_str(), wrong);
    return wrong == 0 && hits > 0;
}

// What the operations offer beside value and gradient.
std::string offers(const sgt_surface_ops *ops)
{
    const std::pair<bool, const char *> all[] = {
        {ops->span != nullptr, "span"},
        {ops->first != nullptr, "first"},
        {ops->clearance != nullptr, "clearance"},
        {ops->enclose != nullptr, "enclose"},
        {ops->rounding != nullptr, "rounding"},
        {ops->second != nullptr && ops->by_parameter != nullptr, "sensitivities"},
    };
    std::string said;
    for (const std::pair<bool, const char *> &one : all)
        if (one.first)
            said += (said.empty() ? "" : ", ") + std::string(one.second);
    return said;
}

void print_table(const Table &table, const std::deque<Work> &works)
{
    std::printf("\ntype;surface;offers;met;evaluations;first;near;one-first;one-near;formula;times;boost\n");
    for (const Work &w : works) {
        auto ns = [&](const char *variant) { return table.median(w.of.name + "/" + variant); };
        auto cell = [](double x) {
            char text[32];
            std::snprintf(text, sizeof text, ";%.3g", x);
            return std::string(std::isnan(x) ? ";-" : text);
        };
        double first = ns("first"), by_itself = ns("formula");
        if (std::isnan(first))
            continue;
        std::string line = std::string(w.of.type) + ";" + w.of.name + ";" + offers(w.of.s.ops);
        for (double x : {w.met, w.evals_first, first, ns("near"), ns("one-first"), ns("one-near"), by_itself,
                         first / (by_itself * w.evals_first), ns("boost-newton_raphson_iterate-31-bits")})
            line += cell(x);
        std::printf("%s\n", line.c_str());
    }
}

} // namespace

int main(int argc, char **argv)
{
    Kept kept;
    Arrays arrays;
    std::deque<Work> works;
    std::vector<Row> rows;
    bool all_right = true;
    for (const Subject &of : subjects(kept)) {
        works.push_back({ of, 0, 0, 0, 0, {} });
        Work &w = works.back();
        all_right &= right(w);
        rows.push_back({ of.name, "first", N, [&w, &arrays] { batch(w, arrays, SGT_FIRST); } });
        rows.push_back({ of.name, "near", N, [&w, &arrays] { batch(w, arrays, SGT_NEAR_SEED); } });
        rows.push_back({ of.name, "one-first", N, [&w, &arrays] { one_by_one(w, arrays, SGT_FIRST); } });
        rows.push_back({ of.name, "one-near", N, [&w, &arrays] { one_by_one(w, arrays, SGT_NEAR_SEED); } });
        if (of.s.ops->values)
            rows.push_back({ of.name, "formula", static_cast<double>(w.points), [&w] { formula(w); } });
#ifdef HAVE_BOOST
        if (of.sag)
            rows.push_back({of.name, "boost-newton_raphson_iterate-31-bits", N,
                            [&w, &arrays] { boost_by_one(w, arrays); }});
#endif
    }
    if (!all_right)
        return 1;
    Table table(rows);
    if (!run(rows, { "--benchmark_repetitions=9", "--benchmark_min_time=0.01" }, argc, argv, table))
        return 2;
    print_table(table, works);
    return 0;
}
