/* picture_missing.c - replaces what draws pictures of a lens if there is no cairo. */
#include "picture.h"

void picture_check(const char *option)
{
    fail_usage("--%s: not available; this command was built without cairo", option);
}

picture_kind picture_kind_of(const char *option, const char *path)
{
    (void)path;
    picture_check(option);
    return PICTURE_SVG;
}

void picture_write(const char *file, picture_kind kind, const scene *s)
{
    (void)file, (void)kind, (void)s;
}
