/* page.c - points of a lens on a page. */
#include "page.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

page_dot page_at(const page *p, sgt_vec3 point)
{
    spot s = view_spot(&p->scene->view, point);
    return (page_dot){p->left + p->scale * s.right, p->base - p->scale * s.up};
}

page_dot page_along(const page *p, sgt_vec3 direction)
{
    spot s = view_spot(&p->scene->view, direction);
    return (page_dot){s.right, -s.up};
}

void page_line(const page *p, const sgt_vec3 at[], size_t count)
{
    bool open = false;
    for (size_t i = 0; i < count; i++) {
        page_dot d = page_at(p, at[i]);
        bool fine = isfinite(d.x) && isfinite(d.y);
        if (fine && open)
            cairo_line_to(p->cr, d.x, d.y);
        else if (fine)
            cairo_move_to(p->cr, d.x, d.y);
        open = fine;
    }
}

void page_stroke(const page *p, double width, double grey)
{
    cairo_set_source_rgb(p->cr, grey, grey, grey);
    cairo_set_line_width(p->cr, width);
    cairo_stroke(p->cr);
}

static double width_of(cairo_t *cr, const char *text)
{
    cairo_text_extents_t size;
    cairo_text_extents(cr, text, &size);
    return size.x_advance;
}

double page_text(cairo_t *cr, double x, double y, double room, const char *text)
{
    enum { MOST = 400 };
    char cut[MOST + 4];
    size_t length = strlen(text);
    bool whole = length < MOST;
    snprintf(cut, sizeof cut, "%.*s", MOST, text);
    if (!whole) length = MOST;
    while (length > 0 && (!whole || width_of(cr, cut) > room)) {
        whole = width_of(cr, cut) <= room; /* then it was only too long to be copied */
        do length--;
        while (length > 0 && ((unsigned char)text[length] & 0xC0) == 0x80); /* not inside a letter */
        memcpy(cut + length, "\342\200\246", 4);
    }
    cairo_move_to(cr, x, y);
    cairo_show_text(cr, cut);
    return width_of(cr, cut);
}
