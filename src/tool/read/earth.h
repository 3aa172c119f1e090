// SPDX-License-Identifier: MIT
/* earth.h - the surface types of sagitta_geo, if the command is built with it. */
#ifndef TOOL_EARTH_H
#define TOOL_EARTH_H
#include "rays.h"

#include <sagitta/geo.h>
#include <sagitta/surfaces.h>

/* A table like that of sgt_builtins(); NULL if the command is built without sagitta_geo. */
const sgt_builtin *earth_types(void);

/* For sgt_lens_options: opens the file of a geoid. */
const sgt_surface_ops *earth_file_ops(void);
const char *earth_complete(void *context, const sgt_builtin *type, void *self, const char *path);

/* Is it a surface about the Earth?  If so, and the list has places, makes rays of them; `over` (may be NULL)
 * becomes what earth_places needs. */
bool earth_rays(sgt_surface s, ray_list *list, sgt_geodetic_height *over);

/* The latitudes, longitudes and heights of points, by column; NaN for NaN. */
void earth_places(const sgt_geodetic_height *over, size_t n, const double *const p[3],
                  double *const place[3]);

#endif
