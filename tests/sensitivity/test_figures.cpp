// SPDX-License-Identifier: MIT
// test_figures.cpp - derivatives of spots by numbers of lens files, against differences in 113 bits.
//
// Random lenses are written as files: spheres, conics, aspheres and toroids, some tilted, behind a pupil that
// the file gives, so that the launch rays are the same whatever the surfaces are.  Their spots are worked out
// again by slow_trace.h, in 113 bits, with one number of the file changed by far less than an ulp of a
// double: that gives the rms and its derivative, which share nothing with the library but the launch rays.
// What a number of the file does to an element is written here once more, from docs/lens_file.md.
#include "../oracle/cases.h"
#include "slow_trace.h"

#include <sagitta/figure.h>

#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>

using oracle::generator;
using oracle::quad;

namespace
{

int failures, compared;
double worst, worst_value;

// A number of the file, and what it changes: by(elements, h).
struct number {
    std::string path;
    enum { RADIUS, PARAMETER, THICKNESS, INDEX, TILT } kind;
    std::size_t surface, parameter;
    double x;
};

struct random_lens {
    std::string text;
    std::vector<number> numbers;
};

std::string print(const char *form, double x)
{
    char text[64];
    std::snprintf(text, sizeof text, form, x);
    return text;
}

random_lens make(generator &g)
{
    random_lens r;
    const std::size_t count = 2 + g.bits() % 5;
    r.text = "{units: mm, wavelengths: [0.55], pupil: {semi_diameter: " + print("%.17g", g.uniform(1, 4)) +
             ", distance: " + print("%.17g", g.uniform(-3, 6)) + "}, fields: [0, " +
             print("%.17g", g.uniform(1, 6)) + ", [" + print("%.17g", g.uniform(-3, 3)) +
             ", 2]], surfaces: [\n";
    for (std::size_t i = 0; i < count; i++) {
        const std::string at = "surfaces[" + std::to_string(i + 1) + "].";
        const double radius = g.sign() * g.uniform(25, 80), thickness = g.uniform(1, 6),
                     index = i % 2 == 0 ? g.uniform(1.4, 1.8) : g.uniform(1, 1.1);
        const std::size_t type = g.bits() % 4;
        const char *const name[] = {"sphere", "conic", "even_asphere", "odd_asphere"};
        r.text += std::string("{type: ") + name[type] + ", radius: " + print("%.17g", radius);
        r.numbers.push_back({at + "radius", number::RADIUS, i, 0, radius});
        if (type > 0) {
            const double conic = g.uniform(-2, 1);
            r.text += ", conic: " + print("%.17g", conic);
            r.numbers.push_back({at + "conic", number::PARAMETER, i, 1, conic});
        }
        if (type > 1) {
            r.text += ", coefficients: [";
            for (std::size_t j = 0; j < 3; j++) {
                const double unit = type == 2 ? std::pow(8, -2 * double(j) - 1) : std::pow(8, -double(j)),
                             a = (type == 3 && j == 0) || g.chance(0.2) ? 0 : g.uniform(-0.02, 0.02) * unit;
                r.text += (j ? ", " : "") + print("%.17g", a);
                if (!(type == 3 && j == 0)) // (whose rays through the tip have no derivative)
                    r.numbers.push_back(
                        {at + "coefficients[" + std::to_string(j + 1) + "]", number::PARAMETER, i, 2 + j, a});
            }
            r.text += "]";
        }
        if (g.chance(0.4)) {
            const double tilt = g.chance(0.3) ? 0 : g.uniform(-3, 3);
            r.text += ", tilt: [" + print("%.17g", tilt) + ", " + print("%.17g", g.uniform(-2, 2)) + ", 0]";
            r.numbers.push_back({at + "tilt[1]", number::TILT, i, 0, tilt});
        }
        r.text += ", thickness: " + print("%.17g", thickness) + ", index: " + print("%.17g", index) + "},\n";
        r.numbers.push_back({at + "thickness", number::THICKNESS, i, 0, thickness});
        r.numbers.push_back({at + "index", number::INDEX, i, 0, index});
    }
    r.text += "{type: plane}]}\n";
    return r;
}

void move(std::vector<slow::element> &e, const number &n, quad h)
{
    const quad degree = (quad(3.141592653589793116) + quad(1.2246467991473532e-16)) / 180;
    slow::element &s = e[n.surface];
    switch (n.kind) {
    case number::RADIUS:
        s.a[0] = 1 / (quad(n.x) + h);
        break;
    case number::PARAMETER:
        s.a[n.parameter] += h;
        break;
    case number::THICKNESS:
        for (std::size_t i = n.surface + 1; i < e.size(); i++) e[i].origin.z += h;
        break;
    case number::INDEX:
        s.index += h;
        break;
    case number::TILT:
        s.turn.x += h * degree;
        break; // the turn about x comes first: about its own axis
    }
}

struct ray {
    slow::vec o, d;
    double weight;
};

// The rms of a field about its chief ray, rays[0]; below 0: not all get there.
quad spot(const std::vector<slow::element> &e, const std::vector<ray> &rays)
{
    quad sum = 0, all = 0;
    slow::vec chief = {0, 0, 0};
    for (std::size_t i = 0; i < rays.size(); i++) {
        const slow::end r = slow::trace(e, e.size(), 1, rays[i].o, rays[i].d);
        if (r.passed < e.size()) return -1;
        if (i == 0) chief = r.p;
        const quad x = r.p.x - chief.x, y = r.p.y - chief.y, w = rays[i].weight;
        sum += w * (x * x + y * y), all += w;
    }
    return oracle::square_root(sum / all);
}

std::vector<ray> rays_of(const sgt_launcher *from, const sgt_lens *lens, std::size_t field, std::size_t rings)
{
    std::vector<sgt_pupil_point> at(sgt_pupil_points(SGT_PATTERN_HEXAPOLAR, rings, 0, 0, nullptr));
    sgt_pupil_points(SGT_PATTERN_HEXAPOLAR, rings, 0, at.size(), at.data());
    at.insert(at.begin(), {0, 0, 0}); // the chief ray
    std::vector<sgt_launched> launched(at.size());
    sgt_field_beam beam;
    std::vector<ray> r;
    if (!sgt_launch_field(from, lens->field_kind, &lens->field[field], &beam, nullptr) ||
        !sgt_launch_rays(from, &beam, lens->element, lens->index_before, at.size(), at.data(),
                         launched.data(), nullptr))
        return r;
    for (std::size_t i = 0; i < at.size(); i++)
        r.push_back({slow::of(launched[i].ray.o), slow::of(launched[i].ray.d), at[i].weight});
    return r;
}

bool try_lens(generator &g)
{
    constexpr std::size_t RINGS = 1;
    const random_lens made = make(g);
    sgt_error e = {};
    const std::unique_ptr<sgt_lens, void (*)(sgt_lens *)> lens(
        sgt_lens_read_text("random.yaml", made.text.data(), made.text.size(), nullptr, &e), sgt_lens_free);
    if (!lens) return std::printf("%s: %s\n%s", e.key, e.words, made.text.c_str()), failures++, false;
    const std::unique_ptr<sgt_launcher, void (*)(sgt_launcher *)> from(
        sgt_launcher_new(lens.get(), nullptr, &e), sgt_launcher_free);
    std::vector<const char *> paths;
    for (const number &n : made.numbers) paths.push_back(n.path.c_str());
    sgt_study_options study = {};
    study.rays = RINGS;
    const std::unique_ptr<sgt_figure, void (*)(sgt_figure *)> f(
        sgt_figure_new(lens.get(), &study, nullptr, paths.size(), paths.data(), &e), sgt_figure_free);
    if (!f || !from) return std::printf("%s: %s\n%s", e.key, e.words, made.text.c_str()), failures++, false;
    const std::size_t values = sgt_figure_size(f.get()).values, count = paths.size();
    std::vector<double> value(values), value_err(values), gradient(values * count), error(values * count);
    sgt_figure_out out = {};
    out.value = value.data(), out.value_err = value_err.data();
    out.gradient = gradient.data(), out.gradient_err = error.data();
    if (!sgt_figure_eval(f.get(), nullptr, &out, &e) || out.lost) return false; // a chief ray, or another
    std::vector<slow::element> elements;
    for (std::size_t i = 0; i < lens->count; i++) elements.push_back(slow::element_of(lens->element[i]));
    for (std::size_t field = 0; field < lens->fields; field++) {
        const std::vector<ray> rays = rays_of(from.get(), lens.get(), field, RINGS);
        const quad rms = spot(elements, rays);
        if (!(rms > 0)) return false;
        const double off = oracle::to_double(oracle::magnitude(rms - quad(value[field])));
        worst_value = std::fmax(worst_value, off / value_err[field]);
        if (!(off <= value_err[field])) {
            std::printf("rms %.17g is off by %g, not %g\n%s", value[field], off, value_err[field],
                        made.text.c_str());
            failures++;
        }
        for (std::size_t m = 0; m < count; m++) {
            const quad h = quad(1e-13) * quad(std::fmax(std::fabs(made.numbers[m].x), 1e-6));
            std::vector<slow::element> up = elements, down = elements;
            move(up, made.numbers[m], h), move(down, made.numbers[m], -h);
            const double by = oracle::to_double((spot(up, rays) - spot(down, rays)) / (2 * h));
            const double is = gradient[field * count + m], told = error[field * count + m];
            const double apart = std::fabs(is - by);
            compared++;
            const double share = std::fabs(by * made.numbers[m].x) / value[field];
            if (share > 1e-6) worst = std::fmax(worst, apart / std::fabs(by)); // of what matters
            if (!(apart <= told) || !(told <= 1e-6 * std::fabs(by) + 1e-9)) {
                std::printf("by %s: %.17g, not %.17g; told %g\n%s", paths[m], is, by, told,
                            made.text.c_str());
                failures++;
            }
        }
    }
    return true;
}

} // namespace

int main()
{
    const char *text = std::getenv("SAGITTA_TEST_SCALE"), *seed = std::getenv("SAGITTA_TEST_SEED");
    generator g(seed ? std::strtoull(seed, nullptr, 10) : 391);
    const int lenses = static_cast<int>(40 * (text ? std::atof(text) : 0.5));
    int tried = 0;
    for (int drawn = 0; tried < lenses && drawn < 20 * lenses; drawn++) tried += try_lens(g);
    std::printf("%d lenses, %d derivatives; the worst is off by %.2g of it; an rms by %.2g of its bound\n",
                tried, compared, worst, worst_value);
    return failures != 0 || tried < lenses;
}
