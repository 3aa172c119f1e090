// SPDX-License-Identifier: MIT
/* choose.c - which set of instructions the processor has.
 *
 * As in the x86-64 psABI (1.0, table 3.1):
 *
 *     v3    AVX, AVX2, BMI1, BMI2, F16C, FMA, LZCNT, MOVBE, and a system that keeps the registers of AVX
 *     v4    besides, AVX512F, BW, CD, DQ, VL, and a system that keeps their registers
 *
 * For tests the environment variable SAGITTA_SET names base, v3 or v4.  If the processor does not have
 * that set, the best it has is taken. */
#include "dispatch.h"

#if SGT_SETS > 1
#include <cpuid.h>
#include <stdlib.h>
#include <string.h>

int sgt_chosen_set = -1;

enum { KEPT_AVX = 0x06, KEPT_AVX512 = 0xe6 }; /* bits of XCR0 */

static unsigned kept_by_system(void)
{
    unsigned low, high;
    __asm__("xgetbv" : "=a"(low), "=d"(high) : "c"(0));
    return low;
}

static int best_set(void)
{
    const unsigned v3_1 = bit_FMA | bit_MOVBE | bit_OSXSAVE | bit_AVX | bit_F16C,
                   v3_7 = bit_BMI | bit_AVX2 | bit_BMI2;
    const unsigned v4_7 = bit_AVX512F | bit_AVX512DQ | bit_AVX512CD | bit_AVX512BW | bit_AVX512VL,
                   lzcnt = 1u << 5;
    unsigned a, b, c, d, b7, c7, of_lzcnt;
    if (!__get_cpuid(1, &a, &b, &c, &d) || (c & v3_1) != v3_1) return SGT_BASE;
    unsigned kept = kept_by_system();
    if (!__get_cpuid_count(7, 0, &a, &b7, &c7, &d) || !__get_cpuid(0x80000001, &a, &b, &of_lzcnt, &d))
        return SGT_BASE;
    if ((b7 & v3_7) != v3_7 || !(of_lzcnt & lzcnt) || (kept & KEPT_AVX) != KEPT_AVX) return SGT_BASE;
    return (b7 & v4_7) == v4_7 && (kept & KEPT_AVX512) == KEPT_AVX512 ? SGT_V4 : SGT_V3;
}

int sgt_choose_set(void)
{
    int best = best_set(), set = best;
    const char *name = getenv("SAGITTA_SET");
    if (name && strcmp(name, "base") == 0) set = SGT_BASE;
    if (name && strcmp(name, "v3") == 0 && best > SGT_V3) set = SGT_V3;
    __atomic_store_n(&sgt_chosen_set, set, __ATOMIC_RELAXED);
    return set;
}
#else
typedef int sgt_nothing_to_choose;
#endif
