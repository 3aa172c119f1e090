// SPDX-License-Identifier: MIT
// The rim of every sag and the clear aperture of an element, where a chord or a square of it may go wrong:
// a rim of the greatest numbers is none, one of the smallest is never a wrong answer, and a root exactly on
// the rim, at either end of the ray's chord, is never a miss.
#include "agree.h"
#include "judge.h"

#include <sagitta/system.h>

using namespace catalogue;

namespace {

std::map<std::string, long> failed;
long asked;

const std::vector<const char *> all_sags = types_of({"conic", "even_asphere"}, true, false);

void print_ray(const sgt_ray &r)
{
    std::printf("    ray {{%a, %a, %a}, {%a, %a, %a}, %a, %a}\n", r.o.x, r.o.y, r.o.z, r.d.x, r.d.y, r.d.z,
                r.tmin, r.tmax);
}
void print_hit(const char *name, const sgt_hit &h)
{
    std::printf("    %s %s evals %d t %.17g t_err %g [%g, %g] p %a %a %a\n", name, sgt_status_text(h.status),
                h.evals, h.t, h.t_err, h.lo, h.hi, h.p.x, h.p.y, h.p.z);
}

void fail(const specimen &s, double rim, const sgt_ray &r, const sgt_options &o, const std::string &why,
          const sgt_hit *hit)
{
    if (failed[s.type + ": " + why]++) return;
    std::printf("FAIL %s of semi_diameter %a: %s; pick %d proof %d\n", s.type.c_str(), rim, why.c_str(),
                static_cast<int>(o.pick), static_cast<int>(o.proof));
    print_surface(s.s);
    print_ray(r);
    if (hit) print_hit("answer", *hit);
}

specimen random_sag(generator &g, const std::string &type)
{
    if (type != "conic" && type != "even_asphere") return random_specimen(g, type);
    specimen s = random_specimen(g, "odd_asphere");
    const double *of = first_number(s.s);
    sgt_even_asphere a = {of[0], of[1], of[2], {}};
    s.type = type;
    if (type == "even_asphere") {
        a.a[0] = 0.01 / s.h, a.a[1] = 0.003 / (s.h * s.h * s.h);
        s.s = {&sgt_even_asphere_ops, s.keep(a)};
    } else s.s = {&sgt_conic_ops, s.keep(sgt_conic{a.c, a.k, a.semi_diameter})};
    return s;
}

bool same(double a, double b) { return a == b || (a != a && b != b); }
bool same(const sgt_hit &a, const sgt_hit &b)
{
    return a.status == b.status && a.evals == b.evals && same(a.t, b.t) && same(a.t_err, b.t_err) &&
           same(a.lo, b.lo) && same(a.hi, b.hi) && same(a.p.x, b.p.x) && same(a.p.y, b.p.y) &&
           same(a.p.z, b.p.z);
}

sgt_hit by_batch(const sgt_surface &s, const sgt_ray &r, const sgt_options &o)
{
    sgt_status status;
    double t;
    sgt_hits out = {};
    out.status = &status, out.t = &t;
    sgt_intersect_batch(s, 1, {{&r.o.x, &r.o.y, &r.o.z}, {&r.d.x, &r.d.y, &r.d.z}, &r.tmin, &r.tmax}, out,
                        &o);
    sgt_hit hit = {};
    hit.status = static_cast<sgt_status>(status), hit.t = t;
    return hit;
}

// Rims of the greatest and the smallest numbers.
void extremes(generator &g, const std::string &type)
{
    const specimen s = random_sag(g, type);
    specimen shape = s;
    if (type == "conic")
        shape.s = {&sgt_odd_asphere_ops,
                   shape.keep(sgt_odd_asphere{first_number(s.s)[0], first_number(s.s)[1], s.rim, {}})};
    const subject of(shape);
    double *rim = rim_of(s);
    for (int i = 0; i < 6; i++) {
        sgt_ray r = random_ray(g, of, static_cast<ray_kind>(g.below(ray_kinds)));
        sgt_options o = {};
        o.pick = g.chance(0.5) ? SGT_FIRST : SGT_NEAR_SEED;
        o.proof = static_cast<sgt_proof>(g.below(3));
        *rim = 0;
        const sgt_hit none = sgt_intersect(s.s, r, &o);
        sgt_hit all[8], other[8];
        const int n = sgt_intersect_all(s.s, r, 8, all, &o);
        for (const double wide : {0x1p500, 1e200, DBL_MAX}) {
            *rim = wide;
            asked++;
            const sgt_hit hit = sgt_intersect(s.s, r, &o), batch = by_batch(s.s, r, o);
            if (!same(hit, none)) fail(s, wide, r, o, "it is not as without a rim", &hit);
            if (batch.status != none.status || !same(batch.t, none.t))
                fail(s, wide, r, o, "a batch is not as without a rim", &batch);
            int m = sgt_intersect_all(s.s, r, 8, other, &o);
            bool equal = m == n;
            for (int j = 0; equal && j < n && j < 8; j++)
                equal = all[j].status == other[j].status && same(all[j].t, other[j].t);
            if (!equal) fail(s, wide, r, o, "all are not as without a rim", nullptr);
        }
        for (const double narrow : {0x1p-481, 1e-200, 1e-300, 0x1p-1074}) {
            *rim = narrow;
            asked++;
            const sgt_hit hit = sgt_intersect(s.s, r, &o), batch = by_batch(s.s, r, o);
            if (hit.status != SGT_UNPROVEN) fail(s, narrow, r, o, "something is told", &hit);
            if (batch.status != SGT_UNPROVEN) fail(s, narrow, r, o, "a batch tells something", &batch);
            if (sgt_intersect_all(s.s, r, 8, other, &o) != 1 || other[0].status != SGT_UNPROVEN)
                fail(s, narrow, r, o, "something is told of all", &other[0]);
        }
    }
}

// Flat: the root and the rim are exact, 3^2 + 4^2 = 5^2.
sgt_surface flat(const std::string &type, specimen *s, double rim)
{
    sgt_surface zero;
    if (type == "conic") return {&sgt_conic_ops, s->keep(sgt_conic{0, 0, rim})};
    if (type == "even_asphere") return {&sgt_even_asphere_ops, s->keep(sgt_even_asphere{0, 0, rim, {}})};
    if (type == "odd_asphere") return {&sgt_odd_asphere_ops, s->keep(sgt_odd_asphere{0, 0, rim, {}})};
    if (type == "polynomial_xy")
        return {&sgt_polynomial_xy_ops, s->keep(sgt_polynomial_xy{0, 0, rim, s->numbers(1, 1, {0.0})})};
    if (type == "chebyshev")
        return {&sgt_chebyshev_ops,
                s->keep(sgt_chebyshev{0, 0, rim, 2 * rim, 2 * rim, s->numbers(1, 1, {0.0})})};
    if (type == "zernike")
        return {&sgt_zernike_ops, s->keep(sgt_zernike{0, 0, rim, rim, SGT_NOLL, 0, s->numbers(1, 1, {0.0})})};
    if (type == "q_con") return {&sgt_q_con_ops, s->keep(sgt_q_con{0, 0, rim, rim, s->numbers(1, 1, {0.0})})};
    if (type == "q_bfs") return {&sgt_q_bfs_ops, s->keep(sgt_q_bfs{0, rim, rim, s->numbers(1, 1, {0.0})})};
    if (type == "grid")
        return {&sgt_grid_ops, s->keep(sgt_grid{0, 0, rim, rim, rim,
                                                s->numbers(4, 4, std::vector<double>(16, 0.0)), 0, 0, 0})};
    if (type == "toroidal") return {&sgt_toroidal_ops, s->keep(sgt_toroidal{0, 0, 0, rim, {}})};
    if (type == "biconic" || type == "cylinder")
        return {&sgt_biconic_ops, s->keep(sgt_biconic{0, 0, 0, 0, rim})};
    if (type != "sum") { // one that is known by its row
        const sgt_builtin *b = row_named(type);
        s->s = {b->ops, s->keep(std::vector<double>(b->size / sizeof(double) + 1))->data()};
        *rim_of(*s) = rim;
        return s->s;
    }
    zero = flat("odd_asphere", s, 0);
    return {&sgt_sum_ops, s->keep(sgt_sum{0, 0, rim, s->keep(zero), 1})};
}

void on_the_rim(generator &g, const std::string &type)
{
    const double unit = std::ldexp(1.0, g.below(41) - 20), rim = 5 * unit;
    specimen s = {};
    s.type = type, s.s = flat(type, &s, rim);
    static const double points[][2] = {{3, 4},  {-3, 4}, {3, -4}, {-4, -3}, {5, 0},
                                       {-5, 0}, {0, 5},  {0, -5}, {4, 3}};
    for (const auto &at : points)
        for (int i = 0; i < 8; i++) {
            const sgt_vec3 d = {double(g.below(65) - 32), double(g.below(65) - 32),
                                g.sign() * std::ldexp(1.0, -g.below(12))};
            const double back = std::ldexp(double(1 + g.below(31)), -3);
            sgt_ray r = {{unit * (at[0] - back * d.x), unit * (at[1] - back * d.y), unit * (0 - back * d.z)},
                         {unit * d.x, unit * d.y, unit * d.z},
                         0,
                         g.chance(0.5) ? HUGE_VAL : back * (1 + g.uniform(0.001, 3))};
            if (g.chance(0.3)) r.tmin = -HUGE_VAL;
            for (int proof = 0; proof < 3; proof++)
                for (const sgt_pick pick : {SGT_FIRST, SGT_NEAR_SEED}) {
                    sgt_options o = {};
                    o.pick = pick, o.proof = static_cast<sgt_proof>(proof);
                    asked++;
                    const sgt_hit hit = sgt_intersect(s.s, r, &o), batch = by_batch(s.s, r, o);
                    const bool near = std::fabs(hit.t - back) <= hit.t_err; // no more is promised of t
                    const bool right = hit.status == SGT_HIT
                                           ? near
                                           : proof != SGT_ESTIMATE && hit.status == SGT_UNPROVEN;
                    if (!right) fail(s, rim, r, o, "a root exactly on the rim", &hit);
                    if (batch.status != hit.status)
                        fail(s, rim, r, o, "a root exactly on the rim, of a batch", &batch);
                    sgt_hit all[4];
                    const int n = sgt_intersect_all(s.s, r, 4, all, &o);
                    if (n < 1 || !(all[0].lo <= back && all[0].hi >= back))
                        fail(s, rim, r, o, "a root exactly on the rim, of all", n > 0 ? &all[0] : nullptr);
                }
        }
}

// Curved: the root, in 113 bits, inside by more than rounding.
void beside_the_rim(generator &g, const std::string &type)
{
    specimen s = random_sag(g, type);
    s.rim = *rim_of(s) = s.h;
    specimen shape = s;
    if (type == "conic")
        shape.s = {&sgt_odd_asphere_ops,
                   shape.keep(sgt_odd_asphere{first_number(s.s)[0], first_number(s.s)[1], s.rim, {}})};
    const subject of(shape);
    for (int i = 0; i < 6; i++) {
        const double about = g.uniform(0, 6.283185307179586), r = s.h * (1 - 0x1p-48),
                     x = r * std::cos(about), y = r * std::sin(about), z = -of.rough(x, y, 0.0);
        const double tilt = g.uniform(0.05, 1.5), way = g.uniform(0, 6.283185307179586),
                     away = s.h * g.uniform(0.1, 3);
        const sgt_vec3 d = {std::sin(tilt) * std::cos(way), std::sin(tilt) * std::sin(way),
                            g.sign() * std::cos(tilt)};
        if (z != z) continue;
        sgt_ray ray = {{x - away * d.x, y - away * d.y, z - away * d.z}, d, 0, 2 * away};
        const judgement truth(of, ray, 8);
        root m;
        if (!truth.polish(quad(away), &m)) continue;
        const quad r2 = m.p.x * m.p.x + m.p.y * m.p.y, rim2 = quad(s.rim) * s.rim;
        if (!(r2 <= rim2 * (1 + quad(0x1p-45))) || !(oracle::magnitude(m.t - away) < quad(1e-6 * away)) ||
            counting(m, ray.tmin, ray.tmax) != oracle::yes)
            continue;
        asked++;
        sgt_options o = {};
        o.proof = static_cast<sgt_proof>(g.below(3));
        sgt_hit all[12];
        const int n = sgt_intersect_all(s.s, ray, 12, all, &o);
        bool found = false;
        for (int j = 0; j < n && j < 12; j++)
            found = found || (quad(all[j].lo) <= m.t && quad(all[j].hi) >= m.t) ||
                    oracle::magnitude(quad(all[j].t) - m.t) <= quad(all[j].t_err);
        if (!found) fail(s, s.rim, ray, o, "a root inside the rim is not told of all", nullptr);
        const sgt_hit hit = sgt_intersect(s.s, ray, &o);
        if (hit.status == SGT_MISS || (hit.status > 0 && quad(hit.t) - hit.t_err > m.t))
            fail(s, s.rim, ray, o, "a root inside the rim is passed by", &hit);
    }
}

// The clear aperture of an element.
void apertures()
{
    const sgt_conic plane = {0, 0, 0};
    const double at[] = {0, 5e-324, 9e-301, 1e-300, 1.1e-300, 1e-200, 1e-150, 1, 1e140},
                 apertures[] = {5e-324, 1e-300, 1e-150, 1, 0x1p500, 1e200, DBL_MAX};
    for (const double aperture : apertures)
        for (const double x : at) {
            const sgt_element e = {{&sgt_conic_ops, &plane}, {}, 1.5, aperture, nullptr, nullptr, {}};
            for (int proof = 0; proof < 3; proof++) {
                sgt_options o = {};
                o.proof = static_cast<sgt_proof>(proof);
                sgt_ray ray = {{x, 0, -1}, {0, 0, 1}, 0, 0};
                const sgt_ray start = ray;
                sgt_fate fate;
                sgt_trace(1, &e, 1, &ray, nullptr, &fate, &o);
                sgt_fate batch;
                sgt_traced out = {};
                out.fate = &batch;
                sgt_trace_batch(1, &e, 1, 1,
                                {{&start.o.x, &start.o.y, &start.o.z},
                                 {&start.d.x, &start.d.y, &start.d.z},
                                 nullptr,
                                 nullptr},
                                out, nullptr, &o);
                const sgt_fate right = x <= aperture ? SGT_PASSED : SGT_CLIPPED;
                asked++;
                if ((fate != right && !(proof && fate == SGT_LOST)) || batch != fate) {
                    failed["a clear aperture"]++;
                    std::printf("FAIL x = %g, aperture %g, proof %d: %s, of a batch %s\n", x, aperture, proof,
                                sgt_fate_text(fate), sgt_fate_text(static_cast<sgt_fate>(batch)));
                }
            }
        }
}

} // namespace

int main(int argc, char **argv)
{
    const oracle::run r(argc, argv, 8, 20260802);
    apertures();
    for (const char *type : all_sags) {
        generator g(r.seed + std::strlen(type) * 7919);
        for (long i = 0; i < r.count; i++) {
            extremes(g, type);
            beside_the_rim(g, type);
            if (i % 4 == 0) on_the_rim(g, type);
        }
    }
    for (const auto &f : failed) std::printf("  FAIL %8ld  %s\n", f.second, f.first.c_str());
    std::printf("%ld questions, %s\n", asked, failed.empty() ? "no failure" : "FAILED");
    return !failed.empty();
}
