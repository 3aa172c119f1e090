// SPDX-License-Identifier: MIT
// A batch of rays on each surface of the catalogue is what each ray alone is, to the bit: hostile rays,
// options and parameters beside ordinary ones, any number of rays, outputs left out, arrays that nobody may
// write beyond.  And so with lenses of such surfaces: sgt_trace_batch is sgt_trace.
#include "../batch/soil.h"
#include "judge.h"

#include <sagitta/system.h>

using namespace catalogue;

namespace {

std::map<std::string, long> failed;
enum { most = 600, guard = 16 };

bool same(double a, double b) { return !std::memcmp(&a, &b, sizeof a) || (a != a && b != b); }
bool same(const sgt_vec3 &a, const sgt_vec3 &b) { return same(a.x, b.x) && same(a.y, b.y) && same(a.z, b.z); }

double hostile_number(generator &g)
{
    static const double bad[] = {0,     -0.0,    0x1p-1074, 0x1p-1022, -1e-300,  1e-160,   1e-16,
                                 1,     -1,      1e8,       -1e16,     1e100,    1e154,    -1e160,
                                 1e300, DBL_MAX, -DBL_MAX,  NAN,       HUGE_VAL, -HUGE_VAL};
    if (g.chance(0.2)) {
        const std::uint64_t bits = g.bits();
        double x;
        std::memcpy(&x, &bits, sizeof x);
        return x;
    }
    return bad[g.below(sizeof bad / sizeof bad[0])];
}

double *component(sgt_ray &r, int i)
{
    double *const all[] = {&r.o.x, &r.o.y, &r.o.z, &r.d.x, &r.d.y, &r.d.z, &r.tmin, &r.tmax};
    return all[i];
}

sgt_ray hostile_ray(generator &g, const subject &of)
{
    sgt_ray r = random_ray(g, of, static_cast<ray_kind>(g.below(ray_kinds)));
    switch (g.below(8)) {
    case 0:
        for (int n = 1 + g.below(3); n > 0; n--) *component(r, g.below(8)) = hostile_number(g);
        break;
    case 1: {
        const double k = std::pow(10, g.uniform(-320, 308)),
                     j = g.chance(0.5) ? 1 : std::pow(10, g.uniform(-320, 308));
        for (int i = 0; i < 6; i++) *component(r, i) *= i < 3 ? k : j;
        break;
    }
    case 2: r.d = {0, 0, g.sign()}; break;
    case 3: r.o = {0, 0, g.chance(0.5) ? 0 : -of.s.h}; break;
    case 4: {
        r.tmin = -HUGE_VAL, r.tmax = HUGE_VAL;
        const sgt_hit h = sgt_intersect(of.s.s, r, nullptr);
        if (h.status > 0) {
            const double at = std::nextafter(h.t, g.chance(0.5) ? HUGE_VAL : -HUGE_VAL);
            (g.chance(0.5) ? r.tmin : r.tmax) = g.chance(0.5) ? h.t : at;
        }
        break;
    }
    default: break;
    }
    return r;
}

sgt_options hostile_options(generator &g)
{
    sgt_options o = {};
    if (g.chance(0.4)) return o;
    o.pick = static_cast<sgt_pick>(g.below(3));
    if (g.chance(0.3)) o.t_tol = std::pow(10, g.uniform(-16, 1));
    if (g.chance(0.2)) o.max_evals = 1 + g.below(60);
    if (g.chance(0.1)) o.dt_min = std::pow(10, g.uniform(-3, 0));
    if (g.chance(0.3)) o.proof = g.chance(0.5) ? SGT_PROVE_ROOT : SGT_PROVE_FIRST;
    if (g.chance(0.02)) o.t_tol = NAN;
    return o;
}

// Any number of the struct's own.
void spoil(generator &g, specimen *s)
{
    int numbers = 0;
    for (const sgt_param *p = row_named(s->type)->params; p->name; p++)
        if (p->kind == SGT_PARAM_REAL || p->kind == SGT_PARAM_VECTOR) numbers += p->count;
    first_number(s->s)[g.below(numbers)] = g.chance(0.5) ? hostile_number(g) : g.uniform(-2, 2);
    if (s->sag) s->rim = *rim_of(*s);
}

struct array {
    std::vector<double> room;
    std::size_t from;
    bool wanted;
    array(generator &g, std::size_t n, bool want)
        : room(n + 2 * guard, -77), from(guard / 2 + static_cast<std::size_t>(g.below(8))), wanted(want)
    {
    }
    double *data() { return wanted ? room.data() + from : nullptr; }
    bool kept(std::size_t n) const
    {
        for (std::size_t i = 0; i < room.size(); i++)
            if (room[i] != -77 && !(wanted && i >= from && i < from + n)) return false;
        return true;
    }
};

void print_ray(const sgt_ray &r)
{
    std::printf("    ray {{%a, %a, %a}, {%a, %a, %a}, %a, %a}\n", r.o.x, r.o.y, r.o.z, r.d.x, r.d.y, r.d.z,
                r.tmin, r.tmax);
}
void print_hit(const char *name, const sgt_hit &h)
{
    std::printf("    %s %s evals %d t %a t_err %a t_lo %a p %a %a %a +- %a n %a %a %a\n", name,
                sgt_status_text(h.status), h.evals, h.t, h.t_err, h.t_lo, h.p.x, h.p.y, h.p.z, h.p_err, h.n.x,
                h.n.y, h.n.z);
}

void fail(const char *why, const specimen &s, const sgt_ray *ray, const sgt_options &o, const sgt_hit *alone,
          const sgt_hit *batch)
{
    if (failed[s.type + ": " + why]++ >= 2) return;
    std::printf("FAIL %s, %s; options t_tol %a dt_min %a max_evals %d pick %d proof %d\n", s.type.c_str(),
                why, o.t_tol, o.dt_min, o.max_evals, static_cast<int>(o.pick), static_cast<int>(o.proof));
    print_surface(s.s);
    if (ray) print_ray(*ray);
    if (alone) print_hit("alone", *alone);
    if (batch) print_hit("batch", *batch);
}

long of_status[8];

std::size_t one_batch(generator &g, const char *type)
{
    specimen s = random_specimen(g, type, g.chance(0.05));
    const subject of(s);
    if (g.chance(0.1)) spoil(g, &s);
    const std::size_t n = g.chance(0.2) ? static_cast<std::size_t>(g.below(4))
                                        : static_cast<std::size_t>(g.chance(0.1) ? static_cast<int>(most)
                                                                                 : g.below(140));
    const sgt_options options = hostile_options(g);
    const int mixture = g.below(3);
    std::vector<sgt_ray> rays;
    std::vector<sgt_hit> alone;
    const bool no_tmin = g.chance(0.2), no_tmax = g.chance(0.2);
    for (std::size_t i = 0; i < n; i++) {
        rays.push_back(mixture == 0 || (mixture == 1 && i % 2) ? hostile_ray(g, of)
                                                               : random_ray(g, of, ordinary));
        if (no_tmin) rays.back().tmin = 0;
        if (no_tmax) rays.back().tmax = HUGE_VAL;
        // (an end in arrays, where a single ray of {0} has none)
        if (rays.back().tmin == 0 && rays.back().tmax == 0) rays.back().tmax = -0.0;
        alone.push_back(sgt_intersect(s.s, rays.back(), &options));
        of_status[alone.back().status - SGT_INVALID]++;
    }
    for (int twice = 0; twice < 2; twice++) {
        std::vector<array> in, out;
        for (int k = 0; k < 8; k++) in.emplace_back(g, n, k < 6 || !(k == 6 ? no_tmin : no_tmax));
        const bool all = g.chance(0.4), points = all || g.chance(0.5), normals = all || g.chance(0.5);
        for (int k = 0; k < 10; k++)
            out.emplace_back(g, n, k < 4 ? all || g.chance(0.5) : k < 7 ? points : normals);
        std::vector<std::size_t> order;
        for (std::size_t i = 0; i < n; i++) order.push_back(i);
        for (std::size_t i = n; twice && i > 1; i--)
            std::swap(order[i - 1], order[static_cast<std::size_t>(g.below(static_cast<int>(i)))]);
        for (int k = 0; k < 8; k++)
            for (std::size_t i = 0; i < n && in[static_cast<std::size_t>(k)].wanted; i++)
                in[static_cast<std::size_t>(k)].data()[i] = *component(rays[order[i]], k);
        std::vector<sgt_status> status(n + 2, SGT_STOPPED);
        std::vector<int> evals(n + 2, 99);
        const sgt_rays r = {{in[0].data(), in[1].data(), in[2].data()},
                            {in[3].data(), in[4].data(), in[5].data()},
                            in[6].data(),
                            in[7].data()};
        const bool want_status = all || g.chance(0.7), want_evals = all || g.chance(0.5);
        const sgt_hits h = {want_status ? status.data() + 1 : nullptr,
                            want_evals ? evals.data() + 1 : nullptr,
                            out[0].data(),
                            out[1].data(),
                            out[2].data(),
                            {out[4].data(), out[5].data(), out[6].data()},
                            {out[7].data(), out[8].data(), out[9].data()},
                            out[3].data(),
                            {}};
        soil_stack(g.bits());
        const std::size_t met = sgt_intersect_batch(s.s, n, r, h, &options);
        std::size_t expected = 0;
        for (std::size_t k = 0; k < n; k++) {
            const sgt_hit &a = alone[order[k]];
            sgt_hit b = a;
            expected += a.status > 0;
            if (h.status) b.status = static_cast<sgt_status>(h.status[k]);
            if (h.evals) b.evals = h.evals[k];
            if (h.t) b.t = h.t[k];
            if (h.t_err) b.t_err = h.t_err[k];
            if (h.t_lo) b.t_lo = h.t_lo[k];
            if (h.p_err) b.p_err = h.p_err[k];
            if (h.p[0]) b.p = {h.p[0][k], h.p[1][k], h.p[2][k]};
            if (h.n[0]) b.n = {h.n[0][k], h.n[1][k], h.n[2][k]};
            if (!(a.status == b.status && a.evals == b.evals && same(a.t, b.t) && same(a.t_err, b.t_err) &&
                  same(a.t_lo, b.t_lo) && same(a.p_err, b.p_err) && same(a.p, b.p) && same(a.n, b.n)))
                fail("another answer in a batch", s, &rays[order[k]], options, &a, &b);
        }
        if (met != expected) fail("the count returned", s, nullptr, options, nullptr, nullptr);
        for (const array &a : out)
            if (!a.kept(n)) fail("written around an output", s, nullptr, options, nullptr, nullptr);
        if (status[0] != SGT_STOPPED || status[n + 1] != SGT_STOPPED || evals[0] != 99 || evals[n + 1] != 99)
            fail("written around status or evals", s, nullptr, options, nullptr, nullptr);
    }
    return n;
}

// A lens of one size: three to five sags, one behind the other, some of them tilted.
std::size_t one_trace(generator &g)
{
    std::vector<specimen> parts;
    std::vector<sgt_element> lens;
    double z = 0;
    while (parts.size() < static_cast<std::size_t>(3 + g.below(3))) {
        const int which = g.below(static_cast<int>(sags.size()));
        specimen s = random_specimen(g, sags[static_cast<std::size_t>(which)]);
        if (s.h < 3 || s.h > 20) continue;
        parts.push_back(std::move(s));
    }
    for (const specimen &s : parts) {
        sgt_element e = {};
        e.surface = s.s;
        e.pose.origin = {0, 0, z += g.uniform(1, 10)};
        if (g.chance(0.3))
            e.pose = sgt_pose_tilted(e.pose.origin, {g.uniform(-5, 5), g.uniform(-5, 5), g.uniform(-90, 90)});
        e.index = g.chance(0.1) ? SGT_MIRROR : g.uniform(1, 1.8);
        e.semi_diameter = g.chance(0.5) ? 0 : s.h * g.uniform(0.4, 1);
        lens.push_back(e);
    }
    const std::size_t n = static_cast<std::size_t>(1 + g.below(150)), elements = lens.size();
    std::vector<double> in[6], out[7], t(n * elements), direction(n * elements);
    std::vector<sgt_fate> fate(n);
    std::vector<sgt_status> status(n * elements);
    std::vector<int> passed(n);
    for (auto &v : in) v.resize(n);
    for (auto &v : out) v.resize(n);
    for (std::size_t i = 0; i < n; i++) {
        const double r = 3 * std::sqrt(g.uniform(0, 1)), about = g.uniform(0, 6.283185307179586),
                     l = g.uniform(-0.2, 0.2), m = g.uniform(-0.2, 0.2);
        const double ray[6] = {r * std::cos(about),         r * std::sin(about), -5, l, m,
                               std::sqrt(1 - l * l - m * m)};
        for (int k = 0; k < 6; k++) in[k][i] = g.chance(0.01) ? hostile_number(g) : ray[k];
    }
    sgt_options options = {};
    if (g.chance(0.3)) options.proof = g.chance(0.5) ? SGT_PROVE_ROOT : SGT_PROVE_FIRST;
    if (g.chance(0.2)) options.pick = SGT_FIRST;
    const double *o[3] = {in[0].data(), in[1].data(), in[2].data()};
    sgt_rays rays = {{o[0], o[1], o[2]}, {in[3].data(), in[4].data(), in[5].data()}, nullptr, nullptr};
    std::vector<sgt_passages> passages(elements);
    for (std::size_t e = 0; e < elements; e++) {
        passages[e].hits.t = t.data() + e * n;
        passages[e].hits.status = status.data() + e * n;
        passages[e].opl = direction.data() + e * n;
    }
    const sgt_traced traced = {fate.data(),
                               passed.data(),
                               {out[0].data(), out[1].data(), out[2].data()},
                               {out[3].data(), out[4].data(), out[5].data()},
                               out[6].data(),
                               {}};
    soil_stack(g.bits());
    sgt_trace_batch(elements, lens.data(), 1, n, rays, traced, passages.data(), &options);
    for (std::size_t i = 0; i < n; i++) {
        sgt_ray ray = {{in[0][i], in[1][i], in[2][i]}, {in[3][i], in[4][i], in[5][i]}, 0, 0};
        const sgt_ray launched = ray;
        std::vector<sgt_passage> own(elements);
        sgt_fate what;
        const std::size_t far = sgt_trace(elements, lens.data(), 1, &ray, own.data(), &what, &options);
        const sgt_vec3 p = {out[0][i], out[1][i], out[2][i]}, d = {out[3][i], out[4][i], out[5][i]};
        bool good = static_cast<int>(far) == passed[i] && what == static_cast<sgt_fate>(fate[i]) &&
                    same(p, ray.o) && same(d, ray.d);
        for (std::size_t e = 0; e < elements && e <= far && good; e++)
            good = same(own[e].hit.t, t[e * n + i]) &&
                   own[e].hit.status == static_cast<sgt_status>(status[e * n + i]) &&
                   same(own[e].opl, direction[e * n + i]);
        of_status[own[0].hit.status - SGT_INVALID]++;
        if (!good)
            fail("another trace in a batch", parts[std::min(far, elements - 1)], &launched, options,
                 &own[std::min(far, elements - 1)].hit, nullptr);
    }
    return n;
}

void print_statuses(const char *name, double asked)
{
    std::printf("%-14s %8.0f rays:", name, asked);
    for (int i = 7; i >= 0; i--)
        if (of_status[i])
            std::printf(" %s %ld", sgt_status_text(static_cast<sgt_status>(i + SGT_INVALID)), of_status[i]);
    std::printf("\n");
    std::fflush(stdout);
    std::fill(of_status, of_status + 8, 0L);
}

} // namespace

int main(int argc, char **argv)
{
    const oracle::run r(argc, argv, 900, 20240603);
    const char *only = std::getenv("SAGITTA_TEST_TYPE");
    for (std::size_t k = 0; k < types.size(); k++) {
        if (only && std::strcmp(only, types[k])) continue;
        generator g(r.seed ^ static_cast<std::uint64_t>(k) << 40);
        long asked = 0;
        while (asked < r.count) asked += static_cast<long>(one_batch(g, types[k]));
        const bool one_sided = of_status[SGT_HIT - SGT_INVALID] < asked / 10 ||
                               of_status[SGT_MISS - SGT_INVALID] < asked / 100;
        print_statuses(types[k], static_cast<double>(asked));
        if (one_sided && asked > 1000) failed[std::string(types[k]) + ": these rays are no test"]++;
    }
    if (!only || !std::strcmp(only, "lens")) {
        generator g(r.seed);
        long asked = 0;
        while (asked < 2 * r.count) asked += static_cast<long>(one_trace(g));
        print_statuses("lenses", static_cast<double>(asked));
    }
    for (const auto &f : failed) std::printf("FAIL %6ld  %s\n", f.second, f.first.c_str());
    return !failed.empty();
}
