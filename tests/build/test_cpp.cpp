// SPDX-License-Identifier: MIT
// sagitta.hpp is the functions of C and nothing else.  Lambdas give, bit by bit, the answers of the same
// surface written in C.  Every operation arrives with its arguments.  Views of unequal length change nothing.
// Not one byte is allocated.  Compiled without exceptions and without run-time types.
#include <sagitta/sagitta.hpp>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <new>
#include <vector>

static std::size_t allocations;
void *operator new(std::size_t size)
{
    allocations++;
    void *block = std::malloc(size);
    if (!block) std::abort();
    return block;
}
void operator delete(void *block) noexcept { std::free(block); }
void operator delete(void *block, std::size_t) noexcept { std::free(block); }

static int faults;
#define EXPECT(what) \
    do { \
        if (!(what)) faults++, std::printf("%s:%d: %s\n", __FILE__, __LINE__, #what); \
    } while (0)

// Equal bits; a NaN is equal to any NaN.
static bool same(double a, double b) { return std::memcmp(&a, &b, sizeof a) == 0 || (a != a && b != b); }
static bool same(sgt_vec3 a, sgt_vec3 b) { return same(a.x, b.x) && same(a.y, b.y) && same(a.z, b.z); }
static bool same(sgt_interval a, sgt_interval b) { return same(a.lo, b.lo) && same(a.hi, b.hi); }
static bool same(const sgt_hit &a, const sgt_hit &b)
{
    return a.status == b.status && a.evals == b.evals && same(a.t, b.t) && same(a.t_err, b.t_err) &&
           same(a.t_lo, b.t_lo) && same(a.lo, b.lo) && same(a.hi, b.hi) && same(a.f, b.f) && same(a.p, b.p) &&
           same(a.n, b.n) && same(a.p_err, b.p_err);
}

static std::uint64_t state;
static double random_number()  // splitmix64, in [-1, 1)
{
    std::uint64_t z = state += 0x9e3779b97f4a7c15u;
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
    z = (z ^ z >> 27) * 0x94d049bb133111ebu;
    return static_cast<double>((z ^ z >> 31) >> 11) * 0x1p-52 - 1;
}

// An ellipsoid in C: the half axis along z is in `self`.
struct shape { double c; };
static double f_of(double c, sgt_vec3 p) { return p.x * p.x + p.y * p.y + p.z * p.z / (c * c) - 1; }
static sgt_vec3 gradient_of(double c, sgt_vec3 p) { return {2 * p.x, 2 * p.y, 2 * p.z / (c * c)}; }
static sgt_span span_of(double c, const sgt_ray &ray)
{
    double far = (c + 2) / std::sqrt(ray.d.x * ray.d.x + ray.d.y * ray.d.y + ray.d.z * ray.d.z);
    double a = ray.d.x * ray.d.x + ray.d.y * ray.d.y + ray.d.z * ray.d.z;
    double t = -(ray.o.x * ray.d.x + ray.o.y * ray.d.y + ray.o.z * ray.d.z) / a;
    return {t - far, t + far, t - far / 2, false};
}
static sgt_interval enclose_of(double c, const sgt_ray &ray, sgt_interval t, sgt_interval *slope)
{
    sgt_interval x = sgt_interval_sum(sgt_interval_of(ray.o.x), sgt_interval_scaled(t, ray.d.x));
    sgt_interval y = sgt_interval_sum(sgt_interval_of(ray.o.y), sgt_interval_scaled(t, ray.d.y));
    sgt_interval z = sgt_interval_sum(sgt_interval_of(ray.o.z), sgt_interval_scaled(t, ray.d.z));
    sgt_interval c2 = sgt_interval_square(sgt_interval_of(c)), two = sgt_interval_of(2);
    sgt_interval zz = sgt_interval_quotient(z, c2);
    *slope = sgt_interval_product(
        two, sgt_interval_sum(sgt_interval_sum(sgt_interval_product(x, sgt_interval_of(ray.d.x)),
                                               sgt_interval_product(y, sgt_interval_of(ray.d.y))),
                              sgt_interval_product(zz, sgt_interval_of(ray.d.z))));
    return sgt_interval_difference(
        sgt_interval_sum(sgt_interval_sum(sgt_interval_square(x), sgt_interval_square(y)),
                         sgt_interval_quotient(sgt_interval_square(z), c2)),
        sgt_interval_of(1));
}

extern "C" {
static double c_value(const void *self, sgt_vec3 p, sgt_vec3 *grad)
{
    double c = static_cast<const shape *>(self)->c;
    if (grad) *grad = gradient_of(c, p);
    return f_of(c, p);
}
static sgt_span c_span(const void *self, const sgt_ray *ray)
{
    return span_of(static_cast<const shape *>(self)->c, *ray);
}
static sgt_interval c_enclose(const void *self, const sgt_ray *ray, sgt_interval t, sgt_interval *slope)
{
    return enclose_of(static_cast<const shape *>(self)->c, *ray, t, slope);
}
static void c_values(const void *self, size_t n, sgt_points p, sgt_values out)
{
    for (size_t i = 0; i < n; i++) {
        sgt_vec3 grad;
        out.f[i] = c_value(self, {p.p[0][i], p.p[1][i], p.p[2][i]}, &grad);
        if (out.grad[0]) out.grad[0][i] = grad.x, out.grad[1][i] = grad.y, out.grad[2][i] = grad.z;
    }
}
}

// ---------------------------------------------------------------- what is accepted

using doubles = std::vector<double>;
using const_view = sagitta::view<const double>;
static_assert(std::is_constructible_v<const_view, doubles &>);
static_assert(std::is_constructible_v<const_view, const doubles &>);
static_assert(std::is_constructible_v<const_view, sagitta::view<double>>);
static_assert(std::is_constructible_v<sagitta::view<double>, std::array<double, 3> &>);
static_assert(std::is_constructible_v<sagitta::view<double>, double (&)[3]>);
static_assert(!std::is_constructible_v<sagitta::view<double>, const doubles &>, "const is kept");
static_assert(!std::is_constructible_v<sagitta::view<double>, const_view>, "const is kept");
static_assert(!std::is_constructible_v<sagitta::view<double>, std::vector<float> &>);

static double plane(sgt_vec3 p) { return p.z; }
using plane_surface = decltype(sagitta::surface(plane));
static_assert(std::is_convertible_v<plane_surface &, sgt_surface>);
static_assert(std::is_convertible_v<const plane_surface &, sgt_surface>);
static_assert(!std::is_convertible_v<plane_surface, sgt_surface>, "a temporary surface is not borrowed");
static_assert(std::is_same_v<decltype(sagitta::surface(std::declval<plane_surface &>())), plane_surface>);

// ------------------------------------------------------------------- every operation

static void every_operation()
{
    int calls = 0;  // a lambda that counts, and checks what it is given
    sgt_ray ray = sagitta::ray({1, 2, 3}, {4, 5, 6}, 7, 8);
    sgt_interval slope{0, 0};
    double out_f[1] = {0}, in[1] = {5};
    auto all = sagitta::surface([&](sgt_vec3 p) { return calls++, p.x + 10 * p.y + 100 * p.z; })
                   .gradient([&](sgt_vec3 p) { return calls++, sgt_vec3{p.z, p.y, p.x}; })
                   .span([&](const sgt_ray &r) {
                       return calls++, sgt_span{r.o.x, r.d.z, r.tmax, true};
                   })
                   .rounding([&](sgt_vec3 p) { return calls++, p.x; })
                   .clearance([&](sgt_vec3 p) { return calls++, p.y; })
                   .estimate([&](sgt_vec3 p) { return calls++, p.z; })
                   .enclose([&](const sgt_ray &r, sgt_interval t, sgt_interval &s) {
                       return calls++, s = {r.d.y, t.lo}, sgt_interval{r.tmin, t.hi};
                   })
                   .values([&](std::size_t n, sgt_points p, sgt_values out) {
                       calls++, out.f[n - 1] = p.p[2][n - 1];
                   })
                   .spans([&](std::size_t n, sgt_rays r, sgt_spans out) {
                       calls++, out.lo[n - 1] = r.d[1][n - 1];
                   })
                   .first([&](const sgt_ray &r) { return calls++, sgt_span{r.o.y, r.d.x, 0, false}; })
                   .firsts([&](std::size_t n, sgt_rays r, sgt_spans out) {
                       calls++, out.hi[n - 1] = r.o[0][n - 1];
                   })
                   .second([&](std::size_t n, sgt_points p, double *const out[6]) {
                       calls++, out[5][n - 1] = p.p[0][n - 1];
                   })
                   .parameters([&] { return calls++, std::size_t{3}; })
                   .by_parameter([&](std::size_t j, std::size_t n, sgt_points, sgt_values out) {
                       calls++, out.f[n - 1] = static_cast<double>(j);
                   })
                   .encloses([&](std::size_t n, sgt_rays r, const double *lo, const double *hi,
                                 sgt_enclosures out) {
                       calls++, out.lo[n - 1] = r.d[2][n - 1] + 10 * lo[n - 1] + 100 * hi[n - 1];
                   })
                   .name("all");
    auto copy = all;
    sgt_surface s = copy;
    const sgt_surface_ops &o = *s.ops;
    sgt_vec3 p{1, 2, 3}, grad{0, 0, 0};
    EXPECT(s.self == &copy && std::strcmp(o.name, "all") == 0 && o.size == sizeof o && o.own_ == nullptr);
    EXPECT(o.value(s.self, p, nullptr) == 321 && calls == 1);
    EXPECT(o.value(s.self, p, &grad) == 321 && same(grad, {3, 2, 1}) && calls == 3);
    sgt_span span = o.span(s.self, &ray);
    EXPECT(span.lo == 1 && span.hi == 6 && span.seed == 8 && span.single && calls == 4);
    EXPECT(o.rounding(s.self, p) == 1 && o.clearance(s.self, p) == 2 && o.estimate(s.self, p) == 3);
    EXPECT(calls == 7);
    EXPECT(same(o.enclose(s.self, &ray, {20, 30}, &slope), {7, 30}) && same(slope, {5, 20}) && calls == 8);
    sgt_points points = {{in, in, in}};
    sgt_values values = {out_f, {nullptr, nullptr, nullptr}};
    sgt_rays rays = {{in, in, in}, {in, in, in}, nullptr, nullptr};
    sgt_spans spans = {out_f, out_f, nullptr, nullptr};
    double *second[6] = {nullptr, nullptr, nullptr, nullptr, nullptr, out_f};
    o.values(s.self, 1, points, values);
    EXPECT(out_f[0] == 5 && calls == 9);
    out_f[0] = 0, o.spans(s.self, 1, rays, spans);
    EXPECT(out_f[0] == 5 && calls == 10);
    span = o.first(s.self, &ray);
    EXPECT(span.lo == 2 && span.hi == 4 && calls == 11);
    out_f[0] = 0, o.firsts(s.self, 1, rays, spans);
    EXPECT(out_f[0] == 5 && calls == 12);
    out_f[0] = 0, o.second(s.self, 1, points, second);
    EXPECT(out_f[0] == 5 && calls == 13);
    EXPECT(o.parameters(s.self) == 3 && calls == 14);
    o.by_parameter(s.self, 2, 1, points, values);
    EXPECT(out_f[0] == 2 && calls == 15);
    sgt_enclosures enclosures = {out_f, out_f, nullptr, nullptr};
    const double from[1] = {1}, to[1] = {2};
    o.encloses(s.self, 1, rays, from, to, enclosures);
    EXPECT(out_f[0] == 215 && calls == 16);

    auto bare = sagitta::surface(plane);
    s = bare;
    EXPECT(s.ops->value && !s.ops->span && !s.ops->rounding && !s.ops->clearance && !s.ops->estimate &&
           !s.ops->enclose && !s.ops->values && !s.ops->spans && !s.ops->first && !s.ops->firsts &&
           !s.ops->second && !s.ops->parameters && !s.ops->by_parameter && !s.ops->encloses &&
           !s.ops->name);
    EXPECT(s.ops->value(s.self, p, &grad) == 3 && grad.x != grad.x && grad.y != grad.y && grad.z != grad.z);
}

// ------------------------------------------------------------------ lambdas against C

enum { RAYS = 500, MOST = 8 };
static std::array<double, RAYS> ox, oy, oz, dx, dy, dz, t_c, t_cpp, err_c, err_cpp, n_c[3], n_cpp[3];

static void lambdas_against_c()
{
    shape it{1.5};
    sgt_surface_ops ops = sgt_surface_ops();
    ops.value = c_value, ops.span = c_span, ops.enclose = c_enclose, ops.values = c_values;
    sgt_surface in_c{&ops, &it};
    double c = it.c;
    auto lambda = sagitta::surface([c](sgt_vec3 p) { return f_of(c, p); })
                      .gradient([c](sgt_vec3 p) { return gradient_of(c, p); })
                      .span([c](const sgt_ray &ray) { return span_of(c, ray); })
                      .enclose([c](const sgt_ray &ray, sgt_interval t, sgt_interval &slope) {
                          using sagitta::interval;
                          auto at = [t](double a, double b) {
                              return a + interval(sgt_interval_scaled(t, b));
                          };
                          sgt_vec3 o = ray.o, d = ray.d;
                          interval x = at(o.x, d.x), y = at(o.y, d.y), z = at(o.z, d.z);
                          interval c2 = square(interval(c));
                          slope = 2 * (x * d.x + y * d.y + z / c2 * d.z);
                          return sgt_interval(square(x) + square(y) + square(z) / c2 - 1);
                      })
                      .values([&](std::size_t n, sgt_points p, sgt_values out) { c_values(&it, n, p, out); });
    for (std::size_t i = 0; i < RAYS; i++) {
        ox[i] = random_number(), oy[i] = random_number(), oz[i] = -4;
        dx[i] = 0.2 * random_number(), dy[i] = 0.2 * random_number(), dz[i] = 1;
    }
    std::size_t before = allocations;
    int met = 0;
    for (sgt_proof proof : {SGT_ESTIMATE, SGT_PROVE_ROOT, SGT_PROVE_FIRST}) {
        sgt_options options = sgt_options();
        options.proof = proof;
        for (std::size_t i = 0; i < RAYS; i++) {
            sgt_ray ray = sagitta::ray({ox[i], oy[i], oz[i]}, {dx[i], dy[i], dz[i]});
            sgt_hit a = sgt_intersect(in_c, ray, &options), b = sagitta::intersect(lambda, ray, options);
            EXPECT(same(a, b));
            met += a.status == SGT_HIT;
            sgt_hit all_c[MOST], all_cpp[MOST];
            int count = sgt_intersect_all(in_c, ray, MOST, all_c, &options);
            EXPECT(sagitta::intersect_all(lambda, ray, all_cpp, options) == count && count <= MOST);
            for (int j = 0; j < count; j++) EXPECT(same(all_c[j], all_cpp[j]));
        }
        sgt_rays rays = {
            {ox.data(), oy.data(), oz.data()}, {dx.data(), dy.data(), dz.data()}, nullptr, nullptr};
        sgt_hits hits = sgt_hits();
        hits.t = t_c.data(), hits.t_err = err_c.data();
        for (int j = 0; j < 3; j++) hits.n[j] = n_c[j].data();
        sagitta::hits out;
        out.t = t_cpp, out.t_err = err_cpp, out.n = {n_cpp[0], n_cpp[1], n_cpp[2]};
        EXPECT(sgt_intersect_batch(in_c, RAYS, rays, hits, &options) ==
               sagitta::intersect(lambda, {{ox, oy, oz}, {dx, dy, dz}, {}, {}}, out, options));
        for (std::size_t i = 0; i < RAYS; i++)
            EXPECT(same(t_c[i], t_cpp[i]) && same(err_c[i], err_cpp[i]) && same(n_c[2][i], n_cpp[2][i]));
    }
    EXPECT(met > RAYS && met < 3 * RAYS);
    // Leaving: the same again, from the hits of the batch.
    std::array<double, RAYS> at[3], p_err, t_next;
    std::array<signed char, RAYS> side;
    sagitta::hits met_at, next_at;
    met_at.t = t_c, met_at.p = {at[0], at[1], at[2]}, met_at.n = {n_cpp[0], n_cpp[1], n_cpp[2]};
    met_at.p_err = p_err;
    next_at.t = t_next;
    sagitta::intersect(lambda, {{ox, oy, oz}, {dx, dy, dz}, {}, {}}, met_at);
    sagitta::starts from = {{at[0], at[1], at[2]}, {n_cpp[0], n_cpp[1], n_cpp[2]}, p_err, {dx, dy, dz}, {}};
    std::size_t crossed = sagitta::leave(lambda, from, next_at, side), alone = 0;
    for (std::size_t i = 0; i < RAYS; i++) {
        sgt_start start = {{at[0][i], at[1][i], at[2][i]}, {n_cpp[0][i], n_cpp[1][i], n_cpp[2][i]}, p_err[i],
                           {dx[i], dy[i], dz[i]}, 0, {}};
        sgt_crossing a = sgt_leave(in_c, &start, nullptr), b = sagitta::leave(lambda, start);
        EXPECT(same(a.hit, b.hit) && a.side == b.side && side[i] == b.side && same(t_next[i], b.hit.t));
        alone += b.hit.status > 0;
    }
    EXPECT(crossed == alone);
    sagitta::view<signed char> two(side.data(), 2);
    EXPECT(sagitta::leave(lambda, from, next_at, two) == sagitta::misfit);
    std::array<sgt_ray, 2> some = {sagitta::ray({0, 0, -4}, {0, 0, 1}, 0, 9),
                                   sagitta::ray({0.5, 0, -4}, {0, 0.1, 1}, 0, 9)};
    EXPECT(sagitta::check(lambda, some) == SGT_SOUND);

    // Without a gradient: the same roots, within both errors.
    auto bare = sagitta::surface([c](sgt_vec3 p) { return f_of(c, p); });
    for (std::size_t i = 0; i < RAYS; i++) {
        sgt_ray ray = sagitta::ray({ox[i] / 2, oy[i] / 2, oz[i]}, {0, 0, dz[i]}, 0, 9);
        sgt_hit a = sgt_intersect(in_c, ray, nullptr), b = sagitta::intersect(bare, ray);
        EXPECT(a.status == SGT_HIT && b.status == SGT_HIT && std::fabs(a.t - b.t) <= a.t_err + b.t_err);
    }

    // A watcher sees each evaluation, and may stop.
    int seen = 0;
    auto see = [&seen](const sgt_step &step) { return step.eval == ++seen && seen == 3; };
    sgt_options watched = sgt_options();
    sagitta::watch(watched, see);
    EXPECT(sagitta::intersect(lambda, some[0], watched).status == SGT_STOPPED && seen == 3);
    EXPECT(allocations == before);
}

// ------------------------------------------------------------------------- traces

static void traces()
{
    sgt_conic front = {1 / 50.0, 0, 0}, back = {-1 / 60.0, -0.5, 0};
    sgt_element lens[2] = {};
    lens[0].surface = {&sgt_conic_ops, &front}, lens[0].index = 1.5;
    lens[1].surface = {&sgt_conic_ops, &back}, lens[1].index = 1, lens[1].pose.origin.z = 5;
    double x[2] = {1, 2}, y[2] = {0, 3}, z[2] = {-5, -5}, n[2] = {1, 1}, zero[2] = {0, 0}, opl[2], y_end[2];
    double x_end[2], z_end[2];
    sgt_fate fate[2];
    sagitta::rays launch{{x, y, z}, {zero, zero, n}, {}, {}};
    sagitta::traced out;
    out.opl = opl, out.fate = fate, out.o = {x_end, y_end, z_end};
    EXPECT(sagitta::trace(lens, 1, launch, out) == 2 && fate[0] == SGT_PASSED);
    sgt_ray ray = sagitta::ray({2, 3, -5}, {0, 0, 1}), in_c = ray;
    sgt_fate end = SGT_LOST, end_c = SGT_LOST;
    sgt_passage at[2], at_c[2];
    EXPECT(sagitta::trace(lens, 1, ray, end, at) == 2 && end == SGT_PASSED);
    EXPECT(sgt_trace(2, lens, 1, &in_c, at_c, &end_c, nullptr) == 2);
    EXPECT(same(ray.o, in_c.o) && same(ray.d, in_c.d) && same(at[1].hit, at_c[1].hit));
    EXPECT(same(at[1].opl, opl[1]) && same(ray.o.y, y_end[1]));

    // Lengths that differ: nothing is written.
    opl[0] = -1;
    sagitta::traced short_one = out;
    short_one.opl = {opl, 1};
    EXPECT(sagitta::trace(lens, 1, launch, short_one) == sagitta::misfit && opl[0] == -1);
    EXPECT(sagitta::trace({lens, 1}, 1, ray, end, at) == sagitta::misfit);
    launch.o.y = {y, 1};
    EXPECT(sagitta::trace(lens, 1, launch, out) == sagitta::misfit && opl[0] == -1);
    launch.o.y = y, launch.d = {};
    EXPECT(sagitta::trace(lens, 1, launch, out) == sagitta::misfit);
    launch.d = {zero, zero, n}, launch.tmax = {n, 1};
    EXPECT(sagitta::intersect(lens[0].surface, launch, {}) == sagitta::misfit);
    launch.tmax = {};
    sagitta::hits hits;
    hits.n = {x_end, y_end, {}};
    EXPECT(sagitta::intersect(lens[0].surface, launch, hits) == sagitta::misfit);
    EXPECT(sagitta::intersect(lens[0].surface, sagitta::rays{}, {}) == 0);
    EXPECT(sagitta::intersect(lens[0].surface, launch, {}) == 2);
}

// ----------------------------------------------------------------------- intervals

static void intervals()
{
    using sagitta::interval;
    for (int i = 0; i < 1000; i++) {
        double a = random_number(), b = random_number(), d = random_number();
        interval x(sgt_interval_between(a, b)), y(sgt_interval_between(b, d));
        EXPECT(same(x + y, sgt_interval_sum(x, y)) && same(x - y, sgt_interval_difference(x, y)));
        EXPECT(same(x * y, sgt_interval_product(x, y)) && same(x / y, sgt_interval_quotient(x, y)));
        EXPECT(same(-x, sgt_interval_negative(x)) && same(square(x), sgt_interval_square(x)));
        EXPECT(same(sqrt(x), sgt_interval_square_root(x)) && same(abs(x), sgt_interval_absolute(x)));
        EXPECT(same(exp(x), sgt_interval_exponential(x)) && same(log(x), sgt_interval_logarithm(x)));
        EXPECT(same(sin(x), sgt_interval_sine(x)) && same(cos(x), sgt_interval_cosine(x)));
        EXPECT(same(tan(x), sgt_interval_tangent(x)) && same(2 * x - a, interval(2) * x - interval(a)));
        EXPECT(same(interval(-1, a + 2), {-1, a + 2}));
        EXPECT(same(asin(x), sgt_interval_arc_sine(x)) && same(acos(x), sgt_interval_arc_cosine(x)));
        EXPECT(same(atan(x), sgt_interval_arc_tangent(x)) && same(atan2(x, y), sgt_interval_angle(x, y)));
        EXPECT(same(sinh(x), sgt_interval_hyperbolic_sine(x)) && same(cbrt(x), sgt_interval_cube_root(x)));
        EXPECT(same(cosh(x), sgt_interval_hyperbolic_cosine(x)));
        EXPECT(same(tanh(x), sgt_interval_hyperbolic_tangent(x)));
        EXPECT(same(pow(x, 3), sgt_interval_power(x, 3)) && same(pow(x, y), sgt_interval_real_power(x, y)));
        EXPECT(same(pow(x, 2.5), sgt_interval_real_power(x, sgt_interval_of(2.5))));
        EXPECT(same(hypot(x, y), sgt_interval_hypotenuse(x, y)));
        EXPECT(same(min(x, y), sgt_interval_minimum(x, y)) && same(max(x, y), sgt_interval_maximum(x, y)));
    }
}

int main()
{
    const char *seed = std::getenv("SAGITTA_TEST_SEED");
    state = seed ? std::strtoull(seed, nullptr, 0) : 20260722;
    std::printf("seed %llu\n", static_cast<unsigned long long>(state));
    doubles warm(1);  // the count works
    EXPECT(allocations > 0);
    every_operation();
    lambdas_against_c();
    traces();
    intervals();
    std::printf("%d faults\n", faults);
    return faults != 0;
}
