// SPDX-License-Identifier: MIT
/* glance.h - the first root along a chord within the rim, by two looks beside it (glance.c). */
#ifndef SGT_RAY_GLANCE_H
#define SGT_RAY_GLANCE_H

#include "vicinity.h"

#include "../num/lanes.h"

/* Looks beside the root near the seed of each row that is asked, within [v->lo, v->hi], and answers in v as
 * sgt_march_chord does (wings.h), which is to be asked for the rows that are left.  marches_chord(whole) is
 * true. */
void sgt_glance_chord(sgt_surface s, size_t n, sgt_rays rays, const sgt_shared *whole, const vicinity *v);

/* Bounds on the second derivative of a sag, as a loop over rays takes them: those of all directions, those by
 * axis, the greatest of each, and what its turn says. */
typedef struct bends {
    sgt_interval bent, xx, yy;
    double xy, bent_most, xx_most, yy_most, least, greatest;
} bends;

SGT_INLINE bends bends_of(const sgt_shared *whole)
{
    const sgt_interval bent = whole->bent, xx = whole->axis.xx, yy = whole->axis.yy;
    const double turn = whole->axis.turn;
    return (bends){bent, xx, yy, whole->axis.xy, larger(-bent.lo, bent.hi), larger(-xx.lo, xx.hi),
                   larger(-yy.lo, yy.hi), turn > 0 ? 0 : -HUGE_VAL, turn < 0 ? 0 : HUGE_VAL};
}

/* Is the second derivative known by axis? */
SGT_INLINE bool bends_by_axis(const sgt_shared *whole)
{
    const sgt_by_axis *a = &whole->axis;
    return whole->by_axis && a->xx.hi < HUGE_VAL && a->yy.hi < HUGE_VAL && a->xy < HUGE_VAL;
}

/* The second derivative along (l, m) is in this (wings.c, THE BEND, BY AXIS). */
SGT_INLINE sgt_interval bent_along(bool by_axis, const bends *of, double l, double m)
{
    const double off = 0x1p-40;
    double l2 = l * l, m2 = m * m, all = l2 + m2, rounded = off * of->bent_most * all,
           lo = of->bent.lo * all - rounded, hi = of->bent.hi * all + rounded;
    if (by_axis) {
        double mixed = 2 * of->xy * fabs(l * m), less = of->xx.lo * l2 + of->yy.lo * m2 - mixed,
               more = of->xx.hi * l2 + of->yy.hi * m2 + mixed,
               lost = off * (of->xx_most * l2 + of->yy_most * m2 + mixed);
        lo = larger(lo, less - lost), hi = -larger(-hi, -(more + lost));
        lo = larger(lo, of->least), hi = -larger(-hi, -of->greatest);
    }
    return (sgt_interval){lo, hi};
}

/* Is a point within R of the axis, however it was rounded?  tx, ty: its terms. */
SGT_INLINE mask glance_within(double R, double x, double y, double tx, double ty)
{
    double inner = R - 0x1p-50 * (fabs(tx) + fabs(ty) + fabs(x) + fabs(y));
    return MASK(inner > 0) & MASK(x * x + y * y < inner * inner);
}

#endif
