// SPDX-License-Identifier: MIT
// The scan lens of consumer.c as a C++ program would trace it: nothing but the
// installed library.  Prints the height on the image for each field; exits with
// the number of rays that are not where a trace at 50 digits puts them.
#include <cmath>
#include <cstdio>
#include <deque>
#include <limits>
#include <vector>
#include <sagitta/diagnose.h>
#include <sagitta/surfaces.h>
#include <sagitta/system.h>

class Lens {
public:
    void add(double radius, double z, double index)
    {
        sgt_conic shape = { 1 / radius, 0, 0 };
        shapes.push_back(shape);
        sgt_element element = sgt_element();
        element.surface.ops = &sgt_conic_ops;
        element.surface.self = &shapes.back();
        element.pose.origin.z = z;
        element.index = index;
        elements.push_back(element);
    }
    bool trace(sgt_vec3 o, sgt_vec3 d, sgt_vec3 &point) const
    {
        sgt_ray ray = { o, d, 0, 0 };
        std::vector<sgt_passage> at(elements.size());
        sgt_fate fate;
        size_t passed = sgt_trace(elements.size(), elements.data(), 1, &ray, at.data(), &fate, nullptr);
        point = at.back().hit.p;
        return passed == elements.size();
    }
private:
    std::deque<sgt_conic> shapes;  // never moved: the elements point at them
    std::vector<sgt_element> elements;
};

int main()
{
    const double flat = std::numeric_limits<double>::infinity(), glass = 1.8395380486608464;
    Lens lens;
    lens.add(flat, 0, 1);
    lens.add(-2.2136, 5.0, glass);
    lens.add(-2.6575, 5.3, 1);
    lens.add(-5.5022, 5.319999999999999, glass);
    lens.add(-3.8129, 5.8492, 1);
    lens.add(7.9951, 10.1419, glass);
    lens.add(8.3651, 10.7319, 1);
    lens.add(flat, 28.7333, 1);

    const struct { double y, m, n, height; } rays[] = {
        { 0, 0, 1, 0 },
        { 0.5, 0, 1, 0.002307925412564594611055892 },
        { -0.2679491924311227, 0.2588190451025208, 0.9659258262890684, 5.234820045459811411434062 },
        { -0.7679491924311227, 0.2588190451025208, 0.9659258262890684, 5.247190278715706976243825 },
    };
    int wrong = 0;
    for (const auto &ray : rays) {
        sgt_vec3 point = { 0, 0, 0 };
        bool arrived = lens.trace({ 0, ray.y, -1 }, { 0, ray.m, ray.n }, point);
        std::printf("from y = %7.4f at m = %.4f: y = %.16f\n", ray.y, ray.m, point.y);
        wrong += !(arrived && std::fabs(point.y - ray.height) < 1e-12 * 28.7333 && point.x == 0);
    }

    // Every other header of the library links from C++ too.
    sgt_log log = { nullptr, 0, 0 };
    wrong += sgt_diagnose(&log).verdict != SGT_WANDERING;
    return wrong;
}
