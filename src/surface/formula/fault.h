// SPDX-License-Identifier: MIT
/* fault.h - the sentence that says what is wrong with a formula, put together without the C library. */
#ifndef SGT_SURFACE_FORMULA_FAULT_H
#define SGT_SURFACE_FORMULA_FAULT_H

#include <sagitta/formula.h>

/* The first fault that was found; later ones follow from it, and are not told. */
typedef struct formula_fault {
    bool found;
    sgt_error error;
} formula_fault;

/* Says that there is a fault at that column.  Returns it, to be told with the functions below; NULL if there
 * was one before. */
formula_fault *sgt_formula_blame(formula_fault *f, size_t column);

/* Append to the sentence what fits, and return f.  f may be NULL. */
formula_fault *sgt_formula_say(formula_fault *f, const char *text);
formula_fault *sgt_formula_say_part(formula_fault *f, const char *text, size_t length);
formula_fault *sgt_formula_say_number(formula_fault *f, size_t n);

#endif
