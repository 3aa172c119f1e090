// SPDX-License-Identifier: MIT
// level_sets.h - what the benchmarks of level sets share: the sets, the rays of a picture of 640 x 480, and
// POV-Ray as a peer.
//
// POV-Ray traces the same rays through the same surface: its max_iteration M tests |Q_0| ... |Q_{M-1}|, our
// N is M - 1; its bound is R = min(2, 1 + |c| + 1e-7) and |Q|^2 > R^2 + 1e-7 has escaped, which is our
// escape.  Its time is what it says its trace phase took of the processor, less the same for an empty
// scene; it includes the normal, and so does ours.  Its hits come from a picture of depths, exact to 2e-9
// (povray/julia.pov); that the rays are the same is seen first on a sphere.
#ifndef BENCH_LEVEL_SETS_H
#define BENCH_LEVEL_SETS_H

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>
#include <stdlib.h>
#include <time.h>
#include <unistd.h>
#ifdef __linux__
#include <sched.h>
#endif
#include <sagitta/surfaces.h>
#include "march_rules.h"

namespace {

using march::NONE;

// --------------------------------------------------------- the sets, the rays

struct Case {
    const char *name;
    double c[4];
    int iterations, povray_c;
};
const Case CASES[] = {
    { "c1-N7", { -0.083, 0, -0.83, -0.025 }, 7, 1 },
    { "c1-N11", { -0.083, 0, -0.83, -0.025 }, 11, 1 },
    { "c2-N7", { -0.2, 0.8, 0, 0 }, 7, 2 },
};

inline sgt_julia julia(const Case &one)
{
    sgt_julia s = {};
    double norm2 = 0;
    for (int i = 0; i < 4; i++) {
        s.c[i] = one.c[i];
        norm2 += one.c[i] * one.c[i];
    }
    double bound = std::min(2.0, 1 + std::sqrt(norm2) + 1e-7);
    s.escape = std::sqrt(bound * bound + 1e-7);
    s.iterations = one.iterations;
    return s;
}

int width = 640, height = 480;

inline std::vector<sgt_ray> camera()
{
    const sgt_vec3 o = { 1.2, 0.9, -3.2 }, d = { -0.47536594, -0.35652446, 1.26764251 };
    const sgt_vec3 right = { 1.24843890, 0.0, 0.46816459 }, up = { -0.08941721, 0.96703057, 0.23844589 };
    std::vector<sgt_ray> rays;
    for (int y = 0; y < height; y++)
        for (int x = 0; x < width; x++) {
            double u = (x + 0.5) / width - 0.5, v = (height - 1 - y + 0.5) / height - 0.5;
            sgt_vec3 w = {d.x + u * right.x + v * up.x, d.y + u * right.y + v * up.y,
                          d.z + u * right.z + v * up.z};
            double length = std::sqrt(march::dot(w, w));
            rays.push_back({ o, { w.x / length, w.y / length, w.z / length }, 0, 0 });
        }
    return rays;
}

// ----------------------------------------------------------------------- time

// To the last of the processors allowed, and POV-Ray inherits it.
inline void to_one_processor()
{
#ifdef __linux__
    cpu_set_t allowed, last;
    CPU_ZERO(&last);
    if (sched_getaffinity(0, sizeof allowed, &allowed) == 0) {
        for (int i = 0, left = CPU_COUNT(&allowed); left > 0; i++)
            if (CPU_ISSET(i, &allowed) && --left == 0)
                CPU_SET(i, &last);
        sched_setaffinity(0, sizeof last, &last);
    }
#endif
}

inline double now()
{
    timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

inline double median(std::vector<double> sorted)
{
    std::sort(sorted.begin(), sorted.end());
    return (sorted[(sorted.size() - 1) / 2] + sorted[sorted.size() / 2]) / 2;
}

// -------------------------------------------------------------------- POV-Ray

class Povray {
public:
    Povray()
    {
        char name[] = "/tmp/bench_level_sets.XXXXXX";
        const char *made = mkdtemp(name);
        folder = made ? made : "";
        found = made && seconds_empty() >= 0;
    }
    ~Povray()
    {
        if (!folder.empty()) {
            std::remove((folder + "/image.ppm").c_str());
            std::remove((folder + "/image.png").c_str());
            rmdir(folder.c_str());
        }
    }
    Povray(const Povray &) = delete;
    Povray &operator=(const Povray &) = delete;

    // Seconds of its trace phase; negative: it did not run.
    double seconds_empty() { return run("empty.pov", "+FN8"); }
    double seconds(const Case &one, double precision)
    {
        return run("julia.pov", "+FN8 Declare=DEPTH=0" + declare(one.povray_c, one.iterations, precision));
    }

    // t for each ray, NaN where nothing is hit; empty: it did not run.
    std::vector<double> depths(int c, int iterations, double precision)
    {
        std::vector<double> t;
        if (run("julia.pov", "+FP16 File_Gamma=1 Declare=DEPTH=1" + declare(c, iterations, precision)) < 0)
            return t;
        FILE *file = std::fopen((folder + "/image.ppm").c_str(), "rb");
        if (!file)
            return t;
        char line[256];
        while (std::fgets(line, sizeof line, file) && std::strcmp(line, "65535\n") != 0) {}
        unsigned char pixel[6];
        while (std::fread(pixel, sizeof pixel, 1, file) == 1) {
            int red = pixel[0] << 8 | pixel[1], green = pixel[2] << 8 | pixel[3],
                blue = pixel[4] << 8 | pixel[5];
            t.push_back(blue ? (red + green / 65535.0) / 4096 : NONE);
        }
        std::fclose(file);
        return t;
    }
    bool found;

private:
    static std::string declare(int c, int iterations, double precision)
    {
        return " Declare=CC=" + std::to_string(c) + " Declare=MI=" + std::to_string(iterations + 1) +
               " Declare=PR=" + std::to_string(precision);
    }
    double run(const std::string &scene, const std::string &words)
    {
        std::string command = "povray '+I" SCENES "/" + scene + "' '+L" SCENES "' '+O" + folder +
                              "/image' +W" + std::to_string(width) + " +H" + std::to_string(height) +
                              " +WT1 -D -A -J " + words + " 2>&1 </dev/null";
        FILE *pipe = popen(command.c_str(), "r");
        if (!pipe)
            return -1;
        std::string said;
        char part[4096];
        size_t n;
        while ((n = std::fread(part, 1, sizeof part, pipe)) > 0)
            said.append(part, n);
        if (pclose(pipe) != 0)
            return -1;
        size_t at = said.find("Trace Time:");
        size_t with = at == std::string::npos ? at : said.find("with ", at);
        return with == std::string::npos ? -1 : std::atof(said.c_str() + with + 5);
    }
    std::string folder;
};

// Does POV-Ray trace the rays we think it does?  The sphere of povray/julia.pov tells.
inline bool same_rays(Povray &povray, const std::vector<sgt_ray> &rays)
{
    std::vector<double> t = povray.depths(0, 0, 20);
    size_t wrong = 0;
    for (size_t i = 0; i < rays.size() && i < t.size(); i++) {
        sgt_span inside = march::ball(rays[i], 1.2);
        wrong += std::isnan(t[i]) ? inside.lo < inside.hi : !(std::fabs(t[i] - inside.lo) < 1e-8);
    }
    std::fprintf(stderr, "POV-Ray's sphere: %zu rays, %zu of them not as ours\n", t.size(), wrong);
    return t.size() == rays.size() && wrong == 0;
}

} // namespace
#endif
