// SPDX-License-Identifier: MIT
// Every derivative against differences of sgt_intersect itself: each number of the ray and each parameter
// is moved a little to either side, and the ray met again.  Less sharp than the Jets (test_jets.cpp), but
// nothing is told the mathematics.
//
// (f(x + h) - f(x - h)) / 2h is off by f''' h^2 / 6 and by the rounding of f over h; a second one with h /
// 2 gives both away: the tolerance is TIMES their difference, and what rounding of f can be.
//
// Then what does not depend on a formula: the batch has the bits of the single ray, whatever its
// neighbours; misses are NaN, and the surface is not shown them; a surface that offers less is told as
// such, and what needs less is as it was.
#include "subjects.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <limits>

namespace {

int failures;

bool fail(const char *what)
{
    if (failures++ < 20) std::printf("FAIL %s\n", what);
    return false;
}

bool same(double a, double b)
{
    return std::memcmp(&a, &b, sizeof a) == 0 || (std::isnan(a) && std::isnan(b));
}
double part(const sgt_vec3 &v, int i) { return i == 0 ? v.x : i == 1 ? v.y : v.z; }
double length(const sgt_vec3 &v) { return std::sqrt(v.x * v.x + v.y * v.y + v.z * v.z); }

struct seven { double x[7]; }; // t, p, n
seven of(const sgt_hit &h) { return {{h.t, h.p.x, h.p.y, h.p.z, h.n.x, h.n.y, h.n.z}}; }
seven of(const sgt_change &c) { return {{c.t, c.p.x, c.p.y, c.p.z, c.n.x, c.n.y, c.n.z}}; }

// ------------------------------------------------------------------ differences

template <class Move> bool difference(sgt_surface s, const sgt_ray &ray, double h, Move move, seven &out)
{
    sgt_ray a = ray, b = ray;
    move(a, -h);
    const sgt_hit low = sgt_intersect(s, a, nullptr);
    move(a, 0);
    move(b, h);
    const sgt_hit high = sgt_intersect(s, b, nullptr);
    move(b, 0);
    for (int i = 0; i < 7; i++) out.x[i] = (of(high).x[i] - of(low).x[i]) / (2 * h);
    return low.status == SGT_HIT && high.status == SGT_HIT;
}

constexpr double TIMES = 20, NOISE = 1e-14;

struct tally { long compared, left; double worst; };

template <class Move>
void compare(const char *name, sgt_surface s, const sgt_ray &ray, const sgt_hit &hit, double condition,
             const sgt_change &ours, double h, int which, Move move, tally &w)
{
    seven wide, narrow, is = of(ours), at = of(hit);
    if (!difference(s, ray, 2 * h, move, wide) || !difference(s, ray, h, move, narrow)) {
        w.left++;
        return;
    }
    double size = length(hit.p) + std::fabs(hit.t) * length(ray.d);
    for (int i = 0; i < 7; i++) {
        const double noise = NOISE * condition *
                             (i == 0  ? size / length(ray.d)
                              : i < 4 ? size
                                      : length(hit.n)) /
                             h;
        const double most = TIMES * std::fabs(wide.x[i] - narrow.x[i]) / 3 + noise,
                     off = std::fabs(is.x[i] - narrow.x[i]);
        w.compared++;
        w.worst = std::max(w.worst, most > 0 ? off / most : 0);
        if (off <= most) continue;
        if (failures++ < 20)
            std::printf("FAIL %s: of %s by %d is %.17g, by differences %.17g (within %.3g; at %.17g)\n  ray "
                        "%a %a %a  %a %a %a\n",
                        name,
                        i == 0  ? "t"
                        : i < 4 ? "p"
                                : "n",
                        which, is.x[i], narrow.x[i], most, at.x[i], ray.o.x, ray.o.y, ray.o.z, ray.d.x,
                        ray.d.y, ray.d.z);
    }
}

template <class Subject> void differences(Subject &subject, oracle::generator &g, tally &w)
{
    const sgt_surface s = subject.surface();
    const std::vector<subjects::parameter> parameters = subject.parameters();
    for (int i = 0; i < 10; i++) {
        const sgt_ray ray = subject.ray(g);
        const sgt_hit hit = sgt_intersect(s, ray, nullptr);
        if (hit.status != SGT_HIT || !subject.near(hit.p)) continue;
        const double condition = length(hit.n) * length(ray.d) /
                                 std::fabs(hit.n.x * ray.d.x + hit.n.y * ray.d.y + hit.n.z * ray.d.z);
        if (condition > 10) continue;
        sgt_change by_o[3];
        std::vector<sgt_change> by_a(parameters.size());
        if (sgt_differentiate(s, &ray, &hit, by_o, by_a.data())) fail("something is missing");
        for (int j = 0; j < 3; j++) {
            compare(
                Subject::name(), s, ray, hit, condition, by_o[j], 0x1p-13, j,
                [&](sgt_ray &r, double h) {
                    (j == 0 ? r.o.x : j == 1 ? r.o.y : r.o.z) = part(ray.o, j) + h;
                },
                w);
            const double t = hit.t;
            const sgt_change c = by_o[j], by_d = {t * c.t,
                                                  {t * c.p.x, t * c.p.y, t * c.p.z},
                                                  {t * c.n.x, t * c.n.y, t * c.n.z}};
            compare(
                Subject::name(), s, ray, hit, condition, by_d, 0x1p-13 * length(ray.d), 3 + j,
                [&](sgt_ray &r, double h) {
                    (j == 0 ? r.d.x : j == 1 ? r.d.y : r.d.z) = part(ray.d, j) + h;
                },
                w);
        }
        for (std::size_t j = 0; j < parameters.size(); j++) {
            double &parameter = *parameters[j].at;
            const double was = parameter, h = std::exp2(std::floor(std::log2(1e-4 * parameters[j].unit)));
            compare(
                Subject::name(), s, ray, hit, condition, by_a[j], h, 6 + static_cast<int>(j),
                [&](sgt_ray &, double by) { parameter = was + by; }, w);
            if (parameter != was) fail("a parameter was left changed");
        }
    }
}

// ------------------------------------------------------------- batches and singles

// Room for all outputs.
struct room {
    room(std::size_t rays, std::size_t parameters)
        : n(rays), count(parameters), all((21 + 7 * parameters) * rays, -77)
    {
        double *next = all.data();
        auto array = [&] { double *a = next; next += n; return a; };
        jacobian = {};
        for (int i = 0; i < 3; i++) {
            jacobian.t_by_o[i] = array();
            for (int j = 0; j < 3; j++) jacobian.p_by_o[i][j] = array(), jacobian.n_by_o[i][j] = array();
            for (std::size_t j = 0; j < count; j++) p[i].push_back(array()), nn[i].push_back(array());
            jacobian.p_by_a[i] = p[i].data(), jacobian.n_by_a[i] = nn[i].data();
        }
        for (std::size_t j = 0; j < count; j++) t.push_back(array());
        jacobian.t_by_a = t.data();
    }
    sgt_change by_o(std::size_t i, int j) const
    {
        const sgt_jacobian &b = jacobian;
        return {b.t_by_o[j][i],
                {b.p_by_o[0][j][i], b.p_by_o[1][j][i], b.p_by_o[2][j][i]},
                {b.n_by_o[0][j][i], b.n_by_o[1][j][i], b.n_by_o[2][j][i]}};
    }
    sgt_change by_a(std::size_t i, std::size_t j) const
    {
        return {t[j][i], {p[0][j][i], p[1][j][i], p[2][j][i]}, {nn[0][j][i], nn[1][j][i], nn[2][j][i]}};
    }
    std::size_t n, count;
    std::vector<double> all;
    std::vector<double *> t, p[3], nn[3];
    sgt_jacobian jacobian;
};

struct batch { // rays and their hits
    batch(sgt_surface s, const std::vector<sgt_ray> &rays) : n(rays.size()), numbers(13 * n), status(n)
    {
        double *a = numbers.data();
        for (std::size_t i = 0; i < n; i++) {
            const sgt_ray &r = rays[i];
            const double x[6] = {r.o.x, r.o.y, r.o.z, r.d.x, r.d.y, r.d.z};
            for (std::size_t k = 0; k < 6; k++) a[k * n + i] = x[k];
        }
        in = {{a, a + n, a + 2 * n}, {a + 3 * n, a + 4 * n, a + 5 * n}, nullptr, nullptr};
        out = {};
        out.status = status.data();
        out.t = a + 6 * n;
        for (std::size_t k = 0; k < 3; k++) out.p[k] = a + (7 + k) * n, out.n[k] = a + (10 + k) * n;
        sgt_intersect_batch(s, n, in, out, nullptr);
    }
    std::size_t n;
    std::vector<double> numbers;
    std::vector<sgt_status> status;
    sgt_rays in;
    sgt_hits out;
};

bool same(const sgt_change &a, const sgt_change &b)
{
    for (int i = 0; i < 7; i++)
        if (!same(of(a).x[i], of(b).x[i])) return false;
    return true;
}

bool lost(const sgt_change &c)
{
    for (double x : of(c).x)
        if (!std::isnan(x)) return false;
    return true;
}

template <class Subject>
std::vector<sgt_ray> mixed(Subject &subject, oracle::generator &g, std::size_t n, int kind)
{
    std::vector<sgt_ray> rays;
    for (std::size_t i = 0; i < n; i++) {
        sgt_ray r = subject.ray(g);
        const bool spoiled = kind == 0 ? false : kind == 1 ? i % 2 == 0 : kind == 2 ? true : g.chance(0.3);
        if (spoiled) {
            const int how = g.chance(0.02) ? 3 : g.below(3); // the last costs most
            if (how == 0) r.d = {-r.d.x, -r.d.y, -r.d.z};
            if (how == 1) r.o.y = std::numeric_limits<double>::quiet_NaN();
            if (how == 2) r.d.z = std::numeric_limits<double>::infinity();
            if (how == 3) r.o.x = 1e9, r.d = {1, 0, 0};
        }
        rays.push_back(r);
    }
    return rays;
}

// The product is the Jacobian's, and NaN where that is.
template <class Subject>
void forward(sgt_surface s, oracle::generator &g, const batch &b, const room &all, const Subject &subject)
{
    const std::size_t n = b.n;
    std::vector<double> change(6 * n), da(all.count), out(7 * n, -77);
    for (double &c : change) c = g.uniform(-1, 1);
    for (double &c : da) c = g.chance(0.3) ? 0 : g.uniform(-1, 1);
    const bool origins = g.chance(0.7), directions = g.chance(0.7), parameters = g.chance(0.7);
    double *o = out.data();
    const double *c = change.data();
    sgt_rays by = {};
    for (std::size_t k = 0; k < 3; k++) {
        if (origins) by.o[k] = c + k * n;
        if (directions) by.d[k] = c + (3 + k) * n;
    }
    sgt_differentiate_forward(s, n, b.in, b.out, by, parameters ? da.data() : nullptr,
                              {o, {o + n, o + 2 * n, o + 3 * n}, {o + 4 * n, o + 5 * n, o + 6 * n}});
    for (std::size_t i = 0; i < n; i++) {
        double sum[7] = {}, size[7] = {}, most = 1;
        auto add = [&](const sgt_change &column, double times) {
            for (int k = 0; k < 7; k++)
                sum[k] += of(column).x[k] * times, size[k] += std::fabs(of(column).x[k] * times);
        };
        for (int j = 0; j < 3; j++) {
            const std::size_t k = static_cast<std::size_t>(j);
            if (origins) add(all.by_o(i, j), c[k * n + i]);
            if (directions) add(all.by_o(i, j), c[(3 + k) * n + i] * b.out.t[i]);
            most = std::max(most,
                            std::fabs(all.by_o(i, j).t) * length({b.in.d[0][i], b.in.d[1][i], b.in.d[2][i]}));
        }
        for (std::size_t j = 0; parameters && j < all.count; j++) add(all.by_a(i, j), da[j]);
        for (std::size_t k = 0; k < 7; k++) {
            const double is = o[k * n + i];
            if (b.out.status[i] > 0 && !subject.near({b.out.p[0][i], b.out.p[1][i], b.out.p[2][i]})) continue;
            if (b.out.status[i] <= 0 ? !std::isnan(is)
                                     : !(std::fabs(is - sum[k]) <= 1e-13 * most * (size[0] + size[k])))
                fail("the forward product is not the Jacobian's");
        }
    }
}

template <class Subject> void bits(Subject &subject, oracle::generator &g)
{
    const sgt_surface s = subject.surface();
    const std::size_t count = sgt_parameters(s);
    for (int kind = 0; kind < 4; kind++) {
        const std::size_t n = static_cast<std::size_t>(1 + g.below(250));
        const std::vector<sgt_ray> rays = mixed(subject, g, n, kind);
        const batch b(s, rays);
        room all(n, count), some(n, count);
        sgt_differentiate_batch(s, n, b.in, b.out, all.jacobian);
        std::vector<sgt_change> by_a(count);
        for (std::size_t i = 0; i < n; i++) {
            sgt_change by_o[3];
            const sgt_hit hit = sgt_intersect(s, rays[i], nullptr);
            sgt_differentiate(s, &rays[i], &hit, by_o, by_a.data());
            for (int j = 0; j < 3; j++) {
                if (!same(all.by_o(i, j), by_o[j])) fail("batch and single differ by o");
                if (hit.status <= 0 && !lost(by_o[j])) fail("a miss has a derivative by o");
                if (hit.status == SGT_HIT && std::isnan(by_o[j].t)) fail("a hit has none by o");
            }
            for (std::size_t j = 0; j < count; j++) {
                if (!same(all.by_a(i, j), by_a[j])) fail("batch and single differ by a parameter");
                if (hit.status <= 0 && !lost(by_a[j])) fail("a miss has a derivative by a parameter");
                if (hit.status == SGT_HIT && std::isnan(by_a[j].t)) fail("a hit has none by a parameter");
            }
        }
        // What is not wanted is not written, and changes nothing; without a status NaN in n says it.
        sgt_jacobian jacobian = some.jacobian;
        sgt_hits hits = b.out;
        if (g.chance(0.5)) hits.status = nullptr;
        std::vector<double *> t = some.t, p = some.p[1], nn = some.nn[2];
        for (std::size_t j = 0; j < count; j++) {
            if (g.chance(0.5)) t[j] = nullptr;
            if (g.chance(0.5)) p[j] = nullptr;
            if (g.chance(0.5)) nn[j] = nullptr;
        }
        jacobian.t_by_a = g.chance(0.2) ? nullptr : t.data();
        jacobian.p_by_a[1] = g.chance(0.2) ? nullptr : p.data(),
        jacobian.n_by_a[2] = g.chance(0.2) ? nullptr : nn.data();
        for (int i = 0; i < 3; i++) {
            if (g.chance(0.5)) jacobian.t_by_o[i] = nullptr;
            if (g.chance(0.5)) jacobian.p_by_a[i == 1 ? 0 : i] = nullptr;
            if (g.chance(0.5)) jacobian.n_by_a[i == 2 ? 0 : i] = nullptr;
            for (int j = 0; j < 3; j++) {
                if (g.chance(0.5)) jacobian.p_by_o[i][j] = nullptr;
                if (g.chance(0.5)) jacobian.n_by_o[i][j] = nullptr;
            }
        }
        sgt_differentiate_batch(s, n, b.in, hits, jacobian);
        for (std::size_t i = 0; i < n * (21 + 7 * count); i++)
            if (some.all[i] != -77 && !same(some.all[i], all.all[i]))
                fail("what else is wanted changes a number");
        for (int j = 0; j < 3; j++)
            if (!jacobian.t_by_o[j] && some.jacobian.t_by_o[j][0] != -77) fail("not wanted, and written");
        for (std::size_t j = 0; j < count; j++) {
            if ((!jacobian.t_by_a || !t[j]) && some.t[j][0] != -77)
                fail("t by a parameter not wanted, and written");
            if (jacobian.t_by_a && t[j] && some.t[j][n - 1] == -77)
                fail("t by a parameter wanted, and not written");
        }
        forward(s, g, b, all, subject);
        // The status decides, whatever is in p and n.
        std::vector<sgt_status> status = b.status;
        const std::size_t taken = static_cast<std::size_t>(g.below(static_cast<int>(n)));
        status[taken] = g.chance(0.5) ? SGT_MISS : SGT_UNPROVEN;
        hits.status = status.data();
        sgt_differentiate_batch(s, n, b.in, hits, some.jacobian);
        for (std::size_t i = 0; i < n; i++)
            for (int j = 0; j < 3; j++)
                if (i == taken ? !lost(some.by_o(i, j)) : !same(some.by_o(i, j), all.by_o(i, j)))
                    fail("a status that is not positive");
    }
}

// --------------------------------------------------------------- less is offered

long shown; // points of a ray that was not met
void watchful_second(const void *self, std::size_t n, sgt_points p, double *const out[6])
{
    for (std::size_t i = 0; i < n; i++) shown += !(std::fabs(p.p[0][i]) < 100);
    subjects::quartic_second(self, n, p, out);
}
void watchful_by_parameter(const void *self, std::size_t j, std::size_t n, sgt_points p, sgt_values out)
{
    for (std::size_t i = 0; i < n; i++) shown += !(std::fabs(p.p[0][i]) < 100);
    subjects::quartic_by_parameter(self, j, n, p, out);
}

void less(oracle::generator &g)
{
    subjects::quartic subject(g);
    const sgt_surface whole = subject.surface();
    sgt_surface_ops watchful = *whole.ops;
    watchful.second = watchful_second, watchful.by_parameter = watchful_by_parameter;
    for (int kind = 0; kind < 4; kind++) {
        const std::size_t n = 200;
        const batch b({&watchful, whole.self}, mixed(subject, g, n, kind));
        room all(n, 2);
        if (sgt_differentiate_batch({&watchful, whole.self}, n, b.in, b.out, all.jacobian))
            fail("something is missing");
        for (int what = 0; what < 4; what++) {
            sgt_surface_ops ops = *whole.ops;
            if (what & 1) ops.second = nullptr;
            if (what & 2) ops.by_parameter = nullptr;
            const sgt_surface s = {&ops, whole.self};
            const int lacks = (what & 1 ? SGT_LACKS_SECOND : 0) | (what & 2 ? SGT_LACKS_PARAMETERS : 0);
            if (sgt_parameters(s) != (what & 2 ? 0 : 2)) fail("the number of parameters");
            room some(n, 2);
            if (sgt_differentiate_batch(s, n, b.in, b.out, some.jacobian) != lacks)
                fail("what is lacking is not told");
            sgt_jacobian t_alone = {};
            for (int j = 0; j < 3; j++) t_alone.t_by_o[j] = some.jacobian.t_by_o[j];
            if (sgt_differentiate_batch(s, n, b.in, b.out, t_alone) != 0) fail("nothing is lacking");
            for (std::size_t i = 0; i < n; i++)
                for (int j = 0; j < 3; j++) {
                    const sgt_change is = some.by_o(i, j), was = all.by_o(i, j);
                    if (!same(is.t, was.t)) fail("t by o needs less");
                    for (int k = 0; k < 3; k++) {
                        if (!same(part(is.p, k), part(was.p, k))) fail("p by o needs less");
                        if (what & 1 ? !std::isnan(part(is.n, k)) : !same(part(is.n, k), part(was.n, k)))
                            fail("n by o");
                    }
                    if (what & 2) continue;
                    const sgt_change a = some.by_a(i, static_cast<std::size_t>(j & 1)),
                                     before = all.by_a(i, static_cast<std::size_t>(j & 1));
                    if (!same(a.t, before.t)) fail("t by a parameter needs less");
                    if (what & 1 ? !std::isnan(a.n.x) : !same(a.n.x, before.n.x)) fail("n by a parameter");
                }
            if (what & 2 && some.t[0][0] != -77) fail("parameters that are none have been written");
            std::vector<double> out(7 * n);
            double *o = out.data();
            const double da[2] = {1, -1};
            for (const double *moved : {static_cast<const double *>(nullptr), da}) {
                const sgt_changes changes = {
                    o, {o + n, o + 2 * n, o + 3 * n}, {o + 4 * n, o + 5 * n, o + 6 * n}};
                const int is = sgt_differentiate_forward(s, n, b.in, b.out, b.in, moved, changes);
                if (is !=
                    ((what & 1 ? SGT_LACKS_SECOND : 0) | (moved && what & 2 ? SGT_LACKS_PARAMETERS : 0)))
                    fail("what the product lacks is not told");
                for (std::size_t i = 0; i < n; i++) {
                    const bool no_t = b.status[i] <= 0 || (moved && what & 2), no_n = no_t || what & 1;
                    if (std::isnan(o[i]) != no_t || std::isnan(o[n + i]) != no_t ||
                        std::isnan(o[5 * n + i]) != no_n)
                        fail("a product of what is lacking");
                }
            }
        }
    }
    if (shown) fail("a point of a ray that was not met was shown to the surface");
}

// A level set offers neither: by the ray t and p come all the same.
void level_set()
{
    sgt_julia julia = {};
    julia.c[0] = -0.2, julia.c[1] = 0.6, julia.iterations = 4;
    const double e = 1;
    julia.ex[0] = julia.ey[1] = julia.ez[2] = e;
    const sgt_surface s = {&sgt_julia_ops, &julia};
    const sgt_ray ray = {{0.1, 0.2, -4}, {0.01, 0.02, 1}, 0, 0};
    const sgt_hit hit = sgt_intersect(s, ray, nullptr);
    sgt_change by_o[3], none;
    if (hit.status != SGT_HIT) fail("the level set is not met");
    if (sgt_parameters(s) != 0) fail("a level set has parameters");
    if (sgt_differentiate(s, &ray, &hit, by_o, &none) != (SGT_LACKS_SECOND | SGT_LACKS_PARAMETERS))
        fail("a level set lacks both");
    for (int j = 0; j < 3; j++) {
        if (!std::isnan(by_o[j].n.x)) fail("second derivatives of a level set");
        seven d;
        if (!difference(
                s, ray, 0x1p-20,
                [&](sgt_ray &r, double h) {
                    (j == 0 ? r.o.x : j == 1 ? r.o.y : r.o.z) = part(ray.o, j) + h;
                },
                d))
            fail("not met beside");
        for (int i = 0; i < 4; i++)
            if (!(std::fabs(d.x[i] - of(by_o[j]).x[i]) <= 1e-6 * (1 + std::fabs(d.x[i]))))
                fail("a level set by differences");
    }
}

class visitor {
public:
    visitor(std::uint64_t seed, long times) : g(seed), count(times) {}
    template <class Subject> void of()
    {
        tally w = {};
        for (long i = 0; i < count; i++) {
            Subject subject(g);
            differences(subject, g, w);
            if (i % 8 == 0) bits(subject, g);
        }
        std::printf("%-14s %ld differences, %ld left out, worst %.3f of the tolerance\n", Subject::name(),
                    w.compared, w.left, w.worst);
        if (w.compared < 100 * count || w.left * 50 > w.compared) fail("too few differences");
    }
    oracle::generator g;
private:
    long count;
};

} // namespace

int main(int argc, char **argv)
{
    const oracle::run run(argc, argv, 8, 7);
    visitor visit(run.seed, run.count);
    subjects::each_subject(visit);
    less(visit.g);
    level_set();
    std::printf("%d failures\n", failures);
    return failures != 0;
}
