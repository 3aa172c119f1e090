// SPDX-License-Identifier: MIT
/* fitted.h - both polynomials of a fitted map at PARTS registers of points.  widths.h includes it for each
 * width of register.
 *
 *     RAYS           points to a register
 *     FITTED(name)   the name of a function of this width
 *     WITH           what the compiler may use in it
 *
 * Several registers go side by side, so that no sum waits for itself.  Of a mirrored map the one for u is x
 * times a polynomial of x^2, the one for v is one of x^2.  There is no fma: so all widths make the same
 * bits. */
typedef double FITTED(part) __attribute__((vector_size(8 * RAYS), aligned(8), may_alias));

/* mirrored: a constant. */
WITH static inline void FITTED(few_of)(bool mirrored, const sgt_aim_map *of, const double x[],
                                       const double y[], double u[], double v[])
{
    typedef FITTED(part) part;
    const int by = mirrored ? 2 : 1;
    const part *at_x = (const void *)x, *at_y = (const void *)y;
    part *to_u = (void *)u, *to_v = (void *)v;
    part s[PARTS], sum_u[PARTS], sum_v[PARTS], a[PARTS], b[PARTS];
    for (int q = 0; q < PARTS; q++) {
        s[q] = at_x[q], sum_u[q] = sum_v[q] = (part){0};
        if (mirrored) s[q] *= s[q];
    }
    /* most: the highest power of x with one of y; mirrored: odd ones for u, even ones for v */
    WRITTEN_OUT for (int most = 0; most <= AIM_DEGREE; most++)
    {
        const double *by_u = &of->fit[0][most * (most + 1) / 2], *by_v = &of->fit[1][most * (most + 1) / 2];
        for (int q = 0; q < PARTS; q++) a[q] = b[q] = (part){0};
        WRITTEN_OUT for (int i = mirrored && most % 2 == 0; i <= most; i += by)
            for (int q = 0; q < PARTS; q++) a[q] = a[q] * s[q] + by_u[i];
        WRITTEN_OUT for (int i = mirrored && most % 2 == 1; i <= most; i += by)
            for (int q = 0; q < PARTS; q++) b[q] = b[q] * s[q] + by_v[i];
        for (int q = 0; q < PARTS; q++) {
            sum_u[q] = sum_u[q] * at_y[q] + a[q];
            sum_v[q] = sum_v[q] * at_y[q] + b[q];
        }
    }
    for (int q = 0; q < PARTS; q++) {
        if (mirrored) sum_u[q] *= at_x[q];
        to_u[q] = sum_u[q], to_v[q] = sum_v[q];
    }
}

WITH static void FITTED(few)(const sgt_aim_map *of, const double x[], const double y[], double u[],
                             double v[])
{
    if (of->mirrored) FITTED(few_of)(true, of, x, y, u, v);
    else FITTED(few_of)(false, of, x, y, u, v);
}

#undef RAYS
#undef FITTED
#undef WITH
