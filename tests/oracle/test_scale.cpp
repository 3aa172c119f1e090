// SPDX-License-Identifier: MIT
// What must not depend on the unit of length, on the length of the direction, on the
// side one looks from, or on being watched - to the last bit.
//
// Lengths times 2^k with c times 2^-k and a[i] times 2^(-(2i+1) k), |k| <= 40, and
// directions times 2^j, |j| <= 500, scale every operation of the solution exactly, so
// the answers must scale exactly, wherever no input leaves the normal range.  A turn
// by 90 degrees about z and the mirror images are exact too.
//
// Of evaluations on the way, too, where the squares of F and of its slope are numbers.  At
// points far off they, or the bounds made of them, may overflow at one scale and not at
// another: then the answer is the same, but not how many evaluations it took.
#include "cases.h"

#include <sagitta/sagitta.h>

#include <chrono>
#include <cfloat>
#include <map>
#include <string>

using namespace oracle;

namespace {

int failures, compared, skipped;
std::map<std::string, int> failed; // by kind

bool show(const char *kind)
{
    failures++;
    return ++failed[kind] <= 10;
}

bool same(double a, double b) { return a == b || (a != a && b != b); }
bool same(const sgt_vec3 &a, const sgt_vec3 &b) { return same(a.x, b.x) && same(a.y, b.y) && same(a.z, b.z); }
bool normal(double x)
{
    return x == 0 || std::isinf(x) || (std::fabs(x) >= DBL_MIN && std::fabs(x) <= DBL_MAX);
}
bool normal(const sgt_vec3 &v) { return normal(v.x) && normal(v.y) && normal(v.z); }

// An infinity is an end, or an input that overflowed.
bool in_range(const test_case &t)
{
    bool all = normal(t.surface.c) && normal(t.surface.semi_diameter) && normal(t.ray.o) && normal(t.ray.d) &&
               normal(t.ray.tmin) && normal(t.ray.tmax);
    for (double a : t.surface.a) all = all && normal(a) && std::isfinite(a);
    return all && std::isfinite(t.surface.c);
}

sgt_vec3 scaled(const sgt_vec3 &v, int k)
{
    return {std::ldexp(v.x, k), std::ldexp(v.y, k), std::ldexp(v.z, k)};
}

int count_calls(void *data, const sgt_step *step)
{
    int *calls = static_cast<int *>(data);
    if (step->eval != *calls + 1 || step->ray != 0) *calls = -1000000;
    ++*calls;
    return 0;
}

sgt_hit ask(const test_case &t, sgt_pick pick, int *calls = nullptr)
{
    sgt_conic conic;
    const sgt_surface s = as_surface(t, &conic);
    sgt_options options = {};
    options.pick = pick;
    if (calls) {
        options.watch = count_calls;
        options.watch_data = calls;
    }
    return sgt_intersect(s, t.ray, &options);
}

void print_hit(const char *name, const sgt_hit &h)
{
    std::printf("    %-9s %s evals %d t %a t_err %a t_lo %a lo %a hi %a f %a\n              p %a %a %a p_err "
                "%a n %a %a %a\n",
                name, sgt_status_text(h.status), h.evals, h.t, h.t_err, h.t_lo, h.lo, h.hi, h.f, h.p.x, h.p.y,
                h.p.z, h.p_err, h.n.x, h.n.y, h.n.z);
}

void compare(const char *what, int power, const test_case &t, const sgt_hit &got, const sgt_hit &want)
{
    compared++;
    if (got.status == want.status && got.evals == want.evals && same(got.t, want.t) &&
        same(got.t_err, want.t_err) && same(got.t_lo, want.t_lo) && same(got.lo, want.lo) &&
        same(got.hi, want.hi) && same(got.f, want.f) && same(got.p, want.p) && same(got.n, want.n) &&
        same(got.p_err, want.p_err))
        return;
    if (!show(what)) return;
    std::printf("FAIL %s (power %d)\n    --replay \"", what, power);
    print_case(stdout, t);
    std::printf("\"\n");
    print_hit("got", got);
    print_hit("wanted", want);
}

int note_overflow(void *data, const sgt_step *step)
{
    if (!(std::fabs(step->f) < 0x1p500 && std::fabs(step->slope) < 0x1p500))
        *static_cast<bool *>(data) = true;
    return 0;
}

bool overflows(const test_case &t, sgt_pick pick)
{
    sgt_conic conic;
    bool any = false;
    sgt_options options = {};
    options.pick = pick, options.watch = note_overflow, options.watch_data = &any;
    sgt_intersect(as_surface(t, &conic), t.ray, &options);
    return any;
}

// As compare, of the same question at another scale.
void compare_scaled(const char *what, int power, const test_case &t, const test_case &scaled_to,
                    sgt_pick pick, sgt_hit want)
{
    const sgt_hit got = ask(scaled_to, pick);
    if (got.evals != want.evals && (overflows(t, pick) || overflows(scaled_to, pick))) want.evals = got.evals;
    compare(what, power, scaled_to, got, want);
}

void lengths(const test_case &t, sgt_pick pick, const sgt_hit &hit, int k)
{
    test_case u = t;
    u.surface.c = std::ldexp(u.surface.c, -k);
    u.surface.semi_diameter = std::ldexp(u.surface.semi_diameter, k);
    for (int i = 0; i < 8; i++) u.surface.a[i] = std::ldexp(u.surface.a[i], -(2 * i + 1) * k);
    u.ray.o = scaled(u.ray.o, k); // d too would change t by nothing
    u.ray.d = scaled(u.ray.d, k);
    if (!in_range(u)) { skipped++; return; }
    sgt_hit want = hit;
    want.f = std::ldexp(want.f, k);
    want.p = scaled(want.p, k);
    want.p_err = std::ldexp(want.p_err, k);
    compare_scaled("lengths", k, t, u, pick, want);

    // ... and with d as it was: t then counts in lengths.
    u.ray.d = t.ray.d;
    u.ray.tmin = std::ldexp(u.ray.tmin, k);
    u.ray.tmax = std::ldexp(u.ray.tmax, k);
    for (double *x : {&want.t, &want.t_err, &want.t_lo, &want.lo, &want.hi}) *x = std::ldexp(*x, k);
    compare_scaled("lengths without d", k, t, u, pick, want);
}

void directions(const test_case &t, sgt_pick pick, const sgt_hit &hit, int j)
{
    test_case u = t;
    u.ray.d = scaled(u.ray.d, j);
    u.ray.tmin = std::ldexp(u.ray.tmin, -j);
    u.ray.tmax = std::ldexp(u.ray.tmax, -j);
    if (!in_range(u)) { skipped++; return; }
    sgt_hit want = hit;
    for (double *x : {&want.t, &want.t_err, &want.t_lo, &want.lo, &want.hi}) *x = std::ldexp(*x, -j);
    compare_scaled("directions", j, t, u, pick, want);
}

sgt_vec3 turned(const sgt_vec3 &v) { return {-v.y, v.x, v.z}; }
sgt_vec3 mirrored(const sgt_vec3 &v) { return {-v.x, v.y, v.z}; }

void symmetries(const test_case &t, sgt_pick pick, const sgt_hit &hit)
{
    test_case u = t;
    sgt_hit want = hit;
    u.ray.o = turned(t.ray.o), u.ray.d = turned(t.ray.d);
    want.p = turned(hit.p), want.n = turned(hit.n);
    compare("turned by 90 degrees about z", 0, u, ask(u, pick), want);

    u = t, want = hit;
    u.ray.o = mirrored(t.ray.o), u.ray.d = mirrored(t.ray.d);
    want.p = mirrored(hit.p), want.n = mirrored(hit.n);
    compare("mirrored in x", 0, u, ask(u, pick), want);

    u = t, want = hit;
    u.ray.o.z = -u.ray.o.z, u.ray.d.z = -u.ray.d.z;
    u.surface.c = -u.surface.c;
    for (double &a : u.surface.a) a = -a;
    want.f = -want.f, want.p.z = -want.p.z;
    want.n.x = -want.n.x, want.n.y = -want.n.y;
    compare("mirrored in z", 0, u, ask(u, pick), want);
}

} // namespace

int main(int argc, char **argv)
{
    const run r(argc, argv, 10000, 314159);
    const auto began = std::chrono::steady_clock::now();
    generator g(r.seed);
    for (long i = 0; i < r.count; i++) {
        const test_case t = random_case(g);
        const sgt_pick pick = g.chance(0.5) ? SGT_FIRST : SGT_NEAR_SEED;
        const sgt_hit hit = ask(t, pick);
        if (!in_range(t)) continue;

        int calls = 0;
        const sgt_hit watched = ask(t, pick, &calls);
        compare("watched", 0, t, watched, hit);
        if (calls != watched.evals && show("calls of the watcher")) {
            std::printf("FAIL calls of the watcher %d, evals %d\n    --replay \"", calls, watched.evals);
            print_case(stdout, t);
            std::printf("\"\n");
        }
        for (int k : {-40, 40, -1 - g.below(39), 1 + g.below(39)}) lengths(t, pick, hit, k);
        for (int j : {-500, 500, -1 - g.below(499), 1 + g.below(499)}) directions(t, pick, hit, j);
        symmetries(t, pick, hit);
    }
    for (const auto &f : failed) std::printf("  FAIL %8d  %s\n", f.second, f.first.c_str());
    std::printf("%d comparisons, %d skipped (an input leaves the normal range), %d failures, %.1f s\n",
                compared, skipped, failures,
                std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count());
    return failures != 0;
}
