// SPDX-License-Identifier: MIT
// Rays that graze an even asphere (src/surface/asphere/graze.h), against quad.h: random surfaces in any unit
// of length, with a rim and without, of weak and strong terms of either sign, and rays that meet them at 45
// degrees to 0.005, from outside and inside, from near and from 10^7 radii.  In batches of 40, each
// beside the single ray to the last bit, with and without its evaluations.
//
//   a hit     a root lies within t_err of t, and none that counts is before it; p is within 24 ulps of the
//             largest term off the surface (SHARP ENOUGH in easy.h allows as much), and within p_err of the
//             root
//   a miss    no root counts
//
// Most are met: else nothing would be tested.
#include "cases.h"
#include "quad.h"

#include <cstring>

using namespace oracle;

namespace {

long failures, hits, misses, left, told;

void fail(const char *why, const sgt_even_asphere &s, const sgt_ray &r, const sgt_hit &h, const answer *a)
{
    failures++;
    if (told++ >= 5) return;
    std::printf("FAIL %s: %s t %.17g + %.3g t_err %.3g\n    c, k, rim %a %a %a  a", why,
                sgt_status_text(h.status), h.t, h.t_lo, h.t_err, s.c, s.k, s.semi_diameter);
    for (double x : s.a) std::printf(" %a", x);
    std::printf("\n    ray {{%a, %a, %a}, {%a, %a, %a}, %a, %a}\n", r.o.x, r.o.y, r.o.z, r.d.x, r.d.y, r.d.z,
                r.tmin, r.tmax);
    for (size_t i = 0; a && i < a->roots.size(); i++)
        std::printf("    root %s\n", text(a->roots[i].t()).c_str());
}

void judge(const sgt_even_asphere &s, const sgt_ray &ray, const sgt_hit &h)
{
    if (h.status == SGT_HIT) hits++;
    else if (h.status == SGT_MISS) misses++;
    else {
        left++;
        return;
    }
    const surface own(s);
    const answer a = all_roots(own, ray);
    if (!a.doubtful.empty() || a.everywhere) return;
    bool there = false;
    for (const meeting &m : a.roots) {
        const counts is = counting(m, ray.tmin, ray.tmax);
        if (h.status == SGT_MISS) {
            if (is == yes) return fail("a miss that meets", s, ray, h, &a);
            continue;
        }
        const quad off = magnitude(m.minus(h.t)), bound = quad(h.t_err) * (1 + quad(1e-9)) + m.blur;
        if (off <= bound && is != no) {
            there = true;
            const quad away = norm({m.p.x - h.p.x, m.p.y - h.p.y, m.p.z - h.p.z});
            if (away > quad(h.p_err) * (1 + quad(1e-9)) + m.blur)
                fail("p is off by more than p_err", s, ray, h, &a);
        } else if (is == yes && m.minus(h.t) < 0)
            return fail("not the first", s, ray, h, &a);
    }
    if (h.status != SGT_HIT) return;
    if (!there) return fail("a hit without a root that counts", s, ray, h, &a);
    quad largest;
    const quad ulps = normal_error(own, {h.p.x, h.p.y, h.p.z}, &largest);
    if (ulps > 24 * quad(ulp(to_double(largest)))) fail("p is off the surface", s, ray, h, &a);
}

double log_uniform(generator &g, double lo, double hi) { return lo * std::pow(hi / lo, g.uniform(0, 1)); }

sgt_even_asphere random_surface(generator &g, double *radius)
{
    sgt_even_asphere s = {};
    const double unit = std::ldexp(1.0, static_cast<int>(g.uniform(-30, 30))),
                 curve = log_uniform(g, 0.003, 0.6),
                 depart = g.chance(0.1) ? 0 : log_uniform(g, 1e-6, 0.5);
    const int terms = 1 + g.below(g.chance(0.3) ? 8 : 4);
    *radius = unit;
    s.c = g.sign() * curve / unit, s.k = g.chance(0.2) ? 0 : g.chance(0.2) ? -1 : g.uniform(-4, 1.5);
    for (int i = g.chance(0.2) ? 0 : 1; i < terms; i++)
        s.a[i] = g.sign() * curve * depart * g.uniform(0, 1) / std::pow(unit, 2 * i + 1);
    if (s.a[1] == 0) s.a[1] = 1e-7 * curve / std::pow(unit, 3);
    s.semi_diameter = g.chance(0.5) ? 0 : unit * g.uniform(1, 1.5);
    return s;
}

sgt_ray random_ray(generator &g, const sgt_even_asphere &s, double radius)
{
    const double r = radius * std::sqrt(g.uniform(0.01, 1)), about = 2 * M_PI * g.uniform(0, 1),
                 x = r * std::cos(about), y = r * std::sin(about), h = 0x1p-20 * radius;
    const auto sag = [&](double at) { return rough_sag(s, at * at); };
    const double rise = (sag(r + h) - sag(r - h)) / (2 * h), nx = -rise * x / r, ny = -rise * y / r,
                 length = std::sqrt(nx * nx + ny * ny + 1), angle = log_uniform(g, 0.005, 45) * M_PI / 180,
                 phi = 2 * M_PI * g.uniform(0, 1), l = std::cos(phi), m = std::sin(phi),
                 n = -(nx * l + ny * m),
                 by = std::cos(angle) / std::sqrt(1 + n * n), up = g.sign() * std::sin(angle) / length,
                 size = g.chance(0.7) ? 1 : log_uniform(g, 0.01, 100),
                 before = (g.chance(0.8) ? log_uniform(g, 0.1, 20) : log_uniform(g, 1, 1e7)) * radius;
    const sgt_vec3 d = {by * l + up * nx, by * m + up * ny, by * n + up};
    sgt_ray ray = {{x - before * d.x, y - before * d.y, sag(r) - before * d.z},
                   {size * d.x, size * d.y, size * d.z}, 0, HUGE_VAL};
    if (g.chance(0.1)) ray.tmin = g.uniform(-1, 1.2) * before / size;
    if (g.chance(0.05)) ray.tmin = -HUGE_VAL;
    if (g.chance(0.1)) ray.tmax = ray.tmin + g.uniform(0, 3) * before / size;
    return ray;
}

bool same(double a, double b) { return std::memcmp(&a, &b, sizeof a) == 0 || (a != a && b != b); }

void batch(generator &g)
{
    enum { N = 40 };
    double radius, in[8][N], out[10][N];
    const sgt_even_asphere s = random_surface(g, &radius);
    const sgt_surface of = {&sgt_even_asphere_ops, &s};
    sgt_status status[N], again[N];
    int evals[N];
    std::vector<sgt_ray> rays;
    for (int i = 0; i < N; i++) {
        const sgt_ray r = random_ray(g, s, radius);
        const double of_ray[8] = {r.o.x, r.o.y, r.o.z, r.d.x, r.d.y, r.d.z, r.tmin, r.tmax};
        for (int k = 0; k < 8; k++) in[k][i] = of_ray[k];
        rays.push_back(r);
    }
    sgt_options opt = {};
    opt.pick = g.chance(0.8) ? SGT_FIRST : SGT_NEAR_SEED;
    const sgt_rays all = {{in[0], in[1], in[2]}, {in[3], in[4], in[5]}, in[6], in[7]};
    const sgt_hits to = {status, evals, out[0], out[1], out[2], {out[3], out[4], out[5]},
                         {out[6], out[7], out[8]}, out[9], {}},
                   plain = {again, nullptr, nullptr, nullptr, nullptr, {}, {}, nullptr, {}};
    sgt_intersect_batch(of, N, all, to, &opt);
    sgt_intersect_batch(of, N, all, plain, &opt);
    for (std::size_t i = 0; i < std::size_t{N}; i++) {
        const sgt_hit h = sgt_intersect(of, rays[i], &opt);
        const double one[10] = {h.t, h.t_err, h.t_lo, h.p.x, h.p.y, h.p.z, h.n.x, h.n.y, h.n.z, h.p_err};
        bool alike = status[i] == h.status && again[i] == h.status && evals[i] == h.evals;
        for (int k = 0; k < 10; k++) alike = alike && (h.status != SGT_HIT || same(out[k][i], one[k]));
        if (!alike) fail("the batch and the single ray differ", s, rays[i], h, nullptr);
        if (opt.pick == SGT_FIRST) judge(s, rays[i], h);
    }
}

// Rays at the edge of the disc of easy.h (BY CONSTANTS), where the step before the last may lie in it and the
// first may not: each alone, beside itself, and beside a ray on the axis.
void beside_others(generator &g)
{
    constexpr std::size_t N = 17;
    const double a[8] = {0, -0x1.c1b4c5c6fa411p-9, 0x1.8e26789e54ae1p-11, -0x1.090767e8df299p-11};
    sgt_even_asphere s = {0x1.33259e089a438p-2, 0x1.688b5fd70ce80p-3, 0, {}};
    for (int i = 0; i < 8; i++) s.a[i] = a[i] * (g.chance(0.5) ? 1 : g.uniform(0.999, 1.001));
    const sgt_surface of = {&sgt_even_asphere_ops, &s};
    sgt_options opt = {};
    opt.pick = g.chance(0.7) ? SGT_NEAR_SEED : SGT_FIRST;
    opt.t_tol = g.chance(0.7) ? 1e-6 : 0;
    const double by = g.chance(0.3) ? 0 : g.uniform(-3e-3, 3e-3);
    const sgt_ray ray = {{-0x1.ea259d3e8a01fp+0 * (1 + by), 0, -0x1.31a74bc5551d3p+3},
                         {0x1.2f2c2d4ea0b2cp-2, 0x1.47ae147ae147bp-6, 0x1.e90bac6eee951p-1},
                         0,
                         HUGE_VAL};
    const sgt_hit one = sgt_intersect(of, ray, &opt);
    for (int others = 0; others < 2; others++) {
        double in[6][N], t[N], t_err[N];
        sgt_status status[N];
        int evals[N];
        for (std::size_t i = 0; i < N; i++) {
            const bool axis = others && i == N - 1;
            const sgt_ray r = axis ? sgt_ray{{0.1, 0, -10}, {0, 0, 1}, 0, HUGE_VAL} : ray;
            const double x[6] = {r.o.x, r.o.y, r.o.z, r.d.x, r.d.y, r.d.z};
            for (int k = 0; k < 6; k++) in[k][i] = x[k];
        }
        sgt_hits to = {};
        to.status = status, to.evals = evals, to.t = t, to.t_err = t_err;
        const sgt_rays all = {{in[0], in[1], in[2]}, {in[3], in[4], in[5]}, nullptr, nullptr};
        sgt_intersect_batch(of, N, all, to, &opt);
        if (status[0] != one.status || evals[0] != one.evals || !same(t[0], one.t) ||
            !same(t_err[0], one.t_err))
            fail(others ? "a neighbour changes a ray" : "a batch of one ray differs", s, ray, one, nullptr);
    }
}

} // namespace

int main(int argc, char **argv)
{
    const run r(argc, argv, 100, 20261128);
    generator g(r.seed);
    for (long i = 0; i < r.count; i++) batch(g);
    for (long i = 0; i < r.count; i++) beside_others(g);
    std::printf("%ld hits, %ld misses, %ld undecided, %ld failures\n", hits, misses, left, failures);
    return failures || 2 * hits < misses + left || left * 50 > hits + misses;
}
