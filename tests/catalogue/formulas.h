// SPDX-License-Identifier: MIT
// formulas.h - F of each surface by its definition, for any type of number: the table that the command's
// trade and these oracles share, and test_formulas.cpp checks.
#ifndef TESTS_CATALOGUE_FORMULAS_H
#define TESTS_CATALOGUE_FORMULAS_H

#include "../../src/truth/formulas.hpp"
#include "../oracle/quad.h"

// What most of the tests ask for is compiled once, in formulas.cpp.
#define FORMULAS_OF(how, number)                                                                           \
    how const row<number> *row_of<number>(const sgt_surface &);                                            \
    how number level(const sgt_surface &, const number *, const number &, const number &, const number &); \
    how number smooth_level(const sgt_surface &, const number *, const number &, const number &,           \
                            const number &);

namespace catalogue {
typedef dual<quad, 3> dual_of_point;
FORMULAS_OF(extern template, double)
FORMULAS_OF(extern template, quad)
FORMULAS_OF(extern template, dual_of_point)
} // namespace catalogue

#endif
