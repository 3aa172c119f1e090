// SPDX-License-Identifier: MIT
// text.hpp - a formula as text (sagitta/formula.h), worked out for any type of number.
//
// The text is read anew for each point, by a function for each rule of the grammar (recursive descent), and
// each function returns the value of what it has read.  So nothing is folded, shared or rewritten, as it is
// in the library, of which there is no code here.  Derivatives come with the type of number: the chain rule
// for each function is below.
//
// WHOLE EXPONENTS.  u^2 is a product and u^p, with a parameter p, is exp(p log u), which is not defined for
// u < 0.  To tell them apart, each value knows whether it is a number that numbers alone make exactly.  All
// such numbers are doubles, so sums, products and quotients of two can be tried in 113 bits.  Other functions
// are exact only at 0 or where they are 0 (exp 0, log 1): elsewhere their values are transcendental.
//
// THE VERTEX.  At x = y = 0 r has no slope, and the angle of (x, y) no value.  But formula.h defines
// r^n cos(n atan2(y, x)) and even powers of r there as the polynomials that they are elsewhere.  So where the
// plain text has no value or slope at x = y = 0, r and atan2 are taken at x = 2^-200 instead.  A polynomial
// changes by 2^-200 of its slope, far below 113 bits.  (What has no limit, such as log r, has a value too.
// Nobody asks for it, since the library finds no root there.)
//
// Test: tests/formula/test_text.cpp.
#ifndef TRUTH_TEXT_HPP
#define TRUTH_TEXT_HPP
#include "elementary.hpp"
#include "formulas.hpp"

namespace catalogue {

// ---------------------------------------------------------- the chain rule

using oracle::angle_of;
using oracle::arc_cosine;
using oracle::arc_sine;
using oracle::arc_tangent;
using oracle::cosine_of;
using oracle::cube_root;
using oracle::exponential;
using oracle::hyperbolic_cosine;
using oracle::hyperbolic_sine;
using oracle::hyperbolic_tangent;
using oracle::logarithm;
using oracle::sine_of;
using oracle::tangent;

template <class T, int N> dual<T, N> chained(const dual<T, N> &x, const T &value, const T &slope)
{
    dual<T, N> r(value);
    for (int i = 0; i < N; i++) r.v[i] = slope * x.v[i];
    return r;
}
template <class T, int N> dual<T, N> exponential(const dual<T, N> &x)
{
    const T value = exponential(x.a);
    return chained(x, value, value);
}
template <class T, int N> dual<T, N> logarithm(const dual<T, N> &x)
{
    return chained(x, logarithm(x.a), T(T(1.0) / x.a));
}
template <class T, int N> dual<T, N> sine_of(const dual<T, N> &x)
{
    return chained(x, sine_of(x.a), cosine_of(x.a));
}
template <class T, int N> dual<T, N> cosine_of(const dual<T, N> &x)
{
    return chained(x, cosine_of(x.a), T(-sine_of(x.a)));
}
template <class T, int N> dual<T, N> tangent(const dual<T, N> &x)
{
    const T value = tangent(x.a);
    return chained(x, value, T(T(1.0) + value * value));
}
template <class T, int N> dual<T, N> arc_sine(const dual<T, N> &x)
{
    return chained(x, arc_sine(x.a), T(T(1.0) / square_root(T((T(1.0) - x.a) * (T(1.0) + x.a)))));
}
template <class T, int N> dual<T, N> arc_cosine(const dual<T, N> &x)
{
    return chained(x, arc_cosine(x.a), T(T(-1.0) / square_root(T((T(1.0) - x.a) * (T(1.0) + x.a)))));
}
template <class T, int N> dual<T, N> arc_tangent(const dual<T, N> &x)
{
    return chained(x, arc_tangent(x.a), T(T(1.0) / (T(1.0) + x.a * x.a)));
}
template <class T, int N> dual<T, N> hyperbolic_sine(const dual<T, N> &x)
{
    return chained(x, hyperbolic_sine(x.a), hyperbolic_cosine(x.a));
}
template <class T, int N> dual<T, N> hyperbolic_cosine(const dual<T, N> &x)
{
    return chained(x, hyperbolic_cosine(x.a), hyperbolic_sine(x.a));
}
template <class T, int N> dual<T, N> hyperbolic_tangent(const dual<T, N> &x)
{
    const T value = hyperbolic_tangent(x.a);
    return chained(x, value, T(T(1.0) - value * value));
}
template <class T, int N> dual<T, N> cube_root(const dual<T, N> &x)
{
    const T value = cube_root(x.a);
    return chained(x, value, T(T(1.0) / (T(3.0) * value * value)));
}
template <class T, int N> dual<T, N> angle_of(const dual<T, N> &y, const dual<T, N> &x)
{
    const T size = x.a * x.a + y.a * y.a;
    dual<T, N> r(angle_of(y.a, x.a));
    for (int i = 0; i < N; i++) r.v[i] = (x.a * y.v[i] - y.a * x.v[i]) / size;
    return r;
}

template <class T> T absolute(const T &x) { return plain(x) < 0 ? -x : x; }

// ------------------------------------------------------------- the reading

template <class T> class text_formula {
public:
    text_formula(bool sag, const char *text, std::size_t n, const sgt_named *parameter)
        : sag_(sag), text_(text)
    {
        for (std::size_t i = 0; i < n; i++) names_.push_back({parameter[i].name, parameter[i].value});
    }
    // NaN where it is not defined.
    T operator()(const T &x, const T &y, const T &z) const
    {
        const T value = at(x, y, z, 0);
        const T apart = value - value; // 0, and its derivatives, unless something is not finite
        return nothing(apart) || plain(x) != 0 || plain(y) != 0 ? value : at(x, y, z, 0x1p-200);
    }
    // The column, from 1, of what is not understood; 0: the text is read to its end.
    std::size_t column() const
    {
        reading r(*this, T(0.5), T(0.25), T(0.125), 0);
        r.formula();
        return r.lost();
    }

private:
    bool sag_;
    std::string text_;
    std::vector<std::pair<std::string, double>> names_;

    T at(const T &x, const T &y, const T &z, double beside) const
    {
        const T value = reading(*this, x, y, z, beside).formula();
        return sag_ ? z - value : value;
    }

    // constant: without x, y, z, and so without derivatives.  exact: numbers alone make it, exactly.
    struct part {
        T value;
        bool constant, exact;
    };
    static quad bare(quad x) { return x; }
    template <class S, int N> static quad bare(const dual<S, N> &x) { return bare(x.a); }
    static bool is_double(quad x) { return quad(oracle::to_double(x)) == x; }
    static bool is_whole(const part &p, int most)
    {
        const quad x = bare(p.value);
        return p.exact && oracle::magnitude(x) <= most && x == quad(static_cast<int>(x));
    }

    class reading {
    public:
        // beside: how far from the vertex r and atan2 are taken.
        reading(const text_formula &f, const T &x, const T &y, const T &z, double beside)
            : of_(f), x_(x), y_(y), z_(z), beside_(beside), s_(f.text_.c_str()), lost_(0)
        {
            blanks();
        }
        T formula()
        {
            T value = sum().value;
            if (!of_.sag_ && took('=')) value = value - sum().value;
            if (*s_) lose();
            return value;
        }
        std::size_t lost() const { return lost_; }

    private:
        const text_formula &of_;
        const T x_, y_, z_;
        const double beside_;
        const char *s_;
        std::size_t lost_;

        static bool is_digit(char c) { return c >= '0' && c <= '9'; }
        static bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }
        static part number(double x) { return {T(x), true, true}; }
        static part of(const T &value, const part &a, const part &b)
        {
            const bool constant = a.constant && b.constant;
            return {constant ? T(bare(value)) : value, constant, false};
        }

        void blanks()
        {
            while (*s_ == ' ' || *s_ == '\t' || *s_ == '\n' || *s_ == '\r') s_++;
        }
        bool took(char c)
        {
            if (*s_ != c) return false;
            s_++;
            blanks();
            return true;
        }
        // The first time; then nothing is left to read.
        part lose()
        {
            if (!lost_) lost_ = static_cast<std::size_t>(s_ - of_.text_.c_str()) + 1;
            s_ = of_.text_.c_str() + of_.text_.size();
            return number(0);
        }

        part sum()
        {
            part a = term();
            for (;;) {
                if (took('+')) a = plus(a, term());
                else if (took('-')) a = plus(a, negative(term()));
                else return a;
            }
        }
        part term()
        {
            part a = factor();
            for (;;) {
                if (took('*')) a = product(a, factor());
                else if (took('/')) a = quotient(a, factor());
                else return a;
            }
        }
        part factor()
        {
            if (took('-')) return negative(factor());
            const part base = atom();
            return took('^') ? power(base, factor()) : base;
        }
        part atom()
        {
            if (took('(')) {
                const part inside = sum();
                return took(')') ? inside : lose();
            }
            if (is_digit(*s_) || *s_ == '.') return literal();
            std::string name;
            if (!is_letter(*s_)) return lose();
            while (is_letter(*s_) || is_digit(*s_) || *s_ == '_') name += *s_++;
            blanks();
            if (took('(')) return function(name);
            return named(name);
        }
        // The double nearest to it.  An e without digits is no part of it.
        part literal()
        {
            const char *end = s_;
            while (is_digit(*end) || *end == '.') end++;
            if (*end == 'e' || *end == 'E') {
                const char *more = end + (end[1] == '+' || end[1] == '-' ? 2 : 1);
                if (is_digit(*more)) end = more;
                while (is_digit(*end)) end++;
            }
            const std::string digits(s_, end);
            s_ = end;
            blanks();
            return number(std::strtod(digits.c_str(), nullptr));
        }
        part named(const std::string &name)
        {
            if (name == "x") return {x_, false, false};
            if (name == "y") return {y_, false, false};
            if (name == "z" && !of_.sag_) return {z_, false, false};
            if (name == "r") {
                const T u = x_ + T(beside_);
                return {square_root(T(u * u + y_ * y_)), false, false};
            }
            if (name == "pi") return {T(oracle::half_turn), true, false};
            for (const std::pair<std::string, double> &p : of_.names_)
                if (p.first == name) return {T(p.second), true, false};
            return lose();
        }
        part function(const std::string &name)
        {
            static const struct {
                const char *name;
                T (*of)(const T &);
            } one[] = {
                {"exp", [](const T &u) { return exponential(u); }},
                {"log", [](const T &u) { return logarithm(u); }},
                {"sin", [](const T &u) { return sine_of(u); }},
                {"cos", [](const T &u) { return cosine_of(u); }},
                {"tan", [](const T &u) { return tangent(u); }},
                {"asin", [](const T &u) { return arc_sine(u); }},
                {"acos", [](const T &u) { return arc_cosine(u); }},
                {"atan", [](const T &u) { return arc_tangent(u); }},
                {"sinh", [](const T &u) { return hyperbolic_sine(u); }},
                {"cosh", [](const T &u) { return hyperbolic_cosine(u); }},
                {"tanh", [](const T &u) { return hyperbolic_tangent(u); }},
            };
            const part a = sum(), b = took(',') ? sum() : a;
            if (!took(')')) return lose();
            if (name == "sqrt") return root(a);
            if (name == "hypot") return root(plus(product(a, a), product(b, b)));
            if (name == "abs") return {absolute(a.value), a.constant, a.exact};
            if (name == "min") return lesser(a, b);
            if (name == "max") return negative(lesser(negative(a), negative(b)));
            if (name == "atan2") {
                const bool nowhere = bare(a.value) == 0 && bare(b.value) == 0;
                return elementary(angle_of(a.value, nowhere ? T(b.value + T(beside_)) : b.value), a, b);
            }
            if (name == "cbrt") {
                part c = of(cube_root(a.value), a, a);
                const quad v = bare(c.value);
                c.exact = a.exact && is_double(v) && is_double(v * v) && v * v * v == bare(a.value);
                return c;
            }
            for (const auto &f : one)
                if (name == f.name) return elementary(f.of(a.value), a, a);
            return lose();
        }

        static part lesser(const part &a, const part &b)
        {
            part v = bare(b.value) < bare(a.value) || !is_number(b) ? b : a;
            v.constant = a.constant && b.constant, v.exact = a.exact && b.exact;
            return v;
        }
        static bool is_number(const part &a) { return bare(a.value) == bare(a.value); }
        static part elementary(const T &value, const part &a, const part &b)
        {
            part v = of(value, a, b);
            const quad w = bare(value);
            v.exact = a.exact && b.exact && (bare(a.value) == 0 || w == 0) && is_double(w);
            return v;
        }
        static part negative(part a)
        {
            a.value = -a.value;
            return a;
        }
        static part plus(const part &a, const part &b)
        {
            part s = of(a.value + b.value, a, b);
            const quad u = bare(a.value), v = bare(b.value), w = bare(s.value);
            s.exact = a.exact && b.exact && is_double(w) && w - u == v && w - v == u;
            return s;
        }
        static part product(const part &a, const part &b)
        {
            part p = of(a.value * b.value, a, b);
            p.exact = a.exact && b.exact && is_double(bare(p.value));
            return p;
        }
        static part quotient(const part &a, const part &b)
        {
            part q = of(a.value / b.value, a, b);
            const quad w = bare(q.value);
            q.exact = a.exact && b.exact && is_double(w) && w * bare(b.value) == bare(a.value);
            if (bare(b.value) == 0) q.value = T(static_cast<double>(NAN));
            return q;
        }
        static part root(const part &a)
        {
            part r = of(square_root(a.value), a, a);
            const quad w = bare(r.value);
            r.exact = a.exact && is_double(w) && w * w == bare(a.value);
            return r;
        }
        static part power(const part &b, const part &e)
        {
            enum { LARGEST = 1 << 20, FEW = 64 };
            if (is_whole(e, LARGEST)) {
                const int n = static_cast<int>(bare(e.value));
                if (n == 0) return is_number(b) ? number(1) : b;
                part p = of(catalogue::power(b.value, n < 0 ? -n : n), b, b), stepped = number(1);
                const int most = n < 0 ? -n : n;
                for (int i = 0; b.exact && stepped.exact && i < most && most <= FEW; i++)
                    stepped = product(stepped, b);
                p.exact = b.exact && stepped.exact && most <= FEW;
                return n < 0 ? quotient(number(1), p) : p;
            }
            const part twice = product(number(2), e);
            if (b.constant && is_whole(twice, FEW)) return power(root(b), twice); // 4^0.5 is exactly 2
            const quad u = bare(b.value), v = bare(e.value);
            if (u > 0) return of(exponential(T(e.value * logarithm(b.value))), b, e);
            if (u == 0 && v > 1) return of(T(0.0), b, e);
            if (u == 0 && v > 0) return of(square_root(b.value), b, e); // 0, and steep as well
            return of(T(static_cast<double>(NAN)), b, e);
        }
    };
};

} // namespace catalogue
#endif
