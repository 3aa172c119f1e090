// SPDX-License-Identifier: MIT
/* interval_once.h - products and quotients of intervals, once for a whole set (src/meson.build includes this
 * before all else).
 *
 * They are too long to be inlined: each file that asks for a product had a copy of 6.5 KB, for a quotient one
 * of 2.4. */
#ifndef SGT_NUM_INTERVAL_ONCE_H
#define SGT_NUM_INTERVAL_ONCE_H

#define sgt_interval_product sgt_interval_product_of_file
#define sgt_interval_quotient sgt_interval_quotient_of_file
#include <sagitta/interval.h>
#undef sgt_interval_product
#undef sgt_interval_quotient

sgt_interval sgt_interval_product_once(sgt_interval x, sgt_interval y);
sgt_interval sgt_interval_quotient_once(sgt_interval x, sgt_interval y);

static inline sgt_interval sgt_interval_product(sgt_interval x, sgt_interval y)
{
    return sgt_interval_product_once(x, y);
}

static inline sgt_interval sgt_interval_quotient(sgt_interval x, sgt_interval y)
{
    return sgt_interval_quotient_once(x, y);
}

#endif
