/* decimal.h - the double nearest to a decimal number. */
#ifndef SGT_SURFACE_FORMULA_DECIMAL_H
#define SGT_SURFACE_FORMULA_DECIMAL_H

#include <stddef.h>

/* The double nearest to the number that the text begins with: 12, 1.5, .5, 5., 1e-06; ties to even.
 * *length: how many characters it has, 0 if there is no number.  An e without digits after it is not a part
 * of it.  INFINITY if it is larger than any double. */
double sgt_formula_decimal(const char *text, size_t *length);

#endif
