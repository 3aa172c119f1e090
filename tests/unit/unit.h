// SPDX-License-Identifier: MIT
/* unit.h - what the unit tests share: cmocka, a generator of random cases, long doubles.
 *
 * SAGITTA_TEST_SEED chooses other cases (a number; 1), SAGITTA_TEST_SCALE multiplies how
 * many.  Each program prints both, so that what failed can be run again. */
#ifndef TESTS_UNIT_UNIT_H
#define TESTS_UNIT_UNIT_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <float.h>
#include <math.h>
#include <sagitta/sagitta.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#if defined(__GNUC__)
#define UNUSED __attribute__((unused))
#else
#define UNUSED
#endif

/* Says what is wrong, with numbers. */
#ifndef REQUIRE
#define REQUIRE(condition, ...)                \
    do {                                       \
        if (!(condition)) fail_msg(__VA_ARGS__); \
    } while (0)
#endif

#define COUNT_OF(array) (sizeof(array) / sizeof *(array))

static const double NOT = (double)NAN, FAR = HUGE_VAL;

/* ------------------------------------------------------------ random cases */

typedef struct generator { uint64_t state; } generator;

static UNUSED uint64_t random_bits(generator *g) /* splitmix64 (Steele, Lea & Flood 2014) */
{
    uint64_t z = (g->state += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

static UNUSED double uniform(generator *g, double lo, double hi)
{
    return lo + (hi - lo) * ldexp((double)(random_bits(g) >> 11), -53);
}
static UNUSED double log_uniform(generator *g, double lo, double hi)
{
    return exp(uniform(g, log(lo), log(hi)));
}
static UNUSED int below(generator *g, int n) { return (int)(random_bits(g) % (uint64_t)n); }
static UNUSED bool chance(generator *g, double p) { return uniform(g, 0, 1) < p; }
static UNUSED double either_sign(generator *g) { return chance(g, 0.5) ? 1 : -1; }

/* Evenly over the sphere. */
static UNUSED sgt_vec3 random_direction(generator *g)
{
    double z = uniform(g, -1, 1), a = uniform(g, 0, 6.283185307179586), r = sqrt(1 - z * z);
    return (sgt_vec3){r * cos(a), r * sin(a), z};
}
static UNUSED sgt_vec3 random_point(generator *g, double size)
{
    return (sgt_vec3){uniform(g, -size, size), uniform(g, -size, size), uniform(g, -size, size)};
}

static UNUSED generator seeded(const char *test)
{
    const char *text = getenv("SAGITTA_TEST_SEED");
    unsigned long long seed = text ? strtoull(text, NULL, 0) : 1;
    printf("%s: SAGITTA_TEST_SEED=%llu\n", test, seed);
    return (generator){seed};
}

static UNUSED long scaled(long count)
{
    const char *text = getenv("SAGITTA_TEST_SCALE");
    double n = (double)count * (text ? atof(text) : 0.5);
    printf("%ld cases\n", n < 1 ? 1 : (long)n);
    return n < 1 ? 1 : (long)n;
}

/* ----------------------------------------------- vectors, in long double */

typedef struct wide { long double x, y, z; } wide;

static UNUSED wide widen(sgt_vec3 a) { return (wide){a.x, a.y, a.z}; }
static UNUSED long double wide_dot(wide a, wide b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static UNUSED wide wide_cross(wide a, wide b)
{
    return (wide){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
static UNUSED wide wide_sum(wide a, wide b) { return (wide){a.x + b.x, a.y + b.y, a.z + b.z}; }
static UNUSED wide wide_difference(wide a, wide b) { return (wide){a.x - b.x, a.y - b.y, a.z - b.z}; }
static UNUSED wide wide_times(long double a, wide b) { return (wide){a * b.x, a * b.y, a * b.z}; }
static UNUSED long double wide_length(wide a) { return sqrtl(wide_dot(a, a)); }
static UNUSED wide wide_unit(wide a) { return wide_times(1 / wide_length(a), a); }

static UNUSED bool same_bits(double a, double b) { return memcmp(&a, &b, sizeof a) == 0; }
static UNUSED bool same_vector(sgt_vec3 a, sgt_vec3 b)
{
    return same_bits(a.x, b.x) && same_bits(a.y, b.y) && same_bits(a.z, b.z);
}

#endif
