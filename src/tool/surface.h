/* surface.h - a surface from its YAML map. */
#ifndef TOOL_SURFACE_H
#define TOOL_SURFACE_H
#include "document.h"

#include <sagitta/surfaces.h>

/* Whose is `semi_diameter`?  Of a surface by itself it is a parameter; in a lens it is
 * the element's clear aperture, which the reader of the lens has taken by then. */
typedef enum surface_rim { SURFACE_OWN_RIM, SURFACE_NO_RIM } surface_rim;

/* Takes `type` and the parameters of that type out of the map, which document_map has
 * seen.  What is left in it is the caller's.  *type (may be NULL): its row of the table. */
sgt_surface surface_read(const document *d, const node *map, surface_rim rim, const sgt_builtin **type);

/* The keys of a type, for the message about an unknown one. */
const char *surface_keys(const sgt_builtin *type, surface_rim rim);

/* A surface given as text in an option: the whole document is one. */
sgt_surface surface_parse(const char *option, const char *text);

#endif
