// SPDX-License-Identifier: MIT
// test_figures.cpp - derivatives of spots and wavefronts by numbers of lens files, against differences in 113
// bits.
//
// Random lenses are written as files: spheres, conics, aspheres and toroids.  Some numbers are pickups of
// others, and the image may stand where the paraxial focus is.  There are three kinds:
//
//   TILTED    some surfaces are tilted, behind a pupil that the file gives: launch rays are the same whatever
//             the surfaces are
//   STRAIGHT  none is, so that there is an exit pupil, and a wavefront to compare
//   AIMED     the same with a stop among the surfaces, at which rays are aimed
//
// Their spots and wavefronts are worked out again by slow_trace.h, in 113 bits, with one number of the file
// changed by far less than an ulp of a double: that gives the rms and its derivative, which share nothing
// with the library but the launch rays, and of aimed rays not even these: they are sought in 113 bits. Pupils
// and foci are by paraxial rays, y and n u (Welford 1986, 3.2).  What a number of the file does to an element
// is written here once more, from docs/lens_file.md.
#include "../oracle/cases.h"
#include "slow_trace.h"

#include <sagitta/figure.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>

using oracle::generator;
using oracle::quad;

namespace
{

int failures, compared;
double worst, worst_value, worst_error;

enum kind { TILTED, STRAIGHT, AIMED, KINDS };

// What a number of the file changes: it is `scale` times the number (of pickups other than 1).
struct effect {
    enum { RADIUS, PARAMETER, THICKNESS, INDEX, TILT, PUPIL } what;
    std::size_t surface, parameter;
    double scale;
};

struct number {
    std::string path;
    double x;
    std::vector<effect> effects;
};

struct random_lens {
    std::string text;
    std::vector<number> numbers;
    kind of;
    std::size_t stop; // of AIMED
    double semi_diameter;
    bool solved; // the image is at the paraxial focus
};

std::string print(const char *form, double x)
{
    char text[64];
    std::snprintf(text, sizeof text, form, x);
    return text;
}

// Writes a number, or a pickup of an earlier one of the same key with the effect of its own.
void put_number(generator &g, random_lens &r, std::size_t surface, const char *key, double x, effect e)
{
    static const double scales[] = {1, -1, 0.5, 2};
    std::vector<number *> same;
    for (number &n : r.numbers)
        if (n.effects[0].what == e.what && n.effects[0].parameter == e.parameter &&
            n.path.find(key) != std::string::npos)
            same.push_back(&n);
    if (!same.empty() && r.of != TILTED && g.chance(0.3)) {
        number &from = *same[g.bits() % same.size()];
        e.scale = scales[e.what == effect::RADIUS ? g.bits() % 4 : 2 * (g.bits() % 2)];
        r.text += std::string(key) + ": {pickup: \"" + from.path + "\", scale: " + print("%g", e.scale) + "}";
        from.effects.push_back(e);
        return;
    }
    r.text += std::string(key) + ": " + print("%.17g", x);
    r.numbers.push_back({"surfaces[" + std::to_string(surface + 1) + "]." + key, x, {e}});
}

random_lens make(generator &g, kind of)
{
    random_lens r;
    const std::size_t count = 2 + g.bits() % 5;
    r.of = of, r.stop = g.bits() % count, r.semi_diameter = g.uniform(1, 4);
    r.solved = of != TILTED && g.chance(0.3);
    r.text = "{units: mm, wavelengths: [0.55], pupil: {semi_diameter: " + print("%.17g", r.semi_diameter) +
             (of == AIMED ? "}, aim: stop" : ", distance: " + print("%.17g", g.uniform(-3, 6)) + "}") +
             ", fields: [0, " + print("%.17g", g.uniform(1, 6)) + ", [" + print("%.17g", g.uniform(-3, 3)) +
             ", 2]], surfaces: [\n";
    if (of == AIMED)
        r.numbers.push_back({"pupil.semi_diameter", r.semi_diameter, {{effect::PUPIL, 0, 0, 1}}});
    for (std::size_t i = 0; i < count; i++) {
        const std::string at = "surfaces[" + std::to_string(i + 1) + "].";
        const std::size_t type = g.bits() % (of == TILTED ? 4 : 3); // (an odd asphere may have no focus)
        const char *const name[] = {"sphere", "conic", "even_asphere", "odd_asphere"};
        r.text += std::string("{type: ") + name[type] + ", ";
        put_number(g, r, i, "radius", g.sign() * g.uniform(25, 80), {effect::RADIUS, i, 0, 1});
        if (type > 0) {
            r.text += ", ";
            put_number(g, r, i, "conic", g.uniform(-2, 1), {effect::PARAMETER, i, 1, 1});
        }
        if (type > 1) {
            r.text += ", coefficients: [";
            for (std::size_t j = 0; j < 3; j++) {
                const double unit = type == 2 ? std::pow(8, -2 * double(j) - 1) : std::pow(8, -double(j)),
                             a = (type == 3 && j == 0) || g.chance(0.2) ? 0 : g.uniform(-0.02, 0.02) * unit;
                r.text += (j ? ", " : "") + print("%.17g", a);
                if (!(type == 3 && j == 0)) // (whose rays through the tip have no derivative)
                    r.numbers.push_back({at + "coefficients[" + std::to_string(j + 1) + "]",
                                         a,
                                         {{effect::PARAMETER, i, 2 + j, 1}}});
            }
            r.text += "]";
        }
        if (of == TILTED && g.chance(0.4)) {
            const double tilt = g.chance(0.3) ? 0 : g.uniform(-3, 3);
            r.text += ", tilt: [" + print("%.17g", tilt) + ", " + print("%.17g", g.uniform(-2, 2)) + ", 0]";
            r.numbers.push_back({at + "tilt[1]", tilt, {{effect::TILT, i, 0, 1}}});
        }
        r.text += ", ";
        if (r.solved && i + 1 == count)
            r.text += "thickness: {solve: paraxial_focus}";
        else
            put_number(g, r, i, "thickness", g.uniform(1, 6), {effect::THICKNESS, i, 0, 1});
        const double index = i % 2 == 0 ? g.uniform(1.4, 1.8) : g.uniform(1, 1.1);
        r.text +=
            ", index: " + print("%.17g", index) + (of == AIMED && i == r.stop ? ", stop: true},\n" : "},\n");
        r.numbers.push_back({at + "index", index, {{effect::INDEX, i, 0, 1}}});
    }
    r.text += "{type: plane}]}\n";
    return r;
}

// ------------------------------------------------------------------ paraxial rays

quad vertex_curvature(const slow::element &e)
{
    const bool even = e.surface.ops == &sgt_even_asphere_ops;
    return e.a.empty() ? quad(0) : e.a[0] + (even ? 2 * e.a[2] : quad(0));
}

// y and n u of a ray that meets surface `first` at y with n u in front of it, at the vertex plane of `last`;
// it is not bent there.
struct paraxial {
    quad y, nu, n;
};
paraxial pass(const std::vector<slow::element> &e, std::size_t first, std::size_t last, paraxial r)
{
    for (std::size_t i = first; i < last; i++) {
        const quad behind = e[i].index == 0 ? r.n : e[i].index;
        r.nu -= r.y * (behind - r.n) * vertex_curvature(e[i]);
        r.n = behind;
        r.y += (e[i + 1].origin.z - e[i].origin.z) * r.nu / r.n;
    }
    return r;
}

// ---------------------------------------------------------------- a lens that is moved

struct moved_lens {
    std::vector<slow::element> e;
    quad stop_radius, exit_pupil; // from the image
};

moved_lens move(const random_lens &made, std::vector<slow::element> e, const number *n, quad h)
{
    const quad degree = (quad(3.141592653589793116) + quad(1.2246467991473532e-16)) / 180;
    quad semi_diameter = made.semi_diameter;
    for (std::size_t k = 0; n && k < n->effects.size(); k++) {
        const effect &f = n->effects[k];
        slow::element &s = e[f.surface];
        switch (f.what) {
        case effect::RADIUS:
            s.a[0] = 1 / (f.scale * (quad(n->x) + h));
            break;
        case effect::PARAMETER:
            s.a[f.parameter] += f.scale * h;
            break;
        case effect::THICKNESS:
            for (std::size_t i = f.surface + 1; i < e.size(); i++) e[i].origin.z += f.scale * h;
            break;
        case effect::INDEX:
            s.index += h;
            break;
        case effect::TILT:
            s.turn.x += h * degree;
            break; // the turn about x comes first: about its own axis
        case effect::PUPIL:
            semi_diameter += h;
            break;
        }
    }
    const std::size_t image = e.size() - 1, first = made.of == AIMED ? made.stop : 0;
    if (made.solved) {
        const paraxial r = pass(e, 0, image, {1, 0, 1});
        e[image].origin.z -= r.y * r.n / r.nu;
    }
    quad index = 1;
    for (std::size_t i = 0; i < first; i++) index = e[i].index == 0 ? index : e[i].index;
    const paraxial centre = pass(e, first, image, {0, index, index}); // of the stop, the first surface else
    return {e, pass(e, 0, first, {semi_diameter, 0, 1}).y, -centre.y * centre.n / centre.nu};
}

struct ray {
    slow::vec o, d;
    sgt_pupil_point at;
};

// Moves the ray across its direction until it meets its point of the stop: Newton's method, differences.
void aim(const moved_lens &l, std::size_t stop, ray &r)
{
    const quad h = 1e-17, size = oracle::magnitude(l.stop_radius);
    const slow::vec away = oracle::magnitude(r.d.x) < oracle::magnitude(r.d.y) ? slow::vec{1, 0, 0}
                                                                               : slow::vec{0, 1, 0},
                    u = slow::unit(slow::outer(r.d, away)), v = slow::unit(slow::outer(r.d, u));
    const auto miss = [&](const slow::vec &o) {
        const slow::vec p = slow::trace(l.e, stop + 1, 1, o, r.d, true).p;
        return slow::vec{p.x - size * r.at.x, p.y - size * r.at.y, 0};
    };
    const slow::vec at = miss(r.o), by_u = miss(r.o + h * u) - at, by_v = miss(r.o + h * v) - at;
    const quad a = by_u.x / h, b = by_v.x / h, c = by_u.y / h, d = by_v.y / h, all = a * d - b * c;
    for (int i = 0; i < 6; i++) {
        const slow::vec left = miss(r.o);
        if (oracle::magnitude(left.x) + oracle::magnitude(left.y) < 1e-30) break;
        r.o = r.o - ((d * left.x - b * left.y) / all) * u - ((a * left.y - c * left.x) / all) * v;
    }
}

// The rms of a field, rays[0] its chief ray: of the spot about it, or of the path differences, in waves,
// about their mean.  Below 0: not all get there.
quad figure_of(const random_lens &made, sgt_figure_kind kind, const moved_lens &l,
               const std::vector<ray> &rays)
{
    std::vector<slow::end> end;
    quad sum = 0, mean = 0, all = 0;
    std::vector<quad> opd;
    for (ray r : rays) {
        if (made.of == AIMED) aim(l, made.stop, r);
        r.o = r.o - (slow::inner(r.o - rays[0].o, r.d) / slow::inner(r.d, r.d)) * r.d; // one wavefront
        end.push_back(slow::trace(l.e, l.e.size(), 1, r.o, r.d));
        if (end.back().passed < l.e.size()) return -1;
    }
    const slow::vec from_pupil = end[0].p - slow::vec{0, 0, l.exit_pupil};
    const quad side = slow::inner(from_pupil, end[0].d) < 0 ? -1 : 1, R = side * slow::length(from_pupil);
    quad n = 1;
    for (const slow::element &e : l.e) n = e.index == 0 ? n : e.index;
    for (std::size_t i = 0; i < rays.size(); i++) {
        const quad w = rays[i].at.weight;
        const slow::vec v = end[i].p - end[0].p;
        all += w;
        if (kind == SGT_FIGURE_SPOT) {
            sum += w * (v.x * v.x + v.y * v.y);
            continue;
        }
        const quad b = slow::inner(v, end[i].d), h2 = slow::inner(v, v) - b * b;
        opd.push_back((end[i].opl - end[0].opl + n * (R - b - side * oracle::square_root(R * R - h2))) /
                      0.55e-3);
        mean += w * opd[i];
    }
    for (std::size_t i = 0; i < opd.size(); i++)
        sum += rays[i].at.weight * (opd[i] - mean / all) * (opd[i] - mean / all);
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
        r.push_back({slow::of(launched[i].ray.o), slow::unit(slow::of(launched[i].ray.d)), at[i]});
    return r;
}

bool try_figure(const random_lens &made, sgt_figure_kind kind, const sgt_lens *lens, const sgt_launcher *from)
{
    constexpr std::size_t RINGS = 1;
    const double small = kind == SGT_FIGURE_OPD ? 1e-7 : 1e-9;
    static const sgt_pattern hexapolar = SGT_PATTERN_HEXAPOLAR;
    sgt_error e = {};
    std::vector<const char *> paths;
    for (const number &n : made.numbers) paths.push_back(n.path.c_str());
    sgt_study_options study = {};
    study.pattern = &hexapolar, study.rays = RINGS;
    sgt_figure_options opt = {};
    opt.kind = kind;
    const std::unique_ptr<sgt_figure, void (*)(sgt_figure *)> f(
        sgt_figure_new(lens, &study, &opt, paths.size(), paths.data(), &e), sgt_figure_free);
    if (!f) return std::printf("%s: %s\n%s", e.key, e.words, made.text.c_str()), failures++, false;
    const std::size_t values = sgt_figure_size(f.get()).values, count = paths.size();
    std::vector<double> value(values), value_err(values), gradient(values * count), error(values * count);
    sgt_figure_out out = {};
    out.value = value.data(), out.value_err = value_err.data();
    out.gradient = gradient.data(), out.gradient_err = error.data();
    if (!sgt_figure_eval(f.get(), nullptr, &out, &e) || out.lost) return false; // a chief ray, or another
    std::vector<slow::element> elements;
    for (std::size_t i = 0; i < lens->count; i++) elements.push_back(slow::element_of(lens->element[i]));
    elements.back().index = 0; // the image bends no light, whatever is in front of it
    for (std::size_t field = 0; field < lens->fields; field++) {
        const std::vector<ray> rays = rays_of(from, lens, field, RINGS);
        const quad rms =
            rays.empty() ? quad(-1) : figure_of(made, kind, move(made, elements, nullptr, 0), rays);
        if (!(rms > 0)) return false;
        const double off = oracle::to_double(oracle::magnitude(rms - quad(value[field])));
        worst_value = std::fmax(worst_value, off / value_err[field]);
        if (!(off <= value_err[field])) {
            std::printf("rms %.17g is off by %g, not %g\n%s", value[field], off, value_err[field],
                        made.text.c_str());
            failures++;
        }
        for (std::size_t m = 0; m < count; m++) {
            const number &n = made.numbers[m];
            const quad h = quad(1e-13) * quad(std::fmax(std::fabs(n.x), 1e-6)),
                       up = figure_of(made, kind, move(made, elements, &n, h), rays),
                       down = figure_of(made, kind, move(made, elements, &n, -h), rays);
            const double by = oracle::to_double((up - down) / (2 * h));
            const double is = gradient[field * count + m], told = error[field * count + m];
            const double apart = std::fabs(is - by), share = std::fabs(by * n.x) / value[field];
            compared++;
            worst_error = std::fmax(worst_error, apart / told);
            if (share > 1e-6) worst = std::fmax(worst, apart / std::fabs(by)); // of what matters
            // (near a focus that is solved for, what is off in its place cancels between rays)
            const bool sharp = told <= 1e-5 * std::fabs(by) + small * std::fmax(1, value[field]);
            if (!(apart <= told) || !(sharp || (kind == SGT_FIGURE_OPD && made.solved))) {
                std::printf("field %zu by %s: %.17g, not %.17g; told %g\n%s", field + 1, paths[m], is, by,
                            told, made.text.c_str());
                failures++;
            }
        }
    }
    return true;
}

bool try_lens(generator &g, kind of)
{
    const random_lens made = make(g, of);
    sgt_error e = {};
    const std::unique_ptr<sgt_lens, void (*)(sgt_lens *)> lens(
        sgt_lens_read_text("random.yaml", made.text.data(), made.text.size(), nullptr, &e), sgt_lens_free);
    if (!lens) return std::printf("%s: %s\n%s", e.key, e.words, made.text.c_str()), failures++, false;
    const std::unique_ptr<sgt_launcher, void (*)(sgt_launcher *)> from(
        sgt_launcher_new(lens.get(), nullptr, &e), sgt_launcher_free);
    if (!from) return std::printf("%s: %s\n%s", e.key, e.words, made.text.c_str()), failures++, false;
    return try_figure(made, SGT_FIGURE_SPOT, lens.get(), from.get()) &&
           (of == TILTED || try_figure(made, SGT_FIGURE_OPD, lens.get(), from.get()));
}

} // namespace

int main()
{
    const char *text = std::getenv("SAGITTA_TEST_SCALE"), *seed = std::getenv("SAGITTA_TEST_SEED");
    generator g(seed ? std::strtoull(seed, nullptr, 10) : 391);
    const int lenses = std::max(1, static_cast<int>(14 * (text ? std::atof(text) : 0.5)));
    int tried = 0;
    for (int of = TILTED; of < KINDS; of++)
        for (int drawn = 0, own = 0; own < lenses && drawn < 20 * lenses; drawn++)
            if (try_lens(g, static_cast<kind>(of))) own++, tried++;
    std::printf(
        "%d lenses, %d derivatives; the worst is off by %.2g of it, and by %.2g of what is told; an rms by "
        "%.2g of its bound\n",
        tried, compared, worst, worst_error, worst_value);
    return failures != 0 || tried < KINDS * lenses;
}
