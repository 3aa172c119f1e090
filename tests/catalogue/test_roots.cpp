// SPDX-License-Identifier: MIT
// Where random rays meet random surfaces of the catalogue, against judge.h.
//
//   a hit        has a root of F, in 113 bits, within t_err of t; its point within p_err; it counts; it is
//                the first;
//   a miss       is one, as far as the judge sees;
//   undecided    has no root that counts before it; of ordinary rays nearly none is, where the surface or
//                the ray ends;
//   all roots    are in the list, in order, and each hit of it is a root;
//   near seed    a root that counts; where a proof is asked for, the only one;
//   a proof      is of one root alone; what it costs is that more is undecided;
//   the rim      is sharp to a part in 2^46;
//   ridges       rays along a sag that has ridges, as a grid of rows or a term of high order has: each may
//                be the first that is met, and an enclosure has to see each of them.  The judge takes 40
//                samples a ridge.  By estimate, and the first proven, alone and in a batch.
#include "judge.h"

using namespace catalogue;

namespace {

std::map<std::string, long> failed;
struct tally {
    long rays, hit, miss, undecided, graze, doubtful, several, bounded, bounded_undecided;
    long proven[2], asked[2];
};

void print_ray(const sgt_ray &r)
{
    std::printf("    ray {{%a, %a, %a}, {%a, %a, %a}, %a, %a}\n", r.o.x, r.o.y, r.o.z, r.d.x, r.d.y, r.d.z,
                r.tmin, r.tmax);
}

void fail(const char *why, const subject &of, const sgt_ray &ray, const judgement &j, int n,
          const sgt_hit *hits, double number)
{
    if (failed[of.s.type + ": " + why]++ >= 2) return;
    std::printf("FAIL %s, %s: %.17g\n", of.s.type.c_str(), why, number);
    print_surface(of.s.s);
    print_ray(ray);
    for (int i = 0; i < n; i++)
        std::printf("    %s t %.17g (%a) t_lo %.3g t_err %.3g [%.17g, %.17g] p %a %a %a +- %.3g evals %d\n",
                    sgt_status_text(hits[i].status), hits[i].t, hits[i].t, hits[i].t_lo, hits[i].t_err,
                    hits[i].lo, hits[i].hi, hits[i].p.x, hits[i].p.y, hits[i].p.z, hits[i].p_err,
                    hits[i].evals);
    for (const root &r : j.roots)
        std::printf("    root %s, slope %.3g%s\n", oracle::text(r.t).c_str(), plain(r.slope),
                    r.edge ? " (on the rim)" : "");
    for (const stretch &d : j.doubtful)
        std::printf("    doubtful %s .. %s\n", oracle::text(d.lo).c_str(), oracle::text(d.hi).c_str());
    std::fflush(stdout);
}

bool in_doubt(const judgement &j, quad lo, quad hi)
{
    for (const stretch &d : j.doubtful)
        if (d.lo <= hi && d.hi >= lo) return true;
    return false;
}

// One hit by itself: is there a root?
void check_hit(const subject &of, const sgt_ray &ray, const judgement &j, const sgt_hit &h)
{
    const double tmin = ray.tmin, tmax = ray.tmax;
    if (!(h.t >= tmin && h.t <= tmax && h.t_err >= 0 && h.t_err < HUGE_VAL && h.p_err >= 0))
        return fail("t, t_err or p_err makes no sense", of, ray, j, 1, &h, h.t);
    const quad lo = quad(h.t) - h.t_err, hi = quad(h.t) + h.t_err, a = j.at(lo), b = j.at(hi);
    if (h.status == SGT_GRAZE) {
        const quad f = j.at(quad(h.t));
        const double allowed = of.s.s.ops->rounding(of.s.s.self, h.p);
        if (f == f &&
            !(oracle::magnitude(f) <=
              8 * quad(allowed) + quad(1e-14) * of.s.h * oracle::norm(j.about(0).n)) &&
            !((a < 0) != (b < 0)))
            fail("a graze where F is not near zero", of, ray, j, 1, &h, plain(f));
        return;
    }
    root r;
    bool there = (a <= 0 && b >= 0) || (a >= 0 && b <= 0);
    const bool polished = j.polish(quad(h.t) + h.t_lo, &r) && oracle::magnitude(r.t - h.t) <= quad(h.t_err);
    if (!there && !polished) {
        // Two ends of one sign: a root of the judge's own may be inside, near a double one.
        for (const root &known : j.roots) there = there || oracle::magnitude(known.t - h.t) <= quad(h.t_err);
        if (!there) fail("a hit without a root within t_err", of, ray, j, 1, &h, plain(a));
        return;
    }
    if (!polished) {
        if (h.t_err > 1e-6 * of.s.h / oracle::to_double(oracle::norm({ray.d.x, ray.d.y, ray.d.z}))) return;
        if (!there) return;
        quad x = lo, y = hi;
        for (int i = 0; i < 120; i++) {
            const quad m = (x + y) / 2, f = j.at(m);
            ((f < 0) == (a < 0) ? x : y) = m;
        }
        if (!j.polish(x, &r)) return;
    }
    const vector3 off = {h.p.x - r.p.x, h.p.y - r.p.y, h.p.z - r.p.z};
    if (!(oracle::norm(off) <= quad(h.p_err) * (1 + quad(1e-9)) + oracle::norm(r.p) * quad(0x1p-100)))
        fail("p is farther from the point than p_err", of, ray, j, 1, &h, plain(oracle::norm(off)));
    if (of.s.rim > 0) {
        const quad r2 = r.p.x * r.p.x + r.p.y * r.p.y, rim2 = quad(of.s.rim) * of.s.rim * (1 + quad(0x1p-44));
        if (r2 > rim2 * (1 + quad(0x1p-48)))
            fail("a root outside the rim", of, ray, j, 1, &h, plain(r2 / rim2 - 1));
    }
    if (counting(r, tmin, tmax) == oracle::no) fail("a root that does not count", of, ray, j, 1, &h, h.t);
    sgt_vec3 n;
    const double f = of.s.s.ops->value(of.s.s.self, h.p, &n);
    if (std::memcmp(&f, &h.f, sizeof f) && f == f) fail("f is not F at p", of, ray, j, 1, &h, h.f);
    if (f == f && std::memcmp(&n, &h.n, sizeof n))
        fail("n is not the gradient at p", of, ray, j, 1, &h, h.n.x);
    if (h.status == SGT_HIT &&
        oracle::magnitude(r.slope) >
            quad(1e-4) * oracle::norm(r.n) * oracle::norm({ray.d.x, ray.d.y, ray.d.z}) &&
        (h.n.x * ray.d.x + h.n.y * ray.d.y + h.n.z * ray.d.z > 0) != (r.slope > 0))
        fail("enters where it leaves", of, ray, j, 1, &h, plain(r.slope));
}

bool before(const judgement &, const root &r, const sgt_hit &h) { return r.t < quad(h.t) - h.t_err; }

void check(const subject &of, generator &g, ray_kind kind, const sgt_ray &ray, tally *t)
{
    const judgement j(of, ray, 240);
    const double tmin = ray.tmin, tmax = ray.tmax;
    if (j.everywhere && j.from < tmax && j.to > tmin) {
        const sgt_hit h = sgt_intersect(of.s.s, ray, nullptr);
        if (j.from > tmin && j.to < tmax && (h.status == SGT_MISS || h.status == SGT_HIT))
            fail("a ray that lies in it", of, ray, j, 1, &h, h.t);
        return;
    }
    if (j.everywhere) return;
    t->rays++;
    t->doubtful += !j.doubtful.empty();
    t->several += j.roots.size() > 1;

    sgt_options options = {};
    const sgt_hit first = sgt_intersect(of.s.s, ray, &options);
    t->hit += first.status > 0, t->miss += first.status == SGT_MISS, t->undecided += first.status < 0,
        t->graze += first.status == SGT_GRAZE;
    const bool bounded = !of.s.sag || of.s.rim > 0 || (std::isfinite(tmin) && std::isfinite(tmax));
    t->bounded += bounded, t->bounded_undecided += bounded && first.status < 0;
    if (first.status == SGT_INVALID || first.status == SGT_STOPPED)
        return fail("invalid", of, ray, j, 1, &first, 0);
    if (first.status > 0) check_hit(of, ray, j, first);
    for (const root &r : j.roots) {
        if (counting(r, tmin, tmax) != oracle::yes || in_doubt(j, r.t, r.t)) continue;
        if (first.status == SGT_MISS) fail("a miss that meets", of, ray, j, 1, &first, plain(r.t));
        if (first.status > 0 && before(j, r, first)) fail("not the first", of, ray, j, 1, &first, plain(r.t));
        if (first.status < 0 && first.lo <= first.hi &&
            r.t < quad(first.lo) - quad(1e-12) * (oracle::magnitude(r.t) + of.s.h))
            fail("undecided, and a root before", of, ray, j, 1, &first, plain(r.t));
    }

    if (g.chance(0.5)) {
        enum { most = 40 };
        sgt_hit hit[most];
        const int n = sgt_intersect_all(of.s.s, ray, most, hit, &options),
                  kept = std::min(n, static_cast<int>(most));
        if (n < 0 || n > most) return fail("all: invalid, or too many", of, ray, j, 0, hit, n);
        for (int i = 0; i < kept; i++) {
            if (hit[i].status > 0) check_hit(of, ray, j, hit[i]);
            if (i && !(hit[i].t + hit[i].t_err >= hit[i - 1].t - hit[i - 1].t_err))
                fail("all: out of order", of, ray, j, kept, hit, hit[i].t);
            for (int k = 0; k < i; k++)
                if (hit[i].status == SGT_HIT && hit[k].status == SGT_HIT && hit[i].t == hit[k].t &&
                    hit[i].t_lo == hit[k].t_lo)
                    fail("all: one root twice", of, ray, j, kept, hit, hit[i].t);
        }
        const quad unit = of.s.h / oracle::norm({ray.d.x, ray.d.y, ray.d.z});
        for (const root &r : j.roots) {
            if (counting(r, tmin, tmax) != oracle::yes || in_doubt(j, r.t, r.t)) continue;
            bool known = false;
            for (int i = 0; i < kept; i++)
                known = known ||
                        (hit[i].status > 0 ? oracle::magnitude(r.t - hit[i].t) <=
                                                 quad(hit[i].t_err) * (1 + quad(1e-6)) + quad(0x1p-90) * unit
                                           : r.t >= hit[i].lo && r.t <= hit[i].hi);
            if (!known) fail("all: a root in no entry", of, ray, j, kept, hit, plain(r.t));
        }
        if ((n == 0) != (first.status == SGT_MISS) && first.status != SGT_EXHAUSTED)
            fail("all: a miss alone, or of all", of, ray, j, kept, hit, n);
        else if (n > 0 && first.status > 0 && hit[0].status > 0 &&
                 !(std::fabs(first.t - hit[0].t) <= first.t_err + hit[0].t_err))
            fail("all: another first", of, ray, j, kept, hit, first.t);
    }
    if (g.chance(0.3)) {
        options.pick = SGT_NEAR_SEED;
        const sgt_hit h = sgt_intersect(of.s.s, ray, &options);
        if (h.status > 0) check_hit(of, ray, j, h);
        for (const root &r : j.roots)
            if (h.status == SGT_MISS && counting(r, tmin, tmax) == oracle::yes && !in_doubt(j, r.t, r.t))
                fail("near the seed: a miss that meets", of, ray, j, 1, &h, plain(r.t));
    }
    if (g.chance(0.2)) {
        options.pick = g.chance(0.5) ? SGT_NEAR_SEED : SGT_FIRST;
        options.proof = g.chance(0.5) ? SGT_PROVE_ROOT : SGT_PROVE_FIRST;
        const sgt_hit h = sgt_intersect(of.s.s, ray, &options);
        if (kind == ordinary && bounded && options.pick == SGT_FIRST)
            t->asked[options.proof == SGT_PROVE_FIRST]++,
                t->proven[options.proof == SGT_PROVE_FIRST] += h.status >= 0;
        if (h.status > 0) check_hit(of, ray, j, h);
        long within = 0;
        for (const root &r : j.roots) {
            if (in_doubt(j, r.t, r.t)) continue;
            within += oracle::magnitude(r.t - h.t) <= quad(h.t_err);
            if (counting(r, tmin, tmax) != oracle::yes) continue;
            if (h.status == SGT_MISS) fail("proven: a miss that meets", of, ray, j, 1, &h, plain(r.t));
            if (h.status == SGT_HIT && options.proof == SGT_PROVE_FIRST &&
                (options.pick == SGT_FIRST ? before(j, r, h) : oracle::magnitude(r.t - h.t) > quad(h.t_err)))
                fail("proven: another root", of, ray, j, 1, &h, plain(r.t));
        }
        if (h.status == SGT_HIT && within > 1)
            fail("proven: two roots within t_err", of, ray, j, 1, &h, static_cast<double>(within));
    }
}

// From beside one point of a sag to beside another, over or through what is between.
void along_ridges(generator &g, const std::string &type, tally *t)
{
    enum { rays = 8 };
    double height;
    int ridges;
    const specimen s = ridged_specimen(g, type, &height, &ridges);
    const subject of(s);
    double in[6][rays], at[rays];
    sgt_ray all[rays];
    sgt_status status[rays];
    for (int i = 0; i < rays; i++) {
        sgt_vec3 end[2];
        for (sgt_vec3 &p : end) {
            const double r = 0.95 * s.h * (g.chance(0.5) ? 1 : std::sqrt(g.uniform(0, 1))),
                         about = g.chance(0.5) ? g.below(4) * 1.5707963267948966 + g.uniform(-0.05, 0.05)
                                               : g.uniform(0, 6.283185307179586);
            p = {r * std::cos(about), r * std::sin(about), height * g.uniform(-1.2, 1.2)};
            p.z += first_number(s.s)[0] * r * r / 2;
        }
        if (i % 2) end[1].x = -end[0].x, end[1].y = -end[0].y + s.h * g.uniform(-0.1, 0.1);
        const sgt_vec3 &a = end[0], &b = end[1];
        all[i] = {a, {b.x - a.x, b.y - a.y, b.z - a.z}, 0, g.chance(0.5) ? 1 : HUGE_VAL};
        const double v[6] = {a.x, a.y, a.z, all[i].d.x, all[i].d.y, all[i].d.z};
        for (int k = 0; k < 6; k++) in[k][i] = v[k];
        at[i] = all[i].tmax;
    }
    for (int proof = SGT_ESTIMATE; proof <= SGT_PROVE_FIRST; proof += 2) {
        sgt_options options = {};
        options.proof = static_cast<sgt_proof>(proof);
        sgt_hits out = {};
        double found[rays];
        out.status = status, out.t = found;
        sgt_intersect_batch(s.s, rays, {{in[0], in[1], in[2]}, {in[3], in[4], in[5]}, nullptr, at}, out,
                            &options);
        for (int i = 0; i < rays; i++) {
            const sgt_ray &ray = all[i];
            if (!(ray.d.x * ray.d.x + ray.d.y * ray.d.y > 0.01 * s.h * s.h)) continue;
            const judgement j(of, ray, std::max(240, 40 * ridges));
            const sgt_hit h = sgt_intersect(s.s, ray, &options);
            if (h.status != status[i] || (h.status > 0 && std::memcmp(&h.t, &found[i], sizeof h.t)))
                fail("ridges: a batch says something else", of, ray, j, 1, &h, status[i]);
            if (j.everywhere) continue;
            t->rays++, t->hit += h.status > 0, t->miss += h.status == SGT_MISS, t->undecided += h.status < 0;
            t->several += j.roots.size() > 1, t->doubtful += !j.doubtful.empty();
            if (h.status > 0) check_hit(of, ray, j, h);
            for (const root &r : j.roots) {
                if (counting(r, ray.tmin, ray.tmax) != oracle::yes || in_doubt(j, r.t, r.t)) continue;
                if (h.status == SGT_MISS) fail("ridges: a miss that meets", of, ray, j, 1, &h, plain(r.t));
                if (h.status > 0 && before(j, r, h))
                    fail("ridges: not the first", of, ray, j, 1, &h, plain(r.t));
                if (h.status < 0 && h.lo <= h.hi && r.t < quad(h.lo) - quad(1e-12))
                    fail("ridges: undecided, and a root before", of, ray, j, 1, &h, plain(r.t));
            }
        }
    }
}

// Axial rays at the rim: x^2 + y^2 says at once on which side they are.
void at_rim(const subject &of, generator &g, long *sure, long *unsure)
{
    for (int i = 0; i < 12; i++) {
        const double about = g.uniform(0, 6.283185307179586),
                     r = of.s.rim * (1 + g.sign() * g.log_uniform(1e-16, 1e-9));
        const sgt_ray ray = {
            {r * std::cos(about), r * std::sin(about), of.low - of.s.h}, {0, 0, 1}, -HUGE_VAL, HUGE_VAL};
        const double f = of.rough(ray.o.x, ray.o.y, 0.0);
        if (f != f) continue;
        const quad over = (quad(ray.o.x) * ray.o.x + quad(ray.o.y) * ray.o.y) / (quad(of.s.rim) * of.s.rim) -
                          1 - quad(0x1p-44);
        const sgt_hit h = sgt_intersect(of.s.s, ray, nullptr);
        const judgement j(of, ray, 8);
        const bool certain = oracle::magnitude(over) > quad(0x1p-46);
        (h.status < 0 ? *unsure : *sure)++;
        if (certain && h.status < 0) fail("undecided beside the rim", of, ray, j, 1, &h, plain(over));
        if (certain && h.status >= 0 && (h.status > 0) != (over < 0))
            fail("on the wrong side of the rim", of, ray, j, 1, &h, plain(over));
    }
}

} // namespace

int main(int argc, char **argv)
{
    const oracle::run r(argc, argv, 260, 20240602);
    const char *only = std::getenv("SAGITTA_TEST_TYPE");
    for (std::size_t k = 0; k < types.size(); k++) {
        if (only && std::strcmp(only, types[k])) continue;
        generator g(r.seed ^ static_cast<std::uint64_t>(k) << 40);
        tally of_kind[ray_kinds] = {}, all = {};
        long sure = 0, unsure = 0;
        for (long done = 0; done < r.count;) {
            const specimen s = random_specimen(g, types[k], g.chance(0.02));
            const subject of(s);
            for (int i = 0; i < 13; i++, done++) {
                const ray_kind kind = i < 5 ? ordinary : static_cast<ray_kind>(i - 4);
                check(of, g, kind, random_ray(g, of, kind), &of_kind[kind]);
            }
            if (s.sag && s.rim > 0 && g.chance(0.3)) at_rim(of, g, &sure, &unsure);
        }
        std::printf("%-14s", types[k]);
        for (int i = 0; i < ray_kinds; i++) {
            const tally &t = of_kind[i];
            all.rays += t.rays, all.hit += t.hit, all.miss += t.miss, all.undecided += t.undecided,
                all.graze += t.graze, all.doubtful += t.doubtful, all.several += t.several,
                all.bounded_undecided += t.bounded_undecided;
            for (int p = 0; p < 2; p++) all.proven[p] += t.proven[p], all.asked[p] += t.asked[p];
        }
        std::printf(" %6ld rays, %6ld hits, %5ld misses, %4ld grazes, %4ld with several roots, %3ld "
                    "doubtful; undecided %ld, %ld of them bounded (",
                    all.rays, all.hit, all.miss, all.graze, all.several, all.doubtful, all.undecided,
                    all.bounded_undecided);
        bool none = true;
        for (int i = 0; i < ray_kinds; i++)
            if (of_kind[i].undecided)
                std::printf("%s%s %ld", none ? "" : ", ", ray_names[i], of_kind[i].undecided), none = false;
        std::printf(
            "%s); ordinary ones proven %ld of %ld, first %ld of %ld; at the rim %ld decided, %ld not\n",
            none ? "none" : "", all.proven[0], all.asked[0], all.proven[1], all.asked[1], sure, unsure);
        std::fflush(stdout);
        const tally &o = of_kind[ordinary];
        if (double(o.bounded_undecided) > 1 + 0.001 * double(o.bounded))
            failed[std::string(types[k]) +
                   ": too many ordinary rays are undecided, where surface or ray have an end"]++;
        // Where neither ends, much of a line without an end has no bounds.
        if (double(o.undecided) > 3 + 0.2 * double(o.rays))
            failed[std::string(types[k]) + ": too many ordinary rays are undecided"]++;
        if (all.rays > 200 && (all.hit < all.rays / 4 || all.miss < all.rays / 50))
            failed[std::string(types[k]) + ": these rays are no test"]++;
        if (double(o.proven[0] + o.proven[1]) < 0.8 * double(o.asked[0] + o.asked[1]) - 3)
            failed[std::string(types[k]) + ": too few ordinary rays are proven"]++;
    }
    for (const char *type : {"grid", "chebyshev", "zernike", "q_con", "q_bfs", "odd_asphere", "toroidal",
                             "polynomial_xy", "sum"}) {
        if (only && std::strcmp(only, type)) continue;
        generator g(r.seed ^ static_cast<std::uint64_t>(type[0]) << 48 ^
                    static_cast<std::uint64_t>(type[2]) << 40);
        tally t = {};
        const bool grid = !std::strcmp(type, "grid");
        for (long done = 0; done < r.count; done += grid ? 4 : 26) along_ridges(g, type, &t);
        std::printf("%-14s %6ld rays along ridges, %6ld hits, %5ld misses, %ld with several roots, %ld "
                    "doubtful; %ld undecided\n",
                    type, t.rays, t.hit, t.miss, t.several, t.doubtful, t.undecided);
        if (t.several < t.rays / 20) failed[std::string(type) + ": these ridges are no test"]++;
        if (double(t.undecided) > 6 + 0.1 * double(t.rays)) // seen: 1 to 6 %
            failed[std::string(type) + ": too many rays along ridges are undecided"]++;
    }
    for (const auto &f : failed) std::printf("FAIL %6ld  %s\n", f.second, f.first.c_str());
    return !failed.empty();
}
