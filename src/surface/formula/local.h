// SPDX-License-Identifier: MIT
/* local.h - one operation of a formula on a row of points: its result, and its own derivatives.
 *
 * With v = op(a, b) the rules are in terms of the partial derivatives by the operands, va, vb, vaa, vab, vbb.
 * The chain rule makes of them whatever derivative is asked for: gradients, and second derivatives by points
 * and parameters (values.c).  So each operation is written once.
 *
 * NaN is undefined, and stays.  A quotient by 0 is NaN, not infinite: F would change its sign there without
 * a root.  A minimum with a NaN is NaN.
 *
 * KINKS.  At 0 the derivative of |a| is taken as 1, where a = b that of min and max as that of a, and the
 * hypotenuse of 0 and 0 as flat: each is one of the derivatives nearby, or their mean. */
#ifndef SGT_SURFACE_FORMULA_LOCAL_H
#define SGT_SURFACE_FORMULA_LOCAL_H

#include "../../num/functions.h"
#include "../../num/lanes.h"
#include "tape.h"

enum { FORMULA_BLOCK = 64 };

typedef double formula_row[FORMULA_BLOCK];

/* The rows of one operation.  NULL for vb, vab, vbb where it has one operand; vaa NULL: second derivatives
 * are not wanted.  No row is a or b. */
typedef struct formula_local { double *v, *va, *vb, *vaa, *vab, *vbb; } formula_local;

/* Of n numbers, FORMULA_BLOCK at most.  e: the exponent of FORMULA_POWER and FORMULA_HALF_POWER.  first: va
 * and vb are wanted. */
void sgt_formula_local(formula_op op, int e, size_t n, const double *a, const double *b, bool first,
                       formula_local out);

/* Of rows: by a, a b, and va a + vb b.  out may be an operand. */
void sgt_row_scaled(size_t n, double by, const double *a, double *out);
void sgt_row_product(size_t n, const double *a, const double *b, double *out);
void sgt_row_products(size_t n, const double *va, const double *a, const double *vb, const double *b,
                      double *out);

#endif
