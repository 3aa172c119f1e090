/* trade_plot_missing.c - in the place of trade_plot.c where there is no cairo. */
#include "picture.h"
#include "trade.h"

void trade_picture_check(void) { picture_check(); }

void trade_picture(const char *file, const trade *t)
{
    (void)file, (void)t;
    picture_check();
}
