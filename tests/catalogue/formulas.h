// formulas.h - F of each surface by its definition, for any type of number: the table that the command's
// trade and these oracles share, and test_formulas.cpp checks.
#ifndef TESTS_CATALOGUE_FORMULAS_H
#define TESTS_CATALOGUE_FORMULAS_H

#include "../../src/truth/formulas.hpp"
#include "../oracle/quad.h"

#endif
