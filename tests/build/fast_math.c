// SPDX-License-Identifier: MIT
/* Prints what sgt_arithmetic says in this thread, as a number, and whether sgt_check then tries anything:
 * once as the program is started, once with rounding upward, and once to nearest again. */
#include <sagitta/diagnose.h>
#include <sagitta/surfaces.h>

#include <fenv.h>
#include <stdio.h>

static void tell(void)
{
    sgt_conic plane = {0};
    sgt_surface s = {&sgt_conic_ops, &plane};
    sgt_ray ray = {{0, 0, -1}, {0, 0, 1}, 0, 2};
    sgt_fault fault = sgt_check(s, 1, &ray, NULL);
    int bad = sgt_arithmetic();
    printf("%d %d %s\n", bad, fault == SGT_WRONG_ARITHMETIC, sgt_arithmetic_text(bad));
}

int main(void)
{
    tell();
    int before = fegetround();
    if (fesetround(FE_UPWARD) != 0) return 77;
    tell();
    fesetround(before);
    tell();
    return 0;
}
