// SPDX-License-Identifier: MIT
// The derivatives of whole traces (aim.h) against differences of an independent tracer in 113 bits.
//
// The lens is made for this: a double Gauss of six elements, an even asphere and an odd one, in front of a
// plate that is tilted and a concave mirror, with an image plane that is tilted, too.  Rays are random; each
// number of the lens and of the launch ray is changed by a part in 1e10 of its unit, up and down, in quads:
// the difference is then right to some 1e-19.  The gradient has to agree within 1e-9 of its vector (the
// changes of p, of d, of the path), and within 1e-9 of itself where it is not a hundred times smaller than
// that.
//
// SAGITTA_TEST_SCALE multiplies the rays; SAGITTA_TEST_SEED replaces the seed.
#include "slow_trace.h"
#include "../oracle/cases.h"

#include <sagitta/aim.h>

#include <cstdlib>

using namespace slow;

static int failures;

static void fail(const char *what, std::size_t a, std::size_t b, double x, double y)
{
    if (failures++ < 20) std::printf("FAIL %s (%zu, %zu): %.17g, should be %.17g\n", what, a, b, x, y);
}

// ------------------------------------------------------------------ the lens

struct gauss {
    sgt_conic sphere[9];
    sgt_even_asphere asphere;
    sgt_odd_asphere odd;
    sgt_conic plate, mirror, image;
    std::vector<sgt_element> e;
    gauss()
    {
        const double c[9] = {1 / 38.2, 1 / 101.3, 1 / 22.7, 1 / 15.4, 1 / -16.9, 1 / -24.1, 0, 0, 1 / -28.8};
        const double z[12] = {0, 6.1, 6.7, 12.5, 16.3, 29.1, 31.4, 38.2, 38.9, 43.7, 0, 0};
        for (int i = 0; i < 9; i++) sphere[i] = {c[i], i == 4 ? -0.2 : 0, 0};
        asphere = {1 / -21.6, 0.3, 0, {0, 2e-6, -1e-9, 3e-12, 0, 0, 0, 0}};
        odd = {1 / 152.0, -0.5, 0, {0, 1e-4, 3e-6, 1e-6, 2e-8}};
        plate = {0, 0, 0}, mirror = {1 / -250.0, -0.7, 0}, image = {0, 0, 0};
        const double index[10] = {1.62, 1, 1.67, 1, 1.6, 1.64, 1, 1.69, 1, 0};
        const sgt_surface s[10] = {at(sphere[0]), at(sphere[1]), at(sphere[2]), at(sphere[3]), at(sphere[4]),
                                   at(sphere[5]), {&sgt_even_asphere_ops, &asphere},
                                   {&sgt_odd_asphere_ops, &odd}, at(sphere[8]), at(plate)};
        for (int i = 0; i < 10; i++) {
            sgt_element one = {};
            one.surface = s[i], one.index = index[i], one.pose.origin = {0, 0, z[i]};
            e.push_back(one);
        }
        e[2].pose = sgt_pose_tilted({0.02, -0.01, 6.7}, {0.3, -0.2, 10});
        e[9].pose = sgt_pose_tilted({0.5, 0.3, 48}, {12, -7, 3}), e[9].index = 1.5;
        e.push_back(e[9]);
        e[10].pose.origin.z = 50, e[10].index = 1;
        sgt_element one = {};
        one.surface = at(mirror), one.index = SGT_MIRROR;
        one.pose = sgt_pose_tilted({0, 0, 60}, {4, 3, 0});
        e.push_back(one);
        one.surface = at(image), one.index = 0, one.pose = sgt_pose_tilted({5, -4, 20}, {2, 6, 30});
        e.push_back(one);
    }
    static sgt_surface at(const sgt_conic &s) { return {&sgt_conic_ops, &s}; }
};

// ------------------------------------------------------------- the differences

struct seven { quad x[7]; };

static seven numbers(const end &r) { return {{r.p.x, r.p.y, r.p.z, r.d.x, r.d.y, r.d.z, r.opl}}; }

struct system_of {
    std::vector<element> e;
    quad before;
    vec o, d;
    seven end_of(std::size_t n) const
    {
        const end r = trace(e, n, before, o, d);
        if (r.passed != n) fail("the slow trace", r.passed, n, 0, 0);
        return numbers(r);
    }
};

// Number j of the list of sgt_trace_parameters, and a unit of it.
static quad *number(system_of &s, std::size_t j, double *unit)
{
    *unit = 1;
    quad *const launch[7] = {&s.o.x, &s.o.y, &s.o.z, &s.d.x, &s.d.y, &s.d.z, &s.before};
    if (j < 7) return launch[j];
    j -= 7;
    for (element &e : s.e) {
        if (j < e.a.size()) { // of a power of r, by name: curvature, conic, then r^2, r^4 ... or r, r^2 ...
            const bool odd = e.surface.ops == &sgt_odd_asphere_ops;
            *unit = j == 0 ? 1e-2 : j == 1 ? 1 : std::pow(10.0, -(odd ? double(j) - 2 : 2 * double(j) - 4));
            return &e.a[j];
        }
        j -= e.a.size();
        vec &o = e.origin, &w = e.turn;
        quad *const own[7] = {&o.x, &o.y, &o.z, &w.x, &w.y, &w.z, &e.index};
        if (j < 7) return own[j];
        j -= 7;
    }
    return nullptr;
}

constexpr double NOTHING = 1e-13;
static double worst_vector, worst_entry;
static long compared;

// Component r of the seven: p, d, the path.
static double &component(sgt_ray_change &c, std::size_t r)
{
    double *const all[7] = {&c.p.x, &c.p.y, &c.p.z, &c.d.x, &c.d.y, &c.d.z, &c.opl};
    return *all[r];
}

static void compare_ray(const gauss &lens, std::size_t n, const sgt_ray &launch, double before)
{
    std::vector<sgt_passage> passages(n);
    sgt_ray ray = launch;
    if (sgt_trace(n, lens.e.data(), before, &ray, passages.data(), nullptr, nullptr) != n) return;
    const std::size_t count = sgt_trace_parameters(n, lens.e.data());
    std::vector<double> gradient(7 * count);
    sgt_ray_change weight[7] = {};
    for (std::size_t r = 0; r < 7; r++) component(weight[r], r) = 1;
    const int lacks = sgt_trace_gradient(n, lens.e.data(), before, &launch, passages.data(), 7, weight,
                                         gradient.data());
    if (lacks) fail("lacks", n, 0, lacks, 0);

    sgt_ray_change forward[6] = {};
    for (std::size_t j = 0; j < 6; j++) component(forward[j], j) = 1;
    sgt_trace_sensitivity(n, lens.e.data(), before, &launch, passages.data(), 6, forward, forward);

    system_of s = {{}, before, of(launch.o), of(launch.d)};
    for (std::size_t i = 0; i < n; i++) s.e.push_back(element_of(lens.e[i]));
    for (std::size_t j = 0; j < count; j++) {
        double unit;
        quad *a = number(s, j, &unit);
        const quad was = *a, h = quad(unit) * quad(1e-10);
        if (j >= 7 && a && (was == 0 || was == -1) && unit == 1) {
            bool index = false;
            for (element &e : s.e) index = index || a == &e.index;
            if (index) {
                for (std::size_t r = 0; r < 7; r++)
                    if (gradient[r * count + j] != 0) fail("no index", r, j, gradient[r * count + j], 0);
                continue;
            }
        }
        *a = was + h;
        const seven up = s.end_of(n);
        *a = was - h;
        const seven down = s.end_of(n);
        *a = was;
        double size[3] = {0, 0, 0}, by[7];
        for (int r = 0; r < 7; r++) {
            by[r] = to_double((up.x[r] - down.x[r]) / (2 * h));
            size[r / 3] = std::max(size[r / 3], std::fabs(by[r]));
        }
        for (std::size_t r = 0; r < 7; r++) {
            const double g = gradient[r * count + j], off = std::fabs(g - by[r]), all = size[r / 3];
            compared++;
            // NOTHING: a derivative that is 0 is a sum that cancels (a sphere turned about its axis)
            const bool counts = all * unit > 1e-6, itself = counts && std::fabs(by[r]) > 1e-2 * all;
            if (counts) worst_vector = std::max(worst_vector, off / all);
            if (itself) worst_entry = std::max(worst_entry, off / std::fabs(by[r]));
            if (!(off <= 1e-9 * all + NOTHING / unit)) fail("gradient", r, j, g, by[r]);
            if (itself && !(off <= 1e-9 * std::fabs(by[r]))) fail("gradient, by itself", r, j, g, by[r]);
            if (j >= 6) continue;
            const double x = component(forward[j], r);
            if (!(std::fabs(x - by[r]) <= 1e-9 * all + NOTHING)) fail("forward", r, j, x, by[r]);
        }
    }
}

// ------------------------------------------------------------------ the ends

// More rows than a sweep has, and one by one; columns in place; no element at all.
static void compare_calls(const gauss &lens)
{
    const std::size_t n = lens.e.size(), count = sgt_trace_parameters(n, lens.e.data());
    const sgt_ray launch = {{0.4, -0.3, -50}, {0.02, 0.03, 1}, 0, 0};
    std::vector<sgt_passage> passages(n);
    sgt_ray ray = launch;
    sgt_trace(n, lens.e.data(), 1, &ray, passages.data(), nullptr, nullptr);
    std::vector<double> all(19 * count), one(count);
    std::vector<sgt_ray_change> weight(19);
    for (std::size_t r = 0; r < 19; r++)
        weight[r] = {{double(r), 1, -0.5 * double(r)}, {2, double(r), 1}, double(r) / 3};
    weight[3] = {{1, 0, 0}, {0, 0, 0}, 0};
    sgt_trace_gradient(n, lens.e.data(), 1, &launch, passages.data(), 19, weight.data(), all.data());
    for (std::size_t r = 0; r < 19; r++) {
        sgt_trace_gradient(n, lens.e.data(), 1, &launch, passages.data(), 1, &weight[r], one.data());
        for (std::size_t j = 0; j < count; j++)
            if (one[j] != all[r * count + j]) fail("a row alone", r, j, one[j], all[r * count + j]);
    }
    // a row with weights on the point only, of a ray that is stopped by the last element
    std::vector<sgt_passage> stopped = passages;
    stopped[n - 1].direction = {0, 0, 0};
    sgt_trace_gradient(n, lens.e.data(), 1, &launch, stopped.data(), 1, &weight[3], one.data());
    for (std::size_t j = 0; j < count; j++)
        if (one[j] != all[3 * count + j]) fail("stopped", 3, j, one[j], all[3 * count + j]);
    sgt_ray_change x = {{1, 0, 0}, {0, 1, 0}, 0}, y;
    sgt_trace_sensitivity(n, lens.e.data(), 1, &launch, stopped.data(), 1, &x, &y);
    if (!(y.p.x == y.p.x && y.opl == y.opl && y.d.x != y.d.x)) fail("stopped, forward", 0, 0, y.p.x, y.d.x);
    // not met: all NaN
    stopped[2].hit.status = SGT_MISS;
    sgt_trace_gradient(n, lens.e.data(), 1, &launch, stopped.data(), 1, &weight[2], one.data());
    if (!(one[0] != one[0])) fail("not met", 0, 0, one[0], NAN);
    // none: the launch ray itself
    if (sgt_trace_parameters(0, nullptr) != 7) fail("of none", 0, 0, 0, 7);
    const sgt_ray away = {{1, 2, 3}, {0, 0, 4}, 0, 0};
    x = {{1, 2, 3}, {4, 8, 5}, 6};
    sgt_trace_sensitivity(0, nullptr, 1, &away, nullptr, 1, &x, &x);
    if (x.p.x != 1 || x.d.x != 1 || x.d.y != 2 || x.d.z != 0 || x.opl != 6) fail("of none", 0, 1, x.d.x, 1);
    const sgt_ray_change w = {{1, 2, 3}, {4, 8, 5}, 6};
    sgt_trace_gradient(0, nullptr, 1, &away, nullptr, 1, &w, one.data());
    if (one[1] != 2 || one[3] != 1 || one[5] != 0 || one[6] != 0) fail("of none", 1, 0, one[3], 1);
}

// A user's surface without second derivatives: the point is known, the direction is not.
static double flat(const void *, sgt_vec3 p, sgt_vec3 *grad)
{
    if (grad) *grad = {0, 0, 1};
    return p.z;
}

static void compare_lacks()
{
    sgt_surface_ops ops = {};
    ops.value = flat;
    sgt_element e[2] = {};
    e[0].surface = e[1].surface = {&ops, nullptr};
    e[0].index = 1, e[1].index = 1.5, e[1].pose.origin = {0, 0, 1};
    const sgt_ray launch = {{0, 0, -1}, {0, 0.1, 1}, 0, 0};
    sgt_passage passages[2];
    sgt_ray ray = launch;
    if (sgt_trace(2, e, 1, &ray, passages, nullptr, nullptr) != 2) fail("flat", 0, 0, 0, 2);
    sgt_ray_change x = {{1, 0, 0}, {0, 0, 0}, 0};
    int lacks = sgt_trace_sensitivity(2, e, 1, &launch, passages, 1, &x, &x);
    if (lacks != SGT_LACKS_SECOND || std::fabs(x.p.x - 1) > 1e-15 || x.d.x == x.d.x)
        fail("lacks", 0, 1, x.p.x, x.d.x);
    double g[21];
    sgt_ray_change w = {{1, 0, 0}, {0, 0, 0}, 0};
    lacks = sgt_trace_gradient(2, e, 1, &launch, passages, 1, &w, g);
    if (lacks != SGT_LACKS_PARAMETERS || std::fabs(g[0] - 1) > 1e-15 || sgt_trace_parameters(2, e) != 21)
        fail("lacks", 1, 1, lacks, g[0]);
}

int main()
{
    const char *text = std::getenv("SAGITTA_TEST_SCALE"), *seed = std::getenv("SAGITTA_TEST_SEED");
    const double scale = text ? std::atof(text) : 0.5;
    oracle::generator random(seed ? std::strtoull(seed, nullptr, 10) : 20261);
    const gauss lens;
    const int rays = std::max(2, int(12 * scale));
    for (int i = 0; i < rays; i++) {
        const double x = random.uniform(-6, 6), y = random.uniform(-6, 6), way = random.log_uniform(0.1, 10);
        const sgt_vec3 d = {random.uniform(-0.15, 0.15) * way, random.uniform(-0.15, 0.15) * way, way};
        const sgt_ray launch = {{x - 40 / way * d.x, y - 40 / way * d.y, -40}, d, 0, 0};
        compare_ray(lens, i % 3 == 2 ? std::size_t(1 + random.below(12)) : lens.e.size(), launch,
                    i % 4 == 3 ? 1.1 : 1);
    }
    compare_calls(lens);
    compare_lacks();
    std::printf("%ld derivatives of %d rays; worst: %.2g of its vector, %.2g of itself\n", compared, rays,
                worst_vector, worst_entry);
    if (compared < 1000) failures++;
    return failures != 0;
}
