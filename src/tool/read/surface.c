/* surface.c - a surface from the text of an option, and what the table says of one. */
#include "surface.h"

#include "lens.h"

#include <string.h>

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

const sgt_builtin *surface_row(sgt_surface s)
{
    const sgt_builtin *b = sgt_builtins();
    while (b->type && b->ops != s.ops) b++;
    return b;
}

bool surface_is_level_set(sgt_surface s) { return surface_row(s)->family == SGT_FAMILY_LEVEL_SET; }

const double *surface_number(sgt_surface s, const char *key)
{
    for (const sgt_builtin *b = sgt_builtins(); b->type; b++)
        for (const sgt_param *p = b->params; b->ops == s.ops && p->name; p++)
            if (p->kind == SGT_PARAM_REAL && strcmp(p->name, key) == 0)
                return (const void *)((const char *)s.self + p->offset);
    return NULL;
}
