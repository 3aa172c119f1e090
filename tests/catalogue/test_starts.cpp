// SPDX-License-Identifier: MIT
// Rays that start next to a departure: is the root there the start itself, or a hit?
//
// The rule of the start (src/solve/accept.h) has one answer, whichever way a root is found.  Random surfaces
// of all departures and sums; starts on both sides, 0.1 to 100 reaches of the rule from the surface, in
// directions of the whole sphere and nearly along the surface; tmin = 0 or not; tmax
// behind the root by little or much, or before it.  Of each ray are asked: the first hit without a proof and
// with each, all hits, a batch of one, and a batch of 40 whose other rays come from afar or start anywhere.
//
//     all answers    decided ones are the same as the first of all hits by the same proof, within t_err (the
//                    rule has t_err in it, and with a proof that is another one)
//     batches        the same as the single ray, to the last bit
//     a hit          F in 113 bits has unlike signs at t -+ t_err, and t is not within the rule
//     the start      a root 40 reaches from the start, in 113 bits, is not passed over
//
// The first rows are rays whose root was once taken for the start: the bound on what is rounded was that of a
// whole ring.
#include "../ends.h"
#include "specimens.h"

#include <cstdlib>
#include <cstring>
#include <map>

using namespace catalogue;

namespace {

std::map<std::string, int> failed;
long asked, decided, hits_near, dropped;

void fail(const char *what, const char *type, const sgt_surface &s, const sgt_ray &r, const sgt_hit &h)
{
    if (failed[std::string(type) + ": " + what]++ > 1) return;
    std::printf("%s: %s\n    o %.17g %.17g %.17g, d %.17g %.17g %.17g, %.17g ... %.17g\n    %s, t = %.17g +- "
                "%.3g\n    ",
                type, what, r.o.x, r.o.y, r.o.z, r.d.x, r.d.y, r.d.z, r.tmin, end_of(&r),
                sgt_status_text(h.status), h.t, h.t_err);
    print_surface(s);
}

quad along(const formula<quad> &f, const sgt_ray &r, quad t)
{
    return f(quad(r.o.x) + t * quad(r.d.x), quad(r.o.y) + t * quad(r.d.y), quad(r.o.z) + t * quad(r.d.z));
}

quad size_of(quad x) { return x < 0 ? -x : x; }

// The slope along d and the terms of the rule at a point.  F = z - s: its slope along z is 1.
struct local_terms { quad slope, terms; };

local_terms terms_at(const formula<quad> &f, const sgt_ray &r, quad t, double h)
{
    const quad x = quad(r.o.x) + t * quad(r.d.x), y = quad(r.o.y) + t * quad(r.d.y),
               z = quad(r.o.z) + t * quad(r.d.z), e = quad(h) * quad(0x1p-40),
               fx = (f(x + e, y, z) - f(x - e, y, z)) / (2 * e),
               fy = (f(x, y + e, z) - f(x, y - e, z)) / (2 * e);
    return {fx * quad(r.d.x) + fy * quad(r.d.y) + quad(r.d.z),
            size_of(x * fx) + size_of(y * fy) + size_of(z)};
}

bool same(const sgt_hit &h, sgt_status status, double t, double t_err)
{
    return h.status == status && (h.status <= 0 || (h.t == t && h.t_err == t_err));
}

struct batch {
    std::vector<double> in[8], t, t_err;
    std::vector<sgt_status> status;
    batch(const sgt_surface &s, const sgt_ray *rays, std::size_t n) : t(n), t_err(n), status(n)
    {
        for (std::vector<double> &a : in) a.resize(n);
        for (std::size_t i = 0; i < n; i++) {
            const sgt_ray &r = rays[i];
            const double of[] = {r.o.x, r.o.y, r.o.z, r.d.x, r.d.y, r.d.z, r.tmin, end_of(&r)};
            for (int k = 0; k < 8; k++) in[k][i] = of[k];
        }
        const sgt_rays many = {{in[0].data(), in[1].data(), in[2].data()},
                               {in[3].data(), in[4].data(), in[5].data()},
                               in[6].data(),
                               in[7].data()};
        sgt_hits hits = {};
        hits.status = status.data(), hits.t = t.data(), hits.t_err = t_err.data();
        sgt_intersect_batch(s, n, many, hits, nullptr);
    }
};

void ask(const char *type, const sgt_surface &s, double h, double rim, const std::vector<sgt_ray> &rays,
         const std::vector<bool> &near)
{
    const formula<quad> exact(s);
    const batch many(s, rays.data(), rays.size());
    for (std::size_t i = 0; i < rays.size(); i++) {
        const sgt_ray &r = rays[i];
        sgt_options none = {}, root = {}, first = {};
        root.proof = SGT_PROVE_ROOT, first.proof = SGT_PROVE_FIRST;
        const sgt_hit one = sgt_intersect(s, r, nullptr);
        const batch alone(s, &r, 1);
        if (!same(one, many.status[i], many.t[i], many.t_err[i]))
            fail("a batch of many is not the single ray", type, s, r, one);
        if (!same(one, alone.status[0], alone.t[0], alone.t_err[0]))
            fail("a batch of one is not the single ray", type, s, r, one);
        if (!near[i]) continue;
        asked++, decided += one.status >= 0;
        // the root next to the start
        quad t = quad(r.tmin);
        for (int k = 0; k < 6; k++) {
            const local_terms at = terms_at(exact, r, t, h);
            t -= along(exact, r, t) / at.slope;
        }
        const local_terms at = terms_at(exact, r, t, h);
        const quad reach = quad(0x1p-48) * at.terms / size_of(at.slope), away = t - quad(r.tmin),
                   length = quad(std::hypot(r.d.x, r.d.y, r.d.z)),
                   x = quad(r.o.x) + t * quad(r.d.x), y = quad(r.o.y) + t * quad(r.d.y);
        const bool is = size_of(along(exact, r, t)) < quad(0x1p-90) * quad(h) && away > 40 * reach &&
                        away * length < quad(1e-6) * quad(h) && reach > 0 &&
                        t < quad(end_of(&r)) - away / 4 &&
                        away > 64 * quad(0x1p-53) * size_of(t) &&
                        !(rim > 0 && x * x + y * y > quad(rim) * quad(rim) * quad(1 - 1e-9));
        const sgt_options *ask_for[] = {&none, &root, &first};
        for (int k = 0; k < 3; k++) {
            const sgt_hit got = sgt_intersect(s, r, ask_for[k]);
            sgt_hit list[8];
            const int count = sgt_intersect_all(s, r, 8, list, ask_for[k]);
            if (got.status < 0) continue;
            const quad err = quad(got.t_err) * (1 + quad(0x1p-20)), where = quad(got.t) + quad(got.t_lo);
            if (is && (got.status == SGT_MISS || where - err > t)) fail("a root is lost", type, s, r, got);
            if (got.status == SGT_HIT) {
                const quad left = along(exact, r, where - err), right = along(exact, r, where + err);
                if (left == left && right == right && ((left > 0 && right > 0) || (left < 0 && right < 0)))
                    fail("no root within t_err", type, s, r, got);
                hits_near += got.t - r.tmin < 1e-9 * h;
                const local_terms there = terms_at(exact, r, where, h);
                if (where + err - quad(r.tmin) <
                    quad(0x1p-48) * quad(0.98) * there.terms / size_of(there.slope))
                    fail("the start itself is a hit", type, s, r, got);
            } else dropped++;
            if (count < 0 || (count > 0 && list[0].status < 0)) continue;
            const bool meets = count > 0;
            if (meets != (got.status > 0) ||
                (meets && size_of(where - quad(list[0].t) - quad(list[0].t_lo)) >
                              err + quad(list[0].t_err) * (1 + quad(0x1p-20))))
                fail(k == 0 ? "the first is not the first of all"
                            : "with a proof the first is not the first of all",
                     type, s, r, got);
        }
    }
}

// A ray that starts next to a point of the surface.
bool start_near(generator &g, const specimen &s, const formula<double> &rough, const formula<quad> &exact,
                sgt_ray *r)
{
    const double radius = s.h * std::sqrt(g.uniform(0, 0.9)) * (g.chance(0.2) ? g.log_uniform(1e-5, 1) : 1),
                 about = g.uniform(0, 6.28), to = g.uniform(0, 6.28), up = g.uniform(-1, 1),
                 x = radius * std::cos(about),
                 y = radius * std::sin(about), z = -rough(x, y, 0.0),
                 size = g.chance(0.5) ? 1 : g.log_uniform(1e-3, 1e3);
    if (!(z == z)) return false;
    const double e = 0x1p-20 * s.h, nx = (rough(x + e, y, 0.0) - rough(x - e, y, 0.0)) / (2 * e),
                 ny = (rough(x, y + e, 0.0) - rough(x, y - e, 0.0)) / (2 * e);
    const double across = std::sqrt(1 - up * up);
    sgt_vec3 d = {across * std::cos(to), across * std::sin(to), up};
    if (g.chance(0.3)) d.z = -(nx * d.x + ny * d.y) + g.sign() * g.log_uniform(1e-5, 0.3);
    const double terms = std::fabs(x * nx) + std::fabs(y * ny) + std::fabs(z),
                 off = g.sign() * 0x1p-48 * terms * g.log_uniform(0.1, 100);
    *r = {{x, y, z + off}, {d.x * size, d.y * size, d.z * size}, 0, INFINITY};
    if (g.chance(0.3)) {
        const double back = s.h * g.log_uniform(1e-6, 1);
        r->o = {x - back * d.x, y - back * d.y, z - back * d.z};
        const quad slope = terms_at(exact, *r, quad(back / size), s.h).slope, at = quad(back / size),
                   root = at - along(exact, *r, at) / slope;
        r->tmin = static_cast<double>(root - quad(off) / slope);
    }
    if (g.chance(0.3)) {
        const quad slope = terms_at(exact, *r, quad(r->tmin), s.h).slope;
        const double way = static_cast<double>(-along(exact, *r, quad(r->tmin)) / slope);
        r->tmax = r->tmin + std::fabs(way) *
                                (g.chance(0.5) ? g.log_uniform(0.5, 10) : g.log_uniform(10, 1e10));
    }
    return r->tmax > r->tmin && std::fabs(r->tmin) < 1e300;
}

void known_rows()
{
    {
        const double a[] = {-0.00017901240194288296, -3.0791355112629952e-05, 0.00024254061744916004,
                            -0.00029544118414415432};
        sgt_q_bfs q = {};
        q.c = -0.61074163996491193, q.norm = 0.0084668760239081028, q.a = {a, 1, 4};
        ask("row 1", {&sgt_q_bfs_ops, &q}, 0.0084, 0,
            {{{-0.0063885683482481194, 0.0064940512216609082, -0.000314762658445574},
              {-0.89565065401068988, -0.38079924733808529, -0.22978650786539023},
              0,
              0.21084109362918607}},
            {true});
    }
    {
        sgt_odd_asphere odd = {};
        const double b[] = {0, -0.035090554629786934, 0, 0, -3.6669287543391973, -2.3205216992141331,
                            8.8214551804487815, -8.7203186094294196, 0, 113.05277359940675,
                            208.35577814327095, 0, 0, -95.76486413432005, 0, 0};
        std::memcpy(odd.a, b, sizeof b);
        const double a[] = {0, -0.0050642911069801481, -0.0087465304430576554, 0,
                            0, 0.029760485371300778, 0, -0.28096190687032507,
                            0, 0, 0, 0.10366027261026023,
                            0.89693782146917189, 0, -10.779689705752288, 0};
        sgt_polynomial_xy xy = {};
        xy.a = {a, 4, 4};
        const sgt_surface terms[] = {{&sgt_odd_asphere_ops, &odd}, {&sgt_polynomial_xy_ops, &xy}};
        sgt_sum sum = {};
        sum.c = 0.0048884668606168106, sum.k = -1, sum.semi_diameter = 0.58749083131274005;
        sum.terms = terms, sum.count = 2;
        ask("row 2", {&sgt_sum_ops, &sum}, 0.587, 0.58749083131274005,
            {{{0.36890026230540496, -0.12944911510585175, 0.012069678940781507},
              {-0.92252985639873131, -0.019738397176830673, -0.38542062701654412},
              0,
              INFINITY}},
            {true});
    }
    {
        const double a[] = {0, 0, 1.5107314153974456, 0.088114528340209705};
        sgt_q_con q = {};
        q.c = -14.524446738798105, q.norm = 0.027453828897446301, q.a = {a, 1, 4};
        ask("row 3", {&sgt_q_con_ops, &q}, 0.027, 0,
            {{{-0.0009925109295745979, -0.0030495586262269214, 0.0026303909906738921},
              {0.1723486953924302, 0.68866500284262822, -0.70429854540265113},
              0.00042334664976011329,
              INFINITY}},
            {true});
    }
    {
        const double a[] = {0.19081176592899868, -0.42272862555208873, -0.11953371554415715};
        sgt_q_bfs q = {};
        q.c = -0.17299564786918048, q.semi_diameter = 3.9808657403088556, q.norm = 3.6750952643353307;
        q.a = {a, 1, 3};
        ask("row 4", {&sgt_q_bfs_ops, &q}, 3.98, 3.9808657403088556,
            {{{0.55512436371603202, 2.4519831245371253, -0.66486316416629343},
              {0.57306729121765476, 0.75594280956224413, -0.31645591858519651},
              0,
              INFINITY}},
            {true});
    }
    {
        sgt_toroidal t = {-0x1.2630c57907a04p-11, 0, 0, 0, {0x1.88b93c52057aap-12, -0x1.7946b064b409ep-20,
                                                            -0x1.219c1f221545dp-27}};
        ask("row 5", {&sgt_toroidal_ops, &t}, 1.4, 0,
            {{{0.51187463594623583, 1.2915389041207601, 0.00015279637664412246},
              {-0.040071823083180941, -0.047372487669387717, -2.0926773488055973e-05},
              0,
              2.2425169703998225e-06}},
            {true});
    }
}

}  // namespace

int main()
{
    const char *seed = std::getenv("SAGITTA_TEST_SEED"), *scale = std::getenv("SAGITTA_TEST_SCALE"),
               *only = std::getenv("SAGITTA_TEST_TYPE");
    const std::uint64_t from = seed ? std::strtoull(seed, nullptr, 0) : 31;
    const int rounds = static_cast<int>(16 * (scale ? std::atof(scale) : 0.5)) + 1;
    std::printf("seed %llu\n", static_cast<unsigned long long>(from));
    known_rows();
    for (const char *type : sags) {
        if (only && std::string(only) != type) continue;
        generator g(from ^ (static_cast<std::uint64_t>(type[0]) << 8 | static_cast<std::uint64_t>(type[2])));
        asked = decided = hits_near = dropped = 0;
        for (int round = 0; round < rounds; round++) {
            const specimen s = random_specimen(g, type);
            const formula<double> rough(s.s);
            const formula<quad> exact(s.s);
            std::vector<sgt_ray> rays;
            std::vector<bool> near;
            for (int i = 0; i < 200 && rays.size() < 40; i++) {
                sgt_ray r;
                if (!start_near(g, s, rough, exact, &r)) continue;
                const bool is = g.chance(0.6);
                if (!is) { // from afar, or from anywhere
                    const double back = s.h * g.log_uniform(1e-3, 1e3) / std::hypot(r.d.x, r.d.y, r.d.z);
                    r.o = {r.o.x - back * r.d.x, r.o.y - back * r.d.y, r.o.z - back * r.d.z};
                    r.tmin = 0, r.tmax = INFINITY;
                }
                rays.push_back(r), near.push_back(is);
            }
            if (!rays.empty()) ask(s.type.c_str(), s.s, s.h, s.rim, rays, near);
        }
        std::printf("%-14s %6ld starts, %6ld decided, %6ld times a hit nearby, %6ld times none\n", type,
                    asked,
                    decided, hits_near, dropped);
    }
    for (const auto &f : failed) std::printf("FAIL %6d  %s\n", f.second, f.first.c_str());
    return !failed.empty();
}
