// SPDX-License-Identifier: MIT
/* sheet.c - the file of a picture.
 *
 * Fonts are not hinted: so texts have the same widths in a file of any kind, and where they are measured. */
#include "sheet.h"

#include "../base/fail.h"
#include "../base/input.h"

#include <cairo-pdf.h>
#include <cairo-svg.h>
#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

static const double PIXELS = 2, MOST_PIXELS = 32000; /* cairo's images have less than 2^15 rows */

static cairo_t *sheet_begin(cairo_surface_t *surface)
{
    cairo_t *cr = cairo_create(surface);
    cairo_font_options_t *options = cairo_font_options_create();
    cairo_font_options_set_hint_style(options, CAIRO_HINT_STYLE_NONE);
    cairo_font_options_set_hint_metrics(options, CAIRO_HINT_METRICS_OFF);
    cairo_font_options_set_antialias(options, CAIRO_ANTIALIAS_GRAY);
    cairo_set_font_options(cr, options);
    cairo_font_options_destroy(options);
    cairo_surface_destroy(surface); /* cr keeps it */
    return cr;
}

cairo_t *sheet_nowhere(void)
{
    return sheet_begin(cairo_recording_surface_create(CAIRO_CONTENT_COLOR, NULL));
}

void sheet_forget(cairo_t *cr) { cairo_destroy(cr); }

static cairo_status_t to_file(void *file, const unsigned char *data, unsigned length)
{
    return fwrite(data, 1, length, file) == length ? CAIRO_STATUS_SUCCESS : CAIRO_STATUS_WRITE_ERROR;
}

static cairo_surface_t *surface_for(picture_kind kind, FILE *file, double width, double height, double scale)
{
    if (kind == PICTURE_SVG) return cairo_svg_surface_create_for_stream(to_file, file, width, height);
    if (kind == PICTURE_PNG)
        return cairo_image_surface_create(CAIRO_FORMAT_RGB24, (int)(width * scale), (int)(height * scale));
    cairo_surface_t *pdf = cairo_pdf_surface_create_for_stream(to_file, file, width, height);
    cairo_pdf_surface_set_metadata(pdf, CAIRO_PDF_METADATA_CREATE_DATE, ""); /* it would be the time of day */
    return pdf;
}

void sheet_write(const char *path, picture_kind kind, double width, double height,
                 void (*draw)(cairo_t *cr, const void *what), const void *what)
{
    const char *name = output_name(path);
    FILE *file = fopen(name, "wb");
    if (!file) fail_input("%s: %s", path, strerror(errno));
    height = ceil(height);
    double scale = kind == PICTURE_PNG ? fmin(PIXELS, MOST_PIXELS / height) : 1;
    cairo_t *cr = sheet_begin(surface_for(kind, file, width, height, scale));
    cairo_surface_t *surface = cairo_get_target(cr);
    cairo_scale(cr, scale, scale);
    cairo_set_source_rgb(cr, 1, 1, 1);
    cairo_paint(cr);
    draw(cr, what);
    cairo_status_t status = cairo_status(cr);
    if (status == CAIRO_STATUS_SUCCESS && kind == PICTURE_PNG)
        status = cairo_surface_write_to_png_stream(surface, to_file, file);
    cairo_surface_finish(surface);
    if (status == CAIRO_STATUS_SUCCESS) status = cairo_surface_status(surface);
    cairo_destroy(cr);
    bool written = !ferror(file);
    if (fclose(file) != 0 || !written) fail_input("%s: cannot be written", path);
    if (status != CAIRO_STATUS_SUCCESS) fail_input("%s: %s", path, cairo_status_to_string(status));
    output_whole("picture", name, path);
}
