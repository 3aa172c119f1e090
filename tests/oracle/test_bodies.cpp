// SPDX-License-Identifier: MIT
// Ellipsoids and quadrics of every kind, by closed form (src/surface/body/easy.h): each number of a batch.
//
// The kinds: ellipsoids of revolution from flat to long; quadrics made of three forms with coefficients of
// any sign, turned and moved: ellipsoids, hyperboloids, cones, cylinders, paraboloids, saddles, pairs of
// planes, a plane; or such a one with a weight that nearly vanishes.  The unit of length is 2^k, |k| <= 300.
// Rays come from near by and from up to 1e14 units, along an axis, near tangents, on the surface and next to
// it, with ends anywhere and beside roots.
//
// The roots are those of the parabola about the point of the ray nearest the middle, to 113 bits.  Where
// these can tell:
//   a hit        is the first root that counts, within t_err; the point on the surface is within p_err of p;
//                f and n are those of `value` at p;
//   a miss       has no root that counts;
//   undecided    has none before lo;
//   near         a root that counts, or none does;
//   a batch      has the bits of the single ray.
#include "cases.h"
#include "quad.h"

#include <map>

using namespace oracle;

namespace {

std::map<std::string, long> failed;
long asked, hits, misses, others, unknown, closed; // closed: one evaluation for a hit, none for a miss
const char *kind_name = "";

struct vec { quad x[3]; };
struct crossing { quad t, start, off; vec p; };
struct truth { bool known; std::vector<crossing> roots; };

// a form in quads, exactly that of the surface: squares of quads are rounded to 113 bits
struct form { quad s[3], p[3], l[3], c; };

form form_of(const sgt_quadric &q)
{
    form f = {};
    for (int i = 0; i < 3; i++) f.s[i] = q.squares[i], f.p[i] = q.products[i], f.l[i] = q.linear[i];
    f.c = q.constant;
    return f;
}
form form_of(const sgt_ellipsoid &e)
{
    form f = {};
    const quad a = e.a, b = quad(1) - e.f;
    f.s[0] = f.s[1] = 1, f.s[2] = 1 / (b * b), f.c = -(a * a);
    return f;
}

quad two(const form &f, const vec &a, const vec &b, bool sizes) // the second-degree part
{
    quad sum = 0;
    auto add = [&](quad x) { sum += sizes ? magnitude(x) : x; };
    for (int i = 0; i < 3; i++) add(f.s[i] * a.x[i] * b.x[i]);
    const int u[3] = {0, 1, 0}, v[3] = {1, 2, 2};
    for (int i = 0; i < 3; i++)
        add(f.p[i] * a.x[u[i]] * b.x[v[i]] / 2), add(f.p[i] * a.x[v[i]] * b.x[u[i]] / 2);
    return sum;
}
quad one(const form &f, const vec &a, bool sizes)
{
    quad sum = 0;
    for (int i = 0; i < 3; i++) sum += sizes ? magnitude(f.l[i] * a.x[i]) : f.l[i] * a.x[i];
    return sum;
}

truth truth_of(const form &f, const sgt_ray &ray)
{
    truth r = {};
    const vec o = {{ray.o.x, ray.o.y, ray.o.z}}, d = {{ray.d.x, ray.d.y, ray.d.z}};
    const quad d2 = d.x[0] * d.x[0] + d.x[1] * d.x[1] + d.x[2] * d.x[2];
    const double t0 = to_double(-(o.x[0] * d.x[0] + o.x[1] * d.x[1] + o.x[2] * d.x[2]) / d2);
    vec x;
    quad far = 0;
    for (int i = 0; i < 3; i++) x.x[i] = o.x[i] + quad(t0) * d.x[i], far = std::max(far, magnitude(o.x[i]));
    const quad unit = quad(0x1p-105), lost = far * quad(0x1p-111); // of each coordinate
    vec around = x, along = d;
    for (int i = 0; i < 3; i++) around.x[i] = magnitude(x.x[i]), along.x[i] = magnitude(d.x[i]);
    vec off = {{lost, lost, lost}};
    const quad A = two(f, d, d, false), B = two(f, x, d, false) + one(f, d, false) / 2,
               C = two(f, x, x, false) + one(f, x, false) + f.c;
    const quad eA = unit * two(f, along, along, true),
               eB = unit * (two(f, around, along, true) + one(f, along, true)) + two(f, off, along, true),
               eC = unit * (two(f, around, around, true) + one(f, around, true) + magnitude(f.c)) +
                    2 * two(f, around, off, true) + one(f, off, true);
    const quad D = B * B - A * C, eD = 2 * magnitude(B) * eB + magnitude(A) * eC + magnitude(C) * eA +
                                       eB * eB + eA * eC + unit * (B * B + magnitude(A * C));
    if (D < -eD) return r.known = true, r;
    if (!(D > 4096 * eD)) return r;
    const quad S = square_root(D), b = -(B + (B < 0 ? -S : S));
    std::vector<quad> t = {C / b};
    if (magnitude(A) > 64 * eA) t.push_back(b / A);
    else if (A != 0 || eA != 0) return r; // a second one far off, perhaps
    std::sort(t.begin(), t.end());
    r.known = true;
    for (const quad at : t) {
        crossing c = {at + t0, 0, (magnitude(at) * (eA * magnitude(at) + 2 * eB) + eC) / S, {}};
        c.off += unit * magnitude(at);
        quad spread = 0;
        for (int i = 0; i < 3; i++) c.p.x[i] = x.x[i] + at * d.x[i];
        for (int i = 0; i < 3; i++) {
            vec e = {};
            e.x[i] = 1;
            spread += magnitude(c.p.x[i] * (2 * two(f, c.p, e, false) + f.l[i]));
        }
        c.start = quad(0x1p-48) * spread / (2 * S);
        r.roots.push_back(c);
    }
    return r;
}

counts counts_of(const crossing &c, double tmin, double tmax)
{
    const quad slack = 8 * c.start + 64 * quad(ulp(to_double(c.t))) + c.off;
    counts result = yes;
    if (!(magnitude(c.t) < quad(1e150))) return perhaps; // the place on the ray may be out of range
    if (std::isfinite(tmin)) {
        const quad beyond = c.t - tmin;
        if (beyond <= c.start * (1 - quad(0x1p-20)) - c.off || beyond <= -c.off) return no;
        if (beyond <= c.start + slack) result = perhaps;
    }
    if (std::isfinite(tmax)) {
        if (tmax - c.t < -slack) return no;
        if (tmax - c.t <= slack) result = perhaps;
    }
    return result;
}

struct question {
    sgt_surface s;
    form f;
    sgt_ray ray;
    sgt_hit hit, one;
};

void fail(const char *why, const question &q, const truth &t)
{
    if (failed[std::string(kind_name) + ": " + why]++ >= 2) return;
    std::printf("FAIL %s: %s: %s t %.17g t_err %.3g p_err %.3g evals %d (one: %s %.17g)\n   ", kind_name, why,
                sgt_status_text(q.hit.status), q.hit.t, q.hit.t_err, q.hit.p_err, q.hit.evals,
                sgt_status_text(q.one.status), q.one.t);
    const double *x = static_cast<const double *>(q.s.self);
    for (int i = 0; i < (q.s.ops == &sgt_quadric_ops ? 10 : 2); i++) std::printf(" %a", x[i]);
    const sgt_ray &r = q.ray;
    std::printf("\n    ray {{%a, %a, %a}, {%a, %a, %a}, %a, %a}\n", r.o.x, r.o.y, r.o.z, r.d.x, r.d.y, r.d.z,
                r.tmin, r.tmax);
    for (const crossing &c : t.roots)
        std::printf("    root %s off %.3g start %.3g: %d\n", text(c.t).c_str(), to_double(c.off),
                    to_double(c.start), counts_of(c, r.tmin, r.tmax));
}

bool same(double a, double b) { return std::memcmp(&a, &b, sizeof a) == 0 || (a != a && b != b); }

void judge(const question &q, bool near)
{
    const sgt_hit &h = q.hit;
    const truth t = truth_of(q.f, q.ray);
    asked++, hits += h.status == SGT_HIT, misses += h.status == SGT_MISS;
    others += h.status != SGT_HIT && h.status;
    const sgt_hit &g = q.one;
    if (h.status != g.status || h.evals != g.evals || !same(h.t, g.t) || !same(h.t_err, g.t_err) ||
        !same(h.t_lo, g.t_lo) || !same(h.p_err, g.p_err) || !same(h.p.x, g.p.x) || !same(h.p.y, g.p.y) ||
        !same(h.p.z, g.p.z) || !same(h.n.x, g.n.x) || !same(h.n.y, g.n.y) || !same(h.n.z, g.n.z))
        fail("a batch and a single ray", q, t);
    if (h.status == SGT_HIT) {
        sgt_vec3 n;
        if (!same(q.s.ops->value(q.s.self, h.p, &n), g.f) || !same(n.x, h.n.x) || !same(n.y, h.n.y) ||
            !same(n.z, h.n.z))
            fail("f or n is not that at p", q, t);
    }
    const sgt_vec3 o = q.ray.o, d = q.ray.d;
    const bool valid = q.ray.tmin <= q.ray.tmax && q.ray.tmin < HUGE_VAL && q.ray.tmax > -HUGE_VAL &&
                       std::isfinite(o.x + o.y + o.z) && std::isfinite(d.x + d.y + d.z);
    if ((h.status == SGT_INVALID) == valid) fail("valid or not", q, t);
    if (h.status == SGT_HIT && !(std::fabs(h.t) < HUGE_VAL && h.t_err < HUGE_VAL && h.p_err < HUGE_VAL))
        fail("no numbers of a hit", q, t);
    closed += h.status >= 0 && h.evals == (h.status == SGT_HIT);
    if (!t.known || h.status == SGT_INVALID) {
        unknown += !t.known;
        return;
    }
    bool itself = false, may = false, close = false;
    for (const crossing &c : t.roots) {
        const counts k = counts_of(c, q.ray.tmin, q.ray.tmax);
        if (h.status > 0 && magnitude(c.t - h.t) <= h.t_err + c.off) {
            itself = true, may = may || k != no;
            const quad dx = c.p.x[0] - h.p.x, dy = c.p.x[1] - h.p.y, dz = c.p.x[2] - h.p.z,
                       far = c.off * (magnitude(q.ray.d.x) + magnitude(q.ray.d.y) + magnitude(q.ray.d.z));
            close = close || square_root(dx * dx + dy * dy + dz * dz) <= h.p_err + far;
        }
        if (k != yes) continue;
        if (h.status == SGT_MISS) fail("a miss that meets", q, t);
        if (!near && h.status > 0 && c.t < (h.status == SGT_GRAZE ? quad(h.lo) : quad(h.t) - h.t_err) - c.off)
            fail("not the first", q, t);
        if (!near && h.status < 0 && c.t < quad(g.lo) - 64 * quad(ulp(to_double(c.t))))
            fail("undecided, and a root before", q, t);
    }
    if (h.status == SGT_HIT && !itself) fail("a hit without a root", q, t);
    else if (h.status == SGT_HIT && !may) fail("a root that does not count", q, t);
    else if (h.status == SGT_HIT && !close) fail("a point too far from the surface", q, t);
}

// ---------------------------------------------------------------- surfaces, rays

void unit_vector(generator &g, double v[3])
{
    double r;
    do {
        for (int i = 0; i < 3; i++) v[i] = g.uniform(-1, 1);
        r = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    } while (!(r > 0.1 && r < 1));
    for (int i = 0; i < 3; i++) v[i] /= r;
}

enum { revolution, any_signs, cone, cylinder, paraboloid, planes, plane, faint, kinds };
const char *const names[] = {"ellipsoids",  "quadrics", "cones",   "cylinders",
                             "paraboloids", "planes",   "a plane", "nearly less"};

sgt_quadric quadric(generator &g, int kind)
{
    sgt_quadric q = {};
    double w[3], m[3][3], at[3];
    const bool turned = g.chance(0.7), mild = g.chance(0.5);
    for (int i = 0; i < 3; i++) {
        w[i] = (mild ? 1 : g.sign()) * g.log_uniform(0.2, 5), at[i] = g.chance(0.4) ? 0 : g.uniform(-2, 2);
        for (int j = 0; j < 3; j++) m[i][j] = i == j ? 1 : turned ? g.uniform(-0.5, 0.5) : 0;
    }
    double last = -g.log_uniform(0.2, 20), push = 0;
    if (kind == cone) w[2] = -std::fabs(w[2]), last = 0;
    if (kind == cylinder || kind == paraboloid || kind == planes || kind == plane) w[2] = 0;
    if (kind == planes) w[1] = g.chance(0.5) ? 0 : -std::fabs(w[1]) * (w[0] > 0 ? 1 : -1);
    if (kind == planes && w[1] != 0) last = 0;
    if (kind == paraboloid || kind == plane) push = g.sign() * g.log_uniform(0.1, 10);
    if (kind == plane) w[0] = w[1] = 0;
    if (kind == faint) w[2] *= g.log_uniform(1e-18, 1e-3);
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < 3; i++) {
            q.squares[i] += w[k] * m[k][i] * m[k][i];
            q.products[i] += 2 * w[k] * m[k][i == 1 ? 1 : 0] * m[k][i == 0 ? 1 : 2];
        }
    for (int i = 0; i < 3; i++) q.linear[i] += push * m[2][i];
    double shift = 0;
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        const double pj = i == 0 ? q.products[0] : i == 1 ? q.products[1] : q.products[2],
                     pk = i == 0 ? q.products[2] : i == 1 ? q.products[0] : q.products[1];
        const double rise = 2 * q.squares[i] * at[i] + pj * at[j] + pk * at[k];
        shift += rise * at[i] / 2 - q.linear[i] * at[i], q.linear[i] -= rise;
    }
    q.constant = g.chance(0.15) ? 0 : last + shift; // through the origin the rule of the start is narrow
    return q;
}

sgt_vec3 scaled(sgt_vec3 a, int k) { return {std::ldexp(a.x, k), std::ldexp(a.y, k), std::ldexp(a.z, k)}; }

sgt_vec3 along(const sgt_ray &r, double t)
{
    return {r.o.x + t * r.d.x, r.o.y + t * r.d.y, r.o.z + t * r.d.z};
}

// A ray in units of 1.
sgt_ray random_ray(generator &g, const sgt_surface &s)
{
    double d[3], p[3], spread = g.chance(0.5) ? 0.5 : 3;
    unit_vector(g, d);
    if (g.chance(0.2)) { // along an axis, or nearly
        const int axis = g.below(3);
        const double tilt = g.chance(0.5) ? 0 : g.log_uniform(g.chance(0.1) ? 1e-320 : 1e-20, 1e-2);
        for (int i = 0; i < 3; i++) d[i] = i == axis ? g.sign() : tilt * g.uniform(-1, 1);
    }
    const double size = g.chance(0.1) ? g.log_uniform(1e-20, 1e-3) : spread;
    for (int i = 0; i < 3; i++) p[i] = g.uniform(-size, size);
    const double away = g.chance(0.1) ? g.log_uniform(1, 1e14) : g.uniform(-2, 12);
    sgt_ray r = {{p[0] - away * d[0], p[1] - away * d[1], p[2] - away * d[2]}, {d[0], d[1], d[2]}, 0, 0};
    const int way = g.below(6);
    if (way < 3) { // from a point of the surface, or to it
        const sgt_hit h = sgt_intersect(s, r, nullptr);
        double to[3], n2 = h.n.x * h.n.x + h.n.y * h.n.y + h.n.z * h.n.z;
        if (h.status != SGT_HIT || !(n2 > 0)) return r;
        unit_vector(g, to);
        if (way == 1) { // nearly a tangent
            const double on = (to[0] * h.n.x + to[1] * h.n.y + to[2] * h.n.z) / n2 *
                              (1 - (g.chance(0.2) ? 0 : g.log_uniform(1e-16, 1)));
            to[0] -= on * h.n.x, to[1] -= on * h.n.y, to[2] -= on * h.n.z;
        }
        const double before = way == 0   ? 0
                              : way == 1 ? g.uniform(-5, 5)
                                         : g.sign() * g.log_uniform(1e-18, 1e-1);
        sgt_ray own = {h.p, {to[0], to[1], to[2]}, 0, 0};
        own.o = along(own, -before);
        return own;
    }
    return r;
}

void ends(generator &g, question &q)
{
    const truth t = truth_of(q.f, q.ray);
    const int way = g.below(8);
    q.ray.tmin = 0, q.ray.tmax = HUGE_VAL;
    if (way == 0) q.ray.tmin = -HUGE_VAL;
    if (way == 1) q.ray.tmin = g.uniform(-5, 8);
    if (way == 2) q.ray.tmax = g.uniform(0, 12);
    if (way == 3 && !t.roots.empty()) {
        const crossing &c = t.roots[static_cast<std::size_t>(g.below(static_cast<int>(t.roots.size())))];
        const double at = to_double(c.t), by = g.chance(0.5) ? g.uniform(-40, 40) * ulp(at)
                                                             : g.sign() * g.log_uniform(1e-16, 1e-2);
        (g.chance(0.5) ? q.ray.tmin : q.ray.tmax) = at + by;
    }
    if (!(q.ray.tmin <= q.ray.tmax) || q.ray.tmin == HUGE_VAL || (q.ray.tmin == 0 && q.ray.tmax == 0))
        q.ray.tmin = 0, q.ray.tmax = HUGE_VAL;
    if (g.chance(0.03)) // not valid
        q.ray.tmax = g.chance(0.5) ? double(NAN) : q.ray.tmin - g.log_uniform(1e-3, 10);
}

// `many` rays at one surface, in a batch.
void ask(generator &g, int kind, int many)
{
    sgt_quadric q = {}, unit = {};
    sgt_ellipsoid e = {}, ball = {};
    const int k = g.chance(0.5) ? 0 : g.below(601) - 300, j = g.chance(0.7) ? 0 : g.below(401) - 200;
    sgt_surface s, own;
    form f;
    if (kind == revolution) {
        ball = {g.log_uniform(0.5, 4), g.chance(0.5) ? g.uniform(-0.5, 0.5) : 1 - g.log_uniform(1e-3, 1e3)};
        e = {std::ldexp(ball.a, k), ball.f}, s = {&sgt_ellipsoid_ops, &e}, own = {&sgt_ellipsoid_ops, &ball};
        f = form_of(e);
    } else {
        unit = quadric(g, kind), q = unit;
        const int all = std::abs(k) > 200 || g.chance(0.7) ? 0 : 300 * (g.below(3) - 1); // of F
        for (double &x : q.squares) x = std::ldexp(x, all);
        for (double &x : q.products) x = std::ldexp(x, all);
        for (double &x : q.linear) x = std::ldexp(x, k + all);
        q.constant = std::ldexp(q.constant, 2 * k + all);
        s = {&sgt_quadric_ops, &q}, own = {&sgt_quadric_ops, &unit}, f = form_of(q);
    }
    const std::size_t n = static_cast<std::size_t>(many);
    std::vector<question> all(n);
    std::vector<double> in[8], out[10];
    std::vector<int> evals(n);
    std::vector<sgt_status> status(n);
    for (question &a : all) {
        a.s = s, a.f = f, a.ray = random_ray(g, own);
        a.ray.o = scaled(a.ray.o, k), a.ray.d = scaled(a.ray.d, k + j);
        ends(g, a);
        if (j && std::isfinite(a.ray.tmin)) a.ray.tmin = std::ldexp(a.ray.tmin, -j);
        if (j && std::isfinite(a.ray.tmax)) a.ray.tmax = std::ldexp(a.ray.tmax, -j);
        if (a.ray.tmin == 0 && a.ray.tmax == 0) a.ray.tmax = HUGE_VAL; /* by underflow */
        const sgt_ray &r = a.ray;
        const double x[8] = {r.o.x, r.o.y, r.o.z, r.d.x, r.d.y, r.d.z, r.tmin, r.tmax};
        for (int i = 0; i < 8; i++) in[i].push_back(x[i]);
    }
    for (auto &x : out) x.resize(n);
    sgt_hits h = {};
    h.status = status.data(), h.evals = evals.data(), h.t = out[0].data(), h.t_err = out[1].data(),
    h.t_lo = out[2].data(), h.p_err = out[3].data();
    for (int i = 0; i < 3; i++) h.p[i] = out[4 + i].data(), h.n[i] = out[7 + i].data();
    sgt_options o = {};
    o.pick = g.chance(0.25) ? SGT_NEAR_SEED : SGT_FIRST;
    const sgt_rays rays = {{in[0].data(), in[1].data(), in[2].data()},
                           {in[3].data(), in[4].data(), in[5].data()},
                           in[6].data(),
                           in[7].data()};
    sgt_intersect_batch(s, n, rays, h, &o);
    for (std::size_t i = 0; i < n; i++) {
        question &a = all[i];
        a.one = sgt_intersect(s, a.ray, &o), a.hit = {};
        a.hit.status = status[i], a.hit.evals = evals[i], a.hit.t = out[0][i], a.hit.t_err = out[1][i];
        a.hit.t_lo = out[2][i], a.hit.p_err = out[3][i], a.hit.lo = a.one.lo;
        a.hit.p = {out[4][i], out[5][i], out[6][i]}, a.hit.n = {out[7][i], out[8][i], out[9][i]};
        judge(a, o.pick == SGT_NEAR_SEED);
    }
}

} // namespace

int main(int argc, char **argv)
{
    const run r(argc, argv, 200, 20261128);
    for (int kind = 0; kind < kinds; kind++) {
        generator g(r.seed ^ static_cast<std::uint64_t>(kind) << 40);
        kind_name = names[kind];
        asked = hits = misses = others = unknown = closed = 0;
        for (long done = 0; done < r.count; done++) ask(g, kind, 1 + g.below(g.chance(0.5) ? 9 : 160));
        std::printf("%-12s %ld answers: %ld hits, %ld misses, %ld others; %ld not judged\n", kind_name, asked,
                    hits, misses, others, unknown);
        std::fflush(stdout);
        if (closed < asked / 2) failed[std::string(kind_name) + ": the closed form seldom answers"]++;
        if (hits < asked / 8 || unknown > asked / 2)
            failed[std::string(kind_name) + ": these rays are no test"]++;
    }
    for (const auto &f : failed) std::printf("FAIL %6ld  %s\n", f.second, f.first.c_str());
    return !failed.empty();
}
