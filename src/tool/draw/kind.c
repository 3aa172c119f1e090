// SPDX-License-Identifier: MIT
/* kind.c - the endings of the files of pictures, in capitals, too. */
#include "kind.h"

#include "../base/fail.h"

#include <string.h>
#include <strings.h>

picture_kind picture_kind_of(const char *option, const char *path)
{
    static const char *const endings[] = {
        [PICTURE_SVG] = ".svg", [PICTURE_PNG] = ".png", [PICTURE_PDF] = ".pdf"};
    size_t length = strlen(path);
    for (int k = PICTURE_SVG; k <= PICTURE_PDF; k++)
        if (length > 4 && strcasecmp(path + length - 4, endings[k]) == 0) return (picture_kind)k;
    fail_usage("--%s %s: the name must end in .svg, .png or .pdf", option, path);
}
