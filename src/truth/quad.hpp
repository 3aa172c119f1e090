// SPDX-License-Identifier: MIT
// quad.hpp - numbers of 113 bits in C++: gcc's and clang's __float128, or a long double of that width.
//
// The arithmetic is in the compiler's own library.  The square root is here, so no other library is needed.
// The command's trade and the oracles of tests/ share this file and formulas.hpp.
#ifndef TRUTH_QUAD_HPP
#define TRUTH_QUAD_HPP
#include "quad.h"

#include <cmath>

namespace oracle {

using ::quad;

inline quad magnitude(quad x) { return x < 0 ? -x : x; }
inline double magnitude(double x) { return std::fabs(x); }
inline double to_double(quad x) { return static_cast<double>(x); }
inline double square_root(double x) { return std::sqrt(x); }

// By Newton from the double's root: 53 bits, 105, 113.  NaN for x < 0.
inline quad square_root(quad x)
{
    if (!(x > 0)) return x == 0 ? x : quad(NAN);
    if (x - x != 0) return x; // infinity
    quad scale = 1;
    while (x > quad(0x1p1000)) { x *= quad(0x1p-1000); scale *= quad(0x1p500); }
    while (x < quad(0x1p-1000)) { x *= quad(0x1p1000); scale *= quad(0x1p-500); }
    quad y = std::sqrt(to_double(x));
    y = (y + x / y) / 2;
    return scale * ((y + x / y) / 2);
}

} // namespace oracle
#endif
