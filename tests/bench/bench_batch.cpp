// SPDX-License-Identifier: MIT
// Many rays through sgt_intersect_batch and sgt_trace_batch, beside the single ray in a loop, what a
// careful person would write over arrays (bench_peers.c), what one would take ray by ray (bench_shared.h),
// and a plain copy that moves the same bytes: what memory allows.
//
//     build/tests/bench/bench_batch [--benchmark_... of Google Benchmark]
//
// 10^3 rays are in the processor's cache, 10^6 come from memory, and all answers go there.  Arrays follow
// each other in one block, each at a line of the cache; but for the size 1e6-malloc: there they lie as
// separate large mallocs have them, 16 bytes behind the begin of a page, so that a ray's numbers all
// compete for one set of the first cache.
//
// Before the clock starts each variant has answered, and the answer was compared (of 10^6 rays every 17th):
// a batch's with the single ray's, to the last bit; a peer's t, point and gradient within 8e-15, a lens's
// last point and direction within 1e-12.  The repetitions of all are shuffled among each other; the csv has
// the medians, case,variant,ns,per_second, per ray, of a lens per ray and surface.  Behind it stands what
// is to be reached.  Which set of instructions runs is the processor's choice; one built with
// -Dclones=x86-64-v3 shows what AVX2 does.
#include <cstring>
#include <deque>
#include <regex>
#include <sagitta/system.h>
#include "bench_peers.h"
#include "bench_shared.h"

using namespace bench;

namespace {

// ------------------------------------------------------- arrays in and out

struct Size { const char *name; size_t n; bool pages; };
const Size CACHE = {"1e3", 1000, false}, MEMORY = {"1e6", RAYS, false}, PAGES = {"1e6-malloc", RAYS, true};

enum Outputs { T_ALONE, TARGET, EVERYTHING };  // t; status, t, t_err, p, n; all there is

// Arrays of doubles in one block, each beginning with a line of the cache, or 16 bytes behind a page's begin.
class Block {
public:
    Block(size_t arrays, size_t n, bool pages)
        : stride(pages ? (n + 511) / 512 * 512 : (n + 7) / 8 * 8), block(arrays * stride + 514)
    {
        first = block.data();
        while (reinterpret_cast<uintptr_t>(first) % 4096 != 0)
            first++;
        first += pages ? 2 : 0;
    }
    double *next() { return first + stride * taken++; }
private:
    size_t stride, taken = 0;
    std::vector<double> block;
    double *first;
};

size_t compared_every(size_t n) { return n > 1000 ? 17 : 1; }

struct Rays {  // and room for the answers
    Rays(const std::vector<sgt_ray> &from, const Size &size)
        : n(size.n), block(16, n, size.pages), status(n), fate(n), evals(n)
    {
        for (int k = 0; k < 6; k++)
            in[k] = block.next();
        for (double *&array : out)
            array = block.next();
        for (size_t i = 0; i < n; i++) {
            const sgt_ray &ray = from[i];
            in[0][i] = ray.o.x, in[1][i] = ray.o.y, in[2][i] = ray.o.z;
            in[3][i] = ray.d.x, in[4][i] = ray.d.y, in[5][i] = ray.d.z;
        }
    }
    sgt_rays rays() const { return { { in[0], in[1], in[2] }, { in[3], in[4], in[5] }, nullptr, nullptr }; }
    sgt_ray ray(size_t i) const
    {
        return {{in[0][i], in[1][i], in[2][i]}, {in[3][i], in[4][i], in[5][i]}, 0, 0};
    }
    sgt_hits hits(Outputs which)
    {
        sgt_hits h = {};
        h.t = out[0];
        if (which == T_ALONE)
            return h;
        h.status = status.data();
        h.t_err = out[1];
        for (int k = 0; k < 3; k++)
            h.p[k] = out[2 + k], h.n[k] = out[5 + k];
        if (which == EVERYTHING)
            h.evals = evals.data(), h.t_lo = out[8], h.p_err = out[9];
        return h;
    }
    sgt_traced traced()
    {
        return {fate.data(), nullptr, {out[0], out[1], out[2]}, {out[3], out[4], out[5]}, nullptr, {}};
    }
    void forget()
    {
        std::fill(status.begin(), status.end(), static_cast<sgt_status>(77));
        std::fill(fate.begin(), fate.end(), static_cast<sgt_fate>(77));
        std::fill(evals.begin(), evals.end(), -77);
        for (double *array : out)
            std::fill(array, array + n, -77.0);
    }
    size_t n;
private:
    Block block;
    std::vector<sgt_status> status;
    std::vector<sgt_fate> fate;
    std::vector<int> evals;
    double *in[6], *out[10];
};

bool same(double a, double b)
{
    return std::memcmp(&a, &b, sizeof a) == 0 || (std::isnan(a) && std::isnan(b));
}
bool same(const double *const a[3], size_t i, sgt_vec3 b)
{
    return same(a[0][i], b.x) && same(a[1][i], b.y) && same(a[2][i], b.z);
}
double off(const double *const a[3], size_t i, sgt_vec3 b)
{
    return std::max(std::fabs(a[0][i] - b.x), std::max(std::fabs(a[1][i] - b.y), std::fabs(a[2][i] - b.z)));
}

// Of the arrays that there are.
bool same(const sgt_hits &h, size_t i, const sgt_hit &hit)
{
    return same(h.t[i], hit.t) && (!h.status || h.status[i] == hit.status) &&
           (!h.evals || h.evals[i] == hit.evals) && (!h.t_err || same(h.t_err[i], hit.t_err)) &&
           (!h.t_lo || same(h.t_lo[i], hit.t_lo)) && (!h.p_err || same(h.p_err[i], hit.p_err)) &&
           (!h.p[0] || same(h.p, i, hit.p)) && (!h.n[0] || same(h.n, i, hit.n));
}

// ------------------------------------------------------------ one surface

sgt_even_asphere plain(const Case &s) { return Surface(s).asphere; }

struct Work {
    const Case *of;
    Surface built_in;
    sgt_even_asphere formula;
    sgt_surface own;  // what the batch is asked of: the built-in or a user's
    Rays *rays;
    std::vector<double> points;
    size_t evals;     // of all rays
};

template <Outputs which>
void batch(Work &w) { sgt_intersect_batch(w.own, w.rays->n, w.rays->rays(), w.rays->hits(which), nullptr); }

void one_by_one(Work &w)
{
    sgt_hits h = w.rays->hits(TARGET);
    for (size_t i = 0; i < w.rays->n; i++) {
        sgt_hit hit = sgt_intersect(w.own, w.rays->ray(i), nullptr);
        h.status[i] = hit.status;
        h.t[i] = hit.t, h.t_err[i] = hit.t_err;
        h.p[0][i] = hit.p.x, h.p[1][i] = hit.p.y, h.p[2][i] = hit.p.z;
        h.n[0][i] = hit.n.x, h.n[1][i] = hit.n.y, h.n[2][i] = hit.n.z;
    }
}

template <size_t peer>
void by_peer(Work &w)
{
    sgt_hits h = w.rays->hits(TARGET);
    for (size_t i = 0; i < w.rays->n; i++) {
        Answer a = PEERS[peer].solve(*w.of, w.rays->ray(i));
        h.status[i] = std::isnan(a.t) ? SGT_MISS : SGT_HIT;
        h.t[i] = a.t;
        h.p[0][i] = a.p.x, h.p[1][i] = a.p.y, h.p[2][i] = a.p.z;
        h.n[0][i] = a.n.x, h.n[1][i] = a.n.y, h.n[2][i] = a.n.z;
    }
}

void closed_form(Work &w) { peer_closed_form(&w.formula, w.rays->n, w.rays->rays(), w.rays->hits(TARGET)); }
void newton(Work &w) { peer_newton(&w.formula, w.rays->n, w.rays->rays(), w.rays->hits(TARGET)); }
void copy(Work &w) { peer_copy(w.rays->n, w.rays->rays(), w.rays->hits(TARGET)); }
void copy_arrays(Work &w) { peer_copy_arrays(w.rays->n, w.rays->rays(), w.rays->hits(TARGET)); }

// The user's formula by itself, as often as the batch evaluates it, in tiles at the points of the answers.
void formula(Work &w)
{
    double out[4][PEER_TILE];
    for (size_t done = 0, n = w.rays->n; done < w.evals;) {
        size_t at = done % n, here = std::min({ n - at, size_t(PEER_TILE), w.evals - done });
        const double *p = w.points.data() + at;
        peer_own_values.values(w.own.self, here, {{p, p + n, p + 2 * n}}, {out[0], {out[1], out[2], out[3]}});
        benchmark::DoNotOptimize(out);
        done += here;
    }
}

enum Truth {
    SINGLE,
    NEAR,
    NONE
}; // how the answer is compared: with the single ray's, within 8e-15, not at all

struct Variant {
    const char *name;
    void (*pass)(Work &);
    Outputs outputs;
    Truth truth;
    bool conic, asphere, memory;  // can it, is it worth while from memory?
};
const Variant VARIANTS[] = {
    {"batch", batch<TARGET>, TARGET, SINGLE, true, true, true},
    {"batch-t", batch<T_ALONE>, T_ALONE, SINGLE, true, true, true},
    {"batch-everything", batch<EVERYTHING>, EVERYTHING, SINGLE, true, true, true},
    {"one-by-one", one_by_one, TARGET, SINGLE, true, true, true},
    {"closed-form-arrays", closed_form, TARGET, NEAR, true, false, true},
    {"newton-arrays", newton, TARGET, NEAR, false, true, true},
    {PEERS[0].name, by_peer<0>, TARGET, NEAR, true, PEERS[0].asphere, false},
    {PEERS[1].name, by_peer<1>, TARGET, NEAR, true, PEERS[1].asphere, false},
#ifdef HAVE_BOOST
    {PEERS[2].name, by_peer<2>, TARGET, NEAR, true, PEERS[2].asphere, false},
    {PEERS[3].name, by_peer<3>, TARGET, NEAR, true, PEERS[3].asphere, false},
#endif
#ifdef HAVE_GSL
    {PEERS[sizeof PEERS / sizeof PEERS[0] - 1].name, by_peer<sizeof PEERS / sizeof PEERS[0] - 1>, TARGET,
     NEAR, true, true, false},
#endif
    {"copy", copy, TARGET, NONE, true, true, true},
    {"copy-by-array", copy_arrays, TARGET, NONE, true, true, true},
};
const Variant PAGES_VARIANTS[] = { VARIANTS[0], { "copy", copy, TARGET, NONE, true, true, true },
                                   { "copy-by-array", copy_arrays, TARGET, NONE, true, true, true } };

// A user's surface, and what it offers.
struct Own { const char *name; const sgt_surface_ops *ops; };
const Own OWN[] = {
    { "batch", &peer_own_spans },
    { "batch-no-spans", &peer_own_values },
    { "batch-value-alone", &peer_own_value },
};
const Variant OWN_BATCH = { "", batch<TARGET>, TARGET, SINGLE, true, true, false };
const Variant OWN_FORMULA = { "formula", formula, TARGET, NONE, true, true, false };

bool right(const std::string &name, Work &w, const Variant &v)
{
    if (v.truth == NONE)
        return true;
    w.rays->forget();
    v.pass(w);
    sgt_hits h = w.rays->hits(v.outputs);
    size_t wrong = 0;
    for (size_t i = 0; i < w.rays->n; i += compared_every(w.rays->n)) {
        sgt_hit hit = sgt_intersect(v.truth == SINGLE ? w.own : w.built_in.surface(), w.rays->ray(i),
                                    nullptr);
        if (hit.status != SGT_HIT)
            wrong++;
        else if (v.truth == SINGLE)
            wrong += !same(h, i, hit);
        else
            wrong += !(h.status[i] == SGT_HIT && std::fabs(h.t[i] - hit.t) < 8e-15 &&
                       off(h.p, i, hit.p) < 8e-15 && off(h.n, i, hit.n) < 8e-15);
    }
    if (wrong)
        std::printf("%s: %zu rays are wrong\n", name.c_str(), wrong);
    return wrong == 0;
}

// What `values` is called with, beside what the answers say of it.
size_t points_given;
void counted_values(const void *self, size_t n, sgt_points p, sgt_values out)
{
    points_given += n;
    peer_own_spans.values(self, n, p, out);
}

// Fills in evals and the points of the formula's row.
void count(const std::string &name, Work &w)
{
    sgt_surface_ops ops = peer_own_spans;
    ops.values = counted_values;
    sgt_hits h = w.rays->hits(EVERYTHING);
    points_given = 0;
    sgt_intersect_batch({ &ops, w.own.self }, w.rays->n, w.rays->rays(), h, nullptr);
    size_t n = w.rays->n;
    for (size_t i = 0; i < n; i++)
        w.evals += static_cast<size_t>(h.evals[i]);
    for (int k = 0; k < 3; k++)
        w.points.insert(w.points.end(), h.p[k], h.p[k] + n);
    std::printf("%s: %.3f evaluations a ray; `values` was given %.3f points a ray\n", name.c_str(),
                static_cast<double>(w.evals) / static_cast<double>(n),
                static_cast<double>(points_given) / static_cast<double>(n));
}

// ---------------------------------------------------------------- a lens

struct Optic {
    double radius, thickness, index, semi_diameter, k;
    std::vector<double> a;  // even asphere: of r^2, r^4 ...; odd: of r, r^2 ...
};
struct Prescription { const char *name; double pupil; bool odd; std::vector<Optic> optics; };

// M. Laikin, Lens Design, 4th edition (CRC Press 2007), page 251, at the d line: examples/lenses/ftheta.yaml.
const Prescription SCAN = { "scan-lens", 0.5, false, {
    { 0, 5, 1, 0.5, 0, {} },
    { -2.2136, 0.3, 1.84666, 2.0, 0, {} },
    { -2.6575, 0.02, 1, 2.25, 0, {} },
    { -5.5022, 0.5292, 1.84666, 2.5, 0, {} },
    { -3.8129, 4.2927, 1, 2.6, 0, {} },
    { 7.9951, 0.59, 1.84666, 4.05, 0, {} },
    { 8.3651, 18.0014, 1, 4.0, 0, {} },
    { 0, 0, 1, 7.2, 0, {} },
} };

// The same with six aspheres for its six spheres: k = -0.2, and at the rim, r = a, terms of r^4, r^6, r^8 of
// 0.004, -0.002 and 0.0005 a.
Prescription aspheric(const Prescription &spherical)
{
    Prescription made = spherical;
    made.name = "lens-of-aspheres";
    for (Optic &o : made.optics)
        if (o.radius != 0) {
            double a2 = o.semi_diameter * o.semi_diameter, a3 = a2 * o.semi_diameter;
            o.k = -0.2;
            o.a = { 0, 0.004 / a3, -0.002 / (a3 * a2), 0.0005 / (a3 * a2 * a2) };
        }
    return made;
}

// examples/lenses/aspheric_singlet.yaml.
const Prescription SINGLET = { "aspheric-singlet", 9.9, false, {
    { 20, 7, 1.7848059679000448, 10, 0, { -2.248851e-4, -4.690412e-6, -6.404376e-8, 0 } },
    { 0, 21.56201105, 1, 9.5, 0, {} },
    { 0, 0, 1, 1, 0, {} },
} };

// The lens of a telephone's camera, United States Patent 7,535,658: a stop, eight odd aspheres with all terms
// from r^3 to r^10, a plate of glass, the image.
const Prescription PHONE = { "phone-lens", 0.78, true, {
    { 0, 0, 1, 0.79358, 0, {} },
    { 1.962, 1.19, 1.471, 0.938, 1.153,
      { 0, 0, -1.895e-2, 2.426e-2, -5.123e-2, 8.371e-4, 7.850e-3, 4.091e-3, -7.732e-3, -4.265e-3 } },
    { 33.398, 0.93, 1, 1.0837, 39.18,
      { 0, 0, -4.966e-3, -1.434e-2, -6.139e-3, -9.284e-5, 6.438e-3, -5.72e-3, -2.385e-2, 1.108e-2 } },
    { -2.182, 0.75, 1.603, 1.1338, 1.105,
      { 0, 0, -4.388e-2, -2.555e-2, 5.16e-2, -4.307e-2, -2.831e-2, 3.162e-2, 4.630e-2, -4.877e-2 } },
    { -6.367, 0.1, 1, 1.539, 2.382,
      { 0, 0, -1.131e-1, -7.863e-2, 1.094e-1, 6.228e-3, -2.216e-2, -5.89e-3, 4.123e-3, 1.041e-3 } },
    { 5.694, 0.89, 1.51, 1.8254, -222.1,
      { 0, 0, -7.876e-2, 7.02e-2, 1.575e-3, -9.958e-3, -7.322e-3, 6.914e-4, 2.54e-3, -7.65e-4 } },
    { 9.192, 0.16, 1, 2.3978, -0.0669,
      { 0, 0, 9.694e-3, -2.516e-3, -3.606e-3, -2.497e-4, -6.84e-4, -1.414e-4, 2.932e-4, -7.284e-5 } },
    { 1.674, 0.85, 1.51, 2.482, -8.617,
      { 0, 0, 7.429e-2, -6.933e-2, -5.811e-3, 2.396e-3, 2.1e-3, -3.119e-4, -5.552e-5, 7.969e-6 } },
    { 1.509, 0.7, 1, 2.9297, -3.707,
      { 0, 0, 1.767e-3, -4.652e-2, 1.625e-2, -3.522e-3, -7.106e-4, 3.825e-4, 6.271e-5, -2.631e-5 } },
    { 0, 0.4, 1.516, 3.3067, 0, {} },
    { 0, 0.64, 1, 3.4058, 0, {} },
    { 0, 0, 1, 3.691, 0, {} },
} };

// Along the axis, uniform in the pupil, from z = -1.
std::vector<sgt_ray> bundle(double radius)
{
    std::vector<sgt_ray> made(RAYS);
    Random random;
    for (sgt_ray &ray : made) {
        double r = radius * std::sqrt(random.unit()), phi = 2 * M_PI * random.unit();
        ray = { { r * std::cos(phi), r * std::sin(phi), -1 }, { 0, 0, 1 }, 0, 0 };
    }
    return made;
}

struct Lens {
    explicit Lens(const Prescription &from)
        : name(from.name), pupil(from.pupil), odd(from.odd)
    {
        double z = 0;
        for (const Optic &o : from.optics) {
            sgt_even_asphere s = {};
            sgt_odd_asphere t = {};
            s.c = t.c = o.radius != 0 ? 1 / o.radius : 0;
            s.k = t.k = o.k;
            std::copy(o.a.begin(), o.a.end(), odd ? t.a : s.a);
            bool terms = std::any_of(o.a.begin(), o.a.end(), [](double a) { return a != 0; });
            conics.push_back({ s.c, s.k, 0 });
            odds.push_back(t);
            peers.push_back({ s, terms, z, o.index });
            sgt_element e = {};
            e.pose.origin.z = z;
            e.index = o.index;
            e.semi_diameter = o.semi_diameter;
            elements.push_back(e);
            z += o.thickness;
        }
        for (size_t i = 0; i < elements.size(); i++) {
            if (!peers[i].asphere)
                elements[i].surface = { &sgt_conic_ops, &conics[i] };
            else if (odd)
                elements[i].surface = { &sgt_odd_asphere_ops, &odds[i] };
            else
                elements[i].surface = { &sgt_even_asphere_ops, &peers[i].surface };
        }
    }
    Lens(const Lens &) = delete;
    const char *name;
    double pupil;
    bool odd;  // no peer knows it
    std::vector<sgt_element> elements;
    std::vector<peer_element> peers;
private:
    std::vector<sgt_conic> conics;
    std::vector<sgt_odd_asphere> odds;
};

struct Passages {  // everything, of every element
    Passages(size_t elements, size_t n)
        : block(14 * elements, n, false), status(elements * n), evals(elements * n)
    {
        for (size_t k = 0; k < elements; k++) {
            sgt_passages p = {};
            p.hits = {&status[k * n], &evals[k * n], block.next(), block.next(), block.next(), {}, {},
                      block.next(), {}};
            for (int j = 0; j < 3; j++)
                p.hits.p[j] = block.next(), p.hits.n[j] = block.next(), p.direction[j] = block.next();
            p.opl = block.next();
            all.push_back(p);
        }
    }
    std::vector<sgt_passages> all;
private:
    Block block;
    std::vector<sgt_status> status;
    std::vector<int> evals;
};

struct Tracing {
    const Lens *lens;
    Rays *rays;
    Passages *passages;
};

void trace(Tracing &w, const sgt_passages *passages)
{
    sgt_trace_batch(w.lens->elements.size(), w.lens->elements.data(), 1, w.rays->n, w.rays->rays(),
                    w.rays->traced(), passages, nullptr);
}
void trace_batch(Tracing &w) { trace(w, nullptr); }
void trace_everything(Tracing &w) { trace(w, w.passages->all.data()); }
void trace_one_by_one(Tracing &w)
{
    sgt_traced out = w.rays->traced();
    for (size_t i = 0; i < w.rays->n; i++) {
        sgt_ray ray = w.rays->ray(i);
        sgt_fate fate;
        sgt_trace(w.lens->elements.size(), w.lens->elements.data(), 1, &ray, nullptr, &fate, nullptr);
        out.fate[i] = fate;
        out.o[0][i] = ray.o.x, out.o[1][i] = ray.o.y, out.o[2][i] = ray.o.z;
        out.d[0][i] = ray.d.x, out.d[1][i] = ray.d.y, out.d[2][i] = ray.d.z;
    }
}
template <void (*peer)(size_t, const peer_element[], size_t, sgt_rays, sgt_traced)>
void trace_by_peer(Tracing &w)
{
    peer(w.lens->peers.size(), w.lens->peers.data(), w.rays->n, w.rays->rays(), w.rays->traced());
}
void trace_copy(Tracing &w) { peer_copy_traced(w.rays->n, w.rays->rays(), w.rays->traced()); }

struct TraceVariant {
    const char *name;
    void (*pass)(Tracing &);
    Truth truth;  // NEAR: by a peer
    bool memory;
};
const TraceVariant TRACE_VARIANTS[] = {
    { "batch", trace_batch, SINGLE, true },
    { "batch-everything", trace_everything, SINGLE, false },
    { "one-by-one", trace_one_by_one, SINGLE, false },
    { "by-hand", trace_by_peer<peer_trace>, NEAR, false },
    { "by-hand-arrays", trace_by_peer<peer_trace_tiles>, NEAR, true },
    { "copy", trace_copy, NONE, true },
};

bool right(const std::string &name, Tracing &w, const TraceVariant &v)
{
    if (v.truth == NONE)
        return true;
    w.rays->forget();
    v.pass(w);
    sgt_traced out = w.rays->traced();
    size_t wrong = 0, elements = w.lens->elements.size();
    std::vector<sgt_passage> passages(elements);
    for (size_t i = 0; i < w.rays->n; i += compared_every(w.rays->n)) {
        sgt_ray ray = w.rays->ray(i);
        sgt_fate fate;
        sgt_trace(elements, w.lens->elements.data(), 1, &ray, passages.data(), &fate, nullptr);
        bool good = fate == SGT_PASSED && out.fate[i] == fate;
        if (v.truth == SINGLE)
            good = good && same(out.o, i, ray.o) && same(out.d, i, ray.d);
        else
            good = good && off(out.o, i, ray.o) < 1e-12 && off(out.d, i, ray.d) < 1e-12;
        for (size_t k = 0; v.pass == trace_everything && k < elements; k++) {
            const sgt_passages &p = w.passages->all[k];
            good = good && same(p.hits, i, passages[k].hit) && same(p.direction, i, passages[k].direction) &&
                   same(p.opl[i], passages[k].opl);
        }
        wrong += !good;
    }
    if (wrong)
        std::printf("%s: %zu rays are wrong\n", name.c_str(), wrong);
    return wrong == 0;
}

// ------------------------------------------------------------ what to reach

struct Target {
    const char *row;
    double wide, narrow;  // ns with AVX-512, with AVX2; 0: no figure
    const char *peer;     // or: at most `times` the fastest of these
    const char *other;
    double times;
};
const Target TARGETS[] = {
    { "sphere-1e3/batch", 3, 5, nullptr, nullptr, 0 },
    { "paraboloid-1e3/batch", 3, 5, nullptr, nullptr, 0 },
    { "conic-1e3/batch", 3, 5, nullptr, nullptr, 0 },
    { "sphere-1e6/batch", 0, 0, "sphere-1e6/copy", "sphere-1e6/copy-by-array", 1.5 },
    { "paraboloid-1e6/batch", 0, 0, "paraboloid-1e6/copy", "paraboloid-1e6/copy-by-array", 1.5 },
    { "conic-1e6/batch", 0, 0, "conic-1e6/copy", "conic-1e6/copy-by-array", 1.5 },
    { "sphere-1e6-malloc/batch", 0, 0, "sphere-1e6-malloc/copy", "sphere-1e6-malloc/copy-by-array", 1.5 },
    { "asphere-1e3/batch", 5, 8, nullptr, nullptr, 0 },
    { "asphere-1e6/batch", 5, 8, "asphere-1e6/copy", "asphere-1e6/copy-by-array", 0 },
    { "own-conic-1e3/batch", 0, 0, "own-conic-1e3/formula", nullptr, 2 },
    { "own-asphere-1e3/batch", 0, 0, "own-asphere-1e3/formula", nullptr, 2 },
    { "scan-lens-1e3/batch", 4.4, 9, "scan-lens-1e3/by-hand-arrays", nullptr, 0 },
    { "scan-lens-1e6/batch", 4.4, 9, "scan-lens-1e6/by-hand-arrays", nullptr, 0 },
    { "lens-of-aspheres-1e3/batch", 8, 18, "lens-of-aspheres-1e3/by-hand-arrays", nullptr, 0 },
    { "lens-of-aspheres-1e6/batch", 8, 18, "lens-of-aspheres-1e6/by-hand-arrays", nullptr, 0 },
    { "aspheric-singlet-1e3/batch", 8, 18, "aspheric-singlet-1e3/by-hand-arrays", nullptr, 0 },
    { "phone-lens-1e3/batch", 20, 0, nullptr, nullptr, 0 },
    { "phone-lens-1e6/batch", 20, 0, nullptr, nullptr, 0 },
};

// 512: the library for x86-64-v4 runs; 256: that for v3; 0: neither.
int width()
{
    int own = 0;
#if defined(__x86_64__) && defined(__GNUC__)
    __builtin_cpu_init();
    if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") && __builtin_cpu_supports("bmi2"))
        own = 256;
    if (own && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
        __builtin_cpu_supports("avx512cd") && __builtin_cpu_supports("avx512dq") &&
        __builtin_cpu_supports("avx512vl"))
        own = 512;
#endif
    std::printf("the processor has %s; kernels in this build: %s\n",
                own == 512 ? "AVX-512" : own ? "AVX2" : "neither AVX2 nor AVX-512", KERNELS);
    if (std::strstr(KERNELS, "x86-64-v4"))
        return 512;
    if (std::strstr(KERNELS, "x86-64-v3"))
        return 256;
    return std::strstr(KERNELS, "none") ? 0 : own;
}

void print_targets(const Table &table, int vector)
{
    std::printf("\n%-28s %8s %8s %10s %10s\n", "", "ns", "to reach", "of peer", "to reach");
    for (const Target &target : TARGETS) {
        double ns = table.median(target.row), most = vector == 512   ? target.wide
                                                     : vector == 256 ? target.narrow
                                                                     : 0;
        if (std::isnan(ns))
            continue;
        std::printf("%-28s %8.2f", target.row, ns);
        if (most > 0)
            std::printf(" %8.2g", most);
        else
            std::printf(" %8s", "");
        if (target.peer) {
            double peer = table.median(target.peer);
            if (target.other)
                peer = std::fmin(peer, table.median(target.other));
            std::printf(" %10.2f", ns / peer);
        }
        if (target.times > 0)
            std::printf(" %10.2g", target.times);
        std::printf("\n");
    }
}

// What is not asked for is not answered either.  (One that begins with '-' says what to leave out: all are
// answered.)
const char *filter_of(int argc, char **argv)
{
    const char *option = "--benchmark_filter=", *filter = "";
    for (int i = 1; i < argc; i++)
        if (std::strncmp(argv[i], option, std::strlen(option)) == 0)
            filter = argv[i] + std::strlen(option);
    return *filter == '-' ? "" : filter;
}

} // namespace

int main(int argc, char **argv)
{
    int vector = width();
    std::deque<Rays> arrays;
    std::deque<Work> works;
    std::deque<Lens> lenses;
    std::deque<Passages> passages;
    std::deque<Tracing> tracings;
    std::vector<Row> rows;
    bool all_right = true;
    const std::regex filter(filter_of(argc, argv));
    auto wanted = [&](const std::string &name) { return std::regex_search(name, filter); };

    auto add = [&](const std::string &of, const std::string &variant, Work &work, const Variant &v) {
        if (!wanted(of + "/" + variant))
            return;
        all_right &= right(of + "/" + variant, work, v);
        rows.push_back({ of, variant, static_cast<double>(work.rays->n), [&work, &v] { v.pass(work); } });
    };
    auto work = [&](const Case &s, Rays &of) -> Work & {
        works.push_back({ &s, Surface(s), plain(s), {}, &of, {}, 0 });
        works.back().own = works.back().built_in.surface();
        return works.back();
    };

    for (const Size *size : { &CACHE, &MEMORY, &PAGES }) {
        arrays.emplace_back(rays(), *size);
        for (const Case &s : CASES) {
            Work &one = work(s, arrays.back());
            const std::string of = std::string(s.name) + "-" + size->name;
            if (!size->pages) {
                for (const Variant &v : VARIANTS)
                    if ((s.asphere ? v.asphere : v.conic) && (size == &CACHE || v.memory))
                        add(of, v.name, one, v);
            } else if (std::strcmp(s.name, "sphere") == 0) {
                for (const Variant &v : PAGES_VARIANTS)
                    add(of, v.name, one, v);
            }
        }
    }
    for (const Case &s : CASES)
        if (s.k == -0.6) {
            const std::string of = std::string("own-") + s.name + "-" + CACHE.name;
            for (const Own &own : OWN) {
                Work &one = work(s, arrays.front());
                one.own = { own.ops, &one.formula };
                add(of, own.name, one, OWN_BATCH);
                if (&own == OWN) {
                    count(of, one);
                    add(of, "formula", one, OWN_FORMULA);
                }
            }
            add(of, "built-in", work(s, arrays.front()), OWN_BATCH);
        }
    for (const Prescription &from : { SCAN, aspheric(SCAN), SINGLET, PHONE }) {
        lenses.emplace_back(from);
        const Lens &lens = lenses.back();
        const std::vector<sgt_ray> along = bundle(lens.pupil);
        for (const Size *size : { &CACHE, &MEMORY }) {
            arrays.emplace_back(along, *size);
            passages.emplace_back(size == &CACHE ? lens.elements.size() : 0, size->n);
            tracings.push_back({ &lens, &arrays.back(), &passages.back() });
            Tracing &one = tracings.back();
            const std::string of = std::string(lens.name) + "-" + size->name;
            for (const TraceVariant &v : TRACE_VARIANTS)
                if ((size == &CACHE || v.memory) && !(lens.odd && v.truth == NEAR) &&
                    wanted(of + "/" + v.name)) {
                    all_right &= right(of + "/" + v.name, one, v);
                    rows.push_back({of, v.name, static_cast<double>(size->n * lens.elements.size()),
                                    [&one, &v] { v.pass(one); }});
                }
        }
    }
    if (!all_right)
        return 1;

    Table table(rows);
    if (!run(rows, { "--benchmark_repetitions=9", "--benchmark_min_time=0.02" }, argc, argv, table))
        return 2;
    print_targets(table, vector);
    return 0;
}
