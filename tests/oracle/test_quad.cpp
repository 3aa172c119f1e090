// SPDX-License-Identifier: MIT
// The oracle's check of itself, without the library: the search must find on conics
// what the closed form finds, and on aspheres every change of sign that a fine
// walk sees; equations with known roots come out to 30 digits.
#include "cases.h"
#include "quad.h"

using namespace oracle;

static int failures;

static void fail(const char *what, const test_case &t)
{
    if (failures++ < 10) {
        std::printf("FAIL %s: ", what);
        print_case(stdout, t);
        std::printf("\n");
    }
}

static void search_agrees_with_closed_form(generator &g, long count)
{
    long roots = 0, doubtful = 0;
    for (long i = 0; i < count; i++) {
        test_case t = random_case(g);
        for (double &a : t.surface.a) a = 0;
        const surface s(t.surface);
        const answer a = conic_roots(s, t.ray), b = all_roots_by_search(s, t.ray);
        if (!a.doubtful.empty() || !b.doubtful.empty() || b.gave_up) { doubtful++; continue; }
        if (t.surface.c == 0 || t.surface.k <= -1)
            continue; // no bound on the line: the search is not meant for it
        if (a.roots.size() != b.roots.size()) { fail("number of roots", t); continue; }
        for (std::size_t j = 0; j < a.roots.size(); j++, roots++)
            if (magnitude(a.roots[j].t() - b.roots[j].t()) >
                quad(1e-27) * (magnitude(a.roots[j].t()) + t.h) + a.roots[j].blur + b.roots[j].blur) {
                fail("root", t);
                std::printf("  %s\n  %s\n  blur %g %g\n", text(a.roots[j].t()).c_str(),
                            text(b.roots[j].t()).c_str(), to_double(a.roots[j].blur),
                            to_double(b.roots[j].blur));
            }
    }
    std::printf("conics: %ld cases, %ld roots, %ld doubtful\n", count, roots, doubtful);
    if (doubtful > count / 1000 + 1) failures++, std::printf("FAIL: too many doubtful\n");
}

static void walk_sees_no_more(generator &g, long count)
{
    long cases = 0, roots = 0, doubtful = 0, gave_up = 0, stretches = 0, most = 0, several = 0;
    while (cases < count) {
        test_case t = random_case(g);
        if (!t.asphere || surface(t.surface).bare()) continue;
        cases++;
        const surface s(t.surface);
        const answer a = all_roots(s, t.ray);
        stretches += a.stretches;
        most = std::max(most, a.stretches);
        gave_up += a.gave_up;
        if (a.at_fault) fail("F does not vanish at a root", t);
        if (!a.doubtful.empty() || a.gave_up) { doubtful++; continue; }
        roots += static_cast<long>(a.roots.size());
        several += a.roots.size() > 1;
        for (const meeting &m : a.roots) {
            const value v = evaluate(s, m.p);
            if (!(magnitude(v.f) <= 4 * m.blur * magnitude(m.slope))) fail("not a root", t);
            const quad size =
                t.h + norm(m.p); // of the terms of F: a second root may be far from what the ray is aimed at
            if (!(m.blur <= quad(1e-25) * (magnitude(m.t()) + size / magnitude(m.slope))))
                fail("a vague root", t);
        }
        // Walk in double over 3 h (or the domain) beside the aim, in 4000 steps; on the
        // moved ray, since o + t d is not to be trusted far from o.
        const double q = t.ray.d.x * t.ray.d.x + t.ray.d.y * t.ray.d.y;
        const double reach = 3 * t.h / std::sqrt(std::max(q, 1e-6 * t.ray.d.z * t.ray.d.z));
        const double t0 = q > 0 ? -(t.ray.o.x * t.ray.d.x + t.ray.o.y * t.ray.d.y) / q
                                : -t.ray.o.z / t.ray.d.z;
        const line l(t.ray, t0);
        const double ox = to_double(l.o.x), oy = to_double(l.o.y), oz = to_double(l.o.z);
        double before = NAN;
        long seen = 0;
        for (int i = 0; i <= 4000; i++) {
            const double w = -reach + reach * i / 2000, x = ox + w * t.ray.d.x, y = oy + w * t.ray.d.y,
                         r2 = x * x + y * y;
            double f = oz + w * t.ray.d.z - rough_sag(t.surface, r2);
            if ((1 + s.k) * s.c * s.c * r2 > 1 ||
                (s.semi_diameter > 0 && r2 > s.semi_diameter * s.semi_diameter))
                f = NAN;
            if (f != 0 && before != 0 && (f < 0) != (before < 0) && f == f && before == before) seen++;
            before = f;
        }
        if (seen > static_cast<long>(a.roots.size())) fail("the walk saw more roots", t);
    }
    std::printf("aspheres: %ld cases, %ld roots (%ld with several), %ld doubtful, %ld given up, stretches "
                "%.1f mean, %ld most\n",
                cases, roots, several, doubtful, gave_up, double(stretches) / double(count), most);
    if (doubtful > count / 1000 + 1) failures++, std::printf("FAIL: too many doubtful\n");
}

// z = r^2 (r^2 - 1) (r^2 - 4) / 8 along y, crossed by z = 0: roots -2, -1, 0 (double), 1, 2.
static void known_roots()
{
    test_case t = {};
    t.asphere = true;
    t.surface.a[0] = 0.5, t.surface.a[1] = -0.625, t.surface.a[2] = 0.125;
    t.ray = sgt_ray{{0, -3, 0}, {0, 1, 0}, -HUGE_VAL, HUGE_VAL};
    answer a = all_roots(surface(t.surface), t.ray);
    const double want[4] = {1, 2, 4, 5};
    if (a.roots.size() != 4 || a.doubtful.size() != 1) fail("roots of the sextic", t);
    else {
        for (int i = 0; i < 4; i++)
            if (magnitude(a.roots[std::size_t(i)].minus(want[i])) > quad(1e-30))
                fail("root of the sextic", t);
        if (!(a.doubtful[0].lo <= 3 && a.doubtful[0].hi >= 3 &&
              a.doubtful[0].hi - a.doubtful[0].lo < quad(1e-12)))
            fail("double root", t);
    }
    // A sphere seen from 1e12: 1e12 + 0.06726209469111849 at 30 digits.
    t = test_case();
    t.surface.c = 1;
    t.ray = sgt_ray{{0.3, 0.2, -1e12}, {0, 0, 1}, 0, 0};
    a = all_roots(surface(t.surface), t.ray);
    if (a.roots.size() != 1 || magnitude(a.roots[0].minus(1e12) - quad(0.06726209469111849)) > quad(1.5e-17))
        fail("far sphere", t);
    // Tangent to a sphere: a double root, doubtful; a part in 1e25 beside it: not.
    t.ray = sgt_ray{{0, -5, 1}, {0, 1, 0}, 0, 0};
    t.surface.c = 1;
    a = all_roots(surface(t.surface), t.ray); // through the equator, z = R: both ends on the sheet's limit
    if (a.roots.size() != 2 || !a.roots[0].edge || !a.roots[1].edge) fail("equator", t);
    t.ray = sgt_ray{{1, -5, 0.5}, {0, 1, 0}, 0, 0};
    if (!all_roots(surface(t.surface), t.ray).roots.empty()) fail("beside", t);
    t.ray = sgt_ray{{0, -5, 0}, {0, 1, 0}, 0, 0};
    if (all_roots(surface(t.surface), t.ray).doubtful.size() != 1) fail("tangent at the vertex", t);
    t.ray.o.z = -1e-25;
    if (!all_roots(surface(t.surface), t.ray).doubtful.empty() ||
        !all_roots(surface(t.surface), t.ray).roots.empty())
        fail("just past", t);
    t.ray.o.z = 1e-25;
    if (all_roots(surface(t.surface), t.ray).roots.size() != 2) fail("just through", t);
    // Square roots.
    for (double x : {2.0, 1e-300, 1e300, 0x1p-1074, 3e5}) {
        const quad r = square_root(quad(x));
        if (magnitude(r * r - x) > quad(x) * quad(0x1p-110))
            failures++, std::printf("FAIL square root of %g\n", x);
    }
}

int main(int argc, char **argv)
{
    const run r(argc, argv, 4000, 1);
    generator g(r.seed);
    known_roots();
    search_agrees_with_closed_form(g, r.count);
    walk_sees_no_more(g, r.count / 4);
    std::printf(failures ? "%d FAILED\n" : "ok\n", failures);
    return failures != 0;
}
