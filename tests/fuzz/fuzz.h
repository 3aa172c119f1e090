// SPDX-License-Identifier: MIT
/* fuzz.h - what the fuzz targets share: invariants that stop the run, and numbers out of bytes.
 *
 * A target is the function LLVMFuzzerTestOneInput (libFuzzer's name): bytes in, and where an invariant does
 * not hold, REQUIRE says which and aborts.  libFuzzer makes the bytes, in a build by clang (run.sh);
 * replay.c feeds files, with any compiler. */
#ifndef TESTS_FUZZ_FUZZ_H
#define TESTS_FUZZ_FUZZ_H

#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

#if defined(__GNUC__)
#define UNUSED __attribute__((unused))
#else
#define UNUSED
#endif

#define COUNT_OF(array) (sizeof(array) / sizeof *(array))

#define REQUIRE(condition, ...)                                        \
    do {                                                               \
        if (!(condition)) {                                            \
            fprintf(stderr, "%s:%d: not so: %s\n    ", __FILE__, __LINE__, #condition); \
            fprintf(stderr, __VA_ARGS__);                              \
            fputc('\n', stderr);                                       \
            abort();                                                   \
        }                                                              \
    } while (0)

static UNUSED uint64_t bits_of(double x)
{
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}

static UNUSED double from_bits(uint64_t bits)
{
    double x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

/* Equal to the last bit; a NaN is a NaN. */
static UNUSED bool same(double a, double b) { return bits_of(a) == bits_of(b) || (a != a && b != b); }

/* x moved by n doubles (n small). */
static UNUSED double moved(double x, int n)
{
    for (; n > 0; n--) x = nextafter(x, HUGE_VAL);
    for (; n < 0; n++) x = nextafter(x, -HUGE_VAL);
    return x;
}

/* -------------------------------------------------------- numbers out of bytes */

/* What is left of the input; beyond its end all is zero. */
typedef struct bytes { const uint8_t *at; size_t left; double last[4]; unsigned made; } bytes;

static UNUSED unsigned take_byte(bytes *b)
{
    if (!b->left) return 0;
    b->left--;
    return *b->at++;
}

static UNUSED uint64_t take_bits(bytes *b, int count)
{
    uint64_t bits = 0;
    for (int i = 0; i < count; i++) bits |= (uint64_t)take_byte(b) << (8 * i);
    return bits;
}

static const double ODD_NUMBERS[] = {
    0,
    1,
    0.5,
    2,
    0.1,
    10,
    1e-3,
    1e3,
    0x1p-1074,
    0x1p-1022,
    0x1p-1000,
    1e-300,
    1e-160,
    1e-154,
    1e-100,
    1e-16,
    1e-8,
    1e8,
    1e15,
    1e16,
    1e75,
    1e100,
    1e150,
    1e154,
    1e155,
    1e200,
    1e300,
    DBL_MAX,
    (double)INFINITY,
    (double)NAN,
    0x1p-52,
    0x1p-26,
};

/* A double: the first byte says how it is written, so that a mutation of one byte makes a number of another
 * kind, and small numbers, numbers of any size, each single pattern of bits, and numbers next to one that
 * came before are all near. */
static UNUSED double take_number(bytes *b)
{
    unsigned how = take_byte(b), sign = how >> 7;
    double x = 0, whole;
    switch (how & 7) { /* one at a time: C does not say which of two arguments is taken first */
    case 0: break;
    case 1: x = (double)(int16_t)take_bits(b, 2) / 1024; break;
    case 2: x = ODD_NUMBERS[(how >> 3 & 15) | (take_byte(b) & 1) << 4]; break;
    case 3:
        whole = (double)(take_bits(b, 2) | 1 << 16), x = ldexp(whole, (int)(int8_t)take_byte(b) - 16);
        break;
    case 4:
        whole = (double)(take_bits(b, 2) | 1 << 16),
        x = ldexp(whole, (int)(int16_t)take_bits(b, 2) % 1100 - 16);
        break;
    case 5: x = moved(b->last[how >> 3 & 3], (int)(int8_t)take_byte(b) / 8); break;
    case 6:
        whole = (double)(int8_t)take_byte(b),
        x = b->last[how >> 3 & 3] * (1 + ldexp(whole, -8 - (int)(take_byte(b) & 63)));
        break;
    default: x = from_bits(take_bits(b, 8)); break;
    }
    if (sign) x = -x;
    return b->last[b->made++ & 3] = x;
}

static UNUSED int take_int(bytes *b, int lo, int hi)
{
    return lo + (int)(take_byte(b) % (unsigned)(hi - lo + 1));
}

#endif
