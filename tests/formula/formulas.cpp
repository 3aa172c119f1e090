// SPDX-License-Identifier: MIT
// formulas.cpp - the table of the formulas (formulas.h), compiled once for all tests.
//
// A row is FORMULA(name, text, place, parameters, special points, expression): the expression in x, y, z of
// any type of number (numbers.h), its parameters a[0], a[1] ..., and r.  A number N(0.1) is the double.
//   place     BALL(radius), BOX(x, y, z) half widths about the origin, or SAG(rim, reach): then the
//             expression is s(x, y), and |s| <= reach within the rim.  OPEN(radius) is not clipped, and has
//             nothing outside of that ball
//   special   points through which rays are sent: nodes, tips, poles, places of cuts
//   TOUCHES   in place of FORMULA: F is the square of the expression, and so touches zero where that crosses
//             it.  There is no change of sign to be proven
//
// Sources: Barth, Clebsch, Chmutov, Kummer, Cayley, Togliatti, Steiner, Boy: Hunt's and Endrass' collections,
// as quoted at MathWorld.  Apery 1987 for Boy's surface.  Taubin 1994 for the heart.
#include "formulas.h"

namespace formula {

template <class S> class row : public written {
    template <class N> N of(const N &x, const N &y, const N &z, const N *a, bool root) const
    {
        const N f = S::template f<N>(x, y, z, a), g = where.rim > 0 ? z - f : f;
        return touches && !root ? sq(g) : g;
    }
    template <class N> N of(const N &x, const N &y, const N &z, bool root = false) const
    {
        N a[8];
        for (std::size_t i = 0; i < named.size(); i++) a[i] = N(named[i].value);
        return of(x, y, z, a, root);
    }

public:
    using second = dual<dual<ball>>;
    ball at(const ball &x, const ball &y, const ball &z, bool root) const override { return of(x, y, z,
        root); }
    dual<ball> at(const dual<ball> &x, const dual<ball> &y, const dual<ball> &z, bool root) const override
    {
        return of(x, y, z, root);
    }
    second at(const second &x, const second &y, const second &z) const override { return of(x, y, z); }
    dual<double> at(const dual<double> &x, const dual<double> &y, const dual<double> &z,
                    bool root) const override
    {
        return of(x, y, z, root);
    }
    dual<range> at(const dual<range> &x, const dual<range> &y, const dual<range> &z) const override
    {
        return of(x, y, z);
    }
    second by(std::size_t j, const second &x, const second &y, const second &z) const override
    {
        second a[8];
        for (std::size_t i = 0; i < named.size(); i++)
            a[i] = second(dual<ball>(named[i].value), dual<ball>(i == j ? 1.0 : 0.0));
        return of(x, y, z, a, false);
    }
};

#define BALL(r) {r, {0, 0, 0}, 0, 0, false}
#define BOX(x, y, z) {0, {x, y, z}, 0, 0, false}
#define SAG(rim, reach) {0, {0, 0, 0}, rim, reach, false}
#define OPEN(r) {r, {0, 0, 0}, 0, 0, true}
#define LIST(...) {__VA_ARGS__}
#define WRITTEN(NAME, TEXT, PLACE, PARAMETERS, SPECIAL, TOUCH, ...)                  \
    struct NAME##_formula {                                                         \
        template <class N> static N f(const N &x, const N &y, const N &z, const N *a) \
        {                                                                           \
            const auto r = [&] { return hypot(x, y); };                             \
            static_cast<void>(x), static_cast<void>(y), static_cast<void>(z);       \
            static_cast<void>(a), static_cast<void>(r);                             \
            __VA_ARGS__;                                                            \
        }                                                                           \
    };                                                                              \
    static const bool NAME##_listed = list_of<NAME##_formula>(#NAME, TEXT, PLACE, PARAMETERS, SPECIAL, TOUCH);
#define FORMULA(NAME, TEXT, PLACE, PARAMETERS, SPECIAL, ...) \
    WRITTEN(NAME, TEXT, (place PLACE), (std::vector<sgt_named> PARAMETERS), (std::vector<sgt_vec3> SPECIAL), \
            false, __VA_ARGS__)
#define TOUCHES(NAME, TEXT, PLACE, PARAMETERS, SPECIAL, ...) \
    WRITTEN(NAME, TEXT, (place PLACE), (std::vector<sgt_named> PARAMETERS), (std::vector<sgt_vec3> SPECIAL), \
            true, __VA_ARGS__)

std::vector<std::unique_ptr<written>> &formulas()
{
    static std::vector<std::unique_ptr<written>> all;
    return all;
}

template <class S>
bool list_of(const char *name, const char *text, const place &where, const std::vector<sgt_named> &named,
             const std::vector<sgt_vec3> &special, bool touches)
{
    auto one = std::make_unique<row<S>>();
    one->name = name, one->text = text, one->where = where, one->named = named, one->special = special;
    one->touches = touches;
    formulas().push_back(std::move(one));
    return true;
}

// ----------------------------------------------------------------------------------- algebraic, with nodes

FORMULA(barth,
        "4*((2.618033988749895*x^2-y^2)*(2.618033988749895*y^2-z^2)*(2.618033988749895*z^2-x^2))"
        "-4.23606797749979*(x^2+y^2+z^2-1)^2",
        BALL(1.6), LIST(), LIST({1, 0, 0}, {0.5, 0.8090169943749475, 0.3090169943749474}, {0, 0, 0}),
        const N p = 2.618033988749895, X = sq(x), Y = sq(y), Z = sq(z);
        return N(4) * (p * X - Y) * (p * Y - Z) * (p * Z - X) - N(4.23606797749979) * sq(X + Y + Z - N(1)))
FORMULA(clebsch,
        "81*(x^3+y^3+z^3)-189*(x^2*(y+z)+y^2*(x+z)+z^2*(x+y))+54*(x*y*z)+126*(x*y+x*z+y*z)"
        "-9*(x^2+y^2+z^2)-9*(x+y+z)+1",
        BALL(1.6), LIST(), LIST({0.3333333333333333, 0.3333333333333333, -0.3333333333333333}, {0, 0, 0}),
        const N X = sq(x), Y = sq(y), Z = sq(z), s = x + y + z;
        return N(81) * (X * x + Y * y + Z * z) - N(189) * (X * (y + z) + Y * (z + x) + Z * (x + y)) +
               N(54) * x * y * z + N(126) * (x * y + x * z + y * z) - N(9) * (X + Y + Z) - N(9) * s + N(1))
FORMULA(chmutov, "2*(2*(2*x^2-1)^2-1)^2+2*(2*(2*y^2-1)^2-1)^2+2*(2*(2*z^2-1)^2-1)^2-2", BALL(1.6), LIST(),
        LIST({0, 0, 0}, {0.3826834323650898, 0, 0.3826834323650898}),
        const auto t = [](const N &u) { return N(2) * sq(u) - N(1); };
        return t(t(t(x))) + t(t(t(y))) + t(t(t(z))) + N(1))
FORMULA(kummer,
        "(x^2+y^2+z^2-mu^2)^2 - (3*mu^2-1)/(3-mu^2)*(1-z-sqrt(2)*x)*(1-z+sqrt(2)*x)*(1+z+sqrt(2)*y)"
        "*(1+z-sqrt(2)*y) = 0",
        BALL(3), LIST({"mu", 1.3}), LIST({0, 0, 0}),
        const N m = sq(a[0]), w = sqrt(N(2)), u = N(1) - z, v = N(1) + z;
        return sq(sq(x) + sq(y) + sq(z) - m) -
               (N(3) * m - N(1)) / (N(3) - m) * (u - w * x) * (u + w * x) * (v + w * y) * (v - w * y))
FORMULA(cayley, "4*(x^2 + y^2 + z^2) + 16*x*y*z = 1", BALL(1.5), LIST(),
        LIST({0.5, 0.5, -0.5}, {-0.5, 0.5, 0.5}, {-0.5, -0.5, -0.5}),
        return N(4) * (sq(x) + sq(y) + sq(z)) + N(16) * x * y * z - N(1))
FORMULA(togliatti,
        "64*(x-1)*(x^4-4*x^3-10*x^2*y^2-4*x^2+16*x-20*x*y^2+5*y^4+16-20*y^2)"
        "-5*sqrt(5-sqrt(5))*(2*z-sqrt(5-sqrt(5)))*(4*(x^2+y^2-z^2)+1+3*sqrt(5))^2",
        BALL(4), LIST(), LIST({1, 0, 0}),
        const N X = sq(x), Y = sq(y), w = sqrt(N(5)), q = sqrt(N(5) - w);
        return N(64) * (x - N(1)) *
                   (sq(X) - N(4) * X * x - N(10) * X * Y - N(4) * X + N(16) * x - N(20) * x * Y +
                    N(5) * sq(Y) + N(16) - N(20) * Y) -
               N(5) * q * (N(2) * z - q) * sq(N(4) * (X + Y - sq(z)) + N(1) + N(3) * w))
FORMULA(whitney, "x^2 = y^2*z", BOX(1.5, 1.5, 1.5), LIST(), LIST({0, 0, 0}, {0, 0, 0.5}),
        return sq(x) - sq(y) * z)
FORMULA(steiner, "x^2*y^2 + y^2*z^2 + z^2*x^2 = x*y*z", BALL(1.2), LIST(), LIST({0, 0, 0}, {0, 0, 0.25}),
        const N X = sq(x), Y = sq(y), Z = sq(z); return X * Y + Y * Z + Z * X - x * y * z)
FORMULA(boy,
        "64*(1-z)^3*z^3 - 48*(1-z)^2*z^2*(3*x^2+3*y^2+2*z^2) + 12*(1-z)*z*(27*(x^2+y^2)^2"
        " - 24*z^2*(x^2+y^2) + 36*sqrt(2)*y*z*(y^2-3*x^2) + 4*z^4) + (9*x^2+9*y^2-2*z^2)"
        "*(-81*(x^2+y^2)^2 - 72*z^2*(x^2+y^2) + 108*sqrt(2)*x*z*(x^2-3*y^2) + 4*z^4)",
        BALL(2), LIST(), LIST({0, 0, 0}, {0, 0, 1}),
        const N X = sq(x), Y = sq(y), Z = sq(z), q = X + Y, u = (N(1) - z) * z, w = sqrt(N(2));
        return N(64) * pown(u, 3) - N(48) * sq(u) * (N(3) * q + N(2) * Z) +
               N(12) * u * (N(27) * sq(q) - N(24) * Z * q + N(36) * w * y * z * (Y - N(3) * X) +
               N(4) * sq(Z)) +
               (N(9) * q - N(2) * Z) *
                   (N(-81) * sq(q) - N(72) * Z * q + N(108) * w * x * z * (X - N(3) * Y) + N(4) * sq(Z)))
FORMULA(klein_bottle,
        "(x^2+y^2+z^2+2*y-1)*((x^2+y^2+z^2-2*y-1)^2-8*z^2)+16*x*z*(x^2+y^2+z^2-2*y-1)=0", BALL(4.5), LIST(),
        LIST({0, 0, 0}, {1, 0, 0}), const N q = sq(x) + sq(y) + sq(z) - N(1), m = q - N(2) * y;
        return (q + N(2) * y) * (sq(m) - N(8) * sq(z)) + N(16) * x * z * m)
FORMULA(cone, "z^2 = x^2 + y^2", BALL(2), LIST(), LIST({0, 0, 0}), return sq(z) - sq(x) - sq(y))

// --------------------------------------------------------------------------------------- algebraic, smooth

FORMULA(plane, "x + 2*y - z = 0.1", BALL(1), LIST(), LIST(), return x + N(2) * y - z - N(0.1))
FORMULA(heart, "(x^2 + 9/4*y^2 + z^2 - 1)^3 = x^2*z^3 + 9/80*y^2*z^3", BOX(1.5, 1.5, 1.5), LIST(),
        LIST({0, 0, 1}, {1, 0, 0}, {0, 0, 0}), const N p = sq(x) + N(9) / N(4) * sq(y) + sq(z) - N(1),
        Z = pown(z, 3);
        return pown(p, 3) - sq(x) * Z - N(9) / N(80) * sq(y) * Z)
FORMULA(tanglecube, "x^4 - 5*x^2 + y^4 - 5*y^2 + z^4 - 5*z^2 + 11.8 = 0", BALL(4), LIST(), LIST({0, 0, 0}),
        const auto q = [](const N &u) { return sq(u) * (sq(u) - N(5)); };
        return q(x) + q(y) + q(z) + N(11.8))
FORMULA(goursat, "x^4 + y^4 + z^4 = a", BALL(1.6), LIST({"a", 1}), LIST({1, 0, 0}),
        return pown(x, 4) + pown(y, 4) + pown(z, 4) - a[0])
FORMULA(torus, "(x^2+y^2+z^2+R^2-s^2)^2 = 4*R^2*(x^2+y^2)", BALL(2), LIST({"R", 1}, {"s", 0.35}),
        LIST({0, 0, 0.35}, {0, 0, 0}), const N Q = sq(a[0]), q = sq(x) + sq(y);
        return sq(q + sq(z) + Q - sq(a[1])) - N(4) * Q * q)
FORMULA(cyclide, "(x^2+y^2+z^2+b^2-d^2)^2 = 4*(a*x-sqrt(a^2-b^2)*d)^2 + 4*b^2*y^2", BALL(5),
        LIST({"a", 2}, {"b", 1.9}, {"d", 1}), LIST({0, 0, 0}), const N B = sq(a[1]), c = sqrt(sq(a[0]) - B);
        return sq(sq(x) + sq(y) + sq(z) + B - sq(a[2])) - N(4) * sq(a[0] * x - c * a[2]) - N(4) * B * sq(y))
FORMULA(astroidal, "(x^2+y^2+z^2-1)^3 + 27*x^2*y^2*z^2 = 0", BALL(1.3), LIST(), LIST({1, 0, 0}, {0, 0, -1}),
        return pown(sq(x) + sq(y) + sq(z) - N(1), 3) + N(27) * sq(x) * sq(y) * sq(z))
FORMULA(decocube,
        "((x^2+y^2-c^2)^2+(z^2-1)^2)*((y^2+z^2-c^2)^2+(x^2-1)^2)*((z^2+x^2-c^2)^2+(y^2-1)^2) = b", BALL(2),
        LIST({"c", 0.9}, {"b", 0.02}), LIST({0, 0, 0}), const N C = sq(a[0]), X = sq(x), Y = sq(y), Z = sq(z);
        const auto q = [&](const N &u, const N &v, const N &w) { return sq(u + v - C) + sq(w - N(1)); };
        return q(X, Y, Z) * q(Y, Z, X) * q(Z, X, Y) - a[1])
FORMULA(open_sphere, "x^2 + y^2 + z^2 = 2", OPEN(1.5), LIST(), LIST({0, 0, 0}),
        return sq(x) + sq(y) + sq(z) - N(2))

// --------------------------------------------------------------------------------------------- other units

FORMULA(barth_mm,
        "4*((phi^2*(x/s)^2-(y/s)^2)*(phi^2*(y/s)^2-(z/s)^2)*(phi^2*(z/s)^2-(x/s)^2))"
        "-(1+2*phi)*((x/s)^2+(y/s)^2+(z/s)^2-1)^2",
        BALL(1600), LIST({"s", 1000}, {"phi", 1.618033988749895}), LIST({1000, 0, 0}),
        const N p = sq(a[1]), X = sq(x / a[0]), Y = sq(y / a[0]), Z = sq(z / a[0]);
        return N(4) * (p * X - Y) * (p * Y - Z) * (p * Z - X) - (N(1) + N(2) * a[1]) * sq(X + Y + Z - N(1)))
FORMULA(small_torus, "(hypot(x, y) - R)^2 + z^2 = s^2", BALL(2e-6), LIST({"R", 1e-6}, {"s", 3e-7}),
        LIST({0, 0, 0}), return sq(r() - a[0]) + sq(z) - sq(a[1]))
FORMULA(large_goursat, "(x/L)^4 + (y/L)^4 + (z/L)^4 = 1", BALL(1.6e9), LIST({"L", 1e9}), LIST(),
        return pown(x / a[0], 4) + pown(y / a[0], 4) + pown(z / a[0], 4) - N(1))

// ------------------------------------------------------------------------------------- roots and distances

FORMULA(root_sphere, "sqrt(x^2 + y^2 + z^2) = R", BALL(2), LIST({"R", 1.25}), LIST({0, 0, 0}),
        return sqrt(sq(x) + sq(y) + sq(z)) - a[0])
FORMULA(root_cone, "z = sqrt(x^2 + y^2)", BALL(2), LIST(), LIST({0, 0, 0}), return z - sqrt(sq(x) + sq(y)))
FORMULA(r_cone, "r*cos(w) = z*sin(w)", BALL(2), LIST({"w", 0.5}), LIST({0, 0, 0}),
        return r() * cos(a[0]) - z * sin(a[0]))
FORMULA(tube_torus, "(sqrt(x^2+y^2) - 1)^2 + z^2 = 0.1225", BALL(2), LIST(), LIST({0, 0, 0.35}),
        return sq(sqrt(sq(x) + sq(y)) - N(1)) + sq(z) - N(0.1225))
FORMULA(hypot_torus, "hypot(hypot(x, y) - 1, z) = 0.3", BALL(2), LIST(), LIST({0, 0, 0}, {1, 0, 0}),
        return hypot(r() - N(1), z) - N(0.3))
FORMULA(hemisphere, "z = sqrt(1 - x^2 - y^2)", BALL(1.5), LIST(), LIST({1, 0, 0}, {0.6, 0.8, 0}),
        return z - sqrt(N(1) - sq(x) - sq(y)))
FORMULA(box_asphere, "z = c*r^2/(1+sqrt(1-(1+k)*c^2*r^2)) + a4*r^4 + a6*r^6", BOX(4, 4, 4),
        LIST({"c", 0.2}, {"k", -0.3}, {"a4", 1e-3}, {"a6",
        -2e-5}), LIST({0, 0, 0}), const N q = sq(x) + sq(y);
        return z - (a[0] * q / (N(1) + sqrt(N(1) - (N(1) + a[1]) * sq(a[0]) * q)) + a[2] * sq(q) +
                    a[3] * q * sq(q)))
FORMULA(superquadric, "abs(x)^n + abs(y/0.8)^n + abs(z/1.2)^m = 1", BALL(2), LIST({"n", 2.5}, {"m", 3.7}),
        LIST({0, 0, 1.2}, {1, 0, 0}),
        return power(abs(x), a[0]) + power(abs(y / N(0.8)), a[0]) + power(abs(z / N(1.2)), a[1]) - N(1))
FORMULA(half_powers, "abs(x)^2.5 + abs(y)^1.5 + abs(z)^4.5 = 1", BALL(2), LIST(),
        LIST({0, 0, 1}, {1, 0, 0}, {0, 1, 0}, {0, 0.5, 0.9}, {0, 0, 0}),
        const N Y = abs(y), Z = abs(z);
        return sq(x) * power(abs(x), 0.5) + power(Y, 1.5) + sq(sq(z)) * power(Z, 0.5) - N(1))
FORMULA(hollow_superquadric, "abs(x)^0.7 + abs(y)^0.7 + abs(z)^0.7 = 1", BALL(1.2), LIST(), LIST({1, 0, 0}),
        return power(abs(x), 0.7) + power(abs(y), 0.7) + power(abs(z), 0.7) - N(1))
FORMULA(cube_roots, "cbrt(x) + cbrt(y) + cbrt(z) = 0.2", BALL(1.5), LIST(), LIST({0, 0, 0.008}),
        return cbrt(x) + cbrt(y) + cbrt(z) - N(0.2))
FORMULA(astroid_roots, "cbrt(x^2) + cbrt(y^2) + cbrt(z^2) = 1", BALL(1.3), LIST(), LIST({1, 0, 0}),
        return cbrt(sq(x)) + cbrt(sq(y)) + cbrt(sq(z)) - N(1))
FORMULA(real_power, "x^y = z + 1/2", BALL(2), LIST(), LIST({1, 0, 0.5}), return power(x, y) - (z + N(0.5)))
FORMULA(tower, "2^-x + 3^y*0.5 = z^2", BALL(2), LIST(), LIST({0, 0, 0}),
        return power(N(2), -x) + power(N(3), y) * N(0.5) - sq(z))

// ------------------------------------------------------------------------------------------- min, max, abs

FORMULA(octahedron, "abs(x) + abs(y) + abs(z) = 1", BALL(1.5), LIST(), LIST({1, 0, 0}, {0.5, 0.5, 0}),
        return abs(x) + abs(y) + abs(z) - N(1))
FORMULA(cube, "max(abs(x), max(abs(y), abs(z))) = 0.8",
        BALL(1.5), LIST(), LIST({0.8, 0.8, 0.8}, {0.8, 0.8, 0}),
        return max(abs(x), max(abs(y), abs(z))) - N(0.8))
FORMULA(rounded_cube,
        "sqrt(max(abs(x)-w, 0)^2 + max(abs(y)-w, 0)^2 + max(abs(z)-w, 0)^2) = s", BALL(1.8),
        LIST({"w", 0.7}, {"s", 0.2}), LIST({0.7, 0.7, 0.9}),
        const auto q = [&](const N &u) { return sq(max(abs(u) - a[0], N(0))); };
        return sqrt(q(x) + q(y) + q(z)) - a[1])
FORMULA(bored_sphere, "max(x^2 + y^2 + z^2 - 1, 0.25 - min(x^2 + y^2, y^2 + z^2))", BALL(1.3), LIST(),
        LIST({0.5, 0, 0.866}, {0, 0.5, 0}),
        return max(sq(x) + sq(y) + sq(z) - N(1), N(0.25) - min(sq(x) + sq(y), sq(y) + sq(z))))

// ------------------------------------------------------------------------------------------ transcendental

FORMULA(gyroid, "sin(6*x)*cos(6*y)+sin(6*y)*cos(6*z)+sin(6*z)*cos(6*x)", BALL(1.6), LIST(), LIST({0, 0, 0}),
        const N u = N(6) * x, v = N(6) * y, w = N(6) * z;
        return sin(u) * cos(v) + sin(v) * cos(w) + sin(w) * cos(u))
FORMULA(gyroid_sheet, "abs(sin(k*x)*cos(k*y)+sin(k*y)*cos(k*z)+sin(k*z)*cos(k*x)) - d", BALL(1.2),
        LIST({"k", 5}, {"d", 0.2}), LIST({0, 0, 0}), const N u = a[0] * x, v = a[0] * y, w = a[0] * z;
        return abs(sin(u) * cos(v) + sin(v) * cos(w) + sin(w) * cos(u)) - a[1])
FORMULA(grating, "z = A*sin(k*x)", BALL(1.5), LIST({"A", 0.05}, {"k", 40}), LIST({0, 0, 0}),
        return z - a[0] * sin(a[1] * x))
FORMULA(eggs, "sin(pi*x)*sin(pi*y)*sin(pi*z) = 0.1", BALL(1.7), LIST(), LIST({0.5, 0.5, 0.5}),
        const N p = pi<N>(); return sin(p * x) * sin(p * y) * sin(p * z) - N(0.1))
FORMULA(helicoid, "x*sin(2*z) = y*cos(2*z)", BALL(2), LIST(), LIST({0, 0, 0.5}),
        return x * sin(N(2) * z) - y * cos(N(2) * z))
FORMULA(bumps,
        "exp(-4*((x-0.5)^2+y^2+z^2)) + exp(-4*((x+0.5)^2+y^2+z^2)) + exp(-8*(x^2+(y-0.7)^2+z^2)) = 0.4",
        BALL(2), LIST(), LIST({0, 0, 0}), const N q = sq(y) + sq(z);
        return exp(N(-4) * (sq(x - N(0.5)) + q)) + exp(N(-4) * (sq(x + N(0.5)) + q)) +
               exp(N(-8) * (sq(x) + sq(y - N(0.7)) + sq(z))) - N(0.4))
FORMULA(cushion, "log(exp(8*x^2) + exp(8*y^2) + exp(8*z^2)) = p", BALL(1.5), LIST({"p", 8}), LIST({1, 0, 0}),
        return log(exp(N(8) * sq(x)) + exp(N(8) * sq(y)) + exp(N(8) * sq(z))) - a[0])
FORMULA(catenoid, "r = w*cosh(z/w)", BALL(2), LIST({"w", 0.6}), LIST({0, 0, 0}),
        return r() - a[0] * cosh(z / a[0]))
FORMULA(sinhs, "sinh(x)*sinh(2*y) = z",
        BALL(1.5), LIST(), LIST({0, 0, 0}), return sinh(x) * sinh(N(2) * y) - z)
FORMULA(tanhs, "tanh(4*x) + tanh(4*y) + tanh(4*z) = 0.3", BALL(2), LIST(), LIST({0, 0, 0}),
        return tanh(N(4) * x) + tanh(N(4) * y) + tanh(N(4) * z) - N(0.3))
FORMULA(scherk, "exp(z)*cos(y) = cos(x)", BALL(5), LIST(), LIST({1.5707963267948966, 1.5707963267948966, 0}),
        return exp(z) * cos(y) - cos(x))
FORMULA(arc_sine, "z = asin(x*y)", BALL(2), LIST(), LIST({1, 1, 1.5707963267948966}), return z - asin(x * y))
FORMULA(arc_cosines, "acos(x) + acos(y) + acos(z) = 4", BALL(1.6), LIST(), LIST({1, 0, 0}),
        return acos(x) + acos(y) + acos(z) - N(4))
FORMULA(drop, "r^2 = z*exp(-z)*log(2 + z)", BALL(3), LIST(), LIST({0, 0, 0}, {0, 0, -2}),
        return sq(x) + sq(y) - z * exp(-z) * log(N(2) + z))

// -------------------------------------------------------------------------- jumps, poles, and what touches

FORMULA(spiral_stair, "atan2(y, x) = p*z", BALL(2), LIST({"p",
        1.7}), LIST({0, 0, 0}, {-1, 0, 0}, {-1, 0, 1.8}),
        return atan2(y, x) - a[0] * z)
FORMULA(metaballs, "1/((x-0.6)^2+y^2+z^2) + 1/((x+0.6)^2+y^2+z^2) + 0.5/(x^2+(y-0.9)^2+z^2) = 5",
        BALL(2), LIST(),
        LIST({0.6, 0, 0}, {0, 0, 0}),
        return N(1) / (sq(x - N(0.6)) + sq(y) + sq(z)) + N(1) / (sq(x + N(0.6)) + sq(y) + sq(z)) +
               N(0.5) / (sq(x) + sq(y - N(0.9)) + sq(z)) - N(5))
FORMULA(pole, "1/x = y + z", BALL(2), LIST(), LIST({0, 0.3, 0}, {0, 0, 0}), return N(1) / x - (y + z))
FORMULA(two_poles, "x/(z - 0.2) + y^-3 = 1", BALL(2), LIST(), LIST({0.5, 0.5, 0.2}, {0, 0, 0.2}),
        return x / (z - N(0.2)) + pown(y, -3) - N(1))
FORMULA(tangent, "y = tan(2*x)", BALL(2), LIST(), LIST({0.7853981633974483, 0, 0}), return y - tan(N(2) * x))
FORMULA(step, "atan(1/x) = z", BALL(2), LIST(), LIST({0, 0, 0.5}), return atan(N(1) / x) - z)
TOUCHES(double_sphere, "(x^2 + y^2 + z^2 - 1)^2", BALL(1.5), LIST(), LIST({0, 0, 0}),
        return sq(x) + sq(y) + sq(z) - N(1))
TOUCHES(double_saddle, "z^2 - 2*z*x*y + x^2*y^2", BALL(1.5), LIST(), LIST({0, 0, 0}), return z - x * y)

// ---------------------------------------------------------------------------------------------------- sags

FORMULA(asphere_sag, "c*r^2/(1+sqrt(1-(1+k)*c^2*r^2)) + a4*r^4 + a6*r^6", SAG(4, 4),
        LIST({"c", 0.15}, {"k", -0.6}, {"a4", 1e-4}, {"a6",
        -2e-6}), LIST({0, 0, 0}), const N q = sq(x) + sq(y);
        return a[0] * q / (N(1) + sqrt(N(1) - (N(1) + a[1]) * sq(a[0]) * q)) + a[2] * sq(q) +
        a[3] * q * sq(q))
FORMULA(trefoil_sag, "c*r^2/(1+sqrt(1-(1+k)*c^2*r^2)) + t*r^3*cos(3*atan2(y,x))", SAG(4, 4),
        LIST({"c", 0.1}, {"k", -1}, {"t", 2e-3}), LIST({0, 0, 0}), const N q = sq(x) + sq(y);
        return a[0] * q / (N(1) + sqrt(N(1) - (N(1) + a[1]) * sq(a[0]) * q)) +
               a[2] * x * (sq(x) - N(3) * sq(y)))
FORMULA(twisted_sag, "c*r^2/(1+sqrt(1-(1+k)*c^2*r^2)) + a*r^4*cos(3*atan2(y,x))", SAG(4, 4),
        LIST({"c", 0.02}, {"k", 0}, {"a", 1e-4}), LIST({0, 0, 0}), const N q = sq(x) + sq(y);
        return a[0] * q / (N(1) + sqrt(N(1) - (N(1) + a[1]) * sq(a[0]) * q)) +
               a[2] * r() * x * (sq(x) - N(3) * sq(y)))
FORMULA(ripple_sag, "A*cos(k*r)*exp(-r/5)", SAG(6, 1), LIST({"A", 0.3}, {"k", 4}), LIST({0, 0, 0.3}),
        return a[0] * cos(a[1] * r()) * exp(-r() / N(5)))
FORMULA(axicon_sag, "0.2*r", SAG(3, 1), LIST(), LIST({0, 0, 0}), return N(0.2) * r())
FORMULA(ridge_sag, "c*r^2/2 + a*abs(x)^2.5", SAG(3, 1), LIST({"c", 0.05}, {"a", 0.01}),
        LIST({0, 0, 0}, {0, 1, 0.025}, {0, -2, 0.1}),
        return a[0] * (sq(x) + sq(y)) / N(2) + a[1] * power(abs(x), 2.5))
FORMULA(angle_sag, "c*r^2/2 + a*atan2(9 + x, y)", SAG(3, 1), LIST({"c", 0.05}, {"a", 0.01}),
        LIST({0, 0, 0.01}), return a[0] * (sq(x) + sq(y)) / N(2) + a[1] * atan2(N(9) + x, y))
FORMULA(grating_sag, "c*r^2/2 + A*sin(k*x)", SAG(3, 1), LIST({"c", 0.05}, {"A", 0.01}, {"k",
        30}), LIST({0, 0, 0}),
        return a[0] * (sq(x) + sq(y)) / N(2) + a[1] * sin(a[2] * x))

} // namespace formula
