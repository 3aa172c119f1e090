// SPDX-License-Identifier: MIT
// The clear aperture of an element is the rim of its surface in a proof.
//
// Each type without a semi_diameter, behind an aperture, against the same with the aperture for its
// semi_diameter: what sgt_intersect proves of the one, root or first, near the seed, sgt_trace has to prove
// of the other.  And what a trace proves is so: of the judge's roots (judge.h) within the aperture there is
// one, within t_err.  sgt_trace_batch has the same bits.  Then rays parallel to the axis at the rim and a
// few ulps beside it, where r^2 in 113 bits says on which side they are: what is proven has to be so.  Then
// a lens of six odd aspheres in a few millimetres, conic constants up to 39 and slopes beyond a half, whose
// sags end or turn back not far behind the apertures: every ray of it is proven, singly and in a batch,
// near the axis and far off it.  And of rays past the aperture, without a proof, which a trace clips:
// within it the judge finds no root.
#include "judge.h"

#include <sagitta/system.h>

using namespace catalogue;

namespace {

long failures;

// The same parameters without a semi_diameter.
sgt_surface without_rim(specimen *s)
{
    for (const sgt_builtin *b = sgt_builtins(); b->type; b++)
        for (const sgt_param *p = b->params; b->ops == s->s.ops && p->name; p++) {
            if (std::string(p->name) != "semi_diameter") continue;
            std::vector<char> &copy = *s->keep(std::vector<char>(b->size));
            std::memcpy(copy.data(), s->s.self, b->size);
            std::memset(copy.data() + p->offset, 0, sizeof(double));
            return {s->s.ops, copy.data()};
        }
    return {nullptr, nullptr};
}

struct traced {
    sgt_fate fate;
    sgt_passage at;
};

// Many rays through one element, singly and together: the same, or it fails.
std::vector<traced> trace(const sgt_element &e, const std::vector<sgt_ray> &rays, const sgt_options &opt,
                          const char *type)
{
    const std::size_t n = rays.size();
    std::vector<double> a[6], told[8];
    std::vector<sgt_fate> fate(n);
    std::vector<sgt_status> status(n);
    std::vector<int> evals(n);
    for (std::vector<double> &x : a) x.resize(n);
    for (std::vector<double> &x : told) x.resize(n);
    for (std::size_t i = 0; i < n; i++) {
        const double numbers[6] = {rays[i].o.x, rays[i].o.y, rays[i].o.z,
                                   rays[i].d.x, rays[i].d.y, rays[i].d.z};
        for (int k = 0; k < 6; k++) a[k][i] = numbers[k];
    }
    sgt_passages p = {};
    p.hits.status = status.data(), p.hits.evals = evals.data(), p.hits.t = told[0].data(),
    p.hits.t_err = told[1].data(), p.hits.t_lo = told[2].data();
    p.hits.p_err = told[3].data(), p.opl = told[4].data();
    for (int k = 0; k < 3; k++) p.hits.p[k] = told[5 + k].data();
    sgt_traced out = {};
    out.fate = fate.data();
    sgt_trace_batch(
        1, &e, 1, n,
        {{a[0].data(), a[1].data(), a[2].data()}, {a[3].data(), a[4].data(), a[5].data()}, nullptr, nullptr},
        out, &p, &opt);
    std::vector<traced> all(n);
    for (std::size_t i = 0; i < n; i++) {
        sgt_ray ray = rays[i];
        sgt_trace(1, &e, 1, &ray, &all[i].at, &all[i].fate, &opt);
        const sgt_hit &h = all[i].at.hit;
        const double one[8] = {h.t, h.t_err, h.t_lo, h.p_err, all[i].at.opl, h.p.x, h.p.y, h.p.z};
        bool same = fate[i] == all[i].fate && status[i] == h.status && evals[i] == h.evals;
        for (int k = 0; k < 8; k++)
            same = same && (one[k] == told[k][i] || (one[k] != one[k] && told[k][i] != told[k][i]));
        if (!same && failures++ < 12)
            std::printf("FAIL %s: ray %zu of a batch is not the single one: %s %s evals %d t %a +- %a, %s %s "
                        "evals %d t %a +- %a\n",
                        type, i, sgt_fate_text(sgt_fate(fate[i])), sgt_status_text(sgt_status(status[i])),
                        evals[i], told[0][i], told[1][i], sgt_fate_text(all[i].fate),
                        sgt_status_text(h.status), h.evals, h.t, h.t_err);
    }
    return all;
}

// A ray at a point within the aperture, of unit length.
sgt_ray aimed(generator &g, const subject &of, double h)
{
    const double r = h * std::sqrt(g.uniform(0, 0.98)), a = g.uniform(0, 6.2831853), x = r * std::cos(a),
                 y = r * std::sin(a), z = -of.rough(x, y, 0.0);
    const double tilt = g.chance(0.8) ? g.uniform(0, 0.8) : g.uniform(0, 1.5), b = g.uniform(0, 6.2831853),
                 away = h * g.log_uniform(0.5, 30);
    const sgt_vec3 d = {std::sin(tilt) * std::cos(b), std::sin(tilt) * std::sin(b), std::cos(tilt)};
    return {{x - away * d.x, y - away * d.y, z - away * d.z}, d, -HUGE_VAL, HUGE_VAL};
}

sgt_ray global(const sgt_pose &p, sgt_ray ray)
{
    if (p.ex.x == 0 && p.ey.y == 0) return ray;
    auto turned = [&](sgt_vec3 a) {
        return sgt_vec3{a.x * p.ex.x + a.y * p.ey.x + a.z * p.ez.x,
                        a.x * p.ex.y + a.y * p.ey.y + a.z * p.ez.y,
                        a.x * p.ex.z + a.y * p.ey.z + a.z * p.ez.z};
    };
    ray.o = turned(ray.o), ray.d = turned(ray.d);
    ray.o = {ray.o.x + p.origin.x, ray.o.y + p.origin.y, ray.o.z + p.origin.z};
    return ray;
}

void types_by_aperture(generator &g, double scale)
{
    std::printf("%-14s %7s %9s %9s %9s\n", "type", "rays", "intersect", "trace", "alone");
    for (const char *type : sags) {
        long asked = 0, by_rim = 0, by_trace = 0, alone = 0;
        for (int i = 0; i < std::max(1, static_cast<int>(30 * scale)); i++) {
            specimen s;
            do s = random_specimen(g, type); while (!(s.rim > 0));
            const subject of(s);
            sgt_element e = {};
            e.surface = without_rim(&s), e.semi_diameter = s.rim;
            std::vector<sgt_ray> rays;
            for (int j = 0; j < 12; j++) {
                const sgt_ray ray = aimed(g, of, s.rim);
                if (ray.o.z == ray.o.z) rays.push_back(ray);
            }
            for (sgt_proof proof : {SGT_PROVE_ROOT, SGT_PROVE_FIRST}) {
                sgt_options opt = {};
                opt.proof = proof, opt.pick = SGT_NEAR_SEED;
                const std::vector<traced> all = trace(e, rays, opt, type);
                for (std::size_t j = 0; j < rays.size(); j++) {
                    const sgt_hit a = sgt_intersect(s.s, rays[j], &opt), &b = all[j].at.hit;
                    asked++, by_rim += a.status == SGT_HIT,
                        by_trace += all[j].fate == SGT_PASSED && b.status == SGT_HIT;
                    const char *wrong = nullptr;
                    if (a.status == SGT_HIT && !(all[j].fate == SGT_PASSED && b.status == SGT_HIT))
                        wrong = "not proven by the trace";
                    else if (proof == SGT_PROVE_FIRST && a.status == SGT_HIT &&
                             !(std::fabs(a.t - b.t) <= a.t_err + b.t_err + 1e-13 * s.rim))
                        wrong = "another root";
                    if (b.status == SGT_HIT && proof == SGT_PROVE_FIRST && j < 3) {
                        const judgement is(of, rays[j], 300);
                        int inside = 0, near = 0, edge = 0;
                        for (const root &r : is.roots) {
                            near += oracle::magnitude(r.t - b.t) <= quad(b.t_err) + quad(4e-15) * s.rim;
                            inside += !r.edge, edge += r.edge;
                        }
                        alone++;
                        if (is.doubtful.empty() && !edge && (inside != 1 || near != 1))
                            wrong = "proven to be alone, and it is not";
                    }
                    if (wrong && failures++ < 12) {
                        std::printf("FAIL %s, proof %d: %s: %s t %.17g +- %g; %s %s t %.17g +- %g\n", type,
                                    proof, wrong, sgt_status_text(a.status), a.t, a.t_err,
                                    sgt_fate_text(all[j].fate), sgt_status_text(b.status), b.t, b.t_err);
                        print_surface(s.s);
                        std::printf("    ray {{%a, %a, %a}, {%a, %a, %a}}\n", rays[j].o.x, rays[j].o.y,
                                    rays[j].o.z, rays[j].d.x, rays[j].d.y, rays[j].d.z);
                    }
                }
            }
        }
        std::printf("%-14s %7ld %9ld %9ld %9ld\n", type, asked, by_rim, by_trace, alone);
    }
}

// A rise and a fall beyond the rim: a ray may be met outside, and twice within.
specimen hump(generator &g, bool even)
{
    specimen s = {};
    s.type = even ? "even_asphere" : "odd_asphere", s.sag = true, s.rim = s.h = g.uniform(0.5, 2);
    const double wide = g.uniform(1.2, 1.6) * s.rim, high = g.uniform(-2, 2), a2 = high / wide,
                 a4 = -a2 / wide / wide;
    if (even) s.s = {&sgt_even_asphere_ops, s.keep(sgt_even_asphere{0, 0, s.rim, {a2, a4}})};
    else s.s = {&sgt_odd_asphere_ops, s.keep(sgt_odd_asphere{0, 0, s.rim, {0, a2, 0, a4}})};
    return s;
}

specimen with_rim(generator &g, const std::string &type)
{
    specimen s = {};
    if (type == "hump") return hump(g, g.chance(0.5));
    if (type != "conic" && type != "asphere") {
        do s = random_specimen(g, type); while (!(s.rim > 0));
        return s;
    }
    s.type = type, s.sag = true, s.rim = s.h = g.uniform(0.5, 2);
    const double c = g.chance(0.1) ? 0 : g.uniform(-0.65, 0.65) / s.rim;
    const sgt_even_asphere a = {
        c, g.uniform(-2, 1), s.rim, {0, g.uniform(-0.1, 0.1) / s.rim / s.rim / s.rim}};
    if (type == "conic") s.s = {&sgt_conic_ops, s.keep(sgt_conic{a.c, a.k, a.semi_diameter})};
    else s.s = {&sgt_even_asphere_ops, s.keep(a)};
    return s;
}

// A ray that a trace clips meets the surface outside the aperture, and nowhere within: of the judge's roots
// there is none.
void clipped(generator &g, double scale)
{
    std::printf("%-14s %7s %9s %9s %9s\n", "clipped", "rays", "passed", "clipped", "judged");
    for (const char *type : types_of({"conic", "asphere", "hump"}, true, false)) {
        long asked = 0, passed = 0, stopped = 0, judged = 0;
        for (int i = 0; i < std::max(1, static_cast<int>(30 * scale)); i++) {
            const specimen s = with_rim(g, type);
            const subject of(s);
            sgt_element e = {};
            specimen bare = s;
            e.surface = g.chance(0.8) ? without_rim(&bare) : s.s, e.semi_diameter = s.rim, e.index = 1.3;
            if (g.chance(0.3)) e.pose = sgt_pose_tilted({g.uniform(-1, 1), 0, 0}, {g.uniform(-20, 20), 0, 0});
            std::vector<sgt_ray> rays, local;
            for (int j = 0; j < 20; j++) {
                const sgt_ray ray = aimed(g, of, g.uniform(0.8, 1.6) * s.rim);
                if (ray.o.z != ray.o.z) continue;
                rays.push_back(global(e.pose, ray)), local.push_back(ray);
            }
            sgt_options opt = {};
            opt.pick = g.chance(0.7) ? SGT_NEAR_SEED : SGT_FIRST;
            const std::vector<traced> all = trace(e, rays, opt, type);
            for (std::size_t j = 0; j < rays.size(); j++) {
                asked++, passed += all[j].fate == SGT_PASSED, stopped += all[j].fate == SGT_CLIPPED;
                if (all[j].fate != SGT_CLIPPED) continue;
                const judgement is(of, local[j], 300);
                long inside = 0;
                for (const root &r : is.roots) inside += !r.edge;
                judged++;
                if (inside && is.doubtful.empty() && failures++ < 12) {
                    std::printf("FAIL %s: clipped at t %.17g +- %g, and %ld roots inside, at %.17g\n", type,
                                all[j].at.hit.t, all[j].at.hit.t_err, inside, plain(is.roots[0].t));
                    print_surface(e.surface);
                    std::printf("    aperture %a, ray {{%a, %a, %a}, {%a, %a, %a}}\n", s.rim, local[j].o.x,
                                local[j].o.y, local[j].o.z, local[j].d.x, local[j].d.y, local[j].d.z);
                }
            }
        }
        std::printf("%-14s %7ld %9ld %9ld %9ld\n", type, asked, passed, stopped, judged);
    }
}

// The side of the rim is told from rounded coordinates, and where rounding hides it nothing is proven.
void on_the_rim(generator &g, double scale)
{
    std::printf("%-14s %7s %9s %9s %9s\n", "on the rim", "rays", "hits", "misses", "unproven");
    for (const char *type : types_of({"conic", "asphere"}, true, false)) {
        long asked = 0, hits = 0, misses = 0, unproven = 0;
        for (int i = 0; i < std::max(1, static_cast<int>(20 * scale)); i++) {
            const specimen s = with_rim(g, type);
            const bool even = s.type == "conic" || s.type == "asphere";
            const quad rim2 = quad(s.rim * s.rim * (1 + 0x1p-44)); // as the header says, in doubles
            for (int j = 0; j < 40; j++) {
                const double a = g.chance(0.3) ? 1.5707963267948966 * g.below(4) : g.uniform(0, 6.2831853),
                             r = s.rim * (1 + 0x1p-45) *
                                 (1 + (g.below(33) - 16) * (g.chance(0.3) ? 0x1p-46 : 0x1p-53));
                const double x = g.chance(0.2) ? r : r * std::cos(a), y = x == r ? 0 : r * std::sin(a),
                             below = 3 * s.rim;
                const sgt_ray ray = {{x, y, -below}, {0, 0, 1}, -HUGE_VAL, HUGE_VAL};
                const double there = s.s.ops->value(s.s.self, ray.o, nullptr);
                if (there != there) continue; // beyond the edge of a grid
                const quad beyond = quad(x) * x + quad(y) * y - rim2;
                const bool hidden = oracle::magnitude(beyond) <= rim2 * quad(0x1p-46);
                for (int ask = 0; ask < 4; ask++) {
                    sgt_options opt = {};
                    opt.proof = ask & 1 ? SGT_PROVE_FIRST : SGT_PROVE_ROOT,
                    opt.pick = ask & 2 ? SGT_NEAR_SEED : SGT_FIRST;
                    sgt_hit h = sgt_intersect(s.s, ray, &opt);
                    for (int traced = 0; traced < (ask & 2 ? 2 : 1); traced++) {
                        if (traced) { // by the slope, mostly
                            sgt_element e = {};
                            sgt_ray way = ray;
                            sgt_passage p;
                            e.surface = s.s;
                            sgt_trace(1, &e, 1, &way, &p, nullptr, &opt);
                            h = p.hit;
                        }
                        asked++, hits += h.status == SGT_HIT, misses += h.status == SGT_MISS,
                            unproven += h.status == SGT_UNPROVEN;
                        const bool wrong = (h.status == SGT_HIT && beyond > 0) ||
                                           (h.status == SGT_MISS && beyond < 0) ||
                                           (h.status == SGT_UNPROVEN && !hidden && even);
                        if (wrong && failures++ < 12) {
                            std::printf("FAIL %s on the rim, %s, proof %d, pick %d: %s, r^2 is %.3g beyond\n",
                                        type, traced ? "traced" : "met", opt.proof, opt.pick,
                                        sgt_status_text(h.status), plain(beyond / rim2));
                            print_surface(s.s);
                            std::printf("    x %a y %a\n", x, y);
                        }
                    }
                }
            }
        }
        std::printf("%-14s %7ld %9ld %9ld %9ld\n", type, asked, hits, misses, unproven);
    }
}

void lens_of_six()
{
    static const sgt_odd_asphere six[6] = {
        {1 / 1.9, 0.4, 0, {0, 0, 0.004, -0.012, 0.003, 0.006, -0.002, -0.004}},
        {-1 / 7.6, 39.18, 0, {0, 0, 0.006, 0.03, -0.01, -0.02, 0.004, 0.006}},
        {-1 / 5.1, 3.7, 0, {0, 0, 0.01, 0.06, -0.02, -0.03, 0.01, 0.008}},
        {1 / 6.9, 22.5, 0, {0, 0, 0, 0.05, -0.01, 0.01, 0, -0.005}},
        {1 / 11.0, 39.18, 0, {0, 0, -0.02, -0.05, 0.02, 0.01, 0, -0.002}},
        {-1 / 3.2, -4, 0, {0, 0, 0.05, -0.06, 0.01, 0.006, -0.002, 0}}};
    const double semi_diameter[6] = {0.85, 0.95, 0.95, 1.0, 1.3, 1.4},
                 thickness[6] = {0.7, 0.15, 0.3, 0.6, 0.7, 0}, index[6] = {1.544, 1, 1.639, 1, 1.544, 1};
    sgt_element e[6] = {};
    double z = 0;
    for (int i = 0; i < 6; z += thickness[i], i++)
        e[i].surface = {&sgt_odd_asphere_ops, &six[i]}, e[i].pose.origin.z = z, e[i].index = index[i],
        e[i].semi_diameter = semi_diameter[i];
    for (double degrees : {0.0, 10.0, 25.0})
        for (sgt_proof proof : {SGT_PROVE_ROOT, SGT_PROVE_FIRST}) {
            std::vector<double> a[6];
            const double angle = degrees * 3.141592653589793 / 180;
            for (int i = 0; i < 2025; i++) {
                const double start[6] = {0.5 * ((i % 45) / 22.0 - 1),
                                         0.5 * ((i / 45) / 22.0 - 1) - std::tan(angle),
                                         -1,
                                         0,
                                         std::sin(angle),
                                         std::cos(angle)};
                for (int k = 0; k < 6; k++) a[k].push_back(start[k]);
            }
            sgt_options opt = {};
            opt.proof = proof;
            long single = 0;
            for (std::size_t i = 0; i < 2025; i++) {
                sgt_ray ray = {{a[0][i], a[1][i], a[2][i]}, {a[3][i], a[4][i], a[5][i]}, 0, 0};
                single += sgt_trace(6, e, 1, &ray, nullptr, nullptr, &opt) == 6;
            }
            const std::size_t together = sgt_trace_batch(6, e, 1, 2025,
                                                         {{a[0].data(), a[1].data(), a[2].data()},
                                                          {a[3].data(), a[4].data(), a[5].data()},
                                                          nullptr,
                                                          nullptr},
                                                         {}, nullptr, &opt);
            std::printf("six odd aspheres, %g degrees, %s: %ld of 2025 proven, %zu of them in a batch\n",
                        degrees, proof == SGT_PROVE_ROOT ? "root" : "first", single, together);
            if (single != 2025 || together != 2025) failures++, std::printf("FAIL: not all\n");
        }
}

} // namespace

int main()
{
    const char *seed_given = std::getenv("SAGITTA_TEST_SEED"),
               *scale_given = std::getenv("SAGITTA_TEST_SCALE");
    const std::uint64_t seed = seed_given ? std::strtoull(seed_given, nullptr, 0) : 20261123;
    std::printf("seed %llu\n", static_cast<unsigned long long>(seed));
    generator g(seed);
    types_by_aperture(g, scale_given ? std::atof(scale_given) : 0.5);
    clipped(g, scale_given ? std::atof(scale_given) : 0.5);
    on_the_rim(g, scale_given ? std::atof(scale_given) : 0.5);
    lens_of_six();
    if (failures) std::printf("%ld failures\n", failures);
    return failures != 0;
}
