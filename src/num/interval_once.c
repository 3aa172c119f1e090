// SPDX-License-Identifier: MIT
/* interval_once.c - the product and the quotient of interval_once.h. */
#include "interval_once.h"

sgt_interval sgt_interval_product_once(sgt_interval x, sgt_interval y)
{
    return sgt_interval_product_of_file(x, y);
}

sgt_interval sgt_interval_quotient_once(sgt_interval x, sgt_interval y)
{
    return sgt_interval_quotient_of_file(x, y);
}
