// SPDX-License-Identifier: MIT
// Rays on which published programs have failed: the first root, or the miss, and then
// each root in its turn, from the one before.  The roots have 30 digits, no more.
#include "../ends.h"
#include "table.h"

#include <sagitta/sagitta.h>

#include <algorithm>

using namespace oracle;

static int failures;

static void fail(const std::string &id, const char *how, const char *why, const sgt_hit &h)
{
    failures++;
    std::printf("FAIL %s %s: %s; %s t %.17g t_err %.3g evals %d\n", id.c_str(), how, why,
                sgt_status_text(h.status), h.t, h.t_err, h.evals);
}

static void walk(const hard_case &c, const char *how, sgt_surface s, bool asphere)
{
    sgt_ray ray = c.ray;
    double before = -HUGE_VAL;
    for (const decimal &root : c.roots) {
        const sgt_hit h = sgt_intersect(s, ray, nullptr);
        if (!(h.status > 0)) return fail(c.id, how, "not met", h);
        if (!(std::fabs(root.minus(h.t)) <= h.t_err + 1e-29 * std::fabs(root.hi)))
            return fail(c.id, how, "not the first root, or t_err is no bound", h);
        if (!(h.t_err <= 1e-6 * std::max(1.0, std::fabs(h.t)))) return fail(c.id, how, "t_err is large", h);
        if (!(h.t > before)) return fail(c.id, how, "no progress", h);
        before = ray.tmin = h.t, ray.tmax = end_of(&c.ray); // the next one, from here
    }
    const sgt_hit h = sgt_intersect(s, ray, nullptr);
    if (h.status == SGT_MISS || (asphere && h.status < 0 && h.status != SGT_INVALID))
        return; // a missed asphere needs a proof
    fail(c.id, how, c.roots.empty() ? "a miss is wanted" : "a root after the last", h);
}

// The types of the catalogue: the list of all roots, and each in its turn.  A double root is one entry.
static void catalogue(const table &t, std::size_t row)
{
    enum { MOST = 8 };
    const std::string &id = t.cell(row, "id");
    const shape s(t, row);
    sgt_ray ray = ray_of(t, row);
    std::vector<decimal> roots;
    for (const decimal &root : roots_of(t, row))
        if (roots.empty() || root.minus(roots.back().hi) > 1e-15 * std::fabs(root.hi)) roots.push_back(root);
    sgt_hit entry[MOST] = {};
    const int count = sgt_intersect_all(s.surface, ray, MOST, entry, nullptr);
    std::size_t met = 0;
    for (int i = 0; i < count && i < MOST; i++) {
        if (entry[i].status < 0) continue; // what cannot be told; a root is missed only if none is met there
        if (met == roots.size()) return fail(id, "in the list", "more roots than there are", entry[i]);
        if (!(std::fabs(roots[met].minus(entry[i].t)) <= entry[i].t_err))
            return fail(id, "in the list", "t_err is no bound", entry[i]);
        if (!(entry[i].t_err <= 1e-6 * std::max(1.0, std::fabs(entry[i].t))))
            return fail(id, "in the list", "t_err is large", entry[i]);
        met++;
    }
    if (met != roots.size()) return fail(id, "in the list", "a root is missing", entry[0]);
    for (const decimal &root : roots) {
        const sgt_hit h = sgt_intersect(s.surface, ray, nullptr);
        if (!(h.status > 0)) return fail(id, "one by one", "not met", h);
        if (!(std::fabs(root.minus(h.t)) <= h.t_err))
            return fail(id, "one by one", "not the first root, or t_err is no bound", h);
        if (!(h.t > ray.tmin)) return fail(id, "one by one", "no progress", h);
        const double end = end_of(&ray);
        ray.tmin = h.t, ray.tmax = end; // the next one, from here
    }
    const sgt_hit h = sgt_intersect(s.surface, ray, nullptr);
    if (h.status > 0 || h.status == SGT_INVALID) fail(id, "one by one", "a root after the last", h);
}

int main(int argc, char **argv)
{
    if (argc < 2) return std::printf("usage: test_hard FOLDER-OF-DATA\n"), 2;
    const std::vector<hard_case> cases = hard_cases(argv[1]);
    for (const hard_case &c : cases) {
        sgt_even_asphere a = c.surface;
        sgt_conic k = {a.c, a.k, a.semi_diameter};
        const bool terms = has_terms(a);
        if (!terms) walk(c, "as conic", sgt_surface{&sgt_conic_ops, &k}, false);
        walk(c, "as asphere", sgt_surface{&sgt_even_asphere_ops, &a}, terms);
        if (a.semi_diameter > 0) {
            a.semi_diameter = 0;
            walk(c, "without its rim", sgt_surface{&sgt_even_asphere_ops, &a}, terms);
        }
    }
    const table others(std::string(argv[1]) + "/catalogue_cases.csv");
    for (std::size_t i = 0; i < others.rows.size(); i++) catalogue(others, i);
    std::printf("%zu cases, %d failures\n", cases.size() + others.rows.size(), failures);
    return failures != 0;
}
