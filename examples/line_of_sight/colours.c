// SPDX-License-Identifier: MIT
/* colours.c - viridis (S. van der Walt and N. Smith, 2015) grows evenly in lightness and can be read by the
 * colour-blind and in grey. */
#include "colours.h"

#include <math.h>

unsigned colours_viridis(double x)
{
    static const unsigned stops[] = {0x440154, 0x482878, 0x3e4a89, 0x31688e, 0x26828e,
                                     0x1f9e89, 0x35b779, 0x6ece58, 0xb5de2b, 0xfde725};
    enum { LAST = sizeof stops / sizeof *stops - 1 };
    double at = fmax(0, fmin(1, x)) * LAST;
    int i = at < LAST ? (int)at : LAST - 1;
    unsigned code = 0;
    for (int shift = 0; shift < 24; shift += 8) {
        double a = stops[i] >> shift & 255, b = stops[i + 1] >> shift & 255;
        code |= (unsigned)(a + (at - i) * (b - a) + 0.5) << shift;
    }
    return code;
}

void colours_set(cairo_t *cr, unsigned code)
{
    cairo_set_source_rgb(cr, (code >> 16 & 255) / 255.0, (code >> 8 & 255) / 255.0, (code & 255) / 255.0);
}

void colours_box(cairo_t *cr, double x, double y, double width, double height, unsigned code)
{
    cairo_rectangle(cr, x, y, width, height);
    colours_set(cr, code);
    cairo_fill(cr);
}

double colours_text(cairo_t *cr, double x, double y, double align, const char *words)
{
    cairo_text_extents_t size;
    cairo_text_extents(cr, words, &size);
    cairo_move_to(cr, x - align * size.x_advance, y);
    cairo_show_text(cr, words);
    return size.x_advance;
}
