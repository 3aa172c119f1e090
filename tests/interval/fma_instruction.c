// SPDX-License-Identifier: MIT
/* fma_instruction.c - the processor's own fma for test_fma.c; compiled for a processor that has it. */
#include "fma_instruction.h"

#if defined(__FMA__) || defined(__aarch64__) || defined(__s390x__) || defined(__FP_FAST_FMA)
bool fma_instruction_is_there(void)
{
#if defined(__x86_64__) || defined(__i386__)
    return __builtin_cpu_supports("fma");
#else
    return true;
#endif
}

double fma_instruction(double a, double b, double c) { return __builtin_fma(a, b, c); }
#else
bool fma_instruction_is_there(void) { return false; }
double fma_instruction(double a, double b, double c) { return a * b + c; } /* never called */
#endif
