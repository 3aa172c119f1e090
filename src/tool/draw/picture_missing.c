/* picture_missing.c - replaces picture.c and legend.c if there is no cairo. */
#include "picture.h"

void picture_check(void) { fail_usage("--svg: not available; this command was built without cairo"); }

void picture_write(const char *file, const scene *s)
{
    (void)file, (void)s;
    picture_check();
}
