// SPDX-License-Identifier: MIT
/* lanes.h - a formula for one ray, written so that a loop over rays becomes vector code.
 *
 * There is no branch, no call but sqrt and fma, and choices are made by masks as wide as a double: all
 * bits set, or none.  The compiler then makes the loop of the lanes of a register.  Each lane does the
 * operations of the single ray in the same order.  IEEE 754 rounds each of them in one way, and
 * -ffp-contract=off leaves them as they are written.  So a lane's bits are those of the single ray, on
 * every processor.
 *
 * A condition is written so that it is false for NaN.  The result of fma is never negated, nor that of dot,
 * which ends in one; its arguments are, or what it is multiplied by: compilers make one instruction of
 * -fma(a, b, c), and its zero has another sign. */
#ifndef SGT_NUM_LANES_H
#define SGT_NUM_LANES_H

#include "exact.h"

typedef unsigned long long mask;

#define MASK(condition) ((condition) ? ~0ULL : 0ULL)

SGT_INLINE double chosen(mask m, double yes, double no) { return m != 0 ? yes : no; }

/* Marks a loop whose rounds do not depend on each other. */
#define LANES _Pragma("omp simd")

/* Marks a loop of a constant number of rounds, at most 16, inside of such a loop: to be written out, as a
 * loop inside would keep the compiler from vectorising. */
#if defined(__GNUC__) && !defined(__clang__)
#define UNROLLED _Pragma("GCC unroll 16")
#else
#define UNROLLED
#endif

#endif
