// SPDX-License-Identifier: MIT
// What two threads gain: each function for batches in one thread, then in several, each with rays of its own.
//
//     build/tests/bench/bench_threads [THREADS]     2, unless it is said
//
// The time of one thread over that of several, times how many there are: 2.00 is all that two processors can
// give.  A batch shares nothing between threads, so what is missing is the machine's: two rows tell how much
// that is.  `counting` keeps to registers and touches no memory; `copying` is a plain copy of as many bytes
// as a ray of sgt_intersect_batch has.  1000 rays and answers are in each processor's own cache, a million in
// memory.
//
// Each pass of one thread is followed by one of several, and the ratio is the median of ROUNDS such pairs:
// what else the machine has to do then slows both.  Seconds are those that passed, from where all threads
// start to where the last one ends.  Before the clock starts each thread answers, and all answers are the
// same.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>
#include <sagitta/aim.h>
#include <sagitta/sensitivity.h>
#include <sagitta/system.h>
#include "bench_subjects.h"

namespace {

constexpr int ROUNDS = 15;
constexpr double LEAST_SECONDS = 0.02;  // of a pass

// --------------------------------------------------------------------- the lens and the rays

// A cemented doublet of 100 mm at f/4, by its radii, thicknesses, indices and rims.
struct Doublet {
    sgt_conic shape[4] = {{1 / 61.0, 0, 0}, {-1 / 43.5, 0, 0}, {-1 / 124.0, 0, 0}, {0, 0, 0}};
    sgt_element elements[4] = {};
    Doublet()
    {
        const double z[4] = {0, 6, 8.5, 105}, index[4] = {1.5168, 1.6727, 1, 1};
        for (int i = 0; i < 4; i++) {
            elements[i].surface = {&sgt_conic_ops, &shape[i]};
            elements[i].pose.origin.z = z[i];
            elements[i].index = index[i];
            elements[i].semi_diameter = 13;
        }
    }
};
const Doublet doublet;

// The rays and answers of one thread, made by it, so that its memory is near to its processor.
struct Arrays {
    explicit Arrays(size_t rays, bool lens)
        : n(rays), numbers((lens ? 27 : 24) * rays), floats((lens ? 6 : 15) * rays), status(rays),
          fate(rays), side(rays), aims(rays), points(rays)
    {
        const std::vector<sgt_ray> &from = bench::rays();
        for (size_t i = 0; i < n; i++) {
            const sgt_ray &ray = from[i];
            const double in[6] = {ray.o.x, ray.o.y, ray.o.z, lens ? 0 : ray.d.x, lens ? 0.01 : ray.d.y,
                                  lens ? std::sqrt(1 - 1e-4) : ray.d.z};
            for (size_t k = 0; k < 6; k++)
                at(k)[i] = in[k], floats[k * n + i] = static_cast<float>(in[k]);
            points[i] = {4 * ray.d.x / 0.15, 4 * ray.d.y / 0.15};
        }
    }
    double *at(size_t k) { return numbers.data() + k * n; }
    float *floats_at(size_t k) { return floats.data() + k * n; }
    sgt_rays rays() { return {{at(0), at(1), at(2)}, {at(3), at(4), at(5)}, nullptr, nullptr}; }
    sgt_hits hits()
    {
        sgt_hits h = {};
        h.status = status.data(), h.t = at(6), h.t_err = at(7), h.p_err = at(8);
        for (size_t k = 0; k < 3; k++)
            h.p[k] = at(9 + k), h.n[k] = at(12 + k);
        return h;
    }
    sgt_traced traced()
    {
        return {fate.data(), nullptr, {at(15), at(16), at(17)}, {at(18), at(19), at(20)}, nullptr, {}};
    }
    size_t n;
    std::vector<double> numbers;
    std::vector<float> floats;
    std::vector<sgt_status> status;
    std::vector<sgt_fate> fate;
    std::vector<signed char> side;
    std::vector<sgt_aiming> aims;
    std::vector<sgt_vec2> points;
    std::vector<double> more, gradients;  // records of each element; by each parameter
    std::vector<double *> gradient;
    std::vector<sgt_status> met;          // by each element
    sgt_passages passages[4] = {};
};

// Room for what each element says of each ray, and for the derivatives by its numbers.
void with_records(Arrays &a)
{
    size_t parameters = sgt_trace_parameters(4, doublet.elements);
    a.gradients.resize(parameters * a.n), a.gradient.resize(parameters);
    for (size_t j = 0; j < parameters; j++)
        a.gradient[j] = a.gradients.data() + j * a.n;
    a.met.resize(4 * a.n);
    a.more.resize(4 * 12 * a.n);
    for (size_t e = 0; e < 4; e++) {
        double *at = a.more.data() + 12 * e * a.n;
        sgt_passages &p = a.passages[e];
        p.hits.status = a.met.data() + e * a.n;
        p.hits.t = at, p.hits.p_err = at + a.n, p.opl = at + 2 * a.n;
        for (size_t k = 0; k < 3; k++)
            p.hits.p[k] = at + (3 + k) * a.n, p.hits.n[k] = at + (6 + k) * a.n,
            p.direction[k] = at + (9 + k) * a.n;
    }
}

// ------------------------------------------------------------------------------- what is timed

using Pass = std::function<void(Arrays &)>;
struct Row {
    std::string name;
    bool lens;
    Pass prepare, pass;
};

void nothing(Arrays &) {}

Pass intersect(sgt_surface s)
{
    return [s](Arrays &a) { sgt_intersect_batch(s, a.n, a.rays(), a.hits(), nullptr); };
}

void trace(Arrays &a)
{
    sgt_trace_batch(4, doublet.elements, 1, a.n, a.rays(), a.traced(), a.passages, nullptr);
}
void recorded(Arrays &a)
{
    with_records(a);
    trace(a);
}

// Products in four chains, as long as a batch of conics takes: what threads reach that share nothing at all.
void count(Arrays &a)
{
    double x[4] = {1, 1.1, 1.2, 1.3};
    for (size_t i = 0; i < 12 * a.n; i++)
        for (double &one : x)
            one = one * 0.999999 + 1e-6;
    a.at(6)[0] = x[0] + x[1] + x[2] + x[3];
}

void copy(Arrays &a)  // a ray's six numbers, and as many bytes as its answers have
{
    for (size_t k = 0; k < 9; k++)
        std::memcpy(a.at(6 + k), a.at(k % 6), a.n * sizeof(double));
}

std::vector<Row> rows(bench::catalogue::Kept &kept)
{
    static const sgt_conic plane = {}, sphere = {0.1, 0, 4};
    static sgt_julia set = {};
    set.c[0] = -0.083, set.c[2] = -0.83, set.c[3] = -0.025, set.iterations = 7;
    std::vector<Row> all = {{"counting", false, nothing, count}, {"copying", false, nothing, copy}};
    all.push_back({"intersect, plane", false, nothing, intersect({&sgt_conic_ops, &plane})});
    for (const bench::catalogue::Subject &s : bench::catalogue::subjects(kept))
        if (s.name == "conic" || s.name == "even_asphere" || s.name == "toroidal, to y^8" ||
            s.name == "zernike, fringe, 37" || s.name == "torus")
            all.push_back({"intersect, " + s.name, false, nothing, intersect(s.s)});
    all.push_back({"intersect, Julia set", false, nothing, intersect({&sgt_julia_ops, &set})});
    const sgt_surface ball = {&sgt_conic_ops, &sphere};
    all.push_back({"intersect in floats, sphere", false, nothing, [ball](Arrays &a) {
        sgt_rays_f rays = {{a.floats_at(0), a.floats_at(1), a.floats_at(2)},
                           {a.floats_at(3), a.floats_at(4), a.floats_at(5)}, nullptr, nullptr};
        sgt_hits_f hits = {a.status.data(), a.floats_at(6), a.floats_at(7),
                           {a.floats_at(8), a.floats_at(9), a.floats_at(10)},
                           {a.floats_at(11), a.floats_at(12), a.floats_at(13)}, a.floats_at(14), {}};
        sgt_intersect_batch_f(ball, a.n, rays, hits, nullptr);
    }});
    all.push_back({"leave, sphere", false, intersect(ball), [ball](Arrays &a) {
        sgt_starts from = {{a.at(9), a.at(10), a.at(11)}, {a.at(12), a.at(13), a.at(14)}, a.at(8),
                           {a.at(3), a.at(4), a.at(5)}, nullptr, {}};
        sgt_hits h = {};
        h.t = a.at(21), h.t_err = a.at(22);
        sgt_leave_batch(ball, a.n, from, h, a.side.data(), nullptr);
    }});
    all.push_back({"differentiate, sphere", false, intersect(ball), [ball](Arrays &a) {
        sgt_jacobian out = {};
        for (size_t k = 0; k < 3; k++)
            out.t_by_o[k] = a.at(21 + k);
        sgt_differentiate_batch(ball, a.n, a.rays(), a.hits(), out);
    }});
    all.push_back({"trace, doublet", true, nothing, [](Arrays &a) {
        sgt_trace_batch(4, doublet.elements, 1, a.n, a.rays(), a.traced(), nullptr, nullptr);
    }});
    all.push_back({"trace_sensitivity, doublet", true, recorded, [](Arrays &a) {
        sgt_traces t = {a.n, a.rays(), a.passages};
        sgt_ray_changes change = {{a.at(0), a.at(1), a.at(2)}, {}, nullptr, {}},
                        out = {{a.at(21), a.at(22), a.at(23)}, {a.at(24), a.at(25), a.at(26)}, nullptr, {}};
        sgt_trace_sensitivity_batch(4, doublet.elements, 1, &t, 1, &change, &out);
    }});
    all.push_back({"trace_gradient, doublet", true, recorded, [](Arrays &a) {
        sgt_traces t = {a.n, a.rays(), a.passages};
        sgt_ray_changes weight = {{a.at(0), a.at(1), a.at(2)}, {}, nullptr, {}};
        sgt_trace_gradient_batch(4, doublet.elements, 1, &t, 1, &weight, a.gradient.data());
    }});
    all.push_back({"trace_error, doublet", true, recorded, [](Arrays &a) {
        sgt_traces t = {a.n, a.rays(), a.passages};
        sgt_trace_error_batch(4, doublet.elements, 1, &t, {a.at(21), a.at(22), nullptr, nullptr, {}});
    }});
    all.push_back({"aim, doublet", true, recorded, [](Arrays &a) {
        sgt_beam beam = {};
        beam.o = {0, 0, -5}, beam.ou = {1, 0, 0}, beam.ov = {0, 1, 0}, beam.d = {0, 0.01, 1};
        beam.u = {-12, 12}, beam.v = {-12, 12};
        sgt_passage room[3];
        sgt_aims aims = {a.n, a.points.data(), a.aims.data(), a.passages};
        sgt_aim_batch(2, doublet.elements, 1, &beam, &aims, room, nullptr);
    }});
    return all;
}

// ------------------------------------------------------------------------------- the clock

// Seconds that `times` passes take in each of `threads` threads.
double seconds(const Row &row, std::vector<std::unique_ptr<Arrays>> &arrays, size_t threads, size_t times)
{
    std::atomic<size_t> ready{0};
    std::atomic<bool> go{false};
    std::vector<std::thread> all;
    for (size_t i = 0; i < threads; i++)
        all.emplace_back([&, i] {
            ready++;
            while (!go)
                ;
            for (size_t k = 0; k < times; k++)
                row.pass(*arrays[i]);
        });
    while (ready != threads)
        ;
    auto start = std::chrono::steady_clock::now();
    go = true;
    for (std::thread &one : all)
        one.join();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

bool same(const Arrays &a, const Arrays &b)
{
    auto equal = [](const auto &x, const auto &y) {
        return std::memcmp(x.data(), y.data(), x.size() * sizeof x[0]) == 0;
    };
    return equal(a.numbers, b.numbers) && equal(a.floats, b.floats) && equal(a.more, b.more) &&
           equal(a.gradients, b.gradients);
}

// One line: case, rays, ns a ray of one thread, and what several gain.  false: the answers differ.
bool measure(const Row &row, size_t n, size_t threads)
{
    std::vector<std::unique_ptr<Arrays>> arrays(threads);
    std::vector<std::thread> made;
    for (std::unique_ptr<Arrays> &one : arrays)
        made.emplace_back([&] {
            one.reset(new Arrays(n, row.lens));
            row.prepare(*one);
        });
    for (std::thread &one : made)
        one.join();
    size_t times = 1;
    while (seconds(row, arrays, 1, times) < LEAST_SECONDS)
        times *= 2;
    seconds(row, arrays, threads, times);
    for (const std::unique_ptr<Arrays> &one : arrays)
        if (!same(*one, *arrays[0])) {
            std::printf("%s: the threads' answers differ\n", row.name.c_str());
            return false;
        }
    std::vector<double> gain, alone;
    for (int round = 0; round < ROUNDS; round++) {
        double one = seconds(row, arrays, 1, times), several = seconds(row, arrays, threads, times);
        gain.push_back(static_cast<double>(threads) * one / several);
        alone.push_back(1e9 * one / static_cast<double>(times * n));
    }
    std::nth_element(gain.begin(), gain.begin() + ROUNDS / 2, gain.end());
    std::nth_element(alone.begin(), alone.begin() + ROUNDS / 2, alone.end());
    std::printf("%s;%zu;%.3g;%.2f\n", row.name.c_str(), n, alone[ROUNDS / 2], gain[ROUNDS / 2]);
    std::fflush(stdout);
    return true;
}

} // namespace

int main(int argc, char **argv)
{
    size_t threads = argc > 1 ? std::strtoul(argv[1], nullptr, 10) : 2;
    if (threads < 1 || threads > 256) {
        std::fprintf(stderr, "bench_threads: %s is no number of threads from 1 to 256\n", argv[1]);
        return 2;
    }
    bench::catalogue::Kept kept;
    std::printf("row;rays;ns;gain\n");
    bool right = true;
    for (const Row &row : rows(kept))
        for (size_t n : {size_t(1000), size_t(bench::RAYS)})
            if (n == 1000 || !row.lens)
                right = measure(row, n, threads) && right;
    return right ? 0 : 1;
}
