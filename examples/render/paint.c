// SPDX-License-Identifier: MIT
/* paint.c - numbers as colours.
 *
 * Evaluations go through viridis (S. van der Walt and N. Smith, 2015), which grows evenly in lightness and
 * can be read by the colour-blind and in grey, on a scale of logarithms, because a grazing ray may cost a
 * hundred times what another does.  A status has one of the colours of M. Okabe and K. Ito (2008): what is
 * decided is cool or pale, what is undecided is warm or black. */
#include "paint.h"

#include <stdio.h>

enum { STRIP = 62, MARGIN = 10, WIDTH_LEAST = 440, STOPS = 10 };

static const unsigned VIRIDIS[STOPS] = {0x440154, 0x482878, 0x3e4a89, 0x31688e, 0x26828e,
                                        0x1f9e89, 0x35b779, 0x6ece58, 0xb5de2b, 0xfde725};
static const unsigned NOTHING_SPENT = 0xd9d9d9, PAPER = 0xffffff;

static unsigned viridis(double x)
{
    double at = fmax(0, fmin(1, x)) * (STOPS - 1);
    int i = at < STOPS - 1 ? (int)at : STOPS - 2;
    unsigned code = 0;
    for (int shift = 0; shift < 24; shift += 8) {
        double a = VIRIDIS[i] >> shift & 255, b = VIRIDIS[i + 1] >> shift & 255;
        code |= (unsigned)(a + (at - i) * (b - a) + 0.5) << shift;
    }
    return code;
}

static const struct { sgt_status status; unsigned code; } STATUSES[] = {
    {SGT_HIT, 0x56b4e9}, {SGT_GRAZE, 0x009e73}, {SGT_MISS, 0xe8e8e8}, {SGT_UNPROVEN, 0xe69f00},
    {SGT_UNDEFINED, 0xcc79a7}, {SGT_EXHAUSTED, 0xd55e00}, {SGT_STOPPED, 0x0072b2}, {SGT_INVALID, 0x000000}};
enum { STATUS_KINDS = sizeof STATUSES / sizeof *STATUSES };

static int kind_of(double status)
{
    int i = STATUS_KINDS - 1;
    while (i > 0 && STATUSES[i].status != (sgt_status)status) i--;
    return i;
}

static void set_colour(cairo_t *cr, unsigned code)
{
    cairo_set_source_rgb(cr, (code >> 16 & 255) / 255.0, (code >> 8 & 255) / 255.0, (code & 255) / 255.0);
}

static void box(cairo_t *cr, double x, double y, double width, double height, unsigned code)
{
    cairo_rectangle(cr, x, y, width, height);
    set_colour(cr, code);
    cairo_fill(cr);
}

/* align: 0 begins at x, 0.5 in the middle, 1 ends there. */
static double text(cairo_t *cr, double x, double y, double align, const char *words)
{
    cairo_text_extents_t size;
    cairo_text_extents(cr, words, &size);
    set_colour(cr, 0x202020);
    cairo_move_to(cr, x - align * size.x_advance, y);
    cairo_show_text(cr, words);
    return size.x_advance;
}

static void evaluations_legend(cairo_t *cr, double top, double width, double most, double mean)
{
    char words[120];
    double left = MARGIN, right = width - MARGIN - 120, decades = fmax(log10(most), 1e-9);
    snprintf(words, sizeof words, "evaluations of F for each ray of the camera: mean %.1f, most %.0f", mean,
             most);
    text(cr, left, top + 18, 0, words);
    for (double x = left; x < right; x++)
        box(cr, x, top + 26, 1, 12, viridis((x - left) / (right - 1 - left)));
    /* decades, and the end */
    for (double tick = 1; tick <= most; tick = tick < most && 10 * tick > most ? most : 10 * tick) {
        double x = left + log10(tick) / decades * (right - left);
        if (tick < most && right - x < 40) continue;
        box(cr, fmin(x, right - 1), top + 38, 1, 4, 0x202020);
        snprintf(words, sizeof words, "%.0f", tick);
        text(cr, x, top + 54, x > left ? 0.5 : 0, words);
    }
    box(cr, right + 20, top + 26, 12, 12, NOTHING_SPENT);
    text(cr, right + 38, top + 36, 0, "none needed");
}

static void status_legend(cairo_t *cr, const picture *p, double top, double width, const long count[])
{
    double x = MARGIN, y = top + 18;
    for (int i = 0; i < STATUS_KINDS; i++) {
        char words[80];
        cairo_text_extents_t size;
        if (!count[i]) continue;
        snprintf(words, sizeof words, "%s %ld (%.3g %%)", sgt_status_text(STATUSES[i].status), count[i],
                 100.0 * (double)count[i] / ((double)p->width * p->height));
        cairo_text_extents(cr, words, &size);
        if (x > MARGIN && x + 18 + size.x_advance > width - MARGIN) x = MARGIN, y += 18;
        box(cr, x, y - 10, 12, 12, STATUSES[i].code);
        x += 18 + text(cr, x + 18, y, 0, words) + 16;
    }
}

void paint_write(const picture *p, paint_kind kind, const char *file, uint64_t digest)
{
    int width = p->width > WIDTH_LEAST ? p->width : WIDTH_LEAST;
    size_t n = (size_t)p->width * (size_t)p->height;
    double most = 1, sum = 0;
    long count[STATUS_KINDS] = {0};
    for (size_t i = 0; i < n; i++) {
        most = fmax(most, p->pixel[i].x);
        sum += p->pixel[i].x;
        count[kind_of(p->pixel[i].y)]++;
    }
    cairo_surface_t *surface = picture_surface(width, p->height + STRIP);
    cairo_t *cr = cairo_create(surface);
    set_colour(cr, PAPER);
    cairo_paint(cr);
    cairo_select_font_face(cr, "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
    cairo_set_font_size(cr, 12);
    if (kind == PAINT_STATUS) status_legend(cr, p, p->height, width, count);
    else evaluations_legend(cr, p->height, width, most, sum / (double)n);
    cairo_destroy(cr);
    cairo_surface_flush(surface);
    for (size_t i = 0; i < n; i++) {
        double evals = p->pixel[i].x;
        unsigned spent = evals > 0 ? viridis(log(evals) / fmax(log(most), 1e-9)) : NOTHING_SPENT;
        picture_put(surface, (int)(i % (size_t)p->width), (int)(i / (size_t)p->width),
                    kind == PAINT_STATUS ? STATUSES[kind_of(p->pixel[i].y)].code : spent);
    }
    picture_save(surface, file, digest);
}
