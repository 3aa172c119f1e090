// SPDX-License-Identifier: MIT
/* surface.h - a surface from the text of an option. */
#ifndef TOOL_SURFACE_H
#define TOOL_SURFACE_H
#include <sagitta/surfaces.h>
#include <stdbool.h>

static inline bool surface_is_level_set(sgt_surface s)
{
    return sgt_builtin_of(s)->family == SGT_FAMILY_LEVEL_SET;
}

/* Reads a surface from the text of an option; an error ends the command. */
sgt_surface surface_parse(const char *option, const char *text);

/* The same; *type: the name of its type. */
sgt_surface surface_parse_typed(const char *option, const char *text, const char **type);

#endif
