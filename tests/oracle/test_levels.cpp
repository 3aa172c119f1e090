// SPDX-License-Identifier: MIT
// The level sets against quadruple precision: each number for itself, then what answers claim.
//
// The oracle is levels.h: the orbit as it is written down, in 113 bits.  A bound of the library
// (rounding, t_err, p_err, an enclosure) is held to its word exactly.  A gradient has no bound of
// its own; how far doubles can tell it is found by shaking: the same recursion in 113 bits, each
// number of each level moved by a few parts in 2^51 at random (Vignes 1978, Mathematics and
// Computers in Simulation 20, 227).  What is off by more than 1e-9 and than that is wrong.
//
// A list of all roots is checked without another search: on every stretch between two entries the
// exact sign of F must be the one that the entries on its two sides promise.  Samples see that, and
// a change of sign within t_err shows each root.  (Whether a hit is the first one, that is what the
// signs before it say, and test_brute with finer steps.)
#include "levels.h"
#include "quad.h"

#include <chrono>
#include <map>
#include <string>

using namespace oracle;

namespace {

// ------------------------------------------------------------------- levels

bool many; // more levels than the library keeps numbers of, and the limit between

// Sets of which levels beyond 100 still show something: where the orbit passes a point at which |dQ| is
// nearly 1, or stays.  A quarter of them shows nothing any more: only what rounding leaves of a surface.
level many_levels(generator &g)
{
    static const double thin[6][4] = {{0.2501, 0, 0, 0},     {0.26, 0, 0, 0}, {-0.75, 0.03, 0, 0},
                                      {0.25, 0.0005, 0, 0.001}, {0, 0, 0, 0},    {-1, 0, 0, 0}};
    level f = random_level(g);
    const bool plain = g.chance(0.75);
    if (!f.mandelbrot && plain) {
        f.s.power = 2, f.s.escape = 2;
        std::memcpy(f.s.c, thin[g.below(6)], sizeof f.s.c);
    }
    const double size = f.mandelbrot ? std::max(safe_escape(f), f.s.escape) : safe_escape(f),
                 growth = f.s.power * std::pow(size, f.s.power - 1);
    if (growth > 15) f.s.power = 2, f.s.escape = f.mandelbrot ? 2 : 4; // or so many levels are refused
    static const int limits[] = {99, 100, 101, 102}, more[] = {300, 1000, 10000};
    const bool at_limit = g.chance(0.3), far = g.chance(0.05);
    f.s.iterations = at_limit ? limits[g.below(4)] : far ? more[g.below(3)] : 102 + g.below(100);
    return f;
}

level any_level(generator &g) { return many ? many_levels(g) : random_level(g); }

// ------------------------------------------------------------------ reports

std::map<std::string, long> failed, counted;

bool first_of(const std::string &why) { return failed[why]++ < 4; }

void print_ray(const sgt_ray &r)
{
    std::printf("    o {%a, %a, %a} d {%a, %a, %a} tmin %a tmax %a\n", r.o.x, r.o.y, r.o.z, r.d.x, r.d.y,
                r.d.z, r.tmin, r.tmax);
}
void print_hit(const sgt_hit &h)
{
    std::printf("    %s t %.17g t_lo %.3g t_err %.3g lo %.17g hi %.17g evals %d p %a %a %a p_err %.3g n %.9g "
                "%.9g %.9g f %.3g\n",
                sgt_status_text(h.status), h.t, h.t_lo, h.t_err, h.lo, h.hi, h.evals, h.p.x, h.p.y, h.p.z,
                h.p_err, h.n.x, h.n.y, h.n.z, h.f);
}
void fail_at(const std::string &why, const level &f, const sgt_vec3 &p, double number)
{
    if (!first_of(why)) return;
    std::printf("FAIL %s: %.9g at {%a, %a, %a}\n", why.c_str(), number, p.x, p.y, p.z);
    print_level(f);
}
void fail_on(const std::string &why, const level &f, const sgt_ray &r, double number)
{
    if (!first_of(why)) return;
    std::printf("FAIL %s: %.17g\n", why.c_str(), number);
    print_level(f);
    print_ray(r);
}
void fail_on(const std::string &why, const level &f, const sgt_ray &r, double number, const sgt_hit &h)
{
    if (failed[why] < 4) print_hit(h);
    fail_on(why, f, r, number);
}

// Ratios, for quantiles.
std::map<std::string, std::vector<double>> ratios;
double quantile(std::vector<double> &v, double q)
{
    if (v.empty()) return 0;
    const std::size_t i = static_cast<std::size_t>(q * double(v.size() - 1));
    std::nth_element(v.begin(), v.begin() + static_cast<std::ptrdiff_t>(i), v.end());
    return v[i];
}

// -------------------------------------------------------- the plain recursion

const double far_away = 1e300; // |Q|^2 of an orbit that is not followed further

struct matrix {
    quad m[4][4];
};
matrix product(const matrix &a, const matrix &b)
{
    matrix r;
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < 4; j++)
            r.m[i][j] = a.m[i][0] * b.m[0][j] + a.m[i][1] * b.m[1][j] + a.m[i][2] * b.m[2][j] +
                        a.m[i][3] * b.m[3][j];
    return r;
}
matrix from_left(const quaternion<quad> &q) // q h
{
    return {{{q.a, -q.b, -q.c, -q.d}, {q.b, q.a, -q.d, q.c}, {q.c, q.d, q.a, -q.b}, {q.d, -q.c, q.b, q.a}}};
}
matrix from_right(const quaternion<quad> &q) // h q
{
    return {{{q.a, -q.b, -q.c, -q.d}, {q.b, q.a, q.d, -q.c}, {q.c, -q.d, q.a, q.b}, {q.d, q.c, -q.b, q.a}}};
}
const matrix identity = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}};
// The sum of L^i R^(p-1-i), by Horner's rule.
matrix jacobian(const quaternion<quad> &q, int p)
{
    const matrix left = from_left(q), right = from_right(q);
    matrix sum = identity, last = identity;
    for (int i = 1; i < p; i++) {
        sum = product(left, sum);
        last = product(right, last);
        for (int r = 0; r < 4; r++)
            for (int c = 0; c < 4; c++) sum.m[r][c] += last.m[r][c];
    }
    return sum;
}

struct recursion {
    quad f;            // F
    vector3 gradient;  // of F
    double growth;     // the greatest |T(n)| / max(1, |Q_n|), per length: how fast anything changes
};

// `shake`: each number moved by some parts in 2^51.
recursion by_recursion(const level &f, const vector3 &p, generator *shake)
{
    const double u = 0x1p-51;
    const quaternion<quad> point = in_slice(f, p.x, p.y, p.z),
                           c = f.mandelbrot ? point : constant<quad>(f.s.c);
    const quad size = square_root(dot(c, c));
    quaternion<quad> q = point;
    matrix t = identity;
    quad greatest = 1;
    int n = f.mandelbrot; // Q_1 is the point itself, and T(1) the identity
    for (;; n++) {
        quad sum = 0;
        for (auto &row : t.m)
            for (quad &x : row) sum += x * x;
        greatest = std::max(greatest, sum / std::max(quad(1), dot(q, q)));
        if (shake) {
            const quad by = u * (square_root(dot(q, q)) + size), turn = u * square_root(sum);
            for (quad *x : {&q.a, &q.b, &q.c, &q.d}) *x += by * shake->uniform(-1, 1);
            for (auto &row : t.m)
                for (quad &x : row) x += turn * shake->uniform(-1, 1);
        }
        if (n >= f.s.iterations || dot(q, q) > far_away) break;
        t = product(jacobian(q, f.s.power), t);
        if (f.mandelbrot)
            for (int i = 0; i < 4; i++) t.m[i][i] += 1;
        q = power(q, f.s.power) + c;
    }
    const quad e = f.s.escape, v = dot(q, q) / (e * e);
    const quad whole[4] = {q.a, q.b, q.c, q.d};
    vector3 g = {0, 0, 0};
    for (int j = 0; j < 4; j++) {
        quad along = 0;
        for (int i = 0; i < 4; i++) along += 2 * whole[i] * t.m[i][j];
        g.x += along * f.s.ex[j], g.y += along * f.s.ey[j], g.z += along * f.s.ez[j];
    }
    const quad chain = 2 / (e * e * (v + 1) * (v + 1));
    return {(v - 1) / (v + 1),
            {chain * g.x, chain * g.y, chain * g.z},
            to_double(square_root(greatest)) * axis_length(f)};
}

vector3 widen(const sgt_vec3 &p) { return {p.x, p.y, p.z}; }
vector3 minus(const vector3 &a, const vector3 &b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
vector3 along(const sgt_ray &r, quad t) { return {r.o.x + t * r.d.x, r.o.y + t * r.d.y, r.o.z + t * r.d.z}; }
double length(const sgt_vec3 &d) { return std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z); }

quad exact_f(const level &f, const vector3 &p) { return level_value(f, p.x, p.y, p.z, far_away); }
quad exact_g(const level &f, const sgt_ray &r, quad t)
{
    const vector3 p = along(r, t);
    return excess(f, p.x, p.y, p.z, far_away);
}

// How far doubles can tell the gradient at p.
double blur_of(const level &f, const vector3 &p, const recursion &exact, generator &g)
{
    double blur = 0;
    for (int i = 0; i < 3; i++)
        blur = std::max(blur, to_double(norm(minus(by_recursion(f, p, &g).gradient, exact.gradient))));
    return 4 * blur;
}

// ------------------------------------------------------------------- points

// In the ball, or on the surface as near as doubles tell.
sgt_vec3 interesting_point(generator &g, const level &f)
{
    const double size = 1.2 / axis_length(f);
    const auto inside = [&](const sgt_vec3 &p) { return excess(f, p.x, p.y, p.z) < 0; };
    sgt_vec3 a = random_point(g, size), b = random_point(g, size);
    const bool at_a = inside(a);
    if (g.chance(0.3)) return a;
    for (int i = 0; i < 50 && inside(b) == at_a; i++) b = random_point(g, size);
    if (inside(b) == at_a) return a;
    for (int i = 0; i < 60; i++) {
        const sgt_vec3 m = {(a.x + b.x) / 2, (a.y + b.y) / 2, (a.z + b.z) / 2};
        (inside(m) == at_a ? a : b) = m;
    }
    return a;
}

void values(generator &g, long count)
{
    for (long i = 0; i < count; i++) {
        const level f = any_level(g);
        sgt_mandelbrot m;
        const sgt_surface s = as_surface(f, &m);
        const sgt_vec3 p = interesting_point(g, f);
        const double v = s.ops->value(s.self, p, nullptr), own = s.ops->rounding(s.self, p);
        const quad exact = exact_f(f, widen(p));
        const double off = to_double(magnitude(v - exact));
        if (!(v >= -1 && v <= 1)) fail_at("F is not in [-1, 1]", f, p, v);
        if (!(own >= 0 && own < HUGE_VAL)) fail_at("rounding is no bound", f, p, own);
        if (!(off <= own)) fail_at("F is off by more than its rounding", f, p, off / own);
        ratios["rounding / max(error of F, 2^-54)"].push_back(own / std::max(off, 0x1p-54));
        if (std::fabs(v) > 1e-3)
            counted[own < std::fabs(v) ? "values whose sign rounding leaves certain"
                                       : "values whose sign rounding leaves open"]++;
        if (s.ops->clearance) {
            const double clear = s.ops->clearance(s.self, p);
            for (int k = 0; k < 8 && clear > 0 && clear < HUGE_VAL; k++) { // nowhere else a sign, so near
                const sgt_vec3 way = random_way(g);
                const quad by = clear * (k < 4 ? 1 - 0x1p-40 : g.uniform(0, 1));
                const quad there = exact_f(f, {p.x + by * way.x, p.y + by * way.y, p.z + by * way.z});
                if ((there > 0) != (exact > 0)) fail_at("the surface is within its clearance", f, p, clear);
            }
            counted["clearances"]++;
        }
        if (s.ops->estimate) {
            const double estimate = s.ops->estimate(s.self, p);
            if (!(estimate >= 0 && estimate < HUGE_VAL)) fail_at("an estimate that is none", f, p, estimate);
            counted["estimates"]++;
        }
        // Left to a default, the escape is the safe one: within a few parts in 2^50 of this one.
        if (f.s.escape == safe_escape(f)) {
            level by_default = f;
            by_default.s.escape = 0;
            sgt_mandelbrot m2;
            const sgt_surface s2 = as_surface(by_default, &m2);
            const double v2 = s2.ops->value(s2.self, p, nullptr);
            if (!(std::fabs(v2 - v) <= 2 * own + 0x1p-48))
                fail_at("another F by default of escape", f, p, v2 - v);
            counted["values by default of escape"]++;
        }
        counted["values"]++;
    }
    if (!many && counted["values whose sign rounding leaves open"] > count / 20)
        failed["rounding says too little"]++;
}

void gradients(generator &g, long count)
{
    for (long i = 0; i < count; i++) {
        const level f = any_level(g);
        sgt_mandelbrot m;
        const sgt_surface s = as_surface(f, &m);
        const sgt_vec3 p = interesting_point(g, f);
        const vector3 q = widen(p);
        const recursion r = by_recursion(f, q, nullptr);
        const quad size = norm(r.gradient);
        if (many && !(r.growth < 1e10)) { // neither differences nor shaking tells then
            counted["gradients: finer than doubles"]++;
            continue;
        }

        // Central differences of F, with steps h and h/2, extrapolated (Richardson 1911).
        const double h = std::ldexp(1, std::ilogb(1e-6 / r.growth));
        const auto difference = [&](double x, double y, double z) {
            return (exact_f(f, {q.x + x, q.y + y, q.z + z}) - exact_f(f, {q.x - x, q.y - y, q.z - z})) /
                   (2 * (quad(x) + y + z));
        };
        const vector3 whole = {difference(h, 0, 0), difference(0, h, 0), difference(0, 0, h)};
        const vector3 half = {difference(h / 2, 0, 0), difference(0, h / 2, 0), difference(0, 0, h / 2)};
        const vector3 best = {half.x + (half.x - whole.x) / 3, half.y + (half.y - whole.y) / 3,
                              half.z + (half.z - whole.z) / 3};
        const quad doubt = norm(minus(best, half)) + quad(1e-28) * r.growth;
        if (!(size > quad(1e-6) * axis_length(f))) counted["gradients: small"]++;
        else if (doubt > quad(1e-10) * size) counted["gradients: no differences to compare with"]++;
        else {
            if (!(norm(minus(best, r.gradient)) <= 4 * doubt))
                fail_at("the oracle's two gradients differ", f, p,
                        to_double(norm(minus(best, r.gradient)) / size));
            counted["gradients: recursion and differences agree"]++;
        }

        sgt_vec3 n = {NAN, NAN, NAN};
        const double v = s.ops->value(s.self, p, &n), bare = s.ops->value(s.self, p, nullptr);
        if (v != bare) fail_at("another F with the gradient", f, p, v - bare);
        // (F may be 1 to the last bit where its gradient is not quite zero yet)
        const double blur = blur_of(f, q, r, g), off = to_double(norm(minus(widen(n), r.gradient))),
                     tiny = 0x1p-60 * r.growth;
        if (!(off <= 1e-9 * to_double(size) + blur + tiny)) fail_at("gradient", f, p, off / to_double(size));
        if (blur <= 1e-9 * to_double(size) && tiny <= 1e-10 * to_double(size)) {
            if (doubt <= quad(1e-10) * size && !(off <= 1e-9 * to_double(norm(best))))
                fail_at("gradient against differences, 1e-9", f, p, off / to_double(size));
            if (!(off <= 1e-9 * to_double(size)))
                fail_at("gradient against the recursion, 1e-9", f, p, off / to_double(size));
            counted["gradients: to 1e-9"]++;
        } else counted["gradients: no double could be true to 1e-9"]++;
    }
    if (many) return; // which sets show something is left to chance
    if (double(counted["gradients: no differences to compare with"]) > 0.02 * double(count))
        failed["too few gradients compared with differences"]++;
    if (double(counted["gradients: to 1e-9"]) < 0.5 * double(count))
        failed["too few gradients compared to 1e-9"]++;
}

// ------------------------------------------------------------- the potential

double potential_of(const level &f, const sgt_surface &s, const sgt_vec3 &p, sgt_vec3 *grad)
{
    return f.mandelbrot ? sgt_mandelbrot_potential(static_cast<const sgt_mandelbrot *>(s.self), p, grad)
                        : sgt_julia_potential(static_cast<const sgt_julia *>(s.self), p, grad);
}

typedef dual<quad> pair;
struct escaping {
    double value, slope; // of the potential, along d
    bool escapes;
};
escaping by_orbit(const level &f, const sgt_vec3 &p, const sgt_vec3 &d, generator *shake)
{
    const quaternion<pair> point = in_slice(f, pair(p.x, d.x), pair(p.y, d.y), pair(p.z, d.z)),
                           c = f.mandelbrot ? point : constant<pair>(f.s.c);
    quaternion<pair> q = point;
    quad scale = 1;
    int n = f.mandelbrot;
    if (n) scale = f.s.power;
    for (;; n++, scale *= f.s.power) {
        if (shake) {
            const quad by = quad(0x1p-51) * (square_root(dot(q, q).v) + square_root(dot(c, c).v));
            const quad turn = quad(0x1p-51) *
                              square_root(q.a.d * q.a.d + q.b.d * q.b.d + q.c.d * q.c.d + q.d.d * q.d.d);
            for (pair *x : {&q.a, &q.b, &q.c, &q.d})
                *x = *x + pair(by * shake->uniform(-1, 1), turn * shake->uniform(-1, 1));
        }
        if (n >= std::max(200, f.s.iterations) || dot(q, q).v > quad(0x1p64)) break;
        q = power(q, f.s.power) + c;
    }
    const pair square = dot(q, q);
    if (!(square.v > quad(0x1p64))) return {0, 0, false};
    quad reduced = square.v;
    double logarithm = 0;
    while (reduced > quad(1e300)) reduced /= quad(1e300), logarithm += std::log(1e300);
    logarithm += std::log(to_double(reduced));
    return {logarithm / 2 / to_double(scale), to_double(square.d / (2 * square.v) / scale), true};
}

void potentials(generator &g, long count)
{
    for (long i = 0; i < count; i++) {
        level f = any_level(g);
        const bool slow = many && g.chance(0.9); // the orbit passes 1/2 in some 310 levels
        if (slow) {
            static const double c[4] = {0.2501, 0, 0, 0};
            f = level();
            std::memcpy(f.s.c, c, sizeof c);
            f.s.ex[0] = f.s.ey[1] = f.s.ez[2] = 1;
            f.s.power = 2, f.s.escape = 2, f.s.iterations = 250 + g.below(200);
        }
        sgt_mandelbrot m;
        const sgt_surface s = as_surface(f, &m);
        sgt_vec3 p = interesting_point(g, f);
        if (slow) p = {g.uniform(0.1, 0.45), g.uniform(-1e-4, 1e-4), g.uniform(-1e-4, 1e-4)};
        else if (g.chance(0.1)) {
            const double far = g.log_uniform(1, 1e150); // |Q|^2 still a double
            p = {far * p.x, far * p.y, far * p.z};
        }
        const sgt_vec3 d = random_way(g);
        sgt_vec3 grad = {NAN, NAN, NAN};
        const double v = potential_of(f, s, p, &grad), bare = potential_of(f, s, p, nullptr);
        const escaping exact = by_orbit(f, p, d, nullptr);
        double blur = 0, blur_slope = 0;
        bool told = true;
        for (int k = 0; k < 6; k++) {
            const escaping e = by_orbit(f, p, d, &g);
            told = told && e.escapes == exact.escapes;
            blur = std::max(blur, 4 * std::fabs(e.value - exact.value)),
            blur_slope = std::max(blur_slope, 4 * std::fabs(e.slope - exact.slope));
        }
        // An orbit that stays may be let go by few of the ways to round it.
        for (int k = 0; told && !exact.escapes && v != 0 && k < 1000; k++)
            told = !by_orbit(f, p, d, &g).escapes;
        if (v != bare) fail_at("another potential with the gradient", f, p, v - bare);
        if (!(v >= 0 && v < HUGE_VAL && std::isfinite(grad.x) && std::isfinite(grad.y)
            && std::isfinite(grad.z))) fail_at("the potential is no number", f, p, v);
        if (!told || blur > exact.value) {
            counted["potentials: no double could tell whether the orbit escapes"]++;
            continue;
        }
        if (!exact.escapes) {
            if (!(v == 0 && grad.x == 0 && grad.y == 0 && grad.z == 0))
                fail_at("a potential where the orbit stays", f, p, v);
            counted["potentials: of orbits that stay"]++;
            continue;
        }
        const double slope = grad.x * d.x + grad.y * d.y + grad.z * d.z,
                     size = std::max({std::fabs(grad.x), std::fabs(grad.y), std::fabs(grad.z)});
        if (!(std::fabs(v - exact.value) <= 1e-13 * exact.value + blur))
            fail_at("potential", f, p, v / exact.value - 1);
        if (!(std::fabs(slope - exact.slope) <= 1e-12 * size + blur_slope))
            fail_at("gradient of the potential", f, p, (slope - exact.slope) / size);
        counted[blur <= 1e-9 * exact.value ? "potentials: to 1e-9" : "potentials: as far as doubles tell"]++;
    }
    if (!many && double(counted["potentials: to 1e-9"]) < 0.4 * double(count))
        failed["too few potentials compared to 1e-9"]++;
}

// --------------------------------------------------------- far, deep, and none

bool finite(const sgt_vec3 &v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

void nothing_overflows(generator &g, long count)
{
    static const double sizes[] = {0,   5e-324, 1e-300, 1e-100, 1e-9,  1,
                                   1e9, 1e100,  1e154,  1e200,  1e300, 1.7e308};
    for (long i = 0; i < count; i++) {
        level f = random_level(g);
        f.s.iterations = g.chance(0.5) ? 50 : 100;
        if (many) f.s.iterations = g.chance(0.5) ? 101 : g.chance(0.8) ? 600 : 2500;
        if (g.chance(0.3)) f.s.power = 8;
        if (g.chance(0.5)) {
            random_unit(g, f.s.c);
            for (double &c : f.s.c) c *= 2;
        }
        if (g.chance(0.1))
            for (double &c : f.s.c) c = g.uniform(-1e6, 1e6) / 2;
        if (g.chance(0.1))
            for (double &a : f.s.at) a = g.uniform(-1e6, 1e6);
        f.s.escape = g.chance(0.5) ? safe_escape(f) * (1 + g.log_uniform(1e-3, 1)) : f.mandelbrot ? 4 : 0;
        const double unit = g.chance(0.2) ? std::pow(10, g.uniform(-99, 99)) / axis_length(f) : 1;
        for (double *a : {f.s.ex, f.s.ey, f.s.ez})
            for (int k = 0; k < 4; k++) a[k] *= unit;
        const bool stays = many && g.chance(0.2); // -2: the real axis up to 2 stays, and |dQ_N| is 2^N
        if (stays) {
            f = level();
            f.s.c[0] = -2, f.s.ex[0] = f.s.ey[1] = f.s.ez[2] = 1;
            f.s.power = 2, f.s.escape = 2, f.s.iterations = 2500;
        }
        sgt_mandelbrot m;
        const sgt_surface s = as_surface(f, &m);
        const auto size = [&] {
            return sizes[g.below(static_cast<int>(sizeof sizes / sizeof *sizes))] * g.sign();
        };
        const sgt_vec3 p = stays           ? sgt_vec3{g.uniform(-2, 2), 0, 0}
                           : g.chance(0.3) ? interesting_point(g, f)
                                           : sgt_vec3{size(), size(), size()};
        sgt_vec3 n = {NAN, NAN, NAN}, along_potential = {NAN, NAN, NAN};
        const double v = s.ops->value(s.self, p, &n), own = s.ops->rounding(s.self, p);
        if (v != v) { // the derivative, (p R^(p-1))^N, is to be a double
            const double radius = f.mandelbrot ? std::max(safe_escape(f), f.s.escape) : safe_escape(f);
            const double bits = f.s.iterations * std::log2(f.s.power * std::pow(radius, f.s.power - 1));
            if (!(bits > 450)) fail_at("F overflows", f, p, bits);
            counted["far and deep: invalid, too deep for a double"]++;
            continue;
        }
        if (!(v >= -1 && v <= 1)) fail_at("F overflows", f, p, v);
        const bool none = many && std::isnan(n.x) && std::isnan(n.y) && std::isnan(n.z);
        if (none) counted["far and deep: the derivative is no double"]++;
        if (!finite(n) && !none) fail_at("the gradient overflows", f, p, n.x + n.y + n.z);
        if (!(own >= 0 && own < HUGE_VAL)) fail_at("rounding overflows", f, p, own);
        const double potential = potential_of(f, s, p, &along_potential);
        if (!(potential >= 0 && potential < HUGE_VAL)) fail_at("the potential overflows", f, p, potential);
        if (!finite(along_potential))
            fail_at("the gradient of the potential overflows", f, p, along_potential.x);
        if (s.ops->estimate && !(s.ops->estimate(s.self, p) >= 0 && s.ops->estimate(s.self, p) < HUGE_VAL))
            fail_at("the estimate overflows", f, p, s.ops->estimate(s.self, p));
        if (s.ops->clearance && std::isnan(s.ops->clearance(s.self, p)))
            fail_at("a clearance that is NaN", f, p, NAN);

        // Rays from there, whatever their direction's length: an answer, and one that makes sense.
        const sgt_vec3 way = random_way(g);
        const double by = g.chance(0.5) ? 1 : g.log_uniform(1e-300, 1e300);
        sgt_ray ray = {p, {by * way.x, by * way.y, by * way.z}, 0, 0};
        if (g.chance(0.3)) ray.tmin = -HUGE_VAL, ray.tmax = HUGE_VAL;
        const sgt_span span = s.ops->span(s.self, &ray);
        if (std::isnan(span.lo) || std::isnan(span.hi)) fail_on("a span that is NaN", f, ray, span.lo);
        sgt_options few = {};
        few.max_evals = 300;
        for (int fast = 0; fast < 2; fast++) {
            few.dt_min = fast ? 1e-3 / (by * axis_length(f)) : 0;
            if (!(few.dt_min < HUGE_VAL)) continue;
            const sgt_hit h = sgt_intersect(s, ray, &few);
            if (h.status == SGT_INVALID) fail_on("valid input called invalid", f, ray, few.dt_min, h);
            if (h.status > 0 && !(std::isfinite(h.t) && h.t_err >= 0 && h.t_err < HUGE_VAL && finite(h.p) &&
                                  finite(h.n) && h.p_err >= 0))
                fail_on("a hit of no numbers", f, ray, h.t, h);
            counted["far and deep: " + std::string(sgt_status_text(h.status))]++;
        }
    }
}

// --------------------------------------------------------------- enclosures

// F and F' along the ray.
pair exact_along(const level &f, const sgt_ray &r, quad t)
{
    const pair w(t, 1);
    const auto coordinate = [&](double o, double d) { return pair(o) + pair(d) * w; };
    const pair x = coordinate(r.o.x, r.d.x), y = coordinate(r.o.y, r.d.y), z = coordinate(r.o.z, r.d.z);
    int n;
    const quaternion<pair> q = orbit(f, in_slice(f, x, y, z), f.s.iterations, far_away, &n);
    const pair square = dot(q, q);
    const quad e2 = quad(f.s.escape) * f.s.escape, sum = square.v + e2;
    return {(square.v - e2) / sum, 2 * e2 / sum * (square.d / sum)};
}

void enclosures(generator &g, long count)
{
    long said = 0;
    for (long i = 0; i < count; i++) {
        const level f = any_level(g);
        sgt_mandelbrot m;
        const sgt_surface s = as_surface(f, &m);
        if (!s.ops->enclose) break;
        const sgt_vec3 p = interesting_point(g, f), way = random_way(g);
        const double by = g.chance(0.5) ? 1 : g.log_uniform(1e-3, 1e3),
                     away = g.chance(0.3) ? 0 : g.uniform(-4, 4) / axis_length(f) / by;
        const sgt_vec3 d = {by * way.x, by * way.y, by * way.z};
        const sgt_ray ray = {{p.x - away * d.x, p.y - away * d.y, p.z - away * d.z}, d, 0, 0};
        const double width = g.log_uniform(1e-14, 2) / axis_length(f) / by,
                     at = away + width * g.uniform(-0.5, 0.5);
        const sgt_interval t = {at - width / 2, at + width / 2};
        sgt_interval slope = {NAN, NAN};
        const sgt_interval value = s.ops->enclose(s.self, &ray, t, &slope);
        if (value.lo > value.hi) fail_on("undefined all over a cell", f, ray, width);
        if (slope.lo > slope.hi) fail_on("no slope at all in a cell", f, ray, width);
        quad steepest = 0;
        for (int k = 0; k < 12; k++) {
            const quad w = k < 2 ? quad(k ? t.lo : t.hi) : quad(t.lo) + (quad(t.hi) - t.lo) * g.uniform(0, 1);
            const pair e = exact_along(f, ray, w);
            const quad tiny = quad(1e-250) * by * axis_length(f);
            steepest = std::max(steepest, magnitude(e.d));
            if (e.v < value.lo || e.v > value.hi) fail_on("g outside its enclosure", f, ray, width);
            if (e.d < slope.lo - tiny || e.d > slope.hi + tiny)
                fail_on("g' outside its enclosure", f, ray, width);
        }
        counted["enclosures"]++;
        if (!(value.hi - value.lo < HUGE_VAL && slope.hi - slope.lo < HUGE_VAL)) continue;
        said++;
        // A cell so narrow that F is straight in it.
        const recursion r = by_recursion(f, along(ray, at), nullptr);
        if (!(r.growth * by * width < 1e-5)) continue;
        const double own = s.ops->rounding(s.self,
                                           {ray.o.x + at * d.x, ray.o.y + at * d.y, ray.o.z + at * d.z});
        ratios["width of a narrow enclosure / what F and rounding need"].push_back(
            (value.hi - value.lo) / (to_double(steepest) * width + own));
        ratios["width of the slope in a narrow cell / 1e-4 |T| |d|"].push_back((slope.hi - slope.lo) /
                                                                               (1e-4 * r.growth * by));
    }
    std::printf("%ld enclosures that say something\n", said);
    if (many && !(15 * said > count)) failed["many: enclosures say too little"]++;
    if (!many && counted["enclosures"] &&
        !(quantile(ratios["width of a narrow enclosure / what F and rounding need"], 0.5) < 10))
        failed["enclosures of narrow cells are too wide"]++;
}

// ------------------------------------------------------------------- rays

const int most = 4000;

void check_hit(const level &f, const sgt_surface &s, const sgt_ray &ray, const sgt_hit &h, generator &g,
               const std::string &by)
{
    double tmin, tmax;
    ends_of(ray, &tmin, &tmax);
    counted[by + ": " + sgt_status_text(h.status)]++;
    if (!(h.t >= tmin && h.t <= tmax && h.t_err >= 0 && h.p_err >= 0 && std::isfinite(h.t) &&
          std::isfinite(h.t_err) && std::isfinite(h.p_err))) {
        fail_on(by + ": t, t_err or p_err makes no sense", f, ray, h.t, h);
        return;
    }
    if (!(h.lo <= h.t && h.t <= h.hi)) fail_on(by + ": t is not in [lo, hi]", f, ray, h.t, h);
    sgt_vec3 n;
    if (s.ops->value(s.self, h.p, &n) != h.f) fail_on(by + ": f is not F at p", f, ray, h.f, h);
    const recursion r = by_recursion(f, widen(h.p), nullptr);
    const double size = to_double(norm(r.gradient)), off = to_double(norm(minus(widen(h.n), r.gradient)));
    if (!(off <= 1e-9 * size) && !(off <= 1e-9 * size + blur_of(f, widen(h.p), r, g)))
        fail_on(by + ": n is not the gradient at p", f, ray, off / size, h);

    quad root = quad(h.t) + h.t_lo;
    if (h.status == SGT_HIT) {
        quad lo = quad(h.t) - h.t_err, hi = quad(h.t) + h.t_err;
        const quad before = exact_g(f, ray, lo), behind = exact_g(f, ray, hi);
        if ((before > 0) == (behind > 0) && before != 0 && behind != 0) {
            fail_on(by + ": no change of sign at t +- t_err", f, ray, to_double(before), h);
            return;
        }
        const double slope = h.n.x * ray.d.x + h.n.y * ray.d.y + h.n.z * ray.d.z,
                     told = std::max(off, 1e-9 * size) * length(ray.d);
        if (std::fabs(slope) > told && (slope > 0) != (behind > before))
            fail_on(by + ": enters where it leaves", f, ray, slope, h);
        for (int i = 0; i < 24; i++) {
            const quad middle = (lo + hi) / 2;
            ((exact_g(f, ray, middle) > 0) == (before > 0) ? lo : hi) = middle;
        }
        root = (lo + hi) / 2;
        const double error = to_double(magnitude(root - h.t));
        if (h.t != 0)
            ratios[by + ": t_err / max(error, ulp(t)/2)"].push_back(h.t_err / std::max(error, ulp(h.t) / 2));
        if (!(magnitude(root - h.t - h.t_lo) <= h.t_err * (1 + quad(1e-6))))
            fail_on(by + ": t + t_lo is farther from the root than t_err", f, ray, to_double(root - h.t), h);
    } else {
        // Within rounding all over: that of F, and that of the place where F is looked at.
        const double own = s.ops->rounding(s.self, h.p),
                     place = 0x1p-50 * (std::fabs(h.p.x) + std::fabs(h.p.y) + std::fabs(h.p.z)) * size;
        for (int k = 0; k <= 8; k++) {
            const vector3 p = along(ray, h.lo + (quad(h.hi) - h.lo) * k / 8);
            const double there = to_double(magnitude(exact_f(f, p)));
            if (!(there <= 4 * own + place + size * h.p_err))
                fail_on(by + ": a graze that is none", f, ray, there / own, h);
        }
    }
    const double aside = to_double(norm(minus(along(ray, root), widen(h.p))));
    if (!(aside <= h.p_err * (1 + 1e-6)))
        fail_on(by + ": p is farther from the point than p_err", f, ray, aside / h.p_err, h);
}

// The list against the signs: where no entry is, each sample has the sign that the entries promise.
void check_list(const level &f, const sgt_surface &s, const sgt_ray &ray, int n, const sgt_hit hit[],
                generator &g, int samples)
{
    double tmin, tmax, last = -HUGE_VAL;
    ends_of(ray, &tmin, &tmax);
    for (int i = 0; i < n; i++) {
        const sgt_hit &h = hit[i];
        if (h.status > 0) check_hit(f, s, ray, h, g, "all");
        else {
            counted["all: " + std::string(sgt_status_text(h.status))]++;
            if (!(std::isnan(h.f) && std::isnan(h.n.x) && std::isnan(h.p.x)))
                fail_on("all: a stretch with a point", f, ray, h.t, h);
            if (!(h.lo <= h.hi && h.t - h.t_err <= h.lo && h.t + h.t_err >= h.hi))
                fail_on("all: t +- t_err does not cover its stretch", f, ray, h.t, h);
        }
        if (!(h.t + h.t_err >= last)) fail_on("all: out of order", f, ray, h.t, h);
        last = h.t;
    }
    const sgt_span span = s.ops->span(s.self, &ray);
    const double by = length(ray.d),
                 off = std::sqrt(ray.o.x * ray.o.x + ray.o.y * ray.o.y + ray.o.z * ray.o.z);
    const double middle = -(ray.o.x * ray.d.x + ray.o.y * ray.d.y + ray.o.z * ray.d.z) / (by * by),
                 reach = std::min(off, 5 / axis_length(f)) / by + 3 / axis_length(f) / by;
    const double lo = std::max(tmin, middle - reach), hi = std::min(tmax, middle + reach);
    int promised = 0; // where there is no entry at all, the first sample's
    for (int k = 0; k < samples && lo < hi; k++) {
        const double t = lo + (hi - lo) * g.uniform(0, 1);
        const sgt_vec3 p = {ray.o.x + t * ray.d.x, ray.o.y + t * ray.d.y, ray.o.z + t * ray.d.z};
        const bool outside = span.lo > span.hi || t < span.lo || t > span.hi;
        int next = 0;
        while (next < n && (hit[next].status > 0 ? hit[next].t + hit[next].t_err : hit[next].hi) < t) next++;
        if (next < n && t >= (hit[next].status > 0 ? hit[next].t - hit[next].t_err : hit[next].lo))
            continue; // on an entry
        int sign = 0;
        if (next < n && hit[next].status == SGT_HIT)
            sign = hit[next].n.x * ray.d.x + hit[next].n.y * ray.d.y + hit[next].n.z * ray.d.z > 0 ? -1 : 1;
        else if (next > 0 && hit[next - 1].status == SGT_HIT) {
            const sgt_hit &h = hit[next - 1];
            sign = h.n.x * ray.d.x + h.n.y * ray.d.y + h.n.z * ray.d.z > 0 ? 1 : -1;
        } else if (n == 0) sign = promised;
        const double rough = excess(f, p.x, p.y, p.z);
        if (!(rough < 0) && outside && sign >= 0 && n > 0) continue; // as it should be
        if (sign && (rough > 0) == (sign > 0)) continue;
        const quad there = exact_g(f, ray, t);
        const int exact = there > 0 ? 1 : there < 0 ? -1 : 0;
        if (outside && exact < 0) fail_on("span: the inside of the set is outside of it", f, ray, t);
        if (n == 0 && !promised) promised = exact;
        if (sign && exact && exact != sign) {
            const std::string why = n == 0 ? "all: none, and F changes sign"
                                           : "all: a root is missing, or one too many";
            if (failed[why] < 4)
                for (int i = 0; i < n; i++) print_hit(hit[i]);
            fail_on(why, f, ray, t);
        }
        counted["signs confirmed in 113 bits"]++;
    }
}

void check_restart(const level &f, const sgt_surface &s, const sgt_ray &ray, int n, const sgt_hit hit[])
{
    for (int i = 0; i < n && i < 6; i++) {
        if (hit[i].status != SGT_HIT) return;
        sgt_ray rest = ray;
        rest.tmin = hit[i].t;
        if (ray.tmax == 0 && ray.tmin == 0) rest.tmax = HUGE_VAL;
        if (rest.tmin == 0 && rest.tmax == 0) return;
        const sgt_hit next = sgt_intersect(s, rest, nullptr);
        // The rule of sgt_ray: a root as near as that to tmin does not count; about the limit, perhaps.
        int j = i + 1, perhaps = -1;
        for (; j < n; j++) {
            const sgt_hit &h = hit[j];
            if (h.status <= 0) return;
            const double slope = std::fabs(h.n.x * ray.d.x + h.n.y * ray.d.y + h.n.z * ray.d.z);
            const double spread =
                (std::fabs(h.p.x * h.n.x) + std::fabs(h.p.y * h.n.y) + std::fabs(h.p.z * h.n.z)) / slope;
            const double start = rest.tmin + h.t_err + 0x1p-48 * spread + 0x1p-50 * std::fabs(h.t),
                         slack = 8 * (start - rest.tmin) + 16 * h.t_err + hit[i].t_err;
            if (h.t <= start - slack) continue;
            if (perhaps < 0) perhaps = j;
            if (h.t > start + slack) break;
        }
        counted["restarts"]++;
        if (j == n && perhaps < 0) {
            if (next.status > 0) fail_on("restart: a root behind the last one", f, rest, next.t, next);
            continue;
        }
        if (next.status < 0) {
            counted["restarts that are undecided"]++;
            continue;
        }
        bool known = next.status == SGT_MISS && j == n;
        for (int k = perhaps; k <= j && k < n && next.status > 0; k++)
            known = known || std::fabs(next.t - hit[k].t) <= next.t_err + hit[k].t_err;
        if (!known) fail_on("restart: not the next root", f, rest, j < n ? hit[j].t : NAN, next);
    }
}

// With dt_min: late perhaps, never false.
void check_fast(const level &f, const sgt_surface &s, const sgt_ray &ray, int n, const sgt_hit hit[],
                generator &g)
{
    sgt_options options = {};
    options.dt_min = g.log_uniform(1e-5, 1e-1) / axis_length(f) / length(ray.d);
    options.max_evals = 1000000;
    const sgt_hit h = sgt_intersect(s, ray, &options);
    double tmin, tmax;
    ends_of(ray, &tmin, &tmax);
    const sgt_span span = s.ops->span(s.self, &ray);
    const bool by = span.lo > span.hi || span.hi < tmin || span.lo > tmax;
    if (h.status == SGT_MISS && !by) fail_on("fast: a miss that cannot be told", f, ray, options.dt_min, h);
    if (by && h.status != SGT_MISS)
        fail_on("fast: not a miss, though the ball is passed by", f, ray, options.dt_min, h);
    if (h.status > 0) {
        check_hit(f, s, ray, h, g, "fast");
        const bool decided = n > 0 && hit[0].status > 0;
        if (n == 0 || (decided && h.t + h.t_err < hit[0].t - hit[0].t_err))
            fail_on("fast: before the first root", f, ray, n ? hit[0].t : NAN, h);
        if (decided && h.t - h.t_err > hit[0].t + hit[0].t_err) counted["fast: a later root"]++;
    } else {
        counted["fast: " + std::string(sgt_status_text(h.status))]++;
        if (n > 0 && hit[0].status > 0) counted["fast: none, though there is one"]++;
        if (h.status != SGT_MISS && h.status != SGT_UNPROVEN)
            fail_on("fast: another status", f, ray, options.dt_min, h);
    }
    // All by the fast way: each is true, each in its place.
    static sgt_hit list[most];
    const int found = sgt_intersect_all(s, ray, most, list, &options);
    for (int i = 0; i < found && i < most; i++) {
        if (list[i].status > 0) check_hit(f, s, ray, list[i], g, "fast, all");
        if (i && !(list[i].t + list[i].t_err >= list[i - 1].t - list[i - 1].t_err))
            fail_on("fast, all: out of order", f, ray, list[i].t, list[i]);
    }
    if (!by && found == 0) fail_on("fast, all: a miss that cannot be told", f, ray, options.dt_min);
}

void check_tolerance(const level &f, const sgt_surface &s, const sgt_ray &ray, const sgt_hit &first,
                     generator &g)
{
    sgt_options options = {};
    options.t_tol = g.log_uniform(1e-12, 1e-2) / axis_length(f) / length(ray.d);
    const sgt_hit h = sgt_intersect(s, ray, &options);
    if (h.status == SGT_MISS && first.status > 0) fail_on("tolerance: a miss", f, ray, options.t_tol, first);
    if (h.status != SGT_HIT) return;
    const quad before = exact_g(f, ray, quad(h.t) - h.t_err), behind = exact_g(f, ray, quad(h.t) + h.t_err);
    if ((before > 0) == (behind > 0))
        fail_on("tolerance: no change of sign at t +- t_err", f, ray, options.t_tol, h);
    if (first.status == SGT_HIT && !(std::fabs(h.t - first.t) <= h.t_err + first.t_err))
        fail_on("tolerance: another root", f, ray, first.t, h);
    if (!(h.t_err <= 8 * options.t_tol + 4 * first.t_err))
        fail_on("tolerance: t_err is far above it", f, ray, options.t_tol, h);
    counted["tolerances"]++;
    if (first.status == SGT_HIT)
        counted["tolerances: evaluations with one"] += h.evals,
            counted["tolerances: evaluations without"] += first.evals;
}

void rays(generator &g, long count)
{
    static sgt_hit hit[most];
    long undecided = 0, with_roots = 0;
    for (long i = 0; i < count; i++) {
        const level f = any_level(g);
        sgt_mandelbrot m;
        const sgt_surface s = as_surface(f, &m);
        for (int k = 0; k < 4; k++) {
            sgt_ray ray = random_ray(g, f);
            if (g.chance(0.2)) ray.tmin = -HUGE_VAL, ray.tmax = HUGE_VAL;
            else if (g.chance(0.1)) {
                const double unit = 1 / axis_length(f) / length(ray.d);
                ray.tmin = g.uniform(-2, 4) * unit, ray.tmax = ray.tmin + g.log_uniform(0.1, 4) * unit;
            }
            const int n = sgt_intersect_all(s, ray, most, hit, nullptr);
            if (n < 0 || n > most) {
                fail_on("all: invalid, or more than a set can have", f, ray, n);
                continue;
            }
            check_list(f, s, ray, n, hit, g, 200);
            for (int j = 0; j < n; j++) undecided += hit[j].status < 0;
            with_roots += n > 0;
            const sgt_hit first = sgt_intersect(s, ray, nullptr);
            if (first.status > 0) check_hit(f, s, ray, first, g, "first");
            else counted["first: " + std::string(sgt_status_text(first.status))]++;
            if ((n == 0) != (first.status == SGT_MISS))
                fail_on("first: a miss where all says otherwise", f, ray, n, first);
            if (n > 0 && hit[0].status > 0 &&
                !(first.status > 0 && std::fabs(first.t - hit[0].t) <= first.t_err + hit[0].t_err))
                fail_on("first: not the first of all", f, ray, hit[0].t, first);
            check_restart(f, s, ray, n, hit);
            check_tolerance(f, s, ray, first, g);
            if (k == 0) check_fast(f, s, ray, n, hit, g);
        }
    }
    std::printf("%ld rays, %ld with an entry, %ld undecided stretches\n", 4 * count, with_roots, undecided);
    if (!many && double(undecided) > 1 + 1e-3 * double(count)) failed["too many undecided stretches"]++;
    if (4 * with_roots < count) failed["too few rays with a root"]++;
    if (!many && counted["tolerances: evaluations with one"] > counted["tolerances: evaluations without"])
        failed["a coarse tolerance is not cheap"]++;
}

// First hits of many levels.  The surface may be finer than doubles tell.  Then many roots are within t_err
// of t, and the gradient at p says nothing of the side.  What has to hold: nothing inside lies before t -
// t_err, nor anywhere on a ray that misses; there is a root within t_err.  And the levels lie in each other,
// so a ray meets level N + 1 not before level N.
void first_hits(generator &g, long count)
{
    for (long i = 0; i < count; i++) {
        level f = any_level(g);
        sgt_mandelbrot m;
        const sgt_ray ray = random_ray(g, f);
        const double unit = 1 / axis_length(f) / length(ray.d);
        sgt_options options = {};
        if (g.chance(0.2)) options.proof = SGT_PROVE_FIRST;
        else if (g.chance(0.2)) options.t_tol = g.log_uniform(1e-12, 1e-3) * unit;
        const std::string by = "many, N " + std::string(f.s.iterations > 100 ? "> 100" : "<= 100") +
                               (options.proof != SGT_ESTIMATE ? ", proof" : "");
        const sgt_hit h = sgt_intersect(as_surface(f, &m), ray, &options);
        counted[by + ": " + sgt_status_text(h.status)]++;
        if (h.status == SGT_INVALID) fail_on("many: valid input called invalid", f, ray, h.t, h);
        if (f.s.iterations > 100) { // a ray that misses level 100 misses what lies inside
            level hundred = f;
            hundred.s.iterations = 100;
            if (sgt_intersect(as_surface(hundred, &m), ray, &options).status == SGT_MISS)
                counted[h.status == SGT_MISS ? "many: misses of level 100, and N"
                                             : "many: misses of level 100 only"]++;
            as_surface(f, &m);
        }
        if (h.status != SGT_HIT && h.status != SGT_MISS) continue;
        const double off = std::sqrt(ray.o.x * ray.o.x + ray.o.y * ray.o.y + ray.o.z * ray.o.z),
                     by_d = length(ray.d),
                     middle = -(ray.o.x * ray.d.x + ray.o.y * ray.d.y + ray.o.z * ray.d.z) / (by_d * by_d),
                     reach = std::min(off, 5 / axis_length(f)) / by_d + 3 * unit,
                     lo = std::max(0.0, middle - reach),
                     end = h.status == SGT_HIT ? h.t - h.t_err : middle + reach;
        // A ray that starts inside meets the set where it leaves.
        const bool within = excess(f, ray.o.x, ray.o.y, ray.o.z) < 0;
        for (int k = 0; k < 200 && lo < end; k++) {
            const double part = k % 2 ? g.uniform(0, 1) : g.log_uniform(1e-15, 1),
                         t = end - (end - lo) * part,
                         x = ray.o.x + t * ray.d.x, y = ray.o.y + t * ray.d.y, z = ray.o.z + t * ray.d.z,
                         there = excess(f, x, y, z);
            if (h.status == SGT_HIT && !(quad(t) < quad(h.t) - h.t_err)) continue; // from afar t is coarse
            if ((there < 0) == within || !(t > 16 * 0x1p-53 * off / by_d)) continue;
            if ((exact_g(f, ray, t) < 0) != within && (exact_g(f, ray, 0) < 0) == within)
                fail_on("many: a root before the first", f, ray, t, h);
        }
        if (h.status == SGT_MISS) { // and it misses what lies inside
            level next = f;
            next.s.iterations++;
            const sgt_hit behind = sgt_intersect(as_surface(next, &m), ray, &options);
            counted[behind.status == SGT_MISS ? "many: misses of level N + 1, too"
                                              : "many: misses that are not"]++;
            if (behind.status > 0) fail_on("many: level N missed, level N + 1 met", f, ray, behind.t, h);
            continue;
        }
        bool in = false, out = false;
        for (int k = 0; k <= 64 && !(in && out); k++) {
            const quad there = exact_g(f, ray, quad(h.t) + quad(h.t_err) * (k % 2 ? k + 1 : -k) / 64);
            in = in || !(there > 0), out = out || !(there < 0);
        }
        counted[in && out ? "many: roots confirmed" : "many: roots not confirmed"]++;
        if (!(in && out)) fail_on("many: no root within t_err", f, ray, h.t, h);
        const vector3 at = along(ray, quad(h.t) + h.t_lo);
        if (!(to_double(norm(minus(at, widen(h.p)))) <= h.p_err + h.t_err * by_d))
            fail_on("many: p is not at t", f, ray, h.t, h);
        if (!finite(h.n)) fail_on("many: a hit of no numbers", f, ray, h.t, h);
        level next = f;
        next.s.iterations++;
        const sgt_hit behind = sgt_intersect(as_surface(next, &m), ray, &options);
        if (!within && behind.status == SGT_HIT && behind.t + behind.t_err < h.t - h.t_err)
            fail_on("many: level N + 1 before level N", f, ray, behind.t, h);
        counted["many: level N + 1 not before level N"]++;
    }
    if (10 * counted["many: misses of level 100 only"] > 10 + counted["many: misses of level 100, and N"])
        failed["many: misses of level 100 that level N cannot tell"]++;
    if (10 * counted["many: misses that are not"] > 20 + counted["many: misses of level N + 1, too"])
        failed["many: misses of level N that level N + 1 cannot tell"]++;
}

// ---------------------------------------------------------- scale and symmetry

bool same_bits(double a, double b) { return std::memcmp(&a, &b, sizeof a) == 0; }

// The same but for units: axes 2^-k, the ray's place 2^k, its direction 2^j.
void units(generator &g, long count)
{
    static const int powers[] = {1, -1, 7, -40, 150, -200};
    static sgt_hit hit[most], other[most];
    for (long i = 0; i < count; i++) {
        const level f = any_level(g);
        sgt_mandelbrot m;
        const sgt_surface s = as_surface(f, &m);
        const sgt_ray ray = random_ray(g, f);
        const int n = sgt_intersect_all(s, ray, most, hit, nullptr);
        const sgt_hit first = sgt_intersect(s, ray, nullptr);
        const int k = powers[g.below(6)], j = powers[g.below(6)];
        level f2 = f;
        for (double *a : {f2.s.ex, f2.s.ey, f2.s.ez})
            for (int c = 0; c < 4; c++) a[c] = std::ldexp(a[c], -k);
        sgt_mandelbrot m2;
        const sgt_surface s2 = as_surface(f2, &m2);
        const auto scaled = [](const sgt_vec3 &v, int by) {
            return sgt_vec3{std::ldexp(v.x, by), std::ldexp(v.y, by), std::ldexp(v.z, by)};
        };
        const sgt_ray ray2 = {scaled(ray.o, k), scaled(ray.d, k + j), 0, 0};
        const int n2 = sgt_intersect_all(s2, ray2, most, other, nullptr);
        sgt_hit first2 = sgt_intersect(s2, ray2, nullptr);
        if (n != n2) fail_on("units: another number of entries", f2, ray2, n);
        const auto compare = [&](const sgt_hit &a, const sgt_hit &b) {
            const bool same = a.status == b.status &&
                              (a.status == SGT_MISS || (same_bits(a.t, std::ldexp(b.t, j)) &&
                                                        same_bits(a.t_err, std::ldexp(b.t_err, j)) &&
                                                        same_bits(a.t_lo, std::ldexp(b.t_lo, j)))) &&
                              (a.status <= 0 || (same_bits(a.p.x, std::ldexp(b.p.x, -k)) &&
                                                 same_bits(a.n.x, std::ldexp(b.n.x, k)) &&
                                                 same_bits(a.p_err, std::ldexp(b.p_err, -k))));
            if (!same) fail_on("units: another answer in other units", f2, ray2, a.t, b);
        };
        for (int e = 0; e < n && e < n2; e++) compare(hit[e], other[e]);
        compare(first, first2);
        counted["units"]++;
    }
}

// Level sets that are one another's image: lists must match within their errors.
void symmetries(generator &g, long count)
{
    static sgt_hit hit[most], other[most];
    for (long i = 0; i < count; i++) {
        const level f = any_level(g);
        sgt_mandelbrot m, m2;
        const sgt_surface s = as_surface(f, &m);
        sgt_ray ray = random_ray(g, f), ray2 = ray;
        level f2 = f;
        double *const list[] = {f2.s.c, f2.s.at, f2.s.ex, f2.s.ey, f2.s.ez};
        const int kind = g.below(4);
        const char *const name[] = {"symmetry: mirrored", "symmetry: conjugate", "symmetry: i to j to k",
                                    "symmetry: half a turn"};
        if (kind == 0) { // Q to -Q: with c for even p, -c for odd, and with the ray mirrored, not the axes
            if (f.mandelbrot && f.s.power % 2 == 0) continue;
            for (double &a : f2.s.at) a = -a;
            if (f.s.power % 2)
                for (double &a : f2.s.c) a = -a;
            ray2.o = {-ray.o.x, -ray.o.y, -ray.o.z};
            ray2.d = {-ray.d.x, -ray.d.y, -ray.d.z};
        } else
            for (double *v : list) {
                if (kind == 1) v[1] = -v[1], v[2] = -v[2], v[3] = -v[3];
                if (kind == 2) {
                    const double first = v[1];
                    v[1] = v[3], v[3] = v[2], v[2] = first;
                }
                if (kind == 3) v[1] = -v[1], v[2] = -v[2];
            }
        const sgt_surface s2 = as_surface(f2, &m2);
        const int n = sgt_intersect_all(s, ray, most, hit, nullptr),
                  n2 = sgt_intersect_all(s2, ray2, most, other, nullptr);
        bool plain = n == n2;
        for (int e = 0; e < n; e++) plain = plain && hit[e].status == SGT_HIT;
        for (int e = 0; e < n2; e++) plain = plain && other[e].status == SGT_HIT;
        if (n != n2) {
            bool grazes = false; // what touches may be a graze, two hits or a stretch
            for (int e = 0; e < n; e++) grazes = grazes || hit[e].status != SGT_HIT;
            for (int e = 0; e < n2; e++) grazes = grazes || other[e].status != SGT_HIT;
            if (!grazes) fail_on(std::string(name[kind]) + ", another number of roots", f, ray, n2);
        }
        if (!plain) continue;
        for (int e = 0; e < n; e++) {
            if (!(std::fabs(hit[e].t - other[e].t) <= hit[e].t_err + other[e].t_err))
                fail_on(name[kind], f, ray, other[e].t, hit[e]);
            if (kind == 0 && !same_bits(hit[e].t, other[e].t))
                fail_on("symmetry: mirrored, other bits", f, ray, other[e].t, hit[e]);
        }
        counted[name[kind]]++;
    }
}

} // namespace

int main(int argc, char **argv)
{
    const run r(argc, argv, 1000, 314159);
    const auto began = std::chrono::steady_clock::now();
    double last = 0;
    generator g(r.seed);
    const auto section = [&](const char *name, void (*test)(generator &, long), long count) {
        test(g, count);
        const double now = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
        std::printf("%-20s %6ld cases, %.1f s\n", name, count, now - last);
        last = now;
    };
    section("values", values, 10 * r.count);
    section("gradients", gradients, r.count / 2 + 1);
    section("potentials", potentials, r.count);
    section("far and deep", nothing_overflows, 2 * r.count);
    section("enclosures", enclosures, r.count);
    section("rays", rays, r.count / 5 + 1);
    section("units", units, r.count / 2 + 1);
    section("symmetries", symmetries, r.count / 2 + 1);
    many = true;
    section("many: values", values, r.count / 4 + 1);
    section("many: gradients", gradients, r.count / 10 + 1);
    section("many: potentials", potentials, r.count / 20 + 1);
    section("many: far and deep", nothing_overflows, r.count + 1);
    section("many: enclosures", enclosures, r.count / 2 + 1);
    section("many: first hits", first_hits, r.count / 2 + 1);
    section("many: units", units, r.count / 100 + 1);
    std::printf("%-60s %9s %9s %9s %9s\n", "", "number", "median", "99 %", "most");
    for (auto &e : ratios)
        std::printf("%-60s %9zu %9.3g %9.3g %9.3g\n", e.first.c_str(), e.second.size(),
                    quantile(e.second, 0.5), quantile(e.second, 0.99), quantile(e.second, 1));
    for (const auto &e : counted) std::printf("  %9ld  %s\n", e.second, e.first.c_str());
    for (const auto &e : failed) std::printf("  FAIL %9ld  %s\n", e.second, e.first.c_str());
    std::printf("%.1f s\n", std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count());
    return !failed.empty();
}
