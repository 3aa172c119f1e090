// SPDX-License-Identifier: MIT
// Quadrics that come apart: pairs of planes, double planes, cones through their apex, cylinders on two lines.
//
// Coefficients are small integers, so that a parabola along the ray is exact to 113 bits of its terms, and
// so are its roots, its slope there, and the gradient: the rule of the start (sgt_ray in sagitta.h) is
// evaluated from those.  The rays run in one of the planes to an ulp or so, through the line where two
// planes meet, through an apex: where the gradient is lost in rounding, and with it the rule.  Every status
// of every pick and proof is judged:
//
//   a miss       no root counts for certain;
//   a hit        is the first that counts, and one that counts; near the seed under proof the only one;
//   undecided    no root counts for certain before [lo, hi];
//   all          no root that counts is in no entry;
//   a batch      says the same.
//
// A case whose discriminant 113 bits cannot tell from 0 is asked, and judged by what is known of it: nothing.
#include "cases.h"
#include "quad.h"

#include <map>

using namespace oracle;

namespace {

std::map<std::string, long> failed;
long asked, undecided, hits, misses, grazes, judged;

struct vec { quad x[3]; };

struct crossing {
    quad t, spread, slope,
        off; // off: t itself is off by no more, with the coefficients of the parabola as they are rounded
};

// What is known of a ray: its roots in order, if `known`.
struct truth {
    bool known, everywhere;
    std::vector<crossing> roots;
};

quad form(const sgt_quadric &q, const vec &a, const vec &b)
{
    const double *s = q.squares, *p = q.products;
    const quad half = quad(0.5);
    return s[0] * a.x[0] * b.x[0] + s[1] * a.x[1] * b.x[1] + s[2] * a.x[2] * b.x[2] +
           half * p[0] * (a.x[0] * b.x[1] + a.x[1] * b.x[0]) +
           half * p[1] * (a.x[1] * b.x[2] + a.x[2] * b.x[1]) +
           half * p[2] * (a.x[0] * b.x[2] + a.x[2] * b.x[0]);
}

quad row(const sgt_quadric &q, const vec &a, int i)
{
    vec e = {};
    e.x[i] = 1;
    return 2 * form(q, a, e) + q.linear[i];
}

truth truth_of(const sgt_quadric &q, const sgt_ray &ray)
{
    truth r = {};
    const vec o = {{ray.o.x, ray.o.y, ray.o.z}}, d = {{ray.d.x, ray.d.y, ray.d.z}};
    const quad linear = q.linear[0] * o.x[0] + q.linear[1] * o.x[1] + q.linear[2] * o.x[2];
    const quad A = form(q, d, d),
               B = form(q, o, d) + (q.linear[0] * d.x[0] + q.linear[1] * d.x[1] + q.linear[2] * d.x[2]) / 2,
               C = form(q, o, o) + linear + q.constant;
    quad most = magnitude(quad(q.constant)), far = 0, big = 0;
    for (int i = 0; i < 3; i++)
        far = std::max(far, magnitude(o.x[i])), big = std::max(big, magnitude(d.x[i]));
    for (int i = 0; i < 3; i++)
        most = std::max(most,
                        std::max(magnitude(quad(q.squares[i])),
                                 std::max(magnitude(quad(q.products[i])), magnitude(quad(q.linear[i])))));
    const quad size = most * (far + 1), unit = quad(0x1p-108), eA = unit * most * big * big,
               eB = unit * size * big, eC = unit * size * (far + 1);
    const quad D = B * B - A * C, eD = 2 * magnitude(B) * eB + magnitude(A) * eC + magnitude(C) * eA +
                                       eB * eB + eA * eC + unit * (B * B + magnitude(A * C));
    if (D < -eD) return r.known = true, r;
    r.everywhere = magnitude(A) <= eA && magnitude(B) <= eB && magnitude(C) <= eC;
    if (!(D > 4096 * eD)) return r; // one, two or none
    const quad S = square_root(D), b = -(B + (B < 0 ? -S : S));
    std::vector<quad> t = {C / b};
    if (magnitude(A) > 64 * eA) t.push_back(b / A);
    else if (magnitude(A) > eA || A != 0) return r; // a second one far off, perhaps
    std::sort(t.begin(), t.end());
    r.known = true;
    for (const quad at : t) {
        const vec p = {{o.x[0] + at * d.x[0], o.x[1] + at * d.x[1], o.x[2] + at * d.x[2]}};
        crossing c = {at, 0, 2 * S,
                      (magnitude(at) * (eA * magnitude(at) + 2 * eB) + eC) / S + unit * magnitude(at)};
        for (int i = 0; i < 3; i++) c.spread += magnitude(p.x[i] * row(q, p, i));
        r.roots.push_back(c);
    }
    return r;
}

// As counting() in quad.h.  beyond: what a root's own t is off.
counts counts_of(const crossing &c, double tmin, double tmax)
{
    const quad start = quad(0x1p-48) * c.spread / c.slope, slack = 8 * start + 64 * quad(ulp(to_double(c.t))),
               blur = quad(0x1p-60) * start;
    counts result = yes;
    if (std::isfinite(tmin)) {
        const quad beyond = c.t - tmin;
        if (beyond <= start * (1 - quad(0x1p-20)) - blur || beyond <= 0) return no;
        if (beyond <= start + slack) result = perhaps;
    }
    if (std::isfinite(tmax)) {
        if (tmax - c.t < -slack) return no;
        if (tmax - c.t <= slack) result = perhaps;
    }
    return result;
}

const char *kind_name = "";

void fail(const char *why, const sgt_quadric &q, const sgt_ray &ray, const truth &t, const sgt_hit &h,
          const sgt_options &o)
{
    if (failed[std::string(kind_name) + ": " + why]++ >= 2) return;
    std::printf("FAIL %s: %s, pick %d, proof %d: %s t %.17g t_err %.3g [%.17g, %.17g]\n    quadric",
                kind_name, why, o.pick, o.proof, sgt_status_text(h.status), h.t, h.t_err, h.lo, h.hi);
    for (const double *x = q.squares; x < q.squares + 10; x++) std::printf(" %g", *x);
    std::printf("\n    ray {{%a, %a, %a}, {%a, %a, %a}, %a, %a}\n", ray.o.x, ray.o.y, ray.o.z, ray.d.x,
                ray.d.y, ray.d.z, ray.tmin, ray.tmax);
    for (const crossing &c : t.roots)
        std::printf("    root %s slope %.3g, start %.3g: %s\n", text(c.t).c_str(), to_double(c.slope),
                    to_double(quad(0x1p-48) * c.spread / c.slope),
                    counts_of(c, ray.tmin, ray.tmax) == yes  ? "counts"
                    : counts_of(c, ray.tmin, ray.tmax) == no ? "does not count"
                                                             : "perhaps");
}

// t_err far above what the root is known to speaks of more than one.
bool about(const crossing &c, const sgt_hit &h) { return magnitude(c.t - h.t) <= h.t_err + c.off; }

void judge(const sgt_quadric &q, const sgt_ray &ray, const truth &t, const sgt_hit &h, const sgt_options &o)
{
    asked++, hits += h.status == SGT_HIT, misses += h.status == SGT_MISS, grazes += h.status == SGT_GRAZE,
        undecided += h.status < 0;
    if (h.status == SGT_INVALID || h.status == SGT_STOPPED) return fail("no such status", q, ray, t, h, o);
    if (!t.known) return;
    judged++;
    bool itself = false, may = false;
    for (const crossing &c : t.roots) {
        const counts k = counts_of(c, ray.tmin, ray.tmax);
        if (h.status > 0 && about(c, h)) itself = true, may = may || k != no;
        if (k != yes) continue;
        if (h.status == SGT_MISS) fail("a miss that meets", q, ray, t, h, o);
        if (o.pick != SGT_NEAR_SEED && h.status > 0 &&
            c.t < (h.status == SGT_GRAZE ? quad(h.lo) : quad(h.t) - h.t_err) - c.off)
            fail("not the first", q, ray, t, h, o);
        if (o.pick != SGT_NEAR_SEED && h.status < 0 && c.t < quad(h.lo) - 64 * quad(ulp(to_double(c.t))))
            fail("undecided, and a root before", q, ray, t, h, o);
        if (o.pick == SGT_NEAR_SEED && o.proof == SGT_PROVE_FIRST && h.status == SGT_HIT && !about(c, h))
            fail("the only one, and another", q, ray, t, h, o);
    }
    if (h.status == SGT_HIT && !itself) fail("a hit without a root", q, ray, t, h, o);
    else if (h.status == SGT_HIT && !may) fail("a root that does not count", q, ray, t, h, o);
}

void judge_all(const sgt_quadric &q, sgt_surface s, const sgt_ray &ray, const truth &t, sgt_options o)
{
    enum { most = 64 };
    sgt_hit hit[most], none = {};
    const int n = sgt_intersect_all(s, ray, most, hit, &o);
    asked++;
    if (n < 0 || n > most) return fail("all: invalid, or too many", q, ray, t, none, o);
    if (!t.known) return;
    judged++;
    none.status = SGT_MISS;
    for (const crossing &c : t.roots) {
        bool in = counts_of(c, ray.tmin, ray.tmax) != yes;
        for (int i = 0; i < n; i++)
            in = in || (hit[i].status == SGT_HIT ? about(c, hit[i]) : c.t >= hit[i].lo && c.t <= hit[i].hi);
        if (!in) fail("all: a root in no entry", q, ray, t, n ? hit[0] : none, o);
    }
    for (int i = 0; i < n; i++) {
        bool itself = hit[i].status != SGT_HIT;
        for (const crossing &c : t.roots)
            itself = itself || (about(c, hit[i]) && counts_of(c, ray.tmin, ray.tmax) != no);
        if (!itself) fail("all: an entry that is no root that counts", q, ray, t, hit[i], o);
    }
}

// ---------------------------------------------------------------- surfaces, rays

double whole(generator &g, int most) { return std::floor(g.uniform(-most, most + 1)); }

struct case_of {
    sgt_quadric q;
    double on[3], along[3]; // a point of the singular line or apex, about, and a direction in the surface
};

// (a . p + a3) (b . p + b3)
sgt_quadric product_of(const double a[4], const double b[4])
{
    sgt_quadric q = {};
    for (int i = 0; i < 3; i++) q.squares[i] = a[i] * b[i], q.linear[i] = a[i] * b[3] + a[3] * b[i];
    q.products[0] = a[0] * b[1] + a[1] * b[0], q.products[1] = a[1] * b[2] + a[2] * b[1],
    q.products[2] = a[0] * b[2] + a[2] * b[0];
    q.constant = a[3] * b[3];
    return q;
}

void cross(const double a[3], const double b[3], double out[3])
{
    for (int i = 0; i < 3; i++) out[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
}

double dot3(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

enum { planes, double_plane, cone, cylinder, kinds };
const char *const kind_names[] = {"a pair of planes", "a double plane", "a cone", "a cylinder"};

bool draw(generator &g, int kind, case_of *c)
{
    double a[4], b[4];
    for (int i = 0; i < 4; i++) a[i] = whole(g, 8), b[i] = whole(g, 6);
    if (dot3(a, a) == 0 || dot3(b, b) == 0) return false;
    if (kind == double_plane)
        for (int i = 0; i < 4; i++) b[i] = a[i];
    double line[3], u[3], w[3];
    cross(a, b, line);
    if (kind == planes && dot3(line, line) == 0) return false;
    const double turn[3] = {g.uniform(-1, 1), g.uniform(-1, 1), g.uniform(-1, 1)};
    cross(a, turn, u); // in the plane a
    if (kind == double_plane) {
        c->q = product_of(a, a);
        for (int i = 0; i < 3; i++)
            c->on[i] = -a[3] * a[i] / dot3(a, a) + g.uniform(-2, 2) * u[i], c->along[i] = u[i];
    } else if (kind == planes) {
        c->q = product_of(a, b);
        cross(b, line, u), cross(line, a, w); // the line: (-a3 (b x l) - b3 (l x a)) / l^2
        const double by = g.uniform(-2, 2), to = g.uniform(-1, 1), side = g.uniform(-1, 1);
        double in[3];
        cross(a, line, in);
        for (int i = 0; i < 3; i++)
            c->on[i] = (-a[3] * u[i] - b[3] * w[i]) / dot3(line, line) + by * line[i],
            c->along[i] = to * line[i] + side * in[i];
    } else {
            // about a whole centre: x^2 + y^2 = z^2 and the like, sheared by whole numbers; a cylinder has
            // no third
        const double e[3] = {whole(g, 4), whole(g, 4), kind == cone ? whole(g, 4) : 0};
        double m[3][3], centre[3];
        for (int i = 0; i < 3; i++) {
            centre[i] = whole(g, 4);
            for (int j = 0; j < 3; j++) m[i][j] = i == j ? 1 : g.chance(0.5) ? 0 : whole(g, 2);
        }
        c->q = sgt_quadric{};
        for (int k = 0; k < 3; k++) {
            const double l[4] = {m[k][0], m[k][1], m[k][2], -dot3(m[k], centre)};
            const sgt_quadric s = product_of(l, l);
            for (int i = 0; i < 3; i++)
                c->q.squares[i] += e[k] * s.squares[i], c->q.products[i] += e[k] * s.products[i],
                    c->q.linear[i] += e[k] * s.linear[i];
            c->q.constant += e[k] * s.constant;
        }
        if (kind == cylinder) c->q.constant -= g.chance(0.5) ? 0 : whole(g, 4);
        for (int i = 0; i < 3; i++) c->on[i] = centre[i], c->along[i] = turn[i];
        if (kind == cylinder) cross(m[0], m[1], c->along);
    }
    bool any = false;
    for (const double *x = c->q.squares; x < c->q.squares + 9; x++) any = any || *x != 0;
    return any && dot3(c->along, c->along) > 0;
}

double moved(generator &g, double x) { return x == 0 || g.chance(0.4) ? x : x + whole(g, 8) * ulp(x); }

// Numbers of few bits, of which the products are exact.
double coarse(double x) { return std::ldexp(std::nearbyint(std::ldexp(x, 20)), -20); }

sgt_ray random_ray(generator &g, const case_of &c)
{
    double p[3], d[3];
    const int way = g.below(4); // in it, nearly in it, through the singular place, anywhere near
    const double lift = way == 0 ? 0 : way == 1 ? g.sign() * g.log_uniform(1e-16, 1e-6) : 1;
    for (int i = 0; i < 3; i++) d[i] = c.along[i] + lift * g.uniform(-1, 1);
    const double length = std::sqrt(dot3(d, d));
    for (int i = 0; i < 3; i++) d[i] /= g.chance(0.9) ? length : 1, p[i] = c.on[i];
    if (way == 3 || g.chance(0.3))
        for (int i = 0; i < 3; i++) p[i] += g.sign() * g.log_uniform(1e-16, 1e-2);
    const double away = g.uniform(-10, 10);
    const bool few = g.chance(0.3);
    for (int i = 0; i < 3; i++) {
        if (few) d[i] = coarse(d[i]), p[i] = coarse(p[i]);
        p[i] -= away * d[i];
        p[i] = few ? coarse(p[i]) : moved(g, p[i]), d[i] = few ? d[i] : moved(g, d[i]);
    }
    sgt_ray r = {{p[0], p[1], p[2]}, {d[0], d[1], d[2]}, -HUGE_VAL, HUGE_VAL};
    return r;
}

} // namespace

int main(int argc, char **argv)
{
    const run r(argc, argv, 1000, 20241113);
    for (int kind = 0; kind < kinds; kind++) {
        generator g(r.seed ^ static_cast<std::uint64_t>(kind) << 40);
        kind_name = kind_names[kind];
        asked = undecided = hits = misses = grazes = judged = 0;
        for (long done = 0; done < r.count;) {
            case_of c;
            if (!draw(g, kind, &c)) continue;
            done++;
            const sgt_surface s = {&sgt_quadric_ops, &c.q};
            sgt_ray ray = random_ray(g, c);
            if (ray.d.x == 0 && ray.d.y == 0 && ray.d.z == 0) continue;
            const truth t = truth_of(c.q, ray);
            for (int start = 0; start < 3; start++) {
                if (start == 1) ray.tmin = g.uniform(-12, 12);
                if (start == 2) { // near the start of a root
                    if (t.roots.empty()) continue;
                    const crossing &at =
                        t.roots[static_cast<std::size_t>(g.below(static_cast<int>(t.roots.size())))];
                    ray.tmin = to_double(
                        at.t - quad(0x1p-48) * at.spread / at.slope *
                                   quad(g.uniform(0, 1) < 0.5 ? g.uniform(0, 1) : g.uniform(9, 20)));
                }
                ray.tmax = g.chance(0.5) ? HUGE_VAL : (start ? ray.tmin : -8) + g.uniform(0, 20);
                if (!(ray.tmin <= ray.tmax) || (ray.tmax == 0 && ray.tmin == 0) ||
                    !(std::fabs(ray.tmin) < 1e30 || start == 0))
                    continue;
                const int turn = g.below(3);
                for (int proof = 0; proof < 3; proof++) {
                    for (int pick = SGT_FIRST; pick <= SGT_NEAR_SEED; pick++) {
                        if (start && pick + proof != turn + 1) continue; // one of each kind
                        sgt_options o = {};
                        o.pick = static_cast<sgt_pick>(pick), o.proof = static_cast<sgt_proof>(proof);
                        const sgt_hit h = sgt_intersect(s, ray, &o);
                        judge(c.q, ray, t, h, o);
                        sgt_status status;
                        double at, err;
                        sgt_hits out = {};
                        out.status = &status, out.t = &at, out.t_err = &err;
                        sgt_intersect_batch(s, 1,
                                            {{&ray.o.x, &ray.o.y, &ray.o.z},
                                             {&ray.d.x, &ray.d.y, &ray.d.z},
                                             &ray.tmin,
                                             &ray.tmax},
                                            out, &o);
                        if (status != h.status || std::memcmp(&at, &h.t, sizeof at) ||
                            std::memcmp(&err, &h.t_err, sizeof err))
                            if (!(at != at && h.t != h.t))
                                fail("a batch says something else", c.q, ray, t, h, o);
                    }
                }
                sgt_options o = {};
                o.proof = static_cast<sgt_proof>(turn);
                judge_all(c.q, s, ray, t, o);
            }
        }
        std::printf("%-17s %ld answers, %ld of them judged by their roots: %ld hits, %ld misses, %ld grazes, "
                    "%ld undecided\n",
                    kind_name, asked, judged, hits, misses, grazes, undecided);
        std::fflush(stdout);
        if (grazes < asked / 50)
            failed[std::string(kind_name) + ": too few grazes, where the gradient vanishes"]++;
        if (judged < asked / 4 && kind != double_plane)
            failed[std::string(kind_name) + ": these rays are no test"]++;
    }
    for (const auto &f : failed) std::printf("FAIL %6ld  %s\n", f.second, f.first.c_str());
    return !failed.empty();
}
