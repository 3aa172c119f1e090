// SPDX-License-Identifier: MIT
// First hits on four implicit surfaces by cells in lanes, proven, in a picture of 640 x 480 rays.
//
//     build/tests/bench/bench_cells [--quick] [--only TEXT]
//
// Each surface is a user's, cut by a ball of 1.6, and written once as a template: of doubles for the value
// and the gradient, of intervals of interval.h for `enclose`, of eight intervals side by side for
// `encloses`.  The latter are widened outward by 2^-52 of themselves and 2^-1000, one rounding of which is
// 2^-53; sine and cosine by 2^-49.
//
// Four ways take turns, slices of the picture, by the time of the processor that this thread has had:
//
//     formula   sgt_intersect_batch, SGT_PROVE_FIRST, of the surface read from its text (formula.h)
//     cells     the same of the compiled surface, with `encloses`
//     single    sgt_intersect, ray by ray, with `encloses`, on a fortieth of each slice
//     one       the same with `enclose` only
//
// Told are medians of ns a ray, the evaluations a ray, the cells a ray that `encloses` was asked for, how
// many rays are undecided, and how many statuses or roots differ by more than both errors.
#include "bench_clock.h"
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <string>
#include <vector>
#include <time.h>
#include <sagitta/formula.h>
#include <sagitta/interval.h>
#include <sagitta/sagitta.h>

#if defined(HAVE_CLONES)
#define CLONES __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define CLONES
#endif
#define HERE static inline __attribute__((always_inline))

namespace
{

constexpr double BALL = 1.6;
constexpr int WIDTH = 640, HEIGHT = 480, LANES = 8;

// ------------------------------------------------------------- numbers: lanes of doubles, with a gradient

typedef double lanes __attribute__((vector_size(8 * LANES)));
typedef long long bits __attribute__((vector_size(8 * LANES)));

HERE lanes all(double x) { return lanes{} + x; }
HERE lanes least(lanes a, lanes b) { return a < b ? a : b; }
HERE lanes most(lanes a, lanes b) { return a > b ? a : b; }
HERE lanes size(lanes a) { return (lanes)((bits)a & 0x7fffffffffffffff); }
HERE lanes whole(lanes a) { return (a + 0x1.8p52) - 0x1.8p52; }
HERE lanes up(lanes a)
{
    lanes w = whole(a);
    return w < a ? w + 1 : w;
}

// Sine and cosine, within 2^-50 for |x| < 2^20: x less quarters of a turn, in three parts, then Taylor.
HERE void turn(lanes x, lanes *s, lanes *c)
{
    lanes k = whole(x * 0x1.45f306dc9c883p-1);
    lanes r = ((x - k * 0x1.921fb54p0) - k * 0x1.10b4611p-30) - k * 0x1.4c4c6628b80dcp-59;
    lanes q = r * r;
    lanes sine =
        r + r * q *
                (-1 / 6. +
                 q * (1 / 120. +
                      q * (-1 / 5040. +
                           q * (1 / 362880. +
                                q * (-1 / 39916800. + q * (1 / 6227020800. + q * (-1 / 1307674368000. +
                                                                                  q / 355687428096000.)))))));
    lanes cosine =
        1 - q * (0.5 - q * (1 / 24. -
                            q * (1 / 720. -
                                 q * (1 / 40320. - q * (1 / 3628800. -
                                                        q * (1 / 479001600. - q * (1 / 87178291200. -
                                                                                   q / 20922789888000.)))))));
    bits n = __builtin_convertvector(k, bits);
    lanes a = (n & 1) != 0 ? cosine : sine, b = (n & 1) != 0 ? sine : cosine;
    *s = (n & 2) != 0 ? -a : a;
    *c = ((n + 1) & 2) != 0 ? -b : b;
}

template <class R> struct Dual {
    R v, x, y, z;
};
template <class R> HERE Dual<R> operator+(Dual<R> a, Dual<R> b)
{
    return {a.v + b.v, a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class R> HERE Dual<R> operator-(Dual<R> a, Dual<R> b)
{
    return {a.v - b.v, a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class R> HERE Dual<R> operator*(Dual<R> a, Dual<R> b)
{
    return {a.v * b.v, a.v * b.x + a.x * b.v, a.v * b.y + a.y * b.v, a.v * b.z + a.z * b.v};
}
template <class R> HERE Dual<R> operator*(double k, Dual<R> a)
{
    return {k * a.v, k * a.x, k * a.y, k * a.z};
}
template <class R> HERE Dual<R> operator+(Dual<R> a, double k)
{
    a.v += k;
    return a;
}
template <class R> HERE Dual<R> square(Dual<R> a)
{
    R t = 2 * a.v;
    return {a.v * a.v, t * a.x, t * a.y, t * a.z};
}
template <class R> HERE Dual<R> cube(Dual<R> a)
{
    R q = a.v * a.v, t = 3 * q;
    return {q * a.v, t * a.x, t * a.y, t * a.z};
}
template <class R> HERE void wave(Dual<R> a, Dual<R> *sine, Dual<R> *cosine)
{
    lanes s, c;
    turn(lanes{} + a.v, &s, &c);
    R p, q;
    if constexpr (sizeof(R) == sizeof(lanes))
        p = s, q = c;
    else
        p = s[0], q = c[0];
    *sine = {p, q * a.x, q * a.y, q * a.z};
    *cosine = {q, -p * a.x, -p * a.y, -p * a.z};
}

// ------------------------------------------------------- intervals, one and in lanes, each with a slope

struct One {
    sgt_interval v, s;
};
HERE One operator+(One a, One b) { return {sgt_interval_sum(a.v, b.v), sgt_interval_sum(a.s, b.s)}; }
HERE One operator-(One a, One b)
{
    return {sgt_interval_difference(a.v, b.v), sgt_interval_difference(a.s, b.s)};
}
HERE One operator*(One a, One b)
{
    return {sgt_interval_product(a.v, b.v),
            sgt_interval_sum(sgt_interval_product(a.v, b.s), sgt_interval_product(a.s, b.v))};
}
HERE One operator*(double k, One a) { return {sgt_interval_scaled(a.v, k), sgt_interval_scaled(a.s, k)}; }
HERE One operator+(One a, double k)
{
    a.v = sgt_interval_sum(a.v, sgt_interval_of(k));
    return a;
}
HERE One square(One a)
{
    return {sgt_interval_square(a.v), sgt_interval_scaled(sgt_interval_product(a.v, a.s), 2)};
}
HERE One cube(One a)
{
    sgt_interval q = sgt_interval_square(a.v);
    return {sgt_interval_product(q, a.v), sgt_interval_scaled(sgt_interval_product(q, a.s), 3)};
}
HERE void wave(One a, One *sine, One *cosine)
{
    sgt_interval s = sgt_interval_sine(a.v), c = sgt_interval_cosine(a.v);
    *sine = {s, sgt_interval_product(c, a.s)};
    *cosine = {c, sgt_interval_negative(sgt_interval_product(s, a.s))};
}

struct Range {
    lanes lo, hi;
};
HERE Range out(lanes lo, lanes hi)
{
    return {lo - (size(lo) * 0x1p-52 + 0x1p-1000), hi + (size(hi) * 0x1p-52 + 0x1p-1000)};
}
HERE Range operator+(Range a, Range b) { return out(a.lo + b.lo, a.hi + b.hi); }
HERE Range operator-(Range a, Range b) { return out(a.lo - b.hi, a.hi - b.lo); }
HERE Range operator*(Range a, Range b)
{
    lanes p = a.lo * b.lo, q = a.lo * b.hi, r = a.hi * b.lo, s = a.hi * b.hi;
    return out(least(least(p, q), least(r, s)), most(most(p, q), most(r, s)));
}
HERE Range operator*(double k, Range a)
{
    lanes p = k * a.lo, q = k * a.hi;
    return k < 0 ? out(q, p) : out(p, q);
}
HERE Range square(Range a)
{
    lanes p = a.lo * a.lo, q = a.hi * a.hi, zero = {};
    Range r = out(((a.lo < 0) & (a.hi > 0)) ? zero : least(p, q), most(p, q));
    r.lo = most(r.lo, zero);
    return r;
}
// The least and the greatest of the wave with a crest at `crest`, whose ends are a and b.
HERE Range arc(Range x, lanes a, lanes b, double crest)
{
    constexpr double turns = 0x1.45f306dc9c883p-3, full = 0x1.921fb54442d18p2, near = 0x1p-40;
    lanes lo = least(a, b) - 0x1p-49, hi = most(a, b) + 0x1p-49;
    hi = up((x.lo - crest) * turns - near) * full + crest <= x.hi + near ? all(1) : hi;
    lo = up((x.lo - crest) * turns + 0.5 - near) * full + (crest - full / 2) <= x.hi + near ? all(-1) : lo;
    return {most(lo, all(-1)), least(hi, all(1))};
}

struct Many {
    Range v, s;
};
HERE Many operator+(Many a, Many b) { return {a.v + b.v, a.s + b.s}; }
HERE Many operator-(Many a, Many b) { return {a.v - b.v, a.s - b.s}; }
HERE Many operator*(Many a, Many b) { return {a.v * b.v, a.v * b.s + a.s * b.v}; }
HERE Many operator*(double k, Many a) { return {k * a.v, k * a.s}; }
HERE Many operator+(Many a, double k)
{
    a.v = out(a.v.lo + k, a.v.hi + k);
    return a;
}
HERE Many square(Many a) { return {square(a.v), 2 * (a.v * a.s)}; }
HERE Many cube(Many a)
{
    Range q = square(a.v);
    return {q * a.v, 3 * (q * a.s)};
}
HERE void wave(Many a, Many *sine, Many *cosine)
{
    lanes p, q, r, s;
    turn(a.v.lo, &p, &q);
    turn(a.v.hi, &r, &s);
    Range sines = arc(a.v, p, r, 0x1.921fb54442d18p0), cosines = arc(a.v, q, s, 0);
    *sine = {sines, cosines * a.s};
    *cosine = {cosines, -1 * (sines * a.s)};
}

// ----------------------------------------------------------------------------- the surfaces

struct Barth {
    template <class N> HERE N f(N x, N y, N z)
    {
        const double p2 = 2.618033988749895, k = 4.23606797749979;
        N X = square(x), Y = square(y), Z = square(z);
        return 4 * ((p2 * X - Y) * (p2 * Y - Z) * (p2 * Z - X)) - k * square(X + Y + Z + -1.0);
    }
};
struct Clebsch {
    template <class N> HERE N f(N x, N y, N z)
    {
        N X = square(x), Y = square(y), Z = square(z), s = x + y + z;
        return 81 * (cube(x) + cube(y) + cube(z)) - 189 * (X * (y + z) + Y * (x + z) + Z * (x + y)) +
               54 * (x * y * z) + 126 * (x * y + x * z + y * z) - 9 * (X + Y + Z) - 9 * s + 1.0;
    }
};
struct Chmutov {
    template <class N> HERE N t8(N x)
    {
        N a = 2 * square(x) + -1.0;
        a = 2 * square(a) + -1.0;
        return 2 * square(a) + -1.0;
    }
    template <class N> HERE N f(N x, N y, N z) { return t8(x) + t8(y) + t8(z) + 1.0; }
};
struct Gyroid {
    template <class N> HERE N f(N x, N y, N z)
    {
        N a, b, c, d, e, g;
        wave(6 * x, &a, &b);
        wave(6 * y, &c, &d);
        wave(6 * z, &e, &g);
        return a * d + c * g + e * b;
    }
};

template <class S> double value(const void *, sgt_vec3 p, sgt_vec3 *grad)
{
    typedef Dual<double> N;
    N f = S::template f<N>(N{p.x, 1, 0, 0}, N{p.y, 0, 1, 0}, N{p.z, 0, 0, 1});
    if (grad) *grad = {f.x, f.y, f.z};
    return f.v;
}

HERE lanes from(const double *a, size_t n)
{
    lanes x = all(a[0]);
    std::memcpy(&x, a, n * sizeof *a);
    return x;
}
HERE void to(double *a, size_t n, lanes x) { std::memcpy(a, &x, n * sizeof *a); }

template <class S> HERE void values_of(size_t n, sgt_points p, sgt_values out)
{
    for (size_t i = 0; i < n; i += LANES) {
        size_t m = n - i < LANES ? n - i : LANES;
        typedef Dual<lanes> N;
        lanes no = {}, one = all(1);
        N f = S::template f<N>(N{from(p.p[0] + i, m), one, no, no}, N{from(p.p[1] + i, m), no, one, no},
                               N{from(p.p[2] + i, m), no, no, one});
        to(out.f + i, m, f.v);
        if (out.grad[0])
            to(out.grad[0] + i, m, f.x), to(out.grad[1] + i, m, f.y), to(out.grad[2] + i, m, f.z);
    }
}

HERE Many line(lanes o, lanes d, lanes t_lo, lanes t_hi)
{
    Range a = Range{o, o} + Range{d, d} * Range{t_lo, t_hi};
    return {a, {d, d}};
}

long asked; // cells

template <class S>
HERE void encloses_of(size_t n, sgt_rays r, const double *t_lo, const double *t_hi, sgt_enclosures e)
{
    asked += static_cast<long>(n);
    for (size_t i = 0; i < n; i += LANES) {
        size_t m = n - i < LANES ? n - i : LANES;
        lanes a = from(t_lo + i, m), b = from(t_hi + i, m);
        Many f = S::template f<Many>(line(from(r.o[0] + i, m), from(r.d[0] + i, m), a, b),
                                     line(from(r.o[1] + i, m), from(r.d[1] + i, m), a, b),
                                     line(from(r.o[2] + i, m), from(r.d[2] + i, m), a, b));
        to(e.lo + i, m, f.v.lo), to(e.hi + i, m, f.v.hi);
        if (e.slope_lo) to(e.slope_lo + i, m, f.s.lo), to(e.slope_hi + i, m, f.s.hi);
    }
}

// Clones are made of functions that are no templates.
#define SURFACE(S)                                                                                   \
    CLONES void values_##S(const void *, size_t n, sgt_points p, sgt_values out)                     \
    {                                                                                                \
        values_of<S>(n, p, out);                                                                     \
    }                                                                                                \
    CLONES void encloses_##S(const void *, size_t n, sgt_rays r, const double *lo, const double *hi, \
                             sgt_enclosures e)                                                       \
    {                                                                                                \
        encloses_of<S>(n, r, lo, hi, e);                                                             \
    }
SURFACE(Barth)
SURFACE(Clebsch)
SURFACE(Chmutov)
SURFACE(Gyroid)

template <class S> sgt_interval enclose(const void *, const sgt_ray *r, sgt_interval t, sgt_interval *slope)
{
    auto along = [&](double o, double d) {
        return One{sgt_interval_sum(sgt_interval_of(o), sgt_interval_scaled(t, d)), sgt_interval_of(d)};
    };
    One f = S::template f<One>(along(r->o.x, r->d.x), along(r->o.y, r->d.y), along(r->o.z, r->d.z));
    *slope = f.s;
    return f.v;
}

sgt_span span(const void *, const sgt_ray *r)
{
    double b = r->o.x * r->d.x + r->o.y * r->d.y + r->o.z * r->d.z,
           a = r->d.x * r->d.x + r->d.y * r->d.y + r->d.z * r->d.z,
           c = r->o.x * r->o.x + r->o.y * r->o.y + r->o.z * r->o.z - BALL * BALL, h = b * b - a * c;
    if (h < 0) return {1, -1, NAN, false};
    h = std::sqrt(h);
    return {(-b - h) / a, (-b + h) / a, NAN, false};
}

void spans(const void *, size_t n, sgt_rays r, sgt_spans out)
{
    for (size_t i = 0; i < n; i++) {
        double ox = r.o[0][i], oy = r.o[1][i], oz = r.o[2][i], dx = r.d[0][i], dy = r.d[1][i], dz = r.d[2][i];
        double b = ox * dx + oy * dy + oz * dz, a = dx * dx + dy * dy + dz * dz,
               c = ox * ox + oy * oy + oz * oz - BALL * BALL, h = b * b - a * c, q = std::sqrt(h < 0 ? 0 : h);
        out.lo[i] = h < 0 ? 1 : (-b - q) / a, out.hi[i] = h < 0 ? -1 : (-b + q) / a;
        out.seed[i] = NAN, out.single[i] = false;
    }
}

// ---------------------------------------------------------------------------------- the picture

using bench::now;

double median(std::vector<double> a)
{
    std::sort(a.begin(), a.end());
    return a.empty() ? NAN : a[a.size() / 2];
}

struct Picture {
    std::vector<double> o[3], d[3];
    size_t count() const { return o[0].size(); }
    sgt_rays from(size_t i) const
    {
        return {{&o[0][i], &o[1][i], &o[2][i]}, {&d[0][i], &d[1][i], &d[2][i]}, nullptr, nullptr};
    }
};

Picture picture()
{
    const double at[3] = {1.2, 0.9, -3.2}, look[3] = {-0.47536594, -0.35652446, 1.26764251},
                 right[3] = {1.24843890, 0, 0.46816459}, above[3] = {-0.08941721, 0.96703057, 0.23844589};
    Picture p;
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        double u = (i % WIDTH + 0.5) / WIDTH - 0.5, v = (HEIGHT - 1 - i / WIDTH + 0.5) / HEIGHT - 0.5, q[3],
               l = 0;
        for (int k = 0; k < 3; k++) q[k] = look[k] + u * right[k] + v * above[k], l += q[k] * q[k];
        for (int k = 0; k < 3; k++) p.o[k].push_back(at[k]), p.d[k].push_back(q[k] / std::sqrt(l));
    }
    return p;
}

struct Answers {
    std::vector<sgt_status> status;
    std::vector<int> evals;
    std::vector<double> t, t_err, t_lo, p[3], n[3], p_err;
    explicit Answers(size_t m) : status(m), evals(m), t(m), t_err(m), t_lo(m), p_err(m)
    {
        for (int k = 0; k < 3; k++) p[k].resize(m), n[k].resize(m);
    }
    sgt_hits from(size_t i)
    {
        return {&status[i],
                &evals[i],
                &t[i],
                &t_err[i],
                &t_lo[i],
                {&p[0][i], &p[1][i], &p[2][i]},
                {&n[0][i], &n[1][i], &n[2][i]},
                &p_err[i],
                {}};
    }
};

// Are both decided, and not the same?
bool differ(const Answers &a, const Answers &b, size_t r)
{
    if (a.status[r] < 0 || b.status[r] < 0) return false;
    double far = std::fabs((a.t[r] - b.t[r]) + (a.t_lo[r] - b.t_lo[r]));
    return a.status[r] != b.status[r] || far > a.t_err[r] + b.t_err[r];
}

struct Subject {
    const char *name, *text;
    sgt_surface_ops ops;
};

// A formula in a room of its own.
struct Text {
    std::vector<double> room;
    sgt_formula formula = {};
    explicit Text(const char *text)
    {
        room.resize(sgt_formula_room(text, 0) / sizeof(double) + 1);
        sgt_error error;
        formula.ball = BALL;
        formula.tape = sgt_formula_read(text, SGT_FORMULA_XYZ, 0, nullptr, room.data(),
                                        room.size() * sizeof(double), &error);
        if (!formula.tape) std::printf("%s: column %zu: %s\n", text, error.column, error.words);
    }
};

template <class S>
Subject subject(const char *name, const char *text, decltype(sgt_surface_ops::values) values,
                decltype(sgt_surface_ops::encloses) encloses)
{
    sgt_surface_ops ops = {};
    ops.size = sizeof ops;
    ops.name = name, ops.value = value<S>, ops.span = span, ops.enclose = enclose<S>, ops.values = values;
    ops.spans = spans, ops.encloses = encloses;
    return {name, text, ops};
}

} // namespace

int main(int argc, char **argv)
{
    bool quick = false;
    std::string only;
    for (int i = 1; i < argc; i++) {
        if (!std::strcmp(argv[i], "--quick"))
            quick = true;
        else if (!std::strcmp(argv[i], "--only") && i + 1 < argc)
            only = argv[++i];
        else
            return std::fprintf(stderr, "bench_cells [--quick] [--only TEXT]\n"), 2;
    }
    const Subject subjects[] = {
        subject<Barth>(
            "Barth sextic",
            "4*(2.618033988749895*x^2 - y^2)*(2.618033988749895*y^2 - z^2)*(2.618033988749895*z^2 - x^2)"
            " - 4.23606797749979*(x^2 + y^2 + z^2 - 1)^2",
            values_Barth, encloses_Barth),
        subject<Clebsch>("Clebsch",
                         "81*(x^3 + y^3 + z^3) - 189*(x^2*(y + z) + y^2*(x + z) + z^2*(x + y)) + 54*x*y*z"
                         " + 126*(x*y + x*z + y*z) - 9*(x^2 + y^2 + z^2) - 9*(x + y + z) + 1",
                         values_Clebsch, encloses_Clebsch),
        subject<Chmutov>("Chmutov 8",
                         "2*(2*(2*x^2-1)^2-1)^2 + 2*(2*(2*y^2-1)^2-1)^2 + 2*(2*(2*z^2-1)^2-1)^2 - 2",
                         values_Chmutov, encloses_Chmutov),
        subject<Gyroid>("gyroid", "sin(6*x)*cos(6*y) + sin(6*y)*cos(6*z) + sin(6*z)*cos(6*x)", values_Gyroid,
                        encloses_Gyroid)};
    const Picture rays = picture();
    const size_t slice = 5 * WIDTH, sparse = 40;
    const int turns = quick ? 1 : 5;
    sgt_options opt = {};
    opt.proof = SGT_PROVE_FIRST;
    std::printf("%-14s %9s %9s %9s %9s %7s | %6s %6s %6s | %6s %6s %6s\n", "ns a ray", "formula", "cells",
                "single", "one", "ratio", "evals", "cells", "one", "hit", "open", "unlike");
    for (const Subject &s : subjects) {
        if (!only.empty() && std::string(s.name).find(only) == std::string::npos) continue;
        sgt_surface_ops by_one = s.ops;
        by_one.encloses = nullptr;
        Answers in_lanes(rays.count()), alone(rays.count()), from_text(rays.count());
        const Text text(s.text);
        if (!text.formula.tape) return 1;
        std::vector<double> text_ns, lanes_ns, single_ns, one_ns;
        long hits = 0, open = 0, unlike = 0, evals = 0, one_evals = 0, compared = 0, kept = 0;
        long in_batches = 0;
        for (int turn = 0; turn < turns; turn++) {
            double spent = 0, spent_text = 0, spent_single = 0, spent_one = 0;
            size_t ones = 0;
            in_batches = 0;
            for (size_t i = 0, k = 0; i < rays.count(); i += slice, k++) {
                asked = 0;
                double start = now();
                sgt_intersect_batch({&s.ops, nullptr}, slice, rays.from(i), in_lanes.from(i), &opt);
                spent += now() - start;
                in_batches += asked;
                start = now();
                sgt_intersect_batch({&sgt_formula_ops, &text.formula}, slice, rays.from(i), from_text.from(i),
                                    &opt);
                spent_text += now() - start;
                for (size_t r = i; turn == 0 && r < i + slice; r++) unlike += differ(in_lanes, from_text, r);
                size_t few = slice / sparse, at = i + (k % sparse) * few;
                sgt_rays some = rays.from(at);
                start = now();
                for (size_t r = 0; r < few; r++) {
                    sgt_ray ray = {{some.o[0][r], some.o[1][r], some.o[2][r]},
                                   {some.d[0][r], some.d[1][r], some.d[2][r]},
                                   0,
                                   0};
                    kept += sgt_intersect({&s.ops, nullptr}, ray, &opt).evals;
                }
                spent_single += now() - start;
                start = now();
                sgt_intersect_batch({&by_one, nullptr}, few, rays.from(at), alone.from(at), &opt);
                spent_one += now() - start;
                ones += few;
                for (size_t r = at; turn == 0 && r < at + few; r++) {
                    compared++, one_evals += alone.evals[r];
                    unlike += differ(in_lanes, alone, r);
                }
            }
            text_ns.push_back(spent_text / static_cast<double>(rays.count()));
            lanes_ns.push_back(spent / static_cast<double>(rays.count()));
            single_ns.push_back(spent_single / static_cast<double>(ones));
            one_ns.push_back(spent_one / static_cast<double>(ones));
        }
        for (size_t i = 0; i < rays.count(); i++)
            hits += in_lanes.status[i] > 0, open += (in_lanes.status[i] < 0) + (from_text.status[i] < 0),
                evals += in_lanes.evals[i];
        double all_rays = static_cast<double>(rays.count()), ns = median(lanes_ns), one = median(one_ns);
        if (kept == 0) std::printf("nothing was evaluated\n");
        std::printf("%-14s %9.0f %9.0f %9.0f %9.0f %7.1f | %6.1f %6.1f %6.1f | %6.3f %6ld %6ld\n", s.name,
                    median(text_ns), ns,
                    median(single_ns), one, one / ns, static_cast<double>(evals) / all_rays,
                    static_cast<double>(in_batches) / all_rays,
                    static_cast<double>(one_evals) / static_cast<double>(compared),
                    static_cast<double>(hits) / all_rays, open, unlike);
        std::fflush(stdout);
    }
}
