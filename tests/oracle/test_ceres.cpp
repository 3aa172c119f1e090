// SPDX-License-Identifier: MIT
// Every root once more, by Ceres' own solvers and on a formula written for its scalars.
//
// The residual is F = z - s on the moved ray (o + t0 d is rounded once, by fma, so a far
// origin costs nothing); the one parameter is tau = t - t0.  Ceres minimises F^2 / 2, so
// it may end in a minimum that is no root: an end is a root where |F| is within its own
// rounding.  Then it must be sgt_intersect's root, or another one that sgt_intersect
// finds when it is asked for just that stretch of the ray, and not one before the first.
//
// The reference roots and the hard ones go through the whole ceres::Problem, random ones
// through ceres::TinySolver.  At every root ceres::Jet<double, 3> checks the gradients:
// the one of the hit and the one of ops->value.
//
// Level sets likewise, on the orbit of levels.h with Jets for numbers: from beside each root of
// sgt_intersect_all Ceres must come back to it, and wherever it ends in a root from elsewhere on
// the ray, that one must be in the list.
#include "cases.h"
#include "levels.h"
#include "table.h"

#include <sagitta/sagitta.h>

#include <ceres/ceres.h>
#include <ceres/tiny_solver.h>
#include <ceres/tiny_solver_autodiff_function.h>
#include <glog/logging.h>

#include <algorithm>
#include <cfloat>
#include <chrono>
#include <map>

using namespace oracle;

namespace {

std::map<std::string, long> failed, counted;

void print(const test_case &t, const sgt_hit &h)
{
    std::printf("    --replay \"");
    print_case(stdout, t);
    std::printf("\"\n    %s t %.17g (%a) t_err %.3g p %a %a %a n %a %a %a\n", sgt_status_text(h.status), h.t,
                h.t, h.t_err, h.p.x, h.p.y, h.p.z, h.n.x, h.n.y, h.n.z);
}

void fail(const char *why, const std::string &where, const test_case &t, const sgt_hit &h, double number)
{
    if (failed[why]++ >= 5) return;
    std::printf("FAIL %s (%s): %.17g\n", why, where.c_str(), number);
    print(t, h);
}

// F at p, for any scalar of Ceres'; NaN outside the domain.
template <class T> T equation(const sgt_even_asphere &s, const T &x, const T &y, const T &z)
{
    using std::sqrt;
    const T r2 = x * x + y * y;
    T sag = s.c * r2 / (1.0 + sqrt(1.0 - (1.0 + s.k) * s.c * s.c * r2)), power = r2;
    for (double a : s.a) {
        sag += a * power;
        power *= r2;
    }
    return z - sag;
}

// What rounding may make of F at p, and what 1 - (1+k) c^2 r^2 is there.
struct noise {
    double f, u;
};
noise noise_at(const sgt_even_asphere &s, const sgt_vec3 &p)
{
    const double r2 = p.x * p.x + p.y * p.y, u = 1 - (1 + s.k) * s.c * s.c * r2;
    double terms = std::fabs(p.z) +
                   std::fabs(s.c) * r2 *
                       (1 + std::fabs((1 + s.k) * s.c * s.c * r2) / std::max(u, DBL_EPSILON)),
           power = r2;
    for (double a : s.a) {
        terms += std::fabs(a) * power * 9;
        power *= r2;
    }
    return {16 * DBL_EPSILON * terms, u};
}

// One ray moved to t0, as a functor of both solvers.  Both have tolerances with units in
// them: the parameter is tau in units of `unit`, the residual F in units of `size`.
struct residual {
    const sgt_even_asphere *surface;
    sgt_vec3 o, d;
    double size, unit;
    template <class T> bool operator()(const T *parameter, T *f) const
    {
        const T tau = parameter[0] * unit;
        f[0] = equation(*surface, T(o.x + tau * d.x), T(o.y + tau * d.y), T(o.z + tau * d.z)) / size;
        return true;
    }
};

// The same for ceres::Problem, which takes no NaN but an "it cannot be done here".
struct defined_residual : residual {
    explicit defined_residual(const residual &r) : residual(r) {}
    template <class T> bool operator()(const T *tau, T *f) const
    {
        residual::operator()(tau, f);
        return f[0] == f[0];
    }
};

double tiny_solve(const residual &r, double tau)
{
    typedef ceres::TinySolverAutoDiffFunction<residual, 1, 1> function;
    function f(r);
    ceres::TinySolver<function> solver;
    solver.options.max_num_iterations = 60;
    solver.options.gradient_tolerance = 0;
    solver.options.parameter_tolerance = 1e-16;
    solver.options.function_tolerance = 0;
    solver.options.cost_threshold = 0;
    Eigen::Matrix<double, 1, 1> x(tau / r.unit);
    solver.Solve(f, &x);
    return x[0] * r.unit;
}

double whole_solve(const residual &r, double tau)
{
    double x = tau / r.unit;
    ceres::Problem problem;
    problem.AddResidualBlock(new ceres::AutoDiffCostFunction<defined_residual, 1, 1>(new defined_residual(r)),
                             nullptr, &x);
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::DENSE_QR;
    options.logging_type = ceres::SILENT;
    options.max_num_iterations = 100;
    options.function_tolerance = options.gradient_tolerance = options.parameter_tolerance = 1e-300;
    options.update_state_every_iteration = true; // it calls the end "no progress", and takes it back
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem, &summary);
    return x * r.unit;
}

sgt_hit ask(const test_case &t, const sgt_ray &ray, sgt_pick pick)
{
    sgt_conic conic;
    const sgt_surface s = as_surface(t, &conic);
    sgt_options options = {};
    options.pick = pick;
    return sgt_intersect(s, ray, &options);
}

// The gradient of the hit, and of ops->value, beside that of the Jets.
void check_gradient(const std::string &where, const test_case &t, const sgt_hit &h)
{
    typedef ceres::Jet<double, 3> jet;
    const jet f = equation(t.surface, jet(h.p.x, 0), jet(h.p.y, 1), jet(h.p.z, 2));
    const noise n = noise_at(t.surface, h.p);
    if (!(n.u > 1e-8)) {
        counted["gradients left out, at the rim of the domain"]++;
        return;
    }
    // What the terms of the slope lose by rounding; 1/u is the base conic's condition.
    const double r2 = h.p.x * h.p.x + h.p.y * h.p.y;
    double slope = std::fabs(t.surface.c) / std::sqrt(n.u) *
                   (1 + (1 + std::fabs((1 + t.surface.k) * t.surface.c * t.surface.c * r2)) / n.u),
           power = 1;
    for (int i = 0; i < 8; i++) {
        slope += 20 * (i + 1) * std::fabs(t.surface.a[i]) * power;
        power *= r2;
    }
    const double allowed = 32 * DBL_EPSILON * slope * std::sqrt(r2) + DBL_MIN;
    sgt_conic conic;
    const sgt_surface s = as_surface(t, &conic);
    sgt_vec3 g = {NAN, NAN, NAN};
    const double value = s.ops->value(s.self, h.p, &g);
    auto compare = [&](const char *which, const sgt_vec3 &v) {
        const double off = std::max(
            {std::fabs(v.x - f.v[0]), std::fabs(v.y - f.v[1]), std::fabs(v.z - f.v[2])});
        if (!(off <= allowed)) fail(which, where, t, h, off / allowed);
    };
    compare("gradient of the hit", h.n);
    compare("gradient of ops->value", g);
    if (!(std::fabs(value - f.a) <= 2 * n.f)) fail("value", where, t, h, value - f.a);
    counted["gradients compared"]++;
}

struct moved {
    double t0;
    residual r;
};

moved move(const test_case &t, double t0)
{
    const sgt_ray &r = t.ray;
    const double length = std::sqrt(r.d.x * r.d.x + r.d.y * r.d.y + r.d.z * r.d.z);
    return {t0,
            {&t.surface,
             {std::fma(t0, r.d.x, r.o.x), std::fma(t0, r.d.y, r.o.y), std::fma(t0, r.d.z, r.o.z)},
             r.d,
             t.h,
             t.h / length}};
}

typedef double solver(const residual &, double);

// Solves from tau and judges where it ends.  `own`: it must end at the hit's root.
void solve(const std::string &where, const test_case &t, const sgt_hit &h, const moved &m, double tau,
           solver *by, bool own)
{
    const double end = by(m.r, tau);
    counted["solved again"]++;
    const sgt_ray &ray = t.ray;
    const residual &r = m.r;
    const sgt_vec3 p = {r.o.x + end * r.d.x, r.o.y + end * r.d.y, r.o.z + end * r.d.z};
    const noise n = noise_at(t.surface, p);
    typedef ceres::Jet<double, 1> jet;
    jet f, at(end / r.unit, 0);
    r(&at, &f);
    f *= r.size;
    const double slope = std::fabs(f.v[0]) / r.unit,
                 length = std::sqrt(ray.d.x * ray.d.x + ray.d.y * ray.d.y + ray.d.z * ray.d.z);
    const double moving = DBL_EPSILON * (std::fabs(r.o.x) + std::fabs(r.o.y) + std::fabs(r.o.z) +
                                         3 * length * std::fabs(end));
    if (!(n.u > 1e-8)) {
        counted["... left out, at the rim of the domain"]++;
        return;
    }
    double gradient = 1;
    {
        typedef ceres::Jet<double, 3> jet3;
        const jet3 g = equation(t.surface, jet3(p.x, 0), jet3(p.y, 1), jet3(p.z, 2));
        gradient = std::sqrt(g.v.squaredNorm());
    }
    const double rounding = n.f + moving * gradient;
    if (!(std::fabs(f.a) <= 4 * rounding)) { // a minimum, or nowhere
        counted["... that end in no root"]++;
        if (own) counted["... though begun beside the root"]++;
        return;
    }
    const double wide = 8 * rounding / slope; // of tau: what Ceres can tell
    const double size = t.h / length;
    if (!(wide <= 1e-6 * (size + std::fabs(end)))) {
        counted["... left out, a graze"]++;
        return;
    }
    const double off = std::fabs((h.t - m.t0) - end);
    if (h.status > 0 && off <= h.t_err + wide) {
        counted["... at the root of the hit"]++;
        return;
    }
    if (own) counted["... that leave the root they began beside"]++;
    // Another root: does it count, and does sgt_intersect know it?
    const double r2 = p.x * p.x + p.y * p.y, rim = t.surface.semi_diameter;
    if (rim > 0 && r2 > rim * rim * (1 - 1e-9)) {
        counted["... outside the rim"]++;
        return;
    }
    double tmin, tmax;
    ends_of(ray, &tmin, &tmax);
    const double here = m.t0 + end, start = 1e-12 * (size + std::fabs(here)) + 1e3 * wide;
    const bool counts = here > tmin + start && here < tmax - start;
    if (counts && (h.status == SGT_MISS || (h.status > 0 && here < h.t - h.t_err - wide - start)))
        fail("Ceres found a root before the first", where, t, h, here);
    sgt_ray part = ray;
    const double reach = 4 * wide + 4 * DBL_EPSILON * std::fabs(here) + start;
    part.tmin = here - reach;
    part.tmax = here + reach;
    if (part.tmin == 0 && part.tmax == 0) return;
    const sgt_hit other = ask(t, part, SGT_FIRST);
    if (other.status < 0) {
        counted["... at another root, undecided"]++;
        return;
    }
    if (other.status == SGT_MISS) {
        test_case u = t;
        u.ray = part;
        fail("a root of Ceres' that is a miss", where, u, other, here);
    } else counted["... at another root, known too"]++;
}

// One ray: the same seed, beside the root, and others.
void again(const std::string &where, const test_case &t, const sgt_hit &h, generator &g, solver *by)
{
    const sgt_ray &r = t.ray;
    const double length = std::sqrt(r.d.x * r.d.x + r.d.y * r.d.y + r.d.z * r.d.z), size = t.h / length;
    if (h.status > 0) check_gradient(where, t, h);
    double vertex = -r.o.z / r.d.z;
    if (!(std::fabs(r.d.z) > 1e-3 * length))
        vertex = -(r.o.x * r.d.x + r.o.y * r.d.y + r.o.z * r.d.z) / (length * length);
    const moved plane = move(t, vertex);
    solve(where, t, h, plane, 0, by, false);
    solve(where, t, h, plane, size * g.uniform(-1, 1), by, false);
    if (h.status > 0) solve(where, t, h, move(t, h.t), size * g.sign() * 1e-4, by, true);
}

void random_ones(long count, generator &g)
{
    for (long i = 0; i < count; i++) {
        const test_case t = random_case(g);
        again("random", t, ask(t, t.ray, SGT_FIRST), g, tiny_solve);
    }
}

void hard_ones(const std::string &folder, generator &g)
{
    for (const hard_case &c : hard_cases(folder)) {
        test_case t = {};
        t.surface = c.surface;
        t.asphere = has_terms(c.surface);
        t.ray = c.ray;
        sgt_hit h = ask(t, c.ray, SGT_FIRST);
        const double length = std::sqrt(c.ray.d.x * c.ray.d.x + c.ray.d.y * c.ray.d.y +
                                        c.ray.d.z * c.ray.d.z);
        t.h = h.status > 0 ? std::max(1e-3, std::sqrt(h.p.x * h.p.x + h.p.y * h.p.y)) : 1;
        for (int i = 0; i < 4; i++) again(c.id, t, h, g, whole_solve);
        // Each listed root, from beside it.
        for (const decimal &root : c.roots) {
            const moved m = move(t, root.hi);
            const double end = whole_solve(m.r, 1e-5 * t.h / length);
            if (!(std::fabs(end - root.minus(m.t0)) <= 1e-9 * (1 + t.h / length)))
                fail("Ceres does not confirm a listed root", c.id, t, h, end);
            counted["listed roots solved again"]++;
        }
    }
}

// Every row of the reference rays is one ray on one surface: from the point before, in the
// frame of this one (no lens here is tilted).
void reference_ones(const std::string &folder)
{
    for (const char *name : lens_names) {
        const lens l(folder + "/" + name + "_lens.csv");
        const table rays(folder + "/" + name + "_rays.csv");
        for (std::size_t i = 0; i < rays.rows.size(); i++) {
            const int surf = rays.whole(i, "surf");
            const std::string &status = rays.cell(i, "status");
            if (surf == 0 || status == "miss" || status == "dead") continue;
            const std::size_t e = static_cast<std::size_t>(surf - 1);
            test_case t = {};
            t.surface = l.aspheres[e];
            t.asphere = has_terms(t.surface);
            const sgt_vec3 before = surf > 1 ? l.elements[e - 1].pose.origin : sgt_vec3{0, 0, 0},
                           here = l.elements[e].pose.origin;
            const sgt_vec3 p = rays.vector(i - 1, "x", "y", "z"), want = rays.vector(i, "x", "y", "z");
            t.ray = sgt_ray{{p.x + (before.x - here.x), p.y + (before.y - here.y), p.z + (before.z - here.z)},
                            rays.vector(i - 1, "l", "m", "n"),
                            -HUGE_VAL,
                            HUGE_VAL};
            t.h = std::max(1e-3, std::sqrt(want.x * want.x + want.y * want.y));
            const sgt_hit h = ask(t, t.ray, SGT_NEAR_SEED);
            const std::string where = std::string(name) + " ray " + rays.cell(i, "ray") + " surface " +
                                      rays.cell(i, "surf");
            if (h.status > 0) check_gradient(where, t, h);
            const moved m = move(t, -t.ray.o.z / t.ray.d.z);
            for (double seed : {0.0, want.z / t.ray.d.z * 0.9}) {
                solve(where, t, h, m, seed, whole_solve, false);
                solve(where, t, h, m, seed, tiny_solve, false);
            }
            // Begun a little beside it, Ceres must end at the very point of the reference.
            const double end = whole_solve(m.r, (want.z - m.r.o.z) / t.ray.d.z + 1e-4 * t.h);
            const residual &r = m.r;
            const double off = std::max({std::fabs(r.o.x + end * r.d.x - want.x),
                                         std::fabs(r.o.y + end * r.d.y - want.y),
                                         std::fabs(r.o.z + end * r.d.z - want.z)});
            if (!(off <= 1e-12 * l.length))
                fail("Ceres does not confirm a reference point", where, t, h, off);
            if (rays.whole(i, "nroots") == 1) {
                const double apart = std::max(
                    {std::fabs(h.p.x - want.x), std::fabs(h.p.y - want.y), std::fabs(h.p.z - want.z)});
                if (!(h.status > 0 && apart <= 1e-12 * l.length))
                    fail("sgt_intersect does not confirm a reference point", where, t, h, apart);
            }
            counted["reference roots solved again"]++;
        }
    }
}

// ---------------------------------------------------------------- level sets

void fail_on(const char *why, const level &f, const sgt_ray &r, const sgt_hit &h, double number)
{
    if (failed[why]++ >= 5) return;
    std::printf("FAIL %s: %.17g\n", why, number);
    print_level(f);
    std::printf("    o %a %a %a d %a %a %a\n    %s t %.17g t_err %.3g\n", r.o.x, r.o.y, r.o.z, r.d.x, r.d.y,
                r.d.z, sgt_status_text(h.status), h.t, h.t_err);
}

// F on the ray moved to t0; the parameter is in units of `unit`.
struct level_residual {
    const level *f;
    sgt_vec3 o, d;
    double unit;
    template <class T> bool operator()(const T *parameter, T *residual) const
    {
        const T tau = parameter[0] * unit;
        residual[0] = level_value(*f, T(o.x + tau * d.x), T(o.y + tau * d.y), T(o.z + tau * d.z));
        return true;
    }
};

double level_solve(const level_residual &r, double tau, bool whole)
{
    if (!whole) {
        typedef ceres::TinySolverAutoDiffFunction<level_residual, 1, 1> function;
        function f(r);
        ceres::TinySolver<function> tiny;
        tiny.options.max_num_iterations = 60;
        tiny.options.gradient_tolerance = tiny.options.function_tolerance = tiny.options.cost_threshold = 0;
        tiny.options.parameter_tolerance = 1e-17;
        Eigen::Matrix<double, 1, 1> x(tau / r.unit);
        tiny.Solve(f, &x);
        return x[0] * r.unit;
    }
    double x = tau / r.unit;
    ceres::Problem problem;
    problem.AddResidualBlock(new ceres::AutoDiffCostFunction<level_residual, 1, 1>(new level_residual(r)),
                             nullptr, &x);
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::DENSE_QR;
    options.logging_type = ceres::SILENT;
    options.max_num_iterations = 60;
    options.function_tolerance = options.gradient_tolerance = options.parameter_tolerance = 1e-300;
    options.update_state_every_iteration = true;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem, &summary);
    return x * r.unit;
}

// F and its gradient at p, and what rounding may make of F: an ulp at level n becomes |dQ_N/dQ_n| ulps
// of Q_N, which the longest of the |dQ_n/dx| on the way bounds well enough.
struct level_point {
    ceres::Jet<double, 3> f;
    double noise;
};
level_point at_point(const level &f, const sgt_vec3 &p)
{
    typedef ceres::Jet<double, 3> jet;
    const jet x(p.x, 0), y(p.y, 1), z(p.z, 2);
    double growth = 0;
    for (int n = 1; n <= f.s.iterations; n++) {
        int reached;
        const quaternion<jet> q = orbit(f, in_slice(f, x, y, z), n, 1e30, &reached);
        growth = std::max(growth, std::sqrt(q.a.v.squaredNorm() + q.b.v.squaredNorm() + q.c.v.squaredNorm() +
                                            q.d.v.squaredNorm()));
    }
    return {level_value(f, x, y, z),
            16 * DBL_EPSILON * (f.s.iterations + 1) * std::max(1.0, growth / axis_length(f))};
}

void level_ones(long count, generator &g)
{
    static sgt_hit list[4000];
    for (long i = 0; i < count; i++) {
        const level f = random_level(g);
        sgt_mandelbrot m;
        const sgt_surface s = as_surface(f, &m);
        const sgt_ray ray = random_ray(g, f);
        const int n = sgt_intersect_all(s, ray, 4000, list, nullptr);
        const double length = std::sqrt(ray.d.x * ray.d.x + ray.d.y * ray.d.y + ray.d.z * ray.d.z),
                     size = 1 / axis_length(f) / length;
        const auto moved_to = [&](double t) {
            return level_residual{
                &f,
                {std::fma(t, ray.d.x, ray.o.x), std::fma(t, ray.d.y, ray.o.y), std::fma(t, ray.d.z, ray.o.z)},
                ray.d,
                size};
        };
        // Where it ends: a root, and if so how well Ceres can tell (of t)?
        const auto wide_of = [&](double t0, double end) {
            const level_residual r = moved_to(t0);
            const level_point p = at_point(f,
                                           {r.o.x + end * r.d.x, r.o.y + end * r.d.y, r.o.z + end * r.d.z});
            const double slope = std::fabs(p.f.v[0] * ray.d.x + p.f.v[1] * ray.d.y + p.f.v[2] * ray.d.z);
            const double place = DBL_EPSILON * (std::fabs(r.o.x) + std::fabs(r.o.y) + std::fabs(r.o.z)) *
                                 std::sqrt(p.f.v.squaredNorm());
            return std::fabs(p.f.a) <= 4 * (p.noise + place) ? 8 * (p.noise + place) / slope : HUGE_VAL;
        };
        for (int k = 0; k < n && k < 8; k++) {
            const sgt_hit &h = list[k];
            if (h.status != SGT_HIT) continue;
            const level_point p = at_point(f, h.p);
            const double off = std::sqrt((p.f.v[0] - h.n.x) * (p.f.v[0] - h.n.x) +
                                         (p.f.v[1] - h.n.y) * (p.f.v[1] - h.n.y) +
                                         (p.f.v[2] - h.n.z) * (p.f.v[2] - h.n.z));
            const double gradient = std::sqrt(p.f.v.squaredNorm());
            if (!(off <= (1e-12 + 4 * p.noise) * gradient))
                fail_on("level set: gradient of the hit", f, ray, h, off / gradient);
            // From beside it, not as far as its neighbours.
            double room = size;
            for (int j = 0; j < n; j++)
                if (j != k) room = std::min(room, std::fabs(list[j].t - h.t));
            const double end = level_solve(moved_to(h.t), 1e-4 * room * g.sign(), k == 0),
                         wide = wide_of(h.t, end);
            counted["level sets: solved again"]++;
            if (!(wide <= 1e-6 * size)) counted["level sets: ... that end in no root, or a graze"]++;
            else if (std::fabs(end) <= h.t_err + wide) counted["level sets: ... at the root of the hit"]++;
            else if (std::fabs(end) < 0.01 * room)
                fail_on("level set: Ceres does not confirm a root", f, ray, h, end);
            else counted["level sets: ... that leave the root they began beside"]++;
        }
        // From anywhere on the ray's way through the ball.
        const double nearest = -(ray.o.x * ray.d.x + ray.o.y * ray.d.y + ray.o.z * ray.d.z) /
                               (length * length);
        for (int k = 0; k < 3; k++) {
            const double t0 = nearest + size * g.uniform(-1.5, 1.5),
                         end = level_solve(moved_to(t0), 0, false), t = t0 + end, wide = wide_of(t0, end);
            counted["level sets: solved from elsewhere"]++;
            if (!(wide <= 1e-6 * size) || t <= 1e-6 * size) {
                counted["level sets: ... that end in no root, or a graze, or behind the start"]++;
                continue;
            }
            bool known = false;
            for (int j = 0; j < n; j++)
                known = known ||
                        (list[j].status > 0 ? std::fabs(list[j].t - t) <=
                                                  list[j].t_err + wide + 4 * DBL_EPSILON * std::fabs(t)
                                            : list[j].lo <= t + wide && list[j].hi >= t - wide);
            if (!known)
                fail_on("level set: a root of Ceres' that is in no entry", f, ray, n ? list[0] : sgt_hit(),
                        t);
            counted["level sets: ... at a root of the list"]++;
        }
    }
    if (counted["level sets: ... at the root of the hit"] < count / 4)
        failed["too few roots of level sets confirmed"]++;
    if (counted["level sets: ... at a root of the list"] < count / 4)
        failed["too few roots of level sets found again"]++;
}

} // namespace

int main(int argc, char **argv)
{
    if (argc < 2) return std::printf("usage: test_ceres FOLDER-OF-DATA [--seed S] [--count N]\n"), 2;
    const run r(argc - 1, argv + 1, 10000, 271828);
    FLAGS_minloglevel = 3; // an undefined seed is no news
    const auto began = std::chrono::steady_clock::now();
    generator g(r.seed);
    hard_ones(argv[1], g);
    reference_ones(argv[1]);
    random_ones(r.count, g);
    level_ones(r.count / 10 + 1, g);
    for (const auto &c : counted) std::printf("  %9ld  %s\n", c.second, c.first.c_str());
    for (const auto &f : failed) std::printf("  FAIL %9ld  %s\n", f.second, f.first.c_str());
    std::printf("%.1f s\n", std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count());
    return !failed.empty();
}
