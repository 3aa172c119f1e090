/* fma.h - a * b + c, rounded once, on every system.
 *
 * Error terms and outward rounding rest on it, and the fma of some C libraries is not rounded once (mingw-w64's is
 * not).  Where the processor that is compiled for has the instruction it is that; else it is worked out. */
#ifndef SAGITTA_FMA_H
#define SAGITTA_FMA_H

#include <math.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The same without the instruction: any doubles, infinities, NaN and subnormal numbers included, rounded to nearest,
 * ties to even; the exception flags are not kept. */
#if defined(__GNUC__)
__attribute__((noinline, unused))
#endif
static double sgt_fma_exactly(double a, double b, double c)
{
    return fma(a, b, c);
}

static inline double sgt_fma(double a, double b, double c)
{
#if defined(__FMA__) || defined(__aarch64__) || defined(__s390x__) || defined(__FP_FAST_FMA)
    return __builtin_fma(a, b, c);
#else
    return sgt_fma_exactly(a, b, c);
#endif
}

#ifdef __cplusplus
}
#endif

#endif
