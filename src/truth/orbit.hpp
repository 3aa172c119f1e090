// SPDX-License-Identifier: MIT
// orbit.hpp - quaternions and the orbit Q -> Q^p + c by its definition, for any type of number.
//
// Shared by formulas.hpp and the oracles of tests/.
#ifndef TRUTH_ORBIT_HPP
#define TRUTH_ORBIT_HPP

namespace oracle {

template <class T> struct quaternion {
    T a, b, c, d;
};
template <class T> quaternion<T> operator+(const quaternion<T> &p, const quaternion<T> &q)
{
    return {p.a + q.a, p.b + q.b, p.c + q.c, p.d + q.d};
}
template <class T> quaternion<T> operator*(const quaternion<T> &p, const quaternion<T> &q)
{
    return {p.a * q.a - p.b * q.b - p.c * q.c - p.d * q.d, p.a * q.b + p.b * q.a + p.c * q.d - p.d * q.c,
            p.a * q.c - p.b * q.d + p.c * q.a + p.d * q.b, p.a * q.d + p.b * q.c - p.c * q.b + p.d * q.a};
}
template <class T> quaternion<T> operator*(const T &k, const quaternion<T> &q)
{
    return {k * q.a, k * q.b, k * q.c, k * q.d};
}
template <class T> T dot(const quaternion<T> &p, const quaternion<T> &q)
{
    return p.a * q.a + p.b * q.b + p.c * q.c + p.d * q.d;
}
template <class T> quaternion<T> power(const quaternion<T> &q, int p)
{
    return p == 1 ? q : p % 2 ? q * power(q, p - 1) : power(q * q, p / 2);
}
template <class T> quaternion<T> constant(const double v[4]) { return {T(v[0]), T(v[1]), T(v[2]), T(v[3])}; }

// Q_n of the orbit that starts at q, n = `levels`; or the first with |Q|^2 > far: after that it grows.
template <class T>
quaternion<T> orbit(quaternion<T> q, const quaternion<T> &c, int p, int levels, double far, int *n)
{
    for (*n = 0; *n < levels && !(dot(q, q) > far); ++*n) q = power(q, p) + c;
    return q;
}

} // namespace oracle
#endif
