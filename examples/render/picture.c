// SPDX-License-Identifier: MIT
/* picture.c - from linear light to eight bits, and to a file by cairo.
 *
 * Light up to 0.6 of white stays as it is; what is more comes ever nearer to white, by tanh, so that
 * a highlight has no edge where it becomes too bright.  Then the curve of sRGB (IEC 61966-2-1). */
#include "picture.h"

#include "fail.h"

#include <stdint.h>
#include <stdlib.h>

picture picture_new(int width, int height)
{
    picture p = {width, height, calloc((size_t)width * (size_t)height, sizeof *p.pixel)};
    if (!p.pixel) fail_input("out of memory for %d x %d pixels", width, height);
    return p;
}

static unsigned byte_of(double x)
{
    x = fmax(0, fmin(1, x)); /* NaN: 0 */
    return (unsigned)(255 * (x <= 0.0031308 ? 12.92 * x : 1.055 * pow(x, 1 / 2.4) - 0.055) + 0.5);
}

unsigned picture_code(vec3 c) { return byte_of(c.x) << 16 | byte_of(c.y) << 8 | byte_of(c.z); }

cairo_surface_t *picture_surface(int width, int height)
{
    cairo_surface_t *surface = cairo_image_surface_create(CAIRO_FORMAT_RGB24, width, height);
    cairo_status_t status = cairo_surface_status(surface);
    if (status != CAIRO_STATUS_SUCCESS)
        fail_input("a picture of %d x %d: %s", width, height, cairo_status_to_string(status));
    return surface;
}

void picture_put(cairo_surface_t *surface, int x, int y, unsigned code)
{
    unsigned char *row = cairo_image_surface_get_data(surface) +
                         (ptrdiff_t)y * cairo_image_surface_get_stride(surface);
    ((uint32_t *)(void *)row)[x] = code;
}

void picture_save(cairo_surface_t *surface, const char *file)
{
    cairo_surface_mark_dirty(surface);
    cairo_status_t status = cairo_surface_write_to_png(surface, file);
    cairo_surface_destroy(surface);
    if (status != CAIRO_STATUS_SUCCESS) fail_input("%s: %s", file, cairo_status_to_string(status));
}

static double shouldered(double x) { return x < 0.6 ? x : 0.6 + 0.4 * tanh((x - 0.6) / 0.4); }

void picture_write(const picture *p, double exposure, const char *file)
{
    cairo_surface_t *surface = picture_surface(p->width, p->height);
    for (int y = 0; y < p->height; y++)
        for (int x = 0; x < p->width; x++) {
            vec3 c = scaled(p->pixel[(size_t)y * (size_t)p->width + (size_t)x], exposure);
            picture_put(surface, x, y,
                        picture_code((vec3){shouldered(c.x), shouldered(c.y), shouldered(c.z)}));
        }
    picture_save(surface, file);
}
