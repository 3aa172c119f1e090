// SPDX-License-Identifier: MIT
// The surfaces of the catalogue that have a closed form, written as formulas: the same rays meet both at the
// same places, within both t_err.
//
//     test_catalogue [--count N] [--seed S] [--only TYPE]
//
// Each row has the built-in surface and its text.  Parameters are random, and so is the unit.  A sag is asked
// for its first root, without proof and with, and for the one near the seed; a body for its first.  Each has
// to say the same of each ray, but where the root is within rounding of the rim, of the domain's end or of
// the ray's start.  Undecided may be a hundredth of the rays, and rays through the vertex only where the
// formula has no second derivative there.
//
// Sources of the polynomials: Wyant and Creath 1992 (Zernike, fringe), Forbes 2007 (Q), as in surfaces.h.
#include "../oracle/cases.h"

#include <sagitta/formula.h>
#include <sagitta/surfaces.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <map>
#include <memory>
#include <string>
#include <vector>

using oracle::generator;

namespace
{

// The surface, its text, and what the text names, in the same numbers.
struct pair_of {
    sgt_surface built_in;
    std::string text;
    std::vector<sgt_named> named;
    double h;      // the aperture, or the size of the body
    bool sag, tip; // tip: not smooth at the vertex
    std::vector<std::shared_ptr<void>> kept;

    template <class S> S *keep(const S &s)
    {
        std::shared_ptr<S> p = std::make_shared<S>(s);
        kept.push_back(p);
        return p.get();
    }
    // Of a list: the parameters p0, p1 ...
    void name_all(const std::vector<double> &x)
    {
        static const char *const names[] = {"p0", "p1", "p2", "p3", "p4", "p5", "p6", "p7", "p8", "p9"};
        for (std::size_t i = 0; i < x.size(); i++) named.push_back({names[i], x[i]});
    }
};

const char base[] = "c*r^2/(1+sqrt(1-(1+k)*c^2*r^2))";

struct part {
    generator &g;
    double h, c, k; // |c| h < 0.8
    part(generator &from)
        : g(from), h(g.log_uniform(1e-2, 1e2)), c(g.sign() * g.log_uniform(0.01, 0.8) / h),
          k(g.chance(0.3) ? -1 : g.uniform(-2, 0.5))
    {
    }
    double term(int power) { return g.uniform(-0.03, 0.03) * std::pow(h, 1 - power); }
    std::vector<double> terms(std::size_t n, double unit)
    {
        std::vector<double> a(n);
        for (double &x : a) x = g.uniform(-0.02, 0.02) * unit;
        return a;
    }
};

pair_of on_base(part &p, const std::string &more)
{
    pair_of r = {};
    r.sag = true, r.h = p.h;
    r.text = std::string(base) + more;
    r.named = {{"c", p.c}, {"k", p.k}};
    return r;
}

pair_of plane(part &p)
{
    pair_of r = {};
    r.sag = true, r.h = p.h, r.text = "0";
    r.built_in = {&sgt_conic_ops, r.keep(sgt_conic{0, 0, p.h})};
    return r;
}
pair_of sphere(part &p)
{
    pair_of r = {};
    r.sag = true, r.h = p.h, r.text = "c*r^2/(1 + sqrt(1 - (c*r)^2))", r.named = {{"c", p.c}};
    r.built_in = {&sgt_conic_ops, r.keep(sgt_conic{p.c, 0, p.h})};
    return r;
}
pair_of conic(part &p)
{
    pair_of r = on_base(p, "");
    r.built_in = {&sgt_conic_ops, r.keep(sgt_conic{p.c, p.k, p.h})};
    return r;
}
pair_of even_asphere(part &p)
{
    pair_of r = on_base(p, " + p0*r^4 + p1*r^6 + p2*(x^2+y^2)^4");
    const std::vector<double> a = {p.term(4), p.term(6), p.term(8)};
    r.name_all(a);
    r.built_in = {&sgt_even_asphere_ops, r.keep(sgt_even_asphere{p.c, p.k, p.h, {0, a[0], a[1], a[2]}})};
    return r;
}
pair_of odd_asphere(part &p)
{
    pair_of r = on_base(p, " + p0*r^3 + p1*r^4 + p2*r^5");
    const std::vector<double> a = {p.term(3), p.term(4), p.term(5)};
    r.name_all(a);
    r.tip = true;
    r.built_in = {&sgt_odd_asphere_ops, r.keep(sgt_odd_asphere{p.c, p.k, p.h, {0, 0, a[0], a[1], a[2]}})};
    return r;
}
pair_of polynomial_xy(part &p)
{
    pair_of r = on_base(p, " + p0*y + p1*x + p2*x*y + x^2*(p3 + p4*y^2)");
    const std::vector<double> a = {p.term(1), p.term(1), p.term(2), p.term(2), p.term(4)};
    r.name_all(a);
    const double *x = r.keep(std::vector<double>{0, a[0], 0, a[1], a[2], 0, a[3], 0, a[4]})->data();
    r.built_in = {&sgt_polynomial_xy_ops, r.keep(sgt_polynomial_xy{p.c, p.k, p.h, {x, 3, 3}})};
    return r;
}
pair_of biconic(part &p)
{
    pair_of r = {};
    const sgt_biconic b = {p.c, p.k, p.g.uniform(-0.5, 0.5) / p.h, p.g.uniform(-2, 0.5), p.h};
    r.sag = true, r.h = p.h;
    r.text = "(cx*x^2 + cy*y^2)/(1 + sqrt(1 - (1+kx)*cx^2*x^2 - (1+ky)*cy^2*y^2))";
    r.named = {{"cx", b.c_x}, {"kx", b.k_x}, {"cy", b.c_y}, {"ky", b.k_y}};
    r.built_in = {&sgt_biconic_ops, r.keep(b)};
    return r;
}
pair_of cylinder(part &p)
{
    pair_of r = {};
    r.sag = true, r.h = p.h, r.text = "c*y^2/(1 + sqrt(1 - (1+k)*c^2*y^2))",
    r.named = {{"c", p.c}, {"k", p.k}};
    r.built_in = {&sgt_biconic_ops, r.keep(sgt_biconic{0, 0, p.c, p.k, p.h})};
    return r;
}
pair_of toroidal(part &p)
{
    pair_of r = {};
    sgt_toroidal t = {};
    t.c = p.c, t.k = p.k, t.c_x = p.g.uniform(-0.5, 0.5) / p.h, t.semi_diameter = p.h,
    t.a[1] = p.term(4) * 0.3;
    r.sag = true, r.h = p.h;
    const std::string profile = "(c*y^2/(1+sqrt(1-(1+k)*c^2*y^2)) + a*y^4)", q = "(1 - cx*" + profile + ")";
    r.text = profile + " + cx*x^2/(" + q + " + sqrt(" + q + "^2 - cx^2*x^2))";
    r.named = {{"c", t.c}, {"k", t.k}, {"cx", t.c_x}, {"a", t.a[1]}};
    r.built_in = {&sgt_toroidal_ops, r.keep(t)};
    return r;
}
pair_of zernike(part &p)
{
    const bool turned = p.g.chance(0.5);
    pair_of r =
        on_base(p, turned ? " + p0 + p1*r*cos(atan2(y,x))/n + p2*y/n + p3*(2*r^2/n^2 - 1)"
                            " + p4*(r/n)^2*cos(2*atan2(y, x)) + p5*(r/n)^2*sin(2*atan2(y, x))"
                            " + p6*(3*(r/n)^2 - 2)*x/n + p7*(3*(r/n)^2 - 2)*y/n"
                            " + p8*(6*(r/n)^4 - 6*(r/n)^2 + 1)"
                          : " + p0 + (p1*x + p2*y)/n + p3*(2*(x^2 + y^2)/n^2 - 1) + p4*(x^2 - y^2)/n^2"
                            " + 2*p5*x*y/n^2 + (3*(x^2 + y^2)/n^2 - 2)*(p6*x + p7*y)/n"
                            " + p8*(6*(x^2 + y^2)^2/n^4 - 6*(x^2 + y^2)/n^2 + 1)");
    const std::vector<double> a = p.terms(9, p.h);
    r.name_all(a);
    r.named.push_back({"n", 1.25 * p.h});
    r.built_in = {&sgt_zernike_ops,
                  r.keep(sgt_zernike{p.c, p.k, p.h, 1.25 * p.h, SGT_FRINGE, 0, {r.keep(a)->data(), 1, 9}})};
    return r;
}
pair_of chebyshev(part &p)
{
    const std::string t[3] = {"1", "(x/n)", "(2*(x/n)^2 - 1)"}, u[3] = {"1", "(y/m)", "(2*(y/m)^2 - 1)"};
    std::string sum;
    for (int i = 0; i < 9; i++) sum += " + p" + std::to_string(i) + "*" + t[i / 3] + "*" + u[i % 3];
    pair_of r = on_base(p, sum);
    const std::vector<double> a = p.terms(9, p.h);
    r.name_all(a);
    r.named.push_back({"n", 1.5 * p.h});
    r.named.push_back({"m", 1.125 * p.h});
    r.built_in = {&sgt_chebyshev_ops,
                  r.keep(sgt_chebyshev{p.c, p.k, p.h, 1.5 * p.h, 1.125 * p.h, {r.keep(a)->data(), 3, 3}})};
    return r;
}
pair_of q_con(part &p)
{
    pair_of r = on_base(p, " + (r/n)^4*(p0 + p1*(6*r^2/n^2 - 5) + p2*(28*(r/n)^4 - 42*(r/n)^2 + 15)"
                           " + p3*(120*(r/n)^6 - 252*(r/n)^4 + 168*(r/n)^2 - 35))");
    std::vector<double> a = p.terms(4, p.h);
    a[3] *= 0.1;
    r.name_all(a);
    r.named.push_back({"n", 1.25 * p.h});
    r.built_in = {&sgt_q_con_ops, r.keep(sgt_q_con{p.c, p.k, p.h, 1.25 * p.h, {r.keep(a)->data(), 1, 4}})};
    return r;
}
pair_of q_bfs(part &p)
{
    p.k = 0;
    pair_of r = on_base(p, " + (r/n)^2*(1 - (r/n)^2)/sqrt(1 - c^2*r^2)*(p0 + p1*(13 - 16*(r/n)^2)/sqrt(19)"
                           " + p2*sqrt(2/95)*(29 - 4*(r/n)^2*(25 - 19*(r/n)^2))"
                           " + p3*sqrt(2/2545)*(207 - 4*(r/n)^2*(315 - (r/n)^2*(577 - 320*(r/n)^2))))");
    const std::vector<double> a = p.terms(4, p.h);
    r.name_all(a);
    r.named.push_back({"n", 1.25 * p.h});
    r.built_in = {&sgt_q_bfs_ops, r.keep(sgt_q_bfs{p.c, p.h, 1.25 * p.h, {r.keep(a)->data(), 1, 4}})};
    return r;
}
pair_of quadric(part &p)
{
    pair_of r = {};
    sgt_quadric q = {};
    std::vector<double> a;
    for (double &x : q.squares) a.push_back(x = p.g.uniform(-1, 1) + (p.g.chance(0.5) ? 1 : 0));
    for (double &x : q.products) a.push_back(x = p.g.uniform(-0.5, 0.5));
    for (double &x : q.linear) a.push_back(x = p.g.uniform(-0.5, 0.5) * p.h);
    a.push_back(q.constant = -0.5 * p.h * p.h);
    r.h = p.h;
    r.text = "p0*x^2 + p1*y^2 + p2*z^2 + p3*x*y + p4*y*z + p5*x*z + p6*x + p7*y + p8*z = -p9";
    r.name_all(a);
    r.built_in = {&sgt_quadric_ops, r.keep(q)};
    return r;
}
pair_of torus(part &p)
{
    pair_of r = {};
    const sgt_torus t = {0.6 * p.h, p.h * p.g.uniform(0.02, p.g.chance(0.7) ? 0.35 : 0.9)};
    r.h = 2 * p.h;
    r.text =
        p.g.chance(0.5) ? "(x^2+y^2+z^2+R^2-s^2)^2 = 4*R^2*(x^2+y^2)" : "(r^2+z^2+R^2-s^2)^2 - (2*R*r)^2";
    if (t.minor < t.major && p.g.chance(0.5)) r.text = "(r - R)^2 + z^2 = s^2";
    r.named = {{"R", t.major}, {"s", t.minor}};
    r.built_in = {&sgt_torus_ops, r.keep(t)};
    return r;
}
pair_of ellipsoid(part &p)
{
    pair_of r = {};
    const sgt_ellipsoid e = {p.h, p.g.uniform(-0.5, 0.7)};
    r.h = 1.8 * p.h;
    r.text = "(x^2 + y^2)/a^2 + (z/(a*(1 - f)))^2 = 1";
    r.named = {{"a", e.a}, {"f", e.f}};
    r.built_in = {&sgt_ellipsoid_ops, r.keep(e)};
    return r;
}

struct row {
    const char *type;
    pair_of (*make)(part &);
};
const row rows[] = {{"plane", plane},
                    {"sphere", sphere},
                    {"conic", conic},
                    {"even_asphere", even_asphere},
                    {"odd_asphere", odd_asphere},
                    {"polynomial_xy", polynomial_xy},
                    {"biconic", biconic},
                    {"cylinder", cylinder},
                    {"toroidal", toroidal},
                    {"zernike", zernike},
                    {"chebyshev", chebyshev},
                    {"q_con", q_con},
                    {"q_bfs", q_bfs},
                    {"quadric", quadric},
                    {"torus", torus},
                    {"ellipsoid", ellipsoid}};

long failures, examples = 2;
std::map<std::string, long> faults;

struct tally {
    long rays = 0, hits = 0, misses = 0, undecided = 0, built_in_undecided = 0, excused = 0;
    double worst = 0;
};

void fail(const char *type, const std::string &what, const pair_of &p, const sgt_ray &ray, const sgt_hit &a,
          const sgt_hit &b)
{
    failures++;
    if (faults[std::string(type) + ": " + what]++ >= examples) return;
    std::printf("FAIL %s: %s\n    %s\n   ", type, what.c_str(), p.text.c_str());
    for (const sgt_named &n : p.named) std::printf(" %s = %a", n.name, n.value);
    std::printf(" h = %a\n    {{%a, %a, %a}, {%a, %a, %a}, %a, %a}\n", p.h, ray.o.x, ray.o.y, ray.o.z,
                ray.d.x, ray.d.y, ray.d.z, ray.tmin, ray.tmax);
    for (const sgt_hit *h : {&a, &b})
        std::printf("    %s t %.17g t_err %.3g [%.17g, %.17g] evals %d p {%.17g, %.17g, %.17g}\n",
                    sgt_status_text(h->status), h->t, h->t_err, h->lo, h->hi, h->evals, h->p.x, h->p.y,
                    h->p.z);
}

// Within rounding of where the surface ends: the rim; where the root of the base is 0.
bool at_the_end(const pair_of &p, const sgt_surface &s, const sgt_hit &h)
{
    if (!(h.status > 0)) return false;
    const double r = std::hypot(h.p.x, h.p.y);
    sgt_vec3 n;
    s.ops->value(s.self, h.p, &n);
    const double steep = std::sqrt(n.x * n.x + n.y * n.y + n.z * n.z);
    if (p.sag) return std::fabs(r - p.h) < 1e-11 * p.h || !(steep < 1e6);
    const double far = std::sqrt(r * r + h.p.z * h.p.z);
    return std::fabs(far - p.h) < 1e-11 * p.h;
}

sgt_ray ray_at(generator &g, const pair_of &p, const sgt_surface &s, bool *vertex)
{
    *vertex = p.sag && g.chance(0.1);
    const double r = *vertex ? 0 : p.h * std::sqrt(g.uniform(0, g.chance(0.9) ? 1 : 1.3)),
                 at = g.uniform(0, 6.283185307179586);
    sgt_vec3 to = {r * std::cos(at), r * std::sin(at), 0};
    if (p.sag) {
        const double f = s.ops->value(s.self, to, nullptr); // z - s at z = 0
        to.z = f == f ? -f : 0;
    } else {
        to.z = p.h * g.uniform(-0.6, 0.6);
    }
    const double tilt = g.chance(0.1) ? 0 : p.sag ? g.uniform(0, 1.2) : std::acos(g.uniform(-1, 1));
    const double about = g.uniform(0, 6.283185307179586), by = g.chance(0.7) ? 1 : g.log_uniform(1e-3, 1e3);
    const sgt_vec3 d = {by * std::sin(tilt) * std::cos(about), by * std::sin(tilt) * std::sin(about),
                        (p.sag ? g.sign() : 1) * by * std::cos(tilt)};
    const double away = p.h / by * (g.chance(0.1) ? g.log_uniform(10, 1e8) : g.uniform(1, 6));
    sgt_ray ray = {{to.x - away * d.x, to.y - away * d.y, to.z - away * d.z}, d, 0, 0};
    if (g.chance(0.1)) ray.tmin = -HUGE_VAL, ray.tmax = HUGE_VAL;
    return ray;
}

// Is the first root inside the ball, if the body has one?  A quadric has no end, the formula has its ball.
bool beyond_ball(const pair_of &p, const sgt_hit &h)
{
    return !p.sag && h.status > 0 && h.p.x * h.p.x + h.p.y * h.p.y + h.p.z * h.p.z > p.h * p.h * (1 - 1e-11);
}

void compare(const char *type, const pair_of &p, const sgt_surface &s, const sgt_ray &ray, bool vertex,
             tally *t)
{
    const struct {
        sgt_pick pick;
        sgt_proof proof;
        const char *name;
    } asked[] = {{SGT_FIRST, SGT_ESTIMATE, "first"},
                 {SGT_FIRST, SGT_PROVE_FIRST, "proven first"},
                 {SGT_NEAR_SEED, SGT_ESTIMATE, "near the seed"}};
    for (const auto &q : asked) {
        if (q.pick == SGT_NEAR_SEED && !p.sag) continue;
        sgt_options o = {};
        o.pick = q.pick, o.proof = q.proof;
        sgt_hit a = sgt_intersect(p.built_in, ray, &o);
        const sgt_hit b = sgt_intersect(s, ray, &o);
        const std::string how = std::string(" (") + q.name + ")";
        t->rays++;
        if (beyond_ball(p, a)) { // the next one of all roots inside
            sgt_hit all[8];
            const int n = std::min(8, sgt_intersect_all(p.built_in, ray, 8, all, nullptr));
            a.status = SGT_MISS;
            for (int i = n - 1; i >= 0; i--)
                if (all[i].status > 0 && !beyond_ball(p, all[i])) a = all[i];
            for (int i = 0; i < n; i++)
                if (all[i].status < 0) a.status = SGT_UNPROVEN;
        }
        const bool decided_a = a.status == SGT_HIT || a.status == SGT_MISS,
                   decided_b = b.status == SGT_HIT || b.status == SGT_MISS;
        t->built_in_undecided += !decided_a;
        if (b.status == SGT_INVALID || b.status == SGT_STOPPED)
            fail(type, "a status nobody asked for" + how, p, ray, a, b);
        if (!decided_b) {
            t->undecided += decided_a;
            if (vertex && !p.tip && decided_a && !at_the_end(p, s, a))
                fail(type, "undecided at the vertex" + how, p, ray, a, b);
            continue;
        }
        if (!decided_a) continue;
        if (at_the_end(p, p.built_in, a) || at_the_end(p, p.built_in, b)) {
            t->excused++;
            continue;
        }
        if (a.status != b.status) {
            fail(type, (a.status > 0 ? "not met" : "met") + how, p, ray, a, b);
            continue;
        }
        if (a.status == SGT_MISS) {
            t->misses++;
            continue;
        }
        t->hits++;
        if (q.pick == SGT_NEAR_SEED && std::fabs(a.t - b.t) > a.t_err + b.t_err) { // another seed; but a root
            sgt_hit all[8];
            const int n = std::min(8, sgt_intersect_all(p.built_in, ray, 8, all, nullptr));
            for (int i = 0; i < n; i++)
                if (all[i].status > 0 && std::fabs(all[i].t - b.t) <= all[i].t_err + b.t_err) a = all[i];
        }
        // (t is a double: two of them next to a root may be an ulp apart more)
        const double off = std::fabs((a.t - b.t) + (a.t_lo - b.t_lo)), most = a.t_err + b.t_err;
        if (off / most > t->worst) t->worst = off / most;
        if (!(std::fabs(a.t - b.t) <= most * (1 + 0x1p-40))) fail(type, "another root" + how, p, ray, a, b);
        const double apart = std::sqrt((a.p.x - b.p.x) * (a.p.x - b.p.x) + (a.p.y - b.p.y) * (a.p.y - b.p.y) +
                                       (a.p.z - b.p.z) * (a.p.z - b.p.z));
        if (!(apart <= (a.p_err + b.p_err) * (1 + 0x1p-40))) fail(type, "another point" + how, p, ray, a, b);
    }
}

} // namespace

int main(int argc, char **argv)
{
    const char *only = nullptr;
    for (int i = 1; i + 1 < argc; i++)
        if (!std::strcmp(argv[i], "--only")) only = argv[i + 1];
    const oracle::run run(argc, argv, 1000, 20261125);
    std::printf("%-14s %6s %6s %6s %9s %9s %8s %8s\n", "type", "asked", "hits", "misses", "undecided",
                "built-in", "excused", "|dt|/err");
    std::uint64_t number = 0;
    for (const row &r : rows) {
        number++;
        if (only && std::strcmp(only, r.type)) continue;
        generator g(run.seed + 7919 * number);
        tally t;
        for (long i = 0; i < run.count; i += 10) {
            part of(g);
            const pair_of p = r.make(of);
            const std::size_t size = sgt_formula_room(p.text.c_str(), p.named.size());
            std::vector<double> room(size / sizeof(double) + 1);
            sgt_error e = {};
            sgt_tape *tape = sgt_formula_read(p.text.c_str(), p.sag ? SGT_FORMULA_XY : SGT_FORMULA_XYZ,
                                              p.named.size(), p.named.data(), room.data(), size, &e);
            if (!tape) {
                std::printf("FAIL %s: %s (column %zu)\n    %s\n", r.type, e.words, e.column, p.text.c_str());
                failures++;
                break;
            }
            const sgt_formula level = {tape, p.h, {0, 0, 0}, {0, 0, 0}};
            const sgt_formula_sag sag = {tape, p.h};
            const sgt_surface s =
                p.sag ? sgt_surface{&sgt_formula_sag_ops, &sag} : sgt_surface{&sgt_formula_ops, &level};
            for (int k = 0; k < 10; k++) {
                bool vertex;
                const sgt_ray ray = ray_at(g, p, p.built_in, &vertex);
                compare(r.type, p, s, ray, vertex, &t);
            }
        }
        std::printf("%-14s %6ld %6ld %6ld %9ld %9ld %8ld %8.3f\n", r.type, t.rays, t.hits, t.misses,
                    t.undecided, t.built_in_undecided, t.excused, t.worst);
        if (t.undecided * 100 > t.rays + 500) {
            std::printf("FAIL %s: too many undecided\n", r.type);
            failures++;
        }
    }
    for (const auto &x : faults) std::printf("    %6ld %s\n", x.second, x.first.c_str());
    std::printf("%ld failures\n", failures);
    return failures != 0;
}
