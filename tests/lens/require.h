// SPDX-License-Identifier: MIT
/* require.h - what has to be so.  A test counts its faults, tells each, and goes on. */
#ifndef TESTS_LENS_REQUIRE_H
#define TESTS_LENS_REQUIRE_H
#include <stdio.h>

static int faults;

#define REQUIRE(condition, ...)                                          \
    do {                                                                 \
        if (!(condition)) {                                              \
            printf("%s:%d: not so: %s: ", __FILE__, __LINE__, #condition); \
            printf(__VA_ARGS__);                                         \
            printf("\n");                                                \
            faults++;                                                    \
        }                                                                \
    } while (0)

#endif
