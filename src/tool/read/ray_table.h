// SPDX-License-Identifier: MIT
/* ray_table.h - rays from arrays of NumPy, and what they share with those from csv. */
#ifndef TOOL_RAY_TABLE_H
#define TOOL_RAY_TABLE_H
#include "rays.h"

/* The columns of a table of rays. */
enum { RAY_COLUMNS = 9, RAY_TMIN = 6, RAY_TMAX = 7, RAY_ID = 8, RAY_REQUIRED = 6 };
extern const char *const ray_column_name[RAY_COLUMNS];

enum { RAY_WHY = 120 };

/* Those of a file of places: latitude, longitude, height, azimuth and elevation stand in for the first five,
 * and the sixth is missing. */
extern const char *const place_column_name[RAY_COLUMNS];

/* As ray_of, of value[0 ... 4]: o has the place, d the look. */
bool place_of(const double value[8], bool has_tmin, bool has_tmax, sgt_ray *ray, char why[RAY_WHY]);

/* Makes a ray of value[0 ... 7], in the order of the columns.  false: `why` says what is wrong. */
bool ray_of(const double value[8], bool has_tmin, bool has_tmax, sgt_ray *ray, char why[RAY_WHY]);

/* Is it an array, by its name, or a folder? */
bool ray_table_is(const char *path);

/* Opens the array, or those of the folder, and looks at all rays: as rays_read. */
void ray_table_open(ray_list *list, const char *path, bool skip_bad);

/* As rays_part. */
void ray_table_part(const ray_table *from, size_t first, size_t count, ray_block *to);

#endif
