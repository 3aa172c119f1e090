// SPDX-License-Identifier: MIT
// Surfaces whose departure from a plane is far below what its square, or its product with a length, can be
// told from 0; and ones that are as steep.  Proofs must not take a bound that underflows for none.
//
// Toroids, biconics, quadrics and tori have more ranges of their own, below.
//
// A ray crosses the plane z = 0 well within the rim.  F = z - P has certain unlike signs at both ends of a
// chord that is 2^-30 long, as |P| is at most 1e-25 of the rim: so a root is there, and it is the plane's to
// rounding. A miss, or a hit that is elsewhere by more than its t_err, is wrong.  For z = A x the root is a
// quotient.
#include "judge.h"

#include <sagitta/formula.h>

using namespace catalogue;

namespace
{

long asked, decided, failures;

void judge(const std::string &name, const sgt_surface &s, const sgt_ray &r, long double t, long double room)
{
    for (int proof = 0; proof < 3; proof++) {
        sgt_options o = {};
        o.proof = static_cast<sgt_proof>(proof);
        const sgt_hit h = sgt_intersect(s, r, &o);
        sgt_hit all[8];
        const int n = sgt_intersect_all(s, r, 8, all, &o);
        asked++, decided += h.status == SGT_HIT;
        const bool off =
            h.status == SGT_HIT && !(std::fabs(static_cast<double>(h.t - t)) <=
                                     h.t_err + static_cast<double>(room) + 0x1p-52 * std::fabs(h.t));
        if (h.status == SGT_MISS || h.status == SGT_INVALID || n == 0 || off) {
            if (failures++ < 20)
                std::printf("FAIL %s, proof %d: %s at %.17g, want %.17Lg; %d in all\n    ray {%a, %a, %a} "
                            "{%a, %a, %a}\n",
                            name.c_str(), proof, sgt_status_text(h.status), h.t, t, n, r.o.x, r.o.y, r.o.z,
                            r.d.x, r.d.y, r.d.z);
        }
    }
}

// Meets z = 0 at about (x, y), at *t.
sgt_ray ray_to(generator &g, double x, double y, double h, long double *t)
{
    const double l = g.uniform(-1, 1), m = g.uniform(-1, 1), n = g.sign() * g.uniform(0.5, 2),
                 away = h * g.uniform(1, 4);
    const sgt_ray r = {{x - away * l, y - away * m, -away * n}, {l, m, n}, 0, HUGE_VAL};
    *t = -static_cast<long double>(r.o.z) / n;
    return r;
}

void sag_of_text(generator &g, const std::string &text, double rim, long double steep)
{
    std::vector<double> room(sgt_formula_room(text.c_str(), 0) / sizeof(double) + 8);
    sgt_error error;
    const sgt_tape *tape = sgt_formula_read(text.c_str(), SGT_FORMULA_XY, 0, nullptr, room.data(),
                                            room.size() * sizeof(double), &error);
    if (!tape) {
        failures++, std::printf("FAIL %s: %s\n", text.c_str(), error.words);
        return;
    }
    const sgt_formula_sag sag = {tape, rim};
    long double t;
    sgt_ray r = ray_to(g, rim * g.uniform(-0.5, 0.5), rim * g.uniform(-0.5, 0.5), rim, &t);
    if (steep != 0) // z = A x: oz + t n = A (ox + t l)
        t = (steep * r.o.x - r.o.z) / (static_cast<long double>(r.d.z) - steep * r.d.x);
    if (!(t > 0)) return;
    const long double x = r.o.x + t * r.d.x, y = r.o.y + t * r.d.y;
    if (!(x * x + y * y < 0.9L * rim * rim)) return;
    judge(text, {&sgt_formula_sag_ops, &sag}, r, t, steep != 0 ? 0x1p-50 * rim : 1e-25L * rim);
}

// Toroids and biconics of hardly any curvature: |P| <= (|c_x| + |c_y|) r^2 + the terms of the profile.
void flat_profile(generator &g)
{
    const double h = g.log_uniform(1e-3, 1e3), faint = g.log_uniform(1e-290, 1e-27) / h,
                 rim = g.chance(0.7) ? 0.9 * h : 0;
    sgt_toroidal t = {};
    t.semi_diameter = rim, t.c = g.chance(0.5) ? faint * g.uniform(-1, 1) : 0, t.k = g.uniform(-2, 2);
    t.c_x = g.chance(0.5) ? faint * g.uniform(-1, 1) : 0;
    for (int i = 0; i < 3; i++)
        if (g.chance(0.5)) t.a[i] = 0.1 * faint * std::pow(h, -2.0 * i) * g.uniform(-1, 1);
    sgt_biconic b = {};
    b.semi_diameter = rim, b.c_x = faint * g.uniform(-1, 1), b.c_y = faint * g.uniform(-1, 1);
    b.k_x = g.uniform(-2, 2), b.k_y = g.chance(0.2) ? 1e30 : g.uniform(-2, 2);
    if (g.chance(0.3)) b.c_x = 0;
    long double at;
    const sgt_ray ray = ray_to(g, h * g.uniform(-0.4, 0.4), h * g.uniform(-0.4, 0.4), h, &at);
    judge("toroidal", {&sgt_toroidal_ops, &t}, ray, at, 1e-25L * h);
    judge("biconic", {&sgt_biconic_ops, &b}, ray, at, 1e-25L * h);
}

// A ray that starts on the vertex, along the axis, has no other root: any departure is exactly 0 there.  So
// is a cylinder's where y is 0.
void from_the_vertex(generator &g)
{
    const double c = g.sign() * g.log_uniform(1e-3, 1), numbers[2] = {0.1 * c, -0.03 * c};
    sgt_toroidal toroidal = {};
    toroidal.c = c, toroidal.c_x = 0.7 * c, toroidal.a[1] = 1e-3 * c;
    sgt_biconic biconic = {}, cylinder = {};
    biconic.c_x = c, biconic.c_y = 0.5 * c, cylinder.c_y = c;
    sgt_q_bfs q = {};
    q.c = c, q.norm = 0.5 / std::fabs(c), q.a = {numbers, 1, 2};
    const sgt_surface all[] = {{&sgt_toroidal_ops, &toroidal}, {&sgt_biconic_ops, &biconic},
                               {&sgt_biconic_ops, &cylinder}, {&sgt_q_bfs_ops, &q}};
    for (const sgt_surface &s : all) {
        const double x = s.self == &cylinder ? g.uniform(-9, 9) : 0;
        const sgt_ray ray = {{x, 0, 0}, {0, 0, g.sign()}, 0, HUGE_VAL};
        for (int proof = 0; proof < 3; proof++) {
            sgt_options o = {};
            o.proof = static_cast<sgt_proof>(proof);
            const sgt_hit h = sgt_intersect(s, ray, &o);
            asked++, decided += h.status == SGT_MISS;
            if (h.status == SGT_MISS) continue;
            if (failures++ < 20)
                std::printf("FAIL %s from (%g, 0, 0), proof %d: %s\n", s.ops->name, x, proof,
                            sgt_status_text(h.status));
        }
    }
}

// F = factor z (1 + small terms), which is 0 where z is: all coefficients of a quadric may be faint or huge.
void plane_quadric(generator &g)
{
    const double h = g.log_uniform(1e-3, 1e3), factor = g.sign() * std::pow(10, g.uniform(-140, 140));
    sgt_quadric q = {};
    q.linear[2] = factor;
    const double less = factor / h * g.log_uniform(1e-140, 1e-27);
    for (int i = 0; i < 3; i++)
        q.squares[i] = less * g.uniform(-1, 1), q.products[i] = less * g.uniform(-1, 1);
    long double at;
    const sgt_ray ray = ray_to(g, h * g.uniform(-0.4, 0.4), h * g.uniform(-0.4, 0.4), h, &at);
    judge("quadric", {&sgt_quadric_ops, &q}, ray, at, 1e-25L * h);
}

// A torus whose tube, or whose ring, is of any size from 1e-100 to 1e100, met in its plane on the x axis at
// R + r from outside: at t = far - (R + r) exactly.
void ring(generator &g)
{
    const double size = std::pow(10, g.uniform(-100, 100)), r = size * g.log_uniform(1e-12, 0.9);
    const sgt_torus s = {size, r};
    const sgt_ray ray = {{4 * size, 0, 0}, {-1, 0, 0}, 0, HUGE_VAL};
    judge("torus", {&sgt_torus_ops, &s}, ray, 4 * static_cast<long double>(size) - size - r, 0);
}

// Departures that are as steep as 1e100: a term a x that is huge, with the rest of its size or less, has its
// root where x is 0, for rays that cross x = 0 within the rim in the plane y = 0.
void steep_slope(generator &g, bool polynomial)
{
    const double a = std::pow(10, g.uniform(2, 100)), z = g.uniform(-1, 1), numbers[4] = {0, 0, a, 0};
    sgt_polynomial_xy p = {};
    p.a = {numbers, 2, 2}, p.semi_diameter = 1;
    sgt_chebyshev c = {};
    c.a = {numbers, 2, 2}, c.semi_diameter = 1, c.norm_x = c.norm_y = 1;
    const double l = g.sign() * g.uniform(0.5, 2), n = g.uniform(-1, 1);
    const sgt_ray ray = {{-l, 0.25, z - n}, {l, 0, n}, 0, HUGE_VAL};
    // oz + t n = a (ox + t l)
    const long double A = a, t = (A * ray.o.x - ray.o.z) / (n - A * l);
    if (polynomial) judge("polynomial_xy, steep", {&sgt_polynomial_xy_ops, &p}, ray, t, 0);
    else judge("chebyshev, steep", {&sgt_chebyshev_ops, &c}, ray, t, 0);
}

} // namespace

int main(int argc, char **argv)
{
    const oracle::run r(argc, argv, 30, 20260803);
    generator g(r.seed);
    const char *const kinds[] = {"odd_asphere", "polynomial_xy", "chebyshev", "zernike",
                                 "q_con",       "q_bfs",         "grid",      "sum"};
    for (long i = 0; i < r.count; i++) {
        for (const char *kind : kinds) {
            specimen s = {};
            s.type = kind;
            const double h = s.h = g.log_uniform(1e-3, 1e3), size = h * g.log_uniform(1e-290, 1e-27);
            s.sag = true;
            if (!std::strcmp(kind, "sum")) {
                std::vector<sgt_surface> terms = {random_departure(g, &s, "odd_asphere", h, size, false),
                                                  random_departure(g, &s, "polynomial_xy", h, size, false)};
                const std::vector<sgt_surface> &own = *s.keep(terms);
                s.s = {&sgt_sum_ops, s.keep(sgt_sum{0, 0, 0, own.data(), own.size()})};
            } else
                s.s = random_departure(g, &s, kind, h, size, false);
            first_number(s.s)[0] = 0;
            if (g.chance(0.7)) *rim_of(s) = 0.9 * h;
            long double t;
            const sgt_ray ray = ray_to(g, h * g.uniform(-0.4, 0.4), h * g.uniform(-0.4, 0.4), h, &t);
            judge(kind, s.s, ray, t, 1e-25L * h);
        }
        from_the_vertex(g), flat_profile(g), plane_quadric(g), ring(g);
        steep_slope(g, true), steep_slope(g, false);
        for (const char *power :
             {"x", "x*y", "x^2 + y^2", "r", "r^3", "x^3 - y", "sin(x)", "hypot(x, y)", "abs(x) + y"}) {
            char text[96];
            std::snprintf(text, sizeof text, "1e-%d*(%s)", 40 + g.below(270), power);
            sag_of_text(g, text, g.log_uniform(1e-3, 10), 0);
        }
        char text[64];
        const int n = 8 + g.below(50), e = 4 + g.below(6);
        for (const char *with : {"x^%d", "r^%d", "x*y^%d", "(x^2 + y^2)^%d"}) {
            std::snprintf(text, sizeof text, with, n);
            sag_of_text(g, text, std::pow(10, -e) * g.uniform(1, 2), 0);
        }
        const int big = g.below(600) - 300;
        std::snprintf(text, sizeof text, "1e%d*x", big);
        sag_of_text(g, text, 1, strtold(("1e" + std::to_string(big)).c_str(), nullptr));
    }
    std::printf("%ld asked, %ld decided, %ld failures\n", asked, decided, failures);
    if (decided * 10 < asked * 8) failures++, std::printf("FAIL these are too few\n");
    return failures != 0;
}
