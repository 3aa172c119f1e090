// SPDX-License-Identifier: MIT
// Departures that are polynomials, without a rim, and all that a ray meets of them far out (src/ray/along.c).
//
// Random sags of many terms: powers of x and y, of r, Zernike, Chebyshev and Q terms, sums; on bases that
// end, that never end, and on none.  Their wings reach from a millionth of the ray to 10^20 times it.  Rays
// come from afar, pass by, or go out in any direction, with an end or without.  Two in five are shifted so
// that F nearly touches zero somewhere, from a hundredth of the size to 10^-14 of it.
//
// The judge is F: 1500 points of the ray, evenly in the angle that the axis sees them at, and as many next to
// the answer.  (Of sags of revolution some rays go through the axis, along it, or start on the sag or 10^14
// away; src/ray/profile.c.)  Where F in doubles changes its sign between two of them, F in 113 bits is asked
// at both.
//     a miss    F has one sign from the start to the end, or to the edge of its domain
//     a hit     F has one sign from the start up to it, and unlike signs on either side of it
// What a watcher is told of the first stretches holds in 113 bits, up to their ends.
// Batches, and rays one by one, are the same to the last bit.  Most misses take fewer than ten evaluations.
//
// From 10,000 radii, at weak departures on bases that never end, the first root is 10 to 1000 radii out.  It
// takes ten evaluations in the mean, and hardly a ray goes cell by cell, which takes hundreds.
#include "specimens.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <map>

using namespace catalogue;

namespace
{

std::map<std::string, int> failed;

void fail(const char *what, const specimen &s, const sgt_ray &r, const sgt_hit &h)
{
    if (failed[s.type + ": " + what]++ > 2) return;
    std::printf("%s: %s\n    ray %a %a %a, %a %a %a, %a\n    %s, t = %.17g +- %.3g, r = %.3g h\n    ",
                s.type.c_str(), what, r.o.x, r.o.y, r.o.z, r.d.x, r.d.y, r.d.z, r.tmax,
                sgt_status_text(h.status), h.t, h.t_err, std::hypot(h.p.x, h.p.y) / s.h);
    print_surface(s.s);
}

int sign(quad x) { return x > 0 ? 1 : x < 0 ? -1 : 0; }

quad along(const formula<quad> &f, const sgt_ray &r, quad t)
{
    return f(quad(r.o.x) + t * quad(r.d.x), quad(r.o.y) + t * quad(r.d.y), quad(r.o.z) + t * quad(r.d.z));
}

// The first two neighbours among the points between which F certainly changes its sign, before `to`.
bool changes(const formula<double> &rough, const formula<quad> &exact, const sgt_ray &r, double to, double h,
             double touched)
{
    if (touched > r.tmin && touched < to) { // what no other point may see
        const quad there = along(exact, r, touched), begins = along(exact, r, r.tmin);
        if (there == there && begins == begins && sign(there) * sign(begins) < 0) return true;
    }
    const double a = r.d.x * r.d.x + r.d.y * r.d.y, near = -(r.o.x * r.d.x + r.o.y * r.d.y) / a,
                 by = h / std::sqrt(a);
    std::vector<double> at;
    for (int i = 0; i < 1500; i++) {
        at.push_back(near + by * std::tan(3.14159 * ((i + 0.5) / 1500 - 0.5)));
        if (to < INFINITY) at.push_back(to - (to - near) * std::pow(1e-9, (i + 0.5) / 1500));
    }
    if (to < INFINITY) at.push_back(to);
    std::sort(at.begin(), at.end());
    bool any = false;
    double last = 0;
    int before = 0;
    for (double t : at) {
        if (t < r.tmin || t > to || t > r.tmax) continue;
        const double f = rough(r.o.x + t * r.d.x, r.o.y + t * r.d.y, r.o.z + t * r.d.z);
        if (!(f == f)) { // a gap of the domain
            any = false;
            continue;
        }
        const int is = f > 0 ? 1 : -1;
        if (any && is != before) {
            const int one = sign(along(exact, r, last)), other = sign(along(exact, r, t));
            if (one * other < 0) return true;
        }
        any = true, before = is, last = t;
    }
    return false;
}

double coefficient(generator &g, double strong) { return g.uniform(-1, 1) * strong; }

// A sag of size h without a rim.
specimen wide(generator &g, int kind)
{
    specimen s = {};
    s.h = g.log_uniform(1e-3, 1e3);
    const double h = s.h, strong = h * g.log_uniform(1e-6, 0.1);
    double c = g.sign() / (h * g.log_uniform(1.3, 100)), k = 0;
    switch (static_cast<int>(g.uniform(0, 6))) {
    case 0:
        c = 0;
        break;
    case 1:
        k = -1;
        break;
    case 2:
        k = g.uniform(-5, -1);
        break;
    default:
        k = g.uniform(-0.9, 0.5);
    }
    const std::size_t n = static_cast<std::size_t>(g.uniform(2, g.chance(0.1) ? 20 : 9));
    const bool sparse = g.chance(0.3); // leading terms that vanish, one of one sign
    auto numbers = [&](std::size_t rows, std::size_t columns, auto size) {
        std::vector<double> x(rows * columns);
        for (std::size_t i = 0; i < rows; i++)
            for (std::size_t j = 0; j < columns; j++)
                x[i * columns + j] = sparse && g.chance(0.7) ? 0 : coefficient(g, strong * size(i, j));
        return s.numbers(rows, columns, x);
    };
    auto one = [](std::size_t, std::size_t) { return 1.0; };
    switch (kind) {
    case 0: {
        s.type = "polynomial_xy";
        const std::size_t m = static_cast<std::size_t>(g.uniform(1, 9));
        s.s = {&sgt_polynomial_xy_ops,
               s.keep(sgt_polynomial_xy{c, k, 0, numbers(n, m, [&](std::size_t i, std::size_t j) {
                                            return std::pow(h, -static_cast<double>(i + j));
                                        })})};
        break;
    }
    case 1: {
        s.type = "zernike";
        const std::size_t terms = static_cast<std::size_t>(g.uniform(4, g.chance(0.1) ? 231 : 60));
        s.s = {&sgt_zernike_ops, s.keep(sgt_zernike{c, k, 0, h, g.chance(0.5) ? SGT_NOLL : SGT_FRINGE,
                                                    g.chance(0.5), numbers(1, terms, one)})};
        break;
    }
    case 2:
        s.type = "chebyshev";
        s.s = {&sgt_chebyshev_ops,
               s.keep(sgt_chebyshev{c, k, 0, h, h * g.log_uniform(0.5, 2),
                                    numbers(n, static_cast<std::size_t>(g.uniform(1, 9)), one)})};
        break;
    case 3:
    case 7:
        s.type = "q_con";
        s.s = {&sgt_q_con_ops, s.keep(sgt_q_con{c, k, 0, h, numbers(1, n, one)})};
        break;
    case 5:
        s.type = "q_bfs";
        s.s = {&sgt_q_bfs_ops, s.keep(sgt_q_bfs{c, 0, h, numbers(1, n, one)})};
        break;
    case 6: {
        s.type = "odd_asphere";
        sgt_odd_asphere odd = {c, k, 0, {}};
        const int first = g.chance(0.3) ? 0 : 2;
        for (int i = first; i < static_cast<int>(n < 14 ? n + 2 : 16); i++)
            if (!sparse || g.chance(0.4)) odd.a[i] = coefficient(g, strong * std::pow(h, -i - 1));
        s.s = {&sgt_odd_asphere_ops, s.keep(odd)};
        break;
    }
    default: {
        s.type = "sum";
        sgt_even_asphere even = {0, 0, 0, {}};
        for (int i = 1; i < 6; i++) even.a[i] = coefficient(g, strong * std::pow(h, -2 * i - 2));
        std::vector<sgt_surface> terms = {
            {&sgt_even_asphere_ops, s.keep(even)},
            {&sgt_zernike_ops, s.keep(sgt_zernike{0, 0, 0, h, SGT_FRINGE, 0, numbers(1, 4 * n, one)})}};
        auto *kept = s.keep(terms);
        s.s = {&sgt_sum_ops, s.keep(sgt_sum{c, k, 0, kept->data(), kept->size()})};
    }
    }
    return s;
}

sgt_ray drawn(generator &g, const specimen &s, const formula<double> &f)
{
    const double r = s.h * std::sqrt(g.uniform(0, 1.5)), about = g.uniform(0, 6.2832),
                 x = r * std::cos(about), y = r * std::sin(about), sag = -f(x, y, 0.0),
                 z0 = sag == sag ? sag : 0, to = g.uniform(0, 6.2832),
                 up = g.chance(0.4) ? g.uniform(-0.1, 0.1) : g.uniform(-1, 1), flat = std::sqrt(1 - up * up);
    const sgt_vec3 d = {flat * std::cos(to), flat * std::sin(to), up};
    const double off = g.chance(0.1) ? 0 : g.sign() * s.h * g.log_uniform(1e-6, 3),
                 back = g.chance(0.5) ? 0 : s.h * g.log_uniform(0.1, g.chance(0.3) ? 1e6 : 100),
                 end = g.chance(0.7) ? INFINITY : back + s.h * g.log_uniform(0.1, 100);
    return {{x - back * d.x, y - back * d.y, z0 + off - back * d.z}, d, 0, end};
}

// The same where symmetry is: through the axis to the last bit, along it, from 10^14 away; or from on the
// sag.
sgt_ray special(generator &g, const specimen &s, const formula<double> &f)
{
    sgt_ray r = drawn(g, s, f);
    switch (static_cast<int>(g.uniform(0, 5))) {
    case 0: {
        const double back = std::ldexp(1.0, static_cast<int>(g.uniform(-4, 8))) * s.h;
        r.o = {-back * r.d.x, -back * r.d.y, r.o.z};
        break;
    }
    case 1:
        r.d = {0, 0, g.sign()};
        break;
    case 2: { // nearly along it
        const double by = g.log_uniform(1e-12, 1e-2);
        r.d = {by * r.d.x, by * r.d.y, r.d.z};
        break;
    }
    case 3: {
        const double back = s.h * g.log_uniform(1e6, 1e14);
        r.o = {r.o.x - back * r.d.x, r.o.y - back * r.d.y, r.o.z - back * r.d.z};
        r.tmax = INFINITY;
        break;
    }
    default: {
        const sgt_hit h = sgt_intersect(s.s, r, nullptr);
        if (h.status == SGT_HIT) r.o = h.p;
        const double up = g.uniform(-1, 1), to = g.uniform(0, 6.2832), flat = std::sqrt(1 - up * up);
        r.d = {flat * std::cos(to), flat * std::sin(to), up};
    }
    }
    return r;
}

// Shifts a ray along z so that F nearly touches zero where |F| has a minimum, on this side of it or on that.
// Returns that t; NaN: there is none.
double touch(generator &g, const specimen &s, const formula<double> &f, sgt_ray &r)
{
    const double a = std::hypot(r.d.x, r.d.y), near = -(r.o.x * r.d.x + r.o.y * r.d.y) / (a * a);
    std::vector<double> t, is;
    for (int i = 0; i < 200; i++) {
        const double at = near + s.h / a * std::tan(3.14159 * ((i + 0.5) / 200 - 0.5));
        if (at < r.tmin + 1e-6 * s.h || at > r.tmax) continue;
        t.push_back(at), is.push_back(f(r.o.x + at * r.d.x, r.o.y + at * r.d.y, r.o.z + at * r.d.z));
    }
    for (std::size_t i = 1; i + 1 < t.size(); i++) {
        if (!(is[i] * is[i - 1] > 0 && is[i] * is[i + 1] > 0)) continue;
        if (!(std::fabs(is[i]) < std::fabs(is[i - 1]) && std::fabs(is[i]) < std::fabs(is[i + 1]))) continue;
        double lo = t[i - 1], hi = t[i + 1];
        for (int k = 0; k < 60; k++) {
            const double one = lo + (hi - lo) / 3, other = hi - (hi - lo) / 3;
            auto at = [&](double v) {
                return std::fabs(f(r.o.x + v * r.d.x, r.o.y + v * r.d.y, r.o.z + v * r.d.z));
            };
            (at(one) < at(other) ? hi : lo) = at(one) < at(other) ? other : one;
        }
        const double v = 0.5 * (lo + hi), left = f(r.o.x + v * r.d.x, r.o.y + v * r.d.y, r.o.z + v * r.d.z);
        r.o.z -=
            left + g.sign() * g.log_uniform(1e-14, 1e-2) * (s.h + std::fabs(left)); // F is z less the sag
        return v;
    }
    return NAN;
}

// What a watcher is told of stretches: F, in 113 bits, lies in the range that is told.  Next to the ends of a
// stretch, where F is monotone, that is all of what it may be off.
int gather(void *data, const sgt_step *step)
{
    if (step->kind == SGT_OVER_CELL) static_cast<std::vector<sgt_step> *>(data)->push_back(*step);
    return 0;
}

bool holds(const formula<quad> &f, const sgt_ray &r, const sgt_step &cell)
{
    const double in = 0x1p-49 * (std::fabs(cell.lo) + std::fabs(cell.hi));
    for (double t :
         {cell.lo + in, cell.hi - in, 0.5 * cell.lo + 0.5 * cell.hi, 0.9 * cell.lo + 0.1 * cell.hi}) {
        if (!(t > cell.lo && t < cell.hi && std::fabs(t) < 1e30)) continue;
        const quad is = along(f, r, t);
        if (is == is && (is < quad(cell.f_lo) || is > quad(cell.f_hi))) return false;
    }
    return true;
}

struct counts {
    long rays, hits, misses, undecided, by_misses;
};

void check(generator &g, int kind, int surfaces, counts *all)
{
    constexpr int RAYS = 12;
    for (int n = 0; n < surfaces; n++) {
        specimen s = wide(g, kind);
        const formula<double> rough(s.s);
        const formula<quad> exact(s.s);
        std::vector<sgt_ray> rays;
        std::vector<double> touched;
        std::vector<double> in[7], out[3];
        for (int i = 0; i < RAYS; i++) {
            const bool apart = kind > 4 && g.chance(0.4);
            sgt_ray ray = apart ? special(g, s, rough) : drawn(g, s, rough);
            touched.push_back(!apart && g.chance(0.4) ? touch(g, s, rough, ray) : NAN);
            const double of[] = {ray.o.x, ray.o.y, ray.o.z, ray.d.x, ray.d.y, ray.d.z, ray.tmax};
            rays.push_back(ray);
            for (int j = 0; j < 7; j++) in[j].push_back(of[j]);
        }
        std::vector<double> zero(RAYS, 0);
        std::vector<sgt_status> status(RAYS);
        std::vector<int> evals(RAYS);
        for (std::vector<double> &a : out) a.resize(RAYS);
        const sgt_rays many = {{in[0].data(), in[1].data(), in[2].data()},
                               {in[3].data(), in[4].data(), in[5].data()},
                               zero.data(),
                               in[6].data()};
        sgt_hits told = {};
        told.status = status.data(), told.evals = evals.data(), told.t = out[0].data(),
        told.t_err = out[1].data(), told.p_err = out[2].data();
        sgt_intersect_batch(s.s, RAYS, many, told, nullptr);
        for (std::size_t i = 0; i < RAYS; i++) {
            const sgt_ray &ray = rays[i];
            std::vector<sgt_step> cells;
            sgt_options watched = {};
            watched.watch = gather, watched.watch_data = &cells;
            const sgt_hit h = sgt_intersect(s.s, ray, &watched);
            for (std::size_t j = 0; j < cells.size() && j < 12; j++)
                if (!holds(exact, ray, cells[j])) fail("F is not in the range of a stretch", s, ray, h);
            const double one[] = {h.t, h.t_err, h.p_err};
            bool same = h.status == status[i] && h.evals == evals[i];
            for (int j = 0; j < 3; j++)
                same = same && (std::memcmp(&one[j], &out[j][i], sizeof one[j]) == 0 ||
                                (one[j] != one[j] && out[j][i] != out[j][i]));
            if (!same) fail("a batch is not the single ray", s, ray, h);
            all->rays++, all->undecided += h.status < 0;
            sgt_ray from = ray; // the start itself may be a root
            from.tmin = 1e-6 * s.h;
            if (h.status == SGT_MISS) {
                all->misses++, all->by_misses += h.evals;
                if (changes(rough, exact, from, INFINITY, s.h, touched[i]))
                    fail("a miss that meets", s, ray, h);
            }
            if (h.status != SGT_HIT) continue;
            all->hits++;
            const quad at = quad(h.t) + quad(h.t_lo), width = quad(h.t_err) * (1 + quad(0x1p-20)),
                       left = along(exact, ray, at - width), right = along(exact, ray, at + width);
            if (left == left && right == right && sign(left) * sign(right) > 0)
                fail("no root within t_err", s, ray, h);
            const double before = static_cast<double>(at - width) * (1 - 0x1p-50);
            if (before > from.tmin && changes(rough, exact, from, before, s.h, touched[i]))
                fail("another root is nearer", s, ray, h);
        }
    }
}

// Rays from afar at a departure of four rows of Chebyshev terms, or of 59 Zernike terms, without a rim.
void from_afar(generator &g)
{
    long rays = 0, evals = 0, many = 0;
    for (int n = 0; n < 24; n++) {
        const double h = g.log_uniform(0.1, 10), strong = h * g.log_uniform(1e-5, 1e-2),
                     c = g.sign() * g.log_uniform(0.01, 0.3) / h, k = g.uniform(-20, -1.2);
        specimen s = {};
        std::vector<double> a(60);
        for (double &x : a) x = g.uniform(-1, 1) * strong / 16;
        if (n % 2 == 0)
            s.s = {&sgt_chebyshev_ops, s.keep(sgt_chebyshev{c, k, 0, h, h, s.numbers(4, 4, a)})};
        else
            s.s = {&sgt_zernike_ops, s.keep(sgt_zernike{c, k, 0, h, SGT_NOLL, 0, s.numbers(1, 59, a)})};
        for (int i = 0; i < 40; i++) {
            const double r = h * std::sqrt(g.uniform(0, 1)), phi = g.uniform(0, 6.2832),
                         tilt = g.uniform(0, 0.6), about = g.uniform(0, 6.2832), x = r * std::cos(phi),
                         y = r * std::sin(phi),
                         z = -s.s.ops->value(s.s.self, {x, y, 0}, nullptr), back = 1e4 * h;
            const sgt_vec3 d = {std::sin(tilt) * std::cos(about), std::sin(tilt) * std::sin(about),
                                std::cos(tilt)};
            const sgt_hit hit =
                sgt_intersect(s.s, {{x - back * d.x, y - back * d.y, z - back * d.z}, d, 0, 0}, nullptr);
            rays++, evals += hit.evals, many += hit.evals > 50;
            if (hit.status != SGT_HIT) failed["a ray from afar at the surface does not meet it"]++;
        }
    }
    const double mean = static_cast<double>(evals) / static_cast<double>(rays);
    std::printf("from afar: %ld rays by %.1f evaluations, %ld by more than 50\n", rays, mean, many);
    if (mean > 12 || many * 50 > rays) failed["rays from afar take too many evaluations"]++;
}

// A table of Chebyshev terms without rows or without columns may name any number of the other.
void empty_tables()
{
    const double none[1] = {0};
    for (int way = 0; way < 2; way++) {
        const sgt_numbers a = {none, way ? 64U : 0U, way ? 0U : 64U};
        const sgt_chebyshev empty = {-0.05, -1, 0, 3, 4, a};
        const sgt_conic base = {-0.05, -1, 0};
        generator g(3);
        for (int i = 0; i < 300; i++) {
            const sgt_ray ray = {{g.uniform(-30, 30), g.uniform(-30, 30), g.uniform(-30, 30)},
                                 {g.uniform(-1, 1), g.uniform(-1, 1), g.uniform(-1, 1)}, 0, INFINITY};
            const sgt_hit h = sgt_intersect({&sgt_chebyshev_ops, &empty}, ray, nullptr),
                          conic = sgt_intersect({&sgt_conic_ops, &base}, ray, nullptr);
            const bool met = h.status == SGT_HIT && std::fabs(h.t - conic.t) <= h.t_err + conic.t_err;
            if (h.status >= 0 && (h.status != conic.status || (h.status == SGT_HIT && !met)))
                failed["a table without terms is not its base"]++;
        }
    }
}

} // namespace

int main()
{
    const char *given = std::getenv("SAGITTA_TEST_SEED"), *scale = std::getenv("SAGITTA_TEST_SCALE"),
               *only = std::getenv("SAGITTA_TEST_TYPE");
    const std::uint64_t seed = given ? std::strtoull(given, nullptr, 0) : 5;
    std::printf("seed %llu\n", static_cast<unsigned long long>(seed));
    const int surfaces = static_cast<int>(60 * (scale ? std::atof(scale) : 0.5));
    generator g(seed);
    for (int kind = 0; kind < 8; kind++) {
        counts all = {};
        if (only && std::atoi(only) != kind) continue;
        check(g, kind, surfaces, &all);
        std::printf("%d: %ld rays, %ld hits, %ld misses by %.1f evaluations, %ld undecided\n", kind, all.rays,
                    all.hits, all.misses,
                    static_cast<double>(all.by_misses) / static_cast<double>(all.misses), all.undecided);
        if (all.undecided * 10 > all.rays + 60) failed["too many are undecided"]++;
    }
    from_afar(g);
    empty_tables();
    for (const auto &f : failed) std::printf("%s: %d times\n", f.first.c_str(), f.second);
    return !failed.empty();
}
