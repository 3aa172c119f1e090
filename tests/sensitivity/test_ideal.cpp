// SPDX-License-Identifier: MIT
// Phases among spheres, conics and mirrors: derivatives, told errors and proofs, against 113 bits.
//
// Random rows of surfaces.  Half of the elements have a phase: mirrors too, with a change of index or none,
// tilted and decentred.  Every other phase is an ideal lens: of either sign, of one power or two, from afar
// or not, a few of them on a sphere.  The others are in waves: conics, even aspheres, polynomials, Zernike's,
// and quadrics of x, y and z, on any surface.  Some of the sags are not phases but facets: they have no
// paths.  Of each ray
//
//     sgt_trace_gradient and sgt_trace_sensitivity   agree with differences of slow_trace.h
//     sgt_trace_error                                 is not less than the error, and not absurdly large
//     sgt_aim                                         meets points that are met, and never denies them
//
// (Batches with phases are in tests/batch/test_trace_batch.c.)
//
// SAGITTA_TEST_SCALE multiplies the systems; SAGITTA_TEST_SEED replaces the seed.
#include "slow_trace.h"
#include "../oracle/cases.h"

#include <sagitta/aim.h>

#include <algorithm>
#include <cstdlib>

using namespace slow;

static int failures;
static unsigned long long system_seed;

static void fail(const char *what, double a, double b, double got, double wanted)
{
    if (failures++ < 20)
        std::printf("FAIL %s (%g, %g): %.17g, should be %.17g; system %llu\n", what, a, b, got, wanted,
                    system_seed);
}

// ------------------------------------------------------------------ a system

// What the functions of phases in waves are made of.
struct function {
    sgt_conic conic;
    sgt_even_asphere asphere;
    sgt_polynomial_xy polynomial;
    sgt_zernike zernike;
    sgt_quadric quadric;
    double a[9];
};

struct row {
    std::vector<sgt_conic> conic;
    std::vector<sgt_phase> phase;
    std::vector<function> waves;
    std::vector<sgt_element> e;
    double before, size;
};

// A phase whose G is some tenths at r = size / 2.
static void random_waves(sgt_phase *p, function *f, double size, oracle::generator &random)
{
    *p = {}, *f = {};
    const bool facets = random.chance(0.25);
    p->kind = facets ? SGT_FACETS : SGT_PHASE_SAG;
    p->per_wave = random.sign() * size * random.log_uniform(1e-6, 1e-2);
    if (facets) p->per_wave = 1;                               // not read; slopes of some tenths
    const double by = random.uniform(-0.3, 0.3) / p->per_wave; // of the gradient at r = size
    for (double &a : f->a) a = random.uniform(-0.3, 0.3) / p->per_wave;
    switch (random.below(facets ? 4 : 5)) {
    case 0:
        f->conic = {by / size, 1e-9, 0};
        f->conic.k = -1 - random.uniform(0, 1) / (1 + std::fabs(by)); // defined everywhere
        p->waves = {&sgt_conic_ops, &f->conic};
        break;
    case 1:
        f->asphere.a[0] = by / size, f->asphere.a[1] = f->a[1] / std::pow(size, 3);
        f->asphere.a[3] = f->a[2] / std::pow(size, 7);
        p->waves = {&sgt_even_asphere_ops, &f->asphere};
        break;
    case 2:
        for (int i = 0; i < 9; i++) f->a[i] /= std::pow(size, i / 3 + i % 3 - 1);
        f->polynomial.a = {f->a, 3, 3};
        if (random.chance(0.3)) f->polynomial.a.columns = 2, f->polynomial.a.rows = 1; // a grating
        p->waves = {&sgt_polynomial_xy_ops, &f->polynomial};
        break;
    case 3:
        for (double &a : f->a) a *= 0.2 * size;
        f->zernike.norm = size, f->zernike.order = random.chance(0.5) ? SGT_NOLL : SGT_FRINGE;
        f->zernike.a = {f->a, 1, 9};
        p->waves = {&sgt_zernike_ops, &f->zernike};
        break;
    default:
        p->kind = SGT_PHASE_FUNCTION;
        for (int i = 0; i < 3; i++) {
            f->quadric.squares[i] = f->a[i] / (3 * size), f->quadric.products[i] = f->a[3 + i] / (3 * size);
            f->quadric.linear[i] = f->a[6 + i] / 3;
        }
        p->waves = {&sgt_quadric_ops, &f->quadric};
    }
}

static row random_row(oracle::generator &random)
{
    row r;
    const std::size_t count = std::size_t(2 + random.below(5));
    const double size = r.size = random.log_uniform(1e-2, 1e3);
    r.conic.resize(count), r.phase.resize(count), r.waves.resize(count);
    r.before = random.chance(0.5) ? 1 : random.uniform(1, 1.7);
    double z = 0, way = 1;
    bool any = false;
    for (std::size_t i = 0; i < count; i++) {
        sgt_element e = {};
        const bool last = i + 1 == count, phase = !last && (random.chance(0.5) || (i + 2 == count && !any));
        const bool ideal = phase && random.chance(0.5);
        const bool flat = last ? random.chance(0.7) : ideal ? random.chance(0.9) : random.chance(0.1);
        r.conic[i] = {flat ? 0 : random.sign() / (size * random.uniform(3, 20)),
                      random.chance(0.5) ? 0 : random.uniform(-1.5, 0.5), 0};
        e.surface = {&sgt_conic_ops, &r.conic[i]};
        e.index = last || random.chance(0.3) ? 0 : random.chance(0.2) ? SGT_MIRROR : random.uniform(1, 1.9);
        if (ideal) {
            r.phase[i] = {};
            r.phase[i].kind = SGT_IDEAL_LENS;
            r.phase[i].focal_length = random.sign() * size * random.log_uniform(2, 100);
            if (random.chance(0.3)) // of two powers
                r.phase[i].focal_length_y =
                    random.chance(0.3) ? double(INFINITY) : random.sign() * size * random.log_uniform(2, 100);
            if (r.phase[i].focal_length_y != 0 && random.chance(0.5))
                std::swap(r.phase[i].focal_length, r.phase[i].focal_length_y);
            if (random.chance(0.6))
                r.phase[i].object_distance = random.sign() * size * random.log_uniform(1, 100);
            e.phase = &r.phase[i], any = true;
        }
        if (phase && !ideal) {
            random_waves(&r.phase[i], &r.waves[i], size, random);
            e.phase = &r.phase[i], any = true;
        }
        const double aside = random.chance(0.5) ? 0 : 0.1 * size, tilt = random.chance(0.5) ? 0 : 10;
        const sgt_vec3 origin = {random.uniform(-aside, aside), random.uniform(-aside, aside), z};
        if (tilt > 0)
            e.pose = sgt_pose_tilted(origin, {random.uniform(-tilt, tilt), random.uniform(-tilt, tilt),
                                              random.uniform(-180, 180)});
        else e.pose.origin = origin;
        r.e.push_back(e);
        if (e.index == SGT_MIRROR) way = -way;
        z += way * size * random.uniform(0.2, 4);
    }
    return r;
}

static bool has_paths(const row &r)
{
    for (const sgt_element &e : r.e)
        if (e.phase && e.phase->kind == SGT_FACETS) return false;
    return true;
}

static sgt_ray random_ray(const row &r, oracle::generator &random)
{
    const double size = r.size, far = random.log_uniform(1, 100) * size;
    const double x = random.uniform(-1, 1) * 0.5 * size, y = random.uniform(-1, 1) * 0.5 * size,
                 u = random.uniform(-0.2, 0.2), v = random.uniform(-0.2, 0.2),
                 long_by = random.chance(0.5) ? 1 : random.log_uniform(0.1, 10);
    return {{x - u * far, y - v * far, -far}, {u * long_by, v * long_by, long_by}, 0, 0};
}

static std::vector<element> slow_of(const row &r)
{
    std::vector<element> e;
    for (const sgt_element &one : r.e) e.push_back(element_of(one));
    return e;
}

// -------------------------------------------------------------- derivatives

static double &component(sgt_ray_change &c, std::size_t i)
{
    double *const all[7] = {&c.p.x, &c.p.y, &c.p.z, &c.d.x, &c.d.y, &c.d.z, &c.opl};
    return *all[i];
}

static long derivatives, by_phases;
static double worst_derivative;

// Number j of sgt_trace_parameters, and a unit of it; NULL where it is none.
static quad *number(std::vector<element> &e, quad &before, vec &o, vec &d, std::size_t j, double size,
                    double *unit)
{
    quad *const launch[7] = {&o.x, &o.y, &o.z, &d.x, &d.y, &d.z, &before};
    *unit = j < 3 ? size : 1;
    if (j < 7) return launch[j];
    j -= 7;
    for (element &one : e) {
        *unit = j == 0 ? 1 / size : 1;
        if (j < 2) return &one.a[j]; // the curvature and the conic constant
        j -= 2;
        vec &q = one.origin, &w = one.turn;
        quad *const own[7] = {&q.x, &q.y, &q.z, &w.x, &w.y, &w.z, &one.index};
        *unit = j < 3 ? size : 1;
        if (j == 6 && !(one.index > 0)) return nullptr;
        if (j < 7) return own[j];
        j -= 7;
    }
    return nullptr;
}

static void compare_derivatives(const row &r, const sgt_ray &launch, const std::vector<sgt_passage> &passages)
{
    const std::size_t n = r.e.size(), count = sgt_trace_parameters(n, r.e.data());
    std::vector<double> gradient(7 * count);
    sgt_ray_change weight[7] = {}, forward[6] = {};
    for (std::size_t i = 0; i < 7; i++) component(weight[i], i) = 1;
    for (std::size_t i = 0; i < 6; i++) component(forward[i], i) = 1;
    int lacks = sgt_trace_gradient(n, r.e.data(), r.before, &launch, passages.data(), 7, weight,
                                   gradient.data());
    lacks |= sgt_trace_sensitivity(n, r.e.data(), r.before, &launch, passages.data(), 6, forward, forward);
    if (lacks) fail("lacks", 0, 0, lacks, 0);
    std::vector<element> e = slow_of(r);
    quad before = r.before;
    vec o = of(launch.o), d = of(launch.d);
    for (std::size_t j = 0; j < count; j++) {
        double unit;
        quad *a = number(e, before, o, d, j, r.size, &unit);
        if (!a) {
            for (std::size_t i = 0; i < 7; i++)
                if (gradient[i * count + j] != 0)
                    fail("no number", double(i), double(j), gradient[i * count + j], 0);
            continue;
        }
        const quad was = *a, h = quad(unit) * quad(1e-11);
        *a = was + h;
        const end up = trace(e, n, before, o, d);
        *a = was - h;
        const end down = trace(e, n, before, o, d);
        *a = was;
        if (up.passed != n || down.passed != n) continue; // at an edge
        const quad s = quad(0.5) / h;
        const vec p = s * (up.p - down.p), q = s * (up.d - down.d);
        const double by[7] = {to_double(p.x), to_double(p.y), to_double(p.z), to_double(q.x),
                              to_double(q.y), to_double(q.z), to_double(s * (up.opl - down.opl))};
        const double sizes[3] = {to_double(length(p)), to_double(length(q)), std::fabs(by[6])};
        for (std::size_t i = 0; i < (has_paths(r) ? 7u : 6u); i++) {
            // the path is a sum of terms that cancel by Fermat's principle: of the size of the others
            const double all = i / 3 < 2 ? sizes[i / 3] : sizes[2] + sizes[0] + r.size / unit,
                         nothing = (i < 3 || i == 6 ? r.size : 1) / unit * 1e-3;
            const double got = gradient[i * count + j], off = std::fabs(got - by[i]) / (all + nothing);
            derivatives++, worst_derivative = std::max(worst_derivative, off);
            if (!(off <= 1e-9)) fail("gradient", double(i), double(j), got, by[i]);
            if (j >= 6) continue;
            const double x = component(forward[j], i);
            if (!(std::fabs(x - by[i]) <= 1e-9 * (all + nothing)))
                fail("forward", double(i), double(j), x, by[i]);
        }
    }
}

// By the numbers of the phases.
static void compare_phases(const row &r, const sgt_ray &launch, const std::vector<sgt_passage> &passages)
{
    const std::size_t n = r.e.size(), count = sgt_phase_parameters(n, r.e.data()),
                      rows = has_paths(r) ? 7 : 6;
    std::vector<double> gradient(7 * count);
    sgt_ray_change weight[7] = {};
    for (std::size_t i = 0; i < 7; i++) component(weight[i], i) = 1;
    const int lacks =
        sgt_phase_gradient(n, r.e.data(), r.before, &launch, passages.data(), rows, weight, gradient.data());
    if (lacks) fail("phases lack", 0, 0, lacks, 0);
    const std::vector<element> e = slow_of(r);
    std::size_t j = 0;
    for (const sgt_element &one : r.e) {
        if (!one.phase) continue;
        const sgt_phase &a = *one.phase;
        const bool ideal = a.kind == SGT_IDEAL_LENS, facets = a.kind == SGT_FACETS;
        const int m = ideal ? 3 : 1 + int(sgt_parameters(a.waves));
        for (int k = 0; k < m; k++, j++) {
            const double sizes[3] = {a.focal_length, a.focal_length_y, a.object_distance};
            const bool none = (ideal && (sizes[k] == 0 || std::isinf(sizes[k]))) || (facets && k == 0);
            // a step that moves the end by some 1e-10 of its size, if the derivative is what is said
            double most = 0;
            for (std::size_t i = 0; i < rows; i++) {
                const double got = std::fabs(gradient[i * count + j]) / (i < 3 || i == 6 ? r.size : 1);
                most = std::max(most, got);
            }
            const std::vector<double> own = ideal ? std::vector<double>() : catalogue::parameters_of(a.waves);
            const double number = std::fabs(ideal ? sizes[k] : k == 0 ? a.per_wave : own[std::size_t(k - 1)]);
            double step = 1e-10 / (most > 0 ? most : 1);
            if (number != 0) step = std::min(step, 1e-7 * number); // far from linear beyond
            if (number == 0 && k < 3)
                step = std::min(step, 1e-7 / (k == 1 ? r.size : 1)); // a curvature, a conic constant
            const quad h = none ? quad(0) : quad(step);
            moved = {&a, ideal ? k : k - 1, h};
            const end up = trace(e, n, r.before, of(launch.o), of(launch.d));
            moved.by = -h;
            const end down = trace(e, n, r.before, of(launch.o), of(launch.d));
            moved = {nullptr, 0, 0};
            if (up.passed != n || down.passed != n) continue;
            if (facets && one.index == 0) continue; // they do nothing, and roundings are what is told
            if (!none && most * step < 1e-20) {     // too little for differences: there is none either
                const double by_step =
                    to_double(length(up.p - down.p)) / r.size + to_double(length(up.d - down.d));
                if (!(by_step < 1e-18))
                    fail("a phase that seems to do nothing", double(j), double(k), most, by_step);
                continue;
            }
            const quad s = none ? quad(0) : quad(0.5) / h;
            const vec p = s * (up.p - down.p), q = s * (up.d - down.d);
            const double by[7] = {to_double(p.x),
                                  to_double(p.y),
                                  to_double(p.z),
                                  to_double(q.x),
                                  to_double(q.y),
                                  to_double(q.z),
                                  to_double(s * (up.opl - down.opl))};
            const double all[3] = {to_double(length(p)), to_double(length(q)),
                                   std::fabs(by[6]) + to_double(length(p))};
            for (std::size_t i = 0; i < rows; i++) {
                double nothing = (i < 3 || i == 6 ? r.size : 1) * (most > 0 ? most : 1) * 1e-3;
                if (ideal && k == 2 && !none)
                    nothing += 1e-3 * std::pow(r.size / number, 2); // a difference of two terms
                const double got = gradient[i * count + j],
                             off = std::fabs(got - by[i]) / (all[i / 3] + nothing);
                by_phases++, worst_derivative = std::max(worst_derivative, off);
                if (!(off <= 1e-9)) fail("by a phase", double(i), double(k), got, by[i]);
            }
        }
    }
}

// -------------------------------------------------------------------- errors

struct spread {
    std::vector<double> part, ratio; // of the told error; told by what is to be expected of doubles
    void add(double error, double told, double grain)
    {
        part.push_back(told > 0 ? error / told : error > 0 ? HUGE_VAL : 0), ratio.push_back(told / grain);
    }
    void print(const char *what)
    {
        std::sort(part.begin(), part.end()), std::sort(ratio.begin(), ratio.end());
        const std::size_t n = part.size();
        if (n == 0) return fail(what, 0, 0, 0, 1);
        std::printf("%s: %zu, error by told error: median %.2g, 99 %% %.2g, most %.3g; told by an ulp of the "
                    "numbers: median %.2g, 99 %% %.3g\n",
                    what, n, part[n / 2], part[n * 99 / 100], part[n - 1], ratio[n / 2], ratio[n * 99 / 100]);
        if (!(part[n - 1] <= 1)) fail(what, 0, 0, part[n - 1], 1);
        if (!(part[n / 2] >= 1e-3)) fail("the told error is absurdly large", 0, 0, part[n / 2], 1e-3);
    }
};

static spread of_point, of_path;

static void compare_errors(const row &r, const sgt_ray &launch, const std::vector<sgt_passage> &passages,
                           const end &is)
{
    const std::size_t n = r.e.size();
    sgt_end_error told;
    if (!sgt_trace_error(n, r.e.data(), r.before, &launch, passages.data(), &told))
        fail("no error", 0, 0, 0, 1);
    const bool paths = has_paths(r);
    if (!paths && !(std::isnan(told.path) && std::isnan(passages[n - 1].opl)))
        fail("a path behind facets", told.path, 0, passages[n - 1].opl, 0);
    if (!(told.point < HUGE_VAL && (!paths || (told.path < HUGE_VAL && told.path_grain < HUGE_VAL))))
        fail("an error is not finite", told.point, told.grain, told.path, 0);
    const sgt_passage &last = passages[n - 1];
    const quad x = last.hit.p.x - is.p.x, y = last.hit.p.y - is.p.y;
    const vec by = of(last.hit.p) - is.p;
    // in front of the last element, in its frame: both rays, whose foot from the exact point is compared
    const std::vector<element> e = slow_of(r);
    const vec in = e[n - 1].local(e[n - 2].global(of(passages[n - 2].direction)));
    double index = r.before;
    for (std::size_t i = 0; i + 1 < n; i++)
        if (r.e[i].index > 0) index = r.e[i].index;
    const double path = to_double(magnitude(last.opl - is.opl - index * inner(by, in)));
    const double size = 1.1e-16 * r.size;
    of_point.add(to_double(square_root(x * x + y * y)), told.point, size);
    if (paths) of_path.add(path, told.path, size);
}

// ------------------------------------------------------------------- aiming

static long met, none, undecided, asked, denied;

// A point that a ray of the beam meets: found; and not said to be none by the proof alone.
static void compare_aim(const row &r, const sgt_ray &launch, oracle::generator &random)
{
    const std::size_t n = r.e.size();
    std::size_t stop = std::size_t(1 + random.below(int(n) - 1));
    std::vector<sgt_passage> passages(n);
    const double half = 0.5 * r.size, u = random.uniform(-half, half), v = random.uniform(-half, half);
    sgt_beam beam = {};
    beam.o = launch.o, beam.d = launch.d, beam.ou = {1, 0, 0}, beam.ov = {0, 1, 0};
    if (random.chance(0.5)) {
        const double by = 0.3 / (r.size * random.uniform(1, 5));
        beam.ou = beam.ov = {0, 0, 0}, beam.du = {by, 0, 0}, beam.dv = {0, by, 0};
    }
    sgt_ray ray = sgt_beam_ray(&beam, u, v);
    if (sgt_trace(stop + 1, r.e.data(), r.before, &ray, passages.data(), nullptr, nullptr) < stop ||
        passages[stop].hit.status <= 0)
        return;
    const double wide = random.log_uniform(1e-5, 0.5) * r.size;
    beam.u = {u - random.uniform(0.01, 1) * wide, u + random.uniform(0.01, 1) * wide};
    beam.v = {v - random.uniform(0.01, 1) * wide, v + random.uniform(0.01, 1) * wide};
    const sgt_vec2 wanted = {passages[stop].hit.p.x, passages[stop].hit.p.y};
    sgt_aiming a;
    sgt_aim_options alone = {};
    const sgt_vec2 start = {1e9, 1e9};
    alone.max_traces = 1, alone.start = &start, alone.starts = 1, alone.max_boxes = 200;
    asked++;
    if (sgt_aim(stop, r.e.data(), r.before, &beam, wanted, passages.data(), &alone, &a) == SGT_NO_SUCH_RAY)
        fail("a known ray is said not to be", u, v, 0, 1);
    sgt_aim(stop, r.e.data(), r.before, &beam, wanted, passages.data(), nullptr, &a);
    met += a.status == SGT_MET, none += a.status == SGT_NO_SUCH_RAY, undecided += a.status < 0;
    if (a.status == SGT_NO_SUCH_RAY) fail("a known ray is said not to be", u, v, 0, 2);
    if (a.status == SGT_MET) {
        const end is = trace(slow_of(r), stop + 1, r.before, of(a.ray.o), of(a.ray.d), true);
        const quad x = is.p.x - wanted.x, y = is.p.y - wanted.y;
        const double off = to_double(square_root(x * x + y * y));
        if (!(off <= a.miss)) fail("the miss", u, v, off, a.miss);
    }
    // far beside all that the box reaches: mostly proven
    const sgt_vec2 beside = {wanted.x + 20 * r.size + 1e3 * std::fabs(wanted.x), wanted.y};
    alone.max_boxes = 0;
    sgt_aim(stop, r.e.data(), r.before, &beam, beside, passages.data(), &alone, &a);
    denied += a.status == SGT_NO_SUCH_RAY;
    if (a.status == SGT_NO_SUCH_RAY)
        for (int i = 0; i < 20; i++) {
            const sgt_ray other = sgt_beam_ray(&beam, random.uniform(beam.u.lo, beam.u.hi),
                                               random.uniform(beam.v.lo, beam.v.hi));
            const end is = trace(slow_of(r), stop + 1, r.before, of(other.o), of(other.d), true);
            if (!is.why && magnitude(is.p.x - beside.x) + magnitude(is.p.y - beside.y) < 1e-9 * r.size)
                fail("there is such a ray", u, v, 0, 0);
        }
}

int main()
{
    const char *text = std::getenv("SAGITTA_TEST_SCALE"), *seed = std::getenv("SAGITTA_TEST_SEED");
    const double scale = text ? std::atof(text) : 0.5;
    const unsigned long long first = seed ? std::strtoull(seed, nullptr, 10) : 7;
    const int systems = std::max(50, int(1500 * scale));
    long rays = 0;
    std::printf("SAGITTA_TEST_SEED=%llu\n", first);
    for (int i = 0; i < systems; i++) {
        system_seed = first * 1000003 + (unsigned long long)i;
        oracle::generator random(system_seed);
        row r = random_row(random);
        for (int j = 0; j < 4; j++) {
            const sgt_ray launch = random_ray(r, random);
            const std::size_t n = r.e.size();
            std::vector<sgt_passage> passages(n);
            sgt_ray ray = launch;
            if (sgt_trace(n, r.e.data(), r.before, &ray, passages.data(), nullptr, nullptr) != n) continue;
            double slope = 1; // of the steepest incidence: near grazing all is large
            for (const sgt_passage &p : passages) slope = std::min(slope, std::fabs(p.direction.z));
            const end is = trace(slow_of(r), n, r.before, of(launch.o), of(launch.d));
            if (is.passed != n || slope < 0.1) continue;
            const vec off = of(passages[n - 1].hit.p) - is.p;
            if (!(to_double(length(off)) < 1e-3 * r.size)) continue; // the other root of a conic
            rays++;
            compare_errors(r, launch, passages, is);
            if (j == 0) compare_derivatives(r, launch, passages), compare_phases(r, launch, passages);
            if (j == 0) compare_aim(r, launch, random);
        }
    }
    std::printf("%ld rays of %d systems; %ld derivatives, %ld by phases, off by %.2g at most\n", rays,
                systems, derivatives, by_phases, worst_derivative);
    of_point.print("point"), of_path.print("path");
    std::printf("%ld points that are met: %ld found, %ld undecided; %ld beside: %ld proven\n", asked, met,
                undecided, asked, denied);
    if (rays < systems || met < asked * 9 / 10 || denied < asked / 2)
        fail("too few", double(rays), double(met), double(denied), 0);
    return failures != 0;
}
