// SPDX-License-Identifier: MIT
// The limit of the grating equation: rays at gratings on planes and spheres, in transmission and in
// reflection, whose order exists by a hair, or does not.  sgt_phase_at says where the limit is; per_wave is
// set beside it, by a part of 1e-8 down to less than an ulp.  The fates, of single rays and of a batch, are
// those of 113 bits, unless |t| is within 2^-50 (n1 + |G|) of n2, as system.h has it.  The normal and the
// slopes of W are taken as they stand in doubles.
//
// SAGITTA_TEST_SCALE multiplies the rays; SAGITTA_TEST_SEED replaces the seed.
#include "slow_trace.h"
#include "../oracle/cases.h"

#include <sagitta/aim.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

using namespace slow;

int main()
{
    const char *text = std::getenv("SAGITTA_TEST_SCALE"), *seed = std::getenv("SAGITTA_TEST_SEED");
    const double scale = text ? std::atof(text) : 0.5;
    const unsigned long long first = seed ? std::strtoull(seed, nullptr, 10) : 11;
    const long rays = std::max(1000L, long(2e6 * scale));
    oracle::generator random(first);
    long asked = 0, passed = 0, evanescent = 0, within = 0, faults = 0;
    double worst = 0; // how far from the limit a fate was wrong, of n1 + |G|, in 2^-53
    std::printf("SAGITTA_TEST_SEED=%llu\n", first);
    while (asked < rays) {
        const double n1 = random.uniform(1, 2), n2 = random.chance(0.3) ? n1 : random.uniform(1, 2);
        const bool mirror = random.chance(0.3), flat = random.chance(0.5);
        const sgt_conic bowl = {flat ? 0 : random.uniform(-0.3, 0.3), 0, 0};
        const bool along_y = random.chance(0.3);
        double a[4] = {0, random.uniform(-1000, 1000), along_y ? 0 : random.uniform(-1000, 1000), 0};
        sgt_polynomial_xy waves = {};
        waves.a = {a, 2, 2};
        sgt_phase phase = {};
        phase.kind = SGT_PHASE_SAG, phase.waves = {&sgt_polynomial_xy_ops, &waves};
        sgt_element e = {};
        e.surface = {&sgt_conic_ops, &bowl}, e.index = mirror ? SGT_MIRROR : n2, e.phase = &phase;
        const vec way = unit({random.uniform(-2, 2), random.uniform(-2, 2), random.sign()});
        const sgt_vec3 d = {to_double(way.x), to_double(way.y), to_double(way.z)};
        sgt_ray ray = {{random.uniform(-2, 2), random.uniform(-2, 2), 0}, d, 0, 0};
        const sgt_ray launch = ray;
        sgt_passage is;
        sgt_trace(1, &e, n1, &ray, &is, nullptr, nullptr);
        if (!(is.hit.status > 0)) continue;
        const sgt_phased at = sgt_phase_at(&e, n1, d, &is.hit);
        if (!(at.per_wave.lo < at.per_wave.hi)) continue;
        const vec n = unit(of(is.hit.n)), exact_d = unit(of(d));
        const quad limit = mirror ? n1 : n2;
        for (int k = 0; k < 64; k++) {
            const double end = random.chance(0.5) ? at.per_wave.lo : at.per_wave.hi;
            phase.per_wave = end * (1 + random.sign() * random.log_uniform(1e-17, 1e-8));
            const vec G = quad(phase.per_wave) * vec{a[2], a[1], 0};
            const vec u = quad(n1) * exact_d + G, t = u - inner(u, n) * n;
            const quad size = length(t);
            const double beyond = to_double((size - limit) / (n1 + length(G))) * 0x1p53;
            sgt_fate fate, batch;
            ray = launch;
            sgt_trace(1, &e, n1, &ray, &is, &fate, nullptr);
            double o[3] = {launch.o.x, launch.o.y, launch.o.z}, l[3] = {d.x, d.y, d.z};
            sgt_traced out = {};
            out.fate = &batch;
            const sgt_rays one = {{o, o + 1, o + 2}, {l, l + 1, l + 2}, nullptr, nullptr};
            sgt_trace_batch(1, &e, n1, 1, one, out, nullptr, nullptr);
            asked++, passed += fate == SGT_PASSED, evanescent += fate == SGT_EVANESCENT;
            within += std::fabs(beyond) <= 8;
            const bool right = fate == (beyond > 0 ? SGT_EVANESCENT : SGT_PASSED);
            if (!right) worst = std::max(worst, std::fabs(beyond));
            if (batch == fate && (right || (std::fabs(beyond) <= 8 && (fate == SGT_PASSED ||
                                                                       fate == SGT_EVANESCENT))))
                continue;
            if (faults++ < 10)
                std::printf("FAIL %s, in a batch %s, beyond the limit by %g: n %a to %a, per_wave %a\n",
                            sgt_fate_text(fate), sgt_fate_text(batch), beyond, n1, n2, phase.per_wave);
        }
    }
    std::printf("%ld rays: %ld passed, %ld evanescent, %ld within the rounding of the limit; a fate was "
                "wrong up to %.2g of 2^-53 from it\n", asked, passed, evanescent, within, worst);
    if (passed < asked / 4 || evanescent < asked / 4 || within < asked / 100 || within > asked / 2) {
        std::printf("FAIL too few\n");
        return 1;
    }
    return faults != 0;
}
