// SPDX-License-Identifier: MIT
/* earth.h - the surface types of sagitta_geo, if the command is built with it. */
#ifndef TOOL_EARTH_H
#define TOOL_EARTH_H
#include <sagitta/surfaces.h>

/* A table like that of sgt_builtins(); NULL if the command is built without sagitta_geo. */
const sgt_builtin *earth_types(void);

/* For sgt_lens_options: opens the file of a geoid. */
const sgt_surface_ops *earth_file_ops(void);
const char *earth_complete(void *context, const sgt_builtin *type, void *self, const char *path);

#endif
