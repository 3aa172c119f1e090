// SPDX-License-Identifier: MIT
// First hits and all roots of quaternion level sets against brute force (brute.h): steps of 2e-5
// along the ray, of 2e-6 on one ray in a hundred, each change of sign bisected.
//
// Configurations.  Every set is met in three slices - the first three components; a slice tilted
// at random through a point of the set, with w parts and `at` not zero; and one of axes of
// different lengths that are not at right angles, at E = 1.5 R* instead of the smallest safe E,
// R* - at three N (the skew slice at the middle one), from three eyes: one outside the ball
// |Q| <= E, one in the ball and outside the set, one inside the set.  Where a slice has no such
// eye (a set of dust has no inside that points at random meet), the line `left out` says so.
//
// What is demanded of each ray.  No status is undecided.  For each reported root F changes sign
// within [t - t_err, t + t_err], by 113 bits and not by brute force, in the sense that n . d
// tells.  Between one root and the next, before the first and behind the last the sign stays, by
// 113 bits again, so that no odd number of roots is missing.  Each root of the brute force is
// there, nearer than max(1e-12, t_err).  Where the two differ 113 bits decide: a root that the
// library reports and brute force did not see is proven by its change of sign, and counted under
// `stepped over`; one that brute force saw and 113 bits do not confirm under `refuted`; one they
// confirm is missing in the library, and a failure.  So is a brute force that errs often.  A graze
// must have |F| next to nothing at t and t +- t_err, and stands for all roots within its t_err,
// however many; the columns |t - t_ref| and t_err are those of the other hits.
//
// 1 / F has a pole wherever brute force sees F change sign, and no root: no way of a user's surface may
// tell one.
//
//     test_brute                       a few rays of each configuration
//     test_brute --full                160x120 rays of each for first hits, 60x45 for all roots
//     test_brute --replay "..."        one ray, as a failure prints it
// --rays WxH, --set I, --seed S; SAGITTA_TEST_SCALE and SAGITTA_TEST_SEED.  The nine million rays
// of --full take some twenty minutes on one core with AVX-512, compiled with -O3 -march=native
// -fno-math-errno (the square root is then vectorised too), and four times that for plain x86-64.
#include "brute.h"
#include "cases.h"

#include <sagitta/sagitta.h>
#include <sagitta/surfaces.h>

#include <chrono>
#include <map>

using namespace brute;
using oracle::generator;
using oracle::to_double;

namespace {

// ------------------------------------------------------------------- sets

struct family {
    const char *name;
    bool mandelbrot;
    int power;
    quaternion c;
};

const family families[] = {
    {"classic (-0.083, 0, -0.83, -0.025)", false, 2, {-0.083, 0, -0.83, -0.025}},
    {"classic (-0.2, 0.8, 0, 0)", false, 2, {-0.2, 0.8, 0, 0}},
    {"(-1, 0.2, 0, 0)", false, 2, {-1, 0.2, 0, 0}},
    {"(-0.291, -0.399, 0.339, 0.437)", false, 2, {-0.291, -0.399, 0.339, 0.437}},
    {"(-0.2, 0.4, -0.4, -0.4)", false, 2, {-0.2, 0.4, -0.4, -0.4}},
    {"(-0.213, -0.041, -0.563, -0.56)", false, 2, {-0.213, -0.041, -0.563, -0.56}},
    {"(-0.125, -0.256, 0.847, 0.0895)", false, 2, {-0.125, -0.256, 0.847, 0.0895}},
    {"rabbit (-0.123, 0.745, 0, 0)", false, 2, {-0.123, 0.745, 0, 0}},
    {"(0.25, 0, 0, 0)", false, 2, {0.25, 0, 0, 0}},
    {"ball, c = 0", false, 2, {0, 0, 0, 0}},
    {"|c| = 2, (-2, 0, 0, 0)", false, 2, {-2, 0, 0, 0}},
    {"|c| = 2, (0, 2, 0, 0)", false, 2, {0, 2, 0, 0}},
    {"|c| = 1.99, (-1.1, 1.2, -0.9, 0.7)", false, 2, {-1.1, 1.2, -0.9, 0.7}},
    {"|c| = 1.96, (1.9, -0.3, 0.3, 0.2)", false, 2, {1.9, -0.3, 0.3, 0.2}},
    {"random, |c| = 0.73", false, 2, {-0.417, 0.284, 0.391, -0.358}},
    {"random, |c| = 1.18", false, 2, {-0.772, -0.518, 0.306, 0.661}},
    {"power 3, (0.35, 0.6, -0.2, 0.1)", false, 3, {0.35, 0.6, -0.2, 0.1}},
    {"power 8, (-0.5, 0.4, 0.5, -0.2)", false, 8, {-0.5, 0.4, 0.5, -0.2}},
    {"Mandelbrot", true, 2, {0, 0, 0, 0}},
    {"Mandelbrot, power 3", true, 3, {0, 0, 0, 0}},
};
const int number_of_families = sizeof families / sizeof *families;

// N with p^N of one size: the degree in t of what is solved.
int iterations_of(int power, int which)
{
    return power == 2 ? 4 + 4 * which : power == 3 ? 3 + 2 * which : 2 + which;
}

// The root of x^p = x + |c| (p = 2: (1 + sqrt(1 + 4 |c|)) / 2), or 2^(1/(p-1)) for the Mandelbrot
// set, up by a little more than rounding.
double safe_escape(const family &f)
{
    if (f.mandelbrot) return std::pow(2, 1.0 / (f.power - 1)) * (1 + 0x1p-48);
    const double c = std::sqrt(f.c[0] * f.c[0] + f.c[1] * f.c[1] + f.c[2] * f.c[2] + f.c[3] * f.c[3]);
    double lo = 1, hi = 3;
    for (int i = 0; i < 60; i++) {
        const double m = (lo + hi) / 2;
        (std::pow(m, f.power) < m + c ? lo : hi) = m;
    }
    return hi * (1 + 0x1p-48);
}

double dot(const quaternion &a, const quaternion &b)
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
}

quaternion combine(const quaternion &a, double s, const quaternion &b)
{
    return {a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2], a[3] + s * b[3]};
}

quaternion random_direction(generator &g)
{
    quaternion q;
    double n;
    do {
        for (double &x : q) x = g.uniform(-1, 1);
        n = dot(q, q);
    } while (!(n > 0.01 && n < 1));
    for (double &x : q) x /= std::sqrt(n);
    return q;
}

// One of the p-th roots of q, by the polar form.
quaternion random_root(const quaternion &q, int power, generator &g)
{
    quaternion v = {0, q[1], q[2], q[3]};
    double length = std::sqrt(dot(v, v));
    const double angle = (std::atan2(length, q[0]) + 2 * std::acos(-1.0) * g.below(power)) / power;
    const double radius = std::pow(dot(q, q), 0.5 / power);
    while (!(length > 0)) {
        v = random_direction(g);
        v[0] = 0;
        length = std::sqrt(dot(v, v));
    }
    return {radius * std::cos(angle), radius * std::sin(angle) * v[1] / length,
            radius * std::sin(angle) * v[2] / length, radius * std::sin(angle) * v[3] / length};
}

// How many of Q_0 ... Q_N, one after the other, are within E, and the sum of their log |Q_k|^2: the
// less, the smaller the derivative of Q_N and the wider what is around.
struct depth {
    int levels;
    double narrowness;
};

depth depth_at(const level_set &s, const quaternion &start)
{
    depth found = {0, 0};
    quaternion q = start;
    for (int n = s.mandelbrot; n <= s.iterations && dot(q, q) <= s.escape * s.escape; n++) {
        found.levels++;
        found.narrowness += std::log(dot(q, q) + 1e-9);
        const double square = dot(q, q) - q[0] * q[0];
        double real = q[0], factor = 1; // Q^k = real + factor v
        for (int k = 1; k < s.power; k++) {
            const double before = real;
            real = q[0] * real - square * factor;
            factor = q[0] * factor + before;
        }
        for (double &x : q) x *= factor;
        q[0] = real;
        q = combine(q, 1, s.mandelbrot ? start : s.c);
    }
    return found;
}

// ---------------------------------------------------------- configurations

enum { straight, tilted, skew, number_of_slices };
enum { outside, in_the_ball, inside, number_of_eyes };
const char *const slice_names[] = {"straight", "tilted", "skew, E = 1.5 R*"};
const char *const eye_names[] = {"eye outside", "eye in the ball", "eye in the set"};

vector3 sum(const vector3 &a, double s, const vector3 &b)
{
    return {a.x + s * b.x, a.y + s * b.y, a.z + s * b.z};
}
double dot(const vector3 &a, const vector3 &b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
vector3 cross(const vector3 &a, const vector3 &b)
{
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
vector3 unit(const vector3 &a)
{
    const double n = std::sqrt(dot(a, a));
    return {a.x / n, a.y / n, a.z / n};
}
vector3 random_direction3(generator &g)
{
    vector3 v;
    do v = {g.uniform(-1, 1), g.uniform(-1, 1), g.uniform(-1, 1)};
    while (!(dot(v, v) > 0.01 && dot(v, v) < 1));
    return unit(v);
}

// A set in its slice, with what the eyes need; the same for every N.
struct scene {
    level_set set;
    vector3 centre, deepest,
        nearest; // of the ball in the slice; where the set is widest; outside, and near it
    double radius, longest;           // of the ball; of a unit of length in Q, seen in the slice
    int deepest_levels, nearest_levels;
};

// The set and its slice, and a point of the slice that may well be in the set.
level_set make_set(int index, int slice, std::uint64_t seed, vector3 *within)
{
    const family &f = families[index];
    generator g(seed + static_cast<std::uint64_t>(1000 * index + slice));
    level_set s = {f.mandelbrot, f.power, iterations_of(f.power, 2), safe_escape(f),
                   f.c,          {},      {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
    *within = {0.37, 0, 0}; // c = -2 is dust but for the real axis
    if (slice == straight) return s;
    for (int i = 0; i < 3; i++) { // Gram and Schmidt
        quaternion &q = s.axis[i];
        double n;
        do {
            q = random_direction(g);
            for (int twice = 0; twice < 2; twice++)
                for (int j = 0; j < i; j++) q = combine(q, -dot(q, s.axis[j]), s.axis[j]);
            n = std::sqrt(dot(q, q));
        } while (n < 0.3);
        for (double &x : q) x /= n;
    }
    // A point of the set: backwards from 0, the widest of a hundred.
    double narrowest = HUGE_VAL;
    for (int i = 0; i < 100; i++) {
        quaternion q = {};
        double narrowness = 0;
        for (int k = 0; k < s.iterations; k++) {
            q = random_root(combine(q, -1, s.c), s.power, g);
            narrowness += std::log(dot(q, q));
        }
        if (s.mandelbrot) q = random_direction(g), q = combine(q, -0.8, q);
        if (narrowness < narrowest) narrowest = narrowness, s.at = q;
    }
    if (slice == skew) {
        s.escape *= 1.5;
        const double scale[3] = {1.3, 0.6, 2.1};
        for (int i = 0; i < 3; i++)
            for (double &x : s.axis[i]) x *= scale[i];
        s.axis[0] = combine(s.axis[0], 0.4, s.axis[1]);
        s.axis[2] = combine(s.axis[2], -0.3, s.axis[0]);
    }
    *within = {g.uniform(0.05, 0.3), g.uniform(0.05, 0.3), g.uniform(0.05, 0.3)};
    s.at = combine(combine(combine(s.at, -within->x, s.axis[0]), -within->y, s.axis[1]), -within->z,
                   s.axis[2]);
    return s;
}

quaternion point_of(const level_set &s, const vector3 &p)
{
    return combine(combine(combine(s.at, p.x, s.axis[0]), p.y, s.axis[1]), p.z, s.axis[2]);
}

scene make_scene(int index, int slice, std::uint64_t seed)
{
    scene c = {};
    vector3 within = {};
    level_set &s = c.set = make_set(index, slice, seed, &within);
    generator g(seed + static_cast<std::uint64_t>(1000 * index + 10 * slice + 7));

    // The point of the slice nearest to Q = 0, by relaxation.
    double x[3] = {};
    quaternion q = s.at;
    for (int round = 0; round < 500; round++)
        for (int i = 0; i < 3; i++) {
            const double step = -dot(q, s.axis[i]) / dot(s.axis[i], s.axis[i]);
            x[i] += step;
            q = combine(q, step, s.axis[i]);
        }
    c.centre = {x[0], x[1], x[2]};
    c.radius = std::sqrt(s.escape * s.escape - dot(q, q));
    for (const quaternion &axis : s.axis) c.longest = std::max(c.longest, 1 / std::sqrt(dot(axis, axis)));

    // The deepest of many points in the ball; then, at the least N, the nearest of a few outside.
    const auto draw = [&](double reach) {
        return sum(c.centre, reach * c.longest * c.radius * std::cbrt(g.uniform(0, 1)), random_direction3(g));
    };
    c.deepest = within;
    depth best = depth_at(s, point_of(s, within));
    for (int i = 0; i < 20000; i++) {
        const vector3 p = draw(1);
        const depth d = depth_at(s, point_of(s, p));
        if (d.levels > best.levels || (d.levels == best.levels && d.narrowness < best.narrowness))
            best = d, c.deepest = p;
    }
    c.deepest_levels = best.levels;
    s.iterations = iterations_of(s.power, 0);
    for (int i = 0, candidates = 0; i < 20000 && candidates < 20; i++) {
        const vector3 p = draw(0.9);
        const int levels = depth_at(s, point_of(s, p)).levels;
        if (levels == 0 || levels + s.mandelbrot > s.iterations) continue;
        candidates++;
        if (levels > c.nearest_levels) c.nearest_levels = levels, c.nearest = p;
    }
    return c;
}

struct configuration {
    level_set set;
    vector3 eye, forward, right, up;
    double middle; // of a pixel: 0 gives rays with d.x = 0 or d.y = 0
};

// False: the slice has no such eye.
bool make_configuration(const scene &c, int iterations, int slice, int eye, generator &g, configuration *out)
{
    const bool axis_parallel = slice == straight && eye == outside;
    vector3 look = random_direction3(g);
    out->set = c.set;
    out->set.iterations = iterations;
    out->middle = axis_parallel ? 0 : 0.5;
    if (eye == outside) {
        if (axis_parallel) look = {0, 0, 1};
        out->eye = sum(c.centre, -2.5 * c.radius * c.longest, look);
    } else if (eye == in_the_ball) {
        if (c.nearest_levels == 0) return false;
        out->eye = c.nearest;
        look = unit(sum(c.deepest, -1, c.nearest));
    } else {
        if (c.deepest_levels + c.set.mandelbrot <= iterations) return false;
        out->eye = c.deepest;
    }
    const vector3 right = axis_parallel ? vector3{1, 0, 0} : unit(cross(look, {look.y, look.z, -look.x}));
    const double width = eye == outside ? 0.8 : 2;
    out->forward = look;
    out->right = sum({0, 0, 0}, width, right);
    out->up = sum({0, 0, 0}, width, cross(right, look));
    return true;
}

ray ray_of(const configuration &c, int i, int j, int width, int height)
{
    const double x = (i + c.middle - width / 2) / width, y = (j + c.middle - height / 2) / width;
    return {c.eye, unit(sum(sum(c.forward, x, c.right), y, c.up))};
}

// ------------------------------------------------------------- the library

struct library_set {
    sgt_julia julia;
    sgt_mandelbrot mandelbrot;
    bool is_mandelbrot;

    explicit library_set(const level_set &s) : julia(), mandelbrot(), is_mandelbrot(s.mandelbrot)
    {
        for (std::size_t i = 0; i < 4; i++) {
            julia.c[i] = s.c[i];
            julia.at[i] = mandelbrot.at[i] = s.at[i];
            julia.ex[i] = mandelbrot.ex[i] = s.axis[0][i];
            julia.ey[i] = mandelbrot.ey[i] = s.axis[1][i];
            julia.ez[i] = mandelbrot.ez[i] = s.axis[2][i];
        }
        julia.escape = mandelbrot.escape = s.escape;
        julia.iterations = mandelbrot.iterations = s.iterations;
        julia.power = mandelbrot.power = s.power;
    }
    sgt_surface surface() const
    {
        return is_mandelbrot ? sgt_surface{&sgt_mandelbrot_ops, &mandelbrot}
                             : sgt_surface{&sgt_julia_ops, &julia};
    }
};

// What the library says: the first hit, or all.  A miss is no entry.
std::vector<sgt_hit> answers(const level_set &s, const ray &r, bool first_only, long *evals)
{
    const library_set set(s);
    const sgt_ray line = {{r.o.x, r.o.y, r.o.z}, {r.d.x, r.d.y, r.d.z}, 0, 0};
    std::vector<sgt_hit> hits(1);
    if (first_only) {
        hits[0] = sgt_intersect(set.surface(), line, nullptr);
        *evals += hits[0].evals;
        if (hits[0].status == SGT_MISS) hits.clear();
        return hits;
    }
    for (;;) {
        const int n = sgt_intersect_all(set.surface(), line, static_cast<int>(hits.size()), hits.data(),
                                        nullptr);
        const bool complete = n <= static_cast<int>(hits.size());
        if (n < 0) hits[0].status = SGT_INVALID;
        hits.resize(static_cast<std::size_t>(n < 0 ? 1 : n));
        if (complete) break;
    }
    for (const sgt_hit &h : hits) *evals += h.evals;
    return hits;
}

// -------------------------------------------------------------- comparison

struct row {
    long rays, met, missed, roots, stepped_over, refuted, wrong, undecided, grazes, evals;
    double error, t_err;
    void add(const row &r)
    {
        rays += r.rays, met += r.met, missed += r.missed, roots += r.roots, stepped_over += r.stepped_over,
            refuted += r.refuted;
        wrong += r.wrong, undecided += r.undecided, grazes += r.grazes, evals += r.evals;
        error = std::max(error, r.error);
        t_err = std::max(t_err, r.t_err);
    }
};

void print_head(const char *title)
{
    const char *const form = "%-38s %8s %8s %8s %8s %9s %7s %7s %6s %9s %9s %9s %7s\n";
    std::printf("\n");
    std::printf(form, title, "rays", "met", "missed", "roots", "stepped", "refuted", "library", "un-",
                "|t-t_ref|", "t_err", "evals", "grazes");
    std::printf(form, "", "", "", "", "", "over", "", "wrong", "decid.", "worst", "worst", "mean", "");
}

void print_row(const char *name, const row &r)
{
    std::printf("%-38s %8ld %8ld %8ld %8ld %9ld %7ld %7ld %6ld %9.2g %9.2g %9.1f %7ld\n", name, r.rays, r.met,
                r.missed, r.roots, r.stepped_over, r.refuted, r.wrong, r.undecided, r.error, r.t_err,
                double(r.evals) / double(std::max(r.rays, 1L)), r.grazes);
    std::fflush(stdout);
}

std::map<std::string, long> failures;
bool talkative; // of one ray: say everything

void print_case(const level_set &s, const ray &r)
{
    std::printf("--replay \"%d %d %d %a", s.mandelbrot, s.power, s.iterations, s.escape);
    for (const quaternion *q : {&s.c, &s.at, &s.axis[0], &s.axis[1], &s.axis[2]})
        for (double x : *q) std::printf(" %a", x);
    std::printf(" %a %a %a %a %a %a\"", r.o.x, r.o.y, r.o.z, r.d.x, r.d.y, r.d.z);
}

// ------------------------------------------------------------------ poles
//
// 1 / F of a set, as a user's surface: where the brute force sees a change of sign it has a pole, and
// nowhere a root.

struct inverse {
    sgt_surface of;
    double seed; // NaN: none
    bool single;
};

double inverse_value(const void *self, sgt_vec3 p, sgt_vec3 *grad)
{
    const sgt_surface &s = static_cast<const inverse *>(self)->of;
    sgt_vec3 n;
    const double f = s.ops->value(s.self, p, &n);
    if (grad) *grad = {-n.x / (f * f), -n.y / (f * f), -n.z / (f * f)};
    return 1 / f;
}

double inverse_rounding(const void *self, sgt_vec3 p)
{
    const sgt_surface &s = static_cast<const inverse *>(self)->of;
    const double f = std::fabs(s.ops->value(s.self, p, nullptr)), off = s.ops->rounding(s.self, p);
    return off < f ? off / (f * (f - off)) + 0x1p-52 / f : HUGE_VAL;
}

sgt_span inverse_span(const void *self, const sgt_ray *r)
{
    const inverse *v = static_cast<const inverse *>(self);
    sgt_span span = v->of.ops->span(v->of.self, r);
    if (span.lo < 0) span.lo = 0;
    if (v->single) span.lo = v->seed - 1e-3, span.hi = v->seed + 1e-3;
    span.seed = v->seed, span.single = v->single;
    return span;
}

long poles(const level_set &s, const ray &r)
{
    const library_set set(s);
    const sgt_ray line_of = {{r.o.x, r.o.y, r.o.z}, {r.d.x, r.d.y, r.d.z}, 0, 0};
    const std::vector<change> found = changes(s, line(s, r), 1e-3, false);
    sgt_surface_ops ops = {};
    ops.name = "inverse", ops.value = inverse_value, ops.span = inverse_span;
    for (std::size_t i = 0; i < found.size(); i++)
        for (int way = 0; way < 8; way++) {
            const inverse v = {set.surface(), way & 1 ? found[i].t : NAN, (way & 3) == 3};
            sgt_options o = {};
            o.pick = way & 1 ? SGT_NEAR_SEED : SGT_FIRST;
            o.dt_min = 1e-2;
            ops.rounding = way & 4 ? inverse_rounding : nullptr;
            const sgt_surface surface = {&ops, &v};
            sgt_hit all[16];
            const sgt_hit first = sgt_intersect(surface, line_of, &o);
            const int n = sgt_intersect_all(surface, line_of, 16, all, &o);
            bool met = first.status > 0;
            for (int k = 0; k < n && k < 16; k++) met = met || all[k].status > 0;
            if (!met) continue;
            if (failures["a pole is a root"]++ < 5)
                std::printf("FAIL a pole at %.17g is a root, way %d, t %.17g, f %g: ", found[i].t, way,
                            first.t, first.f),
                    print_case(s, r), std::printf("\n");
        }
    return static_cast<long>(found.size());
}

bool read_case(const char *text, level_set *s, ray *r)
{
    double v[30];
    char *end;
    for (double &x : v) {
        x = std::strtod(text, &end);
        if (end == text) return false;
        text = end;
    }
    *s = {v[0] != 0, static_cast<int>(v[1]), static_cast<int>(v[2]), v[3], {}, {}, {}};
    const double *next = v + 4;
    for (quaternion *q : {&s->c, &s->at, &s->axis[0], &s->axis[1], &s->axis[2]})
        for (double &x : *q) x = *next++;
    *r = {{v[24], v[25], v[26]}, {v[27], v[28], v[29]}};
    return true;
}

void print_entry(const sgt_hit &h, const ray &r)
{
    std::printf("    library  %-9s t %.17g (%a) t_err %.3g [%.17g, %.17g] n.d %.3g evals %d\n",
                sgt_status_text(h.status), h.t, h.t, h.t_err, h.lo, h.hi,
                h.n.x * r.d.x + h.n.y * r.d.y + h.n.z * r.d.z, h.evals);
}

// The first hit, or all roots, of one ray; what of it is to be counted.
row compare(const level_set &s, const ray &r, double step, bool first_only)
{
    row out = {};
    out.rays = 1;
    const exact_line exact(s, r);
    const std::vector<sgt_hit> hits = answers(s, r, first_only, &out.evals);
    std::vector<change> seen = changes(s, line(s, r), step, first_only);
    const char *failure = nullptr;
    double where = NAN;
    const auto fail = [&](const char *what, double t) {
        if (!failure) failure = what, where = t;
    };
    const double slack = 1e-12;

    // The library's roots by themselves, in 113 bits: each is there, and the signs between agree.
    bool known = true, is_in = exact.is_inside(0), undecided = false, positive = false;
    quad reach = 0;
    double before = 0;
    std::vector<bool> rises(hits.size()), used(hits.size());
    for (std::size_t i = 0; i < hits.size(); i++) {
        const sgt_hit &h = hits[i];
        if (h.status == SGT_INVALID) fail("a valid question called invalid", h.t);
        if (h.status < 0) {
            undecided = true, known = false;
            continue;
        }
        positive = true;
        const quad lo = quad(h.t) - h.t_err, hi = quad(h.t) + h.t_err;
        const double slope = h.n.x * r.d.x + h.n.y * r.d.y + h.n.z * r.d.z;
        const bool in_lo = exact.is_inside(lo), in_hi = exact.is_inside(hi);
        rises[i] = slope > 0;
        if (!(h.t >= before && h.t_err >= 0 && h.t_err < HUGE_VAL)) fail("t or t_err out of order", h.t);
        before = h.t;
        out.roots++;
        if (h.status == SGT_GRAZE) {
            out.grazes++;
            used[i] = true;
            for (quad t : {lo, quad(h.t), hi})
                if (!(std::fabs(to_double(exact.excess(t))) <= 1e-10))
                    fail("a graze where F is not near zero", h.t);
            continue;
        }
        out.t_err = std::max(out.t_err, h.t_err);
        if (in_lo == in_hi) {
            if (!exact.changes_within(lo, hi)) fail("F does not change sign within t_err", h.t);
        } else if (!(in_lo ? slope > 0 : slope < 0)) fail("n . d has the wrong sign", h.t);
        if (known && lo > reach && in_lo != is_in)
            fail("the sign is not that behind the root before: a root is missing", h.t);
        known = true, is_in = in_hi, reach = hi;
    }
    if (known && is_in && (hits.empty() || !first_only))
        fail("the ray ends inside: the last root is missing", before);

    // The roots of the brute force: each is among them.
    const auto match = [&](quad root, bool rising) {
        std::size_t nearest = hits.size();
        double least = HUGE_VAL;
        for (std::size_t i = 0; i < hits.size(); i++) {
            if (hits[i].status != SGT_HIT || used[i] || rises[i] != rising) continue;
            const double distance = std::fabs(to_double(root - hits[i].t));
            if (distance <= std::max(slack, hits[i].t_err) && distance < least) nearest = i, least = distance;
        }
        return std::make_pair(nearest, least);
    };
    bool refuted = false;
    for (const change &c : seen) {
        if (first_only && !hits.empty() && hits[0].status == SGT_HIT &&
            hits[0].t < c.t - std::max(slack, hits[0].t_err))
            break; // the library's is earlier, and proven above
        const auto grazed = [&](const sgt_hit &h) {
            return h.status == SGT_GRAZE && std::fabs(h.t - c.t) <= h.t_err;
        };
        if (std::any_of(hits.begin(), hits.end(), grazed)) continue;
        std::pair<std::size_t, double> found = match(c.t, c.rises);
        if (!(found.second <= slack)) {
            // 113 bits decide, within the bracket and a few units of rounding beside it.
            const quad lo = quad(c.lo) - 0x1p-48, hi = quad(c.hi) + 0x1p-48;
            if (exact.is_inside(lo) == exact.is_inside(hi)) {
                refuted = true;
                continue;
            }
            found = match(exact.root(lo, hi), c.rises);
        }
        if (found.first < hits.size()) {
            used[found.first] = true;
            out.error = std::max(out.error, found.second);
            continue;
        }
        const auto covers = [&](const sgt_hit &h) {
            return h.status < 0 && (first_only || (h.lo <= c.hi && h.hi >= c.lo));
        };
        if (std::none_of(hits.begin(), hits.end(), covers)) fail("a root is missing", c.t);
    }
    const bool stepped_over = std::find(used.begin(), used.end(), false) != used.end();

    out.met = positive;
    out.missed = hits.empty();
    if (failure) out.wrong = 1;
    else if (undecided) out.undecided = 1, failure = "undecided";
    else if (refuted) out.refuted = 1;
    else if (stepped_over) out.stepped_over = 1;
    if (talkative || (failure && failures[failure]++ < 5)) {
        std::printf("%s, %s: %s, near t = %.17g\n    ", failure ? "FAIL" : "note",
                    first_only ? "first hit" : "all roots",
                    failure            ? failure
                    : out.stepped_over ? "stepped over"
                    : out.refuted      ? "refuted"
                                       : "agreed",
                    where);
        print_case(s, r);
        std::printf("\n");
        int shown = 0;
        for (const sgt_hit &h : hits)
            if (talkative || shown++ < 8) print_entry(h, r);
        shown = 0;
        for (const change &c : seen)
            if (talkative || shown++ < 8)
                std::printf("    by steps of %g: t %.17g (%a), %s\n", step, c.t, c.t,
                            c.rises ? "rising" : "falling");
    }
    return out;
}

} // namespace

int main(int argc, char **argv)
{
    std::uint64_t seed = 20240317;
    double scale = 0.5;
    bool full = false;
    int width = 160, height = 120, only = -1;
    const char *replay = nullptr;
    if (const char *e = std::getenv("SAGITTA_TEST_SEED")) seed = std::strtoull(e, nullptr, 0);
    if (const char *e = std::getenv("SAGITTA_TEST_SCALE")) scale = std::atof(e);
    for (int i = 1; i < argc; i++) {
        const bool more = i + 1 < argc;
        if (!std::strcmp(argv[i], "--full")) full = true;
        else if (more && !std::strcmp(argv[i], "--rays"))
            full = std::sscanf(argv[++i], "%dx%d", &width, &height) == 2 && width > 0 && height > 0;
        else if (more && !std::strcmp(argv[i], "--set")) only = std::atoi(argv[++i]);
        else if (more && !std::strcmp(argv[i], "--seed")) seed = std::strtoull(argv[++i], nullptr, 0);
        else if (more && !std::strcmp(argv[i], "--replay")) replay = argv[++i];
        else {
            std::fprintf(stderr,
                         "test_brute [--full] [--rays WxH] [--set I] [--seed S] [--replay \"...\"]\n");
            return 2;
        }
    }
    if (replay) {
        level_set s;
        ray r;
        if (!read_case(replay, &s, &r)) return 2;
        talkative = true;
        const row first = compare(s, r, 2e-6, true), all = compare(s, r, 2e-6, false);
        return first.wrong + first.undecided + all.wrong + all.undecided != 0;
    }
    std::printf("seed %" PRIu64 ", %s\n", seed, full ? "every ray" : "a few rays of each configuration");

    const auto began = std::chrono::steady_clock::now();
    const auto seconds = [&] {
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
    };
    std::map<std::string, row> parts[2];
    std::vector<row> sets[2];
    row total[2] = {};
    std::string left_out;
    long of_poles = 0;
    for (int index = 0; index < number_of_families; index++) {
        row here[2] = {};
        for (int slice = 0; slice < number_of_slices; slice++) {
            if (only >= 0 && index != only) continue;
            const scene view = make_scene(index, slice, seed);
            for (int which = 0; which < 3; which++)
                for (int eye = 0; eye < number_of_eyes; eye++) {
                    if (slice == skew && which != 1) continue;
                    const int n = iterations_of(families[index].power, which);
                    const std::string iterations = "N = " + std::to_string(n);
                    generator g(seed ^
                                static_cast<std::uint64_t>(((index * 8 + slice) * 8 + which) * 8 + eye + 1)
                                    << 32);
                    configuration c;
                    if (!make_configuration(view, n, slice, eye, g, &c)) {
                        left_out += "    " + std::string(families[index].name) + ", " + slice_names[slice] +
                                    ", " + iterations + ", " + eye_names[eye] + "\n";
                        continue;
                    }
                    for (int all = 0; all < 2; all++) {
                        const int w = all ? std::max(1, width * 3 / 8) : width,
                                  h = all ? std::max(1, height * 3 / 8) : height;
                        const int count = full ? w * h
                                               : std::max(1, static_cast<int>((all ? 6 : 20) * scale));
                        row rays = {};
                        for (int k = 0; k < count; k++) {
                            const int pixel = full ? k : g.below(w * h);
                            const double step = g.chance(0.01) ? 2e-6 : 2e-5;
                            rays.add(compare(c.set, ray_of(c, pixel % w, pixel / w, w, h), step, !all));
                        }
                        for (int k = 0; k < 2 && all && which == 0; k++)
                            of_poles += poles(c.set, ray_of(c, g.below(w), g.below(h), w, h));
                        here[all].add(rays);
                        total[all].add(rays);
                        parts[all][families[index].power == 2 ? iterations : "power above 2"].add(rays);
                        parts[all][slice_names[slice]].add(rays);
                        parts[all][eye_names[eye]].add(rays);
                    }
                }
        }
        sets[0].push_back(here[0]), sets[1].push_back(here[1]);
        if (only >= 0 && index != only) continue;
        std::printf("%d %s: %.0f s\n", index, families[index].name, seconds());
        std::fflush(stdout);
    }

    for (int all = 0; all < 2; all++) {
        print_head(all ? "all roots" : "first hits");
        for (int index = 0; index < number_of_families; index++)
            if (only < 0 || index == only)
                print_row(families[index].name, sets[all][static_cast<std::size_t>(index)]);
        for (const auto &part : parts[all]) print_row(part.first.c_str(), part.second);
        print_row("total", total[all]);
    }
    for (const row &r : total) {
        if (double(r.refuted) > 1 + 1e-4 * double(r.rays)) failures["the brute force is refuted too often"]++;
        if (double(r.stepped_over) > 3 + 1e-2 * double(r.rays))
            failures["the brute force steps over roots too often"]++;
    }
    std::printf("\n1 / F: %ld poles, each asked in eight ways\n", of_poles);
    if (!left_out.empty()) std::printf("\nleft out, no such eye found in the slice:\n%s", left_out.c_str());
    std::printf("\n");
    for (const auto &f : failures) std::printf("FAIL %8ld  %s\n", f.second, f.first.c_str());
    std::printf("%.1f s, %s\n", seconds(), failures.empty() ? "no failure" : "failed");
    return !failures.empty();
}
