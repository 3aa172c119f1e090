/* surface.h - reads a surface from its YAML map. */
#ifndef TOOL_SURFACE_H
#define TOOL_SURFACE_H
#include "document.h"

#include <sagitta/surfaces.h>

/* What is `semi_diameter`?  OWN_RIM: a parameter of the surface.  NO_RIM: in a lens, the element's clear
 * aperture, which the reader of the lens has taken already.  TERM: a term of a sum has no rim and no base
 * conic; the sum has them. */
typedef enum surface_rim { SURFACE_OWN_RIM, SURFACE_NO_RIM, SURFACE_TERM } surface_rim;

/* Takes `type` and the parameters of that type from a map that document_map has checked.  Any key
 * that is left is an error.  `others`: the keys that the caller has taken, for the message.
 * *type: the row of the table. */
sgt_surface surface_read(const document *d, const node *map, surface_rim rim, const char *others,
                         const sgt_builtin **type);

/* surface_row: the first row of the table with the operations of s; of other surfaces the row of zeros at its
 * end.  surface_is_level_set: by its family.  surface_number: a number of s by its key, in any row with these
 * operations; NULL if it has none of that name. */
const sgt_builtin *surface_row(sgt_surface s);
bool surface_is_level_set(sgt_surface s);
const double *surface_number(sgt_surface s, const char *key);

/* Reads a surface from the text of an option. */
sgt_surface surface_parse(const char *option, const char *text);

/* The same; *type: the name of its type. */
sgt_surface surface_parse_typed(const char *option, const char *text, const char **type);

#endif
