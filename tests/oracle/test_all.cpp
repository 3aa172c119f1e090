// SPDX-License-Identifier: MIT
// Every root of a conic or an even asphere, in order, against quadruple precision: the cases are
// those of test_random.  Each root that counts is in an entry, each hit has a root of its own
// within t_err that counts, and the ray enters or leaves there as the exact slope says.
#include "cases.h"
#include "quad.h"

#include <map>

using namespace oracle;

namespace {

std::map<std::string, long> failed, counted;
enum { most = 40 };

void fail(const char *why, const test_case &t, const answer &a, int n, const sgt_hit h[], double number)
{
    if (failed[why]++ >= 4) return;
    std::printf("FAIL %s: %.17g\n    --replay \"", why, number);
    print_case(stdout, t);
    std::printf("\"\n");
    for (const meeting &m : a.roots)
        std::printf("    root %s%s\n", text(m.t()).c_str(), m.edge ? " (on an edge)" : "");
    for (const answer::stretch &s : a.doubtful)
        std::printf("    doubtful %s .. %s\n", text(s.lo).c_str(), text(s.hi).c_str());
    for (int i = 0; i < n; i++)
        std::printf("    %s t %.17g t_lo %.3g t_err %.3g lo %.17g hi %.17g p_err %.3g evals %d\n",
                    sgt_status_text(h[i].status), h[i].t, h[i].t_lo, h[i].t_err, h[i].lo, h[i].hi, h[i].p_err,
                    h[i].evals);
}

bool covers(const sgt_hit &h, const meeting &m)
{
    if (h.status > 0) return magnitude(m.minus(h.t)) <= quad(h.t_err) + m.blur;
    return m.t() >= quad(h.lo) - m.blur && m.t() <= quad(h.hi) + m.blur;
}

void check(const test_case &t)
{
    const answer a = all_roots(surface(t.surface), t.ray);
    if (a.at_fault || a.gave_up) {
        counted["left out: the oracle cannot tell"]++;
        return;
    }
    double tmin, tmax;
    ends_of(t.ray, &tmin, &tmax);
    sgt_conic conic;
    const sgt_surface s = as_surface(t, &conic);
    sgt_hit hit[most];
    const int n = sgt_intersect_all(s, t.ray, most, hit, nullptr);
    if (n < 0 || n > most) return fail("invalid, or too many", t, a, 0, hit, n);

    std::map<const meeting *, int> met; // by hits
    for (int i = 0; i < n; i++) {
        const sgt_hit &h = hit[i];
        counted[(t.narrow ? "narrow: " : "") + std::string(sgt_status_text(h.status))]++;
        if (i && !(h.t + h.t_err >= hit[i - 1].t - hit[i - 1].t_err)) fail("out of order", t, a, n, hit, h.t);
        if (h.status <= 0) {
            if (!(h.lo <= h.hi && h.status != SGT_MISS && h.status != SGT_INVALID && h.f != h.f))
                fail("an undecided stretch that is none", t, a, n, hit, h.lo);
            continue;
        }
        if (!(h.t >= tmin && h.t <= tmax && h.t_err >= 0 && h.p_err >= 0))
            fail("t, t_err or p_err makes no sense", t, a, n, hit, h.t);
        if (in_doubt(a, h)) continue;
        const meeting *root = meant(a, h);
        if (!root || !covers(h, *root)) {
            fail("a hit without a root within t_err", t, a, n, hit, h.t);
            continue;
        }
        if (counting(*root, tmin, tmax) == no) fail("a root that does not count", t, a, n, hit, h.t);
        met[root]++;
        const double slope = h.n.x * t.ray.d.x + h.n.y * t.ray.d.y + h.n.z * t.ray.d.z;
        const double size = std::fabs(h.n.x * t.ray.d.x) + std::fabs(h.n.y * t.ray.d.y) +
                            std::fabs(h.n.z * t.ray.d.z);
        if (h.status == SGT_HIT && std::fabs(slope) > 1e-6 * size && h.p_err < 1e-9 * t.h &&
            (slope > 0) != (root->slope > 0))
            fail("enters where it leaves", t, a, n, hit, slope);
        // (the point is that of this root, and not another within t_err of t)
        const vector3 off = {h.p.x - root->p.x, h.p.y - root->p.y, h.p.z - root->p.z};
        if (!(norm(off) <= quad(h.p_err) * (1 + quad(1e-9)) + norm(root->p) * quad(0x1p-107) +
                               root->blur * norm({t.ray.d.x, t.ray.d.y, t.ray.d.z})))
            fail("p is farther from the point than p_err", t, a, n, hit, h.t);
    }
    long expected = 0;
    for (const meeting &m : a.roots) {
        if (counting(m, tmin, tmax) != yes) continue;
        expected++;
        bool known = false;
        for (int i = 0; i < n; i++) known = known || covers(hit[i], m);
        for (const answer::stretch &d : a.doubtful)
            known = known || (d.lo <= m.t() + m.blur && d.hi >= m.t() - m.blur);
        if (!known) fail("a root in no entry", t, a, n, hit, to_double(m.t()));
    }
    // Two hits at one root: not unless several roots are within t_err of one another.
    for (const auto &e : met)
        if (e.second > 1) {
            bool close = !a.doubtful.empty();
            for (const meeting &m : a.roots)
                for (int i = 0; i < n; i++)
                    close = close || (&m != e.first && covers(hit[i], m) && covers(hit[i], *e.first));
            if (!close) fail("one root, two hits", t, a, n, hit, to_double(e.first->t()));
        }
    counted["rays with " + std::to_string(expected) + (expected == 1 ? " root" : " roots")]++;

    // What is first of all is first.
    const sgt_hit first = sgt_intersect(s, t.ray, nullptr);
    if ((n == 0) != (first.status == SGT_MISS)) fail("a miss alone, or of all", t, a, n, hit, first.t);
    else if (n && hit[0].status > 0 &&
             !(first.status > 0 && std::fabs(first.t - hit[0].t) <= first.t_err + hit[0].t_err))
        fail("not the first", t, a, n, hit, first.t);
    else if (n && hit[0].status < 0 && first.status > 0)
        fail("undecided of all, a hit alone", t, a, n, hit, first.t);
}

} // namespace

int main(int argc, char **argv)
{
    const run r(argc, argv, 20000, 20240301);
    if (r.replay) {
        test_case t;
        if (!read_case(r.replay, &t)) return 2;
        check(t);
        return !failed.empty();
    }
    generator g(r.seed);
    for (long i = 0; i < r.count; i++) check(i % 5 ? random_case(g) : random_narrow_case(g));
    for (const auto &c : counted) std::printf("  %9ld  %s\n", c.second, c.first.c_str());
    for (const auto &f : failed) std::printf("  FAIL %9ld  %s\n", f.second, f.first.c_str());
    long undecided = 0;
    for (const char *status : {"unproven", "undefined", "exhausted"}) undecided += counted[status];
    if (double(undecided) > 1 + 2e-5 * double(r.count))
        return std::printf("  FAIL undecided: %ld\n", undecided), 1;
    return !failed.empty();
}
