// SPDX-License-Identifier: MIT
/* The operations of formulas as a program sees them: operations.h. */
#include "operations.h"

#include <sagitta/formula.h>

OF_IMPLICIT(formula, "formula")
OF_DEPARTURE(formula_sag, "formula")
