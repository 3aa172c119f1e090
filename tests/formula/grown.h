// SPDX-License-Identifier: MIT
// grown.h - random formulas: a tree of operations, its text, and the same function of any type of number.
//
// All of the grammar is drawn: numbers, pi, parameters, x y z r, operators with as few parentheses as they
// need or more, whole and real powers, every function.  Half of the trees are sums of plain terms, which have
// roots; the others are anything.  A whole number as exponent is a product (formula.h), so one that is not
// meant as a product is made of a parameter or of a variable.
//
// And formulas of one operation each (`single`), which are counted and not drawn.  What has code of its own
// for an operation or a power has a formula here that nothing else of that formula can hide behind.
#ifndef FORMULA_GROWN_H
#define FORMULA_GROWN_H

#include "formulas.h"
#include "../oracle/cases.h"

#include <cstdio>

namespace formula
{

enum class op {
    number, pi, parameter, x, y, z, r,
    negative, sqrt, cbrt, exp, log, sin, cos, tan, asin, acos, atan, sinh, cosh, tanh, absolute, whole,
    sum, difference, product, quotient, atan2, min, max, hypot, power,
    wave // r^k cos(n atan2(y, x)), or sin: a polynomial
};

struct node {
    op what;
    double value; // of a number; a whole exponent; the index of a parameter; of a wave 0: cosine, 1: sine
    int a, b;     // nodes before this one; n and k of a wave
};

// One operation of one operand or two, each in a form of its own: x^2 + y^2, x, a sum of products, r.
struct single {
    op what;
    int power;    // of op::whole
    int form;     // of the operand
    int second;   // 0: none; the other operand is 1: a number, 2: the first one is, 3: the same, 4: a number
                  // more than that form, 5: another form, 6: both are sums
    bool sag;
};

inline std::vector<single> singles()
{
    std::vector<single> all;
    const auto ops = [](op from, op to) {
        std::vector<op> found;
        for (int i = static_cast<int>(from); i <= static_cast<int>(to); i++)
            found.push_back(static_cast<op>(i));
        return found;
    };
    for (int sag = 0; sag < 2; sag++)
        for (int form = 0; form < 4; form++) {
            for (op what : ops(op::negative, op::absolute)) all.push_back({what, 0, form, 0, sag > 0});
            for (int n = -4; n <= 20; n++) all.push_back({op::whole, n, form, 0, sag > 0});
            for (op what : ops(op::sum, op::power))
                for (int second = 1; second <= 6; second++) all.push_back({what, 0, form, second, sag > 0});
        }
    return all;
}

class grown : public written {
public:
    using second = dual<dual<ball>>;

    grown(oracle::generator &g, long number) : g_(g)
    {
        name = "grown " + std::to_string(number);
        where = {1.5, {0, 0, 0}, 0, 0, false};
        touches = false;
        static const char *const names[] = {"a", "b2", "long_name"};
        for (int i = g.below(4); i > 0; i--) {
            named.push_back({names[named.size()], value_of()});
            if (named.back().value == 0) named.back().value = 0.25;
        }
        do {
            nodes_.clear(), varies_ = false;
            g.chance(0.5) ? plain(1 + g.below(4)) : tree(2 + g.below(4));
        } while (!varies_);
        if (g.chance(0.3)) where = {0, {g.uniform(0.5, 2), g.uniform(0.5, 2), 1}, 0, 0, false};
        special = {{0, 0, 0}, {1, 0, 0}, {-1, 0, 0.5}, {0, 0, 1}, {0.5, 0.5, 0.5}, {0, -0.25, 0}};
        text = print(last(), 1);
    }
    // a + b op(u, v): the numbers about it are parameters half of the time.
    grown(oracle::generator &g, long number, const single &of) : g_(g)
    {
        name = "single " + std::to_string(number);
        where = {1.5, {0, 0, 0}, 0, 0, false};
        if (of.sag) where = {0, {0, 0, 0}, 1.25, 3, false};
        touches = false;
        const auto some = [&](double value) {
            if (named.size() >= 3 || g.chance(0.5)) return add(op::number, value);
            static const char *const names[] = {"a", "b2", "long_name"};
            named.push_back({names[named.size()], value});
            return add(op::parameter, static_cast<double>(named.size()) - 1);
        };
        const auto operand = [&](int form) {
            const auto square = [&](op of_what) { return add(op::whole, 2, add(of_what)); };
            if (form == 0) { // numbered, for the order of evaluation
                const int x2 = square(op::x), y2 = square(op::y);
                return add(op::product, 0, some(g.uniform(0.4, 0.9)), add(op::sum, 0, x2, y2));
            }
            if (form == 1) return add(op::product, 0, some(g.uniform(0.4, 0.9)), add(op::x));
            if (form == 3) return add(op::r);
            const int x = add(op::x), y = add(op::y), third = add(of.sag ? op::y : op::z),
                      xy = add(op::product, 0, x, y);
            return add(op::sum, 0, xy, add(op::product, 0, some(g.uniform(0.4, 0.9)), third));
        };
        int u = operand(of.form), v = of.second == 3 ? u : 0;
        const auto more_than = [&](int base) { return add(op::sum, 0, some(g.uniform(0.3, 2)), base); };
        if (of.second == 6) u = more_than(u);
        if (of.second == 4 || of.second == 6) v = more_than(operand(of.form));
        if (of.second == 5) v = operand((of.form + 1 + g.below(3)) % 4);
        if (of.second == 1 || of.second == 2) v = some(g.uniform(0.3, 2));
        if (of.second == 2) std::swap(u, v);
        const int it = add(of.what, of.power, u, v), times = add(op::product, 0, some(g.uniform(0.2, 1)), it);
        add(g.chance(0.5) ? op::sum : op::difference, 0, some(g.uniform(-1, 1)), times);
        special = {{0, 0, 0}, {1, 0, 0}, {0, -0.25, 0}, {0.5, 0.5, 0.5}};
        text = print(last(), 1);
    }
    std::size_t size() const { return nodes_.size(); }
    bool is_random() const override { return true; }
    bool is_tame(const sgt_vec3 &p) const override
    {
        for (std::size_t i = 0; i < nodes_.size(); i++)
            for (int k = 0; k < 3; k++) {
                const dual<double> v = part(dual<double>(p.x, k == 0), dual<double>(p.y, k == 1),
                                            dual<double>(p.z, k == 2), i);
                const auto is_small = [](double x) { return std::fabs(x) < 1e60; };
                if (!is_small(v.v) || !is_small(v.s) || (v.v != 0 && !is_small(1 / v.v))) return false;
                // (the slope of tanh is 1 - v^2)
                if (nodes_[i].what == op::tanh && std::fabs(v.v) > 1 - 1e-6) return false;
            }
        return true;
    }

    ball at(const ball &x, const ball &y, const ball &z, bool) const override { return of(x, y, z); }
    dual<ball> at(const dual<ball> &x, const dual<ball> &y, const dual<ball> &z, bool) const override
    {
        return of(x, y, z);
    }
    second at(const second &x, const second &y, const second &z) const override { return of(x, y, z); }
    dual<double> at(const dual<double> &x, const dual<double> &y, const dual<double> &z, bool) const override
    {
        return of(x, y, z);
    }
    dual<range> at(const dual<range> &x, const dual<range> &y, const dual<range> &z) const override
    {
        return of(x, y, z);
    }
    second by(std::size_t j, const second &x, const second &y, const second &z) const override
    {
        second a[3];
        for (std::size_t i = 0; i < named.size(); i++)
            a[i] = second(dual<ball>(named[i].value), dual<ball>(i == j ? 1.0 : 0.0));
        return level(z, walked(x, y, z, a));
    }

    // Is some part of numbers and parameters alone not certainly defined?  Such a text may be refused.
    bool may_be_refused() const
    {
        const ball nothing[3] = {0, 0, 0};
        std::vector<bool> fixed;
        const proof::precision low(40);
        for (std::size_t i = 0; i < nodes_.size(); i++) {
            const node &n = nodes_[i];
            const auto is = [&](int k) { return fixed[static_cast<std::size_t>(k)]; };
            fixed.push_back(n.what <= op::parameter ||
                            (n.what > op::r && n.what < op::wave && is(n.a) &&
                             (n.what < op::sum || is(n.b))));
            if (n.what == op::whole && n.value == 0) fixed.back() = true; // u^0 is 1
            if (n.what == op::quotient && is(n.b) && !part(nothing[0], nothing[1], nothing[2],
                                                           static_cast<std::size_t>(n.b)).sign())
                return true; // by 0, whatever is divided
            if (!fixed.back()) continue;
            seen = marks();
            const ball v = part(nothing[0], nothing[1], nothing[2], i);
            if (seen.torn() || seen.nowhere || !v.is_finite() || std::fabs(v.rough()) > 1e300) return true;
        }
        return false;
    }

private:
    oracle::generator &g_;
    std::vector<node> nodes_;
    bool varies_ = false;

    int last() const { return static_cast<int>(nodes_.size()) - 1; }
    int add(op what, double value = 0, int a = 0, int b = 0)
    {
        nodes_.push_back({what, value, a, b});
        return last();
    }
    double value_of()
    {
        switch (g_.below(4)) {
        case 0: return g_.below(10);
        case 1: return g_.below(40) / 8.0;
        case 2: return g_.uniform(-3, 3);
        default: return g_.sign() * g_.log_uniform(1e-3, 1e2);
        }
    }
    int variable()
    {
        varies_ = true;
        static const op of[] = {op::x, op::y, op::z, op::x, op::y, op::z, op::r};
        return add(of[g_.below(7)]);
    }
    int leaf()
    {
        const double which = g_.uniform(0, 1);
        if (which < 0.6) return variable();
        if (which < 0.75 && !named.empty())
            return add(op::parameter, g_.below(static_cast<int>(named.size())));
        return which < 0.8 ? add(op::pi) : add(op::number, value_of());
    }
    int function(int of)
    {
        return add(static_cast<op>(static_cast<int>(op::sqrt) + g_.below(14)), 0, of);
    }
    int wave()
    {
        varies_ = true;
        const int n = 1 + g_.below(4);
        return add(op::wave, g_.below(2), n, n + 2 * g_.below(2));
    }
    int tree(int depth)
    {
        if (depth == 0 || g_.chance(0.1)) return leaf();
        if (g_.chance(0.03)) return wave();
        const double which = g_.uniform(0, 1);
        if (which < 0.25) return function(tree(depth - 1));
        if (which < 0.3) return add(op::negative, 0, tree(depth - 1));
        if (which < 0.4) {
            static const int to[] = {2, 2, 2, 3, 4, 5, 6, 7, 1, 0, -1, -2, -3};
            return add(op::whole, to[g_.below(13)], tree(depth - 1));
        }
        if (which < 0.45) {
            const int base = tree(depth - 1);
            if (g_.chance(0.5)) return add(op::power, 0, base, add(op::number, 0.25 + g_.below(6) / 2.0));
            return add(op::power, 0, base, variable());
        }
        if (which < 0.5) { // equal parts
            const int a = tree(depth - 1);
            return add(g_.chance(0.5) ? op::product : op::sum, 0, a, a);
        }
        const int a = tree(depth - 1), b = tree(g_.below(depth));
        static const op two[] = {op::sum,     op::difference, op::product, op::sum, op::difference,
                                 op::product, op::quotient,   op::atan2,   op::min, op::max,
                                 op::hypot};
        return g_.chance(0.5) ? add(two[g_.below(11)], 0, a, b) : add(two[g_.below(11)], 0, b, a);
    }
    int plain(int terms)
    {
        int sum = add(op::number, g_.uniform(-1, 1));
        for (int i = 0; i < terms; i++) {
            int term = g_.chance(0.1) ? wave() : variable();
            if (g_.chance(0.4)) term = add(op::product, 0, leaf(), term);
            if (g_.chance(0.4)) term = function(term);
            if (g_.chance(0.4)) term = add(op::whole, 1 + g_.below(5), term);
            if (g_.chance(0.2)) term = add(op::product, 0, term, variable());
            sum = add(g_.chance(0.5) ? op::sum : op::difference, 0, sum, term);
        }
        return sum;
    }

    // ------------------------------------------------------------------------------------------- as a text

    std::string put(const std::string &s, int level, int least)
    {
        return level < least || g_.chance(0.1) ? "(" + s + ")" : s;
    }
    std::string print(int i, int least)
    {
        static const char *const words[] = {
            "",     "pi",   "",     "x",    "y",    "z",   "r", "-",   "sqrt", "cbrt", "exp",
            "log",  "sin",  "cos",  "tan",  "asin", "acos", "atan", "sinh", "cosh", "tanh", "abs",
            "^",    " + ",  " - ",  "*",    "/",    "atan2", "min", "max", "hypot", "^",   ""};
        const node n = nodes_[static_cast<std::size_t>(i)];
        const std::string word = words[static_cast<int>(n.what)];
        char s[40];
        switch (n.what) {
        case op::number:
            std::snprintf(s, sizeof s, "%.17g", n.value);
            return put(s, n.value < 0 ? 3 : 5, least);
        case op::parameter: return named[static_cast<std::size_t>(n.value)].name;
        case op::pi: case op::x: case op::y: case op::z: case op::r: return put(word, 5, least);
        case op::negative: return put("-" + print(n.a, 3), 3, least);
        case op::whole:
            std::snprintf(s, sizeof s, g_.chance(0.1) ? "^(%g)" : "^%g", n.value);
            return put(print(n.a, 5) + s, 4, least);
        case op::power: return put(print(n.a, 5) + "^" + print(n.b, 3), 4, least);
        case op::wave: {
            char k[20];
            std::snprintf(k, sizeof k, n.b == 1 ? "%s" : "%s^%d", put("r", 5, 5).c_str(), n.b);
            std::snprintf(s, sizeof s, "%s(%d*atan2(y, x))", n.value > 0 ? "sin" : "cos", n.a);
            const bool first = g_.chance(0.5);
            return put(first ? k + ("*" + std::string(s)) : s + ("*" + std::string(k)), 2, least);
        }
        case op::sum: case op::difference: return put(print(n.a, 1) + word + print(n.b, 2), 1, least);
        case op::product: case op::quotient: return put(print(n.a, 2) + word + print(n.b, 3), 2, least);
        case op::atan2: case op::min: case op::max: case op::hypot: {
            const std::string first = print(n.a, 1);
            return put(word + "(" + first + ", " + print(n.b, 1) + ")", 5, least);
        }
        default: return put(word + "(" + print(n.a, 1) + ")", 5, least);
        }
    }

    // ---------------------------------------------------------------------------------------- as a function

    template <class N> N of(const N &x, const N &y, const N &z) const
    {
        N a[3];
        for (std::size_t i = 0; i < named.size(); i++) a[i] = N(named[i].value);
        return level(z, walked(x, y, z, a));
    }
    template <class N> N level(const N &z, const N &v) const { return sag() ? z - v : v; }
    template <class N> N part(const N &x, const N &y, const N &z, std::size_t to) const
    {
        N a[3];
        for (std::size_t i = 0; i < named.size(); i++) a[i] = N(named[i].value);
        return walked(x, y, z, a, to + 1);
    }
    template <class N> N walked(const N &x, const N &y, const N &z, const N *a, std::size_t to = 0) const
    {
        std::vector<N> v;
        v.reserve(nodes_.size());
        if (!to) to = nodes_.size();
        for (std::size_t i = 0; i < to; i++) v.push_back(stepped(nodes_[i], x, y, z, a, v));
        return v.back();
    }
    template <class N>
    static N stepped(const node &n, const N &x, const N &y, const N &z, const N *a, const std::vector<N> &v)
    {
        const auto u = [&] { return v[static_cast<std::size_t>(n.a)]; };
        const auto w = [&] { return v[static_cast<std::size_t>(n.b)]; };
        switch (n.what) {
        case op::number: return N(n.value);
        case op::pi: return formula::pi<N>();
        case op::parameter: return a[static_cast<std::size_t>(n.value)];
        case op::x: return x;
        case op::y: return y;
        case op::z: return z;
        case op::r: return hypot(x, y);
        case op::negative: return -u();
        case op::sqrt: return sqrt(u());
        case op::cbrt: return cbrt(u());
        case op::exp: return exp(u());
        case op::log: return log(u());
        case op::sin: return sin(u());
        case op::cos: return cos(u());
        case op::tan: return tan(u());
        case op::asin: return asin(u());
        case op::acos: return acos(u());
        case op::atan: return atan(u());
        case op::sinh: return sinh(u());
        case op::cosh: return cosh(u());
        case op::tanh: return tanh(u());
        case op::absolute: return absolute(u());
        case op::whole: return pown(u(), static_cast<int>(n.value));
        case op::sum: return u() + w();
        case op::difference: return u() - w();
        case op::product: return u() * w();
        case op::quotient: return over(u(), w());
        case op::atan2: return atan2(u(), w());
        case op::min: return min(u(), w());
        case op::max: return max(u(), w());
        case op::hypot: return hypot(u(), w());
        case op::power: return power(u(), w());
        case op::wave: {
            N re = x, im = y;
            for (int i = 1; i < n.a; i++) {
                const N was = re;
                re = was * x - im * y, im = was * y + im * x;
            }
            return (n.value > 0 ? im : re) * pown(sq(x) + sq(y), (n.b - n.a) / 2);
        }
        }
        return u();
    }
};

} // namespace formula
#endif
