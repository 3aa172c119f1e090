// SPDX-License-Identifier: MIT
/* picture.h - a picture in linear light, and its PNG. */
#ifndef RENDER_PICTURE_H
#define RENDER_PICTURE_H
#include "vector.h"

#include <cairo.h>
#include <stdbool.h>
#include <stdint.h>

/* Row by row from the top.  Of a painted one a pixel holds {evaluations, status, 0}. */
typedef struct picture { int width, height; vec3 *pixel; } picture;

picture picture_new(int width, int height); /* free(p.pixel) is the caller's */

/* An 8-bit colour as screens have it (sRGB). */
unsigned picture_code(vec3 linear);
cairo_surface_t *picture_surface(int width, int height);
void picture_put(cairo_surface_t *surface, int x, int y, unsigned code);

/* Writes the surface and destroys it; a file that cannot be written ends the program.  The file is whole or
 * is not there (output.h).  digest: what the picture depends on, kept in it; 0: it is no frame. */
void picture_save(cairo_surface_t *surface, const char *file, uint64_t digest);

void picture_write(const picture *p, double exposure, const char *file, uint64_t digest);

/* Is the file a whole PNG, every chunk's sum right, with this digest? */
bool picture_is_whole(const char *file, uint64_t digest);

#endif
