// SPDX-License-Identifier: MIT
// Rays that leave, or come at, a toroid, a biconic, a cylinder or a grid without a rim, in directions of the
// whole sphere: is a root passed over, or a hit no root (src/surface/departure/ahead.c)?
//
// F is looked at along each ray in doubles, at some 2,000 points from 1e-8 to 1e4 of the surface's size, with
// no knowledge of the library.  Where it changes its sign, the root between is found by bisection in 113
// bits.  If it is certainly not the start (8 times the rule, and rounding) and before the hit, or there is no
// hit, it has been lost.  A hit is a root if F has unlike signs, in 113 bits, within its t_err.  Each batch
// has to answer as the single rays do, to the last bit and evaluation.
#include "as_batch.h"
#include "specimens.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>

using namespace catalogue;

namespace
{

struct counted {
    long rays, hits, misses, undecided, lost, false_hits, differ;
} all;

template <class T> T along(const formula<T> &f, const sgt_ray &r, T t)
{
    return f(T(r.o.x) + t * T(r.d.x), T(r.o.y) + t * T(r.d.y), T(r.o.z) + t * T(r.d.z));
}

quad size_of(quad x) { return x < 0 ? -x : x; }

double curvature(generator &g, double h)
{
    return g.chance(0.15) ? 0 : g.sign() * g.log_uniform(0.01, 2) / h;
}

double conic(generator &g) { return g.chance(0.3) ? (g.chance(0.5) ? 0 : -1) : g.uniform(-3, 1.5); }

specimen drawn(generator &g, const std::string &type)
{
    specimen s;
    s.type = type, s.h = g.chance(0.5) ? 1 : g.log_uniform(1e-3, 1e3), s.rim = 0, s.sag = true;
    const double h = s.h, c = curvature(g, h), k = conic(g);
    if (type == "toroidal") {
        sgt_toroidal t = {c, k, curvature(g, h), 0, {}};
        const int terms = g.chance(0.3) ? 0 : static_cast<int>(g.uniform(1, 5));
        double unit = 1 / h;
        for (int i = 0; i < terms; i++, unit /= h * h) t.a[i] = g.sign() * g.log_uniform(1e-7, 0.3) * unit;
        s.s = {&sgt_toroidal_ops, s.keep(t)};
    } else if (type == "grid") {
        const std::size_t rows = static_cast<std::size_t>(g.uniform(4, 40)),
                          columns = static_cast<std::size_t>(g.uniform(4, 40));
        std::vector<double> z(rows * columns);
        const double a = g.uniform(-3, 3), b = g.uniform(-3, 3), up = h * g.log_uniform(1e-6, 0.2);
        for (std::size_t i = 0; i < rows; i++)
            for (std::size_t j = 0; j < columns; j++)
                z[i * columns + j] = up * std::cos(a * static_cast<double>(i) / static_cast<double>(rows) +
                                                   b * static_cast<double>(j) / static_cast<double>(columns));
        sgt_grid grid = {};
        grid.c = 0.3 * c, grid.k = k, grid.step_x = 3 * h / static_cast<double>(columns),
        grid.step_y = 3 * h / static_cast<double>(rows), grid.z = s.numbers(rows, columns, z);
        if (g.chance(0.8)) sgt_grid_measure(&grid);
        s.s = {&sgt_grid_ops, s.keep(grid)};
    } else {
        sgt_biconic b = {curvature(g, h), conic(g), c, k, 0};
        if (type == "cylinder") (g.chance(0.5) ? b.c_x : b.c_y) = 0;
        if (g.chance(0.1)) b.c_x = b.c_y, b.k_x = b.k_y;
        s.s = {&sgt_biconic_ops, s.keep(b)};
    }
    return s;
}

bool draw(generator &g, const specimen &s, const formula<double> &rough, sgt_ray *r)
{
    const double radius = s.h * std::sqrt(g.uniform(0, 2)) * (g.chance(0.2) ? g.log_uniform(1e-6, 1) : 1),
                 about = g.uniform(0, 6.28), x = radius * std::cos(about), y = radius * std::sin(about),
                 z = -rough(x, y, 0.0), to = g.uniform(0, 6.28), up = g.uniform(-1, 1), e = 0x1p-20 * s.h,
                 across = std::sqrt(1 - up * up),
                 nx = (rough(x + e, y, 0.0) - rough(x - e, y, 0.0)) / (2 * e),
                 ny = (rough(x, y + e, 0.0) - rough(x, y - e, 0.0)) / (2 * e);
    if (!(z == z)) return false;
    sgt_vec3 d = {across * std::cos(to), across * std::sin(to), up};
    if (g.chance(0.1)) d.x = 0;
    if (g.chance(0.1)) d.y = 0;
    if (g.chance(0.1)) d.z = 0;
    if (g.chance(0.4)) d.z = -(nx * d.x + ny * d.y) + g.sign() * g.log_uniform(1e-5, 0.5);
    if (d.x == 0 && d.y == 0 && d.z == 0) d.z = 1;
    *r = {{x, y, z}, d, 0, INFINITY};
    if (g.chance(0.25)) {
        const double back = s.h * g.log_uniform(1e-5, 1e2) * (g.chance(0.1) ? g.log_uniform(1e3, 1e12) : 1);
        r->o = {x - back * d.x, y - back * d.y, z - back * d.z};
    } else if (g.chance(0.7)) {
        const sgt_hit hit = sgt_intersect(s.s, {{x, y, z - s.h}, {0, 0, 1}, 0, INFINITY}, nullptr);
        if (hit.status != SGT_HIT) return false;
        r->o = hit.p;
    }
    if (g.chance(0.1)) r->tmax = s.h * g.log_uniform(0.1, 30);
    if (g.chance(0.05)) r->tmin = s.h * g.log_uniform(1e-6, 3);
    return r->tmin < r->tmax;
}

// The places at which F is looked at, up to `end`.
std::vector<double> places(const sgt_ray &r, double h, double end)
{
    const double first = 1e-8 * h, last = std::min(end, 1e4 * h), far = std::hypot(r.o.x, r.o.y, r.o.z),
                 near = std::max(far - 30 * h, 0.0);
    std::vector<double> t;
    for (int j = 0; j <= 600 && last > first; j++)
        t.push_back(r.tmin + first * std::pow(last / first, j / 600.0));
    for (int j = 0; j <= 1200; j++) t.push_back(near + 60 * h * j / 1200);
    std::sort(t.begin(), t.end());
    return t;
}

// Is there a root in [left, right] that a hit, or a miss, has passed over?
bool passed_over(const specimen &s, const formula<quad> &exact, const sgt_ray &r, const sgt_hit &got,
                 quad left, quad right)
{
    const quad before = along(exact, r, left), behind = along(exact, r, right);
    if (!(before * behind < 0)) return false;
    for (int i = 0; i < 90; i++) {
        const quad t = (left + right) / 2, f = along(exact, r, t);
        if (!(f == f)) return false;
        (f * before > 0 ? left : right) = t;
    }
    const quad a = along(exact, r, left), b = along(exact, r, right), jump = size_of(a - b);
    if (!(jump < quad(1e-9) * quad(s.h))) return false;
    const double t = static_cast<double>(left);
    const sgt_vec3 p = {r.o.x + t * r.d.x, r.o.y + t * r.d.y, r.o.z + t * r.d.z};
    sgt_vec3 n = {0, 0, 0};
    s.s.ops->value(s.s.self, p, &n);
    const double slope = std::fabs(n.x * r.d.x + n.y * r.d.y + n.z * r.d.z),
                 terms = std::fabs(p.x * n.x) + std::fabs(p.y * n.y) + std::fabs(p.z * n.z);
    const bool start = !((t - r.tmin) * slope > 8 * (0x1p-48 * terms + s.s.ops->rounding(s.s.self, p)));
    return !start && t > r.tmin && t < r.tmax * (1 - 1e-12) &&
           (got.status == SGT_MISS || left < quad(got.t) - 4 * quad(got.t_err));
}

// Has F unlike signs beside the hit?
bool is_root(const formula<quad> &exact, const sgt_ray &r, const sgt_hit &got)
{
    const quad t = quad(got.t) + quad(got.t_lo), off = quad(got.t_err) * quad(1.0001) + quad(1e-300);
    const quad a = along(exact, r, t - off), b = along(exact, r, t + off);
    return !(a == a && b == b) || a * b <= 0 || got.status == SGT_GRAZE;
}

void told(const char *type, const char *what, const specimen &s, const sgt_ray &r, const sgt_hit &got,
          double at)
{
    std::printf(
        "%s: %s at %.17g, %s %.17g +- %g\n    o %.17g %.17g %.17g, d %.17g %.17g %.17g, from %.17g up to "
        "%.17g\n    ",
        type, what, at, sgt_status_text(got.status), got.t, got.t_err, r.o.x, r.o.y, r.o.z, r.d.x, r.d.y,
        r.d.z, r.tmin, r.tmax);
    print_surface(s.s);
}

void ask(const char *type, const specimen &s, const std::vector<sgt_ray> &rays, const formula<double> &rough)
{
    const formula<quad> exact(s.s);
    const as_batch batch(s.s, rays);
    for (std::size_t i = 0; i < rays.size(); i++) {
        const sgt_ray &r = rays[i];
        const sgt_hit one = sgt_intersect(s.s, r, nullptr);
        const bool same = batch.same(i, one);
        all.rays++, all.hits += one.status > 0, all.misses += one.status == SGT_MISS;
        all.undecided += one.status < 0;
        if (!same && all.differ++ < 3) {
            std::printf("%d and %d evaluations, %s in the batch\n", one.evals, batch.evals[i],
                        sgt_status_text(batch.status[i]));
            told(type, "in a batch another answer", s, r, one, batch.t[i]);
        }
        if (one.status < 0) continue;
        if (one.status > 0 && !is_root(exact, r, one) && all.false_hits++ < 3)
            told(type, "no root", s, r, one, one.t);
        double last = NAN, f_last = NAN;
        for (double at : places(r, s.h, one.status > 0 ? one.t - 4 * one.t_err : r.tmax)) {
            if (one.status > 0 && at > one.t) break;
            const double f = along(rough, r, at);
            if (f * f_last < 0 && passed_over(s, exact, r, one, quad(last), quad(at))) {
                if (all.lost++ < 3) told(type, "a root is lost before", s, r, one, at);
                break;
            }
            last = at, f_last = f;
        }
    }
}

// A profile whose slope squared is beyond the doubles: its bends are not known, and were taken for none.
bool steep_profile()
{
    const sgt_toroidal steep = {
        0x1.e53b802b43bb8p+4, -0x1.7d2dd7797b1bdp+1, 0, 0,
        {-0x1.33fc1b762121cp+9, -0x1.206d8bd5bc7a9p+25, 0x1.1be6e43edd09p+19, 0x1.59d264c3d5943p+62,
         -0x1.1a3b4459a549ap-420, 0, -0x1.515c3fd522c6fp+117, 0x1.0a479c979b42dp+106}};
    const sgt_vec3 from = {-0x1.afafc004ad55ap+27, 0x1.fdc156912a1cfp+27, -0x1.538fec198d6a2p+1};
    const sgt_vec3 directions[] = {
        {0x1.4ae18c76672ecp-1, -0x1.86b8316f676a6p-1, -0x1.afba4dfed61a2p-38},
        {0x1.a7a73d43ff288p-1, -0x1.0ad692b757282p+0, 0x1.0a2a2547cc09bp-3}};
    bool good = true;
    for (const sgt_vec3 &d : directions) {
        const sgt_hit h = sgt_intersect({&sgt_toroidal_ops, &steep}, {from, d, 0, INFINITY}, nullptr);
        good = good && h.status == SGT_HIT;
        if (h.status != SGT_HIT) std::printf("a steep toroid: %s\n", sgt_status_text(h.status));
    }
    return good;
}

// Toroids whose base never ends, or is a line: nothing is met, which the heights of all of it tell from the
// start of the ray, and would not tell from far out.
bool far_misses()
{
    const struct {
        double c, k, c_x;
        sgt_ray ray;
    } missed[] = {
        {0, -0x1.5fbe767c638ebp+1, -0x1.efb98e00845cbp-7,
         {{0x1.7cf21c65c0152p+5, 0x1.2f8144e7c1e07p+3, -0x1.107b1f38d7b89p+8},
          {0, 0x1.3d1cf40191305p-2, -0x1.e6d493e856277p-1}, 0x1.51972336e451p+5, INFINITY}},
        {0x1.6e2f900e60f8cp-7, -10, 0x1.d4356a0f6763ep-1,
         {{0x1.01e7b9b7e2f06p+0, -0x1.cbdead185929ap+1, -0x1.167646583c523p-18},
          {0x1.3e374bcb9962dp-2, -0x1.1bb4223218413p+0, -0x1.57944a3d38292p-20}, 0, INFINITY}},
        {0x1.463f6f697d2efp+5, -2, 0x1.343c2800627a3p+4,
         {{0x1.5ff2d0d21688dp-11, 0x1.5083d4c503814p-12, -0x1.7c0144dfb1727p-12},
          {0x1.3b40003ff3d75p-1, -0x1.fbb4854d136f9p+0, -0x1.4b80f6058c48fp+0}, 0, INFINITY}},
    };
    bool good = true;
    for (const auto &one : missed) {
        const sgt_toroidal s = {one.c, one.k, one.c_x, 0, {}};
        const sgt_hit h = sgt_intersect({&sgt_toroidal_ops, &s}, one.ray, nullptr);
        good = good && h.status == SGT_MISS;
        if (h.status != SGT_MISS) std::printf("a toroid that is missed: %s\n", sgt_status_text(h.status));
    }
    return good;
}

} // namespace

int main()
{
    const char *seed = std::getenv("SAGITTA_TEST_SEED"), *scale = std::getenv("SAGITTA_TEST_SCALE"),
               *only = std::getenv("SAGITTA_TEST_TYPE");
    const std::uint64_t from = seed ? std::strtoull(seed, nullptr, 0) : 37;
    const int rounds = static_cast<int>(30 * (scale ? std::atof(scale) : 1)) + 1;
    bool good = steep_profile();
    good = far_misses() && good;
    std::printf("seed %llu\n", static_cast<unsigned long long>(from));
    for (const char *type : {"toroidal", "biconic", "cylinder", "grid"}) {
        if (only && std::string(only) != type) continue;
        generator g(from ^ (static_cast<std::uint64_t>(type[0]) << 8));
        all = {};
        for (int round = 0; round < rounds; round++) {
            const specimen s = drawn(g, type);
            const formula<double> rough(s.s);
            std::vector<sgt_ray> rays;
            for (int i = 0; i < 400 && rays.size() < 100; i++) {
                sgt_ray r;
                if (draw(g, s, rough, &r)) rays.push_back(r);
            }
            if (!rays.empty()) ask(type, s, rays, rough);
        }
        std::printf(
            "%-9s %6ld rays, %6ld hits, %6ld misses, %4ld undecided, %ld roots lost, %ld hits no root, %ld "
            "differ in a batch\n",
            type, all.rays, all.hits, all.misses, all.undecided, all.lost, all.false_hits, all.differ);
        good =
            good && all.lost == 0 && all.false_hits == 0 && all.differ == 0 && all.undecided <= all.rays / 10;
    }
    return !good;
}
