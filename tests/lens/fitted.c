// SPDX-License-Identifier: MIT
/* fitted.c - the polynomials of a fitted map: by registers of each width that this processor has, the bits of
 * Horner's rule for one point.
 *
 * SAGITTA_TEST_SEED replaces the seed. */
#include "../../src/lens/optics/widths.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static unsigned long long state = 36;

static double draw(void)
{
    state = state * 6364136223846793005ULL + 1442695040888963407ULL;
    return (double)(state >> 11) / 4503599627370496.0 - 1;
}

/* c: 0 for u, 1 for v.  Rows from the highest power of y, in each from the highest of x.  Of a mirrored map u
 * has odd powers of x alone, v even ones. */
static double by_hand(const sgt_aim_map *of, int c, double x, double y)
{
    const double s = of->mirrored ? x * x : x;
    const double *a = of->fit[c];
    double sum = 0;
    for (int j = AIM_DEGREE; j >= 0; j--) {
        double row = 0;
        for (int i = AIM_DEGREE - j; i >= 0; i--, a++)
            if (!of->mirrored || (i % 2 == 1) == (c == 0)) row = row * s + *a;
        sum = sum * y + row;
    }
    return of->mirrored && c == 0 ? sum * x : sum;
}

static int differ(few_fitted *few, int points, const sgt_aim_map *of)
{
    double x[AIM_FEW_MOST], y[AIM_FEW_MOST], u[AIM_FEW_MOST], v[AIM_FEW_MOST];
    int wrong = 0;
    for (int i = 0; i < points; i++) x[i] = draw(), y[i] = draw();
    few(of, x, y, u, v);
    for (int i = 0; i < points; i++) {
        const double own[2] = {by_hand(of, 0, x[i], y[i]), by_hand(of, 1, x[i], y[i])};
        wrong += memcmp(&u[i], &own[0], sizeof u[i]) || memcmp(&v[i], &own[1], sizeof v[i]);
    }
    return wrong;
}

int main(void)
{
    enum { MAPS = 2000 };
    const char *seed = getenv("SAGITTA_TEST_SEED");
    int wrong = 0, widths = 0;
    size_t count;
    few_fitted *const widest_here = widest(&count);
    if (seed) state = strtoull(seed, NULL, 10);
    for (int map = 0; map < MAPS; map++) {
        static sgt_aim_map of;
        of.mirrored = map % 2;
        for (int c = 0; c < 2; c++)
            for (int k = 0; k < AIM_TERMS; k++) of.fit[c][k] = draw();
        wrong += differ(few_by_2, 2 * PARTS, &of), widths = 1;
#ifdef SGT_WIDE
        if (count >= 4 * PARTS) wrong += differ(few_by_4, 4 * PARTS, &of), widths = 2;
        if (count >= 8 * PARTS) wrong += differ(few_by_8, 8 * PARTS, &of), widths = 3;
#endif
        wrong += differ(widest_here, (int)count, &of);
    }
    printf("%d maps by %d widths: %d points differ\n", (int)MAPS, widths, wrong);
    return wrong != 0;
}
