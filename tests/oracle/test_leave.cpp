// SPDX-License-Identifier: MIT
// sgt_leave and sgt_leave_batch: particles that go from crossing to crossing, against signs in 113 bits.
//
// A thousand particles at a time go through a world: a gyroid in a ball of ten cells, a thin torus (R = 139,
// r = 1), nested spheres and Clebsch's cubic as formulas, and as built-in types a quadric, an ellipsoid, a
// hyperboloid, a ring and a spindle.
// At each crossing they go straight on; every tenth time, in a new direction of the whole sphere.  One that
// misses turns where it was, into a new direction; one in 64 of these, and what is undecided, begins anew
// from outside.  Asked of every crossing:
//
//     the side it starts on is that of the slope at the start, where that is not nearly 0
//     the next crossing is one to the other side: the slope there has the other sign
//     t is above 0
//
// Of some of them: F in 113 bits has the sign of the side at points all along the way, up to the crossing,
// and the other sign right behind it.  A miss is looked at as far as the world reaches.  A crossing that was
// lost, or met twice, shows as a wrong sign.  Undecided answers are printed, with the slope at the start.
//
// Conics with a rim are left against their equation in 113 bits, even aspheres, also random ones, against
// their roots in quad.h: as by sgt_leave, and as by sgt_intersect.
//
// Rows by hand: starts within 1e-8 of a torus, exits along tangents, the vertex of a sag, starts on a
// coordinate plane, what makes no sense.  A batch has the bits of single starts.
//
//     test_leave               SAGITTA_TEST_SCALE, SAGITTA_TEST_SEED as everywhere
//     test_leave --steps N     N crossings in each world, and times, against those of first hits
//     test_leave --steps N WORLD     in those worlds whose names begin so
#include "../../src/truth/elementary.hpp"
#include "../batch/soil.h"
#include "quad.h"

#include <sagitta/formula.h>
#include <sagitta/surfaces.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <deque>
#include <functional>
#include <random>
#include <string>
#include <vector>

using oracle::quad;

namespace
{

int failures = 0;
std::mt19937_64 bits;

double uniform(double lo, double hi) { return std::uniform_real_distribution<double>(lo, hi)(bits); }

sgt_vec3 direction()
{
    for (;;) {
        const sgt_vec3 v = {uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)};
        const double r2 = v.x * v.x + v.y * v.y + v.z * v.z;
        if (r2 > 1 || r2 < 1e-4) continue;
        const double r = std::sqrt(r2);
        return {v.x / r, v.y / r, v.z / r};
    }
}

double dot(sgt_vec3 a, sgt_vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
double length(sgt_vec3 a) { return std::sqrt(dot(a, a)); }
double now() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

struct World {
    const char *name;
    sgt_surface s;
    double reach; // no part of the surface is farther from the origin
    std::function<quad(quad, quad, quad)> f;
};

// Reads the text, whose tape lasts until the program ends.
sgt_surface formula(const char *text, double ball)
{
    struct Read {
        sgt_formula f;
        std::vector<double> room;
    };
    static std::deque<Read> kept;
    const size_t size = sgt_formula_room(text, 0);
    kept.push_back({{}, std::vector<double>(size / sizeof(double) + 1)});
    Read &own = kept.back();
    own.f.tape = sgt_formula_read(text, SGT_FORMULA_XYZ, 0, nullptr, own.room.data(), size, nullptr);
    own.f.ball = ball;
    return {&sgt_formula_ops, &own.f};
}

std::vector<World> worlds()
{
    static const sgt_torus torus = {139, 1}, ring = {3, 1}, spindle = {1, 2};
    static const sgt_quadric quadric = {{1, 0.25, 0.5}, {0.1, 0.05, 0.2}, {0, 0, 0}, -1};
    static const sgt_quadric sheets = {{1, 1.5, -1}, {0, 0, 0}, {0, 0, 0}, -1};
    static const sgt_ellipsoid ellipsoid = {1.5, 0.25};
    return {{"gyroid in a ball of ten cells",
             formula("sin(x)*cos(y) + sin(y)*cos(z) + sin(z)*cos(x) = 0", 62.8), 62.8,
             [](quad x, quad y, quad z) {
                 using oracle::cosine_of;
                 using oracle::sine_of;
                 return sine_of(x) * cosine_of(y) + sine_of(y) * cosine_of(z) + sine_of(z) * cosine_of(x);
             }},
            {"torus, R = 139, r = 1",
             {&sgt_torus_ops, &torus},
             140,
             [](quad x, quad y, quad z) {
                 const quad off = oracle::square_root(x * x + y * y) - 139;
                 return off * off + z * z - 1;
             }},
            {"nested spheres",
             formula("(x^2 + y^2 + z^2 - 1)*(x^2 + y^2 + z^2 - 4)*(x^2 + y^2 + z^2 - 9) = 0", 4), 3,
             [](quad x, quad y, quad z) {
                 const quad r2 = x * x + y * y + z * z;
                 return (r2 - 1) * (r2 - 4) * (r2 - 9);
             }},
            {"Clebsch's cubic in a ball",
             formula("81*(x^3 + y^3 + z^3) - 189*(x^2*(y + z) + y^2*(x + z) + z^2*(x + y)) + 54*x*y*z"
                     " + 126*(x*y + x*z + y*z) - 9*(x^2 + y^2 + z^2) - 9*(x + y + z) + 1",
                     1.6),
             1.6,
             [](quad x, quad y, quad z) {
                 return 81 * (x * x * x + y * y * y + z * z * z) -
                        189 * (x * x * (y + z) + y * y * (x + z) + z * z * (x + y)) + 54 * x * y * z +
                        126 * (x * y + x * z + y * z) - 9 * (x * x + y * y + z * z) - 9 * (x + y + z) + 1;
             }},
            {"quadric",
             {&sgt_quadric_ops, &quadric},
             3,
             [](quad x, quad y, quad z) {
                 return x * x + y * y / 4 + z * z / 2 + quad(0.1) * x * y + quad(0.05) * y * z +
                        quad(0.2) * x * z - 1;
             }},
            {"ellipsoid",
             {&sgt_ellipsoid_ops, &ellipsoid},
             1.5,
             [](quad x, quad y, quad z) {
                 const quad w = z / quad(0.75);
                 return x * x + y * y + w * w - quad(1.5) * quad(1.5);
             }},
            {"hyperboloid",
             {&sgt_quadric_ops, &sheets},
             3,
             [](quad x, quad y, quad z) { return x * x + quad(1.5) * y * y - z * z - 1; }},
            {"ring, R = 3, r = 1",
             {&sgt_torus_ops, &ring},
             4,
             [](quad x, quad y, quad z) {
                 const quad off = oracle::square_root(x * x + y * y) - 3;
                 return off * off + z * z - 1;
             }},
            {"spindle, R = 1, r = 2", {&sgt_torus_ops, &spindle}, 3, [](quad x, quad y, quad z) {
                 const quad sum = x * x + y * y + z * z + 1 - 4;
                 return sum * sum - 4 * (x * x + y * y);
             }}};
}

int sign_of(quad x) { return (x > 0) - (x < 0); }

int sign_at(const World &w, sgt_vec3 p, sgt_vec3 d, double t)
{
    return sign_of(w.f(p.x + quad(t) * d.x, p.y + quad(t) * d.y, p.z + quad(t) * d.z));
}

bool complain(const World &w, const char *what, const sgt_start &a, double t, int side)
{
    if (failures++ < 20)
        std::printf("%s: %s, from %a %a %a p_err %a along %a %a %a: t %a side %d, slope %g\n", w.name, what,
                    a.p.x, a.p.y, a.p.z, a.p_err, a.d.x, a.d.y, a.d.z, t, side, dot(a.n, a.d));
    return false;
}

// Is F of that side all the way from the start to t, or over the world?  `skip`: what is not looked at near
// the ends.
bool way_right(const World &w, const sgt_start &a, sgt_status status, double t, int side, double skip)
{
    const double along = dot(a.p, a.d), left = along * along - (dot(a.p, a.p) - w.reach * w.reach);
    const double end = status > 0 ? t - skip : (std::sqrt(left > 0 ? left : 0) - along) * (1 - 1e-9);
    for (int i = 0; i <= 24; i++) {
        const double at = skip + (end - skip) * (i == 0 ? 0 : i == 24 ? 1 : uniform(0, 1));
        if (at > skip * 0.99 && at <= end && sign_at(w, a.p, a.d, at) != side)
            return complain(w, "F is of the other side on the way", a, at, side);
    }
    if (status == SGT_HIT && sign_at(w, a.p, a.d, t + skip) == side && t > 4 * skip)
        return complain(w, "F does not change its sign at the crossing", a, t, side);
    return true;
}

struct Counts {
    long steps, hits, misses, undecided, unsided, checked, lost, evals;
};

void walk(const World &w, long steps, long checks, bool timed)
{
    enum { N = 1000 };
    std::vector<double> column[3][3], plain[6];
    for (auto &group : column)
        for (auto &c : group) c.assign(N, 0);
    for (auto &c : plain) c.assign(N, 0);
    std::vector<double>(&p)[3] = column[0], (&n)[3] = column[1], (&d)[3] = column[2];
    std::vector<double> &p_err = plain[0], &t = plain[1], new_p[3] = {plain[2], plain[3], plain[4]},
                        &new_err = plain[5];
    std::vector<double> new_n[3] = {p_err, p_err, p_err}, t_err = p_err;
    std::vector<sgt_status> status(N);
    std::vector<int> evals(N);
    std::vector<signed char> side(N);
    Counts c = {};
    double spent = 0, first = 0;
    long firsts = 0;
    const auto begin = [&](size_t i) { // from outside, onto the surface
        for (int trial = 0;; trial++) {
            const sgt_vec3 from = direction(), to = direction();
            const double k = w.reach * std::cbrt(uniform(0, 1));
            sgt_vec3 o = {3 * w.reach * from.x, 3 * w.reach * from.y, 3 * w.reach * from.z},
                     along = {k * to.x - o.x, k * to.y - o.y, k * to.z - o.z};
            const double by = length(along);
            along = {along.x / by, along.y / by, along.z / by};
            const sgt_hit hit = sgt_intersect(w.s, {o, along, 0, 0}, nullptr);
            if (hit.status != SGT_HIT) continue;
            const double at[3] = {hit.p.x, hit.p.y, hit.p.z}, grad[3] = {hit.n.x, hit.n.y, hit.n.z},
                         way[3] = {along.x, along.y, along.z};
            for (int k2 = 0; k2 < 3; k2++) p[k2][i] = at[k2], n[k2][i] = grad[k2], d[k2][i] = way[k2];
            p_err[i] = hit.p_err;
            return;
        }
    };
    for (size_t i = 0; i < N; i++) begin(i);
    if (timed) { // a first hit, for comparison: from outside toward a point of the surface
        std::vector<double> o[3] = {t, t, t}, e[3] = {t, t, t};
        for (size_t i = 0; i < N; i++) {
            const sgt_vec3 from = direction();
            const double a[3] = {3 * w.reach * from.x, 3 * w.reach * from.y, 3 * w.reach * from.z};
            for (int j = 0; j < 3; j++) o[j][i] = a[j], e[j][i] = p[j][i] - a[j];
        }
        const sgt_rays rays = {{o[0].data(), o[1].data(), o[2].data()},
                               {e[0].data(), e[1].data(), e[2].data()},
                               nullptr,
                               nullptr};
        sgt_hits hits = {};
        hits.status = status.data(), hits.t = t.data(), hits.p_err = new_err.data();
        for (int k = 0; k < 3; k++) hits.p[k] = new_p[k].data(), hits.n[k] = new_n[k].data();
        for (int k = 0; k < 20; k++) {
            const double at = now();
            sgt_intersect_batch(w.s, N, rays, hits, nullptr);
            first += now() - at, firsts += N;
        }
    }
    while (c.steps < steps) {
        const sgt_starts from = {{p[0].data(), p[1].data(), p[2].data()},
                                 {n[0].data(), n[1].data(), n[2].data()},
                                 p_err.data(),
                                 {d[0].data(), d[1].data(), d[2].data()},
                                 nullptr,
                                 {}};
        sgt_hits hits = {};
        hits.status = status.data(), hits.t = t.data(), hits.p_err = new_err.data();
        hits.evals = evals.data(), hits.t_err = t_err.data();
        for (int k = 0; k < 3; k++) hits.p[k] = new_p[k].data(), hits.n[k] = new_n[k].data();
        const double at = now();
        sgt_leave_batch(w.s, N, from, hits, side.data(), nullptr);
        spent += now() - at;
        const bool check = c.checked * steps < c.steps * checks + checks;
        for (size_t i = 0; i < N; i++) {
            const sgt_start a = {{p[0][i], p[1][i], p[2][i]},
                                 {n[0][i], n[1][i], n[2][i]},
                                 p_err[i],
                                 {d[0][i], d[1][i], d[2][i]},
                                 0,
                                 {}};
            const double slope = dot(a.n, a.d), steep = std::fabs(slope) / length(a.n);
            c.steps++, c.evals += evals[i];
            c.hits += status[i] > 0, c.misses += status[i] == 0, c.undecided += status[i] < 0,
                c.unsided += status[i] >= 0 && side[i] == 0;
            if (status[i] < 0) {
                std::printf("%s: %s, from %a %a %a along %a %a %a, slope %g\n", w.name,
                            sgt_status_text(status[i]), a.p.x, a.p.y, a.p.z, a.d.x, a.d.y, a.d.z, steep);
                if (steep > 1e-5) complain(w, "undecided", a, 0, 0);
            } else {
                bool right = true;
                if (steep > 1e-4 && side[i] != (slope > 0 ? 1 : -1))
                    right = complain(w, "wrong side", a, t[i], side[i]);
                if (status[i] > 0 && !(t[i] > 0)) right = complain(w, "t is not above 0", a, t[i], side[i]);
                const sgt_vec3 m = {new_n[0][i], new_n[1][i], new_n[2][i]};
                const double falls = dot(m, a.d) / length(m);
                if (status[i] == SGT_HIT && std::fabs(falls) > 1e-5 && falls * side[i] > 0)
                    right = complain(w, "the crossing is from the other side", a, t[i], side[i]);
                if (check && side[i] != 0) {
                    const double to = status[i] > 0 ? t[i] : 0, err = status[i] > 0 ? t_err[i] : 0,
                                 start = (a.p_err + 1e-15 * length(a.p)) / (steep + 1e-300);
                    const double skip = start + err + 1e-12 * (w.reach + to) / std::min(1.0, steep + 1e-4);
                    right = way_right(w, a, status[i], status[i] > 0 ? t[i] : 0, side[i], skip) && right;
                    c.checked++;
                }
                c.lost += !right;
            }
            if (status[i] > 0) {
                for (int k = 0; k < 3; k++) p[k][i] = new_p[k][i], n[k][i] = new_n[k][i];
                p_err[i] = new_err[i];
                if (bits() % 10 == 0) {
                    const sgt_vec3 v = direction();
                    d[0][i] = v.x, d[1][i] = v.y, d[2][i] = v.z;
                }
            } else if (status[i] == SGT_MISS && bits() % 64 != 0) {
                const sgt_vec3 v = direction();
                d[0][i] = v.x, d[1][i] = v.y, d[2][i] = v.z;
            } else
                begin(i);
        }
    }
    std::printf(
        "%s: %ld crossings and misses, %ld met, %ld undecided, %ld without a side, %ld lost or wrong, %ld in "
        "113 bits; %.1f evaluations each",
        w.name, c.steps, c.hits, c.undecided, c.unsided, c.lost, c.checked,
        static_cast<double>(c.evals) / static_cast<double>(c.steps));
    if (timed)
        std::printf("; %.0f ns each, %.0f a first hit", spent / static_cast<double>(c.steps) * 1e9,
                    first / static_cast<double>(firsts) * 1e9);
    std::puts("");
    if (static_cast<double>(c.undecided + c.unsided) > 1 + 1e-7 * static_cast<double>(c.steps))
        std::printf("%s: too many undecided\n", w.name), failures++;
}

bool same_bits(double a, double b) { return std::memcmp(&a, &b, sizeof a) == 0 || (a != a && b != b); }

// A batch of these, against each alone.  Every number has the same bits.
void batch_is_single(const World &w, const std::vector<sgt_start> &starts, const sgt_options *opt)
{
    const size_t n = starts.size();
    std::vector<double> in[11], out[9];
    for (auto &c : in) c.resize(n);
    for (auto &c : out) c.resize(n);
    std::vector<sgt_status> status(n);
    std::vector<int> evals(n);
    std::vector<signed char> side(n);
    for (size_t i = 0; i < n; i++) {
        const sgt_start &a = starts[i];
        const double row[11] = {a.p.x, a.p.y, a.p.z, a.n.x,   a.n.y, a.n.z,
                                a.d.x, a.d.y, a.d.z, a.p_err, a.tmax};
        for (int k = 0; k < 11; k++) in[k][i] = row[k];
    }
    const sgt_starts from = {{in[0].data(), in[1].data(), in[2].data()},
                             {in[3].data(), in[4].data(), in[5].data()},
                             in[9].data(),
                             {in[6].data(), in[7].data(), in[8].data()},
                             in[10].data(),
                             {}};
    const sgt_hits hits = {status.data(),
                           evals.data(),
                           out[0].data(),
                           out[1].data(),
                           out[2].data(),
                           {out[3].data(), out[4].data(), out[5].data()},
                           {out[6].data(), out[7].data(), out[8].data()},
                           nullptr,
                           {}};
    soil_stack(bits());
    const size_t met = sgt_leave_batch(w.s, n, from, hits, side.data(), opt);
    size_t count = 0;
    for (size_t i = 0; i < n; i++) {
        const sgt_crossing c = sgt_leave(w.s, &starts[i], opt);
        const double row[9] = {c.hit.t,   c.hit.t_err, c.hit.t_lo, c.hit.p.x, c.hit.p.y,
                               c.hit.p.z, c.hit.n.x,   c.hit.n.y,  c.hit.n.z};
        bool same = c.hit.status == status[i] && c.side == side[i] && c.hit.evals == evals[i];
        for (int k = 0; k < 9; k++) same = same && same_bits(row[k], out[k][i]);
        count += c.hit.status > 0;
        if (!same) complain(w, "a batch has other bits", starts[i], c.hit.t, c.side);
    }
    if (count != met) std::printf("%s: %zu met, said %zu\n", w.name, count, met), failures++;
}

void require(bool good, const char *what)
{
    if (!good) std::printf("%s\n", what), failures++;
}

sgt_vec3 moved(sgt_vec3 p, double t, sgt_vec3 d) { return {p.x + t * d.x, p.y + t * d.y, p.z + t * d.z}; }

// Points beside the surface that p_err covers, by up to 1e-8; and tangents, exactly and nearly.  A particle
// that is pushed by an epsilon is lost or stuck at these.
void beside_and_along(const World &w, int count)
{
    std::vector<sgt_start> starts;
    int undecided = 0;
    for (int i = 0, trials = 0; i < count && trials < 100 * count; trials++) {
        const sgt_vec3 from = direction(), to = direction();
        const double k = w.reach * std::cbrt(uniform(0, 1));
        const sgt_vec3 o = {3 * w.reach * from.x, 3 * w.reach * from.y, 3 * w.reach * from.z};
        const sgt_hit hit =
            sgt_intersect(w.s, {o, {k * to.x - o.x, k * to.y - o.y, k * to.z - o.z}, 0, 0}, nullptr);
        if (hit.status != SGT_HIT) continue;
        i++;
        const double size = length(hit.n), off = (i % 2 ? 1 : -1) * 1e-8 * std::pow(10, -uniform(0, 7));
        const sgt_vec3 unit = {hit.n.x / size, hit.n.y / size, hit.n.z / size};
        sgt_start a = {moved(hit.p, off, unit), hit.n, 1.5 * std::fabs(off) + hit.p_err, direction(), 0, {}};
        if (i % 3 == 0) a.n = {0, 0, 0};
        if (i % 3 == 1) a.n = {-3 * hit.n.x, -3 * hit.n.y, -3 * hit.n.z};
        const bool tangent = i % 4 == 3;
        if (tangent) { // at an angle from 1e-3 to 1e-12
            a.p = hit.p, a.p_err = hit.p_err;
            a.d = moved(a.d, -dot(a.d, unit), unit);
            const double by = length(a.d);
            a.d = moved({a.d.x / by, a.d.y / by, a.d.z / by},
                        (i % 8 == 3 ? 1 : -1) * std::pow(10, -uniform(3, 12)), unit);
        }
        const sgt_crossing c = sgt_leave(w.s, &a, nullptr);
        const double slope = dot(unit, a.d);
        starts.push_back(a);
        if (c.hit.status < 0) {
            if (std::fabs(slope) > 1e-5) complain(w, "undecided", a, 0, 0);
            undecided++;
            continue;
        }
        const sgt_vec3 way = {c.ray.o.x - a.p.x, c.ray.o.y - a.p.y, c.ray.o.z - a.p.z};
        if (length(way) > a.p_err + 1e-15 * w.reach)
            complain(w, "the start has moved too far", a, c.hit.t, c.side);
        if (std::fabs(slope) > 1e-3 && c.side != (slope > 0 ? 1 : -1))
            complain(w, "wrong side", a, c.hit.t, c.side);
        if (c.side == 0) continue;
        a.p = c.ray.o;
        const double way_to = c.hit.status > 0 ? c.hit.t : 0,
                     skip = 1e-12 * (w.reach + way_to) / (std::fabs(slope) + 1e-7) +
                            (c.hit.status > 0 ? c.hit.t_err : 0);
        way_right(w, a, c.hit.status, c.hit.status > 0 ? c.hit.t : 0, c.side, skip);
    }
    batch_is_single(w, starts, nullptr);
    std::printf("%s: %zu starts beside it and along tangents, %d undecided\n", w.name, starts.size(),
                undecided);
}

// Conics with a rim, left from points on them: the roots of c (r^2 + (1 + k) z^2) = 2 z along the ray, in 113
// bits, without the one at the start.  What is decided has to be the first of them that is on the sheet and
// within the rim, within t_err; a root nearer to either than a part in 2^40 is not judged.
void bowls(int count)
{
    static const double kinds[][3] = {{0.1, 0, 8},   {0.2, -1, 10}, {0.2, -2.5, 8},   {-0.05, 1.5, 9},
                                      {0.4, 0, 2.4}, {1e-3, 0, 30}, {-0.2, -1.01, 0}, {0.1, 0, 0}};
    for (const auto &kind : kinds) {
        static sgt_conic conic;
        conic = {};
        conic.c = kind[0], conic.k = kind[1], conic.semi_diameter = kind[2];
        const World w = {"conic", {&sgt_conic_ops, &conic}, kind[2] > 0 ? kind[2] : 6, nullptr};
        const quad c = kind[0], k1 = 1 + quad(kind[1]),
                   rim2 = kind[2] > 0 ? quad(kind[2]) * kind[2] : quad(1e300);
        std::vector<sgt_start> starts;
        int hits = 0, undecided = 0;
        for (int i = 0; i < count; i++) {
            const sgt_vec3 at = direction(), along = {at.y, -at.x, 1e-3 * at.z},
                           d = i % 7 == 0 ? along : direction();
            const double by = 0.99 * w.reach * std::cbrt(uniform(0, 1)) / std::hypot(at.x, at.y);
            sgt_vec3 p = {by * at.x, by * at.y, 0}, n = {0, 0, 0};
            p.z = -w.s.ops->value(w.s.self, p, &n);
            if (!(std::fabs(p.z) < 1e6)) continue;
            w.s.ops->value(w.s.self, p, &n);
            if (i % 3 == 0) p.z *= 1 + 0x1p-53 * uniform(-24, 24);  // by what the rule of the start allows
            const sgt_start a = {p, n, 4e-16 * w.reach, d, 0, {}};
            starts.push_back(a);
            const sgt_crossing next = sgt_leave(w.s, &a, nullptr);
            const sgt_vec3 o = next.ray.o;
            const quad A = c * (quad(d.x) * d.x + quad(d.y) * d.y + k1 * d.z * d.z),
                       B = d.z - c * (quad(o.x) * d.x + quad(o.y) * d.y + k1 * o.z * d.z),
                       C = c * (quad(o.x) * o.x + quad(o.y) * o.y + k1 * o.z * o.z) - 2 * quad(o.z);
            const quad D = B * B - A * C;
            if (next.hit.status < 0 || D < 1e-14 * B * B || A == 0) {
                undecided += next.hit.status < 0;
                continue;
            }
            const quad q = B + (B < 0 ? -1 : 1) * oracle::square_root(D), t = q / A, z = o.z + t * d.z,
                       x = o.x + t * d.x, y = o.y + t * d.y, r2 = x * x + y * y, v = 1 - k1 * c * z;
            const quad narrow = 1e-12;
            // along a tangent: between its roots the ray is no farther from the surface than the start may be
            if (B * B < 8 * (A < 0 ? -A : A) * quad(a.p_err)) continue;
            if ((v < narrow && v > -narrow) || (r2 > rim2 * (1 - narrow) && r2 < rim2 * (1 + narrow)) ||
                (t < 1e-9 && t > -1e-9))
                continue;
            const bool meets = v > 0 && r2 < rim2 && t > 0;
            const quad off = next.hit.t - t;
            hits += meets;
            if (meets != (next.hit.status == SGT_HIT) ||
                (meets && !(off <= next.hit.t_err && -off <= next.hit.t_err)))
                complain(w, "not the other root of the conic", a, next.hit.t, next.side);
            const double slope = dot(n, d) / length(n);
            if (std::fabs(slope) > 1e-3 && next.side != (slope > 0 ? 1 : -1))
                complain(w, "wrong side", a, next.hit.t, next.side);
        }
        batch_is_single(w, starts, nullptr);
        std::printf("conic, c %g, k %g, rim %g: %zu starts, %d met, %d undecided\n", kind[0], kind[1],
                    kind[2], starts.size(), hits, undecided);
        require(undecided == 0, "conic: undecided");
    }
}

// Planes: a line leaves them for good, to the side to which it goes.  In some starts a number makes no sense.
void planes(int count)
{
    for (double rim : {0.0, 5.0}) {
        const sgt_conic flat = {0, 0, rim};
        const World w = {"plane", {&sgt_conic_ops, &flat}, 4, nullptr};
        std::vector<sgt_start> starts;
        for (int i = 0; i < count; i++) {
            sgt_start a = {{uniform(-3, 3), uniform(-3, 3), 0}, {0, 0, 1}, 1e-15, direction(), 0, {}};
            if (i % 8 == 1) a.p.z = uniform(-1e-15, 1e-15);
            if (i % 8 == 2) a.p.x = a.p.y = 0;
            if (i % 16 == 3) a.d.z = 0;
            const bool sound = i % 16 != 7;
            if (!sound && i % 3 == 0) a.p.x = NAN;
            if (!sound && i % 3 == 1) a.p_err = -1;
            if (!sound && i % 3 == 2) a.d = {0, 0, 0};
            starts.push_back(a);
            if (sound && a.d.z == 0) continue; // all of the ray is on the plane
            const sgt_crossing next = sgt_leave(w.s, &a, nullptr);
            const sgt_status due = sound ? SGT_MISS : SGT_INVALID;
            const int side = sound ? (a.d.z > 0) - (a.d.z < 0) : 0;
            if (next.hit.status != due || next.side != side)
                complain(w, "not the way off a plane", a, next.hit.t, next.side);
        }
        batch_is_single(w, starts, nullptr);
    }
}

// The hit of a ray that starts on an asphere: all its roots in 113 bits (quad.h) have to be as the hit says.
// *ulps: by how many u of the largest term a point is off the surface, at most.
void root_right(const World &w, const sgt_even_asphere &kind, const sgt_start &a, const sgt_ray &ray,
                const sgt_hit &hit, const oracle::answer &known, double *ulps)
{
    const bool met = hit.status > 0;
    bool there = !met, before = false;
    for (const oracle::meeting &m : known.roots) {
        const oracle::counts is = oracle::counting(m, ray.tmin, ray.tmax);
        const quad off = m.minus(hit.t);
        const bool same = met && oracle::magnitude(off) <= quad(hit.t_err) + m.blur;
        there = there || (same && is != oracle::no);
        before = before || (is == oracle::yes && !same && (!met || off < 0));
        if (!same) continue;
        const oracle::vector3 p = {hit.p.x, hit.p.y, hit.p.z};
        if (oracle::norm({p.x - m.p.x, p.y - m.p.y, p.z - m.p.z}) >
            quad(hit.p_err) + m.blur * quad(length(a.d)))
            complain(w, "p is farther from the point than p_err", a, hit.t, 0);
        quad largest;
        const quad normal = oracle::normal_error(oracle::surface(kind), p, &largest);
        const double units = largest == 0 ? 0 : oracle::to_double(normal / largest) * 0x1p53;
        *ulps = std::max(*ulps, units);
        if (!(units <= 24)) complain(w, "p is off the surface", a, units, 0);
        const double x = oracle::to_double(m.gradient.x / m.gradient.z),
                     y = oracle::to_double(m.gradient.y / m.gradient.z), size = std::hypot(x, y);
        if (!(std::hypot(hit.n.x - x, hit.n.y - y) <= 1e-10 * (1 + size * size)))
            complain(w, "the gradient is off", a, size, 0);
    }
    if (!there || before) complain(w, "not the next root of the asphere", a, hit.t, 0);
}

// A start on an asphere: by sgt_leave, and as a ray.  Returns the status.
sgt_status asphere_right(const World &w, const sgt_even_asphere &kind, const sgt_start &a, bool outside,
                         double *ulps)
{
    const sgt_crossing next = sgt_leave(w.s, &a, nullptr);
    const sgt_hit plain = sgt_intersect(w.s, next.ray, nullptr);
    if (next.hit.status < 0) return next.hit.status;
    const oracle::answer known = oracle::all_roots(oracle::surface(kind), next.ray);
    if (!known.doubtful.empty() || known.at_fault || known.gave_up) return next.hit.status;
    root_right(w, kind, a, next.ray, next.hit, known, ulps);
    if (plain.status >= 0) root_right(w, kind, a, next.ray, plain, known, ulps);
    const double slope = dot(a.n, a.d) / (length(a.n) * length(a.d));
    if (!outside && std::fabs(slope) > 1e-3 && next.side != (slope > 0 ? 1 : -1))
        complain(w, "wrong side", a, next.hit.t, next.side);
    return next.hit.status;
}

// Even aspheres, left from points on them into the whole sphere and along the surface: terms of both signs,
// with and without a rim.  All roots of next.ray in 113 bits (quad.h) have to be as the answer says.
void aspheres(int count)
{
    static const sgt_even_asphere kinds[] = {{0.1, -0.6, 4, {0, 1e-4, -2e-6, 1e-8}},
                                             {0.1, -0.6, 0, {0, 1e-4, -2e-6, 1e-8}},
                                             {-0.05, 0, 6, {0, -1e-4, 3e-6}},
                                             {0, 0, 5, {0, 2e-4}},
                                             {0.1, -1, 5, {-2e-3, 3e-4, 0, 0, 1e-9}},
                                             {-0.2, 1, 0, {0, 1e-3}}};
    for (const sgt_even_asphere &kind : kinds) {
        const World w = {"asphere", {&sgt_even_asphere_ops, &kind}, 4, nullptr};
        std::vector<sgt_start> starts;
        int hits = 0, undecided = 0;
        double worst = 0;
        for (int i = 0; i < count; i++) {
            const sgt_vec3 at = direction();
            const bool outside = kind.semi_diameter > 0 && i % 4 == 0; // beyond the rim F goes on
            const double r =
                outside ? kind.semi_diameter * uniform(1, 1.4) : 3.5 * std::sqrt(uniform(0, 1));
            const double by = r / std::hypot(at.x, at.y);
            sgt_vec3 p = {by * at.x, by * at.y, 0}, n = {0, 0, 0}, d = direction();
            if (outside) d = {-by * at.x + uniform(-3, 3), -by * at.y + uniform(-3, 3), uniform(-2, 2)};
            p.z = -w.s.ops->value(w.s.self, p, &n);
            if (!(std::fabs(p.z) < 1e6)) continue;
            w.s.ops->value(w.s.self, p, &n);
            if (i % 3 == 0) { // nearly along it
                const double lift = std::pow(10, uniform(-6, 0)), part = dot(n, d) / dot(n, n);
                d = {d.x + (lift - 1) * part * n.x, d.y + (lift - 1) * part * n.y,
                     d.z + (lift - 1) * part * n.z};
            }
            const sgt_start a = {p, n, 4e-16 * w.reach, d, 0, {}};
            starts.push_back(a);
            const sgt_status is = asphere_right(w, kind, a, outside, &worst);
            hits += is > 0, undecided += is < 0;
        }
        batch_is_single(w, starts, nullptr);
        std::printf("asphere, c %g, k %g, rim %g: %zu starts, %d met, %d undecided\n", kind.c, kind.k,
                    kind.semi_diameter, starts.size(), hits, undecided);
        require(undecided * 200 <= count, "asphere: undecided");
    }
}

// Random aspheres, most of them bent in one way as far as they go: flat and steep, with rims before and at
// the equator and without.  They are left from anywhere on them, into the whole sphere, along the surface,
// toward the rim and the equator as near as 1e-9 of it, and into ends.
void bowls_of_aspheres(int count)
{
    int hits = 0, undecided = 0, all = 0;
    double worst = 0;
    for (int i = 0; i < count; i++) {
        sgt_even_asphere kind = {};
        const double sign = uniform(0, 1) < 0.5 ? 1 : -1;
        kind.c = i % 5 == 0 ? 0 : sign * std::pow(10, uniform(-3, 0));
        kind.k = i % 3 == 0 ? std::round(uniform(-2, 1)) : uniform(-2, 1.5);
        const double k1 = 1 + kind.k,
                     equator = kind.c != 0 && k1 > 0 ? 1 / (std::fabs(kind.c) * std::sqrt(k1)) : HUGE_VAL,
                     wide = equator < HUGE_VAL ? equator : std::pow(10, uniform(0, 2));
        const double wide_of = i % 4 == 0 ? 1 : i % 4 == 1 ? uniform(0.9, 1.1) : uniform(0.2, 0.9);
        kind.semi_diameter = uniform(0, 1) < 0.4 ? 0 : wide * wide_of;
        const double reach = kind.semi_diameter > 0 ? std::min(kind.semi_diameter, equator) : wide;
        double power = 1 / reach;
        for (double &a : kind.a) {
            if (uniform(0, 1) < 0.4)
                a = power * std::pow(10, uniform(-4, 0.5)) * (uniform(0, 1) < 0.9 ? sign : -0.1 * sign);
            power /= reach * reach;
        }
        if (kind.c == 0 && std::count(kind.a, kind.a + 8, 0.0) == 8) continue; // a plane
        const World w = {"bowl of an asphere", {&sgt_even_asphere_ops, &kind}, 4, nullptr};
        auto point = [&](double r, sgt_vec3 *n) {
            const double phi = uniform(0, 6.283);
            sgt_vec3 p = {r * std::cos(phi), r * std::sin(phi), 0};
            p.z = -w.s.ops->value(w.s.self, p, n);
            w.s.ops->value(w.s.self, p, n);
            return p;
        };
        std::vector<sgt_start> starts;
        const int had = failures;
        for (int j = 0; j < 40; j++) {
            sgt_vec3 n = {0, 0, 0}, m = {0, 0, 0}, d = direction();
            const double part = j % 8 == 0 ? 1 - std::pow(10, uniform(-9, -1)) : std::sqrt(uniform(0, 1)),
                         r = reach * part;
            const sgt_vec3 p = point(r, &n);
            if (!(std::fabs(p.z) < 1e6) || !(length(n) < 1e9)) continue;
            if (j % 4 == 1) {
                const double lift = std::pow(10, uniform(-6, 0)), by = (lift - 1) * dot(n, d) / dot(n, n);
                d = {d.x + by * n.x, d.y + by * n.y, d.z + by * n.z};
            }
            if (j % 2 == 0) {
                const double off = std::pow(10, uniform(-9, -1)),
                             out = reach < equator && j % 3 == 0 ? 1 : -1;
                sgt_vec3 to = point(reach * (1 + out * off), &m);
                if (!(std::fabs(to.z) < 1e6)) continue;
                d = {to.x - p.x, to.y - p.y, to.z - p.z};
                const double far = length(d);
                if (!(far > 1e-9 * reach)) continue;
                d = {d.x / far, d.y / far, d.z / far};
            }
            starts.push_back(
                {p, n, 4e-16 * (r + std::fabs(p.z)), d, j % 5 == 4 ? reach * uniform(0, 3) : 0, {}});
            const sgt_status is = asphere_right(w, kind, starts.back(), false, &worst);
            hits += is > 0, undecided += is < 0, all++;
        }
        batch_is_single(w, starts, nullptr);
        if (failures > had && failures < 40)
            std::printf("  c %a k %a rim %a a %a %a %a %a %a %a %a %a\n", kind.c, kind.k, kind.semi_diameter,
                        kind.a[0], kind.a[1], kind.a[2], kind.a[3], kind.a[4], kind.a[5], kind.a[6],
                        kind.a[7]);
    }
    std::printf("bowls of aspheres: %d starts, %d met, %d undecided, at most %.1f u off the surface\n", all,
                hits, undecided, worst);
    require(undecided * 100 <= all, "bowls of aspheres: undecided");
}

void rows_by_hand()
{
    static const sgt_torus torus = {139, 1};
    const sgt_surface ring = {&sgt_torus_ops, &torus};
    // 1e-8 inside of the tube, straight out: that is the start; the far side of the hole is next.
    sgt_start a = {{138 + 1e-8, 0, 0}, {-1, 0, 0}, 2e-8, {-1, 0, 0}, 0, {}};
    sgt_crossing c = sgt_leave(ring, &a, nullptr);
    require(c.hit.status == SGT_HIT && c.side == 1 && std::fabs(c.hit.t - 276) < 1e-7,
            "torus, out of the tube");
    a.p.x = 138 - 1e-8; // the same from without
    c = sgt_leave(ring, &a, nullptr);
    require(c.hit.status == SGT_HIT && c.side == 1 && std::fabs(c.hit.t - 276) < 1e-7,
            "torus, beside the tube");
    a.p_err = 0, a.p.x = 138 + 1e-8; // a point that is not on it: the tube's wall is met
    c = sgt_leave(ring, &a, nullptr);
    require(c.hit.status == SGT_HIT && c.side == -1 && std::fabs(c.hit.t - 1e-8) < 1e-13,
            "torus, no start on it");
    static const sgt_conic flat = {0, 0, 0}; // a start beside a plane by less than its last place
    for (const double z : {1e-17, 1e-18, -1e-17, -1e-18})
        for (const double slope : {1e-9, -1e-9, 1e-3, -1e-3}) {
            a = {{1, 0, z}, {0, 0, 1}, 0, {1, 0, slope}, 0, {}};
            c = sgt_leave({&sgt_conic_ops, &flat}, &a, nullptr);
            require(c.hit.status == SGT_MISS && c.side == (slope > 0 ? 1 : -1), "plane, nearly on it");
        }
    a = {{140, 0, 0}, {0, 0, 0}, 1e-13, {0, 0, 1}, 0, {}}; // along the outermost tangent
    c = sgt_leave(ring, &a, nullptr);
    require(c.hit.status != SGT_HIT && c.side >= 0, "torus, tangent");
    a.tmax = 5, a.d = {-1, 0, 0};
    c = sgt_leave(ring, &a, nullptr);
    require(c.hit.status == SGT_HIT && c.side == -1 && std::fabs(c.hit.t - 2) < 1e-12, "torus, before tmax");
    a.tmax = 1.5;
    c = sgt_leave(ring, &a, nullptr);
    require(c.hit.status == SGT_MISS && c.side == -1, "torus, behind tmax");
    a.p_err = -1;
    require(sgt_leave(ring, &a, nullptr).hit.status == SGT_INVALID, "a p_err below 0");
    a.p_err = 0, a.reserved_[1] = 1;
    require(sgt_leave(ring, &a, nullptr).hit.status == SGT_INVALID, "reserved");
    // z = 0.1 r^2 by its vertex, as a formula and as a conic: the root at the start is not accepted
    const char *text = "0.1*r^2";
    const size_t size = sgt_formula_room(text, 0);
    std::vector<double> room(size / sizeof(double) + 1);
    sgt_formula_sag sag = {sgt_formula_read(text, SGT_FORMULA_XY, 0, nullptr, room.data(), size, nullptr), 0};
    sgt_conic conic = {};
    conic.c = 0.2, conic.k = -1;
    const sgt_surface two[2] = {{&sgt_formula_sag_ops, &sag}, {&sgt_conic_ops, &conic}};
    for (const sgt_surface &s : two)
        for (const double x : {0.0, 1e-17, -3e-12}) {
            a = {{x, 0, 0}, {0, 0, 0}, 1e-16, {1, 0, 0.25}, 0, {}};
            c = sgt_leave(s, &a, nullptr);
            require(c.hit.status == SGT_HIT && c.side == 1 && std::fabs(c.hit.t - 2.5) < 1e-10,
                    "bowl, up from the vertex");
            a.d.z = -0.25, a.tmax = 100;
            c = sgt_leave(s, &a, nullptr);
            require(c.hit.status == SGT_MISS && c.side == -1, "bowl, down from the vertex");
        }
    // a start beside the origin, on a ball of which F hides 1e-17 but not the slope
    sgt_quadric far = {};
    far.squares[0] = far.squares[1] = far.squares[2] = 1, far.linear[2] = -20, far.constant = 0;
    for (const double x : {0.0, 1e-17, 1e-12}) {
        a = {{x, 0, 0}, {0, 0, -20}, 1e-16, {0, 0, -1}, 0, {}};
        c = sgt_leave({&sgt_quadric_ops, &far}, &a, nullptr);
        require(c.hit.status == SGT_MISS && c.side == 1, "out of a ball, from beside the origin");
    }
    // t_tol wider than a cap: its end may lie where the slope has turned, and the side may not
    sgt_surface_ops plain = {};
    plain.size = sizeof plain, plain.value = [](const void *, sgt_vec3 p, sgt_vec3 *n) {
        if (n) *n = {2 * p.x, 2 * p.y, 2 * p.z};
        return p.x * p.x + p.y * p.y + p.z * p.z - 1;
    };
    for (const double tol : {0.01, 0.05, 0.15, 0.3}) {
        sgt_options loose = {};
        loose.t_tol = tol;
        const double h = 0.1, y = std::sqrt(1 - h * h);
        a = {{-h, y, 0}, {-2 * h, 2 * y, 0}, 1e-15, {1, 0, 0}, 0, {}};
        c = sgt_leave({&plain, nullptr}, &a, &loose);
        require(c.hit.status != SGT_HIT || c.side <= 0, "through a cap, with a wide t_tol");
    }
    // starts in mid-air, at the origin, where F has no terms: outside of a ball, and at the middle of one
    sgt_quadric ball = {};
    ball.squares[0] = ball.squares[1] = ball.squares[2] = 1, ball.linear[0] = -6, ball.constant = 8;
    sgt_ellipsoid round = {};
    round.a = 2;
    a = {{0, 0, 0}, {0, 0, 0}, 0, {1, 0.5, 0}, 0, {}};
    c = sgt_leave({&sgt_quadric_ops, &ball}, &a, nullptr);
    require(c.hit.status == SGT_MISS && c.side == 1, "outside of a ball, from the origin");
    a = {{0, 0, 0}, {0, 0, 0}, 0, {0, 0, 1}, 1, {}};
    c = sgt_leave({&sgt_ellipsoid_ops, &round}, &a, nullptr);
    require(c.hit.status == SGT_MISS && c.side == -1, "in the middle of a ball, before it ends");
    a.tmax = -0.0;
    c = sgt_leave({&sgt_ellipsoid_ops, &round}, &a, nullptr);
    require(c.hit.status == SGT_MISS, "an end of -0 is an end");
    // a plane through the origin: no terms are left on it
    const World plane = {"plane", formula("y = 0", 10), 10, nullptr};
    const sgt_hit away = sgt_intersect(plane.s, {{1, 0, 3}, {0.3, 0.1, 0}, 0, 0}, nullptr);
    require(away.status == SGT_MISS, "a plane, from a point on it");
}

} // namespace

int main(int argc, char **argv)
{
    const char *scale = std::getenv("SAGITTA_TEST_SCALE"), *seed = std::getenv("SAGITTA_TEST_SEED");
    const bool timed = argc > 2 && std::strcmp(argv[1], "--steps") == 0;
    const double by = scale ? std::atof(scale) : 0.5;
    bits.seed(seed ? std::strtoull(seed, nullptr, 10) : 37);
    const long steps = timed ? std::atol(argv[2]) : static_cast<long>(20000 * by);
    const std::string only = timed && argc > 3 ? argv[3] : "";
    for (const World &w : worlds()) {
        if (std::string(w.name).compare(0, only.size(), only) != 0) continue;
        walk(w, steps, timed ? std::min(steps, 100000L) : steps / 4, timed);
        std::fflush(stdout);
    }
    if (!timed)
        for (const World &w : worlds()) beside_and_along(w, static_cast<int>(2000 * by));
    if (!timed) bowls(static_cast<int>(4000 * by));
    if (!timed) planes(static_cast<int>(4000 * by));
    if (!timed) aspheres(static_cast<int>(4000 * by));
    if (!timed) bowls_of_aspheres(static_cast<int>(200 * by));
    rows_by_hand();
    return failures > 0;
}
