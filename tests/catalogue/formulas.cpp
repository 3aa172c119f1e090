// SPDX-License-Identifier: MIT
// The formulas of the catalogue for the usual types of number (formulas.h).
#include "formulas.h"

namespace catalogue {
FORMULAS_OF(template, double)
FORMULAS_OF(template, quad)
FORMULAS_OF(template, dual_of_point)
} // namespace catalogue
