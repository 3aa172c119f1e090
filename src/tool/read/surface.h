/* surface.h - a surface from its YAML map. */
#ifndef TOOL_SURFACE_H
#define TOOL_SURFACE_H
#include "document.h"

#include <sagitta/surfaces.h>

/* Whose is `semi_diameter`?  Of a surface by itself it is a parameter; in a lens it is
 * the element's clear aperture, which the reader of the lens has taken by then.  A term of a
 * sum has none, and no base either: the sum has these. */
typedef enum surface_rim { SURFACE_OWN_RIM, SURFACE_NO_RIM, SURFACE_TERM } surface_rim;

/* Takes `type` and the parameters of that type out of the map, which document_map has
 * seen.  What is left in it is unknown; `others`, behind the keys of the type in the message,
 * are those that the caller has taken.  *type: its row of the table. */
sgt_surface surface_read(const document *d, const node *map, surface_rim rim, const char *others,
                         const sgt_builtin **type);

/* The row of the table with the operations of s, the first of them; and a number of s by its key, of any
 * row that has these operations: NULL, it has none of that name. */
const sgt_builtin *surface_row(sgt_surface s);
const double *surface_number(sgt_surface s, const char *key);

/* A surface given as text in an option: the whole document is one. */
sgt_surface surface_parse(const char *option, const char *text);

/* The same, and the name of its type, as the text gives it. */
sgt_surface surface_parse_typed(const char *option, const char *text, const char **type);

#endif
