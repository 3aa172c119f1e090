// SPDX-License-Identifier: MIT
// One shape, many types: what one says of a ray no other may contradict.
//
// A conic is also each departure type without a departure, a sum of nothing, a biconic of equal curvatures,
// with k = 0 a toroid and a q_bfs, and one sheet of a quadric; an even asphere is an odd one, a polynomial,
// a Chebyshev and a Zernike sum, a sum of itself; a cylinder, an ellipsoid and a plane have their twins.
// All numbers have so few bits that the twins are exactly the same surface, at any size from 2^-100 to
// 2^100.
//
// The first of a shape has the roots of the ray, all of them, and what it leaves undecided.  Of each other,
// for each proof: all roots, the first, the one near the seed.  A hit is a root of the first one, or in
// what that leaves undecided; nothing is a miss where that has a root, nor first where that has one before.
// Excused are roots within rounding of the ray's ends and of the rim, as either of the two types knows
// them.
#include "agree.h"
#include "judge.h"

using namespace catalogue;

namespace {

std::map<std::string, long> failed, counted;

struct twin {
    std::string name;
    sgt_surface s;
};

struct shape {
    specimen s;  // the first: what rays are aimed at, and h
    double rim;
    std::vector<twin> twins;
    double c, k; // of a sag with a quadric for a twin
};

// A number of 12 bits.
double few_bits(generator &g, double lo, double hi)
{
    const double x = g.uniform(lo, hi);
    int e;
    const double m = std::frexp(x, &e);
    return std::ldexp(std::nearbyint(m * 4096), e - 12);
}

shape conic_shape(generator &g)
{
    shape f = {};
    specimen &s = f.s;
    const int size = g.chance(0.5) ? 0 : g.below(201) - 100;
    const double unit = std::ldexp(1.0, size), k = g.chance(0.2)   ? 0
                                                   : g.chance(0.3) ? -1
                                                   : g.chance(0.3) ? few_bits(g, -40, -1)
                                                                   : few_bits(g, -3, 4);
    const double R = k < -1 && g.chance(0.5) ? g.log_uniform(1e-6, 1e-3)
                     : g.chance(0.4)         ? g.log_uniform(1e-5, 1e5)
                                             : g.log_uniform(0.3, 30);
    const double c = g.chance(0.1)
                         ? 0
                         : g.sign() * few_bits(g, 0.5, 1) * std::exp2(std::floor(std::log2(1 / R))) / unit;
    const double edge = (1 + k) * c * c > 0 ? 1 / (std::fabs(c) * std::sqrt(1 + k)) : HUGE_VAL,
                 h = few_bits(g, 0.5, 1) * std::min(edge, unit * 4);
    f.c = c, f.k = k;
    s.type = "conic", s.h = h, s.sag = true;
    f.rim = s.rim = g.chance(0.5) ? h : g.chance(0.1) ? 2 * h : 0;
    static const double wide[] = {0x1p500, 1e200, DBL_MAX};
    const double own = f.rim, rim = own == 0 && g.chance(0.3)
                                        ? wide[g.below(3)]
                                        : own; // a rim that is none, to all but the first
    if (rim != own) s.type = "conic, its rim none";
    s.s = {&sgt_odd_asphere_ops, s.keep(sgt_odd_asphere{c, k, rim, {}})};
    const sgt_numbers none = s.numbers(1, 1, {0.0});
    f.twins = {{"conic", {&sgt_conic_ops, s.keep(sgt_conic{c, k, own})}},
               {"even_asphere", {&sgt_even_asphere_ops, s.keep(sgt_even_asphere{c, k, rim, {}})}},
               {"odd_asphere", s.s},
               {"polynomial_xy", {&sgt_polynomial_xy_ops, s.keep(sgt_polynomial_xy{c, k, rim, none})}},
               {"chebyshev", {&sgt_chebyshev_ops, s.keep(sgt_chebyshev{c, k, rim, h, h, none})}},
               {"zernike", {&sgt_zernike_ops, s.keep(sgt_zernike{c, k, rim, h, SGT_NOLL, 0, none})}},
               {"q_con", {&sgt_q_con_ops, s.keep(sgt_q_con{c, k, rim, h, none})}},
               {"sum of nothing", {&sgt_sum_ops, s.keep(sgt_sum{c, k, rim, nullptr, 0})}},
               {"sum", {&sgt_sum_ops, s.keep(sgt_sum{c, k, rim, s.keep(s.s), 1})}},
               {"biconic", {&sgt_biconic_ops, s.keep(sgt_biconic{c, k, c, k, rim})}}};
    if (own > 0)
        f.twins.push_back(
            {"grid",
             {&sgt_grid_ops, s.keep(sgt_grid{c, k, own, own, own,
                                             s.numbers(4, 4, std::vector<double>(16, 0.0)), 0, 0, 0})}});
    if (k == 0) {
        f.twins.push_back({"toroidal", {&sgt_toroidal_ops, s.keep(sgt_toroidal{c, 0, c, rim, {}})}});
        f.twins.push_back({"q_bfs", {&sgt_q_bfs_ops, s.keep(sgt_q_bfs{c, rim, h, none})}});
    }
    f.twins.push_back(
        {"quadric",
         {&sgt_quadric_ops, s.keep(sgt_quadric{{c / 2, c / 2, (1 + k) * c / 2}, {0, 0, 0}, {0, 0, -1}, 0})}});
    return f;
}

shape asphere_shape(generator &g)
{
    shape f = {};
    specimen &s = f.s;
    const int size = g.chance(0.5) ? 0 : g.below(81) - 40;
    const double unit = std::ldexp(1.0, size), n = 2 * unit, h = few_bits(g, 0.5, 1) * n;
    const bool steep = g.chance(0.2); // nearly a cone
    const double c = steep           ? std::ldexp(g.sign(), g.below(20)) / n
                     : g.chance(0.3) ? 0
                                     : few_bits(g, -0.4, 0.4) / n,
                 k = steep           ? few_bits(g, -40, -2)
                     : g.chance(0.4) ? -1
                                     : few_bits(g, -3, 1);
    const double a = few_bits(g, -0.25, 0.25) / n,
                 b = g.chance(0.5) ? 0 : few_bits(g, -0.1, 0.1) / (n * n * n);
    s.type = "asphere", s.h = h, s.sag = true;
    f.rim = s.rim = g.chance(0.6) ? h : 0;
    const double rim = f.rim, a2 = a * n * n, b4 = b * n * n * n * n;
    const sgt_even_asphere even = {c, k, rim, {a, b}};
    const sgt_surface bare = {&sgt_even_asphere_ops, s.keep(sgt_even_asphere{0, 0, 0, {a, b}})},
                      first = {&sgt_even_asphere_ops, s.keep(sgt_even_asphere{0, 0, 0, {a, 0}})},
                      rest = {&sgt_even_asphere_ops, s.keep(sgt_even_asphere{0, 0, 0, {0, b}})};
    s.s = {&sgt_odd_asphere_ops, s.keep(sgt_odd_asphere{c, k, rim, {0, a, 0, b}})};
    // x^2 = (T2 + 1) / 2, x^4 = (T4 + 4 T2 + 3) / 8, of x / n
    std::vector<double> t(25, 0.0);
    t[0] = a2 + b4 * (0.375 + 0.375 + 0.5), t[2] = t[10] = a2 / 2 + b4 * (0.5 + 0.5), t[4] = t[20] = b4 / 8,
    t[12] = b4 / 2;
    f.twins = {
        {"even_asphere", {&sgt_even_asphere_ops, s.keep(even)}},
        {"odd_asphere", s.s},
        {"polynomial_xy",
         {&sgt_polynomial_xy_ops,
          s.keep(sgt_polynomial_xy{c, k, rim, s.numbers(5, 5, {0, 0, a, 0, b, 0, 0, 0, 0, 0, a, 0, 2 * b,
                                                               0, 0, 0, 0, 0, 0, 0, b, 0, 0, 0, 0})})}},
        {"chebyshev", {&sgt_chebyshev_ops, s.keep(sgt_chebyshev{c, k, rim, n, n, s.numbers(5, 5, t)})}},
        {"sum", {&sgt_sum_ops, s.keep(sgt_sum{c, k, rim, s.keep(bare), 1})}},
        {"sum of two",
         {&sgt_sum_ops,
          s.keep(sgt_sum{c, k, rim, s.keep(std::vector<sgt_surface>{first, rest})->data(), 2})}}};
    if (b == 0)
        f.twins.push_back({"zernike",
                           {&sgt_zernike_ops, s.keep(sgt_zernike{c, k, rim, n, SGT_NOLL, 0,
                                                                 s.numbers(1, 4, {a2 / 2, 0, 0, a2 / 2})})}});
    return f;
}

shape cylinder_shape(generator &g)
{
    shape f = conic_shape(g);
    specimen &s = f.s;
    s.type = "cylinder";
    const double c = f.c, k = f.k, rim = f.rim;
    s.s = {&sgt_biconic_ops, s.keep(sgt_biconic{0, 0, c, k, rim})};
    f.twins = {
        {"biconic", s.s},
        {"toroidal", {&sgt_toroidal_ops, s.keep(sgt_toroidal{c, k, 0, rim, {}})}},
        {"quadric",
         {&sgt_quadric_ops, s.keep(sgt_quadric{{0, c / 2, (1 + k) * c / 2}, {0, 0, 0}, {0, 0, -1}, 0})}}};
    return f;
}

shape ellipsoid_shape(generator &g)
{
    shape f = {};
    specimen &s = f.s;
    const double a = std::ldexp(1.0, g.chance(0.5) ? 0 : g.below(161) - 80), flat = few_bits(g, -1, 0.9),
                 b = a * (1 - flat);
    s.type = "ellipsoid", s.h = a;
    s.s = {&sgt_ellipsoid_ops, s.keep(sgt_ellipsoid{a, flat})};
    const double q = (b / a) * (b / a);
    f.twins = {{"ellipsoid", s.s},
               {"quadric", {&sgt_quadric_ops, s.keep(sgt_quadric{{q, q, 1}, {0, 0, 0}, {0, 0, 0}, -b * b})}},
               {"quadric, larger",
                {&sgt_quadric_ops,
                 s.keep(sgt_quadric{{-16 * q, -16 * q, -16}, {0, 0, 0}, {0, 0, 0}, 16 * (b * b)})}}};
    return f;
}

// ----------------------------------------------------------------------- rays

sgt_ray hostile_ray(generator &g, const subject &of, const shape &f)
{
    sgt_ray r = random_ray(g, of, static_cast<ray_kind>(g.below(ray_kinds)));
    const double h = f.s.h;
    switch (g.below(10)) {
    case 0: r.d.z = std::hypot(r.d.x, r.d.y) * g.sign() * g.log_uniform(1e-14, 0.1); break;
    case 1: // far
        for (double *x : {&r.o.x, &r.o.y, &r.o.z}) *x *= g.chance(0.5) ? 1e3 : 1e6;
        break;
    case 2: // through a point beside the rim or the equator
    case 3:
        if (f.s.sag) {
            const double about = g.uniform(0, 6.283185307179586),
                         q = h * (1 + (g.chance(0.2) ? 0 : g.sign() * g.log_uniform(1e-16, 1e-2))),
                         x = q * std::cos(about), y = q * std::sin(about), z = -of.rough(x, y, 0.0),
                         away = h * g.uniform(0.1, 4);
            const sgt_vec3 d = random_direction(g);
            if (z == z) r = {{x - away * d.x, y - away * d.y, z - away * d.z}, d, 0, HUGE_VAL};
        }
        break;
    case 4: // low: a hyperboloid is met twice
        if (f.s.sag) r.d.z = std::hypot(r.d.x, r.d.y) * g.uniform(-0.2, 0.2);
        break;
    default: break;
    }
    if (g.chance(0.3)) r.tmin = -HUGE_VAL, r.tmax = HUGE_VAL;
    else if (g.chance(0.2)) {
        const sgt_hit at = sgt_intersect(f.twins[0].s, r, nullptr);
        if (at.status > 0)
            (g.chance(0.5) ? r.tmin : r.tmax) =
                g.chance(0.5) ? at.t : std::nextafter(at.t, g.chance(0.5) ? -HUGE_VAL : HUGE_VAL);
        if (r.tmin == 0 && r.tmax == 0) r.tmax = HUGE_VAL;
    }
    return r;
}

// ----------------------------------------------------------------- agreement

struct question {
    const shape *f;
    sgt_ray ray;
};

// Within rounding of the rim or of an end of the ray: it may count to one type, and not to another.
bool excused(const question &q, const sgt_hit &h)
{
    const double r2 = h.p.x * h.p.x + h.p.y * h.p.y, rim2 = q.f->rim * q.f->rim;
    if (q.f->rim > 0 && std::fabs(r2 - rim2) <= 0x1p-42 * rim2 + 8 * std::sqrt(r2) * h.p_err) return true;
    const sgt_vec3 &d = q.ray.d;
    const double slope = std::fabs(h.n.x * d.x + h.n.y * d.y + h.n.z * d.z),
                 terms = std::fabs(h.p.x * h.n.x) + std::fabs(h.p.y * h.n.y) + std::fabs(h.p.z * h.n.z);
    const double width = 4 * h.t_err + 0x1p-46 * (slope > 0 ? terms / slope : 0) + 0x1p-47 * std::fabs(h.t);
    return h.t <= q.ray.tmin + width || h.t >= q.ray.tmax - width;
}

std::vector<sgt_hit> all_of(const sgt_surface &s, const sgt_ray &r, const sgt_options &o)
{
    std::vector<sgt_hit> list(16);
    list.resize(
        static_cast<std::size_t>(std::max(0, std::min(16, sgt_intersect_all(s, r, 16, list.data(), &o)))));
    return list;
}

// The rule of the start has t_err in it, and one type may know the same root less well than another: so it
// is asked of the root as either of the two tells it; the other's is that on the whole line.
bool excused_by(const question &q, const sgt_hit &h, const sgt_surface &other)
{
    if (excused(q, h)) return true;
    sgt_ray line = q.ray;
    line.tmin = -HUGE_VAL, line.tmax = HUGE_VAL;
    for (const sgt_hit &e : all_of(other, line, {}))
        if (e.status == SGT_HIT && one_root(e, h) && excused(q, e)) return true;
    return false;
}

bool inside(double t, double t_err, const sgt_hit &stretch)
{
    const double room = t_err + 0x1p-51 * std::fabs(t);
    return t + room >= stretch.lo && t - room <= stretch.hi;
}

bool has(const std::vector<sgt_hit> &list, const sgt_hit &h)
{
    for (const sgt_hit &e : list)
        if (e.status == SGT_HIT ? one_root(e, h) : inside(h.t, h.t_err, e)) return true;
    return false;
}

void print_hit(const char *name, const sgt_hit &h)
{
    std::printf("    %-6s %s evals %d t %.17g t_err %g [%.17g, %.17g] p %.17g %.17g %.17g\n", name,
                sgt_status_text(h.status), h.evals, h.t, h.t_err, h.lo, h.hi, h.p.x, h.p.y, h.p.z);
}

void fail(const question &q, const twin &t, const std::string &why, const std::vector<sgt_hit> &truth,
          const std::vector<sgt_hit> &said)
{
    if (failed[q.f->s.type + " as " + t.name + ": " + why]++) return;
    std::printf("FAIL %s as %s: %s\n", q.f->s.type.c_str(), t.name.c_str(), why.c_str());
    print_surface(q.f->s.s);
    print_surface(t.s);
    const sgt_ray &r = q.ray;
    std::printf("    ray {{%a, %a, %a}, {%a, %a, %a}, %a, %a}\n", r.o.x, r.o.y, r.o.z, r.d.x, r.d.y, r.d.z,
                r.tmin, r.tmax);
    for (const sgt_hit &h : truth) print_hit("first", h);
    for (const sgt_hit &h : said) print_hit("this", h);
}

// A root of the quadric on the sheet of the sag, inside its rim, by a margin; -1: by a margin not; 0: it
// may be.
int on_sheet(const question &q, const sgt_hit &h)
{
    const double v = 1 - (1 + q.f->k) * q.f->c * h.p.z, r2 = h.p.x * h.p.x + h.p.y * h.p.y,
                 rim2 = q.f->rim * q.f->rim;
    const double size = std::fabs((1 + q.f->k) * q.f->c) * (std::fabs(h.p.z) + h.p_err * 0x1p40) + 1;
    if (std::fabs(v) <= 0x1p-40 * size) return 0;
    if (v < 0 || (q.f->rim > 0 && r2 > rim2 * (1 + 0x1p-30))) return -1;
    return q.f->rim > 0 && r2 > rim2 * (1 - 0x1p-30) ? 0 : 1;
}

// A graze is within rounding: F there, in 113 bits, is.
void check_graze(const question &q, const twin &t, const subject &of, const std::vector<sgt_hit> &truth,
                 const sgt_hit &h)
{
    counted["grazes"]++;
    const quad f = judgement(of, q.ray, 4).at(h.t);
    const double own = t.s.ops->rounding ? t.s.ops->rounding(t.s.self, h.p) : 0,
                 terms = std::fabs(h.p.x * h.n.x) + std::fabs(h.p.y * h.n.y) + std::fabs(h.p.z * h.n.z);
    if (t.s.ops == &sgt_quadric_ops) return; // its F is not the first one's
    if (f == f && terms == terms && oracle::magnitude(f) > quad(64 * own + 0x1p-44 * terms))
        fail(q, t, "a graze beside the surface", truth, {h});
}

void ask(generator &g, const shape &f, const subject &of, const sgt_ray &ray)
{
    const question q = {&f, ray};
    const sgt_surface &first = f.twins[0].s;
    const std::vector<sgt_hit> truth = all_of(first, ray, {});
    if (truth.size() >= 16) return;
    for (const twin &t : f.twins) {
        const bool sheets = t.s.ops == &sgt_quadric_ops && f.s.sag;
        sgt_options o = {};
        o.proof = static_cast<sgt_proof>(g.below(3));
        const std::vector<sgt_hit> list = all_of(t.s, ray, o);
        counted["lists"]++;
        for (const sgt_hit &h : list) {
            counted[h.status < 0 ? "undecided entries" : "entries"]++;
            if (h.status == SGT_GRAZE) check_graze(q, t, of, truth, h);
            if (h.status == SGT_HIT && (!sheets || on_sheet(q, h) > 0) && !has(truth, h) &&
                !excused_by(q, h, first))
                fail(q, t, "a root too many", truth, list);
        }
        for (const sgt_hit &h : truth)
            if (h.status == SGT_HIT && !has(list, h) && !excused_by(q, h, t.s))
                fail(q, t, "a root is missing", truth, list);
        for (const sgt_pick pick : {SGT_FIRST, SGT_NEAR_SEED}) {
            o.pick = pick, o.proof = static_cast<sgt_proof>(g.below(3));
            const sgt_hit hit = sgt_intersect(t.s, ray, &o);
            counted["single"]++;
            if (hit.status < 0) {
                counted["undecided"]++;
                continue;
            }
            if (hit.status == SGT_GRAZE) check_graze(q, t, of, truth, hit);
            if (hit.status == SGT_HIT && (!sheets || on_sheet(q, hit) > 0) && !has(truth, hit) &&
                !excused_by(q, hit, first))
                fail(q, t, "a hit that is no root", truth, {hit});
            for (const sgt_hit &h : truth) {
                if (h.status != SGT_HIT) continue;
                const bool before = pick == SGT_FIRST && h.t + h.t_err < hit.lo && !one_root(h, hit);
                if ((hit.status != SGT_MISS && !before) || excused_by(q, h, t.s)) continue;
                fail(q, t,
                     hit.status == SGT_MISS ? "a miss where there is a root" : "a root before the first",
                     truth, {hit});
            }
        }
    }
}

} // namespace

int main(int argc, char **argv)
{
    const oracle::run r(argc, argv, 50, 20260803);
    shape (*const kinds[])(generator &) = {conic_shape, asphere_shape, cylinder_shape, ellipsoid_shape};
    for (std::size_t kind = 0; kind < 4; kind++) {
        generator g(r.seed + kind * 104729);
        for (long i = 0; i < r.count * (kind == 0 ? 2 : 1); i++) {
            const shape f = kinds[kind](g);
            const subject of(f.s);
            for (int j = 0; j < 8; j++) {
                const sgt_ray ray = hostile_ray(g, of, f);
                if (std::isfinite(ray.o.x + ray.o.y + ray.o.z + ray.d.x + ray.d.y + ray.d.z) &&
                    !(ray.tmin > ray.tmax))
                    ask(g, f, of, ray);
            }
        }
    }
    for (const auto &c : counted) std::printf("  %9ld %s\n", c.second, c.first.c_str());
    for (const auto &f : failed) std::printf("  FAIL %8ld  %s\n", f.second, f.first.c_str());
    return !failed.empty();
}
