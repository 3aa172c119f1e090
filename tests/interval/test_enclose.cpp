// SPDX-License-Identifier: MIT
// The `enclose` of every built-in surface against MPFR: g(t) = F(o + t d) and g'(t) at random t of an
// interval lie in what it says of that interval.
//
//     test_enclose [TYPE]     SAGITTA_TEST_SCALE multiplies the cases, SAGITTA_TEST_SEED replaces the seed
//
// The oracle: F as surfaces.h documents it, by its closed formula or by the orbit, with 1000 bits, of the
// stored parameters, ray and t, all taken as exact.  No step loses more than 900 of them on what is drawn
// here.
//
// What is drawn: surfaces of sizes from 1e-100 to 1e100; rays aimed at a point of the surface, inside its
// domain or beside, or grazing it; along the axis, across it, at any angle; directions of any length;
// origins as far off as 1e12 times the size; stretches as wide as a thousand times the surface, at times
// 1e100 times, and as narrow as a few ulps or none, about the point and beside; the equator itself.  A sag
// is looked at where the ray is nearest to the axis too, and on either side of where it leaves the domain.
//
// What is demanded: where F is defined, g and g' are inside; where the enclosure says that F is undefined
// all over, it is.  What is measured: the width of what is said over the width of what is true, and how
// often g is seen to be monotone on a narrow stretch where it is.  There floors are demanded.
#include <sagitta/surfaces.h>

#include <mpfr.h>

#include <algorithm>
#include <cfloat>
#include <cinttypes>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <string>
#include <vector>

namespace {

// ------------------------------------------------------------------ numbers of 1000 bits

class real {
public:
    real(double x = 0) { mpfr_init2(v, 1000), mpfr_set_d(v, x, MPFR_RNDN); }
    real(const real &o) { mpfr_init2(v, 1000), mpfr_set(v, o.v, MPFR_RNDN); }
    real(real &&o) noexcept { mpfr_init2(v, 2), mpfr_swap(v, o.v); }
    real &operator=(const real &o)
    {
        if (this != &o) mpfr_set_prec(v, 1000), mpfr_set(v, o.v, MPFR_RNDN);
        return *this;
    }
    real &operator=(real &&o) noexcept
    {
        mpfr_swap(v, o.v);
        return *this;
    }
    ~real() { mpfr_clear(v); }
    mpfr_t v;
};

#define OPERATION(sign, name)                     \
    real operator sign(const real &a, const real &b) \
    {                                             \
        real r;                                   \
        mpfr_##name(r.v, a.v, b.v, MPFR_RNDN);    \
        return r;                                 \
    }
OPERATION(+, add)
OPERATION(-, sub)
OPERATION(*, mul)
OPERATION(/, div)
#undef OPERATION
bool operator<(const real &a, const real &b) { return mpfr_cmp(a.v, b.v) < 0; }
bool operator>(const real &a, const real &b) { return mpfr_cmp(a.v, b.v) > 0; }

real root(const real &a)
{
    real r;
    mpfr_sqrt(r.v, a.v, MPFR_RNDN);
    return r;
}
real size_of(const real &a)
{
    real r;
    mpfr_abs(r.v, a.v, MPFR_RNDN);
    return r;
}
real power_of_two(const real &a, long k)
{
    real r;
    mpfr_mul_2si(r.v, a.v, k, MPFR_RNDN);
    return r;
}
double nearest(const real &a) { return mpfr_get_d(a.v, MPFR_RNDN); }

// ------------------------------------------------------------------ F and its slope along a ray

// blur, slope_blur: what the oracle itself may be off by.  scale: the size of what g and g' are sums of.
struct truth {
    bool defined = false, steep = false; // steep: no finite slope there
    real g, slope, blur, slope_blur;
    double scale = 0, slope_scale = 0, margin = 1; // margin: phi^2 of a sag
};

struct along {
    real p[3], d[3];
};
along point(const sgt_ray &ray, const real &t)
{
    const double o[3] = {ray.o.x, ray.o.y, ray.o.z}, d[3] = {ray.d.x, ray.d.y, ray.d.z};
    along a;
    for (int i = 0; i < 3; i++) a.d[i] = real(d[i]), a.p[i] = real(o[i]) + t * a.d[i];
    return a;
}

truth sag_at(double c, double k, const double *a, const sgt_ray &ray, const real &t)
{
    truth e;
    const along at = point(ray, t);
    const real rho = at.p[0] * at.p[0] + at.p[1] * at.p[1], half = at.p[0] * at.d[0] + at.p[1] * at.d[1],
               one(1), cc(c);
    const real phi2 = one - (one + real(k)) * cc * cc * rho;
    e.margin = nearest(phi2);
    if (phi2 < real(0)) return e;
    e.defined = true;
    e.steep = !(phi2 > real(0)) && c != 0;
    const real phi = root(phi2), sag = cc * rho / (one + phi),
               sag_slope = e.steep ? real(0) : cc / (phi + phi);
    real p(0), dp(0), sizes = size_of(sag), slopes = size_of(sag_slope), to(1);
    for (int i = 0; i < 8 && a; i++) {
        const real term = real(a[i]) * to; // a[i] rho^i
        p = p + term * rho, dp = dp + real(i + 1) * term;
        sizes = sizes + size_of(term * rho), slopes = slopes + size_of(real(i + 1) * term);
        to = to * rho;
    }
    e.g = at.p[2] - sag - p;
    e.slope = at.d[2] - (sag_slope + dp) * half * real(2);
    const real whole = size_of(at.p[2]) + sizes,
               whole_slope = size_of(at.d[2]) + size_of(half) * slopes * real(2);
    e.scale = nearest(whole), e.slope_scale = nearest(whole_slope);
    e.blur = power_of_two(whole, -400), e.slope_blur = power_of_two(whole_slope, -400);
    return e;
}

// A quaternion and its derivative along the ray.
struct dual {
    real q[4], v[4];
};
void multiply(const real *a, const real *b, real *out)
{
    out[0] = out[0] + a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3];
    out[1] = out[1] + a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2];
    out[2] = out[2] + a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1];
    out[3] = out[3] + a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0];
}
dual operator*(const dual &a, const dual &b)
{
    dual r;
    multiply(a.q, b.q, r.q), multiply(a.v, b.q, r.v), multiply(a.q, b.v, r.v);
    return r;
}
real dot(const real *a, const real *b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3]; }

struct level { // either set
    bool mandelbrot;
    double c[4], at[4], axes[3][4], escape;
    int iterations, power;
};

// 0: the positive root of x^p = x + |c| by Newton's method from above, where that is convex; of a
// mandelbrot that of x^(p-1) = 2.
real escape_of(const level &s)
{
    if (s.escape != 0) return real(s.escape);
    real c2(0);
    for (double x : s.c) c2 = c2 + real(x) * real(x);
    const real one(1), c = root(c2);
    real x = real(2) + c;
    for (int i = 0; i < 60; i++) {
        real high = one; // x^(p-1)
        for (int k = 1; k < s.power; k++) high = high * x;
        const real p(s.power);
        x = s.mandelbrot ? x - (high - real(2)) * x / ((p - one) * high)
                         : x - (high * x - x - c) / (p * high - one);
    }
    return x;
}

truth level_at(const level &s, const sgt_ray &ray, const real &t)
{
    truth e;
    const along at = point(ray, t);
    dual start, add, q;
    for (int i = 0; i < 4; i++) {
        start.q[i] = real(s.at[i]);
        for (int j = 0; j < 3; j++)
            start.q[i] = start.q[i] + at.p[j] * real(s.axes[j][i]),
            start.v[i] = start.v[i] + at.d[j] * real(s.axes[j][i]);
        add.q[i] = real(s.c[i]);
    }
    q = start;
    if (s.mandelbrot) add = start;
    const real far = power_of_two(real(1), 1L << 20); // well within MPFR's range
    e.defined = true;
    e.scale = 1;
    for (int n = s.mandelbrot ? 1 : 0; n < s.iterations; n++) {
        if (dot(q.q, q.q) > far) { // u will be more than that, and the slope is smaller than any double
            e.g = real(1) - power_of_two(real(1), -900);
            e.blur = real(0), e.slope_blur = power_of_two(real(1), -1075);
            return e;
        }
        dual to = q;
        for (int i = 1; i < s.power; i++) to = to * q;
        for (int i = 0; i < 4; i++) q.q[i] = to.q[i] + add.q[i], q.v[i] = to.v[i] + add.v[i];
    }
    const real escape = escape_of(s), limit = escape * escape, u = dot(q.q, q.q) / limit,
               du = real(2) * dot(q.q, q.v) / limit, one(1);
    e.g = (u - one) / (u + one);
    e.slope = real(2) * du / ((u + one) * (u + one));
    // (p R^(p-1))^N is below 2^480: so many bits at most are lost on the way
    e.blur = power_of_two(one, -400), e.slope_blur = power_of_two(size_of(e.slope), -400);
    const real big = real(4) * root(dot(q.q, q.q)) * root(dot(q.v, q.v)) / limit / ((u + one) * (u + one));
    e.slope_scale = nearest(big);
    e.slope_blur = e.slope_blur + power_of_two(big, -400);
    return e;
}

// ------------------------------------------------------------------ what is drawn

struct generator { // splitmix64
    std::uint64_t state;
    std::uint64_t bits()
    {
        std::uint64_t z = (state += 0x9e3779b97f4a7c15u);
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
        return z ^ (z >> 31);
    }
    double uniform(double lo, double hi)
    {
        return lo + (hi - lo) * std::ldexp(static_cast<double>(bits() >> 11), -53);
    }
    double log_uniform(double lo, double hi) { return std::exp(uniform(std::log(lo), std::log(hi))); }
    bool chance(double p) { return uniform(0, 1) < p; }
    double sign() { return bits() & 1 ? 1 : -1; }
    int below(int n) { return static_cast<int>(bits() % static_cast<unsigned>(n)); }
};

struct surface {
    std::string type;
    sgt_even_asphere sag = {};
    sgt_conic conic = {};
    sgt_julia julia = {};
    sgt_mandelbrot mandelbrot = {};
    level set = {};
    bool terms = false;
    bool on_equator = false;
    double size = 1; // a length about which it has its features
    sgt_surface handle = {};

    truth at(const sgt_ray &ray, const real &t) const
    {
        if (handle.ops == &sgt_julia_ops || handle.ops == &sgt_mandelbrot_ops) return level_at(set, ray, t);
        return sag_at(sag.c, sag.k, terms ? sag.a : nullptr, ray, t);
    }
    void print() const
    {
        std::printf("    %s", type.c_str());
        if (handle.ops == &sgt_julia_ops || handle.ops == &sgt_mandelbrot_ops) {
            std::printf(" c {%a,%a,%a,%a} at {%a,%a,%a,%a} escape %a iterations %d power %d", set.c[0],
                        set.c[1], set.c[2], set.c[3], set.at[0], set.at[1], set.at[2], set.at[3], set.escape,
                        set.iterations, set.power);
            for (auto &x : set.axes) std::printf(" axis {%a,%a,%a,%a}", x[0], x[1], x[2], x[3]);
        } else {
            std::printf(" c %a k %a semi_diameter %a", sag.c, sag.k, sag.semi_diameter);
            if (terms) {
                std::printf(" a {");
                for (double x : sag.a) std::printf("%a,", x);
                std::printf("}");
            }
        }
        std::printf("\n");
    }
};

double conic_constant(generator &g)
{
    switch (g.below(7)) {
    case 0: return 0;
    case 1: return -1;
    case 2: return -1 + g.sign() * g.log_uniform(1e-16, 1e-3);
    case 3: return g.sign() * g.log_uniform(1, 1e6);
    default: return g.uniform(-3, 3);
    }
}

// false: no oracle for it.
bool draw(generator &g, const sgt_builtin &row, surface *s)
{
    s->type = row.type;
    if (row.ops == &sgt_conic_ops || row.ops == &sgt_even_asphere_ops) {
        const double size = g.chance(0.5)   ? g.log_uniform(1e-2, 1e3)
                            : g.chance(0.8) ? g.log_uniform(1e-30, 1e30)
                                            : g.log_uniform(1e-100, 1e100);
        s->size = size;
        s->sag.c = s->type == "plane" || g.chance(0.1)
                       ? 0
                       : g.sign() * (g.chance(0.6) ? g.uniform(0.1, 1.5) : g.log_uniform(1e-9, 10)) / size;
        s->sag.k = s->type == "plane" || s->type == "sphere" ? 0 : conic_constant(g);
        s->sag.semi_diameter = g.chance(0.5) ? 0 : size * g.uniform(0.2, 1.5);
        s->on_equator = s->type != "plane" && g.chance(0.03);
        if (s->on_equator) {
            s->size = std::ldexp(1, std::ilogb(s->size)), s->sag.c = g.sign() / s->size;
            if (s->type != "sphere") s->sag.k = g.chance(0.5) ? 0 : 3;
        }
        s->terms = row.ops == &sgt_even_asphere_ops;
        if (s->terms) {
            const int count = g.below(9);
            const double height = size * g.log_uniform(1e-8, 3);
            for (int i = 0; i < count; i++)
                s->sag.a[i] = g.chance(0.2) ? 0
                                            : g.sign() * g.uniform(0, 1) * height / std::pow(size, 2 * i + 2);
            for (double &a : s->sag.a)
                if (!std::isfinite(a)) a = 0;
        }
        s->conic = {s->sag.c, s->sag.k, s->sag.semi_diameter};
        s->handle = {row.ops, s->terms ? static_cast<const void *>(&s->sag) : &s->conic};
        return true;
    }
    if (row.ops != &sgt_julia_ops && row.ops != &sgt_mandelbrot_ops) return false;
    level &l = s->set;
    l.mandelbrot = row.ops == &sgt_mandelbrot_ops;
    l.power = g.chance(0.6) ? 2 : 2 + g.below(7);
    l.iterations = g.chance(0.8) ? 1 + g.below(12) : 1 + g.below(40);
    double c = 0;
    for (int i = 0; i < 4; i++) {
        if (!l.mandelbrot) l.c[i] = g.uniform(-0.8, 0.8), c += l.c[i] * l.c[i];
        l.at[i] = g.chance(0.5) ? 0 : g.uniform(-0.5, 0.5);
    }
    const double scale = g.chance(0.5) ? 1 : g.log_uniform(1e-20, 1e20);
    s->size = 1 / scale;
    for (int j = 0; j < 3; j++)
        for (int i = 0; i < 4; i++)
            l.axes[j][i] = scale * (g.chance(0.5) ? i == j : (i == j) + g.uniform(-0.4, 0.4));
    // x^p = x + |c| at the least, from above
    double safe = 2;
    for (int i = 0; i < 200; i++) safe = std::pow(safe + std::sqrt(c), 1.0 / l.power);
    if (l.mandelbrot) safe = std::pow(2, 1.0 / (l.power - 1));
    l.escape = safe * (g.chance(0.5) ? 1 + 1e-9 : g.uniform(1.001, 4));
    if (g.chance(0.3)) l.escape = 0;
    if (l.mandelbrot) {
        sgt_mandelbrot &m = s->mandelbrot;
        std::memcpy(m.at, l.at, sizeof m.at);
        std::memcpy(m.ex, l.axes[0], sizeof m.ex), std::memcpy(m.ey, l.axes[1], sizeof m.ey),
            std::memcpy(m.ez, l.axes[2], sizeof m.ez);
        m.escape = l.escape, m.iterations = l.iterations, m.power = l.power;
        s->handle = {row.ops, &m};
    } else {
        sgt_julia &j = s->julia;
        std::memcpy(j.c, l.c, sizeof j.c), std::memcpy(j.at, l.at, sizeof j.at);
        std::memcpy(j.ex, l.axes[0], sizeof j.ex), std::memcpy(j.ey, l.axes[1], sizeof j.ey),
            std::memcpy(j.ez, l.axes[2], sizeof j.ez);
        j.escape = l.escape, j.iterations = l.iterations, j.power = l.power;
        s->handle = {row.ops, &j};
    }
    return true;
}

struct stretch {
    sgt_ray ray;
    sgt_interval t;
    double aim, length; // the t of the point aimed at; |d|
};

stretch draw_ray(generator &g, const surface &s)
{
    const bool sag = s.handle.ops == &sgt_conic_ops || s.handle.ops == &sgt_even_asphere_ops;
    stretch e;
    // A point of the surface, or one beside it.
    double reach = s.size;
    const double equator = (1 + s.sag.k) * s.sag.c * s.sag.c;
    if (sag && equator > 0 && g.chance(0.5)) reach = std::min(reach, 1 / std::sqrt(equator));
    const double r = reach * (g.chance(0.1)    ? 0
                              : g.chance(0.05) ? g.log_uniform(1e-250, 1)
                              : g.chance(0.1)  ? 1
                              : g.chance(0.1)  ? 1 - g.log_uniform(1e-15, 1e-2)
                              : g.chance(0.8)  ? g.uniform(0, 1)
                                               : g.uniform(0, 3));
    const double turn = g.uniform(0, 6.3);
    sgt_vec3 p = {r * std::cos(turn), r * std::sin(turn), s.size * g.uniform(-1.5, 1.5)}, n = {0, 0, 1};
    if (sag && g.chance(0.8)) {
        sgt_vec3 grad;
        const double off = s.handle.ops->value(s.handle.self, p, &grad);
        if (off == off && std::isfinite(off)) {
            p.z -= off, n = grad;
            const double long_ = std::sqrt(n.x * n.x + n.y * n.y + n.z * n.z);
            n = std::isfinite(long_) ? sgt_vec3{n.x / long_, n.y / long_, n.z / long_} : sgt_vec3{0, 0, 1};
        }
    }
    if (!sag && g.chance(0.8)) { // between a point inside and one outside
        sgt_vec3 in = {0, 0, 0}, out = {9 * s.size, 9 * s.size, 9 * s.size};
        for (int i = 0; i < 20 && !(s.handle.ops->value(s.handle.self, in, &n) < 0); i++)
            in = {s.size * g.uniform(-1, 1), s.size * g.uniform(-1, 1), s.size * g.uniform(-1, 1)};
        out = {out.x * g.uniform(-1, 1), out.y * g.uniform(-1, 1), out.z * g.uniform(-1, 1)};
        for (int i = 0; i < 40; i++) {
            p = {(in.x + out.x) / 2, (in.y + out.y) / 2, (in.z + out.z) / 2};
            (s.handle.ops->value(s.handle.self, p, &n) < 0 ? in : out) = p;
        }
        const double length = std::sqrt(n.x * n.x + n.y * n.y + n.z * n.z);
        n = length > 0 && std::isfinite(length) ? sgt_vec3{n.x / length, n.y / length, n.z / length}
                                                : sgt_vec3{0, 0, 1};
    }
    sgt_vec3 d = {g.uniform(-1, 1), g.uniform(-1, 1), g.uniform(-1, 1)};
    const int kind = g.below(13);
    if (kind == 0) d = {0, 0, g.sign()};
    if (kind == 1) d.z = 0;
    if (kind == 2) d = {1, 0, 0};
    if (kind == 3) d.x *= 1e-9, d.y *= 1e-9;
    if (kind == 4 || kind == 5) { // along the tangent, or nearly
        const double by = d.x * n.x + d.y * n.y + d.z * n.z -
                          (kind == 4 ? 0 : g.sign() * g.log_uniform(1e-14, 1e-1));
        d = {d.x - by * n.x, d.y - by * n.y, d.z - by * n.z};
    }
    if (kind == 6) d.x = 0;
    if (kind == 8) d.x *= g.log_uniform(1e-250, 1), d.y *= g.log_uniform(1e-250, 1);
    if (kind == 7)
        d = {-p.x + 1e-3 * s.size * d.x, -p.y + 1e-3 * s.size * d.y,
             d.z * s.size}; // through the axis, nearly
    const double now = std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z);
    const double want = g.chance(0.5)   ? 1
                        : g.chance(0.8) ? g.log_uniform(1e-3, 1e3)
                                        : g.log_uniform(1e-100, 1e100);
    if (!(now > 0) || !std::isfinite(now)) d = {0.6, 0, 0.8};
    else d = {d.x / now, d.y / now, d.z / now};
    d = {d.x * want, d.y * want, d.z * want};
    const double away = (g.chance(0.2)   ? 0
                         : g.chance(0.6) ? g.uniform(-10, 10)
                                         : g.sign() * g.log_uniform(1, 1e12)) *
                        s.size / want;
    e.ray = {{p.x - away * d.x, p.y - away * d.y, p.z - away * d.z}, d, 0, 0};
    e.aim = away, e.length = want;
    const double unit = s.size / want, ulp = std::nextafter(std::fabs(away), HUGE_VAL) - std::fabs(away);
    double width = g.log_uniform(1e-16, 3) * unit, at = away;
    switch (g.below(8)) {
    case 0: width = 0; break;
    case 1: width = ulp * g.below(5); break;
    case 2: width = g.log_uniform(1, g.chance(0.9) ? 1e3 : 1e100) * unit; break;
    case 3: at += g.uniform(-2, 2) * unit; break; // beside the surface
    case 4: at += g.uniform(-1, 1) * width; break;
    default: break;
    }
    if (sag && s.on_equator) { // exactly, in each of its numbers
        const double x = std::sqrt(1 / equator);
        e.ray = {{x, 0, s.size}, {g.chance(0.5) ? 0 : g.sign(), 0, 1}, 0, 0};
        e.length = 1, at = 0, width = g.chance(0.3) ? 0 : g.log_uniform(1e-16, 1) * s.size;
    }
    const double part = s.on_equator ? g.below(3) / 2.0 : g.uniform(0, 1);
    e.t = {at - part * width, at + (1 - part) * width};
    if (e.t.lo > e.t.hi) std::swap(e.t.lo, e.t.hi);
    return e;
}

// ------------------------------------------------------------------ the test

struct figures {
    long cases = 0, samples = 0, outside = 0, slope_outside = 0, false_empty = 0, nothing = 0, no_slope = 0,
         undefined = 0, seen_undefined = 0, monotone = 0, seen_monotone = 0, inside = 0;
    std::vector<double> wide, narrow, slope_wide, slope_narrow;
};
std::map<std::string, figures> results;
long failures;

double quantile(std::vector<double> &v, double q)
{
    if (v.empty()) return double(NAN);
    const auto at = v.begin() + static_cast<std::ptrdiff_t>(q * double(v.size() - 1));
    std::nth_element(v.begin(), at, v.end());
    return *at;
}

void complain(const char *what, const surface &s, const stretch &e, sgt_interval value, sgt_interval slope,
              double t, const truth *w)
{
    static std::map<std::string, int> shown;
    failures++;
    if (shown[s.type + what]++ >= 5) return;
    std::printf("FAIL %s\n", what);
    s.print();
    std::printf("    o {%a,%a,%a} d {%a,%a,%a} t [%a, %a]\n    g [%a, %a] slope [%a, %a] at t = %a",
                e.ray.o.x, e.ray.o.y, e.ray.o.z, e.ray.d.x, e.ray.d.y, e.ray.d.z, e.t.lo, e.t.hi, value.lo,
                value.hi, slope.lo, slope.hi, t);
    if (w) std::printf(": g %.25g slope %.25g (phi^2 %.3g)", nearest(w->g), nearest(w->slope), w->margin);
    std::printf("\n");
    if (w) mpfr_printf("    g %.40Rg slope %.40Rg\n", w->g.v, w->slope.v);
}

bool outside(sgt_interval x, const real &at, const real &blur)
{
    return at + blur < real(x.lo) || at - blur > real(x.hi);
} // false of a NaN

void try_one(generator &g, const surface &s, const stretch &e)
{
    figures &f = results[s.type];
    sgt_interval slope = {double(NAN), double(NAN)};
    const sgt_interval value = s.handle.ops->enclose(s.handle.self, &e.ray, e.t, &slope);
    f.cases++;
    const bool none = value.lo > value.hi, no_slope = slope.lo > slope.hi;
    const bool measured = g.chance(0.05);
    std::vector<double> at = {e.t.lo, e.t.hi};
    const int count = measured ? 25 : 5;
    for (int i = 1; i < count - 1; i++)
        at.push_back(e.t.lo + (e.t.hi - e.t.lo) * (measured ? double(i) / (count - 1) : g.uniform(0, 1)));
    double found_in = double(NAN), found_out = double(NAN);
    const sgt_vec3 &o = e.ray.o, &d = e.ray.d;
    if (!s.set.iterations) // nearest to the axis
        at.push_back(nearest(real(0) - (real(o.x) * real(d.x) + real(o.y) * real(d.y)) /
                                           (real(d.x) * real(d.x) + real(d.y) * real(d.y) + real(5e-324))));
    int defined = 0, steep = 0, sign = 0;
    bool one_sign = true;
    double scale = 0, slope_scale = 0, margin = HUGE_VAL, least_slope = HUGE_VAL, closeness = 0;
    real lo, hi, slope_lo, slope_hi;
    for (std::size_t i = 0; i < at.size(); i++) {
        const double t = std::min(std::max(at[i], e.t.lo), e.t.hi);
        const truth w = s.at(e.ray, real(t));
        f.samples++;
        if (w.defined && (mpfr_nan_p(w.g.v) || mpfr_nan_p(w.slope.v)))
            complain("the oracle itself has a NaN", s, e, value, slope, t, &w);
        if (s.set.iterations) closeness = std::max(closeness, std::fabs(nearest(w.g)));
        margin = std::min(margin, w.margin);
        (w.defined ? found_in : found_out) = t;
        if (int(i) == count && found_in == found_in && found_out == found_out &&
            g.chance(0.3)) { // the end of the domain
            double in = found_in, out = found_out;
            for (int k = 0; k < 70; k++) {
                const double middle = in + 0.5 * (out - in);
                (s.at(e.ray, real(middle)).defined ? in : out) = middle;
            }
            at.insert(at.end(), {in, std::nextafter(in, found_in), out});
        }
        if (!w.defined) continue;
        if (none) f.false_empty++, complain("said to be undefined all over", s, e, value, slope, t, &w);
        else if (outside(value, w.g, w.blur))
            f.outside++, complain("g is outside", s, e, value, slope, t, &w);
        if (!w.steep && !none && (no_slope || outside(slope, w.slope, w.slope_blur)))
            f.slope_outside++, complain("g' is outside", s, e, value, slope, t, &w);
        if (!defined || w.g < lo) lo = w.g;
        if (!defined || w.g > hi) hi = w.g;
        scale = std::max(scale, w.scale), slope_scale = std::max(slope_scale, w.slope_scale);
        defined++;
        if (w.steep) steep++;
        else {
            if (defined == 1 + steep || w.slope < slope_lo) slope_lo = w.slope;
            if (defined == 1 + steep || w.slope > slope_hi) slope_hi = w.slope;
            const double size = nearest(w.slope);
            if (sign && (size > 0) != (sign > 0)) one_sign = false;
            sign = size > 0 ? 1 : -1;
            least_slope = std::min(least_slope, std::fabs(size));
        }
    }
    const double width = (e.t.hi - e.t.lo) * e.length / s.size;
    if (!defined) {
        f.undefined++;
        f.seen_undefined += none;
        return;
    }
    const bool inside = defined == int(at.size()) && !steep && closeness < 0.5 &&
                        margin > 1e-3; // in the domain, with room; near the level
    if (!inside) return;
    f.inside++;
    if (!(value.hi - value.lo < HUGE_VAL)) f.nothing++;
    if (!(slope.hi - slope.lo < HUGE_VAL)) f.no_slope++;
    const bool close = std::fabs(e.aim) * e.length <= 100 * s.size;
    if (measured && close && width < 1e3 && value.hi - value.lo < HUGE_VAL &&
        slope.hi - slope.lo < HUGE_VAL) {
        const double u = 0x1p-52, least = DBL_MIN,
                     turn = slope_scale *
                            (std::max(std::fabs(e.t.lo), std::fabs(e.t.hi)) + s.size / e.length),
                     ratio = (value.hi - value.lo) / (nearest(hi - lo) + 4 * u * (scale + turn) + least),
                     slope_ratio = (slope.hi - slope.lo) /
                                   (nearest(slope_hi - slope_lo) + 4 * u * slope_scale + least);
        (width > 1e-2 ? f.wide : f.narrow).push_back(ratio);
        (width > 1e-2 ? f.slope_wide : f.slope_narrow).push_back(slope_ratio);
    }
    const bool narrow = s.set.iterations ? close && (e.t.hi - e.t.lo) * slope_scale < 1e-5
                                         : width < 1e-6; // of an orbit: for its folds
    if (narrow && one_sign && least_slope > 1e-2 * slope_scale) {
        f.monotone++;
        f.seen_monotone += slope.lo > 0 || slope.hi < 0;
    }
}

} // namespace

int main(int argc, char **argv)
{
    std::uint64_t seed = 1;
    double scale = 0.5;
    if (const char *e = std::getenv("SAGITTA_TEST_SEED")) seed = std::strtoull(e, nullptr, 0);
    if (const char *e = std::getenv("SAGITTA_TEST_SCALE")) scale = std::atof(e);
    std::printf("SAGITTA_TEST_SEED=%" PRIu64 "\n", seed);
    generator g = {seed};
    for (const sgt_builtin *row = sgt_builtins(); row->type; row++) {
        if (row->ops->values) continue; // met by its operations: tests/catalogue
        if (argc > 1 && std::strcmp(argv[1], row->type)) continue;
        if (!row->ops->enclose) {
            std::printf("FAIL %s has no enclose\n", row->type);
            failures++;
            continue;
        }
        const bool set = row->ops == &sgt_julia_ops || row->ops == &sgt_mandelbrot_ops;
        const long cases = static_cast<long>((set ? 800 : 6000) * scale);
        for (long i = 0; i < cases; i++) {
            surface s;
            if (!draw(g, *row, &s)) {
                std::printf("FAIL %s has no oracle here\n", row->type);
                failures++;
                break;
            }
            try_one(g, s, draw_ray(g, s));
        }
    }
    for (auto &entry : results) {
        figures &f = entry.second;
        const bool set = !entry.first.compare("julia") || !entry.first.compare("mandelbrot");
        const auto floor = [&](const char *what, double got, double limit) { // at most
            if (f.cases < 500 || !(got > limit)) return;
            std::printf("FAIL %s: %s %.3g, at most %.3g is good\n", entry.first.c_str(), what, got, limit);
            failures++;
        };
        floor("share of narrow monotone stretches that is not seen to be so",
              1 - double(f.seen_monotone) / double(std::max(f.monotone, 1L)), set ? 0.1 : 0.005);
        floor("share of undefined stretches that is not said to be so",
              f.undefined ? 1 - double(f.seen_undefined) / double(f.undefined) : 0, 0.05);
        floor("median width of g, wide", quantile(f.wide, 0.5), set ? 10 : 1.5);
        floor("median width of g, narrow", quantile(f.narrow, 0.5), set ? 15 : 1.5);
        if (!set) floor("99 % width of g, narrow", quantile(f.narrow, 0.99), 3);
        std::printf("%s: %ld stretches, %ld samples; g outside %ld, g' outside %ld, said undefined where it "
                    "is not %ld\n",
                    entry.first.c_str(), f.cases, f.samples, f.outside, f.slope_outside, f.false_empty);
        std::printf("  in the domain with room (near the level) %ld: nothing said of g %ld, of g' %ld; "
                    "undefined at all samples %ld, said so %ld; narrow and monotone %ld, seen %ld\n",
                    f.inside, f.nothing, f.no_slope, f.undefined, f.seen_undefined, f.monotone,
                    f.seen_monotone);
        std::printf("  from less than 100 sizes away: width over the true one, median and 99 %%: wide g %.3g "
                    "%.3g, g' %.3g %.3g; narrow g %.3g %.3g, g' %.3g %.3g\n",
                    quantile(f.wide, 0.5), quantile(f.wide, 0.99), quantile(f.slope_wide, 0.5),
                    quantile(f.slope_wide, 0.99), quantile(f.narrow, 0.5), quantile(f.narrow, 0.99),
                    quantile(f.slope_narrow, 0.5), quantile(f.slope_narrow, 0.99));
    }
    mpfr_free_cache();
    if (failures) std::printf("%ld failures\n", failures);
    return failures != 0;
}
