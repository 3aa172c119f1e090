// SPDX-License-Identifier: MIT
// numbers.h - the operations of a formula, for four types of number, so that a formula is written once.
//
//   double   F as a machine works it out
//   ball     Arb's balls (../proof/ball.h): F to any precision, or an enclosure of it
//   range    interval.h: what a user's `enclose` is made of
//   dual<T>  T and one derivative of it (Clifford), by t, by a coordinate or by a parameter; of a dual the
//            second derivatives
//
// An enclosure may be of a stretch where F is not smooth, or not defined all over.  `seen` says what an
// evaluation came across since it was cleared:
//   nowhere  an operand is outside the domain all over: F is not defined on any of it
//   border   partly so: the end of a domain
//   pole     a divisor may be zero, or a tangent infinite
//   cut      atan2 jumps, or has no value
//   kink     abs, min and max change branch, or a root or a power has a steep end: F is continuous
// Derivatives of kinks are those of both branches: F lies within them of its value at any point of the
// stretch (Clarke 1983, theorem 2.3.7).  After a border, a pole or a cut they say nothing.
#ifndef FORMULA_NUMBERS_H
#define FORMULA_NUMBERS_H

#include "../proof/ball.h"

#include <sagitta/interval.h>

#include <cmath>

namespace formula
{

struct marks {
    bool nowhere = false, border = false, pole = false, cut = false, kink = false;
    bool torn() const { return border || pole || cut; }
};
inline marks seen;

} // namespace formula

// ------------------------------------------------------------------------------------------------- balls

namespace proof
{

using formula::seen;

inline int sign_of(const ball &a) { return a.sign(); }
inline bool is_nothing(const ball &a) { return a.is_zero(); }
inline bool has_zero(const ball &a) { return arb_contains_zero(a.x); }
inline ball unknown()
{
    ball r;
    arb_indeterminate(r.x);
    return r;
}
inline ball hull(const ball &a, const ball &b) { return between(a, b); }
inline ball not_negative(const ball &a)
{
    if (arb_is_nonnegative(a.x) || !a.is_finite()) return a;
    return between(ball(0), high(a));
}
inline ball sq(const ball &a) { return not_negative(square(a)); }
inline ball over(const ball &a, const ball &b)
{
    if (b.is_zero()) seen.nowhere = true;
    if (b.sign() == 0) seen.pole = true;
    return a / b;
}
inline ball pown(const ball &a, int n)
{
    if (n == 0) return 1;
    if (n < 0) return over(1, pown(a, -n));
    return n % 2 ? a * pown(a, n - 1) : sq(pown(a, n / 2));
}
// The part of a that is at least 0; false: there is none.
inline bool to_domain(ball *a)
{
    if (arb_is_positive(a->x) || a->is_zero()) {
        seen.kink = seen.kink || a->is_zero();
        return true;
    }
    if (arb_is_negative(a->x)) {
        seen.nowhere = true;
        return false;
    }
    (arb_is_nonnegative(a->x) ? seen.kink : seen.border) = true;
    *a = not_negative(*a);
    return a->is_finite();
}
inline ball sqrt(ball a)
{
    if (!to_domain(&a)) return unknown();
    ball r;
    if (a.sign() || a.is_zero())
        arb_sqrt(r.x, a.x, bits);
    else
        arb_sqrt(r.x, high(a).x, bits), r = between(ball(0), r);
    return r;
}
inline ball log(const ball &a)
{
    if (arb_is_nonpositive(a.x)) seen.nowhere = true;
    if (!a.sign()) seen.border = true;
    ball r;
    arb_log(r.x, a.x, bits);
    return a.sign() > 0 ? r : unknown();
}
inline ball cbrt(const ball &a)
{
    if (a.sign() < 0) return -cbrt(-a);
    ball r;
    if (a.is_zero()) seen.kink = true;
    if (a.sign() > 0 || a.is_zero()) {
        arb_root_ui(r.x, a.x, 3, bits);
        return r;
    }
    seen.kink = true;
    if (!a.is_finite()) return unknown();
    return between(cbrt(low(a)), cbrt(high(a)));
}
inline ball exp(const ball &a)
{
    ball r;
    arb_exp(r.x, a.x, bits);
    return r;
}
inline ball sin(const ball &a)
{
    ball r;
    arb_sin(r.x, a.x, bits);
    return r;
}
inline ball cos(const ball &a)
{
    ball r;
    arb_cos(r.x, a.x, bits);
    return r;
}
inline ball atan(const ball &a)
{
    ball r;
    arb_atan(r.x, a.x, bits);
    return r;
}
inline ball sinh(const ball &a)
{
    ball r;
    arb_sinh(r.x, a.x, bits);
    return r;
}
inline ball cosh(const ball &a)
{
    ball r;
    arb_cosh(r.x, a.x, bits);
    return r;
}
inline ball tanh(const ball &a)
{
    ball r;
    arb_tanh(r.x, a.x, bits);
    return r;
}
inline ball tan(const ball &a)
{
    if (cos(a).sign() == 0) {
        seen.pole = true;
        return unknown();
    }
    ball r;
    arb_tan(r.x, a.x, bits);
    return r;
}
// The part of a that is in [-1, 1]; false: there is none.
inline bool to_circle(ball *a)
{
    const ball size = proof::size(*a), one = 1;
    if (less(one, size)) {
        seen.nowhere = true;
        return false;
    }
    if (arb_le(size.x, one.x)) return true;
    seen.border = true;
    ball unit;
    arb_add_error(unit.x, one.x);
    if (!cut_to(unit, a)) *a = unit; // of a NaN nothing is known
    return true;
}
inline ball half_pi()
{
    ball r;
    arb_const_pi(r.x, bits);
    return scaled(r, -1);
}
inline ball asin(ball a)
{
    if (!to_circle(&a)) return unknown();
    const auto at = [](const ball &end) { // (an end may be beyond 1 by a rounding)
        ball r;
        if (arb_ge(end.x, ball(1).x)) return half_pi();
        if (arb_le(end.x, ball(-1).x)) return -half_pi();
        arb_asin(r.x, end.x, bits);
        return r;
    };
    return between(at(low(a)), at(high(a)));
}
inline ball acos(const ball &a) { return half_pi() - asin(a); }
inline ball atan2(const ball &y, const ball &x)
{
    if (!y.sign() && x.sign() <= 0) {
        seen.cut = true;
        if (y.is_zero() && x.is_zero()) seen.nowhere = true;
        if (!(y.is_zero() && x.sign() < 0)) { // [-pi, pi]
            ball r = scaled(half_pi(), 1), whole;
            arb_add_error(whole.x, r.x);
            return y.is_finite() && x.is_finite() ? whole : unknown();
        }
    }
    ball r;
    arb_atan2(r.x, y.x, x.x, bits);
    return r;
}
inline ball absolute(const ball &a) { return a.sign() ? size(a) : not_negative(size(a)); }
inline ball min(const ball &a, const ball &b)
{
    ball r;
    arb_min(r.x, a.x, b.x, bits);
    return r;
}
inline ball max(const ball &a, const ball &b)
{
    ball r;
    arb_max(r.x, a.x, b.x, bits);
    return r;
}
inline ball hypot(const ball &a, const ball &b) { return sqrt(sq(a) + sq(b)); }
inline ball power(ball b, const ball &e)
{
    ball r;
    if (b.sign() > 0) {
        arb_pow(r.x, b.x, e.x, bits);
        return r;
    }
    if (!to_domain(&b)) return unknown();
    if (e.sign() <= 0) {
        (b.is_zero() && arb_is_nonpositive(e.x) ? seen.nowhere : seen.pole) = true;
        return unknown();
    }
    if (b.is_zero()) return 0;
    arb_pow(r.x, high(b).x, e.x, bits);
    return between(ball(0), r);
}

} // namespace proof

namespace formula
{

using proof::ball;

// ----------------------------------------------------------------------------------------------- doubles

inline int sign_of(double a) { return (a > 0) - (a < 0); }
inline bool is_nothing(double a) { return a == 0; }
inline bool has_zero(double a) { return a == 0; }
inline double hull(double a, double) { return a; }
inline double sq(double a) { return a * a; }
inline double pown(double a, int n) { return std::pow(a, n); }
inline double over(double a, double b) { return b == 0 ? static_cast<double>(NAN) : a / b; }
inline double sqrt(double a) { return std::sqrt(a); }
inline double cbrt(double a) { return std::cbrt(a); }
inline double exp(double a) { return std::exp(a); }
inline double log(double a) { return a > 0 ? std::log(a) : static_cast<double>(NAN); }
inline double sin(double a) { return std::sin(a); }
inline double cos(double a) { return std::cos(a); }
inline double tan(double a) { return std::tan(a); }
inline double asin(double a) { return std::asin(a); }
inline double acos(double a) { return std::acos(a); }
inline double atan(double a) { return std::atan(a); }
inline double sinh(double a) { return std::sinh(a); }
inline double cosh(double a) { return std::cosh(a); }
inline double tanh(double a) { return std::tanh(a); }
inline double absolute(double a) { return std::fabs(a); }
inline double atan2(double y, double x)
{
    return x == 0 && y == 0 ? static_cast<double>(NAN) : std::atan2(y, x);
}
inline double min(double a, double b) { return a < b ? a : b; }
inline double max(double a, double b) { return a > b ? a : b; }
inline double hypot(double a, double b) { return std::hypot(a, b); }
inline double power(double b, double e)
{
    return b > 0 || (b == 0 && e > 0) ? std::pow(b, e) : static_cast<double>(NAN);
}

// ---------------------------------------------------------------------------------------------- intervals

struct range {
    sgt_interval i;
    range() : i{0, 0} {}
    range(double a) : i{a, a} {}
    range(sgt_interval a) : i(a) {}
    friend range operator+(range a, range b) { return sgt_interval_sum(a.i, b.i); }
    friend range operator-(range a, range b) { return sgt_interval_difference(a.i, b.i); }
    friend range operator*(range a, range b) { return sgt_interval_product(a.i, b.i); }
    friend range operator/(range a, range b) { return sgt_interval_quotient(a.i, b.i); }
    range operator-() const { return sgt_interval_negative(i); }
};
inline int sign_of(range a) { return sgt_interval_is_positive(a.i) - sgt_interval_is_negative(a.i); }
inline bool is_nothing(range a) { return a.i.lo == 0 && a.i.hi == 0; }
inline bool has_zero(range a) { return sgt_interval_has(a.i, 0); }
inline range hull(range a, range b) { return sgt_interval_hull(a.i, b.i); }
inline range sq(range a) { return sgt_interval_square(a.i); }
inline range pown(range a, int n)
{
    if (n < 0) return range(1) / pown(a, -n);
    return n == 0 ? range(1) : range(sgt_interval_power(a.i, n));
}
inline range over(range a, range b)
{
    if (has_zero(b)) seen.pole = true;
    return a / b;
}
inline range marked(range a, bool nowhere, bool border)
{
    if (nowhere) seen.nowhere = true;
    if (border) seen.border = true;
    return a;
}
inline range sqrt(range a) { return marked(sgt_interval_square_root(a.i), a.i.hi < 0, a.i.lo < 0); }
inline range log(range a) { return marked(sgt_interval_logarithm(a.i), a.i.hi <= 0, a.i.lo <= 0); }
inline range cbrt(range a) { return sgt_interval_cube_root(a.i); }
inline range exp(range a) { return sgt_interval_exponential(a.i); }
inline range sin(range a) { return sgt_interval_sine(a.i); }
inline range cos(range a) { return sgt_interval_cosine(a.i); }
inline range atan(range a) { return sgt_interval_arc_tangent(a.i); }
inline range sinh(range a) { return sgt_interval_hyperbolic_sine(a.i); }
inline range cosh(range a) { return sgt_interval_hyperbolic_cosine(a.i); }
inline range tanh(range a) { return sgt_interval_hyperbolic_tangent(a.i); }
inline range tan(range a)
{
    const range r = sgt_interval_tangent(a.i);
    if (!(r.i.lo > -HUGE_VAL && r.i.hi < HUGE_VAL)) seen.pole = true;
    return r;
}
inline range asin(range a)
{
    return marked(sgt_interval_arc_sine(a.i), a.i.lo > 1 || a.i.hi<-1, a.i.hi> 1 || a.i.lo < -1);
}
inline range acos(range a)
{
    return marked(sgt_interval_arc_cosine(a.i), a.i.lo > 1 || a.i.hi<-1, a.i.hi> 1 || a.i.lo < -1);
}
inline range absolute(range a) { return sgt_interval_absolute(a.i); }
inline range atan2(range y, range x)
{
    if (has_zero(y) && !(x.i.lo > 0)) seen.cut = true;
    return sgt_interval_angle(y.i, x.i);
}
inline range min(range a, range b)
{
    return sgt_interval{std::min(a.i.lo, b.i.lo), std::min(a.i.hi, b.i.hi)};
}
inline range max(range a, range b)
{
    return sgt_interval{std::max(a.i.lo, b.i.lo), std::max(a.i.hi, b.i.hi)};
}
inline range hypot(range a, range b) { return sgt_interval_hypotenuse(a.i, b.i); }
inline range power(range b, range e)
{
    return marked(sgt_interval_real_power(b.i, e.i), b.i.hi < 0, b.i.lo < 0 || (b.i.lo <= 0 && e.i.lo <= 0));
}

// ------------------------------------------------------------------------------------------------- duals

template <class T> struct dual {
    T v, s;
    dual() : v(0.0), s(0.0) {}
    dual(double c) : v(c), s(0.0) {}
    dual(const T &value, const T &slope) : v(value), s(slope) {}
    friend dual operator+(const dual &a, const dual &b) { return {a.v + b.v, a.s + b.s}; }
    friend dual operator-(const dual &a, const dual &b) { return {a.v - b.v, a.s - b.s}; }
    friend dual operator*(const dual &a, const dual &b) { return {a.v * b.v, a.s * b.v + a.v * b.s}; }
    friend dual operator/(const dual &a, const dual &b)
    {
        const T q = over(a.v, b.v);
        return {q, is_nothing(b.s) ? over(a.s, b.v) : over(a.s - q * b.s, b.v)};
    }
    dual operator-() const { return {-v, -s}; }
};
template <class T> int sign_of(const dual<T> &a) { return sign_of(a.v); }
template <class T> bool is_nothing(const dual<T> &a) { return is_nothing(a.v) && is_nothing(a.s); }
template <class T> bool has_zero(const dual<T> &a) { return has_zero(a.v); }
template <class T> dual<T> hull(const dual<T> &a, const dual<T> &b)
{
    return {hull(a.v, b.v), hull(a.s, b.s)};
}
template <class T> dual<T> over(const dual<T> &a, const dual<T> &b) { return a / b; }
template <class T> dual<T> sq(const dual<T> &a) { return {sq(a.v), T(2.0) * a.v * a.s}; }
template <class T> dual<T> pown(const dual<T> &a, int n)
{
    if (n == 0) return dual<T>(1);
    if (n < 0) return dual<T>(1) / pown(a, -n);
    return {pown(a.v, n), T(static_cast<double>(n)) * pown(a.v, n - 1) * a.s};
}
template <class T> dual<T> sqrt(const dual<T> &a)
{
    const T v = sqrt(a.v);
    return {v, is_nothing(a.s) ? a.s : a.s / (T(2.0) * v)};
}
template <class T> dual<T> cbrt(const dual<T> &a)
{
    const T v = cbrt(a.v);
    return {v, is_nothing(a.s) ? a.s : a.s / (T(3.0) * sq(v))};
}
template <class T> dual<T> exp(const dual<T> &a)
{
    const T v = exp(a.v);
    return {v, v * a.s};
}
template <class T> dual<T> log(const dual<T> &a) { return {log(a.v), a.s / a.v}; }
template <class T> dual<T> sin(const dual<T> &a) { return {sin(a.v), cos(a.v) * a.s}; }
template <class T> dual<T> cos(const dual<T> &a) { return {cos(a.v), -sin(a.v) * a.s}; }
template <class T> dual<T> tan(const dual<T> &a)
{
    const T v = tan(a.v);
    return {v, (T(1.0) + sq(v)) * a.s};
}
template <class T> T beside(const T &a) { return T(1.0) / sqrt((T(1.0) - a) * (T(1.0) + a)); }
template <class T> dual<T> asin(const dual<T> &a)
{
    const T v = asin(a.v);
    return {v, a.s * beside(a.v)};
}
template <class T> dual<T> acos(const dual<T> &a)
{
    const T v = acos(a.v);
    return {v, -a.s * beside(a.v)};
}
template <class T> dual<T> atan(const dual<T> &a) { return {atan(a.v), a.s / (T(1.0) + sq(a.v))}; }
template <class T> dual<T> sinh(const dual<T> &a) { return {sinh(a.v), cosh(a.v) * a.s}; }
template <class T> dual<T> cosh(const dual<T> &a) { return {cosh(a.v), sinh(a.v) * a.s}; }
template <class T> dual<T> tanh(const dual<T> &a)
{
    const T v = tanh(a.v);
    return {v, (T(1.0) - sq(v)) * a.s};
}
template <class T> dual<T> atan2(const dual<T> &y, const dual<T> &x)
{
    return {atan2(y.v, x.v), (x.v * y.s - y.v * x.s) / (sq(x.v) + sq(y.v))};
}
template <class T> dual<T> absolute(const dual<T> &a)
{
    const int sign = sign_of(a.v);
    if (sign) return sign > 0 ? a : -a;
    seen.kink = true;
    return {absolute(a.v), hull(a.s, -a.s)};
}
template <class T> dual<T> min(const dual<T> &a, const dual<T> &b)
{
    const int sign = sign_of(a.v - b.v);
    if (sign) return sign < 0 ? a : b;
    seen.kink = true;
    return {min(a.v, b.v), hull(a.s, b.s)};
}
template <class T> dual<T> max(const dual<T> &a, const dual<T> &b) { return -min(-a, -b); }
template <class T> dual<T> hypot(const dual<T> &a, const dual<T> &b)
{
    const T v = hypot(a.v, b.v);
    if (sign_of(v)) return {v, (a.v * a.s + b.v * b.s) / v};
    const T most = hypot(a.s, b.s);
    seen.kink = true;
    return {v, hull(-most, most)};
}
template <class T> dual<T> power(const dual<T> &b, const dual<T> &e)
{
    const T v = power(b.v, e.v);
    const bool nowhere = seen.nowhere; // of F: its slope may be nowhere defined (0^e by e)
    T s(0.0);
    if (!is_nothing(b.s)) { // (the steep end of a power is a kink, and no pole)
        const marks before = seen;
        s = e.v * power(b.v, e.v - T(1.0)) * b.s;
        if (seen.pole && !before.pole) seen = before, seen.kink = true;
    }
    if (!is_nothing(e.s) && !is_nothing(v)) s = s + v * log(b.v) * e.s; // (0^e is 0 for all e > 0)
    seen.nowhere = nowhere;
    return {v, s};
}

// As the texts have it.
template <class N> N power(const N &b, double e) { return power(b, N(e)); }
template <class N> N abs(const N &a) { return absolute(a); }

template <class N> struct number_pi;
template <> struct number_pi<double> {
    static double get() { return 3.141592653589793; }
};
template <> struct number_pi<ball> {
    static ball get() { return proof::scaled(proof::half_pi(), 1); }
};
template <> struct number_pi<range> {
    static range get() { return sgt_interval{0x1.921fb54442d18p+1, 0x1.921fb54442d19p+1}; }
};
template <class T> struct number_pi<dual<T>> {
    static dual<T> get() { return {number_pi<T>::get(), T(0.0)}; }
};
template <class N> N pi() { return number_pi<N>::get(); }

} // namespace formula
#endif
