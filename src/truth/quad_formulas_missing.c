// SPDX-License-Identifier: MIT
/* quad_formulas_missing.c - replaces quad_formulas.cpp if there is no C++, or no number of 113 bits. */
#include "quad.h"

const quad_formula *quad_formula_of(sgt_surface s)
{
    (void)s;
    return NULL;
}

size_t quad_formula_read(sgt_surface s, const char *text, size_t n, const sgt_named parameter[])
{
    (void)s, (void)text, (void)n, (void)parameter;
    return 1;
}

quad quad_value(const quad_formula *f, quad3 p, quad3 *grad)
{
    (void)f, (void)p;
    *grad = (quad3){0, 0, 0};
    return 0;
}
