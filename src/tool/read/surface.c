// SPDX-License-Identifier: MIT
/* surface.c - a surface from the text of an option. */
#include "surface.h"

#include "lens.h"

sgt_surface surface_parse_typed(const char *option, const char *text, const char **type)
{
    sgt_lens_options o = lens_options();
    sgt_error e;
    sgt_lens *l = sgt_lens_read_surface(option, text, &o, &e);
    if (!l) lens_refuse(&e);
    *type = lens_keep(l)->surface[0].type;
    return l->element[0].surface;
}

sgt_surface surface_parse(const char *option, const char *text)
{
    const char *type;
    return surface_parse_typed(option, text, &type);
}
