/* surface.h - a surface from the text of an option, and what the table says of one. */
#ifndef TOOL_SURFACE_H
#define TOOL_SURFACE_H
#include <sagitta/surfaces.h>
#include <stdbool.h>

/* surface_row: the first row of the table with the operations of s; of other surfaces the row of zeros at its
 * end.  surface_is_level_set: by its family.  surface_number: a number of s by its key, in any row with these
 * operations; NULL if it has none of that name. */
const sgt_builtin *surface_row(sgt_surface s);
bool surface_is_level_set(sgt_surface s);
const double *surface_number(sgt_surface s, const char *key);

/* Reads a surface from the text of an option; an error ends the command. */
sgt_surface surface_parse(const char *option, const char *text);

/* The same; *type: the name of its type. */
sgt_surface surface_parse_typed(const char *option, const char *text, const char **type);

#endif
