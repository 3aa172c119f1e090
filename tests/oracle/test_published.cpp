// SPDX-License-Identifier: MIT
// Bugs that others have published, as rows: what their programs said, and what this library has to say.
// docs/notes/published_bugs.md has them as a table.  The right answers come from closed forms, in 113
// bits where a difference of large numbers has to be taken.
#include "../../src/truth/elementary.hpp"

#include <sagitta/formula.h>
#include <sagitta/surfaces.h>

#include <cmath>
#include <cstdio>
#include <random>
#include <vector>

using oracle::quad;

namespace
{

int failures = 0;
std::mt19937_64 bits(37);

double uniform(double lo, double hi) { return std::uniform_real_distribution<double>(lo, hi)(bits); }

double dot(sgt_vec3 a, sgt_vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

sgt_vec3 direction()
{
    for (;;) {
        const sgt_vec3 v = {uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)};
        const double r2 = dot(v, v), r = std::sqrt(r2);
        if (r2 < 1 && r2 > 1e-4) return {v.x / r, v.y / r, v.z / r};
    }
}

void require(bool good, const char *what)
{
    if (!good && failures++ < 20) std::printf("%s\n", what);
}

bool close(double a, double b, double within) { return std::fabs(a - b) <= within; }

// OpenMC, pull request 2053: a particle on a torus of R = 139 met it again at once, 1e-10 on, since the
// root at the start came out small and positive; cutoffs of 1e-10 and 1e-9 are too small at R = 139
// and R = 1000.
void openmc_large_torus(double major)
{
    const sgt_torus torus = {major, 1};
    const sgt_surface s = {&sgt_torus_ops, &torus};
    for (int i = 0; i < 20000; i++) {
        const double turn = uniform(0, 6.283185307179586), across = uniform(0, 6.283185307179586),
                     r = major + std::cos(across);
        const sgt_vec3 d = direction(), n = {std::cos(across) * std::cos(turn),
                                             std::cos(across) * std::sin(turn), std::sin(across)};
        const sgt_start at = {
            {r * std::cos(turn), r * std::sin(turn), std::sin(across)}, n, 4e-16 * major, d, 0, {}};
        const double slope = dot(n, d);
        if (std::fabs(slope) < 1e-3) continue;
        const sgt_crossing c = sgt_leave(s, &at, nullptr);
        require(c.hit.status >= 0 && c.side == (slope > 0 ? 1 : -1),
                "large torus: undecided, or the wrong side");
        require(slope > 0 || c.hit.status == SGT_HIT, "large torus: lost in the tube");
        require(c.hit.status == SGT_MISS || c.hit.t > 1e-4 * std::fabs(slope),
                "large torus: met at its start");
    }
}

// OpenMC, pull request 2589: with R < r a second surface appeared inside, the roots of the quartic where
// sqrt(x^2 + y^2) would be negative.  sgt_torus is that quartic, with its inner part, as its comment says.
void openmc_spindle()
{
    const sgt_torus torus = {1, 2};
    sgt_hit hit[4];
    const int n =
        sgt_intersect_all({&sgt_torus_ops, &torus}, {{0.1, 0, -5}, {0, 0, 1}, 0, 0}, 4, hit, nullptr);
    const double outer = std::sqrt(4 - 0.81);
    require(n == 4 && close(hit[0].t, 5 - outer, 1e-14) && close(hit[3].t, 5 + outer, 1e-14),
            "torus with R < r");
    const char *text = "(sqrt(x^2 + y^2) - 1)^2 + z^2 = 4"; // the outer part alone
    const size_t size = sgt_formula_room(text, 0);
    std::vector<double> room(size / sizeof(double) + 1);
    sgt_formula f = {};
    f.tape = sgt_formula_read(text, SGT_FORMULA_XYZ, 0, nullptr, room.data(), size, nullptr), f.ball = 4;
    const int two =
        sgt_intersect_all({&sgt_formula_ops, &f}, {{0.1, 0, -5}, {0, 0, 1}, 0, 0}, 4, hit, nullptr);
    require(two == 2 && close(hit[0].t, 5 - outer, 1e-14) && close(hit[1].t, 5 + outer, 1e-14),
            "its outer part");
}

// brepkit, pull request 1068: quartic solvers missed roots of rays that start in the tube, R = 6, r = 2, and
// found others off the surface.  POV-Ray, pull request 358: rays went through tori of scale 1e-4 and 1e4.
void in_the_tube()
{
    for (const double scale : {0x1p-13, 1.0, 0x1p13}) {
        const sgt_torus torus = {6 * scale, 2 * scale};
        for (int i = 0; i < 20000; i++) {
            const double turn = uniform(0, 6.283185307179586), r = 6 + uniform(-1.3, 1.3),
                         z = uniform(-1.3, 1.3);
            const sgt_vec3 o = {scale * r * std::cos(turn), scale * r * std::sin(turn), scale * z},
                           d = direction();
            const sgt_hit hit = sgt_intersect({&sgt_torus_ops, &torus}, {o, d, 0, 0}, nullptr);
            require(hit.status == SGT_HIT && dot(hit.n, d) > 0, "from the tube of a torus");
            const quad x = hit.p.x, y = hit.p.y, off = oracle::square_root(x * x + y * y) - torus.major;
            const quad far = oracle::square_root(off * off + quad(hit.p.z) * hit.p.z) - torus.minor;
            require(static_cast<double>(far < 0 ? -far : far) <= hit.p_err, "off the torus");
        }
    }
}

// Geant4, pull request 116: from within a spherical shell with a cone of 45 degrees, a direction along the
// cone gave a distance below 0, and photons got stuck.
void geant4_cone()
{
    sgt_quadric cone = {};
    cone.squares[0] = cone.squares[1] = 1, cone.squares[2] = -1;
    const sgt_surface s = {&sgt_quadric_ops, &cone};
    const double x = 105 * std::sqrt(0.75), z = 52.5;
    for (const double nudge : {0.0, 1e-17, -1e-17, 1e-13, -1e-13, 1e-9, -1e-9}) {
        const sgt_hit along = sgt_intersect(s, {{x, 0, z}, {1, 0, 1 + nudge}, 0, 1e8}, nullptr),
                      back = sgt_intersect(s, {{x, 0, z}, {-1, 0, -1 - nudge}, 0, 0}, nullptr);
        require(along.status == SGT_MISS, "along a cone"); // (without an end: unproven from 2e30 on)
        require(back.status == SGT_HIT && close(back.t, (x + z) / 2, 1e-6), "along a cone, backward");
    }
}

// Optiland, issue 787: steep rays on a hyperboloid (c = 0.3396, k = -2.5073, 5 mm away, up to 42 degrees) met
// its other sheet.  Pull requests 753 of Optiland and 167 of optika: the same on other conics.
void hyperboloid()
{
    const sgt_conic conic = {0.3396, -2.5073, 0};
    for (int i = -200; i <= 200; i++) {
        const double a = 42 * i / 200.0 * 0.017453292519943295;
        const sgt_hit hit = sgt_intersect({&sgt_conic_ops, &conic},
                                          {{0, 0, -5}, {0, std::sin(a), std::cos(a)}, 0, 0}, nullptr);
        const quad c = 0.3396, y = hit.p.y, under = 1 - (1 + quad(-2.5073)) * c * c * y * y;
        const quad off = c * y * y / (1 + oracle::square_root(under)) - hit.p.z;
        require(hit.status == SGT_HIT && static_cast<double>(off < 0 ? -off : off) <= 2 * hit.p_err,
                "hyperboloid: not on the sheet of the vertex");
    }
}

// Optiland, issue 559: a paraboloid and a ray along its axis: a division by 0.
void paraboloid_along_axis()
{
    const sgt_conic conic = {-0.01, -1, 0};
    const sgt_hit hit = sgt_intersect({&sgt_conic_ops, &conic}, {{10, 0, -50}, {0, 0, 1}, 0, 0}, nullptr);
    require(hit.status == SGT_HIT && hit.t == 49.5, "paraboloid, along its axis");
}

// optika, pull request 224: a ray that starts on a steep paraboloid (f = -0.65, at a radius of 76, 3.94
// degrees to the axis) was moved to the far crossing, 1663 mm away.
void steep_paraboloid()
{
    const sgt_conic conic = {-1 / 1.3, -1, 0};
    const sgt_surface s = {&sgt_conic_ops, &conic};
    const double a = 3.94 * 0.017453292519943295, z = -76 * 76 / 2.6;
    const sgt_ray ray = sgt_ray_between({76, 0, z}, {-std::sin(a), 0, std::cos(a)}, -HUGE_VAL, HUGE_VAL);
    sgt_hit hit[3];
    const int n = sgt_intersect_all(s, ray, 3, hit, nullptr);
    require(n == 2 && (close(hit[0].t, 0, 1e-10) || close(hit[1].t, 0, 1e-10)),
            "steep paraboloid: all roots");
    const sgt_start at = {ray.o, {0, 0, 0}, 1e-12, ray.d, 0, {}};
    const sgt_crossing c = sgt_leave(s, &at, nullptr);
    const double far = std::fabs(hit[0].t) > std::fabs(hit[1].t) ? hit[0].t : hit[1].t;
    require(far > 0 ? c.hit.status == SGT_HIT && close(c.hit.t, far, 1e-9) : c.hit.status == SGT_MISS,
            "steep paraboloid: left");
}

// Mitsuba, issue 1236: rays that left a small ball (radius 0.015 at (0, 0.083, 0.4)) outward met it again.
// pbrt-v3, issue 265, and Mitsuba 2, issue 171, are of this kind: the offset was less than rounding.
void small_ball()
{
    sgt_quadric ball = {};
    const sgt_vec3 c = {0, 0.083, 0.4};
    std::vector<double> in[10];
    for (double &k : ball.squares) k = 1;
    ball.linear[1] = -2 * c.y, ball.linear[2] = -2 * c.z, ball.constant = dot(c, c) - 0.015 * 0.015;
    const sgt_surface s = {&sgt_quadric_ops, &ball};
    for (int i = 0; i < 20000; i++) {
        const sgt_vec3 from = direction(), d = direction(), o = {c.x + from.x, c.y + from.y, c.z + from.z};
        const sgt_hit hit = sgt_intersect(s, {o, {-from.x, -from.y, -from.z}, 0, 0}, nullptr);
        const double slope = dot(hit.n, d) / std::sqrt(dot(hit.n, hit.n));
        if (hit.status != SGT_HIT || slope < 1e-6) continue;
        const sgt_start at = {hit.p, hit.n, hit.p_err, d, 0, {}};
        const sgt_crossing out = sgt_leave(s, &at, nullptr);
        require(out.hit.status == SGT_MISS && out.side == 1, "a small ball is met again");
        const double row[10] = {at.p.x, at.p.y, at.p.z, at.n.x, at.n.y, at.n.z, d.x, d.y, d.z, at.p_err};
        for (int k = 0; k < 10; k++) in[k].push_back(row[k]);
    }
    const size_t n = in[0].size();
    std::vector<sgt_status> status(n, SGT_INVALID);
    std::vector<signed char> side(n);
    sgt_starts from = {};
    for (size_t k = 0; k < 3; k++)
        from.p[k] = in[k].data(), from.n[k] = in[3 + k].data(), from.d[k] = in[6 + k].data();
    from.p_err = in[9].data();
    sgt_hits hits = {};
    hits.status = status.data();
    require(n > 5000 && sgt_leave_batch(s, n, from, hits, side.data(), nullptr) == 0,
            "a small ball, a batch");
    for (size_t i = 0; i < n; i++) require(status[i] == SGT_MISS && side[i] == 1, "a small ball, a batch");
}

// Mitsuba, pull request 1871: between balls of radius 1 and 1 + 4e-5 rays skipped the inner one, since their
// offset was larger than the gap.
void two_balls()
{
    const char *text = "(x^2 + y^2 + z^2 - 1)*(x^2 + y^2 + z^2 - (1 + 4e-5)^2) = 0";
    const size_t size = sgt_formula_room(text, 0);
    std::vector<double> room(size / sizeof(double) + 1);
    sgt_formula f = {};
    f.tape = sgt_formula_read(text, SGT_FORMULA_XYZ, 0, nullptr, room.data(), size, nullptr), f.ball = 2;
    const sgt_surface s = {&sgt_formula_ops, &f};
    for (int i = 0; i < 5000; i++) {
        const sgt_vec3 from = direction(), d = direction();
        const sgt_hit hit = sgt_intersect(
            s, {{3 * from.x, 3 * from.y, 3 * from.z}, {-from.x, -from.y, -from.z}, 0, 0}, nullptr);
        const double slope = dot(from, d);
        if (slope > -0.1) continue;
        const sgt_start at = {hit.p, hit.n, hit.p_err, d, 0, {}};
        const sgt_crossing in = sgt_leave(s, &at, nullptr);
        const double r = 1 + 4e-5, t = -slope * r - std::sqrt(slope * slope * r * r - (r * r - 1));
        require(in.hit.status == SGT_HIT && in.side == -1 && close(in.hit.t, t, 1e-10),
                "the inner of two balls is skipped");
    }
}

// Mitsuba, issue 512: rings on a ball that is seen from 100 and 1000 away.
void from_afar()
{
    const sgt_ellipsoid ball = {1, 0};
    for (const double far : {10.0, 1e2, 1e3, 1e6})
        for (int i = 0; i < 2000; i++) {
            const double x = uniform(-0.7, 0.7), y = uniform(-0.7, 0.7);
            const sgt_hit hit =
                sgt_intersect({&sgt_ellipsoid_ops, &ball}, {{x, y, -far}, {0, 0, 1}, 0, 0}, nullptr);
            const quad t = quad(far) - oracle::square_root(1 - quad(x) * x - quad(y) * y), off = t - hit.t;
            require(hit.status == SGT_HIT && static_cast<double>(off < 0 ? -off : off) <= hit.t_err &&
                        hit.t_err < 1e-15 * far,
                    "a ball from afar");
        }
}

} // namespace

int main()
{
    openmc_large_torus(139), openmc_large_torus(1000);
    openmc_spindle();
    in_the_tube();
    geant4_cone();
    hyperboloid();
    paraboloid_along_axis();
    steep_paraboloid();
    small_ball();
    two_balls();
    from_afar();
    return failures > 0;
}
