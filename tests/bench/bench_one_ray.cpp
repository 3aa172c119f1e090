// SPDX-License-Identifier: MIT
// One ray at a time through sgt_intersect, beside what a person would otherwise
// write or take: Newton by hand, the closed form by hand, Boost.Math's
// newton_raphson_iterate, GSL's root_fdfsolver.  All do the same work on the same
// million rays in one run: t to rounding, the point, and the gradient of
// z - s(x, y).  That they do is checked before the clock starts.
//
//     build/tests/bench/bench_one_ray [--benchmark_... of Google Benchmark]
//
// The repetitions of all variants are shuffled among each other, so that a busy
// moment of the machine falls on no one side.  Ends with the medians as csv:
// case,variant,ns,per_second.
#include "bench_shared.h"

using namespace bench;

namespace {

double off(sgt_vec3 a, sgt_vec3 b)
{
    return std::max(std::fabs(a.x - b.x), std::max(std::fabs(a.y - b.y), std::fabs(a.z - b.z)));
}

bool same_work()
{
    bool same = true;
    for (const Case &s : CASES) {
        Surface ours(s);
        double worst[sizeof PEERS / sizeof PEERS[0]] = { 0 };
        size_t without = 0;
        for (const sgt_ray &ray : rays()) {
            sgt_hit hit = sgt_intersect(ours.surface(), ray, nullptr);
            without += hit.status != SGT_HIT;
            for (size_t v = 0; v < sizeof PEERS / sizeof PEERS[0]; v++)
                if (!s.asphere || PEERS[v].asphere) {
                    Answer a = PEERS[v].solve(s, ray);
                    double d = std::max(std::fabs(a.t - hit.t), std::max(off(a.p, hit.p), off(a.n, hit.n)));
                    worst[v] = d <= worst[v] ? worst[v] : d;
                }
        }
        // Lengths up to 6: one ulp of t is 8.9e-16.
        for (size_t v = 0; v < sizeof PEERS / sizeof PEERS[0]; v++)
            if (!(worst[v] < 8e-15)) {
                std::printf("%s, %s: off by %g\n", s.name, PEERS[v].name, worst[v]);
                same = false;
            }
        if (without) {
            std::printf("%s: %zu rays without a hit\n", s.name, without);
            same = false;
        }
    }
    return same;
}

} // namespace

int main(int argc, char **argv)
{
    if (!same_work())
        return 1;
    std::vector<Row> rows;
    for (const Case &s : CASES) {
        rows.push_back({ s.name, "sagitta", RAYS, [&s] {
            Surface ours(s);
            sgt_surface surface = ours.surface();
            for (const sgt_ray &ray : rays()) {
                sgt_hit hit = sgt_intersect(surface, ray, nullptr);
                benchmark::DoNotOptimize(hit);
            }
        } });
        for (const Peer &peer : PEERS)
            if (!s.asphere || peer.asphere)
                rows.push_back({ s.name, peer.name, RAYS, [&s, &peer] {
                    for (const sgt_ray &ray : rays()) {
                        Answer a = peer.solve(s, ray);
                        benchmark::DoNotOptimize(a);
                    }
                } });
    }
    Table table(rows);
    return run(rows, { "--benchmark_repetitions=7", "--benchmark_min_time=0.1" }, argc, argv, table) ? 0 : 2;
}
