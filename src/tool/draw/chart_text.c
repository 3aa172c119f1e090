// SPDX-License-Identifier: MIT
/* chart_text.c - text that fits: measured, cleaned, shortened, broken into lines.
 *
 * Cairo refuses all further drawing after one byte that is not UTF-8, and names of files may have any.  So
 * every text is cleaned first. */
#include "chart_draw.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { LONGEST = 1024 }; /* bytes; more than fit into a line of the sheet */
#define ELLIPSIS "\342\200\246"

void chart_font(cairo_t *cr, double size, bool bold)
{
    cairo_select_font_face(cr, "sans-serif", CAIRO_FONT_SLANT_NORMAL,
                           bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
    cairo_set_font_size(cr, size);
}

void chart_font_within(cairo_t *cr, double size, double room, const char *text)
{
    chart_font(cr, size, false);
    double wide = chart_width(cr, text);
    if (wide > room) cairo_set_font_size(cr, size * fmax(room / wide, 0.75));
}

void chart_grey(cairo_t *cr, double grey) { cairo_set_source_rgb(cr, grey, grey, grey); }

/* Bytes of the character at `s`; 0 if it is not UTF-8 (RFC 3629: no overlong forms, surrogates, or what is
 * beyond U+10FFFF). */
static size_t character_length(const char *s)
{
    unsigned char a = (unsigned char)s[0], b = a ? (unsigned char)s[1] : 0;
    size_t length = a < 0x80                ? 1
                    : a >= 0xC2 && a < 0xE0 ? 2
                    : a >= 0xE0 && a < 0xF0 ? 3
                    : a >= 0xF0 && a < 0xF5 ? 4
                                            : 0;
    for (size_t i = 1; i < length; i++)
        if (((unsigned char)s[i] & 0xC0) != 0x80) return 0;
    if ((a == 0xE0 && b < 0xA0) || (a == 0xED && b > 0x9F) || (a == 0xF0 && b < 0x90) ||
        (a == 0xF4 && b > 0x8F))
        return 0;
    return length;
}

static void cleaned(const char *text, char out[LONGEST])
{
    size_t used = 0;
    while (*text && used + 5 < LONGEST) {
        size_t length = character_length(text);
        if (length > 1)
            memcpy(out + used, text, length), used += length;
        else
            out[used++] = length == 0 ? '?' : (unsigned char)*text < ' ' || *text == 127 ? ' ' : *text;
        text += length ? length : 1;
    }
    out[used] = 0;
}

static double width_of_clean(cairo_t *cr, const char *text)
{
    cairo_text_extents_t size;
    cairo_text_extents(cr, text, &size);
    return size.x_advance;
}

double chart_width(cairo_t *cr, const char *text)
{
    char clean[LONGEST];
    if (!text) return 0;
    cleaned(text, clean);
    return width_of_clean(cr, clean);
}

/* Leaves out characters before the unit, or at the end, until the text is no wider than `room`. */
static void shorten(cairo_t *cr, char clean[LONGEST], double room)
{
    if (width_of_clean(cr, clean) <= room) return;
    char unit[LONGEST] = "", shorter[2 * LONGEST + 8];
    char *open = strrchr(clean, '(');
    size_t length = strlen(clean);
    if (open && open > clean && clean[length - 1] == ')') {
        snprintf(unit, sizeof unit, " %s", open);
        length = (size_t)(open - clean);
    }
    if (width_of_clean(cr, unit) + width_of_clean(cr, ELLIPSIS) > room) *unit = 0;
    do {
        while (length > 0 && ((unsigned char)clean[--length] & 0xC0) == 0x80) {
        }
        snprintf(shorter, sizeof shorter, "%.*s" ELLIPSIS "%s", (int)length, clean, unit);
    } while (length > 0 && width_of_clean(cr, shorter) > room);
    if (width_of_clean(cr, shorter) > room) *shorter = 0;
    snprintf(clean, LONGEST, "%.*s", LONGEST - 1, shorter);
}

void chart_text(cairo_t *cr, double x, double y, double part, double room, const char *text)
{
    char clean[LONGEST];
    if (!text || !*text) return;
    cleaned(text, clean);
    shorten(cr, clean, room);
    cairo_move_to(cr, x - part * width_of_clean(cr, clean), y);
    cairo_show_text(cr, clean);
    cairo_new_path(cr);
}

void chart_text_up(cairo_t *cr, double x, double y, double room, const char *text)
{
    cairo_save(cr);
    cairo_translate(cr, x, y);
    cairo_rotate(cr, -1.5707963267948966);
    chart_text(cr, 0, 0, 0.5, room, text);
    cairo_restore(cr);
}

size_t chart_wrap(cairo_t *cr, double x, double y, double room, double step, const char *text, bool draw)
{
    size_t lines = 0;
    char line[LONGEST], longer[LONGEST];
    if (!text) return 0;
    while (*text == ' ') text++;
    while (*text) {
        size_t used = 0; /* whole words that fit; one that is too long stands by itself */
        for (size_t end = 0; text[end];) {
            while (text[end] == ' ') end++;
            while (text[end] && text[end] != ' ') end++;
            snprintf(longer, sizeof longer, "%.*s", (int)(end < LONGEST ? end : LONGEST - 1), text);
            if (used > 0 && (chart_width(cr, longer) > room || end >= LONGEST)) break;
            memcpy(line, longer, sizeof line);
            used = end;
        }
        if (draw) chart_text(cr, x, y + (double)lines * step, 0, room, line);
        lines++;
        text += used;
        while (*text == ' ') text++;
    }
    return lines;
}
