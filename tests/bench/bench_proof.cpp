// SPDX-License-Identifier: MIT
// The price of proof: batches and single rays, of surfaces, of the lenses in examples/lenses and of the
// triplet with departures, with proof root and first beside the estimate.
//
//     build/tests/bench/bench_proof [--runs N] [--only TEXT]
//
// About a thousand rays, in the cache.  A run takes half a millisecond of each of the three, in turns, by
// the time of the processor that this thread has had; told are the medians over all runs (N: 61) of the
// estimate's time and of the ratios within a run, which other work on the machine disturbs least.  A
// surface's row has status, t, t_err, p and n for output, a lens's fate, point and direction.
//
// L DECIDES where F = z - s(r^2) is certainly monotone along the ray's chord within the rim,
//     |n| > L sqrt(l^2 + m^2),  L = max |grad s| over the rim,
// which this program works out by itself, at a thousand places between axis and rim; of a lens for each ray
// and element met, with the rim of the surface or the clear aperture.  What is to be reached is 1.1 (root)
// and 1.2 (first) times the estimate on those, on others 3 times or 12 ns, whichever is more; of a mixture
// the mean.  Single rays: 1.5 and 3.
//
// Before the clock starts each answer under proof was compared with the estimate: it has the same status
// and the same t to within both bounds, or is UNPROVEN; the share of those is told.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <string>
#include <vector>
#include <sagitta/surfaces.h>
#include <sagitta/system.h>
#include "bench_clock.h"
#include "proof_lenses.h"

namespace {

using bench::now;

constexpr size_t RAYS = 1000;
constexpr double SLICE = 0.5e6;  // ns

class Random {  // splitmix64: Steele, Lea, Flood, OOPSLA 2014
public:
    double unit()
    {
        uint64_t z = state += 0x9e3779b97f4a7c15u;
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
        return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-53;
    }
    double within(double a, double b) { return a + (b - a) * unit(); }
private:
    uint64_t state = 0x1234567;
};

double median(std::vector<double> a)
{
    std::sort(a.begin(), a.end());
    return (a[(a.size() - 1) / 2] + a[a.size() / 2]) / 2;
}

// ------------------------------------------------------------------ the sags

// |grad s| of a conic with even terms (none: NULL), infinite at the equator and beyond.
double slope_at(double c, double k, const double *a, double r)
{
    double phi2 = 1 - (1 + k) * c * c * r * r, slope = phi2 > 0 ? c / std::sqrt(phi2) : HUGE_VAL, dp = 0;
    for (int i = 7; a && i >= 0; i--)
        dp = dp * r * r + 2 * (i + 1) * a[i];
    return std::fabs(slope + dp) * r;
}

// HUGE_VAL without a rim, and for level sets NaN: it decides nothing.
double steepest(sgt_surface s, double aperture)
{
    double c, k, rim;
    const double *a = nullptr;
    if (s.ops == &sgt_conic_ops) {
        const sgt_conic *q = static_cast<const sgt_conic *>(s.self);
        c = q->c, k = q->k, rim = q->semi_diameter;
    } else if (s.ops == &sgt_even_asphere_ops) {
        const sgt_even_asphere *q = static_cast<const sgt_even_asphere *>(s.self);
        c = q->c, k = q->k, rim = q->semi_diameter, a = q->a;
    } else {
        return NAN;
    }
    if (c == 0 && !a)
        return 0;
    if (rim == 0 || (aperture > 0 && aperture < rim))
        rim = aperture;
    if (rim == 0)
        return HUGE_VAL;
    double most = 0;
    for (int i = 0; i <= 1000; i++)
        most = std::fmax(most, slope_at(c, k, a, rim * i / 1000));
    return most;
}

bool decides(double L, double l, double m, double n)
{
    double side = std::hypot(l, m);
    return side == 0 ? L == L : std::fabs(n) > L * side;
}

// ---------------------------------------------------------------------- rows

const sgt_proof PROOFS[3] = { SGT_ESTIMATE, SGT_PROVE_ROOT, SGT_PROVE_FIRST };

struct Row {
    std::string name;
    bool single, target;
    size_t answers;                // a pass is of so many rays, or rays times surfaces
    double decided;                // the share of them for which L decides
    double unproven[2];            // root, first
    std::function<void(sgt_proof)> pass;
    double ns, ratio[2];           // found
};

struct Arrays {
    explicit Arrays(const std::vector<sgt_ray> &from)
        : n(from.size()), stride((n + 7) / 8 * 8), block(18 * stride + 8), status(n), fate(n)
    {
        double *at = block.data();
        while (reinterpret_cast<uintptr_t>(at) % 64 != 0)
            at++;
        for (int i = 0; i < 6; i++, at += stride)
            in[i] = at;
        for (int i = 0; i < 12; i++, at += stride)
            out[i] = at;
        for (size_t i = 0; i < n; i++) {
            const sgt_ray &r = from[i];
            in[0][i] = r.o.x, in[1][i] = r.o.y, in[2][i] = r.o.z;
            in[3][i] = r.d.x, in[4][i] = r.d.y, in[5][i] = r.d.z;
        }
    }
    sgt_rays rays() const { return { { in[0], in[1], in[2] }, { in[3], in[4], in[5] }, nullptr, nullptr }; }
    sgt_ray ray(size_t i) const
    {
        return {{in[0][i], in[1][i], in[2][i]}, {in[3][i], in[4][i], in[5][i]}, 0, 0};
    }
    sgt_hits hits()
    {
        return {status.data(),
                nullptr,
                out[0],
                out[1],
                nullptr,
                {out[2], out[3], out[4]},
                {out[5], out[6], out[7]},
                nullptr,
                {}};
    }
    sgt_traced traced()
    {
        return {fate.data(), nullptr, {out[0], out[1], out[2]}, {out[3], out[4], out[5]}, nullptr, {}};
    }
    size_t n;
private:
    size_t stride;
    std::vector<double> block;
    double *in[6], *out[12];
public:
    std::vector<sgt_status> status;
    std::vector<sgt_fate> fate;
};

void put(const sgt_hits &h, size_t i, const sgt_hit &hit)
{
    h.status[i] = hit.status;
    h.t[i] = hit.t, h.t_err[i] = hit.t_err;
    h.p[0][i] = hit.p.x, h.p[1][i] = hit.p.y, h.p[2][i] = hit.p.z;
    h.n[0][i] = hit.n.x, h.n[1][i] = hit.n.y, h.n[2][i] = hit.n.z;
}

size_t wrong_answers;

// Counts the UNPROVEN; others must be as the estimate.  (What the estimate left open may be decided under
// no proof either.)
size_t compare(const std::string &name, sgt_status estimate, double t, double t_err, sgt_status status,
               double t2, double t_err2)
{
    if (status == SGT_UNPROVEN)
        return 1;
    if (status != estimate || (status > 0 && !(std::fabs(t - t2) <= t_err + t_err2))) {
        if (wrong_answers++ < 10)
            std::printf("%s: status %d at %.17g under proof, %d at %.17g without\n", name.c_str(), status, t2,
                        estimate, t);
    }
    return 0;
}

// --------------------------------------------------------------- one surface

void add_surface(std::vector<Row> &rows, const std::string &name, sgt_surface s,
                 const std::vector<sgt_ray> &rays, sgt_pick pick, bool target)
{
    Arrays *a = new Arrays(rays), *b = new Arrays(rays);  // to the end of the program
    double L = steepest(s, 0), decided = 0;
    for (const sgt_ray &r : rays)
        decided += decides(L, r.d.x, r.d.y, r.d.z);
    Row row = { name, false, target, a->n, decided / static_cast<double>(a->n), {}, {}, 0, {} };
    row.pass = [=](sgt_proof proof) {
        sgt_options opt = {};
        opt.pick = pick, opt.proof = proof;
        sgt_intersect_batch(s, a->n, a->rays(), a->hits(), &opt);
    };
    Row one = row;
    one.name = name, one.single = true;
    one.pass = [=](sgt_proof proof) {
        sgt_options opt = {};
        opt.pick = pick, opt.proof = proof;
        sgt_hits h = b->hits();
        for (size_t i = 0; i < b->n; i++)
            put(h, i, sgt_intersect(s, b->ray(i), &opt));
    };
    row.pass(SGT_ESTIMATE);
    one.pass(SGT_ESTIMATE);
    const std::vector<sgt_status> estimate = a->status;
    std::vector<double> t(a->hits().t, a->hits().t + a->n), t_err(a->hits().t_err, a->hits().t_err + a->n);
    for (int k = 0; k < 2; k++) {
        size_t unproven = 0;
        row.pass(PROOFS[k + 1]);
        one.pass(PROOFS[k + 1]);
        sgt_hits h = a->hits(), g = b->hits();
        for (size_t i = 0; i < a->n; i++) {
            unproven += compare(name, static_cast<sgt_status>(estimate[i]), t[i], t_err[i],
                                static_cast<sgt_status>(h.status[i]), h.t[i], h.t_err[i]);
            if (h.status[i] != g.status[i] ||
                (h.status[i] > 0 && (h.t[i] != g.t[i] || h.t_err[i] != g.t_err[i])))
                wrong_answers++;
        }
        row.unproven[k] = one.unproven[k] = static_cast<double>(unproven) / static_cast<double>(a->n);
    }
    rows.push_back(row);
    rows.push_back(one);
}

// Through the disk of radius 2.5 in the vertex plane, from 5 in front of it: l and m within +-0.15.
std::vector<sgt_ray> mild()
{
    Random random;
    std::vector<sgt_ray> made;
    while (made.size() < RAYS) {
        double r = 2.5 * std::sqrt(random.unit()), phi = 2 * M_PI * random.unit();
        double l = random.within(-0.15, 0.15), m = random.within(-0.15, 0.15),
               n = std::sqrt(1 - l * l - m * m);
        made.push_back({{r * std::cos(phi) - 5 * l / n, r * std::sin(phi) - 5 * m / n, -5}, {l, m, n}, 0, 0});
    }
    return made;
}

// Through the same disk at 70 to 80 degrees, from 20 away.
std::vector<sgt_ray> shallow()
{
    Random random;
    std::vector<sgt_ray> made;
    while (made.size() < RAYS) {
        double r = 2.5 * std::sqrt(random.unit()), phi = 2 * M_PI * random.unit();
        double angle = random.within(70, 80) * M_PI / 180, turn = 2 * M_PI * random.unit();
        sgt_vec3 d = { std::sin(angle) * std::cos(turn), std::sin(angle) * std::sin(turn), std::cos(angle) };
        made.push_back({{r * std::cos(phi) - 20 * d.x, r * std::sin(phi) - 20 * d.y, -20 * d.z}, d, 0, 0});
    }
    return made;
}

struct Sag { const char *name; double c, k; int terms; };
const Sag SAGS[] = {
    { "plane", 0, 0, 0 },
    { "sphere", 0.1, 0, 0 },
    { "conic", 0.1, -0.6, 0 },
    { "paraboloid", 0.1, -1, 0 },
    { "hyperboloid", -0.1, -3.4, 0 },
    { "asphere-3", 0.1, -0.6, 4 },
    { "asphere-8", 0.1, -0.6, 8 },
};
const double TERMS[8] = { 0, 1e-4, -2e-6, 1e-8, 1e-10, -1e-12, 1e-14, -1e-16 };  // of r^2, r^4, ...

sgt_surface surface_of(const Sag &s, double rim)
{
    if (!s.terms) {
        sgt_conic *made = new sgt_conic;
        *made = { s.c, s.k, rim };
        return { &sgt_conic_ops, made };
    }
    sgt_even_asphere *made = new sgt_even_asphere;
    *made = {};
    made->c = s.c, made->k = s.k, made->semi_diameter = rim;
    std::copy(TERMS, TERMS + s.terms, made->a);
    return { &sgt_even_asphere_ops, made };
}

// ---------------------------------------------------------------- level sets

const sgt_julia JULIA = { { -0.083, 0, -0.83, -0.025 }, {}, {}, {}, {}, 1.8345, 7, 0 };

std::vector<sgt_ray> picture()  // of a camera at (1.2, 0.9, -3.2): every n-th ray
{
    const sgt_vec3 o = { 1.2, 0.9, -3.2 }, d = { -0.47536594, -0.35652446, 1.26764251 };
    const sgt_vec3 right = { 1.24843890, 0.0, 0.46816459 }, up = { -0.08941721, 0.96703057, 0.23844589 };
    std::vector<sgt_ray> made;
    for (int y = 0; y < 30; y++)
        for (int x = 0; x < 40; x++) {
            double u = (x + 0.5) / 40 - 0.5, v = (29 - y + 0.5) / 30 - 0.5;
            sgt_vec3 w = {d.x + u * right.x + v * up.x, d.y + u * right.y + v * up.y,
                          d.z + u * right.z + v * up.z};
            made.push_back({ o, w, 0, 0 });
        }
    return made;
}

// -------------------------------------------------------------------- lenses

void add_lens(std::vector<Row> &rows, const std::string &name, const proof_lens &lens,
              const proof_field &field)
{
    const std::vector<sgt_ray> rays(field.rays, field.rays + field.n);
    Arrays *a = new Arrays(rays), *b = new Arrays(rays);
    const size_t count = lens.count, n = a->n;
    std::vector<double> L;
    for (size_t j = 0; j < count; j++)
        L.push_back(steepest(lens.element[j].surface, lens.element[j].semi_diameter));
    auto trace = [=](size_t i, sgt_proof proof, sgt_passage *passages, sgt_fate *fate, sgt_ray *ray) {
        sgt_options opt = {};
        opt.proof = proof;
        *ray = b->ray(i);
        return sgt_trace(count, lens.element, lens.index, ray, passages, fate, &opt);
    };
    Row row = { name, false, true, n * count, 0, {}, {}, 0, {} };
    row.pass = [=](sgt_proof proof) {
        sgt_options opt = {};
        opt.proof = proof;
        sgt_trace_batch(count, lens.element, lens.index, n, a->rays(), a->traced(), nullptr, &opt);
    };
    size_t met = 0, decided = 0, unproven[2] = {};
    row.pass(SGT_ESTIMATE);
    const std::vector<sgt_fate> estimates = a->fate;
    for (int k = 0; k < 2; k++) {
        row.pass(PROOFS[k + 1]);
        for (size_t i = 0; i < n; i++) {
            std::vector<sgt_passage> of(count), by(count);
            sgt_fate fate, other;
            sgt_ray ray, ray2;
            size_t passed = trace(i, SGT_ESTIMATE, of.data(), &fate, &ray), far = std::min(passed + 1, count);
            size_t passed2 = trace(i, PROOFS[k + 1], by.data(), &other, &ray2);
            if (fate != estimates[i] || other != a->fate[i])
                wrong_answers++;
            for (size_t j = 0; j < far && j <= passed2; j++)
                unproven[k] += compare(name, of[j].hit.status, of[j].hit.t, of[j].hit.t_err, by[j].hit.status,
                                       by[j].hit.t, by[j].hit.t_err);
            for (size_t j = 0; k == 0 && j < far; j++) {
                sgt_vec3 d = j ? of[j - 1].direction : b->ray(i).d;
                const sgt_pose &back = lens.element[j ? j - 1 : 0].pose, &to = lens.element[j].pose;
                if (j && (back.ex.x != 0 || back.ex.y != 0 || back.ex.z != 0))
                    d = {d.x * back.ex.x + d.y * back.ey.x + d.z * back.ez.x,
                         d.x * back.ex.y + d.y * back.ey.y + d.z * back.ez.y,
                         d.x * back.ex.z + d.y * back.ey.z + d.z * back.ez.z};
                if (to.ex.x != 0 || to.ex.y != 0 || to.ex.z != 0)
                    d = {d.x * to.ex.x + d.y * to.ex.y + d.z * to.ex.z,
                         d.x * to.ey.x + d.y * to.ey.y + d.z * to.ey.z,
                         d.x * to.ez.x + d.y * to.ez.y + d.z * to.ez.z};
                met++;
                decided += decides(L[j], d.x, d.y, d.z);
            }
        }
    }
    row.decided = static_cast<double>(decided) / static_cast<double>(met);
    for (int k = 0; k < 2; k++)
        row.unproven[k] = static_cast<double>(unproven[k]) / static_cast<double>(met);
    row.answers = met;
    Row one = row;
    one.single = true;
    one.pass = [=](sgt_proof proof) {
        sgt_traced out = b->traced();
        for (size_t i = 0; i < n; i++) {
            sgt_fate fate;
            sgt_ray ray;
            trace(i, proof, nullptr, &fate, &ray);
            out.fate[i] = fate;
            out.o[0][i] = ray.o.x, out.o[1][i] = ray.o.y, out.o[2][i] = ray.o.z;
            out.d[0][i] = ray.d.x, out.d[1][i] = ray.d.y, out.d[2][i] = ray.d.z;
        }
    };
    rows.push_back(row);
    rows.push_back(one);
}

// The same lens with a departure of some 1e-4 of the clear radius on each curved surface, which has no rim.
template <class Surface>
proof_lens departed(const proof_lens &lens, const sgt_surface_ops *ops, void (*depart)(Surface *, double))
{
    Surface *of = new Surface[lens.count]();
    sgt_element *e = new sgt_element[lens.count];
    proof_lens other = lens;
    other.element = e;
    for (size_t i = 0; i < lens.count; i++) {
        e[i] = lens.element[i];
        const sgt_conic *q = static_cast<const sgt_conic *>(e[i].surface.self);
        if (e[i].surface.ops != &sgt_conic_ops || q->c == 0 || !(e[i].semi_diameter > 0))
            continue;
        of[i].c = q->c;
        depart(&of[i], e[i].semi_diameter);
        e[i].surface = { ops, &of[i] };
    }
    return other;
}

void as_odd_asphere(sgt_odd_asphere *s, double r)
{
    s->a[2] = 1e-4 / (r * r), s->a[3] = -2e-4 / (r * r * r), s->a[5] = 1e-4 / std::pow(r, 5);
}

void as_zernike(sgt_zernike *s, double r)
{
    static const double terms[16] = { 0, 1e-4, -2e-4, 1e-4, 2e-4, -1e-4, 5e-5, -5e-5,
                                      1e-4, 5e-5, -5e-5, 2e-5, 2e-5, 1e-5, -1e-5, 1e-5 };
    double *a = new double[16];
    for (int i = 0; i < 16; i++)
        a[i] = terms[i] * r;
    s->norm = r, s->order = SGT_FRINGE, s->a = { a, 1, 16 };
}

// ---------------------------------------------------------------------- time

void measure(Row &row, int runs)
{
    int times[3];
    for (int k = 0; k < 3; k++) {
        row.pass(PROOFS[k]);
        double start = now(), spent;
        int n = 0;
        do {
            row.pass(PROOFS[k]);
            n++;
            spent = now() - start;
        } while (spent < SLICE);
        times[k] = n;
    }
    std::vector<double> ns[3], ratio[2];
    for (int run = 0; run < runs; run++) {
        double of[3];
        for (int j = 0; j < 3; j++) {
            int k = (j + run) % 3;  // each goes first as often as the others
            double start = now();
            for (int i = 0; i < times[k]; i++)
                row.pass(PROOFS[k]);
            of[k] = (now() - start) / times[k];
        }
        for (int k = 0; k < 3; k++)
            ns[k].push_back(of[k] / static_cast<double>(row.answers));
        for (int k = 0; k < 2; k++)
            ratio[k].push_back(of[k + 1] / of[0]);
    }
    row.ns = median(ns[0]);
    for (int k = 0; k < 2; k++)
        row.ratio[k] = median(ratio[k]);
}

double limit(const Row &row, int k)
{
    const double batch[2] = { 1.1, 1.2 }, single[2] = { 1.5, 3 };
    if (row.single)
        return single[k];
    return row.decided * batch[k] + (1 - row.decided) * std::max(3.0, 12 / row.ns);
}

} // namespace

int main(int argc, char **argv)
{
    int runs = 61;
    const char *only = "";
    for (int i = 1; i + 1 < argc; i += 2) {
        if (std::strcmp(argv[i], "--runs") == 0)
            runs = std::max(1, std::atoi(argv[i + 1]));
        else if (std::strcmp(argv[i], "--only") == 0)
            only = argv[i + 1];
    }
    std::vector<Row> rows;
    auto wanted = [&](const std::string &name) { return name.find(only) != std::string::npos; };
    const std::vector<sgt_ray> few = mild(), slant = shallow();
    struct { const char *name; double rim; const std::vector<sgt_ray> *rays;
    } const WAYS[] = {
        {"rim", 4, &few},
        {"wide rim", 9.99, &few},
        {"no rim", 0, &few},
        {"rim, shallow", 4, &slant},
        {"no rim, shallow", 0, &slant},
    };
    for (const auto &way : WAYS)
        for (const Sag &sag : SAGS)
            for (sgt_pick pick : { SGT_NEAR_SEED, SGT_FIRST }) {
                std::string name = std::string(sag.name) + ", " + way.name + ", " +
                                   (pick == SGT_FIRST ? "first" : "near");
                if (wanted(name))
                    add_surface(rows, name, surface_of(sag, way.rim), *way.rays, pick, true);
            }
    const struct { const char *name, *file;
    } LENSES_OF[] = {
        {"singlet", "aspheric_singlet"}, {"Cassegrain", "cassegrain"}, {"triplet", "cooke_triplet"},
        {"f-theta", "ftheta"},           {"Newtonian", "newtonian"},
        {"toroidal lens", "toroidal_lens"}, {"figured mirror", "figured_mirror"},
    };
    for (const auto &file : LENSES_OF) {
        proof_lens lens = proof_lens_read((std::string(LENSES "/") + file.file + ".yaml").c_str(), RAYS);
        for (size_t i = 0; i < lens.fields; i++) {
            char degrees[20];
            std::snprintf(degrees, sizeof degrees, " %g", lens.field[i].degrees);
            std::string name = std::string("lens ") + file.name + degrees;
            if (wanted(name))
                add_lens(rows, name, lens, lens.field[i]);
            if (std::strcmp(file.name, "triplet") != 0 || i != 1)
                continue;
            const proof_lens odd = departed(lens, &sgt_odd_asphere_ops, as_odd_asphere),
                             zernike = departed(lens, &sgt_zernike_ops, as_zernike);
            if (wanted(name + ", 6 odd aspheres"))
                add_lens(rows, name + ", 6 odd aspheres", odd, lens.field[i]);
            if (wanted(name + ", 6 Zernike sags"))
                add_lens(rows, name + ", 6 Zernike sags", zernike, lens.field[i]);
        }
    }
    if (wanted("julia"))
        add_surface(rows, "julia, N = 7", { &sgt_julia_ops, &JULIA }, picture(), SGT_FIRST, false);
    if (wrong_answers) {
        std::printf("%zu answers are wrong\n", wrong_answers);
        return 1;
    }
    std::printf("%-36s %-6s %8s %8s %8s %8s %6s %6s %6s\n", "", "", "L: %", "open: %", "open: %", "ns",
                "root", "first", "");
    for (Row &row : rows) {
        measure(row, runs);
        std::printf("%-36s %-6s %8.1f %8.2f %8.2f %8.2f %6.2f %6.2f\n", row.name.c_str(),
                    row.single ? "single" : "batch", 100 * row.decided, 100 * row.unproven[0],
                    100 * row.unproven[1], row.ns, row.ratio[0], row.ratio[1]);
        std::fflush(stdout);
    }
    std::printf("\n%-36s %-6s %8s %8s %8s %8s\n", "", "", "root", "to reach", "first", "to reach");
    size_t over[2] = {}, with_target = 0;
    for (const Row &row : rows) {
        if (!row.target)
            continue;
        with_target++;
        bool more = false;
        for (int k = 0; k < 2; k++)
            if (row.ratio[k] > limit(row, k))
                over[k]++, more = true;
        std::printf("%-36s %-6s %8.2f %8.2f %8.2f %8.2f%s\n", row.name.c_str(),
                    row.single ? "single" : "batch", row.ratio[0], limit(row, 0), row.ratio[1], limit(row, 1),
                    more ? "  more" : "");
    }
    std::printf("of %zu rows root is over in %zu, first in %zu\n", with_target, over[0], over[1]);
    return 0;
}
