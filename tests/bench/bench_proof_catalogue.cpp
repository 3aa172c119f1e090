// SPDX-License-Identifier: MIT
// The price of proof of each type of the catalogue: batches and single rays, proof root and first beside the
// estimate, the first root wanted.
//
//     build/tests/bench/bench_proof_catalogue [--runs N] [--only TEXT]
//
// The surfaces and 1000 rays of bench_subjects.h, and three more tori, of which one is a formula.  A run
// takes each of the three in turns, by the time of the processor that this thread has had.  Printed are
// medians over the runs (N: 15): nanoseconds a ray without proof, and how many times that the proofs take.
// open: rays that are UNPROVEN under first, in per cent.  Each answer under proof is compared with the
// estimate first: the same status and the same t to within both bounds, or UNPROVEN; and the batch with the
// single ray, to the bit.
#include <sagitta/formula.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "bench_clock.h"
#include "bench_subjects.h"

using namespace bench;
using namespace bench::catalogue;

namespace {

constexpr size_t N = 1000;
const sgt_proof PROOFS[3] = {SGT_ESTIMATE, SGT_PROVE_ROOT, SGT_PROVE_FIRST};

struct Answers {
    Answers() : status(N), t(N), t_err(N), p(3, std::vector<double>(N)), n(p) {}
    sgt_hits hits()
    {
        sgt_hits h = {};
        h.status = status.data(), h.t = t.data(), h.t_err = t_err.data();
        for (size_t k = 0; k < 3; k++)
            h.p[k] = p[k].data(), h.n[k] = n[k].data();
        return h;
    }
    std::vector<sgt_status> status;
    std::vector<double> t, t_err;
    std::vector<std::vector<double>> p, n;
};

sgt_rays given()
{
    static std::vector<double> in[6];
    for (size_t i = 0; in[5].size() < N; i++) {
        const sgt_ray &r = rays()[i];
        const double x[6] = {r.o.x, r.o.y, r.o.z, r.d.x, r.d.y, r.d.z};
        for (size_t k = 0; k < 6; k++)
            in[k].push_back(x[k]);
    }
    return {{in[0].data(), in[1].data(), in[2].data()}, {in[3].data(), in[4].data(), in[5].data()}, nullptr,
            nullptr};
}

void ask(sgt_surface s, sgt_proof proof, bool single, Answers &a)
{
    sgt_options opt = {};
    opt.pick = SGT_FIRST, opt.proof = proof;
    if (!single) {
        sgt_intersect_batch(s, N, given(), a.hits(), &opt);
        return;
    }
    for (size_t i = 0; i < N; i++) {
        sgt_hit h = sgt_intersect(s, rays()[i], &opt);
        a.status[i] = h.status, a.t[i] = h.t, a.t_err[i] = h.t_err;
    }
}

double median(std::vector<double> a)
{
    std::sort(a.begin(), a.end());
    return (a[(a.size() - 1) / 2] + a[a.size() / 2]) / 2;
}

size_t wrong;

// How many rays the proof leaves open.
size_t compare(const Subject &of, const Answers &estimate, sgt_proof proof)
{
    Answers batch, one;
    size_t open = 0;
    ask(of.s, proof, false, batch), ask(of.s, proof, true, one);
    for (size_t i = 0; i < N; i++) {
        bool apart = batch.status[i] != estimate.status[i] ||
                     (batch.status[i] > 0 &&
                      !(std::fabs(batch.t[i] - estimate.t[i]) <= batch.t_err[i] + estimate.t_err[i])),
             unlike = batch.status[i] != one.status[i] ||
                      (one.status[i] > 0 && std::memcmp(&batch.t[i], &one.t[i], sizeof one.t[i]) != 0);
        open += batch.status[i] == SGT_UNPROVEN;
        if (unlike || (apart && batch.status[i] != SGT_UNPROVEN)) {
            if (wrong++ < 10)
                std::printf("%s, ray %zu: another answer under proof, or in the batch\n", of.name.c_str(), i);
        }
    }
    return open;
}

// Nanoseconds a ray of the estimate, and the ratios of root and first.
void measure(const Subject &of, bool single, int runs, double told[3])
{
    Answers a;
    std::vector<double> all[3];
    for (int run = 0; run < runs; run++) {
        double ns[3];
        for (int k = 0; k < 3; k++) {
            int times = 0;
            double start = now(), spent;
            do
                ask(of.s, PROOFS[k], single, a), times++, spent = now() - start;
            while (spent < 0.5e6);
            ns[k] = spent / times / N;
        }
        all[0].push_back(ns[0]), all[1].push_back(ns[1] / ns[0]), all[2].push_back(ns[2] / ns[0]);
    }
    for (int k = 0; k < 3; k++)
        told[k] = median(all[k]);
}

// Clipped by a ball about the origin.
sgt_surface own_formula(Kept &kept, const char *text, double ball)
{
    static double room[4096];
    sgt_formula f = {};
    f.tape = sgt_formula_read(text, SGT_FORMULA_XYZ, 0, nullptr, room, sizeof room, nullptr);
    f.ball = ball;
    if (!f.tape)
        std::exit(2);
    return {&sgt_formula_ops, kept.keep(f)};
}

} // namespace

int main(int argc, char **argv)
{
    int runs = 15;
    std::string only;
    for (int i = 1; i + 1 < argc; i += 2) {
        if (std::strcmp(argv[i], "--runs") == 0)
            runs = std::atoi(argv[i + 1]);
        if (std::strcmp(argv[i], "--only") == 0)
            only = argv[i + 1];
    }
    Kept kept;
    std::vector<Subject> all = subjects(kept);
    all.push_back({"torus, spindle", "torus", {&sgt_torus_ops, kept.keep(sgt_torus{1, 1.6})}, false});
    all.push_back({"torus, thin", "torus", {&sgt_torus_ops, kept.keep(sgt_torus{2, 0.1})}, false});
    all.push_back({"torus, a formula", "formula",
                   own_formula(kept, "hypot(hypot(x, y) - 2, z) - 1.5", 4), false});
    std::printf("| | open, %% | batch, ns | root | first | single, ns | root | first |\n"
                "|---|---|---|---|---|---|---|---|\n");
    for (const Subject &of : all) {
        if (of.name.find(only) == std::string::npos)
            continue;
        Answers estimate;
        ask(of.s, SGT_ESTIMATE, false, estimate);
        compare(of, estimate, SGT_PROVE_ROOT);
        size_t open = compare(of, estimate, SGT_PROVE_FIRST);
        double batch[3], single[3];
        measure(of, false, runs, batch), measure(of, true, runs, single);
        std::printf("| %s | %.1f | %.4g | %.3g | %.3g | %.4g | %.3g | %.3g |\n", of.name.c_str(),
                    100.0 * static_cast<double>(open) / N, batch[0], batch[1], batch[2], single[0], single[1],
                    single[2]);
        std::fflush(stdout);
    }
    if (wrong)
        std::printf("%zu answers were wrong\n", wrong);
    return wrong != 0;
}
