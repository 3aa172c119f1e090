// SPDX-License-Identifier: MIT
/* widths.h - both polynomials of a fitted map at some points, by registers of each width (fitted.h): the same
 * bits.
 *
 * Test: tests/lens/fitted.c. */
#ifndef SGT_OPTICS_WIDTHS_H
#define SGT_OPTICS_WIDTHS_H
#include "launch.h"

/* Registers that go side by side, and the most points of a call. */
enum { PARTS = 4, AIM_FEW_MOST = 8 * PARTS };
#if defined(__GNUC__) && !defined(__clang__)
#define WRITTEN_OUT _Pragma("GCC unroll 16")
#else
#define WRITTEN_OUT
#endif
typedef void few_fitted(const sgt_aim_map *of, const double x[], const double y[], double u[], double v[]);

#define RAYS 2
#define FITTED(name) name##_by_2
#define WITH
#include "fitted.h"

/* gcc does not align such registers on the stack of Windows. */
#if defined(__x86_64__) && defined(__GNUC__) && !defined(_WIN32)
#define SGT_WIDE
#define RAYS 4
#define FITTED(name) name##_by_4
#define WITH __attribute__((target("avx2")))
#include "fitted.h"

#define RAYS 8
#define FITTED(name) name##_by_8
#define WITH __attribute__((target("avx512f")))
#include "fitted.h"

static few_fitted *widest(size_t *count)
{
    const bool eight = __builtin_cpu_supports("avx512f"), four = __builtin_cpu_supports("avx2");
    *count = PARTS * (eight ? 8 : four ? 4 : 2);
    return eight ? few_by_8 : four ? few_by_4 : few_by_2;
}
#else
static few_fitted *widest(size_t *count)
{
    *count = PARTS * 2;
    return few_by_2;
}
#endif

#endif
