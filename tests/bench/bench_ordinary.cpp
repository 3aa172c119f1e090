// SPDX-License-Identifier: MIT
// Ordinary input: what a user gives who sets nothing, beside the same with a rim, or away from the case.
//
//     build/tests/bench/bench_ordinary [--quick] [--only TEXT] [--list]
//     build/tests/bench/bench_ordinary --drawn [SEED] [--quick] [--list]
//     build/tests/bench/bench_ordinary --search [--seconds N] [--seed S] [--type T] [--brief]
//     build/tests/bench/bench_ordinary --case "type=... ..."
//
// The first prints the tables of docs/data/ordinary.md, as markdown (--only: the rows whose name has TEXT;
// --list: and what becomes of the rays where the two sides differ in it).  The second draws fifty random
// sags and compares each without a rim with itself with one (--list: tells all of them).
// docs/ordinary_table.py puts both into the page.  The third and the fourth look for the worst that there is
// (cliff_search.cpp).
//
// Each line has two sides: the input that is asked about, and its neighbour.  They take turns, a slice of
// about 0.3 ms each, by the time of the processor that this thread has had.  All lines of a table are
// shuffled among each other from turn to turn.  Told are the medians of each side in ns per ray, and the
// median of the ratios within a turn, which other work on the machine disturbs least.  A ratio above 3 is
// in bold face.
//
// Batches have status, t, t_err, p and n for output; traces fate, point and direction.  Before the clock
// starts the first 200 rays of each side are compared with the single ray, to the last bit.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>
#include <sagitta/formula.h>
#include <sagitta/surfaces.h>
#include <sagitta/system.h>
#include "bench_clock.h"
#include "bench_subjects.h"
#include "cliff_search.h"

using namespace bench;
using namespace bench::catalogue;

namespace {

using bench::now;

constexpr size_t N = 1000, FEW = 200,
                 HUNDRED = 100;  // rays of a batch, of a loop over single rays, of a small batch
constexpr double CLIFF = 3;
double slice = 0.3e6;  // ns
int most_turns = 21;
double most_time = 0.25e9;  // ns, of one line; it has three turns at least

double median(std::vector<double> a)
{
    if (a.empty())
        return NAN;
    std::sort(a.begin(), a.end());
    return (a[(a.size() - 1) / 2] + a[a.size() / 2]) / 2;
}

std::string digits(double x, int n = 3)  // of them; no exponent
{
    char text[32];
    if (std::isnan(x))
        return "-";
    std::snprintf(text, sizeof text, "%.*f", x < 1 ? n : x < 10 ? n - 1 : x < 100 && n > 2 ? n - 2 : 0, x);
    return text;
}

// ------------------------------------------------------------------- rays

struct Arrays {
    explicit Arrays(const std::vector<sgt_ray> &from)
        : n(from.size()), in(8, std::vector<double>(n)), out(8, std::vector<double>(n)), status(n)
    {
        for (size_t i = 0; i < n; i++) {
            const sgt_ray &r = from[i];
            const double x[] = { r.o.x, r.o.y, r.o.z,  r.d.x,
                                 r.d.y, r.d.z, r.tmin, r.tmax == 0 && r.tmin == 0 ? INFINITY : r.tmax };
            for (size_t k = 0; k < 8; k++)
                in[k][i] = x[k];
        }
    }
    sgt_rays rays(size_t i = 0) const
    {
        const double *p[8];
        for (size_t k = 0; k < 8; k++)
            p[k] = &in[k][i];
        return { { p[0], p[1], p[2] }, { p[3], p[4], p[5] }, p[6], p[7] };
    }
    sgt_ray ray(size_t i) const
    {
        return { { in[0][i], in[1][i], in[2][i] }, { in[3][i], in[4][i], in[5][i] }, in[6][i], in[7][i] };
    }
    sgt_hits hits(size_t i = 0)
    {
        return { &status[i],
                 nullptr,
                 &out[0][i],
                 &out[1][i],
                 nullptr,
                 { &out[2][i], &out[3][i], &out[4][i] },
                 { &out[5][i], &out[6][i], &out[7][i] },
                 nullptr,
                 {} };
    }
    sgt_traced traced()
    {
        return { reinterpret_cast<sgt_fate *>(&status[0]), // one byte, as a status is
                 nullptr,
                 { &out[0][0], &out[1][0], &out[2][0] },
                 { &out[3][0], &out[4][0], &out[5][0] },
                 nullptr,
                 {} };
    }
    size_t n;
    std::vector<std::vector<double>> in, out;
    std::vector<sgt_status> status;
};

std::vector<sgt_ray> bundle(size_t n)
{
    return std::vector<sgt_ray>(rays().begin(), rays().begin() + static_cast<long>(n));
}

sgt_ray moved(sgt_ray ray, double t)
{
    ray.o = { ray.o.x + t * ray.d.x, ray.o.y + t * ray.d.y, ray.o.z + t * ray.d.z };
    return ray;
}

template <class Of> std::vector<sgt_ray> each(std::vector<sgt_ray> all, Of of)
{
    for (sgt_ray &ray : all)
        ray = of(ray);
    return all;
}

// ------------------------------------------------------------------ sides

bool same(double a, double b)
{
    return std::memcmp(&a, &b, sizeof a) == 0 || (std::isnan(a) && std::isnan(b));
}

sgt_options picking(sgt_pick pick)
{
    sgt_options opt = {};
    opt.pick = pick;
    return opt;
}

struct Side {  // rays, and the surface or the lens that they meet
    Side(sgt_surface s, const std::vector<sgt_ray> &rays) : surface(s), arrays(std::make_shared<Arrays>(rays))
    {}
    Side(const std::vector<sgt_element> &e, const std::vector<sgt_ray> &rays)
        : surface(), lens(e), arrays(std::make_shared<Arrays>(rays))
    {}
    sgt_surface surface;
    std::vector<sgt_element> lens;
    std::shared_ptr<Arrays> arrays;
    size_t at_once = 0;  // rays of a batch; 0: all
    std::vector<double> n[3], p_err;  // not empty: each ray is a start on the surface, and leaves it

    bool leaves() const { return !p_err.empty(); }
    void batch(const sgt_options &opt) const
    {
        if (leaves()) {
            const sgt_rays of = arrays->rays();
            const sgt_starts from = { { of.o[0], of.o[1], of.o[2] },
                                      { n[0].data(), n[1].data(), n[2].data() },
                                      p_err.data(),
                                      { of.d[0], of.d[1], of.d[2] },
                                      nullptr,
                                      {} };
            std::vector<signed char> side(arrays->n);
            sgt_leave_batch(surface, arrays->n, from, arrays->hits(), side.data(), &opt);
            return;
        }
        if (!lens.empty()) {
            sgt_trace_batch(lens.size(), lens.data(), 1, arrays->n, arrays->rays(), arrays->traced(), nullptr,
                            &opt);
            return;
        }
        size_t most = at_once ? at_once : arrays->n;
        for (size_t i = 0; i < arrays->n; i += most)
            sgt_intersect_batch(surface, std::min(most, arrays->n - i), arrays->rays(i), arrays->hits(i),
                                &opt);
    }
    size_t few() const { return std::min(FEW, arrays->n); }
    void one_by_one(const sgt_options &opt) const
    {
        Arrays &a = *arrays;
        for (size_t i = 0; i < few(); i++) {
            double x[8] = { 0, 0, 0, 0, 0, 0, 0, 0 };
            a.status[i] = static_cast<sgt_status>(one(i, opt, x));
            for (size_t k = 0; k < 8; k++)
                a.out[k][i] = x[k];
        }
    }
    int one(size_t i, const sgt_options &opt, double x[8]) const
    {
        sgt_ray ray = arrays->ray(i);
        if (!lens.empty()) {
            sgt_fate fate;
            sgt_trace(lens.size(), lens.data(), 1, &ray, nullptr, &fate, &opt);
            const double y[] = { ray.o.x, ray.o.y, ray.o.z, ray.d.x, ray.d.y, ray.d.z };
            std::copy(y, y + 6, x);
            return fate;
        }
        sgt_start from = { ray.o, {}, 0, ray.d, 0, {} };
        if (leaves()) from.n = { n[0][i], n[1][i], n[2][i] }, from.p_err = p_err[i];
        sgt_hit h = leaves() ? sgt_leave(surface, &from, &opt).hit : sgt_intersect(surface, ray, &opt);
        const double y[] = { h.t, h.t_err, h.p.x, h.p.y, h.p.z, h.n.x, h.n.y, h.n.z };
        std::copy(y, y + 8, x);
        return h.status;
    }
    bool right(const sgt_options &opt) const  // the batch is the single ray
    {
        batch(opt);
        size_t wrong = 0;
        for (size_t i = 0; i < few(); i++) {
            double x[8];
            bool good = one(i, opt, x) == arrays->status[i];
            for (size_t k = 0; k < (lens.empty() ? 8u : 6u); k++)
                good = good && same(x[k], arrays->out[k][i]);
            wrong += !good;
        }
        if (wrong)
            std::printf("%zu of %zu rays differ between batch and single\n", wrong, few());
        return wrong == 0;
    }
    std::string fates(const sgt_options &opt) const  // "980 hit, 20 miss"
    {
        batch(opt);
        std::string said;
        for (int status = 4; status >= -5; status--) {
            long count =
                std::count(arrays->status.begin(), arrays->status.end(), status);
            const char *text = lens.empty() ? sgt_status_text(static_cast<sgt_status>(status))
                                            : sgt_fate_text(static_cast<sgt_fate>(status));
            if (count)
                said += (said.empty() ? "" : ", ") + std::to_string(count) + " " + text;
        }
        return said;
    }
};

// ------------------------------------------------------------------ lines

struct Line {  // of one neighbour and one side asked about, in one way of asking
    const Side *neighbour, *asked;
    sgt_options opt, neighbour_opt;
    bool single;
    int turns_left;
    std::vector<double> ns[2], ratio;

    Line(const Side *a, const Side *b, sgt_pick pick, bool s) : Line(a, b, picking(pick), picking(pick), s) {}
    Line(const Side *a, const Side *b, sgt_options a_opt, sgt_options b_opt, bool s)
        : neighbour(a), asked(b), opt(b_opt), neighbour_opt(a_opt), single(s), turns_left(0), often()
    {}
    void begin()
    {
        double cost = 0;
        for (int i = 0; i < 2; i++) {
            pass(i);  // the arrays come into the cache
            double start = now();
            pass(i);
            double took = std::max(now() - start, 100.0);
            often[i] = static_cast<int>(slice / took) + 1;
            cost += took * often[i];
        }
        turns_left = std::min(most_turns, std::max(3, static_cast<int>(most_time / cost)));
    }
    void turn(bool swapped)
    {
        double took[2];
        for (int j = 0; j < 2; j++) {
            int i = swapped ? 1 - j : j;
            double start = now();
            for (int k = 0; k < often[i]; k++)
                pass(i);
            const Side *side = i ? asked : neighbour;
            took[i] =
                (now() - start) / often[i] / static_cast<double>(single ? side->few() : side->arrays->n);
            ns[i].push_back(took[i]);
        }
        ratio.push_back(took[1] / took[0]);
        turns_left--;
    }
    std::string cells() const
    {
        double of = median(ratio);
        bool bold = of > CLIFF;
        return " | " + digits(median(ns[0])) + " | " + digits(median(ns[1])) + " | " + (bold ? "**" : "") +
               digits(of, 2) + (bold ? "**" : "");
    }

private:
    int often[2];
    void pass(int i) const
    {
        const Side *side = i ? asked : neighbour;
        const sgt_options &o = i ? opt : neighbour_opt;
        if (single)
            side->one_by_one(o);
        else
            side->batch(o);
    }
};

Random shuffler;

void measure(const std::vector<Line *> &all)
{
    for (Line *line : all)
        line->begin();
    std::vector<Line *> left = all;
    while (!left.empty()) {
        for (size_t i = left.size(); i-- > 1;)
            std::swap(left[i], left[static_cast<size_t>(shuffler.unit() * static_cast<double>(i + 1))]);
        for (Line *line : left)
            line->turn(shuffler.unit() < 0.5);
        left.erase(std::remove_if(left.begin(), left.end(), [](Line *line) { return line->turns_left <= 0; }),
                   left.end());
    }
}

struct Table {
    struct Row {
        std::string name;
        std::deque<Line> lines;
    };
    std::string title, words;                // above it
    std::string head;                        // of the first column
    std::vector<std::string> groups, cells;  // three cells in each group
    std::deque<Row> rows;

    void print() const
    {
        std::printf("\n### %s\n\n%s\n\n| %s", title.c_str(), words.c_str(), head.c_str());
        for (const std::string &group : groups)
            for (const std::string &cell : cells)
                std::printf(" | %s", (&cell == &cells[0] ? group + ": " + cell : cell).c_str());
        std::printf(" |\n|---");
        for (size_t i = 0; i < groups.size() * cells.size(); i++)
            std::printf("|---");
        std::printf("|\n");
        for (const Row &row : rows) {
            std::string line = "| " + row.name;
            for (const Line &one : row.lines)
                line += one.cells();
            std::printf("%s |\n", line.c_str());
        }
    }
};

std::deque<Side> sides;
Kept kept;
std::string only;
bool listed = false;

const Side *side(sgt_surface s, const std::vector<sgt_ray> &of)
{
    return &*sides.insert(sides.end(), Side(s, of));
}
const Side *side(const std::vector<sgt_element> &e, const std::vector<sgt_ray> &of)
{
    return &*sides.insert(sides.end(), Side(e, of));
}

bool wanted(const std::string &name) { return name.find(only) != std::string::npos; }

// First and near the seed, of batches or of single rays.
void picks(Table &table, const std::string &name, const Side *a, const Side *b, bool single)
{
    if (!wanted(name))
        return;
    table.rows.push_back({ name, {} });
    for (sgt_pick pick : { SGT_FIRST, SGT_NEAR_SEED })
        table.rows.back().lines.emplace_back(a, b, pick, single);
}

// A batch and single rays.
void ways(Table &table, const std::string &name, const Side *a, const Side *b, const sgt_options &opt)
{
    if (!wanted(name))
        return;
    table.rows.push_back({ name, {} });
    for (bool single : { false, true })
        table.rows.back().lines.emplace_back(a, b, opt, opt, single);
}

void ways(Table &table, const std::string &name, const Side *a, const Side *b, sgt_pick pick)
{
    ways(table, name, a, b, picking(pick));
}

// ------------------------------------------------------------- the input

template <class S> sgt_surface of_conic(S s) { return { &sgt_conic_ops, kept.keep(s) }; }

sgt_surface conic(double c, double k, double rim) { return of_conic(sgt_conic{ c, k, rim }); }

sgt_surface asphere(double rim, double strength)
{
    return {&sgt_even_asphere_ops,
            kept.keep(sgt_even_asphere{C, K, rim, {0, 1e-4 * strength, -2e-6 * strength, 1e-8 * strength}})};
}

std::vector<Subject> sags(double rim)
{
    std::vector<Subject> all = { { "plane", "plane", conic(0, 0, rim), true },
                                 { "sphere", "sphere", conic(C, 0, rim), true } };
    for (const Subject &one : subjects(kept, rim))
        if (one.sag)
            all.push_back(one);
    return all;
}

std::vector<Subject> without_a_rim()
{
    std::vector<Subject> all;
    for (const Subject &one : subjects(kept))
        if (!one.sag)
            all.push_back(one);
    sgt_julia julia = {};
    const double c[] = { -0.083, 0, -0.83, -0.025 };
    std::copy(c, c + 4, julia.c);
    julia.iterations = 7;
    sgt_mandelbrot mandelbrot = {};
    mandelbrot.iterations = 7;
    all.push_back({ "julia, N = 7", "julia", { &sgt_julia_ops, kept.keep(julia) }, false });
    all.push_back(
        { "mandelbrot, N = 7", "mandelbrot", { &sgt_mandelbrot_ops, kept.keep(mandelbrot) }, false });
    return all;
}

sgt_element element(sgt_surface s, double z, double index, double aperture, double degrees = 0)
{
    sgt_pose pose = {};  // no axes: no turn
    pose.origin = { 0, 0, z };
    if (degrees != 0)
        pose = sgt_pose_tilted(pose.origin, { degrees, 0, 0 });
    return { s, pose, index, aperture, nullptr, nullptr, {} };
}

// Where each ray meets the surface, started there.
std::vector<sgt_ray> from_the_surface(sgt_surface s, const std::vector<sgt_ray> &of)
{
    return each(of, [&](sgt_ray ray) {
        sgt_hit hit = sgt_intersect(s, ray, nullptr);
        return hit.status > 0 ? sgt_ray{ hit.p, ray.d, ray.tmin, ray.tmax } : ray;
    });
}

// --------------------------------------------------------- the tables

const std::vector<std::string> FIRST_NEAR = { "first", "near" }, BATCH_ONE = { "batch", "one ray" };

// The same lines for a batch and for single rays.
std::deque<Table> types()
{
    std::deque<Table> tables;
    std::vector<Subject> with = sags(RIM), without = sags(0);
    for (bool single : { false, true }) {
        tables.push_back({ single ? "Without a rim: one ray at a time" : "Without a rim: batches",
                           single ? "`sgt_intersect` in a loop." : "Batches of 1000 rays.",
                           "type",
                           FIRST_NEAR,
                           { "rim", "no rim", "ratio" },
                           {} });
        for (size_t i = 0; i < with.size(); i++)
            picks(tables.back(), with[i].name, side(with[i].s, bundle(N)), side(without[i].s, bundle(N)),
                  single);
    }
    return tables;
}

Table first_against_near()
{
    Table table = { "Types that have no rim",
                    "The root near the seed, the first, and how many times near that costs. Rays as above; "
                    "for the level sets they start at half the "
                    "distance from the axis.",
                    "type",
                    BATCH_ONE,
                    { "near", "first", "ratio" },
                    {} };
    for (const Subject &one : without_a_rim()) {
        bool level = one.s.ops == &sgt_julia_ops || one.s.ops == &sgt_mandelbrot_ops;
        const Side *s = side(one.s, each(bundle(N), [&](sgt_ray ray) {
                                 if (level)
                                     ray.o.x *= 0.5, ray.o.y *= 0.5;
                                 return ray;
                             }));
        if (!wanted(one.name))
            continue;
        table.rows.push_back({ one.name, {} });
        for (bool single : { false, true })
            table.rows.back().lines.emplace_back(s, s, picking(SGT_NEAR_SEED), picking(SGT_FIRST), single);
    }
    return table;
}

// A thin part: the same surface twice, of index 1.5 between them.
Table traces()
{
    Table table = {
        "Traces without clear apertures",
        "Each surface twice, 3 behind each other, glass between them; an origin within 1.5 of the axis. "
        "*Aperture*: rim and clear aperture are 4; *none*: neither is given. ns a ray and surface.",
        "type",
        BATCH_ONE,
        { "aperture", "none", "ratio" },
        {}
    };
    std::vector<Subject> with = sags(RIM), without = sags(0);
    std::vector<sgt_ray> narrow = each(bundle(N), [](sgt_ray ray) {
        ray.o.x *= 0.6, ray.o.y *= 0.6;
        return ray;
    });
    for (size_t i = 0; i < with.size(); i++)
        ways(table, with[i].name,
             side({ element(with[i].s, 0, 1.5, RIM), element(with[i].s, 3, 1, RIM) }, narrow),
             side({ element(without[i].s, 0, 1.5, 0), element(without[i].s, 3, 1, 0) }, narrow),
             SGT_PICK_DEFAULT);
    return table;
}

// The lens in another unit; its surfaces are conics.
std::vector<sgt_element> thousandth(std::vector<sgt_element> lens)
{
    for (sgt_element &e : lens) {
        const sgt_conic *from = static_cast<const sgt_conic *>(e.surface.self);
        e.surface = conic(1000 * from->c, from->k, 1e-3 * from->semi_diameter);
        e.pose.origin.z *= 1e-3, e.semi_diameter *= 1e-3;
    }
    return lens;
}

// The surface twice, without a rim, behind apertures of 4, and what may be done with the two.
void pairs_of(Table &table, const Subject &one)
{
    auto pair = [&](double z, double index, double second) {
        return std::vector<sgt_element>{element(one.s, 0, index, RIM),
                                        element(one.s, z, index < 0 ? index : 1, second)};
    };
    std::vector<sgt_ray> narrow = each(bundle(N), [](sgt_ray ray) {
        ray.o.x *= 0.6, ray.o.y *= 0.6;
        return ray;
    });
    const Side *neighbour = side(pair(3, 1.5, RIM), narrow);
    auto row = [&](const char *what, const std::vector<sgt_element> &lens, const std::vector<sgt_ray> &rays) {
        ways(table, one.name + " twice: " + what, neighbour, side(lens, rays), SGT_PICK_DEFAULT);
    };
    row("the second clips half against none", pair(3, 1.5, 1.2), narrow);
    row("mirrors against a lens", pair(-3, SGT_MIRROR, RIM), narrow);
    row("from 1e6 before it against from 5", pair(3, 1.5, RIM),
        each(narrow, [](sgt_ray ray) { return moved(ray, -1e6); }));
    row("from between the two against from 5 before", pair(3, 1.5, RIM),
        each(narrow, [](sgt_ray ray) { return moved(ray, 6); }));
    row("directions of length 2 against 1", pair(3, 1.5, RIM), each(narrow, [](sgt_ray ray) {
            ray.d = { 2 * ray.d.x, 2 * ray.d.y, 2 * ray.d.z };
            return ray;
        }));
    sgt_options loose = picking(SGT_PICK_DEFAULT);
    loose.t_tol = 1e-9;
    ways(table, one.name + " twice: in one place, t_tol 1e-9, against 3 apart", neighbour,
         side(pair(0, 1.5, RIM), narrow), loose);
    std::vector<sgt_element> backward = pair(3, 1.5, RIM);
    std::swap(backward[0].pose, backward[1].pose);
    row("from behind, backward, against from 5 before", backward, each(narrow, [](sgt_ray ray) {
            ray.o.z = 8, ray.d.z = -ray.d.z;
            return ray;
        }));
}

Table lenses()
{
    Table table = { "Traces: more of them",
                    "ns a ray and surface.",
                    "trace",
                    BATCH_ONE,
                    { "neighbour", "asked", "ratio" },
                    {} };
    std::vector<sgt_element> stop = { element(conic(0, 0, 0), 0, 0, 2.6) }, singlet = stop;
    singlet.push_back(element(conic(0.05, 0, 0), 1, 1.5, 4));
    singlet.push_back(element(conic(-0.05, 0, 0), 3, 1, 4));
    std::vector<sgt_ray> at_stop = each(bundle(N), [](sgt_ray ray) {
        ray.o.z = 0;
        return ray;
    });
    std::vector<sgt_ray> before = each(at_stop, [](sgt_ray ray) { return moved(ray, -5); });
    ways(table, "a plane stop alone: from on it against from 5 before", side(stop, before),
         side(stop, at_stop), SGT_PICK_DEFAULT);
    ways(table, "a plane stop and a lens: from on the stop against from 5 before", side(singlet, before),
         side(singlet, at_stop), SGT_PICK_DEFAULT);
    std::vector<sgt_ray> along_axis = each(before, [](sgt_ray ray) {
        ray.d = { 0, 0, 1 };
        return ray;
    });
    std::vector<sgt_ray> doubled = each(along_axis, [](sgt_ray ray) {
        ray.d = { 0, 0, 2 };
        return ray;
    });
    ways(table, "a plane stop and a lens, along the axis: directions of length 2 against 1",
         side(singlet, along_axis), side(singlet, doubled), SGT_PICK_DEFAULT);
    for (double index : { 1.0, 1.5 }) {
        std::vector<sgt_element> with, without;
        for (int i = 0; i < 10; i++) {
            double behind = i % 2 ? 1 : index;
            with.push_back(element(conic(0.1, 0, 0), 0.3 * i, behind, 5, 8.6));
            without.push_back(element(conic(0.1, 0, 0), 0.3 * i, behind, 0, 8.6));
        }
        ways(table,
             std::string("ten R = 10 spheres tilted by 8.6 degrees, ") +
                 (index == 1 ? "no glass" : "every other of glass") + ": without apertures against with",
             side(with, bundle(N)), side(without, bundle(N)), SGT_PICK_DEFAULT);
    }
    std::vector<sgt_element> half_stop = singlet;
    half_stop[0].semi_diameter = 1.7;
    ways(table, "a plane stop and a lens: the stop clips half against a tenth", side(singlet, before),
         side(half_stop, before), SGT_PICK_DEFAULT);
    ways(table, "a plane stop and a lens: all lengths a thousandth", side(singlet, before),
         side(thousandth(singlet), each(before,
                                        [](sgt_ray ray) {
                                            ray.o = { 1e-3 * ray.o.x, 1e-3 * ray.o.y, 1e-3 * ray.o.z };
                                            return ray;
                                        })),
         SGT_PICK_DEFAULT);
    for (const Subject &one : sags(0)) {
        if (one.name != "sphere" && one.name != "even_asphere" && one.name != "toroidal, to y^8" &&
            one.name != "zernike, fringe, 16")
            continue;
        pairs_of(table, one);
    }
    return table;
}

Table at_zero()
{
    Table table = { "From on the surface: t about 0",
                    "The rays start at the point where they meet the surface, and beside them 5 before it, "
                    "with the rim. tmin = 0 refuses the root at the "
                    "start, tmin = -1 accepts it. *Exactly 0*: from z = 0 of the plane, and from the vertex; "
                    "else t is 0 to rounding.",
                    "surface",
                    BATCH_ONE,
                    { "5 before", "on it", "ratio" },
                    {} };
    auto both = [&](const std::string &name, sgt_surface s, const std::vector<sgt_ray> &on, double tmin) {
        auto start = [=](double t, double low) {
            return each(on, [=](sgt_ray ray) {
                ray = moved(ray, t);
                ray.tmin = low, ray.tmax = INFINITY;
                return ray;
            });
        };
        const Side *a = side(s, start(-5, 0)), *b = side(s, start(0, tmin));
        ways(table, name + ", first", a, b, SGT_FIRST);
        ways(table, name + ", near", a, b, SGT_NEAR_SEED);
    };
    std::vector<sgt_ray> flat = each(bundle(N), [](sgt_ray ray) {
        ray.o.z = 0;
        return ray;
    });
    std::vector<sgt_ray> vertex = each(bundle(N), [](sgt_ray ray) {
        ray.o = { 0, 0, 0 };
        return ray;
    });
    for (double rim : { RIM, 0.0 })
        for (double tmin : { 0.0, -1.0 }) {
            std::string how = std::string(", exactly 0, ") + (rim == 0 ? "no rim, " : "") +
                              (tmin == 0 ? "tmin = 0" : "tmin = -1");
            both("plane" + how, conic(0, 0, rim), flat, tmin);
            both("sphere" + how, conic(C, 0, rim), vertex, tmin);
            both("even_asphere" + how, asphere(rim, 1), vertex, tmin);
        }
    for (const Subject &one : sags(RIM))
        if (one.name != "plane")
            both(one.name, one.s, from_the_surface(one.s, bundle(N)), 0);
    return table;
}

Table misses()
{
    Table table = { "Misses",
                    "The first root, in a batch. *Behind*: the rays start 1 behind the surface, beside rays "
                    "that hit it; both with the rim. *Past*: they start 5 "
                    "farther from the axis and pass the rim by, beside rays that hit. *No rim*: 100 rays "
                    "from 1 behind, without a rim beside with one.",
                    "type",
                    { "behind", "past", "no rim" },
                    { "neighbour", "asked", "ratio" },
                    {} };
    std::vector<Subject> without = sags(0);
    size_t number = 0;
    for (const Subject &one : sags(RIM)) {
        const Subject &bare = without[number++];
        if (!wanted(one.name))
            continue;
        const Side *hits = side(one.s, bundle(N));
        const Side *behind =
            side(one.s, each(from_the_surface(one.s, bundle(N)), [](sgt_ray ray) { return moved(ray, 1); }));
        const Side *past = side(one.s, each(bundle(N), [](sgt_ray ray) {
                                    double r = std::hypot(ray.o.x, ray.o.y), by = (r + 5) / r;
                                    ray.o.x *= by, ray.o.y *= by;
                                    return ray;
                                }));
        std::vector<sgt_ray> few =
            each(from_the_surface(one.s, bundle(HUNDRED)), [](sgt_ray ray) { return moved(ray, 1); });
        table.rows.push_back({ one.name, {} });
        table.rows.back().lines.emplace_back(hits, behind, SGT_FIRST, false);
        table.rows.back().lines.emplace_back(hits, past, SGT_FIRST, false);
        table.rows.back().lines.emplace_back(side(one.s, few), side(bare.s, few), SGT_FIRST, false);
    }
    return table;
}

Table from_the_side()
{
    Table table = {
        "From the side, from afar and past the rim",
        "The first root, in a batch; the neighbour hits the surface with the rim from 5 before it. *Bowl*: "
        "rays that run nearly along the vertex plane into the bowl, with the rim. *Afar*: from a million "
        "times as far, along the same lines, without a rim. *Past*: 40 beside the axis, with the rim. "
        "*Steep*: at up to 64 degrees, without a rim.",
        "type",
        {"bowl", "afar", "past", "steep"},
        {"neighbour", "asked", "ratio"},
        {}};
    std::vector<Subject> without = sags(0);
    size_t number = 0;
    Random dice(7);
    std::vector<sgt_ray> bowl = each(bundle(N), [&](sgt_ray ray) {
        return sgt_ray{
            {-3, 0.5 * dice.unit(), 0.24}, {1, 0.02 * dice.unit(), 0.02 * dice.unit()}, ray.tmin, ray.tmax};
    });
    std::vector<sgt_ray> steep = each(bundle(N), [&](sgt_ray ray) {
        double l = 1.8 * dice.unit() - 0.9, m = 0.4 * dice.unit() - 0.2;
        ray.d = {l, m, std::sqrt(1 - l * l - m * m)};
        return moved({{ray.o.x, ray.o.y, 0}, ray.d, ray.tmin, ray.tmax}, -5 / ray.d.z);
    });
    for (const Subject &one : sags(RIM)) {
        const Subject &bare = without[number++];
        if (!wanted(one.name) || one.name == "plane") continue;
        const Side *hits = side(one.s, bundle(N));
        table.rows.push_back({one.name, {}});
        table.rows.back().lines.emplace_back(hits, side(one.s, bowl), SGT_FIRST, false);
        table.rows.back().lines.emplace_back(
            hits, side(bare.s, each(bundle(N), [](sgt_ray ray) { return moved(ray, -5e6); })), SGT_FIRST,
            false);
        table.rows.back().lines.emplace_back(hits,
                                             side(one.s, each(bundle(N),
                                                              [](sgt_ray ray) {
                                                                  ray.o.x += 40;
                                                                  return ray;
                                                              })),
                                             SGT_FIRST, false);
        table.rows.back().lines.emplace_back(hits, side(bare.s, steep), SGT_FIRST, false);
    }
    return table;
}

// Points of the surface below those of `of`, each met at `degrees` from the tangent plane, from `before` it.
std::vector<sgt_ray> along(sgt_surface s, const std::vector<sgt_ray> &of, double degrees, double before)
{
    Random dice(11);
    const double rise = std::sin(degrees * M_PI / 180), run = std::cos(degrees * M_PI / 180);
    return each(of, [&](sgt_ray ray) {
        const sgt_hit at = sgt_intersect(s, { { ray.o.x, ray.o.y, -5 }, { 0, 0, 1 }, 0, 0 }, nullptr);
        const double length = std::sqrt(at.n.x * at.n.x + at.n.y * at.n.y + 1), phi = 2 * M_PI * dice.unit(),
                     l = std::cos(phi), m = std::sin(phi), n = -(at.n.x * l + at.n.y * m) / at.n.z,
                     by = run / std::sqrt(1 + n * n), up = rise / length;
        const sgt_vec3 d = { by * l + up * at.n.x, by * m + up * at.n.y, by * n + up * at.n.z };
        return moved({ at.p, d, 0, 0 }, -before);
    });
}

// At least 1 from the axis, where no symmetry helps.
std::vector<sgt_ray> off_axis(double by)
{
    return each(bundle(N), [=](sgt_ray ray) {
        const double r = std::hypot(ray.o.x, ray.o.y), out = by * (1 + 0.6 * r) / r;
        ray.o.x *= out, ray.o.y *= out;
        return ray;
    });
}

Table grazing()
{
    Table table = { "Along the surface",
                    "The first root, in a batch. Rays that meet the surface at 30, 10, 3, 1 and 0.3 degrees "
                    "from its tangent plane, at a point that is 1 to 2.5 from the axis, from 5 before it; "
                    "the neighbour comes nearly along the axis, with the rim. *Mirrors*: R = 20000, 60 "
                    "across (a biconic: k = -0.6), 10 to 25 from the axis, with a rim of 40, from 1000 "
                    "before it.",
                    "type",
                    { "30", "10", "3", "1", "0.3" },
                    { "neighbour", "asked", "ratio" },
                    {} };
    auto row = [&](const std::string &name, sgt_surface with, sgt_surface s, double by, double before) {
        if (!wanted(name)) return;
        const Side *hits = side(with, each(bundle(N), [=](sgt_ray ray) {
                                    ray.o.x *= by, ray.o.y *= by;
                                    return ray;
                                }));
        table.rows.push_back({ name, {} });
        for (double degrees : { 30.0, 10.0, 3.0, 1.0, 0.3 })
            table.rows.back().lines.emplace_back(hits, side(s, along(s, off_axis(by), degrees, before)),
                                                 SGT_FIRST, false);
    };
    std::vector<Subject> with = sags(RIM), without = sags(0);
    for (size_t i = 0; i < with.size(); i++) {
        const Subject &one = with[i];
        bool closed = one.name == "sphere" || one.name == "conic" || one.name == "even_asphere";
        if (one.name != "plane") row(one.name, one.s, one.s, 1, 5);
        if (closed) row(one.name + ", no rim", one.s, without[i].s, 1, 5);
    }
    const double R = 20000, across = 60;
    const sgt_surface toroid = { &sgt_toroidal_ops, kept.keep(sgt_toroidal{ 1 / across, 0, 1 / R, 40, {} }) },
                      biconic = { &sgt_biconic_ops, kept.keep(sgt_biconic{ 1 / R, K, 1 / across, K, 40 }) };
    row("toroidal mirror", toroid, toroid, 10, 1000);
    row("biconic mirror", biconic, biconic, 10, 1000);
    return table;
}

// F(x, y, z) = 0 within the ball.
sgt_surface body(const char *text, double ball)
{
    std::vector<double> room(sgt_formula_room(text, 0) / sizeof(double) + 1);
    std::vector<double> &own = *const_cast<std::vector<double> *>(kept.keep(room));
    const sgt_tape *tape = sgt_formula_read(text, SGT_FORMULA_XYZ, 0, nullptr, own.data(),
                                            own.size() * sizeof(double), nullptr);
    return { &sgt_formula_ops, kept.keep(sgt_formula{ tape, ball, {}, {} }) };
}

Table leaving()
{
    Table table = { "Leaving",
                    "`sgt_leave_batch` from where rays have met the surface, beside the first hits. "
                    "*Straight on*, *mirrored*, and *any way*: in directions of the whole sphere.",
                    "type",
                    { "straight on", "mirrored", "any way" },
                    { "first hit", "leaving", "ratio" },
                    {} };
    auto start = [&](sgt_surface s, const std::vector<sgt_ray> &of, int way) {
        Random dice(13);
        std::vector<sgt_ray> from;
        Side made(s, {});
        for (const sgt_ray &ray : of) {
            const sgt_hit at = sgt_intersect(s, ray, nullptr);
            if (at.status <= 0) continue;
            const double d[] = { ray.d.x, ray.d.y, ray.d.z }, n[] = { at.n.x, at.n.y, at.n.z };
            const double z = 2 * dice.unit() - 1, phi = 2 * M_PI * dice.unit(), r = std::sqrt(1 - z * z),
                         by = 2 * (d[0] * n[0] + d[1] * n[1] + d[2] * n[2]) /
                              (n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
            sgt_ray next = { at.p, ray.d, 0, 0 };
            if (way == 1) next.d = { d[0] - by * n[0], d[1] - by * n[1], d[2] - by * n[2] };
            if (way == 2) next.d = { r * std::cos(phi), r * std::sin(phi), z };
            from.push_back(next), made.p_err.push_back(at.p_err);
            for (int k = 0; k < 3; k++) made.n[k].push_back(n[k]);
        }
        made.arrays = std::make_shared<Arrays>(from);
        return &*sides.insert(sides.end(), made);
    };
    auto row = [&](const std::string &name, sgt_surface s) {
        if (!wanted(name)) return;
        const Side *hits = side(s, bundle(N));
        table.rows.push_back({ name, {} });
        for (int way = 0; way < 3; way++)
            table.rows.back().lines.emplace_back(hits, start(s, bundle(N), way), SGT_FIRST, false);
    };
    for (double rim : { RIM, 0.0 })
        for (const Subject &one : sags(rim))
            if (one.name.find("20 x 20") == std::string::npos && one.name.find("231") == std::string::npos)
                row(one.name + (rim > 0 ? "" : ", no rim"), one.s);
    for (const Subject &one : subjects(kept))
        if (!one.sag) row(one.name, one.s);
    row("sphere as a formula", body("x^2 + y^2 + z^2 = 9", 4));
    row("quartic as a formula", body("x^4 + y^4 + z^4 = 81", 6));
    row("gyroid as a formula", body("sin(x)*cos(y) + sin(y)*cos(z) + sin(z)*cos(x) = 0", 6));
    return table;
}

Table others()
{
    Table table = { "Near by, and strong",
                    "Rays and surfaces as above, but for what the row says.",
                    "what",
                    BATCH_ONE,
                    { "neighbour", "asked", "ratio" },
                    {} };
    for (double rim : { RIM, 0.0 })
        for (sgt_pick pick : { SGT_FIRST, SGT_NEAR_SEED }) {
            sgt_surface weak = conic(0.005, 0, rim);
            std::vector<sgt_ray> on = from_the_surface(weak, bundle(N));
            ways(table,
                 std::string("a weak sphere (c = 0.005), ") + (rim == 0 ? "no rim, " : "") +
                     (pick == SGT_FIRST ? "first" : "near") + ": from 1e-6 before it against from 10 before",
                 side(weak, each(on, [](sgt_ray ray) { return moved(ray, -10); })),
                 side(weak, each(on, [](sgt_ray ray) { return moved(ray, -1e-6); })), pick);
        }
    for (sgt_pick pick : { SGT_FIRST, SGT_NEAR_SEED })
        ways(table,
             std::string("even_asphere with a rim of 5, ") + (pick == SGT_FIRST ? "first" : "near") +
                 ": coefficients 100 times as large",
             side(asphere(5, 1), bundle(N)), side(asphere(5, 100), bundle(N)), pick);
    return table;
}

Table hundreds()
{
    Table table = { "Batches of 100 rays",
                    "10,000 rays at once, and the same a hundred at a time; with the rim.",
                    "type",
                    FIRST_NEAR,
                    { "10,000", "100", "ratio" },
                    {} };
    std::vector<Subject> all = sags(RIM);
    for (const Subject &one : without_a_rim())
        all.push_back(one);
    for (const Subject &one : all) {
        bool level = one.s.ops == &sgt_julia_ops || one.s.ops == &sgt_mandelbrot_ops;
        std::vector<sgt_ray> many = each(bundle(10000), [=](sgt_ray ray) {
            if (level)
                ray.o.x *= 0.5, ray.o.y *= 0.5;
            return ray;
        });
        const Side *a = side(one.s, many);
        Side hundred(one.s, many);
        hundred.at_once = HUNDRED;
        sides.push_back(hundred);
        picks(table, one.name, a, &sides.back(), false);
    }
    return table;
}

// Every side against the single ray, and what becomes of the rays where the two sides differ in it.
bool all_right(const std::deque<Table> &tables, std::vector<std::string> &told)
{
    bool right = true;
    for (const Table &table : tables)
        for (const Table::Row &row : table.rows)
            for (const Line &line : row.lines) {
                if (line.single && line.neighbour->lens.empty())
                    continue;  // the batch's line has been looked at
                if (!line.neighbour->right(line.neighbour_opt) || !line.asked->right(line.opt)) {
                    std::printf("%s, %s: wrong\n", table.title.c_str(), row.name.c_str());
                    right = false;
                }
                std::string a = line.neighbour->fates(line.neighbour_opt), b = line.asked->fates(line.opt);
                if (a != b && !line.single)
                    told.push_back(table.title + ", " + row.name +
                                   (line.opt.pick == SGT_FIRST ? " (first): " : ": ") + a + "; asked: " + b);
            }
    return right;
}

// ------------------------------------------------------- drawn at random

constexpr size_t DRAWN = 50, DRAWN_RAYS = 256;

const char *const DRAWN_TYPES[] = { "conic",     "even_asphere", "odd_asphere", "polynomial_xy",
                                    "chebyshev", "zernike",      "q_con",       "q_bfs",
                                    "grid",      "sum",          "toroidal",    "biconic" };

struct Drawn {
    std::string type;
    double c, k, c_x, k_x;  // c_x, k_x: of a toroid and a biconic
    double radius, size, from,
        steep;  // the rays fill the radius; the departure; how far the rays come from; their most degrees
    bool from_behind;
    size_t terms;           // of a table in each direction
    std::vector<double> a;  // of size 1 at the radius
    double scale;           // what makes the departure `size` at most, where |P| is looked at
    std::string words() const
    {
        char text[400];
        std::string base = type == "toroidal"  ? ", c_x = " + exact(c_x)
                           : type == "biconic" ? ", c_x = " + exact(c_x) + ", k_x = " + exact(k_x)
                                               : "";
        std::snprintf(text, sizeof text,
                      "%s (%zu terms): c = %s, k = %s%s, radius %s, departure %s of it, rays from %s "
                      "radii%s, up to %.0f degrees from the axis",
                      type.c_str(), terms, exact(c).c_str(), exact(k).c_str(), base.c_str(),
                      exact(radius).c_str(), exact(size / radius).c_str(), exact(from / radius).c_str(),
                      from_behind ? " behind" : "", steep);
        return text;
    }
    static std::string exact(double x)
    {
        char text[32];
        std::snprintf(text, sizeof text, "%.3g", x);
        return text;
    }
};

double within(Random &dice, double a, double b) { return a + (b - a) * dice.unit(); }
double log_within(Random &dice, double a, double b) { return a * std::pow(b / a, dice.unit()); }

// The departures that are lists of coefficients, on a base of curvature c and conic constant k.
sgt_surface built(const Drawn &d, const std::string &type, double c, double k, double rim, double scale)
{
    double h = d.radius;
    auto power = [&](size_t i, size_t exponent) {
        return scale * d.a[i] / std::pow(h, static_cast<double>(exponent));
    };
    auto list = [&] { return kept.table(1, d.terms, [&](size_t, size_t j) { return scale * d.a[j]; }); };
    auto square = [&](size_t n) {
        return kept.table(n, n, [&](size_t i, size_t j) { return scale * d.a[i * n + j]; });
    };
    if (type == "conic")
        return conic(c, k, rim);
    if (type == "even_asphere" || type == "toroidal") {
        sgt_even_asphere s = { c, k, rim, {} };
        sgt_toroidal toroid = { c, k, c == 0 ? 0 : d.c_x, rim, {} };
        for (size_t i = 0; i < d.terms; i++)
            s.a[i] = toroid.a[i] = power(i, 2 * i + 2);
        if (type == "toroidal")
            return { &sgt_toroidal_ops, kept.keep(toroid) };
        return { &sgt_even_asphere_ops, kept.keep(s) };
    }
    if (type == "odd_asphere") {
        sgt_odd_asphere s = { c, k, rim, {} };
        for (size_t i = 1; i < d.terms; i++)
            s.a[i] = power(i, i + 1);
        return { &sgt_odd_asphere_ops, kept.keep(s) };
    }
    if (type == "polynomial_xy")
        return { &sgt_polynomial_xy_ops, kept.keep(sgt_polynomial_xy{
                                             c, k, rim, kept.table(d.terms, d.terms, [&](size_t i, size_t j) {
                                                 return power(i * d.terms + j, i + j);
                                             }) }) };
    if (type == "chebyshev")
        return { &sgt_chebyshev_ops, kept.keep(sgt_chebyshev{ c, k, rim, h, h, square(d.terms) }) };
    if (type == "zernike")
        return { &sgt_zernike_ops, kept.keep(sgt_zernike{ c, k, rim, h, SGT_NOLL, 0, list() }) };
    if (type == "q_con")
        return { &sgt_q_con_ops, kept.keep(sgt_q_con{ c, k, rim, h, list() }) };
    if (type == "q_bfs")
        return { &sgt_q_bfs_ops, kept.keep(sgt_q_bfs{ c, rim, h, list() }) };
    if (type == "grid") {
        double step = 2.2 * h / static_cast<double>(d.terms - 1);
        sgt_grid g = { c, k, rim, step, step, square(d.terms), 0, 0, 0 };
        sgt_grid_measure(&g);
        return { &sgt_grid_ops, kept.keep(g) };
    }
    if (type == "sum") {
        const std::vector<sgt_surface> *both = kept.keep(std::vector<sgt_surface>{
            built(d, "zernike", 0, 0, 0, scale / 2), built(d, "even_asphere", 0, 0, 0, scale / 2) });
        return { &sgt_sum_ops, kept.keep(sgt_sum{ c, k, rim, both->data(), both->size() }) };
    }
    return { &sgt_biconic_ops, kept.keep(sgt_biconic{ d.c_x, d.k_x, c, k, rim }) };
}

double sag(sgt_surface s, double x, double y) { return -s.ops->value(s.self, { x, y, 0 }, nullptr); }

// The largest |s| within the radius; NaN where it is not defined all over it.
double largest(sgt_surface s, double radius)
{
    double most = 0;
    for (int i = 1; i <= 24; i++)
        for (int j = 0; j < 32; j++) {
            double z = std::fabs(
                sag(s, radius * i / 24 * std::cos(M_PI * j / 16), radius * i / 24 * std::sin(M_PI * j / 16)));
            most = z > most || std::isnan(z) ? z : most;
            if (std::isnan(z))
                return NAN;
        }
    return most;
}

// Half of the conic constants are those of lenses, -2 to 1, and half are from -50 to 5.
double drawn_k(Random &dice) { return dice.unit() < 0.5 ? within(dice, -2, 1) : within(dice, -50, 5); }

Drawn drawn(Random &dice, size_t number)
{
    Drawn d = {};
    d.type = DRAWN_TYPES[number % (sizeof DRAWN_TYPES / sizeof DRAWN_TYPES[0])];
    d.radius = log_within(dice, 0.1, 100);
    auto curvature = [&] { return (dice.unit() < 0.5 ? -1 : 1) * log_within(dice, 1e-3, 0.9) / d.radius; };
    d.c = curvature(), d.k = drawn_k(dice), d.c_x = curvature(), d.k_x = drawn_k(dice);
    d.size = d.radius * log_within(dice, 1e-5, 0.2);
    d.from = d.radius * log_within(dice, 1e-2, 1e5);
    d.steep = within(dice, 1, 45);
    d.from_behind = dice.unit() < 0.3;
    auto from_to = [&](size_t a, size_t b) {
        return a + static_cast<size_t>(dice.unit() * static_cast<double>(b - a + 1));
    };
    d.terms = d.type == "grid"                                     ? from_to(8, 40)
              : d.type == "polynomial_xy" || d.type == "chebyshev" ? from_to(2, 8)
              : d.type == "zernike"                                ? from_to(4, 60)
              : d.type == "odd_asphere"                            ? from_to(2, 12)
              : d.type == "conic" || d.type == "biconic"           ? 0
                                                                   : from_to(1, 8);
    d.a.resize(std::max<size_t>(d.terms * d.terms, 64));
    for (double &a : d.a)
        a = within(dice, -1, 1);
    if (d.type == "polynomial_xy")
        d.a[0] = d.a[1] = d.a[d.terms] = 0;
    if (d.type == "q_bfs")
        d.k = 0;
    double size =
        d.type == "conic" || d.type == "biconic" ? 1 : largest(built(d, d.type, 0, 0, 0, 1), d.radius);
    d.scale = d.size / size;
    if (d.type == "conic" || d.type == "biconic")
        d.size = 0;
    while (std::isnan(largest(built(d, d.type, d.c, d.k, 0, d.scale), 1.02 * d.radius)))
        d.c *= 0.8, d.c_x *= 0.8;
    return d;
}

// Rays at points of the surface within the radius.
std::vector<sgt_ray> drawn_rays(Random &dice, const Drawn &d, sgt_surface s)
{
    std::vector<sgt_ray> all(DRAWN_RAYS);
    for (sgt_ray &ray : all) {
        double r = d.radius * std::sqrt(dice.unit()), phi = 2 * M_PI * dice.unit(), x = r * std::cos(phi),
               y = r * std::sin(phi);
        double tilt = d.steep * M_PI / 180 * std::sqrt(dice.unit()), about = 2 * M_PI * dice.unit();
        sgt_vec3 way = { std::sin(tilt) * std::cos(about), std::sin(tilt) * std::sin(about),
                         (d.from_behind ? -1 : 1) * std::cos(tilt) };
        ray = moved(sgt_ray{ { x, y, sag(s, x, y) }, way, 0, 0 }, -d.from);
    }
    return all;
}

struct Counts {
    size_t answers, other_root, other_near, unexplained, undecided[2];
};

void add(Counts &all, const Counts &some)
{
    all.answers += some.answers, all.other_root += some.other_root, all.other_near += some.other_near,
        all.unexplained += some.unexplained;
    for (int i = 0; i < 2; i++)
        all.undecided[i] += some.undecided[i];
}

double percent(size_t some, const Counts &of)
{
    return 100 * static_cast<double>(some) / static_cast<double>(of.answers);
}

// Without a rim the first root, or the one near the seed, may lie outside it.  Of two roots inside the rim
// the search near the seed may find either: which one its guess leads to depends on where the search ends.
// All else has to be told alike.
Counts compare(const Side &with, const Side &without, double rim, sgt_pick pick)
{
    Counts counts = {};
    sgt_options opt = picking(pick);
    for (size_t i = 0; i < with.arrays->n; i++) {
        sgt_hit a = sgt_intersect(with.surface, with.arrays->ray(i), &opt),
                b = sgt_intersect(without.surface, without.arrays->ray(i), &opt);
        counts.answers++;
        counts.undecided[0] += a.status < 0, counts.undecided[1] += b.status < 0;
        bool alike = a.status == b.status && (a.status <= 0 || std::fabs(a.t - b.t) <= a.t_err + b.t_err);
        if (alike || a.status < 0 || b.status < 0)
            continue;
        bool outside = b.status > 0 && std::hypot(b.p.x, b.p.y) + b.p_err > rim * (1 - 1e-12);
        bool either = !outside && pick == SGT_NEAR_SEED && a.status > 0 && b.status > 0;
        counts.other_root += outside, counts.other_near += either, counts.unexplained += !outside && !either;
        if (!outside && (!either || listed))
            std::printf("%s, ray %zu: %s %.17g with the rim, %s %.17g without\n",
                        pick == SGT_FIRST ? "first" : "near", i, sgt_status_text(a.status), a.t,
                        sgt_status_text(b.status), b.t);
    }
    return counts;
}

int fifty(unsigned long seed)
{
    struct Pair {
        Drawn d;
        const Side *with, *without;
        std::deque<Line> lines;
        Counts counts[2];
    };
    std::deque<Pair> pairs;
    Random dice(seed);
    Counts counts = {};
    std::vector<Line *> lines;
    bool right = true;
    for (size_t i = 0; i < DRAWN; i++) {
        Drawn d = drawn(dice, i);
        sgt_surface with = built(d, d.type, d.c, d.k, d.radius, d.scale),
                    without = built(d, d.type, d.c, d.k, 0, d.scale);
        std::vector<sgt_ray> of = drawn_rays(dice, d, without);
        pairs.push_back({ d, side(with, of), side(without, of), {}, {} });
        Pair &pair = pairs.back();
        for (sgt_pick pick : { SGT_FIRST, SGT_NEAR_SEED }) {
            if (!pair.with->right(picking(pick)) || !pair.without->right(picking(pick))) {
                std::printf("%s: wrong\n", d.words().c_str());
                right = false;
            }
            pair.counts[pick == SGT_NEAR_SEED] = compare(*pair.with, *pair.without, d.radius, pick);
            add(counts, pair.counts[pick == SGT_NEAR_SEED]);
            pair.lines.emplace_back(pair.with, pair.without, pick, false);
        }
        for (Line &line : pair.lines)
            lines.push_back(&line);
    }
    if (!right)
        return 1;
    measure(lines);
    std::printf("\nSeed %lu. %zu rays on each, in a batch; ns a ray.\n", seed, DRAWN_RAYS);
    for (size_t pick = 0; pick < 2; pick++) {
        std::vector<std::pair<double, const Pair *>> order;
        std::vector<double> ratios;
        size_t cliffs = 0, steep = 0;
        for (const Pair &pair : pairs) {
            double of = median(pair.lines[pick].ratio);
            ratios.push_back(of), order.push_back({ of, &pair });
            cliffs += of > CLIFF, steep += of > 10;
        }
        std::sort(order.begin(), order.end(),
                  [](const std::pair<double, const Pair *> &a, const std::pair<double, const Pair *> &b) {
                      return a.first > b.first;
                  });
        std::printf(
            "\n**%s**: no rim over rim, median %s, worst %s; above 3: %zu, above 10: %zu of %zu. The five "
            "worst:\n\n| ratio | rim | no rim | undecided, %% | surface and rays |\n|---|---|---|---|---|\n",
            pick ? "Near the seed" : "First", digits(median(ratios), 2).c_str(),
            digits(order[0].first, 2).c_str(), cliffs, steep, DRAWN);
        for (size_t i = 0; i < 5; i++) {
            const Pair &pair = *order[i].second;
            const Line &line = pair.lines[pick];
            std::printf("| %s | %s | %s | %.0f, %.0f | %s |\n", digits(order[i].first, 2).c_str(),
                        digits(median(line.ns[0])).c_str(), digits(median(line.ns[1])).c_str(),
                        percent(pair.counts[pick].undecided[0], pair.counts[pick]),
                        percent(pair.counts[pick].undecided[1], pair.counts[pick]), pair.d.words().c_str());
        }
    }
    std::printf(
        "\n%zu answers. Undecided with the rim %.2f %%, without %.2f %%. Another root because one lies "
        "outside the rim: %.2f %%; near the seed another of two inside the rim: %zu; any other difference: "
        "%zu.\n",
        counts.answers, percent(counts.undecided[0], counts), percent(counts.undecided[1], counts),
        percent(counts.other_root, counts), counts.other_near, counts.unexplained);
    if (listed)
        for (const Pair &pair : pairs)
            for (size_t pick = 0; pick < 2; pick++) {
                const Line &line = pair.lines[pick];
                std::printf("%s %8s = %8s / %6s, undecided without %3.0f %%: %s\n", pick ? "near " : "first",
                            digits(median(line.ratio), 2).c_str(), digits(median(line.ns[1])).c_str(),
                            digits(median(line.ns[0])).c_str(),
                            percent(pair.counts[pick].undecided[1], pair.counts[pick]),
                            pair.d.words().c_str());
            }
    return counts.unexplained ? 1 : 0;
}

// How many ratios are above 3, and, if they are few, which.
void print_cliffs(const std::deque<Table> &tables)
{
    size_t all = 0;
    std::vector<std::string> above;
    for (const Table &table : tables)
        for (const Table::Row &row : table.rows)
            for (size_t i = 0; i < row.lines.size(); i++) {
                double of = median(row.lines[i].ratio);
                all++;
                if (of > CLIFF)
                    above.push_back("- " + table.title + ", " + row.name + ", " + table.groups[i] + ": " +
                                    digits(of, 2));
            }
    std::printf("\nOf %zu ratios %zu are above 3%s\n", all, above.size(),
                above.empty() || above.size() > 20 ? "." : ":\n");
    if (above.size() <= 20)
        for (const std::string &line : above)
            std::printf("%s\n", line.c_str());
}

int ordinary()
{
    std::deque<Table> tables = types();
    tables.push_back(first_against_near());
    tables.push_back(at_zero());
    tables.push_back(misses());
    tables.push_back(from_the_side());
    tables.push_back(grazing());
    tables.push_back(leaving());
    tables.push_back(others());
    tables.push_back(hundreds());
    tables.push_back(traces());
    tables.push_back(lenses());
    std::vector<std::string> told;
    if (!all_right(tables, told))
        return 1;
    for (Table &table : tables) {
        std::vector<Line *> lines;
        for (Table::Row &row : table.rows)
            for (Line &line : row.lines)
                lines.push_back(&line);
        measure(lines);
        for (Line *line : lines)  // a trace's time is for each surface
            for (std::vector<double> &ns : line->ns)
                for (double &x : ns)
                    x /= std::max(1.0, static_cast<double>(line->asked->lens.size()));
        if (!table.rows.empty())
            table.print();
        std::fflush(stdout);
    }
    print_cliffs(tables);
    for (const std::string &line : listed ? told : std::vector<std::string>())
        std::fprintf(stderr, "%s\n", line.c_str());
    return 0;
}

}  // namespace

int main(int argc, char **argv)
{
    bool random = false, search = false, brief = false;
    unsigned long seed = 1;
    double seconds = 60;
    std::string type;
    for (int i = 1; i < argc; i++) {
        std::string word = argv[i];
        if (word == "--quick") {
            slice = 0.03e6, most_turns = 9, most_time = 0.02e9;
        } else if (word == "--only" && i + 1 < argc) {
            only = argv[++i];
        } else if (word == "--list") {
            listed = true;
        } else if (word == "--drawn") {
            random = true;
            if (i + 1 < argc && argv[i + 1][0] != '-')
                seed = std::strtoul(argv[++i], nullptr, 0);
        } else if (word == "--search") {
            search = true;
        } else if (word == "--brief") {
            brief = true;
        } else if (word == "--seconds" && i + 1 < argc) {
            seconds = std::strtod(argv[++i], nullptr);
        } else if (word == "--seed" && i + 1 < argc) {
            seed = std::strtoul(argv[++i], nullptr, 0);
        } else if (word == "--type" && i + 1 < argc) {
            type = argv[++i];
        } else if (word == "--case" && i + 1 < argc) {
            return run_case(argv[++i]);
        } else {
            std::fprintf(stderr, "bench_ordinary [--quick] [--only TEXT] [--drawn [SEED] [--list]]\n"
                                 "bench_ordinary --search [--seconds N] [--seed S] [--type T] [--brief]\n"
                                 "bench_ordinary --case \"type=... ...\"\n");
            return 2;
        }
    }
    if (search)
        return search_for_cliffs(seconds, seed, type, brief);
    return random ? fifty(seed) : ordinary();
}
