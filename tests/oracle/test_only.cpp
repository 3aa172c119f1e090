// SPDX-License-Identifier: MIT
// The only root, under proof: even aspheres, and rays at any tilt to 89.9 degrees from the axis, against
// every root in quadruple precision (quad.h).
//
//   the only one  where the root near the seed is a hit under SGT_PROVE_FIRST, no other root of the ray
//     counts;
//   decided       most rays that have one root are hits: the proof is no refusal;
//   leaving       rays that begin in the vertex, or behind the vertex plane, or behind the surface, with
//                 tmin = 0 or
//                 later, by every pick and proof, alone and in a batch: a miss has no root that counts.
//   one in t_err  under either proof a hit has exactly one root within t_err, accepted or not: conics and
//                 aspheres without a rim, from 1 to 1e20 times their size away, by every pick.  From so
//                 far t is rounded by more than the roots are apart, and no t_err holds one alone.
#include "cases.h"
#include "quad.h"

using namespace oracle;

namespace {

int failures = 0;

bool is_of(const meeting &m, const sgt_hit &h)
{
    return magnitude(m.minus(h.t)) <= quad(h.t_err) * (1 + quad(1e-9)) + m.blur;
}

void fail(const char *why, const test_case &t, const answer &a, const sgt_hit &h)
{
    if (failures++ >= 10) return;
    std::printf("FAIL %s: %s t %.17g +- %.3g [%.17g, %.17g]\n    ", why, sgt_status_text(h.status), h.t,
                h.t_err, h.lo, h.hi);
    print_case(stdout, t);
    std::printf("\n");
    for (const meeting &m : a.roots)
        std::printf("    root %s%s\n", text(m.t()).c_str(), m.edge ? " (edge)" : "");
}

// A ray through a point inside h; in half of the cases nearly parallel to the vertex plane.
test_case tilted_case(generator &g)
{
    test_case t;
    do t = random_case(g); while (!t.asphere);
    const double pi = 3.141592653589793, r = t.h * std::sqrt(g.uniform(0, 1)), at = g.uniform(0, 2 * pi),
                 about = g.uniform(0, 2 * pi);
    const double tilt = (g.chance(0.5) ? g.uniform(0, 89.9) : g.uniform(70, 88)) * pi / 180,
                 away = t.h * g.log_uniform(1e-2, 1e2);
    const double z = rough_sag(t.surface, r * r) * g.uniform(0.9, 1.1);
    t.ray.d = {std::sin(tilt) * std::cos(about), std::sin(tilt) * std::sin(about), g.sign() * std::cos(tilt)};
    t.ray.o = {r * std::cos(at) - away * t.ray.d.x, r * std::sin(at) - away * t.ray.d.y,
               z - away * t.ray.d.z};
    t.ray.tmin = g.chance(0.5) ? 0 : away + t.h * g.uniform(-1, 1);
    t.ray.tmax = g.chance(0.5) ? HUGE_VAL : t.ray.tmin + t.h * g.log_uniform(0.1, 10);
    if (!g.chance(0.3)) t.ray.tmin = -HUGE_VAL, t.ray.tmax = HUGE_VAL;
    return t;
}

// Mostly without a rim; the start is the ray's origin, or later.
test_case leaving_case(generator &g)
{
    test_case t = tilted_case(g);
    if (g.chance(0.7)) t.surface.semi_diameter = 0;
    const double r = t.h * std::sqrt(g.uniform(0, 1)), at = g.uniform(0, 6.283185307179586);
    t.ray.d.z = std::fabs(t.ray.d.z) * (t.surface.c < 0 ? -1 : 1);
    t.ray.o = {0, 0, 0};
    if (g.chance(0.6))
        t.ray.o = {r * std::cos(at), r * std::sin(at), rough_sag(t.surface, r * r) * g.uniform(0, 3)};
    t.ray.tmin = g.chance(0.4) ? 0 : t.h * g.log_uniform(1e-6, 10);
    t.ray.tmax = g.chance(0.5) ? HUGE_VAL : t.ray.tmin + t.h * g.log_uniform(0.1, 10);
    return t;
}

// The misses of all ways to ask, told.
long misses_of(const test_case &t, const answer &a)
{
    long misses = 0;
    const sgt_surface s = {&sgt_even_asphere_ops, &t.surface};
    for (int proof = 0; proof < 3; proof++)
        for (int pick = SGT_FIRST; pick <= SGT_NEAR_SEED; pick++) {
            sgt_options o = {};
            o.proof = static_cast<sgt_proof>(proof), o.pick = static_cast<sgt_pick>(pick);
            const sgt_hit h = sgt_intersect(s, t.ray, &o);
            const sgt_ray &r = t.ray;
            sgt_status status;
            int evals;
            sgt_hits out = {};
            out.status = &status, out.evals = &evals;
            sgt_intersect_batch(s, 1, {{&r.o.x, &r.o.y, &r.o.z}, {&r.d.x, &r.d.y, &r.d.z}, &r.tmin, &r.tmax},
                                out, &o);
            if (status != h.status || evals != h.evals) fail("a batch says something else", t, a, h);
            if (h.status != SGT_MISS) continue;
            misses++;
            for (const meeting &m : a.roots)
                if (counting(m, t.ray.tmin, t.ray.tmax) == yes) fail("a miss that meets", t, a, h);
        }
    return misses;
}

// From far away, at any tilt to 85 degrees or nearly along a tangent.
test_case far_case(generator &g)
{
    test_case t = g.chance(0.3) ? random_narrow_case(g) : random_case(g);
    if (!t.asphere || g.chance(0.5))
        for (double &a : t.surface.a) a = 0;
    t.asphere = false;
    for (double a : t.surface.a) t.asphere = t.asphere || a != 0;
    t.surface.semi_diameter = 0;
    const double away = t.h * g.log_uniform(1, 1e20) /
                        std::sqrt(t.ray.d.x * t.ray.d.x + t.ray.d.y * t.ray.d.y + t.ray.d.z * t.ray.d.z);
    const double r = t.h * std::sqrt(g.uniform(0, 1)), at = g.uniform(0, 6.283185307179586),
                 x = r * std::cos(at), y = r * std::sin(at), z = rough_sag(t.surface, r * r);
    if (!t.narrow)
        t.ray.o = {x - away * t.ray.d.x, y - away * t.ray.d.y, z - away * t.ray.d.z};
    if (!t.narrow && g.chance(0.3)) t.ray.d.x = t.ray.d.y = 0, t.ray.o.x = x, t.ray.o.y = y;
    t.ray.tmin = -HUGE_VAL, t.ray.tmax = HUGE_VAL;
    if (g.chance(0.3)) t.ray.tmin = 0;
    return t;
}

// told[0]: hits; told[1]: refusals on a ray that has roots.
void alone_within(const test_case &t, long told[2])
{
    sgt_conic conic;
    const sgt_surface s = as_surface(t, &conic);
    const answer a = all_roots(surface(t.surface), t.ray);
    if (a.gave_up || !a.doubtful.empty()) return;
    for (int proof = SGT_PROVE_ROOT; proof <= SGT_PROVE_FIRST; proof++)
        for (int pick = SGT_FIRST; pick <= SGT_NEAR_SEED; pick++) {
            sgt_options o = {};
            o.proof = static_cast<sgt_proof>(proof), o.pick = static_cast<sgt_pick>(pick);
            sgt_hit h = sgt_intersect(s, t.ray, &o);
            for (int batch = 0; batch < 2; batch++) {
                sgt_status status;
                sgt_hits out = {};
                out.status = &status, out.t = &h.t, out.t_err = &h.t_err;
                const sgt_ray &r = t.ray;
                if (batch) {
                    const sgt_rays one = {
                        {&r.o.x, &r.o.y, &r.o.z}, {&r.d.x, &r.d.y, &r.d.z}, &r.tmin, &r.tmax};
                    sgt_intersect_batch(s, 1, one, out, &o);
                    h.status = static_cast<sgt_status>(status);
                }
                if (h.status < 0 && !a.roots.empty()) told[1]++;
                if (h.status != SGT_HIT) continue;
                told[0]++;
                long within = 0, surely = 0;
                for (const meeting &m : a.roots) {
                    within += is_of(m, h);
                    surely += magnitude(m.minus(h.t)) <= quad(h.t_err) * (1 - quad(1e-9)) - m.blur;
                }
                if (surely > 1) fail("proven, and two roots within t_err", t, a, h);
                if (within < 1) fail("proven, and no root within t_err", t, a, h);
            }
        }
}

}  // namespace

int main(int argc, char **argv)
{
    const run r(argc, argv, 6000, 14);
    generator g(r.seed);
    long single = 0, decided = 0, several = 0, vague = 0;
    for (long i = 0; i < r.count; i++) {
        const test_case t = tilted_case(g);
        const answer a = all_roots(surface(t.surface), t.ray);
        if (!a.doubtful.empty() || a.gave_up) {
            vague++;
            continue;
        }
        sgt_options o = {};
        o.proof = SGT_PROVE_FIRST, o.pick = SGT_NEAR_SEED;
        const sgt_hit h = sgt_intersect({&sgt_even_asphere_ops, &t.surface}, t.ray, &o);
        long sure = 0, maybe = 0;
        for (const meeting &m : a.roots) {
            const counts k = counting(m, t.ray.tmin, t.ray.tmax);
            sure += k == yes, maybe += k == perhaps;
            if (k == yes && h.status == SGT_HIT && !is_of(m, h)) fail("the only one, and another", t, a, h);
            if (k == yes && h.status == SGT_MISS) fail("a miss that meets", t, a, h);
        }
        several += sure > 1;
        if (sure != 1 || maybe) continue;
        single++, decided += h.status == SGT_HIT;
    }
    std::printf("%ld rays of one root, %ld proven to be; %ld of several, %ld too close to tell\n", single,
                decided, several, vague);
    long misses = 0, leaving = 0;
    for (long i = 0; i < r.count; i++) {
        const test_case t = leaving_case(g);
        const answer a = all_roots(surface(t.surface), t.ray);
        if (a.gave_up || !a.doubtful.empty()) continue;
        leaving++, misses += misses_of(t, a);
    }
    std::printf("%ld rays that leave, %ld misses of %ld answers\n", leaving, misses, 6 * leaving);
    long told[2] = {0, 0};
    for (long i = 0; i < r.count; i++) alone_within(far_case(g), told);
    std::printf("%ld proven hits from afar, %ld refusals\n", told[0], told[1]);
    if (told[0] < r.count || told[1] < r.count / 50)
        failures++, std::printf("FAIL: these rays are no test\n");
    if (static_cast<double>(decided) < 0.97 * static_cast<double>(single))
        failures++, std::printf("FAIL: too few are decided\n");
    return failures != 0;
}
