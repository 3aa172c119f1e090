// SPDX-License-Identifier: MIT
/* soil.h - what a row of a batch that no loop has set may hold.
 *
 * A batch keeps its rows on the stack, and not all of them are set for all rays.  What such a row holds
 * was left there by the calls before, so a fault that reads one shows itself seldom.  soil_stack leaves
 * there what does harm: a mask of all bits, which is a NaN too; nothing; bytes and a number that look like
 * an answer; an infinity; any bits.  Two times of eight what the calls before have left stays.  Answers must
 * not depend on it: the batch that is asked next is compared with rays one by one.
 */
#ifndef TESTS_BATCH_SOIL_H
#define TESTS_BATCH_SOIL_H

#include <stdint.h>

#if defined(__GNUC__)
__attribute__((noinline, unused))
#endif
static void soil_stack(uint64_t random)
{
    enum { WORDS = 160 * 1024 / 8 }; /* more than a call takes (tests/build/test_stack.c) */
    static const uint64_t stains[5] = {UINT64_MAX, 0, 0x0101010101010101u, 0x3ff0000000000000u,
                                       0x7ff0000000000000u};
    volatile uint64_t frame[WORDS];
    const int stain = (int)(random >> 61);
    for (int i = 0; i < WORDS && stain < 6; i++) {
        random = random * 0xd1342543de82ef95u + 1;
        frame[i] = stain < 5 ? stains[stain] : random;
    }
    (void)frame[0];
}

#endif
