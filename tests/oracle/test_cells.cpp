// SPDX-License-Identifier: MIT
// First roots by cells in lanes (src/ray/cells_batch.c) against roots in quadruple precision.
//
// The surface is a user's: a product of planes and spheres, so that the roots along a ray are those of its
// factors, each a quadratic that is solved here in 113 bits.  Factors are drawn far apart, nearly touching,
// nearly alike and alike, and rays through what two of them share, along tangents, from far away, with ends
// at roots.  `encloses` is a loop over interval.h, with some cells widened, unbounded or NaN by the bits of
// the cell itself.
//
// Answers that `enclose` had to give without a proof are about F as computed; they are only compared with
// the batch.  Of the others:
//
//     HIT         a root lies within t_err of t, exactly one where a proof is asked for; no root that is
//                 accepted lies before it; the point on the ray is within p_err of p
//     MISS        no root is accepted
//     undecided   two roots are near each other, or nearly meet off the line; or the answer without
//                 `encloses` is undecided, too
//
// Every fourth surface is met with few evaluations, so that the rays of a batch stop at different depths.  A
// hit or a miss is one all the same; what is undecided begins at lo, and no accepted root lies before it.
//
// A root within 1e-6 of an end may be accepted or not; then the answer without `encloses` has to be the same
// root.  Each answer of a batch is that of the ray alone, to the last bit.
//
//     test_cells     SAGITTA_TEST_SCALE multiplies the number of surfaces, SAGITTA_TEST_SEED chooses others
#include "../ends.h"
#include "../../src/truth/quad.hpp"

#include <algorithm>
#include <cinttypes>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <random>
#include <vector>
#include <sagitta/interval.h>
#include <sagitta/sagitta.h>

using oracle::magnitude;
using oracle::quad;
using oracle::to_double;

namespace
{

struct Factor {
    bool plane;
    sgt_vec3 n;
    double c;
}; // n . p - c, or |p - n|^2 - c^2

// WIDENED, MUTE: `encloses`, by the bits of the cell.  SHIFTED: `value` is not F but 1e-4 less.
enum Fault { HONEST, WIDENED, MUTE, SHIFTED };

struct Product {
    std::vector<Factor> factors;
    double reach; // of the ball that cuts it
    Fault fault;
    long *by_one; // calls of `enclose`
};

const Product &of(const void *self) { return *static_cast<const Product *>(self); }

double value(const void *self, sgt_vec3 p, sgt_vec3 *grad)
{
    double f = 1;
    sgt_vec3 g = {0, 0, 0};
    for (const Factor &a : of(self).factors) {
        sgt_vec3 n = a.n;
        double v;
        if (a.plane) {
            v = n.x * p.x + n.y * p.y + n.z * p.z - a.c;
        } else {
            sgt_vec3 q = {p.x - n.x, p.y - n.y, p.z - n.z};
            v = q.x * q.x + q.y * q.y + q.z * q.z - a.c * a.c;
            n = {2 * q.x, 2 * q.y, 2 * q.z};
        }
        g = {g.x * v + f * n.x, g.y * v + f * n.y, g.z * v + f * n.z};
        f *= v;
    }
    if (grad) *grad = g;
    return f - (of(self).fault == SHIFTED ? 1e-4 : 0);
}

sgt_interval enclosed(const Product &s, const sgt_ray &r, sgt_interval t, sgt_interval *slope)
{
    sgt_interval f = sgt_interval_of(1), g = sgt_interval_of(0);
    for (const Factor &a : s.factors) {
        const double o[3] = {r.o.x, r.o.y, r.o.z}, d[3] = {r.d.x, r.d.y, r.d.z}, n[3] = {a.n.x, a.n.y, a.n.z};
        sgt_interval v = sgt_interval_of(0), w = sgt_interval_of(0);
        for (int k = 0; k < 3; k++) {
            sgt_interval p = sgt_interval_sum(sgt_interval_of(o[k]), sgt_interval_scaled(t, d[k]));
            sgt_interval by = sgt_interval_scaled(sgt_interval_of(n[k]), d[k]);
            if (!a.plane) {
                p = sgt_interval_difference(p, sgt_interval_of(n[k]));
                by = sgt_interval_scaled(p, d[k]);
                by = sgt_interval_sum(by, by);
            }
            v = sgt_interval_sum(v, a.plane ? sgt_interval_scaled(p, n[k]) : sgt_interval_square(p));
            w = sgt_interval_sum(w, by);
        }
        sgt_interval c = sgt_interval_of(a.c);
        v = sgt_interval_difference(v, a.plane ? c : sgt_interval_square(c));
        g = sgt_interval_sum(sgt_interval_product(g, v), sgt_interval_product(f, w));
        f = sgt_interval_product(f, v);
    }
    *slope = g;
    return f;
}

sgt_interval enclose(const void *self, const sgt_ray *ray, sgt_interval t, sgt_interval *slope)
{
    ++*of(self).by_one;
    return enclosed(of(self), *ray, t, slope);
}

// A number in [0, 1) that depends on the cell alone.
double hash(double a, double b)
{
    std::uint64_t x, y;
    std::memcpy(&x, &a, 8), std::memcpy(&y, &b, 8);
    x = (x ^ (y * 3)) * 0x9e3779b97f4a7c15u;
    x = (x ^ (x >> 29)) * 0xbf58476d1ce4e5b9u;
    return static_cast<double>((x ^ (x >> 32)) >> 11) * 0x1p-53;
}

void encloses(const void *self, size_t n, sgt_rays r, const double *lo, const double *hi, sgt_enclosures out)
{
    for (size_t i = 0; i < n; i++) {
        sgt_ray ray = {{r.o[0][i], r.o[1][i], r.o[2][i]}, {r.d[0][i], r.d[1][i], r.d[2][i]}, 0, 0};
        sgt_interval slope, g = enclosed(of(self), ray, {lo[i], hi[i]}, &slope);
        double any = hash(lo[i], hi[i]), by = of(self).fault == WIDENED ? any : 0;
        g.lo -= by * (g.hi - g.lo), g.hi += by * (g.hi - g.lo);
        slope.lo -= by * (slope.hi - slope.lo), slope.hi += by * (slope.hi - slope.lo);
        if (of(self).fault == MUTE && any < 0.2)
            slope = any < 0.1 ? sgt_interval_all() : sgt_interval{NAN, NAN};
        if (of(self).fault == MUTE && any < 0.05)
            g = any < 0.02 ? sgt_interval_all() : sgt_interval{any < 0.03 ? NAN : g.lo, NAN};
        out.lo[i] = g.lo, out.hi[i] = g.hi;
        if (out.slope_lo) out.slope_lo[i] = slope.lo, out.slope_hi[i] = slope.hi;
    }
}

sgt_span span(const void *self, const sgt_ray *r)
{
    double b = r->o.x * r->d.x + r->o.y * r->d.y + r->o.z * r->d.z,
           a = r->d.x * r->d.x + r->d.y * r->d.y + r->d.z * r->d.z, m = -b / a;
    sgt_vec3 p = {r->o.x + m * r->d.x, r->o.y + m * r->d.y, r->o.z + m * r->d.z};
    double left = of(self).reach * of(self).reach - (p.x * p.x + p.y * p.y + p.z * p.z),
           h = std::sqrt(left / a);
    return left < 0 ? sgt_span{1, -1, NAN, false} : sgt_span{m - h, m + h, NAN, false};
}

// ------------------------------------------------------------------------------- the oracle

// Every root of the ray, in order; a double one twice.  grazes: it touches a sphere, or nearly.
std::vector<quad> roots_of(const Product &s, const sgt_ray &r, bool *grazes = nullptr)
{
    std::vector<quad> roots;
    const double o[3] = {r.o.x, r.o.y, r.o.z}, d[3] = {r.d.x, r.d.y, r.d.z};
    for (const Factor &f : s.factors) {
        const double n[3] = {f.n.x, f.n.y, f.n.z};
        quad a = 0, b = 0, c = f.plane ? -quad(f.c) : -quad(f.c) * f.c;
        for (int k = 0; k < 3; k++) {
            if (f.plane) {
                c += quad(n[k]) * o[k], b += quad(n[k]) * d[k];
                continue;
            }
            quad q = quad(o[k]) - n[k];
            a += quad(d[k]) * d[k], b += q * d[k], c += q * q;
        }
        if (f.plane) {
            if (b != 0) roots.push_back(-c / b);
            continue;
        }
        quad D = b * b - a * c;
        if (grazes && magnitude(D) < 1e-6 * a * f.c * f.c) *grazes = true;
        if (magnitude(D) < b * b * quad(0x1p-96)) D = 0;
        if (D < 0) continue;
        quad q = -b - (b > 0 ? oracle::square_root(D) : -oracle::square_root(D));
        roots.push_back(q / a), roots.push_back(q != 0 ? c / q : q / a);
    }
    std::sort(roots.begin(), roots.end());
    return roots;
}

// ------------------------------------------------------------------------------------ cases

std::mt19937_64 draw;
double uniform(double lo, double hi)
{
    return lo + (hi - lo) * (static_cast<double>(draw() >> 11) * 0x1p-53);
}
bool chance(double p) { return uniform(0, 1) < p; }
double power(double lo, double hi) { return std::pow(10, uniform(lo, hi)); }

sgt_vec3 direction()
{
    for (;;) {
        sgt_vec3 v = {uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)};
        double l = std::sqrt(v.x * v.x + v.y * v.y + v.z * v.z);
        if (l > 0.1 && l < 1) return {v.x / l, v.y / l, v.z / l};
    }
}
sgt_vec3 point(double size) { return {uniform(-size, size), uniform(-size, size), uniform(-size, size)}; }
sgt_vec3 along(sgt_vec3 o, double t, sgt_vec3 d) { return {o.x + t * d.x, o.y + t * d.y, o.z + t * d.z}; }

Product product(long *by_one)
{
    Product s = {{}, 2.5, chance(0.6) ? HONEST : static_cast<Fault>(1 + draw() % 3), by_one};
    int n = 1 + static_cast<int>(uniform(0, 4.99));
    for (int i = 0; i < n; i++) {
        Factor f = {chance(0.5), chance(0.5) ? direction() : point(1), uniform(-1, 1)};
        if (i > 0 && chance(0.4)) {
            f = s.factors.back();
            f.c += chance(0.2) ? 0 : (chance(0.5) ? 1 : -1) * power(-15, -1);
            if (chance(0.2)) f.n.x += power(-14, -1);
        }
        s.factors.push_back(f);
    }
    return s;
}

sgt_ray ray_to(const Product &s)
{
    double far = chance(0.7) ? uniform(0, 6) : power(0, chance(0.8) ? 4 : 12),
           length = chance(0.6) ? 1 : power(-5, 5);
    sgt_vec3 d = direction(), at = point(1.2);
    const Factor &f = s.factors[draw() % s.factors.size()];
    if (!f.plane && chance(0.2)) { // along a tangent, nearly
        sgt_vec3 n = direction();
        double k = n.x * d.x + n.y * d.y + n.z * d.z;
        n = along(n, -k, d);
        at = along(f.n,
                   f.c * (1 + (chance(0.5) ? -1 : 1) * power(-16, -2)) /
                       std::sqrt(n.x * n.x + n.y * n.y + n.z * n.z),
                   n);
    }
    sgt_ray r = {along(at, -far, d), {d.x * length, d.y * length, d.z * length}, 0, 0};
    if (chance(0.1)) r.tmin = -INFINITY, r.tmax = INFINITY;
    if (chance(0.2)) { // an end at a root, or beside it
        std::vector<quad> roots = roots_of(s, r);
        double t = roots.empty() ? 1 : to_double(roots[draw() % roots.size()]);
        if (chance(0.5)) t += (chance(0.5) ? 1 : -1) * std::fabs(t) * power(-17, -3);
        if (chance(0.5))
            r.tmin = t, r.tmax = INFINITY;
        else if (t > 0)
            r.tmax = t;
    }
    if (chance(0.1) && !std::isinf(r.tmin)) // from the surface itself
        for (quad t : roots_of(s, r))
            if (t > 0) {
                r.o = along(r.o, to_double(t), r.d), r.tmin = r.tmax = 0;
                break;
            }
    return r;
}

// ------------------------------------------------------------------------------------ claims

long failures, counts[3], near_ends, spent, cut_short;

void fail(const char *what, const Product &s, const sgt_ray &r, const sgt_hit &h,
          const std::vector<quad> &roots)
{
    if (++failures > 6) return;
    std::printf("FAIL %s: %s t %.17g +- %g (%a), evals %d; ray o %a %a %a d %a %a %a ends %a %a\n", what,
                sgt_status_text(h.status), h.t, h.t_err, h.t, h.evals, r.o.x, r.o.y, r.o.z, r.d.x, r.d.y,
                r.d.z, r.tmin, r.tmax);
    for (const Factor &f : s.factors)
        std::printf("  %s %a %a %a, %a\n", f.plane ? "plane" : "sphere", f.n.x, f.n.y, f.n.z, f.c);
    std::printf("  fault %d, roots", s.fault);
    for (quad t : roots) std::printf(" %.17g", to_double(t));
    std::printf("\n");
}

void judge(const Product &s, sgt_surface plain, const sgt_ray &given, const sgt_hit &h,
           const sgt_options &opt)
{
    sgt_ray r = given;
    if (r.tmax == 0 && r.tmin == 0) r.tmax = INFINITY;
    sgt_span all = span(&s, &r);
    bool near_end = false, near_root = false, met = h.status > 0;
    std::vector<quad> every = roots_of(s, r, &near_root), roots;
    // `size`: of t; what is nearer than 1e-6 of that to an end may count or not
    double size = std::max(std::fabs(all.lo), std::fabs(all.hi)), close = 1e-6 * size;
    for (quad t : every) {
        if (all.lo > all.hi || t < all.lo - close || t > all.hi + close) continue;
        for (double end : {all.lo, all.hi, r.tmin, r.tmax})
            near_end = near_end || (std::isfinite(end) && magnitude(t - end) < close);
        if (t > r.tmin && t <= r.tmax) roots.push_back(t);
    }
    for (size_t i = 1; i < roots.size(); i++) near_root = near_root || roots[i] - roots[i - 1] < 1e-6 * size;
    counts[met ? 0 : h.status == SGT_MISS ? 1 : 2]++;
    if (s.fault == SHIFTED && h.status == SGT_HIT && *s.by_one == 0)
        return fail("a root where value has none", s, given, h, every);
    if (near_end) {
        near_ends++;
        sgt_options proven = opt;
        proven.proof = SGT_PROVE_FIRST;
        sgt_hit old = sgt_intersect(plain, given, &proven);
        if (h.status < 0 || old.status < 0 || old.status == SGT_GRAZE) return;
        if ((old.status > 0) != met)
            return fail("near an end: another status than without encloses", s, given, h, every);
        if (met && std::fabs((old.t - h.t) + (old.t_lo - h.t_lo)) > old.t_err + h.t_err)
            return fail("near an end: another root than without encloses", s, given, h, every);
        return;
    }
    if (h.status < 0 && opt.max_evals) {
        cut_short++;
        // where cells say nothing, or another thing than `value`, a quick try at a root is ended, too
        const int more = s.fault == MUTE || s.fault == SHIFTED ? 16 : 1;
        if (h.evals > opt.max_evals + more) fail("more evaluations than allowed", s, given, h, every);
        const bool begun = h.lo <= h.hi;
        if (!begun) fail("undecided, and no stretch", s, given, h, every);
        for (quad t : roots)
            if (begun && t < quad(h.lo) - quad(1e-12) * size)
                return fail("undecided, and a root before", s, given, h, every);
        return;
    }
    if (h.status < 0) {
        bool open = !near_root && sgt_intersect(plain, given, &opt).status >= 0;
        if (open && h.evals >= 2000) // what is spent on cells is not left to others
            spent++;
        else if (open)
            fail("undecided, and not so without encloses", s, given, h, every);
        return;
    }
    if (h.status == SGT_MISS) {
        // without a proof nothing else is promised of a graze than what is seen
        if (!roots.empty()) fail("a root was missed", s, given, h, every);
        return;
    }
    if (h.status == SGT_GRAZE) return;
    quad off = roots.empty() ? quad(INFINITY) : magnitude(roots[0] - h.t);
    quad err = quad(h.t_err) * (1 + quad(0x1p-50));
    // without a proof several roots that cannot be told apart are one
    if (!(off <= err)) return fail("not the first root", s, given, h, every);
    int within = 0;
    for (quad t : every) within += magnitude(t - h.t) <= quad(h.t_err);
    if (opt.proof && within != 1) return fail("not one root within t_err", s, given, h, every);
    const double o[3] = {r.o.x, r.o.y, r.o.z}, d[3] = {r.d.x, r.d.y, r.d.z}, p[3] = {h.p.x, h.p.y, h.p.z};
    quad away = 0;
    for (int k = 0; k < 3; k++) {
        quad x = quad(o[k]) + roots[0] * d[k] - p[k];
        away += x * x;
    }
    if (away > quad(h.p_err) * h.p_err * (1 + quad(0x1p-40)))
        return fail("the point is farther than p_err", s, given, h, every);
    // sharp: a root that is far from others is known to some roundings
    if (!near_root && opt.t_tol == 0 && h.t_err > 1e-9 * size)
        return fail("t_err is wide", s, given, h, every);
}

// ------------------------------------------------------------------------- rows by hand

// Functions of z, in pieces.  Each was drawn so that one shortcut of the march, taken too far, misses a root.
enum Row { HOLE, JUMP, ROWS };

double row_value(const void *self, sgt_vec3 p, sgt_vec3 *grad)
{
    Row row = *static_cast<const Row *>(self);
    double z = p.z;
    if (grad) *grad = {0, 0, 1};
    if (row == HOLE) // not defined in (0.2, 0.3); its signs on both sides differ
        return z < 0.2 ? z + 2 : z < 0.3 ? NAN : z - 0.5;
    return z < 0.3 ? z + 2 : z - 0.5;
}

sgt_interval row_enclose(const void *self, const sgt_ray *ray, sgt_interval t, sgt_interval *slope)
{
    Row row = *static_cast<const Row *>(self);
    sgt_interval z = sgt_interval_sum(sgt_interval_of(ray->o.z), sgt_interval_scaled(t, ray->d.z));
    const double end = row == HOLE ? 0.2 : 0.3;
    *slope = sgt_interval_of(ray->d.z);
    if (row == HOLE && z.lo > 0.2 && z.hi < 0.3) return sgt_interval_empty();
    if (z.hi < end) return sgt_interval_sum(z, sgt_interval_of(2));
    if (z.lo >= 0.3) return sgt_interval_difference(z, sgt_interval_of(0.5));
    slope->hi = INFINITY; // F jumps down, or is not defined all over the cell
    sgt_interval before = {z.lo + 1.9, 2.4}, behind = {-0.2, std::max(z.hi - 0.4, -0.1)};
    if (row == HOLE && z.hi < 0.3) return before;
    if (row == HOLE && z.lo > 0.2) return behind;
    return {std::min(before.lo, behind.lo), std::max(before.hi, behind.hi)};
}

void row_encloses(const void *self, size_t n, sgt_rays r, const double *lo, const double *hi,
                  sgt_enclosures out)
{
    for (size_t i = 0; i < n; i++) {
        sgt_ray ray = {{r.o[0][i], r.o[1][i], r.o[2][i]}, {r.d[0][i], r.d[1][i], r.d[2][i]}, 0, 0};
        sgt_interval slope, g = row_enclose(self, &ray, {lo[i], hi[i]}, &slope);
        out.lo[i] = g.lo, out.hi[i] = g.hi;
        if (out.slope_lo) out.slope_lo[i] = slope.lo, out.slope_hi[i] = slope.hi;
    }
}

void rows()
{
    sgt_surface_ops ops = {};
    ops.size = sizeof ops, ops.value = row_value, ops.enclose = row_enclose, ops.encloses = row_encloses;
    for (int row = 0; row < ROWS; row++)
        for (int i = 0; i < 200; i++) {
            Row self = static_cast<Row>(row);
            double start = uniform(-1.8, 0.1), length = power(-3, 3),
                   root = ((row == HOLE ? 0.5 : 0.3) - start) / length;
            sgt_ray ray = {{uniform(-1, 1), 0, start}, {0, 0, length}, 0, (uniform(0.6, 3) - start) / length};
            sgt_options opt = {};
            opt.proof = static_cast<sgt_proof>(i % 3);
            sgt_hit h = sgt_intersect({&ops, &self}, ray, &opt);
            bool good = h.status == SGT_HIT ? std::fabs(h.t - root) <= h.t_err + 1e-12 * root
                                            : row == JUMP && h.status < 0 && h.lo <= root;
            if (!good && ++failures <= 6)
                std::printf("FAIL row %d, from %a by %a to %a, proof %d: %s at z %.17g, not %.17g\n", row,
                            start, length, ray.tmax, opt.proof, sgt_status_text(h.status),
                            start + h.t * length, start + root * length);
        }
}

bool same(double a, double b) { return std::memcmp(&a, &b, sizeof a) == 0 || (a != a && b != b); }

} // namespace

int main()
{
    const char *scale = std::getenv("SAGITTA_TEST_SCALE"), *set = std::getenv("SAGITTA_TEST_SEED");
    const std::uint64_t seed = set ? std::strtoull(set, nullptr, 10) : 20300;
    const int surfaces = static_cast<int>(1000 * (scale ? std::atof(scale) : 0.5)) + 1;
    constexpr size_t N = 60;
    draw.seed(seed);
    std::printf("SAGITTA_TEST_SEED=%" PRIu64 ", %d surfaces, %zu rays each\n", seed, surfaces, N);
    rows();
    long by_one = 0, calls = 0, left = 0, honest = 0;
    for (int i = 0; i < surfaces; i++) {
        Product s = product(&by_one);
        sgt_surface_ops ops = {}, old = {};
        ops.size = sizeof ops, ops.value = value, ops.span = span, ops.enclose = enclose;
        old = ops;
        ops.encloses = encloses;
        sgt_surface by_cells = {&ops, &s}, plain = {&old, &s};
        std::vector<double> in[8], out[10];
        for (auto &a : in) a.resize(N);
        for (auto &a : out) a.resize(N);
        std::vector<int> evals(N);
        std::vector<sgt_status> status(N);
        std::vector<sgt_ray> rays(N);
        for (size_t k = 0; k < N; k++) {
            rays[k] = ray_to(s);
            const sgt_ray &r = rays[k];
            const double numbers[8] = {r.o.x, r.o.y, r.o.z, r.d.x, r.d.y, r.d.z, r.tmin, end_of(&r)};
            for (int c = 0; c < 8; c++) in[c][k] = numbers[c];
        }
        sgt_options opt = {};
        opt.proof = static_cast<sgt_proof>(i % 3);
        if (i % 7 == 0) opt.t_tol = 1e-9;
        if (i % 4 == 1) opt.max_evals = 1 + static_cast<int>(power(0, 2.2));
        sgt_intersect_batch(by_cells, N,
                            {{in[0].data(), in[1].data(), in[2].data()},
                             {in[3].data(), in[4].data(), in[5].data()},
                             in[6].data(),
                             in[7].data()},
                            {status.data(),
                             evals.data(),
                             out[0].data(),
                             out[1].data(),
                             out[2].data(),
                             {out[3].data(), out[4].data(), out[5].data()},
                             {out[6].data(), out[7].data(), out[8].data()},
                             out[9].data(),
                             {}},
                            &opt);
        for (size_t k = 0; k < N; k++) {
            by_one = 0;
            sgt_hit h = sgt_intersect(by_cells, rays[k], &opt);
            calls++;
            if (s.fault == HONEST) honest++, left += by_one > 0;
            const double want[10] = {h.t, h.t_err, h.t_lo, h.p.x, h.p.y, h.p.z, h.n.x, h.n.y, h.n.z, h.p_err};
            bool alike = status[k] == h.status && evals[k] == h.evals;
            for (int c = 0; c < 10; c++) alike = alike && same(want[c], out[c][k]);
            if (!alike) {
                fail("the batch differs", s, rays[k], h, {});
                if (failures <= 6)
                    std::printf("  batch: %d, t %.17g +- %g, t_lo %g (%g), evals %d\n", status[k], out[0][k],
                                out[1][k], out[2][k], h.t_lo, evals[k]);
            }
            if (by_one == 0 || opt.proof) judge(s, plain, rays[k], h, opt);
        }
    }
    std::printf("%ld rays: %ld met, %ld missed, %ld undecided, %ld with a root near an end; of honest "
                "surfaces %.1f %% "
                "were left to `enclose`\n",
                calls, counts[0], counts[1], counts[2], near_ends,
                100. * static_cast<double>(left) / static_cast<double>(honest));
    std::printf("%ld rays cut short\n", cut_short);
    if (cut_short < calls / 200) failures++, std::printf("FAIL the budgets are no test\n");
    if (spent > 1 + calls / 50000)
        failures++, std::printf("FAIL %ld rays have spent their evaluations\n", spent);
    std::printf("%ld failures\n", failures);
    return failures != 0;
}
