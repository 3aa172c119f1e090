// SPDX-License-Identifier: MIT
/* page.c - points of a lens on a page. */
#include "page.h"

#include <math.h>

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
    if (p->pale) grey = PAGE_PALE;
    cairo_set_source_rgb(p->cr, grey, grey, grey);
    cairo_set_line_width(p->cr, width);
    cairo_stroke(p->cr);
}
