// SPDX-License-Identifier: MIT
// Every root on the surfaces of the catalogue once more by Ceres: its solver and its Jets on formulas.h.
//
// Ceres minimises F^2 / 2 along the ray.  From beside each hit of sgt_intersect_all it must come back to
// it; wherever it ends in a root from elsewhere, and that counts, the root is in an entry of the list.  Its
// Jets give F and its gradient at each hit.  An end is a root where |F| is small and Newton's method in 113
// bits closes in on it at once.
#include <ceres/tiny_solver.h>
#include <ceres/tiny_solver_autodiff_function.h>

namespace ceres {
template <class T, int N> Jet<T, N> square_root(const Jet<T, N> &x) { return sqrt(x); }
template <class T, int N> double plain(const Jet<T, N> &x) { return x.a; }
} // namespace ceres

#include "judge.h"

using namespace catalogue;

namespace {

std::map<std::string, long> failed, counted;

// F on the ray moved to t0, over `size`; the parameter is t - t0 in units of `unit`.
struct residual {
    const sgt_surface *surface;
    const std::vector<double> *parameters;
    sgt_vec3 o, d;
    double size, unit;
    template <class T> bool operator()(const T *parameter, T *f) const
    {
        const T tau = parameter[0] * unit;
        const std::vector<T> p(parameters->begin(), parameters->end());
        f[0] = level(*surface, p.data(), T(o.x + tau * d.x), T(o.y + tau * d.y), T(o.z + tau * d.z)) / size;
        return true;
    }
};

double solve(const residual &r, double tau)
{
    typedef ceres::TinySolverAutoDiffFunction<residual, 1, 1> function;
    function f(r);
    ceres::TinySolver<function> solver;
    solver.options.max_num_iterations = 80;
    solver.options.gradient_tolerance = 0;
    solver.options.parameter_tolerance = 1e-16;
    solver.options.function_tolerance = 0;
    solver.options.cost_threshold = 0;
    Eigen::Matrix<double, 1, 1> x(tau / r.unit);
    solver.Solve(f, &x);
    return x[0] * r.unit;
}

void fail(const char *why, const subject &of, const sgt_ray &ray, const sgt_hit &h, double number)
{
    if (failed[of.s.type + ": " + why]++ >= 2) return;
    std::printf("FAIL %s, %s: %.17g; %s t %.17g (%a) t_err %.3g [%g, %g]\n", of.s.type.c_str(), why, number,
                sgt_status_text(h.status), h.t, h.t, h.t_err, h.lo, h.hi);
    print_surface(of.s.s);
    std::printf("    ray {{%a, %a, %a}, {%a, %a, %a}, %a, %a}\n", ray.o.x, ray.o.y, ray.o.z, ray.d.x, ray.d.y,
                ray.d.z, ray.tmin, ray.tmax);
}

void gradient(const subject &of, const sgt_ray &ray, const std::vector<double> &parameters, const sgt_hit &h)
{
    typedef ceres::Jet<double, 3> jet;
    const std::vector<jet> p(parameters.begin(), parameters.end());
    const jet f = level(of.s.s, p.data(), jet(h.p.x, 0), jet(h.p.y, 1), jet(h.p.z, 2));
    const double off = std::max(
        {std::fabs(h.n.x - f.v[0]), std::fabs(h.n.y - f.v[1]), std::fabs(h.n.z - f.v[2])});
    if (!std::isfinite(f.v[0]) || !std::isfinite(f.v[1])) return;
    // (next to the equator of its sphere both lose digits in 1 - c^2 r^2)
    if (of.s.type == "q_bfs") {
        const double c = static_cast<const sgt_q_bfs *>(of.s.s.self)->c;
        if (!(1 - c * c * (h.p.x * h.p.x + h.p.y * h.p.y) > 1e-6)) return;
    }
    counted["gradients compared"]++;
    if (!(off <= 1e-7 * f.v.norm()))
        fail("the gradient", of, ray, h, off / f.v.norm()); // sums of alternating signs, in double
}

void check(const subject &of, generator &g, const sgt_ray &ray)
{
    enum { most = 24 };
    sgt_hit hit[most];
    const int all = sgt_intersect_all(of.s.s, ray, most, hit, nullptr),
              n = std::min(all, static_cast<int>(most));
    const double length = std::sqrt(ray.d.x * ray.d.x + ray.d.y * ray.d.y + ray.d.z * ray.d.z),
                 size = of.s.type == "quadric" ? of.s.h * of.s.h : of.s.h;
    const judgement j(of, ray, 4);
    const std::vector<double> parameters = parameters_of(of.s.s);
    const double middle = -(ray.o.x * ray.d.x + ray.o.y * ray.d.y + ray.o.z * ray.d.z) / (length * length);
    for (int i = -3; i < n; i++) {
        const bool own = i >= 0;
        if (own && (hit[i].status != SGT_HIT || hit[i].t_err > 1e-6 * of.s.h / length)) continue;
        const double t0 = own ? hit[i].t : middle;
        const residual r = {
            &of.s.s,
            &parameters,
            {std::fma(t0, ray.d.x, ray.o.x), std::fma(t0, ray.d.y, ray.o.y), std::fma(t0, ray.d.z, ray.o.z)},
            ray.d,
            size,
            of.s.h / length};
        const double end = solve(r, own ? g.sign() * 1e-4 * r.unit : r.unit * g.uniform(-1.5, 1.5));
        counted["solved"]++;
        double x = end / r.unit, f;
        r(&x, &f);
        root at;
        if (own) gradient(of, ray, parameters, hit[i]);
        if (!(std::fabs(f) <= 1e-8) || !j.polish(quad(t0) + end, &at) ||
            !(oracle::magnitude(at.t - t0 - end) <= quad(1e-4) * r.unit)) {
            counted[own ? "... beside a hit that end in no root" : "... that end in no root"]++;
            continue;
        }
        if (own && oracle::magnitude(at.t - hit[i].t) <= quad(hit[i].t_err) + quad(0x1p-90) * r.unit) {
            counted["... back at the hit"]++;
            continue;
        }
        if (of.s.rim > 0 && at.p.x * at.p.x + at.p.y * at.p.y > quad(of.s.rim) * of.s.rim) {
            counted["... outside the rim"]++;
            continue;
        }
        if (counting(at, ray.tmin, ray.tmax) != oracle::yes) {
            counted["... at a root that does not count"]++;
            continue;
        }
        bool known = false;
        for (int k = 0; k < n; k++)
            known = known ||
                    (hit[k].status > 0 ? oracle::magnitude(at.t - hit[k].t) <=
                                             quad(hit[k].t_err) * (1 + quad(1e-6)) + quad(0x1p-90) * r.unit
                                       : at.t >= hit[k].lo && at.t <= hit[k].hi);
        counted["... at another root, known too"] += known;
        if (!known)
            fail("a root of Ceres' that is in no entry", of, ray, n > 0 ? hit[0] : sgt_hit{}, plain(at.t));
    }
}

} // namespace

int main(int argc, char **argv)
{
    const oracle::run r(argc, argv, 160, 20240605);
    const char *only = std::getenv("SAGITTA_TEST_TYPE");
    for (std::size_t k = 0; k < types.size(); k++) {
        if (only && std::strcmp(only, types[k])) continue;
        generator g(r.seed ^ static_cast<std::uint64_t>(k) << 40);
        for (long done = 0; done < r.count;) {
            const specimen s = random_specimen(g, types[k]);
            const subject of(s);
            for (int i = 0; i < 8; i++, done++)
                check(
                    of, g,
                    random_ray(g, of, static_cast<ray_kind>(g.chance(0.5) ? ordinary : g.below(ray_kinds))));
        }
    }
    for (const auto &c : counted) std::printf("  %8ld  %s\n", c.second, c.first.c_str());
    for (const auto &f : failed) std::printf("FAIL %6ld  %s\n", f.second, f.first.c_str());
    const double beside = static_cast<double>(counted["... beside a hit that end in no root"]),
                 back = static_cast<double>(counted["... back at the hit"]);
    if (beside > 0.05 * back + 5) return std::printf("FAIL too often Ceres does not come back\n"), 1;
    return !failed.empty();
}
