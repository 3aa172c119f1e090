// SPDX-License-Identifier: MIT
// Conics, and even aspheres that are conics, where they are hardest to tell, against quad.h: on the
// equator, where the sheet of the sag ends, and 1 ... 20 ulps beside; and rays that nearly touch, from
// afar, which the careful path answers.
//
//   the equator   a root on the sheet is found by every pick and proof, one behind it never is told; also
//                 where
//                 it is beside the equator by some parts in 2^106, which twice the precision cannot tell;
//   the careful   |t + t_lo - root| <= t_err / 100, as long as t_err is mostly what one double cannot hold
//                 of t.
#include "cases.h"
#include "quad.h"

#include <map>

using namespace oracle;

namespace {

std::map<std::string, long> failed;
std::string name;

void fail(const char *why, const sgt_conic &s, const sgt_ray &r, const answer &a, const sgt_hit &h, int pick,
          int proof)
{
    if (failed[name + ": " + why]++ >= 2) return;
    std::printf("FAIL %s: %s, pick %d, proof %d: %s t %.17g + %.3g t_err %.3g [%.17g, %.17g]\n    c, k, rim "
                "%a %a %a\n    ray {{%a, %a, %a}, {%a, %a, %a}, %a, %a}\n",
                name.c_str(), why, pick, proof, sgt_status_text(h.status), h.t, h.t_lo, h.t_err, h.lo, h.hi,
                s.c, s.k, s.semi_diameter, r.o.x, r.o.y, r.o.z, r.d.x, r.d.y, r.d.z, r.tmin, r.tmax);
    for (const meeting &m : a.roots)
        std::printf("    root %s%s\n", text(m.t()).c_str(), m.edge ? " (edge)" : "");
}

bool is_of(const meeting &m, const sgt_hit &h)
{
    return magnitude(m.minus(h.t)) <= quad(h.t_err) * (1 + quad(1e-9)) + m.blur;
}

void judge(const sgt_conic &s, const sgt_ray &ray, const answer &a, const sgt_hit &h, int pick, int proof)
{
    if (h.status == SGT_INVALID || h.status == SGT_STOPPED)
        return fail("no such status", s, ray, a, h, pick, proof);
    if (!a.doubtful.empty() || a.everywhere) return;
    bool there = h.status != SGT_HIT;
    for (const meeting &m : a.roots) {
        const counts k = counting(m, ray.tmin, ray.tmax);
        there = there || (is_of(m, h) && k != no);
        if (k != yes) continue;
        if (h.status == SGT_MISS) return fail("a miss that meets", s, ray, a, h, pick, proof);
        if (pick == SGT_FIRST && h.status > 0 && m.minus(h.t) < -quad(h.t_err) - m.blur)
            return fail("not the first", s, ray, a, h, pick, proof);
        if (pick == SGT_NEAR_SEED && proof == SGT_PROVE_FIRST && h.status == SGT_HIT && !is_of(m, h))
            return fail("the only one, and another", s, ray, a, h, pick, proof);
    }
    if (!there) fail("a hit without a root that counts", s, ray, a, h, pick, proof);
}

double beside(double x, int n)
{
    for (; n > 0; n--) x = std::nextafter(x, HUGE_VAL);
    for (; n < 0; n++) x = std::nextafter(x, -HUGE_VAL);
    return x;
}

int steps(generator &g) { return g.chance(0.2) ? 0 : static_cast<int>(g.sign()) * (1 + g.below(20)); }

// aspheric: the same as an even asphere, its only term so small that it is nothing.
void ask(const sgt_conic &s, const sgt_ray &ray, const answer &a, bool aspheric, long *undecided, long *all)
{
    const sgt_even_asphere even = {s.c, s.k, s.semi_diameter, {1e-300}};
    const sgt_surface surface = aspheric ? sgt_surface{&sgt_even_asphere_ops, &even}
                                         : sgt_surface{&sgt_conic_ops, &s};
    name = surface.ops->name;
    for (int proof = 0; proof < 3; proof++)
        for (int pick = SGT_FIRST; pick <= SGT_NEAR_SEED; pick++) {
            sgt_options o = {};
            o.pick = static_cast<sgt_pick>(pick), o.proof = static_cast<sgt_proof>(proof);
            const sgt_hit h = sgt_intersect(surface, ray, &o);
            judge(s, ray, a, h, pick, proof);
            ++*all, *undecided += h.status < 0;
        }
    sgt_hit hit[4];
    const int n = sgt_intersect_all(surface, ray, 4, hit, nullptr);
    if (!a.doubtful.empty() || a.everywhere) return;
    for (const meeting &m : a.roots) {
        bool in = counting(m, ray.tmin, ray.tmax) != yes;
        for (int i = 0; i < n; i++)
            in = in || is_of(m, hit[i]) ||
                 (hit[i].status != SGT_HIT && m.t() >= hit[i].lo && m.t() <= hit[i].hi);
        if (!in) fail("all: a root in no entry", s, ray, a, hit[0], 0, 0);
    }
}

double random_k(generator &g)
{
    return g.chance(0.3) ? 0 : g.chance(0.5) ? g.uniform(-0.99, 2) : g.log_uniform(1e-3, 1e2);
}

void at_equator(generator &g, long *undecided, long *all)
{
    const double R = g.log_uniform(1e-2, 1e3);
    sgt_conic s = {g.sign() / R, random_k(g), 0};
    const double e = 1 + s.k, r = beside(1 / (std::fabs(s.c) * std::sqrt(e)), steps(g)),
                 z = beside(1 / (s.c * e), steps(g)), about = g.uniform(0, 6.283185307179586);
    const bool axis = g.chance(0.4);
    const double p[3] = {axis ? r : r * std::cos(about), axis ? 0 : r * std::sin(about), z};
    double d[3];
    const double tilt = g.chance(0.3) ? 0 : g.log_uniform(1e-9, 1), turn = g.uniform(0, 6.283185307179586);
    if (g.chance(0.5))
        d[0] = std::cos(turn), d[1] = std::sin(turn),
        d[2] = g.sign() * tilt; // nearly in the plane of the equator
    else d[0] = g.uniform(-1, 1), d[1] = g.uniform(-1, 1), d[2] = g.uniform(-1, 1);
    double away = R * (g.chance(0.1) ? 0 : g.log_uniform(1e-3, 1e2)) * g.sign();
    if (axis && g.chance(0.5)) {
        // nearly tangent there: the two roots are as near the equator as each other, and their errors great
        d[0] = g.sign() * g.below(1 << (4 + g.below(8))) * 0x1p-54, d[1] = g.uniform(-1, 1),
        d[2] = g.uniform(-1, 1);
        away = g.chance(0.5) ? 0 : g.sign() * std::ldexp(R, -g.below(20));
    }
    if (g.chance(0.3)) s.semi_diameter = r * (g.chance(0.5) ? 1 : 2);
    sgt_ray ray = {{p[0] - away * d[0], p[1] - away * d[1], p[2] - away * d[2]},
                   {d[0], d[1], d[2]},
                   -HUGE_VAL,
                   HUGE_VAL};
    if (g.chance(0.5)) ray.tmin = 0;
    const answer a = conic_roots(surface(s), ray);
    ask(s, ray, a, false, undecided, all);
    ask(s, ray, a, true, undecided, all);
}

// Nearly in the plane of the equator, aimed so that the root is some 2^-106 of the radius to one side of it.
void at_equator_itself(generator &g, long *sides, long *undecided, long *all)
{
    const double R = g.log_uniform(1e-2, 1e3);
    const sgt_conic s = {g.sign() / R, random_k(g), 0};
    const quad e = 1 + quad(s.k), height = 1 / (e * s.c), r = 1 / (square_root(e) * magnitude(quad(s.c)));
    const double about = g.uniform(0, 6.283185307179586), turn = about + g.sign() * g.uniform(0, 1.2);
    const double away = to_double(r) * g.uniform(0.1, 10);
    sgt_vec3 d = {std::cos(turn), std::sin(turn), 0};
    const double z = beside(to_double(height), static_cast<int>(g.sign()) * (1 + g.below(4)));
    const sgt_vec3 p = {to_double(r) * std::cos(about), to_double(r) * std::sin(about), z};
    const sgt_vec3 o = {p.x - away * d.x, p.y - away * d.y, z};
    const quad a = quad(d.x) * d.x + quad(d.y) * d.y, b = quad(o.x) * d.x + quad(o.y) * d.y;
    const quad D = b * b - a * (quad(o.x) * o.x + quad(o.y) * o.y - r * r);
    if (!(D > 0)) return;
    const quad t[2] = {(-b - square_root(D)) / a, (-b + square_root(D)) / a};
    d.z = beside(to_double((height - z) / t[g.below(2)]), static_cast<int>(g.sign()) * g.below(8));
    const sgt_ray ray = {o, d, -HUGE_VAL, HUGE_VAL};
    answer known = conic_roots(surface(s), ray);
    std::vector<meeting> roots;
    for (meeting m : known.roots) { // its z is right to some 2^-112
        const quad side = 1 - e * s.c * m.p.z, margin = quad(0x1p-110) + magnitude(e * s.c * d.z) * m.blur;
        if (magnitude(side) < quad(0x1p-102)) ++*sides;
        if (side < -margin) continue;
        m.edge = side < margin;
        roots.push_back(m);
    }
    known.roots = roots;
    ask(s, ray, known, false, undecided, all);
    ask(s, ray, known, true, undecided, all);
}

// The greatest of |t + t_lo - root| / t_err.
void nearly_touching(generator &g, double *worst, long *asked, long *undecided, long *all)
{
    const double R = g.log_uniform(1e-2, 1e3);
    const sgt_conic s = {g.sign() / R, g.uniform(-3, 2), 0};
    const double u = 1 / (1 + std::fabs(s.k)), r = R * g.uniform(0.02, 0.6) * std::sqrt(u),
                 about = g.uniform(0, 6.283185307179586), x = r * std::cos(about), y = r * std::sin(about);
    const double phi = std::sqrt(1 - (1 + s.k) * s.c * s.c * r * r), z = s.c * r * r / (1 + phi),
                 slope = s.c / phi;
    const double turn = g.uniform(0, 6.283185307179586), l = std::cos(turn), m = std::sin(turn),
                 lift = g.sign() * g.log_uniform(1e-7, 1e-4);
    const sgt_vec3 d = {l, m, slope * (x * l + y * m) + lift};
    const double away = R * g.log_uniform(1, 1e7) * g.sign();
    const sgt_ray ray = {{x - away * d.x, y - away * d.y, z - away * d.z}, d, -HUGE_VAL, HUGE_VAL};
    const answer a = conic_roots(surface(s), ray);
    ask(s, ray, a, false, undecided, all);
    sgt_hit hit[4];
    const int n = sgt_intersect_all({&sgt_conic_ops, &s}, ray, 4, hit, nullptr);
    for (int i = 0; i < n; i++) {
        const sgt_hit &h = hit[i];
        if (h.status != SGT_HIT || !(h.t_err >= 0.25 * ulp(h.t) && h.t_err <= 0.51 * ulp(h.t))) continue;
        for (const meeting &root : a.roots) {
            const quad off = magnitude(root.minus(h.t));
            if (!(off <= 2 * quad(h.t_err)) || root.blur > quad(1e-3) * h.t_err) continue;
            ++*asked;
            const double ratio = to_double(magnitude(root.minus(h.t) - h.t_lo) / h.t_err);
            *worst = std::fmax(*worst, ratio);
            if (!(ratio <= 0.01))
                fail("t + t_lo is not the root to a hundredth of t_err", s, ray, a, h, 0, 0);
        }
    }
}

} // namespace

int main(int argc, char **argv)
{
    const run r(argc, argv, 20000, 20241119);
    generator g(r.seed);
    long undecided = 0, all = 0, asked = 0, sides = 0;
    double worst = 0;
    for (long i = 0; i < r.count; i++) at_equator(g, &undecided, &all);
    std::printf("the equator: %ld answers, %ld undecided\n", all, undecided);
    undecided = all = 0;
    for (long i = 0; i < r.count / 2; i++) at_equator_itself(g, &sides, &undecided, &all);
    std::printf("the equator itself: %ld answers, %ld undecided; %ld roots within 2^-102\n", all, undecided,
                sides);
    if (sides < r.count / 8) failed["these rays are not at the equator"]++;
    undecided = all = 0;
    for (long i = 0; i < r.count; i++) nearly_touching(g, &worst, &asked, &undecided, &all);
    std::printf("nearly touching: %ld answers, %ld undecided; %ld roots of which t_err is a half ulp, t + "
                "t_lo off by %.2g of it at most\n",
                all, undecided, asked, worst);
    if (asked < r.count / 20) failed["these rays are no test"]++;
    for (const auto &f : failed) std::printf("FAIL %6ld  %s\n", f.second, f.first.c_str());
    return !failed.empty();
}
