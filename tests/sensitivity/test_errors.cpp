// SPDX-License-Identifier: MIT
// The told errors of ends, by sgt_trace_error_batch, against traces in 113 bits (slow_trace.h).
//
// Random trains: conics, even aspheres, odd aspheres, toroids, Zernike sags and ideal lenses; mirrors, turned
// and decentred frames, changes of index or none.  Of each ray that gets to the end and is nowhere near to
// grazing:
//
//     point   x and y of the end are within `point` of those of the exact ray
//     path    opl, to the foot of the perpendicular from the exact end, is within `path` of the exact one
//
// No told error may be exceeded.  And it may not be wide: half of the errors are more than a thousandth of
// it.
//
// SAGITTA_TEST_SCALE multiplies the ends (3000; 35 of them are 10^5); SAGITTA_TEST_SEED replaces the seed.
#include "slow_trace.h"
#include "../oracle/cases.h"

#include <sagitta/aim.h>

#include <algorithm>
#include <cstdlib>

using namespace slow;

static int failures;
static unsigned long long train_seed;

static void fail(const char *what, double a, double b)
{
    if (failures++ < 20) std::printf("FAIL %s: %.17g, %.17g; train %llu\n", what, a, b, train_seed);
}

enum { MOST = 7, RAYS = 100 };

// Surfaces of a size of about 1; lengths are then scaled by a power of two.
struct train {
    sgt_conic conic[MOST];
    sgt_even_asphere asphere[MOST];
    sgt_odd_asphere odd[MOST];
    sgt_toroidal toroid[MOST];
    sgt_zernike zernike[MOST];
    double terms[MOST][16];
    sgt_phase phase[MOST];
    std::vector<sgt_element> e;
    double before;
};

static sgt_surface surface_of(oracle::generator &g, train &r, std::size_t i, bool flat)
{
    const double c = flat || g.chance(0.1) ? 0 : g.sign() / g.log_uniform(2.5, 30),
                 k = g.chance(0.5) ? 0 : g.uniform(-1.5, 0.5), rim = 1.3;
    const int kind = flat ? 0 : g.below(8);
    if (kind < 3) {
        r.conic[i] = {c, k, 0};
        return {&sgt_conic_ops, &r.conic[i]};
    }
    if (kind < 5) {
        r.asphere[i] = {c, k, rim, {}};
        for (double &a : r.asphere[i].a) a = g.chance(0.5) ? 0 : g.uniform(-1, 1) * g.log_uniform(1e-5, 1e-2);
        return {&sgt_even_asphere_ops, &r.asphere[i]};
    }
    if (kind == 5) {
        r.odd[i] = {c, k, rim, {}};
        for (std::size_t j = 1; j < 6; j++) r.odd[i].a[j] = g.uniform(-1, 1) * 3e-3;
        return {&sgt_odd_asphere_ops, &r.odd[i]};
    }
    if (kind == 6) {
        r.toroid[i] = {c, k, g.uniform(-0.2, 0.2), rim, {}};
        r.toroid[i].a[1] = g.uniform(-1, 1) * 1e-3;
        return {&sgt_toroidal_ops, &r.toroid[i]};
    }
    for (double &a : r.terms[i]) a = g.uniform(-1, 1) * 1e-3;
    r.zernike[i] = {c, k, rim, rim, SGT_FRINGE, 0, {r.terms[i], 1, 9 + std::size_t(g.below(7))}};
    return {&sgt_zernike_ops, &r.zernike[i]};
}

static void draw(oracle::generator &g, train &r)
{
    const std::size_t count = std::size_t(2 + g.below(MOST - 1));
    const bool ideal = g.chance(0.4);
    r.before = g.chance(0.5) ? 1 : g.uniform(1, 1.7);
    double z = 0, way = 1;
    for (std::size_t i = 0; i < count; i++) {
        const bool last = i + 1 == count, phased = ideal && !last && g.chance(0.4);
        sgt_element e = {};
        e.surface = surface_of(g, r, i, (last && g.chance(0.7)) || phased);
        e.index = last || g.chance(0.2) ? 0 : g.chance(0.2) ? SGT_MIRROR : g.uniform(1, 1.9);
        if (phased) {
            r.phase[i] = {};
            r.phase[i].kind = SGT_IDEAL_LENS, r.phase[i].focal_length = g.sign() * g.log_uniform(2, 100);
            r.phase[i].object_distance = g.chance(0.4) ? 0 : g.sign() * g.log_uniform(1, 100);
            e.phase = &r.phase[i];
        }
        const double aside = g.chance(0.5) ? 0 : 0.1;
        const sgt_vec3 origin = {g.uniform(-aside, aside), g.uniform(-aside, aside), z};
        if (g.chance(0.4))
            e.pose = sgt_pose_tilted(origin, {g.uniform(-8, 8), g.uniform(-8, 8), g.uniform(-180, 180)});
        else
            e.pose.origin = origin;
        r.e.push_back(e);
        if (e.index == SGT_MIRROR) way = -way;
        z += way * g.uniform(0.1, 2);
    }
}

// Of told errors: how much of them the errors are.
struct spread {
    const char *name;
    std::vector<double> part;
    void add(double error, double told)
    {
        part.push_back(told > 0 ? error / told : error > 0 ? HUGE_VAL : 0);
        if (!(error <= told)) fail(name, error, told);
    }
    void print()
    {
        const std::size_t n = part.size();
        if (n == 0) return fail(name, 0, 0);
        std::sort(part.begin(), part.end());
        std::printf("%s: %zu ends; error by told error: median %.2g, 99 %% %.2g, most %.3g\n", name, n,
                    part[n / 2], part[n * 99 / 100], part[n - 1]);
        if (!(part[n / 2] >= 1e-3)) fail("told errors are wide", part[n / 2], 1e-3);
    }
};

static spread of_point = {"point", {}}, of_path = {"path", {}},
              of_phased_path = {"path with ideal lenses", {}};
static long by_kind[8];

static void try_train(oracle::generator &g)
{
    train r;
    draw(g, r);
    const std::size_t m = r.e.size();
    std::vector<std::vector<double>> room(12 * m + 4, std::vector<double>(RAYS));
    std::vector<double> launch[6];
    std::vector<std::vector<sgt_status>> status(m, std::vector<sgt_status>(RAYS));
    std::vector<sgt_fate> fate(RAYS);
    std::vector<sgt_passages> passages(m);
    std::size_t used = 0;
    const auto next = [&] { return room[used++].data(); };
    for (std::size_t i = 0; i < m; i++) {
        sgt_passages &p = passages[i];
        p = {};
        p.hits.status = status[i].data(), p.hits.t = next(), p.hits.p_err = next(), p.opl = next();
        for (int k = 0; k < 3; k++) p.hits.p[k] = next(), p.hits.n[k] = next(), p.direction[k] = next();
    }
    for (auto &x : launch) x.resize(RAYS);
    for (std::size_t i = 0; i < RAYS; i++) {
        const double far = g.log_uniform(1, 100), u = g.uniform(-0.15, 0.15), v = g.uniform(-0.15, 0.15),
                     by = g.chance(0.5) ? 1 : g.log_uniform(0.1, 10);
        const double x[6] = {
            g.uniform(-0.6, 0.6) - u * far, g.uniform(-0.6, 0.6) - v * far, -far, u * by, v * by, by};
        for (std::size_t k = 0; k < 6; k++) launch[k][i] = x[k];
    }
    sgt_rays rays = {};
    for (std::size_t k = 0; k < 3; k++) rays.o[k] = launch[k].data(), rays.d[k] = launch[3 + k].data();
    sgt_traced out = {};
    out.fate = fate.data();
    sgt_trace_batch(m, r.e.data(), r.before, RAYS, rays, out, passages.data(), nullptr);
    sgt_end_errors told = {};
    double *const point = told.point = next(), *const path = told.path = next();
    const sgt_traces traces = {RAYS, rays, passages.data()};
    sgt_trace_error_batch(m, r.e.data(), r.before, &traces, told);

    std::vector<element> e;
    for (const sgt_element &one : r.e) e.push_back(element_of(one));
    double index = r.before;
    bool phased = false;
    for (std::size_t i = 0; i + 1 < m; i++) {
        if (r.e[i].index > 0) index = r.e[i].index;
        phased = phased || r.e[i].phase;
    }
    const sgt_passages &last = passages[m - 1], &front = passages[m - 2];
    for (std::size_t i = 0; i < RAYS; i++) {
        if (fate[i] != SGT_PASSED) continue;
        double slope = 1; // of the steepest incidence: near grazing all is large
        for (const sgt_passages &p : passages) {
            const double n = std::sqrt(p.hits.n[0][i] * p.hits.n[0][i] + p.hits.n[1][i] * p.hits.n[1][i] +
                                       p.hits.n[2][i] * p.hits.n[2][i]);
            slope = std::min(slope, std::fabs(p.direction[0][i] * p.hits.n[0][i] +
                                              p.direction[1][i] * p.hits.n[1][i] +
                                              p.direction[2][i] * p.hits.n[2][i]) /
                                        n);
        }
        if (slope < 0.1) continue;
        const end is = trace(e, m, r.before, of(sgt_vec3{launch[0][i], launch[1][i], launch[2][i]}),
                             of(sgt_vec3{launch[3][i], launch[4][i], launch[5][i]}));
        const vec off = of(sgt_vec3{last.hits.p[0][i], last.hits.p[1][i], last.hits.p[2][i]}) - is.p;
        if (is.passed != m || !(to_double(length(off)) < 1e-3)) continue; // another root
        const vec in = e[m - 1].local(e[m - 2].global(
            of(sgt_vec3{front.direction[0][i], front.direction[1][i], front.direction[2][i]})));
        of_point.add(to_double(square_root(off.x * off.x + off.y * off.y)), point[i]);
        (phased ? of_phased_path : of_path)
            .add(to_double(magnitude(last.opl[i] - is.opl - index * inner(off, in))), path[i]);
        by_kind[0]++;
        bool mirror = false, turned = false, departure = false, asphere = false;
        for (const sgt_element &one : r.e) {
            mirror = mirror || one.index == SGT_MIRROR, turned = turned || one.pose.ez.z != 0;
            asphere = asphere || one.surface.ops == &sgt_even_asphere_ops;
            departure =
                departure || (one.surface.ops != &sgt_conic_ops && one.surface.ops != &sgt_even_asphere_ops);
        }
        by_kind[1] += mirror, by_kind[2] += turned, by_kind[3] += departure, by_kind[4] += phased;
        by_kind[5] += asphere;
    }
}

int main()
{
    const char *text = std::getenv("SAGITTA_TEST_SCALE"), *seed = std::getenv("SAGITTA_TEST_SEED");
    const double scale = text ? std::atof(text) : 0.5;
    const unsigned long long first = seed ? std::strtoull(seed, nullptr, 10) : 5;
    const long ends = std::max(1000L, long(3000 * scale));
    std::printf("SAGITTA_TEST_SEED=%llu\n", first);
    long trains = 0;
    for (; by_kind[0] < ends && trains < ends; trains++) {
        train_seed = first * 1000003 + (unsigned long long)trains;
        oracle::generator g(train_seed);
        try_train(g);
    }
    std::printf(
        "%ld ends of %ld trains; with mirrors %ld, turned %ld, departures %ld, ideal lenses %ld, even "
        "aspheres %ld\n",
        by_kind[0], trains, by_kind[1], by_kind[2], by_kind[3], by_kind[4], by_kind[5]);
    of_point.print(), of_path.print(), of_phased_path.print();
    for (int k = 0; k < 6; k++)
        if (by_kind[k] < ends / 20) fail("too few", k, double(by_kind[k]));
    return failures != 0;
}
