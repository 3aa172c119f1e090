// SPDX-License-Identifier: MIT
/* exact.h - sums and products without loss, and numbers of twice the precision.
 *
 * ERROR-FREE SUMS AND PRODUCTS.  For doubles a, b and rounding to nearest, a + b and a * b differ from
 * their rounded values by an amount that is itself a double.  For the sum: Moller 1965; Knuth, TAOCP vol.
 * 2, 4.2.2, theorem B.  For the product: one fused multiply-add.  This holds as long as nothing overflows
 * and no product falls below 2^-969.
 *
 * A TWOFOLD hi + lo, |lo| <= ulp(hi)/2, carries at least 2 * 53 - 1 bits.  The relative errors of its
 * operations, with u = 2^-53, are at most
 *
 *     sum            3 u^2 + 13 u^3
 *     product        5 u^2
 *     quotient       15 u^2 + 56 u^3
 *     square root    25/8 u^2
 *
 * (Joldes, Muller, Popescu 2017, ACM TOMS 44, 15res; the square root: Lefevre, Louvet, Muller, Picot,
 * Rideau 2023, ACM TOMS 49, 2).  All are below SGT_TWOFOLD = 16 u^2 = 2^-102.  The exponent range is that
 * of a double, so callers scale first.
 *
 * sgt_fma() is rounded once on every system (fma.h). */
#ifndef SGT_NUM_EXACT_H
#define SGT_NUM_EXACT_H

#include <sagitta/fma.h>

#include <math.h>

/* The C library of mingw-w64 sends these through memory or the x87.  A loop with one of them is then no
 * vector code. */
#if defined(__MINGW32__)
#undef copysign
#undef isfinite
#undef isnan
#undef signbit
#define copysign(x, sign) __builtin_copysign(x, sign)
#define isfinite(x) __builtin_isfinite(x)
#define isnan(x) __builtin_isnan(x)
#define signbit(x) __builtin_signbit(x)
#endif

/* SGT_SMALL: a set that is to be small rather than fast (src/meson.build). */
#if defined(__GNUC__) && defined(SGT_SMALL)
#define SGT_INLINE static inline __attribute__((unused))
#elif defined(__GNUC__)
#define SGT_INLINE static inline __attribute__((always_inline, unused))
#else
#define SGT_INLINE static inline
#endif

#if defined(__clang__)
#define SGT_NOINLINE __attribute__((noinline))
#elif defined(__GNUC__)
#define SGT_NOINLINE __attribute__((noinline, noclone))
#else
#define SGT_NOINLINE
#endif

/* A function that is seldom called: what it needs is worked out there, not before it is asked for. */
#if defined(__GNUC__)
#define SGT_COLD __attribute__((cold))
#else
#define SGT_COLD
#endif

/* A small function that others spend their time in. */
#if defined(__GNUC__)
#define SGT_HOT __attribute__((hot))
#else
#define SGT_HOT
#endif

/* A function of a file that is compiled for x86-64-v4, which itself gains nothing by it: v4 calls that of v3,
 * and leaves its own copy out (names.py).  TYPE NAME(...) {...} is
 * written SGT_NARROW(TYPE, NAME, (...)) {...}. */
#if defined(SGT_SET_NUMBER) && SGT_SET_NUMBER == 2
#define SGT_NARROW(TYPE, NAME, PARAMETERS) \
    TYPE NAME PARAMETERS;                  \
    static __attribute__((unused)) TYPE NAME##_here PARAMETERS
#else
#define SGT_NARROW(TYPE, NAME, PARAMETERS) \
    TYPE NAME PARAMETERS;                  \
    TYPE NAME PARAMETERS
#endif

/* Marks a loop over rays that is to become vector code.  It is a function of its own: inlined, or cloned
 * for some of its arguments, it may lose that.  It is in a section of its own, where
 * tests/build/vectorised.py finds it. */
#if defined(__ELF__)
#define SGT_KERNEL SGT_NOINLINE __attribute__((section(".text.sgt_kernels")))
#else
#define SGT_KERNEL SGT_NOINLINE
#endif

#define SGT_U 0x1p-53        /* half an ulp of 1: one rounding is at most u |result| */
#define SGT_TWOFOLD 0x1p-102

/* The larger, by one instruction (fmax is a call, because of NaN); b if a is NaN. */
SGT_INLINE double larger(double a, double b) { return a > b ? a : b; }

typedef struct twofold { double hi, lo; } twofold;

/* a + b = hi + lo exactly. */
SGT_INLINE twofold two_sum(double a, double b)
{
    double s = a + b, v = s - a;
    return (twofold){s, (a - (s - v)) + (b - v)};
}

/* The same if |a| >= |b| or a = 0. */
SGT_INLINE twofold quick_two_sum(double a, double b)
{
    double s = a + b;
    return (twofold){s, b - (s - a)};
}

/* a * b = hi + lo exactly. */
SGT_INLINE twofold two_product(double a, double b)
{
    double p = a * b;
    return (twofold){p, sgt_fma(a, b, -p)};
}

SGT_INLINE twofold twofold_of(double a) { return (twofold){a, 0}; }
SGT_INLINE twofold twofold_negative(twofold a) { return (twofold){-a.hi, -a.lo}; }
SGT_INLINE twofold twofold_times_power(twofold a, double power)
{
    return (twofold){a.hi * power, a.lo * power};
}

SGT_INLINE twofold twofold_sum(twofold a, twofold b)
{
    twofold s = two_sum(a.hi, b.hi), t = two_sum(a.lo, b.lo);
    s = quick_two_sum(s.hi, s.lo + t.hi);
    return quick_two_sum(s.hi, s.lo + t.lo);
}

SGT_INLINE twofold twofold_difference(twofold a, twofold b) { return twofold_sum(a, twofold_negative(b)); }

SGT_INLINE twofold twofold_product(twofold a, twofold b)
{
    twofold p = two_product(a.hi, b.hi);
    return quick_two_sum(p.hi, p.lo + sgt_fma(a.lo, b.hi, sgt_fma(a.hi, b.lo, a.lo * b.lo)));
}

SGT_INLINE twofold twofold_scaled(twofold a, double b) { return twofold_product(a, twofold_of(b)); }

SGT_INLINE twofold twofold_quotient(twofold a, twofold b)
{
    double q = a.hi / b.hi;
    twofold r = twofold_difference(a, twofold_scaled(b, q));
    return quick_two_sum(q, (r.hi + r.lo) / b.hi);
}

/* The square root; a >= 0. */
SGT_INLINE twofold twofold_root(twofold a)
{
    if (!(a.hi > 0)) return twofold_of(0);
    double s = sqrt(a.hi);
    twofold r = twofold_difference(a, two_product(s, s));
    return quick_two_sum(s, r.hi / (2 * s));
}

#endif
