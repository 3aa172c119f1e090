// SPDX-License-Identifier: MIT
// What derivatives of a trace cost beside the trace, and what it costs to aim.
//
//     build/tests/bench/bench_aim
//
// All run on the same rays of the same lens, by turns, in one process; the figures are medians of the turns.
// A trace is sgt_trace with its passages.
//
//     trace      ns a ray
//     launch     sgt_trace_sensitivity, two columns: beside the trace, at most 3
//     gradient   sgt_trace_gradient of one number by all parameters: beside the trace, at most 5
//     jacobian   the gradients of all seven numbers: ns for each of its entries
//
// Then the same for many rays at a time, 256 of them as an analysis takes them: ns a ray, and in brackets how
// many plain sgt_trace_batch that is.
//
//     trace, path, passages   sgt_trace_batch: plain; with opl; with what the others read
//     point, errors           sgt_trace_error_batch: of the point, of the path too
//     launch, gradient        sgt_trace_sensitivity_batch of two columns, sgt_trace_gradient_batch of one
//     number aim                     sgt_aim_batch at points of the front of the last lens, from starts by a
//     linear map one by one              sgt_trace_error, and sgt_aim, of one ray
//
// Then sgt_aim, from a field of 5 degrees: at points of the front of the last lens, and of its surface far
// outside, also from a beam that is a hundred times as wide: us a point, traces, boxes of the proof; and if
// there are many, us a box, with the few traces.
#include <sagitta/aim.h>
#include <sagitta/surfaces.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <functional>
#include <string>
#include <vector>

namespace {

struct Lens {
    std::string name;
    std::vector<sgt_element> e;
    double reach, slope, start;  // rays: |x|, |y| and slopes at z = 0, and where they begin
};

sgt_conic spheres[40];
sgt_even_asphere aspheres[8];
sgt_odd_asphere odd, odds[6];
const double coefficients[16] = { 0, 1e-6, -2e-6, 1e-5, 2e-6, -1e-6 };
sgt_zernike zernike, zernikes[6];
int used;

sgt_surface sphere(double radius)
{
    spheres[used] = { radius == 0 ? 0 : 1 / radius, 0, 0 };
    return { &sgt_conic_ops, &spheres[used++] };
}

void put(Lens &lens, sgt_surface s, double z, double index)
{
    sgt_element e = {};
    e.surface = s, e.pose.origin = { 0, 0, z }, e.index = index;
    lens.e.push_back(e);
}

Lens triplet(const char *name)
{
    Lens l = { name, {}, 3, 0.1, -20 };
    const double r[7] = { 22.01359, -435.76044, -22.21328, 20.29192, 79.6836, -18.39533, 0 },
                 index[7] = { 1.6226, 1, 1.6237, 1, 1.6226, 1, 1 },
                 z[7] = { 0, 3.25896, 9.26651, 10.26648, 15.01689, 17.96897, 60.17675 };
    for (int i = 0; i < 7; i++)
        put(l, sphere(r[i]), z[i], index[i]);
    return l;
}

std::vector<Lens> lenses()
{
    std::vector<Lens> all = { triplet("triplet, 7 spheres") };
    all.push_back(triplet("the same, all turned"));
    for (sgt_element &e : all.back().e)
        e.pose = sgt_pose_tilted(e.pose.origin, { 0.5, -0.3, 0 });
    all.push_back(triplet("triplet, 3 even aspheres"));
    for (size_t i = 0; i < 3; i++) {
        aspheres[i] = { spheres[used - 7 + int(2 * i)].c, 0, 0, { 0, 1e-6, -2e-9, 1e-11 } };
        all.back().e[2 * i].surface = { &sgt_even_asphere_ops, &aspheres[i] };
    }
    all.push_back(triplet("triplet, 1 odd asphere"));
    odd = { 1 / 22.01359, 0, 12, { 0, 1e-5, 1e-6, -1e-8 } };
    all.back().e[0].surface = { &sgt_odd_asphere_ops, &odd };
    all.push_back(triplet("triplet, 1 zernike of 16"));
    zernike.c = 1 / 22.01359, zernike.semi_diameter = 12, zernike.norm = 12, zernike.order = SGT_FRINGE;
    zernike.a = { coefficients, 1, 16 };
    all.back().e[0].surface = { &sgt_zernike_ops, &zernike };
    all.push_back(triplet("triplet, 6 odd aspheres"));
    all.push_back(triplet("triplet, 6 zernike of 16"));
    for (size_t i = 0; i < 6; i++) {
        odds[i] = odd, zernikes[i] = zernike;
        odds[i].c = zernikes[i].c = spheres[used - 7 + int(i)].c;
        all[all.size() - 2].e[i].surface = { &sgt_odd_asphere_ops, &odds[i] };
        all.back().e[i].surface = { &sgt_zernike_ops, &zernikes[i] };
    }
    return all;
}

std::vector<sgt_ray> rays_of(const Lens &lens)
{
    std::vector<sgt_ray> rays;
    unsigned long long state = 1;
    auto unit = [&state] {
        state = state * 6364136223846793005ULL + 1442695040888963407ULL;
        return double(state >> 11) / 9007199254740992.0 * 2 - 1;
    };
    while (rays.size() < 500) {
        sgt_vec3 d = { lens.slope * unit(), lens.slope * unit(), 1 };
        double x = lens.reach * unit(), y = lens.reach * unit();
        sgt_ray ray = { { x + lens.start * d.x, y + lens.start * d.y, lens.start }, d, 0, 0 }, copy = ray;
        if (sgt_trace(lens.e.size(), lens.e.data(), 1, &copy, nullptr, nullptr, nullptr) == lens.e.size())
            rays.push_back(ray);
    }
    return rays;
}

double seconds()
{
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// Medians of some turns, each ns a ray.
std::vector<double> medians(const std::vector<std::function<void(size_t)>> &works, size_t rays)
{
    std::vector<std::vector<double>> times(works.size());
    for (int turn = 0; turn < 61; turn++)
        for (size_t w = 0; w < works.size(); w++) {
            const double from = seconds();
            for (size_t i = 0; i < rays; i++)
                works[w](i);
            times[w].push_back((seconds() - from) / double(rays) * 1e9);
        }
    std::vector<double> result;
    for (auto &t : times) {
        std::sort(t.begin(), t.end());
        result.push_back(t[t.size() / 2]);
    }
    return result;
}

void derivatives(const Lens &lens)
{
    const size_t n = lens.e.size(), count = sgt_trace_parameters(n, lens.e.data());
    const std::vector<sgt_ray> rays = rays_of(lens);
    std::vector<sgt_passage> passages(n * rays.size());
    std::vector<double> gradient(7 * count);
    sgt_ray_change two[2] = { { { 0, 0, 0 }, { 1, 0, 0 }, 0 }, { { 0, 0, 0 }, { 0, 1, 0 }, 0 } }, out[2];
    sgt_ray_change seven[7] = {};
    for (int r = 0; r < 7; r++)
        (r < 3 ? &seven[r].p.x : r < 6 ? &seven[r].d.x : &seven[r].opl)[r < 6 ? r % 3 : 0] = 1;
    const sgt_element *e = lens.e.data();
    double *all = gradient.data();
    const std::vector<double> t = medians(
        { [&](size_t i) {
             sgt_ray ray = rays[i];
             sgt_trace(n, e, 1, &ray, &passages[n * i], nullptr, nullptr);
         },
          [&](size_t i) { sgt_trace_sensitivity(n, e, 1, &rays[i], &passages[n * i], 2, two, out); },
          [&](size_t i) { sgt_trace_gradient(n, e, 1, &rays[i], &passages[n * i], 1, seven, all); },
          [&](size_t i) { sgt_trace_gradient(n, e, 1, &rays[i], &passages[n * i], 7, seven, all); } },
        rays.size());
    std::printf("%-26s %7.0f ns  %8.2f  %8.2f of %3zu  %8.1f ns of %4zu\n", lens.name.c_str(), t[0],
                t[1] / t[0], t[2] / t[0], count, t[3] / double(7 * count), 7 * count);
}

// Rooms for n rays.
struct Room {
    std::vector<std::vector<double>> arrays;
    std::vector<std::vector<sgt_status>> fates;
    std::vector<sgt_passages> passages;
    size_t n;
    Room(size_t rays, size_t elements) : n(rays)
    {
        for (size_t e = 0; e < elements; e++) {
            sgt_passages p = {};
            fates.emplace_back(n), p.hits.status = fates.back().data();
            p.hits.t = next(), p.hits.p_err = next(), p.opl = next();
            for (int k = 0; k < 3; k++) p.hits.p[k] = next(), p.hits.n[k] = next(), p.direction[k] = next();
            passages.push_back(p);
        }
    }
    double *next() { return arrays.emplace_back(n), arrays.back().data(); }
};

sgt_rays many_rays(Room &room, const std::vector<sgt_ray> &rays)
{
    sgt_rays r = {};
    double *of[6];
    for (double *&x : of) x = room.next();
    for (int k = 0; k < 3; k++) r.o[k] = of[k], r.d[k] = of[3 + k];
    for (size_t i = 0; i < room.n; i++) {
        const double numbers[6] = {rays[i].o.x, rays[i].o.y, rays[i].o.z,
                                   rays[i].d.x, rays[i].d.y, rays[i].d.z};
        for (int k = 0; k < 6; k++) of[k][i] = numbers[k];
    }
    return r;
}

void many(const Lens &lens)
{
    const size_t n = 256, m = lens.e.size(), stop = 4, count = sgt_trace_parameters(m, lens.e.data());
    const sgt_element *e = lens.e.data();
    Room room(n, m), aimed(n, stop + 1);
    const std::vector<sgt_ray> all = rays_of(lens);
    const sgt_rays rays = many_rays(room, all);
    sgt_traced plain = {}, path = {};
    for (int k = 0; k < 3; k++) plain.o[k] = room.next(), plain.d[k] = room.next();
    path = plain, path.opl = room.next();
    sgt_end_errors point = {}, errors = {};
    point.point = errors.point = room.next(), point.grain = errors.grain = room.next();
    errors.path = room.next();
    sgt_ray_changes column[2] = {}, end[2] = {}, weight = {};
    double *const one = room.next(), *const none = room.next();
    std::fill(one, one + n, 1.0);
    for (int j = 0; j < 2; j++)
        for (int k = 0; k < 3; k++)
            column[j].d[k] = j == k ? one : none, end[j].p[k] = room.next(), end[j].d[k] = room.next();
    weight.p[0] = one, weight.p[1] = weight.p[2] = none;
    std::vector<double *> gradient;
    for (size_t j = 0; j < count; j++) gradient.push_back(room.next());

    // a beam, and starts by the derivatives of its middle ray
    sgt_beam beam = {};
    beam.o = {0, 0, -20}, beam.ou = {1, 0, 0}, beam.ov = {0, 1, 0}, beam.d = {0, 0.0875, 1};
    beam.u = {-9, 9}, beam.v = {-11, 7};
    std::vector<sgt_passage> single(m), work(m);
    sgt_aiming chief, a;
    sgt_aim(stop, e, 1, &beam, {0, 0}, single.data(), nullptr, &chief);
    sgt_ray_change by[2] = {{beam.ou, beam.du, 0}, {beam.ov, beam.dv, 0}};
    sgt_trace_sensitivity(stop + 1, e, 1, &chief.ray, single.data(), 2, by, by);
    const double det = by[0].p.x * by[1].p.y - by[1].p.x * by[0].p.y;
    std::vector<sgt_vec2> wanted(n), start(n);
    for (size_t i = 0; i < n; i++) {
        const double turn = 0.0628 * double(i), r = 3 * double(i % 10 + 1) / 10, x = r * std::cos(turn),
                     y = r * std::sin(turn);
        wanted[i] = {x, y};
        start[i] = {chief.u + (by[1].p.y * x - by[1].p.x * y) / det,
                    chief.v + (by[0].p.x * y - by[0].p.y * x) / det};
    }
    sgt_aim_options from = {}, first = {};
    from.starts = first.starts = 1, from.max_boxes = first.max_boxes = -1, from.start = start.data();
    const sgt_traced nothing = {};
    const sgt_traces traces = {n, rays, room.passages.data()};
    const sgt_aims aims = {n, wanted.data(), nullptr, aimed.passages.data()};
    std::vector<double> t = medians(
        {[&](size_t) { sgt_trace_batch(m, e, 1, n, rays, plain, nullptr, nullptr); },
         [&](size_t) { sgt_trace_batch(m, e, 1, n, rays, path, nullptr, nullptr); },
         [&](size_t) { sgt_trace_batch(m, e, 1, n, rays, nothing, room.passages.data(), nullptr); },
         [&](size_t) { sgt_trace_error_batch(m, e, 1, &traces, point); },
         [&](size_t) { sgt_trace_error_batch(m, e, 1, &traces, errors); },
         [&](size_t) { sgt_trace_sensitivity_batch(m, e, 1, &traces, 2, column, end); },
         [&](size_t) { sgt_trace_gradient_batch(m, e, 1, &traces, 1, &weight, gradient.data()); },
         [&](size_t) { sgt_aim_batch(stop, e, 1, &beam, &aims, work.data(), &from); }},
        1);
    sgt_ray ray = all[0];
    sgt_trace(m, e, 1, &ray, single.data(), nullptr, nullptr);
    const std::vector<double> alone =
        medians({[&](size_t) {
                     sgt_end_error told;
                     sgt_trace_error(m, e, 1, &all[0], single.data(), &told);
                 },
                 [&](size_t i) {
                     first.start = &start[i];
                     sgt_aim(stop, e, 1, &beam, wanted[i], work.data(), &first, &a);
                 }},
                n);
    for (double &x : t) x /= double(n);
    std::printf("%-26s %6.1f %7.1f %7.1f  (%4.2f)", lens.name.c_str(), t[0], t[1], t[2], t[2] / t[0]);
    for (size_t k = 3; k < t.size(); k++) std::printf(" %6.0f (%4.2f)", t[k], t[k] / t[0]);
    std::printf("   %.0f, %.0f\n", alone[0], alone[1]);
}

// Points at `size` from the axis; the beam is so many times as wide.
void aim_at(const Lens &lens, double size, double wide, const char *what)
{
    const size_t stop = lens.e.size() - 1;
    std::vector<sgt_passage> passages(lens.e.size());
    sgt_beam beam = {};
    beam.o = { 0, 0, -20 }, beam.ou = { 1, 0, 0 }, beam.ov = { 0, 1, 0 }, beam.d = { 0, 0.0875, 1 };
    beam.u = { -9 * wide, 9 * wide }, beam.v = { -11 * wide, 7 * wide };
    const size_t points = wide > 1 ? 3 : 100;
    size_t met = 0, none = 0, traces = 0, boxes = 0, asked = 0;
    const std::vector<double> t = medians(
        { [&](size_t i) {
            const double turn = 0.0628 * double(i), r = size * double(i % 10 + 1) / 10;
            const sgt_vec2 wanted = { r * std::cos(turn), size + r * std::sin(turn) };
            sgt_aiming a;
            sgt_aim(stop, lens.e.data(), 1, &beam, wanted, passages.data(), nullptr, &a);
            met += a.status == SGT_MET, none += a.status == SGT_NO_SUCH_RAY, asked++;
            traces += size_t(a.traces), boxes += size_t(a.boxes);
        } },
        points);
    const double n = double(asked);
    std::printf("%-26s %-8s %8.1f us  %5.1f traces  %6.1f boxes   %3.0f %% met, %3.0f %% none",
                lens.name.c_str(), what, t[0] / 1000, double(traces) / n, double(boxes) / n,
                100 * double(met) / n, 100 * double(none) / n);
    if (wide > 1) std::printf("   %5.2f us a box", t[0] / 1000 / (double(boxes) / n));
    std::printf("\n");
}

} // namespace

int main()
{
    std::printf("%-26s %10s  %8s  %15s  %s\n", "lens", "trace", "launch", "gradient", "jacobian, each");
    std::vector<Lens> all = lenses();
    for (const Lens &lens : all)
        derivatives(lens);
    std::printf("\n%-26s %6s %7s %16s %13s %13s %13s %13s %13s   %s\n", "many rays", "trace", "path",
                "passages", "point", "errors", "launch", "gradient", "aim", "one by one");
    for (const Lens &lens : all)
        many(lens);
    std::printf("\n");
    for (Lens &lens : all) {
        lens.e.resize(5); // to the front of the last lens
        aim_at(lens, 1, 1, "inside");
        aim_at(lens, 60, 1, "outside");
        aim_at(lens, 60, 100, "wide");
    }
    return 0;
}
