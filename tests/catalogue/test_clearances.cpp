// SPDX-License-Identifier: MIT
// The `clearance` of every body of the catalogue that has one, against a dense sample of its surface.
//
// A clearance is a radius within which the surface is not.  So it is at most the distance of any point of
// the surface.  A sample that is nearer refutes it, however the sample was found; and none refutes a
// clearance that is right.  These are bodies of revolution: the points nearest to p lie in the meridian of
// p, so a curve is sampled and no area.  Its angle goes in even steps; then the best ones are sharpened by
// golden section.  Each sample is on the surface to 113 bits: cos and sin are rounded, and their vector is
// then made of length 1.
//
// The surfaces are thin and thick, flat, long, open, closed and self-intersecting.  The points are outside,
// inside, on the surface and beside it by an ulp up to its size, on the axis, in the middle of the tube,
// and far away.  Sizes go from 2^-300 to 2^300.
//
// A clearance of 0 is right, too, and of no use.  So each is also at least what its formula is good for: the
// distance itself for a torus, times the ratio of its axes for an ellipsoid, less rounding.
#include "specimens.h"

#include <map>

using namespace catalogue;

namespace {

std::map<std::string, long> failed;

// A body of revolution in its meridian: the point at an angle, given by cos and sin.
struct meridian {
    bool known;
    quad middle, wide, high; // (middle + wide cos, high sin)
    double shortest;         // a clearance is at least so much of the distance, but for rounding
};

meridian meridian_of(const sgt_surface &s)
{
    if (s.ops == &sgt_torus_ops) {
        const sgt_torus &t = *static_cast<const sgt_torus *>(s.self);
        return {true, quad(t.major), quad(t.minor), quad(t.minor), 1};
    }
    if (s.ops == &sgt_ellipsoid_ops) {
        const sgt_ellipsoid &e = *static_cast<const sgt_ellipsoid *>(s.self);
        const quad b = quad(e.a) * (1 - quad(e.f)), ratio = b / e.a;
        return {true, quad(0), quad(e.a), b, oracle::to_double(ratio < 1 ? ratio : 1 / ratio)};
    }
    return {false, 0, 0, 0, 0};
}

quad distance(const meridian &m, quad rho, quad z, double angle)
{
    const quad c = std::cos(angle), s = std::sin(angle), unit = oracle::square_root(c * c + s * s);
    const quad x = m.middle + m.wide * (c / unit) - rho, y = m.high * (s / unit) - z;
    return oracle::square_root(x * x + y * y);
}

// The least distance of the samples.  Both halves of the meridian: the curve may cross the axis.
quad nearest(const meridian &m, sgt_vec3 p)
{
    constexpr int samples = 96;
    const double turn = 6.283185307179586, golden = 0.6180339887498949;
    const quad rho = oracle::square_root(quad(p.x) * p.x + quad(p.y) * p.y);
    quad best = quad(HUGE_VAL);
    for (int half = -1; half <= 1; half += 2) {
        quad d[samples];
        for (int i = 0; i < samples; i++) d[i] = distance(m, half * rho, quad(p.z), turn * i / samples);
        for (int i = 0; i < samples; i++) {
            if (d[i] < best) best = d[i];
            if (d[i] > d[(i + 1) % samples] || d[i] > d[(i + samples - 1) % samples]) continue;
            double lo = turn * (i - 1) / samples, hi = turn * (i + 1) / samples;
            for (int k = 0; k < 75; k++) {
                const double a = hi - golden * (hi - lo), b = lo + golden * (hi - lo);
                const quad at_a = distance(m, half * rho, quad(p.z), a),
                           at_b = distance(m, half * rho, quad(p.z), b);
                if (at_a < best) best = at_a;
                if (at_b < best) best = at_b;
                (at_a < at_b ? hi : lo) = at_a < at_b ? b : a;
            }
        }
    }
    return best;
}

sgt_surface body(generator &g, const std::string &type, specimen *s)
{
    const double size = g.chance(0.7) ? g.log_uniform(1e-3, 1e3) : std::ldexp(1.0, g.below(600) - 300);
    if (type == "torus") {
        const double minor = g.chance(0.1) ? size : size * g.log_uniform(1e-6, 1e3);
        return {&sgt_torus_ops, s->keep(sgt_torus{size, minor})};
    }
    const double by = g.chance(0.1) ? 1 : g.chance(0.5) ? g.log_uniform(0.2, 5) : g.log_uniform(1e-6, 1e6);
    return {&sgt_ellipsoid_ops, s->keep(sgt_ellipsoid{size, 1 - by})};
}

sgt_vec3 point(generator &g, const meridian &m)
{
    const double wide = oracle::to_double(m.wide), high = oracle::to_double(m.high),
                 middle = oracle::to_double(m.middle), size = std::max(wide, high) + middle;
    const double angle = g.uniform(0, 6.283185307179586), about = g.uniform(0, 6.283185307179586);
    const int kind = g.below(6);
    const double off = kind == 0   ? 1
                       : kind == 1 ? 1 + g.sign() * g.log_uniform(1e-16, 1)
                       : kind == 2 ? g.uniform(0, 3)
                       : kind == 3 ? 1 + g.log_uniform(1, 1e12)
                                   : g.uniform(0, 1);
    double rho = middle + off * wide * std::cos(angle), z = off * high * std::sin(angle);
    if (kind == 4) rho = 0, z = g.uniform(-2, 2) * (g.chance(0.5) ? high : size);
    if (kind == 5) rho = g.uniform(0, 2) * size, z = g.chance(0.5) ? 0 : g.uniform(-2, 2) * size;
    if (g.chance(0.05)) rho = middle, z = 0;
    return {rho * std::cos(about), rho * std::sin(about), z};
}

} // namespace

int main(int argc, char **argv)
{
    const oracle::run r(argc, argv, 2000, 20261125);
    const char *only = std::getenv("SAGITTA_TEST_TYPE");
    long asked = 0;
    for (const sgt_builtin *row = sgt_builtins(); row->type; row++) {
        const std::string type = row->type;
        if (!row->ops->clearance || row->family != SGT_FAMILY_BODY || (only && type != only)) continue;
        generator g(r.seed ^ static_cast<std::uint64_t>(type[0]) << 40);
        long off = 0;
        double most = 0;
        specimen s = {};
        asked++;
        if (!meridian_of({row->ops, row->specimen}).known) {
            failed[type + ": this test cannot sample it"]++;
            continue;
        }
        for (long i = 0; i < r.count; i++) {
            if (i % 8 == 0) s = specimen(), s.s = body(g, type, &s);
            const meridian m = meridian_of(s.s);
            const sgt_vec3 p = point(g, m);
            const double clear = s.s.ops->clearance(s.s.self, p);
            const quad is = nearest(m, p), size = oracle::magnitude(m.wide) + oracle::magnitude(m.high) +
                                                  m.middle + oracle::magnitude(quad(p.z)) + is;
            if (quad(clear) > is * (1 + quad(0x1p-100)) && failed[type + ": above the distance"]++ < 2) {
                std::printf("FAIL %s: the clearance at %a %a %a is %.17g, the distance %.17g\n", type.c_str(),
                            p.x, p.y, p.z, clear, oracle::to_double(is));
                print_surface(s.s);
            }
            if (quad(clear) < quad(0.999 * m.shortest) * is - quad(0x1p-46) * size &&
                failed[type + ": too short"]++ < 2) {
                std::printf("FAIL %s: the clearance at %a %a %a is %.17g, the distance %.17g\n", type.c_str(),
                            p.x, p.y, p.z, clear, oracle::to_double(is));
                print_surface(s.s);
            }
            if (!(is > quad(0x1p-20) * size)) continue;
            most = std::max(most, oracle::to_double(quad(clear) / is)), off++;
        }
        std::printf("%-10s %ld points, %ld of them off the surface: up to %.17g of the distance\n",
                    type.c_str(), r.count, off, most);
        if (off < r.count / 2 || most < 0.999999)
            failed[type + ": these points are no test"]++;
    }
    for (const auto &f : failed) std::printf("FAIL %6ld  %s\n", f.second, f.first.c_str());
    if (!asked && !only) std::printf("FAIL no type has a clearance\n");
    return !failed.empty() || (!asked && !only);
}
