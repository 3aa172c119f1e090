// SPDX-License-Identifier: MIT
/* fma_instruction.h - the processor's own fma, where it has one. */
#ifndef TESTS_INTERVAL_FMA_INSTRUCTION_H
#define TESTS_INTERVAL_FMA_INSTRUCTION_H
#include <stdbool.h>

bool fma_instruction_is_there(void);
double fma_instruction(double a, double b, double c);

#endif
