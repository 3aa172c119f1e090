// SPDX-License-Identifier: MIT
// F, its gradient, its second derivatives and its derivatives by the parameters, of each surface of the
// catalogue, against formulas.h in 113 bits, whose derivatives are those of dual numbers.
//
//   F             is within what `rounding` says;
//   sums          of Zernike's polynomials to order 20 and of 20 x 20 of Chebyshev's are within 1e-13 of
//                 their size, value
//                 and gradient: the sum of the magnitudes of what the terms are there;
//   5151 terms    of Zernike's, to order 100, and 64 of each Q likewise;
//   all others    within 1e-13 (second derivatives, by parameters: 1e-11) of the size that they have within
//                 the aperture;
//   many at once  are what each alone is, to the bit, whatever array begins where.
#include "specimens.h"

#include <map>

using namespace catalogue;

namespace {

typedef dual<quad, 3> gradient;
typedef dual<gradient, 3> hessian;
typedef dual<gradient, 1> by_parameter;

std::map<std::string, long> failed;

struct worst {
    double bound, value, slope, second, parameter, slack;
    long points, undefined;
};

void fail(const char *why, const specimen &s, const sgt_vec3 &p, double found, double wanted)
{
    if (failed[s.type + ": " + why]++ >= 2) return;
    std::printf("FAIL %s, %s at %a %a %a: %.17g (%a), wanted %.17g (%a)\n", s.type.c_str(), why, p.x, p.y,
                p.z, found, found, wanted, wanted);
    print_surface(s.s);
}

bool same(double a, double b) { return !std::memcmp(&a, &b, sizeof a) || (a != a && b != b); }
double off(double found, quad exact) { return std::fabs(oracle::to_double(quad(found) - exact)); }

template <class T> T variable(double x, int i);
template <> gradient variable<gradient>(double x, int i) { return gradient::variable(quad(x), i); }
template <> hessian variable<hessian>(double x, int i)
{
    return hessian::variable(gradient::variable(quad(x), i), i);
}
template <> by_parameter variable<by_parameter>(double x, int i)
{
    return by_parameter(gradient::variable(quad(x), i));
}
template <class T> T level_at(const specimen &s, const std::vector<T> &p, const sgt_vec3 &at)
{
    return level(s.s, p.data(), variable<T>(at.x, 0), variable<T>(at.y, 1), variable<T>(at.z, 2));
}

// dF / d(parameter j) and its gradient.  What is linear in a list of coefficients needs no other of them.
gradient exact_by_parameter(const specimen &s, const std::vector<double> &p, std::size_t j,
                            const sgt_vec3 &at)
{
    const std::size_t base = s.s.ops == &sgt_q_bfs_ops ? 1 : 2;
    bool listed = false;
    for (const sgt_param *of = row_of_ops(s.s.ops)->params; of->name; of++)
        listed = listed || of->kind == SGT_PARAM_LIST || of->kind == SGT_PARAM_TABLE;
    std::vector<by_parameter> q;
    for (std::size_t i = 0; i < p.size(); i++)
        q.push_back(by_parameter(gradient(quad(listed && j >= base && i >= 2 ? 0 : p[i]))));
    q[j].v[0] = gradient(quad(1));
    return level_at(s, q, at).v[0];
}

void points_of(const specimen &s, generator &g, worst *w, int count)
{
    enum { most = 70 };
    const formula<double> rough(s.s);
    const formula<gradient> exact(s.s);
    const std::vector<double> parameters = parameters_of(s.s);
    double x[3][most], f[most + 1], n[3][most + 1], alone[most];
    const int together = 1 + g.below(most);
    for (int i = 0; i < together; i++) {
        sgt_vec3 p = random_point(g, s, rough, g.chance(0.1) ? 1.3 : 1);
        if (g.chance(0.05)) p.x = 0;
        if (g.chance(0.05)) p.y = 0;
        x[0][i] = p.x, x[1][i] = p.y, x[2][i] = p.z;
    }
    f[together] = n[0][together] = n[1][together] = n[2][together] = -77;
    const sgt_points points = {{x[0], x[1], x[2]}};
    s.s.ops->values(s.s.self, static_cast<std::size_t>(together), points,
                    {alone, {nullptr, nullptr, nullptr}});
    s.s.ops->values(s.s.self, static_cast<std::size_t>(together), points, {f, {n[0], n[1], n[2]}});
    if (f[together] != -77 || n[0][together] != -77 || n[1][together] != -77 || n[2][together] != -77)
        fail("written beyond the end", s, {}, 0, 0);

    std::vector<gradient> e;
    double big = 0, steep = 0, bent = 0;
    std::vector<hessian> second;
    const std::vector<hessian> own(parameters.begin(), parameters.end());
    for (int i = 0; i < together; i++) {
        const sgt_vec3 p = {x[0][i], x[1][i], x[2][i]};
        sgt_vec3 m = {-77, -77, -77};
        const double v = s.s.ops->value(s.s.self, p, &m);
        if (!same(v, f[i]) || !same(v, alone[i]) || !same(v, s.s.ops->value(s.s.self, p, nullptr)))
            fail("another F among others", s, p, f[i], v);
        if (v == v && (!same(m.x, n[0][i]) || !same(m.y, n[1][i]) || !same(m.z, n[2][i])))
            fail("another gradient among others", s, p, n[0][i], m.x);
    }
    const int looked = std::min(count, together);
    for (int i = 0; i < looked; i++) {
        const sgt_vec3 p = {x[0][i], x[1][i], x[2][i]};
        e.push_back(level_at(s, exact.p, p));
        if (!(e.back().a == e.back().a)) continue;
        if (s.type == "quadric") { // its terms
            for (std::size_t k = 0; k < 10; k++) {
                const double powers[] = {p.x * p.x, p.y * p.y, p.z * p.z, p.x * p.y, p.y * p.z,
                                         p.x * p.z, p.x,       p.y,       p.z,       1};
                big = std::max(big, std::fabs(parameters[k] * powers[k]));
            }
        }
        big = std::max(big, std::fabs(plain(e.back().a)));
        big = std::max({big, std::fabs(p.z), s.sag ? std::fabs(plain(e.back().a) - p.z) : 0});
        for (quad d : e.back().v) steep = std::max(steep, std::fabs(oracle::to_double(d)));
    }
    for (int i = 0; i < looked; i++) {
        const sgt_vec3 p = {x[0][i], x[1][i], x[2][i]};
        const gradient &q = e[static_cast<std::size_t>(i)];
        const double r = s.s.ops->rounding(s.s.self, p);
        w->points++;
        if (!(q.a == q.a)) {
            w->undefined++;
            // (within rounding of the edge either is right: no point is drawn there on purpose)
            if (f[i] == f[i]) fail("F where it is not defined", s, p, f[i], NAN);
            continue;
        }
        if (f[i] != f[i]) {
            fail("NaN where F is defined", s, p, f[i], plain(q.a));
            continue;
        }
        if (!(r >= 0 && r < HUGE_VAL)) fail("rounding", s, p, r, 0);
        const double error = off(f[i], q.a);
        if (!(error <= r)) fail("F is off by more than `rounding`", s, p, error, r);
        if (error > 0) w->bound = std::max(w->bound, error / r);
        w->value = std::max(w->value, error / big);
        w->slack = std::max(w->slack, r / (0x1p-53 * big));
        if (!(error <= 1e-13 * big)) fail("F", s, p, f[i], plain(q.a));
        for (int k = 0; k < 3; k++) {
            if (!(q.v[k] == q.v[k])) continue; // the tip of a cone
            const double d = off(n[k][i], q.v[k]) / steep;
            w->slope = std::max(w->slope, d);
            if (!(d <= 1e-13)) fail("the gradient", s, p, n[k][i], oracle::to_double(q.v[k]));
        }
    }
    if (looked > 0 && g.chance(0.5)) {
        const int few = std::min(looked, 8);
        const bool grids = s.type == "grid" || s.type == "sum";
        const bool cone = s.type == "odd_asphere" &&
                          static_cast<const sgt_odd_asphere *>(s.s.self)->a[0] != 0;
        double h[6][most], *const to[6] = {h[0], h[1], h[2], h[3], h[4], h[5]};
        s.s.ops->second(s.s.self, static_cast<std::size_t>(together), points, to);
        for (int i = 0; i < few; i++) {
            second.push_back(level_at(s, own, {x[0][i], x[1][i], x[2][i]}));
            if (!(second.back().a.a == second.back().a.a) || (grids && (x[0][i] == 0 || x[1][i] == 0)) ||
                (cone && x[0][i] == 0 && x[1][i] == 0))
                second.back() = hessian(gradient(quad(NAN))); // a knot, or the tip of a cone
            if (second.back().a.a != second.back().a.a) continue;
            for (const gradient &row : second.back().v)
                for (quad d : row.v)
                    if (d == d) bent = std::max(bent, std::fabs(oracle::to_double(d)));
        }
        bent += steep / s.h * 1e-3;
        for (int i = 0; i < few; i++)
            for (int k = 0, a = 0; a < 3; a++)
                for (int b = a; b < 3; b++, k++) {
                    const quad d = second[static_cast<std::size_t>(i)].v[a].v[b];
                    if (!(d == d) ||
                        second[static_cast<std::size_t>(i)].a.a != second[static_cast<std::size_t>(i)].a.a)
                        continue;
                    const double error = off(h[k][i], d) / bent;
                    w->second = std::max(w->second, error);
                    if (!(error <= 1e-11))
                        fail("the second derivatives", s, {x[0][i], x[1][i], x[2][i]}, h[k][i],
                             oracle::to_double(d));
                }
    }
    if (s.s.ops->parameters(s.s.self) != parameters.size())
        return fail("the number of parameters", s, {}, static_cast<double>(s.s.ops->parameters(s.s.self)),
                    static_cast<double>(parameters.size()));
    for (int tries = 0; tries < 3 && looked > 0 && !parameters.empty(); tries++) {
        const std::size_t j = tries < 2 && g.chance(0.5)
                                  ? static_cast<std::size_t>(tries) % parameters.size()
                                  : static_cast<std::size_t>(g.below(static_cast<int>(parameters.size())));
        double v[most], d[3][most], bare[most], most_v = 0, most_d = 0;
        s.s.ops->by_parameter(s.s.self, j, static_cast<std::size_t>(together), points,
                              {v, {d[0], d[1], d[2]}});
        s.s.ops->by_parameter(s.s.self, j, static_cast<std::size_t>(together), points,
                              {bare, {nullptr, nullptr, nullptr}});
        for (int i = 0; i < together; i++)
            if (!same(v[i], bare[i]))
                fail("by a parameter, without the gradient", s, {x[0][i], x[1][i], x[2][i]}, bare[i], v[i]);
        std::vector<gradient> q;
        const int few = std::min(looked, 6);
        for (int i = 0; i < few; i++) {
            q.push_back(exact_by_parameter(s, parameters, j, {x[0][i], x[1][i], x[2][i]}));
            if (q.back().a == q.back().a) most_v = std::max(most_v, std::fabs(plain(q.back().a)));
            for (quad a : q.back().v)
                if (a == a) most_d = std::max(most_d, std::fabs(oracle::to_double(a)));
        }
        for (int i = 0; i < few; i++) {
            const sgt_vec3 p = {x[0][i], x[1][i], x[2][i]};
            const gradient &a = q[static_cast<std::size_t>(i)];
            const std::string name = "by parameter " + std::to_string(j < 4 ? j : 4) +
                                     (j < 4 ? "" : " or later");
            if (!(a.a == a.a) || !(e[static_cast<std::size_t>(i)].a == e[static_cast<std::size_t>(i)].a))
                continue;
            const double error = off(v[i], a.a) / (most_v > 0 ? most_v : 1);
            w->parameter = std::max(w->parameter, error);
            if (!(error <= 1e-11)) fail(name.c_str(), s, p, v[i], plain(a.a));
            for (int k = 0; k < 3; k++) {
                if (!(a.v[k] == a.v[k])) continue;
                const double slope = off(d[k][i], a.v[k]) / (most_d > 0 ? most_d : 1);
                w->parameter = std::max(w->parameter, slope);
                if (!(slope <= 1e-11))
                    fail((name + ", the gradient").c_str(), s, p, d[k][i], oracle::to_double(a.v[k]));
            }
        }
    }
}

// The size of a sum at a point: the magnitudes of its terms, of F and of each derivative.
void long_sum(generator &g, const char *name, specimen s, int points)
{
    double *base = first_number(s.s);
    const bool bfs = s.s.ops == &sgt_q_bfs_ops;
    base[0] = base[1] = 0;
    if (!bfs) base[2] = 0;
    const std::vector<double> parameters = parameters_of(s.s);
    const formula<gradient> exact(s.s);
    double value = 0, slope = 0;
    for (int i = 0; i < points; i++) {
        const double r = i == 0 ? 1 : std::sqrt(g.uniform(0, 1)), about = g.uniform(0, 6.283185307179586);
        sgt_vec3 p = {r * std::cos(about), r * std::sin(about), 0}, n;
        if (s.type == "chebyshev") p = {g.uniform(-1, 1), g.uniform(-1, 1), 0};
        if (i == 1 && !bfs) p = {1, 0, 0};
        if (i == 2) p = {-0.99999, 1e-9, 0};
        if (i == 1 && s.type == "chebyshev") p = {0.999999999999, -1 + 1e-9, 0};
        if (bfs) p = {0.95 * p.x, 0.95 * p.y, 0}; // its terms are 0 at the edge, and lose what x and y lose
        const gradient e = level_at(s, exact.p, p);
        double size = 0, size_n[2] = {0, 0};
        for (std::size_t j = bfs ? 1 : 2; j < parameters.size(); j++) {
            const gradient b = exact_by_parameter(s, parameters, j, p);
            size += std::fabs(parameters[j] * plain(b.a));
            for (int k = 0; k < 2; k++) size_n[k] += std::fabs(parameters[j] * plain(b.v[k]));
        }
        const double f = s.s.ops->value(s.s.self, p, &n);
        value = std::max(value, off(f, e.a) / size);
        slope = std::max({slope, off(n.x, e.v[0]) / std::max(size_n[0], size_n[1]),
                          off(n.y, e.v[1]) / std::max(size_n[0], size_n[1])});
        if (!(off(f, e.a) <= s.s.ops->rounding(s.s.self, p)))
            fail("a long sum is off by more than `rounding`", s, p, off(f, e.a),
                 s.s.ops->rounding(s.s.self, p));
        if (!(off(f, e.a) <= 1e-13 * size)) fail("a long sum", s, p, f, plain(e.a));
        if (!(std::max(off(n.x, e.v[0]), off(n.y, e.v[1])) <= 1e-13 * std::max(size_n[0], size_n[1])))
            fail("the gradient of a long sum", s, p, n.x, plain(e.v[0]));
    }
    std::printf("%-34s F within %.2g of its size, the gradient within %.2g\n", name, value, slope);
}

void long_sums(generator &g, int points)
{
    for (int falling = 0; falling < 2; falling++) {
        std::vector<double> a(231), b(400);
        for (std::size_t i = 0; i < a.size(); i++)
            a[i] = g.uniform(-1, 1) * (falling ? std::exp(-0.03 * double(i)) : 1);
        for (std::size_t i = 0; i < b.size(); i++)
            b[i] = g.uniform(-1, 1) * (falling ? std::exp(-0.3 * double(i / 20 + i % 20)) : 1);
        specimen s = {};
        s.type = "zernike";
        for (int order = SGT_NOLL; order <= SGT_FRINGE; order++) {
            s.s = {&sgt_zernike_ops,
                   s.keep(sgt_zernike{0, 0, 0, 1, order, falling, s.numbers(1, a.size(), a)})};
            long_sum(g, order == SGT_NOLL ? "231 terms of Zernike, Noll" : "231 terms of Zernike, Fringe", s,
                     points);
        }
        s.type = "chebyshev";
        s.s = {&sgt_chebyshev_ops, s.keep(sgt_chebyshev{0, 0, 0, 1, 1, s.numbers(20, 20, b)})};
        long_sum(g, "20 x 20 of Chebyshev", s, points);
        a.resize(64);
        s.type = "q";
        s.s = {&sgt_q_con_ops, s.keep(sgt_q_con{0, 0, 0, 1, s.numbers(1, a.size(), a)})};
        long_sum(g, "64 terms of Q_con", s, points);
        s.s = {&sgt_q_bfs_ops, s.keep(sgt_q_bfs{0, 0, 1, s.numbers(1, a.size(), a)})};
        long_sum(g, "64 terms of Q_bfs", s, points);
    }
}

// All that Noll's list may have, to radial order 100, where the explicit sum loses all its digits: by the
// mean over the circle R(rho) = < U_n(rho cos t) cos m t >, which is exact over more than n + m points
// (Janssen and Dirksen 2007).
void order_100(generator &g, int points)
{
    typedef dual<quad, 2> number;
    enum { order = 100, terms = 5151, nodes = 204 };
    std::vector<double> a(terms);
    for (double &x : a) x = g.uniform(-1, 1);
    specimen s = {};
    s.type = "zernike";
    s.s = {&sgt_zernike_ops, s.keep(sgt_zernike{0, 0, 0, 1, SGT_NOLL, 0, s.numbers(1, terms, a)})};
    std::vector<quad> cosine(4 * nodes);
    for (int i = 0; i < nodes; i++) { // of 2 pi i / nodes, by way of a quarter
        const quad turn = quad(4 * i) / static_cast<int>(nodes);
        const int quarter = static_cast<int>(turn);
        const quad rest = half_pi() * (turn - quarter), c = sine(half_pi() - rest), d = sine(rest);
        cosine[static_cast<std::size_t>(i)] = quarter == 0 ? c : quarter == 1 ? -d : quarter == 2 ? -c : d;
    }
    double value = 0, slope = 0;
    for (int i = 0; i < points; i++) {
        const double r = i == 0 ? 0.995 : std::sqrt(g.uniform(0.01, 0.99)),
                     about = g.uniform(0, 6.283185307179586);
        const sgt_vec3 p = {r * std::cos(about), r * std::sin(about), 0};
        const number x = number::variable(quad(p.x), 0), y = number::variable(quad(p.y), 1),
                     rho = square_root(x * x + y * y);
        std::vector<std::vector<number>> R(order + 1, std::vector<number>(order + 1));
        for (std::size_t k = 0; k < nodes; k++) {
            const number u = rho * cosine[k], beside = square_root(number(quad(1)) - u * u);
            const complex<number> w = {u, beside};
            complex<number> turned = w;
            for (std::size_t n = 0; n <= order; n++, turned = turned * w) {
                const number of_n = turned.im / beside;
                for (std::size_t m = n % 2; m <= n; m += 2)
                    R[n][m] = R[n][m] + of_n * (cosine[k * m % nodes] / static_cast<int>(nodes));
            }
        }
        std::vector<complex<number>> angle = {{number(quad(1)), number(quad(0))}};
        while (angle.size() <= order) angle.push_back(angle.back() * complex<number>{x / rho, y / rho});
        number sum(quad(0));
        double size = 0, steep[2] = {0, 0};
        for (int j = 1; j <= terms; j++) {
            const auto nm = noll(j);
            const complex<number> &w = angle[static_cast<std::size_t>(std::abs(nm.second))];
            const number z =
                R[static_cast<std::size_t>(nm.first)][static_cast<std::size_t>(std::abs(nm.second))] *
                (nm.second < 0 ? w.im : w.re) * quad(a[static_cast<std::size_t>(j - 1)]);
            sum = sum + z;
            size += std::fabs(plain(z));
            for (int k = 0; k < 2; k++) steep[k] += std::fabs(oracle::to_double(z.v[k]));
        }
        sgt_vec3 n;
        const double f = s.s.ops->value(s.s.self, p, &n);
        const double e = off(-f, sum.a) / size,
                     d = std::max(off(-n.x, sum.v[0]), off(-n.y, sum.v[1])) / std::max(steep[0], steep[1]);
        value = std::max(value, e), slope = std::max(slope, d);
        if (!(off(f, -sum.a) <= s.s.ops->rounding(s.s.self, p)))
            fail("order 100 is off by more than `rounding`", s, p, off(f, -sum.a),
                 s.s.ops->rounding(s.s.self, p));
        if (!(e <= 1e-13)) fail("order 100", s, p, -f, plain(sum));
        if (!(d <= 1e-13)) fail("the gradient of order 100", s, p, -n.x, oracle::to_double(sum.v[0]));
    }
    std::printf("%-34s F within %.2g of its size, the gradient within %.2g\n", "5151 terms of Zernike", value,
                slope);
}

// The tip of a cone: F itself is exact there, and the gradient that of the rest.
void tip()
{
    sgt_odd_asphere a = {0.1, -0.5, 0, {0.2, 0.01, -0.03}};
    sgt_vec3 n = {-77, -77, -77};
    const double f = sgt_odd_asphere_ops.value(&a, {0, 0, 0.25}, &n);
    specimen s = {};
    s.type = "odd_asphere";
    s.s = {&sgt_odd_asphere_ops, &a};
    if (f != 0.25 || n.x != 0 || n.y != 0 || n.z != 1) fail("the tip", s, {0, 0, 0.25}, n.x, 0);
}

} // namespace

int main(int argc, char **argv)
{
    const oracle::run r(argc, argv, 60, 20240601);
    const char *only = std::getenv("SAGITTA_TEST_TYPE");
    for (std::size_t t = 0; t < types.size(); t++) {
        if (only && std::strcmp(only, types[t])) continue;
        generator g(r.seed ^ static_cast<std::uint64_t>(t) << 40);
        worst w = {};
        for (long i = 0; i < r.count; i++) points_of(random_specimen(g, types[t], g.chance(0.1)), g, &w, 16);
        std::printf("%-14s %6ld points, %5ld undefined; F within %.2g of its size and %.2g of `rounding` (up "
                    "to %.3g half ulps of size), gradient %.2g, second %.2g, by parameter %.2g\n",
                    types[t], w.points, w.undefined, w.value, w.bound, w.slack, w.slope, w.second,
                    w.parameter);
        std::fflush(stdout);
        if (w.undefined > w.points / 3) failed["too few points are defined"]++;
    }
    if (!only) {
        generator g(r.seed);
        long_sums(g, static_cast<int>(std::min(400L, 3 + r.count / 60)));
        order_100(g, static_cast<int>(std::min(50L, 1 + r.count / 60)));
        tip();
    }
    for (const auto &f : failed) std::printf("FAIL %6ld  %s\n", f.second, f.first.c_str());
    return !failed.empty();
}
