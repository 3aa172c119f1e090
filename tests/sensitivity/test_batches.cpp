// SPDX-License-Identifier: MIT
// The functions of aim.h for many rays, against those for one: each number to the last bit.
//
// Random trains of elements: every type of sgt_builtins, a user's surface without second derivatives, a
// formula; mirrors, turned frames, ideal lenses, rims, items of apertures; some elements without any change
// of index. Some hundred rays go through each.  Among them are rays that miss, are clipped or totally
// reflected, and rays of NaN and infinity: what a ray is told does not depend on its neighbours, so the
// neighbours of any are bad ones.
//
//     sgt_trace_error_batch         all four numbers, and some of them only
//     sgt_trace_sensitivity_batch   columns with changes of all kinds, in place too; more of them than go
//     together sgt_trace_gradient_batch      rows with weights of points, of directions (for some rays only),
//     of paths sgt_aim_batch                 points that are met or not, starts of their own, tolerances,
//     budgets: the
//                                   answers, the attempts, the counts, the passages
//
// SAGITTA_TEST_SCALE multiplies the trains; SAGITTA_TEST_SEED replaces the seed.
#include "../batch/soil.h"
#include "../catalogue/specimens.h"

#include <sagitta/aim.h>
#include <sagitta/formula.h>

#include <array>

using namespace catalogue;
typedef std::vector<double> numbers;

static long failures, compared, same_as_nan;
static unsigned long long train_seed;

static void fail(const char *what, std::size_t a, std::size_t b, double got, double wanted)
{
    if (failures++ < 20)
        std::printf("FAIL %s (%zu, %zu): %a, alone %a; train %llu\n", what, a, b, got, wanted, train_seed);
}

static void compare(const char *what, std::size_t a, std::size_t b, double got, double wanted)
{
    compared++;
    if (got != got && wanted != wanted) {
        same_as_nan++;
        return;
    }
    if (std::memcmp(&got, &wanted, sizeof got)) fail(what, a, b, got, wanted);
}

// ------------------------------------------------------------------ elements

static double bowl(const void *self, sgt_vec3 p, sgt_vec3 *grad)
{
    const double c = *static_cast<const double *>(self);
    if (grad) *grad = {-c * p.x, -c * p.y, 1};
    return p.z - 0.5 * c * (p.x * p.x + p.y * p.y);
}

struct train {
    std::vector<specimen> kept;
    std::vector<sgt_element> e;
    sgt_surface_ops user;
    double curvature, before;
    sgt_phase phase[8];
    sgt_polynomial_xy waves[8];
    double numbers[8][9];
    sgt_aperture_item item[8];
    sgt_aperture aperture[8];
};

static const sgt_tape *ripples()
{
    static const char text[] = "0.02*(x^2 + y^2) + 0.01*sin(x)";
    static std::vector<double> room(sgt_formula_room(text, 0) / sizeof(double) + 1);
    static const sgt_tape *tape = sgt_formula_read(text, SGT_FORMULA_XY, 0, nullptr, room.data(),
                                                   room.size() * sizeof(double), nullptr);
    return tape;
}

static sgt_surface random_surface(generator &g, train &r)
{
    static const sgt_formula_sag ripple = {ripples(), 0};
    specimen s = {};
    if (g.chance(0.05)) return {&r.user, &r.curvature};
    if (g.chance(0.05)) return {&sgt_formula_sag_ops, &ripple};
    if (g.chance(0.03)) {
        s.s = {&sgt_julia_ops, s.keep(sgt_julia{})};
    } else if (g.chance(0.6)) {
        const double c = g.chance(0.2) ? 0 : g.sign() / g.log_uniform(6, 200),
                     k = g.chance(0.5) ? 0 : g.uniform(-2, 1);
        sgt_even_asphere a = {c, k, g.chance(0.3) ? 6.0 : 0.0, {}};
        for (double &term : a.a)
            term = g.chance(0.3) ? g.uniform(-1, 1) * std::pow(10.0, -3 - 2 * double(&term - a.a)) : 0;
        if (g.chance(0.5))
            s.s = {&sgt_conic_ops, s.keep(sgt_conic{c, k, a.semi_diameter})};
        else
            s.s = {&sgt_even_asphere_ops, s.keep(a)};
    } else {
        const char *type = types[std::size_t(g.below(int(types.size())))];
        do s = random_specimen(g, type);
        while (!(s.h > 5 && s.h < 50));
    }
    r.kept.push_back(s);
    return s.s;
}

// A phase in waves: a polynomial, a formula of x and y, or the user's function, which has no second
// derivatives.
static void random_waves(generator &g, train &r, std::size_t i)
{
    static const sgt_formula_sag ripple = {ripples(), 0};
    sgt_phase &p = r.phase[i] = {};
    for (double &a : r.numbers[i]) a = g.uniform(-0.1, 0.1);
    r.waves[i] = {}, r.waves[i].a = {r.numbers[i], 3, 3};
    p.kind = SGT_PHASE_SAG, p.per_wave = g.sign() * g.uniform(0.1, 1);
    p.waves = {&sgt_polynomial_xy_ops, &r.waves[i]};
    if (g.chance(0.3)) p.waves = {&sgt_formula_sag_ops, &ripple};
    if (!g.chance(0.2)) return;
    p.waves = {&r.user, &r.curvature};
    if (g.chance(0.5)) p.kind = SGT_PHASE_FUNCTION;
}

static void random_train(generator &g, train &r)
{
    const std::size_t count = std::size_t(1 + g.below(6));
    r.before = g.chance(0.5) ? 0 : g.uniform(1, 1.7);
    r.user = {}, r.user.value = bowl, r.user.name = "bowl";
    r.curvature = g.uniform(-0.05, 0.05);
    double z = 0, way = 1;
    for (std::size_t i = 0; i < count; i++) {
        sgt_element e = {};
        e.surface = random_surface(g, r);
        e.index = g.chance(0.3) ? 0 : g.chance(0.2) ? SGT_MIRROR : g.uniform(1, 1.9);
        e.semi_diameter = g.chance(0.3) ? g.uniform(2, 6) : 0;
        if (g.chance(0.2)) {
            r.phase[i] = {};
            r.phase[i].kind = SGT_IDEAL_LENS, r.phase[i].focal_length = g.sign() * g.log_uniform(10, 100);
            r.phase[i].object_distance = g.chance(0.5) ? 0 : g.sign() * g.log_uniform(10, 100);
            if (g.chance(0.6)) random_waves(g, r, i);
            e.phase = &r.phase[i];
        }
        if (g.chance(0.2)) {
            r.item[i] = {};
            r.item[i].shape = SGT_CIRCLE, r.item[i].radius = g.uniform(0.5, 5),
            r.item[i].obscuring = g.chance(0.3);
            r.aperture[i] = {};
            r.aperture[i].count = 1, r.aperture[i].items = &r.item[i];
            e.aperture = &r.aperture[i];
        }
        const sgt_vec3 origin = {g.uniform(-0.5, 0.5), g.uniform(-0.5, 0.5), z};
        if (g.chance(0.4))
            e.pose = sgt_pose_tilted(origin, {g.uniform(-15, 15), g.uniform(-15, 15), g.uniform(-180, 180)});
        else
            e.pose.origin = origin;
        r.e.push_back(e);
        if (e.index == SGT_MIRROR) way = -way;
        z += way * g.uniform(0.2, 15);
    }
}

static sgt_ray random_ray(generator &g)
{
    const double wide = g.chance(0.2) ? 12 : 3, slope = g.chance(0.1) ? 1.5 : 0.2,
                 far = g.log_uniform(1, 100), by = g.chance(0.5) ? 1 : g.log_uniform(0.1, 10);
    const double u = g.uniform(-slope, slope), v = g.uniform(-slope, slope);
    sgt_ray ray = {{g.uniform(-wide, wide) - u * far, g.uniform(-wide, wide) - v * far, -far},
                   {u * by, v * by, by},
                   0,
                   0};
    if (g.chance(0.05)) (g.chance(0.5) ? ray.o.x : ray.d.y) = g.chance(0.5) ? NAN : INFINITY;
    return ray;
}

// --------------------------------------------------------------------- a batch

// Arrays for n rays, and what they are shown as.
struct batch {
    std::size_t n, elements;
    numbers launch[6];
    std::vector<numbers> all;
    std::vector<std::vector<sgt_status>> status;
    std::vector<sgt_passages> passages;
    batch(std::size_t rays, std::size_t count) : n(rays), elements(count), status(count)
    {
        for (numbers &x : launch) x.resize(n);
        all.reserve(17 * count);
        for (std::size_t i = 0; i < count; i++) {
            sgt_passages p = {};
            status[i].resize(n), p.hits.status = status[i].data();
            p.hits.t = room(), p.hits.t_lo = room(), p.hits.p_err = room(), p.opl = room();
            for (int k = 0; k < 3; k++) p.hits.p[k] = room(), p.hits.n[k] = room(), p.direction[k] = room();
            passages.push_back(p);
        }
    }
    double *room() { return all.emplace_back(n, -7.0), all.back().data(); }
    void set(std::size_t i, const sgt_ray &ray)
    {
        const double x[6] = {ray.o.x, ray.o.y, ray.o.z, ray.d.x, ray.d.y, ray.d.z};
        for (int k = 0; k < 6; k++) launch[k][i] = x[k];
    }
    sgt_rays rays() const
    {
        sgt_rays r = {};
        for (int k = 0; k < 3; k++) r.o[k] = launch[k].data(), r.d[k] = launch[3 + k].data();
        return r;
    }
};

static void compare_passage(const char *what, const batch &b, std::size_t i, std::size_t j,
                            const sgt_passage &p)
{
    const sgt_passages &to = b.passages[j];
    if (to.hits.status[i] != p.hit.status) fail(what, i, j, to.hits.status[i], p.hit.status);
    const double *const got[12] = {to.hits.t,    to.hits.p_err,   to.opl,          to.hits.p[0],
                                   to.hits.p[1], to.hits.p[2],    to.hits.n[0],    to.hits.n[1],
                                   to.hits.n[2], to.direction[0], to.direction[1], to.direction[2]};
    const double alone[12] = {p.hit.t,   p.hit.p_err, p.opl,     p.hit.p.x,     p.hit.p.y,     p.hit.p.z,
                              p.hit.n.x, p.hit.n.y,   p.hit.n.z, p.direction.x, p.direction.y, p.direction.z};
    for (int k = 0; k < 12; k++) compare(what, i, j, got[k][i], alone[k]);
}

static double *part(sgt_ray_change &c, int k)
{
    double *const all[7] = {&c.p.x, &c.p.y, &c.p.z, &c.d.x, &c.d.y, &c.d.z, &c.opl};
    return all[k];
}

// Changes of each ray, seven arrays a column; and which of them are given.
struct columns {
    std::vector<std::array<numbers, 7>> x;
    std::vector<std::array<bool, 3>> given;
    std::vector<sgt_ray_changes> shown;
    columns(std::size_t count, std::size_t n) : x(count), given(count), shown(count)
    {
        for (auto &c : x)
            for (numbers &a : c) a.assign(n, 0.0);
    }
    void show()
    {
        for (std::size_t c = 0; c < x.size(); c++) {
            shown[c] = {};
            for (int k = 0; k < 3; k++) {
                if (given[c][0]) shown[c].p[k] = x[c][std::size_t(k)].data();
                if (given[c][1]) shown[c].d[k] = x[c][std::size_t(3 + k)].data();
            }
            if (given[c][2]) shown[c].opl = x[c][6].data();
        }
    }
    sgt_ray_change of(std::size_t c, std::size_t i)
    {
        sgt_ray_change out = {};
        for (int k = 0; k < 7; k++) *part(out, k) = x[c][std::size_t(k)][i];
        return out;
    }
    // Some are zero for some rays, or for all.
    void draw(generator &g)
    {
        for (std::size_t c = 0; c < x.size(); c++) {
            for (bool &there : given[c]) there = g.chance(0.6);
            for (std::size_t k = 0; k < 7; k++)
                for (double &v : x[c][k]) v = given[c][k / 3] && !g.chance(0.3) ? g.uniform(-1, 1) : 0;
        }
        show();
    }
};

static void compare_derivatives(generator &g, const train &r, const batch &b,
                                const std::vector<std::vector<sgt_passage>> &alone)
{
    const std::size_t n = b.n, m = r.e.size(), count = sgt_trace_parameters(m, r.e.data());
    numbers error[4];
    for (numbers &x : error) x.assign(n, -7.0);
    sgt_end_errors out = {};
    out.point = error[0].data(), out.path = error[1].data(), out.grain = error[2].data();
    out.path_grain = error[3].data();
    const sgt_traces traces = {n, b.rays(), b.passages.data()};
    soil_stack(g.bits());
    std::size_t met = sgt_trace_error_batch(m, r.e.data(), r.before, &traces, out), ok = 0;
    numbers some(n, -7.0);
    sgt_end_errors few = {};
    const int which = g.below(4);
    (which == 0 ? few.point : which == 1 ? few.path : which == 2 ? few.grain : few.path_grain) = some.data();
    soil_stack(g.bits());
    sgt_trace_error_batch(m, r.e.data(), r.before, &traces, few);

    const std::size_t wide = std::size_t(1 + g.below(11)), high = std::size_t(1 + g.below(6));
    columns change(wide, n), to(wide, n), weight(high, n);
    change.draw(g), weight.draw(g);
    for (auto &a : to.given) a = {true, true, true};
    to.show();
    soil_stack(g.bits());
    int lacks = sgt_trace_sensitivity_batch(m, r.e.data(), r.before, &traces, wide, change.shown.data(),
                                            to.shown.data()),
        lack = 0;
    columns in_place = change;
    for (auto &a : in_place.given) a = {true, true, true};
    in_place.show();
    sgt_trace_sensitivity_batch(m, r.e.data(), r.before, &traces, wide, in_place.shown.data(),
                                in_place.shown.data());
    std::vector<numbers> gradient(high * count, numbers(n, -7.0));
    std::vector<double *> list;
    for (numbers &x : gradient) list.push_back(g.chance(0.1) ? nullptr : x.data());
    soil_stack(g.bits());
    int lacks_back = sgt_trace_gradient_batch(m, r.e.data(), r.before, &traces, high, weight.shown.data(),
                                              list.data()),
        lack_back = 0;
    std::vector<double> one(high * count);
    for (std::size_t i = 0; i < n; i++) {
        const sgt_ray launch = {{b.launch[0][i], b.launch[1][i], b.launch[2][i]},
                                {b.launch[3][i], b.launch[4][i], b.launch[5][i]},
                                0,
                                0};
        sgt_end_error told;
        ok += sgt_trace_error(m, r.e.data(), r.before, &launch, alone[i].data(), &told);
        const double all[4] = {told.point, told.path, told.grain, told.path_grain};
        for (std::size_t k = 0; k < 4; k++) compare("an error", i, k, error[k][i], all[k]);
        const std::size_t order[4] = {0, 1, 2, 3};
        compare("an error by itself", i, order[which], some[i], all[order[which]]);
        std::vector<sgt_ray_change> c, w;
        for (std::size_t j = 0; j < wide; j++) c.push_back(change.of(j, i));
        for (std::size_t j = 0; j < high; j++) w.push_back(weight.of(j, i));
        lack |= sgt_trace_sensitivity(m, r.e.data(), r.before, &launch, alone[i].data(), wide, c.data(),
                                      c.data());
        for (std::size_t j = 0; j < wide; j++)
            for (std::size_t k = 0; k < 7; k++) {
                compare("forward", i, 7 * j + k, to.x[j][k][i], *part(c[j], int(k)));
                compare("forward, in place", i, 7 * j + k, in_place.x[j][k][i], *part(c[j], int(k)));
            }
        lack_back |=
            sgt_trace_gradient(m, r.e.data(), r.before, &launch, alone[i].data(), high, w.data(), one.data());
        for (std::size_t j = 0; j < high * count; j++)
            if (list[j])
                compare("backward", i, j, gradient[j][i], one[j]);
            else if (gradient[j][i] != -7)
                fail("not wanted", i, j, gradient[j][i], -7);
    }
    if (met != ok) fail("how many were met", 0, 0, double(met), double(ok));
    if (lacks != lack || lacks_back != lack_back)
        fail("lacks", std::size_t(lacks), std::size_t(lacks_back), lack, lack_back);
}

// ------------------------------------------------------------------------ aims

static long aims, met_points;

static void compare_aims(generator &g, const train &r)
{
    const std::size_t n = std::size_t(1 + g.below(150)), stop = std::size_t(g.below(int(r.e.size())));
    sgt_beam beam = {};
    const double a = g.uniform(-0.1, 0.1), c = g.uniform(-0.1, 0.1), far = g.log_uniform(20, 1e4);
    beam.u = beam.v = {-4, 4};
    if (g.chance(0.5))
        beam.o = {-20 * a, -20 * c, -20}, beam.ou = {1, 0, 0}, beam.ov = {0, 1, 0}, beam.d = {a, c, 1};
    else
        beam.o = {-far * a, -far * c, -far}, beam.d = {far * a, far * c, far}, beam.du = {1, 0, 0},
        beam.dv = {0, 1, 0};
    std::vector<sgt_vec2> wanted(n), start;
    std::vector<sgt_passage> passages(r.e.size()), room(stop + 1);
    for (sgt_vec2 &w : wanted) { // of a known ray, mostly
        sgt_ray ray = sgt_beam_ray(&beam, g.uniform(-3, 3), g.uniform(-3, 3));
        sgt_trace(r.e.size(), r.e.data(), r.before, &ray, passages.data(), nullptr, nullptr);
        const bool there = passages[stop].hit.status > 0 && !g.chance(0.1);
        w = {there ? passages[stop].hit.p.x : g.uniform(-5, 5),
             there ? passages[stop].hit.p.y : g.uniform(-5, 5)};
        if (g.chance(0.02)) w.x = NAN;
    }
    sgt_aim_options opt = {};
    opt.max_boxes = g.chance(0.1) ? 20 : -1, opt.max_traces = g.chance(0.3) ? 1 + g.below(8) : 60;
    opt.tol = g.chance(0.2) ? g.log_uniform(1e-12, 1e-2) : 0;
    opt.starts = std::size_t(g.below(3)), opt.room = std::size_t(g.below(3));
    for (std::size_t i = 0; i < n * opt.starts; i++) start.push_back({g.uniform(-5, 5), g.uniform(-5, 5)});
    if (opt.starts && g.chance(0.2)) start[std::size_t(g.below(int(start.size())))].x = INFINITY;
    opt.start = start.data();
    std::vector<sgt_attempt> tried(n * opt.room + 1), one(opt.room + 1);
    opt.attempt = tried.data();
    batch b(n, stop + 1);
    std::vector<sgt_aiming> out(n);
    const sgt_aims together = {n, wanted.data(), out.data(), b.passages.data()};
    soil_stack(g.bits());
    const std::size_t met = sgt_aim_batch(stop, r.e.data(), r.before, &beam, &together, room.data(), &opt);
    std::size_t found = 0;
    for (std::size_t i = 0; i < n; i++) {
        sgt_aim_options own = opt;
        own.start = start.data() + i * opt.starts, own.attempt = one.data();
        sgt_aiming w;
        sgt_aim(stop, r.e.data(), r.before, &beam, wanted[i], passages.data(), &own, &w);
        aims++, found += w.status == SGT_MET, met_points += w.status == SGT_MET;
        const sgt_aiming &x = out[i];
        if (x.status != w.status || x.clipped != w.clipped || x.attempts != w.attempts ||
            x.traces != w.traces || x.boxes != w.boxes)
            fail("an aim: status or counts", i, x.attempts, x.status * 1000 + x.traces,
                 w.status * 1000 + w.traces);
        const double got[9] = {x.u,       x.v,       x.point.x, x.point.y, x.miss,
                               x.ray.o.x, x.ray.o.y, x.ray.d.x, x.ray.d.y},
                     is[9] = {w.u,       w.v,       w.point.x, w.point.y, w.miss,
                              w.ray.o.x, w.ray.o.y, w.ray.d.x, w.ray.d.y};
        for (std::size_t k = 0; k < 9; k++) compare("an aim", i, k, got[k], is[k]);
        for (std::size_t k = 0; k < opt.room && k < w.attempts; k++) {
            const sgt_attempt &t = tried[i * opt.room + k], &s = one[k];
            if (t.reason != s.reason || t.fate != s.fate || t.element != s.element || t.traces != s.traces)
                fail("an attempt", i, k, t.reason, s.reason);
            compare("an attempt", i, k, t.from.x, s.from.x), compare("an attempt", i, k, t.from.y, s.from.y);
            compare("an attempt", i, k, t.to.x, s.to.x), compare("an attempt", i, k, t.miss, s.miss);
        }
        for (std::size_t j = 0; w.status == SGT_MET && j <= stop; j++)
            compare_passage("a passage of an aim", b, i, j, passages[j]);
    }
    if (met != found) fail("how many points are met", 0, 0, double(met), double(found));
}

// ------------------------------------------------------------------------- main

static void try_train(generator &g)
{
    train r;
    random_train(g, r);
    const std::size_t n = std::size_t(1 + g.below(200)), m = r.e.size();
    batch b(n, m);
    std::vector<std::vector<sgt_passage>> alone(n, std::vector<sgt_passage>(m));
    for (std::size_t i = 0; i < n; i++) b.set(i, random_ray(g));
    sgt_traced none = {};
    soil_stack(g.bits());
    sgt_trace_batch(m, r.e.data(), r.before, n, b.rays(), none, b.passages.data(), nullptr);
    for (std::size_t i = 0; i < n; i++)
        for (std::size_t j = 0; j < m; j++) {
            const sgt_passages &p = b.passages[j];
            sgt_passage &to = alone[i][j];
            to = {};
            to.hit.status = p.hits.status[i], to.hit.t = p.hits.t[i],
            to.hit.p_err = p.hits.p_err[i];
            to.hit.p = {p.hits.p[0][i], p.hits.p[1][i], p.hits.p[2][i]};
            to.hit.n = {p.hits.n[0][i], p.hits.n[1][i], p.hits.n[2][i]};
            to.direction = {p.direction[0][i], p.direction[1][i], p.direction[2][i]}, to.opl = p.opl[i];
        }
    compare_derivatives(g, r, b, alone);
    compare_aims(g, r);
}

int main()
{
    const char *text = std::getenv("SAGITTA_TEST_SCALE"), *seed = std::getenv("SAGITTA_TEST_SEED");
    const double scale = text ? std::atof(text) : 0.5;
    const unsigned long long first = seed ? std::strtoull(seed, nullptr, 10) : 11;
    const int trains = std::max(40, int(400 * scale));
    std::printf("SAGITTA_TEST_SEED=%llu\n", first);
    for (int i = 0; i < trains; i++) {
        train_seed = first * 1000003 + (unsigned long long)i;
        generator g(train_seed);
        try_train(g);
    }
    std::printf("%d trains: %ld numbers, %ld of them NaN; %ld points, %ld of them met\n", trains, compared,
                same_as_nan, aims, met_points);
    if (compared < 1000L * trains || same_as_nan > compared * 3 / 4 || met_points < aims / 4)
        fail("too few", 0, 0, 0, 0);
    return failures != 0;
}
