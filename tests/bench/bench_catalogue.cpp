// The surfaces beyond conics and even aspheres, through sgt_intersect_batch and the single ray, beside their formula by
// itself and Boost's Newton on it.
//
//     build/tests/bench/bench_catalogue [--benchmark_... of Google Benchmark]
//
// Per surface 1000 rays of bench_shared.h, the arrays in the processor's cache:
//     first, near            a batch, the first root and the one near the seed
//     one-first, one-near    sgt_intersect in a loop
//     formula                `values` at the points of the answers, in blocks of 64 as the batch asks for them
//     boost-...              from the vertex plane, on the surface's own `value`; sags only
// Before the clock starts each batch is compared with the single ray's answers, to the last bit, and Boost's t with them
// within 1e-13.  The repetitions of all are shuffled among each other; the csv has the medians in ns per ray (formula: per
// point).  Behind it stands a table, one line for each surface: what docs/surfaces_table.py puts into docs/surfaces.md.
// times: a batch of first roots, divided by what as many evaluations cost in the formula alone.
#include <cstring>
#include <deque>
#include <memory>
#include "bench_shared.h"

using namespace bench;

namespace {

constexpr size_t N = 1000, BLOCK = 64;
constexpr double RIM = 4, C = 0.1, K = -0.6;

// Number i of the coefficients: of both signs, falling.
double coefficient(size_t i, double first)
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
    sgt_numbers list(size_t n, double first) { return table(1, n, [=](size_t, size_t j) { return coefficient(j, first); }); }
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

sgt_numbers powers(Kept &kept, size_t n)  // of degree 2 and more; each at most 0.01 at the rim
{
    return kept.table(n, n, [](size_t i, size_t j) { return i + j < 2 ? 0 : coefficient(i + j, 0.01) / std::pow(RIM, static_cast<double>(i + j)); });
}

sgt_numbers waves(Kept &kept, size_t n) { return kept.table(n, n, [](size_t i, size_t j) { return coefficient(i + j, 0.005); }); }

const sgt_grid *grid(Kept &kept, size_t n)
{
    double step = 2.1 * RIM / static_cast<double>(n - 1);
    sgt_numbers z = kept.table(n, n, [=](size_t i, size_t j) {
        double x = (static_cast<double>(j) - 0.5 * static_cast<double>(n - 1)) * step / RIM, y = (static_cast<double>(i) - 0.5 * static_cast<double>(n - 1)) * step / RIM;
        return 0.01 * std::cos(2 * x + y) + 0.003 * std::sin(3 * y - x);
    });
    sgt_grid g = { C, K, RIM, step, step, z, 0, 0, 0 };
    sgt_grid_measure(&g);
    return kept.keep(g);
}

struct Subject {
    std::string name;
    const char *type;  // its row in docs/surfaces.md
    sgt_surface s;
    bool sag;
};

std::vector<Subject> subjects(Kept &kept)
{
    sgt_zernike fringe16 = { C, K, RIM, RIM, SGT_FRINGE, 0, kept.list(16, 0.01) }, fringe37 = fringe16, noll = fringe16;
    fringe37.a = kept.list(37, 0.01), noll.order = SGT_NOLL, noll.normalised = 1, noll.a = kept.list(231, 0.005);
    sgt_asphere even = { C, K, RIM, { 0, 1e-4, -2e-6, 1e-8 } };
    sgt_odd_asphere odd = { C, K, RIM, { 0, 0, 5e-4, 1e-4, -2e-5, -2e-6, 1e-7, 1e-8 } };
    sgt_toroidal toroid = { C, K, 0.07, RIM, { 0, 1e-4, -2e-6, 1e-8 } };
    const sgt_zernike *wave = kept.keep(fringe16);
    std::vector<sgt_surface> terms = { { &sgt_zernike_ops, wave }, { &sgt_asphere_ops, kept.keep(even) } };
    const std::vector<sgt_surface> *both = kept.keep(terms);
    sgt_quadric saddle = { { 0.05, 0.04, 0.01 }, { 0.01, 0.005, -0.005 }, { 0.02, 0.01, -1 }, -0.2 };
    return {
        { "conic", "conic", { &sgt_conic_ops, kept.keep(sgt_conic{ C, K, RIM }) }, true },
        { "even_asphere", "even_asphere", { &sgt_asphere_ops, kept.keep(even) }, true },
        { "odd_asphere, to r^8", "odd_asphere", { &sgt_odd_asphere_ops, kept.keep(odd) }, true },
        { "polynomial_xy, 3 x 3", "polynomial_xy", { &sgt_polynomial_xy_ops, kept.keep(sgt_polynomial_xy{ C, K, RIM, powers(kept, 3) }) }, true },
        { "polynomial_xy, 10 x 10", "polynomial_xy", { &sgt_polynomial_xy_ops, kept.keep(sgt_polynomial_xy{ C, K, RIM, powers(kept, 10) }) }, true },
        { "toroidal, to y^8", "toroidal", { &sgt_toroidal_ops, kept.keep(toroid) }, true },
        { "biconic", "biconic", { &sgt_biconic_ops, kept.keep(sgt_biconic{ C, K, 0.07, 0.3, RIM }) }, true },
        { "cylinder", "cylinder", { &sgt_biconic_ops, kept.keep(sgt_biconic{ 0, 0, C, K, RIM }) }, true },
        { "zernike, fringe, 16", "zernike", { &sgt_zernike_ops, wave }, true },
        { "zernike, fringe, 37", "zernike", { &sgt_zernike_ops, kept.keep(fringe37) }, true },
        { "zernike, noll, 231", "zernike", { &sgt_zernike_ops, kept.keep(noll) }, true },
        { "chebyshev, 5 x 5", "chebyshev", { &sgt_chebyshev_ops, kept.keep(sgt_chebyshev{ C, K, RIM, RIM, RIM, waves(kept, 5) }) }, true },
        { "chebyshev, 20 x 20", "chebyshev", { &sgt_chebyshev_ops, kept.keep(sgt_chebyshev{ C, K, RIM, RIM, RIM, waves(kept, 20) }) }, true },
        { "q_con, 8", "q_con", { &sgt_q_con_ops, kept.keep(sgt_q_con{ C, K, RIM, RIM, kept.list(8, 0.01) }) }, true },
        { "q_bfs, 8", "q_bfs", { &sgt_q_bfs_ops, kept.keep(sgt_q_bfs{ C, RIM, RIM, kept.list(8, 0.01) }) }, true },
        { "grid, 64 x 64", "grid", { &sgt_grid_ops, grid(kept, 64) }, true },
        { "grid, 512 x 512", "grid", { &sgt_grid_ops, grid(kept, 512) }, true },
        { "sum, zernike 16 + even_asphere", "sum", { &sgt_sum_ops, kept.keep(sgt_sum{ C, K, RIM, both->data(), both->size() }) }, true },
        { "quadric", "quadric", { &sgt_quadric_ops, kept.keep(saddle) }, false },
        { "torus", "torus", { &sgt_torus_ops, kept.keep(sgt_torus{ 2, 1.5 }) }, false },
        { "ellipsoid", "ellipsoid", { &sgt_ellipsoid_ops, kept.keep(sgt_ellipsoid{ 5, 0.2 }) }, false },
    };
}

struct Arrays {
    Arrays() : in(6, std::vector<double>(N)), out(10, std::vector<double>(N)), status(N), evals(N)
    {
        for (size_t i = 0; i < N; i++) {
            const sgt_ray &ray = rays()[i];
            in[0][i] = ray.o.x, in[1][i] = ray.o.y, in[2][i] = ray.o.z;
            in[3][i] = ray.d.x, in[4][i] = ray.d.y, in[5][i] = ray.d.z;
        }
    }
    sgt_rays given() const { return { { in[0].data(), in[1].data(), in[2].data() }, { in[3].data(), in[4].data(), in[5].data() }, nullptr, nullptr }; }
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
    std::vector<signed char> status;
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
        h.status[i] = static_cast<signed char>(hit.status);
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
        w.of.s.ops->values(w.of.s.self, few, { { x, x + w.points, x + 2 * w.points } }, { out[0], { out[1], out[2], out[3] } });
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
        a.out[0][i] = t, a.out[2][i] = p.x, a.out[3][i] = p.y, a.out[4][i] = p.z, a.out[5][i] = n.x, a.out[6][i] = n.y, a.out[7][i] = n.z;
    }
}
#endif

bool same(double a, double b) { return std::memcmp(&a, &b, sizeof a) == 0 || (std::isnan(a) && std::isnan(b)); }

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
            bool good = h.status[i] == one.status && h.evals[i] == one.evals && same(h.t[i], one.t) && same(h.t_err[i], one.t_err) && same(h.t_lo[i], one.t_lo) && same(h.p_err[i], one.p_err);
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
        { ops->span != nullptr, "span" }, { ops->first != nullptr, "first" }, { ops->clearance != nullptr, "clearance" }, { ops->enclose != nullptr, "enclose" },
        { ops->rounding != nullptr, "rounding" }, { ops->second != nullptr && ops->by_parameter != nullptr, "sensitivities" },
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
        for (double x : { w.met, w.evals_first, first, ns("near"), ns("one-first"), ns("one-near"), by_itself, first / (by_itself * w.evals_first), ns("boost-newton_raphson_iterate-31-bits") })
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
            rows.push_back({ of.name, "boost-newton_raphson_iterate-31-bits", N, [&w, &arrays] { boost_by_one(w, arrays); } });
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
